//! Rare breaches: what several methods say, whether they agree, and the most likely way to fail.

use super::story::story;
use crate::campaign::{FEW_BREACHES, MostLikelyBreach, RareEvent};
use crate::descent::{Outcome, OutcomeQuantity};
use crate::numerics::special::normal;
use crate::reliability::agreement::Agreement;
use crate::reliability::estimate::{Estimate, Method};
use crate::reliability::event::Event;
use crate::study::{LimitKind, Study};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// One rare event.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RareFinding {
    /// Names of the limits concerned.
    pub limits: Vec<String>,
    /// The event in words.
    pub title: String,
    /// One estimate a method, the samples' own first.
    pub estimates: Vec<Estimate>,
    /// Which of them have no interval, and why, in sentences.
    pub without_interval: Vec<String>,
    /// Whether they agree.
    pub agreement: Agreement,
    /// The agreement in words.
    pub agreement_statement: String,
    /// The most likely way to breach.
    pub design_point: Option<DesignPointFinding>,
}

/// The most likely way to breach.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DesignPointFinding {
    /// Distance from the origin in standard deviations, β; negative where the medians breach.
    pub reliability_index: f64,
    /// Whether the medians breach: the point is then the nearest that does not.
    pub medians_breach: bool,
    /// Every input at the point, the most important first.
    pub inputs: Vec<DesignPointInput>,
    /// Outcomes of the flight at the point by column name, SI; empty if it could not be computed.
    pub flight: BTreeMap<String, f64>,
    /// The point in words.
    pub statement: String,
}

/// One input at a design point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DesignPointInput {
    /// Dotted path.
    pub path: String,
    /// Value at the point, SI.
    pub value: f64,
    /// Median of its law, SI.
    pub median: f64,
    /// Probability of a value below it: below ½ the input is low, above it is high.
    pub percentile: f64,
    /// Probability of a value as far or farther out on its side.
    pub beyond: f64,
    /// Importance factor α²: its share of the point's distance; of inputs drawn together the first has
    /// the share of all.
    pub importance: f64,
}

/// The rare events of a study, told beside its nominal descent.
pub fn rare_findings(
    study: &Study,
    events: &[RareEvent],
    nominal: Option<&Outcome>,
) -> Vec<RareFinding> {
    events.iter().map(|event| finding(study, event, nominal)).collect()
}

fn finding(study: &Study, rare: &RareEvent, nominal: Option<&Outcome>) -> RareFinding {
    let members: Vec<usize> = match rare.event {
        Event::Limit(i) => vec![i],
        Event::Both(i, j) => vec![i, j],
        Event::Any | Event::All => (0..study.limits.len()).collect(),
    };
    let of_limit = |&i: &usize| {
        let limit = study.limits.get(i)?;
        let side = if limit.kind == LimitKind::Max { "above" } else { "below" };
        Some(format!("{} {side} {}", limit.outcome.title(), limit.text))
    };
    let title = match rare.event {
        Event::Any => "any limit".to_owned(),
        _ => members.iter().filter_map(of_limit).collect::<Vec<String>>().join(" and "),
    };
    RareFinding {
        limits: members.iter().filter_map(|&i| Some(study.limits.get(i)?.name())).collect(),
        title,
        without_interval: without_interval(&rare.estimates),
        estimates: rare.estimates.clone(),
        agreement_statement: agreement_statement(&rare.agreement),
        agreement: rare.agreement.clone(),
        design_point: rare.most_likely.as_ref().map(|breach| design_point(study, breach, nominal)),
    }
}

fn design_point(
    study: &Study,
    breach: &MostLikelyBreach,
    nominal: Option<&Outcome>,
) -> DesignPointFinding {
    let MostLikelyBreach { point, medians_breach, draw, flight } = breach;
    let mut inputs: Vec<DesignPointInput> = study
        .inputs
        .iter()
        .enumerate()
        .map(|(k, input)| DesignPointInput {
            path: input.target.path(),
            value: draw[k],
            median: input.marginal.median(),
            percentile: normal::cdf(point.point[k]),
            beyond: normal::survival(point.point[k].abs()),
            importance: point.importance[k],
        })
        .collect();
    inputs.sort_by(|a, b| b.importance.total_cmp(&a.importance));
    let flight = flight.as_ref().ok();
    let outcomes = flight.map(|outcome| {
        OutcomeQuantity::ALL.into_iter().map(|of| (of.column(), outcome.get(of))).collect()
    });
    DesignPointFinding {
        reliability_index: point.reliability_index,
        medians_breach: *medians_breach,
        statement: story(study, &inputs, point.reliability_index, *medians_breach, flight, nominal),
        flight: outcomes.unwrap_or_default(),
        inputs,
    }
}

/// One sentence a reason, in the order of the estimates.
fn without_interval(estimates: &[Estimate]) -> Vec<String> {
    let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
    for estimate in estimates {
        let Some(why) = estimate.interval.why_none() else { continue };
        match reasons.iter_mut().find(|(known, _)| *known == why) {
            Some((_, methods)) => methods.push(estimate.method.name()),
            None => reasons.push((why, vec![estimate.method.name()])),
        }
    }
    let sentence = |(why, methods): (&str, Vec<&str>)| {
        format!("No interval from {}: {why}.", methods.join(", "))
    };
    reasons.into_iter().map(sentence).collect()
}

fn agreement_statement(agreement: &Agreement) -> String {
    let name = |method: Method| method.name();
    match agreement.agrees {
        Some(true) => "The methods agree within their errors.".to_owned(),
        Some(false) => {
            let pairs: Vec<String> = agreement
                .comparisons
                .iter()
                .filter(|pair| !pair.agree)
                .map(|pair| format!("{} and {}", name(pair.methods.0), name(pair.methods.1)))
                .collect();
            format!(
                "AGREEMENT CHECK FAILED: {} differ by more than their errors allow; do not sign any of \
                 these numbers before it is known why.",
                pairs.join(", ")
            )
        }
        None => format!(
            "No two methods could be compared (fewer than {FEW_BREACHES} breaches among the samples, and \
             fewer than two methods with an interval)."
        ),
    }
}
