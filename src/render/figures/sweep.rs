//! The design space along one path: outcomes, probabilities, courses.

use super::Figure;
use super::axis::Axis;
use super::chart::{BLUE, Chart, HEIGHT, INK, PALETTE};
use super::key::Swatch;
use super::sweep_map;
use crate::findings::CONFIDENCE;
use crate::findings::sweep::{CourseFinding, LimitFinding, PathFinding, SweepFinding};
use crate::numerics::interval::Estimate;
use crate::render::figures_of_speech::{count, probability, value};
use crate::units::{DisplayUnit, Quantity, display};

/// Colours from cold to hot, dark enough for lines on white and distinct in grey and to colour-blind eyes.
const ORDERED: [&str; 6] = ["#0d2a63", "#1f5fa8", "#3b9bb3", "#a08a12", "#d9731a", "#a3123f"];

/// Every figure of a sweep.
pub fn sweep_figures(sweep: &SweepFinding) -> Vec<Figure> {
    match &sweep.paths[..] {
        [path] => along(sweep, path),
        [first, second] => sweep_map::figures(sweep, first, second),
        _ => Vec::new(),
    }
}

/// What an axis along a path says.
pub(super) fn path_label(path: &PathFinding) -> String {
    let symbol = display(path.quantity).symbol;
    if symbol.is_empty() { path.path.clone() } else { format!("{} ({symbol})", path.path) }
}

fn along(sweep: &SweepFinding, path: &PathFinding) -> Vec<Figure> {
    let unit = display(path.quantity);
    let xs: Vec<f64> = path.values.iter().map(|&x| unit.shown(x)).collect();
    let outcomes = sweep
        .limits
        .iter()
        .enumerate()
        .filter_map(|(k, limit)| outcome(sweep, path, (k, limit), &xs));
    let mut figures: Vec<Figure> = outcomes.collect();
    figures.extend(probabilities(sweep, path, &xs));
    figures.extend(courses(sweep, path));
    figures
}

/// The study's own value as a dashed line, if it lies inside.
fn mark_present(chart: &mut Chart, path: &PathFinding, xs: &[f64]) {
    let present = display(path.quantity).shown(path.present);
    if present_inside(path, xs) {
        chart.vertical_limit(present, format!("study: {}", value(path.present, path.quantity)));
    }
}

fn present_inside(path: &PathFinding, xs: &[f64]) -> bool {
    let present = display(path.quantity).shown(path.present);
    xs.first().is_some_and(|&x| x <= present) && xs.last().is_some_and(|&x| x >= present)
}

/// A limited outcome against the path, with its limit.
fn outcome(
    sweep: &SweepFinding,
    path: &PathFinding,
    (k, limit): (usize, &LimitFinding),
    xs: &[f64],
) -> Option<Figure> {
    let quantity = limit.quantity.quantity();
    let unit = display(quantity);
    let column = limit.quantity.column();
    let nominal: Vec<(f64, f64)> = xs
        .iter()
        .zip(&sweep.cells)
        .filter_map(|(&x, cell)| Some((x, unit.shown(*cell.outcomes.get(&column)?))))
        .collect();
    let bands: Vec<(f64, [f64; 3])> = xs
        .iter()
        .zip(&sweep.cells)
        .filter_map(|(&x, cell)| Some((x, cell.quantiles.get(k).copied()??.map(|v| unit.shown(v)))))
        .collect();
    let heights = || {
        let quantiles = bands.iter().flat_map(|(_, q)| [q[0], q[2]]);
        let stated = (!limit.implied).then(|| unit.shown(limit.value));
        nominal.iter().map(|p| p.1).chain(quantiles).chain(stated)
    };
    let low = heights().fold(f64::INFINITY, f64::min);
    let high = heights().fold(f64::NEG_INFINITY, f64::max);
    let mut keys = vec![(Swatch::Line(INK, false), "nominal".to_owned())];
    if !bands.is_empty() {
        keys.push((Swatch::Line(BLUE, false), "median".to_owned()));
        keys.push((Swatch::Area(BLUE, 0.3), "middle 90 %".to_owned()));
    }
    let room = 0.06 * (high - low);
    let x = Axis::linear(path_label(path), *xs.first()?, *xs.last()?);
    let y_label = format!("{} ({})", limit.quantity.title(), unit.symbol);
    let y = Axis::linear(y_label, low - room, high + room);
    let name = format!("sweep-{}", limit.name.replace('_', "-"));
    let mut chart = Chart::new(&name, HEIGHT, &x, &y, keys, present_inside(path, xs));
    let area: Vec<(f64, f64, f64)> = bands.iter().map(|(x, q)| (*x, q[0], q[2])).collect();
    chart.band(&area, BLUE, 0.3);
    let median: Vec<(f64, f64)> = bands.iter().map(|(x, q)| (*x, q[1])).collect();
    chart.line(&median, BLUE, 3.0, false);
    chart.line(&nominal, INK, 1.6, false);
    if !limit.implied {
        chart.horizontal_limit(unit.shown(limit.value), &format!("limit {}", limit.text));
    }
    mark_present(&mut chart, path, xs);
    let title = format!("{} against {}", capital(limit.quantity.title()), path.path);
    let mut caption = "The nominal descent at each value".to_owned();
    if let Some(samples) = sweep.samples {
        caption += &format!(
            ", and the middle 90 % of {} samples of what the card says is uncertain",
            count(samples)
        );
    }
    let (first, last) = (nominal.first()?, nominal.last()?);
    let alternative = format!(
        "The nominal {} goes from {:.4} {s} at the left end to {:.4} {s} at the right end; {}{}.",
        limit.quantity.title(),
        first.1,
        last.1,
        if limit.implied { "not deployed after " } else { "the limit is " },
        limit.text,
        s = unit.symbol,
    );
    let svg = chart.svg(&title, &alternative);
    Some(Figure { name, title, caption: caption + ".", alternative, svg })
}

