//! A pretend method for tests: in every iteration each point takes a random step.
//!
//! It shows what a method needs to be offered by page and command line: this file, its declaration, and one line in the
//! list of [`crate::methods`]. It is left out of every build without the feature `pretend-method`.

use glam::DVec2;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use crate::pattern::{Boundary, PointPattern, keep_inside};
use crate::run::Place::{Advanced, Main};
use crate::run::{
    Canvas, Choice, Cost, Definition, Description, Edit, Event, LossDescription, Losses, Parameter, ParameterError,
    Plan, PresetDescription, Progress, Run, RunError, Tool, preset_error,
};
use crate::sampling::{Purpose, Rng, white_noise};

const NAME: &str = "jitter";
const PRESET: &str = "quick";
const VERSION: u32 = 1;

const BOUNDARIES: [Choice; 2] = [
    Choice { name: "open", title: "Open", meaning: "A window." },
    Choice { name: "periodic", title: "Periodic", meaning: "A tile." },
];
const PARAMETERS: [Parameter; 6] = [
    Parameter::real(
        "expansion-x",
        0.25,
        8.0,
        (Main, "Size", "Width"),
        "Width of the result in widths of the exemplar.",
    ),
    Parameter::real(
        "expansion-y",
        0.25,
        8.0,
        (Main, "Size", "Height"),
        "Height of the result in heights of the exemplar.",
    ),
    Parameter::whole("seed", 0.0, 9_007_199_254_740_991.0, (Main, "Seed", "Seed"), "Same seed: the same pattern."),
    Parameter::real("stride", 0.0, 0.5, (Advanced, "Walk", "Stride"), "Longest step along x and y, in exemplar units."),
    Parameter::whole("walks", 1.0, 1000.0, (Advanced, "Walk", "Walks"), "How many steps each point takes."),
    Parameter::choice("boundary", &BOUNDARIES, (Main, "Border", "Border"), "What lies beyond the border."),
];

/// The method as it can be chosen.
#[derive(Clone, Copy, Debug)]
pub struct Jitter;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
struct Parameters {
    expansion_x: f64,
    expansion_y: f64,
    seed: u64,
    stride: f64,
    walks: u32,
    boundary: Boundary,
}

#[derive(Debug, Serialize, Deserialize)]
struct State {
    method: String,
    version: u32,
    exemplar: PointPattern,
    parameters: Parameters,
    points: Vec<DVec2>,
    walked: u32,
}

#[derive(Debug)]
struct JitterRun {
    canvas: Canvas,
    parameters: Parameters,
    walked: u32,
}

/// The preset's values, each replaced by what `replace` makes of its parameter.
fn fields(
    preset: &str,
    boundary: Boundary,
    replace: &dyn Fn(&Parameter) -> Result<Option<Value>, ParameterError>,
) -> Result<Map<String, Value>, ParameterError> {
    if preset != PRESET {
        return Err(preset_error(preset, &[PRESET]));
    }
    let defaults = json!({
        "expansion-x": 2.0, "expansion-y": 2.0, "seed": 1, "stride": 0.02, "walks": 5, "boundary": boundary,
    });
    let mut fields = Map::new();
    for parameter in &PARAMETERS {
        let value = replace(parameter)?.unwrap_or_else(|| defaults[parameter.name].clone());
        fields.insert(parameter.name.to_owned(), value);
    }
    Ok(fields)
}

fn typed(fields: Map<String, Value>) -> Result<Parameters, RunError> {
    let parameters = serde_json::from_value(Value::Object(fields));
    Ok(parameters.map_err(|error| ParameterError::Unreadable(error.to_string()))?)
}

impl JitterRun {
    fn new(exemplar: PointPattern, parameters: Parameters) -> Result<Self, RunError> {
        let expansion = DVec2::new(parameters.expansion_x, parameters.expansion_y);
        let count = exemplar.len();
        let mut canvas = Canvas::new(exemplar, expansion, parameters.boundary)?;
        let total = ((count as f64 * expansion.x * expansion.y).round() as usize).max(1);
        let places = white_noise(&mut Rng::new(parameters.seed, Purpose::Start(0)), canvas.size(), total);
        for (point, place) in places.into_iter().enumerate() {
            canvas.add(place, point % count);
        }
        Ok(Self { canvas, parameters, walked: 0 })
    }
}

impl Definition for Jitter {
    fn describe(&self) -> Description {
        Description {
            name: NAME,
            title: "Jitter",
            meaning: "Every point takes random steps. (A pretend method.)",
            presets: vec![PresetDescription {
                name: PRESET,
                title: "Quick",
                meaning: "A few steps.",
                parameters: fields(PRESET, Boundary::Open, &|_| Ok(None)).unwrap_or_default(),
            }],
            parameters: &PARAMETERS,
            tools: &[Tool::Move, Tool::Pin],
            losses: &[LossDescription { name: "unrest", title: "Unrest" }],
        }
    }

