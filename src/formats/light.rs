//! Thresholds of a picture, and its ground where light falls on it unevenly.

/// Pixels along a tile's side, at least; and tiles along the picture's.
const TILE: usize = 24;
const TILES: [usize; 2] = [4, 12];
/// Least difference of the ground's brightness that is looked at.
const UNEVEN: u8 = 24;
/// Least difference of faint spots from the ground, and how many times its scatter it is.
const FAINT: f64 = 12.0;
const SCATTERS: f64 = 6.0;

pub(super) fn histogram(levels: &[u8]) -> [usize; 256] {
    let mut histogram = [0; 256];
    for &value in levels {
        histogram[usize::from(value)] += 1;
    }
    histogram
}

/// The threshold that parts the pixels into the two most different groups (Otsu 1979). Between two groups with nothing
/// in between it is the middle of the gap.
pub(super) fn otsu(histogram: &[usize; 256]) -> u8 {
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

/// The middle value.
fn median(histogram: &[usize; 256]) -> u8 {
    let half = histogram.iter().sum::<usize>().div_ceil(2);
    let mut count = 0;
    for level in 0..=u8::MAX {
        count += histogram[usize::from(level)];
        if count >= half {
            return level;
        }
    }
    u8::MAX
}

/// From where on spots that are fainter than the threshold stand out from the ground: beyond its commonest level by several
/// times its scatter, and less than half way to what is beyond the threshold.
pub(super) fn faint_threshold(histogram: &[usize; 256], threshold: u8, is_dark: bool) -> Option<u8> {
    let is_ink = |level: u8| (level <= threshold) == is_dark;
    let (mut ground, mut ink, mut inked) = ([0; 256], 0.0, 0.0);
    for level in 0..=u8::MAX {
        let count = histogram[usize::from(level)];
        if is_ink(level) {
            ink += count as f64 * f64::from(level);
            inked += count as f64;
        } else {
            ground[usize::from(level)] = count;
        }
    }
    let most = ground.iter().max().copied().filter(|&most| most > 0)?;
    let mode = ground.iter().position(|&count| count == most)? as f64;
    let mut gaps = [0; 256];
    for (level, &count) in ground.iter().enumerate() {
        // Between two levels up to 255.
        gaps[(level as f64 - mode).abs() as usize] += count;
    }
    // 1.48 times the median distance is the standard deviation of a normal distribution.
    let step = f64::max(FAINT, SCATTERS * 1.48 * f64::from(median(&gaps)));
    if inked == 0.0 || 2.0 * step > (ink / inked - mode).abs() {
        return None;
    }
    // Between the two.
    let level = if is_dark { mode - step } else { mode + step } as u8;
    (!is_ink(level)).then_some(level)
}

/// The brightness of the ground, tile by tile.
#[derive(Debug)]
pub(super) struct Light {
    across: usize,
    down: usize,
    ground: Vec<f64>,
}

impl Light {
    /// None where one threshold does for the whole picture: where the ground, the median of each tile, is on one side of Otsu's
    /// threshold everywhere; or where it changes by steps, as large blobs do.
    pub(super) fn of(levels: &[u8], [width, height]: [usize; 2]) -> Option<Self> {
        if width.min(height) < TILES[0] * TILE / 2 {
            return None;
        }
        let tiles = |side: usize| (side / TILE).clamp(TILES[0], TILES[1]);
        let (across, down) = (tiles(width), tiles(height));
        let mut histograms = vec![[0_usize; 256]; across * down];
        for (row, pixels) in levels.chunks_exact(width).enumerate() {
            for (column, &level) in pixels.iter().enumerate() {
                histograms[row * down / height * across + column * across / width][usize::from(level)] += 1;
            }
        }
        let ground: Vec<u8> = histograms.iter().map(median).collect();
        let mut all = [0; 256];
        histograms.iter().for_each(|one| all.iter_mut().zip(one).for_each(|(sum, count)| *sum += count));
        let threshold = otsu(&all);
        let dark = ground.iter().filter(|&&level| level <= threshold).count();
        let (low, high) = (ground.iter().min().copied()?, ground.iter().max().copied()?);
        if dark == 0 || dark == ground.len() || high - low < UNEVEN {
            return None;
        }
        let at = |column: usize, row: usize| ground[row * across + column];
        let (mut pairs, mut steps) = (0, 0);
        for row in 0..down {
            for column in 0..across {
                let right = (column + 1 < across).then(|| at(column + 1, row));
                let below = (row + 1 < down).then(|| at(column, row + 1));
                for other in [right, below].into_iter().flatten() {
                    pairs += 1;
                    steps += usize::from(2 * u16::from(other.abs_diff(at(column, row))) > u16::from(high - low));
                }
            }
        }
        if 100 * steps > pairs {
            return None;
        }
        // A tile that a blob covers is told by those around it.
        let smooth = |column: usize, row: usize| {
            let mut around: Vec<u8> = Vec::with_capacity(9);
            for row in row.saturating_sub(1)..(row + 2).min(down) {
                around.extend((column.saturating_sub(1)..(column + 2).min(across)).map(|column| at(column, row)));
            }
            around.sort_unstable();
            let middle = around[around.len() / 2];
            let own = at(column, row);
            f64::from(if own.abs_diff(middle) > (high - low) / 3 { middle } else { own })
        };
        let ground = (0..across * down).map(|tile| smooth(tile % across, tile / across)).collect();
        Some(Self { across, down, ground })
    }

    /// The picture as if its ground were alike everywhere: reflected light is a share of what falls on it, and light from within
    /// adds to the ground.
    pub(super) fn evened(&self, levels: &[u8], [width, height]: [usize; 2]) -> Vec<u8> {
        /// What the ground becomes where light adds to it.
        const DARK: f64 = 48.0;
        /// What it becomes where it reflects.
        const LIGHT: f64 = 224.0;
        let reflects = self.ground.iter().sum::<f64>() >= 128.0 * self.ground.len() as f64;
        // The middles of the tiles on either side, and how far it is from the first; beyond the last ones as before them.
        let between = |at: usize, side: usize, tiles: usize| {
            let place = (at as f64 + 0.5) * tiles as f64 / side as f64 - 0.5;
            let first = (place.floor().max(0.0) as usize).min(tiles - 2);
            (first, place - first as f64)
        };
        let columns: Vec<(usize, f64)> = (0..width).map(|column| between(column, width, self.across)).collect();
        let mut evened = Vec::with_capacity(levels.len());
        for (row, pixels) in levels.chunks_exact(width).enumerate() {
            let (upper, down) = between(row, height, self.down);
            let of = |column: usize| {
                let [above, below] = [upper, upper + 1].map(|row| self.ground[row * self.across + column]);
                above + down * (below - above)
            };
            let line: Vec<f64> = (0..self.across).map(of).collect();
            evened.extend(pixels.iter().zip(&columns).map(|(&level, &(left, along))| {
                let ground = line[left] + along * (line[left + 1] - line[left]);
                let level = f64::from(level);
                let even = if reflects { level * LIGHT / ground.max(1.0) } else { level - ground + DARK };
                // Saturates.
                even.round() as u8
            }));
        }
        evened
    }
}
