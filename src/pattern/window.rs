//! The part of a domain that was looked at: an outline of straight lines, perhaps with holes.

use glam::DVec2;

use super::{Domain, PatternError};

/// Most corners of an outline.
pub const MAX_CORNERS: usize = 10_000;

/// Where points could have been: what lies within an odd number of closed lines. Lines may touch or cross themselves.
#[derive(Clone, Debug, PartialEq)]
pub struct Window {
    rings: Vec<Vec<DVec2>>,
}

impl Window {
    /// A window from closed lines; a last corner that repeats the first is dropped.
    ///
    /// # Errors
    /// When there is no line, one has fewer than three corners, all together more than [`MAX_CORNERS`], a corner is not
    /// finite, or there is no area.
    pub fn new(rings: Vec<Vec<DVec2>>) -> Result<Self, PatternError> {
        let refuse = |reason: String| Err(PatternError::Window { reason });
        let mut rings = rings;
        let corners: usize = rings.iter().map(Vec::len).sum();
        if corners > MAX_CORNERS {
            return refuse(format!("it has {corners} corners; at most {MAX_CORNERS} are allowed"));
        }
        for ring in &mut rings {
            if ring.len() > 1 && ring.first() == ring.last() {
                ring.pop();
            }
            if ring.len() < 3 {
                return refuse(format!("an outline has {} corners; at least 3 are needed", ring.len()));
            }
            if let Some(corner) = ring.iter().find(|corner| !corner.is_finite()) {
                return refuse(format!("the corner ({}, {}) is not finite", corner.x, corner.y));
            }
        }
        if rings.is_empty() {
            return refuse("it has no outline".to_owned());
        }
        let window = Self { rings };
        let (low, high) = window.bounds();
        let size = high - low;
        // Against the rectangle around it: what is left of the rounding of a line is no area.
        if !(size.is_finite() && window.area() > 1e-9 * size.x * size.y) {
            return refuse("it has no area".to_owned());
        }
        Ok(window)
    }

    /// The closed lines.
    #[must_use]
    pub fn rings(&self) -> &[Vec<DVec2>] {
        &self.rings
    }

    /// The lower and the upper corner of the smallest rectangle around it.
    #[must_use]
    pub fn bounds(&self) -> (DVec2, DVec2) {
        bounds(self.rings.iter().flatten())
    }

