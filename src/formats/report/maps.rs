//! Densities of pair differences and periodograms as maps.

use std::fmt::Write as _;

use glam::DVec2;

use super::{CHANCE, GAP, MAP, MARGIN, Page, QUIET, RAMP, ReportError, Side, WIDTH};
use crate::analysis::{PairDensity, Periodogram, Scales, pair_density, periodogram, quantile};
use crate::formats::png::encode_rgba;
use crate::formats::style::{Color, PALETTE};
use crate::formats::svg::Px;

impl Page {
    /// Densities of pair differences and periodograms, two or four in a row.
    pub(super) fn maps(&mut self, sides: &[Side<'_>], scales: &Scales) -> Result<(), ReportError> {
        let d = scales.spacing;
        let mut densities = Vec::new();
        let mut spectra = Vec::new();
        for side in sides {
            densities.push(pair_density(&side.cloud, &scales.pair_density)?);
            spectra.push(periodogram(&side.cloud, scales.max_frequency)?);
        }
        // One scale for both sides, which a few extremes of the exemplar don't decide.
        let mut values: Vec<f64> = densities[0].within_reach().map(|(_, value)| value).collect();
        values.sort_unstable_by(f64::total_cmp);
        let most = quantile(&values, 0.995).max(2.0);
        let mut values: Vec<f64> = spectra[0].iter().map(|(_, power)| power).collect();
        values.sort_unstable_by(f64::total_cmp);
        let strongest = quantile(&values, 0.995).max(10.0);

        let half = (WIDTH - 2.0 * MARGIN - GAP) / 2.0;
        let room = half - MAP * sides.len() as f64;
        let gap = if sides.len() > 1 { room / (sides.len() - 1) as f64 } else { 0.0 };
        let second = MARGIN + half + GAP;
        let heading = "font-size=\"16\" font-weight=\"600\"";
        self.text(DVec2::new(MARGIN, self.y), heading, "Where neighbours lie (pair differences)");
        self.text(DVec2::new(second, self.y), heading, "Periodogram");
        let top = self.y + 16.0;
        for (i, side) in sides.iter().enumerate() {
            let reach = scales.pair_density.reach / d;
            let min = DVec2::new(MARGIN + i as f64 * (MAP + gap), top);
            self.image(min, &density_pixels(&densities[i], most))?;
            self.cross(min, side, &format!("± {reach:.1} d"));
            let min = DVec2::new(second + i as f64 * (MAP + gap), top);
            let reach = scales.max_frequency * d;
            self.image(min, &spectrum_pixels(&spectra[i], strongest))?;
            self.cross(min, side, &format!("± {reach:.1} / d"));
        }
        let bottom = top + MAP + 30.0;
        self.ramp(
            DVec2::new(MARGIN, bottom),
            half,
            &[(0.0, "0"), (1.0 / most, "1 (chance)"), (1.0, &format!("{most:.1} times chance"))],
        );
        let place = |power: f64| log_share(power, strongest);
        self.ramp(
            DVec2::new(second, bottom),
            half,
            &[(place(LEAST_POWER), "0.1"), (place(1.0), "1 (chance)"), (1.0, &format!("{strongest:.0} times chance"))],
        );
        self.y = bottom + 56.0;
        Ok(())
    }

    /// The middle, the frame and the caption of a map.
    pub(super) fn cross(&mut self, min: DVec2, side: &Side<'_>, reach: &str) {
        let middle = min + MAP / 2.0;
        for arm in [DVec2::new(5.0, 0.0), DVec2::new(0.0, 5.0)] {
            self.line(middle - arm, middle + arm, &format!("stroke=\"{}\" stroke-width=\"1.5\"", PALETTE[1].hex()));
        }
        self.rectangle(min, DVec2::splat(MAP), &format!("fill=\"none\" stroke=\"{CHANCE}\""));
        let below = min.y + MAP + 16.0;
        let color = format!("font-size=\"12\" font-weight=\"600\" fill=\"{}\"", side.color.hex());
        self.text(DVec2::new(min.x, below), &color, side.role);
        let quiet = format!("font-size=\"12\" text-anchor=\"end\" fill=\"{QUIET}\"");
        self.text(DVec2::new(min.x + MAP, below), &quiet, reach);
    }

    fn image(&mut self, min: DVec2, image: &Image) -> Result<(), ReportError> {
        let bytes = encode_rgba(image.width, image.height, &image.pixels)?;
        let _ = writeln!(
            self.svg,
            "<image x=\"{}\" y=\"{}\" width=\"{MAP}\" height=\"{MAP}\" preserveAspectRatio=\"none\" \
             href=\"data:image/png;base64,{}\"/>",
            Px(min.x),
            Px(min.y),
            base64(&bytes)
        );
        Ok(())
    }

    /// What the colours of a map mean.
    pub(super) fn ramp(&mut self, at: DVec2, width: f64, labels: &[(f64, &str)]) {
        const STEPS: usize = 96;
        for step in 0..STEPS {
            let [red, green, blue] = ramp_color(step as f64 / (STEPS - 1) as f64);
            let min = at + DVec2::new(width * step as f64 / STEPS as f64, 0.0);
            let fill = format!("fill=\"{}\"", Color::new(red, green, blue).hex());
            // A hair wider, so that no seam shows between them.
            self.rectangle(min, DVec2::new(width / STEPS as f64 + 0.6, 9.0), &fill);
        }
        self.rectangle(at, DVec2::new(width, 9.0), &format!("fill=\"none\" stroke=\"{CHANCE}\""));
        for &(share, label) in labels {
            let x = at.x + width * share;
            let anchor = match share {
                share if share < 0.08 => "start",
                share if share > 0.92 => "end",
                _ => "middle",
            };
            self.line(DVec2::new(x, at.y + 9.0), DVec2::new(x, at.y + 13.0), "stroke=\"#9aa5b1\"");
            let look = format!("font-size=\"12\" text-anchor=\"{anchor}\" fill=\"{QUIET}\"");
            self.text(DVec2::new(x, at.y + 26.0), &look, label);
        }
    }
}

/// Pixels, `[height, width, 4]`.
struct Image {
    width: u32,
    height: u32,
    pixels: Vec<u8>,
}

fn density_pixels(density: &PairDensity, most: f64) -> Image {
    let mut pixels = vec![0_u8; 4 * density.values.len()];
    for (pixel, value) in density.within_reach() {
        let [red, green, blue] = ramp_color(value / most);
        pixels[4 * pixel..4 * pixel + 4].copy_from_slice(&[red, green, blue, 255]);
    }
    Image { width: density.side as u32, height: density.side as u32, pixels }
}

/// Power at the light end of the ramp.
const LEAST_POWER: f64 = 0.1;

fn log_share(power: f64, strongest: f64) -> f64 {
    let log = |power: f64| libm::log10(power.max(LEAST_POWER) / LEAST_POWER);
    (log(power) / log(strongest)).clamp(0.0, 1.0)
}

fn spectrum_pixels(spectrum: &Periodogram, strongest: f64) -> Image {
    let pixels = spectrum
        .power
        .iter()
        .flat_map(|&power| {
            let [red, green, blue] = ramp_color(log_share(power, strongest));
            [red, green, blue, 255]
        })
        .collect();
    Image { width: spectrum.size[0] as u32, height: spectrum.size[1] as u32, pixels }
}

/// The colour of a share of the ramp.
fn ramp_color(share: f64) -> [u8; 3] {
    let place = share.clamp(0.0, 1.0) * (RAMP.len() - 1) as f64;
    let at = (place as usize).min(RAMP.len() - 2);
    let t = place - at as f64;
    std::array::from_fn(|i| (RAMP[at][i] + (RAMP[at + 1][i] - RAMP[at][i]) * t).round() as u8)
}

/// RFC 4648, with padding.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let byte = |i: usize| u32::from(chunk.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for digit in 0..4 {
            let value = bits >> (18 - 6 * digit) & 63;
            text.push(if digit > chunk.len() { '=' } else { char::from(DIGITS[value as usize]) });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_the_rfc() {
        for (plain, coded) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }
}
