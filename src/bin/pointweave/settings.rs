//! Words of the command line as a method and its parameters.

use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{Args, ValueEnum};
use glam::DVec2;
use pointweave::methods::Method;
use pointweave::run::{Description, Kind, ParameterError};
use pointweave::{Boundary, Domain};
use serde_json::{Map, Value};

use crate::failure::Failure;

/// `--boundary` and `--exemplar-boundary`.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum BoundaryArgument {
    /// A window: nothing is known beyond the border.
    Open,
    /// A tile: what leaves on one side enters on the other.
    Periodic,
}

impl From<BoundaryArgument> for Boundary {
    fn from(argument: BoundaryArgument) -> Self {
        match argument {
            BoundaryArgument::Open => Self::Open,
            BoundaryArgument::Periodic => Self::Periodic,
        }
    }
}

/// `2` or `2x3`: width and height of the output in those of the exemplar. The range is checked with the parameters.
fn parse_scale(text: &str) -> Result<[f64; 2], String> {
    let number = |word: &str| {
        word.trim()
            .parse::<f64>()
            .map_err(|_| format!("{word:?} is not a number; '2' or '2x3' (width x height) is needed"))
    };
    match text.split_once(['x', 'X', '×']) {
        Some((width, height)) => Ok([number(width)?, number(height)?]),
        None => number(text).map(|both| [both, both]),
    }
}

/// `x0,y0,x1,y1`: lower and upper corner.
pub(crate) fn parse_domain(text: &str) -> Result<Domain, String> {
    let numbers: Vec<f64> = text
        .split([',', ' '])
        .filter(|word| !word.is_empty())
        .map(|word| word.parse().map_err(|_| format!("{word:?} is not a number; 'x0,y0,x1,y1' is needed")))
        .collect::<Result<_, _>>()?;
    let &[x0, y0, x1, y1] = numbers.as_slice() else {
        return Err(format!("it has {} numbers; 'x0,y0,x1,y1' needs 4", numbers.len()));
    };
    Domain::new(DVec2::new(x0, y0), DVec2::new(x1 - x0, y1 - y0)).map_err(|error| error.to_string())
}

/// `name=value`.
fn parse_setting(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() => Ok((name.trim().to_owned(), value.trim().to_owned())),
        _ => Err("'name=value' is needed, as in 'channels=32'".to_owned()),
    }
}

/// What runs and with which parameters: what `synth` and `link encode` have in common.
#[derive(Debug, Args)]
pub(crate) struct MethodArguments {
    /// What makes the result [default: network]
    #[arg(long, value_name = "METHOD", value_parser = methods())]
    method: Option<String>,
    /// Size of the result in sizes of the exemplar: one number, or width x height as in 2x3 [default: 2]
    #[arg(long, value_name = "N|WxH", value_parser = parse_scale)]
    scale: Option<[f64; 2]>,
    /// Trade time for fidelity [default: the method's quickest]
    #[arg(long, value_name = "PRESET", value_parser = presets())]
    preset: Option<String>,
    /// Same seed, same result [default: 1]
    #[arg(long)]
    seed: Option<u64>,
    /// What lies beyond the border of the result [default: the same as beyond the exemplar's]
    #[arg(long, value_enum)]
    boundary: Option<BoundaryArgument>,
    /// Change any parameter, as in --set channels=32; may be repeated (list below)
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = parse_setting)]
    settings: Vec<(String, String)>,
}

/// The names of these arguments, for those that exclude them.
pub(crate) const METHOD_ARGUMENTS: [&str; 6] = ["method", "scale", "preset", "seed", "boundary", "settings"];

/// A method, one of its presets, and what differs from it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Chosen {
    pub(crate) method: Method,
    pub(crate) preset: String,
    pub(crate) overrides: Map<String, Value>,
}

impl MethodArguments {
    /// What was chosen; each name and value is checked against the method's description.
    pub(crate) fn chosen(&self) -> Result<Chosen, Failure> {
        let usage = |error: ParameterError| Failure::Usage(error.to_string());
        let method = self.method.as_deref().map_or(Ok(Method::default()), Method::from_name).map_err(usage)?;
        let description = method.definition().describe();
        let first = description.presets.first().map_or("", |preset| preset.name);
        let preset = self.preset.as_deref().unwrap_or(first).to_owned();
        method.check_preset(&preset).map_err(usage)?;
        let mut overrides = Map::new();
        let mut set = |name: &str, value: Value| -> Result<(), Failure> {
            let parameter = description.parameter(name).ok_or_else(|| unknown(&description, name))?;
            overrides.insert(name.to_owned(), parameter.check(&value).map_err(usage)?);
            Ok(())
        };
        if let Some([width, height]) = self.scale {
            set("expansion-x", width.into())?;
            set("expansion-y", height.into())?;
        }
        if let Some(seed) = self.seed {
            set("seed", seed.into())?;
        }
        if let Some(boundary) = self.boundary {
            set("boundary", Boundary::from(boundary).name().into())?;
        }
        for (name, text) in &self.settings {
            let parameter = description.parameter(name).ok_or_else(|| unknown(&description, name))?;
            set(name, parameter.parse(text).map_err(usage)?)?;
        }
        Ok(Chosen { method, preset, overrides })
    }
}

