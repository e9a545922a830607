//! The random filter bank.

/// Random convolution filters.
#[derive(Debug)]
pub struct FilterBank;
