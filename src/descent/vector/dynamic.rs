//! The dynamic model in its slow variables, with the Newton matrix eliminated by hand.
//!
//! # Variables
//! The two velocities are replaced by the common centre's, `U = (m1 V1 + m2 V2)/M`, and by
//! `z = κ v`, the brake's pull on the line that a Newtonian fluid would give, where `v = V1 − V2`,
//! `κ = k θ/p`, `θ = exp(B/Tv)`, `p = R²` and `k` is the torque per reel speed in an infinitely hot fluid.
//! `M = m1 + m2` does not change, and `η = m2/M` is linear in `l`. With `w = v/p = z/(kθ)`, `R ω = v`:
//! ```text
//! l̇ = v = p w                              V1 = U + η v ,  E = free lift − D(V1)
//! U̇ = (E + (x/g) v²)/M                     x = Wx/L
//! v̇ = p N/Q ,  N = W2 − x l + η E − ½ J s w² − y ,  Q = p M η (1 − η) + J
//! ż = κ v̇ + z (s w − b Ṫv)                 b = B/Tv² ,  s = (Ro² − Ri²)/L
//! C1 Ṫ1 = y v − …                          the other nodes as in the paper
//! ```
//! `y = M/R` is `z` itself, or `z/(1 + (χ z R)^m)` with Cross fluidity: the Cross group `θ ω c` is a
//! function of `z R` alone. `v` follows the load in some 50 ms while the load changes over minutes; `z`
//! then stays near the almost linear `W2 − x l`, whereas `v` would follow temperature and radius and
//! cost the method its order. Nothing here needs a square root without Cross.
//!
//! The rates are multiplied by the clock's `g = dt/dτ = 1/G`, `G = α v + β` (see [`super::clock`]); one
//! division serves `Q`, `G` and `1/θ`, another `1/Tv`.
//!
//! # The step's linear system
//! `F = g f` has the Jacobian `g (J_f − α F ∇vᵀ)`. Divided by `g`, with `c = G/(hγ)`, every row reads
//! `c u_j − (∂f_j·u at fixed v) − (∂f_j/∂v − α F_j) u_v = G r_j`, `u_v = ∇v·u`, and `u_z` is given by `u_v`:
//! `u_z = κ u_v + z (s/p) u_l − z b u_Tv`. Taking `z s/p` times the row of `l` from that of `z` and adding
//! `z b` times those of `Tv` cancels every derivative of `Ṫv`; over `κ` what is left is
//! ```text
//! (c + α g v̇ − λ) u_v − ∂v̇·u − A_l u_l + A_T u_Tv = G (r_z/κ − s w r_l + v b r_Tv)
//! λ = s w − b Ṫv ,  A_l = s (N/Q + w λ) + s² w² ,  A_T = b (v̇ + λ v) − 2 v (b/Tv) Ṫv
//! ```
//! The rows of `l`, `U` and the temperatures give `u_l`, `u_U` and `u_T` as a combination of their own `r`
//! plus a multiple of `u_v`; put in, the row above yields `u_v = Σ ρ_j r_j` with six weights `ρ` that are
//! worked out once a step. A stage's solve is then some thirty multiply-adds without a division.

use super::clock::Clock;
use super::constants::Constants;
use super::observables::OBSERVABLES;
use super::rosenbrock::System;
use super::thermal;
use crate::numerics::lanes::Lanes;
use crate::numerics::lanes::elementary::{exp, ln};

/// Number of state variables: `l, U, z, T1, T2, T3, t`.
pub const STATES: usize = 7;

/// The dynamic model of as many descents as there are lanes.
pub struct Dynamic<V> {
    /// The lanes' constants.
    pub constants: Constants<V>,
    /// The lanes' clocks.
    pub clock: Clock<V>,
    /// Whether any lane's fluid thins with shear (a lane's bits do not depend on it).
    pub any_cross: bool,
}

