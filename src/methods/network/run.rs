//! The run as a state machine: classes × scales × iterations.
//!
//! [`NetworkRun::advance`] does one bounded piece of work (a fraction of an iteration: well under a second even at the
//! paper's size in a browser) and says what happened. Its parts can be read by themselves: the points
//! ([`crate::run::Canvas`]), the place on the ladder (`ladder.rs`), the engine (`handover.rs`), what is put right
//! (`finishing.rs`), other tries (`retries.rs`), hands (`edits.rs`) and saved states (`state.rs`).

use std::collections::VecDeque;
use std::ops::Range;
use std::sync::Arc;

use glam::DVec2;

use super::NetworkError;
use super::exemplar::PreparedExemplar;
use super::finishing::finishing_after;
use super::handover::{Handover, Start};
use super::ladder::Ladder;
use super::memory;
use super::parameters::{Parameters, PointStart};
use super::retries::Best;
use super::state::Redo;
use crate::engine::gpu::Gpu;
use crate::engine::view::Stage;
use crate::engine::{Advance, LossTerms, ScaleSetup};
use crate::finish::Frame;
use crate::finish::disks::movable;
use crate::pattern::{Boundary, MAX_POINTS, PatternError, PointPattern};
use crate::run::{Canvas, Event, Losses, Progress};
use crate::sampling::{Purpose, Rng, poisson_disk, white_noise};

/// A run of the method. Same exemplar, parameters and seed: the same points.
#[derive(Debug)]
pub struct NetworkRun {
    /// The output's points, class after class as they are placed: those of the classes done and of the one at hand.
    pub(super) canvas: Canvas,
    pub(super) prepared: PreparedExemplar,
    pub(super) parameters: Parameters,
    pub(super) ladder: Ladder,
    pub(super) handover: Handover,
    /// Where each started class begins on the canvas, in the order of placing.
    pub(super) class_starts: Vec<usize>,
    /// How many classes were placed before the one at hand.
    pub(super) turn: usize,
    /// The least mismatched points of the class at hand so far.
    pub(super) best: Option<Best>,
    /// The region that is being done again, and how many there were.
    pub(super) redo: Option<Redo>,
    pub(super) redos: u32,
    pub(super) total_iterations: u64,
    pub(super) finished: bool,
    /// Events not yet returned by [`Self::advance_by`].
    pending: VecDeque<Event>,
}

/// The named terms of an engine's loss.
fn named(loss: LossTerms) -> Losses {
    Losses::new([("gram", loss.grams()), ("correlation", loss.correlation)])
}

impl NetworkRun {
    /// Prepares a run: checks everything, estimates memory, places the start points. `memory_limit` is in bytes.
    ///
    /// # Errors
    /// When a parameter is out of range, the exemplar has no spacing to measure, or the run would not fit.
    pub fn new(exemplar: PointPattern, parameters: Parameters, memory_limit: u64) -> Result<Self, NetworkError> {
        let mut run = Self::prepare(exemplar, parameters, memory_limit)?;
        run.begin_class();
        Ok(run)
    }

    /// Everything that [`Self::new`], [`Self::resume`] and [`Self::continue_with`] share: a run without points.
    pub(super) fn prepare(
        exemplar: PointPattern,
        parameters: Parameters,
        memory_limit: u64,
    ) -> Result<Self, NetworkError> {
        parameters.validate()?;
        let prepared = PreparedExemplar::new(&exemplar, &parameters)?;
        let expansion = DVec2::new(parameters.expansion_x, parameters.expansion_y);
        let run = Self {
            canvas: Canvas::new(exemplar, expansion, parameters.boundary)?,
            ladder: Ladder::new(prepared.schedule(&parameters)),
            handover: Handover::default(),
            class_starts: Vec::new(),
            turn: 0,
            best: None,
            redo: None,
            redos: 0,
            total_iterations: 0,
            finished: false,
            pending: VecDeque::new(),
            prepared,
            parameters,
        };
        let total: usize = run.prepared.order.iter().map(|&class| run.output_count(class)).sum();
        if total > MAX_POINTS {
            return Err(PatternError::TooMany { what: "points in the output", count: total, max: MAX_POINTS }.into());
        }
        let largest = run.prepared.radii.iter().flatten().copied().fold(0.0, f64::max);
        if !movable(total, run.prepared.density, largest) {
            return Err(NetworkError::Exemplar(
                "every disk overlaps hundreds of others; check the unit of the radii, or set 'disk-overlap' to 0",
            ));
        }
        memory::check(run.canvas.exemplar(), &run.prepared, &run.parameters, memory_limit)?;
        Ok(run)
    }

