//! Calibrations of made-up data whose truth is known: the short form of `examples/calibration_certificate.rs`.

use crate::campaign;
use crate::repetitions::{chi_squared, from_prior, of_campaign, problem, small_plan};
use reeldown::calibration::{LeastSquares, LogLikelihood};
use reeldown::campaign::calibration::{Channel, Coordinate, Options, RigLikelihood, plan};
use reeldown::numerics::columns::Columns;
use reeldown::numerics::special::{binomial, chi_squared as chi};
use reeldown::study::MeasuredRun;

/// Repetitions of the short form.
const SHORT: u64 = 6;

#[test]
fn analytic_ranks_of_truths_from_the_prior_are_uniform_and_regions_hold_them() {
    let study = crate::habe::pinned(&[]);
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
    let study = crate::habe::pinned(&[]);
    let both: Vec<_> = (0..2).map(|k| of_campaign(&study, k)).collect();
    let failures: Vec<_> = both.iter().flat_map(|repetition| &repetition.failures).collect();
    assert!(both.iter().any(|repetition| repetition.inside), "gates that failed: {failures:?}");
}

#[test]
fn property_the_least_squares_form_is_the_likelihood_s_own_slope() {
    let study = crate::habe::pinned(&[]);
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

/// A gain and an offset, taken as known, are the same as readings corrected by hand.
#[test]
fn analytic_an_instrument_s_errors_are_those_of_its_readings() {
    let study = crate::habe::pinned(&[]);
    let runs: Vec<MeasuredRun> = campaign::runs(campaign::SEED)
        .expect("the campaign can be made")
        .into_iter()
        .map(|(name, text)| MeasuredRun::from_csv(name, &text, Default::default()).expect("a run"))
        .collect();
    let options = |speed_sd: f64| Options {
        sensor_sd: vec![(Channel::Speed, speed_sd), (Channel::Fluid, 0.5), (Channel::Housing, 0.4)],
        discrepancy: None,
        ..Options::seeded(1993)
    };
    let planned = |runs: &[MeasuredRun]| {
        let all: Vec<&MeasuredRun> = runs.iter().collect();
        plan::planned(&all, &study, &options(0.02)).expect("runs that can be compared")
    };
    let likelihood = RigLikelihood::of_runs(&study, planned(&runs), &options(0.02));
    let coordinates = likelihood.coordinates();
    let mut z: Vec<f64> = (0..coordinates.len()).map(|j| 0.1 * ((j % 5) as f64 - 2.0)).collect();
    let mut by_hand = z.clone();
    let mut corrected = runs.clone();
    for (j, coordinate) in coordinates.iter().enumerate() {
        let (k, deviations) = match *coordinate {
            Coordinate::Gain(k) => (k, 0.8),
            Coordinate::Offset(k) => (k, -1.3),
            _ => continue,
        };
        (z[j], by_hand[j]) = (deviations, 0.0);
        let error = likelihood.systematic()[k];
        for run in &mut corrected {
            let values = match error.channel {
                Channel::Force => &mut run.force_n,
                Channel::Speed => &mut run.speed_m_per_s,
                Channel::Fluid => &mut run.fluid_k,
                Channel::Housing => &mut run.housing_k,
                other => panic!("{other:?} is not used"),
            };
            for value in values.as_mut().expect("the channel") {
                match coordinate {
                    Coordinate::Gain(_) => *value *= 1.0 + error.gain * deviations,
                    _ => *value += error.offset * deviations,
                }
            }
        }
    }
    let mut again = planned(&corrected);
    for (again, run) in again.iter_mut().zip(likelihood.runs()) {
        again.initial = run.initial;
    }
    // A reading's density, in place of the corrected reading's: its error is smaller by the gain, the density higher.
    let gain = likelihood.correction(Channel::Speed, &z).gain;
    let readings: usize = runs.iter().map(|run| run.time_s.len()).sum();
    let without = RigLikelihood::of_runs(&study, again, &options(0.02 * gain));
    let ln = |likelihood: &RigLikelihood<'_>, z: &[f64]| {
        let mut value = [0.0];
        likelihood.ln_likelihood(&Columns::from_rows(&[z]), &mut value).expect("a likelihood");
        value[0]
    };
    let (with, without) =
        (ln(&likelihood, &z), ln(&without, &by_hand) + readings as f64 * gain.ln());
    // Sums of some thousand squares, with rounding of the corrected record.
    assert!((with - without).abs() < 1e-9 * with.abs(), "{with} {without}");
}
