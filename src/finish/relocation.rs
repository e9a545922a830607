//! *Relocation*: a point that is too close to its neighbour goes into a hole.
//!
//! Statistics of blurred maps barely change when two points coincide or when one lattice place stays empty while a point
//! stands beside another: the gradient there is small, and the way out leads uphill. The exemplar says what is out of
//! the question: a distance between points that it never has, and a hole larger than any of its own. Only such places
//! are touched, so a pattern that has none is left alone. (Tu et al. 2019, §5, add and remove whole points for this,
//! with weights that are optimised.)

use glam::DVec2;

use super::arrangement::{Arrangement, HOLE, Limits};
use crate::analysis::largest_empty_circle;

/// Points stand in each other's way below this share of the exemplar's smallest distance.
const CROWDED: f64 = 0.85;

/// Moves up to `most` points from crowds into holes; returns how many. Frozen ones count.
pub fn relocate(points: &mut [DVec2], arrangement: Arrangement<'_>, limits: Limits, most: usize) -> usize {
    let first = arrangement.first;
    let mut found = Vec::with_capacity(2);
    for moved in 0..most {
        let Some(cloud) = arrangement.cloud(points) else { return moved };
        let hole = largest_empty_circle(&cloud);
        if hole.radius <= HOLE * limits.hole {
            return moved;
        }
        // Of two that are in each other's way, the one that is more so in the second place.
        let grid = cloud.neighbours();
        let mut crowded = None;
        let mut smallest = f64::INFINITY;
        for (index, &point) in points.iter().enumerate().skip(first) {
            grid.nearest(point, 2, Some(index), &mut found);
            let (Some(nearest), Some(next)) = (found.first(), found.last()) else { continue };
            let both = nearest.distance_squared + next.distance_squared;
            if both < smallest && nearest.distance_squared.sqrt() < CROWDED * limits.distance {
                (crowded, smallest) = (Some(index), both);
            }
        }
        let Some(index) = crowded else { return moved };
        points[index] = hole.center.into();
    }
    most
}

#[cfg(test)]
mod tests {
    use super::super::arrangement::tests::{arrangement, cloud, grid};
    use super::*;
    use crate::pattern::Boundary;

    #[test]
    fn a_point_beside_another_goes_to_the_empty_place() {
        let whole = grid(6);
        let lattice = |first| arrangement(&[0; 36], first, DVec2::ONE, Boundary::Periodic);
        let limits = Limits::of(&cloud(&whole)).unwrap_or_else(|| unreachable!());
        assert!((limits.distance - 1.0 / 6.0).abs() < 1e-12);
        let mut broken = whole.clone();
        broken[14] = whole[3] + 0.02;
        assert_eq!(relocate(&mut broken, lattice(0), limits, 10), 1);
        let filled = broken.iter().map(|point| point.distance(whole[14])).fold(f64::INFINITY, f64::min);
        assert!(filled < 0.01, "{filled}");
        // What is as it should be is left alone, and so is what may not move.
        let mut same = whole.clone();
        assert_eq!(relocate(&mut same, lattice(0), limits, 10), 0);
        assert_eq!(same, whole);
        let mut frozen = whole.clone();
        frozen[14] = whole[3] + 0.02;
        let before = frozen.clone();
        assert_eq!(relocate(&mut frozen, lattice(36), limits, 10), 0);
        assert_eq!(frozen, before);
    }
}
