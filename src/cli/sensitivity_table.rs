//! Every measure of sensitivity as one long Parquet table.

use crate::analysis::Findings;
use crate::error::Result;
use crate::numerics::interval::Estimate;
use crate::store::{Field, Parentage, write_table};
use std::path::Path;

/// The table of sensitivity indices.
pub(super) const SENSITIVITY: &str = "sensitivity.parquet";

/// How the Sobol' indices and the fair shares were estimated.
const PICK_FREEZE: &str = "pick-freeze design";
const WALKS: &str = "walks of a design of their own";

/// One row of the table.
struct Row {
    method: &'static str,
    index: &'static str,
    output: String,
    factor: String,
    inputs: usize,
    samples: usize,
    estimate: Estimate,
    p_value: Option<f64>,
    note: Option<String>,
    rows_left_out: usize,
}

/// Writes every index of every output and factor, one row each.
///
/// # Errors
/// If the file cannot be written.
pub(super) fn write_sensitivity(
    path: &Path,
    findings: &Findings,
    parentage: &Parentage,
) -> Result<()> {
    let mut rows = pick_freeze(findings);
    rows.extend(shares(findings));
    rows.extend(measured(findings));
    rows.extend(derivatives(findings));
    let text = |read: &dyn Fn(&Row) -> Option<String>| Field::Text(rows.iter().map(read).collect());
    let number =
        |read: &dyn Fn(&Row) -> Option<f64>| Field::Number(rows.iter().map(read).collect());
    let count =
        |read: &dyn Fn(&Row) -> usize| Field::Count(rows.iter().map(|r| read(r) as u64).collect());
    let why_none = |row: &Row| {
        let why = row.estimate.interval.why_none().map(|why| format!("no interval: {why}"));
        let said = [why, row.note.clone()].into_iter().flatten().collect::<Vec<_>>().join("; ");
        (!said.is_empty()).then_some(said)
    };
    let columns = vec![
        ("method".to_owned(), text(&|row| Some(row.method.to_owned()))),
        ("index".to_owned(), text(&|row| Some(row.index.to_owned()))),
        ("output".to_owned(), text(&|row| Some(row.output.clone()))),
        ("factor".to_owned(), text(&|row| Some(row.factor.clone()))),
        ("inputs".to_owned(), count(&|row| row.inputs)),
        ("samples".to_owned(), count(&|row| row.samples)),
        ("estimate".to_owned(), number(&|row| row.estimate.value)),
        ("standard_error".to_owned(), number(&|row| row.estimate.standard_error)),
        ("lower_95".to_owned(), number(&|row| Some(row.estimate.interval.interval()?.lower))),
        ("upper_95".to_owned(), number(&|row| Some(row.estimate.interval.interval()?.upper))),
        ("p_value".to_owned(), number(&|row| row.p_value)),
        ("note".to_owned(), text(&why_none)),
        ("rows_left_out".to_owned(), count(&|row| row.rows_left_out)),
    ];
    write_table(path, columns, parentage.entries())
}

fn pick_freeze(findings: &Findings) -> Vec<Row> {
    let drivers = &findings.drivers;
    let mut rows = Vec::new();
    for output in &drivers.outputs {
        let row =
            |index, factor: String, inputs, estimate: &Estimate, note: &Option<String>, left| Row {
                method: PICK_FREEZE,
                index,
                output: output.name.to_string(),
                factor,
                inputs,
                samples: drivers.base_samples,
                estimate: estimate.clone(),
                p_value: None,
                note: note.clone(),
                rows_left_out: left,
            };
        for factor in &output.factors {
            let found = &factor.indices;
            for (index, estimate) in [("first", &found.first), ("total", &found.total)] {
                let beyond = estimate.value.is_some_and(|value| !(0.0..=1.0).contains(&value));
                let note = found.explanation.clone().filter(|_| beyond);
                let name = factor.name.to_string();
                rows.push(row(index, name, factor.inputs, estimate, &note, found.rows_left_out));
            }
        }
        for pair in &output.pairs {
            let found = &pair.indices;
            let name = format!("{} × {}", pair.factors.0, pair.factors.1);
            for (index, estimate, note) in [
                ("closed", &found.closed, &None),
                ("second", &found.interaction, &found.explanation),
            ] {
                rows.push(row(
                    index,
                    name.clone(),
                    pair.inputs,
                    estimate,
                    note,
                    found.rows_left_out,
                ));
            }
        }
    }
    rows
}

fn shares(findings: &Findings) -> impl Iterator<Item = Row> {
    let shapley = &findings.shapley;
    let inputs = |name: &str| {
        let known = findings.measures.factors.iter().find(|factor| factor.name.name == name);
        known.map_or(1, |factor| factor.inputs)
    };
    shapley.outputs.iter().flat_map(move |output| {
        output.effects.iter().map(move |(factor, effect)| Row {
            method: WALKS,
            index: "shapley",
            output: output.name.to_string(),
            factor: factor.clone(),
            inputs: inputs(factor),
            samples: shapley.walks,
            estimate: effect.clone(),
            p_value: None,
            note: None,
            rows_left_out: output.left_out,
        })
    })
}

fn measured(findings: &Findings) -> impl Iterator<Item = Row> {
    let measures = &findings.measures;
    measures.outputs.iter().flat_map(move |output| {
        output.indices.iter().flat_map(move |column| {
            measures.factors.iter().zip(&column.estimates).enumerate().map(
                move |(k, (factor, estimate))| Row {
                    method: column.method,
                    index: column.index,
                    output: output.name.to_string(),
                    factor: factor.name.to_string(),
                    inputs: factor.inputs,
                    samples: column.samples,
                    estimate: estimate.clone(),
                    p_value: column.p_values.get(k).copied().flatten(),
                    note: column.explanations.get(k).cloned().flatten(),
                    rows_left_out: column.left_out,
                },
            )
        })
    })
}

fn derivatives(findings: &Findings) -> Vec<Row> {
    let local = &findings.measures.local;
    let mut rows = Vec::new();
    for outcome in &local.outcomes {
        let columns =
            [("derivative_at_nominal", &outcome.nominal), ("derivative_at_means", &outcome.mean)];
        for (index, values) in columns {
            for (target, value) in local.targets.iter().zip(values) {
                let mut estimate = Estimate::none(outcome.note.trim_start_matches("no interval: "));
                estimate.value = *value;
                rows.push(Row {
                    method: "gradient kernel, SI per SI",
                    index,
                    output: outcome.name.to_owned(),
                    factor: target.path.clone(),
                    inputs: target.inputs,
                    samples: 0,
                    estimate,
                    p_value: None,
                    note: None,
                    rows_left_out: 0,
                });
            }
        }
    }
    rows
}
