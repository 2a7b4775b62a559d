//! What becomes known when, and whether to go, in a reader's words.

use super::figures_of_speech::{bare, count, lies_between, probability, probability_interval};
use super::trade_view::{TradeRow, percent, quantity_of};
use crate::findings::known::{GoAnswer, GoChart, GoMap, KnownFinding};
use crate::numerics::interval::Estimate;
use crate::units::display;
use serde::Serialize;

/// What becomes known when, ready to be laid out.
#[derive(Debug, Serialize)]
pub(super) struct Known {
    pub none: Option<String>,
    pub stages: Vec<String>,
    pub charts: Vec<Chart>,
    pub map: Option<MapTable>,
}

/// A go/no-go map of two measured values.
#[derive(Debug, Serialize)]
pub(super) struct MapTable {
    pub title: String,
    pub about: String,
    /// Values of the second input.
    pub header: Vec<String>,
    pub rows: Vec<TradeRow>,
}

/// A go/no-go chart.
#[derive(Debug, Serialize)]
pub(super) struct Chart {
    pub title: String,
    pub about: String,
    pub rows: Vec<ChartRow>,
}

/// One row of it.
#[derive(Debug, Serialize)]
pub(super) struct ChartRow {
    pub value: String,
    pub cumulative: String,
    pub probability: String,
    pub interval: String,
    pub answer: &'static str,
}

/// What becomes known when, in words.
pub(super) fn known(finding: &KnownFinding) -> Known {
    let stages = finding
        .stages
        .iter()
        .map(|stage| {
            let settled = match (stage.settled.value, stage.settled.interval.interval()) {
                (Some(share), Some(i)) => {
                    format!("{:.3} ({:.3} … {:.3})", share, i.lower, i.upper)
                }
                (Some(share), None) => format!("{share:.3} (no interval)"),
                (None, _) => "an unknown share".to_owned(),
            };
            let at = |share: f64| {
                let found = stage.quantiles.iter().find(|(s, _)| *s == share);
                found.map_or(f64::NAN, |(_, p)| *p)
            };
            let told = match &stage.untold {
                Some(why) => {
                    format!("the share of variance resolved and P(any breach) given it cannot be estimated: {why}")
                }
                None => format!(
                    "a share {settled} of the variance of the breach indicator is resolved; P(any breach) given it {} \
                     in 90 % of cases (median {})",
                    lies_between(at(0.05), at(0.95)),
                    probability(at(0.5))
                ),
            };
            let words = match stage.known {
                "at build" => "Once the brake is built and measured",
                _ => "Once that and the day's measurements are known",
            };
            format!(
                "{words} ({} inputs), {told} ({} sets of values with {} continuations each, corrected for their \
                 sampling error).",
                stage.inputs,
                count(stage.sets as u64),
                stage.continuations
            )
        })
        .collect();
    Known {
        none: finding.none.clone(),
        stages,
        charts: finding.charts.iter().map(chart).collect(),
        map: finding.map.as_ref().map(map),
    }
}

fn map(map: &GoMap) -> MapTable {
    let unit = |path: &str| display(quantity_of(path)).symbol;
    let shown = |path: &str, si: f64| bare(si, quantity_of(path));
    let (first, second) = (&map.paths.0, &map.paths.1);
    let cell = |(estimate, answer): &(Estimate, GoAnswer)| {
        format!("{} {}", percent(estimate), words(*answer))
    };
    // A table has room for so many columns.
    let step = map.second.len().div_ceil(TABLE_COLUMNS).max(1);
    MapTable {
        title: format!("`{first}` ({}) down, `{second}` ({}) across", unit(first), unit(second)),
        about: about(map),
        header: map.second.iter().step_by(step).map(|&si| shown(second, si)).collect(),
        rows: map
            .first
            .iter()
            .zip(map.cells.chunks(map.second.len().max(1)))
            .map(|(&si, cells)| TradeRow {
                name: shown(first, si),
                cells: cells.iter().step_by(step).map(cell).collect(),
            })
            .collect(),
    }
}

/// Most columns of a map's table.
const TABLE_COLUMNS: usize = 11;

fn about(map: &GoMap) -> String {
    let mut about = match (map.allowed, map.confidence) {
        (Some(allowed), Some(confidence)) => format!(
            "Go: P(any breach) ≤ {} is demonstrated at {} confidence given both values; no go: the opposite is, \
             each cell by itself.",
            probability(allowed),
            probability(confidence)
        ),
        _ => "The study requires nothing.".to_owned(),
    };
    about += &format!(
        " {} descents a cell, the same points in every cell; everything else is as uncertain as the card says.",
        count(map.samples)
    );
    if map.lot {
        about += " The second value is that of the lot of fluid at hand, as measured at rest and taken as exact; \
                  what shear does to it stays uncertain.";
    }
    about
}

fn words(answer: GoAnswer) -> &'static str {
    match answer {
        GoAnswer::Go => "go",
        GoAnswer::NoGo => "no go",
        GoAnswer::Undecided => "undecided",
        GoAnswer::NoRequirement => "–",
    }
}

fn chart(chart: &GoChart) -> Chart {
    let quantity = quantity_of(&chart.path);
    let unit = display(quantity).symbol;
    let about = match (chart.allowed, chart.confidence) {
        (Some(allowed), Some(confidence)) => format!(
            "Go: P(any breach) ≤ {} is demonstrated at {} confidence given the measured value; no go: the \
             opposite is. {} descents a row, the same points in every row; everything else is as uncertain \
             as the card says.{}",
            probability(allowed),
            probability(confidence),
            count(chart.samples),
            match chart.go_share {
                Some(0.0) => " There is no value at which to go.".to_owned(),
                Some(share) => format!(
                    " The measured value lies between neighbouring \"go\" rows on {} of days.",
                    probability(share)
                ),
                None => String::new(),
            }
        ),
        _ => format!("{} descents a row; the study requires nothing.", count(chart.samples)),
    };
    Chart {
        title: format!(
            "`{}`{}",
            chart.path,
            if unit.is_empty() { String::new() } else { format!(", {unit}") }
        ),
        about,
        rows: chart
            .rows
            .iter()
            .map(|row| ChartRow {
                value: bare(row.value, quantity),
                cumulative: probability(row.cumulative),
                probability: percent(&row.probability),
                interval: probability_interval(&row.probability.interval),
                answer: words(row.answer),
            })
            .collect(),
    }
}
