//! P(breach) against the spread and the mean of every input, and against a design value: reruns of one
//! sample with common random numbers; and the sums that its derivatives are made from.

use super::common_numbers::{Breaches, Change, CommonSample, Event};
use super::{Progress, Record, factors, in_parallel, sampler};
use crate::error::Result;
use crate::numerics::columns::Columns;
use crate::sensitivity::pick_freeze::Factor;
use crate::sensitivity::score_sums::ScoreSums;
use crate::study::{DesignRange, Study};
use crate::uncertainty::{Law, Marginal};

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
/// Samples in a piece of the score sums.
const PIECE: u64 = 4096;
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
    let mut kept: Vec<Factor> = all
        .iter()
        .filter(|factor| !member(factor))
        .map(|factor| Factor {
            name: factor.name.trim_end_matches(" (all)").to_owned(),
            columns: factor.columns.clone(),
        })
        .collect();
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

/// Sums behind the derivatives of one factor's parameter.
#[derive(Debug, Clone)]
pub struct FactorScores {
    /// Which factor.
    pub factor: usize,
    /// Which parameter.
    pub parameter: Parameter,
    /// One a limit, then one of any limit; or why there are none.
    pub sums: std::result::Result<Vec<ScoreSums>, String>,
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
    /// Score sums over all samples of the run.
    pub scores: Vec<FactorScores>,
    /// Derivatives by common random numbers on the larger sample, of the factors in `halved`.
    pub differences: Vec<CentralDifference>,
    /// Sweeps of the design values that may move.
    pub sweeps: Vec<Sweep>,
}

/// Descents that the trade of a study takes, about.
pub fn trade_descents(study: &Study) -> u64 {
    let factors = trade_factors(study).len() as u64;
    let rows = study.trade.samples.min(study.sampling.samples);
    let curves = factors * (SPREADS.len() + SHIFTS.len()) as u64;
    let headline = (HEADLINE * study.trade.samples).min(study.sampling.samples);
    let sweeps = study.tighten.design.len() as u64 * (2 * SWEEP as u64);
    rows * (1 + curves + sweeps) + headline * 5 * HEADLINES as u64
}

