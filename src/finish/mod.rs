//! What puts results right, whatever made them: the points' places, and whose values they carry.
//!
//! Each step compares with the exemplar and touches only what it says is wrong, so a pattern in which nothing is wrong is
//! left as it is. [`Finishing::apply`] runs them in order:
//!
//! | step | what it puts right |
//! |---|---|
//! | [`relocation`] | points on top of one another, where there is a hole elsewhere |
//! | [`alignment`] | neighbourhoods that nearly match one of the exemplar's |
//! | [`single_moves`] | a point too many in one place, and one too few in another |
//! | [`values`] | attribute values in the wrong place |
//! | [`spacing`] | points, groups and borders too close to one another |
//! | [`disks`] | disks that overlap more than the exemplar's |
//! | [`holes`] | holes a little too large |
//!
//! [`perturbation`] prepares another try for the regions that are still worst.

pub mod alignment;
pub mod arrangement;
pub mod disks;
pub mod holes;
pub mod perturbation;
pub mod relocation;
pub mod single_moves;
pub mod spacing;
pub mod values;

use glam::DVec2;

use self::alignment::{align, undo_torn_holes};
use self::disks::{Disks, Overlaps, separate};
use self::holes::shrink_hole;
use self::relocation::relocate;
use self::single_moves::move_single_points;
use self::spacing::{Room, keep_apart, keep_off_border};
use self::values::{Exchange, Values};
use crate::analysis::Cloud;
use crate::pattern::{Boundary, PointPattern};
use crate::sampling::Rng;

pub use self::arrangement::{Arrangement, Limits};

/// Alignments at most, with relocations between them.
const ALIGNMENTS: usize = 3;
/// How often single points are moved and neighbourhoods aligned in turn at most.
const SINGLE_MOVES: usize = 2;
/// Steps at shrinking holes at most; one hole may take several.
const HOLE_STEPS: usize = 100;

/// Which steps are taken, and how far each goes. 0 leaves a step out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finishing {
    /// Share of the exemplar's smallest distance that points keep.
    pub spacing_floor: f64,
    /// Share of the points that may be relocated.
    pub relocation: f64,
    /// Rounds of alignment.
    pub alignment: u32,
    /// Tries at moves of single points.
    pub single_moves: u32,
    /// Share of the exemplar's distances that disks keep.
    pub disk_overlap: f64,
    /// Sweeps of exchanges of values.
    pub value_swaps: u32,
    /// Whether nothing follows. Before a further descent groups that are only forming are not torn apart, and holes that
    /// it will close are not drawn together.
    pub is_last: bool,
}

/// The exemplar as a class that is being placed sees it.
#[derive(Clone, Debug)]
pub struct Reference<'a> {
    /// All of it.
    pub exemplar: &'a PointPattern,
    /// Which of its points are of the classes placed so far.
    pub seen: &'a [usize],
    /// These points in exemplar units, with their classes.
    pub cloud: Cloud,
    /// The class being placed.
    pub class: u16,
    /// For each of the exemplar's points when its class is placed, from 0.
    pub turns: &'a [u16],
    /// Radii of the disks that its points stand for, in exemplar units.
    pub radii: Option<&'a [f64]>,
}

/// The rectangle of the output, and which of its points may move.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// The first point that may move; those before it are frozen.
    pub first: usize,
    /// Width and height in exemplar units.
    pub size: DVec2,
    /// What lies beyond the border.
    pub boundary: Boundary,
}

impl Finishing {
    /// Whether no step is taken; `has_disks` says whether the points stand for disks.
    #[must_use]
    pub fn is_idle(&self, has_disks: bool) -> bool {
        let by_places =
            self.spacing_floor > 0.0 || self.relocation > 0.0 || self.alignment > 0 || self.single_moves > 0;
        !by_places && self.value_swaps == 0 && !has_disks
    }

