//! Mistakes in studies and cards: one message each, with the place, what was expected and what is near.

use super::program::{Answer, Place, reeldown};

/// What is answered to a study and a card with one mistake.
#[track_caller]
fn answer(place: &Place, study: &str, card: &str) -> Answer {
    let answer = answer_to_mistakes(place, study, card);
    let errors = answer.err.matches("error: ").count();
    assert_eq!(errors, 1, "one message: {}", answer.err);
    answer
}

/// What is answered to a study and a card with mistakes.
fn answer_to_mistakes(place: &Place, study: &str, card: &str) -> Answer {
    place.write("card.toml", card);
    let study = place.write("bad.toml", study);
    let out = place.at("run");
    let answer = reeldown(&["run", "--samples", "20", "--out", &out, &study]).ended_with(1);
    assert_eq!(answer.out, "");
    assert!(!place.path().join("run").exists(), "nothing is written for a study that cannot run");
    // The same mistake is found by whatever reads the study.
    for command in ["check", "descend"] {
        let other = reeldown(&[command, &study]).ended_with(1);
        assert_eq!(other.err, answer.err, "{command}");
    }
    answer
}

#[track_caller]
fn assert_says(answer: &Answer, parts: &[&str]) {
    for part in parts {
        assert!(answer.err.contains(part), "{part:?} is missing in\n{}", answer.err);
    }
}

const CARD: &str = include_str!("../fixtures/habe/card.toml");

#[test]
fn property_an_unknown_key_names_the_nearest() {
    let place = Place::new("unknown");
    let study = "title = \"x\"\ncard = \"card.toml\"\n[design]\n\"fluid.viscosity\" = 0.1\n";
    assert_says(
        &answer(&place, study, CARD),
        &["bad.toml:4:1", "unknown design key `fluid.viscosity`", "did you mean `fluid."],
    );
    let study = "title = \"x\"\ncard = \"card.toml\"\nlimit = 1\n";
    assert_says(&answer(&place, study, CARD), &["bad.toml:3:1", "did you mean `limits`?"]);
    let card = "title = \"x\"\n[brake.gab]\nlaw = \"normal\"\nmean = 1\nsd = 1\n";
    let study = "title = \"x\"\ncard = \"card.toml\"\n";
    assert_says(&answer(&place, study, card), &["card.toml:2:", "did you mean `brake.gap`?"]);
}

#[test]
fn property_a_wrong_unit_and_an_impossible_value_show_the_place() {
    let place = Place::new("values");
    let study = "title = \"x\"\ncard = \"card.toml\"\n[limits]\ntime = { max = \"210 kg\" }\n";
    assert_says(&answer(&place, study, CARD), &["bad.toml:4:21", "`kg`", "expected a time"]);
    let study = "title = \"x\"\ncard = \"card.toml\"\n[design]\n\"brake.gap\" = \"-1 mm\"\n";
    assert_says(&answer(&place, study, CARD), &["bad.toml:4:15", "impossible", "expected"]);
    let study = "title = \"x\"\ncard = \"card.toml\"\n[design]\nbrake.inner_radius = \"20 in\"\n";
    assert_says(&answer(&place, study, CARD), &["bad.toml:4:22", "brake.outer_radius"]);
}

#[test]
fn property_malformed_toml_shows_the_place() {
    let place = Place::new("malformed");
    let study = "title = \"x\"\n[limits\ntime = 3\n";
    assert_says(&answer(&place, study, CARD), &["bad.toml:2:8"]);
    let study = "title = \"x\"\ncard = \"card.toml\"\n";
    assert_says(&answer(&place, study, "[brake.gap\n"), &["card.toml:1:11"]);
}

#[test]
fn property_missing_files_are_named() {
    let place = Place::new("missing");
    let study = "title = \"x\"\ncard = \"nowhere.toml\"\n";
    assert_says(&answer(&place, study, CARD), &["bad.toml:2:8", "nowhere.toml", "no such file"]);
    let absent = reeldown(&["run", &place.at("absent.toml")]).ended_with(1);
    assert_says(&absent, &["cannot read", "absent.toml", "no such file", "help: name a study"]);
    let directory = reeldown(&["check", &place.at("")]).ended_with(1);
    assert_says(&directory, &["it is a directory"]);
    let bytes = place.write("bytes.toml", [0xff, 0xfe, 0x00]);
    assert_says(&reeldown(&["check", &bytes]).ended_with(1), &["not UTF-8"]);
}

