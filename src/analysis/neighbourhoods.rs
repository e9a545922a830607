//! Neighbourhoods of one pattern found again in another.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::cloud::{Cloud, check_positive};
use super::error::AnalysisError;
use crate::parallel::for_each_chunk;
use crate::pattern::Boundary;

/// How many neighbours make a neighbourhood.
pub const NEIGHBOURHOOD: usize = 8;
/// Among how many of the other side's they are looked for. In a lattice several neighbours are equally far, and which
/// of them comes eighth is decided by the last digit: hexagonal ones have 6 and 6, square ones 4, 4 and 4.
const SPARE: usize = 12;
/// Neighbourhoods looked up in one go.
const TOGETHER: usize = 16;
/// A window's incomplete neighbourhoods are left out unless fewer than this share is complete.
const ENOUGH: f64 = 0.1;

/// Most pairs of neighbourhoods in one comparison, half a second of work. Beyond it only every second, third, …
/// neighbourhood is looked for (among all of the other side): a mean over a sample.
const MAX_PAIRS: usize = 8_000_000;

/// The nearest neighbours of one point, as offsets from it in units of the exemplar's mean spacing.
#[derive(Clone, Debug)]
struct Neighbourhood {
    x: [f32; SPARE],
    y: [f32; SPARE],
    classes: [u16; SPARE],
    /// How many there are.
    count: usize,
    class: u16,
    /// Whether a window's border could hide a neighbour.
    complete: bool,
}

/// The neighbourhoods of all points of a pattern.
#[derive(Clone, Debug)]
pub struct Neighbourhoods {
    all: Vec<Neighbourhood>,
    single_class: bool,
}

/// How well the neighbourhoods of two patterns match; 0 is best. Distances between two neighbourhoods are Chamfer
/// distances: the mean distance from an offset to the nearest of the other side, both ways averaged. Where classes
/// differ a mean spacing is added.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct NeighbourhoodMatch {
    /// Mean distance from an output's neighbourhood to the best of the exemplar's, in mean spacings of the exemplar:
    /// whether what is there should be.
    pub precision: f64,
    /// Mean distance from an exemplar's neighbourhood to the best of the output's: whether what should be is there.
    pub coverage: f64,
}

impl Neighbourhoods {
    /// The [`NEIGHBOURHOOD`] nearest neighbours of every point; `spacing` is the exemplar's mean spacing in the
    /// cloud's unit.
    ///
    /// # Errors
    /// With a single point, or a spacing that is not positive.
    pub fn of(cloud: &Cloud, spacing: f64) -> Result<Self, AnalysisError> {
        let mut own = Self::of_some(cloud, spacing, &(0..cloud.len()).collect::<Vec<_>>())?;
        let complete = own.all.iter().filter(|one| one.complete).count();
        if (complete as f64) < (ENOUGH * own.all.len() as f64).max(1.0) {
            own.all.iter_mut().for_each(|one| one.complete = true);
        }
        Ok(own)
    }

    /// The same of these points only, in this order, natively on all threads; incomplete ones are left out however many they
    /// are.
    #[inline(never)]
    pub(crate) fn of_some(cloud: &Cloud, spacing: f64, some: &[usize]) -> Result<Self, AnalysisError> {
        cloud.at_least("a neighbourhood", 2)?;
        check_positive("spacing", spacing)?;
        let grid = cloud.neighbours();
        let blank = Neighbourhood {
            // What is missing is never the nearest.
            x: [f32::MAX.sqrt() / 4.0; SPARE],
            y: [f32::MAX.sqrt() / 4.0; SPARE],
            classes: [0; SPARE],
            count: 0,
            class: 0,
            complete: true,
        };
        let mut all = vec![blank; some.len()];
        for_each_chunk(&mut all, TOGETHER, |chunk, all| {
            let mut found = Vec::with_capacity(SPARE + 1);
            for (own, &index) in all.iter_mut().zip(&some[chunk * TOGETHER..]) {
                let (point, class) = (cloud.points()[index], cloud.classes()[index]);
                grid.nearest(point, SPARE, Some(index), &mut found);
                (own.class, own.classes, own.count) = (class, [class; SPARE], found.len());
                for (place, neighbour) in found.iter().enumerate() {
                    own.x[place] = (neighbour.offset.x / spacing) as f32;
                    own.y[place] = (neighbour.offset.y / spacing) as f32;
                    own.classes[place] = cloud.classes()[neighbour.index];
                }
                if cloud.boundary() == Boundary::Open {
                    let to_border = point.min(cloud.size() - point).min_element();
                    let last = found.get(NEIGHBOURHOOD - 1).map(|neighbour| neighbour.distance_squared.sqrt());
                    own.complete = last.is_some_and(|distance| distance <= to_border);
                }
            }
        });
        let single_class = cloud.classes().windows(2).all(|pair| pair[0] == pair[1]);
        Ok(Self { all, single_class })
    }

    /// Precision and coverage of an output's neighbourhoods against an exemplar's, both with the same spacing. What a
    /// window cuts off is not asked for but may be found.
    #[must_use]
    pub fn compare(exemplar: &Self, output: &Self) -> NeighbourhoodMatch {
        NeighbourhoodMatch { precision: output.best_in(exemplar, false), coverage: exemplar.best_in(output, false) }
    }

    /// Mean distance from a neighbourhood to the best of the others of the same pattern: 0 in a lattice, in a random
    /// pattern about what the precision of an independent sample is.
    #[must_use]
    pub fn kinship(&self) -> f64 {
        self.best_in(self, true)
    }

