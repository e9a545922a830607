//! Every number and word that a person can choose, its range and its meaning.
//!
//! [`Parameters::validate`] is the one place where parameters are checked: the command line, the page, files and
//! links all go through it.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::schedule::Scale;
use crate::engine::ScaleSettings;
use crate::pattern::{Boundary, Meaning, PointPattern};
use crate::run::Place::{Advanced, Main};
use crate::run::{Choice, Parameter, ParameterError};
use crate::sorting;

/// How the output points start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PointStart {
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
    pub start: PointStart,
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
    /// How often the regions that came out worst are moved at random and go through the finer half of the ladder again; what does
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

/// What lies beyond the border.
const BOUNDARIES: [Choice; 2] = [
    Choice { name: "open", title: "Open", meaning: "Nothing: the pattern is seen through a window." },
    Choice { name: "periodic", title: "Periodic", meaning: "The opposite side, so that the result tiles." },
];
const STARTS: [Choice; 2] = [
    Choice { name: "poisson-disk", title: "Poisson disk", meaning: "Evenly spread points." },
    Choice { name: "white-noise", title: "White noise", meaning: "Independent points." },
];
const STEP_UNITS: [Choice; 2] = [
    Choice { name: "output-side", title: "Output side", meaning: "The longer side of the result, as in the paper." },
    Choice { name: "sigma", title: "σ of the scale", meaning: "Steps shrink with what the scale can tell apart." },
];
const CLASS_ORDERS: [Choice; 3] = [
    Choice { name: "file", title: "As listed", meaning: "As the exemplar lists them, as in the paper." },
    Choice {
        name: "largest-first",
        title: "Largest first",
        meaning: "By mean radius or scale; where there is neither, fewest points first.",
    },
    Choice { name: "most-first", title: "Most first", meaning: "By number of points." },
];
const CLASS_MAPS: [Choice; 3] = [
    Choice { name: "pooled", title: "Pooled", meaning: "All points in the same maps, as in the paper." },
    Choice { name: "separate", title: "Separate", meaning: "The class being placed has maps of its own." },
    Choice { name: "each", title: "Each", meaning: "Every class has maps of its own." },
];

