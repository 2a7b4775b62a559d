//! What the integrator's own error could have done to the probabilities, as measured.

use super::demonstration::percent;
use crate::campaign::{NEAR, Record, Verification};
use crate::study::Study;
use serde::Serialize;

/// The numerical error, measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NumericalFinding {
    /// Samples whose outcomes were compared with the plain integrator's.
    pub compared: usize,
    /// Worst relative error of each outcome over them.
    pub worst_relative_error: Vec<(&'static str, f64)>,
    /// A margin within this share of its limit counts as near.
    pub near: f64,
    /// One entry a limit.
    pub limits: Vec<NumericalLimit>,
    /// The measurement in words.
    pub statement: String,
}

/// What the numerical error could have done to one probability.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NumericalLimit {
    /// Name of the limit.
    pub limit: String,
    /// Samples near the limit.
    pub near: usize,
    /// Those computed again by the plain integrator.
    pub recomputed: usize,
    /// Breaches that are none, and clean samples that are breaches, by the plain integrator.
    pub flips: (u64, u64),
    /// The share of breaches with the flips one way only, either way.
    pub band: Option<(f64, f64)>,
}

/// The measurement of a run.
pub(super) fn numerical(
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
            let band = record.counts().constraint(i).filter(|c| c.samples > 0).map(|counts| {
                let share = |breaches: u64| breaches as f64 / counts.samples as f64;
                let lower = counts.breaches.saturating_sub(near.breach_to_clean);
                (share(lower), share(counts.breaches + near.clean_to_breach))
            });
            NumericalLimit {
                limit: limit.name(),
                near: near.near,
                recomputed: near.recomputed,
                flips: (near.breach_to_clean, near.clean_to_breach),
                band,
            }
        })
        .collect();
    let limited = |name: &str| study.limits.iter().any(|limit| limit.outcome.name() == name);
    let worst_relative_error: Vec<(&'static str, f64)> =
        verification.worst.iter().map(|(quantity, error)| (quantity.name(), *error)).collect();
    let worst = worst_relative_error
        .iter()
        .filter(|(name, _)| limited(name) || study.limits.is_empty())
        .map(|(_, error)| *error)
        .fold(0.0, f64::max);
    let mut statement = format!(
        "Against the plain integrator on the first {} samples, the worst relative error of a limited \
         outcome is {worst:.1e}.",
        verification.measured
    );
    for limit in &limits {
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
            " Limit `{}`: {} samples within {NEAR:.0e} of it, {which} computed again, {} verdicts flip",
            limit.limit,
            limit.near,
            to_clean + to_breach,
        );
        statement += &if to_clean + to_breach == 0 {
            ".".to_owned()
        } else {
            format!(" (numerical band {} to {}).", percent(low), percent(high))
        };
    }
    NumericalFinding {
        compared: verification.measured,
        worst_relative_error,
        near: NEAR,
        limits,
        statement,
    }
}
