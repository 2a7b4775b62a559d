//! The derivatives of the outcomes against central differences of the reference integrator.

use reeldown::descent::gradient::gradient;
use reeldown::descent::vector::{Settings, descend};
use reeldown::descent::{Fault, Model, Outcome, reference};
use reeldown::physics::{Coefficients, Design, PARAMETERS, Parameter, Target};

fn targets() -> Vec<Target> {
    let whole = PARAMETERS.iter().map(|info| Target::whole(info.parameter));
    whole.chain([Target::gap(0), Target::gap(13)]).collect()
}

/// Designs: the baseline, one with thinning, offset and air, one near runaway.
fn designs() -> [Design; 3] {
    let with = |settings: &[(Parameter, f64)]| {
        let mut design = Design::baseline();
        for &(parameter, value) in settings {
            design.set(Target::whole(parameter), value);
        }
        design
    };
    [
        with(&[(Parameter::FluidAveragingOffset, 0.05)]),
        with(&[
            (Parameter::FluidCrossTimeConstant, 0.01),
            (Parameter::FluidAveragingOffset, -0.1),
            (Parameter::ThermalAirConductance, 20.0),
            (Parameter::ThermalAirTemperature, 250.0),
        ]),
        with(&[(Parameter::FluidNominalViscosity, 0.08), (Parameter::FluidAveragingOffset, 0.2)]),
    ]
}

/// How far a target is moved for a difference: one part in ten thousand of it, so that third derivatives
/// cost 1e-8 and the reference's 1e-11 over the move 1e-7, both times what the outcomes amplify. An outcome that goes as
/// the power n of a target costs n³ · 1e-8/6 then, and the detailed models have n = 54: theirs is a third of that.
fn move_of(model: Model, design: &Design, target: Target) -> f64 {
    let share = if model.is_detailed() { 3e-5 } else { 1e-4 };
    match target.parameter {
        Parameter::FluidAveragingOffset => share,
        Parameter::ThermalAirConductance => 100.0 * share,
        Parameter::FluidCrossTimeConstant => share * design.at(target).max(1e-3),
        _ => share * design.at(target),
    }
}

fn difference(model: Model, design: &Design, target: Target) -> [f64; 10] {
    let step = move_of(model, design, target);
    let at = |sign: f64| {
        let mut moved = design.clone();
        moved.set(target, design.at(target) + sign * step);
        reference::descend(&Coefficients::new(&moved), model, 1e-11).unwrap()
    };
    let (up, down) = (at(1.0), at(-1.0));
    std::array::from_fn(|n| (up.values[n] - down.values[n]) / (2.0 * step))
}

#[test]
fn reference_differences_agree_with_the_gradient() {
    for model in Model::ALL {
        let settings = Settings { tolerance: if model.is_detailed() { 1e-9 } else { 1e-8 } };
        for (which, design) in designs().iter().enumerate() {
            let targets = targets();
            let found = gradient(model, &settings, design, &targets).unwrap();
            for (target, derivatives) in targets.iter().zip(&found.derivatives) {
                if target.parameter == Parameter::BrakeRotors
                    || (target.parameter == Parameter::ThermalAirConductance && which != 1)
                    || (target.parameter == Parameter::FluidCrossTimeConstant && which != 1)
                    || target.parameter == Parameter::FluidExpansion
                {
                    // Whole numbers, and values at the end of their range, have no central difference.
                    continue;
                }
                let want = difference(model, design, *target);
                let size = design.at(*target).abs().max(move_of(model, design, *target));
                for n in 0..10 {
                    // As relative changes: of the outcome, per relative change of the input. The peaks'
                    // derivatives are a digit less accurate, as the peaks are.
                    let scale = found.outcome.values[n] / size;
                    let error = (derivatives[n] - want[n]).abs() / scale;
                    let bound = if n < 3 { 1e-5 } else { 1e-4 };
                    // The films' kernel and reference are two discretisations of space.
                    let bound = if model.is_detailed() { 20.0 * bound } else { bound };
                    assert!(
                        error < bound,
                        "{model:?} design {which} {} outcome {n}: {} {} ({error:e})",
                        target.path(),
                        derivatives[n],
                        want[n]
                    );
                }
            }
        }
    }
}

#[test]
fn property_the_outcome_is_that_of_the_plain_kernel_to_the_bit() {
    for model in Model::ALL {
        for design in designs() {
            for tolerance in [1e-4, 1e-6] {
                let settings = Settings { tolerance };
                let found = gradient(model, &settings, &design, &[]).unwrap();
                let mut plain = [Err::<Outcome, _>(Fault::NotFinite)];
                descend(model, &settings, &[Coefficients::new(&design)], &mut plain);
                assert_eq!(Ok(found.outcome), plain[0]);
                assert!(found.derivatives.is_empty());
            }
        }
    }
}

#[test]
fn property_a_whole_gap_is_all_its_surfaces_and_rotors_have_no_derivative() {
    let design = Design::baseline();
    let settings = Settings::default();
    let mut targets: Vec<Target> = (0..14).map(Target::gap).collect();
    targets.extend([
        Target::whole(Parameter::BrakeGap),
        Target::whole(Parameter::BrakeRotors),
        Target::gap(99),
    ]);
    let found = gradient(Model::Dynamic, &settings, &design, &targets).unwrap();
    let rows = &found.derivatives;
    for n in 0..10 {
        let sum: f64 = rows[..14].iter().map(|row| row[n]).sum();
        assert!((sum - rows[14][n]).abs() <= 1e-9 * rows[14][n].abs());
        assert_eq!((rows[15][n], rows[16][n]), (0.0, 0.0));
    }
}

#[test]
fn property_impossible_designs_are_faults() {
    let mut design = Design::baseline();
    design.set(Target::whole(Parameter::ThermalFluidCapacity), f64::NAN);
    let found = gradient(Model::Dynamic, &Settings::default(), &design, &targets());
    assert_eq!(found, Err(Fault::ImpossibleInput));
}
