//! What can be wrong with a pattern, its rectangle or a field over it.

use thiserror::Error;

/// Why a pattern was refused. The messages name the value, the place and what is allowed.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PatternError {
    /// The rectangle is not one.
    #[error("the domain from ({}, {}) with sides {} × {} can't be used: {reason}", min[0], min[1], size[0], size[1])]
    Domain {
        /// Lower corner.
        min: [f64; 2],
        /// Width and height.
        size: [f64; 2],
        /// What is wrong with it.
        reason: &'static str,
    },
    /// An outline that is none.
    #[error("the window can't be used: {reason}")]
    Window {
        /// What is wrong with it.
        reason: String,
    },
    /// No rectangle where there must be one.
    #[error("the pattern has no 'domain'")]
    NoDomain,
    /// No points at all.
    #[error("the pattern has no points; at least 1 is needed")]
    Empty,
    /// More points, classes or attributes than the cap.
    #[error("the pattern has {count} {what}; at most {max} are allowed")]
    TooMany {
        /// Points, classes or attributes.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many are allowed.
        max: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("point {index}: {axis} is {value}, but must be a finite number")]
    NotFinite {
        /// Which point, from 0.
        index: usize,
        /// `x`, `y` or the attribute's name.
        axis: String,
        /// The offending value.
        value: f64,
    },
    /// A size below 0.
    #[error("point {index}: {name} is {value}, but a size must be 0 or more")]
    Negative {
        /// Which point, from 0.
        index: usize,
        /// The attribute's name.
        name: String,
        /// The offending value.
        value: f64,
    },
    /// A position lies outside the domain.
    #[error("point {index} at ({}, {}) lies outside the domain ({}, {}) – ({}, {})", at[0], at[1], min[0], min[1], max[0], max[1])]
    Outside {
        /// Which point, from 0.
        index: usize,
        /// Where it is.
        at: [f64; 2],
        /// Lower corner of the domain.
        min: [f64; 2],
        /// Upper corner of the domain.
        max: [f64; 2],
    },
    /// A list does not have one entry a point.
    #[error("{what} has {count} values for {points} points; one value a point is needed")]
    Length {
        /// `classes` or the attribute's name.
        what: String,
        /// How many values there are.
        count: usize,
        /// How many points there are.
        points: usize,
    },
    /// A class index without a class.
    #[error("point {index} has class {class}, but there are only {classes} classes (0 to {})", classes.saturating_sub(1))]
    Class {
        /// Which point, from 0.
        index: usize,
        /// Its class index.
        class: usize,
        /// How many classes there are.
        classes: usize,
    },
    /// A name that can't be used.
    #[error("the name {name:?} can't be used: {reason}")]
    Name {
        /// The offending name.
        name: String,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// A raster of a shape that can't be used.
    #[error("the field with {columns} columns and {cells} cells can't be used: {reason}")]
    Field {
        /// How many columns it has.
        columns: usize,
        /// How many cells it has.
        cells: usize,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// A raster with a value that it must not hold.
    #[error("the field's value in column {column}, row {row} is {value}: {reason}")]
    FieldValue {
        /// Which column, from 0.
        column: usize,
        /// Which row, from 0.
        row: usize,
        /// The offending value.
        value: f64,
        /// What is allowed.
        reason: &'static str,
    },
}
