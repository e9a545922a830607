//! JSON and GeoJSON as programs write them: lines, sequences, gaps, records, degrees, and the way back.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use glam::DVec2;
use pointweave::formats::{FileFormat, Note, NoteKind, Origin, ReadOptions, Reading, open, write_geojson};
use pointweave::{Attribute, Boundary, Domain, PointPattern};
use serde_json::{Value, json};

const SPECIES: [&str; 3] = ["ash", "lime", "yew"];

/// Forty points in a jittered grid, 80 × 50, far from the origin of degrees.
fn grid() -> Vec<[f64; 2]> {
    (0..40)
        .map(|i: i32| {
            let jitter = |k: i32| f64::from((i * k) % 7 - 3) * 0.4;
            [f64::from(i % 8) * 10.0 + 400.0 + jitter(3), f64::from(i / 8) * 10.0 + 300.0 + jitter(5)]
        })
        .collect()
}

fn feature(place: impl Into<Value>, properties: Value) -> Value {
    json!({"type": "Feature", "properties": properties, "geometry": {"type": "Point", "coordinates": place.into()}})
}

fn collection(features: &[Value]) -> String {
    json!({"type": "FeatureCollection", "features": features}).to_string()
}

fn features() -> Vec<Value> {
    let place =
        |(i, at): (usize, [f64; 2])| feature(at.to_vec(), json!({"species": SPECIES[i % 3], "dbh": 20.5 + i as f64}));
    grid().into_iter().enumerate().map(place).collect()
}

#[track_caller]
fn opened_with(text: &str, options: &ReadOptions) -> Reading {
    open(text.as_bytes(), None, options).unwrap_or_else(|error| panic!("{text:.300}\n{error}"))
}

#[track_caller]
fn opened(text: &str) -> Reading {
    opened_with(text, &ReadOptions::default())
}

#[track_caller]
fn refused(text: &str, parts: &[&str]) {
    let error = open(text.as_bytes(), None, &ReadOptions::default()).expect_err(text).to_string();
    for part in parts {
        assert!(error.contains(part), "{text:.200}\n  says    {error:?}\n  without {part:?}");
    }
}

#[track_caller]
fn noted(reading: &Reading, kind: NoteKind, part: &str) {
    let found = reading.notes.iter().any(|note| note.kind == kind && note.text.contains(part));
    assert!(found, "{:#?} without {part:?}", reading.notes);
}

fn xy(pattern: &PointPattern) -> Vec<[f64; 2]> {
    pattern.positions().iter().map(|point| point.to_array()).collect()
}

fn classes(pattern: &PointPattern) -> Vec<&str> {
    pattern.classes().iter().map(|&class| pattern.class_names()[usize::from(class)].as_str()).collect()
}

fn texts(notes: &[Note]) -> Vec<&str> {
    notes.iter().map(|note| note.text.as_str()).collect()
}

/// The forty features, each with its species and its dbh, and nothing to say about them.
#[track_caller]
fn is_the_grid(reading: &Reading) {
    assert_eq!(xy(&reading.pattern), grid());
    assert_eq!(reading.pattern.class_names(), SPECIES);
    assert_eq!(classes(&reading.pattern)[..4], ["ash", "lime", "yew", "ash"]);
    let dbh = Attribute { name: "dbh".to_owned(), values: (0..40).map(|i| 20.5 + f64::from(i)).collect() };
    assert_eq!(reading.pattern.attributes(), [dbh]);
}

