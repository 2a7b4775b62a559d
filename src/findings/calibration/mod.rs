//! What rig runs taught of the card, what they could not, and what that does to the probability of a breach.

mod agreement;
mod laws;
mod parameters;
mod statements;

use super::ReproductionFinding;
use crate::calibration::Diagnosis;
use crate::calibration::consistency::ChiSquared;
use crate::calibration::screening::Suspicion;
use crate::campaign::calibration::next_test::{NextTest, NextTests};
use crate::campaign::calibration::predictive::{BAND, ChannelCheck, coverage_score};
use crate::campaign::calibration::risk::Risk;
use crate::campaign::calibration::{Calibration, Screened};
use crate::error::Result;
use crate::physics::Target;
use crate::study::{MeasuredRun, Study};
use serde::Serialize;

pub use laws::{CorrelationFinding, LawFinding};
pub use parameters::ParameterFinding;
pub use statements::{about_one, refusal};

/// What `reeldown calibrate` found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CalibrationFinding {
    /// Layout of this tree.
    pub format: u32,
    /// The study's title.
    pub title: String,
    /// Whether every gate held and nothing contradicts anything: only then is there a card.
    pub accepted: bool,
    /// Whether the sampler's gates held.
    pub converged: bool,
    /// What the data contradict, a sentence each: each other, the card, the noise that was found.
    pub doubts: Vec<String>,
    /// The tests behind the doubts.
    pub consistency: Vec<AgreementFinding>,
    /// The answer in a few sentences.
    pub statements: Vec<String>,
    /// The runs.
    pub runs: Vec<RunFinding>,
    /// What is suspicious about their readings.
    pub suspicions: Vec<SuspicionFinding>,
    /// The inputs of the card, and what is made of them.
    pub parameters: Vec<ParameterFinding>,
    /// Initial temperatures, sensor errors, discrepancies.
    pub nuisances: Vec<ParameterFinding>,
    /// The most probable point.
    pub best_fit: BestFitFinding,
    /// Whether the posterior may be believed.
    pub diagnosis: Diagnosis,
    /// The runs against what the posterior predicts.
    pub checks: Vec<CheckFinding>,
    /// P(any breach) before and after.
    pub risk: Option<(RiskFinding, RiskFinding)>,
    /// What to measure next.
    pub next: Option<NextFinding>,
    /// A law for each calibrated input.
    pub laws: Vec<LawFinding>,
    /// Their dependence.
    pub correlations: Vec<CorrelationFinding>,
    /// Draws of the posterior in its table.
    pub draws: usize,
    /// What it takes to have the same numbers again.
    pub reproduction: ReproductionFinding,
}

/// A run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunFinding {
    /// Its file.
    pub name: String,
    /// SHA-256 of the file.
    pub sha256: String,
    /// Whether the posterior has not seen it.
    pub held_out: bool,
    /// Whether its file says that it was made up.
    pub synthetic: bool,
    /// What drives its prediction.
    pub drive: &'static str,
    /// What is predicted.
    pub predicted: Vec<&'static str>,
    /// Number of moments.
    pub moments: usize,
}

/// A test of whether the data agree with something.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AgreementFinding {
    /// What is tested: a run, or the posterior.
    pub of: String,
    /// Its channel, if only that is.
    pub channel: Option<&'static str>,
    /// Against what.
    pub against: &'static str,
    /// Chi-squared statistic, its degrees of freedom, and the probability of so much or more.
    pub test: ChiSquared,
    /// Smallest probability that raises no doubt.
    pub least: f64,
}

/// Something suspicious.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SuspicionFinding {
    /// The run.
    pub run: String,
    /// The channel.
    pub channel: &'static str,
    /// What it is.
    pub suspicion: Suspicion,
    /// In a sentence.
    pub statement: String,
}

/// The most probable point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BestFitFinding {
    /// Steps of Levenberg and Marquardt's method.
    pub steps: usize,
    /// Whether it converged.
    pub converged: bool,
    /// ln of the likelihood there.
    pub ln_likelihood: f64,
    /// Path and value of each input, SI.
    pub inputs: Vec<(String, f64)>,
}

/// A channel of a run against what the posterior predicts.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CheckFinding {
    /// The run.
    pub run: String,
    /// Whether the posterior has not seen it.
    pub held_out: bool,
    /// The channel.
    pub channel: &'static str,
    /// Share of the readings in the band that should hold `expected` of them.
    pub coverage: f64,
    /// See `coverage`.
    pub expected: f64,
    /// Number of independent readings behind it, about.
    pub independent: f64,
    /// How many of its standard errors the share is away; beyond two the band is suspect.
    pub score: f64,
    /// Root mean square of readings less the model's median, SI.
    pub residual_rms: f64,
    /// Median half width of the band, SI.
    pub half_width: f64,
    /// The course, for its figure.
    #[serde(skip)]
    pub course: Vec<CheckPoint>,
}

/// One moment of a check, SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CheckPoint {
    /// When, s.
    pub time_s: f64,
    /// What was read.
    pub measured: f64,
    /// The model's median.
    pub model: f64,
    /// The model alone, 5 % and 95 %.
    pub model_band: [f64; 2],
    /// The reading, 5 % and 95 %.
    pub band: [f64; 2],
}

/// P(any breach) over brakes and flights.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RiskFinding {
    /// Brakes and flights together.
    pub probability: f64,
    /// Of each limit.
    pub limits: Vec<(String, f64)>,
    /// 5 %, 50 % and 95 % quantiles over brakes.
    pub band: [f64; 3],
}