/// A right-hand side's evaluation.
#[derive(Clone, Copy)]
pub struct Moment<V> {
    /// Rates in the clock.
    pub rates: [V; STATES],
    /// Relative velocity, and over `p`.
    pub v: V,
    /// `w = v/p = ω/R`.
    pub w: V,
    /// Squared radius.
    pub p: V,
    /// `N`, the force left to accelerate.
    pub force: V,
    /// Viscous pull `y = M/R`, N.
    pub pull: V,
    /// Weight hanging, N.
    pub load: V,
    inverse_q: V,
    fluidity: V,
    inverse_tv: V,
    b: V,
    eta: V,
    drag_slope: V,
    lift: V,
    tv_rate: V,
    pull_by_z: V,
    half_thinning: V,
}

/// What a step's solves share; see the module.
pub struct Factored<V> {
    h_gamma: V,
    weights: [V; 6],
    line_by_v: V,
    centre: [V; 3],
    heat: thermal::Solution<V>,
    z_by_v: V,
    z_by_line: V,
    z_by_fluid: V,
    z_by_rotor: V,
    time_by_v: V,
}

impl<V: Lanes> System<V, STATES> for Dynamic<V> {
    const STIFF: usize = 2;
    type Moment = Moment<V>;
    type Factored = Factored<V>;

    #[inline(always)]
    fn moment(&self, y: &[V; STATES]) -> Moment<V> {
        let k = &self.constants;
        let [l, centre, z, fluid, rotor, housing, _] = *y;
        let one = V::splat(1.0);
        let tv = k.averaging_offset.mul_add(fluid - rotor, fluid);
        let inverse_tv = one / tv;
        let fluidity = exp(k.minus_viscosity_temperature * inverse_tv);
        let p = k.radius_slope.neg_mul_add(l, k.full_radius_squared);
        let w = (z * k.inverse_torque) * fluidity;
        let v = p * w;
        let (pull, pull_by_z, half_thinning) = self.thinned(z, p);

        let eta = k.share_slope.neg_mul_add(l, k.payload_share);
        let balloon = eta.mul_add(v, centre);
        let drag_speed = k.drag * balloon.abs();
        let lift = drag_speed.neg_mul_add(balloon, k.free_lift);
        let load = k.extraction.neg_mul_add(l, k.weight);
        let spool = k.spool_pull * w;
        let force = eta.mul_add(lift, load) - spool.mul_add(w, pull);
        let reduced_mass = k.total_mass * eta.neg_mul_add(eta, eta);
        let q = p.mul_add(reduced_mass, k.inertia);
        let pace = self.clock.pace(v);

        let qe = q * fluidity;
        let inverse = one / (qe * pace);
        let g = inverse * qe;
        let pace_inverse = inverse * pace;
        let inverse_q = pace_inverse * fluidity;
        let pull_rate = (k.torque * force) * (q * pace_inverse) * inverse_q;

        let [fluid_rate, rotor_rate, housing_rate] =
            thermal::rates(k, fluid, rotor, housing, pull * v);
        let tv_rate = k.averaging_offset.mul_add(fluid_rate - rotor_rate, fluid_rate);
        let b = -(k.minus_viscosity_temperature * (inverse_tv * inverse_tv));
        let growth = b.neg_mul_add(tv_rate, k.radius_slope * w);
        let z_rate = z.mul_add(growth, pull_rate);
        let centre_rate = (k.share_slope * v).mul_add(v, k.inverse_mass * lift);
        Moment {
            rates: [
                v * g,
                centre_rate * g,
                z_rate * g,
                fluid_rate * g,
                rotor_rate * g,
                housing_rate * g,
                g,
            ],
            v,
            w,
            p,
            force,
            pull,
            load,
            inverse_q,
            fluidity,
            inverse_tv,
            b,
            eta,
            drag_slope: drag_speed + drag_speed,
            lift,
            tv_rate,
            pull_by_z,
            half_thinning,
        }
    }

    #[inline(always)]
    fn rates(moment: &Moment<V>) -> [V; STATES] {
        moment.rates
    }

