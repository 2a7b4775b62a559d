//! Elementary functions as straight lines of arithmetic that a compiler can lay over vector lanes.
//!
//! Only additions, multiplications, divisions, square roots and moves of bits, each rounded once by
//! IEEE 754 and never contracted: the same bits from a scalar, an AVX2 or an AVX-512 loop.

use crate::numerics::elementary;
use std::f64::consts::LOG2_E;

/// Compiles a loop for the portable, the AVX2 and the AVX-512 instruction sets and picks one at run time.
///
/// The arm with `narrow` is the part without AVX-512, for the other's use. A body that chooses between two long
/// polynomials is better split into two passes: as masked moves both are worked out for every value.
macro_rules! over_lanes {
    ($(#[$meta:meta])* narrow $vis:vis fn $name:ident($($arg:ident : $type:ty),* $(,)?) $body:block) => {
        $(#[$meta])*
        $vis fn $name($($arg: $type),*) {
            #[inline(always)]
            fn portable($($arg: $type),*) $body
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2")]
                fn avx2($($arg: $type),*) {
                    portable($($arg),*)
                }
                if std::arch::is_x86_feature_detected!("avx2") {
                    // SAFETY: the feature was just detected.
                    return unsafe { avx2($($arg),*) };
                }
            }
            portable($($arg),*)
        }
    };
    ($(#[$meta:meta])* $vis:vis fn $name:ident($($arg:ident : $type:ty),* $(,)?) $body:block) => {
        $(#[$meta])*
        $vis fn $name($($arg: $type),*) {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx512f,avx512dq,avx512vl")]
                fn avx512($($arg: $type),*) $body
                if std::arch::is_x86_feature_detected!("avx512f")
                    && std::arch::is_x86_feature_detected!("avx512dq")
                    && std::arch::is_x86_feature_detected!("avx512vl")
                {
                    // SAFETY: the three features were just detected.
                    return unsafe { avx512($($arg),*) };
                }
            }
            over_lanes! {
                /// The same without AVX-512.
                narrow fn narrower($($arg: $type),*) $body
            }
            narrower($($arg),*)
        }
    };
}
pub(crate) use over_lanes;

/// ln 2 to 33 bits, so that its product with a binary exponent is exact, and the rest.
const LN_2_HIGH: f64 = f64::from_bits(0x3FE6_2E42_FEE0_0000);
const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;
/// 1.5 · 2^52: adding it leaves the nearest integer in the low bits.
const TO_INTEGER: f64 = 6_755_399_441_055_744.0;
/// 1/k! for k = 13 … 2.
const EXPONENTIAL: [f64; 12] = [
    1.0 / 6_227_020_800.0,
    1.0 / 479_001_600.0,
    1.0 / 39_916_800.0,
    1.0 / 3_628_800.0,
    1.0 / 362_880.0,
    1.0 / 40_320.0,
    1.0 / 5_040.0,
    1.0 / 720.0,
    1.0 / 120.0,
    1.0 / 24.0,
    1.0 / 6.0,
    0.5,
];
/// 2/(2k + 1) for k = 10 … 1: the series of 2 artanh.
const LOGARITHM: [f64; 10] = [
    2.0 / 21.0,
    2.0 / 19.0,
    2.0 / 17.0,
    2.0 / 15.0,
    2.0 / 13.0,
    2.0 / 11.0,
    2.0 / 9.0,
    2.0 / 7.0,
    2.0 / 5.0,
    2.0 / 3.0,
];

/// The polynomial with `coefficients` from the highest power down.
#[inline(always)]
pub(crate) fn descending<const N: usize>(coefficients: &[f64; N], x: f64) -> f64 {
    let mut turned = *coefficients;
    let mut k = 0;
    while k < N {
        turned[k] = coefficients[N - 1 - k];
        k += 1;
    }
    ascending(&turned, x)
}

/// The polynomial with `coefficients` from the constant up.
///
/// Four interleaved Horner schemes in x⁴: the vector units wait for a single scheme's every step.
#[inline(always)]
pub(crate) fn ascending<const N: usize>(coefficients: &[f64; N], x: f64) -> f64 {
    let square = x * x;
    let fourth = square * square;
    let mut sums = [0.0; 4];
    let mut k = N;
    while k > 0 {
        k -= 1;
        let sum = &mut sums[k % 4];
        *sum = if k + 4 >= N { coefficients[k] } else { *sum * fourth + coefficients[k] };
    }
    (sums[0] + x * sums[1]) + square * (sums[2] + x * sums[3])
}

/// Largest magnitude of `x` that [`exponential`] takes.
pub(crate) const EXPONENTIAL_LIMIT: f64 = 708.0;

/// exp(`x` + `rest`) for |x| ≤ 708 and a `rest` far smaller than one, to about an ulp.
#[inline(always)]
pub(crate) fn exponential(x: f64, rest: f64) -> f64 {
    let shifted = x * LOG2_E + TO_INTEGER;
    let k = shifted - TO_INTEGER;
    let r = (x - k * LN_2_HIGH) - (k * LN_2_LOW - rest);
    let mantissa = 1.0 + (r + r * r * descending(&EXPONENTIAL, r));
    let scale = f64::from_bits((shifted.to_bits().wrapping_add(1023)) << 52);
    mantissa * scale
}

/// The natural logarithm of a positive normal number, to about two ulps away from one.
#[inline(always)]
pub(crate) fn logarithm(x: f64) -> f64 {
    // The mantissa is taken from [√½, √2): subtracting √½'s bits carries into the exponent there.
    const ROOT_HALF: u64 = 0x3FE6_A09E_667F_3BCD;
    // The exponent becomes a double through the bits of 2^52 + e + 2048, which needs no conversion.
    const INTEGER_BITS: u64 = 0x4330_0000_0000_0000;
    let offset = x.to_bits().wrapping_sub(ROOT_HALF).wrapping_add(2048 << 52);
    let exponent = offset >> 52;
    let e = f64::from_bits(exponent | INTEGER_BITS) - (4_503_599_627_370_496.0 + 2048.0);
    let m = f64::from_bits(x.to_bits().wrapping_sub(exponent.wrapping_sub(2048) << 52));
    let f = m - 1.0;
    let s = f / (2.0 + f);
    let square = s * s;
    e * LN_2_HIGH + (2.0 * s + (s * square * descending(&LOGARITHM, square) + e * LN_2_LOW))
}

/// exp(`x`) for any `x`: the scalar form of [`exponential_column`].
pub(crate) fn exponential_value(x: f64) -> f64 {
    if x.abs() <= EXPONENTIAL_LIMIT { exponential(x, 0.0) } else { elementary::exp(x) }
}

over_lanes! {
    /// exp(`offset` + `factor` x) in place: the straight-line part.
    fn exponential_lanes(values: &mut [f64], offset: f64, factor: f64) {
        for value in values.iter_mut() {
            *value = exponential(offset + factor * *value, 0.0);
        }
    }
}

/// Replaces every value x by exp(`offset` + `factor` x), the bits of [`exponential_value`].
pub(crate) fn exponential_column(values: &mut [f64], offset: f64, factor: f64) {
    const BLOCK: usize = 128;
    let mut kept = [0.0; BLOCK];
    for block in values.chunks_mut(BLOCK) {
        let kept = &mut kept[..block.len()];
        kept.copy_from_slice(block);
        exponential_lanes(block, offset, factor);
        for (value, &x) in block.iter_mut().zip(kept.iter()) {
            let argument = offset + factor * x;
            if argument.is_nan() || argument.abs() > EXPONENTIAL_LIMIT {
                *value = exponential_value(argument);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reference_libm_exponential_and_logarithm_agree_to_two_ulps() {
        for k in 0..20_000 {
            let x = -707.0 + 0.0707 * f64::from(k);
            let truth = elementary::exp(x);
            assert!((exponential(x, 0.0) / truth - 1.0).abs() <= 2.0 * f64::EPSILON, "exp({x})");
            let p = elementary::exp(-0.0353 * f64::from(k) - 2.0);
            assert!(
                (logarithm(p) / elementary::ln(p) - 1.0).abs() <= 2.0 * f64::EPSILON,
                "ln({p})"
            );
        }
    }

    #[test]
    fn property_exponential_column_has_the_bits_of_the_scalar() {
        let inputs: Vec<f64> = (0..1000).map(|k| -800.0 + 1.61 * f64::from(k)).collect();
        let mut column = inputs.clone();
        exponential_column(&mut column, 0.5, 1.25);
        for (&x, &y) in inputs.iter().zip(&column) {
            assert_eq!(exponential_value(0.5 + 1.25 * x).to_bits(), y.to_bits());
        }
    }
}
