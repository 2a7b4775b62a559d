//! Which unknown carries how much of the band: Sobol' indices of P(e).

use super::inner::{Inner, NestedEvent};
use super::{Blocks, NestedState};
use crate::error::{Error, Result};
use crate::numerics::columns::Columns;
use crate::numerics::interval::{Earned, Estimate};
use crate::reliability::draws::open_uniform;
use crate::reliability::jackknife::delete_a_group;
use crate::streams::{Purpose, stream};

/// Groups of rows from which the errors are read.
const GROUPS: usize = 20;

/// Margins at a pick-freeze design of the unknowns with inner points.
#[derive(Debug, Clone)]
pub struct ShareSample {
    rows: usize,
    inner: Inner,
    factors: usize,
    /// Which factors are all of the unknowns.
    whole: Vec<bool>,
    margins: Columns,
}

impl ShareSample {
    /// Points in all.
    pub fn points(&self) -> usize {
        self.margins.rows()
    }
}

/// How much of the variance of P(e) each factor carries.
#[derive(Debug, Clone, PartialEq)]
pub struct Shares {
    /// Variance of P(e) by the same sample.
    pub variance: f64,
    /// First order: what is settled, on average, by knowing the factor alone.
    pub first: Vec<Estimate>,
    /// Total: what is left if everything else is known.
    pub total: Vec<Estimate>,
}

/// Inner samples of a row: A with the first, A with the second, B with either, then every factor's with the second.
const FIXED: usize = 4;

/// The half whose points a block has.
fn side_of(block: usize) -> usize {
    usize::from(block == 1 || block >= FIXED - 1)
}

/// Margins at `rows` rows of a pick-freeze design of the unknowns, `inner` points each: two independent points A and B
/// of the unknowns and, for each factor (places of coordinates), A with the factor from B. A and B see two
/// halves of what varies; the others see the second.
///
/// Row k is a pure function of (seed, k).
///
/// # Errors
/// If a factor names a coordinate that is not an unknown one, there are fewer than 40 rows or no point, or the system fails.
pub fn share_sample(
    state: &dyn NestedState,
    factors: &[Vec<usize>],
    rows: usize,
    inner: usize,
    seed: u64,
) -> Result<ShareSample> {
    let unknown = state.unknown();
    if rows < 2 * GROUPS || inner == 0 {
        return Err(Error::argument(format!("shares need {} rows and a point", 2 * GROUPS)));
    }
    if factors.iter().flatten().any(|j| !unknown.contains(j)) {
        return Err(Error::argument("a factor of the unknowns is made of unknown coordinates"));
    }
    let inner = Inner::new(state, inner)?;
    let blocks_a_row = FIXED + factors.len();
    let mut margins = Columns::new(rows * blocks_a_row * inner.size(), state.limits());
    let mut blocks = Blocks::new(state, &mut margins);
    for row in 0..rows {
        let mut random = stream(seed, Purpose::UnknownShares, row as u64);
        let mut draw =
            || -> Vec<f64> { unknown.iter().map(|_| open_uniform(&mut random)).collect() };
        let (a, b) = (draw(), draw());
        let [one, two] = [0, 1].map(|side| {
            let index = 2 * row as u64 + side;
            inner.points(side as usize, seed, Purpose::VaryingShares, index)
        });
        for (unknown, points) in [(&a, &one), (&a, &two), (&b, &one), (&b, &two)] {
            blocks.push(unknown, inner.varying(), points)?;
        }
        for factor in factors {
            let mixed: Vec<f64> = unknown
                .iter()
                .enumerate()
                .map(|(m, j)| if factor.contains(j) { b[m] } else { a[m] })
                .collect();
            blocks.push(&mixed, inner.varying(), &two)?;
        }
    }
    blocks.finish()?;
    let whole = factors.iter().map(|f| unknown.iter().all(|j| f.contains(j))).collect();
    Ok(ShareSample { rows, inner, factors: factors.len(), whole, margins })
}

/// Variance, first-order and total indices.
type Indices = (f64, Vec<f64>, Vec<f64>);

/// Sums over some rows: what variance and indices are made from.
#[derive(Debug, Clone)]
struct Sums {
    rows: f64,
    mean: f64,
    /// Sum of the products of A's halves and of B's, halved.
    square: f64,
    first: Vec<f64>,
    total: Vec<f64>,
}

