//! The findings in a reader's words and units: what every textual rendering is laid out from.

use super::calibrated_view::{Calibrated, calibrated};
use super::driver_view::{Drivers, drivers, ranked};
use super::epistemic_view::{Epistemic, epistemic};
use super::exact_view::{Exact, exact};
use super::figures_of_speech::{
    bare, count, maybe, probability, probability_interval, quantity_of, upper_end, value,
    value_interval,
};
use super::known_view::{Known, known};
use super::measures_view::{Measures, measures};
use super::model_form_view::{ModelFormView, model_form};
use super::trade_view::{Shares, Trade, shares, trade};
use crate::analysis::Findings;
use crate::descent::OutcomeQuantity;
use crate::findings::{
    CONFIDENCE, Decision, EventKind, LimitFinding, MarginFinding, Output, RareFinding, VerdictWord,
};
use crate::study::NO_SOURCE;
use crate::units::number;
use serde::Serialize;

/// A report, ready to be laid out.
#[derive(Debug, Serialize)]
pub(super) struct View {
    pub title: String,
    pub verdict: Verdict,
    pub stopping: Option<String>,
    /// Confidence of the intervals of the probabilities.
    pub probability_label: String,
    pub interval_label: String,
    pub bound_label: String,
    pub probabilities: Vec<ProbabilityRow>,
    pub limits: Vec<LimitRow>,
    pub statements: Vec<String>,
    pub model_form: Option<ModelFormView>,
    pub demonstration: Option<Demonstration>,
    pub rare: Vec<Rare>,
    pub margins: Vec<Margin>,
    pub drivers: Drivers,
    pub shares: Shares,
    pub measures: Measures,
    pub trade: Trade,
    pub known: Known,
    pub epistemic: Epistemic,
    pub calibrated: Option<Calibrated>,
    pub nominal: String,
    pub outcomes: Vec<OutcomeRow>,
    pub exceptions: Vec<String>,
    pub inputs: Vec<InputRow>,
    pub correlations: Vec<CorrelationRow>,
    pub exact: Exact,
    pub method: Method,
    pub reproduction: Reproduction,
}

#[derive(Debug, Serialize)]
pub(super) struct Verdict {
    pub heading: &'static str,
    pub statement: String,
    pub other: Option<String>,
    pub sharpest: Option<String>,
}

#[derive(Debug, Serialize)]
pub(super) struct ProbabilityRow {
    pub title: String,
    pub pair: bool,
    pub counts: String,
    pub probability: String,
    pub interval: String,
    pub upper: String,
}

#[derive(Debug, Serialize)]
pub(super) struct LimitRow {
    pub limit: String,
    pub source: String,
}

#[derive(Debug, Serialize)]
pub(super) struct Demonstration {
    pub risks: String,
    pub allowed: Vec<(String, String)>,
}

#[derive(Debug, Serialize)]
pub(super) struct Rare {
    pub title: String,
    pub rows: Vec<RareRow>,
    /// Which of the rows has the smallest error.
    pub sharpest: Option<usize>,
    /// Which methods have no interval, and why; empty if all have one.
    pub without_interval: String,
    pub agreement: String,
    /// Whether methods differ by more than their errors allow.
    pub disagree: bool,
    pub story: Option<String>,
}

#[derive(Debug, Clone, Serialize)]
pub(super) struct RareRow {
    pub method: &'static str,
    pub probability: String,
    pub interval: String,
    pub relative_error: String,
    pub descents: String,
}

#[derive(Debug, Serialize)]
pub(super) struct Margin {
    pub title: String,
    pub rows: Vec<MarginRow>,
}

#[derive(Debug, Serialize)]
pub(super) struct MarginRow {
    pub share: String,
    pub margin: String,
    pub interval: String,
}

#[derive(Debug, Serialize)]
pub(super) struct OutcomeRow {
    pub title: &'static str,
    pub nominal: String,
    pub mean: String,
    pub sd: String,
    pub smallest: String,
    pub largest: String,
}

#[derive(Debug, Serialize)]
pub(super) struct InputRow {
    pub path: String,
    pub description: &'static str,
    pub law: String,
    pub inputs: usize,
    pub known: &'static str,
    pub nature: &'static str,
    pub source: String,
}

#[derive(Debug, Serialize)]
pub(super) struct CorrelationRow {
    pub inputs: String,
    pub stated: String,
    pub normal: String,
    pub source: String,
}

#[derive(Debug, Serialize)]
pub(super) struct Method {
    pub model: &'static str,
    pub design: String,
    pub tolerance: String,
    pub numerical: String,
    pub caveats: Vec<String>,
}

#[derive(Debug, Serialize)]
pub(super) struct Reproduction {
    pub command: String,
    pub version: &'static str,
    pub seed: u64,
    pub digest: String,
    pub files: Vec<(String, String)>,
}

