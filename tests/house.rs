//! The order of the house: which room may name which, how long a file may be, and what the pages' modules import.
//!
//! Every rule is a function over paths and texts, so each test first shows that the rule finds what breaks it.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// The rooms of `src/` from bottom to top. A room may name those further down; those of one line do not name each other.
const ROOMS: [&[&str]; 14] = [
    &["sorting", "parallel"],
    &["pattern"],
    &["sampling"],
    &["gallery"],
    &["analysis"],
    &["finish"],
    &["engine"],
    &["run"],
    &["methods"],
    &["formats"],
    &["bench"],
    &["web"],
    &["bin"],
    // The crate's root: it declares the rooms.
    &[""],
];

/// A file that may name a path all the same.
struct Exception {
    file: &'static str,
    path: &'static str,
    /// Whether only its tests may.
    only_tests: bool,
    reason: &'static str,
}

const EXCEPTIONS: [Exception; 2] = [
    Exception {
        file: "src/bench.rs",
        path: "methods::network",
        only_tests: false,
        reason: "it times an iteration of this method's network",
    },
    Exception {
        file: "src/pattern/point_pattern.rs",
        path: "sampling",
        only_tests: true,
        reason: "random points are measured against a slow way to do the same",
    },
];

/// Most lines of a file that does not say why it is longer.
const LONGEST: usize = 700;
/// How a file says why, and in how many lines from its start.
const LONG_BECAUSE: &str = "Long because:";
const HEAD_LINES: usize = 30;

/// A path from the root of the repository, with `/`, and what is in the file.
type File = (String, String);

/// The files below `folder` that have one of the extensions.
fn files(folder: &str, extensions: &[&str]) -> Vec<File> {
    fn collect(folder: &Path, name: &str, extensions: &[&str], found: &mut Vec<File>) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = format!("{name}/{}", path.file_name().unwrap().to_str().unwrap());
            if path.is_dir() {
                collect(&path, &name, extensions, found);
            } else if path.extension().is_some_and(|extension| extensions.iter().any(|known| extension == *known)) {
                found.push((name, fs::read_to_string(&path).unwrap()));
            }
        }
    }
    let mut found = Vec::new();
    collect(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), folder, extensions, &mut found);
    found.sort();
    found
}

fn planted(files: &[(&str, &str)]) -> Vec<File> {
    files.iter().map(|(path, text)| ((*path).to_owned(), (*text).to_owned())).collect()
}

// ------------------------------------------------------------------------------------------------------ Rust's paths

/// A word or a mark of Rust's, with its line. `::` is one mark; literals and comments are left out.
#[derive(Clone, Debug, PartialEq)]
struct Token {
    text: String,
    line: usize,
}

fn tokens(text: &str) -> Vec<Token> {
    let letters: Vec<char> = text.chars().collect();
    let at = |place: usize| letters.get(place).copied().unwrap_or('\0');
    let is_word = |letter: char| letter.is_alphanumeric() || letter == '_';
    let (mut tokens, mut place, mut line) = (Vec::new(), 0, 1);
    while place < letters.len() {
        let start = place;
        match (at(place), at(place + 1)) {
            ('/', '/') => {
                while place < letters.len() && at(place) != '\n' {
                    place += 1;
                }
            }
            ('/', '*') => {
                let mut depth = 0;
                loop {
                    match (at(place), at(place + 1)) {
                        ('/', '*') => (depth, place) = (depth + 1, place + 2),
                        ('*', '/') => (depth, place) = (depth - 1, place + 2),
                        _ => place += 1,
                    }
                    if depth == 0 || place >= letters.len() {
                        break;
                    }
                }
            }
            ('"', _) => place = end_of_string(&letters, place),
            ('\'', '\\') => {
                place += 3;
                while place < letters.len() && at(place) != '\'' {
                    place += 1;
                }
                place += 1;
            }
            // A letter in quotes, or else a lifetime.
            ('\'', _) => place += if at(place + 2) == '\'' { 3 } else { 1 },
            (letter, _) if is_word(letter) => {
                while is_word(at(place)) {
                    place += 1;
                }
                let word: String = letters[start..place].iter().collect();
                let hashes = letters[place..].iter().take_while(|&&letter| letter == '#').count();
                match word.as_str() {
                    "r" | "br" | "cr" if at(place + hashes) == '"' => {
                        let end: Vec<char> = std::iter::once('"').chain(std::iter::repeat_n('#', hashes)).collect();
                        place += hashes + 1;
                        while place < letters.len() && !letters[place..].starts_with(&end) {
                            place += 1;
                        }
                        place += end.len();
                    }
                    "b" | "c" if at(place) == '"' => place = end_of_string(&letters, place),
                    _ => tokens.push(Token { text: word, line }),
                }
            }
            (letter, next) => {
                place += if (letter, next) == (':', ':') { 2 } else { 1 };
                if !letter.is_whitespace() {
                    tokens.push(Token { text: letters[start..place].iter().collect(), line });
                }
            }
        }
        line += letters[start..place.min(letters.len())].iter().filter(|&&letter| letter == '\n').count();
    }
    tokens
}

