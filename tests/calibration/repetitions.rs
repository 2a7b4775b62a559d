//! Calibrations repeated: of truths drawn from the prior, and of the example campaign's one truth with its noise drawn
//! anew.

use crate::campaign;
use reeldown::calibration::{LogLikelihood, Plan, Posterior, sample};
use reeldown::campaign::calibration::plan::{self, InitialTemperature};
use reeldown::campaign::calibration::{
    Channel, ChannelNoise, Coordinate, Options, Positive, RigLikelihood, SensorError, is_hardware,
};
use reeldown::descent::driven::Drive;
use reeldown::streams::{Purpose, standard_normal, stream};
use reeldown::study::{MeasuredRun, Study};

/// What a repetition came to.
pub struct Repetition {
    /// Name and rank of the truth among the draws, as a share of them, for every coordinate.
    pub ranks: Vec<(String, f64)>,
    /// Whether the truth lies in the 95 % region of the hardware's parameters: no farther from the mean of the first
    /// half of the replicates' draws, in their covariance, than 95 % of the other half's. (Draws are nearer to their
    /// own mean than another draw of the same law, so that they would make the region too small.)
    pub inside: bool,
    /// Which gates failed.
    pub failures: Vec<String>,
}

/// Fewer particles and replicates than a calibration takes.
pub fn small_plan(seed: u64) -> Plan {
    Plan { particles: 400, replicates: 2, seed, ..Plan::seeded(1993) }
}

/// The problem whose truths are drawn from its prior: two of the campaign's records, read every four seconds, with sensor
/// errors and discrepancies that are estimated, all laws fixed beforehand.
pub fn problem(study: &Study) -> RigLikelihood<'_> {
    let runs: Vec<MeasuredRun> = campaign::runs(campaign::SEED)
        .expect("the campaign can be made")
        .into_iter()
        .filter(|(name, _)| ["constant_force.csv", "constant_power.csv"].contains(name))
        .map(|(name, text)| {
            let lines: Vec<&str> = text.lines().collect();
            let thinned: Vec<&str> =
                lines.iter().take(1).chain(lines[1..].iter().step_by(4)).copied().collect();
            MeasuredRun::from_csv(name, &thinned.join("\n"), Default::default()).expect("a run")
        })
        .collect();
    let options = Options { drive: Some(Drive::Force), ..Options::seeded(1993) };
    let mut planned = plan::planned(&runs.iter().collect::<Vec<_>>(), study, &options)
        .expect("runs that can be compared");
    for run in &mut planned {
        run.initial = InitialTemperature { mean_k: 294.0, sd_k: 4.0 };
    }
    let noise = [(Channel::Speed, 0.01), (Channel::Fluid, 0.6), (Channel::Housing, 0.4)]
        .map(|(channel, scale)| ChannelNoise {
            channel,
            sensor: SensorError::Estimated(Positive { median: scale, log_sd: 0.5 }),
            discrepancy: Some((
                Positive { median: scale, log_sd: 0.7 },
                Positive { median: 30.0, log_sd: 0.5 },
            )),
        })
        .to_vec();
    let systematic = plan::systematic(&planned, &options);
    RigLikelihood::new(study, planned, systematic, noise)
}

/// Repetition `k`: a truth from the prior, data from the truth, a posterior from the data by `plan`.
pub fn from_prior(
    study: &Study,
    problem: &RigLikelihood<'_>,
    k: u64,
    plan: impl Fn(u64) -> Plan,
) -> Repetition {
    let mut stream = stream(7_000_000 + k, Purpose::Test, 0);
    let dimension = problem.coordinates().len();
    let (truth, data) = loop {
        let z: Vec<f64> = (0..dimension).map(|_| standard_normal(&mut stream)).collect();
        // An impossible brake of the prior would be no brake.
        if let Some(data) = problem.redrawn(&z, &mut stream) {
            break (z, data);
        }
    };
    let posterior = sample(&data, &plan(k)).expect("a posterior");
    compare(study, &data, &posterior, &truth)
}

