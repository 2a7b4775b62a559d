//! The loop: lanes that step, each at its own pace, and are refilled from the queue as they finish.

use super::constants::Constants;
use super::model::Model;
use super::observables::{OBSERVABLES, Peaks};
use super::rosenbrock::{self, STAGES};
use super::settings::{Counts, Settings};
use crate::descent::outcome::{Fault, Outcome, TIME_LIMIT_S};
use crate::numerics::lanes::{Lanes, Mask};
use crate::physics::Coefficients;

/// Most step attempts of one descent: some hundred times what an ordinary one takes.
const MOST_STEPS: f64 = 20_000.0;

/// Smallest step, relative to where the clock stands.
const FINEST: f64 = 1e-15;

/// A step's growth aims at this share of the tolerance's fourth root; a larger one saves no steps, as more
/// of them are rejected (0.85: 2 % rejected; 0.9: 5 %; 0.95: 14 %, and more steps in all).
const SAFETY: f64 = 0.85;

/// The clock changes to line length when the unbalanced force has fallen below this share of the load:
/// after two or three fast time constants. Between 0.005 and 0.3 it makes no difference to cost or error.
const SETTLED: f64 = 0.1;

/// How a lane has finished: not yet, at the end of the line, at the time limit, or not at all.
const RUNNING: f64 = 0.0;
const DEPLOYED: f64 = 1.0;
const LATE: f64 = 2.0;
const MANY: f64 = -1.0;
const SMALL: f64 = -2.0;

/// Widest lane type: two AVX-512 registers.
const WIDEST: usize = 16;

/// Part of a descent that a lane is in.
const STARTING: f64 = 0.0;
/// In line length, to the end of the line.
const PAYING_OUT: f64 = 1.0;
/// In time again, to the time limit, because the line would not have ended before it.
const RUNNING_LATE: f64 = 2.0;
/// In line length for good: the line ends, by a hair, before the limit.
const LANDING: f64 = 3.0;

/// Integrates every descent of the batch.
#[inline(always)]
pub fn run<V: Lanes, M: Model<V, N>, const N: usize>(
    settings: &Settings,
    batch: &[Coefficients<f64>],
    results: &mut [Result<Outcome, Fault>],
) -> Counts {
    let mut counts = Counts::default();
    let mut next = 0;
    let Some(first) = next_possible(batch, results, &mut next) else { return counts };

    let zero = V::splat(0.0);
    let one = V::splat(1.0);
    let limit = V::splat(TIME_LIMIT_S);
    let inverse_tolerance = V::splat(1.0 / settings.local_tolerance(M::KIND));

    let mut model = M::new(&first.1);
    let mut y = [one; N];
    let mut h = one;
    let mut leg = zero;
    let mut attempts = zero;
    let mut finished = zero;
    let mut peaks = Peaks::new();
    let mut sample = [usize::MAX; WIDEST];
    let mut waiting = Some(first);
    let mut live = 0u32;

    for (lane, place) in sample.iter_mut().enumerate().take(V::WIDTH) {
        // Lanes without a sample follow the first one's constants and are never read.
        let (constants, index) = match waiting.take() {
            Some((index, constants)) => (constants, index),
            None => match next_possible(batch, results, &mut next) {
                Some((index, constants)) => (constants, index),
                None => break,
            },
        };
        live |= 1 << lane;
        *place = index;
        load::<V, M, N>(&mut model, lane, &constants, &mut y, &mut h, &mut leg);
    }
    // Idle lanes need some state: that of lane 0.
    for lane in 0..V::WIDTH {
        if live & (1 << lane) == 0 {
            for value in &mut y {
                let first = value.lanes()[0];
                value.lanes_mut()[lane] = first;
            }
            let (first_h, first_leg) = (h.lanes()[0], leg.lanes()[0]);
            h.lanes_mut()[lane] = first_h;
            leg.lanes_mut()[lane] = first_leg;
        }
    }
    let any = any_cross(model.constants());
    model.set_any_cross(any);

    while live != 0 {
        let in_length = V::splat(0.5).lt(leg).and(leg.lt(V::splat(1.5))).or(V::splat(2.5).lt(leg));
        model.clock().length = V::select(in_length, one, zero);
        model.clock().time = V::select(in_length, zero, one);

        let moment = model.moment(&y);
        let seen = model.observe(&y, &moment);
        let velocity = M::velocity(&moment);
        let end_slopes = model.observable_rates(&moment, peaks.stiff_rate(velocity));
        peaks.arrive(velocity, &seen, &end_slopes);

        let done = zero.lt(finished.abs()).bits() & live;
        if done != 0 {
            let mut rest = done;
            while rest != 0 {
                let lane = rest.trailing_zeros() as usize;
                rest &= rest - 1;
                results[sample[lane]] = harvest::<V, M, N>(
                    lane,
                    finished.lanes()[lane],
                    &y,
                    &peaks,
                    seen[4].lanes()[lane],
                );
                counts.attempts += attempts.lanes()[lane] as u64;
                counts.descents += 1;
                counts.evaluations += 1;
                finished.lanes_mut()[lane] = RUNNING;
                attempts.lanes_mut()[lane] = 0.0;
                peaks.clear_lane(lane);
                match next_possible(batch, results, &mut next) {
                    Some((index, constants)) => {
                        sample[lane] = index;
                        load::<V, M, N>(&mut model, lane, &constants, &mut y, &mut h, &mut leg);
                    }
                    None => live &= !(1 << lane),
                }
            }
            let any = any_cross(model.constants());
            model.set_any_cross(any);
            // The refilled lanes' right-hand sides are evaluated with all the others' again.
            continue;
        }

        // The step: to the end of the interval if it is near, half-way if two steps reach it.
        let length = model.constants().length;
        let remaining = V::select(in_length, length - y[0], limit - y[N - 1]);
        let half = V::splat(0.5) * remaining;
        let wanted = V::select(h.lt(half), h, half);
        let last = remaining.lt(h * V::splat(1.05));
        let tried = V::select(last, remaining, wanted);

        let step = rosenbrock::step(&model, &y, &moment, tried);
        attempts = attempts + one;
        let error = model.error(&step) * inverse_tolerance;
        // error^(-1/4), the embedded method being of order 3.
        let growth = V::splat(SAFETY) / error.max(V::splat(1e-8)).sqrt().sqrt();
        let growth = V::splat(0.2).max(V::splat(5.0).min(growth));
        let good = error.le(one);
        let end_velocity = M::velocity(&step.moment);

        let over_line = in_length.not().and(length.le(step.state[0]));
        let over_time = in_length.and(leg.lt(V::splat(2.5))).and(limit.le(step.state[N - 1]));
        let accepted = good.and(over_line.not()).and(over_time.not());
        let pace = model.clock().pace(velocity);
        let start_slopes = model.observable_rates(&moment, step.slopes[0] * pace / tried);
        peaks.stepped(
            V::select(accepted, tried, zero),
            model.clock(),
            one / pace,
            &start_slopes,
            step.slopes[1],
        );
        for (old, &new) in y.iter_mut().zip(&step.state) {
            *old = V::select(accepted, new, *old);
        }
        let arrived = accepted.and(last);
        finished =
            V::select(arrived, V::select(in_length, V::splat(DEPLOYED), V::splat(LATE)), finished);

        // Not a number in the error: `growth` is then 0.2, as `max` and `min` give their second operand.
        h = tried * V::select(good, growth, growth.min(V::splat(0.8)));
        let settled = accepted
            .and(leg.lt(V::splat(0.5)))
            .and(M::imbalance(&step.moment).lt(V::splat(SETTLED)));
        let into_line = good.and(over_line);
        let into_time = good.and(over_time);
        h = V::select(settled, h * end_velocity, h);
        h = V::select(into_line, length - y[0], h);
        h = V::select(into_time, limit - y[N - 1], h);
        leg = V::select(settled, V::splat(PAYING_OUT), leg);
        let late = V::splat(1.5).lt(leg);
        leg = V::select(into_line, V::select(late, V::splat(LANDING), V::splat(PAYING_OUT)), leg);
        leg = V::select(into_time, V::splat(RUNNING_LATE), leg);

        let rejected = u64::from((accepted.not().bits() & live).count_ones());
        counts.rejected += rejected;
        counts.evaluations += STAGES as u64 * u64::from(live.count_ones()) - rejected;
        let position = V::select(in_length, y[0], y[N - 1]).abs();
        let tiny = position.mul_add(V::splat(FINEST), V::splat(f64::MIN_POSITIVE));
        let many = V::splat(MOST_STEPS).le(attempts);
        let stuck = tiny.lt(h).not().or(many).and(arrived.not());
        if stuck.any() {
            let fault = V::select(many, V::splat(MANY), V::splat(SMALL));
            finished = V::select(stuck, fault, finished);
        }
    }
    counts
}

