//! The GPU engine computes what the CPU engine computes, on whatever adapter there is; no adapter is a failure.
//!
//! The sizes are small: an adapter that a processor plays does less than a billion operations a second.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail loudly")]

mod common;

use std::sync::Arc;

use glam::DVec2;
use pointweave::engine::Bands;
use pointweave::engine::cpu::adam::Adam;
use pointweave::engine::cpu::convolution::Geometry;
use pointweave::engine::gpu::probe::{Case, Deviation, compare, probe};
use pointweave::engine::gpu::timing::Direct;
use pointweave::engine::gpu::{Gpu, GpuEngine, GpuError, OpenOptions, Shader};
use pointweave::engine::{Advance, ScaleSetup};
use pointweave::methods::network::schedule::Scale;
use pointweave::methods::network::{NetworkRun, Parameters, Preset};
use pointweave::run::Event;
use pointweave::sampling::{Purpose, Rng, white_noise};
use pointweave::{Boundary, PointPattern, gallery};

const MEMORY: u64 = 2_000_000_000;

fn open_with(options: OpenOptions) -> Arc<Gpu> {
    pollster::block_on(Gpu::open(options)).expect("these tests need a Vulkan adapter; Mesa's lavapipe will do")
}

fn open() -> Arc<Gpu> {
    open_with(OpenOptions::default())
}

fn deviations(gpu: &Arc<Gpu>, case: Case) -> Vec<Deviation> {
    let found = pollster::block_on(compare(gpu, case)).unwrap();
    assert_eq!(found.len(), 25, "every stage is compared");
    found
}

#[test]
fn every_stage_matches_its_twin() {
    let gpu = open();
    let small = Case::small(Boundary::Open);
    let cases = [
        small,
        Case::small(Boundary::Periodic),
        // Weighted maps, more of them than channels; without weights in a tile.
        Case { bands: Bands { lone: false, full: 3, waves: 2 }, ..small },
        Case { bands: Bands { lone: true, full: 0, waves: 1 }, channels: 20, ..small },
        Case { bands: Bands::default(), ..Case::small(Boundary::Periodic) },
        // Windows that come around a periodic domain from both sides.
        Case { output: [0.5, 0.75], ..Case::small(Boundary::Periodic) },
        // Two blocks of channels, the last one not full.
        Case { channels: 72, output: [1.0, 1.0], resolution: 16, ..small },
        Case { points: 1, ..small },
    ];
    for case in cases {
        for deviation in deviations(&gpu, case) {
            assert!(deviation.is_fine(), "{case:?}: {deviation:?}");
        }
    }
    assert_eq!(gpu.fault(), None);
}

