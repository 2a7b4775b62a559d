//! The Gaussian copula and the joint law.

use reeldown::numerics::columns::Columns;
use reeldown::numerics::special::normal;
use reeldown::streams::{Purpose, stream};
use reeldown::uncertainty::{Copula, Joint, Law, Marginal, Measure, Statement, nataf};

/// A statement of normal correlation.
fn normally(first: usize, second: usize, rho: f64) -> Statement {
    Statement { first, second, measure: Measure::Normal(rho) }
}

#[test]
fn analytic_measures_convert() {
    // Kruskal (1958): ρ = 2 sin(π ρs/6) = sin(π τ/2).
    assert!((Measure::Spearman(1.0 - 1e-15).normal_correlation() - 1.0).abs() < 1e-14);
    assert!((Measure::Kendall(-1.0 / 3.0).normal_correlation() + 0.5).abs() < 1e-15);
    assert_eq!(Measure::Normal(0.7).normal_correlation(), 0.7);
}

#[test]
fn analytic_refusals_name_the_pair_and_what_would_do() {
    // Three inputs, each pair at −0.6: with two of them given, the third must exceed
    // ρ12 ρ13 − √((1 − ρ12²)(1 − ρ13²)) = 0.36 − 0.64 = −0.28.
    let statements = [normally(0, 1, -0.6), normally(0, 2, -0.6), normally(1, 2, -0.6)];
    let refusal = Copula::new(3, &statements).unwrap_err();
    assert_eq!((refusal.statement, refusal.pair), (2, (1, 2)));
    let (low, high) = refusal.admissible.unwrap();
    assert!((low + 0.28).abs() < 1e-12 && (high - 1.0).abs() < 1e-12, "{low} {high}");
    let mended =
        |rho| Copula::new(3, &[normally(0, 1, -0.6), normally(0, 2, -0.6), normally(1, 2, rho)]);
    assert!(mended(-0.279).is_ok() && mended(-0.281).is_err());
    // The range is in the statement's own measure.
    let third = Statement { first: 1, second: 2, measure: Measure::Kendall(-0.6) };
    let refusal = Copula::new(3, &[statements[0], statements[1], third]).unwrap_err();
    let (low, _) = refusal.admissible.unwrap();
    assert!((Measure::Kendall(low).normal_correlation() + 0.28).abs() < 1e-12);
    for (statements, at) in [
        (vec![normally(0, 0, 0.1)], 0),
        (vec![normally(0, 3, 0.1)], 0),
        (vec![normally(0, 1, 0.1), normally(1, 0, 0.1)], 1),
        (vec![normally(0, 1, 1.0)], 0),
        (vec![normally(0, 1, f64::NAN)], 0),
    ] {
        assert_eq!(Copula::new(3, &statements).unwrap_err().statement, at);
    }
    // Two contradictions far apart: no single statement mends both.
    let twice: Vec<Statement> = [0, 3]
        .iter()
        .flat_map(|&k| {
            [normally(k, k + 1, -0.6), normally(k, k + 2, -0.6), normally(k + 1, k + 2, -0.6)]
        })
        .collect();
    let refusal = Copula::new(6, &twice).unwrap_err();
    assert_eq!((refusal.statement, refusal.admissible), (2, None));
}

