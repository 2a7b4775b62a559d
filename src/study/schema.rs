//! JSON Schema (draft 2020-12) of studies and cards, for an editor's completion and checks.
//!
//! Made from the tables that the parser reads, so that neither knows a key that the other does not.
//! A schema cannot tell units, ranges across keys or files; `reeldown check` does.

use super::laws::{Kind, LAWS, LawInfo, NOMINAL, TERMS, keys_of};
use super::vocabulary::{
    CARD, EPISTEMIC, GRADE, INPUT, KeyInfo, LIMIT, NUMERICS, RELIABILITY, REQUIREMENT, SAMPLING,
    SENSITIVITY, STUDY, TIGHTEN, TRADE, UNTIL,
};
mod statements;

use super::read::SHARES;
use super::{Known, LimitKind, Nature, RareMethod, RequirementOf};
use crate::descent::vector::TOLERANCES;
use crate::descent::{Model, OutcomeQuantity};
use crate::physics::parameters::{PARAMETERS, Parameter, ParameterInfo};
use crate::sampling;
use crate::units::Quantity;
use serde_json::{Map, Value, json};
use statements::{correlation, joint};

const DRAFT: &str = "https://json-schema.org/draft/2020-12/schema";

/// The JSON Schema of a study file.
pub fn study() -> Value {
    let mut limits = Map::new();
    for outcome in OutcomeQuantity::ALL {
        let value = |info: &KeyInfo| match info.name {
            "source" => text("specification, section 3"),
            _ => reference(outcome.quantity()),
        };
        let mut limit = table(LIMIT, value, &[]);
        let sides = LimitKind::ALL.map(|side| json!({ "required": [side.name()] }));
        insert(&mut limit, "anyOf", json!(sides));
        limits.insert(outcome.name().to_owned(), described(limit, outcome.title()));
    }
    let limits = json!({ "type": "object", "properties": limits, "additionalProperties": false });
    let requirement = table(
        REQUIREMENT,
        |info| match info.name {
            "of" => json!({ "enum": RequirementOf::ALL.map(RequirementOf::name) }),
            _ => share(),
        },
        &["reliability", "confidence"],
    );
    let mut sampling = table(SAMPLING, sampling_key, &[]);
    insert(&mut sampling, "not", json!({ "required": ["samples", "until"] }));
    let numerics = table(
        NUMERICS,
        |_| json!({ "type": "number", "minimum": TOLERANCES.start(), "maximum": TOLERANCES.end() }),
        &[],
    );
    let names = json!({ "type": "string", "pattern": "\\S" });
    let pair = json!({ "type": "array", "items": names, "minItems": 2, "maxItems": 2 });
    let sensitivity = table(
        SENSITIVITY,
        |info| match info.name {
            "bootstrap" => whole(100),
            "pairs" => json!({ "type": "array", "items": pair, "uniqueItems": true }),
            _ => whole(0),
        },
        &[],
    );
    let names = RareMethod::ALL.map(RareMethod::name);
    let methods = json!({ "type": "array", "items": { "enum": names }, "uniqueItems": true });
    let reliability = table(RELIABILITY, |_| methods.clone(), &[]);
    let trade = table(TRADE, |_| json!({ "anyOf": [{ "const": 0 }, whole(100)] }), &[]);
    let tighten = table(
        TIGHTEN,
        |info| match info.name {
            "target" => share(),
            "samples" => whole(100),
            _ => ranges(),
        },
        &[],
    );
    let section = |info: &KeyInfo| match info.name {
        "title" => text("HABE reel-down, launch day"),
        "card" => json!({ "anyOf": [
            text("../../distributions/habe.toml"),
            { "type": "array", "items": { "type": "string" }, "minItems": 1, "uniqueItems": true }
        ] }),
        "model" => json!({ "enum": Model::ALL.map(Model::name), "default": Model::Dynamic.name() }),
        "design" => design(),
        "limits" => limits.clone(),
        "requirement" => requirement.clone(),
        "sampling" => sampling.clone(),
        "numerics" => numerics.clone(),
        "sensitivity" => sensitivity.clone(),
        "trade" => trade.clone(),
        "tighten" => tighten.clone(),
        "epistemic" => epistemic(),
        _ => reliability.clone(),
    };
    let mut schema = table(STUDY, section, &["title", "card"]);
    insert(&mut schema, "dependentRequired", json!({ "requirement": ["limits"] }));
    document(schema, "A reeldown study", quantities())
}

