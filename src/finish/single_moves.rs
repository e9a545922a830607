//! *Single moves*: a point goes from where one is too many to where one is missing.
//!
//! A row with a point too many and another with one too few can't be put right by small steps: every step on the way
//! makes both worse. Each neighbourhood says what is wrong with it, though. Compared with the exemplar's most similar
//! one it has places that no point fills and points that stand in no place. Where several say the same, each end is
//! tried by itself: a point less here, one more there, and the surroundings aligned. The two that together promise most
//! make a move, and what does not match better is undone. (Points that are removed and added where the pattern is worst: Tu et al. 2019, §5, there by weights that are
//! optimised; most similar neighbourhoods: Ma, Wei & Tong 2011, §4.)

use glam::DVec2;

use super::alignment::{MAX_PAIRS, Reference};
use super::arrangement::{Arrangement, HOLE, Limits};
use super::spacing::Room;
use crate::analysis::{Cloud, EmptyCircle, NEIGHBOURHOOD, Neighbourhoods, largest_empty_circle, nearest_distances};
use crate::parallel::for_each_chunk;
use crate::pattern::{Boundary, keep_inside};
use crate::sorting::order;

/// A place this many mean spacings from the next point is not filled, and a point as far from the next place is in none.
const NEAR: f64 = 0.25;
/// Width of the Gaussian, in mean spacings, by which neighbourhoods that miss a point at nearly the same spot agree.
const AGREEMENT: f64 = 0.35;
/// Spots are apart by this many mean spacings, or they are one.
const APART: f64 = 0.5;
/// Neighbourhoods within this many mean spacings of a spot are aligned after a move.
const REACH: f64 = 2.5;
/// Those within this much more feel it.
const RIM: f64 = 1.5;
/// Rounds of that alignment.
const ROUNDS: u32 = 12;
/// [`REACH`] of the moves that follow where an exemplar repeats itself: a row that stands in a zigzag around a point too
/// many becomes straight along a good part of its length.
const WIDE_REACH: f64 = 6.0;
/// Rounds of their alignment.
const WIDE_ROUNDS: u32 = 40;
/// One try with wide surroundings for so many others; each takes a dozen times as long.
const WIDE_SHARE: u32 = 8;
/// Moves with either surroundings follow one another at most so often: what one leaves the other may put right.
const CYCLES: u32 = 4;
/// An exemplar repeats itself when its neighbourhoods are on average this like another of its own, in mean spacings:
/// walls and rows are within 0.09, blue noise, discs and rings begin at 0.2.
const REPEATED: f64 = 0.12;
/// Spots of each kind that are looked at.
const SPOTS: usize = 24;
/// What a point that coincides with another counts as, in mean spacings of misfit; less for what is merely too close.
/// Neighbourhoods hardly differ by a point on top of another, so moves would pile them up.
const CROWDED: f64 = 1.0;
/// What a point counts as in whose clump all would be in one place, in mean spacings of misfit; less for clumps that are
/// merely too tight.
const CLUMPED: f64 = 2.0;
/// A point is isolated when this neighbour of it is far: two or three strays together are isolated all the same.
const ISOLATION_RANK: usize = 4;
/// What a point counts as whose [`ISOLATION_RANK`]th neighbour is twice as far as any in the exemplar, in mean spacings of
/// misfit; less where it is nearer. Neighbourhoods that a window's border cuts off are not compared, so nothing else tells of strays there.
const ISOLATED: f64 = 4.0;
/// A move must lower the sum of misfits by this many mean spacings more than the alignment does without it.
const GAIN: f64 = 0.2;
/// What the largest hole counts as for each radius of the exemplar's by which it is too large, in mean spacings of misfit.
const OPEN: f64 = 10.0;
/// Misfits below this, in mean spacings, are mere inaccuracy.
const INACCURATE: f64 = 0.02;

