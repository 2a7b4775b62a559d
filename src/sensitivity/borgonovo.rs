//! Borgonovo's delta from samples already run: how far knowing an input moves the outcome's whole law.
//!
//! δ is the mean over the input of the total-variation distance between the outcome's law and its law
//! given the input: 0 exactly for independence, 1 for determination, unchanged by any monotone
//! transformation of the outcome, and valid for correlated inputs. Estimated over classes of equal
//! count, as in Plischke, Borgonovo and Smith, Eur. J. Oper. Res. 226 (2013) 536: the outcome is turned
//! into normal scores, both laws are smoothed by the same kernel, and the bias that the noise of the
//! classes makes is taken off by the bootstrap.

use super::classes::{CELLS, Class, Classes, Corrected, Law, cells_of, noise_levels, too_few};
use super::given_data::{GivenData, checked};
use crate::error::Result;
use crate::numerics::elementary::{exp, ln};
use crate::numerics::interval::Estimate;
use crate::numerics::special::normal;
use serde::Serialize;

/// Normal scores beyond this go to the last cell: 1e-5 of a sample.
const REACH: f64 = 4.4;
/// Share of Silverman's bandwidth: less smoothing than for a picture, because the bias of smoothing
/// stays and that of noise is taken off.
const BANDWIDTH: f64 = 0.5;
const METHOD: &str = "basic bootstrap, widened for smoothing and noise";

/// Delta of one input.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Delta {
    /// δ with its bias taken off, and the basic bootstrap interval, widened by the scale of the
    /// biases that smoothing and noise leave and reaching down to 0 where an input without effect could give as much.
    pub delta: Estimate,
    /// What the same estimator gives for an input that has no effect; an estimate not above it is noise.
    pub noise_level: Option<f64>,
}

/// Delta of the outcome for each input. The outcome should be continuous; ties share a score.
///
/// # Errors
/// If the confidence is not strictly between 0 and 1.
pub fn borgonovo_delta(data: &GivenData, confidence: f64, seed: u64) -> Result<Vec<Delta>> {
    checked(confidence)?;
    let none = |why: &str| Delta { delta: Estimate::none(why), noise_level: None };
    if let Err(why) = too_few(data.rows()) {
        return Ok(data.inputs().iter().map(|_| none(&why)).collect());
    }
    let cells = cells_of(data.outcome(), |p| (normal::quantile(p) + REACH) / (2.0 * REACH));
    let [level] = noise_levels(&cells, seed, |classes, number| {
        corrected(classes, BANDWIDTH, seed, number).values
    });
    let of_input = |(j, input): (usize, &Vec<f64>)| {
        if let Some(why) = data.why_none(j) {
            return none(why);
        }
        let classes = Classes::of(input, &cells);
        let result = corrected(&classes, BANDWIDTH, seed, j as u64);
        // How much half the smoothing moves it is the scale of what smoothing leaves.
        let sharper = corrected(&classes, BANDWIDTH / 2.0, seed, j as u64);
        let margin = (sharper.values[0] - result.values[0]).abs();
        Delta {
            delta: result.estimate(0, margin, level, confidence, METHOD),
            noise_level: Some(level),
        }
    };
    Ok(data.inputs().iter().enumerate().map(of_input).collect())
}

fn corrected(classes: &Classes, bandwidth: f64, seed: u64, input: u64) -> Corrected<1> {
    let kernels: Vec<Vec<f64>> =
        classes.classes.iter().map(|class| kernel(class, bandwidth)).collect();
    classes.corrected(seed, input, |laws| {
        let mixture = classes.mixture(laws);
        let distances =
            classes.classes.iter().zip(laws).zip(&kernels).map(|((class, law), kernel)| {
                let mut difference = *law;
                difference.iter_mut().zip(&mixture).for_each(|(d, p)| *d -= p);
                class.share * smoothed_distance(&difference, kernel)
            });
        [distances.sum()]
    })
}

/// The right half, from its centre, of a class's normal kernel; the whole sums to 1.
fn kernel(class: &Class, bandwidth: f64) -> Vec<f64> {
    let count = class.cells.len() as f64;
    let mean = class.cells.iter().map(|c| f64::from(*c)).sum::<f64>() / count;
    let squares: f64 =
        class.cells.iter().map(|c| (f64::from(*c) - mean) * (f64::from(*c) - mean)).sum();
    // Silverman's rule, in cells; n^(−1/5) through the logarithm.
    let width = bandwidth * 0.9 * (squares / count).sqrt() * exp(-0.2 * ln(count));
    let mut kernel = vec![1.0];
    while width > 0.2 && (kernel.len() as f64) < 4.0 * width && kernel.len() < CELLS {
        let step = kernel.len() as f64 / width;
        kernel.push(exp(-0.5 * step * step));
    }
    let sum = 2.0 * kernel.iter().sum::<f64>() - 1.0;
    kernel.iter_mut().for_each(|weight| *weight /= sum);
    kernel
}

/// Half the sum of the smoothed difference's absolute values; room beyond the grid's ends keeps what is
/// smoothed over them.
fn smoothed_distance(difference: &Law, kernel: &[f64]) -> f64 {
    let mut padded = [0.0; 3 * CELLS];
    for (cell, value) in difference.iter().enumerate() {
        let centre = CELLS + cell;
        padded[centre] += kernel[0] * value;
        for (offset, weight) in kernel.iter().enumerate().skip(1) {
            padded[centre + offset] += weight * value;
            padded[centre - offset] += weight * value;
        }
    }
    0.5 * padded.iter().map(|value| value.abs()).sum::<f64>()
}
