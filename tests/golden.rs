//! The engine against values made by an independent implementation: `tests/golden/make_golden.py`, PyTorch with
//! automatic differentiation in double precision, on a tiny fixed network.
//!
//! In `f64` the two agree to rounding; in `f32`, which is what a run uses, to a few units in the last place of sums
//! over a thousand terms. Every comparison is shown to be able to fail (`assert_close`).

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail loudly")]

mod common;

use std::sync::Arc;

use common::assert_close;
use glam::DVec2;
use pointweave::Boundary;
use pointweave::engine::cpu::convolution::Tile;
use pointweave::engine::cpu::lanes::{LANES, padded};
use pointweave::engine::cpu::network::{Evaluation, Network};
use pointweave::engine::cpu::real::Real;
use pointweave::engine::view::{Grid, Lags, View, Wave};
use pointweave::engine::{FilterBank, Weights};
use serde_json::Value;

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(list) => list.iter().flat_map(numbers).collect(),
        number => vec![number.as_f64().unwrap()],
    }
}

fn positions(value: &Value) -> Vec<DVec2> {
    numbers(value).chunks_exact(2).map(|p| DVec2::new(p[0], p[1])).collect()
}

/// `[pixel, stored channel]` to `[channel, pixel]`.
fn by_channel<T: Real>(image: &[T], stored: usize, channels: usize) -> Vec<f64> {
    (0..channels).flat_map(|c| image.iter().skip(c).step_by(stored).map(|v| v.wide())).collect()
}

fn activations<T: Real>(evaluation: &Evaluation<T>, layer: usize, channels: usize) -> Vec<f64> {
    let (image, statistics) = evaluation.image(layer);
    let stored = statistics.mean.len();
    let activated: Vec<T> = image
        .iter()
        .enumerate()
        .map(|(i, v)| {
            let normalized = (*v - statistics.mean[i % stored]) * statistics.inverse_deviation[i % stored];
            if normalized > T::ZERO { normalized } else { T::ZERO }
        })
        .collect();
    by_channel(&activated, stored, channels)
}

fn check_digest(what: &str, values: &[f64], digest: &Value, tolerance: f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square = values.iter().map(|v| v * v).sum::<f64>() / count;
    let ramp = values.iter().enumerate().map(|(i, v)| v * (i + 1) as f64 / count).sum::<f64>() / count;
    let expected = [&digest["mean"], &digest["mean_square"], &digest["ramp"]].map(|v| v.as_f64().unwrap());
    assert_close(what, &[mean, square, ramp], &expected, tolerance);
}

/// Tolerances: of sums of positive terms, and of the gradient, where terms cancel.
fn check<T: Real>(tolerance: f64, gradient_tolerance: f64) {
    let golden: Value = serde_json::from_str(include_str!("golden/golden.json")).unwrap();
    let weights = golden["weights"].as_array().unwrap();
    let channels = weights[1].as_array().unwrap().len();
    let bank = FilterBank { channels, layers: std::array::from_fn(|layer| numbers(&weights[layer])) };
    let cases = golden["cases"].as_array().unwrap();
    assert!(cases.len() >= 2, "both boundaries");
    // The last one with the other tile size too.
    for (case, tiles) in cases.iter().flat_map(|case| [(case, [Tile::Small; 4]), (case, [Tile::Large; 4])]) {
        let name = case["name"].as_str().unwrap();
        let number = |key: &str| case[key].as_f64().unwrap();
        let boundary = match case["boundary"].as_str().unwrap() {
            "open" => Boundary::Open,
            "periodic" => Boundary::Periodic,
            other => panic!("{other}"),
        };
        let lags = numbers(&case["lags"]);
        let lags = Lags { rows: lags[0] as usize, columns: lags[1] as usize };
        let view = |grid: &Value| {
            let size = numbers(grid);
            View {
                grid: Grid {
                    height: size[0] as usize,
                    width: size[1] as usize,
                    pitch: DVec2::splat(number("pitch")),
                    boundary,
                },
                // Wide enough that what is cut off vanishes in double precision.
                wave: Wave {
                    sigma: number("sigma"),
                    frequency: number("frequency"),
                    scale: number("map_scale"),
                    cutoff_sigmas: 9.0,
                },
                interior_only: false,
            }
        };
        let network = Arc::new(Network::<T>::new(&bank, tiles));
        let exemplar_points = positions(&case["positions_exemplar"]);
        let points = positions(&case["positions_output"]);
        let mut exemplar = Evaluation::new(
            Arc::clone(&network),
            &view(&case["grid_exemplar"]),
            exemplar_points.len(),
            lags,
            false,
            [0.0; 2],
            &Weights::default(),
        );
        while !exemplar.advance(&exemplar_points, None) {}
        let targets = exemplar.targets(lags);
        let weights = [number("gram_weight"), number("correlation_weight")];
        let (side, seen) = (Arc::clone(&network), view(&case["grid_output"]));
        let mut output = Evaluation::new(side, &seen, points.len(), lags, true, weights, &Weights::default());
        while !output.advance(&points, Some(&targets)) {}

        let what = |thing: &str| format!("{name} {:?}: {thing}", tiles[0]);
        let maps = by_channel(exemplar.maps(), LANES, 5);
        assert_close(&what("maps"), &maps, &numbers(&case["maps_exemplar"]), tolerance);
        for (side, evaluation) in [("exemplar", &exemplar), ("output", &output)] {
            let digests = &case[format!("digests_{side}")];
            let maps = by_channel(evaluation.maps(), LANES, 5);
            check_digest(&what("maps"), &maps, &digests["maps"], tolerance);
            for layer in 0..4 {
                let values = activations(evaluation, layer, channels);
                let label = format!("features_{}", layer + 1);
                check_digest(&what(&label), &values, &digests[&label], tolerance);
            }
            let features = activations(evaluation, 3, channels);
            let expected = numbers(&case[format!("features_4_{side}")]);
            assert_close(&what("features of layer 4"), &features, &expected, tolerance);
            let measured = evaluation.targets(lags);
            let stored = padded(channels);
            let grams: Vec<f64> = measured
                .grams
                .iter()
                .flat_map(|gram| (0..channels).flat_map(move |i| gram[i * stored..i * stored + channels].to_vec()))
                .collect();
            assert_close(&what("gram"), &grams, &numbers(&case[format!("gram_{side}")]), tolerance);
            let correlations: Vec<f64> = measured.correlations.iter().map(|v| v.wide()).collect();
            let expected = numbers(&case[format!("correlation_{side}")]);
            assert_close(&what("correlation"), &correlations, &expected, tolerance);
        }
        let loss = output.loss();
        let expected = &case["loss"];
        assert_close(&what("gram loss"), &loss.gram, &numbers(&expected["gram"]), gradient_tolerance);
        let terms = [loss.correlation, loss.total()];
        let expected = [&expected["correlation"], &expected["total"]].map(|v| v.as_f64().unwrap());
        assert_close(&what("loss"), &terms, &expected, gradient_tolerance);
        let gradient: Vec<f64> = output.point_gradients(0).iter().flatten().copied().collect();
        assert_close(&what("gradient"), &gradient, &numbers(&case["gradient"]), gradient_tolerance);
    }
}

#[test]
fn in_double_precision() {
    check::<f64>(1e-10, 1e-9);
}

#[test]
fn in_single_precision() {
    check::<f32>(2e-5, 2e-4);
}
