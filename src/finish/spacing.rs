//! *Spacing*: points are pushed apart until they keep the exemplar's smallest distance, groups of them until they are
//! hardly tighter than its tightest, and single points off an open border as far as its points stay.

use glam::DVec2;

use super::arrangement::{Arrangement, Limits};
use crate::analysis::{CLUMP_SIZES, Cloud};
use crate::pattern::{Boundary, keep_inside};
use crate::sorting::order;

/// Points stand in a clump when it is tighter than the tightest of as many in the exemplar by this factor. Samples of
/// one process differ by nearly as much, and with less, pairs and rings would lose more than clumps cost them.
const CLUMP: f64 = 1.3;
/// Distances are only kept up to this relative radius (Lagae & Dutré 2008): beyond, points would jam long before a
/// lattice is found.
const WIDEST: f64 = 0.76;
/// Rounds of pushing apart at most; each halves the largest overlap or so.
const ROUNDS: usize = 100;
/// A little more distance than asked for, or the last overlaps would only be halved for ever.
const SLACK: f64 = 1.002;
/// Pairs that are farther apart than asked for are left so within this.
const LOOSE: f64 = 1.01;

/// How far points keep from one another.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Room {
    /// From the nearest.
    pub distance: f64,
    /// From the second, third … sixth.
    pub clumps: [f64; CLUMP_SIZES],
}

impl Room {
    /// What `count` points keep: `share` of the exemplar's smallest distance, and clumps hardly tighter than its
    /// tightest. Less before they jam.
    #[must_use]
    pub fn of(limits: Limits, share: f64, size: DVec2, count: usize) -> Self {
        // Twice the radius of discs in the densest packing of as many.
        let packed = 2.0 * (size.x * size.y / (2.0 * 3.0_f64.sqrt() * count as f64)).sqrt();
        let possible = WIDEST * packed;
        let scale = (possible / limits.distance).min(1.0) / CLUMP;
        Self { distance: (share * limits.distance).min(possible), clumps: limits.clumps.map(|least| scale * least) }
    }

    /// Within which others matter.
    pub(super) fn reach(&self) -> f64 {
        SLACK * self.clumps.into_iter().fold(self.distance, f64::max)
    }

    /// Asks this of all pairs, each according to how many of either point's are nearer.
    pub(super) fn demand(&self, contacts: &mut [Contact], count: usize) {
        let mut nearer = vec![0; count];
        for place in order(contacts.iter().map(|contact| contact.length)) {
            let contact = &mut contacts[place];
            let rank = contact.pair.map(|point| nearer[point]).into_iter().fold(0, usize::max);
            let wanted =
                if rank == 0 { self.distance } else { self.clumps[rank.min(CLUMP_SIZES) - 1].max(self.distance) };
            contact.least = contact.least.max(wanted);
            contact.most = contact.most.max(wanted);
            contact.pair.into_iter().for_each(|point| nearer[point] += 1);
        }
    }
}

/// Pushes points apart until they have that much room, or as nearly as a bounded number of rounds comes.
pub fn keep_apart(points: &mut [DVec2], arrangement: Arrangement<'_>, room: Room) {
    let count = points.len();
    settle(points, arrangement, room.reach(), &|contacts| room.demand(contacts, count));
}

/// Moves points that are nearer to an open border than `distance` so far away from it.
pub fn keep_off_border(points: &mut [DVec2], arrangement: Arrangement<'_>, distance: f64) {
    let Arrangement { first, size, boundary, .. } = arrangement;
    if boundary == Boundary::Periodic {
        return;
    }
    // An output may be smaller than its exemplar.
    let inset = DVec2::splat(distance).min(0.5 * size);
    points.iter_mut().skip(first).for_each(|point| *point = point.clamp(inset, size - inset));
}

/// Two points near one another, and the distances they may have.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact {
    /// Which points.
    pub(super) pair: [usize; 2],
    /// From the first to the second.
    offset: DVec2,
    /// How far they are from each other.
    pub(super) length: f64,
    /// How far they should be at least.
    pub(super) least: f64,
    /// How far they should be at most.
    pub(super) most: f64,
}

impl Contact {
    /// Whether neither point may move, as those before `first` may not.
    pub(super) fn is_frozen(&self, first: usize) -> bool {
        self.pair.iter().all(|&point| point < first)
    }
}

/// The pairs within `reach`, each with any distance allowed. A point and its own image are left out: they can't be
/// parted.
pub(super) fn contacts(cloud: &Cloud, reach: f64) -> Vec<Contact> {
    let mut found = Vec::new();
    cloud.neighbours().pairs(reach, |i, j, offset| {
        if i != j {
            found.push(Contact { pair: [i, j], offset, length: offset.length(), least: 0.0, most: f64::INFINITY });
        }
    });
    found
}

