//! The chi-squared distribution, through the gamma's.

use super::gamma;

/// Distribution function with `df` degrees of freedom.
pub fn cdf(df: f64, x: f64) -> f64 {
    gamma::regularized_lower(0.5 * df, 0.5 * x.max(0.0))
}

/// Survival function with `df` degrees of freedom.
pub fn survival(df: f64, x: f64) -> f64 {
    gamma::regularized_upper(0.5 * df, 0.5 * x.max(0.0))
}

/// The value whose lower tail is `p`.
pub fn quantile_lower(df: f64, p: f64) -> f64 {
    2.0 * gamma::quantile_lower(0.5 * df, p)
}

/// The value whose upper tail is `q`.
pub fn quantile_upper(df: f64, q: f64) -> f64 {
    2.0 * gamma::quantile_upper(0.5 * df, q)
}
