//! What is calibrated by what: the runs, how they are driven, and the laws of everything that is not on the card.

use super::channel::Channel;
use crate::calibration::noise::{Reading, Series};
use crate::calibration::{Plan, screening};
use crate::descent::driven::{Drive, Record};
use crate::error::{Error, Result};
use crate::numerics::elementary::exp;
use crate::physics::parameters::Parameter;
use crate::study::{MeasuredRun, Study};
use crate::units::{display, number};

/// A positive quantity that is not known: its logarithm is normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Positive {
    /// Median, SI.
    pub median: f64,
    /// Standard deviation of the logarithm.
    pub log_sd: f64,
}

impl Positive {
    /// The value at a standard-normal coordinate.
    pub fn at(&self, z: f64) -> f64 {
        self.median * exp(self.log_sd * z)
    }
}

/// The error of a channel's sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SensorError {
    /// Its standard deviation is stated, SI.
    Stated(f64),
    /// It is estimated with the rest.
    Estimated(Positive),
}

/// How a channel differs from the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelNoise {
    /// The channel.
    pub channel: Channel,
    /// Its sensor.
    pub sensor: SensorError,
    /// Standard deviation of the model's discrepancy and its correlation time (s); none for a model that is right.
    pub discrepancy: Option<(Positive, Positive)>,
}

/// What all readings of an instrument err by alike, in every run: truth − zero = (1 + gain) (reading − zero) + offset.
/// Both are normal with mean zero; a standard deviation of zero is an error that the instrument does not have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Systematic {
    /// The channel.
    pub channel: Channel,
    /// Standard deviation of the gain's error.
    pub gain: f64,
    /// Standard deviation of the offset, SI.
    pub offset: f64,
}

/// Systematic error of load cell, speedometer and line counter where none is stated, as a share: assumed.
pub const GAIN: f64 = 0.01;
/// Systematic error of a thermometer where none is stated, K (2 °F): assumed.
pub const OFFSET_K: f64 = 2.0 / 1.8;

impl Systematic {
    /// What is assumed of a channel's instrument if nothing is stated; [`crate::findings::rig::Instruments`] plans with
    /// the same.
    pub fn assumed(channel: Channel) -> Self {
        match channel.is_temperature() {
            true => Systematic { channel, gain: 0.0, offset: OFFSET_K },
            false => Systematic { channel, gain: GAIN, offset: 0.0 },
        }
    }
}

/// A law of the temperature at a run's start, K.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InitialTemperature {
    /// Mean.
    pub mean_k: f64,
    /// Standard deviation.
    pub sd_k: f64,
}

/// One run, ready to be compared.
#[derive(Debug, Clone)]
pub struct PlannedRun {
    /// The run's name.
    pub name: String,
    /// What drives it.
    pub record: Record,
    /// What is known of its initial temperature beforehand.
    pub initial: InitialTemperature,
    /// The channels that are predicted, with what was read.
    pub channels: Vec<(Channel, Series)>,
}

/// What a person chooses.
#[derive(Debug, Clone)]
pub struct Options {
    /// Stated standard deviations of sensors, SI.
    pub sensor_sd: Vec<(Channel, f64)>,
    /// Stated standard deviations of the instruments' gains, as shares; zero for none.
    pub gain_sd: Vec<(Channel, f64)>,
    /// Stated standard deviations of the instruments' offsets, SI; zero for none.
    pub offset_sd: Vec<(Channel, f64)>,
    /// Median of the discrepancy's standard deviation, as a share of the channel's range; none for no discrepancy.
    pub discrepancy: Option<f64>,
    /// Degrees of freedom of heavy-tailed noise; none for normal noise.
    pub degrees_of_freedom: Option<f64>,
    /// What drives the runs; none for the force where it was recorded.
    pub drive: Option<Drive>,
    /// How the posterior is sampled.
    pub plan: Plan,
}

impl Options {
    /// What is usual, with the seed of every stream.
    pub fn seeded(seed: u64) -> Self {
        Options {
            sensor_sd: Vec::new(),
            gain_sd: Vec::new(),
            offset_sd: Vec::new(),
            discrepancy: Some(0.01),
            degrees_of_freedom: None,
            drive: None,
            plan: Plan::seeded(seed),
        }
    }
}

