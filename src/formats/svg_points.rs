//! Points of a drawing: every visible `circle` and `ellipse` of an SVG, also by way of `use`, with all transforms;
//! and our own glyphs.
//!
//! The class is what a group says with `data-class` (as [`write_svg`](super::write_svg) does), else the fill, else the
//! stroke; with more than one radius there is an attribute `radius`. y points down, as in the drawing and on the page.
//! Of style sheets the rules for elements, ids and classes count. Documents with a DTD are refused, and nothing outside
//! the file is ever fetched.

use std::borrow::Cow;
use std::collections::HashMap;

use glam::{DAffine2, DMat2, DVec2};
use roxmltree::{Document, Node, ParsingOptions};

use super::error::{FormatError, Place, clip, place};
use super::guess::Guess;
use super::style::RADIUS_ATTRIBUTE;
use super::style_sheet::{StyleSheet, Styles};
use super::svg::GLYPH;
use super::{FileFormat, Note, ReadOptions, Reading};
use crate::pattern::{Attribute, Boundary, Domain, MAX_CLASSES, MAX_NAME_LENGTH, MAX_POINTS, PointPattern};

/// Most nodes of the document, text included.
const MAX_NODES: u32 = 400_000;
/// Most elements that are visited: `use` can show one element many times.
const MAX_VISITS: usize = 400_000;
/// Elements within elements, those shown by `use` included.
const MAX_DEPTH: usize = 64;
/// Most attributes of an element: names are compared with each other.
const MAX_ELEMENT_ATTRIBUTES: usize = 500;
/// Longest style or transform, in bytes: one element can be shown many times.
const MAX_STYLE_LENGTH: usize = 4_000;
/// Most declarations of namespaces on the way from the root to an element, times elements with a declaration.
const MAX_NAMESPACE_WORK: usize = 10_000_000;

/// What an element passes on to those in it.
#[derive(Clone)]
struct Context {
    /// From the element's coordinates to those of the page.
    transform: DAffine2,
    fill: Option<String>,
    stroke: Option<String>,
    class: Option<String>,
    /// Not `display: none`, which nothing within can undo.
    is_displayed: bool,
    /// Not `visibility: hidden`, which something within can.
    is_visible: bool,
    /// Width and height that a share in percent refers to.
    viewport: DVec2,
    depth: usize,
}

struct Found {
    /// First byte of the element.
    at: usize,
    position: DVec2,
    radius: f64,
    class: String,
}

struct Reader<'a> {
    document: &'a Document<'a>,
    ids: HashMap<&'a str, Node<'a, 'a>>,
    sheet: &'a StyleSheet,
    found: Vec<Found>,
    visits: usize,
    /// Shapes that are no circles.
    others: usize,
    /// Circles and ellipses without a radius or a place.
    degenerate: usize,
}

/// The library's words, with the place in front as in every other format.
fn located(error: &roxmltree::Error) -> FormatError {
    let position = error.pos();
    let message = error.to_string();
    let place = format!(" at {}:{}", position.row, position.col);
    let message = message.strip_suffix(&place).unwrap_or(&message);
    FormatError::Syntax {
        line: position.row as usize,
        column: position.col as usize,
        message: format!("the SVG can't be used: {message}"),
    }
}

/// Blanks in place of a DOCTYPE that only names SVG, as many programs write it: what declares nothing does no harm.
fn without_doctype(text: &str) -> Cow<'_, str> {
    let found = text.find("<!DOCTYPE").and_then(|start| Some((start, start + text[start..].find('>')?)));
    match found {
        Some((start, end)) if !text[start..end].contains('[') => {
            let blanks = text[start..=end].chars().map(|c| if c == '\n' { '\n' } else { ' ' }).collect::<String>();
            Cow::Owned([&text[..start], &blanks, &text[end + 1..]].concat())
        }
        _ => Cow::Borrowed(text),
    }
}