    /// All sides, from corner to corner.
    pub(crate) fn sides(&self) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
        self.rings.iter().flat_map(|ring| ring.iter().copied().zip(ring.iter().copied().cycle().skip(1)))
    }

    /// How much lies within, in the unit of the corners squared. Exact where no sides cross.
    #[must_use]
    pub fn area(&self) -> f64 {
        /// Most comparisons of a side with a height: some tenths of a second.
        const MOST: usize = 20_000_000;
        let index = self.index();
        let mut heights: Vec<f64> = self.rings.iter().flatten().map(|corner| corner.y).collect();
        crate::sorting::ascending(&mut heights);
        heights.dedup();
        let fullest = index.rows.iter().map(Vec::len).max().unwrap_or(0);
        if heights.len() * fullest > MOST {
            // A scribble: strips of one height do.
            let count = (MOST / fullest).max(1);
            let step = (index.high - index.low) / count as f64;
            heights = (0..=count).map(|i| index.low + i as f64 * step).collect();
        }
        let mut crossings = Vec::new();
        // Between two heights of corners the width is linear.
        let strips = heights.windows(2).map(|pair| {
            index.crossings(0.5 * (pair[0] + pair[1]), &mut crossings);
            let width: f64 = crossings.chunks_exact(2).map(|span| span[1] - span[0]).sum();
            width * (pair[1] - pair[0])
        });
        strips.sum()
    }

    /// Prepares to ask for many points.
    #[must_use]
    pub fn index(&self) -> WindowIndex {
        WindowIndex::new(self)
    }

    /// Whether a point lies within. For many of them, [`Self::index`] is quicker.
    #[must_use]
    pub fn contains(&self, point: DVec2) -> bool {
        self.sides().filter(|&(a, b)| crosses(a, b, point.y) && crossing(a, b, point.y) < point.x).count() % 2 == 1
    }

    /// How far the outline is from a place: positive within, negative outside.
    pub(crate) fn clearance(&self, index: &WindowIndex, place: DVec2) -> f64 {
        let to_side = |(a, b): (DVec2, DVec2)| {
            let (way, side) = (place - a, b - a);
            let length = side.length_squared();
            let along = if length > 0.0 { (way.dot(side) / length).clamp(0.0, 1.0) } else { 0.0 };
            (way - along * side).length_squared()
        };
        let distance = self.sides().map(to_side).fold(f64::INFINITY, f64::min).sqrt();
        if index.contains(place) { distance } else { -distance }
    }

    /// The same in other units: every corner goes through `place`, which must not turn areas into lines.
    ///
    /// # Errors
    /// When it does.
    pub fn map(&self, place: impl Fn(DVec2) -> DVec2) -> Result<Self, PatternError> {
        Self::new(self.rings.iter().map(|ring| ring.iter().map(|&corner| place(corner)).collect()).collect())
    }

    /// The same in the exemplar units of a domain, as
    /// [`positions_in_exemplar_units`](super::PointPattern::positions_in_exemplar_units).
    ///
    /// # Errors
    /// When too little is left of it to have an area.
    pub fn in_exemplar_units(&self, domain: Domain) -> Result<Self, PatternError> {
        let unit = domain.exemplar_unit();
        self.map(|corner| (corner - domain.min()) / unit)
    }

    /// What of it lies in a rectangle (Sutherland & Hodgman 1974, line by line: what they leave along the rectangle's
    /// sides is there and back again, and bounds nothing).
    ///
    /// # Errors
    /// When nothing does.
    pub fn clipped(&self, domain: Domain) -> Result<Self, PatternError> {
        let (low, high) = (domain.min(), domain.max());
        let mut rings = Vec::new();
        for ring in &self.rings {
            let mut ring = ring.clone();
            for (axis, limit, sign) in [(0, low.x, 1.0), (0, high.x, -1.0), (1, low.y, 1.0), (1, high.y, -1.0)] {
                let inside = |corner: DVec2| sign * (corner[axis] - limit) >= 0.0;
                let mut kept = Vec::with_capacity(ring.len() + 4);
                for (i, &to) in ring.iter().enumerate() {
                    let from = ring[(i + ring.len() - 1) % ring.len()];
                    if inside(from) != inside(to) {
                        let along = (limit - from[axis]) / (to[axis] - from[axis]);
                        let mut cut = from + (to - from) * along;
                        cut[axis] = limit;
                        kept.push(cut);
                    }
                    if inside(to) {
                        kept.push(to);
                    }
                }
                ring = kept;
            }
            if ring.len() >= 3 {
                rings.push(ring);
            }
        }
        if rings.is_empty() {
            return Err(PatternError::Window { reason: "nothing of it lies in the domain".to_owned() });
        }
        Self::new(rings)
    }

    /// The smallest convex window that holds all points; none where they lie on a line.
    #[must_use]
    pub fn convex_hull(points: &[DVec2]) -> Option<Self> {
        let ring = convex_hull(points);
        (ring.len() >= 3).then(|| Self::new(vec![ring]).ok()).flatten()
    }

    /// The convex window that points were most likely cut from: their convex hull, larger by √(n / (n − m)) about its
    /// centre of mass, of n points of which m are its corners (Ripley & Rasson 1977). None where they lie on a line, or
    /// hardly any is within the hull.
    #[must_use]
    pub fn around(points: &[DVec2]) -> Option<Self> {
        let ring = convex_hull(points);
        let (all, corners) = (points.len() as f64, ring.len() as f64);
        if corners < 3.0 || all - corners < 0.25 * all {
            return None;
        }
        let (mut area, mut sum) = (0.0, DVec2::ZERO);
        for i in 1..ring.len() - 1 {
            let (a, b) = (ring[i] - ring[0], ring[i + 1] - ring[0]);
            area += a.perp_dot(b);
            sum += a.perp_dot(b) * (a + b) / 3.0;
        }
        let center = ring[0] + sum / area;
        let factor = (all / (all - corners)).sqrt();
        Self::new(vec![ring.into_iter().map(|corner| center + factor * (corner - center)).collect()]).ok()
    }
}

