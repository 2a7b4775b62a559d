//! Lanes that step, each at its own pace: one descent in each.

use super::clock::Clock;
use super::leg::{LANDING, PAYING_OUT, RUNNING_LATE};
use super::model::Model;
use super::observables::{OBSERVABLES, Peaks};
use super::possible::Possible;
use super::rosenbrock;
use super::settings::{Attempt, IMPOSSIBLE_SLACK};
use super::start::Start;
use crate::descent::outcome::{Fault, Outcome, TIME_LIMIT_S};
use crate::numerics::lanes::elementary::inverse_fourth_root;
use crate::numerics::lanes::{Lanes, Mask};

/// Widest lane type: two AVX-512 registers.
pub const WIDEST: usize = 16;

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

/// As many descents as there are lanes.
pub struct Group<V, M, const N: usize> {
    /// The lanes' equations.
    pub model: M,
    /// State.
    pub state: [V; N],
    /// Step to try next, in the clock.
    pub step: V,
    /// Part of the descent.
    pub leg: V,
    /// Step attempts so far.
    pub attempts: V,
    /// 1 where a lane was put at a start after the others' moments were evaluated, so that it has none.
    fresh: V,
    /// How the lane has finished, if it has.
    finished: V,
    /// Until when the state is not that of the descent yet, s.
    settled: V,
    peaks: Peaks<V>,
    /// Observables at the state.
    seen: [V; OBSERVABLES],
    inverse_tolerance: V,
    /// What the descents may end in.
    possible: [Possible<f64>; WIDEST],
    attempt: Attempt,
}

impl<V: Lanes, M: Model<V, N>, const N: usize> Group<V, M, N> {
    /// Every lane at its start.
    #[inline(always)]
    pub fn new(model: M, start: &Start<V, N>, attempt: Attempt) -> Self {
        let zero = V::splat(0.0);
        Group {
            model,
            state: start.state,
            step: start.step,
            leg: start.leg,
            attempts: zero,
            fresh: zero,
            finished: zero,
            settled: start.settled,
            peaks: Peaks::new(start.peaks, attempt.tolerance),
            seen: [zero; OBSERVABLES],
            inverse_tolerance: V::splat(1.0 / attempt.local_tolerance(M::KIND)),
            possible: [Possible::ANYTHING; WIDEST],
            attempt,
        }
    }

    /// Puts one lane at the start that others' lane `from` has; the model's constants are the caller's business.
    /// Until the next [`Self::look`], steps leave it where it is: one idle step of a lane costs a third of
    /// what evaluating every lane again does.
    #[inline(always)]
    pub fn restart(
        &mut self,
        lane: usize,
        starts: &Start<V, N>,
        possible: Possible<f64>,
        from: usize,
    ) {
        self.possible[lane] = possible;
        for (variable, others) in self.state.iter_mut().zip(&starts.state) {
            variable.lanes_mut()[lane] = others.lanes()[from];
        }
        self.step.lanes_mut()[lane] = starts.step.lanes()[from];
        self.leg.lanes_mut()[lane] = starts.leg.lanes()[from];
        self.attempts.lanes_mut()[lane] = 0.0;
        self.fresh.lanes_mut()[lane] = 1.0;
        self.finished.lanes_mut()[lane] = RUNNING;
        self.settled.lanes_mut()[lane] = starts.settled.lanes()[from];
        self.peaks.restart(lane, &starts.peaks, from);
    }

    /// The lanes whose clock is line length.
    #[inline(always)]
    fn in_length(&self) -> V::Mask {
        let leg = self.leg;
        V::splat(0.5).lt(leg).and(leg.lt(V::splat(1.5))).or(V::splat(2.5).lt(leg))
    }

    /// Evaluates the right-hand side and takes in the observables where the lanes stand.
    #[inline(always)]
    pub fn look(&mut self) -> M::Moment {
        let (zero, one) = (V::splat(0.0), V::splat(1.0));
        let in_length = self.in_length();
        self.model.set_clock(Clock {
            length: V::select(in_length, one, zero),
            time: V::select(in_length, zero, one),
        });
        self.fresh = zero;
        let moment = self.model.moment(&self.state);
        self.seen = self.model.observe(&self.state, &moment);
        let velocity = M::velocity(&moment);
        let slopes =
            self.model.observable_rates(&moment, &self.state, self.peaks.stiff_rate(velocity));
        // Within the initial layer a start beyond it is not the descent's own state: nothing is there to be seen.
        let real = self.settled.le(self.state[N - 1]);
        let thins = self.model.thins();
        self.peaks.arrive(real, velocity, &self.seen, &slopes, thins);
        moment
    }

    /// Bit `k` is set where lane `k` has finished.
    #[inline(always)]
    pub fn finished(&self) -> u32 {
        V::splat(0.0).lt(self.finished.abs()).bits()
    }

