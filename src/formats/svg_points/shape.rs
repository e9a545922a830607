//! The outlines of shapes, and what of them can be a mark: middle, area and form of every closed piece.

use glam::{DMat2, DVec2};
use roxmltree::Node;
use svgtypes::PointsParser;

use super::canvas::length;
use super::style_sheet::Styles;
use crate::formats::outline::{Segment, ellipse_segments, read_segments};

/// Most lines and curves of one shape.
pub(super) const MAX_SEGMENTS: usize = 1_000_000;
/// How far from an ellipse, in its radii, a shape may be that counts as one: programs round to one decimal.
const ROUNDNESS: f64 = 0.045;
/// Points of a line or curve that are compared with the ellipse.
const SAMPLES: u32 = 8;
/// Fewest corners and curves of what counts as an ellipse, each compared in [`SAMPLES`] points.
const MIN_SEGMENTS: usize = 2;
/// Nodes and weights of Gauss and Legendre's integration on −1 to 1 with six points (Abramowitz and Stegun 1964, table
/// 25.4): exact up to degree 11, which second moments of cubic curves have.
const GAUSS: [(f64, f64); 3] = [
    (0.238_619_186_083_197, 0.467_913_934_572_691),
    (0.661_209_386_466_265, 0.360_761_573_048_139),
    (0.932_469_514_203_152, 0.171_324_492_379_170),
];

/// What a piece of an outline looks like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Form {
    /// An ellipse, however it is written.
    Round,
    /// Any other area, with so many corners; none when it has curves.
    Area { corners: Option<usize> },
    /// All in one place.
    Dot,
    /// Nothing to fill.
    Line,
}

/// A piece of an outline, in the shape's own units.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub(super) form: Form,
    /// Whether it is closed without being filled.
    pub(super) is_closed: bool,
    /// Centroid of the area, or the middle of the box around it.
    pub(super) center: DVec2,
    /// Of a disk with the same area.
    pub(super) radius: f64,
    /// Covariance of the area.
    pub(super) spread: DMat2,
    /// Corners of the box around it.
    pub(super) bounds: [DVec2; 2],
}

impl Piece {
    pub(super) fn size(&self) -> DVec2 {
        self.bounds[1] - self.bounds[0]
    }
}

/// The outline of an element; nothing for what is no shape.
pub(super) fn segments(node: Node, styles: &Styles, viewport: DVec2) -> Option<Vec<Segment>> {
    let diagonal = viewport.length() / std::f64::consts::SQRT_2;
    let x = |name: &str| styles.get(name).or_else(|| node.attribute(name)).and_then(|text| length(text, viewport.x));
    let y = |name: &str| styles.get(name).or_else(|| node.attribute(name)).and_then(|text| length(text, viewport.y));
    let at = |across: &str, down: &str| DVec2::new(x(across).unwrap_or(0.0), y(down).unwrap_or(0.0));
    Some(match node.tag_name().name() {
        "circle" => {
            let radius = styles.get("r").and_then(|text| length(text, diagonal)).unwrap_or(0.0);
            ellipse_segments(at("cx", "cy"), DVec2::splat(radius))
        }
        "ellipse" => {
            let (across, down) = (x("rx"), y("ry"));
            let radii = DVec2::new(across.or(down).unwrap_or(0.0), down.or(across).unwrap_or(0.0));
            ellipse_segments(at("cx", "cy"), radii)
        }
        "rect" => {
            let size = at("width", "height");
            let (across, down) = (x("rx"), y("ry"));
            let radii = DVec2::new(across.or(down).unwrap_or(0.0), down.or(across).unwrap_or(0.0));
            if size.min_element() > 0.0 { rectangle(at("x", "y"), size, radii) } else { Vec::new() }
        }
        "line" => vec![Segment::Move(at("x1", "y1")), Segment::Line(at("x2", "y2"))],
        name @ ("polyline" | "polygon") => {
            let points = PointsParser::from(node.attribute("points").unwrap_or_default()).take(MAX_SEGMENTS);
            let mut segments: Vec<Segment> = points.map(|(x, y)| Segment::Line(DVec2::new(x, y))).collect();
            if let Some(first) = segments.first_mut()
                && let Segment::Line(at) = *first
            {
                *first = Segment::Move(at);
            }
            if name == "polygon" && !segments.is_empty() {
                segments.push(Segment::Close);
            }
            segments
        }
        "path" => read_segments(node.attribute("d").unwrap_or_default(), MAX_SEGMENTS),
        _ => return None,
    })
}

