//! Tornado: what drives each output, alone and with interactions.

use super::Figure;
use super::axis::Axis;
use super::chart::{BLUE, Chart, INK};
use super::key::Swatch;
use crate::analysis::Findings;
use crate::findings::{CONFIDENCE, DriverOutput, FactorFinding, Output};
use crate::numerics::interval::Estimate;
use crate::render::driver_view::ranked;
use crate::render::figures_of_speech::probability;
use crate::units::number;

/// Factors shown.
const SHOWN: usize = 8;
/// Height of a factor's row.
const ROW: f64 = 34.0;

/// A tornado of any breach and of each limited outcome.
pub(super) fn figures(findings: &Findings) -> Vec<Figure> {
    let limited: Vec<&str> = findings.margins.iter().map(|margin| margin.outcome).collect();
    let mut outputs: Vec<&DriverOutput> = findings
        .drivers
        .outputs
        .iter()
        .filter(|output| output.name == Output::AnyBreach || output.name.is_one_of(&limited))
        .collect();
    outputs.sort_by_key(|output| !output.breach);
    outputs.into_iter().filter_map(tornado).collect()
}

fn tornado(output: &DriverOutput) -> Option<Figure> {
    let factors: Vec<&FactorFinding> = ranked(output)
        .into_iter()
        .filter(|factor| factor.indices.total.value.is_some())
        .take(SHOWN)
        .collect();
    let strongest = factors.first()?;
    let ends = |estimate: &Estimate| {
        let value = estimate.value.unwrap_or(0.0);
        estimate.interval.interval().map_or((value, value), |i| (i.lower, i.upper))
    };
    let all = || factors.iter().flat_map(|f| [&f.indices.total, &f.indices.first]).map(ends);
    let low = all().map(|e| e.0).fold(0.0, f64::min);
    let high = all().map(|e| e.1).fold(0.0, f64::max);
    let room = 0.04 * (high - low);
    let rows = factors.len() as f64;
    // The strongest on top: rows are numbered from below.
    let labels: Vec<String> = factors.iter().rev().map(|factor| row_name(factor)).collect();
    let keys = vec![
        (Swatch::Area(BLUE, 0.35), "with interactions (total)".to_owned()),
        (Swatch::Area(BLUE, 1.0), "alone (first order)".to_owned()),
        (Swatch::Line(INK, false), format!("{} interval", probability(CONFIDENCE))),
    ];
    let name = format!("drivers-{}", output.name.to_string().replace('.', "-"));
    let x = Axis::linear("share of the variance", low - room, high + room);
    let y = Axis::linear("", 0.45, rows + 0.55);
    let height = 110.0 + ROW * rows;
    let mut chart = Chart::with_rows(&name, height, &x, &y, keys, false, Some(labels));
    for (k, factor) in factors.iter().enumerate() {
        let middle = rows - k as f64;
        let kinds = [("total", &factor.indices.total, 0.35), ("alone", &factor.indices.first, 1.0)];
        for (place, (kind, estimate, opacity)) in kinds.into_iter().enumerate() {
            let Some(value) = estimate.value else { continue };
            let y = middle + 0.19 - 0.38 * place as f64;
            let (lower, upper) = ends(estimate);
            let hover = format!(
                "{}, {kind}: {} ({} to {})",
                factor.name,
                number(value, 3),
                number(lower, 3),
                number(upper, 3)
            );
            chart.bar((0.0, y - 0.16), (value, y + 0.16), BLUE, opacity, hover);
            if estimate.interval.interval().is_some() {
                chart.line(&[(lower, y), (upper, y)], INK, 1.4, false);
                for end in [lower, upper] {
                    chart.line(&[(end, y - 0.09), (end, y + 0.09)], INK, 1.4, false);
                }
            }
        }
    }
    chart.line(&[(0.0, 0.45), (0.0, rows + 0.55)], INK, 1.0, false);
    let title = format!("What drives the {}", output.title);
    let caption =
        "Sobol' indices with their bootstrap intervals. An interval that reaches below zero says \
                   only that the index is small."
            .to_owned();
    let alternative = format!(
        "Bars of the {} strongest factors; the longest is {}, total index {}.",
        factors.len(),
        strongest.name,
        number(strongest.indices.total.value.unwrap_or(0.0), 3)
    );
    let svg = chart.svg(&title, &alternative);
    Some(Figure { name, title, caption, alternative, svg })
}

/// The path without its section where that is understood: "fluid.shear_factor" as it is, and a group with
/// the number of its members.
fn row_name(factor: &FactorFinding) -> String {
    match factor.inputs {
        1 => factor.name.to_string(),
        many => format!("{} ×{many}", factor.name.name),
    }
}
