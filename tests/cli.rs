//! The real binary: files, standard streams, exit codes, and what it says when it refuses.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

#[path = "common/program.rs"]
mod program;
#[path = "common/zip.rs"]
mod zip;

use std::fs;
use std::path::Path;

use pointweave::formats::{Project, ReadOptions, read, write_csv, write_project};
use pointweave::{Boundary, PointPattern, gallery};
use program::{Folder, run};

/// The smallest run the parameters allow: these tests are about the command line, not about the picture.
const TINY: [&str; 16] = [
    "--set",
    "channels=4",
    "--set",
    "grid-min=16",
    "--set",
    "grid-max=16",
    "--set",
    "scales=2",
    "--set",
    "iterations-coarse=3",
    "--set",
    "iterations-fine=2",
    "--set",
    "coarse-sigma-px=4",
    "--threads",
    "1",
];

/// What is in a folder.
fn names(folder: &Folder) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(&folder.0).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Runs a tiny synthesis that must succeed in silence; returns standard output.
#[track_caller]
fn synth(arguments: &[&str], input: &[u8]) -> Vec<u8> {
    // What a reader says of a few points is looked at elsewhere.
    let output = run(&[&["synth", "--quiet"], arguments, &TINY[..]].concat(), input);
    let words = String::from_utf8_lossy(&output.stderr);
    assert_eq!((output.status.code(), &*words), (Some(0), ""), "{arguments:?}");
    output.stdout
}

/// The command must end with `code` and say all of `parts`, in one line, with nothing on standard output.
#[track_caller]
fn refused(arguments: &[&str], input: &[u8], code: i32, parts: &[&str]) {
    let quiet: &[&str] = if arguments.first() == Some(&"synth") { &["--quiet"] } else { &[] };
    let output = run(&[arguments, quiet].concat(), input);
    let words = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {words}");
    assert!(output.stdout.is_empty());
    for part in parts {
        assert!(words.contains(part), "{arguments:?}\n  says    {words:?}\n  without {part:?}");
    }
    if words.starts_with("pointweave: ") {
        assert_eq!(words.lines().count(), 1, "{words}");
    }
}

fn pattern(bytes: &[u8]) -> PointPattern {
    read(bytes, None, &ReadOptions::default()).unwrap()
}

fn exemplar() -> String {
    write_csv(&gallery::entries()[0].exemplar())
}

#[test]
fn every_format_goes_in_and_out() {
    let folder = Folder::new("formats");
    let input = folder.file("in.csv", &exemplar());
    let [csv, json, svg, png] = ["out.csv", "out.json", "out.SVG", "out.png"].map(|name| {
        assert!(synth(&[&input, "--boundary", "open", "-o", &folder.path(name)], b"").is_empty());
        fs::read(folder.path(name)).unwrap()
    });
    let result = pattern(&csv);
    let source = pattern(exemplar().as_bytes());
    assert_eq!(result.len(), 4 * source.len());
    assert_eq!(result.domain().size(), source.domain().size() * 2.0);
    assert_eq!(result.boundary(), Boundary::Open);
    // Unless told otherwise, a tile makes a tile.
    assert_eq!(source.boundary(), Boundary::Periodic);
    assert_eq!(pattern(&synth(&[&input], b"")).boundary(), Boundary::Periodic);
    assert_eq!(pattern(&json), result);
    let svg = String::from_utf8(svg).unwrap();
    assert_eq!(svg.matches("<circle").count(), result.len());
    assert!(svg.contains(&format!("<title>{} points", result.len())), "{svg:.300}");
    assert!(png.starts_with(b"\x89PNG"));
    assert_eq!(names(&folder), ["in.csv", "out.SVG", "out.csv", "out.json", "out.png"], "no half-written files");

    // Standard streams carry the same, and a pipe sees no progress bar (`synth` asserts silence).
    let open = ["--boundary", "open"];
    let streamed = |arguments: &[&str], bytes: &[u8]| synth(&[arguments, &open].concat(), bytes);
    assert_eq!(streamed(&["-"], exemplar().as_bytes()), csv);
    assert_eq!(streamed(&["-", "-o", "-", "--format", "json"], exemplar().as_bytes()), json);
    assert_eq!(streamed(&[&format!("gallery:{}", gallery::entries()[0].name)], b""), csv);
    // --format beats the name; an existing file is replaced whole.
    let long = folder.file("old.csv", &"x".repeat(1_000_000));
    streamed(&[&input, "-o", &long, "--format", "json"], b"");
    assert_eq!(fs::read(&long).unwrap(), json);
}

