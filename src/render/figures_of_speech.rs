//! Numbers as a reader wants them: shares in per cent, values in the paper's units.

use crate::descent::OutcomeQuantity;
use crate::numerics::interval::Earned;
use crate::units::Quantity;
use crate::units::{display, number};

/// Significant digits of an estimate in a report.
const DIGITS: usize = 4;

/// A probability: per cent down to a thousandth of one, then in powers of ten.
pub(super) fn probability(share: f64) -> String {
    if share == 0.0 {
        return "0".to_owned();
    }
    if share < 1e-5 {
        return format!("{share:.2e}");
    }
    format!("{} %", number(100.0 * share, DIGITS))
}

/// Where a probability lies: "lies between 1 % and 2 %", or "is 1 %" where both ends print alike.
pub(super) fn lies_between(low: f64, high: f64) -> String {
    let (low, high) = (probability(low), probability(high));
    if low == high { format!("is {low}") } else { format!("lies between {low} and {high}") }
}

/// Both ends of an interval of a probability, or that there is none.
pub(super) fn probability_interval(interval: &Earned) -> String {
    match interval.interval() {
        Some(i) => format!("{} … {}", probability(i.lower), probability(i.upper)),
        None => "none".to_owned(),
    }
}

/// The upper end of an interval of a probability.
pub(super) fn upper_end(interval: &Earned) -> String {
    interval.interval().map_or("none".to_owned(), |i| probability(i.upper))
}

/// The quantity of an outcome by its name in study files.
pub(super) fn quantity_of(outcome: &str) -> Quantity {
    OutcomeQuantity::from_name(outcome).map_or(Quantity::Number, OutcomeQuantity::quantity)
}

/// A value in the paper's unit, without the unit.
pub(super) fn bare(value_si: f64, quantity: Quantity) -> String {
    number(display(quantity).shown(value_si), DIGITS)
}

/// A value in the paper's unit.
pub(super) fn value(value_si: f64, quantity: Quantity) -> String {
    let symbol = display(quantity).symbol;
    let number = bare(value_si, quantity);
    if symbol.is_empty() { number } else { format!("{number} {symbol}") }
}

/// A value that may not be there.
pub(super) fn maybe(value_si: Option<f64>, quantity: Quantity) -> String {
    value_si.map_or("–".to_owned(), |v| value(v, quantity))
}

/// Both ends of an interval of a value, in the paper's unit.
pub(super) fn value_interval(interval: &Earned, quantity: Quantity) -> String {
    match interval.interval() {
        Some(i) => format!("{} … {}", bare(i.lower, quantity), value(i.upper, quantity)),
        None => "none".to_owned(),
    }
}

/// A whole number in groups of three, held together by no-break spaces: 100 000.
pub(super) fn count(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push('\u{a0}');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_counts_are_grouped_from_the_right() {
        let cases =
            [(0, "0"), (999, "999"), (1000, "1\u{a0}000"), (1234567, "1\u{a0}234\u{a0}567")];
        for (value, text) in cases {
            assert_eq!(count(value), text);
        }
    }

    #[test]
    fn analytic_probabilities_keep_four_digits() {
        assert_eq!(probability(0.401234), "40.12 %");
        assert_eq!(probability(0.00123), "0.123 %");
        assert_eq!(probability(3.2e-7), "3.20e-7");
    }
}
