//! Gauss–Lobatto–Legendre points: where a spectral method in space keeps its unknowns.
//!
//! `N` points on [−1, 1], both ends included, integrate polynomials of degree 2N − 3 exactly. They are the ends
//! and the zeros of `P'_{N−1}`, with weights `2/(N (N − 1) P_{N−1}(x)²)`. Source: C. Canuto et al., *Spectral
//! Methods: Fundamentals in Single Domains*, section 2.3.

use std::f64::consts::PI;

/// Points, weights and the matrix of derivatives of the Lagrange polynomials through the points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GaussLobatto<const N: usize> {
    /// Points, rising from −1 to 1.
    pub points: [f64; N],
    /// Weights, whose sum is 2.
    pub weights: [f64; N],
    /// `derivative[q][i]`: slope at point `q` of the polynomial that is 1 at point `i` and 0 at the others.
    pub derivative: [[f64; N]; N],
}

/// Newton steps from the Chebyshev points: quadratic, so four reach rounding; the rest are no harm.
const NEWTON_STEPS: usize = 12;

impl<const N: usize> GaussLobatto<N> {
    /// The rule of `N` ≥ 2 points.
    pub fn new() -> Self {
        let degree = N - 1;
        let mut points: [f64; N] = std::array::from_fn(|k| {
            -crate::numerics::elementary::cos(PI * k as f64 / degree as f64)
        });
        for x in &mut points[1..degree] {
            for _ in 0..NEWTON_STEPS {
                // The zeros of P'_n by the differential equation (1 − x²) P'' = 2 x P' − n (n + 1) P.
                let (value, before) = legendre(degree, *x);
                let n = degree as f64;
                let slope = n * (before - *x * value) / (1.0 - *x * *x);
                let bend = (2.0 * *x * slope - n * (n + 1.0) * value) / (1.0 - *x * *x);
                *x -= slope / bend;
            }
        }
        // Exactly symmetric, whatever Newton's last rounding did.
        for k in 0..N / 2 {
            let half = 0.5 * (points[N - 1 - k] - points[k]);
            (points[k], points[N - 1 - k]) = (-half, half);
        }
        if N % 2 == 1 {
            points[N / 2] = 0.0;
        }
        (points[0], points[degree]) = (-1.0, 1.0);
        let polynomial = points.map(|x| legendre(degree, x).0);
        let weights = polynomial.map(|p| 2.0 / (N as f64 * degree as f64 * p * p));
        let mut derivative = [[0.0; N]; N];
        for q in 0..N {
            for i in (0..N).filter(|&i| i != q) {
                derivative[q][i] = polynomial[q] / (polynomial[i] * (points[q] - points[i]));
            }
            // A constant has no slope.
            derivative[q][q] = -derivative[q].iter().sum::<f64>();
        }
        GaussLobatto { points, weights, derivative }
    }
}

impl<const N: usize> Default for GaussLobatto<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// Legendre polynomials of degree `n` and `n − 1` at `x`, by their three-term recurrence.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut value, mut before) = (1.0, 0.0);
    for k in 0..n {
        let next = ((2 * k + 1) as f64 * x * value - k as f64 * before) / (k + 1) as f64;
        (value, before) = (next, value);
    }
    (value, before)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_five_points() {
        let rule = GaussLobatto::<5>::new();
        let inner = (3.0f64 / 7.0).sqrt();
        for (got, want) in rule.points.iter().zip([-1.0, -inner, 0.0, inner, 1.0]) {
            assert!((got - want).abs() < 2e-16, "{got} {want}");
        }
        let weights = [0.1, 49.0 / 90.0, 32.0 / 45.0, 49.0 / 90.0, 0.1];
        for (got, want) in rule.weights.iter().zip(weights) {
            assert!((got - want).abs() < 4e-16, "{got} {want}");
        }
    }

    /// Degree 2N − 3 is exact, 2N − 2 is not; the derivative of a polynomial of degree N − 1 is exact.
    #[test]
    fn analytic_exactness() {
        let rule = GaussLobatto::<7>::new();
        let integral = |power: i32| -> f64 {
            rule.points.iter().zip(rule.weights).map(|(x, w)| w * x.powi(power)).sum()
        };
        for power in 0..12 {
            let exact = if power % 2 == 0 { 2.0 / f64::from(power + 1) } else { 0.0 };
            assert!((integral(power) - exact).abs() < 4e-16, "{power}: {}", integral(power));
        }
        assert!((integral(12) - 2.0 / 13.0).abs() > 1e-4);
        for (q, row) in rule.derivative.iter().enumerate() {
            let slope: f64 = row.iter().zip(rule.points).map(|(d, x)| d * x.powi(6)).sum();
            assert!((slope - 6.0 * rule.points[q].powi(5)).abs() < 1e-13, "{slope}");
        }
    }
}