/// The JSON Schema of an uncertainty card.
pub fn card() -> Value {
    let mut definitions = quantities();
    definitions.insert("laws".to_owned(), laws());
    let mut properties = Map::new();
    let uncertain = |info: &&ParameterInfo| info.parameter != Parameter::BrakeRotors;
    for info in PARAMETERS.iter().filter(uncertain) {
        let name = input_name(info);
        if !definitions.contains_key(&name) {
            definitions.insert(name.clone(), input(info));
        }
    }
    let entry = |info: &ParameterInfo| {
        described(json!({ "$ref": format!("#/$defs/{}", input_name(info)) }), &summary(info))
    };
    let surface = json!({ "$ref": "#/$defs/input_length" });
    let (nested, pattern) =
        by_path(&mut properties, PARAMETERS.iter().filter(uncertain), entry, surface);
    for info in CARD {
        let value = match info.name {
            "correlation" => json!({ "type": "array", "items": correlation() }),
            "joint" => json!({ "type": "array", "items": joint() }),
            _ => text("HABE reel-down brake, as designed"),
        };
        properties.insert(info.name.to_owned(), described(value, info.description));
    }
    properties.extend(nested);
    let schema = json!({
        "type": "object",
        "properties": properties,
        "patternProperties": pattern,
        "additionalProperties": false,
    });
    // A gap of one surface is an input of a length, like a radius.
    document(schema, "A reeldown uncertainty card", definitions)
}

fn document(mut schema: Value, title: &str, definitions: Map<String, Value>) -> Value {
    insert(&mut schema, "$schema", json!(DRAFT));
    insert(&mut schema, "title", json!(title));
    insert(&mut schema, "$defs", Value::Object(definitions));
    schema
}

fn insert(schema: &mut Value, key: &str, value: Value) {
    if let Value::Object(object) = schema {
        object.insert(key.to_owned(), value);
    }
}

fn described(mut schema: Value, description: &str) -> Value {
    insert(&mut schema, "description", json!(description));
    schema
}

/// A table of the keys of a list.
fn table(keys: &[KeyInfo], value: impl Fn(&KeyInfo) -> Value, required: &[&str]) -> Value {
    let properties: Map<String, Value> = keys
        .iter()
        .map(|info| (info.name.to_owned(), described(value(info), info.description)))
        .collect();
    json!({
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    })
}

fn text(example: &str) -> Value {
    json!({ "type": "string", "pattern": "\\S", "examples": [example] })
}

fn whole(least: u64) -> Value {
    json!({ "type": "integer", "minimum": least })
}

/// A share strictly between 0 and 1, as a number or in per cent.
fn share() -> Value {
    json!({ "anyOf": [
        { "type": "number", "minimum": SHARES.start(), "maximum": SHARES.end() },
        { "type": "string", "pattern": "^\\s*[0-9.]", "examples": ["99 %"] }
    ] })
}

fn sampling_key(info: &KeyInfo) -> Value {
    match info.name {
        "until" => until(),
        "design" => json!({ "enum": sampling::Design::ALL.map(sampling::Design::name) }),
        "samples" => json!({ "type": "integer", "minimum": 1, "maximum": sampling::MAX_SAMPLES }),
        "replicates" => {
            json!({ "type": "integer", "minimum": 1, "maximum": sampling::MAX_REPLICATES })
        }
        _ => whole(0),
    }
}

/// What ends the sampling: one of two rules.
fn until() -> Value {
    let value = |info: &KeyInfo| match info.name {
        "decided" => json!({ "const": true }),
        "budget" => json!({ "type": "integer", "minimum": 1, "maximum": sampling::MAX_SAMPLES }),
        _ => share(),
    };
    let mut schema = table(UNTIL, value, &["budget"]);
    let rules = ["relative_error", "decided"].map(|rule| json!({ "required": [rule] }));
    insert(&mut schema, "oneOf", json!(rules));
    schema
}

