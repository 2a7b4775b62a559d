//! The detailed dynamic model over lanes.

use super::brake::{Detailed, Fresh, Moment, field_of, fill, lean, put};
use super::linear::Factored;
use crate::descent::model::Model as Kind;
use crate::descent::vector::clock::Clock;
use crate::descent::vector::constants::Constants;
use crate::descent::vector::leg::STARTING;
use crate::descent::vector::model::{Model, nearness};
use crate::descent::vector::observables::OBSERVABLES;
use crate::descent::vector::rosenbrock::{Step, System};
use crate::descent::vector::settings::Attempt;
use crate::descent::vector::start::{Start, at_rest};
use crate::numerics::lanes::Lanes;

/// The detailed dynamic model: `P K + 5` states.
pub struct Dynamic<V, const P: usize, const K: usize>(Detailed<V, P, K>);

impl<V: Lanes, const P: usize, const K: usize, const N: usize> System<V, N> for Dynamic<V, P, K> {
    const STIFF: usize = 2;
    type Moment = Moment<V, P, K, N>;
    type Factored = Factored<V, P, K>;

    #[inline(always)]
    fn moment(&self, y: &[V; N]) -> Moment<V, P, K, N> {
        let k = &self.0.constants;
        let one = V::splat(1.0);
        let (l, centre, v) = (y[0], y[1], y[2]);
        let p = k.radius_slope.neg_mul_add(l, k.full_radius_squared);
        let inverse_p = one / p;
        let w = v * inverse_p;
        let field = field_of(y, 3);
        let heat = self.0.heat(&field, y[N - 2], |_, _, _| w * p.sqrt());
        let lean = lean(&heat);
        let pull_per_w = k.torque * heat.shear.stiffness.0;
        let pull = pull_per_w * w;
        let eta = k.share_slope.neg_mul_add(l, k.payload_share);
        let balloon = eta.mul_add(v, centre);
        let drag_speed = k.drag * balloon.abs();
        let lift = drag_speed.neg_mul_add(balloon, k.free_lift);
        let load = k.extraction.neg_mul_add(l, k.weight);
        let spool = k.spool_pull * w;
        let force = eta.mul_add(lift, load) - spool.mul_add(w, pull);
        let reduced_mass = k.total_mass * eta.neg_mul_add(eta, eta);
        let q = p.mul_add(reduced_mass, k.inertia);
        let pace = self.0.clock.pace(v);
        let shared = one / (q * pace);
        let g = shared * q;
        let inverse_q = shared * pace;
        let centre_rate = (k.share_slope * v).mul_add(v, k.inverse_mass * lift);
        let mut rates = [g; N];
        rates[0] = v * g;
        rates[1] = centre_rate * g;
        rates[2] = ((p * inverse_q) * force) * g;
        fill(&mut rates, 3, &heat, g);
        Moment {
            rates,
            heat,
            v,
            p,
            pull,
            pull_by_v: (pull_per_w * inverse_p) * (one + lean),
            load,
            force,
            inverse_q,
            eta,
            drag_slope: drag_speed + drag_speed,
            lift,
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
        let one = V::splat(1.0);
        let alpha = self.0.clock.length;
        let pace = self.0.clock.pace(m.v);
        let c = pace * inverse_h_gamma;
        let s = k.radius_slope;
        // Centre: (c + D'/M) u_U + (D'/M)(η u_v − η' v u_l) − 2 σ v u_v + α F_U u_v = G r_U, with u_l given by u_v.
        let drag_rate = m.drag_slope * k.inverse_mass;
        let inverse_centre = one / (c + drag_rate);
        let line_by_v = alpha.neg_mul_add(m.rates[0], one) / c;
        let centre_line = drag_rate * (k.share_slope * m.v);
        let two_shift = (k.share_slope + k.share_slope) * m.v;
        let centre_v = centre_line.mul_add(
            line_by_v,
            alpha.neg_mul_add(m.rates[1], drag_rate.neg_mul_add(m.eta, two_shift)),
        );
        let centre = [
            pace * inverse_centre,
            (centre_line * h_gamma) * inverse_centre,
            centre_v * inverse_centre,
        ];
        // Velocity: c u_v − dn N − n dN + α F_v u_v = G r_v.
        let n = m.p * m.inverse_q;
        let w = m.v / m.p;
        let mass_slope = k.total_mass * (k.share_slope * (m.eta + m.eta - one));
        let n_line = -((n * n).mul_add(mass_slope, (k.inertia * s) * (m.inverse_q * m.inverse_q)));
        let per_p = one / m.p;
        let half_slope = V::splat(0.5) * (s * per_p);
        let pull_line = half_slope * m.pull_by_v.mul_add(m.v, m.pull);
        let jsw = k.inertia * (s * w);
        // dN by u_l, u_U, u_v and A3.
        let force_line = {
            let direct = k.share_slope.mul_add(m.lift, k.extraction);
            let drag = (m.eta * m.drag_slope) * (k.share_slope * m.v);
            drag - direct - pull_line - jsw * (w * (s * per_p))
        };
        let force_v = -((m.eta * m.eta).mul_add(m.drag_slope, m.pull_by_v) + jsw * per_p);
        let own_v = n.neg_mul_add(force_v, alpha.mul_add(m.rates[2], c));
        let by_line = -n_line.mul_add(m.force, n * force_line);
        let by_centre = n * (m.eta * m.drag_slope);
        let by_heat = -(n * m.pull);
        self.0.factor(m, 3, (h_gamma, c), (pace, centre, [own_v, by_line, by_centre, by_heat]))
    }

    #[inline(always)]
    fn solve(f: &Factored<V, P, K>, r: &[V; N]) -> [V; N] {
        let ([line, centre, velocity], field, housing, time) = f.solve(r, 3);
        let mut u = [time; N];
        (u[0], u[1], u[2]) = (line, centre, velocity);
        put(&mut u, 3, &field, housing);
        u
    }
}

impl<V: Lanes, const P: usize, const K: usize, const N: usize> Model<V, N> for Dynamic<V, P, K>
where
    Detailed<V, P, K>: Fresh<V>,
{
    const KIND: Kind = Kind::DetailedDynamic;

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
        let [fluid, metal] = self.0.means(&field_of(y, 3));
        [fluid, metal, y[N - 2]]
    }

