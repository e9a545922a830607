//! Built-in exemplars.
