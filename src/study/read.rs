//! Reading values of known kinds out of a tree, with a diagnostic for everything else.

use super::document::{Key, Node, Table, Value};
use super::mistakes::all;
use super::place::Place;
use super::values::written;
use super::vocabulary::KeyInfo;
use crate::error::Result;
use crate::units::spelling::nearest;
use crate::units::{self, Quantity};

/// A value of a quantity, SI: a text with a unit; a pure number may be bare.
pub(super) fn quantity(node: &Node, quantity: Quantity) -> Result<f64> {
    let value = match &node.value {
        Value::Integer(value, _) | Value::Float(value) => *value,
        Value::String(text) => {
            return units::parse(text, quantity).map_err(|error| {
                inside(&node.place, text, error.span).error_with(
                    error.problem,
                    error.expected,
                    error.help,
                )
            });
        }
        other => {
            let expected =
                format!("expected {}, such as \"{}\"", quantity.described(), quantity.example());
            return Err(node.place.error(format!("this is {}", other.described()), expected));
        }
    };
    if !value.is_finite() {
        return Err(node.place.error("this is not a finite number", "expected a finite number"));
    }
    units::bare(value, node.place.written(), quantity)
        .map_err(|error| node.place.error_with(error.problem, error.expected, error.help))
}

/// The stretch of a text value that lies between its quotes, if they are plain ones.
fn inside(place: &Place, text: &str, span: std::ops::Range<usize>) -> Place {
    let written = place.written();
    let start = if written == text {
        0
    } else if written.get(1..written.len().saturating_sub(1)) == Some(text) {
        1
    } else {
        return place.clone();
    };
    let start = place.span.start + start;
    // An empty stretch would show nothing.
    if span.is_empty() {
        return place.clone();
    }
    Place::new(&place.text, start + span.start..start + span.end)
}

/// A whole number in a range.
pub(super) fn integer(node: &Node, least: u64, most: u64, example: &str) -> Result<u64> {
    let expected = || format!("expected a whole number from {least} to {most}, such as {example}");
    match &node.value {
        Value::Integer(_, Some(exact)) => match u64::try_from(*exact) {
            Ok(value) if (least..=most).contains(&value) => Ok(value),
            _ => Err(node.place.error(format!("{exact} is out of range"), expected())),
        },
        Value::Integer(..) => Err(node.place.error("this number is out of range", expected())),
        // 1e6 is a float to TOML and a count to a person; beyond 2^53 it is not exact.
        Value::Float(value)
            if value.fract() == 0.0 && (0.0..=9_007_199_254_740_992.0).contains(value) =>
        {
            let whole = *value as u64;
            if (least..=most).contains(&whole) {
                Ok(whole)
            } else {
                Err(node.place.error(format!("{whole} is out of range"), expected()))
            }
        }
        other => Err(node.place.error(format!("this is {}", other.described()), expected())),
    }
}

/// A text.
pub(super) fn string<'n>(node: &'n Node, what: &str) -> Result<&'n str> {
    match &node.value {
        Value::String(text) if text.trim().is_empty() => {
            Err(node.place.error("this string is empty", format!("expected {what}")))
        }
        Value::String(text) => Ok(text),
        other => {
            let problem = format!("this is {}", other.described());
            Err(node.place.error(problem, format!("expected {what} as a quoted string")))
        }
    }
}

/// True or false.
pub(super) fn boolean(node: &Node) -> Result<bool> {
    match &node.value {
        Value::Boolean(value) => Ok(*value),
        other => {
            let problem = format!("this is {}", other.described());
            Err(node.place.error(problem, "expected true or false"))
        }
    }
}

/// A table.
pub(super) fn table<'n>(node: &'n Node, example: &str) -> Result<&'n Table> {
    match &node.value {
        Value::Table(entries) => Ok(entries),
        other => {
            let problem = format!("this is {}", other.described());
            Err(node.place.error(problem, format!("expected a table, such as {example}")))
        }
    }
}

