//! What both engines see: the sampling grid, the shapes of the images on it, and which of their pixels count.

use glam::DVec2;

use crate::engine::filters::{LAYERS, STRIDES};
use crate::pattern::Boundary;

/// Layers whose Gram matrices count: all but the first.
pub const GRAM_LAYERS: usize = LAYERS - 1;

/// Pixels of the first layer's grid by which each layer sees past its own pixel: 3 for every kernel, at its stride.
const RECEPTIVE_REACH: [f64; LAYERS] = [3.0, 6.0, 9.0, 15.0];

/// The sampling grid: pixel centres `((x + ½) · pitch.x, (y + ½) · pitch.y)` in exemplar units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Rows.
    pub height: usize,
    /// Columns.
    pub width: usize,
    /// Size of a pixel in exemplar units.
    pub pitch: DVec2,
    /// Whether points are seen across the border.
    pub boundary: Boundary,
}

/// What the maps look like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// Width of the Gaussian in exemplar units.
    pub sigma: f64,
    /// Frequency f in cycles per exemplar unit.
    pub frequency: f64,
    /// Scale s of the maps; 1 / min(30, M) matches the paper's published code.
    pub scale: f64,
    /// How many σ a point reaches along each axis.
    pub cutoff_sigmas: f64,
}

/// Reach of a point in σ: what is cut off is below e⁻⁸ of the peak, an order below what 32-bit sums resolve here.
pub const CUTOFF_SIGMAS: f64 = 4.0;

/// Rows and columns of pixels that a point's window spans.
pub(crate) fn window(grid: &Grid, wave: &Wave) -> [usize; 2] {
    // One pixel more to either side for the jitter and for the point's place within its pixel.
    [grid.pitch.y, grid.pitch.x].map(|pitch| 2 * ((wave.cutoff_sigmas * wave.sigma / pitch).ceil() as usize + 1) + 1)
}

/// A rectangle of pixels: rows `y0 … y1`, columns `x0 … x1`, ends excluded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// First row.
    pub y0: usize,
    /// One past the last row.
    pub y1: usize,
    /// First column.
    pub x0: usize,
    /// One past the last column.
    pub x1: usize,
}

impl Region {
    /// All of an image.
    #[must_use]
    pub const fn whole(height: usize, width: usize) -> Self {
        Self { y0: 0, y1: height, x0: 0, x1: width }
    }

    /// Rows.
    #[must_use]
    pub const fn height(&self) -> usize {
        self.y1 - self.y0
    }

    /// Columns.
    #[must_use]
    pub const fn width(&self) -> usize {
        self.x1 - self.x0
    }

    /// Pixels.
    #[must_use]
    pub const fn pixels(&self) -> usize {
        self.height() * self.width()
    }
}

/// Central lags of an autocorrelation: rows and columns of lags, `−q/2 … q − q/2 − 1` each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lags {
    /// Vertical lags.
    pub rows: usize,
    /// Horizontal lags.
    pub columns: usize,
}

impl Lags {
    /// How many lags.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.rows * self.columns
    }
}

/// Shapes of the images of all layers: the input maps first, then each layer's output, as (height, width).
#[must_use]
pub fn image_sizes(height: usize, width: usize) -> [(usize, usize); LAYERS + 1] {
    let mut sizes = [(height, width); LAYERS + 1];
    for (layer, stride) in STRIDES.into_iter().enumerate() {
        let (h, w) = sizes[layer];
        sizes[layer + 1] = (h.div_ceil(stride), w.div_ceil(stride));
    }
    sizes
}

/// Operations of the four convolutions on a grid of so many columns and rows, done directly, forward and with respect
/// to the input.
pub(crate) fn direct_operations(grid: [f64; 2], channels: f64) -> f64 {
    let pairs = grid[0] * grid[1] * channels * (5.0 + channels + channels / 4.0 + channels / 16.0);
    2.0 * 2.0 * 49.0 * pairs
}

/// Where statistics of a pattern are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The sampling grid.
    pub grid: Grid,
    /// How the maps are made.
    pub wave: Wave,
    /// Leave out the border, where an open exemplar's features know that nothing lies beyond.
    pub interior_only: bool,
}

impl View {
    /// The pixels of each layer whose statistics count.
    pub(crate) fn regions(&self) -> [Region; LAYERS] {
        let sizes = image_sizes(self.grid.height, self.grid.width);
        std::array::from_fn(|layer| {
            let (height, width) = sizes[layer + 1];
            if !self.interior_only {
                return Region::whole(height, width);
            }
            let stride: usize = STRIDES[..=layer].iter().product();
            let margin = |pixels: usize, pitch: f64| {
                let wanted = (RECEPTIVE_REACH[layer] + self.wave.sigma / pitch) / stride as f64;
                // Filters of the last layers reach half across an exemplar. A margin of a tenth removes most of the
                // border's influence; a wider one leaves too little to measure (docs/findings/interior-statistics.md).
                (wanted.ceil() as usize).min(pixels / 10)
            };
            let (y, x) = (margin(height, self.grid.pitch.y), margin(width, self.grid.pitch.x));
            Region { y0: y, y1: height - y, x0: x, x1: width - x }
        })
    }

    /// Rows and columns of layer 4 whose statistics count.
    #[must_use]
    pub fn last_region(&self) -> Region {
        self.regions()[LAYERS - 1]
    }
}

/// Interiors are windows, whatever the border of the whole.
pub(crate) fn boundary_of_lags(view: &View) -> Boundary {
    if view.interior_only { Boundary::Open } else { view.grid.boundary }
}

/// A stage of the method, for timings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Stage {
    /// Gabor maps.
    Gabor,
    /// Convolutions, forward.
    Convolution,
    /// Instance normalisation, forward.
    Normalization,
    /// Gram matrices and loss.
    Gram,
    /// Deep correlation, loss and gradient.
    Correlation,
    /// Gradient of the Gram losses and through normalisation and ReLU.
    NormalizationGradient,
    /// Gradient through the convolutions.
    ConvolutionGradient,
    /// Gradient from the maps to the points.
    GaborGradient,
    /// Loss terms added up and points moved, where that is work of its own.
    Update,
}

impl Stage {
    /// All stages in their order.
    pub const ALL: [Self; 9] = [
        Self::Gabor,
        Self::Convolution,
        Self::Normalization,
        Self::Gram,
        Self::Correlation,
        Self::NormalizationGradient,
        Self::ConvolutionGradient,
        Self::GaborGradient,
        Self::Update,
    ];

    /// The name in benchmark output.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Gabor => "gabor",
            Self::Convolution => "convolution",
            Self::Normalization => "normalization",
            Self::Gram => "gram",
            Self::Correlation => "correlation",
            Self::NormalizationGradient => "normalization and gram gradient",
            Self::ConvolutionGradient => "convolution gradient",
            Self::GaborGradient => "gabor gradient",
            Self::Update => "update",
        }
    }
}
