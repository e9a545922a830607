//! Pictures: dark blobs on light ground, or light ones on dark, become points.
//!
//! Pixels on one side of a threshold that touch, also at corners, are one blob; its centroid is a point, and the radius
//! of a disk of the same area its attribute. y points down, as in the picture and on the page.

use glam::DVec2;

use super::error::FormatError;
use super::style::RADIUS_ATTRIBUTE;
use super::{FileFormat, Note, ReadOptions, Reading};
use crate::pattern::{Attribute, Boundary, Domain, MAX_POINTS, PointPattern};

/// Most pixels of a picture: 4096².
pub(super) const MAX_PIXELS: usize = 1 << 24;

/// A picture's pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    width: usize,
    height: usize,
    /// Brightness from 0 (black) to 255, row by row; what is transparent shows white.
    brightness: Vec<u8>,
}

impl Picture {
    /// From pixels, `[height, width, 4]`: red, green, blue and alpha that is not multiplied in.
    ///
    /// # Errors
    /// When there are no pixels, more than 4096², or not as many as the sides say.
    pub fn new(width: usize, height: usize, rgba: impl AsRef<[u8]>) -> Result<Self, FormatError> {
        let refuse = |reason: String| Err(FormatError::Pixels { reason });
        let rgba = rgba.as_ref();
        let count = width.saturating_mul(height);
        if count == 0 || count > MAX_PIXELS {
            return refuse(format!("it has {width} × {height} pixels; 1 to {MAX_PIXELS} are allowed"));
        }
        if rgba.len() != 4 * count {
            return refuse(format!("{width} × {height} pixels do not take {} bytes", rgba.len()));
        }
        let brightness = rgba
            .chunks_exact(4)
            .map(|pixel| {
                let [red, green, blue, alpha] = [pixel[0], pixel[1], pixel[2], pixel[3]].map(u32::from);
                // ITU-R BT.601, in thousandths.
                let luma = (299 * red + 587 * green + 114 * blue + 500) / 1000;
                let shown = (luma * alpha + 255 * (255 - alpha) + 127) / 255;
                // A weighted mean of two numbers up to 255.
                shown as u8
            })
            .collect();
        Ok(Self { width, height, brightness })
    }
}

/// Which pixels are points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ink {
    /// The side of the threshold with fewer pixels.
    #[default]
    Auto,
    /// The darker ones.
    Dark,
    /// The lighter ones.
    Light,
}

/// How points are looked for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BlobOptions {
    /// Pixels up to this brightness are dark; Otsu's (1979) when `None`.
    pub threshold: Option<u8>,
    /// Which pixels are points.
    pub ink: Ink,
    /// Smallest blob in pixels; when `None` those of a quarter of the median area or less are taken for dirt.
    pub min_area: Option<f64>,
    /// Largest blob in pixels; no limit when `None`.
    pub max_area: Option<f64>,
}

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Blobs {
    /// The points, in pixels from the picture's upper left corner.
    pub reading: Reading,
    /// The threshold that was used.
    pub threshold: u8,
    /// Which side of it was taken; never [`Ink::Auto`].
    pub ink: Ink,
}

/// Looks for the points of a picture.
///
/// # Errors
/// When there are none, or more than a pattern may hold.
pub fn find_blobs(picture: &Picture, options: &BlobOptions, read: &ReadOptions) -> Result<Blobs, FormatError> {
    let histogram = histogram(&picture.brightness);
    let threshold = options.threshold.unwrap_or_else(|| otsu(&histogram));
    let dark: usize = histogram[..=usize::from(threshold)].iter().sum();
    let ink = match options.ink {
        Ink::Auto if 2 * dark <= picture.brightness.len() => Ink::Dark,
        Ink::Auto => Ink::Light,
        chosen => chosen,
    };
    let blobs = components(picture, |brightness| (brightness <= threshold) == (ink == Ink::Dark));
    let smallest = options.min_area.unwrap_or_else(|| dirt(&blobs));
    let largest = options.max_area.unwrap_or(f64::INFINITY);
    let wanted = |blob: &&Blob| blob.area >= smallest && blob.area <= largest;
    let kept: Vec<&Blob> = blobs.iter().filter(wanted).collect();
    if kept.is_empty() {
        let side = if ink == Ink::Dark { "dark" } else { "light" };
        let reason = match blobs.len() {
            0 => format!("it has no {side} blobs at threshold {threshold}"),
            all => format!("none of its {all} {side} blobs has {smallest} to {largest} pixels"),
        };
        return Err(FormatError::Pixels { reason });
    }
    if kept.len() > MAX_POINTS {
        let reason = format!("it has {} blobs; at most {MAX_POINTS} are allowed: ask for larger ones", kept.len());
        return Err(FormatError::Pixels { reason });
    }
    let size = DVec2::new(picture.width as f64, picture.height as f64);
    let domain = match read.domain {
        Some(domain) => domain,
        None => Domain::new(DVec2::ZERO, size)?,
    };
    let radius = kept.iter().map(|blob| (blob.area / std::f64::consts::PI).sqrt()).collect();
    let positions = kept.iter().map(|blob| blob.center).collect();
    let pattern = PointPattern::new(domain, positions)?
        .with_boundary(read.boundary.unwrap_or(Boundary::Open))
        .with_attribute(Attribute { name: RADIUS_ATTRIBUTE.to_owned(), values: radius })?;
    let mut reading = Reading::new(FileFormat::Picture, pattern);
    reading.is_domain_declared = true;
    match blobs.len() - kept.len() {
        0 => {}
        1 => reading.notes.push(Note::left_out("One blob was too small or too large.")),
        others => reading.notes.push(Note::left_out(format!("{others} blobs were too small or too large."))),
    }
    Ok(Blobs { reading, threshold, ink })
}

