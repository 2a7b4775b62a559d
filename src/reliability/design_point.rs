//! Design points: the breaches nearest to the origin, "the most likely way to fail".
//!
//! The search is the improved HLRF algorithm (Zhang and Der Kiureghian, 1995, "Two improved algorithms
//! for reliability analysis"): a step to the point of the linearised limit nearest to the origin, with
//! Armijo's rule on the merit ½‖u‖² + c |g|, the nearness measured with a quasi-Newton model of the
//! limit's curvature. Several limits at once take the step to the nearest point
//! of all their linearised half spaces (Hildreth's quadratic programme) and the merit ½‖u‖² + Σ c max(g, 0).
//! Starts: the origin and keyed random directions in opposite pairs.

use super::draws::direction;
use super::event::{Evaluator, Event, FaultReading};
use super::limit_state::LimitState;
use super::linearisation::{Linearisation, linearise};
use super::quasi_newton::Curvature;
use super::vectors::{distance, dot, norm};
use crate::error::{Error, Result};
use crate::numerics::columns::Columns;
use crate::streams::{Purpose, stream};
use serde::Serialize;
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

impl Default for SearchOptions {
    fn default() -> Self {
        SearchOptions {
            directions: 16,
            start_radius: 3.0,
            iterations: 100,
            difference_step: 1e-2,
            distance_tolerance: 1e-5,
            angle_tolerance: 1e-3,
            farthest: 12.0,
            seed: 0,
        }
    }
}

/// A half space of breaches: direction · u ≥ reliability_index.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HalfSpace {
    /// Unit vector from safe to breach, α.
    pub direction: Vec<f64>,
    /// Signed distance of its boundary from the origin, β.
    pub reliability_index: f64,
}

