//! A window that makes a tile: its statistics must be those of the pattern, not of the empty space around it.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::sync::Arc;

use glam::DVec2;
use pointweave::Boundary;
use pointweave::engine::cpu::network::{Evaluation, Network, best_tiles};
use pointweave::engine::view::{Grid, Lags, View, Wave};
use pointweave::engine::{FilterBank, Weights};
use pointweave::gallery;

const CHANNELS: usize = 8;
const PIXELS: usize = 64;

/// The Gram matrices of layers 2 to 4, one after the other.
fn grams(points: &[DVec2], boundary: Boundary, interior_only: bool) -> Vec<f64> {
    let weights = Weights::default();
    let bands = weights.bands();
    let view = View {
        grid: Grid { height: PIXELS, width: PIXELS, pitch: DVec2::splat(1.0 / PIXELS as f64), boundary },
        wave: Wave { sigma: 0.05, frequency: 1.5, scale: 1.0 / 30.0, cutoff_sigmas: 8.0 },
        interior_only,
    };
    let bank = FilterBank::for_bands(3, CHANNELS, bands);
    let tiles = best_tiles(CHANNELS, PIXELS, PIXELS, boundary, bands);
    let lags = Lags { rows: 6, columns: 6 };
    let network = Arc::new(Network::<f64>::new(&bank, tiles));
    let mut side = Evaluation::new(network, &view, points.len(), lags, false, [0.0; 2], &weights);
    while !side.advance(points, None) {}
    side.targets(lags).grams.concat()
}

#[test]
fn the_interior_of_a_window_is_nearer_to_the_tile_than_a_window_in_empty_space() {
    // Each repeats itself within the window; where a few shapes more or less are seen, that counts for more.
    for name in ["maze", "waves", "nested-grids"] {
        let points = gallery::find(name).unwrap().exemplar().positions_in_exemplar_units();
        let tile = grams(&points, Boundary::Periodic, false);
        let length = |list: &mut dyn Iterator<Item = f64>| list.map(|value| value * value).sum::<f64>().sqrt();
        let error = |interior_only| {
            let found = grams(&points, Boundary::Open, interior_only);
            length(&mut found.iter().zip(&tile).map(|(a, b)| a - b)) / length(&mut tile.iter().copied())
        };
        let (padded, interior) = (error(false), error(true));
        assert!(padded > 0.1, "{name}: nothing to put right in {padded}");
        assert!(interior < 0.7 * padded, "{name}: padded {padded}, interior {interior}");
    }
}
