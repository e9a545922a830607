//! Lists of points in JSON, one list or one object a point, as rows of the same table that text files give.
//!
//! Objects are records: their members are columns, whether all of them have one or not. What a record says of its place in
//! an object or a list of its own (`"position": [1, 2]`, `"location": {"lat": 1, "lon": 2}`, a point of GeoJSON) becomes two
//! columns.

use std::collections::HashSet;

use serde_json::{Map, Value};

use super::column_names::Sureness;
use super::declaration::Declared;
use super::error::{FormatError, clip};
use super::json::{kind, layout_at};
use super::note::counted;
use super::table::{MAX_COLUMNS, Row, RowPlace, Table};
use super::{Note, column_names};

/// Most cells of a table of records: what a record lacks takes a cell too.
const MAX_CELLS: usize = 4_000_000;
/// Members that hold a place, without signs and in small letters.
const PLACES: [&str; 18] = [
    "position",
    "pos",
    "location",
    "loc",
    "point",
    "geometry",
    "geom",
    "coordinates",
    "coordinate",
    "coords",
    "coord",
    "center",
    "centre",
    "centroid",
    "xy",
    "place",
    "lonlat",
    "latlng",
];

/// `[x, y, …]` or `{"x": …, "y": …, …}`, with the line and character of each.
pub(super) fn table(points: &[Value], places: &[(usize, usize)], declared: Declared) -> Result<Table, FormatError> {
    let mut table = Table::new(declared);
    let are_records = matches!(points.first(), Some(Value::Object(_)));
    for (index, point) in points.iter().enumerate() {
        let (fits, wanted) = match point {
            Value::Array(_) => (!are_records, "an object with 'x' and 'y' like the first one"),
            Value::Object(_) => (are_records, "a list [x, y] like the first one"),
            _ if are_records => (false, "an object with 'x' and 'y' like the first one"),
            _ => (false, "a list [x, y]"),
        };
        if !fits {
            let message = format!("point {} of the list is {}, but must be {wanted}", index + 1, kind(point));
            return Err(layout_at(places.get(index).copied(), message));
        }
    }
    let row_place = |index: usize| RowPlace::Entry(index + 1, places.get(index).copied());
    if !are_records {
        for (index, point) in points.iter().enumerate() {
            let values = point.as_array().map(Vec::as_slice).unwrap_or_default();
            table.push(Row::new(row_place(index), values.iter().map(cell)))?;
        }
        return Ok(table);
    }
    let records = || points.iter().filter_map(Value::as_object);
    let members = Members::of(records(), &mut table.notes);
    for (index, record) in records().enumerate() {
        table.push(Row::new(row_place(index), members.columns.iter().map(|column| column.cell(record))))?;
    }
    table.header = Some(members.names());
    Ok(table)
}

/// A JSON value as the text of a cell.
pub(super) fn cell(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        // "null" would pass for the name of a class.
        Value::Null => String::new(),
        other => other.to_string(),
    }
}

/// Names of members in the order they appear in, each once, so many that a table of `rows` rows can hold them; how many
/// others there are is noted.
pub(super) fn union<'a>(
    objects: impl Iterator<Item = &'a Map<String, Value>>,
    rows: usize,
    what: [&str; 2],
    notes: &mut Vec<Note>,
) -> Vec<&'a str> {
    let most = (MAX_CELLS / rows.max(1)).clamp(16, MAX_COLUMNS - 8);
    let mut known: HashSet<&str> = HashSet::new();
    let mut names = Vec::new();
    let mut beyond: HashSet<&str> = HashSet::new();
    for name in objects.flat_map(Map::keys) {
        if known.contains(name.as_str()) {
            continue;
        }
        if names.len() < most {
            known.insert(name);
            names.push(name.as_str());
        } else {
            beyond.insert(name);
        }
    }
    if let Some(first) = beyond.iter().min() {
        let were = counted(beyond.len(), &format!("One {} was", what[0]), &format!("{} were", what[1]));
        notes.push(Note::left_out(format!(
            "{were} left out, as at most {most} fit a table of {rows} points, among them '{}'.",
            clip(first)
        )));
    }
    names
}

