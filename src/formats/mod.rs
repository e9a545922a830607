//! Bytes to patterns and back.