fn end_of_string(letters: &[char], quote: usize) -> usize {
    let mut place = quote + 1;
    while place < letters.len() && letters[place] != '"' {
        place += if letters[place] == '\\' { 2 } else { 1 };
    }
    place + 1
}

/// A path that a file names, from the root of the crate.
#[derive(Clone, Debug, PartialEq)]
struct Named {
    /// `*` is a segment, too.
    path: Vec<String>,
    line: usize,
    in_tests: bool,
}

/// The module that a file of `src/` is: `src/engine/cpu/mod.rs` is `engine`, `cpu`. Those of the program are in `bin`.
fn module_of(path: &str) -> Vec<String> {
    let names = path.trim_start_matches("src/").trim_end_matches(".rs").split('/');
    let names: Vec<String> = names.map(str::to_owned).collect();
    let names = match names.split_first() {
        Some((bin, rest)) if bin == "bin" => [vec![bin.clone()], rest[1..].to_vec()].concat(),
        _ => names,
    };
    match names.split_last() {
        Some((last, rest)) if ["mod", "lib", "main"].contains(&last.as_str()) => rest.to_vec(),
        _ => names,
    }
}

/// Whether the attribute that begins here is `#[cfg(test)]` or asks for tests among other things.
fn asks_for_tests(tokens: &[Token]) -> bool {
    let words: Vec<&str> = tokens.iter().map(|token| token.text.as_str()).take_while(|text| *text != "]").collect();
    words.starts_with(&["#", "[", "cfg"]) && words.contains(&"test") && !words.contains(&"not")
}

/// What `crate::…`, `self::…` and `super::…` mean wherever they stand in a file, and `pointweave::…` in the program.
fn named_paths(file: &str, text: &str) -> Vec<Named> {
    let tokens = tokens(text);
    let is = |place: usize, text: &str| tokens.get(place).is_some_and(|token| token.text == text);
    let own = module_of(file);
    let is_program = own.first().is_some_and(|room| room == "bin");
    let mut named = Vec::new();
    // What each open brace is: the name of a module where it is one's, and whether tests begin with it.
    let mut braces: Vec<(Option<String>, bool)> = Vec::new();
    let (mut module, mut tests_next) = (None, false);
    for (place, token) in tokens.iter().enumerate() {
        let starts_path = is(place + 1, "::") && (place == 0 || !is(place - 1, "::"));
        match token.text.as_str() {
            "#" if asks_for_tests(&tokens[place..]) => tests_next = true,
            "mod" if is(place + 2, "{") => module = tokens.get(place + 1).map(|name| name.text.clone()),
            "{" => braces.push((module.take(), std::mem::take(&mut tests_next))),
            "}" => drop(braces.pop()),
            word @ ("crate" | "self" | "super" | "pointweave") if starts_path => {
                let inline = braces.iter().filter_map(|(module, _)| module.clone());
                let base = match word {
                    "pointweave" if is_program => Vec::new(),
                    "pointweave" => continue,
                    "crate" if is_program => vec!["bin".to_owned()],
                    "crate" => Vec::new(),
                    _ => own.iter().cloned().chain(inline).collect(),
                };
                let in_tests = tests_next || braces.iter().any(|&(_, tests)| tests);
                // `self` stays where it is, `super` is the first step up.
                let start = if word == "super" { place } else { place + 2 };
                let mut paths = Vec::new();
                follow(&tokens, start, base, &mut paths);
                named.extend(paths.into_iter().map(|path| Named { path, line: token.line, in_tests }));
            }
            ";" => tests_next = false,
            _ => {}
        }
    }
    named
}

