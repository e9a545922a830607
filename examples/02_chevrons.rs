//! A result of another shape, and another seed: three times as wide as the exemplar, as high as it is.
//!
//! ```sh
//! pointweave synth gallery:chevrons --scale 3x1 --seed 2 -o chevrons.svg
//! ```
//!
//! `cargo run --release --example 02_chevrons` makes the same points.

use std::fs;

use anyhow::{Context, Result};
use pointweave::formats::{SvgStyle, write_svg};
use pointweave::methods::Method;
use pointweave::run::{Event, Plan};
use pointweave::{PointPattern, gallery};
use serde_json::{Map, Value, json};

/// What to learn from, and how.
pub(crate) fn plan() -> Result<Plan> {
    let exemplar = gallery::find("chevrons").context("the gallery has no such exemplar")?.exemplar();
    let overrides: Map<String, Value> =
        serde_json::from_value(json!({ "expansion-x": 3.0, "expansion-y": 1.0, "seed": 2 }))?;
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
    fs::write("chevrons.svg", write_svg(&output, &SvgStyle::default()))?;
    Ok(())
}
