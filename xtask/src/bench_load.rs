//! What somebody waits for who opens the page for the first time: on a slow line, with a slow processor, without a cache.
//!
//! The browser, the line and the slow processor are in `benches/load/`, which says what is imitated and what is not.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use serde::Deserialize;
use serde_json::json;

use crate::requirements::{self, Requirement};
use crate::workload::median;
use crate::{process, web};

/// Longest time from the address to moving points that people shall wait, in milliseconds, with the defaults below.
const GOAL_MS: f64 = 3000.0;

/// Options of `cargo xtask bench-load`.
#[derive(Debug, Args)]
pub(crate) struct LoadArguments {
    /// A built page, in place of the one that is built now.
    #[arg(long, value_name = "DIR")]
    dist: Option<PathBuf>,
    /// Another built page, measured by turns with the first; the ratios are printed, too.
    #[arg(long, value_name = "DIR")]
    against: Option<PathBuf>,
    /// Loads of each page.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    runs: u32,
    /// The line in megabits a second.
    #[arg(long, default_value_t = 9.0, value_parser = above_zero)]
    megabits: f64,
    /// From a request to the first byte of its answer, in milliseconds.
    #[arg(long, default_value_t = 60.0, value_parser = above_zero)]
    round_trip: f64,
    /// How many times slower the processor is; 1 leaves it as it is.
    #[arg(long, default_value_t = 4.0, value_parser = one_or_more)]
    slowdown: f64,
    /// How the host compresses.
    #[arg(long, value_enum, default_value_t = Encoding::Gzip)]
    encoding: Encoding,
    /// Open a table as soon as a point has moved, and measure from choosing it to its preview.
    #[arg(long)]
    csv: bool,
    /// Show when each file was asked for and when it had arrived.
    #[arg(long)]
    files: bool,
}

/// What most hosts offer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Encoding {
    /// Level 6.
    Gzip,
    /// Level 5.
    Brotli,
}

fn number(text: &str, least: f64, words: &str) -> Result<f64, String> {
    text.parse().ok().filter(|&value: &f64| value >= least && value.is_finite()).ok_or_else(|| words.to_owned())
}

fn above_zero(text: &str) -> Result<f64, String> {
    number(text, f64::MIN_POSITIVE, "a number above 0 is needed")
}

fn one_or_more(text: &str) -> Result<f64, String> {
    number(text, 1.0, "a number of 1 or more is needed")
}

/// What `benches/load/load.mjs` prints. Times in milliseconds since the navigation began.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Load {
    paint: f64,
    contentful_paint: f64,
    points: f64,
    #[serde(rename = "move")]
    first_move: f64,
    /// From choosing a table to its preview.
    csv: Option<f64>,
    bytes: f64,
    bytes_until_move: f64,
    requests: f64,
    slowed: Option<Slowed>,
    files: Vec<File>,
}

/// How much slower the processor really was.
#[derive(Clone, Copy, Debug, Deserialize)]
struct Slowed {
    page: f64,
    worker: f64,
}

/// A file on its way to the page.
#[derive(Clone, Debug, Deserialize)]
struct File {
    path: String,
    status: u16,
    bytes: f64,
    asked: f64,
    arrived: Option<f64>,
}

/// What is printed of a load: a name, a value and a unit.
type Figure = (&'static str, fn(&Load) -> f64, &'static str);

const FIGURES: [Figure; 8] = [
    ("first paint", |load| load.paint, "ms"),
    ("first contentful paint", |load| load.contentful_paint, "ms"),
    ("first points", |load| load.points, "ms"),
    ("first moving point", |load| load.first_move, "ms"),
    ("from a table to its preview", |load| load.csv.unwrap_or(f64::NAN), "ms"),
    ("on the wire until then", |load| load.bytes_until_move / 1000.0, "kB"),
    ("on the wire in all", |load| load.bytes / 1000.0, "kB"),
    ("requests", |load| load.requests, ""),
];

/// Loads the pages by turns and prints medians.
pub(crate) fn run(arguments: &LoadArguments) -> Result<()> {
    requirements::provide(&[Requirement::Node, Requirement::Npm, Requirement::Chromium], true)?;
    requirements::provide_npm_packages()?;
    let chromium = requirements::chromium().context("there is no Chromium")?;
    let first = match &arguments.dist {
        Some(folder) => folder.clone(),
        None => web::build(&web::BuildArguments { optimize: true, ..Default::default() })?,
    };
    let mut pages = vec![(first, Vec::new())];
    pages.extend(arguments.against.iter().map(|folder| (folder.clone(), Vec::new())));
    for (folder, _) in &mut pages {
        *folder = folder.canonicalize().with_context(|| format!("{} is no folder", folder.display()))?;
        if !folder.join("_headers").is_file() {
            bail!("{} is no built page: it has no _headers", folder.display());
        }
    }
    let LoadArguments { runs, megabits, round_trip, slowdown, encoding, .. } = arguments;
    let coding = if *encoding == Encoding::Gzip { "gzip" } else { "br" };
    println!("{megabits} Mbit/s, {round_trip} ms, processor {slowdown} times slower, {coding}, no cache; {runs} loads");
    for round in 1..=*runs {
        for (number, (folder, loads)) in pages.iter_mut().enumerate() {
            let options = json!({
                "megabits": megabits,
                "roundTripMs": round_trip,
                "slowdown": slowdown,
                "encoding": coding,
                "csv": arguments.csv,
                // Once is enough, and it takes a second.
                "calibrate": round == 1 && number == 0 && *slowdown > 1.0,
            });
            let load = load(folder, &options.to_string(), &chromium)?;
            if let Some(Slowed { page, worker }) = load.slowed {
                println!("measured: the page is {page:.1} times slower, a worker {worker:.1} times");
            }
            println!("round {round}, page {}: first moving point after {:.0} ms", number + 1, load.first_move);
            loads.push(load);
        }
    }
    let loads: Vec<&[Load]> = pages.iter().map(|(_, loads)| loads.as_slice()).collect();
    for (number, (folder, loads)) in pages.iter().enumerate() {
        println!("page {}: {}", number + 1, folder.display());
        if arguments.files {
            print!("{}", timeline(loads));
        }
    }
    print!("{}", table(&loads));
    let reached = middle(loads[0], FIGURES[3].1);
    println!("goal: a point moves after {GOAL_MS} ms; {}", if reached <= GOAL_MS { "reached" } else { "missed" });
    Ok(())
}

