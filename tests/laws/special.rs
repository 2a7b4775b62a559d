//! Special functions against mpmath, both tails, down to 1e-290.
//!
//! Tolerance of the quantiles: 1e-12, the project's requirement. Tails: a tail e^(−E) can only be as
//! good as its exponent, |E| rounding units, so 1e-12 is some 7 times what rounding costs at 1e-290.

use super::reference::{Errors, list, number, values};
use reeldown::numerics::special::{beta, binomial, chi_squared, gamma, normal, student};

const TOLERANCE: f64 = 1e-12;

#[test]
fn reference_mpmath_normal() {
    let reference = values();
    let mut tails = Errors::new("normal tails", 2e-15);
    let mut quantiles = Errors::new("normal quantiles", 1e-15);
    let mut logarithms = Errors::new("ln normal tails", 1e-14);
    for row in list(&reference, "normal") {
        let x = number(row, "x");
        if !row["p"].is_null() {
            let p = number(row, "p");
            quantiles.check(normal::quantile(p), x, || format!("quantile({p:e})"));
            continue;
        }
        let (lower, upper) = (number(row, "lower"), number(row, "upper"));
        // Subnormal tails have fewer digits.
        if lower > 1e-305 && upper > 1e-305 {
            tails.check(normal::cdf(x), lower, || format!("cdf({x})"));
            tails.check(normal::survival(x), upper, || format!("survival({x})"));
        }
        logarithms.check(normal::ln_cdf(x), number(row, "ln_lower"), || format!("ln_cdf({x})"));
        let (below, above) = (number(row, "quantile_lower"), number(row, "quantile_upper"));
        quantiles.check(normal::quantile(lower), below, || format!("quantile({lower:e})"));
        quantiles
            .check(normal::quantile_upper(upper), above, || format!("quantile_upper({upper:e})"));
    }
    tails.finish(200);
    quantiles.finish(130);
    logarithms.finish(100);
}

#[test]
fn reference_mpmath_gamma() {
    let reference = values();
    let mut tails = Errors::new("gamma tails", TOLERANCE);
    let mut quantiles = Errors::new("gamma quantiles", TOLERANCE);
    for row in list(&reference, "gamma") {
        let (a, x) = (number(row, "a"), number(row, "x"));
        let (lower, upper) = (number(row, "lower"), number(row, "upper"));
        if lower > 1e-290 {
            tails.check(gamma::regularized_lower(a, x), lower, || format!("P({a}, {x:e})"));
        }
        if upper > 1e-290 {
            tails.check(gamma::regularized_upper(a, x), upper, || format!("Q({a}, {x:e})"));
        }
        if lower < 0.99 {
            quantiles.check(gamma::quantile_lower(a, lower), number(row, "quantile_lower"), || {
                format!("quantile_lower({a}, {lower:e})")
            });
            quantiles.check(
                0.5 * chi_squared::quantile_lower(2.0 * a, lower),
                number(row, "quantile_lower"),
                || format!("chi-squared quantile_lower({a}, {lower:e})"),
            );
        }
        if upper < 0.99 {
            quantiles.check(gamma::quantile_upper(a, upper), number(row, "quantile_upper"), || {
                format!("quantile_upper({a}, {upper:e})")
            });
        }
    }
    tails.finish(300);
    quantiles.finish(300);
}

#[test]
fn reference_mpmath_beta() {
    let reference = values();
    let mut tails = Errors::new("beta tails", TOLERANCE);
    let mut quantiles = Errors::new("beta quantiles", TOLERANCE);
    for row in list(&reference, "beta") {
        let (a, b, x) = (number(row, "a"), number(row, "b"), number(row, "x"));
        let (lower, upper) = (number(row, "lower"), number(row, "upper"));
        if lower > 1e-290 {
            tails.check(beta::regularized(a, b, x), lower, || format!("I({a}, {b}, {x:e})"));
        }
        if upper > 1e-290 {
            tails.check(beta::regularized_upper(a, b, x), upper, || {
                format!("1 − I({a}, {b}, {x:e})")
            });
        }
        if lower < 0.99 {
            quantiles.check(
                beta::quantile_lower(a, b, lower),
                number(row, "quantile_lower"),
                || format!("quantile_lower({a}, {b}, {lower:e})"),
            );
        }
        if upper < 0.99 {
            quantiles.check(
                beta::quantile_upper(a, b, upper),
                number(row, "quantile_upper"),
                || format!("quantile_upper({a}, {b}, {upper:e})"),
            );
        }
    }
    tails.finish(300);
    quantiles.finish(300);
}

