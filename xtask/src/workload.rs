//! The iteration that is timed, the same for every contender.

use std::process::Command;

use anyhow::{Context, Result, bail};
use clap::Args;
use serde_json::{Value, json};

/// Size of the work. The defaults are the paper's: see Huang et al. 2022, §4 and §5.
#[derive(Clone, Debug, Args)]
pub(crate) struct Workload {
    /// Columns and rows of the output's sampling grid.
    #[arg(long, default_value = "256x256", value_parser = grid)]
    grid: (u32, u32),
    /// Pixels along a side of the exemplar's grid.
    #[arg(long, default_value_t = 128)]
    exemplar_grid: u32,
    /// Output channels of every random convolution.
    #[arg(long, default_value_t = 120)]
    channels: u32,
    /// Points of the output.
    #[arg(long, default_value_t = 256)]
    points: u32,
}

fn grid(text: &str) -> Result<(u32, u32), String> {
    let read = |side: &str| side.parse::<u32>().ok().filter(|&side| side > 0);
    text.split_once('x')
        .and_then(|(width, height)| Some((read(width)?, read(height)?)))
        .ok_or_else(|| format!("{text:?} is not a grid; write columns and rows like 256x256"))
}

impl Workload {
    /// As options on a command line.
    pub(crate) fn add_to(&self, command: &mut Command, iterations: u32, threads: usize) {
        let (width, height) = self.grid;
        command.args([
            "--grid".to_owned(),
            format!("{width}x{height}"),
            "--exemplar-grid".to_owned(),
            self.exemplar_grid.to_string(),
            "--channels".to_owned(),
            self.channels.to_string(),
            "--points".to_owned(),
            self.points.to_string(),
            "--iterations".to_owned(),
            iterations.to_string(),
            "--threads".to_owned(),
            threads.to_string(),
            "--json".to_owned(),
        ]);
    }

    /// As the message a page gets.
    pub(crate) fn message(&self, iterations: u32) -> Value {
        let (width, height) = self.grid;
        json!({
            "grid": [width, height],
            "exemplarGrid": self.exemplar_grid,
            "channels": self.channels,
            "points": self.points,
            "iterations": iterations,
        })
    }
}

impl std::fmt::Display for Workload {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (width, height) = self.grid;
        let Self { exemplar_grid, channels, points, .. } = self;
        write!(
            formatter,
            "grid {width} × {height}, exemplar grid {exemplar_grid}, {channels} channels, {points} points"
        )
    }
}

/// What a contender reports about itself.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Timing {
    /// Median over the iterations of one start of the program.
    pub(crate) seconds_per_iteration: f64,
    /// The whole report.
    pub(crate) report: Value,
}

impl Timing {
    /// Reads the JSON object a contender prints, as the last line that is one.
    pub(crate) fn read(output: &str) -> Result<Self> {
        let report = output
            .lines()
            .rev()
            .find_map(|line| serde_json::from_str::<Value>(line.trim()).ok().filter(Value::is_object))
            .or_else(|| serde_json::from_str(output).ok())
            .with_context(|| format!("no JSON object in the output:\n{output}"))?;
        match report.get("seconds_per_iteration").and_then(Value::as_f64) {
            Some(seconds) if seconds > 0.0 && seconds.is_finite() => {
                Ok(Self { seconds_per_iteration: seconds, report })
            }
            _ => bail!("'seconds_per_iteration' is missing or not a positive number in {report}"),
        }
    }

    /// Prints the shares by stage, if the report has them.
    pub(crate) fn print_stages(&self, who: &str) {
        let Some(stages) = self.report.get("stages").and_then(Value::as_object) else { return };
        let parts: Vec<String> =
            stages.iter().filter_map(|(name, seconds)| Some(format!("{name} {:.4} s", seconds.as_f64()?))).collect();
        println!("{who}, by stage: {}", parts.join(", "));
    }
}

/// The middle one, or the mean of the two middle ones; NaN for none.
pub(crate) fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => f64::NAN,
        odd if odd % 2 == 1 => values[middle],
        _ => f64::midpoint(values[middle - 1], values[middle]),
    }
}

/// Prints both medians and how many times as long as ours the other takes.
pub(crate) fn print_ratio(ours: (&str, &[Timing]), theirs: (&str, &[Timing])) {
    let middle = |timings: &[Timing]| median(timings.iter().map(|timing| timing.seconds_per_iteration));
    for (who, timings) in [ours, theirs] {
        if let Some(last) = timings.last() {
            last.print_stages(who);
        }
        println!("{who}: {:.4} s per iteration, median of {} rounds", middle(timings), timings.len());
    }
    println!("ratio {} / {}: {:.2}", theirs.0, ours.0, middle(theirs.1) / middle(ours.1));
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may fail loudly")]
    use super::*;

    #[test]
    fn medians() {
        assert_eq!(median([3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median([4.0, 1.0, 2.0, 3.0]), 2.5);
        assert!(median([]).is_nan());
    }

    #[test]
    fn grids() {
        assert_eq!(grid("256x128"), Ok((256, 128)));
        for wrong in ["256", "0x3", "ax3", "3x", "3x4x5"] {
            assert!(grid(wrong).unwrap_err().contains(wrong));
        }
    }

    #[test]
    fn reports_are_read_and_nonsense_is_refused() {
        let timing = Timing::read("warming up\n{\"seconds_per_iteration\": 0.5, \"stages\": {}}\n").unwrap();
        assert_eq!(timing.seconds_per_iteration, 0.5);
        let pretty = "{\n  \"seconds_per_iteration\": 0.25\n}\n";
        assert_eq!(Timing::read(pretty).unwrap().seconds_per_iteration, 0.25);
        for wrong in ["", "{}", "{\"seconds_per_iteration\": 0}", "{\"seconds_per_iteration\": \"fast\"}"] {
            assert!(Timing::read(wrong).is_err(), "{wrong}");
        }
    }
}
