//! Peaks: the largest value of each observable over a run, interior maxima included.
//!
//! At both ends of every step the observables and their time derivatives are known. Where one rises at
//! the start and falls at the end, the maximum of the cubic Hermite interpolant in the step's clock
//! counts. The derivatives follow by the chain rule from the right-hand side, save that of the stiff
//! variable, which is the dense output's: the right-hand side turns an error of 1e-6 in the balance of
//! forces into a derivative that is wrong throughout. (A quintic through the moment before as well was
//! tried: no better where the run is smooth, as the step's own error is the larger one there, and worse in
//! the start-up, where steps grow threefold.)

use super::clock::Clock;
use crate::numerics::lanes::{Lanes, Mask};

/// Number of observables: fluid temperature (K), tension (N), *squared* reel speed (rad²/s²), brake
/// power (W), separation velocity (m/s).
pub const OBSERVABLES: usize = 5;

/// A cubic's maximum errs by about a sixth of the square of its rise above the step's ends, as shares of the peak (a
/// smooth function over a step: the rise is its second derivative, the error its fourth). It is trusted while that is
/// below a hundred times the tolerance.
const TRUSTED_SQUARE: f64 = 100.0;
/// No larger rise of the fluid's temperature is trusted, which is promised more closely than the other peaks.
const TRUSTED_WARMING: f64 = 0.03;
/// At release the pull of a fluid that thins with shear is no smooth function of time, it rises as a power below one:
/// a rise of the tension's maximum above the step's ends is trusted up to this many tolerances.
const TRUSTED_STARTING: f64 = 90.0;

/// The largest values so far, and the step under way.
#[derive(Clone, Copy)]
pub struct Peaks<V> {
    /// Largest values so far.
    pub values: [V; OBSERVABLES],
    /// Values at the step's start.
    start: [V; OBSERVABLES],
    /// Derivatives in time at the step's start.
    slopes: [V; OBSERVABLES],
    /// Step, 0 where it was not accepted, and time per clock at its start.
    step: V,
    start_rate: V,
    /// 1 where the step's start was real.
    start_real: V,
    clock: Clock<V>,
    /// Derivative of the stiff variable in the clock at the step's end.
    stiff: V,
    /// 1 where a peak is in doubt.
    doubt: V,
    /// Largest rise of an interpolated peak above the step's ends that is trusted, as a share of the peak: of any
    /// peak, of the fluid's temperature, and of the tension while a fluid that thins with shear gets going.
    trusted: [f64; 3],
}

impl<V: Lanes> Peaks<V> {
    /// Nothing seen yet but some largest values.
    pub fn new(values: [V; OBSERVABLES], tolerance: f64) -> Self {
        let zero = V::splat(0.0);
        let none = [zero; OBSERVABLES];
        let usual = (TRUSTED_SQUARE * tolerance).sqrt();
        Peaks {
            values,
            start: none,
            slopes: none,
            step: zero,
            start_rate: zero,
            start_real: zero,
            clock: Clock { length: zero, time: V::splat(1.0) },
            stiff: zero,
            doubt: zero,
            trusted: [usual, usual.min(TRUSTED_WARMING), TRUSTED_STARTING * tolerance],
        }
    }

    /// Lets a lane have seen nothing but the largest values in a lane of others.
    #[inline(always)]
    pub fn restart(&mut self, lane: usize, values: &[V; OBSERVABLES], from: usize) {
        for (value, others) in self.values.iter_mut().zip(values) {
            value.lanes_mut()[lane] = others.lanes()[from];
        }
        self.step.lanes_mut()[lane] = 0.0;
        self.doubt.lanes_mut()[lane] = 0.0;
    }

    /// Whether a peak of a lane is in doubt.
    #[inline(always)]
    pub fn doubtful(&self, lane: usize) -> bool {
        self.doubt.lanes()[lane] > 0.5
    }

    /// Notes a step: its size (0 where not accepted), its clock, the time per clock at its start, the
    /// observables' derivatives in time there, and the stiff variable's in the clock at the end.
    #[inline(always)]
    pub fn stepped(
        &mut self,
        step: V,
        clock: &Clock<V>,
        start_rate: V,
        slopes: &[V; OBSERVABLES],
        stiff: V,
    ) {
        self.step = step;
        self.clock = *clock;
        self.start_rate = start_rate;
        self.slopes = *slopes;
        self.stiff = stiff;
    }

    /// Derivative in time of the stiff variable at the step's end, where the relative velocity is `v`.
    #[inline(always)]
    pub fn stiff_rate(&self, v: V) -> V {
        self.stiff * self.clock.pace(v)
    }

    /// Takes in the values where the step ended, if they are real, with their derivatives in time there, given
    /// where the fluid thins with shear if it does anywhere.
    #[inline(always)]
    pub fn arrive(
        &mut self,
        real: V::Mask,
        v: V,
        end: &[V; OBSERVABLES],
        end_slopes: &[V; OBSERVABLES],
        thins: Option<V>,
    ) {
        let zero = V::splat(0.0);
        let moved = zero.lt(self.step);
        let known = V::splat(0.5).lt(self.start_real);
        for n in 0..OBSERVABLES {
            self.values[n] = V::select(real, end[n].max(self.values[n]), self.values[n]);
            let turned = moved.and(zero.lt(self.slopes[n])).and(end_slopes[n].lt(zero));
            if turned.any() {
                let d0 = self.step * self.slopes[n] * self.start_rate;
                let d1 = self.step * end_slopes[n] / self.clock.pace(v);
                let top = interior(self.start[n], end[n], d0, d1);
                let seen = top.max(self.values[n]);
                self.values[n] = V::select(turned.and(known), seen, self.values[n]);
                // A turn within a step whose start was not the descent's own is a peak that nobody has seen.
                let mut share = V::splat(self.trusted[usize::from(n == 0)]);
                if let (1, Some(thins)) = (n, thins) {
                    let singular = V::splat(0.5).lt(thins * self.clock.time);
                    share = V::select(singular, V::splat(self.trusted[2]), share);
                }
                let steep = (share * top).lt(top - self.start[n].max(end[n]));
                let doubt = turned.and(steep.or(known.not()));
                self.doubt = V::select(doubt, V::splat(1.0), self.doubt);
            }
        }
        self.start = *end;
        self.start_real = V::select(real, V::splat(1.0), zero);
        self.step = zero;
    }
}

/// Maximum of the cubic from `start` to `end` with slope `d0` > 0 at θ = 0 and `d1` < 0 at θ = 1.
#[inline(always)]
fn interior<V: Lanes>(start: V, end: V, d0: V, d1: V) -> V {
    let three = V::splat(3.0);
    let rise = end - start;
    let b = (d0 + d1) - (rise + rise);
    let a = three.mul_add(rise, -(d0 + d0)) - d1;
    let root = a.mul_add(a, -(three * b * d0)).max(V::splat(0.0)).sqrt();
    let x = d0 / (root - a);
    x.mul_add(x.mul_add(x.mul_add(b, a), d0), start)
}
