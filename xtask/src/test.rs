//! Every check there is, one step after the other. All steps run, so that one look shows all that is wrong.

use std::env;
use std::fs;
use std::io::IsTerminal;
use std::path::PathBuf;
use std::process::Command;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};

use crate::process;
use crate::requirements::{self, Requirement};
use crate::web;

/// Options of `cargo xtask test`.
#[derive(Debug, Args)]
pub(crate) struct TestArguments {
    /// Run only these steps, after whatever they need.
    #[arg(long, value_enum, num_args = 1.., value_name = "STEP")]
    only: Vec<Step>,
    /// Install nothing; say what is missing instead.
    #[arg(long)]
    no_install: bool,
}

/// The steps, in their order: what fails soonest comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Step {
    /// Node, Chromium, Firefox, a Vulkan driver, npm's packages.
    Requirements,
    /// `cargo fmt --check`.
    Format,
    /// Clippy on everything native and on the WebAssembly library, warnings denied.
    Lint,
    /// The types of the page's scripts, when a tsconfig.json asks for them.
    Types,
    /// All tests of the workspace.
    Native,
    /// The page builds, and its modules keep to their budgets.
    Web,
    /// The WebAssembly module against the native code, in Node.
    Wasm,
    /// The page in headless Chromium, and once in Firefox.
    Browser,
}

/// Natively there is a second method, so that tests see how one is offered.
const PRETEND: &str = "pointweave/pretend-method";

impl Step {
    fn title(self) -> &'static str {
        match self {
            Self::Requirements => "Requirements",
            Self::Format => "Format",
            Self::Lint => "Lint",
            Self::Types => "Types of the page's scripts",
            Self::Native => "Native tests",
            Self::Web => "Page build and module size",
            Self::Wasm => "WebAssembly tests",
            Self::Browser => "Page tests in browsers",
        }
    }

    fn needs(self) -> &'static [Requirement] {
        match self {
            Self::Requirements => &Requirement::ALL,
            Self::Format | Self::Lint => &[],
            Self::Web => &[Requirement::Node, Requirement::Npm],
            // The GPU engine is tested on whatever adapter there is, and none is a failure.
            Self::Native => &[Requirement::Vulkan],
            Self::Types => &[Requirement::Node, Requirement::Npm],
            Self::Wasm => &[Requirement::Node],
            Self::Browser => &[Requirement::Node, Requirement::Npm, Requirement::Chromium, Requirement::Firefox],
        }
    }
}

/// How a step ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Outcome {
    Passed,
    Failed,
    /// The repository has nothing for it.
    Empty,
}

/// A run in progress.
struct Session<'a> {
    arguments: &'a TestArguments,
    /// Summary lines of the test runners, in order.
    summaries: Vec<String>,
    is_page_built: bool,
}

/// Runs the steps and fails when one of them did.
pub(crate) fn run(arguments: &TestArguments) -> Result<()> {
    let start = Instant::now();
    let mut session = Session { arguments, summaries: Vec::new(), is_page_built: false };
    let mut results: Vec<(Step, Outcome, Duration)> = Vec::new();
    for &step in Step::value_variants() {
        if !arguments.only.is_empty() && !arguments.only.contains(&step) {
            continue;
        }
        println!("\n=== {} ===", step.title());
        let begin = Instant::now();
        let outcome = session.step(step).unwrap_or_else(|error| {
            println!("{error:#}");
            Outcome::Failed
        });
        let time = begin.elapsed();
        println!("--- {}: {} in {:.1} s", step.title(), word(outcome), time.as_secs_f64());
        results.push((step, outcome, time));
    }

    println!("\n=== Summary ===");
    for (step, outcome, time) in &results {
        println!("{:<28} {:>7.1} s  {}", step.title(), time.as_secs_f64(), word(*outcome));
    }
    println!("{:<28} {:>7.1} s\n", "Together", start.elapsed().as_secs_f64());
    for line in &session.summaries {
        println!("{line}");
    }
    let count = |wanted| results.iter().filter(|(_, outcome, _)| *outcome == wanted).count();
    println!("{} passed, {} failed", count(Outcome::Passed), count(Outcome::Failed));
    if count(Outcome::Failed) > 0 {
        // The lines above have said everything; another message would only bury them.
        std::process::exit(1);
    }
    Ok(())
}

fn word(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Passed => "passed",
        Outcome::Failed => "FAILED",
        Outcome::Empty => "nothing to do",
    }
}

