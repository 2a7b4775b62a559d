//! Line sampling that trusts no line: each is searched over its whole length for every crossing. The
//! fallback of [`super::line`] for limits that its shorter lines do not fit.
//!
//! Space is shared out among the design points u_k by the largest u_k·z/‖u_k‖², and each share is sampled
//! by lines along its own u_k, of which only the stretch within the share counts. Every line is searched
//! over its whole length for every crossing, so that the estimate is unbiased for any directions: poor
//! ones cost precision only.
//!
//! Unfit, and its interval withdrawn, where no line is better than another: a shell of 100 dimensions
//! (benchmark RP63), and in two seeds of three a union of bands about the origin that breaches more often than not
//! (RP55).
//!
//! Sources: Hohenbichler and Rackwitz, J. Eng. Mech. 114 (1988) 2195; Koutsourelakis, Pradlwarter and
//! Schuëller, Probabilistic Engineering Mechanics 19 (2004) 409.

use super::crossings::{Breached, Ray, TOLERANCE, breached, measure, shifted_grid};
use super::design_point::{DesignPoints, SearchOptions, design_points};
use super::draws::{open_uniform, standard_normal};
use super::estimate::{Estimate, Method};
use super::event::{Evaluator, Event, FaultReading};
use super::form::no_design_point;
use super::importance::{combined, shares};
use super::limit_state::LimitState;
use super::vectors::{dot, norm};
use super::weighted::{WeightChecks, WeightedBreaches};
use crate::error::{Error, Result};
use crate::numerics::interval::Earned;
use crate::numerics::special::normal;
use crate::streams::{Purpose, stream};

/// How line sampling is done.
#[derive(Debug, Clone, PartialEq)]
pub struct SearchedLineOptions {
    /// Lines.
    pub lines: u64,
    /// A line is searched from −reach to reach …
    pub reach: f64,
    /// … on a randomly shifted grid of this many cells: a breach thinner than one is seen by chance, and
    /// then counts for those that were not.
    pub cells: usize,
    /// Confidence of the interval.
    pub confidence: f64,
    /// The self-checks, on the lines' probabilities.
    pub checks: WeightChecks,
    /// The search of the design points that give the directions.
    pub search: SearchOptions,
    /// Seed of the lines.
    pub seed: u64,
}

impl SearchedLineOptions {
    /// The usual choices, with the seed of every stream.
    pub fn seeded(seed: u64) -> Self {
        SearchedLineOptions {
            lines: 2000,
            reach: 8.0,
            cells: 24,
            confidence: 0.95,
            checks: WeightChecks::default(),
            search: SearchOptions::seeded(seed),
            seed,
        }
    }
}

/// Line sampling of an event along the directions of its design points, with independent lines.
///
/// With faults met, the whole is run again with every fault read as a breach.
///
/// # Errors
/// If an option is out of range, the event does not fit, or the limit state fails.
pub fn searched_lines(
    state: &dyn LimitState,
    event: Event,
    options: &SearchedLineOptions,
) -> Result<Estimate> {
    if options.lines < 2 || options.cells == 0 || !(options.reach > 0.0 && options.reach < 38.0) {
        return Err(Error::argument("line sampling needs two lines, a grid and a reach below 38"));
    }
    let found = design_points(state, event, &options.search)?;
    let directions = Directions::new(&found);
    let mut estimate = if directions.targets.is_empty() {
        Estimate::without_number(Method::LineSampling, event, no_design_point(&found))
    } else {
        let safe = run(state, event, &directions, options, FaultReading::Safe)?;
        match safe.faults {
            0 => safe,
            _ => {
                let breach = run(state, event, &directions, options, FaultReading::Breach)?;
                Estimate::joined(safe, breach)
            }
        }
    };
    count_search(&mut estimate, &found);
    Ok(estimate)
}

/// Adds the cost and the faults of the search.
pub(super) fn count_search(estimate: &mut Estimate, found: &DesignPoints) {
    estimate.evaluations += found.evaluations;
    estimate.faults += found.faults;
    estimate.diagnostics.extend(found.diagnostics());
}

/// The design points that lines run to, and the share of the lines that each gets.
struct Directions {
    targets: Vec<Vec<f64>>,
    shares: Vec<f64>,
}

impl Directions {
    fn new(found: &DesignPoints) -> Self {
        let (mut targets, mut kept) = (Vec::new(), Vec::new());
        for (point, share) in found.points.iter().zip(shares(found)) {
            // A point at the origin has no direction.
            if norm(&point.point) > 1e-6 {
                targets.push(point.point.clone());
                kept.push(share);
            }
        }
        let total: f64 = kept.iter().sum();
        Directions { targets, shares: kept.iter().map(|share| share / total).collect() }
    }

