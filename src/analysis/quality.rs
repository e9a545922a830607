//! One number for how well an output reproduces its exemplar.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::cloud::Cloud;
use super::error::AnalysisError;
use super::neighbourhoods::{NeighbourhoodMatch, Neighbourhoods};
use super::pair_density::{PairDensity, PairDensitySettings, class_pair_densities};
use super::{common_classes, exemplar_unit};
use crate::pattern::{Boundary, PointPattern};
use crate::sampling::{Purpose, Rng, poisson_disk, white_noise};

/// How many starts of each kind the zero is averaged over.
pub(super) const STARTS: u64 = 3;
/// Nothing scores below: an output as much worse than chance as chance is worse than the tiling, or more.
const LOWEST: f64 = -1.0;
/// Seeds of starts are this far from the caller's, so that judging a start by its own seed does not meet the same
/// points.
const START_STREAM: u32 = 1 << 20;

/// Distances between an exemplar and an output; smaller is better, 0 is best.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Distances {
    /// Mean absolute difference of the two densities of pair differences (1 is the density of chance), averaged over
    /// pairs of classes by their share of the exemplar's pairs.
    pub pair_density: f64,
    /// Precision and coverage of neighbourhoods, in mean spacings.
    #[serde(flatten)]
    pub neighbourhoods: NeighbourhoodMatch,
}

/// Normalised quality: 0 is chance, 1 the exemplar tiled onto the output's domain. Each part may lie above 1 (an open
/// exemplar's tiling has seams that an output need not have) and reaches down to −1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    /// Mean of the three parts.
    pub score: f64,
    /// Score of the density of pair differences: the arrangement of pairs within 3.5 mean spacings.
    pub pair_density: f64,
    /// Score of the output's neighbourhoods: whether what is there should be.
    pub precision: f64,
    /// Score of the exemplar's neighbourhoods: whether what should be is there.
    pub coverage: f64,
    /// What an independent sample of the exemplar's process would score, roughly: the score of the exemplar's
    /// neighbourhoods against one another. 1 for a lattice; for a random pattern less, and an output that scores more
    /// has copied from the exemplar.
    pub independent: f64,
    /// What was measured.
    pub distances: Distances,
}

/// What an output is judged by: an exemplar, and what chance and the tiled exemplar score on the output's domain.
/// Made once, it judges every state of a run.
#[derive(Clone, Debug)]
pub struct QualityScale {
    reference: Reference,
    /// Distances that score 0: the worse of white noise and the Poisson-disk start, each averaged over several.
    pub chance: Distances,
    /// Distances that score 1: the exemplar tiled onto the domain.
    pub tiled: Distances,
}

/// The exemplar's side of every comparison.
#[derive(Clone, Debug)]
struct Reference {
    spacing: f64,
    settings: PairDensitySettings,
    /// Densities by classes, and their share of all pairs.
    densities: Vec<(u16, u16, f64, PairDensity)>,
    neighbourhoods: Neighbourhoods,
    kinship: f64,
}

impl Reference {
    fn of(exemplar: &Cloud) -> Result<Self, AnalysisError> {
        let spacing = exemplar.spacing_for("quality")?;
        let settings = PairDensitySettings::suited_to(exemplar, spacing);
        let sizes = exemplar.class_sizes();
        let densities = class_pair_densities(exemplar, &settings)?
            .into_iter()
            .map(|(a, b, density)| {
                let pairs = sizes[usize::from(a)] as f64 * sizes[usize::from(b)] as f64;
                (a, b, if a == b { pairs } else { 2.0 * pairs }, density)
            })
            .collect();
        let neighbourhoods = Neighbourhoods::of(exemplar, spacing)?;
        let kinship = neighbourhoods.kinship();
        Ok(Self { spacing, settings, densities, neighbourhoods, kinship })
    }

    fn distances(&self, output: &Cloud) -> Result<Distances, AnalysisError> {
        output.at_least("quality", 2)?;
        let found = class_pair_densities(output, &self.settings)?;
        let (mut sum, mut weights) = (0.0, 0.0);
        for (a, b, weight, density) in &self.densities {
            // Pairs that the output does not have at all are a density of 0.
            let empty = || PairDensity { values: vec![0.0; density.values.len()], ..density.clone() };
            let own = found.iter().find(|(x, y, _)| (x, y) == (a, b)).map_or_else(empty, |(_, _, own)| own.clone());
            sum += weight * own.mean_absolute_difference(density).unwrap_or(f64::INFINITY);
            weights += weight;
        }
        let neighbourhoods = Neighbourhoods::compare(&self.neighbourhoods, &Neighbourhoods::of(output, self.spacing)?);
        Ok(Distances { pair_density: sum / f64::max(weights, f64::MIN_POSITIVE), neighbourhoods })
    }
}

