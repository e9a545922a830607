//! The density of pair differences in the plane: a pair correlation that keeps the direction.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::cloud::{Cloud, check_positive};
use super::error::{AnalysisError, check};

/// How many standard deviations of the Gaussian count.
const KERNEL_REACH: f64 = 3.5;

/// Which differences are looked at, how smoothly and on which grid. Lengths are in the cloud's unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PairDensitySettings {
    /// Longest difference.
    pub reach: f64,
    /// Standard deviation of the Gaussian that each difference is spread by, along each axis.
    pub sigma: f64,
    /// Distance between neighbouring pixels.
    pub pitch: f64,
}

impl PairDensitySettings {
    /// Longest difference in mean spacings.
    pub const REACH: f64 = 3.5;
    /// Standard deviation in mean spacings.
    pub const SIGMA: f64 = 0.3;
    /// Pixels a mean spacing: σ is then 2.4 pixels, enough for a Gaussian to be sampled without loss.
    pub const PIXELS: f64 = 8.0;

    /// The settings for a pattern of mean spacing `spacing`. The reach is cut at what a window can tell.
    #[must_use]
    pub fn suited_to(cloud: &Cloud, spacing: f64) -> Self {
        let reach = (Self::REACH * spacing).min(cloud.longest_reach());
        Self { reach, sigma: Self::SIGMA * spacing, pitch: spacing / Self::PIXELS }
    }

    fn half(&self) -> usize {
        (self.reach / self.pitch + 1e-9).floor() as usize
    }

    fn check(&self) -> Result<(), AnalysisError> {
        check_positive("reach", self.reach)?;
        check_positive("sigma", self.sigma)?;
        check("pitch", self.pitch, self.reach / 1000.0, self.reach)
    }
}

/// How often one point lies at a given offset from another, against as many independent points: 1 is chance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PairDensity {
    /// How it was estimated.
    pub settings: PairDensitySettings,
    /// Pixels along a side, an odd number; the one in the middle is the difference 0.
    pub side: usize,
    /// `[side, side]`, row by row from the lowest y difference on; 0 beyond the reach.
    pub values: Vec<f64>,
}

impl PairDensity {
    /// The pixels within the reach and their values.
    pub fn within_reach(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let half = (self.side / 2) as f64;
        let reach_px = self.settings.reach / self.settings.pitch + 1e-9;
        self.values.iter().copied().enumerate().filter(move |(pixel, _)| {
            let x = (pixel % self.side) as f64 - half;
            let y = (pixel / self.side) as f64 - half;
            x * x + y * y <= reach_px * reach_px
        })
    }

    /// Mean absolute difference of two densities within the reach; `None` when their settings differ.
    #[must_use]
    pub fn mean_absolute_difference(&self, other: &Self) -> Option<f64> {
        if self.settings != other.settings || self.values.len() != other.values.len() {
            return None;
        }
        let (mut sum, mut count) = (0.0, 0.0);
        for (pixel, value) in self.within_reach() {
            sum += (value - other.values[pixel]).abs();
            count += 1.0;
        }
        (count > 0.0).then(|| sum / count)
    }
}

/// The density of the differences between all points, whatever their class: every difference spread by a Gaussian,
/// weighted for the border (translation correction in a window), divided by what independent points have (the second
/// moment measure of Ohser & Stoyan 1981, §2, smoothed).
///
/// # Errors
/// With a single point, or settings that are not positive.
pub fn pair_density(cloud: &Cloud, settings: &PairDensitySettings) -> Result<PairDensity, AnalysisError> {
    cloud.at_least("the density of pair differences", 2)?;
    let plain = cloud.clone().renumbered(1, |_| 0);
    let mut densities = class_pair_densities(&plain, settings)?;
    densities.pop().map(|(_, _, density)| density).ok_or(AnalysisError::TooFewPoints {
        what: "the density of pair differences",
        count: cloud.len(),
        needed: 2,
    })
}