/// Refuses what the parser would take too long over.
fn check_size(text: &str) -> Result<(), FormatError> {
    let refuse = |byte: usize, message: &str| {
        let (line, column) = place(text, byte);
        let message = format!("the SVG can't be used: {message}");
        Err(FormatError::Syntax { line, column, message })
    };
    let mut at = 0;
    for (index, element) in text.split('<').enumerate() {
        if element.bytes().filter(|&byte| byte == b'=').count() > MAX_ELEMENT_ATTRIBUTES {
            return refuse(at, "an element has too many attributes");
        }
        at += element.len() + usize::from(index > 0);
    }
    let (named, all) = (text.matches("xmlns:").count(), text.matches("xmlns").count());
    if (named + 1).saturating_mul(all) > MAX_NAMESPACE_WORK {
        return refuse(text.rfind("xmlns").unwrap_or(0), "it declares too many namespaces");
    }
    Ok(())
}

pub(super) fn read(text: &str, options: &ReadOptions) -> Result<Reading, FormatError> {
    check_size(text)?;
    let text = &without_doctype(text);
    let parsing = ParsingOptions { allow_dtd: false, nodes_limit: MAX_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, parsing).map_err(|error| located(&error))?;
    let root = document.root_element();
    if root.tag_name().name() != "svg" {
        let message = format!("its outermost element is <{}>, not <svg>", clip(root.tag_name().name()));
        let position = document.text_pos_at(root.range().start);
        return Err(FormatError::Syntax { line: position.row as usize, column: position.col as usize, message });
    }
    let ids = root.descendants().filter_map(|node| Some((node.attribute("id")?, node))).collect();
    let sheet = StyleSheet::of(root);
    let mut reader =
        Reader { document: &document, ids, sheet: &sheet, found: Vec::new(), visits: 0, others: 0, degenerate: 0 };
    let canvas = Canvas::of(root, DVec2::splat(100.0));
    let context = Context {
        transform: DAffine2::IDENTITY,
        fill: None,
        stroke: None,
        class: None,
        is_displayed: true,
        is_visible: true,
        viewport: canvas.size,
        depth: 0,
    };
    reader.visit(root, &context)?;
    reader.finish(root, &canvas, options)
}

/// The rectangle of the page that an `svg` element shows, in its own units.
struct Canvas {
    min: DVec2,
    size: DVec2,
    /// Whether the file says so.
    is_declared: bool,
}

impl Canvas {
    fn of(node: Node, viewport: DVec2) -> Self {
        if let Some(numbers) = node.attribute("viewBox").and_then(numbers)
            && let [x, y, width, height] = numbers[..]
            && width > 0.0
            && height > 0.0
        {
            return Self { min: DVec2::new(x, y), size: DVec2::new(width, height), is_declared: true };
        }
        let side = |name, whole| node.attribute(name).and_then(|text| length(text, whole)).filter(|&side| side > 0.0);
        match (side("width", viewport.x), side("height", viewport.y)) {
            (Some(width), Some(height)) => {
                Self { min: DVec2::ZERO, size: DVec2::new(width, height), is_declared: true }
            }
            _ => Self { min: DVec2::ZERO, size: viewport, is_declared: false },
        }
    }
}

impl<'a> Reader<'a> {
    fn refuse<T>(&self, node: Node, message: &str) -> Result<T, FormatError> {
        let position = self.document.text_pos_at(node.range().start);
        Err(FormatError::Syntax {
            line: position.row as usize,
            column: position.col as usize,
            message: format!("the SVG can't be used: {message}"),
        })
    }

