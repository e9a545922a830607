//! Handing points over to an engine and taking them back: on the processor or on a device, with what one scale leaves
//! to the next.
//!
//! An engine sees points in an order of its own: those that stay first, those that move after them. Both engines keep
//! their filters from one scale to the next, and the optimiser's moments survive a change of the engine.

use std::sync::Arc;

use glam::DVec2;

use crate::engine::cpu::adam::Adam;
use crate::engine::cpu::network::Network;
use crate::engine::cpu::{CpuEngine, Float};
use crate::engine::gpu::{Gpu, GpuEngine, GpuNetwork};
use crate::engine::view::Stage;
use crate::engine::{Engine, ScaleSetup};

/// The engine of a run, and what it needs to build the next one.
#[derive(Debug, Default)]
pub(super) struct Handover {
    /// None between scales, and after something was touched.
    engine: Option<Engine>,
    /// The engine's points as indices into the canvas.
    arranged: Vec<usize>,
    /// Moments to go on with; none for a fresh start.
    moments: Option<Adam>,
    /// The filters of the scale before.
    network: Option<Arc<Network<Float>>>,
    gpu_network: Option<Arc<GpuNetwork>>,
    /// The device to use, and the memory it may take, in bytes.
    gpu: Option<(Arc<Gpu>, u64)>,
}

/// What an engine starts a scale from.
pub(super) struct Start {
    pub(super) setup: ScaleSetup,
    pub(super) channels: usize,
    /// All points on the canvas.
    pub(super) points: Vec<DVec2>,
    /// The order in which the engine sees them.
    pub(super) arranged: Vec<usize>,
    /// The first place in that order whose point may move.
    pub(super) moving_from: usize,
    /// Iterations of this scale that are done.
    pub(super) iteration: u32,
}

impl Handover {
    /// The engine at work.
    pub(super) fn engine(&self) -> Option<&Engine> {
        self.engine.as_ref()
    }

    /// The engine at work, to be advanced.
    pub(super) fn engine_mut(&mut self) -> Option<&mut Engine> {
        self.engine.as_mut()
    }

    /// Builds the engine of a scale.
    ///
    /// # Errors
    /// When the device can't be used, with the reason; the next try is on the processor.
    pub(super) fn begin(&mut self, start: Start) -> Result<(), String> {
        let Start { setup, channels, points, arranged, moving_from, iteration } = start;
        let adam = self.moments.take().unwrap_or_else(|| Adam::new(arranged.len() - moving_from));
        let points = arranged.iter().map(|&point| points[point]).collect();
        self.arranged = arranged;
        let engine = match &self.gpu {
            Some((gpu, memory)) => {
                let before = self.gpu_network.take();
                let kept = adam.clone();
                match GpuEngine::new(gpu, setup, channels, before, points, moving_from, adam, iteration, *memory) {
                    Ok(engine) => Engine::Gpu(Box::new(engine)),
                    Err(error) => {
                        self.leave_gpu(kept);
                        return Err(error.to_string());
                    }
                }
            }
            None => {
                let network = CpuEngine::network(&setup, channels, self.network.take());
                Engine::Cpu(Box::new(CpuEngine::new(setup, network, points, moving_from, adam, iteration)))
            }
        };
        self.engine = Some(engine);
        Ok(())
    }

    /// Copies the engine's points to where they stand on the canvas.
    pub(super) fn take_back(&self, points: &mut [DVec2]) {
        let Some(engine) = &self.engine else { return };
        for (&point, &place) in self.arranged.iter().zip(engine.points()) {
            points[point] = place;
        }
    }

    /// Goes on without the device, with these moments.
    fn leave_gpu(&mut self, adam: Adam) {
        self.moments = Some(adam);
        self.engine = None;
        self.gpu_network = None;
        self.gpu = None;
    }

    /// The device is lost: goes on without it, from the moments that came back last.
    pub(super) fn lose_gpu(&mut self) {
        let adam = self.engine.as_ref().map(|engine| engine.adam().clone());
        if let Some(adam) = adam {
            self.leave_gpu(adam);
        }
    }

    /// Computes on this device from now on; with none, on the processor.
    pub(super) fn use_gpu(&mut self, gpu: Option<Arc<Gpu>>, memory: u64) {
        self.restart();
        self.network = None;
        self.gpu_network = None;
        self.gpu = gpu.map(|gpu| (gpu, memory));
    }

    /// Gives up what has not come back yet: the scale is set up again from the last complete iteration.
    pub(super) fn restart(&mut self) {
        if let Some(engine) = self.engine.take() {
            self.moments = Some(engine.adam().clone());
        }
    }

    /// Gives up the engine, but not its filters.
    pub(super) fn free(&mut self) {
        match self.engine.take() {
            Some(Engine::Cpu(engine)) => self.network = Some(engine.into_network()),
            Some(Engine::Gpu(engine)) => self.gpu_network = Some(engine.into_network()),
            None => {}
        }
    }

    /// The same without the moments: what moved before may not be what moves now.
    pub(super) fn free_with_moments(&mut self) {
        self.free();
        self.moments = None;
    }

    /// Gives up the filters, too: nothing will be computed for a while.
    pub(super) fn drop_networks(&mut self) {
        self.network = None;
        self.gpu_network = None;
    }

    /// Moments for the next engine.
    pub(super) fn set_moments(&mut self, adam: Adam) {
        self.moments = Some(adam);
    }

    /// The moments as they stand; none when the next engine starts with fresh ones.
    pub(super) fn moments(&self) -> Option<Adam> {
        match &self.engine {
            Some(engine) => Some(engine.adam().clone()),
            None => self.moments.clone(),
        }
    }

    /// Whether a device has been given more than so many iterations ahead.
    pub(super) fn is_ahead_of(&self, most: u32) -> bool {
        matches!(&self.engine, Some(Engine::Gpu(engine)) if engine.ahead() > most)
    }

    /// The device in use.
    pub(super) fn gpu(&self) -> Option<&Arc<Gpu>> {
        self.gpu.as_ref().map(|(gpu, _)| gpu)
    }

    /// Waits for the device.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn wait(&self) {
        if let Some(Engine::Gpu(engine)) = &self.engine {
            engine.wait();
        }
    }

    /// The stage that the next piece of work belongs to, for timings.
    pub(super) fn stage(&self) -> Option<Stage> {
        self.engine.as_ref().and_then(Engine::stage)
    }
}
