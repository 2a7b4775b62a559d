//! `reeldown rig`: runs, recorded runs, the modes compared, tests planned; and `reeldown paper`.

use super::program::{Answer, Place, program, reeldown};
use reeldown::store::read_number_column;
use std::path::Path;

const LBF: f64 = 4.4482216152605;

#[test]
fn property_a_held_pull_and_its_trace_read_back_give_the_same_run() {
    let place = Place::new("rig-held");
    let trace = place.at("run.parquet");
    let held =
        reeldown(&["rig", "--force", "6000 lbf", "--trace", &trace, "--json"]).ended_with(0).json();
    let get = |object: &serde_json::Value, name: &str| object[name].as_f64().expect("a number");
    assert!((get(&held, "peak_tension_n") / LBF - 6000.0).abs() < 1e-6);
    assert_eq!(read_number_column(Path::new(&trace), "time_s").unwrap()[0], 0.0);
    for (by, drives) in [("force", "force"), ("speed", "speed")] {
        let again =
            reeldown(&["rig", "--recorded", &trace, "--by", by, "--json"]).ended_with(0).json();
        // Linear between readings a quarter of a second apart: the curvature costs a few parts in a million.
        for name in ["peak_fluid_temperature_k", "final_rotor_temperature_k", "energy_j", "time_s"]
        {
            let (a, b) = (get(&held, name), get(&again, name));
            assert!((a / b - 1.0).abs() < 1e-4, "{by} {name}: {a} {b}");
        }
        for residual in again["residuals"].as_array().expect("residuals") {
            assert_eq!(residual["drives"].as_bool(), Some(residual["channel"] == drives));
        }
        assert_eq!(again["record_digest"].as_str().map(str::len), Some(64));
    }
    assert!(place.unfinished().is_empty());
}

#[test]
fn property_a_recorded_run_in_engineers_units() {
    let place = Place::new("rig-recorded");
    let rows: String = (0..60).map(|k| format!("{k}, {}, 60\n", 5000 + 300 * (k % 3))).collect();
    let csv = place.write("run.csv", format!("time [s], force [lbf], fluid [°F]\n{rows}"));
    let figures = place.at("figures");
    let answer = reeldown(&["rig", "--recorded", &csv, "--figures", &figures]).ended_with(0);
    for text in ["driven by the force", "The record ends before the line does", "root mean square"]
    {
        assert!(answer.out.contains(text), "{text}: {}", answer.out);
    }
    for name in ["rig-force", "rig-speed", "rig-power", "rig-temperatures"] {
        let svg = String::from_utf8(place.bytes(&format!("figures/{name}.svg"))).unwrap();
        assert!(svg.contains("role=\"img\"") && svg.contains("<desc"), "{name}");
    }
    let gap =
        place.write("gap.csv", format!("time [s], force [lbf], fluid [°F]\n{rows}90,5000,60\n"));
    let answer = reeldown(&["rig", "--recorded", &gap]).ended_with(1);
    assert!(answer.err.contains("a gap of 31 s"), "{}", answer.err);
    assert!(answer.err.contains("gap.csv:62"), "{}", answer.err);
    reeldown(&["rig", "--recorded", &gap, "--gaps"]).ended_with(0);
    let answer = reeldown(&["rig", "--recorded", &csv, "--by", "speed"]).ended_with(1);
    assert!(answer.err.contains("no column `speed`"), "{}", answer.err);
}

#[test]
fn property_mistakes_on_the_rig_are_one_clear_error() {
    let cases: [(&[&str], &str); 6] = [
        (&["rig", "--force", "6000 lb"], "lb is a mass; write lbf"),
        (&["rig", "--force", "0 lbf"], "pulls no line"),
        (&["rig", "--speed=-1 ft/s"], "pulls no line"),
        (&["rig", "--plan", "--starts", "60"], "has no unit"),
        (&["rig", "--compare", "--force-gain", "0 %"], "systematic error of force"),
        (&["rig", "--recorded", "no-such.csv"], "cannot read no-such.csv"),
    ];
    for (arguments, expected) in cases {
        let answer = reeldown(arguments).ended_with(1);
        assert!(answer.err.contains(expected), "{arguments:?}: {}", answer.err);
        assert_eq!(answer.err.matches("error: ").count(), 1, "{}", answer.err);
        assert_eq!(answer.out, "");
    }
    // Options that contradict each other, or lack one, are misuse.
    let cases: [(&[&str], &str); 6] = [
        (&["rig"], "what pulls?"),
        (&["rig", "--force", "6000 lbf", "--speed", "2 ft/s"], "--compare takes several"),
        (&["rig", "--plan", "--force", "1 lbf"], "cannot be used with"),
        (&["rig", "--compare", "--thermometers", "none,fluid"], "none goes with no other node"),
        (&["rig", "--plan", "9"], "9 is not in 1..=4"),
        (&["rig", "--recorded", "x.csv", "--force", "1 lbf"], "cannot be used with"),
    ];
    for (arguments, expected) in cases {
        let answer = reeldown(arguments).ended_with(2);
        assert!(answer.err.contains(expected), "{arguments:?}: {}", answer.err);
        assert_eq!(answer.out, "");
    }
}

