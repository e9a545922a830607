//! JSON: our own lossless layout, and lists of points.
//!
//! ```json
//! {"domain": {"min": [0, 0], "size": [1, 1]}, "boundary": "open", "positions": [[0.5, 0.5]], "classes": [0],
//!  "class_names": ["points"], "attributes": [{"name": "radius", "values": [0.1]}]}
//! [[0.5, 0.5], [0.25, 0.75]]
//! {"points": [{"x": 0.5, "y": 0.5, "class": "oak", "radius": 0.1}], "domain": [0, 0, 1, 1], "boundary": "open"}
//! ```
//! Records may stand one a line (NDJSON) or each behind a record separator (RFC 8142), and may have text and different members;
//! tables of columns, as statistics programs write them, are read too. Projects and GeoJSON are JSON as well: see `project.rs`
//! and `geojson.rs`.

use std::collections::HashMap;

use glam::DVec2;
use serde::Deserialize as _;
use serde_json::{Map, Value};

use super::column_names::Sureness;
use super::declaration::Declared;
use super::error::{FormatError, clip, place, places};
use super::guess::Guess;
use super::table::{MAX_COLUMNS, Row, RowPlace, Table};
use super::{FileFormat, ReadOptions, Reading, column_names, geojson, project};
use crate::pattern::{Boundary, Domain, PatternError, PointPattern, RawPattern};

/// In front of every text of a sequence (RFC 8142).
pub(super) const RECORD_SEPARATOR: char = '\u{1e}';
/// Most commas: every value but one costs a comma, and the largest pattern needs a tenth of this. It bounds the
/// memory that nested empty lists could take.
const MAX_COMMAS: usize = 3_000_000;
/// Most objects: each takes hundreds of bytes, and a feature of GeoJSON is three of them.
const MAX_OBJECTS: usize = 200_000;

/// Reads any of the JSON layouts.
pub(super) fn read(text: &str, options: &ReadOptions) -> Result<Reading, FormatError> {
    for (sign, max, what) in [(b',', MAX_COMMAS, "values"), (b'{', MAX_OBJECTS, "objects")] {
        if let Some((byte, _)) = text.bytes().enumerate().filter(|&(_, byte)| byte == sign).nth(max) {
            let message = format!("there are more than {max} {what}; a pattern has fewer");
            return Err(layout_at(Some(place(text, byte)), message));
        }
    }
    // RFC 8142 puts a record separator before every text of a sequence; within a text it can't stand.
    let blanked;
    let text = if text.contains(RECORD_SEPARATOR) {
        blanked = text.replace(RECORD_SEPARATOR, " ");
        &blanked
    } else {
        text
    };
    let mut stream = serde_json::Deserializer::from_str(text).into_iter::<Value>();
    let first = stream.next().ok_or(FormatError::NoPoints)?.map_err(|error| located(&error))?;
    if text[stream.byte_offset()..].trim().is_empty() {
        drop(stream);
        return whole(text, first, options);
    }
    let mut values = vec![first];
    let mut starts = vec![text.len() - text.trim_start().len()];
    loop {
        let rest = &text[stream.byte_offset()..];
        let start = text.len() - rest.trim_start().len();
        let Some(value) = stream.next() else { break };
        values.push(value.map_err(|error| located(&error))?);
        if values.len() > MAX_OBJECTS {
            let message = format!("there are more than {MAX_OBJECTS} values; a pattern has fewer");
            return Err(layout_at(Some(place(text, start)), message));
        }
        starts.push(start);
    }
    sequence(values, &places(text, starts), options)
}

