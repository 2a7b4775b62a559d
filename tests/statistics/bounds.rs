//! Bounds that a statistic of a fixed-seed test may not cross.
//!
//! Every test of chance here is held to a level of 1e-6 on each side, so that the few thousand
//! comparisons of the suite together would fail a right program about once in a hundred seeds.

/// The standard normal quantile of 1 − 1e-6.
pub const NORMAL: f64 = 4.753_424;

/// The Kolmogorov statistic √n D of level 1e-6, from its leading term 2 exp(−2 x²).
pub const KOLMOGOROV: f64 = 2.693;

/// Chi-squared quantiles of 1e-6 and 1 − 1e-6 (E. B. Wilson, M. M. Hilferty, PNAS 17, 1931: within 2 %
/// at this level for the 6 and more degrees of freedom used).
pub fn chi_squared(df: f64) -> (f64, f64) {
    let spread = NORMAL * (2.0 / (9.0 * df)).sqrt();
    let at = |offset: f64| df * (1.0 - 2.0 / (9.0 * df) + offset).max(0.0).powi(3);
    (at(-spread), at(spread))
}

/// Pearson's statistic of `counts` against equal expectations.
pub fn pearson(counts: &[u64]) -> f64 {
    let expected = counts.iter().sum::<u64>() as f64 / counts.len() as f64;
    counts.iter().map(|&count| (count as f64 - expected).powi(2) / expected).sum()
}

/// Asserts that equally probable cells were hit as chance would, neither too unevenly nor too evenly.
pub fn assert_uniform(counts: &[u64], what: &str) {
    let (low, high) = chi_squared(counts.len() as f64 - 1.0);
    let statistic = pearson(counts);
    assert!(statistic < high && statistic > low, "{what}: {statistic} not in {low}..{high}");
}

/// Mean and unbiased variance.
pub fn moments(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, squares / (n - 1.0))
}
