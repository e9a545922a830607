//! GeoJSON as the exemplar's file had it: in its coordinates and under its names.

use serde_json::{Map, Value, json};

use super::Origin;
use super::geojson::OWN_MEMBER;
use super::table::ATTRIBUTE_PREFIX;
use crate::pattern::{Domain, PointPattern};

/// Decimals of degrees: half a unit of the last one is 0.06 mm.
pub(super) const DECIMALS: i32 = 9;

/// Writes a pattern as a collection of points: in degrees where the exemplar's were, else as its positions are, and with
/// class and attributes under the names they had. A member `pointweave` beside the features holds what GeoJSON has no
/// word for: the rectangle in the same coordinates, the boundary, the classes in their order, which property is what, and how
/// degrees had become metres.
#[must_use]
pub fn write_geojson(pattern: &PointPattern, origin: &Origin) -> String {
    let scale = 10_f64.powi(DECIMALS);
    let rounded = |degrees: f64| (degrees * scale).round() / scale;
    let has_classes = pattern.class_names() != ["points"];
    let names = names(pattern, origin, has_classes);
    let features: Vec<Value> = (0..pattern.len())
        .map(|i| {
            let position = pattern.positions()[i];
            let coordinates = match origin.projection {
                Some(projection) => projection.unproject(position).to_array().map(rounded),
                None => position.to_array(),
            };
            let mut properties = Map::new();
            let mut names = names.iter();
            if let Some(name) = names.next().filter(|_| has_classes) {
                let class = usize::from(pattern.classes()[i]);
                properties.insert(name.clone(), pattern.class_names()[class].clone().into());
            }
            for (name, attribute) in names.zip(pattern.attributes()) {
                properties.insert(name.clone(), attribute.values[i].into());
            }
            json!({"type": "Feature", "geometry": {"type": "Point", "coordinates": coordinates}, "properties": properties})
        })
        .collect();
    let mut own = Map::new();
    own.insert("domain".to_owned(), domain(pattern.domain(), origin));
    own.insert("boundary".to_owned(), pattern.boundary().name().into());
    if has_classes {
        own.insert("class".to_owned(), names[0].clone().into());
        own.insert("classes".to_owned(), pattern.class_names().into());
    }
    let attributes = names[1..].iter().zip(pattern.attributes()).map(|(name, attribute)| json!([name, attribute.name]));
    own.insert("attributes".to_owned(), attributes.collect());
    let projection = origin.projection.map(|it| json!({"longitude": it.longitude, "latitude": it.latitude}));
    own.insert("projection".to_owned(), projection.into());
    json!({"type": "FeatureCollection", OWN_MEMBER: own, "features": features}).to_string() + "\n"
}

/// The names of the properties: the class's, used or not, then the attributes'. No two are alike.
fn names(pattern: &PointPattern, origin: &Origin, has_classes: bool) -> Vec<String> {
    let mut names = vec![origin.class.clone().unwrap_or_else(|| "class".to_owned())];
    for attribute in pattern.attributes() {
        let mut name = origin.header(&attribute.name).to_owned();
        while names[usize::from(!has_classes)..].contains(&name) {
            name.insert_str(0, ATTRIBUTE_PREFIX);
        }
        names.push(name);
    }
    names
}

/// The corners, where they tell the size without loss, or corner and size.
fn domain(domain: Domain, origin: &Origin) -> Value {
    let (min, max) = (domain.min(), domain.max());
    if let Some(projection) = origin.projection {
        let low = projection.unproject(min);
        // Beyond the 180th meridian, but to the east of the other corner.
        let mut high = projection.unproject(max);
        if high.x < low.x {
            high.x += 360.0;
        }
        json!([low.x, low.y, high.x, high.y])
    } else if max - min == domain.size() {
        json!([min.x, min.y, max.x, max.y])
    } else {
        json!({"min": min.to_array(), "size": domain.size().to_array()})
    }
}
