//! What a run on the rig can teach: Fisher information for the card's uncertain parameters.
//!
//! The parameters are the coordinates of standard-normal space of every input that a rig run shares with the
//! flights (known at build, or never; an input known on the day is each day's own, and the temperature at the
//! start of a run is measured). Derivatives of every predicted reading come from dual numbers at the card's
//! medians, along the force or speed history that the run would have. Each reading has a random error of its
//! own; besides, load cell, speedometer and every thermometer have a systematic error of their own, the same in every
//! run, estimated along with the parameters, with the widths that `calibrate` assumes where none is stated; every run's
//! initial temperature is not known.
//!
//! A systematic error is that of the truth over the reading: true force = read force · (1 + error), true
//! temperature = read temperature + error. One scaling can never be learned on the rig: force, brake constant,
//! heat capacities and conductances all multiplied by one factor give the same speeds and temperatures; so
//! the brake constant is never known better than the load cell (a test holds that).

use super::run::cannot_compute;
use crate::campaign::calibration::plan::INITIAL_SD_K;
use crate::descent::driven::{
    Drive, Prediction, Reading, Record, Settings, differentiate, predict,
};
use crate::error::{Error, Result};
use crate::numerics::columns::Columns;
use crate::numerics::dual::Dual;
use crate::numerics::real::Real;
use crate::physics::{Coefficients, Design, Parameter, Target};
use crate::study::{Known, Study};
use nalgebra::DMatrix;
use serde::Serialize;

/// Parameters differentiated in one pass.
const DIRECTIONS: usize = 8;
/// Half width of differences of the inputs' transform, in standard deviations.
const STEP: f64 = 1e-3;
/// Relative step of differences in the drive's gain.
const GAIN_STEP: f64 = 1e-4;
/// Systematic errors that all runs share: gains of force and of speed, offsets of three thermometers (one that is not
/// there keeps its prior, and teaches nothing).
pub const SHARED: usize = 5;

/// What the instruments read, and how well.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Instruments {
    /// Time between readings, s.
    pub every_s: f64,
    /// Random error of a force reading, standard deviation, N.
    pub force_noise_n: f64,
    /// Systematic error of the load cell, as a share of the force.
    pub force_gain: f64,
    /// Random error of a speed reading, m/s.
    pub speed_noise_m_per_s: f64,
    /// Systematic error of the speedometer, as a share of the speed.
    pub speed_gain: f64,
    /// Random error of a temperature reading, K.
    pub temperature_noise_k: f64,
    /// Systematic error of each thermometer, K.
    pub temperature_offset_k: f64,
    /// Which nodes have a thermometer: fluid, rotors, housing.
    pub thermometers: [bool; 3],
}

impl Instruments {
    /// Checks that every error is one.
    ///
    /// # Errors
    /// [`Error::Argument`] naming the one that is not.
    pub fn validate(&self) -> Result<()> {
        let entries = [
            ("time between readings", self.every_s),
            ("random error of force", self.force_noise_n),
            ("systematic error of force", self.force_gain),
            ("random error of speed", self.speed_noise_m_per_s),
            ("systematic error of speed", self.speed_gain),
            ("random error of temperature", self.temperature_noise_k),
            ("systematic error of temperature", self.temperature_offset_k),
        ];
        match entries.iter().find(|(_, value)| !(value.is_finite() && *value > 0.0)) {
            Some((name, value)) => {
                Err(Error::argument(format!("a {name} of {value} is impossible: it is positive")))
            }
            None => Ok(()),
        }
    }
}

/// The parameters that runs can teach something about, at the card's medians.
pub struct Parameters {
    /// Places of the inputs in the study.
    pub inputs: Vec<usize>,
    /// The design at the medians.
    pub median: Design,
    /// `slopes[j]`: what each target moves by along parameter `j`, SI a standard deviation.
    slopes: Vec<Vec<(Target, f64)>>,
}

