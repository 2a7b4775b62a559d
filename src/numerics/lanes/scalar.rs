//! One lane: a plain `f64`. This is the portable path and the scalar twin of the vector kernels.

use super::{Lanes, Mask};

impl Mask for bool {
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        self & other
    }
    #[inline(always)]
    fn or(self, other: Self) -> Self {
        self | other
    }
    #[inline(always)]
    fn not(self) -> Self {
        !self
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        u32::from(self)
    }
}

/// Bits of √½, the lower end of the range of a split number.
pub(super) const SQRT_HALF_BITS: u64 = 0x3fe6_a09e_667f_3bcd;
/// Bits of 2⁵², whose low bits hold a whole number below 2⁵².
pub(super) const TWO_52_BITS: u64 = 0x4330_0000_0000_0000;
/// 2⁵² plus the exponent's bias.
pub(super) const TWO_52_AND_BIAS: f64 = 4_503_599_627_370_496.0 + 1023.0;
/// The bits of 1.0: the exponent's bias in place.
pub(super) const ONE_BITS: u64 = 0x3ff0_0000_0000_0000;

/// Five quarters of the exponent's bias, less what makes the estimate of the inverse fourth root best.
pub(super) const FOURTH_ROOT_BITS: u64 = 0x4feb_07ae_147a_e000;

// SAFETY: an f64 is one f64.
unsafe impl Lanes for f64 {
    const WIDTH: usize = 1;
    type Mask = bool;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        f64::mul_add(self, factor, term)
    }
    #[inline(always)]
    fn neg_mul_add(self, factor: Self, term: Self) -> Self {
        f64::mul_add(-self, factor, term)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self < other
    }
    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self <= other
    }
    #[inline(always)]
    fn select(mask: bool, this: Self, other: Self) -> Self {
        if mask { this } else { other }
    }
    #[inline(always)]
    fn inverse_fourth_root_estimate(self) -> Self {
        f64::from_bits(FOURTH_ROOT_BITS.wrapping_sub(self.to_bits() >> 2))
    }
    #[inline(always)]
    fn power_of_two(self) -> Self {
        f64::from_bits((self.to_bits() << 52).wrapping_add(ONE_BITS))
    }
    #[inline(always)]
    fn split(self) -> (Self, Self) {
        let bits = self.to_bits();
        let exponent = bits.wrapping_sub(SQRT_HALF_BITS).wrapping_add(ONE_BITS) >> 52;
        let whole = f64::from_bits(exponent | TWO_52_BITS) - TWO_52_AND_BIAS;
        let rest = f64::from_bits(bits.wrapping_sub(exponent << 52).wrapping_add(ONE_BITS));
        (whole, rest)
    }
}
