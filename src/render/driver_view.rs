//! The drivers in a reader's words.

use super::figures_of_speech::{count, probability};
use crate::analysis::Findings;
use crate::findings::{CONFIDENCE, DriverOutput, FactorFinding, Output};
use crate::numerics::interval::Estimate;
use serde::Serialize;

/// How many factors a table of drivers shows.
const SHOWN_FACTORS: usize = 8;

#[derive(Debug, Serialize)]
pub(super) struct Drivers {
    pub none: Option<String>,
    pub about: String,
    pub outputs: Vec<DriverTable>,
}

#[derive(Debug, Serialize)]
pub(super) struct DriverTable {
    pub title: String,
    pub sentence: String,
    pub rows: Vec<DriverRow>,
    /// What pairs do together, where that was asked for.
    pub pairs: Vec<String>,
    pub explanations: Vec<String>,
}

#[derive(Debug, Serialize)]
pub(super) struct DriverRow {
    pub name: String,
    pub first: String,
    pub total: String,
}

/// The factors of an output without the members of listed groups, the strongest first; none where too few
/// breaches rank them.
pub(super) fn ranked(output: &DriverOutput) -> Vec<&FactorFinding> {
    if output.too_few.is_some() {
        return Vec::new();
    }
    let mut factors: Vec<&FactorFinding> = output.factors.iter().filter(|f| !f.grouped).collect();
    let strength = |f: &FactorFinding| f.indices.total.value.unwrap_or(f64::NEG_INFINITY);
    factors.sort_by(|a, b| strength(b).total_cmp(&strength(a)));
    factors
}

fn index(estimate: &Estimate) -> String {
    match (estimate.value, estimate.interval.interval()) {
        (Some(value), Some(i)) => format!("{value:.3} ({:.3} … {:.3})", i.lower, i.upper),
        (Some(value), None) => format!("{value:.3} (no interval)"),
        (None, _) => "–".to_owned(),
    }
}

pub(super) fn drivers(findings: &Findings) -> Drivers {
    let drivers = &findings.drivers;
    let faults = match drivers.faults {
        0 => String::new(),
        faults => {
            format!(" {} of them could not be computed and their rows are left out.", count(faults))
        }
    };
    let about = format!(
        "Sobol' indices from a pick-freeze design of {} rows, {} descents of their own.{faults} An index is \
         the share of the variance that a factor explains alone, and with all its interactions; in brackets \
         its {} bootstrap interval. A breach that needs several causes at once has small first-order and \
         large total indices. Every output and factor is in `sensitivity.parquet`.",
        count(drivers.base_samples as u64),
        count(drivers.descents),
        probability(CONFIDENCE)
    );
    let limited: Vec<&str> = findings.margins.iter().map(|margin| margin.outcome).collect();
    let shown = |output: &&DriverOutput| {
        output.name == Output::AnyBreach || output.name.is_one_of(&limited)
    };
    let mut outputs: Vec<&DriverOutput> = drivers.outputs.iter().filter(shown).collect();
    outputs.sort_by_key(|output| !output.breach);
    Drivers {
        none: drivers.none.clone(),
        about,
        outputs: outputs.into_iter().map(driver_table).collect(),
    }
}

fn driver_table(output: &DriverOutput) -> DriverTable {
    let factors = ranked(output);
    let shown = &factors[..factors.len().min(SHOWN_FACTORS)];
    let why_none = shown.first().and_then(|factor| factor.indices.total.interval.why_none());
    let grouped = output.factors.iter().filter(|factor| factor.grouped);
    let strongest = grouped.filter_map(|f| f.indices.total.value).fold(f64::NAN, f64::max);
    let mut sentence = match (shown.first(), why_none) {
        (Some(factor), _) if factor.indices.total.value.is_some() => {
            format!("Strongest: `{}`.", factor.name)
        }
        (_, Some(why)) => format!("No indices: {why}."),
        _ => "No indices.".to_owned(),
    };
    if let Some(why) = &output.too_few {
        sentence = format!("No ranking: {why}.");
    } else if strongest.is_finite() {
        sentence +=
            &format!(" No single member of a group has a total index above {strongest:.3}.");
    }
    let mut explained: Vec<(&str, Vec<String>)> = Vec::new();
    for factor in shown {
        let Some(text) = factor.indices.explanation.as_deref() else { continue };
        match explained.iter_mut().find(|(known, _)| *known == text) {
            Some((_, names)) => names.push(factor.name.to_string()),
            None => explained.push((text, vec![factor.name.to_string()])),
        }
    }
    let pairs = output.pairs.iter().map(|pair| {
        let note = pair.indices.explanation.as_ref().map_or(String::new(), |why| format!(": {why}"));
        format!(
            "`{}` and `{}` together explain {}, of which interaction between them (second order) {}{note}.",
            pair.factors.0,
            pair.factors.1,
            index(&pair.indices.closed),
            index(&pair.indices.interaction)
        )
    });
    let explanations: Vec<String> = explained
        .into_iter()
        .map(|(text, names)| format!("{}: {text}.", names.join(", ")))
        .collect();
    DriverTable {
        title: output.title.clone(),
        sentence,
        rows: shown
            .iter()
            .filter(|factor| factor.indices.total.value.is_some())
            .map(|factor| DriverRow {
                name: match factor.inputs {
                    1 => format!("`{}`", factor.name),
                    many => format!("`{}`, {many} as one", factor.name.name),
                },
                first: index(&factor.indices.first),
                total: index(&factor.indices.total),
            })
            .collect(),
        pairs: pairs.filter(|_| output.too_few.is_none()).collect(),
        explanations,
    }
}
