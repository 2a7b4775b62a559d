//! Morris' screening of a study, and the derivatives of its outcomes at the nominal design and at the means
//! of its laws.

use super::Ensemble;
use super::analysis::{Absent, Analysis, Found, Run};
use crate::descent::Fault;
use crate::descent::gradient::{Gradient, gradient};
use crate::descent::vector::Settings;
use crate::error::Result;
use crate::numerics::columns::Columns;
use crate::physics::Target;
use crate::sensitivity::morris::Screening;
use crate::study::Study;

/// Trajectories of a screening.
pub const TRAJECTORIES: usize = 200;

/// Outcomes along the trajectories.
#[derive(Debug, Clone)]
pub struct ScreeningOutcomes {
    /// The trajectories.
    pub screening: Screening,
    /// Outcomes at their points, trajectory after trajectory × [`crate::descent::OutcomeQuantity::ALL`]; NaN
    /// where faulted.
    pub outcomes: Columns,
}

impl Analysis<'_> for ScreeningOutcomes {
    const NAME: &'static str = "screening";

    fn cost(study: &Study) -> Found<u64> {
        Absent::unless_asked("sensitivity.base_samples", study.sensitivity.base_samples)?;
        Ok(((study.inputs.len() + 1) * TRAJECTORIES) as u64)
    }

    /// Each input moves by its own law, whatever its correlation with others.
    fn compute(Run { study, progress, .. }: Run<'_>) -> Result<Option<Self>> {
        let screening = Screening::new(study.inputs.len(), TRAJECTORIES, study.sampling.seed)?;
        let points = screening.points();
        let mut inputs = Columns::new(points.rows(), points.columns());
        for (j, input) in study.inputs.iter().enumerate() {
            input.marginal.quantile_column(points.column(j), inputs.column_mut(j));
        }
        let table = Ensemble::new(study).at_inputs(&inputs, progress);
        Ok(Some(ScreeningOutcomes { screening, outcomes: table.outcomes }))
    }
}

/// Derivatives of the outcomes with respect to every input, then to every design value that may move, SI.
#[derive(Debug, Clone)]
pub struct Slopes {
    /// What is differentiated by.
    pub targets: Vec<Target>,
    /// At the design as it is.
    pub nominal: std::result::Result<Gradient, Fault>,
    /// With every input at its law's mean.
    pub mean: std::result::Result<Gradient, Fault>,
}

/// Differentiates the nominal descent and the one at the means.
pub fn slopes(study: &Study) -> Slopes {
    let mut targets: Vec<Target> = study.inputs.iter().map(|input| input.target).collect();
    let moving = study.tighten.design.iter().map(|range| range.target);
    let others: Vec<Target> = moving.filter(|target| !targets.contains(target)).collect();
    targets.extend(others);
    let settings = Settings { tolerance: study.numerics.tolerance };
    let means: Vec<f64> = study.inputs.iter().map(|input| input.marginal.mean()).collect();
    let at_means = Ensemble::new(study).design_of(&means);
    Slopes {
        nominal: gradient(study.model, &settings, &study.design, &targets),
        mean: gradient(study.model, &settings, &at_means, &targets),
        targets,
    }
}
