//! What a run allocates on the device, worked out before anything is.

use super::device::GpuError;
use crate::engine::Bands;
use crate::engine::ScaleSetup;
use crate::engine::cpu::convolution::{Geometry, Tile};
use crate::engine::cpu::lanes::padded;
use crate::engine::cpu::network::geometries;
use crate::engine::filters::LAYERS;
use crate::engine::view::View;

use super::{correlation, gabor, gram, network, normalization};

/// The only side of tiles on the GPU: 16.
pub(super) const TILE: Tile = Tile::Small;

/// What a device and a person allow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Allowance {
    /// Most bytes of one buffer.
    pub buffer: u64,
    /// Most bytes of all buffers.
    pub total: u64,
    /// Most tiles of an image transformed in one pass.
    pub tiles: usize,
}

/// One buffer: what is in it, and how many 32-bit numbers.
pub(super) type Need = (&'static str, usize);

/// How a scale is cut to fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Plan {
    /// Numbers that each of the two buffers of spectra holds.
    pub(super) spectra: usize,
    /// Bytes of everything.
    pub(super) total: u64,
}

/// Numbers of the spectrum of one tile.
pub(super) fn spectrum_len(channels: usize) -> usize {
    TILE.frequencies() * 2 * channels
}

/// Most numbers in one buffer of spectra. More only pays while everything fits a cache, which it never does.
const SPECTRA_CAP: usize = 32 << 20;

impl Plan {
    /// Fits a scale into what is allowed: large images go through the transforms in several passes.
    pub(super) fn new(
        setup: &ScaleSetup,
        channels: usize,
        points: usize,
        allowed: Allowance,
    ) -> Result<Self, GpuError> {
        let bands = setup.exemplar_weights.bands();
        let outputs = padded(channels);
        let widest = outputs.max(padded(bands.maps()));
        let longest = |view: &View| {
            let grid = view.grid;
            let tiles = |geometry: &Geometry| geometry.tiles(TILE);
            geometries(grid.height, grid.width, grid.boundary).iter().map(tiles).max().unwrap_or(0)
        };
        let tiles = longest(&setup.output_view).max(longest(&setup.exemplar_view));
        let one = spectrum_len(widest);
        let cap = SPECTRA_CAP.min((allowed.buffer / 4) as usize);
        let spectra = (tiles.min(allowed.tiles) * one).min(cap.max(one));

        let side = |view: &View, points: usize, with_gradient: bool| {
            let mut needs = gabor::needs(view, points, bands);
            needs.extend(normalization::needs(view, outputs));
            needs.extend(gram::needs(view, outputs));
            needs.extend(correlation::needs(view, setup.lags, channels));
            needs.extend(network::needs(view, [outputs, widest], points, with_gradient));
            needs
        };
        let mut shared: Vec<Need> = vec![("spectra", spectra), ("spectra", spectra)];
        shared.extend(filter_needs(channels, bands));
        let (exemplar, output) =
            (side(&setup.exemplar_view, setup.exemplar.len(), false), side(&setup.output_view, points, true));
        for &(what, numbers) in shared.iter().chain(&exemplar).chain(&output) {
            let bytes = numbers as u64 * 4;
            if bytes > allowed.buffer {
                let (needed_mb, limit_mb) = (bytes.div_ceil(1_000_000), allowed.buffer / 1_000_000);
                return Err(GpuError::TooLarge { what, needed_mb, limit_mb });
            }
        }
        if correlation::longest_line(setup) > correlation::LONGEST_LINE {
            let mb = |lines: usize| (lines * 16) as u64;
            return Err(GpuError::TooLarge {
                what: "lines of the correlation",
                needed_mb: mb(correlation::longest_line(setup)),
                limit_mb: mb(correlation::LONGEST_LINE),
            });
        }
        let sum = |needs: &[Need]| needs.iter().map(|&(_, numbers)| numbers as u64 * 4).sum::<u64>();
        // The exemplar's buffers are given back before the output's are allocated, but no one says when.
        let total = sum(&shared) + sum(&exemplar) + sum(&output);
        if total > allowed.total {
            return Err(GpuError::Memory { needed_mb: total.div_ceil(1_000_000), limit_mb: allowed.total / 1_000_000 });
        }
        Ok(Self { spectra, total })
    }
}

/// The filters of all layers, both ways.
fn filter_needs(channels: usize, bands: Bands) -> Vec<Need> {
    let outputs = padded(channels);
    (0..LAYERS)
        .flat_map(|layer| {
            let inputs = if layer == 0 { padded(bands.maps()) } else { outputs };
            let numbers = TILE.frequencies() * 2 * inputs * outputs;
            [("filters", numbers), ("filters", numbers)]
        })
        .collect()
}
