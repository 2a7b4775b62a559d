//! The brake: viscous torque summed over the working surfaces, each with its own gap.

use super::design::Design;
use super::parameters::Parameter;
use crate::numerics::real::Real;

/// Brake constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Brake<R> {
    /// `(π/2)(ro⁴ − ri⁴) Σ 1/d_k`, m³: torque per viscosity and reel speed, paper (5).
    pub torque_factor_m3: R,
    /// `r_t/d_h`: mean shear rate per reel speed, with the torque-weighted radius
    /// `r_t = (4/5)(ro⁵ − ri⁵)/(ro⁴ − ri⁴)` and the harmonic-mean gap `d_h = 2n/Σ(1/d_k)`.
    pub shear_rate_per_speed: R,
}

impl<R: Real> Brake<R> {
    /// The brake of a design.
    #[inline(always)]
    pub fn new(design: &Design<R>) -> Self {
        let outer = design.get(Parameter::BrakeOuterRadius);
        let inner = design.get(Parameter::BrakeInnerRadius);
        let fourth = |r: R| (r * r) * (r * r);
        let fourths = fourth(outer) - fourth(inner);
        let fifths = fourth(outer) * outer - fourth(inner) * inner;
        let mut inverse_gaps = R::constant(0.0);
        for &gap in design.gaps() {
            inverse_gaps = inverse_gaps + R::constant(1.0) / gap;
        }
        let surfaces = R::constant(design.surfaces() as f64);
        Brake {
            torque_factor_m3: R::constant(std::f64::consts::FRAC_PI_2) * fourths * inverse_gaps,
            shear_rate_per_speed: R::constant(0.8) * fifths / fourths * inverse_gaps / surfaces,
        }
    }
}
