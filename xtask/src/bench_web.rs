//! One iteration in headless Chromium against native code on one thread, turn by turn.

use anyhow::{Context, Result};
use clap::Args;

use crate::bench_peer::build_native;
use crate::requirements::{self, Requirement};
use crate::serve::{Mount, Running};
use crate::workload::{Timing, Workload, print_ratio};
use crate::{process, web};

/// Options of `cargo xtask bench-web`.
#[derive(Debug, Args)]
pub(crate) struct WebArguments {
    #[command(flatten)]
    workload: Workload,
    /// Timed iterations a round, after a warm-up.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..))]
    iterations: u32,
    /// Rounds; in each, both contenders have one turn.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
}

/// Runs both, alternately, and prints the ratio.
pub(crate) fn run(arguments: &WebArguments) -> Result<()> {
    let WebArguments { workload, iterations, rounds } = arguments;
    requirements::provide(&[Requirement::Node, Requirement::Npm, Requirement::Chromium], true)?;
    requirements::provide_npm_packages()?;
    let chromium = requirements::chromium().context("there is no Chromium")?;
    let program = build_native()?;
    let dist = web::build(&web::BuildArguments { bench: true, ..Default::default() })?;
    let pages = process::root().join("benches/web");
    let server = Running::start("127.0.0.1", 0, vec![Mount::new("", &dist)?, Mount::new("bench", &pages)?])?;
    println!("{workload}; 1 thread, {iterations} iterations a round");

    let (mut native, mut browser) = (Vec::new(), Vec::new());
    for round in 1..=*rounds {
        let mut command = process::command(&program);
        command.arg("bench");
        workload.add_to(&mut command, *iterations, 1);
        let here = Timing::read(&process::read(&mut command)?)?;

        let mut command = process::command("node");
        command.arg("benches/web/run.mjs").arg(format!("{}/bench/", server.url()));
        command.arg(workload.message(*iterations).to_string()).env("POINTWEAVE_CHROMIUM", &chromium);
        let there = Timing::read(&process::read(&mut command)?)?;

        println!(
            "round {round}: native {:.4} s, Chromium {:.4} s",
            here.seconds_per_iteration, there.seconds_per_iteration
        );
        native.push(here);
        browser.push(there);
    }
    server.stop()?;
    print_ratio(("native", &native), ("Chromium", &browser));
    Ok(())
}
