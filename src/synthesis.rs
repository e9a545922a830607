//! The run as a state machine: classes × scales × iterations.
//!
//! [`Synthesis::advance`] does one bounded piece of work (a fraction of an iteration: well under a second even at the
//! paper's size in a browser) and says what happened. Whoever drives it (command line, worker, test) decides when to
//! call it again, so pause and cancel need no flags and the page pulls at its own pace.

mod touch;

use std::collections::VecDeque;
use std::sync::Arc;

use glam::DVec2;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::analysis::{AnalysisError, Cloud, check_radii};
use crate::engine::cpu::adam::Adam;
use crate::engine::cpu::network::Network;
use crate::engine::cpu::{CpuEngine, Float};
use crate::engine::gpu::{Gpu, GpuEngine, GpuNetwork};
use crate::engine::view::Stage;
use crate::engine::{Advance, Engine, ScaleSetup};
use crate::method::alignment::{align, mend};
use crate::method::disks::{Disks, Overlaps, movable, separate};
use crate::method::parameters::Start;
use crate::method::repair::{Arrangement, Limits, Room, keep_apart, keep_off_border, narrow_hole, relocate};
use crate::method::restart::{shake, wrongness};
use crate::method::schedule::converged;
use crate::method::transplant::transplant;
use crate::method::values::{Exchange, Values};
use crate::method::{ParameterError, Parameters, Schedule, Weights, bands};
use crate::pattern::{Attribute, MAX_POINTS, PatternError, PointPattern};
use crate::sampling::{Purpose, Rng, poisson_disk, white_noise};
use crate::{Boundary, Domain};

pub use touch::Redo;

/// The loss of one iteration and its terms, weights included.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LossTerms {
    /// Gram loss of layers 2, 3 and 4.
    pub gram: [f64; 3],
    /// Deep-correlation loss of layer 4.
    pub correlation: f64,
}

impl LossTerms {
    /// The sum of all terms.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.gram.iter().sum::<f64>() + self.correlation
    }
}

/// Where a run stands.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Progress {
    /// Class being placed, from 0, in the order of the exemplar's class names.
    pub class: usize,
    /// How many classes were placed before it.
    pub turn: usize,
    /// How many classes have points.
    pub classes: usize,
    /// Scale being worked on, from 0 (coarse).
    pub scale: usize,
    /// How many scales there are.
    pub scales: usize,
    /// Which try at the worst regions; 0 is the way through all scales that comes before them.
    pub restart: u32,
    /// How many tries there may be.
    pub restarts: u32,
    /// Whether a region is being done again.
    pub redoing: bool,
    /// Iterations done on this scale.
    pub iteration: u32,
    /// Most iterations this scale may take.
    pub iterations: u32,
    /// Iterations done in the whole run.
    pub total_iterations: u64,
    /// Share of the run that is done, 0 to 1, by work; a scale that converges early jumps ahead.
    pub done: f64,
}

/// What happened during one call of [`Synthesis::advance`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "kebab-case", rename_all_fields = "camelCase")]
pub enum Event {
    /// Part of an iteration is done; nothing to show yet.
    Working,
    /// There is nothing to do before the device reports something: see [`Synthesis::wait`].
    Waiting,
    /// A scale begins: targets are computed, the grid is allocated.
    ScaleStarted {
        /// Where the run stands.
        progress: Progress,
        /// Width of the Gaussian in exemplar units.
        sigma: f64,
        /// Columns and rows of the output's sampling grid.
        grid: [usize; 2],
    },
    /// An iteration is complete: the points have moved.
    Iterated {
        /// Where the run stands.
        progress: Progress,
        /// The loss before the move.
        loss: LossTerms,
    },
    /// A scale is over.
    ScaleFinished {
        /// Where the run stands.
        progress: Progress,
        /// Whether it converged before its iterations ran out.
        converged: bool,
    },
    /// The device can't be used, or no longer: the run goes on from what came back last, on the processor unless
    /// another device is given to [`Synthesis::use_gpu`].
    EngineChanged {
        /// What happened, as a sentence.
        reason: String,
    },
    /// Every class and scale is done.
    Finished,
}

/// Why a synthesis can't start or continue.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SynthesisError {
    /// A parameter is out of range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The exemplar, or what would come out, is not a valid pattern.
    #[error(transparent)]
    Pattern(#[from] PatternError),
    /// A radius of the exemplar is none.
    #[error("the exemplar's disks can't be used: {0}")]
    Disks(#[from] AnalysisError),
    /// The exemplar has too little structure to learn from.
    #[error("the exemplar can't be used: {0}")]
    Exemplar(&'static str),
    /// More memory than there is.
    #[error("this run needs about {needed_mb} MB of memory, {limit_mb} MB are available; lower {lower}")]
    Memory {
        /// What it would take, in MB (10⁶ bytes).
        needed_mb: u64,
        /// What may be used, in MB.
        limit_mb: u64,
        /// Which parameters to lower, and to what.
        lower: String,
    },
    /// Values that the output can't carry.
    #[error("these values can't be given to the output's points: {0}")]
    Sources(String),
    /// Points, places, regions or parameters that the result at hand can't take.
    #[error("this can't be done to the result: {0}")]
    Touch(String),
    /// A saved state that does not fit together.
    #[error("the saved state can't be continued: {0}")]
    State(String),
    /// A loss or a position is no longer finite.
    #[error(
        "iteration {iteration} on scale {scale} gave a loss that is not a finite number; the points of the iteration before are kept"
    )]
    NotFinite {
        /// Scale, from 0.
        scale: usize,
        /// Iteration within the scale.
        iteration: u32,
    },
}