    fn visit(&mut self, node: Node<'a, 'a>, outer: &Context) -> Result<(), FormatError> {
        self.visits += 1;
        if self.visits > MAX_VISITS {
            return self.refuse(node, &format!("it shows more than {MAX_VISITS} elements"));
        }
        if outer.depth > MAX_DEPTH {
            return self.refuse(node, &format!("elements lie more than {MAX_DEPTH} deep in each other"));
        }
        let name = node.tag_name().name();
        match name {
            "svg" | "g" | "a" | "switch" | "circle" | "ellipse" | "use" => {}
            // A glyph of our own, in radii around its middle.
            "path" if node.has_attribute(GLYPH) => {}
            "path" | "rect" | "line" | "polyline" | "polygon" | "image" | "text" => {
                self.others += 1;
                return Ok(());
            }
            // What is not shown where it stands: defs, symbol, clipPath, mask, pattern, marker, style, title, …
            _ => return Ok(()),
        }
        let styles = self.styles(node)?;
        let mut context = self.enter(node, outer, &styles)?;
        match name {
            "circle" | "ellipse" | "path" => self.take(node, &context, &styles),
            "use" => self.follow(node, &context),
            _ => {
                if name == "svg" && outer.depth > 0 {
                    self.nest(node, &mut context);
                }
                for child in node.children().filter(Node::is_element) {
                    self.visit(child, &context)?;
                }
                Ok(())
            }
        }
    }