/// Negative controls: a kernel with one thing wrong is found, and what it computes is the first thing that differs.
#[test]
fn a_wrong_kernel_is_found_out() {
    let wrong = [
        (Shader::Gabor, "even - odd", "even + odd", "Gabor maps"),
        (Shader::Gabor, "sum.y += y.w *", "sum.y += 1.01 * y.w *", "gradient of the points"),
        (Shader::Gabor, "weight * tables[point", "tables[point", "Gabor maps"),
        (Shader::Gabor, "g.x += weight *", "g.x += 1.1 * weight *", "gradient of the points"),
        (Shader::Gabor, "fifth += weight *", "fifth +=", "gradient of the points"),
        (Shader::Convolution, "const W3 = vec2f(0.38", "const W3 = vec2f(0.39", "convolution 1"),
        (Shader::Convolution, "out.im += a_re.w * i3", "out.im -= a_re.w * i3", "convolution 1"),
        (Shader::Convolution, "shape.first + inner.y", "inner.y", "gradient of layer 3"),
        (Shader::Normalization, "const EPSILON = 1e-5", "const EPSILON = 1.1e-5", "normalization 1"),
        (Shader::Normalization, "product += g * normalized", "product += g", "gradient of layer 4"),
        (Shader::Gram, "s3 += a.w * b", "s3 += a.z * b", "Gram matrix 2"),
        (Shader::Gram, "4.0 * shape.weight", "4.2 * shape.weight", "gradient of layer 4"),
        (Shader::Correlation, "rest.x * rest.y", "plane.region.x * rest.y", "autocorrelation"),
        (Shader::Correlation, "2.0 / f32(plane.size.x", "2.1 / f32(plane.size.x", "gradient of layer 4"),
        (Shader::Adam, "const BETA2 = 0.999", "const BETA2 = 0.998", "step of Adam"),
        (Shader::Loss, "sum.w += correlation[i]", "sum.w += 1.1 * correlation[i]", "loss"),
    ];
    for (shader, piece, replacement, what) in wrong {
        let gpu = open();
        gpu.sabotage(shader, piece, replacement);
        assert_eq!(gpu.fault(), None);
        // Weights are in a tile only.
        let boundary = if piece.contains("weight *") { Boundary::Periodic } else { Boundary::Open };
        let found = deviations(&gpu, Case::small(boundary));
        // The exemplar's statistics come first, and would only say that something is wrong.
        let first = found.iter().skip(4).find(|deviation| !deviation.is_fine());
        assert_eq!(first.map(|deviation| deviation.what), Some(what), "{shader:?} {replacement:?}: {found:#?}");
        let refused = pollster::block_on(probe(&gpu)).unwrap_err();
        assert!(matches!(refused, GpuError::Wrong { .. }), "{refused}");
    }
}

#[test]
fn a_sabotage_that_hits_nothing_is_no_control() {
    let gpu = open();
    gpu.sabotage(Shader::Gram, "no such thing", "");
    assert!(gpu.fault().is_some());
}

/// All sets of constants that the host may set.
fn variants(shader: Shader) -> Vec<Vec<(&'static str, u32)>> {
    match shader {
        Shader::Convolution => [(16, 8), (32, 32), (64, 60), (64, 64)]
            .iter()
            .map(|&(tiles, channels)| {
                vec![("BLOCK_TILES", tiles), ("BLOCK_CHANNELS", channels), ("THREADS", tiles * channels / 16)]
            })
            .collect(),
        Shader::Gram => [8, 32, 60, 64].iter().map(|&block| vec![("BLOCK", block)]).collect(),
        Shader::Correlation => {
            [16, 1000].iter().map(|&length| vec![("LENGTH", length), ("LINES", 2 * length)]).collect()
        }
        _ => vec![vec![]],
    }
}

fn validate(source: &str) -> Result<naga::Module, String> {
    let module = naga::front::wgsl::parse_str(source).map_err(|error| error.emit_to_string(source))?;
    naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty())
        .validate(&module)
        .map_err(|error| error.emit_to_string(source))?;
    Ok(module)
}

#[test]
fn every_shader_is_valid_within_what_every_device_offers() {
    let limits = wgpu::Limits::defaults();
    for shader in Shader::ALL {
        for constants in variants(shader) {
            let module = validate(&shader.with_constants(&constants)).unwrap_or_else(|e| panic!("{shader:?}: {e}"));
            assert!(!module.entry_points.is_empty());
            for entry in &module.entry_points {
                let invocations: u32 = entry.workgroup_size.iter().product();
                assert!(invocations <= limits.max_compute_invocations_per_workgroup, "{shader:?} {}", entry.name);
            }
            let written = Shader::text(shader);
            assert!(!written.contains("//"), "comments don't travel");
        }
    }
    // Negative control.
    assert!(validate(&Shader::Gram.with_constants(&[])).is_err(), "a constant that is not set");
    assert!(validate("@compute @workgroup_size(1) fn f() { let x: u32 = 1.0; }").is_err());
}

/// A run small enough for a device that a processor plays.
fn tiny(name: &str, overrides: impl FnOnce(&mut Parameters)) -> NetworkRun {
    let exemplar = gallery::find(name).unwrap().exemplar();
    run_of(exemplar, overrides)
}

