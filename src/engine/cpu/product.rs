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

/// `Y = X · W` for complex `X` (`rows × inner`) and `W` (`inner × columns`, a multiple of [`LANES`] columns: all real
/// parts, then all imaginary ones), or `X · W̄`. `y` is `[rows, eight columns, re | im, LANES]`.
#[inline(always)]
pub fn complex<T: Real, const CONJUGATE: bool, const FMA: bool>(x: Pieces<T>, w: &[T], columns: usize, y: &mut [T]) {
    let (w_re, w_im) = w.split_at(x.inner * columns);
    // Blocks outermost: the weights of one frequency stay in the cache, the rows pass by once.
    for (block, y) in y[..x.rows * 2 * columns].chunks_mut(ROWS * 2 * columns).enumerate() {
        let first = block * (x.inner / LANES);
        for column in (0..columns).step_by(LANES) {
            let [re, im] = complex_block::<T, CONJUGATE, FMA>(x, first, &w_re[column..], &w_im[column..], columns);
            for ((y, re), im) in y.chunks_mut(2 * columns).zip(&re).zip(&im) {
                let line = &mut y[2 * column..][..LINE];
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
pub const REAL_ROWS: usize = 6;

/// `Y += X · W` for real `X` (`rows × columns`) and square `W` (`columns × columns`, a multiple of [`LANES`]). `X` is
/// packed into `packed` (at least `columns` times `rows` rounded up to [`REAL_ROWS`]) on the way.
#[inline(always)]
pub fn add_product<T: Real, const FMA: bool>(x: &[T], w: &[T], columns: usize, packed: &mut [T], y: &mut [T]) {
    let blocks = x.chunks(REAL_ROWS * columns).zip(y.chunks_mut(REAL_ROWS * columns));
    for (x, y) in blocks {
        let count = x.len() / columns;
        let packed = &mut packed[..REAL_ROWS * columns];
        for (row, x) in x.chunks_exact(columns).enumerate() {
            for (step, value) in packed.chunks_exact_mut(REAL_ROWS).zip(x) {
                step[row] = *value;
            }
        }
        let mut column = 0;
        while column + 2 * LANES <= columns {
            let block = real_block::<T, REAL_ROWS, { 2 * LANES }, FMA>(packed, REAL_ROWS, &w[column..], columns);
            add(&block[..count], &mut y[column..], columns);
            column += 2 * LANES;
        }
        if column < columns {
            let block = real_block::<T, REAL_ROWS, LANES, FMA>(packed, REAL_ROWS, &w[column..], columns);
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
