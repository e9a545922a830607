//! Bytes to patterns and back, one file a format.
//!
//! # What can be read
//! | format | told by |
//! |---|---|
//! | NumPy array ([`write_npy`]'s layout, N × 2 and more), or an archive of arrays | its first bytes |
//! | PNG (dark or light blobs become points, see [`find_blobs`]) | its first bytes; natively only, a page decodes by itself |
//! | SVG (circles, and what looks like marks, become points) | the first character is `<`, and there is an `<svg` |
//! | project ([`Project`]) | JSON with a member `pointweave-project` |
//! | GeoJSON points | JSON with a `type` that GeoJSON knows |
//! | JSON ([`write_json`]'s layout, `[[x, y], …]`, `{"points": […]}`, records, sequences) | the first character is `{` or `[`, or the name ends in `.json` |
//! | the reference implementation's text | whole numbers `class x y …`, with a first line `K id…` or classes 1000, 2000, … |
//! | TSV, semicolon-separated text, CSV, text with bars | most lines of data hold a tab, else a semicolon, else a comma, else a bar |
//! | whitespace-separated text | everything else |
//!
//! Text is UTF-8, UTF-16 or Windows-1252, with any line ends (`text.rs`). Lines that begin with `#` are comments, unless they fit
//! as rows or as the header (`header.rs`).
//!
//! # Columns
//! A header names x and y, and perhaps the class, in many words (`column_names.rs`); every other column of numbers is an
//! attribute, as far as there is room; `attribute:` in front of a name marks an attribute called, say, `class`. Text, running
//! numbers and columns with gaps are left out, and a [`Note`] says so (`columns.rs`). Without a header the columns are x, y, then
//! a class or an attribute, then attributes named `attribute-1`, … . The third column holds classes when a value in it is a word,
//! or when all are whole numbers with at most [`MAX_CLASSES`](crate::pattern::MAX_CLASSES) different ones. Classes are numbered in
//! the order they appear in; beyond the cap the most frequent ones stay. [`ColumnChoice`] is a person's own choice.
//!
//! Decimal commas are understood where the comma does not separate columns, and in quotes (`number.rs`).
//!
//! # Domain
//! [`ReadOptions`], then the file, then the unit square when all points lie in it and fill it, then the bounding box grown
//! by half the mean distance between nearest neighbours. Points fill the unit square unless they leave a strip along a side
//! empty that is wider than every hole between them. A text file declares its domain in a comment line:
//! ```text
//! # domain 0 0 100 50 periodic        lower corner, upper corner, boundary (open when left out)
//! # domain 0 0 size 100 50            lower corner, width and height
//! # classes: oak,"silver birch"       the order of the classes, quoted as in CSV
//! ```

mod areas;
mod column_names;
mod columns;
mod declaration;
mod delimited;
mod error;
mod geojson;
mod glyph;
mod ground;
mod guess;
mod header;
mod json;
pub mod link;
mod literal;
mod note;
mod npy;
mod npz;
mod number;
mod oddities;
mod origin;
mod outline;
mod picture;
#[cfg(not(target_arch = "wasm32"))]
pub(crate) mod png;
mod preview;
mod project;
mod reference;
#[cfg(not(target_arch = "wasm32"))]
mod report;
mod spots;
pub mod style;
pub(crate) mod svg;
mod svg_points;
mod table;
mod text;
mod whitespace;
mod window;

pub use delimited::{write_csv, write_csv_like, write_tsv};
pub use error::{FormatError, Place};
pub use geojson::write_geojson;
pub use glyph::{Glyph, GlyphError, Polygon};
pub use json::write_json;
pub use note::{Note, NoteKind};
pub use npy::write_npy;
pub use oddities::oddities;
pub use origin::{Origin, Projection};
pub use outline::{MAX_PATH_LENGTH, MAX_PATH_SEGMENTS, Outline, OutlineError};
pub use picture::{BlobOptions, Blobs, Ink, Picture, find_blobs};
#[cfg(not(target_arch = "wasm32"))]
pub use png::{PngError, PngStyle, draw, encode_png, write_png};
pub use preview::{AttributePreview, ClassPreview, Preview};
pub use project::{Project, write_project};
#[cfg(not(target_arch = "wasm32"))]
pub use report::{ReportError, write_comparison_report, write_report};
pub use svg::{SvgStyle, write_svg};
pub use window::read_window;

use serde::{Deserialize, Serialize};

use crate::pattern::{Boundary, Domain, PatternError, PointPattern, Window};

