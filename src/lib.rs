//! Pointweave: example-based synthesis of point patterns.
//!
//! A small exemplar (a few dozen to a few hundred points) goes in; a larger pattern with the same structure comes
//! out. The method is that of Huang, Memari, Seidel and Singh, *Point-Pattern Synthesis using Gabor and Random
//! Filters* (EGSR 2022): the points become Gabor maps, the maps go through a bank of random convolutions, and the
//! output points descend the gradient of the distance between the statistics (Gram matrices, deep correlation) of
//! both sides, from a coarse scale to a fine one.
//!
//! The way through, in one direction:
//! `bytes → formats → exemplar → Run (method, plan, seed): edits in, events out → Canvas → analysis, formats → picture or file`.
//!
//! The rooms from bottom to top; none imports one above it (`tests/house.rs`):
//!
//! | module | what lives there |
//! |---|---|
//! | [`pattern`] | the point pattern, its rectangle, fields over it; none can hold an invalid value |
//! | [`sampling`] | the random generator, Poisson-disk and white-noise starts |
//! | [`gallery`] | built-in exemplars, each a seeded generator |
//! | [`analysis`] | statistics of patterns, and how well one reproduces another |
//! | [`finish`] | what puts results right, whatever made them |
//! | [`engine`] | arithmetic of networks on grids: points → statistics → gradient → points |
//! | [`run`] | what all methods share: plan, canvas, edits, events, parameters in words |
//! | [`methods`] | the methods, one room each, and the one list of them |
//! | [`formats`] | bytes ⇄ patterns, pictures, links, projects; one file a format |
//! | [`web`] | what the workers of the page call |

pub mod analysis;
pub mod bench;
pub mod engine;
pub mod finish;
pub mod formats;
pub mod gallery;
pub mod methods;
mod parallel;
pub mod pattern;
pub mod run;
pub mod sampling;
mod sorting;
pub mod web;

pub use pattern::{Attribute, Boundary, Domain, Field, PatternError, PointPattern};
