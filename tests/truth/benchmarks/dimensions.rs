//! Ten and a hundred dimensions.

use super::{Benchmark, component};

/// The problems of this file.
pub fn all() -> Vec<Benchmark> {
    vec![
        // Φ(−5), exact; published 1.9 % too high.
        component("RP107", 10, rp107, 2.86651571879194e-7, 1e-10),
        // The origin breaches a shell's inside: no design point says where the probability is.
        component("RP63", 100, rp63, 0.000376943611833052, 1e-10),
    ]
}

fn rp107(x: &[f64], margins: &mut Vec<f64>) {
    margins.push(5.0 * 10.0_f64.sqrt() - x.iter().sum::<f64>());
}

fn rp63(x: &[f64], margins: &mut Vec<f64>) {
    margins.push(0.1 * x[1..].iter().map(|x| x * x).sum::<f64>() - x[0] - 4.5);
}
