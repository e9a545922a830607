//! What follows a run: the curves a page draws and the judgement. It leaves out what a [`Comparison`](super::Comparison)
//! has beyond that, so that it is quick and so that the page's module holds nothing it does not show.

use super::nearest::{Histogram, Summary, nearest_distances};
use super::pair_correlation::{PairCorrelation, pair_correlation};
use super::spacing::{border_crowd, relative_radius};
use super::spectrum::{Periodogram, RadialSpectrum, periodogram};
use super::verdict::Facts;
use super::{Analysis, AnalysisError, Cloud, Defects, Quality, Scales};

/// The curves of one side. Lengths are in exemplar units; each member is that of the same name in [`Analysis`].
#[derive(Clone, Debug, PartialEq)]
pub struct Curves {
    /// How many points there are.
    pub points: usize,
    /// Distances to the nearest neighbour.
    pub nearest: Option<Summary>,
    /// The same as shares.
    pub nearest_histogram: Histogram,
    /// All points, whatever their class.
    pub pair_correlation: PairCorrelation,
    /// The periodogram.
    pub periodogram: Periodogram,
    /// Its radial mean.
    pub spectrum: RadialSpectrum,
    /// ρ.
    pub relative_radius: f64,
}

impl Curves {
    /// The curves of a cloud.
    ///
    /// # Errors
    /// With a single point, or scales out of range.
    pub fn of(cloud: &Cloud, scales: &Scales) -> Result<Self, AnalysisError> {
        let nearest = nearest_distances(cloud, 1)?;
        let distances = nearest.distances.iter().copied();
        let periodogram = periodogram(cloud, scales.max_frequency)?;
        Ok(Self {
            points: cloud.len(),
            nearest_histogram: Histogram::of(distances.clone(), scales.histogram_width, scales.histogram_count),
            nearest: Summary::of(distances),
            pair_correlation: pair_correlation(cloud, &scales.pair_correlation)?,
            spectrum: periodogram.radial_mean(scales.ring_width)?,
            periodogram,
            relative_radius: relative_radius(cloud)?,
        })
    }
}

/// An output as it stands against its exemplar; see [`Judge::follow`](super::Judge::follow).
#[derive(Clone, Debug, PartialEq)]
pub struct Live {
    /// Distances and widths of all curves.
    pub scales: Scales,
    /// The exemplar.
    pub exemplar: Curves,
    /// The output.
    pub output: Curves,
    /// Normalised quality.
    pub quality: Quality,
    /// Stacked points, clumps, holes, crowded borders.
    pub defects: Defects,
    /// The same in words, see [`verdict`](super::verdict()).
    pub verdict: String,
}

impl Live {
    pub(super) fn of(
        scales: &Scales,
        exemplar: (&Cloud, &Curves),
        output: &Cloud,
        quality: Quality,
    ) -> Result<Self, AnalysisError> {
        let curves = Curves::of(output, scales)?;
        let defects = Defects::of(exemplar.0, output)?;
        let border = border_crowd(output, Analysis::BORDER * scales.spacing)?;
        let verdict = Facts {
            quality: &quality,
            defects: &defects,
            density_ratio: output.density() / exemplar.0.density(),
            exemplar_points: exemplar.1.points,
            nearest: [exemplar.1.nearest.as_ref(), curves.nearest.as_ref()],
            border_excess: border.map(|border| border.excess),
            // A word on the exemplar's shape belongs to the whole comparison.
            filled: [None; 2],
        }
        .verdict();
        Ok(Self { scales: *scales, exemplar: exemplar.1.clone(), output: curves, quality, defects, verdict })
    }
}
