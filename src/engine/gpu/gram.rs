//! Gram matrices on the device: drives `shaders/gram.wgsl`.

use bytemuck::{Pod, Zeroable};

use super::convolution::block_channels;
use super::device::Gpu;
use super::kernel::{Dispatch, Shader};
use super::plan::Need;
use crate::engine::view::{GRAM_LAYERS, Region, Stage, View};

/// As in the shader.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Shape {
    origin: [u32; 2],
    size: [u32; 2],
    width: u32,
    quads: u32,
    part: u32,
    parts: u32,
    scale: f32,
    weight: f32,
    judged: u32,
    unused: u32,
}

/// Parts of an image that are added up apart: enough to keep a device busy, few enough to add up.
const PARTS: usize = 64;
/// Pixels of a part at least, a few loads of workgroup memory.
const LEAST_PART: usize = 64;
/// Pixels of a workgroup of the gradient, as in the shader.
const PIXELS: usize = 64;

fn part_of(pixels: usize) -> usize {
    pixels.div_ceil(PARTS).max(LEAST_PART)
}

/// Buffers of all layers' [`Gram::new`].
pub(super) fn needs(view: &View, channels: usize) -> Vec<Need> {
    let square = channels * channels;
    view.regions()[1..]
        .iter()
        .flat_map(|region| {
            let parts = region.pixels().div_ceil(part_of(region.pixels()));
            [
                ("parts of Gram matrices", parts * square),
                ("Gram matrix", square),
                ("losses", square),
                ("slopes", square),
            ]
        })
        .collect()
}

/// Gram matrix of one layer.
#[derive(Debug)]
pub(super) struct Gram {
    /// `[channels, channels]`, padded.
    pub(super) matrix: wgpu::Buffer,
    /// Loss of every element.
    pub(super) losses: wgpu::Buffer,
    partial: wgpu::Buffer,
    slopes: wgpu::Buffer,
    shape: wgpu::Buffer,
    target: Option<wgpu::Buffer>,
    pixels: usize,
    channels: usize,
    parts: usize,
    constants: [(&'static str, u32); 1],
    block: usize,
}

const _: () = assert!(GRAM_LAYERS == 3, "the shader that adds up the losses knows three");

impl Gram {
    /// For the pixels of `region` of an image of this width, of `channels` padded channels of which `real_channels`
    /// count; `weight` is that of the loss.
    pub(super) fn new(
        gpu: &Gpu,
        (width, region): (usize, Region),
        (channels, real_channels): (usize, usize),
        weight: f64,
        target: Option<&wgpu::Buffer>,
    ) -> Self {
        let (pixels, part) = (region.pixels(), part_of(region.pixels()));
        let parts = pixels.div_ceil(part);
        let square = channels * channels;
        let block = block_channels(channels);
        let shape = Shape {
            origin: [region.x0 as u32, region.y0 as u32],
            size: [region.width() as u32, region.height() as u32],
            width: width as u32,
            quads: (channels / 4) as u32,
            part: part as u32,
            parts: parts as u32,
            scale: (1.0 / (real_channels * pixels) as f64) as f32,
            weight: weight as f32,
            judged: u32::from(target.is_some()),
            unused: 0,
        };
        Self {
            matrix: gpu.storage("Gram matrix", square),
            losses: gpu.storage("losses", square),
            partial: gpu.storage("parts of Gram matrices", parts * square),
            slopes: gpu.storage("slopes", square),
            shape: gpu.uniform("shape", &shape),
            target: target.cloned(),
            pixels,
            channels,
            parts,
            constants: [("BLOCK", block as u32)],
            block,
        }
    }

    /// Measures an image before normalisation, and its loss where there is a target.
    pub(super) fn measure(&self, gpu: &Gpu, image: &wgpu::Buffer, moments: &wgpu::Buffer) -> [Dispatch; 2] {
        let kernel = |entry| gpu.kernel(Shader::Gram, entry, &self.constants);
        let blocks = self.channels.div_ceil(self.block);
        let square = self.channels * self.channels;
        [
            Dispatch::new(
                gpu,
                &kernel("measure"),
                &[(0, &self.shape), (1, image), (2, moments), (3, &self.partial)],
                [blocks, blocks, self.parts],
                Stage::Gram,
                (self.pixels * square) as f64,
            ),
            Dispatch::new(
                gpu,
                &kernel("compare"),
                &[
                    (0, &self.shape),
                    (3, &self.partial),
                    (4, &self.matrix),
                    (5, self.target.as_ref().unwrap_or(moments)),
                    (6, &self.losses),
                    (9, &self.slopes),
                ],
                [square.div_ceil(64), 1, 1],
                Stage::Gram,
                8.0 * (self.parts * square) as f64,
            ),
        ]
    }

    /// Adds dL/dF to `gradient`. The region must be the whole image.
    pub(super) fn add_gradient(
        &self,
        gpu: &Gpu,
        image: &wgpu::Buffer,
        moments: &wgpu::Buffer,
        gradient: &wgpu::Buffer,
    ) -> Dispatch {
        let groups = self.pixels.div_ceil(PIXELS);
        Dispatch::new(
            gpu,
            &gpu.kernel(Shader::Gram, "add_gradient", &self.constants),
            &[(0, &self.shape), (1, image), (2, moments), (7, &self.slopes), (8, gradient)],
            [self.channels.div_ceil(self.block), groups.min(65535), groups.div_ceil(65535)],
            Stage::NormalizationGradient,
            2.0 * (self.pixels * self.channels * self.channels) as f64,
        )
    }
}
