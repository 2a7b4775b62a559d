//! Laws of listed values: observations with and without ties, discrete laws.

use proptest::prelude::*;
use reeldown::uncertainty::nataf::product_moment_correlation;
use reeldown::uncertainty::{Law, Marginal};

/// Means and deviations are sums of at most a few hundred terms: 1e-13 of the size.
const ROUNDING: f64 = 1e-13;

fn repeated(groups: &[(f64, usize)]) -> Vec<f64> {
    groups.iter().flat_map(|&(value, count)| std::iter::repeat_n(value, count)).collect()
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= ROUNDING * (1.0 + b.abs())
}

#[test]
fn analytic_ties_keep_their_weight() {
    // By hand: the mean is the sum over the count, the deviation that of a two-point law, √(p q) d.
    let cases = [
        ([(1.0, 9), (1.1, 1)], 1.01, 0.09_f64.sqrt() * 0.1),
        ([(0.9, 20), (1.1, 80)], 1.06, 0.4 * 0.2),
        ([(1.0, 3), (2.0, 1)], 1.25, 0.1875_f64.sqrt()),
    ];
    for (groups, mean, sd) in &cases {
        let (groups, mean, sd) = (&groups[..], *mean, *sd);
        let law = Marginal::untruncated(Law::empirical(repeated(groups), None).unwrap());
        assert!(close(law.mean(), mean) && close(law.sd(), sd), "{groups:?}: {:?}", law.moments());
        // And what is drawn: a grid of 10 000 midpoints has every atom to one point.
        let n = 10_000;
        let drawn = (0..n).map(|k| law.from_uniform((f64::from(k) + 0.5) / f64::from(n)));
        let first = drawn.filter(|x| *x == groups[0].0).count() as f64 / f64::from(n);
        let total: usize = groups.iter().map(|group| group.1).sum();
        assert!((first - groups[0].1 as f64 / total as f64).abs() <= 1.0 / f64::from(n), "{first}");
        assert_eq!(law.law().family(), "discrete");
    }
}

#[test]
fn analytic_rows_have_the_moments_of_the_rows() {
    // 99 rows of 1 and one of 1.1: mean 1.001, deviation 0.1 √(0.99 · 0.01).
    let law = Law::discrete(repeated(&[(1.0, 99), (1.1, 1)]), None).unwrap();
    assert!(close(law.mean(), 1.001) && close(law.sd(), 0.1 * 0.0099_f64.sqrt()));
    // Rows without a tie are no less a discrete law.
    let law = Law::discrete(vec![1.0, 2.0, 4.0], None).unwrap();
    assert!(close(law.mean(), 7.0 / 3.0) && close(law.sd(), 14.0_f64.sqrt() / 3.0));
}

#[test]
fn analytic_observations_without_ties_are_type_five() {
    // Hyndman and Fan's type 5 by hand: five values at 0.1, 0.3, 0.5, 0.7, 0.9; the mean is theirs, 6.4.
    let law = Marginal::untruncated(Law::empirical(vec![9.0, 1.0, 4.0, 16.0, 2.0], None).unwrap());
    for (p, x) in
        [(0.0, 1.0), (0.1, 1.0), (0.2, 1.5), (0.3, 2.0), (0.5, 4.0), (0.7, 9.0), (0.9, 16.0)]
    {
        assert!((law.quantile_lower(p) - x).abs() < 1e-13, "{p}");
    }
    assert!(close(law.mean(), 6.4));
    // A weight is a multiplicity.
    let weighted = Law::empirical(vec![1.0, 2.0, 3.0], Some(vec![1.0, 2.0, 1.0])).unwrap();
    assert_eq!(weighted, Law::empirical(vec![2.0, 1.0, 3.0, 2.0], None).unwrap());
}

#[test]
fn analytic_truncation_keeps_the_atoms_at_its_ends() {
    let law = Law::discrete(vec![1.0, 2.0, 3.0, 4.0], Some(vec![1.0, 2.0, 3.0, 4.0])).unwrap();
    let cut = Marginal::new(law.clone(), Some(2.0), Some(3.0)).unwrap();
    assert!(close(cut.mass(), 0.5) && close(cut.mean(), 2.6), "{} {}", cut.mass(), cut.mean());
    assert!(Marginal::new(law.clone(), Some(2.5), Some(3.5)).is_err(), "one value is a constant");
    assert!(Marginal::new(law, Some(5.0), None).is_err());
}

