//! Comma, semicolon and tab: reading by the `csv` crate, and our own CSV.

use super::Origin;
use super::declaration::{Declared, domain_line, number_text};
use super::error::FormatError;
use super::table::{ATTRIBUTE_PREFIX, Row, RowPlace, Table};
use crate::pattern::PointPattern;

/// Reads delimited text. A decimal comma is understood where the comma does not separate columns.
pub(super) fn read(text: &str, delimiter: u8) -> Result<Table, FormatError> {
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(delimiter)
        .has_headers(false)
        .flexible(true)
        .comment(Some(b'#'))
        .from_reader(text.as_bytes());
    let mut table = Table::new(Declared::default());
    table.decimal_comma = delimiter != b',';
    let mut cursor = Cursor { text, offset: 0, line: 1 };
    let mut record = csv::StringRecord::new();
    loop {
        let more = reader.read_record(&mut record).map_err(|error| FormatError::Syntax {
            line: cursor.line,
            column: 1,
            message: error.to_string(),
        })?;
        if !more {
            cursor.skip_to_record(text.len(), &mut table.declared)?;
            return Ok(table);
        }
        let start = record.position().map_or(0, |position| position.byte() as usize);
        let line = cursor.skip_to_record(start, &mut table.declared)?;
        table.push(Row { place: RowPlace::Line(line), cells: record.iter().map(str::to_owned).collect() })?;
    }
}

/// Follows the reader through the text: it skips comments and blank lines silently, and its own line number is that
/// of the first line it skipped.
struct Cursor<'a> {
    text: &'a str,
    offset: usize,
    line: usize,
}

impl Cursor<'_> {
    /// Moves to byte `start`, then over comments (taken in) and blank lines; returns the line it stops at.
    fn skip_to_record(&mut self, start: usize, declared: &mut Declared) -> Result<usize, FormatError> {
        let bytes = self.text.as_bytes();
        while self.offset < start.min(bytes.len()) {
            self.step();
        }
        loop {
            match bytes.get(self.offset) {
                Some(b'\r' | b'\n') => self.step(),
                Some(b'#') => {
                    let rest = &self.text[self.offset + 1..];
                    // The reader ends a comment at a line feed only.
                    let comment = rest.split('\n').next().unwrap_or_default();
                    declared.comment(self.line, comment.trim_end_matches('\r'))?;
                    self.offset += 1 + comment.len();
                }
                _ => return Ok(self.line),
            }
        }
    }

    /// One byte on; a line ends at `\n`, and at a `\r` that no `\n` follows.
    fn step(&mut self) {
        let bytes = self.text.as_bytes();
        let ends = match bytes[self.offset] {
            b'\n' => true,
            b'\r' => bytes.get(self.offset + 1) != Some(&b'\n'),
            _ => false,
        };
        self.line += usize::from(ends);
        self.offset += 1;
    }
}

/// Writes a pattern as CSV that reads back as the same pattern, digit by digit: a comment line with the domain, a
/// header, then one row a point. The class column is left out where there is only the default class.
#[must_use]
pub fn write_csv(pattern: &PointPattern) -> String {
    write_csv_like(pattern, &Origin::default())
}

/// The same with the columns named as those of the exemplar's file were, units included.
#[must_use]
pub fn write_csv_like(pattern: &PointPattern, origin: &Origin) -> String {
    let mut text = domain_line(pattern.domain(), pattern.boundary());
    text.push('\n');
    let names = pattern.class_names();
    let with_class = names != ["points"];
    if with_class && !order_shows(pattern) {
        text.push_str("# classes: ");
        push_row(&mut text, names, ',');
    }
    push_table(&mut text, pattern, with_class, ',', origin);
    text
}

/// Writes a pattern as cells for the clipboard: a header, then one row a point, separated by tabs. A spreadsheet would
/// take a comment for a cell, so the domain and classes without points are left out.
#[must_use]
pub fn write_tsv(pattern: &PointPattern) -> String {
    let mut text = String::new();
    push_table(&mut text, pattern, pattern.class_names() != ["points"], '\t', &Origin::default());
    text
}

fn push_table(text: &mut String, pattern: &PointPattern, with_class: bool, delimiter: char, origin: &Origin) {
    let names = pattern.class_names();
    let mut cells: Vec<String> = match &origin.axes {
        Some(axes) => axes.to_vec(),
        None => vec!["x".to_owned(), "y".to_owned()],
    };
    if with_class {
        cells.push(origin.class.clone().unwrap_or_else(|| "class".to_owned()));
    }
    cells.extend(pattern.attributes().iter().map(|attribute| match origin.header(&attribute.name) {
        header if header == attribute.name => header_name(header),
        header => header.to_owned(),
    }));
    push_row(text, &cells, delimiter);
    for (i, position) in pattern.positions().iter().enumerate() {
        cells.clear();
        cells.extend([number_text(position.x), number_text(position.y)]);
        if with_class {
            cells.push(names[usize::from(pattern.classes()[i])].clone());
        }
        cells.extend(pattern.attributes().iter().map(|attribute| number_text(attribute.values[i])));
        push_row(text, &cells, delimiter);
    }
}

/// Whether the rows alone tell the classes and their order: each appears, in order, and has no blanks at its ends.
fn order_shows(pattern: &PointPattern) -> bool {
    let mut seen = 0;
    for &class in pattern.classes() {
        if usize::from(class) > seen {
            return false;
        }
        seen = seen.max(usize::from(class) + 1);
    }
    seen == pattern.class_names().len() && pattern.class_names().iter().all(|name| name.trim() == name)
}

/// An attribute's name as it stands in a header.
fn header_name(name: &str) -> String {
    let reserved = ["x", "y", "class"].iter().any(|word| name.trim().eq_ignore_ascii_case(word));
    if reserved || name.trim() != name || name.starts_with(ATTRIBUTE_PREFIX) {
        format!("{ATTRIBUTE_PREFIX}{name}")
    } else {
        name.to_owned()
    }
}

fn push_row(text: &mut String, cells: &[String], delimiter: char) {
    for (i, cell) in cells.iter().enumerate() {
        if i > 0 {
            text.push(delimiter);
        }
        if cell.contains([',', '"', '#', '\n', '\r', ';', '\t', ' ']) {
            text.push('"');
            text.push_str(&cell.replace('"', "\"\""));
            text.push('"');
        } else {
            text.push_str(cell);
        }
    }
    text.push('\n');
}
