//! Checked construction of the laws, in the parameters in which engineers state them.

use super::Law;
use crate::error::{Error, Result};
use crate::numerics::elementary::{ln, ln_1p};
use crate::uncertainty::empirical::Empirical;
use std::f64::consts::PI;

/// Euler's constant: the mean of the standard Gumbel law of a maximum.
pub(in crate::uncertainty) const EULER_GAMMA: f64 = 0.577_215_664_901_532_9;

/// Refuses a parameter that is not a finite number.
fn finite(law: &str, name: &str, value: f64) -> Result<()> {
    if value.is_finite() {
        Ok(())
    } else {
        Err(Error::argument(format!("a {law} law needs a finite {name}, not {value}")))
    }
}

/// Refuses a parameter that is not a finite number above zero.
fn positive(law: &str, name: &str, value: f64) -> Result<()> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(Error::argument(format!("a {law} law needs a {name} above zero, not {value}")))
    }
}

/// Refuses bounds that do not enclose an interval of finite width.
fn interval(law: &str, lower: f64, upper: f64) -> Result<()> {
    finite(law, "lower bound", lower)?;
    finite(law, "upper bound", upper)?;
    if lower < upper && (upper - lower).is_finite() {
        Ok(())
    } else {
        Err(Error::argument(format!(
            "a {law} law needs a lower bound below its upper bound, not {lower} and {upper}"
        )))
    }
}

impl Law {
    /// Normal law with `mean` and standard deviation `sd`.
    ///
    /// # Errors
    /// If `mean` is not finite or `sd` is not above zero.
    pub fn normal(mean: f64, sd: f64) -> Result<Law> {
        finite("normal", "mean", mean)?;
        positive("normal", "standard deviation", sd)?;
        Ok(Law::Normal { mean, sd })
    }

    /// Lognormal law with `median` and the standard deviation `log_sd` of the logarithm.
    ///
    /// # Errors
    /// If either is not above zero.
    pub fn lognormal_median_log_sd(median: f64, log_sd: f64) -> Result<Law> {
        positive("lognormal", "median", median)?;
        positive("lognormal", "standard deviation of the logarithm", log_sd)?;
        Ok(Law::Lognormal { log_mean: ln(median), log_sd })
    }

    /// Lognormal law with `median` and coefficient of variation `cv` (standard deviation over mean).
    ///
    /// # Errors
    /// If either is not above zero.
    pub fn lognormal_median_cv(median: f64, cv: f64) -> Result<Law> {
        positive("lognormal", "median", median)?;
        positive("lognormal", "coefficient of variation", cv)?;
        Law::lognormal_median_log_sd(median, ln_1p(cv * cv).sqrt())
    }

    /// Lognormal law with the `mean` and standard deviation `sd` of the quantity itself.
    ///
    /// # Errors
    /// If either is not above zero.
    pub fn lognormal_mean_sd(mean: f64, sd: f64) -> Result<Law> {
        positive("lognormal", "mean", mean)?;
        positive("lognormal", "standard deviation", sd)?;
        let ratio = sd / mean;
        let variance = ln_1p(ratio * ratio);
        positive("lognormal", "ratio of standard deviation to mean", variance)?;
        Ok(Law::Lognormal { log_mean: ln(mean) - 0.5 * variance, log_sd: variance.sqrt() })
    }

    /// Uniform law on [lower, upper].
    ///
    /// # Errors
    /// If the bounds are not finite and in order.
    pub fn uniform(lower: f64, upper: f64) -> Result<Law> {
        interval("uniform", lower, upper)?;
        Ok(Law::Uniform { lower, upper })
    }

    /// Triangular law on [lower, upper] with its peak at `mode`.
    ///
    /// # Errors
    /// If the bounds are not finite and in order, or the mode lies outside them.
    pub fn triangular(lower: f64, mode: f64, upper: f64) -> Result<Law> {
        interval("triangular", lower, upper)?;
        within("triangular", lower, mode, upper)?;
        Ok(Law::Triangular { lower, mode, upper })
    }

    /// Beta law with shapes `alpha`, `beta` on [lower, upper].
    ///
    /// # Errors
    /// If a shape is not above zero, or the bounds are not finite and in order.
    pub fn beta(alpha: f64, beta: f64, lower: f64, upper: f64) -> Result<Law> {
        positive("beta", "first shape", alpha)?;
        positive("beta", "second shape", beta)?;
        interval("beta", lower, upper)?;
        Ok(Law::Beta { alpha, beta, lower, upper })
    }

    /// PERT law: the beta law on [lower, upper] with mean (lower + 4 mode + upper)/6.
    ///
    /// # Errors
    /// If the bounds are not finite and in order, or the mode lies outside them.
    pub fn pert(lower: f64, mode: f64, upper: f64) -> Result<Law> {
        interval("PERT", lower, upper)?;
        within("PERT", lower, mode, upper)?;
        let width = upper - lower;
        let alpha = 1.0 + 4.0 * ((mode - lower) / width);
        let beta = 1.0 + 4.0 * ((upper - mode) / width);
        Law::beta(alpha, beta, lower, upper)
    }

