//! What physics allows a descent to end in: what lies beyond it is an error of the integration, however small the
//! estimates of its steps were.
//!
//! # Heat
//! The relative motion's energy `K = ½ (Q/p) v²` (see `dynamic.rs`) and the heat `H = ∫ y dl` obey, by the equation
//! of `v` multiplied with `v`,
//! ```text
//! d(K + H)/dl = W2 − x l + η E − ½ (x/g)(1 − 2η) v² ,   E = free lift − D(V1)
//! ```
//! in which the spool's two terms cancel. While the balloon does not sink, `E` is at most the free lift `F`, and so
//! `K + H ≤ a (W2 L − ½ Wx L + η0 F L)`. The last term adds energy only where the payload is the heavier body
//! (η > ½): with `K ≥ ½ M η (1 − η) v²` it is at most `K η' (2η − 1)/(η (1 − η))`, the logarithmic derivative of
//! `η (1 − η)` along the line, whence the factor `a`, the ratio of the largest to the smallest `η (1 − η)` there; else
//! `a` = 1. Without accelerations `H` is the load's work itself. The three nodes answer to heat linearly and without a
//! change of sign: no temperature leaves the range of release and air by more than `H/C` of its own node upwards, or
//! at all downwards.
//!
//! The detailed models report the hottest of their points, whose own part of `C` may be as small as one likes: it has no
//! bound but that of their mean, which lies below it.
//!
//! # What few points across the film resolve
//! Of the detailed models' points the few that a loose tolerance takes resolve a film that is not much thinner where it is
//! hot: its heating by the brake's power `P`, were all of it kept in the film, is `P/(C1 c)` with `c` the rate of
//! conduction across it, and `Na = (B/T²) P/(C1 c)` the logarithm of what that does to the viscosity. Against more points,
//! on 4 500 designs of the default study, the stress set and hard ones: time, final velocity and hottest fluid err by
//! 1e-3 at most up to [`RESOLVED`], by 0.02 at 0.7, by 0.2 beyond 1.5. The default study's largest is some 0.35.
//!
//! Rotors and housing are warmed by the fluid alone: neither is ever warmer than the hottest of its peak, release and
//! air.
//!
//! # Speed
//! `v² ≤ 2 (K + H)/(M η (1 − η) + J/Ro²)`, and the reels never turn faster than `v/Ri` at the largest `v`. Without
//! accelerations neither is bounded, but the tension is the load, which falls.

use super::constants::Constants;
use crate::descent::model::Model;
use crate::descent::outcome::{OUTCOME_COUNT, TIME_LIMIT_S};
use crate::numerics::lanes::Lanes;

/// Largest `Na` that few points across the film resolve.
const RESOLVED: f64 = 0.45;

/// What descents may end in, SI: of as many as there are lanes, or of one.
#[derive(Clone, Copy)]
pub struct Possible<V> {
    /// Lowest temperature.
    coldest: V,
    /// Highest temperature without any heat of the brake's.
    warmest: V,
    /// Highest temperature of the fluid.
    hottest: V,
    /// Square of the largest separation velocity.
    fastest_squared: V,
    /// Squared radius of the empty reel.
    empty_radius_squared: V,
    /// Largest tension.
    tautest: V,
    /// Largest power over the square of the hottest temperature that few points across the film resolve.
    resolved: V,
}

