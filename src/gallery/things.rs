//! Things rather than dots: several classes, sizes, directions, depth.

use std::f64::consts::TAU;

use glam::DVec2;

use super::sample::{Sample, angle, cells, direction, jitter, random, scattered, torus_distance};
use crate::sampling::{Rng, wrap};

/// Adds `count` points by darts that `place` throws, each at least `least(i)` away from point `i`. Where that becomes
/// hard, all distances shrink.
fn throw(
    rng: &mut Rng,
    points: &mut Vec<DVec2>,
    count: usize,
    mut place: impl FnMut(&mut Rng) -> DVec2,
    least: impl Fn(usize) -> f64,
) {
    let (end, mut share, mut misses) = (points.len() + count, 1.0, 0);
    while points.len() < end {
        let dart = wrap(place(rng), DVec2::ONE);
        if points.iter().enumerate().all(|(i, &other)| torus_distance(dart, other, DVec2::ONE) >= share * least(i)) {
            points.push(dart);
        } else {
            misses += 1;
            if misses % 200 == 0 {
                share *= 0.98;
            }
        }
    }
}

fn anywhere(rng: &mut Rng) -> DVec2 {
    DVec2::new(rng.uniform(), rng.uniform())
}

/// A place at a distance of `near` to `far` from `centre`.
fn around(rng: &mut Rng, centre: DVec2, near: f64, far: f64) -> DVec2 {
    let distance = rng.range(near, far);
    centre + distance * direction(angle(rng))
}

/// Cluster process with visible parents: 32 flowers, a relaxed Poisson disk pattern, and by turns two and three bees
/// within 0.045 of each. 112 points.
pub(super) fn attracting(seed: u64) -> Sample {
    const FLOWERS: usize = 32;
    let mut rng = random(seed);
    let mut points = scattered(&mut rng, FLOWERS, 2);
    for flower in 0..FLOWERS {
        let centre = points[flower];
        throw(&mut rng, &mut points, 2 + flower % 2, |rng| around(rng, centre, 0.037, 0.045), |_| 0.037);
    }
    let bees = points.len() - FLOWERS;
    Sample::tile(DVec2::ONE, points).of(&[("flower", FLOWERS), ("bee", bees)])
}

/// Hard-core process of two classes, as the nests of two kinds of ant have been described (Harkness & Isham 1983): 0.05
/// between nests of a kind, much more between the kinds. The kinds settle by turns, four at a time. 96 points.
pub(super) fn repelling(seed: u64) -> Sample {
    const NESTS: usize = 48;
    let mut rng = random(seed);
    let mut points = Vec::new();
    let kind = |nest: usize| nest / 4 % 2;
    for nest in 0..2 * NESTS {
        let least = |other| if kind(other) == kind(nest) { 0.05 } else { 0.15 };
        throw(&mut rng, &mut points, 1, anywhere, least);
    }
    let of_kind =
        |wanted| points.iter().zip(0..).filter(move |&(_, nest)| kind(nest) == wanted).map(|(&point, _)| point);
    Sample::tile(DVec2::ONE, of_kind(0).chain(of_kind(1))).of(&[("harvester", NESTS), ("hunter", NESTS)])
}

/// Regular and stochastic at once: three rows of twelve houses with a little play, each row shifted by chance, and 80
/// trees as Poisson disk darts that keep clear of the houses. 116 points.
pub(super) fn houses(seed: u64) -> Sample {
    let mut rng = random(seed);
    let shifts = [rng.uniform(), rng.uniform(), rng.uniform()];
    let mut points: Vec<DVec2> = cells(12, 3)
        .map(|(column, row)| {
            let corner = DVec2::new(f64::from(column) + shifts[row as usize], f64::from(row) + 0.5);
            corner / DVec2::new(12.0, 3.0) + jitter(&mut rng, 0.004)
        })
        .collect();
    let houses = points.len();
    throw(&mut rng, &mut points, 80, anywhere, |i| if i < houses { 0.062 } else { 0.075 });
    Sample::tile(DVec2::ONE, points).of(&[("house", houses), ("tree", 80)])
}

