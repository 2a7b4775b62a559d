//! P(breach) against the spread and the mean of every input, and against a design value: reruns of one
//! sample with common random numbers; and the sums that its derivatives are made from.

use super::analysis::{Absent, Analysis, Found, Run};
use super::common_numbers::{Breaches, Change, CommonSample, Event};
use super::scores::{FactorScores, scores};
use super::{Progress, Record, factors};
use crate::error::Result;
use crate::physics::Target;
use crate::sensitivity::pick_freeze::Factor;
use crate::streams::Purpose;
use crate::study::{DesignRange, Study};
use crate::uncertainty::Marginal;

/// Spread factors of a curve; 1, the card's own, is the base.
pub const SPREADS: [f64; 6] = [0.0, 0.25, 0.5, 0.75, 1.25, 1.5];
/// Moves of a mean, in standard deviations.
pub const SHIFTS: [f64; 4] = [-1.0, -0.5, 0.5, 1.0];
/// The main design's samples stand behind the headlines, up to this many times the curves' samples.
const HEADLINE: u64 = 5;
/// Tightenings that are confirmed on the larger sample.
pub const HEADLINES: usize = 3;
/// Half the step of a central difference, in standard deviations.
const STEP: f64 = 0.1;
/// Settings of a design value in a sweep.
const SWEEP: usize = 13;

/// The parameter of a law that a trade moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parameter {
    /// Mean.
    Mean,
    /// Spread: standard deviation, of a lognormal law the logarithm's.
    Spread,
}

/// The inputs that are traded: each group of several as one, every other input by itself, in the order
/// of the inputs.
pub fn trade_factors(study: &Study) -> Vec<Factor> {
    let all = factors(study);
    let member = |factor: &Factor| {
        all.iter().any(|other| {
            other.columns.len() > factor.columns.len()
                && factor.columns.iter().all(|column| other.columns.contains(column))
        })
    };
    let mut kept: Vec<Factor> = all.iter().filter(|factor| !member(factor)).cloned().collect();
    kept.sort_by_key(|factor| factor.columns.first().copied());
    kept
}

/// One setting of a curve.
#[derive(Debug, Clone)]
pub struct Setting {
    /// Spread factor, move of the mean (SI), or design value (SI).
    pub value: f64,
    /// The breaches there.
    pub breaches: Breaches,
    /// The changed laws, for reweighting.
    pub marginals: Vec<(usize, Marginal)>,
}

/// P against one parameter of one factor.
#[derive(Debug, Clone)]
pub struct Curve {
    /// Which factor, among [`TradeOutcomes::factors`].
    pub factor: usize,
    /// Which parameter.
    pub parameter: Parameter,
    /// The settings, the base not among them, ascending.
    pub settings: Vec<Setting>,
}

/// A derivative by common random numbers: breaches at θ + h and θ − h.
#[derive(Debug, Clone)]
pub struct CentralDifference {
    /// Which factor.
    pub factor: usize,
    /// Which parameter.
    pub parameter: Parameter,
    /// h, SI.
    pub step: f64,
    /// Breaches at θ − h and at θ + h.
    pub breaches: (Breaches, Breaches),
}

/// A headline: the spread of a factor halved, on the larger sample.
#[derive(Debug, Clone)]
pub struct Halved {
    /// Which factor.
    pub factor: usize,
    /// The breaches.
    pub breaches: Breaches,
}

/// A sweep of one design value.
#[derive(Debug, Clone)]
pub struct Sweep {
    /// The value and its range.
    pub range: DesignRange,
    /// Settings over the whole range, then over a narrower one about the best; ascending each.
    pub coarse: Vec<Setting>,
    /// See `coarse`.
    pub fine: Vec<Setting>,
}

/// The spread of every factor halved where the design values are at their best.
#[derive(Debug, Clone)]
pub struct AtBest {
    /// The design values, SI, in the order of the sweeps.
    pub design: Vec<f64>,
    /// The breaches there.
    pub base: Breaches,
    /// The breaches there with the spread of each factor halved.
    pub halved: Vec<Halved>,
}

