//! The trade of tolerances and the fair shares, in a reader's words.

use super::figures_of_speech::{bare, count, probability, probability_interval, value};
use crate::findings::derivatives::DerivativeFinding;
use crate::findings::design_value::DesignValueFinding;
use crate::findings::trade::{TighteningFinding, TradeCurve, TradeFinding};
use crate::findings::{Output, ShapleyFinding};
use crate::numerics::interval::Estimate;
use crate::physics::parameters::Parameter;
use crate::units::{Quantity, number};
use serde::Serialize;

/// Derivatives shown of each parameter.
const SHOWN_DERIVATIVES: usize = 4;

/// The trade, ready to be laid out.
#[derive(Debug, Serialize)]
pub(super) struct Trade {
    pub none: Option<String>,
    /// The best tightenings and the best design value, a sentence each.
    pub best: Vec<String>,
    pub about: String,
    /// Header of the spread table: the settings.
    pub spreads: Vec<String>,
    pub spread_rows: Vec<TradeRow>,
    pub shifts: Vec<String>,
    pub shift_rows: Vec<TradeRow>,
    pub derivatives: Vec<DerivativeRow>,
    /// Samples behind the score function.
    pub score_samples: String,
    pub check: Option<String>,
}

/// P(any breach) at the settings of one factor.
#[derive(Debug, Serialize)]
pub(super) struct TradeRow {
    pub name: String,
    pub cells: Vec<String>,
}

/// One derivative.
#[derive(Debug, Serialize)]
pub(super) struct DerivativeRow {
    pub name: String,
    pub step: String,
    pub score: String,
    pub confirmed: String,
}

/// Shapley effects of a breach of any limit, ready to be laid out.
#[derive(Debug, Serialize)]
pub(super) struct Shares {
    pub none: Option<String>,
    pub about: String,
    /// Why those of a breach are not shown.
    pub too_few: Option<String>,
    pub rows: Vec<ShareRow>,
}

/// One factor's share.
#[derive(Debug, Serialize)]
pub(super) struct ShareRow {
    pub name: String,
    pub share: String,
}

/// The Shapley effects in words, the largest first.
pub(super) fn shares(finding: &ShapleyFinding) -> Shares {
    let mut effects: Vec<&(String, Estimate)> = finding
        .outputs
        .iter()
        .filter(|output| output.name == Output::AnyBreach && output.too_few.is_none())
        .flat_map(|output| &output.effects)
        .collect();
    let size = |effect: &(String, Estimate)| effect.1.value.unwrap_or(f64::NEG_INFINITY);
    effects.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let shown = effects.iter().filter(|effect| effect.1.value.is_some());
    let of_breach = finding.outputs.iter().find(|output| output.name == Output::AnyBreach);
    Shares {
        none: finding.none.clone(),
        too_few: of_breach.and_then(|output| output.too_few.clone()),
        about: format!(
            "Shapley effects of a breach of any limit: shares of its variance that add up to one, also where inputs are \
             correlated, by {} permutations ({} descents). Negative values are consistent with zero.",
            count(finding.walks as u64),
            count(finding.descents)
        ),
        rows: shown
            .map(|(name, effect)| ShareRow {
                name: format!("`{name}`"),
                share: match (effect.value, effect.interval.interval()) {
                    (Some(value), Some(i)) => {
                        format!("{value:.3} ({:.3} … {:.3})", i.lower, i.upper)
                    }
                    (Some(value), None) => format!("{value:.3} (no interval)"),
                    (None, _) => "–".to_owned(),
                },
            })
            .collect(),
    }
}

pub(super) fn quantity_of(path: &str) -> Quantity {
    let parameter = path.split('[').next().and_then(Parameter::from_path);
    parameter.map_or(Quantity::Number, |parameter| parameter.info().quantity)
}

pub(super) fn name_of(path: &str, inputs: usize) -> String {
    if inputs == 1 { format!("`{path}`") } else { format!("`{path}`, {inputs} as one") }
}

