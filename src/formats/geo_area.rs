//! Which polygon of GeoJSON is the window that the points lie in.

use glam::DVec2;
use serde_json::Value;

use super::origin::{Projection, eastwards};
use crate::pattern::{Domain, MAX_CORNERS};

/// Of so many points one may lie outside the window: places are measured, and outlines are drawn roughly.
const OUTSIDE: usize = 20;
/// Most comparisons of a point with a side, for all polygons together: some tenths of a second.
const MAX_COMPARISONS: usize = 400_000_000;

/// The polygons of one geometry, each a list of rings.
pub(super) struct Area<'a>(pub(super) Vec<&'a [Value]>);

/// The area around the points.
pub(super) struct Around {
    /// Its place among the areas.
    pub(super) area: usize,
    /// How many points lie outside.
    pub(super) outside: usize,
    /// In the file's coordinates; from 0 to 360 degrees where the points lie across the 180th meridian.
    rings: Vec<Vec<DVec2>>,
}

/// The smallest area that holds nearly all points, if there is one.
pub(super) fn around(areas: &[Area<'_>], positions: &[DVec2], crosses: bool) -> Option<Around> {
    let allowed = positions.len() / OUTSIDE;
    let place = |point: DVec2| if crosses { DVec2::new(eastwards(point.x), point.y) } else { point };
    // An area that leaves out more points than it may on one side is none.
    let inner = |of: fn(&DVec2) -> f64| -> Option<(f64, f64)> {
        let mut values: Vec<f64> = positions.iter().map(|&point| of(&place(point))).collect();
        values.sort_unstable_by(f64::total_cmp);
        Some((*values.get(allowed)?, *values.get(values.len() - 1 - allowed)?))
    };
    let (x, y) = (inner(|point| point.x)?, inner(|point| point.y)?);
    let mut comparisons = 0;
    let mut best: Option<(f64, Around)> = None;
    for (area, polygons) in areas.iter().enumerate() {
        let Some(rings) = rings(polygons) else { continue };
        let rings: Vec<Vec<DVec2>> = rings.into_iter().map(|ring| ring.into_iter().map(place).collect()).collect();
        let (low, high) = bounds(&rings);
        if low.x > x.0 || high.x < x.1 || low.y > y.0 || high.y < y.1 {
            continue;
        }
        comparisons += positions.len() * rings.iter().map(Vec::len).sum::<usize>();
        if comparisons > MAX_COMPARISONS {
            break;
        }
        let outside = positions.iter().filter(|&&point| !contains(&rings, place(point))).count();
        let size = (high - low).x * (high - low).y;
        if outside <= allowed && best.as_ref().is_none_or(|(smallest, _)| size < *smallest) {
            best = Some((size, Around { area, outside, rings }));
        }
    }
    best.map(|(_, around)| around)
}

impl Around {
    /// The rectangle around it and all points, in the file's coordinates.
    pub(super) fn domain(&self, positions: &[DVec2], crosses: bool) -> Option<Domain> {
        let (mut low, mut high) = bounds(&self.rings);
        for point in positions {
            let point = if crosses { DVec2::new(eastwards(point.x), point.y) } else { *point };
            (low, high) = (low.min(point), high.max(point));
        }
        // Rounding must not leave the outermost points outside.
        let digit = low.abs().max(high.abs()) * f64::EPSILON;
        let mut size = high - low;
        for _ in 0..4 {
            size += DVec2::select(high.cmpgt(low + size), digit, DVec2::ZERO);
        }
        Domain::new(low, size).ok()
    }

    /// Its closed lines in metres where the points are.
    pub(super) fn rings(&self, projection: Option<Projection>) -> Vec<Vec<DVec2>> {
        let place = |&point: &DVec2| projection.map_or(point, |projection| projection.project(point));
        self.rings.iter().map(|ring| ring.iter().map(place).collect()).collect()
    }
}

/// The closed lines of an area; none where it has too many corners, or one of them is no place.
fn rings(area: &Area<'_>) -> Option<Vec<Vec<DVec2>>> {
    let lists = || area.0.iter().flat_map(|polygon| polygon.iter()).filter_map(Value::as_array);
    if lists().map(Vec::len).sum::<usize>() > MAX_CORNERS {
        return None;
    }
    let corner = |value: &Value| match value.as_array()?.as_slice() {
        [x, y, ..] => Some(DVec2::new(x.as_f64()?, y.as_f64()?)),
        _ => None,
    };
    let rings: Option<Vec<Vec<DVec2>>> = lists().map(|ring| ring.iter().map(corner).collect()).collect();
    rings.filter(|rings| !rings.is_empty() && rings.iter().all(|ring| ring.len() >= 3))
}

fn bounds(rings: &[Vec<DVec2>]) -> (DVec2, DVec2) {
    let corners = || rings.iter().flatten().copied();
    (corners().fold(DVec2::INFINITY, DVec2::min), corners().fold(DVec2::NEG_INFINITY, DVec2::max))
}

/// Whether a point lies within an odd number of closed lines.
fn contains(rings: &[Vec<DVec2>], point: DVec2) -> bool {
    let mut inside = false;
    for ring in rings {
        let mut from = ring.last().copied().unwrap_or(point);
        for &to in ring {
            if (from.y > point.y) != (to.y > point.y)
                && point.x < from.x + (point.y - from.y) / (to.y - from.y) * (to.x - from.x)
            {
                inside = !inside;
            }
            from = to;
        }
    }
    inside
}
