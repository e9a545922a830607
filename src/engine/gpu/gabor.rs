//! Gabor maps on the device: drives `shaders/gabor.wgsl`.

use bytemuck::{Pod, Zeroable};

use super::device::Gpu;
use super::kernel::{Dispatch, Shader, folded};
use super::network::Io;
use super::plan::Need;
use crate::engine::cpu::lanes::padded;
use crate::engine::view::{Stage, View, window};
use crate::engine::{Bands, Weights};
use crate::pattern::Boundary;

/// As in the shader.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Frame {
    grid: [u32; 2],
    span: [u32; 2],
    pitch: [f32; 2],
    cell: [f32; 2],
    cells: [u32; 2],
    points: u32,
    first: u32,
    margin: f32,
    inverse_sigma: f32,
    frequency: f32,
    scale: f32,
    periodic: u32,
    jitter: u32,
    bands: u32,
    stored: u32,
    lone: u32,
}

/// Columns and rows of cells: each at least as large as a point's reach, which is half its window and a pixel.
fn cells(view: &View) -> [usize; 2] {
    let [rows, columns] = window(&view.grid, &view.wave);
    [(view.grid.width, columns), (view.grid.height, rows)].map(|(pixels, span)| (pixels / (span / 2 + 2)).max(1))
}

/// Numbers of jitter an iteration: one for each row and column.
pub(super) fn jitter_len(view: &View) -> usize {
    view.grid.height + view.grid.width
}

/// Buffers of [`Gabor::new`].
pub(super) fn needs(view: &View, points: usize, bands: Bands) -> Vec<Need> {
    let [rows, columns] = window(&view.grid, &view.wave);
    let [across, down] = cells(view);
    let places = points * (rows + columns);
    vec![
        ("windows", 2 * points),
        ("tables", 4 * places),
        ("slopes of tables", 2 * places),
        ("cells of points", points),
        ("cells", across * down + 1),
        ("sorted points", points),
        ("Gabor maps", view.grid.height * view.grid.width * padded(bands.maps())),
        ("weights of points", points * bands.count()),
    ]
}

/// Maps and gradients on one grid.
#[derive(Debug)]
pub(super) struct Gabor {
    /// `[height, width, maps]`, padded.
    pub(super) maps: wgpu::Buffer,
    frame: wgpu::Buffer,
    starts: wgpu::Buffer,
    tables: wgpu::Buffer,
    slopes: wgpu::Buffer,
    weights: wgpu::Buffer,
    /// Work of gathering the gradient of one point.
    gathering: usize,
    moving: usize,
    forward: Vec<Dispatch>,
}

impl Gabor {
    /// For `points` points of which those from `first` on move, and their weights; `margin` is how far the grid
    /// reaches beyond the domain, in exemplar units.
    pub(super) fn new(
        gpu: &Gpu,
        view: &View,
        margin: f64,
        [points, first]: [usize; 2],
        weights: &Weights,
        io: &Io,
    ) -> Self {
        let bands = weights.bands();
        let values: Vec<f32> = weights.values(points).map(|weight| weight as f32).collect();
        let [starts, tables, slopes, cell_of, cell_starts, order, maps, weights] =
            gpu.buffers(&needs(view, points, bands));
        gpu.queue.write_buffer(&weights, 0, bytemuck::cast_slice(&values));

        let (grid, wave) = (view.grid, view.wave);
        let [rows, columns] = window(&grid, &wave);
        let [across, down] = cells(view);
        let frame = gpu.uniform(
            "frame",
            &Frame {
                grid: [grid.width as u32, grid.height as u32],
                span: [columns as u32, rows as u32],
                pitch: grid.pitch.as_vec2().into(),
                cell: [grid.width as f32 / across as f32, grid.height as f32 / down as f32],
                cells: [across as u32, down as u32],
                points: points as u32,
                first: first as u32,
                margin: margin as f32,
                inverse_sigma: (1.0 / wave.sigma) as f32,
                frequency: wave.frequency as f32,
                scale: wave.scale as f32,
                periodic: u32::from(grid.boundary == Boundary::Periodic),
                jitter: jitter_len(view) as u32,
                bands: bands.count() as u32,
                stored: padded(bands.maps()) as u32,
                lone: bands.lone.into(),
            },
        );
        let kernel = |entry| gpu.kernel(Shader::Gabor, entry, &[]);
        let places = (points * (rows + columns)) as f64;
        let pixels = grid.height * grid.width;
        // A pixel asks the points of nine cells, or of all there are.
        let asked = points as f64 * (9.0 / (across * down) as f64).min(1.0);
        let forward = vec![
            Dispatch::new(
                gpu,
                &kernel("tabulate"),
                &[
                    (0, &frame),
                    (1, &io.points),
                    (2, &io.progress),
                    (3, &io.shifts),
                    (4, &starts),
                    (5, &tables),
                    (6, &slopes),
                    (7, &cell_of),
                ],
                [(rows + columns).div_ceil(64), points, 1],
                Stage::Gabor,
                120.0 * places,
            ),
            Dispatch::new(
                gpu,
                &kernel("sort"),
                &[(0, &frame), (7, &cell_of), (8, &cell_starts), (9, &order)],
                folded(across * down, 64),
                Stage::Gabor,
                8.0 * (across * down * points) as f64,
            ),
            Dispatch::new(
                gpu,
                &kernel("sum_maps"),
                &[(0, &frame), (4, &starts), (5, &tables), (8, &cell_starts), (9, &order), (10, &maps), (12, &weights)],
                [grid.width.div_ceil(8), grid.height.div_ceil(8), bands.count()],
                Stage::Gabor,
                (pixels * bands.count()) as f64 * 20.0 * asked,
            ),
        ];
        // Every further band adds its gradient to the first one's.
        let gathering = rows * columns * (50 + 10 * bands.count());
        Self { maps, frame, starts, tables, slopes, weights, gathering, moving: points - first, forward }
    }

    /// Points to maps.
    pub(super) fn forward(&mut self) -> Vec<Dispatch> {
        std::mem::take(&mut self.forward)
    }

    /// Gradient of the maps, `[height, width, maps]`, to that of the moving points.
    pub(super) fn backward(&self, gpu: &Gpu, map_gradient: &wgpu::Buffer, gradients: &wgpu::Buffer) -> Dispatch {
        Dispatch::new(
            gpu,
            &gpu.kernel(Shader::Gabor, "gather_gradients", &[]),
            &[
                (0, &self.frame),
                (4, &self.starts),
                (5, &self.tables),
                (6, &self.slopes),
                (10, map_gradient),
                (11, gradients),
                (12, &self.weights),
            ],
            [self.moving, 1, 1],
            Stage::GaborGradient,
            (self.moving * self.gathering) as f64,
        )
    }
}