#[test]
fn parameters_reach_the_run() {
    let text = exemplar();
    let base = synth(&["-"], text.as_bytes());
    assert_eq!(synth(&["-", "--seed", "1", "--preset", "fast", "--scale", "2"], text.as_bytes()), base);
    assert_ne!(synth(&["-", "--seed", "2"], text.as_bytes()), base);
    assert_eq!(synth(&["-", "--seed", "2"], text.as_bytes()), synth(&["-", "--set", "seed=2"], text.as_bytes()));

    let source = pattern(text.as_bytes());
    let wide = pattern(&synth(&["-", "--scale", "3x1", "--boundary", "periodic"], text.as_bytes()));
    assert_eq!(wide.boundary(), Boundary::Periodic);
    assert!((wide.domain().size() / source.domain().size() - glam::DVec2::new(3.0, 1.0)).length() < 1e-12);
    // A domain twice as wide is twice as empty; the result keeps that.
    let sparse = pattern(&synth(&["-", "--domain", "-1,0,1,1"], b"0.1 0.1\n0.5 0.5\n0.9 0.2\n0.3 0.8\n0.7 0.9\n"));
    assert_eq!((sparse.domain().min().x, sparse.domain().size().x, sparse.len()), (-1.0, 4.0, 20));
}

#[test]
fn a_saved_run_continues_bit_for_bit() {
    let folder = Folder::new("state");
    let (state, again) = (folder.path("half.state"), folder.path("whole.state"));
    let whole = synth(&["-", "--save-state", &again], exemplar().as_bytes());
    let half = synth(&["-", "--max-iterations", "2", "--save-state", &state], exemplar().as_bytes());
    assert_ne!(half, whole);
    let resumed = run(&["synth", "--resume", &state, "--threads", "1"], b"");
    assert_eq!((resumed.status.code(), resumed.stderr.as_slice()), (Some(0), &b""[..]));
    assert_eq!(resumed.stdout, whole);
    // A finished run has nothing left to do.
    assert_eq!(run(&["synth", "--resume", &again], b"").stdout, whole);

    refused(&["synth", "--resume", &state, "--seed", "2"], b"", 2, &["--seed", "--resume"]);
    let broken = folder.file("broken.state", "{\"version\": 1}");
    refused(&["synth", "--resume", &broken], b"", 1, &["broken.state", "is not a saved state", "missing field"]);
    let later = fs::read_to_string(&state).unwrap().replacen("\"version\":2", "\"version\":99", 1);
    let later = folder.file("later.state", &later);
    refused(&["synth", "--resume", &later], b"", 1, &["can't be continued", "99"]);
}

