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
use pointweave::method::{Parameters, Preset};
use pointweave::synthesis::{Event, Synthesis};
use pointweave::{PointPattern, gallery};

/// The exemplar and the parameters.
pub(crate) fn plan() -> Result<(PointPattern, Parameters)> {
    let exemplar = gallery::find("rings").context("the gallery has no such exemplar")?.exemplar();
    let parameters = Parameters::suited_to(Preset::Fast, &exemplar);
    Ok((exemplar, parameters))
}

/// The result.
pub(crate) fn run(exemplar: PointPattern, parameters: Parameters) -> Result<PointPattern> {
    let memory_limit = 2_000_000_000;
    let mut synthesis = Synthesis::new(exemplar, parameters, memory_limit)?;
    while !matches!(synthesis.advance()?, Event::Finished) {}
    Ok(synthesis.output()?)
}

fn main() -> Result<()> {
    let (exemplar, parameters) = plan()?;
    let output = run(exemplar, parameters)?;
    fs::write("rings.svg", write_svg(&output, &SvgStyle::default()))?;
    Ok(())
}
