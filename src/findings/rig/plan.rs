//! Which runs on the rig are worth most: every combination of up to four candidates.

use super::band::{Band, HalfSpaces};
use super::equipment::Equipment;
use super::information::{Instruments, Parameters, information, posterior};
use super::run::{RigRun, flight_means, held};
use crate::campaign::{Progress, in_parallel};
use crate::descent::OutcomeQuantity;
use crate::descent::driven::Drive;
use crate::error::{Error, Result};
use crate::physics::{Design, Parameter, Target};
use crate::study::Study;
use nalgebra::DMatrix;
use serde::Serialize;

/// Most runs in a plan: the paper's trucks allow two to four.
pub const MOST_RUNS: usize = 4;
/// A gentler level as a share of the top one.
const GENTLE: f64 = 0.7;
/// Combinations of each number of runs that are reported.
const REPORTED: usize = 5;
/// Halvings that place the top level.
const HALVINGS: usize = 30;

/// What may be planned.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanOptions {
    /// Runs available, 1 to [`MOST_RUNS`].
    pub runs: usize,
    /// Temperatures that a run can be started at, K.
    pub starts_k: Vec<f64>,
    /// Proof load and instruments.
    pub equipment: Equipment,
}

/// One run that could be made.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Candidate {
    /// What the truck holds.
    pub mode: &'static str,
    /// How much of it, SI.
    pub level: f64,
    /// Temperature at the start, K.
    pub start_k: f64,
    /// Length of the run, s.
    pub duration_s: f64,
    /// Highest load on the line, N.
    pub peak_force_n: f64,
    /// Highest fluid temperature, K.
    pub peak_fluid_k: f64,
    /// The band of P to be expected after this run alone.
    pub band: Band,
    #[serde(skip)]
    drive: Drive,
}

/// A combination of runs and what it is expected to leave.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Combination {
    /// Places of its runs among the candidates, in no order; a run may be repeated.
    pub runs: Vec<usize>,
    /// The band of P to be expected.
    pub band: Band,
    /// Standard deviation of each parameter after over before, in the order of [`PlanFinding::parameters`].
    pub remaining: Vec<f64>,
}

/// The plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlanFinding {
    /// Load that no run exceeds, N.
    pub proof_load_n: f64,
    /// The instruments.
    pub instruments: Instruments,
    /// What of load and instruments is assumed.
    pub assumed: Vec<String>,
    /// Paths of the parameters; like ones as one, with how many; last, the brake constant.
    pub parameters: Vec<(String, usize)>,
    /// The band of P without a run.
    pub now: Band,
    /// P of each limit by its half space.
    pub limits: Vec<(String, f64)>,
    /// Limits that are left out, as no design point was found.
    pub left_out: Vec<String>,
    /// Every candidate.
    pub candidates: Vec<Candidate>,
    /// Candidates that cannot be run, and why.
    pub refused: Vec<String>,
    /// Combinations searched.
    pub searched: usize,
    /// The best combinations of 1, 2, … runs, the best first.
    pub best: Vec<Vec<Combination>>,
    /// The best combination of 1, 2, … runs none of which is at constant power; as long as there is one.
    pub without_power: Vec<Combination>,
    /// The study's own initial temperature, K: a run from another needs the brake cooled or heated first.
    pub start_k: f64,
}

/// The greatest level up to `most` that a limit allows: by halving, as loads and temperatures grow with it.
fn greatest(most: f64, allowed: impl Fn(f64) -> bool) -> Option<f64> {
    if allowed(most) {
        return Some(most);
    }
    let (mut low, mut high) = (0.0, most);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if allowed(middle) { low = middle } else { high = middle }
    }
    (low > 0.05 * most).then_some(low)
}

/// The level of a mode that is nearest to the flight's mean within the proof load and the fluid's limit, and
/// its run; none if not even a gentle pull is possible.
pub fn top_level(
    study: &Study,
    design: &Design,
    drive: Drive,
    most: f64,
    proof_load_n: f64,
) -> Option<(f64, RigRun)> {
    let hottest = study
        .limits
        .iter()
        .filter(|limit| limit.outcome == OutcomeQuantity::PeakFluidTemperature)
        .map(|limit| limit.value)
        .fold(f64::INFINITY, f64::min);
    let allowed = |level: f64| {
        held(design, drive, level).is_ok_and(|run| {
            run.outcome.deployed
                && run.outcome.get(OutcomeQuantity::PeakTension) <= proof_load_n
                && run.outcome.get(OutcomeQuantity::PeakFluidTemperature) <= hottest
        })
    };
    let level = greatest(most, allowed)?;
    Some((level, held(design, drive, level).ok()?))
}

