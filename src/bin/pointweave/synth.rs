//! `pointweave synth`: runs the method on one exemplar.

use std::io::{IsTerminal as _, stderr};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use pointweave::Domain;
use pointweave::formats::{self, Origin, Project, ReadOptions};
use pointweave::methods;
use pointweave::run::{Event, Plan, Run, RunError, StateTag};

use crate::device::{self, DEVICE_MEMORY, EngineArgument};
use crate::failure::Failure;
use crate::files::{self, Format, LookArguments, Output};
use crate::memory;
use crate::reading::{Opened, ReadArguments};
use crate::settings::{self, BoundaryArgument, Chosen, METHOD_ARGUMENTS, MethodArguments};

/// Most bytes of a saved state: the largest exemplar and output as JSON take a tenth of it.
const MAX_STATE_BYTES: u64 = 200_000_000;

/// Grow a larger pattern out of an exemplar.
///
/// IN is a file, - for standard input, or gallery:NAME for a built-in exemplar. What can be read: tables (CSV, TSV, text in
/// columns), JSON, GeoJSON, the marks of an SVG, NumPy arrays, and the blobs of a PNG. What is left out or had to be guessed
/// is said on standard error. The domain is what --domain says, else what the file declares, as in a line
/// '# domain x0 y0 x1 y1 periodic', else the unit square when all points lie in it and leave no strip of it empty, else the
/// points' bounding box and half a mean spacing around it.
///
/// The same exemplar, parameters and seed give the same points, whatever the number of threads.
#[derive(Debug, Args)]
#[command(after_long_help = after_help())]
pub(crate) struct SynthArguments {
    /// The exemplar: a file, - or gallery:NAME
    #[arg(value_name = "IN", required_unless_present = "resume")]
    input: Option<PathBuf>,
    /// Where to write the result: .csv, .json, .geojson, .svg, .png, .npy, or - for standard output [default: -]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// What to write, whatever the file is called [default: csv on standard output]
    #[arg(long, value_enum)]
    format: Option<Format>,
    /// Longer side of a PNG in pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 1024, value_parser = clap::value_parser!(u32).range(16..=8192))]
    png_size: u32,
    #[command(flatten)]
    look: LookArguments,

    #[command(flatten)]
    reading: ReadArguments,
    #[command(flatten)]
    chosen: MethodArguments,
    /// The rectangle the exemplar's points were cut from
    #[arg(long, value_name = "X0,Y0,X1,Y1", allow_hyphen_values = true, value_parser = settings::parse_domain)]
    domain: Option<Domain>,
    /// What lies beyond the border of the exemplar [default: what the file declares, else open]
    #[arg(long, value_enum)]
    exemplar_boundary: Option<BoundaryArgument>,

    /// What computes
    #[arg(long, value_enum, default_value_t)]
    engine: EngineArgument,
    /// Threads to use [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Refuse to start when more memory than this is needed, in MB [default: three quarters of what is free]
    #[arg(long, value_name = "MB", value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    max_memory: Option<u64>,
    /// Stop after this many iterations altogether, those before a --resume included
    #[arg(long, value_name = "N")]
    max_iterations: Option<u64>,
    /// Write everything needed to continue later, at the end or where --max-iterations stops
    #[arg(long, value_name = "FILE")]
    save_state: Option<PathBuf>,
    /// Continue a saved run or the playground's project, exemplar and parameters included
    #[arg(long, value_name = "FILE", conflicts_with_all = METHOD_ARGUMENTS)]
    #[arg(conflicts_with_all = ["input", "domain", "exemplar_boundary", "columns", "no_projection", "strict"])]
    resume: Option<PathBuf>,
    /// No progress bar, and no word on what was left out of a file or looks odd
    #[arg(short, long)]
    quiet: bool,
}

fn after_help() -> String {
    format!(
        "\
Examples:
  pointweave synth gallery:rings -o rings.svg
  pointweave synth trees.csv -o forest.csv --scale 3x2 --seed 7 --domain 0,0,100,50
  pointweave synth tile.json -o tile.png --boundary periodic --preset balanced
  cat points.txt | pointweave synth - > more.csv
  pointweave synth a.csv -o a.svg --max-iterations 100 --save-state a.state
  pointweave synth --resume a.state -o a.svg
  pointweave synth gallery:houses -o village.svg --glyph tree=disk --palette bright

{}",
        settings::describe_parameters()
    )
}

/// Runs the method and writes the result.
pub(crate) fn run(arguments: SynthArguments) -> Result<(), Failure> {
    let output = Output::new(arguments.output.as_deref(), arguments.format, arguments.png_size, &arguments.look)?;
    if let Some(path) = &arguments.save_state {
        files::check_writable(path)?;
    }
    if let Some(threads) = arguments.threads {
        use_threads(threads)?;
    }
    let memory_limit = arguments.max_memory.map_or_else(memory::default_limit, |megabytes| megabytes * 1_000_000);

    let started = Instant::now();
    let (mut run, origin) = begin(&arguments, memory_limit)?;
    arguments.look.check(run.canvas().exemplar())?;
    let speaking = !arguments.quiet && stderr().is_terminal();
    let gpu = device::choose(arguments.engine)?;
    run.use_gpu(gpu, DEVICE_MEMORY);
    let bar = progress_bar(speaking);
    // On a thread of the pool: from outside it, each of the thirty loops of an iteration would wait for another thread to
    // wake up, a seventh of the time of a small run.
    let outcome = rayon::scope(|_| advance(run.as_mut(), &arguments, &bar));
    bar.finish_and_clear();
    outcome.map_err(|error| Failure::Run(error.to_string()))?;

    let pattern = run.canvas().pattern().map_err(|error| Failure::Run(error.to_string()))?;
    if let Some(path) = &arguments.save_state {
        let state = run.state().map_err(|error| Failure::Run(format!("the state can't be saved: {error}")))?;
        files::write_file(path, state.as_bytes())?;
    }
    output.write(&pattern, &origin, &format!("{} points, synthesised by Pointweave", pattern.len()))?;
    if speaking {
        let (iterations, time) = (run.progress().total_iterations, started.elapsed().as_secs_f64());
        eprintln!("{} points after {iterations} iterations in {time:.1} s: {}", pattern.len(), output.name());
    }
    Ok(())
}

