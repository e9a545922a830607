//! Deep correlation: the autocorrelation of every channel of the last layer, its loss and its gradient.
//!
//! `R(τ) = Σ_x F(x) F(x + τ) / n(τ)` for the central lags τ, where n(τ) is the number of pixel pairs at that lag: the
//! overlap `(H − |τy|)(W − |τx|)` in an open domain, `H · W` in a periodic one (Huang et al. 2022, §4.3, after
//! Sendik & Cohen-Or 2017). The loss is the mean over channels and lags of `(R̃ − R)²`.
//!
//! By Wiener–Khinchin R is the inverse transform of |F̂|². With `D(τ) = dL/dR(τ) / n(τ)` the gradient is
//! `dL/dF(x) = Σ_τ D(τ) (F(x + τ) + F(x − τ))`, whose transform is `2 Re(D̂) · F̂`: both factors of the
//! autocorrelation get their share.

use std::sync::Arc;

use rustfft::algorithm::butterflies::{Butterfly4, Butterfly5, Butterfly6, Butterfly8, Butterfly9, Butterfly12};
use rustfft::algorithm::{BluesteinsAlgorithm, Radix4};
use rustfft::num_complex::Complex;
use rustfft::{Direction, Fft, FftDirection, Length};

use crate::engine::view::{Lags, Region};
use crate::pattern::Boundary;

use super::normalization::Statistics;
use super::real::Real;
use super::scratch::Scratch;
use crate::parallel::{for_each_chunk, for_each_chunk_pair};

/// A transform that starts from one of rustfft's butterflies.
type Base<T> = fn(FftDirection) -> Arc<dyn Fft<T>>;

/// The butterflies in use: times powers of four they give lengths at most a third apart.
///
/// Naming them, rather than asking rustfft's planner, keeps the planner's whole stock of algorithms out of the wasm
/// (half a megabyte) and makes the transforms the same bits on every machine; the correlation takes a few percent of
/// an iteration either way.
fn bases<T: Real>() -> [(usize, Base<T>); 6] {
    [
        (4, |direction| Arc::new(InPlace(Butterfly4::new(direction)))),
        (5, |direction| Arc::new(InPlace(Butterfly5::new(direction)))),
        (6, |direction| Arc::new(InPlace(Butterfly6::new(direction)))),
        (8, |direction| Arc::new(InPlace(Butterfly8::new(direction)))),
        (9, |direction| Arc::new(InPlace(Butterfly9::new(direction)))),
        (12, |direction| Arc::new(InPlace(Butterfly12::new(direction)))),
    ]
}

/// A butterfly in place, all that [`Radix4`] asks of it. rustfft writes every butterfly three times, and what may be
/// called is kept: the copying variants would be 34 kB of the wasm that nobody calls.
struct InPlace<F>(F);

impl<F: Length> Length for InPlace<F> {
    fn len(&self) -> usize {
        self.0.len()
    }
}

impl<F: Direction> Direction for InPlace<F> {
    fn fft_direction(&self) -> FftDirection {
        self.0.fft_direction()
    }
}

impl<T: Real, F: Fft<T>> Fft<T> for InPlace<F> {
    fn process_with_scratch(&self, buffer: &mut [Complex<T>], scratch: &mut [Complex<T>]) {
        self.0.process_with_scratch(buffer, scratch);
    }

    fn process_outofplace_with_scratch(
        &self,
        input: &mut [Complex<T>],
        output: &mut [Complex<T>],
        scratch: &mut [Complex<T>],
    ) {
        self.process_immutable_with_scratch(input, output, scratch);
    }

    fn process_immutable_with_scratch(
        &self,
        input: &[Complex<T>],
        output: &mut [Complex<T>],
        scratch: &mut [Complex<T>],
    ) {
        output.copy_from_slice(input);
        self.0.process_with_scratch(output, scratch);
    }

    fn get_inplace_scratch_len(&self) -> usize {
        self.0.get_inplace_scratch_len()
    }

    fn get_outofplace_scratch_len(&self) -> usize {
        self.0.get_inplace_scratch_len()
    }

    fn get_immutable_scratch_len(&self) -> usize {
        self.0.get_inplace_scratch_len()
    }
}

/// The exponent k with `len = base · 4ᵏ`, if there is one.
fn power_of_four(len: usize, base: usize) -> Option<u32> {
    (0..16).find(|&k| base << (2 * k) == len)
}

/// The least length ≥ `n` that [`bases`] makes directly.
fn fast_length(n: usize) -> usize {
    let fits = |len: usize| bases::<f32>().iter().any(|&(base, _)| power_of_four(len, base).is_some());
    (n..).find(|&len| fits(len)).unwrap_or(n)
}

