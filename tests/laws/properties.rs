//! Properties that hold for every law and every argument.

use proptest::prelude::*;
use reeldown::numerics::columns::Columns;
use reeldown::uncertainty::{Copula, Joint, Law, Marginal, Measure, Statement};

/// Some law with a density, with parameters of ordinary size; laws of listed values are in `listed`.
fn laws() -> impl Strategy<Value = Law> {
    let location = -10.0..10.0;
    let scale = 0.01..20.0;
    let shape = 0.3..30.0;
    prop_oneof![
        (location.clone(), scale.clone()).prop_map(|(m, s)| Law::normal(m, s).unwrap()),
        (scale.clone(), 0.01..1.5).prop_map(|(m, s)| Law::lognormal_median_log_sd(m, s).unwrap()),
        (location.clone(), scale.clone()).prop_map(|(a, w)| Law::uniform(a, a + w).unwrap()),
        (location.clone(), 0.0..1.0, scale.clone()).prop_map(|(a, c, w)| Law::triangular(
            a,
            a + c * w,
            a + w
        )
        .unwrap()),
        (shape.clone(), shape.clone(), location.clone(), scale.clone())
            .prop_map(|(p, q, a, w)| Law::beta(p, q, a, a + w).unwrap()),
        (shape.clone(), scale.clone(), location.clone())
            .prop_map(|(k, s, a)| Law::weibull(k, s, a).unwrap()),
        (location.clone(), scale.clone(), any::<bool>())
            .prop_map(|(location, scale, minimum)| Law::Gumbel { location, scale, minimum }),
        (shape, scale.clone(), location.clone()).prop_map(|(k, s, a)| Law::gamma(k, s, a).unwrap()),
        (scale, location).prop_map(|(m, a)| Law::exponential(m, a).unwrap()),
    ]
}

/// Some marginal: the law whole, or cut at two of its own quantiles, or at one.
fn marginals() -> impl Strategy<Value = Marginal> {
    (laws(), 0.0..0.95, 0.02..1.0, 0..4).prop_map(|(law, from, share, kind)| {
        let to: f64 = from + (1.0 - from) * share;
        let lower = law.quantile_lower(from);
        let upper = law.quantile_lower(to);
        let (lower, upper) = match kind {
            0 => (None, None),
            1 => (Some(lower), None),
            2 => (None, Some(upper)),
            _ => (Some(lower), Some(upper)),
        };
        let finite = |limit: Option<f64>| limit.filter(|x| x.is_finite());
        Marginal::new(law, finite(lower), finite(upper)).unwrap()
    })
}

