//! The plan that meets a target, or why none does.

use super::ReproductionFinding;
use super::known::GoAnswer;
use super::this_brake;
use super::trade::proportion;
use crate::campaign::common_numbers::Event;
use crate::campaign::tighten::Tightening;
use crate::error::Result;
use crate::numerics::interval::Estimate;
use crate::reliability::allocation::Allocation;
use crate::reliability::cheaper_plans::Proof;
use crate::reliability::demonstration::{Demonstration, Verdict};
use crate::study::Study;
use crate::uncertainty::Law;
use serde::Serialize;

/// What `reeldown tighten` found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TightenFinding {
    /// Layout of this tree.
    pub format: u32,
    /// The study's title.
    pub title: String,
    /// Largest acceptable P(any breach).
    pub target: f64,
    /// Confidence with which it is to be demonstrated.
    pub confidence: f64,
    /// `go`: the plan is demonstrated; `no_go`: it is demonstrated that none exists; `undecided`.
    pub answer: GoAnswer,
    /// The answer in a sentence or two.
    pub statement: String,
    /// P(any breach) as things are, on the search's sample.
    pub present: Estimate,
    /// The best design values alone, and P(any breach) with nothing bought.
    pub design_alone: PlanFinding,
    /// The plan; without one that reaches the target, everything that can be bought.
    pub plan: PlanFinding,
    /// The way there: what each purchase costs in all and brings.
    pub steps: Vec<PlanFinding>,
    /// Breaches of each limit in the confirming run.
    pub confirmed_limits: Vec<(String, Estimate)>,
    /// What the confirming run demonstrates; its confidence allows for every attempt.
    pub demonstration: Demonstration,
    /// Confirming runs made.
    pub attempts: u64,
    /// With everything bought: what still breaches.
    pub residual: Option<ResidualFinding>,
    /// Samples of the search, and descents in all.
    pub samples: u64,
    /// See `samples`.
    pub descents: u64,
    /// Plans evaluated by the last search.
    pub evaluations: u64,
    /// Whether the plan is the cheapest; `None` without a plan.
    pub proof: Option<ProofFinding>,
    /// What it takes to have the same numbers again.
    pub reproduction: ReproductionFinding,
}

/// How sure it is that no cheaper plan would do.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ProofFinding {
    /// Plans that cost less and were refuted: half halvings and grades.
    pub refuted: usize,
    /// Settings of the design values at which each was.
    pub settings: usize,
    /// No plan of half halvings and grades that costs less than this reaches the aim.
    pub none_below: f64,
    /// Whether every cheaper plan was looked at.
    pub complete: bool,
    /// The aim on the search's sample: below the target by what a confirming run may come out too high.
    pub aim: f64,
    /// All that in a sentence.
    pub statement: String,
}

/// Tightenings and design values with what they cost and give.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlanFinding {
    /// Cost in all.
    pub cost: f64,
    /// P(any breach) on the search's sample; of a plan the luckiest of many, so without an interval.
    pub probability: f64,
    /// What is bought.
    pub purchases: Vec<PurchaseFinding>,
    /// Design values.
    pub design: Vec<DesignChange>,
}

/// One tightening of a plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PurchaseFinding {
    /// Path of the input, or name of the group.
    pub factor: String,
    /// How many inputs it is.
    pub inputs: usize,
    /// What the spread is multiplied by.
    pub spread_factor: f64,
    /// Standard deviation before and after, SI; of a lognormal law of the logarithm.
    pub spread: (f64, f64),
    /// Whether `spread` is the logarithm's.
    pub relative: bool,
    /// Its cost.
    pub cost: f64,
}

/// One design value of a plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DesignChange {
    /// Its path.
    pub path: String,
    /// Its value now, SI.
    pub before: f64,
    /// Its value in the plan, SI.
    pub after: f64,
}

/// What remains if everything is bought.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResidualFinding {
    /// P(any breach) with everything bought, on the search's sample.
    pub probability: Estimate,
    /// The probability of each limit's breach.
    pub limits: Vec<(String, Estimate)>,
    /// P(any breach) if one factor more had no spread at all, the most telling first.
    pub causes: Vec<(String, Estimate)>,
}

