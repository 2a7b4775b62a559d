//! Borgonovo's delta from samples already run: how far knowing an input moves the outcome's whole law.
//!
//! δ is the mean over the input of the total-variation distance between the outcome's law and its law
//! given the input (Borgonovo, Reliab. Eng. Syst. Saf. 92 (2007) 771): 0 exactly for independence, 1 for
//! determination, unchanged by any monotone transformation of either, and valid for correlated inputs.
//!
//! It is the largest of P(A) − Π(A) over all sets A of pairs (x, y), P being their joint law and Π the
//! product of its margins; the largest is reached where the copula's density exceeds one. Here A is found
//! on four fifths of the rows, from a kernel estimate of that density with reflection at the boundary, and
//! P(A) − Π(A) is taken on the other fifth, for each fifth in turn. Rows that did not choose A show no
//! difference by chance, so an input without effect gets 0 on average; a wrong piece of A costs only as
//! much as the density there differs from one, so the error of the density enters in second order, and
//! only downwards. That is why the estimate gives a lower confidence bound and no upper one.

use super::classes::too_few;
use super::given_data::{GivenData, checked, mid_ranks};
use crate::error::Result;
use crate::numerics::elementary::exp;
use crate::numerics::interval::{Earned, Estimate, Interval};
use crate::numerics::special::normal;

/// Cells a side of the unit square on which the copula is held.
const CELLS: usize = 64;
/// Parts of the rows, each of which judges a set that the others chose.
const FOLDS: usize = 5;
/// Standard deviations of the kernels, as shares of the unit interval. The pair that reaches the largest
/// difference is taken, as for the set itself.
const WIDTHS: [f64; 7] = [0.012, 0.02, 0.033, 0.055, 0.09, 0.15, 0.25];
/// The widths along the two sides differ by no more places of [`WIDTHS`] than this.
const FURTHEST_APART: usize = 3;
/// How the interval is made.
const METHOD: &str = "lower confidence bound, cross-fitted; no upper bound is earned";

type Square = Vec<[f64; CELLS]>;

/// Delta of the outcome for each input, with a one-sided interval that reaches from a lower confidence bound
/// to 1. Ties share a place. An estimate below zero stands for an effect below its error.
///
/// # Errors
/// If the confidence is not strictly between 0 and 1.
pub fn borgonovo_delta(data: &GivenData, confidence: f64) -> Result<Vec<Estimate>> {
    checked(confidence)?;
    if let Err(why) = too_few(data.rows()) {
        return Ok(data.inputs().iter().map(|_| Estimate::none(why.clone())).collect());
    }
    let kernels = WIDTHS.map(Kernel::new);
    let outcome = places(data.outcome());
    let of_input = |(j, input): (usize, &Vec<f64>)| match data.why_none(j) {
        Some(why) => Estimate::none(why),
        None => Copula::of(&places(input), &outcome).delta(&kernels, confidence),
    };
    Ok(data.inputs().iter().enumerate().map(of_input).collect())
}

/// The cell of every value's rank.
fn places(values: &[f64]) -> Vec<usize> {
    let count = values.len() as f64;
    let place = |rank: f64| ((rank - 0.5) / count * CELLS as f64) as usize;
    mid_ranks(values).into_iter().map(|rank| place(rank).min(CELLS - 1)).collect()
}

/// A normal kernel on the unit interval that keeps what it carries over an end, by reflection there.
struct Kernel {
    weights: Square,
    /// Cells on either side of the middle that have weight.
    reach: usize,
}

impl Kernel {
    fn new(width: f64) -> Self {
        let middle = |cell: usize| (cell as f64 + 0.5) / CELLS as f64;
        let bell = |distance: f64| exp(-0.5 * (distance / width) * (distance / width));
        let mut weights = vec![[0.0; CELLS]; CELLS];
        for from in 0..CELLS {
            let at = middle(from);
            let images = [at, -at, 2.0 - at];
            let weight = |to: usize| images.iter().map(|image| bell(middle(to) - image)).sum();
            let column: [f64; CELLS] = std::array::from_fn(weight);
            let sum: f64 = column.iter().sum();
            weights.iter_mut().zip(column).for_each(|(row, weight)| row[from] = weight / sum);
        }
        // Six standard deviations: 2e-9 of the weight lies beyond.
        Kernel { weights, reach: (6.0 * width * CELLS as f64) as usize + 1 }
    }

    fn range(&self, cell: usize) -> std::ops::Range<usize> {
        cell.saturating_sub(self.reach)..(cell + self.reach + 1).min(CELLS)
    }

    /// Smoothed along the first side.
    fn along_first(&self, square: &Square) -> Square {
        let mut smooth = vec![[0.0; CELLS]; CELLS];
        for (to, row) in smooth.iter_mut().enumerate() {
            for from in self.range(to) {
                let weight = self.weights[to][from];
                row.iter_mut().zip(&square[from]).for_each(|(sum, value)| *sum += weight * value);
            }
        }
        smooth
    }

