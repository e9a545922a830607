//! How good the presets are: every exemplar of the gallery × preset × seed, judged, in a table and on a sheet of pictures.
//!
//! `cargo xtask quality` runs this; so does `cargo run --release --example quality`. Every run is written to the folder
//! as soon as it is done and taken from there the next time, so a long table can be made in pieces; what was made with
//! other parameters is refused. An ablation is the same with `--set` and a `--label` of its own. `--judge` takes the
//! points that lie there and measures them anew.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::Instant;

use anyhow::{Context, Result, bail};
use clap::{Parser, ValueEnum};
use font8x8::{BASIC_FONTS, UnicodeFonts};
use pointweave::analysis::{Comparison, Defects, MarkError, Quality, Score, scores};
use pointweave::engine::gpu::{self, Gpu};
use pointweave::formats::style::Look;
use pointweave::formats::{self, ReadOptions, draw, encode_png, write_csv};
use pointweave::gallery::{self, Entry};
use pointweave::methods::network::{NetworkRun, Parameters, Preset};
use pointweave::run::Event;
use pointweave::{Boundary, PointPattern};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use tiny_skia::{Color, Paint, Pixmap, PixmapPaint, Rect, Transform};

/// Longer side of an output on the sheet, in pixels.
const OUTPUT_PX: f64 = 400.0;
/// Space around everything, in pixels.
const GAP_PX: u32 = 16;
/// Side of a letter: the font's eight pixels, doubled.
const LETTER_PX: u32 = 16;
/// Two lines of text above each pair of pictures.
const TEXT_PX: u32 = 2 * LETTER_PX + GAP_PX;
/// What a run may take, in bytes, of the machine's memory and of a device's.
const MEMORY_LIMIT: u64 = 4_000_000_000;

/// Run the presets on the gallery, judge every output, and write a table and a sheet of pictures.
#[derive(Debug, Parser)]
#[command(name = "quality", max_term_width = 100)]
struct Arguments {
    /// Folder of the results: one file and one picture a run, and for each preset a table and a sheet.
    #[arg(long, default_value = "target/quality")]
    folder: PathBuf,
    /// Make everything anew, whatever lies in the folder.
    #[arg(long)]
    fresh: bool,
    /// Judge the points that lie in the folder anew and run nothing, as after a change of the statistics.
    #[arg(long, conflicts_with = "fresh")]
    judge: bool,
    /// fast, balanced, best, paper: several with commas.
    #[arg(long, value_delimiter = ',', default_values = Preset::ALL.map(Preset::name), value_parser = Preset::from_name)]
    presets: Vec<Preset>,
    /// Seeds of the runs, with commas.
    #[arg(long, value_delimiter = ',', default_values_t = [1, 2, 3])]
    seeds: Vec<u64>,
    /// Only these entries, with commas.
    #[arg(long, value_delimiter = ',', value_name = "NAME")]
    only: Vec<String>,
    /// Boundary of the outputs, open or periodic; each exemplar's own when left out.
    #[arg(long, value_parser = boundary)]
    boundary: Option<Boundary>,
    /// Change a parameter of every run, as in --set channels=16; may be repeated. Wants a --label.
    #[arg(long = "set", value_name = "NAME=VALUE", requires = "label")]
    settings: Vec<String>,
    /// What this ablation is called: a folder of its own.
    #[arg(long)]
    label: Option<String>,
    /// What computes; results of both lie beside each other.
    #[arg(long, value_enum, default_value_t = EngineArgument::Cpu)]
    engine: EngineArgument,
    /// Runs side by side, one thread each; their seconds are those of one thread then.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=64))]
    jobs: u8,
    /// Pairs of pictures in a row.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=12))]
    columns: u32,
}

/// What computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum EngineArgument {
    /// The processor
    Cpu,
    /// A GPU that has passed the probe, or fail
    Gpu,
}

fn boundary(name: &str) -> Result<Boundary, String> {
    [Boundary::Open, Boundary::Periodic]
        .into_iter()
        .find(|boundary| boundary.name() == name)
        .ok_or_else(|| format!("{name:?} is no boundary; choose open or periodic"))
}