/// Most bytes of a file. The largest pattern with eight attributes takes about 5 MB.
pub const MAX_BYTES: usize = 20_000_000;
/// Most bytes of a line of text.
pub const MAX_LINE_LENGTH: usize = 100_000;

/// What the caller knows better than the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// The rectangle, instead of what the file declares or its points suggest.
    pub domain: Option<Domain>,
    /// The boundary, instead of what the file declares.
    pub boundary: Option<Boundary>,
    /// Which columns of a table, members of records or properties of GeoJSON hold what, instead of what their names suggest.
    pub columns: ColumnChoice,
    /// Takes degrees of longitude and latitude as they are, instead of projecting them to metres.
    pub keeps_degrees: bool,
}

/// Which columns hold what, each told by its name, or by its number from 1 where no column is called so.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ColumnChoice {
    /// The column of x.
    pub x: Option<String>,
    /// The column of y.
    pub y: Option<String>,
    /// The column of classes; empty for none.
    pub class: Option<String>,
    /// The column of radii; of all others what there is is taken.
    pub radius: Option<String>,
    /// The columns that become attributes, each with the attribute's name, as in (`radius`, `crown_m`); all others are left
    /// out. `None` takes what there is.
    pub attributes: Option<Vec<(String, String)>>,
}

impl ColumnChoice {
    /// Whether anything is chosen.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// A column of a table, a member of records or a property of GeoJSON, as a person chooses among them.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Column {
    /// What it is called, or its number from 1.
    pub name: String,
    /// What it was taken for.
    pub role: ColumnRole,
    /// Its first values as they were written, at most three, each cut to 40 characters.
    pub examples: Vec<String>,
    /// Whether every value that is there is a number.
    pub is_numeric: bool,
}

/// What a column was taken for.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "kind", content = "name")]
pub enum ColumnRole {
    /// Positions along x.
    X,
    /// Positions along y.
    Y,
    /// Both, as in `POINT (1 2)`.
    Place,
    /// Classes.
    Class,
    /// The attribute of this name.
    Attribute(String),
    /// Nothing: it was left out.
    LeftOut,
}

impl ReadOptions {
    /// The pattern in the rectangle and with the boundary the caller knows.
    fn apply(&self, pattern: PointPattern) -> Result<PointPattern, PatternError> {
        let boundary = self.boundary.unwrap_or(pattern.boundary());
        let Some(domain) = self.domain else { return Ok(pattern.with_boundary(boundary)) };
        let mut moved = PointPattern::new(domain, pattern.positions().to_vec())?
            .with_boundary(boundary)
            .with_classes(pattern.classes().to_vec(), pattern.class_names().to_vec())?;
        for attribute in pattern.attributes() {
            moved = moved.with_attribute(attribute.clone())?;
        }
        Ok(moved)
    }
}

/// What a file turned out to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileFormat {
    /// Columns separated by tabs, semicolons or commas.
    Delimited,
    /// Columns separated by blanks.
    Text,
    /// The text of the method's public reference implementation.
    Reference,
    /// A pattern or a list of points.
    Json,
    /// A whole session.
    Project,
    /// Points in space, taken as planar.
    GeoJson,
    /// Marks of a drawing.
    Svg,
    /// A NumPy array, alone or in an archive.
    Npy,
    /// Blobs of a picture.
    Picture,
}

impl FileFormat {
    /// What a person calls it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Delimited => "CSV or TSV",
            Self::Text => "text in columns",
            Self::Reference => "text of the reference implementation",
            Self::Json => "JSON",
            Self::Project => "Pointweave project",
            Self::GeoJson => "GeoJSON",
            Self::Svg => "SVG",
            Self::Npy => "NumPy array",
            Self::Picture => "picture",
        }
    }
}

/// A file as it was understood.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// What it is.
    pub format: FileFormat,
    /// Its points; of a project the exemplar.
    pub pattern: PointPattern,
    /// Whether the file or the caller told the domain; otherwise it was found from the points.
    pub is_domain_declared: bool,
    /// Other rectangles that the points may have been cut from, with a word for each; none where the domain was declared.
    pub domains: Vec<(&'static str, Domain)>,
    /// The outline within the rectangle that the points were cut from, where the file has one.
    pub window: Option<Window>,
    /// What there was to choose from, of a table, records or GeoJSON.
    pub columns: Vec<Column>,
    /// How the file named and placed things.
    pub origin: Origin,
    /// What was left out or changed.
    pub notes: Vec<Note>,
    /// What else a project holds.
    pub project: Option<Project>,
}

impl Reading {
    fn new(format: FileFormat, pattern: PointPattern) -> Self {
        Self {
            format,
            pattern,
            is_domain_declared: false,
            domains: Vec::new(),
            window: None,
            columns: Vec::new(),
            origin: Origin::default(),
            notes: Vec::new(),
            project: None,
        }
    }
}

