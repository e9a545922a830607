//! Uneven light: pixels are compared with the ground around them, instead of with one threshold.

use super::picture::{Blob, BlobOptions, Ink, Split};

/// How far apart ink and ground have to be, in standard deviations of the ground. The halves of a ramp are 3.5 apart, those of
/// normal noise 2.6.
const CLEAR: f64 = 4.0;
/// The side of the square that a pixel is compared with, as a share of the picture's shorter side.
const SHARE: f64 = 0.2;
/// Shortest half side of the square, in pixels.
const LEAST: usize = 4;

/// Whether a blob is a part of the ground: a sixteenth of the picture at its border, larger than the others by far.
fn is_region(blob: &Blob, others: f64, [width, height]: [usize; 2]) -> bool {
    let at_border = blob.min.contains(&0) || blob.max[0] == width || blob.max[1] == height;
    at_border && 16.0 * blob.area >= (width * height) as f64 && blob.fill() >= 0.25 && blob.area >= 10.0 * others
}

fn has_region(split: &Split, size: [usize; 2]) -> bool {
    let areas: Vec<f64> = split.blobs.iter().map(|blob| blob.area).collect();
    let order = crate::sorting::order(areas.iter().copied());
    let others = match order.as_slice() {
        [_] | [] => 0.0,
        order => areas[order[(order.len() - 1) / 2]],
    };
    split.blobs.iter().any(|blob| is_region(blob, others, size))
}

/// Differences from the ground, 128 for none, and what they are split into, where one threshold for the whole picture fails
/// and these do not. It fails when a part of the ground is on the side of the ink, or when both sides are not clearly apart
/// and a fourth more points are found by the differences.
pub(super) fn even(
    values: &[u8],
    size: [usize; 2],
    split: &Split,
    options: &BlobOptions,
    count: impl Fn(&Split) -> usize,
) -> Option<(Vec<u8>, Split)> {
    let fails = has_region(split, size);
    if !fails && split.separation >= CLEAR {
        return None;
    }
    let [width, height] = size;
    let half = ((SHARE / 2.0 * width.min(height) as f64) as usize).max(LEAST);
    let first = differences(values, size, half, |_| true);
    let rough = Split::of(&first, width, options);
    // Once more, with the ground alone.
    let flat = differences(values, size, half, |index| !rough.is_ink(first[index]));
    let local = Split::of(&flat, width, options);
    let found = count(&local);
    let is_better = local.separation >= CLEAR.max(1.5 * split.separation) && !has_region(&local, size) && found >= 3;
    let is_needed = fails || 4 * found > 5 * count(split);
    // Ink and ground must not change sides.
    let is_same = options.ink == Ink::Auto || local.ink == options.ink;
    (is_better && is_needed && is_same).then_some((flat, local))
}

/// Every value less the mean of the ground in a square around it, plus 128.
fn differences(values: &[u8], [width, height]: [usize; 2], half: usize, is_ground: impl Fn(usize) -> bool) -> Vec<u8> {
    // Sums and counts of the columns of the square's rows: of all pixels, and of the ground.
    let mut columns = vec![[0_u32; 4]; width];
    let change = |columns: &mut Vec<[u32; 4]>, row: usize, is_added: bool| {
        for (column, sums) in columns.iter_mut().enumerate() {
            let index = row * width + column;
            let value = u32::from(values[index]);
            let ground = u32::from(is_ground(index));
            for (sum, part) in sums.iter_mut().zip([value, 1, ground * value, ground]) {
                *sum = if is_added { *sum + part } else { *sum - part };
            }
        }
    };
    let mut flat = Vec::with_capacity(values.len());
    (0..half.min(height)).for_each(|row| change(&mut columns, row, true));
    for row in 0..height {
        if row + half < height {
            change(&mut columns, row + half, true);
        }
        if row > half {
            change(&mut columns, row - half - 1, false);
        }
        // The square's sums: at most 2^24 pixels of at most 255.
        let mut sums = [0_u32; 4];
        let add = |sums: &mut [u32; 4], column: usize, is_added: bool| {
            for (sum, part) in sums.iter_mut().zip(columns[column]) {
                *sum = if is_added { *sum + part } else { *sum - part };
            }
        };
        (0..half.min(width)).for_each(|column| add(&mut sums, column, true));
        for column in 0..width {
            if column + half < width {
                add(&mut sums, column + half, true);
            }
            if column > half {
                add(&mut sums, column - half - 1, false);
            }
            let [sum, count] = if sums[3] > 0 { [sums[2], sums[3]] } else { [sums[0], sums[1]] };
            let mean = f64::from(sum) / f64::from(count.max(1));
            let difference = 128.0 + f64::from(values[row * width + column]) - mean;
            // Saturates.
            flat.push(difference.round() as u8);
        }
    }
    flat
}
