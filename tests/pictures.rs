//! Pictures as people have them, one test a kind; all are drawn here.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use pointweave::formats::{BlobOptions, Blobs, Ink, NoteKind, Picture, ReadOptions, find_blobs};
use pointweave::sampling::{Purpose, Rng};

const WIDTH: usize = 240;
const HEIGHT: usize = 180;

/// 40 points of a jittered grid, away from the border.
fn points() -> Vec<[f64; 2]> {
    let jitter = |i: usize| (i * 7 % 11) as f64 - 5.0;
    (0..40)
        .map(|i| [27.0 + (i % 8) as f64 * 26.0 + jitter(i), 28.0 + (i / 8) as f64 * 30.0 + jitter(3 * i + 1)])
        .collect()
}

/// Brightness of each pixel.
struct Canvas(Vec<f64>);

impl Canvas {
    fn new(ground: impl Fn(f64, f64) -> f64) -> Self {
        let at = |index: usize| ground((index % WIDTH) as f64 + 0.5, (index / WIDTH) as f64 + 0.5);
        Self((0..WIDTH * HEIGHT).map(at).collect())
    }

    /// Changes the pixels within a disk.
    fn disk(&mut self, [x, y]: [f64; 2], radius: f64, change: impl Fn(f64) -> f64) {
        for (index, value) in self.0.iter_mut().enumerate() {
            let [dx, dy] = [(index % WIDTH) as f64 + 0.5 - x, (index / WIDTH) as f64 + 0.5 - y];
            if dx * dx + dy * dy <= radius * radius {
                *value = change(*value);
            }
        }
    }

    fn rectangle(&mut self, columns: std::ops::Range<usize>, rows: std::ops::Range<usize>, value: f64) {
        for row in rows {
            self.0[row * WIDTH + columns.start..row * WIDTH + columns.end].fill(value);
        }
    }

    fn noisy(mut self, size: f64) -> Self {
        let mut rng = Rng::new(5, Purpose::Gallery);
        self.0.iter_mut().for_each(|value| *value += rng.range(-size, size));
        self
    }

    fn picture(&self) -> Picture {
        self.rgba(|value| [value, value, value, 255])
    }

    fn rgba(&self, pixel: impl Fn(u8) -> [u8; 4]) -> Picture {
        Picture::new(WIDTH, HEIGHT, self.0.iter().flat_map(|&value| pixel(value as u8)).collect::<Vec<_>>()).unwrap()
    }
}

fn dotted(ground: f64, ink: f64) -> Canvas {
    let mut canvas = Canvas::new(|_, _| ground);
    points().into_iter().for_each(|point| canvas.disk(point, 5.0, |_| ink));
    canvas
}

fn found(picture: &Picture) -> Blobs {
    let blobs = find_blobs(picture, &BlobOptions::default(), &ReadOptions::default()).unwrap();
    assert_eq!(blobs.reading.pattern.domain().size().to_array(), [WIDTH as f64, HEIGHT as f64]);
    blobs
}

/// Whether these points were found and nothing else, each within a pixel.
fn is(blobs: &Blobs, expected: &[[f64; 2]]) {
    let places: Vec<[f64; 2]> = blobs.reading.pattern.positions().iter().map(|point| point.to_array()).collect();
    assert_eq!(places.len(), expected.len(), "{:?}", blobs.reading.notes);
    for [x, y] in expected {
        let near = places.iter().filter(|at| (at[0] - x).hypot(at[1] - y) < 1.0).count();
        assert_eq!(near, 1, "at {x}, {y}: {:?}", blobs.reading.notes);
    }
}

fn has_note(blobs: &Blobs, kind: NoteKind, part: &str) {
    let notes = &blobs.reading.notes;
    assert!(notes.iter().any(|note| note.kind == kind && note.text.contains(part)), "{part:?} is not in {notes:?}");
}

#[test]
fn plain_pictures_have_no_notes() {
    for canvas in [dotted(255.0, 0.0), dotted(10.0, 240.0), dotted(200.0, 90.0).noisy(20.0)] {
        let blobs = found(&canvas.picture());
        is(&blobs, &points());
        assert!(!blobs.is_local && blobs.reading.notes.is_empty(), "{:?}", blobs.reading.notes);
    }
}

#[test]
fn frames_and_axes_are_no_points() {
    let lines: [&[(std::ops::Range<usize>, std::ops::Range<usize>)]; 4] = [
        // A frame.
        &[(6..234, 6..8), (6..234, 172..174), (6..8, 6..174), (232..234, 6..174)],
        // Two axes that meet.
        &[(6..234, 172..174), (6..8, 6..174)],
        // Two that do not.
        &[(12..234, 174..176), (4..6, 6..160)],
        // A frame at the very border.
        &[(0..240, 0..3), (0..240, 177..180), (0..3, 0..180), (237..240, 0..180)],
    ];
    for lines in lines {
        let mut canvas = dotted(255.0, 30.0);
        lines.iter().for_each(|(columns, rows)| canvas.rectangle(columns.clone(), rows.clone(), 30.0));
        let blobs = found(&canvas.picture());
        is(&blobs, &points());
        has_note(&blobs, NoteKind::LeftOut, "left out: a frame, an axis or a line");
    }
    // A large disk is none.
    let mut canvas = dotted(255.0, 30.0);
    canvas.disk(points()[20], 11.0, |_| 30.0);
    assert_eq!(found(&canvas.picture()).reading.pattern.len(), 40);
}

