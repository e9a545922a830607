//! Patterns, curves and descriptions as the page gets them.

use glam::DVec2;

use super::device::cpu;
use crate::analysis::{Curves, Periodogram};
use crate::formats::{Glyph, style};
use crate::gallery;
use crate::methods::Method;
use crate::pattern::{PatternError, PointPattern};
use crate::run::{Canvas, Choice, Description, Kind, Parameter, Place};
use crate::web::protocol::{
    ClassLookView, CurvesView, GalleryEntryView, GlyphView, KindView, LossView, MethodView, OptionView, ParameterView,
    PatternView, PlaceView, Points, PresetView, Response, SpectrumView,
};

pub(super) fn describe() -> Response {
    let methods = Method::ALL.iter().map(|method| method_view(method.definition().describe())).collect();
    let view = |glyph: &Glyph| GlyphView { name: glyph.name().to_owned(), outline: glyph.path_data() };
    let glyphs = Glyph::all().iter().map(view).collect();
    Response::Description { version: env!("CARGO_PKG_VERSION").to_owned(), engine: cpu(), methods, glyphs }
}

/// A method in its own words.
fn method_view(description: Description) -> MethodView {
    MethodView {
        name: description.name.to_owned(),
        title: description.title.to_owned(),
        meaning: description.meaning.to_owned(),
        presets: description
            .presets
            .into_iter()
            .map(|preset| PresetView {
                name: preset.name.to_owned(),
                title: preset.title.to_owned(),
                meaning: preset.meaning.to_owned(),
                parameters: preset.parameters,
            })
            .collect(),
        parameters: description.parameters.iter().map(parameter_view).collect(),
        tools: description.tools.to_vec(),
        losses: description
            .losses
            .iter()
            .map(|loss| LossView { name: loss.name.to_owned(), title: loss.title.to_owned() })
            .collect(),
    }
}

fn parameter_view(parameter: &Parameter) -> ParameterView {
    ParameterView {
        name: parameter.name.to_owned(),
        title: parameter.title.to_owned(),
        meaning: parameter.meaning.to_owned(),
        place: match parameter.place {
            Place::Main => PlaceView::Main,
            Place::Advanced => PlaceView::Advanced,
        },
        group: parameter.group.to_owned(),
        kind: match parameter.kind {
            Kind::Number { min, max, whole } => KindView::Number { min, max, whole },
            Kind::Choice(choices) => {
                let option = |choice: &Choice| OptionView {
                    name: choice.name.to_owned(),
                    title: choice.title.to_owned(),
                    meaning: choice.meaning.to_owned(),
                };
                KindView::Choice { options: choices.iter().map(option).collect() }
            }
        },
    }
}

pub(super) fn list_gallery() -> Response {
    let entries = gallery::entries()
        .iter()
        .map(|entry| GalleryEntryView {
            name: entry.name.to_owned(),
            title: entry.title.to_owned(),
            caption: entry.caption.to_owned(),
            pattern: view(&entry.exemplar()),
        })
        .collect();
    Response::Gallery { entries }
}

pub(super) fn view(pattern: &PointPattern) -> PatternView {
    view_beside(pattern, pattern)
}

/// An output is measured in its exemplar's unit, not in its own.
pub(super) fn view_beside(pattern: &PointPattern, exemplar: &PointPattern) -> PatternView {
    let domain = pattern.domain();
    let (unit, own_unit) = (exemplar.domain().exemplar_unit(), domain.exemplar_unit());
    let points = points(pattern, exemplar);
    let styles = style::class_styles(pattern.class_names(), !points.radii.is_empty());
    let looks = styles.iter().map(|style| ClassLookView { glyph: style.glyph.name().to_owned(), color: style.color });
    PatternView {
        points,
        looks: looks.collect(),
        class_names: pattern.class_names().to_vec(),
        size: (domain.size() / unit).into(),
        min: domain.min().into(),
        unit,
        boundary: pattern.boundary(),
        spacing: pattern.mean_spacing().map(|spacing| spacing * own_unit / unit),
    }
}

/// A periodogram as the page draws it; lengths are in mean spacings of the exemplar, `unit`.
pub(super) fn spectrum(curves: &Curves, unit: f64) -> SpectrumView {
    let Periodogram { step, size: [width, height], power } = &curves.periodogram;
    SpectrumView {
        width: *width,
        height: *height,
        power: narrow(power, 1.0),
        reach: [step[0] * (width / 2) as f64 * unit, step[1] * (height / 2) as f64 * unit],
    }
}

/// What the page draws of one side, in mean spacings of the exemplar, `unit`.
pub(super) fn curves(curves: &Curves, unit: f64) -> CurvesView {
    CurvesView {
        pair_correlation: narrow(&curves.pair_correlation.value, 1.0),
        nearest: narrow(&curves.nearest_histogram.shares, 1.0),
        spacing: curves.nearest.map_or(0.0, |nearest| nearest.mean) / unit,
        frequency: narrow(&curves.spectrum.frequency, unit),
        power: narrow(&curves.spectrum.power, 1.0),
        relative_radius: curves.relative_radius,
    }
}

pub(super) fn narrow(values: &[f64], factor: f64) -> Vec<f32> {
    values.iter().map(|value| (value * factor) as f32).collect()
}

fn points(pattern: &PointPattern, exemplar: &PointPattern) -> Points {
    let (min, unit) = (pattern.domain().min(), exemplar.domain().exemplar_unit());
    let positions = pattern.positions().iter().flat_map(|&point| ((point - min) / unit).as_vec2().to_array()).collect();
    let look = style::attribute_look(pattern, exemplar);
    let narrow = |values: Vec<f64>| narrow(&values, 1.0);
    Points {
        ids: (0..pattern.len() as u32).collect(),
        positions,
        classes: pattern.classes().to_vec(),
        radii: narrow(look.radii),
        scales: narrow(look.scales),
        turns: narrow(look.turns),
        depths: narrow(look.depths),
        pinned: Vec::new(),
    }
}

/// The points of a run as they stand, with their ids.
pub(super) fn output_points(canvas: &Canvas) -> Result<Points, PatternError> {
    let listed = canvas.listed();
    let ids = listed.iter().map(|&point| canvas.ids()[point]).collect();
    let pinned = listed.into_iter().filter(|&point| canvas.pinned()[point]).map(|point| canvas.ids()[point]).collect();
    Ok(Points { ids, pinned, ..points(&canvas.pattern()?, canvas.exemplar()) })
}

/// Numbers as places.
pub(super) fn pairs(numbers: &[f64]) -> Vec<DVec2> {
    numbers.chunks_exact(2).map(DVec2::from_slice).collect()
}
