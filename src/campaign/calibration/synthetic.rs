//! Rig runs made up from a known truth: a driver who wobbles, sensors that err, and a brake that is not quite the
//! model.

use super::channel::Channel;
use crate::calibration::noise::{Noise, Reading, Series, drawn_errors};
use crate::descent::driven::{Drive, Prediction, Record, Settings, predict};
use crate::error::{Error, Result};
use crate::physics::{Coefficients, Design};
use crate::streams::{Purpose, Stream, standard_normal, stream};
use crate::study::MeasuredRun;
use crate::units;

/// How a run is driven.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Schedule {
    /// The quantity that the driver tries to hold.
    pub hold: Drive,
    /// Its level, SI.
    pub level: f64,
    /// Wobble about it, as a share: standard deviation and correlation time, s.
    pub wobble: (f64, f64),
    /// Temperature of brake and air at the start, K.
    pub initial_k: f64,
    /// Longest duration, s; the run ends at 97 % of the line at the latest.
    pub end_s: f64,
    /// Interval between readings, s.
    pub every_s: f64,
}

/// Errors of a channel in truth, SI, and the step of its display.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instrument {
    /// The channel.
    pub channel: Channel,
    /// Sensor error, and the discrepancy of the model where the channel does not drive.
    pub noise: Noise,
    /// Gain and offset (SI) that all its readings share: truth = (1 + gain) reading + offset, of a thermometer from
    /// the ice point.
    pub systematic: (f64, f64),
    /// Unit of the display, as a header has it.
    pub unit: &'static str,
    /// Step of the display, in that unit.
    pub step: f64,
}

/// What the file says of itself, and every result that comes of it after it.
const SYNTHETIC: &str = "synthetic: made up from a known brake, nothing here was measured";
/// Share of the line at which a run ends.
const LINE_SHARE: f64 = 0.97;
/// Steps of the truth, s: finer than a calibration's.
const TRUTH_STEP_S: f64 = 0.25;
/// Time in which the driver takes up the slack, s.
const START_S: f64 = 3.0;

/// The CSV text of a run of the brake `truth`: see [`Schedule`] and [`Instrument`]. `drive` is the quantity that an
/// analyst will take as given; its sensor has no discrepancy.
///
/// # Errors
/// If the schedule or the brake is impossible.
pub fn run(
    truth: &Design,
    schedule: &Schedule,
    instruments: &[Instrument],
    drive: Drive,
    (seed, index): (u64, u64),
) -> Result<String> {
    truth.validate()?;
    let mut stream = stream(seed, Purpose::Synthetic, index);
    let held = driven(schedule, &mut stream)?;
    let mut brake = Coefficients::new(truth);
    brake.initial_temperature_k = schedule.initial_k;
    let mut predictions: Vec<Prediction> = Vec::new();
    predict(&held, &Settings { longest_step_s: TRUTH_STEP_S }, &[brake], &mut predictions);
    let readings = &predictions[0].readings;
    let end = readings
        .iter()
        .position(|reading| reading.line_m > LINE_SHARE * brake.reel.line_length_m)
        .unwrap_or(readings.len());
    let (times_s, readings) = (&held.times_s()[..end], &readings[..end]);
    let mut columns = Vec::new();
    for instrument in instruments {
        let channel = instrument.channel;
        let series = Series {
            readings: times_s
                .iter()
                .enumerate()
                .map(|(moment, &time_s)| Reading { moment, time_s, value: 0.0, variance: 0.0 })
                .collect(),
            degrees_of_freedom: None,
        };
        let mut noise = instrument.noise;
        if Channel::of_drive(drive) == Some(channel) {
            noise.discrepancy_sd = 0.0;
        }
        let errors = drawn_errors(&series, &noise, &mut stream);
        let read = channel.correction(instrument.systematic.0, instrument.systematic.1);
        let floor = if channel.is_temperature() { f64::NEG_INFINITY } else { 0.0 };
        let shown = readings
            .iter()
            .zip(errors)
            .map(|(reading, error)| (read.reading(channel.predicted(reading)) + error).max(floor))
            .map(|value| displayed(value, instrument))
            .collect::<Result<Vec<String>>>()?;
        columns.push((format!("{} [{}]", channel.name(), instrument.unit), shown));
    }
    let mut text = format!("# {SYNTHETIC}\ntime [s]");
    for (header, _) in &columns {
        text += &format!(", {header}");
    }
    text.push('\n');
    for (k, time_s) in times_s.iter().enumerate() {
        text += &units::number(*time_s, 8);
        for (_, shown) in &columns {
            text += &format!(", {}", shown[k]);
        }
        text.push('\n');
    }
    Ok(text)
}

/// The same run as an analyst reads it.
///
/// # Errors
/// As [`run`].
pub fn measured(
    name: &str,
    truth: &Design,
    schedule: &Schedule,
    instruments: &[Instrument],
    drive: Drive,
    key: (u64, u64),
) -> Result<MeasuredRun> {
    let text = run(truth, schedule, instruments, drive, key)?;
    MeasuredRun::from_csv(name, &text, Default::default())
}

/// What the driver really applies: up from nothing, then about the level.
fn driven(schedule: &Schedule, stream: &mut Stream) -> Result<Record> {
    let count = (schedule.end_s / schedule.every_s).floor();
    if !(2.0..=1e6).contains(&count) {
        return Err(Error::argument("a synthetic run needs between two and a million readings"));
    }
    let times: Vec<f64> = (0..=count as usize).map(|k| k as f64 * schedule.every_s).collect();
    let (share, time_s) = schedule.wobble;
    let keeps = crate::numerics::elementary::exp(-schedule.every_s / time_s);
    let mut wobble = share * standard_normal(stream);
    let values = times
        .iter()
        .map(|&time| {
            let up = (time / START_S).min(1.0);
            let value = schedule.level * up * (1.0 + wobble);
            wobble =
                keeps * wobble + share * (1.0 - keeps * keeps).sqrt() * standard_normal(stream);
            value.max(0.0)
        })
        .collect();
    Record::new(schedule.hold, times, values)
}

/// A value as the display shows it: in its unit, to its step.
fn displayed(value: f64, instrument: &Instrument) -> Result<String> {
    let quantity = instrument.channel.quantity();
    let unit = |number: f64| {
        units::parse(&format!("{number} {}", instrument.unit), quantity)
            .map_err(|error| Error::argument(error.problem))
    };
    // Units are linear in SI: two points tell the scale.
    let (zero, one) = (unit(0.0)?, unit(1.0)?);
    let steps = ((value - zero) / (one - zero) / instrument.step).round();
    Ok(units::number(steps * instrument.step, 8))
}