fn bounds<'a>(corners: impl Iterator<Item = &'a DVec2>) -> (DVec2, DVec2) {
    corners.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), &corner| (low.min(corner), high.max(corner)))
}

/// Corners of the convex hull in order around it, none of them within a side (Andrew 1979). Fewer than three where the
/// points lie on a line.
pub(crate) fn convex_hull(points: &[DVec2]) -> Vec<DVec2> {
    let up = crate::sorting::order(points.iter().map(|point| point.y));
    let along = crate::sorting::order(up.iter().map(|&i| points[i].x));
    let sorted: Vec<DVec2> = along.into_iter().map(|rank| points[up[rank]]).collect();
    let mut hull: Vec<DVec2> = Vec::new();
    let mut half = |sorted: &mut dyn Iterator<Item = &DVec2>| {
        let start = hull.len();
        for &point in sorted {
            while hull.len() >= start + 2 {
                let (a, b) = (hull[hull.len() - 2], hull[hull.len() - 1]);
                if (b - a).perp_dot(point - a) > 0.0 {
                    break;
                }
                hull.pop();
            }
            hull.push(point);
        }
        hull.pop();
    };
    half(&mut sorted.iter());
    half(&mut sorted.iter().rev());
    hull
}

/// Whether a side meets a height; a corner belongs to the side that goes up from it.
fn crosses(a: DVec2, b: DVec2, y: f64) -> bool {
    (a.y <= y) != (b.y <= y)
}

/// Where it does.
fn crossing(a: DVec2, b: DVec2, y: f64) -> f64 {
    a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y))
}

/// The sides of a [`Window`] sorted into rows, so that a point is compared with the few that pass its height.
#[derive(Clone, Debug)]
pub struct WindowIndex {
    low: f64,
    high: f64,
    rows: Vec<Vec<(DVec2, DVec2)>>,
}

impl WindowIndex {
    fn new(window: &Window) -> Self {
        let (low, high) = window.bounds();
        let (low, high) = (low.y, high.y);
        let corners = window.rings.iter().map(Vec::len).sum::<usize>();
        // Rows that hold a few sides each of an ordinary outline. A comb has all of them in every row: 256 rows bound that.
        let count = corners.clamp(1, 256);
        let mut index = Self { low, high, rows: vec![Vec::new(); count] };
        for (a, b) in window.sides() {
            if a.y != b.y {
                for row in index.row(a.y.min(b.y))..=index.row(a.y.max(b.y)) {
                    index.rows[row].push((a, b));
                }
            }
        }
        index
    }

    fn row(&self, y: f64) -> usize {
        let count = self.rows.len();
        let row = (y - self.low) / (self.high - self.low) * count as f64;
        (row.max(0.0) as usize).min(count - 1)
    }

    /// Whether a point lies within.
    #[must_use]
    pub fn contains(&self, point: DVec2) -> bool {
        if !(self.low..=self.high).contains(&point.y) {
            return false;
        }
        let sides = self.rows[self.row(point.y)].iter();
        sides.filter(|&&(a, b)| crosses(a, b, point.y) && crossing(a, b, point.y) < point.x).count() % 2 == 1
    }

