//! Files, pictures and links: what the page's second module does. No browser in sight, so that it is tested natively.
//!
//! Every request is answered by itself; nothing is kept in between. Positions are [`PatternData`]'s: exact, in the
//! pattern's own unit.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use thiserror::Error;

use super::pattern_data::PatternData;
use super::protocol::Place;
use crate::domain::{Boundary, Domain};
use crate::formats::link::{Link, LinkError, LinkExemplar, Written, read_link, write_link};
use crate::formats::style::{Look, Palette};
use crate::formats::{
    self, BlobOptions, FormatError, Glyph, GlyphError, Ink, Picture, Preview, Project, ReadOptions, Reading, SvgStyle,
    find_blobs, write_project,
};
use crate::method::{Cost, ParameterError, Parameters, Preset};
use crate::pattern::{PatternError, PointPattern};

/// Longest estimated run, in seconds, that a link may start by itself.
const LONGEST_AUTO_RUN: f64 = 600.0;

/// What the page asks: an object whose `type` is one of these in kebab case, read as [`super::Request`] is.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", rename_all_fields = "camelCase")]
pub enum FilesRequest {
    /// Reads a file. Answered by [`FilesResponse::Read`], or [`FilesResponse::Picture`] when it is one.
    Read {
        /// Its name; the extension helps to tell formats apart.
        name: String,
        /// What is in it.
        #[serde(with = "serde_bytes")]
        bytes: Vec<u8>,
        /// What the person knows better.
        #[serde(default)]
        options: ReadOptionsView,
    },
    /// Looks for the points of a picture. Answered by [`FilesResponse::Blobs`].
    Blobs {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// Red, green, blue, alpha.
        #[serde(with = "serde_bytes")]
        pixels: Vec<u8>,
        /// What counts as a point.
        #[serde(default)]
        options: BlobOptionsView,
    },
    /// Writes a pattern as a file. Answered by [`FilesResponse::Written`].
    Write {
        /// Which kind of file.
        format: WrittenFormat,
        /// What to write.
        pattern: Box<PatternData>,
        /// What stands in a drawing's title.
        #[serde(default)]
        title: String,
        /// A drawing that ends at the domain's border.
        #[serde(default)]
        tile: bool,
        /// In a drawing, the glyphs chosen for classes, by the classes' names.
        #[serde(default)]
        glyphs: Map<String, Value>,
        /// In a drawing, the colours.
        #[serde(default)]
        palette: String,
    },
    /// The outline of a glyph, or what is wrong with its path. Answered by [`FilesResponse::Glyph`].
    Glyph {
        /// Its name, or `path:` and SVG path data.
        name: String,
    },
    /// Writes a whole session. Answered by [`FilesResponse::Written`].
    WriteProject {
        /// What the person calls it.
        title: String,
        /// Name of a preset.
        preset: String,
        /// Parameters that differ from it.
        #[serde(default)]
        overrides: Map<String, Value>,
        /// What is learnt from.
        exemplar: Box<PatternData>,
        /// What has come out so far.
        #[serde(default)]
        output: Option<Box<PatternData>>,
        /// What the engine's `save` answered.
        #[serde(default)]
        state: Option<String>,
    },
    /// Writes a link. Answered by [`FilesResponse::LinkWritten`].
    WriteLink {
        /// What is learnt from.
        exemplar: LinkExemplarView,
        /// Name of a preset.
        preset: String,
        /// Parameters that may differ from it.
        #[serde(default)]
        overrides: Map<String, Value>,
    },
    /// Reads a link. Answered by [`FilesResponse::LinkRead`].
    ReadLink {
        /// With or without its `#`.
        fragment: String,
    },
}

/// [`ReadOptions`] as the page writes them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct ReadOptionsView {
    /// Lower and upper corner.
    pub domain: Option<[f64; 4]>,
    /// What lies beyond the border.
    pub boundary: Option<Boundary>,
}

