//! The header of a table: where it is, and what stands before and after it.

use super::column_names::{self, Sureness};
use super::error::clip;
use super::note::counted;
use super::number::{self, is_missing};
use super::table::{Comment, Row, RowPlace, Table};
use super::whitespace;
use super::{Note, ReadOptions};

/// How many rows may stand before the header.
const MAX_TITLES: usize = 20;
/// How many rows of names and units may stand below it: TrackMate writes three.
const MAX_ROWS_BELOW: usize = 4;

/// The names of the columns.
#[derive(Clone, Debug)]
pub(super) struct Header {
    /// One name a column, as it was written but for its Unicode form; empty where there is none.
    pub(super) names: Vec<String>,
    /// Units, where a row below the names holds them; as many as there are names, or none.
    pub(super) units: Vec<String>,
    /// Where it stands.
    pub(super) place: RowPlace,
}

impl Header {
    fn of(row: &Row) -> Self {
        Self { names: row.cells.iter().map(column_names::normalized).collect(), units: Vec::new(), place: row.place }
    }

    fn trimmed(&self) -> Vec<&str> {
        self.names.iter().map(|name| name.trim()).collect()
    }

    /// Whether the names leave no doubt that they are names: they say where x and y are.
    fn is_sure(names: &[&str]) -> bool {
        column_names::place_columns(names).is_some_and(|(_, sureness)| sureness <= Sureness::Degrees)
            || names.iter().any(|name| column_names::is_geometry(name))
    }
}

impl Table {
    /// Takes the header off the rows, and with it what stands before it and does not belong to the table; none where the rows
    /// begin with points.
    pub(super) fn take_header(&mut self, options: &ReadOptions) -> Option<Header> {
        if let Some(names) = self.header.take() {
            let place = self.rows.first().map_or(RowPlace::Entry(1, None), |row| row.place);
            let names = names.iter().map(|name| column_names::normalized(name)).collect();
            return Some(Header { names, units: Vec::new(), place });
        }
        self.take_count();
        let mut header = self.find_header(options);
        self.take_commented_rows(header.as_ref());
        if let Some(header) = &mut header {
            self.name_row_names(header);
            self.take_units(header);
            self.take_repeated(header);
            while header.names.len() > 2
                && header.names.last().is_some_and(|name| name.trim().is_empty())
                && self.rows.iter().all(|row| row.width() < header.names.len())
            {
                header.names.pop();
            }
        }
        header
    }

    /// Files of points may begin with how many there are.
    fn take_count(&mut self) {
        let [first, second, ..] = self.rows.as_slice() else { return };
        let count: Option<usize> = if first.width() == 1 { first.cell(0).parse().ok() } else { None };
        let (Some(count), true) = (count, second.width() > 1) else { return };
        let (line, rows) = (first.place.name(), self.rows.len() - 1);
        let but = if count == rows { String::new() } else { format!(", but there are {rows} rows") };
        self.notes.push(Note::changed(format!("The {count} {line} was taken for the number of points{but}.")));
        self.rows.remove(0);
    }

    /// The first row that is a header: among the first ones the one that names x and y, else the first when it holds words.
    fn find_header(&mut self, options: &ReadOptions) -> Option<Header> {
        let is_data = |row: &Row| row.width() >= 2 && (0..2).all(|column| self.parse(row.cell(column)).is_some());
        let sure = self
            .rows
            .iter()
            .take(MAX_TITLES)
            .take_while(|row| !is_data(row))
            .position(|row| Header::is_sure(&row.cells.iter().map(str::trim).collect::<Vec<_>>()));
        if let Some(at) = sure {
            let mut header = Header::of(&self.rows[at]);
            if at > 0 && self.rows[at - 1].width() >= header.names.len().min(2) {
                header.combine(&self.rows[at - 1]);
            }
            if at > 0 {
                let text = match at {
                    1 => format!("The row {}, before the header, was left out.", self.rows[0].place.name()),
                    _ => {
                        format!("{at} rows before the header, the first {}, were left out.", self.rows[0].place.name())
                    }
                };
                self.notes.push(Note::left_out(text));
            }
            self.rows.drain(..=at);
            return Some(header);
        }
        let first = self.rows.first()?;
        let is_word = |column: usize| {
            let cell = first.cell(column);
            !cell.is_empty() && self.parse(cell).is_none() && !is_missing(cell)
        };
        // A column of row names has no name of its own.
        let is_header = is_word(0) && is_word(1) || first.cell(0).is_empty() && is_word(1) && is_word(2);
        // pandas numbers columns: `,0,1`.
        let numbered = first.cell(0).is_empty()
            && first.width() >= 3
            && (1..first.width()).all(|column| first.cell(column) == (column - 1).to_string());
        let chosen = [&options.columns.x, &options.columns.y];
        let asked = chosen.into_iter().flatten().all(|name| first.cells.iter().any(|cell| cell.trim() == name.trim()))
            && options.columns.x.is_some();
        if is_header || numbered || asked {
            let mut header = Header::of(first);
            if numbered {
                header.names[1] = "x".to_owned();
                header.names[2] = "y".to_owned();
            }
            self.rows.remove(0);
            return Some(header);
        }
        self.commented_header()
    }

