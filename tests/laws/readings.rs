//! What a few readings predict.

use rand::RngExt;
use reeldown::numerics::special::{normal, student};
use reeldown::streams::{Purpose, stream};
use reeldown::uncertainty::{Marginal, Readings};

/// `n` readings with mean 0 and standard deviation 1.
fn standardised(n: usize) -> Vec<f64> {
    let raw: Vec<f64> = (0..n).map(|k| normal::quantile((k as f64 + 0.5) / n as f64)).collect();
    let mean = raw.iter().sum::<f64>() / n as f64;
    let squares: f64 = raw.iter().map(|x| (x - mean) * (x - mean)).sum();
    let sd = (squares / (n as f64 - 1.0)).sqrt();
    raw.iter().map(|x| (x - mean) / sd).collect()
}

#[test]
fn reference_scipy_risk_beyond_k_standard_deviations_of_n_readings() {
    // t.sf(k/sqrt(1 + 1/n), n - 1) by SciPy. The plug-in law says 1.35e-3 for k = 3 whatever n is.
    for (n, k, predictive) in [
        (5, 3.0, 0.025989847100962967),
        (10, 3.0, 0.009384261030014867),
        (30, 3.0, 0.003104339705585242),
        (100, 3.0, 0.0017857788496986975),
        (10, 4.0, 0.0020643328858909785),
    ] {
        let readings = Readings::new(&standardised(n), None, false).unwrap();
        let risk = Marginal::untruncated(readings.predictive()).survival(k);
        // The readings' own mean and standard deviation are rounded: a few hundred roundings.
        assert!((risk / predictive - 1.0).abs() < 1e-11, "{n} {k}: {risk}");
        let plug_in = normal::survival(k);
        assert!(risk > 1.3 * plug_in);
        // The same of a logarithm, at exp(k).
        let values: Vec<f64> =
            standardised(n).iter().map(|&x| reeldown::numerics::elementary::exp(x)).collect();
        let logarithmic = Readings::new(&values, None, true).unwrap().predictive();
        let risk = logarithmic.survival(reeldown::numerics::elementary::exp(k));
        assert!((risk / predictive - 1.0).abs() < 1e-11, "{n} {k}: {risk}");
        // A known deviation: normal, with the mean's own error.
        let known = Readings::new(&standardised(n), Some(1.0), false).unwrap().predictive();
        let expected = normal::survival(k / (1.0 + 1.0 / n as f64).sqrt());
        assert!((known.survival(k) / expected - 1.0).abs() < 1e-11);
    }
}

#[test]
fn analytic_quantile_density_and_tails_belong_together() {
    let readings = Readings::new(&[1.0, 1.2, 0.9, 1.4], None, true).unwrap();
    for law in [
        Marginal::untruncated(readings.predictive()),
        Marginal::new(readings.predictive(), Some(0.7), Some(2.0)).unwrap(),
        Marginal::untruncated(Readings::new(&[1.0, 1.2, 0.9], None, false).unwrap().predictive()),
    ] {
        for p in [1e-9, 0.01, 0.3, 0.5, 0.8, 0.999] {
            let x = law.quantile_lower(p);
            // Around a truncation, differences of tails of order one: 1e-12 of the probability.
            assert!((law.cdf(x) - p).abs() < 1e-12 * (1.0 + p / 1e-2), "{p} {x} {}", law.cdf(x));
            let h = 1e-5;
            let slope = (law.cdf(x + h) - law.cdf(x - h)) / (2.0 * h);
            let density = reeldown::numerics::elementary::exp(law.ln_density(x));
            let inside = law.cdf(x - h) > 0.0;
            // A central difference: h² of the curvature, and 1e-16/h of rounding.
            assert!(
                !inside || (slope - density).abs() < 1e-6 * density.max(1e-3),
                "{p}: {slope} {density}"
            );
        }
    }
    // Student's standard deviation with three degrees of freedom is √3 scales.
    let law = Readings::new(&[1.0, 1.2, 0.9, 1.4], None, false).unwrap().predictive();
    assert!((law.sd() - 3.0_f64.sqrt() * law.spread()).abs() < 1e-15);
    // The truncated law's moments, by its own quantile function at midpoints.
    let cut = Marginal::new(law, Some(0.5), Some(1.6)).unwrap();
    let n = 20_000;
    let mean = (0..n).map(|k| cut.quantile_lower((k as f64 + 0.5) / f64::from(n))).sum::<f64>()
        / f64::from(n);
    assert!((cut.mean() - mean).abs() < 1e-7);
}

#[test]
fn property_the_predictive_law_is_calibrated_and_the_plug_in_is_not() {
    // 20 000 data sets of four readings and a fifth value: the predictive upper 5 % point is exceeded by
    // 5 % of them, within four standard errors of 0.15 %; the plug-in point by far more.
    let sets = 20_000;
    let mut random = stream(7, Purpose::Test, 0);
    let mut value = || normal::quantile(random.random_range(1e-12..1.0));
    let (mut beyond, mut beyond_plug_in) = (0, 0);
    let t = student::quantile_upper(3.0, 0.05);
    for _ in 0..sets {
        let readings: Vec<f64> = (0..4).map(|_| value()).collect();
        let found = Readings::new(&readings, None, false).unwrap();
        let next = value();
        let point = found.centre() + t * found.sd() * 1.25_f64.sqrt();
        assert!(
            (found.predictive().quantile_upper(0.05) - point).abs() < 1e-12 * (1.0 + point.abs())
        );
        beyond += usize::from(next > point);
        beyond_plug_in += usize::from(next > found.centre() + 1.6448536269514722 * found.sd());
    }
    let share = beyond as f64 / f64::from(sets);
    assert!((share - 0.05).abs() < 4.0 * 0.00154, "{share}");
    assert!(beyond_plug_in as f64 / f64::from(sets) > 0.08);
}
