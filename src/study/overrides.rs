//! Statements on the command line that change a study: `--set PATH=VALUE` and its like.

use super::document::{Key, Node, Table, Value, parse_value};
use super::laws::law_keys;
use super::place::{Place, Text};
use super::read;
use super::values::parameter_path;
use super::vocabulary::{INPUT, KeyInfo, LIMIT, STUDY, UNTIL};
use crate::descent::OutcomeQuantity;
use crate::error::Result;
use crate::physics::parameters::PARAMETERS;
use crate::units::spelling::nearest;
use std::sync::Arc;

/// One change to a study, `PATH=VALUE`, from an option of the command line.
///
/// The path is a design key (`initial.temperature`, `brake.gap[3]`), a key of the study file
/// (`model`, `sampling.samples`, `limits.time.max`, `requirement.reliability`) or a key of the card
/// (`brake.gap.sd`). The value is TOML, or a text whose quotes the shell has eaten.
///
/// `sampling.samples` is the budget of a study that samples until something, and `sampling.until` takes
/// the place of the file's `samples`.
///
/// A design key moves the *nominal* value. Where the card makes the parameter uncertain, the
/// samples still follow the card's law; [`crate::study::Study::notes`] says so.
#[derive(Debug, Clone, PartialEq)]
pub struct Override {
    pub(super) path: Key,
    pub(super) value: Node,
}

impl Override {
    /// Reads `PATH=VALUE` as given to `option` ("--set").
    ///
    /// # Errors
    /// A diagnostic in the option's text: no `=`, no path, no value, unfinished TOML.
    pub fn parse(option: &str, statement: &str) -> Result<Self> {
        let text = Arc::new(Text { origin: option.to_owned(), text: statement.to_owned() });
        let place = |start: usize, end: usize| Place::new(&text, start..end);
        let example = "expected PATH=VALUE, such as initial.temperature=\"0 °F\"";
        let Some(equals) = statement.find('=') else {
            return Err(place(0, statement.len()).error("there is no `=`", example));
        };
        let name = statement[..equals].trim();
        if name.is_empty() {
            return Err(place(0, equals + 1).error("there is no path before the `=`", example));
        }
        let name_start = statement[..equals].len() - statement[..equals].trim_start().len();
        let path = Key { name: name.to_owned(), place: place(name_start, name_start + name.len()) };
        let raw = &statement[equals + 1..];
        let start = equals + 1 + raw.len() - raw.trim_start().len();
        let end = start + raw.trim().len();
        if raw.trim().is_empty() {
            return Err(
                place(equals, statement.len()).error("there is no value after the `=`", example)
            );
        }
        let value = match parse_value(&text, start) {
            Some(node) => node,
            None if raw.trim().starts_with(['"', '\'', '[', '{']) => {
                let problem = "this is not a TOML value";
                let expected = "expected a number, a text, true, false, a list or a table";
                return Err(place(start, end).error(problem, expected));
            }
            None => Node { value: Value::String(raw.trim().to_owned()), place: place(start, end) },
        };
        Ok(Override { path, value })
    }

    /// The statement as typed.
    pub fn text(&self) -> &str {
        &self.path.place.text.text
    }

    /// Where the statement goes.
    pub(super) fn destination(&self) -> Result<Destination> {
        let name = self.path.name.as_str();
        if parameter_path(name).is_some() {
            return Ok(Destination::Design);
        }
        if STUDY.iter().any(|info| info.name == name) {
            return Ok(Destination::Study(vec![name.to_owned()]));
        }
        if let Some((section, rest)) = name.split_once('.') {
            if section == "design" && parameter_path(rest).is_some() {
                return Err(self.unknown(Some(rest.to_owned())));
            }
            let keys = section_keys(section);
            if keys.iter().any(|info| info.name == rest) {
                return Ok(Destination::Study(vec![section.to_owned(), rest.to_owned()]));
            }
            let until = rest.strip_prefix("until.").filter(|_| section == "sampling");
            if let Some(key) = until
                && UNTIL.iter().any(|info| info.name == key)
            {
                return Ok(Destination::Study(
                    ["sampling", "until", key].map(str::to_owned).to_vec(),
                ));
            }
            // Whether the outcome and the side exist is found out where limits are read.
            if section == "limits" && rest.matches('.').count() < 2 {
                let parts = rest.split('.').map(str::to_owned);
                return Ok(Destination::Study(
                    std::iter::once(section.to_owned()).chain(parts).collect(),
                ));
            }
        }
        if let Some((path, key)) = name.rsplit_once('.')
            && parameter_path(path).is_some()
            && (INPUT.iter().any(|info| info.name == key) || law_keys().any(|k| k == key))
        {
            return Ok(Destination::Card { path: path.to_owned(), key: key.to_owned() });
        }
        Err(self.unknown(self.nearest_path()))
    }

