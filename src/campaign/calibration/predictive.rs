//! Do the runs look like what the posterior says they should? Those that it was made from, and one it has not seen.

use super::channel::Channel;
use super::likelihood::RigLikelihood;
use super::plan::PlannedRun;
use crate::calibration::noise::standardised;
use crate::descent::driven::{Correction, Prediction};
use crate::error::{Error, Result};
use crate::numerics::columns::Columns;
use crate::numerics::special::normal;
use crate::streams::{Purpose, standard_normal, stream};

/// Draws of the posterior behind a band.
const DRAWS: usize = 400;
/// Share of the readings that a band should hold.
pub const BAND: f64 = 0.9;
/// Streams of the held-out runs' starts and of the bands, beyond the replicates'.
const STARTS: u64 = 1 << 32;

/// One channel of one run against what the posterior predicts.
#[derive(Debug, Clone)]
pub struct ChannelCheck {
    /// The channel.
    pub channel: Channel,
    /// When, s.
    pub time_s: Vec<f64>,
    /// What was read, SI.
    pub measured: Vec<f64>,
    /// The model's own prediction: 5 %, 50 % and 95 % quantiles over the posterior, SI.
    pub model: Vec<[f64; 3]>,
    /// Prediction of the reading, discrepancy and sensor error in: 5 % and 95 % quantiles, SI.
    pub band: Vec<[f64; 2]>,
    /// Share of the readings inside the band, which should hold [`BAND`] of them.
    pub coverage: f64,
    /// Effective number of independent readings behind that share: neighbours within the discrepancy's correlation
    /// time count as one.
    pub independent: f64,
    /// Each reading given those before it, in standard deviations, averaged over the draws.
    pub scores: Vec<f64>,
}

/// One run against what the posterior predicts.
#[derive(Debug, Clone)]
pub struct RunCheck {
    /// The run.
    pub name: String,
    /// Whether the posterior has not seen it.
    pub held_out: bool,
    /// Its channels.
    pub channels: Vec<ChannelCheck>,
}

/// Where a check's initial temperatures come from.
enum Start {
    /// The run's place among those calibrated.
    Calibrated(usize),
    /// The run's own first readings.
    Read,
}

/// Checks the calibrated runs and the held-out ones against draws of the posterior.
///
/// # Errors
/// If a draw of the posterior cannot be computed.
pub fn check(
    likelihood: &RigLikelihood<'_>,
    held_out: &[PlannedRun],
    draws: &[Vec<f64>],
    seed: u64,
) -> Result<Vec<RunCheck>> {
    let step = (draws.len() / DRAWS).max(1);
    let chosen: Vec<Vec<f64>> = draws.iter().step_by(step).cloned().collect();
    let inputs = likelihood.inputs(&Columns::from_rows(&chosen));
    let calibrated =
        likelihood.runs().iter().enumerate().map(|(k, run)| (run, Start::Calibrated(k)));
    let others = held_out.iter().map(|run| (run, Start::Read));
    calibrated
        .chain(others)
        .enumerate()
        .map(|(k, (run, start))| check_run(likelihood, run, &start, &chosen, &inputs, (seed, k)))
        .collect()
}

