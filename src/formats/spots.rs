//! Which blobs of a picture are points: dirt, frames and axes are not, small ones and faint ones may be.

use super::Note;
use super::note::counted;
use super::picture::{Blob, Ink, Split, components, histogram, moments};

/// Fewest blobs alike that are no accident.
const FEW: usize = 3;
/// Fewest pixels of a small blob: less has no shape.
const LEAST_AREA: f64 = 4.0;

/// From the least to the greatest.
fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    crate::sorting::ascending(&mut values);
    values
}

/// The upper one of the two in the middle; 0 of none.
fn median(sorted: &[f64]) -> f64 {
    sorted.get(sorted.len() / 2).copied().unwrap_or_default()
}

/// Whether blobs of these areas are one kind: the middle half within a factor of 3.
fn are_alike(areas: &[f64]) -> bool {
    areas.len() >= FEW && areas[3 * (areas.len() - 1) / 4] <= 3.0 * areas[areas.len() / 4]
}

/// A quarter of the median area or less is dirt.
fn dirt(sorted: &[f64]) -> f64 {
    let most = sorted.last().copied().unwrap_or_default();
    ((median(sorted) / 4.0).floor() + 1.0).min(most)
}

/// The area that the smallest points have: dirt has less, unless many of its blobs are alike, and are no specks.
pub(super) fn smallest(blobs: &[Blob]) -> f64 {
    let areas = sorted(blobs.iter().map(|blob| blob.area));
    let limit = dirt(&areas);
    let specks = areas.partition_point(|&area| area < LEAST_AREA);
    let small = &areas[specks..areas.partition_point(|&area| area < limit).max(specks)];
    let large = areas.len() - specks - small.len();
    // As many as a tenth of the large ones, and not so many specks beside them that they may be the largest of these.
    if are_alike(small) && 10 * small.len() >= large && specks <= small.len() {
        return dirt(small).max(LEAST_AREA);
    }
    limit
}

/// What to say of small ones that were kept.
pub(super) fn note_of_small(kept: &[Blob], all: &[Blob]) -> Option<Note> {
    let limit = dirt(&sorted(all.iter().map(|blob| blob.area)));
    let small = kept.iter().filter(|blob| blob.area < limit).count();
    (small > 0).then(|| {
        let are = counted(small, "One blob is", "blobs are");
        Note::changed(format!(
            "{are} much smaller than the others, and were taken for points because they are alike. Set the smallest blob to \
             {limit} pixels to leave them out."
        ))
    })
}

/// Takes off frames, axes and lines: shapes much longer than the other blobs that enclose some of them, span the picture, or
/// are thin. Without them there must be enough left to compare with.
pub(super) fn take_frames(kept: &mut Vec<Blob>, [width, height]: [usize; 2]) -> Option<Note> {
    let lengths = sorted(kept.iter().map(|blob| blob.sides()[0].max(blob.sides()[1])));
    let usual = median(&lengths);
    let picture = [width as f64, height as f64];
    let is_frame = |blob: &Blob| {
        let sides = blob.sides();
        let [long, thin] = [sides[0].max(sides[1]), sides[0].min(sides[1])];
        if long < 4.0 * usual || kept.len() <= FEW {
            return false;
        }
        let spans = |share: f64| (0..2).filter(|&axis| sides[axis] >= share * picture[axis]).count();
        let is_hollow = blob.fill() < 0.35;
        let encloses = || {
            let inside = |other: &&Blob| {
                let at = other.center.to_array();
                (0..2).all(|axis| at[axis] > blob.min[axis] as f64 && at[axis] < blob.max[axis] as f64)
            };
            // Itself is one.
            kept.iter().filter(inside).take(FEW + 1).count() > FEW
        };
        let is_line = 12.0 * thin <= long && spans(0.4) > 0;
        spans(0.6) == 2 || is_line || is_hollow && (spans(0.4) == 2 || encloses())
    };
    let frames: Vec<bool> = kept.iter().map(is_frame).collect();
    let count = frames.iter().filter(|&&is_frame| is_frame).count();
    if count == 0 || kept.len() - count < FEW {
        return None;
    }
    let mut marks = frames.iter();
    kept.retain(|_| marks.next() == Some(&false));
    let shapes = counted(count, "One large shape was", "large shapes were");
    Some(Note::left_out(format!(
        "{shapes} left out: a frame, an axis or a line, much longer than the {} blobs that were taken for points. Cut the \
         picture if it is in the way.",
        kept.len()
    )))
}