fn histogram(brightness: &[u8]) -> [usize; 256] {
    let mut histogram = [0; 256];
    for &value in brightness {
        histogram[usize::from(value)] += 1;
    }
    histogram
}

/// The threshold that parts the pixels into the two most different groups (Otsu 1979). Between two groups with nothing
/// in between it is the middle of the gap.
fn otsu(histogram: &[usize; 256]) -> u8 {
    let total: usize = histogram.iter().sum();
    let weighted = |from: usize, to: usize| -> f64 { (from..to).map(|value| (value * histogram[value]) as f64).sum() };
    let all = weighted(0, 256);
    let (mut count, mut sum) = (0_usize, 0.0);
    let (mut best, mut first, mut last) = (-1.0, 0_u8, 0_u8);
    for threshold in 0..=255_u8 {
        count += histogram[usize::from(threshold)];
        sum += f64::from(threshold) * histogram[usize::from(threshold)] as f64;
        let (low, high) = (count as f64, (total - count) as f64);
        let between = if low > 0.0 && high > 0.0 {
            let apart = sum / low - (all - sum) / high;
            low * high * apart * apart
        } else {
            0.0
        };
        if between > best {
            (best, first, last) = (between, threshold, threshold);
        } else if between == best {
            last = threshold;
        }
    }
    // Of a range of equally good ones.
    first + (last - first) / 2
}

struct Blob {
    center: DVec2,
    area: f64,
}

/// Blobs up to this area are dirt beside the others.
fn dirt(blobs: &[Blob]) -> f64 {
    let mut areas: Vec<f64> = blobs.iter().map(|blob| blob.area).collect();
    let order = crate::sorting::order(areas.iter().copied());
    areas = order.into_iter().map(|place| areas[place]).collect();
    areas
        .get(areas.len() / 2)
        .map_or(0.0, |median| (median / 4.0).floor() + 1.0)
        .min(areas.last().copied().unwrap_or(0.0))
}

