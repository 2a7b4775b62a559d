//! A design as the equations use it: everything that stays constant during a descent, worked out once.

use super::balloon::Balloon;
use super::brake::Brake;
use super::design::Design;
use super::film::Film;
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
    /// The brake in detail, which the detailed models use in place of two of the three nodes.
    pub film: Film<R>,
    /// Temperature of all nodes at release `T0`, K.
    pub initial_temperature_k: R,
}

impl<R: Real> Coefficients<R> {
    /// The constants of a design; `shear_thinning` says whether its Cross time constant is positive.
    #[inline(always)]
    pub fn with_shear_thinning(design: &Design<R>, shear_thinning: bool) -> Self {
        let brake = Brake::new(design);
        Coefficients {
            reel: Reel::new(design),
            fluid: Fluid::new(design, &brake, shear_thinning),
            thermal: Thermal::new(design),
            payload: Payload::new(design),
            balloon: Balloon::new(|parameter| design.get(parameter)),
            film: Film::new(design),
            initial_temperature_k: design.get(Parameter::InitialTemperature),
        }
    }
}

macro_rules! fields {
    ($($part:ident: $Part:ident { $($name:ident,)* } $also:tt)*) => {
        /// Number of constants of one descent, apart from whether the fluid thins with shear.
        pub const FIELD_COUNT: usize = 1 $($(+ { let _ = stringify!($name); 1 })*)*;

        impl<R: Real> Coefficients<R> {
            /// All constants in a row, in the order that [`Coefficients::from_fields`] takes them.
            #[inline(always)]
            pub fn fields(&self) -> [R; FIELD_COUNT] {
                [$($(self.$part.$name,)*)* self.initial_temperature_k]
            }

            /// The constants out of a row of them: how several descents are laid side by side.
            #[inline(always)]
            pub fn from_fields(fields: [R; FIELD_COUNT], shear_thinning: bool) -> Self {
                let [$($($name,)*)* initial_temperature_k] = fields;
                Coefficients {
                    $($part: fields!(@part $Part { $($name,)* } $also shear_thinning),)*
                    initial_temperature_k,
                }
            }
        }
    };
    (@part $Part:ident { $($name:ident,)* } [] $thins:ident) => { $Part { $($name,)* } };
    (@part $Part:ident { $($name:ident,)* } [thins] $thins:ident) => {
        $Part { $($name,)* shear_thinning: $thins }
    };
}

fields! {
    reel: Reel {
        line_length_m, full_radius_squared_m2, squared_radius_slope_m, inertia_kg_m2,
    } []
    fluid: Fluid {
        torque_per_speed_nms, viscosity_temperature_k, averaging_offset, cross_time_s,
        cross_exponent,
    } [thins]
    thermal: Thermal {
        fluid_capacity_j_per_k, rotor_capacity_j_per_k, housing_capacity_j_per_k,
        fluid_rotor_w_per_k, fluid_housing_w_per_k, rotor_housing_w_per_k, air_w_per_k, air_k,
    } []
    payload: Payload { weight_n, extraction_n_per_m, } []
    balloon: Balloon {
        moving_mass_kg, net_lift_n, drag_factor_kg_per_m, rise_speed_m_per_s,
    } []
    film: Film {
        middle_radius_m, half_width_m, conduction_per_s, cross_time_s_per_m, spreading_per_s,
        expansion_per_k,
    } []
}

impl Coefficients<f64> {
    /// The constants of a design.
    pub fn new(design: &Design<f64>) -> Self {
        Self::with_shear_thinning(design, design.get(Parameter::FluidCrossTimeConstant) > 0.0)
    }

    /// The same constants in another number type, without derivatives.
    pub fn lift<S: Real>(&self) -> Coefficients<S> {
        Coefficients::from_fields(self.fields().map(S::constant), self.fluid.shear_thinning)
    }
}
