//! One iteration of ours against the same work in PyTorch, turn by turn, so that a busy machine hits both alike.

use std::env;
use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;

use crate::process;
use crate::workload::{Timing, Workload, print_ratio};

/// Options of `cargo xtask bench-peer`.
#[derive(Debug, Args)]
pub(crate) struct PeerArguments {
    #[command(flatten)]
    workload: Workload,
    /// Threads for each contender.
    #[arg(long, default_value_t = 2)]
    threads: usize,
    /// Timed iterations a round, after a warm-up.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    iterations: u32,
    /// Rounds; in each, both contenders have one turn.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
}

/// Runs both, alternately, and prints the ratio.
pub(crate) fn run(arguments: &PeerArguments) -> Result<()> {
    let PeerArguments { workload, threads, iterations, rounds } = arguments;
    let python = python()?;
    let program = build_native()?;
    println!("{workload}; {threads} threads, {iterations} iterations a round");

    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    for round in 1..=*rounds {
        let mut command = process::command(&program);
        command.arg("bench");
        workload.add_to(&mut command, *iterations, *threads);
        let our = Timing::read(&process::read(&mut command)?)?;

        let mut command = process::command(&python);
        command.arg("benches/peer/iteration.py");
        workload.add_to(&mut command, *iterations, *threads);
        let their = Timing::read(&process::read(&mut command)?)?;

        println!(
            "round {round}: Pointweave {:.4} s, PyTorch {:.4} s",
            our.seconds_per_iteration, their.seconds_per_iteration
        );
        ours.push(our);
        theirs.push(their);
    }
    print_ratio(("Pointweave", &ours), ("PyTorch", &theirs));
    Ok(())
}

/// The native program, optimised.
pub(crate) fn build_native() -> Result<PathBuf> {
    process::run(process::cargo().args(["build", "--locked", "--release", "--bin", "pointweave"]))?;
    Ok(process::target().join("release").join(format!("pointweave{}", env::consts::EXE_SUFFIX)))
}

/// A Python with PyTorch: `POINTWEAVE_PEER_PYTHON` when set, else an environment of our own.
fn python() -> Result<PathBuf> {
    if let Some(python) = env::var_os("POINTWEAVE_PEER_PYTHON") {
        return Ok(python.into());
    }
    let folder = process::target().join("peer-venv");
    let python = if cfg!(windows) { folder.join("Scripts/python.exe") } else { folder.join("bin/python") };
    if !python.is_file() {
        let maker = process::find_program(&["python3", "python"])
            .context("no python3 on the path; install it with its venv module, or set POINTWEAVE_PEER_PYTHON")?;
        process::run(process::command(maker).args(["-m", "venv"]).arg(&folder))?;
    }
    // Quick when everything is there already.
    process::run(
        process::command(&python)
            .args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"])
            .args(["--requirement", "benches/peer/requirements.txt"]),
    )?;
    Ok(python)
}
