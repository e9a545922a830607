//! A run as it is saved, and how it is continued bit for bit.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::NetworkError;
use super::parameters::Parameters;
use super::retries::Best;
use super::run::NetworkRun;
use crate::engine::cpu::adam::Adam;
use crate::pattern::PointPattern;

/// Version of [`NetworkState`]'s layout.
const STATE_VERSION: u32 = 2;

/// Everything needed to continue a run later, bit for bit. Taken between iterations.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct NetworkState {
    /// Name of the method. States that were saved when there was one method do not say it.
    #[serde(default = "method_name")]
    pub method: String,
    /// Version of this layout.
    pub version: u32,
    /// The exemplar.
    pub exemplar: PointPattern,
    /// The parameters.
    pub parameters: Parameters,
    /// Output points in exemplar units, class after class as they are placed.
    pub points: Vec<DVec2>,
    /// For every output point the exemplar point whose attributes it carries. (States of version 1 have none; they
    /// are refused for their version.)
    #[serde(default)]
    pub sources: Vec<usize>,
    /// Class at hand.
    pub class: usize,
    /// Scale at hand.
    pub scale: usize,
    /// Most iterations of the scale at hand; more than its own where the scales before had nothing to match.
    pub iterations: u32,
    /// Losses of the scale at hand.
    pub losses: Vec<f64>,
    /// Iterations done in the whole run.
    pub total_iterations: u64,
    /// Which try at the worst regions of the class; 0 before the first.
    pub restart: u32,
    /// The least mismatched points of the class, once there are tries.
    pub best: Option<Best>,
    /// Whether everything is done.
    pub finished: bool,
    /// Points that are held where they are, ascending.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pinned: Vec<usize>,
    /// The region that is being done again.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub redo: Option<Redo>,
    /// How many regions were done again.
    #[serde(default)]
    pub redos: u32,
    /// Adam's moments of the moving points.
    pub adam: Adam,
}

fn method_name() -> String {
    super::NAME.to_owned()
}

/// A region that is being done again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct Redo {
    /// Which points move, ascending.
    pub points: Vec<usize>,
    /// Class at hand before.
    pub class: usize,
    /// Scale at hand before: it begins anew afterwards.
    pub scale: usize,
    /// Whether everything was done before.
    pub finished: bool,
}

fn refuse<T>(reason: String) -> Result<T, NetworkError> {
    Err(NetworkError::State(reason))
}

impl NetworkRun {
    /// Everything needed to continue later. An iteration that is only partly done is done again.
    #[must_use]
    pub fn state(&self) -> NetworkState {
        let pinned = self.canvas.pinned();
        NetworkState {
            method: method_name(),
            version: STATE_VERSION,
            exemplar: self.exemplar().clone(),
            parameters: self.parameters.clone(),
            points: self.points().to_vec(),
            sources: self.sources().to_vec(),
            class: self.class(),
            scale: self.ladder.scale,
            iterations: self.ladder.current().iterations,
            losses: self.ladder.losses.clone(),
            total_iterations: self.total_iterations,
            restart: self.ladder.restart,
            best: self.best.clone(),
            finished: self.finished,
            pinned: (0..pinned.len()).filter(|&point| pinned[point]).collect(),
            redo: self.redo.clone(),
            redos: self.redos,
            adam: self.handover.moments().unwrap_or_else(|| Adam::new(self.moving())),
        }
    }

