//! The design space from end to end: the grid, what its values mean, what it leaves behind, mistakes.

use super::program::{Answer, Place, reeldown};
use reeldown::store::read_number_column;
use serde_json::Value;
use std::path::Path;

const VISCOSITY: &str = "fluid.nominal_viscosity=100000cSt..150000cSt:3";
const TEMPERATURE: &str = "initial.temperature=50°F..70°F:3";

fn sweep(place: &Place, arguments: &[&str]) -> Value {
    let out = place.at("sweep");
    reeldown(&[&["sweep", "--json", "--out", &out], arguments].concat()).ended_with(0).json()
}

fn breaches_of_a_run(place: &Place, arguments: &[&str]) -> Value {
    let out = place.at("run");
    let quick = ["--set", "sensitivity.base_samples=0", "--set", "trade.samples=0"];
    let answer = reeldown(&[&["run", "--json", "--out", &out], &quick[..], arguments].concat());
    let findings = answer.json();
    let any = findings["probabilities"].as_array().expect("events").iter();
    let any = any.clone().find(|event| event["kind"] == "any").expect("any limit");
    any["counts"]["breaches"].clone()
}

#[test]
fn property_a_design_value_in_the_sweep_is_that_value_in_a_run() {
    let place = Place::new("sweep-design");
    let found = sweep(&place, &["--over", VISCOSITY, "--samples", "2000"]);
    assert_eq!(found["cells"].as_array().expect("cells").len(), 3);
    // The same points: the first 2000 of the run's plain Monte Carlo design.
    let middle = &found["cells"][1];
    assert_eq!(middle["counts"][0]["breaches"], breaches_of_a_run(&place, &["--samples", "2000"]));
    let set = ["--samples", "2000", "--set", "fluid.nominal_viscosity=150000 cSt"];
    assert_eq!(found["cells"][2]["counts"][0]["breaches"], breaches_of_a_run(&place, &set));
}

/// The lot's tolerance is a share of whatever viscosity is chosen, and the payload's of whatever weight: swept or set, the
/// laws go along.
#[test]
fn property_a_swept_value_takes_its_tolerance_with_it() {
    let place = Place::new("sweep-tolerance");
    let few = ["--samples", "2000"];
    for (path, over, value, meaning) in [
        ("fluid.nominal_viscosity", "80000cSt..150000cSt:2", "150000 cSt", "design"),
        ("payload.weight", "5400lbf..6000lbf:2", "5400 lbf", "centred"),
        ("brake.outer_radius", "8.2in..8.5in:2", "8.2 in", "centred"),
    ] {
        let found = sweep(&place, &[&["--over", &format!("{path}={over}")], &few[..]].concat());
        assert_eq!(found["paths"][0]["meaning"], meaning);
        let cell = if meaning == "design" { 1 } else { 0 };
        let swept = found["cells"][cell]["counts"][0]["breaches"].as_i64().expect("a count");
        let set = format!("{path}={value}");
        let run = breaches_of_a_run(&place, &[&few[..], &["--set", &set]].concat());
        // A mean that is moved is that mean but for rounding: a sample at a limit may fall either way.
        assert!((swept - run.as_i64().expect("a count")).abs() <= 1, "{path}: {swept} {run}");
        assert!(swept > 0 && swept < 2000, "{path}: {swept}");
    }
    // The lot's law is that of a factor: at no viscosity is its effect lost.
    let at = |set: &[&str]| breaches_of_a_run(&place, &[&few[..], set].concat());
    let design = "fluid.nominal_viscosity=150000 cSt";
    let tight = ["--set", design, "--set", "fluid.lot_factor.sd=1e-9"];
    assert_ne!(at(&["--set", design]), at(&tight));
}

#[test]
fn property_what_is_measured_on_the_day_is_held_and_can_be_centred() {
    let place = Place::new("sweep-held");
    let fixed = ["--over", TEMPERATURE, "--samples", "3000"];
    let held = sweep(&place, &fixed);
    assert_eq!(held["paths"][0]["meaning"], "held");
    // A card without the launch temperature: the other inputs are drawn from the same numbers.
    let card = include_str!("../../distributions/habe.toml");
    let (rest, _) = card.split_once("[initial.temperature]").expect("its last input");
    place.write("card.toml", rest);
    let study = include_str!("../../reports/habe/study.toml");
    let line = study.lines().find(|line| line.starts_with("card")).expect("a card");
    let study = place.write("study.toml", study.replace(line, "card = \"card.toml\""));
    let known = breaches_of_a_run(&place, &[&study, "--samples", "3000"]);
    assert_eq!(held["cells"][1]["counts"][0]["breaches"], known);

    let centred = sweep(&place, &[&fixed[..], &["--centre", "initial.temperature"]].concat());
    assert_eq!(centred["paths"][0]["meaning"], "centred");
    let run = breaches_of_a_run(&place, &["--samples", "3000"]);
    // The middle of 50 and 70 °F is 60 °F but for rounding in K.
    let moved = centred["cells"][1]["counts"][0]["breaches"].as_i64().expect("a count");
    assert!((moved - run.as_i64().expect("a count")).abs() <= 1, "{moved} {run}");
    // What is made and not measured is centred unless it is held.
    let gap = ["--over", "brake.gap=0.06in..0.064in:2", "--samples", "1000"];
    let centred = sweep(&place, &gap);
    assert_eq!(centred["paths"][0]["meaning"], "centred");
    let held = sweep(&place, &[&gap[..], &["--hold", "brake.gap"]].concat());
    assert_ne!(centred["cells"], held["cells"]);
    assert_eq!(centred["cells"][0]["outcomes"], held["cells"][0]["outcomes"], "the same nominal");
}