#[test]
fn reference_mpmath_student() {
    let reference = values();
    let mut tails = Errors::new("Student tails", TOLERANCE);
    let mut quantiles = Errors::new("Student quantiles", TOLERANCE);
    for row in list(&reference, "student") {
        let (df, t) = (number(row, "df"), number(row, "x"));
        let upper = number(row, "upper");
        tails.check(student::survival(df, t), upper, || format!("survival({df}, {t:e})"));
        tails.check(student::cdf(df, -t), upper, || format!("cdf({df}, −{t:e})"));
        tails.check(student::cdf(df, t), number(row, "lower"), || format!("cdf({df}, {t:e})"));
        // Near the median a rounded tail says where t is only to 1e-16 absolutely.
        let (got, expected) = (student::quantile_upper(df, upper), number(row, "quantile_upper"));
        quantiles.check_scaled(got, expected, expected.abs().max(1e-3), || {
            format!("quantile_upper({df}, {upper:e})")
        });
    }
    tails.finish(150);
    quantiles.finish(50);
}

#[test]
fn reference_mpmath_binomial() {
    let reference = values();
    let mut errors = Errors::new("binomial", TOLERANCE);
    for row in list(&reference, "binomial") {
        let (k, n, p) = (row["k"].as_u64().unwrap(), row["n"].as_u64().unwrap(), number(row, "p"));
        errors.check(binomial::cdf(k, n, p), number(row, "cdf"), || format!("cdf({k}, {n}, {p})"));
        errors.check(binomial::survival(k, n, p), number(row, "survival"), || {
            format!("survival({k}, {n}, {p})")
        });
        errors.check(binomial::probability(k, n, p), number(row, "probability"), || {
            format!("probability({k}, {n}, {p})")
        });
    }
    errors.finish(27);
}

#[test]
fn analytic_edges() {
    assert_eq!(normal::quantile(0.0), f64::NEG_INFINITY);
    assert_eq!(normal::quantile(1.0), f64::INFINITY);
    assert!(normal::quantile(-0.1).is_nan() && normal::quantile(1.1).is_nan());
    assert_eq!(gamma::quantile_lower(2.0, 0.0), 0.0);
    assert_eq!(gamma::quantile_lower(2.0, 1.0), f64::INFINITY);
    assert_eq!(gamma::quantile_upper(2.0, 0.0), f64::INFINITY);
    assert_eq!(beta::quantile_lower(2.0, 3.0, 0.0), 0.0);
    assert_eq!(beta::quantile_upper(2.0, 3.0, 0.0), 1.0);
    assert!(gamma::quantile_lower(-1.0, 0.5).is_nan());
    assert!(beta::quantile_lower(1.0, f64::NAN, 0.5).is_nan());
    assert!(beta::quantile_lower(1.0, 1.0, 1.5).is_nan());
    assert_eq!(student::quantile_upper(5.0, 0.5), 0.0);
    assert_eq!(binomial::cdf(10, 10, 0.3), 1.0);
    assert_eq!(binomial::probability(11, 10, 0.3), 0.0);
    // beta(1, b): the quantile is −expm1(ln1p(−p)/b); zero failures in 1e7 trials.
    for p in [1e-9, 0.05, 0.5, 0.95] {
        let exact = -libm_expm1(p, 1e7);
        assert!((beta::quantile_lower(1.0, 1e7, p) / exact - 1.0).abs() < 1e-14);
    }
}

/// expm1(ln(1 − p)/b).
fn libm_expm1(p: f64, b: f64) -> f64 {
    use reeldown::numerics::elementary::{exp_m1, ln_1p};
    exp_m1(ln_1p(-p) / b)
}