    /// What style sheets say of an element.
    fn styles(&self, node: Node) -> Result<Styles<'a>, FormatError> {
        let is_long = |name: &&str| node.attribute(*name).is_some_and(|text| text.len() > MAX_STYLE_LENGTH);
        if ["style", "class", "transform"].iter().any(is_long) {
            return self.refuse(node, &format!("a style, class or transform has more than {MAX_STYLE_LENGTH} bytes"));
        }
        match self.sheet.styles(node) {
            Some(styles) => Ok(styles),
            None => self.refuse(node, "its style sheets have too many rules for so many elements"),
        }
    }

    /// What holds within an element.
    fn enter(&self, node: Node, outer: &Context, styles: &Styles<'_>) -> Result<Context, FormatError> {
        let mut context = Context { depth: outer.depth + 1, ..outer.clone() };
        if let Some(text) = node.attribute("transform") {
            match transform(text) {
                Some(own) => context.transform *= own,
                None => return self.refuse(node, &format!("{:?} is not a transform", clip(text))),
            }
        }
        let property = |name| styles.property(node, name);
        let paint = |name| property(name).filter(|value| *value != "inherit");
        if let Some(fill) = paint("fill") {
            context.fill = Some(fill.to_owned());
        }
        if let Some(stroke) = paint("stroke") {
            context.stroke = Some(stroke.to_owned());
        }
        if let Some(class) = node.attribute("data-class") {
            context.class = Some(class.to_owned());
        }
        if property("display") == Some("none") {
            context.is_displayed = false;
        }
        match property("visibility") {
            Some("hidden" | "collapse") => context.is_visible = false,
            Some("visible") => context.is_visible = true,
            _ => {}
        }
        Ok(context)
    }

    /// A picture within the picture: moved to its place, scaled to its size.
    fn nest(&self, node: Node, context: &mut Context) {
        let place = |name, whole| node.attribute(name).and_then(|text| length(text, whole));
        let at =
            DVec2::new(place("x", context.viewport.x).unwrap_or(0.0), place("y", context.viewport.y).unwrap_or(0.0));
        let size = DVec2::new(
            place("width", context.viewport.x).unwrap_or(context.viewport.x),
            place("height", context.viewport.y).unwrap_or(context.viewport.y),
        );
        let inner = Canvas::of(node, size);
        // As large as fits, in the middle: the rule unless a file says otherwise, which drawings of points do not.
        let scale = (size / inner.size).min_element();
        let rest = (size - inner.size * scale) / 2.0;
        context.transform *= DAffine2::from_translation(at + rest)
            * DAffine2::from_scale(DVec2::splat(scale))
            * DAffine2::from_translation(-inner.min);
        context.viewport = inner.size;
    }

    fn follow(&mut self, node: Node<'a, 'a>, context: &Context) -> Result<(), FormatError> {
        let reference =
            node.attributes().find(|attribute| attribute.name() == "href").map(|attribute| attribute.value());
        let Some(target) = reference.and_then(|text| text.strip_prefix('#')).and_then(|id| self.ids.get(id).copied())
        else {
            // Something in another file, or nowhere.
            self.others += 1;
            return Ok(());
        };
        let place = |name, whole| node.attribute(name).and_then(|text| length(text, whole)).unwrap_or(0.0);
        let at = DVec2::new(place("x", context.viewport.x), place("y", context.viewport.y));
        let mut context = context.clone();
        context.transform *= DAffine2::from_translation(at);
        if target.tag_name().name() == "symbol" {
            let inner = self.enter(target, &context, &self.styles(target)?)?;
            for child in target.children().filter(Node::is_element) {
                self.visit(child, &inner)?;
            }
            return Ok(());
        }
        self.visit(target, &context)
    }

    fn take(&mut self, node: Node, context: &Context, styles: &Styles<'_>) -> Result<(), FormatError> {
        let fill = context.fill.as_deref().unwrap_or("black");
        let stroke = context.stroke.as_deref().unwrap_or("none");
        let paint = [fill, stroke].into_iter().find(|paint| *paint != "none" && *paint != "transparent");
        let (true, Some(paint)) = (context.is_displayed && context.is_visible, paint) else { return Ok(()) };
        let diagonal = context.viewport.length() / std::f64::consts::SQRT_2;
        let get = |name: &str, whole: f64| match styles.property(node, name) {
            None => Ok(None),
            Some(text) => match length(text, whole) {
                Some(value) => Ok(Some(value)),
                None => self.refuse(node, &format!("{name} is {:?}, but must be a length", clip(text))),
            },
        };
        let center =
            DVec2::new(get("cx", context.viewport.x)?.unwrap_or(0.0), get("cy", context.viewport.y)?.unwrap_or(0.0));
        let radii = if node.tag_name().name() == "circle" {
            let radius = get("r", diagonal)?.unwrap_or(0.0);
            DVec2::splat(radius)
        } else if node.has_attribute(GLYPH) {
            DVec2::ONE
        } else {
            let (x, y) = (get("rx", context.viewport.x)?, get("ry", context.viewport.y)?);
            DVec2::new(x.or(y).unwrap_or(0.0), y.or(x).unwrap_or(0.0))
        };
        let position = context.transform.transform_point2(center);
        // Of a disk with the same area.
        let radius = (context.transform.matrix2.determinant().abs() * radii.x * radii.y).sqrt();
        if !(position.is_finite() && radius.is_finite() && radii.min_element() > 0.0 && radius > 0.0) {
            self.degenerate += 1;
            return Ok(());
        }
        if self.found.len() >= MAX_POINTS {
            return self.refuse(node, &format!("it has more than {MAX_POINTS} circles"));
        }
        let class = context.class.clone().unwrap_or_else(|| color_name(paint));
        self.found.push(Found { at: node.range().start, position, radius, class });
        Ok(())
    }

    /// The pattern of what was found.
    fn finish(mut self, root: Node, canvas: &Canvas, options: &ReadOptions) -> Result<Reading, FormatError> {
        let mut notes = Vec::new();
        let all = self.found.len();
        let (domain, boundary) = self.own_units(root);
        let inside = |rectangle: Domain| move |found: &Found| rectangle.contains(found.position);
        if let Some(domain) = domain {
            // In a tile the opposite sides are the same, and what comes in from the other side is drawn twice.
            let max = domain.max();
            let is_tile = boundary == Boundary::Periodic;
            self.found.retain(|found| inside(domain)(found) && !(is_tile && found.position.cmpge(max).any()));
        } else if canvas.is_declared
            && let Ok(page) = Domain::new(canvas.min, canvas.size)
        {
            self.found.retain(inside(page));
            match all - self.found.len() {
                0 => {}
                1 => notes.push(Note::left_out("One circle outside the picture was left out.")),
                outside => notes.push(Note::left_out(format!("{outside} circles outside the picture were left out."))),
            }
        }
        match self.others {
            0 => {}
            1 => notes.push(Note::left_out("One shape that is no circle was left out.")),
            others => notes.push(Note::left_out(format!("{others} shapes that are no circles were left out."))),
        }
        if self.degenerate > 0 {
            notes.push(Note::left_out(format!("{} circles without a size were left out.", self.degenerate)));
        }
        match self.sheet.left_out {
            0 => {}
            1 => notes.push(Note::left_out(
                "One rule of its style sheets is more than elements, ids and classes, and was left out.",
            )),
            rules => notes.push(Note::left_out(format!(
                "{rules} rules of its style sheets are more than elements, ids and classes, and were left out."
            ))),
        }
        if self.found.is_empty() {
            return self.refuse(root, &format!("it shows no circles or ellipses, but {} other shapes", self.others));
        }
        let positions: Vec<DVec2> = self.found.iter().map(|found| found.position).collect();
        let is_domain_declared = options.domain.or(domain).is_some();
        let mut choices = Vec::new();
        let domain = match options.domain.or(domain) {
            Some(domain) => domain,
            None => {
                let guess = page_or_points(canvas, &positions)?;
                notes.extend(guess.notes);
                choices = guess.choices;
                guess.domain
            }
        };
        if let Some(found) = self.found.iter().find(|found| !domain.contains(found.position)) {
            let position = self.document.text_pos_at(found.at);
            return Err(FormatError::Outside {
                place: Place::Line { line: position.row as usize, column: position.col as usize },
                at: found.position.into(),
                min: domain.min().into(),
                max: domain.max().into(),
            });
        }
        let pattern = PointPattern::new(domain, positions)?.with_boundary(options.boundary.unwrap_or(boundary));
        let mut reading = Reading::new(FileFormat::Svg, self.dress(pattern, &mut notes)?);
        reading.is_domain_declared = is_domain_declared;
        reading.domains = choices;
        reading.notes = notes;
        Ok(reading)
    }

    /// Classes and radii.
    fn dress(&self, mut pattern: PointPattern, notes: &mut Vec<Note>) -> Result<PointPattern, FormatError> {
        let mut names: Vec<String> = Vec::new();
        let mut classes = Vec::with_capacity(self.found.len());
        for found in &self.found {
            let name: String = found.class.trim().chars().filter(|c| !c.is_control()).take(MAX_NAME_LENGTH).collect();
            let name = if name.is_empty() { "none".to_owned() } else { name };
            let class = names.iter().position(|known| *known == name).unwrap_or_else(|| {
                names.push(name);
                names.len() - 1
            });
            classes.push(class as u16);
            if names.len() > MAX_CLASSES {
                break;
            }
        }
        if names.len() > MAX_CLASSES {
            notes.push(Note::left_out(format!(
                "There are more than {MAX_CLASSES} colours, so all points are of one class."
            )));
        } else if names.len() > 1 || names.first().is_some_and(|name| !name.starts_with('#')) {
            pattern = pattern.with_classes(classes, names)?;
        }
        let first = self.found.first().map_or(0.0, |found| found.radius);
        // Three decimals are what writers keep.
        if self.found.iter().any(|found| (found.radius - first).abs() > 1e-3 * first) {
            let values = self.found.iter().map(|found| found.radius).collect();
            pattern = pattern.with_attribute(Attribute { name: RADIUS_ATTRIBUTE.to_owned(), values })?;
        }
        Ok(pattern)
    }

    /// Back from pixels to the pattern's own unit, where [`write_svg`](super::write_svg) left what that takes.
    fn own_units(&mut self, root: Node) -> (Option<Domain>, Boundary) {
        let list = |name| root.attribute(name).and_then(numbers);
        let (Some(domain), Some(frame)) = (list("data-domain"), list("data-frame")) else {
            return (None, Boundary::Open);
        };
        let boundary = match root.attribute("data-boundary") {
            Some("periodic") => Boundary::Periodic,
            _ => Boundary::Open,
        };
        let (&[x, y, width, height], &[left, top, columns, rows]) = (&domain[..], &frame[..]) else {
            return (None, boundary);
        };
        let Ok(domain) = Domain::new(DVec2::new(x, y), DVec2::new(width, height)) else { return (None, boundary) };
        let Ok(frame) = Domain::new(DVec2::new(left, top), DVec2::new(columns, rows)) else { return (None, boundary) };
        let unit = domain.exemplar_unit() / frame.exemplar_unit();
        for found in &mut self.found {
            // Three decimals put a point on the border a little outside.
            let place = (found.position - frame.min()) / frame.size();
            let rounding = 1e-3 / frame.size().min_element();
            let place = if place.cmpge(DVec2::splat(-rounding)).all() && place.cmple(DVec2::splat(1.0 + rounding)).all()
            {
                place.clamp(DVec2::ZERO, DVec2::ONE)
            } else {
                place
            };
            found.position = domain.min() + place * domain.size();
            found.radius *= unit;
        }
        (Some(domain), boundary)
    }
}

