//! The surface the worker of the page calls.