/// Standard deviation of a run's initial temperature about its first readings, K: wide, for the readings
/// themselves are compared too.
pub const INITIAL_SD_K: f64 = 5.0;
/// Standard deviation of the logarithm of an estimated sensor error, and of a discrepancy.
const NOISE_LOG_SD: f64 = 1.0;
/// Median of the discrepancy's correlation time, as a share of the longest run, and the logarithm's standard deviation.
const CORRELATION_SHARE: f64 = 0.2;
const CORRELATION_LOG_SD: f64 = 0.7;
/// Median of an estimated sensor error, as a share of the channel's range.
const SENSOR_SHARE: f64 = 0.01;

/// Whether a parameter belongs to the brake and its fluid, which a rig has in common with a flight.
///
/// Payload, balloon and the reels' inertia do not act on the rig (its model is quasi-steady); air and initial
/// temperature are those of the day.
pub fn is_hardware(parameter: Parameter) -> bool {
    let path = parameter.info().path;
    let belongs =
        ["brake.", "fluid.", "reel.", "thermal."].iter().any(|start| path.starts_with(start));
    belongs && !matches!(parameter, Parameter::ReelInertia | Parameter::ThermalAirTemperature)
}

/// The channels of a run that are predicted, given what drives it. Line paid out is the speed's integral: it is used
/// where there is no speed.
pub fn predicted_channels(run: &MeasuredRun, drive: Drive) -> Vec<Channel> {
    let there = |channel: &Channel| channel.measured(run).is_some();
    Channel::ALL
        .into_iter()
        .filter(there)
        .filter(|&channel| Some(channel) != Channel::of_drive(drive))
        .filter(|&channel| channel != Channel::Line || (!there(&Channel::Speed)))
        .collect()
}

/// The runs as they are compared, and the noise of their channels. `held_out` runs get a plan too, but do not shape
/// the noise.
///
/// # Errors
/// A run with nothing to predict, or whose drive was not recorded.
pub fn planned(runs: &[&MeasuredRun], study: &Study, options: &Options) -> Result<Vec<PlannedRun>> {
    runs.iter().map(|run| planned_run(run, study, options)).collect()
}

fn planned_run(run: &MeasuredRun, study: &Study, options: &Options) -> Result<PlannedRun> {
    let drive = match options.drive {
        Some(drive) => drive,
        None => run.preferred_drive(),
    };
    let record = run.record(drive)?;
    let channels = predicted_channels(run, drive);
    if channels.is_empty() {
        return Err(Error::argument(format!(
            "{}: nothing is left to predict: besides the {} that drives it a run needs another column",
            run.origin,
            drive.name()
        )));
    }
    for &(channel, sd) in &options.sensor_sd {
        refuse_finer_than_its_display(run, channel, sd)?;
    }
    let drive_sd = Channel::of_drive(drive).and_then(|of_drive| {
        options.sensor_sd.iter().find(|(channel, _)| *channel == of_drive).map(|(_, sd)| *sd)
    });
    let series = |channel: Channel| {
        let values = channel.measured(run).unwrap_or_default();
        let readings = values.iter().enumerate().map(|(moment, &value)| Reading {
            moment,
            time_s: run.time_s[moment],
            value,
            variance: drive_variance(channel, value, record.values()[moment], drive_sd),
        });
        Series { readings: readings.collect(), degrees_of_freedom: options.degrees_of_freedom }
    };
    Ok(PlannedRun {
        name: run.origin.clone(),
        initial: initial_temperature(run, study),
        channels: channels.into_iter().map(|channel| (channel, series(channel))).collect(),
        record,
    })
}

/// A sensor cannot err by less than the rounding of what it shows: a stated error below that would have the model blamed
/// for the last digit.
fn refuse_finer_than_its_display(run: &MeasuredRun, channel: Channel, sd: f64) -> Result<()> {
    let step = channel.measured(run).and_then(screening::resolution);
    // The error of rounding to a step is uniform over it.
    let Some(least) = step.map(|step| step / 12.0_f64.sqrt()).filter(|least| sd < 0.99 * least)
    else {
        return Ok(());
    };
    let unit = display(channel.quantity().of_difference());
    let shown = |si: f64| format!("{} {}", number(unit.shown(si), 3), unit.symbol);
    Err(Error::argument(format!(
        "{}: its {} is rounded to {}, which alone errs by {}: a --sensor-sd of {} is impossible, state that at least",
        run.origin,
        channel.name(),
        shown(least * 12.0_f64.sqrt()),
        shown(least),
        shown(sd)
    )))
}

