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
}
