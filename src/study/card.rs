//! Cards: the inputs that are uncertain, statement by statement.

use super::document::{Key, Node, Table, Value};
use super::mistakes::Mistakes;
use super::read;
use super::together::Together;
use super::values::{parameter_path, unknown_input};
use crate::error::Result;
use crate::physics::design::Target;
use crate::physics::parameters::PARAMETERS;

/// What a card says of one input, before it is understood.
#[derive(Debug, Clone)]
pub(super) struct Statement {
    pub target: Target,
    pub key: Key,
    pub node: Node,
}

/// A card, before it is understood.
#[derive(Debug, Clone, Default)]
pub(super) struct Card {
    pub statements: Vec<Statement>,
    pub correlations: Vec<Node>,
    /// What a calibrated card was made from.
    pub calibrated_from: Option<String>,
    /// The `[[joint]]` statements.
    pub joints: Vec<Node>,
    /// What the `[[joint]]` statements draw, once their files are read.
    pub together: Vec<Together>,
}

/// Sorts the entries of a card into inputs and correlations.
///
/// What cannot be sorted is left out and kept among the mistakes.
pub(super) fn read_card(document: &Node, mistakes: &mut Mistakes) -> Card {
    let mut card = Card::default();
    let entries = mistakes.keep(read::table(document, "[brake.gap]"));
    for (key, node) in entries.into_iter().flatten() {
        mistakes.keep(read_entry(key, node, &mut card));
    }
    card
}

fn read_entry(key: &Key, node: &Node, card: &mut Card) -> Result<()> {
    match key.name.as_str() {
        "title" | "description" => {
            read::string(node, "the text")?;
        }
        "calibrated_from" => {
            let what = "what the card was calibrated from";
            card.calibrated_from = Some(read::string(node, what)?.trim().to_owned());
        }
        "correlation" => card.correlations.extend_from_slice(statements(key, node)?),
        "joint" => card.joints.extend_from_slice(statements(key, node)?),
        _ => collect(key.name.clone(), key, node, &mut card.statements)?,
    }
    Ok(())
}

/// The statements that begin with a header in double brackets.
fn statements<'n>(key: &Key, node: &'n Node) -> Result<&'n [Node]> {
    match &node.value {
        Value::Array(items) => Ok(items),
        other => {
            let problem = format!("this is {}", other.described());
            let expected = format!("expected statements that begin with [[{}]]", key.name);
            Err(node.place.error(problem, expected))
        }
    }
}

/// Collects the inputs at and below `path`.
fn collect(path: String, key: &Key, node: &Node, into: &mut Vec<Statement>) -> Result<()> {
    if let Some(target) = parameter_path(&path) {
        if into.iter().any(|statement| statement.target == target) {
            let problem = format!("{path} is given twice in one card");
            return Err(key.place.error(problem, "expected each input once"));
        }
        if !matches!(node.value, Value::Table(_)) {
            let problem = format!("{path} has no law: this is {}", node.value.described());
            let expected = format!("expected a table that begins with [{path}]");
            return Err(node.place.error(problem, expected));
        }
        into.push(Statement { target, key: key.clone(), node: node.clone() });
        return Ok(());
    }
    let group = format!("{path}.");
    match &node.value {
        Value::Table(entries) if PARAMETERS.iter().any(|info| info.path.starts_with(&group)) => {
            let mut mistakes = Mistakes::default();
            for (key, child) in entries {
                mistakes.keep(collect(format!("{path}.{}", key.name), key, child, into));
            }
            mistakes.none_or(Some(()))
        }
        _ => Err(unknown_input(&path, key)),
    }
}

/// Merges cards: of two statements about one input, alone or with others, the later wins.
pub(super) fn merge(cards: Vec<Card>) -> Card {
    let mut merged = Card::default();
    for card in cards {
        let stated = card.statements.iter().map(|statement| statement.target);
        let drawn = card.together.iter().flat_map(|together| &together.members);
        for target in stated.chain(drawn.map(|(target, _)| *target)) {
            // The gap as a whole replaces what earlier cards said of single gaps.
            let replaced = |earlier: Target| {
                earlier == target
                    || target.surface.is_none() && earlier.parameter == target.parameter
            };
            merged.statements.retain(|earlier| !replaced(earlier.target));
            for together in &mut merged.together {
                together.members.retain(|(earlier, _)| !replaced(*earlier));
            }
        }
        merged.together.retain(|together| !together.members.is_empty());
        merged.statements.extend(card.statements);
        merged.together.extend(card.together);
        merged.correlations.extend(card.correlations);
    }
    merged
}

/// Puts an override's value into the statement about an input, or makes one.
pub(super) fn put(card: &mut Card, target: Target, key: &Key, name: &str, value: &Node) {
    let here = Key { name: name.to_owned(), place: key.place.clone() };
    let entry = (here, value.clone());
    let found = card.statements.iter_mut().find(|statement| statement.target == target);
    let entries: &mut Table = match found {
        Some(Statement { node: Node { value: Value::Table(entries), .. }, .. }) => entries,
        _ => {
            let node = Node { value: Value::Table(vec![entry]), place: key.place.clone() };
            card.statements.push(Statement { target, key: key.clone(), node });
            return;
        }
    };
    match entries.iter_mut().find(|(existing, _)| existing.name == name) {
        Some(existing) => *existing = entry,
        None => entries.push(entry),
    }
}