/// A run of the method. Same exemplar, parameters and seed: the same points.
#[derive(Debug)]
pub struct Synthesis {
    exemplar: PointPattern,
    parameters: Parameters,
    schedule: Schedule,
    /// Exemplar points in exemplar units, and which of them belong to each class.
    positions: Vec<DVec2>,
    members: Vec<Vec<usize>>,
    /// What every exemplar point weighs in the bands of its attributes.
    columns: Vec<Vec<f64>>,
    /// The classes that have points, in the order in which they are placed.
    order: Vec<usize>,
    output_size: DVec2,
    /// The same rectangle in the exemplar's own unit.
    output_domain: Domain,
    /// Output points, class after class as they are placed, in exemplar units: the classes done and the one at hand.
    points: Vec<DVec2>,
    /// For every output point the exemplar point whose attributes it carries.
    sources: Vec<usize>,
    /// For every output point whether it is held where it is.
    pinned: Vec<bool>,
    /// The region that is being done again, and how many there were.
    redo: Option<Redo>,
    redos: u32,
    /// The engine's points as indices into `points`.
    arranged: Vec<usize>,
    /// Radii of the exemplar's disks in exemplar units, where they are to overlap as they do there.
    radii: Option<Vec<f64>>,
    /// Where each started class begins in `points`, in the order of placing.
    class_starts: Vec<usize>,
    /// How many classes were placed before the one at hand.
    turn: usize,
    scale: usize,
    /// Losses of the scale at hand, one an iteration.
    losses: Vec<f64>,
    total_iterations: u64,
    /// Which try at the worst regions of the class at hand; 0 before the first.
    restart: u32,
    /// The least wrong points of the class at hand so far.
    best: Option<Best>,
    finished: bool,
    /// Set by a resumed run until its engine is built.
    resumed: Option<Adam>,
    engine: Option<Engine>,
    /// The filters of the scale before.
    network: Option<Arc<Network<Float>>>,
    gpu_network: Option<Arc<GpuNetwork>>,
    /// The device to use, and the memory it may take, in bytes.
    gpu: Option<(Arc<Gpu>, u64)>,
    /// Iterations that came back together, and are told one by one.
    told: VecDeque<Event>,
}

/// What a class looked like when it was least wrong.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Best {
    /// How wrong it was: see [`wrongness`].
    pub wrongness: f64,
    /// Its points in exemplar units.
    pub points: Vec<DVec2>,
    /// Which of the exemplar's points each takes its values from.
    pub sources: Vec<usize>,
}

/// Alignments at most, with relocations between them.
const ALIGNMENTS: usize = 3;
/// How often single points are moved and neighbourhoods aligned in turn at most.
const TRANSPLANTS: usize = 2;
/// Holes drawn together at the end of a class at most; one may take several turns.
const NARROWINGS: usize = 100;

/// Version of [`SynthesisState`]'s layout.
const STATE_VERSION: u32 = 2;

/// Everything needed to continue a run later, bit for bit. Taken between iterations.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct SynthesisState {
    /// Version of this layout.
    pub version: u32,
    /// The exemplar.
    pub exemplar: PointPattern,
    /// The parameters.
    pub parameters: Parameters,
    /// Output points in exemplar units, class after class as they are placed.
    pub points: Vec<DVec2>,
    /// For every output point the exemplar point whose attributes it carries. (States of version 1 have none; they
    /// are refused for their version.)
    #[serde(default)]
    pub sources: Vec<usize>,
    /// Class at hand.
    pub class: usize,
    /// Scale at hand.
    pub scale: usize,
    /// Most iterations of the scale at hand; more than its own where the scales before had nothing to match.
    pub iterations: u32,
    /// Losses of the scale at hand.
    pub losses: Vec<f64>,
    /// Iterations done in the whole run.
    pub total_iterations: u64,
    /// Which try at the worst regions of the class; 0 before the first.
    pub restart: u32,
    /// The least wrong points of the class, once there are tries.
    pub best: Option<Best>,
    /// Whether everything is done.
    pub finished: bool,
    /// Points that are held where they are, ascending.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pinned: Vec<usize>,
    /// The region that is being done again.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub redo: Option<Redo>,
    /// How many regions were done again.
    #[serde(default)]
    pub redos: u32,
    /// Adam's moments of the moving points.
    pub adam: Adam,
}

impl Synthesis {
    /// Prepares a run: checks everything, estimates memory, places the start points. `memory_limit` is in bytes.
    ///
    /// # Errors
    /// When a parameter is out of range, the exemplar has no spacing to measure, or the run would not fit.
    pub fn new(exemplar: PointPattern, parameters: Parameters, memory_limit: u64) -> Result<Self, SynthesisError> {
        let mut run = Self::prepare(exemplar, parameters, memory_limit)?;
        run.begin_class();
        Ok(run)
    }

    /// Everything that [`Self::new`] and [`Self::resume`] share.
    fn prepare(exemplar: PointPattern, parameters: Parameters, memory_limit: u64) -> Result<Self, SynthesisError> {
        parameters.validate()?;
        let spacing = exemplar
            .mean_spacing()
            .ok_or(SynthesisError::Exemplar("it needs at least two points at different positions"))?;
        let output_size =
            exemplar.domain().size_in_exemplar_units() * DVec2::new(parameters.expansion_x, parameters.expansion_y);
        let domain = exemplar.domain();
        let output_domain =
            Domain::new(domain.min(), domain.size() * DVec2::new(parameters.expansion_x, parameters.expansion_y))?;
        let positions = exemplar.positions_in_exemplar_units();
        let mut members = vec![Vec::new(); exemplar.class_names().len()];
        for (point, &class) in exemplar.classes().iter().enumerate() {
            members[usize::from(class)].push(point);
        }
        let radii = if parameters.disk_overlap > 0.0 { disk_radii(&exemplar)? } else { None };
        let run = Self {
            radii,
            schedule: Schedule::new(&parameters, spacing, density(&exemplar), output_size),
            positions,
            members,
            columns: bands::columns(&exemplar),
            order: parameters.class_order.of(&exemplar),
            output_size,
            output_domain,
            points: Vec::new(),
            sources: Vec::new(),
            pinned: Vec::new(),
            redo: None,
            redos: 0,
            arranged: Vec::new(),
            class_starts: Vec::new(),
            turn: 0,
            scale: 0,
            losses: Vec::new(),
            total_iterations: 0,
            restart: 0,
            best: None,
            finished: false,
            resumed: None,
            engine: None,
            network: None,
            gpu_network: None,
            gpu: None,
            told: VecDeque::new(),
            exemplar,
            parameters,
        };
        let total: usize = run.order.iter().map(|&class| run.output_count(class)).sum();
        if total > MAX_POINTS {
            return Err(PatternError::TooMany { what: "points in the output", count: total, max: MAX_POINTS }.into());
        }
        let largest = run.radii.iter().flatten().copied().fold(0.0, f64::max);
        if !movable(total, density(&run.exemplar), largest) {
            return Err(SynthesisError::Exemplar(
                "every disk overlaps hundreds of others; check the unit of the radii, or set 'disk-overlap' to 0",
            ));
        }
        run.check_memory(memory_limit)?;
        Ok(run)
    }