    /// How many classes have points.
    pub(super) fn classes(&self) -> usize {
        self.prepared.order.len()
    }

    /// The class at hand.
    pub(super) fn class(&self) -> usize {
        self.prepared.order[self.turn]
    }

    /// How many points of a class the output has.
    pub(super) fn output_count(&self, class: usize) -> usize {
        self.prepared.output_count(class, self.parameters.expansion_x * self.parameters.expansion_y)
    }

    /// Scatters the points of the class at hand; one that has its points already goes on from them.
    pub(super) fn begin_class(&mut self) {
        self.ladder.go_to(0);
        if self.turn < self.class_starts.len() {
            if self.redo.is_none() {
                self.ladder.scale = self.parameters.restart_scale();
            }
            return;
        }
        self.class_starts.push(self.canvas.points().len());
        let class = self.class();
        let mut rng = Rng::new(self.parameters.seed, Purpose::Start(class as u16));
        let places = self.scatter(&mut rng, self.output_count(class));
        let sources = self.deal(class, places.len());
        for (place, source) in places.into_iter().zip(sources) {
            self.canvas.add(place, source);
        }
    }

    /// So many points anywhere in the output.
    pub(super) fn scatter(&self, rng: &mut Rng, count: usize) -> Vec<DVec2> {
        match self.parameters.start {
            PointStart::PoissonDisk => poisson_disk(rng, self.canvas.size(), count, self.parameters.boundary),
            PointStart::WhiteNoise => white_noise(rng, self.canvas.size(), count),
        }
    }

    /// For the points of a class that begins the exemplar points whose attributes they get: all of them, repeated as
    /// often as the area asks, in random order (Huang et al. 2022, §4.5).
    fn deal(&self, class: usize, count: usize) -> Vec<usize> {
        let mut members = self.prepared.members[class].clone();
        let mut rng = Rng::new(self.parameters.seed, Purpose::Attributes(class as u16));
        let mut sources = Vec::with_capacity(count);
        while sources.len() < count {
            rng.shuffle(&mut members);
            let some = members.len().min(count - sources.len());
            sources.extend(&members[..some]);
        }
        sources
    }

    /// Where the class at hand begins on the canvas.
    pub(super) fn class_start(&self) -> usize {
        self.class_starts[self.turn]
    }

    /// Where it ends.
    pub(super) fn class_end(&self) -> usize {
        self.class_starts.get(self.turn + 1).copied().unwrap_or(self.canvas.points().len())
    }

    /// For each class that has begun, in the order of placing, its points, where there are `count` points in all.
    pub(super) fn spans(&self, count: usize) -> impl Iterator<Item = (usize, Range<usize>)> {
        let ends = self.class_starts.iter().skip(1).copied().chain([count]);
        self.prepared.order.iter().copied().zip(self.class_starts.iter().zip(ends).map(|(&start, end)| start..end))
    }

    /// Whether this point may move.
    fn is_free(&self, point: usize) -> bool {
        !self.canvas.pinned()[point] && self.redo.as_ref().is_none_or(|redo| redo.points.binary_search(&point).is_ok())
    }

    /// The points of the class at hand and those before it, what may not move first, and where the others begin.
    pub(super) fn arrangement(&self) -> (Vec<usize>, usize) {
        let (start, end) = (self.class_start(), self.class_end());
        let mut order: Vec<usize> = (0..start).collect();
        order.extend((start..end).filter(|&point| !self.is_free(point)));
        let first = order.len();
        order.extend((start..end).filter(|&point| self.is_free(point)));
        (order, first)
    }

    /// How many points of the class at hand may move.
    pub(super) fn moving(&self) -> usize {
        (self.class_start()..self.class_end()).filter(|&point| self.is_free(point)).count()
    }

    /// For every point the exemplar point whose attributes it carries.
    #[must_use]
    pub fn sources(&self) -> &[usize] {
        self.canvas.sources()
    }

    /// Gives the points other exemplar points' attributes. The scale at hand goes on from its last complete iteration.
    ///
    /// # Errors
    /// When there is not one a point, one is of another class, or an exemplar point comes up more or less often than
    /// the area asks.
    pub fn set_sources(&mut self, sources: &[usize]) -> Result<(), NetworkError> {
        self.check_sources(sources, self.canvas.points().len()).map_err(NetworkError::Sources)?;
        self.canvas.sources_mut().copy_from_slice(sources);
        self.handover.restart();
        Ok(())
    }

