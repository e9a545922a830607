//! Pages and views within them: `viewBox`, `preserveAspectRatio`, and lengths.

use glam::{DAffine2, DVec2};
use roxmltree::Node;
use svgtypes::{Align, AspectRatio, Length, LengthUnit, ViewBox};

use super::style_sheet::Styles;

/// A length in user units; a share in percent is one of `whole`.
pub(super) fn pixels(length: Length, whole: f64) -> f64 {
    let unit = match length.unit {
        LengthUnit::None | LengthUnit::Px => 1.0,
        LengthUnit::Pt => 4.0 / 3.0,
        LengthUnit::Pc | LengthUnit::Em => 16.0,
        LengthUnit::Ex => 8.0,
        LengthUnit::In => 96.0,
        LengthUnit::Cm => 96.0 / 2.54,
        LengthUnit::Mm => 96.0 / 25.4,
        LengthUnit::Percent => whole / 100.0,
    };
    length.number * unit
}

/// The same of text.
pub(super) fn length(text: &str, whole: f64) -> Option<f64> {
    text.trim().parse().ok().map(|length| pixels(length, whole)).filter(|value| value.is_finite())
}

/// A number or a share in percent, as opacities are.
pub(super) fn share(text: &str) -> Option<f64> {
    match text.trim().parse::<Length>().ok()? {
        Length { number, unit: LengthUnit::Percent } => Some(number / 100.0),
        Length { number, unit: LengthUnit::None } => Some(number),
        _ => None,
    }
    .map(|share| share.clamp(0.0, 1.0))
}

/// The rectangle of the drawing that an element with `viewBox` shows.
fn view_box(node: Node) -> Option<(DVec2, DVec2)> {
    let ViewBox { x, y, w, h } = node.attribute("viewBox")?.parse().ok()?;
    Some((DVec2::new(x, y), DVec2::new(w, h)))
}

fn aspect_ratio(node: Node) -> AspectRatio {
    node.attribute("preserveAspectRatio").and_then(|text| text.trim().parse().ok()).unwrap_or_default()
}

/// How much of the room that is left over comes before, in x and in y.
fn room_before(align: Align) -> DVec2 {
    let (x, y) = match align {
        Align::XMinYMin | Align::None => (0.0, 0.0),
        Align::XMidYMin => (0.5, 0.0),
        Align::XMaxYMin => (1.0, 0.0),
        Align::XMinYMid => (0.0, 0.5),
        Align::XMidYMid => (0.5, 0.5),
        Align::XMaxYMid => (1.0, 0.5),
        Align::XMinYMax => (0.0, 1.0),
        Align::XMidYMax => (0.5, 1.0),
        Align::XMaxYMax => (1.0, 1.0),
    };
    DVec2::new(x, y)
}

/// How a rectangle of a drawing comes to a box of this size at the origin (SVG 2, §8.2).
fn fit(min: DVec2, inner: DVec2, size: DVec2, ratio: AspectRatio) -> DAffine2 {
    let each = size / inner;
    let scale = match (ratio.align, ratio.slice) {
        (Align::None, _) => each,
        (_, false) => DVec2::splat(each.min_element()),
        (_, true) => DVec2::splat(each.max_element()),
    };
    let rest = (size - inner * scale) * room_before(ratio.align);
    DAffine2::from_translation(rest) * DAffine2::from_scale(scale) * DAffine2::from_translation(-min)
}

/// What the outermost `svg` shows.
pub(super) struct Canvas {
    pub(super) min: DVec2,
    pub(super) size: DVec2,
    /// Whether the file says so.
    pub(super) is_declared: bool,
    /// From the drawing's coordinates to those of the page.
    pub(super) transform: DAffine2,
    /// What percentages refer to.
    pub(super) viewport: DVec2,
}

