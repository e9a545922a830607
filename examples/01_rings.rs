//! A larger pattern from a small one, with the default settings: twice as wide, twice as high.
//!
//! ```sh
//! pointweave synth gallery:rings -o rings.svg
//! ```
//!
//! `cargo run --release --example 01_rings` makes the same points.

use std::fs;

use anyhow::{Context, Result};
use pointweave::formats::{SvgStyle, write_svg};
use pointweave::methods::Method;
use pointweave::run::{Event, Plan};
use pointweave::{PointPattern, gallery};
use serde_json::Map;

/// What to learn from, and how.
pub(crate) fn plan() -> Result<Plan> {
    let exemplar = gallery::find("rings").context("the gallery has no such exemplar")?.exemplar();
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
    fs::write("rings.svg", write_svg(&output, &SvgStyle::default()))?;
    Ok(())
}
