//! The documents: short where a stranger begins, legible in a diff, with links that lead somewhere and small pictures.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::fs;
use std::path::{Path, PathBuf};

/// What a stranger reads first, and how many lines it may have.
const SHORT: [(&str, usize); 2] = [("README.md", 150), ("ARCHITECTURE.md", 150)];
/// Most characters of a line of prose.
const MAX_COLUMNS: usize = 110;
/// Most bytes of all pictures together.
const MAX_PICTURE_BYTES: u64 = 1_500_000;
/// Folders that hold documents, beside the root itself.
const FOLDERS: [&str; 7] = ["benches", "docs", "examples", "fuzz", "tests", "www", "xtask"];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// All files below a folder, build outputs and hidden ones left out.
fn files(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut found = Vec::new();
    for path in entries.map(|entry| entry.unwrap().path()) {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if name.starts_with('.') || ["target", "node_modules", "corpus", "artifacts"].contains(&name.as_str()) {
            continue;
        }
        if path.is_dir() {
            found.extend(files(&path));
        } else {
            found.push(path);
        }
    }
    found
}

/// Every Markdown file and its text.
fn documents() -> Vec<(PathBuf, String)> {
    let own = fs::read_dir(root()).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_file());
    let below = FOLDERS.iter().flat_map(|folder| files(&root().join(folder)));
    let markdown = own.chain(below).filter(|path| path.extension().is_some_and(|extension| extension == "md"));
    markdown.map(|path| (path.clone(), fs::read_to_string(&path).unwrap())).collect()
}

/// The lines outside fenced code, counted from 1.
fn outside_code(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut is_code = false;
    text.lines().zip(1..).filter_map(move |(line, number)| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        (!is_code && !is_fence).then_some((number, line))
    })
}

/// A line without the targets of its links: those can't be broken.
fn without_targets(line: &str) -> String {
    let mut parts = line.split("](");
    let mut rest = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        rest.push(']');
        rest.push_str(part.split_once(')').map_or(part, |(_, after)| after));
    }
    rest
}

/// Lines of prose that are too long; tables, code and HTML are none.
fn long_lines(text: &str) -> Vec<usize> {
    let prose = outside_code(text).filter(|(_, line)| !line.trim_start().starts_with(['|', '<']));
    prose.filter(|(_, line)| without_targets(line).chars().count() > MAX_COLUMNS).map(|(number, _)| number).collect()
}

/// Targets of links and pictures, in Markdown or HTML.
fn targets(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for (number, line) in outside_code(text) {
        // Code within a line is no link, but may be what a link says.
        let plain: String = line.split('`').step_by(2).collect();
        for (opening, closing) in [("](", ')'), ("src=\"", '"'), ("srcset=\"", '"'), ("href=\"", '"')] {
            for part in plain.split(opening).skip(1) {
                found.push((number, part.split(closing).next().unwrap_or_default().to_owned()));
            }
        }
    }
    found
}

/// What a heading is called in an address, as GitHub does it.
fn anchor(heading: &str) -> String {
    let kept = heading.trim().chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect::<String>().to_lowercase()
}

fn has_heading(text: &str, wanted: &str) -> bool {
    let mut headings = outside_code(text).filter_map(|(_, line)| line.strip_prefix('#'));
    headings.any(|heading| anchor(heading.trim_start_matches('#')) == wanted)
}

/// Links of a document that lead nowhere, each with its line. Other sites are not asked.
fn broken_links(path: &Path, text: &str) -> Vec<String> {
    let mut broken = Vec::new();
    for (number, target) in targets(text) {
        if ["http://", "https://", "mailto:"].iter().any(|scheme| target.starts_with(scheme)) {
            continue;
        }
        let (file, wanted) = target.split_once('#').unwrap_or((&target, ""));
        let at = if file.is_empty() { path.to_owned() } else { path.parent().unwrap().join(file) };
        let is_there = if wanted.is_empty() {
            at.exists()
        } else if at == path {
            has_heading(text, wanted)
        } else {
            fs::read_to_string(&at).is_ok_and(|text| has_heading(&text, wanted))
        };
        if !is_there {
            broken.push(format!("{}:{number}: {target}", path.display()));
        }
    }
    broken
}

/// Where files that documents name may lie: ARCHITECTURE leaves out what all of its names begin with.
const BASES: [&str; 3] = ["", "src", "src/engine"];