    fn fresh_schedule(&self) -> Schedule {
        let spacing = self.exemplar.mean_spacing().unwrap_or(1.0);
        Schedule::new(&self.parameters, spacing, density(&self.exemplar), self.output_size)
    }

    /// How many classes have points.
    fn classes(&self) -> usize {
        self.order.len()
    }

    /// The class at hand.
    fn class(&self) -> usize {
        self.order[self.turn]
    }

    /// The exemplar's points of the class at hand and those placed before it.
    fn seen(&self) -> Vec<usize> {
        self.order[..=self.turn].iter().flat_map(|&class| self.members[class].iter().copied()).collect()
    }

    /// What points weigh that carry the values of these exemplar points, once `placed` classes are there.
    fn weights(&self, placed: usize, sources: &[usize]) -> Weights {
        let maps = self.parameters.class_maps;
        Weights::of(&self.columns, self.exemplar.classes(), &self.order[..placed], maps, sources)
    }

    /// How many points of a class the output has: the exemplar's count times the area (Huang et al. 2022, §4.4).
    fn output_count(&self, class: usize) -> usize {
        let area = self.parameters.expansion_x * self.parameters.expansion_y;
        ((self.members[class].len() as f64 * area).round() as usize).max(1)
    }

    /// Bytes the run takes at its peak, with these parameters.
    fn memory_needed(&self, parameters: &Parameters) -> u64 {
        let size = self.exemplar.domain().size_in_exemplar_units();
        let output_size = size * DVec2::new(parameters.expansion_x, parameters.expansion_y);
        let Some(spacing) = self.exemplar.mean_spacing() else { return 0 };
        // The last class sees all maps.
        let weights = self.weights(self.classes(), &[]);
        let area = parameters.expansion_x * parameters.expansion_y;
        let points = (self.exemplar.len() as f64 * area).ceil() as usize;
        Schedule::new(parameters, spacing, density(&self.exemplar), output_size)
            .scales
            .iter()
            .map(|scale| {
                let boundary = self.exemplar.boundary();
                let positions = self.positions.clone();
                let setup = ScaleSetup {
                    exemplar_weights: weights.clone(),
                    ..ScaleSetup::new(parameters, scale, (0, 0), positions, size, boundary, output_size)
                };
                CpuEngine::bytes_for(&setup, parameters.channels as usize, points)
            })
            .max()
            .unwrap_or(0)
    }

    fn check_memory(&self, limit: u64) -> Result<(), SynthesisError> {
        let needed = self.memory_needed(&self.parameters);
        if needed <= limit {
            return Ok(());
        }
        // What would fit, changing one parameter at a time.
        let fits = |change: &dyn Fn(&mut Parameters)| {
            let mut parameters = self.parameters.clone();
            change(&mut parameters);
            self.memory_needed(&parameters) <= limit
        };
        let mut ways = Vec::new();
        if let Some(channels) =
            (4..self.parameters.channels).rev().find(|&c| c % 4 == 0 && fits(&|p: &mut Parameters| p.channels = c))
        {
            ways.push(format!("'channels' to {channels}"));
        }
        let shrink = |share: f64| (self.parameters.expansion_x * share, self.parameters.expansion_y * share);
        if let Some((x, y)) = (1..20).rev().map(|i| shrink(f64::from(i) / 20.0)).find(|&(x, y)| {
            x >= 0.25 && y >= 0.25 && fits(&|p: &mut Parameters| (p.expansion_x, p.expansion_y) = (x, y))
        }) {
            ways.push(format!("the expansion to {x:.2} × {y:.2}"));
        }
        let grid = |g: u32| {
            fits(&|p: &mut Parameters| {
                p.grid_max = g;
                p.grid_min = p.grid_min.min(g);
            })
        };
        if let Some(grid) = (16..self.parameters.grid_max).rev().step_by(4).find(|&g| grid(g)) {
            ways.push(format!("'grid-max' to {grid}"));
        }
        if ways.is_empty() {
            ways.push("'channels', the expansion and 'grid-max' together".to_owned());
        }
        let mb = |bytes: u64| bytes.div_ceil(1_000_000);
        Err(SynthesisError::Memory { needed_mb: mb(needed), limit_mb: limit / 1_000_000, lower: ways.join(" or ") })
    }

    /// Scatters the points of the class at hand; one that has its points already goes on from them.
    fn begin_class(&mut self) {
        self.scale = 0;
        self.losses.clear();
        if self.turn < self.class_starts.len() {
            if self.redo.is_none() {
                self.scale = self.parameters.restart_scale();
            }
            return;
        }
        self.class_starts.push(self.points.len());
        let class = self.class();
        let mut rng = Rng::new(self.parameters.seed, Purpose::Start(class as u16));
        self.points.extend(self.scatter(&mut rng, self.output_count(class)));
        self.deal(class);
        self.pinned.resize(self.points.len(), false);
    }