fn run_of(exemplar: PointPattern, overrides: impl FnOnce(&mut Parameters)) -> NetworkRun {
    let mut parameters = Parameters {
        channels: 8,
        grid_min: 24,
        grid_max: 32,
        scales: 2,
        iterations_coarse: 50,
        iterations_fine: 10,
        iterations_polish: 0,
        expansion_x: 1.0,
        expansion_y: 1.25,
        boundary: exemplar.boundary(),
        ..Parameters::suited_to(Preset::Fast, &exemplar)
    };
    overrides(&mut parameters);
    NetworkRun::new(exemplar, parameters, MEMORY).unwrap()
}

/// Losses of all iterations.
fn losses(synthesis: &mut NetworkRun) -> Vec<f64> {
    let mut losses = Vec::new();
    loop {
        match synthesis.advance().unwrap() {
            Event::Iterated { losses: terms, .. } => losses.push(terms.total()),
            Event::Waiting => synthesis.wait(),
            Event::EngineChanged { reason } => panic!("{reason}"),
            Event::Finished => return losses,
            _ => {}
        }
    }
}

/// One iteration agrees to a millionth, but Adam's first steps have the same length however small a gradient is, so
/// that differences in the last digit grow while each side goes its own way. Found: 6e-3 after 50 iterations (open).
const DRIFT_TOLERANCE: f64 = 5e-2;

#[test]
fn a_whole_synthesis_goes_the_same_way_on_both_engines() {
    let gpu = open();
    for (name, boundary) in [("rings", Boundary::Periodic), ("blue-noise", Boundary::Open)] {
        let start = || {
            tiny(name, |parameters| {
                parameters.boundary = boundary;
                // Done by the processor for both, and whole points move or don't by differences in the last digit.
                parameters.transplants = 0;
            })
        };
        let (mut on_cpu, mut on_gpu) = (start(), start());
        on_gpu.use_gpu(Some(Arc::clone(&gpu)), MEMORY);
        let (cpu, device) = (losses(&mut on_cpu), losses(&mut on_gpu));
        assert!(on_gpu.gpu().is_some(), "it stayed on the device");
        assert_eq!(cpu.len(), device.len());
        common::assert_close("first loss", &device[..1], &cpu[..1], 1e-5);
        common::assert_close("losses", &device[..50], &cpu[..50], DRIFT_TOLERANCE);
        assert!(device[49] < 0.8 * device[0], "it learns: {} to {}", device[0], device[49]);
        let spacing = |run: &NetworkRun| run.output().unwrap().mean_spacing().unwrap();
        let (a, b) = (spacing(&on_cpu), spacing(&on_gpu));
        assert!((a - b).abs() < 0.05 * a, "{name}: mean spacing {a} and {b}");
    }
}

#[test]
fn a_saved_run_goes_on_to_the_same_bits_and_so_does_one_in_steps() {
    let gpu = open();
    let start = || {
        let mut run = tiny("rings", |parameters| parameters.iterations_coarse = 14);
        run.use_gpu(Some(Arc::clone(&gpu)), MEMORY);
        run
    };
    let mut whole = start();
    whole.run(19).unwrap();
    let mut steps = start();
    for _ in 0..19 {
        steps.run(1).unwrap();
    }
    assert_eq!(whole.progress().total_iterations, 19);
    assert_eq!(whole.points(), steps.points(), "the size of batches changes nothing");
    let mut first = start();
    first.run(7).unwrap();
    let mut second = NetworkRun::resume(first.state(), MEMORY).unwrap();
    second.use_gpu(Some(gpu), MEMORY);
    second.run(12).unwrap();
    assert_eq!(whole.points(), second.points());
    // Negative control: another seed goes elsewhere.
    assert_ne!(whole.points()[0], tiny("rings", |p| p.seed = 2).points()[0]);
}

