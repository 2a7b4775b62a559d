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
use super::initial_layer;
use super::observables::OBSERVABLES;
use super::quasi_steady::{self, QuasiSteady};
use super::rosenbrock::{Step, System};
use super::settings::Attempt;
use super::start::{self, Start};
use crate::descent::model::Model as Kind;
use crate::numerics::lanes::{Lanes, Mask};

/// A model as the kernel's loop drives it. The first state variable is line length, the last is time.
pub trait Model<V: Lanes, const N: usize>: System<V, N> {
    /// Which model.
    const KIND: Kind;
    /// The model with the lanes' constants.
    fn new(constants: Constants<V>) -> Self;
    /// The lanes' constants.
    fn constants(&mut self) -> &mut Constants<V>;
    /// The lanes' clocks.
    fn clock(&self) -> &Clock<V>;
    /// Sets the lanes' clocks.
    fn set_clock(&mut self, clock: Clock<V>);
    /// 1 where the fluid thins with shear, if it does in any lane.
    fn thins(&self) -> Option<V>;
    /// Says whether any lane's fluid thins with shear.
    fn set_any_cross(&mut self, any: bool);
    /// Where descents with these constants start.
    fn start(constants: &Constants<V>, attempt: &Attempt) -> Start<V, N>;
    /// Relative velocity at a moment.
    fn velocity(moment: &Self::Moment) -> V;
    /// Time per clock at a moment.
    fn rate(moment: &Self::Moment) -> V;
    /// Whether the force not yet balanced is below a share of the load.
    fn settled(moment: &Self::Moment, share: V) -> V::Mask;
    /// Observables at a moment.
    fn observe(&self, y: &[V; N], moment: &Self::Moment) -> [V; OBSERVABLES];
    /// Their derivatives in time at a state with its moment, given that of the stiff variable.
    fn observable_rates(
        &self,
        moment: &Self::Moment,
        y: &[V; N],
        stiff_rate: V,
    ) -> [V; OBSERVABLES];
    /// Temperatures of fluid, rotors and housing, K; means where the model resolves them.
    fn temperatures(&self, y: &[V; N]) -> [V; 3];
    /// The weighted error of a step, to be compared with the tolerance; see the module.
    fn error(&self, step: &Step<Self::Moment, V, N>) -> V;
}

/// How near the end of the line is, from 0 (far) to 1: the 32nd power of the line's share, which rises
/// within the last few per cent.
#[inline(always)]
pub(super) fn nearness<V: Lanes>(share: V) -> V {
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

    #[inline(always)]
    fn new(constants: Constants<V>) -> Self {
        let clock = Clock { length: V::splat(0.0), time: V::splat(1.0) };
        Dynamic { constants, clock, any_cross: false }
    }
    #[inline(always)]
    fn constants(&mut self) -> &mut Constants<V> {
        &mut self.constants
    }
    #[inline(always)]
    fn clock(&self) -> &Clock<V> {
        &self.clock
    }
    #[inline(always)]
    fn set_clock(&mut self, clock: Clock<V>) {
        self.clock = clock;
    }
    #[inline(always)]
    fn thins(&self) -> Option<V> {
        self.any_cross.then_some(self.constants.cross_on)
    }
    fn set_any_cross(&mut self, any: bool) {
        self.any_cross = any;
    }

    #[inline(always)]
    fn start(constants: &Constants<V>, attempt: &Attempt) -> Start<V, { dynamic::STATES }> {
        let at_rest = start::at_rest(constants);
        match attempt.first_step {
            Some(share) => at_rest.with_step(share),
            None => {
                let tolerance = attempt.local_tolerance(Self::KIND);
                let (fits, beyond) = initial_layer::passed(constants, tolerance);
                Start::select(fits, beyond, at_rest)
            }
        }
    }

    #[inline(always)]
    fn velocity(moment: &dynamic::Moment<V>) -> V {
        moment.v
    }
    #[inline(always)]
    fn rate(moment: &dynamic::Moment<V>) -> V {
        moment.rates[6]
    }
    #[inline(always)]
    fn settled(moment: &dynamic::Moment<V>, share: V) -> V::Mask {
        moment.force.abs().lt(share * moment.load)
    }
    #[inline(always)]
    fn observe(&self, y: &[V; 7], moment: &dynamic::Moment<V>) -> [V; OBSERVABLES] {
        Dynamic::observe(self, y, moment)
    }
    #[inline(always)]
    fn observable_rates(
        &self,
        moment: &dynamic::Moment<V>,
        _: &[V; 7],
        stiff_rate: V,
    ) -> [V; OBSERVABLES] {
        Dynamic::observable_rates(self, moment, stiff_rate)
    }
    #[inline(always)]
    fn temperatures(&self, y: &[V; 7]) -> [V; 3] {
        [y[3], y[4], y[5]]
    }

    #[inline(always)]
    fn error(&self, step: &Step<dynamic::Moment<V>, V, 7>) -> V {
        let k = &self.constants;
        let e = &step.error;
        let m = &step.moment;
        let [line, .., time] = step.state;
        let late = nearness(line * k.inverse_length);
        // Over the total time as estimated from here, t + (L − l)/v, and over the load; one division.
        let total = time.mul_add(m.v, k.length - line);
        let shared = V::splat(1.0) / (total * m.load);
        let time = (e[6].abs() * m.v) * (shared * m.load);
        // A share of the pull's error lasts: what the way and the heat of one fast time constant make of it.
        let mut lasting = V::splat(0.01);
        let (lag, slow) = self.lag(m);
        let loose = (lasting * slow).lt(lag);
        if loose.any() {
            lasting = V::select(loose, lag / slow, lasting).min(V::splat(1.0));
        }
        let brake = V::splat(0.3).mul_add(late, lasting) * e[2].abs();
        let centre = V::splat(0.3) * e[1].abs();
        let force = centre.mul_add(m.drag_share(), brake) * (shared * total);
        let heat = m.velocity_per_kelvin() * heat(late, e[3], e[4]);
        e[0].abs().mul_add(k.inverse_length, time) + (heat + force)
    }
}

