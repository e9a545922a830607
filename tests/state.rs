//! Saved states are continued for ever: one that was saved when there was one method, and so does not name it.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fs;
use std::path::Path;

use pointweave::methods;
use pointweave::run::{Event, StateTag};
use serde_json::Value;

const GENEROUS: u64 = 1_000_000_000;

/// Saved after five iterations of a run with two classes.
fn untagged() -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/state/untagged.json")).unwrap()
}

#[test]
fn a_state_without_a_method_goes_on_where_it_was() {
    let text = untagged();
    assert!(!text.contains("\"method\""), "it is older than the second method");
    let tag = StateTag::of(&text).unwrap();
    assert_eq!((tag.method.as_str(), tag.version), ("network", 2));
    let mut run = methods::resume(&text, GENEROUS).unwrap();

    // Nothing is lost or changed on the way through.
    let before: Value = serde_json::from_str(&text).unwrap();
    let mut after: Value = serde_json::from_str(&run.state().unwrap()).unwrap();
    assert_eq!(after.as_object_mut().unwrap().remove("method"), Some(Value::from("network")));
    assert_eq!(after, before);
    let places: Vec<[f64; 2]> = run.canvas().points().iter().map(|&point| point.into()).collect();
    assert_eq!(serde_json::to_value(places).unwrap(), before["points"]);

    assert_eq!(run.progress().total_iterations, 5);
    while run.advance_by(u32::MAX).unwrap() != Event::Finished {}
    assert_eq!(run.canvas().pattern().unwrap().len(), 12);
    assert!(run.progress().total_iterations > 5);
}

#[test]
fn damage_is_named() {
    let refused = |from: &str, to: &str| {
        let text = untagged();
        assert!(text.contains(from), "{from}");
        methods::resume(&text.replacen(from, to, 1), GENEROUS).map_or_else(|error| error.to_string(), |_| String::new())
    };
    for (from, to, words) in [
        ("\"version\":2", "\"version\":1", "its version is 1, this program reads 2"),
        ("\"version\":2", "\"method\":\"weaving\",\"version\":2", "must be one of network"),
        ("\"total-iterations\":5", "\"total-iterations\":-5", "the saved state can't be read"),
        ("\"channels\":4", "\"channels\":400", "'channels' is 400, but must lie between 4 and 160"),
    ] {
        let message = refused(from, to);
        assert!(message.contains(words), "{message:?} does not say {words:?}");
    }
}
