//! Go or no go: P(any breach) given a value measured on the day.

use super::Figure;
use super::axis::Axis;
use super::chart::{BLUE, Chart, GREEN, HEIGHT, ORANGE, Swatch, VERMILLION};
use crate::findings::CONFIDENCE;
use crate::findings::known::{GoAnswer, GoChart};
use crate::physics::Parameter;
use crate::render::figures_of_speech::probability;
use crate::units::{Quantity, display};

/// The chart of one input; nothing with fewer than two rows.
pub(super) fn figure(go: &GoChart) -> Option<Figure> {
    let path = go.path.split('[').next().unwrap_or(&go.path);
    let quantity = Parameter::from_path(path).map_or(Quantity::Number, |p| p.info().quantity);
    let unit = display(quantity);
    let rows: Vec<(f64, f64, Option<(f64, f64)>, GoAnswer)> = go
        .rows
        .iter()
        .filter_map(|row| {
            let interval = row.probability.interval.interval().map(|i| (i.lower, i.upper));
            Some((unit.shown(row.value), row.probability.value?, interval, row.answer))
        })
        .collect();
    let (first, last) = (rows.first()?, rows.last()?);
    if rows.len() < 2 {
        return None;
    }
    let highest = rows.iter().map(|r| r.2.map_or(r.1, |i| i.1)).fold(0.0, f64::max);
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
    let given = answers.iter().filter(|(answer, ..)| rows.iter().any(|row| row.3 == *answer));
    keys.extend(given.map(|(_, text, fill)| (Swatch::Dot(fill), (*text).to_owned())));
    let symbol = if unit.symbol.is_empty() { String::new() } else { format!(" ({})", unit.symbol) };
    let x = Axis::linear(format!("measured {}{symbol}", go.path), first.0, last.0);
    let high = highest.max(go.allowed.unwrap_or(0.0));
    let y = Axis::shares("probability of any breach", 0.0, 1.06 * high);
    let name = format!("go-{}", go.path.replace(['.', '[', ']'], "-").trim_end_matches('-'));
    let mut chart = Chart::new(&name, HEIGHT, &x, &y, keys, false);
    let band: Vec<(f64, f64, f64)> =
        rows.iter().filter_map(|r| r.2.map(|(lower, upper)| (r.0, lower, upper))).collect();
    chart.band(&band, BLUE, 0.25);
    let curve: Vec<(f64, f64)> = rows.iter().map(|r| (r.0, r.1)).collect();
    chart.line(&curve, BLUE, 2.2, false);
    for (answer, _, fill) in answers {
        let points: Vec<(f64, f64)> =
            rows.iter().filter(|r| r.3 == answer).map(|r| (r.0, r.1)).collect();
        chart.dots(&points, fill, 4.2, 1.0);
    }
    if let Some(allowed) = go.allowed {
        chart.horizontal_limit(allowed, &format!("allowed {}", probability(allowed)));
    }
    let title = format!("Go or no go: P(any breach) by measured {}", go.path);
    let caption = "P(any breach) once the value is known, everything else as uncertain as before; the dots say \
                   what is demonstrated about what is allowed."
        .to_owned();
    let alternative = format!(
        "Curve from {} at {:.4}{symbol} to {} at {:.4}.",
        probability(first.1),
        first.0,
        probability(last.1),
        last.0
    );
    let svg = chart.svg(&title, &alternative);
    Some(Figure { name, title, caption, alternative, svg })
}
