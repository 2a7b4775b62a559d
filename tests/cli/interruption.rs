//! Ctrl-C and sudden death: what was computed stays readable, and the run goes on to the same bytes.

#![cfg(unix)]

use super::determinism::{assert_same, rows, run};
use super::program::{Answer, Place, program, reeldown};
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

/// Most samples that are tried before giving up on catching a run under way.
const MOST: u64 = 1 << 22;

/// A run that was interrupted with some of its samples computed: how many were asked for, and what the
/// program said. A run that was done before it was told to stop is tried again with more samples.
fn caught(place: &Place, directory: &str, extra: &[&str]) -> (u64, Answer) {
    let mut samples = 4096;
    while samples <= MOST {
        let answer = interrupted(place, directory, samples, extra);
        if answer.code == 130 && rows(place, directory) < samples {
            return (samples, answer);
        }
        assert!([3, 130].contains(&answer.code), "{}: {}", answer.code, answer.err);
        std::fs::remove_dir_all(place.path().join(directory)).expect("a run");
        samples *= 2;
    }
    panic!("no run could be interrupted");
}

/// Starts a run and interrupts it as soon as it has begun to write.
fn interrupted(place: &Place, directory: &str, samples: u64, extra: &[&str]) -> Answer {
    let out = place.at(directory);
    let samples = samples.to_string();
    let set = "sensitivity.base_samples=64";
    let child = program()
        .args(["run", "--quiet", "--out", &out, "--set", set, "--samples", &samples])
        .args(extra)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let begun = place.path().join(directory).join("outcomes.parquet.part");
    while !begun.exists() {
        thread::sleep(Duration::from_millis(1));
    }
    let told = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(told.expect("kill runs").success());
    Answer::of(child.wait_with_output().expect("the program ends"))
}

#[test]
fn property_an_interrupted_run_is_readable_and_goes_on_to_the_same_bytes() {
    let place = Place::new("interrupted");
    let (samples, answer) = caught(&place, "parts", &[]);
    let kept = rows(&place, "parts");
    assert!(answer.err.contains(&format!("stopped after {kept} of {samples}")), "{}", answer.err);
    assert!(answer.err.contains("--resume --out"), "{}", answer.err);
    assert_eq!(answer.out, "");
    assert_eq!(place.unfinished(), Vec::<std::path::PathBuf>::new());
    assert!(!place.path().join("parts/report.md").exists(), "there is no report on half a run");

    let samples = samples.to_string();
    let arguments = ["--samples", samples.as_str()];
    run(&place, "parts", &[&arguments[..], &["--resume"]].concat()).ended_with(3);
    run(&place, "whole", &arguments).ended_with(3);
    assert_same(&place, "whole", "parts");
}

#[test]
fn property_the_resume_command_can_be_typed_as_printed() {
    let place = Place::new("printed");
    let (samples, answer) = caught(&place, "it's here", &["--set", "model=quasi-steady"]);
    let command = answer.err.lines().find_map(|line| line.strip_prefix("to go on: reeldown "));
    let command = command.unwrap_or_else(|| panic!("no command: {}", answer.err));
    let line = format!("{} {command} --quiet", env!("CARGO_BIN_EXE_reeldown"));
    let shell = Command::new("sh").args(["-c", &line]).output().expect("sh runs");
    Answer::of(shell).ended_with(3);
    assert_eq!(rows(&place, "it's here"), samples);
}

/// Finished row groups that the journal of a run under way knows of.
fn finished_groups(place: &Place, directory: &str) -> usize {
    let path = place.path().join(directory).join("outcomes.parquet.journal.part");
    let journal = std::fs::read(path).unwrap_or_default();
    journal.iter().filter(|&&byte| byte == b'\n').count().saturating_sub(1)
}

/// Starts a run, kills it once `when` says so, and says whether it was still alive.
fn killed(place: &Place, arguments: &[&str], when: impl Fn() -> bool) -> bool {
    let out = place.at("parts");
    let set = ["--set", "sensitivity.base_samples=64"];
    let mut child = program()
        .args(["run", "--quiet", "--out", &out])
        .args(set)
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    let ended = loop {
        if child.try_wait().expect("a child").is_some() {
            break true;
        }
        if when() {
            break false;
        }
        thread::sleep(Duration::from_millis(1));
    };
    // Not a request: the process cannot see it coming.
    child.kill().expect("kill works");
    child.wait().expect("it ends");
    !ended
}

