//! Statistics of point patterns, and a judge of how well one reproduces another.
//!
//! Everything works on a [`Cloud`]: points in a rectangle in one unit of length. A pattern on its own is measured in
//! its exemplar units; an output in those of its exemplar, with the exemplar's [`Scales`], so that curves of both sides
//! lie on the same axes. Nothing here does I/O, and all of it runs in wasm, fast enough to follow a run.
//!
//! | module | what it measures | source |
//! |---|---|---|
//! | `nearest` | distances to the k-th nearest neighbour | Clark & Evans 1954, Thompson 1956 |
//! | `pair_correlation` | how many neighbours at which distance, also between classes | Öztireli & Gross 2012 |
//! | `pair_density` | the same with directions | Ohser & Stoyan 1981 |
//! | `marks` | whether classes and attributes go with places: mark correlation, and the same at random | Stoyan & Stoyan 1994 |
//! | `spectrum` | periodogram, radial mean | Bartlett 1964, Ulichney 1988 |
//! | `ripley` | K, L, envelopes of chance | Ripley 1976, Besag 1977 |
//! | `region` | the same in windows of any outline; the part of a rectangle that points fill | Ohser & Stoyan 1981, Ripley & Rasson 1977 |
//! | `spacing` | ρ, stacked points, clumps, holes, crowded borders | Lagae & Dutré 2008 |
//! | `overlap` | areas that disks share, relative penetration | our own |
//! | `transport` | Chamfer, Wasserstein, the paper's patches | Huang et al. 2022 |
//! | `neighbourhoods` | neighbourhoods found again: precision, coverage | our own; the comparison after Ma, Wei & Tong 2011 |
//! | `quality` | one number: 0 is chance, 1 the exemplar tiled | our own |
//! | `scores` | the other distances on that scale (native only) | our own |
//! | `verdict` | the quality in words | |
//! | `live` | what of all this follows a run | |
//! | `report` | everything as an SVG (native only) | |

mod cloud;
mod error;
mod live;
mod marks;
mod nearest;
mod neighbourhoods;
mod neighbours;
mod overlap;
mod pair_correlation;
mod pair_density;
mod quality;
mod region;
mod ripley;
#[cfg(not(target_arch = "wasm32"))]
mod scores;
mod spacing;
mod spectrum;
mod transport;
mod verdict;

pub use cloud::Cloud;
pub use error::AnalysisError;
pub use live::{Curves, Live};
pub use marks::{
    ASSIGNMENTS, AttributeCorrelation, AttributeError, ClassPairError, MarkComparison, MarkCorrelation, MarkError,
    MarkFunction, mark_correlation,
};
#[cfg(not(target_arch = "wasm32"))]
pub(crate) use nearest::quantile;
pub use nearest::{Histogram, NEIGHBOURS, NearestDistances, Summary, nearest_distances};
pub use neighbourhoods::{NEIGHBOURHOOD, NeighbourhoodMatch, Neighbourhoods};
pub use neighbours::{Neighbour, Neighbours};
pub use overlap::{ClassOverlap, OverlapStatistics, check_radii, lens_area};
pub use pair_correlation::{
    CrossCorrelation, PairCorrelation, PairCorrelationSettings, class_pair_correlations, cross_pair_correlation,
    densest_distance, pair_correlation,
};
pub use pair_density::{PairDensity, PairDensitySettings, class_pair_densities, pair_density};
pub use quality::{Distances, Quality, QualityScale, normalised_quality, tile};
pub use ripley::{Envelope, Ripley, RipleySettings, envelope, ripley};
#[cfg(not(target_arch = "wasm32"))]
pub use scores::{Score, scores};
pub use spacing::{
    BorderCrowd, CLUMP_SIZES, EmptyCircle, border_crowd, clumps, largest_empty_circle, relative_radius,
    relative_radius_in, stacked, stacking_distance, tightest_clumps,
};
pub use spectrum::{Periodogram, RadialSpectrum, periodogram};
pub use transport::{MAX_ASSIGNMENT, PatchComparison, chamfer, compare_patches, wasserstein};
pub use verdict::{describe, verdict};

use serde::{Deserialize, Serialize};

use glam::DVec2;

use crate::pattern::{Boundary, Domain, PointPattern, Window};
use crate::sampling::{Purpose, Rng};

/// Simulated patterns of an envelope: with 99 the chance that one point of a curve leaves it is 2 %.
pub const SIMULATIONS: usize = 99;

