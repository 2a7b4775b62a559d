//! What buying down a tolerance is worth: the best tightenings, P(any breach) against every spread and
//! mean, its derivatives, and the best value of a design variable.

use super::CONFIDENCE;
use super::derivatives::{DerivativeFinding, derivatives};
use super::design_value::{DesignValueFinding, design_value};
use crate::campaign::common_numbers::{Breaches, Event};
use crate::campaign::trade::{Curve, HEADLINES, Halved, Parameter, TradeOutcomes};
use crate::campaign::{Found, in_parallel};
use crate::error::Result;
use crate::numerics::interval::{Earned, Estimate};
use crate::numerics::words::{self, Word};
use crate::reliability::paired::{PairedCounts, replicated_difference};
use crate::reliability::probability::Proportion;
use crate::reliability::replicates::from_replicate_counts;
use crate::sensitivity::reweighting::{Reweighted, reweighted};
use crate::study::Study;
use serde::{Deserialize, Serialize};

/// The trade of tolerances of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TradeFinding {
    /// Why there is none.
    pub none: Option<String>,
    /// Samples behind each point of a curve.
    pub samples: u64,
    /// P(any breach) on them, every law as the card has it.
    pub base: Option<Estimate>,
    /// The tightenings that lower P(any breach) most, the best first.
    pub best: Vec<TighteningFinding>,
    /// The same where the design values are at their best.
    pub best_at_design: Vec<TighteningFinding>,
    /// The swept setting of each design variable at which those were computed: the one with the fewest breaches, SI.
    pub at_design: Vec<f64>,
    /// The design values that may move.
    pub design: Vec<DesignValueFinding>,
    /// P(any breach) against the spread and the mean of every factor.
    pub curves: Vec<TradeCurve>,
    /// Samples behind the score function's derivatives.
    pub score_samples: u64,
    /// Derivatives of every breach probability.
    pub derivatives: Vec<DerivativeFinding>,
}

/// One tightening: the spread of a factor halved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TighteningFinding {
    /// Path of the input, or name of the group.
    pub factor: String,
    /// How many inputs it is.
    pub inputs: usize,
    /// What the spread is multiplied by.
    pub spread_factor: f64,
    /// Samples behind the numbers.
    pub samples: u64,
    /// P(any breach) before.
    pub before: Estimate,
    /// P(any breach) after.
    pub after: Estimate,
    /// After less before, by common random numbers.
    pub difference: Estimate,
}

/// P(any breach) against one parameter of one factor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TradeCurve {
    /// Path of the input, or name of the group.
    pub factor: String,
    /// How many inputs it is.
    pub inputs: usize,
    /// `spread`: a factor of the card's; `mean`: a move of the mean, SI.
    #[serde(deserialize_with = "words::one")]
    pub parameter: Word,
    /// The settings in ascending order, the base among them.
    pub points: Vec<TradePoint>,
}

/// One point of a trade curve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TradePoint {
    /// Spread factor, or move of the mean, SI.
    pub setting: f64,
    /// P(any breach).
    pub probability: Estimate,
    /// P less its base, by common random numbers.
    pub difference: Estimate,
    /// The probability of each limit's breach, in the order of the limits.
    pub limits: Vec<Option<f64>>,
    /// The same probability by reweighting the base's samples, as a check.
    pub reweighted: Option<Reweighted>,
}

/// The trade of a study, or why there is none.
pub(crate) fn trade(study: &Study, outcomes: &Found<TradeOutcomes<'_>>) -> Result<TradeFinding> {
    let outcomes = match outcomes {
        Ok(outcomes) => outcomes,
        Err(why) => {
            return Ok(TradeFinding {
                none: Some(why.to_string()),
                samples: 0,
                base: None,
                best: Vec::new(),
                at_design: Vec::new(),
                best_at_design: Vec::new(),
                design: Vec::new(),
                curves: Vec::new(),
                score_samples: 0,
                derivatives: Vec::new(),
            });
        }
    };
    let paired = Paired { replicates: outcomes.replicates };
    let curves = in_parallel(&outcomes.curves, |curve| trade_curve(study, outcomes, paired, curve));
    let ranked = |base: &Breaches, halved: &[Halved]| -> Result<Vec<TighteningFinding>> {
        let mut found = halved
            .iter()
            .map(|halved| {
                let factor = &outcomes.factors[halved.factor];
                Ok(TighteningFinding {
                    factor: factor.name.clone(),
                    inputs: factor.columns.len(),
                    spread_factor: 0.5,
                    samples: base.rows() as u64,
                    before: paired.probability(base, Event::Any)?,
                    after: paired.probability(&halved.breaches, Event::Any)?,
                    difference: paired.difference(base, &halved.breaches, Event::Any)?,
                })
            })
            .collect::<Result<Vec<_>>>()?;
        // By this sample's own word, and only what it shows to lower P.
        found.retain(|t| t.difference.interval.interval().is_some_and(|i| i.upper < 0.0));
        let gain = |t: &TighteningFinding| t.difference.value.unwrap_or(0.0);
        found.sort_by(|a, b| gain(a).total_cmp(&gain(b)));
        found.truncate(HEADLINES);
        Ok(found)
    };
    let design: Vec<DesignValueFinding> = outcomes
        .sweeps
        .iter()
        .map(|sweep| design_value(study, outcomes, paired, sweep))
        .collect::<Result<_>>()?;
    let (at_design, best_at_design) = match &outcomes.at_best {
        Some(at_best) if design.iter().all(|found| found.best.value.is_some()) => {
            (at_best.design.clone(), ranked(&at_best.base, &at_best.halved)?)
        }
        _ => (Vec::new(), Vec::new()),
    };
    Ok(TradeFinding {
        none: None,
        samples: outcomes.base.rows() as u64,
        base: Some(paired.probability(&outcomes.base, Event::Any)?),
        best: ranked(&outcomes.headline_base, &outcomes.halved)?,
        at_design,
        best_at_design,
        design,
        curves: curves.into_iter().collect::<Result<_>>()?,
        score_samples: outcomes.score_samples,
        derivatives: derivatives(study, outcomes, paired)?,
    })
}

