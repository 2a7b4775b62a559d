//! Bootstrap intervals of statistics that are functions of sums over rows.
//!
//! A replicate draws rows with replacement, which is a weight for each row; a statistic of sums needs
//! only the weighted sums. Contiguous rows are first added up to at most [`MOST_UNITS`] units and the
//! units are resampled: sums of independent rows are independent again, so the replicates' variance
//! keeps its mean, and the cost no longer grows with the rows.
//!
//! Rows of a quasi-Monte Carlo sample are not independent: their true error is mostly smaller than the
//! bootstrap says, never known to be.
//!
//! Sources: Efron, J. Am. Stat. Assoc. 82 (1987) 171, for the bias-corrected and accelerated interval.

use crate::error::{Error, Result};
use crate::numerics::interval::{Earned, Estimate, Interval};
use crate::numerics::special::normal;
use crate::streams::{Purpose, stream};
use rand::Rng;

/// Units that are resampled, at most.
pub const MOST_UNITS: usize = 1024;

/// Fewer units than this earn no interval.
const FEWEST_UNITS: usize = 20;

/// Replicates that a statistic may be undefined in before its interval is refused, as a share.
const UNDEFINED_ALLOWED: f64 = 0.05;

/// Replicates that are summed in one pass over the units: as many accumulators as stay in registers.
const PASS: usize = 4;

/// The weights of all replicates, shared by every outcome of a design.
#[derive(Debug, Clone, PartialEq)]
pub struct Resampling {
    rows: usize,
    units: usize,
    replicates: usize,
    /// `replicates` × `units`, how often a replicate drew a unit.
    weights: Vec<u16>,
}

/// Sums over rows, kept by unit: `columns` numbers a unit.
pub(crate) struct UnitSums {
    columns: usize,
    units: usize,
    sums: Vec<f64>,
}

/// Sums over all rows, in each replicate, and with each unit left out.
pub(crate) struct ResampledSums {
    columns: usize,
    whole: Vec<f64>,
    replicates: Vec<f64>,
    without_one: Vec<f64>,
}

impl Resampling {
    /// Weights for `replicates` replicates of `rows` rows; replicate r is a pure function of the seed
    /// and r, and of the number of rows.
    ///
    /// # Errors
    /// If there is no row, or fewer than 100 replicates.
    pub fn new(seed: u64, rows: usize, replicates: usize) -> Result<Self> {
        if rows == 0 || replicates < 100 {
            return Err(Error::argument("a bootstrap needs rows and at least 100 replicates"));
        }
        let units = rows.min(MOST_UNITS);
        let mut weights = vec![0u16; replicates * units];
        for (r, replicate) in weights.chunks_exact_mut(units).enumerate() {
            let mut rng = stream(seed, Purpose::Bootstrap, r as u64);
            for _ in 0..units {
                // The high word of the product: uniform on 0..units to within 2^-54.
                let unit = (u128::from(rng.next_u64()) * units as u128) >> 64;
                replicate[unit as usize] += 1;
            }
        }
        Ok(Resampling { rows, units, replicates, weights })
    }

    /// Rows that are resampled.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of replicates.
    pub fn replicates(&self) -> usize {
        self.replicates
    }

    /// Empty sums of `columns` numbers.
    pub(crate) fn unit_sums(&self, columns: usize) -> UnitSums {
        UnitSums { columns, units: self.units, sums: vec![0.0; self.units * columns] }
    }

    /// The unit that `row` belongs to.
    pub(crate) fn unit_of(&self, row: usize) -> usize {
        (row as u128 * self.units as u128 / self.rows as u128) as usize
    }

    /// The weighted sums of every replicate.
    pub(crate) fn resample(&self, units: &UnitSums) -> ResampledSums {
        let columns = units.columns;
        let mut whole = vec![0.0; columns];
        for unit in units.sums.chunks_exact(columns) {
            whole.iter_mut().zip(unit).for_each(|(sum, value)| *sum += value);
        }
        let mut without_one = vec![0.0; units.sums.len()];
        for (left, unit) in
            without_one.chunks_exact_mut(columns).zip(units.sums.chunks_exact(columns))
        {
            left.iter_mut()
                .zip(whole.iter().zip(unit))
                .for_each(|(left, (sum, value))| *left = sum - value);
        }
        let mut replicates = vec![0.0; self.replicates * columns];
        let passes =
            replicates.chunks_mut(PASS * columns).zip(self.weights.chunks(PASS * self.units));
        for (sums, weights) in passes {
            if sums.len() == PASS * columns {
                add_weighted(sums, weights, units);
            } else {
                let one_by_one =
                    sums.chunks_exact_mut(columns).zip(weights.chunks_exact(self.units));
                one_by_one.for_each(|(sums, weights)| add_weighted_one(sums, weights, units));
            }
        }
        ResampledSums { columns, whole, replicates, without_one }
    }
}

impl UnitSums {
    /// The sums of one unit, to be added to.
    pub(crate) fn unit_mut(&mut self, unit: usize) -> &mut [f64] {
        &mut self.sums[unit * self.columns..(unit + 1) * self.columns]
    }
}

/// Sums of four replicates in one pass; each is added up in the order of the units.
fn add_weighted(sums: &mut [f64], weights: &[u16], units: &UnitSums) {
    let (columns, count) = (units.columns, units.units);
    let (s0, rest) = sums.split_at_mut(columns);
    let (s1, rest) = rest.split_at_mut(columns);
    let (s2, s3) = rest.split_at_mut(columns);
    for (u, values) in units.sums.chunks_exact(columns).enumerate() {
        let w = [weights[u], weights[count + u], weights[2 * count + u], weights[3 * count + u]];
        let [w0, w1, w2, w3] = w.map(f64::from);
        let targets = s0.iter_mut().zip(s1.iter_mut()).zip(s2.iter_mut().zip(s3.iter_mut()));
        for (value, ((a, b), (c, d))) in values.iter().zip(targets) {
            *a += w0 * value;
            *b += w1 * value;
            *c += w2 * value;
            *d += w3 * value;
        }
    }
}