/// A probability anywhere, or deep in a tail.
fn probabilities() -> impl Strategy<Value = f64> {
    prop_oneof![0.0001..0.9999, (-200.0..0.0).prop_map(|e: f64| 10f64.powf(e))]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: proptest::test_runner::RngSeed::Fixed(1993), ..ProptestConfig::with_cases(600) })]

    #[test]
    fn property_quantiles_increase_and_stay_inside(m in marginals(), p in probabilities(), r in 0.0..1.0f64) {
        let (least, greatest) = m.support();
        let (x, y) = (m.quantile_lower(p * r), m.quantile_lower(p));
        // Two approximations meet at some points: 1e-13 of the size is what they may disagree by.
        let slack = 1e-13 * (x.abs() + m.law().mean().abs());
        prop_assert!(x <= y + slack, "{m:?}: {x} above {y}");
        prop_assert!(x >= least && y <= greatest, "{m:?}: {x}, {y} outside");
        let (x, y) = (m.quantile_upper(p * r), m.quantile_upper(p));
        prop_assert!(x >= y - slack, "{m:?}: upper {x} below {y}");
        prop_assert!(x <= greatest && y >= least);
    }

    #[test]
    fn property_tails_of_quantiles_are_the_probabilities(m in marginals(), p in probabilities()) {
        // Relative, but for the rounding of x, of what is subtracted from it, and of a law's parameters.
        let (least, greatest) = m.support();
        let size = |x: f64| [x, least, greatest, m.law().mean(), m.law().sd(), m.law().support().0]
            .iter().filter(|v| v.is_finite()).fold(0.0f64, |a, b| a.max(b.abs()));
        let x = m.quantile_lower(p);
        let slack = |x: f64, p: f64| {
            let h = 16.0 * f64::EPSILON * size(x);
            1e-11 * p + (m.cdf(x + h) - m.cdf(x - h)).abs().max((m.survival(x - h) - m.survival(x + h)).abs())
        };
        prop_assert!((m.cdf(x) - p).abs() <= slack(x, p), "{m:?}: cdf({x}) = {} not {p}", m.cdf(x));
        let x = m.quantile_upper(p);
        prop_assert!((m.survival(x) - p).abs() <= slack(x, p), "{m:?}: survival({x}) = {} not {p}", m.survival(x));
    }

    #[test]
    fn property_columns_have_the_bits_of_the_scalars(
        m in marginals(),
        u in prop::collection::vec(prop_oneof![0.0..1.0f64, Just(0.5), (-300.0..0.0).prop_map(|e: f64| 10f64.powf(e)),
            Just(1.0 - f64::EPSILON / 2.0)], 1..70),
        z in prop::collection::vec(prop_oneof![-6.0..6.0f64, -40.0..40.0f64, Just(0.0)], 1..70),
    ) {
        let mut out = vec![0.0; u.len()];
        m.quantile_column(&u, &mut out);
        for (&u, x) in u.iter().zip(&out) {
            prop_assert_eq!(m.from_uniform(u).to_bits(), x.to_bits());
        }
        let mut out = vec![0.0; z.len()];
        m.from_standard_normal_column(&z, &mut out);
        for (&z, x) in z.iter().zip(&out) {
            prop_assert_eq!(m.from_standard_normal(z).to_bits(), x.to_bits());
        }
    }

    #[test]
    fn property_standard_normal_goes_there_and_back(m in marginals(), z in -5.0..5.0f64) {
        let x = m.from_standard_normal(z);
        let (least, greatest) = m.support();
        prop_assume!(x > least && x < greatest);
        let size = [x, m.law().mean(), m.law().sd(), m.law().support().0, least, greatest]
            .iter().filter(|v| v.is_finite()).fold(0.0f64, |a, b| a.max(b.abs()));
        let h = 16.0 * f64::EPSILON * size;
        let slack = 1e-10 + (m.to_standard_normal(x + h) - m.to_standard_normal(x - h)).abs();
        prop_assert!((m.to_standard_normal(x) - z).abs() <= slack, "{m:?}: {z} to {x} to {}", m.to_standard_normal(x));
    }

    #[test]
    fn property_density_is_the_slope_of_the_distribution(m in marginals(), p in 0.02..0.98f64) {
        let x = m.quantile_lower(p);
        let (least, greatest) = m.support();
        let h = 1e-5 * m.sd();
        prop_assume!(x - 3.0 * h > least && x + 3.0 * h < greatest);
        // Only where the density is nearly straight over the step: not across a kink.
        let (left, here, right) = (m.ln_density(x - h).exp(), m.ln_density(x).exp(), m.ln_density(x + h).exp());
        prop_assume!((left - here).abs() < 1e-3 * here && (right - here).abs() < 1e-3 * here);
        let slope = (m.cdf(x + h) - m.cdf(x - h)) / (2.0 * h);
        let rounding = 1e-13 * (1.0 + (x.abs() + m.law().mean().abs()) * here) / h;
        prop_assert!((slope - here).abs() <= 1e-5 * here + rounding, "{m:?} at {x}: {slope} not {here}");
    }

    #[test]
    fn property_spread_and_mean_move_as_said(m in marginals(), factor in 0.2..3.0f64, delta in -1.0..1.0f64) {
        let stretched = m.law().with_spread(factor).unwrap();
        prop_assert!((stretched.spread() / (factor * m.law().spread()) - 1.0).abs() < 1e-9);
        let shift = delta * 0.5 * m.law().mean().abs();
        let shifted = m.law().with_shifted_mean(shift).unwrap();
        let scale = m.law().mean().abs() + m.law().sd();
        prop_assert!((shifted.mean() - m.law().mean() - shift).abs() < 1e-11 * scale);
        // The truncation keeps its probability.
        let mass = m.with_spread(factor).unwrap().mass();
        prop_assert!((mass / m.mass() - 1.0).abs() < 1e-7, "{m:?}: {mass}");
    }

    #[test]
    fn property_a_batch_does_not_change_a_row(
        m in prop::collection::vec(marginals(), 3),
        rho in -0.9..0.9f64,
        u in prop::collection::vec((0.001..0.999f64, 0.001..0.999f64, 0.001..0.999f64), 2..30),
    ) {
        let copula = Copula::new(3, &[Statement { first: 0, second: 2, measure: Measure::Spearman(rho) }]).unwrap();
        let joint = Joint::new(m, Some(copula)).unwrap();
        let rows: Vec<[f64; 3]> = u.iter().map(|&(a, b, c)| [a, b, c]).collect();
        let (mut all, mut one) = (Columns::default(), Columns::default());
        joint.from_uniform(&Columns::from_rows(&rows), &mut all);
        for (k, row) in rows.iter().enumerate() {
            joint.from_uniform(&Columns::from_rows(&[row]), &mut one);
            for j in 0..3 {
                prop_assert_eq!(all.get(k, j).to_bits(), one.get(0, j).to_bits());
            }
        }
    }
}

