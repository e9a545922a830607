//! NumPy's arrays and archives as programs write them.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

#[path = "common/decoders.rs"]
mod decoders;

use decoders::zip;
use pointweave::formats::{FileFormat, ReadOptions, Reading, open};

/// Forty points in a jittered grid; every number is one of 16 bits.
fn grid() -> Vec<[f64; 2]> {
    (0..40)
        .map(|i: i32| {
            let jitter = |k: i32| f64::from((i * k) % 7 - 3) * 0.25;
            [f64::from(i % 8) * 10.0 + jitter(3), f64::from(i / 8) * 10.0 + jitter(5)]
        })
        .collect()
}

fn npy(descr: &str, order: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let descr = if descr.starts_with('[') { descr.to_owned() } else { format!("'{descr}'") };
    let header = format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}\n");
    [b"\x93NUMPY\x01\x00", &(header.len() as u16).to_le_bytes()[..], header.as_bytes(), data].concat()
}

fn doubles(values: impl IntoIterator<Item = f64>) -> Vec<u8> {
    values.into_iter().flat_map(f64::to_le_bytes).collect()
}

fn all() -> Vec<f64> {
    grid().concat()
}

fn axis(axis: usize) -> Vec<f64> {
    grid().iter().map(|at| at[axis]).collect()
}

#[track_caller]
fn opened(bytes: &[u8]) -> Reading {
    open(bytes, None, &ReadOptions::default())
        .unwrap_or_else(|error| panic!("{}: {error}", String::from_utf8_lossy(bytes)))
}

#[track_caller]
fn is_the_grid(reading: &Reading) {
    assert_eq!(reading.format, FileFormat::Npy);
    let places: Vec<[f64; 2]> = reading.pattern.positions().iter().map(|point| point.to_array()).collect();
    assert_eq!(places, grid());
}

#[track_caller]
fn refused(bytes: &[u8], parts: &[&str]) {
    let error = open(bytes, None, &ReadOptions::default()).unwrap_err().to_string();
    for part in parts {
        assert!(error.contains(part), "{error:?} without {part:?}");
    }
}

#[track_caller]
fn noted(reading: &Reading, part: &str) {
    assert!(reading.notes.iter().any(|note| note.text.contains(part)), "{:?} without {part:?}", reading.notes);
}

/// A number of 16 bits, of those that are exactly one.
fn half(value: f64) -> u16 {
    if value == 0.0 {
        return 0;
    }
    let exponent = value.abs().log2().floor() as i32;
    let fraction = (value.abs() / 2_f64.powi(exponent) - 1.0) * 1024.0;
    u16::from(value < 0.0) << 15 | ((exponent + 15) as u16) << 10 | fraction as u16
}

