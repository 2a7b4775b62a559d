//! How a channel's readings differ from what a model predicts: white noise of the sensor, and the model's own
//! discrepancy, an Ornstein–Uhlenbeck process.
//!
//! `y_k = prediction_k + δ(t_k) + ε_k`, where `δ` has mean zero, standard deviation `a` and the correlation
//! `exp(−|Δt|/τ)`, and `ε_k` the variance `s² + v_k`. Its density is computed in one pass by the Kalman
//! recursion: with `φ = exp(−Δt/τ)`, the discrepancy given the readings before has mean `φ m` and variance
//! `φ² P + a² (1 − φ²)`; each reading's density given those before is normal about `prediction + φ m` with the sum
//! `S` of the variances (Rasmussen and Williams, *Gaussian Processes for Machine Learning*, B.2; Särkkä,
//! *Bayesian Filtering and Smoothing*, ch. 4).
//!
//! With heavy tails each of these densities is Student's t of scale `√S` instead, and a reading that lies far out
//! moves the discrepancy by less: its own variance counts `1/w` times, `w = (ν + 1)/(ν + e²/S)` (Agamennoni, Nieto
//! and Nebot, 2011). The product of densities of each reading given those before is a density of all of them, whatever
//! the recursion does in between.

use crate::numerics::elementary;
use crate::numerics::lanes::elementary::{exp, ln};
use crate::numerics::lanes::{InstructionSet, Lanes, Pair};
use crate::streams::{Stream, standard_normal};
use std::f64::consts::PI;

/// A reading of one channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Which moment of the record, for whoever predicts.
    pub moment: usize,
    /// When, s.
    pub time_s: f64,
    /// What was read, SI.
    pub value: f64,
    /// Variance known beforehand, besides the sensor's own: of the drive's reading, for one.
    pub variance: f64,
}

/// One channel of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// The readings, in the order of time.
    pub readings: Vec<Reading>,
    /// Degrees of freedom ν of heavy-tailed noise; none for normal noise.
    pub degrees_of_freedom: Option<f64>,
}

/// The noise of a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise<V = f64> {
    /// Standard deviation of the sensor `s`.
    pub sensor_sd: V,
    /// Standard deviation of the discrepancy `a`.
    pub discrepancy_sd: V,
    /// Correlation time of the discrepancy `τ`, s.
    pub correlation_time_s: V,
}

/// The noise of a channel at many points, one entry a point.
#[derive(Debug, Clone, Copy)]
pub struct NoiseColumns<'a> {
    /// See [`Noise::sensor_sd`].
    pub sensor_sd: &'a [f64],
    /// See [`Noise::discrepancy_sd`].
    pub discrepancy_sd: &'a [f64],
    /// See [`Noise::correlation_time_s`].
    pub correlation_time_s: &'a [f64],
}

/// The discrepancy as far as the readings so far tell, in as many lanes.
struct Filter<V> {
    sensor_variance: V,
    stationary: V,
    rate: V,
    mean: V,
    variance: V,
    interval_s: f64,
    keeps: V,
}

/// A reading seen from those before it.
struct Innovation<V> {
    difference: V,
    variance: V,
}

impl<V: Lanes> Filter<V> {
    #[inline(always)]
    fn new(noise: &Noise<V>) -> Self {
        let stationary = noise.discrepancy_sd * noise.discrepancy_sd;
        Filter {
            sensor_variance: noise.sensor_sd * noise.sensor_sd,
            stationary,
            rate: V::splat(-1.0) / noise.correlation_time_s,
            mean: V::splat(0.0),
            variance: stationary,
            interval_s: 0.0,
            keeps: V::splat(1.0),
        }
    }

    /// Moves on by `interval_s`.
    #[inline(always)]
    fn wait(&mut self, interval_s: f64) {
        // Clocks tick evenly but for rounding: one exponential serves them all.
        if (interval_s - self.interval_s).abs() > 1e-7 * interval_s {
            self.interval_s = interval_s;
            self.keeps = exp(V::splat(interval_s) * self.rate);
        }
        self.mean = self.keeps * self.mean;
        let spread = self.variance - self.stationary;
        self.variance = (self.keeps * self.keeps).mul_add(spread, self.stationary);
    }

