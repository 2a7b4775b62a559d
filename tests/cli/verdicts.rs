//! Exit codes, and what goes to which stream.

use super::program::{Answer, Place, program, reeldown};
use serde_json::Value;
use std::io::Read;
use std::process::Stdio;

/// A study of the embedded card that cannot miss its limit: half an hour less a second.
const LENIENT: &[&str] = &[
    "--set",
    "limits.time.max=1799 s",
    "--set",
    "limits.peak_fluid_temperature.max=2000 °F",
    "--set",
    "limits.final_velocity.max=50 ft/s",
    "--set",
    "sensitivity.base_samples=0",
];
const STRICT: &[&str] = &["--set", "sensitivity.base_samples=0"];

fn run(place: &Place, arguments: &[&[&str]]) -> Answer {
    reeldown(&[&["run", "--out", &place.at("run")], arguments.concat().as_slice()].concat())
}

#[test]
fn property_exit_codes_tell_the_verdict() {
    let place = Place::new("codes");
    // 230 clean samples demonstrate 0.99 at 90 %: 0.99^230 < 0.1 < 0.99^229.
    let met = run(&place, &[LENIENT, &["--samples", "230"]]).ended_with(0);
    assert!(met.out.contains("Requirement met"), "{}", met.out);
    let undecided = run(&place, &[LENIENT, &["--samples", "229"]]).ended_with(4);
    let words = undecided.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("1 more clean samples would"), "{}", undecided.out);
    let not_met = run(&place, &[STRICT, &["--samples", "200"]]).ended_with(3);
    assert!(not_met.out.contains("Requirement not met"), "{}", not_met.out);
    let usage = run(&place, &[&["--bogus"]]).ended_with(2);
    assert!(usage.err.contains("--bogus"), "{}", usage.err);
    reeldown(&["run", "--json", "--quiet"]).ended_with(2);
    reeldown(&["replay"]).ended_with(2);
    reeldown(&["descend", "--trace"]).ended_with(2);
    reeldown(&["run", "--threads", "0"]).ended_with(2);
    run(&place, &[&["--samples", "no"]]).ended_with(1);
}

/// The headline of a replicated design is the interval of its table, or says that there is none; never a binomial one.
#[test]
fn property_without_a_requirement_the_headline_is_the_interval_of_the_table() {
    let place = Place::new("headline");
    place.write("card.toml", include_str!("../fixtures/habe/card.toml"));
    for (design, limit) in [("sobol", 210), ("latin-hypercube", 210), ("halton", 1500)] {
        let text = format!(
            "title = \"h\"\ncard = \"card.toml\"\n[limits]\ntime = {{ max = \"{limit} s\" }}\n\
             [sampling]\ndesign = \"{design}\"\nsamples = 1600\nreplicates = 16\n\
             [sensitivity]\nbase_samples = 64\n[trade]\nsamples = 500\n[epistemic]\nouter = 0\n"
        );
        let study = place.write(&format!("{design}.toml"), &text);
        let findings = run(&place, &[&[&study, "--json"]]).ended_with(0).json();
        let any = findings["probabilities"]
            .as_array()
            .and_then(|all| all.iter().find(|p| p["kind"] == "any").cloned())
            .unwrap_or_default();
        let said = findings["verdict"]["statement"].as_str().unwrap_or_default().to_owned();
        let percent = |end: &str| any["interval"][end].as_f64().map(|p| 100.0 * p);
        match (percent("lower"), percent("upper")) {
            (Some(lower), Some(upper)) => {
                let numbers: Vec<f64> =
                    said.split(['(', ' ']).filter_map(|word| word.parse().ok()).collect();
                let close = |x: f64| numbers.iter().any(|n| (n / x - 1.0).abs() < 1e-3);
                assert!(limit == 210 && close(lower) && close(upper), "{said} {any}");
            }
            _ => assert!(
                limit == 1500 && said.contains("no interval: no replicate saw"),
                "{said} {any}"
            ),
        }
    }
}

/// Nothing is ever lowered: a fluid a thousand times too thick, with limits that say nothing of time.
const STUCK: &str = "title = \"stuck\"\ncard = \"card.toml\"\n[design]\n\
    \"fluid.nominal_viscosity\" = \"125000000 cSt\"\n[limits]\n\
    peak_fluid_temperature = { max = \"450 °F\" }\nfinal_velocity = { max = \"2.5 ft/s\" }\n\
    [requirement]\nreliability = 0.99\nconfidence = 0.90\n\
    [sampling]\nsamples = 2000\n[sensitivity]\nbase_samples = 64\n[trade]\nsamples = 500\n";

