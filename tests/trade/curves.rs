//! The trade of the HABE study against independent reruns.

use reeldown::analysis::Sampling;
use reeldown::campaign::common_numbers::{Breaches, Change, CommonSample, Event};
use reeldown::campaign::trade::{design_value_anew, run_trade, trade_factors};
use reeldown::campaign::{Progress, Record};
use reeldown::streams::Purpose;
use reeldown::study::Study;

/// The pinned study, quasi-steady, with few samples.
pub fn study(set: &[&str]) -> Study {
    let few = ["model=quasi-steady", "sampling.samples=20000", "trade.samples=4000"];
    crate::habe::pinned(&[&few[..], set].concat())
}

pub fn recorded(study: &Study) -> Record {
    Sampling::of(study, &Progress::default()).expect("a run").record
}

fn share(breaches: &Breaches) -> f64 {
    breaches.count(Event::Any).estimate().expect("an estimate")
}

#[test]
fn property_curves_agree_with_independent_reruns() {
    let study = study(&[]);
    let progress = Progress::default();
    let record = recorded(&study);
    let trade = run_trade(&study, &record, &progress).expect("a trade").expect("a trade");
    let base = share(&trade.base);
    // A rerun of its own for the two factors that matter and the gaps, by points the trade never saw.
    let independent = CommonSample::independent(&study, 0..4000, Purpose::Test).expect("a sample");
    let mut checked = 0;
    for curve in &trade.curves {
        let name = &trade.factors[curve.factor].name;
        if !["brake.gap", "fluid.shear_factor", "initial.temperature"].contains(&name.as_str()) {
            continue;
        }
        for setting in &curve.settings {
            let change = Change { marginals: setting.marginals.clone(), ..Change::default() };
            let again = share(&independent.changed(&change, &progress).expect("a rerun"));
            let here = share(&setting.breaches);
            // Two independent shares of 4000: 4.5 standard errors each, about 1 in 10⁵ for 30 settings.
            let p = 0.5 * (again + here);
            let allowed = 4.5 * (2.0 * p * (1.0 - p) / 4000.0).sqrt();
            assert!((again - here).abs() <= allowed, "{name} {}: {here} {again}", setting.value);
            checked += 1;
        }
    }
    assert_eq!(checked, 30);
    assert!(
        (0.35..0.45).contains(&base),
        "the paper's case misses about four times in ten: {base}"
    );
}

#[test]
fn property_the_base_of_the_trade_is_the_run() {
    let study = study(&["sampling.samples=4000"]);
    let record = recorded(&study);
    let progress = Progress::default();
    let sample = CommonSample::of_run(&study, 4000).expect("a sample");
    let base = sample.base(&progress).expect("breaches");
    let of_run = Breaches::from_margins(study.limits.len(), 4000, |i, k| record.margins(i)[k]);
    assert_eq!(base, of_run);
    // Nothing is changed by a spread factor of one.
    for factor in trade_factors(&study) {
        let same = Change::spread(&study, &factor.columns, 1.0).expect("a change");
        let again = sample.changed(&same, &progress).expect("breaches");
        let counts = again.against(&base, Event::Any, 0..4000);
        // The factor passes through mean + 1·(x − mean) and its rounding.
        assert!(counts.gained + counts.lost <= 1, "{}: {counts:?}", factor.name);
    }
}

#[test]
fn property_score_sums_of_the_study_agree_with_central_differences() {
    let study = study(&[]);
    let record = recorded(&study);
    let trade = run_trade(&study, &record, &Progress::default()).expect("a trade").expect("one");
    let any = study.limits.len();
    let mut compared = 0;
    for difference in &trade.differences {
        let scores = trade.scores.iter().find(|scores| {
            scores.factor == difference.factor && scores.parameter == difference.parameter
        });
        let sums = scores.expect("scores").sums.as_ref().expect("sums");
        let score = sums[any].derivative(0.95).expect("a derivative").derivative;
        let (below, above) = &difference.breaches;
        let paired = above.against(below, Event::Any, 0..above.rows());
        let paired = paired.difference(0.95).expect("a difference");
        let scale = 1.0 / (2.0 * difference.step);
        let (a, b) = (score.value.expect("a"), paired.value.expect("b") * scale);
        let error_a = score.standard_error.expect("an error");
        let error_b = paired.standard_error.expect("an error") * scale;
        // 4.5 standard errors of independent estimates would be 1 in 10⁵; these share their points.
        let allowed = 4.5 * (error_a * error_a + error_b * error_b).sqrt();
        assert!((a - b).abs() <= allowed, "{difference:?}: {a} ± {error_a}, {b} ± {error_b}");
        compared += 1;
    }
    assert_eq!(compared, 6);
}