    /// The neighbourhood among `candidates` that is most like the one of this number, and how far it is from it; none
    /// where a window's border cuts it off. A good `guess` saves most of the work; where nothing is `searched`, it is the
    /// only one looked at.
    pub(crate) fn best_match(
        &self,
        index: usize,
        candidates: &Self,
        guess: usize,
        searched: bool,
    ) -> Option<(usize, f32)> {
        let own = &self.all[index];
        let first = candidates.all.get(guess).map(|other| (guess, other));
        let others = candidates.all.iter().enumerate().take(if searched { usize::MAX } else { 0 });
        let among = first.into_iter().chain(others);
        let among = among.filter(|(_, other)| other.complete && other.class == own.class);
        own.complete.then(|| self.best_among(own, candidates, among)).flatten()
    }

    /// How far the most similar other neighbourhood of the same pattern is; infinitely where there is none.
    pub(crate) fn match_within(&self, index: usize) -> f32 {
        let own = &self.all[index];
        let among = self.all.iter().enumerate().filter(|&(number, _)| number != index);
        self.best_among(own, self, among).map_or(f32::INFINITY, |(_, distance)| distance)
    }

    fn best_among<'a>(
        &self,
        own: &Neighbourhood,
        candidates: &Self,
        among: impl Iterator<Item = (usize, &'a Neighbourhood)>,
    ) -> Option<(usize, f32)> {
        let classless = self.is_classless(candidates);
        let mut best = (0, f32::INFINITY);
        for (number, other) in among {
            let distance =
                if classless { plain_distance(own, other, best.1) } else { class_distance(own, other, best.1) };
            if distance < best.1 {
                best = (number, distance);
            }
        }
        best.1.is_finite().then_some(best)
    }

    fn is_classless(&self, candidates: &Self) -> bool {
        self.single_class
            && candidates.single_class
            && self.all.first().map(|one| one.class) == candidates.all.first().map(|one| one.class)
    }

    /// Which place of the neighbourhood of this number is nearest to an offset, among those of the same class, and the
    /// way there, in mean spacings.
    #[inline(never)]
    pub(crate) fn way_to_place(&self, index: usize, offset: DVec2, class: u16) -> Option<(usize, DVec2)> {
        let place = &self.all[index];
        (0..place.count)
            .filter(|&number| place.classes[number] == class)
            .map(|number| (number, DVec2::new(place.x[number].into(), place.y[number].into()) - offset))
            .min_by(|(_, a), (_, b)| a.length_squared().total_cmp(&b.length_squared()))
    }

    /// The places of the neighbourhood of this number, in mean spacings from its point, and their classes.
    pub(crate) fn places(&self, index: usize) -> impl Iterator<Item = (DVec2, u16)> + '_ {
        let own = &self.all[index];
        let count = own.count.min(NEIGHBOURHOOD);
        (0..count).map(|place| (DVec2::new(own.x[place].into(), own.y[place].into()), own.classes[place]))
    }

    /// Mean distance from the complete neighbourhoods to the best among `candidates`, perhaps without the one of the
    /// same number.
    fn best_in(&self, candidates: &Self, without_self: bool) -> f64 {
        let stride = (self.all.len() * candidates.all.len()).div_ceil(MAX_PAIRS).max(1);
        let (mut sum, mut count) = (0.0, 0.0);
        for (index, own) in self.all.iter().enumerate().filter(|(_, one)| one.complete).step_by(stride) {
            let among = candidates.all.iter().enumerate().filter(|&(number, _)| !(without_self && number == index));
            sum += self.best_among(own, candidates, among).map_or(f64::INFINITY, |(_, best)| best.into());
            count += 1.0;
        }
        sum / f64::max(count, 1.0)
    }
}

/// The Chamfer distance of two neighbourhoods, or infinity as soon as it is sure to be `limit` or more.
fn plain_distance(a: &Neighbourhood, b: &Neighbourhood, limit: f32) -> f32 {
    let mut mean = 0.0;
    for (from, to) in [(a, b), (b, a)] {
        let count = from.count.min(NEIGHBOURHOOD);
        let share = 0.5 / count.max(1) as f32;
        for place in 0..count {
            let mut nearest = f32::MAX;
            for (x, y) in to.x.iter().zip(&to.y) {
                let (dx, dy) = (from.x[place] - x, from.y[place] - y);
                let distance = dx * dx + dy * dy;
                nearest = if distance < nearest { distance } else { nearest };
            }
            mean += share * nearest.sqrt();
            if mean >= limit {
                return f32::INFINITY;
            }
        }
    }
    mean
}

/// The same where classes count.
fn class_distance(a: &Neighbourhood, b: &Neighbourhood, limit: f32) -> f32 {
    let mut mean = if a.class == b.class { 0.0 } else { 1.0 };
    for (from, to) in [(a, b), (b, a)] {
        let count = from.count.min(NEIGHBOURHOOD);
        let share = 0.5 / count.max(1) as f32;
        for place in 0..count {
            let mut nearest = f32::INFINITY;
            for other in 0..to.count {
                let (dx, dy) = (from.x[place] - to.x[other], from.y[place] - to.y[other]);
                let penalty = if from.classes[place] == to.classes[other] { 0.0 } else { 1.0 };
                nearest = nearest.min((dx * dx + dy * dy).sqrt() + penalty);
            }
            mean += share * nearest;
            if mean >= limit {
                return f32::INFINITY;
            }
        }
    }
    mean
}