#[test]
fn geojson_in_lines_in_sequences_and_in_lists() {
    let lines: Vec<String> = features().iter().map(Value::to_string).collect();
    let sequence: String = lines.iter().map(|line| format!("\u{1e}{line}\n")).collect();
    let pretty: String = features().iter().map(|it| format!("\u{1e}{it:#}\n")).collect();
    let halves: String = features().chunks(20).map(|half| collection(half) + "\n").collect();
    for text in [
        collection(&features()),
        lines.join("\n"),
        lines.join("\r\n") + "\r\n",
        lines.join("\n\n \n"),
        sequence,
        pretty,
        format!("[{}]", lines.join(",\n")),
        halves,
    ] {
        let reading = opened(&text);
        assert_eq!(reading.format, FileFormat::GeoJson);
        is_the_grid(&reading);
        assert!(reading.notes.is_empty(), "{:?}", texts(&reading.notes));
    }
    // Geometries need no feature around them.
    let bare: String = grid().iter().map(|at| format!("{}\n", json!({"type": "Point", "coordinates": at}))).collect();
    assert_eq!(xy(&opened(&bare).pattern), grid());
    let one = opened(&format!("{}\n", feature(vec![0.25, 0.75], json!({}))));
    assert_eq!(one.pattern.len(), 1);

    refused(&format!("{}\n{{\"type\": \"Feature\", ", lines[0]), &["line 2", "JSON"]);
    refused(&format!("{}\n[1, 2]", lines[0]), &["line 2, column 1", "no GeoJSON"]);
    refused(&format!("{}\n\n  {{\"x\": 1}}", lines[0]), &["line 3, column 3", "no GeoJSON"]);
    refused(&lines.join("\n").replace("[450.0,", "[\"450\","), &["line ", "two numbers"]);
}

#[test]
fn records_and_pairs_in_lines_and_lists() {
    let record =
        |(i, [x, y]): (usize, [f64; 2])| json!({"x": x, "y": y, "species": SPECIES[i % 3], "dbh": 20.5 + i as f64});
    let records: Vec<String> = grid().into_iter().enumerate().map(|it| record(it).to_string()).collect();
    let list = format!("[{}]", records.join(","));
    for text in [records.join("\n"), list.clone(), format!("{{\"points\": {list}}}")] {
        let reading = opened(&text);
        assert_eq!(reading.format, FileFormat::Json);
        is_the_grid(&reading);
    }
    let pairs: Vec<String> = grid().iter().map(|at| json!(at).to_string()).collect();
    for text in [pairs.join("\n"), format!("\u{1e}{}", pairs.join("\n\u{1e}")), format!("[{}]", pairs.join(","))] {
        assert_eq!(xy(&opened(&text).pattern), grid());
    }
    refused("[1, 2]\n{\"x\": 1, \"y\": 2}", &["line 2, column 1", "point 2 of the list is an object", "a list"]);
    refused("{\"x\": 1, \"y\": 2}\n[1, 2]", &["line 2, column 1", "point 2 of the list is a list", "an object"]);
}

#[test]
fn records_are_not_all_alike() {
    // Names, notes that few have, a missing height, a class that is not told.
    let record = |(i, [x, y]): (usize, [f64; 2])| {
        let mut record = json!({"id": i + 1, "x": x, "y": y, "name": format!("tree {i}"), "dbh": 20.5 + i as f64});
        record["species"] = if i % 10 == 3 { Value::Null } else { json!(SPECIES[i % 3]) };
        if i > 0 {
            record["height"] = json!(i);
        }
        if i == 7 {
            record["remark"] = json!("leans");
        }
        record
    };
    let records: Vec<Value> = grid().into_iter().enumerate().map(record).collect();
    let reading = opened(&json!(records).to_string());
    assert_eq!(xy(&reading.pattern), grid());
    assert_eq!(reading.pattern.class_names().len(), 4, "{:?}", reading.pattern.class_names());
    let names: Vec<&str> = reading.pattern.attributes().iter().map(|it| it.name.as_str()).collect();
    assert_eq!(names, ["dbh"]);
    for part in ["name", "remark", "height", "id"] {
        noted(&reading, NoteKind::LeftOut, part);
    }
    noted(&reading, NoteKind::Changed, "4 points have no class");
    // A record without a place.
    let mut gaps = records.clone();
    gaps[4].as_object_mut().unwrap().remove("x");
    gaps[9]["y"] = Value::Null;
    let reading = opened(&json!(gaps).to_string());
    assert_eq!(reading.pattern.len(), 38);
    noted(&reading, NoteKind::LeftOut, "2 rows without a place");
    refused("[{\"x\": 1, \"z\": 2}]", &["line 1", "'y'"]);
}

