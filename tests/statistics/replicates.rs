//! Intervals over replicates, and their absence.

use reeldown::numerics::columns::Columns;
use reeldown::numerics::interval::Interval;
use reeldown::numerics::special::student;
use reeldown::reliability::probability::Proportion;
use reeldown::reliability::replicates::from_replicate_counts;
use reeldown::sampling::{Design, Sampler};
use reeldown::streams::{Purpose, open_uniform, stream};

fn counts(breaches: &[u64], samples: u64) -> Vec<Proportion> {
    breaches.iter().map(|&m| Proportion::new(m, 0, samples).unwrap()).collect()
}

fn interval(breaches: &[u64], samples: u64, confidence: f64) -> Interval {
    let found = from_replicate_counts(&counts(breaches, samples), confidence).unwrap();
    *found.probability.interval.interval().unwrap()
}

/// Korn and Graubard's interval by SciPy 1.16: `beta.ppf`, `t.isf` and `norm.isf` put together as in their paper, the
/// effective sample size capped at the samples where breaches, or samples without one, are fewer than 100.
#[test]
fn reference_korn_and_graubard_by_scipy() {
    type Case = (&'static [u64], u64, f64, f64, f64, f64);
    let cases: [Case; 4] = [
        (
            &[20, 30, 20, 30],
            100,
            0.95,
            0.028_867_513_459_481_28,
            0.162_540_646_702_547_64,
            0.355_477_334_447_142_3,
        ),
        (
            &[200, 210, 190, 204],
            1000,
            0.95,
            0.004_203_173_404_306_161,
            0.187_736_500_117_690_6,
            0.214_772_442_690_236_68,
        ),
        (
            &[2, 0, 1, 3],
            1000,
            0.8,
            0.000_645_497_224_367_902_8,
            0.000_586_185_348_021_156_1,
            0.003_214_201_030_354_991,
        ),
        (
            &[998, 1000, 999, 997],
            1000,
            0.8,
            0.000_645_497_224_367_902_8,
            0.996_785_798_969_644_9,
            0.999_413_814_651_978_9,
        ),
    ];
    for (breaches, samples, confidence, error, lower, upper) in cases {
        let found = from_replicate_counts(&counts(breaches, samples), confidence).unwrap();
        assert!((found.probability.standard_error.unwrap() / error - 1.0).abs() < 1e-12);
        let interval = found.probability.interval.interval().unwrap();
        assert!((interval.lower / lower - 1.0).abs() < 1e-10, "{breaches:?}: {interval:?}");
        assert!((interval.upper / upper - 1.0).abs() < 1e-10, "{breaches:?}: {interval:?}");
    }
}

/// With many breaches the counts' skewness is slight, and the interval is Student's: to 1/√(10⁶) of its half-width.
#[test]
fn analytic_with_many_breaches_the_interval_is_students() {
    let found = interval(&[400_000, 401_000, 399_000, 400_500], 1_000_000, 0.95);
    // Mean 0.400125; deviations −125, 875, −1125, 375 of a million: s² = 2.1875e-6/3·… by the sum of their squares.
    let squares: f64 = [-125.0, 875.0, -1125.0, 375.0f64].iter().map(|d| d * d * 1e-12).sum();
    let half = student::quantile_upper(3.0, 0.025) * (squares / 3.0 / 4.0).sqrt();
    assert!((found.lower - (0.400_125 - half)).abs() < 2e-3 * half, "{found:?} {half}");
    assert!((found.upper - (0.400_125 + half)).abs() < 2e-3 * half, "{found:?} {half}");
    // Replicates that differ in one sample of a million: still a proper interval about the mean.
    let close = interval(&[400_000, 400_000, 400_000, 400_001], 1_000_000, 0.95);
    assert!(
        close.lower < 0.400_000_25
            && close.upper > 0.400_000_25
            && close.upper - close.lower < 1e-5
    );
}

#[test]
fn property_no_interval_without_a_spread() {
    let none = |breaches: &[u64]| {
        let found = from_replicate_counts(&counts(breaches, 100), 0.9).unwrap().probability;
        assert_eq!(found.standard_error, None);
        (found.value, found.interval.why_none().unwrap().to_owned())
    };
    assert_eq!(none(&[]).0, None);
    assert_eq!(none(&[25]).0, Some(0.25));
    let (value, why) = none(&[0; 16]);
    // 1 − 0.1^(1/16) = 0.134: sixteen independent points without a breach.
    assert!(value == Some(0.0) && why.contains("0.13") && why.contains("Monte Carlo"), "{why}");
    assert_eq!(none(&[100; 3]).0, Some(1.0));
    assert_eq!(none(&[10; 3]).0, Some(0.1));
    assert!(from_replicate_counts(&counts(&[50, 60], 100), 1.0).is_err());
    assert!(from_replicate_counts(&[Proportion::new(0, 0, 0).unwrap()], 0.9).is_err());
}

#[test]
fn property_replicates_with_faults_are_counted_both_ways() {
    let counts = |m, f| Proportion::new(m, f, 100).unwrap();
    let result =
        from_replicate_counts(&[counts(10, 0), counts(12, 5), counts(11, 0)], 0.9).unwrap();
    let both = *result.probability.interval.interval().unwrap();
    assert_eq!(both.lower, interval(&[10, 12, 11], 100, 0.9).lower);
    assert_eq!(both.upper, interval(&[10, 17, 11], 100, 0.9).upper);
    assert!(both.contains(result.probability.value.unwrap()));
}

/// Upper end of Student's interval, which is what was stated before.
fn student_upper(counts: &[Proportion], confidence: f64) -> f64 {
    let shares: Vec<f64> = counts.iter().map(|c| c.breaches as f64 / c.samples as f64).collect();
    let n = shares.len() as f64;
    let mean = shares.iter().sum::<f64>() / n;
    let squares: f64 = shares.iter().map(|share| (share - mean) * (share - mean)).sum();
    mean + student::quantile_upper(n - 1.0, (1.0 - confidence) / 2.0)
        * (squares / (n - 1.0) / n).sqrt()
}

/// One-sided bounds at 90 % from counts of a Poisson law, the worst that a replicated design does: the case of a trial in
/// which one run in four, and at 16 breaches one in eight, called a requirement met that was not.
#[test]
fn property_a_bound_from_breaches_holds_as_often_as_it_says() {
    const REPLICATES: usize = 16;
    const SAMPLES: u64 = 1200;
    const TRIALS: u64 = 6000;
    let cases = [2.4, 3.5, 5.0, 16.0, 64.0, 200.0].map(|mean| (mean, true));
    for (mean, rare) in cases.into_iter().chain([(2.4, false), (16.0, false)]) {
        let p = mean / (REPLICATES as f64 * SAMPLES as f64);
        let (mut missed, mut stated, mut narrow) = (0, 0, 0);
        for trial in 0..TRIALS {
            let mut draws = stream(trial, Purpose::Test, 77);
            let counts: Vec<Proportion> = (0..REPLICATES)
                .map(|_| {
                    // Waiting times between breaches, as long as the replicate lasts.
                    let mut breaches = 0;
                    let mut at = -open_uniform(&mut draws).ln() / p;
                    while at < SAMPLES as f64 {
                        breaches += 1;
                        at -= open_uniform(&mut draws).ln() / p;
                    }
                    // Few samples without a breach are few breaches seen from the other side.
                    let breaches = if rare { breaches } else { SAMPLES - breaches };
                    Proportion::new(breaches, 0, SAMPLES).unwrap()
                })
                .collect();
            // Two-sided at 80 %: each end is a bound at 90 %.
            let found = from_replicate_counts(&counts, 0.8).unwrap().probability.interval;
            let Some(interval) = found.interval() else { continue };
            stated += 1;
            missed += u64::from(if rare { interval.upper < p } else { interval.lower > 1.0 - p });
            narrow += u64::from(rare && student_upper(&counts, 0.8) < p);
        }
        // Four standard errors of a share of 10 % among so many.
        let most = 0.1 * stated as f64 + 4.0 * (0.09 * stated as f64).sqrt();
        assert!((missed as f64) <= most, "{mean}: {missed} of {stated}");
        if rare && [2.4, 16.0].contains(&mean) {
            // Student's bound does not pass this test.
            assert!(narrow as f64 > most, "{mean}: {narrow} of {stated}");
        }
    }
}

/// Each design at a requirement's very limit: P(sum of four uniforms < t) = t⁴/24 = 1 %. "Met" at 90 % is wrong in at
/// most 10 % of runs.
#[test]
fn property_each_replicated_design_demonstrates_at_the_limit_no_more_often_than_it_may() {
    const TRIALS: u64 = 1500;
    const REPLICATES: u32 = 16;
    let threshold = 0.24f64.powf(0.25);
    for design in [Design::LatinHypercube, Design::Sobol, Design::Halton] {
        for samples in [1600u64, 6400] {
            let mut points = Columns::new(samples as usize, 4);
            let (mut wrong, mut stated) = (0, 0);
            for trial in 0..TRIALS {
                let seed = 10_000 + trial;
                let sampler =
                    Sampler::new(design, 4, samples, REPLICATES, seed, Purpose::Test).unwrap();
                sampler.fill(0, &mut points).unwrap();
                let mut breaches = [0; REPLICATES as usize];
                for k in 0..samples as usize {
                    let sum: f64 = (0..4).map(|j| points.get(k, j)).sum();
                    let replicate = sampler.replicate_of(k as u64) as usize;
                    breaches[replicate] += u64::from(sum < threshold);
                }
                let each = samples / u64::from(REPLICATES);
                let found = from_replicate_counts(&counts(&breaches, each), 0.8).unwrap();
                let Some(interval) = found.probability.interval.interval() else { continue };
                stated += 1;
                wrong += u64::from(interval.upper < 0.01);
            }
            println!("{design:?} {samples}: {wrong} of {stated}");
            let most = 0.1 * stated as f64 + 4.0 * (0.09 * stated as f64).sqrt();
            assert!(wrong as f64 <= most, "{design:?}, {samples}: {wrong} of {stated}");
        }
    }
}
