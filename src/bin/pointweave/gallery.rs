//! `pointweave gallery`: lists and exports the built-in exemplars.

use std::path::PathBuf;

use clap::Args;
use pointweave::formats::Origin;
use pointweave::gallery;

use crate::failure::Failure;
use crate::files::{self, Format, LookArguments, Output};

/// List the built-in exemplars, or write one of them.
///
/// Without a name it lists every exemplar: its name, its number of points, what it teaches. With a name it writes
/// that exemplar to standard output as CSV, or to a file.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  pointweave gallery
  pointweave gallery rings > rings.csv
  pointweave gallery rings -o rings.svg --seed 3
  pointweave gallery houses -o village.png --glyph tree=disk --palette bright")]
pub(crate) struct GalleryArguments {
    /// Which exemplar to write
    name: Option<String>,
    /// Where to write it: .csv, .json, .svg, .png, .npy, or - for standard output
    #[arg(short, long, value_name = "FILE", requires = "name")]
    output: Option<PathBuf>,
    /// What to write, whatever the file is called
    #[arg(long, value_enum, requires = "name")]
    format: Option<Format>,
    /// Another sample of the same kind [default: the exemplar's own]
    #[arg(long, requires = "name")]
    seed: Option<u64>,
    /// Longer side of a PNG in pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 1024, value_parser = clap::value_parser!(u32).range(16..=8192))]
    png_size: u32,
    #[command(flatten)]
    look: LookArguments,
}

/// Lists or exports.
pub(crate) fn run(arguments: &GalleryArguments) -> Result<(), Failure> {
    let Some(name) = &arguments.name else { return files::write_stdout(list().as_bytes()) };
    let entry = files::find_entry(name)?;
    let output = Output::new(arguments.output.as_deref(), arguments.format, arguments.png_size, &arguments.look)?;
    let pattern = arguments.seed.map_or_else(|| entry.exemplar(), |seed| entry.generate(seed));
    arguments.look.check(&pattern)?;
    output.write(&pattern, &Origin::default(), entry.title)
}

fn list() -> String {
    let width = gallery::entries().iter().map(|entry| entry.name.len()).max().unwrap_or(0);
    gallery::entries()
        .iter()
        .map(|entry| format!("{:width$}  {:>4} points  {}\n", entry.name, entry.exemplar().len(), entry.caption))
        .collect()
}