/// A converged design point.
#[derive(Debug, Clone, PartialEq, Serialize)]
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
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
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DesignPoints {
    /// Distinct converged points, nearest first (by β).
    pub points: Vec<DesignPoint>,
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
    let (mut points, mut unconverged) = (Vec::new(), Vec::new());
    for limits in groups {
        let (found, failed) = search(&mut evaluator, &limits, options)?;
        unconverged.extend(failed.into_iter().map(|why| (limits[0], why)));
        points.extend(distinct(found));
    }
    points.sort_by(|a, b| a.reliability_index.total_cmp(&b.reliability_index));
    let Evaluator { evaluations, faults, .. } = evaluator;
    Ok(DesignPoints { points, unconverged, evaluations, faults })
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

fn starts(dimension: usize, options: &SearchOptions) -> Vec<Vec<f64>> {
    let mut starts = vec![vec![0.0; dimension]];
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for pair in 0..options.directions.div_ceil(2) {
        if basis.len() >= dimension {
            basis.clear();
        }
        // Directions orthogonal to the last ones spread over a plane better than independent ones.
        let mut keyed = stream(options.seed, Purpose::DesignPoint, pair as u64);
        let mut vector = direction(&mut keyed, dimension);
        for other in &basis {
            let share = dot(other, &vector);
            vector.iter_mut().zip(other).for_each(|(x, o)| *x -= share * o);
        }
        let length = norm(&vector);
        if length > 1e-9 {
            vector.iter_mut().for_each(|x| *x /= length);
            basis.push(vector.clone());
        }
        for side in [options.start_radius, -options.start_radius] {
            starts.push(vector.iter().map(|x| x * side).collect());
        }
    }
    starts.truncate(options.directions + 1);
    starts
}

/// One search under way.
struct Search {
    point: Vec<f64>,
    curvature: Curvature,
    outcome: Option<std::result::Result<DesignPoint, Unconverged>>,
}

type Found = (Vec<DesignPoint>, Vec<Unconverged>);

/// Runs every start in lockstep, so that gradients and line searches come in large batches.
fn search(evaluator: &mut Evaluator, limits: &[usize], options: &SearchOptions) -> Result<Found> {
    let joint = limits.len() > 1;
    let mut searches: Vec<Search> = starts(evaluator.dimension(), options)
        .into_iter()
        .map(|point| Search { curvature: Curvature::new(point.len()), point, outcome: None })
        .collect();
    for iteration in 0..options.iterations {
        let active: Vec<usize> =
            (0..searches.len()).filter(|&k| searches[k].outcome.is_none()).collect();
        if active.is_empty() {
            break;
        }
        let points: Vec<Vec<f64>> = active.iter().map(|&k| searches[k].point.clone()).collect();
        let planes = linearise(evaluator, &points, limits, options.difference_step)?;
        let mut steps: Vec<(usize, Step)> = Vec::new();
        for ((&k, point), planes) in active.iter().zip(&points).zip(planes) {
            if joint && iteration == 0 && k == 0 && planes.iter().all(|plane| plane.margin < 0.0) {
                return Ok((Vec::new(), vec![Unconverged::OriginBreaches]));
            }
            let curvature = &mut searches[k].curvature;
            match Step::new(point, &planes, curvature, options.start_radius + 1.0) {
                Err(why) => searches[k].outcome = Some(Err(why)),
                Ok(step) if step.has_converged(point, &planes, options) => {
                    let found = design_point(limits, point, &planes, iteration);
                    searches[k].outcome = Some(Ok(found));
                }
                Ok(_) if norm(point) > options.farthest => {
                    searches[k].outcome = Some(Err(Unconverged::Far));
                }
                Ok(step) => steps.push((k, step)),
            }
        }
        line_search(evaluator, &mut searches, steps, limits)?;
    }
    let (mut found, mut failed) = (Vec::new(), Vec::new());
    for search in searches {
        match search.outcome.unwrap_or(Err(Unconverged::Iterations)) {
            Ok(point) => found.push(point),
            Err(why) => failed.push(why),
        }
    }
    Ok((found, failed))
}

/// A search direction with the merit function that judges it.
struct Step {
    direction: Vec<f64>,
    target: Vec<f64>,
    penalties: Vec<f64>,
    merit: f64,
    slope: f64,
}

impl Step {
    /// The step at `point` towards the point of the linearised limits nearest to the origin.
    fn new(
        point: &[f64],
        planes: &[Linearisation],
        curvature: &mut Curvature,
        longest: f64,
    ) -> std::result::Result<Step, Unconverged> {
        if planes.iter().any(|plane| !plane.is_finite()) {
            return Err(Unconverged::Fault);
        }
        if planes.iter().any(|plane| plane.slope() < 1e-12 * plane.margin.abs().max(1e-300)) {
            return Err(Unconverged::Flat);
        }
        let (target, multipliers) = nearest_linearised(point, planes)?;
        let mut direction: Vec<f64> = match planes {
            [plane] => curvature.step(point, plane.margin, &plane.gradient),
            _ => target.iter().zip(point).map(|(t, u)| t - u).collect(),
        };
        let length = norm(&direction);
        if length > longest {
            direction.iter_mut().for_each(|x| *x *= longest / length);
        }
        // An exact penalty exceeds the multiplier; the second bound lets full steps pass near the end.
        let pull = norm(point).max(norm(&target));
        let penalties: Vec<f64> = planes
            .iter()
            .zip(&multipliers)
            .map(|(plane, multiplier)| 2.0 * multiplier.abs().max(pull / plane.slope()) + 1e-12)
            .collect();
        let excess = violations(planes.iter().map(|plane| plane.margin), planes.len());
        let merit = merit(point, &excess, &penalties);
        let shrink = length.min(longest) / length.max(1e-300);
        let slope = dot(point, &direction) - shrink * dot(&excess, &penalties);
        Ok(Step { direction, target, penalties, merit, slope })
    }

    fn has_converged(
        &self,
        point: &[f64],
        planes: &[Linearisation],
        options: &SearchOptions,
    ) -> bool {
        let excess = violations(planes.iter().map(|plane| plane.margin), planes.len());
        let close = excess
            .iter()
            .zip(planes)
            .all(|(excess, plane)| excess / plane.slope() <= options.distance_tolerance);
        // The target differs from a point on the limit only by the part across the gradient.
        let tolerance = options.angle_tolerance * norm(point).max(1.0);
        close && distance(&self.target, point) <= tolerance
    }
}

/// How far each margin is from where the search wants it: from zero for one limit, above zero for
/// several, of which some may hold with room.
fn violations(margins: impl Iterator<Item = f64>, limits: usize) -> Vec<f64> {
    margins.map(|margin| if limits == 1 { margin.abs() } else { margin.max(0.0) }).collect()
}

fn merit(point: &[f64], excess: &[f64], penalties: &[f64]) -> f64 {
    0.5 * dot(point, point) + dot(excess, penalties)
}

/// The point nearest to the origin on the linearised limit, or within all linearised half spaces, with
/// the multipliers of the limits.
fn nearest_linearised(
    point: &[f64],
    planes: &[Linearisation],
) -> std::result::Result<(Vec<f64>, Vec<f64>), Unconverged> {
    if let [plane] = planes {
        let slope2 = dot(&plane.gradient, &plane.gradient);
        let factor = (dot(&plane.gradient, point) - plane.margin) / slope2;
        return Ok((plane.gradient.iter().map(|x| factor * x).collect(), vec![factor]));
    }
    let bounds: Vec<f64> =
        planes.iter().map(|plane| dot(&plane.gradient, point) - plane.margin).collect();
    let mut nearest = vec![0.0; point.len()];
    let mut multipliers = vec![0.0; planes.len()];
    for _ in 0..2000 {
        let mut moved = 0.0_f64;
        for ((plane, bound), multiplier) in planes.iter().zip(&bounds).zip(&mut multipliers) {
            let slope2 = dot(&plane.gradient, &plane.gradient);
            let raised = (dot(&plane.gradient, &nearest) - bound) / slope2;
            let change = (*multiplier + raised).max(0.0) - *multiplier;
            *multiplier += change;
            nearest.iter_mut().zip(&plane.gradient).for_each(|(x, g)| *x -= change * g);
            moved = moved.max(change.abs() * slope2.sqrt());
        }
        if moved < 1e-9 {
            return Ok((nearest, multipliers));
        }
    }
    Err(Unconverged::Infeasible)
}

/// The best of the step lengths 1, ½, ¼, ⅛ that satisfies Armijo's rule, all searches in one batch; then
/// shorter ones to 2⁻¹², for the searches that found none. The best rather than the first: where
/// |curvature × β| is near 1 the full step is allowed for ever and goes nowhere.
fn line_search(
    evaluator: &mut Evaluator,
    searches: &mut [Search],
    steps: Vec<(usize, Step)>,
    limits: &[usize],
) -> Result<()> {
    let all: Vec<f64> = (0..=12).map(|k| 1.0 / f64::from(1u32 << k)).collect();
    let (long, short) = all.split_at(4);
    let mut waiting = steps;
    for lengths in [long, short] {
        let mut rows: Vec<Vec<f64>> = Vec::new();
        for (k, step) in &waiting {
            for length in lengths {
                let from = searches[*k].point.iter();
                rows.push(from.zip(&step.direction).map(|(u, d)| u + length * d).collect());
            }
        }
        if rows.is_empty() {
            return Ok(());
        }
        let margins = evaluator.margins(&Columns::from_rows(&rows))?.clone();
        let mut left = Vec::new();
        for (position, (k, step)) in waiting.into_iter().enumerate() {
            let mut accepted: Option<(f64, usize)> = None;
            for (which, length) in lengths.iter().enumerate() {
                let row = position * lengths.len() + which;
                let at = limits.iter().map(|&limit| margins.get(row, limit));
                let merit = merit(&rows[row], &violations(at, limits.len()), &step.penalties);
                let allowed = step.merit + 1e-4 * length * step.slope.min(0.0);
                let allowed = allowed + 1e-13 * step.merit.abs();
                if merit <= allowed && accepted.is_none_or(|(least, _)| merit < least) {
                    accepted = Some((merit, row));
                }
            }
            match accepted {
                Some((_, row)) => searches[k].point.clone_from(&rows[row]),
                None => left.push((k, step)),
            }
        }
        waiting = left;
    }
    for (k, _) in waiting {
        searches[k].outcome = Some(Err(Unconverged::Stalled));
    }
    Ok(())
}

fn design_point(
    limits: &[usize],
    point: &[f64],
    planes: &[Linearisation],
    iterations: usize,
) -> DesignPoint {
    let half_spaces: Vec<HalfSpace> = planes
        .iter()
        .map(|plane| {
            let slope = plane.slope();
            let direction: Vec<f64> = plane.gradient.iter().map(|x| -x / slope).collect();
            // The limit's own zero along its normal, not the point's last rounding.
            let reliability_index = dot(&direction, point) + plane.margin / slope;
            HalfSpace { direction, reliability_index }
        })
        .collect();
    let (reliability_index, direction) = match &half_spaces[..] {
        [one] => (one.reliability_index, one.direction.clone()),
        _ => {
            let length = norm(point);
            (length, point.iter().map(|x| x / length.max(1e-300)).collect())
        }
    };
    DesignPoint {
        limits: limits.to_vec(),
        point: point.to_vec(),
        reliability_index,
        importance: direction.iter().map(|x| x * x).collect(),
        half_spaces,
        iterations,
    }
}
