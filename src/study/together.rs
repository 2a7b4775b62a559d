//! `[[joint]]`: inputs that are drawn together, row by row, from a file of joint samples.

use super::columns::{self, Complaint, Found, name_and_unit};
use super::document::{Key, Node, Value};
use super::epistemic::nature;
use super::files::{Files, SampleFile};
use super::read::{self, Section};
use super::values::{parameter_path, possible_range, unknown_input};
use super::vocabulary::JOINT;
use super::{Known, Nature, TighteningCost, pairs, tighten};
use crate::error::{Error, Result};
use crate::physics::design::Target;
use crate::physics::parameters::{PARAMETERS, Parameter};

const COLUMNS_EXAMPLE: &str = "{ \"fluid.shear_factor\" = \"shear_factor\" }";

/// Inputs that a card draws together.
#[derive(Debug, Clone)]
pub(super) struct Together {
    /// Every input with its values, SI, one a row.
    pub members: Vec<(Target, Vec<f64>)>,
    pub known: Known,
    pub nature: Nature,
    pub source: String,
    pub group: String,
    pub cost: TighteningCost,
    pub file: String,
    pub sha256: String,
    /// Columns of the file that no input is drawn from, when the card does not name the columns.
    pub unused: Vec<String>,
    /// What a complaint about an input points to.
    pub key: Key,
}

impl Together {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.members.first().map_or(0, |(_, values)| values.len())
    }

    /// What the law of a member is called.
    pub fn law_text(&self) -> String {
        let others = self.members.len() - 1;
        let with = match others {
            0 => String::new(),
            1 => "together with another input ".to_owned(),
            _ => format!("together with {others} other inputs "),
        };
        format!("drawn {with}from the {} rows of {}", self.rows(), self.file)
    }
}

/// Reads the `[[joint]]` statements of a card, which states the laws of other inputs.
///
/// # Errors
/// A diagnostic: an unknown key or input, a file that cannot be read or is another one, a column that is
/// not there, an impossible value, an input that the card states twice.
pub(super) fn read(
    joints: &[Node],
    has_law: &dyn Fn(Target) -> bool,
    files: &mut dyn Files,
) -> Result<Vec<Together>> {
    let mut found: Vec<Together> = Vec::new();
    for statement in joints {
        let together = read_one(statement, files)?;
        for (target, _) in &together.members {
            let drawn = found.iter().flat_map(|other| &other.members).any(|(t, _)| t == target);
            if drawn || has_law(*target) {
                let problem = format!("{} is given twice in one card", target.path());
                let expected = "expected each input once: in a [[joint]] or with a law of its own \
                                (a later card may replace either)";
                return Err(together.key.place.error(problem, expected));
            }
        }
        found.push(together);
    }
    Ok(found)
}

fn read_one(statement: &Node, files: &mut dyn Files) -> Result<Together> {
    let entries = read::table(statement, "file = \"posterior.parquet\"")?;
    let section = Section::new("[[joint]]", &statement.place, entries, JOINT)?;
    let file = section.require("file", "\"posterior.parquet\"")?;
    let name = read::string(file, "the name of a file of joint samples")?;
    let content = files.sample(&file.place.text.origin, name).map_err(|reason| {
        let expected =
            "expected a CSV or Parquet file, relative to the card, with one column for each input";
        file.place.error(format!("cannot read {name}: {reason}"), expected)
    })?;
    if let Some(node) = section.get("sha256") {
        let stated = read::string(node, "the SHA-256 of the file, in hexadecimal")?;
        if !stated.trim().eq_ignore_ascii_case(&content.sha256) {
            let problem =
                format!("{name} does not match the stated SHA-256; its own is {}", content.sha256);
            let help = "if the new content is intended, state its SHA-256".to_owned();
            let expected = "expected the file that the card was written for";
            return Err(node.place.error_with(problem, expected, Some(help)));
        }
    }
    let (chosen, unused) = match section.get("columns") {
        Some(node) => (named(node, file, name, &content)?, Vec::new()),
        None => by_path(file, name, &content)?,
    };
    let mut members = Vec::with_capacity(chosen.len());
    for Chosen { target, found, place } in chosen {
        let values = values(target, found).map_err(|wrong| {
            place.error_with(format!("{name}: {}", wrong.problem), wrong.expected, wrong.help)
        })?;
        members.push((target, values));
    }
    members.sort_by_key(|(target, _)| *target);
    let rows = members.first().map_or(0, |(_, values)| values.len());
    if rows < 2 || members.iter().any(|(_, values)| values.len() != rows) {
        let problem = format!("{name} holds no joint sample");
        return Err(file.place.error(problem, "expected two rows at least, all of them complete"));
    }
    let known_names = Known::ALL.map(Known::name);
    let known = section.require("known", "\"never\": when the values become known")?;
    let known = read::choice(known, "value of `known`", &known_names, Known::from_name)?;
    let nature = match section.get("nature") {
        Some(node) => nature(node)?,
        None => Nature::default_of(known, false),
    };
    let source = section.require("source", "\"…\": where the sample comes from")?;
    let source = read::string(source, "where the sample comes from")?.trim().to_owned();
    let group = match section.get("group") {
        Some(node) => pairs::group(node, None)?,
        None => format!("joint sample of {} parameters ({name})", members.len()),
    };
    // They are bought together: all of them, or nothing.
    let usual = members
        .iter()
        .map(|(target, _)| TighteningCost::usual(target.parameter, known))
        .find(|cost| *cost != TighteningCost::None)
        .unwrap_or(TighteningCost::None);
    let cost = section.get("cost").map_or(Ok(usual), tighten::cost)?;
    let key = Key { name: name.to_owned(), place: file.place.clone() };
    let (file, sha256) = (name.to_owned(), content.sha256);
    Ok(Together { members, known, nature, source, group, cost, file, sha256, unused, key })
}

