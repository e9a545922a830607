//! Columns separated by blanks, `#` starts a comment.

use super::declaration::Declared;
use super::error::FormatError;
use super::number::Comma;
use super::table::{Row, RowPlace, Table};

/// Reads whitespace-separated text.
pub(super) fn read(text: &str, first_line: usize) -> Result<Table, FormatError> {
    let mut table = Table::new(Declared::default());
    table.comma = Comma::Decimal;
    for (index, line) in text.lines().enumerate() {
        let line_number = first_line + index;
        let (found, comment) = cells(line);
        if let Some(comment) = comment {
            if found.is_empty() {
                table.comment(line_number, comment)?;
            } else {
                // Behind a row it can only declare.
                table.declared.comment(line_number, comment)?;
            }
        }
        table.push(Row::new(RowPlace::Line(line_number), found))?;
    }
    Ok(table)
}

/// A line's cells and its comment. Blanks within double quotes part nothing, as R writes names.
pub(super) fn cells(line: &str) -> (Vec<&str>, Option<&str>) {
    let mut cells = Vec::new();
    let mut rest = line.trim_start();
    while let Some(first) = rest.chars().next() {
        if first == '#' {
            return (cells, Some(&rest[1..]));
        }
        let quoted = rest.strip_prefix('"').and_then(|inner| {
            let end = inner.find('"')?;
            // What goes on behind the quotes is no quoted cell.
            let after = &inner[end + 1..];
            (after.is_empty() || after.starts_with(char::is_whitespace)).then(|| (&inner[..end], after))
        });
        let (cell, after) =
            quoted.unwrap_or_else(|| rest.split_at(rest.find(char::is_whitespace).unwrap_or(rest.len())));
        cells.push(cell);
        rest = after.trim_start();
    }
    (cells, None)
}

/// A line's data and comment. A `#` inside a word belongs to the word.
pub(super) fn split_comment(line: &str) -> (&str, Option<&str>) {
    let start = line
        .match_indices('#')
        .map(|(at, _)| at)
        .find(|&at| line[..at].chars().next_back().is_none_or(char::is_whitespace));
    match start {
        Some(at) => (&line[..at], Some(&line[at + 1..])),
        None => (line, None),
    }
}
