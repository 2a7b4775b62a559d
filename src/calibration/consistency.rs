//! Whether data agree: with other data, with the prior, with the noise that they are said to have.
//!
//! A sampler that has converged says nothing of this: two runs of different brakes have a posterior, too.
//!
//! All three tests are exact where the model is linear and the errors are normal with known sizes, and are used about
//! the most probable point elsewhere.

use crate::error::{Error, Result};
use crate::numerics::special::chi_squared as chi;
use nalgebra::{Cholesky, DMatrix, DVector};
use serde::Serialize;

/// Information, in units of the prior's, from which on data have a say in a direction.
const SAY: f64 = 1.0;
/// Share of the prior's variance that must be gone for a direction to count as learned.
const LEARNED: f64 = 0.5;

/// A normal law of parameters whose prior is N(0, I).
#[derive(Debug, Clone, PartialEq)]
pub struct NormalLaw {
    /// Mean.
    pub mean: DVector<f64>,
    /// Covariance.
    pub covariance: DMatrix<f64>,
}

/// A statistic that follows a chi-squared law where everything is as it is said to be.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ChiSquared {
    /// The statistic.
    pub statistic: f64,
    /// Degrees of freedom; with none, nothing was tested.
    pub degrees: usize,
    /// Probability of so much or more.
    pub p: f64,
}

impl ChiSquared {
    fn new(statistic: f64, degrees: usize) -> Self {
        let p = if degrees == 0 { 1.0 } else { chi::survival(degrees as f64, statistic) };
        ChiSquared { statistic, degrees, p }
    }
}

/// Data against what other data expect of them: `own` is the posterior from the data alone, `others` that from the others.
///
/// The data's own information is `C⁻¹ − I`; along each of its eigenvectors v of eigenvalue λ they are one reading
/// `vᵀC⁻¹m/√λ` of `√λ vᵀθ` with error one, of which the others expect `√λ vᵀm′` with the variance `λ vᵀC′v + 1`: the
/// posterior predictive check of data left out (Gelman and others, *Bayesian Data Analysis*, ch. 6).
///
/// # Errors
/// If a covariance is singular or the sizes differ.
pub fn left_out(own: &NormalLaw, others: &NormalLaw) -> Result<ChiSquared> {
    let n = own.mean.len();
    let singular =
        || Error::argument("the runs' laws cannot be compared: a covariance is singular");
    if others.mean.len() != n {
        return Err(singular());
    }
    let inverse = Cholesky::new(own.covariance.clone()).ok_or_else(singular)?.inverse();
    let gradient = &inverse * &own.mean;
    let eigen = (inverse - DMatrix::identity(n, n)).symmetric_eigen();
    let kept: Vec<usize> = (0..n).filter(|&k| eigen.eigenvalues[k] >= SAY).collect();
    let mut readings = DMatrix::zeros(kept.len(), n);
    let mut off = DVector::zeros(kept.len());
    for (row, &k) in kept.iter().enumerate() {
        let (root, vector) = (eigen.eigenvalues[k].sqrt(), eigen.eigenvectors.column(k));
        for j in 0..n {
            readings[(row, j)] = root * vector[j];
        }
        off[row] = vector.dot(&gradient) / root - root * vector.dot(&others.mean);
    }
    let variance = DMatrix::identity(kept.len(), kept.len())
        + &readings * &others.covariance * readings.transpose();
    let solved = Cholesky::new(variance).ok_or_else(singular)?.solve(&off);
    Ok(ChiSquared::new(off.dot(&solved), kept.len()))
}

/// The posterior's mean against the prior: where the prior is right, the mean along a principal direction in which the
/// posterior has the variance λ has the variance 1 − λ.
pub fn prior_conflict(posterior: &NormalLaw) -> ChiSquared {
    let eigen = posterior.covariance.clone().symmetric_eigen();
    let mut statistic = 0.0;
    let mut degrees = 0;
    for (k, &left) in eigen.eigenvalues.iter().enumerate() {
        if left <= 1.0 - LEARNED {
            let along = eigen.eigenvectors.column(k).dot(&posterior.mean);
            statistic += along * along / (1.0 - left);
            degrees += 1;
        }
    }
    ChiSquared::new(statistic, degrees)
}

/// Whether standardised readings, one after the other, are independent: Ljung and Box's statistic of their first
/// autocorrelations (Biometrika 65, 1978).
pub fn whiteness(scores: &[f64], lags: usize) -> ChiSquared {
    let n = scores.len();
    let lags = lags.min(n / 5);
    let mean = scores.iter().sum::<f64>() / n.max(1) as f64;
    let product = |lag: usize| -> f64 {
        scores.iter().zip(scores.iter().skip(lag)).map(|(a, b)| (a - mean) * (b - mean)).sum()
    };
    let variance = product(0);
    if lags == 0 || variance <= 0.0 {
        return ChiSquared::new(0.0, 0);
    }
    let sum: f64 = (1..=lags)
        .map(|lag| {
            let correlation = product(lag) / variance;
            correlation * correlation / (n - lag) as f64
        })
        .sum();
    ChiSquared::new((n * (n + 2)) as f64 * sum, lags)
}