/// The method's parameters in their own words, in the order in which links write them. Page, help, links and checks are
/// built from this list; a test holds it against the fields of [`Parameters`].
pub(super) const PARAMETERS: [Parameter; 38] = [
    Parameter::real(
        "expansion-x",
        0.25,
        8.0,
        (Main, "Size", "Width"),
        "Width of the result in widths of the exemplar.",
    ),
    Parameter::real(
        "expansion-y",
        0.25,
        8.0,
        (Main, "Size", "Height"),
        "Height of the result in heights of the exemplar.",
    ),
    Parameter::whole(
        "seed",
        0.0,
        9_007_199_254_740_991.0,
        (Main, "Seed", "Seed"),
        "Same seed, same exemplar, same parameters: the same pattern.",
    ),
    Parameter::whole(
        "channels",
        4.0,
        160.0,
        (Advanced, "Network", "Channels"),
        "Random filters a layer. More filters tell finer differences apart; the cost grows with the square.",
    ),
    Parameter::real(
        "pixels-per-spacing",
        2.0,
        16.0,
        (Advanced, "Grid", "Pixels per spacing"),
        "Pixels of the sampling grid per mean distance between neighbours.",
    ),
    Parameter::whole(
        "grid-min",
        16.0,
        256.0,
        (Advanced, "Grid", "Fewest pixels"),
        "Fewest pixels along the exemplar's longer side.",
    ),
    Parameter::whole(
        "grid-max",
        16.0,
        256.0,
        (Advanced, "Grid", "Most pixels"),
        "Most pixels along the exemplar's longer side.",
    ),
    Parameter::real(
        "coarse-sigma-px",
        0.0,
        16.0,
        (Advanced, "Grid", "Pixels per wide σ"),
        "Coarse scales use a coarser grid while σ keeps this many pixels; 0 means never.",
    ),
    Parameter::real(
        "fine-sigma-px",
        0.0,
        8.0,
        (Advanced, "Grid", "Pixels per narrow σ"),
        "The narrowest σ keeps at least this many pixels.",
    ),
    Parameter::whole(
        "scales",
        1.0,
        8.0,
        (Advanced, "Scales", "Number of scales"),
        "Steps from coarse structure to fine placement.",
    ),
    Parameter::real(
        "sigma-coarse-divisor",
        0.1,
        8.0,
        (Advanced, "Scales", "Widest σ, divisor c₁"),
        "The widest σ is the mean spacing divided by this (c₁).",
    ),
    Parameter::real(
        "sigma-coarse-cells",
        0.0,
        8.0,
        (Advanced, "Scales", "Widest σ, in cells"),
        "The widest σ in sides of the square each point has to itself; 0 uses c₁.",
    ),
    Parameter::real(
        "sigma-fine-divisor",
        0.1,
        8.0,
        (Advanced, "Scales", "Narrowest σ, divisor c₂"),
        "The narrowest σ is the mean spacing divided by this (c₂).",
    ),
    Parameter::real(
        "frequency",
        0.0,
        16.0,
        (Advanced, "Network", "Gabor frequency"),
        "Cycles of the Gabor waves per exemplar side.",
    ),
    Parameter::real(
        "jitter-px",
        0.0,
        2.0,
        (Advanced, "Grid", "Jitter"),
        "How far rows and columns of the grid shift between iterations, in pixels.",
    ),
    Parameter::real(
        "margin-sigmas",
        0.0,
        4.0,
        (Advanced, "Grid", "Margin"),
        "How far an open grid reaches beyond the border, in σ.",
    ),
    Parameter::real(
        "gram-weight",
        0.0,
        1000.0,
        (Advanced, "Loss", "Gram weight"),
        "Weight of the Gram loss: which filters respond together.",
    ),
    Parameter::real(
        "correlation-weight",
        0.0,
        1000.0,
        (Advanced, "Loss", "Correlation weight"),
        "Weight of the correlation loss: at which distances structure repeats.",
    ),
    Parameter::real(
        "learning-rate-coarse",
        1e-6,
        1.0,
        (Advanced, "Optimiser", "Step, first scale"),
        "Step of the optimiser on the first scale.",
    ),
    Parameter::real(
        "learning-rate-fine",
        1e-6,
        1.0,
        (Advanced, "Optimiser", "Step, later scales"),
        "Step of the optimiser on later scales.",
    ),
    Parameter::whole(
        "iterations-coarse",
        1.0,
        5000.0,
        (Advanced, "Optimiser", "Iterations, first scale"),
        "Most iterations on the first scale.",
    ),
    Parameter::whole(
        "iterations-fine",
        1.0,
        5000.0,
        (Advanced, "Optimiser", "Iterations, later scales"),
        "Most iterations on every later scale.",
    ),
    Parameter::whole(
        "iterations-polish",
        0.0,
        5000.0,
        (Advanced, "Optimiser", "Iterations, last pass"),
        "Iterations of a last pass over the finest scale.",
    ),
    Parameter::whole(
        "repair-scales",
        0.0,
        8.0,
        (Advanced, "Finishing", "Scales finished"),
        "Only the last so many scales are finished; 0 means all.",
    ),
    Parameter::real(
        "spacing-floor",
        0.0,
        1.0,
        (Advanced, "Finishing", "Smallest distance"),
        "Share of the exemplar's smallest distance that points keep; 0 lets them coincide.",
    ),
    Parameter::real(
        "relocation",
        0.0,
        0.5,
        (Advanced, "Finishing", "Relocation"),
        "Share of points that may move from crowded places into holes after each scale.",
    ),
    Parameter::whole(
        "alignment",
        0.0,
        1000.0,
        (Advanced, "Finishing", "Alignment"),
        "Rounds in which neighbourhoods that nearly match the exemplar are made to match at the end.",
    ),
    Parameter::whole(
        "transplants",
        0.0,
        10_000.0,
        (Advanced, "Finishing", "Single moves"),
        "Moves of single points from where one is too many to where one is missing.",
    ),
    Parameter::whole(
        "restarts",
        0.0,
        100.0,
        (Advanced, "Finishing", "Other tries"),
        "How often the regions that came out worst are tried again.",
    ),
    Parameter::real(
        "disk-overlap",
        0.0,
        1.0,
        (Advanced, "Finishing", "Disk overlap"),
        "Share of the exemplar's distances that disks keep where they must not overlap more; 0 is off.",
    ),
    Parameter::whole(
        "value-swaps",
        0.0,
        100.0,
        (Advanced, "Finishing", "Value exchanges"),
        "Sweeps of exchanges that bring values to where they fit; 0 leaves it to chance.",
    ),
    Parameter::whole(
        "convergence-window",
        10.0,
        5000.0,
        (Advanced, "Optimiser", "Convergence window"),
        "Iterations a scale runs at least, and looks back over.",
    ),
    Parameter::real(
        "convergence-tolerance",
        0.0,
        1.0,
        (Advanced, "Optimiser", "Convergence tolerance"),
        "A scale ends when its last window brought less than this share.",
    ),
    Parameter::choice(
        "boundary",
        &BOUNDARIES,
        (Main, "Border", "Border"),
        "What lies beyond the border of the result.",
    ),
    Parameter::choice(
        "start",
        &STARTS,
        (Advanced, "Optimiser", "Start"),
        "How the points stand before the first iteration.",
    ),
    Parameter::choice(
        "learning-rate-unit",
        &STEP_UNITS,
        (Advanced, "Optimiser", "Unit of the steps"),
        "What the two steps are multiples of.",
    ),
    Parameter::choice(
        "class-order",
        &CLASS_ORDERS,
        (Advanced, "Classes", "Order"),
        "In which order classes are placed; each sees those before it.",
    ),
    Parameter::choice("class-maps", &CLASS_MAPS, (Advanced, "Classes", "Maps"), "Whether the maps tell classes apart."),
];

