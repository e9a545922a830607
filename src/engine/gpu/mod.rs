//! The GPU engine: the stages of [`super::cpu`] on a device, through WebGPU in a browser and Vulkan elsewhere.
//!
//! Everything stays on the device. Work goes there in submissions sized by measurement to stay well under the tenth
//! of a second at which watchdogs and people notice; at most two are on their way. Positions, moments and losses come
//! back once a batch, through one of two staging buffers, so that the next batch runs meanwhile: that copy is where a
//! run goes on from if the device is lost.
//!
//! Nothing here blocks: [`GpuEngine::advance`] hands out work and looks what is done. Who has nothing better to do
//! waits with [`GpuEngine::wait`], or for [`Gpu::report`] where blocking is not possible.

#![cfg_attr(
    target_arch = "wasm32",
    expect(
        clippy::arc_with_non_send_sync,
        reason = "devices are shared among threads natively, and stay on theirs here"
    )
)]

mod adam;
mod convolution;
mod correlation;
mod device;
mod gabor;
mod gram;
mod kernel;
mod network;
mod normalization;
mod plan;
pub mod probe;
#[cfg(not(target_arch = "wasm32"))]
pub mod timing;

use std::collections::VecDeque;
use std::sync::{Arc, Mutex};

use glam::DVec2;
use web_time::Instant;

use crate::engine::LossTerms;
use crate::engine::cpu;
use crate::engine::cpu::adam::{Adam, correction};
use crate::engine::{Advance, ScaleSetup};

pub use device::{DeviceInfo, Gpu, GpuError, OpenOptions, Report, list};
pub use kernel::Shader;
pub use network::GpuNetwork;
pub use plan::Allowance;

use device::{InFlight, lock};
use gabor::jitter_len;
use kernel::Dispatch;
use network::{Evaluation, Io, LONGEST_BATCH};
use plan::Plan;

/// Work of one submission: half of what may be noticed, for the next one may be slower than the last.
const SUBMISSION_SECONDS: f64 = 0.05;

/// Submissions on their way: one runs, one waits for it.
const MOST_IN_FLIGHT: usize = 2;

/// Batches on their way, each with its staging buffer.
const MOST_BATCHES: usize = 2;

/// A buffer on its way back.
#[derive(Debug)]
struct Readback {
    buffer: wgpu::Buffer,
    mapped: Arc<Mutex<Option<bool>>>,
}

impl Readback {
    fn new(gpu: &Gpu, bytes: u64) -> Self {
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("staging"),
            size: bytes,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self { buffer, mapped: Arc::default() }
    }

    /// Asks for its contents; to be called once the commands that fill it are submitted.
    fn request(&self, gpu: &Gpu) {
        let (mapped, bell) = (Arc::clone(&self.mapped), gpu.bell.clone());
        self.buffer.map_async(wgpu::MapMode::Read, .., move |outcome| {
            *lock(&mapped) = Some(outcome.is_ok());
            bell.ring();
        });
    }

    /// The contents once they are there, and an error if they will never be.
    fn take(&self) -> Option<Result<Vec<u8>, GpuError>> {
        let lost = || Err(GpuError::Lost("a buffer can't be read back".to_owned()));
        if !(*lock(&self.mapped))? {
            return Some(lost());
        }
        *lock(&self.mapped) = None;
        let bytes = self.buffer.get_mapped_range(..).map(|range| range.to_vec());
        self.buffer.unmap();
        Some(bytes.map_or_else(|_| lost(), Ok))
    }
}

/// Hands a list of dispatches to the device, in submissions of a bounded size.
#[derive(Debug, Default)]
struct Feeder {
    in_flight: VecDeque<InFlight>,
    /// When the last submission that is done was.
    last_done: Option<Instant>,
}

impl Feeder {
    /// Looks which submissions are done.
    fn collect(&mut self, gpu: &Gpu) {
        gpu.poll();
        while let Some(done) = self.in_flight.front().and_then(|first| first.collect(gpu, self.last_done)) {
            self.last_done = Some(done);
            self.in_flight.pop_front();
        }
    }

