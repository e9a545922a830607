//! The methods that can be chosen, one room each. This list is the only one: page, command line, links, projects and
//! saved states find a method here by its name.
//!
//! To add a method: write `methods/<name>.rs` or a folder with a [`Definition`] and a [`crate::run::Run`], declare the
//! module, and add a line to the list.

#[cfg(feature = "pretend-method")]
pub mod jitter;
pub mod network;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::pattern::PointPattern;
use crate::run::{Definition, ParameterError, Plan, Run, RunError, StateTag, preset_error};

macro_rules! methods {
    ($($(#[cfg($condition:meta)])? $variant:ident = $name:literal, $definition:expr, $words:literal;)+) => {
        /// A method that can be chosen.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
        pub enum Method {
            $($(#[cfg($condition)])? #[doc = $words] #[serde(rename = $name)] $variant,)+
        }

        impl Method {
            /// All methods, in the order in which they are offered.
            pub const ALL: &[Self] = &[$($(#[cfg($condition)])? Self::$variant),+];

            /// Its name in files, links and on the command line.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $($(#[cfg($condition)])? Self::$variant => $name,)+
                }
            }

            /// What it is and how it is started.
            #[must_use]
            pub fn definition(self) -> &'static dyn Definition {
                match self {
                    $($(#[cfg($condition)])? Self::$variant => &$definition,)+
                }
            }
        }
    };
}

methods! {
    Network = "network", network::Network, "Huang et al. 2022: random filters on Gabor maps.";
    #[cfg(feature = "pretend-method")] Jitter = "jitter", jitter::Jitter, "A pretend method for tests.";
}

#[expect(
    clippy::derivable_impls,
    reason = "a macro writes the list, and an attribute on one of its lines would be one more thing to know"
)]
impl Default for Method {
    fn default() -> Self {
        Self::Network
    }
}

impl Method {
    /// The method of that name.
    ///
    /// # Errors
    /// [`ParameterError::Choice`] when there is none.
    pub fn from_name(name: &str) -> Result<Self, ParameterError> {
        Self::ALL.iter().copied().find(|method| method.name() == name).ok_or_else(|| {
            let names: Vec<&str> = Self::ALL.iter().map(|method| method.name()).collect();
            ParameterError::Choice { name: "method", value: name.to_owned(), choices: names.join(", ") }
        })
    }

    /// Checks that it has a preset of that name.
    ///
    /// # Errors
    /// [`ParameterError::Choice`] when it has not.
    pub fn check_preset(self, name: &str) -> Result<(), ParameterError> {
        let presets: Vec<&str> = self.definition().describe().presets.iter().map(|preset| preset.name).collect();
        if presets.contains(&name) { Ok(()) } else { Err(preset_error(name, &presets)) }
    }

    /// Starts a run of this method. `memory_limit` is in bytes.
    ///
    /// # Errors
    /// Those of [`Definition::start`].
    pub fn start(self, plan: Plan, memory_limit: u64) -> Result<Box<dyn Run>, RunError> {
        self.definition().start(plan, memory_limit)
    }

    /// All parameters of one of its presets as they suit the exemplar, with some replaced.
    ///
    /// # Errors
    /// Those of [`Definition::parameters`].
    pub fn parameters(
        self,
        preset: &str,
        exemplar: &PointPattern,
        overrides: &Map<String, Value>,
    ) -> Result<Map<String, Value>, ParameterError> {
        self.definition().parameters(preset, exemplar, overrides)
    }
}

/// Continues a saved run of whatever method. `memory_limit` is in bytes.
///
/// # Errors
/// When the text is no state, its method is unknown, or the state can't be continued.
pub fn resume(state: &str, memory_limit: u64) -> Result<Box<dyn Run>, RunError> {
    let tag = StateTag::of(state)?;
    Method::from_name(&tag.method)?.definition().resume(state, memory_limit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::{Kind, SHARED_PARAMETERS};

    #[test]
    fn every_method_describes_itself() {
        let mut names: Vec<&str> = Method::ALL.iter().map(|method| method.name()).collect();
        names.dedup();
        assert_eq!(names.len(), Method::ALL.len());
        for &method in Method::ALL {
            let description = method.definition().describe();
            assert_eq!((description.name, Method::from_name(description.name)), (method.name(), Ok(method)));
            for shared in SHARED_PARAMETERS {
                assert!(description.parameter(shared).is_some(), "{} has no '{shared}'", method.name());
            }
            assert!(!description.presets.is_empty());
            for preset in &description.presets {
                for parameter in description.parameters {
                    let value = &preset.parameters[parameter.name];
                    assert!(parameter.check(value).is_ok(), "{} of {}: {value}", parameter.name, preset.name);
                }
            }
            for parameter in description.parameters {
                // Keys of links that are not parameters.
                let taken = ["v", "method", "preset", "presets", "exemplar", "points", "domain", "exemplar-boundary"];
                assert!(!taken.contains(&parameter.name) && !["embed", "hide"].contains(&parameter.name));
                if let Kind::Choice(choices) = parameter.kind {
                    assert!(choices.len() > 1, "{} leaves no choice", parameter.name);
                }
            }
        }
    }

    #[test]
    fn states_find_their_method() {
        let refused = |state: &str| resume(state, 1).map_or_else(|error| error.to_string(), |_| String::new());
        assert!(refused("{}").contains("saved state"), "{}", refused("{}"));
        let unknown = refused(r#"{"method":"weaving","version":1}"#);
        assert!(unknown.contains("'method' is \"weaving\"") && unknown.contains("network"), "{unknown}");
    }
}
