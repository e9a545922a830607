//! Disks before and after: overlaps and mark correlations of outputs with and without what keeps them, as a table, and
//! a sheet of pictures with the disks drawn to scale.
//!
//! `cargo run --release --example disks`. Every output is kept in the folder and taken from there the next time.

use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context, Result, bail};
use clap::Parser;
use glam::DVec2;
use pointweave::analysis::{Cloud, OverlapStatistics, PairCorrelationSettings};
use pointweave::formats::encode_png;
use pointweave::gallery;
use pointweave::methods::network::{NetworkRun, Parameters, Preset};
use pointweave::run::Event;
use pointweave::{Boundary, PointPattern};
use tiny_skia::{Color, FillRule, Mask, Paint, PathBuilder, Pixmap, Rect, Stroke, Transform};

/// What a run may take, in bytes.
const MEMORY_LIMIT: u64 = 4_000_000_000;
/// Side of an exemplar in the pictures, in pixels.
const UNIT_PX: f32 = 240.0;
/// Space around a picture, in pixels.
const GAP_PX: f32 = 12.0;
/// The variants: name, disk-overlap, value-swaps.
const VARIANTS: [(&str, f64, u32); 4] =
    [("paper", 0.0, 0), ("disk-overlap", 1.0, 0), ("value-swaps", 0.0, 12), ("both", 1.0, 12)];

/// Synthesise the gallery's disks with and without disk-overlap and value-swaps, and compare.
#[derive(Debug, Parser)]
#[command(name = "disks", max_term_width = 100)]
struct Arguments {
    /// Folder of the outputs, the table and the sheet.
    #[arg(long, default_value = "target/disks")]
    folder: PathBuf,
    /// Make everything anew, whatever lies in the folder.
    #[arg(long)]
    fresh: bool,
    /// The preset: fast, balanced or paper.
    #[arg(long, default_value = "fast", value_parser = Preset::from_name)]
    preset: Preset,
    /// Seeds of the runs, with commas; the pictures show the first.
    #[arg(long, value_delimiter = ',', default_values_t = [1])]
    seeds: Vec<u64>,
    /// Exemplars with an attribute `radius`, with commas.
    #[arg(long, value_delimiter = ',', default_values = ["graded-disks", "packed-disks", "necklaces"])]
    only: Vec<String>,
    /// Variants, with commas: paper (neither), disk-overlap, value-swaps, both.
    #[arg(long, value_delimiter = ',', default_values = VARIANTS.map(|variant| variant.0))]
    variants: Vec<String>,
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    fs::create_dir_all(&arguments.folder)
        .with_context(|| format!("the folder {} can't be made", arguments.folder.display()))?;
    let mut table = String::from(
        "| exemplar | seed | variant | overlap exemplar, % | overlap, % | deepest exemplar | deepest | \
         mark correlation error | variogram error |\n|---|---:|---|---:|---:|---:|---:|---:|---:|\n",
    );
    let mut rows = Vec::new();
    for name in &arguments.only {
        let exemplar = gallery::find(name).with_context(|| format!("the gallery has no {name:?}"))?.exemplar();
        let unit = exemplar.domain().exemplar_unit();
        let (cloud, radii) = disks(&exemplar, unit)?;
        let wanted = OverlapStatistics::of(&cloud, &radii)?;
        let settings = PairCorrelationSettings::suited_to(&cloud);
        let marks = Marks::of(&cloud, &radii, &settings);
        for &seed in &arguments.seeds {
            let mut row = vec![exemplar.clone()];
            for (variant, disk_overlap, value_swaps) in VARIANTS {
                if !arguments.variants.iter().any(|wanted| wanted == variant) {
                    continue;
                }
                let file = arguments.folder.join(format!("{}-{name}-{seed}-{variant}.json", arguments.preset.name()));
                let output: PointPattern = if file.is_file() && !arguments.fresh {
                    serde_json::from_slice(&fs::read(&file)?)
                        .with_context(|| format!("{} is not of this program; --fresh makes it anew", file.display()))?
                } else {
                    let suited = Parameters::suited_to(arguments.preset, &exemplar);
                    let output = run(&exemplar, Parameters { seed, disk_overlap, value_swaps, ..suited })?;
                    fs::write(&file, serde_json::to_vec(&output)?)
                        .with_context(|| format!("{} can't be written", file.display()))?;
                    output
                };
                let (cloud, radii) = disks(&output, unit)?;
                let overlaps = OverlapStatistics::of(&cloud, &radii)?;
                let (correlation, variogram) = marks.error(&Marks::of(&cloud, &radii, &settings));
                writeln!(
                    table,
                    "| {name} | {seed} | {variant} | {:.2} | {:.2} | {:.3} | {:.3} | {correlation:.3} | {variogram:.3} |",
                    100.0 * wanted.fraction,
                    100.0 * overlaps.fraction,
                    wanted.deepest,
                    overlaps.deepest,
                )?;
                row.push(output);
            }
            if rows.len() < arguments.only.len() && seed == arguments.seeds[0] {
                rows.push(row);
            }
        }
    }
    println!("{table}");
    let named = |extension: &str| arguments.folder.join(format!("{}.{extension}", arguments.preset.name()));
    fs::write(named("md"), &table)?;
    fs::write(named("png"), encode_png(draw(&rows)?)?)?;
    println!("table and pictures: {} and .png", named("md").display());
    Ok(())
}

