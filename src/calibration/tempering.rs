//! Sequential Monte Carlo from a normal law to the posterior: one replicate.
//!
//! Particles start as draws of a normal law `q`, and the posterior is let in by degrees: at temperature `β` they stand for
//! `q^(1−β) × (prior × likelihood)^β`. Each `β` is the next at which the effective sample size of the weights has fallen to
//! a half; then the particles are resampled and moved (Del Moral, Doucet and Jasra, 2006; Jasra and others, 2011). The
//! product of the mean weights estimates the evidence, the likelihood's mean over the prior.
//!
//! Where `q` is the prior itself, the path is the usual one, prior × likelihood^β, and finds the posterior from nowhere;
//! but half-way, where data that is nearly ignored leaves noise and model free to take each other's place, it mixes slowly:
//! on the shipped campaign ln evidence was 11 too low with 3 to 9 moves a degree, 4 with 6 to 20, and right only with
//! 50 to 130. So that path serves as a pilot, and the replicates start from the normal law of the pilot's particles, widened:
//! a short path between two laws of much the same shape. What the pilot has missed altogether they miss too.
//!
//! Moves are Metropolis–Hastings steps of two kinds in turn, both shaped by the particles' own mean and covariance: two of
//! preconditioned Crank–Nicolson type, `z′ = m + √(1 − s²)(z − m) + s L ξ`, which leave the normal law N(m, LLᵀ)
//! as it is, so that where the posterior is nearly normal long steps are accepted in any dimension (Cotter and others,
//! 2013); and one random walk, which also moves a particle that sits where that normal law has no mass to speak of. They go on
//! until particles have forgotten where they were resampled: until the correlation of each coordinate with its value
//! before has fallen to a bound.

use super::cloud::{correlation, different};
use super::likelihood::LogLikelihood;
use crate::error::{Error, Result};
use crate::numerics::columns::Columns;
use crate::numerics::elementary::{exp, ln};
use crate::streams::{Purpose, Stream, open_uniform, standard_normal, stream};
use nalgebra::{Cholesky, DMatrix, DVector};

/// Share of the particles that the weights of one degree must leave.
const KEPT: f64 = 0.5;
/// Degrees at most.
const MOST_DEGREES: usize = 200;
/// Shares of accepted moves that step lengths are steered to.
const WANTED: [f64; 2] = [0.35, 0.25];

/// How a posterior is sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// Particles of each replicate.
    pub particles: usize,
    /// Independent replicates.
    pub replicates: u32,
    /// Seed of the random streams.
    pub seed: u64,
    /// Correlation with the values before at which the moves of a degree end.
    pub forgotten: f64,
    /// The same for the last degree.
    pub forgotten_at_last: f64,
    /// Moves of the last degree at least.
    pub least_last_moves: usize,
    /// Moves of a degree at most.
    pub most_moves: usize,
}

impl Plan {
    /// The usual plan, with the seed of every stream.
    pub fn seeded(seed: u64) -> Self {
        Plan {
            particles: 1000,
            replicates: 4,
            seed,
            forgotten: 0.2,
            forgotten_at_last: 0.1,
            least_last_moves: 15,
            most_moves: 120,
        }
    }

    /// The pilot's plan: the same particles, moved just enough to follow the path.
    pub(super) fn pilot(&self) -> Self {
        Plan { forgotten: 0.5, forgotten_at_last: 0.3, least_last_moves: 15, ..*self }
    }
}

/// A normal law to start from.
#[derive(Debug, Clone)]
pub struct Start {
    normal: Normal,
}

/// Variances of the pilot's particles are multiplied by this: the tails of the start must hold the posterior's.
const WIDENED: f64 = 1.7;

impl Start {
    /// The widened normal law of a replicate's particles.
    ///
    /// # Errors
    /// If they are too few for their dimension.
    pub fn about(replicate: &Replicate) -> Result<Self> {
        let n = replicate.particles.rows();
        let weights = vec![1.0 / n as f64; n];
        Ok(Start { normal: Normal::of(&replicate.particles, &weights, WIDENED)? })
    }
}

/// The same for the law about which particles move. One that is as wide as the particles seldom proposes the tails that a
/// few hundred particles in thirty dimensions lack after a resampling: on a linear-normal problem of 34 dimensions the
/// draws of 400 particles then had 0.966 of the posterior's squared distance, with this and `forgotten_at_last` 0.1 they
/// have 1.00, and 1.01 of 1000.
const REFERENCE_WIDENED: f64 = 1.15;

