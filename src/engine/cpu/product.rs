//! Matrix products of the engine's shapes: thin, batched, with operands that need no packing.
//!
//! Libraries pack both operands anew at every call and allocate for it; the products here are small (100 × 120 × 120,
//! once per frequency and layer), their operands already lie contiguous along the lanes, and an iteration must not
//! allocate. `cargo bench --bench products` times this kernel beside the `gemm` crate on the engine's shapes.

#![expect(clippy::too_many_arguments, reason = "shapes and strides of three matrices, as BLAS has them")]
#![expect(clippy::needless_range_loop, reason = "the index runs over several arrays at once, as in the formulas")]

use super::lanes::LANES;
use super::real::Real;

/// Rows of a register block of the complex product: 3 × 16 × 2 accumulators fill twelve of sixteen vector registers.
const COMPLEX_ROWS: usize = 3;
/// Rows of a register block of the real product.
const REAL_ROWS: usize = 6;
/// Columns of a register block.
const COLUMNS: usize = 2 * LANES;

#[inline(always)]
fn multiply_add<T: Real, const FMA: bool>(a: T, b: T, c: T) -> T {
    if FMA { a.fused(b, c) } else { a * b + c }
}

/// A complex matrix whose real and imaginary parts are two real ones in the same buffer.
#[derive(Clone, Copy)]
pub struct Planar<'a, T> {
    /// The buffer.
    pub data: &'a [T],
    /// Distance from a real part to its imaginary part.
    pub imaginary: usize,
    /// Distance from a row to the next. Columns are adjacent.
    pub stride: usize,
}

#[inline(always)]
fn complex_block<T: Real, const ROWS: usize, const COLS: usize, const FMA: bool>(
    x: Planar<T>,
    first: usize,
    w: Planar<T>,
    column: usize,
    inner: usize,
    sign: T,
    y: &mut [T],
    y_imaginary: usize,
    y_stride: usize,
) {
    let mut re = [[T::ZERO; COLS]; ROWS];
    let mut im = [[T::ZERO; COLS]; ROWS];
    let x_re: [&[T]; ROWS] = std::array::from_fn(|row| &x.data[(first + row) * x.stride..][..inner]);
    let x_im: [&[T]; ROWS] = std::array::from_fn(|row| &x.data[x.imaginary + (first + row) * x.stride..][..inner]);
    for k in 0..inner {
        let (Some(w_re), Some(w_im)) = (
            w.data[k * w.stride + column..].first_chunk::<COLS>(),
            w.data[w.imaginary + k * w.stride + column..].first_chunk::<COLS>(),
        ) else {
            return;
        };
        for row in 0..ROWS {
            let (a, b) = (x_re[row][k], x_im[row][k]);
            let (minus_b, plus_a) = (-sign * b, sign * a);
            for col in 0..COLS {
                re[row][col] =
                    multiply_add::<T, FMA>(minus_b, w_im[col], multiply_add::<T, FMA>(a, w_re[col], re[row][col]));
                im[row][col] =
                    multiply_add::<T, FMA>(plus_a, w_im[col], multiply_add::<T, FMA>(b, w_re[col], im[row][col]));
            }
        }
    }
    for row in 0..ROWS {
        let at = (first + row) * y_stride + column;
        y[at..at + COLS].copy_from_slice(&re[row]);
        y[y_imaginary + at..y_imaginary + at + COLS].copy_from_slice(&im[row]);
    }
}

