//! The whole way from points to loss and back on the device, as a list of dispatches.

use std::sync::Arc;

use super::adam::{Adam, Loss};
use super::convolution::{DeviceFilters, Workspace, convolve};
use super::correlation::Correlation;
use super::device::Gpu;
use super::gabor::{Gabor, jitter_len};
use super::gram::Gram;
use super::kernel::Dispatch;
use super::normalization::Normalization;
use super::plan::{Need, Plan};
use crate::engine::ScaleSetup;
use crate::engine::cpu::convolution::Direction;
use crate::engine::cpu::lanes::padded;
use crate::engine::cpu::network::geometries;
use crate::engine::filters::LAYERS;
use crate::engine::view::{GRAM_LAYERS, View, image_sizes};
use crate::engine::{Bands, FilterBank};

/// Most iterations between two looks at the results: convergence is tested every ten.
pub(super) const LONGEST_BATCH: usize = 10;

/// The filters of all layers on the device, and the buffers that every layer's convolution works in.
#[derive(Debug)]
pub struct GpuNetwork {
    gpu: Arc<Gpu>,
    channels: usize,
    seed: u64,
    bands: Bands,
    layers: Vec<DeviceFilters>,
    spectra: [wgpu::Buffer; 2],
    numbers: usize,
}

impl GpuNetwork {
    /// The filters for a scale, taking those of an earlier one if they fit.
    pub(super) fn new(
        gpu: &Arc<Gpu>,
        setup: &ScaleSetup,
        channels: usize,
        plan: &Plan,
        before: Option<Arc<Self>>,
    ) -> Arc<Self> {
        let (seed, bands) = (setup.seed, setup.exemplar_weights.bands());
        if let Some(before) = before
            && Arc::ptr_eq(&before.gpu, gpu)
            && (before.channels, before.seed, before.bands) == (channels, seed, bands)
            && before.numbers >= plan.spectra
        {
            return before;
        }
        let bank = FilterBank::for_bands(seed, channels, bands);
        let layers = (0..LAYERS)
            .map(|layer| DeviceFilters::new(gpu, &bank.layers[layer], bank.inputs(layer), channels))
            .collect();
        let spectra = ["spectra", "products"].map(|label| gpu.storage(label, plan.spectra));
        Arc::new(Self { gpu: Arc::clone(gpu), channels, seed, bands, layers, spectra, numbers: plan.spectra })
    }

    fn workspace(&self) -> Workspace<'_> {
        let [spectra, products] = &self.spectra;
        Workspace { spectra, products, numbers: self.numbers }
    }
}

/// The exemplar's statistics at one scale, on the device.
#[derive(Clone, Debug)]
pub(super) struct Targets {
    /// Gram matrices of layers 2, 3 and 4.
    pub(super) grams: [wgpu::Buffer; GRAM_LAYERS],
    /// Autocorrelations of layer 4.
    pub(super) correlations: wgpu::Buffer,
}

/// What goes in and comes out.
#[derive(Clone, Debug)]
pub(super) struct Io {
    /// Positions in exemplar units, frozen points first.
    pub(super) points: wgpu::Buffer,
    /// Iteration of the batch, and whether a number stopped being finite.
    pub(super) progress: wgpu::Buffer,
    /// Jitter of rows and columns, for every iteration of a batch.
    pub(super) shifts: wgpu::Buffer,
    /// Gradient of the moving points.
    pub(super) gradients: wgpu::Buffer,
    /// Adam's moments of the moving points.
    pub(super) moments: wgpu::Buffer,
    /// Adam's corrections, for every iteration of a batch.
    pub(super) corrections: wgpu::Buffer,
    /// Loss terms, for every iteration of a batch.
    pub(super) losses: wgpu::Buffer,
}

/// Buffers of [`Io`] and of the images in [`Evaluation::new`]: of `channels`, and the gradient's of `widest`, for it
/// ends as the gradient of the maps.
pub(super) fn needs(view: &View, [channels, widest]: [usize; 2], points: usize, with_gradient: bool) -> Vec<Need> {
    let sizes = image_sizes(view.grid.height, view.grid.width);
    let mut needs = vec![
        ("points", 2 * points),
        ("progress", 4),
        ("jitter", LONGEST_BATCH * jitter_len(view)),
        ("gradients of points", 2 * points),
        ("moments of points", 4 * points),
        ("corrections", 2 * LONGEST_BATCH),
        ("losses", 4 * LONGEST_BATCH),
    ];
    needs.extend(sizes[1..].iter().map(|(height, width)| ("images", height * width * channels)));
    if with_gradient {
        let image = sizes[1].0 * sizes[1].1 * widest;
        needs.extend([("gradient of an image", image), ("gradient of an image", image)]);
    }
    needs
}

impl Io {
    /// Room for `points` points on the grid of `view`, no jitter.
    pub(super) fn new(gpu: &Gpu, view: &View, points: usize) -> Self {
        let [points, progress, shifts, gradients, moments, corrections, losses] =
            gpu.buffers(&needs(view, [0; 2], points, false));
        Self { points, progress, shifts, gradients, moments, corrections, losses }
    }
}

