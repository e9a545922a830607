//! Everything a person does with the repository: build the page, serve it, test, compare, look at the gallery.

mod bench_load;
mod bench_peer;
mod bench_web;
mod offline;
mod pictures;
mod process;
mod quality;
mod requirements;
mod serve;
mod test;
mod web;
mod workload;

use anyhow::Result;
use clap::{Parser, Subcommand};

/// Work on Pointweave.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask", max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Build the page into dist/: the files of www/ and the crate as WebAssembly.
    Build(web::BuildArguments),
    /// Bring dist/'s list of files up to date after some were changed there: version, preloaded modules, service worker, headers.
    Stamp,
    /// Build the WebAssembly modules and hold their sizes against the budgets.
    Size,
    /// Build the page and serve it on this machine.
    Serve(serve::ServeArguments),
    /// Run every check there is: format, lints, native tests, WebAssembly, the page in a browser.
    Test(test::TestArguments),
    /// Run the presets on the gallery, judge every output, and write tables and sheets of pictures.
    Quality(quality::QualityArguments),
    /// Time one iteration against the same work in PyTorch, turn by turn.
    BenchPeer(bench_peer::PeerArguments),
    /// Time one iteration in headless Chromium against native code on one thread, turn by turn.
    BenchWeb(bench_web::WebArguments),
    /// Open the page on a slow line with a slow processor: time to the first paint and to moving points, bytes.
    BenchLoad(bench_load::LoadArguments),
    /// Make the pictures of the README: strips from the examples' commands, the gallery as a sheet, the page.
    Pictures(pictures::PicturesArguments),
}

fn main() -> Result<()> {
    match Arguments::parse().command {
        Command::Build(arguments) => web::build(&arguments).map(|_| ()),
        Command::Stamp => offline::stamp(&web::dist()).map(|_| ()),
        Command::Size => web::size(),
        Command::Serve(arguments) => serve::run(&arguments),
        Command::Test(arguments) => test::run(&arguments),
        Command::Quality(arguments) => quality::run(&arguments),
        Command::BenchPeer(arguments) => bench_peer::run(&arguments),
        Command::BenchWeb(arguments) => bench_web::run(&arguments),
        Command::BenchLoad(arguments) => bench_load::run(&arguments),
        Command::Pictures(arguments) => pictures::run(&arguments),
    }
}