/// The next descent that is possible; the impossible ones before it get their fault.
fn next_possible(
    batch: &[Coefficients<f64>],
    results: &mut [Result<Outcome, Fault>],
    next: &mut usize,
) -> Option<(usize, Constants<f64>)> {
    while *next < batch.len() {
        let index = *next;
        *next += 1;
        match Constants::new(&batch[index]) {
            Some(constants) => return Some((index, constants)),
            None => results[index] = Err(Fault::ImpossibleInput),
        }
    }
    None
}

fn load<V: Lanes, M: Model<V, N>, const N: usize>(
    model: &mut M,
    lane: usize,
    constants: &Constants<f64>,
    y: &mut [V; N],
    h: &mut V,
    leg: &mut V,
) {
    model.constants().set_lane(lane, constants);
    let start = M::start(constants);
    for (variable, value) in y.iter_mut().zip(start.state) {
        variable.lanes_mut()[lane] = value;
    }
    h.lanes_mut()[lane] = start.step;
    leg.lanes_mut()[lane] = if start.in_length { PAYING_OUT } else { STARTING };
}

fn any_cross<V: Lanes>(constants: &Constants<V>) -> bool {
    constants.cross_on.lanes().iter().any(|&on| on > 0.5)
}

/// Turns a lane that has ended into its result.
fn harvest<V: Lanes, M: Model<V, N>, const N: usize>(
    lane: usize,
    finished: f64,
    y: &[V; N],
    peaks: &Peaks<V>,
    velocity: f64,
) -> Result<Outcome, Fault> {
    let state: [f64; N] = std::array::from_fn(|n| y[n].lanes()[lane]);
    let top: [f64; OBSERVABLES] = std::array::from_fn(|n| peaks.values[n].lanes()[lane]);
    let deployed = finished == DEPLOYED;
    // A run in line length may land by a rounding beyond the limit; one in time ends on it.
    let time = if deployed { state[N - 1].min(TIME_LIMIT_S) } else { TIME_LIMIT_S };
    let values = [
        time,
        velocity,
        top[0],
        top[1],
        top[2].sqrt(),
        top[3],
        top[4],
        state[M::FLUID],
        state[M::FLUID + 1],
        state[M::FLUID + 2],
    ];
    if !values.iter().chain(&state).all(|value| value.is_finite()) {
        Err(Fault::NotFinite)
    } else if finished == MANY {
        Err(Fault::TooManySteps)
    } else if finished == SMALL {
        Err(Fault::StepTooSmall)
    } else {
        Ok(Outcome { deployed, values })
    }
}
