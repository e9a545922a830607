//! What looks as if it were not meant in a pattern that can be used as it is, and what can be done about it.

use glam::DVec2;

use super::Note;
use crate::analysis::{Cloud, largest_empty_circle, nearest_distances};
use crate::pattern::{Boundary, Domain, PointPattern, RADIUS_ATTRIBUTE, mean_nearest_distance};
use crate::sorting;

/// Below this many points the statistics are those of a few accidents.
const FEW: usize = 16;

/// Everything odd about a pattern, in words. None of the gallery's exemplars has any.
#[must_use]
pub fn oddities(pattern: &PointPattern) -> Vec<Note> {
    let mut notes = Vec::new();
    let all = pattern.len();
    let places = Places::of(pattern.positions());
    same_places(pattern, &places, &mut notes);
    if places.distinct.len() < 2 {
        notes.push(Note::odd("There are no two points at different places, so there is no arrangement to learn."));
        return notes;
    }
    if all < FEW {
        notes.push(Note::odd(format!("There are only {all} points; a few dozen say more.")));
    }
    let far = far_places(&places, &mut notes);
    if far.is_empty()
        && let Some(band) = empty_band(pattern.positions(), pattern.domain())
    {
        notes.push(Note::odd(format!(
            "A strip of {} along the {} side of the domain is empty, wider than any hole between the points: the domain \
             is larger than what the points fill. If the strip does not belong to the pattern, choose another domain.",
            about(band.width),
            band.side
        )));
    }
    on_a_line(&places, &mut notes);
    let near: Vec<DVec2> =
        (0..places.distinct.len()).filter(|place| !far.contains(place)).map(|place| places.distinct[place]).collect();
    nearly_same(&near, &mut notes);
    large_disks(pattern, &mut notes);
    notes
}

/// Where points lie, each place once.
struct Places {
    distinct: Vec<DVec2>,
    counts: Vec<usize>,
}

impl Places {
    fn of(positions: &[DVec2]) -> Self {
        let up = sorting::order(positions.iter().map(|point| point.y + 0.0));
        let along = sorting::order(up.iter().map(|&i| positions[i].x + 0.0));
        let (mut distinct, mut counts): (Vec<DVec2>, Vec<usize>) = (Vec::new(), Vec::new());
        for rank in along {
            let point = positions[up[rank]];
            match counts.last_mut() {
                Some(count) if distinct.last() == Some(&point) => *count += 1,
                _ => {
                    distinct.push(point);
                    counts.push(1);
                }
            }
        }
        Self { distinct, counts }
    }
}

/// Points that lie exactly on others, and what looks like the place of points whose place is not known.
fn same_places(pattern: &PointPattern, places: &Places, notes: &mut Vec<Note>) {
    /// So many points in one place are no accident of doubled rows.
    const CROWD: usize = 3;
    let all = pattern.len();
    let doubled = all - places.distinct.len();
    if doubled == 0 {
        return;
    }
    let most = places.counts.iter().copied().max().unwrap_or(0);
    let crowded = places.counts.iter().position(|&count| count == most).map_or(DVec2::ZERO, |at| places.distinct[at]);
    let at_zero = places.distinct.iter().position(|&place| place == DVec2::ZERO).map_or(0, |at| places.counts[at]);
    let at = |place: DVec2| format!("({}, {})", place.x, place.y);
    if places.distinct.len() > 1 && at_zero > 1 {
        notes.push(Note::odd(format!(
            "{at_zero} of the {all} points lie at exactly (0, 0), as where places are not known: remove them if they are \
             not meant."
        )));
    } else if places.distinct.len() > 1 && most >= CROWD {
        notes.push(Note::odd(format!(
            "{most} of the {all} points lie at exactly {}: remove them if that stands for a place that is not known.",
            at(crowded)
        )));
    }
    notes.push(Note::odd(match doubled {
        1 => format!("One of the {all} points lies exactly on another: remove it if it is not meant."),
        _ => format!("{doubled} of the {all} points lie exactly on others: remove them if they are not meant."),
    }));
}

