//! SORM: the curvatures of the limit at the design point correct FORM's plane.
//!
//! In the tangent plane at u*, the limit is u_n = β + ½ Σ κ_i v_i²; then
//! Breitung (J. Eng. Mech. 110 (1984) 357): p = Φ(−β) Π (1 + β κ_i)^−½;
//! Hohenbichler and Rackwitz (J. Eng. Mech. 114 (1988) 2195): p = Φ(−β) Π (1 + ψ κ_i)^−½, ψ = φ(β)/Φ(−β).

use super::design_point::{DesignPoint, DesignPoints, SearchOptions, design_points};
use super::estimate::{Estimate, Method};
use super::event::{Evaluator, Event, FaultReading};
use super::form::{first_order, no_design_point};
use super::limit_state::LimitState;
use super::linearisation::linearise;
use crate::error::Result;
use crate::numerics::columns::Columns;
use crate::numerics::special::normal;
use nalgebra::{DMatrix, SymmetricEigen};

/// How curvatures are found.
#[derive(Debug, Clone, PartialEq)]
pub struct SormOptions {
    /// The search of the design point.
    pub search: SearchOptions,
    /// Half width of the second differences, in standard deviations.
    pub difference_step: f64,
}

impl SormOptions {
    /// The usual choices, with the seed of every stream.
    pub fn seeded(seed: u64) -> Self {
        SormOptions { search: SearchOptions::seeded(seed), difference_step: 0.05 }
    }
}

/// Second-order estimates of one limit.
#[derive(Debug, Clone, PartialEq)]
pub struct SecondOrder {
    /// Breitung's formula.
    pub breitung: Estimate,
    /// Hohenbichler and Rackwitz' factor.
    pub hohenbichler_rackwitz: Estimate,
    /// Principal curvatures κ at the nearest design point, ascending; empty without a point.
    pub curvatures: Vec<f64>,
}

/// SORM of one limit at its nearest design point, with the design points found.
///
/// Costs dimension² + dimension evaluations beyond FORM. Formulas that have no value (1 + βκ ≤ 0: the
/// limit curves around the origin, or the point is not the nearest one) report no number.
///
/// # Errors
/// Those of [`design_points`].
pub fn sorm(
    state: &dyn LimitState,
    limit: usize,
    options: &SormOptions,
) -> Result<(SecondOrder, DesignPoints)> {
    let event = Event::Limit(limit);
    let found = design_points(state, event, &options.search)?;
    let mut evaluator = Evaluator::new(state, event, FaultReading::Kept)?;
    let mut second = match found.points.first() {
        Some(point) => {
            let curvatures = curvatures(&mut evaluator, point, limit, options)?;
            second_order(event, point.reliability_index, curvatures)
        }
        None => without_number(event, &no_design_point(&found)),
    };
    for estimate in [&mut second.breitung, &mut second.hohenbichler_rackwitz] {
        estimate.evaluations = found.evaluations + evaluator.evaluations;
        estimate.faults = found.faults + evaluator.faults;
        estimate.diagnostics.extend(found.diagnostics());
    }
    Ok((second, found))
}

fn without_number(event: Event, why: &str) -> SecondOrder {
    SecondOrder {
        breitung: Estimate::without_number(Method::SormBreitung, event, why),
        hohenbichler_rackwitz: Estimate::without_number(
            Method::SormHohenbichlerRackwitz,
            event,
            why,
        ),
        curvatures: Vec::new(),
    }
}

