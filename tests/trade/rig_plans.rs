//! The plan of rig tests: its half spaces against descents by brute force.

use reeldown::campaign::{Ensemble, Progress};
use reeldown::descent::driven::Drive;
use reeldown::findings::rig::information::{Parameters, information, posterior};
use reeldown::findings::rig::{Equipment, HalfSpaces};
use reeldown::numerics::columns::Columns;
use reeldown::numerics::special::normal;
use reeldown::reliability::draws::standard_normal;
use reeldown::streams::{Purpose, stream};
use reeldown::study::Study;

/// Brakes per state of knowledge, and launch days per brake.
const BRAKES: usize = 60;
const DAYS: usize = 25;

/// P(any breach) of brakes drawn about a state of knowledge, by descents, one a launch day: mean over the states of
/// the standard deviation, and of the mean.
fn by_descents(
    study: &Study,
    parameters: &Parameters,
    covariance: &nalgebra::DMatrix<f64>,
    states: usize,
) -> (f64, f64) {
    let count = parameters.count();
    let identity = nalgebra::DMatrix::<f64>::identity(count, count);
    let root = |matrix: &nalgebra::DMatrix<f64>| {
        let jitter = &identity * 1e-9;
        nalgebra::Cholesky::new(matrix + jitter).expect("positive definite").l()
    };
    let (moves, within) = (root(&(&identity - covariance)), root(covariance));
    let day = (0..study.inputs.len()).find(|k| !parameters.inputs.contains(k)).expect("a day");
    let ensemble = Ensemble::new(study);
    let (mut spread, mut mean) = (0.0, 0.0);
    for state in 0..states {
        let mut random = stream(7, Purpose::Test, (state / 2) as u64);
        let sign = if state % 2 == 0 { 1.0 } else { -1.0 };
        let mut vector = || nalgebra::DVector::from_fn(count, |_, _| standard_normal(&mut random));
        let centre = &moves * vector() * sign;
        let mut points = Columns::new(BRAKES * DAYS, study.inputs.len());
        for brake in 0..BRAKES {
            let u = &centre + &within * vector();
            for k in 0..DAYS {
                let row = brake * DAYS + k;
                for (j, &input) in parameters.inputs.iter().enumerate() {
                    points.set(row, input, u[j]);
                }
                points.set(row, day, normal::quantile((k as f64 + 0.5) / DAYS as f64));
            }
        }
        let outcomes = ensemble.at_standard_normal(&points, &Progress::default());
        let breached: Vec<bool> = (0..BRAKES * DAYS)
            .map(|row| {
                study.limits.iter().any(|l| l.margin_of(outcomes.outcome(l.outcome)[row]) < 0.0)
            })
            .collect();
        let values: Vec<f64> = breached
            .chunks(DAYS)
            .map(|days| days.iter().filter(|b| **b).count() as f64 / DAYS as f64)
            .collect();
        let own = values.iter().sum::<f64>() / BRAKES as f64;
        let square = values.iter().map(|v| (v - own) * (v - own)).sum::<f64>() / BRAKES as f64;
        mean += own / states as f64;
        spread += square.sqrt() / states as f64;
    }
    (mean, spread)
}

#[test]
fn reference_brute_force_on_one_candidate_and_on_none() {
    let study = crate::habe::pinned(&[]);
    let parameters = Parameters::new(&study);
    let spaces = HalfSpaces::new(&study, &parameters.inputs, &Progress::default()).unwrap();
    let count = parameters.count();
    let equipment = Equipment::assumed(&study.design).expect("a flight");
    let run =
        information(&parameters, &equipment.instruments, 288.7, Drive::Force, 21_900.0, 222.0);
    let after = posterior(count, &[&run.expect("a run")]);
    for (covariance, states) in
        [(nalgebra::DMatrix::identity(count, count) * 0.999, 8), (after, 40)]
    {
        let (mean, spread) = by_descents(&study, &parameters, &covariance, states);
        let band = spaces.band(study.sampling.seed, &covariance);
        println!(
            "P {mean:.4} (half spaces {:.4}), sd {spread:.4} ({:.4})",
            band.mean, band.standard_deviation
        );
        // Half spaces leave out curvature; descents see few states, brakes and days. Opposite states make the
        // means agree to two points; spreads to a tenth, with what 25 days resolve (0.04 steps).
        assert!((mean - band.mean).abs() < 0.025, "{mean} {}", band.mean);
        assert!((spread / band.standard_deviation - 1.0).abs() < 0.12, "{spread} {band:?}");
    }
}
