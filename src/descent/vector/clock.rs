//! A lane's clock: time or line length as the independent variable.
//!
//! The kernels integrate in `τ` with `dτ = α dl + β dt`. A lane starts in time (α = 0, β = 1), since
//! nothing moves at release, and changes to line length (α = 1, β = 0) when the start-up transient has
//! passed: then the end of the line is the end of an interval, not an event to be searched for.

use crate::numerics::lanes::Lanes;

/// Factors of `dτ = α dl + β dt`, lane by lane.
#[derive(Clone, Copy)]
pub struct Clock<V> {
    /// α, 1/m: 1 where line length is the variable, else 0.
    pub length: V,
    /// β, 1/s: 1 where time is the variable, else 0.
    pub time: V,
}

impl<V: Lanes> Clock<V> {
    /// `dτ/dt` at relative velocity `v`: the reciprocal of the clock's rate `g = dt/dτ`.
    #[inline(always)]
    pub fn pace(&self, v: V) -> V {
        self.length.mul_add(v, self.time)
    }
}
