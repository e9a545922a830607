//! What an engine does: measure the exemplar at one scale, then move the output's points iteration by iteration.
//!
//! An engine works in exemplar units and knows nothing of files, pages or names. A [`ScaleSetup`] says all it needs;
//! [`cpu::CpuEngine`] and [`gpu::GpuEngine`] run it in bounded steps.

pub mod bands;
pub mod cpu;
pub mod filters;
pub mod gpu;
pub mod view;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::pattern::Boundary;

use cpu::CpuEngine;
use cpu::adam::Adam;
use gpu::GpuEngine;
use view::{CUTOFF_SIGMAS, Grid, Lags, Region, Stage, View, Wave};

pub use bands::{Bands, Weights};
pub use filters::FilterBank;

/// The loss of one iteration and its terms, weights included.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LossTerms {
    /// Gram loss of layers 2, 3 and 4.
    pub gram: [f64; 3],
    /// Deep-correlation loss of layer 4.
    pub correlation: f64,
}

impl LossTerms {
    /// The Gram loss of all layers.
    #[must_use]
    pub fn grams(&self) -> f64 {
        self.gram.iter().sum()
    }

    /// The sum of all terms.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.grams() + self.correlation
    }
}

/// The numbers of one scale, whatever method chose them. Lengths are in exemplar units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScaleSettings {
    /// What lies beyond the output's border.
    pub boundary: Boundary,
    /// Width of the Gaussian.
    pub sigma: f64,
    /// Frequency of the Gabor waves in cycles per exemplar unit.
    pub frequency: f64,
    /// Pixels per exemplar unit.
    pub resolution: f64,
    /// How far the grids of an open output reach beyond its border, in σ.
    pub margin_sigmas: f64,
    /// Weights of the Gram and the correlation loss.
    pub weights: [f64; 2],
    /// Adam's step.
    pub learning_rate: f64,
    /// Jitter of rows and columns in pixels.
    pub jitter_px: f64,
    /// Decides filters and jitter.
    pub seed: u64,
    /// Which class, from 0.
    pub class: u16,
    /// Which scale, from 0.
    pub scale: u16,
}

/// One class on one scale: everything an engine needs, in exemplar units.
#[derive(Clone, Debug, PartialEq)]
pub struct ScaleSetup {
    /// The exemplar's points of this class and those before it.
    pub exemplar: Vec<DVec2>,
    /// What they weigh in the maps.
    pub exemplar_weights: Weights,
    /// How the exemplar is seen.
    pub exemplar_view: View,
    /// Width and height of the output.
    pub output_size: DVec2,
    /// How far both grids reach beyond their domain on every side; 0 unless the output is open.
    pub margin: f64,
    /// How the output is seen.
    pub output_view: View,
    /// What the output's points weigh in the maps: in as many bands as the exemplar's.
    pub output_weights: Weights,
    /// Lags of the correlation loss.
    pub lags: Lags,
    /// Weights of the Gram and the correlation loss.
    pub weights: [f64; 2],
    /// Adam's step.
    pub learning_rate: f64,
    /// Jitter of rows and columns in pixels.
    pub jitter_px: f64,
    /// Decides filters and jitter.
    pub seed: u64,
    /// Which class, from 0.
    pub class: u16,
    /// Which scale, from 0.
    pub scale: u16,
}

