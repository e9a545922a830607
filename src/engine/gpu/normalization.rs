//! Instance normalisation on the device: drives `shaders/normalization.wgsl`.

use bytemuck::{Pod, Zeroable};

use super::device::Gpu;
use super::kernel::{Dispatch, Shader, folded};
use super::plan::Need;
use crate::engine::filters::LAYERS;
use crate::engine::view::{Region, Stage, View, image_sizes};

/// As in the shader.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct DeviceRegion {
    origin: [u32; 2],
    size: [u32; 2],
    width: u32,
    quads: u32,
    runs: u32,
    unused: u32,
}

/// Pixels of a run, as in the shader.
const RUN: usize = 64;

fn part_len(height: usize, width: usize, channels: usize) -> usize {
    height * width.div_ceil(RUN) * 2 * channels
}

/// Buffers of all layers' [`Normalization::new`].
pub(super) fn needs(view: &View, channels: usize) -> Vec<Need> {
    image_sizes(view.grid.height, view.grid.width)[1..=LAYERS]
        .iter()
        .flat_map(|&(height, width)| {
            [
                ("parts of moments", part_len(height, width, channels)),
                ("moments", 2 * channels),
                ("means of gradients", 2 * channels),
            ]
        })
        .collect()
}

/// Mean and inverse deviation of every channel of one image.
#[derive(Debug)]
pub(super) struct Normalization {
    /// Of four channels each: means, then inverse deviations.
    pub(super) moments: wgpu::Buffer,
    parts: wgpu::Buffer,
    averages: wgpu::Buffer,
    region: wgpu::Buffer,
    runs: usize,
    pixels: usize,
    quads: usize,
}

impl Normalization {
    /// For the pixels of `region` of images `[height, width, channels]`, channels padded.
    pub(super) fn new(gpu: &Gpu, (height, width): (usize, usize), region: Region, channels: usize) -> Self {
        let runs = region.width().div_ceil(RUN);
        Self {
            moments: gpu.storage("moments", 2 * channels),
            parts: gpu.storage("parts of moments", part_len(height, width, channels)),
            averages: gpu.storage("means of gradients", 2 * channels),
            region: gpu.uniform(
                "region",
                &DeviceRegion {
                    origin: [region.x0 as u32, region.y0 as u32],
                    size: [region.width() as u32, region.height() as u32],
                    width: width as u32,
                    quads: (channels / 4) as u32,
                    runs: runs as u32,
                    unused: 0,
                },
            ),
            runs: runs * region.height(),
            pixels: region.pixels(),
            quads: channels / 4,
        }
    }

    /// Work of a kernel that reads or writes so many numbers of every pixel and channel.
    fn cost(&self, numbers: f64) -> f64 {
        (self.pixels * self.quads * 4) as f64 * 8.0 * numbers
    }

    /// Measures `image`.
    pub(super) fn measure(&self, gpu: &Gpu, image: &wgpu::Buffer) -> [Dispatch; 2] {
        let kernel = |entry| gpu.kernel(Shader::Normalization, entry, &[]);
        [
            Dispatch::new(
                gpu,
                &kernel("measure_runs"),
                &[(0, &self.region), (1, image), (2, &self.parts)],
                [(self.runs * self.quads).div_ceil(64), 1, 1],
                Stage::Normalization,
                self.cost(1.0),
            ),
            Dispatch::new(
                gpu,
                &kernel("measure"),
                &[(0, &self.region), (2, &self.parts), (3, &self.moments)],
                [self.quads, 1, 1],
                Stage::Normalization,
                self.cost(0.1),
            ),
        ]
    }

    /// Backward through ReLU and normalisation, in place. The region must be the whole image.
    pub(super) fn backward(&self, gpu: &Gpu, image: &wgpu::Buffer, gradient: &wgpu::Buffer) -> [Dispatch; 3] {
        let kernel = |entry| gpu.kernel(Shader::Normalization, entry, &[]);
        [
            Dispatch::new(
                gpu,
                &kernel("sum_gradient_runs"),
                &[(0, &self.region), (1, image), (2, &self.parts), (3, &self.moments), (4, gradient)],
                [(self.runs * self.quads).div_ceil(64), 1, 1],
                Stage::NormalizationGradient,
                self.cost(2.0),
            ),
            Dispatch::new(
                gpu,
                &kernel("average_gradient"),
                &[(0, &self.region), (2, &self.parts), (5, &self.averages)],
                [self.quads, 1, 1],
                Stage::NormalizationGradient,
                self.cost(0.1),
            ),
            Dispatch::new(
                gpu,
                &kernel("apply_gradient"),
                &[(0, &self.region), (1, image), (3, &self.moments), (4, gradient), (5, &self.averages)],
                folded(self.pixels * self.quads, 64),
                Stage::NormalizationGradient,
                self.cost(3.0),
            ),
        ]
    }
}
