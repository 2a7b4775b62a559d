//! Go or no go given two values measured on the day.

use super::Figure;
use super::axis::Axis;
use super::chart::{Chart, GREEN, INK, ORANGE, Swatch, VERMILLION};
use crate::findings::known::{GoAnswer, GoMap};
use crate::physics::Parameter;
use crate::render::figures_of_speech::probability;
use crate::units::{DisplayUnit, Quantity, display};

/// Nearly square: both are measured.
const HEIGHT: f64 = 430.0;

/// The map, a field for every pair of values; nothing with fewer than two values of each.
pub(super) fn figure(map: &GoMap) -> Option<Figure> {
    let (down, across) = (&map.paths.0, &map.paths.1);
    let (x, x_label) = axis(across, &map.second)?;
    let (y, y_label) = axis(down, &map.first)?;
    let fields = [
        (GoAnswer::Go, "go", GREEN, 0.85),
        (GoAnswer::Undecided, "undecided", ORANGE, 0.6),
        (GoAnswer::NoGo, "no go", VERMILLION, 0.35),
        (GoAnswer::NoRequirement, "no requirement", INK, 0.1),
    ];
    let given =
        fields.iter().filter(|field| map.cells.iter().any(|(_, answer)| *answer == field.0));
    let keys =
        given.map(|(_, text, fill, opacity)| (Swatch::Area(fill, *opacity), (*text).to_owned()));
    let (left, right) = (x.first()?.0, x.last()?.1);
    let (low, high) = (y.first()?.0, y.last()?.1);
    let x_axis = Axis::linear(x_label, left, right);
    let y_axis = Axis::linear(y_label, low, high);
    let name = "go-map";
    let mut chart = Chart::new(name, HEIGHT, &x_axis, &y_axis, keys.collect(), false);
    for (&(bottom, top), cells) in y.iter().zip(map.cells.chunks(x.len())) {
        for (&(from, to), (estimate, answer)) in x.iter().zip(cells) {
            let Some((_, text, fill, opacity)) = fields.iter().find(|field| field.0 == *answer)
            else {
                continue;
            };
            let p = estimate.value.map_or("–".to_owned(), probability);
            chart.bar(
                (from, bottom),
                (to, top),
                fill,
                *opacity,
                format!("{text}: P(any breach) {p}"),
            );
        }
    }
    let title = format!("Go or no go, by measured {down} and {across}");
    let caption = "What is demonstrated about P(any breach) once both values are known, everything else as uncertain \
                   as before: a field for each pair of values in the table."
        .to_owned();
    let go = map.cells.iter().filter(|(_, answer)| *answer == GoAnswer::Go).count();
    let alternative = format!("Map of {} by {} fields, {go} of them go.", y.len(), x.len());
    let svg = chart.svg(&title, &alternative);
    Some(Figure { name: name.to_owned(), title, caption, alternative, svg })
}

/// The field about every value, as wide as half the way to its neighbours, and the axis' label.
fn axis(path: &str, values: &[f64]) -> Option<(Vec<(f64, f64)>, String)> {
    let parameter = path.split('[').next().and_then(Parameter::from_path);
    let unit: DisplayUnit = display(parameter.map_or(Quantity::Number, |p| p.info().quantity));
    let shown: Vec<f64> = values.iter().map(|&si| unit.shown(si)).collect();
    if shown.len() < 2 {
        return None;
    }
    let middle = |k: usize| 0.5 * (shown[k] + shown[k + 1]);
    let last = shown.len() - 1;
    let field = |k: usize| match k {
        0 => (2.0 * shown[0] - middle(0), middle(0)),
        k if k == last => (middle(k - 1), 2.0 * shown[k] - middle(k - 1)),
        k => (middle(k - 1), middle(k)),
    };
    let symbol = if unit.symbol.is_empty() { String::new() } else { format!(" ({})", unit.symbol) };
    Some(((0..shown.len()).map(field).collect(), format!("measured {path}{symbol}")))
}
