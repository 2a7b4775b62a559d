//! How often the verdict and the interval of a run that stopped because of what it saw are true.

use reeldown::numerics::columns::Columns;
use reeldown::reliability::adaptive::{AdaptiveMonteCarlo, Stop, Until};
use reeldown::reliability::confidence_sequence::confidence_sequence;
use reeldown::reliability::demonstration::{Requirement, Verdict};
use reeldown::reliability::event::Event;
use reeldown::reliability::probability::Proportion;
use reeldown::sampling::{Design, Sampler};
use reeldown::streams::Purpose;

/// Seeds, and the confidence of every statement.
const SEEDS: u64 = 500;
const CONFIDENCE: f64 = 0.9;
/// Probability of a breach; in the tests of verdicts also the one that the requirement allows.
const BREACH: f64 = 0.05;
/// Wrong statements among the seeds that three standard errors above 1 − C allow:
/// 500·0.1 + 3·√(500·0.1·0.9) = 70.1.
const WRONG: u64 = 70;

/// Samples of one seed until the rule holds; `look` sees breaches and samples at every look.
fn sampled(
    seed: u64,
    until: Until,
    budget: u64,
    mut look: impl FnMut(u64, u64),
) -> AdaptiveMonteCarlo {
    let mut adaptive = AdaptiveMonteCarlo::new(1, until, CONFIDENCE, budget).expect("sound");
    let source =
        Sampler::new(Design::MonteCarlo, 1, budget, 1, seed, Purpose::Design).expect("sound");
    let mut breaches = 0;
    loop {
        let count = adaptive.next_batch().expect("sound") as usize;
        if count == 0 {
            return adaptive;
        }
        let mut margins = Columns::new(count, 1);
        source.fill(adaptive.samples(), &mut margins).expect("within the budget");
        for margin in margins.column_mut(0) {
            *margin -= BREACH;
            breaches += u64::from(*margin < 0.0);
        }
        adaptive.record(&margins).expect("one limit");
        look(breaches, adaptive.samples());
    }
}

#[test]
fn property_the_verdict_is_wrong_no_more_often_than_stated_whenever_sampling_stops() {
    // At the very limit a decision either way is an error of the confidence sequence: at most 1 − C of the
    // runs may end with one. The exact test for a fixed size, asked at the same looks, ends in far more.
    let requirement = Requirement::new(1.0 - BREACH, CONFIDENCE).expect("sound");
    let (mut decided, mut naive) = (0, 0);
    for seed in 0..SEEDS {
        let mut met = false;
        let until = Until::Decided { allowed: BREACH };
        let adaptive = sampled(seed, until, 30_000, |breaches, samples| {
            let counts = Proportion::new(breaches, 0, samples).expect("sound");
            met |= requirement.verdict(&counts).expect("sound").verdict == Verdict::Met;
        });
        decided += u64::from(adaptive.stop().expect("sound") != Some(Stop::Budget));
        naive += u64::from(met);
    }
    assert!(decided <= WRONG, "{decided} of {SEEDS} verdicts are wrong");
    assert!(naive > WRONG, "looking with a fixed-size test went unpunished: {naive} of {SEEDS}");
}

#[test]
fn property_the_interval_at_the_stop_holds_the_truth_as_often_as_stated() {
    let mut missed = 0;
    for seed in 0..SEEDS {
        let adaptive = sampled(seed, Until::RelativeError(0.15), 100_000, |_, _| {});
        assert_eq!(adaptive.stop().expect("sound"), Some(Stop::Precise));
        let estimates = adaptive.estimates().expect("sound");
        let union = estimates.iter().find(|estimate| estimate.event == Event::Any);
        let interval = union.and_then(|union| union.interval.interval()).expect("an interval");
        missed += u64::from(!interval.contains(BREACH));
    }
    assert!(missed <= WRONG, "{missed} of {SEEDS} intervals miss the truth");
}

/// The probability that the interval ever excludes the truth, looked at after every single sample: not simulated but
/// summed over all paths of the number of breaches.
#[test]
fn analytic_the_sequence_ever_excludes_the_truth_no_more_often_than_stated() {
    for (p, samples, least) in [(0.5, 4000, 0.02), (0.05, 10_000, 0.02), (0.01, 20_000, 0.01)] {
        let holds = |breaches: u64, samples: u64| {
            let counts = Proportion::new(breaches, 0, samples).expect("sound");
            let earned = confidence_sequence(counts, CONFIDENCE).expect("sound");
            earned.interval().expect("an interval").contains(p)
        };
        // Probability of each number of breaches and of no exclusion so far; numbers below `first` are excluded.
        let (mut paths, mut first, mut excluded) = (vec![1.0], 0u64, 0.0);
        for n in 1..=samples {
            let mut next = vec![0.0; paths.len() + 1];
            for (k, &path) in paths.iter().enumerate() {
                next[k] += (1.0 - p) * path;
                next[k + 1] += p * path;
            }
            while !next.is_empty() && !holds(first, n) {
                excluded += next.remove(0);
                first += 1;
            }
            while !next.is_empty() && !holds(first + next.len() as u64 - 1, n) {
                excluded += next.pop().unwrap_or(0.0);
            }
            paths = next;
        }
        // Ville's bound is for all time; what is spent by now is part of it, and not next to nothing.
        assert!(excluded <= 1.0 - CONFIDENCE && excluded > least, "{p}: {excluded}");
        println!("{p}: {excluded}");
    }
}
