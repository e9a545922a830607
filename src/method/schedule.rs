//! The ladder of scales.

/// One scale.
#[derive(Debug)]
pub struct Scale;
/// All scales.
#[derive(Debug)]
pub struct Schedule;
