//! The numbered examples: the command in an example's head and the calls in its body make the same points.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "../examples/05_blue_noise.rs"]
#[allow(dead_code, reason = "its `main` writes a file and is not called")]
mod blue_noise;
#[path = "../examples/04_boats.rs"]
#[allow(dead_code, reason = "its `main` writes a file and is not called")]
mod boats;
#[path = "../examples/02_chevrons.rs"]
#[allow(dead_code, reason = "its `main` writes a file and is not called")]
mod chevrons;
#[path = "../examples/03_houses.rs"]
#[allow(dead_code, reason = "its `main` writes a file and is not called")]
mod houses;
#[path = "common/program.rs"]
#[allow(dead_code, reason = "its folders are for other tests")]
mod program;
#[path = "../examples/01_rings.rs"]
#[allow(dead_code, reason = "its `main` writes a file and is not called")]
mod rings;

use std::fs;
use std::path::Path;

use anyhow::Result;
use pointweave::PointPattern;
use pointweave::formats::write_csv;
use pointweave::run::Plan;
use program::run;
use serde_json::Value;

/// A few iterations on a coarse grid, and none of the corrections that take time. What the runs share is all the same.
const TINY: [(&str, u32); 10] = [
    ("channels", 4),
    ("grid-min", 16),
    ("grid-max", 16),
    ("coarse-sigma-px", 4),
    ("scales", 1),
    ("iterations-coarse", 2),
    ("iterations-polish", 0),
    ("alignment", 0),
    ("transplants", 0),
    ("value-swaps", 0),
];

/// The arguments after `pointweave` in the head of an example, without what it writes.
fn command(example: &str) -> Vec<String> {
    let line = example.lines().find_map(|line| line.strip_prefix("//! pointweave ")).unwrap();
    let (arguments, _) = line.split_once(" -o ").unwrap();
    arguments.split(' ').map(str::to_owned).collect()
}

fn tiny(mut plan: Plan, seed: Option<u64>) -> Plan {
    plan.overrides.extend(TINY.map(|(name, value)| (name.to_owned(), Value::from(value))));
    plan.overrides.extend(seed.map(|seed| ("seed".to_owned(), Value::from(seed))));
    plan
}

#[track_caller]
fn agree(file: &str, plan: fn() -> Result<Plan>, synthesize: fn(Plan) -> Result<PointPattern>) {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(file)).unwrap();
    let mut arguments = command(&text);
    arguments.extend(TINY.iter().flat_map(|(name, value)| ["--set".to_owned(), format!("{name}={value}")]));
    let output = run(&arguments.iter().map(String::as_str).collect::<Vec<_>>(), b"");
    let words = String::from_utf8_lossy(&output.stderr);
    assert_eq!((output.status.code(), &*words), (Some(0), ""), "{arguments:?}");

    let ours = write_csv(&synthesize(tiny(plan().unwrap(), None)).unwrap());
    assert_eq!(ours, String::from_utf8(output.stdout).unwrap(), "{file}");
    // What the parameters say matters: with another seed they are other points.
    assert_ne!(ours, write_csv(&synthesize(tiny(plan().unwrap(), Some(77))).unwrap()), "{file}");
}

#[test]
fn rings_agree() {
    agree("01_rings.rs", rings::plan, rings::run);
}

#[test]
fn chevrons_agree() {
    agree("02_chevrons.rs", chevrons::plan, chevrons::run);
}

#[test]
fn houses_agree() {
    agree("03_houses.rs", houses::plan, houses::run);
}

#[test]
fn boats_agree() {
    agree("04_boats.rs", boats::plan, boats::run);
}

#[test]
fn blue_noise_agrees() {
    agree("05_blue_noise.rs", blue_noise::plan, blue_noise::run);
}

/// An example that is not in the list above is run by nobody.
#[test]
fn every_numbered_example_is_in_this_file() {
    let here = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/examples.rs")).unwrap();
    let mut count = 0;
    for entry in fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if name.starts_with(|first: char| first.is_ascii_digit()) {
            count += 1;
            assert!(here.contains(&format!("agree(\"{name}\"")), "{name}");
        }
    }
    assert!(count >= 5, "{count}");
}
