//! The whole way from points to loss and back, on one grid, as a list of bounded steps.

use std::ops::Range;
use std::sync::Arc;

use glam::DVec2;

use crate::engine::LossTerms;
use crate::engine::filters::{FilterBank, LAYERS, STRIDES};
use crate::engine::view::{GRAM_LAYERS, Grid, Lags, Region, Stage, View, boundary_of_lags, image_sizes};
use crate::engine::{Bands, Weights};
use crate::pattern::Boundary;

use super::convolution::{Convolution, Direction, Filters, Geometry, Source, Tile, Workspace};
use super::correlation::Correlation;
use super::gabor::Gabor;
use super::gram::Gram;
use super::lanes::padded;
use super::normalization::Statistics;
use super::real::Real;
use crate::parallel::for_each_chunk;

/// Operations of one step at most, so that even one thread in a browser is back within about a tenth of a second.
const OPERATIONS_A_STEP: f64 = 1.5e9;

/// Shapes of the inputs of all convolutions on a grid of this size.
pub(crate) fn geometries(height: usize, width: usize, boundary: Boundary) -> [Geometry; LAYERS] {
    let sizes = image_sizes(height, width);
    std::array::from_fn(|layer| {
        let (height, width) = sizes[layer];
        Geometry { height, width, stride: STRIDES[layer], boundary }
    })
}

/// The filters of all layers, ready for images of about one size; shared by the exemplar's side and the output's.
#[derive(Debug)]
pub struct Network<T> {
    channels: usize,
    maps: usize,
    layers: Vec<Filters<T>>,
}

/// The tile of each layer that suits an output of this size.
#[must_use]
pub fn best_tiles(channels: usize, height: usize, width: usize, boundary: Boundary, bands: Bands) -> [Tile; LAYERS] {
    let geometries = geometries(height, width, boundary);
    std::array::from_fn(|layer| {
        let inputs = if layer == 0 { bands.maps() } else { channels };
        Tile::best(&geometries[layer], inputs, channels)
    })
}

impl<T: Real> Network<T> {
    /// Transforms the filters for these tiles.
    #[must_use]
    pub fn new(bank: &FilterBank, tiles: [Tile; LAYERS]) -> Self {
        let layers = (0..LAYERS)
            .map(|layer| Filters::new(&bank.layers[layer], bank.inputs(layer), bank.channels, tiles[layer]))
            .collect();
        Self { channels: bank.channels, maps: bank.inputs(0), layers }
    }

    /// Bytes that [`Self::new`] allocates.
    #[must_use]
    pub fn bytes_for(channels: usize, tiles: [Tile; LAYERS], bands: Bands) -> usize {
        let outputs = padded(channels);
        (0..LAYERS)
            .map(|layer| {
                let inputs = if layer == 0 { padded(bands.maps()) } else { outputs };
                tiles[layer].frequencies() * 2 * inputs * outputs * size_of::<T>()
            })
            .sum()
    }

    /// How many maps the first layer sees.
    #[must_use]
    pub fn maps(&self) -> usize {
        self.maps
    }

    /// The tile of each layer.
    #[must_use]
    pub fn tiles(&self) -> [Tile; LAYERS] {
        std::array::from_fn(|layer| self.layers[layer].tile())
    }
}

/// The exemplar's statistics at one scale.
#[derive(Clone, Debug, PartialEq)]
pub struct Targets<T> {
    /// Gram matrices of layers 2, 3 and 4, `[channels, channels]` with padded channels.
    pub grams: [Vec<f64>; GRAM_LAYERS],
    /// Autocorrelations of layer 4, `[channels, lag rows, lag columns]`.
    pub correlations: Vec<T>,
    /// Their lags.
    pub lags: Lags,
}

/// One bounded piece of work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    Maps,
    Transform(usize, Direction),
    Multiply(usize, Direction, usize, usize),
    Inverse(usize, Direction),
    Measure(usize),
    Gram(usize),
    Correlate,
    CorrelationLoss,
    CorrelationGradient,
    Normalize(usize),
    Points,
}

