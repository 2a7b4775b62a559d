//! The fluid: viscosity that falls with temperature and, optionally, with shear.

use super::brake::Brake;
use super::design::Design;
use super::parameters::Parameter;
use crate::numerics::real::{CONVERGED, Real};

/// Fluid constants, joined with the brake that shears it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fluid<R> {
    /// Torque per reel speed in the limit of an infinitely hot fluid,
    /// `(π/2)(ro⁴ − ri⁴) Σ(1/d_k) ρ f f_lot A ν0`, N·m·s.
    pub torque_per_speed_nms: R,
    /// Viscosity temperature `B`, K.
    pub viscosity_temperature_k: R,
    /// Averaging offset `ε`.
    pub averaging_offset: R,
    /// Cross group per reel speed in the limit of an infinitely hot fluid, `λ f f_lot A r_t/d_h`, s.
    pub cross_time_s: R,
    /// Cross exponent `m`.
    pub cross_exponent: R,
    /// Whether shear thinning is on (`λ` > 0).
    pub shear_thinning: bool,
}

/// How many Newton steps invert the shear-thinned torque; see [`Fluid::speed_of_torque`].
const INVERSION_STEPS: usize = 12;

/// Newton steps beyond the usual ones, at most. Where the exponent `m` is near one, each adds about one to `y` until
/// that is some `−ln(1 − m)`, which is at most 37 in doubles.
pub const MORE_STEPS: usize = 64;

impl<R: Real> Fluid<R> {
    /// The fluid of a design; `shear_thinning` says whether the design's `λ` is positive.
    #[inline(always)]
    pub fn new(design: &Design<R>, brake: &Brake<R>, shear_thinning: bool) -> Self {
        let get = |parameter| design.get(parameter);
        let thickness = Self::thickness(design);
        Fluid {
            torque_per_speed_nms: brake.torque_factor_m3
                * get(Parameter::FluidDensity)
                * get(Parameter::FluidNominalViscosity)
                * thickness,
            viscosity_temperature_k: get(Parameter::FluidViscosityTemperature),
            averaging_offset: get(Parameter::FluidAveragingOffset),
            cross_time_s: get(Parameter::FluidCrossTimeConstant)
                * thickness
                * brake.shear_rate_per_speed,
            cross_exponent: get(Parameter::FluidCrossExponent),
            shear_thinning,
        }
    }

    /// `f f_lot A`: the viscosity in the limit of an infinitely hot fluid over the nominal one. What multiplies the
    /// viscosity multiplies the Cross time constant with it, so that the fluid of a thick lot thins at the same stress.
    #[inline(always)]
    pub(super) fn thickness(design: &Design<R>) -> R {
        design.get(Parameter::FluidShearFactor)
            * design.get(Parameter::FluidLotFactor)
            * design.get(Parameter::FluidViscosityCoefficient)
    }

    /// `exp(B/Tv)` with `Tv = T1 + ε (T1 − T2)`: paper (6) without its constants.
    #[inline(always)]
    pub fn thickening(&self, fluid_k: R, rotor_k: R) -> R {
        let average_k = self.averaging_offset.mul_add(fluid_k - rotor_k, fluid_k);
        (self.viscosity_temperature_k / average_k).exp()
    }

    /// Brake torque `M(ω)`, N·m, at reel speed `speed_rad_per_s`: paper (5) and (6), with Cross shear
    /// thinning `1/(1 + (λ (ν/ν0) γ̇)^m)` when it is on.
    #[inline(always)]
    pub fn torque_nm(&self, speed_rad_per_s: R, fluid_k: R, rotor_k: R) -> R {
        let thickening = self.thickening(fluid_k, rotor_k);
        let newtonian = self.torque_per_speed_nms * thickening * speed_rad_per_s;
        if !self.shear_thinning {
            return newtonian;
        }
        let group = self.cross_time_s * thickening * speed_rad_per_s.abs();
        newtonian / (R::constant(1.0) + group.power(self.cross_exponent))
    }

    /// The reel speed at which the brake's torque is `torque_nm` > 0, rad/s: paper (15) when the
    /// fluid does not thin with shear.
    #[inline(always)]
    pub fn speed_of_torque(&self, torque_nm: R, fluid_k: R, rotor_k: R) -> R {
        let thickening = self.thickening(fluid_k, rotor_k);
        let newtonian = torque_nm / (self.torque_per_speed_nms * thickening);
        if !self.shear_thinning {
            return newtonian;
        }
        self.thinned_speed(newtonian, thickening, R::constant(1.0))
    }

    /// The reel speed at which the brake takes up `power_w` > 0, rad/s.
    #[inline(always)]
    pub fn speed_of_power(&self, power_w: R, fluid_k: R, rotor_k: R) -> R {
        let thickening = self.thickening(fluid_k, rotor_k);
        let newtonian = (power_w / (self.torque_per_speed_nms * thickening)).sqrt();
        if !self.shear_thinning {
            return newtonian;
        }
        self.thinned_speed(newtonian, thickening, R::constant(2.0))
    }

    /// Solves `x^k = a^k (1 + x^m)` for the Cross group `x`, where `a` is the group at the Newtonian
    /// speed and `k` is 1 for a given torque and 2 for a given power.
    ///
    /// In `y = ln x` this reads `k (y − ln a) = ln(1 + e^{m y})`, whose left side minus right side is
    /// increasing and concave for `m` < 1: Newton's method from `ln a`, left of the root, rises to it
    /// monotonically and, the slope lying between `k − m` and `k`, in a few steps.
    #[inline(always)]
    fn thinned_speed(&self, newtonian_rad_per_s: R, thickening: R, order: R) -> R {
        let one = R::constant(1.0);
        let group_per_speed = self.cross_time_s * thickening;
        let ln_a = (group_per_speed * newtonian_rad_per_s).ln();
        let step = |y: R| {
            let growth = (self.cross_exponent * y).exp();
            let residual = order * (y - ln_a) - (one + growth).ln();
            let slope = order - self.cross_exponent * growth / (one + growth);
            residual / slope
        };
        let (mut y, mut last) = (ln_a, one);
        for _ in 0..INVERSION_STEPS {
            last = step(y);
            y = y - last;
        }
        for _ in 0..MORE_STEPS {
            if last.beyond(CONVERGED).is_zero() {
                break;
            }
            last = step(y).beyond(CONVERGED);
            y = y - last;
        }
        y.exp() / group_per_speed
    }
}
