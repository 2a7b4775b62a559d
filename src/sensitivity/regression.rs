//! Standardised regression and partial correlation coefficients, on values or on ranks.
//!
//! With C the inputs' correlation matrix, c their correlations with the outcome and β = C⁻¹c: βⱼ is the
//! standardised coefficient, R² = β·c the share of the variance that a linear model explains, and
//! βⱼ/√(βⱼ² + (1 − R²)(C⁻¹)ⱼⱼ) the partial correlation. They mean something as far as R² is near one
//! (Saltelli, Chan and Scott, *Sensitivity Analysis*, 2000, §6.6; Helton and Davis, Reliab. Eng. Syst.
//! Saf. 81 (2003) 23).

use super::given_data::{GivenData, checked, from_batches, mid_ranks, over_batches};
use crate::error::Result;
use crate::numerics::interval::Estimate;
use serde::Serialize;
use std::ops::Range;

/// A linear model of one outcome, of values or of ranks.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Regression {
    /// Standardised regression coefficient of each input.
    pub standardized: Vec<Estimate>,
    /// Partial correlation of each input with the outcome, the other inputs held.
    pub partial: Vec<Estimate>,
    /// Share of the variance that the linear model explains.
    pub r_squared: Estimate,
}

/// The coefficients of the values (SRC and PCC).
///
/// # Errors
/// If the confidence is not strictly between 0 and 1.
pub fn regression(data: &GivenData, confidence: f64) -> Result<Regression> {
    of_columns(data, data.inputs(), data.outcome(), confidence)
}

/// The coefficients of the ranks (SRRC and PRCC): for an outcome that is monotone and not linear.
///
/// # Errors
/// If the confidence is not strictly between 0 and 1.
pub fn rank_regression(data: &GivenData, confidence: f64) -> Result<Regression> {
    let inputs: Vec<Vec<f64>> = data.inputs().iter().map(|column| mid_ranks(column)).collect();
    of_columns(data, &inputs, &mid_ranks(data.outcome()), confidence)
}

fn of_columns(
    data: &GivenData,
    inputs: &[Vec<f64>],
    outcome: &[f64],
    confidence: f64,
) -> Result<Regression> {
    checked(confidence)?;
    let rows = data.rows();
    let used: Vec<usize> = (0..inputs.len()).filter(|j| data.why_none(*j).is_none()).collect();
    let columns: Vec<&[f64]> = used.iter().map(|j| inputs[*j].as_slice()).collect();
    let whole = Model::fit(&columns, outcome, 0..rows);
    let batches = over_batches(rows, |range| Model::fit(&columns, outcome, range));
    let estimate = |statistic: &dyn Fn(&Model) -> f64| {
        let of = |model: &Option<Model>| model.as_ref().map_or(f64::NAN, statistic);
        let parts: Vec<f64> = batches.iter().map(of).collect();
        match &whole {
            Some(model) => from_batches(rows, confidence, statistic(model), &parts),
            None => {
                Estimate::none("the inputs depend linearly on each other, or have too few rows")
            }
        }
    };
    let of_input = |j: usize, statistic: fn(&Model, usize) -> f64| match data.why_none(j) {
        Some(why) => Estimate::none(why),
        None => {
            let place = used.iter().take_while(|k| **k < j).count();
            estimate(&|model| statistic(model, place))
        }
    };
    let r_squared = match used.is_empty() {
        true => Estimate::none("the outcome or every input does not vary"),
        false => estimate(&|model| model.r_squared),
    };
    Ok(Regression {
        standardized: (0..inputs.len()).map(|j| of_input(j, |m, k| m.standardized[k])).collect(),
        partial: (0..inputs.len()).map(|j| of_input(j, |m, k| m.partial[k])).collect(),
        r_squared,
    })
}

/// A fitted linear model.
struct Model {
    standardized: Vec<f64>,
    partial: Vec<f64>,
    r_squared: f64,
}

impl Model {
    /// The model of these rows; `None` if the inputs' correlations have no inverse.
    fn fit(inputs: &[&[f64]], outcome: &[f64], rows: Range<usize>) -> Option<Model> {
        let columns: Vec<Vec<f64>> =
            inputs.iter().map(|column| standardised(&column[rows.clone()])).collect();
        let outcome = standardised(&outcome[rows]);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let size = columns.len();
        let mut matrix = vec![0.0; size * size];
        for i in 0..size {
            for j in 0..=i {
                matrix[i * size + j] = dot(&columns[i], &columns[j]);
            }
        }
        let factor = cholesky(matrix, size)?;
        let with_outcome: Vec<f64> = columns.iter().map(|column| dot(column, &outcome)).collect();
        let standardized = solve(&factor, size, &with_outcome);
        let r_squared = dot(&standardized, &with_outcome).min(1.0);
        let partial = (0..size).map(|j| {
            let unit: Vec<f64> = (0..size).map(|k| if k == j { 1.0 } else { 0.0 }).collect();
            let inverse = solve(&factor, size, &unit)[j];
            let beta = standardized[j];
            // An exactly linear outcome leaves nothing to an input without effect but rounding.
            if 1.0 - r_squared < 1e-12 && beta.abs() < 1e-7 {
                return f64::NAN;
            }
            beta / (beta * beta + (1.0 - r_squared) * inverse).sqrt()
        });
        Some(Model { partial: partial.collect(), r_squared, standardized })
    }
}

/// The values less their mean, over the root of their sum of squares; NaN if they do not vary.
fn standardised(values: &[f64]) -> Vec<f64> {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let norm = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>().sqrt();
    values.iter().map(|v| (v - mean) / norm).collect()
}

/// Cholesky factor, lower triangle by rows, of a correlation matrix; `None` unless it is positive
/// definite with a margin above rounding.
fn cholesky(mut matrix: Vec<f64>, size: usize) -> Option<Vec<f64>> {
    for i in 0..size {
        for j in 0..=i {
            let mut sum = matrix[i * size + j];
            for k in 0..j {
                sum -= matrix[i * size + k] * matrix[j * size + k];
            }
            if i != j {
                matrix[i * size + j] = sum / matrix[j * size + j];
            } else if sum > 1e-10 {
                matrix[i * size + i] = sum.sqrt();
            } else {
                return None;
            }
        }
    }
    Some(matrix)
}

/// The solution of the system with this Cholesky factor.
fn solve(factor: &[f64], size: usize, right: &[f64]) -> Vec<f64> {
    let mut x = right.to_vec();
    for i in 0..size {
        for k in 0..i {
            x[i] -= factor[i * size + k] * x[k];
        }
        x[i] /= factor[i * size + i];
    }
    for i in (0..size).rev() {
        for k in i + 1..size {
            x[i] -= factor[k * size + i] * x[k];
        }
        x[i] /= factor[i * size + i];
    }
    x
}
