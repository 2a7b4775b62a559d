//! Orthant probabilities of the multinormal law: P(X₁ > h₁, …, X_m > h_m).
//!
//! Two dimensions by quadrature of the conditional probability, all terms positive and so without
//! cancellation in the tails. More by sequential conditioning (Genz, J. Comput. Graph. Stat. 1 (1992)
//! 141) over a randomly shifted lattice, whose shifts give the error.

use super::draws::open_uniform;
use super::vectors::dot;
use crate::numerics::special::{normal, quadrature};
use crate::streams::{Purpose, stream};

/// Correlation beyond which two variables are one (or opposite).
const SINGULAR: f64 = 1.0 - 1e-12;

/// P(X > h, Y > k) of standard normals with this correlation, to about 13 digits.
pub fn bivariate_upper(h: f64, k: f64, correlation: f64) -> f64 {
    let r = correlation.clamp(-1.0, 1.0);
    if r > SINGULAR {
        return normal::survival(h.max(k));
    }
    if r < -SINGULAR {
        return (normal::survival(h) - normal::survival(-k)).max(0.0);
    }
    // Condition on the variable with the farther bound.
    let (h, k) = if h >= k { (h, k) } else { (k, h) };
    let spread = (1.0 - r * r).sqrt();
    let from = h.max(-9.0);
    let to = from.max(k.abs()).max(0.0) + 10.0;
    let mut breaks = vec![from, to];
    // The conditional probability turns from 0 to 1 within a few of these widths.
    if r != 0.0 {
        let (centre, width) = (k / r, spread / r.abs());
        breaks.extend([-8.0, -4.0, -1.0, 0.0, 1.0, 4.0, 8.0].map(|step| centre + step * width));
    }
    breaks.retain(|x| (from..=to).contains(x));
    breaks.sort_by(f64::total_cmp);
    let integrand = |x: f64| normal::density(x) * normal::survival((k - r * x) / spread);
    let mut sum = 0.0;
    for pair in breaks.windows(2) {
        let pieces = ((pair[1] - pair[0]) / 2.0).ceil().max(1.0);
        let length = (pair[1] - pair[0]) / pieces;
        for piece in 0..pieces as usize {
            let start = pair[0] + piece as f64 * length;
            sum += quadrature::integral(start, start + length, integrand);
        }
    }
    sum
}

/// A probability by randomised integration, with its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Integrated {
    /// The probability.
    pub probability: f64,
    /// Standard error over the shifts; 0 where it was found by quadrature.
    pub standard_error: f64,
}

/// Random shifts of the lattice, and points of each.
const SHIFTS: u64 = 12;
const POINTS: u64 = 2048;

/// P(X_i > h_i for every i), X with this correlation matrix (rows). The first bounds are integrated
/// outermost: put the rare ones first.
pub fn orthant(h: &[f64], correlation: &[Vec<f64>], seed: u64) -> Integrated {
    match h {
        [] => Integrated { probability: 1.0, standard_error: 0.0 },
        [h] => Integrated { probability: normal::survival(*h), standard_error: 0.0 },
        [h, k] => {
            let probability = bivariate_upper(*h, *k, correlation[0][1]);
            Integrated { probability, standard_error: 0.0 }
        }
        _ => by_lattice(h, &semidefinite_root(correlation), seed),
    }
}

/// Lower triangular root of a correlation matrix, zero pivots where it is singular.
fn semidefinite_root(correlation: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let m = correlation.len();
    let mut root = vec![vec![0.0; m]; m];
    for i in 0..m {
        for j in 0..=i {
            let rest = correlation[i][j] - dot(&root[i][..j], &root[j][..j]);
            root[i][j] = if i == j {
                if rest > 1e-10 { rest.sqrt() } else { 0.0 }
            } else if root[j][j] > 0.0 {
                rest / root[j][j]
            } else {
                0.0
            };
        }
    }
    root
}

fn by_lattice(h: &[f64], root: &[Vec<f64>], seed: u64) -> Integrated {
    let m = h.len();
    let generators: Vec<f64> = primes(m).into_iter().map(|p| f64::from(p).sqrt()).collect();
    let means: Vec<f64> = (0..SHIFTS)
        .map(|shift| {
            // Above the indices that searches use as starts.
            let mut stream = stream(seed, Purpose::DesignPoint, (1 << 32) + shift);
            let shifts: Vec<f64> = (0..m).map(|_| open_uniform(&mut stream)).collect();
            let mut sum = 0.0;
            for point in 1..=POINTS {
                let coordinate = |j: usize| {
                    let u = point as f64 * generators[j] + shifts[j];
                    // The tent of the lattice coordinate: periodic, and so integrated faster.
                    let tent = (2.0 * (u - u.floor()) - 1.0).abs();
                    tent.clamp(1e-16, 1.0 - 1e-16)
                };
                sum += conditioned(h, root, coordinate);
            }
            sum / POINTS as f64
        })
        .collect();
    let n = SHIFTS as f64;
    let probability = means.iter().sum::<f64>() / n;
    let squares: f64 = means.iter().map(|p| (p - probability) * (p - probability)).sum();
    Integrated { probability, standard_error: (squares / (n * (n - 1.0))).sqrt() }
}

