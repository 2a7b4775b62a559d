//! The plain integrator: slow, adaptive, and obviously right. It stays as the oracle of the fast one,
//! draws trajectories, and decides samples that lie too near a limit for the fast one to be trusted.
//!
//! Every number it reports is the end of a full Radau step: the end of the line and every interior
//! maximum are found by repeating the step they fall into with another length, so that nothing is
//! read off an interpolant of lower order.

mod detailed;
pub mod radau;
mod systems;

use super::model::Model;
use super::outcome::{Fault, OUTCOME_COUNT, Outcome, OutcomeQuantity, TIME_LIMIT_S};
use crate::physics::Coefficients;
use crate::physics::motion::Observation;
use crate::physics::quasi_steady::Pull;
use crate::physics::space::Space;
use radau::{Start, Tolerance};
pub use systems::ReelDown;
use systems::{Dynamic, QuasiSteady};

/// The tolerance at which the outcomes are right to about 1e-9: what "reference" means.
pub const REFERENCE_TOLERANCE: f64 = 1e-9;

/// Steps after which a descent is given up.
const STEP_LIMIT: usize = 200_000;
/// The first step attempted, s; far below the fast time constant, error control lengthens it.
const FIRST_STEP_S: f64 = 1e-4;
/// A step shorter than this share of the time reached cannot be resolved.
const SMALLEST_STEP_SHARE: f64 = 1e-13;
/// The end of the line is placed to this share of the tolerance, which the stages' own error allows.
const EVENT_SHARE: f64 = 1e-2;
/// Secant or bisection steps to place an event; each at least halves the bracket.
const EVENT_ITERATIONS: usize = 60;

/// One moment of a computed descent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Time since release, s.
    pub time_s: f64,
    /// Line paid out, m.
    pub line_m: f64,
    /// Temperatures of fluid, rotors, housing, K.
    pub temperatures_k: [f64; 3],
    /// Upward velocity of the tow balloon, m/s; none in the quasi-steady model.
    pub balloon_velocity_m_per_s: Option<f64>,
    /// Brake torque, N·m.
    pub torque_nm: f64,
    /// Fluid temperature, tension, reel speed, power, separation velocity.
    pub observation: Observation<f64>,
}

/// A descent and the moments it went through: the accepted steps, both ends included.
#[derive(Debug, Clone)]
pub struct Trajectory {
    /// What it ended in.
    pub outcome: Outcome,
    /// The moments, in order of time.
    pub samples: Vec<Sample>,
}

/// Integrates one descent. `tolerance` is the relative tolerance of a step (see
/// [`REFERENCE_TOLERANCE`]).
///
/// # Errors
/// A [`Fault`] when the descent cannot be integrated; never a panic, whatever the coefficients.
pub fn descend(c: &Coefficients<f64>, model: Model, tolerance: f64) -> Result<Outcome, Fault> {
    follow(c, model, Pull::Payload, (tolerance, f64::INFINITY), &mut |_| ())
}

/// Integrates one descent and keeps its trajectory, with steps no longer than `longest_step_s`.
///
/// # Errors
/// As [`descend`].
pub fn trajectory(
    c: &Coefficients<f64>,
    model: Model,
    tolerance: f64,
    longest_step_s: f64,
) -> Result<Trajectory, Fault> {
    let mut samples = Vec::new();
    let mut keep = |sample| samples.push(sample);
    let outcome = follow(c, model, Pull::Payload, (tolerance, longest_step_s), &mut keep)?;
    Ok(Trajectory { outcome, samples })
}

/// Integrates one run on the horizontal rig, quasi-steadily, and keeps its trajectory.
///
/// # Errors
/// As [`descend`].
pub fn rig(
    c: &Coefficients<f64>,
    pull: Pull<f64>,
    tolerance: f64,
    longest_step_s: f64,
) -> Result<Trajectory, Fault> {
    let mut samples = Vec::new();
    let mut keep = |sample| samples.push(sample);
    let outcome = follow(c, Model::QuasiSteady, pull, (tolerance, longest_step_s), &mut keep)?;
    Ok(Trajectory { outcome, samples })
}

