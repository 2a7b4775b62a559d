//! Histograms and tails of limited outcomes.

use super::Figure;
use super::axis::Axis;
use super::chart::{BLUE, Chart, HEIGHT, INK, VERMILLION};
use super::key::Swatch;
use crate::descent::OutcomeQuantity;
use crate::findings::{CONFIDENCE, Distribution};
use crate::render::figures_of_speech::{bare, count, probability, value};
use crate::units::display;

/// The outcome of a distribution with its title and the axis label with the unit.
fn outcome(d: &Distribution) -> Option<(OutcomeQuantity, String)> {
    let outcome = OutcomeQuantity::from_name(d.outcome)?;
    let symbol = display(outcome.quantity()).symbol;
    Some((outcome, format!("{} ({symbol})", outcome.title())))
}

/// Samples by value, the breaching ones marked.
pub(super) fn histogram(d: &Distribution) -> Option<Figure> {
    let (outcome, label) = outcome(d)?;
    let unit = display(outcome.quantity());
    let shown = |v: f64| unit.shown(v);
    let (first, last) = (shown(*d.edges.first()?), shown(*d.edges.last()?));
    let limit = shown(d.limit_value);
    // A limit far outside would leave the samples a sliver; the axis then ends before it.
    let room = 0.04 * (last - first);
    let reach = 1.5 * (last - first);
    let near = limit > first - reach && limit < last + reach;
    let (low, high) = match near {
        true => (first.min(limit) - room, last.max(limit) + room),
        false => (first - room, last + room),
    };
    let most = d.counts.iter().copied().max().unwrap_or(1).max(1) as f64;
    let side = if d.upper { "above" } else { "below" };
    let breaches = |k: usize| {
        let middle = 0.5 * (d.edges[k] + d.edges[k + 1]);
        if d.upper { middle > d.limit_value } else { middle < d.limit_value }
    };
    let keys = vec![
        (Swatch::Area(BLUE, 1.0), "keeps the limit".to_owned()),
        (Swatch::Area(VERMILLION, 1.0), "breaches it".to_owned()),
    ];
    let name = format!("histogram-{}", d.limit);
    let x = Axis::linear(label, low, high);
    let y = Axis::linear("samples", 0.0, 1.06 * most);
    let mut chart = Chart::new(&name, HEIGHT, &x, &y, keys, near);
    for (k, &samples) in d.counts.iter().enumerate().filter(|(_, samples)| **samples > 0) {
        let ends = [shown(d.edges[k]), shown(d.edges[k + 1])];
        // A hair between bars, as long as they are wide enough to spare it.
        let gap = 0.06 * (ends[1] - ends[0]);
        let hover = format!(
            "{} to {}: {} samples",
            bare(d.edges[k], outcome.quantity()),
            value(d.edges[k + 1], outcome.quantity()),
            count(samples)
        );
        let fill = if breaches(k) { VERMILLION } else { BLUE };
        chart.bar((ends[0] + gap, 0.0), (ends[1] - gap, samples as f64), fill, 1.0, hover);
    }
    if near {
        chart.vertical_limit(limit, format!("limit {}", d.limit_text));
    }
    let mut caption =
        format!("{} samples in bins that end at the limit of {}.", count(d.samples), d.limit_text);
    if !near {
        caption += " The limit lies beyond the axis.";
    }
    if d.outside != (0, 0) {
        caption += &format!(
            " Not drawn: {} samples below and {} above the axis.",
            count(d.outside.0),
            count(d.outside.1)
        );
    }
    let title = format!("{}: how it is distributed", capital(outcome.title()));
    let alternative = format!(
        "Histogram of {} from {} to {}; samples {side} {} are marked as breaches.",
        outcome.title(),
        bare(*d.edges.first()?, outcome.quantity()),
        value(*d.edges.last()?, outcome.quantity()),
        d.limit_text
    );
    let svg = chart.svg(&title, &alternative);
    Some(Figure { name, title, caption, alternative, svg })
}

