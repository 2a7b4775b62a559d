//! Derivatives of the breach probabilities with respect to the parameters of the laws, in an engineer's
//! steps.

use super::CONFIDENCE;
use super::trade::{Paired, name_of};
use crate::campaign::common_numbers::Event;
use crate::campaign::trade::{Parameter, TradeOutcomes};
use crate::error::Result;
use crate::numerics::elementary::{exp, ln};
use crate::numerics::interval::{Earned, Estimate, Interval};
use crate::numerics::words::{self, Word};
use crate::study::Study;
use crate::uncertainty::Law;
use crate::units::{Quantity, display, number};
use serde::{Deserialize, Serialize};

/// dP/dθ of one event with respect to one parameter of a factor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DerivativeFinding {
    /// The event: a limit's name, or `any`.
    pub event: String,
    /// Path of the input, or name of the group.
    pub factor: String,
    /// `mean` or `spread`.
    #[serde(deserialize_with = "words::one")]
    pub parameter: Word,
    /// dP/dθ by the score function, per SI unit; of a lognormal law's spread
    /// per unit of the logarithm's standard deviation. Truncation limits are held.
    pub derivative: Estimate,
    /// The same by a central difference with common random numbers, where it was computed.
    pub confirmed: Option<Estimate>,
    /// A step that an engineer would speak of, in the same unit as θ.
    pub step: f64,
    /// The step in words: "0.001 in of standard deviation".
    pub step_text: String,
    /// The change of P for that step: derivative · step.
    pub change: Estimate,
}

/// Every derivative of a study.
pub(super) fn derivatives(
    study: &Study,
    outcomes: &TradeOutcomes<'_>,
    paired: Paired,
) -> Result<Vec<DerivativeFinding>> {
    let events: Vec<(Event, String)> = (0..study.limits.len())
        .map(|i| (Event::Limit(i), study.limits[i].name()))
        .chain([(Event::Any, "any".to_owned())])
        .collect();
    let mut found = Vec::new();
    for scores in &outcomes.scores {
        let factor = &outcomes.factors[scores.factor];
        let Some(input) = factor.columns.first().map(|&j| &study.inputs[j]) else { continue };
        let quantity = input.target.parameter.info().quantity;
        // Parameters of several kinds have no step in common.
        let kind = |&j: &usize| study.inputs[j].target.parameter == input.target.parameter;
        if !factor.columns.iter().all(kind) {
            continue;
        }
        let (step, step_text) = step_of(input.marginal.law(), quantity, scores.parameter);
        let confirmation = outcomes.differences.iter().find(|difference| {
            difference.factor == scores.factor && difference.parameter == scores.parameter
        });
        for (e, (event, name)) in events.iter().enumerate() {
            let derivative = match &scores.sums {
                Err(why) => Estimate::none(why.clone()),
                Ok(sums) => {
                    let mut estimate = sums[e].derivative(CONFIDENCE)?.derivative;
                    if outcomes.replicates > 1 {
                        estimate.standard_error = None;
                        estimate.interval = Earned::none("the points are not independent");
                    }
                    estimate
                }
            };
            let confirmed = match confirmation {
                Some(both) => {
                    let (below, above) = (&both.breaches.0, &both.breaches.1);
                    let difference = paired.difference(below, above, *event)?;
                    Some(scaled(&difference, 0.5 / both.step))
                }
                None => None,
            };
            let change = scaled(confirmed.as_ref().unwrap_or(&derivative), step);
            found.push(DerivativeFinding {
                event: name.clone(),
                factor: factor.name.clone(),
                parameter: name_of(scores.parameter),
                derivative,
                confirmed,
                step,
                step_text: step_text.clone(),
                change,
            });
        }
    }
    Ok(found)
}

/// An estimate multiplied by a positive number.
fn scaled(estimate: &Estimate, by: f64) -> Estimate {
    let interval = match &estimate.interval {
        Earned::Interval(i) => Interval { lower: i.lower * by, upper: i.upper * by, ..*i }.into(),
        none => none.clone(),
    };
    Estimate {
        value: estimate.value.map(|value| value * by),
        standard_error: estimate.standard_error.map(|error| error * by),
        interval,
    }
}

/// A step of a law's parameter that an engineer would speak of, in words with the parameter.
fn step_of(law: &Law, quantity: Quantity, parameter: Parameter) -> (f64, String) {
    let of = match parameter {
        Parameter::Mean => "of mean",
        Parameter::Spread => "of standard deviation",
    };
    let (step, text) = match law {
        Law::Lognormal { .. } if parameter == Parameter::Spread => {
            let step = power_of_ten_below(0.5 * law.spread());
            (step, format!("{} %", number(100.0 * step, 3)))
        }
        law => step_below(0.5 * law.sd(), quantity),
    };
    (step, format!("{text} {of}"))
}

/// The power of ten below a size, in the paper's unit: SI, and in words.
pub(super) fn step_below(size: f64, quantity: Quantity) -> (f64, String) {
    let unit = display(quantity.of_difference());
    let shown = power_of_ten_below(size * unit.scale);
    let text = number(shown, 3);
    let text = if unit.symbol.is_empty() { text } else { format!("{text} {}", unit.symbol) };
    (shown / unit.scale, text)
}

fn power_of_ten_below(x: f64) -> f64 {
    if !(x > 0.0 && x.is_finite()) {
        return 1.0;
    }
    let exponent = (ln(x) / std::f64::consts::LN_10 + 1e-9).floor();
    let power = exp(exponent * std::f64::consts::LN_10);
    // The nearest decimal number: 0.001 and not 0.00100000000000000002.
    format!("{power:.3e}").parse().unwrap_or(power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_a_step_is_a_power_of_ten_in_the_papers_unit() {
        let gap = Law::normal(0.062 * 0.0254, 0.003 * 0.0254).unwrap();
        let (step, text) = step_of(&gap, Quantity::Length, Parameter::Spread);
        assert!((step - 0.001 * 0.0254).abs() < 1e-18, "{step}");
        assert_eq!(text, "0.001 in of standard deviation");
        let factor = Law::lognormal_median_cv(1.0, 0.08).unwrap();
        let (step, text) = step_of(&factor, Quantity::Number, Parameter::Spread);
        assert_eq!((step, text.as_str()), (0.01, "1 % of standard deviation"));
    }
}
