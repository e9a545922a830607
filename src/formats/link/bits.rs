//! Numbers as bits, the lowest of a byte first.

/// Longest lower part of a Rice code: a step along a side has 16 bits.
const MAX_LOW_BITS: u32 = 16;

/// Appends bits.
#[derive(Debug, Default)]
pub(super) struct BitWriter {
    bytes: Vec<u8>,
    /// How many bits of the last byte are taken; 0 when it is full.
    taken: u32,
}

impl BitWriter {
    fn bit(&mut self, bit: bool) {
        if self.taken == 0 {
            self.bytes.push(0);
        }
        if let Some(last) = self.bytes.last_mut() {
            *last |= u8::from(bit) << self.taken;
        }
        self.taken = (self.taken + 1) % 8;
    }

    /// The lowest `count` bits, the highest of them first.
    fn bits(&mut self, number: u32, count: u32) {
        (0..count).rev().for_each(|bit| self.bit(number >> bit & 1 == 1));
    }

    /// A number below `count`, all of them as likely: the first of them take one bit less when `count` is no power of
    /// two.
    pub(super) fn below(&mut self, number: u32, count: u32) {
        let (bits, short) = truncated(count);
        if number < short { self.bits(number, bits) } else { self.bits(number + short, bits + 1) }
    }

    /// Numbers of which the larger are the rarer, as steps from one random point to the next: how many lower bits there
    /// are, in five bits; then of each number the upper part as so many ones and a zero, and the lower bits.
    pub(super) fn rice(&mut self, numbers: &[u32]) {
        let length = |low: u32| numbers.iter().map(|number| u64::from((number >> low) + 1 + low)).sum::<u64>();
        let low = (0..=MAX_LOW_BITS).min_by_key(|&low| length(low)).unwrap_or(0);
        self.bits(low, 5);
        for &number in numbers {
            (0..number >> low).for_each(|_| self.bit(true));
            self.bit(false);
            self.bits(number, low);
        }
    }

    pub(super) fn bytes(self) -> Vec<u8> {
        self.bytes
    }
}

/// Reads what [`BitWriter`] has written; `None` where the bytes end.
#[derive(Debug)]
pub(super) struct BitReader<'a> {
    bytes: &'a [u8],
    next: usize,
}

impl<'a> BitReader<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, next: 0 }
    }

    fn bit(&mut self) -> Option<u32> {
        let byte = *self.bytes.get(self.next / 8)?;
        let bit = byte >> (self.next % 8) & 1;
        self.next += 1;
        Some(bit.into())
    }

    fn bits(&mut self, count: u32) -> Option<u32> {
        (0..count).try_fold(0, |number, _| Some(number << 1 | self.bit()?))
    }

    pub(super) fn below(&mut self, count: u32) -> Option<u32> {
        let (bits, short) = truncated(count);
        let number = self.bits(bits)?;
        if number < short { Some(number) } else { Some((number << 1 | self.bit()?) - short) }
    }

    /// As many numbers, none larger than the bits that are left have room for.
    pub(super) fn rice(&mut self, count: usize) -> Option<Vec<u32>> {
        let low = self.bits(5).filter(|&low| low <= MAX_LOW_BITS)?;
        (0..count)
            .map(|_| {
                let mut high = 0;
                while self.bit()? == 1 {
                    high += 1;
                }
                // At most 400 kB of ones, shifted by 16.
                Some(high.min(0xffff) << low | self.bits(low)?)
            })
            .collect()
    }
}

/// Truncated binary: how many bits the short codes have, and how many of them there are. The long ones have one more.
fn truncated(count: u32) -> (u32, u32) {
    let bits = count.max(1).ilog2();
    (bits, (2 << bits) - count.max(1))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may stop at the first surprise")]
    use super::*;

    #[test]
    fn numbers_below_a_bound_take_the_bits_they_need() {
        for count in [1, 2, 3, 5, 8, 13, 257, 4096, 65_536] {
            let mut writer = BitWriter::default();
            let numbers: Vec<u32> = (0..count).step_by(1 + count as usize / 300).chain([count - 1]).collect();
            numbers.iter().for_each(|&number| writer.below(number, count));
            let bytes = writer.bytes();
            assert!(bytes.len() <= (numbers.len() * f64::from(count).log2().ceil() as usize).div_ceil(8));
            let mut reader = BitReader::new(&bytes);
            assert!(numbers.iter().all(|&number| reader.below(count) == Some(number)), "{count}");
        }
        assert_eq!(BitReader::new(&[]).below(2), None);
        assert_eq!(BitReader::new(&[]).below(1), Some(0));
    }

    #[test]
    fn steps_come_back_whatever_their_size() {
        for numbers in [vec![], vec![0; 9], vec![65_535], vec![0, 1, 200, 3, 65_535, 0], (0..400).collect()] {
            let mut writer = BitWriter::default();
            writer.rice(&numbers);
            let bytes = writer.bytes();
            assert_eq!(BitReader::new(&bytes).rice(numbers.len()).unwrap(), numbers);
            assert_eq!(BitReader::new(&bytes[..bytes.len() - 1]).rice(numbers.len() + 8), None);
        }
        // Seventeen lower bits and more are nothing a step can have; ones without end are no number.
        assert_eq!(BitReader::new(&[0b11111]).rice(0), None);
        assert_eq!(BitReader::new(&[0xff; 100]).rice(1), None);
    }
}