/// A transform of any length.
fn plan<T: Real>(len: usize, direction: FftDirection) -> Arc<dyn Fft<T>> {
    for (base, make) in bases::<T>() {
        if let Some(k) = power_of_four(len, base) {
            return Arc::new(Radix4::new_with_base(k, make(direction)));
        }
    }
    Arc::new(BluesteinsAlgorithm::new(len, plan(fast_length(2 * len), direction)))
}

/// Two-dimensional transforms of one size. Two real channels go through as the real and the imaginary part of one.
struct Plane<T: Real> {
    rows: usize,
    columns: usize,
    /// Along a row, along a column: forward, then inverse.
    along_row: [Arc<dyn Fft<T>>; 2],
    along_column: [Arc<dyn Fft<T>>; 2],
}

impl<T: Real> std::fmt::Debug for Plane<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Plane({} × {})", self.rows, self.columns)
    }
}

impl<T: Real> Plane<T> {
    fn new(rows: usize, columns: usize) -> Self {
        let both = |len| [plan(len, FftDirection::Forward), plan(len, FftDirection::Inverse)];
        Self { rows, columns, along_row: both(columns), along_column: both(rows) }
    }

    fn len(&self) -> usize {
        self.rows * self.columns
    }

    /// Complex numbers the transforms need beside their data.
    fn scratch_len(&self) -> usize {
        self.along_row.iter().chain(&self.along_column).map(|fft| fft.get_inplace_scratch_len()).max().unwrap_or(0)
    }

    /// Forward: `plane` `[rows, columns]` (used up) to `spectrum` `[columns, rows]`. Rows for which `holds` is false
    /// are taken to be zero.
    fn forward(
        &self,
        plane: &mut [Complex<T>],
        spectrum: &mut [Complex<T>],
        scratch: &mut [Complex<T>],
        holds: impl Fn(usize) -> bool,
    ) {
        for (y, row) in plane.chunks_exact_mut(self.columns).enumerate() {
            if holds(y) {
                self.along_row[0].process_with_scratch(row, scratch);
                for (x, value) in row.iter().enumerate() {
                    spectrum[x * self.rows + y] = *value;
                }
            } else {
                for x in 0..self.columns {
                    spectrum[x * self.rows + y] = Complex::default();
                }
            }
        }
        self.along_column[0].process_with_scratch(spectrum, scratch);
    }

    /// Inverse, not normalised: `spectrum` (used up) to those rows of `plane` for which `wanted` is true.
    fn inverse(
        &self,
        spectrum: &mut [Complex<T>],
        plane: &mut [Complex<T>],
        scratch: &mut [Complex<T>],
        wanted: impl Fn(usize) -> bool,
    ) {
        self.along_column[1].process_with_scratch(spectrum, scratch);
        for (y, row) in plane.chunks_exact_mut(self.columns).enumerate().filter(|(y, _)| wanted(*y)) {
            for (x, value) in row.iter_mut().enumerate() {
                *value = spectrum[x * self.rows + y];
            }
            self.along_row[1].process_with_scratch(row, scratch);
        }
    }

    /// Calls `visit(index, a, b)` for every frequency with the transforms of the two real signals whose joint
    /// transform is `spectrum`: `a = (z(k) + z̄(−k)) / 2`, `b = (z(k) − z̄(−k)) / 2i`.
    fn split(&self, spectrum: &[Complex<T>], mut visit: impl FnMut(usize, Complex<T>, Complex<T>)) {
        let half = T::rounded(0.5);
        for x in 0..self.columns {
            let mirrored = (self.columns - x) % self.columns * self.rows;
            for y in 0..self.rows {
                let index = x * self.rows + y;
                let (z, m) = (spectrum[index], spectrum[mirrored + (self.rows - y) % self.rows].conj());
                let (sum, difference) = ((z + m).scale(half), (z - m).scale(half));
                visit(index, sum, Complex::new(difference.im, -difference.re));
            }
        }
    }
}

/// The autocorrelations of one layer and the space to make them.
#[derive(Debug)]
pub struct Correlation<T: Real> {
    plane: Plane<T>,
    lags: Lags,
    region: Region,
    boundary: Boundary,
    real_channels: usize,
    /// Joint spectra of two channels each, `[pairs, columns, rows]`.
    spectra: Vec<Complex<T>>,
    /// `[channels, lag rows, lag columns]`.
    values: Vec<T>,
    /// `[channels, region height, region width]`.
    gradients: Vec<T>,
    losses: Vec<f64>,
    /// Two planes and what the transforms need, for each thread.
    scratch: Scratch<Complex<T>>,
}