/// Places far from where nearly all points are: which they are, of the distinct ones.
fn far_places(places: &Places, notes: &mut Vec<Note>) -> Vec<usize> {
    /// Beyond the middle four fifths of the points by so many times their extent. Of a normal cloud that is 10 σ.
    const FAR: f64 = 4.0;
    /// The same for a place that stands for none.
    const FAR_ZERO: f64 = 1.0;
    /// Fewer points have no middle.
    const LEAST: usize = 8;
    /// Share of the places that may be far; more are a part of the pattern.
    const SHARE: f64 = 0.03;
    let distinct = &places.distinct;
    if distinct.len() < LEAST {
        return Vec::new();
    }
    let middle = |axis: usize| {
        let mut values: Vec<f64> = distinct.iter().map(|place| place[axis]).collect();
        sorting::ascending(&mut values);
        let tenth = values.len() / 10;
        (values[tenth.max(1)], values[values.len() - 1 - tenth.max(1)])
    };
    let ((left, right), (bottom, top)) = (middle(0), middle(1));
    let (low, high) = (DVec2::new(left, bottom), DVec2::new(right, top));
    let extent = (high - low).max_element();
    let beyond = |place: DVec2| (low - place).max(place - high).max_element() / extent;
    let limit = |place: DVec2| if place == DVec2::ZERO { FAR_ZERO } else { FAR };
    let far: Vec<usize> = (0..distinct.len()).filter(|&i| beyond(distinct[i]) > limit(distinct[i])).collect();
    if extent <= 0.0 || far.is_empty() || far.len() as f64 > (SHARE * distinct.len() as f64).max(1.0) {
        return Vec::new();
    }
    let points: usize = far.iter().map(|&place| places.counts[place]).sum();
    let first = distinct[far[0]];
    let times = far.iter().map(|&place| beyond(distinct[place])).fold(f64::INFINITY, f64::min);
    let (subject, them) = match points {
        1 => (format!("One point, at ({}, {}), lies", first.x, first.y), "it"),
        _ => (format!("{points} points, one of them at ({}, {}), lie", first.x, first.y), "them"),
    };
    let unknown = if first == DVec2::ZERO { ", or stands for a place that is not known" } else { "" };
    notes.push(Note::odd(format!(
        "{subject} far from all others, {} times the extent of their middle away: remove {them} if that is a mistake{unknown}.",
        about(times)
    )));
    far
}

/// Points that leave one direction unused.
fn on_a_line(places: &Places, notes: &mut Vec<Note>) {
    /// Standard deviation across the line over that along it.
    const THIN: f64 = 0.005;
    /// Fewer points lie on a line by chance.
    const LEAST: usize = 5;
    if places.distinct.len() < LEAST {
        return;
    }
    let count = places.distinct.len() as f64;
    let middle = places.distinct.iter().map(|&place| place / count).sum::<DVec2>();
    let longest = places.distinct.iter().map(|&place| (place - middle).abs().max_element()).fold(0.0, f64::max);
    let ways = || places.distinct.iter().map(|&place| (place - middle) / longest);
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    ways().for_each(|way| (xx, xy, yy) = (xx + way.x * way.x, xy + way.x * way.y, yy + way.y * way.y));
    let direction = DVec2::from_angle(0.5 * libm::atan2(2.0 * xy, xx - yy));
    let square = |axis: DVec2| ways().map(|way| way.dot(axis).powi(2)).sum::<f64>().sqrt();
    let (along, across) = (square(direction), square(direction.perp()));
    if across < THIN * along {
        let exactly =
            if across < 1e-9 * along { "All points lie on a line" } else { "All points lie nearly on a line" };
        notes.push(Note::odd(format!(
            "{exactly}: there is nothing to learn across it. Are x and y the columns that were meant?"
        )));
    }
}

/// Points so near to others that they are most likely the same, measured twice.
fn nearly_same(distinct: &[DVec2], notes: &mut Vec<Note>) {
    /// Against the median distance to the fourth neighbour: of independent points one in ten thousand is nearer to its
    /// first than the wide limit, and one in seven million than the narrow one.
    const WIDE: f64 = 0.005;
    const NARROW: f64 = 0.0002;
    /// So many within the wide limit are no accident.
    const MANY: (usize, f64) = (4, 0.02);
    const NEIGHBOURS: usize = 4;
    let Some((cloud, unit)) = cloud_of(distinct) else { return };
    let Ok(nearest) = nearest_distances(&cloud, NEIGHBOURS) else { return };
    if nearest.neighbours < NEIGHBOURS {
        return;
    }
    let mut fourth: Vec<f64> = nearest.of_rank(NEIGHBOURS).collect();
    sorting::ascending(&mut fourth);
    let median = fourth[fourth.len() / 2];
    let within = |limit: f64| nearest.of_rank(1).filter(|&distance| distance < limit * median).count();
    let (wide, narrow) = (within(WIDE), within(NARROW));
    let many = wide >= MANY.0 && wide as f64 >= MANY.1 * distinct.len() as f64;
    let (count, limit) = if many { (wide, WIDE) } else { (narrow, NARROW) };
    if count > 1 {
        notes.push(Note::odd(format!(
            "{count} of the points lie within {} of another, far nearer than the rest: remove those that are there twice.",
            about(limit * median * unit)
        )));
    }
}

