//! GeoJSON (RFC 7946): `Point` and `MultiPoint`, alone, in features or in collections, in one object, in a list or one
//! object a line. Degrees become metres on a plane (`origin.rs`) unless coordinates go beyond ±180 and ±90 or a member `crs`
//! names a projected system. Properties are the columns of a table. A polygon around the points is their window.
//!
//! What [`write_geojson`](super::write_geojson) writes has a member `pointweave` beside the features: the rectangle and the
//! boundary, the classes in their order, and how degrees had become metres.

use std::collections::HashSet;

use glam::DVec2;
use serde_json::{Map, Value};

use super::declaration::{Declared, number_text};
use super::error::{FormatError, clip};
use super::geo_area::{self, Area};
use super::json::{domain, entry_places, kind, layout, layout_at};
use super::note::counted;
use super::origin::{self, Projection};
use super::records::{cell, union};
use super::table::{Role, Row, RowPlace, Table};
use super::{FileFormat, Note, ReadOptions, Reading};
use crate::pattern::{Boundary, Domain, MAX_ATTRIBUTES, MAX_CLASSES, MAX_POINTS, Window, check_name};

/// Geometries that hold no points.
const OTHER_SHAPES: [&str; 4] = ["LineString", "MultiLineString", "Polygon", "MultiPolygon"];
/// Collections within collections.
const MAX_DEPTH: usize = 8;
/// The member that only our own files have.
pub(super) const OWN_MEMBER: &str = "pointweave";
/// How far rounding to [`DECIMALS`](super::geojson_out::DECIMALS) may have put a point beyond the domain's border, as a
/// share of its longer side: for rounded degrees of a domain a metre wide it is a ten thousandth.
const ROUNDING: f64 = 1e-12;
const ROUNDING_METRES: f64 = 1.2e-4;

/// What is collected on the way.
#[derive(Default)]
struct Found<'a> {
    points: Vec<Point<'a>>,
    areas: Vec<Area<'a>>,
    polygons: usize,
    lines: usize,
    /// Points and features without coordinates.
    without_place: usize,
    /// Points with a third coordinate.
    heights: usize,
}

struct Point<'a> {
    place: RowPlace,
    position: DVec2,
    properties: Option<&'a Map<String, Value>>,
}

/// Whether an object says that it is GeoJSON.
pub(super) fn is_geojson(object: &Map<String, Value>) -> bool {
    let known = ["FeatureCollection", "Feature", "GeometryCollection", "Point", "MultiPoint"];
    let type_of = object.get("type").and_then(Value::as_str);
    type_of.is_some_and(|name| known.contains(&name) || OTHER_SHAPES.contains(&name))
}

/// Reads one object of GeoJSON or several, with the line and character of each.
pub(super) fn read(
    text: &str,
    objects: &[Value],
    places: &[(usize, usize)],
    options: &ReadOptions,
) -> Result<Reading, FormatError> {
    let mut found = Found::default();
    for (index, value) in objects.iter().enumerate() {
        let place = RowPlace::Entry(index + 1, places.get(index).copied());
        let object = match value {
            Value::Object(object) if is_geojson(object) => object,
            Value::Object(_) => return Err(layout_at(at(place), "an object has no 'type' of GeoJSON".to_owned())),
            other => {
                return Err(layout_at(at(place), format!("a feature is {}, but must be a 'Feature'", kind(other))));
            }
        };
        match object.get("features") {
            Some(Value::Array(features)) => {
                let inner = if objects.len() == 1 { entry_places(text, &["features"]) } else { Vec::new() };
                for (index, feature) in features.iter().enumerate() {
                    let own = inner.get(index).copied().or(at(place));
                    found.feature(feature, RowPlace::Entry(index + 1, own))?;
                }
            }
            Some(_) => {
                let message = "'features' must be a list".to_owned();
                return Err(if objects.len() == 1 {
                    layout(text, &["features"], message)
                } else {
                    layout_at(at(place), message)
                });
            }
            None => found.object(object, place, None, 0)?,
        }
    }
    let objects: Vec<&Map<String, Value>> = objects.iter().filter_map(Value::as_object).collect();
    let own = objects.iter().find_map(|object| object.get(OWN_MEMBER)).and_then(Value::as_object);
    let crs = objects.iter().find_map(|object| object.get("crs"));
    found.into_reading(text, own.map(Own::of), crs, options)
}

/// What [`write_geojson`](super::write_geojson) says beside the features. What of it can't be, is not.
#[derive(Default)]
struct Own {
    domain: Option<Domain>,
    boundary: Option<Boundary>,
    classes: Vec<String>,
    /// The property of the class.
    class: Option<String>,
    /// The properties of the attributes, each with the attribute's name.
    attributes: Vec<(String, String)>,
    projection: Option<Projection>,
}

/// Whether all are names, and no two alike, and no more than there may be.
fn are_names(names: &[&String], most: usize) -> bool {
    let mut sorted = names.to_vec();
    sorted.sort_unstable();
    sorted.dedup();
    sorted.len() == names.len() && names.len() <= most && names.iter().all(|name| check_name(name).is_ok())
}