impl Canvas {
    pub(super) fn of(root: Node, styles: &Styles) -> Self {
        // A share of the window that shows the file is no size.
        let side = |name| styles.get(name).filter(|text| !text.contains('%')).and_then(|text| length(text, 0.0));
        let side = |name| side(name).filter(|&side| side > 0.0);
        let size = side("width").zip(side("height")).map(|(width, height)| DVec2::new(width, height));
        let whole =
            |min, size, viewport| Self { min, size, is_declared: true, transform: DAffine2::IDENTITY, viewport };
        match (view_box(root), size) {
            (Some((min, inner)), Some(size)) => {
                let ratio = aspect_ratio(root);
                let each = size / inner;
                if ratio.align == Align::None && (each.x - each.y).abs() > 1e-9 * each.max_element() {
                    // Stretched in one direction: what one sees is in pixels.
                    return Self { transform: fit(min, inner, size, ratio), ..whole(DVec2::ZERO, size, inner) };
                }
                if ratio.slice && ratio.align != Align::None {
                    // A part fills the page.
                    let seen = size / each.max_element();
                    return whole(min + (inner - seen) * room_before(ratio.align), seen, inner);
                }
                whole(min, inner, inner)
            }
            (Some((min, inner)), None) => whole(min, inner, inner),
            (None, Some(size)) => whole(DVec2::ZERO, size, size),
            (None, None) => {
                let viewport = DVec2::splat(100.0);
                Self { is_declared: false, ..whole(DVec2::ZERO, viewport, viewport) }
            }
        }
    }
}

/// A box within a drawing, with coordinates of its own: a nested `svg` or a `symbol`.
pub(super) struct View {
    /// From its coordinates to those around it.
    pub(super) transform: DAffine2,
    /// What percentages refer to within it.
    pub(super) viewport: DVec2,
    /// Upper left and lower right corner, in the coordinates around it.
    pub(super) corners: [DVec2; 2],
}

impl View {
    /// What a box at `min` of this size shows of an element; nothing where it has no size.
    pub(super) fn of(node: Node, min: DVec2, size: DVec2) -> Option<Self> {
        if size.min_element() <= 0.0 || !size.is_finite() {
            return None;
        }
        let (transform, viewport) = match view_box(node) {
            Some((inner_min, inner)) => (fit(inner_min, inner, size, aspect_ratio(node)), inner),
            None => (DAffine2::IDENTITY, size),
        };
        Some(Self { transform: DAffine2::from_translation(min) * transform, viewport, corners: [min, min + size] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_have_units() {
        assert_eq!(length("12", 0.0), Some(12.0));
        assert_eq!(length(" -1.5e1px ", 0.0), Some(-15.0));
        assert_eq!(length("25.4mm", 0.0), Some(96.0));
        assert_eq!(length("50%", 30.0), Some(15.0));
        assert_eq!(length("2em", 0.0), Some(32.0));
        for wrong in ["", "px", "1 2", "1furlong", "nan", "inf", "1e999"] {
            assert_eq!(length(wrong, 1.0), None, "{wrong}");
        }
        assert_eq!(
            ["0.5", "50%", "7", "-1", "1px", "x"].map(share),
            [Some(0.5), Some(0.5), Some(1.0), Some(0.0), None, None]
        );
    }

    #[test]
    fn boxes_show_rectangles() {
        let fit = |ratio: &str| {
            let ratio = ratio.parse().unwrap_or_default();
            let to_box = fit(DVec2::new(10.0, 0.0), DVec2::new(1.0, 1.0), DVec2::new(4.0, 2.0), ratio);
            [to_box.transform_point2(DVec2::new(10.0, 0.0)), to_box.transform_point2(DVec2::new(11.0, 1.0))]
        };
        let corners = |a: f64, b: f64, c: f64, d: f64| [DVec2::new(a, b), DVec2::new(c, d)];
        assert_eq!(fit(""), corners(1.0, 0.0, 3.0, 2.0));
        assert_eq!(fit("xMinYMid"), corners(0.0, 0.0, 2.0, 2.0));
        assert_eq!(fit("xMaxYMax meet"), corners(2.0, 0.0, 4.0, 2.0));
        assert_eq!(fit("xMidYMid slice"), corners(0.0, -1.0, 4.0, 3.0));
        assert_eq!(fit("xMinYMin slice"), corners(0.0, 0.0, 4.0, 4.0));
        assert_eq!(fit("xMinYMax slice"), corners(0.0, -2.0, 4.0, 2.0));
        assert_eq!(fit("none"), corners(0.0, 0.0, 4.0, 2.0));
        assert_eq!(fit("none slice"), corners(0.0, 0.0, 4.0, 2.0));
    }
}
