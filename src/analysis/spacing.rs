//! Numbers for what must not happen: points on one another, clumps, holes, crowds along a border. And ρ.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::cloud::{Cloud, check_positive};
use super::error::AnalysisError;
use super::nearest::{nearest_distances, quantile};
use super::pair_correlation::densest_distance;
use crate::pattern::Boundary;
use crate::sorting::ascending;

/// Lagae & Dutré's (2008, §3) relative radius ρ in a domain of this area: half the smallest distance between two
/// points over r_max = √(area / (2√3 n)), the radius of the densest packing. 1 for a hexagonal lattice, about 0.7 to
/// 0.75 for the best blue noise, 0 where two points coincide.
///
/// One pair decides it, so it is noisy. In a window the smallest distance is that of the points seen.
///
/// # Errors
/// With a single point, or an area that is not positive.
pub fn relative_radius_in(cloud: &Cloud, area: f64) -> Result<f64, AnalysisError> {
    check_positive("area", area)?;
    let nearest = nearest_distances(cloud, 1)?;
    let smallest = nearest.of_rank(1).fold(f64::INFINITY, f64::min);
    Ok(smallest / densest_distance(cloud.len() as f64 / area))
}

/// [`relative_radius_in`] the cloud's own rectangle.
///
/// # Errors
/// With a single point.
pub fn relative_radius(cloud: &Cloud) -> Result<f64, AnalysisError> {
    relative_radius_in(cloud, cloud.area())
}

/// Below which distance two points count as stacked, given the pattern they should look like: half the distance that
/// 99 % of its points keep from their nearest neighbour.
///
/// # Errors
/// With a single point.
pub fn stacking_distance(exemplar: &Cloud) -> Result<f64, AnalysisError> {
    let mut distances: Vec<f64> = nearest_distances(exemplar, 1)?.distances;
    ascending(&mut distances);
    Ok(0.5 * quantile(&distances, 0.01))
}

/// Share of the points that have another within `distance`, both ends of a pair counted: 0 when nothing is stacked.
///
/// # Errors
/// With a single point.
pub fn stacked(cloud: &Cloud, distance: f64) -> Result<f64, AnalysisError> {
    let nearest = nearest_distances(cloud, 1)?;
    let count = nearest.of_rank(1).filter(|&nearest| nearest < distance).count();
    Ok(count as f64 / cloud.len() as f64)
}

/// Clumps of three to seven points are looked for: a point and its neighbours in a hexagonal lattice.
pub const CLUMP_SIZES: usize = 5;

/// How tight the tightest clumps are: the smallest distance of a point from its second, third … sixth neighbour, in the
/// cloud's unit. 0 where there are too few points, or so many in one place.
///
/// # Errors
/// With a single point.
#[inline(never)]
pub fn tightest_clumps(cloud: &Cloud) -> Result<[f64; CLUMP_SIZES], AnalysisError> {
    let nearest = nearest_distances(cloud, 1 + CLUMP_SIZES)?;
    Ok(std::array::from_fn(|further| nearest.of_rank(2 + further).reduce(f64::min).unwrap_or(0.0)))
}

/// How much tighter the tightest clump of an output is than that of as many points in its exemplar, whichever size is the
/// worst; 0 when the exemplar has as many points in one place. A row with a point too many shows here, while all its
/// points keep their distance from the next one.
///
/// # Errors
/// When either has a single point.
pub fn clumps(exemplar: &Cloud, output: &Cloud) -> Result<f64, AnalysisError> {
    // No division by 0 for points in one place.
    let least = 1e-6 / output.density().sqrt();
    let pairs = tightest_clumps(exemplar)?.into_iter().zip(tightest_clumps(output)?);
    Ok(pairs.map(|(usual, own)| usual / own.max(least)).fold(0.0, f64::max))
}

/// A circle without a point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EmptyCircle {
    /// Where its middle is, in the cloud's unit.
    pub center: [f64; 2],
    /// Its radius, in the cloud's unit.
    pub radius: f64,
}

