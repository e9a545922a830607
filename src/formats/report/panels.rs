//! Panels with axes, curves and histograms.

use std::fmt::Write as _;

use glam::DVec2;

use super::{CURVE_HEIGHT, GAP, GRID, MARGIN, Page, QUIET, WIDTH, listed};
use crate::formats::style::Color;
use crate::formats::svg::Px;

/// One line of a curve panel.
pub(super) struct Curve<'a> {
    pub(super) x: Vec<f64>,
    pub(super) y: &'a [f64],
    pub(super) color: Color,
    /// The exemplar lies below, broad; the output above, narrow: both are seen where they agree.
    pub(super) width: f64,
}

/// Where a panel stands, labels included but not the line of its title.
pub(super) struct Room {
    pub(super) left: f64,
    pub(super) width: f64,
    /// Of the curves.
    pub(super) height: f64,
}

/// A panel with axes.
pub(super) struct Panel {
    pub(super) min: DVec2,
    pub(super) size: DVec2,
    pub(super) x: [f64; 2],
    pub(super) y: [f64; 2],
    /// Whether y is drawn by its logarithm.
    pub(super) log: bool,
}

impl Page {
    /// Axes, grid and labels in the left (0) or right (1) half.
    #[expect(clippy::too_many_arguments, reason = "one call says all there is to say about a panel")]
    pub(super) fn panel(
        &mut self,
        column: usize,
        title: &str,
        across: &str,
        up: &str,
        x: [f64; 2],
        y: [f64; 2],
        log: bool,
    ) -> Panel {
        let width = (WIDTH - 2.0 * MARGIN - GAP) / 2.0;
        let room = Room { left: MARGIN + column as f64 * (width + GAP), width, height: CURVE_HEIGHT };
        self.panel_in(&room, title, across, up, x, y, log)
    }

    /// Axes, grid and labels anywhere.
    #[expect(clippy::too_many_arguments, reason = "one call says all there is to say about a panel")]
    pub(super) fn panel_in(
        &mut self,
        room: &Room,
        title: &str,
        across: &str,
        up: &str,
        x: [f64; 2],
        y: [f64; 2],
        log: bool,
    ) -> Panel {
        let labels = 54.0;
        let min = DVec2::new(room.left + labels, self.y + 16.0);
        let panel = Panel { min, size: DVec2::new(room.width - labels, room.height), x, y, log };
        let size = if room.height < CURVE_HEIGHT { 14 } else { 16 };
        self.text(DVec2::new(room.left, self.y), &format!("font-size=\"{size}\" font-weight=\"600\""), title);
        let (right, bottom) = (min.x + panel.size.x, min.y + panel.size.y);
        let quiet = format!("font-size=\"12\" fill=\"{QUIET}\"");
        for (value, label) in ticks(panel.x, false) {
            let at = panel.place(value, panel.y[0]);
            self.line(DVec2::new(at.x, min.y), DVec2::new(at.x, bottom), &format!("stroke=\"{GRID}\""));
            self.text(DVec2::new(at.x, bottom + 17.0), &format!("text-anchor=\"middle\" {quiet}"), &label);
        }
        for (value, label) in ticks(panel.y, log) {
            let at = panel.place(panel.x[0], value);
            self.line(at, DVec2::new(right, at.y), &format!("stroke=\"{GRID}\""));
            self.text(DVec2::new(min.x - 8.0, at.y + 4.0), &format!("text-anchor=\"end\" {quiet}"), &label);
        }
        self.line(DVec2::new(min.x, bottom), DVec2::new(right, bottom), "stroke=\"#9aa5b1\"");
        self.line(min, DVec2::new(min.x, bottom), "stroke=\"#9aa5b1\"");
        self.text(
            DVec2::new(min.x + panel.size.x / 2.0, bottom + 36.0),
            &format!("text-anchor=\"middle\" {quiet}"),
            across,
        );
        let (x, y) = (min.x - labels + 10.0, min.y + panel.size.y / 2.0);
        let turned = format!("text-anchor=\"middle\" transform=\"rotate(-90 {} {})\" {quiet}", Px(x), Px(y));
        self.text(DVec2::new(x, y), &turned, up);
        panel
    }

