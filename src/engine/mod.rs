//! What an engine does: measure the exemplar at one scale, then move the output's points iteration by iteration.
//!
//! An engine works in exemplar units and knows nothing of files, pages or names. A [`ScaleSetup`] says all it needs;
//! [`cpu::CpuEngine`] and [`gpu::GpuEngine`] run it in bounded steps.

pub mod cpu;
pub mod gpu;
pub mod view;

use glam::DVec2;

use crate::domain::Boundary;
use crate::method::schedule::Scale;
use crate::method::{Parameters, Weights};
use crate::synthesis::LossTerms;

use cpu::CpuEngine;
use cpu::adam::Adam;
use gpu::GpuEngine;
use view::{CUTOFF_SIGMAS, Grid, Lags, Region, Stage, View, Wave};

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
    /// Puts a scale together, for points that weigh the same. `exemplar_size` and `output_size` are in exemplar units; `exemplar_points` is the
    /// number M that sets the scale of the maps.
    #[must_use]
    pub fn new(
        parameters: &Parameters,
        scale: &Scale,
        place: (u16, u16),
        exemplar: Vec<DVec2>,
        exemplar_size: DVec2,
        exemplar_boundary: Boundary,
        output_size: DVec2,
    ) -> Self {
        let boundary = parameters.boundary;
        // Dividing by the number of neighbours summed, at most 30, gives the maps the scale for which the ε of the
        // normalisation works as in the paper's published code.
        let map_scale = 1.0 / exemplar.len().clamp(1, 30) as f64;
        let wave = Wave {
            sigma: scale.sigma,
            frequency: parameters.frequency,
            scale: map_scale,
            cutoff_sigmas: CUTOFF_SIGMAS,
        };
        // A periodic output has no border. The exemplar's statistics must not have one either: it is either a tile
        // itself, or only its interior counts.
        let interior_only = boundary == Boundary::Periodic && exemplar_boundary == Boundary::Open;
        let exemplar_sees = if interior_only { Boundary::Open } else { boundary };
        let margin = if boundary == Boundary::Open { parameters.margin_sigmas * scale.sigma } else { 0.0 };
        let exemplar_view =
            View { grid: grid(exemplar_size + 2.0 * margin, scale.resolution, exemplar_sees), wave, interior_only };
        let output_view =
            View { grid: grid(output_size + 2.0 * margin, scale.resolution, boundary), wave, interior_only: false };
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
            weights: [parameters.gram_weight, parameters.correlation_weight],
            learning_rate: scale.learning_rate,
            jitter_px: parameters.jitter_px,
            seed: parameters.seed,
            class: place.0,
            scale: place.1,
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
