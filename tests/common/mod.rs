//! What several tests share.
#![allow(dead_code, unreachable_pub, reason = "each test binary includes this file and uses its own part")]

use glam::DVec2;
use pointweave::sampling::{Purpose, Rng};

/// Random numbers in −1 … 1.
pub fn noise(seed: u64, len: usize) -> Vec<f64> {
    let mut rng = Rng::new(seed, Purpose::Gallery);
    (0..len).map(|_| rng.range(-1.0, 1.0)).collect()
}

/// Random points in a rectangle.
pub fn points(seed: u64, size: DVec2, count: usize) -> Vec<DVec2> {
    let mut rng = Rng::new(seed, Purpose::Gallery);
    pointweave::sampling::white_noise(&mut rng, size, count)
}

/// Largest difference, relative to the largest expected value.
pub fn relative_error(actual: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(actual.len(), expected.len());
    let scale = expected.iter().fold(1e-300_f64, |most, v| most.max(v.abs()));
    actual.iter().zip(expected).fold(0.0_f64, |most, (a, e)| most.max((a - e).abs())) / scale
}

/// Asserts that two lists agree to `tolerance`, and that the comparison is able to fail: a list with one entry moved
/// by ten tolerances must not pass.
pub fn assert_close(what: &str, actual: &[f64], expected: &[f64], tolerance: f64) {
    let error = relative_error(actual, expected);
    assert!(error <= tolerance, "{what}: relative error {error:.3e} exceeds {tolerance:.1e}");
    let scale = expected.iter().fold(1e-300_f64, |most, v| most.max(v.abs()));
    let mut wrong = actual.to_vec();
    let middle = wrong.len() / 2;
    wrong[middle] += 10.0 * tolerance * scale;
    assert!(relative_error(&wrong, expected) > tolerance, "{what}: the comparison can't fail");
}

/// Central differences of `f` at `x` along every coordinate.
pub fn central_differences(x: &[f64], step: f64, mut f: impl FnMut(&[f64]) -> f64) -> Vec<f64> {
    let mut x = x.to_vec();
    (0..x.len())
        .map(|i| {
            let at = x[i];
            x[i] = at + step;
            let above = f(&x);
            x[i] = at - step;
            let below = f(&x);
            x[i] = at;
            (above - below) / (2.0 * step)
        })
        .collect()
}