/// Everything that the trade is told from.
#[derive(Debug)]
pub struct TradeOutcomes<'a> {
    /// The sample behind the curves.
    pub sample: CommonSample<'a>,
    /// Its breaches in the study as it is.
    pub base: Breaches,
    /// What is traded.
    pub factors: Vec<Factor>,
    /// The curves.
    pub curves: Vec<Curve>,
    /// Breaches of the larger sample in the study as it is.
    pub headline_base: Breaches,
    /// Its independently randomised replicates; 1 if every point is independent.
    pub replicates: usize,
    /// The best tightenings on it, the best first.
    pub halved: Vec<Halved>,
    /// Samples behind the score sums: all of the run, or the headlines' if the run ended by what it saw.
    pub score_samples: u64,
    /// Score sums over them.
    pub scores: Vec<FactorScores>,
    /// Derivatives by common random numbers on the larger sample, of the factors in `halved`.
    pub differences: Vec<CentralDifference>,
    /// Sweeps of the design values that may move.
    pub sweeps: Vec<Sweep>,
    /// The tightenings where the design is at its best; `None` if nothing may move.
    pub at_best: Option<AtBest>,
}

/// Samples behind the curves, and behind the headlines: fixed before the run. What an adaptive run saw decides
/// where it stops, so a trade whose size followed it would not have earned its intervals.
fn sizes(study: &Study) -> (u64, u64) {
    let most = study.sampling.samples;
    let factor = if study.sampling.stopping.is_some() { 1 } else { HEADLINE };
    (study.trade.samples.min(most), (factor * study.trade.samples).min(most))
}

impl<'a> Analysis<'a> for TradeOutcomes<'a> {
    const NAME: &'static str = "trade of tolerances";

    fn cost(study: &Study) -> Found<u64> {
        Absent::unless_asked("trade.samples", study.trade.samples)?;
        Absent::unless_limited(study)?;
        let factors = trade_factors(study).len() as u64;
        let (rows, headline) = sizes(study);
        let curves = factors * (SPREADS.len() + SHIFTS.len()) as u64;
        let sweeps = study.tighten.design.len() as u64 * (2 * SWEEP as u64) + factors + 1;
        Ok(rows * (1 + curves + sweeps) + headline * 5 * HEADLINES as u64)
    }

    fn compute(run: Run<'a>) -> Result<Option<Self>> {
        run_trade(run.study, run.record, run.progress)
    }
}