/// The findings in words.
pub(super) fn view(findings: &Findings) -> View {
    let one_sided = findings.verdict.confidence.unwrap_or(CONFIDENCE);
    View {
        title: findings.title.clone(),
        verdict: verdict(findings),
        stopping: findings.stopping.as_ref().map(|stopping| stopping.statement.clone()),
        probability_label: probability(
            findings.stopping.as_ref().map_or(CONFIDENCE, |stopping| stopping.confidence),
        ),
        interval_label: probability(CONFIDENCE),
        bound_label: probability(one_sided),
        probabilities: findings.probabilities.iter().map(probability_row).collect(),
        limits: findings.limits.iter().map(limit_row).collect(),
        statements: findings
            .probabilities
            .iter()
            .filter(|p| p.kind != EventKind::Pair)
            .filter_map(|p| p.statement.as_ref().map(|text| format!("{}: {text}.", p.title)))
            .collect(),
        model_form: model_form(&findings.model_form),
        demonstration: demonstration(findings),
        rare: findings.rare.iter().map(rare).collect(),
        margins: findings.margins.iter().map(margin).collect(),
        drivers: drivers(findings),
        shares: shares(&findings.shapley),
        measures: measures(&findings.measures),
        trade: trade(&findings.trade),
        known: known(&findings.known),
        epistemic: epistemic(&findings.epistemic),
        calibrated: findings.calibrated.as_ref().map(calibrated),
        nominal: nominal(findings),
        outcomes: findings.outcomes.iter().map(|o| outcome_row(findings, o)).collect(),
        exceptions: exceptions(findings),
        inputs: findings
            .inputs
            .iter()
            .map(|input| InputRow {
                path: input.path.clone(),
                description: input.description,
                law: input.law.clone(),
                inputs: input.inputs,
                known: input.known,
                nature: input.nature,
                source: input.source.clone(),
            })
            .collect(),
        correlations: findings
            .correlations
            .iter()
            .map(|correlation| CorrelationRow {
                inputs: correlation.inputs.clone(),
                stated: format!("{} {}", correlation.kind, correlation.coefficient),
                normal: number(correlation.normal_correlation, 4),
                source: correlation.source.clone(),
            })
            .collect(),
        exact: exact(&findings.exact),
        method: Method {
            model: findings.method.model,
            design: findings.method.design.clone(),
            tolerance: format!("{:e}", findings.method.tolerance),
            numerical: findings.numerical.statement.clone(),
            caveats: findings.method.caveats.clone(),
        },
        reproduction: Reproduction {
            command: findings.reproduction.command.clone(),
            version: findings.reproduction.version,
            seed: findings.reproduction.seed,
            digest: findings.reproduction.study_digest.clone(),
            files: findings.reproduction.files.clone(),
        },
    }
}

fn verdict(findings: &Findings) -> Verdict {
    let heading = match findings.verdict.word {
        VerdictWord::Met => "MET.",
        VerdictWord::NotMet => "NOT MET.",
        VerdictWord::Undecided => "UNDECIDED.",
        VerdictWord::NoRequirement => "NO REQUIREMENT.",
    };
    let worst = findings
        .probabilities
        .iter()
        .filter(|p| p.kind == EventKind::Limit)
        .max_by(|a, b| a.counts.breaches.cmp(&b.counts.breaches))
        .filter(|p| p.counts.breaches > 0);
    let sharpest = worst.map(|p| {
        let share = p.probability.map_or("unknown".to_owned(), probability);
        let driver = findings
            .drivers
            .outputs
            .iter()
            .find(|output| {
                matches!(&output.name, Output::Breach(limit) if Some(limit) == p.limits.first())
            })
            .and_then(|output| ranked(output).into_iter().next())
            .and_then(|factor| Some((factor, factor.indices.total.value?)));
        match driver {
            Some((factor, total)) => format!(
                "Most often breached: {} ({share}), driven most by `{}` (total index {total:.2}).",
                p.title, factor.name
            ),
            None => format!("Most often breached: {} ({share}).", p.title),
        }
    });
    Verdict {
        heading,
        statement: findings.verdict.statement.clone(),
        other: findings.verdict.other.clone(),
        sharpest,
    }
}

fn probability_row(finding: &crate::findings::ProbabilityFinding) -> ProbabilityRow {
    let faults = match finding.counts.faults {
        0 => String::new(),
        faults => format!(" (+{} unknown)", count(faults)),
    };
    ProbabilityRow {
        title: finding.title.clone(),
        pair: finding.kind == EventKind::Pair,
        counts: format!(
            "{}{faults} of {}",
            count(finding.counts.breaches),
            count(finding.counts.samples)
        ),
        probability: finding.probability.map_or("–".to_owned(), probability),
        interval: probability_interval(&finding.interval),
        upper: upper_end(&finding.upper_bound),
    }
}

fn limit_row(finding: &LimitFinding) -> LimitRow {
    let title = OutcomeQuantity::from_name(finding.outcome).map_or(finding.outcome, |q| q.title());
    let side = if finding.side == "max" { "at most" } else { "at least" };
    LimitRow {
        limit: format!("{title} {side} {}", finding.text),
        source: finding.source.clone().unwrap_or_else(|| NO_SOURCE.to_owned()),
    }
}

