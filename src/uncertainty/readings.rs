//! What a handful of readings says: a predictive law for the next value, and the posterior behind it.

use super::empirical::SAME;
use super::law::Law;
use crate::error::{Error, Result};
use crate::numerics::elementary::{exp, ln};
use crate::numerics::special::{gamma, normal};

/// Readings of a quantity that is normal from one to the next, or whose logarithm is.
///
/// Under the reference prior 1/σ of location and scale the next value follows Student's t with n − 1 degrees of
/// freedom about the mean of the readings, with scale s √(1 + 1/n); with a known σ it is normal with standard
/// deviation σ √(1 + 1/n) (A. Gelman et al., *Bayesian Data Analysis*, 3rd ed. 2013, sections 2.5 and 3.2). To take
/// the readings' mean and standard deviation for the true ones instead is to call a tail far too thin.
#[derive(Debug, Clone, PartialEq)]
pub struct Readings {
    count: usize,
    mean: f64,
    sd: f64,
    known: bool,
    logarithmic: bool,
}

impl Readings {
    /// The readings `values`; with `known_sd`, the standard deviation from one reading to the next (of a
    /// `logarithmic` quantity, the logarithm's) is known.
    ///
    /// # Errors
    /// If there are fewer than two readings (one, where the deviation is known), two are not different, one is not finite (of a
    /// logarithmic quantity, not positive), or `known_sd` is not above zero.
    pub fn new(values: &[f64], known_sd: Option<f64>, logarithmic: bool) -> Result<Self> {
        let least = if known_sd.is_some() { 1 } else { 2 };
        if values.len() < least {
            return Err(Error::argument(match least {
                1 => "there are no readings",
                _ => "one reading shows no scatter: state at least two, or the known sd",
            }));
        }
        let possible = |x: &f64| x.is_finite() && (!logarithmic || *x > 0.0);
        if !values.iter().all(possible) {
            return Err(Error::argument("a reading is impossible for the law"));
        }
        // Before any logarithm: what differs by the rounding of a conversion of units alone is the same.
        let greatest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let least_value = values.iter().copied().fold(f64::INFINITY, f64::min);
        let alike = greatest - least_value <= SAME * greatest.abs().max(least_value.abs());
        if alike && known_sd.is_none() {
            return Err(Error::argument("the readings are all the same: they show no scatter"));
        }
        let values: Vec<f64> =
            values.iter().map(|&x| if logarithmic { ln(x) } else { x }).collect();
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let sd = match known_sd {
            Some(sd) if sd > 0.0 && sd.is_finite() => sd,
            Some(_) => return Err(Error::argument("a known standard deviation is above zero")),
            None => {
                let squares: f64 = values.iter().map(|x| (x - mean) * (x - mean)).sum();
                (squares / (count - 1.0)).sqrt()
            }
        };
        if sd <= 0.0 {
            return Err(Error::argument("the readings are all the same: they show no scatter"));
        }
        Ok(Readings { count: values.len(), mean, sd, known: known_sd.is_some(), logarithmic })
    }

    /// Number of readings, n.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Mean of the readings; of a logarithmic quantity, their geometric mean.
    pub fn centre(&self) -> f64 {
        if self.logarithmic { exp(self.mean) } else { self.mean }
    }

    /// Standard deviation of the readings or the known one; of a logarithmic quantity, the logarithm's.
    pub fn sd(&self) -> f64 {
        self.sd
    }

    /// Whether the standard deviation is known.
    pub fn has_known_sd(&self) -> bool {
        self.known
    }

    /// Whether it is the logarithm that is normal.
    pub fn is_logarithmic(&self) -> bool {
        self.logarithmic
    }

    /// The law of the next value.
    pub fn predictive(&self) -> Law {
        let scale = self.sd * (1.0 + 1.0 / self.count as f64).sqrt();
        match (self.known, self.logarithmic) {
            (true, false) => Law::Normal { mean: self.mean, sd: scale },
            (true, true) => Law::Lognormal { log_mean: self.mean, log_sd: scale },
            (false, logarithmic) => Law::Student {
                location: self.mean,
                scale,
                degrees: self.count as f64 - 1.0,
                logarithmic,
            },
        }
    }

    /// The law from one value to the next, given a point of the posterior: the standard deviation's
    /// and the mean's lower-tail probability.
    ///
    /// σ² is (n − 1) s²/χ² with n − 1 degrees of freedom, and the mean normal about the readings' with variance σ²/n.
    pub fn law_at(&self, sd_at: f64, mean_at: f64) -> Law {
        let sd = if self.known {
            self.sd
        } else {
            let degrees = self.count as f64 - 1.0;
            // A large σ is a small χ²: the tails change sides.
            let half = if sd_at > 0.5 {
                gamma::quantile_lower(0.5 * degrees, 1.0 - sd_at)
            } else {
                gamma::quantile_upper(0.5 * degrees, sd_at)
            };
            self.sd * (0.5 * degrees / half).sqrt()
        };
        let mean = self.mean + normal::quantile(mean_at) * sd / (self.count as f64).sqrt();
        match self.logarithmic {
            false => Law::Normal { mean, sd },
            true => Law::Lognormal { log_mean: mean, log_sd: sd },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_the_posterior_averages_to_the_predictive_law() {
        // ∫ Φ((x − μ)/σ) over the posterior of (μ, σ) is the t law's distribution function. A lattice of
        // midpoints in the two probabilities, each as fine as 1/200: errors of the order of 1e-4.
        let readings = Readings::new(&[1.0, 2.5, 2.0, 3.5, 1.5], None, false).unwrap();
        let predictive = readings.predictive();
        for x in [-1.0, 0.5, 2.1, 3.0, 5.0] {
            let n = 200;
            let at = |k: usize| (k as f64 + 0.5) / n as f64;
            let sum: f64 = (0..n)
                .flat_map(|i| (0..n).map(move |j| (i, j)))
                .map(|(i, j)| readings.law_at(at(i), at(j)).cdf(x))
                .sum();
            let mixed = sum / (n * n) as f64;
            assert!((mixed - predictive.cdf(x)).abs() < 4e-4, "{x}: {mixed}");
        }
    }

    #[test]
    fn property_readings_that_show_no_scatter_are_refused() {
        assert!(Readings::new(&[1.0], None, false).is_err());
        assert!(Readings::new(&[1.0, 1.0], None, false).is_err());
        // 0.062 in and 62 mil in metres: one number, in two conversions that round differently.
        assert!(Readings::new(&[0.062 * 0.0254, 62.0 * 0.0254e-3], None, false).is_err());
        assert!(Readings::new(&[0.062 * 0.0254, 62.0 * 0.0254e-3], None, true).is_err());
        assert!(Readings::new(&[1.0, -1.0], None, true).is_err());
        assert!(Readings::new(&[1.0], Some(0.0), false).is_err());
        let known = Readings::new(&[1.0], Some(0.1), false).unwrap();
        assert_eq!(known.predictive(), Law::Normal { mean: 1.0, sd: 0.1 * 2.0_f64.sqrt() });
    }
}
