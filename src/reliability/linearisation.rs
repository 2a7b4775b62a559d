//! Margins and their gradients at many points from one batch.

use super::event::Evaluator;
use super::vectors::norm;
use crate::error::Result;
use crate::numerics::columns::Columns;

/// A margin at a point, with its gradient there.
#[derive(Debug, Clone, PartialEq)]
pub struct Linearisation {
    /// The margin.
    pub margin: f64,
    /// Its gradient by the standard-normal coordinates.
    pub gradient: Vec<f64>,
}

impl Linearisation {
    /// Whether margin and gradient are finite numbers.
    pub fn is_finite(&self) -> bool {
        self.margin.is_finite() && self.gradient.iter().all(|x| x.is_finite())
    }

    /// Length of the gradient.
    pub fn slope(&self) -> f64 {
        norm(&self.gradient)
    }
}

/// Linearises the raw margins of `limits` at every one of `points`: result\[point\]\[limit\].
///
/// Gradients are the limit state's own where it gives one for every limit, else central differences of
/// half width `step`, all points in one batch of (2 dimension + 1) rows a point. A fault in a stencil
/// makes the gradient NaN.
///
/// # Errors
/// Those of the limit state.
pub fn linearise(
    evaluator: &mut Evaluator,
    points: &[Vec<f64>],
    limits: &[usize],
    step: f64,
) -> Result<Vec<Vec<Linearisation>>> {
    let n = evaluator.dimension();
    let state = evaluator.state();
    let known: Vec<Option<Vec<Vec<f64>>>> = points
        .iter()
        .map(|point| limits.iter().map(|&limit| state.gradient(point, limit)).collect())
        .collect();
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for (point, known) in points.iter().zip(&known) {
        rows.push(point.clone());
        if known.is_none() {
            for j in 0..n {
                for side in [step, -step] {
                    let mut moved = point.clone();
                    moved[j] += side;
                    rows.push(moved);
                }
            }
        }
    }
    let margins = evaluator.margins(&Columns::from_rows(&rows))?;
    let mut first = 0;
    let mut all = Vec::with_capacity(points.len());
    let mut faults = 0;
    for known in known {
        let used = if known.is_some() { 1 } else { 2 * n + 1 };
        faults += (first..first + used)
            .filter(|&row| limits.iter().any(|&limit| margins.get(row, limit).is_nan()))
            .count() as u64;
        let at = limits.iter().enumerate().map(|(k, &limit)| {
            let gradient = match &known {
                Some(gradients) => gradients[k].clone(),
                None => (0..n)
                    .map(|j| {
                        let ahead = margins.get(first + 1 + 2 * j, limit);
                        let behind = margins.get(first + 2 + 2 * j, limit);
                        (ahead - behind) / (2.0 * step)
                    })
                    .collect(),
            };
            Linearisation { margin: margins.get(first, limit), gradient }
        });
        all.push(at.collect());
        first += used;
    }
    evaluator.faults += faults;
    Ok(all)
}
