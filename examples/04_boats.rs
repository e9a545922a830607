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
use pointweave::method::{Parameters, Preset};
use pointweave::synthesis::{Event, Synthesis};
use pointweave::{PointPattern, gallery};

/// The exemplar and the parameters.
pub(crate) fn plan() -> Result<(PointPattern, Parameters)> {
    let exemplar = gallery::find("boats").context("the gallery has no such exemplar")?.exemplar();
    let mut parameters = Parameters::suited_to(Preset::Fast, &exemplar);
    (parameters.expansion_x, parameters.expansion_y) = (3.0, 1.0);
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
    fs::write("boats.svg", write_svg(&output, &SvgStyle::default()))?;
    Ok(())
}
