//! Fourier transforms of small real tiles, eight channels at a time.
//!
//! A library transforms one contiguous signal at a time; here eight channels of a pixel lie side by side, and a
//! transform of [`Lanes`] does eight tiles in the time of one, without a single transposition. The sizes are the
//! powers of two 8, 16 and 32 (Stockham's self-sorting scheme in radix 4, with a last radix-2 step where needed);
//! `rustfft` is the oracle in the tests, and does the transforms of arbitrary length in the correlation stage.

#![expect(clippy::needless_range_loop, reason = "the index runs over several arrays at once, as in the formulas")]

use super::lanes::Lanes;
use super::real::Real;

/// Powers of e^(−2πi/N), the twiddle factors of size `N`.
#[derive(Clone, Copy, Debug)]
pub struct Twiddles<T, const N: usize> {
    /// Real parts.
    pub re: [T; N],
    /// Imaginary parts.
    pub im: [T; N],
}

impl<T: Real, const N: usize> Twiddles<T, N> {
    /// The table, rounded from double precision.
    #[must_use]
    pub fn new() -> Self {
        let angle = |k: usize| -std::f64::consts::TAU * k as f64 / N as f64;
        Self {
            re: std::array::from_fn(|k| T::rounded(libm::cos(angle(k)))),
            im: std::array::from_fn(|k| T::rounded(libm::sin(angle(k)))),
        }
    }
}

impl<T: Real, const N: usize> Default for Twiddles<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

/// A complex signal of `N` samples, each eight lanes wide.
#[derive(Clone, Copy, Debug)]
pub struct Signal<T, const N: usize> {
    /// Real parts.
    pub re: [Lanes<T>; N],
    /// Imaginary parts.
    pub im: [Lanes<T>; N],
}

impl<T: Real, const N: usize> Signal<T, N> {
    /// All zero.
    pub const ZERO: Self = Self { re: [Lanes::ZERO; N], im: [Lanes::ZERO; N] };
}

/// One radix-4 step of Stockham's scheme: sub-transforms of length `n`, interleaved with stride `s`.
#[inline(always)]
fn radix4<T: Real, const N: usize, const INVERSE: bool>(
    from: &Signal<T, N>,
    to: &mut Signal<T, N>,
    n: usize,
    s: usize,
    tw: &Twiddles<T, N>,
) {
    let quarter = n / 4;
    for p in 0..quarter {
        for q in 0..s {
            let at = |j: usize| q + s * (p + j * quarter);
            let (ar, ai) = (from.re[at(0)], from.im[at(0)]);
            let (br, bi) = (from.re[at(1)], from.im[at(1)]);
            let (cr, ci) = (from.re[at(2)], from.im[at(2)]);
            let (dr, di) = (from.re[at(3)], from.im[at(3)]);
            let (sum_r, sum_i) = (ar + cr, ai + ci);
            let (dif_r, dif_i) = (ar - cr, ai - ci);
            let (odd_r, odd_i) = (br + dr, bi + di);
            // ∓i (b − d): the sign turns with the direction.
            let (turn_r, turn_i) = if INVERSE { (di - bi, br - dr) } else { (bi - di, dr - br) };
            let to_at = |j: usize| q + s * (4 * p + j);
            to.re[to_at(0)] = sum_r + odd_r;
            to.im[to_at(0)] = sum_i + odd_i;
            let parts =
                [(dif_r + turn_r, dif_i + turn_i), (sum_r - odd_r, sum_i - odd_i), (dif_r - turn_r, dif_i - turn_i)];
            for (j, (re, im)) in parts.into_iter().enumerate() {
                let k = (j + 1) * p * s;
                if k == 0 {
                    to.re[to_at(j + 1)] = re;
                    to.im[to_at(j + 1)] = im;
                } else {
                    let (wr, wi) = (tw.re[k], if INVERSE { -tw.im[k] } else { tw.im[k] });
                    to.re[to_at(j + 1)] = re.scale(wr) - im.scale(wi);
                    to.im[to_at(j + 1)] = re.scale(wi) + im.scale(wr);
                }
            }
        }
    }
}

/// Complex transform in place, not normalised. `N` is 8, 16 or 32.
#[inline(always)]
pub fn fft<T: Real, const N: usize, const INVERSE: bool>(x: &mut Signal<T, N>, tw: &Twiddles<T, N>) {
    const { assert!(N == 8 || N == 16 || N == 32) };
    let mut y = Signal::<T, N>::ZERO;
    radix4::<T, N, INVERSE>(x, &mut y, N, 1, tw);
    if N == 16 {
        radix4::<T, N, INVERSE>(&y, x, N / 4, 4, tw);
        return;
    }
    let last = if N == 32 {
        radix4::<T, N, INVERSE>(&y, x, N / 4, 4, tw);
        &*x
    } else {
        &y
    };
    // What is left are N / 2 transforms of length 2.
    let half = N / 2;
    let mut out = Signal::<T, N>::ZERO;
    for q in 0..half {
        out.re[q] = last.re[q] + last.re[q + half];
        out.im[q] = last.im[q] + last.im[q + half];
        out.re[q + half] = last.re[q] - last.re[q + half];
        out.im[q + half] = last.im[q] - last.im[q + half];
    }
    *x = out;
}

