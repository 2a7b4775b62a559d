//! `reeldown check`: every resolved value of a study, with its unit and source.

use super::arguments::CheckArguments;
use super::{Ending, done};
use crate::error::Result;
use crate::reliability::adaptive::Until;
use crate::render::table;
use crate::study::{RequirementOf, Study};
use crate::units::number;

/// Validates a study and shows it.
pub(super) fn check(arguments: &CheckArguments) -> Result<Ending> {
    let study = arguments.study.load(&[])?;
    study.design.validate()?;
    if arguments.json {
        return done(&format!("{:#}", json(&study)));
    }
    let mut text = format!("{}\n{}: valid\n\n", study.title, study.origin);
    let rows = study.resolved().into_iter().map(|row| {
        let (law, nature, known, source) = match row.uncertain {
            Some(law) => {
                let each =
                    if law.inputs > 1 { format!(" (×{})", law.inputs) } else { String::new() };
                (format!("{}{each}", law.law), law.nature.name(), law.known.name(), law.source)
            }
            None => ("–".to_owned(), "–", "–", row.source),
        };
        [row.path, row.text, law, nature.to_owned(), known.to_owned(), source]
    });
    let header = ["input", "nominal", "law", "nature", "known", "source"];
    text += &format!("{}\n\n", table(&header, 0..0, rows, None));
    for correlation in study.resolved_correlations() {
        text += &format!(
            "correlation: {}: {} {} ({} between normal scores, by a Gaussian copula); {}\n",
            correlation.inputs(),
            correlation.measure.name(),
            correlation.measure.value(),
            number(correlation.measure.normal_correlation(), 4),
            correlation.source
        );
    }
    for limit in &study.limits {
        text += &format!(
            "limit: {} {} {}; {}\n",
            limit.outcome.name(),
            limit.kind.name(),
            limit.text,
            limit.source_text()
        );
    }
    if let Some(requirement) = study.requirement {
        text += &format!(
            "requirement: reliability {} at confidence {}, of {}\n",
            requirement.reliability,
            requirement.confidence,
            match requirement.of {
                RequirementOf::Average => "the average over all possible brakes",
                RequirementOf::Brake => "this brake",
            }
        );
    }
    let plan = &study.sampling;
    text += &format!(
        "sampling: {}, {}{} samples, seed {}\nmodel: {}\ndigest: {}\n",
        plan.design.name(),
        if plan.stopping.is_some() { "at most " } else { "" },
        plan.samples,
        plan.seed,
        study.model.name(),
        study.digest()
    );
    if let Some(stopping) = plan.stopping {
        let until = match stopping.until {
            Until::RelativeError(error) => format!("the relative error is at most {error}"),
            Until::Decided { .. } => "the requirement is decided".to_owned(),
        };
        text += &format!("until: {until}, at confidence {}\n", stopping.confidence);
    }
    for note in &study.notes {
        text += &format!("note: {note}\n");
    }
    done(&text)
}

fn json(study: &Study) -> serde_json::Value {
    let inputs: Vec<serde_json::Value> = study
        .resolved()
        .into_iter()
        .map(|row| {
            serde_json::json!({
                "path": row.path,
                "description": row.description,
                "unit": row.quantity.si_unit(),
                "value": row.value,
                "source": row.source,
                "uncertain": row.uncertain.map(|law| serde_json::json!({
                    "law": law.law,
                    "mean": law.mean,
                    "standard_deviation": law.sd,
                    "inputs": law.inputs,
                    "known": law.known.name(),
                    "nature": law.nature.name(),
                    "source": law.source,
                })),
            })
        })
        .collect();
    let correlations: Vec<serde_json::Value> = study
        .resolved_correlations()
        .into_iter()
        .map(|correlation| {
            serde_json::json!({
                "between": correlation.between,
                "pairs": correlation.pairs,
                "kind": correlation.measure.name(),
                "coefficient": correlation.measure.value(),
                "normal_correlation": correlation.measure.normal_correlation(),
                "source": correlation.source,
            })
        })
        .collect();
    let limits: Vec<serde_json::Value> = study
        .limits
        .iter()
        .map(|limit| {
            serde_json::json!({
                "outcome": limit.outcome.name(),
                "side": limit.kind.name(),
                "value": limit.value,
                "unit": limit.outcome.quantity().si_unit(),
                "source": limit.source,
            })
        })
        .collect();
    serde_json::json!({
        "title": study.title,
        "model": study.model.name(),
        "inputs": inputs,
        "correlations": correlations,
        "limits": limits,
        "requirement": study.requirement.map(|r| serde_json::json!({
            "reliability": r.reliability,
            "confidence": r.confidence,
            "of": r.of.name(),
        })),
        "sampling": {
            "design": study.sampling.design.name(),
            "samples": study.sampling.samples,
            "seed": study.sampling.seed,
            "replicates": study.sampling.replicates,
            "until": study.sampling.stopping.map(|stopping| stopping.until),
            "until_confidence": study.sampling.stopping.map(|stopping| stopping.confidence),
        },
        "study_digest": study.digest(),
        "notes": study.notes,
    })
}