impl Parameters {
    /// The parameters under their names in files.
    #[must_use]
    pub fn fields(&self) -> Map<String, Value> {
        match serde_json::to_value(self) {
            Ok(Value::Object(fields)) => fields,
            _ => Map::new(),
        }
    }

    /// From the names in files.
    ///
    /// # Errors
    /// When one is missing or unknown, or a value is of the wrong kind.
    pub fn from_fields(fields: Map<String, Value>) -> Result<Self, ParameterError> {
        serde_json::from_value(Value::Object(fields)).map_err(|error| ParameterError::Unreadable(error.to_string()))
    }

    /// The same parameters with some replaced. The values are checked one by one, not against each other.
    ///
    /// # Errors
    /// When a name is unknown, or a value is of the wrong kind or out of range.
    pub fn with_overrides(&self, overrides: &Map<String, Value>) -> Result<Self, ParameterError> {
        let mut fields = self.fields();
        for (name, value) in overrides {
            let Some(parameter) = PARAMETERS.iter().find(|parameter| parameter.name == name) else {
                let known: Vec<String> = fields.keys().cloned().collect();
                return Err(ParameterError::Unknown { name: name.clone(), known: known.join(", ") });
            };
            fields.insert(name.clone(), parameter.check(value)?);
        }
        Self::from_fields(fields)
    }

    /// The same parameters with some replaced by what is nearest and allowed. Names and kinds that are unknown are left
    /// out, and what depends on each other is put in order.
    #[must_use]
    pub fn with_nearest(&self, overrides: &Map<String, Value>) -> Self {
        let mut fields = self.fields();
        for parameter in &PARAMETERS {
            if let Some(value) = overrides.get(parameter.name).and_then(|value| parameter.nearest(value)) {
                fields.insert(parameter.name.to_owned(), value);
            }
        }
        let mut parameters = Self::from_fields(fields).unwrap_or_else(|_| self.clone());
        parameters.put_in_order();
        parameters
    }

    /// Raises what [`Self::validate`] wants to be at least as large as something else.
    fn put_in_order(&mut self) {
        self.grid_max = self.grid_max.max(self.grid_min);
        self.sigma_fine_divisor = self.sigma_fine_divisor.max(self.sigma_coarse_divisor);
    }

    /// The scale from which the worst regions try again: the finer half, where structures are closed.
    #[must_use]
    pub fn restart_scale(&self) -> usize {
        self.scales as usize / 2
    }

    /// What an engine needs to know of a scale; `place` is the class and the number of the scale.
    #[must_use]
    pub fn scale_settings(&self, scale: &Scale, place: (u16, u16)) -> ScaleSettings {
        ScaleSettings {
            boundary: self.boundary,
            sigma: scale.sigma,
            frequency: self.frequency,
            resolution: scale.resolution,
            margin_sigmas: self.margin_sigmas,
            weights: [self.gram_weight, self.correlation_weight],
            learning_rate: scale.learning_rate,
            jitter_px: self.jitter_px,
            seed: self.seed,
            class: place.0,
            scale: place.1,
        }
    }

