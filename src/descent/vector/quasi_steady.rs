//! The quasi-steady model: the same heat and the same clock, with the relative velocity given by the load.
//!
//! The brake's pull is the load `a = W2 − x l`, so `z` is `a` itself, or with Cross thinning the solution
//! of `z/(1 + (χ z R)^m) = a`, a function of `l` alone; `v = p z/(kθ)`. State: `l, T1, T2, T3, t`. In
//! the clock of line length the heat put in per length is `a`, whatever the fluid does: what remains
//! nonlinear is only the time that the heat has to flow on.
//!
//! The step's linear system is that of the dynamic model with the row of `v` replaced by
//! `u_v = v_l u_l + v b u_Tv`.

use super::clock::Clock;
use super::constants::Constants;
use super::observables::OBSERVABLES;
use super::rosenbrock::System;
use super::thermal;
use crate::numerics::lanes::elementary::{exp, ln};
use crate::numerics::lanes::{Lanes, Mask};
use crate::numerics::real::CONVERGED;
use crate::physics::fluid::MORE_STEPS;

/// Number of state variables: `l, T1, T2, T3, t`.
pub const STATES: usize = 5;

/// Newton steps that invert Cross thinning. From the larger of the two asymptotes the iteration converges
/// monotonically, and unless the exponent is near one so many steps end it; see the unit test.
const INVERSION_STEPS: usize = 6;

/// Logarithm of the largest ratio of Newtonian to thinned torque that is worked with.
const LARGEST_LOGARITHM: f64 = 600.0;

/// The quasi-steady model of as many descents as there are lanes.
pub struct QuasiSteady<V> {
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
    /// Relative velocity.
    pub v: V,
    /// `w = v/p`.
    pub w: V,
    /// Weight hanging, N.
    pub load: V,
    b: V,
    tv_rate: V,
    /// `∂v/∂l`.
    v_line: V,
}

/// What a step's solves share.
pub struct Factored<V> {
    h_gamma: V,
    weights: [V; 4],
    line_by_v: V,
    heat: thermal::Solution<V>,
    time_by_v: V,
}

impl<V: Lanes> System<V, STATES> for QuasiSteady<V> {
    // Nothing is stiff here once v is given by the load; line length stands in.
    const STIFF: usize = 0;
    type Moment = Moment<V>;
    type Factored = Factored<V>;

    #[inline(always)]
    fn moment(&self, y: &[V; STATES]) -> Moment<V> {
        let k = &self.constants;
        let [l, fluid, rotor, housing, _] = *y;
        let one = V::splat(1.0);
        let tv = k.averaging_offset.mul_add(fluid - rotor, fluid);
        let inverse_tv = one / tv;
        let fluidity = exp(k.minus_viscosity_temperature * inverse_tv);
        let p = k.radius_slope.neg_mul_add(l, k.full_radius_squared);
        let load = k.extraction.neg_mul_add(l, k.weight);
        let (z, z_line) = self.unthinned(load, p);
        let per_z = k.inverse_torque * fluidity;
        let w = z * per_z;
        let v = p * w;
        let g = one / self.clock.pace(v);
        let [fluid_rate, rotor_rate, housing_rate] =
            thermal::rates(k, fluid, rotor, housing, load * v);
        let tv_rate = k.averaging_offset.mul_add(fluid_rate - rotor_rate, fluid_rate);
        Moment {
            rates: [v * g, fluid_rate * g, rotor_rate * g, housing_rate * g, g],
            v,
            w,
            load,
            b: -(k.minus_viscosity_temperature * (inverse_tv * inverse_tv)),
            tv_rate,
            v_line: (p * per_z).mul_add(z_line, -(k.radius_slope * w)),
        }
    }

    #[inline(always)]
    fn rates(moment: &Moment<V>) -> [V; STATES] {
        moment.rates
    }

