//! What a further measurement would be worth: the expected narrowing of the band on P(any breach).
//!
//! Each measurement is turned into the information that it would give about the inputs, at the posterior's mean: of a rig
//! run the derivatives of its readings through the noise as the calibration found it, by the same instruments with their
//! gains and offsets, the run's own initial temperature not known; of a direct measurement the stated error. [`crate::calibration::narrowing`] says what is linear
//! in that.

use super::channel::Channel;
use super::likelihood::{Coordinate, RigLikelihood};
use super::plan::{INITIAL_SD_K, InitialTemperature, is_hardware};
use crate::calibration::narrowing::Dependence;
use crate::calibration::noise::{Noise, Reading, Series, whiten};
use crate::descent::driven::{Drive, Prediction, Record, Settings, predict};
use crate::error::Result;
use crate::numerics::columns::Columns;
use crate::numerics::special::normal;
use crate::physics::Parameter;
use crate::study::Study;
use nalgebra::{DMatrix, DVector};

/// A measurement that could be made next, and what it is expected to do.
#[derive(Debug, Clone)]
pub struct NextTest {
    /// What it is, in a few words.
    pub name: String,
    /// What is measured with which error, for a reader.
    pub detail: String,
    /// Expected standard deviation of the probit of P afterwards.
    pub sd: f64,
    /// The 5 % and 95 % ends of the band on P that goes with it.
    pub band: [f64; 2],
    /// Expected width of the band over its width now.
    pub width_left: f64,
}

/// The band now, as the linear-normal approximation has it, and every measurement, the best first.
#[derive(Debug, Clone)]
pub struct NextTests {
    /// Standard deviation of the probit of P now.
    pub sd: f64,
    /// The 5 % and 95 % ends of the band that goes with it.
    pub band: [f64; 2],
    /// Share of the probit's variance that is linear in the inputs.
    pub linear: f64,
    /// The measurements.
    pub tests: Vec<NextTest>,
}

/// Interval between the readings of a planned run, s.
const EVERY_S: f64 = 1.0;
/// Error of a gap survey, m: half a thousandth of an inch.
const GAP_SURVEY_M: f64 = 0.5 * 2.54e-5;
/// Relative error of a viscometer at the working shear rate.
const VISCOMETER: f64 = 0.02;
/// Length of a heating before a soak, and of the soak, s.
const HEATING_S: f64 = 120.0;
const SOAK_S: f64 = 1200.0;
/// About how long a flight takes, s.
const FLIGHT_S: f64 = 200.0;
/// Standard normal quantile of 95 %.
const NINETY_FIVE: f64 = 1.644_853_626_951_472_2;

/// Compares the measurements.
///
/// `draws` are points of the posterior and `probits` the probits of P(any breach) at them, with `own_variance` from
/// their estimation.
///
/// # Errors
/// If the draws are too few for the slopes.
pub fn next_tests(
    study: &Study,
    likelihood: &RigLikelihood<'_>,
    draws: &[Vec<f64>],
    probits: &[f64],
    own_variance: f64,
) -> Result<NextTests> {
    // The brake, and the instruments that will measure it again.
    let belongs = |coordinate: &Coordinate| match *coordinate {
        Coordinate::Input(j) => is_hardware(study.inputs[j].target.parameter),
        Coordinate::Gain(_) | Coordinate::Offset(_) => true,
        _ => false,
    };
    let coordinates = likelihood.coordinates();
    let columns: Vec<usize> =
        (0..coordinates.len()).filter(|&j| belongs(&coordinates[j])).collect();
    let reduced: Vec<Vec<f64>> =
        draws.iter().map(|row| columns.iter().map(|&j| row[j]).collect()).collect();
    let dependence = Dependence::new(&reduced, probits, own_variance)?;
    let d = coordinates.len();
    let mean: Vec<f64> =
        (0..d).map(|j| draws.iter().map(|row| row[j]).sum::<f64>() / draws.len() as f64).collect();
    let planner = Planner { study, likelihood, columns, mean };
    let sd = dependence.sd();
    let band =
        |sd: f64| [-NINETY_FIVE, NINETY_FIVE].map(|side| normal::cdf(dependence.mean + side * sd));
    let now = band(sd);
    let mut tests = Vec::new();
    for (name, detail, information) in planner.measurements()? {
        let after = dependence.sd_after(&information)?;
        let narrowed = band(after);
        let width_left = (narrowed[1] - narrowed[0]) / (now[1] - now[0]).max(1e-300);
        tests.push(NextTest { name, detail, sd: after, band: narrowed, width_left });
    }
    tests.sort_by(|a, b| a.sd.total_cmp(&b.sd));
    let linear = dependence.explained / dependence.variance.max(1e-300);
    Ok(NextTests { sd, band: now, linear, tests })
}

