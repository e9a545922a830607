//! Pictures that are no plain dots on plain paper: frames, shadows, faint spots, transparent grounds.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use pointweave::formats::{BlobOptions, Blobs, Ink, NoteKind, Picture, ReadOptions, find_blobs};

const WIDTH: usize = 320;
const HEIGHT: usize = 240;

/// Red, green, blue and alpha of a pixel by its place.
type Pixel<'a> = &'a dyn Fn(f64, f64) -> [f64; 4];

fn picture(of: Pixel<'_>) -> Picture {
    let place = |i: usize| ((i % WIDTH) as f64 + 0.5, (i / WIDTH) as f64 + 0.5);
    let pixels = (0..WIDTH * HEIGHT).map(place).flat_map(|(x, y)| of(x, y)).map(|value| value.round() as u8);
    Picture::new(WIDTH, HEIGHT, pixels.collect::<Vec<u8>>()).unwrap()
}

/// Thirty places in a jittered grid, all within 30 pixels of the border.
fn places() -> Vec<[f64; 2]> {
    (0..30)
        .map(|i: i32| {
            let jitter = |k: i32| f64::from((i * k) % 7 - 3) * 1.7;
            [55.0 + f64::from(i % 6) * 42.0 + jitter(3), 45.0 + f64::from(i / 6) * 37.0 + jitter(5)]
        })
        .collect()
}

/// Which disk a place lies in.
fn disk(x: f64, y: f64, radius: impl Fn(usize) -> f64) -> Option<usize> {
    places().iter().enumerate().position(|(i, [cx, cy])| (x - cx).hypot(y - cy) <= radius(i))
}

fn gray(level: f64) -> [f64; 4] {
    [level, level, level, 255.0]
}

#[track_caller]
fn found(of: Pixel<'_>, options: &BlobOptions) -> Blobs {
    find_blobs(&picture(of), options, &ReadOptions::default()).unwrap()
}

#[track_caller]
fn is_all(blobs: &Blobs) {
    let found = blobs.reading.pattern.positions();
    assert_eq!(found.len(), 30, "{:?}", blobs.reading.notes);
    for [x, y] in places() {
        let nearest = found.iter().map(|point| (point.x - x).hypot(point.y - y)).fold(f64::INFINITY, f64::min);
        assert!(nearest < 0.75, "({x}, {y}) is {nearest} from a point");
    }
    let domain = blobs.reading.pattern.domain();
    assert_eq!(domain.max().to_array(), [WIDTH as f64, HEIGHT as f64]);
}

#[track_caller]
fn noted(blobs: &Blobs, kind: NoteKind, part: &str) {
    let notes = &blobs.reading.notes;
    assert!(notes.iter().any(|note| note.kind == kind && note.text.contains(part)), "{notes:#?} without {part:?}");
}

#[test]
fn plain_dots_need_no_word() {
    for (dot, ground) in [(20.0, 240.0), (230.0, 15.0)] {
        // With soft edges, as programs draw them, and some noise.
        let of = |x: f64, y: f64| {
            let gap = places().iter().map(|[cx, cy]| (x - cx).hypot(y - cy)).fold(f64::INFINITY, f64::min);
            let share = (6.5 - gap).clamp(0.0, 1.0);
            let noise = ((x * 12.9898 + y * 78.233).sin() * 43_758.545_3).fract() * 3.0;
            gray((dot * share + ground * (1.0 - share) + noise).clamp(0.0, 255.0))
        };
        let blobs = found(&of, &BlobOptions::default());
        is_all(&blobs);
        assert!(blobs.reading.notes.is_empty(), "{:?}", blobs.reading.notes);
        assert!(!blobs.is_evened && !blobs.is_by_opacity && blobs.faint_threshold.is_none());
    }
}

