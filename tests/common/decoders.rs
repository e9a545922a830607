//! One function a decoder, for fuzzers: takes any bytes, and fails on a panic or when what was read does not come back
//! from what is written of it.
#![allow(dead_code, unreachable_pub, reason = "each fuzzer includes this file and uses its own part")]
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a fuzzer looks for panics")]

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
        let geojson = write_geojson(&reading.pattern, &reading.origin);
        let again = open(geojson.as_bytes(), None, &ReadOptions::default()).expect("our own GeoJSON");
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

/// NumPy arrays, archives, and arrays that are put into one: Z, how it is packed, then the arrays.
pub fn npy(bytes: &[u8]) {
    const MAGIC: &[u8] = b"\x93NUMPY";
    // Most of what a fuzzer tries should get beyond the first bytes.
    let bytes = match bytes {
        [b'Z', packing, rest @ ..] => {
            let starts = rest.windows(MAGIC.len()).enumerate().filter(|(_, window)| *window == MAGIC).map(|(at, _)| at);
            let starts: Vec<usize> = starts.take(6).chain([rest.len()]).collect();
            let names = [
                ["x.npy", "y.npy", "class.npy", "w.npy", "v.npy", "u.npy"],
                ["points.npy", "a", "b.npy", "c.npy", "d", "e"],
            ];
            let arrays = starts.windows(2).map(|pair| &rest[pair[0]..pair[1]]);
            let entries: Vec<_> = names[usize::from(packing / 2 % 2)].into_iter().zip(arrays).collect();
            zip(&entries, packing % 2 == 1)
        }
        _ if bytes.starts_with(MAGIC) || bytes.starts_with(b"PK") => bytes.to_vec(),
        _ => [MAGIC, bytes].concat(),
    };
    if let Some(reading) = look(&bytes, "a.npy") {
        let again = open(&write_npy(&reading.pattern), None, &ReadOptions::default()).expect("our own array");
        assert_eq!(again.pattern.positions(), reading.pattern.positions());
    }
}

/// A ZIP archive of these files, deflated or stored.
pub fn zip(entries: &[(&str, &[u8])], is_deflated: bool) -> Vec<u8> {
    let crc = |bytes: &[u8]| {
        !bytes.iter().fold(u32::MAX, |crc, &byte| {
            (0..8).fold(crc ^ u32::from(byte), |crc, _| crc >> 1 ^ if crc & 1 == 1 { 0xedb8_8320 } else { 0 })
        })
    };
    let (mut bytes, mut directory) = (Vec::new(), Vec::new());
    for (name, data) in entries {
        let packed = if is_deflated { miniz_oxide::deflate::compress_to_vec(data, 6) } else { data.to_vec() };
        let offset = bytes.len() as u32;
        let mut common = vec![20, 0, 0, 0, if is_deflated { 8 } else { 0 }, 0, 0, 0, 0, 0];
        common.extend(crc(data).to_le_bytes());
        common.extend((packed.len() as u32).to_le_bytes());
        common.extend((data.len() as u32).to_le_bytes());
        common.extend((name.len() as u16).to_le_bytes());
        common.extend([0, 0]);
        bytes.extend(b"PK\x03\x04");
        bytes.extend(&common);
        bytes.extend(name.as_bytes());
        bytes.extend(&packed);
        directory.extend(b"PK\x01\x02\x14\x00");
        directory.extend(&common);
        directory.extend([0; 10]);
        directory.extend(offset.to_le_bytes());
        directory.extend(name.as_bytes());
    }
    let (start, count) = (bytes.len() as u32, entries.len() as u16);
    bytes.extend(&directory);
    bytes.extend(b"PK\x05\x06\x00\x00\x00\x00");
    bytes.extend([count.to_le_bytes(), count.to_le_bytes()].concat());
    bytes.extend((directory.len() as u32).to_le_bytes());
    bytes.extend(start.to_le_bytes());
    bytes.extend([0, 0]);
    bytes
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
    let rgba: Vec<u8> = pixels[..width * height].iter().flat_map(|&gray| [gray, gray, gray, 255 - gray / 16]).collect();
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
