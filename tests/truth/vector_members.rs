//! Members of the default study and of a stress set, drawn from the laws of the default card in closed
//! form, for the tests of the vector integrator.

use rand::RngExt;
use reeldown::numerics::elementary::{cos, exp, ln};
use reeldown::physics::{Coefficients, Design, Parameter, Target};
use reeldown::streams::{Purpose, Stream, stream};

fn uniform(stream: &mut Stream) -> f64 {
    stream.random::<f64>().max(1e-300)
}

/// Standard normal by Box and Muller.
fn normal(stream: &mut Stream) -> f64 {
    let radius = (-2.0 * ln(uniform(stream))).sqrt();
    radius * cos(std::f64::consts::TAU * uniform(stream))
}

fn truncated_normal(stream: &mut Stream, lower: f64, upper: f64) -> f64 {
    loop {
        let z = normal(stream);
        if (lower..=upper).contains(&z) {
            return z;
        }
    }
}

fn fahrenheit(degrees: f64) -> f64 {
    (degrees + 459.67) / 1.8
}

fn scale(design: &mut Design, parameter: Parameter, factor: f64) {
    let value = design.get(parameter);
    design.set(Target::whole(parameter), value * factor);
}

/// A design with every uncertain input drawn.
fn draw(stream: &mut Stream) -> Design {
    let mut design = Design::baseline();
    for surface in 0..design.surfaces() {
        let gap_in = 0.062 + 0.003 * truncated_normal(stream, -3.0, 3.0);
        design.set(Target::gap(surface), gap_in * 0.0254);
    }
    scale(&mut design, Parameter::FluidShearFactor, exp(0.08 * normal(stream)));
    design.set(Target::whole(Parameter::FluidAveragingOffset), 0.1 * normal(stream));
    for (parameter, spread) in [
        (Parameter::ThermalFluidCapacity, 0.08),
        (Parameter::ThermalRotorCapacity, 0.08),
        (Parameter::ThermalHousingCapacity, 0.08),
        (Parameter::ThermalFluidRotorConductance, 0.15),
        (Parameter::ThermalFluidHousingConductance, 0.15),
        (Parameter::ThermalRotorHousingConductance, 0.15),
    ] {
        scale(&mut design, parameter, exp(spread * normal(stream)));
    }
    let warm = 60.0 + 10.0 * truncated_normal(stream, -6.0, 4.0);
    design.set(Target::whole(Parameter::InitialTemperature), fahrenheit(warm));
    design
}

/// Members of the default study.
pub fn default_study(count: usize) -> Vec<Coefficients<f64>> {
    (0..count)
        .map(|k| Coefficients::new(&draw(&mut stream(1993, Purpose::Test, k as u64))))
        .collect()
}

/// The stress set: viscosity × 0.2 … × 5, 0 … 100 °F; every third thins with shear, every tenth is so thick
/// that it does not deploy.
pub fn stress(count: usize) -> Vec<Coefficients<f64>> {
    (0..count)
        .map(|k| {
            let rng = &mut stream(1994, Purpose::Test, k as u64);
            let mut design = draw(rng);
            let factor = if k % 10 == 0 {
                5.0 + 20.0 * uniform(rng)
            } else {
                0.2 * exp(ln(25.0) * uniform(rng))
            };
            scale(&mut design, Parameter::FluidNominalViscosity, factor);
            let warm = fahrenheit(100.0 * uniform(rng));
            design.set(Target::whole(Parameter::InitialTemperature), warm);
            if k % 3 == 0 {
                let time_constant = 0.0005 * exp(ln(200.0) * uniform(rng));
                design.set(Target::whole(Parameter::FluidCrossTimeConstant), time_constant);
                let exponent = 0.3 + 0.6 * uniform(rng);
                design.set(Target::whole(Parameter::FluidCrossExponent), exponent);
            }
            Coefficients::new(&design)
        })
        .collect()
}
