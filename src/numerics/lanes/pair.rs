//! Two groups of lanes side by side, so that one group's operations fill the other's waits.

use super::{Lanes, Mask};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Two groups of lanes.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct Pair<V>(V, V);

/// Two groups' masks.
#[derive(Clone, Copy)]
pub struct PairMask<M>(M, M, u32);

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl<V: Lanes> $trait for Pair<V> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Pair(self.0.$method(other.0), self.1.$method(other.1))
            }
        }
    };
}
operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl<V: Lanes> Neg for Pair<V> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Pair(-self.0, -self.1)
    }
}

impl<M: Mask> Mask for PairMask<M> {
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        PairMask(self.0.and(other.0), self.1.and(other.1), self.2)
    }
    #[inline(always)]
    fn or(self, other: Self) -> Self {
        PairMask(self.0.or(other.0), self.1.or(other.1), self.2)
    }
    #[inline(always)]
    fn not(self) -> Self {
        PairMask(self.0.not(), self.1.not(), self.2)
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        self.0.bits() | (self.1.bits() << self.2)
    }
}

// SAFETY: two groups of consecutive f64 without padding (each group's size is a multiple of its
// alignment), in order.
unsafe impl<V: Lanes> Lanes for Pair<V> {
    const WIDTH: usize = 2 * V::WIDTH;
    type Mask = PairMask<V::Mask>;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Pair(V::splat(value), V::splat(value))
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Pair(self.0.mul_add(factor.0, term.0), self.1.mul_add(factor.1, term.1))
    }
    #[inline(always)]
    fn neg_mul_add(self, factor: Self, term: Self) -> Self {
        Pair(self.0.neg_mul_add(factor.0, term.0), self.1.neg_mul_add(factor.1, term.1))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Pair(self.0.abs(), self.1.abs())
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Pair(self.0.sqrt(), self.1.sqrt())
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Pair(self.0.max(other.0), self.1.max(other.1))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Pair(self.0.min(other.0), self.1.min(other.1))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Self::Mask {
        PairMask(self.0.lt(other.0), self.1.lt(other.1), V::WIDTH as u32)
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        PairMask(self.0.le(other.0), self.1.le(other.1), V::WIDTH as u32)
    }
    #[inline(always)]
    fn select(mask: Self::Mask, this: Self, other: Self) -> Self {
        Pair(V::select(mask.0, this.0, other.0), V::select(mask.1, this.1, other.1))
    }
    #[inline(always)]
    fn inverse_fourth_root_estimate(self) -> Self {
        Pair(self.0.inverse_fourth_root_estimate(), self.1.inverse_fourth_root_estimate())
    }
    #[inline(always)]
    fn power_of_two(self) -> Self {
        Pair(self.0.power_of_two(), self.1.power_of_two())
    }
    #[inline(always)]
    fn split(self) -> (Self, Self) {
        let (first, first_rest) = self.0.split();
        let (second, second_rest) = self.1.split();
        (Pair(first, second), Pair(first_rest, second_rest))
    }
}