/// At which distances, frequencies and widths statistics are taken. An output takes its exemplar's, so that both can
/// be laid over one another. Lengths are in exemplar units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scales {
    /// Mean distance to the nearest neighbour, d.
    pub spacing: f64,
    /// Of the pair correlation.
    pub pair_correlation: PairCorrelationSettings,
    /// Of the density of pair differences.
    pub pair_density: PairDensitySettings,
    /// Width of the intervals of the histogram of nearest distances: d / 16.
    pub histogram_width: f64,
    /// How many of them: up to 2.5 d.
    pub histogram_count: usize,
    /// Highest frequency of the periodogram, in cycles per unit: 3 √density, beyond the second ring of a lattice.
    pub max_frequency: f64,
    /// Width of the rings of its radial mean: one cycle of the exemplar's shorter side, at most a 12th of all.
    pub ring_width: f64,
    /// Of Ripley's K and L.
    pub ripley: RipleySettings,
}

impl Scales {
    /// The scales that suit a pattern.
    ///
    /// # Errors
    /// With a single point, or all points in one place.
    pub fn of(cloud: &Cloud) -> Result<Self, AnalysisError> {
        let spacing = cloud.spacing_for("an analysis")?;
        let max_frequency = 3.0 * cloud.density().sqrt();
        Ok(Self {
            spacing,
            pair_correlation: PairCorrelationSettings::suited_to(cloud),
            pair_density: PairDensitySettings::suited_to(cloud, spacing),
            histogram_width: spacing / 16.0,
            histogram_count: 40,
            max_frequency,
            ring_width: (1.0 / cloud.size().min_element()).min(max_frequency / 12.0),
            ripley: RipleySettings::suited_to(cloud),
        })
    }
}

/// What can be said about one pattern. Lengths are in exemplar units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Analysis {
    /// How many points there are.
    pub points: usize,
    /// How many of each class.
    pub class_sizes: Vec<usize>,
    /// Width and height of the rectangle.
    pub size: [f64; 2],
    /// The part of the rectangle that areas, pairs, holes and chance are those of; none is all of it.
    #[serde(default)]
    pub part: Option<Part>,
    /// Window or tile.
    pub boundary: Boundary,
    /// Points per unit of area.
    pub density: f64,
    /// Mean distance to the nearest neighbour; none when all points lie in one place.
    pub spacing: Option<f64>,
    /// Clark & Evans's (1954) index: the mean spacing over that of independent points. Below 1 points cluster. Of a part
    /// that is not the whole rectangle, with its envelope: over the mean of the simulated patterns, borders included.
    pub aggregation_index: Option<f64>,
    /// ρ, see [`relative_radius`].
    pub relative_radius: f64,
    /// Distances to the first, second, … nearest neighbour: up to [`NEIGHBOURS`], fewer with few points.
    pub nearest: Vec<Summary>,
    /// Distances to the nearest neighbour.
    pub nearest_histogram: Histogram,
    /// All points, whatever their class.
    pub pair_correlation: PairCorrelation,
    /// Within and between classes; empty when there is one class. Classes without enough points are left out.
    pub cross_correlations: Vec<CrossCorrelation>,
    /// Of the attributes, if [`Self::with_marks`] was asked for. Attributes whose mean is 0 have none.
    pub mark_correlations: Vec<AttributeCorrelation>,
    /// Radial mean of the periodogram.
    pub spectrum: RadialSpectrum,
    /// Ripley's K and L.
    pub ripley: Ripley,
    /// What chance does to L, if it was asked for.
    pub envelope: Option<Envelope>,
    /// The largest hole.
    pub largest_empty_circle: EmptyCircle,
    /// Points within 0.05 d of the border of a window that is a rectangle.
    pub border: Option<BorderCrowd>,
}

impl Analysis {
    /// Width of the strip along a border in which points are crowded rather than near, in mean spacings.
    pub const BORDER: f64 = 0.05;

