//! Every number a person can choose, its range and its meaning, and the presets.
//!
//! [`Parameters::validate`] is the one place where parameters are checked: the command line, the page, files and
//! links all go through it.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use thiserror::Error;

use crate::analysis::{Cloud, check_radii};
use crate::domain::Boundary;
use crate::pattern::{Meaning, PointPattern};
use crate::sorting;

/// A parameter outside its range.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ParameterError {
    /// A number outside its range.
    #[error("parameter '{name}' is {value}, but must lie between {min} and {max}")]
    Range {
        /// The parameter's name, as in files and links.
        name: &'static str,
        /// The offending value.
        value: f64,
        /// Smallest allowed value.
        min: f64,
        /// Largest allowed value.
        max: f64,
    },
    /// A number that must be whole.
    #[error("parameter '{name}' is {value}, but must be a whole number")]
    NotWhole {
        /// The parameter's name, as in files and links.
        name: &'static str,
        /// The offending value.
        value: f64,
    },
    /// Two parameters that contradict each other.
    #[error("parameter '{name}' is {value}, but must be at least '{other}', which is {bound}")]
    Order {
        /// The parameter's name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The parameter it must not fall below.
        other: &'static str,
        /// That parameter's value.
        bound: f64,
    },
    /// A name that is not one of the choices.
    #[error("parameter '{name}' is {value:?}, but must be one of {choices}")]
    Choice {
        /// The parameter's name.
        name: &'static str,
        /// The offending word.
        value: String,
        /// What is allowed.
        choices: &'static str,
    },
}

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

    /// The preset of that name.
    ///
    /// # Errors
    /// [`ParameterError::Choice`] when there is none.
    pub fn from_name(name: &str) -> Result<Self, ParameterError> {
        Self::ALL.into_iter().find(|preset| preset.name() == name).ok_or_else(|| ParameterError::Choice {
            name: "preset",
            value: name.to_owned(),
            choices: "fast, balanced, best, paper",
        })
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

/// How the output points start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// Poisson-disk (blue-noise) points, exactly as many as asked for.
    #[default]
    PoissonDisk,
    /// Independent uniform points.
    WhiteNoise,
}

/// In which order the classes are placed; each sees those before it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClassOrder {
    /// As the exemplar lists them (the paper's).
    #[default]
    File,
    /// By mean radius or scale, the largest first; where there is neither, fewest points first.
    LargestFirst,
    /// Most points first.
    MostFirst,
}

impl ClassOrder {
    /// The classes of `exemplar` that have points, in this order.
    #[must_use]
    pub fn of(self, exemplar: &PointPattern) -> Vec<usize> {
        let classes = exemplar.class_names().len();
        let mut counts = vec![0.0; classes];
        let mut sizes = vec![0.0; classes];
        let size = exemplar.attributes().iter().find(|attribute| attribute.meaning() == Meaning::Size);
        for (point, &class) in exemplar.classes().iter().enumerate() {
            counts[usize::from(class)] += 1.0;
            sizes[usize::from(class)] += size.map_or(0.0, |size| size.values[point]);
        }
        // Ties stay in the order of the exemplar.
        let mut order = sorting::order((0..classes).map(|class| match (self, size) {
            (Self::File, _) => 0.0,
            (Self::LargestFirst, Some(_)) => -sizes[class] / f64::max(counts[class], 1.0),
            (Self::LargestFirst, None) => counts[class],
            (Self::MostFirst, _) => -counts[class],
        }));
        order.retain(|&class| counts[class] > 0.0);
        order
    }
}

/// Whether the maps tell classes apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClassMaps {
    /// All points in the same maps (the paper's).
    #[default]
    Pooled,
    /// The class that moves has maps of its own, those before it share some. Points with attributes have all ten maps
    /// without them, also when there is one class, and not the Gaussian alone.
    Separate,
    /// Every class has maps of its own.
    Each,
}

/// What a learning rate is a multiple of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LearningRateUnit {
    /// The longer side of the output (the paper's).
    OutputSide,
    /// σ of the scale: steps shrink with what the scale can tell apart, and a rate suits every pattern.
    Sigma,
}

