//! Where a run stands on its ladder of scales: which scale, its losses, and which try at the worst regions.

use super::parameters::Parameters;
use super::schedule::{Scale, Schedule, converged};
use crate::run::Progress;

/// A place on the ladder.
#[derive(Clone, Debug)]
pub(super) struct Ladder {
    schedule: Schedule,
    /// Scale being worked on, from 0 (coarse).
    pub(super) scale: usize,
    /// Losses of that scale, one an iteration.
    pub(super) losses: Vec<f64>,
    /// Which try at the worst regions; 0 before the first.
    pub(super) restart: u32,
}

impl Ladder {
    /// The first scale.
    pub(super) fn new(schedule: Schedule) -> Self {
        Self { schedule, scale: 0, losses: Vec::new(), restart: 0 }
    }

    /// The same place on a fresh schedule: forgets what flat scales passed on.
    pub(super) fn renew(&mut self, schedule: Schedule) {
        self.schedule = schedule;
    }

    /// All scales.
    pub(super) fn scales(&self) -> &[Scale] {
        &self.schedule.scales
    }

    /// The scale being worked on.
    pub(super) fn current(&self) -> &Scale {
        &self.schedule.scales[self.scale]
    }

    /// Gives the scale being worked on so many iterations.
    pub(super) fn set_iterations(&mut self, iterations: u32) {
        self.schedule.scales[self.scale].iterations = iterations;
    }

    /// Iterations that the scale may still take.
    pub(super) fn left(&self) -> u32 {
        self.current().iterations - self.losses.len() as u32
    }

    /// How many scales follow the one being worked on.
    pub(super) fn scales_left(&self) -> usize {
        self.schedule.scales.len() - self.scale - 1
    }

    /// Whether the last iterations brought next to nothing.
    pub(super) fn has_converged(&self, parameters: &Parameters) -> bool {
        converged(&self.losses, parameters.convergence_window as usize, parameters.convergence_tolerance)
    }

    /// Whether the scale has converged or used its iterations.
    pub(super) fn is_over(&self, parameters: &Parameters) -> bool {
        self.left() == 0 || self.has_converged(parameters)
    }

    /// Goes to a scale and forgets the losses of the one before.
    pub(super) fn go_to(&mut self, scale: usize) {
        self.scale = scale;
        self.losses.clear();
    }

    /// The ladder's part of the progress; `done` is the share of the class at hand.
    pub(super) fn progress(&self, parameters: &Parameters) -> Progress {
        let scales = self.scales();
        // Work grows with the pixels of the grid.
        let work = |scale: usize| f64::from(scales[scale].iterations) * scales[scale].resolution.powi(2);
        let span = |from: usize, to: usize| (from..to).map(work).sum::<f64>();
        let (whole, again) = (span(0, scales.len()), span(parameters.restart_scale(), scales.len()));
        let all = whole + f64::from(parameters.restarts) * again;
        let before = match self.restart {
            0 => span(0, self.scale),
            restart => whole + f64::from(restart - 1) * again + span(parameters.restart_scale(), self.scale),
        };
        let limit = self.current().iterations;
        let iteration = self.losses.len() as u32;
        let current = work(self.scale) * f64::from(iteration) / f64::from(limit);
        Progress {
            class: 0,
            turn: 0,
            classes: 1,
            scale: self.scale,
            scales: scales.len(),
            restart: self.restart,
            restarts: parameters.restarts,
            redoing: false,
            iteration,
            iterations: limit,
            total_iterations: 0,
            done: (before + current) / all,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Preset;
    use super::*;
    use glam::DVec2;

    fn ladder(restarts: u32) -> (Ladder, Parameters) {
        let parameters = Parameters { restarts, scales: 4, ..Parameters::preset(Preset::Fast) };
        (Ladder::new(Schedule::new(&parameters, 0.1, 100.0, DVec2::splat(2.0))), parameters)
    }

    #[test]
    fn progress_never_runs_backwards_and_ends_at_one() {
        let (mut ladder, parameters) = ladder(2);
        let mut before = -1.0;
        let scales = ladder.scales().len();
        for restart in 0..=2 {
            ladder.restart = restart;
            for scale in (if restart == 0 { 0 } else { parameters.restart_scale() })..scales {
                ladder.go_to(scale);
                while !ladder.is_over(&parameters) {
                    let done = ladder.progress(&parameters).done;
                    assert!(done > before && done < 1.0, "{done} after {before}");
                    before = done;
                    ladder.losses.push(1.0 / ladder.losses.len().max(1) as f64);
                    if ladder.losses.len() > 40 {
                        break;
                    }
                }
            }
        }
        ladder.losses = vec![1.0; ladder.current().iterations as usize];
        assert!((ladder.progress(&parameters).done - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_scale_ends_when_its_iterations_are_used_or_it_has_converged() {
        let (mut ladder, parameters) = ladder(0);
        assert!(!ladder.is_over(&parameters) && ladder.left() == ladder.current().iterations);
        ladder.set_iterations(3);
        ladder.losses = vec![3.0, 2.0, 1.0];
        assert!(ladder.is_over(&parameters) && !ladder.has_converged(&parameters));
        ladder.set_iterations(1000);
        assert!(!ladder.is_over(&parameters));
        ladder.losses = vec![1.0; 200];
        assert!(ladder.has_converged(&parameters));
        ladder.go_to(2);
        assert_eq!((ladder.scale, ladder.losses.len(), ladder.scales_left()), (2, 0, ladder.scales().len() - 3));
    }
}