#[test]
fn asking_for_few_iterations_gives_exactly_those() {
    let mut run = tiny("rings", |_| {});
    run.use_gpu(Some(open()), MEMORY);
    // A driver that runs ahead, as a page at play does …
    while run.progress().total_iterations < 5 {
        if run.advance().unwrap() == Event::Waiting {
            run.wait();
        }
    }
    // … and then a single step.
    let before = run.progress().total_iterations;
    run.run(1).unwrap();
    assert_eq!(run.progress().total_iterations, before + 1);
    assert_eq!(run.state().losses.len() as u64, before + 1);
}

/// A small scale for one engine alone.
fn setup(boundary: Boundary) -> ScaleSetup {
    let parameters = Parameters { boundary, ..Parameters::preset(Preset::Fast) };
    let scale = Scale { sigma: 0.1, resolution: 24.0, learning_rate: 0.01, iterations: 10 };
    let exemplar = white_noise(&mut Rng::new(7, Purpose::Gallery), DVec2::ONE, 12);
    ScaleSetup::new(&parameters.scale_settings(&scale, (0, 0)), exemplar, DVec2::ONE, boundary, DVec2::ONE)
}

fn engine(gpu: &Arc<Gpu>, setup: ScaleSetup, points: Vec<DVec2>) -> Result<GpuEngine, GpuError> {
    let count = points.len();
    GpuEngine::new(gpu, setup, 8, None, points, 0, Adam::new(count), 0, MEMORY)
}

/// Advances until something comes back.
fn outcome(engine: &mut GpuEngine) -> Advance {
    for _ in 0..100_000 {
        match engine.advance(1) {
            Advance::Working => {}
            Advance::Waiting => engine.wait(),
            other => return other,
        }
    }
    panic!("nothing came back");
}

#[test]
fn numbers_that_are_not_finite_stop_the_run_where_it_is() {
    let gpu = open();
    for bad in [f64::NAN, f64::INFINITY] {
        let points = vec![DVec2::new(0.2, 0.3), DVec2::new(bad, 0.5), DVec2::new(0.7, 0.7)];
        let mut engine = engine(&gpu, setup(Boundary::Open), points.clone()).unwrap();
        assert_eq!(outcome(&mut engine), Advance::NotFinite, "{bad}");
        assert_eq!(engine.points()[0], points[0], "nothing has moved");
        assert_eq!(gpu.fault(), None);
    }
}

#[test]
fn one_point_and_points_on_one_another_are_no_trouble() {
    let gpu = open();
    for points in [vec![DVec2::splat(0.5)], vec![DVec2::splat(0.25); 6], vec![DVec2::ZERO, DVec2::ONE]] {
        for boundary in [Boundary::Open, Boundary::Periodic] {
            let mut engine = engine(&gpu, setup(boundary), points.clone()).unwrap();
            let Advance::Iterated(losses) = outcome(&mut engine) else { panic!("{points:?} {boundary:?}") };
            assert!(losses.iter().all(|loss| loss.total().is_finite()));
            let inside = |p: &DVec2| p.cmpge(DVec2::ZERO).all() && p.cmple(DVec2::ONE).all();
            assert!(engine.points().iter().all(inside), "{:?}", engine.points());
        }
    }
}