#[test]
fn wrong_command_lines_end_with_2() {
    for (arguments, parts) in [
        (&["synth"][..], &["IN"][..]),
        (&["weave"], &["weave"]),
        (&["synth", "-", "--preset", "slow"], &["slow", "balanced"]),
        (&["synth", "-", "--scale", "2y3"], &["\"2y3\" is not a number", "2x3"]),
        (&["synth", "-", "--scale", "9"], &["'expansion-x' is 9", "between 0.25 and 8"]),
        (&["synth", "-", "--domain", "0,0,1"], &["3 numbers", "needs 4"]),
        (&["synth", "-", "--domain", "0,0,0,1"], &["greater than 0"]),
        (&["synth", "-", "--set", "channels"], &["name=value"]),
        (&["synth", "-", "--set", "chanels=8"], &["no parameter 'chanels'", "channels"]),
        (&["synth", "-", "--set", "channels=1000"], &["'channels' is 1000", "between 4 and 160"]),
        (&["synth", "-", "--set", "grid-min=200", "--set", "grid-max=100"], &["'grid-max' is 100", "'grid-min'"]),
        (&["synth", "-", "-o", "out.gif"], &["out.gif", ".csv, .json, .geojson, .svg, .png or .npy"]),
        (&["synth", "-", "--threads", "0"], &["--threads"]),
        (&["synth", "-", "--png-size", "9"], &["--png-size"]),
        (&["synth", "gallery:nothing"], &["no 'nothing'", gallery::entries()[0].name]),
        (&["gallery", "nothing"], &["no 'nothing'"]),
        (&["gallery", "-o", "a.csv"], &["NAME"]),
        (&["gallery", "houses", "--glyph", "house"], &["class=name"]),
        (&["gallery", "houses", "--glyph", "house=hut"], &["no glyph \"hut\"", "disk, ring, square"]),
        (&["gallery", "houses", "--glyph", "house=path:M0 0L9 9 z1"], &["position 11 of the path: '1'"]),
        (&["gallery", "houses", "--glyph", "barn=house"], &["no class 'barn'", "'house', 'tree'"]),
        (&["gallery", "houses", "--palette", "pink"], &["okabe-ito, bright, ink"]),
        (&["synth", "gallery:houses", "--glyph", "barn=house"], &["no class 'barn'", "'house', 'tree'"]),
    ] {
        refused(arguments, b"0.1 0.1\n0.9 0.9\n0.2 0.7", 2, parts);
    }
}

