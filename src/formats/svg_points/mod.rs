//! Points of a drawing: what a person sees as marks. Circles and ellipses, also by way of `use`, with all transforms, clips
//! and colours; shapes that look like them; small shapes where there are no circles; and our own glyphs.
//!
//! The class is what a group says with `data-class` (as [`write_svg`](super::write_svg) does), else the colour of the
//! fill, else of the stroke; with more than one radius there is an attribute `radius`. y points down, as in the drawing
//! and on the page. Nothing outside the file is ever fetched.
//!
//! The walk is our own, in doubles and with caps on everything: libraries that draw SVG compute in single precision and
//! forget where an element stood and what it was called. The grammars of colours, lengths, transforms and selectors are
//! those of `svgtypes` and `simplecss`.

mod canvas;
mod clip;
mod document;
mod marks;
mod paint;
mod shape;
mod style_sheet;
mod transform;
mod walk;

use glam::DVec2;
use roxmltree::{Document, Node};
use svgtypes::NumberListParser;

use super::error::{FormatError, Place};
use super::guess::Guess;
use super::note::counted;
use super::style::RADIUS_ATTRIBUTE;
use super::{FileFormat, Note, ReadOptions, Reading};
use crate::pattern::{Attribute, Boundary, Domain, MAX_CLASSES, MAX_NAME_LENGTH, MAX_POINTS, PointPattern};
use canvas::Canvas;
use document::refuse;
use marks::{Found, Kind};
use style_sheet::StyleSheet;
use walk::{Context, Walk};

/// How much radii of one size may differ: writers keep three decimals, and programs that make paths of circles fewer.
const SAME_RADIUS: f64 = 1e-3;
const SAME_RADIUS_OF_PATHS: f64 = 0.02;

pub(super) fn read(text: &str, options: &ReadOptions) -> Result<Reading, FormatError> {
    document::check_size(text)?;
    let text = &document::without_doctype(text);
    let document = document::parse(text)?;
    let root = document.root_element();
    let css = style_sheet::css_of(root);
    let sheet = StyleSheet::parse(&css);
    let own = Own::of(root);
    let mut walk = Walk::new(root, &sheet, own.is_some());
    let canvas = Canvas::of(root, &walk.styles(root)?);
    walk.visit(root, &Context::new(canvas.transform, canvas.viewport))?;
    Finish { document: &document, canvas, own, options, notes: Vec::new() }.reading(walk)
}

/// What a drawing of ours says of its pattern: the domain, where in the picture it is, and the boundary.
struct Own {
    domain: Domain,
    frame: Domain,
    boundary: Boundary,
}

impl Own {
    fn of(root: Node) -> Option<Self> {
        let rectangle = |name| {
            let numbers: Vec<f64> =
                NumberListParser::from(root.attribute(name)?).take(5).collect::<Result<_, _>>().ok()?;
            let &[x, y, width, height] = &numbers[..] else { return None };
            Domain::new(DVec2::new(x, y), DVec2::new(width, height)).ok()
        };
        let boundary = match root.attribute("data-boundary") {
            Some("periodic") => Boundary::Periodic,
            _ => Boundary::Open,
        };
        Some(Self { domain: rectangle("data-domain")?, frame: rectangle("data-frame")?, boundary })
    }

    /// Back from pixels to the pattern's own unit, without what comes in from the other side.
    fn restore(&self, found: &mut Vec<Found>) {
        let (domain, frame) = (self.domain, self.frame);
        let unit = domain.exemplar_unit() / frame.exemplar_unit();
        for mark in found.iter_mut() {
            // Three decimals put a point on the border a little outside.
            let place = (mark.position - frame.min()) / frame.size();
            let rounding = 1e-3 / frame.size().min_element();
            let place = if place.cmpge(DVec2::splat(-rounding)).all() && place.cmple(DVec2::splat(1.0 + rounding)).all()
            {
                place.clamp(DVec2::ZERO, DVec2::ONE)
            } else {
                place
            };
            mark.position = domain.min() + place * domain.size();
            mark.radius *= unit;
        }
        // In a tile the opposite sides are the same, and what comes in from the other side is drawn twice.
        let is_tile = self.boundary == Boundary::Periodic;
        let max = domain.max();
        found.retain(|mark| domain.contains(mark.position) && !(is_tile && mark.position.cmpge(max).any()));
    }
}

/// From marks to a pattern.
struct Finish<'a> {
    document: &'a Document<'a>,
    canvas: Canvas,
    own: Option<Own>,
    options: &'a ReadOptions,
    notes: Vec<Note>,
}

