//! Series and parallel systems, each limit with its own margin.

use super::{Benchmark, Function};
use reeldown::numerics::special::normal;
use reeldown::reliability::event::Event;
use std::f64::consts::SQRT_2;

/// The problems of this file.
pub fn all() -> Vec<Benchmark> {
    vec![
        system("RP25", 2, 2, rp25, Event::All, 4.14856629375975e-5),
        system("RP33", 3, 2, rp33, Event::Any, 0.00257559779080026),
        // The collection's page says 0.36, a known mistake.
        system("RP55", 2, 4, rp55, Event::Any, 0.56001442828637),
        // 1 − (1 − Φ(−4))(1 − Φ(−5)), exact; the kinks hide which margin matters.
        system("RP110", 2, 2, rp110, Event::Any, 3.19578843263879e-5),
        // Waarts' four branches; FORM 2.33e-4, SORM 8.74e-4 in the published table.
        system("FOURBRANCH", 2, 4, four_branch, Event::Any, 0.00222279506619444),
    ]
}

fn system(
    id: &'static str,
    dimension: usize,
    limits: usize,
    margins: fn(&[f64], &mut Vec<f64>),
    event: Event,
    probability: f64,
) -> Benchmark {
    let limits = Function { dimension, limits, margins };
    Benchmark { id, limits, event, probability, relative_error: 1e-10 }
}

fn rp25(x: &[f64], margins: &mut Vec<f64>) {
    margins.push(x[0] * x[0] - 8.0 * x[1] + 16.0);
    margins.push(-16.0 * x[0] + x[1] + 32.0);
}

fn rp33(x: &[f64], margins: &mut Vec<f64>) {
    margins.push(3.0 * 3.0_f64.sqrt() - x[0] - x[1] - x[2]);
    margins.push(3.0 - x[2]);
}

fn rp55(z: &[f64], margins: &mut Vec<f64>) {
    let uniform = |z: f64| normal::cdf(z) - normal::survival(z);
    let d = uniform(z[0]) - uniform(z[1]);
    let bowl = 0.2 + 0.6 * d * d * d * d;
    margins.push(bowl - d / SQRT_2);
    margins.push(bowl + d / SQRT_2);
    margins.push(d + 5.0 / SQRT_2 - 2.2);
    margins.push(-d + 5.0 / SQRT_2 - 2.2);
}

fn rp110(x: &[f64], margins: &mut Vec<f64>) {
    margins.push(if x[0] <= 3.5 { 0.85 - 0.1 * x[0] } else { 4.0 - x[0] });
    margins.push(if x[1] <= 2.0 { 2.3 - x[1] } else { 0.5 - 0.1 * x[1] });
}

fn four_branch(x: &[f64], margins: &mut Vec<f64>) {
    let (sum, d) = ((x[0] + x[1]) / SQRT_2, x[0] - x[1]);
    margins.push(3.0 + 0.1 * d * d - sum);
    margins.push(3.0 + 0.1 * d * d + sum);
    margins.push(d + 7.0 / SQRT_2);
    margins.push(-d + 7.0 / SQRT_2);
}
