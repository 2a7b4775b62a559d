//! What a verdict becomes under numerical errors that were measured: of 600 samples of the study in `tests/fixtures/habe`.

use super::*;
use crate::campaign::{self, NearLimit, Progress};
use crate::descent::OutcomeQuantity;
use crate::study::Override;

const SAMPLES: u64 = 600;

fn sampled(reliability: &str) -> (Study, Record) {
    let settings = ["sampling.samples=600", reliability, "requirement.confidence=0.9"];
    let overrides: Vec<Override> =
        settings.iter().map(|text| Override::parse("--set", text).expect("a setting")).collect();
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/habe/study.toml");
    let study = Study::load(Some(path.as_ref()), &overrides).expect("the pinned study");
    let mut record = Record::new(&study, 1).expect("a record");
    let mut sink = |table| {
        record.absorb(&table);
        Ok(())
    };
    campaign::run(&study, 0..SAMPLES, &Progress::default(), &mut sink).expect("samples");
    (study, record)
}

fn verified(study: &Study, error: f64, near: NearLimit) -> Verification {
    Verification {
        limits: vec![near; study.limits.len()],
        measured: 300,
        first: 256,
        worst: OutcomeQuantity::ALL.map(|quantity| (quantity, error)).to_vec(),
    }
}

const NONE_NEAR: NearLimit = NearLimit {
    share: 1e-4,
    near: 0,
    recomputed: 0,
    breach_to_clean: 0,
    clean_to_breach: 0,
    untried: (0, 0),
};

fn heeded(
    study: &Study,
    record: &Record,
    verification: &Verification,
) -> (VerdictFinding, NumericalFinding) {
    let probabilities =
        super::super::probabilities::probabilities(study, record).expect("probabilities");
    let verdict =
        super::super::demonstration::verdict(study, record, &probabilities).expect("a verdict");
    let mut finding = numerical(study, record, verification);
    let verdict = heed(study, record, verification, &mut finding, verdict).expect("a verdict");
    (verdict, finding)
}

#[test]
fn property_an_error_above_the_promise_withdraws_the_verdict() {
    // 41 % breach: a reliability of 0.5 is demonstrated, 0.9 is refuted.
    for (reliability, word) in [
        ("requirement.reliability=0.5", VerdictWord::Met),
        ("requirement.reliability=0.9", VerdictWord::NotMet),
    ] {
        let (study, record) = sampled(reliability);
        // At 1e-6: thirty and a hundred times that are promised.
        let (verdict, finding) = heeded(&study, &record, &verified(&study, 2e-5, NONE_NEAR));
        assert_eq!(verdict.word, word);
        assert_eq!(finding.withdrawn, None);
        let (verdict, finding) = heeded(&study, &record, &verified(&study, 2.2e-3, NONE_NEAR));
        assert_eq!(verdict.word, VerdictWord::Undecided);
        assert!(verdict.statement.contains("cannot be trusted"), "{}", verdict.statement);
        assert!(finding.withdrawn.is_some_and(|reason| reason.contains("2.2e-3")));
    }
}

#[test]
fn property_samples_that_may_flip_withdraw_the_verdict_that_they_decide() {
    let (study, record) = sampled("requirement.reliability=0.9");
    let breaches = record.counts().any().breaches;
    // All of the nearest 200 flip, and so may the rest: nothing is left of the refutation.
    let flips = NearLimit {
        near: breaches as usize,
        recomputed: 200,
        breach_to_clean: 200,
        untried: (breaches - 200, 0),
        ..NONE_NEAR
    };
    let (verdict, finding) = heeded(&study, &record, &verified(&study, 1e-7, flips));
    assert_eq!(verdict.word, VerdictWord::Undecided);
    assert_eq!(finding.limits[0].band.map(|band| band.0), Some(0.0));
    // Two that flip of some 250 leave 41 % what they are.
    let few = NearLimit { near: 2, recomputed: 2, breach_to_clean: 2, ..NONE_NEAR };
    let (verdict, _) = heeded(&study, &record, &verified(&study, 1e-7, few));
    assert_eq!(verdict.word, VerdictWord::NotMet);
}

/// The rows that are looked at hold the extremes of the run, and the band near a limit follows the worst error.
#[test]
fn property_verification_looks_at_the_extremes() {
    let (study, record) = sampled("requirement.reliability=0.9");
    let extremes = record.extreme_samples();
    // Sixteen of each outcome, of which many are the same samples.
    assert!(extremes.len() > 16, "{}", extremes.len());
    for (i, limit) in study.limits.iter().enumerate() {
        let margins = record.margins(i);
        let worst = (0..margins.len()).min_by(|&a, &b| margins[a].total_cmp(&margins[b]));
        let largest = limit.outcome != OutcomeQuantity::Time;
        assert!(!largest || extremes.contains(&(worst.expect("a sample") as u64)), "{limit:?}");
    }
    let verification = campaign::verify(&study, &record).expect("a verification");
    let beyond = extremes.iter().filter(|&&sample| sample >= 256).count();
    assert_eq!(verification.first, 256);
    assert_eq!(verification.measured, 256 + beyond);
    for (limit, near) in study.limits.iter().zip(&verification.limits) {
        let error = verification.worst[limit.outcome as usize].1;
        assert_eq!(near.share, (3.0 * error).max(1e-4));
    }
}
