//! Pictures: dark blobs on light ground, or light ones on dark, become points.
//!
//! Pixels on one side of a threshold that touch, also at corners, are one blob; its centroid is a point, and the radius
//! of a disk of the same area its attribute. y points down, as in the picture and on the page.
//!
//! What is not a point, and what a single threshold does not find (`spots.rs`): frames and axes are left out; small
//! blobs stay when many are alike; fainter ones are looked for with a second threshold; where the light is uneven, pixels
//! are compared with those around them (`ground.rs`); on transparent ground, marks are told by their opacity when
//! their brightness does not tell them.

use std::borrow::Cow;

use glam::DVec2;

use super::error::FormatError;
use super::note::counted;
use super::style::RADIUS_ATTRIBUTE;
use super::{FileFormat, Note, ReadOptions, Reading, ground, spots};
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
    /// From 0, where a pixel is opaque, to 255, where it is transparent; only where most are transparent.
    transparency: Option<Vec<u8>>,
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
        let mut transparent = 0;
        let brightness = rgba
            .chunks_exact(4)
            .map(|pixel| {
                let [red, green, blue, alpha] = [pixel[0], pixel[1], pixel[2], pixel[3]].map(u32::from);
                transparent += usize::from(alpha < 128);
                // ITU-R BT.601, in thousandths.
                let luma = (299 * red + 587 * green + 114 * blue + 500) / 1000;
                let shown = (luma * alpha + 255 * (255 - alpha) + 127) / 255;
                // A weighted mean of two numbers up to 255.
                shown as u8
            })
            .collect();
        let is_ground = 2 * transparent > count;
        let transparency = is_ground.then(|| rgba.chunks_exact(4).map(|pixel| 255 - pixel[3]).collect());
        Ok(Self { width, height, brightness, transparency })
    }

    /// The transparency, where it tells marks that the brightness does not: light ones on a ground that shows white.
    fn marks(&self) -> Option<&[u8]> {
        let transparency = self.transparency.as_deref()?;
        let threshold = otsu(&histogram(&self.brightness));
        let opaque = transparency.iter().filter(|&&value| value < 128).count();
        let shown = self.brightness.iter().zip(transparency).filter(|&(&b, &t)| t < 128 && b <= threshold).count();
        // Of marks that all show, only the soft edges are light.
        if opaque == 0 || shown + opaque / 8 >= opaque {
            return None;
        }
        // A light sheet with dark marks is opaque as a whole: then the brightness tells more.
        let blobs = |values: &[u8], limit: u8| components(values, self.width, |value| value <= limit).len();
        (blobs(transparency, 127) > blobs(&self.brightness, threshold)).then_some(transparency)
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
    /// Pixels up to this brightness are dark; when `None`, Otsu's (1979), of the differences from what is around a pixel
    /// where the light is uneven. Of marks on transparent ground it is the transparency.
    pub threshold: Option<u8>,
    /// Which pixels are points. On transparent ground, where marks are told by their opacity, dark means opaque.
    pub ink: Ink,
    /// Smallest blob in pixels; when `None` those of a quarter of the median area or less are taken for dirt, unless many
    /// are alike.
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
    /// Whether it is one of differences: 128 is as bright as what is around a pixel.
    pub is_local: bool,
    /// Which side of it was taken; never [`Ink::Auto`].
    pub ink: Ink,
}

/// Pixels on both sides of a threshold.
pub(super) struct Split {
    pub(super) threshold: u8,
    pub(super) ink: Ink,
    pub(super) blobs: Vec<Blob>,
    /// How many values lie between the means of both sides, in standard deviations of the ground, which is at least 1.
    pub(super) separation: f64,
}

