//! The reels: a spool whose radius shrinks as the line pays out.

use super::design::Design;
use super::parameters::Parameter;
use crate::numerics::real::Real;

/// Reel constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reel<R> {
    /// Line length `L`, m.
    pub line_length_m: R,
    /// `Ro²`, m².
    pub full_radius_squared_m2: R,
    /// `(Ro² − Ri²)/L`, m: how fast the squared radius falls with the line paid out.
    pub squared_radius_slope_m: R,
    /// Moment of inertia of reels and shaft `J`, kg·m².
    pub inertia_kg_m2: R,
}

impl<R: Real> Reel<R> {
    /// The reel of a design.
    #[inline(always)]
    pub fn new(design: &Design<R>) -> Self {
        let length = design.get(Parameter::ReelLineLength);
        let full = design.get(Parameter::ReelFullRadius);
        let empty = design.get(Parameter::ReelEmptyRadius);
        Reel {
            line_length_m: length,
            full_radius_squared_m2: full * full,
            squared_radius_slope_m: (full * full - empty * empty) / length,
            inertia_kg_m2: design.get(Parameter::ReelInertia),
        }
    }

    /// Squared radius of the wound line after `line_m` has been paid out, m²: paper (7), squared.
    #[inline(always)]
    pub fn radius_squared_m2(&self, line_m: R) -> R {
        (-self.squared_radius_slope_m).mul_add(line_m, self.full_radius_squared_m2)
    }
}
