//! The runs behind the paper's own figures.

use crate::descent::reference::{Trajectory, trajectory};
use crate::descent::{Fault, Model};
use crate::physics::{Coefficients, Design, Parameter};

/// Accuracy of the runs.
const TOLERANCE: f64 = 1e-7;
/// Fine enough to draw from, s.
const LONGEST_STEP_S: f64 = 0.5;
/// Fine enough for the first second, s.
const FIRST_SECOND_STEP_S: f64 = 0.005;
/// Times its heat capacity, nothing warms: temperatures stay within a thousandth of a kelvin.
const HEAT_CAPACITY_FACTOR: f64 = 1e6;

/// Dynamic and steady solutions with the temperature held at its initial value.
#[derive(Debug, Clone)]
pub struct ConstantTemperature {
    /// With accelerations, fine from the start.
    pub dynamic: Trajectory,
    /// Without.
    pub steady: Trajectory,
}

/// What the paper's figures 4 to 9 are drawn from.
#[derive(Debug, Clone)]
pub struct PaperRuns {
    /// The design's descent.
    pub descent: Trajectory,
    /// The comparison at constant temperature.
    pub constant_temperature: ConstantTemperature,
}

/// Computes the runs of a design; `model` is that of the descent along which figures 5 to 9 are drawn.
///
/// # Errors
/// The fault of a run.
pub fn paper_runs(design: &Design, model: Model) -> Result<PaperRuns, Fault> {
    let run = |design: &Design, model, step_s| {
        trajectory(&Coefficients::new(design), model, TOLERANCE, step_s)
    };
    let mut cold = design.clone();
    for capacity in [
        Parameter::ThermalFluidCapacity,
        Parameter::ThermalRotorCapacity,
        Parameter::ThermalHousingCapacity,
    ] {
        let target = crate::physics::Target::whole(capacity);
        cold.set(target, design.at(target) * HEAT_CAPACITY_FACTOR);
    }
    Ok(PaperRuns {
        descent: run(design, model, LONGEST_STEP_S)?,
        constant_temperature: ConstantTemperature {
            dynamic: run(&cold, Model::Dynamic, FIRST_SECOND_STEP_S)?,
            steady: run(&cold, Model::QuasiSteady, LONGEST_STEP_S)?,
        },
    })
}
