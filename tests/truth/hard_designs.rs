//! Hard but possible designs: every parameter ranges over a factor of 1.6 to 5 both ways, and the reels' inertia over eighty.

use crate::reference_descents::design;
use rand::RngExt;
use reeldown::descent::vector::{Settings, descend};
use reeldown::descent::{Fault, Model, Outcome, OutcomeQuantity, reference};
use reeldown::numerics::elementary::{exp, ln};
use reeldown::physics::{Coefficients, Design, Parameter, Target};
use reeldown::streams::{Purpose, Stream, stream};
use serde_json::Value;

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

/// Integrates on every core.
fn run(model: Model, tolerance: f64, batch: &[Coefficients<f64>]) -> Vec<Result<Outcome, Fault>> {
    let mut results = vec![Err(Fault::NotFinite); batch.len()];
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let share = batch.len().div_ceil(threads).max(1);
    std::thread::scope(|scope| {
        for (batch, results) in batch.chunks(share).zip(results.chunks_mut(share)) {
            scope.spawn(move || descend(model, &Settings { tolerance }, batch, results));
        }
    });
    results
}

/// Asserts that no outcome errs by more than is promised at a tolerance, and returns how many are faults in either.
fn promise_holds(
    model: Model,
    tolerance: f64,
    got: &[Result<Outcome, Fault>],
    right: &[Result<Outcome, Fault>],
) -> usize {
    let settings = Settings { tolerance };
    let mut faults = 0;
    let mut worst = [0.0f64; 10];
    for (k, pair) in got.iter().zip(right).enumerate() {
        let (Ok(got), Ok(right)) = pair else {
            faults += 1;
            continue;
        };
        for quantity in OutcomeQuantity::ALL {
            let error = (got.get(quantity) / right.get(quantity) - 1.0).abs();
            let worst = &mut worst[quantity as usize];
            *worst = worst.max(error / settings.promise(quantity));
            assert!(
                error <= settings.promise(quantity),
                "{} at {tolerance:e}, design {k}, {}: {error:e}",
                model.name(),
                quantity.name()
            );
        }
    }
    println!("{} {tolerance:e}: {faults} faults, shares of the promise {worst:.2?}", model.name());
    faults
}

/// The promise of `Settings::promise` on 60 000 hard designs at each tolerance that is asked for in practice, against runs
/// at 1e-9, and at the tighter ones on a tenth of them, against runs at 1e-11. What cannot be kept is withheld: a few in a
/// hundred thousand.
#[test]
fn property_the_promise_holds_on_hard_designs() {
    let designs = hard_designs(60_000);
    for model in Model::THREE_NODES {
        let right = run(model, 1e-9, &designs);
        for tolerance in [1e-3, 1e-4, 1e-5, 1e-6] {
            let faults = promise_holds(model, tolerance, &run(model, tolerance, &designs), &right);
            assert!(faults <= 6, "{faults} faults");
        }
        let right = run(model, 1e-11, &designs[..6000]);
        for tolerance in [1e-7, 1e-8] {
            let got = run(model, tolerance, &designs[..6000]);
            assert!(promise_holds(model, tolerance, &got, &right) <= 1);
        }
    }
}

/// The same of the detailed models, whose few points in space at loose tolerances do not resolve every film: against runs
/// at 1e-6, which has more points.
#[test]
fn property_the_promise_of_the_detailed_models_holds_on_hard_designs() {
    let designs = hard_designs(1500);
    for model in [Model::DetailedDynamic, Model::DetailedQuasiSteady] {
        let right = run(model, 1e-7, &designs);
        for tolerance in [1e-3, 1e-4, 1e-5] {
            let faults = promise_holds(model, tolerance, &run(model, tolerance, &designs), &right);
            assert!(faults <= 15, "{faults} faults");
        }
    }
}

/// Against the plain integrator (Radau IIA of order five, at 1e-9), which shares no code with the lanes.
#[test]
fn reference_radau_agrees_on_hard_designs() {
    let designs = hard_designs(120);
    for model in Model::THREE_NODES {
        let right: Vec<_> = designs.iter().map(|c| reference::descend(c, model, 1e-9)).collect();
        for tolerance in [1e-3, 1e-6] {
            let got = run(model, tolerance, &designs);
            assert_eq!(promise_holds(model, tolerance, &got, &right), 0);
        }
    }
}

