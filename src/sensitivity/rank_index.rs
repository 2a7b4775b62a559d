//! First-order indices from samples already run, by Chatterjee's ranks.
//!
//! With the rows in ascending order of an input, neighbours nearly share its value, so the mean
//! product of their outcomes estimates the mean square of the conditional mean: S = (mean of
//! yₖyₖ₊₁ − ȳ²)/(mean of y² − ȳ²). Valid for correlated inputs, where it is the share of the variance
//! that knowing the input removes. Source: Gamboa, Gremaud, Klein and Lagnoux, Bernoulli 28 (2022) 2345;
//! there the last row is followed by the first, which multiplies the outcomes of both tails: here either
//! end has its one neighbour twice.
//!
//! Neighbours do differ a little, and by much in a heavy tail, which makes the index too small. Neighbours
//! two apart differ by more, so what the index loses with them bounds what it has lost already.

use super::given_data::{BATCHES, GivenData, batched, checked, ordering};
use crate::error::Result;
use crate::numerics::interval::{Earned, Estimate, Interval};

/// Effective rows that a batch must hold for its statistic to be near normal: with half as many an
/// interval for 95 % was measured to hold 86 to 90 % for sums of cubes.
const FEWEST_A_BATCH: f64 = 8.0;
/// Effective neighbours whose products make the index: with fewer, an interval for 95 % was measured to
/// hold 20 to 50 % for a rare event.
const FEWEST_NEIGHBOURS: f64 = 10.0;

/// How the interval is made.
const METHOD: &str =
    "Student t over batches, reaching up by what distance between neighbours may hide";

/// First-order index of the outcome for each input, with the error that batches of the rows show.
/// An estimate below zero stands for an index below its error.
///
/// # Errors
/// If the confidence is not strictly between 0 and 1.
pub fn first_order(data: &GivenData, confidence: f64) -> Result<Vec<Estimate>> {
    checked(confidence)?;
    let outcome = data.outcome();
    let estimates = data.inputs().iter().enumerate().map(|(j, input)| match data.why_none(j) {
        Some(why) => Estimate::none(why),
        None => {
            let index = |rows: std::ops::Range<usize>| {
                neighbour_index(&input[rows.clone()], &outcome[rows]).index
            };
            let estimate = batched(data.rows(), confidence, index);
            let whole = neighbour_index(input, outcome);
            match whole.too_rare() {
                Some(why) => {
                    Estimate { standard_error: None, interval: Earned::none(why), ..estimate }
                }
                None => reaching_up(estimate, whole.lost),
            }
        }
    });
    Ok(estimates.collect())
}

/// The estimate with the upper end of its interval moved up by what distance between neighbours may have
/// taken from it.
fn reaching_up(estimate: Estimate, lost: f64) -> Estimate {
    let interval = match estimate.interval {
        Earned::Interval(interval) => {
            let (upper, method) = (interval.upper + lost, METHOD);
            Interval { upper, method, ..interval }.into()
        }
        none => none,
    };
    Estimate { interval, ..estimate }
}

/// The index, and from how many rows and neighbours it comes as if each gave as much: (Σv)²/Σv² over
/// the squares and over the products' magnitudes.
struct Neighbours {
    index: f64,
    /// By how much it is smaller with neighbours two apart, if it is.
    lost: f64,
    effective_rows: f64,
    effective_neighbours: f64,
}

impl Neighbours {
    fn too_rare(&self) -> Option<String> {
        if self.effective_rows < FEWEST_A_BATCH * BATCHES as f64 {
            let rows = self.effective_rows;
            Some(format!(
                "the variance comes from few rows, as if from {rows:.0}: too few for batches"
            ))
        } else if self.effective_neighbours < FEWEST_NEIGHBOURS {
            Some("too few neighbouring rows have the event both: use a pick-freeze design".into())
        } else {
            None
        }
    }
}

fn neighbour_index(input: &[f64], outcome: &[f64]) -> Neighbours {
    let count = outcome.len() as f64;
    let mean = outcome.iter().sum::<f64>() / count;
    let centred: Vec<f64> = ordering(input).into_iter().map(|k| outcome[k] - mean).collect();
    // Each row with the mean of those so many places before and after it; near an end with the one there is.
    let products = |apart: usize| -> f64 {
        let pairs = centred.iter().zip(centred.iter().skip(apart)).map(|(a, b)| a * b);
        let ends = pairs.clone().take(apart).chain(pairs.clone().rev().take(apart));
        pairs.sum::<f64>() + 0.5 * ends.sum::<f64>()
    };
    let (mut magnitudes, mut product_squares) = (0.0, 0.0);
    for pair in centred.windows(2) {
        let product = pair[0] * pair[1];
        magnitudes += product.abs();
        product_squares += product * product;
    }
    let (mut squares, mut fourths) = (0.0, 0.0);
    for y in outcome {
        let square = (y - mean) * (y - mean);
        squares += square;
        fourths += square * square;
    }
    Neighbours {
        index: if squares > 0.0 { products(1) / squares } else { f64::NAN },
        lost: if squares > 0.0 { ((products(1) - products(2)) / squares).max(0.0) } else { 0.0 },
        effective_rows: squares * squares / fourths,
        effective_neighbours: magnitudes * magnitudes / product_squares,
    }
}
