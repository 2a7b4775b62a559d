//! The initial layer: how a descent gets moving, taken in one stride.
//!
//! At release the relative velocity rises from zero to what balances the load, within some ten fast time
//! constants `τ`, that is a third of a second of several minutes. Step by step that costs a third of all
//! steps. Where the fluid hardly warms meanwhile, the method of matched asymptotic expansions (for example
//! M. H. Holmes, *Introduction to Perturbation Methods*, ch. 2) gives the *outer* solution, on which the
//! descent is when the layer has passed, and the integration starts on it at time zero, with long steps.
//!
//! # Expansion
//! With `v∞ = W/κ̃`, `κ̃ = κ + η² D'` (`D'` the drag's slope), `τ = m/κ̃`, `f = v/v∞`, `σ = t/τ`, the way
//! `v∞ τ λ` and the fluid's warming `h θ`, `h = τ κ v∞²/C1`, what matters of the equations is
//! ```text
//! f' = 1 − μ λ − (1 − ε θ + g ε² θ² + ρ λ) f     ε = (B/T²)(1 + offset) h κ/κ̃ ,  g = ½ + T/B
//! θ' = (1 − ε θ + ρ λ) f² − k θ ,  λ' = f        k = τ (K12 + K13)/C1
//! ```
//! with `f = θ = λ = 0` at the start; `ρ = s v∞ τ/p` is by how much the reel narrows in the way `v∞ τ`, `μ` by
//! how much the load fades. All five small numbers are a few thousandths at most. The outer solution has at
//! σ = 0, to the order of `ε` in the way and the warming and of `ε²` in the pull,
//! ```text
//! λ = −1 + 47/12 ε − 5/2 ρ − 3 μ         θ = −2/(1 − k) + 1/(2 − k) + 77/12 ε − 9/2 ρ − 11/2 μ
//! f = 1 − 5/2 ε + 2 ρ + 2 μ
//! f' = ε (1 + 5/2 k + (5 g − 21/2) ε + 37/2 ρ + 15 μ) − ρ − μ − 8 ρ² − 11 ρ μ − 3 μ²
//! f'' = ε ((3 − 2 g) ε − k − 6 ρ − 5 μ) + 3 ρ² + 4 ρ μ + μ²      f''' ≈ ε (k² − 4 ε k + 4 ε²)
//! ```
//! so that it sets out *before* the line's beginning and with a fluid that is colder than it was. Rotors,
//! housing and the common centre follow from what the layer's warmth and velocity lack to first order; the
//! pull is the load less `W f'`.
//!
//! # Peaks
//! An observable that falls along the outer solution has its largest value at the end of the layer, where
//! `O + Ȯ t + ½ Ö t² − A e^{−t/τ}` is largest: at `t = τ ln(A/(−Ȯ τ))`. That is where the line's tension peaks
//! in an ordinary descent, some 0.03 % below the weight. Where the warming outweighs the narrowing reel and the
//! fading load several times, everything else rises throughout the layer. Nothing is read off the outer solution
//! before it is the descent.
//!
//! # Where it holds
//! What is left out is estimated, and a lane goes the long way where that is more than a share of the
//! tolerance, or the layer is not slight against everything else. Against fine steps from rest (300 members
//! of the default study, 1 500 of a stress set) no error above 1e-7 was more than its estimate, most were a
//! quarter of it. At a tolerance of 1e-6 most members of the default study start beyond the layer, at 1e-7
//! hardly any. Thinning with shear goes the long way always.

use super::clock::Clock;
use super::constants::Constants;
use super::dynamic::{Dynamic, STATES};
use super::leg::PAYING_OUT;
use super::observables::OBSERVABLES;
use super::rosenbrock::System;
use super::start::{Start, warming_step};
use crate::numerics::lanes::elementary::{exp, ln};
use crate::numerics::lanes::{Lanes, Mask};

/// Share of a step's tolerance that the layer may leave out of the constrained outcomes.
const SHARE: f64 = 0.2;
/// The same for the peaks, which keep to thirty times the tolerance of the outcomes.
const PEAK_SHARE: f64 = 12.0;
/// Longest layer: `v∞ τ` as a share of the line, and `τ` of the time constants of the fluid's cooling and of the
/// balloon's settling.
const LONGEST: [f64; 3] = [1.0 / 2000.0, 1.0 / 25.0, 1.0 / 50.0];
/// Largest share of the balloon's drag in the damping.
const MOST_DRAG: f64 = 1.0 / 50.0;
/// Largest share of `ε` that `ρ + μ` may be: the descent then gets faster throughout the layer.
const MOST_SLOWING: f64 = 1.0 / 4.0;
/// Time constants after which the outer solution is the descent: e⁻¹⁶ is 1e-7.
const SETTLED: f64 = 16.0;

