//! What the integrator's own error could have done to the probabilities and to the verdict, as measured.

use super::demonstration::{VerdictFinding, VerdictWord};
use super::percent::percent;
use crate::campaign::{Record, Verification};
use crate::error::Result;
use crate::numerics::words::{self, Word};
use crate::reliability::demonstration::{Requirement, Verdict};
use crate::reliability::probability::Proportion;
use crate::study::Study;
use serde::{Deserialize, Serialize};

/// The numerical error, measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NumericalFinding {
    /// Samples whose outcomes were compared with the plain integrator's.
    pub compared: usize,
    /// How many of them are from the start of the run; the others are its most extreme ones.
    pub first: usize,
    /// Worst relative error of each outcome over them.
    #[serde(deserialize_with = "words::with")]
    pub worst_relative_error: Vec<(Word, f64)>,
    /// One entry a limit.
    pub limits: Vec<NumericalLimit>,
    /// Why the verdict is withdrawn, where what was measured leaves none.
    pub withdrawn: Option<String>,
    /// The measurement in words.
    pub statement: String,
}

/// What the numerical error could have done to one probability.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NumericalLimit {
    /// Name of the limit.
    pub limit: String,
    /// A margin within this share of the limit counts as near.
    pub share: f64,
    /// Samples near the limit.
    pub near: usize,
    /// Those computed again by the plain integrator.
    pub recomputed: usize,
    /// Breaches that are none, and clean samples that are breaches, by the plain integrator.
    pub flips: (u64, u64),
    /// The share of breaches with the flips one way only, either way; with those that were not tried where any was seen.
    pub band: Option<(f64, f64)>,
}