    fn has_room(&self) -> bool {
        self.in_flight.len() < MOST_IN_FLIGHT
    }

    /// Submits what comes after the first `done` dispatches of `times` runs through `program`, as much as fits into
    /// one submission, and what `last` adds if that was all. Returns how many are done then.
    fn feed(
        &mut self,
        gpu: &Gpu,
        program: &[Dispatch],
        times: usize,
        done: usize,
        last: impl FnOnce(&mut wgpu::CommandEncoder),
    ) -> usize {
        let most = gpu.work_in(SUBMISSION_SECONDS);
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let (mut cost, mut next) = (0.0, done);
        let all = program.len() * times;
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            while next < all {
                let dispatch = &program[next % program.len()];
                if next > done && cost + dispatch.cost > most {
                    break;
                }
                dispatch.encode(&mut pass);
                cost += dispatch.cost;
                next += 1;
            }
        }
        if next == all {
            last(&mut encoder);
        }
        self.in_flight.push_back(InFlight::submit(gpu, encoder.finish(), cost));
        next
    }

    #[cfg(not(target_arch = "wasm32"))]
    fn wait(&self, gpu: &Gpu) {
        if let Some(first) = self.in_flight.front() {
            gpu.wait_for(&first.index);
        }
    }
}

/// Iterations whose results are on their way.
#[derive(Debug)]
struct Batch {
    iterations: usize,
    /// Which staging buffer they come back through; read once the last submission is on its way.
    staging: Readback,
}

/// The exemplar is measured first; its images are gone before those of the output are allocated.
#[derive(Debug)]
enum Phase {
    Exemplar { side: Box<Evaluation>, done: usize, staging: Readback },
    Output(Box<Output>),
}

/// The output's side, and its batches.
#[derive(Debug)]
struct Output {
    side: Evaluation,
    io: Io,
    /// The batch being handed out: its iterations, and the dispatches that are on their way.
    feeding: Option<(Batch, usize)>,
    batches: VecDeque<Batch>,
    /// Staging buffers that are free.
    spare: Vec<Readback>,
    /// Iterations handed out so far on this scale.
    handed_out: u32,
    /// Adam's steps likewise.
    steps: u32,
}

/// One class on one scale, on a device.
#[derive(Debug)]
pub struct GpuEngine {
    gpu: Arc<Gpu>,
    setup: ScaleSetup,
    network: Arc<GpuNetwork>,
    phase: Phase,
    feeder: Feeder,
    /// What came back last: where a run goes on if the device is lost.
    points: Vec<DVec2>,
    adam: Adam,
    iteration: u32,
    moving_from: usize,
    channels: usize,
    /// The iteration after those of the last batch gave a number that is not finite.
    not_finite: bool,
}

impl GpuEngine {
    /// Bytes that a run of this scale takes at its peak.
    ///
    /// # Errors
    /// When it does not fit into what is allowed.
    pub fn bytes_for(
        gpu: &Gpu,
        setup: &ScaleSetup,
        channels: usize,
        points: usize,
        allowed_bytes: u64,
    ) -> Result<u64, GpuError> {
        Plan::new(setup, channels, points, allowance(gpu, allowed_bytes)).map(|plan| plan.total)
    }

