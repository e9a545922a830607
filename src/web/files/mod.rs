//! Files, pictures and links: what the page's second module does. No browser in sight, so that it is tested natively.
//!
//! Every request is answered by itself; nothing is kept in between. Positions are [`PatternData`]'s: exact, in the
//! pattern's own unit.

use serde_json::{Map, Value};
use thiserror::Error;

mod protocol;
#[cfg(test)]
mod tests;

use super::pattern_data::PatternData;
use super::protocol::Place;
use crate::formats::link::{Link, LinkError, LinkExemplar, Written, read_link, write_link};
use crate::formats::style::{Look, Palette};
use crate::formats::{
    self, BlobOptions, FormatError, Glyph, GlyphError, Ink, Origin, Picture, Preview, Project, ReadOptions, Reading,
    SvgStyle, find_blobs, write_project,
};
use crate::methods::Method;
use crate::pattern::{Domain, PatternError, PointPattern};
use crate::run::{Cost, ParameterError};

pub use protocol::{
    AttributeView, BlobOptionsView, ClassView, CostView, DomainView, FilesRequest, FilesResponse, InkView,
    LinkExemplarView, PreviewView, ProjectView, ReadOptionsView, WrittenFormat,
};

/// Longest estimated run, in seconds, that a link may start by itself.
const LONGEST_AUTO_RUN: f64 = 600.0;