/// The weakest device that WebGPU allows.
#[test]
fn default_limits_are_enough_and_what_exceeds_them_is_refused_in_words() {
    let gpu = open_with(OpenOptions { default_limits: true, ..OpenOptions::default() });
    assert_eq!(gpu.info().max_binding_bytes, 128 << 20);
    for deviation in deviations(&gpu, Case::small(Boundary::Periodic)) {
        assert!(deviation.is_fine(), "{deviation:?}");
    }
    let scaled = |resolution: f64, output: f64| {
        let parameters = Parameters { boundary: Boundary::Periodic, ..Parameters::preset(Preset::Paper) };
        let scale = Scale { sigma: 0.1, resolution, learning_rate: 0.01, iterations: 10 };
        let exemplar = white_noise(&mut Rng::new(7, Purpose::Gallery), DVec2::ONE, 12);
        let (one, boundary) = (DVec2::ONE, Boundary::Periodic);
        ScaleSetup::new(&parameters.scale_settings(&scale, (0, 0)), exemplar, one, boundary, DVec2::splat(output))
    };
    // The paper's largest grid fits, in several passes; the cap of this program's parameters may not.
    let bytes = GpuEngine::bytes_for(&gpu, &scaled(256.0, 2.0), 120, 1000, MEMORY).unwrap();
    assert!(bytes < MEMORY, "{bytes}");
    let refused = GpuEngine::bytes_for(&gpu, &scaled(512.0, 4.0), 160, 1000, MEMORY).unwrap_err();
    assert!(matches!(refused, GpuError::TooLarge { .. }), "{refused}");
    assert!(refused.to_string().contains("134 MB"), "{refused}");
    let refused = GpuEngine::bytes_for(&gpu, &scaled(256.0, 2.0), 120, 1000, 100_000_000).unwrap_err();
    assert!(matches!(refused, GpuError::Memory { .. }), "{refused}");

    // A run that does not fit goes on on the processor, and says why.
    let mut run = tiny("rings", |_| {});
    run.use_gpu(Some(gpu), 1_000_000);
    let reason = loop {
        match run.advance().unwrap() {
            Event::EngineChanged { reason } => break reason,
            Event::ScaleStarted { .. } => panic!("it began on a device without room"),
            _ => {}
        }
    };
    assert!(reason.contains("1 MB may be used"), "{reason}");
    run.run(3).unwrap();
    assert_eq!((run.gpu().is_none(), run.progress().total_iterations), (true, 3));
}

/// The largest grid that parameters allow, on the weakest device, for one iteration.
#[test]
fn the_largest_grid_runs_within_default_limits() {
    let gpu = open_with(OpenOptions { default_limits: true, ..OpenOptions::default() });
    let parameters = Parameters { channels: 8, ..Parameters::preset(Preset::Paper) };
    let scale = Scale { sigma: 0.02, resolution: 256.0, learning_rate: 0.01, iterations: 10 };
    let exemplar = white_noise(&mut Rng::new(7, Purpose::Gallery), DVec2::ONE, 50);
    let (one, open) = (DVec2::ONE, Boundary::Open);
    let setup = ScaleSetup::new(&parameters.scale_settings(&scale, (0, 0)), exemplar, one, open, DVec2::splat(2.0));
    let points = white_noise(&mut Rng::new(3, Purpose::Gallery), DVec2::splat(2.0), 200);
    let mut engine = engine(&gpu, setup, points).unwrap();
    assert!(matches!(outcome(&mut engine), Advance::Iterated(_)));
    assert_eq!(gpu.fault(), None);
}

/// Images larger than one buffer of spectra go through in passes; the arithmetic is the same.
#[test]
fn passes_change_nothing() {
    let points = white_noise(&mut Rng::new(3, Purpose::Gallery), DVec2::ONE, 20);
    let after = |tiles_a_pass: Option<usize>| {
        let gpu = open_with(OpenOptions { tiles_a_pass, ..OpenOptions::default() });
        let mut engine = engine(&gpu, setup(Boundary::Open), points.clone()).unwrap();
        let Advance::Iterated(losses) = outcome(&mut engine) else { panic!("no iteration") };
        (losses[0], engine.points().to_vec())
    };
    let whole = after(None);
    let parted = after(Some(4));
    assert_eq!(whole.0, parted.0);
    assert_eq!(whole.1[..], parted.1[..whole.1.len()]);
}

