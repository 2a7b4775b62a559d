//! The paper's own figures 4 to 9, from a descent.

use super::Figure;
use super::axis::Axis;
use super::chart::{BLUE, Chart, HEIGHT, VERMILLION};
use super::key::Swatch;
use crate::descent::reference::Sample;
use crate::findings::PaperRuns;
use crate::units::{Quantity, display};

/// Torque in the paper's unit of force and its unit of the brake's radii's foot.
const POUND_FEET: f64 = 1.0 / (4.448_221_615_260_5 * 0.3048);
/// The part of the run in which the dynamic solution settles, s.
const FIRST_SECONDS: f64 = 2.0;

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
            8,
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
    let settled = settling_time_s(runs)
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

/// The time from which on the dynamic reel speed stays within 1 % of the steady one, s.
fn settling_time_s(runs: &PaperRuns) -> Option<f64> {
    let steady = &runs.constant_temperature.steady.samples;
    let speed_at = |time_s: f64| {
        let k = steady.partition_point(|s| s.time_s < time_s);
        let (before, after) = (steady.get(k.checked_sub(1)?)?, steady.get(k)?);
        let share = (time_s - before.time_s) / (after.time_s - before.time_s);
        Some(before.observation[2] + share * (after.observation[2] - before.observation[2]))
    };
    let apart = |s: &&Sample| {
        speed_at(s.time_s).is_some_and(|steady| (s.observation[2] / steady - 1.0).abs() > 0.01)
    };
    let last_apart = runs.constant_temperature.dynamic.samples.iter().rposition(|s| apart(&s))?;
    runs.constant_temperature.dynamic.samples.get(last_apart + 1).map(|s| s.time_s)
}

/// One of figures 5 to 9: a reading over time.
fn course(runs: &PaperRuns, (number, name, title, label, read): Curve) -> Option<Figure> {
    let points: Vec<(f64, f64)> =
        runs.descent.samples.iter().map(|s| (s.time_s, read(s))).collect();
    let (first, last) = (points.first()?, points.last()?);
    let top = points.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let low = points.iter().map(|p| p.1).fold(0.0, f64::min);
    let name = format!("figure-{number}-{name}");
    let x = Axis::linear("time since release (s)", 0.0, last.0);
    let y = Axis::linear(label, low, top.1 + 0.06 * (top.1 - low));
    let mut chart = Chart::new(&name, HEIGHT, &x, &y, Vec::new(), false);
    chart.line(&points, BLUE, 2.2, false);
    let caption = format!(
        "From {:.4} at release, at most {:.4} after {:.1} s, to {:.4} at the end.",
        first.1, top.1, top.0, last.1
    );
    let title = format!("Figure {number}: {}", title.to_lowercase());
    let alternative = format!("Curve over the {:.0} s of the run. {caption}", last.0);
    let svg = chart.svg(&title, &alternative);
    Some(Figure { name, title, caption, alternative, svg })
}
