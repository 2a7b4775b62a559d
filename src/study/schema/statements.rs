//! Schemas of the statements of a card that begin with double brackets.

use super::{cost, insert, paths, table, text};
use crate::study::correlation::MEASURES;
use crate::study::vocabulary::{CORRELATION, JOINT, KeyInfo};
use crate::study::{Known, Nature};
use serde_json::{Value, json};

/// Inputs that are drawn together.
pub(super) fn joint() -> Value {
    let value = |info: &KeyInfo| match info.name {
        "file" => text("posterior.parquet"),
        "columns" => paths(|_| text("shear_factor"), text("gap_3_m")),
        "sha256" => json!({ "type": "string", "pattern": "^\\s*[0-9a-fA-F]{64}\\s*$" }),
        "known" => json!({ "enum": Known::ALL.map(Known::name) }),
        "nature" => json!({ "enum": Nature::ALL.map(Nature::name) }),
        "cost" => cost(),
        _ => text("posterior of the truck tests"),
    };
    table(JOINT, value, &["file", "known", "source"])
}

/// A dependence between two inputs.
pub(super) fn correlation() -> Value {
    let coefficient = json!({ "type": "number", "exclusiveMinimum": -1, "exclusiveMaximum": 1 });
    let example = json!(["thermal.fluid_capacity", "thermal.rotor_capacity"]);
    let value = |info: &KeyInfo| match info.name {
        "between" => json!({
            "type": "array",
            "items": { "type": "string" },
            "minItems": 2,
            "maxItems": 2,
            "examples": [example],
        }),
        "source" => text("measured on three housings"),
        _ => coefficient.clone(),
    };
    let mut schema = table(CORRELATION, value, &["between", "source"]);
    let one: Vec<Value> = MEASURES.iter().map(|(name, _)| json!({ "required": [name] })).collect();
    insert(&mut schema, "oneOf", json!(one));
    schema
}
