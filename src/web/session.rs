//! What a request does. No browser in sight: the clock comes in as a function.

use std::sync::Arc;

use glam::DVec2;
use serde_json::{Map, Value};
use thiserror::Error;

use crate::PointPattern;
use crate::analysis::{AnalysisError, Curves, Judge};
use crate::engine::gpu::{Gpu, probe};
use crate::formats::Glyph;
use crate::formats::style;
use crate::gallery;
use crate::method::{ParameterError, Parameters, Preset};
use crate::pattern::PatternError;
use crate::synthesis::{Event, Progress, Synthesis, SynthesisError, SynthesisState};

use super::protocol::{
    AdapterView, ClassLookView, CurvesView, DefectsView, EngineChoice, EngineView, GalleryEntryView, GlyphView,
    PatternView, Points, PresetView, QualityView, RangeView, Request, Response, Source,
};

/// Memory a run may take, in bytes. A 32-bit address space ends at 4 GB, a phone's patience well before.
const MEMORY_LIMIT: u64 = 1_500_000_000;

/// Memory a run may take on the GPU, in bytes: a browser does not tell what is free.
const DEVICE_MEMORY: u64 = 1_500_000_000;

/// One batch works at most this long, in milliseconds, whatever the page asks: a save or a pause must get through.
const LONGEST_BUDGET_MS: f64 = 1000.0;

/// How much of the newest iteration goes into the smoothed speed.
const SPEED_SMOOTHING: f64 = 0.15;

