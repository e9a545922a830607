//! Pictures with one centre; the only entries that are windows, not tiles.

use std::f64::consts::PI;

use glam::DVec2;

use super::sample::{Sample, angle, direction, random};

/// Phyllotaxis by the golden angle: point `n` at radius ∝ √(n + ½), each 137.5° on from the last (Vogel 1979). The
/// seed turns it. 200 points.
pub(super) fn phyllotaxis(seed: u64) -> Sample {
    const POINTS: u32 = 200;
    let start = angle(&mut random(seed));
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    let scale = 0.485 / f64::from(POINTS).sqrt();
    let points = (0..POINTS).map(|n| {
        let n = f64::from(n);
        DVec2::splat(0.5) + scale * (n + 0.5).sqrt() * direction(start + golden * n)
    });
    Sample::window(points)
}

/// Concentric circles 0.11 apart, the points along each 0.07 apart, seen through a square. The seed turns each
/// circle.
pub(super) fn concentric(seed: u64) -> Sample {
    let mut rng = random(seed);
    let centre = DVec2::splat(0.5);
    let mut points = vec![centre];
    for circle in 1..=6 {
        let start = angle(&mut rng);
        let count = 10 * circle;
        points.extend((0..count).map(|k| {
            centre + 0.11 * f64::from(circle) * direction(start + 2.0 * PI * f64::from(k) / f64::from(count))
        }));
    }
    Sample::window(points)
}