/// The measurement of a run.
pub(crate) fn numerical(
    study: &Study,
    record: &Record,
    verification: &Verification,
) -> NumericalFinding {
    let limits: Vec<NumericalLimit> = study
        .limits
        .iter()
        .zip(&verification.limits)
        .enumerate()
        .map(|(i, (limit, near))| {
            let (to_clean, to_breach) = near.may_flip();
            let band = record.counts().constraint(i).filter(|c| c.samples > 0).map(|counts| {
                let share = |breaches: u64| breaches as f64 / counts.samples as f64;
                (
                    share(counts.breaches.saturating_sub(to_clean)),
                    share((counts.breaches + to_breach).min(counts.samples)),
                )
            });
            NumericalLimit {
                limit: limit.name(),
                share: near.share,
                near: near.near,
                recomputed: near.recomputed,
                flips: (near.breach_to_clean, near.clean_to_breach),
                band,
            }
        })
        .collect();
    let worst_relative_error: Vec<(&'static str, f64)> =
        verification.worst.iter().map(|(quantity, error)| (quantity.name(), *error)).collect();
    let withdrawn = broken(study, verification);
    NumericalFinding {
        compared: verification.measured,
        first: verification.first,
        statement: statement(study, verification, &limits),
        worst_relative_error,
        limits,
        withdrawn,
    }
}

/// Whether an outcome is limited, or nothing is.
fn limited(study: &Study, name: &str) -> bool {
    study.limits.is_empty() || study.limits.iter().any(|limit| limit.outcome.name() == name)
}

/// What is wrong where a limited outcome errs by more than is promised at the tolerance asked for.
fn broken(study: &Study, verification: &Verification) -> Option<String> {
    let broken = verification.broken_promises(study).into_iter();
    let worst = broken
        .filter(|(quantity, ..)| limited(study, quantity.name()))
        .max_by(|(_, a, b), (_, c, d)| (a / b).total_cmp(&(c / d)));
    let (quantity, error, promise) = worst?;
    Some(format!(
        "the integrator's relative error in the {} is up to {error:.1e} of samples that were computed again, and at the \
         tolerance {:e} at most {promise:.0e} is promised; ask for a tighter one, such as `--set numerics.tolerance={:e}`",
        quantity.title(),
        study.numerics.tolerance,
        (0.01 * study.numerics.tolerance).max(1e-10),
    ))
}

fn statement(study: &Study, verification: &Verification, limits: &[NumericalLimit]) -> String {
    let worst = verification
        .worst
        .iter()
        .filter(|(quantity, _)| limited(study, quantity.name()))
        .map(|(_, error)| *error)
        .fold(0.0, f64::max);
    let first = verification.first.min(verification.measured);
    let extreme = verification.measured - first;
    let and = match extreme {
        0 => String::new(),
        _ => format!(
            " and the {extreme} most extreme of the run (hottest, fastest, shortest, largest peaks)"
        ),
    };
    let mut statement = format!(
        "Against the plain integrator on the first {first} samples{and}, the worst relative error of a limited outcome \
         is {worst:.1e}."
    );
    for limit in limits {
        if limit.near == 0 {
            continue;
        }
        let (to_clean, to_breach) = limit.flips;
        let (low, high) = limit.band.unwrap_or((f64::NAN, f64::NAN));
        let which = if limit.recomputed < limit.near {
            format!("the nearest {} of them", limit.recomputed)
        } else {
            "all of them".to_owned()
        };
        statement += &format!(
            " Limit `{}`: {} samples within {:.0e} of it, {which} computed again, {} verdicts flip",
            limit.limit,
            limit.near,
            limit.share,
            to_clean + to_breach,
        );
        statement += &if to_clean + to_breach == 0 {
            ".".to_owned()
        } else {
            format!(" (numerical band {} to {}).", percent(low), percent(high))
        };
    }
    statement
}

/// The verdict after what was measured: withdrawn where a limited outcome errs by more than is promised, or where the
/// samples that may flip decide it.
///
/// # Errors
/// If the study's confidence is none.
pub(crate) fn heed(
    study: &Study,
    record: &Record,
    verification: &Verification,
    numerical: &mut NumericalFinding,
    mut verdict: VerdictFinding,
) -> Result<VerdictFinding> {
    if numerical.withdrawn.is_none() {
        numerical.withdrawn = decided_by_flips(study, record, verification, verdict.word)?;
    }
    let Some(reason) = &numerical.withdrawn else { return Ok(verdict) };
    match verdict.word {
        VerdictWord::Met | VerdictWord::NotMet => {
            verdict.word = VerdictWord::Undecided;
            verdict.statement = format!(
                "Undecided, the numbers cannot be trusted: {reason}. With them it would read: {}",
                verdict.statement
            );
        }
        VerdictWord::Undecided | VerdictWord::NoRequirement => {
            verdict.statement += &format!(" The numbers cannot be trusted: {reason}.");
        }
    }
    Ok(verdict)
}

/// Why no verdict is left where the samples that may flip, all to one side, would not have it.
fn decided_by_flips(
    study: &Study,
    record: &Record,
    verification: &Verification,
    word: VerdictWord,
) -> Result<Option<String>> {
    let Some(stated) = study.requirement else { return Ok(None) };
    let (to_clean, to_breach) = verification.limits.iter().fold((0, 0), |(a, b), near| {
        let (c, d) = near.may_flip();
        (a + c, b + d)
    });
    let counts = record.counts().any();
    let requirement = Requirement::new(stated.reliability, stated.confidence)?;
    let (breaches, wanted) = match word {
        VerdictWord::Met if to_breach > 0 => {
            ((counts.breaches + to_breach).min(counts.samples - counts.faults), Verdict::Met)
        }
        VerdictWord::NotMet if to_clean > 0 => {
            (counts.breaches.saturating_sub(to_clean), Verdict::NotMet)
        }
        _ => return Ok(None),
    };
    let otherwise = Proportion::new(breaches, counts.faults, counts.samples)?;
    let holds = requirement.verdict(&otherwise)?.verdict == wanted;
    Ok((!holds).then(|| {
        format!(
            "{} samples near a limit change sides, or may, when they are computed closer, and the verdict with them; ask \
             for a tighter tolerance, such as `--set numerics.tolerance={:e}`",
            to_clean + to_breach,
            (0.01 * study.numerics.tolerance).max(1e-10),
        )
    }))
}

#[cfg(test)]
#[path = "numerical_test.rs"]
mod tests;
