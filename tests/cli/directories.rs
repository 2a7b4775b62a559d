//! Directories of results: one writer at a time, whose they are, and whether they are finished.

use super::determinism::{assert_same, run};
use super::program::{Answer, Place, program, reeldown};
use reeldown::store::OutcomesReader;
use serde_json::Value;
use std::path::Path;
use std::process::{Child, Stdio};
use std::thread;
use std::time::Duration;

fn json(place: &Place, name: &str) -> Value {
    serde_json::from_slice(&place.bytes(name)).expect("JSON")
}

/// Starts a run of the embedded study into a directory.
fn start(out: &str, samples: &str, seed: &str, extra: &[&str]) -> Child {
    let few = ["--set", "sensitivity.base_samples=0", "--set", "trade.samples=0"];
    program()
        .args(["run", "--quiet", "--out", out, "--samples", samples, "--seed", seed])
        .args(few)
        .args(extra)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts")
}

fn ended(child: Child) -> Answer {
    Answer::of(child.wait_with_output().expect("it ends"))
}

#[test]
fn regression_two_runs_into_one_directory_do_not_mix() {
    let place = Place::new("two-runs");
    // Started together: whoever comes second is refused, or finds the first one done and replaces it.
    let children = ["1", "2", "3", "4"].map(|seed| start(&place.at("run"), "20000", seed, &[]));
    let answers = children.map(ended);
    let done = answers.iter().filter(|answer| answer.code == 3).count();
    assert!(done >= 1, "{}", answers[0].err);
    for answer in answers.iter().filter(|answer| answer.code != 3) {
        assert_eq!(answer.code, 1, "{}", answer.err);
        for part in ["cannot write into", "another reeldown is writing", "(process ", "--out"] {
            assert!(answer.err.contains(part), "no {part:?} in {}", answer.err);
        }
    }
    let table =
        OutcomesReader::open(Path::new(&place.at("run/outcomes.parquet"))).expect("a table");
    let of_table = table.parentage().0["study_digest"].clone();
    let reproduction = json(&place, "run/findings.json")["reproduction"].clone();
    assert_eq!(reproduction["study_digest"], of_table);
    let report = String::from_utf8(place.bytes("run/report.md")).expect("UTF-8");
    assert!(report.contains(&of_table), "the report is of the table");
    assert_eq!(place.unfinished(), Vec::<std::path::PathBuf>::new());
    assert!(!place.path().join("run/unfinished.json").exists());
}

/// While one writes, a second is refused at once and disturbs nothing.
#[cfg(unix)]
#[test]
fn regression_a_second_writer_is_refused_and_the_first_one_comes_to_its_end() {
    let place = Place::new("second-writer");
    let first = start(&place.at("run"), "400000", "1", &[]);
    let part = place.path().join("run/outcomes.parquet.part");
    while !part.exists() {
        thread::sleep(Duration::from_millis(1));
    }
    let sweep = ["sweep", "--over", "brake.gap=0.06 in..0.07 in:3", "--nominal", "--out"];
    let out = place.at("run");
    let others =
        [ended(start(&out, "100", "2", &[])), ended(start(&out, "100", "2", &["--force"]))];
    let others = others.into_iter().chain([reeldown(&[&sweep[..], &[&out]].concat())]);
    for answer in others {
        let answer = answer.ended_with(1);
        assert!(answer.err.contains("cannot write into"), "{}", answer.err);
    }
    ended(first).ended_with(3);
    ended(start(&place.at("alone"), "400000", "1", &[])).ended_with(3);
    assert_same(&place, "alone", "run");
}

