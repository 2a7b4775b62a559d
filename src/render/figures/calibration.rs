//! A calibration seen: what each parameter learned, and each channel's readings less what was predicted.

use super::Figure;
use super::axis::Axis;
use super::chart::{BLUE, Chart, HEIGHT, INK, VERMILLION};
use super::key::Swatch;
use crate::findings::calibration::{CalibrationFinding, CheckFinding};
use crate::units::{Quantity, display, number};

/// Height of a parameter's row.
const ROW: f64 = 30.0;

/// Every figure of a calibration.
pub fn calibration_figures(finding: &CalibrationFinding) -> Vec<Figure> {
    shrinkage(finding).into_iter().chain(finding.checks.iter().filter_map(residuals)).collect()
}

/// Posterior intervals in the prior's standard deviations.
fn shrinkage(finding: &CalibrationFinding) -> Option<Figure> {
    let shown: Vec<_> = finding.parameters.iter().filter(|p| p.prior.1 > 0.0).collect();
    if shown.is_empty() {
        return None;
    }
    // The first parameter on top.
    let rows: Vec<String> = shown
        .iter()
        .rev()
        .map(|p| p.name.replace(" (torque per speed, over the nominal)", ""))
        .collect();
    let scaled =
        |p: &crate::findings::calibration::ParameterFinding, x: f64| (x - p.prior.0) / p.prior.1;
    let reach = shown
        .iter()
        .flat_map(|p| [scaled(p, p.quantiles[0]).abs(), scaled(p, p.quantiles[2]).abs()])
        .fold(2.0, f64::max);
    let keys = vec![
        (Swatch::Area(INK, 0.15), "prior, middle 90 %".to_owned()),
        (Swatch::Area(BLUE, 0.6), "posterior, middle 90 %".to_owned()),
        (Swatch::Dot(INK), "posterior median".to_owned()),
    ];
    let x = Axis::linear("prior deviations from the prior mean", -reach, reach);
    let y = Axis::linear("", 0.5, rows.len() as f64 + 0.5);
    let height = 90.0 + ROW * rows.len() as f64;
    let mut chart = Chart::with_rows("shrinkage", height, &x, &y, keys, false, Some(rows));
    for (k, p) in shown.iter().rev().enumerate() {
        let at = k as f64 + 1.0;
        let hover =
            format!("{}: {} ± {}", p.name, number(p.posterior.0, 4), number(p.posterior.1, 2));
        chart.bar((-1.645, at - 0.32), (1.645, at + 0.32), INK, 0.15, p.name.clone());
        let ends = [scaled(p, p.quantiles[0]), scaled(p, p.quantiles[2])];
        chart.bar((ends[0], at - 0.2), (ends[1], at + 0.2), BLUE, 0.6, hover);
        chart.dots(&[(scaled(p, p.quantiles[1]), at)], INK, 3.5, 1.0);
    }
    let title = "Prior and posterior of each parameter".to_owned();
    let most = shown.iter().max_by(|a, b| a.learned.total_cmp(&b.learned))?;
    let caption =
        "Where the posterior is as wide as the prior, the data do not identify the parameter."
            .to_owned();
    let alternative = format!(
        "Prior and posterior intervals of {} parameters; best identified: {}, whose prior variance is reduced by {:.0} %.",
        shown.len(),
        most.name,
        100.0 * most.learned
    );
    let svg = chart.svg(&title, &alternative);
    Some(Figure { name: "shrinkage".to_owned(), title, caption, alternative, svg })
}

/// Readings less the model's median, with the bands.
fn residuals(check: &CheckFinding) -> Option<Figure> {
    let quantity = match check.channel {
        "force" => Quantity::Force,
        "speed" => Quantity::Speed,
        "line" => Quantity::Length,
        _ => Quantity::TemperatureDifference,
    };
    let unit = display(quantity);
    let shown = |si: f64| unit.shown(si);
    let file = check.run.rsplit(['/', '\\']).next().unwrap_or(&check.run);
    let stem = file.split('.').next().unwrap_or(file);
    let inside: Vec<(f64, f64)> = points(check, true, &shown);
    let outside: Vec<(f64, f64)> = points(check, false, &shown);
    let (first, last) = (check.course.first()?.time_s, check.course.last()?.time_s);
    let reach = check
        .course
        .iter()
        .flat_map(|p| [p.band[0] - p.model, p.band[1] - p.model, p.measured - p.model])
        .map(|x| shown(x).abs())
        .fold(0.0, f64::max);
    let keys = vec![
        (Swatch::Area(BLUE, 0.25), "90 % of readings".to_owned()),
        (Swatch::Area(BLUE, 0.5), "90 % of models".to_owned()),
        (Swatch::Dot(INK), "reading inside".to_owned()),
        (Swatch::Dot(VERMILLION), "outside".to_owned()),
    ];
    let name = format!("residuals-{stem}-{}", check.channel);
    let x = Axis::linear("time (s)", first, last);
    let label = format!("{}: read − predicted ({})", check.channel, unit.symbol);
    let y = Axis::linear(label, -1.05 * reach, 1.05 * reach);
    let mut chart = Chart::new(&name, HEIGHT, &x, &y, keys, false);
    let band: Vec<(f64, f64, f64)> = check
        .course
        .iter()
        .map(|p| (p.time_s, shown(p.band[0] - p.model), shown(p.band[1] - p.model)))
        .collect();
    let model: Vec<(f64, f64, f64)> = check
        .course
        .iter()
        .map(|p| (p.time_s, shown(p.model_band[0] - p.model), shown(p.model_band[1] - p.model)))
        .collect();
    chart.band(&band, BLUE, 0.25);
    chart.band(&model, BLUE, 0.35);
    chart.dots(&inside, INK, 2.0, 0.8);
    chart.dots(&outside, VERMILLION, 2.8, 1.0);
    let held = if check.held_out { ", held out" } else { "" };
    let title = format!("Residuals of {} in {file}{held}", check.channel);
    let caption = format!(
        "{}: {:.0} % of {} readings lie in the band that should hold {:.0} %.",
        title,
        100.0 * check.coverage,
        check.course.len(),
        100.0 * check.expected
    );
    let alternative = format!(
        "Readings less predictions over {} s; {} of {} outside the 90 % band.",
        number(last - first, 4),
        outside.len(),
        check.course.len()
    );
    let svg = chart.svg(&title, &alternative);
    Some(Figure { name, title, caption, alternative, svg })
}

fn points(check: &CheckFinding, inside: bool, shown: &dyn Fn(f64) -> f64) -> Vec<(f64, f64)> {
    check
        .course
        .iter()
        .filter(|p| (p.band[0]..=p.band[1]).contains(&p.measured) == inside)
        .map(|p| (p.time_s, shown(p.measured - p.model)))
        .collect()
}
