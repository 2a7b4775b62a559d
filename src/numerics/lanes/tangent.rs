//! One lane that carries derivatives: a value and its slopes along `N` directions.
//!
//! Run through a kernel written over [`Lanes`], it differentiates the kernel: comparisons and choices go by
//! the value, everything else by the chain rule. `exp` and `ln` need no rules of their own, as they are
//! built from the operations here; their slopes are those of their polynomials, right to rounding.

use super::Lanes;
use super::scalar::ONE_BITS;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value with its derivatives along `N` directions.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Tangent<const N: usize> {
    /// The value.
    pub value: f64,
    /// The derivatives.
    pub slopes: [f64; N],
}

impl<const N: usize> Tangent<N> {
    /// `value` with the slopes `a·self + b·other`. A call, like the other operations: inlined a few
    /// thousand times, as those of plain lanes are, they would take minutes to compile.
    #[inline(never)]
    fn chain(self, other: Self, value: f64, a: f64, b: f64) -> Self {
        let mut slopes = [0.0; N];
        for (k, slope) in slopes.iter_mut().enumerate() {
            *slope = a * self.slopes[k] + b * other.slopes[k];
        }
        Tangent { value, slopes }
    }

    /// `value` with the slopes times `factor`.
    #[inline(never)]
    fn scaled(self, value: f64, factor: f64) -> Self {
        let mut slopes = self.slopes;
        for slope in &mut slopes {
            *slope *= factor;
        }
        Tangent { value, slopes }
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $value:expr, $a:expr, $b:expr) => {
        impl<const N: usize> $trait for Tangent<N> {
            type Output = Self;
            #[inline(never)]
            fn $method(self, other: Self) -> Self {
                let (x, y) = (self.value, other.value);
                let value = $value(x, y);
                self.chain(other, value, $a(x, y, value), $b(x, y, value))
            }
        }
    };
}
operator!(Add, add, |x, y| x + y, |_, _, _| 1.0, |_, _, _| 1.0);
operator!(Sub, sub, |x, y| x - y, |_, _, _| 1.0, |_, _, _| -1.0);
operator!(Mul, mul, |x, y| x * y, |_, y, _| y, |x, _, _| x);
operator!(Div, div, |x: f64, y: f64| x / y, |_, y: f64, _| 1.0 / y, |_, y: f64, q: f64| -q / y);

impl<const N: usize> Neg for Tangent<N> {
    type Output = Self;
    #[inline(never)]
    fn neg(self) -> Self {
        self.scaled(-self.value, -1.0)
    }
}

// SAFETY: the value comes first (`repr(C)`), and it is the only lane.
unsafe impl<const N: usize> Lanes for Tangent<N> {
    const WIDTH: usize = 1;
    type Mask = bool;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Tangent { value, slopes: [0.0; N] }
    }
    #[inline(always)]
    fn detached(self) -> Self {
        Self::splat(self.value)
    }
    #[inline(never)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        let value = f64::mul_add(self.value, factor.value, term.value);
        let mut result = self.chain(factor, value, factor.value, self.value);
        for (slope, more) in result.slopes.iter_mut().zip(term.slopes) {
            *slope += more;
        }
        result
    }
    #[inline(never)]
    fn neg_mul_add(self, factor: Self, term: Self) -> Self {
        Lanes::mul_add(-self, factor, term)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        if self.value < 0.0 { -self } else { self }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.scaled(root, if root > 0.0 { 0.5 / root } else { 0.0 })
    }
    #[inline(never)]
    fn max(self, other: Self) -> Self {
        if self.value > other.value { self } else { other }
    }
    #[inline(never)]
    fn min(self, other: Self) -> Self {
        if self.value < other.value { self } else { other }
    }
    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self.value < other.value
    }
    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self.value <= other.value
    }
    #[inline(never)]
    fn select(mask: bool, this: Self, other: Self) -> Self {
        if mask { this } else { other }
    }
    /// Without derivatives: nothing that depends on them is estimated.
    #[inline(always)]
    fn inverse_fourth_root_estimate(self) -> Self {
        Self::splat(self.value.inverse_fourth_root_estimate())
    }
    #[inline(always)]
    fn power_of_two(self) -> Self {
        let value = f64::from_bits((self.value.to_bits() << 52).wrapping_add(ONE_BITS));
        self.scaled(value, std::f64::consts::LN_2 * value)
    }
    #[inline(always)]
    fn split(self) -> (Self, Self) {
        let (whole, rest) = self.value.split();
        (Self::splat(whole), self.scaled(rest, rest / self.value))
    }
}

#[cfg(test)]
mod tests {
    use super::super::elementary::{exp, ln};
    use super::*;

    /// Every operation's derivative in closed form, to a few roundings of numbers below 10.
    #[test]
    fn analytic_derivatives_of_every_operation() {
        let x = Tangent { value: 1.7, slopes: [1.0, 0.0] };
        let y = Tangent { value: 0.6, slopes: [0.0, 1.0] };
        let half = Tangent::splat(0.5);
        let (a, b) = (1.7f64, 0.6f64);
        let cases: [(Tangent<2>, f64, f64, f64); 11] = [
            (x + y, a + b, 1.0, 1.0),
            (x - y, a - b, 1.0, -1.0),
            (x * y, a * b, b, a),
            (x / y, a / b, 1.0 / b, -a / (b * b)),
            ((-x).abs(), a, 1.0, 0.0),
            (exp(x), a.exp(), a.exp(), 0.0),
            (exp(-x * y), (-a * b).exp(), -b * (-a * b).exp(), -a * (-a * b).exp()),
            (ln(y), b.ln(), 0.0, 1.0 / b),
            (Lanes::sqrt(y), b.sqrt(), 0.0, 0.5 / b.sqrt()),
            (Lanes::mul_add(x, y, half * x), a * b + 0.5 * a, b + 0.5, a),
            (x.neg_mul_add(y, y), b - a * b, -b, 1.0 - a),
        ];
        for (k, (got, value, dx, dy)) in cases.into_iter().enumerate() {
            for (got, want) in [(got.value, value), (got.slopes[0], dx), (got.slopes[1], dy)] {
                assert!((got - want).abs() <= 64.0 * f64::EPSILON, "case {k}: {got} {want}");
            }
        }
        assert_eq!(x.detached().slopes, [0.0, 0.0]);
    }
}
