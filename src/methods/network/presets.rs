//! Sets of parameters under a name, and how they suit an exemplar.

use serde::{Deserialize, Serialize};

use super::parameters::{ClassMaps, ClassOrder, LearningRateUnit, Parameters, PointStart};
use crate::analysis::{Cloud, check_radii};
use crate::pattern::{Boundary, PointPattern};
use crate::run::{ParameterError, preset_error};

/// A set of parameters under a name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// Seconds: few channels, a grid just fine enough.
    #[default]
    Fast,
    /// A minute or two: more iterations, other tries at the worst regions.
    Balanced,
    /// As good as it gets: many minutes.
    Best,
    /// The numbers of Huang et al. 2022.
    Paper,
}

impl Preset {
    /// All presets, quickest first.
    pub const ALL: [Self; 4] = [Self::Fast, Self::Balanced, Self::Best, Self::Paper];

    /// The name used in files, links and on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Fast => "fast",
            Self::Balanced => "balanced",
            Self::Best => "best",
            Self::Paper => "paper",
        }
    }

    /// What the page's button says, and one sentence on what to expect.
    #[must_use]
    pub fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Fast => ("Fast", "Seconds: few filters, a grid just fine enough."),
            Self::Balanced => {
                ("Balanced", "Minutes: more iterations, and the worst regions get another try, three times.")
            }
            Self::Best => ("Best", "Many minutes: more filters, a finer grid, and eight tries at the worst regions."),
            Self::Paper => ("Paper", "The numbers of Huang et al. 2022. Takes long in a browser."),
        }
    }

    /// The preset of that name.
    ///
    /// # Errors
    /// [`ParameterError::Choice`] when there is none.
    pub fn from_name(name: &str) -> Result<Self, ParameterError> {
        Self::ALL
            .into_iter()
            .find(|preset| preset.name() == name)
            .ok_or_else(|| preset_error(name, &Self::ALL.map(Self::name)))
    }
}

/// Clark & Evans's index from which an exemplar counts as a lattice: 2 for a square one, 2.15 for a hexagonal one, at
/// most about 1.9 for blue noise.
const LATTICE_INDEX: f64 = 1.95;

/// The index from which Paper keeps the whole of an exemplar's smallest distance: for blue noise and lattices, not for
/// patterns with gaps.
const SPACED_INDEX: f64 = 1.7;

/// The paper's c₁ for lattices, which are flat at wider σ: the paper has the person choose it, and its published examples
/// go as far.
const LATTICE_COARSE_DIVISOR: f64 = 1.7;

/// c₂ for lattices, within what Tu et al. 2019 use.
const LATTICE_FINE_DIVISOR: f64 = 3.5;

/// Weight of the correlation loss for lattices: with the paper's 1 points that start without order seldom find the rows.
const LATTICE_CORRELATION_WEIGHT: f64 = 0.2;

impl Parameters {
    /// The parameters of a preset: a 2 × 2 open output, seed 1. Links name presets: see [`super::editions`] before
    /// changing one.
    #[must_use]
    pub fn preset(preset: Preset) -> Self {
        let paper = Self {
            expansion_x: 2.0,
            expansion_y: 2.0,
            boundary: Boundary::Open,
            seed: 1,
            start: PointStart::PoissonDisk,
            class_order: ClassOrder::File,
            class_maps: ClassMaps::Pooled,
            channels: 120,
            pixels_per_spacing: 9.0,
            grid_min: 128,
            grid_max: 256,
            coarse_sigma_px: 0.0,
            fine_sigma_px: 0.0,
            scales: 4,
            sigma_coarse_divisor: 0.8,
            sigma_coarse_cells: 0.0,
            sigma_fine_divisor: 2.6,
            frequency: 1.5,
            jitter_px: 1.0,
            margin_sigmas: 0.0,
            gram_weight: 0.08,
            correlation_weight: 1.0,
            learning_rate_coarse: 0.005,
            learning_rate_fine: 0.002,
            learning_rate_unit: LearningRateUnit::OutputSide,
            iterations_coarse: 500,
            iterations_fine: 500,
            iterations_polish: 0,
            // The descent is the paper's throughout. Its outcome may have points on one another, clumps, holes, and rows
            // with single gaps, which no preset may leave behind.
            repair_scales: 1,
            spacing_floor: 0.6,
            relocation: 0.1,
            alignment: 20,
            transplants: 600,
            restarts: 0,
            disk_overlap: 0.0,
            value_swaps: 0,
            convergence_window: 100,
            convergence_tolerance: 0.01,
        };
        match preset {
            Preset::Paper => paper,
            // What other tries at the worst regions bring is more than what as much time in a larger network brings.
            Preset::Balanced => Self {
                coarse_sigma_px: 7.0,
                iterations_coarse: 300,
                iterations_fine: 120,
                iterations_polish: 80,
                alignment: 40,
                restarts: 3,
                ..Self::preset(Preset::Fast)
            },
            Preset::Best => Self {
                coarse_sigma_px: 7.0,
                channels: 48,
                pixels_per_spacing: 8.0,
                grid_min: 48,
                grid_max: 160,
                iterations_coarse: 400,
                iterations_fine: 200,
                iterations_polish: 120,
                alignment: 60,
                restarts: 8,
                ..Self::preset(Preset::Fast)
            },
            Preset::Fast => Self {
                class_maps: ClassMaps::Separate,
                margin_sigmas: 2.0,
                channels: 32,
                sigma_coarse_cells: 1.16,
                coarse_sigma_px: 6.0,
                fine_sigma_px: 2.5,
                pixels_per_spacing: 7.0,
                grid_min: 32,
                grid_max: 96,
                learning_rate_coarse: 0.04,
                learning_rate_fine: 0.04,
                learning_rate_unit: LearningRateUnit::Sigma,
                iterations_coarse: 250,
                iterations_fine: 100,
                iterations_polish: 60,
                repair_scales: 0,
                spacing_floor: 1.0,
                relocation: 0.1,
                alignment: 20,
                transplants: 600,
                disk_overlap: 1.0,
                value_swaps: 12,
                ..paper
            },
        }
    }