/// The largest circle that holds no point and lies within the window, or anywhere on the torus. To a thousandth of
/// 1 / √density.
#[must_use]
pub fn largest_empty_circle(cloud: &Cloud) -> EmptyCircle {
    let grid = cloud.neighbours();
    let mut found = Vec::with_capacity(2);
    let size = cloud.size();
    let mut clearance = |place: DVec2| {
        grid.nearest(place, 1, None, &mut found);
        let nearest = found.first().map_or(f64::INFINITY, |point| point.distance_squared.sqrt());
        match cloud.boundary() {
            Boundary::Periodic => nearest,
            Boundary::Open => {
                let to_border = place.min(size - place).min_element();
                nearest.min(cloud.region().map_or(to_border, |region| to_border.min(region.clearance(place))))
            }
        }
    };
    let spacing = 1.0 / cloud.density().sqrt();
    let tolerance = 1e-3 * spacing;

    // Branch and bound: from a place to the next the clearance grows at most by the way between them, so a box whose
    // middle's clearance and half diagonal do not beat the best is done.
    let count = (size / spacing).ceil().clamp(DVec2::ONE, DVec2::splat(256.0));
    let half = 0.5 * size / count;
    let mut boxes = BinaryHeap::new();
    let mut best = EmptyCircle { center: (0.5 * size).into(), radius: 0.0 };
    let mut consider = |center: DVec2, half: DVec2, best: &mut EmptyCircle, boxes: &mut BinaryHeap<Square>| {
        let radius = clearance(center);
        if radius > best.radius {
            *best = EmptyCircle { center: center.into(), radius };
        }
        let bound = radius + half.length();
        if bound > best.radius + tolerance {
            boxes.push(Square { bound, center, half });
        }
    };
    for row in 0..count.y as usize {
        for column in 0..count.x as usize {
            let center = (DVec2::new(column as f64, row as f64) + 0.5) * 2.0 * half;
            consider(center, half, &mut best, &mut boxes);
        }
    }
    while let Some(Square { bound, center, half }) = boxes.pop() {
        if bound <= best.radius + tolerance {
            break;
        }
        let half = 0.5 * half;
        for corner in [DVec2::new(-1.0, -1.0), DVec2::new(1.0, -1.0), DVec2::new(-1.0, 1.0), DVec2::ONE] {
            consider(center + corner * half, half, &mut best, &mut boxes);
        }
    }
    best
}

/// A box and the largest clearance it may hold.
struct Square {
    bound: f64,
    center: DVec2,
    half: DVec2,
}

impl PartialEq for Square {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Square {}

impl PartialOrd for Square {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Square {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

/// How many points lie along the border of a window.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BorderCrowd {
    /// Width of the strip looked at, in the cloud's unit.
    pub width: f64,
    /// Points in it.
    pub count: usize,
    /// Points it would hold if the density were the same everywhere.
    pub expected: f64,
    /// `count − expected` as a share of all points; negative where the border is emptier than the middle.
    pub excess: f64,
}

/// Counts the points within `width` of the border of a rectangle. `None` on a torus, which has no border, and in a window
/// of another shape.
///
/// # Errors
/// When the width is not positive.
pub fn border_crowd(cloud: &Cloud, width: f64) -> Result<Option<BorderCrowd>, AnalysisError> {
    check_positive("width", width)?;
    if cloud.boundary() == Boundary::Periodic || cloud.region().is_some() {
        return Ok(None);
    }
    let size = cloud.size();
    let inner = (size - 2.0 * width).max(DVec2::ZERO);
    let all = cloud.len() as f64;
    let expected = all * (1.0 - inner.x * inner.y / cloud.area());
    let count = cloud.points().iter().filter(|&&point| point.min(size - point).min_element() <= width).count();
    Ok(Some(BorderCrowd { width, count, expected, excess: (count as f64 - expected) / all }))
}