#[test]
fn property_a_replicated_design_has_a_trade_too() {
    let study = study(&["sampling.design=sobol", "sampling.samples=4096", "trade.samples=1024"]);
    let record = recorded(&study);
    let trade = run_trade(&study, &record, &Progress::default()).expect("a trade").expect("one");
    assert_eq!(trade.replicates, 16);
    assert_eq!(trade.base.rows(), 1024);
}

#[test]
fn property_the_size_of_a_trade_does_not_follow_where_an_adaptive_run_stopped() {
    let until = "sampling.until={relative_error=0.2, budget=20000}";
    let adaptive = study(&[until, "trade.samples=8000"]);
    let progress = Progress::default();
    let record = recorded(&adaptive);
    let stopped = record.counts().samples();
    assert!(stopped < 8000, "stopped at {stopped}: it does not stop below the trade's sample");
    let trade = run_trade(&adaptive, &record, &progress).expect("a trade").expect("a trade");
    assert_eq!(
        (trade.base.rows(), trade.headline_base.rows(), trade.score_samples),
        (8000, 8000, 8000)
    );
    // The same points as those of a run of fixed size.
    let fixed = study(&["sampling.samples=8000", "trade.samples=8000"]);
    let whole = CommonSample::of_run(&fixed, 8000).expect("a sample");
    assert_eq!(trade.base, whole.base(&progress).expect("breaches"));
}

#[test]
fn property_a_design_value_agrees_with_independent_reruns() {
    let study = study(&[]);
    let progress = Progress::default();
    let trade = run_trade(&study, &recorded(&study), &progress).expect("a trade").expect("one");
    let [sweep] = &trade.sweeps[..] else { panic!("the viscosity may move") };
    let independent = CommonSample::independent(&study, 0..4000, Purpose::Test).expect("a sample");
    for setting in sweep.coarse.iter().step_by(3).chain(sweep.fine.iter().step_by(4)) {
        let change = Change::default().and_design(sweep.range.target, setting.value);
        let again = share(&independent.changed(&change, &progress).expect("a rerun"));
        let here = share(&setting.breaches);
        let p = (0.5 * (again + here)).clamp(1e-3, 1.0 - 1e-3);
        // As for the curves: 4.5 standard errors of two independent shares of 4000.
        let allowed = 4.5 * (2.0 * p * (1.0 - p) / 4000.0).sqrt();
        assert!((again - here).abs() <= allowed, "{}: {here} {again}", setting.value);
    }
}

/// The study's own points chose the value; others say what P is there. Two such estimates from independent points.
#[test]
fn property_p_at_the_best_design_value_is_of_points_that_the_search_has_not_seen() {
    let study = study(&[]);
    let target = study.tighten.design[0].target;
    let quantity = target.parameter.info().quantity;
    let value = reeldown::units::parse("101600 cSt", quantity).expect("a viscosity");
    let (base, there) = design_value_anew(&study, target, value, 4000).expect("a rerun");
    let run = CommonSample::of_run(&study, 4000).expect("the run's points");
    let progress = Progress::default();
    let searched = run.base(&progress).expect("a rerun");
    let change = Change::default().and_design(target, value);
    let at_value = run.changed(&change, &progress).expect("a rerun");
    for (fresh, searched) in [(&base, &searched), (&there, &at_value)] {
        let (p, q) = (share(fresh), share(searched));
        assert!(p != q, "{p}: the same points");
        let mean = 0.5 * (p + q);
        assert!((p - q).abs() < 4.5 * (2.0 * mean * (1.0 - mean) / 4000.0).sqrt(), "{p} {q}");
    }
    assert!(share(&there) < 0.3 * share(&base));
}
