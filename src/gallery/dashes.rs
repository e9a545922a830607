//! Rows of points: walls, bars, courses and waves.

use std::f64::consts::TAU;

use glam::{DVec2, Vec2Swizzles as _};

use super::sample::{Sample, cells, jitter, random};

/// Random tiling with two tiles (Truchet 1704): on a 6 × 6 grid each cell holds a wall of 4 points, across in half of
/// the cells and upright in the others. Walls in line join. 144 points.
pub(super) fn maze(seed: u64) -> Sample {
    const CELLS: u32 = 6;
    const POINTS: u32 = 4;
    let mut rng = random(seed);
    let mut upright: Vec<bool> = (0..CELLS * CELLS).map(|cell| cell % 2 == 0).collect();
    rng.shuffle(&mut upright);
    let mut points = Vec::new();
    for ((column, row), upright) in cells(CELLS, CELLS).zip(upright) {
        for k in 0..POINTS {
            let along = (f64::from(k) + 0.5) / f64::from(POINTS);
            let (x, y) = if upright { (0.5, along) } else { (along, 0.5) };
            let point = DVec2::new(f64::from(column) + x, f64::from(row) + y) / f64::from(CELLS);
            points.push(point + jitter(&mut rng, 0.002));
        }
    }
    Sample::tile(DVec2::ONE, points)
}

/// Basket weave: on a 4 × 4 chequerboard each field holds two parallel bars of 4 points, across on the black fields
/// and upright on the white. 128 points.
pub(super) fn parquet(seed: u64) -> Sample {
    let mut rng = random(seed);
    let mut points = Vec::new();
    for (column, row) in cells(4, 4) {
        let centre = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5) / 4.0;
        for (k, bar) in cells(4, 2) {
            let offset = DVec2::new(0.05 * (f64::from(k) - 1.5), 0.11 * (f64::from(bar) - 0.5));
            let offset = if (column + row) % 2 == 0 { offset } else { offset.yx() };
            points.push(centre + offset + jitter(&mut rng, 0.002));
        }
    }
    Sample::tile(DVec2::ONE, points)
}

/// Running bond: the mortar of six courses of bricks, each course half a brick further than the one below, as points
/// a third of a course's height apart. The seed gives every course a little play. 144 points.
pub(super) fn bricks(seed: u64) -> Sample {
    let mut rng = random(seed);
    let unit = 1.0 / 18.0;
    let mut points = Vec::new();
    for course in 0..6 {
        let floor = f64::from(3 * course);
        let play = rng.range(-0.3, 0.3);
        points.extend((0..18).map(|k| DVec2::new(f64::from(k) + 0.5, floor + 0.5) * unit));
        let stagger = if course % 2 == 0 { 2.5 } else { 5.5 };
        for joint in 0..3 {
            let x = f64::from(6 * joint) + stagger + play;
            points.extend([1.5, 2.5].map(|y| DVec2::new(x, floor + y) * unit));
        }
    }
    Sample::tile(DVec2::ONE, points)
}

/// Parallel sine waves, five of two periods, each with 24 points at equal distances along the curve. The seed decides
/// where along each wave the points begin. 120 points.
pub(super) fn waves(seed: u64) -> Sample {
    const WAVES: u32 = 5;
    const POINTS: u32 = 24;
    const STEPS: u32 = 1200;
    let mut rng = random(seed);
    let wave = |x: f64| DVec2::new(x, 0.055 * libm::sin(2.0 * TAU * x));
    // The curve as a polyline fine enough (errors below 10⁻⁵) to measure length along it.
    let line: Vec<DVec2> = (0..=STEPS).map(|step| wave(f64::from(step) / f64::from(STEPS))).collect();
    let lengths: Vec<f64> = line.windows(2).map(|ends| ends[0].distance(ends[1])).collect();
    let total: f64 = lengths.iter().sum();
    let at = |length: f64| {
        let mut left = length;
        for (ends, &piece) in line.windows(2).zip(&lengths) {
            if left < piece {
                return ends[0].lerp(ends[1], left / piece);
            }
            left -= piece;
        }
        line[STEPS as usize]
    };
    let mut points = Vec::new();
    for row in 0..WAVES {
        let begin = rng.uniform();
        let middle = DVec2::new(0.0, (f64::from(row) + 0.5) / f64::from(WAVES));
        points.extend((0..POINTS).map(|k| middle + at(total * (f64::from(k) + begin) / f64::from(POINTS))));
    }
    Sample::tile(DVec2::ONE, points)
}
