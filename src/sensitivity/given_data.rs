//! Samples already run, as the given-data estimators read them.

use crate::error::{Error, Result};
use crate::numerics::interval::{Earned, Estimate, Interval};
use crate::numerics::special::student;
use crate::streams::{Purpose, stream};
use rand::Rng;
use std::ops::Range;

/// Batches from which a standard error is taken.
pub const BATCHES: usize = 25;

/// Rows that a batch must have at least.
const FEWEST_ROWS: usize = 20;

/// Inputs and one outcome of samples already run, without those that could not be computed.
#[derive(Debug, Clone, PartialEq)]
pub struct GivenData {
    inputs: Vec<Vec<f64>>,
    outcome: Vec<f64>,
    left_out: usize,
}

impl GivenData {
    /// The rows whose outcome is a finite number; the others are counted.
    ///
    /// # Errors
    /// If there is no input, a column has another length than the outcome, or an input of a row that
    /// counts is not finite.
    pub fn new(inputs: &[&[f64]], outcome: &[f64]) -> Result<Self> {
        if inputs.is_empty() || inputs.iter().any(|column| column.len() != outcome.len()) {
            return Err(Error::argument("every input needs one value for each outcome"));
        }
        let known: Vec<usize> =
            (0..outcome.len()).filter(|row| outcome[*row].is_finite()).collect();
        let gather = |column: &[f64]| known.iter().map(|row| column[*row]).collect::<Vec<f64>>();
        let data = GivenData {
            inputs: inputs.iter().map(|column| gather(column)).collect(),
            outcome: gather(outcome),
            left_out: outcome.len() - known.len(),
        };
        match data.inputs.iter().position(|column| column.iter().any(|value| !value.is_finite())) {
            Some(j) => Err(Error::argument(format!("input {j} has a value that is not finite"))),
            None => Ok(data),
        }
    }

    /// Rows that count.
    pub fn rows(&self) -> usize {
        self.outcome.len()
    }

    /// Rows left out because their outcome is not known.
    pub fn left_out(&self) -> usize {
        self.left_out
    }

    /// The inputs' columns.
    pub fn inputs(&self) -> &[Vec<f64>] {
        &self.inputs
    }

    /// The outcome's column.
    pub fn outcome(&self) -> &[f64] {
        &self.outcome
    }

    /// Why this outcome and input `j` have no index, if so.
    pub(crate) fn why_none(&self, j: usize) -> Option<&'static str> {
        if self.rows() < 2 {
            Some("no row of the sample has its outcome")
        } else if !varies(self.outcome.iter().copied()) {
            Some(CONSTANT)
        } else if !varies(self.inputs[j].iter().copied()) {
            Some("the input does not vary")
        } else {
            None
        }
    }
}

/// Why an outcome that does not vary has no index.
pub(crate) const CONSTANT: &str = "the outcome does not vary";

/// A range of values that is smaller than this share of the largest of them is rounding.
const ROUNDING: f64 = 1e-12;

/// Whether the finite values differ by more than rounding does.
pub(crate) fn varies(values: impl IntoIterator<Item = f64>) -> bool {
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for value in values.into_iter().filter(|value| value.is_finite()) {
        least = least.min(value);
        most = most.max(value);
    }
    most - least > ROUNDING * least.abs().max(most.abs())
}

/// Row numbers in ascending order of the values, ties in the order of the rows, which are independent.
pub(crate) fn ordering(values: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    order
}

/// Ranks from 1, ties sharing their mean rank.
pub(crate) fn mid_ranks(values: &[f64]) -> Vec<f64> {
    let order = ordering(values);
    let mut ranks = vec![0.0; values.len()];
    let mut first = 0;
    while first < order.len() {
        let tied =
            order[first..].iter().take_while(|row| values[**row] == values[order[first]]).count();
        let rank = first as f64 + (tied as f64 + 1.0) / 2.0;
        order[first..first + tied].iter().for_each(|row| ranks[*row] = rank);
        first += tied;
    }
    ranks
}

/// Row range of part `m` of `parts` nearly equal contiguous ones.
pub(crate) fn part(m: usize, parts: usize, rows: usize) -> Range<usize> {
    m * rows / parts..(m + 1) * rows / parts
}