/// One run and what is said of it.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Outcome {
    entry: String,
    preset: String,
    seed: u64,
    /// What it was made with.
    #[serde(default)]
    parameters: Map<String, Value>,
    iterations: u64,
    seconds: f64,
    /// Seconds of processor time, which other programs on the machine don't lengthen; only Linux tells.
    #[serde(default)]
    processor_seconds: Option<f64>,
    loss: f64,
    #[serde(flatten)]
    judgement: Judgement,
}

/// What is measured of an output.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Judgement {
    exemplar_points: usize,
    points: usize,
    quality: Quality,
    defects: Defects,
    /// ρ of the exemplar and of the output.
    relative_radius: [f64; 2],
    pair_correlation_error: f64,
    /// The paper's, over its four patches, where there are enough points.
    chamfer: Option<f64>,
    wasserstein: Option<f64>,
    /// Everything that the quality leaves out, on its scale.
    #[serde(default)]
    scores: Vec<Score>,
    /// Pair correlations of the classes, and mark correlations of the attributes, where there are any.
    #[serde(default)]
    classes: Option<MarkError>,
    #[serde(default)]
    marks: Option<MarkError>,
}

impl Judgement {
    fn of(exemplar: &PointPattern, output: &PointPattern, seed: u64) -> Result<Self> {
        let comparison = Comparison::of(exemplar, output, seed)?;
        Ok(Self {
            exemplar_points: exemplar.len(),
            points: output.len(),
            quality: comparison.quality,
            defects: comparison.defects,
            relative_radius: [comparison.exemplar.relative_radius, comparison.output.relative_radius],
            pair_correlation_error: comparison.pair_correlation_error,
            chamfer: comparison.patches.as_ref().map(|patches| patches.chamfer),
            wasserstein: comparison.patches.as_ref().and_then(|patches| patches.wasserstein),
            scores: scores(exemplar, output, seed)?,
            classes: comparison.marks.as_ref().and_then(|marks| marks.classes),
            marks: comparison.marks.as_ref().and_then(|marks| marks.marks),
        })
    }

    fn score(&self, statistic: &str) -> f64 {
        self.scores.iter().find(|one| one.statistic == statistic).map_or(f64::NAN, |one| one.score)
    }
}

impl Outcome {
    fn words(&self) -> String {
        let Judgement { quality, exemplar_points, points, .. } = &self.judgement;
        format!(
            "{:.2} ({:.2} {:.2} {:.2})  {exemplar_points} -> {points} points, {} iterations, {:.1} s",
            quality.score, quality.pair_density, quality.precision, quality.coverage, self.iterations, self.seconds,
        )
    }
}

/// What to run, and where its results lie.
struct Job {
    entry: &'static Entry,
    preset: Preset,
    seed: u64,
    file: PathBuf,
}

