//! The form of the thermal model in words.

use super::figures_of_speech::{count, probability, probability_interval, quantity_of, value};
use super::trade_view::points;
use crate::descent::OutcomeQuantity;
use crate::findings::{FormFinding, ModelFormFinding, VerdictWord};
use serde::Serialize;

/// The section about the form of the model.
#[derive(Debug, Serialize)]
pub(super) struct ModelFormView {
    /// The answer in a sentence or two.
    pub headline: String,
    /// What the columns after the probability are: limited outcomes of the nominal descent.
    pub columns: Vec<String>,
    pub rows: Vec<FormRow>,
    pub about: String,
}

#[derive(Debug, Serialize)]
pub(super) struct FormRow {
    pub model: &'static str,
    pub heat: &'static str,
    pub probability: String,
    pub interval: String,
    pub verdict: &'static str,
    pub nominal: Vec<String>,
}

/// The words; none where the forms were not computed.
pub(super) fn model_form(finding: &ModelFormFinding) -> Option<ModelFormView> {
    let [own, other] = &finding.forms[..] else { return None };
    let difference = finding.difference.as_ref()?;
    let share = |form: &FormFinding| form.any.value.map_or("unknown".to_owned(), probability);
    let (heat, other_heat) = (heat(own.detailed), heat(other.detailed));
    let compared = format!(
        "by the model with {heat} P(any breach) is {}, with {other_heat} {} (difference {} percentage points)",
        share(own),
        share(other),
        points(difference)
    );
    let headline = match (finding.verdict_depends, own.verdict, other.verdict) {
        (Some(true), _, _) => {
            format!("The verdict depends on the form of the thermal model: {compared}.")
        }
        (Some(false), _, _) => {
            let apart = difference.interval.interval().is_some_and(|i| i.lower * i.upper > 0.0);
            let also = if apart { "P is not" } else { "so is P, as far as these samples tell" };
            format!("The verdict is the same by either thermal model; {also}: {compared}.")
        }
        (None, Some(_), Some(_)) => format!(
            "{} samples do not decide the requirement by both thermal models: {compared}.",
            count(finding.samples)
        ),
        _ => format!("The form of the thermal model: {compared}."),
    };
    let names: Vec<&'static str> = own.nominal.iter().map(|(name, _)| *name).collect();
    let title = |name: &&str| {
        OutcomeQuantity::from_name(name).map_or((*name).to_owned(), |q| q.title().to_owned())
    };
    let row = |form: &FormFinding| FormRow {
        model: form.model,
        heat: self::heat(form.detailed),
        probability: share(form),
        interval: probability_interval(&form.any.interval),
        verdict: match form.verdict {
            Some(VerdictWord::Met) => "met",
            Some(VerdictWord::NotMet) => "not met",
            Some(VerdictWord::Undecided) => "undecided",
            Some(VerdictWord::NoRequirement) | None => "–",
        },
        nominal: names
            .iter()
            .map(|name| {
                let found = form.nominal.iter().find(|(known, _)| known == name);
                let breach = if form.nominal_breaches.iter().any(|b| b.starts_with(name)) {
                    " (breach)"
                } else {
                    ""
                };
                found.map_or("–".to_owned(), |(_, x)| value(*x, quantity_of(name)) + breach)
            })
            .collect(),
    };
    Some(ModelFormView {
        headline,
        columns: names.iter().map(title).collect(),
        rows: vec![row(own), row(other)],
        about: format!(
            "Both fly the same {} samples. With three nodes the fluid has one temperature, its average over the brake; with films \
             resolved, temperature varies over the radius and across the film, and the peak is that of the hottest fluid \
             anywhere. The right-hand columns are of the nominal descent.",
            count(finding.samples)
        ),
    })
}

fn heat(detailed: bool) -> &'static str {
    if detailed { "films resolved" } else { "three nodes" }
}
