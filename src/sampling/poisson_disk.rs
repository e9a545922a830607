//! Poisson-disk (blue-noise) points with an exact count.

use glam::DVec2;

use crate::pattern::Boundary;
use crate::sampling::Rng;

/// Exactly `count` points in `[0, size.x) × [0, size.y)` whose mutual distances stay large: darts are thrown at a
/// radius that starts near the densest packing's and shrinks each time it becomes hard to place another.
///
/// Distances wrap around in a periodic domain.
#[must_use]
pub fn poisson_disk(rng: &mut Rng, size: DVec2, count: usize, boundary: Boundary) -> Vec<DVec2> {
    if count == 0 {
        return Vec::new();
    }
    // Centres of `count` disks in the densest (hexagonal) packing lie this far apart (Lagae & Dutré 2008, r_max · 2).
    let densest = (2.0 * size.x * size.y / (3.0_f64.sqrt() * count as f64)).sqrt();
    // Random placement jams near 0.75 of it; starting just above costs little and keeps the result as even as darts get.
    let mut radius = 0.8 * densest;
    let columns = ((size.x / densest).floor() as usize).clamp(1, 4096);
    let rows = ((size.y / densest).floor() as usize).clamp(1, 4096);
    let cell_of = |point: DVec2| {
        let column = ((point.x / size.x * columns as f64) as usize).min(columns - 1);
        let row = ((point.y / size.y * rows as f64) as usize).min(rows - 1);
        (column, row)
    };
    // Cells are at least `densest` wide, so that everything within the radius lies in the 3 × 3 around a cell.
    let mut cells: Vec<Vec<u32>> = vec![Vec::new(); columns * rows];
    let mut points: Vec<DVec2> = Vec::with_capacity(count);
    let mut misses = 0;
    while points.len() < count {
        let candidate = DVec2::new(rng.uniform(), rng.uniform()) * size;
        let (column, row) = cell_of(candidate);
        let free = neighbours(column, columns, boundary).all(|x| {
            neighbours(row, rows, boundary).all(|y| {
                cells[y * columns + x].iter().all(|&other| {
                    let mut offset = (points[other as usize] - candidate).abs();
                    if boundary == Boundary::Periodic {
                        offset = offset.min(size - offset);
                    }
                    offset.length_squared() >= radius * radius
                })
            })
        });
        if free {
            cells[row * columns + column].push(points.len() as u32);
            points.push(candidate);
            misses = 0;
        } else {
            misses += 1;
            if misses == 200 {
                radius *= 0.98;
                misses = 0;
            }
        }
    }
    points
}

/// The cell and those beside it along one axis, without repeats.
fn neighbours(cell: usize, cells: usize, boundary: Boundary) -> impl Iterator<Item = usize> {
    let wraps = boundary == Boundary::Periodic;
    let before = if cell > 0 {
        Some(cell - 1)
    } else if wraps && cells > 2 {
        Some(cells - 1)
    } else {
        None
    };
    let after = if cell + 1 < cells {
        Some(cell + 1)
    } else if wraps && cells > 2 {
        Some(0)
    } else {
        None
    };
    [before, Some(cell), after].into_iter().flatten()
}