impl ScaleSetup {
    /// Puts a scale together, for points that weigh the same. Sizes are in exemplar units.
    #[must_use]
    pub fn new(
        settings: &ScaleSettings,
        exemplar: Vec<DVec2>,
        exemplar_size: DVec2,
        exemplar_boundary: Boundary,
        output_size: DVec2,
    ) -> Self {
        let &ScaleSettings { boundary, sigma, resolution, .. } = settings;
        // Dividing by the number of neighbours summed, at most 30, gives the maps the scale for which the ε of the
        // normalisation works as in the paper's published code.
        let map_scale = 1.0 / exemplar.len().clamp(1, 30) as f64;
        let wave = Wave { sigma, frequency: settings.frequency, scale: map_scale, cutoff_sigmas: CUTOFF_SIGMAS };
        // A periodic output has no border. The exemplar's statistics must not have one either: it is either a tile
        // itself, or only its interior counts.
        let interior_only = boundary == Boundary::Periodic && exemplar_boundary == Boundary::Open;
        let exemplar_sees = if interior_only { Boundary::Open } else { boundary };
        let margin = if boundary == Boundary::Open { settings.margin_sigmas * sigma } else { 0.0 };
        let exemplar_view =
            View { grid: grid(exemplar_size + 2.0 * margin, resolution, exemplar_sees), wave, interior_only };
        let output_view =
            View { grid: grid(output_size + 2.0 * margin, resolution, boundary), wave, interior_only: false };
        let (a, b): (Region, Region) = (exemplar_view.last_region(), output_view.last_region());
        Self {
            exemplar,
            exemplar_weights: Weights::default(),
            exemplar_view,
            output_size,
            margin,
            output_view,
            output_weights: Weights::default(),
            lags: Lags { rows: a.height().min(b.height()), columns: a.width().min(b.width()) },
            weights: settings.weights,
            learning_rate: settings.learning_rate,
            jitter_px: settings.jitter_px,
            seed: settings.seed,
            class: settings.class,
            scale: settings.scale,
        }
    }
}

/// The sampling grid of a rectangle at `resolution` pixels per exemplar unit.
fn grid(size: DVec2, resolution: f64, boundary: Boundary) -> Grid {
    let pixels = |side: f64| match boundary {
        Boundary::Open => ((resolution * side).round() as usize).max(8),
        // Two strided layers halve a periodic grid evenly.
        Boundary::Periodic => (((resolution * side / 4.0).round() * 4.0) as usize).max(8),
    };
    let (width, height) = (pixels(size.x), pixels(size.y));
    Grid { height, width, pitch: size / DVec2::new(width as f64, height as f64), boundary }
}

/// What one call of an engine brought.
#[derive(Clone, Debug, PartialEq)]
pub enum Advance {
    /// Part of the exemplar's statistics or of an iteration.
    Working,
    /// There is nothing to do before the device reports something.
    Waiting,
    /// The exemplar's maps are flat at this scale: there is nothing to match, and nothing was done.
    Flat,
    /// The points have moved, once for each loss; these were the losses before each move.
    Iterated(Vec<LossTerms>),
    /// The loss or its gradient is no longer finite; the points have not moved.
    NotFinite,
    /// The device stopped working, for this reason; the points are those that came back last.
    Lost(String),
}

/// Whatever computes.
#[derive(Debug)]
pub enum Engine {
    /// The processor.
    Cpu(Box<CpuEngine>),
    /// A graphics device.
    Gpu(Box<GpuEngine>),
}

impl Engine {
    /// Does a bounded piece of work. At most `most` iterations more are begun than have come back.
    pub fn advance(&mut self, most: u32) -> Advance {
        match self {
            Self::Cpu(engine) => engine.advance(),
            Self::Gpu(engine) => engine.advance(most),
        }
    }

    /// The output's points, in exemplar units.
    #[must_use]
    pub fn points(&self) -> &[DVec2] {
        match self {
            Self::Cpu(engine) => engine.points(),
            Self::Gpu(engine) => engine.points(),
        }
    }

    /// The moments of the moving points.
    #[must_use]
    pub fn adam(&self) -> &Adam {
        match self {
            Self::Cpu(engine) => engine.adam(),
            Self::Gpu(engine) => engine.adam(),
        }
    }

    /// The stage the next piece of work belongs to, where that is known.
    #[must_use]
    pub fn stage(&self) -> Option<Stage> {
        match self {
            Self::Cpu(engine) => engine.stage(),
            Self::Gpu(_) => None,
        }
    }
}