/// The whole page where the points fill at least half of it, else what the points suggest: circles in the corner of a
/// sheet of paper are no pattern with a large hole.
fn page_or_points(canvas: &Canvas, positions: &[DVec2]) -> Result<Guess, FormatError> {
    let guessed = Guess::of(positions);
    if canvas.is_declared
        && let Ok(page) = Domain::new(canvas.min, canvas.size)
        && guessed
            .as_ref()
            .map_or(true, |guess| guess.domain == Domain::UNIT || 2.0 * guess.domain.area() >= page.area())
    {
        return Ok(Guess { domain: page, choices: Vec::new(), notes: Vec::new() });
    }
    guessed
}

/// A length in user units; a share in percent is one of `whole`.
fn length(text: &str, whole: f64) -> Option<f64> {
    let text = text.trim();
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic() || c == '%');
    // `1e3` ends in no unit, and `1em` begins with no exponent.
    let value: f64 = digits.trim_end().parse().ok()?;
    let unit = match &text[digits.len()..] {
        "" | "px" => 1.0,
        "pt" => 4.0 / 3.0,
        "pc" => 16.0,
        "in" => 96.0,
        "cm" => 96.0 / 2.54,
        "mm" => 96.0 / 25.4,
        "em" | "rem" => 16.0,
        "ex" | "ch" => 8.0,
        "%" => whole / 100.0,
        _ => return None,
    };
    Some(value * unit).filter(|value| value.is_finite())
}

