//! The judge of the presets. The work is in `examples/quality.rs`, so that building the page or running
//! a check never waits for an optimised native build of the crate.

use std::ffi::OsString;

use anyhow::Result;
use clap::Args;

use crate::process;

/// Options of `cargo xtask quality`.
#[derive(Debug, Args)]
#[command(disable_help_flag = true)]
pub(crate) struct QualityArguments {
    /// Passed on; `--help` lists them.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "OPTIONS")]
    options: Vec<OsString>,
}

/// Builds and runs the example.
pub(crate) fn run(arguments: &QualityArguments) -> Result<()> {
    let mut command = process::cargo();
    command.args(["run", "--locked", "--release", "--example", "quality", "--"]).args(&arguments.options);
    process::run(&mut command)
}