impl Parameters {
    /// The parameters of a study's card.
    pub fn new(study: &Study) -> Self {
        let inputs: Vec<usize> =
            (0..study.inputs.len()).filter(|&k| study.inputs[k].known != Known::OnTheDay).collect();
        let values = |place: Option<(usize, f64)>| {
            let mut z = Columns::new(1, study.inputs.len());
            if let Some((k, step)) = place {
                z.set(0, k, step);
            }
            let mut x = Columns::default();
            study.joint.from_standard_normal(&z, &mut x);
            x.row(0)
        };
        let mut median = study.design.clone();
        for (input, value) in study.inputs.iter().zip(values(None)) {
            median.set(input.target, value);
        }
        let slopes = inputs
            .iter()
            .map(|&k| {
                let (up, down) = (values(Some((k, STEP))), values(Some((k, -STEP))));
                let slope = |j: usize| (up[j] - down[j]) / (2.0 * STEP);
                (0..study.inputs.len())
                    .map(|j| (study.inputs[j].target, slope(j)))
                    .filter(|(target, slope)| {
                        *slope != 0.0 && target.parameter != Parameter::InitialTemperature
                    })
                    .collect()
            })
            .collect();
        Parameters { inputs, median, slopes }
    }

    /// Number of parameters.
    pub fn count(&self) -> usize {
        self.inputs.len()
    }

    /// The relative change of the brake's torque per speed, all fluid and geometry together, along each
    /// parameter: the combination that every run teaches first.
    pub fn brake_constant(&self) -> Vec<f64> {
        let k = |design: &Design| Coefficients::new(design).fluid.torque_per_speed_nms;
        let base = k(&self.median);
        let moved = |j: usize, sign: f64| {
            let mut design = self.median.clone();
            for (target, slope) in &self.slopes[j] {
                design.set(*target, design.at(*target) + sign * STEP * slope);
            }
            k(&design)
        };
        (0..self.count()).map(|j| (moved(j, 1.0) - moved(j, -1.0)) / (2.0 * STEP * base)).collect()
    }

    /// Predictions with derivatives along every parameter and, last, the initial temperature.
    fn differentiate(&self, design: &Design, record: &Record) -> Result<Vec<Vec<[f64; 6]>>> {
        let thins = design.get(Parameter::FluidCrossTimeConstant) > 0.0;
        let start = [(Target::whole(Parameter::InitialTemperature), 1.0)];
        let directions: Vec<&[(Target, f64)]> =
            self.slopes.iter().map(Vec::as_slice).chain([&start[..]]).collect();
        let mut columns = Vec::with_capacity(directions.len());
        for chunk in directions.chunks(DIRECTIONS) {
            let mut varied = design.map(Dual::<DIRECTIONS>::constant);
            for (k, direction) in chunk.iter().enumerate() {
                for &(target, slope) in *direction {
                    let mut value = varied.at(target);
                    value.slopes[k] += slope;
                    varied.set(target, value);
                }
            }
            let coefficients = Coefficients::with_shear_thinning(&varied, thins);
            let run = differentiate(record, &Settings::default(), &coefficients);
            if let Some(fault) = run.fault {
                return Err(cannot_compute(fault));
            }
            for k in 0..chunk.len() {
                let slope = |reading: &Reading<Dual<DIRECTIONS>>| entries(reading, |d| d.slopes[k]);
                columns.push(run.readings.iter().map(slope).collect());
            }
        }
        Ok(columns)
    }
}

/// Line, force, speed and temperatures of a reading.
fn entries<R: Real>(reading: &Reading<R>, value: impl Fn(R) -> f64) -> [f64; 6] {
    let [fluid, rotor, housing] = reading.temperatures_k;
    [reading.line_m, reading.force_n, reading.speed_m_per_s, fluid, rotor, housing].map(value)
}