/// Follows a path, or a tree of them in braces, from `place` on; returns the place after it.
fn follow(tokens: &[Token], mut place: usize, mut path: Vec<String>, paths: &mut Vec<Vec<String>>) -> usize {
    let text = |place: usize| tokens.get(place).map_or("", |token| token.text.as_str());
    loop {
        match text(place) {
            "{" => {
                place += 1;
                while !["}", ""].contains(&text(place)) {
                    place = follow(tokens, place, path.clone(), paths);
                    // What a name is imported as.
                    while ![",", "}", ""].contains(&text(place)) {
                        place += 1;
                    }
                    place += usize::from(text(place) == ",");
                }
                return place + 1;
            }
            "super" => drop(path.pop()),
            "self" => {}
            word => path.push(word.to_owned()),
        }
        place += 1;
        // `::<` gives types, not a name.
        if text(place) != "::" || text(place + 1) == "<" {
            paths.push(path);
            return place;
        }
        place += 1;
    }
}

/// What the crate's root takes out of its rooms: the name and the room.
fn reexports(root: &str) -> BTreeMap<String, String> {
    let tokens = tokens(root);
    let mut names = BTreeMap::new();
    for (place, _) in tokens.iter().enumerate().filter(|(_, token)| token.text == "use") {
        let mut paths = Vec::new();
        follow(&tokens, place + 1, Vec::new(), &mut paths);
        for path in paths {
            if let [room, .., name] = path.as_slice() {
                names.insert(name.clone(), room.clone());
            }
        }
    }
    names
}

/// Every path that names what is above, another method, or a method from outside of `methods/mod.rs`; and every exception
/// that nothing needs.
fn arrows_up(files: &[File], exceptions: &[Exception]) -> Vec<String> {
    let rank = |room: &str| ROOMS.iter().position(|line| line.contains(&room));
    let root = files.iter().find(|(path, _)| path == "src/lib.rs").map_or("", |(_, text)| text);
    let reexports = reexports(root);
    let methods: BTreeSet<String> = files
        .iter()
        .filter_map(|(path, _)| path.strip_prefix("src/methods/"))
        .filter_map(|path| path.split(['/', '.']).next())
        .filter(|name| *name != "mod")
        .map(str::to_owned)
        .collect();
    let mut used = BTreeSet::new();
    let mut found = Vec::new();
    for (file, text) in files {
        let own = module_of(file);
        let room = own.first().map_or("", String::as_str);
        let Some(own_rank) = rank(room) else {
            found.push(format!("{file}: '{room}' is none of the rooms"));
            continue;
        };
        for Named { mut path, line, in_tests } in named_paths(file, text) {
            // The root itself, as `super::*` right below it.
            let Some(first) = path.first().cloned() else { continue };
            if let Some(room) = reexports.get(&first) {
                path.insert(0, room.clone());
            }
            let words = path.join("::");
            let trouble = match rank(&path[0]) {
                _ if path[0] == room && room != "methods" => continue,
                None => format!("names {words}, which is in none of the rooms"),
                Some(other) if other > own_rank => format!("names {words}, which is above {room}"),
                Some(other) if other == own_rank && path[0] != room => format!("names {words}, which is beside {room}"),
                // A glob of `methods` brings all of them.
                _ if path[0] == "methods" && path.get(1).is_some_and(|name| methods.contains(name) || name == "*") => {
                    if own == ["methods"] || own.get(1) == path.get(1) {
                        continue;
                    }
                    format!("names {words}, a method")
                }
                _ => continue,
            };
            let allows = |exception: &Exception| {
                exception.file == file
                    && format!("{words}::").starts_with(&format!("{}::", exception.path))
                    && (in_tests || !exception.only_tests)
            };
            match exceptions.iter().position(allows) {
                Some(place) => drop(used.insert(place)),
                None => found.push(format!("{file}:{line}: {trouble}")),
            }
        }
        // Also by way of a name that was imported: `use crate::methods;` and then `methods::network::…`.
        let is_outside = room != "methods" && !exceptions.iter().any(|exception| exception.file == file);
        for window in tokens(text).windows(3).filter(|_| is_outside) {
            let [first, colons, second] = window else { continue };
            if first.text == "methods" && colons.text == "::" && methods.contains(&second.text) {
                let trouble = format!("{file}:{}: names methods::{}", first.line, second.text);
                if !found.iter().any(|known| known.starts_with(&trouble)) {
                    found.push(format!("{trouble}, a method"));
                }
            }
        }
    }
    for (place, Exception { file, path, reason, .. }) in exceptions.iter().enumerate() {
        if !used.contains(&place) {
            found.push(format!("{file} does not name {path}: the exception ({reason}) can go"));
        }
    }
    found
}

