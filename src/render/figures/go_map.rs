//! Go or no go by two measured values.

use super::Figure;
use super::axis::Axis;
use super::chart::{Chart, GREEN, INK, ORANGE, VERMILLION};
use super::contour::{self, Field};
use super::key::Swatch;
use crate::findings::known::{GoAnswer, GoMap};
use crate::numerics::interval::Estimate;
use crate::numerics::special::normal;
use crate::physics::Parameter;
use crate::render::figures_of_speech::{count, probability, probability_interval, value};
use crate::units::{Quantity, display};

/// Height of the map.
const TALL: f64 = 400.0;
/// Contours besides that of what is allowed.
const CONTOURS: [f64; 2] = [0.1, 0.5];

/// The map; nothing with fewer than two values either way.
pub(super) fn figure(map: &GoMap) -> Option<Figure> {
    let quantity = |path: &str| {
        let path = path.split('[').next().unwrap_or(path);
        Parameter::from_path(path).map_or(Quantity::Number, |p| p.info().quantity)
    };
    // The measured temperature upwards, what is chosen or measured besides to the right.
    let (up, across) = (quantity(&map.paths.0), quantity(&map.paths.1));
    let xs: Vec<f64> = map.second.iter().map(|&v| display(across).shown(v)).collect();
    let ys: Vec<f64> = map.first.iter().map(|&v| display(up).shown(v)).collect();
    let ([x0, .., x1], [y0, .., y1]) = (&xs[..], &ys[..]) else { return None };
    let half = |a: f64, b: f64, cells: usize| 0.5 * (b - a) / (cells - 1) as f64;
    let (wide, high) = (half(*x0, *x1, xs.len()), half(*y0, *y1, ys.len()));
    let label = |lot: bool, path: &str, quantity: Quantity| {
        let symbol = display(quantity).symbol;
        let what = if lot { "lot's " } else { "measured " };
        let unit = if symbol.is_empty() { String::new() } else { format!(" ({symbol})") };
        format!("{what}{path}{unit}")
    };
    let x = Axis::linear(label(map.lot, &map.paths.1, across), x0 - wide, x1 + wide);
    let y = Axis::linear(label(false, &map.paths.0, up), y0 - high, y1 + high);
    let answers = [
        (GoAnswer::Go, "go", GREEN, 0.65),
        (GoAnswer::Undecided, "undecided", ORANGE, 0.4),
        (GoAnswer::NoGo, "no go", VERMILLION, 0.75),
        (GoAnswer::NoRequirement, "no requirement", "#bdbdbd", 0.5),
    ];
    let seen = |answer: GoAnswer| map.cells.iter().filter(|(_, a)| *a == answer).count();
    let mut keys: Vec<(Swatch, String)> = answers
        .iter()
        .filter(|(answer, ..)| seen(*answer) > 0)
        .map(|(_, text, fill, opacity)| (Swatch::Area(fill, *opacity), (*text).to_owned()))
        .collect();
    keys.push((Swatch::Line(INK, false), "P(any breach), as labelled".to_owned()));
    let present = map.present.map(|v| display(across).shown(v));
    let present = present.filter(|v| (x0..=x1).contains(&v));
    let name = "go-map";
    let mut chart = Chart::new(name, TALL, &x, &y, keys, present.is_some());
    for (i, &y) in ys.iter().enumerate() {
        for (j, &x) in xs.iter().enumerate() {
            let Some((estimate, answer)) = map.cells.get(i * xs.len() + j) else { continue };
            let Some((.., fill, opacity)) = answers.iter().find(|(a, ..)| a == answer) else {
                continue;
            };
            let hover = hover((map.first[i], up), (map.second[j], across), estimate);
            chart.bar((x - wide, y - high), (x + wide, y + high), fill, *opacity, hover);
        }
    }
    let blank = Field { xs: xs.clone(), ys: ys.clone(), values: Vec::new() };
    let deviates = blank.map(|j, i| {
        let share = map.cells.get(i * xs.len() + j).and_then(|(estimate, _)| estimate.value);
        let n = map.samples.max(1) as f64;
        share.map_or(f64::NAN, |p| normal::quantile((p * n + 0.5) / (n + 1.0)))
    });
    let levels = map.allowed.iter().chain(CONTOURS.iter().filter(|p| map.allowed != Some(**p)));
    let mut notes: Vec<((f64, f64), String)> = Vec::new();
    for (k, &p) in levels.enumerate() {
        let segments = deviates.contour(normal::quantile(p));
        chart.contour(&segments, INK, if k == 0 { 1.8 } else { 1.0 });
        let wanted = y0 + (y1 - y0) * (0.85 - 0.25 * k as f64);
        let near = (1e-6 * (x1 - x0), 1e-6 * (y1 - y0));
        // The longest first: a short line whose label would stand on another's goes without.
        let mut lines = contour::lines(&segments, near);
        lines.sort_by_key(|line| std::cmp::Reverse(line.len()));
        for (place, line) in lines.iter().enumerate() {
            let longest = place == 0;
            let apart = |at: &(f64, f64), other: &(f64, f64)| {
                (at.0 - other.0).abs() > 0.14 * (x1 - x0)
                    || (at.1 - other.1).abs() > 0.07 * (y1 - y0)
            };
            let clear = |at: &(f64, f64)| {
                present.is_none_or(|v| (at.0 - v).abs() > 2.0 * wide)
                    && notes.iter().all(|(other, _)| apart(at, other))
            };
            let ends = || line.iter().map(|segment| segment[0]);
            let closest = |a: &(f64, f64), b: &(f64, f64)| {
                (a.1 - wanted).abs().total_cmp(&(b.1 - wanted).abs())
            };
            let clear_place = ends().filter(clear).min_by(closest);
            let place = clear_place.or_else(|| ends().filter(|_| longest).min_by(closest));
            notes.extend(place.map(|place| (place, probability(p))));
        }
    }
    for (place, text) in notes {
        chart.note(place, &text);
    }
    if let (Some(at), Some(si)) = (present, map.present) {
        chart.vertical_limit(at, format!("study: {}", value(si, across)));
    }
    let title = format!("Go or no go by {} and {}", map.paths.0, map.paths.1);
    let shown = match (map.allowed, map.confidence) {
        (Some(allowed), Some(confidence)) => format!(
            "Go: P(any breach) ≤ {} is demonstrated at {} confidence given both values; no go: the opposite \
             is; each cell by itself, {} descents in each.",
            probability(allowed),
            probability(confidence),
            count(map.samples)
        ),
        _ => format!(
            "P(any breach) given both values, {} descents in each cell.",
            count(map.samples)
        ),
    };
    let alternative = format!(
        "Map of {} cells: go in {}, undecided in {}, no go in {}.",
        map.cells.len(),
        seen(GoAnswer::Go),
        seen(GoAnswer::Undecided),
        seen(GoAnswer::NoGo)
    );
    let svg = chart.svg(&title, &alternative);
    Some(Figure { name: name.to_owned(), title, caption: shown, alternative, svg })
}

fn hover(first: (f64, Quantity), second: (f64, Quantity), estimate: &Estimate) -> String {
    format!(
        "{}, {}: P {} ({})",
        value(first.0, first.1),
        value(second.0, second.1),
        estimate.value.map_or("unknown".to_owned(), probability),
        probability_interval(&estimate.interval)
    )
}
