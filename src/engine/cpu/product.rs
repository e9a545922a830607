//! Matrix products of the engine's shapes: thin, batched, the same right operands in every iteration.
//!
//! General libraries pack both operands anew at every call and allocate for it. Here the right operand lies contiguous
//! along the lanes already, the left one of the complex product is written in the order in which it is read, and the code
//! stays safe.

use super::lanes::LANES;
use super::real::Real;

/// Rows of a register block of the complex product: with eight columns, real and imaginary parts, its sums fill twelve
/// of sixteen vector registers.
pub const ROWS: usize = 6;

#[inline(always)]
fn multiply_add<T: Real, const FMA: bool>(a: T, b: T, c: T) -> T {
    if FMA { a.fused(b, c) } else { a * b + c }
}

/// Numbers in a piece of a left operand: eight channels of [`ROWS`] rows, `[ROWS, re | im, LANES]`. Whoever makes the
/// operand writes it so, a cache line at a time; the product then reads one contiguous piece, without packing it anew.
pub const PIECE: usize = ROWS * LINE;
/// Eight channels of a complex number, `[re | im, LANES]`.
pub const LINE: usize = 2 * LANES;

/// The left operand of a complex product: a piece for every block of [`ROWS`] rows and eight channels, blocks outermost.
#[derive(Clone, Copy)]
pub struct Pieces<'a, T> {
    /// From the first piece on; the last block may hold rows that mean nothing.
    pub data: &'a [T],
    /// From one piece to the next.
    pub stride: usize,
    /// Rows that mean something.
    pub rows: usize,
    /// Length of the inner product, a multiple of [`LANES`].
    pub inner: usize,
}

#[inline(always)]
fn complex_block<T: Real, const CONJUGATE: bool, const FMA: bool>(
    x: Pieces<T>,
    first: usize,
    w_re: &[T],
    w_im: &[T],
    stride: usize,
) -> [[[T; LANES]; ROWS]; 2] {
    let mut re = [[T::ZERO; LANES]; ROWS];
    let mut im = [[T::ZERO; LANES]; ROWS];
    let lines = LANES * stride;
    for (group, (w_re, w_im)) in w_re.chunks(lines).zip(w_im.chunks(lines)).enumerate() {
        let Some(x) = x.data[(first + group) * x.stride..].first_chunk::<PIECE>() else { break };
        for (k, (w_re, w_im)) in w_re.chunks(stride).zip(w_im.chunks(stride)).enumerate().take(LANES) {
            let (Some(w_re), Some(w_im)) = (w_re.first_chunk::<LANES>(), w_im.first_chunk::<LANES>()) else { break };
            for row in 0..ROWS {
                let (a, b) = (x[row * LINE + k], x[row * LINE + LANES + k]);
                let (a_signed, b_signed) = if CONJUGATE { (-a, b) } else { (a, -b) };
                for col in 0..LANES {
                    re[row][col] = multiply_add::<T, FMA>(a, w_re[col], re[row][col]);
                    im[row][col] = multiply_add::<T, FMA>(b, w_re[col], im[row][col]);
                }
                for col in 0..LANES {
                    re[row][col] = multiply_add::<T, FMA>(b_signed, w_im[col], re[row][col]);
                    im[row][col] = multiply_add::<T, FMA>(a_signed, w_im[col], im[row][col]);
                }
            }
        }
    }
    [re, im]
}

/// Where a complex product goes: a [`LINE`] for every row and eight columns of it, rows outermost.
#[derive(Debug)]
pub struct Lines<'a, T> {
    /// From the first line on.
    pub data: &'a mut [T],
    /// From one line to the next.
    pub stride: usize,
}

impl<T> Lines<'_, T> {
    /// Line number `index`.
    #[inline(always)]
    pub fn line(&mut self, index: usize) -> &mut [T] {
        &mut self.data[index * self.stride..][..LINE]
    }
}

/// `Y = X · W` for complex `X` (`rows × inner`) and `W` (`inner × columns`, a multiple of [`LANES`] columns: all real
/// parts, then all imaginary ones), or `X · W̄`.
#[inline(always)]
pub fn complex<T: Real, const CONJUGATE: bool, const FMA: bool>(
    x: Pieces<T>,
    w: &[T],
    columns: usize,
    y: &mut Lines<T>,
) {
    if !T::faster_complex::<CONJUGATE>(x, w, columns, y) {
        complex_by_lanes::<T, CONJUGATE, FMA>(x, w, columns, y);
    }
}