impl Session<'_> {
    fn step(&mut self, step: Step) -> Result<Outcome> {
        if step == Step::Requirements || self.arguments.only.contains(&step) {
            requirements::provide(step.needs(), !self.arguments.no_install)?;
        }
        match step {
            Step::Requirements => requirements::provide_npm_packages().map(|()| Outcome::Passed),
            Step::Format => self.all(&mut [cargo(&["fmt", "--all", "--check"])]),
            Step::Lint => {
                requirements::provide_target(web::TRIPLE)?;
                let mut native = cargo(&["clippy", "--locked", "--workspace", "--all-targets", "--features", PRETEND]);
                let mut wasm = cargo(&["clippy", "--locked", "--target", "wasm32-unknown-unknown", "--lib"]);
                for command in [&mut native, &mut wasm] {
                    command.args(["--", "--deny", "warnings"]);
                }
                self.all(&mut [native, wasm])
            }
            Step::Types => self.types(),
            Step::Native => {
                self.all(&mut [cargo(&["test", "--locked", "--workspace", "--no-fail-fast", "--features", PRETEND])])
            }
            Step::Web => {
                self.build_page()?;
                web::check_built_size().map(|()| Outcome::Passed)
            }
            Step::Wasm => self.node_tests("tests/wasm"),
            Step::Browser => {
                web::build(&web::BuildArguments { pretend: true, ..Default::default() })?;
                self.node_tests("tests/browser")
            }
        }
    }

    /// Runs every command, even after one has failed.
    fn all(&mut self, commands: &mut [Command]) -> Result<Outcome> {
        let mut outcome = Outcome::Passed;
        for command in commands {
            println!("$ {}", process::words(command));
            let ok = process::watch(command, |line| {
                if is_summary(line) {
                    self.summaries.push(plain(line));
                }
            })?;
            if !ok {
                outcome = Outcome::Failed;
            }
        }
        Ok(outcome)
    }

    fn build_page(&mut self) -> Result<()> {
        if !self.is_page_built {
            web::build(&web::BuildArguments { optimize: true, ..Default::default() })?;
            self.is_page_built = true;
        }
        Ok(())
    }

    fn types(&mut self) -> Result<Outcome> {
        let root = process::root();
        if !root.join("tsconfig.json").is_file() {
            return Ok(Outcome::Empty);
        }
        requirements::provide_npm_packages()?;
        let compiler = root.join("node_modules/.bin/tsc");
        if !compiler.is_file() {
            bail!("{} is missing; package.json must name typescript", compiler.display());
        }
        let mut check = process::command(compiler);
        check.arg("--noEmit");
        self.all(&mut [check])
    }

    /// Runs the `*.test.mjs` files of a folder against the page as it is built from this tree.
    fn node_tests(&mut self, folder: &str) -> Result<Outcome> {
        let files = node_test_files(folder)?;
        if files.is_empty() {
            return Ok(Outcome::Empty);
        }
        requirements::provide_npm_packages()?;
        self.build_page()?;
        let mut tests = process::command("node");
        // One file at a time: the work under test uses every core by itself.
        tests.args(["--test", "--test-reporter=spec", "--test-concurrency=1"]).args(files);
        tests.env("POINTWEAVE_PRETEND_DIST", web::pretend_dist());
        if let Some(chromium) = requirements::chromium() {
            tests.env("POINTWEAVE_CHROMIUM", chromium);
        }
        if let Some(firefox) = requirements::firefox() {
            tests.env("POINTWEAVE_FIREFOX", firefox);
        }
        self.all(&mut [tests])
    }
}

fn cargo(arguments: &[&str]) -> Command {
    let mut command = process::cargo();
    command.args(arguments);
    if std::io::stdout().is_terminal() && env::var_os("NO_COLOR").is_none() {
        command.env("CARGO_TERM_COLOR", "always");
    }
    command
}

/// The test files of a folder, sorted, relative to the root.
fn node_test_files(folder: &str) -> Result<Vec<PathBuf>> {
    let path = process::root().join(folder);
    if !path.is_dir() {
        return Ok(Vec::new());
    }
    let mut files = Vec::new();
    for entry in fs::read_dir(&path).with_context(|| format!("{} can't be listed", path.display()))? {
        let name = entry?.file_name();
        if name.to_string_lossy().ends_with(".test.mjs") {
            files.push(PathBuf::from(folder).join(name));
        }
    }
    files.sort();
    Ok(files)
}

/// Whether a line is a test runner's own count. Runs without a single test are left to the log.
fn is_summary(line: &str) -> bool {
    let line = plain(line);
    let cargo = line.starts_with("test result: ") && !line.contains(" 0 passed; 0 failed; 0 ignored");
    let node = ["tests ", "pass ", "fail ", "skipped ", "cancelled "]
        .iter()
        .any(|count| line.strip_prefix("ℹ ").or(line.strip_prefix("# ")).is_some_and(|rest| rest.starts_with(count)));
    cargo || node
}

/// The line without terminal colours.
fn plain(line: &str) -> String {
    let mut text = String::with_capacity(line.len());
    let mut characters = line.chars();
    while let Some(character) = characters.next() {
        if character == '\u{1b}' {
            // A colour is ESC [ … m.
            for skipped in characters.by_ref() {
                if skipped.is_ascii_alphabetic() {
                    break;
                }
            }
        } else {
            text.push(character);
        }
    }
    text
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may fail loudly")]
    use super::*;

    #[test]
    fn summary_lines_of_both_runners_are_known() {
        for line in [
            "test result: ok. 12 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.1s",
            "test result: \u{1b}[31mFAILED\u{1b}[0m. 0 passed; 1 failed; 0 ignored; 0 measured",
            "test result: ok. 0 passed; 0 failed; 3 ignored; 0 measured; 0 filtered out; finished in 0.1s",
            "ℹ pass 3",
            "\u{1b}[34mℹ fail 0\u{1b}[39m",
            "# tests 3",
        ] {
            assert!(is_summary(line), "{line}");
        }
        for line in [
            "test result: ok. 0 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.0s",
            "test sampling::exact_count ... ok",
            "ℹ duration_ms 3",
            "running 3 tests",
        ] {
            assert!(!is_summary(line), "{line}");
        }
    }

    #[test]
    fn colours_are_taken_out() {
        assert_eq!(plain("a \u{1b}[1m\u{1b}[31mb\u{1b}[0m c"), "a b c");
    }

    #[test]
    fn a_folder_that_is_not_there_has_no_tests() {
        assert!(node_test_files("tests/none-of-this-name").unwrap().is_empty());
    }
}
