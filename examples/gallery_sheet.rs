//! The whole gallery on one picture: every exemplar beside what the method makes of it, at the same scale.
//!
//! `cargo xtask gallery-sheet` runs this; so does `cargo run --release --example gallery_sheet`.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use clap::Parser;
use font8x8::{BASIC_FONTS, UnicodeFonts};
use pointweave::formats::style::Look;
use pointweave::formats::{draw, encode_png};
use pointweave::gallery::{self, Entry};
use pointweave::method::{Parameters, Preset};
use pointweave::synthesis::{Event, Synthesis};
use pointweave::{Boundary, PointPattern};
use tiny_skia::{Color, Paint, Pixmap, PixmapPaint, Rect, Transform};

/// Longer side of an output on the sheet, in pixels.
const OUTPUT_PX: f64 = 400.0;
/// Space around everything, in pixels.
const GAP_PX: u32 = 16;
/// Side of a letter: the font's eight pixels, doubled.
const LETTER_PX: u32 = 16;
/// Two lines of text above each pair of pictures.
const TEXT_PX: u32 = 2 * LETTER_PX + GAP_PX;
/// What a run may take, in bytes.
const MEMORY_LIMIT: u64 = 4_000_000_000;

/// Synthesise from every exemplar of the gallery and put the pictures on one sheet.
#[derive(Debug, Parser)]
#[command(name = "gallery-sheet", max_term_width = 100)]
struct Arguments {
    /// The sheet.
    #[arg(short, long, default_value = "target/gallery-sheet.png")]
    output: PathBuf,
    /// Folder for one picture an entry, written as soon as it is done.
    #[arg(long, default_value = "target/gallery")]
    folder: PathBuf,
    /// Take over the pictures that lie in the folder already, instead of making them anew.
    #[arg(long)]
    resume: bool,
    /// fast, balanced or paper.
    #[arg(long, default_value = "fast", value_parser = Preset::from_name)]
    preset: Preset,
    /// Seed of the runs.
    #[arg(long)]
    seed: Option<u64>,
    /// Boundary of the outputs, open or periodic; each exemplar's own when left out.
    #[arg(long, value_parser = boundary)]
    boundary: Option<Boundary>,
    /// Only these entries.
    #[arg(long, num_args = 1.., value_name = "NAME")]
    only: Vec<String>,
    /// Pairs of pictures in a row.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=8))]
    columns: u32,
}

fn boundary(name: &str) -> Result<Boundary, String> {
    [Boundary::Open, Boundary::Periodic]
        .into_iter()
        .find(|boundary| boundary.name() == name)
        .ok_or_else(|| format!("{name:?} is no boundary; choose open or periodic"))
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    let entries = chosen(&arguments.only)?;

    fs::create_dir_all(&arguments.folder)
        .with_context(|| format!("the folder {} can't be made", arguments.folder.display()))?;
    let mut cells = Vec::new();
    let mut failures = Vec::new();
    for entry in &entries {
        let mut parameters = Parameters::suited_to(arguments.preset, &entry.exemplar());
        parameters.seed = arguments.seed.unwrap_or(parameters.seed);
        parameters.boundary = arguments.boundary.unwrap_or(parameters.boundary);
        let name = format!(
            "{}-{}-{}-{}.png",
            entry.name,
            arguments.preset.name(),
            parameters.boundary.name(),
            parameters.seed
        );
        let file = arguments.folder.join(name);
        if arguments.resume && file.is_file() {
            println!("{}: taken from {}", entry.name, file.display());
            cells.push(read_picture(&file)?);
            continue;
        }
        match synthesise(entry, &parameters) {
            Ok(result) => {
                println!("{}: {}", entry.name, result.words());
                let cell = draw_pair(entry, &result)?;
                write_picture(cell.clone(), &file)?;
                cells.push(cell);
            }
            Err(error) => {
                println!("{}: {error:#}", entry.name);
                failures.push(entry.name);
            }
        }
    }
    if !cells.is_empty() {
        write_picture(lay_out(&cells, arguments.columns)?, &arguments.output)?;
        println!("{} of {} pairs are on {}", cells.len(), entries.len(), arguments.output.display());
    }
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

/// What came of one exemplar.
struct Synthesised {
    exemplar: PointPattern,
    output: PointPattern,
    time: Duration,
    iterations: u64,
    loss: f64,
}

impl Synthesised {
    fn words(&self) -> String {
        format!(
            "{} -> {} points, {} iterations, {:.1} s, loss {:.3e}",
            self.exemplar.len(),
            self.output.len(),
            self.iterations,
            self.time.as_secs_f64(),
            self.loss
        )
    }
}

fn synthesise(entry: &Entry, parameters: &Parameters) -> Result<Synthesised> {
    let exemplar = entry.exemplar();
    let start = Instant::now();
    let mut synthesis = Synthesis::new(exemplar.clone(), parameters.clone(), MEMORY_LIMIT)?;
    let (mut iterations, mut loss) = (0, f64::NAN);
    loop {
        match synthesis.advance()? {
            Event::Finished => break,
            Event::Iterated { progress, loss: terms } => {
                iterations = progress.total_iterations;
                loss = terms.total();
            }
            // Nothing here runs on a device.
            Event::Waiting
            | Event::EngineChanged { .. }
            | Event::Working
            | Event::ScaleStarted { .. }
            | Event::ScaleFinished { .. } => {}
        }
    }
    Ok(Synthesised { exemplar, output: synthesis.output()?, time: start.elapsed(), iterations, loss })
}

/// The exemplar, lower left, and the output beside it, under two lines of text.
fn draw_pair(entry: &Entry, result: &Synthesised) -> Result<Pixmap> {
    let output_unit = result.output.domain().exemplar_unit();
    let px_per_unit = OUTPUT_PX / output_unit;
    let output_size = result.output.domain().size() * px_per_unit;
    let exemplar_size = result.exemplar.domain().size() * px_per_unit;
    let gap = f64::from(GAP_PX);
    let width = (exemplar_size.x + output_size.x + 3.0 * gap).ceil() as u32;
    let height = output_size.y.max(exemplar_size.y).ceil() as u32 + TEXT_PX + 2 * GAP_PX;
    let mut picture = blank(width.max(result.words().len() as u32 * LETTER_PX / 2 + 2 * GAP_PX), height)?;

    write_text(&mut picture, entry.name, GAP_PX, GAP_PX, 2);
    write_text(&mut picture, &result.words(), GAP_PX, GAP_PX + LETTER_PX + GAP_PX / 2, 1);
    // Without a margin of their own both patterns keep one scale.
    let look = Look { margin: 0.0, ..Look::default() };
    let top = f64::from(TEXT_PX) + gap;
    let mut place = |pattern, x, size: glam::DVec2| draw(pattern, &mut picture, x, top, size.x, size.y, &look);
    place(&result.exemplar, gap, exemplar_size);
    place(&result.output, exemplar_size.x + 2.0 * gap, output_size);
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