#[test]
fn analytic_the_nataf_correlation_of_two_coins_is_the_arcsine() {
    // Sheppard (1899): two normal variables cut at their medians have correlation (2/π) asin ρ.
    // 80 terms of the expansion leave less than 0.8^80 ≈ 2e-8 of it.
    let coin = Marginal::untruncated(Law::discrete(vec![0.0, 1.0], None).unwrap());
    for rho in [-0.8, -0.3, 0.2, 0.6, 0.8_f64] {
        let expected = 2.0 / std::f64::consts::PI * rho.asin();
        let found = product_moment_correlation(&coin, &coin, rho);
        assert!((found - expected).abs() < 1e-8, "{rho}: {found} not {expected}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: proptest::test_runner::RngSeed::Fixed(1899), ..ProptestConfig::with_cases(600) })]

    #[test]
    fn property_a_listed_law_has_its_sample_s_mean_and_inverts(
        // Whole numbers, so that about half of the samples have ties.
        list in prop::collection::vec(-30..30i32, 2..25), p in 0.0..1.0f64, z in -6.0..6.0f64,
    ) {
        let values: Vec<f64> = list.iter().map(|&k| f64::from(k)).collect();
        prop_assume!(list.iter().any(|k| *k != list[0]));
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        for law in [Law::empirical(values.clone(), None).unwrap(), Law::discrete(values.clone(), None).unwrap()] {
            let m = Marginal::untruncated(law);
            prop_assert!((m.mean() - mean).abs() < 1e-12 * (1.0 + mean.abs()));
            // The quantile is the least value with as much probability at or below it.
            let x = m.quantile_lower(p);
            prop_assert!(m.cdf(x) >= p - 1e-13, "{m:?}: cdf({x}) < {p}");
            let before = x - 1e-9;
            prop_assert!(m.cdf(before) <= p + 1e-13, "{m:?}: cdf({before}) > {p}");
            prop_assert!((m.cdf(x) + m.survival(x) - 1.0).abs() < 1e-13);
            let upper = m.quantile_upper(p);
            prop_assert!(m.survival(upper) <= p + 1e-13);
            // A value goes to a place on the axis that gives the value.
            let x = m.from_standard_normal(z);
            prop_assert!((m.from_standard_normal(m.to_standard_normal(x)) - x).abs() < 1e-9, "{m:?} {x}");
            // Columns have the bits of the scalars.
            let mut out = [0.0];
            m.quantile_column(&[p], &mut out);
            prop_assert_eq!(out[0].to_bits(), m.from_uniform(p).to_bits());
        }
    }
}

#[test]
fn reference_mpmath_normal_laws_cut_far_out() {
    // mpmath with 60 digits: λ = φ(a)/Q(a), sd = √(1 + a λ − λ²), of the standard normal cut to [a, ∞).
    let cases: [(f64, f64, f64); 6] = [
        (10.0, 10.098_093_233_962_512, 0.097_187_333_668_828_78),
        (31.0, 31.032_191_276_777_723, 0.032_158_071_925_309_69),
        (32.5, 32.530_711_243_381_92, 0.030_682_399_147_859_356),
        (33.0, 33.030_247_631_156_705, 0.030_220_070_119_581_15),
        (34.0, 34.029_361_097_995_02, 0.029_335_884_064_986_47),
        (35.5, 35.528_124_486_560_97, 0.028_102_319_144_917_398),
    ];
    for (a, mean, sd) in cases {
        let law = || Law::normal(0.0, 1.0).unwrap();
        for (marginal, sign) in [
            (Marginal::new(law(), Some(a), None).unwrap(), 1.0),
            (Marginal::new(law(), None, Some(-a)).unwrap(), -1.0),
        ] {
            let (m, s) = marginal.moments();
            // The quantile's own rounding is 1e-15 of `a`, some 4e-14 of the deviation.
            assert!((m - sign * mean).abs() < 1e-12 * sd.max(1.0), "{a}: {m} not {mean}");
            assert!((s / sd - 1.0).abs() < 1e-11, "{a}: {s} not {sd}");
        }
    }
}
