//! Where a run stands, and what happened.

use serde::{Deserialize, Serialize};

use super::Losses;

/// Where a run stands. A run goes through classes, scales from coarse to fine, and iterations; a method that lacks one of
/// these has one of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Progress {
    /// Class being placed, from 0, in the order of the exemplar's class names.
    pub class: usize,
    /// How many classes were placed before it.
    pub turn: usize,
    /// How many classes have points.
    pub classes: usize,
    /// Scale being worked on, from 0 (coarse).
    pub scale: usize,
    /// How many scales there are.
    pub scales: usize,
    /// Which try at the worst regions; 0 is the way through all scales that comes before them.
    pub restart: u32,
    /// How many tries there may be.
    pub restarts: u32,
    /// Whether a region is being done again.
    pub redoing: bool,
    /// Iterations done on this scale.
    pub iteration: u32,
    /// Most iterations this scale may take.
    pub iterations: u32,
    /// Iterations done in the whole run.
    pub total_iterations: u64,
    /// Share of the run that is done, 0 to 1, by work; a scale that converges early jumps ahead.
    pub done: f64,
}

/// What happened during one call of [`super::Run::advance_by`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "kebab-case", rename_all_fields = "camelCase")]
pub enum Event {
    /// Part of an iteration is done; nothing to show yet.
    Working,
    /// There is nothing to do before the device reports something: see [`super::Run::wait`].
    Waiting,
    /// A scale begins: targets are computed, the grid is allocated.
    ScaleStarted {
        /// Where the run stands.
        progress: Progress,
        /// The size of the structures it works on, in exemplar units: the width of a Gaussian, say.
        sigma: f64,
        /// Columns and rows of the output's sampling grid.
        grid: [usize; 2],
    },
    /// An iteration is complete: the points have moved.
    Iterated {
        /// Where the run stands.
        progress: Progress,
        /// The loss before the move.
        losses: Losses,
    },
    /// A scale is over.
    ScaleFinished {
        /// Where the run stands.
        progress: Progress,
        /// Whether it converged before its iterations ran out.
        converged: bool,
    },
    /// The device can't be used, or no longer: the run goes on from what came back last, on the processor unless
    /// another device is given to [`super::Run::use_gpu`].
    EngineChanged {
        /// What happened, as a sentence.
        reason: String,
    },
    /// Everything is done.
    Finished,
}