fn rectangle(min: DVec2, size: DVec2, radii: DVec2) -> Vec<Segment> {
    let radii = radii.clamp(DVec2::ZERO, size / 2.0);
    let corners = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y].map(|corner| min + corner * size);
    if radii.min_element() == 0.0 {
        let [a, b, c, d] = corners;
        return vec![Segment::Move(a), Segment::Line(b), Segment::Line(c), Segment::Line(d), Segment::Close];
    }
    // The four quarters of an ellipse, from the lower right one, moved to their corners.
    let quarters = ellipse_segments(DVec2::ZERO, radii);
    let middles =
        [DVec2::ONE, DVec2::Y, DVec2::ZERO, DVec2::X].map(|corner| min + radii + corner * (size - 2.0 * radii));
    let mut segments = Vec::new();
    let mut from = DVec2::X * radii;
    for (quarter, middle) in quarters[1..].iter().zip(middles) {
        let start = middle + from;
        segments.push(if segments.is_empty() { Segment::Move(start) } else { Segment::Line(start) });
        if let Segment::Curve(a, b, end) = *quarter {
            segments.push(Segment::Curve(middle + a, middle + b, middle + end));
            from = end;
        }
    }
    segments.push(Segment::Close);
    segments
}

/// A line or curve as a cubic curve.
type Cubic = [DVec2; 4];

pub(super) fn point(curve: &Cubic, t: f64) -> DVec2 {
    let [a, b, c, d] = *curve;
    let s = 1.0 - t;
    s * s * s * a + 3.0 * s * s * t * b + 3.0 * s * t * t * c + t * t * t * d
}

fn slope(curve: &Cubic, t: f64) -> DVec2 {
    let [a, b, c, d] = *curve;
    let s = 1.0 - t;
    3.0 * (s * s * (b - a) + 2.0 * s * t * (c - b) + t * t * (d - c))
}

fn straight(from: DVec2, to: DVec2) -> Cubic {
    [from, from + (to - from) / 3.0, to + (from - to) / 3.0, to]
}

/// The pieces of an outline. A hole belongs to the piece around it, which is the one before it.
pub(super) fn pieces(segments: &[Segment]) -> Vec<Piece> {
    let mut found: Vec<Piece> = Vec::new();
    let (mut start, mut here) = (DVec2::ZERO, DVec2::ZERO);
    let mut run: Vec<Cubic> = Vec::new();
    let (mut lines, mut curves) = (0, 0);
    let mut add = |run: &mut Vec<Cubic>, is_closed: bool, start: DVec2, corners: Option<usize>| {
        if (is_closed || !run.is_empty())
            && let Some(piece) = piece(run, is_closed, start, corners)
        {
            let is_inside = |outer: &Piece| {
                outer.bounds[0].cmple(piece.bounds[0]).all() && outer.bounds[1].cmpge(piece.bounds[1]).all()
            };
            let is_area = |piece: &Piece| matches!(piece.form, Form::Round | Form::Area { .. });
            if !(is_area(&piece) && found.last().is_some_and(|outer| is_area(outer) && is_inside(outer))) {
                found.push(piece);
            }
        }
        run.clear();
    };
    for segment in segments {
        match *segment {
            Segment::Move(at) => {
                add(&mut run, false, start, (curves == 0).then_some(lines));
                (start, here, lines, curves) = (at, at, 0, 0);
            }
            Segment::Line(to) => {
                run.push(straight(here, to));
                (here, lines) = (to, lines + 1);
            }
            Segment::Curve(a, b, to) => {
                run.push([here, a, b, to]);
                (here, curves) = (to, curves + 1);
            }
            Segment::Close => {
                add(&mut run, true, start, (curves == 0).then_some(lines));
                (here, lines, curves) = (start, 0, 0);
            }
        }
    }
    add(&mut run, false, start, (curves == 0).then_some(lines));
    found
}