#[test]
fn places_under_other_names_and_further_in() {
    for (shape, is_degrees) in [
        (json!({"easting": "%X", "northing": "%Y"}), false),
        (json!({"X": "%X", "Y": "%Y"}), false),
        (json!({"position": ["%X", "%Y"], "w": 1}), false),
        (json!({"position": {"x": "%X", "y": "%Y"}}), false),
        (json!({"center": {"x": "%X", "y": "%Y", "z": 5}}), false),
        (json!({"coordinates": ["%X", "%Y", 5]}), false),
        (json!({"lon": "%X", "lat": "%Y"}), true),
        (json!({"latitude": "%Y", "longitude": "%X"}), true),
        (json!({"location": {"lat": "%Y", "lng": "%X"}}), true),
        (json!({"geometry": {"type": "Point", "coordinates": ["%X", "%Y"]}}), true),
    ] {
        // A hundredth of a degree wide for degrees.
        let at = |[x, y]: [f64; 2]| if is_degrees { [10.0 + x / 1e4, 59.0 + y / 1e4] } else { [x, y] };
        let text: Vec<String> = grid()
            .into_iter()
            .map(at)
            .map(|[x, y]| shape.to_string().replace("\"%X\"", &x.to_string()).replace("\"%Y\"", &y.to_string()))
            .collect();
        let reading = opened(&format!("[{}]", text.join(",")));
        match reading.origin.projection {
            None => assert_eq!(xy(&reading.pattern), grid(), "{shape}"),
            Some(projection) => {
                for (point, wanted) in reading.pattern.positions().iter().zip(grid()) {
                    let back = projection.unproject(*point) - DVec2::from(at(wanted));
                    assert!(back.abs().max_element() < 1e-9, "{shape}: {back}");
                }
            }
        }
        assert_eq!(reading.origin.projection.is_some(), is_degrees, "{shape}");
    }
}

#[test]
fn points_without_coordinates_are_left_out_with_a_word() {
    let mut all = features();
    all[3]["geometry"]["coordinates"] = json!([]);
    all[8]["geometry"] = Value::Null;
    all[12]["geometry"] = json!({"type": "MultiPoint", "coordinates": []});
    all[13]["geometry"]["coordinates"] = Value::Null;
    all[14]["geometry"]["coordinates"] = json!([null, null]);
    all[15].as_object_mut().unwrap().remove("geometry");
    all[16]["geometry"]["coordinates"].as_array_mut().unwrap().push(json!(120.5));
    all[17]["properties"] = Value::Null;
    let reading = opened(&collection(&all));
    assert_eq!(reading.pattern.len(), 34);
    noted(&reading, NoteKind::LeftOut, "6 features without a place");
    noted(&reading, NoteKind::LeftOut, "The height of one point");
    noted(&reading, NoteKind::Changed, "One point has no class");
    refused(&collection(&[feature(json!([1]), json!({}))]), &["line 1", "two numbers"]);
    refused(&collection(&[feature(json!([1, null]), json!({}))]), &["line 1", "two numbers"]);
}

#[test]
fn the_class_of_some_is_not_told() {
    for gap in [Value::Null, json!("")] {
        let mut all = features();
        all[5]["properties"]["species"] = gap;
        all[6]["properties"].as_object_mut().unwrap().remove("species");
        let reading = opened(&collection(&all));
        assert_eq!(reading.pattern.class_names().len(), 4);
        assert_eq!(reading.pattern.attributes().len(), 1);
        noted(&reading, NoteKind::Changed, "2 points have no class");
    }
    // A running number is no measurement.
    let mut all = features();
    all.iter_mut().enumerate().for_each(|(i, it)| it["properties"]["OBJECTID"] = json!(70_000 + 13 * i));
    let reading = opened(&collection(&all));
    assert_eq!(reading.pattern.attributes().len(), 1);
    noted(&reading, NoteKind::LeftOut, "OBJECTID");
}

