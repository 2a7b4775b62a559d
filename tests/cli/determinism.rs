//! The same study gives the same bytes: on any number of threads, whole or in two parts.

use super::program::{Answer, Place, reeldown};
use reeldown::store::OutcomesReader;
use std::path::Path;

/// Samples of the whole run; more than a row group, so that its groups matter.
pub const WHOLE: &str = "100000";
/// Samples of a run to be continued; inside the second row group.
pub const SHORTER: &str = "70001";

/// What must not differ. `provenance.json` holds what may.
pub const SAME: [&str; 4] =
    ["findings.json", "report.md", "outcomes.parquet", "sensitivity.parquet"];

/// Runs the embedded study, with a small pick-freeze design, into a directory of `place`.
pub fn run(place: &Place, directory: &str, arguments: &[&str]) -> Answer {
    let out = place.at(directory);
    let fixed = ["run", "--quiet", "--out", &out, "--set", "sensitivity.base_samples=64"];
    reeldown(&[&fixed, arguments].concat())
}

/// Asserts that two directories hold the same bytes.
#[track_caller]
pub fn assert_same(place: &Place, one: &str, other: &str) {
    for name in SAME {
        let [a, b] = [one, other].map(|directory| place.bytes(&format!("{directory}/{name}")));
        assert!(a == b, "{name} differs between {one} and {other}");
    }
}

/// Number of samples in a run's table.
pub fn rows(place: &Place, directory: &str) -> u64 {
    let path = place.at(&format!("{directory}/outcomes.parquet"));
    OutcomesReader::open(Path::new(&path)).expect("a readable table").rows()
}

#[test]
fn property_threads_and_resuming_do_not_change_a_byte() {
    let place = Place::new("determinism");
    run(&place, "one", &["--samples", WHOLE, "--threads", "1"]).ended_with(3);
    for threads in ["2", "5"] {
        run(&place, threads, &["--samples", WHOLE, "--threads", threads]).ended_with(3);
        assert_same(&place, "one", threads);
    }
    run(&place, "parts", &["--samples", SHORTER]).ended_with(3);
    assert_eq!(rows(&place, "parts").to_string(), SHORTER);
    run(&place, "parts", &["--samples", WHOLE, "--resume"]).ended_with(3);
    assert_same(&place, "one", "parts");
    let provenance = place.bytes("parts/provenance.json");
    let provenance: serde_json::Value = serde_json::from_slice(&provenance).expect("JSON");
    assert_eq!(provenance["samples_read_again"].to_string(), SHORTER, "they were kept");
    // Going on never takes samples away: a shorter run is refused, and the table stays.
    let refused = run(&place, "parts", &["--samples", SHORTER, "--resume"]).ended_with(1);
    for text in [&format!("it has {WHOLE} samples"), &format!("--samples {WHOLE} or more"), "--out"]
    {
        assert!(refused.err.contains(text), "{text}: {}", refused.err);
    }
    assert_same(&place, "one", "parts");
    assert_eq!(place.unfinished(), Vec::<std::path::PathBuf>::new());
}

#[test]
fn property_every_design_resumes_or_says_why_not() {
    let place = Place::new("designs");
    for design in ["sobol", "halton", "latin-hypercube"] {
        let chosen = format!("sampling.design={design}");
        let with = |samples: &'static str| ["--set", chosen.as_str(), "--samples", samples];
        run(&place, "whole", &with("512")).ended_with(3);
        run(&place, design, &with("256"));
        let resumed = run(&place, design, &[&with("512")[..], &["--resume"]].concat());
        if design == "latin-hypercube" {
            // Its strata depend on the number of samples: the shorter run is no part of the longer.
            let resumed = resumed.ended_with(1);
            assert!(resumed.err.contains("cannot resume"), "{}", resumed.err);
        } else {
            resumed.ended_with(3);
            assert_same(&place, "whole", design);
        }
    }
}

#[test]
fn property_another_seed_gives_another_answer_and_cannot_be_resumed() {
    let place = Place::new("seed");
    run(&place, "a", &["--samples", "200", "--seed", "1"]).ended_with(3);
    run(&place, "b", &["--samples", "200", "--seed", "2"]).ended_with(3);
    assert_ne!(place.bytes("a/outcomes.parquet"), place.bytes("b/outcomes.parquet"));
    let before = place.bytes("a/outcomes.parquet");
    let answer = run(&place, "a", &["--samples", "200", "--seed", "2", "--resume"]).ended_with(1);
    assert!(answer.err.contains("another study, seed or version"), "{}", answer.err);
    assert_eq!(place.bytes("a/outcomes.parquet"), before, "the other run is untouched");
    assert_eq!(place.unfinished(), Vec::<std::path::PathBuf>::new());
}

#[test]
fn property_resuming_where_nothing_is_starts_from_the_first_sample() {
    let place = Place::new("fresh");
    run(&place, "whole", &["--samples", "300"]).ended_with(3);
    let answer = run(&place, "fresh", &["--samples", "300", "--resume"]).ended_with(3);
    assert!(answer.err.contains("starting from the first sample"), "{}", answer.err);
    assert_same(&place, "whole", "fresh");
}