/// What is wrong with one neighbourhood.
#[derive(Clone, Debug, Default)]
struct Assessment {
    /// Which of the exemplar's neighbourhoods it is most like.
    like: usize,
    /// How much, in mean spacings.
    misfit: f64,
    /// Where points are missing, and how sorely.
    missing: Vec<(DVec2, f64)>,
    /// Which points are in no place, and how far from one, in mean spacings.
    surplus: Vec<(usize, f64)>,
}

/// One end of a move.
#[derive(Clone, Copy, Debug)]
struct End {
    spot: DVec2,
    /// Which point is taken away there; none where one is put.
    taken: Option<usize>,
    /// By how much that alone changes the misfits.
    change: f64,
}

/// What comes of a change.
struct Tried {
    points: Vec<DVec2>,
    /// Which of them feel it.
    felt: Vec<usize>,
    /// What is wrong with their neighbourhoods.
    assessments: Vec<Assessment>,
    misfit: f64,
}

/// What is aligned after a move.
#[derive(Clone, Copy, Debug)]
struct Surroundings {
    /// Neighbourhoods within this many mean spacings of a spot.
    reach: f64,
    /// In how many rounds.
    rounds: u32,
}

/// Who judges.
struct Judge<'a> {
    reference: &'a Reference,
    arrangement: Arrangement<'a>,
    /// Points with less are a crowd.
    room: Room,
    /// Points whose [`ISOLATION_RANK`]th neighbour is farther than that are isolated.
    most: f64,
}

impl<'a> Judge<'a> {
    /// For outputs of `count` points.
    fn new(
        reference: &'a Reference,
        arrangement: Arrangement<'a>,
        exemplar: &Cloud,
        limits: Limits,
        count: usize,
    ) -> Self {
        let room = Room::of(limits, 1.0, arrangement.size, count);
        Self { reference, arrangement, room, most: HOLE * widest_isolation(exemplar, arrangement.boundary) }
    }

    /// The assessments of `some` points, more quickly if those of all points `before` are known.
    #[inline(never)]
    fn assessments(&self, points: &[DVec2], some: &[usize], before: &[Assessment]) -> Option<Vec<Assessment>> {
        let Reference { spacing, wanted, usual } = self.reference;
        let Arrangement { classes, first, size, boundary } = self.arrangement;
        let moving = *classes.get(first)?;
        let cloud = self.arrangement.classed_cloud(points)?;
        let own = Neighbourhoods::of_some(&cloud, *spacing, some).ok()?;
        let grid = cloud.neighbours();
        let guesses: Vec<usize> = some.iter().map(|&index| before.get(index).map_or(0, |before| before.like)).collect();
        let matches = self.reference.matches(&own, &guesses, true);
        let mut found = Vec::with_capacity(NEIGHBOURHOOD + 1);
        let assessments = some.iter().zip(matches).map(|(&index, best)| {
            let mut assessment = Assessment::default();
            grid.nearest(points[index], NEIGHBOURHOOD, Some(index), &mut found);
            let distance = |rank: usize| found.get(rank - 1).map(|found| found.distance_squared.sqrt());
            // 0 where any distance will do: `max` drops what 0 / 0 gives.
            let lacks = |rank: usize, least: f64| distance(rank).map_or(0.0, |found| (1.0 - found / least).max(0.0));
            let clumps = self.room.clumps.into_iter().zip(2..);
            let clump = clumps.map(|(least, rank)| lacks(rank, least)).fold(0.0, f64::max);
            let crowd = CROWDED * lacks(1, self.room.distance);
            let isolated =
                distance(ISOLATION_RANK).map_or(0.0, |widest| ISOLATED * (widest / self.most - 1.0).clamp(0.0, 1.0));
            // Who of a clump is one too many, its neighbourhoods tell.
            assessment.misfit = crowd + CLUMPED * clump + isolated;
            if crowd + isolated > 0.0 && index >= first {
                assessment.surplus.push((index, crowd + isolated));
            }
            let Some((best, distance)) = best else { return assessment };
            assessment.like = best;
            let misfit = f64::from(distance - usual[best]);
            if misfit < INACCURATE {
                assessment.misfit += misfit.max(0.0);
                return assessment;
            }
            assessment.misfit += misfit;
            for neighbour in &found {
                let way = wanted.way_to_place(best, neighbour.offset / *spacing, classes[neighbour.index]);
                let astray = way.map_or(1.0, |(_, way)| way.length().min(1.0)) - NEAR;
                if astray > 0.0 && neighbour.index >= first {
                    assessment.surplus.push((neighbour.index, astray));
                }
            }
            for (place, class) in wanted.places(best) {
                let spot = points[index] + place * *spacing;
                let within = boundary == Boundary::Periodic || (spot.cmpge(DVec2::ZERO) & spot.cmple(size)).all();
                if class != moving || !within {
                    continue;
                }
                grid.nearest(spot, 1, None, &mut found);
                let empty = found.first().map_or(1.0, |nearest| nearest.distance_squared.sqrt() / spacing) - NEAR;
                if empty > 0.0 {
                    assessment.missing.push((keep_inside(spot, size, boundary), empty));
                }
            }
            assessment
        });
        Some(assessments.collect())
    }

