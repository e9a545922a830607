//! The pair correlation function.

use std::f64::consts::{PI, SQRT_2, TAU};

use serde::{Deserialize, Serialize};

use super::cloud::{Cloud, check_positive};
use super::error::{AnalysisError, check};

/// How many standard deviations of a Gaussian count.
const KERNEL_REACH: f64 = 4.0;

/// Smallest distance two of the `density · area` points can all keep, at best: the spacing of the hexagonal lattice
/// of that density, `√(2 / (√3 · density))` (Lagae & Dutré 2008, §3; twice their radius r_max). It is the r_max of
/// Öztireli & Gross (2012).
#[must_use]
pub fn densest_distance(density: f64) -> f64 {
    (2.0 / (3.0_f64.sqrt() * density)).sqrt()
}

/// At which distances a pair correlation is estimated, and how smoothly. Lengths are in the cloud's unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PairCorrelationSettings {
    /// Standard deviation of the Gaussian that each distance is spread by.
    pub sigma: f64,
    /// The first sampled distance is `sigma / 100`, this the last.
    pub range: f64,
    /// How many distances are sampled, evenly.
    pub samples: usize,
}

impl PairCorrelationSettings {
    /// Öztireli & Gross's (2012) kernel: σ in units of [`densest_distance`].
    pub const SIGMA: f64 = 0.25;
    /// Their range in the same unit.
    pub const RANGE: f64 = 2.5;
    /// How many distances they sample.
    pub const SAMPLES: usize = 100;

    /// Öztireli & Gross's settings for a pattern of this density. The range is cut at what a window can tell.
    #[must_use]
    pub fn suited_to(cloud: &Cloud) -> Self {
        let unit = densest_distance(cloud.density());
        let range = (Self::RANGE * unit).min(cloud.longest_reach());
        Self { sigma: Self::SIGMA * unit, range, samples: Self::SAMPLES }
    }

    /// The same range with another kernel.
    #[must_use]
    pub fn with_sigma(self, sigma: f64) -> Self {
        Self { sigma, ..self }
    }

    /// Beyond this no pair adds to any sample.
    fn reach(&self) -> f64 {
        self.range + KERNEL_REACH * self.sigma
    }

    pub(super) fn check(&self) -> Result<(), AnalysisError> {
        check_positive("sigma", self.sigma)?;
        check_positive("range", self.range)?;
        check("samples", self.samples as f64, 2.0, 10_000.0)
    }
}

/// g(r): how many neighbours there are at distance r, against as many independent points. 1 is chance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PairCorrelation {
    /// Standard deviation of the kernel, in the cloud's unit.
    pub sigma: f64,
    /// The sampled distances, in the cloud's unit.
    pub radius: Vec<f64>,
    /// g at each of them.
    pub value: Vec<f64>,
}

impl PairCorrelation {
    /// Mean squared difference of two estimates with the same settings; `None` when they were sampled differently.
    #[must_use]
    pub fn mean_squared_difference(&self, other: &Self) -> Option<f64> {
        let same = self.radius == other.radius && !self.radius.is_empty();
        let sum = || self.value.iter().zip(&other.value).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        same.then(|| sum() / self.radius.len() as f64)
    }
}

/// The pair correlation between two classes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CrossCorrelation {
    /// Index of a class.
    pub a: u16,
    /// Index of the other, not below `a`.
    pub b: u16,
    /// Their pair correlation.
    pub correlation: PairCorrelation,
}

/// The pair correlation of all points, whatever their class (Öztireli & Gross 2012, eq. 3): every pair's distance
/// spread by a Gaussian, weighted for the border (translation correction in a window, none needed on a torus).
///
/// Where they divide by the circumference 2πr, this divides by what the Gaussian catches of the plane,
/// `∫ 2πs k(r − s) ds`: the same but for r < 2σ, where it keeps independent points at 1 instead of letting the
/// quotient run off.
///
/// # Errors
/// With a single point, or settings that are not positive.
pub fn pair_correlation(cloud: &Cloud, settings: &PairCorrelationSettings) -> Result<PairCorrelation, AnalysisError> {
    cloud.at_least("the pair correlation", 2)?;
    settings.check()?;
    let mut sums = Sums::new(settings);
    cloud.neighbours().pairs(sums.reach(), |_, _, offset| {
        sums.add(offset.length(), 2.0 * cloud.pair_weight(offset));
    });
    Ok(sums.finish(cloud.squared_density()))
}