/// Statistics of breaches at points that are independent, or belong to replicates in turn.
#[derive(Debug, Clone, Copy)]
pub(super) struct Paired {
    pub(super) replicates: usize,
}

impl Paired {
    pub(super) fn probability(self, breaches: &Breaches, event: Event) -> Result<Estimate> {
        if self.replicates <= 1 {
            return proportion(&breaches.count(event));
        }
        let counts: Vec<Proportion> = (0..self.replicates)
            .map(|r| breaches.counts(event, (r..breaches.rows()).step_by(self.replicates)))
            .collect();
        Ok(from_replicate_counts(&counts, CONFIDENCE)?.probability)
    }

    pub(super) fn difference(
        self,
        base: &Breaches,
        changed: &Breaches,
        event: Event,
    ) -> Result<Estimate> {
        let replicates = self.replicates.max(1);
        let counts: Vec<PairedCounts> = (0..replicates)
            .map(|r| changed.against(base, event, (r..base.rows()).step_by(replicates)))
            .collect();
        replicated_difference(&counts, CONFIDENCE)
    }
}

/// A proportion with its exact interval.
pub(crate) fn proportion(counts: &Proportion) -> Result<Estimate> {
    let value = counts.estimate();
    let computed = (counts.samples - counts.faults) as f64;
    let standard_error = value.map(|p| (p * (1.0 - p) / computed).sqrt());
    Ok(Estimate { value, standard_error, interval: counts.interval(CONFIDENCE)? })
}

pub(super) fn limit_shares(study: &Study, breaches: &Breaches) -> Vec<Option<f64>> {
    (0..study.limits.len()).map(|i| breaches.count(Event::Limit(i)).estimate()).collect()
}

fn trade_curve(
    study: &Study,
    outcomes: &TradeOutcomes<'_>,
    paired: Paired,
    curve: &Curve,
) -> Result<TradeCurve> {
    let factor = &outcomes.factors[curve.factor];
    let indicator = outcomes.base.indicator(Event::Any);
    let base_setting = match curve.parameter {
        Parameter::Spread => 1.0,
        Parameter::Mean => 0.0,
    };
    let mut points = vec![TradePoint {
        setting: base_setting,
        probability: paired.probability(&outcomes.base, Event::Any)?,
        difference: Estimate {
            value: Some(0.0),
            standard_error: None,
            interval: Earned::none("this is the base"),
        },
        limits: limit_shares(study, &outcomes.base),
        reweighted: None,
    }];
    for setting in &curve.settings {
        let drawn_together = factor.columns.iter().any(|&j| study.joint.sample_of(j).is_some());
        let cross_check = study.joint.is_independent() && !drawn_together && setting.value != 0.0;
        points.push(TradePoint {
            setting: setting.value,
            probability: paired.probability(&setting.breaches, Event::Any)?,
            difference: paired.difference(&outcomes.base, &setting.breaches, Event::Any)?,
            limits: limit_shares(study, &setting.breaches),
            reweighted: cross_check
                .then(|| check(study, outcomes, &setting.marginals, &indicator))
                .transpose()?,
        });
    }
    points.sort_by(|a, b| a.setting.total_cmp(&b.setting));
    Ok(TradeCurve {
        factor: factor.name.clone(),
        inputs: factor.columns.len(),
        parameter: name_of(curve.parameter),
        points,
    })
}

pub(super) fn name_of(parameter: Parameter) -> &'static str {
    match parameter {
        Parameter::Mean => "mean",
        Parameter::Spread => "spread",
    }
}

/// The probability under changed laws by reweighting the base's samples.
fn check(
    study: &Study,
    outcomes: &TradeOutcomes<'_>,
    marginals: &[(usize, crate::uncertainty::Marginal)],
    indicator: &[f64],
) -> Result<Reweighted> {
    let inputs = outcomes.sample.inputs();
    let mut log_ratios = vec![0.0; inputs.rows()];
    let mut covered = true;
    for (j, changed) in marginals {
        let own = &study.inputs[*j].marginal;
        let (from, to) = own.support();
        let (changed_from, changed_to) = changed.support();
        covered &= from <= changed_from && changed_to <= to;
        for (sum, &x) in log_ratios.iter_mut().zip(inputs.column(*j)) {
            *sum += changed.ln_density(x) - own.ln_density(x);
        }
    }
    let mut check = reweighted(indicator, &log_ratios, covered, CONFIDENCE)?;
    if outcomes.replicates > 1 {
        check.probability.standard_error = None;
        check.probability.interval = Earned::none("the points are not independent");
    }
    Ok(check)
}
