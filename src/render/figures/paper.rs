//! The paper's own figures 4 to 9, from a descent.

use super::Figure;
use super::axis::Axis;
use super::chart::{BLUE, Chart, HEIGHT, VERMILLION};
use super::curves;
use super::key::Swatch;
use crate::descent::reference::Sample;
use crate::findings::PaperRuns;
use crate::units::{Quantity, display, number};

/// Torque in the paper's unit of force and its unit of the brake's radii's foot.
const POUND_FEET: f64 = 1.0 / (4.448_221_615_260_5 * 0.3048);
/// The part of the run in which the dynamic solution settles, s.
const FIRST_SECONDS: f64 = 2.0;
/// The figure of the fluid's temperature, and the limit that the paper sets it, °F.
const FLUID_TEMPERATURE: u32 = 8;
const PAPER_LIMIT_F: f64 = 450.0;

/// What figures 5 to 9 show: number, file, title, label, reading.
type Curve = (u32, &'static str, &'static str, String, fn(&Sample) -> f64);

/// Figures 4 to 9 of the paper.
pub fn paper_figures(runs: &PaperRuns) -> Vec<Figure> {
    let label = |text: &str, quantity| format!("{text} ({})", display(quantity).symbol);
    let curves: [Curve; 5] = [
        (5, "torque", "Brake torque", "brake torque (lbf·ft)".to_owned(), |s| {
            s.torque_nm * POUND_FEET
        }),
        (6, "reel-speed", "Reel speed", label("reel speed", Quantity::RotationalSpeed), |s| {
            display(Quantity::RotationalSpeed).shown(s.observation[2])
        }),
        (7, "power", "Brake power", label("brake power", Quantity::Power), |s| {
            display(Quantity::Power).shown(s.observation[3])
        }),
        (
            FLUID_TEMPERATURE,
            "fluid-temperature",
            "Fluid temperature",
            label("fluid temperature", Quantity::Temperature),
            |s| display(Quantity::Temperature).shown(s.temperatures_k[0]),
        ),
        (9, "velocity", "Rollout velocity", label("separation velocity", Quantity::Speed), |s| {
            display(Quantity::Speed).shown(s.observation[4])
        }),
    ];
    let along = curves.into_iter().filter_map(|curve| course(runs, curve));
    comparison(runs).into_iter().chain(along).collect()
}

/// Figure 4: reel speed of the dynamic and the steady solution at constant temperature, in the beginning.
fn comparison(runs: &PaperRuns) -> Option<Figure> {
    let unit = display(Quantity::RotationalSpeed);
    let curve = |samples: &[Sample]| -> Vec<(f64, f64)> {
        let early = samples.iter().take_while(|s| s.time_s <= FIRST_SECONDS * 1.3);
        early.map(|s| (s.time_s, unit.shown(s.observation[2]))).collect()
    };
    let dynamic = curve(&runs.constant_temperature.dynamic.samples);
    let steady = curve(&runs.constant_temperature.steady.samples);
    let high = dynamic.iter().chain(&steady).map(|p| p.1).fold(0.0, f64::max);
    let keys = vec![
        (Swatch::Line(BLUE, false), "dynamic".to_owned()),
        (Swatch::Line(VERMILLION, true), "steady".to_owned()),
    ];
    let x = Axis::linear("time since release (s)", 0.0, FIRST_SECONDS);
    let y = Axis::linear(format!("reel speed ({})", unit.symbol), 0.0, 1.08 * high);
    let name = "figure-4-dynamic-and-steady";
    let mut chart = Chart::new(name, HEIGHT, &x, &y, keys, false);
    chart.line(&dynamic, BLUE, 2.2, false);
    chart.line(&steady, VERMILLION, 2.2, true);
    let title = "Figure 4: dynamic and steady solution at constant temperature".to_owned();
    let ends = [&runs.constant_temperature.dynamic, &runs.constant_temperature.steady]
        .map(|run| run.samples.last().map_or(0.0, |sample| sample.time_s));
    let settled = runs
        .settling_time_s()
        .map_or("does not come".to_owned(), |s| format!("comes within {s:.2} s"));
    let caption = format!(
        "The first {FIRST_SECONDS} s of a run in which the fluid is kept at its initial temperature: the \
         dynamic reel speed {settled} to 1 % of the steady one and stays there, of {:.2} s (dynamic) and \
         {:.2} s (steady) in all.",
        ends[0], ends[1]
    );
    let alternative = "The dynamic reel speed rises from zero and joins the steady one.".to_owned();
    let svg = chart.svg(&title, &alternative);
    Some(Figure { name: name.to_owned(), title, caption, alternative, svg })
}

/// One of figures 5 to 9: a reading over time.
fn course(runs: &PaperRuns, (place, name, title, label, read): Curve) -> Option<Figure> {
    let points: Vec<(f64, f64)> =
        runs.descent.samples.iter().map(|s| (s.time_s, read(s))).collect();
    let (first, last) = (points.first()?, points.last()?);
    let top = points.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let low = points.iter().map(|p| p.1).fold(0.0, f64::min);
    let limit = (place == FLUID_TEMPERATURE).then_some(PAPER_LIMIT_F);
    let high = limit.unwrap_or(top.1).max(top.1);
    let name = format!("figure-{place}-{name}");
    let x = Axis::linear("time since release (s)", 0.0, last.0);
    let y = Axis::linear(label, low, high + 0.06 * (high - low));
    let mut chart = Chart::new(&name, HEIGHT, &x, &y, Vec::new(), false);
    chart.line(&points, BLUE, 2.2, false);
    if let Some(limit) = limit {
        chart.horizontal_limit(limit, &format!("limit {limit} °F"));
    }
    let caption = format!(
        "{} from {} at release, at most {} after {} s, to {} at the end.",
        curves::QUASI_STEADY,
        number(first.1, 4),
        number(top.1, 4),
        number(top.0, 3),
        number(last.1, 4)
    );
    let title = format!("Figure {place}: {}", title.to_lowercase());
    let alternative = format!("Curve over the {:.0} s of the run. {caption}", last.0);
    let svg = chart.svg(&title, &alternative);
    Some(Figure { name, title, caption, alternative, svg })
}

/// Figure 10: velocity along the run from several starting temperatures (°F).
pub fn starting_temperature_figure(family: &[(f64, Vec<Sample>)]) -> Option<Figure> {
    let unit = display(Quantity::Speed);
    let curves: Vec<curves::Curve> = family
        .iter()
        .map(|(start, samples)| curves::Curve {
            name: format!("{start:.0} °F"),
            points: samples.iter().map(|s| (s.time_s, unit.shown(s.observation[4]))).collect(),
            dots: false,
        })
        .collect();
    let times: Vec<String> = family
        .iter()
        .filter_map(|(start, samples)| Some((start, samples.last()?.time_s)))
        .map(|(start, time)| format!("{time:.0} s from {start:.0} °F"))
        .collect();
    let panel = curves::Panel {
        name: "figure-10-starting-temperatures",
        title: "Figure 10: velocity from several starting temperatures".to_owned(),
        caption: format!(
            "{} each curve ends with the line, {}.",
            curves::QUASI_STEADY,
            times.join(", ")
        ),
        x: "time since release (s)",
        y: format!("separation velocity ({})", unit.symbol),
        from_zero: true,
        limit: None,
    };
    curves::figure(panel, &curves, true)
}