/// Connected components by union of the runs of each row with those of the row above, in reading order.
fn components(picture: &Picture, is_ink: impl Fn(u8) -> bool) -> Vec<Blob> {
    struct Run {
        start: usize,
        end: usize,
        row: usize,
    }
    fn root(parents: &mut [usize], mut run: usize) -> usize {
        while parents[run] != run {
            // Halves the way for the next one.
            parents[run] = parents[parents[run]];
            run = parents[run];
        }
        run
    }
    let mut runs: Vec<Run> = Vec::new();
    let mut parents: Vec<usize> = Vec::new();
    let mut above = 0..0;
    for (row, pixels) in picture.brightness.chunks_exact(picture.width).enumerate() {
        let first = runs.len();
        let mut column = 0;
        while column < pixels.len() {
            if !is_ink(pixels[column]) {
                column += 1;
                continue;
            }
            let start = column;
            while column < pixels.len() && is_ink(pixels[column]) {
                column += 1;
            }
            let run = runs.len();
            parents.push(run);
            runs.push(Run { start, end: column, row });
            // Corners touch: one pixel more on either side. Runs above that end before this one never touch later ones.
            while above.start < above.end && runs[above.start].end < start {
                above.start += 1;
            }
            for other in above.clone() {
                if runs[other].start > column {
                    break;
                }
                let (a, b) = (root(&mut parents, other), root(&mut parents, run));
                parents[a.max(b)] = a.min(b);
            }
        }
        above = first..runs.len();
    }
    let mut blobs: Vec<Blob> = Vec::new();
    let mut places = vec![usize::MAX; runs.len()];
    for (index, run) in runs.iter().enumerate() {
        let top = root(&mut parents, index);
        if places[top] == usize::MAX {
            places[top] = blobs.len();
            blobs.push(Blob { center: DVec2::ZERO, area: 0.0 });
        }
        let blob = &mut blobs[places[top]];
        let length = (run.end - run.start) as f64;
        blob.area += length;
        // Of the pixels' middles.
        blob.center += length * DVec2::new((run.start + run.end) as f64 / 2.0, run.row as f64 + 0.5);
    }
    for blob in &mut blobs {
        blob.center /= blob.area;
    }
    blobs
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may stop at the first surprise")]
    use super::*;

    /// `#` is black, `+` gray, anything else white.
    fn picture(rows: &[&str]) -> Picture {
        let rgba: Vec<u8> = rows
            .iter()
            .flat_map(|row| row.bytes())
            .flat_map(|byte| match byte {
                b'#' => [0, 0, 0, 255],
                b'+' => [90, 90, 90, 255],
                // Transparent black shows white.
                b'.' => [0, 0, 0, 0],
                _ => [255; 4],
            })
            .collect();
        Picture::new(rows[0].len(), rows.len(), rgba).unwrap()
    }

    fn found(picture: &Picture, options: &BlobOptions) -> Vec<(f64, f64)> {
        let blobs = find_blobs(picture, options, &ReadOptions::default()).unwrap();
        blobs.reading.pattern.positions().iter().map(|point| (point.x, point.y)).collect()
    }

    #[test]
    fn corners_touch_and_a_u_is_one_blob() {
        let shapes = picture(&["#  #   ", "#  #  #", "#### # ", "    #  ", "#......"]);
        let options = BlobOptions { min_area: Some(1.0), ..BlobOptions::default() };
        // The U with its tail of corners has 11 pixels.
        let blobs = find_blobs(&shapes, &options, &ReadOptions::default()).unwrap();
        assert_eq!(blobs.ink, Ink::Dark);
        let radii = &blobs.reading.pattern.attributes()[0].values;
        let areas: Vec<f64> = radii.iter().map(|radius| (radius * radius * std::f64::consts::PI).round()).collect();
        assert_eq!(areas, [11.0, 1.0]);
        assert_eq!(blobs.reading.pattern.positions()[1], DVec2::new(0.5, 4.5));
        assert_eq!(blobs.reading.pattern.domain().max(), DVec2::new(7.0, 5.0));
    }

    #[test]
    fn threshold_ink_and_sizes_choose() {
        let mixed = picture(&["##  ++  ", "##  ++  ", "       #", "        "]);
        assert_eq!(found(&mixed, &BlobOptions::default()), [(1.0, 1.0), (5.0, 1.0)], "a speck is dirt");
        let all = BlobOptions { min_area: Some(0.0), ..BlobOptions::default() };
        assert_eq!(found(&mixed, &all).len(), 3);
        assert_eq!(found(&mixed, &BlobOptions { threshold: Some(40), ..all }), [(1.0, 1.0), (7.5, 2.5)]);
        assert_eq!(found(&mixed, &BlobOptions { max_area: Some(2.0), ..all }), [(7.5, 2.5)]);
        assert_eq!(found(&mixed, &BlobOptions { ink: Ink::Light, ..all }).len(), 1);
        let negative = picture(&["####", "# ##", "####"]);
        let blobs = find_blobs(&negative, &all, &ReadOptions::default()).unwrap();
        assert_eq!((blobs.ink, blobs.reading.pattern.positions()[0]), (Ink::Light, DVec2::new(1.5, 1.5)));
    }

    #[test]
    fn pictures_without_points_say_so() {
        let words = |picture: &Picture, options: &BlobOptions| {
            find_blobs(picture, options, &ReadOptions::default()).unwrap_err().to_string()
        };
        let dark = BlobOptions { ink: Ink::Dark, threshold: Some(10), ..BlobOptions::default() };
        assert!(words(&picture(&["   "]), &dark).contains("no dark blobs at threshold 10"));
        let large = BlobOptions { min_area: Some(5.0), ..BlobOptions::default() };
        assert!(words(&picture(&["#  "]), &large).contains("none of its 1 dark blobs"));
        assert!(Picture::new(2, 2, [0; 15]).is_err() && Picture::new(0, 2, []).is_err());
        assert!(Picture::new(usize::MAX, 2, []).is_err());
    }
}
