//! The pick-freeze design of a study, evaluated: outcomes of every block.

use super::analysis::{Absent, Analysis, Found, Run};
use super::{Ensemble, Progress};
use crate::descent::OutcomeQuantity;
use crate::error::Result;
use crate::numerics::columns::Columns;
use crate::sampling::{Design, Sampler};
use crate::sensitivity::pick_freeze::{Factor, Plan};
use crate::streams::Purpose;
use crate::study::Study;
use std::collections::BTreeMap;

/// Outcomes of every block of a pick-freeze design.
#[derive(Debug, Clone)]
pub struct PickFreezeOutcomes {
    /// The design.
    pub plan: Plan,
    /// One table a block: rows of the design × [`OutcomeQuantity::ALL`], NaN where faulted.
    pub blocks: Vec<Columns>,
    /// Descents that could not be computed, over all blocks.
    pub faults: u64,
}

impl PickFreezeOutcomes {
    /// One outcome quantity in every block, through `read`, which is given a row's outcomes.
    pub fn map(&self, read: impl Fn(&dyn Fn(OutcomeQuantity) -> f64) -> f64) -> Vec<Vec<f64>> {
        self.blocks
            .iter()
            .map(|block| {
                (0..block.rows())
                    .map(|k| read(&|quantity: OutcomeQuantity| block.get(k, quantity as usize)))
                    .collect()
            })
            .collect()
    }
}

/// The factors of a study: every input by itself, then every group of several as one. Inputs that are drawn
/// together are one factor and none by themselves.
pub fn factors(study: &Study) -> Vec<Factor> {
    let single = study
        .inputs
        .iter()
        .enumerate()
        .filter(|(k, _)| study.joint.sample_of(*k).is_none_or(|sample| sample.inputs().len() == 1))
        .map(|(k, input)| Factor { name: input.target.path(), columns: vec![k] });
    let mut groups: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (k, input) in study.inputs.iter().enumerate() {
        if let Some(group) = &input.group {
            groups.entry(group).or_default().push(k);
        }
    }
    let groups = groups.into_iter().filter(|(_, columns)| columns.len() > 1);
    let grouped = groups.map(|(name, columns)| Factor { name: name.to_owned(), columns });
    single.chain(grouped).collect()
}

impl Analysis<'_> for PickFreezeOutcomes {
    const NAME: &'static str = "sensitivity";

    /// Sobol' indices of inputs that are correlated have no meaning.
    fn cost(study: &Study) -> Found<u64> {
        let rows = study.sensitivity.base_samples;
        Absent::unless_asked("sensitivity.base_samples", rows)?;
        if !study.joint.is_independent() {
            return Err(Absent::Correlated);
        }
        let (factors, pairs) = (factors(study).len(), study.sensitivity.pairs.len());
        Ok(rows * (2 + factors + pairs) as u64)
    }

    fn compute(run: Run<'_>) -> Result<Option<Self>> {
        run_pick_freeze(run.study, run.progress)
    }
}

fn run_pick_freeze(study: &Study, progress: &Progress) -> Result<Option<PickFreezeOutcomes>> {
    let rows = study.sensitivity.base_samples;
    let inputs = study.inputs.len();
    let plan = Plan::new(rows as usize, inputs, factors(study))?;
    let place = |name: &String| plan.factors().iter().rposition(|factor| factor.name == *name);
    let pairs = study.sensitivity.pairs.iter();
    let pairs: Vec<(usize, usize)> =
        pairs.filter_map(|(one, other)| Some((place(one)?, place(other)?))).collect();
    let plan = plan.with_pairs(&pairs)?;
    let seed = study.sampling.seed;
    let columns = plan.base_columns();
    let sampler = Sampler::new(Design::MonteCarlo, columns, rows, 1, seed, Purpose::PickFreeze)?;
    let mut base = Columns::new(rows as usize, columns);
    sampler.fill(0, &mut base)?;
    let ensemble = Ensemble::new(study);
    let mut points = Columns::new(0, 0);
    let mut blocks = Vec::with_capacity(plan.blocks());
    let mut faults = 0;
    for block in 0..plan.blocks() {
        if progress.stopping() {
            return Ok(None);
        }
        plan.fill_block(block, &base, &mut points)?;
        let table = ensemble.at_uniform(&points, progress);
        faults += table.faults.iter().flatten().count() as u64;
        blocks.push(table.outcomes);
    }
    Ok(Some(PickFreezeOutcomes { plan, blocks, faults }))
}