/// Everything that, with an exemplar, decides the result. Lengths are in exemplar units (the longer side of the
/// exemplar is 1) unless the name says otherwise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct Parameters {
    /// Width of the output in widths of the exemplar.
    pub expansion_x: f64,
    /// Height of the output in heights of the exemplar.
    pub expansion_y: f64,
    /// What lies beyond the output's border.
    pub boundary: Boundary,
    /// Decides the start, the filters and the jitter.
    pub seed: u64,
    /// How the output points start.
    pub start: Start,
    /// In which order the classes are placed.
    #[serde(default)]
    pub class_order: ClassOrder,
    /// Whether the maps tell classes apart.
    #[serde(default)]
    pub class_maps: ClassMaps,
    /// Output channels of every random convolution.
    pub channels: u32,
    /// Sampling grid: pixels per mean spacing d, before the clamp to `grid_min` … `grid_max`.
    pub pixels_per_spacing: f64,
    /// Fewest pixels along the longer side of the exemplar.
    pub grid_min: u32,
    /// Most pixels along the longer side of the exemplar.
    pub grid_max: u32,
    /// Coarse scales use a coarser grid, as long as their σ keeps this many pixels; 0 keeps one grid for all scales.
    pub coarse_sigma_px: f64,
    /// The finest σ keeps at least this many pixels, or the maps can't tell close points apart; 0 means no limit.
    pub fine_sigma_px: f64,
    /// How many scales, from coarse to fine.
    pub scales: u32,
    /// The coarsest σ is d divided by this (the paper's c₁).
    pub sigma_coarse_divisor: f64,
    /// Unless 0, the coarsest σ is this many times the side of the square that one exemplar point has to itself
    /// (1 / √density), more where points cluster, and c₁ is not used. Where points cluster or line up, d says how close
    /// neighbours stand, but not how large the structures are.
    pub sigma_coarse_cells: f64,
    /// The finest σ is d divided by this (the paper's c₂).
    pub sigma_fine_divisor: f64,
    /// The non-zero Gabor frequency, in cycles per exemplar unit.
    pub frequency: f64,
    /// Each iteration shifts every row and every column of the sampling grid by up to this many pixels.
    pub jitter_px: f64,
    /// In an open domain the sampling grid reaches this many σ beyond the border, on both sides alike: points near the
    /// border are then seen whole, and gain nothing by crowding onto it. 0 ends the grid at the border, as the paper.
    pub margin_sigmas: f64,
    /// Weight of the Gram loss.
    pub gram_weight: f64,
    /// Weight of the deep-correlation loss. The public PyTorch code lets gradient through one of two factors only,
    /// which amounts to 0.5 here.
    pub correlation_weight: f64,
    /// Adam's step on the first (coarsest) scale.
    pub learning_rate_coarse: f64,
    /// Adam's step on all later scales.
    pub learning_rate_fine: f64,
    /// What the two learning rates are multiples of.
    pub learning_rate_unit: LearningRateUnit,
    /// Most iterations on the first scale.
    pub iterations_coarse: u32,
    /// Most iterations on each later scale.
    pub iterations_fine: u32,
    /// Iterations of a last pass over the finest scale, at half its step, after the repairs; 0 for none.
    pub iterations_polish: u32,
    /// Only the last so many scales are followed by repairs: what the next lines say of each scale holds for them. 0 is
    /// all.
    #[serde(default)]
    pub repair_scales: u32,
    /// After each scale points are pushed apart until they keep this share of the exemplar's smallest distance, and off
    /// an open border as far as the exemplar's stay; 0 lets them coincide, and stand on it, as the paper.
    pub spacing_floor: f64,
    /// After each scale this share of the points at most goes from crowds into holes, where the exemplar has neither.
    pub relocation: f64,
    /// After the last scale neighbourhoods that nearly match one of the exemplar's are made to match, in this many
    /// rounds at most.
    pub alignment: u32,
    /// After each pass over the finest scale so many changes are tried at most, and as many again if they bring
    /// something: a point less, a point more, or one moved from where it is too many to where it is missing.
    #[serde(default)]
    pub transplants: u32,
    /// How often the regions that came out worst are shaken and go through the finer half of the ladder again; what does
    /// not become better is undone.
    pub restarts: u32,
    /// After each scale disks (points with an attribute `radius`) are moved until they overlap as the exemplar's do, by
    /// this share of what they lack; 0 leaves them, as the paper.
    pub disk_overlap: f64,
    /// After each scale points exchange their attribute values up to this many times over, so that neighbours fit as in
    /// the exemplar; 0 leaves them where chance put them, as the paper.
    pub value_swaps: u32,
    /// A scale may stop early only after this many iterations; also the window of the convergence test.
    pub convergence_window: u32,
    /// A scale stops when the last window brought less than this share of its whole decrease.
    pub convergence_tolerance: f64,
}

/// One number's name, range and meaning, for help texts, sliders and checks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Range {
    /// The name in files, links and messages.
    pub name: &'static str,
    /// Smallest allowed value.
    pub min: f64,
    /// Largest allowed value.
    pub max: f64,
    /// Whether it must be a whole number.
    pub whole: bool,
    /// One sentence on what it does.
    pub meaning: &'static str,
}

