//! The pictures of the README, from real runs and a real Chromium: strips of exemplar and result, a sheet of the whole
//! gallery, and the page.
//!
//! A strip is what an example's command makes: `examples/01_*.rs` and so on say theirs in their first lines. Strips are
//! the same bytes every time. The sheet and the page are pixels, with at most 256 colours, and follow the machine's fonts.

use std::collections::{BTreeMap, HashMap};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::thread;

use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};

use crate::bench_peer::build_native;
use crate::requirements::{self, Requirement};
use crate::{process, web};

/// Most bytes of all pictures together: a repository keeps every version of them.
const BUDGET: u64 = 1_500_000;
/// Colours of a picture in pixels.
const COLORS: usize = 256;
/// Of these, so many are the most frequent ones, unchanged: backgrounds, lines and letters.
const EXACT_COLORS: usize = 160;
/// Side of an exemplar in a strip, and what is between it and the result, in pixels.
const STRIP_UNIT: f64 = 150.0;
const STRIP_GAP: f64 = 60.0;
/// Around both: what stands on the border of an open pattern stays whole.
const MARGIN: f64 = 6.0;
/// The same as above on the sheet, where results are twice as wide as the exemplar.
const SHEET_UNIT: f64 = 84.0;
const SHEET_GAP: f64 = 8.0;
const SHEET_SCALE: &str = "2x1";
const SHEET_COLUMNS: usize = 4;

/// Options of `cargo xtask pictures`.
#[derive(Debug, Args)]
pub(crate) struct PicturesArguments {
    /// Make only these.
    #[arg(long, value_enum, num_args = 1.., value_name = "KIND")]
    only: Vec<Kind>,
    /// Where they go.
    #[arg(long, value_name = "DIR", default_value = "docs/pictures")]
    folder: PathBuf,
    /// A built page, in place of the one that is built now.
    #[arg(long, value_name = "DIR")]
    dist: Option<PathBuf>,
}

/// The kinds of pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// Exemplar and result of every numbered example: SVG.
    Strips,
    /// Exemplar and result of every entry of the gallery: one PNG.
    Sheet,
    /// The page on a desktop, light and dark, and on a phone: PNG.
    Page,
}

/// Makes the pictures, and fails when they are too large.
pub(crate) fn run(arguments: &PicturesArguments) -> Result<()> {
    let folder = process::root().join(&arguments.folder);
    let work = process::target().join("pictures");
    for folder in [&folder, &work] {
        fs::create_dir_all(folder).with_context(|| format!("{} can't be made", folder.display()))?;
    }
    let wants = |kind| arguments.only.is_empty() || arguments.only.contains(&kind);
    let browser = if wants(Kind::Sheet) || wants(Kind::Page) { Some(Browser::find()?) } else { None };
    // Before anything runs: a page that can't be built shall not cost minutes.
    let dist = match &arguments.dist {
        _ if !wants(Kind::Page) => None,
        Some(dist) => Some(dist.canonicalize().with_context(|| format!("{} is no folder", dist.display()))?),
        None => Some(web::build(&web::BuildArguments { optimize: true, ..Default::default() })?),
    };
    let program = Program(if wants(Kind::Strips) || wants(Kind::Sheet) { build_native()? } else { PathBuf::new() });
    if wants(Kind::Strips) {
        make_strips(&program, &work, &folder)?;
    }
    if let Some(browser) = browser.as_ref().filter(|_| wants(Kind::Sheet)) {
        make_sheet(&program, browser, &work, &folder)?;
    }
    if let (Some(browser), Some(dist)) = (&browser, &dist) {
        browser.shoot(&["page".as_ref(), dist, &work])?;
        for name in ["page-light.png", "page-dark.png", "page-phone.png"] {
            shrink(&work.join(name), &folder.join(name))?;
        }
    }
    check_budget(&folder, BUDGET)
}

