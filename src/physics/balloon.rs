//! The tow balloon: buoyancy, drag, and the air that moves with it.

use super::GRAVITY;
use super::parameters::Parameter;
use crate::numerics::real::Real;

/// Tow balloon constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Balloon<R> {
    /// Moving mass `m_tow + m_added`, kg.
    pub moving_mass_kg: R,
    /// Net lift without drag and extracted weight `B − W1`, N.
    pub net_lift_n: R,
    /// `½ ρ_air CdA`, kg/m.
    pub drag_factor_kg_per_m: R,
    /// Steady rise speed before release `v0`, m/s, at which the drag takes up the free lift.
    pub rise_speed_m_per_s: R,
}

impl<R: Real> Balloon<R> {
    /// The tow balloon of a design's values, carrying the whole payload before release.
    #[inline(always)]
    pub fn new(get: impl Fn(Parameter) -> R) -> Self {
        let own_weight = get(Parameter::BalloonMass) * R::constant(GRAVITY);
        let weight = own_weight + get(Parameter::PayloadWeight);
        let free_lift = get(Parameter::BalloonFreeLift) * weight;
        let drag_factor =
            R::constant(0.5) * get(Parameter::BalloonAirDensity) * get(Parameter::BalloonDragArea);
        Balloon {
            moving_mass_kg: get(Parameter::BalloonMass) + get(Parameter::BalloonAddedMass),
            net_lift_n: free_lift + get(Parameter::PayloadWeight),
            drag_factor_kg_per_m: drag_factor,
            rise_speed_m_per_s: (free_lift / drag_factor).sqrt(),
        }
    }

    /// Aerodynamic drag at upward speed `V1`, N, positive downward: `½ ρ_air CdA V1 |V1|`.
    pub fn drag_n(&self, speed_m_per_s: R) -> R {
        self.drag_factor_kg_per_m * speed_m_per_s * speed_m_per_s.abs()
    }
}
