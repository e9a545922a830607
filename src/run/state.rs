//! The envelope of a saved state: which method it belongs to, and the version of its layout.

use serde::Deserialize;

use super::RunError;

/// What states without a method belong to: they are older than the second method.
pub const DEFAULT_METHOD: &str = "network";

/// The members that every saved state begins with. The others are the method's own.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct StateTag {
    /// Name of the method.
    #[serde(default = "default_method")]
    pub method: String,
    /// Version of the method's layout.
    pub version: u32,
}

fn default_method() -> String {
    DEFAULT_METHOD.to_owned()
}

impl StateTag {
    /// Reads the tag of a state and nothing else.
    ///
    /// # Errors
    /// [`RunError::State`] when the text is no state.
    pub fn of(state: &str) -> Result<Self, RunError> {
        serde_json::from_str(state).map_err(|error| RunError::State(error.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_says_whose_it_is() {
        let of = |text| StateTag::of(text).map(|tag| (tag.method, tag.version)).map_err(|error| error.to_string());
        assert_eq!(of(r#"{"method":"patches","version":1,"points":[]}"#), Ok(("patches".to_owned(), 1)));
        assert_eq!(of(r#"{"version":2,"exemplar":{}}"#), Ok(("network".to_owned(), 2)));
        assert!(
            of("{}")
                .is_err_and(|message| message.contains("the saved state can't be read") && message.contains("version"))
        );
    }
}