impl Step {
    fn stage(self) -> Stage {
        match self {
            Self::Maps => Stage::Gabor,
            Self::Transform(_, d) | Self::Multiply(_, d, _, _) | Self::Inverse(_, d) => match d {
                Direction::Forward => Stage::Convolution,
                Direction::Gradient => Stage::ConvolutionGradient,
            },
            Self::Measure(_) => Stage::Normalization,
            Self::Gram(_) => Stage::Gram,
            Self::Correlate | Self::CorrelationLoss | Self::CorrelationGradient => Stage::Correlation,
            Self::Normalize(_) => Stage::NormalizationGradient,
            Self::Points => Stage::GaborGradient,
        }
    }
}

/// The images of one side, and the program that fills them.
#[derive(Debug)]
pub struct Evaluation<T: Real> {
    network: Arc<Network<T>>,
    regions: [Region; LAYERS],
    sizes: [(usize, usize); LAYERS + 1],
    convolutions: Vec<Convolution>,
    gabor: Gabor<T>,
    /// Gabor maps `[height, width, maps]`, padded.
    maps: Vec<T>,
    /// Outputs of the convolutions, before normalisation.
    images: Vec<Vec<T>>,
    statistics: Vec<Statistics<T>>,
    grams: Vec<Gram<T>>,
    correlation: Correlation<T>,
    workspace: Workspace<T>,
    /// Gradient of the layer at hand; empty on the exemplar's side.
    gradient: Vec<T>,
    program: Vec<Step>,
    next: usize,
    loss: LossTerms,
    weights: [f64; 2],
}

fn workspace_layers(
    channels: usize,
    maps: usize,
    tiles: [Tile; LAYERS],
    geometries: &[Geometry; LAYERS],
) -> [(Geometry, Tile, usize, usize); LAYERS] {
    std::array::from_fn(|layer| {
        let inputs = if layer == 0 { maps } else { channels };
        (geometries[layer], tiles[layer], inputs, channels)
    })
}

impl<T: Real> Evaluation<T> {
    /// Space for `points` points seen through `view`; with a gradient, or only the statistics. `weights` are those of
    /// the Gram and of the correlation loss, `map_weights` those of the points; they must have the bands that the
    /// network was made for.
    #[must_use]
    pub fn new(
        network: Arc<Network<T>>,
        view: &View,
        points: usize,
        lags: Lags,
        with_gradient: bool,
        weights: [f64; 2],
        map_weights: &Weights,
    ) -> Self {
        let Grid { height, width, boundary, .. } = view.grid;
        let stored_maps = padded(map_weights.bands().maps());
        let channels = padded(network.channels);
        let sizes = image_sizes(height, width);
        let geometries = geometries(height, width, boundary);
        let convolutions: Vec<Convolution> =
            (0..LAYERS).map(|layer| Convolution::new(&network.layers[layer], geometries[layer])).collect();
        let pixels = |layer: usize| sizes[layer + 1].0 * sizes[layer + 1].1;
        let regions = view.regions();
        let program = program(&convolutions, with_gradient);
        Self {
            regions,
            gabor: Gabor::new(view.grid, view.wave, points, map_weights),
            maps: vec![T::ZERO; height * width * stored_maps],
            images: (0..LAYERS).map(|layer| vec![T::ZERO; pixels(layer) * channels]).collect(),
            statistics: (0..LAYERS).map(|layer| Statistics::new(sizes[layer + 1].0, channels)).collect(),
            grams: (0..GRAM_LAYERS).map(|_| Gram::new(channels, network.channels)).collect(),
            correlation: Correlation::new(regions[LAYERS - 1], lags, boundary_of_lags(view), network.channels),
            workspace: Workspace::new(&workspace_layers(network.channels, network.maps, network.tiles(), &geometries)),
            // It ends as the gradient of the maps, which have as many pixels as the first layer's image.
            gradient: if with_gradient { vec![T::ZERO; pixels(0) * channels.max(stored_maps)] } else { Vec::new() },
            network,
            sizes,
            convolutions,
            program,
            next: 0,
            loss: LossTerms::default(),
            weights,
        }
    }