/// The same with vectors of [`LANES`].
#[inline(always)]
fn complex_by_lanes<T: Real, const CONJUGATE: bool, const FMA: bool>(
    x: Pieces<T>,
    w: &[T],
    columns: usize,
    y: &mut Lines<T>,
) {
    let (w_re, w_im) = w.split_at(x.inner * columns);
    // Blocks outermost: the weights of one frequency stay in the cache, the rows pass by once.
    for (block, first_row) in (0..x.rows).step_by(ROWS).enumerate() {
        let first = block * (x.inner / LANES);
        for column in (0..columns).step_by(LANES) {
            let [re, im] = complex_block::<T, CONJUGATE, FMA>(x, first, &w_re[column..], &w_im[column..], columns);
            for ((row, re), im) in (first_row..x.rows).zip(&re).zip(&im) {
                let line = y.line((row * columns + column) / LANES);
                line[..LANES].copy_from_slice(re);
                line[LANES..].copy_from_slice(im);
            }
        }
    }
}

/// Sum over the steps k of the inner product of `x[k · step …]` (one value a row) times `w[k · stride …]`.
#[inline(always)]
fn real_block<T: Real, const TALL: usize, const COLS: usize, const FMA: bool>(
    x: &[T],
    step: usize,
    w: &[T],
    stride: usize,
) -> [[T; COLS]; TALL] {
    let mut sum = [[T::ZERO; COLS]; TALL];
    for (x, w) in x.chunks(step).zip(w.chunks(stride)) {
        let (Some(x), Some(w)) = (x.first_chunk::<TALL>(), w.first_chunk::<COLS>()) else { break };
        for row in 0..TALL {
            for col in 0..COLS {
                sum[row][col] = multiply_add::<T, FMA>(x[row], w[col], sum[row][col]);
            }
        }
    }
    sum
}

/// Adds a block of sums to the first `count` rows of `y`.
#[inline(always)]
fn add<T: Real, const COLS: usize>(block: &[[T; COLS]], y: &mut [T], stride: usize) {
    for (line, y) in block.iter().zip(y.chunks_mut(stride)) {
        for (y, value) in y.iter_mut().zip(line) {
            *y += *value;
        }
    }
}

/// Rows of a block of [`add_product`].
const REAL_ROWS: usize = 6;

/// Inner products of six rows `x` with columns of `w[k · stride …]`.
#[inline(always)]
fn rows_block<T: Real, const COLS: usize, const FMA: bool>(
    x: [&[T]; REAL_ROWS],
    w: &[T],
    stride: usize,
) -> [[T; COLS]; REAL_ROWS] {
    let mut sum = [[T::ZERO; COLS]; REAL_ROWS];
    for (k, w) in w.chunks(stride).enumerate() {
        let Some(w) = w.first_chunk::<COLS>() else { break };
        for row in 0..REAL_ROWS {
            for col in 0..COLS {
                sum[row][col] = multiply_add::<T, FMA>(x[row][k], w[col], sum[row][col]);
            }
        }
    }
    sum
}

/// `Y += X · W` for real `X` (`rows × columns`) and square `W` (`columns × columns`, a multiple of [`LANES`]).
#[inline(always)]
pub fn add_product<T: Real, const FMA: bool>(x: &[T], w: &[T], columns: usize, y: &mut [T]) {
    let blocks = x.chunks(REAL_ROWS * columns).zip(y.chunks_mut(REAL_ROWS * columns));
    for (x, y) in blocks {
        let count = x.len() / columns;
        // Where rows are missing, the last one again: its sums are not added.
        let rows = std::array::from_fn(|row| &x[row.min(count - 1) * columns..][..columns]);
        let mut column = 0;
        while column + 2 * LANES <= columns {
            let block = rows_block::<T, { 2 * LANES }, FMA>(rows, &w[column..], columns);
            add(&block[..count], &mut y[column..], columns);
            column += 2 * LANES;
        }
        if column < columns {
            let block = rows_block::<T, LANES, FMA>(rows, &w[column..], columns);
            add(&block[..count], &mut y[column..], columns);
        }
    }
}