    /// Takes in a residual `y − prediction`.
    #[inline(always)]
    fn take(&mut self, residual: V, known_variance: f64, degrees: Option<f64>) -> Innovation<V> {
        let own = self.sensor_variance + V::splat(known_variance);
        let innovation =
            Innovation { difference: residual - self.mean, variance: self.variance + own };
        let (gain, left) = match degrees {
            None => {
                let gain = self.variance / innovation.variance;
                (gain, gain * own)
            }
            Some(degrees) => {
                let square = innovation.difference * innovation.difference / innovation.variance;
                let doubt = (square + V::splat(degrees)) * V::splat(1.0 / (degrees + 1.0));
                let gain = self.variance / own.mul_add(doubt, self.variance);
                (gain, gain * own * doubt)
            }
        };
        self.mean = gain.mul_add(innovation.difference, self.mean);
        self.variance = left;
        innovation
    }
}

/// ln of the factor of Student's density that depends on ν alone, with scale one.
fn student_constant(degrees: f64) -> f64 {
    elementary::ln_gamma(0.5 * (degrees + 1.0))
        - elementary::ln_gamma(0.5 * degrees)
        - 0.5 * elementary::ln(degrees * PI)
}

#[inline(always)]
fn ln_likelihood<V: Lanes>(series: &Series, noise: &Noise<V>, predicted: impl Fn(usize) -> V) -> V {
    let degrees = series.degrees_of_freedom;
    let constant = degrees.map_or(-0.5 * elementary::ln(2.0 * PI), student_constant);
    let mut filter = Filter::new(noise);
    let mut sum = V::splat(constant * series.readings.len() as f64);
    let mut before: Option<f64> = None;
    let half = V::splat(-0.5);
    for reading in &series.readings {
        if let Some(before) = before.replace(reading.time_s) {
            filter.wait(reading.time_s - before);
        }
        let residual = V::splat(reading.value) - predicted(reading.moment);
        let Innovation { difference, variance } = filter.take(residual, reading.variance, degrees);
        let square = difference * difference / variance;
        let tail = match degrees {
            None => square,
            Some(degrees) => {
                let share = square.mul_add(V::splat(1.0 / degrees), V::splat(1.0));
                V::splat(degrees + 1.0) * ln(share)
            }
        };
        sum = half.mul_add(ln(variance) + tail, sum);
    }
    sum
}

/// ln of the density of a series at one point; `predicted` gives the prediction at a moment.
pub fn ln_density(series: &Series, noise: &Noise, predicted: impl Fn(usize) -> f64) -> f64 {
    ln_likelihood::<f64>(series, noise, predicted)
}

