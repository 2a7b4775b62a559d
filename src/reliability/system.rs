//! System FORM: all design points together, as a union or an intersection of half spaces.

use super::design_point::{DesignPoints, HalfSpace, SearchOptions, design_points};
use super::estimate::{Estimate, Method};
use super::event::Event;
use super::form::{first_order, no_design_point};
use super::limit_state::LimitState;
use super::multinormal::{Integrated, bivariate_upper, orthant};
use super::vectors::dot;
use crate::error::Result;
use crate::numerics::special::normal;

/// First-order estimate of an event with several design points: of a single limit (all its points as a
/// union), of any limit (all points of all limits), or of limits together (the joint design point).
///
/// No interval, for FORM's reason. The bounds of a union and the error of the multinormal integral,
/// where it is not quadrature, are among the diagnostics.
///
/// # Errors
/// Those of [`design_points`].
pub fn system_form(
    state: &dyn LimitState,
    event: Event,
    options: &SearchOptions,
) -> Result<(Estimate, DesignPoints)> {
    let found = design_points(state, event, options)?;
    let estimate = from_design_points(event, &found, options.seed);
    Ok((estimate, found))
}

/// The system estimate from design points that are known already.
pub fn from_design_points(event: Event, found: &DesignPoints, seed: u64) -> Estimate {
    let method = Method::SystemForm;
    let joint = matches!(event, Event::Both(..) | Event::All);
    let mut estimate = match found.points.first() {
        None => Estimate::without_number(method, event, no_design_point(found)),
        Some(point) if joint => {
            let all = intersection(&point.half_spaces, seed);
            let mut estimate = first_order(method, event, all.probability);
            estimate.diagnostics.push(integration(all));
            estimate
        }
        Some(_) => {
            let half_spaces: Vec<HalfSpace> =
                found.points.iter().flat_map(|point| point.half_spaces.iter().cloned()).collect();
            let union = union(&half_spaces, seed);
            let (lower, upper) = ditlevsen_bounds(&half_spaces);
            let mut estimate = first_order(method, event, union.probability);
            estimate.diagnostics.push(integration(union));
            estimate.diagnostics.push(format!(
                "Ditlevsen's bounds of the {} half spaces' union: {lower:.4e} to {upper:.4e}",
                half_spaces.len()
            ));
            estimate
        }
    };
    estimate.evaluations = found.evaluations;
    estimate.faults = found.faults;
    estimate.diagnostics.extend(found.diagnostics());
    estimate
}

fn integration(integrated: Integrated) -> String {
    match integrated.standard_error {
        0.0 => "multinormal probability by quadrature".to_owned(),
        error => format!("multinormal probability with an integration error of {error:.1e}"),
    }
}

fn correlations(half_spaces: &[HalfSpace]) -> Vec<Vec<f64>> {
    let each = half_spaces.iter().map(|one| {
        let row = half_spaces.iter().map(|other| dot(&one.direction, &other.direction));
        row.collect()
    });
    each.collect()
}

/// Probability that a standard-normal point lies in all half spaces.
pub fn intersection(half_spaces: &[HalfSpace], seed: u64) -> Integrated {
    let sorted = sorted_by_rarity(half_spaces);
    let bounds: Vec<f64> = sorted.iter().map(|half| half.reliability_index).collect();
    orthant(&bounds, &correlations(&sorted), seed)
}

/// Probability that a standard-normal point lies in at least one half space: of each in turn and of none
/// before it, a sum of positive terms.
pub fn union(half_spaces: &[HalfSpace], seed: u64) -> Integrated {
    let mut sorted = sorted_by_rarity(half_spaces);
    sorted.reverse();
    let (mut probability, mut variance) = (0.0, 0.0);
    for k in 0..sorted.len() {
        let mut set = vec![sorted[k].clone()];
        set.extend(sorted[..k].iter().map(|half| HalfSpace {
            direction: half.direction.iter().map(|x| -x).collect(),
            reliability_index: -half.reliability_index,
        }));
        let bounds: Vec<f64> = set.iter().map(|half| half.reliability_index).collect();
        let term = orthant(&bounds, &correlations(&set), seed);
        probability += term.probability;
        variance += term.standard_error * term.standard_error;
    }
    Integrated { probability, standard_error: variance.sqrt() }
}

/// Rarest first.
fn sorted_by_rarity(half_spaces: &[HalfSpace]) -> Vec<HalfSpace> {
    let mut sorted = half_spaces.to_vec();
    sorted.sort_by(|a, b| b.reliability_index.total_cmp(&a.reliability_index));
    sorted
}

/// Bounds of the union's probability from single and pairwise probabilities.
///
/// Source: Ditlevsen, "Narrow reliability bounds for structural systems" (1979).
pub fn ditlevsen_bounds(half_spaces: &[HalfSpace]) -> (f64, f64) {
    let mut sorted = sorted_by_rarity(half_spaces);
    sorted.reverse();
    let (mut lower, mut upper) = (0.0, 0.0);
    for (k, one) in sorted.iter().enumerate() {
        let own = normal::survival(one.reliability_index);
        let pairs: Vec<f64> = sorted[..k]
            .iter()
            .map(|other| {
                let correlation = dot(&one.direction, &other.direction);
                bivariate_upper(one.reliability_index, other.reliability_index, correlation)
            })
            .collect();
        lower += (own - pairs.iter().sum::<f64>()).max(0.0);
        upper += own - pairs.iter().copied().fold(0.0, f64::max);
    }
    (lower, upper.min(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn half_space(direction: &[f64], reliability_index: f64) -> HalfSpace {
        HalfSpace { direction: direction.to_vec(), reliability_index }
    }

    #[test]
    fn analytic_union_of_orthogonal_half_spaces() {
        let half_spaces: Vec<HalfSpace> = (0..4)
            .map(|k| {
                let mut direction = vec![0.0; 4];
                direction[k] = 1.0;
                half_space(&direction, 2.0 + 0.5 * k as f64)
            })
            .collect();
        let clean: f64 = half_spaces.iter().map(|h| normal::cdf(h.reliability_index)).product();
        let found = union(&half_spaces, 3);
        // Independent factors leave nothing to integrate: only rounding.
        assert!((found.probability / (1.0 - clean) - 1.0).abs() < 1e-10, "{found:?}");
        let (lower, upper) = ditlevsen_bounds(&half_spaces);
        assert!(lower <= 1.0 - clean && 1.0 - clean <= upper && upper < 1.01 * (1.0 - clean));
        let together: f64 =
            half_spaces.iter().map(|h| normal::survival(h.reliability_index)).product();
        assert!((intersection(&half_spaces, 3).probability / together - 1.0).abs() < 1e-10);
    }

    #[test]
    fn property_a_half_space_twice_counts_once() {
        let one = half_space(&[1.0, 0.0], 3.0);
        let found = union(&[one.clone(), one.clone(), one], 4);
        assert!((found.probability / normal::survival(3.0) - 1.0).abs() < 1e-12, "{found:?}");
    }
}
