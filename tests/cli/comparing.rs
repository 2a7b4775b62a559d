//! What changed between two runs, from their directories.

use super::program::{Answer, Place, reeldown};
use serde_json::Value;

const QUICK: &[&str] = &["--quiet", "--set", "trade.samples=0"];

fn run(place: &Place, name: &str, arguments: &[&str]) -> String {
    let out = place.at(name);
    let small = ["run", "--out", &out, "--set", "sensitivity.base_samples=64"];
    let answer = reeldown(&[&small, QUICK, arguments].concat());
    assert!([0, 3, 4].contains(&answer.code), "{}", answer.err);
    out
}

fn compare(before: &str, after: &str) -> Value {
    reeldown(&["compare", before, after, "--json"]).ended_with(0).json()
}

fn event<'v>(finding: &'v Value, name: &str) -> &'v Value {
    let events = finding["probabilities"].as_array().expect("events");
    events.iter().find(|event| event["event"] == name).expect("the event")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("a number: {value}"))
}

#[test]
fn property_one_seed_is_compared_row_by_row() {
    let place = Place::new("compare-paired");
    let before = run(&place, "a", &["--samples", "2000"]);
    let set = [
        "--samples",
        "3000",
        "--set",
        "fluid.nominal_viscosity=103000 cSt",
        "--set",
        "brake.gap.sd=0.002 in",
        "--set",
        "limits.time.max=205 s",
    ];
    let after = run(&place, "b", &set);
    let found = compare(&before, &after);
    assert_eq!(found["paired"], true);
    assert!(found["pairing"].as_str().expect("words").contains("The first 2000 rows"));
    let changed: Vec<&str> = found["changes"]
        .as_array()
        .expect("changes")
        .iter()
        .filter_map(|change| change["what"].as_str())
        .collect();
    assert_eq!(changed, ["fluid.nominal_viscosity", "brake.gap", "time", "samples"]);
    // The difference over the rows that both have is that of their counts there.
    let shorter = run(&place, "c", &[&set[2..], &["--samples", "2000"]].concat());
    let findings: Vec<Value> = ["a", "c"]
        .iter()
        .map(|name| {
            serde_json::from_slice(&place.bytes(&format!("{name}/findings.json"))).expect("JSON")
        })
        .collect();
    let breaches = |findings: &Value| {
        let all = findings["probabilities"].as_array().expect("events");
        number(&all.iter().find(|e| e["kind"] == "any").expect("any")["counts"]["breaches"])
    };
    let any = event(&found, "any");
    let expected = (breaches(&findings[1]) - breaches(&findings[0])) / 2000.0;
    assert!((number(&any["difference"]["value"]) - expected).abs() < 1e-12, "{any}");
    let [gained, lost] = [0, 1].map(|k| number(&any["disagreeing"][k]));
    assert!(((gained - lost) / 2000.0 - expected).abs() < 1e-12 && lost > gained);
    assert!(number(&any["difference"]["interval"]["upper"]) < 0.0, "thinner fluid helps: {any}");
    assert_eq!(compare(&before, &shorter)["probabilities"][0]["difference"], any["difference"]);

    let text = reeldown(&["compare", &before, &after]).ended_with(0).out;
    for part in [
        "P(any breach) fell from",
        "125000 cSt",
        "103000 cSt",
        "max 210 s",
        "max 205 s",
        "common random numbers",
        "driver of any breach",
    ] {
        assert!(text.contains(part), "no {part:?} in\n{text}");
    }
    let report = place.at("compare.md");
    reeldown(&["compare", &before, &after, "--markdown", &report]).ended_with(0);
    let report = String::from_utf8(place.bytes("compare.md")).expect("UTF-8");
    for part in ["# What changed", "## What was changed", "## What margin is left", "Paired:"] {
        assert!(report.contains(part), "no {part:?} in\n{report}");
    }
    for word in ["NaN", "None", "Some("] {
        assert!(!report.contains(word) && !text.contains(word), "{word} in\n{report}{text}");
    }
}