    /// Takes the steps. `sources[i]` is the exemplar point whose values point `i` carries; `rng` decides which values
    /// are offered for exchange.
    pub fn apply(
        &self,
        points: &mut [DVec2],
        sources: &mut [usize],
        reference: &Reference<'_>,
        frame: Frame,
        rng: &mut Rng,
    ) {
        let exemplar = &reference.cloud;
        let Some(limits) = Limits::of(exemplar) else { return };
        let classes = reference.classes_of(sources);
        let arrangement =
            Arrangement { classes: &classes, first: frame.first, size: frame.size, boundary: frame.boundary };
        self.place(points, arrangement, exemplar, limits);
        if self.value_swaps > 0 {
            self.exchange_values(points, sources, reference, frame, rng);
        }
        if self.spacing_floor > 0.0 {
            // The whole of it even where points may stand closer to one another: they press against the border.
            keep_off_border(points, arrangement, limits.border);
        }
        self.space(points, sources, reference, arrangement, limits);
    }

    /// Relocation, alignment and single moves.
    fn place(&self, points: &mut [DVec2], arrangement: Arrangement<'_>, exemplar: &Cloud, limits: Limits) {
        let most = (self.relocation * (points.len() - arrangement.first) as f64).ceil() as usize;
        relocate(points, arrangement, limits, most);
        let align = |points: &mut [DVec2]| {
            let before = points.to_vec();
            align(points, arrangement, exemplar, self.alignment);
            undo_torn_holes(points, &before, arrangement, limits);
        };
        if self.alignment > 0 {
            for _ in 0..ALIGNMENTS {
                align(points);
                // One too many for its row now stands on another, and can go where one is missing.
                if relocate(points, arrangement, limits, most) == 0 {
                    break;
                }
            }
        }
        // What is torn open before the last pass closes in it.
        let hole = if self.is_last { limits.hole } else { f64::INFINITY };
        for _ in 0..SINGLE_MOVES {
            let moved = move_single_points(points, arrangement, exemplar, Limits { hole, ..limits }, self.single_moves);
            if moved == 0 || self.alignment == 0 {
                break;
            }
            // The rest of a row that is no longer too full or too empty; then others can be told apart.
            align(points);
        }
    }

    /// Brings the values of the points that may move to where they fit.
    fn exchange_values(
        &self,
        points: &[DVec2],
        sources: &mut [usize],
        reference: &Reference<'_>,
        frame: Frame,
        rng: &mut Rng,
    ) {
        let Some(values) = Values::of(reference.exemplar, reference.class) else { return };
        let Ok(output) = Cloud::new(points.to_vec(), frame.size, frame.boundary) else { return };
        let Ok(output) = output.with_classes(reference.classes_of(sources)) else { return };
        let exchange = Exchange::new(&values, (&reference.cloud, reference.seen), &output, frame.first);
        exchange.run(sources, self.value_swaps, rng);
    }

    /// Spacing, disks and holes.
    fn space(
        &self,
        points: &mut [DVec2],
        sources: &mut [usize],
        reference: &Reference<'_>,
        arrangement: Arrangement<'_>,
        limits: Limits,
    ) {
        let mut room = Room::of(limits, self.spacing_floor, arrangement.size, points.len());
        if !self.is_last {
            // Groups that are only forming would be torn.
            room.clumps = Default::default();
        }
        // The class that moves has the highest number.
        let disks = reference.radii.and_then(|radii| {
            let all = Cloud::of(reference.exemplar).with_classes(reference.turns.to_vec()).ok()?;
            let turn = reference.seen.iter().map(|&point| reference.turns[point]).max()?;
            let overlaps = Overlaps::of(&all, radii, turn, self.disk_overlap);
            Some((Disks { radii, classes: reference.turns }, overlaps))
        });
        // A hole a little too wide is shrunk once no descent follows that would open it again.
        let rounds = if self.is_last && self.relocation > 0.0 { HOLE_STEPS } else { 0 };
        for more in (0..=rounds).rev() {
            if let Some((disks, overlaps)) = &disks {
                separate(points, sources, arrangement, *disks, overlaps, room);
            } else if self.spacing_floor > 0.0 {
                keep_apart(points, arrangement, room);
            }
            if more == 0 || !shrink_hole(points, arrangement, limits) {
                break;
            }
        }
    }
}

