//! Design points: the breaches nearest to the origin, "the most likely way to fail".
//!
//! The search (`design_search`) starts at the origin and in keyed random directions, in opposite
//! pairs; where several limits are asked for together it looks for their joint breach.

use super::design_search::search;
use super::event::{Evaluator, Event, FaultReading};
use super::limit_state::LimitState;
use super::vectors::distance;
use crate::error::{Error, Result};
use serde::{Deserialize, Serialize};
use std::fmt;

/// How design points are searched.
#[derive(Debug, Clone, PartialEq)]
pub struct SearchOptions {
    /// Starts besides the origin: directions, in opposite pairs.
    pub directions: usize,
    /// Distance of those starts from the origin.
    pub start_radius: f64,
    /// Most steps of one search.
    pub iterations: usize,
    /// Half width of the central differences, in standard deviations.
    pub difference_step: f64,
    /// Converged: the point lies within this distance of the linearised limit …
    pub distance_tolerance: f64,
    /// … and off the gradient's line through the origin by at most this share of its norm.
    pub angle_tolerance: f64,
    /// A search that has gone farther than this is given up.
    pub farthest: f64,
    /// Seed of the starts.
    pub seed: u64,
}

impl SearchOptions {
    /// The usual choices, with the seed of every stream.
    pub fn seeded(seed: u64) -> Self {
        SearchOptions {
            directions: 16,
            start_radius: 3.0,
            iterations: 100,
            difference_step: 1e-2,
            distance_tolerance: 1e-5,
            angle_tolerance: 1e-3,
            farthest: 12.0,
            seed,
        }
    }
}

/// A half space of breaches: direction · u ≥ reliability_index.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HalfSpace {
    /// Unit vector from safe to breach, α.
    pub direction: Vec<f64>,
    /// Signed distance of its boundary from the origin, β.
    pub reliability_index: f64,
}

/// A converged design point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DesignPoint {
    /// The limits that are breached there: one, or all members of an intersection.
    pub limits: Vec<usize>,
    /// The point u*, standard-normal coordinates.
    pub point: Vec<f64>,
    /// Signed distance from the origin, β: negative where the origin itself breaches.
    pub reliability_index: f64,
    /// Importance factors α²: the share of each coordinate in the point's distance; they sum to 1.
    pub importance: Vec<f64>,
    /// The linearised limits there, one a limit.
    pub half_spaces: Vec<HalfSpace>,
    /// Steps that the search took.
    pub iterations: usize,
}

/// Why a search gave no design point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Unconverged {
    /// A margin on the way could not be evaluated.
    Fault,
    /// The margin does not change with any coordinate.
    Flat,
    /// No step along the search direction improves the merit: a kink, a jump or noise.
    Stalled,
    /// The steps were used up.
    Iterations,
    /// The search left the region where probability is.
    Far,
    /// Several limits are all breached at the origin, where an intersection has no design point.
    OriginBreaches,
    /// The linearised limits have no common breach.
    Infeasible,
}

impl fmt::Display for Unconverged {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Unconverged::Fault => "a margin on the way could not be evaluated",
            Unconverged::Flat => "the margin does not change with any coordinate",
            Unconverged::Stalled => "no step improves the merit (a kink, a jump or noise)",
            Unconverged::Iterations => "the steps were used up",
            Unconverged::Far => "the search left the region where probability is",
            Unconverged::OriginBreaches => "the origin breaches every limit of the intersection",
            Unconverged::Infeasible => "the linearised limits have no common breach",
        })
    }
}

/// What the searches of one event found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DesignPoints {
    /// Distinct converged points, nearest first (by β).
    pub points: Vec<DesignPoint>,
    /// Whether the event happens at the origin, where every input is at its median: the points of a limit that is breached
    /// there are the nearest that do *not* breach it.
    pub origin_breaches: bool,
    /// Starts that gave none: (limit or first of the intersection, why).
    pub unconverged: Vec<(usize, Unconverged)>,
    /// Points evaluated.
    pub evaluations: u64,
    /// Evaluations that faulted.
    pub faults: u64,
}

impl DesignPoints {
    /// The nearest point of `limit` alone.
    pub fn nearest(&self, limit: usize) -> Option<&DesignPoint> {
        self.points.iter().find(|point| point.limits == [limit])
    }

    /// Sentences on what the searches met.
    pub fn diagnostics(&self) -> Vec<String> {
        let mut lines = vec![format!("{} distinct design points", self.points.len())];
        let mut reasons: Vec<(Unconverged, usize)> = Vec::new();
        for (_, why) in &self.unconverged {
            match reasons.iter_mut().find(|(known, _)| known == why) {
                Some((_, count)) => *count += 1,
                None => reasons.push((*why, 1)),
            }
        }
        for (why, count) in reasons {
            lines.push(format!("{count} searches gave no point: {why}"));
        }
        lines
    }
}

/// Searches the design points of `event`: of each limit of a union apart, of an intersection jointly.
///
/// # Errors
/// If the event does not fit, an option is not positive, or the limit state fails.
pub fn design_points(
    state: &dyn LimitState,
    event: Event,
    options: &SearchOptions,
) -> Result<DesignPoints> {
    let sizes = [options.start_radius, options.difference_step, options.farthest];
    if sizes.iter().any(|&x| !(x > 0.0 && x.is_finite())) || options.iterations == 0 {
        return Err(Error::argument("the options of a design-point search must be positive"));
    }
    let members = event.members(state.limits())?;
    let first = Event::Limit(members.first().copied().unwrap_or(0));
    let mut evaluator = Evaluator::new(state, first, FaultReading::Kept)?;
    let groups: Vec<Vec<usize>> = match event.is_union() {
        true => members.iter().map(|&limit| vec![limit]).collect(),
        false => vec![members],
    };
    let (mut points, mut unconverged, mut origin_breaches) = (Vec::new(), Vec::new(), false);
    for limits in groups {
        let found = search(&mut evaluator, &limits, options)?;
        unconverged.extend(found.failed.into_iter().map(|why| (limits[0], why)));
        points.extend(distinct(found.points));
        origin_breaches |= found.origin_breaches;
    }
    points.sort_by(|a, b| a.reliability_index.total_cmp(&b.reliability_index));
    let Evaluator { evaluations, faults, .. } = evaluator;
    Ok(DesignPoints { points, origin_breaches, unconverged, evaluations, faults })
}

/// Distance below which two converged points are one.
const SAME_POINT: f64 = 0.2;

fn distinct(mut points: Vec<DesignPoint>) -> Vec<DesignPoint> {
    points.sort_by(|a, b| a.reliability_index.abs().total_cmp(&b.reliability_index.abs()));
    let mut kept: Vec<DesignPoint> = Vec::new();
    for point in points {
        if kept.iter().all(|other| distance(&other.point, &point.point) > SAME_POINT) {
            kept.push(point);
        }
    }
    kept
}
