//! Words of the command line as parameters of the method.

use clap::ValueEnum;
use glam::DVec2;
use pointweave::method::{ParameterError, Parameters, Preset};
use pointweave::{Boundary, Domain};
use serde_json::Value;

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

/// `--preset`.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum PresetArgument {
    /// Seconds: few channels, a grid just fine enough.
    Fast,
    /// A minute or two: more iterations, and three other tries at the worst regions.
    Balanced,
    /// Many minutes: more channels, a finer grid, and many tries at the worst regions.
    Best,
    /// The numbers of the paper, on its fine grid: long.
    Paper,
}

impl From<PresetArgument> for Preset {
    fn from(argument: PresetArgument) -> Self {
        match argument {
            PresetArgument::Fast => Self::Fast,
            PresetArgument::Balanced => Self::Balanced,
            PresetArgument::Best => Self::Best,
            PresetArgument::Paper => Self::Paper,
        }
    }
}

/// `2` or `2x3`: width and height of the output in those of the exemplar. The range is checked with the parameters.
pub(crate) fn parse_scale(text: &str) -> Result<[f64; 2], String> {
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
pub(crate) fn parse_setting(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() => Ok((name.trim().to_owned(), value.trim().to_owned())),
        _ => Err("'name=value' is needed, as in 'channels=32'".to_owned()),
    }
}

/// The parameters with `--set`'s changes; each name is one of the fields as they stand in files.
pub(crate) fn apply(parameters: Parameters, settings: &[(String, String)]) -> Result<Parameters, Failure> {
    let unreadable = |error: serde_json::Error| Failure::Run(format!("the parameters can't be changed: {error}"));
    let mut parameters = parameters;
    for (name, text) in settings {
        let mut fields = serde_json::to_value(&parameters).map_err(unreadable)?;
        let known: Vec<String> = fields.as_object().into_iter().flat_map(|map| map.keys().cloned()).collect();
        let Some(field) = fields.get_mut(name) else {
            return Err(Failure::Usage(format!("there is no parameter '{name}'; there are {}", known.join(", "))));
        };
        *field = if field.is_string() { Value::String(text.clone()) } else { number(name, text)? };
        // Numbers are checked by now; what is left are words that are not among the choices.
        parameters = serde_json::from_value(fields)
            .map_err(|error| Failure::Usage(format!("parameter '{name}' is {text:?}: {error}")))?;
    }
    Ok(parameters)
}

/// A number of the parameter's range, whole where it must be.
fn number(name: &str, text: &str) -> Result<Value, Failure> {
    let refuse = |error: ParameterError| Err(Failure::Usage(error.to_string()));
    let value: f64 =
        text.parse().map_err(|_| Failure::Usage(format!("parameter '{name}' is {text:?}, but must be a number")))?;
    if let Some(range) = Parameters::RANGES.iter().find(|range| range.name == name) {
        if !(value >= range.min && value <= range.max) {
            return refuse(ParameterError::Range { name: range.name, value, min: range.min, max: range.max });
        }
        if range.whole {
            if value.fract() != 0.0 {
                return refuse(ParameterError::NotWhole { name: range.name, value });
            }
            // In range, hence exact in both.
            return Ok(Value::from(value as u64));
        }
    }
    Ok(Value::from(value))
}

/// The names, ranges and meanings of all numeric parameters, for the help.
pub(crate) fn describe_parameters() -> String {
    let defaults = Preset::ALL.map(|preset| serde_json::to_value(Parameters::preset(preset)).unwrap_or_default());
    let mut text =
        String::from("Parameters for --set, with their range and what fast, balanced, best and paper use:\n");
    for range in Parameters::RANGES {
        let values: Vec<String> = defaults.iter().map(|fields| fields[range.name].to_string()).collect();
        let values =
            if values.iter().all(|value| *value == values[0]) { values[0].clone() } else { values.join(" / ") };
        text.push_str(&format!(
            "  {} [{} to {}; {values}]\n      {}\n",
            range.name, range.min, range.max, range.meaning
        ));
    }
    text.push_str(
        "  boundary [open, periodic]\n  start [poisson-disk, white-noise]\n  learning-rate-unit [output-side, sigma]\n  \
         class-order [file, largest-first, most-first]\n  class-maps [pooled, separate, each]\n",
    );
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(name: &str, value: &str) -> Result<Parameters, String> {
        apply(Parameters::preset(Preset::Fast), &[(name.to_owned(), value.to_owned())])
            .map_err(|error| error.to_string())
    }

    #[test]
    fn every_parameter_can_be_set() {
        for range in Parameters::RANGES {
            for value in [range.min, range.max] {
                let changed =
                    set(range.name, &value.to_string()).map(|parameters| serde_json::to_value(parameters).ok());
                let stored = changed.ok().flatten().and_then(|fields| fields[range.name].as_f64());
                assert_eq!(stored, Some(value), "{}", range.name);
            }
        }
        assert_eq!(set("boundary", "periodic").map(|parameters| parameters.boundary), Ok(Boundary::Periodic));
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
            ("start", "grid", "unknown variant `grid`"),
            ("class-order", "a-first", "`file`, `largest-first`, `most-first`"),
            ("class-maps", "own", "`pooled`, `separate`, `each`"),
        ] {
            let message = set(name, value).err().unwrap_or_default();
            assert!(message.contains(words), "{name}={value} says {message:?}");
        }
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
