//! From draws to outcomes: the coefficients of each sample, integrated in batches.

use super::Progress;
use crate::descent::vector::Draws;
use crate::descent::{self, Fault, Model, Outcome};
use crate::error::Result;
use crate::numerics::columns::Columns;
use crate::outcomes::OutcomeTable;
use crate::physics::{Coefficients, Design, Target};
use crate::sampling::Sampler;
use crate::study::Study;
use crate::uncertainty::Joint;
use rayon::prelude::*;
use std::convert::Infallible;
use std::ops::Range;

/// Samples that one thread draws and integrates at a time.
const BATCH: usize = 1024;

/// The nominal descent of a study, by the plain integrator.
///
/// # Errors
/// The fault of the nominal descent.
pub fn nominal(study: &Study) -> std::result::Result<Outcome, Fault> {
    let coefficients = Coefficients::new(&study.design);
    descent::reference::descend(&coefficients, study.model, descent::reference::REFERENCE_TOLERANCE)
}

/// Everything it takes to compute descents of one study from points.
#[derive(Debug, Clone)]
pub struct Ensemble<'a> {
    design: &'a Design,
    joint: &'a Joint,
    targets: Vec<Target>,
    model: Model,
    tolerance: f64,
    /// Whether a draw of a possible design is possible when each of its values is.
    checks_are_separate: bool,
}

impl<'a> Ensemble<'a> {
    /// The ensemble of a study.
    pub fn new(study: &'a Study) -> Self {
        Ensemble {
            design: &study.design,
            joint: &study.joint,
            targets: study.inputs.iter().map(|input| input.target).collect(),
            model: study.model,
            tolerance: study.numerics.tolerance,
            checks_are_separate: study.design.is_possible()
                && study.inputs.iter().all(|input| input.target.is_checked_alone()),
        }
    }

    /// Number of uncertain inputs.
    pub fn dimension(&self) -> usize {
        self.targets.len()
    }

    /// The draw (SI values of the inputs) at a standard-normal point.
    pub fn draw(&self, point: &[f64]) -> Vec<f64> {
        let mut inputs = Columns::new(1, self.dimension());
        self.joint.from_standard_normal(&Columns::from_rows(&[point]), &mut inputs);
        inputs.row(0)
    }

    /// The design of one draw (SI values of the inputs, in their order).
    pub fn design_of(&self, draw: &[f64]) -> Design {
        let mut design = self.design.clone();
        for (&target, &value) in self.targets.iter().zip(draw) {
            design.set(target, value);
        }
        design
    }

    /// Samples `range` of a design, in consecutive tables; fewer if `progress` is asked to stop.
    ///
    /// # Errors
    /// If the range lies beyond the design.
    pub(super) fn samples(
        &self,
        sampler: &Sampler,
        range: Range<u64>,
        progress: &Progress,
    ) -> Result<Vec<OutcomeTable>> {
        let rows = (range.end - range.start) as usize;
        let work = Work { first: range.start, rows, keep_inputs: true, may_stop: true };
        self.batches(&work, progress, |start, scratch, inputs| {
            scratch.reshape(inputs.rows(), self.dimension());
            sampler.fill(range.start + start as u64, scratch)?;
            self.joint.from_uniform(scratch, inputs);
            Ok(())
        })
    }

    /// Outcomes at standard-normal points (rows), on every core; the table holds no inputs.
    pub fn at_standard_normal(&self, points: &Columns, progress: &Progress) -> OutcomeTable {
        self.certain(&Work::outcomes(points.rows()), progress, |start, inputs| {
            self.joint.from_standard_normal(&points.rows_from(start, inputs.rows()), inputs);
        })
    }

    /// Draws and outcomes at points of the unit cube (rows), on every core.
    pub fn at_uniform(&self, points: &Columns, progress: &Progress) -> OutcomeTable {
        let work = Work { keep_inputs: true, ..Work::outcomes(points.rows()) };
        self.certain(&work, progress, |start, inputs| {
            self.joint.from_uniform(&points.rows_from(start, inputs.rows()), inputs);
        })
    }

