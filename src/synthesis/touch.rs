//! Hands on the result: points that are put somewhere and held, regions that are done again, other parameters from the
//! points as they are.
//!
//! An engine knows points that stay (up to `moving_from`, all seen) and points that move. So whatever may not move is
//! listed before what may ([`Synthesis::arrangement`]), and neither engine knows of any of this.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::{Synthesis, SynthesisError};
use crate::domain::{Boundary, keep_inside};
use crate::method::Parameters;
use crate::sampling::{Purpose, Rng};
use crate::sorting::order;

/// Darts thrown for one point that is to lie in a region, at most: a lasso may have no width to speak of.
const DARTS: usize = 2000;

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

impl Synthesis {
    /// Whether this point may move.
    fn is_free(&self, point: usize) -> bool {
        !self.pinned[point] && self.redo.as_ref().is_none_or(|redo| redo.points.binary_search(&point).is_ok())
    }

    /// Where the points of the class at hand end in [`Self::points`].
    pub(super) fn end(&self) -> usize {
        self.class_starts.get(self.turn + 1).copied().unwrap_or(self.points.len())
    }

    /// The points of the class at hand and those before it, what may not move first, and where the others begin.
    pub(super) fn arrangement(&self) -> (Vec<usize>, usize) {
        let (start, end) = (self.moving_from(), self.end());
        let mut order: Vec<usize> = (0..start).collect();
        order.extend((start..end).filter(|&point| !self.is_free(point)));
        let first = order.len();
        order.extend((start..end).filter(|&point| self.is_free(point)));
        (order, first)
    }

    /// How many points of the class at hand may move.
    pub(super) fn moving(&self) -> usize {
        (self.moving_from()..self.end()).filter(|&point| self.is_free(point)).count()
    }

    /// For every point of [`Self::points`] whether it is pinned.
    #[must_use]
    pub fn pinned(&self) -> &[bool] {
        &self.pinned
    }

    /// Whether a region is being done again.
    #[must_use]
    pub fn is_redoing(&self) -> bool {
        self.redo.is_some()
    }

    /// Holds points where they are, or lets them go. The scale at hand goes on from its last complete iteration, with
    /// fresh moments.
    ///
    /// # Errors
    /// When there is no such point; nothing has changed then.
    pub fn pin(&mut self, points: &[usize], pinned: bool) -> Result<(), SynthesisError> {
        self.check_points(points)?;
        for &point in points {
            self.pinned[point] = pinned;
        }
        self.touched();
        Ok(())
    }

    /// Puts points elsewhere, in exemplar units, and pins them there. The scale at hand goes on from its last complete
    /// iteration, with fresh moments.
    ///
    /// # Errors
    /// When there is no such point or a place lies outside the output; nothing has changed then.
    pub fn move_points(&mut self, points: &[usize], places: &[DVec2]) -> Result<(), SynthesisError> {
        if points.len() != places.len() {
            return refuse(format!("there are {} places for {} points", places.len(), points.len()));
        }
        let size = self.output_size;
        // False for what is no number.
        let inside = |place: &DVec2| place.cmpge(DVec2::ZERO).all() && place.cmple(size).all();
        if let Some(place) = places.iter().find(|place| !inside(place)) {
            return refuse(format!("({}, {}) lies outside the output, {} × {}", place.x, place.y, size.x, size.y));
        }
        self.pin(points, true)?;
        for (&point, &place) in points.iter().zip(places) {
            self.points[point] = place;
        }
        Ok(())
    }

    fn check_points(&self, points: &[usize]) -> Result<(), SynthesisError> {
        match points.iter().find(|&&point| point >= self.points.len()) {
            Some(point) => refuse(format!("there is no point {point} among {}", self.points.len())),
            None => Ok(()),
        }
    }