/// Sets of values, and an even number of descents with each.
fn epistemic() -> Value {
    let value = |info: &KeyInfo| match info.name {
        "outer" => json!({ "anyOf": [
            { "const": 0 },
            { "type": "integer", "minimum": 200, "multipleOf": 20 }
        ] }),
        _ => json!({ "type": "integer", "minimum": 4, "multipleOf": 2 }),
    };
    table(EPISTEMIC, value, &[])
}

/// A quantity's name among the definitions.
fn quantity_name(quantity: Quantity) -> String {
    quantity.described().trim_start_matches("an ").trim_start_matches("a ").replace(' ', "_")
}

fn reference(quantity: Quantity) -> Value {
    json!({ "$ref": format!("#/$defs/{}", quantity_name(quantity)) })
}

/// A value of every quantity: a text with a unit; a pure number may be bare.
fn quantities() -> Map<String, Value> {
    let number = "^\\s*[+\\-−]?([0-9]|\\.[0-9])";
    Quantity::ALL
        .into_iter()
        .map(|quantity| {
            // Something that no number holds: the unit.
            let pattern = match quantity {
                Quantity::Number => number.to_owned(),
                _ => format!("{number}.*[^0-9.eE+\\-−_\\s]"),
            };
            let example = quantity.example();
            let text = json!({ "type": "string", "pattern": pattern, "examples": [example] });
            let schema = match quantity {
                Quantity::Number => json!({
                    "anyOf": [{ "type": "number", "description": "a pure number" }, text],
                    "examples": [example],
                }),
                _ => text,
            };
            (quantity_name(quantity), schema)
        })
        .collect()
}

fn summary(info: &ParameterInfo) -> String {
    format!(
        "{} ({}); baseline {}, {}",
        info.description, info.symbol, info.baseline_text, info.source
    )
}

/// `[design]`: every path, quoted or as nested tables.
fn design() -> Value {
    let entry = |info: &ParameterInfo| {
        let mut value = described(reference(info.quantity), &summary(info));
        insert(&mut value, "examples", json!([info.baseline_text]));
        value
    };
    paths(entry, reference(Quantity::Length))
}

/// `[tighten.design]`: ranges by path.
fn ranges() -> Value {
    let entry = |info: &ParameterInfo| described(range(info.quantity), &summary(info));
    paths(entry, range(Quantity::Length))
}

/// The range of a design value that may move.
fn range(quantity: Quantity) -> Value {
    json!({ "type": "array", "items": reference(quantity), "minItems": 2, "maxItems": 2 })
}

/// A table of design paths, quoted or as nested tables.
fn paths(entry: impl Fn(&ParameterInfo) -> Value, surface: Value) -> Value {
    let mut properties = Map::new();
    let (nested, pattern) = by_path(&mut properties, PARAMETERS.iter(), entry, surface);
    properties.extend(nested);
    json!({
        "type": "object",
        "properties": properties,
        "patternProperties": pattern,
        "additionalProperties": false,
    })
}

/// Dotted paths into `properties`; back come the same paths as nested tables, and the pattern of
/// the gaps of single surfaces.
fn by_path<'p>(
    properties: &mut Map<String, Value>,
    parameters: impl Iterator<Item = &'p ParameterInfo>,
    entry: impl Fn(&ParameterInfo) -> Value,
    surface: Value,
) -> (Map<String, Value>, Value) {
    let mut groups: Map<String, Value> = Map::new();
    for info in parameters {
        properties.insert(info.path.to_owned(), entry(info));
        if let Some((group, name)) = info.path.split_once('.') {
            let table = groups.entry(group).or_insert_with(
                || json!({ "type": "object", "properties": {}, "additionalProperties": false }),
            );
            if let Some(Value::Object(members)) = table.get_mut("properties") {
                members.insert(name.to_owned(), entry(info));
            }
            if info.parameter == Parameter::BrakeGap {
                insert(table, "patternProperties", json!({ "^gap\\[[1-9][0-9]*\\]$": surface }));
            }
        }
    }
    (groups, json!({ "^brake\\.gap\\[[1-9][0-9]*\\]$": surface }))
}

/// The name of an input's definition: one for each quantity, and one for the gap of every surface.
fn input_name(info: &ParameterInfo) -> String {
    match info.parameter {
        Parameter::BrakeGap => "input_gap".to_owned(),
        _ => format!("input_{}", quantity_name(info.quantity)),
    }
}