    #[inline(always)]
    fn factor(
        &self,
        y: &[V; STATES],
        m: &Moment<V>,
        h_gamma: V,
        inverse_h_gamma: V,
    ) -> Factored<V> {
        let k = &self.constants;
        let one = V::splat(1.0);
        let z = y[2];
        let s = k.radius_slope;
        let alpha = self.clock.length;
        let pace = self.clock.pace(m.v);
        let [line_rate, centre_rate, _, fluid_rate, rotor_rate, housing_rate, g] = m.rates;
        let c = pace * inverse_h_gamma;
        let eps = k.averaging_offset;

        // Heat: the feedback of temperature at fixed velocity, and the columns of u_v and u_l.
        let zb = z * m.b;
        let feedback = k.inverse_fluid_capacity * (m.v * m.pull_by_z) * zb;
        let cofactors = thermal::cofactors(k, c, feedback);
        let centre_pivot = m.drag_slope.mul_add(k.inverse_mass, c);
        let joint = one / ((c * cofactors.determinant) * centre_pivot);
        let inverse_determinant = (c * centre_pivot) * joint;
        let inverse_centre = (c * cofactors.determinant) * joint;
        let inverse_c = (cofactors.determinant * centre_pivot) * joint;

        let line_by_v = alpha.neg_mul_add(line_rate, one) * inverse_c;
        let sw = s * m.w;
        let heat_line =
            k.inverse_fluid_capacity * (sw * z.mul_add(m.pull_by_z, m.half_thinning * m.pull));
        let heat_v = [
            heat_line.mul_add(
                line_by_v,
                alpha.neg_mul_add(
                    fluid_rate,
                    k.inverse_fluid_capacity * z.mul_add(m.pull_by_z, m.pull),
                ),
            ),
            -(alpha * rotor_rate),
            -(alpha * housing_rate),
        ];
        let mut heat = [[one; 3]; 3];
        let mut heat_by_line = [one; 3];
        let mut heat_by_v = [one; 3];
        let scale = inverse_determinant * pace;
        for i in 0..3 {
            let row = &cofactors.adjugate[i];
            for j in 0..3 {
                heat[i][j] = row[j] * scale;
            }
            heat_by_line[i] = (row[0] * inverse_determinant) * (heat_line * h_gamma);
            heat_by_v[i] = inverse_determinant
                * row[2].mul_add(heat_v[2], row[1].mul_add(heat_v[1], row[0] * heat_v[0]));
        }

        // Centre: (c + D'/M) u_U + (D'/M)(η u_v − η' v u_l) − 2 (x/gM) v u_v + α F_U u_v = G r_U.
        let drag_rate = m.drag_slope * k.inverse_mass;
        let centre_line = drag_rate * (k.share_slope * m.v);
        let two_shift = (k.share_slope + k.share_slope) * m.v;
        let centre_v = centre_line.mul_add(
            line_by_v,
            alpha.neg_mul_add(centre_rate, drag_rate.neg_mul_add(m.eta, two_shift)),
        );
        let centre = [
            pace * inverse_centre,
            (centre_line * h_gamma) * inverse_centre,
            centre_v * inverse_centre,
        ];

        // Relative velocity.
        let n = m.p * m.inverse_q;
        let v_rate = n * m.force;
        let specific = m.force * m.inverse_q;
        let lambda = m.b.neg_mul_add(m.tv_rate, sw);
        let jsw = k.inertia * sw;
        let per_pull = m.p * m.fluidity;
        let shared = one / (per_pull * m.p);
        let inverse_p = shared * per_pull;
        let kappa = k.torque * (shared * m.p);
        let mass_slope = k.total_mass * (k.share_slope * (m.eta + m.eta - one));
        let n_line = -((n * n).mul_add(mass_slope, (k.inertia * s) * (m.inverse_q * m.inverse_q)));
        let spread = s * m.w.mul_add(lambda, specific);
        let a_line = sw.mul_add(sw, spread);
        let two_b_rate = (m.b + m.b) * (m.v * (m.inverse_tv * m.tv_rate));
        let a_heat = m.b.mul_add(lambda.mul_add(m.v, v_rate), -two_b_rate);
        let nd = n * m.drag_slope;
        let by_v = {
            let stiff = m.pull_by_z * (n * kappa);
            let drag = (nd * m.eta).mul_add(m.eta, jsw * m.inverse_q);
            let own = alpha.mul_add(g * v_rate, c - lambda);
            own + (stiff + drag)
        };
        let by_line = {
            let direct = k.share_slope.mul_add(m.lift, k.extraction);
            let drag = (m.drag_slope * m.eta).mul_add(-(k.share_slope * m.v), direct);
            let spool = jsw.mul_add(sw, s * z.mul_add(m.pull_by_z, m.half_thinning * m.pull));
            n_line.neg_mul_add(m.force, n.mul_add(drag, m.inverse_q.mul_add(spool, -a_line)))
        };
        let by_centre = nd * m.eta;
        let by_heat = (n * m.pull_by_z).neg_mul_add(zb, a_heat);

        // u_Tv = (1 + ε) u_1 − ε u_2 as a combination of r and u_v.
        let heat_tv_v = thermal::blend(eps, heat_by_v[0], heat_by_v[1]);
        let pivot = by_heat
            .mul_add(heat_tv_v, by_centre.mul_add(centre[2], by_line.mul_add(line_by_v, by_v)));
        let inverse_pivot = one / pivot;
        let gvb = pace * (m.v * m.b);
        let weights = {
            let heat_row = [
                by_heat * thermal::blend(eps, heat[0][0], heat[1][0]),
                by_heat * thermal::blend(eps, heat[0][1], heat[1][1]),
                by_heat * thermal::blend(eps, heat[0][2], heat[1][2]),
            ];
            let line = by_heat.mul_add(
                thermal::blend(eps, heat_by_line[0], heat_by_line[1]),
                by_centre.mul_add(centre[1], by_line.mul_add(h_gamma, pace * sw)),
            );
            [
                -(line * inverse_pivot),
                -((by_centre * centre[0]) * inverse_pivot),
                (pace * (k.inverse_torque * per_pull)) * inverse_pivot,
                (gvb.mul_add(eps, gvb) - heat_row[0]) * inverse_pivot,
                -(gvb.mul_add(eps, heat_row[1]) * inverse_pivot),
                -(heat_row[2] * inverse_pivot),
            ]
        };
        Factored {
            h_gamma,
            weights,
            line_by_v,
            centre,
            heat: thermal::Solution { own: heat, by_line: heat_by_line, by_v: heat_by_v },
            z_by_v: kappa,
            z_by_line: (z * s) * inverse_p,
            z_by_fluid: -(zb.mul_add(eps, zb)),
            z_by_rotor: zb * eps,
            time_by_v: -((alpha * g) * inverse_c),
        }
    }

