//! A parameter in its own words: name, range or choices, and where it belongs.

use serde_json::Value;
use thiserror::Error;

/// A parameter that can't be used.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ParameterError {
    /// A number outside its range.
    #[error("parameter '{name}' is {value}, but must lie between {min} and {max}")]
    Range {
        /// The parameter's name, as in files and links.
        name: &'static str,
        /// The offending value.
        value: f64,
        /// Smallest allowed value.
        min: f64,
        /// Largest allowed value.
        max: f64,
    },
    /// A number that must be whole.
    #[error("parameter '{name}' is {value}, but must be a whole number")]
    NotWhole {
        /// The parameter's name, as in files and links.
        name: &'static str,
        /// The offending value.
        value: f64,
    },
    /// No number where there must be one.
    #[error("parameter '{name}' is {value}, but must be a number between {min} and {max}")]
    NotANumber {
        /// The parameter's name, as in files and links.
        name: &'static str,
        /// What is there instead.
        value: String,
        /// Smallest allowed value.
        min: f64,
        /// Largest allowed value.
        max: f64,
    },
    /// Two parameters that contradict each other.
    #[error("parameter '{name}' is {value}, but must be at least '{other}', which is {bound}")]
    Order {
        /// The parameter's name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The parameter it must not fall below.
        other: &'static str,
        /// That parameter's value.
        bound: f64,
    },
    /// A name that is not one of the choices.
    #[error("parameter '{name}' is {value:?}, but must be one of {choices}")]
    Choice {
        /// The parameter's name.
        name: &'static str,
        /// The offending word.
        value: String,
        /// What is allowed.
        choices: String,
    },
    /// No such parameter.
    #[error("there is no parameter '{name}'; there are {known}")]
    Unknown {
        /// The offending name.
        name: String,
        /// What there is.
        known: String,
    },
    /// Parameters that are no set of this method's.
    #[error("the parameters can't be used: {0}")]
    Unreadable(String),
}

/// The parameters that every method has; the page has controls of its own for them.
pub const SHARED_PARAMETERS: [&str; 4] = ["expansion-x", "expansion-y", "boundary", "seed"];

/// Where a parameter stands on the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Always in sight: what is often used.
    Main,
    /// Under *Advanced*.
    Advanced,
}

/// A parameter's name, values and words.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Its name in files, links and on the command line.
    pub name: &'static str,
    /// What the page calls it.
    pub title: &'static str,
    /// The heading it stands under.
    pub group: &'static str,
    /// Where on the page.
    pub place: Place,
    /// Which values it may have.
    pub kind: Kind,
    /// One sentence on what it does.
    pub meaning: &'static str,
}

/// Which values a parameter may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A number.
    Number {
        /// Smallest allowed value.
        min: f64,
        /// Largest allowed value.
        max: f64,
        /// Whether it must be a whole number.
        whole: bool,
    },
    /// A word.
    Choice(&'static [Choice]),
}

/// One of the words that a parameter may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choice {
    /// The word in files, links and on the command line.
    pub name: &'static str,
    /// What the page calls it.
    pub title: &'static str,
    /// One sentence on what it does.
    pub meaning: &'static str,
}

/// Says that there is no preset of that name.
#[must_use]
pub fn preset_error(name: &str, presets: &[&str]) -> ParameterError {
    ParameterError::Choice { name: "preset", value: name.to_owned(), choices: presets.join(", ") }
}

impl Parameter {
    /// A real number.
    #[must_use]
    pub const fn real(name: &'static str, min: f64, max: f64, words: Words, meaning: &'static str) -> Self {
        Self::new(name, Kind::Number { min, max, whole: false }, words, meaning)
    }

    /// A whole number.
    #[must_use]
    pub const fn whole(name: &'static str, min: f64, max: f64, words: Words, meaning: &'static str) -> Self {
        Self::new(name, Kind::Number { min, max, whole: true }, words, meaning)
    }

    /// A word.
    #[must_use]
    pub const fn choice(name: &'static str, choices: &'static [Choice], words: Words, meaning: &'static str) -> Self {
        Self::new(name, Kind::Choice(choices), words, meaning)
    }

    const fn new(name: &'static str, kind: Kind, (place, group, title): Words, meaning: &'static str) -> Self {
        Self { name, title, group, place, kind, meaning }
    }

    /// The value as it stands in files.
    ///
    /// # Errors
    /// When it is of the wrong kind, out of range (NaN is), should be whole and is not, or is not one of the choices.
    pub fn check(&self, value: &Value) -> Result<Value, ParameterError> {
        let name = self.name;
        match self.kind {
            Kind::Number { min, max, whole } => {
                let number = if value.is_null() { Some(f64::NAN) } else { value.as_f64() };
                let Some(number) = number else {
                    return Err(ParameterError::NotANumber { name, value: value.to_string(), min, max });
                };
                self.check_number(number)?;
                if !whole {
                    return Ok(value.clone());
                }
                // In range, hence exact in both.
                Ok(value.as_u64().map_or_else(|| Value::from(number as u64), Value::from))
            }
            Kind::Choice(choices) => {
                let word = value.as_str();
                if choices.iter().any(|choice| word == Some(choice.name)) {
                    return Ok(value.clone());
                }
                let value = word.map_or_else(|| value.to_string(), str::to_owned);
                let names: Vec<&str> = choices.iter().map(|choice| choice.name).collect();
                Err(ParameterError::Choice { name, value, choices: names.join(", ") })
            }
        }
    }

