//! Pointweave: example-based synthesis of point patterns.
//!
//! A small exemplar (a few dozen to a few hundred points) goes in; a larger pattern with the same structure comes
//! out. The method is that of Huang, Memari, Seidel and Singh, *Point-Pattern Synthesis using Gabor and Random
//! Filters* (EGSR 2022): the points become Gabor maps, the maps go through a bank of random convolutions, and the
//! output points descend the gradient of the distance between the statistics (Gram matrices, deep correlation) of
//! both sides, from a coarse scale to a fine one.
//!
//! The way through, in one direction:
//! `bytes → formats → PointPattern → synthesis → engine → PointPattern → formats → picture or file`.
//!
//! | module | what lives there |
//! |---|---|
//! | [`pattern`], [`domain`] | the point pattern and its rectangle; neither can hold an invalid value |
//! | [`formats`] | bytes ⇄ pattern, one file a format |
//! | [`gallery`] | built-in exemplars, each a seeded generator |
//! | [`sampling`] | the random generator, Poisson-disk and white-noise starts |
//! | [`analysis`] | statistics of patterns, and how well one reproduces another |
//! | [`method`] | the paper as data both engines share: parameters, presets, scale ladder, filter bank |
//! | [`engine`] | points → statistics → gradient → points |
//! | [`synthesis`] | the run as a state machine: classes × scales × iterations |
//! | [`web`] | what the worker of the page calls |

pub mod analysis;
pub mod bench;
pub mod domain;
pub mod engine;
pub mod formats;
pub mod gallery;
pub mod method;
mod parallel;
pub mod pattern;
pub mod sampling;
mod sorting;
pub mod synthesis;
pub mod web;

pub use domain::{Boundary, Domain};
pub use pattern::{Attribute, PatternError, PointPattern};
