//! Findings as JSON that a person can read and a difference can be taken of: one line for what is small.

use crate::error::{Error, Result};
use serde::Serialize;

/// The longest line that a list or an object with others in it is put on.
const WIDTH: usize = 160;

/// A tree as JSON: a list of plain values, and whatever fits on a line, on one line.
///
/// # Errors
/// If it holds a number that JSON has no word for as a key, which findings do not.
pub fn json(tree: &impl Serialize) -> Result<String> {
    let pretty = serde_json::to_string_pretty(tree)
        .map_err(|reason| Error::argument(format!("the findings cannot be written: {reason}")))?;
    Ok(folded(&pretty))
}

/// Joins the lines of what fits on one. A text of JSON holds no line break, so lines tell the structure.
fn folded(pretty: &str) -> String {
    // Open lists and objects: where each began in the text so far, and whether it holds another.
    let mut open: Vec<(usize, bool)> = Vec::new();
    let mut text = String::with_capacity(pretty.len());
    for line in pretty.lines() {
        let content = line.trim_start();
        let indent = line.len() - content.len();
        let start = text.len();
        text.push_str(line);
        text.push('\n');
        if content.ends_with(['[', '{']) {
            open.iter_mut().for_each(|(_, nested)| *nested = true);
            open.push((start, false));
        } else if content.starts_with([']', '}'])
            && let Some((begin, nested)) = open.pop()
        {
            let plain_list = content.starts_with(']') && !nested;
            let joined = joined(&text[begin..], indent);
            if plain_list || joined.len() <= WIDTH {
                text.truncate(begin);
                text.push_str(&joined);
                text.push('\n');
            }
        }
    }
    text
}

/// Lines as one: without their indentation, a space after each comma.
fn joined(lines: &str, indent: usize) -> String {
    let mut joined = " ".repeat(indent);
    for line in lines.lines() {
        joined.push_str(line.trim_start());
        if joined.ends_with(',') {
            joined.push(' ');
        }
    }
    joined.trim_end_matches(' ').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json as value};

    #[test]
    fn property_folding_changes_no_value_and_folds_what_is_small() {
        let long: Vec<f64> = (0..100).map(|k| f64::from(k) / 7.0).collect();
        let nested: Vec<Value> =
            (0..40).map(|k| value!({ "k": k, "of": [k, "a, {b}[\n"] })).collect();
        let tree =
            value!({ "small": { "a": 1, "b": [1, 2], "c": {} }, "long": long, "nested": nested });
        let text = json(&tree).unwrap();
        assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), tree);
        assert!(text.contains(r#""small": {"a": 1, "b": [1, 2], "c": {}}"#), "{text}");
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 1 + 1 + 1 + 1 + 40 + 1 + 1, "{text}");
        assert!(lines.iter().any(|line| line.len() > 1000), "a list of numbers is one line");
    }
}
