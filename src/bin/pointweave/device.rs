//! Which engine computes: the choice on the command line, and `pointweave devices`.

use std::sync::Arc;

use clap::{Args, ValueEnum};
use pointweave::engine::gpu::{self, DeviceInfo, Gpu, GpuError};

use crate::failure::Failure;

/// Memory that a run may take on a device, in bytes. Vulkan does not tell what is free; this much every card has that
/// is worth using.
pub(crate) const DEVICE_MEMORY: u64 = 3_000_000_000;

/// Values of `--engine`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum EngineArgument {
    /// The GPU if there is one and it computes correctly, else the processor
    #[default]
    Auto,
    /// The processor
    Cpu,
    /// The GPU, or fail
    Gpu,
}

/// A device that has passed the probe.
pub(crate) fn open() -> Result<Arc<Gpu>, GpuError> {
    pollster::block_on(gpu::probe::open())
}

/// Whether there may be a GPU at all. Without one, the Vulkan loader and its software drivers only cost time, and they
/// complain where there is no display.
fn may_have_gpu() -> bool {
    let nodes = ["/dev/dri", "/dev/nvidiactl", "/dev/dxg", "/dev/kgsl-3d0", "/dev/mali0"];
    !cfg!(target_os = "linux") || nodes.iter().any(|node| std::path::Path::new(node).exists())
}

/// The device to use, if any.
pub(crate) fn choose(engine: EngineArgument) -> Result<Option<Arc<Gpu>>, Failure> {
    match engine {
        EngineArgument::Cpu => Ok(None),
        EngineArgument::Gpu => open().map(Some).map_err(|error| Failure::Run(error.to_string())),
        // A processor that plays a GPU is slower than the CPU engine: it is only used when asked for.
        EngineArgument::Auto if !may_have_gpu() => Ok(None),
        EngineArgument::Auto => Ok(pollster::block_on(gpu::list())
            .iter()
            .any(|device| !device.software)
            .then(open)
            .and_then(Result::ok)
            .filter(|gpu| !gpu.info().software)),
    }
}

/// List the devices that can compute, and test the one that --engine gpu takes.
#[derive(Args, Debug)]
pub(crate) struct DevicesArguments {}

/// Lists and probes.
pub(crate) fn run(_: &DevicesArguments) -> Result<(), Failure> {
    let devices = pollster::block_on(gpu::list());
    if devices.is_empty() {
        println!("No GPU: no Vulkan driver offers one. --engine auto computes on the processor.");
        return Ok(());
    }
    for DeviceInfo { name, backend, driver, software, max_binding_bytes } in &devices {
        let note = if *software { ", played by the processor: only used with --engine gpu" } else { "" };
        println!("{name} ({backend}; {driver}): buffers of up to {} MB{note}", max_binding_bytes / 1_000_000);
    }
    let gpu = open().map_err(|error| Failure::Run(error.to_string()))?;
    println!("--engine gpu takes {}: every kernel agrees with its twin on the processor.", gpu.info().name);
    Ok(())
}
