//! Instance normalisation and ReLU, forward and backward.
//!
//! Each channel is shifted to mean 0 and scaled to variance 1 over the pixels of one image, without learned
//! parameters: `x̂ = (y − μ) / √(σ² + ε)` with the biased variance, then `a = max(x̂, 0)` (Huang et al. 2022, §4.2).
//! ε gates channels that hardly respond: the first layer's variances are of its order (1e-6 … 1e-4), so the scale of
//! the Gabor maps matters.

use crate::engine::view::Region;

use super::gram::Gram;
use super::lanes::{self, Kernel, LANES, Lanes};
use super::real::Real;
use crate::parallel::{for_each_chunk, for_each_chunk_pair};

/// Added to the variance under the root.
pub const EPSILON: f64 = 1e-5;

/// Mean and inverse deviation of every channel of one image, and the sums the backward pass needs.
#[derive(Debug)]
pub struct Statistics<T> {
    /// μ of every channel.
    pub mean: Vec<T>,
    /// 1 / √(σ² + ε) of every channel.
    pub inverse_deviation: Vec<T>,
    /// Two sums for every row and channel, `[row, 2, channels]`.
    partial: Vec<f64>,
    channels: usize,
}

impl<T: Real> Statistics<T> {
    /// Space for images of `height` rows and `channels` (padded) channels.
    #[must_use]
    pub fn new(height: usize, channels: usize) -> Self {
        Self {
            mean: vec![T::ZERO; channels],
            inverse_deviation: vec![T::ZERO; channels],
            partial: vec![0.0; height * 2 * channels],
            channels,
        }
    }

    /// Bytes that [`Self::new`] allocates.
    #[must_use]
    pub const fn bytes_for(height: usize, channels: usize) -> usize {
        2 * channels * size_of::<T>() + height * 2 * channels * size_of::<f64>()
    }

    /// Measures the pixels of `region` of an image `[height, width, channels]`.
    ///
    /// Every row is measured in its own mean (rows are short enough for `f32` sums), and the rows are put together in
    /// double precision and in order: accurate where the mean is large against the deviation, and the same bits at
    /// any number of threads.
    pub fn measure(&mut self, image: &[T], width: usize, region: Region) {
        let channels = self.channels;
        let rows = region.height();
        for_each_chunk(&mut self.partial[..rows * 2 * channels], 2 * channels, |row, out| {
            let start = ((region.y0 + row) * width + region.x0) * channels;
            let line = &image[start..start + region.width() * channels];
            lanes::run(MeasureRow { line, channels, out });
        });
        let row_pixels = region.width() as f64;
        for channel in 0..channels {
            let row = |row: usize, which: usize| self.partial[(row * 2 + which) * channels + channel];
            let mean = (0..rows).map(|r| row(r, 0)).sum::<f64>() / rows as f64;
            let squares: f64 = (0..rows).map(|r| row(r, 1) + row_pixels * (row(r, 0) - mean).powi(2)).sum();
            let variance = squares / (rows as f64 * row_pixels);
            self.mean[channel] = T::rounded(mean);
            self.inverse_deviation[channel] = T::rounded(1.0 / (variance + EPSILON).sqrt());
        }
    }

    /// Backward through ReLU and normalisation, in place: `gradient` holds dL/da on entry and dL/dy on return.
    ///
    /// With `g = dL/da` where `x̂ > 0`, else 0: `dL/dy = (g − mean(g) − x̂ · mean(g · x̂)) / √(σ² + ε)`.
    ///
    /// The gradient of a Gram loss on the same activations is added on the way, row by row, while the row is in the
    /// cache.
    pub fn backward(&mut self, image: &[T], gradient: &mut [T], width: usize, gram: Option<&Gram<T>>) {
        let channels = self.channels;
        let row_len = width * channels;
        let rows = image.len() / row_len;
        let (mean, inverse) = (&self.mean, &self.inverse_deviation);
        let partial = &mut self.partial[..rows * 2 * channels];
        for_each_chunk_pair(partial, 2 * channels, gradient, row_len, |row, sums, gradient| {
            let image = &image[row * row_len..(row + 1) * row_len];
            if let Some(gram) = gram {
                gram.add_gradient(image, mean, inverse, gradient);
            }
            lanes::run(BackwardSums { image, gradient, mean, inverse, channels, sums });
        });
        // The sums over all rows, in order, end up in the first row's place.
        let (total, rest) = self.partial.split_at_mut(2 * channels);
        for row in rest.chunks_exact(2 * channels).take(rows - 1) {
            for (sum, part) in total.iter_mut().zip(row) {
                *sum += part;
            }
        }
        let pixels = (rows * width) as f64;
        let total = &*total;
        for_each_chunk(gradient, row_len, |row, gradient| {
            let image = &image[row * row_len..(row + 1) * row_len];
            lanes::run(BackwardApply { image, gradient, mean, inverse, channels, total, pixels });
        });
    }
}

