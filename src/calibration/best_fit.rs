//! The most probable parameters: Levenberg and Marquardt's method in standard-normal space, the noise in turn.
//!
//! In that space the prior is `−½|z|²`, so the most probable point minimises `½|r(z)|² + ½|z|²`, a sum of squares in
//! the coordinates of the model, and its curvature is about `I + JᵀJ`. The noise's coordinates are no sum of squares:
//! between rounds they are moved by Newton's method with differences, a handful of batches.
//!
//! Why not a library: `levenberg-marquardt` 0.15 is kept well but stands on nalgebra 0.34, and a second nalgebra with
//! its trees is more than the forty lines here; its residuals do not know the prior either, which makes every step
//! here positive definite with no damping at all.

use super::likelihood::{LeastSquares, Whitened};
use crate::error::{Error, Result};
use crate::numerics::columns::Columns;
use nalgebra::{Cholesky, DMatrix, DVector};

/// Rounds of model and noise.
const ROUNDS: usize = 8;
/// Steps of one round, at most.
const STEPS: usize = 40;
/// A round ends when a step moves by less than this share of a posterior standard deviation.
const STILL: f64 = 1e-4;
/// Half width of the differences in the noise's coordinates.
const DIFFERENCE: f64 = 0.02;

/// The most probable point and the normal law about it.
#[derive(Debug, Clone)]
pub struct BestFit {
    /// The point, in standard-normal space.
    pub point: Vec<f64>,
    /// ln of the likelihood there.
    pub ln_likelihood: f64,
    /// Covariance of the model's coordinates, noise held: the inverse of `I + JᵀJ`.
    pub covariance: DMatrix<f64>,
    /// Steps taken, all rounds together.
    pub steps: usize,
    /// Length of the last step, in posterior standard deviations.
    pub last_step: f64,
    /// Whether the last round hardly moved.
    pub converged: bool,
}

/// Climbs to the most probable point from `start`.
///
/// # Errors
/// Those of the likelihood, and if it is impossible at the start.
pub fn best_fit(target: &dyn LeastSquares, start: &[f64]) -> Result<BestFit> {
    let squared = target.squared_dimension();
    let mut point = start.to_vec();
    let mut steps = 0;
    let mut last_step = f64::INFINITY;
    let mut converged = false;
    let mut covariance = DMatrix::identity(squared, squared);
    for _ in 0..ROUNDS {
        let climbed = climb(target, &mut point)?;
        steps += climbed.steps;
        last_step = climbed.last_step;
        covariance = climbed.covariance;
        let moved = climbed.moved;
        let noise_moved =
            if squared < point.len() { settle_noise(target, &mut point)? } else { 0.0 };
        if moved.max(noise_moved) < 0.02 {
            converged = last_step < STILL;
            break;
        }
    }
    let mut ln_likelihood = [f64::NAN];
    target.ln_likelihood(&Columns::from_rows(&[&point]), &mut ln_likelihood)?;
    let [ln_likelihood] = ln_likelihood;
    Ok(BestFit { point, ln_likelihood, covariance, steps, last_step, converged })
}

struct Climbed {
    steps: usize,
    last_step: f64,
    moved: f64,
    covariance: DMatrix<f64>,
}

/// The normal equations at a point: `I + JᵀJ`, and minus the gradient.
fn normal_equations(whitened: &Whitened, point: &[f64]) -> (DMatrix<f64>, DVector<f64>) {
    let n = whitened.jacobian.len();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut matrix = DMatrix::identity(n, n);
    for i in 0..n {
        for j in 0..=i {
            let sum = dot(&whitened.jacobian[i], &whitened.jacobian[j]);
            matrix[(i, j)] += sum;
            if i != j {
                matrix[(j, i)] += sum;
            }
        }
    }
    let downhill =
        DVector::from_fn(n, |i, _| -(dot(&whitened.jacobian[i], &whitened.residuals) + point[i]));
    (matrix, downhill)
}

fn cost(whitened: &Whitened, point: &[f64]) -> f64 {
    let squares = |values: &[f64]| values.iter().map(|x| x * x).sum::<f64>();
    0.5 * (squares(&whitened.residuals) + squares(point))
}