/// [`BlobOptions`] as the page writes them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct BlobOptionsView {
    /// Brightness from 0 to 255; Otsu's when left out.
    pub threshold: Option<f64>,
    /// Which pixels are points.
    pub ink: InkView,
    /// Smallest blob in pixels.
    pub min_area: Option<f64>,
    /// Largest blob in pixels.
    pub max_area: Option<f64>,
}

/// [`Ink`] as the page writes it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum InkView {
    /// The side with fewer pixels.
    #[default]
    Auto,
    /// The darker ones.
    Dark,
    /// The lighter ones.
    Light,
}

/// Kinds of file a pattern can be written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum WrittenFormat {
    /// One line a point, lossless.
    Csv,
    /// Cells for the clipboard.
    Tsv,
    /// Lossless.
    Json,
    /// A drawing.
    Svg,
    /// A NumPy array.
    Npy,
}

/// What a link carries an exemplar as: a name of the gallery, or points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LinkExemplarView {
    /// The name of a built-in exemplar.
    Gallery(String),
    /// Its points.
    Pattern(Box<PatternData>),
}

/// What the worker answers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "kebab-case", rename_all_fields = "camelCase")]
pub enum FilesResponse {
    /// A file was read.
    Read {
        /// Its points; of a project the exemplar.
        pattern: Box<PatternData>,
        /// What to show of it.
        preview: PreviewView,
        /// What else a project holds.
        project: Option<ProjectView>,
    },
    /// The file is a picture, whose pixels only the browser knows: they have to come as [`FilesRequest::Blobs`].
    Picture {
        /// What it looks like.
        kind: String,
    },
    /// The points of a picture.
    Blobs {
        /// In pixels from the upper left corner.
        pattern: Box<PatternData>,
        /// What to show of it.
        preview: PreviewView,
        /// The threshold that was used.
        threshold: u8,
        /// Which pixels were taken.
        ink: InkView,
    },
    /// A file.
    Written {
        /// What is in it; a `Uint8Array` on the page.
        #[serde(with = "serde_bytes")]
        bytes: Vec<u8>,
        /// Its media type.
        mime: String,
        /// How its name ends, with the dot.
        extension: String,
    },
    /// A glyph.
    Glyph {
        /// As [`GlyphView::outline`](super::protocol::GlyphView::outline).
        outline: String,
    },
    /// A link.
    LinkWritten {
        /// Without its `#`.
        fragment: String,
        /// The exemplar as the receiver gets it.
        pattern: Box<PatternData>,
        /// Whether that is the one given, to the last digit.
        exact: bool,
        /// What was rounded more than to 65535ths to keep the link short, in a sentence.
        note: Option<String>,
    },
    /// A link was read.
    LinkRead {
        /// What is learnt from.
        exemplar: LinkExemplarView,
        /// Name of a preset.
        preset: String,
        /// Parameters that differ from it, in their ranges.
        overrides: Map<String, Value>,
        /// All parameters.
        parameters: Box<Parameters>,
        /// What was moved into its range, in sentences.
        notes: Vec<String>,
        /// What to show of the exemplar.
        preview: PreviewView,
        /// What a run would take.
        cost: CostView,
    },
    /// The request was refused.
    Error {
        /// One sentence for a person.
        message: String,
        /// Where in the file, when it is about a file.
        place: Option<Place>,
    },
}

/// [`Preview`] as the page shows it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct PreviewView {
    /// What a person calls the format.
    pub format: String,
    /// How many points there are.
    pub points: usize,
    /// The classes in their order.
    pub classes: Vec<ClassView>,
    /// The attributes in their order.
    pub attributes: Vec<AttributeView>,
    /// Lower and upper corner.
    pub domain: [f64; 4],
    /// Whether the file or the caller told the domain.
    pub declared: bool,
    /// Whether it is a window or a tile.
    pub boundary: Boundary,
    /// Mean distance to the nearest neighbour, in the pattern's own unit.
    pub spacing: Option<f64>,
    /// What was left out, changed or looks odd, in sentences.
    pub notes: Vec<String>,
}

