//! Morris' screening: elementary effects along random one-at-a-time trajectories.
//!
//! Sources: Morris, Technometrics 33 (1991) 161; Campolongo, Cariboni and Saltelli, Environ. Model.
//! Softw. 22 (2007) 1509 for the mean magnitude μ*. The levels are the middles of equal slices of (0, 1), so
//! that an unbounded law's quantile exists at each.

use super::given_data::{CONSTANT, permutation, varies};
use crate::error::{Error, Result};
use crate::numerics::columns::Columns;
use crate::numerics::interval::{Earned, Estimate, Interval};
use crate::numerics::special::student;
use crate::streams::{Purpose, stream};
use rand::Rng;
use serde::Serialize;

/// Levels of every coordinate; even.
const LEVELS: u64 = 8;
/// Levels by which a coordinate jumps: half of them.
const JUMP: u64 = LEVELS / 2;

/// Trajectories of a screening.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Screening {
    inputs: usize,
    trajectories: usize,
    seed: u64,
}

/// What the screening says of one input, in the outcome's unit for a jump over half of its probability.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ElementaryEffects {
    /// Mean magnitude μ* of the effects.
    pub magnitude: Estimate,
    /// Mean effect μ: as large as the magnitude if the outcome is monotone.
    pub mean: f64,
    /// Standard deviation of the effects: nonlinearity and interactions.
    pub standard_deviation: f64,
    /// Trajectories left out because an outcome is not known.
    pub left_out: usize,
}

impl Screening {
    /// A screening of `inputs` inputs by `trajectories` trajectories of `inputs + 1` points each.
    ///
    /// # Errors
    /// If there is no input or fewer than two trajectories.
    pub fn new(inputs: usize, trajectories: usize, seed: u64) -> Result<Self> {
        if inputs == 0 || trajectories < 2 {
            return Err(Error::argument(
                "a screening needs an input and two trajectories at least",
            ));
        }
        Ok(Screening { inputs, trajectories, seed })
    }

    /// All points, trajectory after trajectory, in the unit cube.
    pub fn points(&self) -> Columns {
        let stages = self.inputs + 1;
        let mut points = Columns::new(self.trajectories * stages, self.inputs);
        for t in 0..self.trajectories {
            let mut levels = self.start(t);
            let order = permutation(self.seed, t as u64, self.inputs);
            for stage in 0..stages {
                if let Some(&moving) = stage.checked_sub(1).and_then(|s| order.get(s)) {
                    levels[moving] = (levels[moving] + JUMP) % LEVELS;
                }
                for (j, &level) in levels.iter().enumerate() {
                    let u = (level as f64 + 0.5) / LEVELS as f64;
                    points.set(t * stages + stage, j, u);
                }
            }
        }
        points
    }

    fn start(&self, trajectory: usize) -> Vec<u64> {
        let mut rng = stream(self.seed, Purpose::Screening, trajectory as u64);
        (0..self.inputs).map(|_| rng.next_u64() >> (64 - LEVELS.trailing_zeros())).collect()
    }

    /// The effects of every input from the outcomes at all points, in their order.
    ///
    /// # Errors
    /// If there is not one outcome a point, or the confidence is not strictly between 0 and 1.
    pub fn effects(&self, outcomes: &[f64], confidence: f64) -> Result<Vec<ElementaryEffects>> {
        super::given_data::checked(confidence)?;
        let stages = self.inputs + 1;
        if outcomes.len() != self.trajectories * stages {
            return Err(Error::argument("every point of the screening needs an outcome"));
        }
        if outcomes.iter().any(|value| value.is_finite()) && !varies(outcomes.iter().copied()) {
            let constant = ElementaryEffects {
                magnitude: Estimate::none(CONSTANT),
                mean: 0.0,
                standard_deviation: 0.0,
                left_out: 0,
            };
            return Ok(vec![constant; self.inputs]);
        }
        let mut effects: Vec<Vec<f64>> = vec![Vec::new(); self.inputs];
        for t in 0..self.trajectories {
            let values = &outcomes[t * stages..(t + 1) * stages];
            let order = permutation(self.seed, t as u64, self.inputs);
            let start = self.start(t);
            for (stage, &j) in order.iter().enumerate() {
                // From the upper half of the levels the jump goes down.
                let sign = if start[j] < JUMP { 1.0 } else { -1.0 };
                let effect = sign * (values[stage + 1] - values[stage]);
                if effect.is_finite() {
                    effects[j].push(effect);
                }
            }
        }
        Ok(effects.iter().map(|effects| self.summary(effects, confidence)).collect())
    }

