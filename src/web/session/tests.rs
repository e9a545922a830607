//! What the page asks of a session and what it gets.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may stop at the first surprise")]

use std::cell::Cell;

use serde_json::json;

use super::*;
use crate::analysis::{Comparison, verdict};
use crate::web::protocol::EngineChoice;

/// Answers through JSON both ways, as the page would see it, with a clock that ticks 1 ms a look.
fn ask(session: &mut Session, request: Value) -> Value {
    let clock = Cell::new(0.0);
    let now = || {
        clock.set(clock.get() + 1.0);
        clock.get()
    };
    let kind = request["type"].as_str().unwrap().to_owned();
    let request = serde_json::from_value(json!({ kind: request })).unwrap();
    let response = session.handle(request, &now);
    serde_json::to_value(response).unwrap()
}

fn tiny(seed: u64) -> Value {
    json!({
        "type": "start",
        "exemplar": { "source": "gallery", "name": "rings" },
        "preset": "fast",
        "overrides": {
            "expansion-x": 1.0, "expansion-y": 1.5, "channels": 4.0, "grid-min": 16, "grid-max": 16,
            "iterations-coarse": 3, "iterations-fine": 2, "iterations-polish": 1, "convergence-window": 5000, "seed": seed,
            "boundary": "open",
        },
    })
}

/// An exemplar of one class.
fn own(domain: [f64; 4], positions: &[f64]) -> Value {
    json!({
        "source": "pattern", "name": "mine",
        "pattern": {
            "domain": domain, "boundary": "open", "positions": positions, "classes": vec![0; positions.len() / 2],
            "classNames": ["points"], "attributes": [],
        },
    })
}

fn exported(session: &mut Session) -> PointPattern {
    let answer = ask(session, json!({ "type": "export" }));
    let data: crate::web::pattern_data::PatternData = serde_json::from_value(answer["pattern"].clone()).unwrap();
    PointPattern::try_from(data).unwrap()
}

fn run(session: &mut Session, iterations: u32) -> Value {
    ask(session, json!({ "type": "run", "budgetMs": 1e9, "maxIterations": iterations }))
}

/// Runs until it is done: a batch is never longer than a second, and the tests' clock moves at every look.
fn run_to_the_end(session: &mut Session) -> Value {
    loop {
        let batch = run(session, u32::MAX);
        assert_eq!(batch["type"], "batch", "{batch}");
        if batch["finished"] == json!(true) {
            return batch;
        }
    }
}

fn iterated(batch: &Value) -> usize {
    batch["events"].as_array().unwrap().iter().filter(|event| event["type"] == "iterated").count()
}

#[test]
fn the_gallery_is_complete_and_inside_its_squares() {
    let mut session = Session::new();
    let answer = ask(&mut session, json!({ "type": "gallery" }));
    let entries = answer["entries"].as_array().unwrap();
    assert_eq!(entries.len(), gallery::entries().len());
    for entry in entries {
        let points = &entry["pattern"]["points"];
        let (positions, classes) = (points["positions"].as_array().unwrap(), points["classes"].as_array().unwrap());
        assert_eq!(positions.len(), 2 * classes.len());
        assert!(positions.iter().all(|value| (0.0..=1.0).contains(&value.as_f64().unwrap())), "{entry}");
    }
}

