//! The detailed quasi-steady model over lanes.

use super::brake::{Detailed, Fresh, Moment, field_of, fill, lean, put};
use super::linear::Factored;
use crate::descent::model::Model as Kind;
use crate::descent::vector::clock::Clock;
use crate::descent::vector::constants::Constants;
use crate::descent::vector::leg::PAYING_OUT;
use crate::descent::vector::model::{Model, nearness};
use crate::descent::vector::observables::OBSERVABLES;
use crate::descent::vector::rosenbrock::{Step, System};
use crate::descent::vector::settings::Attempt;
use crate::descent::vector::start::{Start, warming_step};
use crate::numerics::lanes::elementary::exp;
use crate::numerics::lanes::{Lanes, Wide};
use crate::physics::film;

/// The detailed quasi-steady model: `P K + 3` states.
pub struct QuasiSteady<V, const P: usize, const K: usize>(Detailed<V, P, K>);

impl<V: Lanes, const P: usize, const K: usize, const N: usize> System<V, N>
    for QuasiSteady<V, P, K>
{
    // Nothing is stiff here that is looked at; line length stands in.
    const STIFF: usize = 0;
    type Moment = Moment<V, P, K, N>;
    type Factored = Factored<V, P, K>;

    #[inline(always)]
    fn moment(&self, y: &[V; N]) -> Moment<V, P, K, N> {
        let k = &self.0.constants;
        let (zero, one) = (V::splat(0.0), V::splat(1.0));
        let l = y[0];
        let p = k.radius_slope.neg_mul_add(l, k.full_radius_squared);
        let radius = p.sqrt();
        let load = k.extraction.neg_mul_add(l, k.weight);
        let field = field_of(y, 1);
        let heat = self.0.heat(&field, y[N - 2], |brake, faces, thickening| {
            let target = film::Demand::Torque(Wide((load * radius) * k.inverse_torque));
            let film = brake.film();
            let newtonian = film::speed_of(&film, faces, thickening, target, None).0;
            if !brake.any_cross {
                return newtonian;
            }
            let thinned = film::speed_of(&film, faces, thickening, target, brake.cross()).0;
            V::select(V::splat(0.5).lt(k.cross_on), thinned, newtonian)
        });
        let v = heat.speed * radius;
        let g = one / self.0.clock.pace(v);
        let mut rates = [g; N];
        rates[0] = v * g;
        fill(&mut rates, 1, &heat, g);
        Moment {
            rates,
            heat,
            v,
            p,
            pull: load,
            pull_by_v: zero,
            load,
            force: zero,
            inverse_q: zero,
            eta: zero,
            drag_slope: zero,
            lift: zero,
        }
    }

    #[inline(always)]
    fn rates(moment: &Moment<V, P, K, N>) -> [V; N] {
        moment.rates
    }

    #[inline(always)]
    fn factor(
        &self,
        _: &[V; N],
        m: &Moment<V, P, K, N>,
        h_gamma: V,
        inverse_h_gamma: V,
    ) -> Factored<V, P, K> {
        let k = &self.0.constants;
        let (zero, one) = (V::splat(0.0), V::splat(1.0));
        let c = self.0.clock.pace(m.v) * inverse_h_gamma;
        // (1 + η) u_v/v + ((s/2p)(2 + η) + x/W) u_l − A3 = 0, with η the mean of ε over the torque.
        let lean = lean(&m.heat);
        let half_slope = V::splat(0.5) * (k.radius_slope / m.p);
        let by_line = half_slope.mul_add(V::splat(2.0) + lean, k.extraction / m.load);
        let row = [(one + lean) / m.v, by_line, zero, -one];
        self.0.factor(m, 1, (h_gamma, c), (zero, [zero; 3], row))
    }

    #[inline(always)]
    fn solve(f: &Factored<V, P, K>, r: &[V; N]) -> [V; N] {
        let ([line, ..], field, housing, time) = f.solve(r, 1);
        let mut u = [time; N];
        u[0] = line;
        put(&mut u, 1, &field, housing);
        u
    }
}