/// One class.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ClassView {
    /// Its name.
    pub name: String,
    /// How many points it has.
    pub count: usize,
}

/// One attribute.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AttributeView {
    /// Its name.
    pub name: String,
    /// Its smallest value.
    pub min: f64,
    /// Its largest value.
    pub max: f64,
}

/// [`Project`] as the page takes it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct ProjectView {
    /// What the person calls it.
    pub title: String,
    /// Name of a preset.
    pub preset: String,
    /// Parameters that differ from it, in their ranges.
    pub overrides: Map<String, Value>,
    /// What had come out.
    pub output: Option<Box<PatternData>>,
    /// For the engine's `resume`.
    pub state: Option<String>,
}

/// [`Cost`] as the page shows it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct CostView {
    /// Points of the output.
    pub points: usize,
    /// Most iterations.
    pub iterations: u64,
    /// Operations in 10⁹.
    pub giga_operations: f64,
    /// About how many seconds on the processor.
    pub seconds: f64,
    /// Whether a page may start it unasked.
    pub auto_run: bool,
}

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
        FilesRequest::Write { format, pattern, title, tile, glyphs, palette } => {
            look(&glyphs, &palette, tile).map_err(Refusal::from).and_then(|look| write(format, *pattern, title, look))
        }
        FilesRequest::Glyph { name } => Glyph::from_name(&name)
            .map(|glyph| FilesResponse::Glyph { outline: glyph.path_data() })
            .map_err(Refusal::from),
        FilesRequest::WriteProject { title, preset, overrides, exemplar, output, state } => {
            project(*exemplar, title, &preset, overrides, output, state)
        }
        FilesRequest::WriteLink { exemplar, preset, overrides } => link(exemplar, &preset, overrides),
        FilesRequest::ReadLink { fragment } => open_link(&fragment),
    };
    response.unwrap_or_else(|refusal| {
        let position = match &refusal {
            Refusal::File { error, .. } => error.position(),
            Refusal::Format(error) => error.position(),
            _ => None,
        };
        let place =
            position.map(|(line, column)| Place { line: line as u64, column: column.map(|column| column as u64) });
        FilesResponse::Error { message: refusal.to_string(), place }
    })
}