#[test]
fn the_description_covers_every_method_with_its_presets_and_parameters() {
    let answer = ask(&mut Session::new(), json!({ "type": "describe" }));
    assert_eq!(answer["methods"].as_array().unwrap().len(), Method::ALL.len());
    let method = &answer["methods"][0];
    let description = Method::ALL[0].definition().describe();
    assert_eq!((&method["name"], &method["title"]), (&json!("network"), &json!("Network")));
    assert_eq!(method["presets"].as_array().unwrap().len(), description.presets.len());
    assert_eq!(method["presets"][0]["parameters"]["channels"], json!(32));
    assert_eq!(method["parameters"].as_array().unwrap().len(), description.parameters.len());
    let of = |name: &str| {
        let parameters = method["parameters"].as_array().unwrap();
        parameters.iter().find(|parameter| parameter["name"] == name).unwrap().clone()
    };
    assert_eq!(of("channels")["kind"], json!({ "number": { "min": 4.0, "max": 160.0, "whole": true } }));
    assert_eq!((&of("channels")["place"], &of("seed")["place"]), (&json!("advanced"), &json!("main")));
    assert_eq!(of("boundary")["kind"]["choice"]["options"][1]["name"], "periodic");
    assert_eq!(method["tools"], json!(["move", "pin", "redo-region", "continue", "gpu"]));
    assert_eq!(
        method["losses"],
        json!([{ "name": "gram", "title": "Gram" }, { "name": "correlation", "title": "Correlation" }])
    );
    assert_eq!(
        answer["engine"],
        json!({ "gpu": false, "name": "CPU · SIMD, all cores", "meaning": "The processor of this machine computes" })
    );
}

#[test]
fn a_run_goes_from_start_to_finish() {
    let mut session = Session::new();
    let started = ask(&mut session, tiny(1));
    assert_eq!(started["type"], "started", "{started}");
    let count = started["exemplar"]["points"]["classes"].as_array().unwrap().len();
    let expected = (count as f64 * 1.5).round() as usize;
    assert_eq!(started["output"]["points"]["classes"].as_array().unwrap().len(), expected);
    assert_eq!(started["output"]["size"], json!([1.0, 1.5]));
    assert_eq!(started["parameters"]["channels"], json!(4));

    let step = run(&mut session, 1);
    assert_eq!((step["type"].as_str(), iterated(&step)), (Some("batch"), 1), "{step}");
    assert_eq!(step["progress"]["totalIterations"], json!(1));
    assert!(step["iterationsPerSecond"].as_f64().unwrap() > 0.0);
    assert_ne!(step["points"]["positions"], started["output"]["points"]["positions"]);

    let rest = run(&mut session, u32::MAX);
    assert_eq!(rest["finished"], json!(true));
    assert_eq!(iterated(&rest), 3 + 3 * 2 + 1 - 1);
    assert_eq!(rest["secondsLeft"], json!(0.0));
    let over = run(&mut session, u32::MAX);
    assert_eq!((iterated(&over), &over["finished"]), (0, &json!(true)));

    let output = exported(&mut session);
    assert_eq!(output.len(), expected);
    assert_eq!(output, session.running.as_ref().unwrap().run.canvas().pattern().unwrap());
}

#[test]
fn statistics_are_those_of_the_exported_pattern() {
    let mut session = Session::new();
    let mut request = tiny(3);
    request["overrides"]["boundary"] = json!("periodic");
    ask(&mut session, request);
    let analyze = || json!({ "type": "analyze" });
    let start = ask(&mut session, analyze());
    run(&mut session, 4);
    let answer = ask(&mut session, analyze());
    assert_eq!((&answer["type"], &answer["iterations"]), (&json!("analyzed"), &json!(4)), "{answer}");
    assert_ne!(answer["output"], start["output"]);
    assert_eq!(answer["exemplar"], start["exemplar"]);

    let output = exported(&mut session);
    let exemplar = gallery::find("rings").unwrap().exemplar();
    let expected = Comparison::of(&exemplar, &output, 3).unwrap();
    let list = |value: &Value| -> Vec<f64> { value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect() };
    let same = |found: &Value, wanted: &[f64], factor: f64| {
        let found = list(found);
        assert_eq!(found.len(), wanted.len());
        for (a, b) in found.iter().zip(wanted) {
            assert_eq!(*a, f64::from((b * factor) as f32), "{found:?} {wanted:?}");
        }
    };
    let d = expected.scales.spacing;
    same(&answer["distance"], &expected.output.pair_correlation.radius, 1.0 / d);
    for (side, analysis) in [("exemplar", &expected.exemplar), ("output", &expected.output)] {
        same(&answer[side]["pairCorrelation"], &analysis.pair_correlation.value, 1.0);
        same(&answer[side]["nearest"], &analysis.nearest_histogram.shares, 1.0);
        same(&answer[side]["frequency"], &analysis.spectrum.frequency, d);
        same(&answer[side]["power"], &analysis.spectrum.power, 1.0);
        assert_eq!(answer[side]["relativeRadius"], json!(analysis.relative_radius));
        assert_eq!(answer[side]["spacing"], json!(analysis.nearest[0].mean / d));
    }
    let quality = expected.quality;
    assert_eq!(answer["quality"]["score"], json!(quality.score));
    assert_eq!(answer["quality"]["arrangement"], json!(quality.pair_density));
    assert_eq!(answer["quality"]["detail"], json!(quality.precision));
    assert_eq!(answer["quality"]["variety"], json!(quality.coverage));
    assert_eq!(answer["quality"]["independent"], json!(quality.independent));
    assert_eq!(answer["defects"]["holes"], json!(expected.defects.holes));
    assert_eq!(answer["defects"]["border"], Value::Null, "a tile has no border");
    assert_eq!(answer["verdict"], json!(verdict(&expected)));
    assert!(answer["workMs"].as_f64().unwrap() > 0.0);
}