fn demonstration(findings: &Findings) -> Option<Demonstration> {
    let verdict = &findings.verdict;
    let (reliability, confidence) = (verdict.reliability?, verdict.confidence?);
    if verdict.failures_allowed.is_empty() {
        return None;
    }
    let allowed =
        verdict.failures_allowed.iter().map(|&(f, n)| (count(f), count(n))).collect::<Vec<_>>();
    let mut risks = format!(
        "Reliability {reliability} at {} confidence is demonstrated by this many independent samples with \
         at most this many failures.",
        probability(confidence)
    );
    if let Some(Decision::Counts(d)) = &verdict.decision {
        let few = d.failures_allowed.map_or("no number of failures".to_owned(), |f| {
            format!("at most {} failures", count(f))
        });
        risks += &format!(
            " Among the {} samples run, {few} would do. Consumer's risk (a system just at the limit \
             passes): {}. Producer's risk (a system with failure probability {} does not pass): {}.",
            count(d.counts.samples),
            d.consumers_risk.map_or("none can pass".to_owned(), probability),
            probability(d.producers_failure_probability),
            probability(d.producers_risk),
        );
    }
    Some(Demonstration { risks, allowed })
}

fn rare(finding: &RareFinding) -> Rare {
    Rare {
        title: finding.title.clone(),
        rows: finding
            .estimates
            .iter()
            .map(|estimate| RareRow {
                method: estimate.method.name(),
                probability: estimate.probability.map_or("none".to_owned(), probability),
                interval: probability_interval(&estimate.interval),
                relative_error: estimate
                    .relative_standard_error()
                    .map_or("–".to_owned(), |error| format!("{:.0} %", 100.0 * error)),
                descents: count(estimate.evaluations),
            })
            .collect(),
        sharpest: finding
            .estimates
            .iter()
            .enumerate()
            .filter(|(_, estimate)| estimate.interval.interval().is_some())
            .filter_map(|(k, estimate)| Some((k, estimate.relative_standard_error()?)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(k, _)| k),
        without_interval: finding.without_interval.join(" "),
        agreement: finding.agreement_statement.clone(),
        disagree: finding.agreement.agrees == Some(false),
        story: finding.design_point.as_ref().map(|point| point.statement.clone()),
    }
}

fn margin(finding: &MarginFinding) -> Margin {
    let quantity = quantity_of(finding.outcome).of_difference();
    let title = OutcomeQuantity::from_name(finding.outcome).map_or(finding.outcome, |q| q.title());
    Margin {
        title: format!("{title}, limit {}", finding.limit_text),
        rows: finding
            .quantiles
            .iter()
            .map(|q| MarginRow {
                share: probability(q.share),
                margin: maybe(q.margin, quantity),
                interval: value_interval(&q.interval, quantity),
            })
            .collect(),
    }
}

fn nominal(findings: &Findings) -> String {
    let nominal = &findings.nominal;
    match (nominal.fault, nominal.deployed) {
        (Some(fault), _) => format!("The nominal descent could not be computed: {fault}."),
        (None, Some(false)) => {
            "The nominal descent does not deploy within the time limit.".to_owned()
        }
        (None, _) if nominal.breaches.is_empty() => {
            "The nominal descent, every input at its nominal value, keeps every limit.".to_owned()
        }
        (None, _) => format!("The nominal descent breaches: {}.", nominal.breaches.join(", ")),
    }
}

fn outcome_row(findings: &Findings, outcome: &crate::findings::OutcomeFinding) -> OutcomeRow {
    let quantity = quantity_of(outcome.name);
    OutcomeRow {
        title: OutcomeQuantity::from_name(outcome.name).map_or(outcome.name, |q| q.title()),
        nominal: maybe(findings.nominal.outcomes.get(&outcome.column).copied(), quantity),
        mean: maybe(outcome.mean, quantity),
        sd: outcome
            .standard_deviation
            .map_or("–".to_owned(), |sd| value(sd, quantity.of_difference())),
        smallest: outcome.smallest.map_or("–".to_owned(), |v| bare(v, quantity)),
        largest: outcome.largest.map_or("–".to_owned(), |v| bare(v, quantity)),
    }
}

fn exceptions(findings: &Findings) -> Vec<String> {
    let exceptions = &findings.exceptions;
    let mut lines = vec![match exceptions.not_deployed {
        0 => "Every computed descent ran out its line before the time limit of 1800 s.".to_owned(),
        some => format!(
            "{} descents had not run out their line after 1800 s; they breach the time limit, and their \
             other outcomes are those at 1800 s.",
            count(some)
        ),
    }];
    lines.push(match exceptions.faulted {
        0 => "Every sample could be computed.".to_owned(),
        some => {
            let kinds: Vec<String> =
                exceptions.faults.iter().map(|(kind, n)| format!("{kind} {}", count(*n))).collect();
            let first: Vec<String> = exceptions
                .first_faulted
                .iter()
                .map(|(index, kind)| format!("{index} ({kind})"))
                .collect();
            format!(
                "{} samples could not be computed ({}); they are rows of the table, and every probability \
                 above allows for each of them being a breach. The first: {}.",
                count(some),
                kinds.join(", "),
                first.join(", ")
            )
        }
    });
    lines
}
