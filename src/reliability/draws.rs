//! Random numbers of the reliability methods, from a stream's bits alone: no platform function.

use crate::numerics::elementary::{ln, pow};
use crate::streams::Stream;
pub use crate::streams::{open_uniform, standard_normal};

/// A unit vector with uniform direction.
pub fn direction(stream: &mut Stream, dimension: usize) -> Vec<f64> {
    loop {
        let vector: Vec<f64> = (0..dimension).map(|_| standard_normal(stream)).collect();
        let norm = super::vectors::norm(&vector);
        if norm > 1e-9 {
            return vector.iter().map(|x| x / norm).collect();
        }
    }
}

/// A gamma number of unit scale.
///
/// Source: Marsaglia and Tsang, "A simple method for generating gamma variables" (2000), with their
/// power of a uniform for shapes below one.
pub fn gamma(stream: &mut Stream, shape: f64) -> f64 {
    if shape < 1.0 {
        let boost = pow(open_uniform(stream), shape.recip());
        return gamma(stream, shape + 1.0) * boost;
    }
    let d = shape - 1.0 / 3.0;
    let c = (9.0 * d).sqrt().recip();
    loop {
        let x = standard_normal(stream);
        let cube = 1.0 + c * x;
        if cube <= 0.0 {
            continue;
        }
        let v = cube * cube * cube;
        if ln(open_uniform(stream)) < 0.5 * x * x + d - d * v + d * ln(v) {
            return d * v;
        }
    }
}
