//! What a run leaves behind: the report in its order, and every artefact with its parents.

use super::determinism::run;
use super::program::{Answer, Place, reeldown};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::path::Path;
use std::process::Command;

fn findings(place: &Place, directory: &str) -> Value {
    serde_json::from_slice(&place.bytes(&format!("{directory}/findings.json"))).expect("JSON")
}

#[test]
fn property_the_report_begins_with_the_verdict_and_ends_with_how_to_reproduce_it() {
    let place = Place::new("report");
    run(&place, "run", &["--samples", "1000"]).ended_with(3);
    let report = String::from_utf8(place.bytes("run/report.md")).expect("UTF-8");
    // Verdict, probabilities, margins, drivers, samples apart, inputs, method, reproduction.
    let order = [
        "**NOT MET.**",
        "## How probable",
        "## What margin",
        "## What drives",
        "## Failed and non-deployed samples",
        "## What is uncertain",
        "## Method and caveats",
        "## To reproduce",
    ];
    let places: Vec<usize> = order
        .iter()
        .map(|part| report.find(part).unwrap_or_else(|| panic!("no {part:?} in\n{report}")))
        .collect();
    assert!(places.is_sorted(), "{places:?}");
    let digest = findings(&place, "run")["reproduction"]["study_digest"].clone();
    assert!(report.contains(digest.as_str().expect("a digest")), "the report names the study");
    assert!(report.contains("assumed"), "the inputs are shown with their sources");
    for word in ["NaN", "inf ", "None", "Some("] {
        assert!(!report.contains(word), "{word:?} in\n{report}");
    }
}

#[test]
fn property_the_command_in_the_report_gives_the_same_bytes() {
    let place = Place::new("command");
    let set = "fluid.nominal_viscosity=\"100000 cSt\"";
    run(&place, "run", &["--samples", "400", "--seed", "7", "--set", set]);
    let findings = findings(&place, "run");
    let command = findings["reproduction"]["command"].as_str().expect("a command");
    let words = command.strip_prefix("reeldown ").expect("the program's name");
    let line = format!("{} {words} --quiet --out {}", env!("CARGO_BIN_EXE_reeldown"), "again");
    let shell = Command::new("sh").args(["-c", &line]).current_dir(place.path()).output();
    let again = Answer::of(shell.expect("sh runs"));
    assert_eq!(again.err, "");
    super::determinism::assert_same(&place, "run", "again");
}

#[test]
fn property_every_artefact_names_its_parents() {
    let place = Place::new("parents");
    let card = include_str!("../fixtures/habe/card.toml");
    place.write("card.toml", card);
    let text = "title = \"parents\"\ncard = \"card.toml\"\n[limits]\ntime = { max = \"210 s\" }\n";
    let study = place.write("study.toml", text);
    run(&place, "run", &[&study, "--samples", "300", "--seed", "5"]).ended_with(0);
    let check = ["check", "--json", &study, "--set", "sampling.samples=300"];
    let set = ["--set", "sampling.seed=5", "--set", "sensitivity.base_samples=64"];
    let checked = reeldown(&[&check[..], &set].concat()).ended_with(0).json();
    let digest = checked["study_digest"].as_str().expect("a digest");

    let findings = findings(&place, "run");
    let reproduction = &findings["reproduction"];
    assert_eq!(reproduction["study_digest"], digest);
    assert_eq!(reproduction["seed"], 5);
    assert_eq!(reproduction["version"], env!("CARGO_PKG_VERSION"));
    let sha = |text: &str| -> String {
        Sha256::digest(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect()
    };
    let files = reproduction["files"].as_array().expect("files");
    let digests: Vec<&str> = files.iter().filter_map(|file| file[1].as_str()).collect();
    assert_eq!(digests, [sha(text), sha(card)], "of the very bytes of study and card");

    let footer = |name: &str| {
        let path = place.path().join("run").join(name);
        let reader = reeldown::store::OutcomesReader::open(Path::new(&path)).expect("a footer");
        reader.parentage().0.clone()
    };
    for name in ["outcomes.parquet", "sensitivity.parquet"] {
        let footer = footer(name);
        assert_eq!(footer["study_digest"], digest, "{name}");
        assert_eq!(footer["seed"], "5", "{name}");
        assert_eq!(footer["version"], env!("CARGO_PKG_VERSION"), "{name}");
        let units: Value = serde_json::from_str(&footer["units"]).expect("JSON");
        assert_eq!(units["time_s"], "s", "{name}");
        assert_eq!(units["brake_gap_1_m"], "m", "{name}");
        assert!(footer["texts"].contains("brake.gap"), "{name} holds the card's text");
    }
    let provenance: Value =
        serde_json::from_slice(&place.bytes("run/provenance.json")).expect("JSON");
    assert_eq!(provenance["study_digest"], digest);
    assert_eq!(provenance["samples_computed"], 300);
}

#[test]
fn property_nothing_that_may_differ_is_in_what_must_not() {
    let place = Place::new("elsewhere");
    run(&place, "first", &["--samples", "200"]);
    run(&place, "second/deeper", &["--samples", "200", "--threads", "3"]);
    super::determinism::assert_same(&place, "first", "second/deeper");
    let directory = place.at("");
    for name in ["findings.json", "report.md"] {
        let text = String::from_utf8(place.bytes(&format!("first/{name}"))).expect("UTF-8");
        assert!(!text.contains(directory.trim_end_matches('/')), "{name} names a directory");
    }
}

#[test]
fn property_the_tables_on_the_terminal_are_aligned() {
    let place = Place::new("aligned");
    let out = place.at("run");
    let set = "sensitivity.base_samples=0";
    let arguments = ["run", "--samples", "500", "--set", set, "--out", &out];
    let answer = reeldown(&arguments).ended_with(3);
    let lines: Vec<&str> = answer.out.lines().collect();
    assert_eq!(lines[2], "NOT MET", "the verdict comes first, under the title");
    let header = lines.iter().position(|line| line.contains("breaches  probability"));
    let header = header.unwrap_or_else(|| panic!("no table in\n{}", answer.out));
    let end = |line: &str, part: &str| {
        let start = line.find(part).unwrap_or_else(|| panic!("no {part} in {line}"));
        line[..start + part.len()].chars().count()
    };
    let column = end(lines[header], "breaches");
    let rows = lines[header + 1..].iter().take_while(|line| line.starts_with(' '));
    let ends: Vec<usize> = rows.map(|line| end(line, " of 500")).collect();
    assert!(ends.len() >= 4, "three limits and any of them");
    assert!(ends.iter().all(|&end| end == column), "{ends:?} under {column}");
    assert!(lines.iter().all(|line| line.chars().count() <= 120), "{}", answer.out);
}
