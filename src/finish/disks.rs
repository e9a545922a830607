//! Disks that overlap as those of the exemplar do, and not at all where those don't.
//!
//! The losses see points and the values they carry, but hardly that two disks share a sliver, and positions move while
//! values stay: so disks of different radii end up in one another (the limit stated by Huang et al. 2022, Fig. 15).
//! After each scale the disks are therefore moved to the nearest places, or as good as, that have the exemplar's
//! overlaps. What is kept is how deep pairs are in one another, from the deepest on: distance over the sum of the radii.

use std::f64::consts::PI;

use glam::DVec2;

use super::arrangement::Arrangement;
use super::spacing::{Contact, Room, contacts, settle};
use crate::analysis::Cloud;
use crate::sorting::{ascending, order};

/// Disks keep a distance of the exemplar's as long as, with it, they fill no more than this share of the area: random
/// packings of equal disks jam at 0.55 when each stays where it fell (Feder 1980), and at 0.84 when pushed.
const FILLED: f64 = 0.55;
/// How far beyond contact pairs are looked at.
const NEAR: f64 = 1.25;
/// How often disks in a jam exchange their values at most.
const EXCHANGES: usize = 12;
/// How many of them may look for another place in one go.
const TIGHTEST: usize = 256;
/// How many places each tries.
const DARTS: usize = 200;
/// Most pairs within reach of each other: below half a second for all rounds of one scale.
const MAX_PAIRS: f64 = 1e6;

/// Radii and classes of an exemplar's points: the output's points carry those of their sources.
#[derive(Clone, Copy, Debug)]
pub struct Disks<'a> {
    /// One radius a point of the exemplar, in exemplar units.
    pub radii: &'a [f64],
    /// One class a point of the exemplar.
    pub classes: &'a [u16],
}

/// How the disks of one class overlap with those of each class up to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Overlaps {
    /// For each other class the overlapping pairs' distances over the sums of their radii, from the deepest on.
    ratios: Vec<Vec<f64>>,
    /// For each other class the ratio that all other pairs keep: the smallest where none overlaps, else 1.
    clear: Vec<f64>,
    /// How many points of the class there are.
    count: usize,
}

impl Overlaps {
    /// Those of an exemplar, its distances multiplied by `share` so that overlaps may be a little deeper (1 keeps them).
    /// Classes are numbered in the order in which they are placed.
    #[must_use]
    pub fn of(exemplar: &Cloud, radii: &[f64], class: u16, share: f64) -> Self {
        let others = usize::from(class) + 1;
        let mut all = vec![Vec::new(); others];
        let classes = exemplar.classes();
        let largest = radii.iter().copied().fold(0.0, f64::max);
        exemplar.neighbours().pairs(2.0 * NEAR * largest, |i, j, offset| {
            let sum = radii[i] + radii[j];
            if i != j && classes[i].max(classes[j]) == class && sum > 0.0 {
                all[usize::from(classes[i].min(classes[j]))].push(offset.length() / sum);
            }
        });
        let area = radii.iter().zip(classes).filter(|of| *of.1 <= class).map(|of| PI * of.0 * of.0).sum::<f64>();
        let roomy = (FILLED * exemplar.area() / area).sqrt().clamp(1.0, NEAR);
        let mut clear = Vec::with_capacity(others);
        for ratios in &mut all {
            ascending(ratios);
            clear.push(ratios.first().map_or(1.0, |least| least.clamp(1.0, roomy)) * share);
            ratios.retain(|&ratio| ratio < 1.0);
            ratios.iter_mut().for_each(|ratio| *ratio *= share);
        }
        Self { ratios: all, clear, count: classes.iter().filter(|&&other| other == class).count() }
    }

    fn none(&self) -> bool {
        self.ratios.iter().all(Vec::is_empty)
    }

    fn widest(&self) -> f64 {
        self.clear.iter().copied().fold(0.0, f64::max)
    }

    /// Gives each pair the distance that the exemplar's pair of the same rank has, by classes; beyond those that
    /// overlap, disks are kept clear of each other.
    fn demand(&self, contacts: &mut [Contact], sources: &[usize], first: usize, disks: Disks<'_>, least: f64) {
        let sum = |contact: &Contact| contact.pair.iter().map(|&point| disks.radii[sources[point]]).sum::<f64>();
        let ranked = if self.none() {
            (0..contacts.len()).collect()
        } else {
            order(contacts.iter().map(|contact| contact.length / sum(contact)))
        };
        // One pair of the exemplar stands for this many.
        let copies = (sources.len() - first) as f64 / self.count.max(1) as f64;
        let mut ranks = vec![0_usize; self.ratios.len()];
        for place in ranked {
            let contact = &mut contacts[place];
            if contact.is_frozen(first) {
                continue;
            }
            let other = contact.pair.iter().map(|&point| usize::from(disks.classes[sources[point]])).min().unwrap_or(0);
            let rank = (ranks[other] as f64 / copies) as usize;
            ranks[other] += 1;
            let sum = sum(contact);
            contact.least = self.clear[other] * sum;
            if let Some(ratio) = self.ratios[other].get(rank) {
                (contact.least, contact.most) = (ratio * sum, (ratio * sum).max(least));
            }
            contact.least = contact.least.max(least);
        }
    }
}

