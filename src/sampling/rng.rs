//! ChaCha8 with named streams and our own distributions.

use rand_chacha::ChaCha8Rng;
use rand_core::{Rng as _, SeedableRng};

/// What a stream of random numbers is for. Streams of one seed are independent, so that adding a draw to one never
/// changes another. The numbers are part of the promise of a share link: never renumber.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// The start positions of a class.
    Start(u16),
    /// The weights of the filter bank.
    Filters,
    /// The grid jitter of one iteration of a class and scale.
    Jitter {
        /// Class, from 0.
        class: u16,
        /// Scale, from 0.
        scale: u16,
        /// Iteration within the scale.
        iteration: u32,
    },
    /// The assignment of attribute values to the points of a class.
    Attributes(u16),
    /// The exchange of attribute values between the points of a class, after a scale.
    Exchange {
        /// Class, from 0.
        class: u16,
        /// Scale, from 0.
        scale: u16,
    },
    /// A gallery exemplar.
    Gallery,
    /// One of the random patterns that statistics are compared with.
    Analysis(u32),
    /// The shaking before another try at the worst regions of a class.
    Restart {
        /// Class, from 0.
        class: u16,
        /// Which try, from 0.
        restart: u32,
    },
    /// The fresh start of a class in a region that is done again.
    Region {
        /// Class, from 0.
        class: u16,
        /// Which of the run's regions, from 1.
        redo: u32,
    },
}

impl Purpose {
    fn stream(self) -> u64 {
        match self {
            Self::Filters => 1,
            Self::Gallery => 2,
            Self::Start(class) => (3 << 56) | u64::from(class),
            Self::Attributes(class) => (4 << 56) | u64::from(class),
            Self::Analysis(pattern) => (6 << 56) | u64::from(pattern),
            Self::Restart { class, restart } => (7 << 56) | (u64::from(class) << 32) | u64::from(restart),
            Self::Exchange { class, scale } => (8 << 56) | (u64::from(class) << 16) | u64::from(scale),
            Self::Region { class, redo } => (9 << 56) | (u64::from(class) << 32) | u64::from(redo),
            Self::Jitter { class, scale, iteration } => {
                (5 << 56) | (u64::from(class & 0xff) << 48) | (u64::from(scale) << 32) | u64::from(iteration)
            }
        }
    }
}

/// The one random generator of the project: ChaCha8 (`rand_chacha`), seeded by a number, split by purpose.
#[derive(Clone, Debug)]
pub struct Rng(ChaCha8Rng);

impl Rng {
    /// The stream of `seed` for `purpose`.
    #[must_use]
    pub fn new(seed: u64, purpose: Purpose) -> Self {
        let mut key = [0_u8; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        let mut rng = ChaCha8Rng::from_seed(key);
        rng.set_stream(purpose.stream());
        Self(rng)
    }

    /// The next 32 random bits.
    pub fn bits(&mut self) -> u32 {
        self.0.next_u32()
    }

    /// Uniform in `[0, 1)`, with all 53 bits of a double.
    pub fn uniform(&mut self) -> f64 {
        let (high, low) = (u64::from(self.bits()), u64::from(self.bits()));
        ((high << 21) ^ (low >> 11)) as f64 * (1.0 / 9_007_199_254_740_992.0)
    }

    /// Uniform in `[low, high)`.
    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// Uniform in `0 … count − 1`; `count` must be positive. The bias is below 2⁻³² · count.
    pub fn index(&mut self, count: usize) -> usize {
        ((u64::from(self.bits()) * count as u64) >> 32) as usize
    }

    /// Standard normal, by Box–Muller (one of the pair; the other is dropped to keep the stream stateless).
    pub fn normal(&mut self) -> f64 {
        let radius = libm::sqrt(-2.0 * libm::log(1.0 - self.uniform()));
        radius * libm::cos(std::f64::consts::TAU * self.uniform())
    }

    /// Poisson-distributed with the given mean (Knuth's product; meant for means below about 100).
    pub fn poisson(&mut self, mean: f64) -> usize {
        let limit = libm::exp(-mean);
        let mut product = self.uniform();
        let mut count = 0;
        while product > limit {
            product *= self.uniform();
            count += 1;
        }
        count
    }

    /// Puts a list into random order (Fisher–Yates).
    pub fn shuffle<T>(&mut self, list: &mut [T]) {
        for last in (1..list.len()).rev() {
            list.swap(last, self.index(last + 1));
        }
    }
}
