//! `pointweave analyze`: statistics of a pattern, or of an output against its exemplar.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;
use pointweave::analysis::{self, Analysis, Comparison, MarkError, Scales};

use pointweave::formats::{self, Note};
use pointweave::pattern::Window;
use pointweave::{Domain, PointPattern};
use serde::Serialize;

use crate::failure::Failure;
use crate::files;
use crate::reading::{Opened, ReadArguments};
use crate::settings::{self, BoundaryArgument};

/// Measure a pattern, or judge an output by its exemplar.
///
/// With A alone: spacing, regularity, pair correlation, spectrum, Ripley's L and ρ of one pattern. With A and B: the
/// same of both, how well B reproduces A, and what is wrong with it, in numbers and in words. A and B are files, -
/// for standard input, or gallery:NAME; both must be in the same unit of length.
///
/// Quality is 0 for points placed by chance and 1 for A tiled onto B's domain. It is the mean of three: the arrangement
/// of pairs within 3.5 mean spacings, how well B's neighbourhoods are found in A (detail), and A's in B (variety). A
/// random pattern has a lower ceiling than 1: an independent sample of the same process.
///
/// With several classes or attributes it also says how far their curves are from A's (the pair correlation of each
/// pair of classes, the mark correlation of each attribute; mean squared differences), and how far they would be with
/// B's classes, or the values within its classes, given out at random.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  pointweave analyze gallery:blue-noise
  pointweave analyze trees.csv forest.csv
  pointweave synth gallery:rings | pointweave analyze gallery:rings - --svg report.svg
  pointweave analyze a.csv b.csv --json | jq .comparison.quality.score")]
pub(crate) struct AnalyzeArguments {
    /// The pattern, or the exemplar B is judged by: a file, - or gallery:NAME
    #[arg(value_name = "A")]
    pattern: PathBuf,
    /// The output: a file, - or gallery:NAME
    #[arg(value_name = "B")]
    output: Option<PathBuf>,
    /// Every number and curve (not the two maps of the report) as one JSON object instead of a table
    #[arg(long)]
    json: bool,
    /// Draw a report with all curves
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    /// Of the random patterns that both are compared with
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    reading: ReadArguments,
    /// No word on what was left out of a file or looks odd
    #[arg(short, long)]
    quiet: bool,
    /// The rectangle A's points were cut from
    #[arg(long, value_name = "X0,Y0,X1,Y1", allow_hyphen_values = true, value_parser = settings::parse_domain)]
    domain: Option<Domain>,
    /// What lies beyond the border of A [default: what the file declares, else open]
    #[arg(long, value_enum)]
    boundary: Option<BoundaryArgument>,
    /// The outline that A's points were cut from, for the statistics of A alone: a file with a GeoJSON polygon, or with
    /// corners, one a line
    #[arg(long, value_name = "FILE", conflicts_with = "output")]
    window: Option<PathBuf>,
    /// The rectangle B's points were cut from
    #[arg(long, value_name = "X0,Y0,X1,Y1", allow_hyphen_values = true, value_parser = settings::parse_domain,
        requires = "output")]
    output_domain: Option<Domain>,
    /// What lies beyond the border of B [default: what the file declares, else open]
    #[arg(long, value_enum, requires = "output")]
    output_boundary: Option<BoundaryArgument>,
}

/// What `--json` prints for one pattern.
#[derive(Serialize)]
struct One {
    scales: Scales,
    analysis: Analysis,
    verdict: String,
}

/// What `--json` prints for two.
#[derive(Serialize)]
struct Two {
    comparison: Comparison,
    verdict: String,
}

