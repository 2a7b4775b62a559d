//! `exp` and `ln` over lanes, the same bits in every lane type; over one `f64` these are the scalar forms.
//!
//! Worst errors found against twice the precision (`tests/truth/vector_elementary.rs`, four million points
//! each and every end of a reduction interval): `exp` 0.78, `ln` 0.84 units in the last place.

use super::{Lanes, MAGIC};

/// ln 2 in two parts: the first has 32 trailing zero bits, so that small multiples of it are exact.
const LN_2_HIGH: f64 = 0.693_147_180_369_123_8;
const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;

/// The largest argument's magnitude that [`exp`] distinguishes; beyond it the result stays the same.
pub const EXP_RANGE: f64 = 708.0;

/// `(eʳ − 1 − r)/r²` on |r| ≤ ½ ln 2 by interpolation at Chebyshev points (mpmath, 60 digits):
/// relative error of eʳ below 3.3e-19.
const EXP: [f64; 11] = [
    0.5,
    0.166_666_666_666_666_7,
    0.041_666_666_666_666_67,
    0.008_333_333_333_326_112,
    0.001_388_888_888_888_373,
    0.000_198_412_698_749_012_6,
    2.480_158_732_560_532_4e-05,
    2.755_725_529_796_964_3e-06,
    2.755_727_357_010_214e-07,
    2.510_525_953_844_85e-08,
    2.091_471_734_171_638e-09,
];

/// Two terms of [`EXP`]'s polynomial.
#[inline(always)]
fn pair<V: Lanes>(r: V, k: usize) -> V {
    r.mul_add(V::splat(EXP[k + 1]), V::splat(EXP[k]))
}

/// Natural exponential of −708 ≤ x ≤ 708; outside, that of the nearer end. Not a number for none.
#[inline(always)]
pub fn exp<V: Lanes>(x: V) -> V {
    let x = V::splat(EXP_RANGE).min(V::splat(-EXP_RANGE).max(x));
    let shifted = x.mul_add(V::splat(std::f64::consts::LOG2_E), V::splat(MAGIC));
    let whole = shifted - V::splat(MAGIC);
    let r = whole.neg_mul_add(V::splat(LN_2_LOW), whole.neg_mul_add(V::splat(LN_2_HIGH), x));
    // Estrin's scheme: the depth of the chain, not the number of operations, is what costs here.
    let r2 = r * r;
    let r4 = r2 * r2;
    let low = r2.mul_add(pair(r, 2), pair(r, 0));
    let middle = r2.mul_add(pair(r, 6), pair(r, 4));
    let high = r2.mul_add(V::splat(EXP[10]), pair(r, 8));
    let q = r4.mul_add(r4.mul_add(high, middle), low);
    // 1 + r is split into its rounded value and the rest, so that only the last addition rounds at the
    // result's own size.
    let one = V::splat(1.0);
    let high = one + r;
    let low = r - (high - one);
    (high + r2.mul_add(q, low)) * shifted.power_of_two()
}

/// Natural logarithm of a positive normal number (after fdlibm's scheme: with `f = z − 1` and
/// `s = f/(2 + f)`, `ln z = f − f²/2 + s (f²/2 + R(s²))`). Anything else gives a meaningless number.
#[inline(always)]
pub fn ln<V: Lanes>(x: V) -> V {
    const R: [f64; 7] = [
        0.666_666_666_666_673_5,
        0.399_999_999_994_094_2,
        0.285_714_287_436_623_9,
        0.222_221_984_321_497_84,
        0.181_835_721_616_180_5,
        0.153_138_376_992_093_73,
        0.147_981_986_051_165_86,
    ];
    let (k, z) = x.split();
    let f = z - V::splat(1.0);
    let s = f / (V::splat(2.0) + f);
    let s2 = s * s;
    let mut r = V::splat(R[6]);
    for &coefficient in R[..6].iter().rev() {
        r = r.mul_add(s2, V::splat(coefficient));
    }
    let half_square = V::splat(0.5) * f * f;
    let tail = s.mul_add(s2.mul_add(r, half_square), k * V::splat(LN_2_LOW));
    k.mul_add(V::splat(LN_2_HIGH), f - (half_square - tail))
}

/// The reciprocal of the fourth root of a positive normal number, to 0.3 %: what a step size needs, at an
/// eighth of the cost of two square roots and a division.
#[inline(always)]
pub fn inverse_fourth_root<V: Lanes>(x: V) -> V {
    let y = x.inverse_fourth_root_estimate();
    let square = y * y;
    y * (V::splat(0.25) * x).neg_mul_add(square * square, V::splat(1.25))
}
