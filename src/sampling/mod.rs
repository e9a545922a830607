//! The one random generator, and ways to scatter points.
//!
//! A share link promises the same start for ever, so the bit stream (ChaCha8) and every distribution drawn from it
//! are ours to keep: golden values in the tests hold them.

mod lloyd;
mod poisson_disk;
mod rng;

pub use lloyd::{lloyd_step, wrap};
pub use poisson_disk::poisson_disk;
pub use rng::{Purpose, Rng};

use glam::DVec2;

/// `count` independent uniform points in `[0, size.x) × [0, size.y)`.
#[must_use]
pub fn white_noise(rng: &mut Rng, size: DVec2, count: usize) -> Vec<DVec2> {
    (0..count).map(|_| DVec2::new(rng.uniform(), rng.uniform()) * size).collect()
}
