//! The surface the worker of the page calls: one request in, one response out.
//!
//! | module | what lives there |
//! |---|---|
//! | [`protocol`] | the messages, as two tagged unions; `www/common/messages.js` holds the same types for the page |
//! | [`session`] | what a request does, without a browser in sight, so that it is tested natively |
//! | [`files`] | the same for files and links, which are a module of their own; `www/common/files-messages.js` |
//! | [`pattern_data`] | a pattern as the two modules hand it to each other |
//! | `bindings`, `files_bindings` | JavaScript values ⇄ messages (wasm only) |
//!
//! The page loads the engine at once and the rest when a file is opened: so neither weighs what the other needs. The
//! features `engine-module` and `files-module` say which of the two a wasm is.

#[cfg(all(target_arch = "wasm32", feature = "engine-module"))]
pub mod bindings;
pub mod files;
#[cfg(all(target_arch = "wasm32", feature = "files-module"))]
pub mod files_bindings;
#[cfg(all(target_arch = "wasm32", any(feature = "engine-module", feature = "files-module")))]
mod messages;
pub mod pattern_data;
pub mod protocol;
pub mod session;

pub use protocol::{Request, Response};
pub use session::Session;
