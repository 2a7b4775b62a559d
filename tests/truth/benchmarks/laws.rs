//! Margins in variables that are not normal.

use super::{Benchmark, component};
use reeldown::numerics::elementary::{exp, ln_1p};

/// The problems of this file.
pub fn all() -> Vec<Benchmark> {
    // Reference by scrambled Sobol' points, standard error 4.6e-8.
    vec![component("RP8", 6, rp8, 0.0007897829777785532, 1.8e-4)]
}

/// A lognormal variable from its own mean and coefficient of variation.
pub fn lognormal(mean: f64, variation: f64, z: f64) -> f64 {
    let variance = ln_1p(variation * variation);
    mean * exp(variance.sqrt() * z - 0.5 * variance)
}

fn rp8(z: &[f64], margins: &mut Vec<f64>) {
    let x: Vec<f64> =
        [(120.0, 0.1), (120.0, 0.1), (120.0, 0.1), (120.0, 0.1), (50.0, 0.2), (40.0, 0.2)]
            .iter()
            .zip(z)
            .map(|(&(mean, variation), &z)| lognormal(mean, variation, z))
            .collect();
    margins.push(x[0] + 2.0 * x[1] + 2.0 * x[2] + x[3] - 5.0 * x[4] - 5.0 * x[5]);
}
