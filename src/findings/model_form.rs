//! Whether the verdict depends on the form of the thermal model.

use super::demonstration::VerdictWord;
use super::trade::Paired;
use crate::campaign::Found;
use crate::campaign::common_numbers::Event;
use crate::campaign::model_form::{Form, ModelFormOutcomes};
use crate::descent::{Model, OutcomeQuantity};
use crate::error::Result;
use crate::numerics::interval::Estimate;
use crate::numerics::words::{self, Word};
use crate::reliability::demonstration::{Requirement, Verdict};
use crate::study::Study;
use serde::{Deserialize, Serialize};

/// The study's samples by either thermal model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelFormFinding {
    /// Samples of either form: the study's first, the same for both.
    pub samples: u64,
    /// The study's own form, then the other one; none if it was not computed.
    pub forms: Vec<FormFinding>,
    /// P(any breach) by the other form less that by the study's own, on the same samples.
    pub difference: Option<Estimate>,
    /// Whether these samples decide the requirement differently by the two forms; `None` where it cannot be told.
    pub verdict_depends: Option<bool>,
    /// Why there are no forms.
    pub none: Option<String>,
}

/// One form of the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FormFinding {
    /// Name in study files.
    #[serde(deserialize_with = "words::one")]
    pub model: Word,
    /// Whether temperature is resolved over the radius and across the film.
    pub detailed: bool,
    /// P(any breach).
    pub any: Estimate,
    /// What these samples alone say of the requirement; `None` without one, or where samples are not independent.
    pub verdict: Option<VerdictWord>,
    /// Outcomes of the nominal descent that are limited: name, value in SI.
    #[serde(deserialize_with = "words::with")]
    pub nominal: Vec<(Word, f64)>,
    /// Limits that the nominal descent breaches.
    pub nominal_breaches: Vec<String>,
}

/// What the form of the model is worth.
///
/// # Errors
/// If a statistic refuses the counts.
pub(crate) fn model_form(
    study: &Study,
    outcomes: &Found<ModelFormOutcomes>,
) -> Result<ModelFormFinding> {
    let found = match outcomes {
        Ok(found) => found,
        Err(why) => {
            return Ok(ModelFormFinding {
                samples: 0,
                forms: Vec::new(),
                difference: None,
                verdict_depends: None,
                none: Some(why.to_string()),
            });
        }
    };
    let paired = Paired { replicates: found.replicates };
    let forms: Vec<FormFinding> =
        found.forms.iter().map(|form| finding(study, form, paired)).collect::<Result<_>>()?;
    let [own, other] = &found.forms;
    let words: Vec<Option<VerdictWord>> = forms.iter().map(|form| form.verdict).collect();
    let verdict_depends = match words[..] {
        [Some(own), Some(other)] => (own != VerdictWord::Undecided
            && other != VerdictWord::Undecided)
            .then_some(own != other),
        _ => None,
    };
    Ok(ModelFormFinding {
        samples: own.breaches.rows() as u64,
        forms,
        difference: Some(paired.difference(&own.breaches, &other.breaches, Event::Any)?),
        verdict_depends,
        none: None,
    })
}

fn finding(study: &Study, form: &Form, paired: Paired) -> Result<FormFinding> {
    let verdict = match study.requirement.filter(|_| paired.replicates <= 1) {
        Some(stated) => {
            let requirement = Requirement::new(stated.reliability, stated.confidence)?;
            Some(match requirement.verdict(&form.breaches.count(Event::Any))?.verdict {
                Verdict::Met => VerdictWord::Met,
                Verdict::NotMet => VerdictWord::NotMet,
                Verdict::Undecided => VerdictWord::Undecided,
            })
        }
        None => None,
    };
    let limited = |quantity: &OutcomeQuantity| study.limits.iter().any(|l| l.outcome == *quantity);
    let quantities = OutcomeQuantity::ALL.into_iter().filter(limited);
    let (nominal, nominal_breaches) = match &form.nominal {
        Ok(outcome) => (
            quantities.map(|quantity| (quantity.name(), outcome.get(quantity))).collect(),
            study
                .limits
                .iter()
                .filter(|limit| limit.margin(outcome) < 0.0)
                .map(|limit| limit.name())
                .collect(),
        ),
        Err(_) => (Vec::new(), Vec::new()),
    };
    Ok(FormFinding {
        model: Model::name(form.model),
        detailed: form.model.is_detailed(),
        any: paired.probability(&form.breaches, Event::Any)?,
        verdict,
        nominal,
        nominal_breaches,
    })
}
