//! The table and the sheet of `cargo xtask quality`, on a part of the gallery with a network too small to be good.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "common/picture.rs"]
mod picture;
#[path = "common/program.rs"]
#[allow(dead_code, reason = "the command line's binary is not run here")]
mod program;

use std::fs;
use std::path::PathBuf;
use std::process::Command;
use std::sync::LazyLock;

use picture::decode;

/// The program, built with what it stands beside: as a test of the whole workspace it is there already.
static PROGRAM: LazyLock<PathBuf> = LazyLock::new(|| {
    let profile = if cfg!(debug_assertions) { "dev" } else { "release" };
    let built = Command::new(env!("CARGO"))
        .args(["build", "--quiet", "--locked", "--workspace", "--example", "quality", "--profile", profile])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .status();
    assert!(built.unwrap().success(), "examples/quality.rs does not build");
    // Tests lie in `deps`, examples beside it.
    let test = std::env::current_exe().unwrap();
    test.parent().unwrap().with_file_name("examples").join("quality").with_extension(std::env::consts::EXE_EXTENSION)
});

/// What it prints, as an error if it fails. Its folder is `folder`.
fn quality(folder: &str, arguments: &[&str]) -> Result<String, String> {
    let output = Command::new(&*PROGRAM)
        .args(["--folder", folder, "--label", "small"])
        .args(["--set", "channels=4", "--set", "grid-min=24", "--set", "grid-max=32", "--set", "iterations-coarse=2"])
        .args(["--set", "iterations-fine=1", "--set", "iterations-polish=0"])
        .args(arguments)
        .output()
        .unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    if output.status.success() { Ok(text) } else { Err(text + &String::from_utf8(output.stderr).unwrap()) }
}

/// Pixels of a PNG, which decodes.
fn size(path: &str) -> (u32, u32) {
    let (width, height, pixels) = decode(&fs::read(path).unwrap());
    assert!(pixels.iter().any(|&value| value != pixels[0]), "{path} is empty");
    (width, height)
}

#[test]
fn presets_are_judged_in_pieces() {
    let folder = program::Folder::new("quality");
    let at = |name: &str| format!("{}/{name}", folder.path("small"));
    let both = ["--presets", "fast,paper", "--only", "rings,cluster", "--seeds", "1,2"];
    let first = quality(&folder.path(""), &["--presets", "fast", "--only", "rings", "--seeds", "1"]).unwrap();
    assert!(first.contains("fast rings 1: "), "{first}");
    let rest = quality(&folder.path(""), &both).unwrap();
    let made = |text: &str| text.lines().filter(|line| line.contains(" iterations, ")).count();
    assert_eq!((made(&first), made(&rest)), (1, 7), "{rest}");
    assert!(!rest.contains("fast rings 1: "), "what lies there is not made again: {rest}");
    for preset in ["fast", "paper"] {
        let table = fs::read_to_string(at(&format!("{preset}.md"))).unwrap();
        for name in ["rings", "cluster"] {
            assert!(table.contains(&format!("| {name} | 2 | ")), "both seeds: {table}");
        }
        // Four pictures, three in a row.
        let (sheet, one) = (size(&at(&format!("{preset}.png"))), size(&at(&format!("{preset}-rings-1.png"))));
        assert!(sheet.0 >= 3 * one.0 && sheet.1 >= 2 * one.1, "{sheet:?} of {one:?}");
    }
    // Tables come from the files, until all is made anew.
    let read = |seed: u8| -> serde_json::Value {
        serde_json::from_str(&fs::read_to_string(at(&format!("fast-rings-{seed}.json"))).unwrap()).unwrap()
    };
    let (mut changed, other) = (read(1), read(2)["quality"]["score"].as_f64().unwrap());
    changed["quality"]["score"] = 7.0.into();
    fs::write(at("fast-rings-1.json"), changed.to_string()).unwrap();
    assert_eq!(made(&quality(&folder.path(""), &both).unwrap()), 0);
    let row = format!("| rings | 2 | {:.3} | ", (7.0 + other) / 2.0);
    assert!(fs::read_to_string(at("fast.md")).unwrap().contains(&row), "{row}");
    let anew = ["--presets", "fast", "--only", "rings", "--seeds", "1", "--fresh"];
    assert_eq!(made(&quality(&folder.path(""), &anew).unwrap()), 1);
    assert!(read(1)["quality"]["score"].as_f64().unwrap() < 1.0);
    // Judged anew, from the points alone, it is the same as before; nothing is run, and what was changed by hand is put right.
    let (mut changed, before) = (read(1), read(1));
    changed["quality"]["score"] = 7.0.into();
    changed["scores"] = serde_json::json!([]);
    fs::write(at("fast-rings-1.json"), changed.to_string()).unwrap();
    let more = ["--presets", "fast", "--only", "rings,maze", "--seeds", "1", "--judge"];
    assert_eq!(made(&quality(&folder.path(""), &more).unwrap()), 1, "rings; there is no maze to judge");
    assert_eq!(read(1), before);
    let scores = before["scores"].as_array().unwrap();
    assert_eq!(scores.len(), 7, "{scores:?}");
    for score in scores {
        let of = |name: &str| score[name].as_f64().unwrap();
        let expected = ((of("chance") - of("value")) / (of("chance") - of("tiled"))).max(-1.0);
        assert!((of("score") - expected).abs() < 1e-9 && of("tiled") < of("chance"), "{score}");
    }
    // Other parameters are no part of this table.
    let error =
        quality(&folder.path(""), &["--presets", "fast", "--only", "rings", "--seeds", "1", "--set", "channels=6"]);
    let error = error.unwrap_err();
    assert!(error.contains("fast-rings-1.json was made with channels = 4 and 6 is asked for"), "{error}");
    assert_eq!(read(1), before);
}

#[test]
fn what_is_not_there_is_named() {
    let folder = program::Folder::new("quality-refuses");
    let error = quality(&folder.path(""), &["--only", "rigns"]).unwrap_err();
    assert!(error.contains("the gallery has no \"rigns\"; it has ") && error.contains("rings"), "{error}");
    let error = quality(&folder.path(""), &["--only", "rings", "--set", "chanels=4"]).unwrap_err();
    assert!(error.contains("there is no parameter \"chanels\""), "{error}");
    let error = quality(&folder.path(""), &["--only", "rings", "--judge"]).unwrap_err();
    assert!(error.contains("there is nothing to judge in ") && error.contains("small"), "{error}");
    let error = quality(&folder.path(""), &["--presets", "quick"]).unwrap_err();
    assert!(error.contains("quick") && error.contains("fast, balanced, best, paper"), "{error}");
}
