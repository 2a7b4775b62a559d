//! The standard normal distribution.
//!
//! The rational approximations were fitted for this project by weighted linear least squares in
//! 50 digits (`tests/laws/references/normal_fit.py`); their own error is below 1.2e-16 relative.

use super::kernels::{ascending, exponential, logarithm, over_lanes};
use crate::numerics::elementary;

/// 1/√(2π).
const INVERSE_ROOT_TWO_PI: f64 = 0.398_942_280_401_432_7;
/// ln √(2π).
const LN_ROOT_TWO_PI: f64 = 0.918_938_533_204_672_7;
/// Below this tail probability the quantile uses the tail's approximation.
const CENTRAL_TAIL: f64 = 0.075;
/// Below this tail probability, exp(−40), it uses the far tail's.
pub(crate) const FAR_TAIL: f64 = 4.248_354_255_291_589e-18;
/// Largest argument whose tail probability is computed without care for underflow.
pub(crate) const LANE_LIMIT: f64 = 37.5;

const CENTRAL_NUMERATOR: [f64; 8] = [
    3.3871328727963665,
    132.9755768907313,
    1966.1728986971173,
    13669.059899577498,
    45611.95030344375,
    66635.3529602749,
    33014.17326095081,
    2468.944190984038,
];
const CENTRAL_DENOMINATOR: [f64; 8] = [
    1.0,
    42.26429483342248,
    685.4400439066746,
    5371.535872888501,
    21082.491479675467,
    38971.5276719539,
    28403.52815271815,
    5150.707469122131,
];

const TAIL_NUMERATOR: [f64; 9] = [
    1.4234371107496837,
    4.644926588509672,
    5.849742333512593,
    3.808701328703729,
    1.4224975045766242,
    0.31445807345054916,
    0.03997879381479934,
    0.002593884031796612,
    6.167266049990924e-05,
];
const TAIL_DENOMINATOR: [f64; 9] = [
    1.0,
    2.063440581258197,
    1.7204629793049455,
    0.7507745298427082,
    0.18513160833139236,
    0.02557014906056957,
    0.0017647438603971247,
    4.360575501049252e-05,
    2.6524548838345768e-11,
];

const FAR_NUMERATOR: [f64; 8] = [
    8.120594767905024,
    5.691093886093955,
    1.6019740845258807,
    0.23171622937158787,
    0.01826285684779054,
    0.0007642348402791411,
    1.5146927661314383e-05,
    1.0388547510734693e-07,
];
const FAR_DENOMINATOR: [f64; 8] = [
    1.0,
    0.5214924644724718,
    0.10443494992183798,
    0.010066912301414741,
    0.00047903216355498184,
    1.0269918263825503e-05,
    7.345768554267445e-08,
    9.30672601556262e-16,
];

const MILLS_NUMERATOR: [f64; 10] = [
    0.5,
    0.7737305408711246,
    0.5923716545325188,
    0.28812486924221237,
    0.09715193084363952,
    0.023453433365661202,
    0.004053007566805706,
    0.00048509847567289956,
    3.6763613369452845e-05,
    1.363422532887775e-06,
];
const MILLS_DENOMINATOR: [f64; 11] = [
    1.0,
    2.3453456425451065,
    2.556058386998315,
    1.708977960972805,
    0.77861349066719,
    0.2534988424245084,
    0.05999816602904235,
    0.010251536065111892,
    0.001219379148786255,
    9.215271274717903e-05,
    3.4175934712166467e-06,
];

/// P(Z > t) for 0 ≤ t ≤ 37.5.
#[inline(always)]
pub(crate) fn tail_lane(t: f64) -> f64 {
    // t² in two parts: the head's square is exact.
    let head = f64::from_bits(t.to_bits() & 0xFFFF_FFFF_F800_0000);
    let rest = -0.5 * (t - head) * (t + head);
    exponential(-0.5 * head * head, rest) * mills(t)
}

/// P(Z > t)/exp(−t²/2) for t ≥ 0.
#[inline(always)]
fn mills(t: f64) -> f64 {
    ascending(&MILLS_NUMERATOR, t) / ascending(&MILLS_DENOMINATOR, t)
}

