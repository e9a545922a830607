//! Ripley's K and L with envelopes of complete spatial randomness.

use serde::{Deserialize, Serialize};

use super::cloud::{Cloud, check_positive};
use super::error::{AnalysisError, check};
use crate::sampling::{Purpose, Rng};

/// At which distances K is estimated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RipleySettings {
    /// Longest distance, in the cloud's unit.
    pub range: f64,
    /// How many distances, evenly from `range / samples` to `range`.
    pub samples: usize,
}

impl RipleySettings {
    /// A quarter of the shorter side, as is customary (Diggle 2013), but at most 6 / √density, where all patterns with
    /// short-range structure look like chance.
    #[must_use]
    pub fn suited_to(cloud: &Cloud) -> Self {
        let range = (0.25 * cloud.shorter_side()).min(6.0 / cloud.density().sqrt());
        Self { range, samples: 64 }
    }
}

/// K(r): how many other points lie within r of a point, over the density (Ripley 1976). Independent points have πr².
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ripley {
    /// The distances, in the cloud's unit.
    pub radius: Vec<f64>,
    /// K at each of them, in units of area.
    pub k: Vec<f64>,
    /// L(r) − r = √(K/π) − r (Besag 1977): 0 for independent points, above it where points cluster.
    pub l_minus_r: Vec<f64>,
}

/// What independent points do in the same rectangle or window.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Envelope {
    /// How many patterns were simulated.
    pub simulations: usize,
    /// Lowest L(r) − r of all simulations.
    pub low: Vec<f64>,
    /// Highest.
    pub high: Vec<f64>,
    /// How often chance alone strays as far from 0, anywhere in the range, as the pattern does: the rank of its
    /// largest |L(r) − r| among the simulations', from 1 / (simulations + 1) to 1 (a Monte-Carlo test, Besag & Diggle
    /// 1977).
    pub p_value: f64,
}

/// Ripley's K and L with the translation correction in a window and around the border of a torus, whatever the
/// points' classes.
///
/// # Errors
/// With a single point, or settings out of range.
pub fn ripley(cloud: &Cloud, settings: &RipleySettings) -> Result<Ripley, AnalysisError> {
    cloud.at_least("Ripley's K", 2)?;
    check_positive("range", settings.range)?;
    check("samples", settings.samples as f64, 1.0, 10_000.0)?;
    let samples = settings.samples;
    let step = settings.range / samples as f64;
    let mut rings = vec![0.0; samples];
    cloud.neighbours().pairs(settings.range, |_, _, offset| {
        // Ring i holds the distances in (i · step, (i + 1) · step].
        let ring = ((offset.length() / step).ceil().max(1.0) as usize).min(samples) - 1;
        rings[ring] += 2.0 * cloud.pair_weight(offset);
    });
    let n = cloud.len() as f64;
    let scale = cloud.area() * cloud.area() / (n * (n - 1.0));
    let mut sum = 0.0;
    let k: Vec<f64> = rings
        .iter()
        .map(|ring| {
            sum += ring;
            sum * scale
        })
        .collect();
    let radius: Vec<f64> = (1..=samples).map(|i| i as f64 * step).collect();
    let l_minus_r = k.iter().zip(&radius).map(|(k, r)| (k / std::f64::consts::PI).sqrt() - r).collect();
    Ok(Ripley { radius, k, l_minus_r })
}

/// The lowest and highest L of `simulations` patterns of as many independent points, and where `observed` stands
/// among them. The same seed gives the same envelope.
///
/// # Errors
/// With a single point, settings out of range, or not between 1 and 9999 simulations.
pub fn envelope(
    cloud: &Cloud,
    observed: &Ripley,
    settings: &RipleySettings,
    simulations: usize,
    seed: u64,
) -> Result<Envelope, AnalysisError> {
    check("simulations", simulations as f64, 1.0, 9999.0)?;
    let largest = |l: &[f64]| l.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let observed = largest(&observed.l_minus_r);
    let mut low = vec![f64::INFINITY; settings.samples];
    let mut high = vec![f64::NEG_INFINITY; settings.samples];
    let mut as_far = 1;
    for simulation in 0..simulations {
        let mut rng = Rng::new(seed, Purpose::Analysis(simulation as u32));
        let chance = ripley(&cloud.independent(&mut rng), settings)?;
        for (i, &value) in chance.l_minus_r.iter().enumerate() {
            low[i] = low[i].min(value);
            high[i] = high[i].max(value);
        }
        as_far += usize::from(largest(&chance.l_minus_r) >= observed);
    }
    Ok(Envelope { simulations, low, high, p_value: as_far as f64 / (simulations + 1) as f64 })
}
