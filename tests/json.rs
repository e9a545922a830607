//! JSON and GeoJSON as people have them: one test a kind of trouble, each with a file of its own.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may stop at the first surprise")]

#[path = "common/readings.rs"]
mod readings;

use glam::DVec2;
use pointweave::Boundary;
use pointweave::formats::{FormatError, NoteKind, ReadOptions, Reading, open, write_geojson};
use readings::{has_places, noted, places};

fn species(i: usize) -> &'static str {
    ["oak", "elm", "fir"][i % 3]
}

fn feature(place: DVec2, properties: &str) -> String {
    let [x, y] = place.to_array();
    let geometry = format!("{{\"type\": \"Point\", \"coordinates\": [{x}, {y}]}}");
    format!("{{\"type\": \"Feature\", \"properties\": {properties}, \"geometry\": {geometry}}}")
}

/// A feature a place.
fn features(properties: impl Fn(usize) -> String) -> Vec<String> {
    places().into_iter().enumerate().map(|(i, place)| feature(place, &properties(i))).collect()
}

fn collection(features: &[String]) -> String {
    format!("{{\"type\": \"FeatureCollection\", \"features\": [{}]}}", features.join(",\n"))
}

fn with(options: &ReadOptions, text: impl AsRef<[u8]>) -> Result<Reading, FormatError> {
    open(text.as_ref(), None, options)
}

#[track_caller]
fn opened(text: impl AsRef<[u8]>) -> Reading {
    with(&ReadOptions::default(), text).unwrap_or_else(|error| panic!("{error}"))
}

#[track_caller]
fn is_whole(reading: &Reading, attributes: &[&str], classes: &[&str]) {
    has_places(reading, attributes);
    assert_eq!(reading.pattern.class_names(), classes);
}

#[test]
fn one_value_a_line_and_sequences() {
    let lines = features(|i| format!("{{\"species\": \"{}\"}}", species(i)));
    let separated: String = lines.iter().map(|line| format!("\u{1e}{line}\n")).collect();
    for text in [lines.join("\n"), lines.join("\r\n\n") + "\n", separated, lines.join(" ")] {
        is_whole(&opened(text), &[], &["oak", "elm", "fir"]);
    }
    let records: Vec<String> = places().iter().map(|p| format!("{{\"x\": {}, \"y\": {}}}", p.x, p.y)).collect();
    is_whole(&opened(records.join("\n")), &[], &["points"]);
    let lists: Vec<String> = places().iter().map(|p| format!("[{}, {}]", p.x, p.y)).collect();
    is_whole(&opened(lists.join("\n")), &[], &["points"]);
    let error = with(&ReadOptions::default(), format!("{}\n{{\"x\": 1}}", lines.join("\n"))).unwrap_err();
    assert!(error.to_string().contains("line 41") && error.to_string().contains("no GeoJSON"), "{error}");
    let error = with(&ReadOptions::default(), format!("{}\n{{\"x\": 1", lines.join("\n"))).unwrap_err();
    assert!(error.to_string().contains("line 41"), "{error}");
}

#[test]
fn features_without_a_place_are_left_out() {
    let mut list = features(|_| "null".to_owned());
    for geometry in
        ["null", "{\"type\": \"Point\", \"coordinates\": []}", "{\"type\": \"MultiPoint\", \"coordinates\": []}"]
    {
        list.insert(
            list.len() / 2,
            format!("{{\"type\": \"Feature\", \"properties\": {{}}, \"geometry\": {geometry}}}"),
        );
    }
    let reading = opened(collection(&list));
    is_whole(&reading, &[], &["points"]);
    noted(&reading, NoteKind::LeftOut, &["3 features without a place"]);
}

#[test]
fn unknown_classes_and_values() {
    let list = features(|i| match i {
        7 => "{\"species\": null, \"dbh\": 3}".to_owned(),
        9 => "{\"dbh\": 4}".to_owned(),
        _ => {
            format!("{{\"species\": \"{}\", \"dbh\": {i}.5, \"h\": {}}}", species(i), if i == 3 { "null" } else { "2" })
        }
    });
    let reading = opened(collection(&list));
    is_whole(&reading, &["dbh"], &["oak", "elm", "fir", "unknown"]);
    noted(&reading, NoteKind::Changed, &["2 points have no class", "'unknown'"]);
    noted(&reading, NoteKind::LeftOut, &["'h'", "3 values missing"]);
}

