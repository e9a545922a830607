//! The distances between an exemplar and an output that [`Quality`](super::Quality) leaves out, on its scale.

use serde::{Deserialize, Serialize};

use super::live::Curves;
use super::nearest::{NEIGHBOURS, nearest_distances, quantile};
use super::quality::{STARTS, score, start_of, tile};
use super::ripley::{Ripley, ripley};
use super::spectrum::RadialSpectrum;
use super::transport::compare_patches;
use super::{AnalysisError, Cloud, Scales, common_classes, exemplar_unit};
use crate::pattern::PointPattern;

/// At how many shares two distributions of distances are compared.
const QUANTILES: usize = 64;

/// One distance between an exemplar and an output; smaller is better, 0 is best.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Score {
    /// What was compared.
    pub statistic: String,
    /// The output's distance from the exemplar.
    pub value: f64,
    /// The same of what scores 0: the worse of white noise and the Poisson-disk start, each averaged over several.
    pub chance: f64,
    /// The same of what scores 1: the exemplar tiled onto the output's domain.
    pub tiled: f64,
    /// `value` on that scale, at least −1. Where tiling and chance are equally far, 1 for what is no farther.
    pub score: f64,
}

/// Everything that is compared, in the order of [`scores`]; what the points don't allow is left out.
const STATISTICS: [&str; 7] =
    ["pair correlation", "nearest neighbours", "periodogram", "Ripley's L", "ρ", "Chamfer", "Wasserstein"];

/// The exemplar's side of all comparisons.
struct Reference<'a> {
    exemplar: &'a Cloud,
    scales: Scales,
    curves: Curves,
    nearest: Vec<Vec<f64>>,
    ripley: Ripley,
}

impl<'a> Reference<'a> {
    fn of(exemplar: &'a Cloud) -> Result<Self, AnalysisError> {
        let scales = Scales::of(exemplar)?;
        Ok(Self {
            exemplar,
            scales,
            curves: Curves::of(exemplar, &scales)?,
            nearest: sorted_distances(exemplar)?,
            ripley: ripley(exemplar, &scales.ripley)?,
        })
    }

    /// The distances of an output in the exemplar's unit, in the order of [`STATISTICS`].
    fn distances(&self, output: &Cloud) -> Result<[Option<f64>; 7], AnalysisError> {
        let (scales, wanted) = (&self.scales, &self.curves);
        let curves = Curves::of(output, scales)?;
        let nearest: Vec<f64> = sorted_distances(output)?
            .iter()
            .zip(&self.nearest)
            .map(|(own, wanted)| distance_of_distributions(own, wanted) / scales.spacing)
            .collect();
        let spectrum = wanted.spectrum.frequency.iter().zip(&wanted.spectrum.power);
        let l = ripley(output, &scales.ripley)?.l_minus_r;
        let patches = compare_patches(self.exemplar, output).ok();
        Ok([
            curves.pair_correlation.mean_squared_difference(&wanted.pair_correlation),
            Some(mean(nearest)),
            Some(mean(spectrum.map(|(&at, power)| at_frequency(&curves.spectrum, at) - power))),
            Some(mean(l.iter().zip(&self.ripley.l_minus_r).map(|(own, wanted)| own - wanted)) / scales.spacing),
            Some((curves.relative_radius - wanted.relative_radius).abs()),
            patches.as_ref().map(|patches| patches.chamfer),
            patches.and_then(|patches| patches.wasserstein),
        ])
    }
}

/// How far an output is from its exemplar by everything that [`Quality`](super::Quality) leaves out, whatever the
/// points' classes, each on the scale of quality: 0 is the worse of white noise and the Poisson-disk start, 1 the
/// exemplar tiled onto the output's domain. The same seed gives the same numbers.
///
/// | statistic | distance |
/// |---|---|
/// | pair correlation | mean squared difference of g, see [`pair_correlation`](super::pair_correlation()) |
/// | nearest neighbours | distance of the distributions of the 1st … 6th nearest distances (Wasserstein's of order 1), mean over the six, in mean spacings |
/// | periodogram | mean absolute difference of the radial means |
/// | Ripley's L | mean absolute difference of L, in mean spacings |
/// | ρ | absolute difference of the relative radii |
/// | Chamfer, Wasserstein | the paper's, see [`PatchComparison`](super::PatchComparison): a random pattern that is close there has copied |
///
/// # Errors
/// When the exemplar has no two points in different places, or the output fewer than two points.
pub fn scores(exemplar: &PointPattern, output: &PointPattern, seed: u64) -> Result<Vec<Score>, AnalysisError> {
    let unit = exemplar_unit(exemplar);
    let (exemplar, output) = common_classes(exemplar, output, unit)?;
    let reference = Reference::of(&exemplar)?;
    let (size, boundary) = (output.size(), output.boundary());
    let class_sizes = output.class_sizes();
    let of_kind = |kind: usize| {
        let start = |number| start_of((kind, number), size, boundary, &class_sizes, seed);
        (0..STARTS).map(|number| reference.distances(&start(number)?)).collect::<Result<Vec<_>, _>>()
    };
    let starts = [of_kind(0)?, of_kind(1)?];
    let tiled = reference.distances(&tile(&exemplar, size, boundary)?)?;
    let found = reference.distances(&output)?;
    let known = |at: usize| {
        let (value, tiled) = (found[at]?, tiled[at]?);
        // Without a value in a start, as where a patch has no two points, the scale has no zero.
        let means = starts.each_ref().map(|list| {
            let values: Option<Vec<f64>> = list.iter().map(|distances| distances[at]).collect();
            values.map(mean)
        });
        let [Some(white), Some(blue)] = means else { return None };
        let chance = f64::max(white, blue);
        let statistic = STATISTICS[at].to_owned();
        Some(Score { statistic, value, chance, tiled, score: score(value, chance, tiled) })
    };
    Ok((0..STATISTICS.len()).filter_map(known).collect())
}

/// Distances to the 1st … 6th nearest neighbour, each sorted.
fn sorted_distances(cloud: &Cloud) -> Result<Vec<Vec<f64>>, AnalysisError> {
    let nearest = nearest_distances(cloud, NEIGHBOURS)?;
    let of_rank = |k| {
        let mut distances: Vec<f64> = nearest.of_rank(k).collect();
        crate::sorting::ascending(&mut distances);
        distances
    };
    Ok((1..=nearest.neighbours).map(of_rank).collect())
}

/// Mean absolute difference of the quantiles of two sorted lists.
fn distance_of_distributions(a: &[f64], b: &[f64]) -> f64 {
    let shares = (0..QUANTILES).map(|i| (i as f64 + 0.5) / QUANTILES as f64);
    mean(shares.map(|share| quantile(a, share) - quantile(b, share)))
}

/// A radial mean between its frequencies, which differ with the domain.
fn at_frequency(spectrum: &RadialSpectrum, frequency: f64) -> f64 {
    let (frequencies, powers) = (&spectrum.frequency, &spectrum.power);
    let above = frequencies.partition_point(|&other| other < frequency).clamp(1, frequencies.len().max(2) - 1);
    let (Some(&high), Some(&power)) = (frequencies.get(above), powers.get(above)) else {
        return powers.first().copied().unwrap_or(0.0);
    };
    let share = ((frequency - frequencies[above - 1]) / (high - frequencies[above - 1])).clamp(0.0, 1.0);
    powers[above - 1] + share * (power - powers[above - 1])
}

/// Mean of the magnitudes.
fn mean(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, count) = values.into_iter().fold((0.0, 0.0), |(sum, count), value| (sum + value.abs(), count + 1.0));
    sum / f64::max(count, 1.0)
}
