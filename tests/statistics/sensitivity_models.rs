//! Functions with known indices, and pick-freeze runs of them.

use rand::Rng;
use reeldown::numerics::columns::Columns;
use reeldown::numerics::special::normal;
use reeldown::sensitivity::pick_freeze::{Factor, Plan};
use reeldown::streams::{Purpose, stream};
use std::f64::consts::PI;

/// A function of one point of uniforms.
pub type Model = fn(&[f64]) -> f64;

/// Ishigami's function with 7 and 0.1 (Saltelli et al., *Global Sensitivity Analysis*, 2008); closed forms.
pub const ISHIGAMI_FIRST: [f64; 3] = [0.313905191147811, 0.442411144790041, 0.0];
pub const ISHIGAMI_TOTAL: [f64; 3] = [0.557588855209959, 0.442411144790041, 0.243683664062148];
pub const ISHIGAMI_VARIANCE: f64 = 13.8445879407193;

pub fn ishigami(u: &[f64]) -> f64 {
    let x: Vec<f64> = u.iter().map(|u| PI * (2.0 * u - 1.0)).collect();
    x[0].sin() + 7.0 * x[1].sin().powi(2) + 0.1 * x[2].powi(4) * x[0].sin()
}

/// Coefficients of Sobol's g-function.
pub const G: [f64; 8] = [0.0, 1.0, 4.5, 9.0, 99.0, 99.0, 99.0, 99.0];

pub fn g_function(u: &[f64]) -> f64 {
    u.iter().zip(G).map(|(x, a)| ((4.0 * x - 2.0).abs() + a) / (1.0 + a)).product()
}

/// Variance of the conditional mean of the g-function given these inputs: Π(1 + Vᵢ) − 1 over them with
/// Vᵢ = 1/(3(1 + aᵢ)²).
pub fn g_partial_variance(inputs: &[usize]) -> f64 {
    inputs.iter().map(|j| 1.0 + 1.0 / (3.0 * (1.0 + G[*j]).powi(2))).product::<f64>() - 1.0
}

/// 1[3 − Σ√aᵢ uᵢ < 0] with a = (0.6, 0.3, 0.1) and standard normal u.
pub fn target_linear(p: &[f64]) -> f64 {
    let sum: f64 =
        p.iter().zip([0.6f64, 0.3, 0.1]).map(|(p, a)| a.sqrt() * normal::quantile(*p)).sum();
    f64::from(u8::from(sum > 3.0))
}

pub fn factor(name: &str, columns: &[usize]) -> Factor {
    Factor { name: name.into(), columns: columns.to_vec() }
}

/// One factor an input.
pub fn singles(inputs: usize) -> Vec<Factor> {
    (0..inputs).map(|j| factor(&format!("x{}", j + 1), &[j])).collect()
}

/// A table of uniforms from one stream.
pub fn uniforms(rows: usize, columns: usize, seed: u64) -> Columns {
    let mut rng = stream(seed, Purpose::Test, 0);
    let mut table = Columns::new(rows, columns);
    for k in 0..rows {
        for j in 0..columns {
            table.set(k, j, ((rng.next_u64() >> 11) as f64 + 0.5) / (1u64 << 53) as f64);
        }
    }
    table
}

/// The outcomes of every block of a plan, on independent uniforms.
pub fn run(plan: &Plan, model: Model, seed: u64) -> Vec<Vec<f64>> {
    let base = uniforms(plan.base_samples(), plan.base_columns(), seed);
    let mut points = Columns::default();
    (0..plan.blocks())
        .map(|block| {
            plan.fill_block(block, &base, &mut points).unwrap();
            (0..points.rows()).map(|k| model(&points.row(k))).collect()
        })
        .collect()
}