const fn real(name: &'static str, min: f64, max: f64, meaning: &'static str) -> Range {
    Range { name, min, max, whole: false, meaning }
}

const fn whole(name: &'static str, min: f64, max: f64, meaning: &'static str) -> Range {
    Range { name, min, max, whole: true, meaning }
}

impl Range {
    /// Checks one number.
    ///
    /// # Errors
    /// When it lies outside the range (NaN does) or should be whole and is not.
    pub fn check(&self, value: f64) -> Result<(), ParameterError> {
        // Written so that NaN is refused too.
        if !(value >= self.min && value <= self.max) {
            return Err(ParameterError::Range { name: self.name, value, min: self.min, max: self.max });
        }
        if self.whole && value.fract() != 0.0 {
            return Err(ParameterError::NotWhole { name: self.name, value });
        }
        Ok(())
    }
}

impl Parameters {
    /// Range and meaning of every numeric parameter, in the order of the struct's fields.
    pub const RANGES: [Range; 33] = [
        real("expansion-x", 0.25, 8.0, "Width of the result in widths of the exemplar."),
        real("expansion-y", 0.25, 8.0, "Height of the result in heights of the exemplar."),
        whole("seed", 0.0, 9_007_199_254_740_991.0, "Same seed, same exemplar, same parameters: the same pattern."),
        whole(
            "channels",
            4.0,
            160.0,
            "Random filters a layer. More see finer differences; the cost grows with the square.",
        ),
        real("pixels-per-spacing", 2.0, 16.0, "Pixels of the sampling grid per mean distance between neighbours."),
        whole("grid-min", 16.0, 256.0, "Fewest pixels along the exemplar's longer side."),
        whole("grid-max", 16.0, 256.0, "Most pixels along the exemplar's longer side."),
        real(
            "coarse-sigma-px",
            0.0,
            16.0,
            "Coarse scales use a coarser grid while σ keeps this many pixels; 0 means never.",
        ),
        real("fine-sigma-px", 0.0, 8.0, "The narrowest σ keeps at least this many pixels."),
        whole("scales", 1.0, 8.0, "Steps from coarse structure to fine placement."),
        real("sigma-coarse-divisor", 0.1, 8.0, "The widest σ is the mean spacing divided by this (c₁)."),
        real(
            "sigma-coarse-cells",
            0.0,
            8.0,
            "The widest σ in sides of the square each point has to itself; 0 uses c₁.",
        ),
        real("sigma-fine-divisor", 0.1, 8.0, "The narrowest σ is the mean spacing divided by this (c₂)."),
        real("frequency", 0.0, 16.0, "Cycles of the Gabor waves per exemplar side."),
        real("jitter-px", 0.0, 2.0, "How far rows and columns of the grid wander between iterations, in pixels."),
        real("margin-sigmas", 0.0, 4.0, "How far an open grid reaches beyond the border, in σ."),
        real("gram-weight", 0.0, 1000.0, "Weight of the Gram loss: which filter answers occur together."),
        real(
            "correlation-weight",
            0.0,
            1000.0,
            "Weight of the correlation loss: at which distances structure repeats.",
        ),
        real("learning-rate-coarse", 1e-6, 1.0, "Step of the optimiser on the first scale."),
        real("learning-rate-fine", 1e-6, 1.0, "Step of the optimiser on later scales."),
        whole("iterations-coarse", 1.0, 5000.0, "Most iterations on the first scale."),
        whole("iterations-fine", 1.0, 5000.0, "Most iterations on every later scale."),
        whole("iterations-polish", 0.0, 5000.0, "Iterations of a last pass over the finest scale."),
        whole("repair-scales", 0.0, 8.0, "Only the last so many scales are followed by repairs; 0 means all."),
        real(
            "spacing-floor",
            0.0,
            1.0,
            "Points keep this share of the exemplar's smallest distance; 0 lets them meet.",
        ),
        real("relocation", 0.0, 0.5, "Share of points that may go from crowds into holes after each scale."),
        whole("alignment", 0.0, 1000.0, "Rounds in which nearly right neighbourhoods are made right at the end."),
        whole(
            "transplants",
            0.0,
            10_000.0,
            "Moves of single points, from where one is too many to where one is missing.",
        ),
        whole("restarts", 0.0, 100.0, "How often the regions that came out worst get another try."),
        real(
            "disk-overlap",
            0.0,
            1.0,
            "Share of the exemplar's distances that disks keep where they must not overlap more; 0 is off.",
        ),
        whole(
            "value-swaps",
            0.0,
            100.0,
            "Sweeps of exchanges that bring values to where they fit; 0 leaves it to chance.",
        ),
        whole("convergence-window", 10.0, 5000.0, "Iterations a scale runs at least, and looks back over."),
        real("convergence-tolerance", 0.0, 1.0, "A scale ends when its last window brought less than this share."),
    ];