    #[inline(always)]
    fn solve(f: &Factored<V>, r: &[V; STATES]) -> [V; STATES] {
        let w = &f.weights;
        let u_v = w[2].mul_add(r[2], w[1].mul_add(r[1], w[0] * r[0]))
            + w[5].mul_add(r[5], w[4].mul_add(r[4], w[3] * r[3]));
        let u_l = f.line_by_v.mul_add(u_v, f.h_gamma * r[0]);
        let u_centre = f.centre[2].mul_add(u_v, f.centre[1].mul_add(r[0], f.centre[0] * r[1]));
        let [u_1, u_2, u_3] = f.heat.solve([r[0], r[3], r[4], r[5]], u_v);
        let u_z = f
            .z_by_rotor
            .mul_add(u_2, f.z_by_fluid.mul_add(u_1, f.z_by_line.mul_add(u_l, f.z_by_v * u_v)));
        let u_t = f.time_by_v.mul_add(u_v, f.h_gamma * r[6]);
        [u_l, u_centre, u_z, u_1, u_2, u_3, u_t]
    }
}

impl<V: Lanes> Moment<V> {
    /// `b = B/Tv²`: relative change of the velocity per kelvin.
    #[inline(always)]
    pub fn velocity_per_kelvin(&self) -> V {
        self.b
    }

    /// `η D'`: change of the load's counterpart per change of the centre's velocity, N·s/m.
    #[inline(always)]
    pub fn drag_share(&self) -> V {
        self.eta * self.drag_slope
    }
}

impl<V: Lanes> Dynamic<V> {
    /// Viscous pull `y`, its derivative in `z`, and `½ m X/(1 + X)` with `X` the Cross group's power:
    /// `∂y/∂l = y ½ m X/(1 + X) s/p`.
    #[inline(always)]
    fn thinned(&self, z: V, p: V) -> (V, V, V) {
        let one = V::splat(1.0);
        if !self.any_cross {
            return (z, one, V::splat(0.0));
        }
        let k = &self.constants;
        let on = V::splat(0.5).lt(k.cross_on);
        let group = (k.cross_group * z.abs() * p.sqrt()).max(V::splat(1e-300));
        let power = exp(k.cross_exponent * ln(group));
        let share = one / (one + power);
        let exponent = k.cross_exponent * (power * share);
        let slope = share * (one - exponent);
        (
            V::select(on, z * share, z),
            V::select(on, slope, one),
            V::select(on, V::splat(0.5) * exponent, V::splat(0.0)),
        )
    }

