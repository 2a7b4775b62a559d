//! One run on the horizontal rig: held by the truck, or driven by a recorded history.

use crate::descent::driven::{Drive, Prediction, Reading, Settings, predict};
use crate::descent::outcome::OUTCOME_COUNT;
use crate::descent::reference::{self, Sample};
use crate::descent::{Fault, Model, Outcome, OutcomeQuantity};
use crate::error::{Error, Result};
use crate::physics::quasi_steady::Pull;
use crate::physics::{Coefficients, Design};
use crate::study::MeasuredRun;
use crate::study::measured_run::CHANNELS;
use crate::units::Quantity;
use serde::Serialize;

/// Accuracy of a flight and of a run that is held.
const TOLERANCE: f64 = 1e-8;
/// Fine enough to draw from, s.
const LONGEST_STEP_S: f64 = 0.25;
/// Share of the run's time that is left out when the rise of temperature is judged: the fluid first warms
/// up above the rotors, in a few times `C1/K12` = 6 s.
pub const WARM_UP: f64 = 0.1;

/// Step at which a course is looked at for its straight parts, s.
const LINE_STEP_S: f64 = 1.0;
/// Steps of the search for a line's slope: the bracket shrinks by a third each.
const SLOPE_STEPS: usize = 60;

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
    /// tenth of the run is over.
    pub fn departure_from_linear(&self) -> Option<f64> {
        self.departure_from_linear_after(WARM_UP)
    }

    /// The same once a share of the run is over.
    pub fn departure_from_linear_after(&self, share: f64) -> Option<f64> {
        let begin = self.samples.first()?.time_s;
        let end = self.samples.last()?.time_s;
        let from = begin + share * (end - begin);
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

    /// The longest time, s, for which the fluid's temperature stays within so many kelvin of a straight line.
    pub fn longest_linear_rise_s(&self, within_k: f64) -> f64 {
        let mut points: Vec<[f64; 2]> = Vec::new();
        for sample in &self.samples {
            if points.last().is_none_or(|last| sample.time_s >= last[0] + LINE_STEP_S) {
                points.push([sample.time_s, sample.temperatures_k[0]]);
            }
        }
        longest_near_a_line(&points, within_k)
    }
}

/// The longest stretch of points (x, y) that lie within a distance in y of one straight line. A part of such a stretch is
/// one, so that two ends that only go forward find it.
fn longest_near_a_line(points: &[[f64; 2]], within: f64) -> f64 {
    let (mut first, mut longest) = (0, 0.0f64);
    for last in 0..points.len() {
        while least_spread(&points[first..=last]) > 2.0 * within {
            first += 1;
        }
        longest = longest.max(points[last][0] - points[first][0]);
    }
    longest
}

/// The least distance between two parallel lines, along y, that hold all points: convex in the slope.
fn least_spread(points: &[[f64; 2]]) -> f64 {
    if points.len() < 3 {
        return 0.0;
    }
    let slopes =
        || points.windows(2).map(|pair| (pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0]));
    let (mut low, mut high) =
        (slopes().fold(f64::INFINITY, f64::min), slopes().fold(f64::NEG_INFINITY, f64::max));
    let spread = |slope: f64| {
        let off = || points.iter().map(|[x, y]| y - slope * x);
        off().fold(f64::NEG_INFINITY, f64::max) - off().fold(f64::INFINITY, f64::min)
    };
    for _ in 0..SLOPE_STEPS {
        let third = (high - low) / 3.0;
        if spread(low + third) < spread(high - third) { high -= third } else { low += third }
    }
    spread(0.5 * (low + high))
}

/// What a run that cannot be computed says.
pub(super) fn cannot_compute(fault: Fault) -> Error {
    Error::argument(format!(
        "the run cannot be computed ({}): is the pull one that the brake can take?",
        fault.name()
    ))
}

/// The flight of a design, as the rig is modelled: quasi-steady.
///
/// # Errors
/// If it cannot be integrated.
pub fn flight(design: &Design) -> Result<RigRun> {
    let c = Coefficients::new(design);
    let run = reference::trajectory(&c, Model::QuasiSteady, TOLERANCE, LONGEST_STEP_S)
        .map_err(cannot_compute)?;
    Ok(RigRun { samples: run.samples, outcome: run.outcome, residuals: Vec::new() })
}

/// What the flight pulls with on the mean over its time: force, speed, power.
///
/// # Errors
/// If the flight cannot be computed.
pub(super) fn flight_means(design: &Design) -> Result<[f64; 3]> {
    let flight = flight(design)?;
    let (first, last) = match (flight.samples.first(), flight.samples.last()) {
        (Some(first), Some(last)) => (first.time_s, last.time_s),
        _ => return Err(Error::argument("the flight has no moments")),
    };
    let mean = |k: usize| {
        let area: f64 = flight
            .samples
            .windows(2)
            .map(|p| {
                0.5 * (p[1].time_s - p[0].time_s) * (p[0].observation[k] + p[1].observation[k])
            })
            .sum();
        area / (last - first)
    };
    Ok([mean(1), mean(4), mean(3)])
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

#[cfg(test)]
mod tests {
    use super::*;

    /// y = x²/100 up to 100: within ± e of a line over any stretch of length l with l²/800 = e (Chebyshev).
    #[test]
    fn analytic_a_parabola_is_near_a_line_over_a_stretch_of_known_length() {
        let points: Vec<[f64; 2]> =
            (0..=1000).map(|k| f64::from(k) / 10.0).map(|x| [x, x * x / 100.0]).collect();
        let longest = longest_near_a_line(&points, 1.0);
        // To the step of the points.
        assert!((longest - 800.0_f64.sqrt()).abs() <= 0.11, "{longest}");
        let straight: Vec<[f64; 2]> = (0..50).map(|k| [f64::from(k), 3.0 * f64::from(k)]).collect();
        assert!((longest_near_a_line(&straight, 1e-9) - 49.0).abs() < 1e-12);
    }
}