    /// Bytes that [`Self::new`] allocates, to within a few lines.
    #[must_use]
    pub fn bytes_for(
        channels: usize,
        tiles: [Tile; LAYERS],
        view: &View,
        points: usize,
        lags: Lags,
        with_gradient: bool,
        bands: Bands,
    ) -> usize {
        let Grid { height, width, boundary, .. } = view.grid;
        let (sizes, outputs, maps) = (image_sizes(height, width), padded(channels), padded(bands.maps()));
        let images: usize = sizes[1..].iter().map(|(h, w)| h * w * outputs).sum();
        let gradient = if with_gradient { sizes[1].0 * sizes[1].1 * outputs.max(maps) } else { 0 };
        let geometries = geometries(height, width, boundary);
        (height * width * maps + images + gradient) * size_of::<T>()
            + Gabor::<T>::bytes_for(&view.grid, &view.wave, points, bands)
            + sizes[1..].iter().map(|&(h, _)| Statistics::<T>::bytes_for(h, outputs)).sum::<usize>()
            + GRAM_LAYERS * Gram::<T>::bytes_for(outputs)
            + Correlation::<T>::bytes_for(view.last_region(), lags, boundary_of_lags(view), channels)
            + Workspace::<T>::bytes_for(&workspace_layers(channels, bands.maps(), tiles, &geometries))
    }

    /// The stage the next step belongs to.
    #[must_use]
    pub fn stage(&self) -> Stage {
        self.program[self.next].stage()
    }

    /// Share of the program that is done, 0 to 1.
    #[must_use]
    pub fn done(&self) -> f64 {
        self.next as f64 / self.program.len() as f64
    }

    /// Shifts of rows and columns of the grid, in pixels; to be set before the first step.
    pub fn shifts_mut(&mut self) -> &mut [Vec<f64>; 2] {
        self.gabor.shifts_mut()
    }

    /// Does the next step for `points` (exemplar units), which must stay the same until the program is through.
    /// Returns whether it is. `targets` may only be missing on the exemplar's side.
    pub fn advance(&mut self, points: &[DVec2], targets: Option<&Targets<T>>) -> bool {
        let step = self.program[self.next];
        self.next += 1;
        match step {
            Step::Maps => self.gabor.maps(points, &mut self.maps),
            Step::Transform(layer, direction) => {
                let source = match (direction, layer) {
                    (Direction::Gradient, _) => Source::Plain(&self.gradient[..]),
                    (Direction::Forward, 0) => Source::Plain(&self.maps[..]),
                    (Direction::Forward, _) => Source::Activated {
                        image: &self.images[layer - 1],
                        mean: &self.statistics[layer - 1].mean,
                        inverse_deviation: &self.statistics[layer - 1].inverse_deviation,
                    },
                };
                self.convolutions[layer].transform(source, direction, &mut self.workspace);
            }
            Step::Multiply(layer, direction, first, end) => {
                let filters = &self.network.layers[layer];
                self.convolutions[layer].multiply(filters, direction, first..end, &mut self.workspace);
            }
            Step::Inverse(layer, direction) => {
                let out = if direction == Direction::Forward { &mut self.images[layer] } else { &mut self.gradient };
                self.convolutions[layer].inverse(direction, &self.workspace, out);
            }
            Step::Measure(layer) => {
                let width = self.sizes[layer + 1].1;
                self.statistics[layer].measure(&self.images[layer], width, self.regions[layer]);
            }
            Step::Gram(layer) => {
                let region = self.regions[layer];
                let gram = &mut self.grams[layer - 1];
                gram.measure(&self.images[layer], self.sizes[layer + 1].1, region, &self.statistics[layer]);
                if let Some(targets) = targets {
                    self.loss.gram[layer - 1] = gram.loss(&targets.grams[layer - 1], self.weights[0], region.pixels());
                }
            }
            Step::Correlate => {
                let last = LAYERS - 1;
                self.correlation.measure(&self.images[last], self.sizes[LAYERS].1, &self.statistics[last]);
            }
            Step::CorrelationLoss => {
                if let Some(targets) = targets {
                    self.loss.correlation = self.correlation.loss(&targets.correlations, self.weights[1]);
                }
            }
            Step::CorrelationGradient => {
                let len = self.images[LAYERS - 1].len();
                let gradient = &mut self.gradient[..len];
                for_each_chunk(gradient, 1 << 14, |_, chunk| chunk.fill(T::ZERO));
                self.correlation.add_gradient(gradient, padded(self.network.channels));
            }
            Step::Normalize(layer) => {
                let len = self.images[layer].len();
                let width = self.sizes[layer + 1].1;
                // The first layer has no Gram loss.
                let gram = layer.checked_sub(1).map(|gram| &self.grams[gram]);
                self.statistics[layer].backward(&self.images[layer], &mut self.gradient[..len], width, gram);
            }
            Step::Points => {}
        }
        let through = self.next == self.program.len();
        if through {
            self.next = 0;
        }
        through
    }

