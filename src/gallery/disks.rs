//! Disks: points with a radius.

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use super::sample::{Sample, angle, direction, fitting_unit, random, scattered, torus_distance};
use crate::sampling::Rng;

/// Size of the tile, centres, radii.
type Disks = (DVec2, Vec<DVec2>, Vec<f64>);

fn sample((size, points, values): Disks) -> Sample {
    Sample::tile(size, points).with("radius", values)
}

/// The next disk of a random sequential packing of the unit torus: the first of `tries` random places whose disk
/// touches none of those there.
fn dart(rng: &mut Rng, points: &[DVec2], radii: &[f64], tries: usize, radius: impl Fn(DVec2) -> f64) -> Option<DVec2> {
    (0..tries).map(|_| DVec2::new(rng.uniform(), rng.uniform())).find(|&place| {
        let own = radius(place);
        points.iter().zip(radii).all(|(&other, theirs)| torus_distance(place, other, DVec2::ONE) >= own + theirs)
    })
}

/// Random sequential adsorption (Feder 1980) of disks whose radius is a function of the place: twice across the tile
/// from 0.018 to 0.06 and back. Ends when two thousand darts in a row miss. About 200 disks.
pub(super) fn graded(seed: u64) -> Sample {
    let mut rng = random(seed);
    // Evenly in the logarithm, so that small disks do not take over.
    let radius = |place: DVec2| 0.033 * libm::exp(-0.6 * libm::cos(2.0 * TAU * place.x));
    let (mut points, mut radii) = (Vec::new(), Vec::new());
    while let Some(place) = dart(&mut rng, &points, &radii, 2000, radius) {
        points.push(place);
        radii.push(radius(place));
    }
    sample((DVec2::ONE, points, radii))
}

/// Random packing of 90 disks by darts, the largest first, radii falling as a power of the rank from 0.134 to 0.02;
/// none overlaps another. Half of the area is filled.
pub(super) fn packed(seed: u64) -> Sample {
    let mut rng = random(seed);
    let (mut points, mut radii) = (Vec::new(), Vec::new());
    for rank in 0..90 {
        let mut radius = 0.19 / f64::from(rank + 2).sqrt();
        loop {
            if let Some(place) = dart(&mut rng, &points, &radii, 2000, |_| radius) {
                points.push(place);
                radii.push(radius);
                break;
            }
            radius *= 0.98;
        }
    }
    sample((DVec2::ONE, points, radii))
}

/// Germ–grain process of necklaces: rings of 6 to 9 equal disks, large and small ones, whose neighbours stand 0.8
/// diameters apart. Two such disks share `2 acos 0.8 − 0.96` squared radii (the lens of two circles), and each has half
/// of two such lenses to itself: 10.4 % of its area, whatever its size. 67 disks.
pub(super) fn necklaces(seed: u64) -> Sample {
    let mut rng = random(seed);
    // How many disks, and how large they are against each other.
    let mut rings = [(9, 1.0), (6, 1.5), (8, 0.7), (7, 1.2), (8, 1.0), (6, 0.8), (7, 0.7), (8, 0.9), (8, 0.8)];
    rng.shuffle(&mut rings);
    let centres = scattered(&mut rng, rings.len(), 3);
    // Circumradius of a ring whose sides are 0.8 diameters.
    let circle = rings.map(|(count, radius)| 0.8 * radius / libm::sin(PI / f64::from(count)));
    let mut reach = circle;
    reach.iter_mut().zip(rings).for_each(|(reach, (_, radius))| *reach += radius);
    let unit = fitting_unit(&centres, &reach, 0.4);
    let (mut points, mut radii) = (Vec::new(), Vec::new());
    for ((&centre, (count, radius)), circle) in centres.iter().zip(rings).zip(circle) {
        let start = angle(&mut rng);
        for k in 0..count {
            points.push(centre + circle * unit * direction(start + TAU * f64::from(k) / f64::from(count)));
            radii.push(radius * unit);
        }
    }
    sample((DVec2::ONE, points, radii))
}
