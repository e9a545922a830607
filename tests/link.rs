//! Share links: old ones decode for ever, new ones are short, hostile ones are harmless.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;

use glam::DVec2;
use pointweave::formats::link::{Link, LinkError, LinkExemplar, MAX_LENGTH, read_link, write_link};
use pointweave::method::{Parameters, Preset};
use pointweave::sampling::{Purpose, Rng, poisson_disk, white_noise};
use pointweave::{Attribute, Boundary, Domain, PointPattern, gallery};
use serde_json::{Map, Value, json};

fn link(exemplar: PointPattern, overrides: Value) -> Link {
    let Value::Object(overrides) = overrides else { panic!("overrides are an object") };
    Link { exemplar: LinkExemplar::Points(exemplar), preset: Preset::Fast, overrides, notes: Vec::new() }
}

fn points(exemplar: PointPattern) -> Link {
    link(exemplar, json!({}))
}

fn white(seed: u64, count: usize) -> PointPattern {
    let mut rng = Rng::new(seed, Purpose::Gallery);
    PointPattern::new(Domain::UNIT, white_noise(&mut rng, DVec2::ONE, count)).unwrap()
}

/// Classes and attributes of all kinds.
fn rich(seed: u64, count: usize) -> PointPattern {
    let mut rng = Rng::new(seed, Purpose::Gallery);
    let domain = Domain::new(DVec2::new(-100.0, 20.0), DVec2::new(400.0, 50.0)).unwrap();
    let positions = white_noise(&mut rng, domain.size(), count).into_iter().map(|p| p + domain.min()).collect();
    let classes = (0..count).map(|_| rng.index(3) as u16).collect();
    let names = ["oak", "silver birch 🌳", "never", "elm & ash"].map(str::to_owned).to_vec();
    let mut number = |low: f64, high: f64| (0..count).map(|_| rng.range(low, high)).collect::<Vec<f64>>();
    let radius = number(0.5, 2.0);
    let huge = number(-1.0, 1.0).into_iter().map(|share| 1e308 * share).collect();
    let sizes = (0..count).map(|i| [0.1, -7.0, 1e-300][i % 3]).collect();
    PointPattern::new(domain, positions)
        .unwrap()
        .with_boundary(Boundary::Periodic)
        .with_classes(classes, names)
        .unwrap()
        .with_attribute(Attribute { name: "radius".to_owned(), values: radius })
        .unwrap()
        .with_attribute(Attribute { name: "sizes".to_owned(), values: sizes })
        .unwrap()
        .with_attribute(Attribute { name: "huge".to_owned(), values: huge })
        .unwrap()
}

fn pattern(link: &Link) -> PointPattern {
    link.exemplar.pattern().unwrap()
}

#[test]
fn points_come_back_to_within_half_a_step_with_their_classes_and_attributes() {
    for (seed, count) in [(1, 1), (2, 2), (3, 300), (4, 2000)] {
        let sent = rich(seed, count);
        let (fragment, exemplar) = write_link(&points(sent.clone())).unwrap();
        let received = read_link(&fragment).unwrap();
        assert_eq!(received.exemplar, exemplar, "the writer tells what will be read");
        let received = pattern(&received);
        assert_eq!((received.boundary(), received.class_names()), (sent.boundary(), sent.class_names()));
        assert!((received.domain().size() - sent.domain().size()).abs().max_element() < 1e-9);
        let step = sent.domain().size() / 65_535.0;
        let mut left: Vec<usize> = (0..count).collect();
        for (i, at) in received.positions().iter().enumerate() {
            let near = |&(_, &j): &(usize, &usize)| {
                let offset = (sent.positions()[j] - *at).abs();
                offset.cmple(0.5001 * step).all() && sent.classes()[j] == received.classes()[i]
            };
            let (place, &source) = left.iter().enumerate().find(near).expect("a point near it");
            left.swap_remove(place);
            for (was, is) in sent.attributes().iter().zip(received.attributes()) {
                assert_eq!(was.name, is.name);
                let (was, is) = (was.values[source], is.values[i]);
                // Two points in one step may be taken for each other, but not here.
                let range = if was.abs() > 1e300 || is.abs() > 1e300 { 1e308 } else { 1.5 };
                assert!((was / 2.0 - is / 2.0).abs() <= 0.5001 * range / 4095.0, "{was} {is}");
            }
        }
        // What has been through a link goes through the next one unchanged, and makes the same link.
        let again = write_link(&points(received.clone())).unwrap();
        assert_eq!((again.0, again.1), (fragment, LinkExemplar::Points(received)));
    }
}

