//! *Holes* a little larger than the exemplar's are shrunk: no point is missing there, the points around them only stand
//! too far apart.

use glam::DVec2;

use super::arrangement::{Arrangement, HOLE, Limits};
use crate::analysis::largest_empty_circle;
use crate::pattern::keep_inside;

/// Points move into a hole a little farther than it needs, or the last of it would take for ever.
const HOLE_TARGET: f64 = 0.99;
/// Points this many radii from the middle of a hole are still its rim.
const RIM: f64 = 1.05;

/// Moves the rim of the largest hole towards its middle if the exemplar has none as large; says whether it did. No point
/// is missing there, they only stand a little too far apart, and a whole one more would leave a hole elsewhere. Frozen
/// ones stay.
pub fn shrink_hole(points: &mut [DVec2], arrangement: Arrangement<'_>, limits: Limits) -> bool {
    let Some(cloud) = arrangement.cloud(points) else { return false };
    let hole = largest_empty_circle(&cloud);
    let radius = HOLE * limits.hole;
    if hole.radius <= radius {
        return false;
    }
    let middle = DVec2::from(hole.center);
    // Three points hold a circle.
    let mut rim = Vec::with_capacity(4);
    cloud.neighbours().nearest(middle, 3, None, &mut rim);
    let mut drawn = false;
    for point in rim {
        let length = point.distance_squared.sqrt();
        if point.index >= arrangement.first && length < RIM * hole.radius {
            let place = middle + point.offset * (HOLE_TARGET * radius / length);
            points[point.index] = keep_inside(place, arrangement.size, arrangement.boundary);
            drawn = true;
        }
    }
    drawn
}

#[cfg(test)]
mod tests {
    use super::super::arrangement::tests::{arrangement, cloud, grid};
    use super::super::spacing::{Room, keep_apart};
    use super::*;
    use crate::pattern::Boundary;

    #[test]
    fn a_hole_a_little_too_large_is_drawn_together() {
        let whole = grid(6);
        let lattice = |first| arrangement(&[0; 36], first, DVec2::ONE, Boundary::Periodic);
        let limits = Limits::of(&cloud(&whole)).unwrap_or_else(|| unreachable!());
        let hole = |points: &[DVec2]| largest_empty_circle(&cloud(points)).radius / limits.hole;
        // The four points round the corner of the tile, so that the way to two or three of them leads across the border.
        let mut wide = whole.clone();
        for corner in [0, 5, 30, 35] {
            let middle = whole[corner].round();
            wide[corner] = middle + (whole[corner] - middle) * 1.3;
        }
        assert!(hole(&wide) > HOLE, "{}", hole(&wide));
        let mut narrowed = wide.clone();
        let mut rounds = 0;
        while shrink_hole(&mut narrowed, lattice(0), limits) {
            keep_apart(&mut narrowed, lattice(0), Room { distance: 0.8 * limits.distance, ..Room::default() });
            rounds += 1;
            assert!(rounds < 20, "{}", hole(&narrowed));
        }
        assert!(rounds > 0 && hole(&narrowed) <= HOLE, "{rounds} {}", hole(&narrowed));
        let nearest = Limits::of(&cloud(&narrowed)).map_or(0.0, |limits| limits.distance);
        assert!(nearest >= 0.8 * limits.distance - 1e-12, "{nearest}");
        for (index, (before, after)) in wide.iter().zip(&narrowed).enumerate() {
            assert!(before == after || [0, 5, 30, 35].contains(&index), "{index} is not of the rim");
        }
        // What is as it should be is left alone, and so is what may not move.
        let mut same = whole.clone();
        assert!(!shrink_hole(&mut same, lattice(0), limits) && same == whole);
        let mut frozen = wide.clone();
        assert!(!shrink_hole(&mut frozen, lattice(36), limits) && frozen == wide);
    }
}
