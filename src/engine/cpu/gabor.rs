//! Gabor maps of the points, and the gradient with respect to their positions.
//!
//! `h(g) = s · Σᵢ exp(−‖D‖² / 2σ²) · cos(2π ν·D)` with `D = pᵢ − g`, for ν = (0, 0), (0, f), (f, 0), (f, f) and
//! (f, −f) (Huang et al. 2022, §4.1, Eq. 5). The paper feeds ten maps to the filters: the plain Gaussian and nine
//! frequencies {−f, 0, f}². As the cosine is even, only these five are distinct; the filter bank folds the other five.
//!
//! `cos(a + b) = cos a cos b − sin a sin b` makes every map a sum of products of a row table and a column table per
//! point. The jitter of the sampling grid shifts whole rows and whole columns, which keeps it so.
//!
//! A band of maps multiplies every point by a weight of its own (`method::bands`): the tables are the same for all bands,
//! and a point that weighs nothing costs nothing.

use glam::DVec2;

use crate::engine::filters::DISTINCT_MAPS as MAPS;
use crate::engine::view::{Grid, Wave, window};
use crate::engine::{Bands, Weights};
use crate::pattern::Boundary;

use super::lanes::{self, Kernel, LANES, padded};
use super::real::Real;
use crate::parallel::for_each_chunk;

/// Tables along one axis: Gaussian, its product with the cosine and with the sine, and the slope of each.
const TABLES: usize = 6;

/// Maps and gradients on one grid.
#[derive(Debug)]
pub struct Gabor<T> {
    grid: Grid,
    wave: Wave,
    bands: Bands,
    /// Of every point in every band, `[points, bands]`.
    weights: Vec<T>,
    /// Pixels a point's window spans: rows, columns.
    span: [usize; 2],
    /// Shift of each row and of each column in pixels.
    shift: [Vec<f64>; 2],
    /// First row and column of every point's window, before wrapping.
    starts: Vec<[isize; 2]>,
    /// Per point: the row tables `[TABLES, rows]`, then the column tables `[TABLES, columns]`.
    tables: Vec<T>,
    /// Gradient maps, one after the other: `[maps, height, width]`.
    planar: Vec<T>,
    /// Gradient of every point.
    gradients: Vec<[f64; 2]>,
}

impl<T: Real> Gabor<T> {
    /// Space for `points` points of these weights.
    #[must_use]
    pub fn new(grid: Grid, wave: Wave, points: usize, weights: &Weights) -> Self {
        let span = window(&grid, &wave);
        let bands = weights.bands();
        Self {
            grid,
            wave,
            bands,
            weights: weights.values(points).map(T::rounded).collect(),
            span,
            shift: [vec![0.0; grid.height], vec![0.0; grid.width]],
            starts: vec![[0; 2]; points],
            tables: vec![T::ZERO; points * TABLES * (span[0] + span[1])],
            planar: vec![T::ZERO; bands.maps() * grid.height * grid.width],
            gradients: vec![[0.0; 2]; points],
        }
    }

    /// Bytes that [`Self::new`] allocates.
    #[must_use]
    pub fn bytes_for(grid: &Grid, wave: &Wave, points: usize, bands: Bands) -> usize {
        let span = window(grid, wave);
        let numbers = points * (TABLES * (span[0] + span[1]) + bands.count()) + bands.maps() * grid.height * grid.width;
        numbers * size_of::<T>() + 32 * points
    }

    /// Shifts of rows and columns in pixels, to be set before [`Self::maps`].
    pub fn shifts_mut(&mut self) -> &mut [Vec<f64>; 2] {
        &mut self.shift
    }

    /// Makes the maps of `points` (exemplar units): `out` is `[height, width, maps]`, padded with zeros to whole lanes.
    pub fn maps(&mut self, points: &[DVec2], out: &mut [T]) {
        self.fill_tables(points);
        let row_len = self.grid.width * padded(self.bands.maps());
        // Four rows a task: enough work to share out, and the planes of a task stay in the first cache.
        for_each_chunk(out, 4 * row_len, |chunk, rows| {
            lanes::run(MapRows { gabor: self, first_row: 4 * chunk, rows });
        });
    }

