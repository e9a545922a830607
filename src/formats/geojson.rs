//! GeoJSON (RFC 7946): `Point` and `MultiPoint`, alone, in features or in collections. Coordinates are taken as they are,
//! on a plane; a property named `class` or the like gives the class, properties that are numbers become attributes.

use serde_json::{Map, Value, json};

use super::declaration::Declared;
use super::error::FormatError;
use super::json::{cell, entry_places, kind, layout, layout_at, member_place};
use super::table::{Role, Row, RowPlace, Table};
use super::{FileFormat, Note, Origin, ReadOptions, Reading};
use crate::pattern::{MAX_ATTRIBUTES, MAX_CLASSES, MAX_NAME_LENGTH, PointPattern};

/// Geometries that hold no points.
const OTHER_SHAPES: [&str; 4] = ["LineString", "MultiLineString", "Polygon", "MultiPolygon"];
/// Properties that name a class, the likeliest first.
const CLASS_NAMES: [&str; 6] = ["class", "species", "category", "kind", "type", "group"];
/// Collections within collections.
const MAX_DEPTH: usize = 8;

/// What is collected on the way.
#[derive(Default)]
struct Points<'a> {
    points: Vec<Point<'a>>,
    /// Shapes that hold no points.
    others: usize,
}

struct Point<'a> {
    place: RowPlace,
    position: &'a [Value],
    properties: Option<&'a Map<String, Value>>,
}

/// Whether an object says that it is GeoJSON.
pub(super) fn is_geojson(object: &Map<String, Value>) -> bool {
    let known = ["FeatureCollection", "Feature", "GeometryCollection", "Point", "MultiPoint"];
    let type_of = object.get("type").and_then(Value::as_str);
    type_of.is_some_and(|name| known.contains(&name) || OTHER_SHAPES.contains(&name))
}

pub(super) fn read(text: &str, object: &Map<String, Value>, options: &ReadOptions) -> Result<Reading, FormatError> {
    let mut found = Points::default();
    if let Some(Value::Array(features)) = object.get("features") {
        let places = entry_places(text, &["features"]);
        for (index, feature) in features.iter().enumerate() {
            let place = RowPlace::Entry(index + 1, places.get(index).copied());
            found.feature(feature, place)?;
        }
    } else if object.contains_key("features") {
        return Err(layout(text, &["features"], "'features' must be a list".to_owned()));
    } else {
        found.object(object, RowPlace::Entry(1, member_place(text, &[])), None, 0)?;
    }

    let mut notes = vec![Note::changed("Coordinates are taken as they are, on a plane.")];
    match found.others {
        0 => {}
        1 => notes.push(Note::left_out("One shape that is no point was left out.")),
        others => notes.push(Note::left_out(format!("{others} shapes that are no points were left out."))),
    }
    let columns = Columns::choose(&found.points, &mut notes);
    let mut table = Table::new(Declared::default());
    let mut roles = vec![Role::X, Role::Y];
    roles.extend(columns.class.map(|_| Role::Class));
    roles.extend(columns.attributes.iter().map(|name| Role::Attribute((*name).to_owned())));
    table.roles = Some(roles);
    for point in &found.points {
        let property = |name: &str| point.properties.and_then(|properties| properties.get(name)).map(cell);
        let mut cells: Vec<String> = point.position.iter().take(2).map(cell).collect();
        cells.extend(columns.class.map(|name| property(name).unwrap_or_default()));
        cells.extend(columns.attributes.iter().map(|name| property(name).unwrap_or_default()));
        table.push(Row::new(point.place, cells))?;
    }
    let mut reading = table.into_reading(FileFormat::GeoJson, options)?;
    reading.notes.splice(0..0, notes);
    Ok(reading)
}

/// Writes a pattern as a collection of points: in degrees where the exemplar's were, else as its positions are, and with
/// class and attributes under the names they had.
#[must_use]
pub fn write_geojson(pattern: &PointPattern, origin: &Origin) -> String {
    let features: Vec<Value> = (0..pattern.len())
        .map(|i| {
            let position = pattern.positions()[i];
            let [x, y] = origin.projection.map_or(position, |projection| projection.unproject(position)).to_array();
            let mut properties = Map::new();
            if pattern.class_names() != ["points"] {
                let name = origin.class.as_deref().unwrap_or("class");
                properties
                    .insert(name.to_owned(), pattern.class_names()[usize::from(pattern.classes()[i])].clone().into());
            }
            for attribute in pattern.attributes() {
                properties.insert(origin.header(&attribute.name).to_owned(), attribute.values[i].into());
            }
            json!({"type": "Feature", "geometry": {"type": "Point", "coordinates": [x, y]}, "properties": properties})
        })
        .collect();
    json!({"type": "FeatureCollection", "features": features}).to_string() + "\n"
}

fn at(place: RowPlace) -> Option<(usize, usize)> {
    match place {
        RowPlace::Entry(_, at) => at,
        RowPlace::Line(line) => Some((line, 1)),
    }
}