/// The Fisher information of one run about the parameters and the shared systematic errors, each in units of
/// its prior standard deviation; the run's own initial temperature is integrated out.
///
/// # Errors
/// If the run cannot be computed.
pub fn information(
    parameters: &Parameters,
    instruments: &Instruments,
    start_k: f64,
    drive: Drive,
    level: f64,
    end_s: f64,
) -> Result<DMatrix<f64>> {
    let mut design = parameters.median.clone();
    design.set(Target::whole(Parameter::InitialTemperature), start_k);
    let record = history(&design, drive, level, end_s, instruments.every_s)?;
    let nominal = one(&design, &record)?;
    let count = parameters.count();
    let mut columns = parameters.differentiate(&design, &record)?;
    let start = columns.pop().unwrap_or_default();
    columns.extend(systematic(&design, &record, &nominal, instruments)?);
    columns.push(scaled(&start, INITIAL_SD_K));
    let total = count + SHARED + 1;
    let mut matrix = DMatrix::<f64>::zeros(total, total);
    for (row, reading) in nominal.readings.iter().enumerate() {
        for (channel, variance) in observed(record.drive(), reading, instruments) {
            let slopes: Vec<f64> = columns.iter().map(|column| column[row][channel]).collect();
            for i in 0..total {
                for j in 0..=i {
                    matrix[(i, j)] += slopes[i] * slopes[j] / variance;
                }
            }
        }
    }
    // The initial temperature has a prior of one unit of its own; then it is integrated out.
    let last = total - 1;
    let own = matrix[(last, last)] + 1.0;
    Ok(DMatrix::from_fn(last, last, |i, j| {
        let (i, j) = (i.max(j), i.min(j));
        matrix[(i, j)] - matrix[(last, i)] * matrix[(last, j)] / own
    }))
}

/// The channels that are compared with their variances: the one of force and speed that is predicted, to
/// whose error that of the other adds, and the thermometers.
fn observed(drive: Drive, reading: &Reading<f64>, instruments: &Instruments) -> Vec<(usize, f64)> {
    let (force, speed) = (reading.force_n, reading.speed_m_per_s);
    let (force_noise, speed_noise) = (instruments.force_noise_n, instruments.speed_noise_m_per_s);
    let sum = |own: f64, driven: f64| own * own + driven * driven;
    let mut channels = vec![match drive {
        Drive::Speed => (1, sum(force_noise, force / speed * speed_noise)),
        Drive::Force | Drive::Power => (2, sum(speed_noise, speed / force * force_noise)),
    }];
    let noise = instruments.temperature_noise_k;
    for (node, there) in instruments.thermometers.iter().enumerate() {
        if *there {
            channels.push((3 + node, noise * noise));
        }
    }
    channels
}

/// Derivatives of the readings along the shared systematic errors, a prior standard deviation each. A gain of
/// what drives the run moves the whole prediction, one of what is predicted lowers its reading; an offset
/// lowers the readings of its thermometer.
fn systematic(
    design: &Design,
    record: &Record,
    nominal: &Prediction,
    instruments: &Instruments,
) -> Result<[Vec<[f64; 6]>; SHARED]> {
    let gained = |sign: f64| {
        let factor = 1.0 + sign * GAIN_STEP;
        let values = record.values().iter().map(|value| value * factor).collect();
        one(design, &Record::new(record.drive(), record.times_s().to_vec(), values)?)
    };
    let (up, down) = (gained(1.0)?, gained(-1.0)?);
    let drive: Vec<[f64; 6]> = up
        .readings
        .iter()
        .zip(&down.readings)
        .map(|(up, down)| {
            let (up, down) = (entries(up, |v| v), entries(down, |v| v));
            std::array::from_fn(|k| (up[k] - down[k]) / (2.0 * GAIN_STEP))
        })
        .collect();
    let predicted = |channel: usize| -> Vec<[f64; 6]> {
        let only = |reading: &Reading<f64>| {
            let mut slopes = [0.0; 6];
            slopes[channel] = -entries(reading, |v| v)[channel];
            slopes
        };
        nominal.readings.iter().map(only).collect()
    };
    let (force, speed) = match record.drive() {
        Drive::Speed => (predicted(1), drive),
        Drive::Force | Drive::Power => (drive, predicted(2)),
    };
    // The thermometer's own readings fall by its offset.
    let offset = |node: usize| -> Vec<[f64; 6]> {
        let mut slopes = [0.0; 6];
        slopes[3 + node] = -instruments.temperature_offset_k;
        vec![slopes; nominal.readings.len()]
    };
    Ok([
        scaled(&force, instruments.force_gain),
        scaled(&speed, instruments.speed_gain),
        offset(0),
        offset(1),
        offset(2),
    ])
}

fn scaled(column: &[[f64; 6]], factor: f64) -> Vec<[f64; 6]> {
    column.iter().map(|row| row.map(|value| factor * value)).collect()
}

