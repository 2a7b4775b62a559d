//! Joint samples in cards: from CSV and Parquet, replayed, and refused when the file is another.

use super::program::{PINNED, Place, reeldown};
use reeldown::store::{Field, write_table};

const STUDY: &str = "title = \"joint\"\ncard = [\"base.toml\", \"card.toml\"]\n\
    [limits]\ntime = { max = \"210 s\" }\n[sampling]\nsamples = 512\n[sensitivity]\nbase_samples = 64\n\
    bootstrap = 100\n[trade]\nsamples = 100\n";

fn write(place: &Place, name: &str, text: &str) {
    std::fs::write(place.path().join(name), text).expect("a file");
}

/// A study whose inputs are drawn from an earlier run's own table of samples.
fn of_an_earlier_run(place: &Place) {
    reeldown(&["run", PINNED, "--samples", "300", "--out", &place.at("first"), "--quiet"]);
    write(place, "base.toml", include_str!("../fixtures/habe/card.toml"));
    write(
        place,
        "card.toml",
        "[[joint]]\nfile = \"first/outcomes.parquet\"\nknown = \"never\"\nsource = \"a run\"\n",
    );
    write(place, "study.toml", STUDY);
}

#[test]
fn property_a_run_draws_rows_of_a_parquet_file_and_replays_them() {
    let place = Place::new("together");
    of_an_earlier_run(&place);
    let study = place.at("study.toml");
    let checked = reeldown(&["check", &study, "--json"]).ended_with(0).json();
    let laws: Vec<&str> = checked["inputs"]
        .as_array()
        .expect("inputs")
        .iter()
        .filter_map(|i| i["uncertain"]["law"].as_str())
        .collect();
    assert!(
        laws.iter().all(|law| law.contains("from the 300 rows of first/outcomes.parquet")),
        "{laws:?}"
    );
    let run = |threads: &str, out: &str| {
        reeldown(&["run", &study, "--threads", threads, "--out", &place.at(out), "--json"]).json()
    };
    let (one, two) = (run("1", "one"), run("2", "two"));
    assert_eq!(one, two);
    let factors = one["drivers"]["outputs"][0]["factors"].as_array().expect("factors");
    assert_eq!(factors.len(), 1, "drawn together, they are one factor: {factors:?}");
    assert_eq!(factors[0]["name"], "joint sample of 23 parameters (first/outcomes.parquet)");
    let table = place.at("one/outcomes.parquet");
    let sample = reeldown(&["replay", &table, "--index", "77", "--json"]).ended_with(0).json();
    // Its row is a row of the first run: the time is one that the first run has seen.
    let first = place.at("first/outcomes.parquet");
    let seen = (0..300).any(|k| {
        let earlier = reeldown(&["replay", &first, "--index", &k.to_string(), "--json"]).json();
        earlier["time_s"] == sample["time_s"]
            && earlier["initial_temperature_k"] == sample["initial_temperature_k"]
    });
    assert!(seen, "{sample}");
    // Another file under the same name: replay refuses.
    reeldown(&[
        "run",
        PINNED,
        "--samples",
        "299",
        "--seed",
        "2",
        "--out",
        &place.at("first"),
        "--quiet",
    ]);
    let refused = reeldown(&["replay", &table, "--index", "77"]).ended_with(1);
    assert!(refused.err.contains("is another one"), "{}", refused.err);
}

#[test]
fn property_csv_with_units_is_the_same_sample_in_si() {
    let place = Place::new("together-csv");
    write(&place, "base.toml", include_str!("../fixtures/habe/card.toml"));
    write(&place, "study.toml", STUDY);
    let card = |file: &str| {
        format!(
            "[[joint]]\nfile = \"{file}\"\nknown = \"never\"\nsource = \"test\"\ngroup = \"g\"\n"
        )
    };
    write(
        &place,
        "si.csv",
        "thermal.fluid_capacity [J/K],initial.temperature [K]\n4000,288.15\n3900,290.15\n4100,280.15\n",
    );
    write(
        &place,
        "units.csv",
        "initial.temperature [°C],\"thermal.fluid_capacity [kJ/K]\"\n15,4\n17,3.9\n7,4.1\n",
    );
    let digest = |file: &str| {
        write(&place, "card.toml", &card(file));
        let answer = reeldown(&["check", &place.at("study.toml"), "--json"]).ended_with(0).json();
        answer["study_digest"].clone()
    };
    assert_eq!(digest("si.csv"), digest("units.csv"));
    // A digest of the file that is not its own.
    write(&place, "card.toml", &format!("{}sha256 = \"{}\"\n", card("si.csv"), "0".repeat(64)));
    let refused = reeldown(&["check", &place.at("study.toml")]).ended_with(1);
    assert!(
        refused.err.contains("si.csv does not match the stated SHA-256; its own is "),
        "{}",
        refused.err
    );
}