#[test]
fn shapes_and_types() {
    let columns: Vec<f64> = axis(0).into_iter().chain(axis(1)).collect();
    let big: Vec<u8> = columns.iter().flat_map(|value| value.to_be_bytes()).collect();
    let halves: Vec<u8> = all().into_iter().flat_map(|value| half(value).to_le_bytes()).collect();
    let big_halves: Vec<u8> = all().into_iter().flat_map(|value| half(value).to_be_bytes()).collect();
    let singles: Vec<u8> = all().into_iter().flat_map(|value| (value as f32).to_le_bytes()).collect();
    for bytes in [
        npy("<f8", "False", "(40, 2)", &doubles(all())),
        npy("<f8", "False", "(40L, 2L)", &doubles(all())),
        npy("<f8", "True", "(40, 2)", &doubles(columns.clone())),
        npy(">f8", "True", "(40, 2)", &big),
        npy("<f2", "False", "(40, 2)", &halves),
        npy(">f2", "False", "(40, 2)", &big_halves),
        npy("<f8", "False", "(40, 1, 2)", &doubles(all())),
        npy("<f8", "False", "(1, 40, 2)", &doubles(all())),
        npy("<c16", "False", "(40,)", &doubles(all())),
        npy("<c8", "False", "(40, 1)", &singles),
        npy("[('x', '<f8'), ('y', '<f8')]", "False", "(40,)", &doubles(all())),
        npy("[('xy', '<f4', (2,))]", "False", "(40, 1)", &singles),
        npy("[('pos', '<f4', 2)]", "False", "(1, 40)", &singles),
        npy("[('f0', '<f8'), ('f1', '<f8')]", "False", "(40,)", &doubles(all())),
        npy("[('z', '<c16')]", "False", "(40,)", &doubles(all())),
    ] {
        let reading = opened(&bytes);
        is_the_grid(&reading);
        assert!(reading.notes.is_empty() && reading.pattern.attributes().is_empty(), "{:?}", reading.notes);
    }
    for bytes in [
        npy("<f8", "False", "(2, 40)", &doubles(columns.clone())),
        npy("<f8", "True", "(2, 40)", &doubles(all())),
        npy(">f8", "False", "(2, 40)", &big),
    ] {
        let reading = opened(&bytes);
        is_the_grid(&reading);
        noted(&reading, "2 rows and 40 columns, so its rows were taken for x and y of 40 points");
    }
    let three: Vec<f64> = columns.into_iter().chain((0..40).map(|i| f64::from(i % 3))).collect();
    let reading = opened(&npy("<f8", "False", "(3, 40)", &doubles(three)));
    is_the_grid(&reading);
    assert_eq!(reading.pattern.class_names().len(), 3);
    noted(&reading, "3 rows and 40 columns");
}

#[test]
fn named_fields_are_columns() {
    let mut data = Vec::new();
    for (i, [x, y]) in grid().into_iter().enumerate() {
        data.extend((i as i32).to_le_bytes());
        data.extend([0; 4]);
        data.extend(doubles([y, x]));
        data.extend(["ash\0\0", "birch"][i % 2].as_bytes());
        data.extend(["é", "o"][i % 2].chars().chain(['\0', '\0']).take(2).flat_map(|c| u32::from(c).to_be_bytes()));
        data.extend((i as f32 / 2.0).to_be_bytes());
        data.push(u8::from(i % 4 == 0));
    }
    let descr = "[('id', '<i4'), ('', '|V4'), ('y', '<f8'), (\"x\", '<f8'), ('species', 'S5'), ('letter', '>U2'), ('dbh', '>f4'), ('old', '|b1')]";
    let reading = opened(&npy(descr, "False", "(40,)", &data));
    is_the_grid(&reading);
    assert_eq!(reading.pattern.class_names(), ["ash", "birch"]);
    let dbh = reading.pattern.attributes().iter().find(|it| it.name == "dbh").unwrap();
    assert_eq!(dbh.values[3], 1.5);
    noted(&reading, "id");
    noted(&reading, "letter");

    for (descr, part) in [
        ("[('p', [('x', '<f8'), ('y', '<f8')])]", "nested"),
        ("[('x', '<f8'), ('y', '<f8'", "not understood"),
        ("[('x', '<f8'), ('y', '|O')]", "Python's objects"),
        ("[('x', '<f8'), ('y', '<f8', (99999999999999999999,))]", "not understood"),
        ("[]", "no fields"),
        ("[('a', '<f8'), ('b', '<f8')]", "a, b"),
    ] {
        refused(&npy(descr, "False", "(40,)", &doubles(all())), &[part]);
    }
}

