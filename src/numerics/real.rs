//! The number type of the equations: a plain `f64`, a value with derivatives, a vector of lanes.

use super::elementary;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number that the equations of motion and heat can be written in.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The constant `value`.
    fn constant(value: f64) -> Self;
    /// Natural exponential.
    fn exp(self) -> Self;
    /// Natural logarithm of a positive number.
    fn ln(self) -> Self;
    /// Square root of a non-negative number.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// `self` to the power `exponent` for `self` ≥ 0; zero to a positive power is zero, with a zero
    /// derivative (the equations multiply it by a quantity that vanishes with it).
    fn power(self, exponent: Self) -> Self;
    /// `self · factor + term`, rounded once where the number type can.
    fn mul_add(self, factor: Self, term: Self) -> Self;
    /// The smaller, with its derivatives; `other` where either is not a number.
    fn min(self, other: Self) -> Self;
    /// Zero, without derivatives, where the magnitude is at most `bound`; the number itself elsewhere.
    fn beyond(self, bound: f64) -> Self;
    /// Whether it is zero, in every lane.
    fn is_zero(self) -> bool;
}

/// A Newton step for a logarithm that is no longer than this leaves an error below a rounding: it converges
/// quadratically, with a constant below one.
pub const CONVERGED: f64 = 1e-8;

impl Real for f64 {
    fn constant(value: f64) -> Self {
        value
    }
    fn exp(self) -> Self {
        elementary::exp(self)
    }
    fn ln(self) -> Self {
        elementary::ln(self)
    }
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    fn abs(self) -> Self {
        f64::abs(self)
    }
    fn power(self, exponent: Self) -> Self {
        if self > 0.0 { elementary::exp(exponent * elementary::ln(self)) } else { 0.0 }
    }
    fn mul_add(self, factor: Self, term: Self) -> Self {
        f64::mul_add(self, factor, term)
    }
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
    fn beyond(self, bound: f64) -> Self {
        if self.abs() <= bound { 0.0 } else { self }
    }
    fn is_zero(self) -> bool {
        self == 0.0
    }
}