/// One value is the whole file.
fn whole(text: &str, value: Value, options: &ReadOptions) -> Result<Reading, FormatError> {
    match value {
        Value::Array(points) => {
            let places = entry_places(text, &[]);
            if points.iter().any(|value| value.as_object().is_some_and(geojson::is_geojson)) {
                return geojson::read_sequence(&points, &places, options);
            }
            points_table(&points, &places, Declared::default())?.into_reading(FileFormat::Json, options)
        }
        Value::Object(object) if project::is_project(&object) => project::read(text, object, options),
        Value::Object(object) if object.contains_key("positions") => {
            // It is read once more, and need not be there twice.
            drop(object);
            own(text, options)
        }
        Value::Object(object) if geojson::is_geojson(&object) => geojson::read(text, &object, options),
        Value::Object(object) if object.get("type").and_then(Value::as_str) == Some("Topology") => {
            Err(layout(text, &["type"], "this is TopoJSON; export it as GeoJSON".to_owned()))
        }
        Value::Object(object) => match object.get("points") {
            Some(Value::Array(points)) => {
                let places = entry_places(text, &["points"]);
                points_table(points, &places, declared(text, &object)?)?.into_reading(FileFormat::Json, options)
            }
            Some(other) => Err(layout(text, &["points"], format!("'points' is {}, but must be a list", kind(other)))),
            None => lists(text, &object, options),
        },
        other => {
            let found = kind(&other);
            Err(layout(text, &[], format!("it is {found}, but must be a list of points or an object with 'points'")))
        }
    }
}

/// Objects of lists: a list for every column, as statistics programs write tables, or one list of points under any name.
fn lists(text: &str, object: &Map<String, Value>, options: &ReadOptions) -> Result<Reading, FormatError> {
    if let (Some(Value::Array(names)), Some(Value::Array(data))) = (object.get("columns"), object.get("data")) {
        let mut table = points_table(data, &entry_places(text, &["data"]), declared(text, object)?)?;
        table.header = Some(names.iter().map(cell).collect());
        return table.into_reading(FileFormat::Json, options);
    }
    let columns: Vec<(&String, &Vec<Value>)> =
        object.iter().filter_map(|(name, value)| Some((name, value.as_array()?))).collect();
    let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
    let rows = columns.first().map_or(0, |(_, values)| values.len());
    if let [(name, points)] = columns[..]
        && !points.is_empty()
        && points.iter().all(|point| point.is_array() || point.is_object())
    {
        let places = entry_places(text, &[name]);
        return points_table(points, &places, declared(text, object)?)?.into_reading(FileFormat::Json, options);
    }
    if column_names::place_columns(&names).is_some() {
        if let Some((name, values)) = columns.iter().find(|(_, values)| values.len() != rows) {
            let (first, name, count) = (clip(names[0]), clip(name), values.len());
            return Err(layout(
                text,
                &[name.as_str()],
                format!("'{name}' has {count} values, but '{first}' has {rows}"),
            ));
        }
        let mut table = Table::new(declared(text, object)?);
        table.header = Some(names.iter().map(|name| (*name).to_owned()).collect());
        for row in 0..rows {
            let cells = columns.iter().map(|(_, values)| cell(&values[row]));
            table.push(Row::new(RowPlace::Entry(row + 1, None), cells))?;
        }
        return table.into_reading(FileFormat::Json, options);
    }
    let keys: Vec<_> = object.keys().map(|key| format!("'{key}'")).collect();
    let found = clip(&keys.join(", "));
    Err(layout(text, &[], format!("neither 'points' nor 'positions' is there; it holds {found}")))
}

/// One value a line, or one behind another: features, records, or lists of coordinates.
fn sequence(values: Vec<Value>, places: &[(usize, usize)], options: &ReadOptions) -> Result<Reading, FormatError> {
    let is_feature = |value: &Value| value.as_object().is_some_and(geojson::is_geojson);
    if values.iter().all(is_feature) {
        return geojson::read_sequence(&values, places, options);
    }
    if let (true, Some(other)) = (is_feature(&values[0]), values.iter().position(|value| !is_feature(value))) {
        let message = format!("value {} of the file is no GeoJSON, but those before it are", other + 1);
        return Err(layout_at(places.get(other).copied(), message));
    }
    points_table(&values, places, Declared::default())?.into_reading(FileFormat::Json, options)
}

/// Writes a pattern as JSON that reads back as the same pattern, digit by digit.
#[must_use]
pub fn write_json(pattern: &PointPattern) -> String {
    #[expect(
        clippy::expect_used,
        reason = "finite numbers and strings in structs: nothing of it can fail to serialise"
    )]
    let mut text = serde_json::to_string(pattern).expect("a pattern serialises");
    text.push('\n');
    text
}