#[test]
fn property_the_modes_keep_the_proof_load_and_every_parameter_gains() {
    let found =
        reeldown(&["rig", "--compare", "--proof-load", "7000 lbf", "--json"]).ended_with(0).json();
    let modes = found["modes"].as_array().expect("modes");
    assert_eq!(modes.len(), 3);
    for mode in modes {
        let share = mode["load_over_proof"].as_f64().unwrap();
        assert!(share > 0.5 && share <= 1.0, "{share}");
        for left in mode["remaining"].as_array().unwrap() {
            let left = left.as_f64().unwrap();
            assert!(left > 0.0 && left <= 1.0 + 1e-12, "{left}");
        }
    }
    // A level that is given is taken as it is, above the proof load too.
    let found =
        reeldown(&["rig", "--compare", "--force", "9500 lbf", "--json"]).ended_with(0).json();
    let share = found["modes"][0]["load_over_proof"].as_f64().unwrap();
    assert!((share - 9500.0 / 9000.0).abs() < 1e-9, "{share}");
}

#[test]
fn regression_a_constant_force_has_no_time_of_its_peak_and_the_model_is_named() {
    let place = Place::new("rig-constant");
    let found = reeldown(&["rig", "--compare", "--json"]).ended_with(0).json();
    let modes = found["modes"].as_array().expect("modes");
    assert!(modes[0]["peak_force_time_s"].is_null(), "{}", modes[0]["peak_force_time_s"]);
    for mode in &modes[1..] {
        assert!(mode["peak_force_time_s"].as_f64().expect("a time") >= 0.0);
    }
    assert_eq!(found["model"], "quasi-steady");
    let (figures, one) = (place.at("figures"), place.at("one"));
    let shown = reeldown(&["rig", "--compare", "--figures", &figures]).ended_with(0).out;
    let after = shown.lines().find(|line| line.trim_start().starts_with("after")).expect("a row");
    assert!(after.contains("constant"), "{after}");
    let single = reeldown(&["rig", "--force", "6000 lbf", "--figures", &one]).ended_with(0).out;
    let plan = ["rig", "--plan", "1", "--starts", "60 °F"];
    let planned = reeldown(&plan).ended_with(0).out;
    let paper = reeldown(&["paper"]).ended_with(0).out;
    for text in [&shown, &single, &planned, &paper] {
        assert!(text.contains("quasi-steady model"), "{text}");
    }
    let drawn = |name: &str| String::from_utf8(place.bytes(name)).expect("text");
    assert!(drawn("one/rig-force.svg").contains("Quasi-steady model: 6000 lbf throughout"));
    assert!(drawn("figures/rig-modes-force.svg").contains("Quasi-steady model: held are"));
}

#[test]
fn property_more_runs_never_leave_a_wider_band_and_better_instruments_a_narrower() {
    let plan = |more: &[&str]| {
        let arguments: Vec<&str> = ["rig", "--plan", "2", "--starts", "20 °F,100 °F", "--json"]
            .iter()
            .chain(more)
            .copied()
            .collect();
        reeldown(&arguments).ended_with(0).json()
    };
    let deviation =
        |band: &serde_json::Value| band["index_standard_deviation"].as_f64().expect("a number");
    let found = plan(&[]);
    let best =
        |found: &serde_json::Value, size: usize| deviation(&found["best"][size - 1][0]["band"]);
    assert!(best(&found, 1) < deviation(&found["now"]));
    assert!(best(&found, 2) < best(&found, 1));
    for candidate in found["candidates"].as_array().expect("candidates") {
        assert!(deviation(&candidate["band"]) >= best(&found, 1) - 1e-12, "the best is the best");
        assert!(candidate["peak_force_n"].as_f64().unwrap() <= 9000.0 * LBF * (1.0 + 1e-9));
    }
    let finer = plan(&["--force-gain", "0.2 %", "--thermometers", "fluid,rotor,housing"]);
    assert!(best(&finer, 1) < best(&found, 1));
    let blind = plan(&["--thermometers", "none"]);
    assert!(best(&blind, 1) > best(&found, 1));
    // The same numbers every time.
    assert_eq!(plan(&[]), found);
}

#[test]
fn regression_the_published_page_of_the_paper_is_what_this_version_writes() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let place = Place::new("paper");
    let out = place.at("paper");
    let run = program().args(["paper", "--out", &out]).current_dir(root).output().expect("a start");
    let answer = Answer::of(run).ended_with(0);
    assert!(
        answer.out.contains("17 of the paper's 24 statements agree, 4 do not, 1 is undecided"),
        "{}",
        answer.out
    );
    let published = root.join("reports/paper");
    let mut files: Vec<String> = vec!["report.md".to_owned(), "paper.json".to_owned()];
    for entry in std::fs::read_dir(published.join("figures")).expect("published figures") {
        files.push(format!("figures/{}", entry.expect("an entry").file_name().to_string_lossy()));
    }
    assert_eq!(files.len(), 2 + 7 + 4, "figures 4 to 10 and four of the rig");
    let report = String::from_utf8(place.bytes("paper/report.md")).expect("text");
    for file in files {
        let kept = std::fs::read(published.join(&file)).expect("a published file");
        assert!(
            place.bytes(&format!("paper/{file}")) == kept,
            "reports/paper/{file} is not what this version writes: `reeldown paper --out reports/paper` (with --force where there is no manifest)"
        );
        assert!(!file.ends_with(".svg") || report.contains(&file), "{file} is on the page");
    }
    assert!(report.contains("**FAIL**") && report.contains("775 s"), "what fails is said");
}
