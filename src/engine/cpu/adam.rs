//! Adam (Kingma & Ba 2015) on the positions, in double precision: the points are few and their sums are long.

use glam::DVec2;
use serde::{Deserialize, Serialize};

/// Decay of the mean of the gradient.
const BETA1: f64 = 0.9;
/// Decay of the mean of its square.
const BETA2: f64 = 0.999;
/// Keeps the step finite where the gradient vanishes.
const EPSILON: f64 = 1e-8;

/// What a step divides the moments by, inverted: `1 / (1 − βᵗ)` for both, after `steps` steps.
#[must_use]
pub fn correction(steps: u32) -> [f64; 2] {
    [BETA1, BETA2].map(|beta| 1.0 / (1.0 - libm::pow(beta, f64::from(steps))))
}

/// The moments of the moving points.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Adam {
    /// Steps taken.
    pub steps: u32,
    /// Mean of the gradient.
    pub first: Vec<DVec2>,
    /// Mean of its square, by component.
    pub second: Vec<DVec2>,
}

impl Adam {
    /// Fresh moments for `points` points.
    #[must_use]
    pub fn new(points: usize) -> Self {
        Self { steps: 0, first: vec![DVec2::ZERO; points], second: vec![DVec2::ZERO; points] }
    }

    /// Moves `points` against `gradients`.
    pub fn step(&mut self, points: &mut [DVec2], gradients: &[[f64; 2]], learning_rate: f64) {
        self.steps += 1;
        let [first_scale, second_scale] = correction(self.steps);
        for (((point, gradient), first), second) in
            points.iter_mut().zip(gradients).zip(&mut self.first).zip(&mut self.second)
        {
            let gradient = DVec2::from(*gradient);
            *first = BETA1 * *first + (1.0 - BETA1) * gradient;
            *second = BETA2 * *second + (1.0 - BETA2) * gradient * gradient;
            let root = (*second * second_scale).map(f64::sqrt);
            *point -= learning_rate * (*first * first_scale) / (root + EPSILON);
        }
    }
}
