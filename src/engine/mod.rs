//! What an engine does.

pub mod cpu;