/// The layout of [`PointPattern`] itself; without a domain the usual rule finds one.
fn own(text: &str, options: &ReadOptions) -> Result<Reading, FormatError> {
    // From the text, not from the values: so a wrong one has a line and a column.
    let mut raw: RawPattern = serde_json::from_str(text).map_err(|error| located(&error))?;
    let is_domain_declared = options.domain.or(raw.domain).is_some();
    let (mut domains, mut notes) = (Vec::new(), Vec::new());
    if raw.domain.is_none() {
        if raw.positions.is_empty() {
            return Err(FormatError::NoPoints);
        }
        let positions: Vec<DVec2> = raw.positions.iter().copied().map(DVec2::from).collect();
        raw.domain = options.domain;
        if raw.domain.is_none() {
            let guess = Guess::of(&positions)?;
            (raw.domain, domains, notes) = (Some(guess.domain), guess.choices, guess.notes);
        }
    }
    let pattern = PointPattern::try_from(raw).and_then(|pattern| options.apply(pattern));
    let mut reading = Reading::new(FileFormat::Json, pattern.map_err(|error| misfit(text, &[], &error))?);
    reading.is_domain_declared = is_domain_declared;
    (reading.domains, reading.notes) = (domains, notes);
    Ok(reading)
}

/// What is wrong with a pattern in our own layout, at the member of the object at `path` that it is about.
pub(super) fn misfit(text: &str, path: &[&str], error: &PatternError) -> FormatError {
    let (member, entry) = match error {
        PatternError::Domain { .. } => ("domain", None),
        PatternError::Outside { index, .. } => ("positions", Some(*index)),
        PatternError::NotFinite { index, axis, .. } if axis == "x" || axis == "y" => ("positions", Some(*index)),
        PatternError::Empty | PatternError::TooMany { what: "points", .. } => ("positions", None),
        PatternError::Class { index, .. } => ("classes", Some(*index)),
        PatternError::Length { what, .. } if what == "classes" => ("classes", None),
        PatternError::TooMany { what: "classes", .. } => ("class_names", None),
        _ => ("attributes", None),
    };
    let path = [path, &[member]].concat();
    let at = match entry {
        Some(index) => entry_places(text, &path).get(index).copied(),
        None => member_place(text, &path),
    };
    // A name may be a class's as well as an attribute's.
    layout_at(at.or_else(|| member_place(text, &path[..path.len() - 1])), error.to_string())
}

/// `[x, y, …]` or `{"x": …, "y": …, …}`, as rows of the same table that text files give. Records may have different members;
/// what one lacks is missing there.
fn points_table(points: &[Value], places: &[(usize, usize)], declared: Declared) -> Result<Table, FormatError> {
    let mut table = Table::new(declared);
    let are_records = matches!(points.first(), Some(Value::Object(_)));
    let mut names = Names::default();
    for (index, point) in points.iter().enumerate() {
        let at = places.get(index).copied();
        let place = RowPlace::Entry(index + 1, at);
        let cells: Vec<String> = match point {
            Value::Array(values) if !are_records => values.iter().map(cell).collect(),
            Value::Object(members) if are_records => {
                let mut cells = vec![String::new(); names.list.len()];
                for (name, value) in members {
                    names.fill(name, value, &mut cells, members);
                }
                if names.list.len() > MAX_COLUMNS {
                    return Err(FormatError::TooMany { place: place.cell(0), what: "members", max: MAX_COLUMNS });
                }
                cells
            }
            other => {
                let wanted = if are_records { "an object like the first one" } else { "a list [x, y]" };
                let found = kind(other);
                let message = format!("point {} of the list is {found}, but must be {wanted}", index + 1);
                return Err(layout_at(at, message));
            }
        };
        table.push_even_blank(Row::new(place, &cells))?;
    }
    if are_records {
        table.header = Some(names.list);
    }
    Ok(table)
}

/// The members of records, in the order they appear in.
#[derive(Default)]
struct Names {
    list: Vec<String>,
    columns: HashMap<String, usize>,
}

