//! The walk over a drawing, as one sees it: what is shown where, in which colours, and what is hidden.

use std::cell::Cell;
use std::collections::HashMap;
use std::rc::Rc;

use glam::{DAffine2, DVec2};
use roxmltree::Node;
use svgtypes::Color;

use super::canvas::{View, length, share};
use super::clip::{Clips, Place};
use super::document::refuse;
use super::marks::{Found, Kind, LeftOut};
use super::paint::{Servers, Source, href, reference};
use super::shape::{self, Form, Piece};
use super::style_sheet::{StyleSheet, Styles};
use crate::formats::error::{FormatError, clip};
use crate::formats::svg::GLYPH;

/// Most elements that are visited: `use` can show one element many times.
const MAX_VISITS: usize = 400_000;
/// Elements within elements, those shown by `use` included.
const MAX_DEPTH: usize = 64;
/// Longest style or transform, in bytes: one element can be shown many times.
const MAX_STYLE_LENGTH: usize = 4_000;
/// Most bytes of styles, transforms and outlines, each time they are shown.
const MAX_SHOWN_BYTES: usize = 60_000_000;
/// Most shapes that may be marks, of all kinds.
const MAX_FOUND: usize = 400_000;
/// What is less opaque than this, one does not see.
const SEEN: f64 = 0.01;
/// A line with round ends that is at most so long, in its width, is a dot.
const DOT_LENGTH: f64 = 0.1;
/// What is more times as long as wide is a line.
const MAX_ASPECT: f64 = 5.0;

/// What an element passes on to those in it.
#[derive(Clone)]
pub(super) struct Context<'a> {
    /// From the element's coordinates to those of the page.
    transform: DAffine2,
    fill: Source<'a>,
    stroke: Source<'a>,
    color: Color,
    /// Of everything within, from 0 to 1.
    opacity: f64,
    fill_opacity: f64,
    stroke_opacity: f64,
    stroke_width: f64,
    /// Whether lines end beyond their ends, so that lines of no length are dots.
    has_caps: bool,
    class: Option<&'a str>,
    /// Not `display: none`, which nothing within can undo.
    is_displayed: bool,
    /// Not `visibility: hidden`, which something within can.
    is_visible: bool,
    is_masked: bool,
    clips: Option<Rc<Clips>>,
    /// Width and height that a share in percent refers to.
    viewport: DVec2,
    depth: usize,
}

impl Context<'_> {
    pub(super) fn new(transform: DAffine2, viewport: DVec2) -> Self {
        Self {
            transform,
            fill: Source::BLACK,
            stroke: Source::NONE,
            color: Color::black(),
            opacity: 1.0,
            fill_opacity: 1.0,
            stroke_opacity: 1.0,
            stroke_width: 1.0,
            has_caps: false,
            class: None,
            is_displayed: true,
            is_visible: true,
            is_masked: false,
            clips: None,
            viewport,
            depth: 0,
        }
    }
}

/// The colours of a shape that one sees.
struct Seen {
    is_filled: bool,
    is_stroked: bool,
    /// The class, by its number.
    class: usize,
}

pub(super) struct Walk<'a> {
    pub(super) ids: HashMap<&'a str, Node<'a, 'a>>,
    pub(super) sheet: &'a StyleSheet<'a>,
    servers: Servers,
    /// Of the root: elements of other namespaces are not drawn.
    namespace: Option<&'a str>,
    /// Whether it is a drawing of ours, whose clip path cuts what comes in from the other side.
    is_own: bool,
    pub(super) found: Vec<Found>,
    pub(super) left: LeftOut,
    /// Names of classes, by number.
    pub(super) classes: Vec<Rc<str>>,
    numbers: HashMap<Rc<str>, usize>,
    visits: usize,
    shown_bytes: usize,
    clip_work: Cell<usize>,
    pub(super) clip_segments: usize,
}

