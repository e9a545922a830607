//! Two classes of points: rows of houses, trees between them.
//!
//! ```sh
//! pointweave synth gallery:houses -o houses.svg
//! ```
//!
//! `cargo run --release --example 03_houses` makes the same points.

use std::fs;

use anyhow::{Context, Result};
use pointweave::formats::{SvgStyle, write_svg};
use pointweave::methods::Method;
use pointweave::run::{Event, Plan};
use pointweave::{PointPattern, gallery};
use serde_json::Map;

/// What to learn from, and how.
pub(crate) fn plan() -> Result<Plan> {
    let exemplar = gallery::find("houses").context("the gallery has no such exemplar")?.exemplar();
    Ok(Plan { exemplar, preset: "fast".to_owned(), overrides: Map::new() })
}

/// The result.
pub(crate) fn run(plan: Plan) -> Result<PointPattern> {
    let memory_limit = 2_000_000_000;
    let mut run = Method::Network.start(plan, memory_limit)?;
    while run.advance_by(u32::MAX)? != Event::Finished {}
    Ok(run.canvas().pattern()?)
}

fn main() -> Result<()> {
    let output = run(plan()?)?;
    fs::write("houses.svg", write_svg(&output, &SvgStyle::default()))?;
    Ok(())
}
