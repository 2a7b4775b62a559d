//! The Nataf model: which normal correlation gives two marginals a stated product-moment correlation.

use super::Empirical;
use super::marginal::Marginal;
use crate::error::{Error, Result};
use crate::numerics::special::normal;

/// Terms of the Hermite expansion: the k-th is weighted by ρ^k and products of coefficients that
/// are summable at |ρ| = 1.
const TERMS: usize = 80;
/// The trapezoidal rule over [−13, 13]: beyond it the normal weight is below 1e-37.
const REACH: f64 = 13.0;
const NODES: i32 = 2600;

/// The normalised Hermite coefficients 1 … [`TERMS`] of the marginal's value as a function of z,
/// divided by its standard deviation.
fn coefficients(marginal: &Marginal) -> Vec<f64> {
    let (centre, spread) = marginal.moments();
    if let Some(listed) = marginal.stepped() {
        return coefficients_of_steps(listed, spread);
    }
    let step = 2.0 * REACH / f64::from(NODES);
    let mut sums = vec![0.0; TERMS];
    for node in 0..=NODES {
        let z = -REACH + step * f64::from(node);
        let value = (marginal.from_standard_normal(z) - centre) / spread;
        let weight = step * normal::density(z) * value;
        // h(k + 1) = (z h(k) − √k h(k − 1))/√(k + 1), orthonormal under the normal density.
        let (mut before, mut here) = (0.0, 1.0);
        for (k, sum) in sums.iter_mut().enumerate() {
            let k = k as f64;
            let next = (z * here - k.sqrt() * before) / (k + 1.0).sqrt();
            (before, here) = (here, next);
            *sum += weight * here;
        }
    }
    sums
}

/// [`coefficients`] of a quantile function that jumps, where the trapezoidal rule would lose its digits.
///
/// By parts, ∫ x(z) h(k) φ dz = ∫ h(k − 1) φ/√k dx: a jump adds its height at its place exactly, and a
/// linear stretch is cut into short ones.
fn coefficients_of_steps(listed: &Empirical, spread: f64) -> Vec<f64> {
    const CUTS: usize = 64;
    let mut sums = vec![0.0; TERMS];
    let mut add = |z: f64, height: f64| {
        let weight = height * normal::density(z) / spread;
        let (mut before, mut here) = (0.0, 1.0);
        for (k, sum) in sums.iter_mut().enumerate() {
            let k = k as f64;
            *sum += weight * here / (k + 1.0).sqrt();
            let next = (z * here - k.sqrt() * before) / (k + 1.0).sqrt();
            (before, here) = (here, next);
        }
    };
    let place = |(below, above): (f64, f64)| {
        if below <= above { normal::quantile(below) } else { normal::quantile_upper(above) }
    };
    for ([from, to], (low, high)) in listed.steps() {
        if from.0 == to.0 || from.1 == to.1 {
            add(place(from), high - low);
            continue;
        }
        for cut in 0..CUTS {
            let share = (cut as f64 + 0.5) / CUTS as f64;
            let at = |a: f64, b: f64| a * (1.0 - share) + b * share;
            add(place((at(from.0, to.0), at(from.1, to.1))), (high - low) / CUTS as f64);
        }
    }
    sums
}

/// The product-moment correlation of two marginals whose standard normal variables have correlation
/// `rho_normal`: Σ c(k) d(k) ρ^k with their Hermite coefficients (Mehler's expansion).
pub fn product_moment_correlation(first: &Marginal, second: &Marginal, rho_normal: f64) -> f64 {
    series(&products(first, second), rho_normal)
}

fn products(first: &Marginal, second: &Marginal) -> Vec<f64> {
    coefficients(first).iter().zip(coefficients(second)).map(|(c, d)| c * d).collect()
}

fn series(products: &[f64], rho: f64) -> f64 {
    products.iter().rev().fold(0.0, |sum, product| rho * (sum + product))
}

/// The normal correlation that gives two marginals the product-moment correlation `rho`.
///
/// Source: A. Der Kiureghian and P.-L. Liu, *Structural Reliability under Incomplete Probability
/// Information* (1986), whose tabulated formulas approximate what is solved here.
///
/// # Errors
/// If `rho` is outside what the two laws can attain, or no number.
pub fn normal_correlation(first: &Marginal, second: &Marginal, rho: f64) -> Result<f64> {
    let products = products(first, second);
    let (mut low, mut high) = (-1.0, 1.0);
    let (least, greatest) = (series(&products, low), series(&products, high));
    if !(rho > least && rho < greatest) {
        return Err(Error::argument(format!(
            "a {} and a {} law cannot have the product-moment correlation {rho}: only values between \
             {least:.4} and {greatest:.4}",
            first.law().family(),
            second.law().family(),
        )));
    }
    // The correlation increases with its normal one (Lancaster): a bisection to the last bit.
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if series(&products, middle) < rho {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(0.5 * (low + high))
}
