//! Share links: old ones decode for ever, new ones are short, hostile ones are harmless.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;

use glam::DVec2;
use pointweave::formats::link::{Link, LinkError, LinkExemplar, MAX_LENGTH, SHORT, Written, read_link, write_link};
use pointweave::methods::Method;
use pointweave::methods::network::editions::EDITION;
use pointweave::methods::network::{Parameters, Preset};
use pointweave::sampling::{Purpose, Rng, poisson_disk, white_noise};
use pointweave::{Attribute, Boundary, Domain, PointPattern, gallery};
use serde_json::{Map, Value, json};

fn link(exemplar: PointPattern, overrides: Value) -> Link {
    let Value::Object(overrides) = overrides else { panic!("overrides are an object") };
    Link {
        method: Method::Network,
        exemplar: LinkExemplar::Points(exemplar),
        preset: "fast".to_owned(),
        overrides,
        notes: Vec::new(),
    }
}

/// A link's parameters as the network takes them.
fn typed(link: &Link) -> Parameters {
    Parameters::from_fields(link.parameters().unwrap()).unwrap()
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
        let (fragment, exemplar) = write_link(&points(sent.clone())).map(|it| (it.fragment, it.exemplar)).unwrap();
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
        assert_eq!((again.fragment, again.exemplar), (fragment, LinkExemplar::Points(received)));
    }
}

#[test]
fn a_list_of_values_is_exact() {
    let values = (0..40).map(|i| [0.1, 1.0 / 3.0, -0.0, 5e-324][i % 4]).collect::<Vec<f64>>();
    let sent = white(1, 40).with_attribute(Attribute { name: "w".to_owned(), values }).unwrap();
    let received = pattern(&read_link(&write_link(&points(sent)).unwrap().fragment).unwrap());
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
        let fragment = write_link(&link(pattern, overrides)).unwrap().fragment;
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
}

/// 300 random points with two classes, radii and angles: each with those before it.
fn trees(seed: u64, what: usize) -> PointPattern {
    let mut rng = Rng::new(seed, Purpose::Gallery);
    let classes = (0..300).map(|_| rng.index(2) as u16).collect();
    let mut numbers = |low, high| (0..300).map(|_| rng.range(low, high)).collect::<Vec<f64>>();
    let attributes = [("radius", numbers(0.001, 0.02)), ("orientation", numbers(-180.0, 180.0))];
    let mut trees = white(seed, 300);
    if what > 0 {
        trees = trees.with_classes(classes, vec!["house".to_owned(), "tree".to_owned()]).unwrap();
    }
    for (name, values) in attributes.into_iter().take(what.saturating_sub(1)) {
        trees = trees.with_attribute(Attribute { name: name.to_owned(), values }).unwrap();
    }
    trees
}

#[test]
fn classes_radii_and_angles_of_three_hundred_points_fit_too() {
    let overrides = json!({ "expansion-x": 3.0, "expansion-y": 3.0, "seed": 123_456_789, "channels": 48 });
    println!("{:<16}{:>12}  rounded beyond 65535ths and 4095ths", "300 points", "characters");
    // What a point may move by, in mean spacings, and a value by, in ranges: half a step.
    for (what, name, places, values) in [
        (0, "places", 0.0, 0.0),
        (1, "and classes", 0.0, 0.0),
        (2, "and radii", 0.0, 1.0 / 2000.0),
        (3, "and angles", 1.0 / 400.0, 1.0 / 500.0),
    ] {
        for seed in 0..8 {
            let sent = trees(seed, what);
            let spacing = sent.mean_spacing().unwrap();
            let written = write_link(&link(sent.clone(), overrides.clone())).unwrap();
            if seed < 2 {
                println!("{name:<16}{:>12}  {}", written.fragment.len(), written.note.as_deref().unwrap_or("no"));
            }
            assert!(written.fragment.len() <= SHORT, "{name}: {} characters", written.fragment.len());
            assert_eq!(written.note.is_some(), values > 0.0, "whoever shares is told");
            let read = read_link(&written.fragment).unwrap();
            assert_eq!(read.exemplar, written.exemplar);
            // What was rounded once is not rounded again, in the same link and in one that need not be short.
            let again = write_link(&read).unwrap();
            assert_eq!((&again.fragment, &again.note), (&written.fragment, &None));
            let other = write_link(&Link { overrides: Map::new(), ..read.clone() }).unwrap();
            assert_eq!(other.exemplar, read.exemplar);

            let received = pattern(&read);
            let largest = |of: fn(&PointPattern, usize) -> f64, allowed: f64| {
                // Points of a class by their x: rounding seldom changes it, and then by no more than is looked for here.
                let order = |it: &PointPattern| {
                    let mut order: Vec<usize> = (0..300).collect();
                    order.sort_by(|&a, &b| {
                        let key = |i: usize| (it.classes()[i], it.positions()[i].x);
                        key(a).partial_cmp(&key(b)).unwrap()
                    });
                    order.into_iter().map(|i| of(it, i)).collect::<Vec<f64>>()
                };
                let gaps = order(&sent).into_iter().zip(order(&received)).map(|(was, is)| (was - is).abs());
                let within = gaps.filter(|&gap| gap <= allowed).count();
                assert!(within >= 290, "{name}: {within} of 300 within {allowed}");
            };
            let places = f64::max(places * spacing, 0.5001 / 65_535.0);
            largest(|it, i| it.positions()[i].x, places);
            largest(|it, i| it.positions()[i].y, places);
            if what > 1 {
                largest(|it, i| it.attributes()[0].values[i], values * 0.019);
            }
            if what > 2 {
                largest(|it, i| it.attributes()[1].values[i], values * 360.0);
            }
        }
    }
}