    /// The real numbers by their names: JSON can't tell NaN from infinity, and whoever set one wants to know which. A
    /// test holds the names against the descriptions.
    fn reals(&self) -> [(&'static str, f64); 19] {
        [
            ("expansion-x", self.expansion_x),
            ("expansion-y", self.expansion_y),
            ("pixels-per-spacing", self.pixels_per_spacing),
            ("coarse-sigma-px", self.coarse_sigma_px),
            ("fine-sigma-px", self.fine_sigma_px),
            ("sigma-coarse-divisor", self.sigma_coarse_divisor),
            ("sigma-coarse-cells", self.sigma_coarse_cells),
            ("sigma-fine-divisor", self.sigma_fine_divisor),
            ("frequency", self.frequency),
            ("jitter-px", self.jitter_px),
            ("margin-sigmas", self.margin_sigmas),
            ("gram-weight", self.gram_weight),
            ("correlation-weight", self.correlation_weight),
            ("learning-rate-coarse", self.learning_rate_coarse),
            ("learning-rate-fine", self.learning_rate_fine),
            ("spacing-floor", self.spacing_floor),
            ("relocation", self.relocation),
            ("disk-overlap", self.disk_overlap),
            ("convergence-tolerance", self.convergence_tolerance),
        ]
    }

    /// Checks every value against its description, and the ones that depend on each other.
    ///
    /// # Errors
    /// The first offence, with the parameter's name, its value and what is allowed.
    pub fn validate(&self) -> Result<(), ParameterError> {
        let fields = self.fields();
        let reals = self.reals();
        for parameter in &PARAMETERS {
            match reals.iter().find(|(name, value)| *name == parameter.name && !value.is_finite()) {
                Some(&(_, value)) => parameter.check_number(value)?,
                None => parameter.check(&fields[parameter.name]).map(|_| ())?,
            }
        }
        let at_least = |name, value: f64, other, bound: f64| {
            if value < bound { Err(ParameterError::Order { name, value, other, bound }) } else { Ok(()) }
        };
        at_least("grid-max", self.grid_max.into(), "grid-min", self.grid_min.into())?;
        at_least("sigma-fine-divisor", self.sigma_fine_divisor, "sigma-coarse-divisor", self.sigma_coarse_divisor)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Preset;
    use super::*;
    use crate::run::Kind;

    #[test]
    fn every_field_is_described_once() {
        let fields = Parameters::preset(Preset::Fast).fields();
        for name in fields.keys() {
            assert_eq!(PARAMETERS.iter().filter(|parameter| parameter.name == name).count(), 1, "{name}");
        }
        assert_eq!(fields.len(), PARAMETERS.len());
        for parameter in &PARAMETERS {
            assert!(parameter.check(&fields[parameter.name]).is_ok(), "{}", parameter.name);
            assert!(parameter.meaning.ends_with('.') && !parameter.title.is_empty(), "{}", parameter.name);
        }
    }

    #[test]
    fn every_real_number_is_told_from_infinity() {
        let reals = Parameters::preset(Preset::Fast).reals().map(|(name, _)| name);
        let described = PARAMETERS.iter().filter(|it| matches!(it.kind, Kind::Number { whole: false, .. }));
        assert!(described.clone().all(|parameter| reals.contains(&parameter.name)));
        assert_eq!(described.count(), reals.len());
        let fields = Parameters::preset(Preset::Fast).fields();
        for (name, value) in Parameters::preset(Preset::Fast).reals() {
            assert_eq!(fields[name].as_f64(), Some(value), "{name}");
        }
    }

    #[test]
    fn every_choice_can_be_made() {
        for parameter in &PARAMETERS {
            let Kind::Choice(choices) = parameter.kind else { continue };
            for choice in choices {
                let chosen = [(parameter.name.to_owned(), Value::from(choice.name))].into_iter().collect();
                let fields = Parameters::preset(Preset::Fast).with_overrides(&chosen).map(|made| made.fields());
                assert_eq!(fields.map(|fields| fields[parameter.name].clone()), Ok(Value::from(choice.name)));
            }
        }
    }
}
