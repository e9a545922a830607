//! Deep correlation on the device: drives `shaders/correlation.wgsl`.

use bytemuck::{Pod, Zeroable};

use super::device::Gpu;
use super::kernel::{Dispatch, Shader};
use super::plan::Need;
use crate::engine::ScaleSetup;
use crate::engine::view::{Lags, Region, Stage, View, boundary_of_lags, image_sizes};
use crate::pattern::Boundary;

/// As in the shader.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Plane {
    size: [u32; 2],
    region: [u32; 2],
    origin: [u32; 2],
    lags: [u32; 2],
    width: u32,
    channels: u32,
    real_channels: u32,
    periodic: u32,
    judged: u32,
    mean: f32,
    held: [u32; 2],
    column_factors: [u32; 12],
    row_factors: [u32; 12],
}

/// Two lines and the sums of a workgroup fill the 16 KiB that every device has.
pub(super) const LONGEST_LINE: usize = 1000;

/// The least length ≥ `n` whose factors are all small.
fn smooth_length(n: usize) -> usize {
    (n..).find(|&length| factors(length).iter().all(|&factor| factor <= 5)).unwrap_or(n)
}

/// Factors of a length, fours first: as few stages as possible, and none wider than its prime.
fn factors(length: usize) -> Vec<u32> {
    let mut rest = length;
    let mut factors = Vec::new();
    for factor in [4, 2, 3, 5] {
        while rest.is_multiple_of(factor) {
            factors.push(factor as u32);
            rest /= factor;
        }
    }
    let mut factor = 7;
    while rest > 1 {
        if rest.is_multiple_of(factor) {
            factors.push(factor as u32);
            rest /= factor;
        } else if factor * factor > rest {
            factor = rest;
        } else {
            factor += 2;
        }
    }
    factors
}

/// Rows and columns of the planes.
fn plane_size(region: Region, lags: Lags, boundary: Boundary) -> [usize; 2] {
    match boundary {
        // Room for the largest lag, so that nothing wraps around into it.
        Boundary::Open => {
            [smooth_length(region.height() + lags.rows / 2), smooth_length(region.width() + lags.columns / 2)]
        }
        Boundary::Periodic => [region.height(), region.width()],
    }
}

fn plane_of(view: &View, lags: Lags) -> [usize; 2] {
    plane_size(view.last_region(), lags, boundary_of_lags(view))
}

/// The longest line that this scale has to transform.
pub(super) fn longest_line(setup: &ScaleSetup) -> usize {
    [&setup.exemplar_view, &setup.output_view]
        .into_iter()
        .flat_map(|view| plane_of(view, setup.lags))
        .max()
        .unwrap_or(0)
}

/// Buffers of [`Correlation::new`].
pub(super) fn needs(view: &View, lags: Lags, channels: usize) -> Vec<Need> {
    let [rows, columns] = plane_of(view, lags);
    let pairs = channels.div_ceil(2);
    let planes = 2 * pairs * rows * columns;
    vec![
        ("lines of the correlation", planes),
        ("spectra of the correlation", planes),
        ("slopes of the correlation", planes),
        ("slopes of the correlation", planes),
        ("autocorrelations", channels * lags.count()),
        ("losses", pairs * lags.rows),
        ("roots of unity", 2 * (rows + columns)),
    ]
}

