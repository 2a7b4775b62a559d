//! What is believed of P(any breach) of the default study.

use super::curves::study;
use reeldown::campaign::Progress;
use reeldown::campaign::epistemic::run_epistemic;
use reeldown::reliability::nested::{NestedEvent, band};

/// At 101 600 cSt a brake meets 1 % with 56.7 ± 0.4 % (an independent nested Monte Carlo with the root in temperature of every
/// brake). Counted, 128 descents a brake said 58.2 % on average over 12 seeds, and up to 61.2.
#[test]
fn reference_the_belief_near_the_requirement_is_not_biased() {
    let (outer, inner) = (1200, 32);
    let seeds = 12;
    let beliefs: Vec<f64> = (0..seeds)
        .map(|seed| {
            let study = study(&[
                "fluid.nominal_viscosity=101600 cSt",
                &format!("sampling.seed={seed}"),
                &format!("epistemic={{ outer = {outer}, inner = {inner} }}"),
            ]);
            let found = run_epistemic(&study, &Progress::default()).expect("an answer");
            let sample = found.expect("one").sample;
            let found = band(&sample.halves(NestedEvent::Any), &[0.5], &[0.01], 0.95);
            let found = found.expect("a band");
            let belief = &found.beliefs[0].1;
            println!(
                "{seed}: {belief:?} noise {:e} median {:?}",
                found.noise, found.quantiles[0].1.value
            );
            belief.value.expect("a number")
        })
        .collect();
    let mean = beliefs.iter().sum::<f64>() / f64::from(seeds);
    let squares: f64 = beliefs.iter().map(|b| (b - mean) * (b - mean)).sum();
    let error = (squares / f64::from(seeds * (seeds - 1))).sqrt();
    println!("{mean} ± {error}");
    assert!(error < 0.006, "{error}");
    assert!((mean - 0.567).abs() < 0.004 + 2.0 * error, "{mean} ± {error}");
}
