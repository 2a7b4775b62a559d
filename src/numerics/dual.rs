//! Forward-mode derivatives: a value and its derivatives along `N` directions.

use super::elementary;
use super::real::Real;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value with its derivatives along `N` directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<const N: usize> {
    /// The value.
    pub value: f64,
    /// The derivatives.
    pub slopes: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// A value that varies along direction `k` with slope one.
    pub fn variable(value: f64, k: usize) -> Self {
        let mut slopes = [0.0; N];
        slopes[k] = 1.0;
        Dual { value, slopes }
    }

    /// The chain rule for a function of one variable with value `value` and derivative `slope`.
    fn chain(self, value: f64, slope: f64) -> Self {
        Dual { value, slopes: self.slopes.map(|s| slope * s) }
    }

    fn zip(self, other: Self, value: f64, slope: impl Fn(f64, f64) -> f64) -> Self {
        let slopes = std::array::from_fn(|k| slope(self.slopes[k], other.slopes[k]));
        Dual { value, slopes }
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.zip(other, self.value + other.value, |a, b| a + b)
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.zip(other, self.value - other.value, |a, b| a - b)
    }
}

// Products and quotients of derivatives follow the product and quotient rules, sums and all.
#[allow(clippy::suspicious_arithmetic_impl)]
impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let (x, y) = (self.value, other.value);
        self.zip(other, x * y, |a, b| a * y + x * b)
    }
}

#[allow(clippy::suspicious_arithmetic_impl)]
impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        self.zip(other, quotient, |a, b| (a - quotient * b) / other.value)
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}

impl<const N: usize> Real for Dual<N> {
    fn constant(value: f64) -> Self {
        Dual { value, slopes: [0.0; N] }
    }
    fn exp(self) -> Self {
        let value = elementary::exp(self.value);
        self.chain(value, value)
    }
    fn ln(self) -> Self {
        self.chain(elementary::ln(self.value), 1.0 / self.value)
    }
    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        self.chain(value, 0.5 / value)
    }
    fn abs(self) -> Self {
        self.chain(self.value.abs(), if self.value < 0.0 { -1.0 } else { 1.0 })
    }
    fn power(self, exponent: Self) -> Self {
        if self.value <= 0.0 {
            return Self::constant(0.0);
        }
        let ln = elementary::ln(self.value);
        let value = elementary::exp(exponent.value * ln);
        let base_slope = exponent.value * value / self.value;
        let exponent_slope = value * ln;
        self.zip(exponent, value, |a, b| base_slope * a + exponent_slope * b)
    }
    fn mul_add(self, factor: Self, term: Self) -> Self {
        let mut result = self.zip(factor, self.value.mul_add(factor.value, term.value), |a, b| {
            a * factor.value + self.value * b
        });
        for (slope, term_slope) in result.slopes.iter_mut().zip(term.slopes) {
            *slope += term_slope;
        }
        result
    }
    fn min(self, other: Self) -> Self {
        if self.value < other.value { self } else { other }
    }
    fn beyond(self, bound: f64) -> Self {
        if self.value.abs() <= bound { Self::constant(0.0) } else { self }
    }
    fn is_zero(self) -> bool {
        self.value == 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_derivatives_of_every_operation() {
        let x = Dual::<2>::variable(1.7, 0);
        let y = Dual::<2>::variable(0.6, 1);
        let half = Dual::constant(0.5);
        // value, d/dx, d/dy in closed form.
        let (a, b) = (1.7f64, 0.6f64);
        let cases: [(Dual<2>, f64, f64, f64); 10] = [
            (x + y, a + b, 1.0, 1.0),
            (x - y, a - b, 1.0, -1.0),
            (x * y, a * b, b, a),
            (x / y, a / b, 1.0 / b, -a / (b * b)),
            (-x, -a, -1.0, 0.0),
            (x.exp(), a.exp(), a.exp(), 0.0),
            (x.ln(), a.ln(), 1.0 / a, 0.0),
            (y.sqrt(), b.sqrt(), 0.0, 0.5 / b.sqrt()),
            (x.power(y), a.powf(b), b * a.powf(b - 1.0), a.powf(b) * a.ln()),
            (x.mul_add(y, half * x), a * b + 0.5 * a, b + 0.5, a),
        ];
        // Each derivative is a few operations: 8 units in the last place of numbers below 8.
        for (k, (dual, value, dx, dy)) in cases.into_iter().enumerate() {
            for (got, want) in [(dual.value, value), (dual.slopes[0], dx), (dual.slopes[1], dy)] {
                assert!((got - want).abs() <= 8.0 * 8.0 * f64::EPSILON, "case {k}: {got} {want}");
            }
        }
    }

    #[test]
    fn property_zero_to_a_power_has_no_slope() {
        let zero = Dual::<1>::variable(0.0, 0);
        let power = zero.power(Dual::constant(0.8));
        assert_eq!((power.value, power.slopes), (0.0, [0.0]));
    }
}