    /// The points most agree to be in the way, the worst first, and how much.
    fn surplus(&self, assessments: &[Assessment]) -> Vec<(usize, f64)> {
        let mut sums = vec![0.0; assessments.len()];
        for &(index, astray) in assessments.iter().flat_map(|assessment| &assessment.surplus) {
            sums[index] += astray;
        }
        let worst = order(sums.iter().map(|sum| -sum)).into_iter().take(SPOTS);
        worst.map(|index| (index, sums[index])).filter(|(_, sum)| *sum > 0.0).collect()
    }

    /// The spots most agree to miss a point at, the worst first, and how much.
    fn missing(&self, assessments: &[Assessment]) -> Vec<(DVec2, f64)> {
        let Arrangement { size, boundary, .. } = self.arrangement;
        let all = || assessments.iter().flat_map(|assessment| &assessment.missing);
        let Ok(cloud) = Cloud::new(all().map(|(spot, _)| *spot).collect(), size, boundary) else { return Vec::new() };
        let empty: Vec<f64> = all().map(|(_, empty)| *empty).collect();
        let grid = cloud.neighbours();
        let width = AGREEMENT * self.reference.spacing;
        let mut agreed = vec![(DVec2::ZERO, 0.0); empty.len()];
        for (&spot, (middle, sum)) in cloud.points().iter().zip(&mut agreed) {
            let mut way = DVec2::ZERO;
            grid.within(spot, 3.0 * width, |other| {
                let weight = empty[other.index] * libm::exp(-0.5 * other.distance_squared / (width * width));
                way += weight * other.offset;
                *sum += weight;
            });
            *middle = keep_inside(spot + way / *sum, size, boundary);
        }
        let mut chosen: Vec<(DVec2, f64)> = Vec::with_capacity(SPOTS);
        for index in order(agreed.iter().map(|(_, sum)| -sum)) {
            let spot = agreed[index];
            if chosen
                .iter()
                .all(|other| self.arrangement.way(other.0, spot.0).length() > APART * self.reference.spacing)
            {
                chosen.push(spot);
            }
            if chosen.len() == SPOTS {
                break;
            }
        }
        chosen
    }

    fn near(&self, a: DVec2, b: DVec2, reach: f64) -> bool {
        self.arrangement.way(a, b).length() < reach * self.reference.spacing
    }

    /// Which points are near either spot.
    #[inline(never)]
    fn within(&self, points: &[DVec2], spots: [DVec2; 2], reach: f64) -> Vec<usize> {
        (0..points.len()).filter(|&index| spots.iter().any(|&spot| self.near(points[index], spot, reach))).collect()
    }