/// Tells what a search came to.
///
/// # Errors
/// If a statistic refuses the numbers.
pub fn tighten(study: &Study, found: &Tightening, command: String) -> Result<TightenFinding> {
    let plan = |allocation: &Allocation| plan_of(study, found, allocation);
    let demonstration = &found.confirmation.demonstration;
    let by_limit = |breaches: &crate::campaign::common_numbers::Breaches| {
        let limits = study.limits.iter().enumerate();
        limits
            .map(|(i, limit)| Ok((limit.name(), proportion(&breaches.count(Event::Limit(i)))?)))
            .collect::<Result<Vec<_>>>()
    };
    let residual = match &found.residual {
        None => None,
        Some((breaches, residuals)) => {
            let mut causes = residuals
                .iter()
                .map(|residual| {
                    let name = found.factors[residual.factor].name.clone();
                    Ok((name, proportion(&residual.without.count(Event::Any))?))
                })
                .collect::<Result<Vec<(String, Estimate)>>>()?;
            causes.sort_by(|a, b| {
                let value = |e: &Estimate| e.value.unwrap_or(1.0);
                value(&a.1).total_cmp(&value(&b.1))
            });
            Some(ResidualFinding {
                probability: proportion(&breaches.count(Event::Any))?,
                limits: by_limit(breaches)?,
                causes,
            })
        }
    };
    let answer = match (&found.search.plan, demonstration.verdict) {
        (_, Verdict::Met) => GoAnswer::Go,
        (None, Verdict::NotMet) => GoAnswer::NoGo,
        _ => GoAnswer::Undecided,
    };
    // The search starts with the present design, and moves the design before it buys anything.
    let alone = found.search.steps.iter().take_while(|step| step.cost == 0.0).last();
    let alone = alone.unwrap_or(&found.confirmation.plan);
    let mut finding = TightenFinding {
        format: 1,
        title: study.title.clone(),
        target: found.target,
        confidence: found.confidence,
        answer,
        statement: String::new(),
        present: proportion(&found.base.count(Event::Any))?,
        design_alone: plan(alone),
        plan: plan(&found.confirmation.plan),
        steps: found.search.steps.iter().map(plan).collect(),
        confirmed_limits: by_limit(&found.confirmation.breaches)?,
        demonstration: demonstration.clone(),
        attempts: found.attempts,
        residual,
        samples: found.samples,
        descents: found.descents,
        evaluations: found.search.evaluations,
        proof: found.proof.as_ref().map(|proof| proof_of(found, proof)),
        reproduction: ReproductionFinding {
            version: env!("CARGO_PKG_VERSION"),
            seed: study.sampling.seed,
            study_digest: study.digest(),
            files: study.file_digests(),
            command,
        },
    };
    finding.statement = statement(&finding, this_brake::has_epistemic_inputs(study));
    Ok(finding)
}

fn proof_of(found: &Tightening, proof: &Proof) -> ProofFinding {
    let cost = found.confirmation.plan.cost;
    let percent = super::percent::percent;
    let refuted = match (proof.refuted, found.settings) {
        (0, _) => "No plan costs less".to_owned(),
        (plans, 1) => format!("{plans} plans that cost less were refuted one by one"),
        (plans, settings) => format!(
            "{plans} plans that cost less were refuted one by one, each at {settings} settings of the design values"
        ),
    };
    let on = format!(
        "{refuted}, all by more breaches on the search's {} samples than {} (the target, less what a confirming run may come \
         out higher)",
        found.samples,
        percent(found.aim)
    );
    let statement = match proof.complete {
        true if proof.none_below >= cost - 1e-9 => format!(
            "Exhaustive search: no plan on the search grid (spread × 2^(−k/2), listed grades) that costs less than {cost:.2} \
             meets the target; spreads between grid points were refined, not searched. {on}."
        ),
        true => format!(
            "Exhaustive search: no plan on the search grid (spread × 2^(−k/2), listed grades) that costs less than {:.2} \
             meets the target; spreads between grid points were refined, not searched. {on}.",
            proof.none_below
        ),
        false => format!(
            "There are too many cheaper plans to refute them all: none that costs less than {:.2} meets the target; between that \
             and {cost:.2} the plan is not proven cheapest (greedy search with exchanges). {on}.",
            proof.none_below
        ),
    };
    ProofFinding {
        refuted: proof.refuted,
        settings: found.settings,
        none_below: proof.none_below,
        complete: proof.complete,
        aim: found.aim,
        statement,
    }
}

