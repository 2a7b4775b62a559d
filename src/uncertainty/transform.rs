//! From uniform and standard normal columns to columns of a law, with the bits of the scalar forms.
//!
//! The normal, lognormal and uniform laws, truncated or not, are most of what cards state: they run
//! as straight lines of arithmetic over whole columns.

use super::truncation::Truncation;
use crate::numerics::special::kernels::{exponential_column, exponential_value, over_lanes};
use crate::numerics::special::normal::{self, LANE_LIMIT, magnitude, tail_lane};

/// exp(x), the scalar form of the columns here.
pub(super) fn exponential_of(x: f64) -> f64 {
    exponential_value(x)
}

/// The value of [`from`, `to`] whose `lower` or upper share of the length is `tail`.
#[inline(always)]
pub(super) fn uniform_of(from: f64, to: f64, tail: f64, lower: bool) -> f64 {
    let width = to - from;
    if lower { from + width * tail } else { to - width * tail }
}

/// The standard normal value of the truncated law whose `lower` or upper tail is `tail`.
pub(super) fn truncated_normal_of(cut: &Truncation, tail: f64, lower: bool) -> f64 {
    let (below, above) = cut.tails_of(tail, lower);
    if below <= above { -magnitude(below) } else { magnitude(above) }
}

/// The smaller tail of the whole law where the truncated one has `tail`, negative where it is the lower one.
#[inline(always)]
fn signed_tail(cut: &Truncation, tail: f64, lower: bool) -> f64 {
    let (below, above) = cut.tails_of(tail, lower);
    if below <= above { -below } else { above }
}

/// The smaller tail at a uniform `u`, and whether it is the lower one.
#[inline(always)]
pub(super) fn tail_of_uniform(u: f64) -> (f64, bool) {
    let lower = u <= 0.5;
    (if lower { u } else { 1.0 - u }, lower)
}

over_lanes! {
    /// [`signed_tail`] at uniforms.
    fn signed_tails_at_uniforms(u: &[f64], out: &mut [f64], cut: &Truncation) {
        for (out, &u) in out.iter_mut().zip(u) {
            let (tail, lower) = tail_of_uniform(u);
            *out = signed_tail(cut, tail, lower);
        }
    }
}

/// Standard normal values of the truncated law at uniforms.
fn truncated_from_uniform(u: &[f64], out: &mut [f64], cut: &Truncation) {
    in_blocks(u, out, |u, tails| signed_tails_at_uniforms(u, tails, cut));
    for (out, &u) in out.iter_mut().zip(u) {
        if out.is_nan() {
            let (tail, lower) = tail_of_uniform(u);
            *out = truncated_normal_of(cut, tail, lower);
        }
    }
}

over_lanes! {
    /// [`signed_tail`] at standard normal values, NaN far out.
    fn signed_tails_at_normals(z: &[f64], out: &mut [f64], cut: &Truncation) {
        for (out, &z) in out.iter_mut().zip(z) {
            let t = z.abs();
            let tail = signed_tail(cut, tail_lane(t), z <= 0.0);
            *out = if t <= LANE_LIMIT { tail } else { f64::NAN };
        }
    }
}

/// Standard normal values of the truncated law at standard normal values of equal probability.
fn truncated_from_normal(z: &[f64], out: &mut [f64], cut: &Truncation) {
    in_blocks(z, out, |z, tails| signed_tails_at_normals(z, tails, cut));
    for (out, &z) in out.iter_mut().zip(z) {
        if out.is_nan() {
            *out = truncated_normal_of(cut, normal::cdf(-z.abs()), z <= 0.0);
        }
    }
}

/// Standard normal values of the signed tails that `tails_of` writes, block by block.
fn in_blocks(from: &[f64], out: &mut [f64], tails_of: impl Fn(&[f64], &mut [f64])) {
    const BLOCK: usize = 256;
    let mut tails = [0.0; BLOCK];
    for (from, out) in from.chunks(BLOCK).zip(out.chunks_mut(BLOCK)) {
        let tails = &mut tails[..from.len()];
        tails_of(from, tails);
        normal::of_signed_tails(tails, out);
    }
}

