//! What belongs to the points, and how it goes with their places: classes against classes, attributes against distance.

use serde::{Deserialize, Serialize};

use super::cloud::Cloud;
use super::error::AnalysisError;
use super::pair_correlation::{PairCorrelationSettings, Sums};
use super::{Analysis, CrossCorrelation, Scales, class_pair_correlations};
use crate::pattern::{ORIENTATION_ATTRIBUTE, PointPattern};
use crate::sampling::{Purpose, Rng};

/// Where fewer pairs than this share of chance's lie at a distance, they tell nothing of their marks: a few pairs that
/// the kernel just reaches would decide everything.
const LEAST_PAIRS: f64 = 0.05;

/// Random assignments that an output is compared with.
pub const ASSIGNMENTS: u32 = 19;
/// Their streams of random numbers begin here; those of simulated patterns lie below.
const FIRST_ASSIGNMENT: u32 = 1_000_000;

/// How the marks of two points become one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MarkFunction {
    /// The product, over the square of the mean of all marks: 1 is independence.
    Product,
    /// The cosine of the difference of two directions in degrees: 1 is parallel, −1 opposite. Independence is the
    /// square of the mean resultant length, 0 where no direction is preferred.
    Direction,
}

impl MarkFunction {
    /// What suits an attribute: directions for `orientation`, else the product.
    #[must_use]
    pub fn for_attribute(name: &str) -> Self {
        if name == ORIENTATION_ATTRIBUTE { Self::Direction } else { Self::Product }
    }
}

/// The mark correlation k(r): how alike the marks of two points at distance r are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MarkCorrelation {
    /// How two marks were put together.
    pub function: MarkFunction,
    /// The sampled distances, in the cloud's unit.
    pub radius: Vec<f64>,
    /// k at each of them; none where hardly two points are so far apart.
    pub value: Vec<Option<f64>>,
    /// What independent marks would have.
    pub independent: f64,
}

impl MarkCorrelation {
    /// Mean squared difference where both are known; `None` when that is nowhere or they were sampled differently.
    #[must_use]
    pub fn mean_squared_difference(&self, other: &Self) -> Option<f64> {
        if self.radius != other.radius || self.function != other.function {
            return None;
        }
        let both = self.value.iter().zip(&other.value).filter_map(|(&a, &b)| Some((a? - b?).powi(2)));
        let (sum, count) = both.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
        (count > 0.0).then(|| sum / count)
    }
}

/// The mark correlation function (Stoyan & Stoyan 1994, *Fractals, Random Shapes and Point Fields*, §14.7): the mean
/// of f(mᵢ, mⱼ) over all pairs at distance r, over what it would be for independent marks. Both sums are those of
/// [`pair_correlation`](super::pair_correlation()): the same Gaussian kernel, the same correction for the border.
///
/// # Errors
/// With a single point, not one finite mark a point, settings that are not positive, or marks whose mean is 0 against
/// their size: then the product has nothing to be measured by.
pub fn mark_correlation(
    cloud: &Cloud,
    marks: &[f64],
    function: MarkFunction,
    settings: &PairCorrelationSettings,
) -> Result<MarkCorrelation, AnalysisError> {
    cloud.at_least("the mark correlation", 2)?;
    settings.check()?;
    if marks.len() != cloud.len() {
        return Err(AnalysisError::Marks { count: marks.len(), points: cloud.len() });
    }
    if let Some((index, &value)) = marks.iter().enumerate().find(|(_, mark)| !mark.is_finite()) {
        return Err(AnalysisError::Mark { index, value });
    }
    let count = marks.len() as f64;
    let mean = |value: fn(f64) -> f64| marks.iter().map(|&mark| value(mark)).sum::<f64>() / count;
    let (unit, independent) = match function {
        MarkFunction::Product => {
            let (unit, square) = (mean(|mark| mark).powi(2), mean(|mark| mark * mark));
            if unit <= 1e-6 * square || unit == 0.0 {
                return Err(AnalysisError::NoMeanMark { mean: mean(|mark| mark) });
            }
            (unit, 1.0)
        }
        MarkFunction::Direction => {
            let along = |part: fn(f64) -> f64| marks.iter().map(|mark| part(mark.to_radians())).sum::<f64>() / count;
            (1.0, along(libm::cos).powi(2) + along(libm::sin).powi(2))
        }
    };
    let (mut pairs, mut products) = (Sums::new(settings), Sums::new(settings));
    cloud.neighbours().pairs(pairs.reach(), |i, j, offset| {
        let weight = 2.0 * cloud.pair_weight(offset);
        let product = match function {
            MarkFunction::Product => marks[i] * marks[j],
            MarkFunction::Direction => libm::cos((marks[i] - marks[j]).to_radians()),
        };
        pairs.add(offset.length(), weight);
        products.add(offset.length(), weight * product);
    });
    let density = cloud.squared_density();
    let (pairs, products) = (pairs.finish(density), products.finish(density));
    let known = pairs.value.iter().zip(&products.value);
    let value = known.map(|(&pairs, product)| (pairs >= LEAST_PAIRS).then(|| product / (pairs * unit))).collect();
    Ok(MarkCorrelation { function, radius: pairs.radius, value, independent })
}

