//! *Alignment*: neighbourhoods that nearly match one of the exemplar's are made to match.
//!
//! The statistics that the filters see are means over the whole picture, and a point that stands a little beside its
//! place changes them little: rows come out slightly wavy, rings slightly dented. What is missing is small and local, so
//! it is put right locally. Every point looks for the exemplar's most similar neighbourhood, and each of its neighbours
//! is asked to stand where that neighbourhood has one (the neighbourhood term of Ma, Wei & Tong 2011, *Discrete Element
//! Textures*, §4, with offsets matched one by one).
//!
//! Nothing is asked of a neighbourhood that matches as well as the exemplar's own match one another. So lattices become
//! exact, shapes clean, and random patterns, no two neighbourhoods of which are alike, are left alone instead of being
//! patched together from copies.

use glam::DVec2;

use super::arrangement::{Arrangement, HOLE, Limits};
use crate::analysis::{Cloud, NEIGHBOURHOOD, Neighbourhoods, largest_empty_circle};
use crate::parallel::for_each_chunk;
use crate::pattern::keep_inside;

/// A neighbour this many mean spacings from its place stands there by mistake rather than by inaccuracy and is asked
/// for less, by a Gaussian of this width.
const WIDTH: f64 = 0.3;
/// Share of the way that a point goes in a round. Both ends of a pair move, and at the whole way they would pass each
/// other.
const STEP: f64 = 0.5;
/// In every so many rounds each point looks for what it is most like; in those between it stays with what it found.
const SEARCHED: u32 = 3;
/// A round that moves no point by more than this share of a mean spacing is the last one.
const STILL: f64 = 2e-3;
/// The rim of a hole reaches this far, in radii of the hole.
const RIM: f64 = 1.5;
/// Holes closed again at most.
const UNDONE: usize = 32;
/// Most pairs of neighbourhoods of output and exemplar that one repair compares, about half a second of work.
pub(super) const MAX_PAIRS: usize = 6_000_000;

/// What an exemplar's neighbourhoods are like, and how alike.
pub(super) struct Reference {
    /// Mean spacing, the unit of all distances here.
    pub(super) spacing: f64,
    pub(super) wanted: Neighbourhoods,
    /// How far each is from the most similar other one.
    pub(super) usual: Vec<f32>,
}

impl Reference {
    #[inline(never)]
    pub(super) fn of(exemplar: &Cloud) -> Option<Self> {
        let spacing = exemplar.mean_spacing()?;
        let wanted = Neighbourhoods::of(exemplar, spacing).ok()?;
        let usual = (0..exemplar.len()).map(|index| wanted.match_within(index)).collect();
        Some(Self { spacing, wanted, usual })
    }

    /// Which of the exemplar's neighbourhoods each of `own` is most like, and how far it is from it, natively on all
    /// threads; see [`Neighbourhoods::best_match`].
    #[inline(never)]
    pub(super) fn matches(&self, own: &Neighbourhoods, guesses: &[usize], searched: bool) -> Vec<Option<(usize, f32)>> {
        let mut matches = vec![None; guesses.len()];
        for_each_chunk(&mut matches, 1, |number, found| {
            found[0] = own.best_match(number, &self.wanted, guesses[number], searched);
        });
        matches
    }
}

/// How much less each point's neighbourhood is like its best match in the exemplar than that one is like another of the
/// exemplar's own, in mean spacings; 0 for those that match as well, and for those that a window's border cuts off.
#[must_use]
pub fn misfits(output: &Cloud, exemplar: &Cloud) -> Vec<f64> {
    let none = || vec![0.0; output.len()];
    let Some(reference) = Reference::of(exemplar) else { return none() };
    let Ok(own) = Neighbourhoods::of(output, reference.spacing) else { return none() };
    let matches = reference.matches(&own, &vec![0; output.len()], true);
    let misfit = |(best, distance): (usize, f32)| (distance - reference.usual[best]).max(0.0).into();
    matches.into_iter().map(|found| found.map_or(0.0, misfit)).collect()
}

/// Moves the points for up to `rounds` rounds; frozen ones count. Classes are distinguished. Returns how many rounds were
/// made.
pub fn align(points: &mut [DVec2], arrangement: Arrangement<'_>, exemplar: &Cloud, rounds: u32) -> u32 {
    let Some(reference) = Reference::of(exemplar) else { return 0 };
    let affordable = MAX_PAIRS / (points.len() * exemplar.len()).max(1);
    let all: Vec<usize> = (0..points.len()).collect();
    reference.align(points, arrangement, &all, rounds.min(affordable as u32))
}

