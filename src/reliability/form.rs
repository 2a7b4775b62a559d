//! FORM: the probability of the half space at the nearest design point.

use super::design_point::{DesignPoints, SearchOptions, design_points};
use super::estimate::{Estimate, Method};
use super::event::Event;
use super::limit_state::LimitState;
use crate::error::Result;
use crate::numerics::interval::Earned;
use crate::numerics::special::normal;

/// Why a first- or second-order result has no interval.
pub const NO_ERROR_KNOWN: &str =
    "an approximation of the limit's shape: nothing in the method measures its error";

/// First-order estimate of the probability of one limit, Φ(−β), with the design points behind it.
///
/// A search that did not converge gives no number. No interval: the error is that of replacing the
/// limit by a plane, and 10 × either way is on record.
///
/// # Errors
/// Those of [`design_points`].
pub fn form(
    state: &dyn LimitState,
    limit: usize,
    options: &SearchOptions,
) -> Result<(Estimate, DesignPoints)> {
    let event = Event::Limit(limit);
    let found = design_points(state, event, options)?;
    let mut estimate = match found.points.first() {
        Some(point) => first_order(Method::Form, event, normal::survival(point.reliability_index)),
        None => Estimate::without_number(Method::Form, event, no_design_point(&found)),
    };
    estimate.evaluations = found.evaluations;
    estimate.faults = found.faults;
    estimate.diagnostics.extend(found.diagnostics());
    Ok((estimate, found))
}

/// An estimate without an error of its own.
pub(super) fn first_order(method: Method, event: Event, probability: f64) -> Estimate {
    Estimate {
        method,
        event,
        probability: Some(probability),
        probability_with_faults: None,
        standard_error: None,
        interval: Earned::none(NO_ERROR_KNOWN),
        evaluations: 0,
        faults: 0,
        diagnostics: Vec::new(),
        replicates: Vec::new(),
    }
}

/// The sentence for a search that found nothing.
pub(super) fn no_design_point(found: &DesignPoints) -> String {
    match found.unconverged.first() {
        Some((_, why)) => format!("no design-point search converged: {why}"),
        None => "no design point was searched".to_owned(),
    }
}
