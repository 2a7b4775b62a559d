//! Lanes as numbers of the equations: what is written over [`Real`] runs on several samples at once.

use super::{Lanes, Mask, elementary};
use crate::numerics::real::Real;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Lanes that the equations of `physics` can be written in.
///
/// Not the lanes themselves: an `f64` is both a lane and a number of the equations, and as the latter it
/// takes the exponential of `libm`. Over any lanes, one included, a `Wide` takes that of
/// [`elementary`], so that a sample's bits do not depend on how many lanes there are.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(transparent)]
pub struct Wide<V>(pub V);

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl<V: Lanes> $trait for Wide<V> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Wide(self.0.$method(other.0))
            }
        }
    };
}
operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl<V: Lanes> Neg for Wide<V> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Wide(-self.0)
    }
}

impl<V: Lanes> Real for Wide<V> {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Wide(V::splat(value))
    }
    #[inline(always)]
    fn exp(self) -> Self {
        Wide(elementary::exp(self.0))
    }
    #[inline(always)]
    fn ln(self) -> Self {
        Wide(elementary::ln(self.0))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Wide(self.0.sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Wide(self.0.abs())
    }
    #[inline(always)]
    fn power(self, exponent: Self) -> Self {
        let zero = V::splat(0.0);
        let power = elementary::exp(exponent.0 * elementary::ln(self.0));
        Wide(V::select(zero.lt(self.0), power, zero))
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Wide(self.0.mul_add(factor.0, term.0))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Wide(self.0.min(other.0))
    }
    #[inline(always)]
    fn beyond(self, bound: f64) -> Self {
        let small = self.0.abs().le(V::splat(bound));
        Wide(V::select(small, V::splat(0.0), self.0))
    }
    #[inline(always)]
    fn is_zero(self) -> bool {
        !V::splat(0.0).lt(self.0.abs()).any()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against `libm`'s: both are right to one unit in the last place, a power's exponent multiplies that.
    #[test]
    fn reference_libm_on_one_lane() {
        for k in 1..200 {
            let x = f64::from(k) * 0.07;
            let (wide, plain) = (Wide(x), x);
            for (got, want) in [
                (Real::exp(wide).0, Real::exp(plain)),
                (Real::ln(wide).0, Real::ln(plain)),
                (wide.power(Wide(0.8)).0, Real::power(plain, 0.8)),
            ] {
                assert!(
                    (got - want).abs() <= 8.0 * f64::EPSILON * want.abs().max(1.0),
                    "{got} {want}"
                );
            }
        }
        assert_eq!(Wide(0.0).power(Wide(0.8)), Wide(0.0));
        assert_eq!(Real::min(Wide(2.0), Wide(1.0)), Wide(1.0));
    }
}
