//! What computes: the processor, or a device that the browser has, for as long as it works.

use std::sync::Arc;

use super::{DEVICE_MEMORY, Pulled, Refusal, Session};
use crate::engine::gpu::{Gpu, Report, probe};
use crate::web::protocol::{AdapterView, EngineChoice, EngineView, Response};

/// The processor.
pub(super) fn cpu() -> EngineView {
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

impl Session {
    pub(super) async fn advance_on_device(
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
    async fn wait(&self, report: Option<Report>) {
        if let Some(report) = report {
            report.await;
        }
    }

    #[cfg(not(target_arch = "wasm32"))]
    async fn wait(&self, _: Option<Report>) {
        if let Some(run) = &self.running {
            run.run.wait();
        }
    }

    /// Goes on without a device.
    pub(super) fn leave_device(&mut self, reason: &str) {
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
        if let Some(run) = &mut self.running {
            run.run.use_gpu(self.gpu.clone(), DEVICE_MEMORY);
        }
    }

    pub(super) async fn choose_engine(&mut self, choice: EngineChoice, adapter: Option<AdapterView>) -> Response {
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

    pub(super) fn gpu_view(&self, gpu: &Gpu) -> EngineView {
        let reported = self.adapter.as_ref().map_or("", |adapter| adapter.name.as_str());
        let emulated = gpu.info().software || self.adapter.as_ref().is_some_and(|adapter| adapter.software);
        let name = [reported, gpu.info().name.as_str()].into_iter().find(|name| !name.is_empty()).unwrap_or("GPU");
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
}
