//! dP/dθ against closed forms.

use reeldown::numerics::columns::Columns;
use reeldown::reliability::paired::PairedCounts;
use reeldown::sampling::{Design, Sampler};
use reeldown::sensitivity::reweighting::reweighted;
use reeldown::sensitivity::score_sums::ScoreSums;
use reeldown::streams::Purpose;
use reeldown::uncertainty::{Joint, Law, Marginal};

/// R ~ N(7, 1) and S ~ N(2, 1); breach where R < S.
fn strength_and_load() -> [Marginal; 2] {
    [(7.0, 1.0), (2.0, 1.0)]
        .map(|(mean, sd)| Marginal::untruncated(Law::normal(mean, sd).expect("a law")))
}

fn draws(marginals: &[Marginal; 2], rows: usize) -> Columns {
    let sampler = Sampler::new(Design::MonteCarlo, 2, rows as u64, 1, 11, Purpose::Test);
    let mut points = Columns::new(rows, 2);
    sampler.expect("a sampler").fill(0, &mut points).expect("points");
    let mut inputs = Columns::default();
    Joint::independent(marginals.to_vec()).from_uniform(&points, &mut inputs);
    inputs
}

fn breached(inputs: &Columns, k: usize) -> bool {
    inputs.get(k, 0) < inputs.get(k, 1)
}

/// Closed form (dP/dθ of P = Φ(−β), β = (μR − μS)/√(σR² + σS²)): mean of R, mean of S, sd of R, sd of S.
const EXACT: [f64; 4] =
    [-0.000544571057588177, 0.000544571057588177, 0.00136142764397044, 0.00136142764397044];

#[test]
fn published_score_function_derivatives_of_strength_less_load() {
    let marginals = strength_and_load();
    let rows = 1_000_000;
    let inputs = draws(&marginals, rows);
    let mut sums = [ScoreSums::default(); 4];
    for k in 0..rows {
        let (r, s) = (inputs.get(k, 0), inputs.get(k, 1));
        let scores = [
            marginals[0].score_mean(r),
            marginals[1].score_mean(s),
            marginals[0].score_spread(r),
            marginals[1].score_spread(s),
        ];
        let breached = Some(breached(&inputs, k));
        sums.iter_mut().zip(scores).for_each(|(sum, score)| sum.push(breached, score));
    }
    for (sum, exact) in sums.iter().zip(EXACT) {
        // 0.9999 each: one seed in 2500 fails somewhere. About 200 breaches give 8 % of standard error.
        let estimate = sum.derivative(0.9999).expect("a derivative").derivative;
        let interval = estimate.interval.interval().copied().expect("an interval");
        assert!(interval.contains(exact), "{interval:?} {exact}");
        assert!(estimate.standard_error.expect("an error") < 0.12 * exact.abs());
    }
}

#[test]
fn published_common_random_numbers_give_the_same_derivatives_with_less_error() {
    let marginals = strength_and_load();
    let rows = 1_000_000;
    let step = 0.1;
    let moved = |which: usize, sign: f64| {
        let mut changed = marginals.clone();
        let input = which % 2;
        let law = changed[input].law();
        let law = if which < 2 {
            law.with_shifted_mean(sign * step)
        } else {
            law.with_spread(1.0 + sign * step)
        };
        changed[input] = Marginal::untruncated(law.expect("a law"));
        draws(&changed, rows)
    };
    for (which, exact) in EXACT.into_iter().enumerate() {
        let (below, above) = (moved(which, -1.0), moved(which, 1.0));
        let mut counts = PairedCounts::default();
        for k in 0..rows {
            counts.push(Some(breached(&below, k)), Some(breached(&above, k)));
        }
        let estimate = counts.difference(0.9999).expect("a difference");
        let interval = estimate.interval.interval().copied().expect("an interval");
        // The difference over 2h; its bias is h²/6 times the third derivative: at β = 3.5 and h = 0.1 sd below
        // 2 % of the derivative, allowed for.
        let (lower, upper) = (interval.lower / (2.0 * step), interval.upper / (2.0 * step));
        let bias = 0.02 * exact.abs();
        assert!(lower - bias <= exact && exact <= upper + bias, "{lower} {upper} {exact}");
    }
}

#[test]
fn analytic_reweighting_finds_the_probability_under_narrower_laws_and_refuses_wider_ones() {
    // P(Z > 1.5) under N(0, 0.8²) from samples of N(0, 1): 1 − Φ(1.875) = 0.0303964.
    let marginals = [(0.0, 1.0), (0.0, 1.0)]
        .map(|(mean, sd)| Marginal::untruncated(Law::normal(mean, sd).expect("a law")));
    let inputs = draws(&marginals, 100_000);
    let hit: Vec<f64> = inputs.column(0).iter().map(|z| f64::from(u8::from(*z > 1.5))).collect();
    let ratios = |factor: f64| -> Vec<f64> {
        let narrow = marginals[0].with_spread(factor).expect("a law");
        let column = inputs.column(0);
        column.iter().map(|&z| narrow.ln_density(z) - marginals[0].ln_density(z)).collect()
    };
    let found = reweighted(&hit, &ratios(0.8), true, 0.9999).expect("an answer");
    assert!(found.trusted && found.effective_share > 0.8, "{found:?}");
    let interval = found.probability.interval.interval().copied().expect("an interval");
    assert!(interval.contains(0.030_396_4), "{interval:?}");
    let refused = reweighted(&hit, &ratios(4.0), true, 0.95).expect("an answer");
    assert!(!refused.trusted && refused.probability.value.is_none(), "{refused:?}");
    let uncovered = reweighted(&hit, &ratios(1.1), false, 0.95).expect("an answer");
    assert!(!uncovered.trusted);
}
