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
    place.write("card.toml", include_str!("../../distributions/habe.toml"));
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
    assert!(report.contains("No fair shares of a breach: "), "{report}");
    assert!(report.contains("No ranking: ") && !report.contains("figures/drivers-breach-any"));
    assert!(
        report.contains(
            "how much is settled and what P(any breach) then is cannot be told: it happened with"
        ),
        "{report}"
    );
    assert!(
        report.contains("at the limit 450 °F every descent with every set of constants has less.")
    );
    for (k, _) in report.match_indices("between ") {
        let ends: Vec<&str> = report[k + 8..].split(" and ").take(2).collect();
        let [low, rest] = ends.as_slice() else { continue };
        assert!(!rest.starts_with(low), "between {low} and {low}");
    }
    // No set of values saw the fluid too hot: the exact bound over the 200 sets, not a bare zero.
    let row = |line: &&str| line.starts_with("| peak fluid temperature above 450 °F | 0 (0 … 1.8");
    assert!(report.lines().any(|line| row(&line)), "{report}");
}