    /// Aligns the points near these spots and assesses again those that feel it.
    #[inline(never)]
    fn tried(
        &self,
        mut points: Vec<DVec2>,
        spots: [DVec2; 2],
        surroundings: Surroundings,
        before: &[Assessment],
    ) -> Option<Tried> {
        let Surroundings { reach, rounds } = surroundings;
        let felt = self.within(&points, spots, reach + RIM);
        let some = self.within(&points, spots, reach);
        self.reference.align(&mut points, self.arrangement, &some, rounds);
        let assessments = self.assessments(&points, &felt, before)?;
        let misfit = assessments.iter().map(|assessment| assessment.misfit).sum();
        Some(Tried { points, felt, assessments, misfit })
    }

    /// [`move_single_points`] with such surroundings.
    #[inline(never)]
    fn run_moves(&self, points: &mut [DVec2], limits: Limits, surroundings: Surroundings, left: &mut u32) -> usize {
        let arrangement = self.arrangement;
        let reach = surroundings.reach;
        let all: Vec<usize> = (0..points.len()).collect();
        let Some(mut assessments) = self.assessments(points, &all, &[]) else { return 0 };
        let none = EmptyCircle { center: [0.0; 2], radius: 0.0 };
        let hole_of = |points: &[DVec2]| arrangement.cloud(points).map_or(none, |cloud| largest_empty_circle(&cloud));
        let allowed = HOLE * limits.hole;
        let mut hole = hole_of(points);
        let largest = hole.radius.max(allowed);
        // Ends of moves, as long as nothing near them has changed.
        let mut known: Vec<End> = Vec::new();
        // Moves that brought nothing, as long as nothing near them has changed.
        let mut failed: Vec<(DVec2, DVec2)> = Vec::new();
        // A hole may open for a while: what leaves it may come back from elsewhere.
        let mut state = points.to_vec();
        let (mut moves_made, mut kept) = (0, 0);
        'moves: loop {
            let mut missing = self.missing(&assessments);
            if hole.radius > allowed {
                missing.push((hole.center.into(), OPEN));
            }
            let fills = |spot: DVec2| hole.radius > allowed && spot == DVec2::from(hole.center);
            let surplus = self.surplus(&assessments);
            let misfit = |spots: [DVec2; 2]| -> f64 {
                self.within(&state, spots, reach + RIM).into_iter().map(|index| assessments[index].misfit).sum()
            };
            // Either end by itself: that takes fewer tries than all pairs.
            let mut ends: Vec<End> = Vec::new();
            for number in 0..surplus.len() + missing.len() {
                let taken = surplus.get(number).map(|&(index, _)| index);
                let spot = taken.map_or_else(|| missing[number - surplus.len()].0, |index| state[index]);
                let same = known.iter().find(|end| end.spot == spot);
                let change = same.map_or(f64::NAN, |end| end.change);
                ends.push(End { spot, taken, change });
            }
            for end in ends.iter_mut().filter(|end| end.change.is_nan()) {
                if *left == 0 {
                    end.change = f64::INFINITY;
                } else {
                    *left -= 1;
                }
            }
            for_each_chunk(&mut ends, 1, |_, ends| {
                let End { spot, taken, change } = &mut ends[0];
                if change.is_nan() {
                    let mut others = state.clone();
                    match *taken {
                        Some(index) => drop(others.remove(index)),
                        None => others.push(*spot),
                    }
                    let spots = [*spot; 2];
                    let after = self.tried(others, spots, surroundings, &assessments);
                    *change = after.map_or(f64::INFINITY, |after| after.misfit - misfit(spots));
                }
            });
            // The most promising first. What ends near one another bring is not the sum of what each does, and a hole
            // counts besides.
            let together = |number: usize| {
                let (from, to) = (number / missing.len(), number % missing.len());
                let (from, to) = (&ends[from], &ends[surplus.len() + to]);
                let special = self.near(from.spot, to.spot, reach + RIM) || fills(to.spot);
                f64::min(from.change + to.change, if special { -GAIN } else { f64::INFINITY })
            };
            let promise: Vec<f64> = (0..surplus.len() * missing.len()).map(together).collect();
            known = ends;
            let mut better = None;
            for number in order(promise.iter().copied()) {
                if promise[number] > -GAIN {
                    break;
                }
                let (index, to) = (surplus[number / missing.len()].0, missing[number % missing.len()].0);
                let from = state[index];
                if failed.contains(&(from, to)) {
                    continue;
                }
                if *left == 0 {
                    break 'moves;
                }
                *left -= 1;
                let aligned = |place: DVec2| {
                    let mut moved = state.clone();
                    moved[index] = place;
                    self.tried(moved, [from, to], surroundings, &assessments)
                };
                let Some(after) = aligned(to) else { break 'moves };
                let before = misfit([from, to]);
                let mut gained = before - after.misfit;
                if fills(to) {
                    gained += OPEN * (hole.radius - hole_of(&after.points).radius.max(allowed)) / limits.hole;
                }
                // What the alignment alone would bring does not count.
                let counts = || aligned(from).is_some_and(|alone| GAIN < gained + alone.misfit - before);
                if gained > GAIN && counts() {
                    better = Some((after, from, to));
                    break;
                }
                failed.push((from, to));
            }
            let Some((after, from, to)) = better else { break 'moves };
            after
                .felt
                .into_iter()
                .zip(after.assessments)
                .for_each(|(index, assessment)| assessments[index] = assessment);
            let untouched = |spot: DVec2| [from, to].iter().all(|&end| !self.near(spot, end, 2.0 * (reach + RIM)));
            failed.retain(|&(a, b)| untouched(a) && untouched(b));
            known.retain(|end| untouched(end.spot));
            state = after.points;
            moves_made += 1;
            hole = hole_of(&state);
            if hole.radius <= largest {
                points.copy_from_slice(&state);
                kept = moves_made;
            }
        }
        kept
    }
}

/// The largest distance from a point to its [`ISOLATION_RANK`]th neighbour in the exemplar; infinite where there are too few points. For an output with borders it
/// is that of a window, even where the exemplar repeats: points beside a border have a larger one.
fn widest_isolation(exemplar: &Cloud, boundary: Boundary) -> f64 {
    let cut = match boundary {
        Boundary::Periodic => None,
        Boundary::Open => Cloud::new(exemplar.points().to_vec(), exemplar.size(), boundary).ok(),
    };
    let distances = nearest_distances(cut.as_ref().unwrap_or(exemplar), ISOLATION_RANK);
    let widest = distances.map_or(0.0, |found| found.of_rank(ISOLATION_RANK).fold(0.0, f64::max));
    if widest > 0.0 { widest } else { f64::INFINITY }
}

/// Tries up to `tries` moves of single points and keeps those after which the neighbourhoods on the whole match the
/// exemplar's better; returns how many. None makes a hole larger than the exemplar's, or points a larger crowd.
pub fn move_single_points(
    points: &mut [DVec2],
    arrangement: Arrangement<'_>,
    exemplar: &Cloud,
    limits: Limits,
    tries: u32,
) -> usize {
    if tries == 0 || points.len() * exemplar.len() > MAX_PAIRS {
        return 0;
    }
    let Some(reference) = Reference::of(exemplar) else { return 0 };
    // One more of the class that moves.
    let mut classes = arrangement.classes.to_vec();
    classes.extend(arrangement.classes.last());
    let arrangement = Arrangement { classes: &classes, ..arrangement };
    let judge = Judge::new(&reference, arrangement, exemplar, limits, points.len());
    let unlike: f64 = reference.usual.iter().map(|&usual| f64::from(usual)).sum();
    let repeated = unlike <= REPEATED * exemplar.len() as f64;
    let near = Surroundings { reach: REACH, rounds: ROUNDS };
    let wide = Surroundings { reach: WIDE_REACH, rounds: WIDE_ROUNDS };
    let (mut left, mut left_wide) = (tries, if repeated { tries.div_ceil(WIDE_SHARE) } else { 0 });
    let mut kept = 0;
    for cycle in 0..CYCLES {
        let before = kept;
        kept += judge.run_moves(points, limits, near, &mut left);
        if repeated && (cycle == 0 || kept > before) {
            kept += judge.run_moves(points, limits, wide, &mut left_wide);
        }
        if kept == before || !repeated {
            break;
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

    use super::*;
    use crate::finish::alignment::{align, misfits};
    use crate::sampling::{Purpose, Rng, white_noise};

    const SIZE: DVec2 = DVec2::splat(2.0);

    fn grid(side: usize) -> Vec<DVec2> {
        (0..side * side).map(|i| (DVec2::new((i % side) as f64, (i / side) as f64) + 0.5) / 6.0).collect()
    }

    fn cloud(points: &[DVec2], size: DVec2) -> Cloud {
        Cloud::new(points.to_vec(), size, Boundary::Periodic).unwrap()
    }

    fn arrangement(classes: &[u16], first: usize) -> Arrangement<'_> {
        Arrangement { classes, first, size: SIZE, boundary: Boundary::Periodic }
    }

    fn limits(exemplar: &Cloud) -> Limits {
        Limits::of(exemplar).unwrap()
    }

    fn tried(points: &mut [DVec2], classes: &[u16], first: usize, exemplar: &Cloud) -> usize {
        move_single_points(points, arrangement(classes, first), exemplar, limits(exemplar), 100)
    }

    /// A lattice whose third row has a point too many, and whose ninth one too few, both rows evenly spread.
    fn uneven() -> Vec<DVec2> {
        let row = |count: usize, row: usize| {
            (0..count).map(move |i| DVec2::new((i as f64 + 0.5) * 2.0 / count as f64, (row as f64 + 0.5) / 6.0))
        };
        (0..12).flat_map(|number| row(12 + usize::from(number == 2) - usize::from(number == 8), number)).collect()
    }

    fn wrong(points: &[DVec2], exemplar: &Cloud) -> f64 {
        misfits(&cloud(points, SIZE), exemplar).iter().sum()
    }

    #[test]
    fn a_point_too_many_goes_to_the_row_that_lacks_one() {
        let exemplar = cloud(&grid(6), DVec2::ONE);
        let classes = [0; 144];
        let mut aligned = uneven();
        align(&mut aligned, arrangement(&classes, 0), &exemplar, 200);
        // Negative control: small steps alone don't.
        let row = |points: &[DVec2], row: usize| {
            points.iter().filter(|point| (point.y * 6.0 - 0.5).round() == row as f64).count()
        };
        assert_eq!([row(&aligned, 2), row(&aligned, 8)], [13, 11]);
        let mut moved = aligned.clone();
        assert_eq!(tried(&mut moved, &classes, 0, &exemplar), 1);
        align(&mut moved, arrangement(&classes, 0), &exemplar, 200);
        assert!(wrong(&moved, &exemplar) < 0.5 * wrong(&aligned, &exemplar));
        assert_eq!([row(&moved, 2), row(&moved, 8)], [12, 12]);
        // Without tries, and where nothing is wrong, nothing happens.
        let mut same = aligned.clone();
        assert_eq!(move_single_points(&mut same, arrangement(&classes, 0), &exemplar, limits(&exemplar), 0), 0);
        assert_eq!(same, aligned);
        let mut whole = grid(12);
        assert_eq!(tried(&mut whole, &classes, 0, &exemplar), 0);
        assert_eq!(whole, grid(12));
    }

    #[test]
    fn a_stray_near_the_border_of_a_window_goes_to_where_a_point_is_missing() {
        let block = || grid(6).into_iter().map(|point| 0.25 + 0.5 * point).collect::<Vec<_>>();
        let window = |points: &[DVec2]| Cloud::new(points.to_vec(), DVec2::ONE, Boundary::Open).unwrap();
        let exemplar = window(&block());
        let mut points = block();
        // Two of them, so that neither is far from the next.
        (points[14], points[21]) = (DVec2::new(0.03, 0.04), DVec2::new(0.1, 0.03));
        let classes = [0; 36];
        let arrangement = Arrangement { classes: &classes, first: 0, size: DVec2::ONE, boundary: Boundary::Open };
        assert_eq!(move_single_points(&mut points, arrangement, &exemplar, limits(&exemplar), 100), 2);
        let astray = |place: &DVec2| points.iter().map(|point| point.distance(*place)).fold(f64::INFINITY, f64::min);
        let worst = block().iter().map(astray).fold(0.0, f64::max);
        assert!(worst < 0.01, "{worst}");
    }

    #[test]
    fn points_beside_a_border_are_not_strays() {
        // The exemplar repeats, the output does not.
        let exemplar = cloud(&grid(6), DVec2::ONE);
        let reference = Reference::of(&exemplar).unwrap();
        let points = grid(12);
        let assessments = |points: &[DVec2], boundary: Boundary| {
            let arrangement = Arrangement { classes: &[0; 144], first: 0, size: SIZE, boundary };
            let judge = Judge::new(&reference, arrangement, &exemplar, limits(&exemplar), points.len());
            let all: Vec<usize> = (0..points.len()).collect();
            judge.assessments(points, &all, &[]).unwrap().iter().filter(|assessment| assessment.misfit > 0.01).count()
        };
        assert_eq!(assessments(&points, Boundary::Open), 0);
        assert_eq!(assessments(&points, Boundary::Periodic), 0);
        // Negative control: one that is.
        let strayed: Vec<DVec2> =
            points.iter().map(|&point| if point.x + point.y < 0.2 { point } else { point * 0.7 + 0.6 }).collect();
        assert!(assessments(&strayed, Boundary::Open) > 0);
    }

    #[test]
    fn random_patterns_are_left_alone() {
        let noise =
            |seed, size: f64, count| white_noise(&mut Rng::new(seed, Purpose::Gallery), DVec2::splat(size), count);
        let exemplar = cloud(&noise(1, 1.0, 90), DVec2::ONE);
        let sample = noise(2, 2.0, 360);
        let mut moved = sample.clone();
        let kept = tried(&mut moved, &[0; 360], 0, &exemplar);
        assert!(kept <= 36, "{kept} of 360 points");
    }

    #[test]
    fn frozen_points_stay_and_classes_keep_their_places() {
        // Every second column is of another class, placed before.
        let columns = |side: usize| {
            let mut lattice: Vec<DVec2> = grid(side);
            lattice.sort_by_key(|point| (point.x * 6.0 - 0.5).round() as usize % 2);
            let classes = (0..side * side).map(|i| u16::from(i >= side * side / 2)).collect::<Vec<_>>();
            (lattice, classes)
        };
        let (lattice, classes) = columns(6);
        let exemplar = cloud(&lattice, DVec2::ONE).with_classes(classes).unwrap();
        let (whole, classes) = columns(12);
        let mut broken = whole.clone();
        // Frozen ones may crowd.
        broken[10] = broken[11] + 0.01;
        // Beside a point of its own column; its place is free.
        let empty = broken[100];
        broken[100] = broken[130] + DVec2::new(0.02, 0.08);
        let mut moved = broken.clone();
        assert!(tried(&mut moved, &classes, 72, &exemplar) > 0);
        assert_eq!(moved[..72], broken[..72]);
        let nearest = moved[72..].iter().map(|point| point.distance(empty)).fold(f64::INFINITY, f64::min);
        assert!(nearest < 0.02, "{nearest}");
        let mut frozen = broken.clone();
        assert_eq!(tried(&mut frozen, &classes, 144, &exemplar), 0);
        assert_eq!(frozen, broken);
    }

    #[test]
    fn nothing_is_piled_up() {
        // Twice as many points as the exemplar has room for: wherever one goes it would be on another.
        let exemplar = cloud(&grid(6), DVec2::ONE);
        let mut points = grid(12);
        points.extend(grid(12).iter().map(|point| *point + 0.5 / 6.0));
        tried(&mut points, &[0; 288], 0, &exemplar);
        let all = cloud(&points, SIZE);
        let closest = crate::analysis::nearest_distances(&all, 1).unwrap().of_rank(1).fold(f64::INFINITY, f64::min);
        assert!(closest > 0.04, "{closest}");
    }
}