#[test]
fn published_the_starting_temperature_changes_everything() {
    let place = Place::new("sweep-figure-10");
    let found = sweep(&place, &["--over", "initial.temperature=0°F..100°F:6", "--nominal"]);
    // SciPy's Radau, tight tolerances, baseline: 0, 40, 60, 80, 100 °F take 399, 248, 201, 165, 137 s.
    for (cell, time_s) in [(0, 399.0), (2, 248.0), (3, 201.0), (4, 165.0), (5, 137.0)] {
        let found = found["cells"][cell]["outcomes"]["time_s"].as_f64().expect("a time");
        assert!((found - time_s).abs() < 0.5, "whole seconds were printed: {found} {time_s}");
    }
    assert_eq!(found["courses"].as_array().expect("courses").len(), 6);
    let figure = place.bytes("sweep/figures/sweep-velocity-courses.svg");
    let figure = String::from_utf8(figure).expect("UTF-8");
    assert!(figure.contains("separation velocity (ft/s)") && figure.contains("100 °F"));
    assert!(found["cells"][0]["any"].is_null(), "nothing was sampled");
}

#[test]
fn property_a_map_leaves_a_report_a_table_and_figures_whatever_the_threads() {
    let place = Place::new("sweep-map");
    let paths = ["--over", "fluid.nominal_viscosity=90000..150000cSt:7", "--over", TEMPERATURE];
    for threads in ["1", "2", "5"] {
        let out = place.at(threads);
        let fixed = ["sweep", "--samples", "300", "--threads", threads, "--out", &out];
        let answer = reeldown(&[&fixed[..], &paths].concat()).ended_with(0);
        assert!(answer.out.contains(" best        95 % interval "), "{}", answer.out);
        let widest = answer.out.lines().map(|line| line.chars().count()).max();
        assert!(widest <= Some(140), "{}", answer.out);
    }
    let figures = ["sweep-map-probability.svg", "sweep-map-margin.svg", "sweep-best.svg"];
    let files = figures.map(|name| format!("figures/{name}"));
    let files = files.iter().map(String::as_str);
    for name in files.chain(["sweep.json", "sweep.parquet", "report.md"]) {
        let bytes = |threads: &str| place.bytes(&format!("{threads}/{name}"));
        assert!(bytes("1") == bytes("2") && bytes("2") == bytes("5"), "{name} differs");
    }
    let report = String::from_utf8(place.bytes("1/report.md")).expect("UTF-8");
    for part in
        ["same points in every cell", "(figures/sweep-best.svg)", "## To reproduce", "--centre"]
    {
        assert!(report.contains(part), "no {part:?} in\n{report}");
    }
    for word in ["NaN", "inf ", "None", "Some("] {
        assert!(!report.contains(word), "{word:?} in\n{report}");
    }
    let findings: Value = serde_json::from_slice(&place.bytes("1/sweep.json")).expect("JSON");
    let table = place.at("1/sweep.parquet");
    let cells = read_number_column(Path::new(&table), "cell").expect("a column");
    let listed = findings["cells"].as_array().expect("cells");
    let anew = listed.iter().filter(|cell| !cell["confirmed"].is_null()).count();
    assert!(anew >= 3, "the best cell of each of three lines, not {anew}");
    // Ten outcomes; a margin, a relative one and three quantiles for each of three limits; four events; what was found
    // by looking, estimated anew.
    assert_eq!(cells.len(), 21 * (10 + 3 * 5 + 4) + anew);
    let columns = ["fluid_nominal_viscosity_m2_per_s", "initial_temperature_k"];
    for (k, column) in columns.into_iter().enumerate() {
        let values = read_number_column(Path::new(&table), column).expect("a column");
        for (cell, value) in cells.iter().zip(values) {
            let listed = &findings["cells"][*cell as usize]["values"][k];
            assert_eq!(listed.as_f64(), Some(value));
        }
    }
    let footer = String::from_utf8_lossy(&place.bytes("1/sweep.parquet")).into_owned();
    let digest = findings["reproduction"]["study_digest"].as_str().expect("a digest");
    for entry in ["reeldown.study_digest", digest, "reeldown.command"] {
        assert!(footer.contains(entry), "{entry} is not in the footer");
    }
    assert!(place.unfinished().is_empty());
}

