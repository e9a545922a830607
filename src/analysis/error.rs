//! Why a pattern could not be analysed.

use thiserror::Error;

/// Why a statistic can't be had. The messages name the value and what is allowed.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum AnalysisError {
    /// Too few points for the statistic to mean anything.
    #[error("{what} needs at least {needed} points, but there are {count}")]
    TooFewPoints {
        /// The statistic.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many are needed.
        needed: usize,
    },
    /// Too many points for a statistic whose cost grows faster than their number.
    #[error("{what} takes at most {max} points, but there are {count}")]
    TooManyPoints {
        /// The statistic.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many are allowed.
        max: usize,
    },
    /// All points lie in one place: there is no distance to measure anything by.
    #[error("all {count} points lie in one place, so there is no spacing to measure by")]
    NoSpacing {
        /// How many points there are.
        count: usize,
    },
    /// A position is not finite or lies outside the rectangle.
    #[error("point {index} at ({}, {}) does not lie in the rectangle of {} × {}", at[0], at[1], size[0], size[1])]
    Outside {
        /// Which point, from 0.
        index: usize,
        /// Where it is.
        at: [f64; 2],
        /// Width and height.
        size: [f64; 2],
    },
    /// The rectangle has no area.
    #[error("a rectangle of {} × {} can't be used; both sides must be finite and greater than 0", size[0], size[1])]
    Size {
        /// Width and height.
        size: [f64; 2],
    },
    /// A window that statistics can't be taken in.
    #[error("the window can't be used: {reason}")]
    Window {
        /// What is wrong with it.
        reason: String,
    },
    /// One class index a point is needed.
    #[error("there are {count} class indices for {points} points; one a point is needed")]
    Classes {
        /// How many class indices there are.
        count: usize,
        /// How many points there are.
        points: usize,
    },
    /// One mark a point is needed.
    #[error("there are {count} marks for {points} points; one a point is needed")]
    Marks {
        /// How many marks there are.
        count: usize,
        /// How many points there are.
        points: usize,
    },
    /// A mark that is no number.
    #[error("the mark of point {index} is {value}, but must be a finite number")]
    Mark {
        /// Which point, from 0.
        index: usize,
        /// The offending value.
        value: f64,
    },
    /// Products of marks are measured by the square of their mean.
    #[error("the mean of the marks is {mean}, too near 0 for their products to be measured by it")]
    NoMeanMark {
        /// The mean.
        mean: f64,
    },
    /// A class that no point belongs to.
    #[error("no point has class {class}")]
    EmptyClass {
        /// The class index.
        class: u16,
    },
    /// One radius a point is needed.
    #[error("there are {count} radii for {points} points; one a point is needed")]
    Radii {
        /// How many radii there are.
        count: usize,
        /// How many points there are.
        points: usize,
    },
    /// A radius that no disk of the pattern can have.
    #[error("the disk of point {index} has a radius of {value} exemplar units, but it must lie between 0 and {max}")]
    Radius {
        /// Which point, from 0.
        index: usize,
        /// Its radius, in the cloud's unit.
        value: f64,
        /// Largest allowed radius: half of the longer side.
        max: f64,
    },
    /// A number of the settings that can't be used.
    #[error("'{name}' is {value}, but must lie between {min} and {max}")]
    Setting {
        /// What it is called.
        name: &'static str,
        /// The offending value.
        value: f64,
        /// Smallest allowed value.
        min: f64,
        /// Largest allowed value.
        max: f64,
    },
}

/// Refuses a setting that is not within `min … max` (NaN included).
pub(super) fn check(name: &'static str, value: f64, min: f64, max: f64) -> Result<(), AnalysisError> {
    if (min..=max).contains(&value) { Ok(()) } else { Err(AnalysisError::Setting { name, value, min, max }) }
}