/// Fails when what is in the folder is larger than it may be.
fn check_budget(folder: &Path, budget: u64) -> Result<()> {
    let mut sizes: Vec<(u64, String)> = fs::read_dir(folder)
        .with_context(|| format!("{} can't be listed", folder.display()))?
        .map(|entry| {
            let entry = entry?;
            Ok((entry.metadata()?.len(), entry.file_name().to_string_lossy().into_owned()))
        })
        .collect::<Result<_>>()?;
    sizes.sort();
    let all: u64 = sizes.iter().map(|(size, _)| size).sum();
    for (size, name) in sizes.iter().rev() {
        println!("{size:>9} bytes  {name}");
    }
    println!("{all:>9} bytes in {}; the budget is {budget}", folder.display());
    if all > budget {
        bail!("the pictures in {} are {} bytes over their budget of {budget}", folder.display(), all - budget);
    }
    Ok(())
}

// ------------------------------------------------------------------------------------------------------ runs

/// The optimised command line.
struct Program(PathBuf);

impl Program {
    fn run(&self, arguments: &[String]) -> Result<()> {
        process::run(process::command(&self.0).args(arguments))
    }

    /// Runs each list of arguments, as many side by side as there are processors, with a thread each.
    fn run_all(&self, jobs: Vec<Vec<String>>) -> Result<()> {
        let workers = thread::available_parallelism().map_or(1, usize::from);
        let left = Mutex::new(jobs);
        let work = || {
            while let Some(job) = left.lock().ok().and_then(|mut jobs| jobs.pop()) {
                println!("pointweave {}", job.join(" "));
                self.run(&[job, vec!["--threads".to_owned(), "1".to_owned()]].concat())?;
            }
            anyhow::Ok(())
        };
        thread::scope(|scope| {
            let threads: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
            threads.into_iter().try_for_each(|thread| thread.join().unwrap_or_else(|_| bail!("a run panicked")))
        })
    }
}

/// An example's command.
#[derive(Debug, PartialEq)]
struct Strip {
    /// The entry of the gallery.
    entry: String,
    /// All that stands between `pointweave` and `-o`.
    arguments: Vec<String>,
    /// What the command writes, and what the strip is called.
    file: String,
}

/// The command in the head of an example: `//! pointweave synth gallery:NAME … -o FILE.svg`.
fn command_of(example: &str) -> Option<Strip> {
    let line = example.lines().find_map(|line| line.strip_prefix("//! pointweave "))?;
    let (arguments, file) = line.split_once(" -o ")?;
    let arguments: Vec<String> = arguments.split(' ').map(str::to_owned).collect();
    let entry = arguments.iter().find_map(|word| word.strip_prefix("gallery:"))?.to_owned();
    file.ends_with(".svg").then(|| Strip { entry, arguments, file: file.to_owned() })
}

fn strips() -> Result<Vec<Strip>> {
    let folder = process::root().join("examples");
    let mut strips = BTreeMap::new();
    for entry in fs::read_dir(&folder).with_context(|| format!("{} can't be listed", folder.display()))? {
        let (path, name) = {
            let entry = entry?;
            (entry.path(), entry.file_name().to_string_lossy().into_owned())
        };
        if !name.starts_with(|first: char| first.is_ascii_digit()) {
            continue;
        }
        let text = fs::read_to_string(&path).with_context(|| format!("{name} can't be read"))?;
        let strip = command_of(&text).with_context(|| {
            format!("{name} does not say its command, as in '//! pointweave synth gallery:rings -o rings.svg'")
        })?;
        strips.insert(name, strip);
    }
    if strips.is_empty() {
        bail!("{} has no numbered examples", folder.display());
    }
    Ok(strips.into_values().collect())
}

/// The exemplars as SVG, one file an entry.
fn draw_exemplars(program: &Program, work: &Path, entries: impl IntoIterator<Item = String>) -> Result<()> {
    entries.into_iter().try_for_each(|entry| {
        let file = work.join(format!("exemplar-{entry}.svg")).display().to_string();
        program.run(&["gallery".to_owned(), entry, "-o".to_owned(), file])
    })
}