/// Half spectrum of a real `N × N` tile: column `kx` (0 … N/2) holds the frequencies `ky` 0 … N−1.
/// Columns beyond N/2 are only there because a constant expression can't size the array.
pub type HalfSpectrum<T, const N: usize> = [Signal<T, N>];

/// Forward transform of a real tile (`N × N`, row-major). The result is **twice** the Fourier transform: the halving
/// that separates two rows transformed as one is left to whoever scales anyway.
#[inline(always)]
pub fn forward<T: Real, const N: usize>(tile: &[Lanes<T>], spectrum: &mut HalfSpectrum<T, N>, tw: &Twiddles<T, N>) {
    let mut z = Signal::<T, N>::ZERO;
    for (pair, rows) in tile.chunks_exact(2 * N).enumerate() {
        let (a, b) = (2 * pair, 2 * pair + 1);
        z.re.copy_from_slice(&rows[..N]);
        z.im.copy_from_slice(&rows[N..]);
        fft::<T, N, false>(&mut z, tw);
        for k in 0..=N / 2 {
            let mirror = (N - k) % N;
            let column = &mut spectrum[k];
            column.re[a] = z.re[k] + z.re[mirror];
            column.im[a] = z.im[k] - z.im[mirror];
            column.re[b] = z.im[k] + z.im[mirror];
            column.im[b] = z.re[mirror] - z.re[k];
        }
    }
    for column in &mut spectrum[..=N / 2] {
        fft::<T, N, false>(column, tw);
    }
}

/// Inverse transform to a real tile (`N × N`, row-major), not normalised (N² times the inverse). Only the rows
/// `first_row …` up to but not including `end_row` are made, rounded outwards to pairs. `spectrum` is used up.
#[inline(always)]
pub fn inverse<T: Real, const N: usize>(
    spectrum: &mut HalfSpectrum<T, N>,
    tile: &mut [Lanes<T>],
    first_row: usize,
    end_row: usize,
    tw: &Twiddles<T, N>,
) {
    for column in &mut spectrum[..=N / 2] {
        fft::<T, N, true>(column, tw);
    }
    let mut z = Signal::<T, N>::ZERO;
    for pair in first_row / 2..end_row.div_ceil(2) {
        let (a, b) = (2 * pair, 2 * pair + 1);
        for k in 0..=N / 2 {
            let column = &spectrum[k];
            z.re[k] = column.re[a] - column.im[b];
            z.im[k] = column.im[a] + column.re[b];
            if k > 0 && k < N / 2 {
                z.re[N - k] = column.re[a] + column.im[b];
                z.im[N - k] = column.re[b] - column.im[a];
            }
        }
        fft::<T, N, true>(&mut z, tw);
        tile[a * N..(a + 1) * N].copy_from_slice(&z.re);
        tile[b * N..(b + 1) * N].copy_from_slice(&z.im);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Purpose, Rng};
    use rustfft::FftPlanner;
    use rustfft::num_complex::Complex;

    fn random_tile<const N: usize>() -> Vec<Lanes<f64>> {
        let mut rng = Rng::new(3, Purpose::Gallery);
        (0..N * N).map(|_| Lanes(std::array::from_fn(|_| rng.range(-1.0, 1.0)))).collect()
    }

    fn against_rustfft<const N: usize>() {
        let tile = random_tile::<N>();
        let mut spectrum = vec![Signal::<f64, N>::ZERO; N];
        let tw = Twiddles::new();
        forward::<f64, N>(&tile, &mut spectrum, &tw);
        let plan = FftPlanner::new().plan_fft_forward(N);
        for lane in 0..8 {
            let mut rows: Vec<Complex<f64>> = tile.iter().map(|v| Complex::new(v.0[lane], 0.0)).collect();
            plan.process(&mut rows);
            for kx in 0..=N / 2 {
                let mut column: Vec<_> = (0..N).map(|y| rows[y * N + kx]).collect();
                plan.process(&mut column);
                for ky in 0..N {
                    let ours = Complex::new(spectrum[kx].re[ky].0[lane], spectrum[kx].im[ky].0[lane]);
                    assert!((ours - column[ky] * 2.0).norm() < 1e-11, "N {N} ky {ky} kx {kx}: {ours} {}", column[ky]);
                }
            }
        }
        let mut back = vec![Lanes::ZERO; N * N];
        inverse::<f64, N>(&mut spectrum, &mut back, 0, N, &tw);
        for (a, b) in tile.iter().zip(&back) {
            for lane in 0..8 {
                assert!((a.0[lane] * 2.0 * (N * N) as f64 - b.0[lane]).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn tiles_of_every_size_match_rustfft_and_come_back() {
        against_rustfft::<8>();
        against_rustfft::<16>();
        against_rustfft::<32>();
    }
}