#[test]
fn nothing_is_rounded_for_a_link_that_stays_long_or_where_points_would_meet() {
    // 600 points with radii are far too many.
    let count = 600;
    let mut rng = Rng::new(1, Purpose::Gallery);
    let values = (0..count).map(|_| rng.range(0.1, 0.2)).collect();
    let many = white(1, count).with_attribute(Attribute { name: "radius".to_owned(), values }).unwrap();
    let written = write_link(&points(many)).unwrap();
    assert!(written.fragment.len() > SHORT && written.note.is_none());
    // A pair that only the finest steps tell apart.
    let sent = trees(1, 3);
    let mut close = sent.positions().to_vec();
    close[1] = close[0] + 1.6 / 65_535.0 * if close[0].x < 0.5 { DVec2::X } else { DVec2::NEG_X };
    let mut pair = PointPattern::new(Domain::UNIT, close).unwrap();
    for attribute in sent.attributes() {
        pair = pair.with_attribute(attribute.clone()).unwrap();
    }
    let received = pattern(&read_link(&write_link(&points(pair)).unwrap().fragment).unwrap());
    let mut places: Vec<_> = received.positions().iter().map(|at| (at.x.to_bits(), at.y.to_bits())).collect();
    places.sort_unstable();
    places.dedup();
    assert_eq!(places.len(), 300);
}

#[test]
fn parameters_are_told_by_their_difference_from_the_preset() {
    let exemplar = LinkExemplar::named("rings").unwrap();
    let suited = Parameters::suited_to(Preset::Balanced, &exemplar.pattern().unwrap());
    let Ok(Value::Object(mut all)) = serde_json::to_value(&suited) else { panic!("parameters are an object") };
    let preset = "balanced".to_owned();
    let mut link = Link { method: Method::Network, exemplar, preset, overrides: all.clone(), notes: Vec::new() };
    assert_eq!(write_link(&link).unwrap().fragment, "v=1&preset=balanced&exemplar=rings");
    all.insert("seed".to_owned(), json!(9_007_199_254_740_991_u64));
    all.insert("jitter-px".to_owned(), json!(0.1));
    all.insert("boundary".to_owned(), json!("open"));
    link.overrides = all;
    let fragment = write_link(&link).unwrap().fragment;
    assert_eq!(fragment, "v=1&preset=balanced&seed=9007199254740991&jitter-px=0.1&boundary=open&exemplar=rings");
    let read = read_link(&format!("#{fragment}")).unwrap();
    assert_eq!(read.parameters().unwrap(), link.parameters().unwrap());
    assert_eq!((typed(&read).seed, &read.notes), (9_007_199_254_740_991, &Vec::new()));
}

#[test]
fn values_are_moved_into_their_ranges() {
    let fragment = "v=1&preset=fast&exemplar=rings&channels=1e9&expansion-x=-5&seed=-1&scales=2.6&frequency=NaN&jitter-px=inf&start=grid\
                    &boundary=leaky&gram-weight=&unknown=7&embed=1&exemplar=rings&channels=1000000";
    let link = read_link(fragment).unwrap();
    let wanted = json!({ "channels": 160, "expansion-x": 0.25, "seed": 0, "scales": 3, "jitter-px": 2.0 });
    assert_eq!(Value::Object(link.overrides.clone()), wanted);
    assert_eq!(link.notes.len(), 9, "one sentence each: {:?}", link.notes);
    typed(&link).validate().unwrap();

    for parameter in Method::Network.definition().describe().parameters {
        for value in ["-1e308", "1e308", "0.5", "-inf", "99999999999999999999"] {
            let link = read_link(&format!("v=1&exemplar=rings&{}={value}", parameter.name)).unwrap();
            typed(&link).validate().unwrap();
            let mut overrides: Map<String, Value> = link.overrides.clone();
            let exemplar = pattern(&link);
            // What the page hands to the engine is all it needs.
            overrides.retain(|_, value| !value.is_null());
            Method::Network.parameters(&link.preset, &exemplar, &overrides).unwrap();
        }
    }
    let tight = read_link("v=1&grid-min=256&exemplar=rings").unwrap();
    assert_eq!(tight.overrides["grid-max"], json!(256), "what depends on another follows it");
}

