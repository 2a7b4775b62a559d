//! Do the runs agree with each other, with the card, and with the noise that was found?

use super::channel::Channel;
use super::likelihood::{Coordinate, RigLikelihood};
use super::plan::{ChannelNoise, PlannedRun, Positive, SensorError};
use super::predictive::RunCheck;
use crate::calibration::consistency::{ChiSquared, NormalLaw, left_out, prior_conflict, whiteness};
use crate::calibration::{BestFit, best_fit};
use crate::error::Result;
use nalgebra::{DMatrix, DVector};

/// Chance with which any run of a campaign is doubted although it agrees, were the noise known. It is estimated, which
/// makes it more: of 24 made-up campaigns of one brake one is doubted (`tests/calibration/consistency.rs`).
pub const RUN_LEVEL: f64 = 0.001;
/// Chance with which the card is doubted although it is right: that of two standard deviations.
pub const PRIOR_LEVEL: f64 = 0.0455;
/// Chance with which any channel's noise is doubted although it is as it was found.
pub const WHITE_LEVEL: f64 = 0.001;
/// Autocorrelations that are looked at.
const LAGS: usize = 10;
/// Prior standard deviations (of the logarithm) by which a discrepancy must exceed what was allowed to be doubted.
pub const MOST_STRAY: f64 = 2.0;

/// One run against all others.
#[derive(Debug, Clone)]
pub struct RunAgreement {
    /// The run.
    pub name: String,
    /// Whether the posterior has not seen it.
    pub held_out: bool,
    /// What the others, or of a held-out run those calibrated with, expect of it.
    pub test: ChiSquared,
}

/// A channel's scores one after the other.
#[derive(Debug, Clone)]
pub struct Whiteness {
    /// The run.
    pub run: String,
    /// The channel.
    pub channel: Channel,
    /// Ljung and Box's test.
    pub test: ChiSquared,
}

/// Everything that the data could contradict.
#[derive(Debug, Clone)]
pub struct Consistency {
    /// Each run against the others; empty for a single one.
    pub runs: Vec<RunAgreement>,
    /// The posterior against the card.
    pub prior: ChiSquared,
    /// The parameter that has moved farthest, and by how many of its prior standard deviations.
    pub farthest: Option<(Coordinate, f64)>,
    /// The calibrated runs' scores.
    pub white: Vec<Whiteness>,
    /// Channels whose discrepancy is beyond what was allowed for, with its prior standard deviations above.
    pub strays: Vec<(Channel, f64)>,
}

/// Checks a campaign.
///
/// # Errors
/// If a run alone cannot be fitted.
pub fn consistency(
    likelihood: &RigLikelihood<'_>,
    held_out: &[PlannedRun],
    fit: &BestFit,
    draws: &[Vec<f64>],
    checks: &[RunCheck],
) -> Result<Consistency> {
    let count = likelihood.runs().len();
    // Noise from each run by itself: fitted together, runs of two brakes pass for one brake and a poor model.
    let mut alone = Vec::new();
    for (k, run) in likelihood.runs().iter().chain(held_out).enumerate() {
        let part = likelihood.with_runs(vec![run.clone()]);
        let places: Vec<usize> = (k < count).then_some(k).into_iter().collect();
        let begin = start(likelihood, &part, &places, &fit.point);
        let fit = best_fit(&part, &begin)?;
        alone.push((part, fit));
    }
    let law = |runs: Vec<PlannedRun>,
               noise: &[ChannelNoise],
               begin: &RigLikelihood<'_>,
               fit: &BestFit|
     -> Result<NormalLaw> {
        let part = likelihood.with_runs(runs).with_noise(noise.to_vec());
        let found = best_fit(&part, &start(begin, &part, &[], &fit.point))?;
        Ok(shared(&part, &found))
    };
    let all = likelihood.runs();
    let mut runs = Vec::new();
    for (k, (part, own_fit)) in alone.iter().enumerate() {
        let held_out = k >= count;
        let others: Vec<PlannedRun> =
            (0..count).filter(|&other| other != k).map(|other| all[other].clone()).collect();
        if others.is_empty() {
            continue;
        }
        let counted: Vec<_> = alone
            .iter()
            .enumerate()
            .filter(|(other, _)| *other < count || *other == k)
            .map(|(_, one)| one)
            .collect();
        let noise = largest_noise(likelihood, &counted);
        let own = law(part.runs().to_vec(), &noise, part, own_fit)?;
        let rest = law(others, &noise, likelihood, fit)?;
        let name = part.runs().first().map_or(String::new(), |run| run.name.clone());
        runs.push(RunAgreement { name, held_out, test: left_out(&own, &rest)? });
    }
    let coordinates = likelihood.coordinates();
    let moved = |j: usize| draws.iter().map(|draw| draw[j]).sum::<f64>() / draws.len() as f64;
    let places = shared_places(likelihood);
    let farthest = places
        .iter()
        .map(|&j| (coordinates[j], moved(j)))
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    let strays = coordinates
        .iter()
        .enumerate()
        .filter_map(|(j, coordinate)| match coordinate {
            Coordinate::Discrepancy(k) => Some((likelihood.noise()[*k].channel, moved(j))),
            _ => None,
        })
        .filter(|(_, deviations)| *deviations > MOST_STRAY)
        .collect();
    let white = checks
        .iter()
        .filter(|check| !check.held_out)
        .flat_map(|check| {
            check.channels.iter().map(|channel| Whiteness {
                run: check.name.clone(),
                channel: channel.channel,
                test: whiteness(&channel.scores, LAGS),
            })
        })
        .collect();
    Ok(Consistency {
        runs,
        prior: prior_conflict(&of_draws(draws, &places)),
        farthest,
        white,
        strays,
    })
}