impl<'a> Points<'a> {
    fn feature(&mut self, feature: &'a Value, place: RowPlace) -> Result<(), FormatError> {
        match feature {
            Value::Object(object) if object.get("type").and_then(Value::as_str) == Some("Feature") => {
                self.object(object, place, None, 0)
            }
            other => Err(layout_at(at(place), format!("a feature is {}, but must be a 'Feature'", kind(other)))),
        }
    }

    fn object(
        &mut self,
        object: &'a Map<String, Value>,
        place: RowPlace,
        properties: Option<&'a Map<String, Value>>,
        depth: usize,
    ) -> Result<(), FormatError> {
        let refuse = |message: String| Err(layout_at(at(place), message));
        if depth > MAX_DEPTH {
            return refuse(format!("collections lie more than {MAX_DEPTH} deep in each other"));
        }
        let name = object.get("type").and_then(Value::as_str).unwrap_or_default();
        match (name, object.get("coordinates"), object.get("geometry"), object.get("geometries")) {
            ("Feature", _, Some(Value::Object(geometry)), _) => {
                let properties = object.get("properties").and_then(Value::as_object);
                self.object(geometry, place, properties, depth + 1)
            }
            // A feature without a place.
            ("Feature", _, None | Some(Value::Null), _) => {
                self.others += 1;
                Ok(())
            }
            ("GeometryCollection", _, _, Some(Value::Array(geometries))) => {
                for geometry in geometries {
                    match geometry {
                        Value::Object(geometry) => self.object(geometry, place, properties, depth + 1)?,
                        other => return refuse(format!("a geometry is {}, but must be an object", kind(other))),
                    }
                }
                Ok(())
            }
            ("Point", Some(Value::Array(position)), _, _) => self.push(position, place, properties),
            ("MultiPoint", Some(Value::Array(positions)), _, _) => {
                for position in positions {
                    match position {
                        Value::Array(position) => self.push(position, place, properties)?,
                        other => return refuse(format!("a position is {}, but must be a list", kind(other))),
                    }
                }
                Ok(())
            }
            (name, ..) if OTHER_SHAPES.contains(&name) => {
                self.others += 1;
                Ok(())
            }
            (name, ..) => refuse(format!("{:?} is not a geometry with coordinates", super::error::clip(name))),
        }
    }

    fn push(
        &mut self,
        position: &'a [Value],
        place: RowPlace,
        properties: Option<&'a Map<String, Value>>,
    ) -> Result<(), FormatError> {
        if position.len() < 2 || !position.iter().take(2).all(Value::is_number) {
            return Err(layout_at(at(place), "a position must begin with two numbers".to_owned()));
        }
        self.points.push(Point { place, position, properties });
        Ok(())
    }
}

/// The properties that are used.
#[derive(Default)]
struct Columns<'a> {
    class: Option<&'a str>,
    attributes: Vec<&'a str>,
}

impl<'a> Columns<'a> {
    /// Every point must have them: a property that some lack is left out, and so is one of many different words.
    fn choose(points: &[Point<'a>], notes: &mut Vec<Note>) -> Self {
        let mut columns = Self::default();
        let Some(first) = points.first().and_then(|point| point.properties) else { return columns };
        let all = |name: &str, is: &dyn Fn(&Value) -> bool| {
            points.iter().all(|point| point.properties.and_then(|list| list.get(name)).is_some_and(is))
        };
        let is_class = |value: &Value| match value {
            Value::String(text) => !text.trim().is_empty() && text.chars().count() <= MAX_NAME_LENGTH,
            Value::Number(number) => number.is_i64(),
            _ => value.is_boolean(),
        };
        columns.class = CLASS_NAMES.iter().find_map(|wanted| {
            let name = first.keys().find(|name| name.eq_ignore_ascii_case(wanted))?;
            let mut different: Vec<String> = Vec::new();
            for point in points {
                let value = point.properties.and_then(|list| list.get(name)).filter(|value| is_class(value))?;
                let word = cell(value);
                if !different.contains(&word) {
                    different.push(word);
                }
                if different.len() > MAX_CLASSES {
                    return None;
                }
            }
            Some(name.as_str())
        });
        let mut left_out = Vec::new();
        for name in first.keys().map(String::as_str).filter(|&name| Some(name) != columns.class) {
            let usable = !name.trim().is_empty() && name.chars().count() <= MAX_NAME_LENGTH && {
                !name.chars().any(char::is_control)
            };
            if usable && columns.attributes.len() < MAX_ATTRIBUTES && all(name, &Value::is_number) {
                columns.attributes.push(name);
            } else {
                left_out.push(super::error::clip(name));
            }
        }
        if !left_out.is_empty() {
            let list = super::error::clip(&left_out.join(", "));
            notes.push(Note::left_out(format!(
                "Properties that are no number of every point, or too many, were left out: {list}."
            )));
        }
        columns
    }
}