/// One replicate: equally weighted draws of the posterior.
#[derive(Debug, Clone)]
pub struct Replicate {
    /// The draws, one row a particle.
    pub particles: Columns,
    /// ln of the likelihood of each.
    pub ln_likelihood: Vec<f64>,
    /// ln of the evidence.
    pub ln_evidence: f64,
    /// The degrees, ending with 1.
    pub temperatures: Vec<f64>,
    /// Moves of each degree.
    pub moves: Vec<usize>,
    /// Share of the moves accepted, both kinds, in the last degree.
    pub accepted: f64,
    /// Largest correlation of a coordinate with its value before the last degree's moves.
    pub remembered: f64,
    /// Different particles among those resampled for the last degree.
    pub ancestors: usize,
    /// Different particles at the end.
    pub unique: usize,
    /// Likelihoods computed.
    pub evaluations: u64,
    /// Proposals of moves at which the model could not be computed.
    pub impossible: u64,
}

/// Particles on their way.
struct Cloud<'a> {
    target: &'a dyn LogLikelihood,
    start: Option<&'a Normal>,
    z: Columns,
    ln_likelihood: Vec<f64>,
    /// ln of likelihood × prior over the start.
    ratio: Vec<f64>,
    stream: Stream,
    evaluations: u64,
    impossible: u64,
}

/// Samples one replicate, from `start`, or from the prior.
///
/// # Errors
/// Those of the likelihood; if no draw of the start is possible; if the temperature sticks.
pub fn replicate(
    target: &dyn LogLikelihood,
    start: Option<&Start>,
    plan: &Plan,
    index: u32,
) -> Result<Replicate> {
    let (n, d) = (plan.particles, target.dimension());
    let mut cloud = Cloud {
        target,
        start: start.map(|start| &start.normal),
        z: Columns::new(n, d),
        ln_likelihood: Vec::new(),
        ratio: Vec::new(),
        stream: stream(plan.seed, Purpose::Calibration, u64::from(index)),
        evaluations: 0,
        impossible: 0,
    };
    for k in 0..n {
        let draw = DVector::from_fn(d, |_, _| standard_normal(&mut cloud.stream));
        let point = cloud.start.map_or_else(|| draw.as_slice().to_vec(), |start| start.at(&draw));
        for (j, value) in point.into_iter().enumerate() {
            cloud.z.set(k, j, value);
        }
    }
    cloud.ln_likelihood = cloud.evaluate(&cloud.z.clone())?;
    cloud.ratio = (0..n).map(|k| cloud.ratio(&cloud.z.row(k), cloud.ln_likelihood[k])).collect();
    let mut beta = 0.0;
    let mut ln_evidence = 0.0;
    let mut temperatures = Vec::new();
    let mut moves = Vec::new();
    let mut lengths = [0.8, 2.38 / (d as f64).sqrt()];
    let (mut accepted, mut remembered, mut ancestors) = (0.0, 1.0, n);
    while beta < 1.0 {
        let step = next_degree(&cloud.ratio, 1.0 - beta)?;
        beta = if step >= 1.0 - beta { 1.0 } else { beta + step };
        let (weights, ln_mean) = weights(&cloud.ratio, step);
        ln_evidence += ln_mean;
        temperatures.push(beta);
        if temperatures.len() > MOST_DEGREES || !ln_mean.is_finite() {
            return Err(Error::argument(
                "the posterior is not reached from the prior: the data contradicts the card, or one of its units is wrong",
            ));
        }
        let reference = Normal::of(&cloud.z, &weights, REFERENCE_WIDENED)?;
        ancestors = cloud.resample(&weights);
        let last = beta >= 1.0;
        let bound = if last { plan.forgotten_at_last } else { plan.forgotten };
        let start = cloud.z.clone();
        let mut made = 0;
        let mut shares = Vec::new();
        loop {
            for kind in [0, 0, 1] {
                let share = cloud.advance(&reference, beta, kind, lengths[kind])?;
                let most = if kind == 0 { 1.0 } else { 5.0 };
                lengths[kind] = (lengths[kind] * exp(share - WANTED[kind])).clamp(0.01, most);
                shares.push(share);
                made += 1;
            }
            remembered = correlation(&start, &cloud.z);
            let enough = !last || made >= plan.least_last_moves;
            if (remembered <= bound && enough) || made >= plan.most_moves {
                break;
            }
        }
        accepted = shares.iter().sum::<f64>() / shares.len() as f64;
        moves.push(made);
    }
    let unique = different(&cloud.z);
    Ok(Replicate {
        unique,
        particles: cloud.z,
        ln_likelihood: cloud.ln_likelihood,
        ln_evidence,
        temperatures,
        moves,
        accepted,
        remembered,
        ancestors,
        evaluations: cloud.evaluations,
        impossible: cloud.impossible,
    })
}

