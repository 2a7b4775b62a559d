//! A design as the equations use it: everything that stays constant during a descent, worked out once.

use super::balloon::Balloon;
use super::brake::Brake;
use super::design::Design;
use super::fluid::Fluid;
use super::parameters::Parameter;
use super::payload::Payload;
use super::reel::Reel;
use super::thermal::Thermal;
use crate::numerics::real::Real;

/// The constants of one descent, SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficients<R> {
    /// The reels.
    pub reel: Reel<R>,
    /// The fluid in its brake.
    pub fluid: Fluid<R>,
    /// The heat paths.
    pub thermal: Thermal<R>,
    /// The payload section.
    pub payload: Payload<R>,
    /// The tow balloon.
    pub balloon: Balloon<R>,
    /// Temperature of all nodes at release `T0`, K.
    pub initial_temperature_k: R,
}

impl<R: Real> Coefficients<R> {
    /// The constants of a design; `shear_thinning` says whether its Cross time constant is positive.
    pub fn with_shear_thinning(design: &Design<R>, shear_thinning: bool) -> Self {
        let brake = Brake::new(design);
        Coefficients {
            reel: Reel::new(design),
            fluid: Fluid::new(design, &brake, shear_thinning),
            thermal: Thermal::new(design),
            payload: Payload::new(design),
            balloon: Balloon::new(design),
            initial_temperature_k: design.get(Parameter::InitialTemperature),
        }
    }
}

impl Coefficients<f64> {
    /// The constants of a design.
    pub fn new(design: &Design<f64>) -> Self {
        Self::with_shear_thinning(design, design.get(Parameter::FluidCrossTimeConstant) > 0.0)
    }

    /// The same constants in another number type, without derivatives.
    pub fn lift<S: Real>(&self) -> Coefficients<S> {
        let c = S::constant;
        Coefficients {
            reel: Reel {
                line_length_m: c(self.reel.line_length_m),
                full_radius_squared_m2: c(self.reel.full_radius_squared_m2),
                squared_radius_slope_m: c(self.reel.squared_radius_slope_m),
                inertia_kg_m2: c(self.reel.inertia_kg_m2),
            },
            fluid: Fluid {
                torque_per_speed_nms: c(self.fluid.torque_per_speed_nms),
                viscosity_temperature_k: c(self.fluid.viscosity_temperature_k),
                averaging_offset: c(self.fluid.averaging_offset),
                cross_time_s: c(self.fluid.cross_time_s),
                cross_exponent: c(self.fluid.cross_exponent),
                shear_thinning: self.fluid.shear_thinning,
            },
            thermal: Thermal {
                fluid_capacity_j_per_k: c(self.thermal.fluid_capacity_j_per_k),
                rotor_capacity_j_per_k: c(self.thermal.rotor_capacity_j_per_k),
                housing_capacity_j_per_k: c(self.thermal.housing_capacity_j_per_k),
                fluid_rotor_w_per_k: c(self.thermal.fluid_rotor_w_per_k),
                fluid_housing_w_per_k: c(self.thermal.fluid_housing_w_per_k),
                rotor_housing_w_per_k: c(self.thermal.rotor_housing_w_per_k),
                air_w_per_k: c(self.thermal.air_w_per_k),
                air_k: c(self.thermal.air_k),
            },
            payload: Payload {
                weight_n: c(self.payload.weight_n),
                extraction_n_per_m: c(self.payload.extraction_n_per_m),
            },
            balloon: Balloon {
                moving_mass_kg: c(self.balloon.moving_mass_kg),
                net_lift_n: c(self.balloon.net_lift_n),
                drag_factor_kg_per_m: c(self.balloon.drag_factor_kg_per_m),
                rise_speed_m_per_s: c(self.balloon.rise_speed_m_per_s),
            },
            initial_temperature_k: c(self.initial_temperature_k),
        }
    }
}