    fn fill_tables(&mut self, points: &[DVec2]) {
        let Self { grid, wave, span, shift, .. } = self;
        for (start, point) in self.starts.iter_mut().zip(points) {
            let centre = [point.y / grid.pitch.y, point.x / grid.pitch.x];
            *start = std::array::from_fn(|axis| centre[axis].floor() as isize - (span[axis] / 2) as isize);
        }
        let starts = &self.starts;
        let inverse_sigma = 1.0 / wave.sigma;
        let omega = std::f64::consts::TAU * wave.frequency;
        for_each_chunk(&mut self.tables, TABLES * (span[0] + span[1]), |index, tables| {
            let (rows, columns) = tables.split_at_mut(TABLES * span[0]);
            let point = points[index];
            let axes = [
                (rows, point.y, grid.pitch.y, grid.height, &shift[0], starts[index][0]),
                (columns, point.x, grid.pitch.x, grid.width, &shift[1], starts[index][1]),
            ];
            for (tables, position, pitch, pixels, shift, start) in axes {
                let count = tables.len() / TABLES;
                for j in 0..count {
                    let pixel = start + j as isize;
                    let wrapped = pixel.rem_euclid(pixels as isize) as usize;
                    let offset = position - (pixel as f64 + 0.5 + shift[wrapped]) * pitch;
                    let scaled = T::rounded(offset * inverse_sigma);
                    let gauss = (T::rounded(-0.5) * scaled * scaled).exp();
                    let (sin, cos) = T::rounded(omega * offset).sin_cos();
                    let slope = -scaled * T::rounded(inverse_sigma);
                    let omega = T::rounded(omega);
                    let (with_cos, with_sin) = (gauss * cos, gauss * sin);
                    tables[j] = gauss;
                    tables[count + j] = with_cos;
                    tables[2 * count + j] = with_sin;
                    tables[3 * count + j] = slope * gauss;
                    tables[4 * count + j] = slope * with_cos - omega * with_sin;
                    tables[5 * count + j] = slope * with_sin + omega * with_cos;
                }
            }
        });
    }

    /// The row and the column tables of a point.
    #[inline(always)]
    fn tables_of(&self, point: usize) -> (&[T], &[T]) {
        let len = TABLES * (self.span[0] + self.span[1]);
        self.tables[point * len..(point + 1) * len].split_at(TABLES * self.span[0])
    }

    /// Calls `visit(place in the window, pixel, length)` for every run of pixels along one axis that a window of
    /// `span` pixels from `start` on covers.
    #[inline(always)]
    fn runs(start: isize, span: usize, pixels: usize, boundary: Boundary, mut visit: impl FnMut(usize, usize, usize)) {
        let len = pixels as isize;
        match boundary {
            Boundary::Open => {
                let first = start.max(0);
                let end = (start + span as isize).min(len);
                if first < end {
                    visit((first - start) as usize, first as usize, (end - first) as usize);
                }
            }
            Boundary::Periodic => {
                let mut done = 0;
                while done < span {
                    let pixel = (start + done as isize).rem_euclid(len) as usize;
                    let run = (pixels - pixel).min(span - done);
                    visit(done, pixel, run);
                    done += run;
                }
            }
        }
    }

    /// Gradient with respect to every point of `first …`, in exemplar units, from the gradient with respect to the
    /// maps, `[height, width, maps]` with padded maps. Uses the tables of the last [`Self::maps`].
    pub fn gradients(&mut self, map_gradient: &[T], first: usize) -> &[[f64; 2]] {
        let (height, width) = (self.grid.height, self.grid.width);
        let size = height * width;
        let stored = padded(self.bands.maps());
        for_each_chunk(&mut self.planar, size, |map, plane| {
            for (value, pixel) in plane.iter_mut().zip(map_gradient.chunks_exact(stored)) {
                *value = pixel[map];
            }
        });
        let mut gradients = std::mem::take(&mut self.gradients);
        for_each_chunk(&mut gradients[first..], 1, |index, out| {
            lanes::run(PointGradient { gabor: self, point: first + index, out: &mut out[0] });
        });
        self.gradients = gradients;
        &self.gradients[first..]
    }
}

/// Some rows of the maps.
struct MapRows<'a, T> {
    gabor: &'a Gabor<T>,
    first_row: usize,
    rows: &'a mut [T],
}

/// Columns worked on at a time, so that the sums of a row live on the stack.
const STRIP: usize = 512;