fn add_weighted_one(sums: &mut [f64], weights: &[u16], units: &UnitSums) {
    for (weight, values) in weights.iter().zip(units.sums.chunks_exact(units.columns)) {
        let weight = f64::from(*weight);
        sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
    }
}

impl ResampledSums {
    /// The sums over all rows.
    pub(crate) fn whole(&self) -> &[f64] {
        &self.whole
    }

    /// The statistic with its bootstrap standard error and BCa interval; `statistic` returns NaN where it
    /// is not defined. A statistic that is the same in every replicate earns no interval: no row saw a
    /// difference, which is not certainty.
    pub(crate) fn estimate(
        &self,
        confidence: f64,
        why_undefined: &str,
        statistic: impl Fn(&[f64]) -> f64,
    ) -> Estimate {
        let value = statistic(&self.whole);
        if !value.is_finite() {
            return Estimate::none(why_undefined);
        }
        let units = self.without_one.len() / self.columns;
        if units < FEWEST_UNITS {
            let why =
                format!("{units} rows are too few to resample: {FEWEST_UNITS} at least are needed");
            return Estimate {
                value: Some(value),
                standard_error: None,
                interval: Earned::none(why),
            };
        }
        let over = |sums: &[f64]| -> Vec<f64> {
            sums.chunks_exact(self.columns).map(&statistic).collect()
        };
        let all = over(&self.replicates);
        let mut replicates: Vec<f64> = all.iter().copied().filter(|v| v.is_finite()).collect();
        if ((all.len() - replicates.len()) as f64) > UNDEFINED_ALLOWED * all.len() as f64 {
            let why = format!(
                "in {} of {} resamples the outcome did not vary: what it is about was seen too rarely",
                all.len() - replicates.len(),
                all.len()
            );
            return Estimate {
                value: Some(value),
                standard_error: None,
                interval: Earned::none(why),
            };
        }
        replicates.sort_unstable_by(f64::total_cmp);
        let error = standard_deviation(&replicates);
        // Sums that are added up in another order differ by rounding; that is not a spread.
        if error <= 1e-12 * value.abs().max(f64::MIN_POSITIVE) || error == 0.0 {
            let why = "every row gave the same, so resampling them shows nothing";
            return Estimate {
                value: Some(value),
                standard_error: None,
                interval: Earned::none(why),
            };
        }
        let jackknife: Vec<f64> =
            over(&self.without_one).into_iter().filter(|v| v.is_finite()).collect();
        let (lower, upper) = bca_ends(value, &replicates, &jackknife, confidence);
        let interval = Interval { lower, upper, confidence, method: "bootstrap, BCa" };
        Estimate { value: Some(value), standard_error: Some(error), interval: interval.into() }
    }
}

/// Standard deviation of at least two values.
fn standard_deviation(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (count - 1.0)).sqrt()
}

/// Ends of the bias-corrected and accelerated interval.
///
/// With z₀ the normal quantile of the share of replicates below the estimate, a the acceleration from
/// the leave-one-out values, the end for normal deviate z is the replicates' quantile
/// Φ(z₀ + (z₀ + z)/(1 − a(z₀ + z))).
pub(crate) fn bca_ends(
    value: f64,
    sorted: &[f64],
    jackknife: &[f64],
    confidence: f64,
) -> (f64, f64) {
    let count = sorted.len() as f64;
    let below = sorted.partition_point(|v| *v < value) as f64;
    let up_to = sorted.partition_point(|v| *v <= value) as f64;
    // Ties count half; no share is 0 or 1, whose quantile is infinite.
    let share = ((below + up_to) / 2.0).clamp(0.5, count - 0.5) / count;
    let bias = normal::quantile(share);
    let acceleration = acceleration(jackknife);
    let z = normal::quantile_upper((1.0 - confidence) / 2.0);
    let end = |z: f64| {
        let shifted = bias + z;
        let scale = 1.0 - acceleration * shifted;
        // An acceleration beyond the deviate itself would turn the interval round.
        let probability = if scale > 0.0 {
            normal::cdf(bias + shifted / scale)
        } else {
            normal::cdf(2.0 * bias + z)
        };
        sorted_quantile(sorted, probability)
    };
    let (lower, upper) = (end(-z), end(z));
    (lower.min(upper), lower.max(upper))
}

/// Σd³/(6(Σd²)^{3/2}) over the leave-one-out values' deviations d from their mean, sign reversed.
fn acceleration(jackknife: &[f64]) -> f64 {
    let mean = jackknife.iter().sum::<f64>() / jackknife.len() as f64;
    let (mut squares, mut cubes) = (0.0, 0.0);
    for value in jackknife {
        let d = mean - value;
        squares += d * d;
        cubes += d * d * d;
    }
    let scale = 6.0 * squares * squares.sqrt();
    if scale > 0.0 { cubes / scale } else { 0.0 }
}

/// The quantile of sorted values at plotting positions k/(n + 1), between the neighbours.
pub(crate) fn sorted_quantile(sorted: &[f64], probability: f64) -> f64 {
    let place = probability * (sorted.len() + 1) as f64;
    let below = (place.floor() as usize).clamp(1, sorted.len());
    let above = (below + 1).min(sorted.len());
    let share = (place - below as f64).clamp(0.0, 1.0);
    let (low, high) = (sorted[below - 1], sorted[above - 1]);
    low + share * (high - low)
}