    /// Every numeric parameter, in the order of [`Self::RANGES`].
    fn numbers(&self) -> [f64; Self::RANGES.len()] {
        [
            self.expansion_x,
            self.expansion_y,
            self.seed as f64,
            self.channels.into(),
            self.pixels_per_spacing,
            self.grid_min.into(),
            self.grid_max.into(),
            self.coarse_sigma_px,
            self.fine_sigma_px,
            self.scales.into(),
            self.sigma_coarse_divisor,
            self.sigma_coarse_cells,
            self.sigma_fine_divisor,
            self.frequency,
            self.jitter_px,
            self.margin_sigmas,
            self.gram_weight,
            self.correlation_weight,
            self.learning_rate_coarse,
            self.learning_rate_fine,
            self.iterations_coarse.into(),
            self.iterations_fine.into(),
            self.iterations_polish.into(),
            self.repair_scales.into(),
            self.spacing_floor,
            self.relocation,
            self.alignment.into(),
            self.transplants.into(),
            self.restarts.into(),
            self.disk_overlap,
            self.value_swaps.into(),
            self.convergence_window.into(),
            self.convergence_tolerance,
        ]
    }

    /// The parameters of a preset: a 2 × 2 open output, seed 1. Links name presets: see [`super::editions`] before
    /// changing one.
    #[must_use]
    pub fn preset(preset: Preset) -> Self {
        let paper = Self {
            expansion_x: 2.0,
            expansion_y: 2.0,
            boundary: Boundary::Open,
            seed: 1,
            start: Start::PoissonDisk,
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

    /// A parameter's allowed value that is nearest to the one given, as it stands in files; `None` when there is no such
    /// parameter, or no value of its kind.
    #[must_use]
    pub fn nearest(name: &str, value: &Value) -> Option<Value> {
        if let Some(range) = Self::RANGES.iter().find(|range| range.name == name) {
            let number = value.as_f64().filter(|number| !number.is_nan())?.clamp(range.min, range.max);
            return Some(if range.whole { Value::from(number.round() as u64) } else { Value::from(number) });
        }
        let choices: &[&str] = match name {
            "boundary" => &["open", "periodic"],
            "start" => &["poisson-disk", "white-noise"],
            "learning-rate-unit" => &["output-side", "sigma"],
            "class-order" => &["file", "largest-first", "most-first"],
            "class-maps" => &["pooled", "separate", "each"],
            _ => return None,
        };
        choices.iter().find(|choice| value.as_str() == Some(choice)).map(|&choice| Value::from(choice))
    }

    /// The preset as it suits the exemplar, with some parameters replaced. Ranges are not checked.
    ///
    /// # Errors
    /// When a name or the kind of a value is wrong.
    pub fn with_overrides(
        preset: Preset,
        exemplar: &PointPattern,
        overrides: Map<String, Value>,
    ) -> Result<Self, serde_json::Error> {
        // By way of text, as a saved state: to and from `Value` would be 10 kB more of the wasm.
        let text = serde_json::to_string(&Self::suited_to(preset, exemplar))?;
        let mut merged: Map<String, Value> = serde_json::from_str(&text)?;
        merged.extend(overrides);
        let text = serde_json::to_string(&merged)?;
        serde_json::from_str(&text)
    }

    /// Raises what [`Self::validate`] wants to be at least as large as something else.
    pub fn put_in_order(&mut self) {
        self.grid_max = self.grid_max.max(self.grid_min);
        self.sigma_fine_divisor = self.sigma_fine_divisor.max(self.sigma_coarse_divisor);
    }

    /// The scale from which the worst regions try again: the finer half, where structures are closed.
    #[must_use]
    pub fn restart_scale(&self) -> usize {
        self.scales as usize / 2
    }

    /// Checks every number against [`Self::RANGES`], and the ones that depend on each other.
    ///
    /// # Errors
    /// The first offence, with the parameter's name, its value and what is allowed.
    pub fn validate(&self) -> Result<(), ParameterError> {
        for (range, value) in Self::RANGES.iter().zip(self.numbers()) {
            range.check(value)?;
        }
        let at_least = |name, value: f64, other, bound: f64| {
            if value < bound { Err(ParameterError::Order { name, value, other, bound }) } else { Ok(()) }
        };
        at_least("grid-max", self.grid_max.into(), "grid-min", self.grid_min.into())?;
        at_least("sigma-fine-divisor", self.sigma_fine_divisor, "sigma-coarse-divisor", self.sigma_coarse_divisor)
    }
}
