//! Ctrl-C: what was computed stays readable, and the run goes on to the same bytes.

#![cfg(unix)]

use super::determinism::{assert_same, rows, run};
use super::program::{Answer, Place, program};
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
