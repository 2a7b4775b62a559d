//! The cheapest set of tightenings that brings a probability down to an aim.
//!
//! The probability is whatever `evaluate` says: with common random numbers a function without noise of its
//! own. Half a halving is bought at a time, where the logarithm of the probability falls most for the
//! money, and free design values follow to their best after every purchase; then purchases are exchanged
//! and trimmed for as long as that saves. For independent contributions to a variance the problem is convex
//! and this finds its solution; in general it finds a good plan and proves nothing:
//! [`super::cheaper_plans`] does.

use crate::error::{Error, Result};
use crate::numerics::elementary::{ln, pow};

/// The most halvings of a spread that are considered.
pub const MOST_HALVINGS: f64 = 6.0;
/// Halvings bought at a time.
const STEP: f64 = 0.5;
/// Settings of a design value in its first sweep.
const SWEEP: usize = 13;
/// Rounds of exchanges.
const ROUNDS: usize = 4;
/// Bisections of a purchase that is trimmed.
const TRIMMINGS: usize = 5;

/// What can be bought of one factor.
#[derive(Debug, Clone, PartialEq)]
pub enum Purchase {
    /// Any spread, at so much for each halving.
    PerHalving(f64),
    /// Grades: spread factor below 1, and cost.
    Grades(Vec<(f64, f64)>),
    /// Nothing.
    Nothing,
}

impl Purchase {
    /// What a spread factor costs; a grade at least that narrow, of grades.
    pub fn cost(&self, spread: f64) -> f64 {
        match self {
            _ if spread >= 1.0 => 0.0,
            Purchase::PerHalving(cost) => cost * ln(1.0 / spread) / std::f64::consts::LN_2,
            Purchase::Grades(grades) => grades
                .iter()
                .filter(|(other, _)| *other <= spread)
                .map(|(_, cost)| *cost)
                .fold(f64::INFINITY, f64::min),
            Purchase::Nothing => f64::INFINITY,
        }
    }

    /// Narrower spreads to try next, the widest first.
    fn narrower(&self, spread: f64) -> Vec<f64> {
        match self {
            Purchase::PerHalving(_) => {
                let next = spread * pow(0.5, STEP);
                if next >= 0.999 * pow(0.5, MOST_HALVINGS) { vec![next] } else { Vec::new() }
            }
            Purchase::Grades(grades) => sorted(grades.iter().filter(|g| g.0 < spread)),
            Purchase::Nothing => Vec::new(),
        }
    }

    /// The next wider spread.
    fn wider(&self, spread: f64) -> Option<f64> {
        match self {
            _ if spread >= 1.0 => None,
            Purchase::PerHalving(_) => Some((spread / pow(0.5, STEP)).min(1.0)),
            Purchase::Grades(grades) => {
                sorted(grades.iter().filter(|g| g.0 > spread)).last().copied().or(Some(1.0))
            }
            Purchase::Nothing => None,
        }
    }

    /// The narrowest spread.
    fn narrowest(&self) -> f64 {
        match self {
            Purchase::PerHalving(_) => pow(0.5, MOST_HALVINGS),
            Purchase::Grades(grades) => grades.iter().map(|grade| grade.0).fold(1.0, f64::min),
            Purchase::Nothing => 1.0,
        }
    }
}

fn sorted<'g>(grades: impl Iterator<Item = &'g (f64, f64)>) -> Vec<f64> {
    let mut spreads: Vec<f64> = grades.map(|grade| grade.0).collect();
    spreads.sort_by(|a, b| b.total_cmp(a));
    spreads
}

/// A free design value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeValue {
    /// Smallest.
    pub lower: f64,
    /// Largest.
    pub upper: f64,
    /// Where it is now.
    pub present: f64,
}

/// What is sought.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// One entry a factor.
    pub purchases: Vec<Purchase>,
    /// Design values that may move at no cost.
    pub design: Vec<FreeValue>,
    /// The probability to come down to.
    pub aim: f64,
}

