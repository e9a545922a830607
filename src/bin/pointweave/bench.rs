//! `pointweave bench`: seconds per iteration and where they go.

use std::time::Instant;

use clap::Args;
use pointweave::bench::{BenchError, Report, Workload, run as measure, run_on_gpu, stage_names};

use crate::device::{self, DEVICE_MEMORY, EngineArgument};
use crate::failure::Failure;
use crate::memory;

/// Times one iteration of the method, stage by stage
///
/// The defaults are the sizes of the Paper preset at twice the exemplar: a 256 × 256 grid, 120 channels.
#[derive(Debug, Args)]
pub(crate) struct BenchArguments {
    /// Columns and rows of the output's sampling grid
    #[arg(long, value_name = "WxH", default_value = "256x256", value_parser = parse_grid)]
    grid: [usize; 2],
    /// Pixels along a side of the exemplar's grid
    #[arg(long, value_name = "N", default_value_t = 128)]
    exemplar_grid: usize,
    /// Output channels of every random convolution
    #[arg(long, value_name = "N", default_value_t = 120)]
    channels: usize,
    /// Points of the output
    #[arg(long, value_name = "N", default_value_t = 256)]
    points: usize,
    /// Timed iterations, after one that is not
    #[arg(long, value_name = "N", default_value_t = 5)]
    iterations: usize,
    /// What computes
    #[arg(long, value_enum, default_value_t = EngineArgument::Cpu)]
    engine: EngineArgument,
    /// Threads to use [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// One JSON object instead of a table
    #[arg(long)]
    json: bool,
}

fn parse_grid(text: &str) -> Result<[usize; 2], String> {
    let side = |side: &str| side.parse().ok();
    text.split_once('x')
        .and_then(|(width, height)| Some([side(width)?, side(height)?]))
        .ok_or_else(|| format!("{text:?} is not a grid; write columns and rows, as in 256x256"))
}

/// Measures and prints.
pub(crate) fn run(arguments: &BenchArguments) -> Result<(), Failure> {
    let BenchArguments { grid, exemplar_grid, channels, points, iterations, engine, threads, json } = *arguments;
    if let Some(threads) = threads {
        crate::synth::use_threads(threads)?;
    }
    let workload = Workload { grid, exemplar_grid, channels, points, iterations };
    let start = Instant::now();
    // On a thread of the pool, as `synth` does it.
    let report = match device::choose(engine)? {
        None => rayon::scope(|_| measure(&workload, &|| start.elapsed().as_secs_f64())).map_err(BenchError::from),
        Some(gpu) => run_on_gpu(&workload, &gpu, DEVICE_MEMORY),
    }
    .map_err(|error| match error {
        BenchError::Workload(error) => Failure::Usage(error.to_string()),
        BenchError::Gpu(error) => Failure::Run(error.to_string()),
    })?;
    let peak_mb = memory::peak_bytes().map(|bytes| bytes as f64 / 1e6);
    if json {
        let mut value = serde_json::to_value(&report).map_err(|error| Failure::Run(error.to_string()))?;
        value["peak_mb"] = peak_mb.into();
        println!("{value}");
    } else {
        print_table(&report, peak_mb);
    }
    Ok(())
}

fn print_table(report: &Report, peak_mb: Option<f64>) {
    let Workload { grid, exemplar_grid, channels, points, iterations } = &report.workload;
    println!(
        "grid {} × {}, exemplar grid {exemplar_grid}, {channels} channels, {points} points, {iterations} iterations, {}",
        grid[0], grid[1], report.engine
    );
    let all: f64 = report.stages.values().sum();
    for name in stage_names() {
        if let Some(seconds) = report.stages.get(name) {
            println!("{name:<34}{seconds:>10.4} s {:>6.1} %", 100.0 * seconds / all);
        }
    }
    println!("{:<34}{:>10.4} s", "iteration", report.seconds_per_iteration);
    println!("{:<34}{:>10.4} s  (a pause waits no longer)", "longest step", report.longest_step_seconds);
    println!("{:<34}{:>10.1} GFLOP/s of direct convolution", "effective rate", report.effective_gflops);
    if let Some(gpu) = &report.gpu {
        println!("{:<34}{:>10.1} GFLOP/s of direct convolution", "convolutions alone", gpu.convolution_gflops);
        println!("{:<34}{:>10.1} GFLOP/s as done", "their products of matrices", gpu.product_gflops);
        println!(
            "{:<34}{:>10.4} s through tiles, {:.4} s directly: ratio {:.2}",
            "second layer, forward",
            gpu.tiles_seconds,
            gpu.direct_seconds,
            gpu.direct_seconds / gpu.tiles_seconds
        );
    }
    print!("{:<34}{:>10.0} MB estimated", "memory", report.estimated_mb);
    match peak_mb {
        Some(peak) => println!(", {peak:.0} MB at the peak"),
        None => println!(),
    }
}
