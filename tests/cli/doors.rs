//! Files and arguments that no study ever meant: pipes, devices, bytes that are no text.
#![cfg(unix)]

use super::program::{Answer, Place, program, reeldown};
use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Runs the program, which has a minute to end by itself: a reader of a pipe without a writer never does.
fn ends(arguments: &[&str]) -> Answer {
    let mut child = program()
        .args(arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let start = Instant::now();
    while child.try_wait().expect("a child").is_none() {
        if start.elapsed() > Duration::from_secs(60) {
            child.kill().expect("it ends");
            panic!("{arguments:?} waits for ever");
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    Answer::of(child.wait_with_output().expect("its answer"))
}

#[test]
fn property_pipes_and_devices_are_refused_wherever_a_file_is_read() {
    let place = Place::new("doors");
    let pipe = place.at("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo").success());
    let joint = "[[joint]]\nfile = \"FILE\"\nknown = \"never\"\nsource = \"test\"\n";
    let listed = "[fluid.shear_factor]\nlaw = \"empirical\"\nfile = \"FILE\"\ncolumn = \"x\"\nknown = \"never\"\n\
                  source = \"test\"\n";
    let study = |name: &str, card: &str| {
        place.write(
            name,
            format!("title = \"t\"\ncard = \"{card}\"\n[limits]\ntime = {{ max = \"230 s\" }}\n"),
        )
    };
    for file in ["pipe", "/dev/zero"] {
        place.write("joint.toml", joint.replace("FILE", file));
        place.write("listed.toml", listed.replace("FILE", file));
        let path = if file == "pipe" { &pipe } else { file };
        for arguments in [
            &["check", path][..],
            &["check", &study("a.toml", file)],
            &["check", &study("b.toml", "joint.toml")],
            &["check", &study("c.toml", "listed.toml")],
            &["rig", "--recorded", path],
            &["calibrate", "--data", path, "--out", &place.at("out")],
            &["replay", path, "--index", "0"],
        ] {
            let answer = ends(arguments).ended_with(1);
            let said =
                answer.err.contains("pipe or a device") || answer.err.contains("not a regular");
            assert!(said, "{arguments:?}: {}", answer.err);
        }
    }
}

#[test]
fn regression_an_argument_that_is_no_text_is_a_path_like_any_other() {
    // Issue 12: the program panicked when it noted its own command.
    let place = Place::new("doors-bytes");
    let out = place.path().join(OsStr::from_bytes(b"run\xff"));
    let mut run = program();
    run.args(["run", "--samples", "64", "--quiet", "--set", "sensitivity.base_samples=0"]);
    run.args(["--set", "trade.samples=0", "--set", "epistemic.outer=0", "--out"]).arg(&out);
    let answer = Answer::of(run.output().expect("the program starts"));
    assert!([0, 3, 4].contains(&answer.code), "{}: {}", answer.code, answer.err);
    let provenance = std::fs::read(out.join("provenance.json")).expect("provenance.json");
    let provenance: serde_json::Value = serde_json::from_slice(&provenance).expect("JSON");
    let command = provenance["command"].as_array().expect("a command");
    assert!(command.iter().any(|word| word.as_str().is_some_and(|w| w.ends_with("run\u{fffd}"))));
    // As an option's text it is a usage error.
    let mut run = program();
    run.args(["run", "--set"]).arg(OsStr::from_bytes(b"\xff=1"));
    Answer::of(run.output().expect("the program starts")).ended_with(2);
    reeldown(&["--version"]).ended_with(0);
}