/// Spreads and design values with what they cost and give.
#[derive(Debug, Clone, PartialEq)]
pub struct Allocation {
    /// Spread factor of every factor; 1 where nothing is bought.
    pub spreads: Vec<f64>,
    /// Design values.
    pub design: Vec<f64>,
    /// Cost.
    pub cost: f64,
    /// The probability, by `evaluate`.
    pub probability: f64,
}

/// What a search found.
#[derive(Debug, Clone, PartialEq)]
pub struct Search {
    /// The cheapest plan found that reaches the aim; `None` if none does.
    pub plan: Option<Allocation>,
    /// The way there, from the present design: after each purchase.
    pub steps: Vec<Allocation>,
    /// Everything bought that can be, the design at its best for that.
    pub everything: Allocation,
    /// Evaluations spent.
    pub evaluations: u64,
}

/// The probability at spreads and design values.
pub type Evaluate<'e> = dyn FnMut(&[f64], &[f64]) -> Result<f64> + 'e;

/// Searches for the cheapest allocation whose probability is at most the aim.
///
/// # Errors
/// If a cost or grade is impossible, and whatever `evaluate` returns.
pub fn cheapest<'p>(problem: &'p Problem, evaluate: &'p mut Evaluate<'p>) -> Result<Search> {
    for purchase in &problem.purchases {
        let possible = match purchase {
            Purchase::PerHalving(cost) => *cost >= 0.0 && cost.is_finite(),
            Purchase::Grades(grades) => {
                grades.iter().all(|(s, c)| (0.0..1.0).contains(s) && *c >= 0.0 && c.is_finite())
            }
            Purchase::Nothing => true,
        };
        if !possible {
            return Err(Error::argument(
                "costs are finite and not negative, grades narrow a spread",
            ));
        }
    }
    let mut searcher = Searcher { problem, evaluate, evaluations: 0 };
    let ones = vec![1.0; problem.purchases.len()];
    let present: Vec<f64> = problem.design.iter().map(|value| value.present).collect();
    let start = searcher.at(ones, present.clone())?;
    let mut now = searcher.with_best_design(start.clone(), true)?;
    let mut steps = vec![start];
    if now.design != present {
        steps.push(now.clone());
    }
    let narrowest = problem.purchases.iter().map(Purchase::narrowest).collect();
    let everything = searcher.at(narrowest, now.design.clone())?;
    let everything = searcher.with_best_design(everything, true)?;
    let plan = if now.probability <= problem.aim {
        Some(now)
    } else if everything.probability > problem.aim {
        None
    } else {
        while now.probability > problem.aim {
            let Some(next) = searcher.purchase(&now)? else { break };
            now = searcher.with_best_design(next, false)?;
            steps.push(now.clone());
        }
        if now.probability > problem.aim {
            // No single step helps, but everything together does.
            now = everything.clone();
        }
        Some(searcher.polished(now)?)
    };
    if let Some(plan) = plan.as_ref().filter(|plan| steps.last() != Some(*plan)) {
        steps.push(plan.clone());
    }
    Ok(Search { plan, steps, everything, evaluations: searcher.evaluations })
}

/// A plan with the design values at their best near where they are, and without what the aim does not need.
///
/// # Errors
/// What `evaluate` returns.
pub fn trimmed<'p>(
    problem: &'p Problem,
    evaluate: &'p mut Evaluate<'p>,
    spreads: Vec<f64>,
    design: Vec<f64>,
) -> Result<(Allocation, u64)> {
    let mut searcher = Searcher { problem, evaluate, evaluations: 0 };
    let plan = searcher.at(spreads, design)?;
    let plan = searcher.with_best_design(plan, false)?;
    let plan = searcher.trimmed(plan)?;
    Ok((plan, searcher.evaluations))
}

struct Searcher<'p> {
    problem: &'p Problem,
    evaluate: &'p mut Evaluate<'p>,
    evaluations: u64,
}