    fn choose(&self, uniform: f64) -> usize {
        let mut left = uniform;
        for (k, share) in self.shares.iter().enumerate() {
            if left <= *share {
                return k;
            }
            left -= share;
        }
        self.shares.len() - 1
    }

    fn score(&self, k: usize, point: &[f64]) -> f64 {
        dot(&self.targets[k], point) / dot(&self.targets[k], &self.targets[k])
    }

    /// The stretch of a ray along target `own` that lies in its share of space: an intersection of
    /// half lines, since scores are linear.
    fn own_stretch(&self, own: usize, ray: &Ray) -> (f64, f64) {
        let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
        for other in (0..self.targets.len()).filter(|&other| other != own) {
            let start = self.score(own, &ray.origin) - self.score(other, &ray.origin);
            let slope = self.score(own, &ray.direction) - self.score(other, &ray.direction);
            if slope > 0.0 {
                from = from.max(-start / slope);
            } else if slope < 0.0 {
                to = to.min(-start / slope);
            } else if start < 0.0 || (start == 0.0 && other < own) {
                return (0.0, 0.0);
            }
        }
        (from, to)
    }
}

fn run(
    state: &dyn LimitState,
    event: Event,
    directions: &Directions,
    options: &SearchedLineOptions,
    reading: FaultReading,
) -> Result<Estimate> {
    let mut evaluator = Evaluator::new(state, event, reading)?;
    let reach = options.reach;
    let (chosen, rays): (Vec<usize>, Vec<Ray>) = (0..options.lines)
        .map(|k| {
            let mut stream = stream(options.seed, Purpose::LineSampling, k);
            let own = directions.choose(open_uniform(&mut stream));
            let grid = shifted_grid(-reach, reach, options.cells, open_uniform(&mut stream));
            let target = &directions.targets[own];
            let length = norm(target);
            let direction: Vec<f64> = target.iter().map(|x| x / length).collect();
            let mut origin: Vec<f64> =
                (0..direction.len()).map(|_| standard_normal(&mut stream)).collect();
            let along = dot(&origin, &direction);
            origin.iter_mut().zip(&direction).for_each(|(x, d)| *x -= along * d);
            (own, Ray { grid, origin, direction })
        })
        .unzip();
    let cell = 2.0 * reach / options.cells as f64;
    let mut lines = WeightedBreaches { samples: options.lines, weights: Vec::new() };
    let mut uncertain = 0.0;
    let found = breached(&mut evaluator, &rays)?;
    for ((&own, ray), stretches) in chosen.iter().zip(&rays).zip(found) {
        let (least, most) = directions.own_stretch(own, ray);
        let kept: Breached = stretches
            .into_iter()
            // What breaches at an end of the grid is taken to breach beyond.
            .map(|(from, to)| {
                let from = if from <= -reach { f64::NEG_INFINITY } else { from };
                (from, if to >= reach { f64::INFINITY } else { to })
            })
            .collect();
        let within = |from: f64, to: f64| between(from.max(least), to.min(most));
        let probability = measure(&kept, cell, within) / directions.shares[own];
        if probability > 0.0 {
            lines.weights.push(probability);
        }
        let ends = kept.iter().flat_map(|&(from, to)| [from, to]).filter(|t| t.is_finite());
        uncertain += ends.map(|t| within(t - TOLERANCE, t + TOLERANCE)).sum::<f64>()
            / directions.shares[own];
    }
    let uncertain = uncertain / options.lines as f64;
    let mut estimate =
        combined(Method::LineSampling, event, &lines, &lines, options.confidence, &options.checks);
    widen(&mut estimate, uncertain);
    estimate.evaluations = evaluator.evaluations;
    estimate.faults = evaluator.faults;
    Ok(estimate)
}

/// Widens an interval by what the tolerance of the roots leaves open: all there is where the limit is a
/// plane and lines agree exactly.
pub(super) fn widen(estimate: &mut Estimate, by: f64) {
    if let Earned::Interval(interval) = &mut estimate.interval {
        interval.lower = (interval.lower - by).max(0.0);
        interval.upper = (interval.upper + by).min(1.0);
    }
}

/// Probability of a standard normal between two values, without cancellation in either tail.
pub(super) fn between(from: f64, to: f64) -> f64 {
    if from >= to {
        0.0
    } else if from > 0.0 {
        normal::survival(from) - normal::survival(to)
    } else if to < 0.0 {
        normal::cdf(to) - normal::cdf(from)
    } else {
        1.0 - normal::cdf(from) - normal::survival(to)
    }
}