fn check_run(
    likelihood: &RigLikelihood<'_>,
    run: &PlannedRun,
    start: &Start,
    draws: &[Vec<f64>],
    inputs: &Columns,
    (seed, place): (u64, usize),
) -> Result<RunCheck> {
    let mut stream = stream(seed, Purpose::Calibration, STARTS + place as u64);
    let initial_k: Vec<f64> = draws
        .iter()
        .map(|z| match start {
            Start::Calibrated(k) => likelihood.initial_k(*k, z),
            Start::Read => {
                // The first readings, each as uncertain as it is.
                let (mut weight, mut sum) = (0.0, 0.0);
                for (channel, series) in &run.channels {
                    let first = series.readings.first().filter(|_| channel.is_temperature());
                    let Some(first) = first else { continue };
                    let noise = likelihood.noise_at(*channel, z);
                    let variance = noise.sensor_sd * noise.sensor_sd
                        + noise.discrepancy_sd * noise.discrepancy_sd;
                    let read = likelihood.correction(*channel, z);
                    weight += 1.0 / variance;
                    sum += read.gain.mul_add(first.value, read.offset) / variance;
                }
                let draw = standard_normal(&mut stream);
                match weight > 0.0 {
                    true => sum / weight + draw / weight.sqrt(),
                    false => run.initial.mean_k + run.initial.sd_k * draw,
                }
            }
        })
        .collect();
    let applied: Vec<Correction> =
        draws.iter().map(|z| likelihood.drive_correction(&run.record, z)).collect();
    let predictions: Option<Vec<Prediction>> =
        likelihood.predict(&run.record, inputs, &initial_k, &applied).into_iter().collect();
    let predictions = predictions
        .ok_or_else(|| Error::argument("a draw of the posterior is an impossible brake"))?;
    let channels = run
        .channels
        .iter()
        .map(|(channel, series)| {
            let noises: Vec<_> = draws.iter().map(|z| likelihood.noise_at(*channel, z)).collect();
            let read: Vec<Correction> =
                draws.iter().map(|z| likelihood.correction(*channel, z)).collect();
            let mut check = ChannelCheck {
                channel: *channel,
                time_s: series.readings.iter().map(|r| r.time_s).collect(),
                measured: series.readings.iter().map(|r| r.value).collect(),
                model: Vec::new(),
                band: Vec::new(),
                coverage: 0.0,
                independent: 0.0,
                scores: vec![0.0; series.readings.len()],
            };
            let mut inside = 0;
            // One error a draw, the same at every moment: the band does not shiver.
            let errors: Vec<f64> = draws.iter().map(|_| standard_normal(&mut stream)).collect();
            for reading in &series.readings {
                let mut model: Vec<f64> = predictions
                    .iter()
                    .zip(&read)
                    .map(|(prediction, read)| {
                        read.reading(channel.predicted(&prediction.readings[reading.moment]))
                    })
                    .collect();
                let mut shown: Vec<f64> = model
                    .iter()
                    .zip(noises.iter().zip(&errors))
                    .map(|(model, (noise, error))| {
                        let variance = noise.sensor_sd * noise.sensor_sd
                            + noise.discrepancy_sd * noise.discrepancy_sd
                            + reading.variance;
                        model + variance.sqrt() * error
                    })
                    .collect();
                model.sort_by(f64::total_cmp);
                shown.sort_by(f64::total_cmp);
                let tail = 0.5 * (1.0 - BAND);
                check.model.push([tail, 0.5, 1.0 - tail].map(|p| quantile(&model, p)));
                let band = [tail, 1.0 - tail].map(|p| quantile(&shown, p));
                inside += usize::from((band[0]..=band[1]).contains(&reading.value));
                check.band.push(band);
            }
            let count = series.readings.len();
            check.coverage = inside as f64 / count as f64;
            let time = noises.iter().map(|noise| noise.correlation_time_s).sum::<f64>()
                / noises.len() as f64;
            let white: f64 = noises
                .iter()
                .map(|noise| {
                    let s = noise.sensor_sd * noise.sensor_sd;
                    let d = noise.discrepancy_sd * noise.discrepancy_sd;
                    s / (s + d)
                })
                .sum::<f64>()
                / noises.len() as f64;
            let lasted = check.time_s.last().unwrap_or(&0.0) - check.time_s.first().unwrap_or(&0.0);
            let clusters = 1.0 + lasted / (2.0 * time);
            check.independent = (white * count as f64 + (1.0 - white) * clusters).min(count as f64);
            for ((prediction, noise), read) in predictions.iter().zip(&noises).zip(&read) {
                let scores = standardised(series, noise, |moment| {
                    read.reading(channel.predicted(&prediction.readings[moment]))
                });
                for (sum, score) in check.scores.iter_mut().zip(scores) {
                    *sum += score.score / predictions.len() as f64;
                }
            }
            check
        })
        .collect();
    Ok(RunCheck { name: run.name.clone(), held_out: matches!(start, Start::Read), channels })
}

/// The value below which a share `p` of sorted numbers lies, by linear interpolation.
pub fn quantile(sorted: &[f64], p: f64) -> f64 {
    let place = p * (sorted.len() as f64 - 1.0);
    let below = place.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

/// The standard score that a share is away from [`BAND`], given so many independent readings: beyond about two the
/// band is wrong.
pub fn coverage_score(check: &ChannelCheck) -> f64 {
    let sd = (BAND * (1.0 - BAND) / check.independent.max(1.0)).sqrt();
    (check.coverage - BAND) / sd
}

/// Half width of a normal law's central [`BAND`], in standard deviations.
pub fn band_half_width() -> f64 {
    normal::quantile_upper(0.5 * (1.0 - BAND))
}