/// Names of files and folders in a document that are none. Only names in one of the repository's folders are looked at;
/// build outputs and patterns are not.
fn missing_files(text: &str) -> Vec<(usize, String)> {
    let is_name = |span: &str| span.contains('/') && span.chars().all(|c| c.is_alphanumeric() || "/._-".contains(c));
    let mut missing = Vec::new();
    for (number, line) in outside_code(text) {
        for span in line.split('`').skip(1).step_by(2).filter(|span| is_name(span)) {
            let first = span.split('/').next().unwrap_or_default();
            let mut bases =
                BASES.iter().map(|base| root().join(base)).filter(|base| base.join(first).is_dir()).peekable();
            let is_output = ["", ".", "..", "dist", "target"].contains(&first);
            if !is_output && bases.peek().is_some() && !bases.any(|base| base.join(span).exists()) {
                missing.push((number, span.to_owned()));
            }
        }
    }
    missing
}

/// Whether the pictures are small enough together.
fn are_small(bytes: impl Iterator<Item = u64>) -> bool {
    bytes.sum::<u64>() <= MAX_PICTURE_BYTES
}

#[test]
fn what_is_read_first_is_short() {
    for (name, most) in SHORT {
        let lines = fs::read_to_string(root().join(name)).unwrap().lines().count();
        assert!(lines <= most, "{name} has {lines} lines; at most {most} are allowed");
    }
}

#[test]
fn lines_of_prose_are_legible_in_a_diff() {
    let mut long = Vec::new();
    for (path, text) in documents() {
        long.extend(long_lines(&text).into_iter().map(|number| format!("{}:{number}", path.display())));
    }
    assert!(long.is_empty(), "over {MAX_COLUMNS} characters:\n{}", long.join("\n"));
}

#[test]
fn relative_links_lead_somewhere() {
    let documents = documents();
    assert!(documents.len() > 20, "only {} documents were found", documents.len());
    let broken: Vec<String> = documents.iter().flat_map(|(path, text)| broken_links(path, text)).collect();
    assert!(broken.is_empty(), "links that lead nowhere:\n{}", broken.join("\n"));
}

#[test]
fn files_that_documents_name_exist() {
    let mut missing = Vec::new();
    for (path, text) in documents() {
        missing
            .extend(missing_files(&text).into_iter().map(|(line, name)| format!("{}:{line}: {name}", path.display())));
    }
    assert!(missing.is_empty(), "files that are not there:\n{}", missing.join("\n"));
}

#[test]
fn pictures_are_small_together() {
    let pictures = files(&root().join("docs/pictures"));
    assert!(!pictures.is_empty());
    assert!(are_small(pictures.iter().map(|path| fs::metadata(path).unwrap().len())), "over {MAX_PICTURE_BYTES} bytes");
}

/// Every check finds what was put there for it to find.
#[test]
fn planted_mistakes_are_found() {
    let long = "word ".repeat(30);
    let text = format!("# Title\n{long}\n| {long} |\n```sh\n{long}\n```\n[a]({}) b\n", "x".repeat(120));
    assert_eq!(long_lines(&text), [2]);
    assert_eq!(long_lines(&"é".repeat(MAX_COLUMNS)), [0; 0]);
    assert_eq!(long_lines(&"é".repeat(MAX_COLUMNS + 1)), [1]);

    let readme = root().join("README.md");
    let broken = |text: &str| broken_links(&readme, text).len();
    assert_eq!(broken("[there](ARCHITECTURE.md), [`code`](src), [out](https://example.org/nowhere)"), 0);
    assert_eq!(broken("[gone](docs/nothing-of-this-name.md)"), 1);
    assert_eq!(broken("text\n<img src=\"docs/nothing.png\" alt=\"\"> and ![gone](docs/nothing.svg)"), 2);
    assert_eq!(broken("```\n[gone](nothing.md)\n```\n`[gone](nothing.md)`"), 0);
    assert_eq!(broken("# Some *Title*, no. 2\n[here](#some-title-no-2) [gone](#no-title)"), 1);
    assert_eq!(broken("[there](ARCHITECTURE.md#the-way-through) [gone](ARCHITECTURE.md#no-title)"), 1);

    assert!(missing_files("`src/lib.rs`, `formats/mod.rs`, `cpu/`, `and/or`, `gpu/<stage>.rs`, `target/x`").is_empty());
    let missing = missing_files("text\n`src/nothing.rs` and `formats/nothing.rs`\n");
    assert_eq!(missing, [(2, "src/nothing.rs".to_owned()), (2, "formats/nothing.rs".to_owned())]);

    assert!(are_small([MAX_PICTURE_BYTES - 1, 1].into_iter()));
    assert!(!are_small([MAX_PICTURE_BYTES, 1].into_iter()));
}
