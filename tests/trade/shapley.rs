//! Shapley effects and sensitivities of a breach against closed forms.

use reeldown::numerics::columns::Columns;
use reeldown::numerics::special::normal;
use reeldown::sampling::{Design, Sampler};
use reeldown::sensitivity::shapley::Walks;
use reeldown::sensitivity::target::breach_sensitivities;
use reeldown::streams::Purpose;
use reeldown::uncertainty::{Copula, Joint, Law, Marginal, Measure, Statement};

fn normals(rows: usize, columns: usize, seed: u64) -> Columns {
    let sampler = Sampler::new(Design::MonteCarlo, columns, rows as u64, 1, seed, Purpose::Shapley);
    let mut points = Columns::new(rows, columns);
    sampler.expect("a sampler").fill(0, &mut points).expect("points");
    let mut normals = Columns::new(rows, columns);
    for j in 0..columns {
        normal::quantile_column(points.column(j), normals.column_mut(j));
    }
    normals
}

fn check(walks: &Walks, exact: &[f64], outcome: impl Fn(&[f64]) -> f64) {
    let ends = normals(walks.orders(), 2 * walks.inputs(), 3);
    let points = walks.points(0, &ends).expect("points");
    let outcomes: Vec<f64> = (0..points.rows()).map(|k| outcome(&points.row(k))).collect();
    let found = walks.effects(&outcomes, 0.9999).expect("effects");
    let sum: f64 = found.effects.iter().filter_map(|effect| effect.value).sum();
    assert!((sum - 1.0).abs() < 1e-9, "{sum}");
    for (effect, exact) in found.effects.iter().zip(exact) {
        let interval = effect.interval.interval().copied().expect("an interval");
        assert!(interval.contains(*exact), "{interval:?} {exact}");
        assert!(interval.width() < 0.1, "{interval:?}");
    }
}

#[test]
fn analytic_ishigami() {
    // Closed forms of Ishigami's function: Sᵢ plus equal shares of the interaction of 1 and 3.
    let exact = [0.435747023178885, 0.442411144790041, 0.121841832031074];
    let walks = Walks::new(vec![vec![0], vec![1], vec![2]], None, 40_000, 7).expect("walks");
    let angle = |z: f64| std::f64::consts::PI * (2.0 * normal::cdf(z) - 1.0);
    check(&walks, &exact, |z| {
        let (a, b, c) = (angle(z[0]), angle(z[1]), angle(z[2]));
        a.sin() + 7.0 * b.sin().powi(2) + 0.1 * c.powi(4) * a.sin()
    });
}

#[test]
fn property_an_outcome_that_varies_by_rounding_has_no_effects() {
    let walks = Walks::new(vec![vec![0], vec![1]], None, 100, 7).expect("walks");
    let points = walks.points(0, &normals(100, 4, 3)).expect("points");
    let outcomes: Vec<f64> = (0..points.rows()).map(|k| 3.0 + 1e-13 * points.get(k, 0)).collect();
    let found = walks.effects(&outcomes, 0.9).expect("effects");
    assert_eq!(found.variance, None);
    assert!(found.effects.iter().all(|effect| {
        effect.interval.why_none().is_some_and(|why| why.contains("does not vary"))
    }));
}

#[test]
fn analytic_a_skewed_outcome_has_intervals_only_from_enough_walks() {
    // exp(2.5 z₁ + 1.5 z₂): the variance of 1000 walks comes from a handful of them.
    let effects = |orders: usize, a: f64, b: f64| {
        let walks = Walks::new(vec![vec![0], vec![1]], None, orders, 7).expect("walks");
        let points = walks.points(0, &normals(orders, 4, 3)).expect("points");
        let outcomes: Vec<f64> = (0..points.rows())
            .map(|k| (a * points.get(k, 0) + b * points.get(k, 1)).exp())
            .collect();
        walks.effects(&outcomes, 0.9999).expect("effects").effects
    };
    for effect in effects(1000, 2.5, 1.5) {
        assert!(effect.value.is_some());
        assert!(effect.interval.why_none().is_some_and(|why| why.contains("few walks")));
    }
    // exp(0.5 z₁ + 0.3 z₂): with vⱼ = exp(σⱼ²) − 1 the effects are vᵢ + v₁v₂/2 over v₁ + v₂ + v₁v₂.
    let (v, w) = (0.25f64.exp_m1(), 0.09f64.exp_m1());
    let all = v + w + v * w;
    for (effect, exact) in
        effects(4000, 0.5, 0.3).iter().zip([(v + v * w / 2.0) / all, (w + v * w / 2.0) / all])
    {
        let interval = effect.interval.interval().expect("an interval");
        assert!(interval.contains(exact) && interval.width() < 0.2, "{interval:?} {exact}");
    }
}

