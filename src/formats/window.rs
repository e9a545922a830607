//! Outlines of windows: GeoJSON polygons, or corners one a line.

use glam::DVec2;
use serde_json::Value;

use super::Origin;
use super::error::{FormatError, Place, clip};
use super::json::located;
use crate::pattern::{MAX_CORNERS, Window};

/// Reads the window that a pattern was cut from, in the pattern's unit. Degrees are projected as the pattern's were, which
/// `origin` tells.
///
/// | text | window |
/// |---|---|
/// | GeoJSON: Polygon, MultiPolygon, or a Feature, FeatureCollection or GeometryCollection of them | all of them together |
/// | JSON: `[[x, y], …]`, or a list of such lists | one outline, or several: what lies within an odd number of them |
/// | two numbers a line, separated by blanks, commas, semicolons or tabs; a line of words is a header | one outline; an empty line begins another |
///
/// # Errors
/// When the text is none of these, or the outline bounds no area.
pub fn read_window(bytes: &[u8], origin: &Origin) -> Result<Window, FormatError> {
    if bytes.len() > super::MAX_BYTES {
        return Err(FormatError::TooLarge { bytes: bytes.len(), max: super::MAX_BYTES });
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let text =
        std::str::from_utf8(bytes).map_err(|_| FormatError::Kind { kind: "no text (a window is GeoJSON or text)" })?;
    let rings = if text.trim_start().starts_with(['{', '[']) {
        let value: Value = serde_json::from_str(text).map_err(|error| located(&error))?;
        let mut rings = Vec::new();
        collect(&value, &mut rings);
        rings
    } else {
        corners(text)?
    };
    let place = |corner: DVec2| origin.projection.map_or(corner, |projection| projection.project(corner));
    let rings = rings.into_iter().map(|ring| ring.into_iter().map(place).collect()).collect();
    Ok(Window::new(rings)?)
}

/// The rings of all polygons in a value, whatever stands around them.
fn collect(value: &Value, rings: &mut Vec<Vec<DVec2>>) {
    match value {
        Value::Object(members) => {
            // Other geometries bound nothing.
            let kind = members.get("type").and_then(Value::as_str).unwrap_or_default();
            if matches!(kind, "Point" | "MultiPoint" | "LineString" | "MultiLineString") {
                return;
            }
            for name in ["coordinates", "geometry", "geometries", "features"] {
                if let Some(inner) = members.get(name) {
                    collect(inner, rings);
                }
            }
        }
        Value::Array(items) => {
            let corner = |item: &Value| {
                let numbers = item.as_array()?;
                Some(DVec2::new(numbers.first()?.as_f64()?, numbers.get(1)?.as_f64()?))
            };
            match items.iter().map(corner).collect::<Option<Vec<DVec2>>>() {
                Some(ring) if !ring.is_empty() => rings.push(ring),
                _ => items.iter().for_each(|item| collect(item, rings)),
            }
        }
        _ => {}
    }
}

/// Corners one a line.
fn corners(text: &str) -> Result<Vec<Vec<DVec2>>, FormatError> {
    let mut rings: Vec<Vec<DVec2>> = vec![Vec::new()];
    let mut count = 0;
    for (number, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.starts_with('#') {
            continue;
        }
        if line.is_empty() {
            if rings.last().is_some_and(|ring| !ring.is_empty()) {
                rings.push(Vec::new());
            }
            continue;
        }
        let cells: Vec<&str> =
            line.split([',', ';', '\t', ' ']).map(str::trim).filter(|cell| !cell.is_empty()).collect();
        let numbers: Option<Vec<f64>> = cells.iter().take(2).map(|cell| cell.trim_matches('"').parse().ok()).collect();
        match numbers.as_deref() {
            Some(&[x, y]) => {
                count += 1;
                if count > MAX_CORNERS {
                    let place = Place::Line { line: number + 1, column: 1 };
                    return Err(FormatError::TooMany { place, what: "corners", max: MAX_CORNERS });
                }
                if let Some(ring) = rings.last_mut() {
                    ring.push(DVec2::new(x, y));
                }
            }
            _ if count == 0 => {}
            _ => {
                return Err(FormatError::Value {
                    place: Place::Line { line: number + 1, column: 1 },
                    name: "a corner".to_owned(),
                    value: clip(line),
                    allowed: "two numbers, x and y".to_owned(),
                });
            }
        }
    }
    rings.retain(|ring| !ring.is_empty());
    Ok(rings)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    fn area(text: &str) -> f64 {
        read_window(text.as_bytes(), &Origin::default()).unwrap().area()
    }

    #[test]
    fn polygons_and_corners() {
        let polygon =
            r#"{"type":"Polygon","coordinates":[[[0,0],[4,0],[4,4],[0,4],[0,0]],[[1,1],[2,1],[2,2],[1,2],[1,1]]]}"#;
        assert_eq!(area(polygon), 15.0);
        assert_eq!(area(&format!(r#"{{"type":"Feature","properties":{{"a":[[9,9]]}},"geometry":{polygon}}}"#)), 15.0);
        let point = r#"{"type":"Feature","geometry":{"type":"Point","coordinates":[1,1]}}"#;
        let both = format!(
            r#"{{"type":"FeatureCollection","features":[{point},{{"type":"Feature","geometry":{{"type":"MultiPolygon","coordinates":[[[[0,0],[1,0],[0,1]]],[[[5,5],[6,5],[5,6]]]]}}}}]}}"#
        );
        assert_eq!(area(&both), 1.0);
        assert_eq!(area("[[0,0],[2,0],[2,1],[0,1]]"), 2.0);
        assert_eq!(area("x,y\n0,0\n2,0\n2,1\n0,1\n"), 2.0);
        assert_eq!(area("# a comment\n0 0\n4 0\n4 4\n0 4\n\n1;1\n2;1\n2;2\n1;2\n"), 15.0);
    }

    #[test]
    fn what_bounds_nothing_is_refused_in_words() {
        for (text, words) in [
            ("", "no outline"),
            ("0,0\n1,1\n", "at least 3"),
            ("0,0\n1,1\n2,x\n", "line 3"),
            ("0,0\n1,1\n2,2\n", "no area"),
            (r#"{"type":"Point","coordinates":[1,2]}"#, "no outline"),
            ("[[0,0],[1,", "line 1"),
        ] {
            let error = read_window(text.as_bytes(), &Origin::default()).unwrap_err().to_string();
            assert!(error.contains(words), "{text}: {error}");
        }
    }
}
