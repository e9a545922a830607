//! Hands on the result: points that are put somewhere and held, regions that are done again, other parameters from the
//! points as they are.
//!
//! An engine knows points that stay and, after them, points that move. So to redo a region the engine gets the fixed
//! points first and the moving points last ([`NetworkRun::arrangement`]), and neither engine knows of any of this.

use glam::DVec2;

use super::NetworkError;
use super::parameters::Parameters;
use super::run::NetworkRun;
use super::state::Redo;
use crate::run::Edit;
use crate::sampling::{Purpose, Rng};
use crate::sorting::order;

impl NetworkRun {
    /// Holds points where they are, or lets them go. The scale at hand goes on from its last complete iteration, with
    /// fresh moments.
    ///
    /// # Errors
    /// When there is no such point; nothing has changed then.
    pub fn pin(&mut self, ids: &[u32], pinned: bool) -> Result<(), NetworkError> {
        self.canvas.pin(ids, pinned)?;
        self.touched();
        Ok(())
    }

    /// Puts points elsewhere, in exemplar units, and pins them there. The scale at hand goes on from its last complete
    /// iteration, with fresh moments.
    ///
    /// # Errors
    /// When there is no such point or a place lies outside the output; nothing has changed then.
    pub fn move_points(&mut self, ids: &[u32], places: &[DVec2]) -> Result<(), NetworkError> {
        self.canvas.place(ids, places)?;
        self.touched();
        Ok(())
    }

    /// One of these or [`Self::redo_region`].
    ///
    /// # Errors
    /// Theirs.
    pub fn edit(&mut self, edit: &Edit) -> Result<(), NetworkError> {
        match edit {
            Edit::Pin { ids, pinned } => self.pin(ids, *pinned),
            Edit::Move { ids, places } => self.move_points(ids, places),
            Edit::RedoRegion { polygon } => self.redo_region(polygon),
        }
    }

    /// Other points may move now, or from elsewhere.
    fn touched(&mut self) {
        self.handover.free_with_moments();
        if let Some(best) = &mut self.best {
            // What it was is no more; whatever the try at hand leads to is better.
            best.mismatch = f64::MAX;
        }
    }

    /// Erases what lies in a polygon and does it again while everything else stays: as many points of each class, from
    /// a fresh start, through all scales. Pinned points stay where they are. Afterwards a run that was not yet done goes
    /// on with the scale it was at; regions asked for meanwhile are done together.
    ///
    /// The corners are in exemplar units; in a periodic output the polygon may reach over the border.
    ///
    /// # Errors
    /// When the polygon is none, or no point that may move lies in it; nothing has changed then.
    pub fn redo_region(&mut self, polygon: &[DVec2]) -> Result<(), NetworkError> {
        let chosen = self.canvas.free_points_in(polygon)?;
        self.touched();
        self.redos += 1;
        for (class, span) in self.spans(self.canvas.points().len()).collect::<Vec<_>>() {
            let mut rng = Rng::new(self.parameters.seed, Purpose::Region { class: class as u16, redo: self.redos });
            let erased: Vec<usize> = chosen.iter().copied().filter(|point| span.contains(point)).collect();
            if erased.is_empty() {
                continue;
            }
            let mut places = self.scatter(&mut rng, span.len());
            places.retain(|&place| self.canvas.lies_in(place, polygon));
            let mut values: Vec<usize> = erased.iter().map(|&point| self.sources()[point]).collect();
            rng.shuffle(&mut values);
            for (place, (&point, value)) in erased.iter().zip(values).enumerate() {
                let before = self.canvas.points()[point];
                let place = places
                    .get(place)
                    .copied()
                    .unwrap_or_else(|| self.canvas.random_place_in(polygon, &mut rng, before));
                self.canvas.points_mut()[point] = place;
                self.canvas.sources_mut()[point] = value;
            }
        }
        let (class, scale, finished) = (self.class(), self.ladder.scale, self.finished);
        let redo = self.redo.get_or_insert_with(|| Redo { points: Vec::new(), class, scale, finished });
        redo.points.extend(chosen);
        redo.points =
            order(redo.points.iter().map(|&point| point as f64)).into_iter().map(|at| redo.points[at]).collect();
        redo.points.dedup();
        self.finished = false;
        self.turn = 0;
        self.ladder.restart = 0;
        self.best = None;
        self.ladder.renew(self.prepared.schedule(&self.parameters));
        self.begin_class();
        Ok(())
    }

    /// The region is done: back to where the run was.
    pub(super) fn end_redo(&mut self, redo: &Redo) {
        self.turn = self.prepared.order.iter().position(|&class| class == redo.class).unwrap_or(0);
        self.ladder.scale = redo.scale;
        self.finished = redo.finished;
        self.ladder.renew(self.prepared.schedule(&self.parameters));
        if self.finished {
            self.handover.drop_networks();
        }
    }

    /// The same run with other parameters, from the points as they are: one that is done goes through the finer scales
    /// again, one under way goes on at the new parameters' scale that is next to its own. Pins hold.
    ///
    /// # Errors
    /// Those of [`Self::new`], and when the output would have another size or its classes another order: then its points
    /// are no start.
    pub fn continue_with(&self, parameters: Parameters, memory_limit: u64) -> Result<Self, NetworkError> {
        let refuse = |reason: String| Err(NetworkError::Continue(reason));
        if self.redo.is_some() {
            return refuse("a region is being done again; other parameters have to wait for it".to_owned());
        }
        let mut run = Self::prepare(self.exemplar().clone(), parameters, memory_limit)?;
        if run.canvas.size() != self.canvas.size() {
            return refuse(format!(
                "the result has {} × {} exemplars; another size needs another start",
                self.parameters.expansion_x, self.parameters.expansion_y
            ));
        }
        if run.prepared.order != self.prepared.order {
            return refuse("its classes would be placed in another order; that needs another start".to_owned());
        }
        run.canvas.adopt(&self.canvas);
        run.class_starts = self.class_starts.clone();
        run.redos = self.redos;
        run.total_iterations = self.total_iterations;
        run.ladder.scale = run.parameters.restart_scale();
        if !self.finished {
            run.turn = self.turn;
            let sigma = self.ladder.current().sigma;
            let scales = run.ladder.scales();
            // The least difference counts: ladders of one exemplar differ in their last digits at most where they meet.
            let next = scales.iter().position(|scale| scale.sigma < 1.001 * sigma);
            run.ladder.scale = next.unwrap_or(scales.len() - 1);
        }
        Ok(run)
    }
}