    /// So many points anywhere in the output.
    fn scatter(&self, rng: &mut Rng, count: usize) -> Vec<DVec2> {
        match self.parameters.start {
            Start::PoissonDisk => poisson_disk(rng, self.output_size, count, self.parameters.boundary),
            Start::WhiteNoise => white_noise(rng, self.output_size, count),
        }
    }

    /// Gives the points of a class that has just begun the attributes of its exemplar points: all of them, repeated as
    /// often as the area asks, in random order (Huang et al. 2022, §4.5).
    fn deal(&mut self, class: usize) {
        let mut members = self.members[class].clone();
        let mut rng = Rng::new(self.parameters.seed, Purpose::Attributes(class as u16));
        while self.sources.len() < self.points.len() {
            rng.shuffle(&mut members);
            let count = members.len().min(self.points.len() - self.sources.len());
            self.sources.extend(&members[..count]);
        }
    }

    /// Where the class at hand begins in `points`.
    fn moving_from(&self) -> usize {
        self.class_starts[self.turn]
    }

    /// For each class that has begun, in the order of placing, its points.
    fn spans(&self) -> impl Iterator<Item = (usize, std::ops::Range<usize>)> {
        let ends = self.class_starts.iter().skip(1).copied().chain([self.points.len()]);
        self.order.iter().copied().zip(self.class_starts.iter().zip(ends).map(|(&start, end)| start..end))
    }

    /// For every point of [`Self::points`] the exemplar point whose attributes it carries.
    #[must_use]
    pub fn sources(&self) -> &[usize] {
        &self.sources
    }

    /// Gives the points other exemplar points' attributes. The scale at hand goes on from its last complete iteration.
    ///
    /// # Errors
    /// When there is not one a point, one is of another class, or an exemplar point comes up more or less often than
    /// the area asks.
    pub fn set_sources(&mut self, sources: Vec<usize>) -> Result<(), SynthesisError> {
        self.check_sources(&sources).map_err(SynthesisError::Sources)?;
        self.sources = sources;
        self.restart_scale();
        Ok(())
    }

    fn check_sources(&self, sources: &[usize]) -> Result<(), String> {
        if sources.len() != self.points.len() {
            return Err(format!("there are {} for {} points", sources.len(), self.points.len()));
        }
        let mut uses = vec![0; self.exemplar.len()];
        for (class, span) in self.spans() {
            let members = &self.members[class];
            for point in span.clone() {
                let source = sources[point];
                if self.exemplar.classes().get(source).copied().map(usize::from) != Some(class) {
                    return Err(format!("point {point} has those of point {source}, which is not of its class"));
                }
                uses[source] += 1;
            }
            let fair = span.len() / members.len()..=span.len().div_ceil(members.len());
            if let Some(&member) = members.iter().find(|&&member| !fair.contains(&uses[member])) {
                return Err(format!("those of exemplar point {member} are used {} times", uses[member]));
            }
        }
        Ok(())
    }

    fn begin_scale(&mut self) -> Event {
        let seen = self.seen();
        let (arranged, moving_from) = self.arrangement();
        let sources: Vec<usize> = arranged.iter().map(|&point| self.sources[point]).collect();
        let setup = ScaleSetup {
            exemplar_weights: self.weights(self.turn + 1, &seen),
            output_weights: self.weights(self.turn + 1, &sources),
            ..ScaleSetup::new(
                &self.parameters,
                &self.schedule.scales[self.scale],
                (self.class() as u16, self.scale as u16),
                seen.iter().map(|&point| self.positions[point]).collect(),
                self.exemplar.domain().size_in_exemplar_units(),
                self.exemplar.boundary(),
                self.output_size,
            )
        };
        let grid = setup.output_view.grid;
        let sigma = setup.output_view.wave.sigma;
        let channels = self.parameters.channels as usize;
        let adam = self.resumed.take().unwrap_or_else(|| Adam::new(arranged.len() - moving_from));
        let iteration = self.losses.len() as u32;
        let points = arranged.iter().map(|&point| self.points[point]).collect();
        self.arranged = arranged;
        let engine = match &self.gpu {
            Some((gpu, memory)) => {
                let before = self.gpu_network.take();
                let kept = adam.clone();
                match GpuEngine::new(gpu, setup, channels, before, points, moving_from, adam, iteration, *memory) {
                    Ok(engine) => Engine::Gpu(Box::new(engine)),
                    Err(error) => return self.leave_gpu(kept, error.to_string()),
                }
            }
            None => {
                let network = CpuEngine::network(&setup, channels, self.network.take());
                Engine::Cpu(Box::new(CpuEngine::new(setup, network, points, moving_from, adam, iteration)))
            }
        };
        self.engine = Some(engine);
        Event::ScaleStarted { progress: self.progress(), sigma, grid: [grid.width, grid.height] }
    }

    /// Goes on without the device.
    fn leave_gpu(&mut self, adam: Adam, reason: String) -> Event {
        self.resumed = Some(adam);
        self.engine = None;
        self.gpu_network = None;
        self.gpu = None;
        Event::EngineChanged { reason }
    }

    /// Computes on this device from now on, with buffers of up to `memory` bytes; with none, on the processor. The
    /// points, moments and iterations that came back last are kept.
    pub fn use_gpu(&mut self, gpu: Option<Arc<Gpu>>, memory: u64) {
        self.restart_scale();
        self.network = None;
        self.gpu_network = None;
        self.gpu = gpu.map(|gpu| (gpu, memory));
    }

    /// Gives up what has not come back yet: the scale at hand is set up again from the last complete iteration.
    fn restart_scale(&mut self) {
        if let Some(engine) = self.engine.take() {
            self.resumed = Some(engine.adam().clone());
        }
    }

