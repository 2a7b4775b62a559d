//! The cheapest set of tightenings and design changes that meets a target, searched for on one sample and
//! confirmed on another.

use super::Progress;
use super::common_numbers::{Breaches, Change, CommonSample, Event};
use super::refutation::{MOST_DESCENTS, Refutation};
use super::trade::trade_factors;
use crate::error::{Error, Result};
use crate::reliability::allocation::{
    Allocation, FreeValue, Problem, Purchase, Search, cheapest, trimmed,
};
use crate::reliability::cheaper_plans::{Proof, prove};
use crate::reliability::demonstration::{Demonstration, Requirement, Verdict};
use crate::sensitivity::pick_freeze::Factor;
use crate::streams::Purpose;
use crate::study::{Study, TighteningCost};

/// Confirming runs at most; the confidence of each allows for all.
const ATTEMPTS: u64 = 3;
/// Samples of a confirming run, at least.
const CONFIRMATION: f64 = 100_000.0;
/// Expected breaches at the target in a confirming run, at least, up to [`MOST_CONFIRMATION`].
const CONFIRMING_BREACHES: f64 = 2_000.0;
/// Samples of a confirming run, at most.
const MOST_CONFIRMATION: f64 = 1_000_000.0;
/// Confidence at which a target is demonstrated when the study states none.
pub const USUAL_CONFIDENCE: f64 = 0.90;

/// An independent run of a plan.
#[derive(Debug, Clone)]
pub struct Confirmation {
    /// The plan.
    pub plan: Allocation,
    /// Its breaches by limit: name's place in the study, and count.
    pub breaches: Breaches,
    /// What it demonstrates, at a confidence that allows for every attempt.
    pub demonstration: Demonstration,
}

/// One cause that would still be there with everything bought.
#[derive(Debug, Clone)]
pub struct Residual {
    /// Place among the factors.
    pub factor: usize,
    /// Breaches with everything bought and this factor without any spread.
    pub without: Breaches,
}

/// What the search for a plan came to.
#[derive(Debug)]
pub struct Tightening {
    /// The target.
    pub target: f64,
    /// Confidence of the demonstration, all attempts together.
    pub confidence: f64,
    /// What can be tightened, by factor.
    pub factors: Vec<Factor>,
    /// What each costs.
    pub purchases: Vec<Purchase>,
    /// Samples of the search.
    pub samples: u64,
    /// The aim on them: below the target by the search's own error.
    pub aim: f64,
    /// The last search.
    pub search: Search,
    /// Whether a cheaper plan of the grid reaches the aim; `None` without a plan.
    pub proof: Option<Proof>,
    /// Settings of the design values at which cheaper plans were refuted.
    pub settings: usize,
    /// Breaches of the study as it is, on the search's sample.
    pub base: Breaches,
    /// The last confirming run; of the plan, or without one of everything that can be bought.
    pub confirmation: Confirmation,
    /// Confirming runs made.
    pub attempts: u64,
    /// What remains if everything is bought and the target is still missed; with its breaches.
    pub residual: Option<(Breaches, Vec<Residual>)>,
    /// Descents spent.
    pub descents: u64,
}

/// What can be bought of each traded factor, in their order. A group is bought as one: at its members'
/// common cost, or at the sum of the costs of the different parameters in it.
///
/// # Errors
/// If a group joins grades that differ.
pub fn purchases(study: &Study, factors: &[Factor]) -> Result<Vec<Purchase>> {
    let of = |factor: &Factor| -> Result<Purchase> {
        let mut costs: Vec<(crate::physics::parameters::Parameter, &TighteningCost)> = Vec::new();
        for &j in &factor.columns {
            let member = (study.inputs[j].target.parameter, &study.inputs[j].cost);
            if !costs.contains(&member) {
                costs.push(member);
            }
        }
        if costs.iter().any(|(_, cost)| **cost == TighteningCost::None) {
            return Ok(Purchase::Nothing);
        }
        let mut sum = 0.0;
        for (_, cost) in &costs {
            match cost {
                TighteningCost::PerHalving(cost) => sum += cost,
                TighteningCost::Grades(grades) if costs.iter().all(|(_, other)| other == cost) => {
                    return Ok(Purchase::Grades(
                        grades.iter().map(|grade| (grade.spread, grade.cost)).collect(),
                    ));
                }
                _ => {
                    return Err(Error::argument(format!(
                        "the inputs of the group {} are tightened together: give all of them the same grades, \
                         or each a cost per halving",
                        factor.name
                    )));
                }
            }
        }
        Ok(Purchase::PerHalving(sum))
    };
    factors.iter().map(of).collect()
}