/// Where a column's cells stand in a record.
#[derive(Debug)]
enum Source<'a> {
    /// A member.
    Member(&'a str),
    /// A member of a member.
    Inner(&'a str, &'a str),
    /// An entry of a list that is a member.
    Entry(&'a str, usize),
    /// A coordinate of a point of GeoJSON.
    Point(&'a str, usize),
}

#[derive(Debug)]
struct Column<'a> {
    name: String,
    source: Source<'a>,
}

impl Column<'_> {
    fn cell(&self, record: &Map<String, Value>) -> String {
        let entry = |value: &Value, index: usize| value.as_array().and_then(|list| list.get(index)).map(cell);
        match self.source {
            Source::Member(name) => record.get(name).map(cell),
            Source::Inner(name, inner) => record.get(name).and_then(|value| value.get(inner)).map(cell),
            Source::Entry(name, index) => record.get(name).and_then(|value| entry(value, index)),
            Source::Point(name, index) => {
                record.get(name).and_then(|value| value.get("coordinates")).and_then(|list| entry(list, index))
            }
        }
        .unwrap_or_default()
    }
}

/// The columns of records.
#[derive(Debug)]
struct Members<'a> {
    columns: Vec<Column<'a>>,
}

impl<'a> Members<'a> {
    fn of(records: impl Iterator<Item = &'a Map<String, Value>> + Clone, notes: &mut Vec<Note>) -> Self {
        let rows = records.clone().count();
        let names = union(records.clone(), rows, ["member of the records", "members of the records"], notes);
        let mut columns: Vec<Column<'a>> = Vec::new();
        // A record that says plainly where it is needs nothing else to say so.
        let is_plain = column_names::place_columns(&names).is_some_and(|(_, sureness)| sureness <= Sureness::Degrees);
        for &name in &names {
            // What the first record that has one says holds for all.
            let first = records.clone().find_map(|record| record.get(name).filter(|value| !value.is_null()));
            let parts =
                first.filter(|_| !is_plain && is_place(name)).map(|value| parts(name, value)).unwrap_or_default();
            if parts.is_empty() {
                columns.push(Column { name: name.to_owned(), source: Source::Member(name) });
            }
            for (part, source) in parts {
                // Names that a record has itself, or another place has taken, stand behind their member's.
                let is_taken = names.contains(&part) || columns.iter().any(|column| column.name == part);
                let name = if is_taken { format!("{name}.{part}") } else { part.to_owned() };
                columns.push(Column { name, source });
            }
        }
        Self { columns }
    }

    fn names(&self) -> Vec<String> {
        self.columns.iter().map(|column| column.name.clone()).collect()
    }
}

fn is_place(name: &str) -> bool {
    let plain: String = name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect();
    PLACES.contains(&plain.as_str())
}

/// What a member that holds a place is made of; nothing where it holds none.
fn parts<'a>(name: &'a str, value: &'a Value) -> Vec<(&'a str, Source<'a>)> {
    let is_position = |value: &Value| {
        value.as_array().is_some_and(|list| (2..=4).contains(&list.len()) && list.iter().all(Value::is_number))
    };
    match value {
        value if is_position(value) => vec![("x", Source::Entry(name, 0)), ("y", Source::Entry(name, 1))],
        Value::Object(inner) if inner.get("coordinates").is_some_and(is_position) => {
            vec![("lon", Source::Point(name, 0)), ("lat", Source::Point(name, 1))]
        }
        Value::Object(inner) => {
            let keys: Vec<&str> = inner.keys().map(String::as_str).collect();
            let found = column_names::place_columns(&keys).map(|(columns, _)| columns);
            found.map_or_else(Vec::new, |columns| columns.map(|at| (keys[at], Source::Inner(name, keys[at]))).into())
        }
        _ => Vec::new(),
    }
}
