//! What the kernel's loop asks of a model besides its equations.
//!
//! # The error norm
//! A step's embedded error is weighted by what it does to the outcomes, all as relative changes:
//! - time against the total time as estimated from here (twice that in the quasi-steady model, where it
//!   decides alone), line against its length;
//! - a kelvin in the rotors changes the velocity by `b = B/Tv²` to the end, and the time with it: weight
//!   0.8 b. A kelvin in the fluid is forgotten within C1/(K12 + K13), some six seconds, but for the heat that
//!   it leaves in the rotors: weight 0.15 b, rising to 1.15 b at the end of the line, where it meets the final
//!   velocity;
//! - the brake's pull `z` is forgotten within the fast time constant: 1 % of its relative error, rising to
//!   31 % at the end of the line; the centre's velocity through the drag's share in the load, 30 %.
//!
//! The weights were scanned on 3 000 members each of the default study and of the stress set for the fewest
//! steps at equal worst error. The pull's decides most: at 10 %, a sixth more steps at the same
//! error, spent on digits of the start-up transient; at 0.1 %, the time of runaways loses a digit. The others
//! may be halved or doubled.

use super::clock::Clock;
use super::constants::Constants;
use super::dynamic::{self, Dynamic};
use super::observables::OBSERVABLES;
use super::quasi_steady::{self, QuasiSteady};
use super::rosenbrock::{Step, System};
use crate::descent::model::Model as Kind;
use crate::numerics::elementary;
use crate::numerics::lanes::Lanes;

/// How a lane starts.
pub struct Start<const N: usize> {
    /// State.
    pub state: [f64; N],
    /// First step to try, in the clock.
    pub step: f64,
    /// Whether the clock is line length from the start.
    pub in_length: bool,
}

/// A model as the kernel's loop drives it. The first state variable is line length, the last is time.
pub trait Model<V: Lanes, const N: usize>: System<V, N> {
    /// Which model.
    const KIND: Kind;
    /// Where the temperatures begin in the state.
    const FLUID: usize;
    /// All lanes with the same constants.
    fn new(constants: &Constants<f64>) -> Self;
    /// The lanes' constants.
    fn constants(&mut self) -> &mut Constants<V>;
    /// The lanes' clocks.
    fn clock(&mut self) -> &mut Clock<V>;
    /// Says whether any lane's fluid thins with shear.
    fn set_any_cross(&mut self, any: bool);
    /// The start of a descent.
    fn start(constants: &Constants<f64>) -> Start<N>;
    /// Relative velocity at a moment.
    fn velocity(moment: &Self::Moment) -> V;
    /// The force not yet balanced, over the load.
    fn imbalance(moment: &Self::Moment) -> V;
    /// Observables at a moment.
    fn observe(&self, y: &[V; N], moment: &Self::Moment) -> [V; OBSERVABLES];
    /// Their derivatives in time, given that of the stiff variable.
    fn observable_rates(&self, moment: &Self::Moment, stiff_rate: V) -> [V; OBSERVABLES];
    /// The weighted error of a step, to be compared with the tolerance; see the module.
    fn error(&self, step: &Step<Self::Moment, V, N>) -> V;
}

/// How near the end of the line is, from 0 (far) to 1: the 32nd power of the line's share, which rises
/// within the last few per cent.
#[inline(always)]
fn nearness<V: Lanes>(share: V) -> V {
    let mut late = share;
    for _ in 0..5 {
        late = late * late;
    }
    late
}

/// Weighted error of the temperatures of fluid and rotors.
#[inline(always)]
fn heat<V: Lanes>(late: V, fluid: V, rotor: V) -> V {
    (V::splat(0.15) + late).mul_add(fluid.abs(), V::splat(0.8) * rotor.abs())
}

impl<V: Lanes> Model<V, { dynamic::STATES }> for Dynamic<V> {
    const KIND: Kind = Kind::Dynamic;
    const FLUID: usize = 3;

    fn new(constants: &Constants<f64>) -> Self {
        let zero = V::splat(0.0);
        let clock = Clock { length: zero, time: V::splat(1.0) };
        Dynamic { constants: Constants::splat(constants), clock, any_cross: false }
    }
    #[inline(always)]
    fn constants(&mut self) -> &mut Constants<V> {
        &mut self.constants
    }
    #[inline(always)]
    fn clock(&mut self) -> &mut Clock<V> {
        &mut self.clock
    }
    fn set_any_cross(&mut self, any: bool) {
        self.any_cross = any;
    }

