//! Points with an attribute: every boat has an orientation, which the result follows.
//!
//! ```sh
//! pointweave synth gallery:boats --scale 3x1 -o boats.svg
//! ```
//!
//! `cargo run --release --example 04_boats` makes the same points.

use std::fs;

use anyhow::{Context, Result};
use pointweave::formats::{SvgStyle, write_svg};
use pointweave::methods::Method;
use pointweave::run::{Event, Plan};
use pointweave::{PointPattern, gallery};
use serde_json::{Map, Value, json};

/// What to learn from, and how.
pub(crate) fn plan() -> Result<Plan> {
    let exemplar = gallery::find("boats").context("the gallery has no such exemplar")?.exemplar();
    let overrides: Map<String, Value> = serde_json::from_value(json!({ "expansion-x": 3.0, "expansion-y": 1.0 }))?;
    Ok(Plan { exemplar, preset: "fast".to_owned(), overrides })
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
    fs::write("boats.svg", write_svg(&output, &SvgStyle::default()))?;
    Ok(())
}