/// The density of the differences from class `a` to class `b`, for all a ≤ b of which there are pairs; with one class
/// it is [`pair_density`].
///
/// # Errors
/// When settings are not positive.
pub fn class_pair_densities(
    cloud: &Cloud,
    settings: &PairDensitySettings,
) -> Result<Vec<(u16, u16, PairDensity)>, AnalysisError> {
    settings.check()?;
    let sizes = cloud.class_sizes();
    let classes = sizes.len();
    let half = settings.half();
    let side = 2 * half + 1;
    let mut maps: Vec<Vec<f64>> = vec![Vec::new(); classes * classes];
    for a in 0..classes {
        for b in a..classes {
            let others = if a == b { sizes[b].saturating_sub(1) } else { sizes[b] };
            if sizes[a] > 0 && others > 0 {
                maps[a * classes + b] = vec![0.0; side * side];
            }
        }
    }
    let mut splat = Splat::new(settings, half);
    cloud.neighbours().pairs(settings.reach + KERNEL_REACH * settings.sigma, |i, j, offset| {
        let (a, b) = (usize::from(cloud.classes()[i]), usize::from(cloud.classes()[j]));
        let (a, b, offset) = if a <= b { (a, b, offset) } else { (b, a, -offset) };
        let map = &mut maps[a * classes + b];
        if map.is_empty() {
            return;
        }
        let weight = cloud.pair_weight(offset);
        splat.add(map, offset, weight);
        if a == b {
            splat.add(map, -offset, weight);
        }
    });
    let area = cloud.area();
    let open = cloud.boundary() == crate::Boundary::Open;
    let mut densities = Vec::new();
    for a in 0..classes {
        for b in a..classes {
            let mut values = std::mem::take(&mut maps[a * classes + b]);
            if values.is_empty() {
                continue;
            }
            let others = if a == b && open { sizes[b] - 1 } else { sizes[b] };
            let scale = area * area / (sizes[a] as f64 * others as f64);
            values.iter_mut().for_each(|value| *value *= scale);
            let mut density = PairDensity { settings: *settings, side, values };
            let inside: Vec<usize> = density.within_reach().map(|(pixel, _)| pixel).collect();
            let mut kept = vec![0.0; density.values.len()];
            inside.into_iter().for_each(|pixel| kept[pixel] = density.values[pixel]);
            density.values = kept;
            densities.push((a as u16, b as u16, density));
        }
    }
    Ok(densities)
}

/// Adds Gaussians to a map, as products of a row and a column.
struct Splat {
    half: f64,
    side: usize,
    pitch: f64,
    sigma_px: f64,
    row: Vec<f64>,
}

impl Splat {
    fn new(settings: &PairDensitySettings, half: usize) -> Self {
        let side = 2 * half + 1;
        let sigma_px = settings.sigma / settings.pitch;
        Self { half: half as f64, side, pitch: settings.pitch, sigma_px, row: vec![0.0; side] }
    }

    /// The pixels of an axis that a Gaussian at `center` (in pixels) reaches.
    fn span(&self, center: f64) -> (usize, usize) {
        let reach = KERNEL_REACH * self.sigma_px;
        let from = (center - reach).ceil().max(0.0) as usize;
        let to = ((center + reach).floor() + 1.0).clamp(0.0, self.side as f64) as usize;
        (from, to)
    }

    fn add(&mut self, map: &mut [f64], offset: DVec2, weight: f64) {
        let center = offset / self.pitch + self.half;
        let ((left, right), (top, bottom)) = (self.span(center.x), self.span(center.y));
        if left >= right || top >= bottom {
            return;
        }
        let gaussian = |x: f64| libm::exp(-0.5 * (x / self.sigma_px).powi(2));
        // Per unit of area, not per pixel.
        let peak = weight / (std::f64::consts::TAU * (self.sigma_px * self.pitch).powi(2));
        for (x, value) in (left..right).zip(&mut self.row) {
            *value = gaussian(x as f64 - center.x);
        }
        for y in top..bottom {
            let height = peak * gaussian(y as f64 - center.y);
            let pixels = &mut map[y * self.side + left..y * self.side + right];
            pixels.iter_mut().zip(&self.row).for_each(|(pixel, value)| *pixel += height * value);
        }
    }
}
