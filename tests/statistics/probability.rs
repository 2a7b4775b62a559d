//! Intervals of a breach probability against SciPy's numbers and by exact enumeration.

use reeldown::numerics::interval::Earned;
use reeldown::reliability::breach_counts::BreachCounts;
use reeldown::reliability::probability::Proportion;

fn counts(breaches: u64, faults: u64, samples: u64) -> Proportion {
    Proportion::new(breaches, faults, samples).unwrap()
}

fn ends(earned: reeldown::error::Result<Earned>) -> (f64, f64) {
    let earned = earned.unwrap();
    let interval = earned.interval().unwrap();
    (interval.lower, interval.upper)
}

/// Breaches, samples; Clopper–Pearson, Wilson and Jeffreys at 95 %; one-sided upper bounds at 95 and
/// 90 %. From SciPy's `beta.ppf` and the closed form of Wilson's interval; the ends that are 0 by
/// convention are 0 here.
type Row = (u64, u64, [f64; 2], [f64; 2], [f64; 2], f64, f64);
const SCIPY: [Row; 8] = [
    (
        0,
        10,
        [0.0, 0.3084971078187607],
        [0.0, 0.2775327998628892],
        [0.0, 0.21719626750921053],
        0.2588655508930522,
        0.2056717652757185,
    ),
    (
        0,
        100,
        [0.0, 0.03621669264517641],
        [0.0, 0.03699349820698568],
        [0.0, 0.02474527001526989],
        0.029513049607039925,
        0.02276277904418932,
    ),
    (
        0,
        1000,
        [0.0, 0.003682083896865671],
        [0.0, 0.0038267584855551234],
        [0.0, 0.0025081643414222978],
        0.002991249545095295,
        0.002299936177446683,
    ),
    (
        1,
        100,
        [0.00025314603297742064, 0.054459385392080645],
        [0.0017674320641406505, 0.054486196178705315],
        [0.0010811017090800639, 0.04577889660072311],
        0.046559811453538935,
        0.03833949749538697,
    ),
    (
        2,
        2000,
        [0.00012112759055682972, 0.0036076285698285315],
        [0.0002742789176520344, 0.003638934269038394],
        [0.00020785926569046482, 0.003204185101432733],
        0.0031445178378896837,
        0.0026589506441740485,
    ),
    (
        5,
        1000,
        [0.00162541951756276, 0.011629470559812147],
        [0.0021375355273244596, 0.011650955373375113],
        [0.0019103525008339467, 0.01092466407181425],
        0.010484076911415651,
        0.009254858093067034,
    ),
    (
        10,
        1000,
        [0.004805510691049308, 0.01831324305511245],
        [0.005440754445529249, 0.018309468870314774],
        [0.005152700745321492, 0.017666397310717785],
        0.016903175120562504,
        0.015364975604890663,
    ),
    (
        50,
        100,
        [0.39832112950330095, 0.601678870496699],
        [0.4038315303659956, 0.5961684696340044],
        [0.40317395089641805, 0.596826049103582],
        0.5863782853690882,
        0.5685831744062192,
    ),
];

#[test]
fn reference_scipy_binomial_intervals() {
    // SciPy's quantiles and ours each hold 1e-12 relative; the sum of both is the tolerance.
    let close = |a: f64, b: f64| (a - b).abs() <= 2e-12 * b.abs();
    for (m, n, exact, score, bayes, upper_95, upper_90) in SCIPY {
        let proportion = counts(m, 0, n);
        let found = [
            ends(proportion.interval(0.95)),
            ends(proportion.wilson(0.95)),
            ends(proportion.jeffreys(0.95)),
        ];
        for ((lower, upper), expected) in found.into_iter().zip([exact, score, bayes]) {
            assert!(close(lower, expected[0]), "{m}/{n}: {lower} {}", expected[0]);
            assert!(close(upper, expected[1]), "{m}/{n}: {upper} {}", expected[1]);
        }
        assert!(close(ends(proportion.upper_bound(0.95)).1, upper_95));
        assert!(close(ends(proportion.upper_bound(0.90)).1, upper_90));
        // By symmetry the lower bound of the complement.
        let complement = ends(counts(n - m, 0, n).lower_bound(0.95)).0;
        assert!((complement - (1.0 - upper_95)).abs() < 1e-13);
    }
}

#[test]
fn analytic_exact_ends_have_the_stated_tails() {
    // The definition: at the upper end, seeing this few or fewer has probability (1 − C)/2.
    for (m, n) in [(1u64, 7u64), (3, 50), (40, 41), (1000, 1_000_000), (999_998, 1_000_000)] {
        let (lower, upper) = ends(counts(m, 0, n).interval(0.9));
        let below = reeldown::reliability::binomial_tails::at_most(m, n, upper);
        let above = reeldown::reliability::binomial_tails::at_least(m, n, lower);
        // A relative error of 1e-12 in the end moves the tail by about n·p·1e-12 relative at most.
        assert!(
            (below - 0.05).abs() < 1e-9 && (above - 0.05).abs() < 1e-9,
            "{m}/{n}: {below} {above}"
        );
    }
}

