//! Descents as a limit state: what the reliability methods see of them.

use super::{Ensemble, Progress};
use crate::descent::{Fault, Outcome};
use crate::error::Result;
use crate::numerics::columns::Columns;
use crate::reliability::limit_state::LimitState;
use crate::study::{Limit, Study};

/// The limits of a study as functions of standard-normal points; a faulted descent is NaN.
#[derive(Debug)]
pub struct DescentLimitState<'a> {
    ensemble: Ensemble<'a>,
    limits: &'a [Limit],
    progress: &'a Progress,
}

impl<'a> DescentLimitState<'a> {
    /// The limit state of a study; descents are counted on `progress`.
    pub fn new(study: &'a Study, progress: &'a Progress) -> Self {
        DescentLimitState { ensemble: Ensemble::new(study), limits: &study.limits, progress }
    }

    /// The inputs (SI) at a standard-normal point.
    pub fn draw(&self, point: &[f64]) -> Vec<f64> {
        self.ensemble.draw(point)
    }

    /// The descent at a standard-normal point.
    ///
    /// # Errors
    /// The fault of that descent.
    pub fn flight(&self, point: &[f64]) -> std::result::Result<Outcome, Fault> {
        self.ensemble.at_standard_normal(&Columns::from_rows(&[point]), self.progress).result(0)
    }
}

impl LimitState for DescentLimitState<'_> {
    fn dimension(&self) -> usize {
        self.ensemble.dimension()
    }

    fn limits(&self) -> usize {
        self.limits.len()
    }

    fn margins(&self, z: &Columns, margins: &mut Columns) -> Result<()> {
        let table = self.ensemble.at_standard_normal(z, self.progress);
        for (i, limit) in self.limits.iter().enumerate() {
            let outcomes = table.outcome(limit.outcome);
            for (margin, &outcome) in margins.column_mut(i).iter_mut().zip(outcomes) {
                *margin = limit.margin_of(outcome);
            }
        }
        Ok(())
    }
}