    /// Forgets the steps taken since the last complete pass.
    pub fn restart(&mut self) {
        self.next = 0;
    }

    /// The loss of the last complete pass.
    #[must_use]
    pub fn loss(&self) -> LossTerms {
        self.loss
    }

    /// Gradient with respect to every point of `first …`, after a complete pass.
    pub fn point_gradients(&mut self, first: usize) -> &[[f64; 2]] {
        self.gabor.gradients(&self.gradient[..self.maps.len()], first)
    }

    /// The statistics of the last complete pass, as targets for another side.
    #[must_use]
    pub fn targets(&self, lags: Lags) -> Targets<T> {
        Targets {
            grams: std::array::from_fn(|layer| self.grams[layer].matrix().to_vec()),
            correlations: self.correlation.values().to_vec(),
            lags,
        }
    }

    /// The gradient as the steps so far have left it: with respect to the image at hand.
    #[must_use]
    pub fn gradient(&self) -> &[T] {
        &self.gradient
    }

    /// Channels of every layer, without padding.
    #[must_use]
    pub fn channels(&self) -> usize {
        self.network.channels
    }

    /// The Gram matrix of layer `gram + 2` of the last pass, `[channels, channels]` with padded channels.
    #[must_use]
    pub fn gram(&self, gram: usize) -> &[f64] {
        self.grams[gram].matrix()
    }

    /// The autocorrelations of the last pass, `[channels, lag rows, lag columns]`.
    #[must_use]
    pub fn correlations(&self) -> &[T] {
        self.correlation.values()
    }

    /// The Gabor maps of the last pass, `[height, width, maps]`, padded.
    #[must_use]
    pub fn maps(&self) -> &[T] {
        &self.maps
    }

    /// A convolution's output of the last pass before normalisation, `[height, width, channels]` with padded
    /// channels, and its statistics.
    #[must_use]
    pub fn image(&self, layer: usize) -> (&[T], &Statistics<T>) {
        (&self.images[layer], &self.statistics[layer])
    }
}

/// The steps of one pass.
fn program(convolutions: &[Convolution], with_gradient: bool) -> Vec<Step> {
    let mut steps = vec![Step::Maps];
    let convolve = |steps: &mut Vec<Step>, layer: usize, direction: Direction| {
        let convolution = &convolutions[layer];
        steps.push(Step::Transform(layer, direction));
        for Range { start, end } in parts(convolution.frequency_rows(), convolution.operations()) {
            steps.push(Step::Multiply(layer, direction, start, end));
        }
        steps.push(Step::Inverse(layer, direction));
    };
    for layer in 0..LAYERS {
        convolve(&mut steps, layer, Direction::Forward);
        steps.push(Step::Measure(layer));
        if layer > 0 {
            steps.push(Step::Gram(layer));
        }
    }
    steps.push(Step::Correlate);
    if with_gradient {
        steps.push(Step::CorrelationLoss);
        steps.push(Step::CorrelationGradient);
        for layer in (0..LAYERS).rev() {
            steps.push(Step::Normalize(layer));
            convolve(&mut steps, layer, Direction::Gradient);
        }
        steps.push(Step::Points);
    }
    steps
}

/// Cuts `count` items that take `operations` in all into runs of a bounded size.
fn parts(count: usize, operations: f64) -> impl Iterator<Item = Range<usize>> {
    let pieces = (operations / OPERATIONS_A_STEP).ceil().max(1.0) as usize;
    let len = count.div_ceil(pieces);
    (0..count).step_by(len).map(move |start| start..(start + len).min(count))
}
