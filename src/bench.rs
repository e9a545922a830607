//! One iteration of the method, timed: the same work on the command line and in the browser.

use std::collections::BTreeMap;
#[cfg(not(target_arch = "wasm32"))]
use std::sync::Arc;
#[cfg(not(target_arch = "wasm32"))]
use std::time::Instant;

use glam::DVec2;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::Boundary;
#[cfg(not(target_arch = "wasm32"))]
use crate::engine::FilterBank;
use crate::engine::LossTerms;
use crate::engine::cpu::CpuEngine;
use crate::engine::cpu::adam::Adam;
use crate::engine::gpu::GpuError;
use crate::engine::view::Stage;
use crate::engine::view::direct_operations;
use crate::engine::{Advance, ScaleSetup};
#[cfg(not(target_arch = "wasm32"))]
use crate::engine::{
    cpu::{convolution::Geometry, lanes::padded},
    gpu::{Gpu, GpuEngine, timing::Direct},
};
use crate::methods::network::schedule::Scale;
use crate::methods::network::{Parameters, Preset};
use crate::parallel;
use crate::sampling::{Purpose, Rng, poisson_disk};

/// Size of the work. The defaults are the paper's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Workload {
    /// Columns and rows of the output's sampling grid.
    pub grid: [usize; 2],
    /// Pixels along a side of the exemplar's grid.
    pub exemplar_grid: usize,
    /// Output channels of every random convolution.
    pub channels: usize,
    /// Points of the output.
    pub points: usize,
    /// Timed iterations, after one that is not.
    pub iterations: usize,
}

impl Default for Workload {
    fn default() -> Self {
        Self { grid: [256, 256], exemplar_grid: 128, channels: 120, points: 256, iterations: 5 }
    }
}

/// A workload outside what can be run.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("'{name}' is {value}, but must lie between {min} and {max}")]
pub struct WorkloadError {
    /// Which number.
    pub name: &'static str,
    /// Its value.
    pub value: usize,
    /// Least allowed.
    pub min: usize,
    /// Most allowed.
    pub max: usize,
}

/// Why nothing was measured.
#[derive(Debug, Error)]
pub enum BenchError {
    /// A workload outside what can be run.
    #[error(transparent)]
    Workload(#[from] WorkloadError),
    /// The device can't do it.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// What was measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Median over the timed iterations.
    pub seconds_per_iteration: f64,
    /// Mean seconds an iteration spends in each stage.
    pub stages: BTreeMap<&'static str, f64>,
    /// The longest single step: how long a pause or a cancel may have to wait.
    pub longest_step_seconds: f64,
    /// Operations of the same convolutions done directly, forward and gradient, per second: the rate a plain kernel
    /// would need to keep up.
    pub effective_gflops: f64,
    /// What computed.
    pub engine: String,
    /// Threads in use.
    pub threads: usize,
    /// What only a GPU tells.
    pub gpu: Option<GpuReport>,
    /// What the run allocates by its own estimate, in MB.
    pub estimated_mb: f64,
    /// Loss of the last iteration, so that no one can skip the work.
    pub loss: f64,
    /// The workload.
    pub workload: Workload,
}

/// Rates of a GPU's kernels.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GpuReport {
    /// Operations a second of the products of matrices in the Fourier domain, as done.
    pub product_gflops: f64,
    /// Operations a second of all convolutions, as if done directly.
    pub convolution_gflops: f64,
    /// Seconds of the second layer's convolution, forward, through transforms of tiles.
    pub tiles_seconds: f64,
    /// Seconds of the same convolution done directly.
    pub direct_seconds: f64,
}

/// The scale that `workload` asks for, and the points of its output.
fn prepare(workload: &Workload) -> Result<(ScaleSetup, Vec<DVec2>), WorkloadError> {
    let Workload { grid, exemplar_grid, channels, points, iterations } = *workload;
    for (name, value, min, max) in [
        ("grid", grid[0].min(grid[1]), 8, 4096),
        ("grid", grid[0].max(grid[1]), 8, 4096),
        ("exemplarGrid", exemplar_grid, 8, 4096),
        ("channels", channels, 1, 512),
        ("points", points, 1, 20_000),
        ("iterations", iterations, 1, 100_000),
    ] {
        if !(min..=max).contains(&value) {
            return Err(WorkloadError { name, value, min, max });
        }
    }
    let output_size = DVec2::new(grid[0] as f64, grid[1] as f64) / exemplar_grid as f64;
    let area = output_size.x * output_size.y;
    let parameters = Parameters { channels: channels as u32, ..Parameters::preset(Preset::Paper) };
    let exemplar_points = ((points as f64 / area).round() as usize).max(2);
    let start = |class, size, count| poisson_disk(&mut Rng::new(1, Purpose::Start(class)), size, count, Boundary::Open);
    // The finest σ of an evenly spread pattern of this density, where the last and longest scales are spent.
    let spacing = 0.7 * (1.0 / exemplar_points as f64).sqrt();
    let scale = Scale {
        sigma: spacing / parameters.sigma_fine_divisor,
        resolution: exemplar_grid as f64,
        learning_rate: 0.004,
        iterations: iterations as u32 + 1,
    };
    let setup = ScaleSetup::new(
        &parameters.scale_settings(&scale, (0, 0)),
        start(1, DVec2::ONE, exemplar_points),
        DVec2::ONE,
        Boundary::Open,
        output_size,
    );
    Ok((setup, start(0, output_size, points)))
}