/// Integrates with a model; the dynamic ones are pulled by the payload, whatever `pull` is.
fn follow(
    c: &Coefficients<f64>,
    model: Model,
    pull: Pull<f64>,
    (tolerance, longest_step_s): (f64, f64),
    keep: &mut dyn FnMut(Sample),
) -> Result<Outcome, Fault> {
    match model {
        Model::Dynamic => run(&Dynamic::new(c), tolerance, longest_step_s, keep),
        Model::QuasiSteady => run(&QuasiSteady::new(c, pull), tolerance, longest_step_s, keep),
        Model::DetailedDynamic => {
            let space = Space::<7, 4>::new::<7>();
            let system = detailed::Dynamic::<7, 4, 32>::new(c, space);
            run(&system, tolerance, longest_step_s, keep)
        }
        Model::DetailedQuasiSteady => {
            let space = Space::<7, 4>::new::<7>();
            let system = detailed::QuasiSteady::<7, 4, 30>::new(c, pull, space);
            run(&system, tolerance, longest_step_s, keep)
        }
    }
}

/// The running maxima of the readings.
struct Peaks(Observation<f64>);

impl Peaks {
    fn note(&mut self, observation: &Observation<f64>) {
        for (peak, &value) in self.0.iter_mut().zip(observation) {
            *peak = peak.max(value);
        }
    }
}

fn run<const N: usize>(
    system: &impl ReelDown<N>,
    relative: f64,
    longest_step_s: f64,
    keep: &mut dyn FnMut(Sample),
) -> Result<Outcome, Fault> {
    let tolerance = Tolerance { relative, floor: system.floor() };
    let length = system.line_length_m();
    let mut start = Start::new(system, 0.0, system.initial());
    let mut moment = system.moment(&start.state);
    if !moment.rates.iter().chain(&moment.observation).all(|value| value.is_finite()) {
        return Err(Fault::ImpossibleInput);
    }
    let mut trends = system.trends(&start.state);
    let mut peaks = Peaks(moment.observation);
    keep(sample(system, &start));
    let mut h = FIRST_STEP_S.min(longest_step_s);
    for _ in 0..STEP_LIMIT {
        if h < SMALLEST_STEP_SHARE * start.time.max(FIRST_STEP_S) {
            return Err(Fault::StepTooSmall);
        }
        let last = start.time + h >= TIME_LIMIT_S;
        let attempted = if last { TIME_LIMIT_S - start.time } else { h };
        let Some(step) = radau::attempt(system, &start, attempted, &tolerance) else {
            h *= 0.5;
            continue;
        };
        if step.error > 1.0 {
            h = attempted * radau::growth(step.error);
            continue;
        }
        let mut taken = attempted;
        let mut state = step.state;
        let deployed = state[0] >= length;
        if deployed {
            (taken, state) = end_of_line(system, &start, attempted, state, length, &tolerance)
                .ok_or(Fault::StepTooSmall)?;
        }
        let end_trends = system.trends(&state);
        for reading in 0..trends.len() {
            if trends[reading] > 0.0 && end_trends[reading] < 0.0 {
                let top = maximum(system, &start, taken, reading, &tolerance)
                    .ok_or(Fault::StepTooSmall)?;
                peaks.note(&top);
            }
        }
        let time = start.time + taken;
        start = Start::new(system, time, state);
        moment = system.moment(&state);
        if !moment.rates.iter().all(|rate| rate.is_finite()) {
            return Err(Fault::NotFinite);
        }
        peaks.note(&moment.observation);
        keep(sample(system, &start));
        if deployed || last {
            let temperatures = system.temperatures_k(&state);
            return Ok(outcome(deployed, time, temperatures, &moment.observation, &peaks));
        }
        trends = end_trends;
        h = (attempted * radau::growth(step.error)).min(longest_step_s);
    }
    Err(Fault::TooManySteps)
}

