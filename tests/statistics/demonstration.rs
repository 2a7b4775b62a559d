//! Demonstrated reliability against published tables and brute force.

use reeldown::reliability::binomial_tails::{at_least, at_most};
use reeldown::reliability::demonstration::{
    Requirement, Verdict, consumers_risk, minimum_samples, producers_risk,
};
use reeldown::reliability::probability::Proportion;

/// Success-run tables (Kececioglu, *Reliability and Life Testing Handbook*; the first row of each is
/// ln(1 − C)/ln R rounded up): reliability, confidence, samples with 0 to 5 failures. Recomputed with
/// SciPy's binomial law.
const FAILURES_ALLOWED: [(f64, f64, [u64; 6]); 8] = [
    (0.95, 0.95, [59, 93, 124, 153, 181, 208]),
    (0.99, 0.95, [299, 473, 628, 773, 913, 1049]),
    (0.99, 0.90, [230, 388, 531, 667, 798, 926]),
    (0.9973, 0.90, [852, 1440, 1970, 2473, 2959, 3433]),
    (0.99865, 0.90, [1705, 2880, 3941, 4947, 5920, 6868]),
    (0.99865, 0.95, [2218, 3513, 4662, 5742, 6778, 7785]),
    (0.999, 0.90, [2302, 3889, 5321, 6679, 7992, 9273]),
    (0.9999, 0.95, [29956, 47437, 62956, 77535, 91533, 105_128]),
];

#[test]
fn published_failures_allowed_tables() {
    for (reliability, confidence, samples) in FAILURES_ALLOWED {
        for (failures, expected) in samples.into_iter().enumerate() {
            let failures = failures as u64;
            assert_eq!(minimum_samples(reliability, confidence, failures).unwrap(), expected);
            let requirement = Requirement::new(reliability, confidence).unwrap();
            assert_eq!(requirement.failures_allowed(expected), Some(failures));
            assert_eq!(requirement.failures_allowed(expected - 1), failures.checked_sub(1));
        }
    }
}

#[test]
fn published_wilks_numbers() {
    // First order, two-sided: content/confidence 95/95, 99/95, 95/99 (Wilks 1941; Nutt and Wallis 2004).
    for (content, confidence, expected) in [(0.95, 0.95, 93), (0.99, 0.95, 473), (0.95, 0.99, 130)]
    {
        assert_eq!(minimum_samples(content, confidence, 1).unwrap(), expected);
    }
}

fn counts(breaches: u64, faults: u64, samples: u64) -> Proportion {
    Proportion::new(breaches, faults, samples).unwrap()
}

#[test]
fn analytic_verdicts_turn_where_the_table_does() {
    let requirement = Requirement::new(0.9973, 0.90).unwrap();
    let verdict = |m, f, n| requirement.verdict(&counts(m, f, n)).unwrap();
    assert_eq!(verdict(0, 0, 852).verdict, Verdict::Met);
    assert_eq!(verdict(0, 0, 851).verdict, Verdict::Undecided);
    assert_eq!(verdict(0, 0, 851).clean_samples_needed, 1);
    assert_eq!(verdict(2, 0, 1970).verdict, Verdict::Met);
    let undecided = verdict(2, 0, 1440);
    assert_eq!((undecided.verdict, undecided.clean_samples_needed), (Verdict::Undecided, 530));
    assert_eq!(undecided.failures_allowed, Some(1));
    assert_eq!(verdict(40, 0, 100).verdict, Verdict::NotMet);
    assert_eq!(verdict(0, 0, 0).verdict, Verdict::Undecided);
    assert_eq!(verdict(0, 0, 0).failures_allowed, None);
    // A met verdict needs no more samples, and its bound is below the limit.
    let met = verdict(1, 0, 1440);
    assert_eq!((met.verdict, met.clean_samples_needed), (Verdict::Met, 0));
    assert!(met.upper_bound.interval().unwrap().upper <= 0.0027 + 1e-15);
}

