//! What the posterior does to the probability of a breach: before and after, each with its epistemic band.
//!
//! What varies from flight to flight (every input that is not of the brake and its fluid: the initial temperature, for
//! one) is drawn afresh for each brake, the same draws for all; what is not known of the brake is the draw itself. The
//! probability given a brake then has a law over the brakes: the band. The full nested analysis is the report's of
//! `reeldown run` with the calibrated card.

use super::plan::is_hardware;
use super::predictive::quantile;
use crate::campaign::{Ensemble, Progress};
use crate::error::{Error, Result};
use crate::numerics::columns::Columns;
use crate::numerics::special::normal;
use crate::sampling::{Design, Sampler};
use crate::streams::Purpose;
use crate::study::Study;

/// Brakes drawn.
pub const BRAKES: usize = 2000;
/// Flights of each.
pub const FLIGHTS: usize = 256;

/// The probability of a breach over brakes and flights.
#[derive(Debug, Clone)]
pub struct Risk {
    /// P(any breach), brakes and flights together.
    pub probability: f64,
    /// P(breach) of each limit, in the study's order.
    pub limits: Vec<f64>,
    /// 5 %, 50 % and 95 % quantiles over brakes of P(any breach) given the brake.
    pub band: [f64; 3],
    /// For every brake, the standard-normal quantile of its probability, halfway cases counted half.
    pub probits: Vec<f64>,
    /// Variance of a probit from the number of flights alone, averaged over the brakes.
    pub own_variance: f64,
}

/// Draws of every input, spread evenly over each (a Latin hypercube).
fn spread(study: &Study, rows: usize, purpose: Purpose) -> Result<Columns> {
    let n = study.inputs.len();
    let seed = study.sampling.seed;
    let sampler = Sampler::new(Design::LatinHypercube, n, rows as u64, 1, seed, purpose)?;
    let mut uniforms = Columns::new(rows, n);
    sampler.fill(0, &mut uniforms)?;
    let mut inputs = Columns::new(rows, n);
    study.joint.from_uniform(&uniforms, &mut inputs);
    Ok(inputs)
}

/// [`FLIGHTS`] flights, spread evenly over what varies: all brakes share them, so that what a plain sample of so few
/// were off by, every brake would be.
fn flights(study: &Study) -> Result<Columns> {
    spread(study, FLIGHTS, Purpose::Calibration)
}

/// Brakes of the prior, spread evenly over what is not known of them.
///
/// # Errors
/// If the study has too many inputs for a design.
pub fn prior_brakes(study: &Study, brakes: usize) -> Result<Columns> {
    spread(study, brakes, Purpose::Unknown)
}

/// The risk over brakes: rows of inputs in SI, of which the hardware's columns count.
///
/// # Errors
/// If the study states no limit.
pub fn risk(study: &Study, brakes: &Columns, progress: &Progress) -> Result<Risk> {
    if study.limits.is_empty() {
        return Err(Error::argument("the study states no limit, so nothing can be breached"));
    }
    let flights = flights(study)?;
    let n = study.inputs.len();
    let mut inputs = Columns::new(brakes.rows() * FLIGHTS, n);
    for (j, input) in study.inputs.iter().enumerate() {
        let of_brake = is_hardware(input.target.parameter);
        for k in 0..brakes.rows() {
            for flight in 0..FLIGHTS {
                let value = if of_brake { brakes.get(k, j) } else { flights.get(flight, j) };
                inputs.set(k * FLIGHTS + flight, j, value);
            }
        }
    }
    let table = Ensemble::new(study).at_inputs(&inputs, progress);
    if progress.stopping() {
        return Err(Error::argument("stopped before the risk was known"));
    }
    let mut limits = vec![0.0; study.limits.len()];
    let mut shares = Vec::with_capacity(brakes.rows());
    for k in 0..brakes.rows() {
        let mut breaches = 0;
        for row in k * FLIGHTS..(k + 1) * FLIGHTS {
            // A descent that could not be computed counts as a breach: it is the safe side.
            let result = table.result(row);
            let mut any = result.is_err();
            if let Ok(outcome) = result {
                for (limit, count) in study.limits.iter().zip(&mut limits) {
                    let breached = limit.margin(&outcome) < 0.0;
                    *count += f64::from(u8::from(breached));
                    any |= breached;
                }
            }
            breaches += usize::from(any);
        }
        shares.push(breaches as f64 / FLIGHTS as f64);
    }
    let rows = (brakes.rows() * FLIGHTS) as f64;
    limits.iter_mut().for_each(|count| *count /= rows);
    let mut own_variance = 0.0;
    let probits = shares
        .iter()
        .map(|share| {
            let p = (share * FLIGHTS as f64 + 0.5) / (FLIGHTS as f64 + 1.0);
            let probit = normal::quantile(p);
            let density = normal::density(probit);
            own_variance += p * (1.0 - p) / FLIGHTS as f64 / (density * density);
            probit
        })
        .collect();
    let probability = shares.iter().sum::<f64>() / shares.len() as f64;
    let mut sorted = shares.clone();
    sorted.sort_by(f64::total_cmp);
    Ok(Risk {
        probability,
        limits,
        band: [0.05, 0.5, 0.95].map(|p| quantile(&sorted, p)),
        probits,
        own_variance: own_variance / shares.len() as f64,
    })
}