    /// At rest on the line. The first step is a fraction of the fast time constant
    /// `(M η (1 − η) + J/p)/κ`, or of the time that the load alone would need for the whole line.
    fn start(k: &Constants<f64>) -> Start<{ dynamic::STATES }> {
        let warm = k.initial_temperature;
        let thickening = elementary::exp(-k.minus_viscosity_temperature / warm);
        let p = k.full_radius_squared;
        let mass = k.total_mass * k.payload_share * (1.0 - k.payload_share) + k.inertia / p;
        let relaxation = mass * p / (k.torque * thickening);
        let free_fall = (k.length * mass / k.weight).sqrt();
        let step = 0.3 * if relaxation < free_fall { relaxation } else { 0.1 * free_fall };
        let state = [0.0, k.rise_speed, 0.0, warm, warm, warm, 0.0];
        Start { state, step, in_length: false }
    }

    #[inline(always)]
    fn velocity(moment: &dynamic::Moment<V>) -> V {
        moment.v
    }
    #[inline(always)]
    fn imbalance(moment: &dynamic::Moment<V>) -> V {
        moment.force.abs() / moment.load
    }
    #[inline(always)]
    fn observe(&self, y: &[V; 7], moment: &dynamic::Moment<V>) -> [V; OBSERVABLES] {
        Dynamic::observe(self, y, moment)
    }
    #[inline(always)]
    fn observable_rates(&self, moment: &dynamic::Moment<V>, stiff_rate: V) -> [V; OBSERVABLES] {
        Dynamic::observable_rates(self, moment, stiff_rate)
    }

    #[inline(always)]
    fn error(&self, step: &Step<dynamic::Moment<V>, V, 7>) -> V {
        let k = &self.constants;
        let e = &step.error;
        let m = &step.moment;
        let remaining = k.length - step.state[0];
        let total = step.state[6] + remaining / m.v;
        let b = m.velocity_per_kelvin();
        let late = nearness(step.state[0] / k.length);
        let pull = V::splat(0.3).mul_add(late, V::splat(0.01));
        let time = e[6].abs() / total;
        let line = e[0].abs() / k.length;
        let heat = b * heat(late, e[3], e[4]);
        let centre = V::splat(0.3) * e[1].abs() * m.drag_per_load();
        let brake = pull * e[2].abs() / m.load;
        ((time + line) + heat) + (centre + brake)
    }
}

impl<V: Lanes> Model<V, { quasi_steady::STATES }> for QuasiSteady<V> {
    const KIND: Kind = Kind::QuasiSteady;
    const FLUID: usize = 1;

    fn new(constants: &Constants<f64>) -> Self {
        let zero = V::splat(0.0);
        let clock = Clock { length: V::splat(1.0), time: zero };
        QuasiSteady { constants: Constants::splat(constants), clock, any_cross: false }
    }
    #[inline(always)]
    fn constants(&mut self) -> &mut Constants<V> {
        &mut self.constants
    }
    #[inline(always)]
    fn clock(&mut self) -> &mut Clock<V> {
        &mut self.clock
    }
    fn set_any_cross(&mut self, any: bool) {
        self.any_cross = any;
    }

    fn start(k: &Constants<f64>) -> Start<{ quasi_steady::STATES }> {
        let warm = k.initial_temperature;
        let state = [0.0, warm, warm, warm, 0.0];
        Start { state, step: 0.01 * k.length, in_length: true }
    }
    #[inline(always)]
    fn velocity(moment: &quasi_steady::Moment<V>) -> V {
        moment.v
    }
    #[inline(always)]
    fn imbalance(_: &quasi_steady::Moment<V>) -> V {
        V::splat(0.0)
    }
    #[inline(always)]
    fn observe(&self, y: &[V; 5], moment: &quasi_steady::Moment<V>) -> [V; OBSERVABLES] {
        QuasiSteady::observe(self, y, moment)
    }
    #[inline(always)]
    fn observable_rates(&self, moment: &quasi_steady::Moment<V>, _: V) -> [V; OBSERVABLES] {
        QuasiSteady::observable_rates(self, moment)
    }
    #[inline(always)]
    fn error(&self, step: &Step<quasi_steady::Moment<V>, V, 5>) -> V {
        let k = &self.constants;
        let e = &step.error;
        let m = &step.moment;
        let remaining = k.length - step.state[0];
        let total = step.state[4] + remaining / m.v;
        let late = nearness(step.state[0] / k.length);
        let b = m.velocity_per_kelvin();
        let time = V::splat(2.0) * e[4].abs() / total;
        let line = e[0].abs() / k.length;
        let heat = b * heat(late, e[1], e[2]);
        (time + line) + heat
    }
}
