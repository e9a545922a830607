//! Small closed figures: rings, chevrons, squares, triangles, crosses.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec2;

use super::sample::{Sample, angle, cells, direction, fitting_unit, jitter, random, scattered};

/// Germ–grain process with ring-shaped grains: germs from a relaxed Poisson disk pattern, on each a regular polygon
/// of 7 to 10 points, all with the same side. 60 points, 7 rings.
///
/// After the ring exemplars used throughout the literature since Ma et al. 2011, *Discrete element textures*.
pub(super) fn rings(seed: u64) -> Sample {
    let mut rng = random(seed);
    let mut counts = [10_u32, 10, 9, 9, 8, 7, 7];
    rng.shuffle(&mut counts);
    let centres = scattered(&mut rng, counts.len(), 3);
    // Circumradius of a regular polygon of side 1.
    let reach = counts.map(|count| 0.5 / libm::sin(PI / f64::from(count)));
    let side = fitting_unit(&centres, &reach, 1.5);
    let points = centres.iter().zip(counts).zip(reach).flat_map(|((&centre, count), reach)| {
        let start = angle(&mut rng);
        (0..count).map(move |k| centre + reach * side * direction(start + TAU * f64::from(k) / f64::from(count)))
    });
    Sample::tile(DVec2::ONE, points)
}

/// Lattice of chevrons with a little play: three columns of six, each column a third of a row higher than the last,
/// so that the rows meet again after one tile. 90 points.
///
/// The "flying geese" of Huang et al. 2022.
pub(super) fn chevrons(seed: u64) -> Sample {
    let mut rng = random(seed);
    let points = cells(3, 6).flat_map(|(column, row)| {
        let (column, row) = (f64::from(column), f64::from(row));
        let tip = DVec2::new((column + 0.5) / 3.0, (row + 0.75 + column / 3.0) / 6.0) + jitter(&mut rng, 0.008);
        [-2.0, -1.0, 0.0, 1.0, 2.0].map(|k: f64| tip + DVec2::new(0.056 * k, -0.044 * k.abs()))
    });
    Sample::tile(DVec2::ONE, points.collect::<Vec<_>>())
}

/// Lattice of squares: 3 × 3 square outlines of 16 points, a point in the middle of each. Exact; the seed shifts the
/// whole. 153 points.
pub(super) fn nested_grids(seed: u64) -> Sample {
    let mut rng = random(seed);
    let spacing = 0.052;
    let shift = jitter(&mut rng, 0.02);
    let points = cells(3, 3).flat_map(|(column, row)| {
        let centre = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5) / 3.0 + shift;
        let outline_or_middle = |&(x, y): &(u32, u32)| x == 0 || x == 4 || y == 0 || y == 4 || (x, y) == (2, 2);
        cells(5, 5)
            .filter(outline_or_middle)
            .map(move |(x, y)| centre + spacing * DVec2::new(f64::from(x) - 2.0, f64::from(y) - 2.0))
    });
    Sample::tile(DVec2::ONE, points)
}

/// Germ–grain process with triangular grains: germs from a relaxed Poisson disk pattern, on each an equilateral
/// triangle of 9 points at a random angle. 108 points, 12 triangles.
pub(super) fn triangles(seed: u64) -> Sample {
    let mut rng = random(seed);
    let centres = scattered(&mut rng, 12, 4);
    // Circumradius of a triangle whose side is three units.
    let reach = 3.0_f64.sqrt();
    let unit = fitting_unit(&centres, &[reach; 12], 0.9);
    let mut points = Vec::new();
    for &centre in &centres {
        let start = angle(&mut rng);
        let corner = |k: u32| centre + reach * unit * direction(start + TAU * f64::from(k) / 3.0);
        for side in 0..3 {
            let (from, to) = (corner(side), corner(side + 1));
            points.extend((0..3).map(|step| from.lerp(to, f64::from(step) / 3.0)));
        }
    }
    Sample::tile(DVec2::ONE, points)
}

/// Staggered lattice of upright crosses of 9 points, with a little play. 162 points, 18 crosses.
pub(super) fn crosses(seed: u64) -> Sample {
    let mut rng = random(seed);
    let points = cells(3, 6).flat_map(|(column, row)| {
        let stagger = if row % 2 == 0 { 0.25 } else { 0.75 };
        let centre = DVec2::new((f64::from(column) + stagger) / 3.0, (f64::from(row) + 0.5) / 6.0);
        let centre = centre + jitter(&mut rng, 0.006);
        let arm = |k: u32| direction(FRAC_PI_2 * f64::from(k));
        let arms = (0..4).flat_map(move |k| [centre + 0.04 * arm(k), centre + 0.08 * arm(k)]);
        std::iter::once(centre).chain(arms)
    });
    Sample::tile(DVec2::ONE, points.collect::<Vec<_>>())
}
