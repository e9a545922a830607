//! What an engine does.