#[test]
fn glyphs_and_colours_can_be_chosen() {
    let drawn = |arguments: &[&str]| {
        let output = run(&[&["gallery", "houses", "--format", "svg"], arguments].concat(), b"");
        assert!(output.status.success(), "{arguments:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    let plain = drawn(&[]);
    assert!(plain.contains("#d55e00") && plain.contains("#009e73") && !plain.contains("<circle"), "{plain:.900}");
    let changed = drawn(&["--glyph", "tree=disk", "--glyph", "house=path:M0 0h8v8z", "--palette", "bright"]);
    assert!(changed.matches("<circle").count() >= 80 && changed.contains("d=\"M-1 -1L1 -1L1 1Z\""), "{changed:.900}");
    assert!(changed.contains("#ee6677") && changed.contains("#228833"));
}

#[test]
fn failures_end_with_1() {
    let folder = Folder::new("failures");
    let (input, missing) = (folder.file("in.csv", "x,y\n0.1,0.2\n0.3,abc\n"), folder.path("missing.csv"));
    let nowhere = folder.path("nowhere/out.csv");
    refused(&["synth", &missing], b"", 1, &["missing.csv", "can't be read"]);
    refused(&["synth", &input], b"", 1, &["in.csv", "line 3, column 2", "\"abc\"", "finite number"]);
    refused(&["synth", "-"], b"0.1 0.2\ninf 0.1", 1, &["standard input", "line 2, column 1"]);
    refused(&["synth", "-"], b"", 1, &["standard input", "no points"]);
    refused(&["synth", "-"], b"0.5 0.5", 1, &["the exemplar can't be used"]);
    refused(&["synth", "-"], &vec![b' '; 20_000_001], 1, &["20000001 bytes", "at most 20000000"]);
    refused(&["synth", "-", "-o", &nowhere], exemplar().as_bytes(), 1, &["nowhere", "folder does not exist"]);
    refused(&["synth", "-", "-o", &nowhere, "--format", "svg"], b"", 1, &["folder does not exist"]);
    refused(&["synth", "-", "--max-memory", "1"], exemplar().as_bytes(), 1, &["MB of memory", "1 MB", "lower"]);
    // What was there before a failure is still there, and nothing else.
    let kept = folder.file("kept.csv", "precious");
    refused(&["synth", &input, "-o", &kept], b"", 1, &["abc"]);
    assert_eq!(fs::read_to_string(&kept).unwrap(), "precious");
    assert_eq!(names(&folder), ["in.csv", "kept.csv"]);
}

#[cfg(unix)]
#[test]
fn writing_respects_links_devices_and_modes() {
    use std::os::unix::fs::{PermissionsExt as _, symlink};
    let folder = Folder::new("links");
    let name = gallery::entries()[0].name;
    let real = folder.file("real.csv", "old");
    fs::set_permissions(&real, fs::Permissions::from_mode(0o640)).unwrap();
    symlink(&real, folder.path("link.csv")).unwrap();
    assert!(run(&["gallery", name, "-o", &folder.path("link.csv")], b"").status.success());
    assert!(fs::symlink_metadata(folder.path("link.csv")).unwrap().is_symlink());
    assert_eq!(fs::read_to_string(&real).unwrap(), exemplar());
    assert_eq!(fs::metadata(&real).unwrap().permissions().mode() & 0o777, 0o640);
    assert!(run(&["gallery", name, "-o", "/dev/null", "--format", "svg"], b"").status.success());
    assert!(!Path::new("/dev/null").is_file());
}

#[test]
fn the_gallery_lists_and_exports() {
    let list = String::from_utf8(run(&["gallery"], b"").stdout).unwrap();
    assert_eq!(list.lines().count(), gallery::entries().len());
    for (line, entry) in list.lines().zip(gallery::entries()) {
        assert!(line.starts_with(entry.name) && line.ends_with(entry.caption), "{line}");
        assert!(line.contains(&format!("{} points", entry.exemplar().len())), "{line}");
    }
    let entry = gallery::entries()[1];
    assert_eq!(pattern(&run(&["gallery", entry.name], b"").stdout), entry.exemplar());
    let other = run(&["gallery", entry.name, "--seed", "12", "--format", "json"], b"");
    assert_eq!(pattern(&other.stdout), entry.generate(12));
}

#[test]
fn arrays_and_drawings_go_in_and_arrays_come_out() {
    let folder = Folder::new("arrays");
    let csv = folder.file("in.csv", &exemplar());
    let array = folder.path("out.npy");
    synth(&[&csv, "-o", &array], b"");
    let result = fs::read(&array).unwrap();
    assert!(result.starts_with(b"\x93NUMPY"));
    assert_eq!(pattern(&result).positions(), pattern(&synth(&[&csv], b"")).positions());
    let result_len = pattern(&result).len();
    // An archive of x and y is an exemplar too.
    let columns: [Vec<f64>; 2] = {
        let source = pattern(exemplar().as_bytes());
        [0, 1].map(|axis| source.positions().iter().map(|point| point[axis]).collect())
    };
    let entries = columns.map(|values| {
        let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({},), }}\n", values.len());
        let numbers: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        [&b"\x93NUMPY\x01\x00"[..], &(header.len() as u16).to_le_bytes(), header.as_bytes(), &numbers].concat()
    });
    let archive = folder.path("in.npz");
    fs::write(&archive, zip::zip(&[("x.npy", &entries[0]), ("y.npy", &entries[1])], zip::Packed::Deflated)).unwrap();
    synth(&[&archive, "--boundary", "open", "-o", &array], b"");
    assert_eq!(pattern(&fs::read(&array).unwrap()).len(), result_len);
    // A drawing of the exemplar is an exemplar, in its own unit.
    let name = gallery::entries()[0].name;
    for file in ["in.svg", "in.npy"] {
        let file = folder.path(file);
        assert!(run(&["gallery", name, "-o", &file], b"").status.success());
        let count = pattern(exemplar().as_bytes()).len();
        assert_eq!(pattern(&fs::read(&file).unwrap()).len(), count, "{file}");
        assert_eq!(pattern(&synth(&[&file, "--scale", "1"], b"")).len(), count, "{file}");
    }
    // A picture has lost what goes on beyond the border of a tile, but not what lies within.
    let picture = folder.path("in.png");
    assert!(run(&["gallery", "blue-noise", "-o", &picture], b"").status.success());
    let (seen, there) =
        (pattern(&fs::read(&picture).unwrap()).len(), gallery::find("blue-noise").unwrap().exemplar().len());
    assert!(seen >= there && seen < there + there / 2, "{seen} blobs of {there} points");
}