    /// Where the square, smoothed along the second side, is positive: one bit a cell.
    fn positive_along_second(&self, square: &Square) -> [u64; CELLS] {
        let mut set = [0; CELLS];
        for (bits, row) in set.iter_mut().zip(square) {
            for to in 0..CELLS {
                let range = self.range(to);
                let weights = &self.weights[to][range.clone()];
                let sum: f64 = weights.iter().zip(&row[range]).map(|(w, value)| w * value).sum();
                *bits |= u64::from(sum > 0.0) << to;
            }
        }
        set
    }
}

/// Pairs of ranks, in cells, by the part of the rows that they belong to.
struct Copula<'a> {
    first: &'a [usize],
    second: &'a [usize],
    /// Shares of all rows.
    parts: Vec<Square>,
    margins: [[f64; CELLS]; 2],
}

impl<'a> Copula<'a> {
    fn of(first: &'a [usize], second: &'a [usize]) -> Self {
        let each = 1.0 / first.len() as f64;
        let mut parts = vec![vec![[0.0; CELLS]; CELLS]; FOLDS];
        let mut margins = [[0.0; CELLS]; 2];
        for (row, (&u, &v)) in first.iter().zip(second).enumerate() {
            parts[row % FOLDS][u][v] += each;
            margins[0][u] += each;
            margins[1][v] += each;
        }
        Copula { first, second, parts, margins }
    }

    /// For each part what the others have more than independence would.
    fn excess(&self) -> Vec<Square> {
        let share = |part: usize| {
            let rows = self.first.len();
            (rows - (part..rows).step_by(FOLDS).count()) as f64 / rows as f64
        };
        let of = |part: usize| {
            let scale = 1.0 / share(part);
            let cell = |u: usize, v: usize| {
                let others = (0..FOLDS).filter(|other| *other != part);
                let joint: f64 = others.map(|other| self.parts[other][u][v]).sum();
                joint * scale - self.margins[0][u] * self.margins[1][v]
            };
            (0..CELLS).map(|u| std::array::from_fn(|v| cell(u, v))).collect()
        };
        (0..FOLDS).map(of).collect()
    }

    fn delta(&self, kernels: &[Kernel], confidence: f64) -> Estimate {
        let widths = kernels.len();
        let mut best: Option<(f64, Vec<[u64; CELLS]>)> = None;
        let excess = self.excess();
        for (a, first) in kernels.iter().enumerate() {
            let smooth: Vec<Square> = excess.iter().map(|e| first.along_first(e)).collect();
            let near = a.saturating_sub(FURTHEST_APART)..(a + FURTHEST_APART + 1).min(widths);
            for second in &kernels[near] {
                let sets: Vec<_> = smooth.iter().map(|s| second.positive_along_second(s)).collect();
                let difference = (0..FOLDS).map(|part| self.difference(part, &sets[part])).sum();
                if best.as_ref().is_none_or(|(most, _)| difference > *most) {
                    best = Some((difference, sets));
                }
            }
        }
        let Some((delta, sets)) = best else { return Estimate::none("no kernel") };
        self.estimate(delta, &sets, confidence)
    }

    /// P(A) − Π(A) times the part's share of the rows.
    fn difference(&self, part: usize, set: &[u64; CELLS]) -> f64 {
        let (mut joint, mut product, mut share) = (0.0, 0.0, 0.0);
        for ((bits, row), weight) in set.iter().zip(&self.parts[part]).zip(&self.margins[0]) {
            let mut within = 0.0;
            for (v, (cell, margin)) in row.iter().zip(&self.margins[1]).enumerate() {
                share += cell;
                if bits >> v & 1 == 1 {
                    joint += cell;
                    within += margin;
                }
            }
            product += weight * within;
        }
        joint - share * product
    }

    /// The difference with the error of its influence function 1[A](x, y) − Π(A | x) − Π(A | y).
    fn estimate(&self, delta: f64, sets: &[[u64; CELLS]], confidence: f64) -> Estimate {
        let has = |set: &[u64; CELLS], u: usize, v: usize| f64::from((set[u] >> v & 1) as u8);
        let given: Vec<[[f64; CELLS]; 2]> = sets
            .iter()
            .map(|set| {
                let along = |u| (0..CELLS).map(|v| has(set, u, v) * self.margins[1][v]).sum();
                let across = |v| (0..CELLS).map(|u| has(set, u, v) * self.margins[0][u]).sum();
                [std::array::from_fn(along), std::array::from_fn(across)]
            })
            .collect();
        let rows = self.first.iter().zip(self.second).enumerate();
        let influence = rows.map(|(row, (&u, &v))| {
            let part = row % FOLDS;
            has(&sets[part], u, v) - given[part][0][u] - given[part][1][v]
        });
        let (mut sum, mut squares) = (0.0, 0.0);
        for value in influence {
            sum += value;
            squares += value * value;
        }
        let count = self.first.len() as f64;
        let variance = squares / count - (sum / count) * (sum / count);
        let value = Some(delta);
        if variance <= 1e-12 {
            let interval = Earned::none("every row shows the same difference");
            return Estimate { value, standard_error: None, interval };
        }
        let error = (variance / (count - 1.0)).sqrt();
        let lower = (delta - normal::quantile_upper(1.0 - confidence) * error).min(1.0);
        let interval = Interval { lower, upper: 1.0, confidence, method: METHOD };
        Estimate { value, standard_error: Some(error), interval: interval.into() }
    }
}
