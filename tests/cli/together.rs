//! Joint samples in cards: from CSV and Parquet, replayed, and refused when the file is another.

use super::program::{Place, reeldown};

const STUDY: &str = "title = \"joint\"\ncard = [\"base.toml\", \"card.toml\"]\n\
    [limits]\ntime = { max = \"210 s\" }\n[sampling]\nsamples = 512\n[sensitivity]\nbase_samples = 64\n\
    bootstrap = 100\n[trade]\nsamples = 100\n";

fn write(place: &Place, name: &str, text: &str) {
    std::fs::write(place.path().join(name), text).expect("a file");
}

/// A study whose inputs are drawn from an earlier run's own table of samples.
fn of_an_earlier_run(place: &Place) {
    reeldown(&["run", "--samples", "300", "--out", &place.at("first"), "--quiet"]);
    write(place, "base.toml", include_str!("../../distributions/habe.toml"));
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
    reeldown(&["run", "--samples", "299", "--seed", "2", "--out", &place.at("first"), "--quiet"]);
    let refused = reeldown(&["replay", &table, "--index", "77"]).ended_with(1);
    assert!(refused.err.contains("is another one"), "{}", refused.err);
}

#[test]
fn property_csv_with_units_is_the_same_sample_in_si() {
    let place = Place::new("together-csv");
    write(&place, "base.toml", include_str!("../../distributions/habe.toml"));
    write(&place, "study.toml", STUDY);
    let card = |file: &str| {
        format!(
            "[[joint]]\nfile = \"{file}\"\nknown = \"never\"\nsource = \"test\"\ngroup = \"g\"\n"
        )
    };
    write(
        &place,
        "si.csv",
        "thermal.fluid_capacity,initial.temperature\n4000,288.15\n3900,290.15\n4100,280.15\n",
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
    assert!(refused.err.contains("si.csv is another file: its SHA-256 is "), "{}", refused.err);
}