#[test]
fn another_run_has_another_judge() {
    let mut session = Session::new();
    let analyze = || json!({ "type": "analyze" });
    ask(&mut session, tiny(3));
    let rings = ask(&mut session, analyze());
    let mut request = tiny(3);
    request["exemplar"]["name"] = json!("chevrons");
    ask(&mut session, request);
    let chevrons = ask(&mut session, analyze());
    assert_ne!(rings["exemplar"]["pairCorrelation"], chevrons["exemplar"]["pairCorrelation"]);
    let mut request = tiny(3);
    request["exemplar"] = own([0.0, 0.0, 1.0, 1.0], &[0.5, 0.5, 0.5, 0.5]);
    if ask(&mut session, request)["type"] == "started" {
        let answer = ask(&mut session, analyze());
        assert_eq!(answer["type"], "error");
        assert!(answer["message"].as_str().unwrap().contains("no statistics"), "{answer}");
    }
}

#[test]
fn a_budget_ends_a_batch_before_its_iterations() {
    let mut session = Session::new();
    ask(&mut session, tiny(1));
    let batch = ask(&mut session, json!({ "type": "run", "budgetMs": 0, "maxIterations": 1000 }));
    assert_eq!(batch["finished"], json!(false));
    assert!(batch["events"].as_array().unwrap().len() <= 1, "one piece of work is one event at most: {batch}");
}

#[test]
fn a_saved_run_continues_to_the_same_points() {
    let (mut whole, mut parted) = (Session::new(), Session::new());
    ask(&mut whole, tiny(5));
    ask(&mut parted, tiny(5));
    run(&mut parted, 2);
    let saved = ask(&mut parted, json!({ "type": "save" }));
    assert_eq!(saved["progress"]["totalIterations"], json!(2));
    let mut second = Session::new();
    let resumed = ask(&mut second, json!({ "type": "resume", "state": saved["state"] }));
    assert_eq!((&resumed["type"], &resumed["progress"]["totalIterations"]), (&json!("started"), &json!(2)));
    run(&mut second, 3);
    run(&mut whole, 5);
    assert_eq!(exported(&mut second), exported(&mut whole));
    ask(&mut parted, tiny(6));
    run(&mut parted, 5);
    assert_ne!(exported(&mut parted), exported(&mut whole));
}