/// Why a request was refused.
#[derive(Debug, Error)]
enum Refusal {
    #[error("{}{error}", match file.as_str() { "" => String::new(), file => format!("{file}: ") })]
    File { file: String, error: Box<FormatError> },
    #[error(transparent)]
    Format(#[from] FormatError),
    #[error("the points can't be used: {0}")]
    Pattern(#[from] PatternError),
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    #[error(transparent)]
    Link(#[from] LinkError),
    #[error(transparent)]
    Glyph(#[from] GlyphError),
}

/// Answers one request.
#[must_use]
pub fn respond(request: FilesRequest) -> FilesResponse {
    let response = match request {
        FilesRequest::Read { name, bytes, options } => read(name, &bytes, options),
        FilesRequest::Blobs { width, height, pixels, options } => blobs(width, height, &pixels, options),
        FilesRequest::Write { format, pattern, title, tile, glyphs, palette, origin } => look(&glyphs, &palette, tile)
            .map_err(Refusal::from)
            .and_then(|look| write(format, *pattern, title, look, &origin)),
        FilesRequest::Glyph { name } => Glyph::from_name(&name)
            .map(|glyph| FilesResponse::Glyph { outline: glyph.path_data() })
            .map_err(Refusal::from),
        FilesRequest::WriteProject { title, method, preset, overrides, exemplar, origin, output, state } => {
            let output = output.map(|output| PointPattern::try_from(*output)).transpose();
            output.map_err(Refusal::from).and_then(|output| {
                project(*exemplar, Project { title, method, preset, overrides, origin, output, state })
            })
        }
        FilesRequest::WriteLink { exemplar, method, preset, overrides } => link(exemplar, method, preset, overrides),
        FilesRequest::ReadLink { fragment } => open_link(&fragment),
    };
    response.unwrap_or_else(|refusal| {
        let (position, columns) = match &refusal {
            Refusal::File { error, .. } => (error.position(), error.columns().to_vec()),
            Refusal::Format(error) => (error.position(), error.columns().to_vec()),
            _ => (None, Vec::new()),
        };
        let place =
            position.map(|(line, column)| Place { line: line as u64, column: column.map(|column| column as u64) });
        FilesResponse::Error { message: refusal.to_string(), place, columns }
    })
}

fn read(file: String, bytes: &[u8], options: ReadOptionsView) -> Result<FilesResponse, Refusal> {
    let domain = options.domain.map(domain).transpose()?;
    let options = ReadOptions {
        domain,
        boundary: options.boundary,
        columns: options.columns,
        keeps_degrees: options.keeps_degrees,
    };
    match formats::open(bytes, Some(&file), &options) {
        Ok(mut reading) => {
            let project = reading.project.take().map(|project| ProjectView {
                title: project.title,
                method: project.method,
                preset: project.preset,
                overrides: project.overrides,
                output: project.output.as_ref().map(boxed),
                state: project.state,
            });
            let preview = preview(reading.format.name(), Preview::of(&reading));
            Ok(FilesResponse::Read { pattern: boxed(&reading.pattern), preview, project })
        }
        Err(FormatError::Picture { kind }) => Ok(FilesResponse::Picture { kind: kind.to_owned() }),
        Err(error) => Err(Refusal::File { file, error: Box::new(error) }),
    }
}

fn domain([x0, y0, x1, y1]: [f64; 4]) -> Result<Domain, PatternError> {
    Domain::new([x0, y0].into(), [x1 - x0, y1 - y0].into())
}

fn boxed(pattern: &PointPattern) -> Box<PatternData> {
    Box::new(pattern.into())
}

fn preview(format: &str, preview: Preview) -> PreviewView {
    let classes = preview.classes.into_iter();
    let attributes = preview.attributes.into_iter();
    PreviewView {
        format: format.to_owned(),
        points: preview.points,
        classes: classes.map(|class| ClassView { name: class.name, count: class.count }).collect(),
        attributes: attributes.map(|one| AttributeView { name: one.name, min: one.min, max: one.max }).collect(),
        domain: preview.domain,
        declared: preview.is_domain_declared,
        boundary: preview.boundary,
        spacing: preview.spacing,
        domains: preview
            .domains
            .into_iter()
            .map(|(name, domain)| DomainView { name: name.to_owned(), domain })
            .collect(),
        columns: preview.columns,
        origin: preview.origin,
        notes: preview.notes,
    }
}

fn blobs(width: usize, height: usize, pixels: &[u8], options: BlobOptionsView) -> Result<FilesResponse, Refusal> {
    let picture = Picture::new(width, height, pixels)?;
    let options = BlobOptions {
        // Saturates.
        threshold: options.threshold.map(|threshold| threshold.round() as u8),
        ink: match options.ink {
            InkView::Auto => Ink::Auto,
            InkView::Dark => Ink::Dark,
            InkView::Light => Ink::Light,
        },
        min_area: options.min_area,
        max_area: options.max_area,
    };
    let found = find_blobs(&picture, &options, &ReadOptions::default())?;
    let Reading { pattern, format, .. } = &found.reading;
    Ok(FilesResponse::Blobs {
        pattern: boxed(pattern),
        preview: preview(format.name(), Preview::of(&found.reading)),
        threshold: found.threshold,
        local: found.is_local,
        ink: if found.ink == Ink::Light { InkView::Light } else { InkView::Dark },
    })
}

/// The look of a drawing that a person has chosen.
fn look(glyphs: &Map<String, Value>, palette: &str, tile: bool) -> Result<Look, GlyphError> {
    let chosen =
        |(class, name): (&String, &Value)| Ok((class.clone(), Glyph::from_name(name.as_str().unwrap_or_default())?));
    let glyphs = glyphs.iter().map(chosen).collect::<Result<_, GlyphError>>()?;
    let look = Look { glyphs, palette: Palette::from_name(palette).unwrap_or_default(), ..Look::default() };
    Ok(if tile { Look { frame: None, margin: 0.0, ..look } } else { look })
}

fn write(
    format: WrittenFormat,
    pattern: PatternData,
    title: String,
    look: Look,
    origin: &Origin,
) -> Result<FilesResponse, Refusal> {
    let pattern = PointPattern::try_from(pattern)?;
    let (bytes, mime, extension) = match format {
        WrittenFormat::Csv => (formats::write_csv_like(&pattern, origin).into_bytes(), "text/csv", ".csv"),
        WrittenFormat::Tsv => (formats::write_tsv(&pattern).into_bytes(), "text/tab-separated-values", ".tsv"),
        WrittenFormat::Json => (formats::write_json(&pattern).into_bytes(), "application/json", ".json"),
        WrittenFormat::GeoJson => {
            (formats::write_geojson(&pattern, origin).into_bytes(), "application/geo+json", ".geojson")
        }
        WrittenFormat::Npy => (formats::write_npy(&pattern), "application/octet-stream", ".npy"),
        WrittenFormat::Svg => {
            let style = SvgStyle { title, look, ..SvgStyle::default() };
            (formats::write_svg(&pattern, &style).into_bytes(), "image/svg+xml", ".svg")
        }
    };
    Ok(FilesResponse::Written { bytes, mime: mime.to_owned(), extension: extension.to_owned() })
}

fn project(exemplar: PatternData, project: Project) -> Result<FilesResponse, Refusal> {
    let exemplar = PointPattern::try_from(exemplar)?;
    project.method.check_preset(&project.preset)?;
    let bytes = write_project(&exemplar, &project)?.into_bytes();
    Ok(FilesResponse::Written { bytes, mime: "application/json".to_owned(), extension: ".json".to_owned() })
}

fn link(
    exemplar: LinkExemplarView,
    method: Method,
    preset: String,
    overrides: Map<String, Value>,
) -> Result<FilesResponse, Refusal> {
    let exemplar = match exemplar {
        LinkExemplarView::Gallery(name) => LinkExemplar::named(&name)?,
        LinkExemplarView::Pattern(pattern) => LinkExemplar::Points((*pattern).try_into()?),
    };
    let link = Link { method, exemplar, preset, overrides, notes: Vec::new() };
    let Written { fragment, exemplar: received, note } = write_link(&link)?;
    let exact = received == link.exemplar;
    let pattern = boxed(&pattern_of(&received)?);
    Ok(FilesResponse::LinkWritten { fragment, pattern, exact, note })
}

fn pattern_of(exemplar: &LinkExemplar) -> Result<PointPattern, LinkError> {
    exemplar.pattern().ok_or_else(|| LinkError::Exemplar(String::new()))
}

fn open_link(fragment: &str) -> Result<FilesResponse, Refusal> {
    let link = read_link(fragment)?;
    let parameters = link.parameters()?;
    let pattern = pattern_of(&link.exemplar)?;
    let cost = match link.method.definition().cost(&pattern, &parameters) {
        Some(Cost { points, iterations, giga_operations, seconds }) => {
            let auto_run = seconds <= LONGEST_AUTO_RUN;
            CostView { points, iterations, giga_operations, seconds, auto_run }
        }
        // Nothing to learn from: a run would be refused at once.
        None => CostView { points: 0, iterations: 0, giga_operations: 0.0, seconds: 0.0, auto_run: false },
    };
    Ok(FilesResponse::LinkRead {
        exemplar: match link.exemplar {
            LinkExemplar::Gallery(name) => LinkExemplarView::Gallery(name.to_owned()),
            LinkExemplar::Points(pattern) => LinkExemplarView::Pattern(boxed(&pattern)),
        },
        method: link.method,
        preset: link.preset,
        overrides: link.overrides,
        parameters,
        notes: link.notes,
        preview: preview("link", Preview::of_pattern(&pattern)),
        cost,
    })
}
