//! Huang, Memari, Seidel and Singh, *Point-Pattern Synthesis using Gabor and Random Filters* (EGSR 2022).
//!
//! The points become Gabor maps, the maps go through a bank of random convolutions, and the output's points descend the
//! gradient of the distance between the statistics of both sides, from a coarse scale to a fine one. [`crate::engine`]
//! does the arithmetic of one scale; here is what leads through the scales: parameters, the ladder, and the run.

mod cost;
pub mod editions;
mod edits;
mod error;
mod exemplar;
mod finishing;
mod handover;
mod ladder;
mod maps;
mod memory;
pub mod parameters;
mod presets;
mod retries;
mod run;
pub mod schedule;
mod state;

use serde_json::{Map, Value};

use crate::pattern::PointPattern;
use crate::run::{
    Cost, Definition, Description, Edit, Event, LossDescription, ParameterError, Plan, PresetDescription, Progress,
    Run, RunError, Tool,
};

pub use cost::cost;
pub use error::NetworkError;
pub use parameters::Parameters;
pub use presets::Preset;
pub use retries::Best;
pub use run::NetworkRun;
pub use schedule::{Scale, Schedule};
pub use state::{NetworkState, Redo};

/// The method's name in files, links and on the command line.
pub const NAME: &str = "network";

/// The method as it can be chosen.
#[derive(Clone, Copy, Debug)]
pub struct Network;

/// The parameters of a preset as they suit the exemplar, with some replaced.
fn chosen(preset: &str, exemplar: &PointPattern, overrides: &Map<String, Value>) -> Result<Parameters, ParameterError> {
    let parameters = Parameters::suited_to(Preset::from_name(preset)?, exemplar).with_overrides(overrides)?;
    parameters.validate()?;
    Ok(parameters)
}

impl Definition for Network {
    fn describe(&self) -> Description {
        let preset = |preset: Preset| {
            let (title, meaning) = preset.words();
            PresetDescription { name: preset.name(), title, meaning, parameters: Parameters::preset(preset).fields() }
        };
        Description {
            name: NAME,
            title: "Network",
            meaning: "Random filters compare result and exemplar, and the points move until both look alike to them. It \
                      invents: no piece of the exemplar is copied. (Huang et al. 2022)",
            presets: Preset::ALL.into_iter().map(preset).collect(),
            parameters: &parameters::PARAMETERS,
            tools: &[Tool::Move, Tool::Pin, Tool::RedoRegion, Tool::Continue, Tool::Gpu],
            losses: &[
                LossDescription { name: "gram", title: "Gram" },
                LossDescription { name: "correlation", title: "Correlation" },
            ],
        }
    }

    fn parameters(
        &self,
        preset: &str,
        exemplar: &PointPattern,
        overrides: &Map<String, Value>,
    ) -> Result<Map<String, Value>, ParameterError> {
        chosen(preset, exemplar, overrides).map(|parameters| parameters.fields())
    }

    fn nearest_parameters(
        &self,
        preset: &str,
        exemplar: &PointPattern,
        overrides: &Map<String, Value>,
    ) -> Result<Map<String, Value>, ParameterError> {
        Ok(Parameters::suited_to(Preset::from_name(preset)?, exemplar).with_nearest(overrides).fields())
    }

    fn edition(&self) -> u32 {
        editions::EDITION
    }

    fn values_before(&self, edition: u32, preset: &str, exemplar: &PointPattern) -> Vec<(&'static str, Value)> {
        Preset::from_name(preset)
            .map_or_else(|_| Vec::new(), |preset| editions::values_before(edition, preset, exemplar))
    }

    fn cost(&self, exemplar: &PointPattern, parameters: &Map<String, Value>) -> Option<Cost> {
        cost(exemplar, &Parameters::from_fields(parameters.clone()).ok()?)
    }

    fn start(&self, plan: Plan, memory_limit: u64) -> Result<Box<dyn Run>, RunError> {
        let parameters = chosen(&plan.preset, &plan.exemplar, &plan.overrides)?;
        Ok(Box::new(NetworkRun::new(plan.exemplar, parameters, memory_limit)?))
    }

    fn resume(&self, state: &str, memory_limit: u64) -> Result<Box<dyn Run>, RunError> {
        let state: NetworkState = serde_json::from_str(state).map_err(|error| RunError::State(error.to_string()))?;
        Ok(Box::new(NetworkRun::resume(state, memory_limit)?))
    }
}

impl Run for NetworkRun {
    fn method(&self) -> &'static str {
        NAME
    }

    fn canvas(&self) -> &crate::run::Canvas {
        self.canvas()
    }

    fn parameters(&self) -> Map<String, Value> {
        self.parameters().fields()
    }

    fn advance_by(&mut self, most: u32) -> Result<Event, RunError> {
        Ok(self.advance_by(most)?)
    }

    fn has_pending_events(&self) -> bool {
        self.has_pending_events()
    }

    fn progress(&self) -> Progress {
        self.progress()
    }

    fn edit(&mut self, edit: &Edit) -> Result<(), RunError> {
        Ok(self.edit(edit)?)
    }

    fn continue_with(
        &self,
        preset: &str,
        overrides: &Map<String, Value>,
        memory_limit: u64,
    ) -> Result<Box<dyn Run>, RunError> {
        let parameters = chosen(preset, self.exemplar(), overrides)?;
        Ok(Box::new(self.continue_with(parameters, memory_limit)?))
    }

    fn state(&self) -> Result<String, RunError> {
        serde_json::to_string(&self.state()).map_err(|error| RunError::State(error.to_string()))
    }

    fn use_gpu(&mut self, gpu: Option<std::sync::Arc<crate::engine::gpu::Gpu>>, memory: u64) {
        self.use_gpu(gpu, memory);
    }

    fn gpu(&self) -> Option<&std::sync::Arc<crate::engine::gpu::Gpu>> {
        self.gpu()
    }

    #[cfg(not(target_arch = "wasm32"))]
    fn wait(&self) {
        self.wait();
    }
}