#[test]
fn uneven_light() {
    // Shadow from the left, from a corner, and a bright middle; dots are half as bright as the ground.
    let grounds: [fn(f64, f64) -> f64; 3] = [
        |x, _| 90.0 + 160.0 * x / WIDTH as f64,
        |x, y| 80.0 + 85.0 * (x / WIDTH as f64 + y / HEIGHT as f64),
        |x, y| 250.0 - 160.0 * ((x - 120.0).powi(2) + (y - 90.0).powi(2)) / 22_500.0,
    ];
    for ground in grounds {
        let mut canvas = Canvas::new(ground);
        points().into_iter().for_each(|point| canvas.disk(point, 5.0, |value| 0.5 * value));
        for canvas in [Canvas(canvas.0.clone()), canvas.noisy(4.0)] {
            let blobs = found(&canvas.picture());
            is(&blobs, &points());
            assert!(blobs.is_local && blobs.ink == Ink::Dark);
            has_note(&blobs, NoteKind::Changed, "The light is uneven");
        }
        // A threshold is one for the whole picture.
        let mut canvas = Canvas::new(ground);
        points().into_iter().for_each(|point| canvas.disk(point, 5.0, |value| 0.5 * value));
        let options = BlobOptions { threshold: Some(120), ..BlobOptions::default() };
        let blobs = find_blobs(&canvas.picture(), &options, &ReadOptions::default()).unwrap();
        assert!(!blobs.is_local && blobs.threshold == 120);
    }
    // Light dots in uneven darkness.
    let mut canvas = Canvas::new(|x, _| 20.0 + 130.0 * x / WIDTH as f64);
    points().into_iter().for_each(|point| canvas.disk(point, 5.0, |value| value + 60.0));
    let blobs = found(&canvas.picture());
    is(&blobs, &points());
    assert!(blobs.is_local && blobs.ink == Ink::Light);
}

/// 28 large ones and 12 others.
fn two_kinds(ground: f64, large: f64, radius: f64, other: f64) -> Canvas {
    let mut canvas = Canvas::new(|_, _| ground);
    for (i, point) in points().into_iter().enumerate() {
        if i % 10 < 3 { canvas.disk(point, radius, |_| other) } else { canvas.disk(point, 7.0, |_| large) }
    }
    canvas
}

#[test]
fn faint_ones_beside_strong_ones() {
    for (ground, large, other) in [(255.0, 20.0, 180.0), (10.0, 240.0, 80.0), (210.0, 30.0, 140.0)] {
        for radius in [2.5, 7.0] {
            let blobs = found(&two_kinds(ground, large, radius, other).noisy(3.0).picture());
            is(&blobs, &points());
            has_note(&blobs, NoteKind::Changed, "12 blobs fainter than the others");
        }
    }
    // Of all sizes they are no kind: they are counted.
    let mut canvas = dotted(255.0, 20.0);
    for (i, radius) in [1.6, 2.0, 6.0, 6.5, 1.8, 7.0].into_iter().enumerate() {
        canvas.disk([14.0 + 38.0 * i as f64, 14.0], radius, |value| value.min(180.0));
    }
    let blobs = found(&canvas.picture());
    assert!(blobs.reading.pattern.len() >= 40);
    assert!(!blobs.reading.notes.is_empty());
}

#[test]
fn small_ones_beside_large_ones() {
    for (ground, ink) in [(255.0, 20.0), (10.0, 240.0)] {
        let blobs = found(&two_kinds(ground, ink, 2.0, ink).picture());
        is(&blobs, &points());
        has_note(&blobs, NoteKind::Changed, "12 blobs are much smaller");
    }
    // Specks are dirt none the less, and are counted.
    let mut canvas = dotted(255.0, 20.0);
    (0..20).for_each(|i| canvas.disk([8.5 + 11.0 * i as f64, 11.5], 0.9, |_| 20.0));
    let blobs = found(&canvas.picture());
    is(&blobs, &points());
    has_note(&blobs, NoteKind::LeftOut, "20 blobs were too small or too large");
}

#[test]
fn marks_on_transparent_ground() {
    let canvas = dotted(0.0, 255.0);
    for color in [[255, 255, 255], [255, 255, 190], [250, 250, 250]] {
        let blobs = found(&canvas.rgba(|value| [color[0], color[1], color[2], value]));
        is(&blobs, &points());
        // Where the color shows on white there is nothing to say.
        if color == [255; 3] {
            has_note(&blobs, NoteKind::Changed, "The ground is transparent");
        }
    }
    // White ones and black ones.
    let mut count = 0;
    let mut canvas = Canvas::new(|_, _| 0.0);
    points().into_iter().for_each(|point| {
        count += 1;
        canvas.disk(point, 5.0, |_| if count % 2 == 0 { 255.0 } else { 128.0 });
    });
    let mixed = canvas.rgba(|value| match value {
        0 => [0, 0, 0, 0],
        128 => [0, 0, 0, 255],
        _ => [255; 4],
    });
    is(&found(&mixed), &points());
    // Black ones as ever, and a light sheet with dark ones on it.
    let blobs = found(&dotted(0.0, 255.0).rgba(|value| [0, 0, 0, value]));
    is(&blobs, &points());
    assert!(blobs.reading.notes.is_empty());
    let mut sheet = Canvas::new(|x, y| if x < 160.0 && y < 120.0 { 255.0 } else { 0.0 });
    let inside: Vec<[f64; 2]> = points().into_iter().filter(|[x, y]| *x < 150.0 && *y < 110.0).collect();
    inside.iter().for_each(|&point| sheet.disk(point, 5.0, |_| 128.0));
    let sheet = sheet.rgba(|value| match value {
        0 => [0; 4],
        128 => [0, 0, 0, 255],
        _ => [255; 4],
    });
    is(&found(&sheet), &inside);
}
