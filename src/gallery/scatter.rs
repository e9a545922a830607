//! Stochastic processes.

use glam::DVec2;

use super::sample::{Sample, angle, direction, random, scattered, torus_distance};
use crate::pattern::Boundary;
use crate::sampling::{lloyd_step, poisson_disk, white_noise, wrap};

/// Blue noise by Lloyd's relaxation on the torus (Lloyd 1982), stopped at a relative radius ρ of 0.73, where capacity-
/// constrained methods end (Balzer et al. 2009), before patches of hexagons form. 120 points.
pub(super) fn blue_noise(seed: u64) -> Sample {
    const POINTS: usize = 120;
    let mut points = poisson_disk(&mut random(seed), DVec2::ONE, POINTS, Boundary::Periodic);
    // ρ is half the smallest distance over the radius of the densest packing (Lagae & Dutré 2008).
    let densest = (2.0 / (3.0_f64.sqrt() * POINTS as f64)).sqrt();
    for _ in 0..400 {
        let mut smallest = f64::INFINITY;
        for (i, &a) in points.iter().enumerate() {
            for &b in &points[..i] {
                smallest = smallest.min(torus_distance(a, b, DVec2::ONE));
            }
        }
        if smallest >= 0.73 * densest {
            break;
        }
        points = lloyd_step(&points, DVec2::ONE, Boundary::Periodic);
    }
    Sample::tile(DVec2::ONE, points)
}

/// Poisson disk sampling by dart throwing (Cook 1986), with an exact count. 120 points.
pub(super) fn poisson_disk_darts(seed: u64) -> Sample {
    Sample::tile(DVec2::ONE, poisson_disk(&mut random(seed), DVec2::ONE, 120, Boundary::Periodic))
}

/// Binomial process: independent uniform points, i.e. complete spatial randomness with its count given. 120 points.
pub(super) fn uniform(seed: u64) -> Sample {
    Sample::tile(DVec2::ONE, white_noise(&mut random(seed), DVec2::ONE, 120))
}

/// Thomas process (Thomas 1949) with nine parents: a Poisson number of children each, 13 on average, normally
/// distributed about the parent. A child within 0.009 of another is drawn again, so that no two dots merge.
pub(super) fn cluster(seed: u64) -> Sample {
    let mut rng = random(seed);
    let parents = white_noise(&mut rng, DVec2::ONE, 9);
    let mut points: Vec<DVec2> = Vec::new();
    for parent in parents {
        // Bounded, so that no seed leaves the gallery's 40 to 300 points.
        let children = rng.poisson(13.0).clamp(5, 30);
        let mut missing = children;
        // The cap only guards against parents that coincide; it is never met in practice.
        for _ in 0..50 * children {
            if missing == 0 {
                break;
            }
            let child = wrap(parent + 0.034 * DVec2::new(rng.normal(), rng.normal()), DVec2::ONE);
            if points.iter().all(|&other| torus_distance(child, other, DVec2::ONE) >= 0.009) {
                points.push(child);
                missing -= 1;
            }
        }
    }
    Sample::tile(DVec2::ONE, points)
}

/// Cluster process of exactly two: pairs 0.036 apart at random angles, their middles a relaxed Poisson disk pattern.
/// 96 points, 48 pairs.
pub(super) fn pairs(seed: u64) -> Sample {
    let mut rng = random(seed);
    let middles = scattered(&mut rng, 48, 2);
    let points = middles.into_iter().flat_map(|middle| {
        let half = 0.018 * direction(angle(&mut rng));
        [middle + half, middle - half]
    });
    Sample::tile(DVec2::ONE, points.collect::<Vec<_>>())
}

/// Inhomogeneous Poisson disk process with two densities: three crowded bands of 34 points, each 0.14 wide, and three
/// sparse ones of 8 between them. Darts, with a radius that shrinks as a band fills up. 126 points.
pub(super) fn stripes(seed: u64) -> Sample {
    let mut rng = random(seed);
    let (crowded, sparse) = (0.14, 1.0 / 3.0 - 0.14);
    let mut points: Vec<DVec2> = Vec::new();
    for (width, offset, count) in [(crowded, 0.5 * sparse, 34_u32), (sparse, -0.5 * sparse, 8)] {
        for period in 0..3 {
            let left = f64::from(period) / 3.0 + offset;
            // The spacing of the densest packing of this band.
            let mut radius = (2.0 * width / (3.0_f64.sqrt() * f64::from(count))).sqrt();
            let (mut placed, mut misses) = (0, 0);
            while placed < count {
                let point = DVec2::new(left + width * rng.uniform(), rng.uniform());
                let point = wrap(point, DVec2::ONE);
                if points.iter().all(|&other| torus_distance(point, other, DVec2::ONE) >= radius) {
                    points.push(point);
                    placed += 1;
                } else {
                    misses += 1;
                    if misses % 200 == 0 {
                        radius *= 0.98;
                    }
                }
            }
        }
    }
    Sample::tile(DVec2::ONE, points)
}
