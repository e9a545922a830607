//! Pictures: dark blobs on light ground, or light ones on dark, become points.
//!
//! Pixels on one side of a threshold that touch, also at corners, are one blob; its centroid is a point, and the radius
//! of a disk of the same area its attribute. y points down, as in the picture and on the page. What is done beyond that, each
//! with a note: uneven light is evened out (`light.rs`), marks that only opacity tells are found by it, frames and axes are left
//! out, and a second kind of fainter or smaller spots is taken too.

use std::borrow::Cow;

use glam::DVec2;

use super::blobs::{Blob, components, dirt, frames, second_kind};
use super::error::FormatError;
use super::light::{Light, faint_threshold, histogram, otsu};
use super::note::counted;
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
    /// From 0 (opaque) to 255, where at least a quarter of the pixels is rather transparent.
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
        let alphas = || rgba.iter().skip(3).step_by(4);
        let is_transparent = 4 * alphas().filter(|&&alpha| alpha < 128).count() >= count;
        let transparency = is_transparent.then(|| alphas().map(|alpha| 255 - alpha).collect());
        Ok(Self { width, height, brightness, transparency })
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
    /// Pixels up to this brightness are dark; Otsu's (1979) when `None`, and then a second kind of fainter spots is looked for
    /// too. Of a picture whose light was evened out it is the brightness after that, of one that opacity tells the transparency.
    pub threshold: Option<u8>,
    /// Which pixels are points.
    pub ink: Ink,
    /// Smallest blob in pixels; when `None` those of a quarter of the median area or less are taken for dirt, unless they are
    /// a second kind of spots.
    pub min_area: Option<f64>,
    /// Largest blob in pixels; no limit when `None`, and then frames and axes are left out.
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
    /// The threshold of a second kind of fainter spots, where they were taken too.
    pub faint_threshold: Option<u8>,
    /// Whether uneven light was evened out before.
    pub is_evened: bool,
    /// Whether opacity told the marks, and not brightness.
    pub is_by_opacity: bool,
}

/// Blobs at a threshold.
struct Found {
    threshold: u8,
    ink: Ink,
    faint_threshold: Option<u8>,
    kept: Vec<Blob>,
    /// Of whatever size.
    all: usize,
    /// Left out for their size.
    sized: usize,
    smallest: f64,
    notes: Vec<Note>,
}

impl Found {
    fn is_ink(&self, level: u8) -> bool {
        (level <= self.threshold) == (self.ink == Ink::Dark)
    }

    fn of(levels: &[u8], [width, height]: [usize; 2], options: &BlobOptions) -> Self {
        let histogram = histogram(levels);
        let threshold = options.threshold.unwrap_or_else(|| otsu(&histogram));
        let dark: usize = histogram[..=usize::from(threshold)].iter().sum();
        let ink = match options.ink {
            Ink::Auto if 2 * dark <= levels.len() => Ink::Dark,
            Ink::Auto => Ink::Light,
            chosen => chosen,
        };
        let mut found = Self {
            threshold,
            ink,
            faint_threshold: None,
            kept: Vec::new(),
            all: 0,
            sized: 0,
            smallest: 0.0,
            notes: Vec::new(),
        };
        let mut blobs = components(levels, width, |level| (found.is_ink(level), false));
        found.all = blobs.len();
        let mut notes = Vec::new();
        if options.max_area.is_none() {
            found.leave_out_frames(&mut blobs, [width, height], &mut notes);
        }
        found.smallest = options.min_area.unwrap_or_else(|| dirt(&blobs));
        let largest = options.max_area.unwrap_or(f64::INFINITY);
        let (mut kept, rest): (Vec<Blob>, Vec<Blob>) =
            blobs.into_iter().partition(|blob| blob.area >= found.smallest && blob.area <= largest);

        found.sized = rest.len();
        // Smaller ones, and fainter ones, are dirt unless they are many and alike.
        let small = if options.min_area.is_none() { rest } else { Vec::new() };
        let faint_threshold = if options.threshold.is_none() && options.max_area.is_none() && options.min_area.is_none()
        {
            faint_threshold(&histogram, threshold, ink == Ink::Dark)
        } else {
            None
        };
        let faint: Vec<Blob> = faint_threshold.map_or_else(Vec::new, |faint| {
            let is_faint = |level: u8| if ink == Ink::Dark { level <= faint } else { level >= faint };
            let all = components(levels, width, |level| (is_faint(level), found.is_ink(level)));
            all.into_iter().filter(|blob| !blob.has_core).collect()
        });
        let before = kept.len();
        let mut second: Vec<Blob> = small.iter().chain(&faint).cloned().collect();
        if second_kind(&kept, &second) {
            found.faint_threshold = faint_threshold.filter(|_| !faint.is_empty());
            kept.append(&mut second);
            found.sized = 0;
        } else if second_kind(&kept, &small) {
            kept.extend(small.iter().cloned());
            found.sized = 0;
        }
        let added = kept.len() - before;
        if added > 0 {
            let at = found.faint_threshold.map_or_else(String::new, |faint| format!(", down to threshold {faint}"));
            let blobs = counted(added, "One blob is", "blobs are");
            notes.push(Note::changed(format!(
                "{blobs} smaller or fainter than the other {before} at threshold {threshold}, but alike, and were taken for points \
                 too{at}. Set a smallest area to leave them out."
            )));
        } else if let Some(at) = faint_threshold.filter(|_| !faint.is_empty() && faint.len() <= 3 * kept.len()) {
            let spots = counted(faint.len(), "One fainter spot was", "fainter spots were");
            notes.push(Note::left_out(format!(
                "{spots} left out at threshold {threshold}. Threshold {at} takes them too, if they are points."
            )));
        }
        found.kept = kept;
        found.notes = notes;
        found
    }