impl QualityScale {
    /// Prepares to judge outputs of this size and boundary, with `class_sizes[c]` points of class c. Both clouds' unit
    /// is the exemplar's; the same seed gives the same scale.
    ///
    /// # Errors
    /// When the exemplar has no two points in different places, or the output fewer than two points.
    pub fn new(
        exemplar: &Cloud,
        size: DVec2,
        boundary: Boundary,
        class_sizes: &[usize],
        seed: u64,
    ) -> Result<Self, AnalysisError> {
        let reference = Reference::of(exemplar)?;
        let mut kinds = [Vec::new(), Vec::new()];
        for number in 0..STARTS {
            for (kind, list) in kinds.iter_mut().enumerate() {
                list.push(reference.distances(&start_of((kind, number), size, boundary, class_sizes, seed)?)?);
            }
        }
        let [white, blue] = kinds.map(|list| mean(&list));
        let chance = Distances {
            pair_density: white.pair_density.max(blue.pair_density),
            neighbourhoods: NeighbourhoodMatch {
                precision: white.neighbourhoods.precision.max(blue.neighbourhoods.precision),
                coverage: white.neighbourhoods.coverage.max(blue.neighbourhoods.coverage),
            },
        };
        let tiled = reference.distances(&tile(exemplar, size, boundary)?)?;
        Ok(Self { reference, chance, tiled })
    }

    /// Judges an output in the exemplar's unit.
    ///
    /// # Errors
    /// With fewer than two points.
    pub fn judge(&self, output: &Cloud) -> Result<Quality, AnalysisError> {
        let distances = self.reference.distances(output)?;
        let (own, chance, tiled) = (distances.neighbourhoods, self.chance.neighbourhoods, self.tiled.neighbourhoods);
        let pair_density = score(distances.pair_density, self.chance.pair_density, self.tiled.pair_density);
        let precision = score(own.precision, chance.precision, tiled.precision);
        let coverage = score(own.coverage, chance.coverage, tiled.coverage);
        let independent = score(self.reference.kinship, chance.precision, tiled.precision).clamp(0.0, 1.0);
        let mean = (pair_density + precision + coverage) / 3.0;
        Ok(Quality { score: mean, pair_density, precision, coverage, independent, distances })
    }
}

/// A distance on the scale of the quality: 0 is as `chance`, 1 as `tiled`, and no less than −1.
pub(super) fn score(value: f64, chance: f64, tiled: f64) -> f64 {
    if chance - tiled > 1e-9 {
        ((chance - value) / (chance - tiled)).max(LOWEST)
    } else {
        // The exemplar is itself no different from chance: whatever is as good gets everything.
        f64::from(u8::from(value <= tiled + 1e-9))
    }
}

/// The start of this number, a white noise (`kind` 0) or a Poisson-disk start, with `class_sizes[c]` points of class c.
pub(super) fn start_of(
    (kind, number): (usize, u64),
    size: DVec2,
    boundary: Boundary,
    class_sizes: &[usize],
    seed: u64,
) -> Result<Cloud, AnalysisError> {
    let (mut points, mut classes) = (Vec::new(), Vec::new());
    for (class, &count) in class_sizes.iter().enumerate() {
        let stream = START_STREAM + (class as u32) * 4 + kind as u32;
        let mut rng = Rng::new(seed.wrapping_add(number), Purpose::Analysis(stream));
        points.extend(match kind {
            0 => white_noise(&mut rng, size, count),
            _ => poisson_disk(&mut rng, size, count, boundary),
        });
        classes.resize(points.len(), class as u16);
    }
    Cloud::new(points, size, boundary)?.with_classes(classes)
}

/// The normalised quality of an output, both patterns in the same unit of length: the mean over the density of pair
/// differences, the precision and the coverage of neighbourhoods, each scaled so that 0 is the worse of white noise
/// and the Poisson-disk start and 1 is the exemplar tiled onto the output's domain. Classes are matched by name.
///
/// # Errors
/// When the exemplar has no two points in different places, or the output fewer than two points.
pub fn normalised_quality(exemplar: &PointPattern, output: &PointPattern, seed: u64) -> Result<Quality, AnalysisError> {
    let unit = exemplar_unit(exemplar);
    let (exemplar, output) = common_classes(exemplar, output, unit)?;
    QualityScale::new(&exemplar, output.size(), output.boundary(), &output.class_sizes(), seed)?.judge(&output)
}

/// Copies of the exemplar side by side from the lower corner on, cut off at `size`.
///
/// # Errors
/// When `size` is no rectangle, or so small that no point falls into it.
pub fn tile(exemplar: &Cloud, size: DVec2, boundary: Boundary) -> Result<Cloud, AnalysisError> {
    let tiles = (size / exemplar.size() - 1e-9).ceil().clamp(DVec2::ONE, DVec2::splat(64.0));
    let (mut points, mut classes) = (Vec::new(), Vec::new());
    for row in 0..tiles.y as usize {
        for column in 0..tiles.x as usize {
            let shift = DVec2::new(column as f64, row as f64) * exemplar.size();
            for (&point, &class) in exemplar.points().iter().zip(exemplar.classes()) {
                let point = point + shift;
                if point.cmple(size).all() {
                    points.push(point);
                    classes.push(class);
                }
            }
        }
    }
    Cloud::new(points, size, boundary)?.with_classes(classes)
}

fn mean(list: &[Distances]) -> Distances {
    let of = |part: fn(&Distances) -> f64| list.iter().map(part).sum::<f64>() / list.len().max(1) as f64;
    Distances {
        pair_density: of(|one| one.pair_density),
        neighbourhoods: NeighbourhoodMatch {
            precision: of(|one| one.neighbourhoods.precision),
            coverage: of(|one| one.neighbourhoods.coverage),
        },
    }
}
