//! Eight lanes in one AVX-512 register.
//!
//! Every method is inlined into a kernel that was entered through a function with
//! `#[target_feature(enable = "avx512f,avx512dq")]`; nothing else may call them.

use super::scalar::{FOURTH_ROOT_BITS, ONE_BITS, SQRT_HALF_BITS, TWO_52_AND_BIAS, TWO_52_BITS};
use super::{Lanes, Mask};
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Eight `f64`. Only a function with the target features of AVX-512 (F and DQ) may use it.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct Octet(__m512d);

macro_rules! operator {
    ($trait:ident, $method:ident, $intrinsic:ident) => {
        impl $trait for Octet {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: see the module.
                Octet(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    };
}
operator!(Add, add, _mm512_add_pd);
operator!(Sub, sub, _mm512_sub_pd);
operator!(Mul, mul, _mm512_mul_pd);
operator!(Div, div, _mm512_div_pd);

impl Neg for Octet {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: see the module.
        Octet(unsafe { _mm512_xor_pd(self.0, _mm512_set1_pd(-0.0)) })
    }
}

impl Mask for __mmask8 {
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

// SAFETY: __m512d is eight consecutive f64.
unsafe impl Lanes for Octet {
    const WIDTH: usize = 8;
    type Mask = __mmask8;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        // SAFETY: see the module; so too below.
        Octet(unsafe { _mm512_set1_pd(value) })
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Octet(unsafe { _mm512_fmadd_pd(self.0, factor.0, term.0) })
    }
    #[inline(always)]
    fn neg_mul_add(self, factor: Self, term: Self) -> Self {
        Octet(unsafe { _mm512_fnmadd_pd(self.0, factor.0, term.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Octet(unsafe { _mm512_abs_pd(self.0) })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Octet(unsafe { _mm512_sqrt_pd(self.0) })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Octet(unsafe { _mm512_max_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Octet(unsafe { _mm512_min_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn lt(self, other: Self) -> __mmask8 {
        unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn le(self, other: Self) -> __mmask8 {
        unsafe { _mm512_cmp_pd_mask::<_CMP_LE_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn select(mask: __mmask8, this: Self, other: Self) -> Self {
        Octet(unsafe { _mm512_mask_blend_pd(mask, other.0, this.0) })
    }
    #[inline(always)]
    fn inverse_fourth_root_estimate(self) -> Self {
        unsafe {
            let quarter = _mm512_srli_epi64::<2>(_mm512_castpd_si512(self.0));
            let whole = _mm512_set1_epi64(FOURTH_ROOT_BITS as i64);
            Octet(_mm512_castsi512_pd(_mm512_sub_epi64(whole, quarter)))
        }
    }
    #[inline(always)]
    fn power_of_two(self) -> Self {
        unsafe {
            let shifted = _mm512_slli_epi64::<52>(_mm512_castpd_si512(self.0));
            let one = _mm512_set1_epi64(ONE_BITS as i64);
            Octet(_mm512_castsi512_pd(_mm512_add_epi64(shifted, one)))
        }
    }
    #[inline(always)]
    fn split(self) -> (Self, Self) {
        unsafe {
            let bits = _mm512_castpd_si512(self.0);
            let one = _mm512_set1_epi64(ONE_BITS as i64);
            let from_root = _mm512_sub_epi64(bits, _mm512_set1_epi64(SQRT_HALF_BITS as i64));
            let exponent = _mm512_srli_epi64::<52>(_mm512_add_epi64(from_root, one));
            let whole = _mm512_castsi512_pd(_mm512_or_si512(
                exponent,
                _mm512_set1_epi64(TWO_52_BITS as i64),
            ));
            let rest =
                _mm512_add_epi64(_mm512_sub_epi64(bits, _mm512_slli_epi64::<52>(exponent)), one);
            (
                Octet(_mm512_sub_pd(whole, _mm512_set1_pd(TWO_52_AND_BIAS))),
                Octet(_mm512_castsi512_pd(rest)),
            )
        }
    }
}
