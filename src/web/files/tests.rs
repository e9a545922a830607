#![allow(clippy::unwrap_used, reason = "a test may stop at the first surprise")]

use serde_json::json;

use super::*;
use crate::formats::Note;
use crate::web::protocol::tests::tags;

fn ask(request: Value) -> Value {
    let kind = request["type"].as_str().unwrap().to_owned();
    serde_json::to_value(respond(serde_json::from_value(json!({ kind: request })).unwrap())).unwrap()
}

fn open(name: &str, bytes: &[u8]) -> Value {
    ask(json!({ "type": "read", "name": name, "bytes": bytes, "options": {} }))
}

fn bytes(answer: &Value) -> Vec<u8> {
    serde_json::from_value(answer["bytes"].clone()).unwrap()
}

#[test]
fn the_page_knows_every_message() {
    let typedefs = include_str!("../../../www/common/files-messages.js");
    let (requests, responses) = (tags::<FilesRequest>(), tags::<FilesResponse>());
    assert!(requests.contains(&"read-link".to_owned()), "{requests:?}");
    assert!(responses.contains(&"link-read".to_owned()), "{responses:?}");
    for tag in requests.iter().chain(&responses) {
        assert!(typedefs.contains(&format!("type: '{tag}'")), "no typedef for the message '{tag}'");
    }
    let known = requests.len() + responses.len();
    assert_eq!(typedefs.matches("type: '").count(), known, "a typedef for a message that does not exist");
}

#[test]
fn a_file_comes_with_its_preview_and_goes_out_in_every_format() {
    let read = open("a.csv", b"# domain 0 0 4 2 periodic\nx,y,class,height\n1,1,oak,3\n2,1,elm,5\n2,1,oak,4\n");
    let preview = &read["preview"];
    assert_eq!(preview["format"], "CSV or TSV", "{read}");
    assert_eq!(preview["classes"], json!([{ "name": "oak", "count": 2 }, { "name": "elm", "count": 1 }]));
    assert_eq!(preview["attributes"], json!([{ "name": "height", "min": 3.0, "max": 5.0 }]));
    assert_eq!((&preview["domain"], &preview["declared"]), (&json!([0.0, 0.0, 4.0, 2.0]), &json!(true)));
    assert_eq!(preview["spacing"], json!(1.0));
    let notes: Vec<Note> = serde_json::from_value(preview["notes"].clone()).unwrap();
    assert!(
        notes[0].text.contains("One of the 3 points lies exactly on another")
            && notes[1].text.contains("only 3 points"),
        "{notes:?}"
    );

    for (format, start) in
        [("csv", "# domain 0 0 4 2"), ("tsv", "x\ty\tclass"), ("json", "{"), ("svg", "<svg"), ("npy", "\u{fffd}NUMPY")]
    {
        let written = ask(json!({ "type": "write", "format": format, "pattern": read["pattern"], "title": "t" }));
        assert_eq!(written["type"], "written", "{written}");
        let bytes = bytes(&written);
        assert!(String::from_utf8_lossy(&bytes).starts_with(start), "{format}");
        let again = open("", &bytes);
        assert_eq!(again["pattern"]["positions"].as_array().unwrap().len(), 6, "{format}: {again}");
        if format == "csv" || format == "json" {
            assert_eq!(again["pattern"], read["pattern"], "{format}");
        }
    }
}

#[test]
fn a_tile_ends_at_its_border() {
    let pattern = &open("", b"# domain 0 0 4 2 periodic\n1 1\n2 1\n")["pattern"];
    let svg = |tile: bool| {
        let written = ask(json!({ "type": "write", "format": "svg", "pattern": pattern, "tile": tile }));
        String::from_utf8(bytes(&written)).unwrap()
    };
    assert!(svg(true).contains("data-frame=\"0 0 800 400\"") && !svg(false).contains("data-frame=\"0 0 800 400\""));
}

#[test]
fn glyphs_are_checked_and_drawn() {
    let glyph = |name: &str| ask(json!({ "type": "glyph", "name": name }));
    let square = json!({ "type": "glyph", "outline": "M-1 -1L1 -1L1 1L-1 1Z" });
    assert_eq!(glyph("path:M0 0h10v10h-10z"), square);
    assert!(glyph("path:M0 0L9 x")["message"].as_str().unwrap().contains("position 8"));
    assert_eq!(glyph("castle")["type"], "error");

    let boats: PatternData = (&crate::gallery::find("boats").unwrap().exemplar()).into();
    let write = |glyphs: Value, palette: &str| {
        ask(json!({ "type": "write", "format": "svg", "pattern": boats, "glyphs": glyphs, "palette": palette }))
    };
    let drawn = |glyphs, palette| String::from_utf8(bytes(&write(glyphs, palette))).unwrap();
    let plain = drawn(json!({}), "");
    assert!(plain.contains("<use href=\"#glyph-0\"") && plain.contains("rotate(") && plain.contains("#0072b2"));
    let own = drawn(json!({ "boat": "path:M0 0L9 0L9 9Z" }), "ink");
    assert!(own.contains("d=\"M-1 -1L1 -1L1 1Z\"") && own.contains("#222222") && !own.contains("#0072b2"));
    let refused = write(json!({ "boat": "path:\"><script>" }), "ink");
    assert_eq!(refused["type"], "error", "{refused}");
}

