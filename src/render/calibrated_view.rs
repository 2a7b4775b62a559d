//! What a calibration changed, in a reader's words.

use super::figures_of_speech::{bare, count, probability, probability_interval};
use super::trade_view::{percent, points, quantity_of};
use crate::findings::{CalibratedEvent, CalibratedFinding, MovedInput};
use crate::numerics::interval::Estimate;
use crate::units::{display, number};
use serde::Serialize;

/// Inputs named among those that moved P.
const NAMED: usize = 3;

/// What a calibration changed, ready to be laid out.
#[derive(Debug, Serialize)]
pub(super) struct Calibrated {
    /// What is to be read first.
    pub headlines: Vec<String>,
    pub events: Vec<EventRow>,
    pub moved: Vec<MovedRow>,
    pub about: String,
}

#[derive(Debug, Serialize)]
pub(super) struct EventRow {
    pub title: String,
    pub prior: String,
    pub prior_band: String,
    pub posterior: String,
    pub posterior_band: String,
}

#[derive(Debug, Serialize)]
pub(super) struct MovedRow {
    pub path: String,
    pub prior: String,
    pub posterior: String,
    pub shift: String,
    pub spread: String,
    pub effect: String,
}

/// What a calibration changed, in words.
pub(super) fn calibrated(finding: &CalibratedFinding) -> Calibrated {
    let mut headlines = Vec::new();
    if let Some(any) = finding.events.last() {
        let band = |band: Option<(f64, f64)>| {
            band.map_or(String::new(), |ends| {
                format!(" (90 % credible interval {})", band_text(ends))
            })
        };
        headlines.push(format!(
            "P(any breach) was {}{} before the calibration and is {}{} with it.",
            percent(&any.prior),
            band(any.prior_band),
            percent(&any.posterior),
            band(any.posterior_band)
        ));
    }
    let shown = |input: &&MovedInput| {
        input.effect.interval.interval().is_some_and(|i| i.lower * i.upper > 0.0)
    };
    let causes: Vec<String> = finding
        .moved
        .iter()
        .filter(shown)
        .take(NAMED)
        .map(|input| {
            format!(
                "`{}` {} percentage points (mean moved by {} prior standard deviations, spread × {})",
                input.path,
                points(&input.effect),
                number(input.shift, 2),
                number(input.spread, 2)
            )
        })
        .collect();
    if !causes.is_empty() {
        headlines.push(format!("Why it moved, one input at a time: {}.", causes.join("; ")));
    }
    Calibrated {
        headlines,
        events: finding.events.iter().map(event).collect(),
        moved: finding.moved.iter().map(moved).collect(),
        about: format!(
            "Calibrated from {}. Before: the cards {} alone, the same seed and {} samples of either. The \
             effect of an input is P(any breach) minus its value with the input's prior law in place of its posterior \
             one, all else equal, on the same random numbers; an input that is drawn together with \
             others keeps its rank among the rows.",
            finding.calibrated_from,
            finding.prior_cards.join(", "),
            count(finding.samples)
        ),
    }
}

fn band_text((low, high): (f64, f64)) -> String {
    let (low, high) = (probability(low), probability(high));
    if low == high { low } else { format!("{low} … {high}") }
}

fn event(event: &CalibratedEvent) -> EventRow {
    let with = |estimate: &Estimate| {
        format!("{} ({})", percent(estimate), probability_interval(&estimate.interval))
    };
    let band = |band: Option<(f64, f64)>| band.map_or("–".to_owned(), band_text);
    EventRow {
        title: event.title.clone(),
        prior: with(&event.prior),
        prior_band: band(event.prior_band),
        posterior: with(&event.posterior),
        posterior_band: band(event.posterior_band),
    }
}

fn moved(input: &MovedInput) -> MovedRow {
    let quantity = quantity_of(&input.path);
    let unit = display(quantity).symbol;
    let law = |(mean, sd): (f64, f64)| {
        format!("{} ± {} {unit}", bare(mean, quantity), bare(sd, quantity.of_difference()))
            .trim_end()
            .to_owned()
    };
    MovedRow {
        path: format!("`{}`", input.path),
        prior: law(input.prior),
        posterior: law(input.posterior),
        shift: number(input.shift, 2),
        spread: number(input.spread, 2),
        effect: points(&input.effect),
    }
}
