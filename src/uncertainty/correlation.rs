//! Dependence between inputs: a Gaussian copula from pairwise statements.

use crate::error::Error;
use crate::numerics::columns::Columns;
use crate::numerics::elementary::{asin, sin};
use nalgebra::{Cholesky, DMatrix};
use std::f64::consts::PI;
use std::fmt;

/// How a dependence between two inputs is stated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Measure {
    /// The correlation of the standard normal variables behind the two.
    Normal(f64),
    /// Spearman's rank correlation.
    Spearman(f64),
    /// Kendall's rank correlation.
    Kendall(f64),
}

impl Measure {
    /// The stated number.
    pub fn value(&self) -> f64 {
        match *self {
            Measure::Normal(value) | Measure::Spearman(value) | Measure::Kendall(value) => value,
        }
    }

    /// The measure's name, as a card writes it.
    pub fn name(&self) -> &'static str {
        match self {
            Measure::Normal(_) => "normal",
            Measure::Spearman(_) => "spearman",
            Measure::Kendall(_) => "kendall",
        }
    }

    /// The normal correlation: 2 sin(π ρ/6) of Spearman's, sin(π τ/2) of Kendall's (Kruskal, 1958).
    pub fn normal_correlation(&self) -> f64 {
        match *self {
            Measure::Normal(rho) => rho,
            Measure::Spearman(rho) => 2.0 * sin(PI * rho / 6.0),
            Measure::Kendall(tau) => sin(PI * tau / 2.0),
        }
    }

    /// The normal correlation `rho` in this measure.
    fn of_normal(&self, rho: f64) -> f64 {
        match self {
            Measure::Normal(_) => rho,
            Measure::Spearman(_) => 6.0 / PI * asin(0.5 * rho),
            Measure::Kendall(_) => 2.0 / PI * asin(rho),
        }
    }
}

/// One stated dependence between the inputs `first` and `second`, counted from 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Statement {
    /// One input.
    pub first: usize,
    /// The other input.
    pub second: usize,
    /// Their dependence.
    pub measure: Measure,
}

/// Why statements do not make a copula, and which one is to blame.
#[derive(Debug, Clone, PartialEq)]
pub struct Refusal {
    /// Index of the offending statement.
    pub statement: usize,
    /// The two inputs of the offending statement.
    pub pair: (usize, usize),
    /// The values, in the statement's own measure, that all the other statements would allow.
    pub admissible: Option<(f64, f64)>,
    /// Whether the statement is refused for itself, not beside the others.
    pub alone: bool,
    /// What is wrong, in one sentence, the inputs named by their numbers from 1.
    pub reason: String,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.reason)
    }
}

impl std::error::Error for Refusal {}

impl From<Refusal> for Error {
    fn from(refusal: Refusal) -> Self {
        Error::argument(refusal.reason)
    }
}

/// Pivots of the Cholesky factor below this count as zero: the inputs are then functions of each other.
const LEAST_PIVOT: f64 = 1e-10;
/// The normal correlation that leaves the least pivot.
pub const NEAREST_TO_ONE: f64 = 0.999_999_999_9;

/// The Gaussian copula of a number of inputs.
#[derive(Debug, Clone, PartialEq)]
pub struct Copula {
    correlation: DMatrix<f64>,
    /// Rows of the lower triangular factor: for each input its non-zero (column, entry).
    factor: Vec<Vec<(usize, f64)>>,
}

impl Copula {
    /// The copula of `dimension` inputs with the stated dependences; pairs not stated are uncorrelated.
    ///
    /// # Errors
    /// A statement about an input that does not exist, about an input and itself, about a pair already
    /// stated, of a value outside (−1, 1); or statements that contradict each other (the matrix is not
    /// positive definite): then the last one that could be mended alone is named, with the values that
    /// the others allow.
    pub fn new(dimension: usize, statements: &[Statement]) -> Result<Self, Refusal> {
        let mut correlation = DMatrix::identity(dimension, dimension);
        for (k, statement) in statements.iter().enumerate() {
            let &Statement { first, second, measure } = statement;
            let refuse = |reason: String| Refusal {
                statement: k,
                pair: (first, second),
                admissible: None,
                alone: true,
                reason,
            };
            if first >= dimension || second >= dimension {
                return Err(refuse(format!(
                    "a correlation names input {} of {dimension}",
                    first.max(second) + 1
                )));
            }
            if first == second {
                return Err(refuse(format!("input {} is correlated with itself", first + 1)));
            }
            let value = measure.value();
            if !(value > -1.0 && value < 1.0) {
                return Err(refuse(format!(
                    "the {} correlation of inputs {} and {} is {value}, not between −1 and 1",
                    measure.name(),
                    first + 1,
                    second + 1
                )));
            }
            let stated = |other: &Statement| {
                (other.first, other.second) == (first, second)
                    || (other.first, other.second) == (second, first)
            };
            // Alone the pair leaves 1 − ρ² of the second's variance: below the least pivot they are one input.
            let rho = measure.normal_correlation();
            if (1.0 - rho) * (1.0 + rho) <= LEAST_PIVOT {
                return Err(refuse(format!(
                    "the {} correlation {value} of inputs {} and {} makes them one input to the tenth digit: \
                     expected at most {NEAREST_TO_ONE} in size, or a single input",
                    measure.name(),
                    first + 1,
                    second + 1
                )));
            }
            if statements.iter().take(k).any(stated) {
                return Err(refuse(format!(
                    "the correlation of inputs {} and {} is stated twice",
                    first + 1,
                    second + 1
                )));
            }
            correlation[(first, second)] = rho;
            correlation[(second, first)] = rho;
        }
        match factored(&correlation) {
            Some(lower) => Ok(Copula { factor: rows(&lower), correlation }),
            None => Err(contradiction(&correlation, statements)),
        }
    }