    fn unknown(&self, near: Option<String>) -> crate::error::Error {
        self.path.place.error_with(
            format!("unknown path `{}`", self.path.name),
            "expected a design key, a key of the study file or a key of the card",
            near.map(|near| format!("did you mean `{near}`?")),
        )
    }

    fn nearest_path(&self) -> Option<String> {
        let name = self.path.name.as_str();
        let mut paths: Vec<String> = PARAMETERS.iter().map(|info| info.path.to_owned()).collect();
        for info in STUDY {
            paths.push(info.name.to_owned());
            paths.extend(
                section_keys(info.name).iter().map(|k| format!("{}.{}", info.name, k.name)),
            );
        }
        paths.extend(UNTIL.iter().map(|key| format!("sampling.until.{}", key.name)));
        for outcome in OutcomeQuantity::ALL {
            paths.extend(
                LIMIT.iter().map(|side| format!("limits.{}.{}", outcome.name(), side.name)),
            );
        }
        if let Some((path, _)) = name.rsplit_once('.')
            && parameter_path(path).is_some()
        {
            paths.extend(law_keys().map(|key| format!("{path}.{key}")));
            paths.extend(INPUT.iter().map(|info| format!("{path}.{}", info.name)));
        }
        nearest(name, paths.iter().map(String::as_str)).map(str::to_owned)
    }
}

fn section_keys(section: &str) -> &'static [KeyInfo] {
    use super::vocabulary::{
        EPISTEMIC, NUMERICS, RELIABILITY, REQUIREMENT, SAMPLING, SENSITIVITY, TIGHTEN, TRADE,
    };
    match section {
        "requirement" => REQUIREMENT,
        "sampling" => SAMPLING,
        "numerics" => NUMERICS,
        "sensitivity" => SENSITIVITY,
        "reliability" => RELIABILITY,
        "trade" => TRADE,
        "tighten" => TIGHTEN,
        "epistemic" => EPISTEMIC,
        _ => &[],
    }
}

/// Where an override goes.
pub(super) enum Destination {
    /// Into the nominal design.
    Design,
    /// Into the study file's tree, at these nested keys.
    Study(Vec<String>),
    /// Into the card, at a key of an input.
    Card {
        /// The input's path.
        path: String,
        /// The key.
        key: String,
    },
}

/// Where a statement about the number of samples goes, so that it takes the place of what the file says
/// of it: `sampling.samples` is the budget of a study with `until`, and `sampling.until` takes `samples`
/// away.
pub(super) fn in_place_of(entries: &mut Table, keys: Vec<String>) -> Vec<String> {
    let names: Vec<&str> = keys.iter().map(String::as_str).collect();
    let sampling = entries.iter_mut().find(|(key, _)| key.name == "sampling");
    let Some((_, Node { value: Value::Table(inner), .. })) = sampling else { return keys };
    match names[..] {
        ["sampling", "samples"]
            if inner.iter().any(|(key, node)| {
                key.name == "until" && matches!(node.value, Value::Table(_))
            }) =>
        {
            ["sampling", "until", "budget"].map(str::to_owned).to_vec()
        }
        ["sampling", "until", ..] => {
            inner.retain(|(key, _)| key.name != "samples");
            keys
        }
        _ => keys,
    }
}

/// Puts a value into a tree at nested keys, in place of what is there.
///
/// # Errors
/// A diagnostic if the way leads through something that is not a table.
pub(super) fn put(entries: &mut Table, keys: &[String], key: &Key, value: &Node) -> Result<()> {
    let Some((name, rest)) = keys.split_first() else { return Ok(()) };
    let found = entries.iter().position(|(existing, _)| existing.name == *name);
    let here = Key { name: name.clone(), place: key.place.clone() };
    if rest.is_empty() {
        match found.and_then(|place| entries.get_mut(place)) {
            Some(entry) => *entry = (here, value.clone()),
            None => entries.push((here, value.clone())),
        }
        return Ok(());
    }
    let place = match found {
        Some(place) => place,
        None => {
            let empty = Node { value: Value::Table(Vec::new()), place: key.place.clone() };
            entries.push((here, empty));
            entries.len() - 1
        }
    };
    match entries.get_mut(place) {
        Some((_, Node { value: Value::Table(inner), .. })) => put(inner, rest, key, value),
        Some((_, other)) => read::table(other, "{ max = \"210 s\" }").map(|_| ()),
        None => Ok(()),
    }
}
