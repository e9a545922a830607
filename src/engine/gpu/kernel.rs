//! Shaders, kernels made of them, and what it takes to start one.

use std::fmt;

use bytemuck::Pod;

use super::device::Gpu;
use super::plan::Need;
use crate::engine::view::Stage;

/// The files of `shaders/`, each named as its twin in `engine/cpu`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Shader {
    /// `gabor.wgsl`
    Gabor,
    /// `convolution.wgsl`
    Convolution,
    /// `normalization.wgsl`
    Normalization,
    /// `gram.wgsl`
    Gram,
    /// `correlation.wgsl`
    Correlation,
    /// `adam.wgsl`
    Adam,
    /// `loss.wgsl`
    Loss,
    /// `direct.wgsl`, which only benchmarks use.
    #[cfg(not(target_arch = "wasm32"))]
    Direct,
}

impl Shader {
    /// All of them.
    #[cfg(not(target_arch = "wasm32"))]
    pub const ALL: [Self; 8] = [
        Self::Gabor,
        Self::Convolution,
        Self::Normalization,
        Self::Gram,
        Self::Correlation,
        Self::Adam,
        Self::Loss,
        Self::Direct,
    ];

    /// Its text, without what the host sets.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Gabor => include_str!(concat!(env!("OUT_DIR"), "/gabor.wgsl")),
            Self::Convolution => include_str!(concat!(env!("OUT_DIR"), "/convolution.wgsl")),
            Self::Normalization => include_str!(concat!(env!("OUT_DIR"), "/normalization.wgsl")),
            Self::Gram => include_str!(concat!(env!("OUT_DIR"), "/gram.wgsl")),
            Self::Correlation => include_str!(concat!(env!("OUT_DIR"), "/correlation.wgsl")),
            Self::Adam => include_str!(concat!(env!("OUT_DIR"), "/adam.wgsl")),
            Self::Loss => include_str!(concat!(env!("OUT_DIR"), "/loss.wgsl")),
            #[cfg(not(target_arch = "wasm32"))]
            Self::Direct => include_str!(concat!(env!("OUT_DIR"), "/direct.wgsl")),
        }
    }

    /// Its text with the constants that the host sets.
    #[must_use]
    pub fn with_constants(self, constants: &[(&'static str, u32)]) -> String {
        let mut source: String = constants.iter().map(|(name, value)| format!("const {name} = {value}u;\n")).collect();
        source.push_str(self.text());
        source
    }
}

/// A compiled entry point.
#[derive(Clone)]
pub(super) struct Kernel {
    pipeline: wgpu::ComputePipeline,
    label: &'static str,
}

impl fmt::Debug for Kernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Kernel({})", self.label)
    }
}

impl Kernel {
    pub(super) fn compile(gpu: &Gpu, shader: Shader, entry: &'static str, constants: &[(&'static str, u32)]) -> Self {
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(entry),
            source: wgpu::ShaderSource::Wgsl(gpu.source(shader, constants).into()),
        });
        let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(entry),
            layout: None,
            module: &module,
            entry_point: Some(entry),
            compilation_options: wgpu::PipelineCompilationOptions {
                // Every kernel writes its workgroup memory before it reads it.
                zero_initialize_workgroup_memory: false,
                ..Default::default()
            },
            cache: None,
        });
        Self { pipeline, label: entry }
    }
}

/// One kernel with its buffers, ready to be started.
#[derive(Debug)]
pub(super) struct Dispatch {
    kernel: Kernel,
    bindings: wgpu::BindGroup,
    workgroups: [u32; 3],
    /// The stage it belongs to, for timings.
    #[cfg_attr(target_arch = "wasm32", expect(dead_code, reason = "nothing is timed in a browser"))]
    pub(super) stage: Stage,
    /// Its work: floating-point operations, and numbers moved as eight of them.
    pub(super) cost: f64,
}

impl Dispatch {
    // Some fifty callers: inlined, it would be several kB of the wasm.
    #[inline(never)]
    pub(super) fn new(
        gpu: &Gpu,
        kernel: &Kernel,
        bindings: &[(u32, &wgpu::Buffer)],
        workgroups: [usize; 3],
        stage: Stage,
        cost: f64,
    ) -> Self {
        let entries: Vec<wgpu::BindGroupEntry> = bindings
            .iter()
            .map(|&(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let bindings = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(kernel.label),
            layout: &kernel.pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        Self { kernel: kernel.clone(), bindings, workgroups: workgroups.map(|count| count as u32), stage, cost }
    }

    /// Whether it is a product of matrices in the Fourier domain.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn is_product(&self) -> bool {
        self.kernel.label == "multiply"
    }

    pub(super) fn encode(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_pipeline(&self.kernel.pipeline);
        pass.set_bind_group(0, &self.bindings, &[]);
        let [x, y, z] = self.workgroups;
        pass.dispatch_workgroups(x, y, z);
    }
}

/// Workgroups of `size` invocations for `count` items, folded into two dimensions where one is too short:
/// the kernel's index is `y · 65535 · size + x`.
pub(super) fn folded(count: usize, size: usize) -> [usize; 3] {
    let groups = count.div_ceil(size).max(1);
    [groups.min(65535), groups.div_ceil(65535), 1]
}

impl Gpu {
    /// A buffer of `numbers` 32-bit numbers that only the device sees.
    #[inline(never)]
    pub(super) fn storage(&self, label: &'static str, numbers: usize) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            // No kernel can be given nothing.
            size: (numbers.max(4) * 4) as u64,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    }

    /// One for each need, in their order.
    pub(super) fn buffers<const N: usize>(&self, needs: &[Need]) -> [wgpu::Buffer; N] {
        std::array::from_fn(|index| {
            let (label, numbers) = needs.get(index).copied().unwrap_or(("nothing", 0));
            self.storage(label, numbers)
        })
    }

    /// A buffer that holds `values`.
    pub(super) fn upload<T: Pod>(&self, label: &'static str, values: &[T]) -> wgpu::Buffer {
        let buffer = self.storage(label, size_of_val(values).div_ceil(4));
        self.queue.write_buffer(&buffer, 0, bytemuck::cast_slice(values));
        buffer
    }

    /// What a kernel is told beside its buffers.
    pub(super) fn uniform<T: Pod>(&self, label: &'static str, value: &T) -> wgpu::Buffer {
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: size_of::<T>().next_multiple_of(16) as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.queue.write_buffer(&buffer, 0, bytemuck::bytes_of(value));
        buffer
    }
}
