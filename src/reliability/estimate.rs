//! What every reliability method hands back: a probability with the error it has earned.

use super::event::Event;
use crate::numerics::interval::{Earned, Interval};
use serde::{Deserialize, Serialize};

/// A method that estimates the probability of an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Crude Monte Carlo.
    CrudeMonteCarlo,
    /// First-order reliability method: the half space at the nearest design point.
    Form,
    /// Second-order, Breitung's asymptotic formula.
    SormBreitung,
    /// Second-order, with Hohenbichler and Rackwitz' factor.
    SormHohenbichlerRackwitz,
    /// First-order with every design point found, joined by the multinormal law.
    SystemForm,
    /// Importance sampling around design points.
    ImportanceSampling,
    /// Subset simulation.
    SubsetSimulation,
    /// Line sampling.
    LineSampling,
    /// Directional sampling.
    DirectionalSampling,
    /// Cross-entropy adaptive importance sampling.
    CrossEntropy,
}

impl Method {
    /// The name that a report uses.
    pub fn name(self) -> &'static str {
        match self {
            Method::CrudeMonteCarlo => "crude Monte Carlo",
            Method::Form => "FORM",
            Method::SormBreitung => "SORM (Breitung)",
            Method::SormHohenbichlerRackwitz => "SORM (Hohenbichler–Rackwitz)",
            Method::SystemForm => "system FORM",
            Method::ImportanceSampling => "importance sampling",
            Method::SubsetSimulation => "subset simulation",
            Method::LineSampling => "line sampling",
            Method::DirectionalSampling => "directional sampling",
            Method::CrossEntropy => "cross-entropy importance sampling",
        }
    }
}

/// A method's answer about one event.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The method.
    pub method: Method,
    /// The event.
    pub event: Event,
    /// Probability of a breach with faults read as no breach; none where the method has no number to
    /// give, and the diagnostics say why.
    pub probability: Option<f64>,
    /// The same with every fault read as a breach, where the method can say; equal to `probability`
    /// where no fault was met.
    pub probability_with_faults: Option<f64>,
    /// Standard error of `probability`.
    pub standard_error: Option<f64>,
    /// The interval: its lower end belongs to faults read as no breach, its upper end to faults read
    /// as breaches.
    pub interval: Earned,
    /// Points evaluated, searches and pilots included.
    pub evaluations: u64,
    /// Points whose event could not be decided.
    pub faults: u64,
    /// What the method noticed, in sentences.
    pub diagnostics: Vec<String>,
    /// The independent replicates that the interval was made of, by
    /// [`interval_of_replicates`](super::log_replicates::interval_of_replicates); none if it was made otherwise.
    #[serde(skip)]
    pub replicates: Vec<f64>,
}

impl Estimate {
    /// An answer without a number.
    pub fn without_number(method: Method, event: Event, why: impl Into<String>) -> Self {
        let why = why.into();
        Estimate {
            method,
            event,
            probability: None,
            probability_with_faults: None,
            standard_error: None,
            interval: Earned::none(why.clone()),
            evaluations: 0,
            faults: 0,
            diagnostics: vec![why],
            replicates: Vec::new(),
        }
    }

    /// Coefficient of variation of the estimate.
    pub fn relative_standard_error(&self) -> Option<f64> {
        match (self.probability, self.standard_error) {
            (Some(p), Some(error)) if p > 0.0 => Some(error / p),
            _ => None,
        }
    }

    /// Joins two runs of one method on one event, `safe` with faults read as no breach and `breach`
    /// with faults read as breaches, into the answer that holds both (invariant: a fault could be
    /// either).
    pub fn joined(safe: Estimate, breach: Estimate) -> Estimate {
        let interval = match (safe.interval, breach.interval) {
            (Earned::Interval(low), Earned::Interval(high)) => {
                Interval { upper: high.upper.max(low.upper), ..low }.into()
            }
            (Earned::None(why), _) | (_, Earned::None(why)) => Earned::None(why),
        };
        let mut diagnostics = safe.diagnostics;
        for line in breach.diagnostics {
            if !diagnostics.contains(&line) {
                diagnostics.push(line);
            }
        }
        let faults = safe.faults + breach.faults;
        diagnostics.push(format!(
            "{faults} points could not be evaluated: run with faults as safe and again as breaches"
        ));
        Estimate {
            probability_with_faults: breach.probability,
            interval,
            evaluations: safe.evaluations + breach.evaluations,
            faults,
            diagnostics,
            replicates: Vec::new(),
            ..safe
        }
    }
}