#[test]
fn a_polygon_around_the_points_is_their_window() {
    let ring = json!([[390, 290], [490, 290], [490, 330], [440, 350], [390, 350], [390, 290]]);
    let hole = json!([[484, 291], [489, 291], [489, 294], [484, 294], [484, 291]]);
    let polygon = |rings: Value| json!({"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": rings}});
    let line = json!({"type": "Feature", "properties": null, "geometry": {"type": "LineString", "coordinates": [[0, 0], [1, 1]]}});
    let mut all = features();
    all.insert(0, polygon(json!([[[0, 0], [1000, 0], [1000, 1000], [0, 1000], [0, 0]]])));
    all.insert(5, polygon(json!([ring, hole])));
    all.push(polygon(json!([[[400, 300], [420, 300], [420, 320], [400, 300]]])));
    all.push(line.clone());
    let reading = opened(&collection(&all));
    assert_eq!(xy(&reading.pattern), grid());
    let window = reading.window.clone().expect("a window");
    assert_eq!(
        window.rings().iter().map(Vec::len).collect::<Vec<_>>(),
        [5, 4],
        "the smallest one that holds all points"
    );
    assert_eq!(reading.pattern.domain(), Domain::new(DVec2::new(390.0, 290.0), DVec2::new(100.0, 60.0)).unwrap());
    assert!(reading.is_domain_declared);
    noted(&reading, NoteKind::Changed, "outline of an area in the file is the window");
    noted(&reading, NoteKind::LeftOut, "2 other outlines of areas");

    // One point of forty outside, in two parts.
    let parts = json!({"type": "MultiPolygon", "coordinates": [
        [[[390, 290], [490, 290], [490, 325], [390, 325], [390, 290]]], [[[390, 325], [490, 325], [490, 339], [390, 338], [390, 325]]]]});
    let mut all = features();
    all.push(feature(vec![488.0, 342.0], json!({"species": "ash", "dbh": 9})));
    all.retain(|it| it["geometry"]["coordinates"][1].as_f64().unwrap() < 336.0 || it["properties"]["dbh"] == 9);
    all.push(parts);
    let reading = opened(&collection(&all[..all.len() - 1]));
    assert!(reading.window.is_none());
    all.last_mut().map(|it| *it = json!({"type": "Feature", "geometry": it.clone(), "properties": {}})).unwrap();
    let reading = opened(&collection(&all));
    noted(&reading, NoteKind::Changed, "one point lies outside");
    assert_eq!(reading.window.unwrap().rings().len(), 2);

    // Elsewhere it is none, and polygons alone are no points.
    let mut all = features();
    all.push(polygon(json!([[[0, 0], [9, 0], [9, 9], [0, 0]]])));
    let reading = opened(&collection(&all));
    assert!(reading.window.is_none() && !reading.is_domain_declared);
    noted(&reading, NoteKind::LeftOut, "40 points lie outside");
    refused(&collection(&[polygon(json!([ring])), line]), &["no points, but 2 shapes", "centroids"]);
    // In degrees it goes with them.
    let degrees = |at: &[f64]| vec![10.0 + at[0] / 1e4, 59.0 + at[1] / 1e4];
    let mut all: Vec<Value> = grid().iter().map(|at| feature(degrees(at), json!({}))).collect();
    let corners = [[390.0, 290.0], [490.0, 290.0], [490.0, 350.0], [390.0, 350.0], [390.0, 290.0]];
    all.push(polygon(json!([corners.map(|at| degrees(&at))])));
    let reading = opened(&collection(&all));
    let (domain, projection) = (reading.pattern.domain(), reading.origin.projection.unwrap());
    let corner = |at: [f64; 2]| projection.project(DVec2::from_slice(&degrees(&at)));
    assert!((domain.min() - corner(corners[0])).length() < 1e-6 && (domain.max() - corner(corners[2])).length() < 1e-6);
}

/// Ten degrees of arc, 0.001 wide, about 56 × 111 m.
fn degrees() -> Vec<[f64; 2]> {
    grid().iter().map(|[x, y]| [25.0 + (x - 400.0) / 8e4, 60.0 + (y - 300.0) / 8e4]).collect()
}

