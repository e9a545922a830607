//! Areas in a file of points: which of them is the window that the points were cut from.

use glam::DVec2;

use super::Note;
use super::note::counted;
use crate::pattern::{Domain, Window};

/// One point in so many may lie outside of its window: places are measured, and outlines are drawn roughly.
const OUTSIDE: usize = 20;

/// The smallest area, told by its closed lines, that nearly all points lie in, else all areas together. What becomes of the
/// areas is noted.
pub(super) fn window(areas: Vec<Vec<Vec<DVec2>>>, positions: &[DVec2], notes: &mut Vec<Note>) -> Option<Window> {
    let count = areas.len();
    if count == 0 {
        return None;
    }
    let together = (count > 1).then(|| areas.concat());
    let mut fewest = positions.len();
    let mut best: Option<(Window, usize)> = None;
    let mut is_all = false;
    for (at, rings) in areas.into_iter().chain(together).enumerate() {
        // What bounds nothing is the window of nothing.
        let Ok(window) = Window::new(rings) else { continue };
        let outside = outside(&window, positions);
        fewest = fewest.min(outside);
        let is_better = best.as_ref().is_none_or(|(smallest, _)| at < count && window.area() < smallest.area());
        if OUTSIDE * outside <= positions.len() && is_better {
            (best, is_all) = (Some((window, outside)), at == count);
        }
    }
    let points = |outside: usize| counted(outside, "one point lies", "points lie");
    let Some((window, outside)) = best else {
        let outlines = counted(count, "One outline of an area was", "outlines of areas were");
        notes.push(Note::left_out(format!("{outlines} left out: {} outside.", points(fewest))));
        return None;
    };
    if !is_all && count > 1 {
        let others = counted(count - 1, "One other outline of an area was", "other outlines of areas were");
        notes.push(Note::left_out(format!("{others} left out, as a pattern has points only.")));
    }
    let outlines = if is_all { format!("{count} outlines of areas") } else { "The outline of an area".to_owned() };
    let are = if is_all { "are" } else { "is" };
    let but = if outside > 0 { format!("; {} outside", points(outside)) } else { String::new() };
    notes.push(Note::changed(format!(
        "{outlines} in the file {are} the window of the points: the rectangle around it is the domain{but}."
    )));
    Some(window)
}

/// How many points lie outside of a window. A point on the outline counts as inside.
fn outside(window: &Window, positions: &[DVec2]) -> usize {
    let index = window.index();
    let (low, high) = window.bounds();
    let near = 1e-9 * (high - low).max_element();
    // The way to the outline is looked for only where it can be short.
    let may_be_near = |point: DVec2| point.cmpge(low - near).all() && point.cmple(high + near).all();
    let is_inside =
        |point: DVec2| index.contains(point) || may_be_near(point) && window.clearance(&index, point) >= -near;
    positions.iter().filter(|point| !is_inside(**point)).count()
}

/// The rectangle around a window and points.
pub(super) fn around(window: &Window, points: &[DVec2]) -> Option<Domain> {
    let (low, high) = window.bounds();
    let low = points.iter().copied().fold(low, DVec2::min);
    let high = points.iter().copied().fold(high, DVec2::max);
    Domain::spanning(low, high).ok()
}

/// Whether a window is one rectangle along the axes.
pub(super) fn is_rectangle(window: &Window) -> bool {
    let [ring] = window.rings() else { return false };
    let (low, high) = window.bounds();
    let is_corner = |point: &DVec2| (point.x == low.x || point.x == high.x) && (point.y == low.y || point.y == high.y);
    ring.len() == 4 && ring.iter().all(is_corner)
}
