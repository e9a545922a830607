//! The method of Huang et al. 2022 as data and arithmetic both engines share. No I/O and no device in here.

pub mod alignment;
pub mod bands;
pub mod cost;
pub mod disks;
pub mod editions;
pub mod filters;
pub mod parameters;
pub mod repair;
pub mod restart;
pub mod schedule;
pub mod transplant;
pub mod values;

pub use bands::{Bands, Weights};
pub use cost::Cost;
pub use filters::FilterBank;
pub use parameters::{ParameterError, Parameters, Preset};
pub use schedule::{Scale, Schedule};
