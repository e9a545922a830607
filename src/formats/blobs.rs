//! Connected pixels of a picture, and which of them are dirt, frames, or a second kind of spots.

use glam::DVec2;

use crate::sorting;

/// A frame is so many times as long as half of the blobs are.
const FRAME_LENGTHS: f64 = 4.0;
/// And at least so many pixels.
const SHORTEST_FRAME: usize = 16;
/// It fills less than this of its box: an outline, an axis with its marks, a curve.
const FRAME_FILL: f64 = 0.25;
/// A line is so many times as long as it is wide.
const LINE_ASPECT: usize = 8;
/// Fewest pixels of a spot of a second kind: noise has fewer.
const SMALLEST_SPOT: f64 = 4.0;

/// Connected pixels.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Blob {
    /// Their mean, in pixels.
    pub(super) center: DVec2,
    /// How many there are.
    pub(super) area: f64,
    /// First column and row, and those after the last ones.
    low: [usize; 2],
    high: [usize; 2],
    /// Whether one of them is a core.
    pub(super) has_core: bool,
}

impl Blob {
    fn sides(&self) -> [usize; 2] {
        [self.high[0] - self.low[0], self.high[1] - self.low[1]]
    }

    fn length(&self) -> usize {
        self.sides().into_iter().max().unwrap_or_default()
    }

    /// Which part of its box it fills.
    fn fill(&self) -> f64 {
        let [width, height] = self.sides();
        self.area / (width * height) as f64
    }

    /// Whether a place lies in its box.
    pub(super) fn holds(&self, place: DVec2) -> bool {
        let corner = |at: [usize; 2]| DVec2::new(at[0] as f64, at[1] as f64);
        place.cmpge(corner(self.low)).all() && place.cmple(corner(self.high)).all()
    }

    /// Whether it is about as wide as high, and rather full: a disk fills 0.79 of its box, one of 13 pixels 0.52.
    fn is_compact(&self) -> bool {
        let [width, height] = self.sides();
        self.fill() >= 0.5 && 5 * width.max(height) <= 8 * width.min(height).max(1)
    }
}

fn ascending(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    sorting::ascending(&mut values);
    values
}

/// Blobs up to this area are dirt beside the others.
pub(super) fn dirt(blobs: &[Blob]) -> f64 {
    let areas = ascending(blobs.iter().map(|blob| blob.area));
    areas
        .get(areas.len() / 2)
        .map_or(0.0, |median| (median / 4.0).floor() + 1.0)
        .min(areas.last().copied().unwrap_or(0.0))
}

/// Which blobs are frames, axes or lines: much longer than the others, thin, and across a good part of the picture; or along
/// two opposite borders.
pub(super) fn frames(blobs: &[Blob], [width, height]: [usize; 2]) -> Vec<bool> {
    let lengths = ascending(blobs.iter().map(|blob| blob.length() as f64));
    let Some(&median) = lengths.get(lengths.len().saturating_sub(1) / 2) else { return Vec::new() };
    let is_frame = |blob: &Blob| {
        let [wide, high] = blob.sides();
        let length = blob.length();
        let is_long =
            length >= SHORTEST_FRAME && length as f64 >= FRAME_LENGTHS * median && 10 * length >= 3 * width.min(height);
        let is_thin = blob.fill() < FRAME_FILL || wide.max(high) >= LINE_ASPECT * wide.min(high);
        let is_across = wide == width || high == height;
        is_long && (is_thin || is_across)
    };
    let found: Vec<bool> = blobs.iter().map(is_frame).collect();
    // A picture of nothing else is a picture of these.
    if found.iter().all(|is| *is) { vec![false; blobs.len()] } else { found }
}

/// Whether blobs that are smaller or fainter than those that are kept are spots too: a good part of all, of one size, compact.
pub(super) fn second_kind(kept: &[Blob], others: &[Blob]) -> bool {
    if others.len() < 3 || 10 * others.len() < kept.len() || others.len() > 3 * kept.len() {
        return false;
    }
    let areas = ascending(others.iter().map(|blob| blob.area));
    let at = |share: usize| areas[(areas.len() - 1) * share / 10];
    let compact = others.iter().filter(|blob| blob.is_compact()).count();
    at(0) >= SMALLEST_SPOT && at(9) <= 3.0 * at(1) && 10 * compact >= 9 * others.len()
}

/// Connected components by union of the runs of each row with those of the row above, in reading order. Of each pixel it is told
/// whether it belongs to one, and whether it is a core.
pub(super) fn components(levels: &[u8], width: usize, of: impl Fn(u8) -> (bool, bool)) -> Vec<Blob> {
    struct Run {
        start: usize,
        end: usize,
        row: usize,
        has_core: bool,
    }
    fn root(parents: &mut [usize], mut run: usize) -> usize {
        while parents[run] != run {
            // Halves the way for the next one.
            parents[run] = parents[parents[run]];
            run = parents[run];
        }
        run
    }
    let kinds: Vec<(bool, bool)> = (0..=u8::MAX).map(of).collect();
    let is_ink = |level: u8| kinds[usize::from(level)].0;
    let mut runs: Vec<Run> = Vec::new();
    let mut parents: Vec<usize> = Vec::new();
    let mut above = 0..0;
    for (row, pixels) in levels.chunks_exact(width).enumerate() {
        let first = runs.len();
        let mut column = 0;
        while column < pixels.len() {
            if !is_ink(pixels[column]) {
                column += 1;
                continue;
            }
            let start = column;
            let mut has_core = false;
            while column < pixels.len() && is_ink(pixels[column]) {
                has_core |= kinds[usize::from(pixels[column])].1;
                column += 1;
            }
            let run = runs.len();
            parents.push(run);
            runs.push(Run { start, end: column, row, has_core });
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
            let (low, high) = ([run.start, run.row], [run.end, run.row + 1]);
            blobs.push(Blob { center: DVec2::ZERO, area: 0.0, low, high, has_core: false });
        }
        let blob = &mut blobs[places[top]];
        let length = (run.end - run.start) as f64;
        blob.area += length;
        // Of the pixels' middles.
        blob.center += length * DVec2::new((run.start + run.end) as f64 / 2.0, run.row as f64 + 0.5);
        blob.low[0] = blob.low[0].min(run.start);
        blob.high = [blob.high[0].max(run.end), run.row + 1];
        blob.has_core |= run.has_core;
    }
    for blob in &mut blobs {
        blob.center /= blob.area;
    }
    blobs
}