/// The value of a key of a table, if it is one and has it.
pub(super) fn entry<'n>(node: &'n Node, name: &str) -> Option<&'n Node> {
    match &node.value {
        Value::Table(entries) => {
            entries.iter().find(|(key, _)| key.name == name).map(|(_, node)| node)
        }
        _ => None,
    }
}

/// One name out of several.
pub(super) fn choice<T>(
    node: &Node,
    what: &str,
    names: &[&'static str],
    from_name: impl Fn(&str) -> Option<T>,
) -> Result<T> {
    let name = string(node, what)?;
    from_name(name).ok_or_else(|| {
        let help =
            nearest(name, names.iter().copied()).map(|near| format!("did you mean \"{near}\"?"));
        node.place.error_with(format!("unknown {what} \"{name}\""), one_of(names, '"'), help)
    })
}

/// "expected one of `a`, `b`".
pub(super) fn one_of(names: &[&str], quote: char) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("{quote}{name}{quote}")).collect();
    format!("expected one of {}", quoted.join(", "))
}

/// The diagnostic of a key that nothing knows.
pub(super) fn unknown_key(key: &Key, section: &str, names: &[&str]) -> crate::error::Error {
    let help =
        nearest(&key.name, names.iter().copied()).map(|near| format!("did you mean `{near}`?"));
    let problem = format!("unknown key `{}`{section}", key.name);
    key.place.error_with(problem, one_of(names, '`'), help)
}

/// Checks that every key is known.
pub(super) fn known_keys(entries: &Table, section: &str, keys: &[KeyInfo]) -> Result<()> {
    let names: Vec<&str> = keys.iter().map(|info| info.name).collect();
    let strange = entries.iter().filter(|(key, _)| !names.contains(&key.name.as_str()));
    all(strange.map(|(key, _)| Err(unknown_key(key, section, &names)))).map(|_: Vec<()>| ())
}

/// The entries of a section whose keys are all known.
pub(super) struct Section<'n> {
    pub name: &'static str,
    place: &'n Place,
    entries: &'n [(Key, Node)],
}

impl<'n> Section<'n> {
    /// Checks that every key is known.
    pub fn new(
        name: &'static str,
        place: &'n Place,
        entries: &'n Table,
        keys: &[KeyInfo],
    ) -> Result<Self> {
        known_keys(entries, &format!(" in {name}"), keys)?;
        Ok(Section { name, place, entries })
    }

    /// The entry of a key.
    pub fn entry(&self, name: &str) -> Option<&'n (Key, Node)> {
        self.entries.iter().find(|(key, _)| key.name == name)
    }

    /// The value of a key.
    pub fn get(&self, name: &str) -> Option<&'n Node> {
        self.entry(name).map(|(_, node)| node)
    }

    /// The value of a key that must be there.
    pub fn require(&self, name: &str, example: &str) -> Result<&'n Node> {
        self.get(name).ok_or_else(|| {
            self.place.error(
                format!("{} lacks the key `{name}`", self.name),
                format!("expected {name} = {example}"),
            )
        })
    }
}

/// The shares that can be told from 0 and from 1: with any of them as reliability and as confidence, the number
/// of samples that a demonstration takes can be counted.
pub(super) const SHARES: std::ops::RangeInclusive<f64> = 1e-12..=1.0 - 1e-12;

/// A share strictly between 0 and 1, in [`SHARES`]: a number, or a text in per cent.
pub(super) fn open_share(node: &Node, what: &str, example: &str) -> Result<f64> {
    let value = quantity(node, Quantity::Number)?;
    if SHARES.contains(&value) {
        Ok(value)
    } else if value > 0.0 && value < 1.0 {
        let problem = format!("{what} {} is out of range", written(node));
        let expected = format!("expected a share from 1e-12 to 1 - 1e-12, such as {example}");
        Err(node.place.error(problem, expected))
    } else {
        let expected = format!("expected a share strictly between 0 and 1, such as {example}");
        Err(node.place.error(format!("{what} {value} is impossible"), expected))
    }
}
