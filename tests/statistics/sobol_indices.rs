//! Sobol' indices by pick-freeze against closed forms, and the bootstrap's coverage.

use super::sensitivity_models::{
    ISHIGAMI_FIRST, ISHIGAMI_TOTAL, ISHIGAMI_VARIANCE, Model, factor, g_function,
    g_partial_variance, ishigami, run, singles, target_linear,
};
use reeldown::numerics::interval::Estimate;
use reeldown::sensitivity::bootstrap::Resampling;
use reeldown::sensitivity::pick_freeze::Plan;
use reeldown::sensitivity::sobol_indices::{SobolIndices, sobol_indices};

fn analyse(plan: &Plan, model: Model, seed: u64) -> SobolIndices {
    let blocks = run(plan, model, seed);
    let blocks: Vec<&[f64]> = blocks.iter().map(Vec::as_slice).collect();
    let resampling = Resampling::new(seed, plan.base_samples(), 300).unwrap();
    sobol_indices(plan, &blocks, &resampling, 0.95).unwrap()
}

/// Within four and a half standard errors, which a right estimator exceeds once in 147 000.
fn assert_near(estimate: &Estimate, truth: f64, what: &str) {
    let value = estimate.value.unwrap();
    let error = estimate.standard_error.unwrap();
    assert!((value - truth).abs() <= 4.5 * error, "{what}: {value} ± {error}, exactly {truth}");
}

/// Closed forms for the indicator 1[3 − Σ√aᵢ uᵢ < 0], from the bivariate normal law.
const TARGET_FIRST: [f64; 3] = [0.102244287045961, 0.0163412850642684, 0.00228881392242621];
const TARGET_TOTAL: [f64; 3] = [0.967467937475839, 0.830757700947185, 0.548554942179419];

#[test]
fn published_ishigami_indices() {
    let plan =
        Plan::new(16_384, 3, singles(3)).unwrap().with_pairs(&[(0, 2), (0, 1), (1, 2)]).unwrap();
    let result = analyse(&plan, ishigami, 1);
    for (j, factor) in result.factors.iter().enumerate() {
        assert_near(&factor.first, ISHIGAMI_FIRST[j], "first");
        assert_near(&factor.total, ISHIGAMI_TOTAL[j], "total");
        assert_eq!((factor.rows, factor.rows_left_out), (16_384, 0));
        // Root mean square difference from the first estimator over 40 other seeds of this design: at
        // most 5.9e-5, 7.3e-3 and 5.2e-3; five times that.
        let first = factor.first.value.unwrap();
        assert!((factor.cross_checks.first_janon.unwrap() - first).abs() < 3e-4);
        assert!((factor.cross_checks.first_saltelli.unwrap() - first).abs() < 0.037);
        assert!(
            (factor.cross_checks.total_martinez.unwrap() - factor.total.value.unwrap()).abs()
                < 0.026
        );
    }
    // Relative standard deviation of the variance over the same seeds: 0.83 %; five times that.
    assert!((result.variance.unwrap() / ISHIGAMI_VARIANCE - 1.0).abs() < 0.042);
    for (pair, truth) in result.pairs.iter().zip([0.243683664062148, 0.0, 0.0]) {
        assert_near(&pair.interaction, truth, "second order");
        let (i, j) = pair.factors;
        assert_near(&pair.closed, truth + ISHIGAMI_FIRST[i] + ISHIGAMI_FIRST[j], "closed");
    }
}

#[test]
fn analytic_g_function_with_a_group() {
    // Eight inputs one by one, then inputs 1, 3 and 5 (counted from 1: 2, 4, 6) as one factor.
    let mut factors = singles(8);
    factors.push(factor("group", &[1, 3, 5]));
    let plan = Plan::new(16_384, 8, factors).unwrap();
    let result = analyse(&plan, g_function, 2);
    let all: Vec<usize> = (0..8).collect();
    let variance = g_partial_variance(&all);
    for (factor, indices) in plan.factors().iter().zip(&result.factors) {
        let members = &factor.columns;
        let others: Vec<usize> = all.iter().copied().filter(|j| !members.contains(j)).collect();
        let first = g_partial_variance(members) / variance;
        let total = 1.0 - g_partial_variance(&others) / variance;
        assert_near(&indices.first, first, &format!("{} first", factor.name));
        assert_near(&indices.total, total, &format!("{} total", factor.name));
    }
    // The published numbers of the first input, with a = (0, 1, 4.5, 9, 99, …): a check of the formula.
    assert!((g_partial_variance(&[0]) / variance - 0.716192168879033).abs() < 1e-12);
    assert!((variance - 0.465424431902207).abs() < 1e-12);
}

