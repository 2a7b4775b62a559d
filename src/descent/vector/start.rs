//! Where descents start: at rest, or beyond the initial layer.

use super::constants::Constants;
use super::dynamic;
use super::leg::{PAYING_OUT, STARTING};
use super::observables::OBSERVABLES;
use super::quasi_steady;
use crate::numerics::lanes::elementary::exp;
use crate::numerics::lanes::{Lanes, Mask};

/// The starts of as many descents as there are lanes.
#[derive(Clone, Copy)]
pub struct Start<V, const N: usize> {
    /// State.
    pub state: [V; N],
    /// The part of the descent that it begins.
    pub leg: V,
    /// First step to try, in that part's clock.
    pub step: V,
    /// Largest values of the observables before it, −∞ for none.
    pub peaks: [V; OBSERVABLES],
    /// Until when the state is not that of the descent yet, s.
    pub settled: V,
}

impl<V: Lanes, const N: usize> Start<V, N> {
    /// A start with nothing before it.
    #[inline(always)]
    fn first(state: [V; N], leg: f64, step: V) -> Self {
        let peaks = [V::splat(f64::NEG_INFINITY); OBSERVABLES];
        Start { state, leg: V::splat(leg), step, peaks, settled: V::splat(0.0) }
    }

    /// Zeros, for lanes that nobody reads.
    #[inline(always)]
    pub fn nowhere() -> Self {
        Self::first([V::splat(0.0); N], STARTING, V::splat(0.0))
    }

    /// The same with a share of the first step.
    #[inline(always)]
    pub fn with_step(mut self, share: f64) -> Self {
        self.step = self.step * V::splat(share);
        self
    }

    /// `this` where the mask is true, `other` elsewhere.
    #[inline(always)]
    pub fn select(mask: V::Mask, this: Self, mut other: Self) -> Self {
        for (value, &this) in other.state.iter_mut().zip(&this.state) {
            *value = V::select(mask, this, *value);
        }
        for (value, &this) in other.peaks.iter_mut().zip(&this.peaks) {
            *value = V::select(mask, this, *value);
        }
        other.leg = V::select(mask, this.leg, other.leg);
        other.step = V::select(mask, this.step, other.step);
        other.settled = V::select(mask, this.settled, other.settled);
        other
    }
}

/// At rest on the line, both bodies rising. The first step is a fraction of the fast time constant
/// `(M η (1 − η) + J/p)/κ`, or of the time that the load alone would need for the whole line.
#[inline(always)]
pub fn at_rest<V: Lanes>(k: &Constants<V>) -> Start<V, { dynamic::STATES }> {
    let (zero, warm) = (V::splat(0.0), k.initial_temperature);
    let fluidity = exp(k.minus_viscosity_temperature / warm);
    let p = k.full_radius_squared;
    let share = k.payload_share;
    let mass = k.total_mass * share * (V::splat(1.0) - share) + k.inertia / p;
    let relaxation = mass * p * (k.inverse_torque * fluidity);
    let free_fall = (k.length * mass / k.weight).sqrt();
    let short = relaxation.lt(free_fall);
    let step = V::splat(0.3) * V::select(short, relaxation, V::splat(0.1) * free_fall);
    Start::first([zero, k.rise_speed, zero, warm, warm, warm, zero], STARTING, step)
}

/// In balance at the line's beginning: the quasi-steady model's start.
#[inline(always)]
pub fn in_balance<V: Lanes>(k: &Constants<V>) -> Start<V, { quasi_steady::STATES }> {
    let (zero, warm) = (V::splat(0.0), k.initial_temperature);
    let fluidity = exp(k.minus_viscosity_temperature / warm);
    let velocity = k.full_radius_squared * k.weight * (k.inverse_torque * fluidity);
    Start::first([zero, warm, warm, warm, zero], PAYING_OUT, warming_step(k, velocity))
}

/// A fraction of the way made at a velocity while the fluid's temperature relaxes: a longer first step can
/// hide from the error estimate.
#[inline(always)]
pub fn warming_step<V: Lanes>(k: &Constants<V>, velocity: V) -> V {
    let way = V::splat(0.25) * velocity / (k.fluid_rotor_1 + k.fluid_housing_1);
    let most = V::splat(0.01) * k.length;
    V::select(V::splat(0.0).lt(way).and(way.lt(most)), way, most)
}
