//! What a further measurement would teach: expected narrowing of a quantity that depends on the parameters.
//!
//! The approximation: about the posterior, parameters are jointly normal and both the measurement and the quantity of
//! interest `q` are linear in them. Then what the measurement's value will be does not matter: with the posterior
//! covariance `C`, the information `F = JᵀR⁻¹J` of the measurement, and the slope `g` of `q`, the variance of `q` goes
//! from `gᵀC g` to `gᵀ(C⁻¹ + F)⁻¹ g` whatever is read (the preposterior analysis of the linear-Gaussian model; Raiffa and
//! Schlaifer, 1961, ch. 5). `g` is the least-squares slope of `q` on the draws of the posterior, and what it leaves
//! unexplained is taken as out of any measurement's reach.

use crate::error::{Error, Result};
use nalgebra::{Cholesky, DMatrix, DVector};

/// A quantity that depends on the parameters, as the posterior's draws show it.
#[derive(Debug, Clone)]
pub struct Dependence {
    /// Covariance of the parameters over the draws.
    pub covariance: DMatrix<f64>,
    /// Slope of the quantity.
    pub slope: DVector<f64>,
    /// Mean of the quantity.
    pub mean: f64,
    /// Variance of the quantity that the parameters explain linearly.
    pub explained: f64,
    /// Variance of the quantity over the draws, less that of its own estimation.
    pub variance: f64,
}

impl Dependence {
    /// The dependence of `quantity` (one entry a draw) on the draws' parameters; `own_variance` is the variance that
    /// each entry has from its estimation alone.
    ///
    /// # Errors
    /// If there are fewer draws than parameters, or the draws do not vary.
    pub fn new(draws: &[Vec<f64>], quantity: &[f64], own_variance: f64) -> Result<Self> {
        let (n, d) = (draws.len(), draws.first().map_or(0, Vec::len));
        if n != quantity.len() || n < 3 * d + 3 {
            return Err(Error::argument(format!(
                "{n} draws are too few for the slopes of {d} parameters"
            )));
        }
        let count = n as f64;
        let means: Vec<f64> =
            (0..d).map(|j| draws.iter().map(|row| row[j]).sum::<f64>() / count).collect();
        let mean = quantity.iter().sum::<f64>() / count;
        let mut covariance = DMatrix::zeros(d, d);
        let mut with = DVector::zeros(d);
        let mut variance = 0.0;
        for (row, &q) in draws.iter().zip(quantity) {
            let from = DVector::from_fn(d, |j, _| row[j] - means[j]);
            covariance.ger(1.0 / (count - 1.0), &from, &from, 1.0);
            with.axpy((q - mean) / (count - 1.0), &from, 1.0);
            variance += (q - mean) * (q - mean) / (count - 1.0);
        }
        let solver = Cholesky::new(covariance.clone()).ok_or_else(|| {
            Error::argument("the draws of the posterior do not vary in every parameter")
        })?;
        let slope = solver.solve(&with);
        // Slopes fitted to noise explain a share d/n of it.
        let raw = slope.dot(&with);
        let left = (variance - raw).max(0.0) * count / (count - d as f64).max(1.0);
        let explained = (raw - left * d as f64 / count).max(0.0);
        let variance = (variance - own_variance).max(explained);
        Ok(Dependence { covariance, slope, mean, explained, variance })
    }

    /// Standard deviation of the quantity now.
    pub fn sd(&self) -> f64 {
        self.variance.sqrt()
    }

    /// Standard deviation of the quantity expected after a measurement with this information (rows and columns the
    /// parameters').
    ///
    /// # Errors
    /// If the information has another size.
    pub fn sd_after(&self, information: &DMatrix<f64>) -> Result<f64> {
        let d = self.slope.len();
        if information.shape() != (d, d) {
            return Err(Error::argument("the information is of other parameters"));
        }
        // (C⁻¹ + F)⁻¹ = (I + C F)⁻¹ C, which asks for no inverse of C.
        let matrix = DMatrix::identity(d, d) + &self.covariance * information;
        let solved = matrix
            .lu()
            .solve(&(&self.covariance * &self.slope))
            .ok_or_else(|| Error::argument("the information of a measurement is not finite"))?;
        let raw = self.slope.dot(&(&self.covariance * &self.slope));
        let after = if raw > 0.0 { self.slope.dot(&solved) / raw } else { 1.0 };
        Ok((self.variance - self.explained * (1.0 - after.clamp(0.0, 1.0))).max(0.0).sqrt())
    }
}