    /// Checks a number that JSON may not be able to hold.
    ///
    /// # Errors
    /// When it is out of range (NaN is), should be whole and is not, or the parameter is a word.
    pub fn check_number(&self, value: f64) -> Result<(), ParameterError> {
        let name = self.name;
        let Kind::Number { min, max, whole } = self.kind else {
            return self.check(&Value::from(value)).map(|_| ());
        };
        // Written so that NaN is refused too.
        if !(value >= min && value <= max) {
            return Err(ParameterError::Range { name, value, min, max });
        }
        if whole && value.fract() != 0.0 {
            return Err(ParameterError::NotWhole { name, value });
        }
        Ok(())
    }

    /// The same for text, as on a command line.
    ///
    /// # Errors
    /// Those of [`Self::check`].
    pub fn parse(&self, text: &str) -> Result<Value, ParameterError> {
        match self.kind {
            Kind::Choice(_) => self.check(&Value::from(text)),
            Kind::Number { min, max, .. } => match text.parse::<f64>() {
                Ok(value) => self.check_number(value).and_then(|()| self.check(&Value::from(value))),
                Err(_) => Err(ParameterError::NotANumber { name: self.name, value: format!("{text:?}"), min, max }),
            },
        }
    }

    /// The allowed value that is nearest to the one given; none when it is of another kind.
    #[must_use]
    pub fn nearest(&self, value: &Value) -> Option<Value> {
        match self.kind {
            Kind::Number { min, max, whole } => {
                let number = value.as_f64().filter(|number| !number.is_nan())?.clamp(min, max);
                Some(if whole { Value::from(number.round() as u64) } else { Value::from(number) })
            }
            Kind::Choice(choices) => {
                choices.iter().find(|choice| value.as_str() == Some(choice.name)).map(|choice| Value::from(choice.name))
            }
        }
    }
}

/// Where a parameter stands on the page, under which heading, and what the page calls it.
pub type Words = (Place, &'static str, &'static str);

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    const COUNT: Parameter = Parameter::whole("count", 4.0, 160.0, (Place::Main, "Size", "Count"), "How many.");
    const SHARE: Parameter = Parameter::real("share", 0.0, 1.0, (Place::Advanced, "Size", "Share"), "How much.");
    const SIDES: [Choice; 2] =
        [Choice { name: "left", title: "Left", meaning: "" }, Choice { name: "right", title: "Right", meaning: "" }];
    const SIDE: Parameter = Parameter::choice("side", &SIDES, (Place::Main, "Size", "Side"), "Which.");

    #[test]
    fn values_in_range_are_kept_as_they_stand_in_files() {
        for (parameter, value, kept) in [
            (COUNT, json!(4), json!(4)),
            (COUNT, json!(160.0), json!(160)),
            (SHARE, json!(0.25), json!(0.25)),
            (SHARE, json!(1), json!(1)),
            (SIDE, json!("right"), json!("right")),
        ] {
            assert_eq!(parameter.check(&value), Ok(kept));
        }
        assert_eq!(COUNT.parse("32"), Ok(json!(32)));
        assert_eq!(SHARE.parse("1e-1"), Ok(json!(0.1)));
        assert_eq!(SIDE.parse("left"), Ok(json!("left")));
    }

    #[test]
    fn others_are_refused_with_the_value_and_what_is_allowed() {
        for (refused, words) in [
            (COUNT.check(&json!(3)), "'count' is 3, but must lie between 4 and 160"),
            (COUNT.check(&json!(8.5)), "'count' is 8.5, but must be a whole number"),
            (COUNT.check(&json!("many")), "'count' is \"many\", but must be a number between 4 and 160"),
            (COUNT.parse("many"), "'count' is \"many\", but must be a number between 4 and 160"),
            (SHARE.parse("NaN"), "'share' is NaN, but must lie between 0 and 1"),
            (SHARE.check(&json!(null)), "'share' is NaN, but must lie between 0 and 1"),
            (SIDE.check(&json!("up")), "'side' is \"up\", but must be one of left, right"),
            (SIDE.check(&json!(3)), "'side' is \"3\", but must be one of left, right"),
        ] {
            let message = refused.map_or_else(|error| error.to_string(), |value| format!("{value} was taken"));
            assert!(message.contains(words), "{message:?} does not say {words:?}");
        }
    }

    #[test]
    fn links_get_the_nearest_value() {
        assert_eq!(COUNT.nearest(&json!(9000)), Some(json!(160)));
        assert_eq!(COUNT.nearest(&json!(8.6)), Some(json!(9)));
        assert_eq!(SHARE.nearest(&json!(-1)), Some(json!(0.0)));
        assert_eq!(SIDE.nearest(&json!("right")), Some(json!("right")));
        assert_eq!((SIDE.nearest(&json!("up")), COUNT.nearest(&json!("8"))), (None, None));
    }
}
