//! Radau IIA of order five with three stages, written plainly: the oracle of the fast integrator.
//!
//! One step solves `Z_i = h Σ_j a_ij f(t + c_j h, y + Z_j)` by simplified Newton iteration on the whole
//! `3N × 3N` system; the method is stiffly accurate, so the new state is `y + Z_3`. The embedded
//! third-order error estimate is filtered by `(γ0/h I − J)⁻¹`. Source: E. Hairer and G. Wanner, *Solving
//! Ordinary Differential Equations II*, sections IV.5 and IV.8.

use nalgebra::{DMatrix, DVector, Dyn, LU};

/// A system of `N` ordinary differential equations `y' = f(t, y)`.
pub trait Equations<const N: usize> {
    /// The rates `f(t, y)`.
    fn rates(&self, time: f64, state: &[f64; N]) -> [f64; N];
    /// The Jacobian `∂f_i/∂y_j`, as rows.
    fn jacobian(&self, time: f64, state: &[f64; N]) -> [[f64; N]; N];
}

/// How accurate a step has to be.
#[derive(Debug, Clone, Copy)]
pub struct Tolerance<const N: usize> {
    /// Relative tolerance of every state.
    pub relative: f64,
    /// The size below which a state's error counts absolutely, as `relative · floor`.
    pub floor: [f64; N],
}

/// An attempted step.
#[derive(Debug, Clone, Copy)]
pub struct Step<const N: usize> {
    /// The state at its end.
    pub state: [f64; N],
    /// The error estimate over the tolerance, root mean square over the states; ≤ 1 is accepted.
    pub error: f64,
}

/// Everything at a step's start that does not depend on its length.
#[derive(Debug, Clone)]
pub struct Start<const N: usize> {
    /// Time.
    pub time: f64,
    /// State.
    pub state: [f64; N],
    /// Rates of the state.
    pub rates: [f64; N],
    jacobian: [[f64; N]; N],
}

impl<const N: usize> Start<N> {
    /// Evaluates rates and Jacobian at a point.
    pub fn new(equations: &impl Equations<N>, time: f64, state: [f64; N]) -> Self {
        Start {
            time,
            state,
            rates: equations.rates(time, &state),
            jacobian: equations.jacobian(time, &state),
        }
    }
}

/// Newton iterations before a step is given up as too long.
const NEWTON_ITERATIONS: usize = 12;
/// Newton iteration stops when the update is this share of the tolerance.
const NEWTON_SHARE: f64 = 1e-4;
/// Newton iteration also stops when the update is this many roundings of the state: no better can be had.
const ROUNDING_FLOOR: f64 = 1e-15;

/// Stage times `c`.
fn nodes() -> [f64; 3] {
    let s6 = 6f64.sqrt();
    [(4.0 - s6) / 10.0, (4.0 + s6) / 10.0, 1.0]
}

/// Coefficients `a_ij`.
fn coefficients() -> [[f64; 3]; 3] {
    let s6 = 6f64.sqrt();
    [
        [(88.0 - 7.0 * s6) / 360.0, (296.0 - 169.0 * s6) / 1800.0, (-2.0 + 3.0 * s6) / 225.0],
        [(296.0 + 169.0 * s6) / 1800.0, (88.0 + 7.0 * s6) / 360.0, (-2.0 - 3.0 * s6) / 225.0],
        [(16.0 - s6) / 36.0, (16.0 + s6) / 36.0, 1.0 / 9.0],
    ]
}

/// ∛3, rounded to the nearest.
const CUBE_ROOT_OF_3: f64 = 1.442_249_570_307_408_4;

/// Weights of the stages in the error estimate, and its shift `γ0`.
fn error_weights() -> ([f64; 3], f64) {
    let s6 = 6f64.sqrt();
    let weights = [(-13.0 - 7.0 * s6) / 3.0, (-13.0 + 7.0 * s6) / 3.0, -1.0 / 3.0];
    (weights, 3.0 + CUBE_ROOT_OF_3 * CUBE_ROOT_OF_3 - CUBE_ROOT_OF_3)
}

/// Attempts a step of length `h`; `None` when the stages could not be solved for: take a shorter one.
pub fn attempt<const N: usize>(
    equations: &impl Equations<N>,
    start: &Start<N>,
    h: f64,
    tolerance: &Tolerance<N>,
) -> Option<Step<N>> {
    let c = nodes();
    let a = coefficients();
    let newton = newton_matrix(start, h, &a)?;
    let scale: [f64; N] =
        std::array::from_fn(|i| tolerance.relative * start.state[i].abs().max(tolerance.floor[i]));
    let mut stages = [[0.0; N]; 3];
    let mut converged = false;
    for _ in 0..NEWTON_ITERATIONS {
        let slopes: [[f64; N]; 3] = std::array::from_fn(|j| {
            let point = std::array::from_fn(|i| start.state[i] + stages[j][i]);
            equations.rates(start.time + c[j] * h, &point)
        });
        let mut residual = DVector::from_fn(3 * N, |row, _| {
            let (s, i) = (row / N, row % N);
            h * (0..3).map(|j| a[s][j] * slopes[j][i]).sum::<f64>() - stages[s][i]
        });
        if residual.iter().any(|r| !r.is_finite()) || !newton.solve_mut(&mut residual) {
            return None;
        }
        let mut worst = 0f64;
        for (row, update) in residual.iter().enumerate() {
            let (s, i) = (row / N, row % N);
            stages[s][i] += update;
            let rounding = ROUNDING_FLOOR * start.state[i].abs();
            worst = worst.max(update.abs() / (NEWTON_SHARE * scale[i]).max(rounding));
        }
        if worst <= 1.0 {
            converged = true;
            break;
        }
    }
    if !converged {
        return None;
    }
    let state: [f64; N] = std::array::from_fn(|i| start.state[i] + stages[2][i]);
    if state.iter().any(|y| !y.is_finite()) {
        return None;
    }
    let error = estimate_error(start, h, &stages, &scale)?;
    Some(Step { state, error })
}