/// Adds ln of the density of a series to every point's `sums`; `predicted` gives the prediction at a moment for a
/// point. The bits are those of [`ln_density`] with every instruction set.
pub fn add_ln_density(
    set: InstructionSet,
    series: &Series,
    noise: NoiseColumns<'_>,
    predicted: impl Fn(usize, usize) -> f64,
    sums: &mut [f64],
) {
    match set {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the features were detected.
        InstructionSet::Avx512 if set.is_available() => unsafe {
            avx512(series, noise, predicted, sums)
        },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the features were detected.
        InstructionSet::Avx2 if set.is_available() => unsafe {
            avx2(series, noise, predicted, sums)
        },
        _ => with_lanes::<f64>(series, noise, predicted, sums),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx2,fma")]
fn avx512(
    series: &Series,
    noise: NoiseColumns<'_>,
    predicted: impl Fn(usize, usize) -> f64,
    sums: &mut [f64],
) {
    with_lanes::<Pair<crate::numerics::lanes::avx512::Octet>>(series, noise, predicted, sums);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn avx2(
    series: &Series,
    noise: NoiseColumns<'_>,
    predicted: impl Fn(usize, usize) -> f64,
    sums: &mut [f64],
) {
    with_lanes::<Pair<crate::numerics::lanes::avx2::Quartet>>(series, noise, predicted, sums);
}

#[inline(always)]
fn with_lanes<V: Lanes>(
    series: &Series,
    noise: NoiseColumns<'_>,
    predicted: impl Fn(usize, usize) -> f64,
    sums: &mut [f64],
) {
    for (group, sums) in sums.chunks_mut(V::WIDTH).enumerate() {
        let start = group * V::WIDTH;
        let count = sums.len();
        let load = |column: &[f64]| {
            // Lanes to spare repeat the first.
            let mut lanes = V::splat(column[start]);
            lanes.lanes_mut()[..count].copy_from_slice(&column[start..start + count]);
            lanes
        };
        let noise = Noise {
            sensor_sd: load(noise.sensor_sd),
            discrepancy_sd: load(noise.discrepancy_sd),
            correlation_time_s: load(noise.correlation_time_s),
        };
        let density = ln_likelihood::<V>(series, &noise, |moment| {
            let mut lanes = V::splat(predicted(moment, start));
            for (k, lane) in lanes.lanes_mut()[..count].iter_mut().enumerate().skip(1) {
                *lane = predicted(moment, start + k);
            }
            lanes
        });
        for (sum, &density) in sums.iter_mut().zip(density.lanes()) {
            *sum += density;
        }
    }
}

/// A reading as the noise sees it, given the readings before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Standardised {
    /// Its difference from what was expected of it, in standard deviations (of t: in scales).
    pub score: f64,
    /// Standard deviation (or scale), SI.
    pub sd: f64,
    /// The discrepancy expected of it, SI.
    pub discrepancy: f64,
}

/// Every reading given those before it: standard normal and independent if the noise is what it is said to be.
pub fn standardised(
    series: &Series,
    noise: &Noise,
    predicted: impl Fn(usize) -> f64,
) -> Vec<Standardised> {
    let mut filter = Filter::<f64>::new(noise);
    let mut before: Option<f64> = None;
    let mut all = Vec::with_capacity(series.readings.len());
    for reading in &series.readings {
        if let Some(before) = before.replace(reading.time_s) {
            filter.wait(reading.time_s - before);
        }
        let discrepancy = filter.mean;
        let residual = reading.value - predicted(reading.moment);
        let seen = filter.take(residual, reading.variance, series.degrees_of_freedom);
        let sd = seen.variance.sqrt();
        all.push(Standardised { score: seen.difference / sd, sd, discrepancy });
    }
    all
}

/// The linear map that makes a series' readings independent with variance one, applied to several columns: the
/// residuals first, then whatever else is linear in them (derivatives of the predictions, with their sign).
///
/// With heavy tails the residuals decide how much each reading counts, and the map is linear given that.
pub fn whiten(series: &Series, noise: &Noise, columns: &mut [Vec<f64>]) {
    let Some((residuals, others)) = columns.split_first_mut() else { return };
    let mut filter = Filter::<f64>::new(noise);
    let mut means = vec![0.0; others.len()];
    let mut before: Option<f64> = None;
    for (k, reading) in series.readings.iter().enumerate() {
        if let Some(before) = before.replace(reading.time_s) {
            filter.wait(reading.time_s - before);
            means.iter_mut().for_each(|mean| *mean *= filter.keeps);
        }
        let spread = filter.variance;
        let own = filter.sensor_variance + reading.variance;
        let seen = filter.take(residuals[k], reading.variance, series.degrees_of_freedom);
        let doubt = series.degrees_of_freedom.map_or(1.0, |degrees| {
            (degrees + seen.difference * seen.difference / seen.variance) / (degrees + 1.0)
        });
        let gain = spread / (spread + own * doubt);
        let scale = 1.0 / (seen.variance * doubt).sqrt();
        residuals[k] = seen.difference * scale;
        for (column, mean) in others.iter_mut().zip(&mut means) {
            let difference = column[k] - *mean;
            *mean += gain * difference;
            column[k] = difference * scale;
        }
    }
}

/// Errors drawn for every reading of a series: discrepancy and normal sensor error together, SI.
pub fn drawn_errors(series: &Series, noise: &Noise, stream: &mut Stream) -> Vec<f64> {
    let mut discrepancy = noise.discrepancy_sd * standard_normal(stream);
    let mut before: Option<f64> = None;
    let mut errors = Vec::with_capacity(series.readings.len());
    for reading in &series.readings {
        if let Some(before) = before.replace(reading.time_s) {
            let interval_s = reading.time_s - before;
            let keeps = elementary::exp(-interval_s / noise.correlation_time_s);
            let fresh = noise.discrepancy_sd * (1.0 - keeps * keeps).max(0.0).sqrt();
            discrepancy = keeps * discrepancy + fresh * standard_normal(stream);
        }
        let own = (noise.sensor_sd * noise.sensor_sd + reading.variance).sqrt();
        errors.push(discrepancy + own * standard_normal(stream));
    }
    errors
}