impl Sums {
    fn none(factors: usize) -> Self {
        let zeros = vec![0.0; factors];
        Sums { rows: 0.0, mean: 0.0, square: 0.0, first: zeros.clone(), total: zeros }
    }

    fn add(&mut self, other: &Sums, sign: f64) {
        self.rows += sign * other.rows;
        self.mean += sign * other.mean;
        self.square += sign * other.square;
        for (sum, x) in self.first.iter_mut().zip(&other.first) {
            *sum += sign * x;
        }
        for (sum, x) in self.total.iter_mut().zip(&other.total) {
            *sum += sign * x;
        }
    }

    /// Variance, first-order and total indices.
    fn indices(&self) -> Indices {
        let mean = self.mean / self.rows;
        // Products are about a centre near the mean; what is left of it is taken off.
        let variance = self.square / self.rows - mean * mean;
        let over = |sums: &[f64]| sums.iter().map(|sum| sum / self.rows / variance).collect();
        (variance, over(&self.first), over(&self.total))
    }
}

/// Sobol' indices of the conditional probability of `event` over the factors of the unknowns.
///
/// Every product is of shares from independent inner samples, so the inner sampling biases nothing: E[(P(A) − c) (P(A) −
/// P(A with j from B))] is the total variance of factor j and E[(P(B) − c) (P(A with j from B) − P(A))] its first-order
/// one, for unknowns that are independent. Errors are by leaving out groups of rows.
///
/// # Errors
/// If the confidence is not between 0 and 1.
pub fn shares(sample: &ShareSample, event: NestedEvent, confidence: f64) -> Result<Shares> {
    if !(confidence > 0.0 && confidence < 1.0) {
        return Err(Error::argument("a confidence lies between 0 and 1"));
    }
    let blocks = FIXED + sample.factors;
    let of = |row: usize, block: usize| {
        let start = (row * blocks + block) * sample.inner.size();
        sample.inner.share(&sample.margins, start, side_of(block), event)
    };
    let rows: Vec<Vec<f64>> = (0..sample.rows)
        .map(|row| (0..blocks).map(|block| of(row, block)).collect::<Vec<f64>>())
        .filter(|row| row.iter().all(|p| p.is_finite()))
        .collect();
    let count = rows.len().max(1) as f64;
    let centre =
        rows.iter().map(|row| 0.25 * row[..FIXED].iter().sum::<f64>()).sum::<f64>() / count;
    let mut groups = vec![Sums::none(sample.factors); GROUPS];
    for (k, row) in rows.iter().enumerate() {
        let sums = &mut groups[k % GROUPS];
        let [a1, a2, b1, b2] = [row[0], row[1], row[2], row[3]].map(|p| p - centre);
        sums.rows += 1.0;
        sums.mean += 0.25 * (a1 + a2 + b1 + b2);
        sums.square += 0.5 * (a1 * a2 + b1 * b2);
        for (j, p) in row[FIXED..].iter().enumerate() {
            let mixed = p - centre;
            sums.first[j] += b1 * (mixed - a2);
            sums.total[j] += a1 * (a2 - mixed);
        }
    }
    let mut all = Sums::none(sample.factors);
    groups.iter().for_each(|group| all.add(group, 1.0));
    let (variance, first, total) = all.indices();
    if rows.len() < 2 * GROUPS || variance.is_nan() || variance <= 0.0 {
        let none =
            vec![Estimate::none("the probability does not vary with the unknowns"); sample.factors];
        return Ok(Shares { variance: 0.0, first: none.clone(), total: none });
    }
    let without: Vec<Indices> = groups
        .iter()
        .map(|group| {
            let mut rest = all.clone();
            rest.add(group, -1.0);
            rest.indices()
        })
        .collect();
    let estimate = |j: usize, value: f64, of: &dyn Fn(&Indices) -> f64| {
        if sample.whole[j] {
            return Estimate {
                value: Some(1.0),
                standard_error: Some(0.0),
                interval: Earned::none(
                    "a factor that is all that is unknown carries all of the band, by definition",
                ),
            };
        }
        let parts: Vec<f64> = without.iter().map(of).collect();
        delete_a_group(value, &parts, confidence, "delete-a-group jackknife over rows")
    };
    Ok(Shares {
        variance,
        first: first.iter().enumerate().map(|(j, &x)| estimate(j, x, &|part| part.1[j])).collect(),
        total: total.iter().enumerate().map(|(j, &x)| estimate(j, x, &|part| part.2[j])).collect(),
    })
}