impl<'a> Walk<'a> {
    pub(super) fn new(root: Node<'a, 'a>, sheet: &'a StyleSheet<'a>, is_own: bool) -> Self {
        let mut ids = HashMap::new();
        for node in root.descendants() {
            // Of several with one id the first is meant.
            if let Some(id) = node.attribute("id") {
                ids.entry(id).or_insert(node);
            }
        }
        Self {
            ids,
            sheet,
            servers: Servers::default(),
            namespace: root.tag_name().namespace(),
            is_own,
            found: Vec::new(),
            left: LeftOut::default(),
            classes: Vec::new(),
            numbers: HashMap::new(),
            visits: 0,
            shown_bytes: 0,
            clip_work: Cell::new(0),
            clip_segments: 0,
        }
    }

    /// Counts an element each time it is looked at.
    pub(super) fn count_visit(&mut self, node: Node) -> Result<(), FormatError> {
        self.visits += 1;
        if self.visits > MAX_VISITS {
            return refuse(node, &format!("it shows more than {MAX_VISITS} elements"));
        }
        let lengths = ["style", "class", "transform", "d", "points"];
        self.shown_bytes += lengths.iter().filter_map(|name| node.attribute(*name)).map(str::len).sum::<usize>();
        if self.shown_bytes > MAX_SHOWN_BYTES {
            return refuse(node, "it shows long paths or styles too often");
        }
        Ok(())
    }

    pub(super) fn visit(&mut self, node: Node<'a, 'a>, outer: &Context<'a>) -> Result<(), FormatError> {
        self.count_visit(node)?;
        if outer.depth > MAX_DEPTH {
            return refuse(node, &format!("elements lie more than {MAX_DEPTH} deep in each other"));
        }
        let name = node.tag_name().name();
        if node.tag_name().namespace() != self.namespace || !is_for_us(node) {
            return Ok(());
        }
        match name {
            "svg" | "g" | "a" | "switch" | "use" => {}
            "circle" | "ellipse" | "path" | "rect" | "line" | "polyline" | "polygon" => {}
            "text" | "foreignObject" => {
                self.left.texts += 1;
                return Ok(());
            }
            "image" => {
                self.left.images += 1;
                return Ok(());
            }
            // What is not shown where it stands: defs, symbol, clipPath, mask, pattern, marker, style, title, …
            _ => return Ok(()),
        }
        let styles = self.styles(node)?;
        let context = self.enter(node, outer, &styles)?;
        match name {
            "use" => self.follow(node, &context, &styles),
            "svg" if outer.depth > 0 => self.nest(node, &context, &styles, [None, None]),
            "svg" | "g" | "a" => self.visit_children(node, &context),
            "switch" => {
                // Only the first child that a viewer can show.
                let fits = |child: &Node| child.is_element() && is_for_us(*child);
                match node.children().find(fits) {
                    Some(child) => self.visit(child, &context),
                    None => Ok(()),
                }
            }
            _ if !(context.is_displayed && context.is_visible) => {
                self.left.hidden += 1;
                Ok(())
            }
            "circle" | "ellipse" => self.take_circle(node, &context, &styles),
            // A glyph of our own, in radii around its middle.
            "path" if node.has_attribute(GLYPH) => {
                let Some(seen) = self.seen(&context) else { return Ok(()) };
                self.add(node, &context, Kind::Circle, DVec2::ZERO, DVec2::ONE, seen.class)
            }
            _ => self.take_shape(node, &context, &styles),
        }
    }

    fn visit_children(&mut self, node: Node<'a, 'a>, context: &Context<'a>) -> Result<(), FormatError> {
        node.children().filter(Node::is_element).try_for_each(|child| self.visit(child, context))
    }