/// Repetition `k` of the shipped campaign's truth, all three runs as they are shipped but for their noise and wobble.
/// Only the hardware is compared: the laws of the noise are made from the data.
pub fn of_campaign(study: &Study, k: u64) -> Repetition {
    let runs: Vec<MeasuredRun> = campaign::runs(8_000_000 + k)
        .expect("the campaign can be made")
        .into_iter()
        .filter(|(name, _)| *name != "hold_out.csv")
        .map(|(name, text)| MeasuredRun::from_csv(name, &text, Default::default()).expect("a run"))
        .collect();
    let options = Options::seeded(1993);
    let planned = plan::planned(&runs.iter().collect::<Vec<_>>(), study, &options)
        .expect("runs that can be compared");
    let likelihood = RigLikelihood::of_runs(study, planned, &options);
    let posterior = sample(&likelihood, &small_plan(k)).expect("a posterior");
    let design = campaign::truth();
    let values: Vec<f64> = study.inputs.iter().map(|input| design.at(input.target)).collect();
    let mut truth = study.joint.to_standard_normal(&values);
    truth.resize(likelihood.dimension(), f64::NAN);
    compare(study, &likelihood, &posterior, &truth)
}

fn compare(
    study: &Study,
    likelihood: &RigLikelihood<'_>,
    posterior: &Posterior,
    truth: &[f64],
) -> Repetition {
    let draws = posterior.draws();
    let ranks = likelihood
        .coordinates()
        .iter()
        .enumerate()
        .filter(|(j, _)| truth[*j].is_finite())
        .map(|(j, coordinate)| {
            let below = draws.iter().filter(|draw| draw[j] < truth[j]).count();
            let name = match *coordinate {
                Coordinate::Input(j) => study.inputs[j].target.path(),
                other => format!("{other:?}"),
            };
            (name, (below as f64 + 0.5) / (draws.len() as f64 + 1.0))
        })
        .collect();
    let hardware: Vec<usize> = (0..study.inputs.len())
        .filter(|&j| is_hardware(study.inputs[j].target.parameter))
        .collect();
    let select = |row: &[f64]| -> Vec<f64> { hardware.iter().map(|&j| row[j]).collect() };
    let rows: Vec<Vec<f64>> = draws.iter().map(|draw| select(draw)).collect();
    let (one, other) = rows.split_at(rows.len() / 2);
    let from_one = Distance::new(one);
    let mut distances: Vec<f64> = other.iter().map(|row| from_one.of(row)).collect();
    distances.sort_by(f64::total_cmp);
    let bound = distances[(0.95 * distances.len() as f64) as usize];
    Repetition {
        ranks,
        inside: from_one.of(&select(truth)) <= bound,
        failures: posterior.diagnosis.failures.clone(),
    }
}

/// Distance from the mean in the draws' own covariance.
struct Distance {
    mean: nalgebra::DVector<f64>,
    inverse: nalgebra::DMatrix<f64>,
}

impl Distance {
    fn new(rows: &[Vec<f64>]) -> Self {
        let (n, d) = (rows.len(), rows[0].len());
        let mean = nalgebra::DVector::from_fn(d, |j, _| {
            rows.iter().map(|row| row[j]).sum::<f64>() / n as f64
        });
        let mut covariance = nalgebra::DMatrix::<f64>::zeros(d, d);
        for row in rows {
            let from = nalgebra::DVector::from_column_slice(row) - &mean;
            covariance.ger(1.0 / (n as f64 - 1.0), &from, &from, 1.0);
        }
        let inverse = covariance.try_inverse().expect("draws that vary");
        Distance { mean, inverse }
    }

    fn of(&self, row: &[f64]) -> f64 {
        let from = nalgebra::DVector::from_column_slice(row) - &self.mean;
        from.dot(&(&self.inverse * &from))
    }
}

/// Chi-squared of shares of [0, 1] in `bins` equal bins against equal counts.
pub fn chi_squared(shares: &[f64], bins: usize) -> f64 {
    let mut counts = vec![0.0_f64; bins];
    for share in shares {
        counts[((share * bins as f64) as usize).min(bins - 1)] += 1.0;
    }
    let expected = shares.len() as f64 / bins as f64;
    counts.iter().map(|count| (count - expected) * (count - expected) / expected).sum()
}
