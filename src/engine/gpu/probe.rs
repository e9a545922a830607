//! Does this device compute the right numbers? Every kernel runs a small case and is compared with its CPU twin.
//!
//! Both sides round to single precision, in different orders. An error is given relative to the largest number of an
//! array, and a few numbers in a thousand may be off by more: a pixel whose activation is zero to within a rounding
//! may pass the ReLU on one side and not on the other.

use std::sync::Arc;

use glam::DVec2;

use super::device::{Gpu, GpuError, OpenOptions};
use super::kernel::Dispatch;
use super::network::{Evaluation, GpuNetwork, Io};
use super::plan::Plan;
use super::{Feeder, Readback, allowance, numbers, singles, terms};
use crate::engine::cpu::adam::{Adam, correction};
use crate::engine::cpu::lanes::{LANES, padded};
use crate::engine::cpu::network as cpu;
use crate::engine::cpu::{Float, shifts};
use crate::engine::view::Stage;
use crate::engine::{Bands, FilterBank, ScaleSettings, ScaleSetup, Weights};
use crate::pattern::Boundary;
use crate::sampling::{Purpose, Rng, white_noise};

/// Sums of a few thousand products in single precision, in another order and with exponentials good to a few digits
/// in the last place. Found on a processor that plays a GPU: up to 1.1e-6.
const FORWARD: f64 = 2e-5;
/// Gradients are sums that cancel, and each layer divides by a deviation. Found: up to 2.4e-6.
const BACKWARD: f64 = 1e-4;

/// A small piece of work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case {
    /// Channels of every layer.
    pub channels: usize,
    /// Pixels an exemplar unit.
    pub resolution: usize,
    /// Width and height of the output in exemplar units.
    pub output: [f64; 2],
    /// Points of the exemplar.
    pub points: usize,
    /// What lies beyond the border, on both sides.
    pub boundary: Boundary,
    /// The bands of maps; with more than one, points have weights of all signs, and some have none.
    pub bands: Bands,
}

impl Case {
    /// What every visitor's device has to get right before it is used: uneven sizes, several tiles, padded channels,
    /// in a tile also weights, in bands of all kinds.
    #[must_use]
    pub fn small(boundary: Boundary) -> Self {
        let bands = match boundary {
            Boundary::Open => Bands::default(),
            Boundary::Periodic => Bands { lone: true, full: 1, waves: 1 },
        };
        Self { channels: 7, resolution: 24, output: [1.5, 1.0], points: 12, boundary, bands }
    }

    /// How many points the output has.
    fn count(&self) -> usize {
        ((self.points as f64 * self.output[0] * self.output[1]) as usize).max(1)
    }

    fn weights(&self, points: usize) -> Weights {
        if self.bands == Bands::default() {
            return Weights::default();
        }
        let mut rng = Rng::new(11, Purpose::Gallery);
        let mut weight = || (rng.range(-1.0, 1.2) * 4.0).round() / 4.0;
        Weights::new(self.bands, (0..points * self.bands.count()).map(|_| weight()).collect())
    }

    fn setup(&self) -> ScaleSetup {
        let settings = ScaleSettings {
            boundary: self.boundary,
            sigma: 0.1,
            frequency: 1.5,
            resolution: self.resolution as f64,
            margin_sigmas: 1.0,
            weights: [0.08, 1.0],
            learning_rate: 0.01,
            jitter_px: 1.0,
            seed: 1,
            class: 0,
            scale: 0,
        };
        let exemplar = white_noise(&mut Rng::new(7, Purpose::Gallery), DVec2::ONE, self.points);
        let output = DVec2::from(self.output);
        ScaleSetup {
            exemplar_weights: self.weights(self.points),
            output_weights: self.weights(self.count()),
            ..ScaleSetup::new(&settings, exemplar, DVec2::ONE, self.boundary, output)
        }
    }
}

/// How far one array of a stage is from its twin's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// What it holds.
    pub what: &'static str,
    /// The error that all but a few in a thousand numbers stay below, relative to the largest number.
    pub error: f64,
    /// What is allowed.
    pub tolerance: f64,
}

impl Deviation {
    fn new(what: &'static str, ours: &[f32], twin: impl IntoIterator<Item = f64>, tolerance: f64) -> Self {
        Self::between(what, ours, twin.into_iter().collect(), tolerance)
    }

