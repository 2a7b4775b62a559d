//! Where the detailed models keep their unknowns: points along the radius and across the film; and the plain numbers that
//! their equations name.

use crate::numerics::gauss_lobatto::GaussLobatto;
use std::array::from_fn;
pub use std::f64::consts::PI;

/// Temperature at which the fluid has its nominal density, K: 25 °C.
pub const DENSITY_TEMPERATURE_K: f64 = 298.15;

/// The smallest inner radius as a share of the outer one: an axis has no area, and its equation would be empty.
pub const SMALLEST_BORE: f64 = 1e-3;

/// Points along the radius and across the film, and what the equations need of them: pure numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Space<const P: usize, const K: usize> {
    /// Points along the radius, from −1 at the bore to 1 at the rim.
    pub radial: [f64; P],
    /// Their weights, whose sum is 2.
    pub radial_weights: [f64; P],
    /// `Σ_q w_q D_qi D_qk`: radial stiffness of a strip.
    pub strip: [[f64; P]; P],
    /// `Σ_q w_q x_q D_qi D_qk`: its part that grows with the radius.
    pub flare: [[f64; P]; P],
    /// Shares of the film's volume at a radius: both walls together, …, the middle.
    pub share: [f64; K],
    /// Conduction across the film: `−rate Σ_b across[a][b] T_b` warms unknown `a`.
    pub across: [[f64; K]; K],
}

impl<const P: usize, const K: usize> Space<P, K> {
    /// `P` points along the radius and `N = 2K − 1` across the film.
    pub fn new<const N: usize>() -> Self {
        const { assert!(N + 1 == 2 * K, "an odd number of points across the film: both halves are one") };
        let radial = GaussLobatto::<P>::new();
        let stiffness = |along: &dyn Fn(f64) -> f64| {
            from_fn(|i| {
                from_fn(|k| {
                    (0..P)
                        .map(|q| {
                            let slopes = radial.derivative[q][i] * radial.derivative[q][k];
                            radial.weights[q] * along(radial.points[q]) * slopes
                        })
                        .sum()
                })
            })
        };
        let film = GaussLobatto::<N>::new();
        // Both halves of the film carry the same temperatures: their rows and columns are added.
        let folded = |node: usize| node.min(N - 1 - node);
        let mut share = [0.0; K];
        let mut across = [[0.0; K]; K];
        for j in 0..N {
            share[folded(j)] += 0.5 * film.weights[j];
            for l in 0..N {
                let stiffness: f64 = (0..N)
                    .map(|q| film.weights[q] * film.derivative[q][j] * film.derivative[q][l])
                    .sum();
                across[folded(j)][folded(l)] += 0.5 * stiffness;
            }
        }
        for (row, share) in across.iter_mut().zip(share) {
            row.iter_mut().for_each(|entry| *entry /= share);
        }
        Space {
            radial: radial.points,
            radial_weights: radial.weights,
            strip: stiffness(&|_| 1.0),
            flare: stiffness(&|x| x),
            share,
            across,
        }
    }
}
