//! Go or no go: P(any breach) given a value measured on the day.

use super::Figure;
use super::axis::Axis;
use super::chart::{BLUE, Chart, GREEN, HEIGHT, INK, ORANGE, VERMILLION};
use super::key::Swatch;
use crate::findings::CONFIDENCE;
use crate::findings::known::{GoAnswer, GoChart};
use crate::physics::Parameter;
use crate::render::figures_of_speech::probability;
use crate::units::{Quantity, display};

/// A row in the units shown.
struct Row {
    value: f64,
    probability: f64,
    interval: Option<(f64, f64)>,
    answer: GoAnswer,
}

/// The chart of one input; nothing with fewer than two rows.
pub(super) fn figure(go: &GoChart) -> Option<Figure> {
    let path = go.path.split('[').next().unwrap_or(&go.path);
    let quantity = Parameter::from_path(path).map_or(Quantity::Number, |p| p.info().quantity);
    let unit = display(quantity);
    let rows: Vec<Row> = go
        .rows
        .iter()
        .filter_map(|row| {
            Some(Row {
                value: unit.shown(row.value),
                probability: row.probability.value?,
                interval: row.probability.interval.interval().map(|i| (i.lower, i.upper)),
                answer: row.answer,
            })
        })
        .collect();
    let (first, last) = (rows.first()?, rows.last()?);
    if rows.len() < 2 {
        return None;
    }
    let highest =
        rows.iter().map(|r| r.interval.map_or(r.probability, |i| i.1)).fold(0.0, f64::max);
    let level = probability(CONFIDENCE);
    let answers = [
        (GoAnswer::Go, "go", GREEN),
        (GoAnswer::Undecided, "undecided", ORANGE),
        (GoAnswer::NoGo, "no go", VERMILLION),
    ];
    let mut keys = vec![
        (Swatch::Line(BLUE, false), "P(any breach)".to_owned()),
        (Swatch::Area(BLUE, 0.25), format!("{level} interval")),
    ];
    let given = answers.iter().filter(|(answer, ..)| rows.iter().any(|row| row.answer == *answer));
    keys.extend(given.map(|(_, text, fill)| (Swatch::Dot(fill), (*text).to_owned())));
    keys.extend(
        go.allowed.map(|a| (Swatch::Line(INK, true), format!("allowed {}", probability(a)))),
    );
    // So that the outermost dots are whole.
    let room = 0.015 * (last.value - first.value);
    let symbol = if unit.symbol.is_empty() { String::new() } else { format!(" ({})", unit.symbol) };
    let x = Axis::linear(
        format!("measured {}{symbol}", go.path),
        first.value - room,
        last.value + room,
    );
    let high = highest.max(go.allowed.unwrap_or(0.0));
    let y = Axis::shares("probability of any breach", 0.0, 1.06 * high);
    let name = format!("go-{}", go.path.replace(['.', '[', ']'], "-").trim_end_matches('-'));
    let mut chart = Chart::new(&name, HEIGHT, &x, &y, keys, false);
    let band: Vec<(f64, f64, f64)> = rows
        .iter()
        .filter_map(|r| r.interval.map(|(lower, upper)| (r.value, lower, upper)))
        .collect();
    chart.band(&band, BLUE, 0.25);
    let curve: Vec<(f64, f64)> = rows.iter().map(|r| (r.value, r.probability)).collect();
    chart.line(&curve, BLUE, 2.2, false);
    for (answer, _, fill) in answers {
        let points: Vec<(f64, f64)> =
            rows.iter().filter(|r| r.answer == answer).map(|r| (r.value, r.probability)).collect();
        chart.dots(&points, fill, 4.2, 1.0);
    }
    if let Some(allowed) = go.allowed {
        chart.unnamed_limit(allowed, 0.0);
    }
    let title = format!("Go or no go: P(any breach) by measured {}", go.path);
    let caption = "P(any breach) once the value is known, everything else as uncertain as before; the dots say \
                   what is demonstrated about what is allowed."
        .to_owned();
    let alternative = format!(
        "Curve from {} at {:.4}{symbol} to {} at {:.4}.",
        probability(first.probability),
        first.value,
        probability(last.probability),
        last.value
    );
    let svg = chart.svg(&title, &alternative);
    Some(Figure { name, title, caption, alternative, svg })
}
