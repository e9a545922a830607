//! What a generator hands back, and the geometry generators share.

use std::f64::consts::TAU;

use glam::DVec2;

use crate::pattern::Boundary;
use crate::sampling::{Purpose, Rng, lloyd_step, poisson_disk, wrap};

/// The points of an exemplar in `[0, size.x] × [0, size.y]`.
pub(super) struct Sample {
    pub(super) size: DVec2,
    pub(super) boundary: Boundary,
    pub(super) points: Vec<DVec2>,
    /// What the classes are called and how many points each has, class after class; empty for one without a name.
    pub(super) classes: Vec<(&'static str, usize)>,
    /// Named numbers, one a point.
    pub(super) attributes: Vec<(&'static str, Vec<f64>)>,
}

impl Sample {
    /// One tile of a torus; points beyond its border come back in on the other side.
    pub(super) fn tile(size: DVec2, points: impl IntoIterator<Item = DVec2>) -> Self {
        let points = points.into_iter().map(|point| wrap(point, size)).collect();
        Self { size, boundary: Boundary::Periodic, points, classes: Vec::new(), attributes: Vec::new() }
    }

    /// The part of a larger picture seen through the unit square.
    pub(super) fn window(points: impl IntoIterator<Item = DVec2>) -> Self {
        let inside = |point: &DVec2| point.cmpge(DVec2::ZERO).all() && point.cmple(DVec2::ONE).all();
        let points = points.into_iter().filter(inside).collect();
        Self { boundary: Boundary::Open, points, ..Self::tile(DVec2::ONE, []) }
    }

    /// Names the classes, in the order of the points.
    pub(super) fn of(self, classes: &[(&'static str, usize)]) -> Self {
        Self { classes: classes.to_vec(), ..self }
    }

    /// Gives every point a number.
    pub(super) fn with(mut self, name: &'static str, values: Vec<f64>) -> Self {
        self.attributes.push((name, values));
        self
    }
}

/// The random numbers of an exemplar.
pub(super) fn random(seed: u64) -> Rng {
    Rng::new(seed, Purpose::Gallery)
}

/// The unit vector at `angle` radians. Through `libm`, so that every machine gets the same bits.
pub(super) fn direction(angle: f64) -> DVec2 {
    DVec2::new(libm::cos(angle), libm::sin(angle))
}

/// A random angle in `[0, 2π)`.
pub(super) fn angle(rng: &mut Rng) -> f64 {
    TAU * rng.uniform()
}

/// A small displacement, uniform in the square of half-side `reach`.
pub(super) fn jitter(rng: &mut Rng, reach: f64) -> DVec2 {
    DVec2::new(rng.range(-reach, reach), rng.range(-reach, reach))
}

/// Columns and rows of a grid, row by row.
pub(super) fn cells(columns: u32, rows: u32) -> impl Iterator<Item = (u32, u32)> {
    (0..rows).flat_map(move |row| (0..columns).map(move |column| (column, row)))
}

/// Distance on the torus of this size.
pub(super) fn torus_distance(a: DVec2, b: DVec2, size: DVec2) -> f64 {
    let offset = (a - b).abs();
    offset.min(size - offset).length()
}

/// Places on the unit torus that keep their distance without order: a Poisson disk pattern, relaxed a little.
pub(super) fn scattered(rng: &mut Rng, count: usize, relaxations: usize) -> Vec<DVec2> {
    let mut places = poisson_disk(rng, DVec2::ONE, count, Boundary::Periodic);
    for _ in 0..relaxations {
        places = lloyd_step(&places, DVec2::ONE, Boundary::Periodic);
    }
    places
}

/// The largest unit length at which figures at `places`, `reach[i]` units in radius, stay `gap` units apart.
pub(super) fn fitting_unit(places: &[DVec2], reach: &[f64], gap: f64) -> f64 {
    let mut unit = f64::INFINITY;
    for (i, &a) in places.iter().enumerate() {
        // A figure must also keep clear of its own image in the next tile.
        unit = unit.min(1.0 / (2.0 * reach[i] + gap));
        for (j, &b) in places.iter().enumerate().take(i) {
            unit = unit.min(torus_distance(a, b, DVec2::ONE) / (reach[i] + reach[j] + gap));
        }
    }
    unit
}
