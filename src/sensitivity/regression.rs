//! Standardised regression and partial correlation coefficients, on values or on ranks.
//!
//! With C the inputs' correlation matrix, c their correlations with the outcome and β = C⁻¹c: βⱼ is the
//! standardised coefficient, R² = β·c the share of the variance that a linear model explains, and
//! βⱼ/√(βⱼ² + (1 − R²)(C⁻¹)ⱼⱼ) the partial correlation. They mean something as far as R² is near one
//! (Saltelli, Chan and Scott, *Sensitivity Analysis*, 2000, §6.6; Helton and Davis, Reliab. Eng. Syst.
//! Saf. 81 (2003) 23).
//!
//! Of several inputs g as one they are the standard deviation that these inputs' part of the linear model has,
//! √(βᵍ·Cᵍᵍβᵍ), and the multiple partial correlation √((R² − R²₋ᵍ)/(1 − R²₋ᵍ)), R²₋ᵍ being that of a model
//! without them (Kendall and Stuart, *The Advanced Theory of Statistics* 2, 1979, §27.29): neither has a sign.

use super::given_data::{GivenData, checked, from_batches, mid_ranks, over_batches};
use crate::error::{Error, Result};
use crate::numerics::interval::{Earned, Estimate};
use serde::Serialize;
use std::ops::Range;

/// Why a group's coefficients have no interval.
const NEVER_NEGATIVE: &str =
    "a group's coefficient is never negative, so batches of the rows overstate a small one";

/// A linear model of one outcome, of values or of ranks.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Regression {
    /// Standardised regression coefficient of each factor.
    pub standardized: Vec<Estimate>,
    /// Partial correlation of each factor with the outcome, the other inputs held.
    pub partial: Vec<Estimate>,
    /// Share of the variance that the linear model of all inputs explains.
    pub r_squared: Estimate,
}

/// The coefficients of the values (SRC and PCC) of each factor: the inputs' columns that are taken as one.
///
/// # Errors
/// If the confidence is not strictly between 0 and 1, or a factor names no input or one that is not there.
pub fn regression(data: &GivenData, factors: &[&[usize]], confidence: f64) -> Result<Regression> {
    of_columns(data, factors, data.inputs(), data.outcome(), confidence)
}

/// The coefficients of the ranks (SRRC and PRCC): for an outcome that is monotone and not linear.
///
/// # Errors
/// As [`regression`].
pub fn rank_regression(
    data: &GivenData,
    factors: &[&[usize]],
    confidence: f64,
) -> Result<Regression> {
    let inputs: Vec<Vec<f64>> = data.inputs().iter().map(|column| mid_ranks(column)).collect();
    of_columns(data, factors, &inputs, &mid_ranks(data.outcome()), confidence)
}

fn of_columns(
    data: &GivenData,
    factors: &[&[usize]],
    inputs: &[Vec<f64>],
    outcome: &[f64],
    confidence: f64,
) -> Result<Regression> {
    checked(confidence)?;
    if factors.iter().any(|f| f.is_empty() || f.iter().any(|j| *j >= inputs.len())) {
        return Err(Error::argument(format!(
            "every factor of a regression names inputs below {}, not {factors:?}",
            inputs.len()
        )));
    }
    let rows = data.rows();
    let used: Vec<usize> = (0..inputs.len()).filter(|j| data.why_none(*j).is_none()).collect();
    let columns: Vec<&[f64]> = used.iter().map(|j| inputs[*j].as_slice()).collect();
    // An input that does not vary adds nothing to what its group explains.
    let places = |factor: &&[usize]| -> Vec<usize> {
        factor.iter().filter_map(|j| used.iter().position(|k| k == j)).collect()
    };
    let members: Vec<Vec<usize>> = factors.iter().map(places).collect();
    let whole = Model::fit(&columns, &members, outcome, 0..rows);
    let batches = over_batches(rows, |range| Model::fit(&columns, &members, outcome, range));
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
    let of_factor = |f: usize, statistic: fn(&Model, usize) -> f64| {
        let why = factors[f].iter().filter_map(|j| data.why_none(*j)).next();
        if let Some(why) = why.filter(|_| members[f].is_empty()) {
            return Estimate::none(why);
        }
        let found = estimate(&|model| statistic(model, f));
        match found.value {
            Some(_) if factors[f].len() > 1 => {
                Estimate { standard_error: None, interval: Earned::none(NEVER_NEGATIVE), ..found }
            }
            _ => found,
        }
    };
    let r_squared = match used.is_empty() {
        true => Estimate::none("the outcome or every input does not vary"),
        false => estimate(&|model| model.r_squared),
    };
    Ok(Regression {
        standardized: (0..factors.len()).map(|f| of_factor(f, |m, k| m.standardized[k])).collect(),
        partial: (0..factors.len()).map(|f| of_factor(f, |m, k| m.partial[k])).collect(),
        r_squared,
    })
}