struct Planner<'a> {
    study: &'a Study,
    likelihood: &'a RigLikelihood<'a>,
    /// The coordinates of brake and instruments.
    columns: Vec<usize>,
    mean: Vec<f64>,
}

type Measurement = (String, String, DMatrix<f64>);

impl Planner<'_> {
    fn measurements(&self) -> Result<Vec<Measurement>> {
        let inputs = self.likelihood.inputs(&Columns::from_rows(&[&self.mean])).row(0);
        let by_input = self.likelihood.input_slopes(&self.mean);
        let design = &self.study.design;
        // The payload's mean pull, and the speed that goes with the flight's length.
        let force_n = design.get(Parameter::PayloadWeight)
            - 0.5 * design.get(Parameter::PayloadExtractedWeight);
        let length_m = design.get(Parameter::ReelLineLength);
        let speed_m_per_s = length_m / FLIGHT_S;
        let channels = self.channels();
        let temperatures: Vec<Channel> =
            channels.iter().copied().filter(|channel| channel.is_temperature()).collect();
        let mut found = Vec::new();
        let runs = [
            ("rig run at constant force", Drive::Force, force_n),
            ("rig run at constant speed", Drive::Speed, speed_m_per_s),
            ("rig run at constant power", Drive::Power, force_n * speed_m_per_s),
        ];
        for (name, drive, level) in runs {
            let held = Record::held(drive, level, 0.9 * length_m / speed_m_per_s, EVERY_S)?;
            let Some(record) = self.recorded(held, &inputs)? else { continue };
            let mut instruments = channels.clone();
            if !instruments.contains(&Channel::Force) {
                instruments.insert(0, Channel::Force);
            }
            let predicted: Vec<Channel> = instruments
                .into_iter()
                .filter(|&channel| match drive {
                    // With the power held, force and speed tell the same.
                    Drive::Force | Drive::Power => channel != Channel::Force,
                    Drive::Speed => channel != Channel::Speed,
                })
                .filter(|&channel| channel != Channel::Line)
                .collect();
            if let Some(information) = self.of_run(&record, &predicted) {
                let read: Vec<&str> = predicted.iter().map(|channel| channel.name()).collect();
                let detail = format!("{} read as in the runs", read.join(", "));
                found.push((name.to_owned(), detail, information));
            }
        }
        if !temperatures.is_empty() {
            let record = soak(speed_m_per_s)?;
            if let Some(information) = self.of_run(&record, &temperatures) {
                let read: Vec<&str> = temperatures.iter().map(|channel| channel.name()).collect();
                let detail = format!(
                    "{HEATING_S} s at constant speed, then {} min at rest, {} read",
                    SOAK_S / 60.0,
                    read.join(", ")
                );
                found.push(("thermal soak".to_owned(), detail, information));
            }
        }
        found.extend(self.direct(
            "gap survey",
            "every gap to 0.0005 in",
            |parameter, _| (parameter == Parameter::BrakeGap).then_some(GAP_SURVEY_M),
            &inputs,
            &by_input,
        ));
        found.extend(self.viscometer(&inputs, &by_input));
        Ok(found)
    }

    /// What the campaign measures.
    fn channels(&self) -> Vec<Channel> {
        self.likelihood.noise().iter().map(|noise| noise.channel).collect()
    }

    /// What such a run would record: of a held power, the force.
    fn recorded(&self, held: Record, inputs: &[f64]) -> Result<Option<Record>> {
        if held.drive() != Drive::Power {
            return Ok(Some(held));
        }
        let Some(brake) = self.likelihood.coefficients(inputs) else { return Ok(None) };
        let mut predictions: Vec<Prediction> = Vec::new();
        predict(&held, &Settings::default(), &[brake], &mut predictions);
        let Some(run) = predictions.pop().filter(|run| run.fault.is_none()) else {
            return Ok(None);
        };
        let force = run.readings.iter().map(|reading| reading.force_n).collect();
        Record::new(Drive::Force, held.times_s().to_vec(), force).map(Some)
    }

    /// Information of a driven run about the coordinates of brake and instruments, its initial temperature integrated
    /// out.
    fn of_run(&self, record: &Record, channels: &[Channel]) -> Option<DMatrix<f64>> {
        let mean_k = self.study.design.get(Parameter::InitialTemperature);
        let initial = InitialTemperature { mean_k, sd_k: INITIAL_SD_K };
        let slopes = self.likelihood.slopes(record, &self.mean, initial, channels)?;
        let (m, n) = (self.columns.len(), self.study.inputs.len());
        let runs = self.likelihood.runs().len();
        let mut matrix = DMatrix::<f64>::zeros(m + 1, m + 1);
        for (c, channel) in channels.iter().enumerate() {
            let readings: Vec<Reading> = record
                .times_s()
                .iter()
                .enumerate()
                .map(|(moment, &time_s)| Reading { moment, time_s, value: 0.0, variance: 0.0 })
                .collect();
            let count = readings.len();
            let series = Series { readings, degrees_of_freedom: None };
            let mut whitened: Vec<Vec<f64>> = vec![vec![0.0; count]];
            whitened.extend(slopes.derivatives[c].iter().cloned());
            whiten(&series, &self.noise_of(*channel), &mut whitened);
            // The card's coordinates, the initial temperature's, the instruments'.
            let place = |j: usize| if j < n { 1 + j } else { 2 + j - runs };
            let mut chosen: Vec<&Vec<f64>> =
                self.columns.iter().filter_map(|&j| whitened.get(place(j))).collect();
            chosen.extend(whitened.get(1 + n));
            for (a, x) in chosen.iter().enumerate() {
                for (b, y) in chosen.iter().enumerate() {
                    matrix[(a, b)] += x.iter().zip(*y).map(|(x, y)| x * y).sum::<f64>();
                }
            }
        }
        // The initial temperature has its prior, and is integrated out.
        let own = matrix[(m, m)] + 1.0;
        let with = matrix.view((0, m), (m, 1)).into_owned();
        let information = matrix.view((0, 0), (m, m)) - &with * with.transpose() / own;
        information.iter().all(|value| value.is_finite()).then_some(information)
    }

    /// The noise of a channel as the runs found it. A force that always drove has the share of the payload's pull that
    /// the speed's noise has of the flight's speed: at a given fluid the two go in proportion.
    fn noise_of(&self, channel: Channel) -> Noise {
        let known = self.channels().contains(&channel);
        if known || channel != Channel::Force {
            return self.likelihood.noise_at(channel, &self.mean);
        }
        let noise = self.likelihood.noise_at(Channel::Speed, &self.mean);
        let design = &self.study.design;
        let force_n = design.get(Parameter::PayloadWeight)
            - 0.5 * design.get(Parameter::PayloadExtractedWeight);
        let scale = force_n / (design.get(Parameter::ReelLineLength) / FLIGHT_S);
        Noise {
            sensor_sd: scale * noise.sensor_sd,
            discrepancy_sd: scale * noise.discrepancy_sd,
            correlation_time_s: noise.correlation_time_s,
        }
    }

    /// Information of a direct measurement of some inputs, each with its standard deviation; nothing where no such input
    /// is uncertain.
    fn direct(
        &self,
        name: &str,
        detail: &str,
        sd: impl Fn(Parameter, f64) -> Option<f64>,
        inputs: &[f64],
        by_input: &[Vec<f64>],
    ) -> Option<Measurement> {
        let m = self.columns.len();
        let mut matrix = DMatrix::<f64>::zeros(m, m);
        let mut any = false;
        for (i, input) in self.study.inputs.iter().enumerate() {
            let Some(sd) = sd(input.target.parameter, inputs[i]) else { continue };
            any = true;
            let slope = |j: usize| by_input[i].get(j).copied().unwrap_or(0.0);
            for (a, &j) in self.columns.iter().enumerate() {
                for (b, &k) in self.columns.iter().enumerate() {
                    matrix[(a, b)] += slope(j) * slope(k) / (sd * sd);
                }
            }
        }
        any.then(|| (name.to_owned(), detail.to_owned(), matrix))
    }

    /// Information of the lot's viscosity as it is sheared: of the product of lot and shear, which it cannot tell apart.
    fn viscometer(&self, inputs: &[f64], by_input: &[Vec<f64>]) -> Option<Measurement> {
        let factors: Vec<usize> = (0..inputs.len())
            .filter(|&i| {
                let parameter = self.study.inputs[i].target.parameter;
                matches!(parameter, Parameter::FluidShearFactor | Parameter::FluidLotFactor)
            })
            .collect();
        // Of the product's logarithm.
        let slope = |j: &usize| -> f64 {
            let of = |&i: &usize| by_input[i].get(*j).copied().unwrap_or(0.0) / inputs[i];
            factors.iter().map(of).sum::<f64>() / VISCOMETER
        };
        let slopes = DVector::from_iterator(self.columns.len(), self.columns.iter().map(slope));
        let detail = "viscosity at the working shear rate to 2 %".to_owned();
        (!factors.is_empty())
            .then(|| ("viscometer run of the lot".to_owned(), detail, &slopes * slopes.transpose()))
    }
}

/// Heating at constant speed, then rest.
fn soak(speed_m_per_s: f64) -> Result<Record> {
    let count = ((HEATING_S + SOAK_S) / EVERY_S) as usize;
    let times: Vec<f64> = (0..=count).map(|k| k as f64 * EVERY_S).collect();
    let values =
        times.iter().map(|&time| if time <= HEATING_S { speed_m_per_s } else { 0.0 }).collect();
    Record::new(Drive::Speed, times, values)
}
