//! Calibrations of made-up data whose truth is known: the short form of `examples/calibration_certificate.rs`.

use crate::campaign;
use crate::repetitions::{chi_squared, from_prior, of_campaign, problem, small_plan};
use reeldown::calibration::{LeastSquares, LogLikelihood};
use reeldown::numerics::columns::Columns;
use reeldown::numerics::special::{binomial, chi_squared as chi};
use reeldown::study::Study;

/// Repetitions of the short form.
const SHORT: u64 = 6;

#[test]
fn analytic_ranks_of_truths_from_the_prior_are_uniform_and_regions_hold_them() {
    let study = Study::load(None, &[]).expect("the embedded study");
    let problem = problem(&study);
    let all: Vec<_> =
        (0..SHORT).map(|k| from_prior(&study, &problem, 100 + k, small_plan)).collect();
    let inside = all.iter().filter(|repetition| repetition.inside).count() as u64;
    // Fewer than this many of them inside has less than one chance in a thousand.
    let least = (0..=SHORT).find(|&k| binomial::cdf(k, SHORT, 0.95) > 1e-3).unwrap_or(0);
    assert!(inside >= least, "{inside} of {SHORT}");
    // Ranks of different coordinates of one repetition hardly depend on each other: together they are uniform.
    let ranks: Vec<f64> = all.iter().flat_map(|r| r.ranks.iter().map(|rank| rank.1)).collect();
    let p = chi::survival(4.0, chi_squared(&ranks, 5));
    assert!(p > 1e-4, "{p}: {ranks:?}");
}

/// The campaign's truth with its noise drawn anew. Two repetitions with 400 particles: both regions miss it with one
/// chance in 400.
#[test]
fn property_the_campaign_s_truth_lies_in_the_region_of_a_repetition() {
    let study = Study::load(None, &[]).expect("the embedded study");
    let both: Vec<_> = (0..2).map(|k| of_campaign(&study, k)).collect();
    let failures: Vec<_> = both.iter().flat_map(|repetition| &repetition.failures).collect();
    assert!(both.iter().any(|repetition| repetition.inside), "gates that failed: {failures:?}");
}

#[test]
fn property_the_least_squares_form_is_the_likelihood_s_own_slope() {
    let study = Study::load(None, &[]).expect("the embedded study");
    let problem = problem(&study);
    let z: Vec<f64> = (0..problem.dimension()).map(|j| 0.3 * ((j * 7 % 5) as f64 - 2.0)).collect();
    let whitened = problem.whitened(&z, true).expect("a model").expect("a possible brake");
    let n = problem.squared_dimension();
    let h = 1e-4;
    let mut rows = Vec::new();
    for j in 0..n {
        for side in [h, -h] {
            let mut row = z.clone();
            row[j] += side;
            rows.push(row);
        }
    }
    let mut values = vec![0.0; rows.len()];
    problem.ln_likelihood(&Columns::from_rows(&rows), &mut values).expect("likelihoods");
    for j in 0..n {
        let slope: f64 =
            -whitened.residuals.iter().zip(&whitened.jacobian[j]).map(|(r, d)| r * d).sum::<f64>();
        let difference = (values[2 * j] - values[2 * j + 1]) / (2.0 * h);
        // Differences of numbers of order 1e4 over 2e-4, and their own error h² times a third derivative.
        let scale = 1e-4 * (1.0 + slope.abs());
        assert!((slope - difference).abs() < scale.max(2e-4), "{j}: {slope} {difference}");
    }
}

#[test]
fn regression_the_shipped_campaign_is_what_its_command_makes() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    for (name, text) in campaign::runs(campaign::SEED).expect("the campaign") {
        let path = root.join("distributions/calibrated/campaign").join(name);
        let shipped = std::fs::read_to_string(&path).expect("a shipped run");
        assert!(shipped == text, "{name}: run `cargo run --release --example synthetic_campaign`");
    }
}
