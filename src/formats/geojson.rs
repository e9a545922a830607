//! GeoJSON (RFC 7946): `Point` and `MultiPoint`, alone, in features or in collections, also one a line; and back.
//!
//! Degrees of one place become metres about it (see [`Projection`](super::Projection)), unless the file names another system
//! of coordinates. A polygon around the points is their window. Properties are columns like those of a table.

use std::collections::HashMap;

use glam::DVec2;
use serde_json::{Map, Value, json};

use super::declaration::Declared;
use super::error::{FormatError, clip};
use super::json::{cell, entry_places, kind, layout, layout_at, member_place};
use super::note::counted;
use super::table::{MAX_COLUMNS, Role, Row, RowPlace, Table};
use super::{ColumnChoice, FileFormat, Note, Origin, ReadOptions, Reading};
use crate::pattern::{Boundary, Domain, MAX_CORNERS, PointPattern};

/// Geometries without area.
const LINES: [&str; 2] = ["LineString", "MultiLineString"];
/// Geometries with one.
const AREAS: [&str; 2] = ["Polygon", "MultiPolygon"];
/// Collections within collections.
const MAX_DEPTH: usize = 8;
/// The member that keeps what GeoJSON has no words for.
const MEMBER: &str = "pointweave";
/// Decimals of degrees that are written: a tenth of a millimetre.
const DECIMALS: f64 = 1e9;

/// What is collected on the way.
#[derive(Default)]
struct Found<'a> {
    points: Vec<Point<'a>>,
    rings: Vec<Vec<DVec2>>,
    /// Shapes that hold no points.
    lines: usize,
    areas: usize,
    /// Features without a place.
    empty: usize,
    heights: usize,
}

struct Point<'a> {
    place: RowPlace,
    position: [&'a Value; 2],
    properties: Option<&'a Map<String, Value>>,
}

/// Whether an object says that it is GeoJSON.
pub(super) fn is_geojson(object: &Map<String, Value>) -> bool {
    let known = ["FeatureCollection", "Feature", "GeometryCollection", "Point", "MultiPoint"];
    let type_of = object.get("type").and_then(Value::as_str);
    type_of.is_some_and(|name| known.contains(&name) || LINES.contains(&name) || AREAS.contains(&name))
}

pub(super) fn read(text: &str, object: &Map<String, Value>, options: &ReadOptions) -> Result<Reading, FormatError> {
    let mut found = Found::default();
    match object.get("features") {
        Some(Value::Array(features)) => {
            let places = entry_places(text, &["features"]);
            for (index, feature) in features.iter().enumerate() {
                found.value(feature, RowPlace::Entry(index + 1, places.get(index).copied()))?;
            }
        }
        Some(_) => return Err(layout(text, &["features"], "'features' must be a list".to_owned())),
        None => found.object(object, RowPlace::Entry(1, member_place(text, &[])), None, 0)?,
    }
    let own = object.get(MEMBER).and_then(Value::as_object);
    found.reading(!names_another_system(object), own, options)
}

/// Features and geometries one behind another.
pub(super) fn read_sequence(
    values: &[Value],
    places: &[(usize, usize)],
    options: &ReadOptions,
) -> Result<Reading, FormatError> {
    let mut found = Found::default();
    for (index, value) in values.iter().enumerate() {
        let place = RowPlace::Entry(index + 1, places.get(index).copied());
        let features = value.get("features").and_then(Value::as_array);
        match features {
            Some(features) => features.iter().try_for_each(|feature| found.value(feature, place))?,
            None => found.value(value, place)?,
        }
    }
    let planar = values.iter().filter_map(Value::as_object).any(names_another_system);
    found.reading(!planar, None, options)
}

/// Whether coordinates are not degrees of WGS 84: files of 2008's GeoJSON may say so.
fn names_another_system(object: &Map<String, Value>) -> bool {
    let name = object.get("crs").and_then(|crs| crs.get("properties")?.get("name")?.as_str());
    name.is_some_and(|name| !["CRS84", "4326", "4258", "WGS84", "WGS 84"].iter().any(|known| name.contains(known)))
}

fn at(place: RowPlace) -> Option<(usize, usize)> {
    match place {
        RowPlace::Entry(_, at) => at,
        RowPlace::Line(line) => Some((line, 1)),
    }
}