    /// Starts a scale. `points` are the output's points in exemplar units; those before `moving_from` are frozen.
    /// `adam` and `iteration` are where a saved run stood, or fresh. `before` are the filters of an earlier scale.
    ///
    /// # Errors
    /// When the scale does not fit on the device; nothing is allocated then.
    #[expect(clippy::too_many_arguments, reason = "the start of a scale is all of these")]
    pub fn new(
        gpu: &Arc<Gpu>,
        setup: ScaleSetup,
        channels: usize,
        before: Option<Arc<GpuNetwork>>,
        points: Vec<DVec2>,
        moving_from: usize,
        adam: Adam,
        iteration: u32,
        allowed_bytes: u64,
    ) -> Result<Self, GpuError> {
        let plan = Plan::new(&setup, channels, points.len(), allowance(gpu, allowed_bytes))?;
        let network = GpuNetwork::new(gpu, &setup, channels, &plan, before);
        let count = setup.exemplar.len();
        let io = Io::new(gpu, &setup.exemplar_view, count);
        gpu.queue.write_buffer(&io.points, 0, bytemuck::cast_slice(&singles(&setup.exemplar)));
        let side = Evaluation::new(gpu, &network, &setup, &setup.exemplar_view, [count, count], &io, None);
        let staging = Readback::new(gpu, side.normalizations[0].moments.size());
        Ok(Self {
            gpu: Arc::clone(gpu),
            phase: Phase::Exemplar { side: Box::new(side), done: 0, staging },
            setup,
            network,
            feeder: Feeder::default(),
            points,
            adam,
            iteration,
            moving_from,
            channels,
            not_finite: false,
        })
    }

    /// Hands out work or takes results, whichever can be done without waiting. At most `most` iterations more are
    /// begun than have come back.
    pub fn advance(&mut self, most: u32) -> Advance {
        self.feeder.collect(&self.gpu);
        if let Some(fault) = self.gpu.fault() {
            return Advance::Lost(GpuError::Lost(fault).to_string());
        }
        if self.not_finite {
            return Advance::NotFinite;
        }
        let outcome = match &mut self.phase {
            Phase::Exemplar { .. } => self.advance_exemplar(),
            Phase::Output(_) => self.advance_output(most),
        };
        outcome.unwrap_or_else(|error| {
            // A browser may say that a buffer is gone before it says that the device is.
            self.gpu.condemn("a buffer can't be read back");
            Advance::Lost(error.to_string())
        })
    }

    fn advance_exemplar(&mut self) -> Result<Advance, GpuError> {
        let Phase::Exemplar { side, done, staging } = &mut self.phase else { return Ok(Advance::Waiting) };
        let gpu = &self.gpu;
        if *done < side.program.len() {
            if !self.feeder.has_room() {
                return Ok(Advance::Waiting);
            }
            let moments = &side.normalizations[0].moments;
            *done = self.feeder.feed(gpu, &side.program, 1, *done, |encoder| {
                encoder.copy_buffer_to_buffer(moments, 0, &staging.buffer, 0, moments.size());
            });
            if *done == side.program.len() {
                staging.request(gpu);
            }
            return Ok(Advance::Working);
        }
        let Some(bytes) = staging.take() else { return Ok(Advance::Waiting) };
        // Four means and four inverse deviations take turns.
        let moments = numbers(&bytes?);
        let inverses = moments.chunks_exact(8).flat_map(|quad| &quad[4..]).take(self.channels).copied();
        if cpu::is_flat(&inverses.collect::<Vec<f32>>()) {
            return Ok(Advance::Flat);
        }
        let targets = side.targets();
        let view = &self.setup.output_view;
        let count = self.points.len();
        let io = Io::new(gpu, view, count);
        gpu.queue.write_buffer(&io.points, 0, bytemuck::cast_slice(&singles(&self.points)));
        let moments: Vec<[f32; 4]> = (self.adam.first.iter().zip(&self.adam.second))
            .map(|(first, second)| [first.x as f32, first.y as f32, second.x as f32, second.y as f32])
            .collect();
        gpu.queue.write_buffer(&io.moments, 0, bytemuck::cast_slice(&moments));
        let side =
            Evaluation::new(gpu, &self.network, &self.setup, view, [count, self.moving_from], &io, Some(&targets));
        let moving = count - self.moving_from;
        let staged = staged(&io, self.moving_from, moving).iter().map(|(_, _, bytes)| bytes).sum();
        self.phase = Phase::Output(Box::new(Output {
            side,
            io,
            feeding: None,
            batches: VecDeque::new(),
            spare: (0..MOST_BATCHES).map(|_| Readback::new(gpu, staged)).collect(),
            handed_out: self.iteration,
            steps: self.adam.steps,
        }));
        Ok(Advance::Working)
    }