/// Computes the trade of a study whose samples have been run. `None` if the study asks for none, has no
/// limit, or `progress` asks for a stop.
///
/// # Errors
/// If a law cannot be moved or stretched as the curves need it.
pub fn run_trade<'a>(
    study: &'a Study,
    record: &Record,
    progress: &Progress,
) -> Result<Option<TradeOutcomes<'a>>> {
    if study.trade.samples == 0 || study.limits.is_empty() {
        return Ok(None);
    }
    let sample = CommonSample::of_run(study, study.trade.samples)?;
    let factors = trade_factors(study);
    let of_run =
        |rows: usize| Breaches::from_margins(study.limits.len(), rows, |i, k| record.margins(i)[k]);
    let base = of_run(sample.rows());
    let mut curves = Vec::new();
    for (f, factor) in factors.iter().enumerate() {
        for parameter in [Parameter::Spread, Parameter::Mean] {
            if progress.stopping() {
                return Ok(None);
            }
            curves.push(curve(&sample, f, &factor.columns, parameter, progress)?);
        }
    }
    let headline = CommonSample::of_run(study, HEADLINE * study.trade.samples)?;
    let headline_base = of_run(headline.rows());
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
    let replicates = headline.replicates();
    let scores = scores(study, record, &factors)?;
    Ok(Some(TradeOutcomes {
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
        Parameter::Mean => SHIFTS.iter().map(|shift| shift * sd).collect(),
    };
    let mut settings = Vec::with_capacity(values.len());
    for value in values {
        let change = match parameter {
            Parameter::Spread => Change::spread(study, columns, value)?,
            Parameter::Mean => match Change::shift(study, columns, value) {
                Ok(change) => change,
                // A lognormal law of great spread has no room below.
                Err(_) => continue,
            },
        };
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

fn central_difference(
    sample: &CommonSample<'_>,
    factor: usize,
    columns: &[usize],
    parameter: Parameter,
    progress: &Progress,
) -> Result<Option<CentralDifference>> {
    let study = sample.study();
    let Some(&first) = columns.first() else { return Ok(None) };
    let law = study.inputs[first].marginal.law();
    let step = STEP * if parameter == Parameter::Mean { law.sd() } else { law.spread() };
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

/// Why a law's score does not give the derivative, if so.
fn without_score(study: &Study, columns: &[usize]) -> Option<String> {
    if !study.joint.is_independent() {
        return Some(
            "the inputs are correlated: see the difference by common random numbers".into(),
        );
    }
    let ended = |&j: &usize| {
        let law = study.inputs[j].marginal.law();
        !matches!(law, Law::Normal { .. } | Law::Lognormal { .. } | Law::Gumbel { .. })
    };
    columns.iter().any(ended).then(|| {
        "the law has an end of its own that moves with its parameter, which a score cannot see"
            .into()
    })
}

/// The score sums of every factor over all samples of the run, whose draws are computed again.
fn scores(study: &Study, record: &Record, factors: &[Factor]) -> Result<Vec<FactorScores>> {
    let sampler = sampler(study)?;
    let samples = record.counts().samples();
    let events: Vec<Event> =
        (0..study.limits.len()).map(Event::Limit).chain([Event::Any]).collect();
    let parameters = [Parameter::Spread, Parameter::Mean];
    let reasons: Vec<Option<String>> =
        factors.iter().map(|factor| without_score(study, &factor.columns)).collect();
    let pieces: Vec<u64> = (0..samples).step_by(PIECE as usize).collect();
    let sums = in_parallel(&pieces, |&first| -> Result<Vec<ScoreSums>> {
        let rows = (samples - first).min(PIECE) as usize;
        let mut uniforms = Columns::new(rows, study.inputs.len());
        sampler.fill(first, &mut uniforms)?;
        let mut inputs = Columns::default();
        study.joint.from_uniform(&uniforms, &mut inputs);
        let breaches = Breaches::from_margins(study.limits.len(), rows, |i, k| {
            record.margins(i)[first as usize + k]
        });
        let mut sums = vec![ScoreSums::default(); factors.len() * 2 * events.len()];
        let mut places = sums.chunks_mut(events.len());
        for (factor, reason) in factors.iter().zip(&reasons) {
            for parameter in parameters {
                let Some(place) = places.next() else { continue };
                if reason.is_some() {
                    continue;
                }
                let scales: Vec<Scorer> = factor
                    .columns
                    .iter()
                    .map(|&j| Scorer::new(&study.inputs[j].marginal, parameter))
                    .collect();
                for k in 0..rows {
                    // A common parameter of independent inputs: the scores add up.
                    let members = factor.columns.iter().zip(&scales);
                    let score = members.map(|(&j, s)| s.score(inputs.get(k, j))).sum();
                    for (sum, &event) in place.iter_mut().zip(&events) {
                        sum.push(breaches.happened(event, k), score);
                    }
                }
            }
        }
        Ok(sums)
    });
    let mut total = vec![ScoreSums::default(); factors.len() * 2 * events.len()];
    for piece in sums {
        total.iter_mut().zip(&piece?).for_each(|(total, piece)| total.add(piece));
    }
    let mut places = total.chunks(events.len());
    let mut found = Vec::with_capacity(2 * factors.len());
    for (factor, reason) in reasons.iter().enumerate() {
        for parameter in parameters {
            let sums = places.next().unwrap_or_default().to_vec();
            let sums = reason.clone().map_or(Ok(sums), Err);
            found.push(FactorScores { factor, parameter, sums });
        }
    }
    Ok(found)
}

/// The score of a marginal as a polynomial of its standardised value, where it is one; the truncation's
/// share is found once instead of at every sample.
enum Scorer<'a> {
    /// Score at two values tells a straight line in z, at three a parabola.
    Parabola {
        marginal: &'a Marginal,
        a: f64,
        b: f64,
        c: f64,
    },
    Direct(&'a Marginal, Parameter),
}

impl<'a> Scorer<'a> {
    fn new(marginal: &'a Marginal, parameter: Parameter) -> Self {
        let direct = |x: f64| match parameter {
            Parameter::Mean => marginal.score_mean(x),
            Parameter::Spread => marginal.score_spread(x),
        };
        let at = |z: f64| -> f64 {
            match *marginal.law() {
                Law::Lognormal { log_mean, log_sd } => {
                    direct(crate::numerics::elementary::exp(log_mean + log_sd * z))
                }
                _ => direct(marginal.law().mean() + marginal.law().sd() * z),
            }
        };
        match marginal.law() {
            Law::Normal { .. } | Law::Lognormal { .. } => {
                let (low, mid, high) = (at(-1.0), at(0.0), at(1.0));
                let a = 0.5 * (low + high) - mid;
                Scorer::Parabola { marginal, a, b: 0.5 * (high - low), c: mid }
            }
            _ => Scorer::Direct(marginal, parameter),
        }
    }

    fn score(&self, x: f64) -> f64 {
        match self {
            Scorer::Parabola { marginal, a, b, c } => {
                let z = match *marginal.law() {
                    Law::Lognormal { log_mean, log_sd } => {
                        (crate::numerics::elementary::ln(x) - log_mean) / log_sd
                    }
                    ref law => (x - law.mean()) / law.sd(),
                };
                (a * z + b) * z + c
            }
            Scorer::Direct(marginal, Parameter::Mean) => marginal.score_mean(x),
            Scorer::Direct(marginal, Parameter::Spread) => marginal.score_spread(x),
        }
    }
}