    #[inline(always)]
    fn factor(
        &self,
        _: &[V; STATES],
        m: &Moment<V>,
        h_gamma: V,
        inverse_h_gamma: V,
    ) -> Factored<V> {
        let k = &self.constants;
        let one = V::splat(1.0);
        let alpha = self.clock.length;
        let pace = self.clock.pace(m.v);
        let [line_rate, fluid_rate, rotor_rate, housing_rate, g] = m.rates;
        let c = pace * inverse_h_gamma;
        let eps = k.averaging_offset;
        let cofactors = thermal::cofactors(k, c, V::splat(0.0));
        let joint = one / (c * cofactors.determinant);
        let inverse_determinant = c * joint;
        let inverse_c = cofactors.determinant * joint;
        let line_by_v = alpha.neg_mul_add(line_rate, one) * inverse_c;
        let heat_line = -(k.inverse_fluid_capacity * (k.extraction * m.v));
        let heat_v = [
            heat_line.mul_add(
                line_by_v,
                alpha.neg_mul_add(fluid_rate, k.inverse_fluid_capacity * m.load),
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
        // (1 − v_l d − v b h) u_v = v_l hγ r_l + v b (Σ τ_j r_j + τ_l r_l)
        let vb = m.v * m.b;
        let heat_tv_v = thermal::blend(eps, heat_by_v[0], heat_by_v[1]);
        let pivot = vb.neg_mul_add(heat_tv_v, m.v_line.neg_mul_add(line_by_v, one));
        let inverse_pivot = one / pivot;
        let scaled_vb = vb * inverse_pivot;
        let weights = [
            scaled_vb.mul_add(
                thermal::blend(eps, heat_by_line[0], heat_by_line[1]),
                (m.v_line * h_gamma) * inverse_pivot,
            ),
            scaled_vb * thermal::blend(eps, heat[0][0], heat[1][0]),
            scaled_vb * thermal::blend(eps, heat[0][1], heat[1][1]),
            scaled_vb * thermal::blend(eps, heat[0][2], heat[1][2]),
        ];
        Factored {
            h_gamma,
            weights,
            line_by_v,
            heat: thermal::Solution { own: heat, by_line: heat_by_line, by_v: heat_by_v },
            time_by_v: -((alpha * g) * inverse_c),
        }
    }

    #[inline(always)]
    fn solve(f: &Factored<V>, r: &[V; STATES]) -> [V; STATES] {
        let w = &f.weights;
        let u_v = w[1].mul_add(r[1], w[0] * r[0]) + w[3].mul_add(r[3], w[2] * r[2]);
        let u_l = f.line_by_v.mul_add(u_v, f.h_gamma * r[0]);
        let [u_1, u_2, u_3] = f.heat.solve([r[0], r[1], r[2], r[3]], u_v);
        let u_t = f.time_by_v.mul_add(u_v, f.h_gamma * r[4]);
        [u_l, u_1, u_2, u_3, u_t]
    }
}

impl<V: Lanes> Moment<V> {
    /// `b = B/Tv²`: relative change of the velocity per kelvin.
    #[inline(always)]
    pub fn velocity_per_kelvin(&self) -> V {
        self.b
    }
}

impl<V: Lanes> QuasiSteady<V> {
    /// The Newtonian pull `z` at which the brake pulls with `load`, and `dz/dl`.
    ///
    /// With `x` the Cross group and `y = ln x`: `y − ln a = ln(1 + e^{m y})`, where `a` is the group of the
    /// load. The left side minus the right is increasing and concave, and both asymptotes
    /// (`y = ln a` for a thin group, `y = ln a/(1 − m)` for a thick one) lie left of the root.
    #[inline(always)]
    fn unthinned(&self, load: V, p: V) -> (V, V) {
        let k = &self.constants;
        if !self.any_cross {
            return (load, -k.extraction);
        }
        let one = V::splat(1.0);
        let on = V::splat(0.5).lt(k.cross_on);
        let m = k.cross_exponent;
        let per_pull = k.cross_group * p.sqrt();
        let ln_a = ln((per_pull * load).max(V::splat(1e-300)));
        let mut y = ln_a.max(ln_a / (one - m));
        let (mut growth, mut step) = (one, one);
        for _ in 0..INVERSION_STEPS {
            growth = exp(m * y);
            let residual = (y - ln_a) - ln(one + growth);
            let share = (m * growth) / (one + growth);
            step = residual / (one - share);
            y = y - step;
        }
        let converged = V::splat(CONVERGED);
        for _ in 0..MORE_STEPS {
            let moving = converged.lt(step.abs()).and(on);
            if !moving.any() {
                break;
            }
            let more = exp(m * y);
            let residual = (y - ln_a) - ln(one + more);
            let share = (m * more) / (one + more);
            step = V::select(moving, residual / (one - share), V::splat(0.0));
            growth = V::select(moving, more, growth);
            y = y - step;
        }
        // Beyond what the exponential can serve there is no number.
        let absurd = V::splat(LARGEST_LOGARITHM).lt(y - ln_a);
        let z = V::select(absurd, V::splat(f64::NAN), load * exp(y - ln_a));
        let exponent = (m * growth) / (one + growth);
        // dz/dl = (da/dl − ∂y/∂l)/(∂y/∂z): with y/z = load/z and ∂y/∂l = load ½ exponent s/p.
        let shrink = load * (V::splat(0.5) * exponent) * (k.radius_slope / p);
        let slope = (-k.extraction - shrink) * (z / load) / (one - exponent);
        (V::select(on, z, load), V::select(on, slope, -k.extraction))
    }

    /// The observables at a moment.
    #[inline(always)]
    pub fn observe(&self, y: &[V; STATES], m: &Moment<V>) -> [V; OBSERVABLES] {
        [y[1], m.load, m.v * m.w, m.load * m.v, m.v]
    }

    /// Their derivatives in time.
    #[inline(always)]
    pub fn observable_rates(&self, m: &Moment<V>) -> [V; OBSERVABLES] {
        let k = &self.constants;
        let pace = self.clock.pace(m.v);
        let v_rate = m.v * m.b.mul_add(m.tv_rate, m.v_line);
        let load_rate = -(k.extraction * m.v);
        [
            m.rates[1] * pace,
            load_rate,
            m.w * (k.radius_slope * m.w).mul_add(m.v, v_rate + v_rate),
            m.load.mul_add(v_rate, load_rate * m.v),
            v_rate,
        ]
    }
}
