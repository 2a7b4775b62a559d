//! Rig runs in, a posterior of the card's inputs out.
//!
//! The steps: [`plan`] turns measured runs and a study into what is compared with what; [`likelihood`] drives brakes by
//! the records, many at a time; the best fit and the posterior are [`crate::calibration`]'s; [`predictive`] asks whether the
//! runs look as they should; [`risk`] what it does to the probability of a breach; [`next_test`] what to measure next.
//! [`synthetic`] makes up runs from a known truth.

mod channel;
pub mod consistency;
pub mod duplicates;
pub mod likelihood;
pub mod next_test;
pub mod plan;
pub mod predictive;
pub mod risk;
pub mod synthetic;

use super::Progress;
use crate::calibration::screening::{self, Suspicion};
use crate::calibration::{BestFit, Posterior, best_fit, sample};
use crate::error::{Error, Result};
use crate::numerics::columns::Columns;
use crate::numerics::elementary::ln;
use crate::study::{MeasuredRun, Study};
pub use channel::Channel;
use consistency::Consistency;
pub use likelihood::{Coordinate, RigLikelihood};
use next_test::NextTests;
pub use plan::{ChannelNoise, Options, PlannedRun, Positive, SensorError, Systematic, is_hardware};
use predictive::RunCheck;
use risk::Risk;

/// What is suspicious about a channel of a run.
#[derive(Debug, Clone)]
pub struct Screened {
    /// The run.
    pub run: String,
    /// The channel.
    pub channel: Channel,
    /// What is suspicious.
    pub suspicions: Vec<Suspicion>,
}

/// A calibration, done.
#[derive(Debug)]
pub struct Calibration<'a> {
    /// The likelihood, with its runs and noises.
    pub likelihood: RigLikelihood<'a>,
    /// Runs that the posterior has not seen.
    pub held_out: Vec<PlannedRun>,
    /// Suspicions about the readings.
    pub screened: Vec<Screened>,
    /// The most probable point.
    pub fit: BestFit,
    /// The posterior.
    pub posterior: Posterior,
    /// Every draw of it, in standard-normal space.
    pub draws: Vec<Vec<f64>>,
    /// The inputs of every draw, SI.
    pub inputs: Columns,
    /// The runs against the posterior's predictions.
    pub checks: Vec<RunCheck>,
    /// Whether runs, card and noise agree.
    pub consistency: Consistency,
    /// P(any breach) with the study's card, and with the posterior; none without limits.
    pub risk: Option<(Risk, Risk)>,
    /// What to measure next; none without limits.
    pub next: Option<NextTests>,
}

/// Likelihoods that each particle takes, about.
const LIKELIHOODS: u64 = 130;
/// Brakes of the prior that a run's level is held against.
const SCREENED_BRAKES: usize = 400;

/// Looks at runs before anything is believed of them: their channels' own course, and their level against what the card
/// allows.
///
/// # Errors
/// Those of the plan.
pub fn screen(study: &Study, runs: &[&MeasuredRun], options: &Options) -> Result<Vec<Screened>> {
    let planned = plan::planned(runs, study, options)?;
    let likelihood = RigLikelihood::of_runs(study, planned, options);
    let prior = risk::prior_brakes(study, SCREENED_BRAKES)?;
    let mut found = Vec::new();
    for (run, planned) in runs.iter().zip(likelihood.runs()) {
        let initial = vec![planned.initial.mean_k; prior.rows()];
        let predictions = likelihood.predict(&planned.record, &prior, &initial, &[]);
        for channel in Channel::ALL {
            let Some(values) = channel.measured(run) else { continue };
            let mut suspicions = screening::screen(&run.time_s, values);
            if planned.channels.iter().any(|(other, _)| *other == channel) {
                let medians: Vec<f64> = predictions
                    .iter()
                    .flatten()
                    .filter_map(|prediction| {
                        let predicted: Vec<f64> =
                            prediction.readings.iter().map(|r| channel.predicted(r)).collect();
                        screening::median(&predicted)
                    })
                    .collect();
                suspicions.extend(suspect_level(channel, values, &medians));
            }
            if !suspicions.is_empty() {
                found.push(Screened { run: run.origin.clone(), channel, suspicions });
            }
        }
    }
    Ok(found)
}

