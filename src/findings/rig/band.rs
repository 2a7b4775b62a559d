//! How well P(any breach) is known: its band over what is not known of the brake, before and after runs.
//!
//! Each limit is replaced by the half space at its design point (FORM). Inputs known on the day vary from flight
//! to flight (aleatory); all others are one brake's and fluid's, constant but unknown (epistemic). Given the
//! epistemic coordinates, P is that of the aleatory ones passing any half space: in closed form if there is one
//! aleatory input, else over a fixed set of their draws.

use crate::campaign::{DescentLimitState, Progress};
use crate::error::{Error, Result};
use crate::numerics::special::normal;
use crate::reliability::design_point::SearchOptions;
use crate::reliability::draws::standard_normal;
use crate::reliability::form::form;
use crate::streams::{Purpose, stream};
use crate::study::{Known, Study};
use nalgebra::DMatrix;
use serde::Serialize;

/// States of knowledge that runs might leave behind, in opposite pairs.
const KNOWLEDGE: usize = 128;
/// Brakes within each, in opposite pairs.
const BRAKES: usize = 128;
/// Draws of the aleatory inputs where there are several.
const DRAWS: usize = 400;
/// Half width of differences of the reliability index, in standard deviations.
const STEP: f64 = 0.05;

/// P(any breach) as a band over what is unknown but constant.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Band {
    /// Mean of P over what is unknown.
    pub mean: f64,
    /// Expected standard deviation of P.
    pub standard_deviation: f64,
    /// Expected 5 % quantile of P.
    pub lower: f64,
    /// Expected 95 % quantile of P.
    pub upper: f64,
    /// Standard deviation of the reliability index, linearised.
    pub index_standard_deviation: f64,
}

impl Band {
    /// A place that is yet to be filled.
    pub(super) const NOTHING: Band = Band {
        mean: f64::NAN,
        standard_deviation: f64::NAN,
        lower: f64::NAN,
        upper: f64::NAN,
        index_standard_deviation: f64::NAN,
    };
}

/// The limits as half spaces, split into what varies and what is unknown.
pub struct HalfSpaces {
    /// `epistemic[i][j]`: direction of limit i along parameter j.
    epistemic: Vec<Vec<f64>>,
    /// The same along each aleatory input.
    aleatory: Vec<Vec<f64>>,
    /// Distances of the planes, β.
    distances: Vec<f64>,
    /// Aleatory parts of the planes over draws, where there are several aleatory inputs.
    draws: Vec<Vec<f64>>,
    /// Slope of the reliability index of any breach with each limit's epistemic part.
    index_slopes: Vec<f64>,
    /// Names of limits whose design point was not found, which are left out.
    pub left_out: Vec<String>,
    /// The FORM probability of each limit that is in.
    pub probabilities: Vec<(String, f64)>,
}

impl HalfSpaces {
    /// The half spaces of a study's limits; `parameters` are the places of the epistemic inputs.
    ///
    /// # Errors
    /// Without limits, or if no design point is found at all.
    pub fn new(study: &Study, parameters: &[usize], progress: &Progress) -> Result<Self> {
        let state = DescentLimitState::new(study, progress);
        let varies: Vec<usize> =
            (0..study.inputs.len()).filter(|&k| study.inputs[k].known == Known::OnTheDay).collect();
        let mut spaces = HalfSpaces {
            epistemic: Vec::new(),
            aleatory: Vec::new(),
            distances: Vec::new(),
            draws: Vec::new(),
            index_slopes: Vec::new(),
            left_out: Vec::new(),
            probabilities: Vec::new(),
        };
        let options = SearchOptions::seeded(study.sampling.seed);
        for (i, limit) in study.limits.iter().enumerate() {
            let (_, found) = form(&state, i, &options)?;
            let Some(point) = found.nearest(i) else {
                spaces.left_out.push(limit.name());
                continue;
            };
            let Some(space) = point.half_spaces.first() else {
                spaces.left_out.push(limit.name());
                continue;
            };
            let pick = |places: &[usize]| places.iter().map(|&k| space.direction[k]).collect();
            spaces.epistemic.push(pick(parameters));
            spaces.aleatory.push(pick(&varies));
            spaces.distances.push(space.reliability_index);
            let probability = normal::survival(space.reliability_index);
            spaces.probabilities.push((limit.name(), probability));
        }
        if spaces.distances.is_empty() {
            return Err(Error::argument(
                "no limit of the study has a design point: P(breach) cannot be linearised",
            ));
        }
        if varies.len() > 1 {
            spaces.draw(study.sampling.seed, varies.len());
        }
        spaces.differentiate();
        Ok(spaces)
    }

