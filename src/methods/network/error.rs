//! Why a run of the network can't start or continue.

use thiserror::Error;

use crate::analysis::AnalysisError;
use crate::pattern::PatternError;
use crate::run::{CanvasError, ParameterError, RunError};

/// Why a run can't start, continue, or be touched.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum NetworkError {
    /// A parameter is out of range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The exemplar, or what would come out, is not a valid pattern.
    #[error(transparent)]
    Pattern(#[from] PatternError),
    /// A radius of the exemplar is none.
    #[error("the exemplar's disks can't be used: {0}")]
    Disks(#[from] AnalysisError),
    /// The exemplar has too little structure to learn from.
    #[error("the exemplar can't be used: {0}")]
    Exemplar(&'static str),
    /// The points fill so little of their domain that no grid holds both.
    #[error(
        "the exemplar's points lie about {times:.0} times closer together than {points} points that fill their domain: the \
         domain is far larger than what the points fill, or points are there twice at slightly different positions; \
         choose the rectangle that the points were cut from as the domain (--domain, or a line '# domain x0 y0 x1 y1'), or \
         remove what is there twice"
    )]
    Crowded {
        /// The spacing of independent points in the domain over that of the points.
        times: f64,
        /// How many points there are.
        points: usize,
    },
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
    /// Values that the output can't carry.
    #[error("these values can't be given to the output's points: {0}")]
    Sources(String),
    /// Points, places or regions that the result at hand does not have.
    #[error("this can't be done to the result: {0}")]
    Canvas(#[from] CanvasError),
    /// Parameters for which the result at hand is no start.
    #[error("this can't be done to the result: {0}")]
    Continue(String),
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

impl From<NetworkError> for RunError {
    fn from(error: NetworkError) -> Self {
        match error {
            NetworkError::Parameter(error) => error.into(),
            NetworkError::Pattern(error) => error.into(),
            other => Self::Method(Box::new(other)),
        }
    }
}
