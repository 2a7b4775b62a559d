//! One run on the horizontal rig: held by the truck, or driven by a recorded history.

use crate::descent::driven::{Drive, Prediction, Reading, Settings, predict};
use crate::descent::outcome::OUTCOME_COUNT;
use crate::descent::reference::{self, Sample};
use crate::descent::{Fault, Outcome, OutcomeQuantity};
use crate::error::{Error, Result};
use crate::physics::quasi_steady::Pull;
use crate::physics::{Coefficients, Design};
use crate::study::MeasuredRun;
use crate::study::measured_run::CHANNELS;
use crate::units::Quantity;
use serde::Serialize;

/// Accuracy of a run that is held.
const TOLERANCE: f64 = 1e-8;
/// Fine enough to draw from, s.
const LONGEST_STEP_S: f64 = 0.25;
/// Share of the run's time that is left out when the rise of temperature is judged: the fluid first warms
/// up above the rotors, in a few times `C1/K12` = 6 s.
const WARM_UP: f64 = 0.1;

/// Relative difference below which readings are the same.
const EQUAL: f64 = 1e-9;

/// A computed run.
#[derive(Debug, Clone)]
pub struct RigRun {
    /// Its moments.
    pub samples: Vec<Sample>,
    /// What it ended in; peaks of a recorded run are over the record's times and the end of the line.
    pub outcome: Outcome,
    /// How far it is from what was measured, for a recorded run.
    pub residuals: Vec<Residual>,
}

/// Predicted minus measured, over the readings on the line, SI.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Residual {
    /// The channel, as in a measured run's header.
    pub channel: &'static str,
    /// SI unit.
    pub unit: &'static str,
    /// Whether it drove the prediction, which then repeats it.
    pub drives: bool,
    /// Mean difference.
    pub mean: f64,
    /// Root of the mean square difference.
    pub root_mean_square: f64,
    /// Readings.
    pub readings: usize,
}

impl RigRun {
    /// The highest of a reading, and when it was first reached, s: none if it is constant, where the last bit
    /// of rounding would choose the time.
    pub fn peak(&self, read: impl Fn(&Sample) -> f64) -> (f64, Option<f64>) {
        let values = || self.samples.iter().map(&read);
        let top = values().fold(f64::NAN, f64::max);
        let least = values().fold(f64::NAN, f64::min);
        let near = top - EQUAL * top.abs();
        let first = self.samples.iter().find(|sample| read(sample) >= near);
        (top, first.filter(|_| least < near).map(|sample| sample.time_s))
    }

    /// Energy put into the brake, J, by the trapezoidal rule.
    pub fn energy_j(&self) -> f64 {
        let power = |s: &Sample| s.observation[3];
        let area = |pair: &[Sample]| {
            0.5 * (pair[1].time_s - pair[0].time_s) * (power(&pair[0]) + power(&pair[1]))
        };
        self.samples.windows(2).map(area).sum()
    }

    /// How far the fluid's temperature strays from a straight line in time, over its rise, once the first
    /// tenth of the run is over. The paper does not say how it measured "nearly linear"; see
    /// `tests/truth/paper_statements.rs` for what other measures give.
    pub fn departure_from_linear(&self) -> Option<f64> {
        let begin = self.samples.first()?.time_s;
        let end = self.samples.last()?.time_s;
        let from = begin + WARM_UP * (end - begin);
        let warm = self.samples.partition_point(|s| s.time_s < from);
        let samples = self.samples.get(warm..)?;
        let (first, last) = (samples.first()?, samples.last()?);
        let rise = last.observation[0] - first.observation[0];
        let straight = |s: &Sample| {
            let share = (s.time_s - first.time_s) / (last.time_s - first.time_s);
            first.observation[0] + rise * share
        };
        let strays = samples.iter().map(|s| (s.observation[0] - straight(s)).abs());
        Some(strays.fold(0.0, f64::max) / rise).filter(|departure| departure.is_finite())
    }
}

/// What a run that cannot be computed says.
pub(super) fn cannot_compute(fault: Fault) -> Error {
    Error::argument(format!(
        "the run cannot be computed ({}): is the pull one that the brake can take?",
        fault.name()
    ))
}

/// A run in which the truck holds a force, a speed or a power, SI.
///
/// # Errors
/// If the pull is not positive or the run cannot be integrated.
pub fn held(design: &Design, drive: Drive, value: f64) -> Result<RigRun> {
    if !(value.is_finite() && value > 0.0) {
        return Err(Error::argument(format!("a {} of {value} pulls no line", drive.name())));
    }
    let pull = match drive {
        Drive::Force => Pull::Force(value),
        Drive::Speed => Pull::Speed(value),
        Drive::Power => Pull::Power(value),
    };
    let run = reference::rig(&Coefficients::new(design), pull, TOLERANCE, LONGEST_STEP_S)
        .map_err(cannot_compute)?;
    Ok(RigRun { samples: run.samples, outcome: run.outcome, residuals: Vec::new() })
}