/// Mean of a row, and the sum of squared differences from it, for every channel.
struct MeasureRow<'a, T> {
    line: &'a [T],
    channels: usize,
    out: &'a mut [f64],
}

impl<T: Real> Kernel for MeasureRow<'_, T> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let pixels = self.line.len() / self.channels;
        let per_pixel = T::rounded(1.0 / pixels as f64);
        for group in (0..self.channels).step_by(LANES) {
            let values = || self.line[group..].chunks(self.channels).map(|pixel| Lanes::load(pixel));
            let mean = values().fold(Lanes::ZERO, |sum, v| sum + v).scale(per_pixel);
            let squares = values().fold(Lanes::ZERO, |sum, v| {
                let difference = v - mean;
                sum + difference * difference
            });
            for lane in 0..LANES {
                self.out[group + lane] = mean.0[lane].wide();
                self.out[self.channels + group + lane] = squares.0[lane].wide();
            }
        }
    }
}

/// The gradient where the ReLU lets it through, else 0.
#[inline(always)]
fn masked<T: Real>(gradient: Lanes<T>, normalized: Lanes<T>) -> Lanes<T> {
    Lanes(std::array::from_fn(|lane| if normalized.0[lane] > T::ZERO { gradient.0[lane] } else { T::ZERO }))
}

/// Σ g and Σ g · x̂ of a row.
struct BackwardSums<'a, T> {
    image: &'a [T],
    gradient: &'a [T],
    mean: &'a [T],
    inverse: &'a [T],
    channels: usize,
    sums: &'a mut [f64],
}

impl<T: Real> Kernel for BackwardSums<'_, T> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let channels = self.channels;
        for group in (0..channels).step_by(LANES) {
            let (mean, inverse) = (Lanes::load(&self.mean[group..]), Lanes::load(&self.inverse[group..]));
            let (mut sum, mut product) = (Lanes::ZERO, Lanes::ZERO);
            for (y, g) in self.image[group..].chunks(channels).zip(self.gradient[group..].chunks(channels)) {
                let normalized = (Lanes::load(y) - mean) * inverse;
                let gradient = masked(Lanes::load(g), normalized);
                sum = sum + gradient;
                product = product + gradient * normalized;
            }
            for lane in 0..LANES {
                self.sums[group + lane] = sum.0[lane].wide();
                self.sums[channels + group + lane] = product.0[lane].wide();
            }
        }
    }
}

struct BackwardApply<'a, T> {
    image: &'a [T],
    gradient: &'a mut [T],
    mean: &'a [T],
    inverse: &'a [T],
    channels: usize,
    total: &'a [f64],
    pixels: f64,
}

impl<T: Real> Kernel for BackwardApply<'_, T> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let channels = self.channels;
        for group in (0..channels).step_by(LANES) {
            let (mean, inverse) = (Lanes::load(&self.mean[group..]), Lanes::load(&self.inverse[group..]));
            let average = |which: usize| {
                Lanes(std::array::from_fn(|lane| T::rounded(self.total[which * channels + group + lane] / self.pixels)))
            };
            let (mean_g, mean_product): (Lanes<T>, Lanes<T>) = (average(0), average(1));
            for (y, g) in self.image[group..].chunks(channels).zip(self.gradient[group..].chunks_mut(channels)) {
                let normalized = (Lanes::load(y) - mean) * inverse;
                let gradient = masked(Lanes::load(g), normalized);
                ((gradient - mean_g - normalized * mean_product) * inverse).store(g);
            }
        }
    }
}

/// Writes the activations `a = max(x̂, 0)` of some pixels, all channels.
pub struct Activate<'a, T> {
    /// Pixels before normalisation.
    pub image: &'a [T],
    /// μ of every channel.
    pub mean: &'a [T],
    /// 1 / √(σ² + ε) of every channel.
    pub inverse_deviation: &'a [T],
    /// Where the activations go.
    pub out: &'a mut [T],
}

impl<T: Real> Kernel for Activate<'_, T> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let channels = self.mean.len();
        for (y, out) in self.image.chunks_exact(channels).zip(self.out.chunks_exact_mut(channels)) {
            for (((value, out), mean), inverse) in y.iter().zip(out).zip(self.mean).zip(self.inverse_deviation) {
                let normalized = (*value - *mean) * *inverse;
                *out = if normalized > T::ZERO { normalized } else { T::ZERO };
            }
        }
    }
}
