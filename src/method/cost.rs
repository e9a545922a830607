//! What a run would take, told before it begins.

use glam::DVec2;

use crate::domain::Boundary;
use crate::method::{Parameters, Schedule};
use crate::pattern::PointPattern;

/// Operations of direct convolution a second that one thread of a browser is worth: 60 to 160 · 10⁹ were seen, the
/// fewer the fewer channels.
const BROWSER_RATE: f64 = 80e9;

/// Upper bounds: scales may converge early.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Points of the output.
    pub points: usize,
    /// Iterations over all classes and scales.
    pub iterations: u64,
    /// Operations of the convolutions done directly, in 10⁹.
    pub giga_operations: f64,
    /// Seconds on one thread of a browser, to a factor of two or three.
    pub seconds: f64,
}

impl Cost {
    /// Of a run with this exemplar; `None` where it has no spacing, so that there is nothing to run.
    #[must_use]
    pub fn of(exemplar: &PointPattern, parameters: &Parameters) -> Option<Self> {
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
        Some(Self {
            points: (exemplar.len() as f64 * parameters.expansion_x * parameters.expansion_y).round() as usize,
            iterations: iterations as u64,
            giga_operations: operations / 1e9,
            seconds: operations / BROWSER_RATE,
        })
    }
}

/// Operations of the four convolutions on a grid of so many columns and rows, done directly, forward and with respect
/// to the input.
pub(crate) fn direct_operations(grid: [f64; 2], channels: f64) -> f64 {
    let pairs = grid[0] * grid[1] * channels * (5.0 + channels + channels / 4.0 + channels / 16.0);
    2.0 * 2.0 * 49.0 * pairs
}