over_lanes! {
    /// Replaces every value z by `offset` + `factor` z.
    fn affine(values: &mut [f64], offset: f64, factor: f64) {
        for value in values.iter_mut() {
            *value = offset + factor * *value;
        }
    }
}

over_lanes! {
    /// Moves every value inside the limits.
    fn clamp(values: &mut [f64], cut: &Truncation) {
        for value in values.iter_mut() {
            *value = cut.clamp(*value);
        }
    }
}

over_lanes! {
    /// Values of the uniform law on [`from`, `to`] at uniforms.
    pub(super) fn uniform_column(u: &[f64], out: &mut [f64], from: f64, to: f64) {
        for (out, &u) in out.iter_mut().zip(u) {
            let (tail, lower) = tail_of_uniform(u);
            *out = uniform_of(from, to, tail, lower);
        }
    }
}

over_lanes! {
    /// The straight-line part of [`uniform_column_from_normal`].
    fn uniform_from_normal_lanes(z: &[f64], out: &mut [f64], from: f64, to: f64) {
        for (out, &z) in out.iter_mut().zip(z) {
            *out = uniform_of(from, to, tail_lane(z.abs()), z <= 0.0);
        }
    }
}

/// Values of the uniform law on [`from`, `to`] at standard normal values of equal probability.
pub(super) fn uniform_column_from_normal(z: &[f64], out: &mut [f64], from: f64, to: f64) {
    uniform_from_normal_lanes(z, out, from, to);
    for (out, &z) in out.iter_mut().zip(z) {
        if z.is_nan() || z.abs() > LANE_LIMIT {
            *out = uniform_of(from, to, normal::cdf(-z.abs()), z <= 0.0);
        }
    }
}

/// What is done to a standard normal value to make it one of the law.
#[derive(Debug, Clone, Copy)]
pub(super) enum Scale {
    /// offset + factor z.
    Linear,
    /// exp(offset + factor z).
    Exponential,
}

/// A law that is a function of a standard normal value.
#[derive(Debug, Clone, Copy)]
pub(super) struct NormalTransform {
    pub scale: Scale,
    pub offset: f64,
    pub factor: f64,
}

impl NormalTransform {
    /// The law's value at a standard normal `z`.
    pub fn value(&self, z: f64) -> f64 {
        let linear = self.offset + self.factor * z;
        match self.scale {
            Scale::Linear => linear,
            Scale::Exponential => exponential_value(linear),
        }
    }

    /// [`NormalTransform::value`] of a column, in place.
    fn apply(&self, values: &mut [f64]) {
        match self.scale {
            Scale::Linear => affine(values, self.offset, self.factor),
            Scale::Exponential => exponential_column(values, self.offset, self.factor),
        }
    }

    /// The law's values, within the truncation if there is one, at uniforms.
    pub fn column_from_uniform(&self, u: &[f64], out: &mut [f64], cut: Option<&Truncation>) {
        match cut {
            None => {
                normal::quantile_column(u, out);
                self.apply(out);
            }
            Some(cut) => {
                truncated_from_uniform(u, out, cut);
                self.apply(out);
                clamp(out, cut);
            }
        }
    }

    /// The law's values, within the truncation if there is one, at standard normal values.
    pub fn column_from_normal(&self, z: &[f64], out: &mut [f64], cut: Option<&Truncation>) {
        match cut {
            None => {
                for (out, &z) in out.iter_mut().zip(z) {
                    *out = z;
                }
                self.apply(out);
            }
            Some(cut) => {
                truncated_from_normal(z, out, cut);
                self.apply(out);
                clamp(out, cut);
            }
        }
    }
}