#[test]
fn a_list_of_values_is_exact() {
    let values = (0..40).map(|i| [0.1, 1.0 / 3.0, -0.0, 5e-324][i % 4]).collect::<Vec<f64>>();
    let sent = white(1, 40).with_attribute(Attribute { name: "w".to_owned(), values }).unwrap();
    let received = pattern(&read_link(&write_link(&points(sent)).unwrap().0).unwrap());
    let mut bits: Vec<u64> = received.attributes()[0].values.iter().map(|value| value.to_bits()).collect();
    bits.sort_unstable();
    bits.dedup();
    assert_eq!(bits.len(), 4);
    assert!(bits.contains(&(-0.0_f64).to_bits()) && bits.contains(&0.1_f64.to_bits()));
}

/// The promise is 2000 characters for 300 points, whatever they are.
#[test]
fn three_hundred_points_fit_into_two_thousand_characters() {
    let length = |name: &str, pattern: PointPattern| {
        let overrides = json!({ "expansion-x": 3.0, "expansion-y": 3.0, "seed": 123_456_789, "channels": 48 });
        let fragment = write_link(&link(pattern, overrides)).unwrap().0;
        println!("{name}: {} characters", fragment.len());
        assert!(fragment.len() <= 2000, "{name}: {} characters", fragment.len());
        fragment.len()
    };
    for seed in 0..20 {
        length("white noise", white(seed, 300));
    }
    let mut rng = Rng::new(1, Purpose::Gallery);
    let blue = poisson_disk(&mut rng, DVec2::ONE, 300, Boundary::Periodic);
    length("blue noise", PointPattern::new(Domain::UNIT, blue).unwrap());
    let lattice = (0..300).map(|i| DVec2::new((i % 20) as f64 / 20.0, (i / 20) as f64 / 15.0)).collect();
    let short = length("lattice", PointPattern::new(Domain::UNIT, lattice).unwrap());
    assert!(short < 600, "a lattice repeats itself: {short}");
    for entry in gallery::entries() {
        let exemplar = entry.exemplar();
        if exemplar.len() <= 300 {
            length(entry.name, exemplar);
        }
    }
    // Two classes and an attribute as well.
    let classes = (0..300).map(|i| (i * 7 % 5 / 3) as u16).collect();
    let values = white(9, 300).positions().iter().map(|p| p.x).collect();
    let trees = white(8, 300)
        .with_classes(classes, vec!["house".to_owned(), "tree".to_owned()])
        .unwrap()
        .with_attribute(Attribute { name: "radius".to_owned(), values })
        .unwrap();
    let fragment = write_link(&points(trees)).unwrap().0;
    assert!(fragment.len() <= 2200, "two classes with radii: {} characters", fragment.len());
}