#[test]
fn paths_are_found_wherever_they_stand() {
    let found = |file: &str, text: &str| -> Vec<String> {
        named_paths(file, text).into_iter().map(|named| named.path.join("::")).collect()
    };
    let in_gram = |text: &str| found("src/engine/cpu/gram.rs", text);
    assert_eq!(in_gram("use crate::a::{self, b::{C, d as e}, f::*};"), ["a", "a::b::C", "a::b::d", "a::f::*"]);
    assert_eq!(
        in_gram("let x = crate::a::B::<u8>::new(super::c(), self::d);"),
        ["a::B", "engine::cpu::c", "engine::cpu::gram::d"]
    );
    assert_eq!(
        in_gram("use super::super::{view, run::{Plan, Edit}};"),
        ["engine::view", "engine::run::Plan", "engine::run::Edit"]
    );
    assert_eq!(
        in_gram("mod tests { use super::*; use super::super::x; } use super::y;"),
        ["engine::cpu::gram::*", "engine::cpu::x", "engine::cpu::y"]
    );
    assert_eq!(in_gram("pub(in crate::engine) fn f<'a>(x: &'a str) -> $crate::g {}"), ["engine", "g"]);
    let silent = r##"// crate::a
        /* crate::b /* crate::c */ crate::d */ "crate::e \" crate::f" r#"crate::g " crate::h"# b"crate::i" '"' '\'' crate::k"##;
    assert_eq!(in_gram(silent), ["k"]);
    assert_eq!(
        found("src/bin/pointweave/synth.rs", "use pointweave::a::B; use crate::files::C; use super::d;"),
        ["a::B", "bin::files::C", "bin::d"]
    );
    let lines: Vec<usize> =
        named_paths("src/run/mod.rs", "\n/*\n*/ \"\n\" crate::a\n;crate::b").iter().map(|one| one.line).collect();
    assert_eq!(lines, [4, 5]);
}

#[test]
fn an_arrow_up_is_found() {
    let broken = |file: &str, text: &str| {
        arrows_up(
            &planted(&[
                ("src/lib.rs", "pub mod engine; pub use pattern::{Domain, PointPattern}; pub use run::Plan as Plan;"),
                ("src/methods/mod.rs", "mod network; mod patches; pub use network::Network;"),
                ("src/methods/network/mod.rs", "use super::Method; use crate::engine::view::Grid;"),
                ("src/methods/patches/mod.rs", ""),
                (file, text),
            ]),
            &[],
        )
    };
    for (file, text) in [
        ("src/engine/view.rs", "use crate::methods::Method;"),
        ("src/engine/cpu/gram.rs", "use super::super::super::methods::Method;"),
        ("src/engine/cpu/gram.rs", "use crate::{parallel, engine::view, methods::{Method}};"),
        ("src/engine/mod.rs", "fn f() -> u32 { 1 + crate::methods::count() }"),
        ("src/pattern/domain.rs", "use crate::sampling::Rng;"),
        ("src/pattern/mod.rs", "#[cfg(test)] mod tests { use super::*; use crate::sampling::Rng; }"),
        ("src/analysis/cloud.rs", "use crate::Plan;"),
        ("src/sorting.rs", "use crate::parallel::threads;"),
        ("src/engine/mod.rs", "use crate::run::Losses;"),
        ("src/finish/mod.rs", "use crate::engine::LossTerms;"),
        ("src/web/session.rs", "use crate::bin::main;"),
        ("src/engine/mod.rs", "use crate::elsewhere::Thing;"),
        ("src/cellar/mod.rs", ""),
        // A method is named by nobody but the list of methods.
        ("src/methods/patches/force.rs", "use super::super::network::features;"),
        ("src/methods/patches/force.rs", "use crate::methods::network::features;"),
        ("src/web/session.rs", "use crate::methods::network::Parameters;"),
        ("src/web/session.rs", "use crate::methods; fn f() { methods::network::g() }"),
        ("src/web/session.rs", "use crate::methods::*;"),
        ("src/bin/pointweave/synth.rs", "use pointweave::{gallery, methods::network::Preset};"),
        ("src/finish/holes.rs", "use crate::methods::network::HOLE;"),
    ] {
        let found = broken(file, text);
        assert_eq!(found.len(), 1, "{file}: {text}\n{found:?}");
        assert!(found[0].starts_with(file), "{found:?}");
    }
    for (file, text) in [
        ("src/engine/cpu/gram.rs", "use super::product; use crate::engine::view::{Grid, self}; use crate::parallel;"),
        (
            "src/engine/view.rs",
            "// crate::methods::Method\nconst A: &str = \"crate::methods\"; use crate::{Domain, analysis::Cloud};",
        ),
        (
            "src/methods/network/ladder.rs",
            "use super::Scale; use super::super::Method; use crate::methods::network::Bands;",
        ),
        ("src/web/session.rs", "use crate::methods::{Method, all}; use super::protocol::Response;"),
        ("src/bin/pointweave/synth.rs", "use pointweave::methods::Method; use crate::files::Output;"),
    ] {
        assert_eq!(broken(file, text), Vec::<String>::new(), "{file}: {text}");
    }
}

