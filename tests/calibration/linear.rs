//! A linear-Gaussian problem, whose posterior and evidence are known in closed form.

use nalgebra::{Cholesky, DMatrix, DVector};
use reeldown::calibration::{LeastSquares, LogLikelihood, Plan, Whitened, best_fit, sample};
use reeldown::error::Result;
use reeldown::numerics::columns::Columns;
use std::f64::consts::PI;

/// `y = A z + e`, `e` ~ N(0, 1), `z` ~ N(0, I).
struct Linear {
    a: DMatrix<f64>,
    y: DVector<f64>,
}

impl Linear {
    /// Five parameters, of which data determines two sharply, one weakly, and two not at all.
    fn new() -> Self {
        let a = DMatrix::from_fn(12, 5, |i, j| {
            let t = i as f64 / 11.0;
            match j {
                0 => 20.0,
                1 => 15.0 * (t - 0.5),
                2 => 0.4 * (3.0 * t).sin(),
                // The sum of the last two only, and hardly.
                _ => 0.1,
            }
        });
        let truth = DVector::from_column_slice(&[1.2, -0.7, 0.5, -1.0, 0.3]);
        let noise = DVector::from_fn(12, |i, _| (7.0 * i as f64).cos());
        let y = &a * truth + noise;
        Linear { a, y }
    }

    /// Mean and covariance of the posterior, and ln evidence: y ~ N(0, A Aᵀ + I).
    fn truth(&self) -> (DVector<f64>, DMatrix<f64>, f64) {
        let information = DMatrix::identity(5, 5) + self.a.transpose() * &self.a;
        let covariance = Cholesky::new(information).expect("positive definite").inverse();
        let mean = &covariance * (self.a.transpose() * &self.y);
        let marginal = DMatrix::identity(12, 12) + &self.a * self.a.transpose();
        let factor = Cholesky::new(marginal).expect("positive definite");
        let ln_determinant: f64 = 2.0 * factor.l().diagonal().iter().map(|x| x.ln()).sum::<f64>();
        let square = self.y.dot(&factor.solve(&self.y));
        (mean, covariance, -0.5 * (square + ln_determinant + 12.0 * (2.0 * PI).ln()))
    }
}

impl LogLikelihood for Linear {
    fn dimension(&self) -> usize {
        5
    }
    fn ln_likelihood(&self, z: &Columns, out: &mut [f64]) -> Result<()> {
        for (k, out) in out.iter_mut().enumerate() {
            let residual = &self.y - &self.a * DVector::from_vec(z.row(k));
            *out = -0.5 * (residual.norm_squared() + 12.0 * (2.0 * PI).ln());
        }
        Ok(())
    }
}

impl LeastSquares for Linear {
    fn squared_dimension(&self) -> usize {
        5
    }
    fn whitened(&self, z: &[f64], _: bool) -> Result<Option<Whitened>> {
        let residuals = &self.y - &self.a * DVector::from_column_slice(z);
        let jacobian = (0..5).map(|j| self.a.column(j).iter().map(|x| -x).collect()).collect();
        Ok(Some(Whitened { residuals: residuals.as_slice().to_vec(), jacobian }))
    }
}

#[test]
fn analytic_best_fit_is_the_posterior_mean_and_its_covariance() {
    let problem = Linear::new();
    let (mean, covariance, _) = problem.truth();
    let fit = best_fit(&problem, &[0.0; 5]).expect("a fit");
    assert!(fit.converged);
    // One undamped step solves it; rounding is amplified by the condition, some 5000.
    for j in 0..5 {
        assert!((fit.point[j] - mean[j]).abs() < 1e-10, "{j}: {} {}", fit.point[j], mean[j]);
        for k in 0..5 {
            assert!((fit.covariance[(j, k)] - covariance[(j, k)]).abs() < 1e-10);
        }
    }
}

