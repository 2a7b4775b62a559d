//! A TOML text as a tree that remembers where everything was written.

use super::place::{Place, Text};
use crate::error::Result;
use std::ops::Range;
use std::sync::Arc;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A key and where it was written.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Key {
    pub name: String,
    pub place: Place,
}

/// A value and where it was written.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Node {
    pub value: Value,
    pub place: Place,
}

/// A table's entries, in the order in which they were written.
pub(super) type Table = Vec<(Key, Node)>;

/// What a value is.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    String(String),
    /// The number and, where it fits, the exact integer.
    Integer(f64, Option<i128>),
    Float(f64),
    Boolean(bool),
    Datetime,
    Array(Vec<Node>),
    Table(Table),
}

impl Value {
    /// What the value is, for a person.
    pub fn described(&self) -> &'static str {
        match self {
            Value::String(_) => "a string",
            Value::Integer(..) => "an integer",
            Value::Float(_) => "a number",
            Value::Boolean(_) => "true or false",
            Value::Datetime => "a date",
            Value::Array(_) => "a list",
            Value::Table(_) => "a table",
        }
    }
}

/// Parses a TOML document.
///
/// # Errors
/// A diagnostic at the place where the text stops being TOML.
pub(super) fn parse(text: &Arc<Text>) -> Result<Node> {
    match DeTable::parse(&text.text) {
        Ok(document) => {
            let source = Source { text, start: 0 };
            let value = Value::Table(source.table(document.get_ref()));
            Ok(Node { value, place: source.place(document.span()) })
        }
        Err(error) => Err(malformed(text, &error)),
    }
}

/// Parses one TOML value that starts at byte `start` of a text; `None` if it is not TOML.
pub(super) fn parse_value(text: &Arc<Text>, start: usize) -> Option<Node> {
    let parsed = DeValue::parse(text.text.get(start..)?).ok()?;
    Some(Source { text, start }.node(&parsed))
}

fn malformed(text: &Arc<Text>, error: &toml::de::Error) -> crate::error::Error {
    let message = error.message();
    let (problem, expected) = match message.split_once(", expected ") {
        // What an engineer forgets: max = 210 s.
        Some((problem, _)) if problem.contains("must be quoted") => (
            "a value is missing or not quoted",
            "expected a value; one with a unit goes in quotes, \"210 s\"".to_owned(),
        ),
        Some((problem, expected)) => (problem, format!("expected {expected}")),
        None => (message, "expected `key = value` or a `[table]`".to_owned()),
    };
    let span = error.span().unwrap_or(text.text.len()..text.text.len());
    let problem = format!("this is not TOML: {}", problem.trim());
    Place::new(text, span).error(problem, expected)
}

/// A text, from byte `start` of which something was parsed.
struct Source<'t> {
    text: &'t Arc<Text>,
    start: usize,
}

impl Source<'_> {
    fn place(&self, span: Range<usize>) -> Place {
        Place::new(self.text, span.start + self.start..span.end + self.start)
    }

    fn table(&self, table: &DeTable<'_>) -> Table {
        let mut entries: Table = table
            .iter()
            .map(|(key, value)| {
                let place = self.place(key.span());
                (Key { name: key.get_ref().to_string(), place }, self.node(value))
            })
            .collect();
        entries.sort_by_key(|(key, _)| key.place.span.start);
        entries
    }

    fn node(&self, spanned: &Spanned<DeValue<'_>>) -> Node {
        let value = match spanned.get_ref() {
            DeValue::String(string) => Value::String(string.to_string()),
            DeValue::Integer(integer) => {
                let exact = i128::from_str_radix(integer.as_str(), integer.radix()).ok();
                let near =
                    exact.map(|exact| exact as f64).or_else(|| integer.as_str().parse().ok());
                Value::Integer(near.unwrap_or(f64::NAN), exact)
            }
            DeValue::Float(float) => Value::Float(float.as_str().parse().unwrap_or(f64::NAN)),
            DeValue::Boolean(boolean) => Value::Boolean(*boolean),
            DeValue::Datetime(_) => Value::Datetime,
            DeValue::Array(items) => {
                Value::Array(items.iter().map(|item| self.node(item)).collect())
            }
            DeValue::Table(entries) => Value::Table(self.table(entries)),
        };
        Node { value, place: self.place(spanned.span()) }
    }
}