/// The candidates of one mode and start with their information, or why there are none.
type Attempt = std::result::Result<Vec<Informed>, String>;

/// A candidate with its Fisher information.
type Informed = (Candidate, DMatrix<f64>);

/// The candidates: three modes, each at the flight's mean (or what proof load and fluid allow) and gentler, from
/// each starting temperature.
fn candidates(
    study: &Study,
    parameters: &Parameters,
    options: &PlanOptions,
) -> Result<(Vec<Informed>, Vec<String>)> {
    let means = flight_means(&parameters.median)?;
    let mut wanted = Vec::new();
    for &start_k in &options.starts_k {
        for (drive, mean) in Drive::ALL.into_iter().zip([means[0], means[1], means[2]]) {
            wanted.push((start_k, drive, mean));
        }
    }
    let found = in_parallel(&wanted, |&(start_k, drive, mean)| -> Result<Attempt> {
        let mut design = parameters.median.clone();
        design.set(Target::whole(Parameter::InitialTemperature), start_k);
        let Some((top, run)) =
            top_level(study, &design, drive, mean, options.equipment.proof_load_n)
        else {
            return Ok(Err(format!(
                "constant {} from {start_k:.1} K: no level keeps the proof load, the fluid's limit and the time",
                drive.name()
            )));
        };
        let mut pair = Vec::new();
        for (level, run) in [(top, Some(run)), (GENTLE * top, None)] {
            let run = match run {
                Some(run) => run,
                None => held(&design, drive, level)?,
            };
            if !run.outcome.deployed {
                continue;
            }
            let get = |quantity| run.outcome.get(quantity);
            let duration_s = get(OutcomeQuantity::Time);
            let instruments = &options.equipment.instruments;
            let matrix = information(parameters, instruments, start_k, drive, level, duration_s)?;
            let candidate = Candidate {
                mode: drive.name(),
                level,
                start_k,
                duration_s,
                peak_force_n: get(OutcomeQuantity::PeakTension),
                peak_fluid_k: get(OutcomeQuantity::PeakFluidTemperature),
                band: Band::NOTHING,
                drive,
            };
            pair.push((candidate, matrix));
        }
        Ok(Ok(pair))
    });
    let (mut kept, mut refused) = (Vec::new(), Vec::new());
    for result in found {
        match result? {
            Ok(pair) => kept.extend(pair),
            Err(why) => refused.push(why),
        }
    }
    Ok((kept, refused))
}

/// Every multiset of `size` of `count` candidates.
fn multisets(count: usize, size: usize) -> Vec<Vec<usize>> {
    let mut found = vec![Vec::new()];
    for _ in 0..size {
        found = found
            .into_iter()
            .flat_map(|set: Vec<usize>| {
                let from = set.last().copied().unwrap_or(0);
                (from..count).map(move |next| set.iter().copied().chain([next]).collect())
            })
            .collect();
    }
    found
}

