//! What can be wrong with a file, in words that name the place, the value and what is allowed.

use std::fmt;

use thiserror::Error;

use super::Column;
use crate::pattern::PatternError;

/// Where in the input a value stands. Everything is counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Line and column (field) of a text file.
    Line {
        /// The line.
        line: usize,
        /// The field within the line.
        column: usize,
    },
    /// An entry of the list of points in a JSON file or of a NumPy array.
    Entry {
        /// The entry of the list.
        entry: usize,
        /// The value within the entry.
        value: usize,
        /// Line and character where the entry begins, in a file of text.
        at: Option<(usize, usize)>,
    },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line { line, column } => write!(f, "line {line}, column {column}"),
            Self::Entry { entry, value, at: None } => write!(f, "point {entry} of the list, value {value}"),
            Self::Entry { entry, value, at: Some((line, column)) } => {
                write!(f, "line {line}, column {column} (point {entry} of the list, value {value})")
            }
        }
    }
}

/// Why a file was refused.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FormatError {
    /// More bytes than the cap.
    #[error("the file has {bytes} bytes; at most {max} are allowed")]
    TooLarge {
        /// How many there are.
        bytes: usize,
        /// How many are allowed.
        max: usize,
    },
    /// A known kind of file that is not read.
    #[error(
        "this is {kind}; what can be read is CSV, TSV, whitespace-separated text, JSON, GeoJSON, SVG, NumPy arrays and \
         pictures"
    )]
    Kind {
        /// What it looks like.
        kind: &'static str,
    },
    /// A picture in a format that only a browser decodes here: its pixels can be given to
    /// [`find_blobs`](super::find_blobs).
    #[error("this is {kind}; save it as PNG, so that its points can be looked for")]
    Picture {
        /// What it looks like.
        kind: &'static str,
    },
    /// A picture that can't be decoded, or shows no points.
    #[error("the picture can't be used: {reason}")]
    Pixels {
        /// What is wrong with it.
        reason: String,
    },
    /// A NumPy array of another shape or type.
    #[error("the NumPy array can't be used: {reason} (byte {byte} of the file)")]
    Array {
        /// What is wrong with it.
        reason: String,
        /// Where, counted from 0.
        byte: usize,
    },
    /// An archive of NumPy arrays that can't be read, or none of whose arrays is the one with the points.
    #[error("the NumPy archive can't be used: {reason}")]
    Archive {
        /// What is wrong with it.
        reason: String,
    },
    /// Bytes that are not UTF-8.
    #[error("line {line}, column {column}: byte {byte:#04x} is not UTF-8; save the file as UTF-8 text")]
    NotUtf8 {
        /// The line.
        line: usize,
        /// Character in the line.
        column: usize,
        /// The first offending byte.
        byte: u8,
    },
    /// A line longer than the cap.
    #[error("line {line} has {length} bytes; at most {max} are allowed")]
    LongLine {
        /// The line.
        line: usize,
        /// Its length.
        length: usize,
        /// The longest allowed.
        max: usize,
    },
    /// Nothing but comments and blank lines, or an empty list.
    #[error("there are no points in it; at least 1 is needed, as 'x y', 'x,y' or [[x, y]]")]
    NoPoints,
    /// More points or columns than the cap.
    #[error("{place}: there are more than {max} {what}; at most {max} are allowed")]
    TooMany {
        /// Where the cap was passed.
        place: Place,
        /// Points, columns or classes.
        what: &'static str,
        /// How many are allowed.
        max: usize,
    },
    /// One value that can't be used.
    #[error("{place}: {name} is {value:?}, but must be {allowed}")]
    Value {
        /// Where it stands.
        place: Place,
        /// The column's name.
        name: String,
        /// The offending text, cut when long.
        value: String,
        /// What is allowed.
        allowed: String,
    },
    /// A position outside the domain that was declared.
    #[error("{place}: the point ({}, {}) lies outside the declared domain ({}, {}) – ({}, {})", at[0], at[1], min[0], min[1], max[0], max[1])]
    Outside {
        /// Where it stands.
        place: Place,
        /// The position.
        at: [f64; 2],
        /// Lower corner of the domain.
        min: [f64; 2],
        /// Upper corner of the domain.
        max: [f64; 2],
    },
    /// A row with too few or too many values.
    #[error("{place}: the row has {found} values, but {expected} are needed")]
    Columns {
        /// Where the row ends.
        place: Place,
        /// How many values it has.
        found: usize,
        /// How many are needed.
        expected: String,
    },
    /// A header without the positions.
    #[error(
        "line {line}: no column is called '{name}', nor anything like it; the columns are called {found}: choose those of x \
         and y in the import dialog or with --columns x=…,y=…"
    )]
    MissingColumn {
        /// The line of the header.
        line: usize,
        /// The name that is missing.
        name: &'static str,
        /// What the header holds.
        found: String,
    },
    /// A header that names a column twice.
    #[error("{place}: another column is called {name:?} too; every column needs its own name")]
    DuplicateColumn {
        /// Where the second one stands.
        place: Place,
        /// The name.
        name: String,
    },
    /// A column that was asked for and is not there.
    #[error("no column is called {name:?}; the columns are called {found}")]
    NoColumn {
        /// What was asked for.
        name: String,
        /// What there is.
        found: String,
    },
    /// A column that was asked for twice.
    #[error("the column {name:?} is chosen twice; a column can hold one thing")]
    ColumnTwice {
        /// What was asked for.
        name: String,
    },
    /// What is wrong with a table whose columns are known, so that others can be chosen.
    #[error("{error}")]
    Table {
        /// What is wrong.
        error: Box<FormatError>,
        /// What there is to choose from.
        columns: Vec<Column>,
    },
    /// A declaration that names a class twice.
    #[error("{place}: another class is called {name:?} too; every class needs its own name")]
    DuplicateClass {
        /// Where the second one stands.
        place: Place,
        /// The name.
        name: String,
    },
    /// A domain that can't be used.
    #[error("line {line}: the domain {value:?} can't be used: {reason}")]
    Declaration {
        /// The line.
        line: usize,
        /// What was declared.
        value: String,
        /// What is wrong with it.
        reason: String,
    },
    /// No domain was declared, and the points do not tell one.
    #[error("the points tell no domain: {reason}; declare one with a line '# domain x0 y0 x1 y1'")]
    NoDomain {
        /// Why not.
        reason: String,
    },
    /// Text that does not parse, or JSON without a layout that is known.
    #[error("{}{message}", match line { 0 => String::new(), line => format!("line {line}, column {column}: ") })]
    Syntax {
        /// Line, or 0 when unknown.
        line: usize,
        /// Character in the line.
        column: usize,
        /// What is wrong.
        message: String,
    },
    /// The values are each fine, but together no pattern.
    #[error(transparent)]
    Pattern(#[from] PatternError),
}

