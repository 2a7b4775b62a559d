//! What descents look like over the run.

use super::Figure;
use super::axis::Axis;
use super::chart::{BLUE, Chart, HEIGHT, INK};
use super::key::Swatch;
use crate::analysis::Findings;
use crate::descent::OutcomeQuantity;
use crate::findings::{Distribution, Fan, FanBand};
use crate::render::figures_of_speech::count;
use crate::units::{DisplayUnit, Quantity, display};

/// Feet: the paper's unit of line.
const FEET: DisplayUnit = DisplayUnit { symbol: "ft", scale: 1.0 / 0.3048, offset: 0.0 };

/// Line over time; fluid temperature and velocity over line.
pub(super) fn figures(findings: &Findings) -> Vec<Figure> {
    let fan = &findings.figures.fan;
    let seconds = display(Quantity::Time);
    let limit = |outcome: OutcomeQuantity| {
        let all = &findings.figures.distributions;
        all.iter().find(|d| d.outcome == outcome.name())
    };
    let line = |name, title, band, y: DisplayUnit, label: &str, limit| Panel {
        name,
        title,
        band,
        x: FEET,
        x_label: "line paid out (ft)".to_owned(),
        y,
        y_label: format!("{label} ({})", y.symbol),
        limit,
    };
    let panels = [
        Panel {
            name: "fan-line",
            title: "Line paid out over time",
            band: &fan.line_over_time,
            x: seconds,
            x_label: "time since release (s)".to_owned(),
            y: FEET,
            y_label: "line paid out (ft)".to_owned(),
            limit: limit(OutcomeQuantity::Time).map(Mark::Across),
        },
        line(
            "fan-temperature",
            "Fluid temperature over the run",
            &fan.fluid_temperature_over_line,
            display(Quantity::Temperature),
            "fluid temperature",
            limit(OutcomeQuantity::PeakFluidTemperature).map(Mark::Along),
        ),
        line(
            "fan-velocity",
            "Separation velocity over the run",
            &fan.velocity_over_line,
            display(Quantity::Speed),
            "separation velocity",
            limit(OutcomeQuantity::FinalVelocity).map(Mark::AtEnd),
        ),
    ];
    panels.into_iter().filter_map(|panel| panel.figure(fan)).collect()
}

/// Where a limit is drawn.
enum Mark<'a> {
    /// At a value of the abscissa.
    Across(&'a Distribution),
    /// At a value of the ordinate, all along.
    Along(&'a Distribution),
    /// At a value of the ordinate, at the end of the line.
    AtEnd(&'a Distribution),
}

struct Panel<'a> {
    name: &'static str,
    title: &'static str,
    band: &'a FanBand,
    x: DisplayUnit,
    x_label: String,
    y: DisplayUnit,
    y_label: String,
    limit: Option<Mark<'a>>,
}

impl Panel<'_> {
    fn figure(self, fan: &Fan) -> Option<Figure> {
        let places = self.band.abscissa.iter().map(|&x| self.x.shown(x));
        let quantiles: Vec<(f64, [f64; 5])> = places
            .clone()
            .zip(&self.band.quantiles)
            .filter_map(|(x, q)| Some((x, (*q)?.map(|y| self.y.shown(y)))))
            .collect();
        let nominal: Vec<(f64, f64)> = places
            .zip(&self.band.nominal)
            .filter_map(|(x, y)| Some((x, self.y.shown((*y)?))))
            .collect();
        let (first, last) = (quantiles.first()?.0, quantiles.last()?.0);
        let heights = || {
            let bands = quantiles.iter().flat_map(|(_, q)| [q[0], q[4]]);
            let limit = match &self.limit {
                Some(Mark::Along(d) | Mark::AtEnd(d)) => Some(self.y.shown(d.limit_value)),
                _ => None,
            };
            bands.chain(nominal.iter().map(|&(_, y)| y)).chain(limit)
        };
        let low = heights().fold(f64::INFINITY, f64::min);
        let high = heights().fold(f64::NEG_INFINITY, f64::max);
        let across = matches!(&self.limit, Some(Mark::Across(d))
            if (first..=last).contains(&self.x.shown(d.limit_value)));
        let mut keys = vec![
            (Swatch::Line(INK, false), "nominal".to_owned()),
            (Swatch::Line(BLUE, false), "median".to_owned()),
            (Swatch::Area(BLUE, 0.5), "middle 50 %".to_owned()),
            (Swatch::Area(BLUE, 0.25), "middle 90 %".to_owned()),
        ];
        if let Some(Mark::AtEnd(d)) = &self.limit {
            keys.push((
                Swatch::Line(INK, true),
                format!("limit {} at the end of the line", d.limit_text),
            ));
        }
        let x = Axis::linear(self.x_label, first, last);
        let y = Axis::linear(self.y_label, low.min(0.0).max(low), high + 0.05 * (high - low));
        let mut chart = Chart::new(self.name, HEIGHT, &x, &y, keys, across);
        for (inner, opacity) in [(0, 0.25), (1, 0.35)] {
            let band: Vec<(f64, f64, f64)> =
                quantiles.iter().map(|(x, q)| (*x, q[inner], q[4 - inner])).collect();
            chart.band(&band, BLUE, opacity);
        }
        let median: Vec<(f64, f64)> = quantiles.iter().map(|(x, q)| (*x, q[2])).collect();
        // Where both run together, both are seen.
        chart.line(&median, BLUE, 3.4, false);
        chart.line(&nominal, INK, 1.2, false);
        match &self.limit {
            Some(Mark::Across(d)) if across => {
                chart
                    .vertical_limit(self.x.shown(d.limit_value), format!("limit {}", d.limit_text));
            }
            Some(Mark::Along(d)) => {
                let text = format!("limit {}", d.limit_text);
                chart.horizontal_limit(self.y.shown(d.limit_value), &text);
            }
            Some(Mark::AtEnd(d)) => chart.unnamed_limit(self.y.shown(d.limit_value), 0.8),
            _ => {}
        }
        let mut caption = format!(
            "Bands that hold 50 % and 90 % of {} sampled descents.",
            count(fan.trajectories as u64)
        );
        if self.name == "fan-line" {
            caption += " A descent that has ended keeps its whole line out.";
        }
        if fan.not_deployed > 0 {
            caption += &format!(
                " {} of them did not run out their line and count as far as they came.",
                count(fan.not_deployed as u64)
            );
        }
        let ends = quantiles.last()?.1;
        let alternative = format!(
            "Bands of {} over {}; at the right edge the middle 90 % lie between {:.4} and {:.4}.",
            y.label, x.label, ends[0], ends[4]
        );
        let svg = chart.svg(self.title, &alternative);
        Some(Figure {
            name: self.name.to_owned(),
            title: self.title.to_owned(),
            caption,
            alternative,
            svg,
        })
    }
}