    /// `# id x y` above the first row, as wide as it is.
    fn commented_header(&self) -> Option<Header> {
        let width = self.rows.first()?.cells.len();
        let mut above = self.comments.iter().rev().filter(|comment| comment.before == 0);
        above.find_map(|comment| {
            // Parted as the rows are, else by blanks, else by the usual signs.
            let signs = [self.delimiter, None, Some(b','), Some(b';'), Some(b'\t')];
            signs.into_iter().map(|sign| split_by(&comment.text, sign)).find_map(|names| {
                let trimmed: Vec<&str> = names.iter().map(|name| name.trim()).collect();
                (names.len() == width && Header::is_sure(&trimmed)).then(|| Header {
                    names: names.iter().map(|name| column_names::normalized(name)).collect(),
                    units: Vec::new(),
                    place: RowPlace::Line(comment.line),
                })
            })
        })
    }

    /// The cells of a comment, parted as the rows are.
    fn split(&self, text: &str) -> Vec<String> {
        split_by(text, self.delimiter)
    }

    /// Rows that begin with `#` and are none the less data: tags or colours in a column that is no number.
    fn take_commented_rows(&mut self, header: Option<&Header>) {
        if self.comments.is_empty() {
            return;
        }
        let places = header.and_then(|header| column_names::place_columns(&header.trimmed()));
        // With a header it says where x and y are; without, they follow the tag.
        let width =
            header.map_or_else(|| self.rows.first().map(|row| row.cells.len()), |header| Some(header.names.len()));
        let [x, y] = places.map_or([1, 2], |(columns, _)| columns);
        let is_row = |comment: &Comment| -> Option<Row> {
            let line = format!("#{}", comment.text);
            let cells = match self.delimiter {
                Some(_) => self.split(&line),
                None => line.split_whitespace().map(str::to_owned).collect(),
            };
            let row = Row::new(RowPlace::Line(comment.line), &cells);
            let fits = width.map_or(cells.len() >= 3, |width| cells.len() == width);
            if fits && number::begins_with_error(&comment.text) {
                return Some(row);
            }
            let has_place = [x, y].iter().all(|&column| self.parse(row.cell(column)).is_some());
            (fits && has_place).then_some(row)
        };
        // A column of numbers begins with no tag: then the sign was put there to leave the row out.
        let first_is_text = x != 0
            && y != 0
            && self.rows.iter().all(|row| self.parse(row.cell(0)).is_none())
            && (!self.rows.is_empty() || header.is_some() || self.comments.len() > 1);
        let found: Vec<Row> = self.comments.iter().filter_map(is_row).collect();
        let errors = self.comments.iter().any(|comment| number::begins_with_error(&comment.text));
        if (errors || first_is_text && (header.is_some() || self.rows.is_empty())) && !found.is_empty() {
            // Rows before the header are gone by now, so that only the order counts.
            let mut rows = std::mem::take(&mut self.rows);
            rows.extend(found);
            rows.sort_by_key(|row| row.place.line());
            self.rows = rows;
            return;
        }
        // Without a tag's column a number may stand right behind the sign.
        let commented = self.comments.iter().filter(|comment| {
            let cells = self.split(&comment.text);
            let row = Row::new(RowPlace::Line(comment.line), &cells);
            let [x, y] = places.map_or([0, 1], |(columns, _)| columns);
            width.is_none_or(|width| cells.len() == width)
                && [x, y].iter().all(|&column| self.parse(row.cell(column)).is_some())
        });
        let lines: Vec<usize> = commented.map(|comment| comment.line).collect();
        if let Some(first) = lines.first() {
            let rows = counted(lines.len(), "One row begins with # and was", "rows begin with # and were");
            self.notes.push(Note::left_out(format!(
                "{rows} taken for comments, the first of them in line {first}. Take the sign away if they are points."
            )));
        }
    }