fn plane_size(region: Region, lags: Lags, boundary: Boundary) -> (usize, usize) {
    match boundary {
        // Room for the largest lag, so that nothing wraps around into it.
        Boundary::Open => {
            (fast_length(region.height() + lags.rows / 2), fast_length(region.width() + lags.columns / 2))
        }
        Boundary::Periodic => (region.height(), region.width()),
    }
}

impl<T: Real> Correlation<T> {
    /// Space for the pixels of `region` of a layer with `real_channels` channels.
    #[must_use]
    pub fn new(region: Region, lags: Lags, boundary: Boundary, real_channels: usize) -> Self {
        let (rows, columns) = plane_size(region, lags, boundary);
        let plane = Plane::new(rows, columns);
        Self {
            lags,
            region,
            boundary,
            real_channels,
            spectra: vec![Complex::default(); real_channels.div_ceil(2) * plane.len()],
            values: vec![T::ZERO; real_channels * lags.count()],
            gradients: vec![T::ZERO; real_channels * region.pixels()],
            losses: vec![0.0; real_channels],
            scratch: Scratch::new(2 * plane.len() + plane.scratch_len()),
            plane,
        }
    }

    /// Bytes that [`Self::new`] allocates, to within a few lines.
    #[must_use]
    pub fn bytes_for(region: Region, lags: Lags, boundary: Boundary, real_channels: usize) -> usize {
        let (rows, columns) = plane_size(region, lags, boundary);
        let complex = 2 * rows * columns;
        let shared = real_channels.div_ceil(2) * complex + real_channels * (lags.count() + region.pixels());
        // A transform along a column of Bluestein's kind needs a few columns more.
        let own = (crate::parallel::threads() + 1) * (2 * complex + 8 * rows.max(columns));
        (shared + own) * size_of::<T>()
    }

    /// The autocorrelations last made, `[channels, lag rows, lag columns]`.
    #[must_use]
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// Where the lag of row `i` and column `j` lies in a plane, and the number of pixel pairs at that lag.
    fn lag(&self, i: usize, j: usize) -> (usize, f64) {
        let wrap = |index: usize, count: usize, len: usize| {
            let lag = index as isize - (count / 2) as isize;
            (lag.unsigned_abs(), lag.rem_euclid(len as isize) as usize)
        };
        let (dy, y) = wrap(i, self.lags.rows, self.plane.rows);
        let (dx, x) = wrap(j, self.lags.columns, self.plane.columns);
        let pairs = match self.boundary {
            Boundary::Open => (self.region.height() - dy) * (self.region.width() - dx),
            Boundary::Periodic => self.region.pixels(),
        };
        (y * self.plane.columns + x, pairs as f64)
    }

    /// Whether a row of a plane holds a lag.
    fn holds_lag(&self, row: usize) -> bool {
        let before = self.lags.rows / 2;
        row < self.lags.rows - before || row >= self.plane.rows - before
    }

    /// Measures an image `[height, width, channels]` before normalisation.
    pub fn measure(&mut self, image: &[T], width: usize, statistics: &Statistics<T>) {
        let channels = statistics.mean.len();
        let (len, count) = (self.plane.len(), self.lags.count());
        let mut spectra = std::mem::take(&mut self.spectra);
        let mut values = std::mem::take(&mut self.values);
        for_each_chunk_pair(&mut spectra, len, &mut values, 2 * count, |pair, spectrum, values| {
            let first = 2 * pair;
            let mut scratch = self.scratch.mine();
            let (plane, rest) = scratch.split_at_mut(len);
            let (power, scratch) = rest.split_at_mut(len);
            plane.fill(Complex::default());
            let activation = |pixel: usize, channel: usize| {
                let mean = statistics.mean[channel];
                let value = (image[pixel * channels + channel] - mean) * statistics.inverse_deviation[channel];
                if value > T::ZERO { value } else { T::ZERO }
            };
            let paired = first + 1 < self.real_channels;
            for y in 0..self.region.height() {
                for x in 0..self.region.width() {
                    let pixel = (self.region.y0 + y) * width + self.region.x0 + x;
                    let second = if paired { activation(pixel, first + 1) } else { T::ZERO };
                    plane[y * self.plane.columns + x] = Complex::new(activation(pixel, first), second);
                }
            }
            self.plane.forward(plane, spectrum, scratch, |row| row < self.region.height());
            self.plane.split(spectrum, |index, a, b| power[index] = Complex::new(a.norm_sqr(), b.norm_sqr()));
            self.plane.inverse(power, plane, scratch, |row| self.holds_lag(row));
            let scale = 1.0 / len as f64;
            for i in 0..self.lags.rows {
                for j in 0..self.lags.columns {
                    let (at, pairs) = self.lag(i, j);
                    let scale = T::rounded(scale / pairs);
                    let index = i * self.lags.columns + j;
                    values[index] = plane[at].re * scale;
                    if paired {
                        values[count + index] = plane[at].im * scale;
                    }
                }
            }
        });
        self.spectra = spectra;
        self.values = values;
    }