impl Reference {
    /// [`align`] for the neighbourhoods of `some` points.
    #[inline(never)]
    pub(super) fn align(&self, points: &mut [DVec2], arrangement: Arrangement<'_>, some: &[usize], rounds: u32) -> u32 {
        let Arrangement { classes, first, size, boundary } = arrangement;
        let spacing = self.spacing;
        // What a point looked like most in the round before, which it will hardly be less like than anything else now.
        let mut guesses = vec![0; some.len()];
        let mut neighbours = Vec::with_capacity(NEIGHBOURHOOD + 1);
        let mut claims = Vec::with_capacity(NEIGHBOURHOOD);
        for round in 0..rounds {
            let searched = round % SEARCHED == 0;
            let Some(cloud) = arrangement.classed_cloud(points) else { return round };
            let Ok(own) = Neighbourhoods::of_some(&cloud, spacing, some) else { return round };
            let grid = cloud.neighbours();
            let mut asked = vec![(DVec2::ZERO, 0.0); points.len()];
            let matches = self.matches(&own, &guesses, searched);
            for ((&index, guess), found) in some.iter().zip(&mut guesses).zip(matches) {
                let Some((best, distance)) = found else { continue };
                *guess = best;
                let urgency = f64::from(1.0 - self.usual[best] / distance.max(f32::MIN_POSITIVE));
                if urgency <= 0.0 {
                    continue;
                }
                grid.nearest(cloud.points()[index], NEIGHBOURHOOD, Some(index), &mut neighbours);
                claims.clear();
                for neighbour in &neighbours {
                    let class = classes[neighbour.index];
                    let way = self.wanted.way_to_place(best, neighbour.offset / spacing, class);
                    let Some((place, way)) = way else { continue };
                    claims.push((place, way, neighbour.index));
                }
                for &(place, way, neighbour) in &claims {
                    // A place is for one: two that want it would end up on one another.
                    let nearer = |other: &(usize, DVec2, usize)| {
                        other.0 == place && other.1.length_squared() < way.length_squared()
                    };
                    if claims.iter().any(nearer) {
                        continue;
                    }
                    let weight = urgency * libm::exp(-0.5 * way.length_squared() / (WIDTH * WIDTH));
                    for (point, way) in [(neighbour, way), (index, -way)] {
                        asked[point].0 += weight * way;
                        asked[point].1 += weight;
                    }
                }
            }
            let mut farthest = 0.0_f64;
            for (point, (sum, weight)) in points.iter_mut().zip(asked).skip(first) {
                if weight > 0.0 {
                    // Few and doubtful requests carry less far.
                    let way = STEP * sum / weight.max(1.0);
                    farthest = farthest.max(way.length());
                    *point = keep_inside(*point + way * spacing, size, boundary);
                }
            }
            if farthest < STILL {
                return round + 1;
            }
        }
        rounds
    }
}

