//! What clip paths and the boxes of nested drawings leave to be seen.

use std::cell::Cell;
use std::rc::Rc;

use glam::{DAffine2, DVec2};
use roxmltree::Node;

use super::document::refuse;
use super::paint::{href, reference};
use super::shape::{self, point};
use super::style_sheet::Styles;
use super::transform;
use super::walk::Walk;
use crate::formats::error::FormatError;
use crate::formats::outline::Segment;

/// Clip paths of clip paths.
const MAX_DEPTH: usize = 8;
/// Most lines and curves of all clip paths together, each time they are referred to.
const MAX_SEGMENTS: usize = 1_000_000;
/// Most comparisons of marks with lines and curves of clip paths.
const MAX_WORK: usize = 200_000_000;
/// Lines that a curve is taken for. A quarter of a circle is off by 0.03 % of its radius.
const CURVE_STEPS: u32 = 32;

/// A clip and those around it.
pub(super) struct Clips {
    area: Area,
    outer: Option<Rc<Clips>>,
}

enum Area {
    /// Corners of a box; nothing is seen through one that a transform made flat.
    Box(Option<DAffine2>, [DVec2; 2]),
    /// What any of these shows.
    Union(Vec<Part>),
}

struct Part {
    from_page: Option<DAffine2>,
    segments: Vec<Segment>,
    is_even_odd: bool,
    within: Option<Rc<Clips>>,
}

fn inverse(transform: DAffine2) -> Option<DAffine2> {
    Some(transform.inverse()).filter(DAffine2::is_finite)
}

impl Clips {
    /// A box in coordinates that `transform` brings to the page.
    pub(super) fn boxed(transform: DAffine2, corners: [DVec2; 2], outer: Option<Rc<Self>>) -> Rc<Self> {
        Rc::new(Self { area: Area::Box(inverse(transform), corners), outer })
    }

    /// Whether one sees a place of the page; nothing when that was asked too often.
    pub(super) fn shows(&self, at: DVec2, work: &Cell<usize>) -> Option<bool> {
        let mut next = Some(self);
        while let Some(clips) = next {
            let is_seen = match &clips.area {
                Area::Box(from_page, [min, max]) => from_page.is_some_and(|from_page| {
                    let at = from_page.transform_point2(at);
                    // What lies on the border is seen in half.
                    let rounding = 1e-9 * (*max - *min);
                    at.cmpge(*min - rounding).all() && at.cmple(*max + rounding).all()
                }),
                Area::Union(parts) => {
                    let mut is_seen = false;
                    for part in parts {
                        is_seen = is_seen || part.shows(at, work)?;
                    }
                    is_seen
                }
            };
            work.set(work.get() + 1);
            if !is_seen {
                return Some(false);
            }
            next = clips.outer.as_deref();
        }
        Some(true)
    }
}

impl Part {
    fn shows(&self, at: DVec2, work: &Cell<usize>) -> Option<bool> {
        work.set(work.get() + 1 + self.segments.len());
        if work.get() > MAX_WORK {
            return None;
        }
        if let Some(within) = &self.within
            && !within.shows(at, work)?
        {
            return Some(false);
        }
        let Some(from_page) = self.from_page else { return Some(false) };
        let at = from_page.transform_point2(at);
        // How often the outline goes round the place: crossings of the ray to the right.
        let mut winding = 0_i64;
        let mut cross = |a: DVec2, b: DVec2| {
            if (a.y <= at.y) != (b.y <= at.y) {
                let side = (b - a).perp_dot(at - a);
                if (b.y > a.y) == (side > 0.0) && side != 0.0 {
                    winding += if b.y > a.y { 1 } else { -1 };
                }
            }
        };
        let (mut start, mut here) = (DVec2::ZERO, DVec2::ZERO);
        for segment in &self.segments {
            match *segment {
                Segment::Move(to) => {
                    cross(here, start);
                    (start, here) = (to, to);
                }
                Segment::Line(to) => {
                    cross(here, to);
                    here = to;
                }
                Segment::Curve(a, b, to) => {
                    let curve = [here, a, b, to];
                    if curve.iter().any(|p| p.y <= at.y) && curve.iter().any(|p| p.y >= at.y) {
                        work.set(work.get() + CURVE_STEPS as usize);
                        let mut from = here;
                        for step in 1..=CURVE_STEPS {
                            let next = point(&curve, f64::from(step) / f64::from(CURVE_STEPS));
                            cross(from, next);
                            from = next;
                        }
                        // Rounding must not leave a gap.
                        cross(from, to);
                    }
                    here = to;
                }
                Segment::Close => {
                    cross(here, start);
                    here = start;
                }
            }
        }
        cross(here, start);
        Some(if self.is_even_odd { winding % 2 != 0 } else { winding != 0 })
    }
}

/// Where a clip path is referred to.
#[derive(Clone, Copy)]
pub(super) struct Place {
    /// From the element's coordinates to those of the page.
    pub(super) transform: DAffine2,
    pub(super) viewport: DVec2,
    /// The box around the element, in its coordinates; none for groups, which are not looked through for that.
    pub(super) bounds: Option<[DVec2; 2]>,
}