/// Moves the points that may move until all pairs within `reach` have the distances that `demand` gives them, or a
/// bounded number of rounds is over, the second half of which only parts what is too close; says whether nothing is in
/// the end.
pub(super) fn settle(
    points: &mut [DVec2],
    arrangement: Arrangement<'_>,
    reach: f64,
    demand: &dyn Fn(&mut [Contact]),
) -> bool {
    let Arrangement { first, size, boundary, .. } = arrangement;
    let mut parted = false;
    for round in 0..ROUNDS {
        let Some(cloud) = arrangement.cloud(points) else { return false };
        let mut contacts = contacts(&cloud, reach);
        demand(&mut contacts);
        let mut push = vec![DVec2::ZERO; points.len()];
        let (mut close, mut loose) = (false, false);
        for contact in contacts {
            let Contact { pair: [i, j], offset, length, least, most } = contact;
            if contact.is_frozen(first) {
                continue;
            }
            let wanted = if length < SLACK * least {
                close |= length < least;
                SLACK * least
            } else if length > SLACK * SLACK * most && round < ROUNDS / 2 {
                loose |= length > LOOSE * most;
                most
            } else {
                continue;
            };
            let direction = if length > 1e-12 {
                offset / length
            } else {
                // Coinciding points part in directions of their own.
                let angle = 2.399_963 * (i + j) as f64;
                DVec2::new(libm::cos(angle), libm::sin(angle))
            };
            let both = i >= first && j >= first;
            let step = direction * (wanted - length) * if both { 0.5 } else { 1.0 };
            if i >= first {
                push[i] -= step;
            }
            if j >= first {
                push[j] += step;
            }
        }
        if !(close || loose) {
            return true;
        }
        parted = !close;
        for (point, push) in points.iter_mut().zip(&push).skip(first) {
            *point = keep_inside(*point + *push, size, boundary);
        }
    }
    parted
}

#[cfg(test)]
mod tests {
    use super::super::arrangement::tests::{arrangement, cloud, grid};
    use super::*;
    use crate::analysis::clumps;
    use crate::sampling::{Purpose, Rng, white_noise};

    #[test]
    fn no_point_stays_nearer_to_an_open_border_than_the_exemplar_s() {
        let limits = |boundary| {
            let exemplar = Cloud::new(grid(6), DVec2::ONE, boundary).unwrap_or_else(|error| unreachable!("{error}"));
            Limits::of(&exemplar).unwrap_or_else(|| unreachable!()).border
        };
        assert!((limits(Boundary::Open) - 1.0 / 12.0).abs() < 1e-12);
        assert_eq!(limits(Boundary::Periodic), 0.0);
        let size = DVec2::new(2.0, 0.1);
        let mut points = [DVec2::new(0.0, 0.06), DVec2::new(1.99, 0.04), DVec2::new(1.2, 0.05)];
        let before = points;
        let rectangle = |first, boundary| arrangement(&[0; 3], first, size, boundary);
        keep_off_border(&mut points, rectangle(0, Boundary::Periodic), 0.03);
        keep_off_border(&mut points, rectangle(3, Boundary::Open), 0.03);
        assert_eq!(points, before, "a torus has no border, and frozen points stay");
        keep_off_border(&mut points, rectangle(0, Boundary::Open), 0.03);
        assert_eq!(points, [DVec2::new(0.03, 0.06), DVec2::new(1.97, 0.04), DVec2::new(1.2, 0.05)]);
        // Where there is no room, the middle.
        keep_off_border(&mut points, rectangle(0, Boundary::Open), 0.08);
        assert_eq!(points.map(|point| point.y), [0.05; 3]);
    }

    #[test]
    fn points_are_kept_as_far_apart_as_the_exemplar_s() {
        for boundary in [Boundary::Open, Boundary::Periodic] {
            let mut points = white_noise(&mut Rng::new(2, Purpose::Gallery), DVec2::ONE, 200);
            points[7] = points[8];
            let distance = |points: &[DVec2]| {
                let cloud = Cloud::new(points.to_vec(), DVec2::ONE, boundary).ok();
                cloud.and_then(|cloud| Limits::of(&cloud)).map_or(0.0, |limits| limits.distance)
            };
            assert_eq!(distance(&points), 0.0);
            let limits = Limits { distance: 0.05, clumps: [0.0; CLUMP_SIZES], hole: 1.0, border: 0.0 };
            let room = Room::of(limits, 1.0, DVec2::ONE, points.len());
            assert_eq!(room, Room { distance: 0.05, ..Room::default() });
            keep_apart(&mut points, arrangement(&[0; 200], 0, DVec2::ONE, boundary), room);
            assert!(distance(&points) >= 0.05 - 1e-12, "{boundary:?}: {}", distance(&points));
            assert!(points.iter().all(|p| p.cmpge(DVec2::ZERO).all() && p.cmple(DVec2::ONE).all()));
        }
    }

    #[test]
    fn no_clump_is_left_tighter_than_the_exemplar_s() {
        let exemplar = cloud(&grid(6));
        // Points may be near one another, only not several.
        let limits = Limits { distance: 0.02, ..Limits::of(&exemplar).unwrap_or_else(|| unreachable!()) };
        let mut points = grid(6);
        for (place, point) in [1, 6, 5, 30].into_iter().zip(0..4) {
            let angle = std::f64::consts::FRAC_PI_2 * f64::from(point);
            points[place] = points[0] + 0.08 * DVec2::new(libm::cos(angle), libm::sin(angle));
        }
        let tight = clumps(&exemplar, &cloud(&points)).unwrap_or(0.0);
        assert!(tight > 2.0, "{tight}");
        let left = |first: usize, room: Room| {
            let mut points = points.clone();
            keep_apart(&mut points, arrangement(&[0; 36], first, DVec2::ONE, Boundary::Periodic), room);
            let far = [14, 15, 20, 21, 22].map(|place| grid(6)[place].distance(points[place]));
            assert!(far.iter().all(|&way| way < 0.02), "{far:?}: those far from a clump hardly move");
            clumps(&exemplar, &cloud(&points)).unwrap_or(f64::INFINITY)
        };
        let room = Room::of(limits, 1.0, DVec2::ONE, 36);
        assert!(left(0, room) < CLUMP + 1e-9, "{}", left(0, room));
        // Round a frozen point too.
        assert!(left(1, room) < CLUMP + 1e-9, "{}", left(1, room));
        // Negative control: pairs alone are no reason to move.
        assert_eq!(left(0, Room { clumps: [0.0; CLUMP_SIZES], ..room }), tight);
    }
}