/// Middle and form of lines and curves that follow one another.
fn piece(run: &mut Vec<Cubic>, is_closed: bool, start: DVec2, corners: Option<usize>) -> Option<Piece> {
    let points = || run.iter().flatten().copied();
    let low = points().fold(start, DVec2::min);
    let high = points().fold(start, DVec2::max);
    let (middle, extent) = (0.5 * (low + high), (high - low).max_element());
    if !(low.is_finite() && high.is_finite()) {
        return None;
    }
    let mut piece =
        Piece { form: Form::Dot, is_closed, center: middle, radius: 0.0, spread: DMat2::ZERO, bounds: [low, high] };
    // Relative coordinates that lead back can be off by a digit.
    if extent <= 1e-13 * low.abs().max(high.abs()).max_element() {
        return Some(piece);
    }
    let end = run.last().map_or(start, |curve| curve[3]);
    if end.distance(start) > 1e-6 * extent {
        run.push(straight(end, start));
    } else {
        piece.is_closed = true;
    }
    piece.form = Form::Line;
    // In units of the extent, from the middle.
    let unit = |p: DVec2| (p - middle) / extent;
    let (mut area, mut first, mut second, mut mixed) = (0.0, DVec2::ZERO, DVec2::ZERO, 0.0);
    for curve in run.iter() {
        let curve = curve.map(unit);
        for (node, weight) in GAUSS.into_iter().flat_map(|(node, weight)| [(node, weight), (-node, weight)]) {
            let t = 0.5 * (1.0 + node);
            let (p, d) = (point(&curve, t), 0.5 * weight * slope(&curve, t));
            // Green's theorem: integrals over the area along its border.
            area += p.x * d.y;
            first += DVec2::new(p.x * p.x * d.y, -p.y * p.y * d.x) / 2.0;
            second += DVec2::new(p.x * p.x * p.x * d.y, -p.y * p.y * p.y * d.x) / 3.0;
            mixed += p.x * p.x * p.y * d.y / 2.0;
        }
    }
    if area.abs() < 1e-4 {
        return Some(piece);
    }
    let (center, second, mixed) = (first / area, second / area, mixed / area);
    let (across, down) = (second.x - center.x * center.x, second.y - center.y * center.y);
    let mixed = mixed - center.x * center.y;
    let spread = DMat2::from_cols_array(&[across, mixed, mixed, down]);
    // Outlines that cross themselves can have any sums.
    if !(across > 0.0 && down > 0.0 && spread.determinant() > 0.0 && center.abs().max_element() <= 0.5) {
        return Some(piece);
    }
    piece.form = Form::Area { corners: corners.map(|lines| lines + usize::from(lines < run.len())) };
    piece.center = middle + center * extent;
    piece.radius = (area.abs() / std::f64::consts::PI).sqrt() * extent;
    piece.spread = spread * (extent * extent);
    // Of an ellipse, the border has distance 2 from the centre in units of the spread.
    let inverse = spread.inverse();
    let reach = |p: DVec2| 0.5 * (p - center).dot(inverse * (p - center)).sqrt();
    let is_round = |curve: &Cubic| {
        let curve = curve.map(unit);
        (0..SAMPLES).all(|step| (reach(point(&curve, f64::from(step) / f64::from(SAMPLES))) - 1.0).abs() <= ROUNDNESS)
    };
    if run.len() >= MIN_SEGMENTS && run.iter().all(is_round) {
        piece.form = Form::Round;
        if corners.is_none() {
            // The ends of curves lie on the ellipse they stand for, the rest nearly.
            piece.radius *= run.iter().map(|curve| reach(unit(curve[0]))).sum::<f64>() / run.len() as f64;
        }
    }
    Some(piece)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(path: &str) -> Vec<Piece> {
        pieces(&read_segments(path, 1000))
    }

    fn one(path: &str) -> Piece {
        let found = of(path);
        assert_eq!(found.len(), 1, "{path}: {found:?}");
        found[0]
    }

    #[test]
    fn circles_are_circles_however_they_are_written() {
        for path in [
            "M16 20a6 6 0 1 1-12 0a6 6 0 1 1 12 0Z",
            "M16 20A6 6 0 0 1 10 26A6 6 0 0 1 4 20A6 6 0 0 1 10 14A6 6 0 0 1 16 20",
            "M16 20C16 23.3137 13.3137 26 10 26S4 23.3137 4 20 6.6863 14 10 14 16 16.6863 16 20Z",
            "M4 20a6,6 0 0112,0 6,6 0 01-12,0z",
        ] {
            let piece = one(path);
            assert_eq!(piece.form, Form::Round, "{path}");
            assert!(piece.center.distance(DVec2::new(10.0, 20.0)) < 1e-9, "{path}: {piece:?}");
            assert!((piece.radius - 6.0).abs() < 1e-4, "{path}: {piece:?}");
        }
        // An ellipse on its side, and a circle rounded to one decimal.
        assert_eq!(one("M0 0A9 3 30 0 1 15.588457268 9A9 3 30 0 1 0 0Z").form, Form::Round);
        assert_eq!(one("M1 0C1 .6 .6 1 0 1S-1 .6-1 0-.6-1 0-1 1-.6 1 0").form, Form::Round);
        let polygon = |corners: u32| -> String {
            let corner = |i| DVec2::from_angle(std::f64::consts::TAU * f64::from(i) / f64::from(corners));
            (0..corners).map(|i| format!("{}{} {}", if i == 0 { 'M' } else { 'L' }, corner(i).x, corner(i).y)).collect()
        };
        assert_eq!(one(&polygon(24)).form, Form::Round);
        assert_eq!(one(&polygon(6)).form, Form::Area { corners: Some(6) });
    }

    #[test]
    fn other_areas_have_centroid_and_area() {
        let square = one("M1 2h4v4h-4z");
        assert_eq!((square.form, square.center), (Form::Area { corners: Some(4) }, DVec2::new(3.0, 4.0)));
        assert!((square.radius.powi(2) * std::f64::consts::PI - 16.0).abs() < 1e-9);
        assert!((square.spread.x_axis.x - 4.0 / 3.0).abs() < 1e-9 && square.spread.x_axis.y.abs() < 1e-12);
        let triangle = one("M0 0L6 0L3 6");
        assert!(triangle.center.distance(DVec2::new(3.0, 2.0)) < 1e-12 && !triangle.is_closed, "{triangle:?}");
        let rounded = pieces(&rectangle(DVec2::ZERO, DVec2::new(8.0, 4.0), DVec2::ONE));
        assert_eq!((rounded[0].form, rounded[0].center), (Form::Area { corners: None }, DVec2::new(4.0, 2.0)));
        let area = rounded[0].radius.powi(2) * std::f64::consts::PI;
        assert!((area - (32.0 - 4.0 + std::f64::consts::PI)).abs() < 1e-3, "{area}");
        let disk = pieces(&rectangle(DVec2::ZERO, DVec2::splat(8.0), DVec2::splat(4.0)));
        assert_eq!(disk[0].form, Form::Round);
        // Three disks in one path, one with a hole.
        let disk = |x: u32, r: u32| format!("M{x} 5a{r} {r} 0 1 1 {} 0a{r} {r} 0 1 1-{} 0z", 2 * r, 2 * r);
        let three = of(&[disk(0, 5), disk(20, 5), disk(23, 2), disk(40, 5)].concat());
        assert_eq!(three.iter().map(|piece| piece.center.x.round()).collect::<Vec<_>>(), [5.0, 25.0, 45.0]);
    }

    #[test]
    fn what_has_no_area_is_a_dot_or_a_line() {
        for dot in ["M3 4h0", "M54.9 448.5h0", "M3 4z", "M3 4l0 0", "M3 4 3 4", "M3 4c0 0 0 0 0 0"] {
            let piece = one(dot);
            assert_eq!(piece.form, Form::Dot, "{dot}");
            assert!([DVec2::new(3.0, 4.0), DVec2::new(54.9, 448.5)].contains(&piece.center), "{dot}");
        }
        assert_eq!(of("M3 4h0M5 6h0m1 1z").len(), 3);
        assert!(of("M3 4").is_empty() && of("").is_empty() && of("M3").is_empty());
        for line in ["M0 0H9", "M0 0H9Z", "M0 0L5 5L9 9", "M0 0L9 0L0 9L9 9Z"] {
            assert_eq!(one(line).form, Form::Line, "{line}");
        }
    }
}
