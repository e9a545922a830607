//! An analysis as a picture: patterns, curves, maps and words on one SVG page.

mod maps;
mod marks;
mod panels;

use std::fmt::Write as _;

use glam::DVec2;
use thiserror::Error;

use self::panels::{Curve, Room};

use super::PngError;
use super::style::{self, Color, Layout, Look, Mark, PALETTE, Painted, RADIUS_ATTRIBUTE};
use super::svg::{Px, escape, write_marks};
use crate::analysis::{
    Analysis, AnalysisError, Cloud, Comparison, SIMULATIONS, Scales, common_classes, describe, exemplar_unit,
    pair_correlation, verdict,
};
use crate::pattern::{Boundary, PointPattern};

/// Why a report could not be drawn.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReportError {
    /// A map could not be worked out.
    #[error(transparent)]
    Analysis(#[from] AnalysisError),
    /// A map could not be encoded.
    #[error(transparent)]
    Png(#[from] PngError),
}

const WIDTH: f64 = 1200.0;
const MARGIN: f64 = 44.0;
const GAP: f64 = 56.0;
/// Height of a panel with a curve, axes and labels not counted.
const CURVE_HEIGHT: f64 = 210.0;
/// Side of a map.
const MAP: f64 = 236.0;
/// Patterns share this much room.
const PATTERNS: DVec2 = DVec2::new(740.0, 420.0);

/// The drawn pair correlation's kernel is this many times narrower than Öztireli & Gross's.
const SHARPER: f64 = 3.0;

const INK: &str = "#1f2933";
const QUIET: &str = "#5c6873";
const GRID: &str = "#e4e8ec";
const CHANCE: &str = "#d7dce1";
/// The exemplar is blue, the output vermilion: the two of Okabe and Ito's palette that differ most for everyone.
const SIDES: [Color; 2] = [PALETTE[0], PALETTE[1]];

/// Colours of a map, from nothing to much: lightness alone tells the order.
const RAMP: [[f64; 3]; 5] =
    [[255.0, 255.0, 255.0], [198.0, 221.0, 240.0], [86.0, 160.0, 209.0], [0.0, 84.0, 140.0], [4.0, 22.0, 48.0]];

/// The report on one pattern. `name` is what a person calls it; `analysis` is [`Analysis::of_pattern`]'s.
///
/// # Errors
/// When the pattern has no two points in different places, or a picture can't be encoded.
pub fn write_report(pattern: &PointPattern, analysis: &Analysis, name: &str) -> Result<String, ReportError> {
    let cloud = match &analysis.part {
        Some(part) => Cloud::of(pattern).within(part.window()?)?,
        None => Cloud::of(pattern),
    };
    let scales = Scales::of(&cloud)?;
    let side = Side { pattern, cloud, analysis, name, color: SIDES[0], role: "pattern" };
    Page::draw(&[side], &scales, &format!("Point pattern: {name}"), &describe(analysis), None)
}

/// The report on an output and its exemplar. `names` are what a person calls them.
///
/// # Errors
/// When a picture can't be encoded.
pub fn write_comparison_report(
    exemplar: &PointPattern,
    output: &PointPattern,
    comparison: &Comparison,
    names: [&str; 2],
) -> Result<String, ReportError> {
    let (a, b) = common_classes(exemplar, output, exemplar_unit(exemplar))?;
    let sides = [
        Side {
            pattern: exemplar,
            cloud: a,
            analysis: &comparison.exemplar,
            name: names[0],
            color: SIDES[0],
            role: "exemplar",
        },
        Side {
            pattern: output,
            cloud: b,
            analysis: &comparison.output,
            name: names[1],
            color: SIDES[1],
            role: "output",
        },
    ];
    let title = format!("{} against its exemplar {}", names[1], names[0]);
    Page::draw(&sides, &comparison.scales, &title, &verdict(comparison), Some(comparison))
}

/// One of the patterns of a page.
struct Side<'a> {
    pattern: &'a PointPattern,
    cloud: Cloud,
    analysis: &'a Analysis,
    name: &'a str,
    color: Color,
    role: &'static str,
}

