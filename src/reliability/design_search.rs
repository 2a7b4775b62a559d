//! The search of design points itself: starts, steps and the line search.
//!
//! Improved HLRF (Zhang and Der Kiureghian, 1995, "Two improved algorithms for reliability analysis"): a
//! step to the point of the linearised limit nearest to the origin, with Armijo's rule on the merit
//! ½‖u‖² + c |g|, the nearness measured with a quasi-Newton model of the limit's curvature. Several limits
//! at once take the step to the nearest point of all their linearised half spaces (Hildreth's quadratic
//! programme) and the merit ½‖u‖² + Σ c max(g, 0).

use super::design_point::{DesignPoint, HalfSpace, SearchOptions, Unconverged};
use super::draws::direction;
use super::event::Evaluator;
use super::linearisation::{Linearisation, linearise};
use super::quasi_newton::Curvature;
use super::vectors::{distance, dot, norm};
use crate::error::Result;
use crate::numerics::columns::Columns;
use crate::streams::{Purpose, stream};

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

/// What one search found.
#[derive(Default)]
pub(super) struct Found {
    /// The points on which starts converged.
    pub points: Vec<DesignPoint>,
    /// Why the others did not.
    pub failed: Vec<Unconverged>,
    /// Whether the origin breaches every limit that was asked for.
    pub origin_breaches: bool,
}

/// Runs every start in lockstep, so that gradients and line searches come in large batches.
pub(super) fn search(
    evaluator: &mut Evaluator,
    limits: &[usize],
    options: &SearchOptions,
) -> Result<Found> {
    let joint = limits.len() > 1;
    let mut searches: Vec<Search> = starts(evaluator.dimension(), options)
        .into_iter()
        .map(|point| Search { curvature: Curvature::new(point.len()), point, outcome: None })
        .collect();
    let mut all = Found::default();
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
            if iteration == 0 && k == 0 && planes.iter().all(|plane| plane.margin < 0.0) {
                all.origin_breaches = true;
                if joint {
                    all.failed.push(Unconverged::OriginBreaches);
                    return Ok(all);
                }
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
    for search in searches {
        match search.outcome.unwrap_or(Err(Unconverged::Iterations)) {
            Ok(point) => all.points.push(point),
            Err(why) => all.failed.push(why),
        }
    }
    Ok(all)
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
