//! The ladder of scales: which σ, which grid, which step, how long.

use glam::DVec2;

use super::parameters::{LearningRateUnit, Parameters};
use crate::pattern::Boundary;

/// One rung of the ladder. Lengths are in exemplar units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Width of the Gaussian.
    pub sigma: f64,
    /// Pixels of the sampling grid per exemplar unit.
    pub resolution: f64,
    /// Adam's step.
    pub learning_rate: f64,
    /// Most iterations.
    pub iterations: u32,
}

/// All rungs, coarse to fine.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    /// The scales.
    pub scales: Vec<Scale>,
}

/// The exemplar side must keep this many pixels, or layer 4 (a quarter of it) has no structure left to measure.
const LEAST_RESOLUTION: f64 = 24.0;

impl Schedule {
    /// The ladder for an exemplar of mean spacing `spacing` and `density` points per unit area, and an output of
    /// `output_size`, all in exemplar units.
    ///
    /// σ falls linearly from d/c₁ to d/c₂; the grid has `clamp(round(pixels_per_spacing / d), grid_min, grid_max)`
    /// pixels per exemplar side (Huang et al. 2022, §4.4).
    #[must_use]
    pub fn new(parameters: &Parameters, spacing: f64, density: f64, output_size: DVec2) -> Self {
        let p = parameters;
        let finest_grid = (p.pixels_per_spacing / spacing).round().clamp(p.grid_min.into(), p.grid_max.into());
        let fine = (spacing / p.sigma_fine_divisor).max(p.fine_sigma_px / finest_grid);
        let coarse = if p.sigma_coarse_cells > 0.0 {
            // Clark & Evans (1954): mean spacing over that of independent points. Below 1 the points cluster, and the
            // clusters are as much larger than a point's share of the plane.
            let aggregation = 2.0 * spacing * density.sqrt();
            p.sigma_coarse_cells / density.sqrt() / aggregation.min(1.0)
        } else {
            spacing / p.sigma_coarse_divisor
        }
        .max(fine);
        let mut scales: Vec<Scale> = (0..p.scales)
            .map(|index| {
                let along = if p.scales > 1 { f64::from(index) / f64::from(p.scales - 1) } else { 1.0 };
                let sigma = coarse + (fine - coarse) * along;
                let mut resolution = finest_grid;
                if p.coarse_sigma_px > 0.0 {
                    resolution = (p.coarse_sigma_px / sigma).round().max(LEAST_RESOLUTION).min(finest_grid);
                }
                if p.boundary == Boundary::Periodic {
                    // Two strided layers must halve a periodic grid evenly.
                    resolution = (resolution / 4.0).round() * 4.0;
                }
                let (rate, iterations) = if index == 0 {
                    (p.learning_rate_coarse, p.iterations_coarse)
                } else {
                    (p.learning_rate_fine, p.iterations_fine)
                };
                let unit = match p.learning_rate_unit {
                    LearningRateUnit::OutputSide => output_size.max_element(),
                    LearningRateUnit::Sigma => sigma,
                };
                Scale { sigma, resolution, learning_rate: rate * unit, iterations }
            })
            .collect();
        if let Some(&finest) = scales.last()
            && p.iterations_polish > 0
        {
            let learning_rate = 0.5 * finest.learning_rate;
            scales.push(Scale { learning_rate, iterations: p.iterations_polish, ..finest });
        }
        Self { scales }
    }
}

/// Whether a scale is over: tested every ten iterations once the window is full, by whether the last window brought
/// less than `tolerance` of the scale's whole decrease (Huang et al. 2022, §4.4). `losses` holds one loss an
/// iteration since the scale began.
#[must_use]
pub fn converged(losses: &[f64], window: usize, tolerance: f64) -> bool {
    let count = losses.len();
    if count <= window || !count.is_multiple_of(10) {
        return false;
    }
    let (first, before, now) = (losses[0], losses[count - 1 - window], losses[count - 1]);
    // A loss above the first one counts as converged: more of the same step size won't help.
    first <= now || (before - now) / (first - now) < tolerance
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::network::Preset;

    #[test]
    fn the_paper_s_ladder() {
        let parameters = Parameters::preset(Preset::Paper);
        let schedule = Schedule::new(&parameters, 0.1, 100.0, DVec2::splat(2.0));
        let sigmas: Vec<f64> = schedule.scales.iter().map(|s| s.sigma).collect();
        assert_eq!(sigmas.len(), 4);
        assert!((sigmas[0] - 0.125).abs() < 1e-12 && (sigmas[3] - 0.1 / 2.6).abs() < 1e-12);
        let step = sigmas[0] - sigmas[1];
        assert!((sigmas[1] - sigmas[2] - step).abs() < 1e-12 && (sigmas[2] - sigmas[3] - step).abs() < 1e-12);
        assert!(schedule.scales.iter().all(|s| s.resolution == 128.0), "9 / 0.1 = 90 is clamped to 128");
        let rates: Vec<f64> = schedule.scales.iter().map(|s| s.learning_rate).collect();
        assert_eq!(rates, [0.01, 0.004, 0.004, 0.004]);
        let dense = Schedule::new(&parameters, 0.05, 400.0, DVec2::splat(2.0));
        assert!(dense.scales.iter().all(|s| s.resolution == 180.0), "9 / 0.05");
    }

    #[test]
    fn the_ladder_follows_the_size_of_structures_where_asked() {
        let parameters = Parameters {
            sigma_coarse_cells: 1.16,
            coarse_sigma_px: 7.0,
            fine_sigma_px: 2.5,
            grid_max: 128,
            ..Parameters::preset(Preset::Paper)
        };
        // A cluster: neighbours a fiftieth apart, a hundred points.
        let schedule = Schedule::new(&parameters, 0.02, 100.0, DVec2::splat(2.0));
        let (first, last) = (schedule.scales[0], schedule.scales[3]);
        assert!((first.sigma - 0.116 / 0.4).abs() < 1e-12, "{}", first.sigma);
        assert!((last.sigma - 2.5 / 128.0).abs() < 1e-12, "{}", last.sigma);
        assert_eq!((first.resolution, last.resolution), (24.0, 128.0));
        // Evenly spread points: the density alone decides.
        let even = Schedule::new(&parameters, 0.09, 100.0, DVec2::splat(2.0));
        assert!((even.scales[0].sigma - 0.116).abs() < 1e-12);
    }

    #[test]
    fn a_flat_loss_converges_and_a_falling_one_does_not() {
        let flat: Vec<f64> = (0..200).map(|i| if i < 20 { 2.0 - 0.05 * f64::from(i) } else { 1.0 }).collect();
        assert!(converged(&flat, 100, 0.01));
        let falling: Vec<f64> = (0..200).map(|i| 2.0 - 0.005 * f64::from(i)).collect();
        assert!(!converged(&falling, 100, 0.01));
        assert!(!converged(&flat[..100], 100, 0.01), "the window is not full");
        assert!(!converged(&flat[..195], 100, 0.01), "only every ten iterations");
        let rising: Vec<f64> = (0..200).map(|i| 1.0 + 0.01 * f64::from(i)).collect();
        assert!(converged(&rising, 100, 0.01));
    }
}
