//! Lanes: several `f64` side by side, one sample in each, with the same bits on every machine.
//!
//! A [`Lanes`] type is a handful of `f64` that take every operation together. Each operation is one that
//! IEEE 754 rounds exactly (`+ − × ÷ √` and the fused multiply-add), so a lane's result depends on
//! neither its neighbours nor the instruction set: a kernel written once over this trait gives the same
//! bits in one `f64`, in AVX2 and in AVX-512 registers. [`elementary`] builds `exp` and `ln` from them.
//!
//! Explicit registers were preferred to plain `[f64; 8]` arrays: with arrays the vectoriser has to find
//! eight independent copies of some thousand operations again, and masks and integer shifts (in `exp`)
//! made it fall back to scalar code.

#[cfg(target_arch = "x86_64")]
pub mod avx2;
#[cfg(target_arch = "x86_64")]
pub mod avx512;
pub mod elementary;
mod instruction_set;
mod pair;
mod scalar;
mod tangent;
mod wide;

pub use instruction_set::InstructionSet;
pub use pair::Pair;
use std::ops::{Add, Div, Mul, Neg, Sub};
pub use tangent::Tangent;
pub use wide::Wide;

/// The magic number 1.5 · 2⁵²: adding it rounds a small number to a whole one, which then stands in the
/// low bits of the sum.
pub const MAGIC: f64 = 6_755_399_441_055_744.0;

/// A comparison's result, lane by lane.
pub trait Mask: Copy {
    /// Both.
    fn and(self, other: Self) -> Self;
    /// Either.
    fn or(self, other: Self) -> Self;
    /// Neither: the opposite.
    fn not(self) -> Self;
    /// Bit `k` is set where lane `k` is true.
    fn bits(self) -> u32;
    /// Whether any lane is true.
    #[inline(always)]
    fn any(self) -> bool {
        self.bits() != 0
    }
}

/// Several `f64` side by side.
///
/// # Safety
/// An implementor begins with `WIDTH` consecutive `f64` in memory, lane 0 first.
pub unsafe trait Lanes:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// How many.
    const WIDTH: usize;
    /// A comparison's result.
    type Mask: Mask;

    /// The same value in every lane.
    fn splat(value: f64) -> Self;
    /// The values without derivatives, for lanes that carry any.
    #[inline(always)]
    fn detached(self) -> Self {
        self
    }
    /// `self · factor + term`, rounded once.
    fn mul_add(self, factor: Self, term: Self) -> Self;
    /// `term − self · factor`, rounded once.
    fn neg_mul_add(self, factor: Self, term: Self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// The larger; `other` where either is not a number.
    fn max(self, other: Self) -> Self;
    /// The smaller; `other` where either is not a number.
    fn min(self, other: Self) -> Self;
    /// Whether smaller; false where either is not a number.
    fn lt(self, other: Self) -> Self::Mask;
    /// Whether smaller or equal; false where either is not a number.
    fn le(self, other: Self) -> Self::Mask;
    /// `self` where the mask is true, `other` elsewhere.
    fn select(mask: Self::Mask, this: Self, other: Self) -> Self;
    /// Roughly `self^(−1/4)`, to 4 %, for a positive normal number: a quarter of the exponent, and the
    /// mantissa for what it is. See [`elementary::inverse_fourth_root`].
    fn inverse_fourth_root_estimate(self) -> Self;
    /// `2^k`, where `self` is `k` + [`MAGIC`] with −1022 ≤ k ≤ 1023.
    fn power_of_two(self) -> Self;
    /// A positive normal number as `(k, z)` with `self = 2^k z` and `z` in [√½, √2).
    fn split(self) -> (Self, Self);

    /// The lanes as a slice.
    #[inline(always)]
    fn lanes(&self) -> &[f64] {
        // SAFETY: an implementor begins with WIDTH consecutive f64 (the trait's contract).
        unsafe { std::slice::from_raw_parts((self as *const Self).cast::<f64>(), Self::WIDTH) }
    }
    /// The lanes as a slice that can be written.
    #[inline(always)]
    fn lanes_mut(&mut self) -> &mut [f64] {
        // SAFETY: an implementor begins with WIDTH consecutive f64 (the trait's contract).
        unsafe { std::slice::from_raw_parts_mut((self as *mut Self).cast::<f64>(), Self::WIDTH) }
    }
}