/// Finds and confirms a plan. `None` if `progress` asks for a stop.
///
/// # Errors
/// If there is no target and no requirement, no limit, or nothing is uncertain.
pub fn tighten(
    study: &Study,
    target: Option<f64>,
    progress: &Progress,
) -> Result<Option<Tightening>> {
    if study.limits.is_empty() {
        return Err(Error::argument(
            "the study states no limit, so there is nothing to tighten for",
        ));
    }
    let of_requirement = || study.requirement.map(|requirement| 1.0 - requirement.reliability);
    let target = target.or(study.tighten.target).or_else(of_requirement).ok_or_else(|| {
        Error::argument(
            "the study states no requirement and no [tighten] target: name one with --target",
        )
    })?;
    if !(target > 0.0 && target < 1.0) {
        return Err(Error::argument(format!(
            "a target probability lies strictly between 0 and 1, not {target}"
        )));
    }
    let confidence =
        study.requirement.map_or(USUAL_CONFIDENCE, |requirement| requirement.confidence);
    let factors = trade_factors(study);
    let purchases = purchases(study, &factors)?;
    let design: Vec<FreeValue> = study
        .tighten
        .design
        .iter()
        .map(|range| FreeValue {
            lower: range.lower,
            upper: range.upper,
            present: study.design.at(range.target),
        })
        .collect();
    let rows = study.tighten.samples;
    let sample = CommonSample::independent(study, 0..rows, Purpose::Design)?;
    let confirming =
        (CONFIRMING_BREACHES / target).clamp(CONFIRMATION, MOST_CONFIRMATION).round() as u64;
    let shared_risk = (1.0 - confidence) / ATTEMPTS as f64;
    let requirement = Requirement::new(1.0 - target, 1.0 - shared_risk)?;
    // The search's plan is the luckiest of many; two standard errors of its own sample and of the
    // confirming one are kept in hand.
    let error = |samples: u64| (target * (1.0 - target) / samples as f64).sqrt();
    let mut aim = (target - 2.0 * error(rows) - 2.0 * error(confirming)).max(0.25 * target);
    let before = progress.done();
    let base = sample.base(progress)?;
    let mut attempt = 0;
    loop {
        let problem = Problem { purchases: purchases.clone(), design: design.clone(), aim };
        let mut evaluate = |spreads: &[f64], design: &[f64]| -> Result<f64> {
            if progress.stopping() {
                return Err(Error::argument(STOPPED));
            }
            let change = change(study, &factors, spreads, design)?;
            Ok(sample.changed(&change, progress)?.worst_share())
        };
        let mut search = match cheapest(&problem, &mut evaluate) {
            Err(_) if progress.stopping() => return Ok(None),
            found => found?,
        };
        let mut settings = 0;
        let proof = match &search.plan {
            None => None,
            Some(plan) => {
                let in_hand = (&plan.spreads[..], &plan.design[..]);
                let mut refutation = Refutation::new(&sample, &factors, in_hand, aim, progress)?;
                settings = refutation.settings();
                let begun = progress.done();
                Some(prove(&problem.purchases, plan.cost, |spreads| {
                    if progress.stopping() || progress.done() - begun > MOST_DESCENTS {
                        return Ok(None);
                    }
                    Ok(Some(refutation.reached(spreads, progress)?))
                })?)
            }
        };
        if progress.stopping() {
            return Ok(None);
        }
        if let Some(((spreads, _), design)) = proof.as_ref().and_then(|proof| proof.found.clone()) {
            let mut evaluate = |spreads: &[f64], design: &[f64]| -> Result<f64> {
                let change = change(study, &factors, spreads, design)?;
                Ok(sample.changed(&change, progress)?.worst_share())
            };
            let (plan, evaluations) = trimmed(&problem, &mut evaluate, spreads, design)?;
            search.evaluations += evaluations;
            search.steps.push(plan.clone());
            search.plan = Some(plan);
        }
        let plan = search.plan.as_ref().unwrap_or(&search.everything).clone();
        let first = attempt * confirming;
        let again =
            CommonSample::independent(study, first..first + confirming, Purpose::Confirmation)?;
        let change = change(study, &factors, &plan.spreads, &plan.design)?;
        let breaches = again.changed(&change, progress)?;
        let demonstration = requirement.verdict(&breaches.count(Event::Any))?;
        attempt += 1;
        let missed = demonstration.verdict != Verdict::Met;
        if missed && search.plan.is_some() && attempt < ATTEMPTS {
            // As much lower as the confirming run came out too high.
            let bound = demonstration.upper_bound.interval().map_or(1.0, |i| i.upper);
            aim *= 0.95 * target / bound;
            continue;
        }
        let residual = match missed {
            true => Some(residual(study, &sample, &factors, &search.everything, progress)?),
            false => None,
        };
        return Ok(Some(Tightening {
            target,
            confidence,
            factors,
            purchases,
            samples: rows,
            aim,
            search,
            proof,
            settings,
            base,
            confirmation: Confirmation { plan, breaches, demonstration },
            attempts: attempt,
            residual,
            descents: progress.done() - before,
        }));
    }
}

const STOPPED: &str = "stopped";

/// The change that an allocation makes to a study.
///
/// # Errors
/// If a law cannot be stretched so.
pub fn change(
    study: &Study,
    factors: &[Factor],
    spreads: &[f64],
    design: &[f64],
) -> Result<Change> {
    let mut change = Change::default();
    for (factor, &spread) in factors.iter().zip(spreads) {
        if spread != 1.0 {
            change = change.and_spread(study, &factor.columns, spread)?;
        }
    }
    for (range, &value) in study.tighten.design.iter().zip(design) {
        change = change.and_design(range.target, value);
    }
    Ok(change)
}

fn residual(
    study: &Study,
    sample: &CommonSample<'_>,
    factors: &[Factor],
    everything: &Allocation,
    progress: &Progress,
) -> Result<(Breaches, Vec<Residual>)> {
    let at = |spreads: &[f64]| -> Result<Breaches> {
        sample.changed(&change(study, factors, spreads, &everything.design)?, progress)
    };
    let mut residuals = Vec::new();
    for factor in 0..factors.len() {
        let mut spreads = everything.spreads.clone();
        spreads[factor] = 0.0;
        residuals.push(Residual { factor, without: at(&spreads)? });
    }
    Ok((at(&everything.spreads)?, residuals))
}
