//! The heat: three nodes, fluid, rotors and stators, housing and shaft.

use super::design::Design;
use super::parameters::Parameter;
use crate::numerics::real::Real;

/// Thermal constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thermal<R> {
    /// Heat capacity of the fluid `C1`, J/K.
    pub fluid_capacity_j_per_k: R,
    /// Heat capacity of rotors and stators `C2`, J/K.
    pub rotor_capacity_j_per_k: R,
    /// Heat capacity of housing and shaft `C3`, J/K.
    pub housing_capacity_j_per_k: R,
    /// Conductance fluid–rotors `K12`, W/K.
    pub fluid_rotor_w_per_k: R,
    /// Conductance fluid–housing `K13`, W/K.
    pub fluid_housing_w_per_k: R,
    /// Conductance rotors–housing `K23`, W/K.
    pub rotor_housing_w_per_k: R,
    /// Conductance housing–air `Ka`, W/K.
    pub air_w_per_k: R,
    /// Air temperature `Ta`, K.
    pub air_k: R,
}

impl<R: Real> Thermal<R> {
    /// The thermal model of a design.
    #[inline(always)]
    pub fn new(design: &Design<R>) -> Self {
        let get = |parameter| design.get(parameter);
        Thermal {
            fluid_capacity_j_per_k: get(Parameter::ThermalFluidCapacity),
            rotor_capacity_j_per_k: get(Parameter::ThermalRotorCapacity),
            housing_capacity_j_per_k: get(Parameter::ThermalHousingCapacity),
            fluid_rotor_w_per_k: get(Parameter::ThermalFluidRotorConductance),
            fluid_housing_w_per_k: get(Parameter::ThermalFluidHousingConductance),
            rotor_housing_w_per_k: get(Parameter::ThermalRotorHousingConductance),
            air_w_per_k: get(Parameter::ThermalAirConductance),
            air_k: get(Parameter::ThermalAirTemperature),
        }
    }

    /// Rates of the three temperatures, K/s, with `power_w` dissipated in the fluid: paper (16), (17)
    /// and a loss to the air from the housing.
    #[inline(always)]
    pub fn rates(&self, temperatures_k: [R; 3], power_w: R) -> [R; 3] {
        let [fluid, rotor, housing] = temperatures_k;
        let to_rotor = self.fluid_rotor_w_per_k * (fluid - rotor);
        let to_housing = self.fluid_housing_w_per_k * (fluid - housing);
        let rotor_to_housing = self.rotor_housing_w_per_k * (rotor - housing);
        let to_air = self.air_w_per_k * (housing - self.air_k);
        [
            (power_w - to_rotor - to_housing) / self.fluid_capacity_j_per_k,
            (to_rotor - rotor_to_housing) / self.rotor_capacity_j_per_k,
            (to_housing + rotor_to_housing - to_air) / self.housing_capacity_j_per_k,
        ]
    }
}
