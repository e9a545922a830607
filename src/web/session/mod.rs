//! What a request does. No browser in sight: the clock comes in as a function.

mod device;
mod running;
#[cfg(test)]
mod tests;
mod views;

use std::sync::Arc;

use serde_json::{Map, Value};
use thiserror::Error;

use self::device::cpu;
use self::running::Running;
use self::views::{curves, describe, list_gallery, narrow, output_points, pairs, spectrum, view, view_beside};
use super::protocol::{
    AdapterView, DefectsView, EngineView, PatternView, PeriodogramView, QualityView, Request, Response, Source,
};
use crate::analysis::{AnalysisError, Judge};
use crate::engine::gpu::Gpu;
use crate::gallery;
use crate::methods::{self, Method};
use crate::pattern::{PatternError, PointPattern};
use crate::run::{Edit, Event, ParameterError, Plan, Run, RunError};

/// Memory a run may take, in bytes. A 32-bit address space ends at 4 GB, a phone's patience well before.
const MEMORY_LIMIT: u64 = 1_500_000_000;

/// Memory a run may take on the GPU, in bytes: a browser does not tell what is free.
const DEVICE_MEMORY: u64 = 1_500_000_000;

/// One batch works at most this long, in milliseconds, whatever the page asks: a save or a pause must get through.
const LONGEST_BUDGET_MS: f64 = 1000.0;