impl Split {
    pub(super) fn of(values: &[u8], width: usize, options: &BlobOptions) -> Self {
        let histogram = histogram(values);
        let threshold = options.threshold.unwrap_or_else(|| otsu(&histogram));
        let dark: usize = histogram[..=usize::from(threshold)].iter().sum();
        let ink = match options.ink {
            Ink::Auto if 2 * dark <= values.len() => Ink::Dark,
            Ink::Auto => Ink::Light,
            chosen => chosen,
        };
        let mut split = Self { threshold, ink, blobs: Vec::new(), separation: 0.0 };
        split.blobs = components(values, width, |value| split.is_ink(value));
        let [low, high] = [moments(&histogram, 0..=threshold), moments(&histogram, threshold.saturating_add(1)..=255)];
        let ground = if ink == Ink::Dark { high } else { low };
        split.separation = (high.0 - low.0) / ground.1.max(1.0);
        split
    }

    pub(super) fn is_ink(&self, value: u8) -> bool {
        (value <= self.threshold) == (self.ink == Ink::Dark)
    }

    /// The blobs that are neither dirt nor beyond what was asked for.
    fn kept(&self, options: &BlobOptions) -> impl Iterator<Item = &Blob> {
        let smallest = options.min_area.unwrap_or_else(|| spots::smallest(&self.blobs));
        let largest = options.max_area.unwrap_or(f64::INFINITY);
        self.blobs.iter().filter(move |blob| blob.area >= smallest && blob.area <= largest)
    }
}

/// Looks for the points of a picture.
///
/// # Errors
/// When there are none, or more than a pattern may hold.
pub fn find_blobs(picture: &Picture, options: &BlobOptions, read: &ReadOptions) -> Result<Blobs, FormatError> {
    let size = [picture.width, picture.height];
    let mut notes = Vec::new();
    let mut values = Cow::Borrowed(&picture.brightness[..]);
    let marks = picture.marks();
    let mut options = *options;
    if let Some(marks) = marks {
        values = Cow::Borrowed(marks);
        if options.ink == Ink::Auto {
            options.ink = Ink::Dark;
        }
        notes.push(Note::changed(
            "The ground is transparent, and the marks on it hardly show on white: points are what is opaque. Put the marks \
             on a ground of another colour if that was not meant.",
        ));
    }
    let mut split = Split::of(&values, size[0], &options);
    let mut is_local = false;
    if options.threshold.is_none()
        && marks.is_none()
        && let Some((flat, local)) = ground::even(&values, size, &split, &options, |split| split.kept(&options).count())
    {
        (values, split, is_local) = (Cow::Owned(flat), local, true);
        notes.push(Note::changed(
            "The light is uneven: no threshold parts the points from the ground everywhere. Each pixel was compared with \
             those around it instead. Set the threshold to use one for the whole picture.",
        ));
    }
    let all = split.blobs.len();
    let mut kept: Vec<Blob> = split.kept(&options).copied().collect();
    let beyond = all - kept.len();
    if kept.is_empty() {
        let side = match split.ink {
            _ if marks.is_some() => "opaque",
            Ink::Dark => "dark",
            _ => "light",
        };
        let smallest = options.min_area.unwrap_or_else(|| spots::smallest(&split.blobs));
        let largest = options.max_area.unwrap_or(f64::INFINITY);
        let reason = match all {
            0 => format!("it has no {side} blobs at threshold {}", split.threshold),
            all => format!("none of its {all} {side} blobs has {smallest} to {largest} pixels"),
        };
        return Err(FormatError::Pixels { reason });
    }
    if options.min_area.is_none() {
        notes.extend(spots::note_of_small(&kept, &split.blobs));
    }
    notes.extend(spots::take_frames(&mut kept, size));
    if options.threshold.is_none() {
        let (fainter, note) = spots::fainter(&values, size[0], &split, kept.len());
        let [smallest, largest] = [options.min_area.unwrap_or(0.0), options.max_area.unwrap_or(f64::INFINITY)];
        let before = kept.len();
        let are_left_out = fainter.is_empty();
        kept.extend(fainter.into_iter().filter(|blob| blob.area >= smallest && blob.area <= largest));
        if are_left_out || kept.len() > before {
            notes.extend(note);
        }
    }
    if kept.len() > MAX_POINTS {
        let reason = format!("it has {} blobs; at most {MAX_POINTS} are allowed: ask for larger ones", kept.len());
        return Err(FormatError::Pixels { reason });
    }
    let domain = match read.domain {
        Some(domain) => domain,
        None => Domain::new(DVec2::ZERO, DVec2::new(picture.width as f64, picture.height as f64))?,
    };
    let radius = kept.iter().map(|blob| (blob.area / std::f64::consts::PI).sqrt()).collect();
    let positions = kept.iter().map(|blob| blob.center).collect();
    let pattern = PointPattern::new(domain, positions)?
        .with_boundary(read.boundary.unwrap_or(Boundary::Open))
        .with_attribute(Attribute { name: RADIUS_ATTRIBUTE.to_owned(), values: radius })?;
    let mut reading = Reading::new(FileFormat::Picture, pattern);
    reading.is_domain_declared = true;
    if beyond > 0 {
        let were = counted(beyond, "One blob was", "blobs were");
        notes.push(Note::left_out(format!(
            "{were} too small or too large. Change the smallest or the largest blob to have them."
        )));
    }
    reading.notes = notes;
    Ok(Blobs { reading, threshold: split.threshold, is_local, ink: split.ink })
}