fn unknown(description: &Description, name: &str) -> Failure {
    let mut known: Vec<&str> = description.parameters.iter().map(|parameter| parameter.name).collect();
    known.sort_unstable();
    Failure::Usage(ParameterError::Unknown { name: name.to_owned(), known: known.join(", ") }.to_string())
}

/// The methods with their words.
fn methods() -> PossibleValuesParser {
    let value = |&method: &Method| {
        let description = method.definition().describe();
        PossibleValue::new(description.name).help(description.meaning)
    };
    PossibleValuesParser::new(Method::ALL.iter().map(value).collect::<Vec<_>>())
}

/// The presets of all methods with their words; one that several methods have stands there once.
fn presets() -> PossibleValuesParser {
    let mut values: Vec<PossibleValue> = Vec::new();
    for preset in Method::ALL.iter().flat_map(|method| method.definition().describe().presets) {
        if values.iter().all(|value| value.get_name() != preset.name) {
            values.push(PossibleValue::new(preset.name).help(preset.meaning));
        }
    }
    PossibleValuesParser::new(values)
}

/// The names, values and meanings of all parameters of all methods, for the help.
pub(crate) fn describe_parameters() -> String {
    Method::ALL.iter().map(|method| describe_method(&method.definition().describe())).collect()
}

fn describe_method(description: &Description) -> String {
    let presets: Vec<&str> = description.presets.iter().map(|preset| preset.name).collect();
    let mut text = format!(
        "Parameters of '{}' for --set, with what they may be and what {} uses:\n",
        description.name,
        presets.join(", ")
    );
    for parameter in description.parameters {
        let word = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        let values: Vec<String> =
            description.presets.iter().map(|preset| word(&preset.parameters[parameter.name])).collect();
        let values =
            if values.iter().all(|value| *value == values[0]) { values[0].clone() } else { values.join(" / ") };
        let allowed = match parameter.kind {
            Kind::Number { min, max, .. } => format!("{min} to {max}"),
            Kind::Choice(choices) => choices.iter().map(|choice| choice.name).collect::<Vec<_>>().join(", "),
        };
        text.push_str(&format!("  {} [{allowed}; {values}]\n      {}\n", parameter.name, parameter.meaning));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What comes of one `--set`.
    fn set(name: &str, value: &str) -> Result<Value, String> {
        let arguments = MethodArguments {
            method: None,
            scale: None,
            preset: None,
            seed: None,
            boundary: None,
            settings: vec![(name.to_owned(), value.to_owned())],
        };
        let chosen = arguments.chosen().map_err(|error| error.to_string())?;
        Ok(chosen.overrides.get(name).cloned().unwrap_or_default())
    }

    #[test]
    fn every_parameter_can_be_set() {
        for parameter in Method::default().definition().describe().parameters {
            match parameter.kind {
                Kind::Number { min, max, .. } => {
                    for value in [min, max] {
                        let stored = set(parameter.name, &value.to_string()).map(|stored| stored.as_f64());
                        assert_eq!(stored, Ok(Some(value)), "{}", parameter.name);
                    }
                }
                Kind::Choice(choices) => {
                    for choice in choices {
                        assert_eq!(set(parameter.name, choice.name), Ok(Value::from(choice.name)));
                    }
                }
            }
        }
    }

    #[test]
    fn wrong_settings_are_named() {
        for (name, value, words) in [
            ("chanels", "8", "no parameter 'chanels'; there are alignment, boundary, channels"),
            ("channels", "3", "'channels' is 3, but must lie between 4 and 160"),
            ("channels", "8.5", "whole number"),
            ("channels", "many", "\"many\", but must be a number"),
            ("frequency", "NaN", "between 0 and 16"),
            ("seed", "-1", "between 0"),
            ("start", "grid", "\"grid\", but must be one of poisson-disk, white-noise"),
            ("class-order", "a-first", "file, largest-first, most-first"),
            ("class-maps", "own", "pooled, separate, each"),
        ] {
            let message = set(name, value).err().unwrap_or_default();
            assert!(message.contains(words), "{name}={value} says {message:?}");
        }
    }

    #[test]
    fn the_help_lists_every_parameter_once() {
        let help = describe_method(&Method::default().definition().describe());
        assert!(describe_parameters().starts_with(&help), "the first method comes first");
        for parameter in Method::default().definition().describe().parameters {
            assert_eq!(help.matches(&format!("  {} [", parameter.name)).count(), 1, "{}", parameter.name);
        }
        assert!(help.contains("  channels [4 to 160; 32 / 32 / 48 / 120]\n      Random filters"), "{help}");
        assert!(help.contains("  boundary [open, periodic; open]"), "{help}");
    }

    #[test]
    fn scales_and_domains() {
        assert_eq!(parse_scale("2"), Ok([2.0, 2.0]));
        assert_eq!(parse_scale("2x0.5"), Ok([2.0, 0.5]));
        assert!(parse_scale("2x").is_err() && parse_scale("two").is_err());
        assert_eq!(parse_domain("-1,0,1,4").map(|domain| domain.size()), Ok(DVec2::new(2.0, 4.0)));
        assert!(parse_domain("0,0,1").is_err() && parse_domain("0,0,0,1").is_err() && parse_domain("0,0,1,b").is_err());
    }
}
