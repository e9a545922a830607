//! The part of a rectangle that points are looked for in, as the statistics need it: its area, what a pair counts for, and
//! independent points within it.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, SQRT_2};

use glam::DVec2;

use super::cloud::Cloud;
use crate::pattern::{Boundary, Window, WindowIndex, convex_hull};
use crate::sampling::Rng;

/// Pixels along the longer side of a region. A disk's set covariance is then right to a few thousandths.
const SIDE: usize = 256;
/// The covariance is known for every second pixel: between them it is as good as straight.
const STRIDE: usize = 2;
/// Pixels in a word of a row.
const WORD: usize = 64;

/// A window in the unit of a cloud, prepared.
#[derive(Clone, Debug)]
pub(super) struct Region {
    window: Window,
    index: WindowIndex,
    low: DVec2,
    high: DVec2,
    area: f64,
    /// Whether it is a guess from the points.
    found: bool,
    /// Distance of the offsets whose covariance is known: from −columns to columns of them, and from 0 to rows.
    step: f64,
    columns: usize,
    rows: usize,
    /// Set covariance over the area, row by row: the share of the region that stays in it when it is moved.
    covariance: Vec<f64>,
}

impl PartialEq for Region {
    fn eq(&self, other: &Self) -> bool {
        self.window == other.window && self.found == other.found
    }
}

impl Region {
    pub(super) fn new(window: Window, found: bool) -> Self {
        let (index, (low, high), area) = (window.index(), window.bounds(), window.area());
        let pixel = (high - low).max_element() / SIDE as f64;
        let count = ((high - low) / pixel).ceil().clamp(DVec2::ONE, DVec2::splat(SIDE as f64));
        let (columns, rows) = (count.x as usize, count.y as usize);
        let words = columns.div_ceil(WORD);
        let mut mask = vec![0_u64; rows * words];
        let mut spans = Vec::new();
        for row in 0..rows {
            index.crossings(low.y + (row as f64 + 0.5) * pixel, &mut spans);
            for span in spans.chunks_exact(2) {
                // The pixels whose middle lies in the span.
                let place = |x: f64| ((x - low.x) / pixel + 0.5).floor().clamp(0.0, columns as f64) as usize;
                for column in place(span[0])..place(span[1]) {
                    mask[row * words + column / WORD] ^= 1 << (column % WORD);
                }
            }
        }
        let covariance = covariance(&mask, columns, rows);
        Self {
            window,
            index,
            low,
            high,
            area,
            found,
            step: STRIDE as f64 * pixel,
            columns: columns.div_ceil(STRIDE),
            rows: rows.div_ceil(STRIDE),
            covariance,
        }
    }

    pub(super) fn area(&self) -> f64 {
        self.area
    }

    /// Width and height of the rectangle around it.
    pub(super) fn size(&self) -> DVec2 {
        self.high - self.low
    }

    pub(super) fn window(&self) -> &Window {
        &self.window
    }

    /// Whether a place lies outside by more than a rounding.
    pub(super) fn excludes(&self, place: DVec2) -> bool {
        !self.index.contains(place) && self.clearance(place) < -1e-6 * self.size().max_element()
    }

    pub(super) fn found(&self) -> bool {
        self.found
    }

    /// The area in which a point can lie so that the one at this offset is in the region too, from the four known ones around it.
    pub(super) fn overlap(&self, offset: DVec2) -> f64 {
        // Moving by −offset leaves as much.
        let offset = if offset.y < 0.0 { -offset } else { offset };
        let place = offset / self.step;
        let (left, top) = (place.x.floor(), place.y.floor());
        let (along, down) = (place.x - left, place.y - top);
        let width = 2 * self.columns + 1;
        let at = |x: f64, y: f64| {
            if x.abs() > self.columns as f64 || y > self.rows as f64 {
                return 0.0;
            }
            self.covariance[y as usize * width + (x + self.columns as f64) as usize]
        };
        let row = |y: f64| (1.0 - along) * at(left, y) + along * at(left + 1.0, y);
        self.area * ((1.0 - down) * row(top) + down * row(top + 1.0))
    }

    /// Independent points in the region.
    pub(super) fn white_noise(&self, rng: &mut Rng, count: usize) -> Vec<DVec2> {
        let size = self.size();
        let mut points = Vec::with_capacity(count);
        while points.len() < count {
            let point = self.low + DVec2::new(rng.uniform(), rng.uniform()) * size;
            if self.index.contains(point) {
                points.push(point);
            }
        }
        points
    }