/// Why a request was refused.
#[derive(Debug, Error)]
enum Refusal {
    #[error("the points can't be used: {0}")]
    Pattern(#[from] PatternError),
    #[error("there is no exemplar named {0:?} in the gallery")]
    UnknownExemplar(String),
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    #[error("the parameters can't be used: {}", without_place(.0))]
    Overrides(serde_json::Error),
    #[error(transparent)]
    Synthesis(#[from] SynthesisError),
    #[error("there are no statistics: {0}")]
    Analysis(#[from] AnalysisError),
    #[error("the saved state can't be read: {0}")]
    State(serde_json::Error),
    #[error("the state can't be saved: {0}")]
    Save(serde_json::Error),
    #[error("no run has been started yet")]
    NoRun,
}

/// What is wrong, not where in a text that nobody sees.
fn without_place(error: &serde_json::Error) -> String {
    error.to_string().split(" at line ").next().unwrap_or_default().to_owned()
}

/// A run and the speed it goes at.
#[derive(Debug)]
struct Run {
    synthesis: Synthesis,
    /// Work since the last complete iteration, in milliseconds.
    pending_ms: f64,
    /// Iterations that came back since then: a device brings several at once.
    pending: u32,
    /// Milliseconds of work an iteration on this scale, smoothed.
    ms_per_iteration: Option<f64>,
    /// Milliseconds of work the whole run would take at the present speed, smoothed.
    ms_per_run: Option<f64>,
    /// [`Progress::done`] at the last complete iteration.
    done: f64,
    finished: bool,
    /// Made when statistics are first asked for.
    judge: Option<Judge>,
}

fn smooth(old: Option<f64>, new: f64) -> Option<f64> {
    Some(old.map_or(new, |old| old + SPEED_SMOOTHING * (new - old)))
}

impl Run {
    fn new(synthesis: Synthesis) -> Self {
        let done = synthesis.progress().done;
        Self {
            synthesis,
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
    fn flush(&mut self) {
        if self.pending == 0 {
            return;
        }
        self.ms_per_iteration = smooth(self.ms_per_iteration, self.pending_ms / f64::from(self.pending));
        let done = self.synthesis.progress().done;
        if done > self.done {
            self.ms_per_run = smooth(self.ms_per_run, self.pending_ms / (done - self.done));
        }
        self.done = done;
        self.pending_ms = 0.0;
        self.pending = 0;
    }

    fn clock(&mut self, event: &Event) {
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
    run: Option<Run>,
    gpu: Option<Arc<Gpu>>,
    /// What the browser told about it.
    adapter: Option<AdapterView>,
    /// How many were lost since the person chose.
    devices_lost: u32,
    /// What computes now, and why, if that has not been told yet.
    change: Option<(EngineView, Option<String>)>,
}

/// The processor.
fn cpu() -> EngineView {
    let simd = if cfg!(any(not(target_arch = "wasm32"), target_feature = "simd128")) { "SIMD, " } else { "" };
    let threads = if cfg!(target_arch = "wasm32") { "1 thread" } else { "all cores" };
    EngineView {
        gpu: false,
        name: format!("CPU · {simd}{threads}"),
        meaning: "The processor of this machine computes".to_owned(),
    }
}

fn capital(sentence: &str) -> String {
    let mut letters = sentence.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

fn on_cpu(reason: &str) -> String {
    format!("{}. The processor computes instead.", capital(reason.trim_end_matches('.')))
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
            Request::Start { exemplar, preset, overrides } => self.start(exemplar, &preset, overrides),
            Request::Run { budget_ms, max_iterations } => self.advance(budget_ms, max_iterations, now_ms),
            Request::Touch { points, positions, pinned } => self.touch(&points, &positions, pinned),
            Request::Resynthesize { region } => self.resynthesize(&region),
            Request::Continue { preset, overrides } => self.continue_with(&preset, overrides),
            Request::Analyze {} => self.analyze(now_ms),
            Request::Export {} => self.export(),
            Request::Save {} => self.save(),
            Request::Resume { state } => self.resume(&state),
        };
        answered(response)
    }

    fn start(&mut self, exemplar: Source, preset: &str, overrides: Map<String, Value>) -> Result<Response, Refusal> {
        let exemplar = read(exemplar)?;
        let parameters = parameters(preset, &exemplar, overrides)?;
        let synthesis = Synthesis::new(exemplar, parameters, MEMORY_LIMIT)?;
        self.adopt(synthesis)
    }

    fn resume(&mut self, state: &str) -> Result<Response, Refusal> {
        let state: SynthesisState = serde_json::from_str(state).map_err(Refusal::State)?;
        self.adopt(Synthesis::resume(state, MEMORY_LIMIT)?)
    }

    fn continue_with(&mut self, preset: &str, overrides: Map<String, Value>) -> Result<Response, Refusal> {
        let synthesis = &self.run.as_ref().ok_or(Refusal::NoRun)?.synthesis;
        let parameters = parameters(preset, synthesis.exemplar(), overrides)?;
        let synthesis = synthesis.continue_with(parameters, MEMORY_LIMIT)?;
        self.adopt(synthesis)
    }

    fn touch(&mut self, points: &[u16], positions: &[f64], pinned: bool) -> Result<Response, Refusal> {
        let synthesis = &mut self.run.as_mut().ok_or(Refusal::NoRun)?.synthesis;
        let listed = synthesis.listed();
        // One that is not there is refused with what it is.
        let points: Vec<usize> = points
            .iter()
            .map(|&point| usize::from(point))
            .map(|point| listed.get(point).copied().unwrap_or(point))
            .collect();
        if !positions.is_empty() {
            synthesis.move_points(&points, &pairs(positions))?;
        }
        synthesis.pin(&points, pinned)?;
        self.moved()
    }

    fn resynthesize(&mut self, region: &[f64]) -> Result<Response, Refusal> {
        let run = self.run.as_mut().ok_or(Refusal::NoRun)?;
        run.synthesis.redo_region(&pairs(region))?;
        // The way ahead is another one.
        (run.finished, run.ms_per_run) = (false, None);
        run.done = run.synthesis.progress().done;
        self.moved()
    }

    /// Tells the page of points that a hand has moved.
    fn moved(&mut self) -> Result<Response, Refusal> {
        self.batch(Pull { end: 0.0, before: 0.0, left: 0, moved: true, events: Vec::new() })
    }

    fn adopt(&mut self, mut synthesis: Synthesis) -> Result<Response, Refusal> {
        // The run before may have been too large for the device.
        self.change = self.gpu.as_ref().map(|gpu| (self.gpu_view(gpu), None));
        synthesis.use_gpu(self.gpu.clone(), DEVICE_MEMORY);
        let exemplar = synthesis.exemplar();
        let response = Response::Started {
            exemplar: view(exemplar),
            output: Box::new(PatternView {
                points: output_points(&synthesis)?,
                ..view_beside(&synthesis.output()?, exemplar)
            }),
            parameters: Box::new(synthesis.parameters().clone()),
            progress: synthesis.progress(),
        };
        self.run = Some(Run::new(synthesis));
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
        let run = self.run.as_mut().ok_or(Refusal::NoRun)?;
        while !run.finished {
            let event = run.synthesis.advance_by(pull.left)?;
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
            // Iterations that came back together are told together.
            if pull.left == 0 || (after >= pull.end && !run.synthesis.has_more_to_tell()) {
                break;
            }
        }
        run.flush();
        Ok(Pulled::Full)
    }

    fn batch(&mut self, pull: Pull) -> Result<Response, Refusal> {
        let (engine, note) = self.change.take().unzip();
        let note = note.flatten();
        let run = self.run.as_ref().ok_or(Refusal::NoRun)?;
        let progress: Progress = run.synthesis.progress();
        let moved = pull.moved || run.finished;
        let points = if moved { Some(output_points(&run.synthesis)?) } else { None };
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
        let run = self.run.as_mut().ok_or(Refusal::NoRun)?;
        let output = run.synthesis.output()?;
        let judge = match run.judge.take() {
            Some(judge) => judge,
            None => Judge::new(run.synthesis.exemplar(), &output, run.synthesis.parameters().seed)?,
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
            iterations: run.synthesis.progress().total_iterations,
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

    async fn advance_on_device(
        &mut self,
        budget_ms: f64,
        max_iterations: u32,
        now_ms: &dyn Fn() -> f64,
    ) -> Result<Response, Refusal> {
        let mut pull = Self::begin(budget_ms, max_iterations, now_ms);
        loop {
            // Taken before the look, so that nothing is missed in between.
            let report = self.gpu.as_ref().map(|gpu| gpu.report());
            match self.pull(&mut pull, now_ms)? {
                Pulled::Full => break,
                Pulled::Waiting => self.wait(report).await,
                Pulled::EngineGone(reason) => self.replace_device(&reason).await,
            }
        }
        self.batch(pull)
    }

    #[cfg(target_arch = "wasm32")]
    async fn wait(&self, report: Option<crate::engine::gpu::Report>) {
        if let Some(report) = report {
            report.await;
        }
    }

    #[cfg(not(target_arch = "wasm32"))]
    async fn wait(&self, _: Option<crate::engine::gpu::Report>) {
        if let Some(run) = &self.run {
            run.synthesis.wait();
        }
    }

    /// Goes on without a device.
    fn leave_device(&mut self, reason: &str) {
        self.change = Some((cpu(), Some(on_cpu(reason))));
        // One that works, but has no room for this run, stays for the next.
        self.gpu = self.gpu.take().filter(|gpu| gpu.fault().is_none());
    }

    /// After a device was lost: once another one, then the processor.
    async fn replace_device(&mut self, reason: &str) {
        self.leave_device(reason);
        if self.gpu.is_some() {
            return;
        }
        self.devices_lost += 1;
        if self.devices_lost > 1 {
            return;
        }
        if let Ok(gpu) = probe::open().await {
            let note = format!("{}. Going on with a fresh device from the last iteration.", capital(reason));
            self.change = Some((self.gpu_view(&gpu), Some(note)));
            self.use_gpu(Some(gpu));
        }
    }

    fn use_gpu(&mut self, gpu: Option<Arc<Gpu>>) {
        self.gpu = gpu;
        if let Some(run) = &mut self.run {
            run.synthesis.use_gpu(self.gpu.clone(), DEVICE_MEMORY);
        }
    }

    async fn choose_engine(&mut self, choice: EngineChoice, adapter: Option<AdapterView>) -> Response {
        self.adapter = adapter;
        let emulated = self.adapter.as_ref().is_some_and(|adapter| adapter.software);
        let (gpu, note) = match choice {
            EngineChoice::Cpu => (None, None),
            EngineChoice::Auto if emulated => (
                None,
                Some("WebGPU is only emulated in this browser, so the processor computes: it is faster.".to_owned()),
            ),
            EngineChoice::Auto | EngineChoice::Gpu => match probe::open().await {
                Ok(gpu) => (Some(gpu), None),
                Err(error) => (None, Some(on_cpu(&error.to_string()))),
            },
        };
        let engine = gpu.as_ref().map_or_else(cpu, |gpu| self.gpu_view(gpu));
        self.choose_gpu(gpu);
        Response::Engine { engine, note }
    }

    /// Computes with what the person chose, whatever happened before.
    fn choose_gpu(&mut self, gpu: Option<Arc<Gpu>>) {
        self.devices_lost = 0;
        self.change = None;
        self.use_gpu(gpu);
    }

    fn gpu_view(&self, gpu: &Gpu) -> EngineView {
        let told = self.adapter.as_ref().map_or("", |adapter| adapter.name.as_str());
        let emulated = gpu.info().software || self.adapter.as_ref().is_some_and(|adapter| adapter.software);
        let name = [told, gpu.info().name.as_str()].into_iter().find(|name| !name.is_empty()).unwrap_or("GPU");
        EngineView {
            gpu: true,
            name: name.to_owned(),
            meaning: format!(
                "{}: {name}",
                if emulated { "WebGPU, emulated by the processor" } else { "WebGPU on the graphics card" }
            ),
        }
    }

    /// Computes from now on with what another session chose: a run can go on here while a device is opened there.
    pub fn take_engine(&mut self, other: Self) {
        self.adapter = other.adapter;
        self.choose_gpu(other.gpu);
    }

    /// Makes the device stop working, as unplugging it would; for tests.
    pub fn destroy_device(&self) {
        if let Some(gpu) = &self.gpu {
            gpu.destroy();
        }
    }

    fn export(&self) -> Result<Response, Refusal> {
        let output = self.run.as_ref().ok_or(Refusal::NoRun)?.synthesis.output()?;
        Ok(Response::Exported { pattern: Box::new((&output).into()) })
    }

    fn save(&self) -> Result<Response, Refusal> {
        let synthesis = &self.run.as_ref().ok_or(Refusal::NoRun)?.synthesis;
        let state = serde_json::to_string(&synthesis.state()).map_err(Refusal::Save)?;
        Ok(Response::Saved { state, progress: synthesis.progress() })
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

/// The preset's parameters as they suit the exemplar, with some replaced. Numbers are checked before they take their
/// type, so that a negative or broken one is answered with its range.
fn parameters(preset: &str, exemplar: &PointPattern, mut overrides: Map<String, Value>) -> Result<Parameters, Refusal> {
    for range in &Parameters::RANGES {
        if let Some(value) = overrides.get(range.name).and_then(Value::as_f64) {
            range.check(value)?;
        }
    }
    // In place: collecting would sort, with a sorting routine of its own.
    overrides.values_mut().for_each(|value| *value = whole(value.take()));
    Parameters::with_overrides(Preset::from_name(preset)?, exemplar, overrides).map_err(Refusal::Overrides)
}

/// JavaScript has one kind of number: 4.0 is a whole number too.
fn whole(value: Value) -> Value {
    match value.as_f64() {
        Some(number) if value.is_f64() && number.fract() == 0.0 && number.abs() <= 9_007_199_254_740_991.0 => {
            Value::from(number as i64)
        }
        _ => value,
    }
}

fn describe() -> Response {
    let presets = Preset::ALL
        .into_iter()
        .map(|preset| {
            let (title, meaning) = match preset {
                Preset::Fast => ("Fast", "Seconds: few filters, a grid just fine enough."),
                Preset::Balanced => {
                    ("Balanced", "Minutes: more iterations, and the worst regions get another try, three times.")
                }
                Preset::Best => {
                    ("Best", "Many minutes: more filters, a finer grid, and eight tries at the worst regions.")
                }
                Preset::Paper => ("Paper", "The numbers of Huang et al. 2022. Takes long in a browser."),
            };
            PresetView {
                name: preset.name().to_owned(),
                title: title.to_owned(),
                meaning: meaning.to_owned(),
                parameters: Parameters::preset(preset),
            }
        })
        .collect();
    let ranges = Parameters::RANGES
        .iter()
        .map(|range| RangeView {
            name: range.name.to_owned(),
            min: range.min,
            max: range.max,
            whole: range.whole,
            meaning: range.meaning.to_owned(),
        })
        .collect();
    let view = |glyph: &Glyph| GlyphView { name: glyph.name().to_owned(), outline: glyph.path_data() };
    let glyphs = Glyph::all().iter().map(view).collect();
    Response::Description { version: env!("CARGO_PKG_VERSION").to_owned(), engine: cpu(), presets, ranges, glyphs }
}

fn list_gallery() -> Response {
    let entries = gallery::entries()
        .iter()
        .map(|entry| GalleryEntryView {
            name: entry.name.to_owned(),
            title: entry.title.to_owned(),
            caption: entry.caption.to_owned(),
            pattern: view(&entry.exemplar()),
        })
        .collect();
    Response::Gallery { entries }
}

fn view(pattern: &PointPattern) -> PatternView {
    view_beside(pattern, pattern)
}

/// An output is measured in its exemplar's unit, not in its own.
fn view_beside(pattern: &PointPattern, exemplar: &PointPattern) -> PatternView {
    let domain = pattern.domain();
    let (unit, own_unit) = (exemplar.domain().exemplar_unit(), domain.exemplar_unit());
    let points = points(pattern, exemplar);
    let styles = style::class_styles(pattern.class_names(), !points.radii.is_empty());
    let looks = styles.iter().map(|style| ClassLookView { glyph: style.glyph.name().to_owned(), color: style.color });
    PatternView {
        points,
        looks: looks.collect(),
        class_names: pattern.class_names().to_vec(),
        size: (domain.size() / unit).into(),
        min: domain.min().into(),
        unit,
        boundary: pattern.boundary(),
        spacing: pattern.mean_spacing().map(|spacing| spacing * own_unit / unit),
    }
}

/// What the page draws of one side, in mean spacings of the exemplar, `unit`.
fn curves(curves: &Curves, unit: f64) -> CurvesView {
    CurvesView {
        pair_correlation: narrow(&curves.pair_correlation.value, 1.0),
        nearest: narrow(&curves.nearest_histogram.shares, 1.0),
        spacing: curves.nearest.map_or(0.0, |nearest| nearest.mean) / unit,
        frequency: narrow(&curves.spectrum.frequency, unit),
        power: narrow(&curves.spectrum.power, 1.0),
        relative_radius: curves.relative_radius,
    }
}

fn narrow(values: &[f64], factor: f64) -> Vec<f32> {
    values.iter().map(|value| (value * factor) as f32).collect()
}

fn points(pattern: &PointPattern, exemplar: &PointPattern) -> Points {
    let (min, unit) = (pattern.domain().min(), exemplar.domain().exemplar_unit());
    let positions = pattern.positions().iter().flat_map(|&point| ((point - min) / unit).as_vec2().to_array()).collect();
    let look = style::attribute_look(pattern, exemplar);
    let narrow = |values: Vec<f64>| narrow(&values, 1.0);
    Points {
        positions,
        classes: pattern.classes().to_vec(),
        radii: narrow(look.radii),
        scales: narrow(look.scales),
        turns: narrow(look.turns),
        depths: narrow(look.depths),
        pinned: Vec::new(),
    }
}

fn output_points(synthesis: &Synthesis) -> Result<Points, Refusal> {
    let held = synthesis.pinned();
    let pinned = (0..).zip(synthesis.listed()).filter(|&(_, point)| held[point]).map(|(place, _)| place).collect();
    Ok(Points { pinned, ..points(&synthesis.output()?, synthesis.exemplar()) })
}

fn pairs(numbers: &[f64]) -> Vec<DVec2> {
    numbers.chunks_exact(2).map(DVec2::from_slice).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic, reason = "a test may stop at the first surprise")]

    use std::cell::Cell;

    use serde_json::json;

    use super::*;
    use crate::analysis::{Comparison, verdict};

    /// Answers through JSON both ways, as the page would see it, with a clock that ticks 1 ms a look.
    fn ask(session: &mut Session, request: Value) -> Value {
        let clock = Cell::new(0.0);
        let now = || {
            clock.set(clock.get() + 1.0);
            clock.get()
        };
        let kind = request["type"].as_str().unwrap().to_owned();
        let request = serde_json::from_value(json!({ kind: request })).unwrap();
        let response = session.handle(request, &now);
        serde_json::to_value(response).unwrap()
    }

    fn tiny(seed: u64) -> Value {
        json!({
            "type": "start",
            "exemplar": { "source": "gallery", "name": "rings" },
            "preset": "fast",
            "overrides": {
                "expansion-x": 1.0, "expansion-y": 1.5, "channels": 4.0, "grid-min": 16, "grid-max": 16,
                "iterations-coarse": 3, "iterations-fine": 2, "iterations-polish": 1, "convergence-window": 5000, "seed": seed,
                "boundary": "open",
            },
        })
    }

    /// An exemplar of one class.
    fn own(domain: [f64; 4], positions: &[f64]) -> Value {
        json!({
            "source": "pattern", "name": "mine",
            "pattern": {
                "domain": domain, "boundary": "open", "positions": positions, "classes": vec![0; positions.len() / 2],
                "classNames": ["points"], "attributes": [],
            },
        })
    }

    fn exported(session: &mut Session) -> PointPattern {
        let answer = ask(session, json!({ "type": "export" }));
        let data: crate::web::pattern_data::PatternData = serde_json::from_value(answer["pattern"].clone()).unwrap();
        PointPattern::try_from(data).unwrap()
    }

    fn run(session: &mut Session, iterations: u32) -> Value {
        ask(session, json!({ "type": "run", "budgetMs": 1e9, "maxIterations": iterations }))
    }

    /// Runs until it is done: a batch is never longer than a second, and the tests' clock moves at every look.
    fn run_to_the_end(session: &mut Session) -> Value {
        loop {
            let batch = run(session, u32::MAX);
            assert_eq!(batch["type"], "batch", "{batch}");
            if batch["finished"] == json!(true) {
                return batch;
            }
        }
    }

    fn iterated(batch: &Value) -> usize {
        batch["events"].as_array().unwrap().iter().filter(|event| event["type"] == "iterated").count()
    }

    #[test]
    fn the_gallery_is_complete_and_inside_its_squares() {
        let mut session = Session::new();
        let answer = ask(&mut session, json!({ "type": "gallery" }));
        let entries = answer["entries"].as_array().unwrap();
        assert_eq!(entries.len(), gallery::entries().len());
        for entry in entries {
            let points = &entry["pattern"]["points"];
            let (positions, classes) = (points["positions"].as_array().unwrap(), points["classes"].as_array().unwrap());
            assert_eq!(positions.len(), 2 * classes.len());
            assert!(positions.iter().all(|value| (0.0..=1.0).contains(&value.as_f64().unwrap())), "{entry}");
        }
    }

    #[test]
    fn the_description_covers_every_preset_and_range() {
        let answer = ask(&mut Session::new(), json!({ "type": "describe" }));
        assert_eq!(answer["presets"].as_array().unwrap().len(), Preset::ALL.len());
        assert_eq!(answer["ranges"].as_array().unwrap().len(), Parameters::RANGES.len());
        assert_eq!(answer["presets"][0]["parameters"]["channels"], json!(Parameters::preset(Preset::Fast).channels));
        assert_eq!(
            answer["engine"],
            json!({ "gpu": false, "name": "CPU · SIMD, all cores", "meaning": "The processor of this machine computes" })
        );
    }

    #[test]
    fn a_run_goes_from_start_to_finish() {
        let mut session = Session::new();
        let started = ask(&mut session, tiny(1));
        assert_eq!(started["type"], "started", "{started}");
        let count = started["exemplar"]["points"]["classes"].as_array().unwrap().len();
        let expected = (count as f64 * 1.5).round() as usize;
        assert_eq!(started["output"]["points"]["classes"].as_array().unwrap().len(), expected);
        assert_eq!(started["output"]["size"], json!([1.0, 1.5]));
        assert_eq!(started["parameters"]["channels"], json!(4));

        let step = run(&mut session, 1);
        assert_eq!((step["type"].as_str(), iterated(&step)), (Some("batch"), 1), "{step}");
        assert_eq!(step["progress"]["totalIterations"], json!(1));
        assert!(step["iterationsPerSecond"].as_f64().unwrap() > 0.0);
        assert_ne!(step["points"]["positions"], started["output"]["points"]["positions"]);

        let rest = run(&mut session, u32::MAX);
        assert_eq!(rest["finished"], json!(true));
        assert_eq!(iterated(&rest), 3 + 3 * 2 + 1 - 1);
        assert_eq!(rest["secondsLeft"], json!(0.0));
        let over = run(&mut session, u32::MAX);
        assert_eq!((iterated(&over), &over["finished"]), (0, &json!(true)));

        let output = exported(&mut session);
        assert_eq!(output.len(), expected);
        assert_eq!(output, session.run.as_ref().unwrap().synthesis.output().unwrap());
    }

    #[test]
    fn statistics_are_those_of_the_exported_pattern() {
        let mut session = Session::new();
        let mut request = tiny(3);
        request["overrides"]["boundary"] = json!("periodic");
        ask(&mut session, request);
        let analyze = || json!({ "type": "analyze" });
        let start = ask(&mut session, analyze());
        run(&mut session, 4);
        let answer = ask(&mut session, analyze());
        assert_eq!((&answer["type"], &answer["iterations"]), (&json!("analyzed"), &json!(4)), "{answer}");
        assert_ne!(answer["output"], start["output"]);
        assert_eq!(answer["exemplar"], start["exemplar"]);

        let output = exported(&mut session);
        let exemplar = gallery::find("rings").unwrap().exemplar();
        let expected = Comparison::of(&exemplar, &output, 3).unwrap();
        let list =
            |value: &Value| -> Vec<f64> { value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect() };
        let same = |found: &Value, wanted: &[f64], factor: f64| {
            let found = list(found);
            assert_eq!(found.len(), wanted.len());
            for (a, b) in found.iter().zip(wanted) {
                assert_eq!(*a, f64::from((b * factor) as f32), "{found:?} {wanted:?}");
            }
        };
        let d = expected.scales.spacing;
        same(&answer["distance"], &expected.output.pair_correlation.radius, 1.0 / d);
        for (side, analysis) in [("exemplar", &expected.exemplar), ("output", &expected.output)] {
            same(&answer[side]["pairCorrelation"], &analysis.pair_correlation.value, 1.0);
            same(&answer[side]["nearest"], &analysis.nearest_histogram.shares, 1.0);
            same(&answer[side]["frequency"], &analysis.spectrum.frequency, d);
            same(&answer[side]["power"], &analysis.spectrum.power, 1.0);
            assert_eq!(answer[side]["relativeRadius"], json!(analysis.relative_radius));
            assert_eq!(answer[side]["spacing"], json!(analysis.nearest[0].mean / d));
        }
        let quality = expected.quality;
        assert_eq!(answer["quality"]["score"], json!(quality.score));
        assert_eq!(answer["quality"]["arrangement"], json!(quality.pair_density));
        assert_eq!(answer["quality"]["detail"], json!(quality.precision));
        assert_eq!(answer["quality"]["variety"], json!(quality.coverage));
        assert_eq!(answer["quality"]["independent"], json!(quality.independent));
        assert_eq!(answer["defects"]["holes"], json!(expected.defects.holes));
        assert_eq!(answer["defects"]["border"], Value::Null, "a tile has no border");
        assert_eq!(answer["verdict"], json!(verdict(&expected)));
        assert!(answer["workMs"].as_f64().unwrap() > 0.0);
    }

    #[test]
    fn another_run_has_another_judge() {
        let mut session = Session::new();
        let analyze = || json!({ "type": "analyze" });
        ask(&mut session, tiny(3));
        let rings = ask(&mut session, analyze());
        let mut request = tiny(3);
        request["exemplar"]["name"] = json!("chevrons");
        ask(&mut session, request);
        let chevrons = ask(&mut session, analyze());
        assert_ne!(rings["exemplar"]["pairCorrelation"], chevrons["exemplar"]["pairCorrelation"]);
        let mut request = tiny(3);
        request["exemplar"] = own([0.0, 0.0, 1.0, 1.0], &[0.5, 0.5, 0.5, 0.5]);
        if ask(&mut session, request)["type"] == "started" {
            let answer = ask(&mut session, analyze());
            assert_eq!(answer["type"], "error");
            assert!(answer["message"].as_str().unwrap().contains("no statistics"), "{answer}");
        }
    }

    #[test]
    fn a_budget_ends_a_batch_before_its_iterations() {
        let mut session = Session::new();
        ask(&mut session, tiny(1));
        let batch = ask(&mut session, json!({ "type": "run", "budgetMs": 0, "maxIterations": 1000 }));
        assert_eq!(batch["finished"], json!(false));
        assert!(batch["events"].as_array().unwrap().len() <= 1, "one piece of work is one event at most: {batch}");
    }

    #[test]
    fn a_saved_run_continues_to_the_same_points() {
        let (mut whole, mut parted) = (Session::new(), Session::new());
        ask(&mut whole, tiny(5));
        ask(&mut parted, tiny(5));
        run(&mut parted, 2);
        let saved = ask(&mut parted, json!({ "type": "save" }));
        assert_eq!(saved["progress"]["totalIterations"], json!(2));
        let mut second = Session::new();
        let resumed = ask(&mut second, json!({ "type": "resume", "state": saved["state"] }));
        assert_eq!((&resumed["type"], &resumed["progress"]["totalIterations"]), (&json!("started"), &json!(2)));
        run(&mut second, 3);
        run(&mut whole, 5);
        assert_eq!(exported(&mut second), exported(&mut whole));
        ask(&mut parted, tiny(6));
        run(&mut parted, 5);
        assert_ne!(exported(&mut parted), exported(&mut whole));
    }

    /// Needs a Vulkan adapter, as the tests of the engine do.
    #[test]
    fn a_device_is_taken_over_and_outlives_a_run_that_is_too_large_for_it() {
        let answer = |session: &mut Session, request: Request| {
            serde_json::to_value(pollster::block_on(session.answer(request, &|| 0.0))).unwrap()
        };
        let start = || -> Request { serde_json::from_value(json!({ "start": tiny(1) })).unwrap() };
        let step = || Request::Run { budget_ms: 1.0, max_iterations: 1 };
        let (mut session, mut chooser) = (Session::new(), Session::new());
        answer(&mut session, start());
        let choice = Request::Engine { choice: EngineChoice::Gpu, adapter: None };
        assert_eq!(answer(&mut chooser, choice)["engine"]["gpu"], json!(true));
        session.take_engine(chooser);
        assert_eq!(answer(&mut session, step())["progress"]["totalIterations"], json!(1));

        // As if the run needed more than there is.
        let gpu = session.gpu.clone();
        session.run.as_mut().unwrap().synthesis.use_gpu(gpu, 1);
        let batch = answer(&mut session, step());
        assert_eq!(batch["engine"]["gpu"], json!(false), "{batch}");
        let note = batch["note"].as_str().unwrap();
        assert!(note.ends_with("The processor computes instead.") && note.contains("MB"), "{note}");
        assert_eq!(batch["progress"]["totalIterations"], json!(2));

        answer(&mut session, start());
        let batch = answer(&mut session, step());
        assert_eq!((&batch["engine"]["gpu"], &batch["note"]), (&json!(true), &Value::Null), "{batch}");
    }

    #[test]
    fn points_are_touched_by_their_place_in_the_list() {
        let mut session = Session::new();
        let mut request = tiny(2);
        // Two classes, placed in the other order than listed.
        request["exemplar"]["name"] = json!("repelling");
        request["overrides"]["class-order"] = json!("most-first");
        let started = ask(&mut session, request);
        assert_eq!(started["type"], "started", "{started}");
        run_to_the_end(&mut session);
        let touch = json!({ "type": "touch", "points": [1, 3], "positions": [0.25, 0.5, 0.75, 1.25], "pinned": true });
        let touched = ask(&mut session, touch);
        assert_eq!((&touched["type"], &touched["finished"]), (&json!("batch"), &json!(true)), "{touched}");
        assert_eq!(touched["points"]["pinned"], json!([1, 3]));
        let places = touched["points"]["positions"].as_array().unwrap();
        assert_eq!([&places[2], &places[3], &places[6], &places[7]], [0.25, 0.5, 0.75, 1.25]);

        let region = json!({ "type": "resynthesize", "region": [0.0, 0.0, 0.5, 0.0, 0.5, 0.8, 0.0, 0.8] });
        let redone = ask(&mut session, region);
        assert_eq!((&redone["finished"], &redone["progress"]["redoing"]), (&json!(false), &json!(true)), "{redone}");
        let rest = run_to_the_end(&mut session);
        assert_eq!((&rest["finished"], &rest["progress"]["redoing"]), (&json!(true), &json!(false)), "{rest}");
        let before: Vec<Vec<f64>> =
            serde_json::from_value(places.chunks(2).map(|place| json!(place)).collect::<Value>()).unwrap();
        let after = rest["points"]["positions"].as_array().unwrap();
        let (mut same, mut other) = (0, 0);
        for (place, now) in before.iter().zip(after.chunks(2)) {
            let inside = place[0] < 0.5 && place[1] < 0.8 && place != &[0.25, 0.5];
            *(if json!(place) == json!(now) { &mut same } else { &mut other }) += 1;
            assert_eq!(json!(place) != json!(now), inside, "{place:?} {now:?}");
        }
        assert!(same > 5 && other > 5, "{same} {other}");

        let overrides = |expansion: f64| {
            json!({
                "expansion-x": 1.0, "expansion-y": expansion, "channels": 8.0, "grid-min": 16, "grid-max": 16,
                "iterations-fine": 2, "seed": 9, "boundary": "open", "class-order": "most-first",
            })
        };
        let request = json!({ "type": "continue", "preset": "fast", "overrides": overrides(1.5) });
        let continued = ask(&mut session, request);
        assert_eq!(
            (&continued["type"], &continued["parameters"]["channels"]),
            (&json!("started"), &json!(8)),
            "{continued}"
        );
        assert_eq!(continued["output"]["points"], rest["points"], "it starts from what is there");
        let request = json!({ "type": "continue", "preset": "fast", "overrides": overrides(2.0) });
        let refused = ask(&mut session, request);
        assert!(refused["message"].as_str().unwrap().contains("another size needs another start"), "{refused}");
    }

    #[test]
    fn refusals_say_why_and_leave_the_run_alone() {
        let mut session = Session::new();
        let refused = |answer: &Value, part: &str| {
            assert_eq!(answer["type"], "error", "{answer}");
            assert!(answer["message"].as_str().unwrap().contains(part), "{answer}");
        };
        for request in [
            json!({ "type": "run", "budgetMs": 1, "maxIterations": 1 }),
            json!({ "type": "save" }),
            json!({ "type": "analyze" }),
            json!({ "type": "export" }),
            json!({ "type": "touch", "points": [0], "positions": [], "pinned": true }),
            json!({ "type": "resynthesize", "region": [0, 0, 1, 0, 1, 1] }),
            json!({ "type": "continue", "preset": "fast" }),
        ] {
            refused(&ask(&mut session, request), "no run");
        }
        ask(&mut session, tiny(1));
        run(&mut session, 1);
        let start = |exemplar: Value, preset: &str, overrides: Value| json!({ "type": "start", "exemplar": exemplar, "preset": preset, "overrides": overrides });
        let rings = || json!({ "source": "gallery", "name": "rings" });
        let nothing = || json!({});
        let cases = [
            (start(json!({ "source": "gallery", "name": "nope" }), "fast", nothing()), "\"nope\""),
            (start(rings(), "perfect", nothing()), "fast, balanced, best, paper"),
            (start(rings(), "fast", json!({ "channels": -3 })), "between 4 and 160"),
            (start(rings(), "fast", json!({ "channels": 4.5 })), "whole number"),
            (start(rings(), "fast", json!({ "channels": "many" })), "can't be used"),
            (start(rings(), "fast", json!({ "chanels": 8 })), "chanels"),
            (start(rings(), "fast", json!({ "boundary": "leaky" })), "leaky"),
            (start(rings(), "fast", json!({ "grid-min": 64, "grid-max": 32 })), "'grid-min'"),
            (json!({ "type": "resume", "state": "{}" }), "saved state"),
            (json!({ "type": "touch", "points": [60000], "positions": [], "pinned": true }), "no point 60000"),
            (json!({ "type": "touch", "points": [0], "positions": [7, 7], "pinned": true }), "outside the output"),
            (json!({ "type": "touch", "points": [0], "positions": [7], "pinned": true }), "0 places for 1 points"),
            (json!({ "type": "resynthesize", "region": [0, 0, 1, 1] }), "three corners"),
            (json!({ "type": "resynthesize", "region": [7, 7, 8, 7, 8, 8] }), "no point in this region"),
        ];
        for (request, part) in cases {
            refused(&ask(&mut session, request), part);
        }
        let batch = run(&mut session, 1);
        assert_eq!(batch["progress"]["totalIterations"], json!(2), "the run before is still there");
    }

    #[test]
    fn patterns_of_things_come_with_their_looks() {
        let mut session = Session::new();
        let glyphs = ask(&mut session, json!({ "type": "describe" }))["glyphs"].clone();
        let named = |name: &str| glyphs.as_array().unwrap().iter().find(|glyph| glyph["name"] == name).unwrap().clone();
        assert_eq!(named("disk")["outline"], "");
        assert!(named("house")["outline"].as_str().unwrap().starts_with("M0 -1.45L1.4 -0.2L"), "{glyphs}");

        let gallery = ask(&mut session, json!({ "type": "gallery" }));
        let pattern = |name: &str| {
            let entries = gallery["entries"].as_array().unwrap();
            entries.iter().find(|entry| entry["name"] == name).unwrap()["pattern"].clone()
        };
        let looks = &pattern("houses")["looks"];
        assert_eq!(looks, &json!([{ "glyph": "house", "color": 1 }, { "glyph": "tree", "color": 2 }]));
        assert_eq!(pattern("grove")["looks"], json!([{ "glyph": "disk", "color": 2 }]), "crowns have a radius");
        let lengths = |name: &str| {
            let points = pattern(name)["points"].clone();
            ["radii", "scales", "turns", "depths"].map(|list| points[list].as_array().unwrap().len())
        };
        assert_eq!(lengths("houses"), [0; 4]);
        assert_eq!(lengths("grove"), [91, 0, 0, 0]);
        assert_eq!(lengths("boats"), [0, 0, 72, 0]);
        assert_eq!(lengths("meadow"), [0, 118, 0, 118]);

        // In metres: radii in exemplar units, scales against the exemplar's mean, on both sides.
        let mut exemplar = own([0.0, 0.0, 40.0, 20.0], &[1.0, 1.0, 20.0, 10.0, 30.0, 5.0, 10.0, 15.0]);
        exemplar["pattern"]["attributes"] = json!([
            { "name": "radius", "values": [4, 2, 1, 3] },
            { "name": "scale", "values": [10, 30, 20, 20] },
        ]);
        let mut request = tiny(1);
        request["exemplar"] = exemplar;
        let started = ask(&mut session, request);
        let list = |side: &str, name: &str| -> Vec<f64> {
            started[side]["points"][name].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
        };
        let near = |found: Vec<f64>, wanted: &[f64]| {
            assert!(
                found.len() == wanted.len() && found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-6),
                "{found:?}"
            );
        };
        near(list("exemplar", "radii"), &[0.1, 0.05, 0.025, 0.075]);
        near(list("exemplar", "scales"), &[0.5, 1.5, 1.0, 1.0]);
        let allowed = |value: &f64| [0.1, 0.05, 0.025, 0.075].iter().any(|radius| (radius - value).abs() < 1e-6);
        assert!(list("output", "radii").iter().all(allowed), "{started}");
    }

    #[test]
    fn numbers_that_are_no_pattern_are_refused() {
        let mut session = Session::new();
        let open = |exemplar: Value| json!({ "type": "open", "exemplar": exemplar });
        let answer = ask(&mut session, open(own([0.0, 0.0, 1.0, 1.0], &[0.5, 1.5])));
        assert!(answer["message"].as_str().unwrap().contains("outside the domain"), "{answer}");
        let answer = ask(&mut session, open(own([0.0, 0.0, 1.0, 1.0], &[0.5, 0.5, 0.2, 0.25])));
        assert_eq!(answer["exemplar"]["points"]["positions"], json!([0.5, 0.5, f64::from(0.2_f32), 0.25]), "{answer}");
        assert_eq!(answer["pattern"]["positions"], json!([0.5, 0.5, 0.2, 0.25]), "{answer}");
    }

    #[test]
    fn an_output_is_drawn_in_the_units_of_its_exemplar() {
        let mut session = Session::new();
        let points = [100.0, 200.0, 140.0, 220.0, 120.0, 210.0, 110.0, 205.0, 130.0, 215.0];
        let mut request = tiny(1);
        request["exemplar"] = own([100.0, 200.0, 40.0, 20.0], &points);
        let started = ask(&mut session, request);
        assert_eq!(started["exemplar"]["size"], json!([1.0, 0.5]), "{started}");
        assert_eq!(started["exemplar"]["min"], json!([100.0, 200.0]));
        assert_eq!(started["exemplar"]["unit"], json!(40.0));
        assert_eq!(started["exemplar"]["points"]["positions"][2], json!(1.0));
        assert_eq!(started["output"]["size"], json!([1.0, 0.75]));
        assert_eq!(started["output"]["unit"], json!(40.0));
    }
}
