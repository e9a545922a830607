//! Files in, files out: what is read, what is refused and in which words, and that nothing is lost on the way.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use glam::DVec2;
use pointweave::formats::style::{Look, Palette};
use pointweave::formats::{
    FormatError, Glyph, MAX_BYTES, PngStyle, ReadOptions, SvgStyle, draw, read, write_csv, write_json, write_png,
    write_svg,
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
    let message = load(text).expect_err(text).to_string();
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

    let options = ReadOptions { domain: Some(domain(0.0, 0.0, 9.0, 9.0)), boundary: Some(Boundary::Periodic) };
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
    refused("0.1 0.2\n# c\n\nnan 0.3", &["line 4, column 1", "x is \"nan\"", "finite number"]);
    refused("nan,nan", &["line 1, column 1", "\"nan\""]);
    refused("0.1,inf", &["line 1, column 2", "\"inf\""]);
    refused("0.1,1e999", &["line 1, column 2", "\"1e999\""]);
    refused("0.1,", &["line 1, column 2", "y is \"\""]);
    refused("0.1;1.000,5", &["line 1, column 2", "\"1.000,5\""]);
    refused("x,y,w\n0,0,1\n0,0,\n", &["line 3, column 3", "w is \"\""]);
    refused("x,y,class\n0,0,a\n0,0, \n", &["line 3, column 3", "class is \"\"", "word"]);
    refused("oak,0.1,0.2", &["line 1, column 1", "x is \"oak\""]);
    refused("x,y\n0,0\n1\n", &["line 3, column 2", "1 values", "2 are needed"]);
    refused("x,y\n0,0\n1,2,3\n", &["line 3, column 3", "3 values", "2 are needed"]);
    refused("0.5\n0.6", &["line 1", "1 values", "at least 2 (x and y)"]);
    refused("lon,lat\n1,2", &["line 1", "'x'", "lon, lat"]);
    refused("x,class\n1,2", &["line 1", "'y'", "x, class"]);
    refused("x,y,w,w\n1,2,3,4", &["line 1, column 4", "\"w\""]);
    refused("x,y,X\n1,2,3", &["line 1, column 3", "\"X\""]);
    refused(&format!("x,y\n1,{}", "9z".repeat(100)), &["9z9z…"]);
    refused("x,y,a b\n0,0,\"un\nclosed", &["line 2, column 3"]);
    // Lines are counted over comments, blank lines and quoted line ends, whatever ends a line.
    refused("# a\r\n\r\nx,y,class\r\n# b\r\n0,0,a\r\n\r\n# c\r\n0,oops,a\r\n", &["line 8, column 2"]);
    refused("# a\rx,y\r0,0\r# c\r0,oops\r", &["line 5, column 2"]);
    refused("x,y,class\n0,0,\"a\"\n\n0,\"\n\",a\n", &["line 4, column 2"]);
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
    refused("[[0, 0], [0, null]]", &["point 2 of the list, value 2", "y is \"\""]);
    refused("[[0, 0], [0, [1]]]", &["point 2 of the list, value 2", "\"[1]\""]);
    refused("[[0, 0], 5]", &["point 2 of the list is a number", "a list [x, y]"]);
    refused("[[0, 0], [0]]", &["point 2 of the list", "1 values"]);
    refused("[{\"x\": 1}]", &["no 'y'"]);
    refused("[{\"x\": 1, \"y\": 0}, {\"x\": 1}]", &["point 2 of the list has no 'y'"]);
    refused("[{\"x\": 1, \"y\": 0}, {\"x\": 1, \"y\": 0, \"z\": 1}]", &["point 2", "'z'"]);
    refused("{\"type\": \"FeatureCollection\", \"features\": []}", &["neither 'points' nor 'positions'", "'features'"]);
    refused("{\"points\": 7}", &["'points' is a number"]);
    refused("{\"points\": [[0,0]], \"boundary\": \"torus\"}", &["\"torus\"", "\"periodic\""]);
    refused("{\"points\": [[0,0]], \"domain\": [0, 0, 1]}", &["'domain' must be [x0, y0, x1, y1]"]);
    refused("{\"points\": [[0,0]], \"domain\": [0, 0, 1, 0]}", &["greater than 0"]);
    refused("{\"domain\": {\"min\": [0,0], \"size\": [1,1]}, \"positions\": [[0, 2]]}", &["point 0 at (0, 2)"]);
    refused("{\"positions\": [[0, 0]], \"classes\": [1], \"class_names\": [\"a\"]}", &["class 1", "1 classes"]);
    refused("{\"positions\": [[0, \"a\"]]}", &["'positions'"]);
    let named = read(b"5", Some("a.JSON"), &ReadOptions::default()).unwrap_err().to_string();
    assert!(named.contains("it is a number"), "{named}");
    refused(&"[".repeat(5000), &["recursion"]);
    refused(&format!("[{}0]", "[],".repeat(3_000_001)), &["more than 3000000 values"]);
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
    refused(&format!("{sixteen}0 0 c16"), &["line 17, column 3", "\"c16\"", "16 classes"]);
    let declared: String = (0..17).map(|i| format!("c{i},")).collect();
    refused(&format!("# classes: {declared}d\n0 0 d"), &["18 classes", "at most 16"]);
    let announced: String = (1..=17).map(|i| format!(" {i}000")).collect();
    refused(&format!("17{announced}\n1000 5 5"), &["17 classes", "at most 16"]);
    let wide = |count: usize| {
        let names: String = (0..count).map(|i| format!(",a{i}")).collect();
        format!("x,y{names}\n0,0{}", ",1".repeat(count))
    };
    assert_eq!(good(&wide(8)).attributes().len(), 8);
    refused(&wide(9), &["9 attributes", "at most 8"]);
    refused(&format!("0.5 0.5{}", " 0.5".repeat(9)), &["line 1", "8 attributes"]);
    refused(&wide(80), &["line 1, column 65", "64 columns"]);
    refused(&format!("0 0\n{}1 1", " ".repeat(10_000)), &["line 2", "10003 bytes", "at most 10000"]);
    refused(&format!("x,y,class\n0,0,{}", "é".repeat(65)), &["longer than 64"]);
    assert_eq!(
        read(&vec![b'1'; MAX_BYTES + 1], None, &ReadOptions::default()),
        Err(FormatError::TooLarge { bytes: 20_000_001, max: 20_000_000 })
    );
}

#[test]
fn other_files_are_named() {
    for (bytes, word) in [
        (&b"\x89PNG\r\n\x1a\n"[..], "PNG picture"),
        (b"PK\x03\x04....", "spreadsheet"),
        (b"\xff\xfe0\x00", "UTF-16"),
        (b"  <svg/>", "XML"),
        (b"0.5 0.5\x00", "binary"),
        (b"0 0\n1 1 \xe9l\xe9\n", "line 2: byte 0xe9 is not UTF-8"),
    ] {
        let message = read(bytes, None, &ReadOptions::default()).unwrap_err().to_string();
        assert!(message.contains(word), "{message}");
    }
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
        let values = (0..count).map(|_| rng.normal() * 10_f64.powf(rng.range(-300.0, 300.0))).collect();
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

/// Width, height and RGBA bytes.
fn decode(bytes: &[u8]) -> (u32, u32, Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    (info.width, info.height, pixels)
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