/// The product of conditional probabilities along one point of the unit cube.
fn conditioned(h: &[f64], root: &[Vec<f64>], coordinate: impl Fn(usize) -> f64) -> f64 {
    let m = h.len();
    let mut y = vec![0.0; m];
    let mut product = 1.0;
    for i in 0..m {
        let known = dot(&root[i][..i], &y[..i]);
        let pivot = root[i][i];
        if pivot == 0.0 {
            if known <= h[i] {
                return 0.0;
            }
            continue;
        }
        let tail = normal::survival((h[i] - known) / pivot);
        if tail <= 0.0 {
            return 0.0;
        }
        product *= tail;
        if i + 1 < m {
            y[i] = normal::quantile_upper((coordinate(i) * tail).max(1e-300));
        }
    }
    product
}

fn primes(count: usize) -> Vec<u32> {
    let mut found: Vec<u32> = Vec::with_capacity(count);
    let mut candidate = 2;
    while found.len() < count {
        if found.iter().all(|prime| candidate % prime != 0) {
            found.push(candidate);
        }
        candidate += 1;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::elementary::asin;
    use std::f64::consts::PI;

    #[test]
    fn published_union_of_two_half_spaces() {
        // P(U1 < −3 or U2 < −3), 30-digit quadrature; 1e-13 is the rounding of the difference.
        let table = [
            (0.0, 0.0026979738385643904),
            (0.5, 0.002617906401427997),
            (0.9, 0.0020893916779564105),
            (-0.5, 0.002699795991785167),
        ];
        for (correlation, union) in table {
            let found = 2.0 * normal::survival(3.0) - bivariate_upper(3.0, 3.0, correlation);
            assert!((found / union - 1.0).abs() < 1e-12, "{correlation}: {found}");
        }
    }

    #[test]
    fn analytic_quadrants_and_degenerate_correlations() {
        for r in [-0.999_999, -0.7, -0.1, 0.0, 0.3, 0.95, 0.999_999] {
            let exact = 0.25 + asin(r) / (2.0 * PI);
            assert!((bivariate_upper(0.0, 0.0, r) - exact).abs() < 1e-13, "{r}");
        }
        assert_eq!(bivariate_upper(2.0, 3.0, 1.0), normal::survival(3.0));
        assert_eq!(bivariate_upper(2.0, 3.0, -1.0), 0.0);
        let straddled = bivariate_upper(-1.0, -1.0, -1.0);
        assert!((straddled - (1.0 - 2.0 * normal::survival(1.0))).abs() < 1e-15);
        // Far bounds keep their relative accuracy: independent tails multiply.
        let far = bivariate_upper(8.0, 7.0, 0.0) / (normal::survival(8.0) * normal::survival(7.0));
        assert!((far - 1.0).abs() < 1e-12);
    }

    #[test]
    fn analytic_orthant_of_three_equicorrelated() {
        // P(X > 0) = 1/8 + 3 asin(r)/(4π); five of the lattice's standard errors, which are themselves small.
        for r in [0.0, 0.5, -0.3] {
            let correlation: Vec<Vec<f64>> =
                (0..3).map(|i| (0..3).map(|j| if i == j { 1.0 } else { r }).collect()).collect();
            let found = orthant(&[0.0; 3], &correlation, 1);
            let exact = 0.125 + 3.0 * asin(r) / (4.0 * PI);
            let error = (found.probability - exact).abs();
            assert!(error < 5.0 * found.standard_error + 1e-12, "{r}: {error} {found:?}");
            assert!(found.standard_error < 1e-4);
        }
    }

    #[test]
    fn property_a_repeated_variable_changes_nothing() {
        let correlation = vec![vec![1.0, 1.0, 0.2], vec![1.0, 1.0, 0.2], vec![0.2, 0.2, 1.0]];
        let found = orthant(&[3.0, 3.0, 1.0], &correlation, 2);
        let exact = bivariate_upper(3.0, 1.0, 0.2);
        assert!((found.probability / exact - 1.0).abs() < 1e-3, "{found:?} {exact}");
    }
}