impl Reference<'_> {
    /// Class of the points that carry these exemplar points' values.
    #[must_use]
    pub fn classes_of(&self, sources: &[usize]) -> Vec<u16> {
        sources.iter().map(|&source| self.exemplar.classes()[source]).collect()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

    use super::*;
    use crate::Domain;
    use crate::analysis::nearest_distances;
    use crate::sampling::Purpose;

    const ALL: Finishing = Finishing {
        spacing_floor: 1.0,
        relocation: 0.1,
        alignment: 20,
        single_moves: 20,
        disk_overlap: 0.0,
        value_swaps: 0,
        is_last: true,
    };

    fn lattice(side: usize, unit: f64) -> Vec<DVec2> {
        (0..side * side).map(|i| (DVec2::new((i % side) as f64, (i / side) as f64) + 0.5) * unit).collect()
    }

    fn finished(settings: Finishing, points: &[DVec2]) -> Vec<DVec2> {
        let exemplar =
            PointPattern::new(Domain::UNIT, lattice(6, 1.0 / 6.0)).unwrap().with_boundary(Boundary::Periodic);
        let seen: Vec<usize> = (0..exemplar.len()).collect();
        let turns = vec![0; exemplar.len()];
        let reference = Reference {
            cloud: Cloud::of(&exemplar),
            exemplar: &exemplar,
            seen: &seen,
            class: 0,
            turns: &turns,
            radii: None,
        };
        let mut points = points.to_vec();
        let mut sources: Vec<usize> = (0..points.len()).map(|point| point % exemplar.len()).collect();
        let frame = Frame { first: 0, size: DVec2::splat(2.0), boundary: Boundary::Periodic };
        settings.apply(&mut points, &mut sources, &reference, frame, &mut Rng::new(1, Purpose::Gallery));
        points
    }

    #[test]
    fn a_broken_lattice_is_put_right_and_a_whole_one_left_alone() {
        let whole = lattice(12, 1.0 / 6.0);
        let moved =
            finished(ALL, &whole).iter().zip(&whole).map(|(after, before)| after.distance(*before)).fold(0.0, f64::max);
        assert!(moved < 1e-12, "{moved}");
        let mut broken = whole.clone();
        broken[40] = broken[41] + 0.01;
        broken[90] += 0.04;
        let farthest = |points: &[DVec2]| {
            let astray =
                |place: &DVec2| points.iter().map(|point| point.distance(*place)).fold(f64::INFINITY, f64::min);
            whole.iter().map(astray).fold(0.0, f64::max)
        };
        assert!(farthest(&finished(ALL, &broken)) < 0.01, "{}", farthest(&finished(ALL, &broken)));
        // Negative control: without any step nothing moves.
        let none = Finishing { spacing_floor: 0.0, relocation: 0.0, alignment: 0, single_moves: 0, ..ALL };
        assert!(none.is_idle(false) && !none.is_idle(true) && !ALL.is_idle(false));
        assert_eq!(finished(none, &broken), broken);
    }

    #[test]
    fn each_step_does_its_own_part() {
        let mut broken = lattice(12, 1.0 / 6.0);
        broken[40] = broken[41] + 0.01;
        let closest = |points: &[DVec2]| {
            let cloud = Cloud::new(points.to_vec(), DVec2::splat(2.0), Boundary::Periodic).unwrap();
            nearest_distances(&cloud, 1).unwrap().of_rank(1).fold(f64::INFINITY, f64::min)
        };
        let none = Finishing { spacing_floor: 0.0, relocation: 0.0, alignment: 0, single_moves: 0, ..ALL };
        assert!(closest(&finished(none, &broken)) < 0.02);
        assert!(closest(&finished(Finishing { spacing_floor: 0.5, ..none }, &broken)) > 0.08);
        let relocated = finished(Finishing { relocation: 0.1, ..none }, &broken);
        assert_eq!(relocated.iter().zip(&broken).filter(|(after, before)| after != before).count(), 1);
        assert!(closest(&relocated) > 0.16);
    }
}