    /// Analyses a cloud: some milliseconds for a thousand points.
    ///
    /// # Errors
    /// With a single point, or scales out of range.
    pub fn of(cloud: &Cloud, scales: &Scales) -> Result<Self, AnalysisError> {
        let nearest = nearest_distances(cloud, NEIGHBOURS)?;
        let density = cloud.density();
        let spacing = cloud.mean_spacing();
        let class_sizes = cloud.class_sizes();
        let cross_correlations =
            if class_sizes.len() > 1 { class_pair_correlations(cloud, &scales.pair_correlation)? } else { Vec::new() };
        Ok(Self {
            points: cloud.len(),
            class_sizes,
            size: cloud.size().into(),
            part: cloud.region().map(|region| Part::of(region, cloud)),
            boundary: cloud.boundary(),
            density,
            spacing,
            aggregation_index: spacing.map(|spacing| 2.0 * spacing * density.sqrt()),
            relative_radius: relative_radius(cloud)?,
            nearest: (1..=nearest.neighbours).filter_map(|k| Summary::of(nearest.of_rank(k))).collect(),
            nearest_histogram: Histogram::of(nearest.of_rank(1), scales.histogram_width, scales.histogram_count),
            pair_correlation: pair_correlation(cloud, &scales.pair_correlation)?,
            cross_correlations,
            mark_correlations: Vec::new(),
            spectrum: periodogram(cloud, scales.max_frequency)?.radial_mean(scales.ring_width)?,
            ripley: ripley(cloud, &scales.ripley)?,
            envelope: None,
            largest_empty_circle: largest_empty_circle(cloud),
            border: border_crowd(cloud, Self::BORDER * scales.spacing)?,
        })
    }

    /// Analyses a pattern on its own, in its exemplar units, with the envelope of [`SIMULATIONS`] simulations. Where the
    /// points fill only a convex part of their rectangle, it is that part's, see [`Cloud::of_part`].
    ///
    /// # Errors
    /// With a single point, or all points in one place.
    pub fn of_pattern(pattern: &PointPattern, seed: u64) -> Result<Self, AnalysisError> {
        Self::of_pattern_within(pattern, None, seed)
    }

    /// [`Self::of_pattern`] within a window in the pattern's unit; without one, the same.
    ///
    /// # Errors
    /// Those of [`Self::of_pattern`] and [`Cloud::of_part`].
    pub fn of_pattern_within(
        pattern: &PointPattern,
        window: Option<&Window>,
        seed: u64,
    ) -> Result<Self, AnalysisError> {
        let cloud = Cloud::of_part(pattern, window)?;
        let scales = Scales::of(&cloud)?;
        Self::of(&cloud, &scales)?.with_marks(&cloud, pattern, &scales).with_envelope(&cloud, &scales, seed)
    }

    /// Adds the mark correlations of the attributes of the pattern that the cloud this analysis is of was made from.
    #[must_use]
    pub fn with_marks(mut self, cloud: &Cloud, pattern: &PointPattern, scales: &Scales) -> Self {
        self.mark_correlations = marks::attribute_correlations(cloud, pattern, scales);
        self
    }

    /// Adds the envelope of [`SIMULATIONS`] simulations for the cloud this analysis is of.
    ///
    /// # Errors
    /// As [`envelope`].
    pub fn with_envelope(mut self, cloud: &Cloud, scales: &Scales, seed: u64) -> Result<Self, AnalysisError> {
        self.envelope = Some(envelope(cloud, &self.ripley, &scales.ripley, SIMULATIONS, seed)?);
        if self.part.is_some() {
            self.aggregation_index = self.spacing.map(|spacing| spacing / independent_spacing(cloud, seed));
        }
        Ok(self)
    }
}

/// Mean spacing of as many independent points in the same window: that of the simulations of an envelope.
fn independent_spacing(cloud: &Cloud, seed: u64) -> f64 {
    let spacing = |simulation| {
        let mut rng = Rng::new(seed, Purpose::Analysis(simulation as u32));
        cloud.independent(&mut rng).mean_spacing().unwrap_or(0.0)
    };
    (0..SIMULATIONS).map(spacing).sum::<f64>() / SIMULATIONS as f64
}

/// The part of a rectangle that statistics are taken in.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// Its share of the rectangle.
    pub share: f64,
    /// Whether it is a guess from the points: their convex hull, a little larger.
    pub found: bool,
    /// Its closed lines, in exemplar units from the rectangle's lower corner.
    pub outline: Vec<Vec<[f64; 2]>>,
}

impl Part {
    fn of(region: &region::Region, cloud: &Cloud) -> Self {
        let corners = |ring: &Vec<DVec2>| ring.iter().copied().map(Into::into).collect();
        Self {
            share: region.area() / (cloud.size().x * cloud.size().y),
            found: region.found(),
            outline: region.window().rings().iter().map(corners).collect(),
        }
    }

    /// It as a window in exemplar units.
    ///
    /// # Errors
    /// When the outline is none.
    pub fn window(&self) -> Result<Window, AnalysisError> {
        let rings = self.outline.iter().map(|ring| ring.iter().copied().map(DVec2::from).collect());
        Window::new(rings.collect()).map_err(|error| AnalysisError::Window { reason: error.to_string() })
    }
}

