//! How the probability of any breach settled.

use super::Figure;
use super::axis::Axis;
use super::chart::{BLUE, Chart, HEIGHT};
use super::key::Swatch;
use crate::findings::Convergence;
use crate::render::figures_of_speech::{count, probability};

/// The running estimate with its interval, against the number of samples; nothing with one checkpoint.
pub(super) fn figure(convergence: &Convergence) -> Option<Figure> {
    let points = &convergence.checkpoints;
    let (first, last) = (points.first()?, points.last()?);
    if points.len() < 2 {
        return None;
    }
    let level = probability(convergence.confidence);
    let ends = points.iter().map(|p| p.interval.unwrap_or((p.probability, p.probability)));
    let lowest = ends.clone().map(|e| e.0).fold(f64::INFINITY, f64::min);
    let highest = ends.map(|e| e.1).fold(0.0, f64::max);
    let allowed = convergence.allowed;
    let (low, high) =
        (lowest.min(allowed.unwrap_or(lowest)), highest.max(allowed.unwrap_or(highest)));
    // Zero belongs to the picture unless it would flatten the band.
    let low = if low < 0.5 * (high - low) { 0.0 } else { low };
    let keys = vec![
        (Swatch::Line(BLUE, false), "estimate".to_owned()),
        (Swatch::Area(BLUE, 0.25), format!("{level} interval")),
    ];
    let x = Axis::counts("samples", first.samples as f64, last.samples as f64);
    let y = Axis::shares("probability of any breach", low, high + 0.06 * (high - low));
    let name = "convergence";
    let mut chart = Chart::new(name, HEIGHT, &x, &y, keys, false);
    let band: Vec<(f64, f64, f64)> =
        points.iter().filter_map(|p| p.interval.map(|(l, u)| (p.samples as f64, l, u))).collect();
    chart.band(&band, BLUE, 0.25);
    let curve: Vec<(f64, f64)> = points.iter().map(|p| (p.samples as f64, p.probability)).collect();
    chart.line(&curve, BLUE, 2.2, false);
    if let Some(allowed) = allowed {
        chart.horizontal_limit(allowed, &format!("allowed {}", probability(allowed)));
    }
    let method = match convergence.method.as_str() {
        "" => "no interval could be made".to_owned(),
        method => method.to_owned(),
    };
    let holds = match convergence.at_every_look {
        true => "which holds at every n at once",
        false => "that a run of n samples would have had",
    };
    let caption =
        format!("The estimate after the first n samples, with the interval ({method}) {holds}.");
    let title = "How the probability of any breach settled".to_owned();
    let alternative = format!(
        "The estimate starts at {} after {} samples and ends at {} after {}.",
        probability(first.probability),
        count(first.samples),
        probability(last.probability),
        count(last.samples)
    );
    let svg = chart.svg(&title, &alternative);
    Some(Figure { name: name.to_owned(), title, caption, alternative, svg })
}