/// Computes the trade of a study whose samples have been run. `None` if `progress` asks for a stop.
///
/// # Errors
/// If a law cannot be moved or stretched as the curves need it.
pub fn run_trade<'a>(
    study: &'a Study,
    record: &Record,
    progress: &Progress,
) -> Result<Option<TradeOutcomes<'a>>> {
    let (rows, headline) = sizes(study);
    let sample = CommonSample::of_run(study, rows)?;
    let factors = trade_factors(study);
    let of_run = |first: usize, rows: usize| {
        Breaches::from_margins(study.limits.len(), rows, |i, k| record.margins(i)[first + k])
    };
    let run = record.counts().samples();
    let base_of = |sample: &CommonSample<'_>| match sample.rows() {
        rows if rows as u64 <= run => Ok(of_run(0, rows)),
        // Points beyond where an adaptive run stopped.
        _ => sample.base(progress),
    };
    let base = base_of(&sample)?;
    let mut curves = Vec::new();
    for (f, factor) in factors.iter().enumerate() {
        for parameter in [Parameter::Spread, Parameter::Mean] {
            if progress.stopping() {
                return Ok(None);
            }
            curves.push(curve(&sample, f, &factor.columns, parameter, progress)?);
        }
    }
    let headline = CommonSample::of_run(study, headline)?;
    let headline_base = base_of(&headline)?;
    let mut halved = Vec::new();
    let mut differences = Vec::new();
    for f in best_halvings(&curves, &base) {
        let columns = &factors[f].columns;
        let change = Change::spread(study, columns, 0.5)?;
        halved.push(Halved { factor: f, breaches: headline.changed(&change, progress)? });
        for parameter in [Parameter::Spread, Parameter::Mean] {
            let found = central_difference(&headline, f, columns, parameter, progress)?;
            differences.extend(found);
        }
    }
    let mut sweeps = Vec::new();
    for range in &study.tighten.design {
        if progress.stopping() {
            return Ok(None);
        }
        sweeps.push(sweep(&sample, range, progress)?);
    }
    let at_best = match sweeps.is_empty() {
        true => None,
        false => Some(at_best(&sample, &factors, &sweeps, progress)?),
    };
    let replicates = headline.replicates();
    let (score_samples, scores) = match study.sampling.stopping {
        None => (run, scores(study, run, of_run, &factors)?),
        Some(_) => {
            let rows = headline_base.rows() as u64;
            let part = |first, rows| headline_base.part(first..first + rows);
            (rows, scores(study, rows, part, &factors)?)
        }
    };
    Ok(Some(TradeOutcomes {
        score_samples,
        sample,
        base,
        factors,
        curves,
        headline_base,
        replicates,
        halved,
        scores,
        differences,
        sweeps,
        at_best,
    }))
}

fn curve(
    sample: &CommonSample<'_>,
    factor: usize,
    columns: &[usize],
    parameter: Parameter,
    progress: &Progress,
) -> Result<Curve> {
    let study = sample.study();
    let sd = columns.first().map_or(0.0, |&j| study.inputs[j].marginal.law().sd());
    let values: Vec<f64> = match parameter {
        Parameter::Spread => SPREADS.to_vec(),
        Parameter::Mean if is_mixed(study, columns) => Vec::new(),
        Parameter::Mean => SHIFTS.iter().map(|shift| shift * sd).collect(),
    };
    let mut settings = Vec::with_capacity(values.len());
    for value in values {
        let change = match parameter {
            Parameter::Spread => Change::spread(study, columns, value),
            Parameter::Mean => Change::shift(study, columns, value),
        };
        // Not every law has room: a lognormal law of great spread has none below.
        let Ok(change) = change else { continue };
        let breaches = sample.changed(&change, progress)?;
        settings.push(Setting { value, breaches, marginals: change.marginals });
    }
    Ok(Curve { factor, parameter, settings })
}

/// The factors whose halved spread lowers P(any) most.
fn best_halvings(curves: &[Curve], base: &Breaches) -> Vec<usize> {
    let all = 0..base.rows();
    let mut gains: Vec<(usize, f64)> = curves
        .iter()
        .filter(|curve| curve.parameter == Parameter::Spread)
        .filter_map(|curve| {
            let half = curve.settings.iter().find(|setting| setting.value == 0.5)?;
            let counts = half.breaches.against(base, Event::Any, all.clone());
            Some((curve.factor, counts.gained as f64 - counts.lost as f64))
        })
        .collect();
    gains.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    gains.into_iter().take(HEADLINES).map(|(factor, _)| factor).collect()
}

/// The law with its parameter moved by `delta`, truncation limits held: what the score differentiates.
fn moved(marginal: &Marginal, parameter: Parameter, delta: f64) -> Result<Marginal> {
    let law = match parameter {
        Parameter::Mean => marginal.law().with_shifted_mean(delta)?,
        Parameter::Spread => marginal.law().with_spread(1.0 + delta / marginal.law().spread())?,
    };
    Marginal::new(law, marginal.lower(), marginal.upper())
}

/// Whether the inputs are of different quantities, which no common step moves.
fn is_mixed(study: &Study, columns: &[usize]) -> bool {
    let parameter = |&j: &usize| study.inputs[j].target.parameter;
    columns.windows(2).any(|pair| parameter(&pair[0]) != parameter(&pair[1]))
}

