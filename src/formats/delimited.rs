//! Comma, semicolon, tab and bar: reading by the `csv` crate, and our own CSV.

use super::column_names::{self, normalized};
use super::declaration::{Declared, domain_line, number_text};
use super::error::FormatError;
use super::number::{self, Comma, is_missing};
use super::table::{ATTRIBUTE_PREFIX, Row, RowPlace, Table};
use super::{Origin, Projection, whitespace};
use crate::pattern::{Domain, PointPattern};

/// How many lines of data are looked at to tell what parts the columns.
const LOOKED_AT: usize = 50;

/// The separator that the first line `sep=;` names, as Excel understands it, and the text behind that line.
pub(super) fn named_separator(text: &str) -> Option<(u8, &str)> {
    let (first, rest) = text.split_once('\n')?;
    let first = first.trim_end_matches([',', ';']).trim_matches('"');
    let sign = first.get(..4).filter(|start| start.eq_ignore_ascii_case("sep="))?;
    // `sep=,` and `sep=;` lose their sign to the trimming above.
    let named = text.get(text.find(sign)? + 4..)?.chars().next()?;
    matches!(named, ',' | ';' | '\t' | '|').then_some((named as u8, rest))
}

/// What parts the columns; `None` is blanks.
pub(super) fn separator(text: &str) -> Option<u8> {
    let lines: Vec<String> = text
        .lines()
        .filter(|line| !line.trim().is_empty() && !line.starts_with('#'))
        .take(LOOKED_AT)
        // Separators within quotes don't count.
        .map(|line| line.split('"').step_by(2).collect())
        .collect();
    // Where every row begins with the sign of a comment, they are what there is to look at.
    let commented: Vec<String>;
    let lines = if lines.len() <= 1 && text.lines().filter(|line| line.starts_with('#')).count() > 1 {
        commented = text.lines().filter(|line| !line.trim().is_empty()).take(LOOKED_AT).map(str::to_owned).collect();
        commented.as_slice()
    } else {
        lines.as_slice()
    };
    let most = |sign: char| 2 * lines.iter().filter(|line| line.trim().contains(sign)).count() > lines.len();
    let sign = ['\t', ';', ',', '|'].into_iter().find(|&sign| most(sign))?;
    // `6,86 5`: blanks part the columns, and commas are decimal points.
    if sign == ',' && lines.iter().all(|line| is_decimal_commas(line) || !line.contains(',')) {
        return None;
    }
    Some(sign as u8)
}

/// Whether a line is two and more words parted by blanks, of which the first two are numbers with at most one comma each.
fn is_decimal_commas(line: &str) -> bool {
    let (cells, _) = whitespace::cells(line);
    let is_number = |cell: &&str| number::parse(cell, Comma::Decimal).is_some();
    cells.len() >= 2 && cells.iter().filter(|cell| cell.contains(',')).all(is_number)
}

/// Reads delimited text, whose first line has this number.
pub(super) fn read(text: &str, delimiter: u8, first_line: usize) -> Result<Table, FormatError> {
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(delimiter)
        .has_headers(false)
        .flexible(true)
        .comment(Some(b'#'))
        .from_reader(text.as_bytes());
    let mut table = Table::new(Declared::default());
    table.delimiter = Some(delimiter);
    let mut cursor = Cursor { text, offset: 0, line: first_line };
    let mut record = csv::StringRecord::new();
    loop {
        // Where the last record ended: comments and blank lines may follow, at the end of the file too.
        let start = reader.position().byte() as usize;
        let more = reader.read_record(&mut record).map_err(|error| FormatError::Syntax {
            line: cursor.line,
            column: 1,
            message: error.to_string(),
        })?;
        let line = cursor.skip_to_record(start, &mut table)?;
        if !more {
            table.comma = comma(&table, delimiter);
            return Ok(table);
        }
        table.push(Row { place: RowPlace::Line(line), cells: record.clone() })?;
    }
}