/// Times `workload` on the processor; `now` gives seconds on any clock.
///
/// # Errors
/// When a number of the workload is out of range.
pub fn run(workload: &Workload, now: &dyn Fn() -> f64) -> Result<Report, WorkloadError> {
    let Workload { grid, channels, points, iterations, .. } = *workload;
    let (setup, positions) = prepare(workload)?;
    let estimated_mb = CpuEngine::bytes_for(&setup, channels, points) as f64 / 1e6;
    let network = CpuEngine::network(&setup, channels, None);
    let mut engine = CpuEngine::new(setup, network, positions, 0, Adam::new(points), 0);

    let mut stages: BTreeMap<&'static str, f64> = BTreeMap::new();
    let mut seconds = Vec::with_capacity(iterations);
    let mut loss = f64::NAN;
    let (mut warm, mut spent, mut longest) = (false, 0.0, 0.0_f64);
    while seconds.len() < iterations {
        let stage = engine.stage();
        let before = now();
        let advance = engine.advance();
        let took = now() - before;
        spent += took;
        longest = longest.max(took);
        if warm && let Some(stage) = stage {
            *stages.entry(stage.name()).or_default() += took / iterations as f64;
        }
        match advance {
            Advance::Working | Advance::Waiting => {}
            Advance::Iterated(terms) => {
                loss = terms.last().map_or(f64::NAN, LossTerms::total);
                if warm {
                    seconds.push(spent);
                }
                warm = true;
                spent = 0.0;
            }
            Advance::Flat | Advance::NotFinite | Advance::Lost(_) => break,
        }
    }
    crate::sorting::ascending(&mut seconds);
    let median = seconds.get(seconds.len() / 2).copied().unwrap_or(f64::NAN);
    Ok(Report {
        seconds_per_iteration: median,
        stages,
        longest_step_seconds: longest,
        effective_gflops: direct_operations(grid.map(|side| side as f64), channels as f64) / median / 1e9,
        engine: format!("CPU, {} threads", parallel::threads()),
        threads: parallel::threads(),
        gpu: None,
        estimated_mb,
        loss,
        workload: workload.clone(),
    })
}

/// Times `workload` on a device.
///
/// # Errors
/// When a number of the workload is out of range, or the device has no room for it or fails.
#[cfg(not(target_arch = "wasm32"))]
pub fn run_on_gpu(workload: &Workload, gpu: &Arc<Gpu>, memory: u64) -> Result<Report, BenchError> {
    let Workload { grid, channels, points, iterations, .. } = *workload;
    let (setup, positions) = prepare(workload)?;
    let estimated_mb = GpuEngine::bytes_for(gpu, &setup, channels, points, memory)? as f64 / 1e6;
    let geometry = Geometry { height: grid[1], width: grid[0], stride: 1, boundary: Boundary::Open };
    let seed = setup.seed;
    let mut engine = GpuEngine::new(gpu, setup, channels, None, positions, 0, Adam::new(points), 0, memory)?;
    let mut done = 0;
    let mut spent = Vec::with_capacity(iterations);
    let mut loss = f64::NAN;
    let mut start = Instant::now();
    while done <= iterations {
        // One at first, until the pace is known; then as a run would.
        let most = if done == 0 { 1 } else { (iterations + 1 - done) as u32 };
        match engine.advance(most) {
            Advance::Working => {}
            Advance::Waiting => engine.wait(),
            Advance::Iterated(terms) => {
                if done > 0 {
                    spent.extend(terms.iter().map(|_| start.elapsed().as_secs_f64() / terms.len() as f64));
                }
                done += terms.len();
                loss = terms.last().map_or(f64::NAN, LossTerms::total);
                start = Instant::now();
            }
            Advance::Lost(reason) => return Err(GpuError::Lost(reason).into()),
            Advance::Flat | Advance::NotFinite => break,
        }
    }
    let mean = spent.iter().sum::<f64>() / spent.len() as f64;
    let timing = engine.time()?;
    let bank = FilterBank::random(seed, channels);
    let mut rng = Rng::new(seed, Purpose::Gallery);
    let image: Vec<f32> = (0..grid[0] * grid[1] * padded(channels)).map(|_| rng.range(-1.0, 1.0) as f32).collect();
    let direct_seconds = Direct::new(gpu, geometry, channels, &bank.layers[1], &image).seconds()?;
    let direct = direct_operations(grid.map(|side| side as f64), channels as f64);
    let of = |stage: Stage| timing.stages.get(stage.name()).copied().unwrap_or(0.0);
    let convolutions = of(Stage::Convolution) + of(Stage::ConvolutionGradient);
    Ok(Report {
        seconds_per_iteration: mean,
        longest_step_seconds: timing.longest,
        stages: timing.stages,
        effective_gflops: direct / mean / 1e9,
        engine: gpu.info().name.clone(),
        threads: 0,
        gpu: Some(GpuReport {
            product_gflops: timing.product.1 / timing.product.0 / 1e9,
            convolution_gflops: direct / convolutions / 1e9,
            tiles_seconds: timing.second_layer,
            direct_seconds,
        }),
        estimated_mb,
        loss,
        workload: workload.clone(),
    })
}

/// All stage names in their order, for tables.
#[must_use]
pub fn stage_names() -> Vec<&'static str> {
    Stage::ALL.iter().map(|stage| stage.name()).collect()
}
