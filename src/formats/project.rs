//! A whole session in one JSON file, without loss: the exemplar, what was chosen, the output, and the run as it stood, so
//! that it goes on as the very same run.
//!
//! ```json
//! {"pointweave-project": 1, "title": "Rings", "method": "network", "preset": "fast", "overrides": {"seed": 7}, "exemplar": {…},
//!  "output": {…}, "run": {…}}
//! ```
//! `exemplar` and `output` are patterns as [`write_json`](super::write_json) writes them. `run` is a
//! state ([`Run::state`](crate::run::Run::state)) without its exemplar, which stands beside it; it is checked by whoever
//! continues it. `output` and `run` may be missing; without `method` it is the network.

use serde_json::{Map, Value, json};

use super::error::clip;
use super::json::{layout, layout_at, located, member_place, misfit};
use super::{FileFormat, FormatError, Note, Origin, ReadOptions, Reading};
use crate::methods::Method;
use crate::pattern::{PointPattern, RawPattern};

const MARK: &str = "pointweave-project";
const VERSION: u64 = 1;
/// Longest title, in characters.
const MAX_TITLE_LENGTH: usize = 200;

/// What a session holds beside its exemplar.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Project {
    /// What the person calls it.
    pub title: String,
    /// The method that was chosen.
    pub method: Method,
    /// Name of the preset that was chosen.
    pub preset: String,
    /// Parameters that differ from it, under their names in files, in their ranges.
    pub overrides: Map<String, Value>,
    /// How the exemplar's file named and placed things.
    pub origin: Origin,
    /// The output as it stood.
    pub output: Option<PointPattern>,
    /// The run as it stood: what [`Run::state`](crate::run::Run::state) gave.
    pub state: Option<String>,
}

pub(super) fn is_project(object: &Map<String, Value>) -> bool {
    object.contains_key(MARK)
}

pub(super) fn read(text: &str, mut object: Map<String, Value>, options: &ReadOptions) -> Result<Reading, FormatError> {
    if object.get(MARK).and_then(Value::as_u64) != Some(VERSION) {
        let found = object.get(MARK).map(Value::to_string).unwrap_or_default();
        let message = format!("it is a project of version {}; this program reads {VERSION}", clip(&found));
        return Err(layout(text, &[MARK], message));
    }
    let exemplar =
        object.remove("exemplar").ok_or_else(|| layout(text, &[], "the project has no 'exemplar'".to_owned()))?;
    let state = match object.remove("run") {
        Some(Value::Object(mut run)) => {
            // The exemplar as it was written, whatever the caller says about its domain.
            run.insert("exemplar".to_owned(), exemplar.clone());
            Some(Value::Object(run).to_string())
        }
        None | Some(Value::Null) => None,
        Some(_) => return Err(layout(text, &["run"], "'run' of the project must be an object".to_owned())),
    };
    let pattern = pattern(text, "exemplar", exemplar)?;
    let output = match object.remove("output") {
        None | Some(Value::Null) => None,
        Some(value) => Some(self::pattern(text, "output", value)?),
    };
    let word = |name: &str| object.get(name).and_then(Value::as_str).unwrap_or_default();
    let method = match word("method") {
        "" => Method::default(),
        name => Method::from_name(name).map_err(|error| layout(text, &["method"], error.to_string()))?,
    };
    let description = method.definition().describe();
    let preset = match word("preset") {
        "" => description.presets.first().map_or_else(String::new, |preset| preset.name.to_owned()),
        name => {
            method.check_preset(name).map_err(|error| layout(text, &["preset"], error.to_string()))?;
            name.to_owned()
        }
    };
    let title = word("title").chars().take(MAX_TITLE_LENGTH).collect();
    let mut notes = Vec::new();
    let mut overrides = Map::new();
    if let Some(Value::Object(chosen)) = object.get("overrides") {
        for (name, value) in chosen {
            match description.parameter(name).and_then(|parameter| parameter.nearest(value)) {
                Some(allowed) => {
                    if allowed.as_f64() != value.as_f64() {
                        notes.push(Note::changed(format!(
                            "'{name}' was {value}, which is out of its range; it is {allowed} now."
                        )));
                    }
                    overrides.insert(name.clone(), allowed);
                }
                None => {
                    notes.push(Note::left_out(format!("There is no parameter '{}' with such a value.", clip(name))));
                }
            }
        }
    }
    let pattern = options.apply(pattern).map_err(|error| misfit(text, &["exemplar"], &error))?;
    let mut reading = Reading::new(FileFormat::Project, pattern);
    reading.is_domain_declared = true;
    reading.notes = notes;
    // A member of a stranger's file: what it can't be, it is not.
    let origin: Origin =
        object.remove("origin").and_then(|value| serde_json::from_value(value).ok()).unwrap_or_default();
    reading.origin = origin.clone();
    reading.project = Some(Project { title, method, preset, overrides, origin, output, state });
    Ok(reading)
}

/// A member that is a pattern.
fn pattern(text: &str, name: &str, value: Value) -> Result<PointPattern, FormatError> {
    let raw: RawPattern = serde_json::from_value(value).map_err(|error| {
        let message = format!("'{name}' of the project: {error}");
        layout_at(member_place(text, &[name]), message)
    })?;
    PointPattern::try_from(raw).map_err(|error| misfit(text, &[name], &error))
}

/// Writes a session as JSON that reads back without loss.
///
/// # Errors
/// When `project.state` is not JSON.
pub fn write_project(exemplar: &PointPattern, project: &Project) -> Result<String, FormatError> {
    let value = |pattern: &PointPattern| serde_json::to_value(pattern).map_err(|error| located(&error));
    let run = match &project.state {
        None => None,
        Some(state) => {
            let mut run: Map<String, Value> = serde_json::from_str(state).map_err(|error| located(&error))?;
            run.remove("exemplar");
            Some(run)
        }
    };
    let output = project.output.as_ref().map(value).transpose()?;
    let whole = json!({
        MARK: VERSION, "title": project.title, "method": project.method, "preset": project.preset, "overrides": project.overrides,
        "exemplar": value(exemplar)?, "origin": project.origin, "output": output, "run": run,
    });
    Ok(whole.to_string() + "\n")
}
