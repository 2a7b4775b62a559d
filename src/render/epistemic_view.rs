//! What varies and what is not known, in a reader's words.

use super::figures_of_speech::{count, lies_between, probability, probability_interval};
use super::trade_view::{name_of, percent};
use crate::findings::{CONFIDENCE, EpistemicEvent, EpistemicFinding};
use crate::numerics::interval::Estimate;
use serde::Serialize;

/// What varies and what is not known, ready to be laid out.
#[derive(Debug, Serialize)]
pub(super) struct Epistemic {
    pub none: Option<String>,
    /// What is to be read first.
    pub headlines: Vec<String>,
    /// How it was found.
    pub about: String,
    /// One row an event.
    pub rows: Vec<EventRow>,
    /// What each unknown carries of the band of P(any breach).
    pub shares: Vec<ShareRow>,
    pub no_shares: Option<String>,
}

#[derive(Debug, Serialize)]
pub(super) struct EventRow {
    pub title: String,
    pub mean: String,
    pub low: String,
    pub median: String,
    pub high: String,
}

#[derive(Debug, Serialize)]
pub(super) struct ShareRow {
    pub name: String,
    pub first: String,
    pub total: String,
}

/// What varies and what is not known, in words.
pub(super) fn epistemic(finding: &EpistemicFinding) -> Epistemic {
    let any = finding.events.iter().find(|event| event.event == "any");
    Epistemic {
        none: finding.none.clone(),
        headlines: any.map_or(Vec::new(), headlines),
        about: about(finding, any),
        rows: finding.events.iter().map(row).collect(),
        shares: any.map_or(Vec::new(), |event| event.shares.iter().map(share).collect()),
        no_shares: any.and_then(no_shares),
    }
}

/// Why there are no shares, or why none of them has a value.
fn no_shares(event: &EpistemicEvent) -> Option<String> {
    let without_value = event.shares.iter().all(|share| share.total.value.is_none());
    let why = || event.shares.first()?.total.interval.why_none().map(str::to_owned);
    event.no_shares.clone().or_else(|| why().filter(|_| without_value))
}

/// A quantile of P by its share of belief.
fn quantile(event: &EpistemicEvent, share: f64) -> Option<&Estimate> {
    event.quantiles.iter().find(|(at, _)| *at == share).map(|(_, estimate)| estimate)
}

/// "3.1 % (2.2 % … 4.3 %)".
fn with_interval(estimate: Option<&Estimate>) -> String {
    let Some(estimate) = estimate else { return "–".to_owned() };
    match estimate.interval.interval() {
        Some(i) if estimate.value.is_none() && i.lower > 0.0 => {
            format!("within {}", probability_interval(&estimate.interval))
        }
        Some(i) if estimate.value.is_none() => format!("at most {}", probability(i.upper)),
        Some(_) => format!("{} ({})", percent(estimate), probability_interval(&estimate.interval)),
        None => percent(estimate),
    }
}

fn headlines(any: &EpistemicEvent) -> Vec<String> {
    let mean = with_interval(Some(&any.mean));
    if let Some(why) = quantile(any, 0.95).and_then(|estimate| estimate.interval.why_none())
        && quantile(any, 0.95).is_some_and(|estimate| estimate.value.is_none())
    {
        return vec![format!(
            "P(any breach), averaged over the epistemic inputs: {mean}. No credible interval for this brake: {why}."
        )];
    }
    let at = |share: f64| quantile(any, share).and_then(|e| e.value).unwrap_or(f64::NAN);
    let mut lines = vec![format!(
        "P(any breach), averaged over the epistemic inputs: {mean}. Of this brake it {} (90 % credible interval).",
        lies_between(at(0.05), at(0.95)),
    )];
    if let Some((allowed, belief)) = &any.requirement_met {
        let is = match (belief.value, belief.interval.why_none()) {
            (None, Some(why)) => format!("not computed, {why}"),
            _ => with_interval(Some(belief)),
        };
        lines.push(format!(
            "Probability (epistemic) that this brake meets the requirement, P(any breach) at most {}: {is}.",
            probability(*allowed)
        ));
    }
    if let [only] = &any.shares[..] {
        lines.push(format!("All epistemic uncertainty comes from `{}`.", only.factor));
        return lines;
    }
    let leading: Vec<String> = any
        .shares
        .iter()
        .take(3)
        .filter_map(|share| Some((share, share.total.value?)))
        .filter(|(share, _)| share.total.interval.interval().is_some_and(|i| i.lower > 0.0))
        .filter(|(_, total)| *total >= 0.05)
        .map(|(share, total)| format!("`{}` ({})", share.factor, probability(total.min(1.0))))
        .collect();
    if !leading.is_empty() {
        lines.push(format!(
            "Largest total-order contributions to the variance of P(any breach) between brakes: {}.",
            leading.join(", ")
        ));
    }
    lines
}

fn about(finding: &EpistemicFinding, any: Option<&EpistemicEvent>) -> String {
    if finding.none.is_some() {
        return String::new();
    }
    let names = |names: &[String]| {
        names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
    };
    let noise = any.map_or(0.0, |event| event.noise);
    let how = match finding.integrated {
        true => format!(
            "{} descents over what varies; P of a set is integrated along lines through them, to a standard deviation of {}, \
             which is removed",
            finding.inner,
            probability(noise)
        ),
        false => format!(
            "{} descents over what varies; the standard deviation of P of a set from so few, {}, is removed",
            finding.inner,
            probability(noise)
        ),
    };
    let mut text = format!(
        "From flight to flight vary: {}. Fixed for this brake, but not known: {}. {} sets of values of what is not known, each \
         with {how}. Intervals are of {} confidence, from the scatter of twenty sections of the sets; the average of an event that \
         too few sets carry has a bound only (its estimate is that of the probabilities above). {} descents in all.",
        names(&finding.varying),
        names(&finding.unknown),
        count(finding.sets as u64),
        probability(CONFIDENCE),
        count(finding.descents)
    );
    if finding.faults > 0 {
        text += &format!(
            " {} of them could not be computed and are left out of their sets.",
            count(finding.faults)
        );
    }
    text
}

fn row(event: &EpistemicEvent) -> EventRow {
    EventRow {
        title: event.title.clone(),
        mean: with_interval(Some(&event.mean)),
        low: with_interval(quantile(event, 0.05)),
        median: with_interval(quantile(event, 0.5)),
        high: with_interval(quantile(event, 0.95)),
    }
}

fn share(share: &crate::findings::UnknownShare) -> ShareRow {
    let index = |estimate: &Estimate| match (estimate.value, estimate.interval.interval()) {
        (Some(value), Some(i)) => format!("{value:.3} ({:.3} … {:.3})", i.lower, i.upper),
        (Some(value), None) => format!("{value:.3}"),
        (None, _) => "–".to_owned(),
    };
    ShareRow {
        name: name_of(&share.factor, share.inputs),
        first: index(&share.first),
        total: index(&share.total),
    }
}