    /// What style sheets, style and attributes say of an element.
    pub(super) fn styles(&self, node: Node<'a, 'a>) -> Result<Styles<'a>, FormatError> {
        let is_long = |name: &&str| node.attribute(*name).is_some_and(|text| text.len() > MAX_STYLE_LENGTH);
        if ["style", "class", "transform"].iter().any(is_long) {
            return refuse(node, &format!("a style, class or transform has more than {MAX_STYLE_LENGTH} bytes"));
        }
        match self.sheet.styles(node) {
            Some(styles) => Ok(styles),
            None => refuse(node, "its style sheets have too many rules for so many elements"),
        }
    }

    /// What holds within an element.
    fn enter(
        &mut self,
        node: Node<'a, 'a>,
        outer: &Context<'a>,
        styles: &Styles<'a>,
    ) -> Result<Context<'a>, FormatError> {
        let mut context = Context { depth: outer.depth + 1, ..outer.clone() };
        context.transform *= self.own_transform(node, styles, context.viewport)?;
        let paint = |name| styles.get(name).and_then(Source::parse);
        context.fill = paint("fill").unwrap_or(context.fill);
        context.stroke = paint("stroke").unwrap_or(context.stroke);
        context.color = styles.get("color").and_then(|text| text.parse().ok()).unwrap_or(context.color);
        let number = |name| styles.get(name).and_then(share);
        context.opacity *= number("opacity").unwrap_or(1.0);
        context.fill_opacity = number("fill-opacity").unwrap_or(context.fill_opacity);
        context.stroke_opacity = number("stroke-opacity").unwrap_or(context.stroke_opacity);
        let width = styles.get("stroke-width").and_then(|text| length(text, diagonal(context.viewport)));
        context.stroke_width = width.filter(|width| *width >= 0.0).unwrap_or(context.stroke_width);
        match styles.get("stroke-linecap") {
            Some("round" | "square") => context.has_caps = true,
            Some("butt") => context.has_caps = false,
            _ => {}
        }
        context.class = node.attribute("data-class").or(context.class);
        if styles.get("display") == Some("none") {
            context.is_displayed = false;
        }
        match styles.get("visibility") {
            Some("hidden" | "collapse") => context.is_visible = false,
            Some("visible") => context.is_visible = true,
            _ => {}
        }
        let mask = styles.get("mask").and_then(reference);
        context.is_masked |= mask.is_some_and(|id| self.ids.contains_key(id));
        if let Some(value) = styles.get("clip-path").filter(|_| !self.is_own) {
            let bounds = self.bounds(node, styles, context.viewport);
            let place = Place { transform: context.transform, viewport: context.viewport, bounds };
            context.clips = self.clip(value, place, context.clips.take(), 0)?;
        }
        Ok(context)
    }

    /// A picture within the picture: moved to its place, scaled to its size, cut off at its border. `size` comes from a
    /// `use` that shows it.
    fn nest(
        &mut self,
        node: Node<'a, 'a>,
        context: &Context<'a>,
        styles: &Styles<'a>,
        size: [Option<f64>; 2],
    ) -> Result<(), FormatError> {
        let outer = context.viewport;
        let get = |name, whole| styles.get(name).and_then(|text| length(text, whole));
        let at = DVec2::new(get("x", outer.x).unwrap_or(0.0), get("y", outer.y).unwrap_or(0.0));
        let size = DVec2::new(
            size[0].or_else(|| get("width", outer.x)).unwrap_or(outer.x),
            size[1].or_else(|| get("height", outer.y)).unwrap_or(outer.y),
        );
        // Without a size it is not drawn.
        let Some(view) = View::of(node, at, size) else { return Ok(()) };
        let mut context = context.clone();
        let is_open = matches!(styles.get("overflow"), Some("visible" | "auto"));
        if !(is_open || self.is_own) {
            context.clips = Some(Clips::boxed(context.transform, view.corners, context.clips.take()));
        }
        context.transform *= view.transform;
        context.viewport = view.viewport;
        self.visit_children(node, &context)
    }

    /// Where a `use` puts what it shows.
    pub(super) fn place_of_use(&self, styles: &Styles, viewport: DVec2) -> DVec2 {
        let get = |name, whole| styles.get(name).and_then(|text| length(text, whole)).unwrap_or(0.0);
        DVec2::new(get("x", viewport.x), get("y", viewport.y))
    }

    fn follow(&mut self, node: Node<'a, 'a>, context: &Context<'a>, styles: &Styles<'a>) -> Result<(), FormatError> {
        let Some(target) = href(node).and_then(|id| self.ids.get(id).copied()) else {
            // Something in another file, or nowhere.
            self.left.elsewhere += 1;
            return Ok(());
        };
        if is_letter(node, target) {
            self.left.texts += 1;
            return Ok(());
        }
        let mut context = context.clone();
        let viewport = context.viewport;
        context.transform *= DAffine2::from_translation(self.place_of_use(styles, viewport));
        let get = |name, whole| styles.get(name).and_then(|text| length(text, whole));
        let size = [get("width", viewport.x), get("height", viewport.y)];
        let name = target.tag_name().name();
        if name != "symbol" && name != "svg" {
            return self.visit(target, &context);
        }
        self.count_visit(target)?;
        if context.depth > MAX_DEPTH {
            return refuse(node, &format!("elements lie more than {MAX_DEPTH} deep in each other"));
        }
        let styles = self.styles(target)?;
        let context = self.enter(target, &context, &styles)?;
        self.nest(target, &context, &styles, size)
    }

    /// What one sees of fill and stroke; nothing is counted among what is left out.
    fn seen(&mut self, context: &Context<'a>) -> Option<Seen> {
        let ink = |source| self.servers.ink(source, context.color, &self.ids, self.sheet);
        let (fill, stroke) = (ink(context.fill), ink(context.stroke).filter(|_| context.stroke_width > 0.0));
        let is_painted = fill.is_some() || stroke.is_some();
        let is_seen = |opacity: f64, own: f64| opacity * own * context.opacity >= SEEN;
        let fill = fill.filter(|ink| is_seen(ink.opacity, context.fill_opacity));
        let stroke = stroke.filter(|ink| is_seen(ink.opacity, context.stroke_opacity));
        let (is_filled, is_stroked) = (fill.is_some(), stroke.is_some());
        let Some(ink) = fill.or(stroke) else {
            *(if is_painted { &mut self.left.transparent } else { &mut self.left.unpainted }) += 1;
            return None;
        };
        let name = context.class.map_or(ink.name, Rc::from);
        let class = *self.numbers.entry(name).or_insert_with_key(|name| {
            self.classes.push(Rc::clone(name));
            self.classes.len() - 1
        });
        Some(Seen { is_filled, is_stroked, class })
    }

    fn take_circle(
        &mut self,
        node: Node<'a, 'a>,
        context: &Context<'a>,
        styles: &Styles<'a>,
    ) -> Result<(), FormatError> {
        let Some(seen) = self.seen(context) else { return Ok(()) };
        let get = |name: &str, whole: f64| match styles.get(name) {
            None | Some("auto") => Ok(None),
            Some(text) => match length(text, whole) {
                Some(value) => Ok(Some(value)),
                None => refuse(node, &format!("{name} is {:?}, but must be a length", clip(text))),
            },
        };
        let viewport = context.viewport;
        let center = DVec2::new(get("cx", viewport.x)?.unwrap_or(0.0), get("cy", viewport.y)?.unwrap_or(0.0));
        let radii = if node.tag_name().name() == "circle" {
            DVec2::splat(get("r", diagonal(viewport))?.unwrap_or(0.0))
        } else {
            let (x, y) = (get("rx", viewport.x)?, get("ry", viewport.y)?);
            DVec2::new(x.or(y).unwrap_or(0.0), y.or(x).unwrap_or(0.0))
        };
        let kind = if radii.min_element() > 0.0 { Kind::Circle } else { Kind::Point };
        self.add(node, context, kind, center, radii.max(DVec2::ZERO), seen.class)
    }

    fn take_shape(
        &mut self,
        node: Node<'a, 'a>,
        context: &Context<'a>,
        styles: &Styles<'a>,
    ) -> Result<(), FormatError> {
        let markers = ["marker", "marker-start", "marker-mid", "marker-end"];
        let has_marker = |name: &&str| styles.get(name).and_then(reference).is_some_and(|id| self.ids.contains_key(id));
        self.left.markers += usize::from(markers.iter().any(has_marker));
        let segments = shape::segments(node, styles, context.viewport).unwrap_or_default();
        let pieces = shape::pieces(&segments);
        if pieces.is_empty() {
            return Ok(());
        }
        let Some(seen) = self.seen(context) else { return Ok(()) };
        for piece in &pieces {
            let half_width = DVec2::splat(context.stroke_width / 2.0);
            let is_short = piece.size().length() <= DOT_LENGTH * context.stroke_width;
            match piece.form {
                Form::Dot | Form::Line if seen.is_stroked && context.has_caps && is_short => {
                    self.add(node, context, Kind::Dot, piece.center, half_width, seen.class)?;
                }
                Form::Dot if seen.is_stroked => {
                    self.add(node, context, Kind::Point, piece.center, DVec2::ZERO, seen.class)?;
                }
                Form::Round | Form::Area { .. } if seen.is_filled || piece.is_closed => {
                    self.add_area(node, context, piece, seen.class)?;
                }
                _ => self.left.lines += 1,
            }
        }
        Ok(())
    }

    /// A piece with an area, unless it is as long as a line.
    fn add_area(&mut self, node: Node, context: &Context<'a>, piece: &Piece, class: usize) -> Result<(), FormatError> {
        let corners = match piece.form {
            Form::Area { corners } => corners,
            _ => return self.add(node, context, Kind::Round, piece.center, DVec2::splat(piece.radius), class),
        };
        let matrix = context.transform.matrix2;
        let spread = matrix * piece.spread * matrix.transpose();
        // Eigenvalues of a symmetric matrix: its half trace, and how far they are from that.
        let half = 0.5 * (spread.x_axis.x + spread.y_axis.y);
        let off = (half * half - spread.determinant()).max(0.0).sqrt();
        if half + off > MAX_ASPECT * MAX_ASPECT * (half - off) {
            self.left.lines += 1;
            return Ok(());
        }
        self.add(node, context, Kind::Area { corners }, piece.center, DVec2::splat(piece.radius), class)
    }

    /// A mark at `center`, with `radii` in the element's coordinates, where nothing hides it.
    fn add(
        &mut self,
        node: Node,
        context: &Context<'a>,
        kind: Kind,
        center: DVec2,
        radii: DVec2,
        class: usize,
    ) -> Result<(), FormatError> {
        let position = context.transform.transform_point2(center);
        let matrix = context.transform.matrix2;
        // Of a disk with the same area.
        let radius = (matrix.determinant().abs() * radii.x * radii.y).sqrt();
        let reach = (matrix.x_axis.abs() * radii.x + matrix.y_axis.abs() * radii.y).max_element();
        if !(position.is_finite() && radius.is_finite() && reach.is_finite()) {
            self.left.flat += 1;
            return Ok(());
        }
        if kind != Kind::Point && radius <= 0.0 {
            self.left.flat += 1;
            return Ok(());
        }
        if let Some(clips) = &context.clips {
            match clips.shows(position, &self.clip_work) {
                Some(true) => {}
                Some(false) => {
                    self.left.clipped += 1;
                    return Ok(());
                }
                None => return refuse(node, "its clip paths have too many lines and curves for so many marks"),
            }
        }
        if self.found.len() >= MAX_FOUND {
            return refuse(node, &format!("it has more than {MAX_FOUND} shapes"));
        }
        self.left.masked += usize::from(context.is_masked);
        self.found.push(Found { at: node.range().start, position, radius, reach, kind, class });
        Ok(())
    }
}

/// What a share in percent of a radius or a width refers to.
fn diagonal(viewport: DVec2) -> f64 {
    viewport.length() / std::f64::consts::SQRT_2
}

/// Whether a viewer shows an element: nothing asks for an extension or another language than English.
fn is_for_us(node: Node) -> bool {
    let is_ours =
        |language: &str| language.trim().split('-').next().is_some_and(|main| main.eq_ignore_ascii_case("en"));
    node.attribute("requiredExtensions").is_none_or(|extensions| extensions.trim().is_empty())
        && node.attribute("systemLanguage").is_none_or(|languages| languages.split(',').any(is_ours))
}

/// Whether a `use` shows the outline of a letter: matplotlib puts these into groups called `text_1`, …, and Cairo calls
/// what they refer to `glyph-0-1`, ….
fn is_letter(node: Node, target: Node) -> bool {
    let is_called = |node: Node, start: &str| node.attribute("id").is_some_and(|id| id.starts_with(start));
    is_called(target, "glyph") && !target.has_attribute(GLYPH)
        || node.ancestors().skip(1).take(4).any(|outer| is_called(outer, "text_"))
}
