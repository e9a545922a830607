//! One function a decoder, for fuzzers: takes any bytes, and fails on a panic or when what was read does not come back
//! from what is written of it.
#![allow(dead_code, unreachable_pub, reason = "each fuzzer includes this file and uses its own part")]
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a fuzzer looks for panics")]

#[path = "zip.rs"]
pub mod zip;

use pointweave::PatternError;
use pointweave::formats::link::{Link, LinkExemplar, Written, read_link, write_link};
use pointweave::formats::{
    BlobOptions, FormatError, Ink, Picture, Preview, ReadOptions, Reading, SvgStyle, find_blobs, open, write_csv,
    write_csv_like, write_geojson, write_json, write_npy, write_svg,
};

/// Reads, and looks at everything there is to see of the result.
fn look(bytes: &[u8], name: &str) -> Option<Reading> {
    match open(bytes, Some(name), &ReadOptions::default()) {
        Ok(reading) => {
            let preview = Preview::of(&reading);
            assert_eq!(preview.points, reading.pattern.len());
            Some(reading)
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            assert!(!matches!(error, FormatError::Pattern(_)), "a refusal without a place: {error}");
            if let Some((line, column)) = error.position() {
                assert!(line > 0 && column != Some(0), "{error}");
            }
            None
        }
    }
}

/// CSV, TSV, text in columns and the reference implementation's; whatever begins like something else is that.
pub fn text(bytes: &[u8]) {
    if let Some(reading) = look(bytes, "a.csv") {
        let again = open(write_csv(&reading.pattern).as_bytes(), None, &ReadOptions::default()).expect("our own CSV");
        assert_eq!(again.pattern, reading.pattern);
        // In the words of the file the classes may be named by a column that only a person can tell.
        let like = write_csv_like(&reading.pattern, &reading.origin);
        let again = open(like.as_bytes(), None, &ReadOptions::default()).expect("CSV like the file");
        assert_eq!(again.pattern.len(), reading.pattern.len());
        if reading.origin.projection.is_none() {
            assert_eq!(again.pattern.positions(), reading.pattern.positions());
        }
    }
}

/// Patterns, lists of points, projects and GeoJSON.
pub fn json(bytes: &[u8]) {
    if let Some(reading) = look(bytes, "a.json") {
        let again = open(write_json(&reading.pattern).as_bytes(), None, &ReadOptions::default()).expect("our own JSON");
        assert_eq!(again.pattern, reading.pattern);
        let written = write_geojson(&reading.pattern, &reading.origin);
        let again = open(written.as_bytes(), None, &ReadOptions::default()).expect("our own GeoJSON");
        assert_eq!(again.pattern.classes(), reading.pattern.classes());
        assert_eq!(again.pattern.attributes(), reading.pattern.attributes());
        if reading.origin.projection.is_none() {
            assert_eq!(again.pattern, reading.pattern);
        }
    }
}

/// SVG. What is written of a drawing shows the same points, but for rounding.
pub fn svg(bytes: &[u8]) {
    if let Some(reading) = look(bytes, "a.svg") {
        let svg = write_svg(&reading.pattern, &SvgStyle::default());
        let again = open(svg.as_bytes(), None, &ReadOptions::default()).expect("our own SVG");
        assert_eq!(again.pattern.domain(), reading.pattern.domain());
    }
}

/// NumPy arrays, and archives of them: as they are when they begin with `PK`, and made of arrays when with `Z`.
pub fn npy(bytes: &[u8]) {
    // Most of what a fuzzer tries should get beyond the first bytes.
    let bytes = match bytes {
        [0x93, b'N', b'U', b'M', b'P', b'Y', ..] | [b'P', b'K', ..] => bytes.to_vec(),
        [b'Z', rest @ ..] => archive(rest),
        _ => [b"\x93NUMPY", bytes].concat(),
    };
    if let Some(reading) = look(&bytes, "a.npy") {
        let pattern = reading.pattern;
        let again = open(&write_npy(&pattern), None, &ReadOptions::default()).expect("our own array");
        assert_eq!(again.pattern.positions(), pattern.positions());
    }
}