#[test]
fn running_numbers_text_and_many_classes() {
    let list = features(|i| {
        format!("{{\"OBJECTID\": {}, \"GlobalNo\": {}, \"dbh\": 3{i}, \"remark\": \"r{i}\"}}", i + 1, 7000 + 3 * i)
    });
    let reading = opened(collection(&list));
    is_whole(&reading, &["dbh"], &["points"]);
    noted(&reading, NoteKind::LeftOut, &["2 columns of running numbers", "GlobalNo", "OBJECTID"]);
    noted(&reading, NoteKind::LeftOut, &["text", "remark"]);
    let list = features(|i| format!("{{\"species\": \"s{}\"}}", i % 20));
    let reading = opened(collection(&list));
    assert_eq!(reading.pattern.class_names().len(), 16);
    noted(&reading, NoteKind::Changed, &["20 classes", "'other'"]);
}

#[test]
fn records_of_any_shape() {
    let record = |members: &dyn Fn(usize, DVec2) -> String| {
        let list: Vec<String> = places().into_iter().enumerate().map(|(i, place)| members(i, place)).collect();
        format!("[{}]", list.join(", "))
    };
    let text = record(&|i, p| format!("{{\"x\": {}, \"y\": {}, \"name\": \"tree {i}\", \"dbh\": 2{i}}}", p.x, p.y));
    let reading = opened(&text);
    is_whole(&reading, &["dbh"], &["points"]);
    noted(&reading, NoteKind::LeftOut, &["text", "name"]);
    for text in [
        record(&|_, p| format!("{{\"position\": [{}, {}]}}", p.x, p.y)),
        record(&|_, p| format!("{{\"location\": {{\"x\": {}, \"y\": {}}}}}", p.x, p.y)),
        record(&|_, p| format!("{{\"geometry\": {{\"type\": \"Point\", \"coordinates\": [{}, {}]}}}}", p.x, p.y)),
        format!("{{\"data\": {}}}", record(&|_, p| format!("[{}, {}]", p.x, p.y))),
        format!("{{\"columns\": [\"y\", \"x\"], \"data\": {}}}", record(&|_, p| format!("[{}, {}]", p.y, p.x))),
        format!("{{\"x\": {}, \"y\": {}}}", record(&|_, p| p.x.to_string()), record(&|_, p| p.y.to_string())),
    ] {
        is_whole(&opened(text), &[], &["points"]);
    }
    // Members that only some have.
    let text = record(&|i, p| {
        let more = if i == 5 { ", \"note\": \"old\"" } else { "" };
        format!("{{\"y\": {}, \"x\": {}{more}}}", p.y, p.x)
    });
    is_whole(&opened(text), &[], &["points"]);
    let text = record(&|i, p| if i % 2 == 0 { format!("{{\"x\": {}, \"y\": {}}}", p.x, p.y) } else { "{}".to_owned() });
    let reading = opened(text);
    assert_eq!(reading.pattern.len(), 20);
    noted(&reading, NoteKind::LeftOut, &["20 rows without a place", "entry 2"]);
    let uneven = with(&ReadOptions::default(), "{\"x\": [1, 2], \"y\": [1]}").unwrap_err().to_string();
    assert!(uneven.contains("'y' has 1 values, but 'x' has 2"), "{uneven}");
}

/// Places in degrees at 60° north: metres, as a sphere of the earth's size would have them.
fn near_oslo(place: DVec2) -> DVec2 {
    DVec2::new(10.7 + place.x * 1e-5, 60.0 + place.y * 1e-5)
}

#[test]
fn degrees_become_metres_and_leave_as_degrees() {
    let list: Vec<String> = places()
        .into_iter()
        .enumerate()
        .map(|(i, p)| feature(near_oslo(p), &format!("{{\"Kind\": \"{}\", \"radius [m]\": 0.{i}1}}", species(i))))
        .collect();
    let text = collection(&list);
    let reading = opened(&text);
    noted(&reading, NoteKind::Changed, &["metres", "60.0003° N", "10.7005° E", "--no-projection"]);
    // The first two places are 13.43 and 1.55 steps of a hundred-thousandth of a degree apart.
    let step = reading.pattern.positions()[1] - reading.pattern.positions()[0];
    assert!((step.x - 13.43 * 0.5580).abs() < 0.01 && (step.y - 1.55 * 1.1141).abs() < 0.01, "{step}");
    let kept = with(&ReadOptions { keeps_degrees: true, ..ReadOptions::default() }, &text).unwrap();
    noted(&kept, NoteKind::Changed, &["Degrees were taken as they are"]);
    assert_eq!(kept.pattern.positions()[0], near_oslo(places()[0]));

    let written = write_geojson(&reading.pattern, &reading.origin);
    let value: serde_json::Value = serde_json::from_str(&written).unwrap();
    for (i, place) in places().into_iter().enumerate() {
        let coordinates = &value["features"][i]["geometry"]["coordinates"];
        let found = DVec2::new(coordinates[0].as_f64().unwrap(), coordinates[1].as_f64().unwrap());
        assert!((found - near_oslo(place)).length() < 2e-9, "{found}");
        assert_eq!(value["features"][i]["properties"]["Kind"], species(i));
        assert_eq!(value["features"][i]["properties"]["radius [m]"], format!("0.{i}1").parse::<f64>().unwrap());
    }
    let again = opened(written);
    assert!(again.is_domain_declared);
    assert_eq!(again.pattern.attributes(), reading.pattern.attributes());
    assert_eq!(again.pattern.class_names(), reading.pattern.class_names());
    let difference = (again.pattern.domain().size() - reading.pattern.domain().size()).length();
    assert!(difference < 1e-3, "{difference}");
}