    fn parameters(
        &self,
        preset: &str,
        exemplar: &PointPattern,
        overrides: &Map<String, Value>,
    ) -> Result<Map<String, Value>, ParameterError> {
        if let Some(name) = overrides.keys().find(|name| PARAMETERS.iter().all(|parameter| parameter.name != **name)) {
            let known: Vec<&str> = PARAMETERS.iter().map(|parameter| parameter.name).collect();
            return Err(ParameterError::Unknown { name: name.clone(), known: known.join(", ") });
        }
        fields(preset, exemplar.boundary(), &|parameter| {
            overrides.get(parameter.name).map(|value| parameter.check(value)).transpose()
        })
    }

    fn nearest_parameters(
        &self,
        preset: &str,
        exemplar: &PointPattern,
        overrides: &Map<String, Value>,
    ) -> Result<Map<String, Value>, ParameterError> {
        fields(preset, exemplar.boundary(), &|parameter| {
            Ok(overrides.get(parameter.name).and_then(|value| parameter.nearest(value)))
        })
    }

    fn cost(&self, exemplar: &PointPattern, parameters: &Map<String, Value>) -> Option<Cost> {
        let Parameters { expansion_x, expansion_y, walks, .. } = typed(parameters.clone()).ok()?;
        let points = (exemplar.len() as f64 * expansion_x * expansion_y).round() as usize;
        Some(Cost { points, iterations: walks.into(), giga_operations: 0.0, seconds: 0.1 })
    }

    fn start(&self, plan: Plan, _memory_limit: u64) -> Result<Box<dyn Run>, RunError> {
        let parameters = typed(self.parameters(&plan.preset, &plan.exemplar, &plan.overrides)?)?;
        Ok(Box::new(JitterRun::new(plan.exemplar, parameters)?))
    }

    fn resume(&self, state: &str, _memory_limit: u64) -> Result<Box<dyn Run>, RunError> {
        let state: State = serde_json::from_str(state).map_err(|error| RunError::State(error.to_string()))?;
        let mut run = JitterRun::new(state.exemplar, state.parameters)?;
        if state.version != VERSION || state.points.len() != run.canvas.points().len() {
            return Err(RunError::State("it is not one of this version and these points".to_owned()));
        }
        run.canvas.points_mut().copy_from_slice(&state.points);
        run.walked = state.walked;
        Ok(Box::new(run))
    }
}

impl Run for JitterRun {
    fn method(&self) -> &'static str {
        NAME
    }

    fn canvas(&self) -> &Canvas {
        &self.canvas
    }

    fn parameters(&self) -> Map<String, Value> {
        match serde_json::to_value(&self.parameters) {
            Ok(Value::Object(fields)) => fields,
            _ => Map::new(),
        }
    }

    fn advance_by(&mut self, _most: u32) -> Result<Event, RunError> {
        if self.walked == self.parameters.walks {
            return Ok(Event::Finished);
        }
        let mut rng = Rng::new(self.parameters.seed, Purpose::Jitter { class: 0, scale: 0, iteration: self.walked });
        let (size, stride) = (self.canvas.size(), self.parameters.stride);
        let pinned = self.canvas.pinned().to_vec();
        for (point, pinned) in self.canvas.points_mut().iter_mut().zip(pinned) {
            let step = DVec2::new(rng.range(-stride, stride), rng.range(-stride, stride));
            if !pinned {
                *point = keep_inside(*point + step, size, self.parameters.boundary);
            }
        }
        self.walked += 1;
        let losses = Losses::new([("unrest", 1.0 / f64::from(self.walked))]);
        Ok(Event::Iterated { progress: self.progress(), losses })
    }

    fn progress(&self) -> Progress {
        let walks = self.parameters.walks;
        Progress {
            class: 0,
            turn: 0,
            classes: 1,
            scale: 0,
            scales: 1,
            restart: 0,
            restarts: 0,
            redoing: false,
            iteration: self.walked,
            iterations: walks,
            total_iterations: self.walked.into(),
            done: f64::from(self.walked) / f64::from(walks),
        }
    }

    fn edit(&mut self, edit: &Edit) -> Result<(), RunError> {
        let done = match edit {
            Edit::Pin { ids, pinned } => self.canvas.pin(ids, *pinned),
            Edit::Move { ids, places } => self.canvas.place(ids, places),
            Edit::RedoRegion { .. } => return Err(RunError::Unsupported { tool: Tool::RedoRegion, method: NAME }),
        };
        done.map_err(|error| RunError::Method(Box::new(error)))
    }

    fn continue_with(&self, _: &str, _: &Map<String, Value>, _: u64) -> Result<Box<dyn Run>, RunError> {
        Err(RunError::Unsupported { tool: Tool::Continue, method: NAME })
    }

    fn state(&self) -> Result<String, RunError> {
        let state = State {
            method: NAME.to_owned(),
            version: VERSION,
            exemplar: self.canvas.exemplar().clone(),
            parameters: self.parameters.clone(),
            points: self.canvas.points().to_vec(),
            walked: self.walked,
        };
        serde_json::to_string(&state).map_err(|error| RunError::State(error.to_string()))
    }
}
