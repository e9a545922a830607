//! SVG: one `<circle>` or `<use>` a point, one group a class.

use std::fmt::Write as _;

use glam::DVec2;

use super::glyph::Glyph;
use super::style::{self, Layout, Look};
use crate::pattern::PointPattern;

/// How an SVG is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct SvgStyle {
    /// Longer side in pixels (user units), margins included.
    pub size_px: f64,
    /// What stands in `<title>`; the number of points when empty.
    pub title: String,
    /// Colours and sizes.
    pub look: Look,
}

impl Default for SvgStyle {
    fn default() -> Self {
        Self { size_px: 800.0, title: String::new(), look: Look::default() }
    }
}

/// Draws a pattern as SVG. y points down, as on the page; coordinates are pixels, so that any domain fits what
/// viewers can hold. A tile (`Periodic`) is clipped to its domain and shows what comes in from the other side.
#[must_use]
pub fn write_svg(pattern: &PointPattern, style: &SvgStyle) -> String {
    let picture = style::picture_size(pattern, style.size_px, &style.look);
    let layout = style::lay_out(pattern, DVec2::ZERO, picture, &style.look);
    let (width, height) = (Px(picture.x), Px(picture.y));
    let frame = format!(
        "x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"",
        Px(layout.min.x),
        Px(layout.min.y),
        Px(layout.size.x),
        Px(layout.size.y)
    );
    let title = if style.title.is_empty() { format!("{} points", pattern.len()) } else { style.title.clone() };

    // Writing to a String can't fail, so the results of `write!` are dropped.
    let mut svg = String::with_capacity(600 + layout.marks.len() * 64);
    let _ = writeln!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" role=\"img\"{}>",
        domain_attributes(pattern, &layout)
    );
    let _ = writeln!(svg, "<title>{}</title>", escape(&title));
    if let Some(color) = style.look.background {
        let _ = writeln!(svg, "<rect width=\"{width}\" height=\"{height}\" fill=\"{}\"/>", color.hex());
    }
    // Below the glyphs: points on the border stay whole.
    if let Some(color) = style.look.frame {
        let line = Px(layout.line);
        let _ = writeln!(svg, "<rect {frame} fill=\"none\" stroke=\"{}\" stroke-width=\"{line}\"/>", color.hex());
    }
    if layout.clipped {
        let _ = writeln!(svg, "<clipPath id=\"tile\"><rect {frame}/></clipPath>\n<g clip-path=\"url(#tile)\">");
    }
    write_marks(&mut svg, &layout, "glyph");
    if layout.clipped {
        svg.push_str("</g>\n");
    }
    svg.push_str("</svg>\n");
    svg
}

/// Writes the glyphs of a layout, one group a run of one class. Those that are no circles are defined once a class,
/// under names that begin with `id`.
pub(crate) fn write_marks(svg: &mut String, layout: &Layout, id: &str) {
    for (number, class) in layout.classes.iter().enumerate() {
        let data = class.glyph.path_data();
        if !data.is_empty() {
            let scaling = if layout.halo.is_some() { " vector-effect=\"non-scaling-stroke\"" } else { "" };
            let _ = writeln!(
                svg,
                "<defs><path id=\"{id}-{number}\" {GLYPH}=\"{}\" d=\"{data}\"{scaling}/></defs>",
                class.glyph.name()
            );
        }
    }
    for marks in layout.marks.chunk_by(|a, b| a.class == b.class) {
        let number = marks[0].class;
        let Some(class) = layout.classes.get(usize::from(number)) else { continue };
        let (color, ring) = (class.color.hex(), class.glyph == Glyph::Ring);
        let _ = write!(svg, "<g data-class=\"{}\"", escape(&class.name));
        let _ = match layout.halo {
            _ if ring => writeln!(svg, " fill=\"none\" stroke=\"{color}\">"),
            Some(halo) => writeln!(
                svg,
                " fill=\"{color}\" stroke=\"{}\" stroke-width=\"{}\" paint-order=\"stroke\">",
                halo.hex(),
                Px(HALO * layout.line)
            ),
            None => writeln!(svg, " fill=\"{color}\">"),
        };
        for mark in marks {
            let (x, y) = (Px(mark.center.x), Px(mark.center.y));
            let _ = match class.glyph {
                Glyph::Ring => {
                    let ring = Ring::of(mark.radius, layout.line);
                    let (r, stroke) = (Px(ring.radius), Px(ring.width));
                    writeln!(svg, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\" stroke-width=\"{stroke}\"/>")
                }
                Glyph::Disk => writeln!(svg, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{}\"/>", Px(mark.radius)),
                _ => {
                    // y points down, so turning back is counter-clockwise.
                    let turn = if mark.turn == 0.0 { String::new() } else { format!(" rotate({})", Px(-mark.turn)) };
                    let r = Px(mark.radius);
                    writeln!(svg, "<use href=\"#{id}-{number}\" transform=\"translate({x} {y}){turn} scale({r})\"/>")
                }
            };
        }
        svg.push_str("</g>\n");
    }
}

/// The attribute that marks a path as a glyph, for the reader of SVG.
pub(crate) const GLYPH: &str = "data-glyph";

/// Width of the line around glyphs that stand before others, both sides together, in lines of the frame.
pub(crate) const HALO: f64 = 3.0;

/// What the reader of SVG needs to get the pattern back in its own unit: the domain, and where in the picture it is.
fn domain_attributes(pattern: &PointPattern, layout: &Layout) -> String {
    let (min, size) = (pattern.domain().min(), pattern.domain().size());
    let domain = [min.x, min.y, size.x, size.y].map(|number| format!("{number:?}")).join(" ");
    let frame = [layout.min.x, layout.min.y, layout.size.x, layout.size.y].map(|px| Px(px).to_string()).join(" ");
    format!(" data-domain=\"{domain}\" data-frame=\"{frame}\" data-boundary=\"{}\"", pattern.boundary().name())
}

/// A ring with the outline of a disk: its middle line and width.
pub(crate) struct Ring {
    pub(crate) radius: f64,
    pub(crate) width: f64,
}

impl Ring {
    pub(crate) fn of(outer: f64, line: f64) -> Self {
        let width = (outer * 0.4).max(line).min(outer);
        Self { radius: outer - width / 2.0, width }
    }
}

/// A length in pixels with at most three decimals.
pub(crate) struct Px(pub(crate) f64);

impl std::fmt::Display for Px {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let text = format!("{:.3}", self.0);
        let text = text.trim_end_matches('0').trim_end_matches('.');
        f.write_str(if text == "-0" { "0" } else { text })
    }
}

/// Text as it may stand in an element or a quoted attribute. What XML can't hold at all becomes U+FFFD.
pub(crate) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\u{fffe}' | '\u{ffff}' => escaped.push('\u{fffd}'),
            control if control.is_control() && !matches!(control, '\n' | '\t') => escaped.push('\u{fffd}'),
            other => escaped.push(other),
        }
    }
    escaped
}
