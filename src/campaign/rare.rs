//! Probabilities that the samples alone cannot show: the reliability methods on a study's descents.

use super::{DescentLimitState, Progress, Record};
use crate::error::Result;
use crate::reliability::agreement::{Agreement, agreement};
use crate::reliability::confidence_sequence::confidence_sequence;
use crate::reliability::cross_entropy::{CrossEntropyOptions, cross_entropy};
use crate::reliability::crude;
use crate::reliability::design_point::{DesignPoint, DesignPoints, SearchOptions};
use crate::reliability::directional::{DirectionalOptions, directional_sampling};
use crate::reliability::estimate::{Estimate, Method};
use crate::reliability::event::Event;
use crate::reliability::form::form;
use crate::reliability::importance::{ImportanceOptions, importance_sampling};
use crate::reliability::limit_state::LimitState;
use crate::reliability::line::{LineOptions, line_sampling};
use crate::reliability::sorm::{SormOptions, sorm};
use crate::reliability::subset::{SubsetOptions, subset_simulation};
use crate::reliability::system::system_form;
use crate::sampling::Design;
use crate::study::Study;

/// Below this many breaches the samples alone say little, and other methods are asked as well.
pub const FEW_BREACHES: u64 = 50;
/// The methods that are asked unless the study names some.
const DEFAULT_METHODS: [&str; 2] = ["subset-simulation", "importance-sampling"];
/// Risk at which methods that are all right are said to disagree.
const FAMILY_RISK: f64 = 0.01;

/// Several methods' answers about one event.
#[derive(Debug, Clone)]
pub struct RareEvent {
    /// The event.
    pub event: Event,
    /// Their estimates, the samples' own first.
    pub estimates: Vec<Estimate>,
    /// Whether they agree within their errors.
    pub agreement: Agreement,
    /// The most likely way to breach, if one was found, with the draw in SI at it.
    pub design_point: Option<(DesignPoint, Vec<f64>)>,
}

/// Asks the reliability methods about every event that the samples saw too rarely or, if the study names
/// methods, about every limit and any of them. Stops early, with what there is, if `progress` says so.
///
/// # Errors
/// If a method refuses its options.
pub fn rare_events(study: &Study, record: &Record, progress: &Progress) -> Result<Vec<RareEvent>> {
    let limits = study.limits.len();
    let counts = record.counts();
    let chosen = study.reliability.methods.as_deref();
    let methods: Vec<&str> = match chosen {
        Some(methods) => methods.iter().map(String::as_str).collect(),
        None => DEFAULT_METHODS.to_vec(),
    };
    let each = (0..limits).map(Event::Limit);
    let events = each.chain((limits > 1).then_some(Event::Any)).filter(|event| {
        let seen = match event {
            Event::Limit(i) => counts.constraint(*i),
            _ => Some(counts.any()),
        };
        chosen.is_some() || seen.is_some_and(|seen| seen.breaches < FEW_BREACHES)
    });
    let state = DescentLimitState::new(study, progress);
    let mut found = Vec::new();
    for event in events {
        if progress.stopping() || methods.is_empty() {
            break;
        }
        found.push(rare_event(study, record, &state, event, &methods)?);
    }
    Ok(found)
}

/// The method, if it goes by slopes of the margins.
fn needs_slopes(method: &str) -> Option<Method> {
    match method {
        "form" => Some(Method::Form),
        "sorm" => Some(Method::SormBreitung),
        "line-sampling" => Some(Method::LineSampling),
        _ => None,
    }
}

/// Why such a method has no number where inputs are drawn from rows.
const STEPS: &str = "inputs are drawn from the rows of a joint sample: the margins are step functions of the \
    coordinate that picks the row, without the slopes that this method goes by";

fn rare_event(
    study: &Study,
    record: &Record,
    state: &DescentLimitState,
    event: Event,
    methods: &[&str],
) -> Result<RareEvent> {
    let seed = study.sampling.seed;
    let search = SearchOptions { seed, ..SearchOptions::default() };
    let mut estimates = Vec::new();
    let mut points: Option<DesignPoints> = None;
    if study.sampling.design == Design::MonteCarlo {
        let seen = match event {
            Event::Limit(i) => record.counts().constraint(i),
            _ => Some(record.counts().any()),
        };
        let confidence = ImportanceOptions::default().confidence;
        if let Some(seen) = seen {
            let mut crude = crude::from_counts(event, seen, confidence)?;
            if study.sampling.stopping.is_some() {
                // How many samples there are depends on what they show.
                crude.interval = confidence_sequence(seen, confidence)?;
            }
            estimates.push(crude);
        }
    }
    for &method in methods {
        if let Some(smooth) = needs_slopes(method).filter(|_| !study.joint.samples().is_empty()) {
            estimates.push(Estimate::without_number(smooth, event, STEPS));
            continue;
        }
        match method {
            "form" => {
                let (estimate, found) = match event {
                    Event::Limit(i) => form(state, i, &search)?,
                    _ => system_form(state, event, &search)?,
                };
                estimates.push(estimate);
                points.get_or_insert(found);
            }
            "sorm" => match event {
                Event::Limit(i) => {
                    let options = SormOptions { search: search.clone(), ..SormOptions::default() };
                    let (second, found) = sorm(state, i, &options)?;
                    estimates.extend([second.breitung, second.hohenbichler_rackwitz]);
                    points.get_or_insert(found);
                }
                _ => estimates.push(Estimate::without_number(
                    Method::SormBreitung,
                    event,
                    "SORM has no formula for a union of limits",
                )),
            },
            "importance-sampling" => {
                let options = ImportanceOptions {
                    seed,
                    search: search.clone(),
                    ..ImportanceOptions::default()
                };
                let (estimate, found) = importance_sampling(state, event, &options)?;
                estimates.push(estimate);
                points.get_or_insert(found);
            }
            "subset-simulation" => {
                let options = SubsetOptions { seed, ..SubsetOptions::default() };
                estimates.push(subset_simulation(state, event, &options)?);
            }
            "line-sampling" => {
                let options =
                    LineOptions { seed, search: search.clone(), ..LineOptions::default() };
                estimates.push(line_sampling(state, event, &options)?);
            }
            "directional-sampling" => {
                let options = DirectionalOptions { seed, ..DirectionalOptions::default() };
                estimates.push(directional_sampling(state, event, &options)?);
            }
            "cross-entropy" => {
                let options = CrossEntropyOptions { seed, ..CrossEntropyOptions::default() };
                estimates.push(cross_entropy(state, event, &options)?);
            }
            // "crude" is the samples themselves, which are there already.
            _ => {}
        }
    }
    let nearest = points.as_ref().and_then(|found| found.points.first()).cloned();
    let design_point = nearest.map(|point| {
        let draw = state.draw(&point.point);
        (point, draw)
    });
    let agreement = agreement(&estimates, FAMILY_RISK)?;
    debug_assert_eq!(state.limits(), study.limits.len());
    Ok(RareEvent { event, estimates, agreement, design_point })
}
