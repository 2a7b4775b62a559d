//! The Rosenbrock method: its order conditions, its order on problems with known solutions, one of them
//! forced by time, and its dense output.

use reeldown::descent::vector::rosenbrock::{A, C, DENSE, GAMMA, System, step};

type Square = [[f64; 6]; 6];

fn product(a: &Square, b: &Square) -> Square {
    let mut c = [[0.0; 6]; 6];
    for i in 0..6 {
        for j in 0..6 {
            c[i][j] = (0..6).map(|k| a[i][k] * b[k][j]).sum();
        }
    }
    c
}

fn apply(a: &Square, x: &[f64; 6]) -> [f64; 6] {
    std::array::from_fn(|i| (0..6).map(|j| a[i][j] * x[j]).sum())
}

fn dot(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Inverse of a lower triangular matrix.
fn inverse(l: &Square) -> Square {
    let mut x: Square = [[0.0; 6]; 6];
    for i in 0..6 {
        for j in 0..=i {
            let unit = if i == j { 1.0 } else { 0.0 };
            let sum: f64 = x[..i].iter().zip(&l[i]).map(|(row, factor)| factor * row[j]).sum();
            x[i][j] = (unit - sum) / l[i][i];
        }
    }
    x
}

/// The method before its transformation: α, β = α + Γ, b, and Γ.
struct Method {
    alpha: Square,
    beta: Square,
    b: [f64; 6],
    gamma: Square,
}

fn method() -> Method {
    let mut a = [[0.0; 6]; 6];
    for (i, row) in A.iter().enumerate() {
        a[i + 1][..4].copy_from_slice(row);
    }
    a[5] = a[4];
    a[5][4] = 1.0;
    let mut weights = a[5];
    weights[5] = 1.0;
    let mut gamma_inverse = [[0.0; 6]; 6];
    for i in 0..6 {
        gamma_inverse[i][i] = 1.0 / GAMMA;
        for j in 0..i {
            gamma_inverse[i][j] = -C[i - 1][j];
        }
    }
    let gamma = inverse(&gamma_inverse);
    let alpha = product(&a, &gamma);
    let mut beta = alpha;
    for i in 0..6 {
        for j in 0..6 {
            beta[i][j] += gamma[i][j];
        }
    }
    let b = std::array::from_fn(|j| (0..6).map(|i| weights[i] * gamma[i][j]).sum());
    Method { alpha, beta, b, gamma }
}

fn powers(x: &[f64; 6], k: i32) -> [f64; 6] {
    x.map(|v| v.powi(k))
}

/// Hairer and Wanner, IV.7, table 7.1 (ordinary differential equations) and VI.4 (index 1).
#[test]
fn published_order_conditions_hold() {
    let m = method();
    let one = [1.0; 6];
    let a = apply(&m.alpha, &one);
    let beta = apply(&m.beta, &one);
    let omega = inverse(&m.beta);
    let times = |x: &[f64; 6], y: &[f64; 6]| -> [f64; 6] { std::array::from_fn(|i| x[i] * y[i]) };
    let algebraic = apply(&omega, &powers(&a, 2));
    let conditions = [
        ("order 1", dot(&m.b, &one), 1.0),
        ("order 2", dot(&m.b, &beta), 1.0 / 2.0),
        ("order 3, bushy", dot(&m.b, &powers(&a, 2)), 1.0 / 3.0),
        ("order 3, tall", dot(&m.b, &apply(&m.beta, &beta)), 1.0 / 6.0),
        ("order 4, bushy", dot(&m.b, &powers(&a, 3)), 1.0 / 4.0),
        ("order 4, mixed", dot(&m.b, &times(&a, &apply(&m.alpha, &beta))), 1.0 / 8.0),
        ("order 4, fork", dot(&m.b, &apply(&m.beta, &powers(&a, 2))), 1.0 / 12.0),
        ("order 4, tall", dot(&m.b, &apply(&m.beta, &apply(&m.beta, &beta))), 1.0 / 24.0),
        ("algebraic, order 2", dot(&m.b, &algebraic), 1.0),
        ("algebraic, order 3", dot(&m.b, &apply(&omega, &powers(&a, 3))), 1.0),
        ("algebraic, mixed", dot(&m.b, &times(&a, &apply(&m.alpha, &algebraic))), 1.0 / 4.0),
    ];
    for (name, got, want) in conditions {
        // The coefficients have 15 decimals and are up to 25: products of three, summed.
        assert!((got - want).abs() < 1e-13, "{name}: {got} {want}");
    }
    // Dense output: b_i(θ) = b_i θ + θ (1 − θ)(p_i + q_i θ) satisfies the first three orders for all θ.
    let weights = |row: usize| -> [f64; 6] {
        std::array::from_fn(|j| (0..5).map(|i| DENSE[row][i] * m.gamma[i][j]).sum())
    };
    let p = weights(0);
    let both = weights(1);
    let tall = apply(&m.beta, &beta);
    let dense = [
        (one, 0.0, 0.0),
        (beta, -0.5, -0.5),
        (powers(&a, 2), -1.0 / 3.0, -2.0 / 3.0),
        (tall, -1.0 / 6.0, -1.0 / 3.0),
        (algebraic, -1.0, -1.0),
    ];
    for (vector, at_start, at_end) in dense {
        assert!((dot(&p, &vector) - at_start).abs() < 1e-13);
        assert!((dot(&both, &vector) - at_end).abs() < 1e-13);
    }
}

/// A system over plain numbers with its matrix solved by Gaussian elimination.
struct Plain<const N: usize> {
    rates: fn(&[f64; N]) -> [f64; N],
    jacobian: fn(&[f64; N]) -> [[f64; N]; N],
}

impl<const N: usize> System<f64, N> for Plain<N> {
    const STIFF: usize = 0;
    type Moment = [f64; N];
    type Factored = [[f64; N]; N];

    fn moment(&self, y: &[f64; N]) -> [f64; N] {
        (self.rates)(y)
    }
    fn rates(moment: &[f64; N]) -> [f64; N] {
        *moment
    }
    fn factor(&self, y: &[f64; N], _: &[f64; N], _: f64, inverse_h_gamma: f64) -> [[f64; N]; N] {
        let mut matrix = (self.jacobian)(y).map(|row| row.map(|entry| -entry));
        for (i, row) in matrix.iter_mut().enumerate() {
            row[i] += inverse_h_gamma;
        }
        matrix
    }
    fn solve(matrix: &[[f64; N]; N], right: &[f64; N]) -> [f64; N] {
        let (mut a, mut b) = (*matrix, *right);
        for i in 0..N {
            for j in i + 1..N {
                let factor = a[j][i] / a[i][i];
                let pivot = a[i];
                for (entry, above) in a[j].iter_mut().zip(pivot).skip(i) {
                    *entry -= factor * above;
                }
                b[j] -= factor * b[i];
            }
        }
        for i in (0..N).rev() {
            for k in i + 1..N {
                b[i] -= a[i][k] * b[k];
            }
            b[i] /= a[i][i];
        }
        b
    }
}

/// The end value of component 0 after `steps` equal steps over `[0, length]`.
fn integrate<const N: usize>(system: &Plain<N>, start: [f64; N], length: f64, steps: u32) -> f64 {
    let h = length / f64::from(steps);
    let mut y = start;
    for _ in 0..steps {
        let moment = system.moment(&y);
        y = step(system, &y, &moment, h).state;
    }
    y[0]
}

/// Order seen between two step counts.
fn order(coarse: f64, fine: f64) -> f64 {
    (coarse / fine).log2()
}

/// `y′ = −y²` has y = 1/(1 + t): nonlinear, smooth.
#[test]
fn analytic_fourth_order_on_a_smooth_problem() {
    let system = Plain::<2> {
        rates: |y| [-y[0] * y[0], y[0] - y[1]],
        jacobian: |y| [[-2.0 * y[0], 0.0], [1.0, -1.0]],
    };
    let error = |steps| (integrate(&system, [1.0, 1.0], 4.0, steps) - 0.2).abs();
    let orders = [order(error(32), error(64)), order(error(64), error(128))];
    for order in orders {
        assert!((3.7..4.6).contains(&order), "{orders:?}");
    }
}

/// Forced by time, `y′ = cos t · y`, y = exp(sin t), with time a component of the state: a wrong stage
/// time would cost the order.
#[test]
fn analytic_fourth_order_on_a_time_forced_problem() {
    let system = Plain::<2> {
        rates: |y| [y[1].cos() * y[0], 1.0],
        jacobian: |y| [[y[1].cos(), -y[1].sin() * y[0]], [0.0, 0.0]],
    };
    let exact = 5.0f64.sin().exp();
    let error = |steps| (integrate(&system, [1.0, 0.0], 5.0, steps) - exact).abs();
    let orders = [order(error(32), error(64)), order(error(64), error(128))];
    for order in orders {
        assert!((3.6..4.6).contains(&order), "{orders:?}");
    }
}

/// Prothero and Robinson's stiff problem `y′ = −λ (y − sin t) + cos t`, λ = 1e5: methods that do not care
/// for stiff forcing fall to order 1 or 2 here; this one keeps 3 at least.
#[test]
fn analytic_stiff_forcing_keeps_the_order() {
    let system = Plain::<2> {
        rates: |y| [-1e5 * (y[0] - y[1].sin()) + y[1].cos(), 1.0],
        jacobian: |y| [[-1e5, 1e5 * y[1].cos() - y[1].sin()], [0.0, 0.0]],
    };
    let exact = 2.0f64.sin();
    let error = |steps| (integrate(&system, [0.0, 0.0], 2.0, steps) - exact).abs();
    let seen = order(error(4), error(8));
    assert!(error(8) < 1e-8 && seen > 2.8, "{} {seen}", error(8));
}

/// The dense output's derivatives at a step's ends are third-order accurate on a stiff component, whose
/// right-hand side at the same states is off by λ times the error.
#[test]
fn analytic_dense_output_gives_the_derivative_of_a_stiff_component() {
    let system = Plain::<2> {
        rates: |y| [-1e5 * (y[0] - y[1].sin()) + y[1].cos(), 1.0],
        jacobian: |y| [[-1e5, 1e5 * y[1].cos() - y[1].sin()], [0.0, 0.0]],
    };
    let error = |h: f64| {
        let start: [f64; 2] = [0.7f64.sin(), 0.7];
        let moment = system.moment(&start);
        let step = step(&system, &start, &moment, h);
        let at_start = (step.slopes[0] - 0.7f64.cos()).abs();
        let at_end = (step.slopes[1] - (0.7 + h).cos()).abs();
        at_start.max(at_end)
    };
    let seen = order(error(0.4), error(0.2));
    assert!(error(0.2) < 1e-3 && seen > 2.6, "{} {seen}", error(0.2));
}
