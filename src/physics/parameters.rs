//! The parameters of a design: their paths, quantities, baseline values and possible ranges.
//!
//! This table is the one list that study files, cards, the JSON Schema, Parquet columns and reports
//! are made from.

use crate::units::Quantity;

/// One parameter of a design; the discriminant is its place in [`PARAMETERS`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(usize)]
#[allow(missing_docs)] // each is described in PARAMETERS
pub enum Parameter {
    BrakeRotors,
    BrakeOuterRadius,
    BrakeInnerRadius,
    BrakeGap,
    FluidDensity,
    FluidNominalViscosity,
    FluidLotFactor,
    FluidViscosityCoefficient,
    FluidViscosityTemperature,
    FluidShearFactor,
    FluidAveragingOffset,
    FluidCrossTimeConstant,
    FluidCrossExponent,
    ReelLineLength,
    ReelFullRadius,
    ReelEmptyRadius,
    ReelInertia,
    PayloadWeight,
    PayloadExtractedWeight,
    BalloonMass,
    BalloonAddedMass,
    BalloonDragArea,
    BalloonAirDensity,
    BalloonFreeLift,
    ThermalFluidCapacity,
    ThermalRotorCapacity,
    ThermalHousingCapacity,
    ThermalFluidRotorConductance,
    ThermalFluidHousingConductance,
    ThermalRotorHousingConductance,
    ThermalAirConductance,
    ThermalAirTemperature,
    InitialTemperature,
    FluidConductivity,
    FluidExpansion,
    MetalConductivity,
    MetalHeatCapacity,
}

/// What is known of a parameter before anybody chooses its value.
#[derive(Debug, Clone, Copy)]
pub struct ParameterInfo {
    /// Which one.
    pub parameter: Parameter,
    /// Dotted path, as in study files and cards.
    pub path: &'static str,
    /// Letter in the equations.
    pub symbol: &'static str,
    /// Kind of quantity.
    pub quantity: Quantity,
    /// Baseline value, SI.
    pub baseline: f64,
    /// The baseline as an engineer writes it.
    pub baseline_text: &'static str,
    /// Smallest possible value, SI.
    pub lower: f64,
    /// Largest possible value, SI.
    pub upper: f64,
    /// Whether the ends of the range are themselves impossible.
    pub open: bool,
    /// What it is, in one line.
    pub description: &'static str,
    /// Where the baseline value comes from.
    pub source: &'static str,
}

/// Number of parameters.
pub const PARAMETER_COUNT: usize = 37;

const IN: f64 = 0.0254;
const FT: f64 = 0.3048;
const LBF: f64 = 4.448_221_615_260_5;
const CST: f64 = 1e-6;
/// 60 °F in kelvin.
const SIXTY_FAHRENHEIT: f64 = (60.0 + 459.67) / 1.8;
const INF: f64 = f64::INFINITY;

macro_rules! table {
    ($($name:ident, $path:literal, $symbol:literal, $quantity:ident, $baseline:expr, $text:literal,
       $lower:expr, $upper:expr, $open:literal, $description:literal, $source:literal;)*) => {
        /// Every parameter, in the order of [`Parameter`].
        pub static PARAMETERS: [ParameterInfo; PARAMETER_COUNT] = [$(ParameterInfo {
            parameter: Parameter::$name,
            path: $path,
            symbol: $symbol,
            quantity: Quantity::$quantity,
            baseline: $baseline,
            baseline_text: $text,
            lower: $lower,
            upper: $upper,
            open: $open,
            description: $description,
            source: $source,
        }),*];
    };
}