    fn summary(&self, effects: &[f64], confidence: f64) -> ElementaryEffects {
        let left_out = self.trajectories - effects.len();
        let moments = |of: &dyn Fn(f64) -> f64| {
            let count = effects.len() as f64;
            let mean = effects.iter().map(|&e| of(e)).sum::<f64>() / count;
            let squares: f64 = effects.iter().map(|&e| (of(e) - mean) * (of(e) - mean)).sum();
            (mean, (squares / (count - 1.0)).sqrt())
        };
        let (mean, standard_deviation) = moments(&|e| e);
        let (size, spread) = moments(&f64::abs);
        let count = effects.len() as f64;
        let error = spread / count.sqrt();
        let magnitude = if effects.len() < 2 {
            Estimate::none("fewer than two effects are known")
        } else if error <= 1e-12 * size {
            let interval = Earned::none("every effect has the same magnitude");
            Estimate { value: Some(size), standard_error: None, interval }
        } else {
            let half = student::quantile_upper(count - 1.0, (1.0 - confidence) / 2.0) * error;
            let method = "Student t over trajectories";
            let interval = Interval { lower: size - half, upper: size + half, confidence, method };
            Estimate { value: Some(size), standard_error: Some(error), interval: interval.into() }
        };
        ElementaryEffects { magnitude, mean, standard_deviation, left_out }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_a_linear_outcome_has_constant_effects_and_an_interaction_scattered_ones() {
        let screening = Screening::new(3, 200, 5).unwrap();
        let points = screening.points();
        let of = |f: &dyn Fn(&[f64]) -> f64| -> Vec<f64> {
            (0..points.rows()).map(|k| f(&points.row(k))).collect()
        };
        let linear = screening.effects(&of(&|u| 3.0 * u[0] - 2.0 * u[1]), 0.95).unwrap();
        // A jump is half of (0, 1).
        for (effect, exact) in linear.iter().zip([1.5, -1.0, 0.0]) {
            assert!((effect.mean - exact).abs() < 1e-12);
            assert!((effect.magnitude.value.unwrap() - exact.abs()).abs() < 1e-12);
            assert!(effect.standard_deviation < 1e-12);
        }
        // u0·u1: the effect of u0 is u1/2, whose mean is 1/4 and variance (1 − 1/64)/12/4.
        let product = screening.effects(&of(&|u| u[0] * u[1]), 0.9999).unwrap();
        let interval = *product[0].magnitude.interval.interval().unwrap();
        assert!(interval.contains(0.25), "{interval:?}");
        let sd = ((1.0 - 1.0 / 64.0) / 48.0f64).sqrt();
        assert!((product[0].standard_deviation / sd - 1.0).abs() < 0.2);
    }
    #[test]
    fn property_an_outcome_that_varies_by_rounding_has_no_effects() {
        let screening = Screening::new(2, 50, 5).unwrap();
        let points = screening.points();
        let outcomes: Vec<f64> =
            (0..points.rows()).map(|k| 3.0 + 1e-13 * points.get(k, 0)).collect();
        for effect in screening.effects(&outcomes, 0.95).unwrap() {
            assert!(effect.magnitude.interval.why_none().unwrap().contains("does not vary"));
        }
    }
}
