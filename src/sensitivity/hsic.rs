//! Dependence of an outcome on an input, of any shape, with a test: HSIC on ranks.
//!
//! The Hilbert–Schmidt independence criterion (Gretton et al., *Algorithmic Learning Theory*, 2005; for
//! sensitivity: Da Veiga, J. Stat. Comput. Simul. 85 (2015) 1283) with the kernel Σₘ cos(mπu)·cos(mπv)/m²
//! of the ranks u, v in (0, 1), the first [`WAVES`] terms of the kernel of Blum, Kiefer and Rosenblatt's
//! test of independence. Finite features make it a sum over rows: linear in their number, unchanged by
//! monotone transformations, and blind only to dependence that all low waves miss. Independence is
//! tested by permuting the outcomes.

use super::bootstrap::Resampling;
use super::given_data::{CONSTANT, GivenData, checked, mid_ranks, permutation};
use crate::error::{Error, Result};
use crate::numerics::elementary::cos;
use crate::numerics::interval::{Estimate, Interval};
use crate::numerics::special::normal;
use serde::Serialize;
use std::f64::consts::PI;

/// Terms of the kernel.
pub const WAVES: usize = 6;
/// Bootstrap replicates of the coefficient.
const REPLICATES: usize = 100;
/// Products of one row's features: the means of both, all products, and the squares of each.
const COLUMNS: usize = 1 + 2 * WAVES + 3 * WAVES * WAVES;

/// The dependence of the outcome on one input.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Dependence {
    /// HSIC(x, y)/√(HSIC(x, x)·HSIC(y, y)): 0 for independence, 1 for determination by a monotone
    /// function; less its mean over permuted outcomes, which is what chance alone makes it. An estimate
    /// below zero stands for less dependence than chance makes. The interval is normal with the
    /// bootstrap's standard error.
    pub coefficient: Estimate,
    /// What was taken off.
    pub noise_level: Option<f64>,
    /// Probability of so large a value without any dependence, (1 + exceedances)/(1 + permutations).
    pub p_value: Option<f64>,
    /// Permutations that the p-value is based on: it cannot be smaller than one over one more.
    pub permutations: usize,
}

/// HSIC of the outcome with each input.
///
/// # Errors
/// If there are fewer than 19 permutations, which cannot reject at 5 %, or the confidence is not
/// strictly between 0 and 1.
pub fn hsic(
    data: &GivenData,
    confidence: f64,
    permutations: usize,
    seed: u64,
) -> Result<Vec<Dependence>> {
    checked(confidence)?;
    if permutations < 19 {
        return Err(Error::argument("a permutation test needs at least 19 permutations"));
    }
    let none = |why: &str| Dependence {
        coefficient: Estimate::none(why),
        noise_level: None,
        p_value: None,
        permutations,
    };
    if let Some(why) = (data.rows() < 2).then(|| data.why_none(0)).flatten() {
        return Ok(data.inputs().iter().map(|_| none(why)).collect());
    }
    let resampling = Resampling::new(seed, data.rows(), REPLICATES)?;
    let outcome = Features::of(data.outcome());
    // The orders are the same for every input: their tests then share what chance there is. Inputs without
    // ties have the same ranks in other places, so the same values stand for all of them.
    let orders: Vec<Vec<usize>> =
        (0..permutations).map(|p| permutation(seed, p as u64, data.rows())).collect();
    let by_chance = |input: &Features| -> Vec<f64> {
        orders.iter().map(|order| input.criterion(&outcome, Some(order))).collect()
    };
    let in_order: Vec<f64> = (0..data.rows()).map(|row| row as f64).collect();
    let untied = by_chance(&Features::of(&in_order));
    let of_input = |j: usize| {
        if let Some(why) = data.why_none(j) {
            return none(why);
        }
        let input = Features::of(&data.inputs()[j]);
        let coefficient = coefficient(&input, &outcome, &resampling, confidence);
        let observed = input.criterion(&outcome, None);
        let own = tied(&data.inputs()[j]).then(|| by_chance(&input));
        let by_chance = own.as_ref().unwrap_or(&untied);
        let exceeding = by_chance.iter().filter(|value| **value >= observed).count();
        let sum: f64 = by_chance.iter().sum();
        let noise = coefficient.value.map(|value| value * sum / permutations as f64 / observed);
        let noise_level = noise.filter(|level| level.is_finite());
        Dependence {
            coefficient: less(coefficient, noise_level.unwrap_or(0.0), confidence),
            noise_level,
            p_value: Some((1 + exceeding) as f64 / (1 + permutations) as f64),
            permutations,
        }
    };
    Ok((0..data.inputs().len()).map(of_input).collect())
}