    /// The preset as it suits an exemplar: a tile makes a tile and a window a window, and lattices, which are flat at
    /// the scales of other patterns, get a fine and narrow ladder. Other values and classes get longer steps, but not
    /// with Best, and values of a single class at least 7 pixels per wide σ; from three classes on Balanced takes 6, and
    /// two other tries. Best spends its time on windows in a larger network instead of on other tries. Up to four classes
    /// together make as many iterations as one with Fast, up to eight as many as two with Balanced. The Paper preset only
    /// takes the boundary and, for lattices, another c₁, c₂ and correlation weight. Of its repairs neighbourhoods are
    /// aligned but for windows, and the exemplar's smallest distance is kept in all that is as evenly spaced as blue
    /// noise.
    #[must_use]
    pub fn suited_to(preset: Preset, exemplar: &PointPattern) -> Self {
        let mut parameters = Self { boundary: exemplar.boundary(), ..Self::preset(preset) };
        if exemplar
            .radii_in(exemplar.domain().exemplar_unit())
            .is_some_and(|radii| check_radii(&Cloud::of(exemplar), &radii).is_err())
        {
            // Radii in another unit than positions are numbers like any other.
            parameters.disk_overlap = 0.0;
        }
        if preset == Preset::Paper {
            parameters.suit_paper(exemplar);
            return parameters;
        }
        let is_lattice = Self::is_lattice(exemplar);
        let classes = parameters.class_order.of(exemplar).len() as u32;
        let has_values = !exemplar.attributes().is_empty();
        if has_values && classes == 1 {
            // Waves that carry values lose more on a coarse grid than points do. With several classes it takes too long.
            parameters.coarse_sigma_px = parameters.coarse_sigma_px.max(7.0);
        }
        if preset == Preset::Balanced && classes > 2 {
            // Filters that reach farther make up for the iterations that many classes share, and the last try for little.
            parameters.coarse_sigma_px = 6.0;
            parameters.restarts = 2;
        }
        if preset != Preset::Best && !is_lattice && (has_values || classes > 1) {
            // They have more to match, and with small steps are far from it when the iterations are over.
            parameters.learning_rate_coarse = 0.16;
            parameters.learning_rate_fine = 0.12;
        }
        if preset == Preset::Fast && (is_lattice || exemplar.boundary() == Boundary::Open) {
            // Each iteration costs more than elsewhere: lattices need the finest grid at all scales, and grids of
            // windows reach beyond the border.
            parameters.iterations_coarse = if is_lattice { 150 } else { 200 };
            parameters.iterations_fine = 80;
        }
        if preset == Preset::Best && exemplar.boundary() == Boundary::Open {
            // A window is not the same everywhere, and tries at single regions find no centres: more channels do.
            parameters.channels = 96;
            parameters.iterations_coarse = 500;
            parameters.iterations_fine = 300;
            parameters.restarts = 2;
        }
        // Classes are placed one after another. With less than a quarter of the iterations nothing comes of any.
        let full = match preset {
            Preset::Fast => 1,
            Preset::Balanced => 2,
            Preset::Best | Preset::Paper => classes,
        };
        let share = f64::from(full) / f64::from(classes.clamp(full, 4 * full));
        let shared =
            [&mut parameters.iterations_coarse, &mut parameters.iterations_fine, &mut parameters.iterations_polish];
        shared.into_iter().for_each(|iterations| *iterations = (share * f64::from(*iterations)).ceil() as u32);
        if !is_lattice {
            return parameters;
        }
        Self {
            pixels_per_spacing: parameters.pixels_per_spacing.max(9.0),
            sigma_coarse_cells: 0.45,
            sigma_fine_divisor: LATTICE_FINE_DIVISOR,
            correlation_weight: LATTICE_CORRELATION_WEIGHT,
            learning_rate_fine: 0.02,
            ..parameters
        }
    }

    /// What of the Paper preset depends on the exemplar, beyond its boundary. The network, the steps and the grids don't.
    fn suit_paper(&mut self, exemplar: &PointPattern) {
        let index = exemplar.aggregation_index().unwrap_or(0.0);
        if index >= LATTICE_INDEX {
            self.sigma_coarse_divisor = LATTICE_COARSE_DIVISOR;
            self.sigma_fine_divisor = LATTICE_FINE_DIVISOR;
            self.correlation_weight = LATTICE_CORRELATION_WEIGHT;
        }
        if exemplar.boundary() == Boundary::Open {
            // Rings that the network found as a whole come apart where neighbourhoods are cut off.
            self.alignment = 0;
        }
        if index >= SPACED_INDEX {
            // Blurred maps hardly see a few pairs that are a little closer than any of the exemplar, and ρ sees nothing
            // else.
            self.spacing_floor = 1.0;
        }
    }

    /// Whether an exemplar gets the ladder of lattices.
    #[must_use]
    pub fn is_lattice(exemplar: &PointPattern) -> bool {
        exemplar.aggregation_index().is_some_and(|index| index >= LATTICE_INDEX)
    }
}
