//! The gamma function and the gamma distribution: regularised incomplete functions and their inverses.

use super::deviance::{ln_ratio_minus, stirling_error};
use super::inversion::{Tail, solve};
use super::quadrature::integral;
use super::{deviance, normal};
use crate::numerics::elementary::{exp, exp_m1, ln, ln_gamma as elementary_ln_gamma};

/// 1/√(2π).
const INVERSE_ROOT_TWO_PI: f64 = 0.398_942_280_401_432_7;
/// From this shape on the tail is integrated, since series and fraction need some 5 √a terms.
const LARGE_SHAPE: f64 = 1000.0;

/// ln Γ(a) for a > 0, to about an ulp of max(1, |ln Γ|).
pub fn ln_gamma(a: f64) -> f64 {
    elementary_ln_gamma(a)
}

/// x^a e^(−x)/Γ(a + 1).
fn prefix(a: f64, x: f64) -> f64 {
    if a >= 1.0 {
        let exponent = a * ln_ratio_minus(x / a, (x - a) / a) - stirling_error(a);
        exp(exponent) * (INVERSE_ROOT_TWO_PI / a.sqrt())
    } else {
        exp(a * ln(x) - x - ln_gamma(1.0 + a))
    }
}

/// Both regularised incomplete gamma functions (P, Q) at `x` > 0.
pub(crate) fn tails(a: f64, x: f64) -> (f64, f64) {
    if !(a > 0.0 && a.is_finite()) || x.is_nan() || x < 0.0 {
        return (f64::NAN, f64::NAN);
    }
    if x == 0.0 {
        return (0.0, 1.0);
    }
    if x == f64::INFINITY {
        return (1.0, 0.0);
    }
    let prefix = prefix(a, x);
    if a >= LARGE_SHAPE && (x - a).abs() < 0.3 * a {
        let tail = integrated_tail(a, x, prefix);
        return if x < a { (tail, 1.0 - tail) } else { (1.0 - tail, tail) };
    }
    if a < 1.0 && x < 1.5 {
        return small_shape_tails(a, x);
    }
    if x < a + 1.0 {
        let lower = prefix * series(a, x);
        (lower, 1.0 - lower)
    } else {
        let upper = prefix * a * fraction(a, x);
        (1.0 - upper, upper)
    }
}

/// 1 + x/(a + 1) + x²/((a + 1)(a + 2)) + …
fn series(a: f64, x: f64) -> f64 {
    let mut term = 1.0;
    let mut sum = 1.0;
    let mut shape = a;
    while term > 1e-17 * sum {
        shape += 1.0;
        term *= x / shape;
        sum += term;
    }
    sum
}

/// Legendre's continued fraction of Γ(a, x) e^x/x^a for x ≥ max(1, a + 1), by Lentz' method.
fn fraction(a: f64, x: f64) -> f64 {
    let mut b = x + 1.0 - a;
    let mut c = f64::INFINITY;
    let mut d = 1.0 / b;
    let mut value = d;
    for k in 1..100_000 {
        let k = f64::from(k);
        let numerator = -k * (k - a);
        b += 2.0;
        d = 1.0 / (numerator * d + b);
        c = b + numerator / c;
        let factor = c * d;
        value *= factor;
        if (factor - 1.0).abs() < 2e-16 {
            break;
        }
    }
    value
}

/// (P, Q) for a < 1 and x < 1.5, where 1 − P would lose the digits of Q.
fn small_shape_tails(a: f64, x: f64) -> (f64, f64) {
    // P = x^a/Γ(1 + a) · (1 + a Σ (−x)^n/(n! (a + n))).
    let mut power = 1.0;
    let mut sum = 0.0;
    let mut n = 0.0;
    loop {
        n += 1.0;
        power *= -x / n;
        let term = power / (a + n);
        sum += term;
        if term.abs() <= 1e-18 {
            break;
        }
    }
    let exponent = a * ln(x) - ln_gamma_1p(a);
    let head = exp(exponent);
    let lower = head * (1.0 + a * sum);
    if lower < 0.5 { (lower, 1.0 - lower) } else { (lower, -exp_m1(exponent) - head * a * sum) }
}