pub(super) fn capital(text: &str) -> String {
    let mut characters = text.chars();
    let first = characters.next().map(|c| c.to_uppercase().to_string());
    first.unwrap_or_default() + characters.as_str()
}

/// P of each limit's breach and of any against the path.
fn probabilities(sweep: &SweepFinding, path: &PathFinding, xs: &[f64]) -> Option<Figure> {
    let samples = sweep.samples?;
    let least = 0.5 / samples as f64;
    let mut curves: Vec<(String, &'static str, Vec<&Estimate>)> = Vec::new();
    for (k, limit) in sweep.limits.iter().enumerate() {
        let estimates = sweep.cells.iter().filter_map(|cell| cell.each.get(k)).collect();
        let colour = PALETTE[(k + 1) % PALETTE.len()];
        curves.push((limit.quantity.title().to_owned(), colour, estimates));
    }
    let any = sweep.cells.iter().filter_map(|cell| cell.any.as_ref()).collect();
    curves.push(("any limit".to_owned(), BLUE, any));
    let lowest = curves
        .iter()
        .flat_map(|(_, _, estimates)| estimates.iter().filter_map(|e| e.value))
        .filter(|&p| p > 0.0)
        .fold(0.1, f64::min);
    let floor = lowest.max(least) * 0.5;
    let mut keys: Vec<(Swatch, String)> = curves
        .iter()
        .enumerate()
        .map(|(k, (name, colour, _))| (Swatch::Line(colour, k % 2 == 1), name.clone()))
        .collect();
    keys.push((Swatch::Area(BLUE, 0.25), format!("{} interval", probability(CONFIDENCE))));
    if let Some((allowed, _)) = sweep.required {
        keys.push((Swatch::Line(INK, true), format!("allowed {}", probability(allowed))));
    }
    let x = Axis::linear(path_label(path), *xs.first()?, *xs.last()?);
    let y = Axis::share_decades("probability of a breach", floor, 1.0);
    let name = "sweep-probability";
    let mut chart = Chart::new(name, HEIGHT, &x, &y, keys, present_inside(path, xs));
    for (_, colour, estimates) in &curves {
        let band: Vec<(f64, f64, f64)> = xs
            .iter()
            .zip(estimates)
            .filter_map(|(&x, e)| {
                let i = e.interval.interval()?;
                Some((x, i.lower.max(floor), i.upper.max(floor)))
            })
            .collect();
        chart.band(&band, colour, 0.22);
    }
    for (k, (_, colour, estimates)) in curves.iter().enumerate() {
        // No breach seen is no point of a logarithmic curve: the band says what that leaves open.
        for piece in pieces(xs, estimates) {
            chart.line(&piece, colour, 2.0, k % 2 == 1);
            chart.dots(&piece, colour, 1.8, 1.0);
        }
    }
    if let Some((allowed, _)) = sweep.required.filter(|(allowed, _)| *allowed > floor) {
        chart.unnamed_limit(allowed, 0.0);
    }
    mark_present(&mut chart, path, xs);
    let title = format!("Probability of a breach against {}", path.path);
    let caption = format!(
        "{} samples at each value, the same points at all of them; where none breaches there is no point, \
         and the band reaches up to what that leaves possible.",
        count(samples)
    );
    let best = sweep.best.first().and_then(|best| best.best.value);
    let alternative = match best {
        Some(best) => format!(
            "Curves of P on a logarithmic scale; P(any breach) is least near {}.",
            value(best, path.quantity)
        ),
        None => "Curves of P on a logarithmic scale; P(any breach) has no least value.".to_owned(),
    };
    let svg = chart.svg(&title, &alternative);
    Some(Figure { name: name.to_owned(), title, caption, alternative, svg })
}

/// The stretches of a curve on which P is above zero.
fn pieces(xs: &[f64], estimates: &[&Estimate]) -> Vec<Vec<(f64, f64)>> {
    let mut pieces = vec![Vec::new()];
    for (&x, estimate) in xs.iter().zip(estimates) {
        match estimate.value.filter(|&p| p > 0.0) {
            Some(p) => {
                if let Some(piece) = pieces.last_mut() {
                    piece.push((x, p));
                }
            }
            None => pieces.push(Vec::new()),
        }
    }
    pieces.retain(|piece| !piece.is_empty());
    pieces
}

/// The courses of a few descents along the path: the paper's Figure 10, where the path is the initial
/// temperature.
fn courses(sweep: &SweepFinding, path: &PathFinding) -> Vec<Figure> {
    type Reading = fn(&CourseFinding) -> &[f64];
    let speed: Reading = |course| &course.velocity_m_per_s;
    let temperature: Reading = |course| &course.fluid_temperature_k;
    let panels = [
        (
            "sweep-velocity-courses",
            "Rollout velocity",
            "separation velocity",
            Quantity::Speed,
            speed,
        ),
        (
            "sweep-temperature-courses",
            "Fluid temperature",
            "fluid temperature",
            Quantity::Temperature,
            temperature,
        ),
    ];
    let draw = |(name, heading, label, quantity, read): (&str, &str, &str, Quantity, Reading)| {
        course_figure(sweep, path, (name, heading, label), display(quantity), read)
    };
    panels.into_iter().filter_map(draw).collect()
}

fn course_figure(
    sweep: &SweepFinding,
    path: &PathFinding,
    (name, heading, label): (&str, &str, &str),
    unit: DisplayUnit,
    read: fn(&CourseFinding) -> &[f64],
) -> Option<Figure> {
    let courses = &sweep.courses;
    let longest = courses.iter().filter_map(|c| c.time_s.last()).copied().fold(0.0, f64::max);
    let values = || courses.iter().flat_map(|c| read(c).iter().map(|&v| unit.shown(v)));
    let low = values().fold(f64::INFINITY, f64::min).min(0.0);
    let high = values().fold(f64::NEG_INFINITY, f64::max);
    if courses.len() < 2 {
        return None;
    }
    let colour = |k: usize| ORDERED[k * (ORDERED.len() - 1) / (courses.len() - 1)];
    let keys = courses
        .iter()
        .enumerate()
        .map(|(k, c)| (Swatch::Line(colour(k), k % 2 == 1), value(c.value, path.quantity)))
        .collect();
    let x = Axis::linear("time since release (s)", 0.0, 1.02 * longest);
    let y = Axis::linear(format!("{label} ({})", unit.symbol), low, high + 0.06 * (high - low));
    let mut chart = Chart::new(name, HEIGHT, &x, &y, keys, false);
    for (k, course) in courses.iter().enumerate() {
        let values = read(course).iter().map(|&v| unit.shown(v));
        let points: Vec<(f64, f64)> = course.time_s.iter().copied().zip(values).collect();
        chart.line(&points, colour(k), 2.0, k % 2 == 1);
        // Where a run ends, so that a short one is seen to end and not to be hidden.
        chart.dots(&points[points.len().saturating_sub(1)..], colour(k), 3.2, 1.0);
    }
    let title = format!("{heading} along the run for several values of {}", path.path);
    let ends: Vec<String> = courses
        .iter()
        .filter_map(|c| Some((c.value, *c.time_s.last()?)))
        .map(|(v, t)| format!("{t:.0} s at {}", value(v, path.quantity)))
        .collect();
    let caption = format!("Nominal descents; a dot is the end of the line: {}.", ends.join(", "));
    let alternative = format!("{} curves. {caption}", courses.len());
    let svg = chart.svg(&title, &alternative);
    Some(Figure { name: name.to_owned(), title, caption, alternative, svg })
}