#[test]
fn published_second_order_of_the_g_function() {
    let plan = Plan::new(16_384, 8, singles(8)).unwrap().with_pairs(&[(0, 1)]).unwrap();
    let pair = &analyse(&plan, g_function, 4).pairs[0];
    assert_near(&pair.interaction, 0.0596826807399194, "second order");
    assert_near(&pair.closed, 0.0596826807399194 + 0.716192168879033 + 0.179048042219758, "closed");
}

#[test]
fn analytic_breach_indicator_has_tiny_first_order_and_large_total_indices() {
    // 1[3 − Σ√aᵢ uᵢ < 0]: a rare event, P = 0.00135; first order and total from the bivariate normal.
    let plan = Plan::new(1 << 17, 3, singles(3)).unwrap();
    let result = analyse(&plan, target_linear, 3);
    let (first, total) = (TARGET_FIRST, TARGET_TOTAL);
    for (j, factor) in result.factors.iter().enumerate() {
        assert_near(&factor.total, total[j], "total");
        // About 18 rows have the event in both blocks for the first input, where the bootstrap serves, and
        // 3 and 1 for the others, whose intervals are exact.
        assert!(
            factor.first.interval.interval().unwrap().contains(first[j]),
            "{j}: {:?}",
            factor.first
        );
        let exact = factor.first.interval.interval().unwrap().method.contains("Clopper");
        assert_eq!(exact, j > 0);
    }
    // P with its binomial error of 2·2^17 samples: 7.2e-5, times 4.5.
    assert!((result.mean.unwrap() - 0.00134989803163009).abs() < 4.5 * 7.2e-5);
}

#[test]
fn property_the_bootstrap_interval_covers_as_stated() {
    // 300 seeds: a share of 0.95 has a binomial standard error of 0.0126, of which three are allowed
    // above; below, a further hundredth for the known shortfall of a bootstrap at 512 rows. Measured:
    // 0.943 to 0.970.
    let plan = Plan::new(512, 3, singles(3)).unwrap();
    let seeds = 300;
    let mut covered = [[0u32; 2]; 3];
    for seed in 0..seeds {
        let result = analyse(&plan, ishigami, 1000 + seed);
        for (j, factor) in result.factors.iter().enumerate() {
            let holds =
                |e: &Estimate, truth| u32::from(e.interval.interval().unwrap().contains(truth));
            covered[j][0] += holds(&factor.first, ISHIGAMI_FIRST[j]);
            covered[j][1] += holds(&factor.total, ISHIGAMI_TOTAL[j]);
        }
    }
    for count in covered.iter().flatten() {
        let share = f64::from(*count) / seeds as f64;
        assert!((0.90..=0.99).contains(&share), "coverage {share}: {covered:?}");
    }
    println!("coverage of first, total over {seeds} seeds: {covered:?}");
}

#[test]
fn property_intervals_of_a_rare_event_cover_although_no_row_may_see_it_twice() {
    // 8192 rows, about 11 events a block. A bootstrap of the first-order index held 71, 17 and 5 % of the
    // time here; the exact interval must hold at least as stated, and the totals about so: three binomial
    // standard errors of 100 seeds below 0.93, which is what 200 other seeds measured.
    let plan = Plan::new(8192, 3, singles(3)).unwrap();
    let mut covered = [[0u32; 2]; 3];
    for seed in 0..100 {
        let result = analyse(&plan, target_linear, 2000 + seed);
        for (j, factor) in result.factors.iter().enumerate() {
            let holds =
                |e: &Estimate, truth| u32::from(e.interval.interval().unwrap().contains(truth));
            covered[j][0] += holds(&factor.first, TARGET_FIRST[j]);
            covered[j][1] += holds(&factor.total, TARGET_TOTAL[j]);
        }
    }
    assert!(covered.iter().all(|[first, total]| *first >= 95 && *total >= 86), "{covered:?}");
}

#[test]
fn property_a_variance_made_by_few_rows_earns_no_interval() {
    let plan = Plan::new(1000, 2, singles(2)).unwrap();
    let result = analyse(&plan, |x| x[1] + if x[0] > 0.997 { 1e3 * x[0] } else { 0.0 }, 9);
    for factor in &result.factors {
        assert!(factor.total.interval.why_none().unwrap().contains("few rows"));
        assert!(factor.total.value.is_some() && factor.total.standard_error.is_none());
    }
}