#[test]
fn links_are_written_and_read() {
    let output = run(
        &["link", "encode", "gallery:rings", "--seed", "7", "--scale", "3x2", "--base", "https://example.org/"],
        b"",
    );
    let link = String::from_utf8(output.stdout).unwrap();
    assert_eq!(link, "https://example.org/#v=1&preset=fast&expansion-x=3&seed=7&exemplar=rings\n");
    let read = run(&["link", "decode", link.trim()], b"");
    assert_eq!(pattern(&read.stdout), gallery::find("rings").unwrap().exemplar());
    let words = String::from_utf8_lossy(&read.stderr);
    assert!(words.contains("seed 7") && words.contains("preset fast"), "{words}");

    let own = run(&["link", "encode", "-", "--domain", "0,0,4,2"], b"1 1\n3 2\n0 0\n");
    let link = String::from_utf8(own.stdout).unwrap();
    assert!(link.starts_with("#v=1&preset=fast&domain=0,0,4,2&points="), "{link}");
    let back = pattern(&run(&["link", "decode", &link, "--format", "json"], b"").stdout);
    assert_eq!((back.len(), back.domain().max().to_array()), (3, [4.0, 2.0]));
    refused(&["link", "decode", "v=1&points=AAAA"], b"", 1, &["points can't be read"]);
    refused(&["link", "encode", "gallery:rings", "--set", "channels=1"], b"", 2, &["between 4 and 160"]);
}

#[test]
fn a_project_continues_as_the_very_same_run() {
    let folder = Folder::new("project");
    let input = folder.file("in.csv", &exemplar());
    let state = folder.path("half.state");
    let half = synth(&[&input, "--max-iterations", "4", "--save-state", &state], b"");
    let project = Project {
        title: "Half".to_owned(),
        output: Some(pattern(&half)),
        state: Some(fs::read_to_string(&state).unwrap()),
        ..Project::default()
    };
    let text = write_project(&pattern(exemplar().as_bytes()), &project).unwrap();
    let project = folder.file("half.json", &text);
    let resume = |from: &str| {
        let output = run(&["synth", "--resume", from, "--threads", "1"], b"");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        output.stdout
    };
    assert_eq!(resume(&project), resume(&state));
    assert_ne!(resume(&project), half, "there was something left to do");
    // As an exemplar it is the exemplar.
    assert_eq!(pattern(text.as_bytes()), pattern(exemplar().as_bytes()));
    let bare = folder.file("bare.json", &write_project(&pattern(exemplar().as_bytes()), &Project::default()).unwrap());
    refused(&["synth", "--resume", &bare], b"", 1, &["holds no run"]);
}

#[test]
fn help_teaches() {
    for (arguments, parts) in [
        (&["--help"][..], &["Examples:", "Exit codes:", "gallery:rings"][..]),
        (&["help", "synth"], &["--scale", "Examples:", "sigma-fine-divisor", "# domain x0 y0 x1 y1", "0.25 to 8"]),
        (&["gallery", "--help"], &["Examples:"]),
    ] {
        let output = run(arguments, b"");
        // Lines are broken as the terminal is wide.
        let text = String::from_utf8_lossy(&output.stdout).split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(output.status.code(), Some(0));
        for part in parts {
            assert!(text.contains(part), "{arguments:?} without {part:?}:\n{text}");
        }
    }
    let version = run(&["--version"], b"").stdout;
    assert_eq!(String::from_utf8_lossy(&version).trim(), format!("pointweave {}", env!("CARGO_PKG_VERSION")));
}