/// Designs on which an earlier integrator returned times of −98 s, velocities of −17 567 m/s and tensions that were wrong by
/// up to 2 240 times the tolerance.
#[test]
fn regression_designs_that_came_out_impossible() {
    let text = include_str!("references/hard_designs.json");
    let file: Value = serde_json::from_str(text).expect("the committed references are JSON");
    for case in file["designs"].as_array().expect("a list") {
        let model = Model::from_name(case["model"].as_str().expect("a name")).expect("a model");
        let tolerance = case["tolerance"].as_str().expect("a text").parse().expect("a number");
        let c = Coefficients::new(&design(&case["parameters"]));
        let got = run(model, tolerance, &[c])[0].expect("an ordinary descent");
        for (name, right) in case["right"].as_object().expect("outcomes") {
            let quantity = OutcomeQuantity::from_name(name).expect("an outcome");
            let error = (got.get(quantity) / right.as_f64().expect("a number") - 1.0).abs();
            let promise = Settings { tolerance }.promise(quantity);
            assert!(error <= promise, "{} {tolerance:e} {name}: {error:e}", model.name());
        }
    }
}

/// Strong thinning and heavy reels: at release the tension overshoots. At 1e-6 an earlier integrator said more than
/// 16 510 N; the plain integrator says 16 489 N.
#[test]
fn regression_tension_of_a_thinning_fluid_at_release() {
    let mut design = Design::baseline();
    design.set(Target::whole(Parameter::FluidCrossTimeConstant), 0.71);
    design.set(Target::whole(Parameter::ReelInertia), 285.0);
    let c = Coefficients::new(&design);
    let right = reference::descend(&c, Model::Dynamic, 1e-9).expect("an ordinary descent");
    let tension = right.get(OutcomeQuantity::PeakTension);
    println!("{tension}");
    assert!((tension - 16_489.0).abs() < 1.0, "{tension}");
    let got = run(Model::Dynamic, 1e-6, &[c]);
    assert_eq!(promise_holds(Model::Dynamic, 1e-6, &got, &[Ok(right)]), 0);
}

/// A Cross exponent near one: the speed sought is a large multiple of the Newtonian one, and Newton's method takes as many
/// steps as it needs. The speed found must give the torque that was asked for; slope of the logarithm of the torque is
/// 1 − m there, so that a rounding of the torque is 1/(1 − m) roundings of the speed.
#[test]
fn property_the_speed_found_gives_the_torque_near_exponent_one() {
    for exponent in [0.5, 0.9, 0.99, 0.995, 0.999] {
        for time_constant in [1e-4, 1e-2, 1.0] {
            let mut design = Design::baseline();
            design.set(Target::whole(Parameter::FluidCrossTimeConstant), time_constant);
            design.set(Target::whole(Parameter::FluidCrossExponent), exponent);
            let fluid = Coefficients::new(&design).fluid;
            for torque in [10.0, 1000.0, 5000.0] {
                let speed = fluid.speed_of_torque(torque, 320.0, 310.0);
                let again = fluid.torque_nm(speed, 320.0, 310.0);
                if speed.is_finite() && again.is_finite() {
                    let miss = (again / torque - 1.0).abs();
                    assert!(miss < 1e-11, "{exponent} {time_constant} {torque}: {speed} {miss:e}");
                }
            }
        }
    }
}

/// In the quasi-steady model the velocity is that of the balance at every moment, so that the two integrators, each with
/// its own solution for it, must find the same descents near exponent one, or a fault.
#[test]
fn reference_quasi_steady_descents_near_exponent_one() {
    let mut descents = 0;
    for exponent in [0.99, 0.995, 0.999] {
        for time_constant in [1e-4, 2e-4, 4e-4, 1e-3] {
            for model in [Model::QuasiSteady, Model::DetailedQuasiSteady] {
                let mut design = Design::baseline();
                design.set(Target::whole(Parameter::FluidCrossTimeConstant), time_constant);
                design.set(Target::whole(Parameter::FluidCrossExponent), exponent);
                let c = Coefficients::new(&design);
                let got = run(model, 1e-6, &[c]);
                let right = [reference::descend(&c, model, 1e-9)];
                println!("{exponent} {time_constant} {:?}", got[0].map(|o| o.values[0]));
                if got[0].is_ok() {
                    assert_eq!(promise_holds(model, 1e-6, &got, &right), 0);
                    descents += 1;
                }
            }
        }
    }
    assert!(descents >= 6, "{descents} of 24");
}