/// Needs a Vulkan adapter, as the tests of the engine do.
#[test]
fn a_device_is_taken_over_and_outlives_a_run_that_is_too_large_for_it() {
    let answer = |session: &mut Session, request: Request| {
        serde_json::to_value(pollster::block_on(session.answer(request, &|| 0.0))).unwrap()
    };
    let start = || -> Request { serde_json::from_value(json!({ "start": tiny(1) })).unwrap() };
    let step = || Request::Run { budget_ms: 1.0, max_iterations: 1 };
    let (mut session, mut chooser) = (Session::new(), Session::new());
    answer(&mut session, start());
    let choice = Request::Engine { choice: EngineChoice::Gpu, adapter: None };
    assert_eq!(answer(&mut chooser, choice)["engine"]["gpu"], json!(true));
    session.take_engine(chooser);
    assert_eq!(answer(&mut session, step())["progress"]["totalIterations"], json!(1));

    // As if the run needed more than there is.
    let gpu = session.gpu.clone();
    session.running.as_mut().unwrap().run.use_gpu(gpu, 1);
    let batch = answer(&mut session, step());
    assert_eq!(batch["engine"]["gpu"], json!(false), "{batch}");
    let note = batch["note"].as_str().unwrap();
    assert!(note.ends_with("The processor computes instead.") && note.contains("MB"), "{note}");
    assert_eq!(batch["progress"]["totalIterations"], json!(2));

    answer(&mut session, start());
    let batch = answer(&mut session, step());
    assert_eq!((&batch["engine"]["gpu"], &batch["note"]), (&json!(true), &Value::Null), "{batch}");
}

#[test]
fn points_are_touched_by_their_ids() {
    let mut session = Session::new();
    let mut request = tiny(2);
    // Two classes, placed in the other order than listed.
    request["exemplar"]["name"] = json!("repelling");
    request["overrides"]["class-order"] = json!("most-first");
    let started = ask(&mut session, request);
    assert_eq!(started["type"], "started", "{started}");
    run_to_the_end(&mut session);
    let touch = json!({ "type": "touch", "points": [1, 3], "positions": [0.25, 0.5, 0.75, 1.25], "pinned": true });
    let touched = ask(&mut session, touch);
    assert_eq!((&touched["type"], &touched["finished"]), (&json!("batch"), &json!(true)), "{touched}");
    assert_eq!(touched["points"]["pinned"], json!([1, 3]));
    let places = touched["points"]["positions"].as_array().unwrap();
    assert_eq!([&places[2], &places[3], &places[6], &places[7]], [0.25, 0.5, 0.75, 1.25]);

    let region = json!({ "type": "resynthesize", "region": [0.0, 0.0, 0.5, 0.0, 0.5, 0.8, 0.0, 0.8] });
    let redone = ask(&mut session, region);
    assert_eq!((&redone["finished"], &redone["progress"]["redoing"]), (&json!(false), &json!(true)), "{redone}");
    let rest = run_to_the_end(&mut session);
    assert_eq!((&rest["finished"], &rest["progress"]["redoing"]), (&json!(true), &json!(false)), "{rest}");
    let before: Vec<Vec<f64>> =
        serde_json::from_value(places.chunks(2).map(|place| json!(place)).collect::<Value>()).unwrap();
    let after = rest["points"]["positions"].as_array().unwrap();
    let (mut same, mut other) = (0, 0);
    for (place, now) in before.iter().zip(after.chunks(2)) {
        let inside = place[0] < 0.5 && place[1] < 0.8 && place != &[0.25, 0.5];
        *(if json!(place) == json!(now) { &mut same } else { &mut other }) += 1;
        assert_eq!(json!(place) != json!(now), inside, "{place:?} {now:?}");
    }
    assert!(same > 5 && other > 5, "{same} {other}");

    let overrides = |expansion: f64| {
        json!({
            "expansion-x": 1.0, "expansion-y": expansion, "channels": 8.0, "grid-min": 16, "grid-max": 16,
            "iterations-fine": 2, "seed": 9, "boundary": "open", "class-order": "most-first",
        })
    };
    let request = json!({ "type": "continue", "preset": "fast", "overrides": overrides(1.5) });
    let continued = ask(&mut session, request);
    assert_eq!(
        (&continued["type"], &continued["parameters"]["channels"]),
        (&json!("started"), &json!(8)),
        "{continued}"
    );
    assert_eq!(continued["output"]["points"], rest["points"], "it starts from what is there");
    let request = json!({ "type": "continue", "preset": "fast", "overrides": overrides(2.0) });
    let refused = ask(&mut session, request);
    assert!(refused["message"].as_str().unwrap().contains("another size needs another start"), "{refused}");
}