impl Names {
    /// Puts a member of a record into its cells. Places may lie within: `"position": [1, 2]`, `"location": {"x": 1, "y": 2}`, or
    /// a point of GeoJSON. Those in degrees keep their names, if the record has no such member itself: they tell that it is degrees.
    fn fill(&mut self, name: &str, value: &Value, cells: &mut Vec<String>, record: &Map<String, Value>) {
        let is_free = |keys: &[&str]| keys.iter().all(|&key| !record.contains_key(key));
        match value {
            Value::Object(members) => {
                if let Some(position @ Value::Array(_)) = members.get("coordinates") {
                    let is_point = members.get("type").and_then(Value::as_str) == Some("Point");
                    let axes = ["lon", "lat"];
                    if let (true, Some([x, y, ..])) =
                        (is_point && is_free(&axes), position.as_array().map(Vec::as_slice))
                    {
                        self.put(axes[0].to_owned(), cell(x), cells);
                        self.put(axes[1].to_owned(), cell(y), cells);
                    } else {
                        self.fill_list(name, position, cells);
                    }
                    return;
                }
                let keys: Vec<&str> = members.keys().map(String::as_str).take(MAX_COLUMNS).collect();
                let place = column_names::place_columns(&keys).filter(|(_, sureness)| *sureness == Sureness::Degrees);
                let axes = place.map(|(columns, _)| columns.map(|at| keys[at])).filter(|axes| is_free(axes));
                for (inner, value) in members {
                    match axes {
                        Some(axes) if axes.contains(&inner.as_str()) => self.put(inner.clone(), cell(value), cells),
                        _ => self.fill_list(&format!("{name}.{inner}"), value, cells),
                    }
                }
            }
            other => self.fill_list(name, other, cells),
        }
    }

    fn fill_list(&mut self, name: &str, value: &Value, cells: &mut Vec<String>) {
        match value {
            Value::Array(values) if (2..=3).contains(&values.len()) && values.iter().all(Value::is_number) => {
                for (axis, value) in ["x", "y", "z"].into_iter().zip(values) {
                    self.put(format!("{name}.{axis}"), cell(value), cells);
                }
            }
            other => self.put(name.to_owned(), cell(other), cells),
        }
    }

    fn put(&mut self, name: String, text: String, cells: &mut Vec<String>) {
        let column = match self.columns.get(&name) {
            Some(&column) => column,
            // Beyond the cap names need not be kept: the record is refused.
            None if self.list.len() > MAX_COLUMNS => return,
            None => {
                self.columns.insert(name.clone(), self.list.len());
                self.list.push(name);
                self.list.len() - 1
            }
        };
        if cells.len() <= column {
            cells.resize(column + 1, String::new());
        }
        cells[column] = text;
    }
}

/// A JSON value as the text of a cell.
pub(super) fn cell(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        // An empty cell, which no column accepts; "null" would pass for the name of a class.
        Value::Null => String::new(),
        other => other.to_string(),
    }
}

/// `domain` (`[x0, y0, x1, y1]` or our own layout) and `boundary` beside a list of points.
fn declared(text: &str, object: &Map<String, Value>) -> Result<Declared, FormatError> {
    let mut declared = Declared::default();
    if let Some(value) = object.get("domain") {
        let domain = match <[f64; 4]>::deserialize(value) {
            Ok([x0, y0, x1, y1]) => Domain::new(DVec2::new(x0, y0), DVec2::new(x1 - x0, y1 - y0))
                .map_err(|error| misfit(text, &[], &error))?,
            Err(_) => Domain::deserialize(value).map_err(|error| {
                let message = "'domain' must be [x0, y0, x1, y1] or {\"min\": [x, y], \"size\": [w, h]}";
                layout(text, &["domain"], format!("{message}: {error}"))
            })?,
        };
        declared.domain = Some(domain);
    }
    if let Some(value) = object.get("boundary") {
        let boundary = Boundary::deserialize(value).map_err(|_| {
            let message = format!("'boundary' is {}, but must be \"open\" or \"periodic\"", clip(&value.to_string()));
            layout(text, &["boundary"], message)
        })?;
        declared.boundary = Some(boundary);
    }
    Ok(declared)
}

pub(super) fn kind(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "true or false",
        Value::Number(_) => "a number",
        Value::String(_) => "a text",
        Value::Array(_) => "a list",
        Value::Object(_) => "an object",
    }
}