/// What the benchmark measures against does the same work: the direct kernel gives the transforms' numbers.
#[test]
fn the_direct_kernel_convolves() {
    let gpu = open();
    let (height, width, channels) = (11, 9, 6);
    let outputs = 8;
    let mut rng = Rng::new(5, Purpose::Gallery);
    let mut image = vec![0.0_f32; height * width * outputs];
    for pixel in image.chunks_exact_mut(outputs) {
        pixel[..channels].fill_with(|| rng.range(-1.0, 1.0) as f32);
    }
    let weights: Vec<f64> = (0..channels * channels * 49).map(|_| rng.range(-1.0, 1.0)).collect();
    for boundary in [Boundary::Open, Boundary::Periodic] {
        let geometry = Geometry { height, width, stride: 1, boundary };
        let direct = Direct::new(&gpu, geometry, channels, &weights, &image);
        direct.seconds().unwrap();
        let ours: Vec<f64> = direct.image().unwrap().iter().map(|&value| value.into()).collect();
        let at = |index: usize, shift: usize, len: usize| -> Option<usize> {
            let place = index as isize + shift as isize - 3;
            match boundary {
                Boundary::Open => usize::try_from(place).ok().filter(|&place| place < len),
                Boundary::Periodic => Some(place.rem_euclid(len as isize) as usize),
            }
        };
        let mut expected = vec![0.0; ours.len()];
        for (pixel, sums) in expected.chunks_exact_mut(outputs).enumerate() {
            let (y, x) = (pixel / width, pixel % width);
            for tap in 0..49 {
                let (Some(y), Some(x)) = (at(y, tap / 7, height), at(x, tap % 7, width)) else { continue };
                for to in 0..channels {
                    for from in 0..channels {
                        let value = f64::from(image[(y * width + x) * outputs + from]);
                        sums[to] += weights[(to * channels + from) * 49 + tap] * value;
                    }
                }
            }
        }
        common::assert_close("direct convolution", &ours, &expected, 1e-5);
    }
}

/// The device goes away after so many pieces of work; the run goes on from what came back last.
fn lose_device_after(pieces: usize, fresh: bool) -> (u64, NetworkRun) {
    let mut run = tiny("rings", |parameters| {
        parameters.iterations_coarse = 20;
        parameters.scales = 1;
    });
    let gpu = open();
    run.use_gpu(Some(Arc::clone(&gpu)), MEMORY);
    for _ in 0..pieces {
        if run.advance().unwrap() == Event::Waiting {
            run.wait();
        }
    }
    let kept = run.state();
    gpu.destroy();
    let mut told = 0;
    loop {
        match run.advance().unwrap() {
            Event::EngineChanged { reason } => {
                assert!(reason.contains("destroyed"), "{reason}");
                let state = run.state();
                assert_eq!((&state.points, &state.losses), (&kept.points, &kept.losses), "nothing is lost");
                assert_eq!(state.adam, kept.adam);
                told += 1;
                run.use_gpu(fresh.then(open), MEMORY);
            }
            Event::Waiting => run.wait(),
            Event::Finished => break,
            _ => {}
        }
    }
    assert!(told <= 1);
    assert_eq!(run.progress().total_iterations, 20);
    assert_eq!(run.gpu().is_some(), fresh || told == 0);
    (told, run)
}

#[test]
fn a_device_destroyed_at_any_moment_loses_nothing() {
    let mut rng = Rng::new(11, Purpose::Gallery);
    let mut whole = tiny("rings", |parameters| {
        parameters.iterations_coarse = 20;
        parameters.scales = 1;
    });
    whole.use_gpu(Some(open()), MEMORY);
    // A quick device is done after fewer pieces than a slow one.
    let mut all: usize = 0;
    loop {
        match whole.advance().unwrap() {
            Event::Finished => break,
            Event::Waiting => whole.wait(),
            _ => {}
        }
        all += 1;
    }
    let mut lost = 0;
    for round in 0..6 {
        let pieces = (rng.range(0.0, 0.9) * all as f64) as usize;
        let (told, run) = lose_device_after(pieces, round % 2 == 0);
        lost += told;
        if round % 2 == 0 {
            assert_eq!(run.points(), whole.points(), "a fresh device goes on bit for bit, from {pieces} on");
        }
    }
    assert!(lost >= 3, "the device was there to be lost: {lost}");
}