/// Trees with the radius of their crowns: 13 old ones, a relaxed Poisson disk pattern, and around each six young ones
/// that touch nothing. The correlation of the marks is below 1 where old and young are neighbours. 91 points.
pub(super) fn grove(seed: u64) -> Sample {
    const OLD: usize = 13;
    let mut rng = random(seed);
    let mut points = scattered(&mut rng, OLD, 3);
    let mut radii: Vec<f64> = (0..OLD).map(|_| rng.range(0.05, 0.072)).collect();
    for old in 0..OLD {
        let (centre, crown) = (points[old], radii[old]);
        for _ in 0..6 {
            let radius = rng.range(0.014, 0.023);
            let (near, far) = (crown + radius + 0.004, crown + radius + 0.03);
            throw(&mut rng, &mut points, 1, |rng| around(rng, centre, near, far), |i| radii[i] + radius + 0.004);
            radii.push(radius);
        }
    }
    let trees = points.len();
    Sample::tile(DVec2::ONE, points).of(&[("tree", trees)]).with("radius", radii)
}

/// Boats in line on four rivers, alternately down and up the stream. The rivers are sine-generated curves, the shape
/// of meanders (Langbein & Leopold 1966): the direction swings as a sine of the way along the curve, so equal steps
/// are equal distances. The orientation is in degrees, counter-clockwise as one sees it. 72 boats.
pub(super) fn boats(seed: u64) -> Sample {
    const BOATS: u32 = 18;
    // Steps from boat to boat; a river makes two bends to either side.
    const STEPS: u32 = 24;
    let mut rng = random(seed);
    let swing = |way: f64| 0.95 * libm::sin(2.0 * TAU * way);
    let (mut points, mut turns) = (Vec::new(), Vec::new());
    for river in 0..4 {
        let begin = rng.uniform() / f64::from(BOATS);
        let way = |step: u32| begin + f64::from(step) / f64::from(BOATS * STEPS);
        let course: Vec<f64> = (0..BOATS * STEPS).map(|step| swing(way(step))).collect();
        let length: f64 = course.iter().map(|&heading| libm::cos(heading)).sum();
        let mut place = DVec2::new(rng.uniform(), 0.125 + 0.25 * f64::from(river));
        for (step, &heading) in (0..).zip(&course) {
            if step % STEPS == 0 {
                points.push(place);
                // y points down, and every second river runs back.
                turns.push(-heading.to_degrees() + 180.0 * f64::from(river % 2));
            }
            place += direction(heading) / length;
        }
    }
    let boats = points.len();
    Sample::tile(DVec2::ONE, points).of(&[("boat", boats)]).with("orientation", turns)
}

/// Four classes, each with its own company: trees that keep apart, bushes at their feet, flowers in drifts away from
/// them, stones anywhere. Depth is 0 in front and 1 far behind; within a class the nearer ones are larger. 118 points.
pub(super) fn meadow(seed: u64) -> Sample {
    /// Name, how many, the scale in front and the depth in front.
    const CLASSES: [(&str, usize, f64, f64); 4] =
        [("tree", 12, 3.2, 0.0), ("bush", 24, 1.5, 0.25), ("flower", 60, 0.9, 0.5), ("stone", 22, 1.1, 0.75)];
    let mut rng = random(seed);
    let mut points = scattered(&mut rng, CLASSES[0].1, 2);
    for tree in 0..CLASSES[0].1 {
        let foot = points[tree] + DVec2::new(0.0, 0.03);
        throw(&mut rng, &mut points, 2, |rng| around(rng, foot, 0.055, 0.085), |_| 0.05);
    }
    let clear = points.len();
    for _ in 0..6 {
        throw(&mut rng, &mut points, 1, anywhere, |i| if i < clear { 0.11 } else { 0.2 });
        let drift = points[points.len() - 1];
        throw(&mut rng, &mut points, 9, |rng| around(rng, drift, 0.0, 0.085), |i| if i < clear { 0.06 } else { 0.034 });
    }
    throw(&mut rng, &mut points, CLASSES[3].1, anywhere, |_| 0.055);

    let (mut scales, mut depths) = (Vec::new(), Vec::new());
    for (_, count, scale, depth) in CLASSES {
        for _ in 0..count {
            let back = rng.uniform();
            scales.push(scale * (1.0 - 0.35 * back));
            depths.push(depth + 0.25 * back);
        }
    }
    let classes = CLASSES.map(|(name, count, ..)| (name, count));
    Sample::tile(DVec2::ONE, points).of(&classes).with("scale", scales).with("depth", depths)
}