/// Variance that a reading has from the drive's sensor. Speed goes with force nearly in proportion, moment by moment;
/// the temperatures only feel its mean.
fn drive_variance(channel: Channel, value: f64, drive: f64, drive_sd: Option<f64>) -> f64 {
    match (channel, drive_sd) {
        (Channel::Force | Channel::Speed, Some(sd)) if drive > 0.0 => {
            let share = sd * value / drive;
            share * share
        }
        _ => 0.0,
    }
}

/// What is known of a run's initial temperature: its first readings; without thermometers the card's law.
fn initial_temperature(run: &MeasuredRun, study: &Study) -> InitialTemperature {
    let first: Vec<f64> = [Channel::Fluid, Channel::Rotor, Channel::Housing]
        .into_iter()
        .filter_map(|channel| channel.measured(run)?.first().copied())
        .collect();
    if !first.is_empty() {
        let mean_k = first.iter().sum::<f64>() / first.len() as f64;
        return InitialTemperature { mean_k, sd_k: INITIAL_SD_K };
    }
    let input =
        study.inputs.iter().find(|input| input.target.parameter == Parameter::InitialTemperature);
    match input {
        Some(input) => {
            let (mean_k, sd_k) = input.marginal.moments();
            InitialTemperature { mean_k, sd_k }
        }
        None => InitialTemperature {
            mean_k: study.design.get(Parameter::InitialTemperature),
            sd_k: INITIAL_SD_K,
        },
    }
}

/// The systematic errors of every instrument that drives a run or is predicted in one, as stated or else assumed.
pub fn systematic(runs: &[PlannedRun], options: &Options) -> Vec<Systematic> {
    let used = |channel: &Channel| {
        runs.iter().any(|run| {
            Channel::of_drive(run.record.drive()) == Some(*channel)
                || run.channels.iter().any(|(other, _)| other == channel)
        })
    };
    let stated = |list: &[(Channel, f64)], channel: Channel| {
        list.iter().find(|(other, _)| *other == channel).map(|(_, sd)| *sd)
    };
    Channel::ALL
        .into_iter()
        .filter(used)
        .map(|channel| {
            let assumed = Systematic::assumed(channel);
            Systematic {
                channel,
                gain: stated(&options.gain_sd, channel).unwrap_or(assumed.gain),
                offset: stated(&options.offset_sd, channel).unwrap_or(assumed.offset),
            }
        })
        .collect()
}

/// The laws of the channels' noise, made from the range that the runs cover.
pub fn noise(runs: &[PlannedRun], options: &Options) -> Vec<ChannelNoise> {
    let longest_s = runs
        .iter()
        .filter_map(|run| Some(run.record.times_s().last()? - run.record.times_s().first()?))
        .fold(0.0, f64::max);
    Channel::ALL
        .into_iter()
        .filter_map(|channel| {
            let range = range(runs, channel)?;
            let stated = options.sensor_sd.iter().find(|(other, _)| *other == channel);
            let sensor = match stated {
                Some(&(_, sd)) => SensorError::Stated(sd),
                None => SensorError::Estimated(Positive {
                    median: SENSOR_SHARE * range,
                    log_sd: NOISE_LOG_SD,
                }),
            };
            let discrepancy = options.discrepancy.map(|share| {
                let sd = Positive { median: share * range, log_sd: NOISE_LOG_SD };
                let median = CORRELATION_SHARE * longest_s;
                (sd, Positive { median, log_sd: CORRELATION_LOG_SD })
            });
            Some(ChannelNoise { channel, sensor, discrepancy })
        })
        .collect()
}

/// How far a channel's readings range: of a temperature from the coldest to the hottest, of what has a true zero from
/// there.
fn range(runs: &[PlannedRun], channel: Channel) -> Option<f64> {
    let values = || {
        runs.iter()
            .flat_map(|run| &run.channels)
            .filter(|(other, _)| *other == channel)
            .flat_map(|(_, series)| series.readings.iter().map(|reading| reading.value))
    };
    let high = values().fold(f64::NEG_INFINITY, f64::max);
    let low = if channel.is_temperature() { values().fold(f64::INFINITY, f64::min) } else { 0.0 };
    // A range of nothing still needs a scale.
    (high.is_finite() && low.is_finite()).then(|| (high - low).max(1e-3 * high.abs()).max(1e-9))
}
