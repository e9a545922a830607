//! The two number types the engine is written for: `f32` runs, `f64` checks the gradients.

use std::fmt::{Debug, Display};
use std::iter::Sum;
use std::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use rustfft::FftNum;

use super::product::{Lines, Pieces};

/// A real number of the engine. Transcendentals go through `libm`, so that the tables of the Gabor stage are the same
/// bits natively and in wasm.
pub trait Real:
    FftNum
    + Copy
    + Default
    + Debug
    + Display
    + PartialOrd
    + Send
    + Sync
    + Sum
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + 'static
{
    /// The number 0.
    const ZERO: Self;
    /// The number 1.
    const ONE: Self;
    /// Rounds a double to this type.
    fn rounded(value: f64) -> Self;
    /// Widens to a double.
    fn wide(self) -> f64;
    /// Exponential.
    fn exp(self) -> Self;
    /// Sine and cosine.
    fn sin_cos(self) -> (Self, Self);
    /// `self · b + c` in one rounding. Only called where the hardware has it: elsewhere it is a slow emulation.
    fn fused(self, b: Self, c: Self) -> Self;
    /// Does the product of [`super::product::complex`] if there is a faster way to the same bits for this type on this
    /// machine. Returns whether; if not, nothing is written.
    fn faster_complex<const CONJUGATE: bool>(
        _x: Pieces<Self>,
        _w: &[Self],
        _columns: usize,
        _y: &mut Lines<Self>,
    ) -> bool {
        false
    }
    /// The same for a transposition of `rows × columns` numbers, both multiples of [`super::lanes::LANES`].
    fn faster_transpose(_from: &[Self], _to: &mut [Self], _rows: usize, _columns: usize) -> bool {
        false
    }
}

impl Real for f32 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    #[inline(always)]
    fn rounded(value: f64) -> Self {
        value as Self
    }
    #[inline(always)]
    fn wide(self) -> f64 {
        self.into()
    }
    fn exp(self) -> Self {
        libm::expf(self)
    }
    fn sin_cos(self) -> (Self, Self) {
        libm::sincosf(self)
    }
    #[inline(always)]
    fn fused(self, b: Self, c: Self) -> Self {
        self.mul_add(b, c)
    }
    #[cfg(target_arch = "x86_64")]
    fn faster_complex<const CONJUGATE: bool>(x: Pieces<Self>, w: &[Self], columns: usize, y: &mut Lines<Self>) -> bool {
        super::x86::complex::<CONJUGATE>(x, w, columns, y)
    }
    #[cfg(target_arch = "x86_64")]
    fn faster_transpose(from: &[Self], to: &mut [Self], rows: usize, columns: usize) -> bool {
        super::x86::transpose(from, to, rows, columns)
    }
}

impl Real for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    #[inline(always)]
    fn rounded(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn wide(self) -> f64 {
        self
    }
    fn exp(self) -> Self {
        libm::exp(self)
    }
    fn sin_cos(self) -> (Self, Self) {
        libm::sincos(self)
    }
    #[inline(always)]
    fn fused(self, b: Self, c: Self) -> Self {
        self.mul_add(b, c)
    }
}
