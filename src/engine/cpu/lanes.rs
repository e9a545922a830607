//! Eight channels side by side: the unit in which the engine computes.
//!
//! Activations are stored `[height, width, channels]` with the channels padded to a multiple of [`LANES`], so that
//! one pixel of eight channels is one contiguous vector. Plain arrays and loops of fixed length: the compiler turns
//! them into 256-bit instructions where [`run`] finds them at run time, and into 128-bit ones in wasm. No operation
//! in here contracts a product and a sum, so results are the same bits whatever the instruction set.

use std::ops::{Add, Mul, Sub};

use super::real::Real;

/// Channels in a vector.
pub const LANES: usize = 8;

/// The least multiple of [`LANES`] that holds `channels`.
#[must_use]
pub const fn padded(channels: usize) -> usize {
    channels.div_ceil(LANES) * LANES
}

/// One value of eight neighbouring channels.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub struct Lanes<T>(pub [T; LANES]);

impl<T: Real> Lanes<T> {
    /// All zero.
    pub const ZERO: Self = Self([T::ZERO; LANES]);

    /// Reads the first eight values of `from`.
    #[inline(always)]
    pub fn load(from: &[T]) -> Self {
        let mut lanes = Self::ZERO;
        lanes.0.copy_from_slice(&from[..LANES]);
        lanes
    }

    /// Writes to the first eight values of `to`.
    #[inline(always)]
    pub fn store(self, to: &mut [T]) {
        to[..LANES].copy_from_slice(&self.0);
    }

    /// Every lane times one number.
    #[inline(always)]
    pub fn scale(self, factor: T) -> Self {
        Self(std::array::from_fn(|lane| self.0[lane] * factor))
    }

    /// Every lane negated.
    #[inline(always)]
    pub fn negate(self) -> Self {
        Self(std::array::from_fn(|lane| -self.0[lane]))
    }
}

impl<T: Real> Add for Lanes<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|lane| self.0[lane] + other.0[lane]))
    }
}

impl<T: Real> Sub for Lanes<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(std::array::from_fn(|lane| self.0[lane] - other.0[lane]))
    }
}

impl<T: Real> Mul for Lanes<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(std::array::from_fn(|lane| self.0[lane] * other.0[lane]))
    }
}

/// A piece of arithmetic that is compiled once for every instruction set.
pub trait Kernel {
    /// Does the work. `FMA` says whether the hardware has a fused multiply-add.
    fn run<const FMA: bool>(self);
}

/// Runs a kernel with the widest instructions this machine has.
#[cfg(target_arch = "x86_64")]
pub fn run<K: Kernel>(kernel: K) {
    struct Wrapped<K>(K);
    impl<K: Kernel> pulp::WithSimd for Wrapped<K> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: pulp::Simd>(self, _simd: S) {
            // Eight f32 lanes mean AVX2 with FMA (x86-64-v3); one lane means neither.
            if S::F32_LANES >= 8 {
                self.0.run::<true>();
            } else {
                self.0.run::<false>();
            }
        }
    }
    // Not `Arch::dispatch`, which would take AVX-512: there the compiler takes loops over eight lanes apart.
    if let Some(simd) = pulp::x86::V3::try_new() {
        pulp::Simd::vectorize(simd, Wrapped(kernel));
    } else {
        pulp::Simd::vectorize(pulp::Scalar, Wrapped(kernel));
    }
}

/// Runs a kernel with the instructions this build was made for. Not inlined: a module over the wire should hold each
/// kernel once.
#[inline(never)]
#[cfg(not(target_arch = "x86_64"))]
pub fn run<K: Kernel>(kernel: K) {
    kernel.run::<{ cfg!(target_arch = "aarch64") }>();
}
