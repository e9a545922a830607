//! Command line of Pointweave.

mod analyze;
mod bench;
mod device;
mod failure;
mod files;
mod gallery;
mod link;
mod memory;
mod reading;
mod settings;
mod synth;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Grows large point patterns out of small examples.
///
/// Give it an exemplar of a few dozen to a few hundred points; what comes out is a larger pattern with the same
/// structure, in the exemplar's own units, classes and attributes.
#[derive(Debug, Parser)]
#[command(version, max_term_width = 110, after_long_help = AFTER_HELP)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Synth(Box<synth::SynthArguments>),
    Analyze(analyze::AnalyzeArguments),
    Gallery(gallery::GalleryArguments),
    Link(link::LinkArguments),
    Bench(bench::BenchArguments),
    Devices(device::DevicesArguments),
}

const AFTER_HELP: &str = "\
Examples:
  pointweave gallery                                   what exemplars are built in
  pointweave synth gallery:rings -o rings.svg          twice as wide and high, as a picture
  pointweave synth trees.csv -o forest.csv --scale 3   your own points
  pointweave analyze trees.csv forest.csv              how good is it? in numbers and words
  pointweave link encode trees.csv                     the exemplar and its parameters as a link
  pointweave bench --threads 2                         seconds per iteration, by stage
  pointweave devices                                   which GPUs there are, and whether they compute correctly
  pointweave help synth                                everything about synth

Exit codes:
  0  done
  1  failed: a file can't be read or written, a pattern can't be used, not enough memory
  2  the command line can't be understood, or a value in it is out of range
Ctrl-C ends the program at once (130 in a shell) and leaves no half-written file.";

fn main() -> ExitCode {
    let outcome = match Arguments::parse().command {
        Command::Synth(arguments) => synth::run(*arguments),
        Command::Analyze(arguments) => analyze::run(&arguments),
        Command::Gallery(arguments) => gallery::run(&arguments),
        Command::Link(arguments) => link::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Devices(arguments) => device::run(&arguments),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("pointweave: {failure}");
            failure.exit_code()
        }
    }
}