#[test]
fn regression_what_is_not_this_studys_is_replaced_with_force_only() {
    let place = Place::new("strangers");
    std::fs::create_dir(place.path().join("mine")).expect("a directory");
    place.write("mine/report.md", "my thesis");
    place.write("mine/data.csv", "1,2\n");
    let few = ["--samples", "200", "--set", "sensitivity.base_samples=0"];
    let refused = |answer: Answer, parts: &[&str]| {
        let answer = answer.ended_with(1);
        for part in parts.iter().chain(&["--force", "--out"]) {
            assert!(answer.err.contains(part), "no {part:?} in {}", answer.err);
        }
    };
    refused(run(&place, "mine", &few), &["report.md", "nothing says that reeldown wrote it"]);
    assert_eq!(place.bytes("mine/report.md"), b"my thesis");
    assert_eq!(std::fs::read_dir(place.path().join("mine")).expect("a directory").count(), 2);
    run(&place, "mine", &[&few[..], &["--force"]].concat()).ended_with(3);
    assert_ne!(place.bytes("mine/report.md"), b"my thesis");
    assert_eq!(place.bytes("mine/data.csv"), b"1,2\n");

    // The same study again needs no force, another study or command does.
    run(&place, "mine", &[&few[..], &["--seed", "3"]].concat()).ended_with(3);
    let before = place.bytes("mine/report.md");
    let other = [&few[..], &["--set", "title=another rig"]].concat();
    refused(run(&place, "mine", &other), &["it holds the results of `reeldown run` of"]);
    let out = place.at("mine");
    let sweep = ["sweep", "--over", "brake.gap=0.06 in..0.07 in:3", "--nominal", "--out", &out];
    refused(reeldown(&sweep), &["it holds the results of `reeldown run` of"]);
    // Nor do results lose their owner with their manifest.
    std::fs::remove_file(place.path().join("mine/manifest.json")).expect("a manifest");
    refused(run(&place, "mine", &other), &["it holds the results of `reeldown run` of"]);
    assert_eq!(place.bytes("mine/report.md"), before);
    run(&place, "mine", &few).ended_with(3);
    // With force, what the other study had and this one has not is gone.
    reeldown(&[&sweep[..], &["--force"]].concat()).ended_with(0);
    for gone in ["outcomes.parquet", "findings.json", "provenance.json"] {
        assert!(!place.path().join("mine").join(gone).exists(), "{gone} is of the run before");
    }
    let page = String::from_utf8(place.bytes("mine/report.html")).expect("UTF-8");
    assert!(page.contains(">Design space<"), "the page is the sweep's");
    assert_eq!(place.bytes("mine/data.csv"), b"1,2\n");
}

#[test]
fn property_the_manifest_names_what_is_there_and_its_checksums() {
    let place = Place::new("manifest");
    run(&place, "run", &["--samples", "300"]).ended_with(3);
    let manifest = json(&place, "run/manifest.json");
    let files = manifest["files"].as_object().expect("files");
    let mut listed: Vec<&str> = files.keys().map(String::as_str).collect();
    listed.push("manifest.json");
    listed.sort_unstable();
    let mut there = Vec::new();
    for directory in ["", "figures/"] {
        for entry in std::fs::read_dir(place.at(&format!("run/{directory}"))).expect("a directory")
        {
            let entry = entry.expect("an entry");
            if entry.path().is_file() {
                there.push(format!("{directory}{}", entry.file_name().display()));
            }
        }
    }
    there.sort();
    assert_eq!(listed, there);
    for (name, sum) in files {
        use sha2::Digest;
        let bytes = place.bytes(&format!("run/{name}"));
        let found: String =
            sha2::Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
        // Tables have checksums of their own; the provenance differs from run to run.
        let own = name.ends_with(".parquet") || name == "provenance.json";
        assert_eq!(sum, &if own { Value::Null } else { found.into() }, "{name}");
    }
    // A changed tree is not compared.
    let text = String::from_utf8(place.bytes("run/findings.json")).expect("UTF-8");
    place.write("run/findings.json", text.replacen("\"breaches\"", "\"broaches\"", 1));
    let out = place.at("run");
    let answer = reeldown(&["compare", &out, &out]).ended_with(1);
    assert!(answer.err.contains("do not match the checksum"), "{}", answer.err);
}

