//! Order-statistic intervals, tolerance bounds and normal tolerance factors.

use reeldown::reliability::normal_tolerance::{one_sided_tolerance_factor, predictive_exceedance};
use reeldown::reliability::quantiles::{OrderedSample, REPORTED};

/// P(K = k), K ~ Binomial(n, p), outward from the mode so that nothing underflows that matters.
fn binomial_masses(n: usize, p: f64) -> Vec<f64> {
    let mode = ((n as f64 + 1.0) * p).floor().min(n as f64) as usize;
    let mut masses = vec![0.0; n + 1];
    masses[mode] = 1.0;
    for k in mode..n {
        masses[k + 1] = masses[k] * (n - k) as f64 / (k + 1) as f64 * p / (1.0 - p);
    }
    for k in (0..mode).rev() {
        masses[k] = masses[k + 1] * (k + 1) as f64 / (n - k) as f64 * (1.0 - p) / p;
    }
    let total: f64 = masses.iter().sum();
    masses.iter().map(|mass| mass / total).collect()
}

#[test]
fn analytic_ranks_are_the_narrowest_with_each_tail_within_its_risk() {
    for n in [10usize, 59, 300, 2000, 10_000] {
        let values: Vec<f64> = (1..=n).map(|k| k as f64).collect();
        let sample = OrderedSample::from_sorted(&values, 0).unwrap();
        for p in REPORTED {
            let masses = binomial_masses(n, p);
            let below = |r: usize| masses[..r].iter().sum::<f64>();
            let above = |r: usize| masses[r..].iter().rev().sum::<f64>();
            let low = (1..=n).take_while(|r| below(*r) <= 0.025).last();
            let high = (1..=n).find(|r| above(*r) <= 0.025);
            let quantile = sample.quantile(p, 0.95).unwrap();
            assert_eq!(quantile.ranks, (low.map(|r| r as u64), high.map(|r| r as u64)), "{n} {p}");
            match (low, high) {
                (Some(low), Some(high)) => {
                    let interval = quantile.interval.interval().unwrap();
                    assert_eq!((interval.lower, interval.upper), (low as f64, high as f64));
                    // Exact coverage for a continuous law: P(low ≤ K ≤ high − 1).
                    let coverage: f64 = masses[low..high].iter().sum();
                    assert!(coverage >= 0.95);
                    assert!((quantile.attained.unwrap() - coverage).abs() < 1e-11);
                }
                _ => assert!(quantile.interval.why_none().unwrap().contains("too few")),
            }
        }
    }
}

#[test]
fn published_wilks_bounds_start_at_their_sample_sizes() {
    let values: Vec<f64> = (1..=473).map(f64::from).collect();
    let sample = |n: usize| OrderedSample::from_sorted(&values[..n], 0).unwrap();
    // One-sided 95/95: 59 for the largest, 93 for the second largest; two-sided 95/95: 93, 99/95: 473.
    assert_eq!(sample(59).upper_bound(0.95, 0.95).unwrap().interval().unwrap().upper, 59.0);
    assert!(sample(58).upper_bound(0.95, 0.95).unwrap().why_none().unwrap().contains("59"));
    assert_eq!(sample(93).upper_bound(0.95, 0.95).unwrap().interval().unwrap().upper, 92.0);
    assert_eq!(sample(59).lower_bound(0.05, 0.95).unwrap().interval().unwrap().lower, 1.0);
    assert!(sample(58).lower_bound(0.05, 0.95).unwrap().why_none().unwrap().contains("59"));
    let two_sided = sample(93).tolerance_interval(0.95, 0.95).unwrap();
    let interval = two_sided.interval().unwrap();
    assert_eq!((interval.lower, interval.upper), (1.0, 93.0));
    assert!(sample(92).tolerance_interval(0.95, 0.95).unwrap().why_none().unwrap().contains("93"));
    assert!(sample(473).tolerance_interval(0.99, 0.95).unwrap().interval().is_some());
    assert!(sample(472).tolerance_interval(0.99, 0.95).unwrap().interval().is_none());
}

#[test]
fn reference_numpy_median_unbiased_quantiles() {
    // numpy.quantile(values, p, method="median_unbiased"), NumPy 2.
    let values = [-1.5, 0.0, 0.25, 2.0, 3.5, 10.0, 12.0];
    let sample = OrderedSample::from_sorted(&values, 0).unwrap();
    for (p, expected) in NUMPY {
        let found = sample.quantile(p, 0.5).unwrap().estimate.unwrap();
        assert!((found - expected).abs() <= 1e-13 * 12.0, "{p}: {found} {expected}");
    }
}