/// The probability of lying beyond a value, on a logarithmic scale, with its bands.
pub(super) fn exceedance(d: &Distribution) -> Option<Figure> {
    let (outcome, label) = outcome(d)?;
    let unit = display(outcome.quantity());
    let shown = |v: f64| unit.shown(v);
    let total = (d.samples + d.faults) as f64;
    let floor = 0.3 / total.max(1.0);
    let end = d.exceedance.iter().map(|e| shown(e.value));
    let (low, high) =
        (end.clone().fold(f64::INFINITY, f64::min), end.fold(f64::NEG_INFINITY, f64::max));
    let limit = shown(d.limit_value);
    let near = limit >= low && limit <= high;
    let level = probability(CONFIDENCE);
    let beyond = if d.upper { "above" } else { "below" };
    let mut keys = vec![(Swatch::Line(BLUE, false), "share of the samples".to_owned())];
    let banded = d.exceedance.iter().any(|e| e.interval.is_some());
    if banded {
        keys.push((Swatch::Area(BLUE, 0.25), format!("{level} interval of each value")));
    }
    if d.simultaneous_half_width.is_some() {
        keys.push((Swatch::Line(INK, true), format!("{level} bound of the whole curve")));
    }
    let name = format!("tail-{}", d.limit);
    let x = Axis::linear(label, low, high);
    let y = Axis::share_decades(format!("probability {beyond}"), floor, 1.0);
    let mut chart = Chart::new(&name, HEIGHT, &x, &y, keys, near);
    let band: Vec<(f64, f64, f64)> = d
        .exceedance
        .iter()
        .filter_map(|e| e.interval.map(|(l, u)| (shown(e.value), l.max(floor / 10.0), u)))
        .collect();
    chart.band(&band, BLUE, 0.25);
    if let Some(half) = d.simultaneous_half_width {
        let upper: Vec<(f64, f64)> =
            d.exceedance.iter().map(|e| (shown(e.value), (e.share + half).min(1.0))).collect();
        let lower: Vec<(f64, f64)> = d
            .exceedance
            .iter()
            .map(|e| (shown(e.value), e.share - half))
            .filter(|&(_, share)| share > 0.0)
            .collect();
        chart.line(&upper, INK, 1.2, true);
        chart.line(&lower, INK, 1.2, true);
    }
    let curve: Vec<(f64, f64)> =
        d.exceedance.iter().filter(|e| e.share > 0.0).map(|e| (shown(e.value), e.share)).collect();
    chart.line(&curve, BLUE, 2.2, false);
    if near {
        chart.vertical_limit(limit, format!("limit {}", d.limit_text));
    }
    let mut caption = format!(
        "The probability that the {} lies {beyond} a value, on a logarithmic scale; where the curve crosses \
         the limit it is the probability of a breach.",
        outcome.title()
    );
    match d.why_no_interval {
        Some(why) => caption += &format!(" No band: {why}."),
        None => {
            caption += &format!(
                " Shaded: exact (Clopper–Pearson) {level} interval at each value, which goes on as an upper \
                 bound where no sample went."
            );
        }
    }
    if d.simultaneous_half_width.is_some() {
        caption +=
            " Dashed: the Dvoretzky–Kiefer–Wolfowitz band, which holds for every value at once.";
    }
    let title = format!("{}: the tail", capital(outcome.title()));
    let at_limit = d.exceedance.iter().find(|e| e.value == d.limit_value);
    let crossing = at_limit.map_or(String::new(), |e| {
        format!(" At the limit of {} it is {}.", d.limit_text, probability(e.share))
    });
    let alternative = format!(
        "Curve of the probability of a {} {beyond} a value, falling from 1.{crossing}",
        outcome.title()
    );
    let svg = chart.svg(&title, &alternative);
    Some(Figure { name, title, caption, alternative, svg })
}

/// The first letter in upper case.
fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}