/// The samples that a run says it has read again.
fn read_again(place: &Place) -> u64 {
    let provenance: serde_json::Value =
        serde_json::from_slice(&place.bytes("parts/provenance.json")).expect("JSON");
    provenance["samples_read_again"].as_u64().expect("a number")
}

#[test]
fn regression_a_killed_run_keeps_its_finished_row_groups() {
    let place = Place::new("killed");
    let samples = (5 * 65_536 + 9).to_string();
    let arguments = ["--samples", samples.as_str()];
    let two = || finished_groups(&place, "parts") >= 2;
    assert!(killed(&place, &arguments, two), "it was to be killed after two of six row groups");
    assert!(!place.path().join("parts/outcomes.parquet").exists());
    assert!(place.path().join("parts/unfinished.json").exists());
    let resumed = run(&place, "parts", &[&arguments[..], &["--resume"]].concat()).ended_with(3);
    assert!(resumed.err.contains("of a run that ended early"), "{}", resumed.err);
    assert!(read_again(&place) >= 2 * 65_536, "{}", read_again(&place));
    run(&place, "whole", &arguments).ended_with(3);
    assert_same(&place, "whole", "parts");
    assert_eq!(place.unfinished(), Vec::<std::path::PathBuf>::new());

    // Killed at other moments, again and again, on its way from the same table to a longer one: never less than
    // before, and the same bytes in the end.
    let longer = (7 * 65_536).to_string();
    let longer = ["--samples", longer.as_str(), "--resume"];
    for delay in [0, 5, 20, 50, 100, 200, 400] {
        let begun = std::time::Instant::now();
        killed(&place, &longer, || begun.elapsed() >= Duration::from_millis(delay));
        assert!(rows(&place, "parts") >= 5 * 65_536 + 9, "after {delay} ms");
    }
    run(&place, "parts", &longer).ended_with(3);
    assert!(read_again(&place) >= 5 * 65_536 + 9, "{}", read_again(&place));
    run(&place, "whole", &longer[..2]).ended_with(3);
    assert_same(&place, "whole", "parts");
    assert_eq!(place.unfinished(), Vec::<std::path::PathBuf>::new());
    assert!(!place.path().join("parts/unfinished.json").exists());
}

#[test]
fn regression_without_resume_what_a_killed_run_left_is_removed() {
    let place = Place::new("killed-anew");
    let samples = (4 * 65_536).to_string();
    let one = || finished_groups(&place, "parts") >= 1;
    assert!(killed(&place, &["--samples", &samples], one));
    let answer = run(&place, "parts", &["--samples", "400", "--seed", "5"]).ended_with(3);
    assert!(answer.err.contains("--resume would have kept them"), "{}", answer.err);
    assert_eq!(place.unfinished(), Vec::<std::path::PathBuf>::new());
    run(&place, "whole", &["--samples", "400", "--seed", "5"]).ended_with(3);
    assert_same(&place, "whole", "parts");
}

#[test]
fn property_a_run_goes_on_when_only_what_is_asked_of_its_samples_changes() {
    let place = Place::new("asked");
    let out = place.at("run");
    let few = ["run", "--quiet", "--samples", "300", "--out", &out, "--set", "model=quasi-steady"];
    let first = ["--set", "sensitivity.base_samples=0", "--set", "trade.samples=0"];
    reeldown(&[&few[..], &first].concat()).ended_with(3);
    let other = [
        "sensitivity.base_samples=32",
        "sensitivity.pairs=[[\"fluid.shear_factor\", \"brake.gap\"]]",
        "trade.samples=200",
        "tighten.target=0.05",
        "tighten.samples=500",
        "tighten.design={\"fluid.nominal_viscosity\" = [\"90000 cSt\", \"140000 cSt\"]}",
        "fluid.shear_factor.cost=3",
        "initial.temperature.cost=[{spread=0.3, cost=40}]",
        "fluid.shear_factor.known=on the day",
        "requirement.reliability=0.9",
    ];
    let other: Vec<&str> = other.iter().flat_map(|text| ["--set", text]).collect();
    reeldown(&[&few[..], &["--resume"], &other].concat()).ended_with(3);
    let text = place.bytes("run/provenance.json");
    let provenance: serde_json::Value = serde_json::from_slice(&text).expect("JSON");
    assert_eq!(provenance["samples_read_again"], 300, "{provenance}");
    // What moves a sample does stop it.
    let moved = [&few[..], &["--resume", "--set", "fluid.nominal_viscosity=120000 cSt"]].concat();
    let answer = reeldown(&moved).ended_with(1);
    assert!(answer.err.contains("another study"), "{}", answer.err);
}