    /// Number of half spaces.
    fn limits(&self) -> usize {
        self.distances.len()
    }

    fn draw(&mut self, seed: u64, inputs: usize) {
        let mut random = stream(seed, Purpose::Planning, 0);
        for _ in 0..DRAWS {
            let z: Vec<f64> = (0..inputs).map(|_| standard_normal(&mut random)).collect();
            let along = |direction: &Vec<f64>| direction.iter().zip(&z).map(|(a, z)| a * z).sum();
            self.draws.push(self.aleatory.iter().map(along).collect());
        }
    }

    /// P(any breach) given the epistemic parts of the planes.
    pub fn probability(&self, parts: &[f64]) -> f64 {
        let rests: Vec<f64> = self.distances.iter().zip(parts).map(|(d, part)| d - part).collect();
        if !self.draws.is_empty() {
            let breached = |draw: &&Vec<f64>| draw.iter().zip(&rests).any(|(a, rest)| a > rest);
            return self.draws.iter().filter(breached).count() as f64 / DRAWS as f64;
        }
        // One aleatory coordinate, or none: what keeps every limit is an interval.
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        for (direction, rest) in self.aleatory.iter().zip(rests) {
            let slope = direction.first().copied().unwrap_or(0.0);
            if slope > 0.0 {
                high = high.min(rest / slope);
            } else if slope < 0.0 {
                low = low.max(rest / slope);
            } else if rest < 0.0 {
                return 1.0;
            }
        }
        if low >= high { 1.0 } else { normal::cdf(low) + normal::survival(high) }
    }

    fn differentiate(&mut self) {
        let limits = self.limits();
        let index = |parts: &[f64]| {
            normal::quantile_upper(self.probability(parts).clamp(1e-300, 1.0 - 1e-16))
        };
        self.index_slopes = (0..limits)
            .map(|i| {
                let at = |step: f64| {
                    let mut parts = vec![0.0; limits];
                    parts[i] = step;
                    index(&parts)
                };
                (at(STEP) - at(-STEP)) / (2.0 * STEP)
            })
            .collect();
    }

    /// `A V Aᵀ`: covariance of the planes' epistemic parts if the parameters' is `covariance`.
    fn parts(&self, covariance: &DMatrix<f64>) -> DMatrix<f64> {
        let columns = covariance.nrows();
        let a = DMatrix::from_fn(self.limits(), columns, |i, j| self.epistemic[i][j]);
        &a * covariance * a.transpose()
    }

    /// The standard deviation of the reliability index of any breach, linearised at the medians.
    pub fn index_deviation(&self, covariance: &DMatrix<f64>) -> f64 {
        let parts = self.parts(covariance);
        let slopes = &self.index_slopes;
        let mut variance = 0.0;
        for i in 0..slopes.len() {
            for j in 0..slopes.len() {
                variance += slopes[i] * slopes[j] * parts[(i, j)];
            }
        }
        variance.max(0.0).sqrt()
    }