/// P(Z > `t`) for `t` ≥ 0.
fn tail(t: f64) -> f64 {
    if t <= LANE_LIMIT {
        tail_lane(t)
    } else if t > 39.0 {
        0.0
    } else {
        let head = f64::from_bits(t.to_bits() & 0xFFFF_FFFF_F800_0000);
        let rest = -0.5 * (t - head) * (t + head);
        // Halved exponents: the product alone may be subnormal, and is rounded only once.
        let half = elementary::exp(-0.25 * head * head);
        half * elementary::exp(rest) * mills(t) * half
    }
}

/// The z ≥ 0 whose tail probability is `p`, for [`CENTRAL_TAIL`] ≤ `p` ≤ ½.
#[inline(always)]
fn central_magnitude(p: f64) -> f64 {
    let q = 0.5 - p;
    let c = 0.180625 - q * q;
    ascending(&CENTRAL_NUMERATOR, c) * q / ascending(&CENTRAL_DENOMINATOR, c)
}

/// The z ≥ 0 whose tail probability is `p`, for exp(−40) ≤ `p` < [`CENTRAL_TAIL`].
#[inline(always)]
fn tail_magnitude(p: f64) -> f64 {
    let t = (-logarithm(p)).sqrt() - 1.6;
    ascending(&TAIL_NUMERATOR, t) / ascending(&TAIL_DENOMINATOR, t)
}

/// The z whose upper tail is `p`, for any `p` below exp(−40).
fn magnitude_far(p: f64) -> f64 {
    if p > 0.0 {
        let t = (-elementary::ln(p)).sqrt() - 6.0;
        ascending(&FAR_NUMERATOR, t) / ascending(&FAR_DENOMINATOR, t)
    } else if p == 0.0 {
        f64::INFINITY
    } else {
        f64::NAN
    }
}

/// The z ≥ 0 whose upper tail is `p`, 0 ≤ `p` ≤ ½.
pub(crate) fn magnitude(p: f64) -> f64 {
    if p >= CENTRAL_TAIL {
        central_magnitude(p)
    } else if p >= FAR_TAIL {
        tail_magnitude(p)
    } else {
        magnitude_far(p)
    }
}

/// Distribution function Φ(z).
pub fn cdf(z: f64) -> f64 {
    if z <= 0.0 { tail(-z) } else { 1.0 - tail(z) }
}

/// Survival function 1 − Φ(z), as accurate in the upper tail as [`cdf`] in the lower.
pub fn survival(z: f64) -> f64 {
    cdf(-z)
}

/// Density φ(z).
pub fn density(z: f64) -> f64 {
    let head = f64::from_bits(z.to_bits() & 0xFFFF_FFFF_F800_0000);
    let rest = -0.5 * (z - head) * (z + head);
    if z.abs() < 40.0 {
        elementary::exp(-0.5 * head * head) * elementary::exp(rest) * INVERSE_ROOT_TWO_PI
    } else if z.is_nan() {
        z
    } else {
        0.0
    }
}

/// ln φ(z).
pub fn ln_density(z: f64) -> f64 {
    -0.5 * z * z - LN_ROOT_TWO_PI
}

/// ln Φ(z), accurate where Φ underflows and where it rounds to one.
pub fn ln_cdf(z: f64) -> f64 {
    if z > 0.0 {
        elementary::ln_1p(-tail(z))
    } else if z > -30.0 {
        elementary::ln(tail(-z))
    } else if z == f64::NEG_INFINITY {
        z
    } else {
        // Laplace's continued fraction of the Mills ratio: 12 terms leave less than 1e-17 at 30.
        let t = -z;
        let mut fraction = t;
        for k in (1..=12).rev() {
            fraction = t + f64::from(k) / fraction;
        }
        ln_density(t) - elementary::ln(fraction)
    }
}

/// ln(1 − Φ(z)).
pub fn ln_survival(z: f64) -> f64 {
    ln_cdf(-z)
}

