//! The runs behind the paper's own figures.

use crate::descent::reference::{Sample, Trajectory, trajectory};
use crate::descent::{Fault, Model};
use crate::physics::{Coefficients, Design, Parameter, Target};

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
    let cold = held_temperature(design);
    Ok(PaperRuns {
        descent: run(design, model, LONGEST_STEP_S)?,
        constant_temperature: ConstantTemperature {
            dynamic: run(&cold, Model::Dynamic, FIRST_SECOND_STEP_S)?,
            steady: run(&cold, Model::QuasiSteady, LONGEST_STEP_S)?,
        },
    })
}

/// A design in which nothing warms: its temperature is held.
pub(crate) fn held_temperature(design: &Design) -> Design {
    let mut held = design.clone();
    for capacity in [
        Parameter::ThermalFluidCapacity,
        Parameter::ThermalRotorCapacity,
        Parameter::ThermalHousingCapacity,
    ] {
        let target = Target::whole(capacity);
        held.set(target, design.at(target) * HEAT_CAPACITY_FACTOR);
    }
    held
}

impl PaperRuns {
    /// At held temperature, the time from which on the dynamic reel speed stays within 1 % of the steady one, s.
    pub fn settling_time_s(&self) -> Option<f64> {
        let ConstantTemperature { dynamic, steady } = &self.constant_temperature;
        let steady = &steady.samples;
        let speed_at = |time_s: f64| {
            let k = steady.partition_point(|s| s.time_s < time_s);
            let (before, after) = (steady.get(k.checked_sub(1)?)?, steady.get(k)?);
            let share = (time_s - before.time_s) / (after.time_s - before.time_s);
            Some(before.observation[2] + share * (after.observation[2] - before.observation[2]))
        };
        let apart = |s: &&Sample| {
            speed_at(s.time_s).is_some_and(|steady| (s.observation[2] / steady - 1.0).abs() > 0.01)
        };
        let last_apart = dynamic.samples.iter().rposition(|s| apart(&s))?;
        dynamic.samples.get(last_apart + 1).map(|s| s.time_s)
    }
}