/// What a comma in a number is. Where commas part the columns it stands within quotes, and only what leaves no doubt is
/// taken for a decimal point: `6,86` is one, `1,234` may part thousands.
fn comma(table: &Table, delimiter: u8) -> Comma {
    let (mut decimal, mut thousands) = (false, false);
    for cell in table.rows.iter().flat_map(|row| row.cells.iter()).filter(|cell| cell.contains(',')) {
        let cell = cell.trim();
        let grouped = number::is_grouped(cell);
        let is_decimal = number::parse(cell, Comma::Decimal).is_some();
        decimal |= is_decimal && !grouped;
        thousands |= grouped && !is_decimal && number::parse(cell, Comma::Thousands).is_some();
    }
    match (decimal, thousands) {
        (true, false) => Comma::Decimal,
        (false, true) => Comma::Thousands,
        // Where commas part no columns, a comma was always a decimal point.
        _ if delimiter != b',' => Comma::Decimal,
        _ => Comma::None,
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
    fn skip_to_record(&mut self, start: usize, table: &mut Table) -> Result<usize, FormatError> {
        let bytes = self.text.as_bytes();
        while self.offset < start.min(bytes.len()) {
            self.step();
        }
        loop {
            match bytes.get(self.offset) {
                Some(b'\n') => self.step(),
                Some(b'#') => {
                    let comment = self.text[self.offset + 1..].split('\n').next().unwrap_or_default();
                    table.comment(self.line, comment)?;
                    self.offset += 1 + comment.len();
                }
                _ => return Ok(self.line),
            }
        }
    }

    /// One byte on.
    fn step(&mut self) {
        self.line += usize::from(self.text.as_bytes()[self.offset] == b'\n');
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
    let mut text = match placed_domain(pattern, origin) {
        Some(domain) => domain_line(domain, pattern.boundary()) + "\n",
        None => String::new(),
    };
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

/// The domain as it is written: in degrees where the exemplar's file was; none where it would be too long and narrow in degrees.
fn placed_domain(pattern: &PointPattern, origin: &Origin) -> Option<Domain> {
    let domain = pattern.domain();
    let degrees = |projection: Projection| {
        Domain::spanning(projection.unproject(domain.min()), projection.unproject(domain.max()))
    };
    match origin.projection {
        Some(projection) => degrees(projection).ok(),
        None => Some(domain),
    }
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
    let domain = placed_domain(pattern, origin);
    for (i, position) in pattern.positions().iter().enumerate() {
        cells.clear();
        // Rounding must leave no point outside of the domain.
        let place = |projection: Projection| {
            let degrees = projection.unproject(*position);
            domain.map_or(degrees, |domain| degrees.clamp(domain.min(), domain.max()))
        };
        let [x, y] = origin.projection.map_or(*position, place).to_array();
        cells.extend([number_text(x), number_text(y)]);
        if with_class {
            cells.push(names[usize::from(pattern.classes()[i])].clone());
        }
        cells.extend(pattern.attributes().iter().map(|attribute| number_text(attribute.values[i])));
        push_row(text, &cells, delimiter);
    }
}

/// Whether the rows alone tell the classes and their order: each appears, in order, and is read as it is written.
fn order_shows(pattern: &PointPattern) -> bool {
    let mut seen = 0;
    for &class in pattern.classes() {
        if usize::from(class) > seen {
            return false;
        }
        seen = seen.max(usize::from(class) + 1);
    }
    seen == pattern.class_names().len()
        && pattern
            .class_names()
            .iter()
            .all(|name| name.trim() == name && normalized(name) == *name && !is_missing(name))
}

/// An attribute's name as it stands in a header: with a prefix where the name alone would say something else.
fn header_name(name: &str) -> String {
    if name.trim() != name || name.starts_with(ATTRIBUTE_PREFIX) || column_names::is_telling(name) {
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
        if cell.contains([',', '"', '#', '\n', '\r', ';', '\t', ' ']) || cell.starts_with(['{', '[', '<']) {
            text.push('"');
            text.push_str(&cell.replace('"', "\"\""));
            text.push('"');
        } else {
            text.push_str(cell);
        }
    }
    text.push('\n');
}
