//! Four lanes in one AVX register.
//!
//! Every method is inlined into a kernel that was entered through a function with
//! `#[target_feature(enable = "avx2,fma")]`; nothing else may call them.

use super::scalar::{FOURTH_ROOT_BITS, ONE_BITS, SQRT_HALF_BITS, TWO_52_AND_BIAS, TWO_52_BITS};
use super::{Lanes, Mask};
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Four `f64`. Only a function with the target features of AVX2 and FMA may use it.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct Quartet(__m256d);

macro_rules! operator {
    ($trait:ident, $method:ident, $intrinsic:ident) => {
        impl $trait for Quartet {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: see the module.
                Quartet(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    };
}
operator!(Add, add, _mm256_add_pd);
operator!(Sub, sub, _mm256_sub_pd);
operator!(Mul, mul, _mm256_mul_pd);
operator!(Div, div, _mm256_div_pd);

impl Neg for Quartet {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: see the module.
        Quartet(unsafe { _mm256_xor_pd(self.0, _mm256_set1_pd(-0.0)) })
    }
}

/// A comparison's result: all bits of a lane set or none.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct QuartetMask(__m256d);

impl Mask for QuartetMask {
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        // SAFETY: see the module; so too below.
        QuartetMask(unsafe { _mm256_and_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn or(self, other: Self) -> Self {
        QuartetMask(unsafe { _mm256_or_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn not(self) -> Self {
        unsafe {
            let ones = _mm256_castsi256_pd(_mm256_set1_epi64x(-1));
            QuartetMask(_mm256_xor_pd(self.0, ones))
        }
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        unsafe { _mm256_movemask_pd(self.0) as u32 }
    }
}

// SAFETY: __m256d is four consecutive f64.
unsafe impl Lanes for Quartet {
    const WIDTH: usize = 4;
    type Mask = QuartetMask;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        // SAFETY: see the module; so too below.
        Quartet(unsafe { _mm256_set1_pd(value) })
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Quartet(unsafe { _mm256_fmadd_pd(self.0, factor.0, term.0) })
    }
    #[inline(always)]
    fn neg_mul_add(self, factor: Self, term: Self) -> Self {
        Quartet(unsafe { _mm256_fnmadd_pd(self.0, factor.0, term.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Quartet(unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0) })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Quartet(unsafe { _mm256_sqrt_pd(self.0) })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Quartet(unsafe { _mm256_max_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Quartet(unsafe { _mm256_min_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn lt(self, other: Self) -> QuartetMask {
        QuartetMask(unsafe { _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, other.0) })
    }
    #[inline(always)]
    fn le(self, other: Self) -> QuartetMask {
        QuartetMask(unsafe { _mm256_cmp_pd::<_CMP_LE_OQ>(self.0, other.0) })
    }
    #[inline(always)]
    fn select(mask: QuartetMask, this: Self, other: Self) -> Self {
        Quartet(unsafe { _mm256_blendv_pd(other.0, this.0, mask.0) })
    }
    #[inline(always)]
    fn inverse_fourth_root_estimate(self) -> Self {
        unsafe {
            let quarter = _mm256_srli_epi64::<2>(_mm256_castpd_si256(self.0));
            let whole = _mm256_set1_epi64x(FOURTH_ROOT_BITS as i64);
            Quartet(_mm256_castsi256_pd(_mm256_sub_epi64(whole, quarter)))
        }
    }
    #[inline(always)]
    fn power_of_two(self) -> Self {
        unsafe {
            let shifted = _mm256_slli_epi64::<52>(_mm256_castpd_si256(self.0));
            let one = _mm256_set1_epi64x(ONE_BITS as i64);
            Quartet(_mm256_castsi256_pd(_mm256_add_epi64(shifted, one)))
        }
    }
    #[inline(always)]
    fn split(self) -> (Self, Self) {
        unsafe {
            let bits = _mm256_castpd_si256(self.0);
            let one = _mm256_set1_epi64x(ONE_BITS as i64);
            let from_root = _mm256_sub_epi64(bits, _mm256_set1_epi64x(SQRT_HALF_BITS as i64));
            let exponent = _mm256_srli_epi64::<52>(_mm256_add_epi64(from_root, one));
            let whole = _mm256_castsi256_pd(_mm256_or_si256(
                exponent,
                _mm256_set1_epi64x(TWO_52_BITS as i64),
            ));
            let rest =
                _mm256_add_epi64(_mm256_sub_epi64(bits, _mm256_slli_epi64::<52>(exponent)), one);
            (
                Quartet(_mm256_sub_pd(whole, _mm256_set1_pd(TWO_52_AND_BIAS))),
                Quartet(_mm256_castsi256_pd(rest)),
            )
        }
    }
}