#[test]
fn property_faults_do_not_poison() {
    let plan = Plan::new(8192, 3, singles(3)).unwrap();
    let mut blocks = run(&plan, ishigami, 5);
    // Every 37th point in evaluation order is a fault: about 2.7 % of each block, three blocks an index.
    let mut faults = 0;
    for row in 0..8192 {
        for (block, outcomes) in blocks.iter_mut().enumerate() {
            if (row * 5 + block) % 37 == 0 {
                outcomes[row] = if row % 2 == 0 { f64::NAN } else { f64::INFINITY };
                faults += 1;
            }
        }
    }
    assert!(faults > 1000);
    let slices: Vec<&[f64]> = blocks.iter().map(Vec::as_slice).collect();
    let resampling = Resampling::new(5, 8192, 300).unwrap();
    let result = sobol_indices(&plan, &slices, &resampling, 0.95).unwrap();
    for (j, factor) in result.factors.iter().enumerate() {
        assert_near(&factor.first, ISHIGAMI_FIRST[j], "first");
        assert_near(&factor.total, ISHIGAMI_TOTAL[j], "total");
        let w = 2 + j;
        let left_out =
            (0..8192).filter(|row| [0, 1, w].iter().any(|b| !blocks[*b][*row].is_finite())).count();
        assert_eq!((factor.rows_left_out, factor.rows), (left_out, 8192 - left_out));
    }
    // A block that is all faults costs its own factor only.
    blocks[3].fill(f64::NAN);
    let slices: Vec<&[f64]> = blocks.iter().map(Vec::as_slice).collect();
    let damaged = sobol_indices(&plan, &slices, &resampling, 0.95).unwrap();
    assert_eq!(damaged.factors[0], result.factors[0]);
    assert!(damaged.factors[1].first.interval.why_none().unwrap().contains("no row"));
    assert_eq!(damaged.factors[1].rows, 0);
}

#[test]
fn property_an_outcome_that_does_not_vary_has_no_index() {
    let plan = Plan::new(100, 2, singles(2)).unwrap();
    let constant = analyse(&plan, |_| 4.25, 6);
    assert_eq!((constant.mean, constant.variance), (Some(4.25), Some(0.0)));
    // The second one varies by its rounding only.
    for outcome in [constant, analyse(&plan, |x| 4.25 + 1e-13 * x[0], 6)] {
        for factor in &outcome.factors {
            assert_eq!(factor.first.value, None);
            assert!(factor.total.interval.why_none().unwrap().contains("does not vary"));
        }
    }
    let faulted = analyse(&plan, |_| f64::NAN, 6);
    assert_eq!((faulted.mean, faulted.factors[0].rows_left_out), (None, 100));
    assert_eq!(faulted.factors[0].total.value, None);
}

#[test]
fn property_an_input_without_effect_is_not_called_certain() {
    let plan = Plan::new(200, 2, singles(2)).unwrap();
    let result = analyse(&plan, |x| x[0], 7);
    assert_eq!(result.factors[1].total.value, Some(0.0));
    assert!(result.factors[1].total.interval.interval().is_none());
    // All of the variance by one input: exactly one, up to rounding, again without a spread.
    assert!((result.factors[0].first.value.unwrap() - 1.0).abs() < 1e-12);
    assert!(result.factors[0].first.interval.interval().is_none());
}

#[test]
fn property_a_negative_estimate_is_reported_and_explained() {
    let plan = Plan::new(256, 3, singles(3)).unwrap();
    let explained = (0..20).any(|seed| {
        let third = analyse(&plan, ishigami, 40 + seed).factors.remove(2);
        let negative = third.first.value.unwrap() < 0.0;
        assert_eq!(
            negative,
            third.explanation.as_deref().is_some_and(|text| text.contains("below 0"))
        );
        negative
    });
    assert!(explained, "an index of zero is estimated below zero about every second time");
}

#[test]
fn property_same_seed_same_bits_and_wrong_shapes_are_refused() {
    let plan = Plan::new(3000, 3, singles(3)).unwrap();
    assert_eq!(analyse(&plan, ishigami, 8), analyse(&plan, ishigami, 8));
    let blocks = run(&plan, ishigami, 8);
    let slices: Vec<&[f64]> = blocks.iter().map(Vec::as_slice).collect();
    let resampling = Resampling::new(8, 3000, 100).unwrap();
    assert!(sobol_indices(&plan, &slices[..4], &resampling, 0.9).is_err());
    assert!(sobol_indices(&plan, &slices, &resampling, 1.0).is_err());
    assert!(sobol_indices(&plan, &slices, &Resampling::new(8, 2999, 100).unwrap(), 0.9).is_err());
    assert!(Resampling::new(8, 0, 100).is_err() && Resampling::new(8, 10, 99).is_err());
}