    /// Weibull law with `shape` and `scale` above `location`.
    ///
    /// # Errors
    /// If `shape` or `scale` is not above zero or `location` is not finite.
    pub fn weibull(shape: f64, scale: f64, location: f64) -> Result<Law> {
        positive("Weibull", "shape", shape)?;
        positive("Weibull", "scale", scale)?;
        finite("Weibull", "location", location)?;
        Ok(Law::Weibull { shape, scale, location })
    }

    /// Gumbel law of a maximum with mode `location` and `scale`.
    ///
    /// # Errors
    /// If `location` is not finite or `scale` is not above zero.
    pub fn gumbel(location: f64, scale: f64) -> Result<Law> {
        finite("Gumbel", "location", location)?;
        positive("Gumbel", "scale", scale)?;
        Ok(Law::Gumbel { location, scale, minimum: false })
    }

    /// Gumbel law of a minimum with mode `location` and `scale`.
    ///
    /// # Errors
    /// As [`Law::gumbel`].
    pub fn gumbel_minimum(location: f64, scale: f64) -> Result<Law> {
        Law::gumbel(location, scale)?;
        Ok(Law::Gumbel { location, scale, minimum: true })
    }

    /// Gumbel law of a maximum with `mean` and standard deviation `sd`.
    ///
    /// # Errors
    /// If `mean` is not finite or `sd` is not above zero.
    pub fn gumbel_mean_sd(mean: f64, sd: f64) -> Result<Law> {
        finite("Gumbel", "mean", mean)?;
        positive("Gumbel", "standard deviation", sd)?;
        let scale = sd * 6.0_f64.sqrt() / PI;
        Law::gumbel(mean - EULER_GAMMA * scale, scale)
    }

    /// Gumbel law of a minimum with `mean` and standard deviation `sd`.
    ///
    /// # Errors
    /// As [`Law::gumbel_mean_sd`].
    pub fn gumbel_minimum_mean_sd(mean: f64, sd: f64) -> Result<Law> {
        finite("Gumbel", "mean", mean)?;
        positive("Gumbel", "standard deviation", sd)?;
        let scale = sd * 6.0_f64.sqrt() / PI;
        Law::gumbel_minimum(mean + EULER_GAMMA * scale, scale)
    }

    /// Gamma law with `shape` and `scale` above `location`.
    ///
    /// # Errors
    /// If `shape` or `scale` is not above zero or `location` is not finite.
    pub fn gamma(shape: f64, scale: f64, location: f64) -> Result<Law> {
        positive("gamma", "shape", shape)?;
        positive("gamma", "scale", scale)?;
        finite("gamma", "location", location)?;
        Ok(Law::Gamma { shape, scale, location })
    }

    /// Gamma law above zero with `mean` and standard deviation `sd`.
    ///
    /// # Errors
    /// If either is not above zero.
    pub fn gamma_mean_sd(mean: f64, sd: f64) -> Result<Law> {
        positive("gamma", "mean", mean)?;
        positive("gamma", "standard deviation", sd)?;
        let ratio = mean / sd;
        Law::gamma(ratio * ratio, sd * (sd / mean), 0.0)
    }

    /// Exponential law above `location` with mean excess `mean`.
    ///
    /// # Errors
    /// If `mean` is not above zero or `location` is not finite.
    pub fn exponential(mean: f64, location: f64) -> Result<Law> {
        positive("exponential", "mean", mean)?;
        finite("exponential", "location", location)?;
        Ok(Law::Exponential { mean, location })
    }

    /// The law of observed `values`, equally weighted or with `weights`: see [`Empirical`].
    ///
    /// # Errors
    /// As [`Empirical::new`].
    pub fn empirical(values: Vec<f64>, weights: Option<Vec<f64>>) -> Result<Law> {
        Empirical::new(values, weights).map(Law::Empirical)
    }

    /// The law of `values` with probabilities in proportion to `weights`, or equal ones, and of nothing between them.
    ///
    /// # Errors
    /// As [`Empirical::discrete`].
    pub fn discrete(values: Vec<f64>, weights: Option<Vec<f64>>) -> Result<Law> {
        Empirical::discrete(values, weights).map(Law::Empirical)
    }
}

/// Refuses a mode outside the bounds.
fn within(law: &str, lower: f64, mode: f64, upper: f64) -> Result<()> {
    if (lower..=upper).contains(&mode) {
        Ok(())
    } else {
        Err(Error::argument(format!(
            "a {law} law needs a mode between its bounds {lower} and {upper}, not {mode}"
        )))
    }
}
