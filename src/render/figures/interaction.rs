//! Where in the plane of the two strongest inputs a breach happens.

use super::Figure;
use super::axis::Axis;
use super::chart::{BLUE, Chart, VERMILLION};
use super::key::Swatch;
use crate::findings::{Interaction, InteractionInput};
use crate::physics::Parameter;
use crate::render::figures_of_speech::count;
use crate::units::{DisplayUnit, Quantity, display};

/// Nearly square: neither input is the cause of the other.
const HEIGHT: f64 = 430.0;

/// The scatter; nothing without a sample.
pub(super) fn figure(interaction: &Interaction) -> Option<Figure> {
    let (x, x_unit) = axis(&interaction.x)?;
    let (y, y_unit) = axis(&interaction.y)?;
    let points = |wanted: bool| -> Vec<(f64, f64)> {
        let values = interaction.x.values.iter().zip(&interaction.y.values);
        values
            .zip(&interaction.breached)
            .filter(|(_, breached)| **breached == wanted)
            .map(|((a, b), _)| (x_unit.shown(*a), y_unit.shown(*b)))
            .collect()
    };
    let (clean, breached) = (points(false), points(true));
    let keys = vec![
        (Swatch::Dot(BLUE), "keeps every limit".to_owned()),
        (Swatch::Dot(VERMILLION), "breaches a limit".to_owned()),
    ];
    let name = "interaction";
    let mut chart = Chart::new(name, HEIGHT, &x, &y, keys, false);
    chart.dots(&clean, BLUE, 1.9, 0.55);
    chart.dots(&breached, VERMILLION, 1.9, 0.75);
    let drawn = interaction.breached.len();
    let mut caption = format!(
        "The first {} samples of the run in the plane of the two inputs with the largest total index of {}; \
         every other input varies too.",
        count((drawn - interaction.added) as u64),
        interaction.output
    );
    if interaction.added > 0 {
        caption += &format!(
            " Breaches are rare: {} of later samples are added, so their share in the picture is not their \
             probability.",
            count(interaction.added as u64)
        );
    }
    let title = format!("Where breaches happen: {} and {}", interaction.x.path, interaction.y.path);
    let alternative = format!(
        "Scatter of {} samples, {} of them breaches.",
        count(drawn as u64),
        count(breached.len() as u64)
    );
    let svg = chart.svg(&title, &alternative);
    Some(Figure { name: name.to_owned(), title, caption, alternative, svg })
}

fn axis(input: &InteractionInput) -> Option<(Axis, DisplayUnit)> {
    let path = input.path.split('[').next().unwrap_or(&input.path);
    let quantity = Parameter::from_path(path).map_or(Quantity::Number, |p| p.info().quantity);
    let unit = display(quantity);
    let values = || input.values.iter().map(|&v| unit.shown(v));
    let low = values().fold(f64::INFINITY, f64::min);
    let high = values().fold(f64::NEG_INFINITY, f64::max);
    if !(low.is_finite() && high.is_finite()) {
        return None;
    }
    let mean = if input.inputs > 1 { format!(", mean of {}", input.inputs) } else { String::new() };
    let symbol = if unit.symbol.is_empty() { String::new() } else { format!(" ({})", unit.symbol) };
    let room = 0.03 * (high - low);
    Some((Axis::linear(format!("{}{mean}{symbol}", input.path), low - room, high + room), unit))
}