#[test]
fn property_faults_count_against_either_verdict() {
    let requirement = Requirement::new(0.9973, 0.90).unwrap();
    let verdict = |m, f, n| requirement.verdict(&counts(m, f, n)).unwrap().verdict;
    assert_eq!(verdict(0, 1, 852), Verdict::Undecided);
    assert_eq!(verdict(0, 1, 1440), Verdict::Met);
    // With 0.27 % allowed of 1000, 10 failures are too many; with 10 faults they may still have been clean.
    assert_eq!(verdict(10, 0, 1000), Verdict::NotMet);
    assert_eq!(verdict(0, 10, 1000), Verdict::Undecided);
}

/// P(K = k), K ~ Binomial(n, p), by its recurrence.
fn binomial_masses(n: u64, p: f64) -> Vec<f64> {
    let mut masses = vec![(1.0 - p).powi(n as i32)];
    for k in 0..n {
        let last = masses[k as usize];
        masses.push(last * (n - k) as f64 / (k + 1) as f64 * p / (1.0 - p));
    }
    masses
}

#[test]
fn property_each_verdict_is_wrong_no_more_often_than_stated() {
    // The probability of a wrong verdict is a finite sum over what could be counted: no simulation.
    for (reliability, confidence, samples) in [(0.95, 0.90, 120), (0.9, 0.95, 77), (0.99, 0.8, 400)]
    {
        let requirement = Requirement::new(reliability, confidence).unwrap();
        let limit = requirement.failure_limit();
        for factor in [0.3, 0.999_999, 1.000_001, 2.0, 5.0] {
            let masses = binomial_masses(samples, limit * factor);
            let (mut met, mut not_met) = (0.0, 0.0);
            for (m, mass) in masses.iter().enumerate() {
                match requirement.verdict(&counts(m as u64, 0, samples)).unwrap().verdict {
                    Verdict::Met => met += mass,
                    Verdict::NotMet => not_met += mass,
                    Verdict::Undecided => {}
                }
            }
            let wrong = if factor > 1.0 { met } else { not_met };
            assert!(
                wrong <= 1.0 - confidence + 1e-9,
                "{reliability} {confidence} {factor}: {wrong}"
            );
        }
    }
}

#[test]
fn analytic_risks_are_the_masses_on_the_wrong_side() {
    let requirement = Requirement::new(0.9, 0.9).unwrap();
    let demonstration = requirement.verdict(&counts(3, 0, 80)).unwrap();
    let allowed = demonstration.failures_allowed.unwrap();
    let at_limit: f64 = binomial_masses(80, 0.1)[..=allowed as usize].iter().sum();
    let good: f64 = binomial_masses(80, 0.05)[allowed as usize + 1..].iter().sum();
    // Sums of at most 80 positive terms, each within 80 roundings: 1e-13 is ample.
    assert!((demonstration.consumers_risk.unwrap() - at_limit).abs() < 1e-13);
    assert!((demonstration.producers_risk - good).abs() < 1e-13);
    assert!(at_limit <= 0.1);
    assert!((consumers_risk(80, allowed, 0.1) - at_limit).abs() < 1e-13);
    assert!((producers_risk(80, allowed, 0.05) - good).abs() < 1e-13);
    let three: f64 = binomial_masses(80, 0.1)[..=3].iter().sum();
    assert!((demonstration.attained_risk - three).abs() < 1e-13);
}

#[test]
fn analytic_binomial_tails_by_summation() {
    for (n, p) in [(1u64, 0.3), (17, 0.02), (60, 0.5), (200, 0.97)] {
        let masses = binomial_masses(n, p);
        for k in 0..=n {
            let below: f64 = masses[..=k as usize].iter().sum();
            let above: f64 = masses[k as usize..].iter().sum();
            // (1 − p)^200 and 200 factors: relative 400 roundings, 1e-13, of sums below 1.
            assert!((at_most(k, n, p) - below).abs() < 1e-12, "{k} {n} {p}");
            assert!((at_least(k, n, p) - above).abs() < 1e-12, "{k} {n} {p}");
        }
    }
}
