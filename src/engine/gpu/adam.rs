//! The loss added up and the step of Adam on the device: drives `shaders/loss.wgsl` and `shaders/adam.wgsl`.

use bytemuck::{Pod, Zeroable};

use super::correlation::Correlation;
use super::device::Gpu;
use super::gram::Gram;
use super::kernel::{Dispatch, Shader};
use super::network::Io;
use crate::engine::ScaleSetup;
use crate::engine::view::Stage;
use crate::pattern::Boundary;

/// As in `loss.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Counts {
    gram: u32,
    correlation: u32,
}

/// The losses of all terms, added up.
#[derive(Debug)]
pub(super) struct Loss(Dispatch);

impl Loss {
    pub(super) fn new(gpu: &Gpu, grams: [&Gram; 3], channels: usize, correlation: &Correlation, io: &Io) -> Self {
        let counts = Counts { gram: (channels * channels) as u32, correlation: correlation.loss_count as u32 };
        let bindings = [
            (0, &gpu.uniform("counts", &counts)),
            (1, &io.progress),
            (2, &grams[0].losses),
            (3, &grams[1].losses),
            (4, &grams[2].losses),
            (5, &correlation.losses),
            (6, &io.losses),
        ];
        let kernel = gpu.kernel(Shader::Loss, "add_up", &[]);
        let cost = 8.0 * (3 * channels * channels + correlation.loss_count) as f64;
        Self(Dispatch::new(gpu, &kernel, &bindings, [1, 1, 1], Stage::Update, cost))
    }

    pub(super) fn into_dispatch(self) -> Dispatch {
        self.0
    }
}

/// As in `adam.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Rule {
    size: [f32; 2],
    learning_rate: f32,
    periodic: u32,
    moving: u32,
    first: u32,
}

/// The step of the optimiser.
#[derive(Debug)]
pub(super) struct Adam {
    rule: wgpu::Buffer,
    moving: usize,
}

impl Adam {
    /// For so many moving points, of which the first has this index.
    pub(super) fn new(gpu: &Gpu, setup: &ScaleSetup, [moving, first]: [usize; 2]) -> Self {
        let rule = Rule {
            size: setup.output_size.as_vec2().into(),
            learning_rate: setup.learning_rate as f32,
            periodic: u32::from(setup.output_view.grid.boundary == Boundary::Periodic),
            moving: moving as u32,
            first: first as u32,
        };
        Self { rule: gpu.uniform("rule", &rule), moving }
    }

    /// Checks that all is finite, moves the points, and goes on to the next iteration.
    pub(super) fn step(&self, gpu: &Gpu, io: &Io) -> [Dispatch; 3] {
        let kernel = |entry| gpu.kernel(Shader::Adam, entry, &[]);
        let rule = (0, &self.rule);
        let progress = (1, &io.progress);
        let cost = 8.0 * 20.0 * self.moving as f64;
        [
            Dispatch::new(
                gpu,
                &kernel("check"),
                &[rule, progress, (2, &io.losses), (3, &io.gradients), (4, &io.points)],
                [1, 1, 1],
                Stage::Update,
                cost,
            ),
            Dispatch::new(
                gpu,
                &kernel("move_points"),
                &[rule, progress, (3, &io.gradients), (4, &io.points), (5, &io.moments), (6, &io.corrections)],
                [self.moving.div_ceil(64), 1, 1],
                Stage::Update,
                cost,
            ),
            Dispatch::new(gpu, &kernel("next"), &[progress], [1, 1, 1], Stage::Update, 1.0),
        ]
    }
}