const NUMPY: [(f64, f64); 6] = [
    (0.01, -1.5),
    (0.1, -1.4),
    (0.37, 0.331_666_666_666_666_2),
    (0.5, 2.0),
    (0.9, 11.866_666_666_666_667),
    (0.999, 12.0),
];

#[test]
fn property_faults_may_lie_on_either_side() {
    let mut values: Vec<f64> = (1..=2000).map(f64::from).collect();
    let clean = OrderedSample::from_unsorted(&values);
    for k in [3, 700, 1999, 5, 100] {
        values[k] = f64::NAN;
    }
    values.reverse();
    let sample = OrderedSample::from_unsorted(&values);
    assert_eq!((sample.samples(), sample.faults()), (2000, 5));
    assert!(sample.values().is_sorted());
    for p in [0.5, 0.9, 0.99] {
        let whole = *clean.quantile(p, 0.9).unwrap().interval.interval().unwrap();
        let widened = *sample.quantile(p, 0.9).unwrap().interval.interval().unwrap();
        assert!(widened.lower <= whole.lower && whole.upper <= widened.upper, "{p}");
    }
    // Rank 1995 or beyond of 2000 may be a fault: 99.73 % cannot be bounded above, 50 % can.
    assert!(sample.quantile(0.9973, 0.9).unwrap().interval.why_none().unwrap().contains("faults"));
    assert!(sample.upper_bound(0.9973, 0.9).unwrap().interval().is_none());
    assert!(sample.lower_bound(0.9973, 0.9).unwrap().interval().is_some());
    let nothing = OrderedSample::from_unsorted(&[f64::NAN]);
    let quantile = nothing.quantile(0.5, 0.9).unwrap();
    assert!(quantile.estimate.is_none() && quantile.interval.interval().is_none());
}

#[test]
fn property_wrong_input_is_refused_and_infinite_values_are_values() {
    assert!(OrderedSample::from_sorted(&[1.0, 0.5], 0).is_err());
    assert!(OrderedSample::from_sorted(&[f64::NAN], 0).is_err());
    assert!(OrderedSample::from_sorted(&[0.0, f64::NAN], 0).is_err());
    let sample =
        OrderedSample::from_unsorted(&[f64::INFINITY, 1.0, f64::INFINITY, f64::NEG_INFINITY]);
    assert!(sample.quantile(1.5, 0.9).is_err() && sample.quantile(0.5, 0.0).is_err());
    for p in [0.01, 0.3, 0.5, 0.9, 0.99] {
        assert!(!sample.quantile(p, 0.5).unwrap().estimate.unwrap().is_nan());
    }
    let empty = OrderedSample::from_unsorted(&[]);
    assert!(empty.quantile(0.5, 0.9).unwrap().estimate.is_none());
    assert!(empty.tolerance_interval(0.5, 0.9).unwrap().interval().is_none());
}

#[test]
fn reference_scipy_normal_tolerance_factors() {
    // scipy.stats.nct.ppf(C, n − 1, z√n)/√n, which is itself good to about 1e-9.
    let table = [
        (2, 0.99, 0.95, 37.09358145617062),
        (5, 0.95, 0.95, 4.202680741256176),
        (10, 0.95, 0.95, 2.9109634130781665),
        (10, 0.99, 0.95, 3.9811178452730585),
        (10, 0.9973, 0.9, 4.184670105243056),
        (30, 0.99, 0.95, 3.06390112623817),
        (100, 0.9973, 0.9, 3.0981932983497664),
        (2000, 0.99865, 0.9, 3.0687722107569804),
    ];
    for (n, content, confidence, expected) in table {
        let found = one_sided_tolerance_factor(n, content, confidence).unwrap();
        assert!(
            (found - expected).abs() < 1e-9 * expected,
            "{n} {content} {confidence}: {found} {expected}"
        );
    }
    assert!(one_sided_tolerance_factor(1, 0.9, 0.9).is_err());
    assert!(one_sided_tolerance_factor(10, 1.0, 0.9).is_err());
}

#[test]
fn published_predictive_exceedance() {
    // Student's survival at k/√(1 + 1/n) with n − 1 degrees of freedom, by SciPy.
    let table = [
        (5, 3.0, 0.025989847100962967),
        (10, 3.0, 0.009384261030014867),
        (30, 3.0, 0.003104339705585242),
        (100, 3.0, 0.0017857788496986975),
        (10, 4.0, 0.0020643328858909785),
    ];
    for (n, k, expected) in table {
        let found = predictive_exceedance(n, k).unwrap();
        assert!((found - expected).abs() < 1e-11 * expected, "{n} {k}: {found}");
    }
    assert!(predictive_exceedance(1, 3.0).is_err());
}