/// Numbers separated by blanks and commas.
fn numbers(text: &str) -> Option<Vec<f64>> {
    let words = text.split(|c: char| c == ',' || c.is_ascii_whitespace()).filter(|word| !word.is_empty());
    words.map(|word| word.parse().ok().filter(|number: &f64| number.is_finite())).collect()
}

/// `translate(…) rotate(…) …`.
fn transform(text: &str) -> Option<DAffine2> {
    let mut whole = DAffine2::IDENTITY;
    let mut rest = text.trim();
    while !rest.is_empty() {
        let (name, after) = rest.split_once('(')?;
        let (inner, after) = after.split_once(')')?;
        let list = numbers(inner)?;
        let radians = |degrees: f64| degrees.to_radians();
        whole *= match (name.trim(), &list[..]) {
            ("matrix", &[a, b, c, d, e, f]) => {
                DAffine2::from_mat2_translation(DMat2::from_cols_array(&[a, b, c, d]), DVec2::new(e, f))
            }
            ("translate", &[x]) => DAffine2::from_translation(DVec2::new(x, 0.0)),
            ("translate", &[x, y]) => DAffine2::from_translation(DVec2::new(x, y)),
            ("scale", &[both]) => DAffine2::from_scale(DVec2::splat(both)),
            ("scale", &[x, y]) => DAffine2::from_scale(DVec2::new(x, y)),
            ("rotate", &[angle]) => DAffine2::from_angle(radians(angle)),
            ("rotate", &[angle, x, y]) => {
                let center = DVec2::new(x, y);
                DAffine2::from_translation(center)
                    * DAffine2::from_angle(radians(angle))
                    * DAffine2::from_translation(-center)
            }
            ("skewX", &[angle]) => DAffine2::from_mat2(DMat2::from_cols_array(&[1.0, 0.0, radians(angle).tan(), 1.0])),
            ("skewY", &[angle]) => DAffine2::from_mat2(DMat2::from_cols_array(&[1.0, radians(angle).tan(), 0.0, 1.0])),
            _ => return None,
        };
        rest = after.trim_start_matches(|c: char| c == ',' || c.is_ascii_whitespace());
    }
    Some(whole)
}