impl<'a> Found<'a> {
    fn value(&mut self, value: &'a Value, place: RowPlace) -> Result<(), FormatError> {
        match value {
            Value::Object(object) if is_geojson(object) => self.object(object, place, None, 0),
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
                self.empty += 1;
                Ok(())
            }
            ("GeometryCollection", _, _, Some(Value::Array(geometries))) => {
                for geometry in geometries {
                    match geometry {
                        Value::Object(geometry) => self.object(geometry, place, properties, depth + 1)?,
                        Value::Null => self.empty += 1,
                        other => return refuse(format!("a geometry is {}, but must be an object", kind(other))),
                    }
                }
                Ok(())
            }
            ("Point" | "MultiPoint", None | Some(Value::Null), _, _) => {
                self.empty += 1;
                Ok(())
            }
            ("Point", Some(Value::Array(position)), _, _) => self.push(position, place, properties),
            ("MultiPoint", Some(Value::Array(positions)), _, _) => {
                self.empty += usize::from(positions.is_empty());
                for position in positions {
                    match position {
                        Value::Array(position) => self.push(position, place, properties)?,
                        other => return refuse(format!("a position is {}, but must be a list", kind(other))),
                    }
                }
                Ok(())
            }
            (name, ..) if LINES.contains(&name) => {
                self.lines += 1;
                Ok(())
            }
            (name, coordinates, ..) if AREAS.contains(&name) => {
                self.areas += 1;
                if let Some(coordinates) = coordinates {
                    self.take_rings(coordinates, 0);
                }
                Ok(())
            }
            (name, ..) => refuse(format!("{:?} is not a geometry with coordinates", clip(name))),
        }
    }

    fn push(
        &mut self,
        position: &'a [Value],
        place: RowPlace,
        properties: Option<&'a Map<String, Value>>,
    ) -> Result<(), FormatError> {
        match position {
            [] | [Value::Null, ..] => self.empty += 1,
            [x @ Value::Number(_), y @ Value::Number(_), rest @ ..] => {
                self.heights += usize::from(rest.first().is_some_and(Value::is_number));
                self.points.push(Point { place, position: [x, y], properties });
            }
            _ => return Err(layout_at(at(place), "a position must begin with two numbers".to_owned())),
        }
        Ok(())
    }

    /// The closed lines of areas, however deep; those that are none are passed over: they are only a help.
    fn take_rings(&mut self, coordinates: &Value, depth: usize) {
        let Value::Array(list) = coordinates else { return };
        let corners: usize = self.rings.iter().map(Vec::len).sum();
        let corner = |value: &Value| Some(DVec2::new(value.get(0)?.as_f64()?, value.get(1)?.as_f64()?));
        let ring: Option<Vec<DVec2>> = list.iter().map(corner).collect();
        match ring {
            Some(ring) if ring.len() >= 3 && corners + ring.len() <= MAX_CORNERS => self.rings.push(ring),
            Some(_) => {}
            None if depth < 3 => list.iter().for_each(|inner| self.take_rings(inner, depth + 1)),
            None => {}
        }
    }

    fn notes(&self) -> Vec<Note> {
        let mut notes = Vec::new();
        let mut say = |count: usize, one: &str, many: &str, why: &str| {
            if count > 0 {
                notes.push(Note::left_out(format!("{} left out{why}.", counted(count, one, many))));
            }
        };
        say(self.empty, "One feature without a place was", "features without a place were", "");
        say(self.lines, "One line was", "lines were", ", as a pattern has points only");
        // Areas around the points are said to be their window.
        let areas = if self.rings.is_empty() { self.areas } else { 0 };
        say(areas, "One shape that is no point was", "shapes that are no points were", "");
        say(self.heights, "The height of one point was", "heights of points were", ", as a pattern is flat");
        notes
    }

    fn reading(
        self,
        is_in_degrees: bool,
        own: Option<&Map<String, Value>>,
        options: &ReadOptions,
    ) -> Result<Reading, FormatError> {
        let mut table = Table::new(own.map(declared).unwrap_or_default());
        table.notes = self.notes();
        table.is_in_degrees = is_in_degrees;
        let mut names = vec!["x".to_owned(), "y".to_owned()];
        let mut columns: HashMap<&str, usize> = HashMap::new();
        for point in &self.points {
            let mut cells: Vec<String> = point.position.iter().map(|value| cell(value)).collect();
            cells.resize(names.len(), String::new());
            for (name, value) in point.properties.into_iter().flatten() {
                let column = *columns.entry(name).or_insert_with(|| {
                    names.push(name.clone());
                    names.len() - 1
                });
                if column >= MAX_COLUMNS {
                    return Err(FormatError::TooMany {
                        place: point.place.cell(0),
                        what: "properties",
                        max: MAX_COLUMNS,
                    });
                }
                if cells.len() <= column {
                    cells.resize(column + 1, String::new());
                }
                cells[column] = cell(value);
            }
            table.push(Row::new(point.place, &cells))?;
        }
        table.header = Some(names);
        table.fixed = vec![Role::X, Role::Y];
        table.rings = self.rings;
        let told = own.filter(|_| options.columns.is_empty()).and_then(choice);
        match told {
            Some(columns) => table.into_reading(FileFormat::GeoJson, &ReadOptions { columns, ..options.clone() }),
            None => table.into_reading(FileFormat::GeoJson, options),
        }
    }
}