fn run(exemplar: &PointPattern, parameters: Parameters) -> Result<PointPattern> {
    let start = Instant::now();
    let mut synthesis = NetworkRun::new(exemplar.clone(), parameters, MEMORY_LIMIT)?;
    let mut repairs = 0.0;
    loop {
        let before = Instant::now();
        match synthesis.advance()? {
            Event::Finished => break,
            Event::ScaleFinished { .. } => repairs += before.elapsed().as_secs_f64(),
            _ => {}
        }
    }
    eprintln!("{:.1} s, between scales {repairs:.2} s", start.elapsed().as_secs_f64());
    Ok(synthesis.output()?)
}

fn disks(pattern: &PointPattern, unit: f64) -> Result<(Cloud, Vec<f64>)> {
    let Some(radii) = pattern.radii_in(unit) else { bail!("the pattern has no attribute 'radius'") };
    Ok((Cloud::in_unit(pattern, unit)?, radii))
}

/// How values of pairs depend on their distance.
struct Marks {
    /// How many pairs there are, for each point, at each distance.
    pairs: Vec<f64>,
    /// k(r), the mean product of the values of pairs at distance r over the squared mean (Stoyan 1984).
    correlation: Vec<f64>,
    /// γ(r), half of their mean squared difference over the variance (Cressie 1993).
    variogram: Vec<f64>,
}

impl Marks {
    fn of(cloud: &Cloud, values: &[f64], settings: &PairCorrelationSettings) -> Self {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
        let sigma = 0.5 * settings.sigma;
        let at = |sample: usize| (sample as f64 + 0.5) * settings.range / settings.samples as f64;
        let mut sums = vec![[0.0; 3]; settings.samples];
        cloud.neighbours().pairs(settings.range + 3.0 * sigma, |i, j, offset| {
            let product = values[i] * values[j] / (mean * mean);
            let difference = 0.5 * (values[i] - values[j]).powi(2) / variance;
            for (sample, sums) in sums.iter_mut().enumerate() {
                let t = (at(sample) - offset.length()) / sigma;
                let weight = (-0.5 * t * t).exp() / count;
                for (sum, what) in sums.iter_mut().zip([1.0, product, difference]) {
                    *sum += weight * what;
                }
            }
        });
        let quotient = |which: usize| sums.iter().map(|sums| sums[which] / sums[0].max(1e-300)).collect();
        Self { pairs: sums.iter().map(|sums| sums[0]).collect(), correlation: quotient(1), variogram: quotient(2) }
    }

