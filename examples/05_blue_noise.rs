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
use pointweave::method::{Parameters, Preset};
use pointweave::synthesis::{Event, Synthesis};
use pointweave::{Boundary, PointPattern, gallery};

/// The exemplar and the parameters.
pub(crate) fn plan() -> Result<(PointPattern, Parameters)> {
    let exemplar = gallery::find("blue-noise").context("the gallery has no such exemplar")?.exemplar();
    let mut parameters = Parameters::suited_to(Preset::Fast, &exemplar);
    parameters.boundary = Boundary::Open;
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
    fs::write("blue-noise.svg", write_svg(&output, &SvgStyle::default()))?;
    Ok(())
}
