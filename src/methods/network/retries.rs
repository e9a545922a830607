//! Other tries at the regions that came out worst: what does not become better is undone.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::run::NetworkRun;
use crate::analysis::{AnalysisError, Cloud};
use crate::finish::Limits;
use crate::finish::perturbation::{mismatch, perturb};
use crate::sampling::{Purpose, Rng};

/// What a class looked like when its mismatch was least.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Best {
    /// How far it was from the exemplar: see [`mismatch`]. States call it by its first name.
    #[serde(rename = "wrongness")]
    pub mismatch: f64,
    /// Its points in exemplar units.
    pub points: Vec<DVec2>,
    /// Which of the exemplar's points each takes its values from.
    pub sources: Vec<usize>,
}

impl NetworkRun {
    /// Keeps the better of this try and the best before, and prepares another one if that is wanted and worth it.
    pub(super) fn try_again(&mut self) -> bool {
        match self.perturbed() {
            Some(points) => {
                self.canvas.points_mut().copy_from_slice(&points);
                self.ladder.restart += 1;
                self.ladder.scale = self.parameters.restart_scale();
            }
            None => {
                self.ladder.restart = 0;
                self.best = None;
            }
        }
        self.ladder.restart > 0
    }

    /// The points of another try; none when there is none. Leaves the best points where they are the last.
    fn perturbed(&mut self) -> Option<Vec<DVec2>> {
        if self.parameters.restarts == 0 || self.moving() == 0 {
            return None;
        }
        let span = self.class_start()..self.class_end();
        let (arranged, first) = self.arrangement();
        let seen = self.prepared.seen(self.turn);
        let exemplar = self.prepared.reference(self.canvas.exemplar(), &seen, self.class()).ok()?.cloud;
        let limits = Limits::of(&exemplar)?;
        let now = mismatch(&self.output_of(&arranged).ok()?, &exemplar, limits);
        match &self.best {
            Some(best) if best.mismatch <= now => {
                self.canvas.points_mut()[span.clone()].copy_from_slice(&best.points);
                self.canvas.sources_mut()[span].copy_from_slice(&best.sources);
            }
            _ => {
                let points = self.canvas.points()[span.clone()].to_vec();
                let sources = self.canvas.sources()[span].to_vec();
                self.best = Some(Best { mismatch: now, points, sources });
            }
        }
        if self.ladder.restart == self.parameters.restarts {
            return None;
        }
        let output = self.output_of(&arranged).ok()?;
        let mut moved = output.points().to_vec();
        let purpose = Purpose::Restart { class: self.class() as u16, restart: self.ladder.restart };
        let mut rng = Rng::new(self.parameters.seed, purpose);
        let count = perturb(&mut moved, first, &output, &exemplar, limits, &mut rng);
        let mut points = self.canvas.points().to_vec();
        for (&point, place) in arranged.iter().zip(moved) {
            points[point] = place;
        }
        (count > 0).then_some(points)
    }

    /// These points of the output.
    fn output_of(&self, points: &[usize]) -> Result<Cloud, AnalysisError> {
        let exemplar = self.canvas.exemplar();
        let places = points.iter().map(|&point| self.canvas.points()[point]).collect();
        let classes = points.iter().map(|&point| exemplar.classes()[self.canvas.sources()[point]]).collect();
        Cloud::new(places, self.canvas.size(), self.parameters.boundary)?.with_classes(classes)
    }
}