    /// Tries one step in every lane from where it stands, whose moment is given; fresh lanes stay. Bit `k`
    /// of the first result is set where lane `k` tried, of the second where it accepted.
    #[inline(always)]
    pub fn advance(&mut self, moment: &M::Moment) -> (u32, u32) {
        let (zero, one) = (V::splat(0.0), V::splat(1.0));
        let limit = V::splat(TIME_LIMIT_S);
        let (y, leg) = (&mut self.state, self.leg);
        let in_length = V::splat(0.5).lt(leg).and(leg.lt(V::splat(1.5))).or(V::splat(2.5).lt(leg));

        // The step: to the end of the interval if it is near, half-way if two steps reach it.
        let length = self.model.constants().length;
        let remaining = V::select(in_length, length - y[0], limit - y[N - 1]);
        let half = V::splat(0.5) * remaining;
        let wanted = self.step.min(half).detached();
        let last = remaining.lt(self.step * V::splat(1.05));
        let tried = V::select(last, remaining, wanted);

        let step = rosenbrock::step(&self.model, y, moment, tried);
        let trying = self.fresh.lt(V::splat(0.5));
        self.attempts = self.attempts + (one - self.fresh);
        let error = self.model.error(&step) * self.inverse_tolerance;
        // The embedded method is of order 3. What is not a number counts as an error of 1e8.
        let size = V::splat(1e-8).max(error.min(V::splat(1e8)));
        let growth = V::splat(SAFETY) * inverse_fourth_root(size);
        let growth = V::splat(0.2).max(V::splat(5.0).min(growth));
        let good = error.le(one).and(trying);

        let over_line = in_length.not().and(length.le(step.state[0]));
        let over_time = in_length.and(leg.lt(V::splat(2.5))).and(limit.le(step.state[N - 1]));
        let accepted = good.and(over_line.not()).and(over_time.not());
        let pace = self.model.clock().pace(M::velocity(moment));
        let slopes = self.model.observable_rates(moment, y, step.slopes[0] * pace);
        self.peaks.stepped(
            V::select(accepted, tried, zero),
            self.model.clock(),
            M::rate(moment),
            &slopes,
            step.slopes[1],
        );
        for (old, &new) in y.iter_mut().zip(&step.state) {
            *old = V::select(accepted, new, *old);
        }
        let arrived = accepted.and(last);
        let how = V::select(in_length, V::splat(DEPLOYED), V::splat(LATE));
        self.finished = V::select(arrived, how, self.finished);

        let mut h = tried * V::select(good, growth, growth.min(V::splat(0.8)));
        let settled =
            accepted.and(leg.lt(V::splat(0.5))).and(M::settled(&step.moment, V::splat(SETTLED)));
        let into_line = good.and(over_line);
        let into_time = good.and(over_time);
        h = V::select(settled, h * M::velocity(&step.moment), h);
        h = V::select(into_line, length - y[0], h);
        h = V::select(into_time, limit - y[N - 1], h);
        self.step = V::select(trying, h, self.step);
        let late = V::splat(1.5).lt(leg);
        let to_the_end = V::select(late, V::splat(LANDING), V::splat(PAYING_OUT));
        let leg = V::select(settled, V::splat(PAYING_OUT), leg);
        let leg = V::select(into_line, to_the_end, leg);
        self.leg = V::select(into_time, V::splat(RUNNING_LATE), leg);

        let position = V::select(in_length, y[0], y[N - 1]).abs();
        let tiny = position.mul_add(V::splat(FINEST), V::splat(f64::MIN_POSITIVE));
        let many = V::splat(MOST_STEPS).le(self.attempts);
        let stuck = tiny.lt(h).not().or(many).and(arrived.not()).and(trying);
        if stuck.any() {
            let fault = V::select(many, V::splat(MANY), V::splat(SMALL));
            self.finished = V::select(stuck, fault, self.finished);
        }
        (trying.bits(), accepted.bits())
    }

    /// Time, velocity, the five peaks and the three temperatures, in the order of
    /// [`Outcome::values`].
    #[inline(always)]
    pub fn outcomes(&self) -> [V; 10] {
        outcomes(
            self.state[N - 1],
            self.model.temperatures(&self.state),
            self.finished,
            &self.seen,
            &self.peaks.values,
        )
    }

    /// What became of a lane that has finished, and whether it is worth a second look: it is impossible, its peaks are
    /// in doubt, or its points in space are too few.
    #[inline(always)]
    pub fn result(&self, lane: usize) -> (Result<Outcome, Fault>, bool) {
        let of = |value: &V| value.lanes()[lane];
        let how = of(&self.finished);
        let temperatures = self.model.temperatures(&self.state).each_ref().map(of);
        let (time, seen) = (of(&self.state[N - 1]), self.seen.each_ref().map(of));
        let peaks = self.peaks.values.each_ref().map(of);
        let values = outcomes(time, temperatures, how, &seen, &peaks);
        if how == MANY {
            return (Err(Fault::TooManySteps), true);
        }
        let slack = IMPOSSIBLE_SLACK * self.attempt.tolerance;
        let result = if self.possible[lane].admits(&values, slack) && how != SMALL {
            Ok(Outcome { deployed: how == DEPLOYED, values })
        } else if how == SMALL {
            Err(Fault::StepTooSmall)
        } else if values.iter().all(|value| value.is_finite()) {
            Err(Fault::Inaccurate)
        } else {
            Err(Fault::NotFinite)
        };
        let coarse = !self.attempt.fine_space && !self.possible[lane].resolves(&values);
        (result, result.is_err() || self.peaks.doubtful(lane) || coarse)
    }
}

/// The outcomes of the lanes, or of one of them, in the order of [`Outcome::values`].
#[inline(always)]
fn outcomes<T: Lanes>(
    time: T,
    [fluid, rotor, housing]: [T; 3],
    finished: T,
    seen: &[T; OBSERVABLES],
    peaks: &[T; OBSERVABLES],
) -> [T; 10] {
    // A run in line length may land by a rounding beyond the limit; one in time ends on it.
    let limit = T::splat(TIME_LIMIT_S);
    [
        T::select(finished.lt(T::splat(1.5)), time.min(limit), limit),
        seen[4],
        peaks[0],
        peaks[1],
        peaks[2].sqrt(),
        peaks[3],
        peaks[4],
        fluid,
        rotor,
        housing,
    ]
}
