//! What a method minimises, as named numbers.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

/// One term of the loss, its weight included.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Loss {
    /// Its name, as in the method's description.
    pub name: Cow<'static, str>,
    /// Its value.
    pub value: f64,
}

/// The terms of one iteration, in the order of the method's description.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Losses(pub Vec<Loss>);

impl Losses {
    /// From names and values.
    #[must_use]
    pub fn new<const N: usize>(terms: [(&'static str, f64); N]) -> Self {
        Self(terms.into_iter().map(|(name, value)| Loss { name: Cow::Borrowed(name), value }).collect())
    }

    /// The sum of all terms.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.0.iter().map(|loss| loss.value).sum()
    }

    /// The term of this name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<f64> {
        self.0.iter().find(|loss| loss.name == name).map(|loss| loss.value)
    }
}