    fn leave_out_frames(&self, blobs: &mut Vec<Blob>, sides: [usize; 2], notes: &mut Vec<Note>) {
        let are_frames = frames(blobs, sides);
        let mut marks = are_frames.iter();
        let all = blobs.clone();
        blobs.retain(|_| marks.next() == Some(&false));
        let found: Vec<&Blob> = all.iter().zip(&are_frames).filter(|(_, is)| **is).map(|(blob, _)| blob).collect();
        if found.is_empty() {
            return;
        }
        let shapes = counted(found.len(), "One shape that is", "shapes that are");
        let was = if found.len() == 1 { "was" } else { "were" };
        let they = if found.len() == 1 { "it is a point" } else { "they are points" };
        notes.push(Note::left_out(format!(
            "{shapes} long and thin beside the others, a frame, axis or line, {was} left out. Set a largest area if {they}."
        )));
        let outside = blobs.iter().filter(|blob| found.iter().all(|frame| !frame.holds(blob.center))).count();
        if outside > 0 && 2 * outside < blobs.len() {
            let are = counted(outside, "One blob is", "blobs are");
            notes.push(Note::odd(format!(
                "{are} outside the frame or axes. If these are labels, cut the picture along the frame first."
            )));
        }
    }
}

/// Looks for the points of a picture.
///
/// # Errors
/// When there are none, or more than a pattern may hold.
pub fn find_blobs(picture: &Picture, options: &BlobOptions, read: &ReadOptions) -> Result<Blobs, FormatError> {
    let sides = [picture.width, picture.height];
    let light = Light::of(&picture.brightness, sides);
    let is_evened = light.is_some();
    let levels = match light {
        Some(light) => Cow::Owned(light.evened(&picture.brightness, sides)),
        None => Cow::Borrowed(&picture.brightness),
    };
    let mut found = Found::of(&levels, sides, options);
    let by_opacity = picture
        .transparency
        .as_ref()
        .filter(|_| options.ink != Ink::Light)
        .map(|levels| Found::of(levels, sides, &BlobOptions { ink: Ink::Dark, ..*options }))
        // Of marks that brightness tells as well it is the measure.
        .filter(|other| 10 * other.kept.len() > 11 * found.kept.len());
    let is_by_opacity = by_opacity.is_some();
    if let Some(by_opacity) = by_opacity {
        found = by_opacity;
    }
    let Found { threshold, ink, faint_threshold, kept, all, sized, smallest, notes } = found;
    if kept.is_empty() {
        let side = if ink == Ink::Dark { "dark" } else { "light" };
        let largest = options.max_area.unwrap_or(f64::INFINITY);
        let reason = match all {
            0 => format!("it has no {side} blobs at threshold {threshold}"),
            all if smallest <= largest && options.min_area.is_none() && options.max_area.is_none() => {
                format!("its {all} {side} blobs at threshold {threshold} are lines or frames")
            }
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
    if is_evened && !is_by_opacity {
        reading.notes.push(Note::changed(format!(
            "The ground is darker on one side than on another, so its light was evened out before the threshold {threshold}."
        )));
    }
    if is_by_opacity {
        reading.notes.push(Note::changed(format!(
            "The ground is transparent and hides the marks on white, so that opacity tells them, at threshold {threshold}."
        )));
    }
    match sized {
        0 => {}
        1 => reading.notes.push(Note::left_out("One blob was too small or too large.")),
        others => reading.notes.push(Note::left_out(format!("{others} blobs were too small or too large."))),
    }
    reading.notes.extend(notes);
    Ok(Blobs { reading, threshold, ink, faint_threshold, is_evened: is_evened && !is_by_opacity, is_by_opacity })
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