/// What to measure next.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NextFinding {
    /// Standard deviation of the probit of P(any breach) over brakes now.
    pub sd: f64,
    /// The band that goes with it.
    pub band: [f64; 2],
    /// Share of that variance that is linear in the inputs: what a measurement can reach by this reckoning.
    pub linear: f64,
    /// The measurements, the best first.
    pub tests: Vec<NextTestFinding>,
}

/// One possible measurement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NextTestFinding {
    /// What it is.
    pub name: String,
    /// With which errors.
    pub detail: String,
    /// Standard deviation of the probit expected afterwards.
    pub sd: f64,
    /// The band that goes with it.
    pub band: [f64; 2],
    /// Its width over the present one.
    pub width_left: f64,
}

/// Tells what a calibration came to. `files` are the SHA-256 of the runs' files, calibrated ones first.
///
/// # Errors
/// If a law refuses the posterior's moments.
pub fn calibration(
    study: &Study,
    found: &Calibration<'_>,
    runs: &[&MeasuredRun],
    files: &[String],
    command: String,
) -> Result<CalibrationFinding> {
    let (laws, correlations) = laws::laws(study, found)?;
    let (parameters, nuisances) = parameters::parameters(study, found)?;
    let count = found.likelihood.runs().len();
    let planned = found.likelihood.runs().iter().chain(&found.held_out);
    let run_findings = planned.zip(runs.iter().zip(files)).enumerate();
    let best = crate::numerics::columns::Columns::from_rows(&[&found.fit.point]);
    let best = found.likelihood.inputs(&best).row(0);
    let diagnosis = found.posterior.diagnosis.clone();
    let (consistency, doubts) = agreement::agreement(study, found);
    let converged = diagnosis.failures.is_empty();
    let mut finding = CalibrationFinding {
        format: 1,
        title: study.title.clone(),
        accepted: converged && doubts.is_empty(),
        converged,
        doubts,
        consistency,
        statements: Vec::new(),
        runs: run_findings
            .map(|(k, (planned, (run, sha256)))| RunFinding {
                name: run.origin.clone(),
                sha256: sha256.clone(),
                held_out: k >= count,
                synthetic: run.synthetic,
                drive: planned.record.drive().name(),
                predicted: planned.channels.iter().map(|(channel, _)| channel.name()).collect(),
                moments: run.time_s.len(),
            })
            .collect(),
        suspicions: suspicions(&found.screened),
        parameters,
        nuisances,
        best_fit: BestFitFinding {
            steps: found.fit.steps,
            converged: found.fit.converged,
            ln_likelihood: found.fit.ln_likelihood,
            inputs: found.likelihood.targets().iter().map(Target::path).zip(best).collect(),
        },
        diagnosis,
        checks: found
            .checks
            .iter()
            .flat_map(|run| {
                run.channels.iter().map(|channel| check(&run.name, run.held_out, channel))
            })
            .collect(),
        risk: found.risk.as_ref().map(|(before, after)| (risk(study, before), risk(study, after))),
        next: found.next.as_ref().map(next),
        laws,
        correlations,
        draws: found.draws.len(),
        reproduction: ReproductionFinding {
            version: env!("CARGO_PKG_VERSION"),
            seed: study.sampling.seed,
            study_digest: study.digest(),
            files: study.file_digests(),
            command,
        },
    };
    finding.statements = statements::statements(&finding);
    Ok(finding)
}

/// Suspicions with their sentences.
pub fn suspicions(screened: &[Screened]) -> Vec<SuspicionFinding> {
    screened
        .iter()
        .flat_map(|screened| {
            screened.suspicions.iter().map(|suspicion| SuspicionFinding {
                run: screened.run.clone(),
                channel: screened.channel.name(),
                suspicion: suspicion.clone(),
                statement: statements::suspicion(screened.channel, suspicion),
            })
        })
        .collect()
}

fn check(run: &str, held_out: bool, check: &ChannelCheck) -> CheckFinding {
    let count = check.measured.len();
    let course: Vec<CheckPoint> = (0..count)
        .map(|k| CheckPoint {
            time_s: check.time_s[k],
            measured: check.measured[k],
            model: check.model[k][1],
            model_band: [check.model[k][0], check.model[k][2]],
            band: check.band[k],
        })
        .collect();
    let squares: f64 = course.iter().map(|p| (p.measured - p.model) * (p.measured - p.model)).sum();
    let mut widths: Vec<f64> = course.iter().map(|p| 0.5 * (p.band[1] - p.band[0])).collect();
    widths.sort_by(f64::total_cmp);
    CheckFinding {
        run: run.to_owned(),
        held_out,
        channel: check.channel.name(),
        coverage: check.coverage,
        expected: BAND,
        independent: check.independent,
        score: coverage_score(check),
        residual_rms: (squares / count as f64).sqrt(),
        half_width: widths.get(count / 2).copied().unwrap_or(0.0),
        course,
    }
}

fn risk(study: &Study, risk: &Risk) -> RiskFinding {
    let names = study.limits.iter().map(|limit| limit.name());
    RiskFinding {
        probability: risk.probability,
        limits: names.zip(risk.limits.iter().copied()).collect(),
        band: risk.band,
    }
}

fn next(next: &NextTests) -> NextFinding {
    let test = |test: &NextTest| NextTestFinding {
        name: test.name.clone(),
        detail: test.detail.clone(),
        sd: test.sd,
        band: test.band,
        width_left: test.width_left,
    };
    NextFinding {
        sd: next.sd,
        band: next.band,
        linear: next.linear,
        tests: next.tests.iter().map(test).collect(),
    }
}
