//! A method in its own words: page, command line help and link reader are built from this.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::Parameter;

/// A method's name, words, parameters, presets, tools and losses.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// Its name in files, links and on the command line.
    pub name: &'static str,
    /// What the page calls it.
    pub title: &'static str,
    /// One or two sentences on what it does.
    pub meaning: &'static str,
    /// Quickest first.
    pub presets: Vec<PresetDescription>,
    /// In the order in which links write them.
    pub parameters: &'static [Parameter],
    /// What hands can do to its results.
    pub tools: &'static [Tool],
    /// The terms of its loss, in the order of [`super::Losses`].
    pub losses: &'static [LossDescription],
}

impl Description {
    /// The parameter of this name.
    #[must_use]
    pub fn parameter(&self, name: &str) -> Option<&'static Parameter> {
        self.parameters.iter().find(|parameter| parameter.name == name)
    }
}

/// A set of parameters under a name.
#[derive(Clone, Debug, PartialEq)]
pub struct PresetDescription {
    /// Its name in files, links and on the command line.
    pub name: &'static str,
    /// What the button says.
    pub title: &'static str,
    /// One sentence on what to expect.
    pub meaning: &'static str,
    /// The numbers behind it, for an exemplar that asks for nothing special.
    pub parameters: Map<String, Value>,
}

/// A term of the loss.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LossDescription {
    /// Its name in messages.
    pub name: &'static str,
    /// What the page calls it.
    pub title: &'static str,
}

/// What can be done to a result by hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Tool {
    /// Points can be put elsewhere.
    Move,
    /// Points can be held where they are.
    Pin,
    /// A region can be done again while the rest stays.
    RedoRegion,
    /// A run can go on with other parameters.
    Continue,
    /// A graphics card can compute.
    Gpu,
}

impl Tool {
    /// Its name in messages.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Move => "move",
            Self::Pin => "pin",
            Self::RedoRegion => "redo-region",
            Self::Continue => "continue",
            Self::Gpu => "gpu",
        }
    }
}

/// What a run would take, known before it begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Points of the output.
    pub points: usize,
    /// Iterations at most.
    pub iterations: u64,
    /// Floating-point operations, in 10⁹.
    pub giga_operations: f64,
    /// Seconds in a browser on a processor, roughly.
    pub seconds: f64,
}