    /// Outcomes of draws (rows, SI), on every core; the table holds no inputs.
    pub fn at_inputs(&self, draws: &Columns, progress: &Progress) -> OutcomeTable {
        self.certain(&Work::outcomes(draws.rows()), progress, |start, inputs| {
            *inputs = draws.rows_from(start, inputs.rows());
        })
    }

    /// [`Self::batches`] of draws that cannot fail.
    fn certain(
        &self,
        work: &Work,
        progress: &Progress,
        fill: impl Fn(usize, &mut Columns) + Sync,
    ) -> OutcomeTable {
        let filled = self.batches(
            work,
            progress,
            |start, _, inputs| -> std::result::Result<(), Infallible> {
                fill(start, inputs);
                Ok(())
            },
        );
        let inputs = if work.keep_inputs { self.dimension() } else { 0 };
        match filled {
            Ok(parts) => OutcomeTable::joined(work.first, inputs, &parts),
            Err(never) => match never {},
        }
    }

    /// Computes rows in batches, whose draws `fill` writes into its last argument for the rows from its first
    /// on; the table between is its to use.
    fn batches<E: Send>(
        &self,
        work: &Work,
        progress: &Progress,
        fill: impl Fn(usize, &mut Columns, &mut Columns) -> std::result::Result<(), E> + Sync,
    ) -> std::result::Result<Vec<OutcomeTable>, E> {
        let starts: Vec<usize> = (0..work.rows).step_by(BATCH).collect();
        let batches: Vec<Option<OutcomeTable>> = starts
            .par_iter()
            .map_init(Scratch::default, |scratch, &start| {
                if work.may_stop && progress.stopping() {
                    return Ok(None);
                }
                let rows = (work.rows - start).min(BATCH);
                let mut table =
                    OutcomeTable::new(work.first + start as u64, rows, self.dimension());
                fill(start, &mut scratch.uniforms, &mut table.inputs)?;
                self.integrate(&mut table, scratch);
                progress.advance(rows);
                if !work.keep_inputs {
                    table.inputs = Columns::new(rows, 0);
                }
                Ok(Some(table))
            })
            .collect::<std::result::Result<_, E>>()?;
        Ok(batches.into_iter().map_while(|batch| batch).collect())
    }

    /// Integrates the rows of a table from its inputs. An impossible draw is a fault of its row.
    fn integrate(&self, table: &mut OutcomeTable, scratch: &mut Scratch) {
        let Scratch { possible, results, .. } = scratch;
        possible.clear();
        possible.resize(table.rows(), true);
        if self.checks_are_separate {
            for (j, target) in self.targets.iter().enumerate() {
                let info = target.parameter.info();
                for (possible, &value) in possible.iter_mut().zip(table.inputs.column(j)) {
                    *possible &= info.admits(value);
                }
            }
        } else {
            let mut design = self.design.clone();
            for (k, possible) in possible.iter_mut().enumerate() {
                for (j, &target) in self.targets.iter().enumerate() {
                    design.set(target, table.inputs.get(k, j));
                }
                *possible = design.is_possible();
            }
        }
        results.clear();
        results.resize(table.rows(), Err(Fault::NotFinite));
        let draws =
            Draws { design: self.design, targets: &self.targets, inputs: &table.inputs, possible };
        descent::descend_draws(self.model, self.tolerance, draws, results);
        for (k, &result) in results.iter().enumerate() {
            table.record(k, result);
        }
    }
}

/// What a thread uses again for its next batch.
#[derive(Default)]
struct Scratch {
    uniforms: Columns,
    possible: Vec<bool>,
    results: Vec<std::result::Result<Outcome, Fault>>,
}

/// Rows to compute.
struct Work {
    /// Index of the first.
    first: u64,
    /// How many.
    rows: usize,
    /// Whether the table is to hold the draws.
    keep_inputs: bool,
    /// Whether to end early when asked to.
    may_stop: bool,
}

impl Work {
    /// All of `rows`, for their outcomes.
    fn outcomes(rows: usize) -> Self {
        Work { first: 0, rows, keep_inputs: false, may_stop: false }
    }
}