/// Blobs fainter than the threshold, where many are alike, and what to say of them.
///
/// The first threshold lies midway between the ground and the strongest blobs, and may pass over a second kind. Of blobs that
/// leave the ground by more than its noise, those without a pixel beyond the first threshold are candidates; half their
/// median depth is the second threshold.
pub(super) fn fainter(values: &[u8], width: usize, split: &Split, strong: usize) -> (Vec<Blob>, Option<Note>) {
    let none = (Vec::new(), None);
    // Depth below the ground, whichever side that is.
    let level = |value: u8| if split.ink == Ink::Dark { value } else { 255 - value };
    let mut levels = [0; 256];
    for (value, count) in (0..=255_u8).zip(histogram(values)) {
        levels[usize::from(level(value))] = count;
    }
    let limit = if split.ink == Ink::Dark { Some(split.threshold) } else { 254_u8.checked_sub(split.threshold) };
    let Some(limit) = limit.filter(|&limit| limit < 255) else { return none };
    let ground: usize = levels[usize::from(limit) + 1..].iter().sum();
    // The level that this share of the ground lies below.
    let quantile = |share: f64| {
        let mut rest = share * ground as f64;
        let found = (limit + 1..=255).find(|&value| {
            rest -= levels[usize::from(value)] as f64;
            rest <= 0.0
        });
        f64::from(found.unwrap_or(255))
    };
    let middle = quantile(0.5);
    let contrast = middle - moments(&levels, 0..=limit).0;
    // Of normal noise a sixth lies more than one standard deviation below.
    let noise = (middle - quantile(0.16)).max(1.0);
    let low = middle - (6.0 * noise).max(0.15 * contrast).max(6.0);
    if low <= f64::from(limit) {
        return none;
    }
    // The strongest pixel of a blob, as a level.
    let peak = |blob: &Blob| f64::from(if split.ink == Ink::Dark { blob.values[0] } else { 255 - blob.values[1] });
    let below = |most: f64| {
        let mut blobs = components(values, width, |value| f64::from(level(value)) <= most);
        blobs.retain(|blob| peak(blob) > f64::from(limit) && peak(blob) <= low && blob.area >= LEAST_AREA);
        blobs
    };
    let candidates = below(low);
    if candidates.len() < FEW {
        return none;
    }
    let depth = median(&sorted(candidates.iter().map(|blob| middle - peak(blob))));
    let second = middle - depth / 2.0;
    let mut found = below(second);
    let areas = sorted(found.iter().map(|blob| blob.area));
    let own = dirt(&areas);
    found.retain(|blob| blob.area >= own);
    let is_spot = |blob: &&Blob| {
        let [width, height] = blob.sides();
        blob.fill() >= 0.45 && width.max(height) <= 3.0 * width.min(height)
    };
    let spots = found.iter().filter(is_spot).count();
    let alike = are_alike(&sorted(found.iter().map(|blob| blob.area)));
    if spots < FEW || 10 * spots < strong {
        return none;
    }
    let setting = if split.ink == Ink::Dark { second } else { 255.0 - second }.round();
    if !alike || 5 * spots < 4 * found.len() || spots > 10 * strong.max(FEW) {
        let note = Note::left_out(format!(
            "{} fainter than the others were left out, for they are not alike. Set the threshold to about {setting} to have \
             them.",
            counted(found.len(), "One blob", "blobs")
        ));
        return (Vec::new(), Some(note));
    }
    found.retain(|blob| is_spot(&blob));
    let note = Note::changed(format!(
        "{} fainter than the others were found by a second threshold, {setting}, and are points, too. Set the threshold to \
         {} to leave them out.",
        counted(found.len(), "One blob", "blobs"),
        split.threshold
    ));
    (found, Some(note))
}
