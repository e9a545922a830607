//! `pointweave link`: share links, written and read.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use pointweave::Domain;
use pointweave::formats::Origin;
use pointweave::formats::link::{Link, LinkExemplar, read_link, write_link};

use crate::failure::Failure;
use crate::files::{self, Format, LookArguments, Output};
use crate::reading::{Opened, ReadArguments};
use crate::settings::{self, BoundaryArgument, Chosen, MethodArguments};

/// Write and read share links.
///
/// A link carries an exemplar and the parameters of a run in the fragment of an address, behind the #: the playground
/// opens it, and no server ever sees it.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  pointweave link encode gallery:rings --seed 7
  pointweave link encode trees.csv --preset balanced --scale 3x2
  pointweave link decode 'v=1&preset=fast&seed=7&exemplar=rings' > rings.csv")]
pub(crate) struct LinkArguments {
    #[command(subcommand)]
    command: LinkCommand,
}

#[derive(Debug, Subcommand)]
enum LinkCommand {
    Encode(EncodeArguments),
    Decode(DecodeArguments),
}

/// Print the link of an exemplar and its parameters.
///
/// Points are rounded to 65535ths of the domain; attributes with more than 16 different values to 4095ths of their range.
/// Where that makes the difference between more and less than 2000 characters, a little more, which is then said.
#[derive(Debug, Args)]
struct EncodeArguments {
    /// The exemplar: a file, - for standard input, or gallery:NAME
    #[arg(value_name = "IN")]
    input: PathBuf,
    #[command(flatten)]
    chosen: MethodArguments,
    /// The rectangle the exemplar's points were cut from
    #[arg(long, value_name = "X0,Y0,X1,Y1", allow_hyphen_values = true, value_parser = settings::parse_domain)]
    domain: Option<Domain>,
    /// What lies beyond the border of the exemplar
    #[arg(long, value_enum)]
    exemplar_boundary: Option<BoundaryArgument>,
    #[command(flatten)]
    reading: ReadArguments,
    /// No word on what was left out or looks odd
    #[arg(short, long)]
    quiet: bool,
    /// What to put in front, as in https://example.org/
    #[arg(long, value_name = "ADDRESS", default_value = "")]
    base: String,
}

/// Write a link's exemplar; what else the link says goes to standard error.
#[derive(Debug, Args)]
struct DecodeArguments {
    /// The link, or what stands behind its #
    link: String,
    /// Where to write the exemplar: .csv, .json, .svg, .png, .npy, or - for standard output
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// What to write, whatever the file is called
    #[arg(long, value_enum)]
    format: Option<Format>,
}

/// Writes or reads.
pub(crate) fn run(arguments: &LinkArguments) -> Result<(), Failure> {
    match &arguments.command {
        LinkCommand::Encode(arguments) => encode(arguments),
        LinkCommand::Decode(arguments) => decode(arguments),
    }
}

fn encode(arguments: &EncodeArguments) -> Result<(), Failure> {
    let boundary = arguments.exemplar_boundary.map(Into::into);
    let Opened { pattern, .. } =
        arguments.reading.open(&arguments.input, arguments.domain, boundary, arguments.quiet)?;
    let Chosen { method, preset, overrides } = arguments.chosen.chosen()?;
    let parameters = method.parameters(&preset, &pattern, &overrides);
    let overrides = parameters.map_err(|error| Failure::Usage(error.to_string()))?;

    let name = arguments.input.to_str().and_then(|text| text.strip_prefix("gallery:"));
    let exemplar = match name {
        Some(name) if arguments.domain.is_none() && boundary.is_none() => LinkExemplar::named(name).map_err(failed)?,
        _ => LinkExemplar::Points(pattern),
    };
    let written = write_link(&Link { method, exemplar, preset, overrides, notes: Vec::new() }).map_err(failed)?;
    if let Some(note) = &written.note {
        eprintln!("{note}");
    }
    let fragment = written.fragment;
    files::write_stdout(format!("{}#{fragment}\n", arguments.base.trim_end_matches('#')).as_bytes())
}

fn decode(arguments: &DecodeArguments) -> Result<(), Failure> {
    let output = Output::new(arguments.output.as_deref(), arguments.format, 1024, &LookArguments::default())?;
    let link = read_link(&arguments.link).map_err(failed)?;
    let parameters = link.parameters().map_err(failed)?;
    let Some(pattern) = link.exemplar.pattern() else {
        return Err(Failure::Run("the link's exemplar is not in the gallery".to_owned()));
    };
    for note in &link.notes {
        eprintln!("{note}");
    }
    eprintln!("method {}", link.method.name());
    eprintln!("preset {}", link.preset);
    for (name, value) in &link.overrides {
        eprintln!("{name} {value}");
    }
    if let Some(cost) = link.method.definition().cost(&pattern, &parameters) {
        eprintln!("{} points in, {} out, at most {} iterations", pattern.len(), cost.points, cost.iterations);
    }
    output.write(&pattern, &Origin::default(), &format!("{} points of a link", pattern.len()))
}

fn failed(error: pointweave::formats::link::LinkError) -> Failure {
    Failure::Run(error.to_string())
}
