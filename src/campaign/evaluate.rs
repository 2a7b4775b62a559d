//! From draws to outcomes: the coefficients of each sample, integrated in batches.

use super::Progress;
use crate::descent::{self, Fault, Model, Outcome};
use crate::error::Result;
use crate::numerics::columns::Columns;
use crate::outcomes::OutcomeTable;
use crate::physics::{Coefficients, Design, Target};
use crate::sampling::Sampler;
use crate::study::Study;
use crate::uncertainty::Joint;
use rayon::prelude::*;
use std::ops::Range;

/// Samples that one thread draws and integrates at a time.
const BATCH: u64 = 1024;

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

    /// Samples `range` of a design, in one table, in order; fewer if `progress` is asked to stop.
    ///
    /// # Errors
    /// If the range lies beyond the design.
    pub(super) fn samples(
        &self,
        sampler: &Sampler,
        range: Range<u64>,
        progress: &Progress,
    ) -> Result<OutcomeTable> {
        let starts: Vec<u64> = range.clone().step_by(BATCH as usize).collect();
        let batches: Vec<Option<OutcomeTable>> = starts
            .par_iter()
            .map(|&start| {
                if progress.stopping() {
                    return Ok(None);
                }
                let rows = (range.end - start).min(BATCH) as usize;
                let mut uniforms = Columns::new(rows, self.dimension());
                sampler.fill(start, &mut uniforms)?;
                let mut table = OutcomeTable::new(start, rows, self.dimension());
                self.joint.from_uniform(&uniforms, &mut table.inputs);
                self.integrate(&mut table);
                progress.advance(rows);
                Ok(Some(table))
            })
            .collect::<Result<_>>()?;
        let complete: Vec<OutcomeTable> = batches.into_iter().map_while(|batch| batch).collect();
        Ok(OutcomeTable::joined(range.start, self.dimension(), &complete))
    }

    /// Outcomes at standard-normal points (rows), on every core.
    pub fn at_standard_normal(&self, points: &Columns, progress: &Progress) -> OutcomeTable {
        let mut inputs = Columns::new(points.rows(), self.dimension());
        self.joint.from_standard_normal(points, &mut inputs);
        self.at_inputs(&inputs, progress)
    }

    /// Outcomes at points of the unit cube (rows), on every core.
    pub fn at_uniform(&self, points: &Columns, progress: &Progress) -> OutcomeTable {
        let mut inputs = Columns::new(points.rows(), self.dimension());
        self.joint.from_uniform(points, &mut inputs);
        self.at_inputs(&inputs, progress)
    }

    /// Outcomes of draws (rows, SI), on every core.
    pub fn at_inputs(&self, inputs: &Columns, progress: &Progress) -> OutcomeTable {
        let starts: Vec<usize> = (0..inputs.rows()).step_by(BATCH as usize).collect();
        let batches: Vec<OutcomeTable> = starts
            .par_iter()
            .map(|&start| {
                let rows = (inputs.rows() - start).min(BATCH as usize);
                let mut table = OutcomeTable::new(start as u64, rows, self.dimension());
                for j in 0..self.dimension() {
                    let column = &inputs.column(j)[start..start + rows];
                    table.inputs.column_mut(j).copy_from_slice(column);
                }
                self.integrate(&mut table);
                progress.advance(rows);
                table
            })
            .collect();
        OutcomeTable::joined(0, self.dimension(), &batches)
    }

    /// Integrates the rows of a table from its inputs. An impossible draw is a fault of its row.
    fn integrate(&self, table: &mut OutcomeTable) {
        let mut design = self.design.clone();
        let mut coefficients = Vec::with_capacity(table.rows());
        let mut rows = Vec::with_capacity(table.rows());
        for k in 0..table.rows() {
            for (j, &target) in self.targets.iter().enumerate() {
                design.set(target, table.inputs.get(k, j));
            }
            if design.is_possible() {
                coefficients.push(Coefficients::new(&design));
                rows.push(k);
            } else {
                table.record(k, Err(Fault::ImpossibleInput));
            }
        }
        let mut results = vec![Err(Fault::NotFinite); rows.len()];
        descent::descend_batch(self.model, self.tolerance, &coefficients, &mut results);
        for (k, result) in rows.into_iter().zip(results) {
            table.record(k, result);
        }
    }
}
