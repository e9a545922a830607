//! The CPU engine: one file a stage, forward and backward side by side.

pub mod adam;
pub mod convolution;
pub mod correlation;
pub mod gabor;
pub mod gram;
pub mod lanes;
pub mod network;
pub mod normalization;
pub mod product;
pub mod real;
pub mod scratch;
pub mod tile_fft;
#[cfg(target_arch = "x86_64")]
mod x86;

use std::sync::Arc;

use glam::DVec2;

use crate::engine::FilterBank;
use crate::engine::view::Stage;
use crate::engine::{Advance, ScaleSetup};
use crate::pattern::keep_inside;
use crate::sampling::{Purpose, Rng};

use adam::Adam;
use network::{Evaluation, Network, Targets, best_tiles};
pub(crate) use normalization::EPSILON;

/// The arithmetic a run uses; double precision is for checking gradients.
pub type Float = f32;

/// One class on one scale, on the CPU.
#[derive(Debug)]
pub struct CpuEngine {
    setup: ScaleSetup,
    network: Arc<Network<Float>>,
    phase: Phase,
    points: Vec<DVec2>,
    /// The same points as the grid sees them: from the corner of its margin.
    seen: Vec<DVec2>,
    moving_from: usize,
    adam: Adam,
    iteration: u32,
}

/// Puts points into the coordinates of a grid with a margin.
fn see(points: &[DVec2], margin: f64, seen: &mut Vec<DVec2>) {
    seen.clear();
    seen.extend(points.iter().map(|point| point + margin));
}

/// The exemplar is measured first; its images are gone before those of the output are allocated.
#[derive(Debug)]
enum Phase {
    Exemplar(Box<Evaluation<Float>>),
    Measured(Targets<Float>),
    Output(Box<Evaluation<Float>>, Targets<Float>),
}

impl CpuEngine {
    /// The filters for a scale, taking those of an earlier one if they fit.
    #[must_use]
    pub fn network(setup: &ScaleSetup, channels: usize, before: Option<Arc<Network<Float>>>) -> Arc<Network<Float>> {
        let grid = setup.output_view.grid;
        let bands = setup.exemplar_weights.bands();
        let tiles = best_tiles(channels, grid.height, grid.width, grid.boundary, bands);
        match before {
            Some(network) if (network.tiles(), network.maps()) == (tiles, bands.maps()) => network,
            // Freed before the new one is made: these are the largest buffers of all.
            other => {
                drop(other);
                Arc::new(Network::new(&FilterBank::for_bands(setup.seed, channels, bands), tiles))
            }
        }
    }

    /// Bytes that a run of this scale takes at its peak.
    #[must_use]
    pub fn bytes_for(setup: &ScaleSetup, channels: usize, points: usize) -> u64 {
        let grid = setup.output_view.grid;
        let bands = setup.exemplar_weights.bands();
        let tiles = best_tiles(channels, grid.height, grid.width, grid.boundary, bands);
        let side = |view, points, with_gradient| {
            Evaluation::<Float>::bytes_for(channels, tiles, view, points, setup.lags, with_gradient, bands)
        };
        let exemplar = side(&setup.exemplar_view, setup.exemplar.len(), false);
        let output = side(&setup.output_view, points, true);
        (Network::<Float>::bytes_for(channels, tiles, bands) + exemplar.max(output)) as u64
    }

    /// Starts a scale. `points` are the output's points in exemplar units; those before `moving_from` are frozen.
    /// `adam` and `iteration` are where a saved run stood, or fresh.
    #[must_use]
    pub fn new(
        setup: ScaleSetup,
        network: Arc<Network<Float>>,
        points: Vec<DVec2>,
        moving_from: usize,
        adam: Adam,
        iteration: u32,
    ) -> Self {
        let count = setup.exemplar.len();
        let mut seen = Vec::with_capacity(points.len().max(count));
        see(&setup.exemplar, setup.margin, &mut seen);
        let ScaleSetup { exemplar_view, lags, weights, exemplar_weights, .. } = &setup;
        let exemplar =
            Evaluation::new(Arc::clone(&network), exemplar_view, count, *lags, false, *weights, exemplar_weights);
        Self { setup, network, phase: Phase::Exemplar(Box::new(exemplar)), points, seen, moving_from, adam, iteration }
    }

