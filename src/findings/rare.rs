//! Rare breaches: what several methods say, whether they agree, and the most likely way to fail.

use super::demonstration::percent;
use crate::campaign::{FEW_BREACHES, RareEvent};
use crate::numerics::special::normal;
use crate::reliability::agreement::Agreement;
use crate::reliability::estimate::{Estimate, Method};
use crate::reliability::event::Event;
use crate::study::{LimitKind, Study};
use crate::units::engineering;
use serde::Serialize;

/// Inputs named in the story of a design point.
const TOLD: usize = 5;

/// One rare event.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RareFinding {
    /// Names of the limits concerned.
    pub limits: Vec<String>,
    /// The event in words.
    pub title: String,
    /// One estimate a method, the samples' own first.
    pub estimates: Vec<Estimate>,
    /// Whether they agree.
    pub agreement: Agreement,
    /// The agreement in words.
    pub agreement_statement: String,
    /// The most likely way to breach.
    pub design_point: Option<DesignPointFinding>,
}

/// The most likely way to breach.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DesignPointFinding {
    /// Distance from the origin in standard deviations, β.
    pub reliability_index: f64,
    /// Every input at the point, the most important first.
    pub inputs: Vec<DesignPointInput>,
    /// The point in words.
    pub statement: String,
}

/// One input at a design point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DesignPointInput {
    /// Dotted path.
    pub path: String,
    /// Value at the point, SI.
    pub value: f64,
    /// Median of its law, SI.
    pub median: f64,
    /// Probability of a value below it: below ½ the input is low, above it is high.
    pub percentile: f64,
    /// Importance factor α²: its share of the point's distance; of inputs drawn together the first has
    /// the share of all.
    pub importance: f64,
}

/// The rare events of a study.
pub(super) fn rare(study: &Study, events: &[RareEvent]) -> Vec<RareFinding> {
    events.iter().map(|event| finding(study, event)).collect()
}

fn finding(study: &Study, rare: &RareEvent) -> RareFinding {
    let members: Vec<usize> = match rare.event {
        Event::Limit(i) => vec![i],
        Event::Both(i, j) => vec![i, j],
        Event::Any | Event::All => (0..study.limits.len()).collect(),
    };
    let title = match (rare.event, members.first().and_then(|&i| study.limits.get(i))) {
        (Event::Limit(_), Some(limit)) => {
            let side = if limit.kind == LimitKind::Max { "above" } else { "below" };
            format!("{} {side} {}", limit.outcome.title(), limit.text)
        }
        (Event::Any, _) => "any limit".to_owned(),
        _ => "several limits together".to_owned(),
    };
    RareFinding {
        limits: members.iter().filter_map(|&i| Some(study.limits.get(i)?.name())).collect(),
        title,
        estimates: rare.estimates.clone(),
        agreement_statement: agreement_statement(&rare.agreement),
        agreement: rare.agreement.clone(),
        design_point: rare.design_point.as_ref().map(|(point, draw)| {
            let mut inputs: Vec<DesignPointInput> = study
                .inputs
                .iter()
                .enumerate()
                .map(|(k, input)| DesignPointInput {
                    path: input.target.path(),
                    value: draw[k],
                    median: input.marginal.median(),
                    percentile: match study.joint.sample_of(k) {
                        Some(_) => input.marginal.cdf(draw[k]),
                        None => normal::cdf(point.point[k]),
                    },
                    importance: point.importance[k],
                })
                .collect();
            inputs.sort_by(|a, b| b.importance.total_cmp(&a.importance));
            let statement = story(study, &inputs, point.reliability_index);
            DesignPointFinding { reliability_index: point.reliability_index, inputs, statement }
        }),
    }
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

fn story(study: &Study, inputs: &[DesignPointInput], distance: f64) -> String {
    let parts: Vec<String> = inputs
        .iter()
        .take(TOLD)
        .filter(|input| input.importance >= 0.02)
        .map(|input| {
            let quantity = study
                .inputs
                .iter()
                .find(|known| known.target.path() == input.path)
                .map(|known| known.target.parameter.info().quantity);
            let shown = quantity.map_or(input.value.to_string(), |q| engineering(input.value, q));
            let side = if input.percentile < 0.5 { "low" } else { "high" };
            let together = study.drawn_together.iter().find(|together| {
                together
                    .inputs
                    .first()
                    .is_some_and(|&j| study.inputs[j].target.path() == input.path)
            });
            let others = together.map_or(String::new(), |together| {
                format!(" with the rest of its row of the {}", together.name)
            });
            format!(
                "{} {side} at {shown}{others} ({} of the distance)",
                input.path,
                percent(input.importance)
            )
        })
        .collect();
    format!(
        "The most likely way to breach lies {distance:.2} standard deviations from the medians: {}.",
        parts.join("; ")
    )
}