    /// The loss against target autocorrelations of the same lags; also prepares [`Self::add_gradient`].
    pub fn loss(&mut self, target: &[T], weight: f64) -> f64 {
        let (len, count, pixels) = (self.plane.len(), self.lags.count(), self.region.pixels());
        let mean = weight / (self.real_channels * count) as f64;
        let mut gradients = std::mem::take(&mut self.gradients);
        let mut losses = std::mem::take(&mut self.losses);
        for_each_chunk_pair(&mut gradients, 2 * pixels, &mut losses, 2, |pair, gradient, losses| {
            let mut scratch = self.scratch.mine();
            let (plane, rest) = scratch.split_at_mut(len);
            let (slopes, scratch) = rest.split_at_mut(len);
            plane.fill(Complex::default());
            for (which, loss) in losses.iter_mut().enumerate() {
                let lags = (2 * pair + which) * count..(2 * pair + which + 1) * count;
                let (values, target) = (&self.values[lags.clone()], &target[lags]);
                let mut sum = 0.0;
                for i in 0..self.lags.rows {
                    for j in 0..self.lags.columns {
                        let index = i * self.lags.columns + j;
                        let difference = (values[index] - target[index]).wide();
                        sum += difference * difference;
                        let (at, pairs) = self.lag(i, j);
                        let slope = T::rounded(2.0 * mean * difference / pairs);
                        if which == 0 {
                            plane[at].re += slope;
                        } else {
                            plane[at].im += slope;
                        }
                    }
                }
                *loss = mean * sum;
            }
            self.plane.forward(plane, slopes, scratch, |row| self.holds_lag(row));
            // Both slopes are real signals; only the real parts of their transforms count. `plane` keeps them.
            let scale = T::rounded(2.0 / len as f64);
            self.plane.split(slopes, |index, a, b| plane[index] = Complex::new(a.re * scale, b.re * scale));
            let spectrum = &self.spectra[pair * len..(pair + 1) * len];
            self.plane.split(spectrum, |index, a, b| {
                let (a, b) = (a.scale(plane[index].re), b.scale(plane[index].im));
                slopes[index] = Complex::new(a.re - b.im, a.im + b.re);
            });
            self.plane.inverse(slopes, plane, scratch, |row| row < self.region.height());
            for (which, gradient) in gradient.chunks_exact_mut(pixels).enumerate() {
                for (y, row) in gradient.chunks_exact_mut(self.region.width()).enumerate() {
                    for (value, from) in row.iter_mut().zip(&plane[y * self.plane.columns..]) {
                        *value = if which == 0 { from.re } else { from.im };
                    }
                }
            }
        });
        self.gradients = gradients;
        let sum = losses.iter().sum();
        self.losses = losses;
        sum
    }

    /// Adds dL/dF to `gradient` `[height, width, channels]`. The region must be the whole image.
    pub fn add_gradient(&self, gradient: &mut [T], channels: usize) {
        let width = self.region.width();
        let pixels = self.region.pixels();
        for_each_chunk(gradient, width * channels, |row, line| {
            for (x, pixel) in line.chunks_exact_mut(channels).enumerate() {
                for (channel, value) in pixel.iter_mut().take(self.real_channels).enumerate() {
                    *value += self.gradients[channel * pixels + row * width + x];
                }
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transforms_of_any_length_match_the_definition() {
        for len in [2, 3, 7, 10, 16, 20, 29, 36, 80, 96, 97] {
            let signal: Vec<Complex<f64>> =
                (0..len).map(|i| Complex::new((i * i % 7) as f64 - 2.0, (i % 5) as f64)).collect();
            for (direction, sign) in [(FftDirection::Forward, -1.0), (FftDirection::Inverse, 1.0)] {
                let mut ours = signal.clone();
                plan::<f64>(len, direction).process(&mut ours);
                for (k, value) in ours.iter().enumerate() {
                    let sum: Complex<f64> = signal
                        .iter()
                        .enumerate()
                        .map(|(i, v)| {
                            v * Complex::from_polar(1.0, sign * std::f64::consts::TAU * (i * k) as f64 / len as f64)
                        })
                        .sum();
                    assert!((value - sum).norm() < 1e-9, "length {len}, {k}: {value} {sum}");
                }
            }
        }
    }
}
