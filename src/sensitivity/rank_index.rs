//! First-order indices from samples already run, by Chatterjee's ranks.
//!
//! With the rows in ascending order of an input, neighbours nearly share its value, so the mean
//! product of their outcomes estimates the mean square of the conditional mean: S = (mean of
//! yₖyₖ₊₁ − ȳ²)/(mean of y² − ȳ²), the last row followed by the first. Valid for correlated inputs,
//! where it is the share of the variance that knowing the input removes. Source: Gamboa, Gremaud,
//! Klein and Lagnoux, Bernoulli 28 (2022) 2345.

use super::given_data::{GivenData, batched, checked, ordering};
use crate::error::Result;
use crate::numerics::interval::Estimate;

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
        None => batched(data.rows(), confidence, |rows| {
            neighbour_index(&input[rows.clone()], &outcome[rows])
        }),
    });
    Ok(estimates.collect())
}

fn neighbour_index(input: &[f64], outcome: &[f64]) -> f64 {
    let count = outcome.len() as f64;
    let mean = outcome.iter().sum::<f64>() / count;
    let order = ordering(input);
    let next = order.iter().cycle().skip(1);
    let products: f64 =
        order.iter().zip(next).map(|(k, l)| (outcome[*k] - mean) * (outcome[*l] - mean)).sum();
    let squares: f64 = outcome.iter().map(|y| (y - mean) * (y - mean)).sum();
    if squares > 0.0 { products / squares } else { f64::NAN }
}