/// Whether two values are the same.
fn tied(values: &[f64]) -> bool {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted.windows(2).any(|pair| pair[0] == pair[1])
}

/// cos(mπu)/m for m = 1 ..= [`WAVES`] of each row's rank u, less their means.
struct Features {
    rows: Vec<[f64; WAVES]>,
}

impl Features {
    fn of(values: &[f64]) -> Self {
        let count = values.len() as f64;
        let waves = |rank: &f64| {
            std::array::from_fn(|m| {
                let m = (m + 1) as f64;
                cos(m * PI * (rank - 0.5) / count) / m
            })
        };
        let mut rows: Vec<[f64; WAVES]> = mid_ranks(values).iter().map(waves).collect();
        for m in 0..WAVES {
            let mean = rows.iter().map(|row| row[m]).sum::<f64>() / count;
            rows.iter_mut().for_each(|row| row[m] -= mean);
        }
        Features { rows }
    }

    /// Sum of squares of the covariances between all features of the two, the other's rows in this
    /// order.
    fn criterion(&self, other: &Features, order: Option<&[usize]>) -> f64 {
        let mut sums = [[0.0; WAVES]; WAVES];
        for (k, x) in self.rows.iter().enumerate() {
            let y = &other.rows[order.map_or(k, |order| order[k])];
            for (sums, x) in sums.iter_mut().zip(x) {
                sums.iter_mut().zip(y).for_each(|(sum, y)| *sum += x * y);
            }
        }
        let count = self.rows.len() as f64;
        sums.iter().flatten().map(|sum| (sum / count) * (sum / count)).sum()
    }
}

/// The estimate less a known bias, with a normal interval in place of the bootstrap's, whose quantiles
/// repeat that bias.
fn less(estimate: Estimate, bias: f64, confidence: f64) -> Estimate {
    let value = estimate.value.map(|value| value - bias);
    let interval = match (value, estimate.standard_error) {
        (Some(value), Some(error)) => {
            let half = normal::quantile_upper((1.0 - confidence) / 2.0) * error;
            let method = "normal, bootstrap standard error";
            Interval { lower: value - half, upper: value + half, confidence, method }.into()
        }
        _ => estimate.interval,
    };
    Estimate { value, interval, standard_error: estimate.standard_error }
}

/// The normalised criterion with its bootstrap standard error.
fn coefficient(x: &Features, y: &Features, resampling: &Resampling, confidence: f64) -> Estimate {
    let mut units = resampling.unit_sums(COLUMNS);
    for (k, (x, y)) in x.rows.iter().zip(&y.rows).enumerate() {
        let sums = units.unit_mut(resampling.unit_of(k));
        let values = std::iter::once(1.0)
            .chain(x.iter().chain(y).copied())
            .chain(x.iter().flat_map(|a| y.iter().map(move |b| a * b)))
            .chain(x.iter().flat_map(|a| x.iter().map(move |b| a * b)))
            .chain(y.iter().flat_map(|a| y.iter().map(move |b| a * b)));
        sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
    }
    let normalised = |sums: &[f64]| {
        let count = sums[0];
        let (x, y) = (&sums[1..=WAVES], &sums[1 + WAVES..=2 * WAVES]);
        let products = |place: usize, a: &[f64], b: &[f64]| -> f64 {
            let block = &sums[1 + 2 * WAVES + place * WAVES * WAVES..][..WAVES * WAVES];
            let covariance =
                |m: usize, l: usize| (block[m * WAVES + l] - a[m] * b[l] / count) / count;
            (0..WAVES * WAVES).map(|i| covariance(i / WAVES, i % WAVES)).map(|c| c * c).sum()
        };
        products(0, x, y) / (products(1, x, x) * products(2, y, y)).sqrt()
    };
    resampling.resample(&units).estimate(confidence, CONSTANT, normalised)
}