impl FormatError {
    /// The same with the columns of the table it is about.
    pub(super) fn with_columns(self, columns: &[Column]) -> Self {
        match self {
            // Nothing that other columns would change.
            Self::NoPoints | Self::Table { .. } => self,
            error if columns.is_empty() => error,
            error => Self::Table { error: Box::new(error), columns: columns.to_vec() },
        }
    }

    /// The columns of the table it is about, where there is one.
    #[must_use]
    pub fn columns(&self) -> &[Column] {
        match self {
            Self::Table { columns, .. } => columns,
            _ => &[],
        }
    }

    /// The line and, when one is known, the column, both from 1.
    #[must_use]
    pub fn position(&self) -> Option<(usize, Option<usize>)> {
        match *self {
            Self::Table { ref error, .. } => error.position(),
            Self::TooMany { place, .. }
            | Self::Value { place, .. }
            | Self::Outside { place, .. }
            | Self::Columns { place, .. }
            | Self::DuplicateColumn { place, .. }
            | Self::DuplicateClass { place, .. } => match place {
                Place::Line { line, column } | Place::Entry { at: Some((line, column)), .. } => {
                    Some((line, Some(column)))
                }
                Place::Entry { at: None, .. } => None,
            },
            Self::Syntax { line, column, .. } if line > 0 => Some((line, Some(column))),
            Self::NotUtf8 { line, column, .. } => Some((line, Some(column))),
            Self::LongLine { line, .. } | Self::MissingColumn { line, .. } | Self::Declaration { line, .. } => {
                Some((line, None))
            }
            _ => None,
        }
    }
}

/// Line and character, from 1, of these bytes of the text. They must be in ascending order.
pub(super) fn places(text: &str, bytes: impl IntoIterator<Item = usize>) -> Vec<(usize, usize)> {
    let (mut line, mut column, mut from) = (1, 1, 0);
    bytes
        .into_iter()
        .map(|byte| {
            let passed = text.get(from..byte).unwrap_or_default();
            from = byte;
            line += passed.bytes().filter(|&byte| byte == b'\n').count();
            column = match passed.rsplit_once('\n') {
                Some((_, rest)) => 1 + rest.chars().count(),
                None => column + passed.chars().count(),
            };
            (line, column)
        })
        .collect()
}

/// The same of one byte.
pub(super) fn place(text: &str, byte: usize) -> (usize, usize) {
    places(text, [byte]).first().copied().unwrap_or((1, 1))
}

/// A piece of input as it may stand in a message: at most 40 characters.
pub(super) fn clip(text: &str) -> String {
    match text.char_indices().nth(40) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