/// The noise of every channel, held at the largest that any run with the channel has by itself: a single run's own fit
/// takes some of its noise for signal.
fn largest_noise(
    likelihood: &RigLikelihood<'_>,
    alone: &[&(RigLikelihood<'_>, BestFit)],
) -> Vec<ChannelNoise> {
    let of = |noise: &ChannelNoise| {
        let own = alone.iter().filter(|(part, _)| {
            part.runs().iter().any(|run| run.channels.iter().any(|(c, _)| *c == noise.channel))
        });
        let mut sensor_sd = 0.0_f64;
        let mut discrepancy = (0.0_f64, 0.0_f64);
        for (part, fit) in own {
            let found = part.noise_at(noise.channel, &fit.point);
            sensor_sd = sensor_sd.max(found.sensor_sd);
            discrepancy.0 = discrepancy.0.max(found.discrepancy_sd);
            discrepancy.1 = discrepancy.1.max(found.correlation_time_s);
        }
        let known = |median: f64| Positive { median, log_sd: 0.0 };
        ChannelNoise {
            channel: noise.channel,
            sensor: match sensor_sd > 0.0 {
                true => SensorError::Stated(sensor_sd),
                false => noise.sensor,
            },
            discrepancy: noise
                .discrepancy
                .map(|_| (known(discrepancy.0), known(discrepancy.1.max(1e-3)))),
        }
    };
    likelihood.noise().iter().map(of).collect()
}

/// The coordinates that all runs have in common: the card's and the instruments'.
fn shared_places(likelihood: &RigLikelihood<'_>) -> Vec<usize> {
    let belongs = |coordinate: &Coordinate| {
        matches!(coordinate, Coordinate::Input(_) | Coordinate::Gain(_) | Coordinate::Offset(_))
    };
    let coordinates = likelihood.coordinates();
    (0..coordinates.len()).filter(|&j| belongs(&coordinates[j])).collect()
}

/// The normal law about a fit, of what all runs have in common.
fn shared(likelihood: &RigLikelihood<'_>, fit: &BestFit) -> NormalLaw {
    let places = shared_places(likelihood);
    let n = places.len();
    NormalLaw {
        mean: DVector::from_fn(n, |j, _| fit.point[places[j]]),
        covariance: DMatrix::from_fn(n, n, |i, j| fit.covariance[(places[i], places[j])]),
    }
}

/// Where the fit of some runs begins: at the fit of all. A run from elsewhere begins at its own prior.
fn start(
    whole: &RigLikelihood<'_>,
    part: &RigLikelihood<'_>,
    places: &[usize],
    point: &[f64],
) -> Vec<f64> {
    let coordinates = whole.coordinates();
    let find = |wanted: Coordinate| {
        let wanted = match wanted {
            Coordinate::Initial(run) => Coordinate::Initial(*places.get(run)?),
            other => other,
        };
        coordinates.iter().position(|coordinate| *coordinate == wanted).map(|j| point[j])
    };
    part.coordinates().into_iter().map(|wanted| find(wanted).unwrap_or(0.0)).collect()
}

/// Mean and covariance of some coordinates of draws.
fn of_draws(draws: &[Vec<f64>], places: &[usize]) -> NormalLaw {
    let (n, count) = (places.len(), draws.len() as f64);
    let mean = DVector::from_fn(n, |j, _| draws.iter().map(|z| z[places[j]]).sum::<f64>() / count);
    let mut covariance = DMatrix::zeros(n, n);
    for z in draws {
        let from = DVector::from_fn(n, |j, _| z[places[j]] - mean[j]);
        covariance.ger(1.0 / (count - 1.0), &from, &from, 1.0);
    }
    NormalLaw { mean, covariance }
}