    /// What an error of the pull leaves behind after the fast time constant `1/λ`, as relative changes of time and
    /// velocity: `0.3 (v/L + ½ b y v/C1)/λ`, numerator and denominator apart (both times `θ⁻¹`), `λ` without the drag's part.
    #[inline(always)]
    pub fn lag(&self, m: &Moment<V>) -> (V, V) {
        let k = &self.constants;
        let heat = V::splat(0.15) * (m.b * (m.pull * k.inverse_fluid_capacity));
        let lag = m.v * V::splat(0.3).mul_add(k.inverse_length, heat);
        (lag * m.fluidity, k.torque * (m.inverse_q * m.pull_by_z))
    }

    /// Derivative in time of the load less the balloon's and the spool's parts, that the brake has to balance.
    #[inline(always)]
    pub fn load_rate(&self, m: &Moment<V>) -> V {
        let k = &self.constants;
        let v_rate = m.p * (m.inverse_q * m.force);
        let shift = k.share_slope * m.v;
        let balloon_rate = m.rates[1] * self.clock.pace(m.v) + m.eta * v_rate - shift * m.v;
        -(m.eta * (m.drag_slope * balloon_rate) + shift * m.lift + k.extraction * m.v)
    }

    /// The observables at a moment.
    #[inline(always)]
    pub fn observe(&self, y: &[V; STATES], m: &Moment<V>) -> [V; OBSERVABLES] {
        let k = &self.constants;
        let specific = m.force * m.inverse_q;
        let brake = (k.spool_pull * m.w).mul_add(m.w, m.pull);
        [y[3], k.inertia.mul_add(specific, brake), (m.w * m.w) * m.p, m.pull * m.v, m.v]
    }

    /// Their derivatives in time, where that of `z` is `z_rate`.
    #[inline(always)]
    pub fn observable_rates(&self, m: &Moment<V>, z_rate: V) -> [V; OBSERVABLES] {
        let k = &self.constants;
        let s = k.radius_slope;
        let pace = self.clock.pace(m.v);
        // w = z/(kθ), v = p w.
        let w_rate = (m.w * m.b).mul_add(m.tv_rate, (k.inverse_torque * m.fluidity) * z_rate);
        let v_rate = m.p * (s * m.w).neg_mul_add(m.w, w_rate);
        let specific = m.force * m.inverse_q;
        let spool = k.spool_pull * m.w;
        let pull_rate = m.pull_by_z.mul_add(z_rate, (m.half_thinning * m.pull) * (s * m.w));
        let brake_rate = (spool + spool).mul_add(w_rate, pull_rate);
        let balloon_rate =
            m.eta.mul_add(v_rate, (k.share_slope * m.v).neg_mul_add(m.v, m.rates[1] * pace));
        let lift_rate = -(m.drag_slope * balloon_rate);
        let share_rate = -(k.share_slope * m.v);
        let force_rate = share_rate
            .mul_add(m.lift, m.eta.mul_add(lift_rate, -(k.extraction.mul_add(m.v, brake_rate))));
        let one = V::splat(1.0);
        let reduced = k.total_mass * m.eta.neg_mul_add(m.eta, m.eta);
        let reduced_rate = k.total_mass * (share_rate * (one - (m.eta + m.eta)));
        let q_rate = m.p.mul_add(reduced_rate, -((s * m.v) * reduced));
        let specific_rate = m.inverse_q * specific.neg_mul_add(q_rate, force_rate);
        [
            m.rates[3] * pace,
            k.inertia.mul_add(specific_rate, brake_rate),
            m.w * (m.p + m.p).mul_add(w_rate, -((s * m.v) * m.w)),
            pull_rate.mul_add(m.v, m.pull * v_rate),
            v_rate,
        ]
    }
}
