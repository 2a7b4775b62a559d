//! Is a plan of tightenings the cheapest? Every plan of a grid that costs less, the cheapest first, until one
//! reaches the aim.
//!
//! The grid: half halvings of a spread up to [`MOST_HALVINGS`], or the grades that can be bought. No monotony is
//! assumed, since a narrower spread may raise a probability; a plan is refuted by counting.

use super::allocation::{MOST_HALVINGS, Purchase};
use crate::error::Result;
use crate::numerics::elementary::pow;

/// Plans that are listed at most; beyond, only those are that cost less than some bound.
const MOST_PLANS: usize = 100_000;
/// Costs that differ by less are the same.
const SAME: f64 = 1e-9;

/// A plan: the spread factor of every factor, and its cost.
pub type GridPlan = (Vec<f64>, f64);

/// What refuting cheaper plans has shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Proof {
    /// Plans of the grid that were refuted: the cheapest.
    pub refuted: usize,
    /// No plan of the grid that costs less than this reaches the aim.
    pub none_below: f64,
    /// Whether that is every plan that costs less than the one in hand.
    pub complete: bool,
    /// The first that reaches the aim after all, with where it does.
    pub found: Option<(GridPlan, Vec<f64>)>,
}

/// Every plan of the grid that costs less than `below`, the cheapest first, and the cost below which that is
/// every one.
pub fn cheaper(purchases: &[Purchase], below: f64) -> (Vec<GridPlan>, f64) {
    let options: Vec<Vec<(f64, f64)>> = purchases.iter().map(options).collect();
    let mut bound = below;
    loop {
        let mut plans = Vec::new();
        let mut spreads = Vec::with_capacity(options.len());
        if collect(&options, &mut spreads, 0.0, bound - SAME, &mut plans) {
            plans.sort_by(|a: &GridPlan, b| {
                a.1.total_cmp(&b.1).then_with(|| wider_first(&a.0, &b.0))
            });
            return (plans, bound);
        }
        bound *= 0.8;
    }
}

/// What can be bought of one factor: spread and cost, nothing first. Grades that another undercuts are kept.
fn options(purchase: &Purchase) -> Vec<(f64, f64)> {
    let mut options = vec![(1.0, 0.0)];
    match purchase {
        Purchase::PerHalving(_) => {
            let steps = (2.0 * MOST_HALVINGS) as u32;
            let spreads = (1..=steps).map(|k| pow(0.5, 0.5 * f64::from(k)));
            options.extend(spreads.map(|spread| (spread, purchase.cost(spread))));
        }
        Purchase::Grades(grades) => options.extend(grades.iter().copied()),
        Purchase::Nothing => {}
    }
    options
}

/// All combinations from factor `spreads.len()` on; false if they are too many.
fn collect(
    options: &[Vec<(f64, f64)>],
    spreads: &mut Vec<f64>,
    cost: f64,
    below: f64,
    plans: &mut Vec<GridPlan>,
) -> bool {
    let Some(own) = options.get(spreads.len()) else {
        plans.push((spreads.clone(), cost));
        return plans.len() <= MOST_PLANS;
    };
    for &(spread, price) in own {
        if cost + price >= below {
            continue;
        }
        spreads.push(spread);
        let few = collect(options, spreads, cost + price, below, plans);
        spreads.pop();
        if !few {
            return false;
        }
    }
    true
}

fn wider_first(a: &[f64], b: &[f64]) -> std::cmp::Ordering {
    let pairs = a.iter().zip(b);
    pairs.map(|(a, b)| b.total_cmp(a)).find(|o| o.is_ne()).unwrap_or(std::cmp::Ordering::Equal)
}

/// Refutes the plans that cost less than `cost`, the cheapest first, until one reaches the aim or `reaches` has had
/// enough: it gives the design values at which a plan reaches the aim, or none, and `None` to stop.
///
/// # Errors
/// What `reaches` returns.
pub fn prove(
    purchases: &[Purchase],
    cost: f64,
    mut reaches: impl FnMut(&[f64]) -> Result<Option<Option<Vec<f64>>>>,
) -> Result<Proof> {
    let (plans, bound) = cheaper(purchases, cost);
    for (k, plan) in plans.iter().enumerate() {
        let (none_below, refuted) = (plan.1, k);
        match reaches(&plan.0)? {
            None => return Ok(Proof { refuted, none_below, complete: false, found: None }),
            Some(None) => {}
            Some(Some(design)) => {
                let found = Some((plan.clone(), design));
                return Ok(Proof { refuted, none_below, complete: true, found });
            }
        }
    }
    let complete = bound >= cost;
    Ok(Proof { refuted: plans.len(), none_below: bound, complete, found: None })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_the_plans_below_a_cost_are_counted() {
        // n half halvings among three factors at 1 a halving: C(n + 2, 2) ways; below 1.5 are n = 0, 1, 2.
        let (plans, bound) = cheaper(&vec![Purchase::PerHalving(1.0); 3], 1.5);
        assert_eq!((plans.len(), bound), (1 + 3 + 6, 1.5));
        assert_eq!(plans[0], (vec![1.0; 3], 0.0));
        assert!(plans.windows(2).all(|pair| pair[0].1 <= pair[1].1 + 1e-12));
        let mixed = [
            Purchase::Grades(vec![(0.5, 10.0), (0.2, 12.0)]),
            Purchase::Nothing,
            Purchase::PerHalving(4.0),
        ];
        let (plans, _) = cheaper(&mixed, 12.5);
        // Without a grade six of 0, 2, … 12; with the first two (10 + 0, 10 + 2), with the second one.
        assert_eq!(plans.len(), 7 + 2 + 1);
        assert!(plans.iter().all(|plan| plan.0[1] == 1.0));
    }

    #[test]
    fn property_too_many_plans_are_cut_at_a_cost() {
        let (plans, bound) = cheaper(&vec![Purchase::PerHalving(1.0); 20], 6.0);
        assert!(bound < 6.0 && plans.len() <= MOST_PLANS && plans.len() > 100, "{bound}");
    }

    #[test]
    fn analytic_the_cheapest_that_reaches_is_found_and_the_cheaper_ones_are_counted() {
        // Reached once the product of the spreads is at most 1/4: two halvings however they are spread.
        let purchases = [Purchase::PerHalving(1.0), Purchase::PerHalving(1.5)];
        let reaches = |s: &[f64]| Ok(Some((s[0] * s[1] <= 0.2501).then(|| vec![7.0])));
        let proof = prove(&purchases, 3.0, reaches).unwrap();
        let (plan, design) = proof.found.unwrap();
        assert!((plan.1 - 2.0).abs() < 1e-9 && (plan.0[0] - 0.25).abs() < 1e-12, "{plan:?}");
        assert_eq!((design, proof.complete), (vec![7.0], true));
        assert!((proof.none_below - 2.0).abs() < 1e-9);
        let proof = prove(&purchases, 2.0, reaches).unwrap();
        assert_eq!((proof.found, proof.complete, proof.none_below), (None, true, 2.0));
        let mut asked = 0;
        let stop = |_: &[f64]| {
            asked += 1;
            Ok((asked < 3).then_some(None))
        };
        let proof = prove(&purchases, 2.0, stop).unwrap();
        assert!(!proof.complete && proof.refuted == 2 && proof.none_below > 0.0);
    }
}
