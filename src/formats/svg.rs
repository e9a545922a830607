//! SVG: one `<circle>` a point, one group a class.

use std::fmt::Write as _;

use glam::DVec2;

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
    let mut svg = String::with_capacity(600 + layout.disks.len() * 48);
    let _ = writeln!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" role=\"img\"{}>",
        domain_attributes(pattern, &layout)
    );
    let _ = writeln!(svg, "<title>{}</title>", escape(&title));
    if let Some(color) = style.look.background {
        let _ = writeln!(svg, "<rect width=\"{width}\" height=\"{height}\" fill=\"{}\"/>", color.hex());
    }
    // Below the disks: points on the border stay whole.
    if let Some(color) = style.look.frame {
        let line = Px(layout.line);
        let _ = writeln!(svg, "<rect {frame} fill=\"none\" stroke=\"{}\" stroke-width=\"{line}\"/>", color.hex());
    }
    if layout.clipped {
        let _ = writeln!(svg, "<clipPath id=\"tile\"><rect {frame}/></clipPath>\n<g clip-path=\"url(#tile)\">");
    }
    for disks in layout.disks.chunk_by(|a, b| a.class == b.class) {
        let class = disks[0].class;
        let look = style::class_style(class);
        let paint = if look.hollow {
            format!("fill=\"none\" stroke=\"{}\"", look.color.hex())
        } else {
            format!("fill=\"{}\"", look.color.hex())
        };
        let name = pattern.class_names().get(usize::from(class)).map_or("", String::as_str);
        let _ = writeln!(svg, "<g data-class=\"{}\" {paint}>", escape(name));
        for disk in disks {
            let (x, y) = (Px(disk.center.x), Px(disk.center.y));
            if look.hollow {
                let ring = Ring::of(disk.radius, layout.line);
                let (r, stroke) = (Px(ring.radius), Px(ring.width));
                let _ = writeln!(svg, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\" stroke-width=\"{stroke}\"/>");
            } else {
                let _ = writeln!(svg, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{}\"/>", Px(disk.radius));
            }
        }
        svg.push_str("</g>\n");
    }
    if layout.clipped {
        svg.push_str("</g>\n");
    }
    svg.push_str("</svg>\n");
    svg
}

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