/// The history that a run of a mode would record: the force or the speed it holds; of a held power, the force.
pub fn history(
    design: &Design,
    drive: Drive,
    level: f64,
    end_s: f64,
    every_s: f64,
) -> Result<Record> {
    // Whole readings before the line runs out.
    let end = (end_s / every_s).floor().max(2.0) * every_s;
    let held = Record::held(drive, level, end, every_s)?;
    if drive != Drive::Power {
        return Ok(held);
    }
    let run = one(design, &held)?;
    let force = run.readings.iter().map(|reading| reading.force_n).collect();
    Record::new(Drive::Force, held.times_s().to_vec(), force)
}

/// One prediction.
fn one(design: &Design, record: &Record) -> Result<Prediction> {
    let mut predictions = Vec::new();
    predict(record, &Settings::default(), &[Coefficients::new(design)], &mut predictions);
    match predictions.pop() {
        Some(Prediction { fault: Some(fault), .. }) => Err(cannot_compute(fault)),
        Some(prediction) => Ok(prediction),
        None => Err(Error::argument("no run was predicted")),
    }
}

/// The covariance of the parameters after runs, in units of the prior's: the block of the inverse of prior
/// precision plus the runs' information.
pub fn posterior(count: usize, runs: &[&DMatrix<f64>]) -> DMatrix<f64> {
    let size = count + SHARED;
    let mut precision = DMatrix::<f64>::identity(size, size);
    for run in runs {
        precision += *run;
    }
    let inverse = match nalgebra::Cholesky::new(precision) {
        Some(factored) => factored.inverse(),
        // A sum with the identity is positive definite but for rounding: then nothing is claimed.
        None => DMatrix::identity(size, size),
    };
    inverse.view((0, 0), (count, count)).into_owned()
}

#[cfg(test)]
mod tests {
    use super::super::equipment::Equipment;
    use super::*;
    use crate::numerics::elementary::{exp, ln_1p};

    /// The sum of what a common factor costs the prior: each relative change over its standard deviation.
    #[test]
    fn analytic_no_set_of_runs_knows_the_brake_better_than_the_load_cell() {
        // The bound below is of the laws of this card.
        let card = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/habe/study.toml");
        let study = Study::load(Some(card.as_ref()), &[]).expect("the pinned study");
        let parameters = Parameters::new(&study);
        let equipment = Equipment::assumed(&study.design).expect("a flight");
        let instruments = equipment.instruments;
        let runs: Vec<DMatrix<f64>> = [
            (Drive::Force, 22e3, 290.0, 220.0),
            (Drive::Speed, 0.7, 290.0, 210.0),
            (Drive::Power, 16e3, 310.0, 180.0),
            (Drive::Speed, 0.5, 310.0, 300.0),
        ]
        .map(|(drive, level, start, end)| {
            information(&parameters, &instruments, start, drive, level, end).expect("a run")
        })
        .into();
        let brake = parameters.brake_constant();
        let deviation = |covariance: &DMatrix<f64>| {
            let mut variance = 0.0;
            for (i, a) in brake.iter().enumerate() {
                for (j, b) in brake.iter().enumerate() {
                    variance += a * b * covariance[(i, j)];
                }
            }
            variance.sqrt()
        };
        let count = parameters.count();
        let many: Vec<&DMatrix<f64>> = runs.iter().flat_map(|run| vec![run; 1000]).collect();
        let four: Vec<&DMatrix<f64>> = runs.iter().collect();
        let before = deviation(&DMatrix::identity(count, count));
        let (after, limit) =
            (deviation(&posterior(count, &four)), deviation(&posterior(count, &many)));
        // The unlearnable direction's prior precision: the load cell's, three capacities of 8 %, three
        // conductances of 15 %, the brake constant's own (all lognormal or nearly).
        let log_sd = |cv: f64| ln_1p(cv * cv).sqrt();
        let precision = |sd: f64| 1.0 / (sd * sd);
        let bound = (precision(0.01)
            + 3.0 * precision(log_sd(0.08))
            + 3.0 * precision(log_sd(0.15))
            + precision(before))
        .recip()
        .sqrt();
        assert!(limit >= bound * 0.99 && limit < bound * 1.1, "{limit} {bound}");
        assert!(after >= limit && after < 0.5 * before, "{after} {before}");
        assert!(exp(-before) > 0.9, "the brake constant is known to 8 %");
    }
}