/// Why a request was refused.
#[derive(Debug, Error)]
enum Refusal {
    #[error("the points can't be used: {0}")]
    Pattern(#[from] PatternError),
    #[error("there is no exemplar named {0:?} in the gallery")]
    UnknownExemplar(String),
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    #[error(transparent)]
    Run(#[from] RunError),
    #[error("there are no statistics: {0}")]
    Analysis(#[from] AnalysisError),
    #[error("no run has been started yet")]
    NoRun,
    #[error("the run is one of '{present}'; going on with '{wanted}' needs another start")]
    OtherMethod { wanted: String, present: &'static str },
}

/// A batch that is being filled.
struct Pull {
    /// When to stop, and when the last look at the clock was, in milliseconds.
    end: f64,
    before: f64,
    /// Iterations still wanted.
    left: u32,
    /// Whether any came back.
    moved: bool,
    events: Vec<Event>,
}

/// Why a batch is not filled any further.
enum Pulled {
    Full,
    /// For the device.
    Waiting,
    /// The device can't be used any more, for this reason.
    EngineGone(String),
}

/// What one worker holds: at most one run, and at most one device.
#[derive(Debug, Default)]
pub struct Session {
    running: Option<Running>,
    gpu: Option<Arc<Gpu>>,
    /// What the browser says about it.
    adapter: Option<AdapterView>,
    /// How many were lost since the person chose.
    devices_lost: u32,
    /// What computes now, and why, if the page does not know it yet.
    change: Option<(EngineView, Option<String>)>,
}

fn answered(response: Result<Response, Refusal>) -> Response {
    response.unwrap_or_else(|refusal| Response::Error { message: refusal.to_string(), place: None })
}

impl Session {
    /// A session without a run.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Answers one request. `now_ms` is a clock that never runs backwards, in milliseconds.
    pub fn handle(&mut self, request: Request, now_ms: &dyn Fn() -> f64) -> Response {
        let response = match request {
            Request::Describe {} => Ok(describe()),
            // Without waiting there is only one engine; see [`Self::answer`].
            Request::Engine { .. } => Ok(Response::Engine { engine: cpu(), note: None }),
            Request::Gallery {} => Ok(list_gallery()),
            Request::Open { exemplar } => read(exemplar)
                .map(|exemplar| Response::Opened { exemplar: view(&exemplar), pattern: Box::new((&exemplar).into()) }),
            Request::Start { exemplar, method, preset, overrides } => self.start(exemplar, &method, preset, overrides),
            Request::Run { budget_ms, max_iterations } => self.advance(budget_ms, max_iterations, now_ms),
            Request::Touch { points, positions, pinned } => self.touch(points, &positions, pinned),
            Request::Resynthesize { region } => self.resynthesize(&region),
            Request::Continue { method, preset, overrides } => self.continue_with(&method, &preset, &overrides),
            Request::Analyze {} => self.analyze(now_ms),
            Request::Export {} => self.export(),
            Request::Save {} => self.save(),
            Request::Resume { state } => self.resume(&state),
        };
        answered(response)
    }

    fn start(
        &mut self,
        exemplar: Source,
        method: &str,
        preset: String,
        overrides: Map<String, Value>,
    ) -> Result<Response, Refusal> {
        let plan = Plan { exemplar: read(exemplar)?, preset, overrides };
        let run = Method::from_name(method)?.start(plan, MEMORY_LIMIT)?;
        self.adopt(run)
    }

    fn resume(&mut self, state: &str) -> Result<Response, Refusal> {
        self.adopt(methods::resume(state, MEMORY_LIMIT)?)
    }

    fn continue_with(
        &mut self,
        method: &str,
        preset: &str,
        overrides: &Map<String, Value>,
    ) -> Result<Response, Refusal> {
        let run = &self.running.as_ref().ok_or(Refusal::NoRun)?.run;
        if method != run.method() {
            return Err(Refusal::OtherMethod { wanted: method.to_owned(), present: run.method() });
        }
        let run = run.continue_with(preset, overrides, MEMORY_LIMIT)?;
        self.adopt(run)
    }

    fn touch(&mut self, ids: Vec<u32>, positions: &[f64], pinned: bool) -> Result<Response, Refusal> {
        let run = &mut self.running.as_mut().ok_or(Refusal::NoRun)?.run;
        if !positions.is_empty() {
            run.edit(&Edit::Move { ids: ids.clone(), places: pairs(positions) })?;
        }
        run.edit(&Edit::Pin { ids, pinned })?;
        self.moved()
    }

    fn resynthesize(&mut self, region: &[f64]) -> Result<Response, Refusal> {
        let running = self.running.as_mut().ok_or(Refusal::NoRun)?;
        running.run.edit(&Edit::RedoRegion { polygon: pairs(region) })?;
        // The way ahead is another one.
        (running.finished, running.ms_per_run) = (false, None);
        running.done = running.run.progress().done;
        self.moved()
    }

    /// Tells the page of points that a hand has moved.
    fn moved(&mut self) -> Result<Response, Refusal> {
        self.batch(Pull { end: 0.0, before: 0.0, left: 0, moved: true, events: Vec::new() })
    }

    fn adopt(&mut self, mut run: Box<dyn Run>) -> Result<Response, Refusal> {
        // The run before may have been too large for the device.
        self.change = self.gpu.as_ref().map(|gpu| (self.gpu_view(gpu), None));
        run.use_gpu(self.gpu.clone(), DEVICE_MEMORY);
        let canvas = run.canvas();
        let response = Response::Started {
            method: run.method().to_owned(),
            exemplar: view(canvas.exemplar()),
            output: Box::new(PatternView {
                points: output_points(canvas)?,
                ..view_beside(&canvas.pattern()?, canvas.exemplar())
            }),
            parameters: run.parameters(),
            progress: run.progress(),
        };
        self.running = Some(Running::new(run));
        Ok(response)
    }

    /// Starts answering [`Request::Run`].
    fn begin(budget_ms: f64, max_iterations: u32, now_ms: &dyn Fn() -> f64) -> Pull {
        // NaN counts as no budget.
        let budget_ms = if budget_ms > 0.0 { budget_ms.min(LONGEST_BUDGET_MS) } else { 0.0 };
        let start = now_ms();
        Pull { end: start + budget_ms, before: start, left: max_iterations.max(1), moved: false, events: Vec::new() }
    }

    /// Works on the run until the batch is full or there is nothing to do but wait.
    fn pull(&mut self, pull: &mut Pull, now_ms: &dyn Fn() -> f64) -> Result<Pulled, Refusal> {
        let run = self.running.as_mut().ok_or(Refusal::NoRun)?;
        while !run.finished {
            let event = run.run.advance_by(pull.left)?;
            let after = now_ms();
            run.pending_ms += after - pull.before;
            pull.before = after;
            run.clock(&event);
            match event {
                Event::Working => {}
                Event::Waiting if after < pull.end => return Ok(Pulled::Waiting),
                Event::Waiting => break,
                Event::EngineChanged { reason } => return Ok(Pulled::EngineGone(reason)),
                event => {
                    match event {
                        Event::Iterated { .. } => {
                            pull.left -= 1;
                            pull.moved = true;
                        }
                        Event::Finished => run.finished = true,
                        _ => {}
                    }
                    pull.events.push(event);
                }
            }
            // Iterations that came back together go into one batch.
            if pull.left == 0 || (after >= pull.end && !run.run.has_pending_events()) {
                break;
            }
        }
        run.flush();
        Ok(Pulled::Full)
    }

    fn batch(&mut self, pull: Pull) -> Result<Response, Refusal> {
        let (engine, note) = self.change.take().unzip();
        let note = note.flatten();
        let run = self.running.as_ref().ok_or(Refusal::NoRun)?;
        let progress = run.run.progress();
        let moved = pull.moved || run.finished;
        let points = if moved { Some(output_points(run.run.canvas())?) } else { None };
        Ok(Response::Batch {
            events: pull.events,
            progress,
            points,
            iterations_per_second: run.ms_per_iteration.filter(|&ms| ms > 0.0).map(|ms| 1000.0 / ms),
            seconds_left: run.ms_per_run.map(|ms| ms * (1.0 - progress.done).max(0.0) / 1000.0),
            engine,
            note,
            finished: run.finished,
        })
    }

    fn analyze(&mut self, now_ms: &dyn Fn() -> f64) -> Result<Response, Refusal> {
        let run = self.running.as_mut().ok_or(Refusal::NoRun)?;
        let canvas = run.run.canvas();
        let output = canvas.pattern()?;
        let judge = match run.judge.take() {
            Some(judge) => judge,
            None => {
                let seed = run.run.parameters().get("seed").and_then(Value::as_u64).unwrap_or(1);
                Judge::new(canvas.exemplar(), &output, seed)?
            }
        };
        let judge = run.judge.insert(judge);
        // What is made once for a run does not count: it says nothing about the next answer.
        let start = now_ms();
        let live = judge.follow(&output)?;
        let unit = live.scales.spacing;
        let (quality, defects) = (live.quality, live.defects);
        Ok(Response::Analyzed {
            exemplar: curves(&live.exemplar, unit),
            output: curves(&live.output, unit),
            periodogram: PeriodogramView {
                exemplar: spectrum(&live.exemplar, unit),
                output: spectrum(&live.output, unit),
            },
            distance: narrow(&live.exemplar.pair_correlation.radius, 1.0 / unit),
            interval: live.scales.histogram_width / unit,
            quality: QualityView {
                score: quality.score,
                arrangement: quality.pair_density,
                detail: quality.precision,
                variety: quality.coverage,
                independent: quality.independent,
            },
            defects: DefectsView {
                stacked: defects.stacked - defects.exemplar_stacked,
                holes: defects.holes,
                border: defects.border,
            },
            verdict: live.verdict,
            iterations: run.run.progress().total_iterations,
            work_ms: now_ms() - start,
        })
    }

    fn advance(&mut self, budget_ms: f64, max_iterations: u32, now_ms: &dyn Fn() -> f64) -> Result<Response, Refusal> {
        let mut pull = Self::begin(budget_ms, max_iterations, now_ms);
        loop {
            match self.pull(&mut pull, now_ms)? {
                Pulled::Full => break,
                // Only with a device, which only [`Self::answer`] can wait for.
                Pulled::Waiting => break,
                Pulled::EngineGone(reason) => self.leave_device(&reason),
            }
        }
        self.batch(pull)
    }

    /// Answers one request, waiting for the device where that takes waiting.
    pub async fn answer(&mut self, request: Request, now_ms: &dyn Fn() -> f64) -> Response {
        let response = match request {
            Request::Engine { choice, adapter } => Ok(self.choose_engine(choice, adapter).await),
            Request::Run { budget_ms, max_iterations } if self.gpu.is_some() => {
                self.advance_on_device(budget_ms, max_iterations, now_ms).await
            }
            other => return self.handle(other, now_ms),
        };
        answered(response)
    }

    fn export(&self) -> Result<Response, Refusal> {
        let output = self.running.as_ref().ok_or(Refusal::NoRun)?.run.canvas().pattern()?;
        Ok(Response::Exported { pattern: Box::new((&output).into()) })
    }

    fn save(&self) -> Result<Response, Refusal> {
        let run = &self.running.as_ref().ok_or(Refusal::NoRun)?.run;
        Ok(Response::Saved { state: run.state()?, progress: run.progress() })
    }
}

fn read(source: Source) -> Result<PointPattern, Refusal> {
    match source {
        Source::Gallery { name } => {
            gallery::find(&name).map(gallery::Entry::exemplar).ok_or(Refusal::UnknownExemplar(name))
        }
        Source::Pattern(pattern) => Ok(PointPattern::try_from(*pattern)?),
    }
}
