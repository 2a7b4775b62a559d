//! A quasi-Newton model of the Lagrangian's curvature for the search of a design point.
//!
//! HLRF takes that curvature as the identity and zigzags where the limit is strongly curved. The model
//! starts there and learns from gradients already paid for: BFGS with Powell's damping, which keeps it
//! positive definite (Nocedal and Wright, *Numerical Optimization*, 2006, procedure 18.2).

use super::vectors::dot;
use nalgebra::{DMatrix, DVector};

/// Curvature of ½‖u‖² + λ g(u), positive definite.
pub struct Curvature {
    matrix: DMatrix<f64>,
    last: Option<(Vec<f64>, Vec<f64>, f64)>,
}

impl Curvature {
    /// The curvature of ½‖u‖² alone.
    pub fn new(dimension: usize) -> Self {
        Curvature { matrix: DMatrix::identity(dimension, dimension), last: None }
    }

    /// The step d that minimises uᵀd + ½ dᵀBd on the linearised limit g + ∇gᵀd = 0, after the model has
    /// learnt from the new gradient.
    pub fn step(&mut self, point: &[f64], margin: f64, gradient: &[f64]) -> Vec<f64> {
        if let Some((old_point, old_gradient, multiplier)) = self.last.take() {
            self.learn(point, gradient, &old_point, &old_gradient, multiplier);
        }
        let plain = || {
            let factor = (dot(gradient, point) - margin) / dot(gradient, gradient);
            (gradient.iter().zip(point).map(|(g, u)| factor * g - u).collect(), -factor)
        };
        let solved = self.matrix.clone().cholesky().map(|cholesky| {
            let slope = cholesky.solve(&DVector::from_column_slice(gradient));
            let pull = cholesky.solve(&DVector::from_column_slice(point));
            let multiplier =
                (margin - dot(gradient, pull.as_slice())) / dot(gradient, slope.as_slice());
            let step = pull.iter().zip(slope.iter()).map(|(p, s)| -(p + multiplier * s)).collect();
            (step, multiplier)
        });
        let (step, multiplier): (Vec<f64>, f64) = match solved {
            Some((step, multiplier)) if multiplier.is_finite() => (step, multiplier),
            _ => {
                self.matrix.fill_with_identity();
                plain()
            }
        };
        self.last = Some((point.to_vec(), gradient.to_vec(), multiplier));
        step
    }

    fn learn(
        &mut self,
        point: &[f64],
        gradient: &[f64],
        old_point: &[f64],
        old_gradient: &[f64],
        multiplier: f64,
    ) {
        let n = point.len();
        let moved = DVector::from_iterator(n, (0..n).map(|j| point[j] - old_point[j]));
        let turned = DVector::from_iterator(
            n,
            (0..n).map(|j| moved[j] + multiplier * (gradient[j] - old_gradient[j])),
        );
        let image = &self.matrix * &moved;
        let bend = moved.dot(&image);
        if !(bend > 1e-16 && turned.iter().all(|x| x.is_finite())) {
            return;
        }
        let along = moved.dot(&turned);
        let share = if along >= 0.2 * bend { 1.0 } else { 0.8 * bend / (bend - along) };
        let damped = turned * share + &image * (1.0 - share);
        let along = moved.dot(&damped);
        self.matrix += &damped * damped.transpose() / along - &image * image.transpose() / bend;
    }
}