/// The autocorrelations of one layer.
#[derive(Debug)]
pub(super) struct Correlation {
    /// `[channels, lag rows, lag columns]`.
    pub(super) values: wgpu::Buffer,
    /// Loss of every pair of channels and row of lags.
    pub(super) losses: wgpu::Buffer,
    /// How many of them.
    pub(super) loss_count: usize,
    lines: wgpu::Buffer,
    spectra: wgpu::Buffer,
    slopes: wgpu::Buffer,
    slope_spectra: wgpu::Buffer,
    roots: wgpu::Buffer,
    /// For the activations, and for the slopes.
    planes: [wgpu::Buffer; 2],
    target: Option<wgpu::Buffer>,
    size: [usize; 2],
    region: Region,
    lags: Lags,
    pairs: usize,
    constants: [(&'static str, u32); 2],
}

impl Correlation {
    /// For the last layer seen through `view`; `real_channels` of the padded `channels` count.
    pub(super) fn new(
        gpu: &Gpu,
        view: &View,
        lags: Lags,
        (channels, real_channels): (usize, usize),
        weight: f64,
        target: Option<&wgpu::Buffer>,
    ) -> Self {
        let [lines, spectra, slopes, slope_spectra, values, losses, roots] =
            gpu.buffers(&needs(view, lags, real_channels));

        let [rows, columns] = plane_of(view, lags);
        let turns = |length: usize| {
            (0..length).map(move |k| {
                let angle = std::f64::consts::TAU * k as f64 / length as f64;
                [libm::cos(angle) as f32, -libm::sin(angle) as f32]
            })
        };
        let table: Vec<[f32; 2]> = turns(columns).chain(turns(rows)).collect();
        gpu.queue.write_buffer(&roots, 0, bytemuck::cast_slice(&table));

        let region = view.last_region();
        let width = image_sizes(view.grid.height, view.grid.width)[4].1;
        let listed = |length: usize| {
            let mut list = [0; 12];
            for (slot, factor) in list.iter_mut().zip(factors(length)) {
                *slot = factor;
            }
            list
        };
        let plane = |held: [usize; 2]| {
            gpu.uniform(
                "plane",
                &Plane {
                    size: [columns as u32, rows as u32],
                    region: [region.width() as u32, region.height() as u32],
                    origin: [region.x0 as u32, region.y0 as u32],
                    lags: [lags.columns as u32, lags.rows as u32],
                    width: width as u32,
                    channels: channels as u32,
                    real_channels: real_channels as u32,
                    periodic: u32::from(boundary_of_lags(view) == Boundary::Periodic),
                    judged: u32::from(target.is_some()),
                    mean: (weight / (real_channels * lags.count()) as f64) as f32,
                    held: held.map(|row| row as u32),
                    column_factors: listed(columns),
                    row_factors: listed(rows),
                },
            )
        };
        let before = lags.rows / 2;
        let pairs = real_channels.div_ceil(2);
        let length = rows.max(columns) as u32;
        Self {
            planes: [plane([region.height(), rows]), plane([lags.rows - before, rows - before])],
            values,
            losses,
            loss_count: pairs * lags.rows,
            lines,
            spectra,
            slopes,
            slope_spectra,
            roots,
            target: target.cloned(),
            size: [rows, columns],
            region,
            lags,
            pairs,
            constants: [("LENGTH", length), ("LINES", 2 * length)],
        }
    }

    fn dispatch(&self, gpu: &Gpu, entry: &'static str, bindings: &[(u32, &wgpu::Buffer)], lines: usize) -> Dispatch {
        let [rows, columns] = self.size;
        let work = (lines * self.pairs * rows.max(columns)) as f64 * 150.0;
        let kernel = gpu.kernel(Shader::Correlation, entry, &self.constants);
        Dispatch::new(gpu, &kernel, bindings, [lines, self.pairs, 1], Stage::Correlation, work)
    }

    /// Measures an image before normalisation, and the loss and its slopes where there is a target.
    pub(super) fn measure(&self, gpu: &Gpu, image: &wgpu::Buffer, moments: &wgpu::Buffer) -> [Dispatch; 4] {
        let columns = self.size[1];
        let [plane, _] = &self.planes;
        [
            self.dispatch(
                gpu,
                "rows_forward",
                &[(0, plane), (1, image), (2, moments), (3, &self.roots), (4, &self.lines)],
                self.region.height(),
            ),
            self.dispatch(
                gpu,
                "columns_forward",
                &[(0, plane), (3, &self.roots), (4, &self.lines), (5, &self.spectra)],
                columns,
            ),
            self.dispatch(
                gpu,
                "power_columns",
                &[(0, plane), (3, &self.roots), (4, &self.lines), (5, &self.spectra)],
                columns,
            ),
            self.dispatch(
                gpu,
                "power_rows",
                &[
                    (0, plane),
                    (3, &self.roots),
                    (4, &self.lines),
                    (6, &self.values),
                    (7, self.target.as_ref().unwrap_or(&self.slope_spectra)),
                    (8, &self.losses),
                    (9, &self.slopes),
                ],
                self.lags.rows,
            ),
        ]
    }

    /// Writes dL/dF into `gradient`, all pixels and real channels. The region must be the whole image.
    pub(super) fn backward(&self, gpu: &Gpu, gradient: &wgpu::Buffer) -> [Dispatch; 3] {
        let columns = self.size[1];
        let [plane, of_slopes] = &self.planes;
        [
            self.dispatch(
                gpu,
                "columns_forward",
                &[(0, of_slopes), (3, &self.roots), (4, &self.slopes), (5, &self.slope_spectra)],
                columns,
            ),
            self.dispatch(
                gpu,
                "gradient_columns",
                &[(0, plane), (3, &self.roots), (4, &self.lines), (5, &self.spectra), (9, &self.slope_spectra)],
                columns,
            ),
            self.dispatch(
                gpu,
                "gradient_rows",
                &[(0, plane), (3, &self.roots), (4, &self.lines), (10, gradient)],
                self.region.height(),
            ),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_factored_into_themselves() {
        for length in 1..=LONGEST_LINE {
            let factors = factors(length);
            assert_eq!(factors.iter().map(|&factor| factor as usize).product::<usize>(), length);
            assert!(factors.len() <= 12, "{length}: {factors:?}");
        }
        assert_eq!(factors(80), [4, 4, 5]);
        assert_eq!(smooth_length(97), 100);
    }
}
