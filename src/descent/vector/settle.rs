//! Descents whose first integration is in doubt, once more and closer, until two runs in a row agree.

use super::batch::Batch;
use super::dispatch::dispatch;
use super::settings::{Attempt, Counts, Settings};
use crate::descent::model::Model;
use crate::descent::outcome::{Fault, Outcome, OutcomeQuantity};
use crate::numerics::lanes::InstructionSet;

/// Integrates the batch, and what is in doubt again.
pub(super) fn run(
    set: InstructionSet,
    model: Model,
    settings: &Settings,
    batch: Batch,
    results: &mut [Result<Outcome, Fault>],
) -> Counts {
    let mut doubtful = Vec::new();
    let mut counts = dispatch(set, model, settings.attempt(), batch, results, &mut doubtful);
    if doubtful.is_empty() {
        return counts;
    }
    doubtful.sort_unstable();
    for attempt in settings.closer() {
        let picked = batch.pick(&doubtful);
        let mut closer = vec![Err(Fault::NotFinite); doubtful.len()];
        let (again, mut still) = (picked.batch(), Vec::new());
        counts += dispatch(set, model, attempt, again, &mut closer, &mut Vec::new());
        for (&place, closer) in doubtful.iter().zip(closer) {
            // What takes too many steps takes more of them at a tighter tolerance.
            let endless = closer == Err(Fault::TooManySteps);
            if !endless && !agree(settings, &results[place], &closer) {
                still.push(place);
            }
            results[place] = closer;
        }
        doubtful = still;
        if doubtful.is_empty() {
            break;
        }
    }
    for place in doubtful {
        results[place] = results[place].and(Err(Fault::Inaccurate));
    }
    counts
}

/// The attempt at a descent whose result [`run`] returns, and that result.
pub(super) fn attempt_of(
    model: Model,
    settings: &Settings,
    one: &crate::physics::Coefficients<f64>,
) -> Result<Attempt, Fault> {
    let batch = Batch::Coefficients(std::slice::from_ref(one));
    let (mut result, mut doubtful) = ([Err(Fault::NotFinite)], Vec::new());
    let set = InstructionSet::Portable;
    let first = settings.attempt();
    dispatch(set, model, first, batch, &mut result, &mut doubtful);
    if doubtful.is_empty() {
        return result[0].map(|_| first);
    }
    let mut last = result[0];
    for attempt in settings.closer() {
        dispatch(set, model, attempt, batch, &mut result, &mut doubtful);
        if agree(settings, &last, &result[0]) {
            return Ok(attempt);
        }
        last = result[0];
        if last == Err(Fault::TooManySteps) {
            break;
        }
    }
    last.and(Err(Fault::Inaccurate))
}

/// Whether two runs of a descent agree to half of what is promised.
fn agree(
    settings: &Settings,
    one: &Result<Outcome, Fault>,
    other: &Result<Outcome, Fault>,
) -> bool {
    let (Ok(one), Ok(other)) = (one, other) else { return false };
    let close = |quantity: OutcomeQuantity| {
        let (one, other) = (one.get(quantity), other.get(quantity));
        (one - other).abs() <= 0.5 * settings.promise(quantity) * other.abs()
    };
    one.deployed == other.deployed && OutcomeQuantity::ALL.into_iter().all(close)
}
