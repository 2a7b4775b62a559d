//! What is believed of P(any breach), and the distribution functions that an outcome may have.

use super::Figure;
use super::axis::Axis;
use super::chart::{BLUE, Chart, HEIGHT, INK};
use super::key::Swatch;
use crate::descent::OutcomeQuantity;
use crate::findings::{EpistemicEvent, EpistemicFinding, ProbabilityBox};
use crate::render::figures_of_speech::{lies_between, probability};
use crate::units::display;

/// The belief about P(any breach), then a p-box for every limited outcome.
pub(super) fn figures(finding: &EpistemicFinding) -> Vec<Figure> {
    let any = finding.events.iter().find(|event| event.event == "any");
    any.and_then(belief).into_iter().chain(finding.boxes.iter().filter_map(p_box)).collect()
}

/// Distribution function of the belief about P.
fn belief(event: &EpistemicEvent) -> Option<Figure> {
    let curve: Vec<(f64, f64)> = event.curve.iter().map(|(share, p)| (*p, *share)).collect();
    let (first, last) = (curve.first()?.0, curve.last()?.0);
    if last <= first {
        return None;
    }
    let allowed = event.requirement_met.as_ref().map(|(allowed, _)| *allowed);
    let low = allowed.map_or(first, |a| a.min(first)).min(first);
    let high = last.max(allowed.unwrap_or(last));
    let room = 0.03 * (high - low);
    let inside: Vec<(f64, f64, f64)> = curve
        .iter()
        .filter(|(_, share)| (0.05..=0.95).contains(share))
        .map(|&(p, share)| (p, 0.0, share))
        .collect();
    let mean = event.mean.value;
    let mut keys = vec![
        (Swatch::Line(BLUE, false), "probability that P is at most this".to_owned()),
        (Swatch::Area(BLUE, 0.25), "90 % credible interval".to_owned()),
    ];
    keys.extend(mean.map(|mean| (Swatch::Dot(INK), format!("mean {}", probability(mean)))));
    let x = Axis::shares(
        "probability of any breach, given the constants of the brake",
        (low - room).max(0.0),
        (high + room).min(1.0),
    );
    let y = Axis::shares("epistemic probability", 0.0, 1.04);
    let name = "belief-any";
    let mut chart = Chart::new(name, HEIGHT, &x, &y, keys, allowed.is_some());
    chart.band(&inside, BLUE, 0.25);
    // From nothing to everything: the curve's own ends are at 1 % and 99 %.
    let whole: Vec<(f64, f64)> =
        std::iter::once((first, 0.0)).chain(curve).chain([(last, 1.0)]).collect();
    chart.line(&whole, BLUE, 2.2, false);
    if let Some(mean) = mean {
        chart.dots(&[(mean, 0.02)], INK, 4.2, 1.0);
    }
    if let Some(allowed) = allowed {
        chart.vertical_limit(allowed, format!("allowed {}", probability(allowed)));
    }
    let title = "P(any breach) of this brake".to_owned();
    let caption = "The probability of any breach depends on constants of this brake that are not known. The curve is \
                   the probability, over those constants, that it is at most the value below."
        .to_owned();
    let at =
        |share: f64| event.quantiles.iter().find(|(s, _)| *s == share).and_then(|(_, e)| e.value);
    let alternative = format!(
        "Rising curve; the 90 % credible interval {}{}.",
        lies_between(at(0.05)?, at(0.95)?),
        mean.map_or(String::new(), |mean| format!(", the mean is {}", probability(mean)))
    );
    let svg = chart.svg(&title, &alternative);
    Some(Figure { name: name.to_owned(), title, caption, alternative, svg })
}

/// The distribution functions that an outcome may have.
fn p_box(data: &ProbabilityBox) -> Option<Figure> {
    let outcome = OutcomeQuantity::from_name(data.outcome)?;
    let unit = display(outcome.quantity());
    let places: Vec<f64> = data.thresholds.iter().map(|&t| unit.shown(t)).collect();
    let (first, last) = (*places.first()?, *places.last()?);
    let [(_, low), (_, median), (_, high)] = data.bands.as_slice() else { return None };
    let keys = vec![
        (Swatch::Line(INK, false), "on average".to_owned()),
        (Swatch::Line(BLUE, false), "median".to_owned()),
        (Swatch::Area(BLUE, 0.25), "90 % credible interval".to_owned()),
    ];
    let x = Axis::linear(format!("{} ({})", outcome.title(), unit.symbol), first, last);
    let y = Axis::shares("probability of less", 0.0, 1.02);
    let name = format!("p-box-{}", data.outcome.replace('_', "-"));
    let mut chart = Chart::new(&name, HEIGHT, &x, &y, keys, true);
    let band: Vec<(f64, f64, f64)> =
        places.iter().zip(low.iter().zip(high)).map(|(x, (a, b))| (*x, *a, *b)).collect();
    chart.band(&band, BLUE, 0.25);
    for (curve, stroke, width) in [(median, BLUE, 3.0), (&data.mean, INK, 1.4)] {
        let points: Vec<(f64, f64)> = places.iter().copied().zip(curve.iter().copied()).collect();
        chart.line(&points, stroke, width, false);
    }
    chart.vertical_limit(unit.shown(data.limit), format!("limit {}", data.limit_text));
    let title = format!("P-box of {}", outcome.title());
    let caption = "Each set of constants has its own distribution function; at every value, its 90 % credible interval \
                   is the band. The width is what is not known; the slope is what varies."
        .to_owned();
    let place = data.thresholds.partition_point(|t| *t < data.limit);
    let at = |curve: &[f64]| curve.get(place).or(curve.last()).copied();
    let (low, high, mean) = (at(low)?, at(high)?, at(&data.mean)?);
    let less = match mean {
        1.0 => "every descent with every set of constants has less".to_owned(),
        0.0 => "no descent with any set of constants has less".to_owned(),
        // A band that prints as one value says less than the mean.
        _ if probability(low) == probability(high) && mean > 0.5 => {
            format!("the probability of more is {} on average", probability(1.0 - mean))
        }
        _ if probability(low) == probability(high) => {
            format!("the probability of less is {} on average", probability(mean))
        }
        _ => format!(
            "the probability of less {}, on average {}",
            lies_between(low, high),
            probability(mean)
        ),
    };
    let alternative = format!("Band of rising curves; at the limit {} {less}.", data.limit_text);
    let svg = chart.svg(&title, &alternative);
    Some(Figure { name, title, caption, alternative, svg })
}