#[test]
fn refusals_say_why_and_leave_the_run_alone() {
    let mut session = Session::new();
    let refused = |answer: &Value, part: &str| {
        assert_eq!(answer["type"], "error", "{answer}");
        assert!(answer["message"].as_str().unwrap().contains(part), "{answer}");
    };
    for request in [
        json!({ "type": "run", "budgetMs": 1, "maxIterations": 1 }),
        json!({ "type": "save" }),
        json!({ "type": "analyze" }),
        json!({ "type": "export" }),
        json!({ "type": "touch", "points": [0], "positions": [], "pinned": true }),
        json!({ "type": "resynthesize", "region": [0, 0, 1, 0, 1, 1] }),
        json!({ "type": "continue", "preset": "fast" }),
    ] {
        refused(&ask(&mut session, request), "no run");
    }
    ask(&mut session, tiny(1));
    run(&mut session, 1);
    let start = |exemplar: Value, preset: &str, overrides: Value| json!({ "type": "start", "exemplar": exemplar, "preset": preset, "overrides": overrides });
    let rings = || json!({ "source": "gallery", "name": "rings" });
    let nothing = || json!({});
    let cases = [
        (start(json!({ "source": "gallery", "name": "nope" }), "fast", nothing()), "\"nope\""),
        (start(rings(), "perfect", nothing()), "fast, balanced, best, paper"),
        (start(rings(), "fast", json!({ "channels": -3 })), "between 4 and 160"),
        (start(rings(), "fast", json!({ "channels": 4.5 })), "whole number"),
        (start(rings(), "fast", json!({ "channels": "many" })), "must be a number"),
        (start(rings(), "fast", json!({ "chanels": 8 })), "chanels"),
        (start(rings(), "fast", json!({ "boundary": "leaky" })), "leaky"),
        (start(rings(), "fast", json!({ "grid-min": 64, "grid-max": 32 })), "'grid-min'"),
        (json!({ "type": "resume", "state": "{}" }), "saved state"),
        (json!({ "type": "touch", "points": [60000], "positions": [], "pinned": true }), "no point 60000"),
        (json!({ "type": "touch", "points": [0], "positions": [7, 7], "pinned": true }), "outside the output"),
        (json!({ "type": "touch", "points": [0], "positions": [7], "pinned": true }), "0 places for 1 points"),
        (json!({ "type": "resynthesize", "region": [0, 0, 1, 1] }), "three corners"),
        (json!({ "type": "resynthesize", "region": [7, 7, 8, 7, 8, 8] }), "no point in this region"),
    ];
    for (request, part) in cases {
        refused(&ask(&mut session, request), part);
    }
    let batch = run(&mut session, 1);
    assert_eq!(batch["progress"]["totalIterations"], json!(2), "the run before is still there");
}

