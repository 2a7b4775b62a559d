//! A calibration in sentences.

use super::{CalibrationFinding, SuspicionFinding};
use crate::calibration::screening::Suspicion;
use crate::campaign::calibration::Channel;
use crate::findings::percent::percent;
use crate::units::{display, number};

/// What a suspicion says.
pub(super) fn suspicion(channel: Channel, suspicion: &Suspicion) -> String {
    let quantity = channel.quantity();
    let value = |si: f64| {
        let unit = display(quantity);
        format!("{} {}", number(unit.shown(si), 5), unit.symbol)
    };
    let seconds = |time: f64| number(time, 6);
    match suspicion {
        Suspicion::Gap { from_s, to_s } => {
            format!("no readings from {} to {} s", seconds(*from_s), seconds(*to_s))
        }
        Suspicion::Outlier { time_s, value: si, deviations } => format!(
            "{} at {} s stands {} robust standard deviations off its neighbours: an outlier? \
             --heavy-tails allows for it",
            value(*si),
            seconds(*time_s),
            number(*deviations, 3)
        ),
        Suspicion::Stuck { from_s, to_s, value: si, at_the_stop } => format!(
            "{} all the way from {} to {} s: {}",
            value(*si),
            seconds(*from_s),
            seconds(*to_s),
            if *at_the_stop { "a sensor at its stop?" } else { "a sensor that hung?" }
        ),
        Suspicion::Unit { ratio, factor, mistake } => format!(
            "readings are {} times what the card predicts; {} would be {mistake}: is a unit in the header wrong?",
            number(*ratio, 4),
            number(*factor, 4)
        ),
        Suspicion::Implausible { ratio, bound } => format!(
            "readings are {} times what the card predicts, which its widths explain up to {}, and no usual mistake of \
             units in them does: another brake, a card too narrow, or a mistaken unit of what drives the run (a force \
             in N under a header that says lbf)?",
            number(*ratio, 4),
            number(*bound, 4)
        ),
    }
}

/// A suspicion with its place.
pub fn about_one(finding: &SuspicionFinding) -> String {
    format!("{}, {}: {}", finding.run, finding.channel, finding.statement)
}

/// The suspicions that forbid a calibration, if there are any.
pub fn refusal(findings: &[SuspicionFinding]) -> Option<String> {
    let grave: Vec<String> = findings
        .iter()
        .filter(|finding| {
            matches!(finding.suspicion, Suspicion::Unit { .. } | Suspicion::Implausible { .. })
        })
        .map(about_one)
        .collect();
    (!grave.is_empty()).then(|| grave.join("; "))
}

/// The answer.
pub(super) fn statements(finding: &CalibrationFinding) -> Vec<String> {
    let mut said = Vec::new();
    let diagnosis = &finding.diagnosis;
    if finding.converged && !finding.doubts.is_empty() {
        said.push(format!(
            "The sampler has converged, but the posterior is in doubt: {}.",
            finding.doubts.join("; ")
        ));
    } else if finding.converged {
        said.push(format!(
            "Posterior diagnostics passed: {} draws, {:.0} effective, R-hat at most {:.3}, ln evidence {:.2} ± {:.2}.",
            finding.draws,
            diagnosis.effective,
            diagnosis.worst_r_hat,
            diagnosis.ln_evidence,
            diagnosis.ln_evidence_error
        ));
    } else {
        said.push(format!(
            "Posterior diagnostics failed, and no card is written: {}. Try more --particles.",
            diagnosis.failures.join("; ")
        ));
    }
    let made_up = finding.runs.iter().filter(|run| run.synthetic).count();
    if made_up > 0 {
        said.push(format!(
            "The data are synthetic: {} of {} runs were generated from a known brake, not measured. What follows \
             demonstrates the method, not a brake.",
            made_up,
            finding.runs.len()
        ));
    }
    let names = |dominated: bool| -> String {
        let chosen = finding.parameters.iter().filter(|p| p.prior_dominated == dominated);
        let names: Vec<String> = chosen
            .map(|p| match dominated {
                true => p.name.clone(),
                false => format!("{} {:.0} %", p.name, 100.0 * p.learned),
            })
            .collect();
        names.join(", ")
    };
    let (learned, dominated) = (names(false), names(true));
    if !learned.is_empty() {
        said.push(format!("Identified by the data, prior variance reduced by: {learned}."));
    }
    if !dominated.is_empty() {
        said.push(format!(
            "Not identified by the data, the posterior is about the prior: {dominated}."
        ));
    }
    if let Some((before, after)) = &finding.risk {
        let band = |band: [f64; 3]| format!("{} … {}", percent(band[0]), percent(band[2]));
        said.push(format!(
            "P(any breach) moves from {} (90 % credible interval over brakes {}) to {} ({}).",
            percent(before.probability),
            band(before.band),
            percent(after.probability),
            band(after.band)
        ));
    }
    let held: Vec<_> = finding.checks.iter().filter(|check| check.held_out).collect();
    if !held.is_empty() {
        let shares: Vec<String> = held
            .iter()
            .map(|check| format!("{} {}", check.channel, percent(check.coverage)))
            .collect();
        said.push(format!(
            "Coverage of the {} predictive bands on held-out readings: {}.",
            percent(held[0].expected),
            shares.join(", ")
        ));
    }
    let off: Vec<String> = finding
        .checks
        .iter()
        .filter(|check| check.score < -2.5)
        .map(|check| format!("{} of {}", check.channel, check.run))
        .collect();
    if !off.is_empty() {
        said.push(format!(
            "The predictive bands are too narrow: they hold too few readings of {}.",
            off.join(", ")
        ));
    }
    if let Some(best) = finding.next.as_ref().and_then(|next| next.tests.first()) {
        said.push(format!(
            "Most informative next measurement: {} ({}); expected width of the interval: {} of today's.",
            best.name,
            best.detail,
            percent(best.width_left)
        ));
    }
    said
}