#[test]
fn analytic_joint_goes_there_and_back() {
    let marginals = vec![
        Marginal::new(Law::normal(1.0, 0.3).unwrap(), Some(0.5), Some(1.5)).unwrap(),
        Marginal::untruncated(Law::lognormal_median_cv(2.0, 0.2).unwrap()),
        Marginal::untruncated(Law::weibull(2.0, 3.0, 0.0).unwrap()),
    ];
    let copula = Copula::new(3, &[normally(0, 1, 0.6), normally(1, 2, -0.4)]).unwrap();
    let joint = Joint::new(marginals.clone(), Some(copula)).unwrap();
    assert!(!joint.is_independent());
    let rows = [[0.3, -1.2, 2.0], [-2.5, 0.0, 0.7], [1.0, 1.0, 1.0]];
    let mut x = Columns::default();
    joint.from_standard_normal(&Columns::from_rows(&rows), &mut x);
    for (k, row) in rows.iter().enumerate() {
        for (got, &z) in joint.to_standard_normal(&x.row(k)).iter().zip(row) {
            // A tail e^(−z²/2) near a truncation limit keeps some 1e-12 of z.
            assert!((got - z).abs() < 1e-11, "{got} is not {z}");
        }
    }
    // By hand: the second input's normal is 0.6 z1 + 0.8 z2.
    let expected = marginals[1].from_standard_normal(0.6 * 0.3 + 0.8 * -1.2);
    assert!((x.get(0, 1) / expected - 1.0).abs() < 1e-15);
    // A copula of zeros is no copula, and uniforms then go straight through the quantiles.
    let free = Joint::new(marginals.clone(), Some(Copula::new(3, &[normally(0, 1, 0.0)]).unwrap()))
        .unwrap();
    assert!(free.is_independent());
    free.from_uniform(&Columns::from_rows(&[[0.2, 0.9, 0.5]]), &mut x);
    assert_eq!(x.get(0, 2), marginals[2].quantile_lower(0.5));
    assert!(Joint::new(marginals, Some(Copula::new(2, &[]).unwrap())).is_err());
}

#[test]
fn analytic_sample_correlations_are_those_stated() {
    use rand::RngExt;
    let marginals = vec![
        Marginal::untruncated(Law::exponential(1.0, 0.0).unwrap()),
        Marginal::untruncated(Law::gumbel(0.0, 1.0).unwrap()),
    ];
    let rho = nataf::normal_correlation(&marginals[0], &marginals[1], 0.5).unwrap();
    let joint =
        Joint::new(marginals, Some(Copula::new(2, &[normally(0, 1, rho)]).unwrap())).unwrap();
    let n = 40_000;
    let mut random = stream(1993, Purpose::Test, 7);
    let mut u = Columns::new(n, 2);
    for k in 0..n {
        for j in 0..2 {
            u.set(k, j, random.random_range(1e-16..1.0));
        }
    }
    let mut x = Columns::default();
    joint.from_uniform(&u, &mut x);
    let mean = |v: &[f64]| v.iter().sum::<f64>() / n as f64;
    let (a, b) = (x.column(0), x.column(1));
    let (ma, mb) = (mean(a), mean(b));
    let moment = |v: &[f64], mv: f64, w: &[f64], mw: f64| {
        v.iter().zip(w).map(|(v, w)| (v - mv) * (w - mw)).sum::<f64>() / n as f64
    };
    let r = moment(a, ma, b, mb) / (moment(a, ma, a, ma) * moment(b, mb, b, mb)).sqrt();
    // Its standard error is below 2/√n = 0.01 for these kurtoses; four of them.
    assert!((r - 0.5).abs() < 0.04, "{r}");
}

#[test]
fn analytic_nataf_refuses_the_unattainable() {
    let skewed = Marginal::untruncated(Law::lognormal_mean_sd(1.0, 1.0).unwrap());
    // Two lognormal laws of variation 1: the least correlation is (e^(−ln 2) − 1)/1 = −½.
    assert!(nataf::normal_correlation(&skewed, &skewed, -0.6).is_err());
    let close = nataf::normal_correlation(&skewed, &skewed, -0.45).unwrap();
    assert!((nataf::product_moment_correlation(&skewed, &skewed, close) + 0.45).abs() < 1e-12);
    assert!(nataf::normal_correlation(&skewed, &skewed, f64::NAN).is_err());
    assert!(normal::quantile(0.5).abs() == 0.0);
}

#[test]
fn property_a_lone_correlation_of_nearly_one_contradicts_nobody() {
    let lone = |rho: f64| {
        Copula::new(2, &[Statement { first: 0, second: 1, measure: Measure::Normal(rho) }])
    };
    for rho in [0.999_999_999_99, -0.999_999_999_99] {
        let refusal = lone(rho).unwrap_err();
        assert!(refusal.reason.contains("makes them one input"), "{refusal}");
        assert!(!refusal.reason.contains("contradict"), "{refusal}");
    }
    assert!(lone(0.999_999).is_ok());
}
