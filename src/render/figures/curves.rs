//! Curves over one abscissa, each with its key: the figures of rig runs and of families of descents.

use super::Figure;
use super::axis::Axis;
use super::chart::{Chart, HEIGHT, PALETTE};
use super::key::Swatch;

/// What captions of quasi-steady curves begin with.
pub(super) const QUASI_STEADY: &str = "Quasi-steady model:";

/// One curve, in the units shown.
pub(super) struct Curve {
    /// Its name in the key; empty for none.
    pub name: String,
    /// Its points.
    pub points: Vec<(f64, f64)>,
    /// Whether it is drawn as dots: measured values.
    pub dots: bool,
}

/// What a figure of curves says.
pub(super) struct Panel<'a> {
    /// File name without ending.
    pub name: &'a str,
    /// Heading.
    pub title: String,
    /// How to read it.
    pub caption: String,
    /// Label of the abscissa.
    pub x: &'a str,
    /// Label of the ordinate.
    pub y: String,
    /// Whether the ordinate begins at zero.
    pub from_zero: bool,
    /// A limit along the panel, in the unit shown, with its label.
    pub limit: Option<(f64, String)>,
}

/// Colours of a family of curves that are in order, cold to warm: Okabe and Ito's, light enough apart in grey.
pub(super) const ORDERED: [&str; 5] = ["#56b4e9", "#0072b2", "#009e73", "#e69f00", "#d55e00"];

/// The figure of some curves; nothing without a point. `ordered` curves take a palette that runs from cold to warm.
pub(super) fn figure(panel: Panel<'_>, curves: &[Curve], ordered: bool) -> Option<Figure> {
    let palette = if ordered { ORDERED } else { PALETTE };
    let points = || curves.iter().flat_map(|curve| &curve.points);
    points().next()?;
    let ends = |read: fn(&(f64, f64)) -> f64| {
        let values = || points().map(read).filter(|value| value.is_finite());
        (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max))
    };
    let ((left, right), (lowest, highest)) = (ends(|p| p.0), ends(|p| p.1));
    // A limit belongs to the picture if the curves come near it.
    let bottom = if panel.from_zero { lowest.min(0.0) } else { lowest };
    let near = |value: f64| value < highest + 0.6 * (highest - bottom) && value > bottom;
    let limit = panel.limit.filter(|(value, _)| near(*value));
    let highest = limit.as_ref().map_or(highest, |(value, _)| value.max(highest));
    let room = 0.06 * (highest - bottom);
    let keys = curves
        .iter()
        .enumerate()
        .filter(|(_, curve)| !curve.name.is_empty())
        .map(|(k, curve)| {
            let colour = palette[k % palette.len()];
            let swatch = if curve.dots {
                Swatch::Dot(colour)
            } else {
                Swatch::Line(colour, k % 2 == 1 && !ordered)
            };
            (swatch, curve.name.clone())
        })
        .collect();
    let x = Axis::linear(panel.x, left, right);
    let low = if panel.from_zero { bottom } else { bottom - room };
    let y = Axis::linear(panel.y, low, highest + room);
    let mut chart = Chart::new(panel.name, HEIGHT, &x, &y, keys, false);
    for (k, curve) in curves.iter().enumerate() {
        let colour = palette[k % palette.len()];
        if curve.dots {
            chart.dots(&curve.points, colour, 2.0, 0.6);
        } else {
            chart.line(&curve.points, colour, 2.2, k % 2 == 1 && !ordered);
        }
    }
    if let Some((value, label)) = &limit {
        chart.horizontal_limit(*value, label);
    }
    let alternative = format!("{} over {}. {}", y.label, x.label, panel.caption);
    let svg = chart.svg(&panel.title, &alternative);
    Some(Figure {
        name: panel.name.to_owned(),
        title: panel.title,
        caption: panel.caption,
        alternative,
        svg,
    })
}
