//! What the values that are taken as exact do to the breaches: each moved a little, at the same points.

use super::analysis::{Absent, Analysis, Found, Run};
use super::common_numbers::{Breaches, Change, CommonSample};
use super::{Progress, factors};
use crate::error::Result;
use crate::physics::Target;
use crate::physics::parameters::Parameter;
use crate::study::Study;
use crate::units::Quantity;

/// Samples of the run at which the values are moved, at most.
const ROWS: u64 = 4096;
/// By what share a value is moved.
pub const SHARE: f64 = 0.01;
/// By how much a temperature is moved, K: a share of its distance from absolute zero says nothing.
pub const KELVIN: f64 = 1.0;

/// Breaches with every exact value moved, and with the mean of every input of the card.
#[derive(Debug)]
pub struct ExactOutcomes {
    /// The breaches of the study as it is.
    pub base: Breaches,
    /// Independently randomised replicates to which the rows belong in turn; 1 if every row is independent.
    pub replicates: usize,
    /// One entry an exact value, in the order of the design's parameters.
    pub values: Vec<MovedValue>,
    /// One entry a factor of the card whose mean can be moved so.
    pub inputs: Vec<(String, Breaches)>,
}

/// What moving one exact value does.
#[derive(Debug)]
pub struct MovedValue {
    /// The value.
    pub target: Target,
    /// By how much it was moved, SI; `None` if it cannot be: a whole number, or zero.
    pub moved: Option<(f64, Breaches)>,
}

/// The values that no law of the card varies.
fn exact(study: &Study) -> Vec<Target> {
    let rows = study.resolved().into_iter().filter(|row| row.uncertain.is_none());
    let rows = rows.map(|row| row.target);
    let varied = |parameter| study.inputs.iter().any(|input| input.target.parameter == parameter);
    rows.filter(|target| match target.parameter {
        // The lot's law is that of the nominal viscosity; without one the two are the same step, made once.
        Parameter::FluidLotFactor => false,
        Parameter::FluidNominalViscosity => !varied(Parameter::FluidLotFactor),
        // A gap as a whole of which single surfaces are uncertain is not exact.
        parameter => target.surface.is_some() || !varied(parameter),
    })
    .collect()
}

/// The step of a value, SI.
fn step(value: f64, parameter: Parameter) -> Option<f64> {
    let info = parameter.info();
    let step = match info.quantity {
        Quantity::Temperature => KELVIN,
        _ => SHARE * value,
    };
    if parameter == Parameter::BrakeRotors || step == 0.0 {
        return None;
    }
    // At the end of a range the other way.
    [step, -step].into_iter().find(|step| info.admits(value + step))
}

impl Analysis<'_> for ExactOutcomes {
    const NAME: &'static str = "exact values";

    fn cost(study: &Study) -> Found<u64> {
        Absent::unless_limited(study)?;
        let moves = 1 + exact(study).len() + factors(study).len();
        Ok(ROWS.min(study.sampling.samples) * moves as u64)
    }

    fn compute(run: Run<'_>) -> Result<Option<Self>> {
        run_exact(run.study, run.progress)
    }
}

/// Moves every exact value and the mean of every input. `None` if `progress` asks for a stop.
///
/// # Errors
///
/// What the sampler refuses, and a value that does not fit the study.
pub fn run_exact(study: &Study, progress: &Progress) -> Result<Option<ExactOutcomes>> {
    let sample = CommonSample::of_run(study, ROWS)?;
    let base = sample.base(progress)?;
    let mut values = Vec::new();
    for target in exact(study) {
        if progress.stopping() {
            return Ok(None);
        }
        let value = study.design.at(target);
        let moved = match step(value, target.parameter) {
            None => None,
            Some(step) => {
                let change = Change::default().and_design(target, value + step);
                Some((step, sample.changed(&change, progress)?))
            }
        };
        values.push(MovedValue { target, moved });
    }
    let mut inputs = Vec::new();
    for factor in factors(study) {
        let members = || factor.columns.iter().map(|&j| &study.inputs[j]);
        let Some(first) = members().next() else { continue };
        let parameter = first.target.parameter;
        if members().any(|input| input.target.parameter != parameter) || progress.stopping() {
            continue;
        }
        let Some(step) = step(first.marginal.mean(), parameter) else { continue };
        // A law that cannot be moved so has no place in the comparison.
        let Ok(change) = Change::shift(study, &factor.columns, step) else { continue };
        inputs.push((factor.name, sample.changed(&change, progress)?));
    }
    Ok(Some(ExactOutcomes { base, replicates: sample.replicates(), values, inputs }))
}