/// The pair correlation between two classes: how many points of class `b` there are at distance r from one of class
/// `a`, against chance; symmetric in the two. With `a == b` it is the correlation within the class.
///
/// # Errors
/// When a class has no points (or one alone with itself), or settings are not positive.
pub fn cross_pair_correlation(
    cloud: &Cloud,
    a: u16,
    b: u16,
    settings: &PairCorrelationSettings,
) -> Result<PairCorrelation, AnalysisError> {
    settings.check()?;
    let classes = cloud.classes();
    let count = |class| classes.iter().filter(|&&other| other == class).count();
    let (of_a, of_b) = (count(a), count(b));
    for (class, count) in [(a, of_a), (b, of_b)] {
        if count == 0 {
            return Err(AnalysisError::EmptyClass { class });
        }
    }
    if a == b && of_a < 2 {
        return Err(AnalysisError::TooFewPoints { what: "the pair correlation of a class", count: of_a, needed: 2 });
    }
    let wanted = (a.min(b), a.max(b));
    let all = class_pair_correlations(cloud, settings)?;
    let found = all.into_iter().find(|one| (one.a, one.b) == wanted).map(|one| one.correlation);
    found.ok_or(AnalysisError::EmptyClass { class: a })
}

/// [`cross_pair_correlation`] for all a ≤ b of which there are pairs of points, in one pass over the pairs.
///
/// # Errors
/// When settings are not positive.
pub fn class_pair_correlations(
    cloud: &Cloud,
    settings: &PairCorrelationSettings,
) -> Result<Vec<CrossCorrelation>, AnalysisError> {
    settings.check()?;
    let (classes, sizes) = (cloud.classes(), cloud.class_sizes());
    let count = sizes.len();
    let mut sums: Vec<Option<Sums>> = Vec::with_capacity(count * count);
    for a in 0..count {
        for b in 0..count {
            let others = if a == b { sizes[b].saturating_sub(1) } else { sizes[b] };
            sums.push((a <= b && sizes[a] > 0 && others > 0).then(|| Sums::new(settings)));
        }
    }
    cloud.neighbours().pairs(settings.reach(), |i, j, offset| {
        let (a, b) = (classes[i].min(classes[j]), classes[i].max(classes[j]));
        if let Some(sums) = &mut sums[usize::from(a) * count + usize::from(b)] {
            // Within a class each of the two is the other's neighbour.
            let ways = if a == b { 2.0 } else { 1.0 };
            sums.add(offset.length(), ways * cloud.pair_weight(offset));
        }
    });
    let open = cloud.boundary() == crate::Boundary::Open;
    let curve = |(place, sums): (usize, Option<Sums>)| {
        let (a, b) = (place / count, place % count);
        let others = if a == b && open { sizes[b].saturating_sub(1) } else { sizes[b] };
        let correlation = sums?.finish(sizes[a] as f64 * others as f64 / (cloud.area() * cloud.area()));
        Some(CrossCorrelation { a: a as u16, b: b as u16, correlation })
    };
    Ok(sums.into_iter().enumerate().filter_map(curve).collect())
}

/// Weighted Gaussians at the distances of pairs, sampled evenly.
pub(super) struct Sums {
    settings: PairCorrelationSettings,
    first: f64,
    step: f64,
    sums: Vec<f64>,
}

impl Sums {
    pub(super) fn new(settings: &PairCorrelationSettings) -> Self {
        let first = (0.01 * settings.sigma).min(0.5 * settings.range);
        let step = (settings.range - first) / (settings.samples - 1) as f64;
        Self { settings: *settings, first, step, sums: vec![0.0; settings.samples] }
    }

    pub(super) fn reach(&self) -> f64 {
        self.settings.reach()
    }

    /// Adds a Gaussian. Neighbouring samples of one differ by a factor that itself changes by a constant factor, so
    /// that two exponentials do for all.
    pub(super) fn add(&mut self, distance: f64, weight: f64) {
        let sigma = self.settings.sigma;
        let sample = |x: f64| ((x - self.first) / self.step).ceil().max(0.0) as usize;
        let from = sample(distance - KERNEL_REACH * sigma);
        let to = sample(distance + KERNEL_REACH * sigma).min(self.sums.len());
        if from >= to {
            return;
        }
        let x = (self.first + from as f64 * self.step - distance) / sigma;
        let step = self.step / sigma;
        let mut value = weight * libm::exp(-0.5 * x * x);
        let mut factor = libm::exp(-step * (x + 0.5 * step));
        let change = libm::exp(-step * step);
        for sum in &mut self.sums[from..to] {
            *sum += value;
            value *= factor;
            factor *= change;
        }
    }

    pub(super) fn finish(self, squared_density: f64) -> PairCorrelation {
        let sigma = self.settings.sigma;
        let radius: Vec<f64> = (0..self.sums.len()).map(|i| self.first + i as f64 * self.step).collect();
        let value = radius
            .iter()
            .zip(&self.sums)
            .map(|(&r, sum)| {
                let t = r / sigma;
                // ∫ 2πs k(r − s) ds over s ≥ 0, in terms of the normal distribution and its density.
                let below = 0.5 * (1.0 + libm::erf(t / SQRT_2));
                let caught = TAU * (r * below + sigma * libm::exp(-0.5 * t * t) / TAU.sqrt());
                sum / ((2.0 * PI).sqrt() * sigma * caught * squared_density)
            })
            .collect();
        PairCorrelation { sigma, radius, value }
    }
}