#[test]
fn parameters_are_told_by_their_difference_from_the_preset() {
    let exemplar = LinkExemplar::named("rings").unwrap();
    let suited = Parameters::suited_to(Preset::Balanced, &exemplar.pattern().unwrap());
    let Ok(Value::Object(mut all)) = serde_json::to_value(&suited) else { panic!("parameters are an object") };
    let mut link = Link { exemplar, preset: Preset::Balanced, overrides: all.clone(), notes: Vec::new() };
    assert_eq!(write_link(&link).unwrap().0, "v=1&preset=balanced&exemplar=rings");
    all.insert("seed".to_owned(), json!(9_007_199_254_740_991_u64));
    all.insert("jitter-px".to_owned(), json!(0.1));
    all.insert("boundary".to_owned(), json!("open"));
    link.overrides = all;
    let fragment = write_link(&link).unwrap().0;
    assert_eq!(fragment, "v=1&preset=balanced&seed=9007199254740991&jitter-px=0.1&boundary=open&exemplar=rings");
    let read = read_link(&format!("#{fragment}")).unwrap();
    assert_eq!(read.parameters().unwrap(), link.parameters().unwrap());
    assert_eq!((read.parameters().unwrap().seed, read.notes), (9_007_199_254_740_991, Vec::<String>::new()));
}

#[test]
fn values_are_moved_into_their_ranges() {
    let fragment = "v=1&preset=fast&channels=1e9&expansion-x=-5&seed=-1&scales=2.6&frequency=NaN&jitter-px=inf&start=grid\
                    &boundary=leaky&gram-weight=&unknown=7&embed=1&exemplar=rings&channels=1000000";
    let link = read_link(fragment).unwrap();
    let wanted = json!({ "channels": 160, "expansion-x": 0.25, "seed": 0, "scales": 3, "jitter-px": 2.0 });
    assert_eq!(Value::Object(link.overrides.clone()), wanted);
    assert_eq!(link.notes.len(), 9, "one sentence each: {:?}", link.notes);
    link.parameters().unwrap().validate().unwrap();

    for range in Parameters::RANGES {
        for value in ["-1e308", "1e308", "0.5", "-inf", "99999999999999999999"] {
            let link = read_link(&format!("v=1&{}={value}", range.name)).unwrap();
            link.parameters().unwrap().validate().unwrap();
            let mut overrides: Map<String, Value> = link.overrides.clone();
            let exemplar = pattern(&link);
            // What the page hands to the engine is all it needs.
            overrides.retain(|_, value| !value.is_null());
            Parameters::with_overrides(link.preset, &exemplar, overrides).unwrap().validate().unwrap();
        }
    }
    let tight = read_link("v=1&grid-min=256").unwrap();
    assert_eq!(tight.overrides["grid-max"], json!(256), "what depends on another follows it");
}

#[test]
fn defaults_and_refusals() {
    let rings = gallery::find("rings").unwrap().exemplar();
    assert_eq!(pattern(&read_link("v=1").unwrap()), rings);
    assert_eq!(read_link("v=1").unwrap().preset, Preset::Fast);
    for (fragment, part) in [
        ("", "version \"\""),
        ("v=2", "version \"2\""),
        ("exemplar=rings", "version"),
        ("v=1&exemplar=nope", "\"nope\""),
        ("v=1&preset=good", "\"good\""),
        ("v=1&points=", "inflated"),
        ("v=1&points=Zm9v!", "base64url"),
        ("v=1&points=Zm9v", "inflated"),
        ("v=1&points=AwA", "end too soon"),
        ("v=1&domain=0,0,1&points=AwA", "x0,y0,x1,y1"),
        ("v=1&domain=0,0,0,1&points=AwA", "both sides"),
        ("v=1&domain=0,0,NaN,1&points=AwA", "finite"),
    ] {
        let message = read_link(fragment).expect_err(fragment).to_string();
        assert!(message.contains(part), "{fragment}\n  says    {message:?}\n  without {part:?}");
    }
    let long = format!("v=1&points={}", "A".repeat(MAX_LENGTH));
    assert!(matches!(read_link(&long), Err(LinkError::TooLong { .. })));
    assert!(matches!(write_link(&points(white(1, 20_000))), Err(LinkError::TooLong { length, .. }) if length > 40_000));
    // A domain that a mail program has escaped.
    let fragment = write_link(&points(rich(1, 10))).unwrap().0;
    assert_eq!(read_link(&fragment.replace(',', "%2C")), read_link(&fragment));
}