    /// Gives up the engine, but not its filters.
    fn free_engine(&mut self) {
        match self.engine.take() {
            Some(Engine::Cpu(engine)) => self.network = Some(engine.into_network()),
            Some(Engine::Gpu(engine)) => self.gpu_network = Some(engine.into_network()),
            None => {}
        }
    }

    /// The device in use.
    #[must_use]
    pub fn gpu(&self) -> Option<&Arc<Gpu>> {
        self.gpu.as_ref().map(|(gpu, _)| gpu)
    }

    /// Whether iterations that came back together have not all been told yet.
    #[must_use]
    pub fn has_more_to_tell(&self) -> bool {
        !self.told.is_empty()
    }

    /// Waits for the device after [`Event::Waiting`]; the whole program waits. In a browser a worker has to wait for
    /// [`Gpu::report`] instead.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn wait(&self) {
        if let Some(Engine::Gpu(engine)) = &self.engine {
            engine.wait();
        }
    }

    /// The stage of the engine that the next [`Self::advance`] works on, for timings.
    #[must_use]
    pub fn stage(&self) -> Option<Stage> {
        self.engine.as_ref().and_then(Engine::stage)
    }

    /// Does one bounded piece of work.
    ///
    /// # Errors
    /// When the loss stops being finite; the points of the iteration before are kept.
    pub fn advance(&mut self) -> Result<Event, SynthesisError> {
        self.advance_by(u32::MAX)
    }

    /// The same for someone who wants `most` iterations more and then to stop: on a device, which is given work ahead
    /// of what is seen of it, no more are begun.
    ///
    /// # Errors
    /// Those of [`Self::advance`].
    pub fn advance_by(&mut self, most: u32) -> Result<Event, SynthesisError> {
        if let Some(event) = self.told.pop_front() {
            return Ok(event);
        }
        if self.finished {
            return Ok(Event::Finished);
        }
        if self.engine.is_some() && self.scale_is_over() {
            return Ok(self.end_scale());
        }
        if matches!(&self.engine, Some(Engine::Gpu(engine)) if engine.ahead() > most) {
            self.restart_scale();
        }
        if self.engine.is_none() && self.moving() == 0 {
            return Ok(self.end_scale());
        }
        let left = self.schedule.scales[self.scale].iterations - self.losses.len() as u32;
        let Some(engine) = &mut self.engine else { return Ok(self.begin_scale()) };
        match engine.advance(left.min(most)) {
            Advance::Working => Ok(Event::Working),
            Advance::Waiting => Ok(Event::Waiting),
            Advance::Lost(reason) => {
                let adam = engine.adam().clone();
                Ok(self.leave_gpu(adam, reason))
            }
            Advance::Flat => {
                // Whatever scale comes first has the long way to go.
                let unused = self.schedule.scales[self.scale].iterations;
                let event = self.end_scale();
                if !self.finished && self.scale > 0 {
                    let next = &mut self.schedule.scales[self.scale].iterations;
                    *next = unused.max(*next);
                }
                Ok(event)
            }
            Advance::NotFinite => {
                Err(SynthesisError::NotFinite { scale: self.scale, iteration: self.losses.len() as u32 })
            }
            Advance::Iterated(losses) => {
                for (&point, &place) in self.arranged.iter().zip(engine.points()) {
                    self.points[point] = place;
                }
                for loss in losses {
                    self.losses.push(loss.total());
                    self.total_iterations += 1;
                    self.told.push_back(Event::Iterated { progress: self.progress(), loss });
                }
                Ok(self.told.pop_front().unwrap_or(Event::Working))
            }
        }
    }

    fn scale_converged(&self) -> bool {
        converged(&self.losses, self.parameters.convergence_window as usize, self.parameters.convergence_tolerance)
    }

    fn scale_is_over(&self) -> bool {
        self.losses.len() >= self.schedule.scales[self.scale].iterations as usize || self.scale_converged()
    }

    /// Puts right what the losses hardly see, where the exemplar says that it is wrong: the moving points' places, and
    /// whose values they carry. Nothing computes meanwhile; the next scale starts from what it leaves.
    fn repair(&mut self) {
        let Parameters {
            spacing_floor,
            relocation,
            alignment,
            transplants,
            iterations_polish,
            repair_scales,
            disk_overlap,
            value_swaps,
            boundary,
            ..
        } = self.parameters;
        let left = self.schedule.scales.len() - self.scale - 1;
        if repair_scales > 0 && left >= repair_scales as usize {
            return;
        }
        let alignment = if left == 0 { alignment } else { 0 };
        // Before the last pass too, which then gives moved points their places.
        let transplants = if left <= usize::from(iterations_polish > 0) { transplants } else { 0 };
        let by_places = spacing_floor > 0.0 || relocation > 0.0 || alignment > 0 || transplants > 0;
        if (!by_places && value_swaps == 0 && self.radii.is_none()) || self.moving() == 0 {
            return;
        }
        let Ok(exemplar) = self.exemplar_so_far() else { return };
        let Some(limits) = Limits::of(&exemplar) else { return };
        let (arranged, first) = self.arrangement();
        let mut points: Vec<DVec2> = arranged.iter().map(|&point| self.points[point]).collect();
        let mut sources: Vec<usize> = arranged.iter().map(|&point| self.sources[point]).collect();
        let most = (relocation * (points.len() - first) as f64).ceil() as usize;
        let classes = self.classes_of(&sources);
        let arrangement = Arrangement { classes: &classes, first, size: self.output_size, boundary };
        relocate(&mut points, arrangement, limits, most);
        let align = |points: &mut [DVec2]| {
            let before = points.to_vec();
            align(points, arrangement, &exemplar, alignment);
            mend(points, &before, arrangement, limits);
        };
        if alignment > 0 {
            for _ in 0..ALIGNMENTS {
                align(&mut points);
                // One too many for its row now stands on another, and can go where one is missing.
                if relocate(&mut points, arrangement, limits, most) == 0 {
                    break;
                }
            }
        }
        // What is torn open before the last pass closes in it.
        let hole = if left == 0 { limits.hole } else { f64::INFINITY };
        for _ in 0..TRANSPLANTS {
            let moved = transplant(&mut points, arrangement, &exemplar, Limits { hole, ..limits }, transplants);
            if moved == 0 || alignment == 0 {
                break;
            }
            // The rest of a row that is no longer too full or too empty; then others can be told apart.
            align(&mut points);
        }
        if value_swaps > 0 {
            self.exchange_values(&exemplar, &points, &mut sources, first, value_swaps);
        }
        if spacing_floor > 0.0 {
            // The whole of it even where points may stand closer to one another: they press against the border.
            keep_off_border(&mut points, arrangement, limits.border);
        }
        let mut room = Room::of(limits, spacing_floor, self.output_size, points.len());
        if left > 0 {
            // Groups that are only forming would be torn.
            room.clumps = Default::default();
        }
        // The class that moves has the highest number.
        let turns: Vec<u16> = self.exemplar.classes().iter().map(|&class| self.turn_of(class)).collect();
        let disks = self.radii.as_ref().and_then(|radii| {
            let all = Cloud::of(&self.exemplar).with_classes(turns.clone()).ok()?;
            let overlaps = Overlaps::of(&all, radii, self.turn as u16, disk_overlap);
            Some((Disks { radii, classes: &turns }, overlaps))
        });
        // What is a little too wide is drawn together once no descent follows that would draw it open again.
        let rounds = if left == 0 && relocation > 0.0 { NARROWINGS } else { 0 };
        for more in (0..=rounds).rev() {
            if let Some((disks, overlaps)) = &disks {
                separate(&mut points, &mut sources, arrangement, *disks, overlaps, room);
            } else if spacing_floor > 0.0 {
                keep_apart(&mut points, arrangement, room);
            }
            if more == 0 || !narrow_hole(&mut points, arrangement, limits) {
                break;
            }
        }
        for ((point, place), source) in arranged.into_iter().zip(points).zip(sources) {
            self.points[point] = place;
            self.sources[point] = source;
        }
    }

    /// When a class is placed, from 0.
    fn turn_of(&self, class: u16) -> u16 {
        self.order.iter().position(|&other| other == usize::from(class)).unwrap_or(0) as u16
    }

    /// Brings the values of the points of `first …` to where they fit; `exemplar` is [`Self::exemplar_so_far`].
    fn exchange_values(&self, exemplar: &Cloud, points: &[DVec2], sources: &mut [usize], first: usize, sweeps: u32) {
        let class = self.class() as u16;
        let Some(values) = Values::of(&self.exemplar, class) else { return };
        let Ok(output) = Cloud::new(points.to_vec(), self.output_size, self.parameters.boundary) else { return };
        let Ok(output) = output.with_classes(self.classes_of(sources)) else { return };
        let mut rng = Rng::new(self.parameters.seed, Purpose::Exchange { class, scale: self.scale as u16 });
        let exchange = Exchange::new(&values, (exemplar, &self.seen()), &output, first);
        exchange.run(sources, sweeps, &mut rng);
    }

    /// The exemplar's points of the class at hand and those before it.
    fn exemplar_so_far(&self) -> Result<Cloud, AnalysisError> {
        let size = self.exemplar.domain().size_in_exemplar_units();
        let seen = self.seen();
        let positions = seen.iter().map(|&point| self.positions[point]).collect();
        let classes = seen.iter().map(|&point| self.exemplar.classes()[point]).collect();
        Cloud::new(positions, size, self.exemplar.boundary())?.with_classes(classes)
    }

    /// Class of the points that carry these exemplar points' values.
    fn classes_of(&self, sources: &[usize]) -> Vec<u16> {
        sources.iter().map(|&source| self.exemplar.classes()[source]).collect()
    }

    /// Keeps the better of this try and the best before, and prepares another one if that is wanted and worth it.
    fn try_again(&mut self) -> bool {
        match self.shaken() {
            Some(points) => {
                self.points = points;
                self.restart += 1;
                self.scale = self.parameters.restart_scale();
            }
            None => {
                self.restart = 0;
                self.best = None;
            }
        }
        self.restart > 0
    }

    /// The points of another try; none when there is none. Leaves the best points where they are the last.
    fn shaken(&mut self) -> Option<Vec<DVec2>> {
        if self.parameters.restarts == 0 || self.moving() == 0 {
            return None;
        }
        let span = self.moving_from()..self.end();
        let (arranged, first) = self.arrangement();
        let exemplar = self.exemplar_so_far().ok()?;
        let limits = Limits::of(&exemplar)?;
        let wrong = wrongness(&self.output_so_far(&arranged).ok()?, &exemplar, limits);
        match &self.best {
            Some(best) if best.wrongness <= wrong => {
                self.points[span.clone()].copy_from_slice(&best.points);
                self.sources[span].copy_from_slice(&best.sources);
            }
            _ => {
                let (points, sources) = (self.points[span.clone()].to_vec(), self.sources[span].to_vec());
                self.best = Some(Best { wrongness: wrong, points, sources });
            }
        }
        if self.restart == self.parameters.restarts {
            return None;
        }
        let output = self.output_so_far(&arranged).ok()?;
        let mut moved = output.points().to_vec();
        let purpose = Purpose::Restart { class: self.class() as u16, restart: self.restart };
        let mut rng = Rng::new(self.parameters.seed, purpose);
        let shaken = shake(&mut moved, first, &output, &exemplar, limits, &mut rng);
        let mut points = self.points.clone();
        for (&point, place) in arranged.iter().zip(moved) {
            points[point] = place;
        }
        (shaken > 0).then_some(points)
    }

    /// These points of the output.
    fn output_so_far(&self, points: &[usize]) -> Result<Cloud, AnalysisError> {
        let places = points.iter().map(|&point| self.points[point]).collect();
        let sources: Vec<usize> = points.iter().map(|&point| self.sources[point]).collect();
        Cloud::new(places, self.output_size, self.parameters.boundary)?.with_classes(self.classes_of(&sources))
    }

    fn end_scale(&mut self) -> Event {
        self.repair();
        let event = Event::ScaleFinished { progress: self.progress(), converged: self.scale_converged() };
        self.free_engine();
        self.losses.clear();
        self.scale += 1;
        if self.scale == self.schedule.scales.len() && !self.try_again() {
            self.scale -= 1;
            self.turn += 1;
            if self.turn == self.class_starts.len()
                && let Some(redo) = self.redo.take()
            {
                self.end_redo(&redo);
            } else if self.turn == self.classes() {
                self.turn -= 1;
                self.finished = true;
                self.network = None;
                self.gpu_network = None;
            } else {
                // Forgets what flat scales passed on.
                self.schedule = self.fresh_schedule();
                self.begin_class();
            }
        }
        event
    }

    /// Runs until `iterations` more are done or the run is over.
    ///
    /// # Errors
    /// Those of [`Self::advance`].
    pub fn run(&mut self, iterations: u64) -> Result<(), SynthesisError> {
        let end = self.total_iterations.saturating_add(iterations);
        while self.total_iterations < end {
            let most = u32::try_from(end - self.total_iterations).unwrap_or(u32::MAX);
            match self.advance_by(most)? {
                Event::Finished => break,
                #[cfg(not(target_arch = "wasm32"))]
                Event::Waiting => self.wait(),
                _ => {}
            }
        }
        Ok(())
    }

    /// Positions of the output as they stand, in exemplar units, class after class as they are placed.
    #[must_use]
    pub fn points(&self) -> &[DVec2] {
        &self.points
    }

    /// Width and height of the output in exemplar units.
    #[must_use]
    pub fn output_size(&self) -> DVec2 {
        self.output_size
    }

    /// The output's points, as indices into [`Self::points`], in the order in which the exemplar lists its classes: that
    /// of [`Self::output`].
    #[must_use]
    pub fn listed(&self) -> Vec<usize> {
        let mut spans: Vec<_> = self.members.iter().map(|_| 0..0).collect();
        for (class, span) in self.spans() {
            spans[class] = span;
        }
        spans.into_iter().flatten().collect()
    }

    /// The output as it stands, in the exemplar's own unit, with classes and attributes. Classes that have not begun
    /// are missing from it.
    ///
    /// # Errors
    /// Never for a run that has begun; the pattern checks itself nevertheless.
    pub fn output(&self) -> Result<PointPattern, SynthesisError> {
        let domain = self.exemplar.domain();
        let unit = domain.exemplar_unit();
        let output_domain = self.output_domain;
        let listed = self.listed();
        let listed = || listed.iter().copied();
        let positions = listed()
            // The last digit may round over the border.
            .map(|point| (domain.min() + self.points[point] * unit).clamp(output_domain.min(), output_domain.max()))
            .collect();
        let classes = listed().map(|point| self.exemplar.classes()[self.sources[point]]).collect();
        let mut output = PointPattern::new(output_domain, positions)?
            .with_boundary(self.parameters.boundary)
            .with_classes(classes, self.exemplar.class_names().to_vec())?;
        for attribute in self.exemplar.attributes() {
            let values = listed().map(|point| attribute.values[self.sources[point]]).collect();
            output = output.with_attribute(Attribute { name: attribute.name.clone(), values })?;
        }
        Ok(output)
    }

    /// Where the run stands.
    #[must_use]
    pub fn progress(&self) -> Progress {
        let scales = &self.schedule.scales;
        // Work grows with the pixels of the grid.
        let work = |scale: usize| f64::from(scales[scale].iterations) * scales[scale].resolution.powi(2);
        let span = |from: usize, to: usize| (from..to).map(work).sum::<f64>();
        let (whole, again) = (span(0, scales.len()), span(self.parameters.restart_scale(), scales.len()));
        let all = whole + f64::from(self.parameters.restarts) * again;
        let before = match self.restart {
            0 => span(0, self.scale),
            restart => whole + f64::from(restart - 1) * again + span(self.parameters.restart_scale(), self.scale),
        };
        let limit = scales[self.scale].iterations;
        let iteration = self.losses.len() as u32;
        let current = work(self.scale) * f64::from(iteration) / f64::from(limit);
        let class_done = if self.finished { 1.0 } else { (before + current) / all };
        Progress {
            class: self.class(),
            turn: self.turn,
            classes: self.classes(),
            scale: self.scale,
            scales: scales.len(),
            restart: self.restart,
            restarts: self.parameters.restarts,
            redoing: self.is_redoing(),
            iteration,
            iterations: limit,
            total_iterations: self.total_iterations,
            done: (self.turn as f64 + class_done) / self.classes() as f64,
        }
    }

    /// The exemplar of the run.
    #[must_use]
    pub fn exemplar(&self) -> &PointPattern {
        &self.exemplar
    }

    /// The parameters of the run.
    #[must_use]
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// Everything needed to continue later. An iteration that is only partly done is done again.
    #[must_use]
    pub fn state(&self) -> SynthesisState {
        let fresh = || Adam::new(self.moving());
        let adam = match (&self.engine, &self.resumed) {
            (Some(engine), _) => engine.adam().clone(),
            (None, Some(adam)) => adam.clone(),
            (None, None) => fresh(),
        };
        SynthesisState {
            version: STATE_VERSION,
            exemplar: self.exemplar.clone(),
            parameters: self.parameters.clone(),
            points: self.points.clone(),
            sources: self.sources.clone(),
            class: self.class(),
            scale: self.scale,
            iterations: self.schedule.scales[self.scale].iterations,
            losses: self.losses.clone(),
            total_iterations: self.total_iterations,
            restart: self.restart,
            best: self.best.clone(),
            finished: self.finished,
            pinned: (0..self.points.len()).filter(|&point| self.pinned[point]).collect(),
            redo: self.redo.clone(),
            redos: self.redos,
            adam,
        }
    }

    /// Continues a saved run.
    ///
    /// # Errors
    /// When the state does not fit together, or would not fit into `memory_limit` bytes.
    pub fn resume(state: SynthesisState, memory_limit: u64) -> Result<Self, SynthesisError> {
        let refuse = |reason: String| Err(SynthesisError::State(reason));
        if state.version != STATE_VERSION {
            return refuse(format!("its version is {}, this program reads {STATE_VERSION}", state.version));
        }
        let mut run = Self::prepare(state.exemplar, state.parameters, memory_limit)?;
        let Some(turn) = run.order.iter().position(|&class| class == state.class) else {
            return refuse(format!("it is at class {}, of which the exemplar has no points", state.class));
        };
        if state.scale >= run.schedule.scales.len() {
            return refuse(format!("it is at scale {}, but there are {}", state.scale, run.schedule.scales.len()));
        }
        let longest = run.schedule.scales.iter().map(|scale| scale.iterations).max().unwrap_or(0);
        if state.iterations == 0 || state.iterations > longest {
            return refuse(format!("its scale has {} iterations, but none may have over {longest}", state.iterations));
        }
        run.schedule.scales[state.scale].iterations = state.iterations;
        // A region done again and a run with changed parameters begin with classes that are all there.
        let mut start = 0;
        for place in 0..run.classes() {
            if place > turn && start >= state.points.len() {
                break;
            }
            run.class_starts.push(start);
            start += run.output_count(run.order[place]);
        }
        if state.points.len() != start {
            return refuse(format!("it has {} points, but {start} belong to its classes", state.points.len()));
        }
        let of_class = run.class_starts[turn]..run.class_starts.get(turn + 1).copied().unwrap_or(start);
        let size = run.output_size;
        let inside = |p: &DVec2| p.x >= 0.0 && p.y >= 0.0 && p.x <= size.x && p.y <= size.y;
        if let Some(index) = state.points.iter().position(|point| !inside(point)) {
            return refuse(format!("point {index} lies outside the output"));
        }
        if state.losses.len() > run.schedule.scales[state.scale].iterations as usize
            || state.losses.iter().any(|loss| !loss.is_finite())
        {
            return refuse("its losses are not those of this scale".to_owned());
        }
        let begun = &run.order[..run.class_starts.len()];
        if let Some(redo) = &state.redo
            && (redo.points.is_empty()
                || !redo.points.is_sorted()
                || redo.points.iter().any(|&point| point >= start)
                || !begun.contains(&redo.class)
                || redo.scale >= run.schedule.scales.len()
                || state.finished)
        {
            return refuse("the region that is done again is none of its own".to_owned());
        }
        run.turn = turn;
        run.points = state.points;
        run.pinned = vec![false; start];
        for &point in &state.pinned {
            match run.pinned.get_mut(point) {
                Some(pinned) => *pinned = true,
                None => return refuse(format!("it holds point {point}, but there are {start}")),
            }
        }
        run.redo = state.redo;
        run.redos = state.redos;
        let moving = run.moving();
        let adam = &state.adam;
        if adam.first.len() != moving || adam.second.len() != moving {
            return refuse(format!("its optimiser moves {} points, not the {moving} that may move", adam.first.len()));
        }
        if adam.first.iter().chain(&adam.second).any(|v| !v.is_finite())
            || adam.second.iter().any(|v| v.min_element() < 0.0)
        {
            return refuse("its optimiser holds a value that is not allowed".to_owned());
        }
        if state.restart > run.parameters.restarts || (state.restart > 0 && state.best.is_none()) {
            return refuse(format!("it is at try {}, but there are {}", state.restart, run.parameters.restarts));
        }
        if let Some(best) = &state.best
            && (best.points.len() != of_class.len()
                || best.sources.len() != of_class.len()
                || !best.points.iter().all(inside)
                || best.wrongness.is_nan())
        {
            return refuse("its best points so far are not those of this class".to_owned());
        }
        run.restart = state.restart;
        let part = |span: std::ops::Range<usize>| state.sources.get(span).unwrap_or(&[]);
        let of_best = state
            .best
            .as_ref()
            .map(|best| [part(0..of_class.start), &best.sources, part(of_class.end..start)].concat());
        for sources in [Some(&state.sources), of_best.as_ref()].into_iter().flatten() {
            if let Err(reason) = run.check_sources(sources) {
                return refuse(format!("of the values that its points carry, {reason}"));
            }
        }
        run.best = state.best;
        run.sources = state.sources;
        run.scale = state.scale;
        run.losses = state.losses;
        run.total_iterations = state.total_iterations;
        run.finished = state.finished;
        run.resumed = Some(state.adam);
        Ok(run)
    }

    /// What lies beyond the output's border.
    #[must_use]
    pub fn boundary(&self) -> Boundary {
        self.parameters.boundary
    }
}

/// Radii of a pattern's disks in exemplar units: those of its attribute `radius`, if it has one.
fn disk_radii(exemplar: &PointPattern) -> Result<Option<Vec<f64>>, AnalysisError> {
    let Some(radii) = exemplar.radii_in(exemplar.domain().exemplar_unit()) else { return Ok(None) };
    check_radii(&Cloud::of(exemplar), &radii)?;
    Ok(Some(radii))
}

/// Points per unit area, in exemplar units.
fn density(exemplar: &PointPattern) -> f64 {
    let size = exemplar.domain().size_in_exemplar_units();
    exemplar.len() as f64 / (size.x * size.y)
}