impl<V: Lanes> Possible<V> {
    /// The bounds of descents with these constants.
    #[inline(always)]
    pub fn new(model: Model, k: &Constants<V>) -> Self {
        let value = V::splat;
        let (zero, one, infinite) = (value(0.0), value(1.0), value(f64::INFINITY));
        let aired = zero.lt(k.air_3);
        let release = k.initial_temperature;
        let warmest = V::select(aired, release.max(k.air_k), release);
        let work = k.length * (k.weight - value(0.5) * (k.extraction * k.length));
        let (heat, fastest_squared, tautest) = match model {
            Model::QuasiSteady | Model::DetailedQuasiSteady => (work, infinite, k.weight),
            Model::Dynamic | Model::DetailedDynamic => {
                let share = k.payload_share;
                let left = k.share_slope.neg_mul_add(k.length, share);
                let smallest = (share * (one - share)).min(left * (one - left));
                let gain = V::select(value(0.5).lt(share), value(0.25) / smallest, one);
                let heat = gain * (work + share * k.free_lift.max(zero) * k.length);
                let inertia = k.total_mass * smallest + k.inertia / k.full_radius_squared;
                (heat, (heat + heat) / inertia, infinite)
            }
        };
        let hottest = if model.is_detailed() {
            infinite
        } else {
            heat.mul_add(k.inverse_fluid_capacity, warmest)
        };
        let film = k.inverse_fluid_capacity * -k.minus_viscosity_temperature;
        let resolved =
            if model.is_detailed() { value(RESOLVED) * k.conduction / film } else { infinite };
        Possible {
            coldest: V::select(aired, release.min(k.air_k), release),
            warmest,
            hottest,
            fastest_squared,
            empty_radius_squared: k.radius_slope.neg_mul_add(k.length, k.full_radius_squared),
            tautest,
            resolved,
        }
    }

    /// The bounds of one lane.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> Possible<f64> {
        let of = |bound: &V| bound.lanes()[lane];
        Possible {
            coldest: of(&self.coldest),
            warmest: of(&self.warmest),
            hottest: of(&self.hottest),
            fastest_squared: of(&self.fastest_squared),
            empty_radius_squared: of(&self.empty_radius_squared),
            tautest: of(&self.tautest),
            resolved: of(&self.resolved),
        }
    }
}

impl Possible<f64> {
    /// No bounds: anything of the right sign that is finite.
    pub const ANYTHING: Self = Possible {
        coldest: 0.0,
        warmest: f64::INFINITY,
        hottest: f64::INFINITY,
        fastest_squared: f64::INFINITY,
        empty_radius_squared: 0.0,
        tautest: f64::INFINITY,
        resolved: f64::INFINITY,
    };

    /// Whether few points across the film resolve it; true of every model with three nodes.
    #[inline(always)]
    pub fn resolves(&self, values: &[f64; OUTCOME_COUNT]) -> bool {
        let [_, _, hottest, _, _, power, ..] = *values;
        power <= self.resolved * (hottest * hottest)
    }

    /// Whether outcomes, in the order of `Outcome::values`, are within the bounds but for a share of them.
    #[inline(always)]
    pub fn admits(&self, values: &[f64; OUTCOME_COUNT], slack: f64) -> bool {
        let [
            time,
            last_velocity,
            fluid_peak,
            tension,
            speed,
            power,
            velocity,
            fluid,
            rotor,
            housing,
        ] = *values;
        let more = 1.0 + slack;
        let coldest = self.coldest * (1.0 - slack);
        let warmest = self.warmest.max(fluid_peak) * more;
        let squared = velocity * velocity;
        let infinite = f64::INFINITY;
        // What is not a number fails every comparison.
        (0.0 < time)
            & (time <= TIME_LIMIT_S)
            & (0.0 <= last_velocity)
            & (last_velocity <= velocity)
            & (squared <= self.fastest_squared * (more * more))
            & (squared < infinite)
            & (0.0 <= speed)
            & (speed * speed * self.empty_radius_squared <= squared * (more * more))
            & (0.0 <= tension)
            & (tension <= self.tautest * more)
            & (tension < infinite)
            & (0.0 <= power)
            & (power < infinite)
            & (coldest <= fluid)
            & (fluid <= fluid_peak)
            & (fluid_peak <= self.hottest * more)
            & (coldest <= rotor)
            & (rotor <= warmest)
            & (coldest <= housing)
            & (housing <= warmest)
    }
}