/// What is wrong with the value at `path`.
pub(super) fn layout(text: &str, path: &[&str], message: String) -> FormatError {
    layout_at(member_place(text, path), message)
}

/// The same with the line and character of what it is about.
pub(super) fn layout_at(at: Option<(usize, usize)>, message: String) -> FormatError {
    let (line, column) = at.unwrap_or((0, 0));
    FormatError::Syntax { line, column, message: format!("the JSON can't be used: {message}") }
}

/// Line and character, from 1, of every entry of the list that `path` leads to, from one member to the next. The text
/// must be JSON; where the path leads nowhere there are no entries.
pub(super) fn entry_places(text: &str, path: &[&str]) -> Vec<(usize, usize)> {
    let leads = |keys: &[Option<String>], open: &[u8], _: &str| {
        keys.len() == path.len() + 1
            && open.last() == Some(&b'[')
            && keys[1..].iter().zip(path).all(|(key, wanted)| key.as_deref() == Some(*wanted))
    };
    places(text, value_offsets(text, &leads))
}

/// Line and character of the value that `path` leads to, from one member to the next; of the whole for an empty path.
pub(super) fn member_place(text: &str, path: &[&str]) -> Option<(usize, usize)> {
    let leads = |keys: &[Option<String>], open: &[u8], key: &str| match path.split_last() {
        None => keys.is_empty(),
        Some((last, outer)) => {
            keys.len() == path.len()
                && open.last() == Some(&b'{')
                && key == *last
                && keys[1..].iter().zip(outer).all(|(key, wanted)| key.as_deref() == Some(*wanted))
        }
    };
    // Of members of the same name the last one holds.
    value_offsets(text, &leads).last().map(|&byte| place(text, byte))
}

/// Whether a value is meant, by the keys of the brackets around it, those brackets and its own key.
type Wanted<'a> = dyn Fn(&[Option<String>], &[u8], &str) -> bool + 'a;

/// The first byte of every value that is `wanted`, by the keys under which the brackets around it stand (None in a list),
/// those brackets, and its own key in an object. The text must be JSON.
fn value_offsets(text: &str, wanted: &Wanted<'_>) -> Vec<usize> {
    let mut offsets = Vec::new();
    let mut keys: Vec<Option<String>> = Vec::new();
    // Whether a value may begin here, and not a key.
    let mut awaits_value = true;
    let mut key = String::new();
    let bytes = text.as_bytes();
    let mut at = 0;
    let mut open: Vec<u8> = Vec::new();
    while let Some(&byte) = bytes.get(at) {
        let begins = awaits_value && !byte.is_ascii_whitespace() && !matches!(byte, b']' | b'}' | b',' | b':');
        if begins && wanted(&keys, &open, &key) {
            offsets.push(at);
        }
        let inside_object = open.last() == Some(&b'{');
        match byte {
            b'{' | b'[' => {
                keys.push(inside_object.then(|| std::mem::take(&mut key)));
                open.push(byte);
                awaits_value = byte == b'[';
                at += 1;
                continue;
            }
            b'}' | b']' => {
                keys.pop();
                open.pop();
            }
            b',' => awaits_value = !inside_object,
            b':' => awaits_value = true,
            b'"' => {
                let start = at + 1;
                at = start;
                while let Some(&inner) = bytes.get(at) {
                    match inner {
                        b'\\' => at += 2,
                        b'"' => break,
                        _ => at += 1,
                    }
                }
                if inside_object && !awaits_value {
                    key = text.get(start..at).unwrap_or_default().to_owned();
                }
                awaits_value = false;
            }
            byte if byte.is_ascii_whitespace() => {}
            _ => awaits_value = false,
        }
        at += 1;
    }
    offsets
}

/// The library's words, with the place in front as in every other format.
pub(super) fn located(error: &serde_json::Error) -> FormatError {
    let message = error.to_string();
    let place = format!(" at line {} column {}", error.line(), error.column());
    let message = message.strip_suffix(&place).unwrap_or(&message);
    FormatError::Syntax {
        line: error.line(),
        // The end of a text that ends a line stands before its first character.
        column: error.column().max(1),
        message: format!("the JSON can't be used: {message}"),
    }
}
