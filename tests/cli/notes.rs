//! What a reader should know about how a study was understood is said by every command that it matters to.

use super::program::{Place, reeldown};

const SET: [&str; 2] = ["--set", "initial.temperature=40 °F"];
const NOTE: &str =
    "initial.temperature = 40 °F (--set) is the nominal value; samples follow the card's law";
/// Little of everything, so that the runs are short.
const SMALL: [&str; 8] = [
    "--set",
    "sensitivity.base_samples=0",
    "--set",
    "trade.samples=0",
    "--set",
    "epistemic.outer=0",
    "--set",
    "reliability.methods=[]",
];

#[test]
fn regression_a_nominal_value_that_moves_no_sample_is_said_on_the_terminal() {
    let place = Place::new("notes");
    let (moved, plain) = (place.at("moved"), place.at("plain"));
    let run = |out: &str, set: &[&str]| {
        let arguments = ["run", "--samples", "200", "--out", out];
        reeldown(&[&arguments, set, &SMALL[..6]].concat()).ended_with(3)
    };
    assert!(run(&moved, &SET).err.contains(NOTE));
    assert!(!run(&plain, &[]).err.contains("note:"));
    let compared = reeldown(&["compare", &plain, &moved]).ended_with(0);
    let words = compared.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains(NOTE), "{}", compared.out);
    let sweep = ["sweep", "--nominal", "--over", "brake.gap=0.06in..0.064in:2", "--out"];
    let swept = reeldown(&[&sweep[..], &[&place.at("sweep")], &SET].concat()).ended_with(0);
    assert!(swept.err.contains(NOTE), "{}", swept.err);
    let tighten = ["tighten", "--target", "0.9", "--move", "none", "--set", "tighten.samples=500"];
    assert!(reeldown(&[&tighten[..], &SET].concat()).err.contains(NOTE));
    assert!(reeldown(&[&["rig", "--compare"][..], &SET].concat()).ended_with(0).err.contains(NOTE));
}