    /// A header that is one cell shorter than every row lacks the name of the first column: R's row names.
    fn name_row_names(&self, header: &mut Header) {
        let wanted = header.names.len() + 1;
        if !self.rows.is_empty() && self.rows.iter().all(|row| row.cells.len() == wanted && row.width() == wanted) {
            let mut names: Vec<&str> = self.rows.iter().map(|row| row.cell(0)).collect();
            let all_words = names.iter().all(|name| self.parse(name).is_none());
            let counts = [0, 1]
                .into_iter()
                .any(|first| names.iter().enumerate().all(|(index, name)| name.parse() == Ok(index + first)));
            names.sort_unstable();
            names.dedup();
            let sure = Header::is_sure(&header.trimmed());
            if sure && names.len() == self.rows.len() && (all_words || counts && self.rows.len() > 2) {
                header.names.insert(0, String::new());
            }
        }
    }

    /// Files that were put together have their header again in the middle.
    fn take_repeated(&mut self, header: &Header) {
        let is_header = |row: &Row| {
            row.cells.len() == header.names.len()
                && row.cells.iter().zip(&header.names).all(|(cell, name)| cell == name)
        };
        let before = self.rows.len();
        let first = self.rows.iter().find(|row| is_header(row)).map(|row| row.place.name());
        self.rows.retain(|row| !is_header(row));
        if let Some(first) = first {
            let rows = counted(
                before - self.rows.len(),
                "One row repeats the header and was",
                "rows repeat the header and were",
            );
            self.notes.push(Note::left_out(format!("{rows} left out, the first {first}.")));
        }
    }

    /// Rows of units, or of more names, below the header.
    fn take_units(&mut self, header: &mut Header) {
        let Some(([x, y], _)) = column_names::place_columns(&header.trimmed()) else { return };
        let is_number = |row: &Row, column: usize| self.parse(row.cell(column)).is_some();
        // Where both are missing the row is one without a place.
        let is_below = |row: &&Row| {
            (0..row.width()).all(|column| !is_number(row, column))
                && ![x, y].iter().all(|&column| is_missing(row.cell(column)))
        };
        let count = self.rows.iter().take(MAX_ROWS_BELOW).take_while(is_below).count();
        // Points have to follow.
        let follows = self.rows.get(count).is_some_and(|row| [x, y].iter().all(|&column| is_number(row, column)));
        if count == 0 || !follows {
            return;
        }
        for row in self.rows.drain(..count) {
            let cells: Vec<String> = (0..header.names.len()).map(|column| row.cell(column).to_owned()).collect();
            let is_unit =
                |column: usize| column_names::is_unit(&cells[column]) || cells[column].starts_with(['[', '(']);
            if [x, y].into_iter().all(is_unit) {
                header.units = cells.iter().map(|cell| cell.trim_matches(['[', ']', '(', ')']).to_owned()).collect();
            } else {
                let (line, words) = (row.place.name(), clip(&cells.join(", ")));
                let text = format!("The row {line} was taken for a second header and left out: {words}.");
                self.notes.push(Note::left_out(text));
            }
        }
    }
}

/// The cells of a line, parted by a sign, or by blanks where there is none.
fn split_by(text: &str, sign: Option<u8>) -> Vec<String> {
    let Some(sign) = sign else { return whitespace::cells(text).0.into_iter().map(str::to_owned).collect() };
    let mut reader = csv::ReaderBuilder::new().has_headers(false).delimiter(sign).from_reader(text.trim().as_bytes());
    let record = reader.records().next().and_then(Result::ok).unwrap_or_default();
    record.iter().map(str::to_owned).collect()
}

impl Header {
    /// Of two rows of names, as CellProfiler writes them: the lower ones, with the upper ones in front where they are not enough
    /// to tell columns apart.
    fn combine(&mut self, above: &Row) {
        let mut names = self.trimmed();
        names.sort_unstable();
        let twice: Vec<String> = names
            .windows(2)
            .filter(|pair| pair[0] == pair[1] && !pair[0].is_empty())
            .map(|pair| pair[0].to_owned())
            .collect();
        for (column, name) in self.names.iter_mut().enumerate() {
            if twice.contains(&name.trim().to_owned()) && !above.cell(column).is_empty() {
                *name = format!("{}_{}", above.cell(column), name.trim());
            }
        }
    }
}