#[test]
fn what_is_no_array_of_places_is_named() {
    for (bytes, parts) in [
        (
            npy("<f8", "False", "(80,)", &doubles(all())),
            &["shape is (80), single numbers", "column_stack", "byte 60"][..],
        ),
        (npy("<f8", "False", "()", &doubles([1.0])), &["one number"]),
        (npy("<f8", "False", "(80, 1)", &doubles(all())), &["1 columns"]),
        (npy("<f8", "False", "(4, 2, 10)", &doubles(all())), &["shape is (4, 2, 10)"]),
        (npy("<f8", "False", "(-40, 2)", &doubles(all())), &["which are no sizes"]),
        (npy("<c16", "False", "(20, 2)", &doubles(all())), &["complex numbers must be in one row"]),
        (npy("<U2", "False", "(40, 2)", &doubles(all())), &["words"]),
        (npy("|O", "False", "(40, 2)", &doubles(all())), &["Python's objects"]),
        (npy("<f8", "False", "(40, 3)", &doubles(all())), &["do not take 640 bytes"]),
        (npy("<f8", "False", "(2, 30000)", &[]), &["at most 20000"]),
    ] {
        refused(&bytes, parts);
    }
}

#[test]
fn archives_hold_places_and_what_belongs_to_them() {
    let places = npy("<f8", "False", "(40, 2)", &doubles(all()));
    let x = npy("<f8", "False", "(40,)", &doubles(axis(0)));
    let y = npy("<f8", "False", "(40,)", &doubles(axis(1)));
    let classes = npy(
        "<U3",
        "False",
        "(40,)",
        &(0..40)
            .flat_map(|i| ["ash", "elm"][i % 2].chars())
            .flat_map(|c| u32::from(c).to_le_bytes())
            .collect::<Vec<u8>>(),
    );
    let dbh =
        npy("<f4", "False", "(40, 1)", &(0..40).flat_map(|i| (i as f32 + 0.5).to_le_bytes()).collect::<Vec<u8>>());
    let matrix = npy("<f8", "False", "(3, 3)", &doubles([0.0; 9]));
    for is_deflated in [false, true] {
        for entries in [
            vec![("arr_0.npy", &places[..])],
            vec![("anything.npy", &places[..])],
            vec![("x.npy", &x[..]), ("y.npy", &y[..])],
            vec![("lying.npy", &places[..]), ("readme.txt", b"hello")],
        ] {
            is_the_grid(&opened(&zip(&entries, is_deflated)));
        }
        for entries in [
            vec![
                ("species.npy", &classes[..]),
                ("x.npy", &x[..]),
                ("y.npy", &y[..]),
                ("dbh.npy", &dbh[..]),
                ("camera.npy", &matrix[..]),
            ],
            vec![
                ("Points.npy", &places[..]),
                ("species.npy", &classes[..]),
                ("dbh.npy", &dbh[..]),
                ("camera.npy", &matrix[..]),
            ],
        ] {
            let reading = opened(&zip(&entries, is_deflated));
            is_the_grid(&reading);
            assert_eq!(reading.pattern.class_names(), ["ash", "elm"]);
            assert_eq!(reading.pattern.attributes()[0].name, "dbh");
            noted(&reading, "camera");
        }
    }
    refused(&zip(&[("a.npy", &places), ("b.npy", &places)], true), &["2 arrays", "a, b", "points"]);
    refused(&zip(&[("x.npy", &x), ("y.npy", &places)], true), &["'x' and 'y'"]);
    refused(&zip(&[("pts.npy", &x), ("w.npy", &x)], true), &["'pts' has no x and y"]);
    refused(&zip(&[("pts.npy", b"hello")], true), &["pts"]);
    let good = zip(&[("arr_0.npy", &places)], false);
    let mut damaged = good.clone();
    let at = good.windows(3).position(|window| window == b"}\n\0").map_or(200, |at| at + 40);
    damaged[at] ^= 1;
    refused(&damaged, &["checksum"]);
    refused(&good[..300], &["ZIP archive", "cut short"]);

    for (name, kind) in [
        ("xl/workbook.xml", "an Excel workbook (save the sheet as CSV)"),
        ("content.xml", "an OpenDocument file"),
        ("doc.kml", "a KMZ file (save it as GeoJSON)"),
        ("trees/trees.shp", "a zipped shapefile"),
        ("photo.jpg", "a ZIP archive (take the files out first)"),
    ] {
        refused(&zip(&[("[Content_Types].xml", b"<x/>"), (name, b"<x/>")], true), &[kind]);
    }
}