#[test]
fn an_exception_lets_one_file_name_one_path_and_has_to_be_needed() {
    let exception =
        |only_tests| Exception { file: "src/run/mod.rs", path: "methods::network", only_tests, reason: "planted" };
    let found = |text: &str, only_tests| {
        arrows_up(&planted(&[("src/methods/network/mod.rs", ""), ("src/run/mod.rs", text)]), &[exception(only_tests)])
    };
    let (code, test) =
        ("use crate::methods::network::A;", "#[cfg(test)] mod tests { use crate::methods::network::A; }");
    assert!(found(code, false).is_empty() && found(test, false).is_empty() && found(test, true).is_empty());
    // One for what was found, one for the exception that nothing needs.
    assert_eq!(found(code, true).len(), 2);
    assert_eq!(found("use crate::methods::networks::A;", false).len(), 2);
    assert_eq!(found("", false).len(), 1);
}

#[test]
fn no_room_names_one_above_it() {
    let files = files("src", &["rs"]);
    for room in ROOMS.concat().into_iter().filter(|room| !room.is_empty()) {
        let is_there = files.iter().any(|(path, _)| module_of(path).first().is_some_and(|first| first == room));
        assert!(is_there, "there is no room '{room}' any more");
    }
    let found = arrows_up(&files, &EXCEPTIONS);
    assert!(found.is_empty(), "{} paths lead the wrong way:\n{}", found.len(), found.join("\n"));
}

// ------------------------------------------------------------------------------------------------------ long files

fn too_long(files: &[File]) -> Vec<String> {
    files
        .iter()
        .filter(|(_, text)| text.lines().count() > LONGEST)
        .filter(|(_, text)| !text.lines().take(HEAD_LINES).any(|line| line.contains(LONG_BECAUSE)))
        .map(|(path, text)| format!("{path}: {} lines", text.lines().count()))
        .collect()
}

#[test]
fn no_file_is_long_without_a_reason() {
    let long = "x\n".repeat(LONGEST + 1);
    let planted = planted(&[
        ("src/long.rs", &long),
        ("src/late.rs", &format!("{long}//! {LONG_BECAUSE} too late\n")),
        ("src/short.rs", &long[2..]),
        ("www/said.css", &format!("/* {LONG_BECAUSE} one table */\n{long}")),
    ]);
    assert_eq!(too_long(&planted), ["src/long.rs: 701 lines", "src/late.rs: 702 lines"]);

    let all = [files("src", &["rs"]), files("shaders", &["wgsl"]), files("www", &["js", "css", "html"])];
    assert!(all.iter().all(|files| !files.is_empty()));
    let found = too_long(&all.concat());
    assert!(found.is_empty(), "over {LONGEST} lines and no line '{LONG_BECAUSE}' at the start:\n{}", found.join("\n"));
}