/// Plans up to four runs.
///
/// # Errors
/// Options that are impossible; a study without limits or parameters; runs that cannot be computed.
pub fn plan(study: &Study, options: &PlanOptions) -> Result<PlanFinding> {
    if !(1..=MOST_RUNS).contains(&options.runs) {
        let problem = format!("{} runs cannot be planned: 1 to {MOST_RUNS} can", options.runs);
        return Err(Error::argument(problem));
    }
    let parameters = Parameters::new(study);
    if parameters.count() == 0 {
        return Err(Error::argument(
            "the card has no uncertain input that a run on the rig could teach something about",
        ));
    }
    let spaces = HalfSpaces::new(study, &parameters.inputs, &Progress::default())?;
    let (candidates, refused) = candidates(study, &parameters, options)?;
    if candidates.is_empty() {
        return Err(Error::argument(format!("no run is possible: {}", refused.join("; "))));
    }
    let count = parameters.count();
    let after = |runs: &[usize]| {
        let matrices: Vec<&DMatrix<f64>> = runs.iter().map(|&k| &candidates[k].1).collect();
        posterior(count, &matrices)
    };
    let seed = study.sampling.seed;
    let groups = Groups::new(study, &parameters);
    let combination = |runs: &Vec<usize>| {
        let covariance = after(runs);
        Combination {
            runs: runs.clone(),
            band: spaces.band(seed, &covariance),
            remaining: groups.remaining(&covariance),
        }
    };
    let (mut searched, mut best, mut without_power) = (0, Vec::new(), Vec::new());
    for size in 1..=options.runs {
        let sets = multisets(candidates.len(), size);
        searched += sets.len();
        let deviations = in_parallel(&sets, |runs| spaces.index_deviation(&after(runs)));
        let mut order: Vec<usize> = (0..sets.len()).collect();
        order.sort_by(|&a, &b| deviations[a].total_cmp(&deviations[b]));
        // A driver can hold a force or a speed; a power asks for both to change all the time.
        let simple =
            |runs: &&Vec<usize>| runs.iter().all(|&k| candidates[k].0.drive != Drive::Power);
        let first = order.iter().map(|&k| &sets[k]).find(simple);
        without_power.extend(first.map(&combination));
        let top: Vec<&Vec<usize>> = order.iter().take(REPORTED).map(|&k| &sets[k]).collect();
        best.push(in_parallel(&top, |runs| combination(runs)));
    }
    let places: Vec<usize> = (0..candidates.len()).collect();
    let bands = in_parallel(&places, |&k| spaces.band(seed, &after(&[k])));
    let now = spaces.band(seed, &DMatrix::identity(count, count));
    let candidates = candidates.iter().zip(bands);
    Ok(PlanFinding {
        proof_load_n: options.equipment.proof_load_n,
        instruments: options.equipment.instruments.clone(),
        assumed: options.equipment.assumed.clone(),
        parameters: groups.names,
        now,
        limits: spaces.probabilities.clone(),
        left_out: spaces.left_out.clone(),
        candidates: candidates.map(|((c, _), band)| Candidate { band, ..c.clone() }).collect(),
        refused,
        searched,
        best,
        without_power,
        start_k: study.design.get(Parameter::InitialTemperature),
    })
}

/// Parameters that are alike, such as the gaps of one statement, and the brake constant.
pub(super) struct Groups {
    /// Names and numbers of members; the last is the brake constant.
    pub names: Vec<(String, usize)>,
    members: Vec<Vec<usize>>,
    brake: Vec<f64>,
}

impl Groups {
    pub fn new(study: &Study, parameters: &Parameters) -> Self {
        let mut names: Vec<(String, usize)> = Vec::new();
        let mut members: Vec<Vec<usize>> = Vec::new();
        for (j, &k) in parameters.inputs.iter().enumerate() {
            let input = &study.inputs[k];
            let name = input.group.clone().unwrap_or_else(|| input.target.path());
            match names.iter().position(|(other, _)| *other == name) {
                Some(place) => {
                    names[place].1 += 1;
                    members[place].push(j);
                }
                None => {
                    names.push((name, 1));
                    members.push(vec![j]);
                }
            }
        }
        names.push(("brake constant".to_owned(), 1));
        Groups { names, members, brake: parameters.brake_constant() }
    }

    /// Standard deviations over the prior's; of alike parameters the root mean square.
    pub fn remaining(&self, covariance: &DMatrix<f64>) -> Vec<f64> {
        let mut shares: Vec<f64> = self
            .members
            .iter()
            .map(|members| {
                let sum: f64 = members.iter().map(|&j| covariance[(j, j)]).sum();
                (sum / members.len() as f64).max(0.0).sqrt()
            })
            .collect();
        let (mut after, mut before) = (0.0, 0.0);
        for (i, a) in self.brake.iter().enumerate() {
            before += a * a;
            for (j, b) in self.brake.iter().enumerate() {
                after += a * b * covariance[(i, j)];
            }
        }
        shares.push(if before > 0.0 { (after.max(0.0) / before).sqrt() } else { 1.0 });
        shares
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_multisets_are_counted_by_binomials() {
        for (count, size, expected) in [(3, 2, 6), (18, 4, 5985), (1, 4, 1)] {
            assert_eq!(multisets(count, size).len(), expected);
        }
        assert_eq!(multisets(2, 2), [[0, 0], [0, 1], [1, 1]]);
    }

    #[test]
    fn analytic_the_greatest_allowed_level() {
        assert_eq!(greatest(4.0, |_| true), Some(4.0));
        assert!((greatest(4.0, |x| x <= 3.0).unwrap_or(0.0) - 3.0).abs() < 1e-8);
        assert_eq!(greatest(4.0, |_| false), None);
    }
}