/// Both formulas from β and the curvatures.
fn second_order(event: Event, beta: f64, curvatures: Option<Vec<f64>>) -> SecondOrder {
    let Some(curvatures) = curvatures else {
        return without_number(event, "a margin around the design point could not be evaluated");
    };
    // Where the origin breaches, the safe set is the one behind the curved limit.
    let mirrored = beta < 0.0;
    let side = if mirrored { -1.0 } else { 1.0 };
    let (distance, tail) = (beta.abs(), normal::survival(beta.abs()));
    let formula = |method: Method, factor: f64| {
        let terms = curvatures.iter().map(|kappa| 1.0 + factor * side * kappa);
        if terms.clone().any(|term| term <= 0.0) {
            let why = "the formula has no value: a curvature at the design point is below −1/β";
            return Estimate::without_number(method, event, why);
        }
        let probability = tail * terms.map(|term| term.sqrt().recip()).product::<f64>();
        if probability > 1.0 {
            let why = "the formula gives more than 1: too many curvatures are near −1/β";
            return Estimate::without_number(method, event, why);
        }
        first_order(method, event, if mirrored { 1.0 - probability } else { probability })
    };
    let ratio = if tail > 0.0 { normal::density(distance) / tail } else { distance };
    SecondOrder {
        breitung: formula(Method::SormBreitung, distance),
        hohenbichler_rackwitz: formula(Method::SormHohenbichlerRackwitz, ratio),
        curvatures,
    }
}

/// Eigenvalues of the Hessian over the gradient's length within the tangent plane; none after a fault.
fn curvatures(
    evaluator: &mut Evaluator,
    point: &DesignPoint,
    limit: usize,
    options: &SormOptions,
) -> Result<Option<Vec<f64>>> {
    let n = point.point.len();
    let step = options.search.difference_step;
    let planes = linearise(evaluator, std::slice::from_ref(&point.point), &[limit], step)?;
    let slope = planes[0][0].slope();
    let Some(hessian) = hessian(evaluator, &point.point, limit, options.difference_step)? else {
        return Ok(None);
    };
    // An orthonormal basis of the tangent plane: Householder's reflection takes the last axis to α.
    let mut normal = point.half_spaces[0].direction.clone();
    let last = n - 1;
    let sign = if normal[last] >= 0.0 { 1.0 } else { -1.0 };
    normal[last] += sign;
    let length2: f64 = normal.iter().map(|x| x * x).sum();
    let basis = DMatrix::from_fn(n, last, |i, j| {
        f64::from(u8::from(i == j)) - 2.0 * normal[i] * normal[j] / length2
    });
    let tangent = basis.transpose() * hessian * basis / slope;
    if last == 0 {
        return Ok(Some(Vec::new()));
    }
    let mut values: Vec<f64> = SymmetricEigen::new(tangent).eigenvalues.iter().copied().collect();
    values.sort_by(f64::total_cmp);
    Ok(Some(values))
}

/// Second differences in one batch of n² + n + 1 points; none after a fault.
fn hessian(
    evaluator: &mut Evaluator,
    at: &[f64],
    limit: usize,
    step: f64,
) -> Result<Option<DMatrix<f64>>> {
    let n = at.len();
    let moved = |moves: &[(usize, f64)]| {
        let mut point = at.to_vec();
        moves.iter().for_each(|&(j, by)| point[j] += by);
        point
    };
    let mut rows = vec![at.to_vec()];
    for side in [step, -step] {
        rows.extend((0..n).map(|j| moved(&[(j, side)])));
    }
    for i in 0..n {
        for j in 0..i {
            rows.extend([step, -step].map(|side| moved(&[(i, side), (j, side)])));
        }
    }
    let margins = evaluator.margins(&Columns::from_rows(&rows))?.column(limit).to_vec();
    let faults = margins.iter().filter(|margin| !margin.is_finite()).count() as u64;
    evaluator.faults += faults;
    if faults > 0 {
        return Ok(None);
    }
    let (centre, ahead, behind) = (margins[0], &margins[1..=n], &margins[n + 1..=2 * n]);
    let mut pairs = margins[2 * n + 1..].chunks_exact(2);
    let mut hessian = DMatrix::zeros(n, n);
    for i in 0..n {
        hessian[(i, i)] = (ahead[i] - 2.0 * centre + behind[i]) / (step * step);
        for j in 0..i {
            let diagonal = pairs.next().map_or(0.0, |pair| pair.iter().sum::<f64>());
            let axes = ahead[i] + behind[i] + ahead[j] + behind[j];
            let mixed = (diagonal + 2.0 * centre - axes) / (2.0 * step * step);
            hessian[(i, j)] = mixed;
            hessian[(j, i)] = mixed;
        }
    }
    Ok(Some(hessian))
}
