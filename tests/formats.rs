//! Files in, files out: what is read, what is refused and in which words, and that nothing is lost on the way.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

#[path = "common/picture.rs"]
mod picture;

use glam::DVec2;
use picture::decode;
use pointweave::formats::style::{Look, Palette};
use pointweave::formats::{
    FileFormat, FormatError, Glyph, MAX_BYTES, PngStyle, ReadOptions, Reading, SvgStyle, draw, open, read, write_csv,
    write_json, write_npy, write_png, write_svg, write_tsv,
};
use pointweave::sampling::{Purpose, Rng};
use pointweave::{Attribute, Boundary, Domain, PointPattern};

fn load(text: &str) -> Result<PointPattern, FormatError> {
    read(text.as_bytes(), None, &ReadOptions::default())
}

#[track_caller]
fn good(text: &str) -> PointPattern {
    load(text).unwrap_or_else(|error| panic!("{text:?}: {error}"))
}

/// The refusal's words must hold every one of `parts`.
#[track_caller]
fn refused(text: &str, parts: &[&str]) {
    let error = load(text).expect_err(text);
    let message = error.to_string();
    // Whatever is not about the file as a whole has its place.
    let bare = if let FormatError::Table { error, .. } = &error { error.as_ref() } else { &error };
    let whole = matches!(bare, FormatError::NoPoints | FormatError::NoDomain { .. } | FormatError::Kind { .. });
    assert!(whole || error.position().is_some(), "{text:.200?}: {message}");
    for part in parts {
        assert!(message.contains(part), "{text:.200?}\n  says    {message:?}\n  without {part:?}");
    }
}

fn xy(pattern: &PointPattern) -> Vec<(f64, f64)> {
    pattern.positions().iter().map(|point| (point.x, point.y)).collect()
}

fn class_of(pattern: &PointPattern) -> Vec<&str> {
    pattern.classes().iter().map(|&class| pattern.class_names()[usize::from(class)].as_str()).collect()
}

fn domain(x0: f64, y0: f64, width: f64, height: f64) -> Domain {
    Domain::new(DVec2::new(x0, y0), DVec2::new(width, height)).unwrap()
}

#[test]
fn one_pattern_in_many_spellings() {
    for text in [
        "x,y\n0.5,0.25\n0.125,1\n",
        "0.5,0.25\n0.125,1",
        " 0.5 , 0.25 \r\n 0.125 , 1 \r\n",
        "\u{feff}Y,X\r\n0.25,0.5\r\n1,.125\r\n",
        "\"x\",\"y\"\n\"0.5\",\"0.25\"\n\"0.125\",\"1\"\n",
        ",x,y\n0,0.5,0.25\n1,0.125,1\n",
        "x,y,\n0.5,0.25,\n0.125,1,\n,,\n",
        "x,y\n0.5,0.25,,\n0.125,1,,\n",
        "x\ty\n0.5\t0.25\n0.125\t1\n",
        "0,5\t0,25\n0,125\t1\n",
        "x;y\n0,5;0,25\n0,125;1,0\n",
        "x;y\n0.5;0.25\n0.125;1\n",
        "# a comment\n0.5 0.25 # and one behind\n\n   0.125   1e0\n",
        "X Y\n0.5 0.25\n0.125 1\n",
        "0.5 0.25\r0.125 1\r",
        "[[0.5, 0.25], [0.125, 1]]",
        "{\"points\": [[0.5, 0.25], [0.125, 1]]}",
        "{\"points\": [{\"x\": 0.5, \"y\": 0.25}, {\"y\": 1, \"x\": 0.125}]}",
        "{\"positions\": [[0.5, 0.25], [0.125, 1]]}",
    ] {
        let pattern = good(text);
        assert_eq!(xy(&pattern), [(0.5, 0.25), (0.125, 1.0)], "{text:?}");
        assert_eq!((pattern.domain(), pattern.boundary()), (Domain::UNIT, Boundary::Open), "{text:?}");
        assert_eq!(pattern.class_names(), ["points"], "{text:?}");
        assert!(pattern.attributes().is_empty(), "{text:?}");
    }
}