fn read(file: String, bytes: &[u8], options: ReadOptionsView) -> Result<FilesResponse, Refusal> {
    let domain = options.domain.map(domain).transpose()?;
    let options = ReadOptions { domain, boundary: options.boundary };
    match formats::open(bytes, Some(&file), &options) {
        Ok(mut reading) => {
            let project = reading.project.take().map(|project| ProjectView {
                title: project.title,
                preset: project.preset.name().to_owned(),
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

fn write(format: WrittenFormat, pattern: PatternData, title: String, look: Look) -> Result<FilesResponse, Refusal> {
    let pattern = PointPattern::try_from(pattern)?;
    let (bytes, mime, extension) = match format {
        WrittenFormat::Csv => (formats::write_csv(&pattern).into_bytes(), "text/csv", ".csv"),
        WrittenFormat::Tsv => (formats::write_tsv(&pattern).into_bytes(), "text/tab-separated-values", ".tsv"),
        WrittenFormat::Json => (formats::write_json(&pattern).into_bytes(), "application/json", ".json"),
        WrittenFormat::Npy => (formats::write_npy(&pattern), "application/octet-stream", ".npy"),
        WrittenFormat::Svg => {
            let style = SvgStyle { title, look, ..SvgStyle::default() };
            (formats::write_svg(&pattern, &style).into_bytes(), "image/svg+xml", ".svg")
        }
    };
    Ok(FilesResponse::Written { bytes, mime: mime.to_owned(), extension: extension.to_owned() })
}

fn project(
    exemplar: PatternData,
    title: String,
    preset: &str,
    overrides: Map<String, Value>,
    output: Option<Box<PatternData>>,
    state: Option<String>,
) -> Result<FilesResponse, Refusal> {
    let exemplar = PointPattern::try_from(exemplar)?;
    let output = output.map(|output| PointPattern::try_from(*output)).transpose()?;
    let project = Project { title, preset: Preset::from_name(preset)?, overrides, output, state };
    let bytes = write_project(&exemplar, &project)?.into_bytes();
    Ok(FilesResponse::Written { bytes, mime: "application/json".to_owned(), extension: ".json".to_owned() })
}

fn link(exemplar: LinkExemplarView, preset: &str, overrides: Map<String, Value>) -> Result<FilesResponse, Refusal> {
    let exemplar = match exemplar {
        LinkExemplarView::Gallery(name) => LinkExemplar::named(&name)?,
        LinkExemplarView::Pattern(pattern) => LinkExemplar::Points((*pattern).try_into()?),
    };
    let link = Link { exemplar, preset: Preset::from_name(preset)?, overrides, notes: Vec::new() };
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
    let cost = match Cost::of(&pattern, &parameters) {
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
        preset: link.preset.name().to_owned(),
        overrides: link.overrides,
        parameters: Box::new(parameters),
        notes: link.notes,
        preview: preview("link", Preview::of_pattern(&pattern)),
        cost,
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may stop at the first surprise")]

    use serde_json::json;

    use super::*;
    use crate::web::protocol::tests::tags;

    fn ask(request: Value) -> Value {
        let kind = request["type"].as_str().unwrap().to_owned();
        serde_json::to_value(respond(serde_json::from_value(json!({ kind: request })).unwrap())).unwrap()
    }

    fn open(name: &str, bytes: &[u8]) -> Value {
        ask(json!({ "type": "read", "name": name, "bytes": bytes, "options": {} }))
    }

    fn bytes(answer: &Value) -> Vec<u8> {
        serde_json::from_value(answer["bytes"].clone()).unwrap()
    }

    #[test]
    fn the_page_knows_every_message() {
        let typedefs = include_str!("../../www/app/files-messages.js");
        let (requests, responses) = (tags::<FilesRequest>(), tags::<FilesResponse>());
        assert!(requests.contains(&"read-link".to_owned()), "{requests:?}");
        assert!(responses.contains(&"link-read".to_owned()), "{responses:?}");
        for tag in requests.iter().chain(&responses) {
            assert!(typedefs.contains(&format!("type: '{tag}'")), "no typedef for the message '{tag}'");
        }
        let known = requests.len() + responses.len();
        assert_eq!(typedefs.matches("type: '").count(), known, "a typedef for a message that does not exist");
    }

    #[test]
    fn a_file_comes_with_its_preview_and_goes_out_in_every_format() {
        let read = open("a.csv", b"# domain 0 0 4 2 periodic\nx,y,class,height\n1,1,oak,3\n2,1,elm,5\n2,1,oak,4\n");
        let preview = &read["preview"];
        assert_eq!(preview["format"], "CSV or TSV", "{read}");
        assert_eq!(preview["classes"], json!([{ "name": "oak", "count": 2 }, { "name": "elm", "count": 1 }]));
        assert_eq!(preview["attributes"], json!([{ "name": "height", "min": 3.0, "max": 5.0 }]));
        assert_eq!((&preview["domain"], &preview["declared"]), (&json!([0.0, 0.0, 4.0, 2.0]), &json!(true)));
        assert_eq!(preview["spacing"], json!(1.0));
        let notes: Vec<String> = serde_json::from_value(preview["notes"].clone()).unwrap();
        assert!(
            notes[0].contains("One point lies exactly on another") && notes[1].contains("only 3 points"),
            "{notes:?}"
        );

        for (format, start) in [
            ("csv", "# domain 0 0 4 2"),
            ("tsv", "x\ty\tclass"),
            ("json", "{"),
            ("svg", "<svg"),
            ("npy", "\u{fffd}NUMPY"),
        ] {
            let written = ask(json!({ "type": "write", "format": format, "pattern": read["pattern"], "title": "t" }));
            assert_eq!(written["type"], "written", "{written}");
            let bytes = bytes(&written);
            assert!(String::from_utf8_lossy(&bytes).starts_with(start), "{format}");
            let again = open("", &bytes);
            assert_eq!(again["pattern"]["positions"].as_array().unwrap().len(), 6, "{format}: {again}");
            if format == "csv" || format == "json" {
                assert_eq!(again["pattern"], read["pattern"], "{format}");
            }
        }
    }

    #[test]
    fn a_tile_ends_at_its_border() {
        let pattern = &open("", b"# domain 0 0 4 2 periodic\n1 1\n2 1\n")["pattern"];
        let svg = |tile: bool| {
            let written = ask(json!({ "type": "write", "format": "svg", "pattern": pattern, "tile": tile }));
            String::from_utf8(bytes(&written)).unwrap()
        };
        assert!(svg(true).contains("data-frame=\"0 0 800 400\"") && !svg(false).contains("data-frame=\"0 0 800 400\""));
    }

    #[test]
    fn glyphs_are_checked_and_drawn() {
        let glyph = |name: &str| ask(json!({ "type": "glyph", "name": name }));
        let square = json!({ "type": "glyph", "outline": "M-1 -1L1 -1L1 1L-1 1Z" });
        assert_eq!(glyph("path:M0 0h10v10h-10z"), square);
        assert!(glyph("path:M0 0L9 x")["message"].as_str().unwrap().contains("position 8"));
        assert_eq!(glyph("castle")["type"], "error");

        let boats: PatternData = (&crate::gallery::find("boats").unwrap().exemplar()).into();
        let write = |glyphs: Value, palette: &str| {
            ask(json!({ "type": "write", "format": "svg", "pattern": boats, "glyphs": glyphs, "palette": palette }))
        };
        let drawn = |glyphs, palette| String::from_utf8(bytes(&write(glyphs, palette))).unwrap();
        let plain = drawn(json!({}), "");
        assert!(plain.contains("<use href=\"#glyph-0\"") && plain.contains("rotate(") && plain.contains("#0072b2"));
        let own = drawn(json!({ "boat": "path:M0 0L9 0L9 9Z" }), "ink");
        assert!(own.contains("d=\"M-1 -1L1 -1L1 1Z\"") && own.contains("#222222") && !own.contains("#0072b2"));
        let refused = write(json!({ "boat": "path:\"><script>" }), "ink");
        assert_eq!(refused["type"], "error", "{refused}");
    }

    #[test]
    fn refusals_name_the_file_and_the_place() {
        let answer = open("mine.csv", b"x,y\n0.5,0.5\n0.2,oops\n");
        assert_eq!(answer["place"], json!({ "line": 3, "column": 2 }), "{answer}");
        let message = answer["message"].as_str().unwrap();
        assert!(message.starts_with("mine.csv: line 3, column 2") && message.contains("oops"), "{message}");
        let answer = open("", b"[[0.5, 0.5],\n [0.5]]");
        assert_eq!(answer["place"], json!({ "line": 2, "column": 2 }), "{answer}");
        assert!(answer["message"].as_str().unwrap().starts_with("line 2, column 2 (point 2"), "{answer}");
    }

    #[test]
    fn pictures_are_left_to_the_page() {
        assert_eq!(open("a.jpg", b"\xff\xd8\xff\xe0")["type"], "picture");
        let mut pixels = vec![255_u8; 4 * 12];
        pixels[4..7].fill(0);
        let request =
            |options: Value| json!({ "type": "blobs", "width": 4, "height": 3, "pixels": pixels, "options": options });
        let answer = ask(request(json!({})));
        assert_eq!((&answer["type"], &answer["ink"]), (&json!("blobs"), &json!("dark")), "{answer}");
        assert_eq!(answer["pattern"]["positions"], json!([1.5, 0.5]));
        assert_eq!(ask(request(json!({ "threshold": 300, "ink": "light" })))["type"], "error");
    }

    #[test]
    fn a_session_is_kept_whole() {
        let exemplar = &open("", b"0.1 0.2\n0.3 0.4\n")["pattern"];
        let state =
            json!({ "version": 1, "exemplar": { "x": 1 }, "losses": [0.1], "points": [[0.1, 0.2]] }).to_string();
        let written = ask(json!({
            "type": "write-project", "title": "Mine", "preset": "balanced", "overrides": { "seed": 7, "channels": 9000, "chanels": 1 },
            "exemplar": exemplar, "output": exemplar, "state": state,
        }));
        let read = open("a.json", &bytes(&written));
        assert_eq!((&read["pattern"], &read["preview"]["format"]), (exemplar, &json!("Pointweave project")), "{read}");
        let project = &read["project"];
        assert_eq!((&project["title"], &project["preset"]), (&json!("Mine"), &json!("balanced")));
        assert_eq!(project["overrides"], json!({ "seed": 7, "channels": 160 }));
        assert_eq!(project["output"], *exemplar);
        let kept: Value = serde_json::from_str(project["state"].as_str().unwrap()).unwrap();
        assert_eq!((&kept["losses"], &kept["points"]), (&json!([0.1]), &json!([[0.1, 0.2]])));
        assert_eq!(kept["exemplar"]["positions"], json!([[0.1, 0.2], [0.3, 0.4]]), "it stands once in the file");
        assert_eq!(read["preview"]["notes"].as_array().unwrap().len(), 3, "two parameters and few points: {read}");
    }

    #[test]
    fn links_go_and_come() {
        let link = |exemplar: Value, overrides: Value| {
            ask(json!({ "type": "write-link", "exemplar": exemplar, "preset": "fast", "overrides": overrides }))
        };
        let read = |fragment: &str| ask(json!({ "type": "read-link", "fragment": fragment }));
        let written = link(json!({ "gallery": "rings" }), json!({ "seed": 7 }));
        assert_eq!(written["fragment"], "v=1&preset=fast&seed=7&exemplar=rings");
        assert_eq!(written["exact"], true);
        let answer = read("#v=1&preset=fast&seed=7&exemplar=rings&embed=1");
        assert_eq!(
            (&answer["exemplar"], &answer["overrides"]),
            (&json!({ "gallery": "rings" }), &json!({ "seed": 7 }))
        );
        assert_eq!((&answer["parameters"]["seed"], &answer["cost"]["autoRun"]), (&json!(7), &json!(true)), "{answer}");
        let heavy = read("v=1&preset=paper&expansion-x=8&expansion-y=8&exemplar=rings");
        assert_eq!(heavy["cost"]["autoRun"], json!(false), "{heavy}");
        assert!(heavy["cost"]["seconds"].as_f64().unwrap() > 3600.0);

        let own = &open("", b"0.1 0.2\n0.3 0.4\n0 1\n")["pattern"];
        let written = link(json!({ "pattern": own }), json!({}));
        assert_eq!(written["exact"], false, "tenths are no 65535ths");
        let answer = read(written["fragment"].as_str().unwrap());
        assert_eq!(answer["exemplar"]["pattern"], written["pattern"], "{answer}");
        let again = link(answer["exemplar"].clone(), json!({}));
        assert_eq!((&again["exact"], &again["fragment"]), (&json!(true), &written["fragment"]));
        assert_eq!(read("v=2")["type"], "error");
    }
}