/// A random order of `0..count`, a pure function of the seed and the index.
pub(crate) fn permutation(seed: u64, index: u64, count: usize) -> Vec<usize> {
    let mut rng = stream(seed, Purpose::Permutation, index);
    let mut order: Vec<usize> = (0..count).collect();
    for last in (1..count).rev() {
        let other = (u128::from(rng.next_u64()) * (last as u128 + 1)) >> 64;
        order.swap(last, other as usize);
    }
    order
}

/// A statistic of all rows with the standard error that disjoint batches of them show: the spread of
/// the batches' statistics over √[`BATCHES`], and Student's t for as many less one. Right for any
/// statistic whose variance falls as one over the rows; a bias that depends on the rows is not in it.
pub(crate) fn batched(
    rows: usize,
    confidence: f64,
    statistic: impl Fn(Range<usize>) -> f64,
) -> Estimate {
    from_batches(rows, confidence, statistic(0..rows), &over_batches(rows, statistic))
}

/// A statistic of each batch; empty if the rows are too few for batches.
pub(crate) fn over_batches<T>(rows: usize, statistic: impl Fn(Range<usize>) -> T) -> Vec<T> {
    if rows < BATCHES * FEWEST_ROWS {
        return Vec::new();
    }
    (0..BATCHES).map(|m| statistic(part(m, BATCHES, rows))).collect()
}

/// The estimate `value` of all rows with the standard error that its values in the batches show.
pub(crate) fn from_batches(rows: usize, confidence: f64, value: f64, parts: &[f64]) -> Estimate {
    if !value.is_finite() {
        return Estimate::none("the index is not defined on this sample");
    }
    let without = |why: String| Estimate {
        value: Some(value),
        standard_error: None,
        interval: Earned::none(why),
    };
    if parts.len() < 2 {
        return without(format!(
            "{rows} rows are too few: {} at least are needed",
            BATCHES * FEWEST_ROWS
        ));
    }
    if parts.iter().any(|value| !value.is_finite()) {
        return without(format!(
            "in some of {BATCHES} batches of the rows the index is not defined"
        ));
    }
    let count = parts.len() as f64;
    let mean = parts.iter().sum::<f64>() / count;
    let squares: f64 = parts.iter().map(|value| (value - mean) * (value - mean)).sum();
    let error = (squares / (count - 1.0) / count).sqrt();
    if error <= 1e-12 * value.abs() {
        return without("every batch of the rows gave the same, so they show no error".into());
    }
    let half = student::quantile_upper(count - 1.0, (1.0 - confidence) / 2.0) * error;
    let (lower, upper) = (value - half, value + half);
    let interval = Interval { lower, upper, confidence, method: "Student t over batches" };
    Estimate { value: Some(value), standard_error: Some(error), interval: interval.into() }
}

/// The confidence, if it lies strictly between 0 and 1.
pub(crate) fn checked(confidence: f64) -> Result<f64> {
    if confidence > 0.0 && confidence < 1.0 {
        Ok(confidence)
    } else {
        Err(Error::argument(format!(
            "a confidence lies strictly between 0 and 1, not {confidence}"
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_ties_share_their_mean_rank() {
        assert_eq!(mid_ranks(&[3.0, 1.0, 3.0, -2.0, 3.0]), [4.0, 2.0, 4.0, 1.0, 4.0]);
        assert_eq!(mid_ranks(&[]), Vec::<f64>::new());
    }

    #[test]
    fn property_a_permutation_holds_every_row_once() {
        let mut order = permutation(3, 1, 1000);
        assert_ne!(order, permutation(3, 2, 1000));
        order.sort_unstable();
        assert!(order.iter().enumerate().all(|(k, row)| k == *row));
    }

    #[test]
    fn property_parts_cover_all_rows_once() {
        let rows: Vec<usize> = (0..7).flat_map(|m| part(m, 7, 45)).collect();
        assert_eq!(rows, (0..45).collect::<Vec<_>>());
    }

    #[test]
    fn property_faults_are_left_out_and_counted() {
        let data = GivenData::new(&[&[1.0, f64::NAN, 3.0]], &[1.0, f64::NAN, 2.0]).unwrap();
        assert_eq!((data.rows(), data.left_out(), &data.inputs()[0][..]), (2, 1, &[1.0, 3.0][..]));
        assert!(GivenData::new(&[&[1.0, f64::NAN]], &[1.0, 2.0]).is_err());
        assert!(GivenData::new(&[&[1.0]], &[1.0, 2.0]).is_err());
        assert!(GivenData::new(&[], &[1.0]).is_err());
    }
}
