//! Every law, whole and truncated, against mpmath: tails, quantiles, densities, means, spreads.
//!
//! Tolerance: 1e-12, the project's requirement, relative to the value or, for a law that straddles
//! zero or sits on a location, to its standard deviation if that is larger: near zero a difference of
//! two large numbers cannot be relatively accurate.

use super::reference::{Errors, list, number, values};
use reeldown::uncertainty::{Law, Marginal};
use serde_json::Value;

const TOLERANCE: f64 = 1e-12;

/// The law of a reference entry.
fn law(entry: &Value) -> Law {
    let p: Vec<f64> = list(entry, "parameters").iter().filter_map(Value::as_f64).collect();
    match entry["family"].as_str().unwrap() {
        "normal" => Law::normal(p[0], p[1]).unwrap(),
        "lognormal" => Law::Lognormal { log_mean: p[0], log_sd: p[1] },
        "uniform" => Law::uniform(p[0], p[1]).unwrap(),
        "triangular" => Law::triangular(p[0], p[1], p[2]).unwrap(),
        "beta" => Law::beta(p[0], p[1], p[2], p[3]).unwrap(),
        "weibull" => Law::weibull(p[0], p[1], p[2]).unwrap(),
        "gumbel" => Law::gumbel(p[0], p[1]).unwrap(),
        "gumbel_minimum" => Law::gumbel_minimum(p[0], p[1]).unwrap(),
        "gamma" => Law::gamma(p[0], p[1], p[2]).unwrap(),
        "exponential" => Law::exponential(p[0], p[1]).unwrap(),
        other => panic!("no family {other}"),
    }
}

/// The reference entries with their marginals.
fn cases() -> Vec<(Marginal, Value)> {
    let reference = values();
    let entries = list(&reference, "laws").to_vec();
    entries
        .into_iter()
        .map(|entry| {
            let limit = |key: &str| entry[key].as_f64();
            (Marginal::new(law(&entry), limit("lower"), limit("upper")).unwrap(), entry)
        })
        .collect()
}

/// "normal [1, 2] within 0, 3".
fn named(entry: &Value) -> String {
    format!(
        "{} {} within {}, {}",
        entry["family"], entry["parameters"], entry["lower"], entry["upper"]
    )
}

#[test]
fn reference_mpmath_quantiles() {
    let mut errors = Errors::new("law quantiles", TOLERANCE);
    for (marginal, entry) in cases() {
        let sd = number(&entry, "sd");
        // A law on [0, …) keeps its relative precision down to zero.
        let (least, _) = marginal.law().support();
        let floor = if least == 0.0 { 0.0 } else { sd };
        for row in list(&entry, "rows") {
            let (lower, upper) = (number(row, "lower"), number(row, "upper"));
            let (below, above) = (number(row, "quantile_lower"), number(row, "quantile_upper"));
            errors.check_scaled(
                marginal.quantile_lower(lower),
                below,
                below.abs().max(floor),
                || format!("{} quantile_lower({lower:e})", named(&entry)),
            );
            errors.check_scaled(
                marginal.quantile_upper(upper),
                above,
                above.abs().max(floor),
                || format!("{} quantile_upper({upper:e})", named(&entry)),
            );
        }
    }
    errors.finish(700);
}

#[test]
fn reference_mpmath_tails() {
    let mut errors = Errors::new("law tails", TOLERANCE);
    for (marginal, entry) in cases() {
        for row in list(&entry, "rows") {
            let x = number(row, "x");
            // The rounding of x itself moves a tail by as much as the density times a rounding unit
            // of x and of the location that is subtracted from it: no function of x can do better.
            let (location, _) = marginal.support();
            let size = x.abs() + if location.is_finite() { location.abs() } else { 0.0 };
            let rounding = size.max(marginal.law().mean().abs()) * 2.2e-16;
            let density = number(row, "ln_density").exp();
            for (name, got) in [("lower", marginal.cdf(x)), ("upper", marginal.survival(x))] {
                let expected = number(row, name);
                if expected > 1e-290 {
                    let scale = expected + density * rounding / TOLERANCE;
                    errors.check_scaled(got, expected, scale, || {
                        format!("{} {name} tail at {x:e}", named(&entry))
                    });
                }
            }
        }
    }
    errors.finish(700);
}

#[test]
fn reference_mpmath_densities() {
    let mut errors = Errors::new("law densities", TOLERANCE);
    for (marginal, entry) in cases() {
        let law = marginal.law();
        for row in list(&entry, "rows") {
            let x = number(row, "x");
            let expected = number(row, "ln_density");
            // As for the tails: what the rounding of x − location does to the logarithm.
            let (location, end) = law.support();
            let size = [x, location, end, law.mean()]
                .iter()
                .filter(|v| v.is_finite())
                .fold(0.0_f64, |a, b| a.max(b.abs()));
            let h = 4.0 * f64::EPSILON * size;
            let change = (law.ln_density(x + h) - law.ln_density(x - h)).abs();
            let change = if change.is_finite() { change } else { 1.0 };
            let scale = expected.abs().max(1.0) + change / TOLERANCE;
            errors.check_scaled(marginal.ln_density(x), expected, scale, || {
                format!("{} ln_density({x:e})", named(&entry))
            });
        }
    }
    errors.finish(700);
}

#[test]
fn reference_mpmath_means_and_spreads() {
    // 1e-10 of the spread: what the quadrature over a truncated law is asked for.
    let mut errors = Errors::new("law moments", 1e-10);
    for (marginal, entry) in cases() {
        let (mean, sd) = (number(&entry, "mean"), number(&entry, "sd"));
        errors.check_scaled(marginal.mean(), mean, sd, || format!("{} mean", named(&entry)));
        errors.check(marginal.sd(), sd, || format!("{} sd", named(&entry)));
    }
    errors.finish(90);
}