/// A channel's level against those of the prior's brakes.
fn suspect_level(channel: Channel, values: &[f64], predicted: &[f64]) -> Option<Suspicion> {
    let (read, centre) = (screening::median(values)?, screening::median(predicted)?);
    let spread = |of: &dyn Fn(f64) -> f64| {
        let about: Vec<f64> = predicted.iter().map(|&x| of(x)).collect();
        crate::calibration::posterior::mean_variance(&about).1.sqrt()
    };
    match channel.is_temperature() {
        true => screening::suspect_scale(read, centre, spread(&|x| x)),
        false if centre > 0.0 => {
            screening::suspect_factor(read / centre, spread(&|x| ln(x.max(1e-300))))
        }
        false => None,
    }
}

/// What a calibration takes, about, in the units of its progress.
pub fn about(options: &Options, runs: &[&MeasuredRun]) -> u64 {
    let moments = runs.iter().map(|run| run.time_s.len()).sum();
    let likelihoods =
        LIKELIHOODS * options.plan.particles as u64 * u64::from(options.plan.replicates);
    likelihoods * likelihood::work(moments) as u64 + 2 * (risk::BRAKES * risk::FLIGHTS) as u64
}

/// Calibrates a study's card by measured runs; `held_out` runs are predicted only. `None` if `progress` asks for a stop.
///
/// # Errors
/// A card that cannot be a prior, a run that cannot be compared or is there twice, data that the card excludes.
pub fn calibrate<'a>(
    study: &'a Study,
    runs: &[&MeasuredRun],
    held_out: &[&MeasuredRun],
    options: &Options,
    progress: &'a Progress,
) -> Result<Option<Calibration<'a>>> {
    match calibrated(study, runs, held_out, options, progress) {
        Err(_) if progress.stopping() => Ok(None),
        found => found.map(Some),
    }
}

fn calibrated<'a>(
    study: &'a Study,
    runs: &[&MeasuredRun],
    held_out: &[&MeasuredRun],
    options: &Options,
    progress: &'a Progress,
) -> Result<Calibration<'a>> {
    duplicates::refuse_twice(runs, held_out)?;
    if !study.inputs.iter().any(|input| is_hardware(input.target.parameter)) {
        return Err(Error::argument(
            "nothing of the brake or its fluid is uncertain in this study: there is nothing to calibrate",
        ));
    }
    if !study.joint.samples().is_empty() {
        return Err(Error::argument(
            "the card draws inputs from the rows of a joint sample, whose density is not known: calibrate from a card \
             of laws (an earlier calibration writes one, calibrated_laws.toml)",
        ));
    }
    let everything: Vec<&MeasuredRun> = runs.iter().chain(held_out).copied().collect();
    let screened = screen(study, &everything, options)?;
    let planned = plan::planned(runs, study, options)?;
    let held_out = plan::planned(held_out, study, options)?;
    let likelihood = RigLikelihood::of_runs(study, planned, options).watched(progress);
    let noise = likelihood.noise();
    let unseen = held_out
        .iter()
        .flat_map(|run| run.channels.iter().map(move |(channel, _)| (run, *channel)))
        .find(|(_, channel)| !noise.iter().any(|noise| noise.channel == *channel));
    if let Some((run, channel)) = unseen {
        return Err(Error::argument(format!(
            "{}: its {} is predicted, but in no calibrated run, so its noise is not known: name the same --drive for \
             all, or leave the column out",
            run.name,
            channel.name()
        )));
    }
    let start = vec![0.0; likelihood.coordinates().len()];
    let fit = best_fit(&likelihood, &start)?;
    let posterior = sample(&likelihood, &options.plan)?;
    let draws = posterior.draws();
    let inputs = likelihood.inputs(&Columns::from_rows(&draws));
    let checks = predictive::check(&likelihood, &held_out, &draws, options.plan.seed)?;
    let consistency = consistency::consistency(&likelihood, &held_out, &fit, &draws, &checks)?;
    let (risk, next) = match study.limits.is_empty() {
        true => (None, None),
        false => {
            let before = risk::risk(study, &risk::prior_brakes(study, risk::BRAKES)?, progress)?;
            let step = (draws.len() / risk::BRAKES).max(1);
            let chosen: Vec<Vec<f64>> =
                draws.iter().step_by(step).take(risk::BRAKES).cloned().collect();
            let brakes = likelihood.inputs(&Columns::from_rows(&chosen));
            let after = risk::risk(study, &brakes, progress)?;
            let next = next_test::next_tests(
                study,
                &likelihood,
                &chosen,
                &after.probits,
                after.own_variance,
            )?;
            (Some((before, after)), Some(next))
        }
    };
    Ok(Calibration {
        likelihood,
        held_out,
        screened,
        fit,
        posterior,
        draws,
        inputs,
        checks,
        consistency,
        risk,
        next,
    })
}
