//! The real program with `[sampling] until`: it ends at the same sample on any number of threads, whole or
//! resumed, and says why.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Passes a row group's end (65 536) before it stops.
const PRECISE: &str = "sampling.until={relative_error=0.012, budget=1_000_000}";

/// A directory of one test, gone with the test.
struct Place(PathBuf);

impl Place {
    fn new(name: &str) -> Place {
        let name = format!("reeldown-adaptive-{}-{name}", std::process::id());
        let place = Place(std::env::temp_dir().join(name));
        std::fs::create_dir_all(&place.0).expect("the temporary directory is writable");
        place
    }

    /// Runs the embedded study into `directory`, without what is not sampled by `until`.
    #[track_caller]
    fn run(&self, directory: &str, arguments: &[&str], code: i32) -> Value {
        let answer = Command::new(env!("CARGO_BIN_EXE_reeldown"))
            .args(["run", "--quiet", "--set", "sensitivity.base_samples=0"])
            .args(["--set", "reliability.methods=[]", "--set", "trade.samples=0"])
            .args(["--set", "model=quasi-steady", "--out"])
            .arg(self.0.join(directory))
            .args(arguments)
            .output()
            .expect("the program starts");
        let said = String::from_utf8_lossy(&answer.stderr);
        assert_eq!(answer.status.code(), Some(code), "{said}");
        let text = std::fs::read(self.0.join(directory).join("findings.json")).expect("findings");
        serde_json::from_slice(&text).expect("JSON")
    }

    #[track_caller]
    fn assert_same(&self, one: &str, other: &str) {
        for name in ["outcomes.parquet", "findings.json", "report.md"] {
            let read = |directory: &str| std::fs::read(self.0.join(directory).join(name));
            let same = read(one).expect("a file") == read(other).expect("a file");
            assert!(same, "{name} differs between {one} and {other}");
        }
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn rows(path: &Path) -> u64 {
    reeldown::store::OutcomesReader::open(path).expect("a readable table").rows()
}

#[test]
fn property_threads_and_resuming_do_not_change_where_it_ends() {
    let place = Place::new("same");
    let findings = place.run("one", &["--set", PRECISE, "--threads", "1"], 3);
    assert_eq!(findings["stopping"]["reason"], "precise");
    let samples = findings["stopping"]["samples"].as_u64().expect("a count");
    assert!((65_537..1_000_000).contains(&samples), "{samples}");
    assert_eq!(rows(&place.0.join("one/outcomes.parquet")), samples);
    place.run("three", &["--set", PRECISE, "--threads", "3"], 3);
    place.assert_same("one", "three");
    // What an interruption leaves: rows that end anywhere, here before and behind a row group's end.
    for interrupted in ["5001", "70001"] {
        place.run("parts", &["--samples", interrupted], 3);
        place.run("parts", &["--set", PRECISE, "--resume"], 3);
        place.assert_same("one", "parts");
    }
    // A run that was longer is refused: going on takes no samples away.
    place.run("longer", &["--samples", &(samples + 3000).to_string()], 3);
    let table = place.0.join("longer/outcomes.parquet");
    let before = std::fs::read(&table).expect("a table");
    place.run("longer", &["--set", PRECISE, "--resume"], 1);
    assert!(std::fs::read(&table).expect("a table") == before, "the longer table is untouched");
}

#[test]
fn property_the_findings_rest_on_the_sequence_and_say_why_it_ended() {
    let place = Place::new("reasons");
    let decided = "sampling.until={decided=true, budget=500_000}";
    let missed = place.run("missed", &["--set", decided], 3);
    let easy = ["--set", decided, "--set", "requirement.reliability=0.5"];
    let met = place.run("met", &easy, 0);
    // Five thousand samples do not tell one part in a hundred thousand, nor decide at the estimate itself.
    let estimate = 1.0 - missed["probabilities"][3]["probability"].as_f64().expect("an estimate");
    let close = format!("requirement.reliability={estimate}");
    let budget = place.run("budget", &["--set", decided, "--set", &close, "--samples", "5000"], 4);
    for (findings, reason, word, samples) in [
        (&missed, "missed", "not_met", 4096),
        (&met, "met", "met", 4096),
        (&budget, "budget", "undecided", 5000),
    ] {
        assert_eq!(findings["stopping"]["reason"], reason);
        assert_eq!(findings["stopping"]["samples"], samples);
        assert_eq!(findings["verdict"]["word"], word);
        let bounds = &findings["verdict"]["decision"]["sequence"]["bounds"];
        assert_eq!(bounds["method"], "beta-binomial confidence sequence, simultaneous");
        assert_eq!(bounds["confidence"], 0.9);
        for event in findings["probabilities"].as_array().expect("events") {
            for key in ["interval", "upper_bound"] {
                let method = event[key]["method"].as_str().expect("a method");
                assert!(method.starts_with("beta-binomial confidence sequence"), "{method}");
            }
        }
        // Order statistics at a size that was decided while looking have earned no interval.
        assert!(findings["margins"][0]["quantiles"][0]["interval"]["none"].is_string());
    }
}