#[test]
fn degrees_become_metres_unless_they_are_none() {
    let text = |top: Value, at: &[[f64; 2]]| {
        let mut whole = top;
        whole["type"] = json!("FeatureCollection");
        whole["features"] = at.iter().map(|at| feature(at.to_vec(), json!({}))).collect();
        whole.to_string()
    };
    let reading = opened(&text(json!({}), &degrees()));
    assert!(!reading.is_domain_declared);
    noted(&reading, NoteKind::Changed, "became metres about 60.000");
    // At 60° N a degree of longitude is 0.5009 as long as one of latitude.
    let positions = reading.pattern.positions();
    let step = |a: usize, b: usize| positions[b] - positions[a];
    let wanted = |a: usize, b: usize| DVec2::from(degrees()[b]) - DVec2::from(degrees()[a]);
    assert!((step(0, 7).x / wanted(0, 7).x - 55_800.0).abs() < 3.0);
    assert!((step(0, 32).y / wanted(0, 32).y - 111_412.0).abs() < 3.0);

    let kept = ReadOptions { keeps_degrees: true, ..ReadOptions::default() };
    let reading = opened_with(&text(json!({}), &degrees()), &kept);
    assert_eq!((xy(&reading.pattern), reading.origin.projection), (degrees(), None));
    noted(&reading, NoteKind::Changed, "0.50 times as long");

    let crs = |name: &str| json!({"crs": {"type": "name", "properties": {"name": name}}});
    for (name, is_degrees) in [
        ("urn:ogc:def:crs:OGC:1.3:CRS84", true),
        ("EPSG:4326", true),
        ("urn:ogc:def:crs:EPSG::4258", true),
        ("http://www.opengis.net/def/crs/EPSG/0/7844", true),
        ("urn:ogc:def:crs:EPSG::25832", false),
        ("EPSG:3857", false),
        ("local grid", false),
    ] {
        let reading = opened(&text(crs(name), &degrees()));
        assert_eq!(reading.origin.projection.is_some(), is_degrees, "{name}");
    }
    // A sheet of paper is no country.
    let sheet: Vec<[f64; 2]> = grid().iter().map(|[x, y]| [x - 390.0, y - 295.0]).collect();
    let reading = opened(&text(json!({}), &sheet));
    assert_eq!(xy(&reading.pattern), sheet);
    noted(&reading, NoteKind::Changed, "were taken as they are");
    assert!(opened(&text(json!({}), &grid())).notes.is_empty(), "beyond 180 there is no doubt");
    // Neighbours across the 180th meridian.
    let fiji: Vec<[f64; 2]> =
        degrees().iter().map(|[x, y]| [if *x > 25.0005 { x - 205.0005 } else { x + 154.9995 }, y - 77.0]).collect();
    let reading = opened(&text(json!({}), &fiji));
    assert!(reading.pattern.domain().size().max_element() < 150.0, "{:?}", reading.pattern.domain());
}

fn planar_origin() -> Origin {
    Origin {
        class: Some("species".to_owned()),
        attributes: vec![("dbh".to_owned(), "DBH (cm)".to_owned())],
        ..Origin::default()
    }
}

/// What was read, written and read again.
fn written(reading: &Reading) -> (String, Reading) {
    let text = write_geojson(&reading.pattern, &reading.origin);
    let again = opened(&text);
    (text, again)
}

#[test]
fn geojson_comes_back_as_it_was() {
    let place = |(i, at): (usize, [f64; 2])| {
        feature(at.to_vec(), json!({"species": SPECIES[i % 3], "DBH": 20.5 + i as f64, "type": i * i}))
    };
    let features: Vec<Value> = degrees().into_iter().enumerate().map(place).collect();
    let reading = opened(&collection(&features));
    let (text, again) = written(&reading);
    assert!(again.is_domain_declared);
    assert!((again.pattern.domain().min() - reading.pattern.domain().min()).abs().max_element() < 1e-6);
    assert!((again.pattern.domain().size() - reading.pattern.domain().size()).abs().max_element() < 1e-6);
    assert_eq!(again.pattern.boundary(), reading.pattern.boundary());
    assert_eq!(again.pattern.class_names(), reading.pattern.class_names());
    assert_eq!(again.pattern.classes(), reading.pattern.classes());
    assert_eq!(again.pattern.attributes(), reading.pattern.attributes());
    assert_eq!(again.origin, reading.origin);
    let furthest = xy(&again.pattern)
        .into_iter()
        .zip(xy(&reading.pattern))
        .map(|(a, b)| (DVec2::from(a) - DVec2::from(b)).length());
    assert!(furthest.fold(0.0, f64::max) < 1e-4, "0.1 mm");

    // As RFC 7946 has it, with the names and the degrees of the file.
    let value: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(value["type"], "FeatureCollection");
    let features: &Vec<Value> = value["features"].as_array().unwrap();
    for (feature, wanted) in features.iter().zip(degrees()) {
        assert_eq!((&feature["type"], &feature["geometry"]["type"]), (&json!("Feature"), &json!("Point")));
        let at: Vec<f64> = serde_json::from_value(feature["geometry"]["coordinates"].clone()).unwrap();
        assert!((at[0] - wanted[0]).abs() < 1e-9 && (at[1] - wanted[1]).abs() < 1e-9, "{at:?} {wanted:?}");
        let names: Vec<&String> = feature["properties"].as_object().unwrap().keys().collect();
        assert_eq!(names, ["DBH", "species", "type"]);
    }
    // What has been through it goes through it again unchanged.
    assert_eq!(xy(&written(&again).1.pattern), xy(&again.pattern));
    assert_eq!(write_geojson(&again.pattern, &again.origin), text);
}