// ------------------------------------------------------------------------------------------------------ the pages

/// A script without its comments, and so without the imports of types.
fn without_comments(text: &str) -> String {
    let mut rest = text;
    let mut code = String::new();
    let mut quote = None;
    while let Some(letter) = rest.chars().next() {
        let mut length = letter.len_utf8();
        match quote {
            None if rest.starts_with("//") => {
                rest = &rest[rest.find('\n').unwrap_or(rest.len())..];
                continue;
            }
            None if rest.starts_with("/*") => {
                rest = rest.find("*/").map_or("", |end| &rest[end + 2..]);
                continue;
            }
            None if ['\'', '"', '`'].contains(&letter) => quote = Some(letter),
            Some(_) if letter == '\\' => length += rest[1..].chars().next().map_or(0, char::len_utf8),
            // Only a template goes on in the next line: a quote in a regular expression does no harm beyond its own.
            Some(open) if letter == open || (letter == '\n' && open != '`') => quote = None,
            _ => {}
        }
        code.push_str(&rest[..length]);
        rest = &rest[length..];
    }
    code
}

/// What a script imports, as written.
fn imports(text: &str) -> Vec<String> {
    let code = without_comments(text);
    let mut found = Vec::new();
    for word in ["from", "import", "import("] {
        for (place, _) in code.match_indices(word) {
            let rest = code[place + word.len()..].trim_start();
            let Some(quote) = rest.chars().next().filter(|first| ['\'', '"'].contains(first)) else { continue };
            if let Some(path) = rest[1..].split(quote).next() {
                found.push(path.to_owned());
            }
        }
    }
    found
}

/// Imports that lead from `www/common` into a page's folder, or from one page's folder into another's.
fn strayed_imports(files: &[File]) -> Vec<String> {
    // `www/pkg` is built: the modules' own JavaScript.
    let folder = |path: &str| match path.split('/').collect::<Vec<_>>()[..] {
        ["www", folder, _, ..] if folder != "pkg" => Some(folder.to_owned()),
        _ => None,
    };
    let mut found = Vec::new();
    for (file, text) in files {
        let Some(own) = folder(file) else { continue };
        for import in imports(text) {
            let mut names: Vec<&str> =
                if import.starts_with('/') { vec!["www", ""] } else { file.split('/').collect() };
            names.pop();
            for name in import.split('/') {
                match name {
                    "" | "." => {}
                    ".." => drop(names.pop()),
                    name => names.push(name),
                }
            }
            let target = names.join("/");
            match folder(&target) {
                Some(other) if other != own && other != "common" => found.push(format!("{file} imports {target}")),
                _ => {}
            }
        }
    }
    found
}

#[test]
fn pages_keep_to_their_folders_and_what_is_common() {
    let found = |file: &str, text: &str| strayed_imports(&planted(&[(file, text)]));
    for (file, text) in [
        ("www/common/store.js", "import { a } from '../playground/main.js';"),
        ("www/common/store.js", "import \"../playground/main.js\";"),
        ("www/common/store.js", "const later = await import('../playground/main.js');"),
        ("www/common/store.js", "export {\n  a,\n} from '/playground/main.js';"),
        ("www/learn/main.js", "import { a } from '../playground/views/stage.js';"),
        ("www/learn/deep/main.js", "const u = 'https://a'; import { a } from '../../playground/main.js'; // b"),
    ] {
        assert_eq!(found(file, text).len(), 1, "{file}: {text}");
    }
    for (file, text) in [
        (
            "www/learn/main.js",
            "import { a } from './figure.js'; import '../common/b.js'; import c from '../pkg/pointweave.js';",
        ),
        (
            "www/common/store.js",
            "/** @typedef {import('../playground/main.js').A} A */ // from '../playground/main.js'",
        ),
        ("www/worker.js", "import { a } from './playground/messages.js';"),
    ] {
        assert_eq!(found(file, text), Vec::<String>::new(), "{file}: {text}");
    }

    let scripts = files("www", &["js"]);
    assert!(scripts.iter().any(|(path, _)| path.starts_with("www/common/")), "there is no www/common any more");
    let found = strayed_imports(&scripts);
    assert!(found.is_empty(), "{}", found.join("\n"));
}
