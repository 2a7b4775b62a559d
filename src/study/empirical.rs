//! Observed values: listed in a card, or one column of a CSV text.

use super::document::{Node, Value};
use super::files::SampleColumn;
use super::read;
use super::values::{check_possible, possible_range};
use crate::error::{Error, Result};
use crate::physics::parameters::ParameterInfo;

/// Reads a column of values: the card's name, the file, the column.
pub(super) type ColumnReader<'r> =
    &'r mut dyn FnMut(&str, &str, &str) -> std::result::Result<Vec<f64>, String>;

/// The values of an empirical law, and where they were written.
///
/// # Errors
/// A diagnostic: no list, no values, an impossible value, a column that cannot be read.
pub(super) fn observed<'n>(
    parameter: &ParameterInfo,
    entry: &dyn Fn(&str) -> Option<&'n Node>,
    columns: ColumnReader<'_>,
) -> Result<(Vec<f64>, &'n Node)> {
    match (entry("values"), entry("file"), entry("column")) {
        (Some(list), _, _) => Ok((listed(parameter, list)?, list)),
        (None, Some(file), Some(column)) => Ok((filed(parameter, file, column, columns)?, file)),
        // The law's form has been chosen, so one of the two is there.
        _ => Err(Error::argument("an empirical law has neither values nor a file")),
    }
}

/// The values of a list.
pub(super) fn listed(parameter: &ParameterInfo, node: &Node) -> Result<Vec<f64>> {
    let Value::Array(items) = &node.value else {
        let problem = format!("this is {}", node.value.described());
        let expected = format!("expected a list, such as [\"{}\"]", parameter.baseline_text);
        return Err(node.place.error(problem, expected));
    };
    if items.is_empty() {
        return Err(node.place.error("the list is empty", "expected observed values"));
    }
    let value = |item: &Node| {
        let value = read::quantity(item, parameter.quantity)?;
        check_possible(parameter, "a value", value, item)?;
        Ok(value)
    };
    items.iter().map(value).collect()
}

fn filed(
    parameter: &ParameterInfo,
    file: &Node,
    column: &Node,
    columns: ColumnReader<'_>,
) -> Result<Vec<f64>> {
    let name = read::string(file, "the name of a file of values")?;
    let column = read::string(column, "the name of a column")?;
    let values = columns(&file.place.text.origin, name, column).map_err(|reason| {
        let problem = format!("cannot take column \"{column}\" from {name}: {reason}");
        let expected = "expected a CSV file whose first line names its columns, values in SI";
        file.place.error(problem, expected)
    })?;
    match values.iter().find(|&&value| !parameter.admits(value)) {
        Some(value) => {
            let problem =
                format!("{name} holds {value}, which is impossible for {}", parameter.path);
            Err(file.place.error(problem, possible_range(parameter.parameter)))
        }
        None => Ok(values),
    }
}

/// The numbers of `column` in a CSV text whose first line names its columns.
///
/// # Errors
/// What is wrong, with the line: no such column (with those there are), not a finite number, no numbers.
pub(super) fn column(text: &str, column: &str) -> std::result::Result<Vec<f64>, String> {
    let mut columns = table(text);
    match columns.iter().position(|(name, _)| name == column) {
        Some(place) => columns.swap_remove(place).1,
        None => {
            let names: Vec<String> = columns.into_iter().map(|(name, _)| name).collect();
            Err(format!("it has no such column, only {}", shortened(&names.join(", "))))
        }
    }
}

/// The columns of a CSV text whose first line names them, each with its numbers or why it holds none.
///
/// Fields are separated by commas and may be quoted; empty lines are skipped; numbers are SI unless the
/// reader of a column knows better.
pub(super) fn table(text: &str) -> Vec<SampleColumn> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let header = lines.next().map(|(_, line)| fields(line)).unwrap_or_default();
    let mut columns: Vec<SampleColumn> =
        header.into_iter().map(|name| (name, Ok(Vec::new()))).collect();
    for (number, line) in lines {
        let mut fields = fields(line).into_iter();
        for (_, values) in &mut columns {
            let field = fields.next().unwrap_or_default();
            let Ok(numbers) = values else { continue };
            match field.parse::<f64>() {
                Ok(value) if value.is_finite() => numbers.push(value),
                _ => {
                    *values = Err(format!(
                        "line {}: \"{}\" is not a finite number",
                        number + 1,
                        shortened(&field)
                    ));
                }
            }
        }
    }
    for (_, values) in &mut columns {
        if values.as_ref().is_ok_and(Vec::is_empty) {
            *values = Err("it holds no numbers".to_owned());
        }
    }
    columns
}

/// The fields of a line, without their quotes.
fn fields(line: &str) -> Vec<String> {
    let mut fields = vec![String::new()];
    let mut quoted = false;
    let mut characters = line.chars().peekable();
    while let Some(character) = characters.next() {
        match character {
            '"' if quoted && characters.peek() == Some(&'"') => {
                characters.next();
                push(&mut fields, '"');
            }
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            other => push(&mut fields, other),
        }
    }
    fields.iter().map(|field| field.trim().to_owned()).collect()
}

fn push(fields: &mut [String], character: char) {
    if let Some(field) = fields.last_mut() {
        field.push(character);
    }
}

/// A text that is short enough for a message.
fn shortened(text: &str) -> String {
    let mut short: String = text.chars().take(80).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn property_a_column_is_found_by_its_name() {
        let text = "\u{feff}\"gap, m\",other\n0.0015, 1\n\n\"0.0016\",2\n";
        assert_eq!(column(text, "gap, m"), Ok(vec![0.0015, 0.0016]));
        assert_eq!(column(text, "other"), Ok(vec![1.0, 2.0]));
    }

    #[test]
    fn property_a_bad_column_says_why() {
        assert!(column("a,b\n1,2\n", "c").is_err_and(|reason| reason.contains("a, b")));
        assert!(column("a\n1\nx\n", "a").is_err_and(|reason| reason.starts_with("line 3")));
        assert!(column("a,b\n1\n", "b").is_err_and(|reason| reason.contains("\"\"")));
        assert!(column("a\nnan\n", "a").is_err());
        assert!(column("a\n", "a").is_err());
        assert!(column("", "a").is_err());
    }
}
