//! Distances to the k-th nearest neighbour.

use serde::{Deserialize, Serialize};

use super::cloud::Cloud;
use super::error::AnalysisError;

/// How many neighbours [`Analysis`](super::Analysis) looks at: the first ring of a hexagonal lattice.
pub const NEIGHBOURS: usize = 6;

/// Distances from every point to its nearest neighbours.
#[derive(Clone, Debug, PartialEq)]
pub struct NearestDistances {
    /// How many neighbours a point has here: at most what was asked for, and in a window at most one less than there
    /// are points.
    pub neighbours: usize,
    /// `[points, neighbours]`, row by row, nearest first, in the cloud's unit.
    pub distances: Vec<f64>,
}

impl NearestDistances {
    /// Distances to the k-th neighbour (from 1), one a point; none when k is not between 1 and `neighbours`.
    pub fn of_rank(&self, k: usize) -> impl Iterator<Item = f64> + '_ {
        let rows = if (1..=self.neighbours).contains(&k) { self.distances.as_slice() } else { &[] };
        rows.chunks_exact(self.neighbours.max(1)).map(move |row| row[k - 1])
    }
}

/// Distances from every point to its 1 … `neighbours` nearest others. Duplicates are at distance 0; a window is not
/// corrected for what may lie beyond its border.
///
/// # Errors
/// With a single point.
pub fn nearest_distances(cloud: &Cloud, neighbours: usize) -> Result<NearestDistances, AnalysisError> {
    cloud.at_least("the distance to the nearest neighbour", 2)?;
    let most = if cloud.boundary() == crate::Boundary::Open { cloud.len() - 1 } else { usize::MAX };
    let neighbours = neighbours.clamp(1, most);
    let grid = cloud.neighbours();
    let mut found = Vec::with_capacity(neighbours + 1);
    let mut distances = Vec::with_capacity(cloud.len() * neighbours);
    for (index, &point) in cloud.points().iter().enumerate() {
        grid.nearest(point, neighbours, Some(index), &mut found);
        distances.extend(found.iter().map(|other| other.distance_squared.sqrt()));
    }
    Ok(NearestDistances { neighbours, distances })
}

/// What a list of numbers looks like.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Arithmetic mean.
    pub mean: f64,
    /// Standard deviation (of these numbers, not an estimate for a larger set).
    pub standard_deviation: f64,
    /// Smallest.
    pub min: f64,
    /// Half lie below.
    pub median: f64,
    /// Largest.
    pub max: f64,
}

impl Summary {
    /// Summarises numbers; `None` when there are none.
    #[must_use]
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut values: Vec<f64> = values.into_iter().collect();
        crate::sorting::ascending(&mut values);
        let (min, max) = (*values.first()?, *values.last()?);
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
        Some(Self { mean, standard_deviation: variance.sqrt(), min, median: quantile(&values, 0.5), max })
    }
}

/// The value below which a `share` of the sorted numbers lies, interpolated between neighbours; 0 without numbers.
pub(crate) fn quantile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return 0.0 };
    let place = share.clamp(0.0, 1.0) * last as f64;
    let below = (place.floor() as usize).min(last);
    let above = (below + 1).min(last);
    sorted[below] + (sorted[above] - sorted[below]) * (place - below as f64)
}

/// Shares of a set in intervals of one width from 0 on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Histogram {
    /// Width of an interval.
    pub width: f64,
    /// Share of the set in each interval; together with `beyond` they sum to 1.
    pub shares: Vec<f64>,
    /// Share beyond the last interval.
    pub beyond: f64,
}

impl Histogram {
    /// Sorts numbers into `count` intervals of `width` from 0 on; negative ones fall into the first.
    #[must_use]
    pub fn of(values: impl IntoIterator<Item = f64>, width: f64, count: usize) -> Self {
        let mut shares = vec![0.0; count];
        let (mut beyond, mut all) = (0.0, 0.0);
        for value in values {
            all += 1.0;
            // A value on a limit, as in a lattice, shall not fall to either side by a rounding.
            match shares.get_mut((value / width + 1e-9).max(0.0) as usize) {
                Some(share) => *share += 1.0,
                None => beyond += 1.0,
            }
        }
        if all > 0.0 {
            shares.iter_mut().for_each(|share| *share /= all);
            beyond /= all;
        }
        Self { width, shares, beyond }
    }
}
