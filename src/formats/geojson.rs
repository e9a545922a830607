//! GeoJSON (RFC 7946): `Point` and `MultiPoint`, alone, in features or in collections, also one a line; and back.
//!
//! Degrees of one place become metres about it (see [`Projection`](super::Projection)), unless the file names another system
//! of coordinates. A polygon around the points is their window. Properties are columns like those of a table.

use std::collections::{HashMap, HashSet};

use glam::DVec2;
use serde::Deserialize as _;
use serde_json::{Map, Value, json};

use super::declaration::Declared;
use super::error::{FormatError, clip};
use super::json::{cell, entry_places, kind, layout, layout_at, member_place};
use super::note::counted;
use super::origin::Projection;
use super::table::{MAX_COLUMNS, Role, Row, RowPlace, Table};
use super::{ColumnChoice, FileFormat, Note, Origin, ReadOptions, Reading};
use crate::pattern::{Boundary, Domain, MAX_ATTRIBUTES, MAX_CLASSES, MAX_CORNERS, PointPattern, check_name};

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
/// How far beyond the domain's border arithmetic puts a point that was written on it, as a share of the longer side.
const ROUNDING: f64 = 1e-8;

/// What is collected on the way.
#[derive(Default)]
struct Found<'a> {
    points: Vec<Point<'a>>,
    /// The closed lines of each area.
    rings: Vec<Vec<Vec<DVec2>>>,
    corners: usize,
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

/// Whether coordinates are no degrees: a member `crs` of 2008's GeoJSON may say so. The geographic systems of the EPSG are
/// numbered from 4000 to 4999, but for the latest ones.
fn names_another_system(object: &Map<String, Value>) -> bool {
    const LATER: [u32; 8] = [5451, 6318, 6668, 6706, 7844, 8999, 9000, 9755];
    let name = object.get("crs").and_then(|crs| crs.get("properties")?.get("name")?.as_str());
    let Some(code) = name.and_then(|name| name.rsplit([':', '/']).next()) else { return false };
    match code.parse::<u32>() {
        Ok(number) => !(4000..5000).contains(&number) && !LATER.contains(&number),
        Err(_) => !["CRS84", "CRS83", "CRS27", "WGS84", "WGS 84"].iter().any(|known| code.contains(known)),
    }
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
                    let mut rings = Vec::new();
                    self.take_rings(coordinates, 0, &mut rings);
                    self.rings.extend(Some(rings).filter(|rings| !rings.is_empty()));
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
    fn take_rings(&mut self, coordinates: &Value, depth: usize, rings: &mut Vec<Vec<DVec2>>) {
        let Value::Array(list) = coordinates else { return };
        let corner = |value: &Value| Some(DVec2::new(value.get(0)?.as_f64()?, value.get(1)?.as_f64()?));
        let ring: Option<Vec<DVec2>> = list.iter().map(corner).collect();
        match ring {
            Some(ring) if ring.len() >= 3 && self.corners + ring.len() <= MAX_CORNERS => {
                self.corners += ring.len();
                rings.push(ring);
            }
            Some(_) => {}
            None if depth < 3 => list.iter().for_each(|inner| self.take_rings(inner, depth + 1, rings)),
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
        let shapes = self.lines + self.areas;
        if self.points.is_empty() && shapes > 0 {
            let others = counted(shapes, "one shape that is none", "shapes that are none");
            let message = format!("it has no points, but {others}; make points of them first, as their centroids");
            return Err(layout_at(None, message));
        }
        let mut table = Table::new(own.map(declared).unwrap_or_default());
        table.notes = self.notes();
        table.is_in_degrees = is_in_degrees;
        if let Some(own) = own {
            // What was no degrees may look like them.
            let told = own.get("projection");
            table.is_in_degrees &= !told.is_some_and(Value::is_null);
            let projection = told.and_then(|value| serde_json::from_value::<Projection>(value.clone()).ok());
            table.projection = projection.filter(|projection| projection.is_usable());
            table.rounding = ROUNDING;
        }
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
        let told = own.filter(|_| options.columns.is_empty()).and_then(choice);
        let is_there = |name: &str| columns.contains_key(name);
        let told = told.filter(|told| {
            told.class.iter().all(|name| name.is_empty() || is_there(name))
                && told.attributes.iter().flatten().all(|(_, property)| is_there(property))
        });
        table.header = Some(names);
        table.fixed = vec![Role::X, Role::Y];
        table.rings = self.rings;
        match told {
            Some(columns) => table.into_reading(FileFormat::GeoJson, &ReadOptions { columns, ..options.clone() }),
            None => table.into_reading(FileFormat::GeoJson, options),
        }
    }
}

/// Domain, boundary and classes that [`write_geojson`] left beside the features.
fn declared(own: &Map<String, Value>) -> Declared {
    let domain = own.get("domain").and_then(|value| match <[f64; 4]>::deserialize(value) {
        Ok([x0, y0, x1, y1]) => Domain::new(DVec2::new(x0, y0), DVec2::new(x1 - x0, y1 - y0)).ok(),
        Err(_) => Domain::deserialize(value).ok(),
    });
    let mut declared = Declared { domain, ..Declared::default() };
    declared.boundary = own.get("boundary").and_then(|value| Boundary::deserialize(value).ok());
    let names = own.get("classes").and_then(Value::as_array);
    declared.classes = names.into_iter().flatten().filter_map(Value::as_str).map(str::to_owned).collect();
    if !are_names(declared.classes.iter(), MAX_CLASSES) {
        declared.classes.clear();
    }
    declared
}

/// Whether all are names, and no two alike, and no more than there may be.
fn are_names<'a>(names: impl Iterator<Item = &'a String> + Clone, most: usize) -> bool {
    let different: HashSet<&String> = names.clone().collect();
    let count = names.clone().count();
    different.len() == count && count <= most && names.into_iter().all(|name| check_name(name).is_ok())
}