/// The mark correlation of an attribute.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AttributeCorrelation {
    /// What the attribute is called.
    pub name: String,
    /// Its mark correlation.
    pub correlation: MarkCorrelation,
}

/// Those of all attributes of a pattern that have one.
pub(super) fn attribute_correlations(
    cloud: &Cloud,
    pattern: &PointPattern,
    scales: &Scales,
) -> Vec<AttributeCorrelation> {
    let of_one = |attribute: &crate::pattern::Attribute| {
        let function = MarkFunction::for_attribute(&attribute.name);
        let correlation = mark_correlation(cloud, &attribute.values, function, &scales.pair_correlation).ok()?;
        Some(AttributeCorrelation { name: attribute.name.clone(), correlation })
    };
    pattern.attributes().iter().filter_map(of_one).collect()
}

/// How far an output's curve is from its exemplar's, and how far it would be with marks given out at random.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MarkError {
    /// Mean squared difference of the two curves.
    pub error: f64,
    /// The same of the output's own points with their marks at random: the mean of [`ASSIGNMENTS`] assignments.
    pub random: f64,
}

impl MarkError {
    /// How many times better than at random.
    #[must_use]
    pub fn factor(&self) -> f64 {
        self.random / self.error.max(f64::MIN_POSITIVE)
    }

    fn mean(errors: impl Iterator<Item = Self>) -> Option<Self> {
        let add = |(sum, count): (Self, f64), one: Self| {
            (Self { error: sum.error + one.error, random: sum.random + one.random }, count + 1.0)
        };
        let (sum, count) = errors.fold((Self { error: 0.0, random: 0.0 }, 0.0), add);
        (count > 0.0).then(|| Self { error: sum.error / count, random: sum.random / count })
    }
}

/// The error of the pair correlation between two classes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClassPairError {
    /// Index of a class in the exemplar; those that only the output has follow.
    pub a: u16,
    /// Index of the other, not below `a`.
    pub b: u16,
    /// How far the curves are apart.
    pub error: MarkError,
}

/// The error of the mark correlation of an attribute.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AttributeError {
    /// What the attribute is called.
    pub name: String,
    /// How far the curves are apart.
    pub error: MarkError,
}

/// How well classes and attributes go with the points' places, as in the exemplar, and how well chance would do it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MarkComparison {
    /// What the classes are called, numbered as in `class_pairs`.
    pub class_names: Vec<String>,
    /// One for each pair of classes that either side has pairs of points of; none with a single class. Chance gives
    /// all classes out anew among all points.
    pub class_pairs: Vec<ClassPairError>,
    /// Their mean.
    pub classes: Option<MarkError>,
    /// One for each attribute that both sides have and that has a mark correlation. Chance gives the values out anew
    /// within each class, so that only what goes beyond the classes counts.
    pub attributes: Vec<AttributeError>,
    /// Their mean.
    pub marks: Option<MarkError>,
}

/// One side of a comparison.
pub(super) struct Marked<'a> {
    pub(super) cloud: &'a Cloud,
    pub(super) pattern: &'a PointPattern,
    pub(super) analysis: &'a Analysis,
}

