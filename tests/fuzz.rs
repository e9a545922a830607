//! A short run of the fuzzers of `fuzz/`, on any toolchain: their seeds, changed at random but reproducibly. A longer one:
//! `POINTWEAVE_FUZZ=1000000 cargo test --release --test fuzz`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

#[path = "common/decoders.rs"]
mod decoders;

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use pointweave::sampling::{Purpose, Rng};

/// Longest time for one input: none takes a thousandth of it, but the machine may have other things to do.
const PATIENCE: Duration = Duration::from_secs(60);

fn seeds(target: &str) -> Vec<Vec<u8>> {
    let folder = format!("{}/fuzz/seeds/{target}", env!("CARGO_MANIFEST_DIR"));
    let mut paths: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths.into_iter().map(|path| fs::read(path).unwrap()).collect()
}

/// A few changes of the kinds fuzzers make.
fn mutate(bytes: &mut Vec<u8>, others: &[Vec<u8>], rng: &mut Rng) {
    const TOKENS: [&[u8]; 16] = [
        b"nan",
        b"-1e308",
        b"1e-320",
        b"18446744073709551616",
        b"\"",
        b"[[",
        b"{",
        b"\xff\xfe",
        b"\r",
        b"#",
        b"<g>",
        b"'",
        b"&",
        b"=",
        b"\x00\x00\x00\xff",
        b"\xc3\xa9",
    ];
    for _ in 0..1 + rng.index(6) {
        let at = rng.index(bytes.len() + 1);
        match rng.index(7) {
            0 if at < bytes.len() => bytes[at] ^= 1 << rng.index(8),
            1 if at < bytes.len() => bytes[at] = rng.index(256) as u8,
            2 if at < bytes.len() => {
                let end = (at + 1 + rng.index(16)).min(bytes.len());
                bytes.drain(at..end);
            }
            3 => {
                let token = TOKENS[rng.index(TOKENS.len())];
                bytes.splice(at..at, token.iter().copied());
            }
            4 if at < bytes.len() => {
                let piece = bytes[at..(at + 1 + rng.index(32)).min(bytes.len())].to_vec();
                let to = rng.index(bytes.len() + 1);
                bytes.splice(to..to, piece);
            }
            5 => {
                let other = &others[rng.index(others.len())];
                let from = rng.index(other.len() + 1);
                bytes.truncate(at);
                bytes.extend_from_slice(&other[from..]);
            }
            _ => bytes.truncate(at),
        }
    }
}

fn fuzz(target: &str, share: usize, decode: fn(&[u8])) {
    let executions: usize = std::env::var("POINTWEAVE_FUZZ").map_or(20_000, |text| text.parse().unwrap());
    let seeds = seeds(target);
    assert!(seeds.len() >= 2, "{target} has its seeds");
    seeds.iter().for_each(|seed| decode(seed));
    let mut rng = Rng::new(1, Purpose::Gallery);
    for execution in 0..executions / share {
        let mut bytes = seeds[rng.index(seeds.len())].clone();
        mutate(&mut bytes, &seeds, &mut rng);
        let start = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| decode(&bytes)));
        let shown = String::from_utf8_lossy(&bytes).into_owned();
        assert!(outcome.is_ok(), "{target}, execution {execution}: {shown:?} = {bytes:?}");
        assert!(start.elapsed() < PATIENCE, "{target}, execution {execution} took {:?}: {shown:?}", start.elapsed());
    }
}

#[test]
fn text() {
    fuzz("text", 1, decoders::text);
}

#[test]
fn json() {
    fuzz("json", 1, decoders::json);
}

#[test]
fn svg() {
    fuzz("svg", 1, decoders::svg);
}

#[test]
fn npy() {
    fuzz("npy", 1, decoders::npy);
}

#[cfg(not(target_arch = "wasm32"))]
#[test]
fn png() {
    fuzz("png", 1, decoders::png);
}

#[test]
fn pixels() {
    fuzz("pixels", 2, decoders::pixels);
}

#[test]
fn link() {
    fuzz("link", 4, decoders::link);
}

/// The fuzzer itself: a decoder that fails on a token it puts in must be caught.
#[test]
#[should_panic(expected = "text, execution")]
fn a_decoder_that_panics_is_found() {
    fuzz("text", 1, |bytes| assert!(!bytes.windows(3).any(|window| window == b"nan"), "found"));
}