fn make_strips(program: &Program, work: &Path, folder: &Path) -> Result<()> {
    let strips = strips()?;
    draw_exemplars(program, work, strips.iter().map(|strip| strip.entry.clone()))?;
    let job = |strip: &Strip| {
        [strip.arguments.clone(), vec!["-o".to_owned(), work.join(&strip.file).display().to_string()]].concat()
    };
    program.run_all(strips.iter().map(job).collect())?;
    for strip in &strips {
        let exemplar = Drawing::read(&work.join(format!("exemplar-{}.svg", strip.entry)))?;
        let result = Drawing::read(&work.join(&strip.file))?;
        let picture = pair(&exemplar, &result, STRIP_UNIT, STRIP_GAP, true);
        write(&folder.join(&strip.file), picture.as_bytes())?;
    }
    Ok(())
}

fn make_sheet(program: &Program, browser: &Browser, work: &Path, folder: &Path) -> Result<()> {
    let listing = process::read(process::command(&program.0).arg("gallery"))?;
    let entries: Vec<String> =
        listing.lines().filter_map(|line| line.split_whitespace().next()).map(str::to_owned).collect();
    draw_exemplars(program, work, entries.clone())?;
    let job = |entry: &String| -> Vec<String> {
        let file = work.join(format!("sheet-{entry}.svg")).display().to_string();
        ["synth", &format!("gallery:{entry}"), "--scale", SHEET_SCALE, "-o", &file].map(str::to_owned).into()
    };
    program.run_all(entries.iter().map(job).collect())?;
    let mut cells = String::new();
    for entry in &entries {
        let exemplar = Drawing::read(&work.join(format!("exemplar-{entry}.svg")))?;
        let result = Drawing::read(&work.join(format!("sheet-{entry}.svg")))?;
        let picture = format!("pair-{entry}.svg");
        write(&work.join(&picture), pair(&exemplar, &result, SHEET_UNIT, SHEET_GAP, false).as_bytes())?;
        cells.push_str(&format!("<figure><figcaption>{entry}</figcaption><img src=\"{picture}\"></figure>\n"));
    }
    let page = work.join("sheet.html");
    let html = format!(
        "<!doctype html><meta charset=\"utf-8\"><style>
        body {{ margin: 0; padding: 14px; width: max-content; background: #fff; display: grid; gap: 12px 26px;
          grid-template-columns: repeat({SHEET_COLUMNS}, auto); font: 13px sans-serif; color: #222; }}
        figure {{ margin: 0; }} figcaption {{ margin-bottom: 3px; }} img {{ display: block; }}
        </style>\n{cells}"
    );
    write(&page, html.as_bytes())?;
    let picture = work.join("gallery.png");
    browser.shoot(&["sheet".as_ref(), &page, &picture])?;
    shrink(&picture, &folder.join("gallery.png"))
}

fn write(file: &Path, bytes: &[u8]) -> Result<()> {
    fs::write(file, bytes).with_context(|| format!("{} can't be written", file.display()))
}

// ------------------------------------------------------------------------------------------------------ drawings

/// An SVG that the command line wrote.
struct Drawing {
    /// What is drawn, without the outer element and the title.
    body: String,
    /// The border of its points' domain in the drawing: left, top, width, height.
    frame: [f64; 4],
    /// The domain's own width and height.
    size: [f64; 2],
}

impl Drawing {
    fn read(file: &Path) -> Result<Self> {
        let text = fs::read_to_string(file).with_context(|| format!("{} can't be read", file.display()))?;
        Self::parse(&text).with_context(|| format!("{} is no drawing of Pointweave's", file.display()))
    }

    fn parse(text: &str) -> Option<Self> {
        let (head, body) = text.strip_prefix("<svg ")?.split_once('>')?;
        let numbers = |name: &str| -> Option<[f64; 4]> {
            let (_, rest) = head.split_once(&format!("{name}=\""))?;
            let numbers: Vec<f64> =
                rest.split('"').next()?.split(' ').map(str::parse).collect::<Result<_, _>>().ok()?;
            numbers.try_into().ok()
        };
        let body = body.trim_end().strip_suffix("</svg>")?;
        let (before, rest) = body.split_once("<title>")?;
        let (_, after) = rest.split_once("</title>\n")?;
        let [x0, y0, x1, y1] = numbers("data-domain")?;
        Some(Self { body: format!("{before}{after}"), frame: numbers("data-frame")?, size: [x1 - x0, y1 - y0] })
    }

    /// As an element of another SVG, `px` for each unit, its names begun with `prefix`.
    fn place(&self, prefix: &str, [left, top]: [f64; 2], px: f64) -> String {
        let body = self
            .body
            .replace("id=\"", &format!("id=\"{prefix}"))
            .replace("url(#", &format!("url(#{prefix}"))
            .replace("href=\"#", &format!("href=\"#{prefix}"));
        format!(
            "<svg x=\"{left}\" y=\"{top}\" width=\"{}\" height=\"{}\" viewBox=\"{}\" overflow=\"visible\">{body}</svg>\n",
            self.size[0] * px,
            self.size[1] * px,
            self.frame.map(|value| value.to_string()).join(" "),
        )
    }
}

/// The exemplar and, at the same scale, the result; an arrow between them where it is wanted.
fn pair(exemplar: &Drawing, result: &Drawing, unit: f64, gap: f64, arrow: bool) -> String {
    let px = unit / exemplar.size[1];
    let [exemplar_size, result_size] = [exemplar, result].map(|drawing| drawing.size.map(|side| side * px));
    let width = exemplar_size[0] + gap + result_size[0] + 2.0 * MARGIN;
    let height = exemplar_size[1].max(result_size[1]) + 2.0 * MARGIN;
    let (left, middle) = (MARGIN + exemplar_size[0] + gap, height / 2.0);
    let mut picture = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         role=\"img\">\n<title>An exemplar and what was made of it</title>\n<rect width=\"{width}\" height=\"{height}\" \
         fill=\"#fff\"/>\n"
    );
    picture.push_str(&exemplar.place("exemplar-", [MARGIN, middle - exemplar_size[1] / 2.0], px));
    if arrow {
        let (from, to) = (left - 0.75 * gap, left - gap / 4.0);
        picture.push_str(&format!(
            "<path d=\"M{from} {middle}H{to}m-8 -6l8 6l-8 6\" fill=\"none\" stroke=\"#666\" stroke-width=\"2\"/>\n"
        ));
    }
    picture.push_str(&result.place("result-", [left, middle - result_size[1] / 2.0], px));
    picture + "</svg>\n"
}

// ------------------------------------------------------------------------------------------------------ pixels

/// A Chromium that takes pictures; see `tests/browser/pictures.mjs`.
struct Browser(PathBuf);

impl Browser {
    fn find() -> Result<Self> {
        requirements::provide(&[Requirement::Node, Requirement::Npm, Requirement::Chromium], true)?;
        requirements::provide_npm_packages()?;
        Ok(Self(requirements::chromium().context("there is no Chromium")?))
    }

    fn shoot(&self, arguments: &[&Path]) -> Result<()> {
        let mut command = process::command("node");
        process::run(command.arg("tests/browser/pictures.mjs").args(arguments).env("POINTWEAVE_CHROMIUM", &self.0))
    }
}

type Rgb = [u8; 3];

/// Writes a picture again with few colours.
fn shrink(from: &Path, to: &Path) -> Result<()> {
    let bytes = fs::read(from).with_context(|| format!("{} can't be read", from.display()))?;
    let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info()?;
    let mut pixels = vec![0; reader.output_buffer_size().context("the picture is too large")?];
    let frame = reader.next_frame(&mut pixels)?;
    let step = frame.color_type.samples();
    if step < 3 {
        bail!("{} has no colours", from.display());
    }
    let pixels: Vec<Rgb> =
        pixels[..frame.buffer_size()].chunks_exact(step).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    let (palette, places) = quantize(&pixels);

    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, frame.width, frame.height);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(palette.concat());
    encoder.set_compression(png::Compression::High);
    // Neighbours in a palette are no neighbours in colour.
    encoder.set_filter(png::Filter::NoFilter);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&places)?;
    writer.finish()?;
    write(to, &bytes)
}