/// ln Γ(1 + a) for 0 ≤ a < 1, relatively accurate at small a.
pub(super) fn ln_gamma_1p(a: f64) -> f64 {
    if a > 0.05 {
        return ln_gamma(1.0 + a);
    }
    // −γ a + Σ ζ(k) (−a)^k/k.
    const ZETA_OVER_K: [f64; 12] = [
        1.000_244_140_625 / 12.0,
        -1.000_494_188_604_119_5 / 11.0,
        1.000_994_575_127_818_2 / 10.0,
        -1.002_008_392_826_082_2 / 9.0,
        1.004_077_356_197_944_3 / 8.0,
        -1.008_349_277_381_922_8 / 7.0,
        1.017_343_061_984_449 / 6.0,
        -1.036_927_755_143_37 / 5.0,
        1.082_323_233_711_138_2 / 4.0,
        -1.202_056_903_159_594_3 / 3.0,
        1.644_934_066_848_226_4 / 2.0,
        -0.577_215_664_901_532_9,
    ];
    a * super::kernels::descending(&ZETA_OVER_K, a)
}

/// The tail beyond `x` away from the mean, from the density at `x` and its fall, for a large shape.
fn integrated_tail(a: f64, x: f64, prefix: f64) -> f64 {
    // The density at x(1 + v) is the one at x times exp((a − 1)(ln(1 + v) − v) + (a − 1 − x) v).
    let order = a - 1.0;
    let slope = order - x;
    let fall = |v: f64| exp(order * deviance::ln_1p_minus(v) + slope * v);
    // Where the fall, taken as quadratic, has reached 60 e-folds: the cubic term takes back a fifth.
    const FALL: f64 = 60.0;
    let steep = slope.abs().max(0.0);
    let reach = 2.0 * FALL / (steep + (steep * steep + 2.0 * FALL * order).sqrt());
    let (from, to) = if x < a { (-reach.min(1.0), 0.0) } else { (0.0, reach) };
    prefix * a * integral(from, to, fall)
}

/// P(a, x): the lower tail at `x` of the gamma law of shape `a` > 0 and scale 1.
pub fn regularized_lower(a: f64, x: f64) -> f64 {
    tails(a, x).0
}

/// Q(a, x) = 1 − P(a, x): the upper tail.
pub fn regularized_upper(a: f64, x: f64) -> f64 {
    tails(a, x).1
}

/// ln of the gamma density of shape `a` and scale 1 at `x`.
pub fn ln_density(a: f64, x: f64) -> f64 {
    if x < 0.0 {
        f64::NEG_INFINITY
    } else if a >= 1.0 && x > 0.0 {
        a * ln_ratio_minus(x / a, (x - a) / a) - stirling_error(a) + 0.5 * ln(a) - ln(x)
            + ln(INVERSE_ROOT_TWO_PI)
    } else if a == 1.0 {
        -x
    } else {
        (a - 1.0) * ln(x) - x - ln_gamma(a)
    }
}

/// The x whose lower tail P(a, x) is `p`.
pub fn quantile_lower(a: f64, p: f64) -> f64 {
    if p > 0.5 { invert(a, 1.0 - p, false) } else { invert(a, p, true) }
}

/// The x whose upper tail Q(a, x) is `q`.
pub fn quantile_upper(a: f64, q: f64) -> f64 {
    if q > 0.5 { invert(a, 1.0 - q, true) } else { invert(a, q, false) }
}

/// The x whose tail is `p` ≤ ½.
fn invert(a: f64, p: f64, lower: bool) -> f64 {
    if !(a > 0.0 && a.is_finite()) || p.is_nan() || p < 0.0 {
        return f64::NAN;
    }
    if p == 0.0 {
        return if lower { 0.0 } else { f64::INFINITY };
    }
    let below = if lower { p } else { 1.0 - p };
    // The leading term of P near zero: P ≈ x^a/Γ(a + 1), short by the factor 1 − a x/(a + 1).
    let leading = if a < 1.0 { ln_gamma_1p(a) } else { ln_gamma(a + 1.0) };
    let near_zero = exp((ln(below) + leading) / a);
    if lower && near_zero < 1e-17 {
        return near_zero;
    }
    let z = if lower { normal::quantile(p) } else { normal::quantile_upper(p) };
    let cube_root = 1.0 - 1.0 / (9.0 * a) + z / (3.0 * a.sqrt());
    let start = if a >= 0.5 && cube_root > 0.2 {
        // Wilson and Hilferty (1931).
        a * cube_root * cube_root * cube_root
    } else if lower || near_zero < 0.5 {
        near_zero
    } else {
        (-ln(p) - ln_gamma(a)).max(0.5)
    };
    let sign = if lower { 1.0 } else { -1.0 };
    solve(p, start, (0.0, f64::INFINITY), lower, |x| {
        let (below, above) = tails(a, x);
        Tail {
            value: if lower { below } else { above },
            weight: sign * prefix(a, x) * a,
            bend: a - x,
        }
    })
}
