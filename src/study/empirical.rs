//! Observed values: listed in a card, or one column of a CSV text.

use super::columns;
use super::document::{Node, Value};
use super::files::{Files, SampleColumn};
use super::mistakes::all;
use super::read;
use super::values::{check_possible, possible_range};
use crate::error::{Error, Result};
use crate::physics::parameters::ParameterInfo;

/// The values of an empirical law, and where they were written.
///
/// # Errors
/// A diagnostic: no list, no values, an impossible value, a column that cannot be read.
pub(super) fn observed<'n>(
    parameter: &ParameterInfo,
    entry: &dyn Fn(&str) -> Option<&'n Node>,
    files: &mut dyn Files,
) -> Result<(Vec<f64>, &'n Node)> {
    match (entry("values"), entry("file"), entry("column")) {
        (Some(list), _, _) => Ok((listed(parameter, list)?, list)),
        (None, Some(file), Some(column)) => Ok((filed(parameter, file, column, files)?, file)),
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
    all(items.iter().map(value))
}

fn filed(
    parameter: &ParameterInfo,
    file: &Node,
    column: &Node,
    files: &mut dyn Files,
) -> Result<Vec<f64>> {
    let name = read::string(file, "the name of a file of values")?;
    let wanted = read::string(column, "the name of a column")?;
    let content = files.sample(&file.place.text.origin, name).map_err(|reason| {
        let expected =
            "expected a CSV or Parquet file, relative to the card, that names its columns";
        file.place.error(format!("cannot read {name}: {reason}"), expected)
    })?;
    let values = columns::find(name, &content.columns, wanted)
        .and_then(|found| columns::in_si(found, parameter.quantity))
        .map_err(|wrong| column.place.error_with(wrong.problem, wrong.expected, wrong.help))?;
    match values.iter().find(|&&value| !parameter.admits(value)) {
        Some(value) => {
            let problem =
                format!("{name} holds {value}, which is impossible for {}", parameter.path);
            Err(file.place.error(problem, possible_range(parameter.parameter)))
        }
        None => Ok(values),
    }
}

/// The columns of a CSV text whose first line names them, each with its numbers or why it holds none.
///
/// Fields are separated by commas and may be quoted; empty lines are skipped; numbers are SI unless the
/// reader of a column knows better. A line with more or fewer fields than the header leaves no column: which field
/// belongs to which name is then a guess.
pub(super) fn table(text: &str) -> Vec<SampleColumn> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let header = lines.next().map(|(_, line)| fields(line)).unwrap_or_default();
    let mut columns: Vec<SampleColumn> =
        header.into_iter().map(|name| (name, Ok(Vec::new()))).collect();
    for (number, line) in lines {
        let fields = fields(line);
        if fields.len() != columns.len() {
            let reason = format!(
                "line {} has {} where the header names {} (commas separate columns, and numbers have a \
                 decimal point)",
                number + 1,
                counted(fields.len(), "value"),
                counted(columns.len(), "column")
            );
            columns.iter_mut().for_each(|(_, values)| *values = Err(reason.clone()));
            return columns;
        }
        for ((_, values), field) in columns.iter_mut().zip(fields) {
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

/// Takes the numbers of columns whose name another one has too: which of them is meant is not known.
pub(super) fn refuse_repeated(columns: &mut [SampleColumn]) {
    for k in 0..columns.len() {
        let times = columns.iter().filter(|(name, _)| *name == columns[k].0).count();
        if times > 1 {
            columns[k].1 = Err(format!("{times} columns have this name"));
        }
    }
}

fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
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

    fn column(text: &str, name: &str) -> std::result::Result<Vec<f64>, String> {
        let mut columns = table(text);
        refuse_repeated(&mut columns);
        let found = columns.into_iter().find(|(header, _)| header == name);
        found.map_or(Err("none".to_owned()), |(_, values)| values)
    }

    #[test]
    fn property_a_column_is_found_by_its_name() {
        let text = "\u{feff}\"gap, m\",other\n0.0015, 1\n\n\"0.0016\",2\n";
        let read = |name: &str| column(text, name);
        assert_eq!(read("gap, m"), Ok(vec![0.0015, 0.0016]));
        assert_eq!(read("other"), Ok(vec![1.0, 2.0]));
    }

    #[test]
    fn property_a_bad_column_says_why() {
        assert!(column("a\n1\nx\n", "a").is_err_and(|reason| reason.starts_with("line 3")));
        assert!(column("a,b\n1,\n", "b").is_err_and(|reason| reason.contains("\"\"")));
        assert!(column("a\nnan\n", "a").is_err());
        assert!(column("a\n", "a").is_err());
        assert!(table("").is_empty());
    }

    #[test]
    fn regression_lines_that_do_not_fit_the_header_leave_no_column() {
        // Issue 12: a decimal comma made 288.15 °C a column of 288 and one of 15 that had no name.
        let reason = column("T\n288,15\n290,65\n", "T").unwrap_err();
        assert!(
            reason.starts_with("line 2 has 2 values where the header names 1 column"),
            "{reason}"
        );
        let reason = column("a,b\n1,2\n\n3\n", "a").unwrap_err();
        assert!(
            reason.starts_with("line 4 has 1 value where the header names 2 columns"),
            "{reason}"
        );
    }

    #[test]
    fn regression_of_two_columns_with_one_name_neither_is_taken() {
        let text = "a,b,a\n1,2,3\n";
        assert_eq!(column(text, "a"), Err("2 columns have this name".to_owned()));
        assert_eq!(column(text, "b"), Ok(vec![2.0]));
    }
}
