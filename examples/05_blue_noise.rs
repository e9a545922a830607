//! No order, only a distance that points keep. The result is a window, not a tile: nothing repeats beyond its border.
//!
//! ```sh
//! pointweave synth gallery:blue-noise --boundary open -o blue-noise.svg
//! ```
//!
//! `cargo run --release --example 05_blue_noise` makes the same points.

use std::fs;

use anyhow::{Context, Result};
use pointweave::formats::{SvgStyle, write_svg};
use pointweave::methods::Method;
use pointweave::run::{Event, Plan};
use pointweave::{PointPattern, gallery};
use serde_json::{Map, Value, json};

/// What to learn from, and how.
pub(crate) fn plan() -> Result<Plan> {
    let exemplar = gallery::find("blue-noise").context("the gallery has no such exemplar")?.exemplar();
    let overrides: Map<String, Value> = serde_json::from_value(json!({ "boundary": "open" }))?;
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
    fs::write("blue-noise.svg", write_svg(&output, &SvgStyle::default()))?;
    Ok(())
}
