//! A grid of cells that finds the points near a place.

use glam::DVec2;

use super::cloud::Cloud;
use crate::pattern::Boundary;

/// Most columns and rows of cells: with more, the cells of the largest pattern would hold less than a point in ten.
const MAX_CELLS: f64 = 512.0;

/// A point near another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbour {
    /// Which point.
    pub index: usize,
    /// From the place asked about to the point, or to its image where that is nearer.
    pub offset: DVec2,
    /// Squared length of the offset.
    pub distance_squared: f64,
}

/// The points of a [`Cloud`] sorted into cells of about one point each.
///
/// In a periodic cloud the cells go on beyond the border, so that images count as points of their own.
#[derive(Clone, Debug)]
pub struct Neighbours<'a> {
    cloud: &'a Cloud,
    cells: [i64; 2],
    cell_size: DVec2,
    /// Where each cell begins in `order`, row by row, and where the last one ends.
    starts: Vec<u32>,
    order: Vec<u32>,
}

impl<'a> Neighbours<'a> {
    /// Sorts the points into cells.
    #[must_use]
    pub(super) fn new(cloud: &'a Cloud) -> Self {
        let side = (1.0 / cloud.density()).sqrt();
        let count = (cloud.size() / side).round().clamp(DVec2::ONE, DVec2::splat(MAX_CELLS));
        let cells = [count.x as i64, count.y as i64];
        let mut grid = Self {
            cloud,
            cells,
            cell_size: cloud.size() / count,
            starts: vec![0; (cells[0] * cells[1]) as usize + 1],
            order: vec![0; cloud.len()],
        };
        let cell_of: Vec<usize> = cloud
            .points()
            .iter()
            .map(|&point| {
                let [column, row] = grid.cell_at(point);
                // Rounding may put a point of a tile one cell too far.
                (row.min(cells[1] - 1) * cells[0] + column.min(cells[0] - 1)) as usize
            })
            .collect();
        for &cell in &cell_of {
            grid.starts[cell + 1] += 1;
        }
        for cell in 1..grid.starts.len() {
            grid.starts[cell] += grid.starts[cell - 1];
        }
        let mut next = grid.starts.clone();
        for (index, &cell) in cell_of.iter().enumerate() {
            grid.order[next[cell] as usize] = index as u32;
            next[cell] += 1;
        }
        grid
    }

    fn cell_at(&self, place: DVec2) -> [i64; 2] {
        let cell = (place / self.cell_size).floor();
        let cell = [cell.x as i64, cell.y as i64];
        match self.cloud.boundary() {
            Boundary::Periodic => cell,
            // A point on the far border of a window belongs to the last cell.
            Boundary::Open => [cell[0].clamp(0, self.cells[0] - 1), cell[1].clamp(0, self.cells[1] - 1)],
        }
    }

    /// Calls `visit` for the points of one cell; beyond a window's border there are none.
    fn visit_cell(&self, column: i64, row: i64, place: DVec2, visit: &mut dyn FnMut(Neighbour, bool)) {
        let [columns, rows] = self.cells;
        let around = [column.div_euclid(columns), row.div_euclid(rows)];
        let image = around != [0, 0];
        if image && self.cloud.boundary() == Boundary::Open {
            return;
        }
        let shift = DVec2::new(around[0] as f64, around[1] as f64) * self.cloud.size() - place;
        let cell = (row.rem_euclid(rows) * columns + column.rem_euclid(columns)) as usize;
        for &index in &self.order[self.starts[cell] as usize..self.starts[cell + 1] as usize] {
            let offset = self.cloud.points()[index as usize] + shift;
            visit(Neighbour { index: index as usize, offset, distance_squared: offset.length_squared() }, image);
        }
    }

    /// Calls `visit` for every point, images included, at most `radius` from `place`, in no particular order.
    pub fn within(&self, place: DVec2, radius: f64, mut visit: impl FnMut(Neighbour)) {
        self.within_images(place, radius, &mut |neighbour, _| visit(neighbour));
    }

    /// One body for all callers: a copy for each of them would be kilobytes of the wasm.
    fn within_images(&self, place: DVec2, radius: f64, visit: &mut dyn FnMut(Neighbour, bool)) {
        let (from, to) = (self.cell_at(place - radius), self.cell_at(place + radius));
        for row in from[1]..=to[1] {
            for column in from[0]..=to[0] {
                self.visit_cell(column, row, place, &mut |neighbour, image| {
                    if neighbour.distance_squared <= radius * radius {
                        visit(neighbour, image);
                    }
                });
            }
        }
    }

    /// Calls `visit(i, j, offset from i to j)` once for every pair of points at most `radius` apart. On a torus each
    /// image makes a pair of its own, a point with its own images included.
    pub fn pairs(&self, radius: f64, mut visit: impl FnMut(usize, usize, DVec2)) {
        for (i, &place) in self.cloud.points().iter().enumerate() {
            self.within_images(place, radius, &mut |other, image| {
                let DVec2 { x, y } = other.offset;
                // A point sees each of its images twice, on opposite sides: half of them are enough.
                let own = other.index == i && image && (x > 0.0 || (x == 0.0 && y > 0.0));
                if other.index > i || own {
                    visit(i, other.index, other.offset);
                }
            });
        }
    }

    /// The `count` points nearest to `place`, nearest first, ties in the order of the points; `without` is left out
    /// (its images are not). In a window there may be fewer.
    pub fn nearest(&self, place: DVec2, count: usize, without: Option<usize>, found: &mut Vec<Neighbour>) {
        let mut best = Nearest { count, without, found };
        best.found.clear();
        if count == 0 {
            return;
        }
        let [column, row] = self.cell_at(place);
        let reach = self.cell_size.min_element();
        let last_ring = match self.cloud.boundary() {
            Boundary::Open => self.cells[0].max(self.cells[1]),
            Boundary::Periodic => i64::MAX,
        };
        // Square rings of cells, until nothing in the next one can be nearer.
        let mut ring = 0;
        while ring <= last_ring && best.farthest() > ((ring - 1).max(0) as f64 * reach).powi(2) {
            for y in row - ring..=row + ring {
                let step = if (y - row).abs() == ring { 1 } else { (2 * ring).max(1) };
                let mut x = column - ring;
                while x <= column + ring {
                    self.visit_cell(x, y, place, &mut |neighbour, image| best.offer(neighbour, image));
                    x += step;
                }
            }
            ring += 1;
        }
    }
}

/// The nearest points so far, nearest first.
struct Nearest<'a> {
    count: usize,
    without: Option<usize>,
    found: &'a mut Vec<Neighbour>,
}

impl Nearest<'_> {
    /// Squared distance beyond which a point is of no interest.
    fn farthest(&self) -> f64 {
        match self.found.last() {
            Some(last) if self.found.len() == self.count => last.distance_squared,
            _ => f64::INFINITY,
        }
    }

    fn offer(&mut self, neighbour: Neighbour, image: bool) {
        if (self.without == Some(neighbour.index) && !image) || neighbour.distance_squared > self.farthest() {
            return;
        }
        let key = |other: &Neighbour| (other.distance_squared, other.index);
        let at = self.found.partition_point(|other| key(other) <= key(&neighbour));
        self.found.insert(at, neighbour);
        self.found.truncate(self.count);
    }
}
