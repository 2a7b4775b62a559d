//! Replicates of the posterior together: what they agree on, and whether they may be believed.

use super::likelihood::LogLikelihood;
use super::tempering::{self, Plan, Replicate, Start};
use crate::error::{Error, Result};
use crate::numerics::elementary::{exp, ln};
use serde::Serialize;

/// The pilot's random stream.
const PILOT: u32 = u32::MAX;
/// Largest R̂ of a coordinate.
pub const MOST_R_HAT: f64 = 1.05;
/// Smallest effective sample size, all replicates together.
pub const LEAST_EFFECTIVE: f64 = 400.0;
/// Largest standard error of ln evidence.
pub const MOST_EVIDENCE_ERROR: f64 = 0.5;
/// Smallest share of different particles.
pub const LEAST_UNIQUE: f64 = 0.5;
/// Largest correlation with the values before the last moves.
pub const MOST_REMEMBERED: f64 = 0.35;

/// The posterior as equally weighted draws, in replicates.
#[derive(Debug, Clone)]
pub struct Posterior {
    /// The replicates.
    pub replicates: Vec<Replicate>,
    /// How far they can be believed.
    pub diagnosis: Diagnosis,
}

/// Whether the replicates found the same posterior.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Diagnosis {
    /// R̂ of each coordinate across the replicates (Gelman and Rubin, 1992).
    pub r_hat: Vec<f64>,
    /// The largest R̂.
    pub worst_r_hat: f64,
    /// Effective number of independent draws, all replicates together: the pooled variance of the coordinates
    /// over the variance of their means between replicates, averaged over the coordinates.
    pub effective: f64,
    /// ln of the evidence: of the mean of the replicates' unbiased estimates.
    pub ln_evidence: f64,
    /// Its standard error, from the replicates' spread.
    pub ln_evidence_error: f64,
    /// Smallest share of different particles in a replicate.
    pub unique: f64,
    /// Largest correlation of a coordinate with its value before the last degree's moves.
    pub remembered: f64,
    /// Likelihoods computed.
    pub evaluations: u64,
    /// Proposals at which the model could not be computed.
    pub impossible: u64,
    /// Which gates failed, a sentence each.
    pub failures: Vec<String>,
}

impl Posterior {
    /// Every draw, replicate after replicate.
    pub fn draws(&self) -> Vec<Vec<f64>> {
        let rows = |replicate: &Replicate| {
            (0..replicate.particles.rows()).map(|k| replicate.particles.row(k)).collect::<Vec<_>>()
        };
        self.replicates.iter().flat_map(rows).collect()
    }

    /// ln of the likelihood of every draw, in the same order.
    pub fn ln_likelihood(&self) -> Vec<f64> {
        self.replicates.iter().flat_map(|r| r.ln_likelihood.iter().copied()).collect()
    }
}

/// Samples the posterior and diagnoses it.
///
/// # Errors
/// Those of [`tempering::replicate`]; if there are fewer than two replicates.
pub fn sample(target: &dyn LogLikelihood, plan: &Plan) -> Result<Posterior> {
    if plan.replicates < 2 || plan.particles < 2 * target.dimension() {
        return Err(Error::argument(format!(
            "a posterior of {} parameters needs at least two replicates and {} particles",
            target.dimension(),
            2 * target.dimension()
        )));
    }
    let pilot = tempering::replicate(target, None, &plan.pilot(), PILOT)?;
    let start = Start::about(&pilot)?;
    let replicates = (0..plan.replicates)
        .map(|index| tempering::replicate(target, Some(&start), plan, index))
        .collect::<Result<Vec<_>>>()?;
    let mut diagnosis = diagnose(&replicates);
    diagnosis.evaluations += pilot.evaluations;
    Ok(Posterior { replicates, diagnosis })
}

/// Compares replicates.
pub fn diagnose(replicates: &[Replicate]) -> Diagnosis {
    let count = replicates.len() as f64;
    let dimension = replicates.first().map_or(0, |replicate| replicate.particles.columns());
    let mut r_hat = Vec::with_capacity(dimension);
    let (mut within_sum, mut between_sum) = (0.0, 0.0);
    for j in 0..dimension {
        let moments: Vec<(f64, f64)> = replicates
            .iter()
            .map(|replicate| mean_variance(replicate.particles.column(j)))
            .collect();
        let means: Vec<f64> = moments.iter().map(|m| m.0).collect();
        let within = moments.iter().map(|m| m.1).sum::<f64>() / count;
        let between = mean_variance(&means).1;
        let n = replicates[0].particles.rows() as f64;
        r_hat.push((((n - 1.0) / n * within + between) / within).sqrt());
        within_sum += 1.0;
        between_sum += between / within;
    }
    let worst_r_hat = r_hat.iter().copied().fold(1.0, f64::max);
    let effective = count * within_sum / between_sum;
    let evidences: Vec<f64> = replicates.iter().map(|replicate| replicate.ln_evidence).collect();
    let top = evidences.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let sum: f64 = evidences.iter().map(|value| exp(value - top)).sum();
    let ln_evidence = top + ln(sum / count);
    let ln_evidence_error = (mean_variance(&evidences).1 / count).sqrt();
    let unique = replicates
        .iter()
        .map(|replicate| replicate.unique as f64 / replicate.particles.rows() as f64)
        .fold(1.0, f64::min);
    let remembered = replicates.iter().map(|replicate| replicate.remembered).fold(0.0, f64::max);
    let gates = [
        (worst_r_hat <= MOST_R_HAT, format!("R-hat is {worst_r_hat:.3}, more than {MOST_R_HAT}")),
        (
            effective >= LEAST_EFFECTIVE,
            format!("{effective:.0} effective draws, fewer than {LEAST_EFFECTIVE}"),
        ),
        (
            ln_evidence_error <= MOST_EVIDENCE_ERROR,
            format!(
                "ln evidence is known to {ln_evidence_error:.2} only, not to {MOST_EVIDENCE_ERROR}"
            ),
        ),
        (
            unique >= LEAST_UNIQUE,
            format!("only {:.0} % of the particles are different", 100.0 * unique),
        ),
        (
            remembered <= MOST_REMEMBERED,
            format!(
                "particles still remember where they were resampled (correlation {remembered:.2}, not {MOST_REMEMBERED})"
            ),
        ),
    ];
    let failures = gates.into_iter().filter(|(held, _)| !held).map(|(_, why)| why).collect();
    Diagnosis {
        r_hat,
        worst_r_hat,
        effective,
        ln_evidence,
        ln_evidence_error,
        unique,
        remembered,
        evaluations: replicates.iter().map(|replicate| replicate.evaluations).sum(),
        impossible: replicates.iter().map(|replicate| replicate.impossible).sum(),
        failures,
    }
}

/// Mean and variance (with n − 1) of numbers.
pub fn mean_variance(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
    (mean, squares / (n - 1.0))
}