/// The step's length and state at which the line is out: Newton's method on the length of line, whose
/// rate is known, kept inside its bracket by bisection; each iterate is a full step.
fn end_of_line<const N: usize>(
    system: &impl ReelDown<N>,
    start: &Start<N>,
    attempted: f64,
    beyond: [f64; N],
    length: f64,
    tolerance: &Tolerance<N>,
) -> Option<(f64, [f64; N])> {
    let (mut low, mut high) = (0.0, attempted);
    let (mut h, mut state) = (attempted, beyond);
    for _ in 0..EVENT_ITERATIONS {
        if state[0] < length {
            low = h;
        } else {
            high = h;
        }
        let newton = h + (length - state[0]) / system.moment(&state).rates[0];
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - h).abs() <= EVENT_SHARE * tolerance.relative * (start.time + h) {
            return Some((h, state));
        }
        h = next;
        state = radau::attempt(system, start, h, tolerance)?.state;
    }
    None
}

/// The readings at the interior maximum of one of them, whose trend is positive at the step's start and
/// negative after `taken`: Illinois' regula falsi on the trend, each iterate a full step.
fn maximum<const N: usize>(
    system: &impl ReelDown<N>,
    start: &Start<N>,
    taken: f64,
    reading: usize,
    tolerance: &Tolerance<N>,
) -> Option<Observation<f64>> {
    let at = |h: f64| radau::attempt(system, start, h, tolerance).map(|step| step.state);
    let (mut low, mut low_trend) = (0.0, system.trends(&start.state)[reading]);
    let (mut high, mut high_trend) = (taken, system.trends(&at(taken)?)[reading]);
    let mut state = start.state;
    for _ in 0..EVENT_ITERATIONS {
        let middle = (low * high_trend - high * low_trend) / (high_trend - low_trend);
        if !(middle > low && middle < high) {
            break;
        }
        state = at(middle)?;
        let trend = system.trends(&state)[reading];
        if trend > 0.0 {
            (low, low_trend) = (middle, trend);
            high_trend *= 0.5;
        } else {
            (high, high_trend) = (middle, trend);
            low_trend *= 0.5;
        }
        // The value is flat here: an error of 1e-6 of the step in time is one of 1e-12 in the value.
        if high - low <= 1e-6 * taken || trend == 0.0 {
            break;
        }
    }
    Some(system.moment(&state).observation)
}

fn sample<const N: usize>(system: &impl ReelDown<N>, start: &Start<N>) -> Sample {
    let moment = system.moment(&start.state);
    let state = &start.state;
    Sample {
        time_s: start.time,
        line_m: state[0],
        temperatures_k: system.temperatures_k(state),
        balloon_velocity_m_per_s: system.balloon_velocity_m_per_s(state),
        torque_nm: moment.torque_nm,
        observation: moment.observation,
    }
}

fn outcome(
    deployed: bool,
    time: f64,
    [fluid_k, rotor_k, housing_k]: [f64; 3],
    last: &Observation<f64>,
    peaks: &Peaks,
) -> Outcome {
    let [fluid, tension, speed, power, velocity] = peaks.0;
    let mut values = [0.0; OUTCOME_COUNT];
    for (quantity, value) in [
        (OutcomeQuantity::Time, time),
        (OutcomeQuantity::FinalVelocity, last[4]),
        (OutcomeQuantity::PeakFluidTemperature, fluid),
        (OutcomeQuantity::PeakTension, tension),
        (OutcomeQuantity::PeakReelSpeed, speed),
        (OutcomeQuantity::PeakPower, power),
        (OutcomeQuantity::PeakVelocity, velocity),
        (OutcomeQuantity::FinalFluidTemperature, fluid_k),
        (OutcomeQuantity::FinalRotorTemperature, rotor_k),
        (OutcomeQuantity::FinalHousingTemperature, housing_k),
    ] {
        values[quantity as usize] = value;
    }
    Outcome { deployed, values }
}
