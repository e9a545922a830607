//! The random filter bank: drawn once per run from the seed, never trained.

use super::bands::Bands;
use crate::sampling::{Purpose, Rng};

/// Convolutions of the network.
pub const LAYERS: usize = 4;
/// Stride of each convolution.
pub const STRIDES: [usize; LAYERS] = [1, 1, 2, 2];
/// Side of a kernel.
pub const KERNEL: usize = 7;
/// Maps the paper feeds to the first convolution: the plain Gaussian and nine frequencies.
pub const PAPER_MAPS: usize = 10;
/// Distinct maps among them.
pub const DISTINCT_MAPS: usize = 5;

/// Which distinct map each of the paper's ten is. First the plain Gaussian, then the frequencies {−f, 0, f}², the
/// vertical one outside. The cosine is even and cos 0 = 1: ν and −ν coincide, and ν = 0 is the Gaussian again.
///
/// Distinct maps: 0 Gaussian, 1 ν = (0, f), 2 ν = (f, 0), 3 ν = (f, f), 4 ν = (f, −f).
pub const DISTINCT_OF_PAPER: [usize; PAPER_MAPS] = [0, 3, 1, 4, 2, 0, 2, 4, 1, 3];

/// Weights of four 7 × 7 convolutions without biases (instance normalisation would remove them), Glorot-uniform:
/// U(−a, a) with a = √(6 / ((c_in + c_out) · 49)) (Huang et al. 2022, §4.2; Glorot & Bengio 2010).
#[derive(Clone, Debug, PartialEq)]
pub struct FilterBank {
    /// Output channels of every layer.
    pub channels: usize,
    /// Weights of each layer, `[channels out, channels in, 7, 7]` row-major; the first layer has as many input
    /// channels as there are distinct maps, the others `channels`.
    pub layers: [Vec<f64>; LAYERS],
}

impl FilterBank {
    /// The bank for one band of unweighted maps.
    #[must_use]
    pub fn random(seed: u64, channels: usize) -> Self {
        Self::for_bands(seed, channels, Bands::default())
    }

    /// Draws the bank. The first layer is drawn for all of the paper's maps and folded onto the distinct ones, which
    /// gives exactly the same output; drawing as many as are distinct would change the distribution.
    #[must_use]
    pub fn for_bands(seed: u64, channels: usize, bands: Bands) -> Self {
        let mut rng = Rng::new(seed, Purpose::Filters);
        let mut draw = |inputs: usize| -> Vec<f64> {
            let bound = (6.0 / ((inputs + channels) * KERNEL * KERNEL) as f64).sqrt();
            (0..channels * inputs * KERNEL * KERNEL).map(|_| rng.range(-bound, bound)).collect()
        };
        let first = fold(&draw(bands.paper_maps()), channels, bands);
        let layers = [first, draw(channels), draw(channels), draw(channels)];
        Self { channels, layers }
    }

    /// Input channels of a layer.
    #[must_use]
    pub fn inputs(&self, layer: usize) -> usize {
        self.layers[layer].len() / (self.channels * KERNEL * KERNEL)
    }
}

/// Adds up the kernels of equal maps: of one band, `[channels, 10, 7, 7]` to `[channels, 5, 7, 7]`.
#[must_use]
pub fn fold(weights: &[f64], channels: usize, bands: Bands) -> Vec<f64> {
    let kernel = KERNEL * KERNEL;
    let distinct: Vec<usize> = (0..bands.count())
        .flat_map(|band| {
            // A band of nine lacks the plain Gaussian.
            let all =
                if bands.paper_maps_of(band) < PAPER_MAPS - 1 { &DISTINCT_OF_PAPER[..1] } else { &DISTINCT_OF_PAPER };
            let lacking = all.len() - bands.paper_maps_of(band);
            all[lacking..].iter().map(move |map| bands.first(band) + map)
        })
        .collect();
    let mut folded = vec![0.0; channels * bands.maps() * kernel];
    for (channel, from) in weights.chunks_exact(bands.paper_maps() * kernel).enumerate() {
        for (map, from) in from.chunks_exact(kernel).enumerate() {
            let at = (channel * bands.maps() + distinct[map]) * kernel;
            for (to, weight) in folded[at..at + kernel].iter_mut().zip(from) {
                *to += weight;
            }
        }
    }
    folded
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_of_equal_maps_is_right() {
        // Evaluate all ten cosines and compare each with the distinct one it is said to be.
        let frequencies = [-1.5, 0.0, 1.5];
        let cosine = |fy: f64, fx: f64| {
            let (dx, dy) = (0.123, -0.377);
            (std::f64::consts::TAU * (fx * dx + fy * dy)).cos()
        };
        let distinct = [1.0, cosine(1.5, 0.0), cosine(0.0, 1.5), cosine(1.5, 1.5), cosine(-1.5, 1.5)];
        let mut ten = vec![1.0];
        for fy in frequencies {
            for fx in frequencies {
                ten.push(cosine(fy, fx));
            }
        }
        for (value, which) in ten.iter().zip(DISTINCT_OF_PAPER) {
            assert!((value - distinct[which]).abs() < 1e-12, "{value} is not map {which}");
        }
        // Negative control: the distinct maps do differ.
        for i in 0..DISTINCT_MAPS {
            for j in 0..i {
                assert!((distinct[i] - distinct[j]).abs() > 1e-3);
            }
        }
    }

    #[test]
    fn weights_fill_the_glorot_range() {
        let bank = FilterBank::random(7, 24);
        let bound = (6.0 / (48.0 * 49.0_f64)).sqrt();
        for layer in &bank.layers[1..] {
            assert_eq!(layer.len(), 24 * 24 * 49);
            let largest = layer.iter().fold(0.0_f64, |most, w| most.max(w.abs()));
            assert!(largest <= bound && largest > 0.999 * bound, "{largest} {bound}");
            let mean = layer.iter().sum::<f64>() / layer.len() as f64;
            assert!(mean.abs() < bound * 0.02, "{mean}");
        }
        assert_eq!(bank.layers[0].len(), 24 * 5 * 49);
    }

    #[test]
    fn folding_keeps_what_every_map_gets() {
        let bands = Bands { lone: true, full: 1, waves: 2 };
        // One output channel; the kernel of map m is 2^m.
        let weights: Vec<f64> = (0..29).flat_map(|map| [f64::from(1 << map); 49]).collect();
        let folded = fold(&weights, 1, bands);
        assert_eq!(folded.len(), 16 * 49);
        let sums: Vec<f64> = folded.chunks_exact(49).map(|kernel| kernel[0]).collect();
        let sum = |maps: &[i32]| maps.iter().map(|&map| f64::from(1 << map)).sum::<f64>();
        let expected = [
            sum(&[0]),
            sum(&[1, 6]),
            sum(&[3, 9]),
            sum(&[5, 7]),
            sum(&[2, 10]),
            sum(&[4, 8]),
            // The frequency 0 of an attribute is its Gaussian.
            sum(&[15]),
            sum(&[12, 18]),
            sum(&[14, 16]),
            sum(&[11, 19]),
            sum(&[13, 17]),
            sum(&[24]),
            sum(&[21, 27]),
            sum(&[23, 25]),
            sum(&[20, 28]),
            sum(&[22, 26]),
        ];
        assert_eq!(sums, expected);
        let bank = FilterBank::for_bands(7, 8, bands);
        assert_eq!((bank.inputs(0), bank.inputs(1)), (16, 8));
        assert_eq!(FilterBank::for_bands(7, 8, Bands::default()), FilterBank::random(7, 8));
    }
}
