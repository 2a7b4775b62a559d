//! What buying down a tolerance is worth: P(any breach) against the spread of each factor.

use super::Figure;
use super::axis::Axis;
use super::chart::{Chart, HEIGHT, PALETTE};
use super::key::Swatch;
use crate::analysis::Findings;
use crate::findings::CONFIDENCE;
use crate::findings::trade::{TradeCurve, TradePoint};
use crate::render::figures_of_speech::probability;
use crate::units::number;

/// Curves drawn in a colour of their own: the ones that move P most.
const SHOWN: usize = 5;

/// P at the card's own spread plus the interval of the difference to it, by common random numbers: what tells
/// the curves from each other. P itself is known to less than that, alike for all of them.
fn band(curve: &TradeCurve) -> Vec<(f64, f64, f64)> {
    let own = curve.points.iter().find(|p| p.difference.interval.why_none().is_some());
    let Some(base) = own.and_then(|point| point.probability.value) else { return Vec::new() };
    let ends = |point: &TradePoint| match point.difference.interval.interval() {
        Some(i) => Some((point.setting, base + i.lower, base + i.upper)),
        None => Some((point.setting, point.probability.value?, point.probability.value?)),
    };
    curve.points.iter().filter_map(ends).collect()
}

/// The curves of the factors whose spread moves P(any breach) most; nothing without a trade.
pub(super) fn figure(findings: &Findings) -> Option<Figure> {
    let curve = |curve: &TradeCurve| -> Vec<(f64, f64)> {
        curve.points.iter().filter_map(|p| Some((p.setting, p.probability.value?))).collect()
    };
    let range = |points: &[(f64, f64)]| {
        let values = || points.iter().map(|p| p.1);
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    };
    let mut curves: Vec<(&TradeCurve, Vec<(f64, f64)>)> = findings
        .trade
        .curves
        .iter()
        .filter(|c| c.parameter == "spread")
        .map(|c| (c, curve(c)))
        .filter(|(_, points)| points.len() > 1)
        .collect();
    curves.sort_by(|a, b| range(&b.1).total_cmp(&range(&a.1)));
    curves.truncate(SHOWN);
    let (strongest, _) = curves.first()?;
    let points = || curves.iter().flat_map(|(_, points)| points);
    let allowed = findings.verdict.reliability.map(|reliability| 1.0 - reliability);
    let ends = |read: fn(&(f64, f64)) -> f64| {
        let low = points().map(read).fold(f64::INFINITY, f64::min);
        (low, points().map(read).fold(f64::NEG_INFINITY, f64::max))
    };
    let ((left, right), (lowest, highest)) = (ends(|p| p.0), ends(|p| p.1));
    let bands = || curves.iter().flat_map(|(curve, _)| band(curve));
    let lowest = bands().map(|(_, low, _)| low).fold(lowest, f64::min).max(0.0);
    let highest = bands().map(|(_, _, high)| high).fold(highest, f64::max);
    // What is allowed belongs to the picture if the curves come anywhere near it.
    let near = allowed.filter(|a| *a > lowest - 3.0 * (highest - lowest));
    let low = near.map_or(lowest, |a| a.min(lowest));
    let high = near.map_or(highest, |a| a.max(highest));
    let keys = curves
        .iter()
        .enumerate()
        .map(|(k, (c, _))| (Swatch::Line(PALETTE[k], k % 2 == 1), c.factor.clone()))
        .collect();
    let (room, side) = (0.08 * (high - low), 0.015 * (right - left));
    let x = Axis::linear("spread over the card's", left - side, right + side);
    let y = Axis::shares("probability of any breach", (low - room).max(0.0), high + room);
    let name = "trade-spread";
    let mut chart = Chart::new(name, HEIGHT + 30.0, &x, &y, keys, false);
    for (k, (curve, _)) in curves.iter().enumerate() {
        chart.band(&band(curve), PALETTE[k], 0.18);
    }
    for (k, (_, points)) in curves.iter().enumerate() {
        chart.line(points, PALETTE[k], 2.2, k % 2 == 1);
        chart.dots(points, PALETTE[k], 3.2, 1.0);
    }
    if let Some(allowed) = near {
        chart.horizontal_limit(allowed, &format!("allowed {}", probability(allowed)));
    }
    let title = "What a tighter tolerance is worth".to_owned();
    let mut caption = format!(
        "P(any breach) when one spread alone is multiplied, for the {} factors that move it most, all on the \
         same random numbers. Shaded: {} interval of the difference to the card's own spread, where the bands meet.",
        curves.len(),
        probability(CONFIDENCE)
    );
    if let (Some(allowed), None) = (allowed, near) {
        caption += &format!(" What is allowed, {}, lies far below the axis.", probability(allowed));
    }
    let alternative = format!(
        "Curves of the probability of any breach over spreads from {} to {} of the card's; the steepest is \
         that of {}.",
        number(left, 3),
        number(right, 3),
        strongest.factor
    );
    let svg = chart.svg(&title, &alternative);
    Some(Figure { name: name.to_owned(), title, caption, alternative, svg })
}