#[test]
fn classes_and_attributes_by_header() {
    let pattern = good("Radius,CLASS,y,x\n0.1,oak,0.2,0.3\n0.4,\"elm, old\",0.5,0.6\n0.7,oak,0.8,0.9\n");
    assert_eq!(xy(&pattern), [(0.3, 0.2), (0.6, 0.5), (0.9, 0.8)]);
    assert_eq!(pattern.class_names(), ["oak", "elm, old"]);
    assert_eq!(class_of(&pattern), ["oak", "elm, old", "oak"]);
    assert_eq!(pattern.attributes(), [Attribute { name: "Radius".to_owned(), values: vec![0.1, 0.4, 0.7] }]);

    let objects =
        good(r#"{"points": [{"x": 0, "y": 1, "class": "a", "w": 3}, {"x": 1, "y": 0, "class": 7, "w": -1}]}"#);
    assert_eq!(class_of(&objects), ["a", "7"]);
    assert_eq!(objects.attributes()[0].values, [3.0, -1.0]);
}

#[test]
fn third_column_without_header() {
    assert_eq!(class_of(&good("0 0 b\n0 1 a\n1 1 b")), ["b", "a", "b"]);
    assert_eq!(class_of(&good("0,0,2\n0,1,1\n1,1,2")), ["2", "1", "2"]);
    let both = good("0,0,2,0.5\n0,1,1,0.25");
    assert_eq!(class_of(&both), ["2", "1"]);
    assert_eq!(both.attributes()[0].name, "attribute-1");
    let fractions = good("0 0 0.5\n0 1 2");
    assert_eq!(fractions.class_names(), ["points"]);
    assert_eq!(fractions.attributes(), [Attribute { name: "attribute-1".to_owned(), values: vec![0.5, 2.0] }]);
    // More whole numbers than there may be classes: a quantity.
    let many: String = (0..17).map(|i| format!("0.{i} 0.5 {i}\n")).collect();
    assert_eq!(good(&many).attributes().len(), 1);
}

#[test]
fn reference_layout() {
    let several = good("2 1000 2000\n2000 0 10000\n1000 2500 5000\n");
    assert_eq!(xy(&several), [(0.0, 1.0), (0.25, 0.5)]);
    assert_eq!(several.class_names(), ["1000", "2000"], "in the order that was announced");
    assert_eq!(class_of(&several), ["2000", "1000"]);
    assert_eq!(several.domain(), Domain::UNIT);

    let bare = good("1000 199 9799\n1000 5000 1\n");
    assert_eq!(xy(&bare), [(0.0199, 0.9799), (0.5, 0.0001)]);
    let disks = good("1 1000\n1000 100 100 250\n1000 100 900 500");
    assert_eq!(disks.attributes(), [Attribute { name: "radius".to_owned(), values: vec![0.025, 0.05] }]);
    let two = good("1000\t100\t100\t250\t1\n1000\t100\t900\t500\t2");
    let names: Vec<_> = two.attributes().iter().map(|attribute| attribute.name.as_str()).collect();
    assert_eq!(names, ["attribute-1", "attribute-2"]);

    // Near misses stay what they look like.
    assert_eq!(xy(&good("1000 2000\n3000 4000\n5000 1000"))[0], (1000.0, 2000.0));
    assert_eq!(xy(&good("1 2 3\n4 5 6\n7 9 8"))[0], (1.0, 2.0));

    refused("2 1000 2000\n1000 5 5\n3000 5 5", &["line 3, column 1", "class is \"3000\"", "1000, 2000"]);
    refused("1 1000\n1000 5 5\n\n1000 5 10001", &["line 4, column 3", "y is \"10001\"", "0 to 10000"]);
    refused("1 1000\n1000 5 5\n1000 0.5 5", &["line 3, column 2", "x is \"0.5\"", "whole number"]);
    refused("1 1000\n1000 5 5\n1000 5", &["line 3", "2 values", "3 are needed"]);
}

#[test]
fn the_domain_is_declared_or_found() {
    let declared = good("# domain 0 0 100 50 periodic\nx,y\n1,2\n3,50\n");
    assert_eq!((declared.domain(), declared.boundary()), (domain(0.0, 0.0, 100.0, 50.0), Boundary::Periodic));
    assert_eq!(good("#Domain: -1,-2,3,4\n0 0").domain(), domain(-1.0, -2.0, 4.0, 6.0));
    assert_eq!(good("0 0 # domain 0 0 size 2 3 open\n").domain(), domain(0.0, 0.0, 2.0, 3.0));
    let json = good(r#"{"points": [[1, 1]], "domain": [0, 0, 2, 4], "boundary": "periodic"}"#);
    assert_eq!((json.domain(), json.boundary()), (domain(0.0, 0.0, 2.0, 4.0), Boundary::Periodic));
    // Comments that only begin like one.
    assert_eq!(good("# domain expertise needed\n# domains 1 2 3\n0.5 0.5").domain(), Domain::UNIT);

    // Neighbours 2 apart: 1 on every side.
    let boxed = good("0 0\n2 0\n4 0\n0 2\n2 2\n4 2\n");
    assert_eq!(boxed.domain(), domain(-1.0, -1.0, 6.0, 4.0));
    assert_eq!(good("10 5\n12 5\n14 5").domain(), domain(9.0, 4.0, 6.0, 2.0));

    let options = ReadOptions {
        domain: Some(domain(0.0, 0.0, 9.0, 9.0)),
        boundary: Some(Boundary::Periodic),
        ..ReadOptions::default()
    };
    for text in ["# domain 0 0 5 5 open\n1 1", "[[1,1]]", &write_json(&good("# domain 0 0 5 5\n1 1"))] {
        let pattern = read(text.as_bytes(), None, &options).unwrap();
        assert_eq!((pattern.domain(), pattern.boundary()), (domain(0.0, 0.0, 9.0, 9.0), Boundary::Periodic), "{text}");
    }

    refused("# domain 0 0 1\n0 0", &["line 1", "four numbers"]);
    refused("x,y\n# domain 0 0 1 q\n0,0", &["line 2", "\"q\" is not a number"]);
    refused("# domain 0 0 1 0\n0 0", &["line 1", "greater than 0"]);
    refused("# domain 0 0 1 1 torus\n0 0", &["line 1", "\"torus\"", "'open' and 'periodic'"]);
    refused("# domain 0 0 100 1\n0 0", &["64 times"]);
    refused("# domain 0 0 1 1\n\n0 0\n0 1.5", &["line 4", "(0, 1.5)", "outside the declared domain (0, 0) – (1, 1)"]);
}

#[test]
fn strange_but_valid_points() {
    assert_eq!(good("0.5 0.5").len(), 1);
    assert_eq!(good("0.5 0.5\n0.5 0.5\n0.5 0.5").len(), 3);
    assert_eq!(good("0.1 0.1\n0.2 0.2\n0.3 0.3").domain(), Domain::UNIT);
    let duplicates = good("5 5\n5 5\n7 5\n7 6\n5 6");
    assert!((duplicates.domain().size() - DVec2::new(3.0, 2.0)).length() < 1e-12);
    for magnitude in ["1e38", "1e300", "1e-300"] {
        let text = format!("0 0\n{magnitude} 0\n0 {magnitude}\n-{magnitude} -{magnitude}");
        let pattern = good(&text);
        assert_eq!(good(&write_csv(&pattern)), pattern, "{magnitude}");
        assert!(pattern.mean_spacing().unwrap() > 0.0);
        assert!(!write_svg(&pattern, &SvgStyle::default()).contains("NaN"));
    }
    // Far from the origin, where rounding bites: the found domain must still hold the points.
    for i in 0..200 {
        let (base, step) = (1e6 + f64::from(i) / 7.0, 1e-5 + f64::from(i) * 1e-6);
        good(&format!("{base} {base}\n{} {base}\n{base} {}", base + step, base + 3.0 * step));
    }
}

#[test]
fn values_that_are_refused() {
    refused("x,y\n0.1,0.2\n0.3,abc\n", &["line 3, column 2", "y is \"abc\"", "finite number"]);
    refused("0.1 0.2\n# c\n\ninf 0.3", &["line 4, column 1", "x is \"inf\"", "finite number"]);
    refused("nan,nan", &["line 1, column 1", "\"nan\""]);
    refused("0.1,inf", &["line 1, column 2", "\"inf\""]);
    refused("0.1,1e999", &["line 1, column 2", "\"1e999\""]);
    refused("0.1,", &["line 1, column 1", "1 values", "at least 2"]);
    refused("0.1;1.000,5", &["line 1, column 2", "\"1.000,5\""]);
    refused("oak,0.1,0.2", &["line 1, column 1", "x is \"oak\""]);
    refused("x,y\n0,0\n1\n", &["line 3, column 2", "1 values", "2 are needed"]);
    refused("x,y\n0,0\n1,2,3\n", &["line 3, column 3", "3 values", "2 are needed"]);
    refused("0.5\n0.6", &["line 1", "1 values", "at least 2 (x and y)"]);
    refused("place,height\n1,2", &["line 1", "'x'", "place, height", "--columns x="]);
    refused("x,class\n1,2", &["line 1", "'y'", "x, class"]);
    refused("x,y,w,w\n1,2,3,4", &["line 1, column 4", "\"w\""]);
    refused("x,y,X\n1,2,3", &["line 1, column 3", "\"X\""]);
    refused(&format!("x,y\n1,{}", "9z".repeat(100)), &["9z9z…"]);
    refused("x,y\n0,\"un\nclosed", &["line 2, column 2"]);
    // Lines are counted over comments, blank lines and quoted line ends, whatever ends a line.
    refused("# a\r\n\r\nx,y,class\r\n# b\r\n0,0,a\r\n\r\n# c\r\n0,oops,a\r\n", &["line 8, column 2"]);
    refused("# a\rx,y\r0,0\r# c\r0,oops\r", &["line 5, column 2"]);
    refused("x,y,class\n0,0,\"a\"\n\n0,\"\nz\",a\n", &["line 4, column 2"]);
}

#[test]
fn no_points_or_no_extent_is_refused() {
    for text in ["", " \n\r\n", "# only\n# comments", "x,y\n", "[]", "{\"points\": []}", "{\"positions\": []}", ",,\n,"]
    {
        assert_eq!(load(text), Err(FormatError::NoPoints), "{text:?}");
    }
    refused("5 5", &["one place outside the unit square", "# domain x0 y0 x1 y1"]);
    refused("5 5\n5 5", &["one place outside the unit square"]);
    refused("1e308 0\n-1e308 0", &["farther apart"]);
    let line: String = (0..100).map(|i| format!("{i} 7\n")).collect();
    refused(&line, &["tell no domain", "64 times", "# domain"]);
    refused("1000000 1000000\n1000000.000000001 1000000", &["tell no domain", "distinct positions"]);
}

#[test]
fn json_that_is_refused() {
    refused("{\"points\": [[0, 0], [0 1]]}", &["line 1, column", "JSON"]);
    refused("[[0, 0],\n [0, NaN]]", &["line 2, column"]);
    refused("[[0, 0], [0, 1e999]]", &["line 1", "out of range"]);
    refused("[[null, 0]]", &["point 1 of the list, value 1", "in at least one row"]);
    refused("[[0, 0], [0, [1]]]", &["point 2 of the list, value 2", "\"[1]\""]);
    refused("[[0, 0], 5]", &["point 2 of the list is a number", "a list [x, y]"]);
    refused("[[0, 0], [0]]", &["point 2 of the list", "1 values"]);
    refused("[{\"x\": 1}]", &["no column is called 'y'"]);
    refused("[{\"x\": 1, \"y\": 0}, [1, 2]]", &["point 2 of the list is a list", "an object like the first one"]);
    refused("{\"kind\": \"none we know\", \"features\": []}", &["neither 'points' nor 'positions'", "'features'"]);
    refused("{\"points\": 7}", &["'points' is a number"]);
    refused("{\"points\": [[0,0]], \"boundary\": \"torus\"}", &["\"torus\"", "\"periodic\""]);
    refused("{\"points\": [[0,0]], \"domain\": [0, 0, 1]}", &["'domain' must be [x0, y0, x1, y1]"]);
    refused("{\"points\": [[0,0]], \"domain\": [0, 0, 1, 0]}", &["greater than 0"]);
    refused("{\"domain\": {\"min\": [0,0], \"size\": [1,1]}, \"positions\": [[0, 2]]}", &["point 0 at (0, 2)"]);
    refused("{\"positions\": [[0, 0]], \"classes\": [1], \"class_names\": [\"a\"]}", &["class 1", "1 classes"]);
    refused("{\"positions\": [[0, \"a\"]]}", &["line 1, column 22", "\"a\""]);
    let named = read(b"5", Some("a.JSON"), &ReadOptions::default()).unwrap_err().to_string();
    assert!(named.contains("it is a number"), "{named}");
    refused(&"[".repeat(5000), &["recursion"]);
    refused(&format!("[{}0]", "[],".repeat(3_000_001)), &["more than 3000000 values"]);
}

/// Where a layout is wrong, not only where JSON is.
#[test]
fn wrong_json_layouts_have_a_place() {
    refused("\n  {\"points\":\n   7}", &["line 3, column 4", "'points' is a number"]);
    refused("\n  {\"things\": 7}", &["line 2, column 3", "neither"]);
    refused("{\"points\": [[0,0]],\n \"boundary\": \"torus\"}", &["line 2, column 14", "torus"]);
    refused("{\"points\": [[0,0]],\n \"é\": 1, \"domain\": [0]}", &["line 2, column 20", "'domain' must be"]);
    refused("{\"points\": [[0,0]],\n \"domain\": [0, 0, 1, 0]}", &["line 2, column 12", "greater than 0"]);
    refused(
        "{\"positions\": [[0, 0],\n [1, 1]], \"classes\":\n [0, 1], \"class_names\": [\"a\"]}",
        &["line 3, column 6"],
    );
    refused("{\"positions\": [[0, 0]],\n \"classes\": [0, 0], \"class_names\": [\"a\"]}", &["line 2, column 13"]);
    refused("{\"positions\": [[0, 0]],\n\"attributes\": [{\"name\": \"\", \"values\": [1]}]}", &["line 2, column 15"]);
    refused("{\"positions\": [[0, 0]],\n \"classes\": [-1]}", &["line 2, column 15"]);
    let domain = "\"domain\": {\"min\": [0, 0], \"size\": [1, 1]}";
    refused(&format!("{{{domain}, \"positions\":\n [[0, 0],\n [2, 0]]}}"), &["line 3, column 2", "outside"]);
    refused("{\"type\": \"FeatureCollection\",\n \"features\": {}}", &["line 2, column 14", "list"]);
    refused("\n{\"type\": \"Point\", \"coordinates\": [1]}", &["line 2, column 1", "two numbers"]);
    refused("{\"pointweave-project\":\n 2}", &["line 2, column 2", "version 2"]);
    refused("\n {\"pointweave-project\": 1}", &["line 2, column 2", "no 'exemplar'"]);
    refused("{\"pointweave-project\": 1,\n \"exemplar\": {}}", &["line 2, column 14", "'exemplar' of the project"]);
    let exemplar = format!("\"exemplar\": {{{domain}, \"positions\": [\n[3, 0]]}}");
    refused(&format!("{{\"pointweave-project\": 1, {exemplar}}}"), &["line 2, column 1", "outside"]);
    let exemplar = format!("\"exemplar\": {{{domain}, \"positions\": [[0, 0]]}}");
    for (member, part) in [("\"run\": 3", "'run'"), ("\"preset\": \"good\"", "preset"), ("\"output\": 3", "'output'")] {
        refused(&format!("{{\"pointweave-project\": 1, {exemplar},\n{member}}}"), &["line 2", part]);
    }
}

#[test]
fn sizes_are_not_negative_and_no_row_lacks_a_value() {
    refused("x,y,radius\n0,0,1\n\n0,0,-0.5\n", &["line 4, column 3", "radius is \"-0.5\"", "0 or more"]);
    refused("x;y;scale\n0;0;-1,5\n", &["line 2, column 3", "scale is \"-1,5\""]);
    refused("Scale y x\n1 0 0\n-2 1 1", &["line 3, column 1", "Scale is \"-2\"", "0 or more"]);
    refused("1 1000\n1000 5 5 7\n1000 5 5 -7", &["line 3, column 4", "radius is \"-7\""]);
    refused(r#"[{"x": 0, "y": 0, "radius": 1}, {"x": 0, "y": 0, "radius": -1}]"#, &["point 2 of the list", "\"-1\""]);
    let own = r#"{"positions": [[0, 0], [1, 1]], "attributes": [{"name": "radius", "values": [1, -3]}]}"#;
    refused(own, &["point 1", "radius is -3", "0 or more"]);
    let other = good("x,y,depth,orientation\n0,0,-1,-90\n1,1,0,360");
    assert_eq!(other.attributes()[0].values, [-1.0, 0.0], "other quantities have a sign");

    refused("2 1000 2000\n1000 5 5 7\n2000 5 5", &["line 3", "3 values", "4 are needed"]);
    let short = r#"{"positions": [[0, 0], [1, 1]], "attributes": [{"name": "depth", "values": [1]}]}"#;
    refused(short, &["depth has 1 values for 2 points"]);
    // The ids of classes are names: any will do.
    assert_eq!(good("0 0 7\n0 1 3\n1 1 7").class_names(), ["7", "3"]);
    let gap = r#"{"positions": [[0, 0], [1, 1]], "classes": [0, 2], "class_names": ["a", "b"]}"#;
    refused(gap, &["point 1 has class 2", "2 classes (0 to 1)"]);
}

#[test]
fn limits() {
    let row = "0.5,0.5\n";
    assert_eq!(good(&row.repeat(20_000)).len(), 20_000);
    assert_eq!(good(&format!("x,y\n{}", row.repeat(20_000))).len(), 20_000);
    refused(&row.repeat(20_001), &["line 20001", "20000 points"]);
    refused(&format!("x,y\n{}", row.repeat(20_001)), &["line 20002", "20000 points"]);
    let sixteen: String = (0..16).map(|i| format!("0 0 c{i}\n")).collect();
    assert_eq!(good(&sixteen).class_names().len(), 16);
    let declared: String = (0..17).map(|i| format!("c{i},")).collect();
    refused(&format!("# classes: {declared}d\n0 0 d"), &["line 1, column 17", "more than 16 classes"]);
    let announced: String = (1..=17).map(|i| format!(" {i}000")).collect();
    refused(&format!("1 2\n2 0 0{}", " 0".repeat(9)), &["line 2, column 12", "more than 8 attributes"]);
    refused(&format!("1 {zeros}1\n{zeros}1 0 0", zeros = "0".repeat(70)), &["line 2, column 3", "2 are needed"]);
    refused(&format!("17{announced}\n1000 5 5"), &["line 1, column 18", "more than 16 classes"]);
    let wide = |count: usize| {
        let names: String = (0..count).map(|i| format!(",a{i}")).collect();
        format!("x,y{names}\n0,0{}", ",1".repeat(count))
    };
    assert_eq!(good(&wide(8)).attributes().len(), 8);
    for many in [wide(9), wide(1022), format!("0.5 0.5{}", " 0.5".repeat(9))] {
        assert_eq!(good(&many).attributes().len(), 8);
    }
    refused(&wide(1023), &["line 1, column 1025", "1024 columns"]);
    refused(&format!("0 0\n{}1 1", " ".repeat(100_000)), &["line 2", "100003 bytes", "at most 100000"]);
    refused(&format!("x,y,class\n0,0,{}", "é".repeat(65)), &["line 2, column 3", "1 to 64 characters"]);
    refused(&format!("x,y,{}\n0,0,1", "é".repeat(65)), &["line 1, column 3", "1 to 64 characters"]);
    refused("x,y,a\u{1}b\n0,0,1", &["line 1, column 3", "control character"]);
    refused("# classes: a,b,a\n0 0 a", &["line 1, column 3", "\"a\""]);
    assert_eq!(
        read(&vec![b'1'; MAX_BYTES + 1], None, &ReadOptions::default()),
        Err(FormatError::TooLarge { bytes: 20_000_001, max: 20_000_000 })
    );
}

#[test]
fn other_files_are_named() {
    for (bytes, word) in [
        (&b"\x89PNG\r\n\x1a\n"[..], "no proper PNG"),
        (b"\xff\xd8\xff\xe0", "a JPEG picture"),
        (b"RIFF....WEBPVP8 ", "a WebP picture"),
        (b"PK\x03\x04....", "spreadsheet"),
        (b"  <html></html>", "XML"),
        (b"0.5 0.5\x00", "binary"),
        (b"0 0\n1 1 \xe9\x01\n", "line 2, column 5: byte 0xe9 is not UTF-8"),
    ] {
        let message = read(bytes, None, &ReadOptions::default()).unwrap_err().to_string();
        assert!(message.contains(word), "{message}");
    }
}

/// Everything that [`open`] tells.
#[track_caller]
fn opened(bytes: impl AsRef<[u8]>) -> Reading {
    open(bytes.as_ref(), None, &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

#[track_caller]
fn noted(reading: &Reading, part: &str) {
    assert!(reading.notes.iter().any(|note| note.text.contains(part)), "{:?} without {part:?}", reading.notes);
}

#[test]
fn geojson_points() {
    let text = r#"{"type": "FeatureCollection", "features": [
        {"type": "Feature", "geometry": {"type": "Point", "coordinates": [13, 52, 7]}, "properties": {"Species": "oak", "h": 3, "n": "x"}},
        {"type": "Feature", "geometry": {"type": "MultiPoint", "coordinates": [[14, 53], [15, 52]]}, "properties": {"Species": "elm", "h": 4.5}},
        {"type": "Feature", "geometry": {"type": "Polygon", "coordinates": []}, "properties": {}},
        {"type": "Feature", "geometry": null, "properties": null}]}"#;
    let reading = opened(text);
    assert_eq!((reading.format, reading.is_domain_declared), (FileFormat::GeoJson, false));
    let projection = reading.origin.projection.unwrap();
    let degrees: Vec<DVec2> = reading.pattern.positions().iter().map(|&point| projection.unproject(point)).collect();
    assert_eq!(degrees, [DVec2::new(13.0, 52.0), DVec2::new(14.0, 53.0), DVec2::new(15.0, 52.0)]);
    assert_eq!(class_of(&reading.pattern), ["oak", "elm", "elm"]);
    assert_eq!(reading.pattern.attributes(), [Attribute { name: "h".to_owned(), values: vec![3.0, 4.5, 4.5] }]);
    noted(&reading, "One shape that is no point");
    noted(&reading, "One feature without a place");
    noted(&reading, "became metres");
    noted(&reading, "text: n");

    let point = opened(r#"{"type": "Point", "coordinates": [0.5, 0.25]}"#);
    assert_eq!(xy(&point.pattern), [(0.0, 0.0)], "about itself");
    let several = r#"{"type": "GeometryCollection", "geometries": [{"type": "Point", "coordinates": [0, 0]}, {"type": "LineString", "coordinates": [[0, 1]]}]}"#;
    assert_eq!(opened(several).pattern.len(), 1);
    // Numbers are classes too; more of them than there may be classes are a quantity.
    let features = |count: usize| {
        let feature = |i: usize| {
            format!(
                r#"{{"type":"Feature","geometry":{{"type":"Point","coordinates":[{i},{}]}},"properties":{{"class":{i}}}}}"#,
                i * i
            )
        };
        let list: Vec<String> = (0..count).map(feature).collect();
        format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, list.join(","))
    };
    assert_eq!(opened(features(3)).pattern.class_names(), ["0", "1", "2"]);
    let many = opened(features(17)).pattern;
    assert_eq!((many.class_names().len(), many.attributes()[0].name.as_str()), (1, "class"));

    refused(r#"{"type": "FeatureCollection", "features": 3}"#, &["'features' must be a list"]);
    refused(r#"{"type": "FeatureCollection", "features": []}"#, &["no points"]);
    let bad = |geometry: &str| {
        format!(
            "{{\"type\": \"FeatureCollection\", \"features\": [\n  {{\"type\": \"Feature\", \"geometry\": {geometry}}}\n]}}"
        )
    };
    refused(&bad(r#"{"type": "Point", "coordinates": [1]}"#), &["line 2, column 3", "two numbers"]);
    refused(&bad(r#"{"type": "Point", "coordinates": ["a", 2]}"#), &["line 2, column 3", "two numbers"]);
    refused(&bad(r#"{"type": "Circle", "coordinates": [1, 2]}"#), &["line 2, column 3", "\"Circle\""]);
    refused(&bad(r#"{"type": "MultiPoint", "coordinates": [1, 2]}"#), &["a position is a number"]);
    let deep = (0..20).fold(r#"{"type":"Point","coordinates":[1,2]}"#.to_owned(), |inner, _| {
        format!(r#"{{"type":"GeometryCollection","geometries":[{inner}]}}"#)
    });
    refused(&deep, &["more than 8 deep"]);
}

/// An SVG around `content`.
fn drawing(attributes: &str, content: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" {attributes}>\n{content}\n</svg>"
    )
}

#[test]
fn svg_circles_wherever_they_stand() {
    let page = "viewBox=\"0 0 100 100\"";
    let at = |content: &str| xy(&opened(drawing(page, content)).pattern);
    let round = |list: Vec<(f64, f64)>| {
        list.iter().map(|(x, y)| ((x * 1e6).round() / 1e6, (y * 1e6).round() / 1e6)).collect::<Vec<_>>()
    };
    assert_eq!(
        at("<circle cx='10' cy='20' r='3'/><ellipse cx='30px' cy='1in' rx='1' ry='2'/>"),
        [(10.0, 20.0), (30.0, 96.0)]
    );
    assert_eq!(at("<circle style='cx: 7; cy:8;r:1'/><circle cx='50%' cy='25%' r='1%'/>"), [(7.0, 8.0), (50.0, 25.0)]);
    assert_eq!(
        at("<g transform='translate(10, 20)'><g transform='scale(2)'><circle cx='5' cy='1' r='1'/></g></g>"),
        [(20.0, 22.0)]
    );
    assert_eq!(round(at("<circle transform='rotate(90 50 50)' cx='60' cy='50' r='1'/>")), [(50.0, 60.0)]);
    let twice = "<defs><circle id='c' cx='1' cy='2' r='1'/></defs><use href='#c' x='10'/><use xlink:href='#c' y='5' transform='translate(3)'/>";
    assert_eq!(at(twice), [(11.0, 2.0), (4.0, 7.0)]);
    assert_eq!(at("<symbol id='s'><circle cx='3' r='1'/></symbol><use href='#s' x='1' y='2'/>"), [(4.0, 2.0)]);
    let nested = "<svg x='20' y='20' width='50' height='50' viewBox='-1 -1 2 2'><circle r='.1'/><circle cx='1' cy='-1' r='.1'/></svg>";
    assert_eq!(at(nested), [(45.0, 45.0), (70.0, 20.0)]);
    let hidden = "<circle cx='1' cy='1' r='1'/><g display='none'><circle cx='9' r='1'/></g><circle style='visibility:hidden' r='1'/>\
                  <circle fill='none' r='1' cx='5'/><clipPath id='k'><circle r='50'/></clipPath><g visibility='hidden'><circle visibility='visible' cx='2' cy='2' r='1'/></g>";
    assert_eq!(at(hidden), [(1.0, 1.0), (2.0, 2.0)]);

    let reading = opened(drawing(
        page,
        "<circle cx='5' cy='5' r='0'/><circle cx='5' cy='200' r='1'/><path d='M0 0'/><circle cx='5' cy='5' r='1'/><use href='other.svg#x'/>",
    ));
    assert_eq!(reading.pattern.len(), 1);
    noted(&reading, "One mark outside the page");
    noted(&reading, "One reference to another file");
    noted(&reading, "One circle or line without a size");
    // Many programs name SVG's DTD; it is not looked at.
    let graphviz = "<?xml version='1.0'?>\n<!DOCTYPE svg PUBLIC \"-//W3C//DTD SVG 1.1//EN\"\n \"http://www.w3.org/svg11.dtd\">\n<svg viewBox='0 0 9 9'><circle cx='1' r='1'/></svg>";
    assert_eq!(opened(graphviz).pattern.len(), 1);
}

#[test]
fn svg_classes_radii_and_domain() {
    let reading = opened(drawing(
        "viewBox='0 0 100 50'",
        "<g fill='Red'><circle cx='10' cy='10' r='2'/><circle cx='90' cy='40' r='3' style='fill: #00F !important'/>\
         <circle cx='50' cy='40' r='2' fill='inherit'/></g><circle cx='5' cy='45' r='2' fill='none' stroke='rgb(0, 0,255)'/>",
    ));
    let pattern = &reading.pattern;
    assert_eq!(class_of(pattern), ["#ff0000", "#0000ff", "#ff0000", "#0000ff"]);
    assert_eq!(pattern.attributes(), [Attribute { name: "radius".to_owned(), values: vec![2.0, 3.0, 2.0, 2.0] }]);
    assert_eq!((pattern.domain(), reading.is_domain_declared), (domain(0.0, 0.0, 100.0, 50.0), false));
    // A transform scales radii by the root of its determinant.
    let flat = opened(drawing(
        "",
        "<g transform='scale(4, 1)'><circle cx='1' cy='1' r='1'/></g><circle cx='1' cy='9' r='1'/>",
    ))
    .pattern;
    assert_eq!(flat.attributes()[0].values, [2.0, 1.0]);
    // Circles in the corner of a sheet: the sheet is not their domain.
    let corner = opened(drawing(
        "width='210mm' height='297mm'",
        "<circle cx='2' cy='2' r='1'/><circle cx='6' cy='2' r='1'/><circle cx='4' cy='6' r='1'/>",
    ))
    .pattern;
    assert!(corner.domain().size().max_element() < 20.0, "{:?}", corner.domain());
    assert_eq!((corner.class_names(), corner.attributes().len()), (&["points".to_owned()][..], 0), "all alike");
}

/// As Illustrator, Inkscape and hands write them.
#[test]
fn svg_style_sheets() {
    let style = "<defs><style>.cls-1{fill:#f00}.cls-2 , .cls-3{fill:blue;stroke:#000}.cls-4{display:none}#odd{fill:lime}\
                 ellipse{fill:#ff0000;r:9}g ~ .deep{fill:lime}@media print{circle{display:none}}</style></defs>";
    let reading = opened(drawing(
        "viewBox='0 0 100 50'",
        &format!(
            "{style}<circle class='cls-1' cx='10' cy='10' r='2'/><circle class='x cls-3' cx='90' cy='40' r='2'/>\
             <g class='cls-4'><circle cx='50' cy='40' r='2'/></g><g class='cls-2'><circle id='odd' cx='5' cy='45' r='2'/>\
             <circle cx='30' cy='45' r='2'/></g><ellipse class='deep' cx='60' cy='10' rx='2' ry='2'/>"
        ),
    ));
    let pattern = &reading.pattern;
    assert_eq!(class_of(pattern), ["#ff0000", "#0000ff", "#00ff00", "#0000ff", "#ff0000"]);
    noted(&reading, "One rule of its style sheets");
    // Rules and elements, each within its limit, can be too many together.
    let many: String = (0..5000).map(|i| format!("circle{{r:{i}}}")).collect();
    refused(
        &format!("<svg><style>{many}</style>{}</svg>", "<circle r='1'/>".repeat(4_001)),
        &["line 1", "too many rules"],
    );
    refused(&format!("<svg>\n<circle class='{}' r='1'/></svg>", "a".repeat(5000)), &["line 2, column 1", "4000 bytes"]);
}

#[test]
fn svg_that_is_refused() {
    refused("<svg>\n <circle cx='a' r='1'/></svg>", &["line 2, column 2", "cx is \"a\""]);
    refused("<svg>\n <g transform='spin(3)'/></svg>", &["line 2, column 2", "spin(3)"]);
    refused("<svg>\n <circle></svg>", &["line 2", "circle"]);
    refused(
        "<svg viewBox='0 0 10 10'><rect width='9' height='9'/><path d='M0 0H5'/></svg>",
        &["no circles, dots or small shapes, but 2 other shapes"],
    );
    refused("<!DOCTYPE svg [<!ENTITY a 'b'><!ENTITY c '&a;&a;'>]><svg>&c;</svg>", &["line 1", "refer to each other"]);
    refused("<x><svg/></x>", &["<x>, not <svg>"]);
    let deep = format!("<svg>{}<circle r='1'/>{}</svg>", "<g>".repeat(100), "</g>".repeat(100));
    refused(&deep, &["more than 64 deep"]);
    // A thousand ways to show a thousand circles, each a thousand times.
    let mut bomb = String::from("<svg><g id='a0'><circle r='1'/></g>");
    for level in 1..12 {
        let uses = format!("<use href='#a{}'/>", level - 1).repeat(10);
        bomb.push_str(&format!("<g id='a{level}'>{uses}</g>"));
    }
    refused(&(bomb + "</svg>"), &["more than"]);
    refused("<svg><g id='a'><use href='#a'/></g></svg>", &["more than 64 deep"]);
    refused(
        &format!("<svg><circle {} r='1'/></svg>", (0..600).map(|i| format!("a{i}=''")).collect::<Vec<_>>().join(" ")),
        &["too many attributes"],
    );
    let names: String = (0..4000).map(|i| format!("<g xmlns:n{i}='u{i}'>")).collect();
    refused(&format!("<svg>{names}"), &["too many namespaces"]);
    refused(&format!("<svg><circle style='{}' r='1'/></svg>", "a".repeat(5000)), &["4000 bytes"]);
}

#[test]
fn our_own_svg_reads_back() {
    for seed in 0..20 {
        let pattern = awkward(seed);
        if pattern.class_names().len() > 1 && pattern.class_names().iter().any(|name| name.trim() != name) {
            continue;
        }
        let reading = opened(write_svg(&pattern, &SvgStyle::default()));
        assert_eq!((reading.pattern.domain(), reading.pattern.boundary()), (pattern.domain(), pattern.boundary()));
        assert_eq!(reading.pattern.len(), pattern.len(), "{seed}");
        // Pixels have three decimals.
        let step = pattern.domain().exemplar_unit() / 800.0 * 2e-3;
        for at in reading.pattern.positions() {
            let near = pattern.positions().iter().any(|other| {
                let offset = (*at - *other).abs();
                let around = (pattern.domain().size() - offset).abs();
                offset.min(if pattern.boundary() == Boundary::Periodic { around } else { offset }).max_element() <= step
            });
            assert!(near, "{at} in {seed}");
        }
    }
    let colours = good("# domain 0 0 2 1\nx,y,class,radius\n0.5,0.5,b,0.1\n1.5,0.25,a,0.2\n");
    let back = opened(write_svg(&colours, &SvgStyle::default())).pattern;
    assert_eq!(class_of(&back), ["b", "a"]);
    assert!((back.attributes()[0].values[1] - 0.2).abs() < 1e-5);
    // Glyphs are no circles, but ours, in whatever order they are drawn.
    let things = good(
        "# domain 0 0 2 1\nx,y,class,scale,orientation,depth\n0.5,0.5,tree,3,0,2\n1.5,0.25,boat,1,30,1\n1,0.5,house,1,0,3\n",
    );
    let back = opened(write_svg(&things, &SvgStyle::default())).pattern;
    assert_eq!(class_of(&back), ["house", "tree", "boat"]);
    assert!(back.positions()[1].abs_diff_eq(DVec2::splat(0.5), 3e-6), "{back:?}");
    let radii = &back.attributes()[0].values;
    assert!((radii[1] / radii[0] - 3.0).abs() < 0.01, "{radii:?}");
}

/// A `.npy` file around `data`.
fn npy(version: u8, header: &str, data: &[u8]) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY".to_vec();
    bytes.extend([version, 0]);
    match version {
        1 => bytes.extend((header.len() as u16).to_le_bytes()),
        _ => bytes.extend((header.len() as u32).to_le_bytes()),
    }
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

#[test]
fn numpy_arrays_of_every_kind() {
    let header = |descr: &str, fortran: &str, shape: &str| {
        format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n")
    };
    let doubles: Vec<u8> = [0.1, 0.2, 0.3, 0.4].iter().flat_map(|value: &f64| value.to_le_bytes()).collect();
    for version in 1..=3 {
        let read = opened(npy(version, &header("<f8", "False", "(2, 2)"), &doubles));
        assert_eq!((read.format, xy(&read.pattern)), (FileFormat::Npy, vec![(0.1, 0.2), (0.3, 0.4)]));
    }
    assert_eq!(xy(&opened(npy(1, &header("<f8", "True", "(2, 2)"), &doubles)).pattern), [(0.1, 0.3), (0.2, 0.4)]);
    let floats: Vec<u8> = [0.5_f32, 0.25].iter().flat_map(|value| value.to_be_bytes()).collect();
    assert_eq!(xy(&opened(npy(1, &header(">f4", "False", "(1, 2)"), &floats)).pattern), [(0.5, 0.25)]);
    let whole = |descr: &str, data: &[u8]| xy(&opened(npy(1, &header(descr, "False", "(2, 2)"), data)).pattern);
    assert_eq!(whole("|i1", &[255, 2, 3, 4]), [(-1.0, 2.0), (3.0, 4.0)]);
    assert_eq!(whole("|u1", &[255, 2, 3, 4]), [(255.0, 2.0), (3.0, 4.0)]);
    assert_eq!(whole(">i2", &[255, 254, 0, 2, 0, 3, 0, 4]), [(-2.0, 2.0), (3.0, 4.0)]);
    assert_eq!(whole("<u4", &[0, 0, 0, 128, 2, 0, 0, 0, 3, 0, 0, 0, 4, 0, 0, 0])[0], (2_147_483_648.0, 2.0));
    // The third column by the rule of text: whole numbers are classes, others an attribute.
    let columns = opened(npy(1, &header("|u1", "False", "(3, 4)"), &[1, 2, 7, 9, 3, 5, 8, 6, 4, 4, 8, 5])).pattern;
    assert_eq!(
        (class_of(&columns), columns.attributes()[0].values.clone()),
        (vec!["7", "8", "8"], vec![9.0, 6.0, 5.0])
    );

    let words = |bytes: &[u8]| open(bytes, None, &ReadOptions::default()).unwrap_err().to_string();
    // Where: 10 bytes come before the header, 11 before the type within it.
    for (bytes, byte) in [
        (b"\x93NUMPY".to_vec(), 6),
        (npy(9, "", &[]), 6),
        (npy(1, "{}", &[]), 10),
        (npy(1, &header("<c16", "False", "(2, 2)"), &doubles), 20),
        (npy(2, &header("<c16", "False", "(2, 2)"), &doubles), 22),
        (npy(1, &header("<f8", "False", "(4,)"), &doubles), 60),
        (npy(1, &header("<f8", "False", "(2, 3)"), &doubles), 70),
    ] {
        let place = format!("(byte {byte} of the file)");
        assert!(words(&bytes).contains(&place), "{} without {place:?}", words(&bytes));
    }
    for (bytes, part) in [
        (b"\x93NUMPY".to_vec(), "ends within its header"),
        (npy(1, "", &[])[..9].to_vec(), "ends within its header"),
        (npy(9, &header("<f8", "False", "(2, 2)"), &doubles), "version is 9"),
        (npy(1, "{}", &[]), "no 'descr'"),
        (npy(1, &header("<c16", "False", "(2, 2)"), &doubles), "\"<c16\""),
        (npy(1, &header("|O", "False", "(2, 2)"), &doubles), "\"|O\""),
        (npy(1, "{'descr': [('x', '<f8')], 'fortran_order': False, 'shape': (2,), }", &doubles), "named fields"),
        (npy(1, &header("<f8", "False", "(4,)"), &doubles), "shape is (4)"),
        (npy(1, &header("<f8", "False", "(4, 1)"), &doubles), "1 columns"),
        (npy(1, &header("<f8", "False", "(2, 3)"), &doubles), "do not take 32 bytes"),
        (npy(1, &header("<f8", "False", "(18446744073709551615, 2)"), &doubles), "at most 20000"),
        (npy(1, &header("<f8", "False", "(0, 2)"), &[]), "no points"),
        (npy(1, &header("<f8", "False", "(1, 2)"), &[255; 16]), "point 1 of the list, value 1"),
        (npy(2, "", &[])[..8].iter().copied().chain([255; 4]).collect(), "at most 10000"),
    ] {
        assert!(words(&bytes).contains(part), "{} without {part:?}", words(&bytes));
    }
}

#[test]
fn our_own_arrays_read_back() {
    for seed in 0..20 {
        let pattern = awkward(seed);
        let options = ReadOptions {
            domain: Some(pattern.domain()),
            boundary: Some(pattern.boundary()),
            ..ReadOptions::default()
        };
        let bytes = write_npy(&pattern);
        assert_eq!(bytes.iter().position(|&byte| byte == b'\n').map(|end| (end + 1) % 64), Some(0));
        let back = read(&bytes, None, &options).unwrap();
        assert_eq!(back.positions(), pattern.positions());
        let classes = usize::from(pattern.class_names().len() > 1);
        assert_eq!(
            back.attributes().len() + usize::from(back.class_names().len() > 1 || classes == 1),
            pattern.attributes().len() + classes
        );
    }
}

#[test]
fn cells_go_to_a_spreadsheet_and_back() {
    let pattern = good("# domain 0 0 1 1\nx,y,class,radius\n0.5,0.25,a b,3\n0.1,0.2,c,4\n");
    let cells = write_tsv(&pattern);
    assert_eq!(cells, "x\ty\tclass\tradius\n0.5\t0.25\t\"a b\"\t3\n0.1\t0.2\tc\t4\n");
    assert_eq!(good(&cells), pattern);
}

#[test]
fn dark_blobs_of_a_png_become_points() {
    let style = PngStyle { size_px: 400, look: Look { frame: None, margin: 0.0, ..Look::default() } };
    let pattern = good("# domain 0 0 4 4\nx,y,radius\n1,1,0.25\n3,2,0.5\n1,3,0.25\n");
    let reading = opened(write_png(&pattern, &style).unwrap());
    assert_eq!((reading.format, reading.pattern.domain()), (FileFormat::Picture, domain(0.0, 0.0, 400.0, 400.0)));
    let mut found: Vec<_> = reading.pattern.positions().iter().map(|at| (at.x.round(), at.y.round())).collect();
    found.sort_by(|a, b| a.partial_cmp(b).unwrap());
    assert_eq!(found, [(100.0, 100.0), (100.0, 300.0), (300.0, 200.0)]);
    let mut radii = reading.pattern.attributes()[0].values.clone();
    radii.sort_by(f64::total_cmp);
    assert!((radii[0] - 25.0).abs() < 1.0 && (radii[2] - 50.0).abs() < 1.0, "{radii:?}");
}

/// Patterns with everything that could get lost: digits, odd names, unused classes, reserved attribute names.
fn awkward(seed: u64) -> PointPattern {
    const NAMES: [&str; 8] = ["a", "silver birch", " padded ", "#1", "say \"hi\"", "c,d;e", "7", "μ\u{1f333}"];
    const ATTRIBUTES: [&str; 8] = ["radius", "class", " X", "y ", "attribute:w", "a,b", "#", "größe 2"];
    let mut rng = Rng::new(seed, Purpose::Gallery);
    let scale = 10_f64.powf(rng.range(-30.0, 30.0));
    let min = DVec2::new(rng.range(-3.0, 3.0), rng.range(-3.0, 3.0)) * scale;
    let domain = Domain::new(min, DVec2::new(rng.range(0.1, 2.0), rng.range(0.1, 2.0)) * scale).unwrap();
    let count = 1 + rng.index(40);
    let positions = (0..count)
        .map(|_| (domain.min() + domain.size() * DVec2::new(rng.uniform(), rng.uniform())).min(domain.max()))
        .collect();
    let mut pattern = PointPattern::new(domain, positions).unwrap();
    if rng.index(2) == 0 {
        pattern = pattern.with_boundary(Boundary::Periodic);
    }
    if rng.index(4) > 0 {
        let start = rng.index(NAMES.len());
        let names: Vec<String> = (0..=rng.index(5)).map(|i| NAMES[(start + i) % NAMES.len()].to_owned()).collect();
        let classes = (0..count).map(|_| rng.index(names.len()) as u16).collect();
        pattern = pattern.with_classes(classes, names).unwrap();
    }
    let start = rng.index(ATTRIBUTES.len());
    for i in 0..rng.index(5) {
        let name = ATTRIBUTES[(start + i) % ATTRIBUTES.len()].to_owned();
        let values = (0..count).map(|_| rng.normal() * 10_f64.powf(rng.range(-300.0, 300.0)));
        // A size has no sign.
        let values = values.map(|value| if name == "radius" { value.abs() } else { value }).collect();
        pattern = pattern.with_attribute(Attribute { name, values }).unwrap();
    }
    pattern
}

#[test]
fn csv_and_json_lose_nothing() {
    for seed in 0..300 {
        let pattern = awkward(seed);
        let csv = write_csv(&pattern);
        assert_eq!(good(&csv), pattern, "seed {seed}:\n{csv}");
        assert_eq!(good(&csv.replace('\n', "\r\n")), pattern, "seed {seed} with CRLF:\n{csv}");
        let json = write_json(&pattern);
        assert_eq!(good(&json), pattern, "seed {seed}:\n{json}");
    }
    let zero = PointPattern::new(Domain::UNIT, vec![DVec2::new(-0.0, 1.0 / 3.0)]).unwrap();
    assert_eq!(write_csv(&zero), "# domain 0 0 1 1 open\nx,y\n-0,0.3333333333333333\n");
    assert!(good(&write_csv(&zero)).positions()[0].x.is_sign_negative());
}

#[test]
fn random_bytes_never_panic() {
    const PIECES: [&str; 28] = [
        "0.5",
        "1e38",
        "-3",
        "nan",
        "inf",
        "x",
        "y",
        "class",
        ",",
        ";",
        "\t",
        " ",
        "\n",
        "\r\n",
        "\r",
        "\"",
        "#",
        "# domain ",
        "# classes: ",
        "[",
        "]",
        "{\"points\":",
        "}",
        "1000",
        "10000",
        "periodic",
        "é",
        "size",
    ];
    let mut rng = Rng::new(7, Purpose::Gallery);
    let (mut read_well, mut refused) = (0, 0);
    for round in 0..30_000 {
        let mut bytes = Vec::new();
        for place in 0..rng.index(30) {
            // Noise, pieces in any order, and rows of two with the odd piece out of place.
            if round % 3 == 0 {
                bytes.push(rng.index(256) as u8);
            } else if round % 3 == 1 || rng.index(20) == 0 {
                bytes.extend_from_slice(PIECES[rng.index(PIECES.len())].as_bytes());
            } else {
                bytes.extend_from_slice([&b"0.5"[..], b" ", b"-7", b"\n"][place % 4]);
            }
        }
        match read(&bytes, Some("a.csv"), &ReadOptions::default()) {
            Ok(pattern) => {
                read_well += 1;
                assert_eq!(good(&write_csv(&pattern)), pattern, "{:?}", String::from_utf8_lossy(&bytes));
            }
            Err(error) => {
                refused += 1;
                assert!(!error.to_string().is_empty());
            }
        }
    }
    assert!(read_well > 50 && refused > 10_000, "{read_well} read, {refused} refused");
}

#[test]
fn svg_shows_every_point_once_in_its_place() {
    let pattern = good("# domain 0 0 20 10\nx,y,class,w\n0,0,a<b,1\n20,10,\"c&\"\"d\",2\n10,5,a<b,3\n");
    let style = SvgStyle { size_px: 200.0, look: Look { margin: 0.0, ..Look::default() }, ..SvgStyle::default() };
    let svg = write_svg(&pattern, &style);
    assert!(svg.contains("viewBox=\"0 0 200 100\""), "{svg}");
    // The first class is disks, the second squares.
    assert_eq!((svg.matches("<circle").count(), svg.matches("<use").count()), (2, 1));
    // y points down.
    for place in ["cx=\"0\" cy=\"0\"", "translate(200 100) scale(", "cx=\"100\" cy=\"50\""] {
        assert!(svg.contains(place), "{place} in {svg}");
    }
    assert!(svg.contains("data-class=\"a&lt;b\"") && svg.contains("data-class=\"c&amp;&quot;d\""), "{svg}");
    assert!(svg.contains("<title>3 points</title>"));
    let titled = write_svg(&pattern, &SvgStyle { title: "<>&\u{1}".to_owned(), ..style.clone() });
    assert!(titled.contains("<title>&lt;&gt;&amp;\u{fffd}</title>"), "{titled}");

    let disks = write_svg(&good("# domain 0 0 20 10\nx,y,radius\n5,5,2\n15,5,4\n"), &style);
    assert!(disks.contains("r=\"20\"") && disks.contains("r=\"40\""), "{disks}");
    let tile = write_svg(&good("# domain 0 0 20 10 periodic\nx,y\n0,5\n10,5\n"), &style);
    assert_eq!(tile.matches("<circle").count(), 3, "the point on the border shows on both sides");
    assert!(tile.contains("clip-path"));
}

#[test]
fn glyphs_are_drawn_alike_in_svg_and_png() {
    // An arrow that points up, a house behind a tree at the same place, a disk in front of everything.
    let text =
        "# domain 0 0 20 10\nx,y,class,scale,orientation,depth\n5,5,arrow,4,90,1\n15,5,tree,4,0,2\n15,5,house,8,0,3\n";
    let pattern = good(text);
    let look = Look { margin: 0.0, disk: 0.2, ..Look::default() };
    let svg = write_svg(&pattern, &SvgStyle { size_px: 200.0, look: look.clone(), ..SvgStyle::default() });
    let place = |part: &str| svg.find(part).unwrap_or_else(|| panic!("{part} in {svg}"));
    assert!(place("data-class=\"house\"") < place("data-class=\"tree\""), "what is behind is drawn first");
    assert!(place("data-class=\"tree\"") < place("data-class=\"arrow\""));
    assert!(svg.contains("translate(50 50) rotate(-90) scale(") && svg.contains("paint-order=\"stroke\""), "{svg}");

    let at = |look: &Look, x: usize, y: usize| -> [u8; 3] {
        let (_, _, pixels) = decode(&write_png(&pattern, &PngStyle { size_px: 200, look: look.clone() }).unwrap());
        pixels[4 * (y * 200 + x)..][..3].try_into().unwrap()
    };
    let (blue, red, green, white) = ([0x00, 0x72, 0xb2], [0xd5, 0x5e, 0x00], [0x00, 0x9e, 0x73], [255; 3]);
    // Common radius: 0.04 of 200 pixels at most, times the scale against its mean of 16⁄3.
    let radius = 8.0 * 4.0 / (16.0 / 3.0);
    let up = |share: f64| (50.0 - share * radius).round() as usize;
    assert_eq!((at(&look, 50, up(1.2)), at(&look, 50, up(-1.2))), (blue, white), "the arrow points up");
    assert_eq!(at(&look, 150, 50), green, "the tree stands before the house");
    let eaves = (150.0 + 0.85 * 2.0 * radius).round() as usize;
    assert_eq!(at(&look, eaves, 52), red, "the house is twice as large");

    // A person's own shape, and other colours.
    let own = Glyph::from_name("path:M0 0L10 0L10 10L0 10ZM2 2L2 8L8 8L8 2Z").unwrap();
    let look = Look { glyphs: vec![("arrow".to_owned(), own)], palette: Palette::Ink, ..look };
    assert_eq!((at(&look, 50, 50), at(&look, 50, up(0.8))), (white, [0x22; 3]), "a frame with a hole");
    let svg = write_svg(&pattern, &SvgStyle { size_px: 200.0, look, ..SvgStyle::default() });
    assert!(svg.contains("d=\"M-1 -1L1 -1L1 1L-1 1ZM-0.6 -0.6L-0.6 0.6L0.6 0.6L0.6 -0.6Z\""), "{svg}");
}

#[test]
fn png_looks_like_the_svg() {
    let pattern = good("# domain 0 0 20 10\nx,y,class,radius\n5,5,a,2\n15,5,b,4\n");
    let style = PngStyle { size_px: 200, look: Look { margin: 0.0, ..Look::default() } };
    let (width, height, pixels) = decode(&write_png(&pattern, &style).unwrap());
    assert_eq!((width, height), (200, 100));
    let at = |x: usize, y: usize| &pixels[4 * (y * 200 + x)..][..3];
    let (blue, red, white) = (&[0x00, 0x72, 0xb2][..], &[0xd5, 0x5e, 0x00][..], &[255, 255, 255][..]);
    assert_eq!((at(50, 50), at(150, 50)), (blue, red));
    // Radii 20 and 40 pixels.
    assert_eq!((at(50, 31), at(50, 25)), (blue, white));
    assert_eq!((at(150, 12), at(150, 7)), (red, white));

    for size_px in [0, 15, 8193] {
        let message = write_png(&pattern, &PngStyle { size_px, ..style.clone() }).unwrap_err().to_string();
        assert!(message.contains(&size_px.to_string()) && message.contains("16 to 8192"), "{message}");
    }
}

#[test]
fn drawing_stays_in_its_rectangle() {
    let pattern = good("0.5 0.5\n0.1 0.1\n0.9 0.9");
    let mut pixmap = tiny_skia::Pixmap::new(60, 40).unwrap();
    draw(&pattern, &mut pixmap, 20.0, 10.0, 30.0, 20.0, &Look::default());
    for (index, pixel) in pixmap.pixels().iter().enumerate() {
        let (x, y) = (index % 60, index / 60);
        let inside = (20..50).contains(&x) && (10..30).contains(&y);
        assert_eq!(pixel.alpha() == 255, inside, "{x} {y}");
    }
    let before = pixmap.data().to_vec();
    draw(&pattern, &mut pixmap, 0.0, 0.0, 0.0, f64::NAN, &Look::default());
    assert_eq!(pixmap.data(), before);
}
