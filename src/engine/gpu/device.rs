//! The device: which one, its limits, what went wrong with it, and how fast it is.

use std::collections::BTreeMap;
use std::fmt;
use std::future::Future;
use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll, Waker};

use thiserror::Error;
use web_time::Instant;

use super::kernel::{Kernel, Shader};

/// Why the GPU can't be used.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum GpuError {
    /// There is none.
    #[error("no WebGPU adapter: {0}")]
    NoAdapter(String),
    /// It would not open.
    #[error("the GPU '{adapter}' can't be opened: {reason}")]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// What it said.
        reason: String,
    },
    /// A kernel gave a wrong number.
    #[error("the GPU computes {what} wrongly: off by {error:.1e}, allowed are {tolerance:.0e}")]
    Wrong {
        /// Which stage.
        what: &'static str,
        /// Largest error, relative to the largest number.
        error: f64,
        /// What was allowed.
        tolerance: f64,
    },
    /// One buffer is larger than the device takes.
    #[error("the GPU takes buffers of up to {limit_mb} MB, but the {what} need {needed_mb} MB")]
    TooLarge {
        /// What it would hold.
        what: &'static str,
        /// What it would take, in MB (10⁶ bytes).
        needed_mb: u64,
        /// What the device offers, in MB.
        limit_mb: u64,
    },
    /// All buffers together are more than may be used.
    #[error("this run needs about {needed_mb} MB on the GPU, {limit_mb} MB may be used")]
    Memory {
        /// What it would take, in MB.
        needed_mb: u64,
        /// What may be used, in MB.
        limit_mb: u64,
    },
    /// It stopped working.
    #[error("the GPU stopped working: {0}")]
    Lost(String),
}

/// What is known about a device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeviceInfo {
    /// Its name; browsers don't tell.
    pub name: String,
    /// Vulkan, or WebGPU in a browser.
    pub backend: String,
    /// Driver and its version, as far as it is known.
    pub driver: String,
    /// Whether a processor only plays a GPU: slower than the CPU engine.
    pub software: bool,
    /// Most bytes of one buffer that a kernel may see.
    pub max_binding_bytes: u64,
}

/// How a device is opened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OpenOptions {
    /// Ask for nothing beyond what every WebGPU device offers, as on the weakest of them; for tests.
    pub default_limits: bool,
    /// Most tiles of an image transformed in one pass, as if memory were scarce; for tests.
    pub tiles_a_pass: Option<usize>,
}

/// Counts what the device reported, and wakes who waits for it.
#[derive(Debug, Default)]
struct Signal {
    count: u64,
    wakers: Vec<Waker>,
}

/// Something was reported: a submission is done, a buffer is mapped, the device is lost.
#[derive(Clone, Debug, Default)]
pub(super) struct Bell(Arc<Mutex<Signal>>);

/// Locks; a panic elsewhere leaves nothing half done in these.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Bell {
    pub(super) fn ring(&self) {
        let wakers = {
            let mut signal = lock(&self.0);
            signal.count += 1;
            std::mem::take(&mut signal.wakers)
        };
        wakers.into_iter().for_each(Waker::wake);
    }

    fn count(&self) -> u64 {
        lock(&self.0).count
    }
}

/// Waits until the device reports something.
#[derive(Debug)]
pub struct Report {
    bell: Bell,
    heard: u64,
}

impl Future for Report {
    type Output = ();

    fn poll(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<()> {
        let mut signal = lock(&self.bell.0);
        if signal.count != self.heard {
            return Poll::Ready(());
        }
        signal.wakers.push(context.waker().clone());
        Poll::Pending
    }
}

/// How much work a submission may hold, learnt from the ones before.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    /// Work a second, in the units of [`super::kernel::Dispatch::cost`].
    rate: f64,
}

impl Pace {
    /// A few milliseconds even for a device emulated in a browser.
    const FIRST: f64 = 4e7;

    /// Shorter than this is latency.
    const LATENCY: f64 = 2e-4;

    /// Learns from a submission: at once where it went slower than thought, so that no watchdog bites, and by and by
    /// where it went faster.
    fn learn(&mut self, cost: f64, seconds: f64) {
        let seen = cost / seconds.max(Self::LATENCY);
        self.rate = if seen < self.rate {
            0.5 * (self.rate + seen)
        } else {
            (0.7 * self.rate + 0.3 * seen).min(4.0 * self.rate)
        };
    }
}

/// An open device, shared by everything that runs on it.
pub struct Gpu {
    pub(super) device: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    info: DeviceInfo,
    limits: wgpu::Limits,
    pub(super) options: OpenOptions,
    fault: Arc<Mutex<Option<String>>>,
    pub(super) bell: Bell,
    pace: Mutex<Pace>,
    kernels: Mutex<BTreeMap<String, Kernel>>,
    /// Replaced pieces of shaders, for negative controls.
    sabotage: Mutex<Vec<(Shader, String, String)>>,
}

