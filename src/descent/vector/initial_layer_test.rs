//! The initial layer against fine steps from rest.

use super::super::rosenbrock;
use super::super::start::at_rest;
use super::super::{Settings, descend};
use super::*;
use crate::descent::{Fault, Model};
use crate::numerics::elementary::{exp, ln};
use crate::physics::{Coefficients, Design, Parameter, Target};

/// The baseline with its viscosity times a factor, at another temperature.
fn constants(viscosity: f64, temperature_k: f64) -> Constants<f64> {
    let mut design = Design::baseline();
    let nominal = design.get(Parameter::FluidNominalViscosity);
    design.set(Target::whole(Parameter::FluidNominalViscosity), nominal * viscosity);
    design.set(Target::whole(Parameter::InitialTemperature), temperature_k);
    Constants::new(&Coefficients::new(&design))
}

/// State and largest tension after thirty time constants in `steps` equal steps.
fn integrate(
    k: &Constants<f64>,
    from: [f64; STATES],
    tau: f64,
    steps: u32,
) -> ([f64; STATES], f64) {
    let clock = Clock { length: 0.0, time: 1.0 };
    let system = Dynamic { constants: *k, clock, any_cross: false };
    let (mut y, mut tension) = (from, 0.0f64);
    for _ in 0..steps {
        let moment = system.moment(&y);
        tension = tension.max(system.observe(&y, &moment)[1]);
        y = rosenbrock::step(&system, &y, &moment, 30.0 * tau / f64::from(steps)).state;
    }
    (y, tension)
}

#[test]
fn property_the_outer_solution_is_met_when_the_layer_has_passed() {
    let mut met = 0;
    for viscosity in [0.6, 0.8, 1.0, 1.5, 3.0, 10.0] {
        for temperature_k in [260.0, 280.0, 300.0] {
            let k = constants(viscosity, temperature_k);
            let layer = Layer::new(&k);
            let (outcomes, peaks) = layer.left_out(&k);
            if outcomes > 1e-4 {
                continue;
            }
            met += 1;
            let start = layer.state(&k);
            let (real, tension) = integrate(&k, at_rest(&k).state, layer.tau, 4000);
            let (outer, _) = integrate(&k, start, layer.tau, 4000);
            let b = -k.minus_viscosity_temperature / (real[3] * real[3]);
            // What a difference does to time, velocity and temperature, as in the error norm.
            let line = (outer[0] - real[0]).abs() / k.length;
            let heat = 0.15 * b * (outer[3] - real[3]).abs() + b * (outer[4] - real[4]).abs();
            let pull = 0.01 * (outer[2] / real[2] - 1.0).abs();
            let off = line + heat + pull;
            assert!(off <= outcomes, "{viscosity} {temperature_k}: {off:e} for {outcomes:e}");
            let off = (layer.peaks(&k, &start).1[1] / tension - 1.0).abs();
            assert!(off <= 1.1 * peaks, "{viscosity} {temperature_k}: {off:e} for {peaks:e}");
        }
    }
    assert!(met >= 12, "{met} cases lie within the expansion's reach");
}

/// The expansion's coefficients: with every other small number out of the way, what is left out of the way
/// and the warming falls with the square of `ε`.
#[test]
fn analytic_what_is_left_out_is_of_second_order() {
    let off = |viscosity: f64| {
        let mut k = constants(viscosity, 290.0);
        k.extraction = 0.0;
        k.share_slope = 0.0;
        k.radius_slope = 0.0;
        k.spool_pull = 0.0;
        k.drag = 0.0;
        k.free_lift = 0.0;
        k.fluid_rotor_1 = 0.0;
        k.fluid_housing_1 = 0.0;
        let layer = Layer::new(&k);
        let (real, _) = integrate(&k, at_rest(&k).state, layer.tau, 8000);
        let (outer, _) = integrate(&k, layer.state(&k), layer.tau, 8000);
        let way = (outer[0] - real[0]) / layer.way;
        let warming = (outer[3] - real[3]) / layer.heat;
        (layer.eps, way.abs(), warming.abs())
    };
    let (thick, thin) = (off(4.0), off(2.0));
    let ratio = ln(thin.0 / thick.0);
    for (large, small) in [(thin.1, thick.1), (thin.2, thick.2)] {
        let order = ln(large / small) / ratio;
        assert!((1.8..2.4).contains(&order), "order {order}: {small:e}, {large:e}");
    }
}

/// Designs of every kind: wherever one starts beyond the layer, its outcomes keep to fifteen times the tolerance and its
/// peaks to a hundred times it, as a stress set's do.
#[test]
fn property_whatever_starts_beyond_the_layer_keeps_the_tolerance() {
    use Parameter as P;
    // Factors on the baseline, from … to, spread evenly in their logarithm.
    let spreads = [
        (P::ReelLineLength, 0.03, 3.0),
        (P::PayloadWeight, 0.06, 2.0),
        (P::FluidNominalViscosity, 0.05, 4.0),
        (P::ThermalFluidCapacity, 0.2, 100.0),
        (P::BalloonDragArea, 0.005, 3.0),
        (P::BalloonMass, 0.1, 3.0),
        (P::ReelInertia, 0.01, 5.0),
        (P::ThermalFluidRotorConductance, 0.01, 10.0),
        (P::PayloadExtractedWeight, 0.02, 1.0),
    ];
    let baseline = Design::baseline();
    let mut state = 12_345u64;
    let mut uniform = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut batch = Vec::new();
    for _ in 0..4000 {
        let mut design = baseline.clone();
        let mut weight = 1.0;
        for (parameter, from, to) in spreads {
            let factor = exp(ln(from) + (ln(to) - ln(from)) * uniform());
            weight = if parameter == P::PayloadWeight { factor } else { weight };
            let scale = if parameter == P::PayloadExtractedWeight { weight } else { 1.0 };
            design.set(Target::whole(parameter), baseline.get(parameter) * factor * scale);
        }
        batch.push(Coefficients::new(&design));
    }
    let results = |tolerance: f64, batch: &[Coefficients<f64>]| {
        let mut results = vec![Err(Fault::NotFinite); batch.len()];
        descend(Model::Dynamic, &Settings { tolerance }, batch, &mut results);
        results
    };
    for tolerance in [1e-5, 1e-6, 1e-7] {
        let local_tolerance = Settings { tolerance }.attempt().local_tolerance(Model::Dynamic);
        let mut beyond = batch.clone();
        beyond.retain(|c| passed(&Constants::new(c), local_tolerance).0);
        assert!(beyond.len() > 100, "{} of them start beyond the layer", beyond.len());
        for (k, pair) in results(tolerance, &beyond).iter().zip(results(1e-11, &beyond)).enumerate()
        {
            let (Ok(got), Ok(exact)) = pair else { panic!("{k}: {pair:?}") };
            for (n, (got, exact)) in got.values.iter().zip(&exact.values).enumerate() {
                let allowed = if n < 3 { 15.0 } else { 100.0 } * tolerance;
                let off = (got / exact - 1.0).abs();
                assert!(off <= allowed, "{k}: outcome {n} off by {off:e} at {tolerance:e}");
            }
        }
    }
}