#[test]
fn property_the_command_of_a_sweep_gives_the_same_bytes() {
    let place = Place::new("sweep-command");
    let found = sweep(
        &place,
        &[
            "--over",
            TEMPERATURE,
            "--centre",
            "initial.temperature",
            "--samples",
            "200",
            "--seed",
            "7",
            "--set",
            "fluid.nominal_viscosity=\"100000 cSt\"",
        ],
    );
    let command = found["reproduction"]["command"].as_str().expect("a command");
    let words = command.strip_prefix("reeldown ").expect("the program's name");
    let line = format!("{} {words} --out again", env!("CARGO_BIN_EXE_reeldown"));
    let shell = std::process::Command::new("sh");
    let again = { shell }.args(["-c", &line]).current_dir(place.path()).output();
    Answer::of(again.expect("sh runs")).ended_with(0);
    for name in ["sweep.json", "sweep.parquet", "report.md"] {
        assert_eq!(place.bytes(&format!("sweep/{name}")), place.bytes(&format!("again/{name}")));
    }
}

#[test]
fn property_every_bad_range_is_one_clear_message() {
    let place = Place::new("sweep-mistakes");
    let out = place.at("sweep");
    let cases: [(&[&str], &[&str]); 19] = [
        (
            &["fluid.nominal_viscocity=1cSt..2cSt:3"],
            &["unknown path", "did you mean `fluid.nominal_viscosity`?"],
        ),
        (&["initial.temperature=0°F..100kg:3"], &["`kg` is a unit of a mass", "a temperature"]),
        (&["initial.temperature=0..100parsec:3"], &["unknown unit `parsec`"]),
        (&["initial.temperature=100°F..0°F:3"], &["reversed", "0°F..100°F:3"]),
        (
            &["initial.temperature=60°F..60°F:3"],
            &["a single point", "--set initial.temperature=60°F"],
        ),
        (&["initial.temperature=0°F..100°F:1"], &["one value is no range"]),
        (&["initial.temperature=0°F..100°F:0"], &["number of values", "from 2 to"]),
        (&["initial.temperature=0°F..100°F:many"], &["number of values", "from 2 to"]),
        (&["initial.temperature=0°F..100°F:5000"], &["5000 values are too many"]),
        (&["initial.temperature=0°F..100°F"], &["no `:`"]),
        (&["initial.temperature=60°F"], &["no `..`"]),
        (&["initial.temperature"], &["no `=`"]),
        (&["=0°F..100°F:3"], &["no path"]),
        (&["brake.gap=-1mm..1mm:3"], &["impossible"]),
        (&["brake.rotors=5..9:5"], &["brake.rotors cannot be swept"]),
        (&["brake.gap[99]=1mm..2mm:3"], &["no surface", "1 to 14"]),
        (&["reel.inertia=1kg·m²..9kg·m²:2"; 3], &["more than two paths"]),
        (&["reel.inertia=1kg·m²..9kg·m²:2"; 2], &["swept twice"]),
        (
            &["reel.inertia=1kg·m²..9kg·m²:200", "initial.temperature=0°F..9°F:200"],
            &["40000 settings", "at most 10000"],
        ),
    ];
    for (overs, parts) in cases {
        let mut arguments = vec!["sweep", "--nominal", "--out", &out];
        arguments.extend(overs.iter().flat_map(|over| ["--over", *over]));
        assert_says(&reeldown(&arguments).ended_with(1), parts);
    }
    let others: [(&[&str], &[&str]); 5] = [
        (&["--hold", "brake.gap"], &["not swept"]),
        (&["--hold", "initial.temprature"], &["did you mean `initial.temperature`?"]),
        (&["--samples", "many"], &["a number of samples a cell"]),
        (&["--samples", "1"], &["from 20 to"]),
        (
            &["--hold", "initial.temperature", "--centre", "initial.temperature"],
            &["cannot be held and centred"],
        ),
    ];
    for (options, parts) in others {
        let fixed = ["sweep", "--out", &out, "--over", TEMPERATURE];
        assert_says(&reeldown(&[&fixed[..], options].concat()).ended_with(1), parts);
    }
    place.write("card.toml", include_str!("../fixtures/habe/card.toml"));
    let study = place.write("plain.toml", "title = \"x\"\ncard = \"card.toml\"\n");
    let answer = reeldown(&["sweep", &study, "--out", &out, "--over", TEMPERATURE]);
    assert_says(&answer.ended_with(1), &["the study states no limit", "--nominal"]);
    // Values that are possible one by one and not together.
    let radii = ["sweep", "--nominal", "--out", &out, "--over", "brake.inner_radius=2in..9in:8"];
    assert_says(&reeldown(&radii).ended_with(1), &["brake.inner_radius", "smaller than"]);
    reeldown(&["sweep"]).ended_with(2);
    assert!(!place.path().join("sweep").exists(), "nothing is written");
}

#[track_caller]
fn assert_says(answer: &Answer, parts: &[&str]) {
    assert_eq!(answer.err.matches("error").count(), 1, "one message: {}", answer.err);
    for part in parts {
        assert!(answer.err.contains(part), "{part:?} is missing in\n{}", answer.err);
    }
}