impl Job {
    fn name(&self) -> String {
        format!("{} {} {}", self.preset.name(), self.entry.name, self.seed)
    }
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    let entries = chosen(&arguments.only)?;
    let folder = arguments.folder.join(arguments.label.as_deref().unwrap_or("presets"));
    fs::create_dir_all(&folder).with_context(|| format!("the folder {} can't be made", folder.display()))?;
    let mut jobs = Vec::new();
    for &preset in &arguments.presets {
        for &entry in &entries {
            for &seed in &arguments.seeds {
                let border = arguments.boundary.map_or(String::new(), |boundary| format!("-{}", boundary.name()));
                let engine = if arguments.engine == EngineArgument::Gpu { "-gpu" } else { "" };
                let file = folder.join(format!("{}-{}-{seed}{border}{engine}.json", preset.name(), entry.name));
                jobs.push(Job { entry, preset, seed, file });
            }
        }
    }
    let (made, missing): (Vec<&Job>, Vec<&Job>) = jobs.iter().partition(|job| job.file.is_file());
    let left = if arguments.judge {
        if made.is_empty() {
            bail!("there is nothing to judge in {}", folder.display());
        }
        for job in made {
            println!("{}: {}", job.name(), judge_anew(job)?.words());
        }
        Vec::new()
    } else if arguments.fresh {
        jobs.iter().collect()
    } else {
        // Before anything is run: one table shall not hold two sets of parameters.
        made.into_iter().try_for_each(|job| admit(job, &parameters(job, &arguments)?))?;
        missing
    };
    let workers = if left.is_empty() { 0 } else { arguments.jobs };
    let left = Mutex::new(left);
    let failures = Mutex::new(Vec::new());
    let work = || {
        // A device for each job: waiting for one waits for everything on it.
        let gpu = match arguments.engine {
            EngineArgument::Cpu => None,
            EngineArgument::Gpu => Some(pollster::block_on(gpu::probe::open())?),
        };
        loop {
            // In the order of the table.
            let next = left.lock().ok().and_then(|mut left| if left.is_empty() { None } else { Some(left.remove(0)) });
            let Some(job) = next else { break };
            let name = job.name();
            match run(job, &arguments, gpu.as_ref()) {
                Ok(outcome) => println!("{name}: {}", outcome.words()),
                Err(error) => {
                    println!("{name}: {error:#}");
                    failures.lock().map(|mut failures| failures.push(name)).ok();
                }
            }
        }
        anyhow::Ok(())
    };
    match workers {
        0 => {}
        // On a thread of the pool, as `pointweave synth`.
        1 => rayon::scope(|_| work())?,
        _ => {
            let pools = (0..workers)
                .map(|_| rayon::ThreadPoolBuilder::new().num_threads(1).build())
                .collect::<Result<Vec<_>, _>>()?;
            std::thread::scope(|scope| {
                let workers: Vec<_> = pools.iter().map(|pool| scope.spawn(|| pool.install(work))).collect();
                workers
                    .into_iter()
                    .map(|worker| worker.join().unwrap_or_else(|_| bail!("a run panicked")))
                    .collect::<Result<Vec<()>>>()
            })?;
        }
    }
    for &preset in &arguments.presets {
        let (mut outcomes, mut cells) = (Vec::new(), Vec::new());
        for job in jobs.iter().filter(|job| job.preset == preset && job.file.is_file()) {
            outcomes.push(read_outcome(&job.file)?);
            cells.push(read_picture(&job.file.with_extension("png"))?);
        }
        if outcomes.is_empty() {
            continue;
        }
        let table = table(&outcomes);
        println!("\n{}\n{table}", preset.name());
        let named = |extension: &str| folder.join(format!("{}.{extension}", preset.name()));
        fs::write(named("md"), &table).with_context(|| format!("{} can't be written", named("md").display()))?;
        write_picture(lay_out(&cells, arguments.columns)?, &named("png"))?;
        println!("table and pictures: {} and .png", named("md").display());
    }
    let failures = failures.into_inner().unwrap_or_default();
    if !failures.is_empty() {
        bail!("no output for {}", failures.join(", "));
    }
    Ok(())
}

fn chosen(names: &[String]) -> Result<Vec<&'static Entry>> {
    if names.is_empty() {
        return Ok(gallery::entries().iter().collect());
    }
    names
        .iter()
        .map(|name| {
            gallery::find(name).with_context(|| {
                let known: Vec<&str> = gallery::entries().iter().map(|entry| entry.name).collect();
                format!("the gallery has no {name:?}; it has {}", known.join(", "))
            })
        })
        .collect()
}

fn by_name(parameters: &Parameters) -> Result<Map<String, Value>> {
    Ok(serde_json::from_value(serde_json::to_value(parameters)?)?)
}

/// The preset's parameters as they suit the exemplar, with those of the command line.
fn parameters(job: &Job, arguments: &Arguments) -> Result<Parameters> {
    let mut parameters = Parameters::suited_to(job.preset, &job.entry.exemplar());
    parameters.seed = job.seed;
    parameters.boundary = arguments.boundary.unwrap_or(parameters.boundary);
    let mut members = by_name(&parameters)?;
    for setting in &arguments.settings {
        let (name, value) = setting.split_once('=').with_context(|| format!("{setting:?} is not NAME=VALUE"))?;
        if !members.contains_key(name) {
            bail!("there is no parameter {name:?}");
        }
        let value = value.parse().unwrap_or_else(|_| Value::String(value.to_owned()));
        members.insert(name.to_owned(), value);
    }
    Ok(serde_json::from_value(Value::Object(members))?)
}