impl<T: Real> Kernel for MapRows<'_, T> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Gabor { grid, wave, bands, span, starts, weights, .. } = self.gabor;
        let scale = T::rounded(wave.scale);
        let stored = padded(bands.maps());
        let mut sums = [[T::ZERO; STRIP]; MAPS];
        for (offset, row) in self.rows.chunks_exact_mut(grid.width * stored).enumerate() {
            let y = self.first_row + offset;
            for (strip, out) in row.chunks_mut(STRIP * stored).enumerate() {
                let left = strip * STRIP;
                let right = left + out.len() / stored;
                out.fill(T::ZERO);
                for band in 0..bands.count() {
                    for sum in &mut sums {
                        sum.fill(T::ZERO);
                    }
                    for (point, start) in starts.iter().enumerate() {
                        let weight = weights[point * bands.count() + band];
                        if weight == T::ZERO {
                            continue;
                        }
                        let weight = scale * weight;
                        let (rows, columns) = self.gabor.tables_of(point);
                        // The rows of this point's window that fall on y: several, if it is taller than a periodic
                        // domain.
                        let offset = y as isize - start[0];
                        let (mut j, next) = match grid.boundary {
                            Boundary::Open if offset < 0 => continue,
                            Boundary::Open => (offset as usize, span[0]),
                            Boundary::Periodic => (offset.rem_euclid(grid.height as isize) as usize, grid.height),
                        };
                        while j < span[0] {
                            let table = |which: usize| rows[which * span[0] + j] * weight;
                            let (gauss, with_cos, with_sin) = (table(0), table(1), table(2));
                            Gabor::<T>::runs(start[1], span[1], grid.width, grid.boundary, |place, pixel, len| {
                                let from = pixel.max(left);
                                let end = (pixel + len).min(right);
                                if from >= end {
                                    return;
                                }
                                let len = end - from;
                                let column = |which: usize| &columns[which * span[1] + place + from - pixel..][..len];
                                let (e, c, s) = (column(0), column(1), column(2));
                                let [plain, along_y, along_x, diagonal, counter] = &mut sums;
                                let at = from - left..end - left;
                                let (plain, along_y) = (&mut plain[at.clone()], &mut along_y[at.clone()]);
                                let (along_x, diagonal) = (&mut along_x[at.clone()], &mut diagonal[at.clone()]);
                                let counter = &mut counter[at];
                                for x in 0..len {
                                    plain[x] += gauss * e[x];
                                    along_y[x] += with_cos * e[x];
                                    along_x[x] += gauss * c[x];
                                    let (even, odd) = (with_cos * c[x], with_sin * s[x]);
                                    diagonal[x] += even - odd;
                                    counter[x] += even + odd;
                                }
                            });
                            j += next;
                        }
                    }
                    let maps = bands.first(band)..bands.first(band + 1);
                    for (x, pixel) in out.chunks_exact_mut(stored).enumerate() {
                        for (value, sum) in pixel[maps.clone()].iter_mut().zip(&sums) {
                            *value = sum[x];
                        }
                    }
                }
            }
        }
    }
}

/// The gradient of one point.
struct PointGradient<'a, T> {
    gabor: &'a Gabor<T>,
    point: usize,
    out: &'a mut [f64; 2],
}

/// Dot product in eight partial sums, so that it vectorises.
#[inline(always)]
fn dot<T: Real>(a: &[T], b: &[T]) -> T {
    let mut sums = [T::ZERO; LANES];
    let (a_blocks, b_blocks) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let (a_rest, b_rest) = (a_blocks.remainder(), b_blocks.remainder());
    for (a, b) in a_blocks.zip(b_blocks) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let mut sum = T::ZERO;
    for (a, b) in a_rest.iter().zip(b_rest) {
        sum += *a * *b;
    }
    for part in sums {
        sum += part;
    }
    sum
}

impl<T: Real> Kernel for PointGradient<'_, T> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Gabor { grid, wave, bands, span, planar, weights, .. } = self.gabor;
        let start = self.gabor.starts[self.point];
        let (rows, columns) = self.gabor.tables_of(self.point);
        let size = grid.height * grid.width;
        let (mut along_x, mut along_y) = (0.0, 0.0);
        for band in 0..bands.count() {
            let weight = weights[self.point * bands.count() + band];
            if weight == T::ZERO {
                continue;
            }
            let first = bands.first(band);
            let (mut band_x, mut band_y) = (0.0, 0.0);
            Gabor::<T>::runs(start[0], span[0], grid.height, grid.boundary, |row_place, row, row_count| {
                for offset in 0..row_count {
                    let row_table = |which: usize| rows[which * span[0] + row_place + offset];
                    let (mut x_sum, mut y_sum) = (T::ZERO, T::ZERO);
                    Gabor::<T>::runs(start[1], span[1], grid.width, grid.boundary, |place, pixel, len| {
                        let column = |which: usize| &columns[which * span[1] + place..][..len];
                        let line =
                            |map: usize| &planar[(first + map) * size + (row + offset) * grid.width + pixel..][..len];
                        if bands.is_lone(band) {
                            x_sum += row_table(0) * dot(line(0), column(3));
                            y_sum += row_table(3) * dot(line(0), column(0));
                            return;
                        }
                        let (diagonal, counter) = (line(3), line(4));
                        let (c, c_slope, s, s_slope) = (column(1), column(4), column(2), column(5));
                        // Maps 3 and 4 are even ∓ odd: their gradients meet the cosines as a sum, the sines as a
                        // difference.
                        let even = |table: &[T]| dot(diagonal, table) + dot(counter, table);
                        let odd = |table: &[T]| dot(counter, table) - dot(diagonal, table);
                        x_sum += row_table(0) * (dot(line(0), column(3)) + dot(line(2), c_slope))
                            + row_table(1) * (dot(line(1), column(3)) + even(c_slope))
                            + row_table(2) * odd(s_slope);
                        y_sum += row_table(3) * (dot(line(0), column(0)) + dot(line(2), c))
                            + row_table(4) * (dot(line(1), column(0)) + even(c))
                            + row_table(5) * odd(s);
                    });
                    band_x += x_sum.wide();
                    band_y += y_sum.wide();
                }
            });
            along_x += weight.wide() * band_x;
            along_y += weight.wide() * band_y;
        }
        *self.out = [along_x * wave.scale, along_y * wave.scale];
    }
}