/// What an output has that it should not.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Defects {
    /// Points nearer than this are stacked, in exemplar units; see [`stacking_distance`].
    pub stacking_distance: f64,
    /// Share of the output's points that are stacked.
    pub stacked: f64,
    /// The same of the exemplar.
    pub exemplar_stacked: f64,
    /// How much tighter the output's tightest clump of three to seven points is than the exemplar's; see [`clumps`]. Of
    /// samples of one process the larger one naturally has a somewhat tighter one.
    pub clumps: f64,
    /// Radius of the output's largest empty circle over that of the exemplar's. In a random pattern the largest of a
    /// larger rectangle is naturally somewhat larger.
    pub holes: f64,
    /// [`BorderCrowd::excess`] of the output's points within 0.05 d of an open border, less the exemplar's own. None
    /// for a tile.
    pub border: Option<f64>,
}

impl Defects {
    /// Measures an output, in the exemplar's unit.
    ///
    /// # Errors
    /// When either has fewer than two points, or the exemplar all in one place.
    pub fn of(exemplar: &Cloud, output: &Cloud) -> Result<Self, AnalysisError> {
        let spacing = exemplar.spacing_for("a search for defects")?;
        let distance = stacking_distance(exemplar)?;
        let (own, wanted) = (largest_empty_circle(output).radius, largest_empty_circle(exemplar).radius);
        let width = Analysis::BORDER * spacing;
        let usual = border_crowd(exemplar, width)?.map_or(0.0, |border| border.excess);
        Ok(Self {
            stacking_distance: distance,
            stacked: stacked(output, distance)?,
            exemplar_stacked: stacked(exemplar, distance)?,
            clumps: clumps(exemplar, output)?,
            holes: own / wanted.max(f64::MIN_POSITIVE),
            border: border_crowd(output, width)?.map(|border| border.excess - usual),
        })
    }
}

/// An output against its exemplar. Lengths are in exemplar units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Length of the exemplar unit in the patterns' own unit.
    pub unit: f64,
    /// Distances and widths of all curves.
    pub scales: Scales,
    /// The exemplar.
    pub exemplar: Analysis,
    /// The output.
    pub output: Analysis,
    /// The output's density over the exemplar's.
    pub density_ratio: f64,
    /// Mean squared difference of the two pair correlations.
    pub pair_correlation_error: f64,
    /// Normalised quality.
    pub quality: Quality,
    /// Distances that score 0.
    pub chance: Distances,
    /// Distances that score 1.
    pub tiled: Distances,
    /// Stacked points, clumps, holes, crowded borders.
    pub defects: Defects,
    /// The paper's numbers, where a patch has two points.
    pub patches: Option<PatchComparison>,
    /// Classes and attributes, where there are any.
    pub marks: Option<MarkComparison>,
    /// Share of their rectangle that the points of the exemplar and of the output fill, where the rest is emptier than
    /// chance leaves it. All statistics here are those of the whole rectangles.
    #[serde(default)]
    pub filled: [Option<f64>; 2],
}

impl Comparison {
    /// Compares both patterns in the same unit of length. The same seed gives the same numbers.
    ///
    /// # Errors
    /// When the exemplar has no two points in different places, or the output fewer than two points.
    pub fn of(exemplar: &PointPattern, output: &PointPattern, seed: u64) -> Result<Self, AnalysisError> {
        let judge = Judge::new(exemplar, output, seed)?;
        judge.compare(output)
    }
}

/// An exemplar and what it takes to judge outputs of one kind: made once, it follows a run.
#[derive(Clone, Debug)]
pub struct Judge {
    pattern: PointPattern,
    unit: f64,
    seed: u64,
    scales: Scales,
    cloud: Cloud,
    curves: Curves,
    domain: Domain,
    boundary: Boundary,
    class_sizes: Vec<usize>,
    quality: QualityScale,
}

impl Judge {
    /// Prepares to judge outputs with the domain, boundary and classes of `output`, be it a start or a result.
    ///
    /// # Errors
    /// When the exemplar has no two points in different places, or the output fewer than two points.
    pub fn new(exemplar: &PointPattern, output: &PointPattern, seed: u64) -> Result<Self, AnalysisError> {
        let unit = exemplar_unit(exemplar);
        let (cloud, points) = common_classes(exemplar, output, unit)?;
        let scales = Scales::of(&cloud)?;
        let curves = Curves::of(&cloud, &scales)?;
        let class_sizes = points.class_sizes();
        let quality = QualityScale::new(&cloud, points.size(), points.boundary(), &class_sizes, seed)?;
        let (domain, boundary) = (output.domain(), output.boundary());
        Ok(Self {
            pattern: exemplar.clone(),
            unit,
            seed,
            scales,
            cloud,
            curves,
            domain,
            boundary,
            class_sizes,
            quality,
        })
    }

