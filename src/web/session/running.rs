//! A run and the speed it goes at.

use crate::analysis::Judge;
use crate::run::{Event, Run};

/// How much of the newest iteration goes into the smoothed speed.
const SPEED_SMOOTHING: f64 = 0.15;

/// A run and the speed it goes at.
#[derive(Debug)]
pub(super) struct Running {
    pub(super) run: Box<dyn Run>,
    /// Work since the last complete iteration, in milliseconds.
    pub(super) pending_ms: f64,
    /// Iterations that came back since then: a device brings several at once.
    pending: u32,
    /// Milliseconds of work an iteration on this scale, smoothed.
    pub(super) ms_per_iteration: Option<f64>,
    /// Milliseconds of work the whole run would take at the present speed, smoothed.
    pub(super) ms_per_run: Option<f64>,
    /// [`Progress::done`](crate::run::Progress::done) at the last complete iteration.
    pub(super) done: f64,
    pub(super) finished: bool,
    /// Made when statistics are first asked for.
    pub(super) judge: Option<Judge>,
}

fn smooth(old: Option<f64>, new: f64) -> Option<f64> {
    Some(old.map_or(new, |old| old + SPEED_SMOOTHING * (new - old)))
}

impl Running {
    pub(super) fn new(run: Box<dyn Run>) -> Self {
        let done = run.progress().done;
        Self {
            run,
            pending_ms: 0.0,
            pending: 0,
            ms_per_iteration: None,
            ms_per_run: None,
            done,
            finished: false,
            judge: None,
        }
    }

    /// Learns the speed from what came back.
    pub(super) fn flush(&mut self) {
        if self.pending == 0 {
            return;
        }
        self.ms_per_iteration = smooth(self.ms_per_iteration, self.pending_ms / f64::from(self.pending));
        let done = self.run.progress().done;
        if done > self.done {
            self.ms_per_run = smooth(self.ms_per_run, self.pending_ms / (done - self.done));
        }
        self.done = done;
        self.pending_ms = 0.0;
        self.pending = 0;
    }

    pub(super) fn clock(&mut self, event: &Event) {
        match event {
            Event::Iterated { .. } => self.pending += 1,
            // Another grid has another speed, and setting it up belongs to no iteration.
            Event::ScaleStarted { progress, .. } => {
                self.ms_per_iteration = None;
                self.done = progress.done;
                self.pending_ms = 0.0;
                self.pending = 0;
            }
            // A scale that converges early jumps ahead without work.
            Event::ScaleFinished { progress, .. } => {
                self.flush();
                self.done = progress.done;
            }
            Event::Working | Event::Waiting | Event::EngineChanged { .. } | Event::Finished => {}
        }
    }
}
