//! What a run would take, known before it begins.

use glam::DVec2;

use super::{Parameters, Schedule};
use crate::engine::view::direct_operations;
use crate::pattern::{Boundary, PointPattern};
use crate::run::Cost;

/// Operations of direct convolution a second that one thread of a browser is worth: 60 to 160 · 10⁹ were seen, the
/// fewer the fewer channels.
const BROWSER_RATE: f64 = 80e9;

/// What a run with this exemplar would take at most, as scales may converge early; none where it has no spacing, so that
/// there is nothing to run. Operations are those of the convolutions done directly, seconds are on one thread of a
/// browser, to a factor of two or three.
#[must_use]
pub fn cost(exemplar: &PointPattern, parameters: &Parameters) -> Option<Cost> {
    let spacing = exemplar.mean_spacing()?;
    let size = exemplar.domain().size_in_exemplar_units();
    let output_size = size * DVec2::new(parameters.expansion_x, parameters.expansion_y);
    let density = exemplar.len() as f64 / (size.x * size.y);
    let classes = exemplar.class_names().len() as f64;
    let (mut iterations, mut operations) = (0.0, 0.0);
    let scales = Schedule::new(parameters, spacing, density, output_size).scales;
    for (index, scale) in scales.iter().enumerate() {
        let passes = 1.0 + if index < parameters.restart_scale() { 0.0 } else { parameters.restarts.into() };
        let margin = match parameters.boundary {
            Boundary::Open => 2.0 * parameters.margin_sigmas * scale.sigma,
            Boundary::Periodic => 0.0,
        };
        let grid = ((output_size + margin) * scale.resolution).ceil();
        let count = passes * classes * f64::from(scale.iterations);
        iterations += count;
        operations += count * direct_operations(grid.into(), parameters.channels.into());
    }
    Some(Cost {
        points: (exemplar.len() as f64 * parameters.expansion_x * parameters.expansion_y).round() as usize,
        iterations: iterations as u64,
        giga_operations: operations / 1e9,
        seconds: operations / BROWSER_RATE,
    })
}
