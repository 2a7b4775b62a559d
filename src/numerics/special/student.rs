//! Student's t distribution.

use super::beta;

/// The upper tail at `t` ≥ 0.
fn tail(df: f64, t: f64) -> f64 {
    if df.is_nan() || df <= 0.0 {
        return f64::NAN;
    }
    if t == f64::INFINITY {
        return 0.0;
    }
    // P(|T| > t) = I_x(df/2, ½) with x = df/(df + t²), kept through the smaller of x and 1 − x.
    let ratio = t / df * t;
    if ratio <= 1.0 {
        0.5 * beta::tails_at(0.5 * df, 0.5, ratio / (1.0 + ratio), true).0
    } else {
        0.5 * beta::tails_at(0.5 * df, 0.5, 1.0 / (1.0 + ratio), false).0
    }
}

/// Distribution function with `df` > 0 degrees of freedom.
pub fn cdf(df: f64, t: f64) -> f64 {
    if t <= 0.0 { tail(df, -t) } else { 1.0 - tail(df, t) }
}

/// Survival function 1 − cdf.
pub fn survival(df: f64, t: f64) -> f64 {
    cdf(df, -t)
}

/// The t whose upper tail is `q`.
pub fn quantile_upper(df: f64, q: f64) -> f64 {
    if df.is_nan() || df <= 0.0 || !(0.0..=1.0).contains(&q) {
        return f64::NAN;
    }
    let smaller = if q > 0.5 { 1.0 - q } else { q };
    // The two-sided tail 2q where it is small, its complement (exact) where it is not.
    let (x, y) = if smaller < 0.25 {
        beta::quantile_pair(0.5 * df, 0.5, 2.0 * smaller, true)
    } else {
        beta::quantile_pair(0.5 * df, 0.5, 1.0 - 2.0 * smaller, false)
    };
    let t = (y / x).sqrt() * df.sqrt();
    if q > 0.5 { -t } else { t }
}

/// The t whose lower tail is `p`.
pub fn quantile(df: f64, p: f64) -> f64 {
    -quantile_upper(df, p)
}