#[test]
fn defaults_and_refusals() {
    let rings = gallery::find("rings").unwrap().exemplar();
    assert_eq!(pattern(&read_link("v=1&exemplar=rings").unwrap()), rings);
    assert_eq!(read_link("v=1&exemplar=rings").unwrap().preset, "fast");
    assert_eq!(
        read_link("v=1&method=weaving&exemplar=rings").unwrap().method,
        Method::Network,
        "version 1 knows no methods"
    );
    assert_eq!(read_link("v=2&method=network&exemplar=rings").unwrap(), read_link("v=1&exemplar=rings").unwrap());
    for (fragment, part) in [
        ("", "version \"\""),
        ("v=2", "the method \"\"; there is network"),
        ("v=2&method=weaving", "the method \"weaving\""),
        ("v=3", "version \"3\""),
        ("exemplar=rings", "version"),
        ("v=1&exemplar=nope", "\"nope\""),
        ("v=1", "names no exemplar and holds no points, so its end is missing"),
        ("v=1&preset=balanced&seed=7", "ask for the whole link"),
        ("v=1&exemplar=ri…", "shortened for show"),
        ("v=1&preset=good", "\"good\"; there are fast, balanced, best, paper"),
        ("v=1&points=", "inflated"),
        ("v=1&points=Zm!9v", "base64url"),
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
    let fragment = write_link(&points(rich(1, 10))).unwrap().fragment;
    assert_eq!(read_link(&fragment.replace(',', "%2C")), read_link(&fragment));
}

#[test]
fn links_that_were_sent_around() {
    let link = Link { overrides: std::iter::once(("seed".to_owned(), json!(7))).collect(), ..points(white(3, 40)) };
    let whole = write_link(&link).unwrap().fragment;
    let read = read_link(&whole).unwrap();
    assert_eq!((read.notes.len(), &read.overrides["seed"]), (0, &json!(7)));
    let folded =
        |end: &str| -> String { whole.as_bytes().chunks(76).map(|line| String::from_utf8_lossy(line) + end).collect() };
    let escaped: String = whole.bytes().map(|byte| format!("%{byte:02X}")).collect();
    for damaged in [
        whole.replace('&', "&amp;"),
        whole.replace('&', "&amp;amp;"),
        whole.replace('&', "%26").replace('=', "%3D"),
        whole.replace('=', "%253D").replace('&', "%2526"),
        escaped.replace("%76%3D", "v%3D"),
        folded("\n"),
        folded("\r\n "),
        folded("=\r\n").replace("&points=", "&points=3D").replace("v=1", "v=3D1"),
        format!("{whole}."),
        format!("<https://example.org/pointweave/#{whole}>"),
        format!("“{whole}”,"),
    ] {
        let mended = read_link(&damaged).unwrap_or_else(|error| panic!("{damaged}: {error}"));
        assert_eq!((&mended.exemplar, &mended.overrides), (&read.exemplar, &read.overrides), "{damaged}");
        assert!(mended.notes.len() == 1 && mended.notes[0].text.contains("mended"), "{:?}", mended.notes);
    }
    // Signs of another base64, and its padding, are the same letters.
    assert_eq!(read_link(&whole.replace('-', "+").replacen('_', "/", 1)).map(|link| link.exemplar), Ok(read.exemplar));
    // Cut anywhere, it says so: no part of a link is taken for the whole.
    for end in (1..whole.len()).step_by(7) {
        let cut = &whole[..end];
        assert!(read_link(cut).is_err(), "{cut}");
    }
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
    // In bits, from the lowest: no lower ones (00000), x is one step of 65535 (10), and so is y (1).
    let good = read(&[2, 1, 0xff, 0xff, 3, 1, 0, 0, 0b1010_0000]).unwrap();
    assert_eq!(pattern(&good).positions(), [DVec2::ONE]);
    for (bytes, part) in [
        (&[3, 1, 0, 0, 0, 0, 0, 0][..], "layout"),
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
        (&[2, 1, 0, 1, 0, 0], "rounded to nothing"),
        (&[2, 1, 1, 0, 0, 0], "rounded to nothing"),
        (&[2, 1, 0x80, 0x80, 4, 1, 0, 0], "beyond recognition"),
        (&[2, 1, 1, 0x80, 0x20, 0, 0], "beyond recognition"),
        (&[2, 0, 1, 1, 0, 0, 0], "no points"),
        (&[2, 1, 1, 1, 0, 0, 0b0001_0011, 0, 0, 0], "end too soon"),
        (&[2, 2, 1, 1, 0, 0, 0, 0xff, 0xff, 0xff], "end too soon"),
        // 25 lower bits.
        (&[2, 1, 1, 1, 0, 0, 0b0001_0011, 0, 0, 0, 0, 0, 0], "end too soon"),
        (&[2, 1, 1, 1, 0, 0, 0b1110_0001, 0xff, 0xff, 0, 0, 0, 0, 0], "outside the domain"),
        (&[2, 1, 1, 1, 0, 1, 1, b'w', 0, 0, 0, 0, 0, 0], "not in its list"),
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
        assert_eq!((link.method, link.preset.as_str()), (Method::Network, case["preset"].as_str().unwrap()), "{name}");
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

const PRESETS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/link/presets.json");

/// What the links of an edition that name a preset and nothing else mean, for a lattice and for another exemplar.
fn presets_of(edition: u32) -> Value {
    let mut presets = Map::new();
    for preset in Preset::ALL {
        let of = |exemplar: &str| {
            let fragment = format!("v=1&preset={}&presets={edition}&exemplar={exemplar}", preset.name());
            Value::Object(read_link(&fragment).unwrap().parameters().unwrap())
        };
        presets.insert(preset.name().to_owned(), json!({ "lattice": of("square-grid"), "other": of("rings") }));
    }
    json!({ "edition": edition, "presets": presets })
}

/// When this fails because a preset has changed, see `src/method/editions.rs`.
#[test]
fn links_keep_the_presets_they_were_made_with() {
    let golden: Vec<Value> = serde_json::from_str(&fs::read_to_string(PRESETS).unwrap()).unwrap();
    let editions: Vec<u32> = golden.iter().map(|it| it["edition"].as_u64().unwrap() as u32).collect();
    assert_eq!(editions, (1..=EDITION).collect::<Vec<u32>>(), "every edition is recorded");
    for (edition, recorded) in editions.into_iter().zip(golden) {
        for (preset, exemplars) in recorded["presets"].as_object().unwrap() {
            for (exemplar, parameters) in exemplars.as_object().unwrap() {
                let now = &presets_of(edition)["presets"][preset][exemplar];
                for (name, value) in parameters.as_object().unwrap() {
                    assert_eq!(
                        &now[name], value,
                        "links of edition {edition} with {preset} have got another {name} ({exemplar} exemplar): \
                         src/method/editions.rs says what to do"
                    );
                }
            }
        }
    }
    let later = read_link(&format!("v=1&presets={}&exemplar=rings", EDITION + 1)).unwrap();
    assert!(later.notes[0].text.contains("later presets"), "{:?}", later.notes);
}

/// Records what links of the present edition mean. Only as long as none are about: afterwards presets get a new edition.
#[test]
#[ignore = "writes what another test compares with"]
fn record_the_presets() {
    let text = fs::read_to_string(PRESETS).unwrap_or_else(|_| "[]".to_owned());
    let mut golden: Vec<Value> = serde_json::from_str(&text).unwrap();
    golden.retain(|it| it["edition"].as_u64() != Some(EDITION.into()));
    golden.push(presets_of(EDITION));
    fs::write(PRESETS, serde_json::to_string_pretty(&golden).unwrap() + "\n").unwrap();
}

/// Writes the golden links of this version, for whoever adds one: `cargo test --test link -- --ignored --nocapture`.
#[test]
#[ignore = "prints golden links instead of testing them"]
fn print_golden_links() {
    let lattice = (0..12).map(|i| DVec2::new((i % 4) as f64 / 4.0, (i / 4) as f64 / 3.0)).collect();
    let lattice = PointPattern::new(Domain::UNIT, lattice).unwrap().with_boundary(Boundary::Periodic);
    let gallery = |preset: Preset, overrides: Value| {
        let Value::Object(overrides) = overrides else { panic!("overrides are an object") };
        let (method, preset) = (Method::Network, preset.name().to_owned());
        Link { method, exemplar: LinkExemplar::named("chevrons").unwrap(), preset, overrides, notes: Vec::new() }
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
        ("classes and attributes in bits", points(rich(6, 40))),
        ("rounded to be short", points(trees(3, 3))),
    ];
    let list: Vec<Value> = cases
        .into_iter()
        .map(|(name, link)| {
            let Written { fragment, exemplar, .. } = write_link(&link).unwrap();
            let read = read_link(&fragment).unwrap();
            let gallery = match &exemplar {
                LinkExemplar::Gallery(name) => json!(name),
                LinkExemplar::Points(_) => Value::Null,
            };
            json!({
                "name": name, "fragment": fragment, "preset": read.preset, "overrides": read.overrides,
                "gallery": gallery, "exemplar": exemplar.pattern().unwrap(),
            })
        })
        .collect();
    println!("{}", serde_json::to_string_pretty(&list).unwrap());
}