    fn advance_output(&mut self, most: u32) -> Result<Advance, GpuError> {
        let Phase::Output(output) = &mut self.phase else { return Ok(Advance::Waiting) };
        if let Some(bytes) = output.batches.front().and_then(|batch| batch.staging.take()) {
            let batch = output.batches.pop_front();
            return self.take_batch(batch, &bytes?);
        }
        let gpu = &self.gpu;
        if !self.feeder.has_room() {
            return Ok(Advance::Waiting);
        }
        if output.feeding.is_none() {
            let ahead = output.handed_out - self.iteration;
            let allowed = most.saturating_sub(ahead) as usize;
            let Some(staging) = (if allowed > 0 { output.spare.pop() } else { None }) else {
                return Ok(Advance::Waiting);
            };
            output.feeding = Some((output.begin_batch(gpu, &self.setup, allowed, staging), 0));
        }
        let Some((batch, done)) = output.feeding.take() else { return Ok(Advance::Waiting) };
        let (program, io) = (&output.side.program, &output.io);
        let moving = self.points.len() - self.moving_from;
        let next = self.feeder.feed(gpu, program, batch.iterations, done, |encoder| {
            let mut at = 0;
            for (buffer, from, bytes) in staged(io, self.moving_from, moving) {
                if bytes > 0 {
                    encoder.copy_buffer_to_buffer(buffer, from, &batch.staging.buffer, at, bytes);
                }
                at += bytes;
            }
        });
        if next == program.len() * batch.iterations {
            batch.staging.request(gpu);
            output.batches.push_back(batch);
        } else {
            output.feeding = Some((batch, next));
        }
        Ok(Advance::Working)
    }

    /// Takes what came back of a batch.
    fn take_batch(&mut self, batch: Option<Batch>, bytes: &[u8]) -> Result<Advance, GpuError> {
        let Some(batch) = batch else { return Ok(Advance::Waiting) };
        let moving = self.points.len() - self.moving_from;
        let values = numbers(bytes);
        let (points, rest) = values.split_at(2 * moving);
        let (moments, rest) = rest.split_at(4 * moving);
        let (losses, progress) = rest.split_at(4 * LONGEST_BATCH);
        let failed = progress.get(1).map_or(0, |number| number.to_bits()) as usize;
        // The iterations before the one that failed are good, and nothing moved since.
        let good = if failed > 0 { failed - 1 } else { batch.iterations };
        if good > 0 {
            self.keep(points, moments);
        }
        self.adam.steps += good as u32;
        self.iteration += good as u32;
        if let Phase::Output(output) = &mut self.phase {
            output.spare.push(batch.staging);
        }
        let losses: Vec<LossTerms> = losses.chunks_exact(4).take(good).map(terms).collect();
        self.not_finite = failed > 0;
        Ok(if losses.is_empty() { Advance::NotFinite } else { Advance::Iterated(losses) })
    }

    /// Keeps positions and moments that came back.
    fn keep(&mut self, points: &[f32], moments: &[f32]) {
        let size = self.setup.output_size;
        for (point, value) in self.points[self.moving_from..].iter_mut().zip(points.chunks_exact(2)) {
            // The device's side of the domain may be larger by a rounding.
            *point = DVec2::new(value[0].into(), value[1].into()).min(size);
        }
        for ((first, second), value) in
            self.adam.first.iter_mut().zip(&mut self.adam.second).zip(moments.chunks_exact(4))
        {
            *first = DVec2::new(value[0].into(), value[1].into());
            *second = DVec2::new(value[2].into(), value[3].into());
        }
    }

