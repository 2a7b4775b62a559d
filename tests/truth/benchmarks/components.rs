//! One smooth margin in normal variables.

use super::{Benchmark, component};
use reeldown::numerics::elementary::sin;
use std::f64::consts::SQRT_2;

/// The problems of this file.
pub fn all() -> Vec<Benchmark> {
    vec![
        // Convex quadratic; FORM gives 6.2097e-3.
        component("RP22", 2, rp22, 0.00420730551129962, 1e-10),
        component("RP53", 2, rp53, 0.0313204856866824, 1e-10),
        // Φ(−√2), exact.
        component("RMINUSS", 2, r_minus_s, 0.0786496035251426, 1e-10),
        // Published as "exact" 1.6 % too high (Waarts 2000: 2.7009e-4).
        component("RSQUAD", 2, r_minus_s_squared, 0.000265898793948049, 1e-10),
        // Answers in the literature span 6e-3 to 1.4e-2.
        component("CANTILEVER2D", 2, cantilever, 0.00951381317302309, 1e-10),
        // Published 0.0081; its crude interval misses the reference by a little.
        component("RP38", 7, rp38, 0.0080504877, 2.4e-5),
    ]
}

fn rp22(x: &[f64], margins: &mut Vec<f64>) {
    let d = x[0] - x[1];
    margins.push(2.5 - (x[0] + x[1]) / SQRT_2 + 0.1 * d * d);
}

fn rp53(z: &[f64], margins: &mut Vec<f64>) {
    let (x1, x2) = (1.5 + z[0], 2.5 + z[1]);
    margins.push(sin(2.5 * x1) + 2.0 - (x1 * x1 + 4.0) * (x2 - 1.0) / 20.0);
}

fn r_minus_s(z: &[f64], margins: &mut Vec<f64>) {
    margins.push((4.0 + z[0]) - (2.0 + z[1]));
}

fn r_minus_s_squared(z: &[f64], margins: &mut Vec<f64>) {
    let x2 = 1.5 + 0.5 * z[1];
    margins.push(11.0 + z[0] - x2 * x2);
}

fn cantilever(z: &[f64], margins: &mut Vec<f64>) {
    let (load, height) = (1000.0 + 200.0 * z[0], 250.0 + 37.5 * z[1]);
    let span2 = 6000.0 * 6000.0;
    margins.push(6000.0 / 325.0 - 1.5 * span2 * span2 / 2.6e10 * load / (height * height * height));
}

fn rp38(z: &[f64], margins: &mut Vec<f64>) {
    let mean = [350.0, 50.8, 3.81, 173.0, 9.38, 33.1, 0.036];
    let sd = [35.0, 5.08, 0.381, 17.3, 0.938, 3.31, 0.0036];
    let x: Vec<f64> = (0..7).map(|j| mean[j] + sd[j] * z[j]).collect();
    let above = x[3] * x[3] - 4.0 * x[4] * x[5] * x[6] * x[6]
        + x[3] * (x[5] + 4.0 * x[4] + 2.0 * x[5] * x[6]);
    let below = x[3] * x[4] * (x[3] + x[5] + 2.0 * x[5] * x[6]);
    let load = x[0] * x[1] * x[1] * x[1] / (2.0 * x[2] * x[2] * x[2]);
    margins.push(155_900.0 - load * above / below);
}
