//! The viscosity of a lot: what its factor does to a brake.

use reeldown::physics::{Coefficients, Design, Parameter, Target};

fn brake(changes: &[(Parameter, f64)]) -> Coefficients<f64> {
    let mut design = Design::baseline();
    for &(parameter, value) in changes {
        design.set(Target::whole(parameter), value);
    }
    Coefficients::new(&design)
}

/// Two roundings.
fn close(a: f64, b: f64) -> bool {
    (a / b - 1.0).abs() < 1e-15
}

#[test]
fn analytic_a_thick_lot_is_a_fluid_of_more_nominal_viscosity() {
    let lot = brake(&[(Parameter::FluidLotFactor, 1.04)]);
    let nominal = brake(&[(Parameter::FluidNominalViscosity, 0.125 * 1.04)]);
    let torque = |brake: &Coefficients<f64>| brake.fluid.torque_per_speed_nms;
    assert!(
        close(torque(&lot), torque(&nominal)) && close(torque(&lot), 1.04 * torque(&brake(&[])))
    );
    // A lot as it should be changes no bit.
    assert_eq!(brake(&[(Parameter::FluidLotFactor, 1.0)]), brake(&[]));
}

/// Cross thinning sets in at the shear stress τ* = ρ ν0/λ, which belongs to the polymer and not to the length of its
/// chains: the group X = λ (ν/ν0) γ̇ is stress over τ* where it is small, whatever the lot.
#[test]
fn analytic_lots_thin_at_the_same_stress() {
    let thins = (Parameter::FluidCrossTimeConstant, 2e-3);
    let of = |factor: f64| brake(&[thins, (Parameter::FluidLotFactor, factor)]);
    let (thin, thick) = (of(0.95), of(1.05));
    let group_per_torque =
        |brake: &Coefficients<f64>| brake.fluid.cross_time_s / brake.fluid.torque_per_speed_nms;
    assert!(close(group_per_torque(&thin), group_per_torque(&thick)));
    let film = |brake: &Coefficients<f64>| brake.film.cross_time_s_per_m / brake.fluid.cross_time_s;
    assert!(close(film(&thin), film(&thick)));
    // To a descent it is what shear does to the viscosity: the product is what counts.
    assert_eq!(of(1.05), brake(&[thins, (Parameter::FluidShearFactor, 1.05)]));
}
