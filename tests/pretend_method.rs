//! A method is offered by its description alone: the pretend method of `src/methods/jitter.rs`, which nothing but the
//! list of methods names, can be run, linked, saved and continued like any other.
#![cfg(feature = "pretend-method")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail loudly")]

use std::fs;
use std::process::{Command, Output};

use pointweave::formats::link::{Link, LinkExemplar, read_link, write_link};
use pointweave::formats::{ReadOptions, open};
use pointweave::methods::{self, Method};
use pointweave::run::{Event, Plan};
use pointweave::web::Session;
use pointweave::{PointPattern, gallery};
use serde_json::{Map, Value, json};

fn command(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_pointweave")).args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn read(csv: &[u8]) -> PointPattern {
    open(csv, None, &ReadOptions::default()).unwrap().pattern
}

fn overrides(value: Value) -> Map<String, Value> {
    value.as_object().unwrap().clone()
}

#[test]
fn the_command_line_offers_it() {
    let help = text(&command(&["help", "synth"]).stdout);
    assert!(help.contains("Every point takes random steps"), "{help}");
    assert!(help.contains("Parameters of 'jitter' for --set") && help.contains("  stride [0 to 0.5; 0.02]"), "{help}");

    let out = command(&["synth", "gallery:rings", "--method", "jitter", "--set", "walks=3", "--seed", "7", "-q"]);
    assert!(out.status.success(), "{}", text(&out.stderr));
    assert_eq!(read(&out.stdout).len(), 4 * gallery::find("rings").unwrap().exemplar().len());
    // Negative control: other parameters, other points.
    let other = command(&["synth", "gallery:rings", "--method", "jitter", "--set", "walks=4", "--seed", "7", "-q"]);
    assert_ne!(out.stdout, other.stdout);

    for (arguments, words) in [
        (["--method", "jitter", "--set", "channels=8"], "no parameter 'channels'; there are boundary, expansion-x"),
        (["--method", "jitter", "--set", "stride=2"], "'stride' is 2, but must lie between 0 and 0.5"),
        (["--method", "jitter", "--preset", "paper"], "'preset' is \"paper\", but must be one of quick"),
        (["--method", "network", "--preset", "quick"], "fast, balanced, best, paper"),
    ] {
        let refused = command(&[&["synth", "gallery:rings"], &arguments[..]].concat());
        assert_eq!(refused.status.code(), Some(2), "{arguments:?}");
        assert!(text(&refused.stderr).contains(words), "{}", text(&refused.stderr));
    }
}

#[test]
fn a_saved_run_finds_its_method_again() {
    let file = std::env::temp_dir().join(format!("pointweave-jitter-{}.state", std::process::id()));
    let state = file.to_str().unwrap();
    let start = ["synth", "gallery:rings", "--method", "jitter", "-q"];
    let whole = command(&start);
    let part = command(&[&start[..], &["--max-iterations", "2", "--save-state", state]].concat());
    assert!(part.status.success() && part.stdout != whole.stdout, "{}", text(&part.stderr));
    assert!(fs::read_to_string(&file).unwrap().starts_with(r#"{"method":"jitter","version":1,"#));
    let rest = command(&["synth", "--resume", state, "-q"]);
    fs::remove_file(&file).unwrap();
    assert_eq!(text(&rest.stdout), text(&whole.stdout), "{}", text(&rest.stderr));
}

#[test]
fn links_name_it() {
    let exemplar = LinkExemplar::named("rings").unwrap();
    let overrides = overrides(json!({ "walks": 9, "stride": 0.02 }));
    let link = Link { method: Method::Jitter, exemplar, preset: "quick".to_owned(), overrides, notes: Vec::new() };
    let fragment = write_link(&link).unwrap().fragment;
    assert_eq!(fragment, "v=2&method=jitter&preset=quick&walks=9&exemplar=rings");
    let read = read_link(&fragment).unwrap();
    assert_eq!((read.method, &read.overrides["walks"]), (Method::Jitter, &json!(9)));
    let moved = read_link("v=2&method=jitter&preset=quick&stride=7&channels=8&exemplar=rings").unwrap();
    assert_eq!(Value::Object(moved.overrides), json!({ "stride": 0.5 }));
    assert_eq!(moved.notes.len(), 1, "another method's parameters belong to others: {:?}", moved.notes);
    assert!(read_link("v=2&method=jitter&preset=fast").is_err());

    let encoded = command(&["link", "encode", "gallery:rings", "--method", "jitter", "--set", "walks=9"]);
    assert_eq!(text(&encoded.stdout).trim(), format!("#{fragment}"));
    let decoded = command(&["link", "decode", &fragment]);
    assert!(text(&decoded.stderr).contains("method jitter") && text(&decoded.stderr).contains("walks 9"));
}

#[test]
fn the_page_s_session_runs_it() {
    let mut session = Session::new();
    let mut ask = |request: Value| -> Value {
        let kind = request["type"].as_str().unwrap().to_owned();
        let request = serde_json::from_value(json!({ kind: request })).unwrap();
        serde_json::to_value(session.handle(request, &|| 0.0)).unwrap()
    };
    let described = ask(json!({ "type": "describe" }));
    let names: Vec<&Value> = described["methods"].as_array().unwrap().iter().map(|method| &method["name"]).collect();
    assert_eq!(names, ["network", "jitter"]);

    let exemplar = json!({ "source": "gallery", "name": "rings" });
    let started = ask(
        json!({ "type": "start", "exemplar": exemplar, "method": "jitter", "preset": "quick", "overrides": { "walks": 2.0 } }),
    );
    assert_eq!((&started["type"], &started["method"]), (&json!("started"), &json!("jitter")), "{started}");
    let step = ask(json!({ "type": "run", "budgetMs": 1, "maxIterations": 1 }));
    assert_eq!(step["events"][0]["losses"], json!([{ "name": "unrest", "value": 1.0 }]), "{step}");
    let pinned = ask(json!({ "type": "touch", "points": [5], "positions": [0.5, 0.25], "pinned": true }));
    assert_eq!(pinned["points"]["pinned"], json!([5]), "{pinned}");
    let refused = ask(json!({ "type": "resynthesize", "region": [0, 0, 2, 0, 2, 2] }));
    assert!(refused["message"].as_str().unwrap().contains("'jitter' can't do this"), "{refused}");
    let other = ask(json!({ "type": "continue", "method": "network", "preset": "fast" }));
    assert!(other["message"].as_str().unwrap().contains("needs another start"), "{other}");
    let state = ask(json!({ "type": "save" }))["state"].clone();
    let resumed = ask(json!({ "type": "resume", "state": state }));
    assert_eq!((&resumed["method"], &resumed["progress"]["totalIterations"]), (&json!("jitter"), &json!(1)));
    let done = ask(json!({ "type": "run", "budgetMs": 1000, "maxIterations": 100 }));
    assert_eq!(done["finished"], json!(true), "{done}");
}

#[test]
fn the_library_runs_it() {
    let exemplar = gallery::find("rings").unwrap().exemplar();
    let plan = Plan { exemplar, preset: "quick".to_owned(), overrides: Map::new() };
    let mut run = Method::Jitter.start(plan, 1).unwrap();
    let before = run.canvas().points().to_vec();
    let mut iterations = 0;
    while run.advance_by(u32::MAX).unwrap() != Event::Finished {
        iterations += 1;
    }
    assert_eq!(iterations, 5);
    assert!(run.canvas().points().iter().zip(&before).all(|(after, before)| after != before));
    let again = methods::resume(&run.state().unwrap(), 1).unwrap();
    assert_eq!(again.canvas().points(), run.canvas().points());
}