/// Measures and prints.
pub(crate) fn run(arguments: &AnalyzeArguments) -> Result<(), Failure> {
    if let Some(path) = &arguments.svg {
        files::check_writable(path)?;
    }
    let stdin = |path: &Path| path.as_os_str() == "-";
    if stdin(&arguments.pattern) && arguments.output.as_deref().is_some_and(stdin) {
        return Err(Failure::Usage("A and B can't both be standard input".to_owned()));
    }
    let boundary = arguments.boundary.map(Into::into);
    let reading = &arguments.reading;
    let opened = reading.open(&arguments.pattern, arguments.domain, boundary, arguments.quiet)?;
    let name = title(&arguments.pattern);
    // An outline that the person gives, else one that the file itself holds.
    let outline = match &arguments.window {
        Some(path) => Some(outline(&opened, path)?),
        None => opened.window.clone(),
    };
    let (pattern, window) = match outline {
        Some(window) => {
            let refused = |error| Failure::Run(format!("{name} can't be cut to its window: {error}"));
            let (pattern, outside) = opened.pattern.cut(&window).map_err(refused)?;
            let points = if outside == 1 { "One point lies".to_owned() } else { format!("{outside} points lie") };
            let note = Note::left_out(format!("{points} outside of the window and had to be left out."));
            let notes = if outside > 0 { vec![note] } else { Vec::new() };
            reading.tell(&files::input_name(&arguments.pattern), &notes, arguments.quiet)?;
            (pattern, Some(window))
        }
        None => (opened.pattern, None),
    };
    match &arguments.output {
        None => {
            let refused = |error| Failure::Run(format!("{name} can't be analysed: {error}"));
            let cloud = analysis::Cloud::of_part(&pattern, window.as_ref()).map_err(refused)?;
            let scales = Scales::of(&cloud).map_err(refused)?;
            let result = Analysis::of_pattern_within(&pattern, window.as_ref(), arguments.seed).map_err(refused)?;
            if let Some(path) = &arguments.svg {
                let svg = formats::write_report(&pattern, &result, &name).map_err(not_drawn)?;
                files::write_file(path, svg.as_bytes())?;
            }
            let verdict = analysis::describe(&result);
            print(arguments.json, &One { scales, analysis: result, verdict }, one_table)
        }
        Some(path) => {
            let boundary = arguments.output_boundary.map(Into::into);
            // What is known of A's columns says nothing of B's.
            let Opened { pattern: output, .. } =
                reading.without_columns().open(path, arguments.output_domain, boundary, arguments.quiet)?;
            let other = title(path);
            let comparison = Comparison::of(&pattern, &output, arguments.seed)
                .map_err(|error| Failure::Run(format!("{name} and {other} can't be compared: {error}")))?;
            if let Some(path) = &arguments.svg {
                let svg = report(&pattern, &output, &comparison, [&name, &other])?;
                files::write_file(path, svg.as_bytes())?;
            }
            let verdict = analysis::verdict(&comparison);
            print(arguments.json, &Two { comparison, verdict }, two_table)
        }
    }
}

/// The window that a file tells, as far as it lies in the domain that was declared.
fn outline(opened: &Opened, path: &Path) -> Result<Window, Failure> {
    let refused =
        |error: &dyn std::fmt::Display| Failure::Run(format!("the window '{}' can't be used: {error}", path.display()));
    let bytes = files::read_bytes(path, formats::MAX_BYTES as u64 + 1)?;
    let window = formats::read_window(&bytes, &opened.origin).map_err(|error| refused(&error))?;
    match opened.declared {
        Some(domain) => window.clipped(domain).map_err(|error| refused(&error)),
        None => Ok(window),
    }
}

fn report(
    pattern: &PointPattern,
    output: &PointPattern,
    comparison: &Comparison,
    names: [&str; 2],
) -> Result<String, Failure> {
    formats::write_comparison_report(pattern, output, comparison, names).map_err(not_drawn)
}

fn not_drawn(error: formats::ReportError) -> Failure {
    Failure::Run(format!("the report can't be drawn: {error}"))
}

fn print<T: Serialize>(json: bool, result: &T, table: fn(&T) -> String) -> Result<(), Failure> {
    let text = if json {
        serde_json::to_string(result).map_err(|error| Failure::Run(error.to_string()))? + "\n"
    } else {
        table(result)
    };
    files::write_stdout(text.as_bytes())
}

/// What a person calls the pattern: the file's name without its folders.
fn title(path: &Path) -> String {
    match path.to_str() {
        Some("-") => "standard input".to_owned(),
        Some(text) if text.starts_with("gallery:") => text.to_owned(),
        _ => path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned()),
    }
}

fn one_table(one: &One) -> String {
    let mut text = format!("{}\n\n", one.verdict);
    numbers(&mut text, &[("", &one.analysis)], &one.scales);
    text
}