/// The start beyond the initial layer, and where it is accurate enough for a step's tolerance.
#[inline(always)]
pub fn passed<V: Lanes>(k: &Constants<V>, local_tolerance: f64) -> (V::Mask, Start<V, STATES>) {
    let layer = Layer::new(k);
    let (outcomes, peaks) = layer.left_out(k);
    let fits = outcomes
        .lt(V::splat(SHARE * local_tolerance))
        .and(peaks.lt(V::splat(PEAK_SHARE * local_tolerance)))
        .and(layer.is_slight(k))
        .and(k.cross_on.lt(V::splat(0.5)));
    let state = layer.state(k);
    let (falls, peaks) = layer.peaks(k, &state);
    let fits = fits.and(falls);
    let step = warming_step(k, layer.v);
    let settled = V::splat(SETTLED) * layer.tau;
    (fits, Start { state, leg: V::splat(PAYING_OUT), step, peaks, settled })
}

/// The layer's scales and small numbers; see the module.
struct Layer<V> {
    /// `W`, with what the balloon adds at the start, N.
    weight: V,
    /// `η D'`, N·s/m.
    gain: V,
    /// `κ̃`, N·s/m.
    damping: V,
    /// `m`, kg.
    mass: V,
    /// `v∞`, m/s.
    v: V,
    /// `τ`, s.
    tau: V,
    /// `v∞ τ`, m.
    way: V,
    /// `h`, K.
    heat: V,
    /// `ε`.
    eps: V,
    /// `g ε`.
    bend: V,
    /// `k`.
    cooling: V,
    /// `ρ`.
    narrowing: V,
    /// `μ`.
    fading: V,
}

impl<V: Lanes> Layer<V> {
    #[inline(always)]
    fn new(k: &Constants<V>) -> Self {
        let one = V::splat(1.0);
        let warm = k.initial_temperature;
        let b = -(k.minus_viscosity_temperature / (warm * warm));
        let (p, eta, rise) = (k.full_radius_squared, k.payload_share, k.rise_speed);
        let kappa = k.torque / (p * exp(k.minus_viscosity_temperature / warm));
        let weight = k.weight + eta * (k.free_lift - k.drag * (rise * rise.abs()));
        // The drag's slope half-way to the velocity.
        let at_rest = (k.drag + k.drag) * rise.abs();
        let drag_slope = at_rest + k.drag * (eta * (weight / (kappa + (eta * eta) * at_rest)));
        let gain = eta * drag_slope;
        let damping = kappa + eta * gain;
        let mass = k.total_mass * (eta * (one - eta)) + k.inertia / p;
        let (v, tau) = (weight / damping, mass / damping);
        let heat = tau * (kappa * (v * v)) * k.inverse_fluid_capacity;
        let warming = heat * (one + k.averaging_offset) * (kappa / damping);
        let eps = b * warming;
        let fading = k.extraction * v - gain * v * (k.share_slope * v + gain * k.inverse_mass);
        Layer {
            weight,
            gain,
            damping,
            mass,
            v,
            tau,
            way: v * tau,
            heat,
            eps,
            bend: V::splat(0.5) * eps + warming / warm,
            cooling: tau * (k.fluid_rotor_1 + k.fluid_housing_1),
            narrowing: tau * (k.radius_slope * (v / p)),
            fading: tau * fading / weight,
        }
    }

    /// The outer solution's state at time zero.
    #[inline(always)]
    fn state(&self, k: &Constants<V>) -> [V; STATES] {
        let value = V::splat;
        let (one, two) = (value(1.0), value(2.0));
        let (eta, warm) = (k.payload_share, k.initial_temperature);
        let (eps, slow) = (self.eps, [self.narrowing, self.fading]);
        let longer = value(47.0 / 12.0) * eps - value(2.5) * slow[0] - value(3.0) * slow[1];
        let line = -(self.way * (one - longer));
        let warmer = value(77.0 / 12.0) * eps - value(4.5) * slow[0] - value(5.5) * slow[1];
        let cold = two / (one - self.cooling) - one / (two - self.cooling) - warmer;
        let shed = value(1.75) * (self.tau * self.heat);
        let shift = self.gain * k.inverse_mass - value(1.5) * (k.share_slope * self.v);
        let centre = k.rise_speed + self.way * shift;

        let slowed = value(2.5) * eps - two * (slow[0] + slow[1]);
        let balloon = centre + eta * (self.v * (one - slowed));
        let lift = k.free_lift - k.drag * (balloon * balloon.abs());
        let w = self.v / k.full_radius_squared;
        let load = k.weight - k.extraction * line + eta * lift - k.spool_pull * (w * w);
        let heating = value(2.5) * self.cooling + value(5.0) * self.bend - value(10.5) * eps;
        let crossed = value(18.5) * slow[0] + value(15.0) * slow[1];
        let slowing = value(8.0) * (slow[0] * slow[0])
            + slow[1] * (value(11.0) * slow[0] + value(3.0) * slow[1]);
        let lag = eps * (one + heating + crossed) - slow[0] - slow[1] - slowing;
        [
            line,
            centre,
            load - self.weight * lag,
            warm - self.heat * cold,
            warm + shed * k.fluid_rotor_2,
            warm + shed * k.fluid_housing_3,
            value(0.0),
        ]
    }