#[test]
fn analytic_posterior_and_evidence_are_met_within_their_errors() {
    let problem = Linear::new();
    let (mean, covariance, ln_evidence) = problem.truth();
    let plan = Plan { particles: 500, replicates: 4, seed: 5, ..Plan::seeded(1993) };
    let posterior = sample(&problem, &plan).expect("a posterior");
    let diagnosis = &posterior.diagnosis;
    assert!(diagnosis.failures.is_empty(), "{:?}", diagnosis.failures);
    // Five of the sampler's own standard errors, and no better than a hundredth can be asked of 2000 draws.
    let error = 5.0 * diagnosis.ln_evidence_error.max(0.01);
    assert!((diagnosis.ln_evidence - ln_evidence).abs() < error, "{diagnosis:?} {ln_evidence}");
    let draws = posterior.draws();
    let n = draws.len() as f64;
    for j in 0..5 {
        let found = draws.iter().map(|draw| draw[j]).sum::<f64>() / n;
        let sd = covariance[(j, j)].sqrt();
        // Five standard errors of the mean, and of the variance of that many independent draws.
        let error = 5.0 * sd / diagnosis.effective.sqrt();
        assert!((found - mean[j]).abs() < error, "{j}: {found} {}", mean[j]);
        let variance =
            draws.iter().map(|draw| (draw[j] - found) * (draw[j] - found)).sum::<f64>() / n;
        let error = 5.0 * (2.0 / diagnosis.effective).sqrt();
        assert!((variance / (sd * sd) - 1.0).abs() < error, "{j}: {variance} {}", sd * sd);
    }
}

#[test]
fn property_the_same_seed_gives_the_same_draws_and_another_others() {
    let problem = Linear::new();
    let plan = |seed| Plan { particles: 100, replicates: 2, seed, ..Plan::seeded(1993) };
    let draws = |seed| sample(&problem, &plan(seed)).expect("a posterior").draws();
    assert_eq!(draws(1), draws(1));
    assert_ne!(draws(1), draws(2));
}

/// Thirty-four parameters, five sums of which data knows: as many as a calibration of the brake has.
struct Wide {
    a: DMatrix<f64>,
    y: DVector<f64>,
}

impl Wide {
    const PARAMETERS: usize = 34;

    fn new() -> Self {
        let sharpness = [30.0, 15.0, 10.0, 5.0, 2.0];
        let a = DMatrix::from_fn(5, Self::PARAMETERS, |i, j| {
            0.2 * sharpness[i] * (1.0 + (i * j) as f64).cos()
        });
        let truth = DVector::from_fn(Self::PARAMETERS, |j, _| (3.0 * j as f64).sin());
        let y = &a * truth;
        Wide { a, y }
    }
}

impl LogLikelihood for Wide {
    fn dimension(&self) -> usize {
        Self::PARAMETERS
    }
    fn ln_likelihood(&self, z: &Columns, out: &mut [f64]) -> Result<()> {
        for (k, out) in out.iter_mut().enumerate() {
            let residual = &self.y - &self.a * DVector::from_vec(z.row(k));
            *out = -0.5 * residual.norm_squared();
        }
        Ok(())
    }
}

/// The mean squared distance of the draws from the exact mean, in the exact covariance, is the dimension. Few particles in
/// many dimensions come out too close together where moves forget too little of their resampling: 3.4 % before they
/// went on longer and about a wider law.
#[test]
fn analytic_draws_of_few_particles_are_as_far_apart_as_the_posterior() {
    let problem = Wide::new();
    let d = Wide::PARAMETERS;
    let information = DMatrix::identity(d, d) + problem.a.transpose() * &problem.a;
    let covariance = Cholesky::new(information.clone()).expect("positive definite").inverse();
    let mean = covariance * (problem.a.transpose() * &problem.y);
    let ratios: Vec<f64> = (0..12)
        .map(|seed| {
            let plan = Plan { particles: 400, replicates: 2, seed, ..Plan::seeded(1993) };
            let draws = sample(&problem, &plan).expect("a posterior").draws();
            let distance = |draw: &Vec<f64>| {
                let from = DVector::from_column_slice(draw) - &mean;
                from.dot(&(&information * &from))
            };
            draws.iter().map(distance).sum::<f64>() / (draws.len() * d) as f64
        })
        .collect();
    let n = ratios.len() as f64;
    let found = ratios.iter().sum::<f64>() / n;
    let variance = ratios.iter().map(|r| (r - found) * (r - found)).sum::<f64>() / (n - 1.0);
    // Four standard errors, and half a hundredth for the bias that so few particles keep.
    let error = 4.0 * (variance / n).sqrt() + 0.005;
    assert!((found - 1.0).abs() < error && error < 0.025, "{found} ± {error}");
}