/// What a table, a GeoJSON file and a link from strangers say on standard error, and how that is silenced or refused.
#[test]
fn readers_are_heard() {
    let folder = Folder::new("readers");
    let rows: String = (0..30)
        .map(|i| {
            format!(
                "t{i};{};{};{};0,{i}\n",
                691_200 + i % 6 * 9 + i % 4,
                5_334_100 + i / 6 * 8 + i % 3,
                ["oak", "elm"][i % 2]
            )
        })
        .collect();
    let table = folder.file("trees.csv", &format!("name;easting;northing;species;crown_m\n{rows}"));
    let said = |arguments: &[&str]| {
        let output = run(arguments, b"");
        let words = String::from_utf8(output.stderr).unwrap();
        (output.status.code(), words, String::from_utf8_lossy(&output.stdout).into_owned())
    };
    let tiny = |arguments: &[&str]| said(&[&["synth"], arguments, &TINY[..]].concat());
    let (code, words, csv) = tiny(&[&table]);
    assert_eq!(code, Some(0), "{words}");
    assert!(
        words.starts_with("pointweave: '") && words.contains("text: name") && words.lines().count() == 1,
        "{words}"
    );
    assert!(csv.contains("\neasting,northing,species,crown_m\n"), "{csv:.200}");
    assert_eq!(tiny(&[&table, "--quiet"]), (Some(0), String::new(), csv), "the same, in silence");
    for command in [&["analyze", &table][..], &["link", "encode", &table]] {
        assert_eq!(said(command).1, words, "every command that reads says so");
        assert_eq!(said(&[command, &["-q"]].concat()).1, "");
        let (code, words, _) = said(&[command, &["--strict"]].concat());
        assert!(code == Some(1) && words.contains("refused by --strict") && words.contains("text: name"), "{words}");
    }
    // Columns by name and by number; what is chosen is said no more.
    let chosen = ["--columns", "x=easting,y=3,class=,radius=crown_m", "--columns", "height=5"];
    assert!(tiny(&[&[table.as_str()], &chosen[..]].concat()).1.contains("chosen twice"));
    let (code, _, csv) = tiny(&[&table, "--columns", "x=easting,y=3,class=,radius=crown_m"]);
    assert!(code == Some(0) && csv.contains("\neasting,northing,crown_m\n"), "{csv:.200}");
    refused(&["analyze", &table, "--columns", "x=west"], b"", 1, &["\"west\"", "name, easting, northing"]);
    refused(&["analyze", &table, "--columns", "easting"], b"", 2, &["'what=column'"]);
    refused(&["analyze", &table, "--columns", "x=1,x=2"], b"", 2, &["'x' is both '1' and '2'"]);

    // GeoJSON leaves as GeoJSON, beside where it came from.
    let features: String = (0..30)
        .map(|i| {
            let at = [10.7 + f64::from(i % 6 * 9 + i % 4) * 1e-5, 60.0 + f64::from(i / 6 * 8 + i % 3) * 1e-5];
            format!("{{\"type\": \"Feature\", \"properties\": {{\"Kind\": \"a\", \"h\": {i}}}, \"geometry\": {{\"type\": \"Point\", \"coordinates\": {at:?}}}}}\n")
        })
        .collect();
    let source = folder.file("trees.geojson", &features);
    let out = folder.path("more.geojson");
    let (code, words, _) = tiny(&[&source, "-o", &out]);
    assert!(code == Some(0) && words.contains("became metres about 60."), "{words}");
    let (code, words, _) = tiny(&[&source, "--no-projection", "--format", "csv", "-o", &folder.path("planar.csv")]);
    assert!(code == Some(0) && words.contains("Degrees were taken as they are"), "{words}");
    let result: serde_json::Value = serde_json::from_slice(&fs::read(&out).unwrap()).unwrap();
    let list = result["features"].as_array().unwrap();
    assert_eq!(list.len(), 120);
    for feature in list {
        let at = &feature["geometry"]["coordinates"];
        assert!((10.699..10.702).contains(&at[0].as_f64().unwrap()), "twice as wide: {at}");
        assert!((59.999..60.002).contains(&at[1].as_f64().unwrap()), "twice as high: {at}");
        assert!(feature["properties"]["h"].is_number());
    }
    assert_eq!(said(&["analyze", &source, &out, "-q"]).0, Some(0), "both can be held against each other");

    let (code, words, _) = said(&["link", "decode", "v=1&amp;preset=balanced&amp;seed=7&amp;exemplar=chevrons."]);
    assert!(
        code == Some(0) && words.contains("mended") && words.contains("seed 7") && words.contains("balanced"),
        "{words}"
    );
    refused(&["link", "decode", "v=1&preset=fast&seed=7"], b"", 1, &["names no exemplar and holds no points"]);
}