fn two_table(two: &Two) -> String {
    let comparison = &two.comparison;
    let mut text = format!("{}\n\n", two.verdict);
    numbers(&mut text, &[("exemplar", &comparison.exemplar), ("output", &comparison.output)], &comparison.scales);
    let quality = &comparison.quality;
    let distances = |one: &analysis::Distances| {
        let own = one.neighbourhoods;
        [one.pair_density, own.precision, own.coverage].map(|value| format!("{value:.3}"))
    };
    let (found, chance, tiled) =
        (distances(&quality.distances), distances(&comparison.chance), distances(&comparison.tiled));
    // Writing to a String can't fail, so the results of `writeln!` are dropped.
    let _ = writeln!(text, "\n{:<36}{:>12}{:>12}{:>12}{:>12}", "quality", "score", "distance", "chance", "tiled");
    let scores = [quality.pair_density, quality.precision, quality.coverage];
    let names = ["arrangement (pair differences)", "detail (precision of neighbours, d)", "variety (coverage, d)"];
    for (i, name) in names.iter().enumerate() {
        let _ = writeln!(text, "{name:<36}{:>12.3}{:>12}{:>12}{:>12}", scores[i], found[i], chance[i], tiled[i]);
    }
    let _ = writeln!(text, "{:<36}{:>12.3}", "all", quality.score);

    let defects = &comparison.defects;
    let mut row = |name: &str, value: String| {
        let _ = writeln!(text, "{name:<36}{value:>12}");
    };
    row("\nstacked points, %", format!("{:.2}", 100.0 * defects.stacked));
    row("tightest clump / exemplar's", format!("{:.3}", defects.clumps));
    row("largest hole / exemplar's", format!("{:.3}", defects.holes));
    if let Some(border) = defects.border {
        row("too many along the border, %", format!("{:+.2}", 100.0 * border));
    }
    row("pair correlation error (MSE)", format!("{:.5}", comparison.pair_correlation_error));
    if let Some(patches) = &comparison.patches {
        let [columns, rows] = patches.patches;
        row(&format!("by {columns} × {rows} patches: Chamfer"), format!("{:.4}", patches.chamfer));
        let distance = patches.wasserstein.map_or("–".to_owned(), |distance| format!("{distance:.4}"));
        row("  Wasserstein", distance);
        row("  pair correlation error", format!("{:.5}", patches.pair_correlation_error));
        row("  the same, kernel of 0.01 r_max", format!("{:.5}", patches.narrow_pair_correlation_error));
        row("  relative radius ρ", format!("{:.4}", patches.relative_radius));
    }
    if let Some(marks) = &comparison.marks {
        text.push_str(&mark_table(marks));
    }
    text
}

/// Classes and attributes, each against the same points with its marks given out at random.
fn mark_table(marks: &analysis::MarkComparison) -> String {
    let mut text = format!("\n{:<36}{:>12}{:>12}{:>12}\n", "classes and attributes", "error", "at random", "better");
    let mut row = |name: &str, one: &MarkError| {
        let better = format!("{:.1} ×", one.factor());
        let _ = writeln!(text, "{name:<36}{:>12.5}{:>12.5}{better:>12}", one.error, one.random);
    };
    let name = |class: u16| marks.class_names.get(usize::from(class)).map_or("?", String::as_str);
    for pair in &marks.class_pairs {
        row(&format!("pairs of {}, {}", name(pair.a), name(pair.b)), &pair.error);
    }
    if let Some(mean) = &marks.classes {
        row("all pairs of classes", mean);
    }
    for attribute in &marks.attributes {
        row(&format!("mark correlation of {}", attribute.name), &attribute.error);
    }
    if let (Some(mean), true) = (&marks.marks, marks.attributes.len() > 1) {
        row("all attributes", mean);
    }
    text
}

/// The numbers of one or two patterns side by side. Lengths are in exemplar units, so that they can be compared.
fn numbers(text: &mut String, sides: &[(&str, &Analysis)], scales: &Scales) {
    if sides.len() > 1 {
        let names: String = sides.iter().map(|(name, _)| format!("{name:>16}")).collect();
        let _ = writeln!(text, "{:<36}{names}", "");
    }
    let mut row = |name: &str, value: &dyn Fn(&Analysis) -> String| {
        let _ = write!(text, "{name:<36}");
        for (_, one) in sides {
            let _ = write!(text, "{:>16}", value(one));
        }
        text.push('\n');
    };
    let length = |value: f64| format!("{value:.5}");
    row("points", &|one| one.points.to_string());
    row("width × height", &|one| format!("{:.3} × {:.3}", one.size[0], one.size[1]));
    row("boundary", &|one| one.boundary.name().to_owned());
    row("density", &|one| format!("{:.2}", one.density));
    row("mean spacing d", &|one| one.spacing.map_or("–".to_owned(), length));
    row("Clark–Evans index", &|one| one.aggregation_index.map_or("–".to_owned(), |index| format!("{index:.4}")));
    row("relative radius ρ", &|one| format!("{:.4}", one.relative_radius));
    for k in 1..=analysis::NEIGHBOURS {
        if sides.iter().all(|(_, one)| one.nearest.len() >= k) {
            row(&format!("neighbour {k}: mean"), &|one| length(one.nearest[k - 1].mean));
            row("  standard deviation", &|one| length(one.nearest[k - 1].standard_deviation));
        }
    }
    row("largest empty circle / d", &|one| format!("{:.4}", one.largest_empty_circle.radius / scales.spacing));
    row("Ripley's L against chance: p", &|one| {
        one.envelope.as_ref().map_or("–".to_owned(), |envelope| format!("{:.2}", envelope.p_value))
    });
    row("within 0.05 d of the border", &|one| match &one.border {
        Some(border) => border.count.to_string(),
        None => "–".to_owned(),
    });
    row("  expected", &|one| match &one.border {
        Some(border) => format!("{:.1}", border.expected),
        None => "–".to_owned(),
    });
}