    /// Continues a saved run.
    ///
    /// # Errors
    /// When the state does not fit together, or would not fit into `memory_limit` bytes.
    pub fn resume(state: NetworkState, memory_limit: u64) -> Result<Self, NetworkError> {
        if state.method != super::NAME {
            return refuse(format!("it belongs to the method '{}', not to '{}'", state.method, super::NAME));
        }
        if state.version != STATE_VERSION {
            return refuse(format!("its version is {}, this program reads {STATE_VERSION}", state.version));
        }
        let mut run = Self::prepare(state.exemplar, state.parameters, memory_limit)?;
        let Some(turn) = run.prepared.order.iter().position(|&class| class == state.class) else {
            return refuse(format!("it is at class {}, of which the exemplar has no points", state.class));
        };
        let scales = run.ladder.scales();
        if state.scale >= scales.len() {
            return refuse(format!("it is at scale {}, but there are {}", state.scale, scales.len()));
        }
        let longest = scales.iter().map(|scale| scale.iterations).max().unwrap_or(0);
        if state.iterations == 0 || state.iterations > longest {
            return refuse(format!("its scale has {} iterations, but none may have over {longest}", state.iterations));
        }
        run.turn = turn;
        run.ladder.go_to(state.scale);
        run.ladder.set_iterations(state.iterations);
        // A region done again and a run with changed parameters begin with classes that are all there.
        let mut count = 0;
        for place in 0..run.classes() {
            if place > turn && count >= state.points.len() {
                break;
            }
            run.class_starts.push(count);
            count += run.output_count(run.prepared.order[place]);
        }
        if state.points.len() != count {
            return refuse(format!("it has {} points, but {count} belong to its classes", state.points.len()));
        }
        let of_class = run.class_starts[turn]..run.class_starts.get(turn + 1).copied().unwrap_or(count);
        if let Some(index) = state.points.iter().position(|&point| !run.canvas.contains(point)) {
            return refuse(format!("point {index} lies outside the output"));
        }
        if state.losses.len() > state.iterations as usize || state.losses.iter().any(|loss| !loss.is_finite()) {
            return refuse("its losses are not those of this scale".to_owned());
        }
        if let Some(redo) = &state.redo
            && !run.accepts(redo, count, state.finished)
        {
            return refuse("the region that is done again is none of its own".to_owned());
        }
        if let Some(point) = state.pinned.iter().find(|&&point| point >= count) {
            return refuse(format!("it holds point {point}, but there are {count}"));
        }
        run.check_best(state.best.as_ref(), state.restart, of_class.len())?;
        let part = |span: std::ops::Range<usize>| state.sources.get(span).unwrap_or(&[]);
        let of_best = state
            .best
            .as_ref()
            .map(|best| [part(0..of_class.start), &best.sources, part(of_class.end..count)].concat());
        for sources in [Some(&state.sources), of_best.as_ref()].into_iter().flatten() {
            if let Err(reason) = run.check_sources(sources, count) {
                return refuse(format!("of the values that its points carry, {reason}"));
            }
        }
        let pinned: Vec<u32> =
            state.points.iter().zip(&state.sources).map(|(&point, &source)| run.canvas.add(point, source)).collect();
        let pinned: Vec<u32> = state.pinned.iter().map(|&point| pinned[point]).collect();
        run.canvas.pin(&pinned, true)?;
        run.redo = state.redo;
        run.redos = state.redos;
        run.check_moments(&state.adam)?;
        run.ladder.restart = state.restart;
        run.ladder.losses = state.losses;
        run.best = state.best;
        run.total_iterations = state.total_iterations;
        run.finished = state.finished;
        run.handover.set_moments(state.adam);
        Ok(run)
    }

    /// Whether a region can be one of this run's, which has `count` points.
    fn accepts(&self, redo: &Redo, count: usize, finished: bool) -> bool {
        let begun = &self.prepared.order[..self.class_starts.len()];
        !redo.points.is_empty()
            && redo.points.is_sorted()
            && redo.points.iter().all(|&point| point < count)
            && begun.contains(&redo.class)
            && redo.scale < self.ladder.scales().len()
            && !finished
    }

    /// Checks the best try so far of a class with `count` points.
    fn check_best(&self, best: Option<&Best>, restart: u32, count: usize) -> Result<(), NetworkError> {
        if restart > self.parameters.restarts || (restart > 0 && best.is_none()) {
            return refuse(format!("it is at try {restart}, but there are {}", self.parameters.restarts));
        }
        if let Some(best) = best
            && (best.points.len() != count
                || best.sources.len() != count
                || !best.points.iter().all(|&point| self.canvas.contains(point))
                || best.mismatch.is_nan())
        {
            return refuse("its best points so far are not those of this class".to_owned());
        }
        Ok(())
    }

    /// Checks the optimiser's moments against the points that may move.
    fn check_moments(&self, adam: &Adam) -> Result<(), NetworkError> {
        let moving = self.moving();
        if adam.first.len() != moving || adam.second.len() != moving {
            return refuse(format!("its optimiser moves {} points, not the {moving} that may move", adam.first.len()));
        }
        if adam.first.iter().chain(&adam.second).any(|v| !v.is_finite())
            || adam.second.iter().any(|v| v.min_element() < 0.0)
        {
            return refuse("its optimiser holds a value that is not allowed".to_owned());
        }
        Ok(())
    }
}
