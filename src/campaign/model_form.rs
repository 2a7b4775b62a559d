//! The same samples by the other thermal model: what the form of the model is worth.

use super::analysis::{Absent, Analysis, Found, Run};
use super::breaches::Breaches;
use super::common_numbers::CommonSample;
use super::nominal;
use crate::descent::{Fault, Model, Outcome};
use crate::error::Result;
use crate::study::Study;

/// Samples of either form at most: tens of thousands of detailed descents a second and core.
const SAMPLES: u64 = 10_000;
/// Accuracy asked of the other form: probabilities of so many samples need no more.
const TOLERANCE: f64 = 1e-4;

/// One form of the model.
#[derive(Debug, Clone)]
pub struct Form {
    /// The model.
    pub model: Model,
    /// Its nominal descent.
    pub nominal: std::result::Result<Outcome, Fault>,
    /// What its samples breach.
    pub breaches: Breaches,
}

/// A study's samples by its own model and by the one that treats heat the other way.
#[derive(Debug, Clone)]
pub struct ModelFormOutcomes {
    /// Independently randomised replicates to which the rows belong in turn; 1 if every row is independent.
    pub replicates: usize,
    /// The study's own form, then the other one.
    pub forms: [Form; 2],
}

impl Analysis<'_> for ModelFormOutcomes {
    const NAME: &'static str = "model form";

    fn cost(study: &Study) -> Found<u64> {
        Absent::unless_limited(study)?;
        Ok(2 * SAMPLES.min(study.sampling.samples))
    }

    /// Flies the first samples of a study by both thermal models, three nodes and films resolved, with the study's model of
    /// motion.
    fn compute(Run { study, progress, .. }: Run<'_>) -> Result<Option<Self>> {
        let mut other = study.clone();
        other.model = study.model.with_other_heat();
        other.numerics.tolerance = study.numerics.tolerance.max(TOLERANCE);
        let rows = SAMPLES.min(study.sampling.samples);
        let own = CommonSample::of_run(study, rows)?;
        let replicates = own.replicates();
        let form = |study: &Study, breaches| Form {
            model: study.model,
            nominal: nominal(study),
            breaches,
        };
        let own = form(study, own.base(progress)?);
        let breaches = CommonSample::of_run(&other, rows)?.base(progress)?;
        Ok(Some(ModelFormOutcomes { replicates, forms: [own, form(&other, breaches)] }))
    }
}