    /// Mean absolute differences of both curves, weighted by the exemplar's number of pairs at each distance.
    fn error(&self, other: &Self) -> (f64, f64) {
        let all: f64 = self.pairs.iter().sum();
        let mean = |own: &[f64], theirs: &[f64]| {
            let terms =
                own.iter().zip(theirs).zip(&self.pairs).map(|((own, theirs), pairs)| pairs * (own - theirs).abs());
            terms.sum::<f64>() / all
        };
        (mean(&self.correlation, &other.correlation), mean(&self.variogram, &other.variogram))
    }
}

/// A row for each exemplar: itself, then its outputs in the order of the variants.
fn draw(rows: &[Vec<PointPattern>]) -> Result<Pixmap> {
    let side = |pattern: &PointPattern, unit: f64| pattern.domain().size().as_vec2() * UNIT_PX / unit as f32;
    let (mut width, mut height) = (0.0_f32, GAP_PX);
    for row in rows {
        let unit = row[0].domain().exemplar_unit();
        width = width.max(row.iter().map(|pattern| side(pattern, unit).x + GAP_PX).sum::<f32>() + GAP_PX);
        height += row.iter().map(|pattern| side(pattern, unit).y).fold(0.0, f32::max) + GAP_PX;
    }
    let (width, height) = (width.ceil() as u32, height.ceil() as u32);
    let mut sheet = Pixmap::new(width, height).context("a picture of this size can't be held")?;
    sheet.fill(Color::WHITE);
    let mut top = GAP_PX;
    for row in rows {
        let unit = row[0].domain().exemplar_unit();
        let mut left = GAP_PX;
        for pattern in row {
            let size = side(pattern, unit);
            let frame = Rect::from_xywh(left, top, size.x, size.y).context("an empty picture")?;
            let mut mask = Mask::new(width, height).context("a picture of this size can't be held")?;
            mask.fill_path(&PathBuilder::from_rect(frame), FillRule::Winding, true, Transform::identity());
            draw_disks(&mut sheet, pattern, (left, top + size.y), unit, &mask)?;
            let mut line = Paint::default();
            line.set_color_rgba8(0x88, 0x8e, 0x96, 255);
            let outline = PathBuilder::from_rect(frame);
            sheet.stroke_path(&outline, &line, &Stroke::default(), Transform::identity(), None);
            left += size.x + GAP_PX;
        }
        top += row.iter().map(|pattern| side(pattern, unit).y).fold(0.0, f32::max) + GAP_PX;
    }
    Ok(sheet)
}

/// Transparent disks: an overlap is darker.
fn draw_disks(
    sheet: &mut Pixmap,
    pattern: &PointPattern,
    (left, foot): (f32, f32),
    unit: f64,
    mask: &Mask,
) -> Result<()> {
    let (mut fill, mut line) = (Paint::default(), Paint::default());
    fill.set_color_rgba8(0x1f, 0x6f, 0xb4, 110);
    line.set_color_rgba8(0x12, 0x3a, 0x5e, 255);
    (fill.anti_alias, line.anti_alias) = (true, true);
    let domain = pattern.domain();
    let images: &[f64] = if pattern.boundary() == Boundary::Periodic { &[-1.0, 0.0, 1.0] } else { &[0.0] };
    let radii = pattern.radii_in(1.0).context("the pattern has no attribute 'radius'")?;
    for (&point, radius) in pattern.positions().iter().zip(radii) {
        for (&x, &y) in images.iter().flat_map(|x| images.iter().map(move |y| (x, y))) {
            let place = (point - domain.min() + DVec2::new(x, y) * domain.size()) / unit;
            let (x, y) = (left + place.x as f32 * UNIT_PX, foot - place.y as f32 * UNIT_PX);
            let Some(circle) = PathBuilder::from_circle(x, y, (radius / unit) as f32 * UNIT_PX) else { continue };
            sheet.fill_path(&circle, &fill, FillRule::Winding, Transform::identity(), Some(mask));
            sheet.stroke_path(
                &circle,
                &line,
                &Stroke { width: 0.8, ..Stroke::default() },
                Transform::identity(),
                Some(mask),
            );
        }
    }
    Ok(())
}