impl Own {
    fn of(member: &Map<String, Value>) -> Self {
        let member = |name: &str| member.get(name).filter(|value| !value.is_null());
        fn list<T: serde::de::DeserializeOwned>(value: Option<&Value>) -> Vec<T> {
            value.and_then(|value| serde_json::from_value(value.clone()).ok()).unwrap_or_default()
        }
        let mut classes: Vec<String> = list(member("classes"));
        if !are_names(&classes.iter().collect::<Vec<_>>(), MAX_CLASSES) {
            classes.clear();
        }
        let mut attributes: Vec<(String, String)> = list(member("attributes"));
        let (properties, names): (Vec<&String>, Vec<&String>) =
            attributes.iter().map(|(property, name)| (property, name)).unzip();
        if !are_names(&names, MAX_ATTRIBUTES) || properties.iter().collect::<HashSet<_>>().len() != properties.len() {
            attributes.clear();
        }
        Self {
            domain: member("domain").and_then(|value| domain(value).ok()),
            boundary: member("boundary").and_then(|value| serde_json::from_value(value.clone()).ok()),
            classes,
            class: member("class").and_then(Value::as_str).map(str::to_owned),
            attributes,
            projection: member("projection")
                .and_then(|value| serde_json::from_value::<Projection>(value.clone()).ok())
                .filter(|projection| projection.is_usable()),
        }
    }

    /// Puts the properties whose meaning is told in front; their roles.
    fn arrange(&self, names: &mut Vec<&str>) -> Vec<Role> {
        let mut roles = Vec::new();
        let class = self.class.iter().map(|property| (property, Role::Class));
        let attributes = self.attributes.iter().map(|(property, name)| (property, Role::Attribute(name.clone())));
        for (property, role) in class.chain(attributes) {
            if let Some(at) = names.iter().skip(roles.len()).position(|name| name == property) {
                let name = names.remove(roles.len() + at);
                names.insert(roles.len(), name);
                roles.push(role);
            }
        }
        roles
    }
}

/// Whether a member `crs` of GeoJSON 2008 names a system whose coordinates are no degrees. The geographic systems of the EPSG
/// are numbered from 4000 to 4999, but for the latest ones.
fn is_projected(crs: Option<&Value>) -> bool {
    const LATER: [u32; 8] = [5451, 6318, 6668, 6706, 7844, 8999, 9000, 9755];
    let Some(name) = crs.and_then(|crs| crs.get("properties")).and_then(|it| it.get("name")).and_then(Value::as_str)
    else {
        return false;
    };
    let code = name.rsplit([':', '/']).next().unwrap_or_default();
    match code.parse::<u32>() {
        Ok(number) => !(4000..5000).contains(&number) && !LATER.contains(&number),
        Err(_) => !["CRS84", "CRS83", "CRS27", "CRS84h", "WGS84"].iter().any(|known| known.eq_ignore_ascii_case(code)),
    }
}

fn at(place: RowPlace) -> Option<(usize, usize)> {
    match place {
        RowPlace::Entry(_, at) => at,
        RowPlace::Line(line) => Some((line, 1)),
    }
}

impl<'a> Found<'a> {
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
            // RFC 7946 lets both be nothing.
            ("Feature", _, None | Some(Value::Null), _) | ("Point" | "MultiPoint", Some(Value::Null), ..) => {
                self.without_place += 1;
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
                self.without_place += usize::from(positions.is_empty());
                for position in positions {
                    match position {
                        Value::Array(position) => self.push(position, place, properties)?,
                        other => return refuse(format!("a position is {}, but must be a list", kind(other))),
                    }
                }
                Ok(())
            }
            (name, coordinates, ..) if OTHER_SHAPES.contains(&name) => {
                let polygons = match (name, coordinates) {
                    ("Polygon", Some(Value::Array(rings))) => Some(vec![rings.as_slice()]),
                    ("MultiPolygon", Some(Value::Array(polygons))) => {
                        Some(polygons.iter().filter_map(Value::as_array).map(Vec::as_slice).collect())
                    }
                    _ => None,
                };
                if name.ends_with("Polygon") {
                    self.polygons += 1;
                } else {
                    self.lines += 1;
                }
                self.areas.extend(polygons.map(Area));
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
        if position.iter().all(Value::is_null) {
            self.without_place += 1;
            return Ok(());
        }
        let position = match position {
            [x, y, rest @ ..] => {
                self.heights += usize::from(rest.first().is_some_and(Value::is_number));
                x.as_f64().zip(y.as_f64())
            }
            _ => None,
        };
        let Some(position) = position.map(DVec2::from) else {
            return Err(layout_at(at(place), "a position must begin with two numbers".to_owned()));
        };
        if self.points.len() >= MAX_POINTS {
            return Err(FormatError::TooMany { place: place.cell(0), what: "points", max: MAX_POINTS });
        }
        self.points.push(Point { place, position, properties });
        Ok(())
    }