/// Reads a pattern; see the module's words on formats, columns and the domain. The file's name only helps where the
/// bytes leave a doubt. Of a project it is the exemplar.
///
/// # Errors
/// With the place, the value and what is allowed.
pub fn read(bytes: &[u8], file_name: Option<&str>, options: &ReadOptions) -> Result<PointPattern, FormatError> {
    open(bytes, file_name, options).map(|reading| reading.pattern)
}

/// Reads a pattern and tells what the file turned out to be.
///
/// # Errors
/// Those of [`read`].
pub fn open(bytes: &[u8], file_name: Option<&str>, options: &ReadOptions) -> Result<Reading, FormatError> {
    if bytes.len() > MAX_BYTES {
        return Err(FormatError::TooLarge { bytes: bytes.len(), max: MAX_BYTES });
    }
    if bytes.starts_with(npy::MAGIC) {
        return npy::read(bytes, options);
    }
    if npz::is_zip(bytes) {
        return npz::read(bytes, options);
    }
    if let Some(kind) = picture_kind(bytes) {
        #[cfg(not(target_arch = "wasm32"))]
        if bytes.starts_with(png::MAGIC) {
            let picture = png::decode(bytes)?;
            return find_blobs(&picture, &BlobOptions::default(), options).map(|blobs| blobs.reading);
        }
        return Err(FormatError::Picture { kind });
    }
    if let Some(kind) = foreign(bytes) {
        return Err(FormatError::Kind { kind });
    }
    let mut notes = Vec::new();
    let text = text::decode(bytes, &mut notes)?;
    let mut reading = open_text(&text, file_name, options)?;
    reading.notes.splice(0..0, notes);
    Ok(reading)
}

fn open_text(text: &str, file_name: Option<&str>, options: &ReadOptions) -> Result<Reading, FormatError> {
    let named_json = file_name
        .and_then(|name| name.rsplit_once('.'))
        .is_some_and(|(_, extension)| extension.eq_ignore_ascii_case("json"));
    if text.trim().is_empty() {
        return Err(FormatError::NoPoints);
    }
    if text.trim_start_matches(|c: char| c.is_whitespace() || c == json::RECORD_SEPARATOR).starts_with(['{', '['])
        || named_json
    {
        return json::read(text, options);
    }
    if text.trim_start().starts_with('<') {
        return if text.contains("<svg") || text.contains(":svg") {
            svg_points::read(text, options)
        } else {
            Err(FormatError::Kind { kind: "XML or HTML" })
        };
    }
    for (index, line) in text.lines().enumerate() {
        if line.len() > MAX_LINE_LENGTH {
            return Err(FormatError::LongLine { line: index + 1, length: line.len(), max: MAX_LINE_LENGTH });
        }
    }
    if let Some(table) = reference::read(text) {
        return table?.into_reading(FileFormat::Reference, options);
    }
    // Excel's first line may name the separator.
    let (delimiter, text, first_line) = match delimited::named_separator(text) {
        Some((delimiter, rest)) => (Some(delimiter), rest, 2),
        None => (delimited::separator(text), text, 1),
    };
    match delimiter {
        Some(delimiter) => delimited::read(text, delimiter, first_line)?.into_reading(FileFormat::Delimited, options),
        None => whitespace::read(text, first_line)?.into_reading(FileFormat::Text, options),
    }
}

/// Names pictures.
fn picture_kind(bytes: &[u8]) -> Option<&'static str> {
    if bytes.get(..4) == Some(b"RIFF") && bytes.get(8..12) == Some(b"WEBP") {
        return Some("a WebP picture");
    }
    if bytes.get(4..12).is_some_and(|start| start == b"ftypavif" || start == b"ftypavis") {
        return Some("an AVIF picture");
    }
    let known: [(&[u8], &str); 3] =
        [(b"\x89PNG", "a PNG picture"), (b"\xff\xd8\xff", "a JPEG picture"), (b"GIF8", "a GIF picture")];
    known.iter().find(|(start, _)| bytes.starts_with(start)).map(|&(_, kind)| kind)
}

/// Names well-known files that are not patterns, instead of complaining about their first byte.
fn foreign(bytes: &[u8]) -> Option<&'static str> {
    let known: [(&[u8], &str); 2] = [(b"%PDF", "a PDF document"), (b"\x1f\x8b", "a gzip archive")];
    known.iter().find(|(start, _)| bytes.starts_with(start)).map(|&(_, kind)| kind)
}
