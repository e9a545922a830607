//! `pointweave analyze`: the real binary, its table, its JSON, its picture, and what it says when it refuses.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

#[path = "common/program.rs"]
mod program;

use std::fs;
use std::process::Output;

use glam::DVec2;
use pointweave::analysis::{Cloud, tile};
use pointweave::formats::write_csv;
use pointweave::sampling::{Purpose, Rng, white_noise};
use pointweave::{Boundary, Domain, PointPattern, gallery};
use program::Folder;

fn run(arguments: &[&str], input: &[u8]) -> Output {
    program::run(&[&["analyze"], arguments].concat(), input)
}

/// Runs what must succeed in silence; returns standard output.
#[track_caller]
fn says(arguments: &[&str], input: &[u8]) -> String {
    let output = run(arguments, input);
    let words = String::from_utf8_lossy(&output.stderr);
    assert_eq!((output.status.code(), &*words), (Some(0), ""), "{arguments:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// The command must end with `code` and say all of `parts`, with nothing on standard output.
#[track_caller]
fn refused(arguments: &[&str], input: &[u8], code: i32, parts: &[&str]) {
    let output = run(arguments, input);
    let words = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {words}");
    assert!(output.stdout.is_empty());
    for part in parts {
        assert!(words.contains(part), "{arguments:?}\n  says    {words:?}\n  without {part:?}");
    }
}

/// An exemplar and an output of twice its width and height: tiled, or chance.
fn sides(name: &str, chance: bool) -> [String; 2] {
    let exemplar = gallery::find(name).unwrap().exemplar();
    let cloud = Cloud::of(&exemplar);
    let size = 2.0 * cloud.size();
    let mut places = tile(&cloud, size, Boundary::Periodic).unwrap().points().to_vec();
    if chance {
        places = white_noise(&mut Rng::new(3, Purpose::Gallery), size, places.len());
    }
    let output = PointPattern::new(Domain::new(DVec2::ZERO, size).unwrap(), places).unwrap();
    [write_csv(&exemplar), write_csv(&output.with_boundary(Boundary::Periodic))]
}

#[test]
fn one_pattern_is_described() {
    let table = says(&["gallery:hex"], b"");
    assert!(table.starts_with("The 100 points stand like a lattice"), "{table}");
    for part in
        ["relative radius ρ                             1.0000", "neighbour 6: mean", "Ripley's L against chance"]
    {
        assert!(table.contains(part), "{table}\nwithout {part}");
    }
    assert!(!table.contains("quality"));
    let json: serde_json::Value = serde_json::from_str(&says(&["gallery:hex", "--json"], b"")).unwrap();
    assert!((json["analysis"]["relative_radius"].as_f64().unwrap() - 1.0).abs() < 1e-9);
    assert_eq!(json["analysis"]["pair_correlation"]["value"].as_array().unwrap().len(), 100);
    assert_eq!(json["analysis"]["boundary"], "periodic");
    assert!(json["verdict"].as_str().unwrap().starts_with("The 100 points"));
    // What the file declares can be overruled: a window of a lattice has a border.
    let open = says(&["gallery:hex", "--boundary", "open", "--json"], b"");
    let open: serde_json::Value = serde_json::from_str(&open).unwrap();
    assert_eq!(open["analysis"]["boundary"], "open");
    assert!(open["analysis"]["border"]["expected"].as_f64().unwrap() > 0.0);
}

#[test]
fn an_output_is_judged() {
    let folder = Folder::new("judged");
    let score = |[exemplar, output]: [String; 2]| {
        let a = folder.file("a.csv", &exemplar);
        let table = says(&[&a, "-"], output.as_bytes());
        let json: serde_json::Value = serde_json::from_str(&says(&[&a, "-", "--json"], output.as_bytes())).unwrap();
        let verdict = json["verdict"].as_str().unwrap().to_owned();
        assert!(table.starts_with(&verdict), "{table}");
        for part in ["exemplar", "output", "arrangement", "detail", "variety", "Chamfer", "Wasserstein"] {
            assert!(table.contains(part), "{table}\nwithout {part}");
        }
        let score = json["comparison"]["quality"]["score"].as_f64().unwrap();
        assert!(table.contains(&format!("{:<36}{score:>12.3}", "all")), "{table}");
        (score, verdict)
    };
    let (best, words) = score(sides("chevrons", false));
    assert!((best - 1.0).abs() < 1e-6 && words.contains("as good as a copy"), "{best} {words}");
    let (chance, words) = score(sides("chevrons", true));
    assert!(chance.abs() < 0.15 && words.contains("hardly"), "{chance} {words}");
    // The seed is that of what they are compared with: other noise, a slightly other zero.
    let [exemplar, output] = sides("chevrons", true);
    let a = folder.file("a.csv", &exemplar);
    let once = says(&[&a, "-", "--json"], output.as_bytes());
    assert_eq!(once, says(&[&a, "-", "--json", "--seed", "1"], output.as_bytes()));
    assert_ne!(once, says(&[&a, "-", "--json", "--seed", "2"], output.as_bytes()));
}

#[test]
fn a_report_is_drawn() {
    let folder = Folder::new("report");
    let [exemplar, output] = sides("rings", true);
    let (a, b) = (folder.file("a & b.csv", &exemplar), folder.file("out.csv", &output));
    let report = folder.path("report.svg");
    let table = says(&[&a, &b, "--svg", &report], b"");
    assert!(table.contains("quality"));
    let svg = fs::read_to_string(&report).unwrap();
    assert!(svg.starts_with("<svg xmlns") && svg.ends_with("</svg>\n"));
    for part in [
        "<title>out.csv against its exemplar a &amp; b.csv</title>",
        "Pair correlation",
        "Distance to the nearest neighbour",
        "Radial periodogram",
        "Ripley’s L",
        "Where neighbours lie",
        "mean spacing d",
        "fill=\"#0072b2\"",
        "fill=\"#d55e00\"",
    ] {
        assert!(svg.contains(part), "no {part}");
    }
    assert_eq!(svg.matches("data:image/png;base64,").count(), 4);
    assert!(svg.matches("<circle").count() >= 60 + 240);
    assert!(!svg.contains("NaN") && !svg.contains("inf\""));
    for tag in ["<g", "<text", "<clipPath"] {
        let close = format!("</{}>", &tag[1..]);
        let opened = svg.matches(&format!("{tag} ")).count() + svg.matches(&format!("{tag}>")).count();
        assert_eq!(opened, svg.matches(&close).count(), "{tag}");
    }
    assert!(svg.len() < 400_000, "{}", svg.len());
    // One pattern alone, several classes, an open border.
    let classes = "x,y,class\n0.1,0.2,oak\n0.5,0.4,elm\n0.8,0.9,oak\n0.3,0.7,elm\n0.6,0.1,oak\n";
    says(&["-", "--svg", &report, "--json", "--quiet"], classes.as_bytes());
    let svg = fs::read_to_string(&report).unwrap();
    assert!(svg.contains("<title>Point pattern: standard input</title>"));
    assert_eq!(svg.matches("data:image/png;base64,").count(), 2);
    assert!(svg.contains(">oak</text>") && svg.contains(">elm</text>") && svg.contains("fill=\"#0072b2\""));
}

#[test]
fn classes_and_attributes_are_held_against_chance() {
    let folder = Folder::new("marks");
    let report = folder.path("report.svg");
    let table = says(&["gallery:meadow", "gallery:meadow", "--svg", &report], b"");
    for part in
        ["at random", "pairs of tree, bush", "all pairs of classes", "mark correlation of scale", "all attributes"]
    {
        assert!(table.contains(part), "{table}\nwithout {part}");
    }
    let svg = fs::read_to_string(&report).unwrap();
    for part in
        ["Classes and attributes", "tree among themselves", "tree and bush", "Mark correlation: depth", "× 1000"]
    {
        assert!(svg.contains(part), "no {part}");
    }
    assert!(!svg.contains("NaN") && !svg.contains("inf\""));
    let json = says(&["gallery:boats", "gallery:boats", "--json"], b"");
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let one = &json["comparison"]["marks"]["attributes"][0];
    assert!(one["name"] == "orientation" && one["error"]["error"] == 0.0, "{one}");
    assert!(one["error"]["random"].as_f64().unwrap() > 0.05, "{one}");
    let curve = &json["comparison"]["output"]["mark_correlations"][0]["correlation"];
    assert!(curve["function"] == "direction" && curve["value"].as_array().unwrap().len() == 100, "{curve}");
    // One class and no attribute: nothing to say.
    assert!(!says(&["gallery:hex", "gallery:hex"], b"").contains("at random"));
    let alone = says(&["gallery:grove", "--svg", &report], b"");
    assert!(!alone.contains("at random"), "{alone}");
    assert!(fs::read_to_string(&report).unwrap().contains("Mark correlation: radius"));
}

#[test]
fn what_can_not_be_analysed_is_refused() {
    let folder = Folder::new("refused");
    let good = folder.file("good.csv", "0.1 0.1\n0.9 0.9\n0.2 0.7\n");
    refused(&[], b"", 2, &["<A>"]);
    refused(&["-", "-"], b"0 0", 2, &["both be standard input"]);
    refused(&["gallery:nothing"], b"", 2, &["no 'nothing'"]);
    refused(&[&good, "--output-domain", "0,0,1,1"], b"", 2, &["<B>"]);
    refused(&[&good, "--seed", "x"], b"", 2, &["--seed"]);
    refused(&["-"], b"0.5 0.5", 1, &["standard input can't be analysed", "at least 2 points, but there are 1"]);
    refused(&["-"], b"0.5 0.5\n0.5 0.5\n", 1, &["all 2 points lie in one place"]);
    refused(&[&good, "-"], b"0.5 0.5", 1, &["good.csv and standard input can't be compared"]);
    refused(&[&folder.path("missing.csv")], b"", 1, &["missing.csv", "can't be read"]);
    refused(&[&good, "--svg", &folder.path("no/where.svg")], b"", 1, &["folder does not exist"]);
    let help = says(&["--help"], b"");
    for part in ["Examples:", "gallery:NAME", "--json", "--svg", "1 for A tiled"] {
        assert!(help.contains(part), "{help}\nwithout {part}");
    }
}

/// Independent points in a round field of view are not called clustered: as it shows, as a file says, and as an outline says.
#[test]
fn windows_that_are_no_rectangles() {
    let folder = Folder::new("windows");
    // A quarter of the way round the golden angle and a fixed shuffle of radii: uniform in the disk, and no lattice.
    let mut state = 7_u64;
    let mut chance = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(1_u32 << 31)
    };
    let mut rows = String::from("x,y\n");
    for _ in 0..200 {
        let (radius, angle) = (100.0 * chance().sqrt(), std::f64::consts::TAU * chance());
        rows += &format!("{},{}\n", 300.0 + radius * angle.cos(), 300.0 + radius * angle.sin());
    }
    let table = folder.file("cells.csv", &rows);
    let corner = |i: i32| {
        let angle = std::f64::consts::TAU * f64::from(i % 64) / 64.0;
        format!("[{}, {}]", 300.0 + 101.0 * angle.cos(), 300.0 + 101.0 * angle.sin())
    };
    let ring: Vec<String> = (0..=64).map(corner).collect();
    let polygon = format!("{{\"type\": \"Polygon\", \"coordinates\": [[{}]]}}", ring.join(", "));
    let outline = folder.file("outline.geojson", &polygon);
    let index = |words: &str| -> f64 {
        let line = words.lines().find(|line| line.starts_with("Clark–Evans")).unwrap();
        line.split_whitespace().last().unwrap().parse().unwrap()
    };
    let shown = says(&[&table], b"");
    assert!(shown.contains("fill a round or otherwise convex part") && !shown.contains("gather in groups"), "{shown}");
    let told = says(&[&table, "--window", &outline], b"");
    assert!(!told.contains("gather in groups") && (0.9..1.15).contains(&index(&told)), "{told}");
    // In the whole rectangle they do seem to gather: what the window is for.
    let square = folder.file("square.csv", "x,y\n150,150\n450,150\n450,450\n150,450\n");
    let whole = says(&[&table, "--window", &square], b"");
    assert!(index(&whole) < 0.75, "{whole}");
    // Points outside are said.
    let half = folder.file("half.csv", "x,y\n300,150\n450,150\n450,450\n300,450\n");
    let output = run(&[&table, "--window", &half], b"");
    let words = String::from_utf8(output.stderr).unwrap();
    assert!(
        output.status.success() && words.contains("points lie outside of the window and had to be left out"),
        "{words}"
    );
    refused(&[&table, "--window", &folder.path("none.geojson")], b"", 1, &["none.geojson"]);
    refused(&[&table, "--window", &folder.file("line.csv", "1,2\n3,4\n")], b"", 1, &["line.csv", "at least 3"]);
}