    /// The band of P that is to be expected once the parameters' covariance is `covariance`: over the states of
    /// knowledge that may be reached from the prior, and the brakes within each, on the same random numbers
    /// whatever the covariance.
    pub fn band(&self, seed: u64, covariance: &DMatrix<f64>) -> Band {
        let prior = self.parts(&DMatrix::identity(covariance.nrows(), covariance.nrows()));
        let after = self.parts(covariance);
        let (moves, within) = (factor(&(prior - &after)), factor(&after));
        let limits = self.limits();
        let mut sums = [0.0; 4];
        for state in 0..KNOWLEDGE {
            let mut random = stream(seed, Purpose::Planning, 1 + state as u64);
            let mut normals =
                || -> Vec<f64> { (0..limits).map(|_| standard_normal(&mut random)).collect() };
            let centre = times(&moves, &normals());
            let mut values: Vec<f64> = (0..BRAKES)
                .map(|_| {
                    let apart = times(&within, &normals());
                    let parts: Vec<f64> = centre.iter().zip(apart).map(|(c, a)| c + a).collect();
                    self.probability(&parts)
                })
                .collect();
            values.sort_by(f64::total_cmp);
            let mean = values.iter().sum::<f64>() / BRAKES as f64;
            let square = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
            let quantile = |level: f64| {
                let place = level * (BRAKES - 1) as f64;
                let k = place as usize;
                let next = values[(k + 1).min(BRAKES - 1)];
                values[k] + (place - k as f64) * (next - values[k])
            };
            let found = [mean, (square / BRAKES as f64).sqrt(), quantile(0.05), quantile(0.95)];
            for (sum, value) in sums.iter_mut().zip(found) {
                *sum += value / KNOWLEDGE as f64;
            }
        }
        let [mean, standard_deviation, lower, upper] = sums;
        let index_standard_deviation = self.index_deviation(covariance);
        Band { mean, standard_deviation, lower, upper, index_standard_deviation }
    }
}

/// A lower triangular factor of a positive semi-definite matrix: Cholesky's, with columns of nothing where
/// nothing is left.
fn factor(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    const NOTHING: f64 = 1e-14;
    let n = matrix.nrows();
    let mut lower = DMatrix::<f64>::zeros(n, n);
    for j in 0..n {
        let own: f64 = (0..j).map(|k| lower[(j, k)] * lower[(j, k)]).sum();
        let left = matrix[(j, j)] - own;
        if left <= NOTHING {
            continue;
        }
        let pivot = left.sqrt();
        lower[(j, j)] = pivot;
        for i in j + 1..n {
            let shared: f64 = (0..j).map(|k| lower[(i, k)] * lower[(j, k)]).sum();
            lower[(i, j)] = (matrix[(i, j)] - shared) / pivot;
        }
    }
    lower
}

fn times(lower: &DMatrix<f64>, z: &[f64]) -> Vec<f64> {
    (0..lower.nrows()).map(|i| (0..=i).map(|j| lower[(i, j)] * z[j]).sum()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn time_and_heat() -> HalfSpaces {
        let mut spaces = HalfSpaces {
            epistemic: vec![vec![0.8, 0.0], vec![-0.3, 0.4]],
            aleatory: vec![vec![-0.6], vec![0.5]],
            distances: vec![0.3, 2.5],
            draws: Vec::new(),
            index_slopes: Vec::new(),
            left_out: Vec::new(),
            probabilities: Vec::new(),
        };
        spaces.differentiate();
        spaces
    }

    #[test]
    fn analytic_two_planes_across_one_aleatory_coordinate() {
        let spaces = time_and_heat();
        // −0.6 z > 0.3 below z = −0.5, 0.5 z > 2.5 above z = 5.
        let expected = normal::cdf(-0.5) + normal::survival(5.0);
        assert!((spaces.probability(&[0.0, 0.0]) - expected).abs() < 1e-15);
        // A brake so slow that time fails below z = 14.5 and heat above 5 keeps both nowhere.
        assert_eq!(spaces.probability(&[9.0, 0.0]), 1.0);
    }

    #[test]
    fn analytic_a_known_brake_has_no_band_and_the_prior_is_one_state_of_knowledge() {
        let spaces = time_and_heat();
        let known = spaces.band(7, &DMatrix::zeros(2, 2));
        assert!(known.standard_deviation < 1e-14 && known.upper == known.lower);
        let prior = spaces.band(7, &DMatrix::identity(2, 2));
        assert!(prior.lower < 0.05 && prior.upper > 0.9, "{prior:?}");
        // P over everything is that of the planes, whatever is known: opposite pairs see it to 1 %.
        let whole = normal::survival(0.3);
        assert!((prior.mean - whole).abs() < 0.02 && (known.mean - whole).abs() < 0.05);
        let half = spaces.band(7, &(DMatrix::identity(2, 2) * 0.25));
        assert!(half.standard_deviation < prior.standard_deviation);
        assert!(
            (half.index_standard_deviation - 0.5 * prior.index_standard_deviation).abs() < 1e-12
        );
    }
}
