//! Hard but possible designs: every parameter ranges over a factor of 1.6 to 5 both ways, and the reels' inertia over eighty.

use rand::RngExt;
use reeldown::numerics::elementary::{exp, ln};
use reeldown::physics::{Coefficients, Design, Parameter, Target};
use reeldown::streams::{Purpose, Stream, stream};

/// A parameter and the factor by which it ranges both ways about its baseline.
const RANGES: [(Parameter, f64); 23] = [
    (Parameter::BrakeOuterRadius, 1.26),
    (Parameter::BrakeInnerRadius, 1.6),
    (Parameter::BrakeGap, 1.6),
    (Parameter::FluidDensity, 1.6),
    (Parameter::FluidNominalViscosity, 5.0),
    (Parameter::FluidViscosityTemperature, 1.26),
    (Parameter::FluidShearFactor, 1.6),
    (Parameter::ReelLineLength, 1.75),
    (Parameter::ReelFullRadius, 1.26),
    (Parameter::ReelEmptyRadius, 1.5),
    (Parameter::PayloadWeight, 1.6),
    (Parameter::PayloadExtractedWeight, 3.0),
    (Parameter::BalloonMass, 4.0),
    (Parameter::BalloonAddedMass, 3.0),
    (Parameter::BalloonDragArea, 3.0),
    (Parameter::BalloonAirDensity, 3.0),
    (Parameter::BalloonFreeLift, 5.0),
    (Parameter::ThermalFluidCapacity, 4.0),
    (Parameter::ThermalRotorCapacity, 3.0),
    (Parameter::ThermalHousingCapacity, 3.0),
    (Parameter::ThermalFluidRotorConductance, 4.0),
    (Parameter::ThermalFluidHousingConductance, 4.0),
    (Parameter::ThermalRotorHousingConductance, 5.0),
];

fn uniform(stream: &mut Stream, low: f64, high: f64) -> f64 {
    low + (high - low) * stream.random::<f64>()
}

fn log_uniform(stream: &mut Stream, low: f64, high: f64) -> f64 {
    exp(uniform(stream, ln(low), ln(high)))
}

/// Hard design `k`. Two of three thin with shear, one in two loses heat to the air, which may be colder or warmer.
pub fn hard_design(k: usize) -> Design {
    let rng = &mut stream(2026, Purpose::Test, k as u64);
    loop {
        let mut design = Design::baseline();
        let mut set = |parameter, value| design.set(Target::whole(parameter), value);
        for (parameter, factor) in RANGES {
            set(parameter, parameter.info().baseline * log_uniform(rng, 1.0 / factor, factor));
        }
        set(Parameter::ReelInertia, log_uniform(rng, 6.0, 480.0));
        set(Parameter::FluidAveragingOffset, uniform(rng, -0.4, 0.4));
        set(Parameter::InitialTemperature, uniform(rng, 250.0, 311.0));
        if rng.random::<f64>() < 2.0 / 3.0 {
            set(Parameter::FluidCrossTimeConstant, log_uniform(rng, 0.001, 1.0));
            set(Parameter::FluidCrossExponent, uniform(rng, 0.25, 0.95));
        }
        if rng.random::<f64>() < 0.5 {
            set(Parameter::ThermalAirConductance, log_uniform(rng, 1.0, 200.0));
            set(Parameter::ThermalAirTemperature, uniform(rng, 220.0, 310.0));
        }
        if design.is_possible() {
            return design;
        }
    }
}

/// The constants of hard designs.
pub fn hard_designs(count: usize) -> Vec<Coefficients<f64>> {
    (0..count).map(|k| Coefficients::new(&hard_design(k))).collect()
}