/// Domain, boundary and classes that [`write_geojson`] left beside the features.
fn declared(own: &Map<String, Value>) -> Declared {
    let mut declared = Declared::default();
    let corners: Option<Vec<f64>> =
        own.get("domain").and_then(Value::as_array).and_then(|list| list.iter().map(Value::as_f64).collect());
    if let Some(&[x0, y0, x1, y1]) = corners.as_deref() {
        declared.domain = Domain::new(DVec2::new(x0, y0), DVec2::new(x1 - x0, y1 - y0)).ok();
    }
    declared.boundary = match own.get("boundary").and_then(Value::as_str) {
        Some("periodic") => Some(Boundary::Periodic),
        Some("open") => Some(Boundary::Open),
        _ => None,
    };
    let names = own.get("classes").and_then(Value::as_array);
    declared.classes = names.into_iter().flatten().filter_map(Value::as_str).map(str::to_owned).collect();
    if declared.classes.iter().any(|name| crate::pattern::check_name(name).is_err()) {
        declared.classes.clear();
    }
    declared.classes.dedup();
    declared
}

/// Which properties [`write_geojson`] wrote what as.
fn choice(own: &Map<String, Value>) -> Option<ColumnChoice> {
    let class = own.get("class").and_then(Value::as_str).unwrap_or_default().to_owned();
    let attributes = own.get("attributes").and_then(Value::as_array)?;
    let pair = |pair: &Value| Some((pair.get(0)?.as_str()?.to_owned(), pair.get(1)?.as_str()?.to_owned()));
    let attributes = attributes.iter().map(pair).collect::<Option<Vec<_>>>()?;
    Some(ColumnChoice { class: Some(class), attributes: Some(attributes), ..ColumnChoice::default() })
}

/// Writes a pattern as a collection of points: in degrees where the exemplar's were, else as its positions are, and with
/// class and attributes under the names they had. Domain and boundary stand beside the features, so that it reads back.
#[must_use]
pub fn write_geojson(pattern: &PointPattern, origin: &Origin) -> String {
    let degrees = |position: DVec2| origin.projection.map_or(position, |projection| projection.unproject(position));
    let (low, high) = (degrees(pattern.domain().min()), degrees(pattern.domain().max()));
    let round = |value: f64| if origin.projection.is_some() { (value * DECIMALS).round() / DECIMALS } else { value };
    let with_class = pattern.class_names() != ["points"];
    let class = origin.class.as_deref().unwrap_or("class");
    let mut properties: Vec<String> = Vec::new();
    for attribute in pattern.attributes() {
        let mut name = origin.header(&attribute.name).to_owned();
        while with_class && name == class || properties.contains(&name) {
            name.push('_');
        }
        properties.push(name);
    }
    let features: Vec<Value> = (0..pattern.len())
        .map(|i| {
            // Rounding must leave no point outside of the domain.
            let [x, y] = degrees(pattern.positions()[i]).to_array();
            let coordinates = [round(x).clamp(low.x, high.x), round(y).clamp(low.y, high.y)];
            let mut own = Map::new();
            if with_class {
                own.insert(class.to_owned(), pattern.class_names()[usize::from(pattern.classes()[i])].clone().into());
            }
            for (attribute, name) in pattern.attributes().iter().zip(&properties) {
                own.insert(name.clone(), attribute.values[i].into());
            }
            json!({"type": "Feature", "geometry": {"type": "Point", "coordinates": coordinates}, "properties": own})
        })
        .collect();
    let names = pattern.attributes().iter().map(|attribute| attribute.name.clone());
    let attributes: Vec<Value> = names.zip(properties).map(|(name, property)| json!([name, property])).collect();
    json!({
        "type": "FeatureCollection",
        MEMBER: {
            "domain": [low.x, low.y, high.x, high.y],
            "boundary": pattern.boundary().name(),
            "class": with_class.then_some(class),
            "classes": if with_class { pattern.class_names() } else { &[] },
            "attributes": attributes,
        },
        "features": features,
    })
    .to_string()
        + "\n"
}
