//! Published tables and textbook values, as literals with their source.

use reeldown::numerics::special::{beta, student};
use reeldown::uncertainty::{Law, Marginal, Measure, nataf};

/// |got/expected − 1| ≤ tolerance.
#[track_caller]
fn assert_close(got: f64, expected: f64, tolerance: f64) {
    assert!((got / expected - 1.0).abs() <= tolerance, "{got} is not {expected}");
}

/// Both limits of the two-sided interval at 95 % and the one-sided upper limits at 95 and 90 %.
fn clopper_pearson(k: f64, n: f64) -> [f64; 4] {
    let lower = if k == 0.0 { 0.0 } else { beta::quantile_lower(k, n - k + 1.0, 0.025) };
    let upper = |q: f64| beta::quantile_upper(k + 1.0, n - k, q);
    [lower, upper(0.025), upper(0.05), upper(0.1)]
}

#[test]
fn published_clopper_pearson_intervals() {
    // Certified by SciPy's beta quantiles (benchmark table of binomial intervals), 15 digits.
    let table = [
        (0.0, 10.0, [0.0, 0.3084971078187607, 0.2588655508930522, 0.2056717652757185]),
        (0.0, 100.0, [0.0, 0.03621669264517641, 0.029513049607039925, 0.02276277904418932]),
        (0.0, 1000.0, [0.0, 0.003682083896865671, 0.002991249545095295, 0.002299936177446683]),
        (
            1.0,
            100.0,
            [
                0.00025314603297742064,
                0.054459385392080645,
                0.046559811453538935,
                0.03833949749538697,
            ],
        ),
        (
            2.0,
            2000.0,
            [
                0.00012112759055682972,
                0.0036076285698285315,
                0.0031445178378896837,
                0.0026589506441740485,
            ],
        ),
        (
            5.0,
            1000.0,
            [0.00162541951756276, 0.011629470559812147, 0.010484076911415651, 0.009254858093067034],
        ),
        (
            10.0,
            1000.0,
            [0.004805510691049308, 0.01831324305511245, 0.016903175120562504, 0.015364975604890663],
        ),
        (
            50.0,
            100.0,
            [0.39832112950330095, 0.601678870496699, 0.5863782853690882, 0.5685831744062192],
        ),
    ];
    for (k, n, expected) in table {
        for (got, expected) in clopper_pearson(k, n).into_iter().zip(expected) {
            if expected == 0.0 {
                assert_eq!(got, 0.0);
            } else {
                assert_close(got, expected, 1e-12);
            }
        }
    }
}

#[test]
fn published_success_run_sizes() {
    // The least n for which zero to three failures demonstrate 99.73 % at 90 % confidence.
    for (failures, n) in [(0.0, 852.0), (1.0, 1440.0), (2.0, 1970.0), (3.0, 2473.0)] {
        assert!(beta::quantile_upper(failures + 1.0, n - failures, 0.1) <= 0.0027);
        assert!(beta::quantile_upper(failures + 1.0, n - 1.0 - failures, 0.1) > 0.0027);
    }
}