/// Puts points back to where they were `before` an alignment, round every hole that it tore: one larger than the
/// exemplar's and larger than any before. Where a point is missing its neighbours only draw apart from the gap.
pub fn undo_torn_holes(points: &mut [DVec2], before: &[DVec2], arrangement: Arrangement<'_>, limits: Limits) {
    let Some(old) = arrangement.cloud(before) else { return };
    let largest = largest_empty_circle(&old).radius.max(HOLE * limits.hole);
    for _ in 0..UNDONE {
        let Some(cloud) = arrangement.cloud(points) else { return };
        let hole = largest_empty_circle(&cloud);
        if hole.radius <= largest {
            return;
        }
        cloud.neighbours().within(hole.center.into(), RIM * hole.radius, |rim| points[rim.index] = before[rim.index]);
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

    use super::*;
    use crate::pattern::Boundary;
    use crate::sampling::{Purpose, Rng, white_noise};

    /// `side`² points of a square lattice of spacing 1/6, each moved by a uniform step of up to `jitter` spacings.
    fn grid(side: usize, jitter: f64) -> Vec<DVec2> {
        let mut rng = Rng::new(5, Purpose::Gallery);
        let size = side as f64 / 6.0;
        (0..side * side)
            .map(|i| DVec2::new((i % side) as f64, (i / side) as f64) + 0.5)
            .map(|place| (place + DVec2::new(rng.range(-jitter, jitter), rng.range(-jitter, jitter))) / 6.0)
            .map(|point| keep_inside(point, DVec2::splat(size), Boundary::Periodic))
            .collect()
    }

    fn cloud(points: &[DVec2], size: f64) -> Cloud {
        Cloud::new(points.to_vec(), DVec2::splat(size), Boundary::Periodic).unwrap()
    }

    fn aligned(points: &[DVec2], classes: &[u16], first: usize, exemplar: &Cloud, rounds: u32) -> Vec<DVec2> {
        let mut points = points.to_vec();
        let arrangement = Arrangement { classes, first, size: DVec2::splat(2.0), boundary: Boundary::Periodic };
        align(&mut points, arrangement, exemplar, rounds);
        points
    }

    fn mean_misfit(points: &[DVec2], exemplar: &Cloud) -> f64 {
        misfits(&cloud(points, 2.0), exemplar).iter().sum::<f64>() / points.len() as f64
    }

    #[test]
    fn a_jittered_lattice_becomes_straight() {
        let exemplar = cloud(&grid(6, 0.0), 1.0);
        let jittered = grid(12, 0.15);
        let before = mean_misfit(&jittered, &exemplar);
        let straight = aligned(&jittered, &[0; 144], 0, &exemplar, 200);
        let after = mean_misfit(&straight, &exemplar);
        assert!(before > 0.05 && after < 0.1 * before, "{before} {after}");
        // Negative control: without rounds nothing happens.
        assert_eq!(aligned(&jittered, &[0; 144], 0, &exemplar, 0), jittered);
    }

    #[test]
    fn random_patterns_keep_their_chance() {
        let noise =
            |seed, size: f64, count| white_noise(&mut Rng::new(seed, Purpose::Gallery), DVec2::splat(size), count);
        let (exemplar, sample) = (cloud(&noise(1, 1.0, 90), 1.0), noise(2, 2.0, 360));
        let moved = aligned(&sample, &[0; 360], 0, &exemplar, 20);
        let spacing = exemplar.mean_spacing().unwrap();
        let way = |(a, b): (&DVec2, &DVec2)| {
            let d = (a - b).abs();
            d.min(DVec2::splat(2.0) - d).length() / spacing
        };
        let mean = sample.iter().zip(&moved).map(way).sum::<f64>() / 360.0;
        assert!(mean < 0.3, "{mean} mean spacings");
        // An independent sample is about as good a match as the exemplar is to itself, and stays so.
        assert!(mean_misfit(&sample, &exemplar) < 0.2, "{}", mean_misfit(&sample, &exemplar));
    }

    #[test]
    fn frozen_points_stay() {
        let exemplar = cloud(&grid(6, 0.0), 1.0);
        let points = grid(12, 0.1);
        let moved = aligned(&points, &[0; 144], 30, &exemplar, 50);
        assert_eq!(moved[..30], points[..30]);
        assert_ne!(moved[30..], points[30..]);
    }

    #[test]
    fn a_torn_hole_is_mended() {
        let limits = Limits::of(&cloud(&grid(6, 0.0), 1.0)).unwrap();
        let before = grid(12, 0.05);
        let mut torn = before.clone();
        let centre = DVec2::splat(1.0);
        for point in &mut torn {
            let away = *point - centre;
            if away.length() < 0.4 {
                *point = centre + away.normalize_or(DVec2::X) * 0.4;
            }
        }
        let hole = |points: &[DVec2]| largest_empty_circle(&cloud(points, 2.0)).radius / limits.hole;
        assert!(hole(&torn) > 2.0, "{}", hole(&torn));
        let size = DVec2::splat(2.0);
        let arrangement = Arrangement { classes: &[0; 144], first: 0, size, boundary: Boundary::Periodic };
        undo_torn_holes(&mut torn, &before, arrangement, limits);
        assert!(hole(&torn) <= HOLE.max(hole(&before)) + 1e-9, "{}", hole(&torn));
    }

    #[test]
    fn classes_are_told_apart() {
        // A chequered lattice: with the classes of two neighbours exchanged no neighbourhood there fits.
        let lattice = grid(6, 0.0);
        let chequered: Vec<u16> = (0..36).map(|i| (i % 6 + i / 6) as u16 % 2).collect();
        let exemplar = cloud(&lattice, 1.0).with_classes(chequered.clone()).unwrap();
        let mut exchanged = chequered.clone();
        exchanged.swap(14, 15);
        let misfit = |classes: Vec<u16>| -> f64 {
            misfits(&cloud(&lattice, 1.0).with_classes(classes).unwrap(), &exemplar).iter().sum()
        };
        assert_eq!(misfit(chequered), 0.0);
        assert!(misfit(exchanged) > 1.0);
    }
}