#[test]
fn property_a_correlation_that_cannot_be_names_the_pair() {
    let place = Place::new("correlation");
    let names = ["thermal.fluid_capacity", "thermal.rotor_capacity", "thermal.housing_capacity"];
    let mut card = CARD.to_owned();
    for (a, b, value) in [(0, 1, "0.9"), (1, 2, "0.9"), (0, 2, "-0.9")] {
        card += &format!(
            "\n[[correlation]]\nbetween = [\"{}\", \"{}\"]\nnormal = {value}\nsource = \"test\"\n",
            names[a], names[b]
        );
    }
    let study = "title = \"x\"\ncard = \"card.toml\"\n";
    let answer = answer(&place, study, &card);
    assert_says(&answer, &["card.toml:", "positive definite", "thermal."]);
}

#[test]
fn property_a_mistake_on_the_command_line_shows_the_option() {
    let cases = [
        (&["--set", "initial.temperatur=40 °F"][..], "did you mean `initial.temperature`?"),
        (&["--set", "initial.temperature"], "--set:1:"),
        (&["--set", "initial.temperature=40 m"], "expected a temperature"),
        (&["--set", "limits.time.max=soon"], "--set:1:17"),
        (&["--set", "sampling.samples=0"], "--set:1:18"),
        (&["--samples", "-5"], "-5"),
        (&["--seed", "x"], "--seed:1:15"),
        (&["--set", ""], "--set"),
    ];
    for (arguments, part) in cases {
        let answer = reeldown(&[&["run"], arguments].concat());
        assert!([1, 2].contains(&answer.code), "{arguments:?}: {}", answer.code);
        assert_says(&answer, &[part, "error: "]);
        assert_eq!(answer.out, "");
    }
}

#[test]
fn property_a_study_without_uncertainty_says_what_to_do() {
    let place = Place::new("certain");
    let study = place.write("certain.toml", "title = \"x\"\n");
    let out = place.at("run");
    let answer = reeldown(&["run", &study, "--out", &out]).ended_with(1);
    assert_says(&answer, &["certain.toml:1:1", "lacks the key `card`", "what is uncertain"]);
}

#[test]
fn regression_a_misspelt_command_is_told_from_a_study() {
    let answer = reeldown(&["chek"]).ended_with(1);
    assert_says(&answer, &["no command and no study file called chek", "`reeldown check`"]);
    let answer = reeldown(&["xyz"]).ended_with(1);
    assert_says(&answer, &["the commands are run, plan"]);
    // What can only be a file is one.
    assert_says(&reeldown(&["chek.toml"]).ended_with(1), &["cannot read chek.toml: no such file"]);
}

#[test]
fn property_all_mistakes_of_a_study_are_shown_at_once() {
    let place = Place::new("mistakes");
    let study = "title = \"x\"\ncard = \"card.toml\"\n[design]\nbrake.gap = 0.062\n[limits]\n\
                 time = { max = 210 }\n[sampling]\nsampels = 5\n";
    let parts =
        ["bad.toml:4:13", "bad.toml:6:16", "bad.toml:8:1", "did you mean `samples`?", "3 mistakes"];
    assert_says(&answer_to_mistakes(&place, study, CARD), &parts);
}

#[test]
fn regression_a_number_without_its_unit_is_one_clear_error() {
    let place = Place::new("kelvin");
    let set = ["--set", "initial.temperature=40"];
    let over = ["--nominal", "--over", "initial.temperature=40..300:3"];
    let moved = ["--move", "fluid.nominal_viscosity=90000..140000"];
    let commands = [&["descend"][..], &["check"], &["run"], &["rig", "--force", "6000 lbf"]]
        .map(|c| (c, &set[..], "40", "°F"));
    let others = [
        (&["sweep"][..], &over[..], "300", "°F"),
        (&["tighten"], &moved[..], "90000", "cSt"),
        (&["rig"], &["--force", "6000"], "6000", "lbf"),
        (&["rig", "--force", "6000 lbf"], &["--set", "limits.time.max=210"], "210", "s"),
    ];
    for (command, option, number, unit) in commands.into_iter().chain(others) {
        let answer = reeldown(&[command, option].concat()).ended_with(1);
        let parts = [format!("{number} has no unit"), format!("write \"{number} {unit}\"")];
        assert_says(&answer, &parts.each_ref().map(String::as_str));
    }
    let study = "title = \"x\"\ncard = \"card.toml\"\n[design]\ninitial.temperature = 60\n";
    assert_says(&answer(&place, study, CARD), &["bad.toml:4:23", "60 has no unit"]);
    let study = "title = \"x\"\ncard = \"card.toml\"\n";
    let card = CARD.replace("mean = \"60 °F\"", "mean = 60");
    assert_ne!(card, CARD);
    assert_says(&answer(&place, study, &card), &["card.toml:", "60 has no unit"]);
    // With a unit at one end a range has that at both; what is written out is taken, and a fault then says
    // what is far from the usual.
    let fault = reeldown(&["descend", "--set", "initial.temperature=40 K"]).ended_with(1);
    assert_says(
        &fault,
        &["step-too-small", "initial.temperature = -387.67 °F (40 K) is farthest", "60 °F"],
    );
}