    /// Other points may move now, or from elsewhere.
    fn touched(&mut self) {
        self.free_engine();
        self.resumed = None;
        if let Some(best) = &mut self.best {
            // What it was is no more; whatever the try at hand leads to is better.
            best.wrongness = f64::MAX;
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
    pub fn redo_region(&mut self, polygon: &[DVec2]) -> Result<(), SynthesisError> {
        if polygon.len() < 3 || polygon.iter().any(|corner| !corner.is_finite()) {
            return refuse("a region needs three corners or more".to_owned());
        }
        let chosen: Vec<usize> = (0..self.points.len())
            .filter(|&point| !self.pinned[point] && self.lies_in(self.points[point], polygon))
            .collect();
        if chosen.is_empty() {
            return refuse("there is no point in this region that may move".to_owned());
        }
        self.touched();
        self.redos += 1;
        for (class, span) in self.spans().collect::<Vec<_>>() {
            let mut rng = Rng::new(self.parameters.seed, Purpose::Region { class: class as u16, redo: self.redos });
            let erased: Vec<usize> = chosen.iter().copied().filter(|point| span.contains(point)).collect();
            if erased.is_empty() {
                continue;
            }
            let mut places = self.scatter(&mut rng, span.len());
            places.retain(|&place| self.lies_in(place, polygon));
            let mut values: Vec<usize> = erased.iter().map(|&point| self.sources[point]).collect();
            rng.shuffle(&mut values);
            for (place, (&point, value)) in erased.iter().zip(values).enumerate() {
                self.points[point] =
                    places.get(place).copied().unwrap_or_else(|| self.dart(&mut rng, polygon, self.points[point]));
                self.sources[point] = value;
            }
        }
        let (class, scale, finished) = (self.class(), self.scale, self.finished);
        let redo = self.redo.get_or_insert_with(|| Redo { points: Vec::new(), class, scale, finished });
        redo.points.extend(chosen);
        redo.points =
            order(redo.points.iter().map(|&point| point as f64)).into_iter().map(|at| redo.points[at]).collect();
        redo.points.dedup();
        self.finished = false;
        self.turn = 0;
        self.restart = 0;
        self.best = None;
        self.schedule = self.fresh_schedule();
        self.begin_class();
        Ok(())
    }

    /// A place in the polygon; `otherwise` where none is found.
    fn dart(&self, rng: &mut Rng, polygon: &[DVec2], otherwise: DVec2) -> DVec2 {
        let low = polygon.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let high = polygon.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        (0..DARTS)
            .map(|_| DVec2::new(rng.range(low.x, high.x), rng.range(low.y, high.y)))
            .map(|place| keep_inside(place, self.output_size, self.parameters.boundary))
            .find(|&place| self.lies_in(place, polygon))
            .unwrap_or(otherwise)
    }

    /// Whether a point or, in a periodic output, one of its copies lies in the polygon.
    fn lies_in(&self, point: DVec2, polygon: &[DVec2]) -> bool {
        let reach = if self.parameters.boundary == Boundary::Periodic { 1 } else { 0 };
        let shifts = || (-reach..=reach).map(f64::from);
        shifts().any(|x| shifts().any(|y| contains(polygon, point + DVec2::new(x, y) * self.output_size)))
    }

    /// The region is done: back to where the run was.
    pub(super) fn end_redo(&mut self, redo: &Redo) {
        self.turn = self.order.iter().position(|&class| class == redo.class).unwrap_or(0);
        self.scale = redo.scale;
        self.finished = redo.finished;
        self.schedule = self.fresh_schedule();
        if self.finished {
            self.network = None;
            self.gpu_network = None;
        }
    }

    /// The same run with other parameters, from the points as they are: one that is done goes through the finer scales
    /// again, one under way goes on at the new parameters' scale that is next to its own. Pins hold.
    ///
    /// # Errors
    /// Those of [`Self::new`], and when the output would have another size or its classes another order: then its points
    /// are no start.
    pub fn continue_with(&self, parameters: Parameters, memory_limit: u64) -> Result<Self, SynthesisError> {
        if self.redo.is_some() {
            return refuse("a region is being done again; other parameters have to wait for it".to_owned());
        }
        let mut run = Self::prepare(self.exemplar.clone(), parameters, memory_limit)?;
        if run.output_size != self.output_size {
            return refuse(format!(
                "the result has {} × {} exemplars; another size needs another start",
                self.parameters.expansion_x, self.parameters.expansion_y
            ));
        }
        if run.order != self.order {
            return refuse("its classes would be placed in another order; that needs another start".to_owned());
        }
        run.points = self.points.clone();
        run.sources = self.sources.clone();
        run.pinned = self.pinned.clone();
        run.class_starts = self.class_starts.clone();
        run.redos = self.redos;
        run.total_iterations = self.total_iterations;
        run.scale = run.parameters.restart_scale();
        if !self.finished {
            run.turn = self.turn;
            let sigma = self.schedule.scales[self.scale].sigma;
            let scales = &run.schedule.scales;
            // The least difference counts: ladders of one exemplar differ in their last digits at most where they meet.
            let next = scales.iter().position(|scale| scale.sigma < 1.001 * sigma);
            run.scale = next.unwrap_or(scales.len() - 1);
        }
        Ok(run)
    }
}

fn refuse<T>(reason: String) -> Result<T, SynthesisError> {
    Err(SynthesisError::Touch(reason))
}

/// Whether a point lies in a polygon, by the even-odd rule.
fn contains(polygon: &[DVec2], point: DVec2) -> bool {
    let before = polygon.iter().cycle().skip(polygon.len() - 1);
    let crossings = polygon.iter().zip(before).filter(|(a, b)| {
        (a.y > point.y) != (b.y > point.y) && point.x < (b.x - a.x) * (point.y - a.y) / (b.y - a.y) + a.x
    });
    crossings.count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polygon_contains_what_is_inside() {
        let arrow = [[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [1.0, 1.0]].map(DVec2::from);
        for (point, inside) in
            [([1.2, 1.0], true), ([0.8, 1.0], false), ([0.3, 0.2], true), ([-0.1, 1.0], false), ([1.9, 1.2], false)]
        {
            assert_eq!(contains(&arrow, point.into()), inside, "{point:?}");
        }
    }
}
