//! Convolutions on the device: drives `shaders/convolution.wgsl`.

use bytemuck::{Pod, Zeroable};

use super::device::Gpu;
use super::kernel::{Dispatch, Kernel, Shader};
use super::plan::{TILE, spectrum_len};
use crate::engine::cpu::convolution::{Direction, Filters, Geometry, KERNEL};
use crate::engine::cpu::lanes::padded;
use crate::engine::view::Stage;
use crate::pattern::Boundary;

/// As in the shader.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Shape {
    size: [u32; 2],
    quads: u32,
    tile_columns: u32,
    first_tile: u32,
    tiles: u32,
    stride: u32,
    first: u32,
    periodic: u32,
    activated: u32,
    quads_out: u32,
    first_frequency: u32,
    extent: [u32; 2],
}

/// Vectors of four channels that a workgroup transforms, as in the shader.
const QUADS: usize = 2;

/// A dispatch should not take longer than this, for a submission can't be cut within one.
const LONGEST_DISPATCH_SECONDS: f64 = 0.03;

/// The spectra of one layer's filters on the device: `[frequency, channel in, channel out / 4, re | im]`, and the
/// same with the channels' roles exchanged for the way back.
#[derive(Debug)]
pub(super) struct DeviceFilters {
    inputs: usize,
    outputs: usize,
    forward: wgpu::Buffer,
    gradient: wgpu::Buffer,
}

impl DeviceFilters {
    /// Transforms weights `[channels out, channels in, 7, 7]` and hands them to the device.
    pub(super) fn new(gpu: &Gpu, weights: &[f64], channels_in: usize, channels_out: usize) -> Self {
        let filters = Filters::<f32>::new(weights, channels_in, channels_out, TILE);
        let (inputs, outputs) = (padded(channels_in), padded(channels_out));
        let plane = inputs * outputs;
        let arrange = |rows: usize, columns: usize, at: &dyn Fn(usize, usize) -> usize, sign: f32| {
            let mut arranged = Vec::with_capacity(filters.spectra().len());
            for spectrum in filters.spectra().chunks_exact(2 * plane) {
                let (re, im) = spectrum.split_at(plane);
                for row in 0..rows {
                    for quad in (0..columns).step_by(4) {
                        // The CPU's transforms leave out a half that these don't.
                        arranged.extend((quad..quad + 4).map(|column| 2.0 * re[at(row, column)]));
                        arranged.extend((quad..quad + 4).map(|column| 2.0 * sign * im[at(row, column)]));
                    }
                }
            }
            arranged
        };
        // Forward is correlation, not convolution: the conjugate of the filter's spectrum.
        let forward = arrange(inputs, outputs, &|from, to| from * outputs + to, -1.0);
        let gradient = arrange(outputs, inputs, &|to, from| from * outputs + to, 1.0);
        Self { inputs, outputs, forward: gpu.upload("filters", &forward), gradient: gpu.upload("filters", &gradient) }
    }
}

/// What every convolution shares.
#[derive(Clone, Copy, Debug)]
pub(super) struct Workspace<'a> {
    /// Transformed tiles, then their products, `numbers` each.
    pub(super) spectra: &'a wgpu::Buffer,
    /// Products.
    pub(super) products: &'a wgpu::Buffer,
    /// Numbers in each.
    pub(super) numbers: usize,
}

/// Channels that one workgroup multiplies: at most 64, and as few idle ones as possible.
pub(super) fn block_channels(channels: usize) -> usize {
    channels.div_ceil(channels.div_ceil(64)).next_multiple_of(4)
}

/// The kernel that multiplies blocks of this many tiles and channels.
fn product_kernel(gpu: &Gpu, block_tiles: usize, block_channels: usize) -> Kernel {
    gpu.kernel(
        Shader::Convolution,
        "multiply",
        &[
            ("BLOCK_TILES", block_tiles as u32),
            ("BLOCK_CHANNELS", block_channels as u32),
            ("THREADS", (block_tiles / 4 * block_channels / 4) as u32),
        ],
    )
}

/// Constants for the kernels that don't use them.
pub(super) const ANY_BLOCK: [(&str, u32); 3] = [("BLOCK_TILES", 64), ("BLOCK_CHANNELS", 64), ("THREADS", 256)];

