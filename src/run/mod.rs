//! What all methods share: how a method is described, started, driven, touched and saved.
//!
//! A method is a [`Definition`]; the list of them is [`crate::methods::Method`]. A definition starts a [`Run`] from a
//! [`Plan`]. Whoever drives a run (command line, worker of the page, test) calls [`Run::advance_by`] again and again;
//! each call does one bounded piece of work and returns an [`Event`]. So pause and cancel need no flags, and the page
//! pulls at its own pace. The points stand on the run's [`Canvas`]; hands change them through [`Edit`].

mod canvas;
mod describe;
mod edit;
mod event;
mod losses;
mod parameter;
mod plan;
mod state;

use std::fmt::Debug;
use std::sync::Arc;

use serde_json::{Map, Value};
use thiserror::Error;

use crate::engine::gpu::Gpu;
use crate::pattern::{PatternError, PointPattern};

pub use canvas::{Canvas, CanvasError};
pub use describe::{Cost, Description, LossDescription, PresetDescription, Tool};
pub use edit::Edit;
pub use event::{Event, Progress};
pub use losses::{Loss, Losses};
pub use parameter::{Choice, Kind, Parameter, ParameterError, Place, SHARED_PARAMETERS, Words, preset_error};
pub use plan::Plan;
pub use state::{DEFAULT_METHOD, StateTag};

/// Why a run can't start, go on, or be touched.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RunError {
    /// A parameter is unknown or out of range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The exemplar, or what would come out, is not a valid pattern.
    #[error(transparent)]
    Pattern(#[from] PatternError),
    /// A saved state that is none.
    #[error("the saved state can't be read: {0}")]
    State(String),
    /// Something that the method can't do; its description says so.
    #[error("the method '{method}' can't do this: it has no '{}'", tool.name())]
    Unsupported {
        /// What is missing.
        tool: Tool,
        /// Name of the method.
        method: &'static str,
    },
    /// The method's own reason.
    #[error(transparent)]
    Method(Box<dyn std::error::Error + Send + Sync>),
}

/// A method that can be chosen. It knows nothing of files, pages or the command line.
pub trait Definition: Sync {
    /// What it is called, what it can do, and which parameters it has.
    fn describe(&self) -> Description;

    /// All parameters of a preset as they suit the exemplar, with some replaced, under their names in files.
    ///
    /// # Errors
    /// When there is no such preset or parameter, a value is of the wrong kind or out of range, or two contradict each
    /// other.
    fn parameters(
        &self,
        preset: &str,
        exemplar: &PointPattern,
        overrides: &Map<String, Value>,
    ) -> Result<Map<String, Value>, ParameterError>;

    /// The same with what can't be used left out, and every value moved to the nearest one that is allowed: for links.
    ///
    /// # Errors
    /// When there is no such preset.
    fn nearest_parameters(
        &self,
        preset: &str,
        exemplar: &PointPattern,
        overrides: &Map<String, Value>,
    ) -> Result<Map<String, Value>, ParameterError>;

    /// The edition of the presets' values; links say which one they mean.
    fn edition(&self) -> u32 {
        1
    }

    /// What of a preset was different for this exemplar in an earlier edition, under the names in files.
    fn values_before(&self, _edition: u32, _preset: &str, _exemplar: &PointPattern) -> Vec<(&'static str, Value)> {
        Vec::new()
    }

    /// What a run with these parameters would take; none when the exemplar has too little structure.
    fn cost(&self, exemplar: &PointPattern, parameters: &Map<String, Value>) -> Option<Cost>;

    /// Starts a run. `memory_limit` is in bytes.
    ///
    /// # Errors
    /// When a parameter or the exemplar can't be used, or the run would not fit.
    fn start(&self, plan: Plan, memory_limit: u64) -> Result<Box<dyn Run>, RunError>;

    /// Continues a run from the text that [`Run::state`] gave. `memory_limit` is in bytes.
    ///
    /// # Errors
    /// When the state is of another version or does not fit together, or the run would not fit.
    fn resume(&self, state: &str, memory_limit: u64) -> Result<Box<dyn Run>, RunError>;
}

/// What can go to another thread. In a browser nothing has to, and a device there can't.
#[cfg(not(target_arch = "wasm32"))]
pub trait Portable: Send {}
#[cfg(not(target_arch = "wasm32"))]
impl<T: Send> Portable for T {}
/// What can go to another thread. In a browser nothing has to, and a device there can't.
#[cfg(target_arch = "wasm32")]
pub trait Portable {}
#[cfg(target_arch = "wasm32")]
impl<T> Portable for T {}

/// A run of some method. Same exemplar, parameters and seed: the same points.
pub trait Run: Debug + Portable {
    /// The name of its method, as in files.
    fn method(&self) -> &'static str;

    /// The points and what they stand on.
    fn canvas(&self) -> &Canvas;

    /// All parameters, under their names in files.
    fn parameters(&self) -> Map<String, Value>;

    /// Does one bounded piece of work, well under a second. On a device, which is given work ahead of what is seen of
    /// it, no more than `most` iterations are begun.
    ///
    /// # Errors
    /// When the run can't go on; its points are those of the last complete iteration.
    fn advance_by(&mut self, most: u32) -> Result<Event, RunError>;

    /// Whether events that came together have not all been returned yet.
    fn has_pending_events(&self) -> bool {
        false
    }

    /// Where the run stands.
    fn progress(&self) -> Progress;

    /// Changes the result by hand.
    ///
    /// # Errors
    /// When the edit can't be done; nothing has changed then.
    fn edit(&mut self, edit: &Edit) -> Result<(), RunError>;

    /// The same method with other parameters, from the points as they are. `memory_limit` is in bytes.
    ///
    /// # Errors
    /// When a parameter can't be used, or the points are no start for it.
    fn continue_with(
        &self,
        preset: &str,
        overrides: &Map<String, Value>,
        memory_limit: u64,
    ) -> Result<Box<dyn Run>, RunError>;

    /// Everything needed to continue later, bit for bit: JSON whose first members are those of [`StateTag`].
    ///
    /// # Errors
    /// When it can't be written.
    fn state(&self) -> Result<String, RunError>;

    /// Computes on this device from now on, with buffers of up to `memory` bytes; with none, on the processor. Methods
    /// without [`Tool::Gpu`] stay on the processor.
    fn use_gpu(&mut self, _gpu: Option<Arc<Gpu>>, _memory: u64) {}

    /// The device in use.
    fn gpu(&self) -> Option<&Arc<Gpu>> {
        None
    }

    /// Waits for the device after [`Event::Waiting`]; the whole program waits. In a browser a worker has to wait for
    /// [`Gpu::report`] instead.
    #[cfg(not(target_arch = "wasm32"))]
    fn wait(&self) {}
}