fn load(folder: &Path, options: &str, chromium: &Path) -> Result<Load> {
    let mut command = process::command("node");
    command.arg("benches/load/load.mjs").arg(folder).arg(options).env("POINTWEAVE_CHROMIUM", chromium);
    let output = process::read(&mut command)?;
    serde_json::from_str(output.trim()).with_context(|| format!("no report in the output:\n{output}"))
}

fn middle(loads: &[Load], value: impl Fn(&Load) -> f64) -> f64 {
    median(loads.iter().map(value))
}

/// A line a figure, a column a page with the median and the least value (other programs only make it slower), and the ratio
/// of two pages' medians.
fn table(pages: &[&[Load]]) -> String {
    let mut text = format!("{:<28}{}\n", "", "   median    least   ".repeat(pages.len()));
    // What was not asked for has no row.
    for (name, value, unit) in
        FIGURES.into_iter().filter(|(_, value, _)| pages.iter().all(|loads| !middle(loads, value).is_nan()))
    {
        let values: Vec<f64> = pages.iter().map(|loads| middle(loads, value)).collect();
        let least = |loads: &[Load]| loads.iter().map(value).fold(f64::INFINITY, f64::min);
        let columns: String = pages
            .iter()
            .zip(&values)
            .map(|(loads, middle)| format!("{middle:>9.0}{:>9.0} {unit:<2}", least(loads)))
            .collect();
        let ratio = match values[..] {
            [first, second] => format!("   ratio {:.2}", first / second),
            _ => String::new(),
        };
        text.push_str(&format!("{name:<28}{columns}{ratio}\n"));
    }
    text
}

/// Bytes and median times of each file, in the order in which the files were asked for. Answers without a body are counted
/// by the last line.
fn timeline(loads: &[Load]) -> String {
    let mut files: BTreeMap<&str, Vec<&File>> = BTreeMap::new();
    let mut known = Vec::new();
    for file in loads.iter().flat_map(|load| &load.files) {
        if file.status == 200 {
            files.entry(&file.path).or_default().push(file);
        } else {
            known.push(file.bytes);
        }
    }
    let mut lines: Vec<(f64, String)> = files
        .into_iter()
        .map(|(path, files)| {
            let asked = median(files.iter().map(|file| file.asked));
            let arrived = median(files.iter().filter_map(|file| file.arrived));
            let bytes = median(files.iter().map(|file| file.bytes));
            (asked, format!("  {asked:>6.0} to {arrived:>6.0} ms  {bytes:>8.0} bytes  {path}\n"))
        })
        .collect();
    lines.sort_by(|(one, _), (other, _)| one.total_cmp(other));
    let count = known.len() as f64 / loads.len() as f64;
    let bytes = known.iter().sum::<f64>() / loads.len() as f64;
    let rest = format!("  and {count:.0} answers of {bytes:.0} bytes that there was nothing new\n");
    lines.into_iter().map(|(_, line)| line).chain([rest]).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may fail loudly")]
    use super::*;

    const REPORT: &str = r#"{"timeOrigin": 1, "paint": 500, "contentfulPaint": 510.5, "points": 1700, "move": 2000, "csv": null, "slowed": null,
        "bytes": 1000000, "bytesUntilMove": 600000, "requests": 3, "files": [
        {"path": "b.js", "status": 200, "bytes": 20, "asked": 30, "arrived": 90.2},
        {"path": "a.js", "status": 200, "bytes": 10, "asked": 40, "arrived": null},
        {"path": "a.js", "status": 304, "bytes": 5, "asked": 50, "arrived": 60}]}"#;

    fn load(first_move: f64) -> Load {
        Load { first_move, ..serde_json::from_str(REPORT).unwrap() }
    }

    #[test]
    fn medians_and_ratios_are_of_each_page() {
        let (one, other) = ([1.0, 3000.0, 2000.0].map(load), [4000.0, 1.0, 9000.0].map(load));
        let table = table(&[&one, &other]);
        let line = table.lines().find(|line| line.starts_with("first moving point")).unwrap();
        assert_eq!(
            line.split_whitespace().collect::<Vec<_>>()[3..],
            ["2000", "1", "ms", "4000", "1", "ms", "ratio", "0.50"]
        );
        assert!(table.contains("1000 kB"), "{table}");
    }

    #[test]
    fn files_stand_in_the_order_they_were_asked_for() {
        let text = timeline(&[load(1.0)]);
        assert!(text.find("b.js") < text.find("a.js") && text.contains("30 to     90 ms"), "{text}");
        assert!(text.ends_with("and 1 answers of 5 bytes that there was nothing new\n"), "{text}");
    }

    #[test]
    fn a_line_without_speed_is_refused() {
        assert_eq!(above_zero("9"), Ok(9.0));
        for wrong in ["0", "-1", "inf", "NaN", "fast"] {
            assert!(above_zero(wrong).is_err(), "{wrong}");
        }
        assert!(one_or_more("0.5").is_err() && one_or_more("1").is_ok());
    }
}