    /// How far the outline is from a place: positive within, negative outside.
    pub(super) fn clearance(&self, place: DVec2) -> f64 {
        self.window.clearance(&self.index, place)
    }
}

/// For every second offset of whole pixels, each way, the pixels that stay within, over all: rows of words, so that 64 are
/// counted at once.
fn covariance(mask: &[u64], columns: usize, rows: usize) -> Vec<f64> {
    let words = columns.div_ceil(WORD);
    let all = mask.iter().map(|word| word.count_ones()).sum::<u32>().max(1);
    let (across, along) = (columns.div_ceil(STRIDE), rows.div_ceil(STRIDE));
    let width = 2 * across + 1;
    let mut shares = vec![0.0; width * (along + 1)];
    let mut moved = vec![0_u64; mask.len()];
    for right in 0..across {
        // The mask moved to the left: its pixel at x + shift comes to x.
        let shift = right * STRIDE;
        let (whole, bits) = (shift / WORD, shift % WORD);
        for row in 0..rows {
            for word in 0..words {
                let from = |word: usize| if word < words { mask[row * words + word] } else { 0 };
                let low = from(word + whole) >> bits;
                let high = if bits == 0 { 0 } else { from(word + whole + 1) << (WORD - bits) };
                moved[row * words + word] = low | high;
            }
        }
        let common = |a: &[u64], b: &[u64]| a.iter().zip(b).map(|(a, b)| (a & b).count_ones()).sum::<u32>();
        for down in 0..along {
            let (above, below) = ((rows - down * STRIDE) * words, down * STRIDE * words);
            let share = |count: u32| f64::from(count) / f64::from(all);
            // With a pixel at x its partner is at x + shift, in a row below it or above it.
            shares[down * width + across + right] = share(common(&mask[..above], &moved[below..]));
            shares[down * width + across - right] = share(common(&mask[below..], &moved[..above]));
        }
    }
    shares
}

/// Independent points in a rectangle fill an ellipse so well by chance in one of a hundred patterns.
const ELLIPSE_LEVEL: f64 = 0.01;
/// The convex hull of n independent points leaves, but for one pattern in a thousand, at most this many times ln n / n of
/// the rectangle around them empty. (On average it is 8/3, Rényi & Sulanke 1963. Simulated for 12 to 3000 points.)
const HULL_EMPTY: f64 = 4.5;
/// Fewer independent points than this tell no shape.
const LEAST_POINTS: f64 = 12.0;

/// The convex part of a window's rectangle that its points fill, where the rest is emptier than chance leaves it: an
/// ellipse, or another convex shape. None of a tile.
///
/// Points that gather in groups count for fewer independent ones: n times the square of Clark & Evans's index.
pub(super) fn filled_part(cloud: &Cloud) -> Option<Window> {
    if cloud.boundary() == Boundary::Periodic || (cloud.len() as f64) < LEAST_POINTS {
        return None;
    }
    let points = cloud.points();
    let window = Window::around(points)?;
    let low = points.iter().copied().fold(DVec2::INFINITY, DVec2::min);
    let high = points.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
    let hull = convex_hull(points);
    let spacing = cloud.mean_spacing()?;
    let aggregation = 2.0 * spacing * (cloud.len() as f64 / window.area()).sqrt();
    let independent = cloud.len() as f64 * aggregation.min(1.0).powi(2);
    if independent < LEAST_POINTS {
        return None;
    }
    // The farthest point in units of the ellipse that touches the sides of the box. Four points decide the box; the
    // chance that they touch it where the ellipse does, and that all others lie within, is known.
    let (center, half) = (0.5 * (low + high), 0.5 * (high - low));
    let reach = hull.iter().map(|&corner| ((corner - center) / half).length()).fold(0.0, f64::max);
    let touching = (reach * reach - 1.0).max(0.0).sqrt().min(1.0);
    let chance = ellipse_share(reach).powf(independent - 4.0) * touching.powi(4);
    let filled = Window::new(vec![hull]).ok()?.area() / (4.0 * half.x * half.y);
    let hull_empty = 1.0 - filled > HULL_EMPTY * independent.ln() / independent;
    if chance > ELLIPSE_LEVEL && !hull_empty {
        return None;
    }
    let domain = crate::pattern::Domain::new(DVec2::ZERO, cloud.size()).ok()?;
    window.clipped(domain).ok()
}