impl Finish<'_> {
    fn reading(mut self, walk: Walk) -> Result<Reading, FormatError> {
        let root = self.document.root_element();
        let Walk { mut found, mut left, classes, sheet, .. } = walk;
        if let Some(own) = &self.own {
            // Its background and frame are no news.
            found.retain(|mark| mark.kind == Kind::Circle);
            own.restore(&mut found);
        } else {
            let side = self.longer_side(&found);
            marks::choose(&mut found, side, &mut left, &mut self.notes);
            self.keep_page(&mut found);
        }
        left.notes(&mut self.notes);
        if sheet.left_out > 0 {
            let text = counted(
                sheet.left_out,
                "One rule of its style sheets uses more of CSS than is read, and was left out.",
                "rules of its style sheets use more of CSS than is read, and were left out.",
            );
            self.notes.push(Note::left_out(format!(
                "{text} If classes are missing, let the program write colours to the shapes themselves."
            )));
        }
        if found.is_empty() {
            let said: String = self.notes.iter().map(|note| format!("; {}", note.text)).collect();
            let others = left.others();
            let message = format!("it shows no circles, dots or small shapes, but {others} other shapes{said}");
            return refuse(root, message.trim_end_matches('.'));
        }
        if let Some(beyond) = found.get(MAX_POINTS) {
            let position = self.document.text_pos_at(beyond.at);
            return Err(FormatError::Syntax {
                line: position.row as usize,
                column: position.col as usize,
                message: format!("the SVG can't be used: it has more than {MAX_POINTS} marks"),
            });
        }
        self.pattern(&found, &classes)
    }

    /// Of the page, or of what is drawn where no page is declared.
    fn longer_side(&self, found: &[Found]) -> f64 {
        if self.canvas.is_declared {
            return self.canvas.size.max_element();
        }
        let positions = || found.iter().map(|mark| mark.position);
        let extent = positions().fold(DVec2::NEG_INFINITY, DVec2::max) - positions().fold(DVec2::INFINITY, DVec2::min);
        // One place has no extent that a mark could be large against.
        if extent.max_element() > 0.0 { extent.max_element() } else { f64::INFINITY }
    }

    /// Leaves out what lies outside the page.
    fn keep_page(&mut self, found: &mut Vec<Found>) {
        let Ok(page) = Domain::new(self.canvas.min, self.canvas.size) else { return };
        if !self.canvas.is_declared {
            return;
        }
        let all = found.len();
        found.retain(|mark| page.contains(mark.position));
        if found.len() < all {
            let text = counted(
                all - found.len(),
                "One mark outside the page was left out.",
                "marks outside the page were left out.",
            );
            self.notes.push(Note::left_out(format!("{text} To keep them, enlarge the page in the drawing program.")));
        }
    }

    fn pattern(mut self, found: &[Found], classes: &[std::rc::Rc<str>]) -> Result<Reading, FormatError> {
        let positions: Vec<DVec2> = found.iter().map(|mark| mark.position).collect();
        let own = self.own.as_ref().map(|own| own.domain);
        let declared = self.options.domain.or(own);
        let mut choices = Vec::new();
        let domain = match declared {
            Some(domain) => domain,
            None => {
                let guess = page_or_points(&self.canvas, &positions)?;
                self.notes.extend(guess.notes);
                choices = guess.choices;
                guess.domain
            }
        };
        if let Some(mark) = found.iter().find(|mark| !domain.contains(mark.position)) {
            let position = self.document.text_pos_at(mark.at);
            return Err(FormatError::Outside {
                place: Place::Line { line: position.row as usize, column: position.col as usize },
                at: mark.position.into(),
                min: domain.min().into(),
                max: domain.max().into(),
            });
        }
        let boundary = self.own.as_ref().map_or(Boundary::Open, |own| own.boundary);
        let pattern = PointPattern::new(domain, positions)?.with_boundary(self.options.boundary.unwrap_or(boundary));
        let mut reading = Reading::new(FileFormat::Svg, self.dress(pattern, found, classes)?);
        reading.is_domain_declared = declared.is_some();
        reading.domains = choices;
        reading.notes = self.notes;
        Ok(reading)
    }

    /// Classes and radii.
    fn dress(
        &mut self,
        mut pattern: PointPattern,
        found: &[Found],
        classes: &[std::rc::Rc<str>],
    ) -> Result<PointPattern, FormatError> {
        let mut names: Vec<String> = Vec::new();
        let mut numbers: Vec<Option<usize>> = vec![None; classes.len()];
        let mut marks = Vec::with_capacity(found.len());
        for mark in found {
            let number = match numbers[mark.class] {
                Some(number) => number,
                None => {
                    let name = class_name(&classes[mark.class]);
                    let number = names.iter().position(|known| *known == name).unwrap_or_else(|| {
                        names.push(name);
                        names.len() - 1
                    });
                    numbers[mark.class] = Some(number);
                    number
                }
            };
            marks.push(number as u16);
            if names.len() > MAX_CLASSES {
                break;
            }
        }
        if names.len() > MAX_CLASSES {
            self.notes.push(Note::left_out(format!(
                "There are more than {MAX_CLASSES} colours, so all points are of one class."
            )));
        } else if names.len() > 1 || names.first().is_some_and(|name| !name.starts_with('#')) {
            pattern = pattern.with_classes(marks, names)?;
        }
        let first = found.first().map_or(0.0, |mark| mark.radius);
        let is_exact = found.iter().all(|mark| mark.kind == Kind::Circle);
        let tolerance = if is_exact { SAME_RADIUS } else { SAME_RADIUS_OF_PATHS };
        if found.iter().any(|mark| (mark.radius - first).abs() > tolerance * first) {
            let values = found.iter().map(|mark| mark.radius).collect();
            pattern = pattern.with_attribute(Attribute { name: RADIUS_ATTRIBUTE.to_owned(), values })?;
        }
        Ok(pattern)
    }
}

/// A name of a class as it may stand in a pattern.
fn class_name(text: &str) -> String {
    let name: String = text.trim().chars().filter(|c| !c.is_control()).take(MAX_NAME_LENGTH).collect();
    if name.is_empty() { "none".to_owned() } else { name }
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
        return Ok(Guess::told(page));
    }
    guessed
}
