//! Figures of runs on the horizontal rig: one run, and the three modes side by side.

use super::Figure;
use super::curves::{Curve, Panel, QUASI_STEADY, figure};
use crate::descent::reference::Sample;
use crate::findings::rig::{Comparison, RigRun};
use crate::render::figures_of_speech::value;
use crate::study::MeasuredRun;
use crate::units::{Quantity, display, number};

/// Abscissa of every figure of a run in time.
const TIME: &str = "time since the pull began (s)";

/// How a value is read off a moment, SI.
type Read = fn(&Sample) -> f64;

fn shown(samples: &[Sample], quantity: Quantity, read: fn(&Sample) -> f64) -> Vec<(f64, f64)> {
    let unit = display(quantity);
    let begin = samples.first().map_or(0.0, |s| s.time_s);
    samples.iter().map(|s| (s.time_s - begin, unit.shown(read(s)))).collect()
}

fn label(text: &str, quantity: Quantity) -> String {
    format!("{text} ({})", display(quantity).symbol)
}

/// Measured values of a column beside a run's curve.
fn measured(run: &MeasuredRun, column: Option<&[f64]>, quantity: Quantity) -> Option<Curve> {
    let begin = run.time_s.first().copied().unwrap_or(0.0);
    let unit = display(quantity);
    let points: Vec<(f64, f64)> =
        run.time_s.iter().zip(column?).map(|(t, v)| (t - begin, unit.shown(*v))).collect();
    Some(Curve { name: "measured".to_owned(), points, dots: true })
}

/// Force, speed, power and temperatures along one run, with what was measured of a recorded one.
/// `proof_load_n` and `hottest_k` are drawn as limits.
pub fn rig_figures(
    run: &RigRun,
    record: Option<&MeasuredRun>,
    proof_load_n: f64,
    hottest_k: Option<f64>,
) -> Vec<Figure> {
    let one = |name: &str, points| Curve { name: name.to_owned(), points, dots: false };
    let course = |name, title: &str, quantity, read: fn(&Sample) -> f64, column, limit| {
        let points = shown(&run.samples, quantity, read);
        let named = if record.is_some() { "predicted" } else { "" };
        let seen = record.and_then(|record: &MeasuredRun| measured(record, column, quantity));
        let (top, at) = run.peak(read);
        let begin = run.samples.first().map_or(0.0, |s| s.time_s);
        let peak = match at {
            Some(at) => {
                format!("at most {} after {} s", value(top, quantity), number(at - begin, 4))
            }
            None => format!("{} throughout", value(top, quantity)),
        };
        let caption = format!("{QUASI_STEADY} {peak}.");
        let panel = Panel {
            name,
            title: title.to_owned(),
            caption,
            x: TIME,
            y: label(&title.to_lowercase(), quantity),
            from_zero: true,
            limit,
        };
        let curves: Vec<Curve> = [one(named, points)].into_iter().chain(seen).collect();
        figure(panel, &curves, false)
    };
    let column = |read: fn(&MeasuredRun) -> &Option<Vec<f64>>| {
        record.and_then(|record| read(record).as_deref())
    };
    let force_limit = display(Quantity::Force).shown(proof_load_n);
    let proof = (force_limit, format!("proof load {}", value(proof_load_n, Quantity::Force)));
    let force = course(
        "rig-force",
        "Pull",
        Quantity::Force,
        |s| s.observation[1],
        column(|r| &r.force_n),
        Some(proof),
    );
    let speed = course(
        "rig-speed",
        "Line speed",
        Quantity::Speed,
        |s| s.observation[4],
        column(|r| &r.speed_m_per_s),
        None,
    );
    let power = course("rig-power", "Power", Quantity::Power, |s| s.observation[3], None, None);
    [force, speed, power]
        .into_iter()
        .chain([temperatures(run, record, hottest_k)])
        .flatten()
        .collect()
}

/// The three nodes' temperatures.
fn temperatures(
    run: &RigRun,
    record: Option<&MeasuredRun>,
    hottest_k: Option<f64>,
) -> Option<Figure> {
    let quantity = Quantity::Temperature;
    let reads: [(&str, Read); 3] = [
        ("fluid", |s| s.temperatures_k[0]),
        ("rotors", |s| s.temperatures_k[1]),
        ("housing", |s| s.temperatures_k[2]),
    ];
    let mut curves: Vec<Curve> = reads
        .into_iter()
        .map(|(name, read)| Curve {
            name: name.to_owned(),
            points: shown(&run.samples, quantity, read),
            dots: false,
        })
        .collect();
    if let Some(record) = record {
        for (name, column) in [("fluid", &record.fluid_k), ("housing", &record.housing_k)] {
            let found = measured(record, column.as_deref(), quantity);
            curves.extend(found.map(|curve| Curve { name: format!("{name}, measured"), ..curve }));
        }
    }
    let top = run.peak(|s| s.temperatures_k[0]).0;
    let end = run.samples.last().map_or([f64::NAN; 3], |s| s.temperatures_k);
    let caption = format!(
        "{QUASI_STEADY} the fluid reaches {}; rotors end at {}, the housing at {}.",
        value(top, quantity),
        value(end[1], quantity),
        value(end[2], quantity)
    );
    let limit = hottest_k
        .map(|k| (display(quantity).shown(k), format!("fluid's limit {}", value(k, quantity))));
    let panel = Panel {
        name: "rig-temperatures",
        title: "Temperatures".to_owned(),
        caption,
        x: TIME,
        y: label("temperature", quantity),
        from_zero: false,
        limit,
    };
    figure(panel, &curves, false)
}

/// Force, speed, power and fluid temperature of the three modes.
pub fn rig_mode_figures(comparison: &Comparison) -> Vec<Figure> {
    let course =
        |name, title: &str, what: &str, quantity, read: fn(&Sample) -> f64, zero, limit| {
            let curves: Vec<Curve> = comparison
                .modes
                .iter()
                .map(|mode| Curve {
                    name: format!("constant {}", mode.mode),
                    points: shown(&mode.run.samples, quantity, read),
                    dots: false,
                })
                .collect();
            let levels: Vec<String> = comparison
                .modes
                .iter()
                .zip([Quantity::Force, Quantity::Speed, Quantity::Power])
                .map(|(mode, quantity)| value(mode.level, quantity))
                .collect();
            let panel = Panel {
                name,
                title: title.to_owned(),
                caption: format!("{QUASI_STEADY} held are {}.", levels.join(", ")),
                x: TIME,
                y: label(what, quantity),
                from_zero: zero,
                limit,
            };
            figure(panel, &curves, false)
        };
    let proof = (
        display(Quantity::Force).shown(comparison.proof_load_n),
        format!("proof load {}", value(comparison.proof_load_n, Quantity::Force)),
    );
    let figures = [
        course(
            "rig-modes-force",
            "Rig: pull in the three modes",
            "pull",
            Quantity::Force,
            |s| s.observation[1],
            true,
            Some(proof),
        ),
        course(
            "rig-modes-speed",
            "Rig: line speed in the three modes",
            "line speed",
            Quantity::Speed,
            |s| s.observation[4],
            true,
            None,
        ),
        course(
            "rig-modes-power",
            "Rig: power in the three modes",
            "power",
            Quantity::Power,
            |s| s.observation[3],
            true,
            None,
        ),
        course(
            "rig-modes-fluid",
            "Rig: fluid temperature in the three modes",
            "fluid temperature",
            Quantity::Temperature,
            |s| s.temperatures_k[0],
            false,
            None,
        ),
    ];
    figures.into_iter().flatten().collect()
}
