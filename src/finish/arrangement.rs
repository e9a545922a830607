//! Points some of which may move, and what the exemplar says they must not exceed.

use glam::DVec2;

use crate::analysis::{CLUMP_SIZES, Cloud, largest_empty_circle, nearest_distances, tightest_clumps};
use crate::pattern::Boundary;

/// A hole is one when it is larger than the exemplar's largest by this factor.
pub(super) const HOLE: f64 = 1.15;

/// Points in a rectangle, those before `first` frozen, the others all of one class.
#[derive(Clone, Copy, Debug)]
pub struct Arrangement<'a> {
    /// Class of each point; there may be more of them than points.
    pub classes: &'a [u16],
    /// The first point that may move.
    pub first: usize,
    /// Size of the rectangle.
    pub size: DVec2,
    /// What lies beyond its border.
    pub boundary: Boundary,
}

impl Arrangement<'_> {
    /// These places, whatever their classes.
    #[inline(never)]
    pub(super) fn cloud(&self, points: &[DVec2]) -> Option<Cloud> {
        Cloud::new(points.to_vec(), self.size, self.boundary).ok()
    }

    /// These places with their classes.
    pub(super) fn classed_cloud(&self, points: &[DVec2]) -> Option<Cloud> {
        self.cloud(points)?.with_classes(self.classes.get(..points.len())?.to_vec()).ok()
    }

    /// From one place to another, or to its image where that is nearer.
    pub(super) fn way(&self, from: DVec2, to: DVec2) -> DVec2 {
        let way = to - from;
        match self.boundary {
            Boundary::Periodic => way - (way / self.size).round() * self.size,
            Boundary::Open => way,
        }
    }
}

/// What an exemplar never exceeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Smallest distance between two of its points.
    pub distance: f64,
    /// Smallest distances of a point from its second, third … sixth neighbour; see [`tightest_clumps`].
    pub clumps: [f64; CLUMP_SIZES],
    /// Radius of its largest empty circle.
    pub hole: f64,
    /// Smallest distance of a point from an open border; 0 where there is none.
    pub border: f64,
}

impl Limits {
    /// Those of `exemplar`; none with fewer than two points.
    #[must_use]
    pub fn of(exemplar: &Cloud) -> Option<Self> {
        let nearest = nearest_distances(exemplar, 1).ok()?;
        let distance = nearest.of_rank(1).fold(f64::INFINITY, f64::min);
        let inside = |point: &DVec2| point.min(exemplar.size() - *point).min_element();
        let border = match exemplar.boundary() {
            Boundary::Open => exemplar.points().iter().map(inside).fold(f64::INFINITY, f64::min),
            Boundary::Periodic => 0.0,
        };
        Some(Self {
            distance,
            clumps: tightest_clumps(exemplar).ok()?,
            hole: largest_empty_circle(exemplar).radius,
            border,
        })
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A square lattice of the unit square.
    pub(in crate::finish) fn grid(side: usize) -> Vec<DVec2> {
        (0..side * side).map(|i| (DVec2::new((i % side) as f64, (i / side) as f64) + 0.5) / side as f64).collect()
    }

    /// Points on the unit torus.
    pub(in crate::finish) fn cloud(points: &[DVec2]) -> Cloud {
        Cloud::new(points.to_vec(), DVec2::ONE, Boundary::Periodic).unwrap_or_else(|error| unreachable!("{error}"))
    }

    pub(in crate::finish) fn arrangement(
        classes: &[u16],
        first: usize,
        size: DVec2,
        boundary: Boundary,
    ) -> Arrangement<'_> {
        Arrangement { classes, first, size, boundary }
    }

    #[test]
    fn the_limits_of_a_lattice() {
        let limits = Limits::of(&cloud(&grid(6))).unwrap_or_else(|| unreachable!());
        assert!((limits.distance - 1.0 / 6.0).abs() < 1e-12);
        assert!((limits.hole - 0.5_f64.sqrt() / 6.0).abs() < 2e-4, "{}", limits.hole);
        assert_eq!(limits.border, 0.0, "a torus has no border");
        assert!(Limits::of(&cloud(&grid(1))).is_none(), "one point has no distance to another");
    }
}
