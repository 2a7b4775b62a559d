//! The walks of the Shapley effects of a study, evaluated.

use super::analysis::{Absent, Analysis, Found, Run};
use super::trade::trade_factors;
use super::{Ensemble, Progress};
use crate::error::Result;
use crate::numerics::columns::Columns;
use crate::numerics::special::normal;
use crate::sampling::{Design, Sampler};
use crate::sensitivity::pick_freeze::Factor;
use crate::sensitivity::shapley::Walks;
use crate::streams::Purpose;
use crate::study::Study;

/// Walks computed at a time.
const BATCH: usize = 2048;

/// Outcomes along the walks.
#[derive(Debug)]
pub struct ShapleyOutcomes {
    /// The factors.
    pub factors: Vec<Factor>,
    /// The walks.
    pub walks: Walks,
    /// Outcomes at their points, walk after walk × [`crate::descent::OutcomeQuantity::ALL`]; NaN where faulted.
    pub outcomes: Columns,
}

impl Analysis<'_> for ShapleyOutcomes {
    const NAME: &'static str = "Shapley effects";

    fn cost(study: &Study) -> Found<u64> {
        let orders = study.sensitivity.base_samples;
        Absent::unless_asked("sensitivity.base_samples", orders)?;
        Ok(orders * (trade_factors(study).len() as u64 + 1))
    }

    fn compute(run: Run<'_>) -> Result<Option<Self>> {
        run_shapley(run.study, run.progress)
    }
}

/// Evaluates the walks of a study, one for each row of its pick-freeze design. `None` if `progress` asks for a stop.
fn run_shapley(study: &Study, progress: &Progress) -> Result<Option<ShapleyOutcomes>> {
    let orders = study.sensitivity.base_samples as usize;
    let factors = trade_factors(study);
    let dimension = study.inputs.len();
    let correlation: Option<Vec<Vec<f64>>> = study.joint.copula().map(|copula| {
        let row = |i| (0..dimension).map(|j| copula.normal_correlation(i, j)).collect();
        (0..dimension).map(row).collect()
    });
    let columns = factors.iter().map(|factor| factor.columns.clone()).collect();
    let seed = study.sampling.seed;
    let walks = Walks::new(columns, correlation.as_deref(), orders, seed)?;
    let sampler =
        Sampler::new(Design::MonteCarlo, 2 * dimension, orders as u64, 1, seed, Purpose::Shapley)?;
    let ensemble = Ensemble::new(study);
    let points = walks.points_a_walk();
    let mut outcomes = Columns::new(orders * points, crate::descent::OutcomeQuantity::ALL.len());
    for first in (0..orders).step_by(BATCH) {
        if progress.stopping() {
            return Ok(None);
        }
        let rows = (orders - first).min(BATCH);
        let mut uniforms = Columns::new(rows, 2 * dimension);
        sampler.fill(first as u64, &mut uniforms)?;
        let mut ends = Columns::new(rows, 2 * dimension);
        for j in 0..2 * dimension {
            normal::quantile_column(uniforms.column(j), ends.column_mut(j));
        }
        let table = ensemble.at_standard_normal(&walks.points(first, &ends)?, progress);
        for j in 0..outcomes.columns() {
            let into = &mut outcomes.column_mut(j)[first * points..(first + rows) * points];
            into.copy_from_slice(table.outcomes.column(j));
        }
    }
    Ok(Some(ShapleyOutcomes { factors, walks, outcomes }))
}
