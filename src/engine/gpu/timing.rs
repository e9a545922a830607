//! How long the kernels take, for `pointweave bench`; not in a browser, where nothing can be waited for.

use std::collections::BTreeMap;
use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use web_time::Instant;

use super::device::{Gpu, GpuError};
use super::kernel::{Dispatch, Shader};
use super::{Feeder, GpuEngine, Phase};
use crate::engine::cpu::convolution::{Geometry, KERNEL};
use crate::engine::cpu::lanes::padded;
use crate::engine::view::Stage;
use crate::pattern::Boundary;

/// What the stages of one iteration take.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Timing {
    /// Seconds of every stage.
    pub stages: BTreeMap<&'static str, f64>,
    /// Of the products of matrices in the convolutions: seconds, and operations actually done.
    pub product: (f64, f64),
    /// The longest piece that can't be interrupted: seconds of the longest dispatch.
    pub longest: f64,
    /// Of the second convolution, forward: seconds through transforms of tiles.
    pub second_layer: f64,
}

/// A timing should be this long at least: starting and waiting is some tens of microseconds.
const LEAST_SECONDS: f64 = 0.01;

/// Seconds of the whole program run once. Pieces are repeated until they take long enough.
fn seconds(gpu: &Gpu, piece: &[Dispatch]) -> Result<f64, GpuError> {
    let run = |times: usize| {
        let mut feeder = Feeder::default();
        let start = Instant::now();
        let mut done = 0;
        while done < piece.len() * times || !feeder.in_flight.is_empty() {
            feeder.collect(gpu);
            if let Some(fault) = gpu.fault() {
                return Err(GpuError::Lost(fault));
            }
            if done < piece.len() * times && feeder.has_room() {
                done = feeder.feed(gpu, piece, times, done, |_| {});
            } else {
                feeder.wait(gpu);
            }
        }
        Ok(start.elapsed().as_secs_f64())
    };
    let once = run(1)?;
    let times = (LEAST_SECONDS / once).ceil().clamp(1.0, 500.0) as usize;
    Ok(run(times)? / times as f64)
}

impl GpuEngine {
    /// Times every stage by itself. The engine's images are garbage afterwards. Nothing before the exemplar is
    /// measured.
    ///
    /// # Errors
    /// When the device fails.
    pub fn time(&self) -> Result<Timing, GpuError> {
        let Phase::Output(output) = &self.phase else { return Ok(Timing::default()) };
        let program = &output.side.program;
        let mut timing = Timing::default();
        let mut images = 0;
        let mut start = 0;
        while start < program.len() {
            let stage = program[start].stage;
            let is_product = program[start].is_product();
            let same = |dispatch: &&Dispatch| dispatch.stage == stage && dispatch.is_product() == is_product;
            let end = start + program[start..].iter().take_while(same).count();
            let piece = &program[start..end];
            let took = seconds(&self.gpu, piece)?;
            let longest = piece.iter().map(|dispatch| dispatch.cost).fold(0.0, f64::max);
            let all: f64 = piece.iter().map(|dispatch| dispatch.cost).sum();
            timing.longest = timing.longest.max(took * longest / all);
            *timing.stages.entry(stage.name()).or_default() += took;
            if is_product {
                timing.product.0 += took;
                timing.product.1 += piece.iter().map(|dispatch| dispatch.cost).sum::<f64>();
            }
            if stage == Stage::Normalization {
                images += 1;
            }
            if stage == Stage::Convolution && images == 1 {
                timing.second_layer += took;
            }
            start = end;
        }
        Ok(timing)
    }
}

/// As in the shader.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Shape {
    size: [u32; 2],
    quads: u32,
    quads_out: u32,
    periodic: u32,
    unused: u32,
}

/// A convolution of stride 1 done directly: what the transforms are measured against.
#[derive(Debug)]
pub struct Direct {
    gpu: Arc<Gpu>,
    pub(super) result: wgpu::Buffer,
    dispatch: Dispatch,
}

impl Direct {
    /// Of an image `[height, width, channels]`, channels padded, with weights `[channels, channels, 7, 7]`.
    #[must_use]
    pub fn new(gpu: &Arc<Gpu>, geometry: Geometry, channels: usize, weights: &[f64], image: &[f32]) -> Self {
        let outputs = padded(channels);
        let mut arranged = vec![0.0_f32; KERNEL * KERNEL * outputs * outputs];
        for (index, &weight) in weights.iter().enumerate() {
            let (pair, tap) = (index / (KERNEL * KERNEL), index % (KERNEL * KERNEL));
            arranged[(tap * outputs + pair % channels) * outputs + pair / channels] = weight as f32;
        }
        let shape = Shape {
            size: [geometry.width as u32, geometry.height as u32],
            quads: (outputs / 4) as u32,
            quads_out: (outputs / 4) as u32,
            periodic: u32::from(geometry.boundary == Boundary::Periodic),
            unused: 0,
        };
        let result = gpu.storage("image", geometry.height * geometry.width * outputs);
        let bindings = [
            (0, &gpu.uniform("shape", &shape)),
            (1, &gpu.upload("image", image)),
            (2, &gpu.upload("weights", &arranged)),
            (3, &result),
        ];
        let groups = [geometry.width.div_ceil(8), geometry.height.div_ceil(8), outputs.div_ceil(64)];
        let cost = 2.0 * (KERNEL * KERNEL * outputs * outputs * geometry.height * geometry.width) as f64;
        let kernel = gpu.kernel(Shader::Direct, "convolve", &[]);
        let dispatch = Dispatch::new(gpu, &kernel, &bindings, groups, Stage::Convolution, cost);
        Self { gpu: Arc::clone(gpu), result, dispatch }
    }

    /// Seconds it takes.
    ///
    /// # Errors
    /// When the device fails.
    pub fn seconds(&self) -> Result<f64, GpuError> {
        seconds(&self.gpu, std::slice::from_ref(&self.dispatch))
    }

    /// The convolved image, `[height, width, channels]`, after [`Self::seconds`].
    ///
    /// # Errors
    /// When the device fails.
    pub fn image(&self) -> Result<Vec<f32>, GpuError> {
        pollster::block_on(super::probe::read(&self.gpu, &self.result, (self.result.size() / 4) as usize))
    }
}