/// An input of a parameter's quantity.
fn input(info: &ParameterInfo) -> Value {
    let mut properties = Map::new();
    let truncation = ["lower", "upper", "truncation_lower", "truncation_upper"];
    for common in INPUT {
        let value = match common.name {
            "law" => json!({ "enum": LAWS.iter().map(|law| law.name).collect::<Vec<_>>() }),
            "known" => json!({ "enum": Known::ALL.map(Known::name) }),
            "nature" => json!({ "enum": Nature::ALL.map(Nature::name) }),
            "cost" => cost(),
            "each_surface" if info.parameter != Parameter::BrakeGap => continue,
            "each_surface" => json!({ "type": "boolean", "default": false }),
            name if truncation.contains(&name) => reference(info.quantity),
            _ => text("assumed"),
        };
        properties.insert(common.name.to_owned(), described(value, common.description));
    }
    let positive = json!({ "anyOf": [
        { "type": "number", "exclusiveMinimum": 0 },
        { "type": "string", "pattern": "^\\s*[0-9.]", "examples": ["8 %"] }
    ] });
    for term in TERMS {
        let value = match term.kind {
            Kind::Point if term.key == "mean" => {
                json!({ "anyOf": [reference(info.quantity), { "const": NOMINAL }] })
            }
            Kind::Point => reference(info.quantity),
            Kind::Spread => reference(info.quantity.of_difference()),
            Kind::Positive => positive.clone(),
            Kind::Values => {
                json!({ "type": "array", "items": reference(info.quantity), "minItems": 1 })
            }
            Kind::File => text("gaps.csv"),
            Kind::Column => text("gap_m"),
        };
        // `lower` and `upper` are described among the common keys.
        if !properties.contains_key(term.key) {
            properties.insert(term.key.to_owned(), described(value, term.description));
        }
    }
    json!({
        "type": "object",
        "properties": properties,
        "required": ["law", "known", "source"],
        "additionalProperties": false,
        "allOf": [{ "$ref": "#/$defs/laws" }],
    })
}

/// What tightening an input costs.
fn cost() -> Value {
    let grade = |info: &KeyInfo| match info.name {
        "spread" => json!({ "type": "number", "minimum": 0, "exclusiveMaximum": 1 }),
        _ => json!({ "type": "number", "minimum": 0 }),
    };
    json!({ "anyOf": [
        { "type": "number", "minimum": 0 },
        { "const": "none" },
        { "type": "array", "items": table(GRADE, grade, &["spread", "cost"]), "minItems": 1 }
    ] })
}

/// What every law asks of the other keys of its input.
fn laws() -> Value {
    let common = INPUT.iter().map(|info| info.name);
    let names: Vec<&str> = common.chain(TERMS.iter().map(|term| term.key)).collect();
    json!({ "allOf": LAWS.iter().map(|law| law_rule(law, &names)).collect::<Vec<_>>() })
}

/// What a law asks of the other keys: one of its forms, and none of the keys that it does not take.
fn law_rule(law: &LawInfo, names: &[&str]) -> Value {
    let own = keys_of(law);
    let defines = |key: &str| TERMS.iter().any(|term| term.key == key);
    let forms: Vec<Value> = law
        .forms
        .iter()
        .map(|form| {
            let others: Vec<Value> = own
                .iter()
                .filter(|key| !form.contains(key) && !law.optional.contains(key))
                .map(|key| json!({ "required": [key] }))
                .collect();
            let mut rule = json!({ "required": form });
            if !others.is_empty() {
                insert(&mut rule, "not", json!({ "anyOf": others }));
            }
            rule
        })
        .collect();
    let taken = |name: &&str| {
        let name = *name;
        let truncates = matches!(name, "lower" | "upper");
        let truncates_bounded = name.starts_with("truncation_");
        own.contains(&name)
            || truncates && !law.bounded
            || truncates_bounded && law.bounded
            || !truncates && !truncates_bounded && !defines(name)
    };
    let mut allowed: Vec<&str> = names.iter().copied().filter(taken).collect();
    allowed.sort_unstable();
    allowed.dedup();
    json!({
        "if": { "properties": { "law": { "const": law.name } }, "required": ["law"] },
        "then": {
            "description": law.description,
            "oneOf": forms,
            "propertyNames": { "enum": allowed },
        },
    })
}