    /// The scales of all curves.
    #[must_use]
    pub fn scales(&self) -> &Scales {
        &self.scales
    }

    /// The output in the exemplar's unit, and a judge prepared for it if this one is not.
    fn admit(&self, output: &PointPattern) -> Result<(Cloud, Option<Self>), AnalysisError> {
        let (_, points) = common_classes(&self.pattern, output, self.unit)?;
        let prepared = (output.domain(), output.boundary()) == (self.domain, self.boundary)
            && points.class_sizes() == self.class_sizes;
        let other = if prepared { None } else { Some(Self::new(&self.pattern, output, self.seed)?) };
        Ok((points, other))
    }

    /// Judges an output in full. One of another domain, boundary or class sizes than prepared for is judged as if it
    /// had been.
    ///
    /// # Errors
    /// With fewer than two points.
    pub fn compare(&self, output: &PointPattern) -> Result<Comparison, AnalysisError> {
        let (points, other) = self.admit(output)?;
        let judge = other.as_ref().unwrap_or(self);
        let analyse = |cloud, pattern| {
            let analysis = Analysis::of(cloud, &judge.scales)?.with_marks(cloud, pattern, &judge.scales);
            analysis.with_envelope(cloud, &judge.scales, judge.seed)
        };
        let pattern = output;
        let (exemplar, output) = (analyse(&judge.cloud, &judge.pattern)?, analyse(&points, pattern)?);
        let marked = marks::Marked { cloud: &judge.cloud, pattern: &judge.pattern, analysis: &exemplar };
        let own = marks::Marked { cloud: &points, pattern, analysis: &output };
        Ok(Comparison {
            marks: marks::compare_marks(&marked, &own, &judge.scales, judge.seed)?,
            filled: [&judge.cloud, &points]
                .map(|cloud| region::filled_part(cloud).map(|window| window.area() / cloud.area())),
            unit: judge.unit,
            scales: judge.scales,
            density_ratio: output.density / exemplar.density,
            pair_correlation_error: output
                .pair_correlation
                .mean_squared_difference(&exemplar.pair_correlation)
                .unwrap_or(f64::INFINITY),
            exemplar,
            output,
            quality: judge.quality.judge(&points)?,
            chance: judge.quality.chance,
            tiled: judge.quality.tiled,
            defects: Defects::of(&judge.cloud, &points)?,
            patches: compare_patches(&judge.cloud, &points).ok(),
        })
    }

    /// Judges an output while it comes into being: some milliseconds for a few hundred points.
    ///
    /// # Errors
    /// With fewer than two points.
    pub fn follow(&self, output: &PointPattern) -> Result<Live, AnalysisError> {
        let (points, other) = self.admit(output)?;
        let judge = other.as_ref().unwrap_or(self);
        Live::of(&judge.scales, (&judge.cloud, &judge.curves), &points, judge.quality.judge(&points)?)
    }
}

/// The unit both sides of a comparison are measured in.
pub(crate) fn exemplar_unit(exemplar: &PointPattern) -> f64 {
    exemplar.domain().exemplar_unit()
}

/// Both patterns in one unit, with one numbering of classes: the exemplar's, then what only the output has. Classes
/// are the same when their names are, or when there is one on each side.
pub(crate) fn common_classes(
    exemplar: &PointPattern,
    output: &PointPattern,
    unit: f64,
) -> Result<(Cloud, Cloud), AnalysisError> {
    let known = exemplar.class_names();
    let mut more: Vec<&String> = Vec::new();
    let alone = known.len() == 1 && output.class_names().len() == 1;
    let numbers: Vec<u16> = output
        .class_names()
        .iter()
        .map(|name| match known.iter().position(|other| other == name) {
            Some(number) => number as u16,
            None if alone => 0,
            None => {
                more.push(name);
                (known.len() + more.len() - 1) as u16
            }
        })
        .collect();
    let count = known.len() + more.len();
    let (exemplar, output) = (Cloud::in_unit(exemplar, unit)?, Cloud::in_unit(output, unit)?);
    let renumber = |class: u16| numbers.get(usize::from(class)).copied().unwrap_or(class);
    Ok((exemplar.renumbered(count, |class| class), output.renumbered(count, renumber)))
}
