//! The binomial distribution of the number of successes in `n` trials of probability `p`.

use super::beta;
use super::deviance::{ln_ratio_minus, stirling_error};
use crate::numerics::elementary::{exp, ln, ln_1p};

/// P(K ≤ `k`).
pub fn cdf(k: u64, n: u64, p: f64) -> f64 {
    if !(0.0..=1.0).contains(&p) {
        f64::NAN
    } else if k >= n {
        1.0
    } else {
        beta::regularized_upper(k as f64 + 1.0, (n - k) as f64, p)
    }
}

/// P(K > `k`).
pub fn survival(k: u64, n: u64, p: f64) -> f64 {
    if !(0.0..=1.0).contains(&p) {
        f64::NAN
    } else if k >= n {
        0.0
    } else {
        beta::regularized(k as f64 + 1.0, (n - k) as f64, p)
    }
}

/// ln P(K = `k`), by Loader's saddle-point form.
pub fn ln_probability(k: u64, n: u64, p: f64) -> f64 {
    if !(0.0..=1.0).contains(&p) {
        return f64::NAN;
    }
    if k > n {
        return f64::NEG_INFINITY;
    }
    let (trials, hits, misses) = (n as f64, k as f64, (n - k) as f64);
    if k == 0 {
        return if n == 0 { 0.0 } else { trials * ln_1p(-p) };
    }
    if k == n {
        return trials * ln(p);
    }
    if p == 0.0 || p == 1.0 {
        return f64::NEG_INFINITY;
    }
    let excess = trials.mul_add(p, -hits);
    hits * ln_ratio_minus(trials * p / hits, excess / hits)
        + misses * ln_ratio_minus(trials * (1.0 - p) / misses, -excess / misses)
        + stirling_error(trials)
        - stirling_error(hits)
        - stirling_error(misses)
        - 0.5 * ln(2.0 * std::f64::consts::PI * hits * (misses / trials))
}

/// P(K = `k`).
pub fn probability(k: u64, n: u64, p: f64) -> f64 {
    exp(ln_probability(k, n, p))
}
