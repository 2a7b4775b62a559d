//! The JSON Schemas: kept as files, and judged by the Python package `jsonschema`.
//!
//! `references/judge_schemas.py` validates the schemas themselves, the shipped texts, the good ones and
//! the corpus, and writes `references/judgements.json`. After a change of the schemas,
//! `REELDOWN_WRITE_CORPUS=1 cargo test --test study` writes them anew; then run the script.

use reeldown::study::schema;
use serde_json::Value;
use std::path::{Path, PathBuf};

fn references() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/study/references")
}

fn recorded(name: &str) -> Value {
    let text = std::fs::read_to_string(references().join(name)).expect(name);
    serde_json::from_str(&text).expect(name)
}

#[test]
fn regression_the_schemas_are_those_that_were_judged() {
    for (name, schema) in
        [("study.schema.json", schema::study()), ("card.schema.json", schema::card())]
    {
        if std::env::var_os("REELDOWN_WRITE_CORPUS").is_some() {
            let text = serde_json::to_string_pretty(&schema).expect("JSON") + "\n";
            std::fs::write(references().join(name), text).expect("the references are writable");
        }
        assert_eq!(schema, recorded(name), "{name} is out of date: see the top of this file");
    }
}

#[test]
fn reference_jsonschema_accepts_good_texts_and_refuses_what_a_schema_can_see() {
    let judgements = recorded("judgements.json");
    let names = |key: &str| -> Vec<String> {
        let list = judgements[key].as_array().expect(key);
        list.iter().map(|name| name.as_str().expect("a name").to_owned()).collect()
    };
    let (accepted, refused) = (names("accepted"), names("refused"));
    for good in [
        "reports/habe/study.toml",
        "distributions/habe.toml",
        "tests/study/accepted/study_full.toml",
        "tests/study/accepted/study_until.toml",
        "tests/study/accepted/card_laws.toml",
        "tests/study/accepted/card_correlated_gaps.toml",
        "tests/study/accepted/card_joint.toml",
        "tests/study/accepted/card_readings.toml",
    ] {
        assert!(accepted.iter().any(|name| name == good), "{good} is not accepted");
    }
    // What needs no knowledge of units, files or other keys.
    for bad in [
        "study_unknown_key",
        "study_missing_title",
        "study_missing_card",
        "study_title_wrong_type",
        "study_model_unknown",
        "study_design_unknown_path",
        "study_design_no_unit",
        "study_design_wrong_type",
        "study_limit_unknown_outcome",
        "study_limit_not_a_table",
        "study_limit_empty",
        "study_limit_source_alone",
        "study_limit_source_number",
        "study_requirement_certain",
        "study_requirement_incomplete",
        "study_requirement_without_limits",
        "study_sampling_unknown_key",
        "study_sampling_unknown_design",
        "study_sampling_fraction",
        "study_reliability_unknown_method",
        "study_until_and_samples",
        "study_until_budget_none",
        "study_until_decided_false",
        "study_until_empty",
        "study_until_error_impossible",
        "study_until_not_a_table",
        "study_until_two_rules",
        "study_until_unknown_key",
        "study_until_without_budget",
        "study_trade_few_samples",
        "study_trade_unknown_key",
        "study_tighten_unknown_key",
        "study_tighten_target_certain",
        "study_tighten_not_a_range",
        "card_cost_text",
        "card_cost_negative",
        "card_cost_grade_wider",
        "card_cost_grade_without_cost",
        "card_unknown_input",
        "card_rotors",
        "card_law_missing",
        "card_law_unknown",
        "card_law_parameter_missing",
        "card_law_parameter_foreign",
        "card_law_parameter_too_many",
        "card_law_parameter_of_other_form",
        "card_known_unknown",
        "card_source_missing",
        "card_each_surface_elsewhere",
        "card_truncation_of_wrong_kind",
        "card_correlation_one",
        "card_correlation_two_coefficients",
        "card_correlation_no_coefficient",
    ] {
        let path = format!("tests/study/corpus/{bad}.toml");
        assert!(refused.contains(&path), "{bad} is not refused");
    }
}