/// A run driven by what was recorded.
///
/// # Errors
/// If the record lacks what is to drive it, or the run cannot be computed.
pub fn recorded(design: &Design, measured: &MeasuredRun, drive: Drive) -> Result<RigRun> {
    let record = measured.record(drive)?;
    let mut predictions = Vec::new();
    let settings = Settings { longest_step_s: LONGEST_STEP_S };
    let coefficients = Coefficients::new(design);
    predict(&record, &settings, &[coefficients], &mut predictions);
    let Some(prediction) = predictions.pop() else {
        return Err(cannot_compute(Fault::NotFinite));
    };
    if let Some(fault) = prediction.fault {
        return Err(cannot_compute(fault));
    }
    let readings = prediction.readings_on_the_line(&record, |value| value);
    let last = last_on_the_line(&prediction, record.times_s(), readings.len());
    let samples: Vec<Sample> = readings
        .iter()
        .copied()
        .zip(record.times_s().iter().copied())
        .chain(last)
        .map(|(reading, time_s)| sample(&coefficients, &reading, time_s))
        .collect();
    let outcome = outcome(&samples, &prediction, record.times_s());
    let residuals = residuals(measured, readings, drive);
    Ok(RigRun { samples, outcome, residuals })
}

/// The reading at the moment the line runs out, between the readings about it; none if it lasts.
fn last_on_the_line(
    prediction: &Prediction,
    times: &[f64],
    seen: usize,
) -> Option<(Reading<f64>, f64)> {
    let end = prediction.line_out_s?;
    let k = seen.checked_sub(1)?;
    let (before, after) = (prediction.readings.get(k)?, prediction.readings.get(seen)?);
    let (from, to) = (*times.get(k)?, *times.get(seen)?);
    let share = (end - from) / (to - from);
    let between = |a: f64, b: f64| share.mul_add(b - a, a);
    let node = |n: usize| between(before.temperatures_k[n], after.temperatures_k[n]);
    let reading = Reading {
        line_m: between(before.line_m, after.line_m),
        force_n: between(before.force_n, after.force_n),
        speed_m_per_s: between(before.speed_m_per_s, after.speed_m_per_s),
        temperatures_k: [node(0), node(1), node(2)],
    };
    (share > 0.0).then_some((reading, end))
}

fn sample(c: &Coefficients<f64>, reading: &Reading<f64>, time_s: f64) -> Sample {
    let radius_m = c.reel.radius_squared_m2(reading.line_m).max(0.0).sqrt();
    let (force, speed) = (reading.force_n, reading.speed_m_per_s);
    let reel_speed = speed / radius_m;
    Sample {
        time_s,
        line_m: reading.line_m,
        temperatures_k: reading.temperatures_k,
        balloon_velocity_m_per_s: None,
        torque_nm: force * radius_m,
        observation: [reading.temperatures_k[0], force, reel_speed, force * speed, speed],
    }
}

fn outcome(samples: &[Sample], prediction: &Prediction, times: &[f64]) -> Outcome {
    let peak = |k: usize| samples.iter().map(|s| s.observation[k]).fold(f64::NAN, f64::max);
    let last = samples.last();
    let first = times.first().copied().unwrap_or(f64::NAN);
    let ended = prediction.line_out_s.or(last.map(|s| s.time_s)).unwrap_or(f64::NAN);
    let end = |read: fn(&Sample) -> f64| last.map_or(f64::NAN, read);
    let mut values = [f64::NAN; OUTCOME_COUNT];
    for (quantity, value) in [
        (OutcomeQuantity::Time, ended - first),
        (OutcomeQuantity::FinalVelocity, end(|s| s.observation[4])),
        (OutcomeQuantity::PeakFluidTemperature, peak(0)),
        (OutcomeQuantity::PeakTension, peak(1)),
        (OutcomeQuantity::PeakReelSpeed, peak(2)),
        (OutcomeQuantity::PeakPower, peak(3)),
        (OutcomeQuantity::PeakVelocity, peak(4)),
        (OutcomeQuantity::FinalFluidTemperature, end(|s| s.temperatures_k[0])),
        (OutcomeQuantity::FinalRotorTemperature, end(|s| s.temperatures_k[1])),
        (OutcomeQuantity::FinalHousingTemperature, end(|s| s.temperatures_k[2])),
    ] {
        values[quantity as usize] = value;
    }
    Outcome { deployed: prediction.line_out_s.is_some(), values }
}

/// The reading of a channel, by its place in [`CHANNELS`].
fn reading_of(reading: &Reading<f64>, channel: usize) -> Option<f64> {
    match channel {
        1 => Some(reading.force_n),
        2 => Some(reading.speed_m_per_s),
        3 => Some(reading.line_m),
        4..=6 => Some(reading.temperatures_k[channel - 4]),
        _ => None,
    }
}

fn residuals(measured: &MeasuredRun, readings: &[Reading<f64>], drive: Drive) -> Vec<Residual> {
    let mut found = Vec::new();
    for (channel, (name, quantity, _)) in CHANNELS.iter().enumerate() {
        let Some(values) = measured.channel(channel) else { continue };
        let differences: Vec<f64> = readings
            .iter()
            .zip(values)
            .filter_map(|(reading, value)| Some(reading_of(reading, channel)? - value))
            .collect();
        if differences.is_empty() {
            continue;
        }
        let count = differences.len() as f64;
        let square = differences.iter().map(|d| d * d).sum::<f64>() / count;
        found.push(Residual {
            channel: name,
            unit: quantity.si_unit(),
            drives: *name == drive.name(),
            mean: differences.iter().sum::<f64>() / count,
            root_mean_square: square.sqrt(),
            readings: differences.len(),
        });
    }
    found
}

impl Residual {
    /// The kind of quantity that the differences are.
    pub fn quantity(&self) -> Quantity {
        let found = CHANNELS.iter().find(|(name, ..)| *name == self.channel);
        found.map_or(Quantity::Number, |(_, quantity, _)| quantity.of_difference())
    }
}