/// Sets the number of threads of everything that follows.
pub(crate) fn use_threads(threads: u16) -> Result<(), Failure> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads.into())
        .build_global()
        .map_err(|error| Failure::Run(format!("{threads} threads can't be started: {error}")))
}

/// A new run, or the saved one, and how the exemplar's file named and placed things.
fn begin(arguments: &SynthArguments, memory_limit: u64) -> Result<(Box<dyn Run>, Origin), Failure> {
    if let Some(path) = &arguments.resume {
        // Its parameters come from a file, so a wrong one is no fault of the command line.
        let (state, origin) = read_state(path)?;
        return methods::resume(&state, memory_limit)
            .map(|run| (run, origin))
            .map_err(|error| match error {
                RunError::State(reason) => format!("'{}' is not a saved state: {reason}", path.display()),
                other => format!("'{}' can't be continued: {other}", path.display()),
            })
            .map_err(Failure::Run);
    }
    let boundary = arguments.exemplar_boundary.map(Into::into);
    // Without --resume the parser makes sure that there is an input.
    let input = arguments.input.as_deref().unwrap_or(Path::new("-"));
    // Checked before the input is read: a wrong command line is told first.
    let Chosen { method, preset, overrides } = arguments.chosen.chosen()?;
    let Opened { pattern: exemplar, origin, .. } =
        arguments.reading.open(input, arguments.domain, boundary, arguments.quiet)?;
    let run = method.start(Plan { exemplar, preset, overrides }, memory_limit).map_err(|error| match error {
        RunError::Parameter(error) => Failure::Usage(error.to_string()),
        other => Failure::Run(other.to_string()),
    })?;
    Ok((run, origin))
}

/// The text of a saved state, or of the one in a project, which knows the origin of its exemplar.
fn read_state(path: &Path) -> Result<(String, Origin), Failure> {
    let bytes = files::read_bytes(path, MAX_STATE_BYTES + 1)?;
    if bytes.len() as u64 > MAX_STATE_BYTES {
        return Err(Failure::Run(format!("'{}' has more than {MAX_STATE_BYTES} bytes", path.display())));
    }
    let refuse = |reason: String| Err(Failure::Run(format!("'{}' is not a saved state: {reason}", path.display())));
    match formats::open(&bytes, None, &ReadOptions::default()).ok().and_then(|reading| reading.project) {
        Some(Project { state: Some(state), origin, .. }) => Ok((state, origin)),
        Some(Project { state: None, .. }) => refuse("the project holds no run".to_owned()),
        None => match String::from_utf8(bytes) {
            Ok(text) => {
                StateTag::of(&text).map_or_else(|error| refuse(error.to_string()), |_| Ok((text, Origin::default())))
            }
            Err(error) => refuse(error.to_string()),
        },
    }
}

/// Drives the run to its end, or to the most iterations asked for.
fn advance(run: &mut dyn Run, arguments: &SynthArguments, bar: &ProgressBar) -> Result<(), RunError> {
    let left = |run: &dyn Run| match arguments.max_iterations {
        Some(max) => u32::try_from(max.saturating_sub(run.progress().total_iterations)).unwrap_or(u32::MAX),
        None => u32::MAX,
    };
    let mut devices_lost = 0;
    while left(run) > 0 {
        match run.advance_by(left(run))? {
            Event::Working => bar.tick(),
            Event::Waiting => run.wait(),
            Event::EngineChanged { reason } => {
                // A device may be lost to a passing fault, a second one hardly.
                devices_lost += 1;
                let again = if devices_lost == 1 { device::open().ok() } else { None };
                let on = if again.is_some() { "a fresh device" } else { "the processor" };
                bar.suspend(|| eprintln!("pointweave: {reason}; going on with {on}"));
                run.use_gpu(again, DEVICE_MEMORY);
            }
            Event::ScaleStarted { progress, .. } | Event::ScaleFinished { progress, .. } => {
                bar.set_position((progress.done * PROGRESS_STEPS) as u64);
            }
            Event::Iterated { progress, losses } => {
                bar.set_position((progress.done * PROGRESS_STEPS) as u64);
                let class = if progress.classes > 1 {
                    let name = &run.canvas().exemplar().class_names()[progress.class];
                    format!("class {}/{} ({name}), ", progress.turn + 1, progress.classes)
                } else {
                    String::new()
                };
                bar.set_message(format!(
                    "{class}scale {}/{}, iteration {}/{}, loss {:.3e}",
                    progress.scale + 1,
                    progress.scales,
                    progress.iteration,
                    progress.iterations,
                    losses.total()
                ));
            }
            Event::Finished => break,
        }
    }
    Ok(())
}

/// The bar counts thousandths of the work.
const PROGRESS_STEPS: f64 = 1000.0;

/// A bar on a terminal, silence elsewhere.
fn progress_bar(speaking: bool) -> ProgressBar {
    if !speaking {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(PROGRESS_STEPS as u64);
    if let Ok(style) = ProgressStyle::with_template("{bar:24} {percent:>3} %  {wide_msg}  {eta} left") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}