/// By the model's definition a descent that does not deploy is a breach, whatever else is limited.
#[test]
fn property_a_line_that_never_runs_out_is_a_breach() {
    let place = Place::new("stuck");
    place.write("card.toml", include_str!("../fixtures/habe/card.toml"));
    let study = place.write("stuck.toml", STUCK);
    let answer = run(&place, &[&[&study, "--json"]]).ended_with(3);
    let findings = answer.json();
    assert_eq!(findings["verdict"]["word"], "not_met");
    let any =
        |list: &Value| list.as_array().and_then(|l| l.iter().find(|p| p["kind"] == "any").cloned());
    let any = any(&findings["probabilities"]).unwrap_or_default();
    assert_eq!(
        (&any["counts"]["breaches"], &any["counts"]["samples"]),
        (&2000.into(), &2000.into())
    );
    assert_eq!(findings["nominal"]["breaches"], serde_json::json!(["time"]));
    let event = &findings["epistemic"]["events"][3];
    assert!(event["mean"]["interval"]["lower"].as_f64().is_some_and(|p| p > 0.99), "{event}");
    // "Go" nowhere: P(any breach) is 1 at every measured value of every chart.
    let charts = findings["known"]["charts"].as_array().cloned().unwrap_or_default();
    let rows: Vec<Value> =
        charts.iter().flat_map(|c| c["rows"].as_array().cloned().unwrap_or_default()).collect();
    assert!(!rows.is_empty(), "{}", findings["known"]);
    for row in rows {
        assert_eq!((&row["probability"]["value"], &row["answer"]), (&1.0.into(), &"no_go".into()));
    }
    let note = "a descent that has not deployed after 1800 s";
    assert!(answer.err.contains(note), "{}", answer.err);
    let place = Place::new("stuck-sweep");
    place.write("card.toml", include_str!("../fixtures/habe/card.toml"));
    let study = place.write("stuck.toml", STUCK);
    let over = "fluid.nominal_viscosity=1e8cSt..1.25e8cSt:3";
    reeldown(&["sweep", "--over", over, "--out", &place.at("swept"), &study]).ended_with(0);
}

/// Where no sample breaches, nothing is best, nothing tightened helps, and no band is drawn.
#[test]
fn property_what_no_sample_shows_is_not_told() {
    let place = Place::new("clean");
    let out = run(&place, &[LENIENT, &["--samples", "2000"]]).ended_with(0).out;
    let words = out.split_whitespace().collect::<Vec<_>>().join(" ");
    for wanted in [
        "the optimum of fluid.nominal_viscosity is not resolved: over a part of its range none of",
        "There is no input whose halved spread lowers P(any breach) significantly.",
        "No credible interval for this brake: it happened with 0 of",
        "MET: P(any breach) 0 (0 … ",
    ] {
        assert!(words.contains(wanted), "{wanted}: {out}");
    }
    assert!(
        !words.contains("the optimum of fluid.nominal_viscosity is 1")
            && !words.contains("Halving"),
        "{out}"
    );
}

#[test]
fn property_without_a_requirement_done_is_done() {
    let place = Place::new("no-requirement");
    place.write("card.toml", include_str!("../fixtures/habe/card.toml"));
    let study = place.write("plain.toml", "title = \"plain\"\ncard = \"card.toml\"\n");
    let answer = run(&place, &[STRICT, &["--samples", "20", &study]]).ended_with(0);
    assert!(answer.out.contains("no limit"), "{}", answer.out);
}

#[test]
fn property_json_is_one_object_and_nothing_else() {
    let place = Place::new("json");
    let answer = run(&place, &[STRICT, &["--samples", "200", "--json"]]).ended_with(3);
    assert_eq!(answer.err, "");
    assert_eq!(answer.out.as_bytes(), place.bytes("run/findings.json"), "the file's very text");
    let findings = answer.json();
    assert_eq!(findings["verdict"]["word"], "not_met");
    assert_eq!(findings["method"]["samples"], 200);
    for arguments in [&["descend", "--json"][..], &["check", "--json"]] {
        let answer = reeldown(arguments).ended_with(0);
        assert_eq!(answer.err, "");
        answer.json();
    }
}

#[test]
fn property_an_error_leaves_standard_output_empty() {
    for arguments in [&["run", "--json", "no.toml"][..], &["descend", "--json", "no.toml"]] {
        let answer = reeldown(arguments).ended_with(1);
        assert_eq!(answer.out, "");
        assert!(answer.err.starts_with("error: cannot read no.toml"), "{}", answer.err);
    }
}

#[test]
fn property_a_run_ends_with_sketches_and_the_verdict_in_80_columns() {
    let place = Place::new("sketch");
    let answer = run(&place, &[STRICT, &["--samples", "2000"]]).ended_with(3);
    // Three sketches, the verdict and the report's place, parted by empty lines.
    let lines: Vec<&str> = answer.out.lines().collect();
    let end = &lines[lines.len() - 7..];
    assert!(end[6].starts_with("report: "), "{}", answer.out);
    assert!(end[4].starts_with("NOT MET: P(any breach) ") && end[4].ends_with("allowed 1 %"));
    for (line, title) in end.iter().zip(["reel-down time", "final sep", "peak fluid"]) {
        assert!(line.starts_with(title) && line.contains('█'), "{line}");
        assert_eq!(line.matches('┃').count(), 1, "one limit: {line}");
    }
    assert!(end[0].contains("% beyond"), "{}", end[0]);
    assert!(end[..5].iter().all(|line| line.chars().count() <= 80), "{end:#?}");
    // Without breaches the limit stands apart.
    let answer = run(&place, &[LENIENT, &["--samples", "300"]]).ended_with(0);
    assert_eq!(answer.out.matches(" ┃").count(), 3, "{}", answer.out);
    assert_eq!(answer.out.matches("no breach\n").count(), 3, "{}", answer.out);
}

