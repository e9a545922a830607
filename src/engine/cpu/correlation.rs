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

use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

use crate::domain::Boundary;

use super::normalization::{Region, Statistics};
use super::parallel::{for_each_chunk, for_each_chunk_pair};
use super::real::Real;
use super::scratch::Scratch;

/// The least number ≥ `n` without prime factors above 5, which transforms fast. Even, as real transforms like it.
fn fast_length(n: usize) -> usize {
    let smooth = |mut m: usize| {
        for factor in [2, 3, 5] {
            while m.is_multiple_of(factor) {
                m /= factor;
            }
        }
        m == 1
    };
    let mut m = n.max(2).next_multiple_of(2);
    while !smooth(m) {
        m += 2;
    }
    m
}

/// Two-dimensional real transforms of one size.
struct Plane<T: Real> {
    rows: usize,
    columns: usize,
    forward_rows: Arc<dyn RealToComplex<T>>,
    inverse_rows: Arc<dyn ComplexToReal<T>>,
    forward_columns: Arc<dyn Fft<T>>,
    inverse_columns: Arc<dyn Fft<T>>,
}

impl<T: Real> std::fmt::Debug for Plane<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Plane({} × {})", self.rows, self.columns)
    }
}

impl<T: Real> Plane<T> {
    fn new(rows: usize, columns: usize) -> Self {
        let mut real = RealFftPlanner::new();
        let mut complex = FftPlanner::new();
        Self {
            rows,
            columns,
            forward_rows: real.plan_fft_forward(columns),
            inverse_rows: real.plan_fft_inverse(columns),
            forward_columns: complex.plan_fft_forward(rows),
            inverse_columns: complex.plan_fft_inverse(rows),
        }
    }

    /// Columns of the half spectrum.
    fn half(&self) -> usize {
        self.columns / 2 + 1
    }

    /// Complex numbers the transforms need beside their data.
    fn scratch_len(&self) -> usize {
        [
            self.forward_rows.get_scratch_len(),
            self.inverse_rows.get_scratch_len(),
            self.forward_columns.get_inplace_scratch_len(),
            self.inverse_columns.get_inplace_scratch_len(),
        ]
        .into_iter()
        .max()
        .unwrap_or(0)
    }

    /// Forward: `plane` `[rows, columns]` (used up) to `spectrum` `[half columns, rows]`.
    /// `line` has one row of the half spectrum.
    fn forward(
        &self,
        plane: &mut [T],
        spectrum: &mut [Complex<T>],
        line: &mut [Complex<T>],
        scratch: &mut [Complex<T>],
    ) {
        let line = &mut line[..self.half()];
        for (y, row) in plane.chunks_exact_mut(self.columns).enumerate() {
            let scratch = &mut scratch[..self.forward_rows.get_scratch_len()];
            let done = self.forward_rows.process_with_scratch(row, line, scratch);
            debug_assert!(done.is_ok(), "the lengths are the plan's own");
            for (x, value) in line.iter().enumerate() {
                spectrum[x * self.rows + y] = *value;
            }
        }
        self.forward_columns.process_with_scratch(spectrum, scratch);
    }

    /// Inverse, not normalised: `spectrum` (used up) to `plane`.
    fn inverse(
        &self,
        spectrum: &mut [Complex<T>],
        plane: &mut [T],
        line: &mut [Complex<T>],
        scratch: &mut [Complex<T>],
    ) {
        self.inverse_columns.process_with_scratch(spectrum, scratch);
        let line = &mut line[..self.half()];
        for (y, row) in plane.chunks_exact_mut(self.columns).enumerate() {
            for (x, value) in line.iter_mut().enumerate() {
                *value = spectrum[x * self.rows + y];
            }
            // These two are real up to rounding; the transform insists on exactly.
            line[0].im = T::ZERO;
            if self.columns.is_multiple_of(2) {
                line[self.half() - 1].im = T::ZERO;
            }
            let scratch = &mut scratch[..self.inverse_rows.get_scratch_len()];
            let done = self.inverse_rows.process_with_scratch(line, row, scratch);
            debug_assert!(done.is_ok(), "the lengths are the plan's own");
        }
    }
}

/// Central lags of an autocorrelation: rows and columns of lags, `−q/2 … q − q/2 − 1` each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lags {
    /// Vertical lags.
    pub rows: usize,
    /// Horizontal lags.
    pub columns: usize,
}