/// Which properties [`write_geojson`] wrote what as.
fn choice(own: &Map<String, Value>) -> Option<ColumnChoice> {
    let class = match own.get("class") {
        None | Some(Value::Null) => String::new(),
        Some(value) => value.as_str()?.to_owned(),
    };
    let attributes: Vec<(String, String)> = serde_json::from_value(own.get("attributes")?.clone()).ok()?;
    let properties = attributes.iter().map(|(_, property)| property);
    let all: HashSet<&String> = properties.chain([&class]).collect();
    if !are_names(attributes.iter().map(|(name, _)| name), MAX_ATTRIBUTES) || all.len() != attributes.len() + 1 {
        return None;
    }
    Some(ColumnChoice { class: Some(class), attributes: Some(attributes), ..ColumnChoice::default() })
}

/// Writes a pattern as a collection of points: in degrees where the exemplar's were, else as its positions are, and with
/// class and attributes under the names they had. Domain and boundary stand beside the features, so that it reads back.
#[must_use]
pub fn write_geojson(pattern: &PointPattern, origin: &Origin) -> String {
    let degrees = |position: DVec2| origin.projection.map_or(position, |projection| projection.unproject(position));
    let (low, mut high) = (degrees(pattern.domain().min()), degrees(pattern.domain().max()));
    // Across the 180th meridian the far corner is beyond it, as the rest is.
    if high.x < low.x {
        high.x += 360.0;
    }
    // Corners may tell a size only roughly.
    let domain = if origin.projection.is_none() && high - low != pattern.domain().size() {
        json!({"min": low.to_array(), "size": pattern.domain().size().to_array()})
    } else {
        json!([low.x, low.y, high.x, high.y])
    };
    let eastwards = |x: f64| if high.x > 180.0 && x < low.x - 180.0 { x + 360.0 } else { x };
    let on_earth = |x: f64| if origin.projection.is_some() && x > 180.0 { x - 360.0 } else { x };
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
            let coordinates = [on_earth(round(eastwards(x)).max(low.x).min(high.x)), round(y).max(low.y).min(high.y)];
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
            "domain": domain,
            "boundary": pattern.boundary().name(),
            "class": with_class.then_some(class),
            "classes": if with_class { pattern.class_names() } else { &[] },
            "attributes": attributes,
            "projection": origin.projection,
        },
        "features": features,
    })
    .to_string()
        + "\n"
}