    /// The stage the next piece of work belongs to; `None` while the exemplar is measured.
    #[must_use]
    pub fn stage(&self) -> Option<Stage> {
        match &self.phase {
            Phase::Output(output, _) => Some(output.stage()),
            _ => None,
        }
    }

    /// Does one bounded piece of work.
    pub fn advance(&mut self) -> Advance {
        match &mut self.phase {
            Phase::Exemplar(exemplar) => {
                if exemplar.advance(&self.seen, None) {
                    if is_flat(&exemplar.image(0).1.inverse_deviation[..exemplar.channels()]) {
                        return Advance::Flat;
                    }
                    self.phase = Phase::Measured(exemplar.targets(self.setup.lags));
                }
                Advance::Working
            }
            Phase::Measured(targets) => {
                let (setup, network) = (&self.setup, Arc::clone(&self.network));
                let targets = targets.clone();
                let count = self.points.len();
                let ScaleSetup { output_view, lags, weights, output_weights, .. } = setup;
                let mut output = Evaluation::new(network, output_view, count, *lags, true, *weights, output_weights);
                jitter(setup, self.iteration, &mut output);
                see(&self.points, self.setup.margin, &mut self.seen);
                self.phase = Phase::Output(Box::new(output), targets);
                Advance::Working
            }
            Phase::Output(output, targets) => {
                if !output.advance(&self.seen, Some(targets)) {
                    return Advance::Working;
                }
                let loss = output.loss();
                let gradients = output.point_gradients(self.moving_from);
                if !loss.total().is_finite() || gradients.iter().flatten().any(|g| !g.is_finite()) {
                    return Advance::NotFinite;
                }
                let moving = &mut self.points[self.moving_from..];
                self.adam.step(moving, gradients, self.setup.learning_rate);
                for point in moving {
                    *point = keep_inside(*point, self.setup.output_size, self.setup.output_view.grid.boundary);
                }
                see(&self.points, self.setup.margin, &mut self.seen);
                self.iteration += 1;
                jitter(&self.setup, self.iteration, output);
                Advance::Iterated(vec![loss])
            }
        }
    }

    /// The output's points, in exemplar units.
    #[must_use]
    pub fn points(&self) -> &[DVec2] {
        &self.points
    }

    /// The moments of the moving points.
    #[must_use]
    pub fn adam(&self) -> &Adam {
        &self.adam
    }

    /// The filters, for the next scale.
    #[must_use]
    pub fn into_network(self) -> Arc<Network<Float>> {
        self.network
    }
}

/// Whether most filters of the first layer see nothing: a lattice blurred by a wide Gaussian is constant. What
/// features are left there is the rounding of sums, and as Adam's steps are as long for small gradients as for large
/// ones, following them would only stir the points. Ordinary patterns stay above a tenth of ε, lattices far below.
/// `inverse_deviations` are those of its channels, padding left out.
pub(crate) fn is_flat(inverse_deviations: &[Float]) -> bool {
    let variance = |inverse_deviation: Float| 1.0 / f64::from(inverse_deviation).powi(2) - EPSILON;
    let seeing = inverse_deviations.iter().filter(|&&inverse| variance(inverse) > 1e-3 * EPSILON).count();
    2 * seeing < inverse_deviations.len()
}

/// Shifts rows and columns of the grid for an iteration.
fn jitter(setup: &ScaleSetup, iteration: u32, output: &mut Evaluation<Float>) {
    for (shift, value) in output.shifts_mut().iter_mut().flatten().zip(shifts(setup, iteration)) {
        *shift = value;
    }
}

/// The shifts of an iteration in pixels, without end: first those of the rows, then those of the columns. Every
/// iteration has its own stream, so that a saved run needs no state of a generator.
pub(crate) fn shifts(setup: &ScaleSetup, iteration: u32) -> impl Iterator<Item = f64> {
    let ScaleSetup { seed, class, scale, jitter_px, .. } = *setup;
    let mut rng = Rng::new(seed, Purpose::Jitter { class, scale, iteration });
    std::iter::repeat_with(move || rng.range(-jitter_px, jitter_px))
}