impl<'a> Walk<'a> {
    /// What the property `clip-path` leaves of what `outer` shows.
    pub(super) fn clip(
        &mut self,
        value: &'a str,
        place: Place,
        outer: Option<Rc<Clips>>,
        depth: usize,
    ) -> Result<Option<Rc<Clips>>, FormatError> {
        if value == "none" {
            return Ok(outer);
        }
        let Some(id) = reference(value) else {
            self.left.unclear_clips += 1;
            return Ok(outer);
        };
        let target = self.ids.get(id).copied();
        let Some(node) = target.filter(|node| node.tag_name().name() == "clipPath") else { return Ok(outer) };
        if depth >= MAX_DEPTH {
            self.left.unclear_clips += 1;
            return Ok(outer);
        }
        self.count_visit(node)?;
        let styles = self.styles(node)?;
        let mut inner = place;
        if node.attribute("clipPathUnits") == Some("objectBoundingBox") {
            let Some([min, max]) = place.bounds else {
                self.left.unclear_clips += 1;
                return Ok(outer);
            };
            inner.transform *= DAffine2::from_translation(min) * DAffine2::from_scale(max - min);
            inner.viewport = DVec2::ONE;
        }
        inner.transform *= self.own_transform(node, &styles, inner.viewport)?;
        let outer = match styles.get("clip-path") {
            Some(value) => self.clip(value, place, outer, depth + 1)?,
            None => outer,
        };
        let mut parts = Vec::new();
        for child in node.children().filter(Node::is_element) {
            self.add_part(child, inner, styles.get("clip-rule"), depth, &mut parts)?;
        }
        Ok(Some(Rc::new(Clips { area: Area::Union(parts), outer })))
    }

    /// What one child of a clip path adds to it.
    fn add_part(
        &mut self,
        node: Node<'a, 'a>,
        mut place: Place,
        rule: Option<&'a str>,
        depth: usize,
        parts: &mut Vec<Part>,
    ) -> Result<(), FormatError> {
        self.count_visit(node)?;
        let styles: Styles<'a> = self.styles(node)?;
        let is_hidden = matches!(styles.get("visibility"), Some("hidden" | "collapse"));
        if styles.get("display") == Some("none") || is_hidden {
            return Ok(());
        }
        place.transform *= self.own_transform(node, &styles, place.viewport)?;
        let rule = styles.get("clip-rule").or(rule);
        let within = match styles.get("clip-path") {
            Some(value) => self.clip(value, Place { bounds: None, ..place }, None, depth + 1)?,
            None => None,
        };
        let mut shape = (node, styles);
        if node.tag_name().name() == "use" {
            let at = self.place_of_use(&shape.1, place.viewport);
            place.transform *= DAffine2::from_translation(at);
            let Some(target) = href(node).and_then(|id| self.ids.get(id).copied()) else { return Ok(()) };
            self.count_visit(target)?;
            shape = (target, self.styles(target)?);
            place.transform *= self.own_transform(target, &shape.1, place.viewport)?;
        }
        let Some(segments) = shape::segments(shape.0, &shape.1, place.viewport) else {
            // Text, or nothing that may stand here.
            self.left.unclear_clips += usize::from(node.tag_name().name() == "text");
            return Ok(());
        };
        self.clip_segments += segments.len();
        if self.clip_segments > MAX_SEGMENTS {
            return refuse(node, "its clip paths have too many lines and curves");
        }
        let is_even_odd = rule == Some("evenodd");
        parts.push(Part { from_page: inverse(place.transform), segments, is_even_odd, within });
        Ok(())
    }
}

impl Walk<'_> {
    /// A transform of the element's own, with `translate`, `rotate`, `scale` and where it turns about.
    pub(super) fn own_transform(
        &mut self,
        node: Node,
        styles: &Styles,
        viewport: DVec2,
    ) -> Result<DAffine2, FormatError> {
        let mut whole = DAffine2::IDENTITY;
        let mut is_any = false;
        let mut apply = |text: &str, own: Option<DAffine2>| {
            is_any = true;
            match own {
                Some(own) => whole *= own,
                None => return refuse(node, &format!("{:?} is not a transform", crate::formats::error::clip(text))),
            }
            Ok(())
        };
        for name in ["translate", "rotate", "scale"] {
            if let Some(text) = styles.get(name) {
                apply(text, transform::property(name, text, viewport))?;
            }
        }
        if let Some(text) = styles.get("transform") {
            apply(text, transform::css(text, viewport))?;
        } else if let Some(text) = node.attribute("transform") {
            apply(text, transform::attribute(text, viewport))?;
        }
        let Some(origin) = styles.get("transform-origin").filter(|_| is_any) else { return Ok(whole) };
        let (min, size) = match styles.get("transform-box") {
            Some("fill-box" | "content-box" | "stroke-box" | "border-box") => {
                match self.bounds(node, styles, viewport) {
                    Some([min, max]) => (min, max - min),
                    None => {
                        self.left.unclear_origins += 1;
                        return Ok(whole);
                    }
                }
            }
            _ => (DVec2::ZERO, viewport),
        };
        let Some(origin) = transform::origin(origin, size) else { return Ok(whole) };
        Ok(DAffine2::from_translation(min + origin) * whole * DAffine2::from_translation(-min - origin))
    }

    /// The box around a shape.
    pub(super) fn bounds(&self, node: Node, styles: &Styles, viewport: DVec2) -> Option<[DVec2; 2]> {
        let segments = shape::segments(node, styles, viewport)?;
        let pieces = shape::pieces(&segments);
        let low = pieces.iter().map(|piece| piece.bounds[0]).fold(DVec2::INFINITY, DVec2::min);
        let high = pieces.iter().map(|piece| piece.bounds[1]).fold(DVec2::NEG_INFINITY, DVec2::max);
        (!pieces.is_empty()).then_some([low, high])
    }
}