/// The step of the temperature that leaves [`KEPT`] of the particles, at most `rest`.
fn next_degree(ratio: &[f64], rest: f64) -> Result<f64> {
    if ratio.iter().all(|value| !value.is_finite()) {
        return Err(Error::argument(
            "the data is impossible at every draw of the prior: a unit may be wrong, or the run is of another brake",
        ));
    }
    let kept = |step: f64| {
        let (weights, _) = weights(ratio, step);
        let squares: f64 = weights.iter().map(|w| w * w).sum();
        1.0 / squares
    };
    let wanted = KEPT * ratio.len() as f64;
    if kept(rest) >= wanted {
        return Ok(rest);
    }
    let (mut low, mut high) = (0.0, rest);
    // Relative to where it ends: early degrees are tiny where the data is precise.
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if kept(middle) >= wanted {
            low = middle
        } else {
            high = middle
        }
        if high - low <= 1e-3 * high {
            break;
        }
    }
    Ok(if low > 0.0 { low } else { high })
}

/// Weights that sum to one of ratio^step, and ln of their mean before.
fn weights(ratio: &[f64], step: f64) -> (Vec<f64>, f64) {
    let finite = |value: f64| if value.is_nan() { f64::NEG_INFINITY } else { value };
    let top = ratio.iter().map(|&value| finite(value)).fold(f64::NEG_INFINITY, f64::max);
    let mut weights: Vec<f64> = ratio
        .iter()
        .map(|&value| match finite(value) {
            value if value > f64::NEG_INFINITY => exp(step * (value - top)),
            _ => 0.0,
        })
        .collect();
    let sum: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|weight| *weight /= sum);
    (weights, step * top + ln(sum / ratio.len() as f64))
}

impl Cloud<'_> {
    fn evaluate(&mut self, z: &Columns) -> Result<Vec<f64>> {
        let mut values = vec![f64::NAN; z.rows()];
        self.target.ln_likelihood(z, &mut values)?;
        self.evaluations += z.rows() as u64;
        Ok(values)
    }

    /// ln of likelihood × prior over the start, at a point.
    fn ratio(&self, z: &[f64], ln_likelihood: f64) -> f64 {
        match self.start {
            None => ln_likelihood,
            Some(start) => {
                // Both normal laws without their powers of 2π.
                let prior = -0.5 * z.iter().map(|x| x * x).sum::<f64>();
                ln_likelihood + prior + 0.5 * start.distance(z) + start.ln_root
            }
        }
    }

    /// ln of the start's density, up to a constant.
    fn ln_start(&self, z: &[f64]) -> f64 {
        match self.start {
            None => -0.5 * z.iter().map(|x| x * x).sum::<f64>(),
            Some(start) => -0.5 * start.distance(z),
        }
    }

    /// Systematic resampling; how many different particles are kept.
    fn resample(&mut self, weights: &[f64]) -> usize {
        let n = weights.len();
        let offset = open_uniform(&mut self.stream);
        let mut chosen = Vec::with_capacity(n);
        let (mut sum, mut k) = (weights[0], 0);
        for place in 0..n {
            let point = (place as f64 + offset) / n as f64;
            while sum < point && k + 1 < n {
                k += 1;
                sum += weights[k];
            }
            chosen.push(k);
        }
        let before = self.z.clone();
        for j in 0..before.columns() {
            for (value, &k) in self.z.column_mut(j).iter_mut().zip(&chosen) {
                *value = before.column(j)[k];
            }
        }
        self.ln_likelihood = chosen.iter().map(|&k| self.ln_likelihood[k]).collect();
        self.ratio = chosen.iter().map(|&k| self.ratio[k]).collect();
        chosen.dedup();
        chosen.len()
    }

    /// One move of every particle; the share accepted. Kind 0 is Crank–Nicolson's, 1 the random walk.
    fn advance(&mut self, reference: &Normal, beta: f64, kind: usize, length: f64) -> Result<f64> {
        let (n, d) = (self.z.rows(), self.z.columns());
        let mut proposed = Columns::new(n, d);
        let keeps = (1.0 - length * length).max(0.0).sqrt();
        let mut thresholds = Vec::with_capacity(n);
        let mut reference_change = Vec::with_capacity(n);
        for k in 0..n {
            let draw = DVector::from_fn(d, |_, _| standard_normal(&mut self.stream));
            let shift = &reference.root * draw;
            let here = self.z.row(k);
            let there: Vec<f64> = (0..d)
                .map(|j| match kind {
                    0 => {
                        let mean = reference.mean[j];
                        mean + keeps * (here[j] - mean) + length * shift[j]
                    }
                    _ => here[j] + length * shift[j],
                })
                .collect();
            for (j, &value) in there.iter().enumerate() {
                proposed.set(k, j, value);
            }
            let mut change = self.ln_start(&there) - self.ln_start(&here);
            if kind == 0 {
                change += 0.5 * (reference.distance(&there) - reference.distance(&here));
            }
            reference_change.push(change);
            thresholds.push(ln(open_uniform(&mut self.stream)));
        }
        let values = self.evaluate(&proposed)?;
        let mut accepted = 0;
        for k in 0..n {
            self.impossible += u64::from(!values[k].is_finite());
            let ratio = self.ratio(&proposed.row(k), values[k]);
            let gain = beta * (ratio - self.ratio[k]) + reference_change[k];
            if values[k].is_finite() && thresholds[k] < gain {
                accepted += 1;
                self.ratio[k] = ratio;
                self.ln_likelihood[k] = values[k];
                for j in 0..d {
                    self.z.set(k, j, proposed.get(k, j));
                }
            }
        }
        Ok(accepted as f64 / n as f64)
    }
}