#[test]
fn property_pairing_narrows_the_interval_and_other_seeds_are_not_paired() {
    let place = Place::new("compare-unpaired");
    let set = ["--set", "fluid.nominal_viscosity=120000 cSt"];
    let before = run(&place, "a", &["--samples", "2000"]);
    let paired = compare(&before, &run(&place, "b", &[&set[..], &["--samples", "2000"]].concat()));
    let other = run(&place, "c", &[&set[..], &["--samples", "2000", "--seed", "7"]].concat());
    let unpaired = compare(&before, &other);
    assert_eq!((&paired["paired"], &unpaired["paired"]), (&true.into(), &false.into()));
    let method = &event(&unpaired, "any")["difference"]["interval"]["method"];
    assert_eq!(method, "Newcombe, independent samples");
    let width = |finding: &Value| {
        let interval = &event(finding, "time")["difference"]["interval"];
        number(&interval["upper"]) - number(&interval["lower"])
    };
    assert!(width(&paired) < 0.6 * width(&unpaired), "{} {}", width(&paired), width(&unpaired));
    // A run against itself has not changed.
    let same = compare(&before, &before);
    assert_eq!(same["changes"].as_array().map(Vec::len), Some(0));
    assert_eq!(number(&event(&same, "any")["difference"]["value"]), 0.0);
    let text = reeldown(&["compare", &before, &before]).ended_with(0).out;
    assert!(
        text.contains("state the same") && text.contains("not shown to have changed"),
        "{text}"
    );
    // Replicates of one design are paired, other designs are not, and have no interval.
    let sobol =
        ["--set", "sampling.design=sobol", "--set", "sampling.replicates=8", "--samples", "2048"];
    let one = run(&place, "d", &sobol);
    let two = run(&place, "e", &[&sobol[..], &set].concat());
    let replicated = compare(&one, &two);
    let difference = &event(&replicated, "any")["difference"];
    assert_eq!(
        difference["interval"]["method"],
        "Student t over replicates, common random numbers"
    );
    let mixed = compare(&before, &two);
    assert_eq!(mixed["paired"], false);
    assert!(event(&mixed, "any")["difference"]["interval"]["none"].is_string(), "{mixed:#}");
}

#[test]
fn property_what_is_no_run_is_said() {
    let place = Place::new("compare-mistakes");
    let good = run(&place, "good", &["--samples", "200"]);
    let says = |directory: &str, parts: &[&str]| {
        let answer: Answer = reeldown(&["compare", &good, directory]).ended_with(1);
        assert_eq!(answer.out, "");
        for part in parts {
            assert!(answer.err.contains(part), "no {part:?} in\n{}", answer.err);
        }
    };
    says(&place.at("nowhere"), &["nowhere", "no such directory"]);
    std::fs::create_dir(place.path().join("empty")).expect("a directory");
    says(&place.at("empty"), &["no finished run", "findings.json"]);
    let bad = |name: &str, findings: &[u8], table: &[u8]| -> String {
        std::fs::create_dir(place.path().join(name)).expect("a directory");
        place.write(&format!("{name}/findings.json"), findings);
        place.write(&format!("{name}/outcomes.parquet"), table);
        place.at(name)
    };
    let (findings, table) =
        (place.bytes("good/findings.json"), place.bytes("good/outcomes.parquet"));
    says(&bad("text", b"hello", &table), &["not JSON"]);
    says(&bad("other", b"{}", &table), &["of reeldown an unknown version"]);
    let text = String::from_utf8(findings.clone()).expect("UTF-8");
    let version = format!("\"version\": \"{}\"", env!("CARGO_PKG_VERSION"));
    let old = text.replace(&version, "\"version\": \"0.0.1\"");
    says(&bad("old", old.as_bytes(), &table), &["of reeldown 0.0.1", "run its study again"]);
    says(&bad("damaged", &findings, &table[..table.len() / 2]), &["outcomes.parquet"]);
    let shorter = run(&place, "shorter", &["--samples", "100"]);
    let shorter = std::fs::read(format!("{shorter}/outcomes.parquet")).expect("a table");
    says(&bad("mixed", &findings, &shorter), &["of different runs", "--resume"]);
    reeldown(&["compare", &good]).ended_with(2);
}