/// Levenberg and Marquardt's method in the model's coordinates.
fn climb(target: &dyn LeastSquares, point: &mut [f64]) -> Result<Climbed> {
    let squared = target.squared_dimension();
    let impossible =
        || Error::argument("the model cannot be computed where the calibration starts");
    let mut here = target.whitened(point, true)?.ok_or_else(impossible)?;
    let begun = point[..squared].to_vec();
    let mut damping = 0.0_f64;
    let (mut steps, mut last_step) = (0, f64::INFINITY);
    while steps < STEPS && last_step > STILL {
        steps += 1;
        let (matrix, downhill) = normal_equations(&here, &point[..squared]);
        let before = cost(&here, &point[..squared]);
        loop {
            let mut damped = matrix.clone();
            for i in 0..squared {
                damped[(i, i)] *= 1.0 + damping;
            }
            let Some(solver) = Cholesky::new(damped) else { return Err(impossible()) };
            let step = solver.solve(&downhill);
            let mut tried = point.to_vec();
            for (place, step) in tried.iter_mut().zip(step.iter()) {
                *place += step;
            }
            let promised = 0.5 * step.dot(&downhill);
            let length = (step.dot(&(&matrix * &step))).sqrt();
            let there = target.whitened(&tried, true)?;
            let after =
                there.as_ref().map_or(f64::INFINITY, |there| cost(there, &tried[..squared]));
            let tiny = length < STILL;
            if after < before - 1e-4 * promised || (tiny && after <= before * (1.0 + 1e-12)) {
                point.copy_from_slice(&tried);
                here = there.ok_or_else(impossible)?;
                last_step = length;
                damping = if damping < 1e-3 { 0.0 } else { damping / 8.0 };
                break;
            }
            if tiny || damping > 1e8 {
                last_step = length;
                break;
            }
            damping = (damping * 8.0).max(1e-3);
        }
        if damping > 1e8 {
            break;
        }
    }
    let (matrix, _) = normal_equations(&here, &point[..squared]);
    let moved = DVector::from_fn(squared, |i, _| point[i] - begun[i]);
    let moved = moved.dot(&(&matrix * &moved)).sqrt();
    let covariance = Cholesky::new(matrix).map(|solver| solver.inverse()).ok_or_else(impossible)?;
    Ok(Climbed { steps, last_step, moved, covariance })
}

/// Newton's method with differences in the noise's coordinates; how far it went.
fn settle_noise(target: &dyn LeastSquares, point: &mut [f64]) -> Result<f64> {
    let first = target.squared_dimension();
    let n = point.len() - first;
    let begun = point[first..].to_vec();
    for _ in 0..12 {
        // The point, each coordinate either way, each pair together.
        let mut rows = vec![point.to_vec()];
        for i in 0..n {
            for side in [DIFFERENCE, -DIFFERENCE] {
                let mut row = point.to_vec();
                row[first + i] += side;
                rows.push(row);
            }
        }
        for i in 0..n {
            for j in 0..i {
                let mut row = point.to_vec();
                row[first + i] += DIFFERENCE;
                row[first + j] += DIFFERENCE;
                rows.push(row);
            }
        }
        let value = densities(target, &rows)?;
        let ahead = |i: usize| value[1 + 2 * i];
        let behind = |i: usize| value[2 + 2 * i];
        let mut curvature = DMatrix::zeros(n, n);
        let mut pair = 1 + 2 * n;
        for i in 0..n {
            curvature[(i, i)] =
                -(ahead(i) - 2.0 * value[0] + behind(i)) / (DIFFERENCE * DIFFERENCE);
            for j in 0..i {
                let mixed =
                    -(value[pair] - ahead(i) - ahead(j) + value[0]) / (DIFFERENCE * DIFFERENCE);
                curvature[(i, j)] = mixed;
                curvature[(j, i)] = mixed;
                pair += 1;
            }
        }
        let uphill = DVector::from_fn(n, |i, _| (ahead(i) - behind(i)) / (2.0 * DIFFERENCE));
        if !uphill.iter().chain(curvature.iter()).all(|x| x.is_finite()) {
            break;
        }
        // Directions that curve up are taken as the prior curves.
        let eigen = curvature.symmetric_eigen();
        let along = eigen.eigenvectors.transpose() * &uphill;
        let scaled =
            DVector::from_fn(n, |i, _| (along[i] / eigen.eigenvalues[i].max(0.3)).clamp(-1.5, 1.5));
        let step = &eigen.eigenvectors * scaled;
        // The best of a few lengths of the step, in one batch.
        let lengths = [1.0, 0.5, 0.25, 0.1, 0.03];
        let tries: Vec<Vec<f64>> = lengths
            .iter()
            .map(|length| {
                let mut row = point.to_vec();
                for (place, step) in row[first..].iter_mut().zip(step.iter()) {
                    *place += length * step;
                }
                row
            })
            .collect();
        let found = densities(target, &tries)?;
        let best = (0..lengths.len())
            .filter(|&k| found[k] > value[0])
            .max_by(|&a, &b| found[a].total_cmp(&found[b]));
        let Some(best) = best else { break };
        point.copy_from_slice(&tries[best]);
        if found[best] - value[0] < 1e-6 {
            break;
        }
    }
    let squares: f64 = point[first..].iter().zip(&begun).map(|(a, b)| (a - b) * (a - b)).sum();
    Ok(squares.sqrt())
}

/// ln of likelihood times prior, up to a constant.
fn densities(target: &dyn LeastSquares, rows: &[Vec<f64>]) -> Result<Vec<f64>> {
    let mut values = vec![0.0; rows.len()];
    target.ln_likelihood(&Columns::from_rows(rows), &mut values)?;
    for (value, row) in values.iter_mut().zip(rows) {
        *value -= 0.5 * row.iter().map(|x| x * x).sum::<f64>();
    }
    Ok(values)
}