impl<V: Lanes> Model<V, { quasi_steady::STATES }> for QuasiSteady<V> {
    const KIND: Kind = Kind::QuasiSteady;

    #[inline(always)]
    fn new(constants: Constants<V>) -> Self {
        let clock = Clock { length: V::splat(1.0), time: V::splat(0.0) };
        QuasiSteady { constants, clock, any_cross: false }
    }
    #[inline(always)]
    fn constants(&mut self) -> &mut Constants<V> {
        &mut self.constants
    }
    #[inline(always)]
    fn clock(&self) -> &Clock<V> {
        &self.clock
    }
    #[inline(always)]
    fn set_clock(&mut self, clock: Clock<V>) {
        self.clock = clock;
    }
    #[inline(always)]
    fn thins(&self) -> Option<V> {
        self.any_cross.then_some(self.constants.cross_on)
    }
    fn set_any_cross(&mut self, any: bool) {
        self.any_cross = any;
    }

    #[inline(always)]
    fn start(constants: &Constants<V>, attempt: &Attempt) -> Start<V, { quasi_steady::STATES }> {
        let start = start::in_balance(constants);
        attempt.first_step.map_or(start, |share| start.with_step(share))
    }

    #[inline(always)]
    fn velocity(moment: &quasi_steady::Moment<V>) -> V {
        moment.v
    }
    #[inline(always)]
    fn rate(moment: &quasi_steady::Moment<V>) -> V {
        moment.rates[4]
    }
    #[inline(always)]
    fn settled(moment: &quasi_steady::Moment<V>, _: V) -> V::Mask {
        moment.v.le(moment.v)
    }
    #[inline(always)]
    fn observe(&self, y: &[V; 5], moment: &quasi_steady::Moment<V>) -> [V; OBSERVABLES] {
        QuasiSteady::observe(self, y, moment)
    }
    #[inline(always)]
    fn observable_rates(
        &self,
        moment: &quasi_steady::Moment<V>,
        _: &[V; 5],
        _: V,
    ) -> [V; OBSERVABLES] {
        QuasiSteady::observable_rates(self, moment)
    }
    #[inline(always)]
    fn temperatures(&self, y: &[V; 5]) -> [V; 3] {
        [y[1], y[2], y[3]]
    }
    #[inline(always)]
    fn error(&self, step: &Step<quasi_steady::Moment<V>, V, 5>) -> V {
        let k = &self.constants;
        let e = &step.error;
        let m = &step.moment;
        let [line, .., time] = step.state;
        let late = nearness(line * k.inverse_length);
        let total = time.mul_add(m.v, k.length - line);
        let time = V::splat(2.0) * (e[4].abs() * m.v) / total;
        let heat = m.velocity_per_kelvin() * heat(late, e[1], e[2]);
        e[0].abs().mul_add(k.inverse_length, time) + heat
    }
}
