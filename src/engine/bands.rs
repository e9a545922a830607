//! Which maps the first layer sees, and what every point weighs in them.
//!
//! The maps come in *bands*: sets in which each point has one weight. A pattern of plain points has one band, in which
//! every point weighs 1. Every attribute has a band of the nine frequencies (Huang et al. 2022, §4.5; every pair of map
//! and attribute), and classes that are to be told apart have a band of all ten maps each, in which the others weigh 0.
//! The paper's maps of a pattern with attributes are the bands of the attributes and the plain Gaussian; where classes
//! have bands of their own a single one has its ten maps, too: weighted by their size small points are hardly seen.

use super::filters::{DISTINCT_MAPS, PAPER_MAPS};

/// The maps in their order: the Gaussian alone, then bands of ten maps, then bands of nine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bands {
    /// Whether the first band is the plain Gaussian alone.
    pub lone: bool,
    /// Bands of the paper's ten maps: the Gaussian and nine frequencies.
    pub full: usize,
    /// Bands of the nine frequencies.
    pub waves: usize,
}

impl Default for Bands {
    fn default() -> Self {
        Self { lone: false, full: 1, waves: 0 }
    }
}

impl Bands {
    /// How many bands there are.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.lone as usize + self.full + self.waves
    }

    /// Distinct maps of all bands: of ten or nine five are, see [`super::filters::DISTINCT_OF_PAPER`].
    #[must_use]
    pub const fn maps(&self) -> usize {
        self.first(self.count())
    }

    /// The paper's maps of all bands.
    #[must_use]
    pub const fn paper_maps(&self) -> usize {
        self.lone as usize + PAPER_MAPS * self.full + (PAPER_MAPS - 1) * self.waves
    }

    /// The first map of a band.
    #[must_use]
    pub const fn first(&self, band: usize) -> usize {
        if self.lone && band > 0 { DISTINCT_MAPS * (band - 1) + 1 } else { DISTINCT_MAPS * band }
    }

    /// Whether a band is the Gaussian alone.
    #[must_use]
    pub const fn is_lone(&self, band: usize) -> bool {
        self.lone && band == 0
    }

    /// How many of the paper's maps a band holds.
    pub(super) const fn paper_maps_of(&self, band: usize) -> usize {
        if self.is_lone(band) {
            1
        } else if band < self.lone as usize + self.full {
            PAPER_MAPS
        } else {
            PAPER_MAPS - 1
        }
    }
}

/// What every point weighs in every band.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Weights {
    bands: Bands,
    values: Vec<f64>,
}

impl Weights {
    /// `values` is `[points, bands]`, row-major; what is missing weighs 1.
    #[must_use]
    pub fn new(bands: Bands, values: Vec<f64>) -> Self {
        Self { bands, values }
    }

    /// The bands.
    #[must_use]
    pub fn bands(&self) -> Bands {
        self.bands
    }

    /// The weights of `points` points, `[points, bands]`.
    pub fn values(&self, points: usize) -> impl Iterator<Item = f64> {
        let len = points * self.bands.count();
        self.values.iter().copied().chain(std::iter::repeat(1.0)).take(len)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pair_of_map_and_attribute() {
        let of = |lone, full, waves| Bands { lone, full, waves };
        for (bands, count, maps, paper) in [
            (Bands::default(), 1, 5, 10),
            (of(true, 0, 1), 2, 6, 10),
            (of(true, 0, 3), 4, 16, 28),
            (of(false, 2, 0), 2, 10, 20),
            (of(false, 16, 9), 25, 125, 241),
        ] {
            assert_eq!((bands.count(), bands.maps(), bands.paper_maps()), (count, maps, paper), "{bands:?}");
            assert_eq!((0..count).map(|band| bands.paper_maps_of(band)).sum::<usize>(), paper);
            assert!((1..count).all(|band| bands.first(band) > bands.first(band - 1)));
        }
    }
}
