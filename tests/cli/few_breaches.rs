//! What a handful of breaches, or none, does not support is not said.

use super::program::{Place, reeldown};

/// About one descent in two thousand takes longer than 350 s, none in these runs gets as hot as 450 °F.
const STUDY: &str = "title = \"few\"\ncard = \"card.toml\"\n[limits]\ntime = { max = \"350 s\" }\n\
    peak_fluid_temperature = { max = \"450 °F\" }\n[sampling]\nsamples = 2000\nseed = 3\n\
    [sensitivity]\nbase_samples = 1024\nbootstrap = 100\n[trade]\nsamples = 200\n\
    [epistemic]\nouter = 200\ninner = 16\n";

#[test]
fn regression_a_handful_of_breaches_ranks_nothing_and_has_no_band() {
    let place = Place::new("few");
    place.write("card.toml", include_str!("../fixtures/habe/card.toml"));
    let study = place.write("study.toml", STUDY);
    let answer = reeldown(&["run", &study, "--out", &place.at("run")]).ended_with(0);
    let words = answer.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("Drivers of breach of any limit: No ranking:"), "{}", answer.out);
    assert!(!words.contains("driven most by"), "{}", answer.out);
    let json = String::from_utf8(place.bytes("run/findings.json")).expect("text");
    let findings: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    let outputs = findings["drivers"]["outputs"].as_array().expect("outputs");
    let any = outputs.iter().find(|output| output["name"] == "breach.any").expect("any breach");
    let why = any["too_few"].as_str().expect("a reason");
    assert!(why.contains("of 2048 descents breach: at least 10"), "{why}");
    assert!(outputs.iter().filter(|o| o["breach"] == false).all(|o| o["too_few"].is_null()));
    let report = String::from_utf8(place.bytes("run/report.md")).expect("text");
    assert!(report.contains("No Shapley effects of a breach: "), "{report}");
    assert!(report.contains("No ranking: ") && !report.contains("figures/drivers-breach-any"));
    assert!(
        report.contains(
            "the share of variance resolved and P(any breach) given it cannot be estimated: it happened with"
        ),
        "{report}"
    );
    assert!(
        report.contains("at the limit 450 °F every descent with every set of constants has less.")
    );
    for (k, _) in report.match_indices("between ") {
        let ends: Vec<&str> = report[k + 8..].split(" and ").take(2).collect();
        let [low, rest] = ends.as_slice() else { continue };
        let high = rest.split_whitespace().next().unwrap_or_default().trim_end_matches([',', '.']);
        assert_ne!(*low, high, "between {low} and {high}");
    }
    // No set of values saw the fluid too hot: the exact bound over the 200 sets, not a bare zero.
    let row = |line: &&str| line.starts_with("| peak fluid temperature above 450 °F | at most 1.8");
    assert!(report.lines().any(|line| row(&line)), "{report}");
}

/// At 150 s the medians breach: the design point is the nearest way not to. Importance sampling printed 100.4 % there.
#[test]
fn regression_where_the_medians_breach_no_way_not_to_is_called_the_most_likely_way_to() {
    let place = Place::new("medians-breach");
    place.write("card.toml", include_str!("../fixtures/habe/card.toml"));
    let study = "title = \"certain\"\ncard = \"card.toml\"\n[limits]\ntime = { max = \"150 s\" }\n\
        [sampling]\nsamples = 2000\n[reliability]\nmethods = [\"importance-sampling\", \"subset-simulation\"]\n\
        [sensitivity]\nbase_samples = 1024\nbootstrap = 100\n[trade]\nsamples = 200\n\
        [epistemic]\nouter = 200\ninner = 16\n";
    let study = place.write("study.toml", study);
    reeldown(&["run", &study, "--out", &place.at("run")]).ended_with(0);
    let json = String::from_utf8(place.bytes("run/findings.json")).expect("text");
    let findings: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    let rare = &findings["rare"][0];
    let estimates = rare["estimates"].as_array().expect("estimates");
    assert_eq!(estimates.len(), 3);
    for estimate in estimates {
        let of = |key: &str| estimate["interval"][key].as_f64().expect("an interval");
        let p = estimate["probability"].as_f64().expect("a probability");
        assert!(of("lower") <= p && p <= of("upper") && of("upper") <= 1.0, "{estimate}");
        assert!(of("lower") < of("upper"), "{estimate}");
    }
    assert_eq!(rare["agreement"]["agrees"], true);
    assert_eq!(rare["design_point"]["medians_breach"], true);
    let report = String::from_utf8(place.bytes("run/report.md")).expect("text");
    assert!(report.contains("The medians breach: with every input at its median"), "{report}");
    assert!(!report.contains("The most likely way to breach lies"), "{report}");
}