impl Lags {
    /// How many lags.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.rows * self.columns
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
    /// `[channels, half columns, rows]`.
    spectra: Vec<Complex<T>>,
    /// `[channels, lag rows, lag columns]`.
    values: Vec<T>,
    /// `[channels, region height, region width]`.
    gradients: Vec<T>,
    losses: Vec<f64>,
    planes: Scratch<T>,
    lines: Scratch<Complex<T>>,
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
        let half = plane.half();
        Self {
            lags,
            region,
            boundary,
            real_channels,
            spectra: vec![Complex::default(); real_channels * half * rows],
            values: vec![T::ZERO; real_channels * lags.count()],
            gradients: vec![T::ZERO; real_channels * region.pixels()],
            losses: vec![0.0; real_channels],
            planes: Scratch::new(rows * columns),
            lines: Scratch::new(half * rows + half + plane.scratch_len()),
            plane,
        }
    }

    /// Bytes that [`Self::new`] allocates, to within a few lines.
    #[must_use]
    pub fn bytes_for(region: Region, lags: Lags, boundary: Boundary, real_channels: usize) -> usize {
        let (rows, columns) = plane_size(region, lags, boundary);
        let spectrum = 2 * rows * (columns / 2 + 1);
        let shared = real_channels * (spectrum + lags.count() + region.pixels());
        let own = (super::parallel::threads() + 1) * (rows * columns + 2 * spectrum);
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

    /// Measures an image `[height, width, channels]` before normalisation.
    pub fn measure(&mut self, image: &[T], width: usize, statistics: &Statistics<T>) {
        let channels = statistics.mean.len();
        let (rows, half) = (self.plane.rows, self.plane.half());
        let mut spectra = std::mem::take(&mut self.spectra);
        let mut values = std::mem::take(&mut self.values);
        for_each_chunk_pair(&mut spectra, rows * half, &mut values, self.lags.count(), |channel, spectrum, values| {
            let (mean, inverse) = (statistics.mean[channel], statistics.inverse_deviation[channel]);
            let mut plane = self.planes.mine();
            let plane = &mut plane[..rows * self.plane.columns];
            plane.fill(T::ZERO);
            for y in 0..self.region.height() {
                for x in 0..self.region.width() {
                    let at = (self.region.y0 + y) * width + self.region.x0 + x;
                    let normalized = (image[at * channels + channel] - mean) * inverse;
                    if normalized > T::ZERO {
                        plane[y * self.plane.columns + x] = normalized;
                    }
                }
            }
            let mut lines = self.lines.mine();
            let (power, rest) = lines.split_at_mut(half * rows);
            let (line, scratch) = rest.split_at_mut(half);
            self.plane.forward(plane, spectrum, line, scratch);
            for (power, value) in power.iter_mut().zip(&*spectrum) {
                *power = Complex::new(value.norm_sqr(), T::ZERO);
            }
            self.plane.inverse(power, plane, line, scratch);
            let scale = 1.0 / (rows * self.plane.columns) as f64;
            for i in 0..self.lags.rows {
                for j in 0..self.lags.columns {
                    let (at, pairs) = self.lag(i, j);
                    values[i * self.lags.columns + j] = plane[at] * T::rounded(scale / pairs);
                }
            }
        });
        self.spectra = spectra;
        self.values = values;
    }

    /// The loss against target autocorrelations of the same lags; also prepares [`Self::add_gradient`].
    pub fn loss(&mut self, target: &[T], weight: f64) -> f64 {
        let (rows, half) = (self.plane.rows, self.plane.half());
        let count = self.lags.count();
        let mean = weight / (self.real_channels * count) as f64;
        let mut gradients = std::mem::take(&mut self.gradients);
        let mut losses = std::mem::take(&mut self.losses);
        for_each_chunk_pair(&mut gradients, self.region.pixels(), &mut losses, 1, |channel, gradient, loss| {
            let mut plane = self.planes.mine();
            let plane = &mut plane[..rows * self.plane.columns];
            plane.fill(T::ZERO);
            let values = &self.values[channel * count..(channel + 1) * count];
            let target = &target[channel * count..(channel + 1) * count];
            let mut sum = 0.0;
            for i in 0..self.lags.rows {
                for j in 0..self.lags.columns {
                    let difference = (values[i * self.lags.columns + j] - target[i * self.lags.columns + j]).wide();
                    sum += difference * difference;
                    let (at, pairs) = self.lag(i, j);
                    plane[at] += T::rounded(2.0 * mean * difference / pairs);
                }
            }
            loss[0] = mean * sum;
            let mut lines = self.lines.mine();
            let (slopes, rest) = lines.split_at_mut(half * rows);
            let (line, scratch) = rest.split_at_mut(half);
            self.plane.forward(plane, slopes, line, scratch);
            let spectrum = &self.spectra[channel * rows * half..(channel + 1) * rows * half];
            let scale = T::rounded(2.0 / (rows * self.plane.columns) as f64);
            for (slope, value) in slopes.iter_mut().zip(spectrum) {
                *slope = value.scale(slope.re * scale);
            }
            self.plane.inverse(slopes, plane, line, scratch);
            for (y, row) in gradient.chunks_exact_mut(self.region.width()).enumerate() {
                row.copy_from_slice(&plane[y * self.plane.columns..][..self.region.width()]);
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
