//! Small runs of the default study, computed once for all tests.

use reeldown::campaign::{self, Progress, Record};
use reeldown::findings::{self, Evidence, Findings};
use std::sync::OnceLock;

/// A run and its findings.
pub struct Sample {
    pub record: Record,
    pub findings: Findings,
}

fn unasked() -> String {
    "none was asked for".to_owned()
}

fn run(settings: &[&str]) -> Sample {
    let study = crate::habe::pinned(settings);
    let progress = Progress::default();
    let replicates = campaign::sampler(&study).unwrap().replicates();
    let mut record = Record::new(&study, replicates).unwrap();
    let mut sink = |table| {
        record.absorb(&table);
        Ok(())
    };
    campaign::run(&study, 0..study.sampling.samples, &progress, &mut sink).unwrap();
    let pick_freeze = match campaign::run_pick_freeze(&study, &progress) {
        Ok(Some(design)) => Ok(design),
        Ok(None) => Err(unasked()),
        Err(reason) => Err(reason.to_string()),
    };
    let findings = findings::gather(&Evidence {
        study: &study,
        record: &record,
        stop: None,
        rare: Vec::new(),
        nominal: campaign::nominal(&study),
        verification: campaign::verify(&study, &record).unwrap(),
        pick_freeze,
        given: campaign::given_sample::run_given(&study, &record, &progress)
            .map_err(|reason| reason.to_string())
            .and_then(|found| found.ok_or_else(unasked)),
        screening: campaign::screening::run_screening(&study, &progress)
            .map_err(|reason| reason.to_string())
            .and_then(|found| found.ok_or_else(unasked)),
        slopes: campaign::screening::slopes(&study),
        shapley: Err(unasked()),
        trade: Err(unasked()),
        calibrated: None,
        epistemic: campaign::epistemic::run_epistemic(&study, &progress)
            .expect("nested descents")
            .ok_or_else(|| "none".to_owned()),
        known: Err(unasked()),
        model_form: campaign::model_form::run_model_form(&study, &progress)
            .map_err(|reason| reason.to_string())
            .and_then(|found| found.ok_or_else(unasked)),
        exact: campaign::exact::run_exact(&study, &progress)
            .map_err(|reason| reason.to_string())
            .and_then(|found| found.ok_or_else(unasked)),
        command: "reeldown run".to_owned(),
    })
    .unwrap();
    Sample { record, findings }
}

/// Independent samples, with sensitivity indices.
pub fn independent() -> &'static Sample {
    static SAMPLE: OnceLock<Sample> = OnceLock::new();
    SAMPLE.get_or_init(|| run(&["sampling.samples=600", "sensitivity.base_samples=64"]))
}

/// A replicated design without sensitivity indices.
pub fn replicated() -> &'static Sample {
    static SAMPLE: OnceLock<Sample> = OnceLock::new();
    SAMPLE.get_or_init(|| {
        run(&[
            "sampling.design=latin-hypercube",
            "sampling.samples=400",
            "sampling.replicates=4",
            "sensitivity.base_samples=0",
        ])
    })
}