#[test]
fn analytic_scores_have_expectation_zero_and_match_differences() {
    // E[score] = 0 under the marginal, by the midpoint rule over its probability: 20 000 points leave
    // less than 1e-4 of the largest score, and 1e-3 is asked for.
    let cases = [
        Marginal::untruncated(Law::normal(2.0, 0.5).unwrap()),
        Marginal::new(Law::normal(2.0, 0.5).unwrap(), Some(1.2), Some(2.1)).unwrap(),
        Marginal::untruncated(Law::lognormal_median_cv(1.0, 0.3).unwrap()),
        Marginal::new(Law::lognormal_median_cv(1.0, 0.3).unwrap(), None, Some(1.3)).unwrap(),
        Marginal::untruncated(Law::gumbel(3.0, 0.7).unwrap()),
        Marginal::new(Law::gumbel(3.0, 0.7).unwrap(), Some(2.5), None).unwrap(),
    ];
    for marginal in &cases {
        let n = 20_000;
        let (mut by_mean, mut by_spread) = (0.0, 0.0);
        for k in 0..n {
            let x = marginal.quantile_lower((f64::from(k) + 0.5) / f64::from(n));
            by_mean += marginal.score_mean(x) / f64::from(n);
            by_spread += marginal.score_spread(x) / f64::from(n);
        }
        let unit = 1.0 / marginal.law().sd();
        assert!(by_mean.abs() < 1e-3 * unit, "{marginal:?}: {by_mean}");
        assert!(by_spread.abs() < 1e-3 * unit, "{marginal:?}: {by_spread}");
        // The closed forms against differences of ln density, limits held; error h² ≈ 1e-8.
        let h = 1e-4 * marginal.law().sd();
        let x = marginal.quantile_lower(0.3);
        let at = |law: Law| {
            Marginal::new(law, marginal.lower(), marginal.upper()).unwrap().ln_density(x)
        };
        let law = marginal.law();
        let slope = (at(law.with_shifted_mean(h).unwrap())
            - at(law.with_shifted_mean(-h).unwrap()))
            / (2.0 * h);
        assert!((slope - marginal.score_mean(x)).abs() < 1e-6 * unit, "{marginal:?}");
        let (f, s) = (1e-4, law.spread());
        let slope = (at(law.with_spread(1.0 + f).unwrap()) - at(law.with_spread(1.0 - f).unwrap()))
            / (2.0 * f * s);
        assert!((slope - marginal.score_spread(x)).abs() < 1e-6 / s, "{marginal:?}");
    }
}

#[test]
fn analytic_constructors_refuse_what_is_no_law() {
    assert!(Law::normal(0.0, 0.0).is_err());
    assert!(Law::normal(f64::NAN, 1.0).is_err());
    assert!(Law::lognormal_median_cv(-1.0, 0.1).is_err());
    assert!(Law::uniform(2.0, 1.0).is_err());
    assert!(Law::triangular(0.0, 2.0, 1.0).is_err());
    assert!(Law::pert(0.0, -1.0, 1.0).is_err());
    assert!(Law::beta(0.0, 1.0, 0.0, 1.0).is_err());
    assert!(Law::gamma_mean_sd(0.0, 1.0).is_err());
    assert!(Law::exponential(-1.0, 0.0).is_err());
    assert!(Law::empirical(vec![1.0, 1.0], None).is_err());
    assert!(Law::empirical(vec![1.0, 2.0], Some(vec![1.0])).is_err());
    assert!(Law::empirical(vec![1.0, f64::NAN], None).is_err());
    let normal = || Law::normal(0.0, 1.0).unwrap();
    assert!(Marginal::new(normal(), Some(1.0), Some(1.0)).is_err());
    assert!(Marginal::new(normal(), Some(2.0), Some(1.0)).is_err());
    assert!(Marginal::new(normal(), Some(50.0), None).is_err());
    assert!(Marginal::new(Law::uniform(0.0, 1.0).unwrap(), Some(2.0), None).is_err());
}