impl fmt::Debug for Gpu {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Gpu").field("info", &self.info).finish_non_exhaustive()
    }
}

fn instance() -> wgpu::Instance {
    wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env())
}

fn describe(adapter: &wgpu::Adapter) -> DeviceInfo {
    let info = adapter.get_info();
    let limits = adapter.limits();
    DeviceInfo {
        name: info.name,
        backend: if info.backend == wgpu::Backend::BrowserWebGpu {
            "WebGPU".to_owned()
        } else {
            info.backend.to_string()
        },
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
        software: info.device_type == wgpu::DeviceType::Cpu,
        max_binding_bytes: limits.max_storage_buffer_binding_size.min(limits.max_buffer_size),
    }
}

/// All devices there are; none in a browser, which does not tell.
pub async fn list() -> Vec<DeviceInfo> {
    instance().enumerate_adapters(wgpu::Backends::all()).await.iter().map(describe).collect()
}

impl Gpu {
    /// Opens the device that the system recommends for speed.
    ///
    /// # Errors
    /// When there is none, or it won't open.
    pub async fn open(options: OpenOptions) -> Result<Arc<Self>, GpuError> {
        let request = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let adapter = instance().request_adapter(&request).await.map_err(|error| {
            // In a browser wgpu lists what else it was not built for.
            let browser = cfg!(target_arch = "wasm32");
            GpuError::NoAdapter(if browser { "this browser offers none".to_owned() } else { error.to_string() })
        })?;
        let mut info = describe(&adapter);
        let mut limits = wgpu::Limits::defaults();
        if !options.default_limits {
            let offered = adapter.limits();
            limits.max_storage_buffer_binding_size = offered.max_storage_buffer_binding_size;
            limits.max_buffer_size = offered.max_buffer_size;
        }
        info.max_binding_bytes = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        let descriptor =
            wgpu::DeviceDescriptor { label: Some("pointweave"), required_limits: limits.clone(), ..Default::default() };
        let (device, queue) = adapter
            .request_device(&descriptor)
            .await
            .map_err(|error| GpuError::NoDevice { adapter: info.name.clone(), reason: error.to_string() })?;

        let (fault, bell) = (Arc::new(Mutex::new(None)), Bell::default());
        let report = |fault: &Arc<Mutex<Option<String>>>, bell: &Bell| {
            let (fault, bell) = (Arc::clone(fault), bell.clone());
            move |message: String| {
                lock(&fault).get_or_insert(message);
                bell.ring();
            }
        };
        let lost = report(&fault, &bell);
        device.set_device_lost_callback(move |reason, message| {
            let message = message.trim();
            lost(if message.is_empty() { format!("{reason:?}") } else { message.to_owned() });
        });
        // An error that no one expected is as good as a lost device: what is in its buffers can't be trusted.
        let failed = report(&fault, &bell);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| failed(error.to_string())));
        Ok(Arc::new(Self {
            device,
            queue,
            info,
            limits,
            options,
            fault,
            bell,
            pace: Mutex::new(Pace { rate: Pace::FIRST }),
            kernels: Mutex::default(),
            sabotage: Mutex::default(),
        }))
    }

    /// What is known about it.
    #[must_use]
    pub fn info(&self) -> &DeviceInfo {
        &self.info
    }

    pub(super) fn limits(&self) -> &wgpu::Limits {
        &self.limits
    }

    /// What went wrong with it, if anything did: then it computes no more.
    #[must_use]
    pub fn fault(&self) -> Option<String> {
        lock(&self.fault).clone()
    }

    /// Uses it no more, for this reason unless there was one before.
    pub(super) fn condemn(&self, reason: &str) {
        lock(&self.fault).get_or_insert_with(|| reason.to_owned());
    }

    /// Makes it stop working, as unplugging it would; for tests.
    pub fn destroy(&self) {
        // A browser reports it later, wgpu at the next poll: from now on nothing may be believed.
        self.condemn("it was destroyed");
        self.device.destroy();
        self.bell.ring();
    }

    /// Replaces a piece of a shader in everything compiled from now on: the negative control of a test. A piece that
    /// does not occur is a fault of the device.
    pub fn sabotage(&self, shader: Shader, piece: &str, replacement: &str) {
        if !shader.text().contains(piece) {
            lock(&self.fault).get_or_insert_with(|| format!("{shader:?} holds no {piece:?}"));
        }
        lock(&self.sabotage).push((shader, piece.to_owned(), replacement.to_owned()));
        lock(&self.kernels).clear();
    }

    pub(super) fn source(&self, shader: Shader, constants: &[(&'static str, u32)]) -> String {
        let mut source = shader.with_constants(constants);
        for (_, piece, replacement) in lock(&self.sabotage).iter().filter(|(which, ..)| *which == shader) {
            source = source.replace(piece, replacement);
        }
        source
    }

    /// A compiled kernel, from the cache if it was needed before.
    pub(super) fn kernel(&self, shader: Shader, entry: &'static str, constants: &[(&'static str, u32)]) -> Kernel {
        let key = format!("{shader:?} {entry} {constants:?}");
        if let Some(kernel) = lock(&self.kernels).get(&key) {
            return kernel.clone();
        }
        let kernel = Kernel::compile(self, shader, entry, constants);
        lock(&self.kernels).insert(key, kernel.clone());
        kernel
    }

    /// Work that takes about this long, by what the submissions so far took.
    pub(super) fn work_in(&self, seconds: f64) -> f64 {
        lock(&self.pace).rate * seconds
    }

    pub(super) fn learn(&self, cost: f64, seconds: f64) {
        lock(&self.pace).learn(cost, seconds);
    }

    /// Lets callbacks run that are due. In a browser they run by themselves, between two tasks.
    pub(super) fn poll(&self) {
        // A failure here reaches `fault` by the callbacks.
        let _ = self.device.poll(wgpu::PollType::Poll);
    }

    /// Waits until a submission is done; the whole program waits. Not in a browser, where [`Self::report`] is.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn wait_for(&self, submission: &wgpu::SubmissionIndex) {
        let wait = wgpu::PollType::Wait { submission_index: Some(submission.clone()), timeout: Some(PATIENCE) };
        if let Err(error) = self.device.poll(wait) {
            lock(&self.fault).get_or_insert_with(|| format!("no answer for {} s ({error})", PATIENCE.as_secs()));
        }
    }

    /// Resolves at the next report of the device: something is done, or the device is lost.
    #[must_use]
    pub fn report(&self) -> Report {
        Report { heard: self.bell.count(), bell: self.bell.clone() }
    }
}