/// The names of all classes, numbered as in [`common_classes`]; none when every pattern has but one.
fn class_names(sides: &[Side<'_>]) -> Vec<String> {
    if sides.iter().all(|side| side.pattern.class_names().len() == 1) {
        return Vec::new();
    }
    let mut names: Vec<String> = Vec::new();
    for name in sides.iter().flat_map(|side| side.pattern.class_names()) {
        if !names.contains(name) {
            names.push(name.clone());
        }
    }
    names
}

fn has_radius(pattern: &PointPattern) -> bool {
    pattern.attributes().iter().any(|attribute| attribute.name == RADIUS_ATTRIBUTE)
}

/// The page as it grows, downwards.
struct Page {
    svg: String,
    y: f64,
}

impl Page {
    fn draw(
        sides: &[Side<'_>],
        scales: &Scales,
        title: &str,
        words: &str,
        comparison: Option<&Comparison>,
    ) -> Result<String, ReportError> {
        let mut page = Self { svg: String::with_capacity(200_000), y: MARGIN };
        page.header(title, words);
        page.patterns(sides, comparison);
        page.correlation_and_nearest(sides, scales)?;
        page.spectrum_and_ripley(sides, scales);
        page.marks(sides, scales, comparison);
        page.maps(sides, scales)?;
        page.footer(scales, sides, comparison);

        let height = Px(page.y + MARGIN - 20.0);
        let mut svg = String::with_capacity(page.svg.len() + 600);
        let _ = writeln!(
            svg,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height}\" viewBox=\"0 0 {WIDTH} \
             {height}\" role=\"img\" font-family=\"system-ui, 'Segoe UI', 'Noto Sans', 'DejaVu Sans', sans-serif\" \
             font-size=\"13\" fill=\"{INK}\">\n<title>{}</title>\n<desc>{}</desc>\n<rect width=\"{WIDTH}\" \
             height=\"{height}\" fill=\"#ffffff\"/>",
            escape(title),
            escape(words)
        );
        svg.push_str(&page.svg);
        svg.push_str("</svg>\n");
        Ok(svg)
    }

    /// Text with further attributes, `attributes` as they stand in the element.
    fn text(&mut self, at: DVec2, attributes: &str, words: &str) {
        let _ = writeln!(self.svg, "<text x=\"{}\" y=\"{}\" {attributes}>{}</text>", Px(at.x), Px(at.y), escape(words));
    }

    fn line(&mut self, from: DVec2, to: DVec2, attributes: &str) {
        let _ = writeln!(
            self.svg,
            "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" {attributes}/>",
            Px(from.x),
            Px(from.y),
            Px(to.x),
            Px(to.y)
        );
    }

    fn rectangle(&mut self, min: DVec2, size: DVec2, attributes: &str) {
        let _ = writeln!(
            self.svg,
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" {attributes}/>",
            Px(min.x),
            Px(min.y),
            Px(size.x.max(0.0)),
            Px(size.y.max(0.0))
        );
    }

    fn header(&mut self, title: &str, words: &str) {
        self.y += 14.0;
        let title: String = shortened(title, 90);
        self.text(DVec2::new(MARGIN, self.y), "font-size=\"25\" font-weight=\"650\"", &title);
        self.y += 12.0;
        for line in wrapped(words, 140) {
            self.y += 21.0;
            self.text(DVec2::new(MARGIN, self.y), &format!("font-size=\"15\" fill=\"{QUIET}\""), &line);
        }
        self.y += 34.0;
    }

    /// The patterns at one scale, and the numbers beside them.
    fn patterns(&mut self, sides: &[Side<'_>], comparison: Option<&Comparison>) {
        let top = self.y;
        let sizes: Vec<DVec2> = sides.iter().map(|side| side.cloud.size()).collect();
        let gaps = GAP * 0.5 * (sizes.len() - 1) as f64;
        let (sum, most) =
            sizes.iter().fold((DVec2::ZERO, DVec2::ZERO), |(sum, most), &size| (sum + size, most.max(size)));
        // Above a pattern stands its name.
        let head = 30.0;
        let beside = ((PATTERNS.x - gaps) / sum.x).min(PATTERNS.y / most.y);
        let below = (PATTERNS.x / most.x).min((PATTERNS.y - gaps - head * (sizes.len() - 1) as f64) / sum.y);
        // Wide ones stand below one another.
        let (scale, stacked) = if below > 1.1 * beside { (below, true) } else { (beside, false) };
        let look = Look { margin: 0.0, ..Look::default() };
        let classes = class_names(sides);
        let mut at = DVec2::new(MARGIN, top);
        let mut bottom = top;
        for (side, size) in sides.iter().zip(&sizes) {
            let caption = format!("{} · {} points", side.name, side.cloud.len());
            let size = *size * scale;
            let widest = ((size.x.max(170.0) + 0.4 * GAP) / 7.0) as usize;
            self.dot(at + DVec2::new(5.0, -4.5), 5.0, side.color);
            self.text(at + DVec2::new(16.0, 0.0), "font-weight=\"600\"", &capitalised(side.role));
            self.text(at + DVec2::new(0.0, 18.0), &format!("fill=\"{QUIET}\""), &shortened(&caption, widest));
            self.pattern(side, &classes, at + DVec2::new(0.0, head), size, &look);
            bottom = f64::max(bottom, at.y + head + size.y);
            if stacked {
                at.y = bottom + 0.5 * GAP;
            } else {
                at.x += size.x.max(170.0) + 0.5 * GAP;
            }
        }
        self.y = bottom;
        let numbers = self.numbers(sides, comparison, DVec2::new(MARGIN + PATTERNS.x + 40.0, top));
        self.y = self.y.max(numbers) + GAP;
    }

    fn pattern(&mut self, side: &Side<'_>, classes: &[String], min: DVec2, size: DVec2, look: &Look) {
        let mut layout = style::lay_out(side.pattern, min, size, look);
        let id = format!("tile-{}", side.role);
        if layout.clipped {
            let _ = write!(self.svg, "<clipPath id=\"{id}\">");
            self.rectangle(layout.min, layout.size, "");
            let _ = writeln!(self.svg, "</clipPath>\n<g clip-path=\"url(#{id})\">");
        }
        // On both sides a class looks the same; a single one has the colour of its side.
        let common = style::class_styles(classes, has_radius(side.pattern));
        for painted in &mut layout.classes {
            match classes.iter().position(|name| *name == painted.name) {
                Some(number) => {
                    painted.color = PALETTE[common[number].color];
                    painted.glyph = common[number].glyph.clone();
                }
                None => painted.color = side.color,
            }
        }
        write_marks(&mut self.svg, &layout, &format!("glyph-{}", side.role));
        if layout.clipped {
            self.svg.push_str("</g>\n");
        }
        // A tile's border is dashed: it is not an end.
        let dashes = if layout.clipped { " stroke-dasharray=\"5 4\"" } else { "" };
        self.rectangle(layout.min, layout.size, &format!("fill=\"none\" stroke=\"#9aa5b1\"{dashes}"));
    }

    fn dot(&mut self, center: DVec2, radius: f64, color: Color) {
        let (x, y, color) = (Px(center.x), Px(center.y), color.hex());
        let _ = writeln!(self.svg, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{}\" fill=\"{color}\"/>", Px(radius));
    }

    /// The glyph of a class beside its name.
    fn key(&mut self, center: DVec2, class: Painted, number: usize) {
        let mark = Mark { center, radius: 4.5, turn: 0.0, class: 0 };
        let (min, size) = (DVec2::ZERO, DVec2::ONE);
        let (marks, classes) = (vec![mark], vec![class]);
        let layout = Layout { min, size, marks, classes, clipped: false, halo: None, line: 1.0 };
        write_marks(&mut self.svg, &layout, &format!("key-{number}"));
    }

    /// A column of numbers; returns where it ends.
    fn numbers(&mut self, sides: &[Side<'_>], comparison: Option<&Comparison>, at: DVec2) -> f64 {
        let right = WIDTH - MARGIN;
        let mut y = at.y;
        if let Some(comparison) = comparison {
            let quality = &comparison.quality;
            self.text(DVec2::new(at.x, y), "font-weight=\"600\"", "Quality (0 chance, 1 the exemplar tiled)");
            y += 10.0;
            let rows = [
                ("all", quality.score),
                ("arrangement", quality.pair_density),
                ("detail", quality.precision),
                ("variety", quality.coverage),
            ];
            for (row, (name, score)) in rows.into_iter().enumerate() {
                let (bar, full) = (at.x + 92.0, right - at.x - 92.0 - 46.0);
                let weight = if row == 0 { "font-weight=\"650\"" } else { "" };
                self.text(DVec2::new(at.x, y + 14.0), weight, name);
                self.rectangle(DVec2::new(bar, y + 4.0), DVec2::new(full, 12.0), "fill=\"#eef1f4\" rx=\"3\"");
                let filled = DVec2::new(full * score.clamp(0.0, 1.0), 12.0);
                self.rectangle(
                    DVec2::new(bar, y + 4.0),
                    filled,
                    &format!("fill=\"{}\" rx=\"3\"", if row == 0 { SIDES[1].hex() } else { "#eba366".to_owned() }),
                );
                let end = DVec2::new(right, y + 14.0);
                self.text(end, &format!("text-anchor=\"end\" {weight}"), &format!("{score:.2}"));
                y += 23.0;
            }
            y += 24.0;
        }

        let columns: Vec<f64> = (0..sides.len()).rev().map(|back| right - 84.0 * back as f64).collect();
        for (side, &x) in sides.iter().zip(&columns) {
            let color = format!("text-anchor=\"end\" font-weight=\"600\" fill=\"{}\"", side.color.hex());
            self.text(DVec2::new(x, y), &color, side.role);
        }
        let spacing = sides[0].analysis.spacing.unwrap_or(1.0);
        type Row = (&'static str, fn(&Analysis, f64) -> String);
        let rows: [Row; 8] = [
            ("points", |one, _| one.points.to_string()),
            ("density (per unit²)", |one, _| format!("{:.1}", one.density)),
            ("mean spacing (units)", |one, _| one.spacing.map_or("–".to_owned(), |d| format!("{d:.4}"))),
            ("Clark–Evans index", |one, _| one.aggregation_index.map_or("–".to_owned(), |r| format!("{r:.3}"))),
            ("relative radius ρ", |one, _| format!("{:.3}", one.relative_radius)),
            ("spread of spacing", |one, _| {
                let spread = one.nearest.first().map_or(0.0, |first| first.standard_deviation / first.mean.max(1e-300));
                format!("{:.0} %", 100.0 * spread)
            }),
            ("largest hole (radius / d)", |one, d| format!("{:.2}", one.largest_empty_circle.radius / d)),
            ("too many on the border", |one, _| match one.border {
                Some(border) => format!("{:+.1} %", 100.0 * border.excess),
                None => "no border".to_owned(),
            }),
        ];
        for (name, value) in rows {
            y += 22.0;
            self.text(DVec2::new(at.x, y), &format!("fill=\"{QUIET}\""), name);
            for (side, &x) in sides.iter().zip(&columns) {
                self.text(DVec2::new(x, y), "text-anchor=\"end\"", &value(side.analysis, spacing));
            }
            let rule = format!("stroke=\"{GRID}\"");
            self.line(DVec2::new(at.x, y + 6.5), DVec2::new(right, y + 6.5), &rule);
        }
        if let Some(comparison) = comparison {
            let mut single = |name: &str, value: String| {
                y += 22.0;
                self.text(DVec2::new(at.x, y), &format!("fill=\"{QUIET}\""), name);
                self.text(DVec2::new(right, y), "text-anchor=\"end\"", &value);
                self.line(DVec2::new(at.x, y + 6.5), DVec2::new(right, y + 6.5), &format!("stroke=\"{GRID}\""));
            };
            single("stacked points", format!("{:.1} %", 100.0 * comparison.defects.stacked));
            single("error of pair correlation (MSE)", format!("{:.4}", comparison.pair_correlation_error));
            if let Some(patches) = &comparison.patches {
                single("Chamfer distance (by patches)", format!("{:.4}", patches.chamfer));
                if let Some(distance) = patches.wasserstein {
                    single("Wasserstein distance (by patches)", format!("{distance:.3}"));
                }
            }
        }
        let names = class_names(sides);
        let styles = style::class_styles(&names, has_radius(sides[0].pattern));
        for (number, (name, style)) in names.iter().zip(styles).enumerate() {
            y += 22.0;
            let class = Painted { name: name.clone(), color: PALETTE[style.color], glyph: style.glyph };
            self.key(DVec2::new(at.x + 5.0, y - 4.5), class, number);
            self.text(DVec2::new(at.x + 17.0, y), &format!("fill=\"{QUIET}\""), &shortened(name, 16));
            for (side, &x) in sides.iter().zip(&columns) {
                let count = side.analysis.class_sizes.get(number).copied().unwrap_or(0);
                self.text(DVec2::new(x, y), "text-anchor=\"end\"", &count.to_string());
            }
            self.line(DVec2::new(at.x, y + 6.5), DVec2::new(right, y + 6.5), &format!("stroke=\"{GRID}\""));
        }
        y + 10.0
    }

    fn correlation_and_nearest(&mut self, sides: &[Side<'_>], scales: &Scales) -> Result<(), ReportError> {
        let d = scales.spacing;
        // Sharper than the kernel that errors are measured with: here noise is seen for what it is.
        let settings = scales.pair_correlation.with_sigma(scales.pair_correlation.sigma / SHARPER);
        let correlations =
            sides.iter().map(|side| pair_correlation(&side.cloud, &settings)).collect::<Result<Vec<_>, _>>()?;
        let curves: Vec<Curve<'_>> = sides
            .iter()
            .zip(&correlations)
            .enumerate()
            .map(|(i, (side, one))| Curve::new(&one.radius, 1.0 / d, &one.value, side.color, i))
            .collect();
        let top = curves.iter().flat_map(|curve| curve.y).fold(1.6_f64, |most, &y| most.max(y));
        let left = self.panel(
            0,
            "Pair correlation",
            &format!("distance r / mean spacing d (smoothed by {:.2} d)", settings.sigma / d),
            "g(r), 1 is chance",
            [0.0, scales.pair_correlation.range / d],
            [0.0, top * 1.06],
            false,
        );
        self.level(&left, 1.0);
        self.curves(&left, &curves);

        let width = scales.histogram_width / d;
        let reach = width * scales.histogram_count as f64;
        let histograms: Vec<&[f64]> = sides.iter().map(|side| &*side.analysis.nearest_histogram.shares).collect();
        let most = histograms.iter().flat_map(|shares| shares.iter()).fold(0.02_f64, |most, &share| most.max(share));
        let right = self.panel(
            1,
            "Distance to the nearest neighbour",
            if sides.len() > 1 { "distance / mean spacing d of the exemplar" } else { "distance / mean spacing d" },
            "% of points",
            [0.0, reach],
            [0.0, 106.0 * most],
            false,
        );
        for (i, (shares, side)) in histograms.iter().zip(sides).enumerate() {
            self.histogram(&right, shares, width, side.color, i);
        }
        self.y += CURVE_HEIGHT + GAP + 34.0;
        Ok(())
    }

    fn spectrum_and_ripley(&mut self, sides: &[Side<'_>], scales: &Scales) {
        let d = scales.spacing;
        let curves: Vec<Curve<'_>> = sides
            .iter()
            .enumerate()
            .map(|(i, side)| {
                let one = &side.analysis.spectrum;
                Curve::new(&one.frequency, d, &one.power, side.color, i)
            })
            .collect();
        let top = curves.iter().flat_map(|curve| curve.y).fold(3.0_f64, |most, &y| most.max(y));
        let left = self.panel(
            0,
            "Radial periodogram",
            "frequency × mean spacing d",
            "power, 1 is chance",
            [0.0, scales.max_frequency * d],
            [0.01, top * 1.3],
            true,
        );
        self.level(&left, 1.0);
        self.curves(&left, &curves);

        let scaled: Vec<Vec<f64>> =
            sides.iter().map(|side| side.analysis.ripley.l_minus_r.iter().map(|value| value / d).collect()).collect();
        let mut range = [-0.1_f64, 0.1];
        let envelopes = sides.iter().filter_map(|side| side.analysis.envelope.as_ref());
        for value in scaled
            .iter()
            .flatten()
            .copied()
            .chain(envelopes.flat_map(|envelope| envelope.low.iter().chain(&envelope.high)).map(|value| value / d))
        {
            range = [range[0].min(1.06 * value), range[1].max(1.06 * value)];
        }
        let right = self.panel(
            1,
            &format!("Ripley’s L, bands: {SIMULATIONS} patterns of chance"),
            "distance r / mean spacing d",
            "(L(r) − r) / d, 0 is chance",
            [0.0, scales.ripley.range / d],
            range,
            false,
        );
        for side in sides.iter().rev() {
            if let Some(envelope) = &side.analysis.envelope {
                let there = side.analysis.ripley.radius.iter().zip(&envelope.high);
                let back = side.analysis.ripley.radius.iter().zip(&envelope.low).rev();
                let places: Vec<DVec2> = there.chain(back).map(|(r, l)| right.place(r / d, l / d)).collect();
                let color = side.color.hex();
                let _ = writeln!(
                    self.svg,
                    "<polygon points=\"{}\" fill=\"{color}\" fill-opacity=\"0.13\"/>",
                    listed(&places)
                );
            }
        }
        self.level(&right, 0.0);
        let curves: Vec<Curve<'_>> = sides
            .iter()
            .zip(&scaled)
            .enumerate()
            .map(|(i, (side, y))| Curve::new(&side.analysis.ripley.radius, 1.0 / d, y, side.color, i))
            .collect();
        self.curves(&right, &curves);
        self.y += CURVE_HEIGHT + GAP + 34.0;
    }

    fn footer(&mut self, scales: &Scales, sides: &[Side<'_>], comparison: Option<&Comparison>) {
        let unit = comparison.map_or_else(|| exemplar_unit(sides[0].pattern), |comparison| comparison.unit);
        let owner = if comparison.is_some() { "the exemplar’s" } else { "the" };
        let borders: Vec<String> = sides
            .iter()
            .map(|side| match side.cloud.boundary() {
                Boundary::Open => format!("{} is a window (open border)", side.role),
                Boundary::Periodic => format!("{} is a tile (periodic)", side.role),
            })
            .collect();
        let words = format!(
            "One unit is {owner} longer side, {unit} in the files’ own unit; d = {:.4} units. The {}. y points down. \
             Pointweave {}.",
            scales.spacing,
            borders.join(", the "),
            env!("CARGO_PKG_VERSION")
        );
        for line in wrapped(&words, 170) {
            self.text(DVec2::new(MARGIN, self.y), &format!("font-size=\"12\" fill=\"{QUIET}\""), &line);
            self.y += 17.0;
        }
    }
}

fn listed(places: &[DVec2]) -> String {
    let mut list = String::with_capacity(places.len() * 14);
    for place in places {
        let _ = write!(list, "{},{} ", Px((place.x * 100.0).round() / 100.0), Px((place.y * 100.0).round() / 100.0));
    }
    list.truncate(list.trim_end().len());
    list
}

/// Lines of at most `width` characters, broken between words.
fn wrapped(words: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in words.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.is_empty() => line.push_str(word),
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// At most `width` characters.
fn shortened(words: &str, width: usize) -> String {
    if words.chars().count() <= width {
        return words.to_owned();
    }
    words.chars().take(width.saturating_sub(1)).chain(['…']).collect()
}

fn capitalised(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