/// base64url of the bytes as deflate holds them when nothing is compressed.
fn stored(bytes: &[u8]) -> String {
    let mut deflated = Vec::new();
    let pieces: Vec<&[u8]> = bytes.chunks(60_000).collect();
    for (i, piece) in pieces.iter().enumerate() {
        deflated.push(u8::from(i + 1 == pieces.len()));
        deflated.extend_from_slice(&(piece.len() as u16).to_le_bytes());
        deflated.extend_from_slice(&(!(piece.len() as u16)).to_le_bytes());
        deflated.extend_from_slice(piece);
    }
    const LETTERS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
    let bits = deflated.iter().flat_map(|byte| (0..8).rev().map(move |bit| byte >> bit & 1)).collect::<Vec<u8>>();
    bits.chunks(6)
        .map(|six| {
            let value = six.iter().fold(0, |value, bit| value << 1 | bit) << (6 - six.len());
            char::from(LETTERS[usize::from(value)])
        })
        .collect()
}

#[test]
fn hostile_points_are_refused() {
    let read = |bytes: &[u8]| read_link(&format!("v=1&points={}", stored(bytes)));
    // The layout by hand: one point at (1, 0.5…), the default class, nothing more.
    let good = read(&[1, 1, 0, 0, 0xff, 0xff, 0x80, 0x00]).unwrap();
    assert_eq!(pattern(&good).positions(), [DVec2::new(1.0, 32_768.0 / 65_535.0)]);
    for (bytes, part) in [
        (&[2, 1, 0, 0, 0, 0, 0, 0][..], "layout"),
        (&[1, 0, 0, 0], "no points"),
        (&[1, 0xff, 0xff, 0x7f, 0, 0], "too many"),
        (&[1, 0xff, 0xff, 0xff, 0xff, 0xff], "too many"),
        (&[1, 1, 17], "too many classes"),
        (&[1, 1, 1, 1, b'a', 2, 0, 0, 0, 0, 0], "more points than there are"),
        (&[1, 1, 2, 1, b'a', 1, 1, b'b', 1, 0, 0, 0, 0, 0], "not have as many points"),
        (&[1, 1, 1, 2, 0xff, 0xff, 1, 0, 0, 0, 0, 0], "not text"),
        (&[1, 1, 1, 0xff, 0x7f], "name is too long"),
        (&[1, 1, 1, 0, 1, 0, 0, 0, 0, 0], "it is empty"),
        (&[1, 1, 0, 9], "too many attributes"),
        (&[1, 1, 0, 1, 1, b'w', 2], "not known"),
        (&[1, 1, 0, 1, 1, b'w', 0, 17], "too many values"),
        (&[1, 1, 0, 1, 1, b'w', 0, 0, 0, 0, 0, 0, 0], "not in its list"),
        (&[1, 1, 0, 1, 1, b'w', 1, 0, 0, 0, 0, 0, 0, 0xf0, 0x7f], "end too soon"),
        (&[1, 2, 0, 0, 0xff, 0xff, 0xff, 0xff, 0, 0, 0, 0], "outside the domain"),
        (&[1, 1, 0, 0, 0, 0, 0], "end too soon"),
    ] {
        let message = read(bytes).expect_err(&format!("{bytes:?}")).to_string();
        assert!(message.contains(part), "{bytes:?}\n  says    {message:?}\n  without {part:?}");
    }
    let mut infinite = vec![1, 1, 0, 1, 1, b'w', 1];
    infinite.extend_from_slice(&f64::INFINITY.to_le_bytes());
    infinite.extend_from_slice(&1.0_f64.to_le_bytes());
    infinite.extend_from_slice(&[0, 0, 0, 0, 0, 0]);
    assert!(read(&infinite).unwrap_err().to_string().contains("finite"));
}

