//! Samples of the run once more, as the estimators that reuse a sample read them.
//!
//! A sample is a function of its index, so its draw and its outcomes are computed again instead of kept. How
//! many are read is fixed before the run: it does not depend on where an adaptive run stopped.

use super::analysis::{Absent, Analysis, Found, Run};
use super::common_numbers::{Breaches, CommonSample, Event};
use super::{Ensemble, Progress, Record, factors, in_parallel};
use crate::error::Result;
use crate::numerics::columns::Columns;
use crate::sensitivity::pick_freeze::Factor;
use crate::study::Study;

/// The first samples of the run that are read, at most.
pub const ROWS: u64 = 20_000;
/// Breaching samples of one event that are read, at most: the first of the run.
const BREACHING: usize = 5_000;
/// Fewer breaches among the first rows than this, and later ones of the run are read too.
const ENOUGH: usize = 1_000;

/// The first samples of a run, and those that breach.
#[derive(Debug, Clone)]
pub struct GivenSample {
    /// Every input, then every group of several as one.
    pub factors: Vec<Factor>,
    /// Normal score of every factor, one column each; of a group that of its members' sum.
    pub scores: Vec<Vec<f64>>,
    /// Values of the inputs, SI, one column each.
    pub values: Vec<Vec<f64>>,
    /// Outcomes in the order of [`crate::descent::OutcomeQuantity::ALL`]; NaN where faulted.
    pub outcomes: Columns,
    /// Breaches of the rows.
    pub breaches: Breaches,
    /// One a limit, then one of any limit.
    pub breaching: Vec<Breaching>,
    /// Independently randomised replicates to which the rows belong in turn; 1 if every row is independent.
    pub replicates: usize,
}

/// Samples that breach.
#[derive(Debug, Clone)]
pub struct Breaching {
    /// Normal score of every factor.
    pub scores: Vec<Vec<f64>>,
    /// By how much the limit is missed, as a share of it; of any limit the largest share.
    pub excess: Vec<f64>,
    /// Samples of the run that were looked through.
    pub among: u64,
}

impl Analysis<'_> for GivenSample {
    const NAME: &'static str = "samples once more";

    fn cost(study: &Study) -> Found<u64> {
        Absent::unless_asked("sensitivity.base_samples", study.sensitivity.base_samples)?;
        Ok(ROWS.min(study.sampling.samples))
    }

    fn compute(run: Run<'_>) -> Result<Option<Self>> {
        run_given(run.study, run.record, run.progress).map(Some)
    }
}

fn run_given(study: &Study, record: &Record, progress: &Progress) -> Result<GivenSample> {
    let sample = CommonSample::of_run(study, ROWS)?;
    let table = Ensemble::new(study).at_inputs(sample.inputs(), progress);
    let breaches = Breaches::of(study, &table);
    let factors = inputs_then_groups(study);
    let events = (0..study.limits.len()).map(Event::Limit).chain([Event::Any]);
    let events: Vec<Event> = events.filter(|_| !study.limits.is_empty()).collect();
    let breaching = events.iter().map(|&event| {
        let first: Vec<usize> = (0..sample.rows())
            .filter(|&k| breaches.happened(event, k) == Some(true))
            .take(BREACHING)
            .collect();
        let margin = |i: usize, k: usize| {
            study.limits[i].margin_of(table.outcomes.get(k, study.limits[i].outcome as usize))
        };
        // Where an adaptive run stopped depends on what it saw: its later rows are left alone.
        if first.len() >= ENOUGH || study.sampling.stopping.is_some() {
            let some = CommonSample::of_rows(study, &first)?;
            let excess = first.iter().map(|&k| excess(study, event, |i| margin(i, k))).collect();
            let among = sample.rows() as u64;
            return Ok(Breaching { scores: scores(&some, &factors), excess, among });
        }
        of_run(study, record, event, &factors)
    });
    let breaching = breaching.collect::<Result<_>>()?;
    let inputs = 0..study.inputs.len();
    Ok(GivenSample {
        scores: scores(&sample, &factors),
        values: inputs.map(|j| sample.inputs().column(j).to_vec()).collect(),
        outcomes: table.outcomes,
        breaches,
        breaching,
        replicates: sample.replicates(),
        factors,
    })
}

/// Every input by itself, also of those drawn together, then every group of several as one.
fn inputs_then_groups(study: &Study) -> Vec<Factor> {
    let alone = study.inputs.iter().enumerate();
    let alone = alone.map(|(j, input)| Factor { name: input.target.path(), columns: vec![j] });
    alone.chain(factors(study).into_iter().filter(|factor| factor.columns.len() > 1)).collect()
}

/// The first breaching samples of the whole run.
fn of_run(study: &Study, record: &Record, event: Event, factors: &[Factor]) -> Result<Breaching> {
    let excess = |k: usize| excess(study, event, |i| record.margins(i)[k]);
    let total = record.margins(0).len();
    let rows: Vec<usize> = (0..total).filter(|&k| excess(k) > 0.0).take(BREACHING).collect();
    let sample = CommonSample::of_rows(study, &rows)?;
    let excess = rows.iter().map(|&k| excess(k)).collect();
    Ok(Breaching { scores: scores(&sample, factors), excess, among: total as u64 })
}

/// By how much an event's limit is missed, as a share of it; negative if it is kept. Of any limit the largest.
fn excess(study: &Study, event: Event, margin: impl Fn(usize) -> f64) -> f64 {
    let limits = study.limits.iter().enumerate();
    let wanted = limits.filter(|(i, _)| event == Event::Any || event == Event::Limit(*i));
    let share = wanted.map(|(i, limit)| {
        let size = limit.value.abs();
        -margin(i) / if size > 0.0 { size } else { 1.0 }
    });
    share.fold(f64::NEG_INFINITY, f64::max)
}

/// Normal score of every factor: of a group its members' sum over its standard deviation, which is standard
/// normal as well, since the members' scores are jointly normal.
fn scores(sample: &CommonSample<'_>, factors: &[Factor]) -> Vec<Vec<f64>> {
    let copula = sample.study().joint.copula();
    let correlation = |i: usize, j: usize| match copula {
        Some(copula) => copula.normal_correlation(i, j),
        None => f64::from(u8::from(i == j)),
    };
    in_parallel(factors, |factor| {
        let members = &factor.columns;
        // Inputs drawn together: the place of their row, along which they move together.
        let together = members.first().and_then(|&j| sample.study().joint.sample_of(j));
        if let Some(drawn) = together.filter(|drawn| members.len() > 1 && drawn.inputs() == members)
        {
            return sample.row_scores(drawn);
        }
        let mut sum = vec![0.0; sample.rows()];
        for &j in members {
            let scores = sample.normal_scores(j);
            sum.iter_mut().zip(scores).for_each(|(sum, score)| *sum += score);
        }
        let of = |i: usize| members.iter().map(|&j| correlation(i, j)).sum::<f64>();
        let variance: f64 = members.iter().map(|&i| of(i)).sum();
        if members.len() > 1 && variance > 0.0 {
            let sd = variance.sqrt();
            sum.iter_mut().for_each(|sum| *sum /= sd);
        }
        sum
    })
}