/// A submission is sized to take a tenth of a second. What takes this long will never come.
#[cfg(not(target_arch = "wasm32"))]
const PATIENCE: std::time::Duration = std::time::Duration::from_secs(60);

/// A submission on its way.
#[derive(Debug)]
pub(super) struct InFlight {
    cost: f64,
    submitted: Instant,
    done: Arc<Mutex<Option<Instant>>>,
    #[cfg_attr(target_arch = "wasm32", expect(dead_code, reason = "only natively can one wait for it"))]
    pub(super) index: wgpu::SubmissionIndex,
}

impl InFlight {
    /// Hands commands worth `cost` to the device.
    pub(super) fn submit(gpu: &Gpu, commands: wgpu::CommandBuffer, cost: f64) -> Self {
        let submitted = Instant::now();
        let index = gpu.queue.submit([commands]);
        let done = Arc::new(Mutex::new(None));
        let (mark, bell) = (Arc::clone(&done), gpu.bell.clone());
        gpu.queue.on_submitted_work_done(move || {
            *lock(&mark) = Some(Instant::now());
            bell.ring();
        });
        Self { cost, submitted, done, index }
    }

    /// When it was done, if it is; tells the device's pace how long it took. `before` is when the one before it was.
    pub(super) fn collect(&self, gpu: &Gpu, before: Option<Instant>) -> Option<Instant> {
        let done = (*lock(&self.done))?;
        let began = before.map_or(self.submitted, |before| before.max(self.submitted));
        gpu.learn(self.cost, done.duration_since(began).as_secs_f64());
        Some(done)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn submissions_settle_at_the_time_they_may_take_on_fast_and_on_slow_devices() {
        for speed in [5e6, 1e9, 2e13] {
            let mut pace = Pace { rate: Pace::FIRST };
            let mut longest = 0.0_f64;
            for submission in 0..40 {
                let work = pace.rate * 0.05;
                let seconds = work / speed + 1e-5;
                if submission > 0 {
                    longest = longest.max(seconds);
                }
                pace.learn(work, seconds);
            }
            let last = pace.rate * 0.05 / speed;
            assert!((0.04..0.06).contains(&last), "{speed}: {last} s");
            // Nothing is known before the first: a device that slow is told from it, and is not asked for as much again.
            assert!(longest < if speed < 1e7 { 0.3 } else { 0.1 }, "{speed}: {longest} s");
        }
    }

    #[test]
    fn a_device_that_becomes_slower_is_asked_for_less_at_once() {
        let mut pace = Pace { rate: 1e12 };
        pace.learn(5e10, 1.0);
        assert!(pace.rate < 0.6e12, "{}", pace.rate);
        // Something that took no time at all says nothing about speed.
        let mut pace = Pace { rate: 1e9 };
        pace.learn(100.0, 0.0);
        assert!(pace.rate < 1e9 && pace.rate.is_finite());
    }
}