/// A column that an input is drawn from.
struct Chosen<'f> {
    target: Target,
    found: Found<'f>,
    place: super::place::Place,
}

/// The columns that the card names for each input.
fn named<'f>(
    node: &'f Node,
    file: &Node,
    name: &str,
    content: &'f SampleFile,
) -> Result<Vec<Chosen<'f>>> {
    let mut chosen: Vec<Chosen<'f>> = Vec::new();
    let mut pending = vec![(String::new(), node)];
    while let Some((prefix, node)) = pending.pop() {
        for (key, child) in read::table(node, COLUMNS_EXAMPLE)? {
            let path =
                if prefix.is_empty() { key.name.clone() } else { format!("{prefix}.{}", key.name) };
            let target = match parameter_path(&path) {
                Some(target) => target,
                None if matches!(child.value, Value::Table(_)) => {
                    pending.push((path, child));
                    continue;
                }
                None => return Err(unknown_input(&path, key)),
            };
            check_continuous(target, key)?;
            if chosen.iter().any(|other| other.target == target) {
                let problem = format!("{path} is given twice");
                return Err(key.place.error(problem, "expected each input once"));
            }
            let wanted = read::string(child, "the name of a column")?.trim();
            let found = columns::find(name, &content.columns, wanted).map_err(|wrong| {
                child.place.error_with(wrong.problem, wrong.expected, wrong.help)
            })?;
            chosen.push(Chosen { target, found, place: child.place.clone() });
        }
    }
    if chosen.is_empty() {
        let expected = format!("expected columns = {COLUMNS_EXAMPLE}, or no such key");
        return Err(file.place.error("`columns` is empty", expected));
    }
    Ok(chosen)
}

/// The columns whose names are design paths or what `reeldown` calls such columns itself, and the names of
/// the others.
fn by_path<'f>(
    file: &Node,
    name: &str,
    content: &'f SampleFile,
) -> Result<(Vec<Chosen<'f>>, Vec<String>)> {
    let mut chosen: Vec<Chosen<'f>> = Vec::new();
    let mut unused = Vec::new();
    for column in &content.columns {
        let (path, unit) = name_and_unit(&column.0);
        let Some(target) = parameter_path(path).or_else(|| column_target(path)) else {
            unused.push(column.0.clone());
            continue;
        };
        let key = Key { name: path.to_owned(), place: file.place.clone() };
        check_continuous(target, &key)?;
        if chosen.iter().any(|other| other.target == target) {
            let problem = format!("{name} has two columns of {}", target.path());
            return Err(file.place.error(problem, "expected each input once"));
        }
        chosen.push(Chosen { target, found: Found { column, unit }, place: file.place.clone() });
    }
    if chosen.is_empty() {
        let problem = format!("no column of {name} is named like an input");
        let expected = format!(
            "expected columns named by dotted path, such as thermal.fluid_capacity [J/K], or columns = \
             {COLUMNS_EXAMPLE}"
        );
        return Err(file.place.error(problem, expected));
    }
    Ok((chosen, unused))
}

/// The target of a column named as in `outcomes.parquet`: `thermal_fluid_capacity_j_per_k`.
fn column_target(name: &str) -> Option<Target> {
    let whole = PARAMETERS.iter().map(|info| Target::whole(info.parameter));
    whole.into_iter().find(|target| target.column() == name).or_else(|| {
        let number = name.strip_prefix("brake_gap_")?.strip_suffix("_m")?;
        let surface: usize = number.parse().ok()?;
        Some(Target::gap(surface.checked_sub(1)?)).filter(|target| target.column() == name)
    })
}

fn check_continuous(target: Target, key: &Key) -> Result<()> {
    if target.parameter == Parameter::BrakeRotors {
        let expected = "expected a continuous parameter; the number of rotors is an integer";
        return Err(key.place.error("brake.rotors cannot be uncertain", expected));
    }
    Ok(())
}

/// The numbers of a column in SI, each possible for the input.
fn values(target: Target, found: Found<'_>) -> std::result::Result<Vec<f64>, Complaint> {
    let info = target.parameter.info();
    let values = columns::in_si(found, info.quantity)?;
    match values.iter().position(|value| !info.admits(*value)) {
        None => Ok(values),
        Some(row) => {
            let header = &found.column.0;
            let written = found.column.1.as_ref().ok().and_then(|values| values.get(row));
            let problem = format!(
                "row {} of column \"{header}\" is {}, which is impossible for {}",
                row + 1,
                written.copied().unwrap_or(f64::NAN),
                target.path()
            );
            Err(Complaint { problem, expected: possible_range(target.parameter), help: None })
        }
    }
}

/// The correlation of an input that is drawn together with others.
pub(super) fn already_dependent(node: &Node, path: &str) -> Error {
    let problem = format!("{path} is drawn from a joint sample, which holds its dependence");
    node.place.error(problem, "expected inputs with laws of their own")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn property_headers_name_inputs() {
        assert_eq!(column_target("brake_gap_3_m"), Some(Target::gap(2)));
        assert_eq!(column_target("brake_gap_0_m"), None);
        let capacity = Target::whole(Parameter::from_path("thermal.fluid_capacity").unwrap());
        assert_eq!(column_target("thermal_fluid_capacity_j_per_k"), Some(capacity));
        assert_eq!(column_target("log_posterior"), None);
    }
}