#[test]
fn published_distribution_values() {
    // Certified values of common engineering distributions, 17 digits (mpmath).
    let lognormal = Marginal::untruncated(Law::lognormal_mean_sd(3.0, 0.9).unwrap());
    let Law::Lognormal { log_mean, log_sd } = *lognormal.law() else { panic!("not lognormal") };
    assert_close(log_mean, 1.0555234405475835, 1e-15);
    assert_close(log_sd, 0.29356037920852385, 1e-15);
    for (x, p) in [
        (0.5, 1.2863874048848913e-9),
        (1.0, 0.0001618271702094482),
        (2.0, 0.10852356475134466),
        (3.0, 0.5583472391428936),
        (5.0, 0.9704120556696658),
        (10.0, 0.9999892184433502),
    ] {
        assert_close(lognormal.cdf(x), p, 1e-13);
    }
    let gumbel = Marginal::untruncated(Law::gumbel_mean_sd(1500.0, 350.0).unwrap());
    let Law::Gumbel { location, scale, .. } = *gumbel.law() else { panic!("not Gumbel") };
    assert_close(location, 1342.481377359007, 1e-15);
    assert_close(scale, 272.8938804317866, 1e-15);
    for (x, p) in
        [(800.0, 0.0006754912017839644), (1500.0, 0.570376001675023), (3000.0, 0.9977003738448373)]
    {
        assert_close(gumbel.cdf(x), p, 1e-13);
    }
    assert_close(gumbel.quantile_lower(1e-6), 625.9188326112383, 1e-14);
    assert_close(gumbel.quantile_lower(0.5), 1442.5005104849245, 1e-14);
    // The table means the decimal 0.999999, whose upper tail is 1e-6; the nearest double is not that.
    assert_close(gumbel.quantile_upper(1e-6), 5112.649527221199, 1e-14);
    let weibull = Marginal::untruncated(Law::weibull(2.5, 4.0, 0.0).unwrap());
    for (x, p) in [
        (0.1, 9.881629422859964e-5),
        (1.0, 0.03076676552365592),
        (4.0, 0.6321205588285577),
        (8.0, 0.9965065107233538),
    ] {
        assert_close(weibull.cdf(x), p, 1e-14);
    }
    for (p, x) in
        [(1e-9, 0.001004754572804783), (0.5, 3.454539602409499), (0.999, 8.665522788380096)]
    {
        assert_close(weibull.quantile_lower(p), x, 1e-14);
    }
    let gamma = Marginal::untruncated(Law::gamma(2.3, 1.7, 0.0).unwrap());
    for (x, p) in [
        (0.01, 2.751033345586718e-6),
        (1.0, 0.07362388772909015),
        (4.0, 0.6009644869166814),
        (20.0, 0.9998171872732476),
    ] {
        assert_close(gamma.cdf(x), p, 1e-14);
    }
    let beta = Marginal::untruncated(Law::beta(2.5, 4.0, 0.0, 1.0).unwrap());
    for (x, p) in [
        (0.001, 4.555762682512327e-7),
        (0.1, 0.03661225782236822),
        (0.5, 0.736109207758652),
        (0.95, 0.9999469518008899),
    ] {
        assert_close(beta.cdf(x), p, 1e-14);
    }
    for (t, p) in [
        (-10.0, 8.54737878714818e-5),
        (-2.0, 0.05096973941492918),
        (0.5, 0.6808505641795355),
        (3.0, 0.9849503760512687),
    ] {
        assert_close(student::cdf(5.0, t), p, 1e-14);
    }
    let truncated = Marginal::new(Law::normal(0.0, 1.0).unwrap(), Some(-2.0), Some(1.0)).unwrap();
    for (x, p) in [
        (-1.9, 0.007288623410054963),
        (-1.0, 0.1660224971420283),
        (0.0, 0.5830112485710142),
        (0.9, 0.968965259510531),
    ] {
        assert_close(truncated.cdf(x), p, 1e-13);
    }
    assert_close(truncated.mean(), -0.22963717909132897, 1e-12);
    let triangular = Marginal::untruncated(Law::triangular(1.0, 2.0, 4.0).unwrap());
    assert_close(triangular.cdf(1.5), 1.0 / 12.0, 1e-15);
    assert_close(triangular.cdf(3.0), 5.0 / 6.0, 1e-15);
    assert_close(triangular.quantile_lower(0.1), 1.547722557505166, 1e-15);
    assert_close(triangular.quantile_lower(0.9), 3.2254033307585166, 1e-15);
}

#[test]
fn published_nataf_correlations() {
    // Der Kiureghian and Liu (1986), exact cases, to 15 digits; lognormal laws by coefficient of variation.
    let lognormal = |cv: f64| Marginal::untruncated(Law::lognormal_mean_sd(1.0, cv).unwrap());
    let normal = Marginal::untruncated(Law::normal(2.0, 3.0).unwrap());
    let uniform = Marginal::untruncated(Law::uniform(-1.0, 5.0).unwrap());
    let found = |a: &Marginal, b: &Marginal| nataf::normal_correlation(a, b, 0.5).unwrap();
    // The trapezoidal rule and 80 terms leave rounding alone in these analytic cases.
    assert_close(found(&lognormal(0.3), &lognormal(0.5)), 0.5215221759434144, 1e-12);
    assert_close(found(&uniform, &uniform), 0.5176380902050415, 1e-12);
    assert_close(found(&normal, &lognormal(0.5)), 0.529234123387546, 1e-12);
    assert_close(found(&normal, &normal), 0.5, 1e-12);
    // Normal correlation ½ is Kendall's τ of a third.
    assert_close(Measure::Kendall(1.0 / 3.0).normal_correlation(), 0.5, 1e-15);
    assert_close(Measure::Spearman(0.5).normal_correlation(), 0.5176380902050415, 1e-15);
}
