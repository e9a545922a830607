//! Two loops with explicit vectors of x86-64, which the compiler takes apart when left to itself.
//!
//! The complex product is a third of an iteration; with AVX-512 it goes over sixteen channels at a time. Its sums are taken
//! in the same order as those over eight with a fused multiply-add, so the results are the same bits. The transposition
//! is what the gradient's product needs of every filter in every iteration.

use std::arch::x86_64::__m256;
use std::hint::black_box;

use pulp::x86::{V3, V4};
use pulp::{NullaryFnOnce, Simd, f32x16};

use super::lanes::LANES;
use super::product::{LINE, Lines, PIECE, Pieces, ROWS};

/// Channels in a 512-bit vector.
const WIDE: usize = 2 * LANES;
/// Pieces of the left operand are whole pages apart, so that nothing fetches the next one in time unless it is asked for:
/// one number of each of its cache lines, this many pieces before it is needed. (A prefetch would do, but is not safe
/// code, and no faster.)
const AHEAD: usize = 3;

/// [`super::product::complex`] with 512-bit vectors. Returns whether this machine has them; nothing is written where it
/// has not.
pub(crate) fn complex<const CONJUGATE: bool>(x: Pieces<f32>, w: &[f32], columns: usize, y: &mut Lines<f32>) -> bool {
    let Some(simd) = V4::try_new() else { return false };
    simd.vectorize(Complex::<CONJUGATE> { simd, x, w, columns, y });
    true
}

struct Complex<'a, 'b, const CONJUGATE: bool> {
    simd: V4,
    x: Pieces<'a, f32>,
    w: &'a [f32],
    columns: usize,
    y: &'a mut Lines<'b, f32>,
}

impl<const CONJUGATE: bool> NullaryFnOnce for Complex<'_, '_, CONJUGATE> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { simd, x, w, columns, y } = self;
        let (w_re, w_im) = w.split_at(x.inner * columns);
        for (block, first_row) in (0..x.rows).step_by(ROWS).enumerate() {
            let first = block * (x.inner / LANES);
            for column in (0..columns).step_by(WIDE) {
                let [re, im] = complex_block::<CONJUGATE>(simd, x, first, &w_re[column..], &w_im[column..], columns);
                for ((row, re), im) in (first_row..x.rows).zip(re).zip(im) {
                    let (re, im): ([f32; WIDE], [f32; WIDE]) = (pulp::cast(re), pulp::cast(im));
                    // The last block may be half empty.
                    for half in (0..WIDE.min(columns - column)).step_by(LANES) {
                        let line = y.line((row * columns + column + half) / LANES);
                        line[..LANES].copy_from_slice(&re[half..half + LANES]);
                        line[LANES..].copy_from_slice(&im[half..half + LANES]);
                    }
                }
            }
        }
    }
}

/// The sums of [`ROWS`] rows and sixteen columns, or of eight and eight that mean nothing.
#[inline(always)]
fn complex_block<const CONJUGATE: bool>(
    simd: V4,
    x: Pieces<f32>,
    first: usize,
    w_re: &[f32],
    w_im: &[f32],
    stride: usize,
) -> [[f32x16; ROWS]; 2] {
    let mut re = [simd.splat_f32s(0.0); ROWS];
    let mut im = re;
    let lines = LANES * stride;
    for (group, (w_re, w_im)) in w_re.chunks(lines).zip(w_im.chunks(lines)).enumerate() {
        let piece = |number: usize| x.data.get(number * x.stride..)?.first_chunk::<PIECE>();
        for next in piece(first + group + AHEAD).into_iter().flat_map(|next| next.chunks_exact(LINE)) {
            black_box(next[0]);
        }
        let Some(x) = piece(first + group) else { break };
        for (k, (w_re, w_im)) in w_re.chunks(stride).zip(w_im.chunks(stride)).enumerate().take(LANES) {
            let (w_re, w_im) = (load(w_re), load(w_im));
            let negative = simd.neg_f32s(w_im);
            let (for_re, for_im) = if CONJUGATE { (w_im, negative) } else { (negative, w_im) };
            for row in 0..ROWS {
                let (a, b) = (simd.splat_f32s(x[row * LINE + k]), simd.splat_f32s(x[row * LINE + LANES + k]));
                re[row] = simd.mul_add_f32s(a, w_re, re[row]);
                im[row] = simd.mul_add_f32s(b, w_re, im[row]);
                re[row] = simd.mul_add_f32s(b, for_re, re[row]);
                im[row] = simd.mul_add_f32s(a, for_im, im[row]);
            }
        }
    }
    [re, im]
}

/// The first sixteen numbers; zeros after eight where there are no more.
#[inline(always)]
fn load(from: &[f32]) -> f32x16 {
    pulp::cast(from.first_chunk::<WIDE>().copied().unwrap_or_else(|| {
        let mut wide = [0.0; WIDE];
        wide[..LANES].copy_from_slice(&from[..LANES]);
        wide
    }))
}

/// Transposes `rows × columns` numbers, both multiples of [`LANES`]. Returns whether this machine has AVX2; nothing is
/// written where it has not.
pub(crate) fn transpose(from: &[f32], to: &mut [f32], rows: usize, columns: usize) -> bool {
    let Some(simd) = V3::try_new() else { return false };
    simd.vectorize(Transpose { simd, from, to, rows, columns });
    true
}

struct Transpose<'a> {
    simd: V3,
    from: &'a [f32],
    to: &'a mut [f32],
    rows: usize,
    columns: usize,
}

impl NullaryFnOnce for Transpose<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { simd, from, to, rows, columns } = self;
        for row in (0..rows).step_by(LANES) {
            for column in (0..columns).step_by(LANES) {
                let block = std::array::from_fn(|i| {
                    let mut line = [0.0; LANES];
                    line.copy_from_slice(&from[(row + i) * columns + column..][..LANES]);
                    line
                });
                for (i, line) in transposed(simd, block).iter().enumerate() {
                    to[(column + i) * rows + row..][..LANES].copy_from_slice(line);
                }
            }
        }
    }
}

/// Transposes eight by eight: within pairs of lines, then pairs of pairs, then the halves of the vectors.
#[inline(always)]
fn transposed(simd: V3, block: [[f32; LANES]; LANES]) -> [[f32; LANES]; LANES] {
    let avx = simd.avx;
    let lines: [__m256; LANES] = block.map(pulp::cast);
    let pairs: [[__m256; 2]; 4] = std::array::from_fn(|i| {
        let (a, b) = (lines[2 * i], lines[2 * i + 1]);
        [avx._mm256_unpacklo_ps(a, b), avx._mm256_unpackhi_ps(a, b)]
    });
    let fours: [[__m256; 4]; 2] = std::array::from_fn(|i| {
        let ([a_low, a_high], [b_low, b_high]) = (pairs[2 * i], pairs[2 * i + 1]);
        [
            avx._mm256_shuffle_ps::<0x44>(a_low, b_low),
            avx._mm256_shuffle_ps::<0xee>(a_low, b_low),
            avx._mm256_shuffle_ps::<0x44>(a_high, b_high),
            avx._mm256_shuffle_ps::<0xee>(a_high, b_high),
        ]
    });
    std::array::from_fn(|i| {
        let (a, b) = (fours[0][i % 4], fours[1][i % 4]);
        pulp::cast(if i < 4 {
            avx._mm256_permute2f128_ps::<0x20>(a, b)
        } else {
            avx._mm256_permute2f128_ps::<0x31>(a, b)
        })
    })
}