    /// The largest values of the observables within the layer, and whether the tension falls throughout the outer
    /// solution's part of it. What rises with the velocity begins at zero and is largest later.
    #[inline(always)]
    fn peaks(&self, k: &Constants<V>, state: &[V; STATES]) -> (V::Mask, [V; OBSERVABLES]) {
        let value = V::splat;
        let (zero, one, two) = (value(0.0), value(1.0), value(2.0));
        let (eps, cooling, tau) = (self.eps, self.cooling, self.tau);
        let outer =
            Dynamic { constants: *k, clock: Clock { length: zero, time: one }, any_cross: false };
        let moment = outer.moment(state);
        let load_rate = outer.load_rate(&moment);
        let slow = [self.narrowing, self.fading];
        let heating = value(3.0) * eps - two * self.bend - cooling;
        let crossed = value(6.0) * slow[0] + value(5.0) * slow[1];
        let slowing = value(3.0) * (slow[0] * slow[0]) + slow[1] * (value(4.0) * slow[0] + slow[1]);
        let curve = eps * (heating - crossed) + slowing;
        let pull_rate = load_rate - self.weight * curve / tau;
        let values = outer.observe(state, &moment);
        let slopes = outer.observable_rates(&moment, pull_rate);

        // The bend of the tension, the load's part by a difference over half a layer.
        let ahead = value(5.0) * tau;
        let mut later = *state;
        for (n, variable) in later.iter_mut().enumerate() {
            let rate = if n == 2 { pull_rate } else { moment.rates[n] };
            *variable = ahead.mul_add(rate, *variable);
        }
        let load_bend = (outer.load_rate(&outer.moment(&later)) - load_rate) * value(0.2);
        let flown = one - k.inertia / (self.mass * k.full_radius_squared);
        let third = eps * (cooling * cooling + value(4.0) * eps * (eps - cooling));
        let tension_bend = tau * load_bend - flown * (self.weight * third);

        let tension = values[1];
        let fall = -(slopes[1] * tau);
        let falls = (value(2.0 * SETTLED) * tension_bend.abs()).lt(fall);
        let times = ln((flown * tension) / V::select(falls, fall, one));
        let top = tension - fall * (one + times) + value(0.5) * tension_bend * (times * times);
        (falls, [k.initial_temperature, top, zero, zero, zero])
    }

    /// Whether the layer is short against all else, and the descent gets faster throughout it by the warming.
    #[inline(always)]
    fn is_slight(&self, k: &Constants<V>) -> V::Mask {
        let value = V::splat;
        let settling = self.tau * (self.gain / k.payload_share * k.inverse_mass);
        let drag = k.payload_share * self.gain / self.damping;
        let slowing = self.narrowing + self.fading;
        (self.way * k.inverse_length)
            .lt(value(LONGEST[0]))
            .and(self.cooling.lt(value(LONGEST[1])))
            .and(settling.lt(value(LONGEST[2])))
            .and(drag.lt(value(MOST_DRAG)))
            .and(slowing.lt(value(MOST_SLOWING) * self.eps))
    }

    /// Estimates of the relative errors of the constrained outcomes and of the peaks.
    #[inline(always)]
    fn left_out(&self, k: &Constants<V>) -> (V, V) {
        let value = V::splat;
        let eps = self.eps;
        let dragged = k.payload_share * self.gain / self.damping;
        let in_heat = value(5.0) * (eps * eps) + value(0.01) * (eps + dragged);
        let in_way = value(20.0) * (self.way * k.inverse_length) * eps;
        let pace = eps + self.cooling;
        let settling = self.tau * (self.gain / k.payload_share * k.inverse_mass);
        let by_load = (k.extraction * self.way / self.weight) * eps;
        let in_peaks = eps * (pace * pace) + dragged * (settling * settling) + by_load;
        (eps * (in_way + in_heat), value(60.0) * in_peaks)
    }
}

#[cfg(test)]
#[path = "initial_layer_test.rs"]
mod tests;