#[test]
fn regression_figures_of_an_earlier_study_do_not_stay() {
    let place = Place::new("figures");
    let figures = |name: &str| -> Vec<String> {
        let list = std::fs::read_dir(place.at(&format!("{name}/figures"))).expect("figures");
        let mut names: Vec<String> =
            list.map(|entry| entry.expect("an entry").file_name().display().to_string()).collect();
        names.sort();
        names
    };
    let few = ["--samples", "500", "--set", "sensitivity.base_samples=0"];
    let less = [&few[..], &["--set", "trade.samples=0", "--set", "epistemic.outer=0"]].concat();
    run(&place, "run", &[&few[..], &["--png"]].concat()).ended_with(3);
    place.write("run/figures/my-own.svg", "<svg/>");
    let more = figures("run");
    run(&place, "alone", &less).ended_with(3);
    run(&place, "run", &less).ended_with(3);
    let mut expected = figures("alone");
    assert!(expected.len() + 1 < more.len(), "{more:?}");
    expected.push("my-own.svg".to_owned());
    expected.sort();
    assert_eq!(figures("run"), expected);
}

#[test]
fn regression_a_file_in_place_of_the_figures_is_noticed_before_the_work() {
    let place = Place::new("figures-obstacle");
    for (kind, directory) in [("run", "a"), ("sweep", "b")] {
        std::fs::create_dir(place.path().join(directory)).expect("a directory");
        place.write(&format!("{directory}/figures"), "mine");
        let out = place.at(directory);
        let over = ["--over", "brake.gap=0.06 in..0.07 in:3", "--nominal"];
        let more: &[&str] = if kind == "sweep" { &over } else { &["--samples", "200"] };
        let answer = reeldown(&[&[kind, "--out", &out, "--force"], more].concat()).ended_with(1);
        assert!(answer.err.contains("figures: it is not a directory"), "{}", answer.err);
        let entries = std::fs::read_dir(&out).expect("a directory").count();
        assert_eq!(entries, 1, "nothing was computed or written");
    }
}

/// A command that dies while it writes leaves a directory that says so, and the next one mends it.
#[cfg(unix)]
#[test]
fn regression_a_directory_of_a_command_that_was_killed_says_that_it_is_unfinished() {
    let place = Place::new("unfinished");
    let few = ["--samples", "300", "--set", "sensitivity.base_samples=0"];
    run(&place, "run", &few).ended_with(3);
    let out = place.at("run");
    // What a kill between two files leaves: the mark of a process that is no more, and a file half-written.
    let marker = r#"{"note": "`reeldown run` of \"x\" ended early", "kind": "run", "study": "TITLE",
        "changed": true, "process": 1}"#;
    let title = json(&place, "run/manifest.json")["study"].clone();
    place.write("run/unfinished.json", marker.replace("TITLE", title.as_str().expect("a title")));
    place.write("run/report.md.77777-0.part", "half");
    place.write("run/figures/x.svg.77777-1.part", "half");
    let answer = reeldown(&["compare", &out, &out]).ended_with(1);
    assert!(answer.err.contains("it is unfinished"), "{}", answer.err);
    run(&place, "run", &few).ended_with(3);
    assert!(!place.path().join("run/unfinished.json").exists());
    assert_eq!(place.unfinished(), Vec::<std::path::PathBuf>::new());
    reeldown(&["compare", &out, &out]).ended_with(0);
}

/// What a run that is refused has not touched is not marked, and a directory that it made is gone.
#[test]
fn property_a_command_that_fails_before_it_writes_leaves_no_mark() {
    let place = Place::new("no-mark");
    run(&place, "run", &["--samples", "200"]).ended_with(3);
    let refused = ["--samples", "200", "--seed", "9", "--resume"];
    run(&place, "run", &refused).ended_with(1);
    assert!(!place.path().join("run/unfinished.json").exists());
    let out = place.at("run");
    reeldown(&["compare", &out, &out]).ended_with(0);
}