/// A fitted linear model: coefficients by factor.
struct Model {
    standardized: Vec<f64>,
    partial: Vec<f64>,
    r_squared: f64,
}

impl Model {
    /// The model of these rows; `None` if the inputs' correlations have no inverse.
    fn fit(
        inputs: &[&[f64]],
        factors: &[Vec<usize>],
        outcome: &[f64],
        rows: Range<usize>,
    ) -> Option<Model> {
        let columns: Vec<Vec<f64>> =
            inputs.iter().map(|column| standardised(&column[rows.clone()])).collect();
        let outcome = standardised(&outcome[rows]);
        let size = columns.len();
        let mut matrix = vec![0.0; size * size];
        for i in 0..size {
            for j in 0..size {
                matrix[i * size + j] = if j <= i {
                    dot(&columns[i], &columns[j])
                } else {
                    dot(&columns[j], &columns[i])
                };
            }
        }
        let with_outcome: Vec<f64> = columns.iter().map(|column| dot(column, &outcome)).collect();
        let factor = cholesky(matrix.clone(), size)?;
        let beta = solve(&factor, size, &with_outcome);
        let r_squared = dot(&beta, &with_outcome).min(1.0);
        let without = |group: &[usize]| -> Option<f64> {
            let rest: Vec<usize> = (0..size).filter(|j| !group.contains(j)).collect();
            let entry = |k: usize| matrix[rest[k / rest.len()] * size + rest[k % rest.len()]];
            let right: Vec<f64> = rest.iter().map(|j| with_outcome[*j]).collect();
            let factor = cholesky((0..rest.len().pow(2)).map(entry).collect(), rest.len())?;
            Some(dot(&solve(&factor, rest.len(), &right), &right).min(1.0))
        };
        let coefficients = factors.iter().map(|group| match group.as_slice() {
            [j] => {
                let unit: Vec<f64> = (0..size).map(|k| if k == *j { 1.0 } else { 0.0 }).collect();
                let inverse = solve(&factor, size, &unit)[*j];
                let beta = beta[*j];
                // An exactly linear outcome leaves nothing to an input without effect but rounding.
                match 1.0 - r_squared < 1e-12 && beta.abs() < 1e-7 {
                    true => (beta, f64::NAN),
                    false => (beta, beta / (beta * beta + (1.0 - r_squared) * inverse).sqrt()),
                }
            }
            group => {
                let square = |i: &usize| {
                    group.iter().map(|j| beta[*i] * matrix[i * size + j] * beta[*j]).sum::<f64>()
                };
                let variance = group.iter().map(square).sum::<f64>().max(0.0);
                let rest = without(group).unwrap_or(f64::NAN);
                match 1.0 - rest < 1e-12 {
                    true => (variance.sqrt(), f64::NAN),
                    false => (variance.sqrt(), ((r_squared - rest).max(0.0) / (1.0 - rest)).sqrt()),
                }
            }
        });
        let (standardized, partial) = coefficients.unzip();
        Some(Model { standardized, partial, r_squared })
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
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
