//! The periodogram and its radial mean.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::cloud::{Cloud, check_positive};
use super::error::AnalysisError;

/// Most complex products of one periodogram: a fifth of a second. Beyond it frequencies are left out evenly.
const MAX_PRODUCTS: f64 = 2e8;

/// |Σ e^(−2πi f·x)|² / n at evenly spaced frequencies: 1 on average for independent points, n at the frequencies of a
/// lattice.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Periodogram {
    /// Distance between neighbouring frequencies along x and y, in cycles per unit of length: whole cycles of the
    /// rectangle, so that its shape leaves no trace.
    pub step: [f64; 2],
    /// Columns and rows, both odd; the frequency in the middle is 0.
    pub size: [usize; 2],
    /// `[rows, columns]`, row by row from the lowest y frequency on. The middle, which would always be n, is 0.
    pub power: Vec<f64>,
}

/// The mean of a periodogram over rings: how strong a wavelength is, whatever its direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RadialSpectrum {
    /// Mean frequency of each ring, in cycles per unit of length.
    pub frequency: Vec<f64>,
    /// Mean power of each ring.
    pub power: Vec<f64>,
}

/// The periodogram for all frequencies up to `max_frequency` (cycles per unit of length) along each axis (Bartlett
/// 1964; Ulichney 1988 for its radial mean). In a window it is the estimate without a taper.
///
/// Its cost grows with the points and with the frequencies: those of the largest patterns are thinned out evenly.
///
/// # Errors
/// When the frequency is not positive.
pub fn periodogram(cloud: &Cloud, max_frequency: f64) -> Result<Periodogram, AnalysisError> {
    check_positive("max_frequency", max_frequency)?;
    let size = cloud.size();
    let cycles = (max_frequency * size + 1e-9).floor().max(glam::DVec2::ONE);
    let products = 2.0 * cycles.x * cycles.y * cloud.len() as f64;
    let stride = (products / MAX_PRODUCTS).sqrt().ceil().max(1.0);
    let halves = [(cycles.x / stride).floor().max(1.0) as usize, (cycles.y / stride).floor().max(1.0) as usize];
    let step = [stride / size.x, stride / size.y];
    let rows = 2 * halves[1] + 1;
    let columns = halves[0] + 1;

    // Half of the plane: the other half is its mirror image.
    let mut re = vec![0.0; rows * columns];
    let mut im = vec![0.0; rows * columns];
    let (mut along_x, mut along_y) = (vec![(0.0, 0.0); columns], vec![(0.0, 0.0); rows]);
    for point in cloud.points() {
        powers(TAU * step[0] * point.x, &mut along_x, 0);
        powers(TAU * step[1] * point.y, &mut along_y, halves[1]);
        for (row, &(c, s)) in along_y.iter().enumerate() {
            let span = row * columns..(row + 1) * columns;
            for ((re, im), &(x, y)) in re[span.clone()].iter_mut().zip(&mut im[span]).zip(&along_x) {
                *re += c * x - s * y;
                *im += c * y + s * x;
            }
        }
    }

    let count = cloud.len() as f64;
    let width = 2 * halves[0] + 1;
    let mut power = vec![0.0; rows * width];
    for row in 0..rows {
        for column in 0..columns {
            let from = row * columns + column;
            let value = (re[from] * re[from] + im[from] * im[from]) / count;
            power[row * width + halves[0] + column] = value;
            power[(rows - 1 - row) * width + halves[0] - column] = value;
        }
    }
    power[halves[1] * width + halves[0]] = 0.0;
    Ok(Periodogram { step, size: [width, rows], power })
}

/// `e^(i·angle·(k − zero))` for k = 0, 1, …, by doubling back to exact values often enough to keep all digits.
fn powers(angle: f64, list: &mut [(f64, f64)], zero: usize) {
    const RENEW: usize = 16;
    let (s1, c1) = libm::sincos(angle);
    let mut last = (1.0, 0.0);
    for (k, value) in list.iter_mut().enumerate() {
        last = if k % RENEW == 0 {
            let (s, c) = libm::sincos(angle * (k as f64 - zero as f64));
            (c, s)
        } else {
            (last.0 * c1 - last.1 * s1, last.0 * s1 + last.1 * c1)
        };
        *value = last;
    }
}

impl Periodogram {
    /// The frequencies (x, y) and powers, the middle left out.
    pub fn iter(&self) -> impl Iterator<Item = ([f64; 2], f64)> + '_ {
        let [columns, rows] = self.size;
        let middle = rows / 2 * columns + columns / 2;
        self.power.iter().enumerate().filter(move |&(at, _)| at != middle).map(move |(at, &power)| {
            let x = (at % columns) as f64 - (columns / 2) as f64;
            let y = (at / columns) as f64 - (rows / 2) as f64;
            ([x * self.step[0], y * self.step[1]], power)
        })
    }

    /// The mean over rings of this width (cycles per unit of length), up to the highest frequency that all directions
    /// have. Rings without a frequency are left out.
    ///
    /// # Errors
    /// When the width is not positive.
    pub fn radial_mean(&self, width: f64) -> Result<RadialSpectrum, AnalysisError> {
        check_positive("width", width)?;
        let highest = (self.step[0] * (self.size[0] / 2) as f64).min(self.step[1] * (self.size[1] / 2) as f64);
        let rings = (highest / width).ceil().clamp(1.0, 10_000.0) as usize;
        let mut sums = vec![(0.0, 0.0, 0.0); rings];
        for ([x, y], power) in self.iter() {
            let frequency = x.hypot(y);
            if frequency <= highest * (1.0 + 1e-9) {
                // A frequency on the limit of two rings, as whole cycles are, shall not fall to either side by a rounding.
                let ring = ((frequency / width + 1e-9) as usize).min(rings - 1);
                let (frequencies, powers, count) = &mut sums[ring];
                *frequencies += frequency;
                *powers += power;
                *count += 1.0;
            }
        }
        sums.retain(|&(_, _, count)| count > 0.0);
        Ok(RadialSpectrum {
            frequency: sums.iter().map(|(frequencies, _, count)| frequencies / count).collect(),
            power: sums.iter().map(|(_, powers, count)| powers / count).collect(),
        })
    }
}