    #[inline(always)]
    fn new(constants: Constants<V>) -> Self {
        let clock = Clock { length: V::splat(0.0), time: V::splat(1.0) };
        Dynamic(Detailed::fresh(constants, clock))
    }

    /// At rest on the line, both bodies rising, as the three-node model starts.
    #[inline(always)]
    fn start(k: &Constants<V>, attempt: &Attempt) -> Start<V, N> {
        let rest = at_rest(k);
        let mut state = [k.initial_temperature; N];
        state[0] = V::splat(0.0);
        state[1] = k.rise_speed;
        state[2] = V::splat(0.0);
        state[N - 1] = V::splat(0.0);
        Start {
            state,
            leg: V::splat(STARTING),
            step: rest.step * V::splat(attempt.first_step.unwrap_or(1.0)),
            peaks: rest.peaks,
            settled: rest.settled,
        }
    }

    #[inline(always)]
    fn settled(moment: &Moment<V, P, K, N>, share: V) -> V::Mask {
        moment.force.abs().lt(share * moment.load)
    }

    #[inline(always)]
    fn observe(&self, y: &[V; N], m: &Moment<V, P, K, N>) -> [V; OBSERVABLES] {
        let k = &self.0.constants;
        let specific = m.force * m.inverse_q;
        let w = m.v / m.p;
        let brake = (k.spool_pull * w).mul_add(w, m.pull);
        let (hottest, _) = Detailed::<V, P, K>::hottest(&field_of(y, 3), None);
        [hottest, k.inertia.mul_add(specific, brake), (w * w) * m.p, m.pull * m.v, m.v]
    }

    #[inline(always)]
    fn observable_rates(&self, m: &Moment<V, P, K, N>, y: &[V; N], v_rate: V) -> [V; OBSERVABLES] {
        let k = &self.0.constants;
        let one = V::splat(1.0);
        let s = k.radius_slope;
        let pace = self.0.clock.pace(m.v);
        let w = m.v / m.p;
        let w_rate = (s * w).mul_add(w, v_rate / m.p);
        let specific = m.force * m.inverse_q;
        let spool = k.spool_pull * w;
        let pull_rate = m.pull_by_v.mul_add(v_rate, m.softening_rate(k, &self.0.space));
        let brake_rate = (spool + spool).mul_add(w_rate, pull_rate);
        let balloon_rate =
            m.eta.mul_add(v_rate, (k.share_slope * m.v).neg_mul_add(m.v, m.rates[1] * pace));
        let lift_rate = -(m.drag_slope * balloon_rate);
        let share_rate = -(k.share_slope * m.v);
        let force_rate = share_rate
            .mul_add(m.lift, m.eta.mul_add(lift_rate, -(k.extraction.mul_add(m.v, brake_rate))));
        let reduced = k.total_mass * m.eta.neg_mul_add(m.eta, m.eta);
        let reduced_rate = k.total_mass * (share_rate * (one - (m.eta + m.eta)));
        let q_rate = m.p.mul_add(reduced_rate, -((s * m.v) * reduced));
        let specific_rate = m.inverse_q * specific.neg_mul_add(q_rate, force_rate);
        let (_, hottest_rate) =
            Detailed::<V, P, K>::hottest(&field_of(y, 3), Some(&m.heat.heating.field));
        [
            hottest_rate,
            k.inertia.mul_add(specific_rate, brake_rate),
            w * (m.p + m.p).mul_add(w_rate, -((s * m.v) * w)),
            pull_rate.mul_add(m.v, m.pull * v_rate),
            v_rate,
        ]
    }

    #[inline(always)]
    fn error(&self, step: &Step<Moment<V, P, K, N>, V, N>) -> V {
        let k = &self.0.constants;
        let (e, m) = (&step.error, &step.moment);
        let late = nearness(step.state[0] * k.inverse_length);
        let total = step.state[N - 1].mul_add(m.v, k.length - step.state[0]);
        let shared = V::splat(1.0) / (total * m.load);
        let time = (e[N - 1].abs() * m.v) * (shared * m.load);
        let brake = (V::splat(0.3).mul_add(late, V::splat(0.01)) * e[2].abs()) * m.pull_by_v;
        let centre = V::splat(0.3) * e[1].abs();
        let force = centre.mul_add(m.eta * m.drag_slope, brake) * (shared * total);
        let heat = m.heat_error(&self.0.space, e, 3, late);
        e[0].abs().mul_add(k.inverse_length, time) + (heat + force)
    }
}
