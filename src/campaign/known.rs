//! What a measurement can settle: the probability of a breach given what is known at build and on the
//! day, and given a measured value.

use super::Progress;
use super::common_numbers::{Breaches, Change, CommonSample, Event};
use crate::error::Result;
use crate::numerics::columns::Columns;
use crate::streams::Purpose;
use crate::study::{Known, Study};
use crate::uncertainty::Law;

/// Settings of a measured value in a chart.
const SETTINGS: usize = 21;
/// Continuations of each set of known values.
pub const INNER: usize = 64;
/// Sets of known values for each sample of the trade.
const OUTER_SHARE: f64 = 1.0 / 20.0;

/// The conditional probability of a breach given what is known by some time.
#[derive(Debug, Clone)]
pub struct Stage {
    /// The time.
    pub known: Known,
    /// Number of inputs known by then.
    pub inputs: usize,
    /// Breaches among the continuations of each set of known values: count, and those not known.
    pub breaches: Vec<(u64, u64)>,
}

/// P(breach) against a measured value, everything else uncertain.
#[derive(Debug, Clone)]
pub struct Chart {
    /// The input.
    pub input: usize,
    /// Measured values, SI, ascending, with the breaches given each.
    pub settings: Vec<(f64, Breaches)>,
}

/// P(breach) against two measured values, everything else uncertain.
#[derive(Debug, Clone)]
pub struct Map {
    /// The inputs.
    pub inputs: (usize, usize),
    /// Values of the first, SI, ascending.
    pub first: Vec<f64>,
    /// Values of the second, SI, ascending.
    pub second: Vec<f64>,
    /// Breaches given both, row by row of the first.
    pub breaches: Vec<Breaches>,
}

/// What is known when.
#[derive(Debug, Clone)]
pub struct KnownOutcomes {
    /// Given what is known at build, then at build and on the day, where that is something and not all.
    pub stages: Vec<Stage>,
    /// One chart for every input that is measured on the day.
    pub charts: Vec<Chart>,
    /// The first two inputs that are measured on the day, together.
    pub map: Option<Map>,
    /// Samples behind each setting of a chart.
    pub samples: u64,
}

/// Descents that this takes, about.
pub fn known_descents(study: &Study) -> u64 {
    let rows = study.trade.samples.min(study.sampling.samples);
    let days = measured(study).len() as u64;
    let maps = if days > 1 { 121 } else { 0 };
    2 * outer(rows) * INNER as u64 + (days * SETTINGS as u64 + maps) * rows
}

fn outer(rows: u64) -> u64 {
    ((rows as f64 * OUTER_SHARE) as u64).max(50)
}

fn measured(study: &Study) -> Vec<usize> {
    // Rows of a joint sample say nothing of the others' laws at a value that no row has.
    let on_the_day =
        |&j: &usize| study.inputs[j].known == Known::OnTheDay && study.joint.sample_of(j).is_none();
    (0..study.inputs.len()).filter(on_the_day).collect()
}

/// Computes what is known when, with no more effort than the `available` samples of the run deserve. `None` if the study asks for no trade, has no limit, or `progress` asks
/// for a stop.
///
/// # Errors
/// If the inputs' dependence cannot be conditioned.
pub fn run_known(
    study: &Study,
    available: u64,
    progress: &Progress,
) -> Result<Option<KnownOutcomes>> {
    let rows = study.trade.samples.min(available);
    if rows == 0 || study.limits.is_empty() {
        return Ok(None);
    }
    let mut stages = Vec::new();
    for known in [Known::AtBuild, Known::OnTheDay] {
        let given: Vec<usize> =
            (0..study.inputs.len()).filter(|&j| study.inputs[j].known <= known).collect();
        let news = study.inputs.iter().any(|input| input.known == known);
        if news && given.len() < study.inputs.len() {
            stages.push(stage(study, known, &given, outer(rows), progress)?);
        }
        if progress.stopping() {
            return Ok(None);
        }
    }
    let sample = CommonSample::independent(study, 0..rows, Purpose::Known)?;
    let mut charts = Vec::new();
    for input in measured(study) {
        let mut settings = Vec::with_capacity(SETTINGS);
        for value in values(study, input) {
            let change = Change { known: vec![(input, value)], ..Change::default() };
            settings.push((value, sample.changed(&change, progress)?));
        }
        charts.push(Chart { input, settings });
        if progress.stopping() {
            return Ok(None);
        }
    }
    let map = match measured(study)[..] {
        [first, second, ..] => Some(map(study, first, second, &sample, progress)?),
        _ => None,
    };
    Ok(Some(KnownOutcomes { stages, charts, map, samples: rows }))
}

/// Values between the law's stated or own ends; where it has none, over all but a thousandth at either end.
fn values(study: &Study, input: usize) -> Vec<f64> {
    let marginal = &study.inputs[input].marginal;
    let law = marginal.law();
    let bounded = matches!(law, Law::Uniform { .. } | Law::Triangular { .. } | Law::Beta { .. });
    let own = bounded.then(|| law.support());
    let from = marginal.lower().or(own.map(|ends| ends.0));
    let to = marginal.upper().or(own.map(|ends| ends.1));
    let from = from.unwrap_or_else(|| marginal.quantile_lower(1e-3));
    let to = to.unwrap_or_else(|| marginal.quantile_upper(1e-3));
    // Of a dependent input just inside the ends, where the others' laws given it still exist.
    let inside = if study.joint.is_independent() { 0.0 } else { 1e-9 * (to - from) };
    let at = |k: usize| from + (to - from) * k as f64 / (SETTINGS - 1) as f64;
    (0..SETTINGS).map(|k| at(k).clamp(from + inside, to - inside)).collect()
}

fn map(
    study: &Study,
    first: usize,
    second: usize,
    sample: &CommonSample<'_>,
    progress: &Progress,
) -> Result<Map> {
    // Every other setting of the charts.
    let coarse = |input| values(study, input).into_iter().step_by(2).collect::<Vec<f64>>();
    let (rows, columns) = (coarse(first), coarse(second));
    let mut breaches = Vec::with_capacity(rows.len() * columns.len());
    for &a in &rows {
        for &b in &columns {
            let known = vec![(first, a), (second, b)];
            let change = Change { known, ..Change::default() };
            breaches.push(sample.changed(&change, progress)?);
        }
    }
    Ok(Map { inputs: (first, second), first: rows, second: columns, breaches })
}

fn stage(
    study: &Study,
    known: Known,
    given: &[usize],
    outer: u64,
    progress: &Progress,
) -> Result<Stage> {
    let sets = CommonSample::independent(study, 0..outer, Purpose::Known)?;
    // Continuations from another part of the stream than the sets, and for each stage the same.
    let rows = outer * INNER as u64;
    let continuations = CommonSample::independent(study, outer..outer + rows, Purpose::Known)?;
    let draws: Columns = sets.mixed(given, |k| k / INNER, &continuations)?;
    let found = sets.at(&draws, progress);
    let breaches = (0..outer as usize)
        .map(|set| {
            let counts = found.counts(Event::Any, set * INNER..(set + 1) * INNER);
            (counts.breaches, counts.faults)
        })
        .collect();
    Ok(Stage { known, inputs: given.len(), breaches })
}