/// How many pixels have each value.
pub(super) fn histogram(values: &[u8]) -> [usize; 256] {
    let mut histogram = [0; 256];
    for &value in values {
        histogram[usize::from(value)] += 1;
    }
    histogram
}

/// Mean and standard deviation of the values in a range; 0 where there are none.
pub(super) fn moments(histogram: &[usize; 256], range: std::ops::RangeInclusive<u8>) -> (f64, f64) {
    let pairs = || range.clone().map(|value| (f64::from(value), histogram[usize::from(value)] as f64));
    let count: f64 = pairs().map(|(_, count)| count).sum();
    if count == 0.0 {
        return (0.0, 0.0);
    }
    let mean = pairs().map(|(value, count)| value * count).sum::<f64>() / count;
    let square = pairs().map(|(value, count)| (value - mean) * (value - mean) * count).sum::<f64>() / count;
    (mean, square.sqrt())
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

/// Pixels that touch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blob {
    pub(super) center: DVec2,
    pub(super) area: f64,
    /// The first column and row, and those behind the last.
    pub(super) min: [usize; 2],
    pub(super) max: [usize; 2],
    /// The least and the greatest value.
    pub(super) values: [u8; 2],
}

impl Blob {
    /// Width and height of the rectangle around it.
    pub(super) fn sides(&self) -> [f64; 2] {
        [0, 1].map(|axis| (self.max[axis] - self.min[axis]) as f64)
    }

    /// How much of that rectangle it fills.
    pub(super) fn fill(&self) -> f64 {
        let [width, height] = self.sides();
        self.area / (width * height)
    }
}

/// Connected components by union of the runs of each row with those of the row above, in reading order.
pub(super) fn components(values: &[u8], width: usize, is_ink: impl Fn(u8) -> bool) -> Vec<Blob> {
    struct Run {
        start: usize,
        end: usize,
        row: usize,
        values: [u8; 2],
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
    for (row, pixels) in values.chunks_exact(width.max(1)).enumerate() {
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
            let extreme =
                pixels[start..column].iter().fold([255, 0], |[low, high]: [u8; 2], &v| [low.min(v), high.max(v)]);
            runs.push(Run { start, end: column, row, values: extreme });
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
            blobs.push(Blob { center: DVec2::ZERO, area: 0.0, min: [usize::MAX; 2], max: [0; 2], values: [255, 0] });
        }
        let blob = &mut blobs[places[top]];
        let length = (run.end - run.start) as f64;
        blob.area += length;
        blob.min = [blob.min[0].min(run.start), blob.min[1].min(run.row)];
        blob.max = [blob.max[0].max(run.end), blob.max[1].max(run.row + 1)];
        blob.values = [blob.values[0].min(run.values[0]), blob.values[1].max(run.values[1])];
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