#[test]
fn analytic_clopper_pearson_covers_at_least_as_stated() {
    // Coverage is a finite sum over the counts: exact, no simulation.
    let (n, confidence) = (40u64, 0.9);
    let intervals: Vec<(f64, f64)> =
        (0..=n).map(|m| ends(counts(m, 0, n).interval(confidence))).collect();
    for step in 1..200 {
        let p = step as f64 / 200.0;
        let mut mass = (1.0 - p).powi(n as i32);
        let mut covered = 0.0;
        for m in 0..=n {
            let (lower, upper) = intervals[m as usize];
            if lower <= p && p <= upper {
                covered += mass;
            }
            mass *= (n - m) as f64 / (m + 1) as f64 * p / (1.0 - p);
        }
        assert!(covered >= confidence - 1e-12, "{p}: {covered}");
    }
}

#[test]
fn property_intervals_hold_whatever_faults_would_have_been() {
    let (m, f, n) = (3u64, 4u64, 60u64);
    let whole = counts(m, f, n);
    assert_eq!(whole.fault_bounds(), Some((3.0 / 60.0, 7.0 / 60.0)));
    assert_eq!(whole.estimate(), Some(3.0 / 56.0));
    let outer = [ends(whole.interval(0.95)), ends(whole.wilson(0.95)), ends(whole.jeffreys(0.95))];
    for breached in m..=m + f {
        let clean = counts(breached, 0, n);
        let inner =
            [ends(clean.interval(0.95)), ends(clean.wilson(0.95)), ends(clean.jeffreys(0.95))];
        for (outer, inner) in outer.iter().zip(inner) {
            assert!(outer.0 <= inner.0 && inner.1 <= outer.1);
        }
    }
    let bound = ends(whole.upper_bound(0.95)).1;
    assert_eq!(bound, ends(counts(7, 0, n).upper_bound(0.95)).1);
    let all_faulted = counts(0, 5, 5);
    assert_eq!((all_faulted.estimate(), ends(all_faulted.interval(0.9))), (None, (0.0, 1.0)));
}

#[test]
fn analytic_clean_samples_needed() {
    // ln 0.1 / ln 0.99 = 229.1: 230 clean samples show P ≤ 1 % at 90 %; 388 with one breach.
    assert_eq!(counts(0, 0, 100).clean_samples_needed(0.01, 0.9).unwrap(), 130);
    assert_eq!(counts(1, 0, 100).clean_samples_needed(0.01, 0.9).unwrap(), 288);
    assert_eq!(counts(0, 1, 100).clean_samples_needed(0.01, 0.9).unwrap(), 288);
    assert_eq!(counts(0, 0, 230).clean_samples_needed(0.01, 0.9).unwrap(), 0);
    assert!(counts(0, 0, 1).clean_samples_needed(0.0, 0.9).is_err());
}

#[test]
fn property_wrong_arguments_are_refused_and_no_sample_earns_nothing() {
    assert!(Proportion::new(3, 3, 5).is_err());
    assert!(Proportion::new(u64::MAX, 1, 5).is_err());
    for confidence in [0.0, 1.0, -0.5, f64::NAN] {
        assert!(counts(1, 0, 5).interval(confidence).is_err());
        assert!(counts(1, 0, 5).upper_bound(confidence).is_err());
    }
    let nothing = counts(0, 0, 0);
    assert_eq!((nothing.estimate(), nothing.fault_bounds()), (None, None));
    assert!(nothing.interval(0.9).unwrap().why_none().is_some());
}

#[test]
fn property_joint_counts_do_not_depend_on_chunks() {
    // A fixed pattern over all masks of four limits with a fault now and then.
    let push = |counts: &mut BreachCounts, k: u32| match k % 11 {
        10 => counts.push_fault(),
        7 => counts.push_partly(k & 0b11, 0b1000),
        _ => counts.push(k.wrapping_mul(2_654_435_761) >> 28),
    };
    let mut whole = BreachCounts::new(4).unwrap();
    (0..1000).for_each(|k| push(&mut whole, k));
    for chunk in [1u32, 7, 64, 999] {
        let mut merged = BreachCounts::new(4).unwrap();
        let mut first = 0;
        while first < 1000 {
            let mut part = BreachCounts::new(4).unwrap();
            (first..(first + chunk).min(1000)).for_each(|k| push(&mut part, k));
            merged.merge(&part).unwrap();
            first += chunk;
        }
        assert_eq!(merged, whole);
    }
    assert!(whole.merge(&BreachCounts::new(3).unwrap()).is_err());
    // Any is at least each, and a pair at most either of its two.
    for i in 0..4 {
        assert!(whole.constraint(i).unwrap().breaches <= whole.any().breaches);
        for j in i + 1..4 {
            let pair = whole.pair(i, j).unwrap();
            assert!(pair.breaches <= whole.constraint(i).unwrap().breaches);
            assert!(pair.most_breaches() <= whole.constraint(j).unwrap().most_breaches());
        }
    }
}

#[test]
fn property_margins_are_counted_like_masks() {
    let time = [1.0, -0.5, f64::NAN, 0.0];
    let heat = [-1.0, -2.0, f64::NAN, 3.0];
    let mut counts = BreachCounts::new(2).unwrap();
    counts.push_margins(&[&time, &heat]).unwrap();
    let mut masks = BreachCounts::new(2).unwrap();
    masks.push(0b10);
    masks.push(0b11);
    masks.push_fault();
    masks.push(0);
    assert_eq!(counts, masks);
    assert!(counts.push_margins(&[&time]).is_err());
    assert!(counts.push_margins(&[&time, &heat[..2]]).is_err());
}