#[test]
fn published_g_function_of_eight_inputs() {
    // Closed forms of Sobol's g with a = (0, 1, 4.5, 9, 99, 99, 99, 99): Sᵢ plus equal shares of every interaction.
    let a = [0.0, 1.0, 4.5, 9.0, 99.0, 99.0, 99.0, 99.0];
    let tiny = 8.78727317004569e-05;
    let exact = [
        0.751518863064373,
        0.210477293704114,
        0.028880459422742,
        0.00877189288196917,
        tiny,
        tiny,
        tiny,
        tiny,
    ];
    let factors = (0..8).map(|j| vec![j]).collect();
    let walks = Walks::new(factors, None, 40_000, 7).expect("walks");
    check(&walks, &exact, |z| {
        let factor = |(z, a): (&f64, f64)| ((4.0 * normal::cdf(*z) - 2.0).abs() + a) / (1.0 + a);
        z.iter().zip(a).map(factor).product()
    });
}

#[test]
fn analytic_linear_function_of_correlated_normal_variables() {
    // x1 + x2 + x3 with sd 1, 1, 2 and corr(x2, x3) = 0.9: conditional variances of Gaussian vectors.
    let exact = [0.10416666666666667, 0.41822916666666665, 0.4776041666666667];
    let rows = vec![vec![1.0, 0.0, 0.0], vec![0.0, 1.0, 0.9], vec![0.0, 0.9, 1.0]];
    let walks = Walks::new(vec![vec![0], vec![1], vec![2]], Some(&rows), 40_000, 7).expect("walks");
    let statement = Statement { first: 1, second: 2, measure: Measure::Normal(0.9) };
    let copula = Copula::new(3, &[statement]).expect("a copula");
    let marginals = [1.0, 1.0, 2.0]
        .map(|sd| Marginal::untruncated(Law::normal(0.0, sd).expect("a law")))
        .to_vec();
    let joint = Joint::new(marginals, Some(copula)).expect("a joint law");
    let outcome = |z: &[f64]| {
        let mut x = Columns::default();
        joint.from_standard_normal(&Columns::from_rows(&[z]), &mut x);
        x.row(0).iter().sum()
    };
    check(&walks, &exact, outcome);
    // The two that are correlated as one factor: the shares of a group add.
    let grouped = Walks::new(vec![vec![0], vec![1, 2]], Some(&rows), 40_000, 7).expect("walks");
    check(&grouped, &[exact[0], exact[1] + exact[2]], outcome);
}

#[test]
fn analytic_a_breach_beyond_a_plane() {
    // 1[3 − Σ √aᵢ uᵢ < 0]: first-order indices of the indicator by the bivariate normal law, and the mean
    // score of uᵢ among the breaches √aᵢ φ(3)/Φ(−3).
    let a = [0.6f64, 0.3, 0.1];
    let target = [0.102244287045961, 0.0163412850642684, 0.00228881392242621];
    let rows = 1_000_000;
    let u = normals(rows, 3, 5);
    let breached: Vec<f64> = (0..rows)
        .map(|k| {
            let sum: f64 = a.iter().enumerate().map(|(j, a)| a.sqrt() * u.get(k, j)).sum();
            f64::from(u8::from(sum > 3.0))
        })
        .collect();
    let uniforms: Vec<Vec<f64>> =
        (0..3).map(|j| u.column(j).iter().map(|&z| normal::cdf(z)).collect()).collect();
    let columns: Vec<&[f64]> = uniforms.iter().map(Vec::as_slice).collect();
    let found = breach_sensitivities(&columns, &breached, 0.9999).expect("sensitivities");
    let mills = normal::density(3.0) / normal::survival(3.0);
    for ((found, a), target) in found.iter().zip(a).zip(target) {
        let shift = found.shift.interval.interval().copied().expect("an interval");
        assert!(shift.contains(a.sqrt() * mills), "{shift:?}");
        if let Some(interval) = found.target.interval.interval() {
            assert!(interval.contains(target), "{interval:?} {target}");
        }
        assert!(found.p_value.expect("a p-value") < 1e-6);
    }
    assert!(found[0].target.interval.interval().is_some(), "{found:?}");
    let distances: Vec<f64> = found.iter().filter_map(|f| f.distance.value).collect();
    assert!(distances[0] > distances[1] && distances[1] > distances[2], "{distances:?}");
}