    /// Checks sources of `count` points against classes and fair use.
    pub(super) fn check_sources(&self, sources: &[usize], count: usize) -> Result<(), String> {
        if sources.len() != count {
            return Err(format!("there are {} for {count} points", sources.len()));
        }
        let exemplar = self.canvas.exemplar();
        let mut uses = vec![0; exemplar.len()];
        for (class, span) in self.spans(count) {
            let members = &self.prepared.members[class];
            for point in span.clone() {
                let source = sources[point];
                if exemplar.classes().get(source).copied().map(usize::from) != Some(class) {
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
        let seen = self.prepared.seen(self.turn);
        let (arranged, moving_from) = self.arrangement();
        let sources: Vec<usize> = arranged.iter().map(|&point| self.sources()[point]).collect();
        let exemplar = self.canvas.exemplar();
        let weights = |sources: &[usize]| self.prepared.weights(exemplar.classes(), self.turn + 1, sources);
        let place = (self.class() as u16, self.ladder.scale as u16);
        let setup = ScaleSetup {
            exemplar_weights: weights(&seen),
            output_weights: weights(&sources),
            ..ScaleSetup::new(
                &self.parameters.scale_settings(self.ladder.current(), place),
                seen.iter().map(|&point| self.prepared.positions[point]).collect(),
                self.prepared.size,
                exemplar.boundary(),
                self.canvas.size(),
            )
        };
        let grid = setup.output_view.grid;
        let sigma = setup.output_view.wave.sigma;
        let start = Start {
            setup,
            channels: self.parameters.channels as usize,
            points: self.canvas.points().to_vec(),
            arranged,
            moving_from,
            iteration: self.ladder.losses.len() as u32,
        };
        match self.handover.begin(start) {
            Ok(()) => Event::ScaleStarted { progress: self.progress(), sigma, grid: [grid.width, grid.height] },
            Err(reason) => Event::EngineChanged { reason },
        }
    }

    /// Computes on this device from now on, with buffers of up to `memory` bytes; with none, on the processor. The
    /// points, moments and iterations that came back last are kept.
    pub fn use_gpu(&mut self, gpu: Option<Arc<Gpu>>, memory: u64) {
        self.handover.use_gpu(gpu, memory);
    }

    /// The device in use.
    #[must_use]
    pub fn gpu(&self) -> Option<&Arc<Gpu>> {
        self.handover.gpu()
    }

    /// Whether events that came together have not all been returned yet.
    #[must_use]
    pub fn has_pending_events(&self) -> bool {
        !self.pending.is_empty()
    }

    /// Waits for the device after [`Event::Waiting`]; the whole program waits. In a browser a worker has to wait for
    /// [`Gpu::report`] instead.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn wait(&self) {
        self.handover.wait();
    }

    /// The stage of the engine that the next [`Self::advance`] works on, for timings.
    #[must_use]
    pub fn stage(&self) -> Option<Stage> {
        self.handover.stage()
    }

    /// Does one bounded piece of work.
    ///
    /// # Errors
    /// When the loss stops being finite; the points of the iteration before are kept.
    pub fn advance(&mut self) -> Result<Event, NetworkError> {
        self.advance_by(u32::MAX)
    }

    /// The same for someone who wants `most` iterations more and then to stop: on a device, which is given work ahead
    /// of what is seen of it, no more are begun.
    ///
    /// # Errors
    /// Those of [`Self::advance`].
    pub fn advance_by(&mut self, most: u32) -> Result<Event, NetworkError> {
        if let Some(event) = self.pending.pop_front() {
            return Ok(event);
        }
        if self.finished {
            return Ok(Event::Finished);
        }
        if self.handover.engine().is_some() && self.ladder.is_over(&self.parameters) {
            return Ok(self.end_scale());
        }
        if self.handover.is_ahead_of(most) {
            self.handover.restart();
        }
        if self.handover.engine().is_none() && self.moving() == 0 {
            return Ok(self.end_scale());
        }
        let left = self.ladder.left();
        let Some(engine) = self.handover.engine_mut() else { return Ok(self.begin_scale()) };
        match engine.advance(left.min(most)) {
            Advance::Working => Ok(Event::Working),
            Advance::Waiting => Ok(Event::Waiting),
            Advance::Lost(reason) => {
                self.handover.lose_gpu();
                Ok(Event::EngineChanged { reason })
            }
            Advance::Flat => {
                // Whatever scale comes first has the long way to go.
                let unused = self.ladder.current().iterations;
                let event = self.end_scale();
                if !self.finished && self.ladder.scale > 0 {
                    self.ladder.set_iterations(unused.max(self.ladder.current().iterations));
                }
                Ok(event)
            }
            Advance::NotFinite => {
                Err(NetworkError::NotFinite { scale: self.ladder.scale, iteration: self.ladder.losses.len() as u32 })
            }
            Advance::Iterated(losses) => {
                self.handover.take_back(self.canvas.points_mut());
                for loss in losses {
                    self.ladder.losses.push(loss.total());
                    self.total_iterations += 1;
                    self.pending.push_back(Event::Iterated { progress: self.progress(), losses: named(loss) });
                }
                Ok(self.pending.pop_front().unwrap_or(Event::Working))
            }
        }
    }

    /// Puts right what the losses do not see, where the exemplar says that it is wrong. Nothing computes meanwhile; the
    /// next scale starts from what it leaves.
    fn finish_scale(&mut self) {
        let has_disks = self.prepared.radii.is_some();
        let Some(finishing) = finishing_after(&self.parameters, self.ladder.scales_left(), has_disks) else { return };
        if self.moving() == 0 {
            return;
        }
        let seen = self.prepared.seen(self.turn);
        let class = self.class();
        let Ok(reference) = self.prepared.reference(self.canvas.exemplar(), &seen, class) else { return };
        let (arranged, first) = self.arrangement();
        let mut points: Vec<DVec2> = arranged.iter().map(|&point| self.canvas.points()[point]).collect();
        let mut sources: Vec<usize> = arranged.iter().map(|&point| self.sources()[point]).collect();
        let frame = Frame { first, size: self.canvas.size(), boundary: self.parameters.boundary };
        let purpose = Purpose::Exchange { class: class as u16, scale: self.ladder.scale as u16 };
        let mut rng = Rng::new(self.parameters.seed, purpose);
        finishing.apply(&mut points, &mut sources, &reference, frame, &mut rng);
        for ((point, place), source) in arranged.into_iter().zip(points).zip(sources) {
            self.canvas.points_mut()[point] = place;
            self.canvas.sources_mut()[point] = source;
        }
    }

    fn end_scale(&mut self) -> Event {
        self.finish_scale();
        let converged = self.ladder.has_converged(&self.parameters);
        let event = Event::ScaleFinished { progress: self.progress(), converged };
        self.handover.free();
        self.ladder.go_to(self.ladder.scale + 1);
        if self.ladder.scale == self.ladder.scales().len() && !self.try_again() {
            self.ladder.scale -= 1;
            self.turn += 1;
            if self.turn == self.class_starts.len()
                && let Some(redo) = self.redo.take()
            {
                self.end_redo(&redo);
            } else if self.turn == self.classes() {
                self.turn -= 1;
                self.finished = true;
                self.handover.drop_networks();
            } else {
                self.ladder.renew(self.prepared.schedule(&self.parameters));
                self.begin_class();
            }
        }
        event
    }

    /// Runs until `iterations` more are done or the run is over.
    ///
    /// # Errors
    /// Those of [`Self::advance`].
    pub fn run(&mut self, iterations: u64) -> Result<(), NetworkError> {
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

    /// The points and the rectangle they stand in.
    #[must_use]
    pub fn canvas(&self) -> &Canvas {
        &self.canvas
    }

    /// Positions of the output as they stand, in exemplar units, class after class as they are placed.
    #[must_use]
    pub fn points(&self) -> &[DVec2] {
        self.canvas.points()
    }

    /// Width and height of the output in exemplar units.
    #[must_use]
    pub fn output_size(&self) -> DVec2 {
        self.canvas.size()
    }

    /// The output as it stands, in the exemplar's own unit, with classes and attributes. Classes that have not begun
    /// are missing from it.
    ///
    /// # Errors
    /// Never for a run that has begun; the pattern checks itself nevertheless.
    pub fn output(&self) -> Result<PointPattern, NetworkError> {
        Ok(self.canvas.pattern()?)
    }

    /// Where the run stands.
    #[must_use]
    pub fn progress(&self) -> Progress {
        let on_ladder = self.ladder.progress(&self.parameters);
        let class_done = if self.finished { 1.0 } else { on_ladder.done };
        Progress {
            class: self.class(),
            turn: self.turn,
            classes: self.classes(),
            redoing: self.is_redoing(),
            total_iterations: self.total_iterations,
            done: (self.turn as f64 + class_done) / self.classes() as f64,
            ..on_ladder
        }
    }

    /// Whether a region is being done again.
    #[must_use]
    pub fn is_redoing(&self) -> bool {
        self.redo.is_some()
    }

    /// The exemplar of the run.
    #[must_use]
    pub fn exemplar(&self) -> &PointPattern {
        self.canvas.exemplar()
    }

    /// The parameters of the run.
    #[must_use]
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// What lies beyond the output's border.
    #[must_use]
    pub fn boundary(&self) -> Boundary {
        self.parameters.boundary
    }
}