/// One spelling for the usual spellings of a colour.
fn color_name(paint: &str) -> String {
    const NAMED: [(&str, &str); 17] = [
        ("black", "#000000"),
        ("silver", "#c0c0c0"),
        ("gray", "#808080"),
        ("grey", "#808080"),
        ("white", "#ffffff"),
        ("maroon", "#800000"),
        ("red", "#ff0000"),
        ("purple", "#800080"),
        ("fuchsia", "#ff00ff"),
        ("green", "#008000"),
        ("lime", "#00ff00"),
        ("olive", "#808000"),
        ("yellow", "#ffff00"),
        ("navy", "#000080"),
        ("blue", "#0000ff"),
        ("teal", "#008080"),
        ("aqua", "#00ffff"),
    ];
    let paint = paint.trim().to_ascii_lowercase();
    if let Some((_, hex)) = NAMED.iter().find(|(name, _)| *name == paint) {
        return (*hex).to_owned();
    }
    if let Some(digits) = paint.strip_prefix('#')
        && digits.len() == 3
        && digits.is_ascii()
    {
        return digits.chars().fold("#".to_owned(), |text, digit| text + &digit.to_string().repeat(2));
    }
    if let Some(list) = paint.strip_prefix("rgb(").and_then(|rest| rest.strip_suffix(')')) {
        let parts: Option<Vec<u8>> = list.split(',').map(|part| part.trim().parse().ok()).collect();
        if let Some(&[red, green, blue]) = parts.as_deref() {
            return super::style::Color::new(red, green, blue).hex();
        }
    }
    paint
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
    }

    #[test]
    fn transforms_apply_from_the_right() {
        let at = |text: &str| transform(text).map(|own| own.transform_point2(DVec2::new(1.0, 2.0)).round());
        assert_eq!(at("translate(10) scale(2,3)"), Some(DVec2::new(12.0, 6.0)));
        assert_eq!(at("rotate(90)"), Some(DVec2::new(-2.0, 1.0)));
        assert_eq!(at("rotate(90, 1 1),translate(0,0)"), Some(DVec2::new(0.0, 1.0)));
        assert_eq!(at("matrix(1 0 0 1 5 -5)"), Some(DVec2::new(6.0, -3.0)));
        assert_eq!(at("skewX(45)"), Some(DVec2::new(3.0, 2.0)));
        for wrong in ["spin(1)", "scale(1", "scale()", "matrix(1 2 3)", "scale(x)"] {
            assert_eq!(at(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn colours_have_one_spelling() {
        for (text, hex) in
            [("Red", "#ff0000"), ("#F00", "#ff0000"), ("rgb(255, 0,0)", "#ff0000"), ("#0072B2", "#0072b2")]
        {
            assert_eq!(color_name(text), hex);
        }
        assert_eq!(color_name("tomato"), "tomato");
        assert_eq!(color_name("#é00"), "#é00");
    }
}
