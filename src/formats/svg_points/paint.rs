//! Colours and gradients by value, not by name: what looks the same is the same class.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

use roxmltree::{Node, NodeId};
use svgtypes::{Color, FuncIRI, Paint, PaintFallback};

use super::canvas::share;
use super::style_sheet::StyleSheet;
use crate::formats::style;

/// Gradients that refer to one another.
const MAX_REFERENCES: usize = 64;
/// Most stops of a gradient that are looked at.
const MAX_STOPS: usize = 100;

/// What `fill` or `stroke` say.
#[derive(Clone, Copy, Debug)]
pub(super) enum Source<'a> {
    Paint(Paint<'a>),
    /// A colour in words that are newer: known by what it is called.
    Unknown(&'a str),
}

impl<'a> Source<'a> {
    pub(super) const BLACK: Self = Self::Paint(Paint::Color(Color { red: 0, green: 0, blue: 0, alpha: 255 }));
    pub(super) const NONE: Self = Self::Paint(Paint::None);

    /// Nothing when it is no paint, which browsers pass over.
    pub(super) fn parse(text: &'a str) -> Option<Self> {
        // A colour for printers can follow the one for screens.
        let screen = text.split("icc-color(").next().unwrap_or_default().trim();
        match Paint::from_str(screen) {
            Ok(Paint::Inherit) => None,
            Ok(paint) => Some(Self::Paint(paint)),
            Err(_) if screen.eq_ignore_ascii_case("currentcolor") => Some(Self::Paint(Paint::CurrentColor)),
            // Younger than the list of names the library has.
            Err(_) if screen.eq_ignore_ascii_case("rebeccapurple") => Self::parse("#663399"),
            Err(_) if text.contains('(') && !text.starts_with("url(") => Some(Self::Unknown(text)),
            Err(_) => None,
        }
    }
}

/// The element that `url(#id)` names; none for `none`, for files and for functions.
pub(super) fn reference(value: &str) -> Option<&str> {
    FuncIRI::from_str(value.trim()).ok().map(|iri| iri.0)
}

/// The `#id` that an element refers to.
pub(super) fn href<'a>(node: Node<'a, '_>) -> Option<&'a str> {
    node.attributes().find(|attribute| attribute.name() == "href")?.value().trim().strip_prefix('#')
}

/// A colour one can see: what a class is called after, and how opaque it is, from 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ink {
    pub(super) name: Rc<str>,
    pub(super) opacity: f64,
}

impl Ink {
    fn of(color: Color) -> Self {
        Self { name: hex(color).into(), opacity: f64::from(color.alpha) / 255.0 }
    }
}

fn hex(color: Color) -> String {
    style::Color::new(color.red, color.green, color.blue).hex()
}

/// Gradients and patterns of a document.
#[derive(Default)]
pub(super) struct Servers {
    known: RefCell<HashMap<NodeId, Option<Ink>>>,
}

impl Servers {
    /// What a paint looks like; nothing when it leaves no trace.
    pub(super) fn ink<'a>(
        &self,
        source: Source<'a>,
        current: Color,
        ids: &HashMap<&str, Node<'a, 'a>>,
        sheet: &StyleSheet,
    ) -> Option<Ink> {
        let paint = match source {
            Source::Paint(paint) => paint,
            Source::Unknown(text) => return Some(Ink { name: text.to_ascii_lowercase().into(), opacity: 1.0 }),
        };
        match paint {
            Paint::None | Paint::Inherit => None,
            Paint::CurrentColor => Some(Ink::of(current)),
            Paint::Color(color) => Some(Ink::of(color)),
            Paint::ContextFill | Paint::ContextStroke => Some(Ink::of(Color::black())),
            Paint::FuncIRI(id, fallback) => match (ids.get(id), fallback) {
                (Some(node), _) => self.server(*node, ids, sheet),
                (None, Some(PaintFallback::Color(color))) => Some(Ink::of(color)),
                (None, Some(PaintFallback::CurrentColor)) => Some(Ink::of(current)),
                (None, Some(PaintFallback::None) | None) => None,
            },
        }
    }

    /// A gradient by the colours of its stops, a pattern by its id, each where the references end.
    fn server<'a>(&self, node: Node<'a, 'a>, ids: &HashMap<&str, Node<'a, 'a>>, sheet: &StyleSheet) -> Option<Ink> {
        let mut node = node;
        for _ in 0..MAX_REFERENCES {
            if node.children().any(|child| child.is_element()) {
                break;
            }
            match href(node).and_then(|id| ids.get(id)) {
                Some(next) => node = *next,
                None => break,
            }
        }
        if let Some(ink) = self.known.borrow().get(&node.id()) {
            return ink.clone();
        }
        let ink = match node.tag_name().name() {
            "linearGradient" | "radialGradient" => gradient(node, sheet),
            "pattern" => Some(Ink { name: node.attribute("id").unwrap_or("pattern").into(), opacity: 1.0 }),
            _ => None,
        };
        self.known.borrow_mut().insert(node.id(), ink.clone());
        ink
    }
}

/// The colours of the stops in their order, each once: `#ffffff-#2277aa`.
fn gradient(node: Node, sheet: &StyleSheet) -> Option<Ink> {
    let mut colors: Vec<String> = Vec::new();
    let mut opacity = 0.0_f64;
    for stop in node.children().filter(|child| child.tag_name().name() == "stop").take(MAX_STOPS) {
        // When the sheets have too much to compare, the walk over the marks says so.
        let Some(styles) = sheet.styles(stop) else { break };
        let own = |name| styles.get(name).or_else(|| stop.attribute(name));
        let color: Color = own("stop-color").and_then(|text| text.parse().ok()).unwrap_or(Color::black());
        let share = own("stop-opacity").and_then(share).unwrap_or(1.0);
        opacity = opacity.max(share * f64::from(color.alpha) / 255.0);
        let hex = hex(color);
        if !colors.contains(&hex) {
            colors.push(hex);
        }
    }
    let name = colors.join("-").into();
    (!colors.is_empty()).then_some(Ink { name, opacity })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_have_one_spelling() {
        let ink = |text| {
            let source = Source::parse(text)?;
            Servers::default().ink(source, Color::white(), &HashMap::new(), &StyleSheet::default())
        };
        let same = ["Red", "#F00", "#ff0000", "rgb(255, 0,0)", "rgb(100%,0%,0%)", "hsl(0,100%,50%)", "#f00f"];
        let print = ["#ff0000 icc-color(profile, 0, 1, 1, 0)", "url(#nothing) red", "rgb(255 0 0)"];
        for text in same.into_iter().chain(print) {
            assert_eq!(ink(text), Some(Ink { name: "#ff0000".into(), opacity: 1.0 }), "{text}");
        }
        assert_eq!(ink("tomato").map(|ink| ink.name), Some("#ff6347".into()));
        assert_eq!(ink("currentColor").map(|ink| ink.name), Some("#ffffff".into()));
        assert_eq!(ink("OKLCH(0.6 0.2 30)").map(|ink| ink.name), Some("oklch(0.6 0.2 30)".into()));
        for nothing in ["none", "url(#nothing)", "#é00", "nonsense", "inherit", "url(#"] {
            assert_eq!(ink(nothing), None, "{nothing}");
        }
        for clear in ["transparent", "rgba(1,2,3,0)", "#12345600"] {
            assert_eq!(ink(clear).map(|ink| ink.opacity), Some(0.0), "{clear}");
        }
    }
}
