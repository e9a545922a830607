//! The CPU engine: one file a stage, forward and backward side by side.

pub mod adam;
pub mod convolution;
pub mod correlation;
pub mod gabor;
pub mod gram;
pub mod lanes;
pub mod network;
pub mod normalization;
pub mod parallel;
pub mod product;
pub mod real;
pub mod scratch;
pub mod tile_fft;