#[test]
fn what_inflates_without_end_is_stopped() {
    // 24 kB of deflate that would give 24 MB of zeros.
    let zeros = miniz_oxide::deflate::compress_to_vec(&vec![0; 20_000_000], 9);
    assert!(zeros.len() < 24_000, "{}", zeros.len());
    const LETTERS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
    let text: String = zeros
        .chunks(3)
        .flat_map(|three| {
            let bits = three.iter().enumerate().fold(0_u32, |bits, (i, &b)| bits | u32::from(b) << (16 - 8 * i));
            (0..=three.len()).map(move |i| char::from(LETTERS[(bits >> (18 - 6 * i)) as usize & 63]))
        })
        .collect();
    let message = read_link(&format!("v=1&points={text}")).unwrap_err().to_string();
    assert!(message.contains("inflated"), "{message}");
}

const GOLDEN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/link/golden.json");

/// Links that were made once. Whatever changes, these must be read as the very same exemplars and parameters: to change
/// what is expected here is to break links people have sent each other.
#[test]
fn golden_links_decode_for_ever() {
    let golden: Vec<Value> = serde_json::from_str(&fs::read_to_string(GOLDEN).unwrap()).unwrap();
    assert!(golden.len() >= 6);
    for case in golden {
        let name = case["name"].as_str().unwrap();
        let link = read_link(case["fragment"].as_str().unwrap()).unwrap();
        assert_eq!(link.preset.name(), case["preset"], "{name}");
        assert_eq!(Value::Object(link.overrides.clone()), case["overrides"], "{name}");
        let gallery = match link.exemplar {
            LinkExemplar::Gallery(name) => json!(name),
            LinkExemplar::Points(_) => Value::Null,
        };
        assert_eq!(gallery, case["gallery"], "{name}");
        let expected: PointPattern = serde_json::from_value(case["exemplar"].clone()).unwrap();
        assert_eq!(pattern(&link), expected, "{name}");
    }
}

/// Writes the golden links of this version, for whoever adds one: `cargo test --test link -- --ignored --nocapture`.
#[test]
#[ignore = "prints golden links instead of testing them"]
fn print_golden_links() {
    let lattice = (0..12).map(|i| DVec2::new((i % 4) as f64 / 4.0, (i / 4) as f64 / 3.0)).collect();
    let lattice = PointPattern::new(Domain::UNIT, lattice).unwrap().with_boundary(Boundary::Periodic);
    let gallery = |preset, overrides: Value| {
        let Value::Object(overrides) = overrides else { panic!("overrides are an object") };
        Link { exemplar: LinkExemplar::named("chevrons").unwrap(), preset, overrides, notes: Vec::new() }
    };
    let cases = [
        ("a gallery exemplar", gallery(Preset::Fast, json!({}))),
        (
            "a gallery exemplar with parameters",
            gallery(
                Preset::Balanced,
                json!({ "seed": 7, "expansion-x": 3.0, "expansion-y": 1.5, "boundary": "open", "start": "white-noise", "channels": 32 }),
            ),
        ),
        ("the paper's preset", gallery(Preset::Paper, json!({ "correlation-weight": 0.5 }))),
        ("one point", points(PointPattern::new(Domain::UNIT, vec![DVec2::new(0.25, 1.0)]).unwrap())),
        ("random points", link(white(1, 30), json!({ "seed": 3 }))),
        ("a lattice", points(lattice)),
        ("classes and attributes", points(rich(5, 25))),
    ];
    let list: Vec<Value> = cases
        .into_iter()
        .map(|(name, link)| {
            let (fragment, exemplar) = write_link(&link).unwrap();
            let read = read_link(&fragment).unwrap();
            let gallery = match &exemplar {
                LinkExemplar::Gallery(name) => json!(name),
                LinkExemplar::Points(_) => Value::Null,
            };
            json!({
                "name": name, "fragment": fragment, "preset": read.preset.name(), "overrides": read.overrides,
                "gallery": gallery, "exemplar": exemplar.pattern().unwrap(),
            })
        })
        .collect();
    println!("{}", serde_json::to_string_pretty(&list).unwrap());
}