/// Disks that hold the centres of their neighbours: radii in another unit than the places.
fn large_disks(pattern: &PointPattern, notes: &mut Vec<Note>) {
    let radius = pattern.attributes().iter().find(|one| one.name.trim().eq_ignore_ascii_case(RADIUS_ATTRIBUTE));
    let (Some(radius), Some((cloud, unit))) = (radius, cloud_of(pattern.positions())) else { return };
    let Ok(nearest) = nearest_distances(&cloud, 1) else { return };
    let apart: Vec<(f64, f64)> =
        nearest.of_rank(1).map(|distance| distance * unit).zip(radius.values.iter().copied()).collect();
    let covering = apart.iter().filter(|&&(distance, radius)| distance > 0.0 && radius > distance).count();
    if 2 * covering <= pattern.len() {
        return;
    }
    let mut ratios: Vec<f64> =
        apart.iter().filter(|(distance, _)| *distance > 0.0).map(|(distance, radius)| radius / distance).collect();
    sorting::ascending(&mut ratios);
    notes.push(Note::odd(format!(
        "{covering} of the {} disks cover the centre of their nearest neighbour: the radii are {} times as large as the \
         distances between points. Are they in another unit than the positions?",
        pattern.len(),
        about(ratios[ratios.len() / 2])
    )));
}

/// Points in their own box whose longer side is 1, and that side. None where they lie in one place.
fn cloud_of(points: &[DVec2]) -> Option<(Cloud, f64)> {
    /// Points on a line still need a rectangle.
    const LEAST_SIDE: f64 = 1e-3;
    let low = points.iter().copied().fold(DVec2::INFINITY, DVec2::min);
    let extent = points.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max) - low;
    let unit = extent.max_element();
    if !(unit > 0.0 && unit.is_finite()) {
        return None;
    }
    let size = (extent / unit).max(DVec2::splat(LEAST_SIDE));
    let points = points.iter().map(|&point| (point - low) / unit).collect();
    Some((Cloud::new(points, size, Boundary::Open).ok()?, unit))
}

/// A strip along a side of a rectangle without a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EmptyBand {
    /// In the unit of the rectangle.
    pub(super) width: f64,
    pub(super) side: &'static str,
}

/// A strip between the points and a side of a rectangle that is wider than the largest hole within the points' box, and
/// that independent points would leave empty in fewer than one of a thousand patterns. The widest, if there is one.
///
/// Points that gather in groups count for fewer independent ones: n times the square of Clark & Evans's index.
pub(super) fn empty_band(positions: &[DVec2], domain: Domain) -> Option<EmptyBand> {
    /// The chance that independent points leave such a strip along any of four sides.
    const LEVEL: f64 = 1e-3;
    /// Points nearer to one another than this share of the strip are one, so that a crowd costs no time.
    const GRAIN: f64 = 0.01;
    let low = positions.iter().copied().fold(DVec2::INFINITY, DVec2::min);
    let high = positions.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
    let (before, after) = (low - domain.min(), domain.max() - high);
    let margins = [(before.x, 0, "left"), (after.x, 0, "right"), (before.y, 1, "low-y"), (after.y, 1, "high-y")];
    let (width, axis, side) =
        margins.into_iter().fold((0.0, 0, ""), |widest, one| if one.0 > widest.0 { one } else { widest });
    let places = Places::of(positions).distinct;
    let chance = |independent: f64| 4.0 * (1.0 - width / domain.size()[axis]).max(0.0).powf(independent);
    if chance(places.len() as f64) > LEVEL {
        return None;
    }
    let extent = high - low;
    let unit = extent.max_element();
    let places: Vec<DVec2> = places.into_iter().map(|place| (place - low) / unit).collect();
    let spacing = mean_nearest_distance(&places, None)?;
    let area = (extent.x / unit + spacing) * (extent.y / unit + spacing);
    let aggregation = 2.0 * spacing * (places.len() as f64 / area).sqrt();
    if chance(places.len() as f64 * aggregation.min(1.0).powi(2)) > LEVEL {
        return None;
    }
    let found = EmptyBand { width, side };
    // No circle within the box is wider than the box.
    if width >= extent.min_element() {
        return Some(found);
    }
    let grain = GRAIN * width / unit;
    let mut cells: Vec<(u64, u64, usize)> =
        places.iter().enumerate().map(|(i, place)| ((place.x / grain) as u64, (place.y / grain) as u64, i)).collect();
    cells.sort_unstable();
    cells.dedup_by_key(|&mut (x, y, _)| (x, y));
    let kept = cells.into_iter().map(|(_, _, i)| places[i]).collect();
    let cloud = Cloud::new(kept, extent / unit, Boundary::Open).ok()?;
    (width > 2.0 * largest_empty_circle(&cloud).radius * unit).then_some(found)
}

/// Two digits that matter, without an exponent where that is short.
pub(super) fn about(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let rounded: f64 = format!("{value:.1e}").parse().unwrap_or(value);
    if (1e-4..1e6).contains(&rounded.abs()) { format!("{rounded}") } else { format!("{rounded:e}") }
}
