//! The surface the worker of the page calls: one request in, one response out.
//!
//! | module | what lives there |
//! |---|---|
//! | [`protocol`] | the messages, as two tagged unions; `www/app/messages.js` holds the same types for the page |
//! | [`session`] | what a request does, without a browser in sight, so that it is tested natively |
//! | `bindings` | JavaScript values ⇄ messages (wasm only) |

#[cfg(target_arch = "wasm32")]
pub mod bindings;
pub mod protocol;
pub mod session;

pub use protocol::{Request, Response};
pub use session::Session;
