//! Traces, `check`, schemas, completions and the manual page.

use super::program::{Place, reeldown};
use reeldown::store::read_number_column;
use std::path::Path;

#[test]
fn property_a_trace_has_its_columns_and_ends_with_the_outcome() {
    let place = Place::new("trace");
    for model in ["dynamic", "quasi-steady"] {
        let file = place.at(&format!("{model}.parquet"));
        let arguments = ["descend", "--json", "--model", model, "--trace", &file];
        let outcome = reeldown(&arguments).ended_with(0).json();
        let column = |name: &str| {
            read_number_column(Path::new(&file), name)
                .unwrap_or_else(|why| panic!("{model} {name}: {why}"))
        };
        let times = column("time_s");
        let names = [
            "line_m",
            "torque_nm",
            "fluid_temperature_k",
            "rotor_temperature_k",
            "housing_temperature_k",
            "tension_n",
            "reel_speed_rad_per_s",
            "power_w",
            "velocity_m_per_s",
        ];
        for name in names {
            assert_eq!(column(name).len(), times.len(), "{name}");
        }
        assert_eq!(times[0], 0.0);
        assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "time goes on");
        let end = |name: &str| *column(name).last().expect("a row");
        let outcome = |name: &str| outcome[name].as_f64().expect("a number");
        // Both at the reference tolerance, with other steps: 1e-8 leaves two decades for that.
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-8;
        assert!(near(end("time_s"), outcome("time_s")));
        assert!(near(end("fluid_temperature_k"), outcome("final_fluid_temperature_k")));
        assert!(near(end("velocity_m_per_s"), outcome("final_velocity_m_per_s")));
        assert!(near(end("line_m"), 500.0 * 0.3048), "the line has run out");
        if model == "dynamic" {
            assert_eq!(column("balloon_velocity_m_per_s").len(), times.len());
        }
    }
    assert!(place.unfinished().is_empty());
}

#[test]
fn property_check_shows_every_input_with_unit_and_source() {
    let answer = reeldown(&["check", "--set", "initial.temperature=40 °F"]).ended_with(0);
    assert_eq!(answer.err, "");
    for text in ["brake.gap", "(×14)", "lognormal", "at build", "on the day", "limit: time max"] {
        assert!(answer.out.contains(text), "{text}: {}", answer.out);
    }
    let object = reeldown(&["check", "--json"]).ended_with(0).json();
    let inputs = object["inputs"].as_array().expect("a list");
    for input in inputs {
        let source = input["source"].as_str().expect("a source");
        assert!(!source.is_empty(), "{input}");
        assert!(input["value"].is_number() && input["unit"].is_string(), "{input}");
    }
    let gap = inputs.iter().find(|input| input["path"] == "brake.gap").expect("the gap");
    assert_eq!(gap["uncertain"]["inputs"], 14);
    assert_eq!(gap["unit"], "m");
    let uncertain: u64 =
        inputs.iter().filter_map(|input| input["uncertain"]["inputs"].as_u64()).sum();
    assert_eq!(uncertain, 28, "the default card has 28 uncertain inputs");
    assert_eq!(object["limits"].as_array().map(Vec::len), Some(3));
}

#[test]
fn property_both_schemas_are_json_and_name_the_keys() {
    for (kind, key) in [("study", "limits"), ("card", "brake.gap")] {
        let schema = reeldown(&["schema", kind]).ended_with(0).json();
        let meta = schema["$schema"].as_str().expect("a dialect");
        assert_eq!(meta, "https://json-schema.org/draft/2020-12/schema");
        let leaf = key.split('.').next_back().expect("a key");
        assert!(schema.to_string().contains(leaf), "{kind} names {key}");
    }
    assert_eq!(reeldown(&["schema"]).out, reeldown(&["schema", "study"]).out);
    reeldown(&["schema", "report"]).ended_with(2);
}

#[test]
fn property_every_shell_has_completions() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let answer = reeldown(&["completions", shell]).ended_with(0);
        for word in ["descend", "replay", "samples", "resume"] {
            assert!(answer.out.contains(word), "{shell} lacks {word}");
        }
    }
    reeldown(&["completions", "tcsh"]).ended_with(2);
}

#[test]
fn property_the_manual_tells_every_command_and_exit_code() {
    let answer = reeldown(&["man"]).ended_with(0);
    assert!(answer.out.contains(".TH reeldown 1"), "{}", answer.out);
    for word in ["descend", "replay", "check", "schema", "completions", "Exit codes"] {
        assert!(answer.out.contains(word), "no {word}");
    }
}

#[test]
fn property_help_and_version_are_answers() {
    let help = reeldown(&["--help"]).ended_with(0);
    assert!(help.out.contains("Exit codes"), "{}", help.out);
    let version = reeldown(&["--version"]).ended_with(0);
    assert_eq!(version.out.trim(), concat!("reeldown ", env!("CARGO_PKG_VERSION")));
}

#[test]
fn property_an_empirical_law_reads_a_column_of_a_parquet_file() {
    let place = Place::new("empirical");
    let trace = place.at("readings.parquet");
    reeldown(&["descend", "--trace", &trace]).ended_with(0);
    let card = "[initial.temperature]\nlaw = \"empirical\"\nfile = \"readings.parquet\"\n\
                column = \"fluid_temperature_k\"\nknown = \"on the day\"\nsource = \"a trace\"\n";
    std::fs::write(place.path().join("card.toml"), card).expect("a card");
    let study = "title = \"empirical\"\ncard = \"card.toml\"\n";
    std::fs::write(place.path().join("study.toml"), study).expect("a study");
    let answer = reeldown(&["check", "--json", &place.at("study.toml")]).ended_with(0);
    let shown: serde_json::Value = serde_json::from_str(&answer.out).expect("JSON");
    let mean = shown["inputs"]
        .as_array()
        .expect("inputs")
        .iter()
        .find(|input| input["path"] == "initial.temperature")
        .and_then(|input| input["uncertain"]["mean"].as_f64())
        .expect("an uncertain input");
    let readings = read_number_column(Path::new(&trace), "fluid_temperature_k").expect("numbers");
    let (low, high) =
        readings.iter().fold((f64::INFINITY, 0.0f64), |(l, h), &v| (l.min(v), h.max(v)));
    assert!(low < mean && mean < high, "{low} {mean} {high}");
}

#[test]
fn property_every_input_and_outcome_is_explained() {
    let listed = reeldown(&["explain"]).ended_with(0).out;
    let object = reeldown(&["check", "--json"]).ended_with(0).json();
    for input in object["inputs"].as_array().expect("a list") {
        let path = input["path"].as_str().expect("a path");
        assert!(listed.contains(path), "{path} in {listed}");
        let told = reeldown(&["explain", path]).ended_with(0).out;
        let source = input["source"].as_str().expect("a source");
        for part in ["what it is", "unit", "possible", "HABE brake", "law", source] {
            assert!(told.contains(part), "{part}: {told}");
        }
    }
    let time = reeldown(&["explain", "time"]).ended_with(0).out;
    assert!(time.contains("time_s") && time.contains("max 210 s"), "{time}");
    let near = reeldown(&["explain", "brake.gpa"]).ended_with(1);
    assert!(near.err.contains("did you mean `reeldown explain brake.gap`?"), "{}", near.err);
}