pub(super) fn percent(estimate: &Estimate) -> String {
    estimate.value.map_or("–".to_owned(), probability)
}

/// A difference of probabilities in percentage points, with its interval.
pub(super) fn points(estimate: &Estimate) -> String {
    let shown = |x: f64| {
        let text = number(100.0 * x, 3);
        if x > 0.0 { format!("+{text}") } else { text.replace('-', "−") }
    };
    match (estimate.value, estimate.interval.interval()) {
        (Some(value), Some(i)) => {
            format!("{} ({} … {})", shown(value), shown(i.lower), shown(i.upper))
        }
        (Some(value), None) => format!("{} (no interval)", shown(value)),
        (None, _) => "–".to_owned(),
    }
}

fn tightening(finding: &TighteningFinding, begin: &str) -> String {
    let begin = if begin.is_empty() { "Halving" } else { begin };
    format!(
        "{begin} the spread of {} takes P(any breach) from {} to {} ({}): {} percentage points.",
        name_of(&finding.factor, finding.inputs),
        percent(&finding.before),
        percent(&finding.after),
        probability_interval(&finding.after.interval),
        points(&finding.difference)
    )
}

fn design_value(finding: &DesignValueFinding) -> String {
    let quantity = quantity_of(&finding.path);
    if finding.best.value.is_none() {
        let why = finding.best.interval.why_none().unwrap_or("it was not found");
        return format!(
            "Without tightening, the optimum of `{}` is not resolved: {why}.",
            finding.path
        );
    }
    let best = match (finding.best.value, finding.best.interval.interval()) {
        (Some(x), Some(i)) => {
            format!(
                "{} ({} … {})",
                value(x, quantity),
                bare(i.lower, quantity),
                value(i.upper, quantity)
            )
        }
        (Some(x), None) => format!("{} (no interval)", value(x, quantity)),
        _ => "not found".to_owned(),
    };
    format!(
        "Without tightening, the optimum of `{}` is {best}: P(any breach) {} ({}) there, {} percentage points \
         against {} now, re-estimated on samples independent of the search.",
        finding.path,
        percent(&finding.probability),
        probability_interval(&finding.probability.interval),
        points(&finding.difference),
        value(finding.present, quantity)
    )
}

/// The trade in words.
pub(super) fn trade(finding: &TradeFinding) -> Trade {
    let nothing = (finding.best.is_empty() && finding.none.is_none()).then(|| {
        "There is no input whose halved spread lowers P(any breach) significantly.".to_owned()
    });
    let best = finding.best.iter().map(|found| tightening(found, "")).chain(nothing);
    let best = best.chain(finding.design.iter().map(design_value));
    let values = finding.design.iter().zip(&finding.at_design);
    let values: Vec<String> =
        values.map(|(found, &at)| value(at, quantity_of(&found.path))).collect();
    let there = format!("At {}, halving", values.join(" and "));
    let there = finding.best_at_design.iter().map(|found| tightening(found, &there));
    let best = best.chain(there).collect();
    let of = |parameter: &str| -> Vec<&TradeCurve> {
        finding.curves.iter().filter(|curve| curve.parameter == parameter).collect()
    };
    let (spreads, spread_rows) = table_of(&of("spread"), false);
    let (shifts, shift_rows) = table_of(&of("mean"), true);
    let half = finding.curves.iter().flat_map(|curve| &curve.points).filter_map(|point| {
        let half = point.difference.interval.interval()?.width() / 2.0;
        half.is_finite().then_some(half)
    });
    let widest = half.fold(0.0, f64::max);
    Trade {
        none: finding.none.clone(),
        best,
        about: format!(
            "P(any breach), computed again at {} of the run's own points through the changed laws (common random \
             numbers): the differences to the base are known to ± {} percentage points or better at 95 %. \
             Truncation limits move with the spread and the mean. All settings with their intervals are in \
             `findings.json`.",
            count(finding.samples),
            number(100.0 * widest, 2)
        ),
        spreads,
        spread_rows,
        shifts,
        shift_rows,
        derivatives: derivatives(finding),
        score_samples: count(finding.score_samples),
        check: check(finding),
    }
}