/// The z whose lower tail is `p`; ±∞ at 1 and 0, NaN outside.
pub fn quantile(p: f64) -> f64 {
    if p <= 0.5 { -magnitude(p) } else { magnitude(1.0 - p) }
}

/// The z whose upper tail is `q`.
pub fn quantile_upper(q: f64) -> f64 {
    -quantile(q)
}

over_lanes! {
    /// [`central_magnitude`] of every tail, with its sign.
    fn signed_central_lanes(tails: &[f64], out: &mut [f64]) {
        for (out, &tail) in out.iter_mut().zip(tails) {
            *out = central_magnitude(tail.abs()).copysign(tail);
        }
    }
}

over_lanes! {
    /// [`tail_magnitude`] of every tail, in place.
    fn tail_lanes(tails: &mut [f64]) {
        for tail in tails.iter_mut() {
            *tail = tail_magnitude(*tail);
        }
    }
}

/// The z of every tail: that of the upper tail where it is positive, of the lower where it is negative, as
/// [`magnitude`] with its sign; NaN for tails below [`FAR_TAIL`], that are no straight line of arithmetic.
///
/// The one in seven that lies outside the middle is worked out apart: choosing between two approximations
/// value by value costs three times as much.
pub(crate) fn of_signed_tails(tails: &[f64], out: &mut [f64]) {
    const BLOCK: usize = 256;
    let mut places = [0; BLOCK];
    let mut outer = [0.0; BLOCK];
    for (tails, out) in tails.chunks(BLOCK).zip(out.chunks_mut(BLOCK)) {
        signed_central_lanes(tails, out);
        let mut count = 0;
        for (k, tail) in tails.iter().enumerate() {
            places[count] = k;
            outer[count] = tail.abs();
            count += usize::from(tail.abs() < CENTRAL_TAIL);
        }
        tail_lanes(&mut outer[..count]);
        for (&k, z) in places[..count].iter().zip(&outer) {
            let z = if tails[k].abs() >= FAR_TAIL { *z } else { f64::NAN };
            out[k] = z.copysign(tails[k]);
        }
    }
}

over_lanes! {
    /// The smaller tail at every probability, negative where it is the lower one.
    fn signed_tails(p: &[f64], out: &mut [f64]) {
        for (out, &p) in out.iter_mut().zip(p) {
            *out = if p <= 0.5 { -p } else { 1.0 - p };
        }
    }
}

/// [`quantile`] of every probability, with the same bits.
///
/// Takes as many values as the shorter slice has.
pub fn quantile_column(p: &[f64], out: &mut [f64]) {
    const BLOCK: usize = 256;
    let mut tails = [0.0; BLOCK];
    for (p, out) in p.chunks(BLOCK).zip(out.chunks_mut(BLOCK)) {
        let count = p.len().min(out.len());
        signed_tails(&p[..count], &mut tails[..count]);
        of_signed_tails(&tails[..count], out);
        for (out, &p) in out.iter_mut().zip(p) {
            if out.is_nan() || !(0.0..=1.0).contains(&p) {
                *out = quantile(p);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn property_columns_have_the_bits_of_the_scalars() {
        let p: Vec<f64> = (0..4001)
            .map(|k| match k {
                0 => 0.0,
                4000 => 1.0,
                1..=1000 => elementary::exp(-0.7 * f64::from(k)),
                _ => f64::from(k) / 4000.0,
            })
            .collect();
        let mut out = vec![0.0; p.len()];
        quantile_column(&p, &mut out);
        for (&p, &z) in p.iter().zip(&out) {
            assert_eq!(quantile(p).to_bits(), z.to_bits(), "p = {p}");
        }
        quantile_column(&[-0.1, 1.2, f64::NAN], &mut out);
        assert!(out[..3].iter().all(|z| z.is_nan()));
    }

    #[test]
    fn published_textbook_quantiles() {
        // NIST/SEMATECH e-Handbook of Statistical Methods, table 1.3.6.7.1, to its four digits.
        for (p, z) in [(0.975, 1.96), (0.95, 1.645), (0.99, 2.326), (0.5, 0.0)] {
            assert!((quantile(p) - z).abs() < 5e-4);
        }
    }
}
