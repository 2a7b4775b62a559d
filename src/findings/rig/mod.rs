//! The horizontal rig: single runs, the paper's three modes as test options, and a plan of tests.

mod band;
mod equipment;
pub mod information;
pub mod plan;
mod run;

pub use band::{Band, HalfSpaces};
pub use equipment::{Equipment, Stated};
pub use information::Instruments;
pub use plan::{Candidate, Combination, PlanFinding, PlanOptions, plan};
pub use run::{Residual, RigRun, WARM_UP, flight, held, recorded};

use crate::descent::driven::Drive;
use crate::descent::{Model, OutcomeQuantity};
use crate::error::{Error, Result};
use crate::study::Study;
use information::{Parameters, information, posterior};
use plan::{Groups, top_level};
use run::flight_means;
use serde::Serialize;

/// The three modes as options for a test.
#[derive(Debug, Clone, Serialize)]
pub struct Comparison {
    /// The model of the flight and of every run, whatever the study's: quasi-steady.
    pub model: &'static str,
    /// Load that no run may exceed, N.
    pub proof_load_n: f64,
    /// The instruments.
    pub instruments: Instruments,
    /// What of load and instruments is assumed.
    pub assumed: Vec<String>,
    /// The flight: force, speed and power on the mean over time, SI.
    pub flight_means: [f64; 3],
    /// Energy that the flight puts into the brake, J.
    pub flight_energy_j: f64,
    /// Highest fluid temperature of the flight, K.
    pub flight_peak_fluid_k: f64,
    /// The modes: constant force, speed, power.
    pub modes: Vec<ModeFinding>,
    /// Paths of the parameters; like ones as one, with how many; last, the brake constant.
    pub parameters: Vec<(String, usize)>,
}

/// One mode as an option for a test.
#[derive(Debug, Clone, Serialize)]
pub struct ModeFinding {
    /// What the truck holds.
    pub mode: &'static str,
    /// How much of it, SI.
    pub level: f64,
    /// Whether proof load or fluid forbid the flight's mean, which would be the level otherwise.
    pub reduced: bool,
    /// Length of the run, s.
    pub duration_s: f64,
    /// Highest load, N, and the time it is first reached, s; none if the load is constant.
    pub peak_force_n: f64,
    /// See `peak_force_n`.
    pub peak_force_time_s: Option<f64>,
    /// Highest load over the proof load.
    pub load_over_proof: f64,
    /// Energy put into the brake, J.
    pub energy_j: f64,
    /// The same over the flight's.
    pub energy_over_flight: f64,
    /// Highest fluid temperature, K.
    pub peak_fluid_k: f64,
    /// Largest departure of the fluid's temperature from a straight line, over its rise, after the first
    /// tenth of the run.
    pub departure_from_linear: Option<f64>,
    /// Standard deviation of each parameter after one such run over before.
    pub remaining: Vec<f64>,
    /// The run.
    #[serde(skip)]
    pub run: RigRun,
}

/// Compares the modes, each at the flight's mean or, where proof load or fluid forbid that, at the greatest
/// level that they allow; a level that is given is taken as it is.
///
/// # Errors
/// If a run or the flight cannot be computed.
pub fn compare(
    study: &Study,
    equipment: &Equipment,
    levels: [Option<f64>; 3],
) -> Result<Comparison> {
    let Equipment { proof_load_n, instruments, assumed } = equipment.clone();
    let design = &study.design;
    let flown = flight(design)?;
    let means = flight_means(design)?;
    let parameters = Parameters::new(study);
    let groups = Groups::new(study, &parameters);
    let energy = flown.energy_j();
    let start_k = design.get(crate::physics::Parameter::InitialTemperature);
    let mut modes = Vec::new();
    for (k, drive) in Drive::ALL.into_iter().enumerate() {
        let (level, run) = match levels[k] {
            Some(level) => (level, held(design, drive, level)?),
            None => top_level(study, design, drive, means[k], proof_load_n).ok_or_else(|| {
                Error::argument(format!(
                    "no constant {} keeps the proof load and the fluid's limit: give a level",
                    drive.name()
                ))
            })?,
        };
        let duration_s = run.outcome.get(OutcomeQuantity::Time);
        let matrix = information(&parameters, &instruments, start_k, drive, level, duration_s)?;
        let covariance = posterior(parameters.count(), &[&matrix]);
        let (peak_force_n, peak_force_time_s) = run.peak(|s| s.observation[1]);
        modes.push(ModeFinding {
            mode: drive.name(),
            level,
            reduced: levels[k].is_none() && level < means[k],
            duration_s,
            peak_force_n,
            peak_force_time_s,
            load_over_proof: peak_force_n / proof_load_n,
            energy_j: run.energy_j(),
            energy_over_flight: run.energy_j() / energy,
            peak_fluid_k: run.outcome.get(OutcomeQuantity::PeakFluidTemperature),
            departure_from_linear: run.departure_from_linear(),
            remaining: groups.remaining(&covariance),
            run,
        });
    }
    Ok(Comparison {
        model: Model::QuasiSteady.name(),
        proof_load_n,
        instruments,
        assumed,
        flight_means: means,
        flight_energy_j: energy,
        flight_peak_fluid_k: flown.outcome.get(OutcomeQuantity::PeakFluidTemperature),
        modes,
        parameters: groups.names,
    })
}