/// How reweighting compares where its guard lets it pass.
fn check(finding: &TradeFinding) -> Option<String> {
    let (mut passed, mut refused, mut agree, mut wider) = (0u64, 0u64, 0u64, Vec::new());
    for point in finding.curves.iter().flat_map(|curve| &curve.points) {
        let Some(check) = &point.reweighted else { continue };
        if !check.trusted {
            refused += 1;
            continue;
        }
        let Some(error) = check.difference_error else { continue };
        let Some(value) = check.probability.value else { continue };
        let (Some(rerun), Some(own)) = (point.probability.value, point.difference.standard_error)
        else {
            continue;
        };
        passed += 1;
        agree += u64::from((value - rerun).abs() <= 1.96 * (error * error + own * own).sqrt());
        if own > 0.0 {
            wider.push(error / own);
        }
    }
    wider.sort_by(f64::total_cmp);
    let median = wider.get(wider.len() / 2).copied();
    (passed > 0).then(|| {
        format!(
            "Reweighting the run instead, as a check: the guard refuses {refused} of {} settings (too few \
             effective samples, or values never drawn); of the others {agree} of {passed} agree within the \
             95 % error of their difference. Its error of a difference to the base is {} times the rerun's (median), \
             so the reruns are what is shown.",
            passed + refused,
            median.map_or("–".to_owned(), |ratio| number(ratio, 2))
        )
    })
}

/// Settings of the longest curve, and a row for each that has all of them.
fn table_of(curves: &[&TradeCurve], in_deviations: bool) -> (Vec<String>, Vec<TradeRow>) {
    let Some(longest) = curves.iter().max_by_key(|curve| curve.points.len()) else {
        return (Vec::new(), Vec::new());
    };
    let settings = longest.points.len();
    let header = if in_deviations {
        ["−1 sd", "−½ sd", "as is", "+½ sd", "+1 sd"].map(str::to_owned).to_vec()
    } else {
        let points = longest.points.iter();
        points.map(|point| format!("× {}", number(point.setting, 3))).collect()
    };
    let rows = curves
        .iter()
        .filter(|curve| curve.points.len() == settings && settings == header.len())
        .map(|curve| TradeRow {
            name: name_of(&curve.factor, curve.inputs),
            cells: curve.points.iter().map(|point| percent(&point.probability)).collect(),
        })
        .collect();
    (header, rows)
}

fn derivatives(finding: &TradeFinding) -> Vec<DerivativeRow> {
    let of = |parameter: &str| {
        let wanted = |d: &&DerivativeFinding| d.event == "any" && d.parameter == parameter;
        let mut found: Vec<_> = finding.derivatives.iter().filter(wanted).collect();
        let size = |d: &DerivativeFinding| d.change.value.map_or(0.0, f64::abs);
        found.sort_by(|a, b| size(b).total_cmp(&size(a)));
        found.truncate(SHOWN_DERIVATIVES);
        found
    };
    of("spread")
        .into_iter()
        .chain(of("mean"))
        .map(|derivative| {
            let per_step = |estimate: &Estimate| {
                let mut scaled = estimate.clone();
                scaled.value = scaled.value.map(|value| value * derivative.step);
                if let crate::numerics::interval::Earned::Interval(i) = &mut scaled.interval {
                    i.lower *= derivative.step;
                    i.upper *= derivative.step;
                }
                points(&scaled)
            };
            DerivativeRow {
                name: format!("`{}`", derivative.factor),
                step: derivative.step_text.clone(),
                score: per_step(&derivative.derivative),
                confirmed: derivative.confirmed.as_ref().map_or("–".to_owned(), per_step),
            }
        })
        .collect()
}