    /// Where the outline meets a height, from left to right: pairs of places between which a point lies within.
    pub(crate) fn crossings(&self, y: f64, found: &mut Vec<f64>) {
        found.clear();
        if (self.low..=self.high).contains(&y) {
            let sides = self.rows[self.row(y)].iter();
            found.extend(sides.filter(|&&(a, b)| crosses(a, b, y)).map(|&(a, b)| crossing(a, b, y)));
            crate::sorting::ascending(found);
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    fn ring(corners: &[[f64; 2]]) -> Vec<DVec2> {
        corners.iter().copied().map(DVec2::from).collect()
    }

    fn square(low: f64, high: f64) -> Vec<DVec2> {
        ring(&[[low, low], [high, low], [high, high], [low, high]])
    }

    #[test]
    fn a_hole_is_no_part_whichever_way_it_goes_round() {
        let mut hole = square(1.0, 2.0);
        for _ in 0..2 {
            let window = Window::new(vec![square(0.0, 4.0), hole.clone()]).unwrap();
            assert!((window.area() - 15.0).abs() < 1e-12, "{}", window.area());
            assert!(window.contains(DVec2::splat(0.5)) && !window.contains(DVec2::splat(1.5)));
            assert!(window.contains(DVec2::splat(2.5)) && !window.contains(DVec2::splat(4.5)));
            hole.reverse();
        }
    }

    #[test]
    fn what_has_no_area_is_refused() {
        for rings in [
            vec![],
            vec![ring(&[[0.0, 0.0], [1.0, 1.0]])],
            vec![ring(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]])],
            vec![square(0.0, 1.0), square(0.0, 1.0)],
            vec![ring(&[[0.0, 0.0], [1.0, f64::NAN], [2.0, 0.0]])],
        ] {
            assert!(matches!(Window::new(rings.clone()), Err(PatternError::Window { .. })), "{rings:?}");
        }
        // A figure of eight touches itself in the middle.
        let eight = Window::new(vec![ring(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]])]).unwrap();
        assert!(eight.contains(DVec2::new(0.2, 1.0)) && !eight.contains(DVec2::new(1.0, 0.2)));
    }

    #[test]
    fn the_index_says_what_all_sides_say() {
        // A comb of 2500 teeth, and a star.
        let comb = (0..2500).flat_map(|i| {
            let x = f64::from(i);
            [[x, 0.0], [x + 0.1, 9.0], [x + 0.6, 9.0], [x + 0.7, 0.0]]
        });
        let comb: Vec<[f64; 2]> = comb.chain([[2500.0, 0.0], [2500.0, -1.0], [0.0, -1.0]]).collect();
        let star: Vec<[f64; 2]> =
            (0..5).map(|i| f64::from(i) * 144.0_f64.to_radians()).map(|a| [a.cos(), a.sin()]).collect();
        for (corners, most) in [(comb[..].to_vec(), 500), (star, 500)] {
            let corners = if corners.len() > 9999 { corners[5..].to_vec() } else { corners };
            let window = Window::new(vec![ring(&corners)]).unwrap();
            let (index, (low, high)) = (window.index(), window.bounds());
            let mut within = 0;
            for i in 0..most {
                let share = DVec2::new((f64::from(i) * 0.618_034).fract(), (f64::from(i) * 0.754_878).fract());
                let point = low + 1.1 * share * (high - low) - 0.05 * (high - low);
                assert_eq!(index.contains(point), window.contains(point), "{point}");
                within += i32::from(index.contains(point));
            }
            assert!(within > 20, "{within}");
        }
    }

    #[test]
    fn clipping_keeps_what_is_common() {
        let ell =
            ring(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [3.0, 4.0], [3.0, 1.0], [1.0, 1.0], [1.0, 4.0], [0.0, 4.0]]);
        let window = Window::new(vec![ell]).unwrap();
        let domain = Domain::new(DVec2::new(-1.0, 2.0), DVec2::splat(10.0)).unwrap();
        // Two teeth are left, joined by lines along the cut that bound nothing.
        let clipped = window.clipped(domain).unwrap();
        assert!((clipped.area() - 4.0).abs() < 1e-12, "{}", clipped.area());
        assert!(clipped.contains(DVec2::new(0.5, 3.0)) && !clipped.contains(DVec2::new(2.0, 3.0)));
        assert!(window.clipped(Domain::new(DVec2::splat(9.0), DVec2::ONE).unwrap()).is_err());
    }

    #[test]
    fn the_hull_of_a_lattice_is_its_square() {
        let lattice: Vec<DVec2> = (0..100).map(|i| DVec2::new(f64::from(i % 10), f64::from(i / 10))).collect();
        let hull = Window::convex_hull(&lattice).unwrap();
        assert_eq!((hull.rings()[0].len(), hull.area()), (4, 81.0));
        let around = Window::around(&lattice).unwrap();
        assert!((around.area() - 81.0 * 100.0 / 96.0).abs() < 1e-9, "{}", around.area());
        let line: Vec<DVec2> = (0..9).map(|i| DVec2::new(f64::from(i), 2.0)).collect();
        assert!(Window::convex_hull(&line).is_none() && Window::around(&line).is_none());
    }
}
