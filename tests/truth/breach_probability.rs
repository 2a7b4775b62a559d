//! Breach probabilities against numpy's: another generator, another integrator, another implementation of the laws
//! (references/breach_probability.py), for the default card and for the one that other tests hold their answers of.

use crate::habe::pinned;
use reeldown::analysis::Sampling;
use reeldown::campaign::Progress;
use reeldown::descent::OutcomeQuantity;
use reeldown::study::{Override, Study};
use serde_json::Value;

const SET: [&str; 2] = ["model=quasi-steady", "sampling.samples=50000"];

#[test]
fn reference_numpy_monte_carlo_of_the_quasi_steady_model() {
    agrees(&pinned(&SET), include_str!("references/breach_probability.json"));
}

#[test]
fn reference_numpy_monte_carlo_of_the_default_card() {
    let overrides = SET.map(|text| Override::parse("--set", text).unwrap());
    let study = Study::load(None, &overrides).unwrap();
    agrees(&study, include_str!("references/breach_probability_default.json"));
}

fn agrees(study: &Study, reference: &str) {
    let reference: Value = serde_json::from_str(reference).unwrap();
    let number = |key: &str| reference[key].as_f64().unwrap();
    let Sampling { record, samples, .. } = Sampling::of(study, &Progress::default()).unwrap();

    // Four standard errors of the difference of two independent estimates: one chance in 16 000 each.
    let (n, m) = (samples as f64, number("samples"));
    let counts = record.counts();
    for (got, key) in [
        (counts.any(), "any"),
        (counts.constraint(0).unwrap(), "late"),
        (counts.constraint(1).unwrap(), "fast"),
        (counts.constraint(2).unwrap(), "hot"),
    ] {
        let (p, q) = (got.breaches as f64 / n, number(key) / m);
        let pooled = (got.breaches as f64 + number(key)) / (n + m);
        let error = (pooled * (1.0 - pooled) * (1.0 / n + 1.0 / m)).sqrt();
        assert!((p - q).abs() <= 4.0 * error, "{key}: {p} against {q}, standard error {error}");
    }
    for (quantity, mean, sd) in [
        (OutcomeQuantity::Time, "mean_time_s", "sd_time_s"),
        (
            OutcomeQuantity::PeakFluidTemperature,
            "mean_peak_fluid_temperature_k",
            "sd_peak_fluid_temperature_k",
        ),
    ] {
        let summary = record.summary(quantity);
        let error = number(sd) * (1.0 / n + 1.0 / m).sqrt();
        let difference = summary.mean - number(mean);
        assert!(difference.abs() <= 4.0 * error, "{mean}: {} {}", summary.mean, number(mean));
        // The laws are nearly normal; the error of a standard deviation is then its share 1/√(2n).
        let got = summary.standard_deviation().unwrap();
        assert!((got / number(sd) - 1.0).abs() <= 6.0 / (2.0 * n).sqrt(), "{sd}: {got}");
    }
}
