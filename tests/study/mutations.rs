//! No text makes the parser panic, and every refusal points into its text.
//!
//! Random edits of the shipped study and card: bytes changed, stretches deleted or doubled, lines of
//! the corpus put in, numbers replaced. A case that ever failed is kept in the corpus.

use super::sources::{card_alone, shipped, study_with};
use proptest::prelude::*;
use reeldown::error::{Error, Result};
use reeldown::study::{EMBEDDED_CARD, EMBEDDED_STUDY, Override, Study};
use reeldown::units::{Quantity, parse};
use std::sync::LazyLock;

/// Lines of the corpus and of the good texts, as material.
static LINES: LazyLock<Vec<String>> = LazyLock::new(|| {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/study");
    let mut lines = Vec::new();
    for directory in ["corpus", "accepted"] {
        let mut files: Vec<_> = std::fs::read_dir(root.join(directory))
            .expect("a directory")
            .map(|entry| entry.expect("an entry").path())
            .filter(|path| path.extension().is_some_and(|ending| ending == "toml"))
            .collect();
        files.sort();
        for file in files {
            let text = std::fs::read_to_string(file).expect("a text");
            lines.extend(text.lines().map(str::to_owned));
        }
    }
    lines.sort();
    lines.dedup();
    lines
});

#[derive(Debug, Clone)]
enum Edit {
    Put(usize, char),
    Delete(usize, usize),
    Double(usize, usize),
    Line(usize, usize),
    Number(usize, f64),
}

fn edits() -> impl Strategy<Value = Vec<Edit>> {
    let character = prop_oneof![
        prop::sample::select(
            "[]{}=\"'#.,\n\r\t\\-+_e°²µ·0179%/*^ \u{feff}\u{0}".chars().collect::<Vec<_>>()
        ),
        any::<char>(),
    ];
    let place = any::<usize>;
    let edit = prop_oneof![
        3 => (place(), character).prop_map(|(at, character)| Edit::Put(at, character)),
        2 => (place(), 1..12_usize).prop_map(|(at, length)| Edit::Delete(at, length)),
        1 => (place(), 1..200_usize).prop_map(|(at, length)| Edit::Double(at, length)),
        4 => (place(), place()).prop_map(|(at, line)| Edit::Line(at, line)),
        3 => (place(), prop_oneof![
            any::<f64>(),
            prop::sample::select(vec![0.0, -1.0, 1.0, 0.5, 1e300, 1e-300, f64::NAN, f64::INFINITY, 15.0]),
        ]).prop_map(|(at, number)| Edit::Number(at, number)),
    ];
    prop::collection::vec(edit, 1..6)
}

fn edited(text: &str, edits: &[Edit]) -> String {
    let mut characters: Vec<char> = text.chars().collect();
    for edit in edits {
        let length = characters.len();
        match *edit {
            Edit::Put(at, character) if length > 0 => characters[at % length] = character,
            Edit::Put(_, character) => characters.push(character),
            Edit::Delete(at, count) => {
                let from = at % (length + 1);
                characters.drain(from..(from + count).min(length));
            }
            Edit::Double(at, count) => {
                let from = at % (length + 1);
                let stretch = characters[from..(from + count).min(length)].to_vec();
                characters.splice(from..from, stretch);
            }
            Edit::Line(at, line) => {
                let mut ends: Vec<usize> =
                    (0..length).filter(|&k| characters[k] == '\n').map(|k| k + 1).collect();
                ends.push(length);
                let from = ends[at % ends.len()];
                let line = format!("{}\n", LINES[line % LINES.len()]);
                characters.splice(from..from, line.chars());
            }
            Edit::Number(at, number) => {
                let from = at % (length + 1);
                let is_digit = |k: &usize| characters[*k].is_ascii_digit();
                let Some(start) = (from..length).find(is_digit) else { continue };
                let end = (start..length).find(|k| !is_digit(k)).unwrap_or(length);
                characters.splice(start..end, format!("{number:?}").chars().collect::<Vec<_>>());
            }
        }
    }
    characters.into_iter().collect()
}

/// What holds of every answer.
fn check(answer: Result<Study>) -> std::result::Result<(), TestCaseError> {
    match answer {
        Ok(study) => {
            prop_assert!(study.validate().is_ok());
            prop_assert_eq!(study.digest(), study.clone().digest());
            prop_assert!(study.resolved().len() >= 32);
            prop_assert!(study.joint.dimension() == study.inputs.len());
        }
        Err(Error::Several(all)) => {
            prop_assert!(all.len() > 1);
            for one in all {
                prop_assert!(!matches!(one, Error::Several(_)));
                check(Err(one))?;
            }
        }
        Err(Error::Input(diagnostic)) => {
            let span = diagnostic.span.clone();
            prop_assert!(diagnostic.text.get(span.clone()).is_some(), "{span:?}: {diagnostic:?}");
            prop_assert!(!diagnostic.problem.is_empty() && !diagnostic.expected.is_empty());
            let (line, column) = diagnostic.position();
            prop_assert!(line >= 1 && column >= 1);
        }
        Err(other) => prop_assert!(false, "not a diagnostic: {other}"),
    }
    Ok(())
}

proptest! {
    // More with PROPTEST_CASES; 100 000 of each passed when this was written.
    #![proptest_config(ProptestConfig {
        cases: ProptestConfig::default().cases.max(500),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn property_an_edited_study_is_read_or_refused(edits in edits()) {
        let text = edited(EMBEDDED_STUDY, &edits);
        check(study_with(&text, "", &[]))?;
    }

    #[test]
    fn property_an_edited_card_is_read_or_refused(edits in edits()) {
        check(card_alone(&edited(EMBEDDED_CARD, &edits)))?;
    }

    #[test]
    fn property_an_edited_card_of_all_laws_is_read_or_refused(edits in edits()) {
        check(card_alone(&edited(include_str!("accepted/card_laws.toml"), &edits)))?;
    }

    #[test]
    fn property_an_edited_override_is_read_or_refused(edits in edits(), which in any::<usize>()) {
        let statements = [
            "initial.temperature=\"0 °F\"", "limits.time={max=\"210 s\"}", "brake.gap[3].sd=0.003 in",
            "card=[\"habe.toml\"]", "sampling.samples=1_000", "design=3", "limits.time.max=1 s",
        ];
        let statement = edited(statements[which % statements.len()], &edits);
        match Override::parse("--set", &statement) {
            Ok(_) => check(shipped(&[&statement]))?,
            Err(error) => check(Err(error))?,
        }
    }

    #[test]
    fn property_any_text_is_a_value_or_refused(text in "\\PC*", which in any::<usize>()) {
        let quantity = Quantity::ALL[which % Quantity::ALL.len()];
        match parse(&text, quantity) {
            Ok(value) => prop_assert!(value.is_finite()),
            Err(error) => prop_assert!(text.get(error.span.clone()).is_some(), "{error:?}"),
        }
    }

    #[test]
    fn property_an_edited_value_is_a_value_or_refused(edits in edits(), which in any::<usize>()) {
        let quantity = Quantity::ALL[which % Quantity::ALL.len()];
        let text = edited(quantity.example(), &edits);
        match parse(&text, quantity) {
            Ok(value) => prop_assert!(value.is_finite()),
            Err(error) => prop_assert!(text.get(error.span.clone()).is_some(), "{error:?}"),
        }
    }
}
