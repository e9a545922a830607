//! Columns separated by blanks, `#` starts a comment.

use super::declaration::Declared;
use super::error::FormatError;
use super::table::{Row, RowPlace, Table};

/// Reads whitespace-separated text.
pub(super) fn read(text: &str) -> Result<Table, FormatError> {
    let mut table = Table::new(Declared::default());
    for (index, line) in text.lines().enumerate() {
        let (data, comment) = split_comment(line);
        if let Some(comment) = comment {
            table.declared.comment(index + 1, comment)?;
        }
        let cells = data.split_whitespace().map(str::to_owned).collect();
        table.push(Row { place: RowPlace::Line(index + 1), cells })?;
    }
    Ok(table)
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
