//! Forty places that files are made of, and what is asked of a reading of them.
#![allow(unreachable_pub, reason = "each test binary includes this file")]

use glam::DVec2;
use pointweave::formats::{NoteKind, Reading};

/// 8 × 5 places, no two on a line, with two decimals.
pub fn places() -> Vec<DVec2> {
    let jitter = |i: usize, step: usize| ((i * step) % 7) as f64 * 0.31;
    (0..40)
        .map(|i| DVec2::new((i % 8) as f64 * 12.5 + jitter(i, 3) + 5.0, (i / 8) as f64 * 11.0 + jitter(i, 5) + 4.0))
        .collect()
}

/// All places were read, with these attributes.
#[track_caller]
pub fn has_places(reading: &Reading, attributes: &[&str]) {
    let found = reading.pattern.positions();
    assert_eq!(found.len(), 40);
    for (found, wanted) in found.iter().zip(places()) {
        assert!((*found - wanted).length() < 1e-9, "{found} is not {wanted}");
    }
    let names: Vec<&str> = reading.pattern.attributes().iter().map(|attribute| attribute.name.as_str()).collect();
    assert_eq!(names, attributes);
}

/// A note of this kind says all of the parts.
#[track_caller]
pub fn noted(reading: &Reading, kind: NoteKind, parts: &[&str]) {
    let fits = reading.notes.iter().any(|note| note.kind == kind && parts.iter().all(|part| note.text.contains(part)));
    assert!(fits, "{:#?} without {parts:?}", reading.notes);
}