    /// The line of chance.
    pub(super) fn level(&mut self, panel: &Panel, value: f64) {
        let from = panel.place(panel.x[0], value);
        let to = panel.place(panel.x[1], value);
        self.line(from, to, &format!("stroke=\"{QUIET}\" stroke-dasharray=\"2 4\""));
    }

    pub(super) fn curves(&mut self, panel: &Panel, curves: &[Curve<'_>]) {
        for curve in curves {
            let inside = curve.x.iter().zip(curve.y).filter(|&(&x, _)| x <= panel.x[1] * (1.0 + 1e-9));
            let places: Vec<DVec2> = inside.map(|(&x, &y)| panel.place(x, y)).collect();
            let _ = writeln!(
                self.svg,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"{}/>",
                listed(&places),
                curve.color.hex(),
                curve.width,
                if curve.width > 3.0 { " stroke-opacity=\"0.55\"" } else { "" }
            );
        }
    }

    pub(super) fn histogram(&mut self, panel: &Panel, shares: &[f64], width: f64, color: Color, layer: usize) {
        let mut places = vec![panel.place(0.0, 0.0)];
        for (i, share) in shares.iter().enumerate() {
            places.push(panel.place(i as f64 * width, 100.0 * share));
            places.push(panel.place((i + 1) as f64 * width, 100.0 * share));
        }
        places.push(panel.place(shares.len() as f64 * width, 0.0));
        // The first is filled, the second an outline over it.
        let (fill, line) = if layer == 0 { ("0.3", 1.0) } else { ("0", 2.0) };
        let color = color.hex();
        let _ = writeln!(
            self.svg,
            "<polygon points=\"{}\" fill=\"{color}\" fill-opacity=\"{fill}\" stroke=\"{color}\" \
             stroke-width=\"{line}\" stroke-linejoin=\"round\"/>",
            listed(&places)
        );
    }
}

impl<'a> Curve<'a> {
    pub(super) fn new(x: &[f64], unit: f64, y: &'a [f64], color: Color, layer: usize) -> Self {
        Self { x: x.iter().map(|x| x * unit).collect(), y, color, width: if layer == 0 { 4.5 } else { 2.0 } }
    }
}

impl Panel {
    /// Where a value stands; those beyond the range stand on its end.
    pub(super) fn place(&self, x: f64, y: f64) -> DVec2 {
        let share = |value: f64, [from, to]: [f64; 2]| ((value - from) / (to - from)).clamp(0.0, 1.0);
        let up = if self.log { share(libm::log10(y.max(1e-300)), self.y.map(libm::log10)) } else { share(y, self.y) };
        self.min + DVec2::new(share(x, self.x), 1.0 - up) * self.size
    }
}

/// Round numbers within a range, and their labels.
fn ticks([from, to]: [f64; 2], log: bool) -> Vec<(f64, String)> {
    if log {
        let first = libm::ceil(libm::log10(from) - 1e-9) as i32;
        let last = libm::floor(libm::log10(to) + 1e-9) as i32;
        return (first..=last)
            .map(|power| {
                let value = libm::pow(10.0, f64::from(power));
                (value, format!("{value}"))
            })
            .collect();
    }
    let rough = ((to - from) / 5.0).max(1e-300);
    let magnitude = libm::pow(10.0, libm::floor(libm::log10(rough)));
    let step = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * magnitude).into_iter().find(|&step| step >= rough * 0.999);
    let step = step.unwrap_or(rough);
    let decimals = (-libm::floor(libm::log10(step) + 1e-9)).max(0.0) as usize;
    let first = libm::ceil(from / step - 1e-9) as i64;
    let last = libm::floor(to / step + 1e-9) as i64;
    (first..=last)
        .map(|i| {
            let label = format!("{:.decimals$}", i as f64 * step);
            // A minus as wide as the digits.
            (i as f64 * step, label.replace('-', "−"))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let labels = |range, log| ticks(range, log).into_iter().map(|(_, label)| label).collect::<Vec<_>>();
        assert_eq!(labels([0.0, 2.5], false), ["0.0", "0.5", "1.0", "1.5", "2.0", "2.5"]);
        assert_eq!(labels([-0.3, 0.11], false), ["−0.3", "−0.2", "−0.1", "0.0", "0.1"]);
        assert_eq!(labels([0.01, 13.0], true), ["0.01", "0.1", "1", "10"]);
    }
}