    #[inline(never)]
    fn between(what: &'static str, ours: &[f32], twin: Vec<f64>, tolerance: f64) -> Self {
        let mut largest = f64::MIN_POSITIVE;
        let mut errors: Vec<f64> = ours
            .iter()
            .zip(twin)
            .map(|(&ours, twin)| {
                largest = largest.max(twin.abs());
                let error = (f64::from(ours) - twin).abs();
                // NaN must not slip through a comparison.
                if error.is_finite() { error } else { f64::INFINITY }
            })
            .collect();
        crate::sorting::ascending(&mut errors);
        // Two numbers, or two in a thousand, may be on the other side of the ReLU.
        let strays = (errors.len() / 500).max(2).min(errors.len() / 8);
        let worst = errors.len().checked_sub(1 + strays).and_then(|index| errors.get(index));
        Self { what, error: worst.copied().unwrap_or(f64::INFINITY) / largest, tolerance }
    }

    /// Whether it is within what is allowed.
    #[must_use]
    pub fn is_fine(&self) -> bool {
        self.error <= self.tolerance
    }
}

/// Runs dispatches to their end.
async fn run(gpu: &Gpu, program: &[Dispatch]) -> Result<(), GpuError> {
    let mut feeder = Feeder::default();
    let mut done = 0;
    while done < program.len() || !feeder.in_flight.is_empty() {
        let report = gpu.report();
        feeder.collect(gpu);
        if let Some(fault) = gpu.fault() {
            return Err(GpuError::Lost(fault));
        }
        if done < program.len() && feeder.has_room() {
            done = feeder.feed(gpu, program, 1, done, |_| {});
        } else if !feeder.in_flight.is_empty() {
            #[cfg(not(target_arch = "wasm32"))]
            feeder.wait(gpu);
            #[cfg(target_arch = "wasm32")]
            report.await;
            #[cfg(not(target_arch = "wasm32"))]
            drop(report);
        }
    }
    Ok(())
}

/// Reads the first bytes of a buffer.
pub(super) async fn read(gpu: &Gpu, buffer: &wgpu::Buffer, count: usize) -> Result<Vec<f32>, GpuError> {
    let bytes = (4 * count) as u64;
    let staging = Readback::new(gpu, bytes);
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &staging.buffer, 0, bytes);
    let index = gpu.queue.submit([encoder.finish()]);
    staging.request(gpu);
    loop {
        let report = gpu.report();
        if let Some(bytes) = staging.take() {
            return bytes.map(|bytes| numbers(&bytes));
        }
        if let Some(fault) = gpu.fault() {
            return Err(GpuError::Lost(fault));
        }
        #[cfg(not(target_arch = "wasm32"))]
        {
            gpu.wait_for(&index);
            drop(report);
        }
        #[cfg(target_arch = "wasm32")]
        {
            let _ = &index;
            report.await;
        }
    }
}

/// A stage of the method on both sides: names of its arrays for messages.
const IMAGES: [&str; 4] = ["convolution 1", "convolution 2", "convolution 3", "convolution 4"];
const MOMENTS: [&str; 4] = ["normalization 1", "normalization 2", "normalization 3", "normalization 4"];
const GRAMS: [&str; 3] = ["Gram matrix 2", "Gram matrix 3", "Gram matrix 4"];
const GRADIENTS: [&str; 5] = [
    "gradient of layer 4",
    "gradient of layer 3",
    "gradient of layer 2",
    "gradient of layer 1",
    "gradient of the maps",
];

