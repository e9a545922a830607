//! Bytes to patterns and back.

pub mod style;

#[cfg(not(target_arch = "wasm32"))]
mod png;
mod svg;

#[cfg(not(target_arch = "wasm32"))]
pub use png::{PngError, PngStyle, draw, encode_png, write_png};
pub use svg::{SvgStyle, write_svg};