#[test]
fn patterns_of_things_come_with_their_looks() {
    let mut session = Session::new();
    let glyphs = ask(&mut session, json!({ "type": "describe" }))["glyphs"].clone();
    let named = |name: &str| glyphs.as_array().unwrap().iter().find(|glyph| glyph["name"] == name).unwrap().clone();
    assert_eq!(named("disk")["outline"], "");
    assert!(named("house")["outline"].as_str().unwrap().starts_with("M0 -1.45L1.4 -0.2L"), "{glyphs}");

    let gallery = ask(&mut session, json!({ "type": "gallery" }));
    let pattern = |name: &str| {
        let entries = gallery["entries"].as_array().unwrap();
        entries.iter().find(|entry| entry["name"] == name).unwrap()["pattern"].clone()
    };
    let looks = &pattern("houses")["looks"];
    assert_eq!(looks, &json!([{ "glyph": "house", "color": 1 }, { "glyph": "tree", "color": 2 }]));
    assert_eq!(pattern("grove")["looks"], json!([{ "glyph": "disk", "color": 2 }]), "crowns have a radius");
    let lengths = |name: &str| {
        let points = pattern(name)["points"].clone();
        ["radii", "scales", "turns", "depths"].map(|list| points[list].as_array().unwrap().len())
    };
    assert_eq!(lengths("houses"), [0; 4]);
    assert_eq!(lengths("grove"), [91, 0, 0, 0]);
    assert_eq!(lengths("boats"), [0, 0, 72, 0]);
    assert_eq!(lengths("meadow"), [0, 118, 0, 118]);

    // In metres: radii in exemplar units, scales against the exemplar's mean, on both sides.
    let mut exemplar = own([0.0, 0.0, 40.0, 20.0], &[1.0, 1.0, 20.0, 10.0, 30.0, 5.0, 10.0, 15.0]);
    exemplar["pattern"]["attributes"] = json!([
        { "name": "radius", "values": [4, 2, 1, 3] },
        { "name": "scale", "values": [10, 30, 20, 20] },
    ]);
    let mut request = tiny(1);
    request["exemplar"] = exemplar;
    let started = ask(&mut session, request);
    let list = |side: &str, name: &str| -> Vec<f64> {
        started[side]["points"][name].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
    };
    let near = |found: Vec<f64>, wanted: &[f64]| {
        assert!(
            found.len() == wanted.len() && found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-6),
            "{found:?}"
        );
    };
    near(list("exemplar", "radii"), &[0.1, 0.05, 0.025, 0.075]);
    near(list("exemplar", "scales"), &[0.5, 1.5, 1.0, 1.0]);
    let allowed = |value: &f64| [0.1, 0.05, 0.025, 0.075].iter().any(|radius| (radius - value).abs() < 1e-6);
    assert!(list("output", "radii").iter().all(allowed), "{started}");
}

#[test]
fn numbers_that_are_no_pattern_are_refused() {
    let mut session = Session::new();
    let open = |exemplar: Value| json!({ "type": "open", "exemplar": exemplar });
    let answer = ask(&mut session, open(own([0.0, 0.0, 1.0, 1.0], &[0.5, 1.5])));
    assert!(answer["message"].as_str().unwrap().contains("outside the domain"), "{answer}");
    let answer = ask(&mut session, open(own([0.0, 0.0, 1.0, 1.0], &[0.5, 0.5, 0.2, 0.25])));
    assert_eq!(answer["exemplar"]["points"]["positions"], json!([0.5, 0.5, f64::from(0.2_f32), 0.25]), "{answer}");
    assert_eq!(answer["pattern"]["positions"], json!([0.5, 0.5, 0.2, 0.25]), "{answer}");
}

#[test]
fn an_output_is_drawn_in_the_units_of_its_exemplar() {
    let mut session = Session::new();
    let points = [100.0, 200.0, 140.0, 220.0, 120.0, 210.0, 110.0, 205.0, 130.0, 215.0];
    let mut request = tiny(1);
    request["exemplar"] = own([100.0, 200.0, 40.0, 20.0], &points);
    let started = ask(&mut session, request);
    assert_eq!(started["exemplar"]["size"], json!([1.0, 0.5]), "{started}");
    assert_eq!(started["exemplar"]["min"], json!([100.0, 200.0]));
    assert_eq!(started["exemplar"]["unit"], json!(40.0));
    assert_eq!(started["exemplar"]["points"]["positions"][2], json!(1.0));
    assert_eq!(started["output"]["size"], json!([1.0, 0.75]));
    assert_eq!(started["output"]["unit"], json!(40.0));
}