#[test]
fn property_quiet_prints_nothing() {
    let place = Place::new("quiet");
    let answer = run(&place, &[STRICT, &["--samples", "200", "--quiet"]]).ended_with(3);
    assert_eq!((answer.out.as_str(), answer.err.as_str()), ("", ""));
    for name in ["findings.json", "report.md", "outcomes.parquet", "provenance.json"] {
        assert!(!place.bytes(&format!("run/{name}")).is_empty());
    }
}

#[test]
fn property_a_reader_who_leaves_is_not_an_error() {
    for arguments in [&["check"][..], &["schema", "card"], &["man"], &["completions", "bash"]] {
        let mut child = program()
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        // One byte, as `| head -c 1` would, and then nobody is there.
        let mut out = child.stdout.take().expect("a pipe");
        out.read_exact(&mut [0]).expect("a byte");
        drop(out);
        let output = child.wait_with_output().expect("the program ends");
        let answer = Answer::of(output).ended_with(0);
        assert_eq!(answer.err, "");
    }
}

/// Runs a command line on a terminal of its own, through `script` of util-linux; `None` without one.
fn on_a_terminal(command: &str, no_colour: Option<&str>) -> Option<String> {
    let mut script = std::process::Command::new("script");
    script.args(["-qec", command, "/dev/null"]).env_remove("NO_COLOR").stdin(Stdio::null());
    if let Some(value) = no_colour {
        script.env("NO_COLOR", value);
    }
    let output = script.env("TERM", "xterm").output().ok()?;
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

#[test]
fn property_colour_is_for_terminals_and_no_color_is_respected() {
    let place = Place::new("colour");
    let binary = env!("CARGO_BIN_EXE_reeldown");
    let set = "--set sensitivity.base_samples=0";
    let command = format!("{binary} run --samples 200 {set} --out {}", place.at("run"));
    let Some(coloured) = on_a_terminal(&command, None) else {
        println!("skipped: there is no `script` here to make a terminal with");
        return;
    };
    assert!(coloured.contains("\u{1b}["), "{coloured:?}");
    let plain = on_a_terminal(&command, Some("1")).expect("script");
    assert!(plain.contains("NOT MET") && !plain.contains("\u{1b}[3"), "{plain:?}");
    let empty = on_a_terminal(&command, Some("")).expect("script");
    assert!(empty.contains("\u{1b}["), "an empty NO_COLOR says nothing: {empty:?}");
}

/// Average and brake differ, and the exit code follows the one that the requirement names: of 300 brakes that share a limit the
/// average is met (1 799 s is never reached), and so is every brake; at the default limits neither is.
#[test]
fn property_the_requirement_names_the_average_or_this_brake() {
    let place = Place::new("of");
    let small = ["--set", "epistemic={ outer = 200, inner = 32 }", "--set", "trade.samples=0"];
    let of = ["--set", "requirement.of=brake", "--samples", "300"];
    let met = run(&place, &[LENIENT, &small, &of]).ended_with(0);
    assert!(met.out.contains("This brake: that its own probability"), "{}", met.out);
    assert!(met.out.contains("MET: this brake has P(any breach) of at most 1 %"), "{}", met.out);
    assert!(met.out.contains("Average over all possible brakes. Requirement met"), "{}", met.out);
    let not_met = run(&place, &[STRICT, &small, &of, &["--force"]]).ended_with(3);
    let text = not_met.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(text.contains("less probable than required (90 %)"), "{text}");
    // Reliability 0.5: the average (40 % breach) meets it, two brakes in five do not.
    let half = ["--set", "requirement.reliability=0.5"];
    run(&place, &[STRICT, &small, &half, &["--samples", "300", "--force"]]).ended_with(0);
    run(&place, &[STRICT, &small, &half, &of, &["--force"]]).ended_with(3);
    // Without the nested analysis nothing is known of this brake.
    let none = ["--set", "epistemic.outer=0", "--set", "trade.samples=0", "--force"];
    let undecided = run(&place, &[LENIENT, &none, &of]).ended_with(4);
    assert!(undecided.out.contains("was not computed"), "{}", undecided.out);
    let refused = run(
        &place,
        &[STRICT, &of[..2], &["--set", "sampling.until={ decided = true, budget = 1000 }"]],
    );
    assert!(refused.ended_with(1).err.contains("the requirement is of this brake"));
}