fn central_difference(
    sample: &CommonSample<'_>,
    factor: usize,
    columns: &[usize],
    parameter: Parameter,
    progress: &Progress,
) -> Result<Option<CentralDifference>> {
    let study = sample.study();
    let Some(&first) = columns.first() else { return Ok(None) };
    if is_mixed(study, columns) {
        return Ok(None);
    }
    let law = study.inputs[first].marginal.law();
    let step = STEP * if parameter == Parameter::Mean { law.sd() } else { law.spread() };
    // The law of a few readings may have no standard deviation to step by.
    if !step.is_finite() {
        return Ok(None);
    }
    let side = |delta: f64| -> Result<Breaches> {
        let mut change = Change::default();
        for &j in columns {
            change.marginals.push((j, moved(&study.inputs[j].marginal, parameter, delta)?));
        }
        sample.changed(&change, progress)
    };
    let breaches = (side(-step)?, side(step)?);
    Ok(Some(CentralDifference { factor, parameter, step, breaches }))
}

fn sweep(sample: &CommonSample<'_>, range: &DesignRange, progress: &Progress) -> Result<Sweep> {
    let settings = |lower: f64, upper: f64| -> Result<Vec<Setting>> {
        (0..SWEEP)
            .map(|k| {
                let value = lower + (upper - lower) * k as f64 / (SWEEP - 1) as f64;
                let change = Change::default().and_design(range.target, value);
                let breaches = sample.changed(&change, progress)?;
                Ok(Setting { value, breaches, marginals: Vec::new() })
            })
            .collect()
    };
    let coarse = settings(range.lower, range.upper)?;
    let step = (range.upper - range.lower) / (SWEEP - 1) as f64;
    let best = coarse
        .iter()
        .min_by(|a, b| a.breaches.worst_share().total_cmp(&b.breaches.worst_share()))
        .map_or(range.lower, |setting| setting.value);
    let fine =
        settings((best - 1.5 * step).max(range.lower), (best + 1.5 * step).min(range.upper))?;
    Ok(Sweep { range: range.clone(), coarse, fine })
}

/// The breaches of the study as it is and with a design value that was found by looking, at `rows` fresh plain Monte
/// Carlo points: those of the search have the luck of the draw on the found value's side.
///
/// # Errors
/// If nothing is uncertain, or a law cannot be moved to the value.
pub fn design_value_anew(
    study: &Study,
    target: Target,
    value: f64,
    rows: u64,
) -> Result<(Breaches, Breaches)> {
    let progress = Progress::default();
    let sample = CommonSample::independent(study, 0..rows, Purpose::Confirmation)?;
    let there = Change::default().and_design(target, value);
    Ok((sample.base(&progress)?, sample.changed(&there, &progress)?))
}

/// Every factor's spread halved at the best settings of the sweeps.
fn at_best(
    sample: &CommonSample<'_>,
    factors: &[Factor],
    sweeps: &[Sweep],
    progress: &Progress,
) -> Result<AtBest> {
    let mut design = Vec::with_capacity(sweeps.len());
    let mut there = Change::default();
    for sweep in sweeps {
        let best = sweep
            .fine
            .iter()
            .min_by(|a, b| a.breaches.worst_share().total_cmp(&b.breaches.worst_share()))
            .map_or(sweep.range.lower, |setting| setting.value);
        design.push(best);
        there = there.and_design(sweep.range.target, best);
    }
    let base = sample.changed(&there, progress)?;
    let mut halved = Vec::with_capacity(factors.len());
    for (factor, found) in factors.iter().enumerate() {
        let change = there.clone().and_spread(sample.study(), &found.columns, 0.5)?;
        halved.push(Halved { factor, breaches: sample.changed(&change, progress)? });
    }
    Ok(AtBest { design, base, halved })
}