#[test]
fn what_is_written_reads_back() {
    // Names that would be taken for something else, a tile, a class that no point has.
    let text = "# domain 0 0 300 200 periodic\n# classes: a,b,c\nx,y,class,attribute:species,attribute:id\n\
                1,2,b,1,7\n250,150,a,2,8\n12,13,b,1,9\n";
    let pattern = opened(text).pattern;
    assert_eq!((pattern.boundary(), pattern.attributes().len()), (Boundary::Periodic, 2));
    let reading = opened(write_geojson(&pattern, &pointweave::formats::Origin::default()));
    assert_eq!(reading.pattern, pattern);
    assert!(reading.notes.is_empty(), "{:?}", reading.notes);
}

#[test]
fn coordinates_that_are_no_degrees_of_one_place() {
    // Beyond the earth, in a system that is named, or spread too widely for a plane.
    let large: Vec<String> =
        places().into_iter().map(|p| feature(p + DVec2::new(691_200.0, 5_334_100.0), "{}")).collect();
    let reading = opened(collection(&large));
    assert!(reading.notes.is_empty() && reading.origin.projection.is_none(), "{:?}", reading.notes);
    let small: Vec<String> = places().into_iter().map(|p| feature(p / 10.0, "{}")).collect();
    let crs = "{\"type\": \"name\", \"properties\": {\"name\": \"urn:ogc:def:crs:EPSG::25832\"}}";
    let named = collection(&small).replacen('{', &format!("{{\"crs\": {crs}, "), 1);
    let reading = opened(named);
    assert!(reading.notes.is_empty() && reading.origin.projection.is_none(), "{:?}", reading.notes);
    let reading = opened(collection(&features(|_| "{}".to_owned())));
    is_whole(&reading, &[], &["points"]);
    noted(&reading, NoteKind::Changed, &["more than a plane can hold", "as they are"]);
}

#[test]
fn other_shapes_and_windows() {
    let shape = |kind: &str, coordinates: &str| {
        let geometry = format!("{{\"type\": \"{kind}\", \"coordinates\": {coordinates}}}");
        format!("{{\"type\": \"Feature\", \"properties\": {{}}, \"geometry\": {geometry}}}")
    };
    let mut list = features(|_| "{}".to_owned());
    list.insert(3, shape("LineString", "[[0, 0], [5, 5]]"));
    list.push(shape("Polygon", "[[[0, 0], [1, 0], [1, 1], [0, 0]]]"));
    let reading = opened(collection(&list));
    is_whole(&reading, &[], &["points"]);
    noted(&reading, NoteKind::LeftOut, &["One line"]);
    noted(&reading, NoteKind::LeftOut, &["outline of an area", "40 points lie outside"]);
    assert!(reading.window.is_none());
    // A rectangle around the points is the domain, any other outline a window in it.
    list.pop();
    list.push(shape("Polygon", "[[[0, 0], [100, 0], [100, 62], [0, 62], [0, 0]]]"));
    let reading = opened(collection(&list));
    assert_eq!((reading.pattern.domain().max(), reading.is_domain_declared), (DVec2::new(100.0, 62.0), true));
    assert!(reading.window.is_none());
    noted(&reading, NoteKind::Changed, &["outline", "window"]);
    list.pop();
    list.push(shape("MultiPolygon", "[[[[0, -20], [120, 0], [100, 62], [0, 82], [0, -20]]]]"));
    let reading = opened(collection(&list));
    is_whole(&reading, &[], &["points"]);
    assert_eq!(reading.window.map(|window| window.rings()[0].len()), Some(4));
    // Heights are said, and points within one feature are points each.
    let all: Vec<String> = places().iter().map(|p| format!("[{}, {}, 3.5]", p.x, p.y)).collect();
    let reading = opened(collection(&[shape("MultiPoint", &format!("[{}]", all.join(", ")))]));
    is_whole(&reading, &[], &["points"]);
    noted(&reading, NoteKind::LeftOut, &["40 heights"]);
    let topology = with(&ReadOptions::default(), "{\"type\": \"Topology\", \"objects\": {}}").unwrap_err();
    assert!(topology.to_string().contains("TopoJSON"), "{topology}");
}