/// One way through a layer: from `image` to `result`, in passes of as many tiles as the workspace holds. `moments`
/// normalise and rectify the image on the way in.
pub(super) fn convolve(
    gpu: &Gpu,
    filters: &DeviceFilters,
    geometry: Geometry,
    direction: Direction,
    (image, moments): (&wgpu::Buffer, Option<&wgpu::Buffer>),
    result: &wgpu::Buffer,
    workspace: Workspace<'_>,
) -> Vec<Dispatch> {
    let (near, far) = ((geometry.height, geometry.width), geometry.output());
    let is_forward = direction == Direction::Forward;
    let (inner, outer, spectra) = if is_forward {
        (filters.inputs, filters.outputs, &filters.forward)
    } else {
        (filters.outputs, filters.inputs, &filters.gradient)
    };
    let stage = if is_forward { Stage::Convolution } else { Stage::ConvolutionGradient };
    // The far side of a strided layer has fewer pixels than its input.
    let ((from, from_stride), (to, to_stride)) =
        if is_forward { ((near, 1), (far, geometry.stride)) } else { ((far, geometry.stride), (near, 1)) };
    let shape = |size: (usize, usize), stride: usize, quads: usize, quads_out: usize| Shape {
        size: [size.1 as u32, size.0 as u32],
        quads: quads as u32,
        tile_columns: geometry.width.div_ceil(TILE.step()) as u32,
        first_tile: 0,
        tiles: 0,
        stride: stride as u32,
        first: if is_forward { 0 } else { KERNEL as u32 - 1 },
        periodic: u32::from(geometry.boundary == Boundary::Periodic),
        activated: u32::from(moments.is_some()),
        quads_out: quads_out as u32,
        first_frequency: 0,
        extent: [geometry.width as u32, geometry.height as u32],
    };
    let kernel = |entry| gpu.kernel(Shader::Convolution, entry, &ANY_BLOCK);
    let all = geometry.tiles(TILE);
    let tiles_a_pass = (workspace.numbers / spectrum_len(inner.max(outer))).clamp(1, all);
    let mut dispatches = Vec::new();
    for first in (0..all).step_by(tiles_a_pass) {
        let tiles = tiles_a_pass.min(all - first);
        let pass = |shape: Shape| Shape { first_tile: first as u32, tiles: tiles as u32, ..shape };
        // A transform takes about 2.5 n log₂ n operations, and moves what it transforms.
        let samples = (TILE.side() * TILE.side()) as f64;
        let transform_cost = |channels: usize| (tiles * channels) as f64 * samples * (2.5 * 8.0 + 2.0 * 8.0);

        let input = gpu.uniform("shape", &pass(shape(from, from_stride, inner / 4, outer / 4)));
        dispatches.push(Dispatch::new(
            gpu,
            &kernel("transform"),
            &[(0, &input), (1, image), (2, moments.unwrap_or(image)), (3, workspace.spectra)],
            [tiles, inner / 4 / QUADS, 1],
            stage,
            transform_cost(inner),
        ));

        let (block_tiles, block_channels) = (
            if tiles > 32 {
                64
            } else if tiles > 16 {
                32
            } else {
                16
            },
            block_channels(outer),
        );
        let multiply = product_kernel(gpu, block_tiles, block_channels);
        let cost_a_frequency = 8.0 * (tiles * inner * outer) as f64;
        let most = (gpu.work_in(LONGEST_DISPATCH_SECONDS) / cost_a_frequency).max(1.0) as usize;
        let pieces = TILE.frequencies().div_ceil(most);
        let a_piece = TILE.frequencies().div_ceil(pieces);
        for first_frequency in (0..TILE.frequencies()).step_by(a_piece) {
            let frequencies = a_piece.min(TILE.frequencies() - first_frequency);
            let piece = Shape {
                first_frequency: first_frequency as u32,
                ..pass(shape(from, from_stride, inner / 4, outer / 4))
            };
            dispatches.push(Dispatch::new(
                gpu,
                &multiply,
                &[(0, &gpu.uniform("shape", &piece)), (3, workspace.spectra), (4, spectra), (5, workspace.products)],
                [outer.div_ceil(block_channels), tiles.div_ceil(block_tiles), frequencies],
                stage,
                cost_a_frequency * frequencies as f64,
            ));
        }

        let output = gpu.uniform("shape", &pass(shape(to, to_stride, outer / 4, outer / 4)));
        dispatches.push(Dispatch::new(
            gpu,
            &kernel("invert"),
            &[(0, &output), (5, workspace.products), (6, result)],
            [tiles, outer / 4 / QUADS, 1],
            stage,
            transform_cost(outer),
        ));
    }
    dispatches
}