/// Refuses a result that was made with other parameters.
fn admit(job: &Job, wanted: &Parameters) -> Result<()> {
    let found = read_outcome(&job.file)?.parameters;
    // Through text as well: a number's last digit may be another one then.
    let wanted: Map<String, Value> = serde_json::from_str(&serde_json::to_string(wanted)?)?;
    let differs = |name: &&String| found.get(*name) != wanted.get(*name);
    let Some(name) = wanted.keys().chain(found.keys()).find(differs) else { return Ok(()) };
    let [was, is] = [&found, &wanted].map(|one| one.get(name).map_or("unknown".to_owned(), Value::to_string));
    bail!(
        "{} was made with {name} = {was} and {is} is asked for; give a --label of its own, another --folder, or --fresh \
         to make it anew",
        job.file.display()
    )
}

/// Judges what was made before, and writes it down.
fn judge_anew(job: &Job) -> Result<Outcome> {
    let mut outcome = read_outcome(&job.file)?;
    let (exemplar, points) = (job.entry.exemplar(), job.file.with_extension("csv"));
    let bytes = fs::read(&points).with_context(|| format!("{} can't be read", points.display()))?;
    let output = formats::read(&bytes, Some("points.csv"), &ReadOptions::default())
        .with_context(|| format!("{} is no pattern", points.display()))?;
    outcome.judgement = Judgement::of(&exemplar, &output, job.seed)?;
    write_down(job, &exemplar, &output, &outcome)?;
    Ok(outcome)
}

/// Synthesises, judges, and writes both down.
fn run(job: &Job, arguments: &Arguments, gpu: Option<&Arc<Gpu>>) -> Result<Outcome> {
    let exemplar = job.entry.exemplar();
    let (start, processor_start) = (Instant::now(), processor_seconds(arguments.jobs > 1));
    let parameters = parameters(job, arguments)?;
    let mut synthesis = NetworkRun::new(exemplar.clone(), parameters.clone(), MEMORY_LIMIT)?;
    synthesis.use_gpu(gpu.cloned(), MEMORY_LIMIT);
    let (mut iterations, mut loss) = (0, f64::NAN);
    loop {
        match synthesis.advance()? {
            Event::Finished => break,
            Event::Iterated { progress, losses: terms } => {
                iterations = progress.total_iterations;
                loss = terms.total();
            }
            Event::Waiting => synthesis.wait(),
            // What the processor ended is no result of the device.
            Event::EngineChanged { reason } => bail!("{reason}"),
            Event::Working | Event::ScaleStarted { .. } | Event::ScaleFinished { .. } => {}
        }
    }
    let seconds = start.elapsed().as_secs_f64();
    let processor_seconds = processor_seconds(arguments.jobs > 1).zip(processor_start).map(|(end, start)| end - start);
    let output = synthesis.output()?;
    let outcome = Outcome {
        entry: job.entry.name.to_owned(),
        preset: job.preset.name().to_owned(),
        seed: job.seed,
        parameters: by_name(&parameters)?,
        iterations,
        seconds,
        processor_seconds,
        loss,
        judgement: Judgement::of(&exemplar, &output, job.seed)?,
    };
    let points = job.file.with_extension("csv");
    fs::write(&points, write_csv(&output)).with_context(|| format!("{} can't be written", points.display()))?;
    write_down(job, &exemplar, &output, &outcome)?;
    Ok(outcome)
}

/// Writes the picture and the outcome.
fn write_down(job: &Job, exemplar: &PointPattern, output: &PointPattern, outcome: &Outcome) -> Result<()> {
    write_picture(draw_pair(job.entry, exemplar, output, &outcome.words())?, &job.file.with_extension("png"))?;
    // Last: a run without this file is done again.
    fs::write(&job.file, serde_json::to_vec_pretty(outcome)?)
        .with_context(|| format!("{} can't be written", job.file.display()))
}

/// Processor time so far, of this thread or of all of the program.
fn processor_seconds(thread_only: bool) -> Option<f64> {
    // Nanoseconds come first.
    let read = |file: PathBuf| fs::read_to_string(file).ok()?.split_whitespace().next()?.parse::<f64>().ok();
    let nanoseconds = if thread_only {
        read("/proc/thread-self/schedstat".into())?
    } else {
        fs::read_dir("/proc/self/task").ok()?.flatten().filter_map(|task| read(task.path().join("schedstat"))).sum()
    };
    Some(nanoseconds * 1e-9)
}

fn read_outcome(file: &Path) -> Result<Outcome> {
    let bytes = fs::read(file).with_context(|| format!("{} can't be read", file.display()))?;
    serde_json::from_slice(&bytes)
        .with_context(|| format!("{} is not a result of this program; --fresh makes it anew", file.display()))
}

