//! What a measurement can settle: the probability of a breach given what is known at build and on the
//! day, and given a measured value.

use super::Progress;
use super::analysis::{Absent, Analysis, Found, Run};
use super::common_numbers::{Breaches, Change, CommonSample, Event};
use crate::error::Result;
use crate::numerics::columns::Columns;
use crate::physics::{Parameter, Target};
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

/// The second of two measured values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Second {
    /// An input that is measured on the day.
    Input(usize),
    /// A design value that is measured in the lot: the nominal viscosity of the fluid that is filled in.
    Lot(Target),
}

/// P(breach) against two measured values, everything else uncertain.
#[derive(Debug, Clone)]
pub struct Map {
    /// The input measured first.
    pub input: usize,
    /// What is measured besides.
    pub beside: Second,
    /// Values of the first, SI, ascending.
    pub first: Vec<f64>,
    /// Values of the second, SI, ascending.
    pub second: Vec<f64>,
    /// Samples behind each cell.
    pub samples: u64,
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
    /// The first input that is measured on the day with the second, or with the viscosity of the lot.
    pub map: Option<Map>,
    /// Samples behind each setting of a chart.
    pub samples: u64,
}

impl Analysis<'_> for KnownOutcomes {
    const NAME: &'static str = "what becomes known when";

    fn cost(study: &Study) -> Found<u64> {
        Absent::unless_asked("trade.samples", study.trade.samples)?;
        Absent::unless_limited(study)?;
        let rows = study.trade.samples.min(study.sampling.samples);
        let days = measured(study).len() as u64;
        let columns = match (days, lot(study)) {
            (0, _) | (1, None) => 0,
            (1, Some(_)) => SETTINGS,
            _ => COARSE,
        };
        let maps = (COARSE * columns) as u64 * map_rows(rows);
        Ok(2 * outer(rows) * INNER as u64 + days * SETTINGS as u64 * rows + maps)
    }

    fn compute(run: Run<'_>) -> Result<Option<Self>> {
        run_known(run.study, run.progress)
    }
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

/// Computes what is known when, on no more samples than the study has at most, wherever it stopped. `None` if
/// `progress` asks for a stop.
///
/// # Errors
/// If the inputs' dependence cannot be conditioned.
pub fn run_known(study: &Study, progress: &Progress) -> Result<Option<KnownOutcomes>> {
    let rows = study.trade.samples.min(study.sampling.samples);
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
    let map = match (&measured(study)[..], lot(study)) {
        ([first, second, ..], _) => Some((*first, Second::Input(*second))),
        ([first], Some(lot)) => Some((*first, Second::Lot(lot))),
        _ => None,
    };
    let map =
        map.map(|(first, beside)| map_of(study, first, beside, rows, progress)).transpose()?;
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

/// The viscosity of the lot, if it is a design value: then a lot has one that can be measured.
fn lot(study: &Study) -> Option<Target> {
    let target = Target::whole(Parameter::FluidNominalViscosity);
    let uncertain = study.inputs.iter().any(|input| input.target == target);
    (!uncertain).then_some(target)
}

/// Values of a lot: the range over which the design value may move.
fn lot_values(study: &Study, target: Target) -> Vec<f64> {
    let stated = study.tighten.design.iter().find(|range| range.target == target);
    let nominal = study.design.at(target);
    let (from, to) = stated.map_or((0.6 * nominal, 1.4 * nominal), |r| (r.lower, r.upper));
    let last = (SETTINGS - 1) as f64;
    (0..SETTINGS).map(|k| from + (to - from) * (k as f64 / last)).collect()
}

/// The lot's viscosity is measured: its law has nothing left to say. A lot whose law is the rows of a calibration is the
/// lot that was calibrated: another one keeps its factor.
fn as_measured(study: &Study, target: Target, value: f64, change: &mut Change) {
    let is_lot = |&j: &usize| study.inputs[j].target.parameter == Parameter::FluidLotFactor;
    let lot = (0..study.inputs.len()).find(is_lot).filter(|&j| study.joint.sample_of(j).is_none());
    let factor = lot.map(|j| (j, study.inputs[j].marginal.median()));
    change.design.push((target, factor.map_or(value, |(_, factor)| value / factor)));
    change.known.extend(factor);
}

/// Values of a measured input in a map: every other setting of its chart.
const COARSE: usize = SETTINGS / 2 + 1;

/// Samples of a cell: a map has many, and says of each only whether to go.
fn map_rows(rows: u64) -> u64 {
    (rows / 5).max(rows.min(1000))
}

fn map_of(
    study: &Study,
    input: usize,
    beside: Second,
    rows: u64,
    progress: &Progress,
) -> Result<Map> {
    let samples = map_rows(rows);
    // The first of the charts' points.
    let sample = CommonSample::independent(study, 0..samples, Purpose::Known)?;
    let coarse = |input| values(study, input).into_iter().step_by(2).collect::<Vec<f64>>();
    let first = coarse(input);
    let second = match beside {
        Second::Input(other) => coarse(other),
        Second::Lot(target) => lot_values(study, target),
    };
    let mut breaches = Vec::with_capacity(first.len() * second.len());
    for &a in &first {
        for &b in &second {
            let mut change = Change { known: vec![(input, a)], ..Change::default() };
            match beside {
                Second::Input(other) => change.known.push((other, b)),
                Second::Lot(target) => as_measured(study, target, b, &mut change),
            }
            breaches.push(sample.changed(&change, progress)?);
        }
    }
    Ok(Map { input, beside, first, second, samples, breaches })
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
    let found = sets.breaches_at(&draws, progress);
    let breaches = (0..outer as usize)
        .map(|set| {
            let counts = found.counts(Event::Any, set * INNER..(set + 1) * INNER);
            (counts.breaches, counts.faults)
        })
        .collect();
    Ok(Stage { known, inputs: given.len(), breaches })
}