#[test]
fn refusals_name_the_file_and_the_place() {
    let answer = open("mine.csv", b"x,y\n0.5,0.5\n0.2,oops\n");
    assert_eq!(answer["place"], json!({ "line": 3, "column": 2 }), "{answer}");
    let message = answer["message"].as_str().unwrap();
    assert!(message.starts_with("mine.csv: line 3, column 2") && message.contains("oops"), "{message}");
    let columns = open("a.csv", b"mass,height\n0.5,0.5\n0.2,0.1\n")["columns"].clone();
    let mass = json!({ "name": "mass", "role": { "kind": "left-out" }, "examples": ["0.5", "0.2"], "isNumeric": true });
    assert_eq!((&columns[0], columns.as_array().unwrap().len()), (&mass, 2), "so that others can be chosen");
    let answer = open("", b"[[0.5, 0.5],\n [0.5]]");
    assert_eq!(answer["place"], json!({ "line": 2, "column": 2 }), "{answer}");
    assert!(answer["message"].as_str().unwrap().starts_with("line 2, column 2 (point 2"), "{answer}");
}

#[test]
fn pictures_are_left_to_the_page() {
    assert_eq!(open("a.jpg", b"\xff\xd8\xff\xe0")["type"], "picture");
    let mut pixels = vec![255_u8; 4 * 12];
    pixels[4..7].fill(0);
    let request =
        |options: Value| json!({ "type": "blobs", "width": 4, "height": 3, "pixels": pixels, "options": options });
    let answer = ask(request(json!({})));
    assert_eq!((&answer["type"], &answer["ink"]), (&json!("blobs"), &json!("dark")), "{answer}");
    assert_eq!(answer["pattern"]["positions"], json!([1.5, 0.5]));
    assert_eq!(ask(request(json!({ "threshold": 300, "ink": "light" })))["type"], "error");
}

#[test]
fn a_session_is_kept_whole() {
    let exemplar = &open("", b"0.1 0.2\n0.3 0.4\n")["pattern"];
    let state = json!({ "version": 1, "exemplar": { "x": 1 }, "losses": [0.1], "points": [[0.1, 0.2]] }).to_string();
    let written = ask(json!({
        "type": "write-project", "title": "Mine", "preset": "balanced", "overrides": { "seed": 7, "channels": 9000, "chanels": 1 },
        "exemplar": exemplar, "output": exemplar, "state": state,
    }));
    let read = open("a.json", &bytes(&written));
    assert_eq!((&read["pattern"], &read["preview"]["format"]), (exemplar, &json!("Pointweave project")), "{read}");
    let project = &read["project"];
    assert_eq!((&project["title"], &project["preset"]), (&json!("Mine"), &json!("balanced")));
    assert_eq!(project["overrides"], json!({ "seed": 7, "channels": 160 }));
    assert_eq!(project["output"], *exemplar);
    let kept: Value = serde_json::from_str(project["state"].as_str().unwrap()).unwrap();
    assert_eq!((&kept["losses"], &kept["points"]), (&json!([0.1]), &json!([[0.1, 0.2]])));
    assert_eq!(kept["exemplar"]["positions"], json!([[0.1, 0.2], [0.3, 0.4]]), "it stands once in the file");
    assert_eq!(read["preview"]["notes"].as_array().unwrap().len(), 3, "two parameters and few points: {read}");
}

#[test]
fn links_go_and_come() {
    let link = |exemplar: Value, overrides: Value| {
        ask(json!({ "type": "write-link", "exemplar": exemplar, "preset": "fast", "overrides": overrides }))
    };
    let read = |fragment: &str| ask(json!({ "type": "read-link", "fragment": fragment }));
    let written = link(json!({ "gallery": "rings" }), json!({ "seed": 7 }));
    assert_eq!(written["fragment"], "v=1&preset=fast&seed=7&exemplar=rings");
    assert_eq!(written["exact"], true);
    let answer = read("#v=1&preset=fast&seed=7&exemplar=rings&embed=1");
    assert_eq!((&answer["exemplar"], &answer["overrides"]), (&json!({ "gallery": "rings" }), &json!({ "seed": 7 })));
    assert_eq!((&answer["parameters"]["seed"], &answer["cost"]["autoRun"]), (&json!(7), &json!(true)), "{answer}");
    let heavy = read("v=1&preset=paper&expansion-x=8&expansion-y=8&exemplar=rings");
    assert_eq!(heavy["cost"]["autoRun"], json!(false), "{heavy}");
    assert!(heavy["cost"]["seconds"].as_f64().unwrap() > 3600.0);

    let own = &open("", b"0.1 0.2\n0.3 0.4\n0 1\n")["pattern"];
    let written = link(json!({ "pattern": own }), json!({}));
    assert_eq!(written["exact"], false, "tenths are no 65535ths");
    let answer = read(written["fragment"].as_str().unwrap());
    assert_eq!(answer["exemplar"]["pattern"], written["pattern"], "{answer}");
    let again = link(answer["exemplar"].clone(), json!({}));
    assert_eq!((&again["exact"], &again["fragment"]), (&json!(true), &written["fragment"]));
    assert_eq!(read("v=2")["type"], "error");
}
