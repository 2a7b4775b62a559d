//! `reeldown descend`: one nominal descent.

use super::arguments::DescendArguments;
use super::figure_files::write_figures;
use super::{Ending, done};
use crate::descent::reference::{self, REFERENCE_TOLERANCE, Sample, Trajectory};
use crate::descent::{Fault, Model, Outcome, OutcomeQuantity};
use crate::error::{Error, Result};
use crate::findings;
use crate::physics::motion::OBSERVABLES;
use crate::physics::parameters::PARAMETERS;
use crate::physics::{Coefficients, Design, Parameter};
use crate::render::{paper_figures, table};
use crate::store::{Field, write_table};
use crate::study::Study;
use crate::units::engineering;
use serde_json::{Map, Value, json};
use std::path::Path;

/// Longest step of a traced descent, s: fine enough to draw from.
const TRACE_STEP_S: f64 = 0.25;

/// Computes the nominal descent of a study and shows it.
pub(super) fn descend(arguments: &DescendArguments) -> Result<Ending> {
    let model = arguments.model.iter().map(|name| ("--model", format!("model={name}")));
    let study = arguments.study.load(&model.collect::<Vec<_>>())?;
    study.design.validate()?;
    let outcome = integrate(&study.design, study.model, arguments.trace.as_deref())?;
    if let Some(directory) = &arguments.figures {
        draw(&study.design, directory)?;
    }
    if arguments.json {
        return done(&format!("{:#}", Value::Object(outcome_json(&outcome))));
    }
    let mut text = format!("{}: nominal descent, {} model\n\n", study.title, study.model.name());
    text += &outcome_table(&study, &outcome);
    if let Some(path) = &arguments.trace {
        text += &format!("\ncourse of the descent: {}\n", path.display());
    }
    if let Some(directory) = &arguments.figures {
        text += &format!("\nfigures: {}\n", directory.display());
    }
    done(&text)
}

/// Draws the paper's figures, from the steady solution as the paper does.
fn draw(design: &Design, directory: &Path) -> Result<()> {
    let runs = findings::paper_runs(design, Model::QuasiSteady)
        .map_err(|fault| cannot_integrate(design, fault))?;
    write_figures(directory, &paper_figures(&runs))
}

/// A fault, with the value that is likeliest to have caused it: the one whose ratio to the paper's brake's is
/// farthest from one.
fn cannot_integrate(design: &Design, fault: Fault) -> Error {
    let baseline = Design::baseline();
    let departure = |parameter: Parameter| {
        let (here, paper): (f64, f64) = (design.get(parameter), baseline.get(parameter));
        Some((here / paper).max(paper / here)).filter(|ratio| ratio.is_finite() && *ratio > 1.0)
    };
    let all = PARAMETERS.iter().map(|info| info.parameter);
    let far = all.filter_map(|parameter| Some((parameter, departure(parameter)?)));
    let advice = far.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(String::new(), |(parameter, _)| {
        let info = parameter.info();
        format!(
            "; {} = {} is farthest from the paper's brake, which has {}: is it meant, and in that unit?",
            info.path,
            engineering(design.get(parameter), info.quantity),
            info.baseline_text
        )
    });
    Error::argument(format!("the descent cannot be integrated: {}{advice}", fault.name()))
}

/// Integrates a design by the plain integrator, writing its course if asked to.
pub(super) fn integrate(design: &Design, model: Model, trace: Option<&Path>) -> Result<Outcome> {
    let coefficients = Coefficients::new(design);
    let failed = |fault| cannot_integrate(design, fault);
    let Some(path) = trace else {
        return reference::descend(&coefficients, model, REFERENCE_TOLERANCE).map_err(failed);
    };
    let Trajectory { samples, .. } =
        reference::trajectory(&coefficients, model, REFERENCE_TOLERANCE, TRACE_STEP_S)
            .map_err(failed)?;
    write_trace(path, model.name(), &samples)?;
    // The outcome is that of the descent without a limit on its steps, whatever is traced.
    reference::descend(&coefficients, model, REFERENCE_TOLERANCE).map_err(failed)
}

/// Writes the course of a descent or of a run on the rig.
pub(super) fn write_trace(path: &Path, model: &str, samples: &[Sample]) -> Result<()> {
    let field =
        |read: &dyn Fn(&Sample) -> Option<f64>| Field::Number(samples.iter().map(read).collect());
    let mut columns = vec![
        ("time_s".to_owned(), field(&|s| Some(s.time_s))),
        ("line_m".to_owned(), field(&|s| Some(s.line_m))),
        ("balloon_velocity_m_per_s".to_owned(), field(&|s| s.balloon_velocity_m_per_s)),
        ("torque_nm".to_owned(), field(&|s| Some(s.torque_nm))),
    ];
    for (k, name) in OBSERVABLES.iter().enumerate() {
        columns.push(((*name).to_owned(), field(&|s| Some(s.observation[k]))));
    }
    columns.push(("rotor_temperature_k".to_owned(), field(&|s| Some(s.temperatures_k[1]))));
    columns.push(("housing_temperature_k".to_owned(), field(&|s| Some(s.temperatures_k[2]))));
    let metadata = vec![
        ("reeldown.version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
        ("reeldown.model".to_owned(), model.to_owned()),
    ];
    write_table(path, columns, metadata)
}

/// An outcome as JSON, SI, under the Parquet column names.
pub(super) fn outcome_json(outcome: &Outcome) -> Map<String, Value> {
    let mut object = Map::new();
    object.insert("deployed".to_owned(), json!(outcome.deployed));
    for quantity in OutcomeQuantity::ALL {
        object.insert(quantity.column(), json!(outcome.get(quantity)));
    }
    object
}

/// An outcome as a table for a terminal, with the limits it is held against.
pub(super) fn outcome_table(study: &Study, outcome: &Outcome) -> String {
    let rows = OutcomeQuantity::ALL.into_iter().map(|quantity| {
        let value = engineering(outcome.get(quantity), quantity.quantity());
        let limits: Vec<_> =
            study.limits.iter().filter(|limit| limit.outcome == quantity).collect();
        let texts: Vec<String> =
            limits.iter().map(|l| format!("{} {}", l.kind.name(), l.text)).collect();
        let margins: Vec<String> = limits
            .iter()
            .map(|limit| {
                let margin = limit.margin(outcome);
                let text = engineering(margin, quantity.quantity().of_difference());
                if margin < 0.0 { format!("{text} BREACH") } else { text }
            })
            .collect();
        [quantity.title().to_owned(), value, texts.join(", "), margins.join(", ")]
    });
    let table = table(&["outcome", "value", "limit", "margin"], 1..4, rows, None);
    let end = if outcome.deployed {
        String::new()
    } else {
        "\nThe line had not run out after 1800 s: the values are those at that time.\n".to_owned()
    };
    format!("{table}\n{end}")
}