/// Runs `case` on the device and on the CPU and compares every stage, forward and backward.
///
/// # Errors
/// When the device fails, or has no room for the case.
pub async fn compare(gpu: &Arc<Gpu>, case: Case) -> Result<Vec<Deviation>, GpuError> {
    let setup = case.setup();
    let Case { channels, boundary, bands, .. } = case;
    let outputs = padded(channels);
    let count = case.count();
    let points = white_noise(&mut Rng::new(3, Purpose::Gallery), setup.output_size, count);
    // Some are frozen.
    let first = count / 4;

    // The CPU's side.
    let grid = setup.output_view.grid;
    let bank = FilterBank::for_bands(setup.seed, channels, bands);
    let tiles = cpu::best_tiles(channels, grid.height, grid.width, boundary, bands);
    let network = Arc::new(cpu::Network::<Float>::new(&bank, tiles));
    let see = |points: &[DVec2]| points.iter().map(|point| point + setup.margin).collect::<Vec<_>>();
    let ScaleSetup { exemplar_view, output_view, lags, weights, exemplar_weights, output_weights, .. } = &setup;
    let (lags, weights) = (*lags, *weights);
    let side = Arc::clone(&network);
    let mut exemplar = cpu::Evaluation::new(side, exemplar_view, case.points, lags, false, weights, exemplar_weights);
    let seen = see(&setup.exemplar);
    while !exemplar.advance(&seen, None) {}
    let targets = exemplar.targets(lags);
    let mut output = cpu::Evaluation::new(network, output_view, count, lags, true, weights, output_weights);
    for (shift, value) in output.shifts_mut().iter_mut().flatten().zip(shifts(&setup, 0)) {
        *shift = value;
    }
    let seen = see(&points);
    let mut gradients = Vec::new();
    loop {
        let stage = output.stage();
        let through = output.advance(&seen, Some(&targets));
        if stage == Stage::NormalizationGradient {
            gradients.push(output.gradient().to_vec());
        }
        if through {
            break;
        }
    }
    gradients.push(output.gradient().to_vec());

    // The device's side.
    let allowed = allowance(gpu, u64::MAX);
    let plan = Plan::new(&setup, channels, count, allowed)?;
    let device_network = GpuNetwork::new(gpu, &setup, channels, &plan, None);
    let io = Io::new(gpu, &setup.exemplar_view, case.points);
    gpu.queue.write_buffer(&io.points, 0, bytemuck::cast_slice(&singles(&setup.exemplar)));
    let all = [case.points, case.points];
    let side = Evaluation::new(gpu, &device_network, &setup, &setup.exemplar_view, all, &io, None);
    run(gpu, &side.program).await?;
    let device_targets = side.targets();
    let mut found = Vec::new();
    for (what, (buffer, twin)) in ["exemplar's Gram matrix 2", "exemplar's Gram matrix 3", "exemplar's Gram matrix 4"]
        .into_iter()
        .zip(device_targets.grams.iter().zip(&targets.grams))
    {
        found.push(Deviation::new(what, &read(gpu, buffer, outputs * outputs).await?, twin.iter().copied(), FORWARD));
    }
    let wide = |values: &[f32]| values.iter().copied().map(f64::from).collect::<Vec<f64>>();
    let ours = read(gpu, &device_targets.correlations, targets.correlations.len()).await?;
    found.push(Deviation::new("exemplar's autocorrelation", &ours, wide(&targets.correlations), FORWARD));

    let io = Io::new(gpu, &setup.output_view, count);
    gpu.queue.write_buffer(&io.points, 0, bytemuck::cast_slice(&singles(&points)));
    let shifts: Vec<f32> = shifts(&setup, 0).take(grid.height + grid.width).map(|shift| shift as f32).collect();
    gpu.queue.write_buffer(&io.shifts, 0, bytemuck::cast_slice(&shifts));
    gpu.queue.write_buffer(&io.corrections, 0, bytemuck::cast_slice(&correction(1).map(|value| value as f32)));
    let side =
        Evaluation::new(gpu, &device_network, &setup, &setup.output_view, [count, first], &io, Some(&device_targets));
    let mut done = 0;
    for (index, (checkpoint, buffer)) in side.checkpoints.iter().enumerate() {
        run(gpu, &side.program[done..*checkpoint]).await?;
        done = *checkpoint;
        if index == 0 {
            forward_deviations(gpu, &side, &output, &mut found).await?;
        }
        let len = if index < 4 { output.image(3 - index).0.len() } else { output.maps().len() };
        let twin = &gradients[index][..len];
        found.push(Deviation::new(GRADIENTS[index], &read(gpu, buffer, len).await?, wide(twin), BACKWARD));
    }
    run(gpu, &side.program[done..]).await?;

    let moving = count - first;
    let ours = read(gpu, &io.gradients, 2 * moving).await?;
    let twin: Vec<f64> = output.point_gradients(first).iter().flatten().copied().collect();
    found.push(Deviation::new("gradient of the points", &ours, twin, BACKWARD));
    let device_loss = terms(&read(gpu, &io.losses, 4).await?);
    let loss = output.loss();
    let both = |loss: &crate::engine::LossTerms| [loss.gram[0], loss.gram[1], loss.gram[2], loss.correlation];
    let ours = both(&device_loss).map(|value| value as f32);
    found.push(Deviation::new("loss", &ours, both(&loss), FORWARD));

    // Adam from the device's own gradients: its first steps turn the rounding of a small one into a full step.
    let device_gradients: Vec<[f64; 2]> =
        read(gpu, &io.gradients, 2 * moving).await?.chunks_exact(2).map(|g| [g[0].into(), g[1].into()]).collect();
    let mut adam = Adam::new(moving);
    let mut moved = points[first..].to_vec();
    adam.step(&mut moved, &device_gradients, setup.learning_rate);
    for point in &mut moved {
        *point = crate::pattern::keep_inside(*point, setup.output_size, boundary);
    }
    let before = points.iter().flat_map(|point| point.to_array());
    let after = points[..first].iter().chain(&moved).flat_map(|point| point.to_array());
    let ours: Vec<f32> = read(gpu, &io.points, 2 * count)
        .await?
        .iter()
        .zip(before.clone())
        .map(|(after, before)| (f64::from(*after) - before) as f32)
        .collect();
    // In single precision a position is good to 1e-7, a hundred thousandth of a step.
    found.push(Deviation::new("step of Adam", &ours, after.zip(before).map(|(after, before)| after - before), 1e-4));
    Ok(found)
}