/// `Y = X · W` for complex `X` (`rows × inner`) and `W` (`inner × columns`, a multiple of [`LANES`] columns); with
/// `sign` −1 instead of 1, `W` is conjugated. `y` holds the real parts (`rows × columns`), then the imaginary ones.
#[inline(always)]
pub fn complex<T: Real, const FMA: bool>(
    x: Planar<T>,
    w: Planar<T>,
    rows: usize,
    inner: usize,
    columns: usize,
    sign: T,
    y: &mut [T],
) {
    let y_imaginary = rows * columns;
    let mut column = 0;
    while column < columns {
        let wide = columns - column >= COLUMNS;
        let mut row = 0;
        while row < rows {
            let tall = rows - row >= COMPLEX_ROWS;
            match (tall, wide) {
                (true, true) => complex_block::<T, COMPLEX_ROWS, COLUMNS, FMA>(
                    x,
                    row,
                    w,
                    column,
                    inner,
                    sign,
                    y,
                    y_imaginary,
                    columns,
                ),
                (true, false) => complex_block::<T, COMPLEX_ROWS, LANES, FMA>(
                    x,
                    row,
                    w,
                    column,
                    inner,
                    sign,
                    y,
                    y_imaginary,
                    columns,
                ),
                (false, true) => {
                    complex_block::<T, 1, COLUMNS, FMA>(x, row, w, column, inner, sign, y, y_imaginary, columns);
                }
                (false, false) => {
                    complex_block::<T, 1, LANES, FMA>(x, row, w, column, inner, sign, y, y_imaginary, columns);
                }
            }
            row += if tall { COMPLEX_ROWS } else { 1 };
        }
        column += if wide { COLUMNS } else { LANES };
    }
}

/// A real left operand with any strides: element `(row, k)` is `data[row · row_stride + k · inner_stride]`.
#[derive(Clone, Copy)]
pub struct Strided<'a, T> {
    /// The buffer.
    pub data: &'a [T],
    /// Distance from a row to the next.
    pub row_stride: usize,
    /// Distance from a column to the next.
    pub inner_stride: usize,
}

#[inline(always)]
fn real_block<T: Real, const ROWS: usize, const COLS: usize, const FMA: bool>(
    x: Strided<T>,
    first: usize,
    w: &[T],
    w_stride: usize,
    column: usize,
    inner: usize,
    y: &mut [T],
    y_stride: usize,
) {
    let mut sum = [[T::ZERO; COLS]; ROWS];
    for row in 0..ROWS {
        let at = (first + row) * y_stride + column;
        sum[row].copy_from_slice(&y[at..at + COLS]);
    }
    for k in 0..inner {
        let Some(w_row) = w[k * w_stride + column..].first_chunk::<COLS>() else { return };
        for row in 0..ROWS {
            let a = x.data[(first + row) * x.row_stride + k * x.inner_stride];
            for col in 0..COLS {
                sum[row][col] = multiply_add::<T, FMA>(a, w_row[col], sum[row][col]);
            }
        }
    }
    for row in 0..ROWS {
        let at = (first + row) * y_stride + column;
        y[at..at + COLS].copy_from_slice(&sum[row]);
    }
}

/// `Y += X · W` for real `X` (`rows × inner`) and `W` (`inner × columns`, rows `w_stride` apart); only columns from
/// `first_column(row block)` on are made, which is how a symmetric product skips its lower half.
#[inline(always)]
pub fn real<T: Real, const FMA: bool>(
    x: Strided<T>,
    w: &[T],
    w_stride: usize,
    rows: usize,
    inner: usize,
    columns: usize,
    y: &mut [T],
    upper_only: bool,
) {
    let mut row = 0;
    while row < rows {
        let tall = rows - row >= REAL_ROWS;
        let mut column = if upper_only { row / LANES * LANES } else { 0 };
        while column < columns {
            let wide = columns - column >= COLUMNS;
            match (tall, wide) {
                (true, true) => {
                    real_block::<T, REAL_ROWS, COLUMNS, FMA>(x, row, w, w_stride, column, inner, y, columns);
                }
                (true, false) => {
                    real_block::<T, REAL_ROWS, LANES, FMA>(x, row, w, w_stride, column, inner, y, columns);
                }
                (false, true) => real_block::<T, 1, COLUMNS, FMA>(x, row, w, w_stride, column, inner, y, columns),
                (false, false) => real_block::<T, 1, LANES, FMA>(x, row, w, w_stride, column, inner, y, columns),
            }
            column += if wide { COLUMNS } else { LANES };
        }
        row += if tall { REAL_ROWS } else { 1 };
    }
}
