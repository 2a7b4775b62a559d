//! The figures that the program is accepted by, through `descend --json`.

use super::program::reeldown;
use serde_json::Value;

/// The figures are stated to six digits and must be met to 1e-5 relative.
const TOLERANCE: f64 = 1e-5;

fn descend(arguments: &[&str]) -> Value {
    let answer = reeldown(&[&["descend", "--json"], arguments].concat()).ended_with(0);
    assert_eq!(answer.err, "");
    answer.json()
}

#[track_caller]
fn assert_figure(outcome: &Value, column: &str, expected: f64) {
    let value = outcome[column].as_f64().unwrap_or_else(|| panic!("no number {column}: {outcome}"));
    let error = (value / expected - 1.0).abs();
    assert!(error < TOLERANCE, "{column} = {value}, expected {expected}: off by {error:.1e}");
}

// SciPy's Radau at tight tolerances gave the figures below, from the equations alone.

#[test]
fn reference_nominal_descent_scipy() {
    let outcome = descend(&[]);
    assert_figure(&outcome, "time_s", 201.025);
    assert_figure(&outcome, "final_velocity_m_per_s", 0.42303);
    assert_figure(&outcome, "peak_fluid_temperature_k", 402.280);
    assert_eq!(outcome["deployed"], Value::Bool(true));
}

#[test]
fn reference_quasi_steady_descent_scipy() {
    assert_figure(&descend(&["--model", "quasi-steady"]), "time_s", 200.771);
}

#[test]
fn reference_cold_descent_scipy() {
    assert_figure(&descend(&["--set", "initial.temperature=0 °F"]), "time_s", 398.727);
}

#[test]
fn reference_runaway_descent_scipy() {
    let thin = "fluid.nominal_viscosity=30000 cSt";
    let outcome = descend(&["--set", thin, "--set", "initial.temperature=100 °F"]);
    assert_figure(&outcome, "time_s", 14.7927);
    assert_figure(&outcome, "peak_fluid_temperature_k", 665.628);
}

#[test]
fn property_the_object_holds_every_outcome_under_its_column_name() {
    let columns = [
        "deployed",
        "final_fluid_temperature_k",
        "final_housing_temperature_k",
        "final_rotor_temperature_k",
        "final_velocity_m_per_s",
        "peak_fluid_temperature_k",
        "peak_power_w",
        "peak_reel_speed_rad_per_s",
        "peak_tension_n",
        "peak_velocity_m_per_s",
        "time_s",
    ];
    let outcome = descend(&[]);
    let mut keys: Vec<&str> =
        outcome.as_object().expect("an object").keys().map(String::as_str).collect();
    keys.sort_unstable();
    assert_eq!(keys, columns);
}

#[test]
fn property_a_thick_cold_fluid_does_not_deploy() {
    let thick = "fluid.nominal_viscosity=2000000 cSt";
    let outcome = descend(&["--set", thick, "--set", "initial.temperature=0 °F"]);
    assert_eq!(outcome["deployed"], Value::Bool(false));
    assert_figure(&outcome, "time_s", 1800.0);
}
