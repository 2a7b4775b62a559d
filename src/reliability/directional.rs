//! Directional sampling: along random directions from the origin the probability is known exactly, the
//! squared distance being chi-squared. For few dimensions: in many, few directions see a rare breach,
//! and the self-checks withdraw the interval.
//!
//! Source: Bjerager, J. Eng. Mech. 114 (1988) 1285; Ditlevsen, Melchers and Gluver, Computers and
//! Structures 36 (1990) 355.

use super::crossings::{Ray, TOLERANCE, breached, measure, shifted_grid};
use super::draws::{direction, open_uniform};
use super::estimate::{Estimate, Method};
use super::event::{Evaluator, Event, FaultReading};
use super::importance::combined;
use super::limit_state::LimitState;
use super::searched_lines::widen;
use super::weighted::{WeightChecks, WeightedBreaches};
use crate::error::{Error, Result};
use crate::numerics::special::chi_squared;
use crate::streams::{Purpose, stream};

/// How directional sampling is done.
#[derive(Debug, Clone, PartialEq)]
pub struct DirectionalOptions {
    /// Directions.
    pub directions: u64,
    /// Cells of the randomly shifted grid along each: a breach thinner than one is seen by chance, and
    /// then counts for those that were not.
    pub cells: usize,
    /// Probability beyond the grid's end.
    pub beyond: f64,
    /// Confidence of the interval.
    pub confidence: f64,
    /// The self-checks, on the directions' probabilities.
    pub checks: WeightChecks,
    /// Seed of the directions.
    pub seed: u64,
}

impl DirectionalOptions {
    /// The usual choices, with the seed of every stream.
    pub fn seeded(seed: u64) -> Self {
        DirectionalOptions {
            directions: 2000,
            cells: 16,
            beyond: 1e-14,
            confidence: 0.95,
            checks: WeightChecks::default(),
            seed,
        }
    }
}

/// Directional sampling of an event.
///
/// With faults met, the whole is run again with every fault read as a breach.
///
/// # Errors
/// If an option is out of range, the event does not fit, or the limit state fails.
pub fn directional_sampling(
    state: &dyn LimitState,
    event: Event,
    options: &DirectionalOptions,
) -> Result<Estimate> {
    let beyond = options.beyond;
    if options.directions < 2 || options.cells == 0 || !(0.0 < beyond && beyond < 0.1) {
        return Err(Error::argument(
            "directional sampling needs two directions, a grid and a small probability beyond it",
        ));
    }
    let safe = run(state, event, options, FaultReading::Safe)?;
    if safe.faults == 0 {
        return Ok(safe);
    }
    let breach = run(state, event, options, FaultReading::Breach)?;
    Ok(Estimate::joined(safe, breach))
}

fn run(
    state: &dyn LimitState,
    event: Event,
    options: &DirectionalOptions,
    reading: FaultReading,
) -> Result<Estimate> {
    let mut evaluator = Evaluator::new(state, event, reading)?;
    let n = state.dimension();
    let degrees = n as f64;
    let near = chi_squared::quantile_lower(degrees, options.beyond).sqrt();
    let far = chi_squared::quantile_upper(degrees, options.beyond).sqrt();
    let cell = (far - near) / options.cells as f64;
    let rays: Vec<Ray> = (0..options.directions)
        .map(|k| {
            let mut stream = stream(options.seed, Purpose::DirectionalSampling, k);
            let direction = direction(&mut stream, n);
            let grid = shifted_grid(near, far, options.cells, open_uniform(&mut stream));
            Ray { grid, origin: vec![0.0; n], direction }
        })
        .collect();
    let beyond = |radius: f64| {
        // What breaches at the grid's end is taken to breach beyond.
        if radius >= far { 0.0 } else { chi_squared::survival(degrees, radius * radius) }
    };
    let between = |from: f64, to: f64| beyond(if from <= near { 0.0 } else { from }) - beyond(to);
    let mut found = WeightedBreaches { samples: options.directions, weights: Vec::new() };
    let mut uncertain = 0.0;
    for stretches in breached(&mut evaluator, &rays)? {
        let probability = measure(&stretches, cell, between);
        if probability > 0.0 {
            found.weights.push(probability);
        }
        let ends = stretches.iter().flat_map(|&(from, to)| [from, to]);
        uncertain += ends.map(|t| between(t - TOLERANCE, t + TOLERANCE)).sum::<f64>();
    }
    let uncertain = uncertain / options.directions as f64;
    let mut estimate = combined(
        Method::DirectionalSampling,
        event,
        &found,
        &found,
        options.confidence,
        &options.checks,
    );
    widen(&mut estimate, uncertain);
    estimate.evaluations = evaluator.evaluations;
    estimate.faults = evaluator.faults;
    Ok(estimate)
}
