//! The course of one run, or of as many side by side as the number type holds.

use super::record::{Correction, Drive, Record};
use super::{Reading, Settings};
use crate::numerics::real::Real;
use crate::physics::Coefficients;
use crate::physics::motion::Moment;
use crate::physics::quasi_steady::{QuasiSteadyState as State, moment};

/// The least that is applied, SI: from nothing at all, thinning fluids have no speed to start from.
const LEAST: f64 = 1e-9;
/// How far past its end the line is imagined to go on, as a share of its length.
const BEYOND_LINE: f64 = 0.05;
/// The same as a share of the length in which the reel would vanish.
const BEYOND_REEL: f64 = 0.5;

/// A run's equations.
struct Truck<'a, R> {
    drive: Drive,
    constants: &'a Coefficients<R>,
    correction: Correction<R>,
    /// The line that the reel keeps its radius from, m.
    furthest_m: R,
}

impl<'a, R: Real> Truck<'a, R> {
    #[inline(always)]
    fn new(drive: Drive, constants: &'a Coefficients<R>, correction: Correction<R>) -> Self {
        let number = R::constant;
        let reel = &constants.reel;
        let length = reel.line_length_m;
        let vanishes = reel.full_radius_squared_m2 / reel.squared_radius_slope_m;
        let by_line = number(1.0 + BEYOND_LINE) * length;
        let by_reel = number(BEYOND_REEL).mul_add(vanishes - length, length);
        Truck { drive, constants, correction, furthest_m: by_line.min(by_reel) }
    }

    /// Rates and readings with a value applied. Past the furthest the reel keeps its radius: predictions
    /// stay finite wherever a trial's line ends.
    #[inline(always)]
    fn at(&self, read: f64, state: &State<R>) -> Moment<State<R>, R> {
        let [line, fluid, rotor, housing] = *state;
        let Correction { gain, offset } = self.correction;
        let applied = gain.mul_add(R::constant(read.max(LEAST)), offset);
        // The larger of the two, by what the number type has.
        let pull = self.drive.pull(-(-applied).min(R::constant(-LEAST)));
        moment(self.constants, pull, &[line.min(self.furthest_m), fluid, rotor, housing])
    }
}

/// `state + h·rates`.
#[inline(always)]
fn ahead<R: Real>(state: &State<R>, rates: &State<R>, h: f64) -> State<R> {
    let h = R::constant(h);
    let mut next = *state;
    for i in 0..4 {
        next[i] = rates[i].mul_add(h, next[i]);
    }
    next
}

/// The classical Runge–Kutta method of order four: each stage's place in the step and its weight.
const STAGES: [(f64, f64); 4] =
    [(0.0, 1.0 / 6.0), (0.5, 1.0 / 3.0), (0.5, 1.0 / 3.0), (1.0, 1.0 / 6.0)];

/// Follows a run from the record's first time to its last and hands each time's reading to `keep`.
///
/// Steps end on the record's times, where the drive has its kinks. A reading costs nothing: it is the next
/// step's first stage. Everything is one loop over stages, so that the equations stand in the machine code
/// once: inlined once a stage, they took minutes to compile.
#[inline(always)]
pub(super) fn course<R: Real>(
    record: &Record,
    settings: &Settings,
    c: &Coefficients<R>,
    correction: Correction<R>,
    mut keep: impl FnMut(usize, Reading<R>),
) {
    let number = R::constant;
    let (times, values) = (record.times_s(), record.values());
    let truck = Truck::new(record.drive(), c, correction);
    let warm = |node: usize| c.initial_temperature_k + number(record.start_offsets_k[node]);
    let mut state = [number(0.0), warm(0), warm(1), warm(2)];
    let mut next = state;
    let mut rates = [number(0.0); 4];
    let (mut k, mut steps, mut done, mut stage) = (0, 0, 0, 0);
    let (mut h, mut slope) = (0.0, 0.0);
    loop {
        let (place, weight) = STAGES[stage];
        let applied = (done as f64 + place).mul_add(slope, values[k]);
        let now = truck.at(applied, &ahead(&state, &rates, place * h));
        if stage == 0 && done == 0 {
            let [_, force, _, _, speed] = now.observation;
            let temperatures_k = [state[1], state[2], state[3]];
            let line_m = state[0];
            keep(k, Reading { line_m, force_n: force, speed_m_per_s: speed, temperatures_k });
            let Some(&next_time) = times.get(k + 1) else { break };
            let interval = next_time - times[k];
            steps = settings.steps(interval);
            h = interval / steps as f64;
            slope = (values[k + 1] - values[k]) / steps as f64;
        }
        rates = now.rates;
        next = ahead(&next, &rates, weight * h);
        stage += 1;
        if stage == STAGES.len() {
            (state, stage, done) = (next, 0, done + 1);
            if done == steps {
                (k, done, slope) = (k + 1, 0, 0.0);
            }
        }
    }
}