    fn into_reading(
        self,
        text: &str,
        own: Option<Own>,
        crs: Option<&Value>,
        options: &ReadOptions,
    ) -> Result<Reading, FormatError> {
        let mut notes = Vec::new();
        if self.points.is_empty() && self.polygons + self.lines > 0 {
            let message =
                format!("it has no points, but {}; make points of them first, as their centroids", self.shapes());
            return Err(layout(text, &[], message));
        }
        let positions: Vec<DVec2> = self.points.iter().map(|point| point.position).collect();
        let is_in_degrees = match &own {
            Some(own) => own.projection.is_some(),
            None => !is_projected(crs) && origin::are_on_earth(&positions),
        };
        let has_own_domain = own.as_ref().is_some_and(|own| own.domain.is_some());
        let crosses = is_in_degrees && origin::cross_the_antimeridian(&positions);
        let window = geo_area::around(&self.areas, &positions, crosses);

        let own = own.unwrap_or_default();
        let properties = || self.points.iter().filter_map(|point| point.properties);
        let mut names = union(properties(), self.points.len(), ["property", "properties"], &mut notes);
        let chosen = &options.columns;
        // What a person chooses is not told twice.
        let roles = if chosen.is_empty() { own.arrange(&mut names) } else { Vec::new() };
        let mut table = Table::new(Declared { domain: own.domain, boundary: own.boundary, classes: own.classes });
        table.is_in_degrees = is_in_degrees;
        table.projection = own.projection;
        if let Some(domain) = own.domain {
            let side = own.projection.map_or(f64::INFINITY, |it| {
                it.project_domain(domain).map_or(0.0, |domain| domain.size().max_element())
            });
            table.rounding = ROUNDING.max(ROUNDING_METRES / side);
        } else if let Some(window) = window.as_ref().filter(|_| !(crosses && options.keeps_degrees)) {
            table.declared.domain = window.domain(&positions, crosses);
        }
        if chosen.x.is_none() && chosen.y.is_none() {
            table.fixed = [Role::X, Role::Y].into_iter().chain(roles).collect();
        }
        for point in &self.points {
            let coordinates = point.position.to_array().map(number_text);
            let property = |name: &&str| point.properties.and_then(|it| it.get(*name)).map(cell).unwrap_or_default();
            table.push(Row::new(point.place, coordinates.into_iter().chain(names.iter().map(property))))?;
        }
        table.header = Some(["x", "y"].iter().chain(&names).map(|&name| name.to_owned()).collect());

        self.say(window.as_ref().map(|window| window.area), &mut notes);
        let mut reading = table.into_reading(FileFormat::GeoJson, options)?;
        if let Some(window) = window {
            let projection = reading.origin.projection;
            let rings = window.rings(projection);
            match Window::new(rings) {
                Ok(outline) => {
                    let outside = counted(window.outside, "; one point lies outside", "points lie outside");
                    let outside = match window.outside {
                        0 => String::new(),
                        1 => outside,
                        _ => format!("; {outside}"),
                    };
                    let domain = if has_own_domain { "" } else { ", and the rectangle around it for the domain" };
                    notes.push(Note::changed(format!(
                        "The polygon around the points was taken for their window{domain}{outside}."
                    )));
                    reading.window = Some(outline);
                }
                Err(error) => {
                    notes.push(Note::left_out(format!("The polygon around the points can't be their window: {error}.")))
                }
            }
        }
        reading.notes.splice(0..0, notes);
        Ok(reading)
    }

    fn shapes(&self) -> String {
        let polygons = counted(self.polygons, "1 polygon", "polygons");
        let lines = counted(self.lines, "1 line", "lines");
        match (self.polygons, self.lines) {
            (_, 0) => polygons,
            (0, _) => lines,
            _ => format!("{polygons} and {lines}"),
        }
    }

    /// What was left out. The area that is the window was not.
    fn say(&self, window: Option<usize>, notes: &mut Vec<Note>) {
        if self.without_place > 0 {
            let features = counted(self.without_place, "One point or feature has", "points or features have");
            let was = if self.without_place == 1 { "was" } else { "were" };
            notes.push(Note::left_out(format!(
                "{features} no coordinates and {was} left out. Add the coordinates if the points are needed."
            )));
        }
        let others =
            Found { polygons: self.polygons - usize::from(window.is_some()), lines: self.lines, ..Found::default() };
        match others.polygons + others.lines {
            0 => {}
            1 => notes.push(Note::left_out(format!("One shape that is no point was left out: {}.", others.shapes()))),
            count => notes
                .push(Note::left_out(format!("{count} shapes that are no points were left out: {}.", others.shapes()))),
        }
        if self.heights > 0 {
            let points = counted(self.heights, "One point has", "points have");
            notes.push(Note::left_out(format!("{points} a third coordinate, a height, which was left out.")));
        }
    }
}