/// Everything up to the loss.
async fn forward_deviations(
    gpu: &Gpu,
    side: &Evaluation,
    twin: &cpu::Evaluation<Float>,
    found: &mut Vec<Deviation>,
) -> Result<(), GpuError> {
    let wide = |values: &[f32]| values.iter().copied().map(f64::from).collect::<Vec<f64>>();
    let ours = read(gpu, &side.gabor.maps, twin.maps().len()).await?;
    found.push(Deviation::new("Gabor maps", &ours, wide(twin.maps()), FORWARD));
    for layer in 0..4 {
        let (image, statistics) = twin.image(layer);
        let ours = read(gpu, &side.images[layer], image.len()).await?;
        found.push(Deviation::new(IMAGES[layer], &ours, wide(image), FORWARD));
        let channels = statistics.mean.len();
        let ours = read(gpu, &side.normalizations[layer].moments, 2 * channels).await?;
        // Means and inverse deviations have magnitudes of their own.
        let mean = |values: &[f32]| values.chunks_exact(8).flat_map(|quad| quad[..4].to_vec()).collect::<Vec<f32>>();
        let inverse = |values: &[f32]| values.chunks_exact(8).flat_map(|quad| quad[4..].to_vec()).collect::<Vec<f32>>();
        let means = Deviation::new(MOMENTS[layer], &mean(&ours), wide(&statistics.mean), FORWARD);
        let inverses = Deviation::new(MOMENTS[layer], &inverse(&ours), wide(&statistics.inverse_deviation), FORWARD);
        found.push(if means.error > inverses.error { means } else { inverses });
    }
    for (gram, what) in GRAMS.into_iter().enumerate() {
        let matrix = twin.gram(gram);
        let ours = read(gpu, &side.grams[gram].matrix, matrix.len()).await?;
        found.push(Deviation::new(what, &ours, matrix.iter().copied(), FORWARD));
    }
    let values = twin.correlations();
    let ours = read(gpu, &side.correlation.values, values.len()).await?;
    found.push(Deviation::new("autocorrelation", &ours, wide(values), FORWARD));
    debug_assert!(twin.maps().len().is_multiple_of(LANES));
    Ok(())
}

/// Opens the device that the system recommends, and hands it out only if it gets everything right.
///
/// # Errors
/// Those of [`Gpu::open`] and [`probe`].
pub async fn open() -> Result<Arc<Gpu>, GpuError> {
    let gpu = Gpu::open(OpenOptions::default()).await?;
    probe(&gpu).await?;
    Ok(gpu)
}

/// Whether this device gets everything right: a window and a tile, every kernel.
///
/// # Errors
/// When it fails or a number is wrong.
pub async fn probe(gpu: &Arc<Gpu>) -> Result<(), GpuError> {
    for boundary in [Boundary::Open, Boundary::Periodic] {
        for Deviation { what, error, tolerance } in compare(gpu, Case::small(boundary)).await? {
            if error.is_nan() || error > tolerance {
                return Err(GpuError::Wrong { what, error, tolerance });
            }
        }
    }
    Ok(())
}