#[test]
fn frames_axes_and_curves_are_no_dots() {
    let near = |value: f64, line: f64| (value - line).abs() <= 1.0;
    let within = |x: f64, y: f64| (20.0..=300.0).contains(&x) && (15.0..=225.0).contains(&y);
    let frame = |x: f64, y: f64| within(x, y) && (near(x, 21.0) || near(x, 299.0) || near(y, 16.0) || near(y, 224.0));
    let axes = |x: f64, y: f64| within(x, y) && (near(x, 21.0) || near(y, 224.0) || near(x % 40.0, 20.0) && y > 219.0);
    let border = |x: f64, y: f64| x < 3.0 || y < 3.0 || x > 317.0 || y > 237.0;
    let line = |x: f64, y: f64| near(y, 16.0) && within(x, y);
    for (shape, name) in
        [(&frame as &dyn Fn(f64, f64) -> bool, "frame"), (&axes, "axes"), (&border, "border"), (&line, "line")]
    {
        for (ink, ground) in [(30.0, 250.0), (240.0, 20.0)] {
            let of = |x: f64, y: f64| gray(if shape(x, y) || disk(x, y, |_| 6.0).is_some() { ink } else { ground });
            let blobs = found(&of, &BlobOptions::default());
            println!("{name}");
            is_all(&blobs);
            noted(&blobs, NoteKind::LeftOut, "One shape that is long and thin");
        }
    }
    let of = |x: f64, y: f64| gray(if frame(x, y) || disk(x, y, |_| 6.0).is_some() { 0.0 } else { 255.0 });
    let all = BlobOptions { max_area: Some(1e6), ..BlobOptions::default() };
    assert_eq!(found(&of, &all).reading.pattern.len(), 31, "whoever sets a largest area decides");
    // Labels beside the axes.
    let label = |x: f64, y: f64| y > 228.0 && y < 236.0 && (x % 30.0) < 6.0;
    let of =
        |x: f64, y: f64| gray(if label(x, y) || frame(x, y) || disk(x, y, |_| 6.0).is_some() { 0.0 } else { 255.0 });
    noted(&found(&of, &BlobOptions::default()), NoteKind::Odd, "outside the frame");
    // Long marks are marks where all are.
    let of = |x: f64, y: f64| gray(if (y % 40.0) < 4.0 && (10.0..310.0).contains(&x) { 0.0 } else { 255.0 });
    assert_eq!(found(&of, &BlobOptions::default()).reading.pattern.len(), 6);
}

#[test]
fn uneven_light_is_evened_out() {
    let linear = |x: f64, y: f64| 60.0 + 190.0 * (0.7 * x / 320.0 + 0.3 * y / 240.0);
    let vignette = |x: f64, y: f64| 250.0 - 190.0 * ((x - 160.0).hypot(y - 120.0) / 200.0).powi(2);
    for light in [&linear as &dyn Fn(f64, f64) -> f64, &vignette] {
        let paper = |x: f64, y: f64| gray(light(x, y) * if disk(x, y, |_| 6.0).is_some() { 0.6 } else { 1.0 });
        let blobs = found(&paper, &BlobOptions::default());
        is_all(&blobs);
        assert!(blobs.is_evened && blobs.ink == Ink::Dark);
        noted(&blobs, NoteKind::Changed, "evened out");
        noted(&blobs, NoteKind::Changed, &blobs.threshold.to_string());
    }
    let glow = |x: f64, y: f64| gray(0.4 * linear(x, y) + if disk(x, y, |_| 6.0).is_some() { 60.0 } else { 0.0 });
    let blobs = found(&glow, &BlobOptions::default());
    is_all(&blobs);
    assert!(blobs.is_evened && blobs.ink == Ink::Light);
    // Large blobs are no shadow.
    let of = |x: f64, y: f64| {
        gray(if (x - 90.0).hypot(y - 90.0) < 70.0 || (x - 250.0).hypot(y - 170.0) < 50.0 { 20.0 } else { 240.0 })
    };
    let blobs = found(&of, &BlobOptions::default());
    assert!(!blobs.is_evened && blobs.reading.pattern.len() == 2);
}