/// Compares both sides; nothing when there is one class and no attribute in common.
///
/// # Errors
/// Never for what has been analysed already.
pub(super) fn compare_marks(
    exemplar: &Marked<'_>,
    output: &Marked<'_>,
    scales: &Scales,
    seed: u64,
) -> Result<Option<MarkComparison>, AnalysisError> {
    let wanted = &exemplar.analysis.cross_correlations;
    let shared: Vec<&AttributeCorrelation> = exemplar
        .analysis
        .mark_correlations
        .iter()
        .filter(|wanted| output.analysis.mark_correlations.iter().any(|own| own.name == wanted.name))
        .collect();
    let found = &output.analysis.cross_correlations;
    if wanted.is_empty() && found.is_empty() && shared.is_empty() {
        return Ok(None);
    }
    let pairs: Vec<(u16, u16)> = {
        let listed = |list: &[CrossCorrelation]| list.iter().map(|one| (one.a, one.b)).collect::<Vec<_>>();
        let mut pairs = listed(wanted);
        pairs.extend(listed(found).into_iter().filter(|pair| !listed(wanted).contains(pair)));
        pairs
    };
    let mut class_random = vec![0.0; pairs.len()];
    let mut mark_random = vec![0.0; shared.len()];
    let own = &output.analysis.mark_correlations;
    for number in 0..ASSIGNMENTS {
        let mut rng = Rng::new(seed, Purpose::Analysis(FIRST_ASSIGNMENT + number));
        if !pairs.is_empty() {
            let mut classes = output.cloud.classes().to_vec();
            rng.shuffle(&mut classes);
            let cloud = output.cloud.clone().relabelled(classes);
            let random = class_pair_correlations(&cloud, &scales.pair_correlation)?;
            for (sum, &pair) in class_random.iter_mut().zip(&pairs) {
                *sum += class_pair_error(wanted, &random, pair) / f64::from(ASSIGNMENTS);
            }
        }
        let order = shuffled_within_classes(output.cloud, &mut rng);
        for (sum, wanted) in mark_random.iter_mut().zip(&shared) {
            let Some(attribute) = output.pattern.attributes().iter().find(|other| other.name == wanted.name) else {
                continue;
            };
            let values: Vec<f64> = order.iter().map(|&point| attribute.values[point]).collect();
            let function = wanted.correlation.function;
            let random = mark_correlation(output.cloud, &values, function, &scales.pair_correlation)?;
            // The points are the same, so it is known at the same distances as the output's own.
            *sum += wanted.correlation.mean_squared_difference(&random).unwrap_or(0.0) / f64::from(ASSIGNMENTS);
        }
    }
    let class_pairs: Vec<ClassPairError> = pairs
        .iter()
        .zip(class_random)
        .map(|(&pair, random)| ClassPairError {
            a: pair.0,
            b: pair.1,
            error: MarkError { error: class_pair_error(wanted, found, pair), random },
        })
        .collect();
    let attributes: Vec<AttributeError> = shared
        .iter()
        .zip(mark_random)
        .filter_map(|(wanted, random)| {
            let own = own.iter().find(|own| own.name == wanted.name)?;
            let error = wanted.correlation.mean_squared_difference(&own.correlation)?;
            Some(AttributeError { name: wanted.name.clone(), error: MarkError { error, random } })
        })
        .collect();
    let known = exemplar.pattern.class_names();
    let more = output.pattern.class_names().iter().filter(|name| !known.contains(name));
    Ok(Some(MarkComparison {
        class_names: known.iter().chain(more).cloned().collect(),
        classes: MarkError::mean(class_pairs.iter().map(|one| one.error)),
        class_pairs,
        marks: MarkError::mean(attributes.iter().map(|one| one.error)),
        attributes,
    }))
}

/// Mean squared difference of the curves of two classes. Where a side has no such pairs its curve is 0.
fn class_pair_error(wanted: &[CrossCorrelation], found: &[CrossCorrelation], pair: (u16, u16)) -> f64 {
    let curve = |list: &'_ [CrossCorrelation]| list.iter().position(|one| (one.a, one.b) == pair);
    let square = |one: &CrossCorrelation| {
        let value = &one.correlation.value;
        value.iter().map(|g| g * g).sum::<f64>() / value.len() as f64
    };
    match (curve(wanted), curve(found)) {
        (Some(a), Some(b)) => wanted[a].correlation.mean_squared_difference(&found[b].correlation).unwrap_or(0.0),
        (Some(only), None) => square(&wanted[only]),
        (None, Some(only)) => square(&found[only]),
        (None, None) => 0.0,
    }
}

/// For every point one of its class, each once.
fn shuffled_within_classes(cloud: &Cloud, rng: &mut Rng) -> Vec<usize> {
    let mut order: Vec<usize> = (0..cloud.len()).collect();
    for class in 0..cloud.class_count() {
        let members: Vec<usize> = (0..cloud.len()).filter(|&i| usize::from(cloud.classes()[i]) == class).collect();
        let mut given = members.clone();
        rng.shuffle(&mut given);
        for (point, from) in members.into_iter().zip(given) {
            order[point] = from;
        }
    }
    order
}
