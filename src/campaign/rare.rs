//! Probabilities that the samples alone cannot show: the reliability methods on a study's descents.

use super::analysis::{Analysis, Found, Run};
use super::{DescentLimitState, Progress, Record};
use crate::descent::{Fault, Outcome};
use crate::error::Result;
use crate::reliability::agreement::{Agreement, agreement};
use crate::reliability::breach_counts::BreachCounts;
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
use crate::reliability::probability::Proportion;
use crate::reliability::sorm::{SormOptions, sorm};
use crate::reliability::subset::{SubsetOptions, subset_simulation};
use crate::reliability::system::system_form;
use crate::sampling::Design;
use crate::study::{RareMethod, Study};

/// Below this many breaches the samples alone say little, and other methods are asked as well.
pub const FEW_BREACHES: u64 = 50;
/// The methods that are asked unless the study names some.
const DEFAULT_METHODS: [RareMethod; 2] =
    [RareMethod::SubsetSimulation, RareMethod::ImportanceSampling];
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
    /// The most likely way to breach, if one was found.
    pub most_likely: Option<MostLikelyBreach>,
}

/// The design point of an event as a flight.
#[derive(Debug, Clone)]
pub struct MostLikelyBreach {
    /// The point nearest to the medians that breaches; where those breach themselves, the nearest that does not.
    pub point: DesignPoint,
    /// Whether the medians breach.
    pub medians_breach: bool,
    /// The inputs there, SI.
    pub draw: Vec<f64>,
    /// The descent there.
    pub flight: std::result::Result<Outcome, Fault>,
}

/// Descents that a method takes for an event, about.
const DESCENTS: u64 = 10_000;

impl Analysis<'_> for Vec<RareEvent> {
    const NAME: &'static str = "rare events";

    /// At most: which events were seen too rarely is known when the samples have been run.
    fn cost(study: &Study) -> Found<u64> {
        let methods = methods(study).len();
        Ok(DESCENTS * (methods * candidates(study).len()) as u64)
    }

    fn compute(run: Run<'_>) -> Result<Option<Self>> {
        rare_events(run.study, run.record, run.progress).map(Some)
    }
}

/// The methods that are asked.
fn methods(study: &Study) -> &[RareMethod] {
    study.reliability.methods.as_deref().unwrap_or(&DEFAULT_METHODS)
}

/// The events that may be asked about: every limit, if the study names methods all pairs of limits, and any of them.
fn candidates(study: &Study) -> Vec<Event> {
    let limits = study.limits.len();
    let each = (0..limits).map(Event::Limit);
    let pairs = (0..limits).flat_map(|i| (i + 1..limits).map(move |j| Event::Both(i, j)));
    let pairs = pairs.filter(|_| study.reliability.methods.is_some());
    each.chain(pairs).chain((limits > 1).then_some(Event::Any)).collect()
}

/// Asks the reliability methods about every limit, and any of them, that the samples saw too rarely or, if the
/// study names methods, about every limit, all pairs of limits and any of them. Stops early, with what there is, if `progress` says so.
///
/// # Errors
/// If a method refuses its options.
pub fn rare_events(study: &Study, record: &Record, progress: &Progress) -> Result<Vec<RareEvent>> {
    let limits = study.limits.len();
    let counts = record.counts();
    let methods = methods(study);
    let events = candidates(study).into_iter().filter(|&event| {
        let seen = seen(counts, event);
        // Of the limit that no study states, a search is worth it where samples showed that it can be breached.
        let implied = |members: Vec<usize>| members.iter().any(|&i| study.limits[i].implied);
        let unstated = !event.is_union() && event.members(limits).is_ok_and(implied);
        if unstated && seen.is_none_or(|seen| seen.breaches == 0) {
            return false;
        }
        study.reliability.methods.is_some() || seen.is_some_and(|seen| seen.breaches < FEW_BREACHES)
    });
    let state = DescentLimitState::new(study, progress);
    let mut found = Vec::new();
    for event in events {
        if progress.stopping() || methods.is_empty() {
            break;
        }
        found.push(rare_event(study, record, &state, event, methods)?);
    }
    Ok(found)
}

/// The method, if it goes by slopes of the margins.
fn needs_slopes(method: RareMethod) -> Option<Method> {
    match method {
        RareMethod::Form => Some(Method::Form),
        RareMethod::Sorm => Some(Method::SormBreitung),
        RareMethod::LineSampling => Some(Method::LineSampling),
        RareMethod::Crude
        | RareMethod::ImportanceSampling
        | RareMethod::SubsetSimulation
        | RareMethod::DirectionalSampling
        | RareMethod::CrossEntropy => None,
    }
}

