//! The two models as systems of equations, their Jacobians by forward-mode derivatives.

use super::radau::Equations;
use crate::numerics::dual::Dual;
use crate::physics::Coefficients;
use crate::physics::motion::{self, DynamicState, Moment, Observation};
use crate::physics::quasi_steady::{self, Pull, QuasiSteadyState};

/// A model of the reel-down over `N` states, the first of which is the line paid out.
pub trait ReelDown<const N: usize>: Equations<N> {
    /// The state at release.
    fn initial(&self) -> [f64; N];
    /// Rates and readings at a moment.
    fn moment(&self, state: &[f64; N]) -> Moment<[f64; N], f64>;
    /// Time derivatives of the readings along the motion.
    fn trends(&self, state: &[f64; N]) -> Observation<f64>;
    /// Sizes below which a state's error counts absolutely.
    fn floor(&self) -> [f64; N];
    /// Line length, m.
    fn line_length_m(&self) -> f64;
    /// Temperatures of fluid, rotors and housing, K; means where the model resolves them.
    fn temperatures_k(&self, state: &[f64; N]) -> [f64; 3] {
        [state[N - 3], state[N - 2], state[N - 1]]
    }
    /// Upward velocity of the tow balloon, m/s; none where nothing accelerates.
    fn balloon_velocity_m_per_s(&self, _: &[f64; N]) -> Option<f64> {
        None
    }
}

/// The dynamic model of one descent.
#[derive(Debug, Clone)]
pub struct Dynamic {
    plain: Coefficients<f64>,
    dual: Coefficients<Dual<6>>,
}

/// The quasi-steady model of one descent or rig run.
#[derive(Debug, Clone)]
pub struct QuasiSteady {
    plain: Coefficients<f64>,
    dual: Coefficients<Dual<4>>,
    pull: Pull<f64>,
}

/// Velocities below this count absolutely, m/s.
pub(super) const VELOCITY_FLOOR: f64 = 0.1;
/// Temperatures below this count absolutely, K.
pub(super) const TEMPERATURE_FLOOR: f64 = 100.0;
/// Lengths of line below this count absolutely, m.
pub(super) const LINE_FLOOR: f64 = 1.0;

impl Dynamic {
    /// The dynamic model with the given constants.
    pub fn new(coefficients: &Coefficients<f64>) -> Self {
        Dynamic { plain: *coefficients, dual: coefficients.lift() }
    }
}

impl QuasiSteady {
    /// The quasi-steady model with the given constants and pull.
    pub fn new(coefficients: &Coefficients<f64>, pull: Pull<f64>) -> Self {
        QuasiSteady { plain: *coefficients, dual: coefficients.lift(), pull }
    }

    fn dual_pull(&self) -> Pull<Dual<4>> {
        use crate::numerics::real::Real;
        match self.pull {
            Pull::Payload => Pull::Payload,
            Pull::Force(force) => Pull::Force(Dual::constant(force)),
            Pull::Speed(speed) => Pull::Speed(Dual::constant(speed)),
            Pull::Power(power) => Pull::Power(Dual::constant(power)),
        }
    }
}

/// Each state as the variable of its own direction.
pub(super) fn variables<const N: usize>(state: &[f64; N]) -> [Dual<N>; N] {
    std::array::from_fn(|k| Dual::variable(state[k], k))
}

/// The derivative of readings along `rates`: gradient times velocity.
pub(super) fn along<const N: usize>(
    readings: &Observation<Dual<N>>,
    rates: &[f64; N],
) -> Observation<f64> {
    readings.map(|reading| reading.slopes.iter().zip(rates).map(|(s, r)| s * r).sum())
}

impl Equations<6> for Dynamic {
    fn rates(&self, _: f64, state: &DynamicState<f64>) -> DynamicState<f64> {
        motion::moment(&self.plain, state).rates
    }
    fn jacobian(&self, _: f64, state: &DynamicState<f64>) -> [[f64; 6]; 6] {
        motion::moment(&self.dual, &variables(state)).rates.map(|rate| rate.slopes)
    }
}

impl ReelDown<6> for Dynamic {
    fn balloon_velocity_m_per_s(&self, state: &DynamicState<f64>) -> Option<f64> {
        Some(state[1])
    }
    fn initial(&self) -> DynamicState<f64> {
        motion::initial(&self.plain)
    }
    fn moment(&self, state: &DynamicState<f64>) -> Moment<DynamicState<f64>, f64> {
        motion::moment(&self.plain, state)
    }
    fn trends(&self, state: &DynamicState<f64>) -> Observation<f64> {
        let moment = motion::moment(&self.dual, &variables(state));
        along(&moment.observation, &moment.rates.map(|rate| rate.value))
    }
    fn floor(&self) -> [f64; 6] {
        [
            LINE_FLOOR,
            VELOCITY_FLOOR,
            VELOCITY_FLOOR,
            TEMPERATURE_FLOOR,
            TEMPERATURE_FLOOR,
            TEMPERATURE_FLOOR,
        ]
    }
    fn line_length_m(&self) -> f64 {
        self.plain.reel.line_length_m
    }
}

impl Equations<4> for QuasiSteady {
    fn rates(&self, _: f64, state: &QuasiSteadyState<f64>) -> QuasiSteadyState<f64> {
        quasi_steady::moment(&self.plain, self.pull, state).rates
    }
    fn jacobian(&self, _: f64, state: &QuasiSteadyState<f64>) -> [[f64; 4]; 4] {
        let moment = quasi_steady::moment(&self.dual, self.dual_pull(), &variables(state));
        moment.rates.map(|rate| rate.slopes)
    }
}

impl ReelDown<4> for QuasiSteady {
    fn initial(&self) -> QuasiSteadyState<f64> {
        quasi_steady::initial(&self.plain)
    }
    fn moment(&self, state: &QuasiSteadyState<f64>) -> Moment<QuasiSteadyState<f64>, f64> {
        quasi_steady::moment(&self.plain, self.pull, state)
    }
    fn trends(&self, state: &QuasiSteadyState<f64>) -> Observation<f64> {
        let moment = quasi_steady::moment(&self.dual, self.dual_pull(), &variables(state));
        along(&moment.observation, &moment.rates.map(|rate| rate.value))
    }
    fn floor(&self) -> [f64; 4] {
        [LINE_FLOOR, TEMPERATURE_FLOOR, TEMPERATURE_FLOOR, TEMPERATURE_FLOOR]
    }
    fn line_length_m(&self) -> f64 {
        self.plain.reel.line_length_m
    }
}