/// `I − h (A ⊗ J)`, factorised.
fn newton_matrix<const N: usize>(
    start: &Start<N>,
    h: f64,
    a: &[[f64; 3]; 3],
) -> Option<LU<f64, Dyn, Dyn>> {
    let matrix = DMatrix::from_fn(3 * N, 3 * N, |row, column| {
        let identity = if row == column { 1.0 } else { 0.0 };
        identity - h * a[row / N][column / N] * start.jacobian[row % N][column % N]
    });
    matrix.iter().all(|entry| entry.is_finite()).then(|| matrix.lu())
}

/// The filtered embedded error over `scale`, root mean square.
fn estimate_error<const N: usize>(
    start: &Start<N>,
    h: f64,
    stages: &[[f64; N]; 3],
    scale: &[f64; N],
) -> Option<f64> {
    let (weights, shift) = error_weights();
    let matrix = DMatrix::from_fn(N, N, |i, j| {
        (if i == j { shift / h } else { 0.0 }) - start.jacobian[i][j]
    });
    let mut error = DVector::from_fn(N, |i, _| {
        start.rates[i] + (0..3).map(|s| weights[s] * stages[s][i]).sum::<f64>() / h
    });
    if !matrix.lu().solve_mut(&mut error) {
        return None;
    }
    let square: f64 = (0..N).map(|i| error[i] / scale[i]).map(|e| e * e).sum();
    let norm = (square / N as f64).sqrt();
    norm.is_finite().then_some(norm)
}

/// The factor by which the next step may be longer, from an error estimate of local order four.
pub fn growth(error: f64) -> f64 {
    (0.9 * error.max(1e-10).sqrt().sqrt().recip()).clamp(0.2, 5.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `y' = −k (y − cos t) − sin t`, whose solution from `y(0) = 1` is `cos t` for any `k`.
    struct Forced(f64);

    impl Equations<1> for Forced {
        fn rates(&self, time: f64, state: &[f64; 1]) -> [f64; 1] {
            [-self.0 * (state[0] - time.cos()) - time.sin()]
        }
        fn jacobian(&self, _: f64, _: &[f64; 1]) -> [[f64; 1]; 1] {
            [[-self.0]]
        }
    }

    /// The end error of `steps` equal steps over two seconds.
    fn error_of(equations: &impl Equations<1>, steps: usize, exact: f64) -> f64 {
        let tolerance = Tolerance { relative: 1e-12, floor: [1.0] };
        let h = 2.0 / steps as f64;
        let mut state = [1.0];
        for k in 0..steps {
            let start = Start::new(equations, k as f64 * h, state);
            state = attempt(equations, &start, h, &tolerance).expect("solvable").state;
        }
        (state[0] - exact).abs()
    }

    #[test]
    fn analytic_order_five_on_a_time_forced_problem() {
        let (coarse, fine) =
            (error_of(&Forced(1.0), 4, 2f64.cos()), error_of(&Forced(1.0), 8, 2f64.cos()));
        let order = (coarse / fine).log2();
        assert!((4.7..5.5).contains(&order), "order {order} from {coarse:e} to {fine:e}");
    }

    #[test]
    fn analytic_stiff_forced_problem_stays_on_its_slow_solution() {
        // The stiff order is three: eight steps of 0.25 s leave less than 0.25³ · 1e-3/k.
        let error = error_of(&Forced(1e6), 8, 2f64.cos());
        assert!(error < 1e-9, "{error:e}");
    }

    #[test]
    fn property_the_error_estimate_bounds_the_error_of_a_nonlinear_step() {
        struct Quadratic;
        impl Equations<1> for Quadratic {
            fn rates(&self, _: f64, y: &[f64; 1]) -> [f64; 1] {
                [-y[0] * y[0]]
            }
            fn jacobian(&self, _: f64, y: &[f64; 1]) -> [[f64; 1]; 1] {
                [[-2.0 * y[0]]]
            }
        }
        let tolerance = Tolerance { relative: 1e-6, floor: [1.0] };
        for h in [0.05, 0.1, 0.2, 0.4] {
            let start = Start::new(&Quadratic, 0.0, [1.0]);
            let step = attempt(&Quadratic, &start, h, &tolerance).expect("solvable");
            let error = (step.state[0] - 1.0 / (1.0 + h)).abs();
            assert!(error <= step.error * 1e-6, "h {h}: {error:e} {:e}", step.error);
        }
    }
}
