//! NumPy's arrays and archives as people have them, one test a kind.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "common/zip.rs"]
mod zip;

use pointweave::formats::{FileFormat, NoteKind, ReadOptions, Reading, open, write_npy};
use pointweave::pattern::PointPattern;
use zip::{Packed, zip};

/// 40 points of a jittered grid, in eighths.
fn points() -> Vec<[f64; 2]> {
    let jitter = |i: usize| (i * 7 % 5) as f64 / 8.0;
    (0..40).map(|i| [(i % 8) as f64 * 2.0 + jitter(i), (i / 8) as f64 * 2.0 + jitter(3 * i + 1)]).collect()
}

fn bytes_of(values: impl IntoIterator<Item = f64>) -> Vec<u8> {
    values.into_iter().flat_map(f64::to_le_bytes).collect()
}

/// A file with this header.
fn array(descr: &str, fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let fortran = if fortran { "True" } else { "False" };
    let header = format!("{{'descr': {descr}, 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
    [b"\x93NUMPY\x01\x00", &(header.len() as u16).to_le_bytes()[..], header.as_bytes(), data].concat()
}

fn doubles(shape: &str, values: impl IntoIterator<Item = f64>) -> Vec<u8> {
    array("'<f8'", false, shape, &bytes_of(values))
}

fn flat() -> Vec<f64> {
    points().into_iter().flatten().collect()
}

fn column(axis: usize) -> Vec<f64> {
    points().into_iter().map(|point| point[axis]).collect()
}

fn opened(bytes: &[u8]) -> Reading {
    open(bytes, None, &ReadOptions::default()).unwrap()
}

fn words(bytes: &[u8]) -> String {
    open(bytes, None, &ReadOptions::default()).unwrap_err().to_string()
}

fn places(pattern: &PointPattern) -> Vec<[f64; 2]> {
    pattern.positions().iter().map(|point| [point.x, point.y]).collect()
}

fn has_note(reading: &Reading, kind: NoteKind, part: &str) {
    let found = reading.notes.iter().any(|note| note.kind == kind && note.text.contains(part));
    assert!(found, "{part:?} is not in {:?}", reading.notes);
}

#[test]
fn rows_and_columns_exchanged() {
    let turned: Vec<f64> = column(0).into_iter().chain(column(1)).collect();
    let read = opened(&doubles("(2, 40)", turned.clone()));
    assert_eq!(places(&read.pattern), points());
    has_note(&read, NoteKind::Changed, "2 rows of 40 numbers");
    // array.T of 40 × 2 is the same bytes in Fortran's order.
    let read = opened(&array("'<f8'", true, "(2, 40)", &bytes_of(flat())));
    assert_eq!(places(&read.pattern), points());
    let third = turned.into_iter().chain((0..40).map(|i| f64::from(i) / 8.0));
    let read = opened(&doubles("(3, 40)", third));
    assert_eq!((places(&read.pattern), read.pattern.attributes().len()), (points(), 1));
    has_note(&read, NoteKind::Changed, "a third value");
    // Three points with a value are three points.
    assert_eq!(opened(&doubles("(3, 3)", (0..9).map(|i| f64::from(i) / 8.0))).pattern.len(), 3);
}

#[test]
fn shapes_of_other_programs() {
    for shape in ["(40L, 2L)", "(40,2)", "[40, 2]", "(1, 40, 2)", "(40, 1, 2)", "(40, 2, 1)"] {
        assert_eq!(places(&opened(&doubles(shape, flat())).pattern), points(), "{shape}");
    }
    has_note(&opened(&doubles("(40, 1, 2)", flat())), NoteKind::Changed, "(40, 1, 2) was read as 40 rows of 2");
    for (shape, parts) in [
        ("(80,)", ["shape is (80)", "array.reshape(-1, 2)"]),
        ("(80L,)", ["shape is (80)", "array.reshape(2, -1).T"]),
        ("(1, 80)", ["80 columns", "array.reshape(-1, 2)"]),
        ("(80, 1)", ["1 columns", "array.reshape(-1, 2)"]),
        ("(2, 20, 2)", ["shape is (2, 20, 2)", "array[0]"]),
        ("()", ["shape is ()", "N rows of x, y"]),
        ("(-40, 2)", ["shape is (-40, 2)", "no sizes"]),
    ] {
        let words = words(&doubles(shape, flat()));
        assert!(parts.iter().all(|part| words.contains(part)), "{shape}: {words}");
    }
}

#[test]
fn half_precision() {
    // Eighths below 16 have at most seven binary digits.
    let half = |value: f64| {
        let bits = (value as f32).to_bits();
        if bits == 0 { 0 } else { ((bits >> 23) as u16 - 112) << 10 | (bits >> 13 & 1023) as u16 }
    };
    let little: Vec<u8> = flat().into_iter().flat_map(|value| half(value).to_le_bytes()).collect();
    let big: Vec<u8> = flat().into_iter().flat_map(|value| half(value).to_be_bytes()).collect();
    assert_eq!(places(&opened(&array("'<f2'", false, "(40, 2)", &little)).pattern), points());
    assert_eq!(places(&opened(&array("'>f2'", false, "(40, 2)", &big)).pattern), points());
    // The smallest, the largest below 1, −2, and what is no number.
    let odd: Vec<u8> =
        [0x0001_u16, 0x3bff, 0xc000, 0x8000, 0x7e00, 0x3c00].iter().flat_map(|bits| bits.to_le_bytes()).collect();
    let read = opened(&array("'<f2'", false, "(3, 2)", &odd));
    assert_eq!(places(&read.pattern), [[1.0 / 16_777_216.0, 2047.0 / 2048.0], [-2.0, 0.0]]);
    has_note(&read, NoteKind::LeftOut, "without a place");
}

#[test]
fn big_endian_in_fortran_order() {
    let values = column(0).into_iter().chain(column(1));
    let data: Vec<u8> = values.flat_map(f64::to_be_bytes).collect();
    assert_eq!(places(&opened(&array("'>f8'", true, "(40, 2)", &data)).pattern), points());
}

#[test]
fn named_fields() {
    let mut data = Vec::new();
    for (i, [x, y]) in points().into_iter().enumerate() {
        data.extend((i as i32).to_le_bytes());
        data.extend(y.to_be_bytes());
        data.extend((x as f32).to_le_bytes());
        data.extend(if i % 2 == 0 { *b"oak\0" } else { *b"fir\0" });
        data.extend([0; 8]);
    }
    let descr = "[('id', '<i4'), ('y', '>f8'), ('x', '<f4'), ('species', '|S4'), ('seen', '<M8[ns]')]";
    let read = opened(&array(descr, false, "(40,)", &data));
    assert_eq!(places(&read.pattern), points());
    assert_eq!(read.pattern.class_names(), ["oak", "fir"]);
    has_note(&read, NoteKind::LeftOut, "'seen'");

    // A field that is the place.
    let data: Vec<u8> = points().iter().flat_map(|[x, y]| [bytes_of([*x, *y]), vec![7, 0, 0, 0]].concat()).collect();
    let read = opened(&array("[('pos', '<f8', (2,)), ('n', '<i4')]", false, "(40,)", &data));
    assert_eq!((places(&read.pattern), read.pattern.attributes()[0].name.as_str()), (points(), "n"));
    for (descr, part) in [
        ("[('x', '<f8'), ('y', '|O')]", "'y' is of a type that can't be read"),
        ("[('x', '<f8'), ('y', '<f8', (99999999999, 99999999999))]", "too large"),
        ("[('x', '<f8'), ('y', '<M8[s]')]", "less than two"),
        ("[('x', '<f8'), 5]", "named fields can't be understood"),
        ("[('x', '<f8'), ('y', '<f8')", "no list of 'descr'"),
    ] {
        let words = words(&array(descr, false, "(40,)", &bytes_of(flat())));
        assert!(words.contains(part), "{descr}: {words}");
    }
}

#[test]
fn complex_numbers() {
    for shape in ["(40,)", "(40, 1)", "(1, 40)"] {
        let read = opened(&array("'<c16'", false, shape, &bytes_of(flat())));
        assert_eq!(places(&read.pattern), points(), "{shape}");
        has_note(&read, NoteKind::Changed, "imaginary");
    }
    let data: Vec<u8> = flat().into_iter().flat_map(|value| (value as f32).to_be_bytes()).collect();
    assert_eq!(places(&opened(&array("'>c8'", false, "(40,)", &data)).pattern), points());
}

#[test]
fn rows_that_are_no_numbers() {
    let mut values = flat();
    values[6] = f64::NAN;
    let read = opened(&doubles("(40, 2)", values));
    assert_eq!(read.pattern.len(), 39);
    has_note(&read, NoteKind::LeftOut, "One row without a place");
}

#[test]
fn archives_of_one_array() {
    let points_array = doubles("(40, 2)", flat());
    for packed in [Packed::Stored, Packed::Deflated] {
        let read = opened(&zip(&[("anything.npy", &points_array)], packed));
        assert_eq!((read.format, places(&read.pattern)), (FileFormat::Npy, points()));
        assert!(read.notes.is_empty(), "{:?}", read.notes);
    }
}

#[test]
fn archives_of_columns() {
    let list = |values: &[f64]| doubles(&format!("({},)", values.len()), values.iter().copied());
    let (x, y) = (list(&column(0)), list(&column(1)));
    let names: Vec<u8> = (0..40)
        .flat_map(|i| if i < 20 { ['o', 'a', 'k'] } else { ['f', 'i', 'r'] })
        .flat_map(|letter| u32::from(letter).to_le_bytes())
        .collect();
    let class = array("'<U3'", false, "(40,)", &names);
    let radius = list(&[0.25; 40]);
    let other = list(&[1.0; 7]);
    let files: [(&str, &[u8]); 5] =
        [("class.npy", &class), ("y.npy", &y), ("x.npy", &x), ("radius.npy", &radius), ("edges.npy", &other)];
    let read = opened(&zip(&files, Packed::Deflated));
    assert_eq!(places(&read.pattern), points());
    assert_eq!(read.pattern.class_names(), ["oak", "fir"]);
    assert_eq!(read.pattern.attributes()[0].name, "radius");
    has_note(&read, NoteKind::LeftOut, "One array of the archive was left out: 'edges'");

    let read = opened(&zip(&[("arr_0.npy", &x), ("arr_1.npy", &y)], Packed::Stored));
    assert_eq!(places(&read.pattern), points());
    has_note(&read, NoteKind::Changed, "the second as y");
}

#[test]
fn archives_of_points_among_others() {
    let (cells, image) = (doubles("(40, 2)", flat()), doubles("(3, 3)", [0.0; 9]));
    for name in ["points", "pts", "XY", "coords", "coordinates", "positions", "arr_0", "data"] {
        let file = format!("{name}.npy");
        let read = opened(&zip(&[("image.npy", &image), (&file, &cells), ("readme.txt", b"hello")], Packed::Stored));
        assert_eq!(places(&read.pattern), points(), "{name}");
        has_note(&read, NoteKind::LeftOut, "'image'");
        has_note(&read, NoteKind::LeftOut, "no array");
    }
    let labels = array("'<i8'", false, "(40,)", &(0..40_i64).flat_map(|i| (i % 2).to_le_bytes()).collect::<Vec<_>>());
    let read = opened(&zip(&[("points.npy", &cells), ("label.npy", &labels)], Packed::Stored));
    assert_eq!((places(&read.pattern), read.pattern.class_names().len()), (points(), 2));
    let words = words(&zip(&[("image.npy", &image), ("mask.npy", &cells)], Packed::Stored));
    assert!(words.contains("'image' (3, 3), 'mask' (40, 2)"), "{words}");
}

#[test]
fn archives_that_are_something_else() {
    for (names, part) in [
        (&["[Content_Types].xml", "xl/workbook.xml"][..], "an Excel workbook (save the sheet as CSV)"),
        (&["word/document.xml"], "word processor"),
        (&["doc.kml"], "a KMZ archive"),
        (&["a/b.shp", "a/b.dbf"], "a shapefile"),
        (&["archive/data.pkl"], "PyTorch"),
        (&["points.csv"], "unpack it"),
        (&[], "an empty ZIP archive"),
    ] {
        let files: Vec<(&str, &[u8])> = names.iter().map(|name| (*name, &b"x"[..])).collect();
        let words = words(&zip(&files, Packed::Deflated));
        assert!(words.contains(part), "{names:?}: {words}");
    }
    let sheet = zip(&[("mimetype", b"application/vnd.oasis.opendocument.spreadsheet")], Packed::Stored);
    assert!(words(&sheet).contains("save the sheet as CSV"));
}

/// Offsets and sizes that lie, of every record.
#[test]
fn archives_that_lie() {
    let good = zip(&[("points.npy", &doubles("(40, 2)", flat()))], Packed::Stored);
    let directory = good.len() - 22 - 46 - "points.npy".len();
    let with = |at: usize, bytes: &[u8]| {
        let mut bad = good.clone();
        bad[at..at + bytes.len()].copy_from_slice(bytes);
        words(&bad)
    };
    let end = good.len() - 22;
    for (at, bytes, part) in [
        (end + 10, &[0xff, 0xff][..], "ZIP64"),
        (end + 16, &[0xff; 4], "ZIP64"),
        (end + 16, &[0xff, 0xff, 0xff, 0x7f], "damaged"),
        (end + 12, &[0xff, 0xff, 0xff, 0x7f], "damaged"),
        (end + 10, &[2, 0], "damaged"),
        (end, b"QK", "damaged"),
        (directory, b"QK", "damaged"),
        (directory + 8, &[1], "password"),
        (directory + 10, &[12], "method 12"),
        (directory + 16, &[1], "'points' is damaged"),
        (directory + 20, &[0xff, 0xff, 0xff, 0x7f], "damaged"),
        (directory + 24, &[0xff, 0xff, 0xff, 0x7f], "at most 20000000"),
        (directory + 24, &[0xff; 4], "ZIP64"),
        (directory + 42, &[9], "damaged"),
        (directory + 42, &[0xff, 0xff, 0xff, 0x7f], "damaged"),
        (0, b"PK\x03\x04\xff", ""),
        (26, &[0xff, 0xff], "damaged"),
    ] {
        if part.is_empty() {
            let mut same = good.clone();
            same[at..at + bytes.len()].copy_from_slice(bytes);
            assert_eq!(places(&opened(&same).pattern), points(), "the entry's own head does not count");
            continue;
        }
        let words = with(at, bytes);
        assert!(words.contains(part), "{at} {bytes:?}: {words}");
    }
    for length in 4..good.len() {
        assert!(open(&good[..length], None, &ReadOptions::default()).is_err(), "{length} bytes");
    }
}

#[test]
fn what_is_written_is_read() {
    let pattern = opened(&doubles("(40, 2)", flat())).pattern;
    let bytes = write_npy(&pattern);
    assert_eq!(opened(&bytes).pattern, pattern);
    assert_eq!(opened(&zip(&[("arr_0.npy", &bytes)], Packed::Deflated)).pattern, pattern);
}
