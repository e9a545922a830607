//! The messages between the page and what reads and writes its files.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::formats::{Column, ColumnChoice, Note, Origin};
use crate::methods::Method;
use crate::pattern::Boundary;
use crate::web::pattern_data::PatternData;
use crate::web::protocol::Place;

/// What the page asks: an object whose `type` is one of these in kebab case, read as [`crate::web::Request`] is.
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
        /// How the exemplar's file named and placed things.
        #[serde(default)]
        origin: Origin,
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
        /// Name of a method.
        #[serde(default)]
        method: Method,
        /// Name of a preset.
        preset: String,
        /// Parameters that differ from it.
        #[serde(default)]
        overrides: Map<String, Value>,
        /// What is learnt from.
        exemplar: Box<PatternData>,
        /// How the exemplar's file named and placed things.
        #[serde(default)]
        origin: Origin,
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
        /// Name of a method.
        #[serde(default)]
        method: Method,
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

/// [`ReadOptions`](crate::formats::ReadOptions) as the page writes them.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct ReadOptionsView {
    /// Lower and upper corner.
    pub domain: Option<[f64; 4]>,
    /// What lies beyond the border.
    pub boundary: Option<Boundary>,
    /// Which columns hold what.
    pub columns: ColumnChoice,
    /// Takes degrees as they are.
    pub keeps_degrees: bool,
}

/// [`BlobOptions`](crate::formats::BlobOptions) as the page writes them.
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

/// [`Ink`](crate::formats::Ink) as the page writes it.
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
    /// Points in the coordinates and words of the exemplar's file.
    #[serde(rename = "geojson")]
    GeoJson,
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
        /// Whether it is one of differences from what is around a pixel, 128 being none: the light is uneven.
        local: bool,
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
        /// As [`GlyphView::outline`](crate::web::protocol::GlyphView::outline).
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
        /// Name of a method.
        method: Method,
        /// Name of a preset.
        preset: String,
        /// Parameters that differ from it, in their ranges.
        overrides: Map<String, Value>,
        /// All parameters.
        parameters: Map<String, Value>,
        /// What was moved into its range, in sentences.
        notes: Vec<Note>,
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
        /// What there is to choose from, when another choice of columns may help.
        #[serde(default)]
        columns: Vec<Column>,
    },
}

/// [`Preview`](crate::formats::Preview) as the page shows it.
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
    /// Other rectangles that the points may have been cut from.
    pub domains: Vec<DomainView>,
    /// What there was to choose from, of a table, records or GeoJSON.
    pub columns: Vec<Column>,
    /// How the file named and placed things: belongs to what is written of the result.
    pub origin: Origin,
    /// What was left out, changed or looks odd.
    pub notes: Vec<Note>,
}

/// A rectangle that the points may have been cut from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DomainView {
    /// A word for it.
    pub name: String,
    /// Lower and upper corner.
    pub domain: [f64; 4],
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

/// [`Project`](crate::formats::Project) as the page takes it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct ProjectView {
    /// What the person calls it.
    pub title: String,
    /// Name of a method.
    pub method: Method,
    /// Name of a preset.
    pub preset: String,
    /// Parameters that differ from it, in their ranges.
    pub overrides: Map<String, Value>,
    /// What had come out.
    pub output: Option<Box<PatternData>>,
    /// For the engine's `resume`.
    pub state: Option<String>,
}

/// [`Cost`](crate::run::Cost) as the page shows it.
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