/// Share of a square that lies in the disk about its middle whose radius is so many times half a side.
fn ellipse_share(radius: f64) -> f64 {
    if radius <= 1.0 {
        FRAC_PI_4 * radius * radius
    } else if radius >= SQRT_2 {
        1.0
    } else {
        // A quarter: two triangles to the corners that the circle cuts off, and a sector between them.
        let side = (radius * radius - 1.0).sqrt();
        side + 0.5 * radius * radius * (FRAC_PI_2 - 2.0 * libm::acos(1.0 / radius))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    fn disk(corners: usize) -> Window {
        let angle = |i: usize| std::f64::consts::TAU * i as f64 / corners as f64;
        let ring = (0..corners).map(|i| 0.5 + 0.5 * DVec2::new(libm::cos(angle(i)), libm::sin(angle(i))));
        Window::new(vec![ring.collect()]).unwrap()
    }

    #[test]
    fn the_set_covariance_of_a_disk_and_of_a_rectangle() {
        let region = Region::new(disk(720), false);
        let exact = |h: f64| 0.5 * libm::acos(h) - 0.5 * h * (1.0 - h * h).sqrt();
        for i in 0..50 {
            let (h, angle) = (f64::from(i) * 0.018, f64::from(i) * 0.7);
            let offset = h * DVec2::new(libm::cos(angle), libm::sin(angle));
            let error = region.overlap(offset) - exact(h);
            assert!(error.abs() < 0.0015, "{error} at {h}");
            // Another distance is told apart.
            assert!((region.overlap(1.1 * offset + 0.01) - exact(h)).abs() > 0.0015, "{h}");
        }
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [0.0, 0.5]].map(DVec2::from);
        let rectangle = Region::new(Window::new(vec![corners.to_vec()]).unwrap(), false);
        for offset in [DVec2::new(0.3, 0.1), DVec2::new(-0.3, 0.1), DVec2::new(-0.31, -0.123), DVec2::new(0.7, -0.4)] {
            let overlap = (1.0 - offset.x.abs()) * (0.5 - offset.y.abs());
            assert!((rectangle.overlap(offset) - overlap).abs() < 0.002, "{offset}: {}", rectangle.overlap(offset));
        }
        assert_eq!(rectangle.overlap(DVec2::new(2.0, 0.0)), 0.0);
    }

    #[test]
    fn a_shape_with_a_direction_keeps_it() {
        // A triangle: moved along its slope it keeps more than moved across it.
        let triangle = Window::new(vec![[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(DVec2::from).to_vec()]).unwrap();
        let region = Region::new(triangle, false);
        let exact = |x: f64, y: f64| {
            // What two such triangles have in common is a smaller one.
            let side: f64 = f64::min(1.0, 1.0 + x + y) - f64::max(0.0, x) - f64::max(0.0, y);
            0.5 * side.max(0.0).powi(2)
        };
        for (x, y) in [(0.2, 0.1), (0.2, -0.2), (-0.3, 0.1), (-0.1, -0.4)] {
            let found = region.overlap(DVec2::new(x, y));
            assert!((found - exact(x, y)).abs() < 0.004, "{x} {y}: {found} instead of {}", exact(x, y));
        }
        assert!(region.overlap(DVec2::new(0.2, -0.2)) > region.overlap(DVec2::new(0.2, 0.2)) + 0.1);
    }

    #[test]
    fn clearance_is_the_way_to_the_outline() {
        let region = Region::new(disk(720), false);
        assert!((region.clearance(DVec2::splat(0.5)) - 0.5).abs() < 1e-4);
        assert!((region.clearance(DVec2::new(1.5, 0.5)) + 0.5).abs() < 1e-4);
    }

    #[test]
    fn the_share_of_a_disk_in_its_square() {
        assert_eq!(ellipse_share(1.0), FRAC_PI_4);
        assert_eq!(ellipse_share(1.5), 1.0);
        // Counted on a grid.
        let inside = (0..1_000_000).filter(|i| {
            let (x, y) = ((f64::from(i % 1000) + 0.5) / 1000.0, (f64::from(i / 1000) + 0.5) / 1000.0);
            x * x + y * y <= 1.44
        });
        let share = inside.count() as f64 / 1e6;
        assert!((ellipse_share(1.2) - share).abs() < 1e-3 && (ellipse_share(1.1) - share).abs() > 0.02);
    }
}