impl<V: Lanes, const P: usize, const K: usize, const N: usize> Model<V, N> for QuasiSteady<V, P, K>
where
    Detailed<V, P, K>: Fresh<V>,
{
    const KIND: Kind = Kind::DetailedQuasiSteady;

    #[inline(always)]
    fn constants(&mut self) -> &mut Constants<V> {
        &mut self.0.constants
    }
    #[inline(always)]
    fn clock(&self) -> &Clock<V> {
        &self.0.clock
    }
    #[inline(always)]
    fn set_clock(&mut self, clock: Clock<V>) {
        self.0.clock = clock;
    }
    #[inline(always)]
    fn thins(&self) -> Option<V> {
        self.0.any_cross.then_some(self.0.constants.cross_on)
    }
    fn set_any_cross(&mut self, any: bool) {
        self.0.any_cross = any;
    }
    #[inline(always)]
    fn velocity(moment: &Moment<V, P, K, N>) -> V {
        moment.v
    }
    #[inline(always)]
    fn rate(moment: &Moment<V, P, K, N>) -> V {
        moment.rates[N - 1]
    }
    #[inline(always)]
    fn temperatures(&self, y: &[V; N]) -> [V; 3] {
        let [fluid, metal] = self.0.means(&field_of(y, 1));
        [fluid, metal, y[N - 2]]
    }

    #[inline(always)]
    fn new(constants: Constants<V>) -> Self {
        let clock = Clock { length: V::splat(1.0), time: V::splat(0.0) };
        QuasiSteady(Detailed::fresh(constants, clock))
    }

    #[inline(always)]
    fn start(k: &Constants<V>, attempt: &Attempt) -> Start<V, N> {
        let mut state = [k.initial_temperature; N];
        state[0] = V::splat(0.0);
        state[N - 1] = V::splat(0.0);
        let fluidity = exp(k.minus_viscosity_temperature / k.initial_temperature);
        let velocity = k.full_radius_squared * k.weight * (k.inverse_torque * fluidity);
        let peaks = [V::splat(f64::NEG_INFINITY); OBSERVABLES];
        let step = warming_step(k, velocity) * V::splat(attempt.first_step.unwrap_or(1.0));
        Start { state, leg: V::splat(PAYING_OUT), step, peaks, settled: V::splat(0.0) }
    }

    #[inline(always)]
    fn settled(moment: &Moment<V, P, K, N>, _: V) -> V::Mask {
        moment.v.le(moment.v)
    }

    #[inline(always)]
    fn observe(&self, y: &[V; N], m: &Moment<V, P, K, N>) -> [V; OBSERVABLES] {
        let w = m.v / m.p;
        let (hottest, _) = Detailed::<V, P, K>::hottest(&field_of(y, 1), None);
        [hottest, m.load, m.v * w, m.load * m.v, m.v]
    }

    #[inline(always)]
    fn observable_rates(&self, m: &Moment<V, P, K, N>, y: &[V; N], _: V) -> [V; OBSERVABLES] {
        let k = &self.0.constants;
        let one = V::splat(1.0);
        let w = m.v / m.p;
        let load_rate = -(k.extraction * m.v);
        // From the balance: y (1 + η) v̇/v = Ẇ − (what the field and the reel do to y).
        let soft = m.softening_rate(k, &self.0.space);
        let v_rate = (m.v * (load_rate - soft)) / (m.load * (one + lean(&m.heat)));
        let (_, hottest_rate) =
            Detailed::<V, P, K>::hottest(&field_of(y, 1), Some(&m.heat.heating.field));
        [
            hottest_rate,
            load_rate,
            w * (k.radius_slope * w).mul_add(m.v, v_rate + v_rate),
            m.load.mul_add(v_rate, load_rate * m.v),
            v_rate,
        ]
    }

    #[inline(always)]
    fn error(&self, step: &Step<Moment<V, P, K, N>, V, N>) -> V {
        let k = &self.0.constants;
        let (e, m) = (&step.error, &step.moment);
        let late = nearness(step.state[0] * k.inverse_length);
        let total = step.state[N - 1].mul_add(m.v, k.length - step.state[0]);
        let time = V::splat(2.0) * (e[N - 1].abs() * m.v) / total;
        let heat = m.heat_error(&self.0.space, e, 1, late);
        e[0].abs().mul_add(k.inverse_length, time) + heat
    }
}
