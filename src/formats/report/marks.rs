//! Classes against classes, and attributes against distance: small panels, three in a row.

use super::{Curve, GAP, MARGIN, Page, QUIET, Room, SIDES, Side, WIDTH, class_names, shortened};
use crate::analysis::{Comparison, MarkFunction, Scales};
use glam::DVec2;

const COLUMNS: usize = 3;
const HEIGHT: f64 = 140.0;
/// With more pairs of classes only those are drawn that the output is farthest from, relative to chance's distance.
const MOST_PAIRS: usize = 12;

/// What a panel shows.
struct Content<'a> {
    title: String,
    up: &'static str,
    chance: f64,
    /// For each side its curve, if it has one; gaps are cut into pieces.
    curves: Vec<Vec<(Vec<f64>, Vec<f64>)>>,
    /// What stands at the right of the title.
    note: String,
    least: [f64; 2],
    radius: &'a [f64],
}

impl Page {
    /// Pair correlations of the classes and mark correlations of the attributes; nothing where there are none.
    pub(super) fn marks(&mut self, sides: &[Side<'_>], scales: &Scales, comparison: Option<&Comparison>) {
        let mut contents = class_panels(sides, comparison);
        let all = contents.len();
        contents.truncate(MOST_PAIRS);
        let left_out = all - contents.len();
        contents.extend(attribute_panels(sides, comparison));
        if contents.is_empty() {
            return;
        }
        self.text(DVec2::new(MARGIN, self.y), "font-size=\"16\" font-weight=\"600\"", "Classes and attributes");
        let mut words = "Above the dotted line more than chance, below it less.".to_owned();
        if comparison.is_some() {
            words +=
                " ×: how many times nearer to the exemplar’s curve than with classes and values given out at random.";
        }
        if left_out > 0 {
            words += &format!(" {left_out} more pairs of classes are better than these.");
        }
        self.text(DVec2::new(MARGIN, self.y + 20.0), &format!("fill=\"{QUIET}\""), &words);
        self.y += 48.0;
        let width = (WIDTH - 2.0 * MARGIN - GAP * (COLUMNS - 1) as f64 * 0.6) / COLUMNS as f64;
        for row in contents.chunks(COLUMNS) {
            for (column, content) in row.iter().enumerate() {
                let room = Room { left: MARGIN + column as f64 * (width + 0.6 * GAP), width, height: HEIGHT };
                self.content(&room, content, scales);
            }
            self.y += HEIGHT + GAP + 22.0;
        }
        self.y += 8.0;
    }

    fn content(&mut self, room: &Room, content: &Content<'_>, scales: &Scales) {
        let d = scales.spacing;
        let mut range = content.least;
        for &value in content.curves.iter().flatten().flat_map(|(_, y)| y) {
            range = [range[0].min(1.06 * value), range[1].max(1.06 * value)];
        }
        let reach = content.radius.last().copied().unwrap_or(1.0) / d;
        let panel = self.panel_in(room, &content.title, "r / d", content.up, [0.0, reach], range, false);
        let end = DVec2::new(room.left + room.width, self.y);
        self.text(end, &format!("text-anchor=\"end\" font-size=\"12\" fill=\"{QUIET}\""), &content.note);
        self.level(&panel, content.chance);
        for (side, pieces) in content.curves.iter().enumerate() {
            let curves: Vec<Curve<'_>> =
                pieces.iter().map(|(x, y)| Curve::new(x, 1.0 / d, y, SIDES[side], side)).collect();
            self.curves(&panel, &curves);
        }
    }
}

/// The pieces of a curve between its gaps.
fn pieces(radius: &[f64], value: &[Option<f64>]) -> Vec<(Vec<f64>, Vec<f64>)> {
    let mut pieces = vec![(Vec::new(), Vec::new())];
    for (&r, value) in radius.iter().zip(value) {
        match (value, pieces.last_mut()) {
            (&Some(value), Some((x, y))) => {
                x.push(r);
                y.push(value);
            }
            _ => pieces.push((Vec::new(), Vec::new())),
        }
    }
    pieces.retain(|(x, _)| !x.is_empty());
    pieces
}

/// The pairs of classes, worst first where there are too many to draw.
fn class_panels<'a>(sides: &'a [Side<'_>], comparison: Option<&Comparison>) -> Vec<Content<'a>> {
    let names = class_names(sides);
    let name = |class: u16| shortened(names.get(usize::from(class)).map_or("?", String::as_str), 16);
    let mut pairs: Vec<(u16, u16)> = Vec::new();
    for one in sides.iter().flat_map(|side| &side.analysis.cross_correlations) {
        if !pairs.contains(&(one.a, one.b)) {
            pairs.push((one.a, one.b));
        }
    }
    let errors = comparison.and_then(|comparison| comparison.marks.as_ref()).map(|marks| &marks.class_pairs);
    let error = |pair| errors.and_then(|list| list.iter().find(|one| (one.a, one.b) == pair)).map(|one| one.error);
    if pairs.len() > MOST_PAIRS {
        let factor = |pair| error(pair).map_or(0.0, |error| error.factor());
        pairs.sort_by(|&a, &b| factor(a).total_cmp(&factor(b)));
    }
    pairs
        .into_iter()
        .map(|pair| {
            let of_side = |side: &'a Side<'_>| {
                side.analysis.cross_correlations.iter().find(|one| (one.a, one.b) == pair).map(|one| &one.correlation)
            };
            let curves: Vec<_> = sides
                .iter()
                .map(|side| of_side(side).map_or(Vec::new(), |one| vec![(one.radius.clone(), one.value.clone())]))
                .collect();
            Content {
                title: if pair.0 == pair.1 {
                    format!("{} among themselves", name(pair.0))
                } else {
                    format!("{} and {}", name(pair.0), name(pair.1))
                },
                up: "g(r)",
                chance: 1.0,
                radius: sides.iter().find_map(of_side).map_or(&[], |one| &one.radius),
                curves,
                note: error(pair).map_or(String::new(), |error| times(error.factor())),
                least: [0.0, 1.6],
            }
        })
        .collect()
}

fn attribute_panels<'a>(sides: &'a [Side<'_>], comparison: Option<&Comparison>) -> Vec<Content<'a>> {
    let mut names: Vec<&str> = Vec::new();
    for one in sides.iter().flat_map(|side| &side.analysis.mark_correlations) {
        if !names.contains(&one.name.as_str()) {
            names.push(&one.name);
        }
    }
    let errors = comparison.and_then(|comparison| comparison.marks.as_ref()).map(|marks| &marks.attributes);
    names
        .into_iter()
        .filter_map(|name| {
            let of_side = |side: &'a Side<'_>| {
                side.analysis.mark_correlations.iter().find(|one| one.name == name).map(|one| &one.correlation)
            };
            let first = sides.iter().find_map(of_side)?;
            let error = errors.and_then(|list| list.iter().find(|one| one.name == name)).map(|one| one.error);
            let curves =
                sides.iter().map(|side| of_side(side).map_or(Vec::new(), |one| pieces(&one.radius, &one.value)));
            let (up, least) = match first.function {
                MarkFunction::Product => ("k(r)", [0.5, 1.5]),
                MarkFunction::Direction => ("mean cosine", [-0.5, 1.0]),
            };
            Some(Content {
                title: format!("Mark correlation: {}", shortened(name, 14)),
                up,
                chance: first.independent,
                radius: &first.radius,
                curves: curves.collect(),
                note: error.map_or(String::new(), |error| times(error.factor())),
                least,
            })
        })
        .collect()
}

/// At most three digits: more would claim too much of a mean over a few assignments.
fn times(factor: f64) -> String {
    match factor {
        factor if factor >= 1000.0 => "× 1000 or more".to_owned(),
        factor if factor >= 10.0 => format!("× {factor:.0}"),
        factor => format!("× {factor:.1}"),
    }
}