/// One line an entry, means over the seeds; the last two lines are the mean and the worst over the entries.
fn table(outcomes: &[Outcome]) -> String {
    let mut by_entry: BTreeMap<&str, Vec<&Outcome>> = BTreeMap::new();
    for outcome in outcomes {
        by_entry.entry(&outcome.entry).or_default().push(outcome);
    }
    type Column = (&'static str, fn(&Outcome) -> f64);
    // The first eleven are on the scale of the quality.
    const SCORES: usize = 11;
    let columns: [Column; 27] = [
        ("quality", |o| o.judgement.quality.score),
        ("pairs", |o| o.judgement.quality.pair_density),
        ("precision", |o| o.judgement.quality.precision),
        ("coverage", |o| o.judgement.quality.coverage),
        ("PCF", |o| o.judgement.score("pair correlation")),
        ("nearest", |o| o.judgement.score("nearest neighbours")),
        ("spectrum", |o| o.judgement.score("periodogram")),
        ("Ripley", |o| o.judgement.score("Ripley's L")),
        ("radius", |o| o.judgement.score("ρ")),
        ("Chamfer", |o| o.judgement.score("Chamfer")),
        ("Wasserstein", |o| o.judgement.score("Wasserstein")),
        ("independent", |o| o.judgement.quality.independent),
        ("ρ exemplar", |o| o.judgement.relative_radius[0]),
        ("ρ", |o| o.judgement.relative_radius[1]),
        ("stacked %", |o| 100.0 * o.judgement.defects.stacked),
        ("clumps", |o| o.judgement.defects.clumps),
        ("holes", |o| o.judgement.defects.holes),
        ("border", |o| o.judgement.defects.border.unwrap_or(f64::NAN)),
        ("PCF error", |o| o.judgement.pair_correlation_error),
        ("Chamfer distance", |o| o.judgement.chamfer.unwrap_or(f64::NAN)),
        ("Wasserstein distance", |o| o.judgement.wasserstein.unwrap_or(f64::NAN)),
        ("class PCFs", |o| o.judgement.classes.map_or(f64::NAN, |one| one.error)),
        ("at random", |o| o.judgement.classes.map_or(f64::NAN, |one| one.random)),
        ("marks", |o| o.judgement.marks.map_or(f64::NAN, |one| one.error)),
        ("at random", |o| o.judgement.marks.map_or(f64::NAN, |one| one.random)),
        ("seconds", |o| o.seconds),
        ("processor s", |o| o.processor_seconds.unwrap_or(f64::NAN)),
    ];
    let mut table = String::from("| exemplar | seeds |");
    for (name, _) in &columns {
        let _ = write!(table, " {name} |");
    }
    table.push_str("\n|---|---|");
    table.push_str(&"---:|".repeat(columns.len()));
    table.push('\n');
    let number = |value: f64| if value.is_nan() { "–".to_owned() } else { format!("{value:.3}") };
    let mut means = vec![Vec::new(); columns.len()];
    for (entry, runs) in &by_entry {
        let _ = write!(table, "| {entry} | {} |", runs.len());
        for ((_, value), means) in columns.iter().zip(&mut means) {
            let mean = runs.iter().map(|run| value(run)).sum::<f64>() / runs.len() as f64;
            means.push(mean);
            let _ = write!(table, " {} |", number(mean));
        }
        table.push('\n');
    }
    let _ = write!(table, "| **mean** | |");
    for means in &means {
        let known: Vec<f64> = means.iter().copied().filter(|mean| !mean.is_nan()).collect();
        let _ = write!(table, " {} |", number(known.iter().sum::<f64>() / known.len() as f64));
    }
    let worst = |pick: fn(f64, f64) -> f64, column: usize| means[column].iter().copied().fold(f64::NAN, pick);
    let _ = write!(table, "\n| **worst** | |");
    for (column, (name, _)) in columns.iter().enumerate() {
        let low_is_bad = column < SCORES;
        let value = if name.starts_with('ρ') || ["independent", "at random"].contains(name) {
            f64::NAN
        } else {
            worst(if low_is_bad { f64::min } else { f64::max }, column)
        };
        let _ = write!(table, " {} |", number(value));
    }
    table.push('\n');
    table
}

/// The exemplar, lower left, and the output beside it, under two lines of text.
fn draw_pair(entry: &Entry, exemplar: &PointPattern, output: &PointPattern, words: &str) -> Result<Pixmap> {
    let output_unit = output.domain().exemplar_unit();
    let px_per_unit = OUTPUT_PX / output_unit;
    let output_size = output.domain().size() * px_per_unit;
    let exemplar_size = exemplar.domain().size() * px_per_unit;
    let gap = f64::from(GAP_PX);
    let width = (exemplar_size.x + output_size.x + 3.0 * gap).ceil() as u32;
    let height = output_size.y.max(exemplar_size.y).ceil() as u32 + TEXT_PX + 2 * GAP_PX;
    let mut picture = blank(width.max(words.len() as u32 * LETTER_PX / 2 + 2 * GAP_PX), height)?;

    write_text(&mut picture, entry.name, GAP_PX, GAP_PX, 2);
    write_text(&mut picture, words, GAP_PX, GAP_PX + LETTER_PX + GAP_PX / 2, 1);
    // Without a margin of their own both patterns keep one scale.
    let look = Look { margin: 0.0, ..Look::default() };
    let top = f64::from(TEXT_PX) + gap;
    let mut place = |pattern, x, size: glam::DVec2| draw(pattern, &mut picture, x, top, size.x, size.y, &look);
    place(exemplar, gap, exemplar_size);
    place(output, exemplar_size.x + 2.0 * gap, output_size);
    Ok(picture)
}

fn lay_out(cells: &[Pixmap], columns: u32) -> Result<Pixmap> {
    let columns = columns.min(cells.len() as u32);
    let width = cells.iter().map(Pixmap::width).max().unwrap_or(1);
    let rows: Vec<&[Pixmap]> = cells.chunks(columns as usize).collect();
    let heights: Vec<u32> = rows.iter().map(|row| row.iter().map(Pixmap::height).max().unwrap_or(1)).collect();
    let mut sheet = blank(columns * width, heights.iter().sum())?;
    let mut y = 0;
    for (row, height) in rows.into_iter().zip(heights) {
        for (column, cell) in row.iter().enumerate() {
            let x = column as u32 * width;
            sheet.draw_pixmap(x as i32, y as i32, cell.as_ref(), &PixmapPaint::default(), Transform::identity(), None);
        }
        y += height;
    }
    Ok(sheet)
}

fn blank(width: u32, height: u32) -> Result<Pixmap> {
    let mut picture = Pixmap::new(width, height).context("a picture of this size can't be held")?;
    picture.fill(Color::WHITE);
    Ok(picture)
}

/// Writes a line of the eight-pixel font, every pixel `zoom` wide. What the font lacks is left blank.
fn write_text(picture: &mut Pixmap, text: &str, x: u32, y: u32, zoom: u32) {
    let mut ink = Paint::default();
    ink.set_color_rgba8(0x22, 0x26, 0x2c, 255);
    ink.anti_alias = false;
    let zoom = zoom as f32;
    for (position, letter) in text.chars().enumerate() {
        for (row, bits) in BASIC_FONTS.get(letter).unwrap_or_default().into_iter().enumerate() {
            for column in (0..8).filter(|column| bits >> column & 1 == 1) {
                let left = x as f32 + zoom * (8 * position + column) as f32;
                let top = y as f32 + zoom * row as f32;
                if let Some(pixel) = Rect::from_xywh(left, top, zoom, zoom) {
                    picture.fill_rect(pixel, &ink, Transform::identity(), None);
                }
            }
        }
    }
}

fn write_picture(picture: Pixmap, file: &Path) -> Result<()> {
    fs::write(file, encode_png(picture)?).with_context(|| format!("{} can't be written", file.display()))
}

/// A picture that this program has written: opaque, 8 bits a channel, with alpha.
fn read_picture(file: &Path) -> Result<Pixmap> {
    let bytes = fs::read(file).with_context(|| format!("{} can't be read", file.display()))?;
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info()?;
    let (width, height) = (reader.info().width, reader.info().height);
    let mut picture = Pixmap::new(width, height).context("a picture of this size can't be held")?;
    if reader.output_buffer_size() != Some(picture.data().len()) {
        bail!("{} was not written by this program; remove it", file.display());
    }
    reader.next_frame(picture.data_mut())?;
    Ok(picture)
}