/// The images of one side, and the program that fills them.
#[derive(Debug)]
pub(super) struct Evaluation {
    /// Everything of one pass, in order.
    pub(super) program: Vec<Dispatch>,
    /// Where the program stands after the gradient of the loss with respect to each image before normalisation, last
    /// layer first, and with respect to the maps: number of dispatches, and the buffer that holds the gradient then.
    pub(super) checkpoints: Vec<(usize, wgpu::Buffer)>,
    pub(super) gabor: Gabor,
    pub(super) images: Vec<wgpu::Buffer>,
    pub(super) normalizations: Vec<Normalization>,
    pub(super) grams: Vec<Gram>,
    pub(super) correlation: Correlation,
}

impl Evaluation {
    /// For `points` points seen through `view`. With `targets` the program ends with a step of Adam on the points
    /// from `first` on; without, it only measures.
    pub(super) fn new(
        gpu: &Gpu,
        network: &GpuNetwork,
        setup: &ScaleSetup,
        view: &View,
        [points, first]: [usize; 2],
        io: &Io,
        targets: Option<&Targets>,
    ) -> Self {
        let real_channels = network.channels;
        let channels = padded(real_channels);
        let grid = view.grid;
        let sizes = image_sizes(grid.height, grid.width);
        let geometries = geometries(grid.height, grid.width, grid.boundary);
        let regions = view.regions();
        let [gram_weight, correlation_weight] = setup.weights;

        let weights = if targets.is_some() { &setup.output_weights } else { &setup.exemplar_weights };
        let mut gabor = Gabor::new(gpu, view, setup.margin, [points, first], weights, io);
        let images: Vec<wgpu::Buffer> =
            sizes[1..].iter().map(|(height, width)| gpu.storage("images", height * width * channels)).collect();
        let normalizations: Vec<Normalization> =
            (0..LAYERS).map(|layer| Normalization::new(gpu, sizes[layer + 1], regions[layer], channels)).collect();
        let grams: Vec<Gram> = (0..GRAM_LAYERS)
            .map(|gram| {
                let target = targets.map(|targets| &targets.grams[gram]);
                let place = (sizes[gram + 2].1, regions[gram + 1]);
                Gram::new(gpu, place, (channels, real_channels), gram_weight, target)
            })
            .collect();
        let target = targets.map(|targets| &targets.correlations);
        let correlation =
            Correlation::new(gpu, view, setup.lags, (channels, real_channels), correlation_weight, target);

        let mut program = gabor.forward();
        for layer in 0..LAYERS {
            let source = match layer.checked_sub(1) {
                None => (&gabor.maps, None),
                Some(before) => (&images[before], Some(&normalizations[before].moments)),
            };
            let (filters, image) = (&network.layers[layer], &images[layer]);
            let workspace = network.workspace();
            program.extend(convolve(gpu, filters, geometries[layer], Direction::Forward, source, image, workspace));
            program.extend(normalizations[layer].measure(gpu, image));
            if let Some(gram) = layer.checked_sub(1) {
                program.extend(grams[gram].measure(gpu, image, &normalizations[layer].moments));
            }
        }
        let last = LAYERS - 1;
        program.extend(correlation.measure(gpu, &images[last], &normalizations[last].moments));

        let mut checkpoints = Vec::new();
        if targets.is_some() {
            let image_len = sizes[1].0 * sizes[1].1 * channels.max(padded(network.bands.maps()));
            let mut gradients = ["gradient of an image"; 2].map(|label| gpu.storage(label, image_len));
            program.extend(correlation.backward(gpu, &gradients[0]));
            for layer in (0..LAYERS).rev() {
                let [gradient, next] = &gradients;
                let (image, normalization) = (&images[layer], &normalizations[layer]);
                // The first layer has no Gram loss.
                if let Some(gram) = layer.checked_sub(1) {
                    program.push(grams[gram].add_gradient(gpu, image, &normalization.moments, gradient));
                }
                program.extend(normalization.backward(gpu, image, gradient));
                checkpoints.push((program.len(), gradient.clone()));
                let (filters, workspace) = (&network.layers[layer], network.workspace());
                let source = (gradient, None);
                program.extend(convolve(gpu, filters, geometries[layer], Direction::Gradient, source, next, workspace));
                gradients.reverse();
            }
            checkpoints.push((program.len(), gradients[0].clone()));
            program.push(gabor.backward(gpu, &gradients[0], &io.gradients));
            let moving = [points - first, first];
            let grams = [&grams[0], &grams[1], &grams[2]];
            program.push(Loss::new(gpu, grams, channels, &correlation, io).into_dispatch());
            program.extend(Adam::new(gpu, setup, moving).step(gpu, io));
        }
        Self { program, checkpoints, gabor, images, normalizations, grams, correlation }
    }

    /// The statistics, as targets for another side.
    pub(super) fn targets(&self) -> Targets {
        Targets {
            grams: std::array::from_fn(|gram| self.grams[gram].matrix.clone()),
            correlations: self.correlation.values.clone(),
        }
    }
}
