//! *Perturbation*: the regions that came out worst are moved at random for another try.
//!
//! Gradient descent stops at the nearest arrangement that no small step improves: a ring left open, a wall with a point
//! too many. The regions whose neighbourhoods are least like any of the exemplar's, or that hold a hole larger than its
//! holes, are moved at random and go through the finer scales again while the rest holds them in place. A try that does not make
//! the pattern as a whole a better match is undone. (Tu et al. 2019, §5, reconsider single points by weights that are
//! optimised; here whole neighbourhoods get a second chance.)

use glam::DVec2;

use super::alignment::misfits;
use super::arrangement::{HOLE, Limits};
use crate::analysis::{Cloud, largest_empty_circle};
use crate::pattern::keep_inside;
use crate::sampling::Rng;
use crate::sorting::ascending;

/// Share of the points that are moved at random.
const SHARE: f64 = 0.15;
/// Perturbed points go this far, in mean spacings: at least so far that they leave their places, not so far that regions mix.
const WAY: [f64; 2] = [0.3, 0.9];
/// Misfits are averaged over this radius, in mean spacings: what is wrong with a point is wrong around it.
const REGION: f64 = 1.5;
/// A region with a lower mismatch than this, in mean spacings, is not worth another try.
const WORTH: f64 = 0.02;

/// How far a pattern is from its exemplar, in mean spacings; 0 when every neighbourhood matches as the exemplar's own do and no hole is
/// larger than its holes.
#[must_use]
pub fn mismatch(output: &Cloud, exemplar: &Cloud, limits: Limits) -> f64 {
    let misfits = misfits(output, exemplar);
    let mean = misfits.iter().sum::<f64>() / misfits.len().max(1) as f64;
    let hole = largest_empty_circle(output).radius / limits.hole.max(f64::MIN_POSITIVE);
    mean + WORTH * (hole / HOLE - 1.0).max(0.0)
}

/// Moves the points of `first …` in the regions that are worst at random; returns how many. None is worth it when 0.
pub fn perturb(
    points: &mut [DVec2],
    first: usize,
    output: &Cloud,
    exemplar: &Cloud,
    limits: Limits,
    rng: &mut Rng,
) -> usize {
    let Some(spacing) = exemplar.mean_spacing() else { return 0 };
    let misfits = misfits(output, exemplar);
    let grid = output.neighbours();
    let mut wrong: Vec<f64> = output
        .points()
        .iter()
        .map(|&place| {
            let (mut sum, mut count) = (0.0, 0.0);
            grid.within(place, REGION * spacing, |other| {
                sum += misfits[other.index];
                count += 1.0;
            });
            sum / f64::max(count, 1.0)
        })
        .collect();
    let hole = largest_empty_circle(output);
    if hole.radius > HOLE * limits.hole {
        // Its rim comes first.
        grid.within(hole.center.into(), hole.radius + spacing, |rim| wrong[rim.index] += 1.0);
    }
    let mut sorted = wrong[first..].to_vec();
    if sorted.is_empty() {
        return 0;
    }
    ascending(&mut sorted);
    let most = (SHARE * sorted.len() as f64).ceil() as usize;
    let least = sorted[sorted.len() - most.clamp(1, sorted.len())].max(WORTH);
    let mut perturbed = 0;
    for (point, _) in points.iter_mut().zip(&wrong).skip(first).filter(|(_, wrong)| **wrong >= least) {
        let (angle, way) = (rng.range(0.0, std::f64::consts::TAU), spacing * rng.range(WAY[0], WAY[1]));
        let moved = *point + way * DVec2::new(libm::cos(angle), libm::sin(angle));
        *point = keep_inside(moved, output.size(), output.boundary());
        perturbed += 1;
    }
    perturbed
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

    use super::*;
    use crate::pattern::Boundary;
    use crate::sampling::Purpose;

    fn grid(side: usize) -> Vec<DVec2> {
        (0..side * side).map(|i| (DVec2::new((i % side) as f64, (i / side) as f64) + 0.5) / 6.0).collect()
    }

    fn cloud(points: &[DVec2], size: f64) -> Cloud {
        Cloud::new(points.to_vec(), DVec2::splat(size), Boundary::Periodic).unwrap()
    }

    #[test]
    fn the_worst_region_is_perturbed_and_no_other() {
        let exemplar = cloud(&grid(6), 1.0);
        let limits = Limits::of(&exemplar).unwrap();
        let mut rng = Rng::new(3, Purpose::Restart { class: 0, restart: 0 });
        let whole = grid(12);
        let mut same = whole.clone();
        assert_eq!(perturb(&mut same, 0, &cloud(&whole, 2.0), &exemplar, limits, &mut rng), 0);
        assert_eq!(same, whole);
        assert!(mismatch(&cloud(&whole, 2.0), &exemplar, limits) < 1e-6);

        let mut broken = whole.clone();
        broken[65] += 0.06;
        broken[66] -= 0.05;
        let wrong = mismatch(&cloud(&broken, 2.0), &exemplar, limits);
        assert!(wrong > 0.002, "{wrong}");
        let mut perturbed = broken.clone();
        let count = perturb(&mut perturbed, 0, &cloud(&broken, 2.0), &exemplar, limits, &mut rng);
        assert!((2..=22).contains(&count), "{count}");
        for (index, (before, after)) in broken.iter().zip(&perturbed).enumerate() {
            if before != after {
                assert!(before.distance(broken[65]) < 0.75, "{index} is far from what is wrong");
            }
        }
        // What may not move does not.
        let mut frozen = broken.clone();
        perturb(&mut frozen, 144, &cloud(&broken, 2.0), &exemplar, limits, &mut rng);
        assert_eq!(frozen, broken);
    }
}
