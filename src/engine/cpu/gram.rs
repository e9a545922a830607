//! Gram matrices of activations, their loss and its gradient.
//!
//! `G = F Fᵀ / (C · H · W)` for activations `F` `[C, H · W]` (Huang et al. 2022, §4.3): which filters answer together,
//! wherever in the image. The loss of a layer is `w · Σ (G̃ − G)²`; its gradient `dL/dF = 4 w (G̃ − G) F / (C · H · W)`.

use crate::engine::view::Region;

use super::lanes::{self, Kernel, LANES};
use super::normalization::{Activate, Statistics};
use super::product;
use super::real::Real;
use super::scratch::Scratch;
use crate::parallel::for_each_chunk;

/// Partial sums of a Gram matrix: enough for any number of cores, few enough to stay in the cache.
const PARTS: usize = 32;
/// Pixels activated at a time: 120 channels of 64 pixels are 30 kB, which stays in the first cache.
const BLOCK: usize = 64;

/// Gram matrix of one layer and the space to make it.
#[derive(Debug)]
pub struct Gram<T> {
    channels: usize,
    real_channels: usize,
    /// `[channels, channels]`, padded.
    matrix: Vec<f64>,
    partial: Vec<T>,
    /// Weight of the gradient: `4 w (G̃ − G) / (C H W)`.
    slope: Vec<T>,
    blocks: Scratch<T>,
}

impl<T: Real> Gram<T> {
    /// Space for layers of `channels` (padded) channels, of which `real_channels` count.
    #[must_use]
    pub fn new(channels: usize, real_channels: usize) -> Self {
        Self {
            channels,
            real_channels,
            matrix: vec![0.0; channels * channels],
            partial: vec![T::ZERO; PARTS * channels * channels],
            slope: vec![T::ZERO; channels * channels],
            blocks: Scratch::new(BLOCK * channels),
        }
    }

    /// Bytes that [`Self::new`] allocates.
    #[must_use]
    pub fn bytes_for(channels: usize) -> usize {
        let matrix = channels * channels;
        matrix * size_of::<f64>()
            + ((PARTS + 1) * matrix + (crate::parallel::threads() + 1) * BLOCK * channels) * size_of::<T>()
    }

    /// The matrix last made, `[channels, channels]` with padded channels.
    #[must_use]
    pub fn matrix(&self) -> &[f64] {
        &self.matrix
    }

    /// Measures the pixels of `region` of an image `[height, width, channels]` before normalisation.
    pub fn measure(&mut self, image: &[T], width: usize, region: Region, statistics: &Statistics<T>) {
        let channels = self.channels;
        let size = channels * channels;
        let rows = region.height();
        let rows_a_part = rows.div_ceil(PARTS);
        let parts = rows.div_ceil(rows_a_part);
        let blocks = &self.blocks;
        for_each_chunk(&mut self.partial[..parts * size], size, |part, sum| {
            sum.fill(T::ZERO);
            let mut block = blocks.mine();
            let first = part * rows_a_part;
            for row in first..(first + rows_a_part).min(rows) {
                let start = ((region.y0 + row) * width + region.x0) * channels;
                let line = &image[start..start + region.width() * channels];
                for pixels in line.chunks(BLOCK * channels) {
                    lanes::run(MeasureBlock { pixels, statistics, channels, block: &mut block, sum });
                }
            }
        });
        let scale = 1.0 / (self.real_channels * region.pixels()) as f64;
        for i in 0..channels {
            for j in i..channels {
                let sum: f64 = (0..parts).map(|part| self.partial[part * size + i * channels + j].wide()).sum();
                self.matrix[i * channels + j] = sum * scale;
                self.matrix[j * channels + i] = sum * scale;
            }
        }
    }

    /// The loss against a target matrix; also prepares [`Self::add_gradient`].
    pub fn loss(&mut self, target: &[f64], weight: f64, pixels: usize) -> f64 {
        let scale = 4.0 * weight / (self.real_channels * pixels) as f64;
        let mut sum = 0.0;
        for ((value, target), slope) in self.matrix.iter().zip(target).zip(&mut self.slope) {
            let difference = value - target;
            sum += difference * difference;
            *slope = T::rounded(scale * difference);
        }
        weight * sum
    }

    /// Adds dL/dF of some pixels, `[pixel, channels]`, to `gradient`, for the loss last taken. `image` is before
    /// normalisation with this `mean` and `inverse_deviation`.
    pub fn add_gradient(&self, image: &[T], mean: &[T], inverse_deviation: &[T], gradient: &mut [T]) {
        let len = BLOCK * self.channels;
        let mut block = self.blocks.mine();
        for (pixels, gradient) in image.chunks(len).zip(gradient.chunks_mut(len)) {
            let slope = &self.slope;
            lanes::run(GradientBlock { pixels, mean, inverse_deviation, block: &mut block, slope, gradient });
        }
    }
}

struct MeasureBlock<'a, T> {
    pixels: &'a [T],
    statistics: &'a Statistics<T>,
    channels: usize,
    block: &'a mut [T],
    sum: &'a mut [T],
}

impl<T: Real> Kernel for MeasureBlock<'_, T> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self { channels, statistics, .. } = self;
        let count = self.pixels.len() / channels;
        let block = &mut self.block[..count * channels];
        Activate {
            image: self.pixels,
            mean: &statistics.mean,
            inverse_deviation: &statistics.inverse_deviation,
            out: block,
        }
        .run::<FMA>();
        product::add_square::<T, FMA>(block, channels, self.sum);
    }
}

struct GradientBlock<'a, T> {
    pixels: &'a [T],
    mean: &'a [T],
    inverse_deviation: &'a [T],
    block: &'a mut [T],
    slope: &'a [T],
    gradient: &'a mut [T],
}

impl<T: Real> Kernel for GradientBlock<'_, T> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self { pixels, mean, inverse_deviation, .. } = self;
        let block = &mut self.block[..pixels.len()];
        Activate { image: pixels, mean, inverse_deviation, out: block }.run::<FMA>();
        product::add_product::<T, FMA>(block, self.slope, mean.len(), self.gradient);
    }
}

const _: () = assert!(BLOCK.is_multiple_of(LANES));
