//! Correlations of a card, and marks in its texts, from `check` to the report.

use super::program::{Place, reeldown};
use serde_json::Value;

const STUDY: &str = "title = \"Brake | <b>two</b>\\nlines `code` and `\"\ncard = [\"base.toml\", \"card.toml\"]\n\
    [limits]\ntime = { max = \"210 s\" }\n[sampling]\nsamples = 400\n[sensitivity]\nbase_samples = 0\n\
    [trade]\nsamples = 0\n[epistemic]\nouter = 0\n";

const CARD: &str = "[initial.temperature]\nlaw = \"normal\"\nmean = \"60 °F\"\nsd = \"10 °F\"\n\
    known = \"on the day\"\nsource = \"\"\"weather | <b>of\nthe day</b> and `\"\"\"\n\
    [[correlation]]\nbetween = [\"thermal.fluid_capacity\", \"thermal.rotor_capacity\"]\nspearman = 0.6\n\
    source = \"a guess\"\n\
    [[correlation]]\nbetween = [\"brake.gap\", \"brake.gap\"]\nnormal = 0.25\nsource = \"one tool\"\n";

fn study(place: &Place) -> String {
    place.write("base.toml", include_str!("../fixtures/habe/card.toml"));
    place.write("card.toml", CARD);
    place.write("study.toml", STUDY)
}

fn report(place: &Place, name: &str) -> String {
    String::from_utf8(place.bytes(&format!("run/{name}"))).expect("text")
}

#[test]
fn regression_correlations_are_shown_wherever_the_inputs_are() {
    let place = Place::new("correlations");
    let study = study(&place);
    let checked = reeldown(&["check", &study]).ended_with(0);
    for text in [
        "thermal.fluid_capacity and thermal.rotor_capacity: spearman 0.6 (0.618 between normal scores",
        "91 pairs of surfaces of brake.gap: normal 0.25",
    ] {
        assert!(checked.out.contains(text), "{}", checked.out);
    }
    let shown = reeldown(&["check", "--json", &study]).ended_with(0).json();
    reeldown(&["run", &study, "--out", &place.at("run"), "--quiet"]).ended_with(0);
    let findings: Value = serde_json::from_str(&report(&place, "findings.json")).expect("JSON");
    // 2 sin(π ρ/6) of Spearman's ρ (Kruskal, 1958).
    let expected = 2.0 * (std::f64::consts::PI * 0.6 / 6.0).sin();
    for tree in [&shown, &findings] {
        let [gaps, capacities] = tree["correlations"].as_array().expect("a list").as_slice() else {
            panic!("two correlations: {}", tree["correlations"]);
        };
        assert_eq!((&gaps["pairs"], &gaps["kind"]), (&Value::from(91), &Value::from("normal")));
        assert_eq!(capacities["between"][1], "thermal.rotor_capacity");
        assert_eq!(
            (&capacities["kind"], &capacities["coefficient"]),
            (&"spearman".into(), &0.6.into())
        );
        let normal = capacities["normal_correlation"].as_f64().expect("a number");
        assert!((normal - expected).abs() < 1e-12, "{normal}");
    }
    for name in ["report.md", "report.html"] {
        let text = report(&place, name);
        for part in ["thermal.fluid_capacity and thermal.rotor_capacity", "spearman 0.6", "a guess"]
        {
            assert!(text.contains(part), "{name}: {part}");
        }
        assert!(text.contains("the inputs are not independent of each other: 92 pairs are correlated by a Gaussian copula"), "{name}");
    }
}

#[test]
fn regression_marks_in_a_card_do_not_break_tables() {
    let place = Place::new("marks");
    let study = study(&place);
    reeldown(&["run", &study, "--out", &place.at("run"), "--quiet"]).ended_with(0);
    let (markdown, html) = (report(&place, "report.md"), report(&place, "report.html"));
    assert!(
        markdown.starts_with("# Brake \\| &lt;b>two&lt;/b> lines `code` and \\`\n"),
        "{markdown}"
    );
    let row = markdown.lines().find(|line| line.contains("weather")).expect("the input's row");
    assert!(row.contains("weather \\| &lt;b>of the day&lt;/b> and \\` |"), "{row}");
    for page in [&markdown, &html] {
        assert!(!page.contains("<b>"), "markup of a card's text passes");
    }
    // Every table has as many cells in each row as in its header.
    let cells = |line: &str| line.replace("\\|", "").matches('|').count();
    let lines: Vec<&str> = markdown.lines().collect();
    for pair in lines.windows(2).filter(|pair| pair.iter().all(|line| line.starts_with('|'))) {
        assert_eq!(cells(pair[0]), cells(pair[1]), "{}\n{}", pair[0], pair[1]);
    }
}
