//! Lattices, commensurate with their rectangle so that they tile.

use glam::DVec2;

use super::sample::{Sample, cells, jitter, random};

/// Hexagonal (triangular) lattice: ten rows of ten in a rectangle of 1 × √3⁄2, all six neighbours at 0.1. The seed
/// shifts it. 100 points.
pub(super) fn hex(seed: u64) -> Sample {
    let shift = jitter(&mut random(seed), 0.02);
    let row_height = 3.0_f64.sqrt() / 20.0;
    let points = cells(10, 10).map(|(column, row)| {
        let stagger = if row % 2 == 0 { 0.25 } else { 0.75 };
        DVec2::new((f64::from(column) + stagger) * 0.1, (f64::from(row) + 0.5) * row_height) + shift
    });
    Sample::tile(DVec2::new(1.0, 10.0 * row_height), points)
}

/// Square lattice, 10 × 10. The seed shifts it. 100 points.
pub(super) fn square_grid(seed: u64) -> Sample {
    let shift = jitter(&mut random(seed), 0.02);
    let points =
        cells(10, 10).map(|(column, row)| DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5) * 0.1 + shift);
    Sample::tile(DVec2::ONE, points)
}

/// Jittered sampling (Cook 1986) on an 11 × 11 grid, each point within the middle 60 % of its cell's sides. 121 points.
pub(super) fn jittered_grid(seed: u64) -> Sample {
    let mut rng = random(seed);
    let points = cells(11, 11).map(|(column, row)| {
        (DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5) + jitter(&mut rng, 0.3)) / 11.0
    });
    Sample::tile(DVec2::ONE, points.collect::<Vec<_>>())
}

/// Honeycomb: the corners of regular hexagons and the middles of their sides, five by six cells in a rectangle of
/// 1 × 3√3⁄5. The seed shifts it. 150 points.
pub(super) fn honeycomb(seed: u64) -> Sample {
    let shift = jitter(&mut random(seed), 0.02);
    // A hexagon 0.2 wide has a side of 0.2 ⁄ √3; rows of cells are 1.5 sides apart.
    let side = 0.2 / 3.0_f64.sqrt();
    let points = cells(5, 6).flat_map(|(column, row)| {
        let stagger = if row % 2 == 0 { 0.25 } else { 0.75 };
        let cell = DVec2::new((f64::from(column) + stagger) * 0.2, (f64::from(row) + 0.4) * 1.5 * side) + shift;
        // Per cell two corners (a valley and the peak to its right) and the three sides that leave the valley.
        let (valley, right, left) = (cell, DVec2::new(0.1, 0.5 * side), DVec2::new(-0.1, 0.5 * side));
        [valley, valley + right, valley + 0.5 * right, valley + 0.5 * left, valley - DVec2::new(0.0, 0.5 * side)]
    });
    Sample::tile(DVec2::new(1.0, 9.0 * side), points)
}