/// `Y += Xᵀ · X` for real `X` (`rows × columns`, a multiple of [`LANES`] columns). Only blocks on and above the
/// diagonal are made.
#[inline(always)]
pub fn add_square<T: Real, const FMA: bool>(x: &[T], columns: usize, y: &mut [T]) {
    let mut row = 0;
    while row < columns {
        let tall = columns - row >= REAL_ROWS;
        let mut column = row / LANES * LANES;
        while column < columns {
            let wide = columns - column >= 2 * LANES;
            let (left, right) = (&x[row..], &x[column..]);
            let y = &mut y[row * columns + column..];
            match (tall, wide) {
                (true, true) => {
                    add(&real_block::<T, REAL_ROWS, { 2 * LANES }, FMA>(left, columns, right, columns), y, columns);
                }
                (true, false) => {
                    add(&real_block::<T, REAL_ROWS, LANES, FMA>(left, columns, right, columns), y, columns);
                }
                // A multiple of eight leaves two or four rows over.
                (false, true) => {
                    add(&real_block::<T, 2, { 2 * LANES }, FMA>(left, columns, right, columns), y, columns)
                }
                (false, false) => add(&real_block::<T, 2, LANES, FMA>(left, columns, right, columns), y, columns),
            }
            column += if wide { 2 * LANES } else { LANES };
        }
        row += if tall { REAL_ROWS } else { 2 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Purpose, Rng};

    /// Rows, inner length and columns: whole and broken blocks of rows, whole vectors of sixteen columns and half ones.
    const SHAPES: [[usize; 3]; 4] = [[6, 8, 16], [1, 16, 8], [13, 24, 24], [12, 40, 40]];

    fn noise<T: Real>(rng: &mut Rng, len: usize) -> Vec<T> {
        (0..len).map(|_| T::rounded(rng.range(-1.0, 1.0))).collect()
    }

    /// By the definition, in double precision, from the same layouts.
    fn expected(x: Pieces<f32>, w: &[f32], columns: usize, conjugate: bool) -> Vec<[f64; 2]> {
        let at = |row: usize, k: usize, part: usize| {
            let piece = (row / ROWS * (x.inner / LANES) + k / LANES) * x.stride;
            x.data[piece + row % ROWS * LINE + part * LANES + k % LANES].wide()
        };
        let mut y = Vec::new();
        for row in 0..x.rows {
            for column in 0..columns {
                let (mut re, mut im) = (0.0, 0.0);
                for k in 0..x.inner {
                    let (a, b) = (at(row, k, 0), at(row, k, 1));
                    let (c, d) = (w[k * columns + column].wide(), w[(x.inner + k) * columns + column].wide());
                    let d = if conjugate { -d } else { d };
                    re += a * c - b * d;
                    im += a * d + b * c;
                }
                y.push([re, im]);
            }
        }
        y
    }

    fn check<const CONJUGATE: bool>([rows, inner, columns]: [usize; 3]) {
        let mut rng = Rng::new(8, Purpose::Gallery);
        // As the convolution has them: a gap between two pieces, and between two lines.
        let (piece_stride, line_stride) = (3 * PIECE, 2 * LINE);
        let data = noise::<f32>(&mut rng, rows.div_ceil(ROWS) * (inner / LANES) * piece_stride);
        let x = Pieces { data: &data, stride: piece_stride, rows, inner };
        let w = noise(&mut rng, 2 * inner * columns);
        let product = |multiply: &dyn Fn(&mut Lines<f32>)| {
            let mut y = vec![f32::NAN; rows * columns / LANES * line_stride];
            multiply(&mut Lines { data: &mut y, stride: line_stride });
            y
        };
        let chosen = product(&|y| complex::<f32, CONJUGATE, true>(x, &w, columns, y));
        let by_lanes = product(&|y| complex_by_lanes::<f32, CONJUGATE, true>(x, &w, columns, y));
        // The same bits, also of what lies between the lines.
        let bits = |y: &[f32]| y.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&chosen), bits(&by_lanes), "{rows} × {inner} × {columns}");
        for (index, [re, im]) in expected(x, &w, columns, CONJUGATE).into_iter().enumerate() {
            let at = index / LANES * line_stride + index % LANES;
            for (value, expected) in [(chosen[at], re), (chosen[at + LANES], im)] {
                assert!((value.wide() - expected).abs() < 1e-5, "{rows} × {inner} × {columns}: {value}, {expected}");
            }
        }
    }

    #[test]
    fn complex_products_are_right_and_the_same_bits_whatever_the_vectors() {
        for shape in SHAPES {
            check::<false>(shape);
            check::<true>(shape);
        }
    }
}
