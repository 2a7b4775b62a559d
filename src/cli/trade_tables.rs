//! The trade of tolerances, the Shapley effects and the go/no-go charts as Parquet tables.

use crate::analysis::Findings;
use crate::error::Result;
use crate::numerics::interval::Estimate;
use crate::store::{Field, Parentage, write_table};
use std::path::Path;

/// The table of the trade.
pub(super) const TRADE: &str = "trade.parquet";

/// One row of the table.
struct Row<'f> {
    kind: &'static str,
    name: &'f str,
    parameter: String,
    setting: Option<f64>,
    value: &'f Estimate,
    difference: Option<&'f Estimate>,
    check: Option<f64>,
}

/// Writes every number of the trade, one row each.
///
/// # Errors
/// If the file cannot be written.
pub(super) fn write_trade(path: &Path, findings: &Findings, parentage: &Parentage) -> Result<()> {
    let mut rows = Vec::new();
    for curve in &findings.trade.curves {
        rows.extend(curve.points.iter().map(|point| Row {
            kind: "curve",
            name: &curve.factor,
            parameter: curve.parameter.to_owned(),
            setting: Some(point.setting),
            value: &point.probability,
            difference: Some(&point.difference),
            check: point.reweighted.as_ref().and_then(|check| check.probability.value),
        }));
    }
    for design in &findings.trade.design {
        rows.extend(design.points.iter().map(|point| Row {
            kind: "design",
            name: &design.path,
            parameter: "value".to_owned(),
            setting: Some(point.setting),
            value: &point.probability,
            difference: Some(&point.difference),
            check: None,
        }));
    }
    for derivative in &findings.trade.derivatives {
        rows.push(Row {
            kind: "derivative",
            name: &derivative.factor,
            parameter: format!("{} of {}", derivative.parameter, derivative.event),
            setting: Some(derivative.step),
            value: &derivative.derivative,
            difference: None,
            check: derivative.confirmed.as_ref().and_then(|confirmed| confirmed.value),
        });
    }
    for output in &findings.shapley.outputs {
        rows.extend(output.effects.iter().map(|(factor, effect)| Row {
            kind: "shapley",
            name: factor,
            parameter: output.name.to_string(),
            setting: None,
            value: effect,
            difference: None,
            check: None,
        }));
    }
    for chart in &findings.known.charts {
        rows.extend(chart.rows.iter().map(|row| Row {
            kind: "go",
            name: &chart.path,
            parameter: "measured value".to_owned(),
            setting: Some(row.value),
            value: &row.probability,
            difference: None,
            check: None,
        }));
    }
    let text = |read: &dyn Fn(&Row<'_>) -> String| {
        Field::Text(rows.iter().map(|row| Some(read(row))).collect())
    };
    let number =
        |read: &dyn Fn(&Row<'_>) -> Option<f64>| Field::Number(rows.iter().map(read).collect());
    let lower = |e: &Estimate| e.interval.interval().map(|i| i.lower);
    let upper = |e: &Estimate| e.interval.interval().map(|i| i.upper);
    let columns = vec![
        ("kind".to_owned(), text(&|row| row.kind.to_owned())),
        ("name".to_owned(), text(&|row| row.name.to_owned())),
        ("parameter".to_owned(), text(&|row| row.parameter.clone())),
        ("setting".to_owned(), number(&|row| row.setting)),
        ("value".to_owned(), number(&|row| row.value.value)),
        ("lower_95".to_owned(), number(&|row| lower(row.value))),
        ("upper_95".to_owned(), number(&|row| upper(row.value))),
        ("difference".to_owned(), number(&|row| row.difference?.value)),
        ("difference_lower_95".to_owned(), number(&|row| lower(row.difference?))),
        ("difference_upper_95".to_owned(), number(&|row| upper(row.difference?))),
        ("check".to_owned(), number(&|row| row.check)),
    ];
    write_table(path, columns, parentage.entries())
}