#[test]
fn what_is_no_degrees_comes_back_to_the_last_digit() {
    let positions: Vec<DVec2> = grid().into_iter().map(|at| DVec2::from(at) / 700.0).collect();
    let domain = Domain::new(DVec2::new(0.1, 0.3), DVec2::new(0.7, 0.3)).unwrap();
    let attribute =
        |name: &str, of: fn(usize) -> f64| Attribute { name: name.to_owned(), values: (0..40).map(of).collect() };
    let pattern = PointPattern::new(domain, positions)
        .unwrap()
        .with_boundary(Boundary::Periodic)
        .with_classes(
            (0..40).map(|i| [2, 0][i % 2]).collect(),
            vec!["yew".to_owned(), "none".to_owned(), "7".to_owned()],
        )
        .unwrap()
        .with_attribute(attribute("dbh", |i| i as f64 / 3.0))
        .unwrap()
        .with_attribute(attribute("class", |i| i as f64))
        .unwrap()
        .with_attribute(attribute("x", |i| -(i as f64)))
        .unwrap();
    for origin in [Origin::default(), planar_origin(), Origin { class: Some("dbh".to_owned()), ..Origin::default() }] {
        let again = opened(&write_geojson(&pattern, &origin));
        assert_eq!(again.pattern, pattern, "{origin:?}");
        assert!(again.is_domain_declared && again.origin.projection.is_none());
    }
    // One class, no attributes.
    let bare = PointPattern::new(Domain::UNIT, vec![DVec2::new(0.5, 1.0)]).unwrap();
    assert_eq!(opened(&write_geojson(&bare, &Origin::default())).pattern, bare);
    // The corners of a domain in degrees are points like others.
    let projection =
        opened(&collection(&degrees().iter().map(|at| feature(at.to_vec(), json!({}))).collect::<Vec<_>>())).origin;
    for side in [0.5, 3.0, 1_234.567_891_234, 99_999.9] {
        let domain = Domain::new(DVec2::new(-side / 3.0, 0.1), DVec2::splat(side)).unwrap();
        let corners = vec![domain.min(), domain.max(), DVec2::new(domain.min().x, domain.max().y)];
        let pattern = PointPattern::new(domain, corners).unwrap();
        let again = opened(&write_geojson(&pattern, &projection));
        assert!((again.pattern.domain().size() - domain.size()).abs().max_element() < 1e-6);
        assert!(again.pattern.positions().iter().zip(pattern.positions()).all(|(a, b)| (*a - *b).length() < 1e-4));
    }
}

#[test]
fn what_our_member_can_not_mean_is_passed_over() {
    let at = features();
    for own in [
        json!(7),
        json!({"domain": [0, 0, 0, 0], "boundary": "torus", "classes": ["a", "a"], "class": 3, "attributes": [["dbh", ""]]}),
        json!({"projection": {"longitude": 0, "latitude": 90}, "attributes": [["dbh", "a"], ["dbh", "b"]]}),
        json!({"projection": {"longitude": 1e300, "latitude": null}}),
    ] {
        let text = json!({"type": "FeatureCollection", "pointweave": own, "features": at}).to_string();
        is_the_grid(&opened(&text));
    }
    let outside = json!({"type": "FeatureCollection", "pointweave": {"domain": [0, 0, 1, 1]}, "features": at});
    refused(&outside.to_string(), &["outside the declared domain"]);
}

#[test]
fn other_json_is_named() {
    refused("{\"type\": \"Topology\", \"objects\": {}, \"arcs\": []}", &["line 1", "TopoJSON", "GeoJSON"]);
    refused("{\"a\": 1}\n{\"a\": 2}", &["line 1", "'x'"]);
}
