//! The Kalman recursion against the dense covariance that it stands for.

use nalgebra::{Cholesky, DMatrix, DVector};
use reeldown::calibration::noise::{
    Noise, NoiseColumns, Reading, Series, add_ln_density, ln_density, standardised, whiten,
};
use reeldown::numerics::lanes::InstructionSet;
use std::f64::consts::PI;

const NOISE: Noise = Noise { sensor_sd: 0.3, discrepancy_sd: 0.8, correlation_time_s: 7.0 };

/// Readings at uneven times, some with a variance of their own.
fn series(degrees_of_freedom: Option<f64>) -> Series {
    let readings = (0..25)
        .map(|k| {
            let t = k as f64;
            Reading {
                moment: k,
                time_s: t + if k > 10 { 4.5 } else { 0.0 } + 0.2 * (3.0 * t).sin(),
                value: 2.0 + (0.7 * t).sin() + 0.3 * (11.0 * t).cos(),
                variance: if k % 3 == 0 { 0.05 } else { 0.0 },
            }
        })
        .collect();
    Series { readings, degrees_of_freedom }
}

fn predicted(moment: usize) -> f64 {
    1.9 + 0.01 * moment as f64
}

fn dense(series: &Series) -> (DMatrix<f64>, DVector<f64>) {
    let readings = &series.readings;
    let n = readings.len();
    let covariance = DMatrix::from_fn(n, n, |i, j| {
        let apart = (readings[i].time_s - readings[j].time_s).abs();
        let smooth = NOISE.discrepancy_sd.powi(2) * (-apart / NOISE.correlation_time_s).exp();
        let own = NOISE.sensor_sd.powi(2) + readings[i].variance;
        smooth + if i == j { own } else { 0.0 }
    });
    (covariance, DVector::from_fn(n, |i, _| readings[i].value - predicted(i)))
}

#[test]
fn analytic_density_is_that_of_the_dense_covariance() {
    let series = series(None);
    let (covariance, residuals) = dense(&series);
    let factor = Cholesky::new(covariance).expect("positive definite");
    let ln_determinant: f64 = 2.0 * factor.l().diagonal().iter().map(|x| x.ln()).sum::<f64>();
    let square = residuals.dot(&factor.solve(&residuals));
    let truth = -0.5 * (square + ln_determinant + 25.0 * (2.0 * PI).ln());
    let found = ln_density(&series, &NOISE, predicted);
    // A hundred operations on numbers of order one.
    assert!((found - truth).abs() < 1e-11, "{found} {truth}");
}

#[test]
fn analytic_whitening_is_the_inverse_of_the_cholesky_factor() {
    let series = series(None);
    let (covariance, residuals) = dense(&series);
    let lower = Cholesky::new(covariance).expect("positive definite").l();
    let other: Vec<f64> = (0..25).map(|k| (0.3 * k as f64).cos()).collect();
    let mut columns = [residuals.as_slice().to_vec(), other.clone()];
    whiten(&series, &NOISE, &mut columns);
    for (column, raw) in columns.iter().zip([residuals, DVector::from_vec(other)]) {
        let truth = lower.solve_lower_triangular(&raw).expect("a solution");
        for (found, truth) in column.iter().zip(truth.iter()) {
            assert!((found - truth).abs() < 1e-11, "{found} {truth}");
        }
    }
    let scores = standardised(&series, &NOISE, predicted);
    for (score, whitened) in scores.iter().zip(&columns[0]) {
        assert!((score.score - whitened).abs() < 1e-12);
    }
}

#[test]
fn property_lanes_give_the_scalar_bits_with_every_instruction_set() {
    for degrees in [None, Some(4.0)] {
        let series = series(degrees);
        let points = 37;
        let spread = |base: f64| -> Vec<f64> {
            (0..points).map(|k| base * (1.0 + 0.02 * k as f64)).collect()
        };
        let (sensor, discrepancy, time) = (spread(0.3), spread(0.8), spread(7.0));
        let noise = NoiseColumns {
            sensor_sd: &sensor,
            discrepancy_sd: &discrepancy,
            correlation_time_s: &time,
        };
        let at = |moment: usize, point: usize| predicted(moment) + 0.01 * point as f64;
        for set in InstructionSet::ALL.into_iter().filter(|set| set.is_available()) {
            let mut sums = vec![0.0; points];
            add_ln_density(set, &series, noise, at, &mut sums);
            for (k, sum) in sums.iter().enumerate() {
                let noise = Noise {
                    sensor_sd: sensor[k],
                    discrepancy_sd: discrepancy[k],
                    correlation_time_s: time[k],
                };
                let alone = ln_density(&series, &noise, |moment| at(moment, k));
                assert_eq!(sum.to_bits(), alone.to_bits(), "{set:?} {k}");
            }
        }
    }
}

#[test]
fn analytic_heavy_tails_integrate_to_one_and_approach_the_normal_law() {
    // The density of two readings, integrated over both by a fine sum: a density whatever the recursion does.
    let two = |a: f64, b: f64| {
        let mut series = series(Some(4.0));
        series.readings.truncate(2);
        for (reading, value) in series.readings.iter_mut().zip([a, b]) {
            reading.value = value;
        }
        ln_density(&series, &NOISE, |_| 0.0).exp()
    };
    let step = 0.25;
    let mut sum = 0.0;
    for i in -400..=400 {
        for j in -400..=400 {
            sum += two(f64::from(i) * step, f64::from(j) * step) * step * step;
        }
    }
    // Beyond 100 each t of four degrees and scale 0.9 has 1e-8; the sum's own error is far below 1e-3.
    assert!((sum - 1.0).abs() < 1e-3, "{sum}");
    let normal = ln_density(&series(None), &NOISE, predicted);
    let nearly = ln_density(&series(Some(1e8)), &NOISE, predicted);
    assert!((normal - nearly).abs() < 1e-4, "{normal} {nearly}");
}