/// A palette, and each pixel's place in it: the most frequent colours as they are, the others by median cut (Heckbert 1982).
fn quantize(pixels: &[Rgb]) -> (Vec<Rgb>, Vec<u8>) {
    let mut counts: HashMap<Rgb, u64> = HashMap::new();
    for &pixel in pixels {
        *counts.entry(pixel).or_default() += 1;
    }
    let mut colors: Vec<(Rgb, u64)> = counts.into_iter().collect();
    // By frequency, and by colour among equals: the same picture gives the same palette.
    colors.sort_by_key(|&(color, count)| (std::cmp::Reverse(count), color));
    let exact = if colors.len() <= COLORS { colors.len() } else { EXACT_COLORS };
    let mut palette: Vec<Rgb> = colors[..exact].iter().map(|&(color, _)| color).collect();
    let mut boxes = if exact < colors.len() { vec![colors[exact..].to_vec()] } else { Vec::new() };
    let spread = |colors: &[(Rgb, u64)]| -> (u64, usize) {
        let width = |channel: usize| {
            let values = colors.iter().map(|(color, _)| u64::from(color[channel]));
            values.clone().max().unwrap_or(0) - values.min().unwrap_or(0)
        };
        (0..3).map(|channel| (width(channel), channel)).max().unwrap_or((0, 0))
    };
    while boxes.len() + exact < COLORS {
        // The one whose colours are farthest apart, weighted by how many pixels have them.
        let weight = |colors: &Vec<(Rgb, u64)>| spread(colors).0 * colors.iter().map(|(_, count)| count).sum::<u64>();
        let Some(widest) =
            (0..boxes.len()).filter(|&place| spread(&boxes[place]).0 > 0).max_by_key(|&place| weight(&boxes[place]))
        else {
            break;
        };
        let channel = spread(&boxes[widest]).1;
        let mut low = boxes.swap_remove(widest);
        low.sort_by_key(|&(color, _)| (color[channel], color));
        let half = low.iter().map(|(_, count)| count).sum::<u64>() / 2;
        let mut seen = 0;
        let cut = low.iter().position(|(_, count)| {
            seen += count;
            seen > half
        });
        // Neither side may be empty.
        let high = low.split_off(cut.unwrap_or(0).clamp(1, low.len() - 1));
        boxes.extend([low, high]);
    }
    palette.extend(boxes.iter().map(|colors| {
        let all = colors.iter().map(|(_, count)| count).sum::<u64>().max(1);
        [0, 1, 2].map(|channel| {
            let sum: u64 = colors.iter().map(|(color, count)| u64::from(color[channel]) * count).sum();
            // A mean of bytes.
            ((sum + all / 2) / all) as u8
        })
    }));
    let distance = |a: Rgb, b: Rgb| -> u32 { (0..3).map(|one| u32::from(a[one].abs_diff(b[one])).pow(2)).sum() };
    let nearest: HashMap<Rgb, u8> = colors
        .iter()
        .map(|&(color, _)| {
            let place = (0..palette.len()).min_by_key(|&place| distance(palette[place], color)).unwrap_or(0);
            // At most COLORS.
            (color, place as u8)
        })
        .collect();
    let places = pixels.iter().map(|pixel| nearest[pixel]).collect();
    (palette, places)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may fail loudly")]
    use super::*;

    #[test]
    fn few_colours_stay_as_they_are() {
        let pixels: Vec<Rgb> = (0..=255).map(|value| [value, 255 - value, 7]).collect();
        let (palette, places) = quantize(&pixels);
        let shown: Vec<Rgb> = places.iter().map(|&place| palette[usize::from(place)]).collect();
        assert_eq!(shown, pixels);
    }

    #[test]
    fn of_many_colours_the_frequent_ones_stay_and_the_others_move_a_little() {
        let ground = [250, 248, 240];
        let mut pixels: Vec<Rgb> = (0..4096_u32).map(|value| [(value % 256) as u8, (value / 16) as u8, 128]).collect();
        pixels.extend([ground; 500]);
        let (palette, places) = quantize(&pixels);
        assert!(palette.len() <= COLORS && palette.contains(&ground), "{}", palette.len());
        let far = |(pixel, place): (&Rgb, &u8)| {
            (0..3).map(|one| pixel[one].abs_diff(palette[usize::from(*place)][one])).max().unwrap()
        };
        let farthest = pixels.iter().zip(&places).map(far).max().unwrap();
        assert!((1..=40).contains(&farthest), "{farthest}");
        assert_eq!(quantize(&pixels), (palette, places), "the same again");
    }

    #[test]
    fn a_strip_keeps_one_scale_and_no_two_names_alike() {
        let drawing = |domain: &str, frame: &str| {
            let text = format!(
                "<svg xmlns=\"x\" width=\"9\" data-domain=\"{domain}\" data-frame=\"{frame}\">\n<title>3 points</title>\n\
                 <clipPath id=\"tile\"/><g clip-path=\"url(#tile)\"><use href=\"#glyph-0\"/></g>\n</svg>\n"
            );
            Drawing::parse(&text).unwrap()
        };
        let (exemplar, result) = (drawing("0 0 2 1", "5 5 90 45"), drawing("1 1 7 4", "5 5 90 45"));
        let strip = pair(&exemplar, &result, 100.0, 40.0, true);
        assert!(strip.contains("width=\"852\" height=\"312\""), "{strip}");
        assert!(strip.contains("x=\"6\" y=\"106\" width=\"200\" height=\"100\" viewBox=\"5 5 90 45\""), "{strip}");
        assert_eq!(strip.matches("id=\"exemplar-tile\"").count(), 1);
        assert_eq!(strip.matches("url(#result-tile)").count(), 1);
        assert_eq!(strip.matches("href=\"#result-glyph-0\"").count(), 1);
        assert_eq!(strip.matches("<title>").count(), 1);
        assert!(Drawing::parse("<svg width=\"1\"></svg>").is_none());
    }

    #[test]
    fn every_numbered_example_says_its_command() {
        let strips = strips().unwrap();
        assert!(strips.len() >= 5, "{strips:?}");
        let wanted = ["synth", "gallery:rings", "--scale", "3x1"].map(str::to_owned).to_vec();
        let file = "rings.svg".to_owned();
        assert_eq!(
            command_of("//! Rings.\n//!\n//! pointweave synth gallery:rings --scale 3x1 -o rings.svg\n"),
            Some(Strip { entry: "rings".to_owned(), arguments: wanted, file })
        );
        assert_eq!(command_of("//! Rings.\nfn main() {}"), None);
    }

    #[test]
    fn pictures_over_the_budget_are_refused() {
        let folder = std::env::temp_dir().join(format!("pointweave-pictures-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("a.png"), [0; 600]).unwrap();
        fs::write(folder.join("b.svg"), [0; 401]).unwrap();
        let error = check_budget(&folder, 1000).unwrap_err().to_string();
        assert!(error.contains("1 bytes over"), "{error}");
        check_budget(&folder, 1001).unwrap();
        fs::remove_dir_all(&folder).unwrap();

        let committed = process::root().join("docs/pictures");
        if committed.is_dir() {
            check_budget(&committed, BUDGET).unwrap();
        }
    }
}
