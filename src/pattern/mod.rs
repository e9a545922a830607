//! Patterns and what they live in: points with classes and attributes, their rectangle, and fields over it.
//!
//! None of these types can hold an invalid value: whoever has one need not check it again.

mod domain;
mod error;
mod field;
mod point_pattern;
mod window;

pub(crate) use domain::keep_inside;
pub use domain::{Boundary, Domain};
pub use error::PatternError;
pub use field::{Field, FieldKind, MAX_FIELD_SIDE};
pub use point_pattern::{
    Attribute, DEPTH_ATTRIBUTE, MAX_ATTRIBUTES, MAX_CLASSES, MAX_NAME_LENGTH, MAX_POINTS, Meaning,
    ORIENTATION_ATTRIBUTE, PointPattern, RADIUS_ATTRIBUTE, SCALE_ATTRIBUTE,
};
pub(crate) use point_pattern::{RawPattern, check_name, mean_nearest_distance};
pub(crate) use window::convex_hull;
pub use window::{MAX_CORNERS, Window, WindowIndex};
