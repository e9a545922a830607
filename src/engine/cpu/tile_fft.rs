//! Fourier transforms of small real tiles, eight channels at a time.
//!
//! A library transforms one contiguous signal at a time; here eight channels of a pixel lie side by side, and a
//! transform of [`Lanes`] does eight tiles in the time of one, without a single transposition. The sizes are the
//! powers of two 8, 16 and 32 (Stockham's self-sorting scheme in radix 4, with a last radix-2 step where needed);
//! `rustfft` is the oracle in the tests, and does the transforms of arbitrary length in the correlation stage.

#![expect(clippy::needless_range_loop, reason = "the index runs over several arrays at once, as in the formulas")]

use std::hint::black_box;

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

/// A bound that the compiler can't see, so that a loop stays one, where that is faster: for sixteen samples it unrolls
/// all of them and takes the vectors apart, which is three times slower. For 32 it leaves the loops alone, and eight
/// samples fit in the registers. In wasm it makes no difference but bytes.
#[inline(always)]
fn opaque<const N: usize>(bound: usize) -> usize {
    if cfg!(target_arch = "x86_64") && N == 16 { black_box(bound) } else { bound }
}

/// One radix-4 step of Stockham's scheme: sub-transforms of length 4 · `QUARTER`, interleaved with stride `S`.
#[inline(always)]
fn radix4<T: Real, const N: usize, const QUARTER: usize, const S: usize, const INVERSE: bool>(
    from: &Signal<T, N>,
    to: &mut Signal<T, N>,
    tw: &Twiddles<T, N>,
) {
    const { assert!(4 * QUARTER * S == N) };
    for p in 0..opaque::<N>(QUARTER) {
        let w: [(T, T); 3] = std::array::from_fn(|j| {
            let k = ((j + 1) * p * S) % N;
            (tw.re[k], if INVERSE { -tw.im[k] } else { tw.im[k] })
        });
        for q in 0..opaque::<N>(S) {
            let at: [usize; 4] = std::array::from_fn(|j| (q + S * (p + j * QUARTER)) % N);
            let to_at: [usize; 4] = std::array::from_fn(|j| (q + S * (4 * p + j)) % N);
            let (ar, ai) = (from.re[at[0]], from.im[at[0]]);
            let (br, bi) = (from.re[at[1]], from.im[at[1]]);
            let (cr, ci) = (from.re[at[2]], from.im[at[2]]);
            let (dr, di) = (from.re[at[3]], from.im[at[3]]);
            let (sum_r, sum_i) = (ar + cr, ai + ci);
            let (dif_r, dif_i) = (ar - cr, ai - ci);
            let (odd_r, odd_i) = (br + dr, bi + di);
            // ∓i (b − d): the sign turns with the direction.
            let (turn_r, turn_i) = if INVERSE { (di - bi, br - dr) } else { (bi - di, dr - br) };
            to.re[to_at[0]] = sum_r + odd_r;
            to.im[to_at[0]] = sum_i + odd_i;
            let parts =
                [(dif_r + turn_r, dif_i + turn_i), (sum_r - odd_r, sum_i - odd_i), (dif_r - turn_r, dif_i - turn_i)];
            for j in 0..3 {
                let (re, im) = parts[j];
                // The first sub-transform's factors are all 1.
                let (re, im) = if p == 0 {
                    (re, im)
                } else {
                    (re.scale(w[j].0) - im.scale(w[j].1), re.scale(w[j].1) + im.scale(w[j].0))
                };
                to.re[to_at[j + 1]] = re;
                to.im[to_at[j + 1]] = im;
            }
        }
    }
}

/// What is left at the end: N / 2 transforms of length 2, from `from`.
#[inline(always)]
fn radix2<T: Real, const N: usize>(from: &Signal<T, N>, to: &mut Signal<T, N>) {
    for q in 0..N / 2 {
        let (a, b) = (q, q + N / 2);
        to.re[a] = from.re[a] + from.re[b];
        to.im[a] = from.im[a] + from.im[b];
        to.re[b] = from.re[a] - from.re[b];
        to.im[b] = from.im[a] - from.im[b];
    }
}

/// The same in place.
#[inline(always)]
fn radix2_in_place<T: Real, const N: usize>(x: &mut Signal<T, N>) {
    for q in 0..N / 2 {
        let (a, b) = (q, q + N / 2);
        (x.re[a], x.re[b]) = (x.re[a] + x.re[b], x.re[a] - x.re[b]);
        (x.im[a], x.im[b]) = (x.im[a] + x.im[b], x.im[a] - x.im[b]);
    }
}

/// A signal of one of the three sizes.
pub trait Transform<T, const N: usize> {
    /// Complex transform in place, not normalised; `scratch` is overwritten.
    fn transform<const INVERSE: bool>(&mut self, scratch: &mut Self, tw: &Twiddles<T, N>);
}

impl<T: Real> Transform<T, 8> for Signal<T, 8> {
    #[inline(always)]
    fn transform<const INVERSE: bool>(&mut self, scratch: &mut Self, tw: &Twiddles<T, 8>) {
        radix4::<T, 8, 2, 1, INVERSE>(self, scratch, tw);
        radix2(scratch, self);
    }
}

impl<T: Real> Transform<T, 16> for Signal<T, 16> {
    #[inline(always)]
    fn transform<const INVERSE: bool>(&mut self, scratch: &mut Self, tw: &Twiddles<T, 16>) {
        radix4::<T, 16, 4, 1, INVERSE>(self, scratch, tw);
        radix4::<T, 16, 1, 4, INVERSE>(scratch, self, tw);
    }
}

impl<T: Real> Transform<T, 32> for Signal<T, 32> {
    #[inline(always)]
    fn transform<const INVERSE: bool>(&mut self, scratch: &mut Self, tw: &Twiddles<T, 32>) {
        radix4::<T, 32, 8, 1, INVERSE>(self, scratch, tw);
        radix4::<T, 32, 2, 4, INVERSE>(scratch, self, tw);
        radix2_in_place(self);
    }
}

/// Half spectrum of a real `N × N` tile: column `kx` (0 … N/2) holds the frequencies `ky` 0 … N−1.
/// Columns beyond N/2 are only there because a constant expression can't size the array.
pub type HalfSpectrum<T, const N: usize> = [Signal<T, N>];

/// Forward transform of a real tile (`N × N`, row-major). The result is **twice** the Fourier transform: the halving
/// that separates two rows transformed as one is left to whoever scales anyway.
#[inline(always)]
pub fn forward<T: Real, const N: usize>(tile: &[Lanes<T>], spectrum: &mut HalfSpectrum<T, N>, tw: &Twiddles<T, N>)
where
    Signal<T, N>: Transform<T, N>,
{
    let mut scratch = Signal::<T, N>::ZERO;
    let mut z = Signal::<T, N>::ZERO;
    for (pair, rows) in tile.chunks_exact(2 * N).enumerate() {
        let (a, b) = (2 * pair, 2 * pair + 1);
        z.re.copy_from_slice(&rows[..N]);
        z.im.copy_from_slice(&rows[N..]);
        z.transform::<false>(&mut scratch, tw);
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
        column.transform::<false>(&mut scratch, tw);
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
) where
    Signal<T, N>: Transform<T, N>,
{
    let mut scratch = Signal::<T, N>::ZERO;
    for column in &mut spectrum[..=N / 2] {
        column.transform::<true>(&mut scratch, tw);
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
        z.transform::<true>(&mut scratch, tw);
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

    fn against_rustfft<const N: usize>()
    where
        Signal<f64, N>: Transform<f64, N>,
    {
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