fn plan_of(study: &Study, found: &Tightening, allocation: &Allocation) -> PlanFinding {
    let bought = found.factors.iter().zip(&found.purchases).zip(&allocation.spreads);
    let purchases = bought
        .filter(|(_, spread)| **spread < 1.0)
        .filter_map(|((factor, purchase), &spread)| {
            let law = study.inputs[*factor.columns.first()?].marginal.law();
            Some(PurchaseFinding {
                factor: factor.name.clone(),
                inputs: factor.columns.len(),
                spread_factor: spread,
                spread: (law.spread(), law.spread() * spread),
                relative: matches!(law, Law::Lognormal { .. }),
                cost: purchase.cost(spread),
            })
        })
        .collect();
    PlanFinding {
        cost: allocation.cost,
        probability: allocation.probability,
        purchases,
        design: study
            .tighten
            .design
            .iter()
            .zip(&allocation.design)
            .map(|(range, &after)| DesignChange {
                path: range.target.path(),
                before: study.design.at(range.target),
                after,
            })
            .collect(),
    }
}

fn statement(finding: &TightenFinding, epistemic: bool) -> String {
    let percent = super::percent::percent;
    let demonstration = &finding.demonstration;
    let counts = &demonstration.counts;
    let target = percent(finding.target);
    let confidence = percent(finding.confidence);
    let seen =
        format!("{} of {} independent descents breached a limit", counts.breaches, counts.samples);
    let upper = demonstration.upper_bound.interval().map_or("1".to_owned(), |i| percent(i.upper));
    let lower = demonstration.lower_bound.interval().map_or("0".to_owned(), |i| percent(i.lower));
    let attempts = match finding.attempts {
        1 => String::new(),
        several => format!(" (confirming run {several}; the confidence allows for every attempt)"),
    };
    // Each of those descents has a brake of its own.
    let (mean, of_one) = match epistemic {
        true => (
            " on average over all possible brakes",
            " A single brake of this plan may still exceed the target: with its values in the study, `reeldown run` states the \
             probability that this brake meets it.",
        ),
        false => ("", ""),
    };
    match finding.answer {
        GoAnswer::Go => format!(
            "A plan of cost {:.2} meets the target{mean}: P(any breach) ≤ {target} is demonstrated at {confidence} \
             confidence. {seen}{attempts}: at most {upper}.{of_one}",
            finding.plan.cost
        ),
        GoAnswer::NoGo => {
            let causes = finding.residual.as_ref().map(residual_words).unwrap_or_default();
            format!(
                "The target {target} cannot be met: with everything bought that can be, and the design at its best, \
                 P(any breach) is at least {lower} at {confidence} confidence ({seen}).{causes}"
            )
        }
        _ => format!(
            "Undecided: the best plan found is not demonstrated to keep P(any breach) ≤ {target} at {confidence} \
             confidence: {seen}{attempts}, so at most {upper} and at least {lower}."
        ),
    }
}

fn residual_words(residual: &ResidualFinding) -> String {
    let percent = super::percent::percent;
    let worst = residual.limits.iter().max_by(|a, b| {
        let value = |e: &Estimate| e.value.unwrap_or(0.0);
        value(&a.1).total_cmp(&value(&b.1))
    });
    let limit = worst.map_or(String::new(), |(name, p)| {
        format!(" Most often still breached: {name} ({}).", p.value.map_or("–".into(), percent))
    });
    let cause = residual.causes.first().map_or(String::new(), |(name, p)| {
        format!(
            " The cause that stands in the way most: {name}; without its spread P would be {}.",
            p.value.map_or("–".into(), percent)
        )
    });
    format!("{limit}{cause}")
}