table! {
    BrakeRotors, "brake.rotors", "n", Number, 7.0, "7", 1.0, 1000.0, false,
        "number of rotors; each has two working surfaces", "reconstructed";
    BrakeOuterRadius, "brake.outer_radius", "ro", Length, 8.5 * IN, "8.5 in", 0.0, 100.0, true,
        "outer radius of the working surfaces", "reconstructed";
    BrakeInnerRadius, "brake.inner_radius", "ri", Length, 3.0 * IN, "3 in", 0.0, 100.0, false,
        "inner radius of the working surfaces", "reconstructed";
    BrakeGap, "brake.gap", "d", Length, 0.062 * IN, "0.062 in", 0.0, 1.0, true,
        "gap between rotor and stator, of every surface or of surface [k]", "reconstructed";
    FluidDensity, "fluid.density", "ρ", Density, 970.0, "970 kg/m³", 0.0, INF, true,
        "density of the brake fluid", "dimethyl silicone data";
    FluidNominalViscosity, "fluid.nominal_viscosity", "ν0", KinematicViscosity, 125_000.0 * CST,
        "125000 cSt", 0.0, INF, true, "nominal kinematic viscosity of the brake fluid", "paper";
    FluidLotFactor, "fluid.lot_factor", "f_lot", Number, 1.0, "1", 0.0, INF, true,
        "viscosity of the lot of fluid that is filled in, over the nominal one", "nominal";
    FluidViscosityCoefficient, "fluid.viscosity_coefficient", "A", Number, 0.003, "0.003", 0.0, INF,
        true, "coefficient A of the viscosity law", "paper";
    FluidViscosityTemperature, "fluid.viscosity_temperature", "B", TemperatureConstant, 1740.0,
        "1740 K", 0.0, INF, false, "temperature B of the viscosity law", "paper";
    FluidShearFactor, "fluid.shear_factor", "f", Number, 1.0, "1", 0.0, INF, true,
        "viscosity at the working shear rate over the law's", "paper: 1";
    FluidAveragingOffset, "fluid.averaging_offset", "ε", Number, 0.0, "0", -5.0, 5.0, false,
        "error of the single average temperature, as a share of fluid minus rotor temperature",
        "paper: 0";
    FluidCrossTimeConstant, "fluid.cross_time_constant", "λ", Time, 0.0, "0 s", 0.0, INF, false,
        "time constant of Cross shear thinning at the nominal viscosity; 0 is off", "off";
    FluidCrossExponent, "fluid.cross_exponent", "m", Number, 0.8, "0.8", 0.0, 1.0, true,
        "exponent of Cross shear thinning", "assumed";
    ReelLineLength, "reel.line_length", "L", Length, 500.0 * FT, "500 ft", 0.0, INF, true,
        "length of line paid out", "paper";
    ReelFullRadius, "reel.full_radius", "Ro", Length, 11.0 * IN, "11 in", 0.0, 100.0, true,
        "radius of the wound line at the start", "reconstructed";
    ReelEmptyRadius, "reel.empty_radius", "Ri", Length, 5.5 * IN, "5.5 in", 0.0, 100.0, true,
        "radius of the reel when the line is out", "reconstructed";
    ReelInertia, "reel.inertia", "J", Inertia, 30.0, "30 kg·m²", 0.0, INF, false,
        "moment of inertia of reels and shaft", "assumed";
    PayloadWeight, "payload.weight", "W2", Force, 6000.0 * LBF, "6000 lbf", 0.0, INF, true,
        "weight of the payload section at the start", "reconstructed";
    PayloadExtractedWeight, "payload.extracted_weight", "Wx", Force, 2000.0 * LBF, "2000 lbf", 0.0,
        INF, false, "weight of the main balloon and parachute pulled out along the line",
        "reconstructed";
    BalloonMass, "balloon.mass", "m_tow", Mass, 1000.0, "1000 kg", 0.0, INF, true,
        "mass of the tow balloon and its helium", "assumed";
    BalloonAddedMass, "balloon.added_mass", "m_added", Mass, 2000.0, "2000 kg", 0.0, INF, false,
        "added mass of the air moved by the tow balloon", "assumed";
    BalloonDragArea, "balloon.drag_area", "CdA", Area, 500.0, "500 m²", 0.0, INF, true,
        "drag area of the tow balloon", "assumed";
    BalloonAirDensity, "balloon.air_density", "ρ_air", Density, 0.30, "0.30 kg/m³", 0.0, INF, true,
        "density of the air", "assumed";
    BalloonFreeLift, "balloon.free_lift", "free lift", Number, 0.05, "5 %", 0.0, 10.0, false,
        "buoyancy above the total weight, as a share of it", "assumed";
    ThermalFluidCapacity, "thermal.fluid_capacity", "C1", HeatCapacity, 3990.0, "3990 J/K", 0.0,
        INF, true, "heat capacity of the fluid", "paper";
    ThermalRotorCapacity, "thermal.rotor_capacity", "C2", HeatCapacity, 21_100.0, "21100 J/K", 0.0,
        INF, true, "heat capacity of rotors and stators", "paper";
    ThermalHousingCapacity, "thermal.housing_capacity", "C3", HeatCapacity, 14_600.0, "14600 J/K",
        0.0, INF, true, "heat capacity of housing and shaft", "paper";
    ThermalFluidRotorConductance, "thermal.fluid_rotor_conductance", "K12", Conductance, 680.0,
        "680 W/K", 0.0, INF, false, "conductance between fluid and rotors", "paper";
    ThermalFluidHousingConductance, "thermal.fluid_housing_conductance", "K13", Conductance, 47.5,
        "47.5 W/K", 0.0, INF, false, "conductance between fluid and housing", "paper";
    ThermalRotorHousingConductance, "thermal.rotor_housing_conductance", "K23", Conductance, 9.5,
        "9.5 W/K", 0.0, INF, false, "conductance between rotors and housing", "paper";
    ThermalAirConductance, "thermal.air_conductance", "Ka", Conductance, 0.0, "0 W/K", 0.0, INF,
        false, "conductance between housing and air", "paper: neglected";
    ThermalAirTemperature, "thermal.air_temperature", "Ta", Temperature, SIXTY_FAHRENHEIT, "60 °F",
        0.0, 2000.0, true, "temperature of the air", "assumed";
    InitialTemperature, "initial.temperature", "T0", Temperature, SIXTY_FAHRENHEIT, "60 °F", 0.0,
        2000.0, true, "temperature of fluid, rotors and housing at release", "paper";
    FluidConductivity, "fluid.conductivity", "k_f", Conductivity, 0.16, "0.16 W/m/K", 0.0, INF,
        true, "thermal conductivity of the fluid (detailed models)", "dimethyl silicone data";
    FluidExpansion, "fluid.expansion", "α", Expansion, 0.0, "0 %/K", 0.0, 0.1, false,
        "thermal expansion of the fluid, which thins it beyond the viscosity law (detailed models)",
        "paper: neglected";
    MetalConductivity, "metal.conductivity", "k_m", Conductivity, 45.0, "45 W/m/K", 0.0, INF, true,
        "thermal conductivity of rotors and stators (detailed models)", "assumed: carbon steel";
    MetalHeatCapacity, "metal.heat_capacity", "c_v", VolumetricHeatCapacity, 3.6e6,
        "3.6 MJ/m³/K", 0.0, INF, true,
        "heat capacity by volume of rotors and stators (detailed models)", "assumed: carbon steel";
}

impl Parameter {
    /// The parameter's entry in [`PARAMETERS`].
    pub fn info(self) -> &'static ParameterInfo {
        &PARAMETERS[self as usize]
    }

    /// The parameter of a dotted path.
    pub fn from_path(path: &str) -> Option<Parameter> {
        PARAMETERS.iter().find(|info| info.path == path).map(|info| info.parameter)
    }
}

impl ParameterInfo {
    /// Whether `value` (SI) is possible for this parameter.
    pub fn admits(&self, value: f64) -> bool {
        value.is_finite()
            && if self.open {
                value > self.lower && value < self.upper
            } else {
                value >= self.lower && value <= self.upper
            }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn property_the_table_is_in_the_order_of_the_names_and_admits_its_baselines() {
        for (place, info) in PARAMETERS.iter().enumerate() {
            assert_eq!(info.parameter as usize, place, "{}", info.path);
            assert!(info.admits(info.baseline), "{}", info.path);
            assert_eq!(Parameter::from_path(info.path), Some(info.parameter));
        }
    }
}