    /// Number of inputs.
    pub fn dimension(&self) -> usize {
        self.correlation.nrows()
    }

    /// The correlation of the standard normal variables behind inputs `i` and `j`.
    pub fn normal_correlation(&self, i: usize, j: usize) -> f64 {
        self.correlation[(i, j)]
    }

    /// Whether no input depends on another.
    pub fn is_independent(&self) -> bool {
        self.factor.iter().all(|row| row.len() == 1)
    }

    /// Correlated standard normal values from independent ones, for every row of `z`.
    pub fn correlate(&self, z: &Columns, out: &mut Columns) {
        out.reset(z.rows(), self.dimension());
        for (j, row) in self.factor.iter().enumerate() {
            let out = out.column_mut(j);
            for &(k, entry) in row {
                for (out, &z) in out.iter_mut().zip(z.column(k)) {
                    *out += entry * z;
                }
            }
        }
    }

    /// Independent standard normal values from correlated ones: forward substitution.
    pub fn decorrelate(&self, correlated: &[f64]) -> Vec<f64> {
        let mut z: Vec<f64> = Vec::with_capacity(correlated.len());
        for (row, &value) in self.factor.iter().zip(correlated) {
            let mut rest = value;
            let mut pivot = 1.0;
            for &(k, entry) in row {
                match z.get(k) {
                    Some(known) => rest -= entry * known,
                    None => pivot = entry,
                }
            }
            z.push(rest / pivot);
        }
        z
    }
}

/// The lower Cholesky factor of a positive definite matrix.
fn factored(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let lower = Cholesky::new(matrix.clone())?.unpack();
    // A pivot is the variance that the inputs before it leave unexplained.
    lower.diagonal().iter().all(|pivot| pivot * pivot > LEAST_PIVOT).then_some(lower)
}

/// The non-zero entries of a lower triangular factor, row by row.
fn rows(lower: &DMatrix<f64>) -> Vec<Vec<(usize, f64)>> {
    (0..lower.nrows())
        .map(|j| (0..=j).map(|k| (k, lower[(j, k)])).filter(|entry| entry.1 != 0.0).collect())
        .collect()
}

/// The values of the normal correlation of `i` and `j` that keep the matrix positive definite.
///
/// With the other inputs given, i and j keep variances v and a covariance: ρ = c ± √(v v').
fn admissible(matrix: &DMatrix<f64>, i: usize, j: usize) -> Option<(f64, f64)> {
    let others: Vec<usize> = (0..matrix.nrows()).filter(|&k| k != i && k != j).collect();
    if others.is_empty() {
        return Some((-1.0, 1.0));
    }
    let rest = DMatrix::from_fn(others.len(), others.len(), |r, c| matrix[(others[r], others[c])]);
    factored(&rest)?;
    let solver = Cholesky::new(rest)?;
    let column = |k: usize| nalgebra::DVector::from_fn(others.len(), |r, _| matrix[(others[r], k)]);
    let (with_i, with_j) = (column(i), column(j));
    let (by_i, by_j) = (solver.solve(&with_i), solver.solve(&with_j));
    let (left_i, left_j) = (1.0 - with_i.dot(&by_i), 1.0 - with_j.dot(&by_j));
    if !(left_i > LEAST_PIVOT && left_j > LEAST_PIVOT) {
        return None;
    }
    let (centre, half) = (with_i.dot(&by_j), (left_i * left_j).sqrt());
    Some(((centre - half).max(-1.0), (centre + half).min(1.0)))
}

/// Names the statement to blame for a matrix that is not positive definite.
fn contradiction(matrix: &DMatrix<f64>, statements: &[Statement]) -> Refusal {
    let mendable = statements.iter().enumerate().rev().find_map(|(k, statement)| {
        admissible(matrix, statement.first, statement.second).map(|range| (k, statement, range))
    });
    if let Some((k, statement, (low, high))) = mendable {
        let measure = statement.measure;
        let (low, high) = (measure.of_normal(low), measure.of_normal(high));
        return Refusal {
            statement: k,
            pair: (statement.first, statement.second),
            admissible: Some((low, high)),
            alone: false,
            reason: format!(
                "the {} correlation {} of inputs {} and {} contradicts the other statements (the matrix is \
                 not positive definite): they leave it only the values between {low:.4} and {high:.4}",
                measure.name(),
                measure.value(),
                statement.first + 1,
                statement.second + 1,
            ),
        };
    }
    // No single change mends it: blame the last statement within the smallest leading block that fails.
    let size = (1..=matrix.nrows())
        .find(|&size| factored(&matrix.view((0, 0), (size, size)).into_owned()).is_none())
        .unwrap_or(matrix.nrows());
    let (k, pair) = statements
        .iter()
        .enumerate()
        .rev()
        .map(|(k, statement)| (k, (statement.first, statement.second)))
        .find(|&(_, (first, second))| first.max(second) + 1 == size)
        .unwrap_or((0, (0, 0)));
    Refusal {
        statement: k,
        pair,
        admissible: None,
        alone: false,
        reason: format!(
            "the correlations up to that of inputs {} and {} contradict each other (the matrix is not positive \
             definite), and changing one of them alone does not mend it",
            pair.0 + 1,
            pair.1 + 1,
        ),
    }
}
