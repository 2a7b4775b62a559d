//! Correlated standard normal values given some of them.

use crate::error::{Error, Result};
use crate::numerics::columns::Columns;
use nalgebra::{DMatrix, DVector};

/// How the values of a Gaussian vector follow when some are given: with the residual correction
/// z + R₍·ᵤ₎ R₍ᵤᵤ₎⁻¹ (given − zᵤ), a draw of the vector becomes a draw of its law given those (Matheron's rule; see
/// Journel and Huijbregts, *Mining Geostatistics*, 1978, ch. VII).
#[derive(Debug, Clone)]
pub struct Conditioning {
    given: Vec<usize>,
    /// R₍·ᵤ₎ R₍ᵤᵤ₎⁻¹: rows = values, columns = given ones.
    gain: DMatrix<f64>,
}

impl Conditioning {
    /// The rule for a correlation matrix (its rows) and the places of the given values.
    ///
    /// # Errors
    /// If a place is not there or named twice, or the given values determine each other.
    pub fn new(correlation: Vec<Vec<f64>>, given: &[usize]) -> Result<Self> {
        let n = correlation.len();
        let twice = given.iter().enumerate().any(|(k, j)| given[..k].contains(j));
        if twice || given.iter().any(|&j| j >= n) || correlation.iter().any(|row| row.len() != n) {
            return Err(Error::argument("given values must be different members of the vector"));
        }
        let within =
            DMatrix::from_fn(given.len(), given.len(), |i, j| correlation[given[i]][given[j]]);
        let across = DMatrix::from_fn(given.len(), n, |i, j| correlation[given[i]][j]);
        let factor = within
            .cholesky()
            .ok_or_else(|| Error::argument("the given values determine each other"))?;
        Ok(Conditioning { given: given.to_vec(), gain: factor.solve(&across).transpose() })
    }

    /// Corrects row `k` of a table of draws so that the given places hold `values`.
    pub fn apply(&self, draws: &mut Columns, k: usize, values: &[f64]) {
        let residual = DVector::from_iterator(
            self.given.len(),
            self.given.iter().zip(values).map(|(&j, value)| value - draws.get(k, j)),
        );
        let correction = &self.gain * residual;
        for (j, correction) in correction.iter().enumerate() {
            draws.set(k, j, draws.get(k, j) + correction);
        }
        for (&j, &value) in self.given.iter().zip(values) {
            draws.set(k, j, value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_two_correlated_values_follow_the_regression_line() {
        let rule = Conditioning::new(vec![vec![1.0, 0.8], vec![0.8, 1.0]], &[0]).unwrap();
        let mut draws = Columns::from_rows(&[[0.5, -0.2]]);
        rule.apply(&mut draws, 0, &[1.5]);
        // The mean of the second given the first is 0.8 times it; the draw's residual is kept.
        let residual = -0.2 - 0.8 * 0.5;
        assert!((draws.get(0, 1) - (0.8 * 1.5 + residual)).abs() < 1e-15);
        assert_eq!(draws.get(0, 0), 1.5);
        assert!(Conditioning::new(vec![vec![1.0]], &[0, 0]).is_err());
    }
}