#[test]
fn property_a_calibrated_card_tells_what_it_changed() {
    let place = Place::new("together-calibrated");
    write(&place, "base.toml", include_str!("../fixtures/habe/card.toml"));
    let rows: String = (0..200)
        .map(|k| format!("{},{}\n", 0.93 + 0.0002 * f64::from(k), 3900.0 + 0.3 * f64::from(k)))
        .collect();
    write(&place, "post.csv", &format!("fluid.shear_factor,thermal.fluid_capacity [J/K]\n{rows}"));
    write(
        &place,
        "card.toml",
        "calibrated_from = \"two runs\"\n[[joint]]\nfile = \"post.csv\"\nknown = \"never\"\nsource = \"test\"\n",
    );
    write(&place, "study.toml", &STUDY.replace("samples = 512", "samples = 4000"));
    let study = place.at("study.toml");
    let run = |out: &str| {
        let small = "epistemic={ outer = 400, inner = 32 }";
        reeldown(&["run", &study, "--set", small, "--out", &place.at(out), "--json"]).json()
    };
    let found = run("one");
    let calibrated = &found["calibrated"];
    assert_eq!(calibrated["calibrated_from"], "two runs");
    let moved = calibrated["moved"].as_array().expect("moved inputs");
    assert_eq!(moved.len(), 2);
    // A fluid thinner by 5 % of 8 %: the mean moves by 0.6 prior deviations, and P(any breach) falls.
    assert_eq!(moved[0]["path"], "fluid.shear_factor");
    let shift = moved[0]["shift"].as_f64().expect("a shift");
    assert!((-0.7..-0.5).contains(&shift), "{shift}");
    let events = calibrated["events"].as_array().expect("events");
    let value =
        |which: &str| events.last().expect("any")[which]["value"].as_f64().expect("a probability");
    assert!(value("posterior") < value("prior") - 0.05, "{events:?}");
    // Before: what the shipped card alone gives, with the same seed.
    write(
        &place,
        "alone.toml",
        &STUDY.replace("samples = 512", "samples = 4000").replace(", \"card.toml\"", ""),
    );
    let alone = reeldown(&[
        "run",
        &place.at("alone.toml"),
        "--set",
        "epistemic.outer=0",
        "--out",
        &place.at("alone"),
        "--json",
    ])
    .json();
    let any = alone["probabilities"]
        .as_array()
        .expect("events")
        .iter()
        .find(|p| p["title"] == "any limit");
    assert_eq!(any.expect("any")["probability"].as_f64(), Some(value("prior")));
    // The band is narrower, and the unknowns are told apart from what varies.
    let band = |which: &str| {
        let ends = events.last().expect("any")[which].as_array().expect("a band").clone();
        ends[1].as_f64().expect("an end") - ends[0].as_f64().expect("an end")
    };
    assert!(band("posterior_band") < band("prior_band"));
    assert_eq!(found["epistemic"]["varying"][0], "initial.temperature");
    let report = std::fs::read_to_string(place.path().join("one/report.md")).expect("a report");
    assert!(
        report.contains("## What did the calibration change?") && report.contains("p-box-time.svg")
    );
    assert_eq!(run("two"), found, "the same bytes again");
}

#[test]
fn regression_a_row_without_a_number_names_file_column_row_and_what_was_expected() {
    let place = Place::new("together-gaps");
    write(&place, "base.toml", include_str!("../fixtures/habe/card.toml"));
    write(&place, "study.toml", STUDY);
    let refused = |file: &str| {
        let card = format!("[[joint]]\nfile = \"{file}\"\nknown = \"never\"\nsource = \"test\"\n");
        write(&place, "card.toml", &card);
        reeldown(&["check", &place.at("study.toml")]).ended_with(1).err
    };
    write(&place, "text.csv", "fluid.shear_factor\n1.0\nthin\n");
    write(&place, "empty.csv", "fluid.shear_factor,note\n1.0,a\n1.1,b\n,c\n");
    let numbers = Field::Number(vec![Some(1.0), Some(1.1), None]);
    let null = place.path().join("null.parquet");
    write_table(&null, vec![("fluid.shear_factor".to_owned(), numbers)], Vec::new())
        .expect("a table");
    let texts = Field::Text(vec![Some("thin".to_owned()), Some("thick".to_owned())]);
    let text = place.path().join("text.parquet");
    write_table(&text, vec![("fluid.shear_factor".to_owned(), texts)], Vec::new())
        .expect("a table");
    for (file, found) in [
        ("text.csv", "line 3: \"thin\" is not a finite number"),
        ("empty.csv", "line 4: \"\" is not a finite number"),
        ("null.parquet", "column \"fluid.shear_factor\": row 3 is null"),
        ("text.parquet", "it holds text, not numbers"),
    ] {
        let message = refused(file);
        let expected = "expected a finite number in every row of the column";
        for part in [file, "column \"fluid.shear_factor\"", found, expected] {
            assert!(message.contains(part), "{file}: {part}: {message}");
        }
    }
}

#[test]
fn regression_rare_breaches_of_joint_samples_say_why_there_is_no_estimate() {
    let place = Place::new("together-rare");
    let study = concat!(env!("CARGO_MANIFEST_DIR"), "/reports/calibrated/study.toml");
    let mut arguments = vec!["run", study, "--samples", "400"];
    for set in ["sensitivity.base_samples=0", "trade.samples=0", "epistemic.outer=0"] {
        arguments.extend(["--set", set]);
    }
    let out = place.at("run");
    arguments.extend(["--out", &out]);
    let answer = reeldown(&arguments).ended_with(3);
    let words = answer.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(!words.contains("none none"), "{}", answer.out);
    for why in [
        "above 450 °F: no estimate sharper than the samples' own. No interval from subset simulation: ",
        "No interval from importance sampling: no design-point search converged",
    ] {
        assert!(words.contains(why), "{}", answer.out);
    }
}