    /// Iterations that have begun but not come back.
    #[must_use]
    pub fn ahead(&self) -> u32 {
        match &self.phase {
            Phase::Output(output) => output.handed_out - self.iteration,
            Phase::Exemplar { .. } => 0,
        }
    }

    /// The device it runs on.
    #[must_use]
    pub fn gpu(&self) -> &Arc<Gpu> {
        &self.gpu
    }

    /// Waits until the device has done something; the whole program waits.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn wait(&self) {
        self.feeder.wait(&self.gpu);
    }

    /// The output's points as they last came back, in exemplar units.
    #[must_use]
    pub fn points(&self) -> &[DVec2] {
        &self.points
    }

    /// The moments of the moving points, likewise.
    #[must_use]
    pub fn adam(&self) -> &Adam {
        &self.adam
    }

    /// The filters, for the next scale.
    #[must_use]
    pub fn into_network(self) -> Arc<GpuNetwork> {
        self.network
    }
}

impl Output {
    /// Prepares up to `allowed` iterations: their jitter and corrections go to the device.
    fn begin_batch(&mut self, gpu: &Gpu, setup: &ScaleSetup, allowed: usize, staging: Readback) -> Batch {
        let cost: f64 = self.side.program.iter().map(|dispatch| dispatch.cost).sum();
        // As many as people see as one, and no more than to the next test of convergence.
        let fluent = (gpu.work_in(SUBMISSION_SECONDS) / cost) as usize;
        let to_test = LONGEST_BATCH - self.handed_out as usize % LONGEST_BATCH;
        let iterations = fluent.clamp(1, to_test).min(allowed.max(1));
        let len = jitter_len(&setup.output_view);
        let mut shifts = Vec::with_capacity(iterations * len);
        let mut corrections = Vec::with_capacity(iterations);
        for index in 0..iterations as u32 {
            shifts.extend(cpu::shifts(setup, self.handed_out + index).take(len).map(|shift| shift as f32));
            corrections.push(correction(self.steps + index + 1).map(|value| value as f32));
        }
        gpu.queue.write_buffer(&self.io.shifts, 0, bytemuck::cast_slice(&shifts));
        gpu.queue.write_buffer(&self.io.corrections, 0, bytemuck::cast_slice(&corrections));
        // Only the slot: what failed stays failed.
        gpu.queue.write_buffer(&self.io.progress, 0, &[0; 4]);
        self.handed_out += iterations as u32;
        self.steps += iterations as u32;
        Batch { iterations, staging }
    }
}

fn allowance(gpu: &Gpu, total: u64) -> Allowance {
    let limits = gpu.limits();
    Allowance {
        buffer: limits.max_storage_buffer_binding_size.min(limits.max_buffer_size),
        total,
        tiles: gpu.options.tiles_a_pass.unwrap_or(usize::MAX),
    }
}

/// What comes back of a batch, in this order: buffer, first byte, bytes.
fn staged(io: &Io, first: usize, moving: usize) -> [(&wgpu::Buffer, u64, u64); 4] {
    let (first, moving) = (first as u64, moving as u64);
    [
        (&io.points, 8 * first, 8 * moving),
        (&io.moments, 0, 16 * moving),
        (&io.losses, 0, 16 * LONGEST_BATCH as u64),
        (&io.progress, 0, 16),
    ]
}

/// Little-endian 32-bit numbers.
fn numbers(bytes: &[u8]) -> Vec<f32> {
    bytes.chunks_exact(4).map(|word| f32::from_le_bytes([word[0], word[1], word[2], word[3]])).collect()
}

fn singles(points: &[DVec2]) -> Vec<[f32; 2]> {
    points.iter().map(|point| point.as_vec2().into()).collect()
}

fn terms(values: &[f32]) -> LossTerms {
    let wide = |index: usize| f64::from(values[index]);
    LossTerms { gram: [wide(0), wide(1), wide(2)], correlation: wide(3) }
}