impl Searcher<'_> {
    fn at(&mut self, spreads: Vec<f64>, design: Vec<f64>) -> Result<Allocation> {
        self.evaluations += 1;
        let probability = (self.evaluate)(&spreads, &design)?;
        let bought = self.problem.purchases.iter().zip(&spreads);
        let cost = bought.map(|(purchase, &spread)| purchase.cost(spread)).sum();
        Ok(Allocation { spreads, design, cost, probability })
    }

    fn with_spread(&mut self, of: &Allocation, factor: usize, spread: f64) -> Result<Allocation> {
        let mut spreads = of.spreads.clone();
        spreads[factor] = spread;
        self.at(spreads, of.design.clone())
    }

    /// Moves every design value to where the probability is least: a sweep over its whole range first if
    /// `widely`, then steps that shrink.
    fn with_best_design(&mut self, from: Allocation, widely: bool) -> Result<Allocation> {
        let mut best = from;
        for (d, value) in self.problem.design.iter().enumerate() {
            let mut step = (value.upper - value.lower) / (SWEEP - 1) as f64;
            let moved = |searcher: &mut Self, of: &Allocation, to: f64| {
                let mut design = of.design.clone();
                design[d] = to;
                searcher.at(of.spreads.clone(), design)
            };
            if widely {
                for k in 0..SWEEP {
                    let next = moved(self, &best, value.lower + step * k as f64)?;
                    if next.probability < best.probability {
                        best = next;
                    }
                }
            }
            let least = step / if widely { 4.0 } else { 3.0 };
            step *= 0.5;
            while step >= least {
                let mut improved = false;
                for to in [best.design[d] - step, best.design[d] + step] {
                    if (value.lower..=value.upper).contains(&to) {
                        let next = moved(self, &best, to)?;
                        if next.probability < best.probability {
                            best = next;
                            improved = true;
                            break;
                        }
                    }
                }
                if !improved {
                    step *= 0.5;
                }
            }
        }
        Ok(best)
    }

    /// The purchase that serves best for its money; `None` if none helps.
    fn purchase(&mut self, now: &Allocation) -> Result<Option<Allocation>> {
        let mut best: Option<(f64, Allocation)> = None;
        let mut reaching: Option<Allocation> = None;
        for factor in 0..self.problem.purchases.len() {
            for spread in self.problem.purchases[factor].narrower(now.spreads[factor]) {
                let next = self.with_spread(now, factor, spread)?;
                if next.probability >= now.probability {
                    continue;
                }
                if next.probability <= self.problem.aim
                    && reaching.as_ref().is_none_or(|other| next.cost < other.cost)
                {
                    reaching = Some(next.clone());
                }
                let floor = 0.1 * self.problem.aim;
                let fall = ln(now.probability.max(floor)) - ln(next.probability.max(floor));
                let value = fall / (next.cost - now.cost).max(1e-9);
                if best.as_ref().is_none_or(|(other, _)| value > *other) {
                    best = Some((value, next));
                }
            }
        }
        Ok(reaching.or(best.map(|(_, next)| next)))
    }

    /// Exchanges purchases and trims them while that saves.
    fn polished(&mut self, plan: Allocation) -> Result<Allocation> {
        let mut plan = plan;
        for _ in 0..ROUNDS {
            let mut best: Option<Allocation> = None;
            for give in 0..plan.spreads.len() {
                let Some(wider) = self.problem.purchases[give].wider(plan.spreads[give]) else {
                    continue;
                };
                let without = self.with_spread(&plan, give, wider)?;
                let mut candidates = vec![without.clone()];
                if without.probability > self.problem.aim {
                    candidates.clear();
                    for take in (0..plan.spreads.len()).filter(|&take| take != give) {
                        let spreads = self.problem.purchases[take].narrower(plan.spreads[take]);
                        for spread in spreads {
                            let cost = without.cost
                                - self.problem.purchases[take].cost(plan.spreads[take])
                                + self.problem.purchases[take].cost(spread);
                            if cost <= plan.cost + 1e-9 {
                                candidates.push(self.with_spread(&without, take, spread)?);
                            }
                        }
                    }
                }
                for next in candidates {
                    let reached = next.probability <= self.problem.aim;
                    let saves = next.cost < plan.cost - 1e-9;
                    // At the same cost, a lower probability leaves more to trim.
                    let lower =
                        next.cost <= plan.cost + 1e-9 && next.probability < plan.probability;
                    let ahead = best.as_ref().is_none_or(|other| {
                        (next.cost, next.probability) < (other.cost, other.probability)
                    });
                    if reached && (saves || lower) && ahead {
                        best = Some(next);
                    }
                }
            }
            match best {
                Some(next) => plan = self.with_best_design(next, false)?,
                None => break,
            }
        }
        self.trimmed(plan)
    }

    /// Gives back of each purchase, the dearest first, what the aim does not need.
    fn trimmed(&mut self, plan: Allocation) -> Result<Allocation> {
        let mut plan = plan;
        let mut order: Vec<usize> = (0..plan.spreads.len())
            .filter(|&f| {
                plan.spreads[f] < 1.0
                    && matches!(self.problem.purchases[f], Purchase::PerHalving(_))
            })
            .collect();
        let cost = |f: usize| self.problem.purchases[f].cost(plan.spreads[f]);
        order.sort_by(|&a, &b| cost(b).total_cmp(&cost(a)).then(a.cmp(&b)));
        for factor in order {
            let (mut enough, mut too_wide) = (plan.spreads[factor], 1.0f64);
            if let Some(wider) = self.problem.purchases[factor].wider(enough) {
                too_wide = wider;
            }
            for _ in 0..TRIMMINGS {
                let middle = (enough * too_wide).sqrt();
                let next = self.with_spread(&plan, factor, middle)?;
                if next.probability <= self.problem.aim {
                    enough = middle;
                    plan = next;
                } else {
                    too_wide = middle;
                }
            }
        }
        Ok(plan)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::special::normal;

    /// P(|Z| > 1) of a normal variable whose variance is the sum of the factors' and which is off centre by
    /// the design value.
    fn two_sided(variances: &[f64], spreads: &[f64], off: f64) -> f64 {
        let variance: f64 = variances.iter().zip(spreads).map(|(v, s)| v * s * s).sum();
        let sd = variance.sqrt();
        normal::cdf((-1.0 - off) / sd) + normal::survival((1.0 - off) / sd)
    }

    #[test]
    fn analytic_independent_variances_are_bought_down_as_lagrange_says() {
        // Least Σ c log2(1/s) with Σ v s² = V: v s² is the same share of V for every factor bought at the same
        // cost per halving. P = 0.01 two-sided: V = 1/2.5758².
        let variances = [0.5, 0.3, 0.01];
        let problem = Problem {
            purchases: vec![Purchase::PerHalving(1.0); 3],
            design: vec![FreeValue { lower: -2.0, upper: 2.0, present: 0.7 }],
            aim: 0.01,
        };
        let mut evaluate = |s: &[f64], d: &[f64]| Ok(two_sided(&variances, s, d[0]));
        let found = cheapest(&problem, &mut evaluate).unwrap();
        let plan = found.plan.unwrap();
        let allowed = 1.0 / (2.5758293f64 * 2.5758293) - 0.01;
        let exact =
            0.5 * (ln(0.5 / (0.5 * allowed)) + ln(0.3 / (0.5 * allowed))) / std::f64::consts::LN_2;
        assert!(plan.probability <= 0.01 && plan.design[0].abs() < 0.1, "{plan:?}");
        assert!(plan.cost >= exact - 1e-9 && plan.cost < 1.03 * exact, "{plan:?} {exact}");
        assert_eq!(plan.spreads[2], 1.0);
    }

    #[test]
    fn property_grades_are_bought_by_the_piece_and_the_impossible_is_said() {
        let variances = [0.5, 0.5];
        let mut problem = Problem {
            purchases: vec![
                Purchase::Grades(vec![(0.5, 10.0), (0.2, 12.0)]),
                Purchase::PerHalving(4.0),
            ],
            design: Vec::new(),
            aim: 0.02,
        };
        let mut evaluate = |s: &[f64], _: &[f64]| Ok(two_sided(&variances, s, 0.0));
        let plan = cheapest(&problem, &mut evaluate).unwrap().plan.unwrap();
        assert_eq!(plan.spreads[0], 0.2);
        assert!(plan.probability <= 0.02);
        problem.purchases[1] = Purchase::Nothing;
        let found = cheapest(&problem, &mut evaluate).unwrap();
        assert!(found.plan.is_none());
        assert_eq!(found.everything.spreads, [0.2, 1.0]);
    }
}