#[test]
fn faint_and_small_spots_beside_large_ones() {
    let is_small = |i: usize| i % 5 > 2;
    // The smallest are thirteen pixels, more or less.
    let radius = |i: usize| if is_small(i) { 2.1 } else { 7.0 };
    for (large, small, ground) in [(10.0, 10.0, 240.0), (10.0, 190.0, 240.0), (240.0, 70.0, 10.0), (250.0, 120.0, 10.0)]
    {
        let of = |x: f64, y: f64| match disk(x, y, radius) {
            Some(i) if is_small(i) => gray(small),
            Some(_) => gray(large),
            None => gray(ground),
        };
        let blobs = found(&of, &BlobOptions::default());
        is_all(&blobs);
        noted(&blobs, NoteKind::Changed, "12 blobs are smaller or fainter than the other 18");
        noted(&blobs, NoteKind::Changed, &format!("threshold {}", blobs.threshold));
        assert_eq!(blobs.faint_threshold.is_some(), large != small);
        // A person who sets a size or a threshold gets that.
        let strict = found(&of, &BlobOptions { min_area: Some(60.0), ..BlobOptions::default() });
        assert_eq!(strict.reading.pattern.len(), 18);
        let strict = found(&of, &BlobOptions { threshold: Some(blobs.threshold), ..BlobOptions::default() });
        assert_eq!(strict.reading.pattern.len(), if large == small { 30 } else { 18 });
    }
    // Letters and lines in gray are no spots, but they are counted.
    let letter = |x: f64, y: f64| y < 20.0 && y > 10.0 && (x % 40.0) < 12.0 && ((x % 40.0) < 2.0 || y < 12.0);
    let of = |x: f64, y: f64| {
        gray(if disk(x, y, |_| 6.0).is_some() {
            10.0
        } else if letter(x, y) {
            190.0
        } else {
            240.0
        })
    };
    let blobs = found(&of, &BlobOptions::default());
    is_all(&blobs);
    noted(&blobs, NoteKind::LeftOut, "8 fainter spots were left out at threshold");
}

#[test]
fn marks_on_a_transparent_ground() {
    let clear = |level: f64| [level, level, level, 0.0];
    let white = |x: f64, y: f64| if disk(x, y, |_| 6.0).is_some() { gray(255.0) } else { clear(255.0) };
    let pale = |x: f64, y: f64| if disk(x, y, |_| 6.0).is_some() { [255.0, 250.0, 220.0, 255.0] } else { clear(0.0) };
    let mixed = |x: f64, y: f64| match disk(x, y, |_| 6.0) {
        Some(i) => gray(if i % 2 == 0 { 255.0 } else { 0.0 }),
        None => clear(0.0),
    };
    for of in [&white as Pixel<'_>, &mixed] {
        let blobs = found(of, &BlobOptions::default());
        is_all(&blobs);
        assert!(blobs.is_by_opacity);
        noted(&blobs, NoteKind::Changed, "opacity");
    }
    is_all(&found(&pale, &BlobOptions::default()));
    let black = |x: f64, y: f64| if disk(x, y, |_| 6.0).is_some() { gray(0.0) } else { clear(255.0) };
    let blobs = found(&black, &BlobOptions::default());
    is_all(&blobs);
    assert!(!blobs.is_by_opacity && blobs.reading.notes.is_empty());
}

/// Nothing that is looked for takes long, whatever the picture.
#[test]
fn the_largest_picture_is_read_in_seconds() {
    let side = 4096;
    let noise = |i: usize| (i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 56) as u8;
    for of in [noise, |i: usize| ((i % 4096) / 16) as u8 / 2 + u8::from(i.is_multiple_of(3)) * 90] {
        let pixels: Vec<u8> = (0..side * side).flat_map(|i| [of(i), of(i), of(i), 255 - of(i)]).collect();
        let picture = Picture::new(side, side, pixels).unwrap();
        let start = std::time::Instant::now();
        let _ = find_blobs(&picture, &BlobOptions::default(), &ReadOptions::default());
        assert!(start.elapsed().as_secs() < 30, "{:?}", start.elapsed());
        println!("{:?}", start.elapsed());
    }
}