/// A normal law.
#[derive(Debug, Clone)]
struct Normal {
    mean: Vec<f64>,
    root: DMatrix<f64>,
    inverse: DMatrix<f64>,
    /// ln of the root's determinant.
    ln_root: f64,
}

impl Normal {
    /// The normal law with the weighted particles' mean and `widened` times their covariance.
    fn of(z: &Columns, weights: &[f64], widened: f64) -> Result<Self> {
        let (n, d) = (z.rows(), z.columns());
        let mean: Vec<f64> =
            (0..d).map(|j| z.column(j).iter().zip(weights).map(|(z, w)| z * w).sum()).collect();
        let centred: Vec<Vec<f64>> =
            (0..d).map(|j| z.column(j).iter().map(|z| z - mean[j]).collect()).collect();
        let mut covariance = DMatrix::zeros(d, d);
        for i in 0..d {
            let weighted: Vec<f64> = centred[i].iter().zip(weights).map(|(z, w)| z * w).collect();
            for j in 0..=i {
                let sum: f64 = weighted.iter().zip(&centred[j]).map(|(a, b)| a * b).sum();
                covariance[(i, j)] = widened * sum;
                covariance[(j, i)] = widened * sum;
            }
        }
        // Weights that leave few particles make a covariance of low rank: a little of its own diagonal mends it.
        for i in 0..d {
            covariance[(i, i)] = covariance[(i, i)] * (1.0 + 1e-3) + 1e-12;
        }
        let degenerate = || {
            Error::argument(format!(
                "{n} particles are too few for {d} parameters: their covariance is singular"
            ))
        };
        let factor = Cholesky::new(covariance).ok_or_else(degenerate)?;
        let root = factor.l();
        let ln_root = root.diagonal().iter().map(|&entry| ln(entry)).sum();
        Ok(Normal { mean, inverse: factor.inverse(), root, ln_root })
    }

    /// The point of a standard-normal draw.
    fn at(&self, draw: &DVector<f64>) -> Vec<f64> {
        let shift = &self.root * draw;
        self.mean.iter().zip(shift.iter()).map(|(mean, shift)| mean + shift).collect()
    }

    /// Squared distance from the mean, in standard deviations.
    fn distance(&self, z: &[f64]) -> f64 {
        let from = DVector::from_fn(z.len(), |j, _| z[j] - self.mean[j]);
        from.dot(&(&self.inverse * &from))
    }
}