/// Why such a method has no number where an input's values jump along its coordinate, if one's do.
fn steps(study: &Study) -> Option<String> {
    if !study.joint.samples().is_empty() {
        return Some(
            "inputs are drawn from the rows of a joint sample: the margins are step functions of the \
             coordinate that picks the row, without the slopes that this method goes by"
                .to_owned(),
        );
    }
    let input = study.inputs.iter().find(|input| input.marginal.has_jumps())?;
    Some(format!(
        "{} has values with a probability of their own: the margins are step functions of its coordinate, \
         without the slopes that this method goes by",
        input.target.path()
    ))
}

/// What the samples saw of an event.
fn seen(counts: &BreachCounts, event: Event) -> Option<Proportion> {
    match event {
        Event::Limit(i) => counts.constraint(i),
        Event::Both(i, j) => counts.pair(i, j),
        Event::Any => Some(counts.any()),
        Event::All => None,
    }
}

fn rare_event(
    study: &Study,
    record: &Record,
    state: &DescentLimitState,
    event: Event,
    methods: &[RareMethod],
) -> Result<RareEvent> {
    let seed = study.sampling.seed;
    let search = SearchOptions::seeded(seed);
    let mut estimates = Vec::new();
    let mut points: Option<DesignPoints> = None;
    if study.sampling.design == Design::MonteCarlo {
        let confidence = ImportanceOptions::seeded(seed).confidence;
        if let Some(seen) = seen(record.counts(), event) {
            let mut crude = crude::from_counts(event, seen, confidence)?;
            if study.sampling.stopping.is_some() {
                // How many samples there are depends on what they show.
                crude.interval = confidence_sequence(seen, confidence)?;
            }
            estimates.push(crude);
        }
    }
    let steps = steps(study);
    for &method in methods {
        if let (Some(smooth), Some(steps)) = (needs_slopes(method), &steps) {
            estimates.push(Estimate::without_number(smooth, event, steps));
            continue;
        }
        match method {
            RareMethod::Form => {
                let (estimate, found) = match event {
                    Event::Limit(i) => form(state, i, &search)?,
                    _ => system_form(state, event, &search)?,
                };
                estimates.push(estimate);
                points.get_or_insert(found);
            }
            RareMethod::Sorm => match event {
                Event::Limit(i) => {
                    let options = SormOptions::seeded(seed);
                    let (second, found) = sorm(state, i, &options)?;
                    estimates.extend([second.breitung, second.hohenbichler_rackwitz]);
                    points.get_or_insert(found);
                }
                _ => estimates.push(Estimate::without_number(
                    Method::SormBreitung,
                    event,
                    "SORM has no formula for several limits",
                )),
            },
            RareMethod::ImportanceSampling => {
                let options = ImportanceOptions::seeded(seed);
                let (estimate, found) = importance_sampling(state, event, &options)?;
                estimates.push(estimate);
                points.get_or_insert(found);
            }
            RareMethod::SubsetSimulation => {
                let options = SubsetOptions::seeded(seed);
                estimates.push(subset_simulation(state, event, &options)?);
            }
            RareMethod::LineSampling => {
                let options = LineOptions::seeded(seed);
                estimates.push(line_sampling(state, event, &options)?);
            }
            RareMethod::DirectionalSampling => {
                let options = DirectionalOptions::seeded(seed);
                estimates.push(directional_sampling(state, event, &options)?);
            }
            RareMethod::CrossEntropy => {
                let options = CrossEntropyOptions::seeded(seed);
                estimates.push(cross_entropy(state, event, &options)?);
            }
            // The samples themselves are there already.
            RareMethod::Crude => {}
        }
    }
    let most_likely = points.as_ref().and_then(|found| {
        // The far side of a region of breaches has the other sign: it is no way into that region.
        let medians_breach = found.origin_breaches;
        let near = |point: &&DesignPoint| (point.reliability_index < 0.0) == medians_breach;
        let point = found.points.iter().find(near)?.clone();
        let (draw, flight) = (state.draw(&point.point), state.flight(&point.point));
        Some(MostLikelyBreach { draw, flight, medians_breach, point })
    });
    let agreement = agreement(&estimates, FAMILY_RISK)?;
    debug_assert_eq!(state.limits(), study.limits.len());
    Ok(RareEvent { event, estimates, agreement, most_likely })
}
