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
use pointweave::method::{Parameters, Preset};
use pointweave::synthesis::{Event, Synthesis};
use pointweave::{PointPattern, gallery};

/// The exemplar and the parameters.
pub(crate) fn plan() -> Result<(PointPattern, Parameters)> {
    let exemplar = gallery::find("chevrons").context("the gallery has no such exemplar")?.exemplar();
    let mut parameters = Parameters::suited_to(Preset::Fast, &exemplar);
    (parameters.expansion_x, parameters.expansion_y) = (3.0, 1.0);
    parameters.seed = 2;
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
    fs::write("chevrons.svg", write_svg(&output, &SvgStyle::default()))?;
    Ok(())
}
