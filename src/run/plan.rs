//! What a run starts from.

use serde_json::{Map, Value};

use crate::pattern::PointPattern;

/// What to learn from, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// What to learn from.
    pub exemplar: PointPattern,
    /// Name of one of the method's presets.
    pub preset: String,
    /// Parameters that differ from the preset as it suits the exemplar, under their names in files.
    pub overrides: Map<String, Value>,
}