/// An archive whose sums are right: its entries end with a line of `--`, and begin with their names.
fn archive(bytes: &[u8]) -> Vec<u8> {
    let text: Vec<&[u8]> = split(bytes, b"\n--\n");
    let files: Vec<(String, &[u8])> = text
        .iter()
        .map(|entry| {
            let end = entry.iter().position(|&byte| byte == b'\n').unwrap_or(entry.len());
            let name = String::from_utf8_lossy(&entry[..end.min(100)]).into_owned();
            (name, entry.get(end + 1..).unwrap_or_default())
        })
        .collect();
    let files: Vec<(&str, &[u8])> = files.iter().map(|(name, file)| (name.as_str(), *file)).collect();
    zip::zip(&files, if bytes.len().is_multiple_of(4) { zip::Packed::Deflated } else { zip::Packed::Stored })
}

fn split<'a>(mut bytes: &'a [u8], by: &[u8]) -> Vec<&'a [u8]> {
    let mut parts = Vec::new();
    while let Some(at) = bytes.windows(by.len()).position(|window| window == by) {
        parts.push(&bytes[..at]);
        bytes = &bytes[at + by.len()..];
    }
    parts.push(bytes);
    parts
}

/// PNG and whatever else is told by its first bytes.
pub fn png(bytes: &[u8]) {
    look(bytes, "a.png");
}

/// Pixels as a browser decodes them: width, threshold, kind of ink, smallest and largest area, then brightness.
pub fn pixels(bytes: &[u8]) {
    let [width, threshold, ink, min_area, max_area, pixels @ ..] = bytes else { return };
    let width = usize::from(*width).max(1);
    let height = pixels.len() / width;
    // White or gray marks on transparent ground, or a picture that is nearly opaque.
    let pixel = |gray: u8| match *ink {
        192.. => [gray | 63, 255, 255, gray],
        _ => [gray, gray, gray, 255 - gray / 16],
    };
    let rgba: Vec<u8> = pixels[..width * height].iter().flat_map(|&gray| pixel(gray)).collect();
    let options = BlobOptions {
        threshold: (threshold % 2 == 0).then_some(*threshold),
        ink: [Ink::Auto, Ink::Dark, Ink::Light][usize::from(ink % 3)],
        min_area: (min_area % 2 == 0).then(|| f64::from(*min_area)),
        max_area: (max_area % 2 == 0).then(|| f64::from(*max_area)),
    };
    let found = Picture::new(width, height, rgba).and_then(|it| find_blobs(&it, &options, &ReadOptions::default()));
    match found {
        Ok(blobs) => {
            let radii = &blobs.reading.pattern.attributes()[0].values;
            let area: f64 = radii.iter().map(|radius| radius * radius * std::f64::consts::PI).sum();
            assert!(area <= (width * height) as f64 + 0.5, "blobs of {area} pixels in {width} × {height}");
        }
        Err(FormatError::Pixels { reason }) => assert!(!reason.is_empty()),
        // Too narrow for a pattern.
        Err(FormatError::Pattern(PatternError::Domain { .. })) => assert!(64 * width.min(height) < width.max(height)),
        Err(error) => panic!("{error}"),
    }
}

/// Share links: the bytes as a fragment, and as the points of one.
pub fn link(bytes: &[u8]) {
    if let Ok(fragment) = std::str::from_utf8(bytes) {
        fragment_of(fragment);
    }
    if bytes.len() < 20_000 {
        let deflated = miniz_oxide::deflate::compress_to_vec(bytes, 0);
        fragment_of(&format!("v=1&points={}", base64url(&deflated)));
    }
}

fn fragment_of(fragment: &str) {
    let Ok(link) = read_link(fragment) else { return };
    let parameters = link.parameters().expect("parameters");
    for parameter in link.method.definition().describe().parameters {
        parameter.check(&parameters[parameter.name]).expect("parameters in their ranges");
    }
    if let LinkExemplar::Points(pattern) = &link.exemplar {
        assert!(pattern.len() <= pointweave::pattern::MAX_POINTS);
    }
    // Whatever was read makes a link that is read as the same.
    if let Ok(Written { fragment: again, exemplar, .. }) = write_link(&link) {
        let second = read_link(&again).expect("our own link");
        assert_eq!(second.exemplar, exemplar);
        assert_eq!(second.parameters(), Link { exemplar, ..link }.parameters());
    }
}

/// RFC 4648, without padding.
pub fn base64url(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
    let mut text = String::new();
    for three in bytes.chunks(3) {
        let bits = three.iter().enumerate().fold(0_u32, |bits, (i, &byte)| bits | u32::from(byte) << (16 - 8 * i));
        (0..=three.len()).for_each(|i| text.push(char::from(LETTERS[(bits >> (18 - 6 * i)) as usize & 63])));
    }
    text
}