/// Whether so many points with radii up to `largest` can be moved in a time that nobody notices.
#[must_use]
pub fn movable(count: usize, density: f64, largest: f64) -> bool {
    0.5 * PI * (2.0 * NEAR * largest).powi(2) * density * count as f64 <= MAX_PAIRS
}

/// Moves the points that may move until their disks overlap as `overlaps` says and all have the `room` they need. Where
/// they jam, a disk without room exchanges its source with a smaller one that has more, or goes to a place that has. Says
/// whether none is deeper in another than it should be in the end. Frozen points count.
pub fn separate(
    points: &mut [DVec2],
    sources: &mut [usize],
    arrangement: Arrangement<'_>,
    disks: Disks<'_>,
    overlaps: &Overlaps,
    room: Room,
) -> bool {
    let first = arrangement.first;
    let largest = sources.iter().map(|&source| disks.radii[source]).fold(0.0, f64::max);
    let reach = (2.0 * NEAR * largest).max(NEAR * room.reach());
    for _ in 0..EXCHANGES {
        let parted = settle(points, arrangement, reach, &|contacts| {
            overlaps.demand(contacts, sources, first, disks, room.distance);
            room.demand(contacts, sources.len());
        });
        if parted {
            return true;
        }
        let Some(cloud) = arrangement.cloud(points) else { return false };
        // Where disks may overlap, lack of room is no reason.
        if !overlaps.none() || !make_room(&cloud, reach, points, sources, first, disks.radii, overlaps.widest()) {
            return false;
        }
    }
    false
}

/// Lets disks that are too large for their place change with smaller ones in larger places, or else go where there is
/// room; says whether any did.
fn make_room(
    cloud: &Cloud,
    reach: f64,
    points: &mut [DVec2],
    sources: &mut [usize],
    first: usize,
    radii: &[f64],
    clear: f64,
) -> bool {
    // The radius up to which a disk would touch none of its neighbours as they are.
    let mut room = vec![f64::INFINITY; sources.len()];
    for Contact { pair: [i, j], length, .. } in contacts(cloud, reach) {
        room[i] = room[i].min(length / clear - radii[sources[j]]);
        room[j] = room[j].min(length / clear - radii[sources[i]]);
    }
    let excess = |point: usize, source: usize| (radii[source] - room[point]).max(0.0);
    let grid = cloud.neighbours();
    let mut moved = vec![false; sources.len()];
    let tightest = order((0..sources.len()).map(|point| -excess(point, sources[point])));
    for point in tightest.into_iter().filter(|&point| point >= first).take(TIGHTEST) {
        let (own, radius) = (excess(point, sources[point]), radii[sources[point]]);
        if own <= 1e-9 * radius {
            break;
        }
        if moved[point] {
            continue;
        }
        let gain = |other: usize| {
            own + excess(other, sources[other]) - excess(point, sources[other]) - excess(other, sources[point])
        };
        let smaller = |&other: &usize| !moved[other] && radii[sources[other]] < radius;
        let best = (first..sources.len()).filter(smaller).max_by(|&a, &b| gain(a).total_cmp(&gain(b)));
        if let Some(other) = best.filter(|&other| gain(other) > 1e-6 * own) {
            sources.swap(point, other);
            (moved[point], moved[other]) = (true, true);
            continue;
        }
        let free = |place: &DVec2| {
            let mut free = true;
            grid.within(*place, reach, |other| {
                let needed = clear * (radius + radii[sources[other.index]]);
                free &= other.index == point || other.distance_squared >= needed * needed;
            });
            free
        };
        // Places of a sequence that fills the plane evenly (Roberts's R₂), a part of its own for each point.
        let mut places = (0..DARTS).map(|dart| {
            let number = (point * DARTS + dart) as f64;
            (number * DVec2::new(0.754_877_666_246_692_7, 0.569_840_290_998_053_3)).fract() * cloud.size()
        });
        if let Some(place) = places.find(free) {
            points[point] = place;
            moved[point] = true;
        }
    }
    moved.contains(&true)
}
