//! One measured run of the rig, or of a flight: columns of a CSV text with units in the header, or of a
//! Parquet file in SI.
//!
//! # The file
//! ```text
//! # comments start with a number sign; empty lines are skipped
//! # synthetic: a comment that begins so says that the run was made up, and every result of it will say so
//! time [s], force [lbf], speed [ft/s], line [ft], fluid [°F], rotor [°F], housing [°F]
//! 0, 6010, 1.52, 0, 60.1, 60.0, 59.9
//! ```
//! The first line that is neither empty nor a comment is the header: column names from [`CHANNELS`], each
//! with a unit in square brackets (any that studies know), separated by commas, in any order. `time` and one
//! of `force` and `speed` are needed; the rest is what was instrumented. Every further line is one reading,
//! with a number in every column. Fields may be quoted; numbers have a decimal point.
//!
//! In a Parquet file the columns have the same names with their units, or are in SI under the names `time_s`,
//! `force_n`, `speed_m_per_s`, `line_m`, `fluid_temperature_k`, `rotor_temperature_k`, `housing_temperature_k` (also
//! `tension_n` and `velocity_m_per_s`, as in the traces that `reeldown` writes). It may hold other columns.

use super::digest;
use super::files::NumberColumn;
use super::load::{Parquet, as_text, is_parquet, read_bytes};
use super::place::{Place, Text};
use crate::descent::driven::{Drive, Record};
use crate::error::{Error, Result};
use crate::units::spelling::{edit_distance, nearest};
use crate::units::{self, Quantity, number};
use std::path::Path;
use std::sync::Arc;

/// What a run can hold, besides time: name in the header, quantity, names of Parquet columns.
pub const CHANNELS: [(&str, Quantity, &[&str]); 7] = [
    ("time", Quantity::Time, &["time_s"]),
    ("force", Quantity::Force, &["force_n", "tension_n"]),
    ("speed", Quantity::Speed, &["speed_m_per_s", "velocity_m_per_s"]),
    ("line", Quantity::Length, &["line_m"]),
    ("fluid", Quantity::Temperature, &["fluid_temperature_k"]),
    ("rotor", Quantity::Temperature, &["rotor_temperature_k"]),
    ("housing", Quantity::Temperature, &["housing_temperature_k"]),
];

/// A step in time this many times the usual one about it is a gap.
const GAP: f64 = 5.0;
/// Steps before and after one that tell the usual one there: a record may be logged faster in one part than in another.
const ABOUT: usize = 5;
/// Share of the largest reading by which a force or a speed may lie below zero: an instrument's zero at rest.
const BELOW_ZERO: f64 = 0.01;
/// A name that differs from a channel's in so many letters is a misspelling of it.
const MISSPELT: usize = 2;
/// The hottest that an instrument can have read, K.
const HOTTEST_K: f64 = 2000.0;

/// What is accepted of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Acceptance {
    /// Longest step in time, as a multiple of the median step about it; infinite accepts gaps.
    pub longest_step: f64,
}

impl Default for Acceptance {
    fn default() -> Self {
        Acceptance { longest_step: GAP }
    }
}

/// A measured run, SI. Every column that is there is as long as `time_s`.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredRun {
    /// The file's name.
    pub origin: String,
    /// SHA-256 of the numbers in SI, in hexadecimal: independent of units, comments and spacing.
    pub digest: String,
    /// Whether the file says that it was made up.
    pub synthetic: bool,
    /// Times, s, strictly increasing.
    pub time_s: Vec<f64>,
    /// Pull on the line, N.
    pub force_n: Option<Vec<f64>>,
    /// Speed of the line, m/s.
    pub speed_m_per_s: Option<Vec<f64>>,
    /// Line paid out, m.
    pub line_m: Option<Vec<f64>>,
    /// Fluid temperature, K.
    pub fluid_k: Option<Vec<f64>>,
    /// Temperature of rotors and stators, K.
    pub rotor_k: Option<Vec<f64>>,
    /// Housing temperature, K.
    pub housing_k: Option<Vec<f64>>,
    /// Columns of the file that were not read.
    pub unused: Vec<String>,
}

impl MeasuredRun {
    /// Reads a run from a CSV or Parquet file.
    ///
    /// # Errors
    /// [`Error::File`] for a file that cannot be read; else what [`MeasuredRun::from_csv`] says.
    pub fn load(path: &Path, acceptance: Acceptance, parquet: Parquet) -> Result<Self> {
        let origin = path.display().to_string();
        let help = "name a CSV file with a header such as: time [s], force [lbf], speed [ft/s]";
        let cannot_read = |reason: String| Error::file(path, "read", reason, help);
        let bytes = read_bytes(path).map_err(cannot_read)?;
        if is_parquet(path, &bytes) {
            let columns = (parquet.table)(&bytes).map_err(cannot_read)?;
            return from_columns(&origin, columns, acceptance);
        }
        let text = as_text(bytes).map_err(cannot_read)?;
        Self::from_csv(&origin, &text, acceptance)
    }

    /// Reads a run from a CSV text called `origin`.
    ///
    /// # Errors
    /// A [`crate::error::Diagnostic`] at the place: a column that is unknown, twice, or without its unit; a
    /// missing or extra value; not a number; an impossible value; a time that does not increase; a gap.
    pub fn from_csv(origin: &str, text: &str, acceptance: Acceptance) -> Result<Self> {
        Csv::new(origin, text).run(acceptance)
    }

    /// The column of a channel, by its place in [`CHANNELS`].
    pub fn channel(&self, channel: usize) -> Option<&[f64]> {
        match channel {
            0 => Some(&self.time_s),
            1 => self.force_n.as_deref(),
            2 => self.speed_m_per_s.as_deref(),
            3 => self.line_m.as_deref(),
            4 => self.fluid_k.as_deref(),
            5 => self.rotor_k.as_deref(),
            6 => self.housing_k.as_deref(),
            _ => None,
        }
    }

    /// The history that drives a prediction of this run: its force or its speed.
    ///
    /// # Errors
    /// [`Error::Argument`] if the run does not hold it.
    pub fn record(&self, drive: Drive) -> Result<Record> {
        let values = match drive {
            Drive::Force => self.force_n.as_ref(),
            Drive::Speed => self.speed_m_per_s.as_ref(),
            Drive::Power => None,
        };
        let Some(values) = values else {
            let name = drive.name();
            return Err(Error::argument(format!("{} holds no column `{name}`", self.origin)));
        };
        // What an instrument reads below its zero at rest pulls no line.
        let values = values.iter().map(|value| value.max(0.0)).collect();
        Record::new(drive, self.time_s.clone(), values)
    }

    /// What a reader should know about how the file was read.
    pub fn note(&self) -> Option<String> {
        let names = self.unused.iter().take(12).cloned().collect::<Vec<_>>().join(", ");
        let more = if self.unused.len() > 12 { ", …" } else { "" };
        (!names.is_empty())
            .then(|| format!("{}: columns that are not read: {names}{more}", self.origin))
    }

    /// What drives a prediction unless told otherwise: the force, if it was recorded.
    pub fn preferred_drive(&self) -> Drive {
        if self.force_n.is_some() { Drive::Force } else { Drive::Speed }
    }

    fn new(origin: &str, mut columns: [Option<Vec<f64>>; CHANNELS.len()]) -> Self {
        let mut canonical = "reeldown measured run 1\n".to_owned();
        for ((name, ..), column) in CHANNELS.iter().zip(&columns) {
            if let Some(values) = column {
                let values: Vec<String> = values.iter().map(|v| format!("{v:e}")).collect();
                canonical += &format!("{name} {}\n", values.join(" "));
            }
        }
        let [time, force, speed, line, fluid, rotor, housing] =
            std::array::from_fn(|k| columns[k].take());
        MeasuredRun {
            origin: origin.to_owned(),
            digest: digest::of_text(&canonical),
            synthetic: false,
            time_s: time.unwrap_or_default(),
            force_n: force,
            speed_m_per_s: speed,
            line_m: line,
            fluid_k: fluid,
            rotor_k: rotor,
            housing_k: housing,
            unused: Vec::new(),
        }
    }
}

/// Whether a line is a comment that says that the run was made up.
fn says_synthetic(line: &str) -> bool {
    let comment = line.trim_start_matches('\u{feff}').trim_start().strip_prefix('#');
    comment.is_some_and(|words| words.trim_start().to_lowercase().starts_with("synthetic"))
}

/// Why a value cannot have been read on an instrument, and what could.
fn impossible(quantity: Quantity, value: f64) -> Option<(&'static str, String)> {
    let (problem, expected) = match quantity {
        Quantity::Temperature if !(value > 0.0 && value < HOTTEST_K) => (
            "this temperature is impossible",
            "expected one above absolute zero and below 2000 K: is the unit right?",
        ),
        Quantity::Length if value < 0.0 => {
            ("less than no line cannot be out", "expected zero or more")
        }
        _ => return None,
    };
    Some((problem, expected.to_owned()))
}

/// The first reading that is farther below zero than an instrument at rest, of a force or a speed.
fn pushed(quantity: Quantity, values: &[f64]) -> Option<usize> {
    let pulls = matches!(quantity, Quantity::Force | Quantity::Speed);
    let least = -BELOW_ZERO * values.iter().copied().fold(0.0, f64::max);
    values.iter().position(|value| *value < least).filter(|_| pulls)
}

/// What a reading below zero says, and what is expected.
const PUSHED: (&str, &str) = (
    "a line cannot be pushed",
    "expected zero or more, or no farther below it than 1 % of the largest reading: leave out readings from before and after \
     the pull",
);

/// Where the time goes wrong: the row, the problem, what was expected, help.
fn irregular(times: &[f64], longest: f64) -> Option<(usize, String, String, Option<String>)> {
    let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if let Some(k) = steps.iter().position(|step| *step <= 0.0) {
        let (before, now) = (number(times[k], 10), number(times[k + 1], 10));
        let problem = if times[k + 1] == times[k] {
            format!("the time {now} s is there twice")
        } else {
            format!("the time goes back from {before} s to {now} s")
        };
        return Some((k + 1, problem, "expected later times on later lines".to_owned(), None));
    }
    let median = |steps: &[f64]| {
        let mut sorted = steps.to_vec();
        sorted.sort_by(f64::total_cmp);
        sorted.get(sorted.len() / 2).copied()
    };
    let usual = |k: usize| {
        let before = median(&steps[k.saturating_sub(ABOUT)..k]);
        let after = median(&steps[k + 1..(k + 1 + ABOUT).min(steps.len())]);
        before.into_iter().chain(after).reduce(f64::max)
    };
    let (k, median) = (0..steps.len())
        .filter_map(|k| Some((k, usual(k)?)))
        .find(|(k, usual)| steps[*k] > longest * usual)?;
    let problem = format!(
        "a gap of {} s before this reading, where the usual step is {} s",
        number(steps[k], 6),
        number(median, 6)
    );
    let expected = format!("expected steps of at most {} times the usual one", number(longest, 6));
    let help =
        "a history is taken as linear between its readings: fill the gap, or give the parts \
                before and after it as runs of their own"
            .to_owned();
    Some((k + 1, problem, expected, Some(help)))
}

/// A CSV text under way.
struct Csv {
    text: Arc<Text>,
}

/// A field: its text without quotes, and the bytes it stands on.
type Field = (String, std::ops::Range<usize>);

impl Csv {
    fn new(origin: &str, text: &str) -> Self {
        Csv { text: Arc::new(Text { origin: origin.to_owned(), text: text.to_owned() }) }
    }

    fn place(&self, span: std::ops::Range<usize>) -> Place {
        Place::new(&self.text, span)
    }

    fn run(&self, acceptance: Acceptance) -> Result<MeasuredRun> {
        let mut lines = self.lines().into_iter();
        let Some((header, header_span)) = lines.next() else {
            let expected = "expected a header such as: time [s], force [lbf], speed [ft/s]";
            return Err(self.place(0..0).error("the file holds no header", expected));
        };
        let columns = self.header(&header)?;
        for (needed, choices) in [("time", &[0][..]), ("force` or `speed", &[1, 2][..])] {
            if !columns.iter().any(|(channel, _)| choices.contains(channel)) {
                let expected = "expected time and one of force and speed at least";
                let problem = format!("the header lacks the column `{needed}`");
                return Err(self.place(header_span).error(problem, expected));
            }
        }
        let mut values: [Option<Vec<f64>>; CHANNELS.len()] = Default::default();
        let mut spans: [Vec<std::ops::Range<usize>>; CHANNELS.len()] = Default::default();
        for (fields, span) in lines {
            if fields.len() != columns.len() {
                let problem = format!(
                    "{} values where the header names {} columns",
                    fields.len(),
                    columns.len()
                );
                let expected = format!("expected {} values", columns.len());
                return Err(self.place(span).error(problem, expected));
            }
            for ((channel, unit), (field, span)) in columns.iter().zip(fields) {
                let value = self.value(*channel, unit, &field, span.clone())?;
                spans[*channel].push(span);
                values[*channel].get_or_insert_default().push(value);
            }
        }
        let times = values[0].as_deref().unwrap_or_default();
        if times.len() < 2 {
            let problem = format!("the file holds {} readings", times.len());
            return Err(self.place(header_span).error(problem, "expected two at least below this"));
        }
        if let Some((row, problem, expected, help)) = irregular(times, acceptance.longest_step) {
            return Err(self.place(spans[0][row].clone()).error_with(problem, expected, help));
        }
        for (channel, (_, quantity, _)) in CHANNELS.iter().enumerate() {
            let column = values[channel].as_deref().unwrap_or_default();
            if let Some(row) = pushed(*quantity, column) {
                return Err(self.place(spans[channel][row].clone()).error(PUSHED.0, PUSHED.1));
            }
        }
        let synthetic = self.text.text.lines().any(says_synthetic);
        Ok(MeasuredRun { synthetic, ..MeasuredRun::new(&self.text.origin, values) })
    }

    /// The lines that hold something, as fields, with the bytes they stand on.
    fn lines(&self) -> Vec<(Vec<Field>, std::ops::Range<usize>)> {
        let mut lines = Vec::new();
        let mut at = 0;
        for line in self.text.text.split_inclusive('\n') {
            let start = at;
            at += line.len();
            let mark = if start == 0 && line.starts_with('\u{feff}') { 3 } else { 0 };
            let content = line.get(mark..).unwrap_or("").trim_end();
            if content.trim().is_empty() || content.trim_start().starts_with('#') {
                continue;
            }
            let start = start + mark;
            lines.push((fields(content, start), start..start + content.len()));
        }
        lines
    }

    /// The channels of a header with their units.
    fn header(&self, fields: &[Field]) -> Result<Vec<(usize, String)>> {
        let mut columns: Vec<(usize, String)> = Vec::new();
        for (field, span) in fields {
            let place = self.place(span.clone());
            if field.contains([';', '\t']) {
                let expected = "expected commas between columns, and numbers with a decimal point";
                return Err(place.error("columns are not separated by commas", expected));
            }
            let (name, unit) = match field.split_once('[') {
                Some((name, rest)) => (name.trim(), rest.trim().strip_suffix(']').map(str::trim)),
                None => (field.trim(), None),
            };
            let names = CHANNELS.map(|(name, ..)| name);
            let Some(channel) = names.iter().position(|known| *known == name.to_lowercase()) else {
                let expected = format!("expected one of {}, each with its unit", names.join(", "));
                let help = nearest(&name.to_lowercase(), names).map(|near| {
                    format!("did you mean `{near}`? A column that is not used must go")
                });
                return Err(place.error_with(format!("unknown column `{name}`"), expected, help));
            };
            if columns.iter().any(|(other, _)| *other == channel) {
                return Err(
                    place.error(format!("column `{name}` is there twice"), "expected it once")
                );
            }
            let quantity = CHANNELS[channel].1;
            let example = quantity.example();
            let example = example.split_once(' ').map_or(example, |(_, unit)| unit);
            let Some(unit) = unit.filter(|unit| !unit.is_empty()) else {
                let problem = format!("column `{name}` has no unit");
                return Err(place.error(problem, format!("expected {name} [{example}]")));
            };
            if let Err(error) = units::parse(&format!("1 {unit}"), quantity) {
                let expected = format!("expected a unit of {} in brackets", quantity.described());
                return Err(place.error_with(error.problem, expected, error.help));
            }
            columns.push((channel, unit.to_owned()));
        }
        Ok(columns)
    }

    /// A field's value, SI.
    fn value(
        &self,
        channel: usize,
        unit: &str,
        field: &str,
        span: std::ops::Range<usize>,
    ) -> Result<f64> {
        let (name, quantity, _) = CHANNELS[channel];
        let place = self.place(span);
        let missing =
            ["", "-", "na", "n/a", "nan", "null"].contains(&field.to_lowercase().as_str());
        if missing {
            let problem = format!("the value of `{name}` is missing");
            let help = "leave the line out, or the column if it is often missing".to_owned();
            return Err(place.error_with(problem, "expected a number", Some(help)));
        }
        let plain = field.parse::<f64>().ok().filter(|value| value.is_finite());
        let value = plain.and_then(|_| units::parse(&format!("{field} {unit}"), quantity).ok());
        let Some(value) = value else {
            let expected = "expected a number with a decimal point, its unit in the header";
            return Err(place.error(format!("\"{field}\" is not a finite number"), expected));
        };
        match impossible(quantity, value) {
            Some((problem, expected)) => Err(place.error(problem, expected)),
            None => Ok(value),
        }
    }
}

/// The fields of a line that begins at byte `start`.
fn fields(line: &str, start: usize) -> Vec<Field> {
    let mut fields = Vec::new();
    let (mut from, mut quoted) = (0, false);
    let ends = line.char_indices().filter_map(|(at, character)| {
        quoted ^= character == '"';
        (character == ',' && !quoted).then_some(at)
    });
    for end in ends.chain([line.len()]) {
        let raw = line.get(from..end).unwrap_or("");
        let lead = raw.len() - raw.trim_start().len();
        let written = raw.trim();
        let field = written.strip_prefix('"').and_then(|rest| rest.strip_suffix('"'));
        let field = field.unwrap_or(written).trim().to_owned();
        let begin = start + from + lead;
        // An empty field is shown by the comma that ends it.
        fields.push((field, begin..begin + written.len().max(1)));
        from = end + 1;
    }
    fields
}

/// A run from the columns of a Parquet file.
fn from_columns(
    origin: &str,
    columns: Vec<NumberColumn>,
    acceptance: Acceptance,
) -> Result<MeasuredRun> {
    let wrong = |what: String| Error::argument(format!("{origin}: {what}"));
    let mut values: [Option<Vec<f64>>; CHANNELS.len()] = Default::default();
    let mut held: [Option<String>; CHANNELS.len()] = Default::default();
    let mut unused = Vec::new();
    for (column, entries) in columns {
        let Some((channel, unit)) = channel_of(&column).map_err(wrong)? else {
            unused.push(column);
            continue;
        };
        let (name, quantity, _) = CHANNELS[channel];
        if let Some(other) = &held[channel] {
            return Err(wrong(format!("columns {other} and {column} both hold the {name}")));
        }
        let entries = entries.map_err(|reason| wrong(format!("column {column}: {reason}")))?;
        let mut series = Vec::with_capacity(entries.len());
        for (row, entry) in entries.into_iter().enumerate() {
            let Some(value) = entry.filter(|value| value.is_finite()) else {
                return Err(wrong(format!("row {} of column {column} is missing", row + 1)));
            };
            let value = match unit {
                None => value,
                Some(unit) => units::parse(&format!("{value} {unit}"), quantity).map_err(|e| {
                    wrong(format!("column {column}: {}, {}", e.problem, e.expected))
                })?,
            };
            if let Some((problem, expected)) = impossible(quantity, value) {
                return Err(wrong(format!("row {} of {column}: {problem}: {expected}", row + 1)));
            }
            series.push(value);
        }
        if let Some(row) = pushed(quantity, &series) {
            return Err(wrong(format!("row {} of {column}: {}: {}", row + 1, PUSHED.0, PUSHED.1)));
        }
        values[channel] = Some(series);
        held[channel] = Some(column);
    }
    // A channel that is not there, and a column that is named nearly like it: a run is not read without the one for
    // the sake of the other's spelling.
    let missing = CHANNELS.iter().zip(&held).filter(|(_, held)| held.is_none());
    for known in missing.flat_map(|((_, _, names), _)| names.iter()) {
        let near = |name: &&String| edit_distance(name, known) <= MISSPELT;
        if let Some(name) = unused.iter().find(near) {
            return Err(wrong(format!(
                "unknown column `{name}`: did you mean `{known}`? Give a column that is something else another name"
            )));
        }
    }
    let times = values[0].as_deref().unwrap_or_default();
    if times.len() < 2 || (values[1].is_none() && values[2].is_none()) {
        return Err(wrong(
            "expected a column time_s with two rows at least, and force_n or speed_m_per_s"
                .to_owned(),
        ));
    }
    if let Some((row, problem, expected, _)) = irregular(times, acceptance.longest_step) {
        return Err(wrong(format!("row {}: {problem}: {expected}", row + 1)));
    }
    Ok(MeasuredRun { unused, ..MeasuredRun::new(origin, values) })
}

/// The channel that a column of a Parquet file holds, with its unit unless that is SI's; none of other columns.
fn channel_of(column: &str) -> std::result::Result<Option<(usize, Option<&str>)>, String> {
    if let Some(channel) = CHANNELS.iter().position(|(_, _, names)| names.contains(&column)) {
        return Ok(Some((channel, None)));
    }
    let (name, unit) = match column.split_once('[') {
        Some((name, rest)) => (name.trim(), rest.trim().strip_suffix(']').map(str::trim)),
        None => (column.trim(), None),
    };
    let named = |(known, ..): &(&str, Quantity, &[&str])| *known == name.to_lowercase();
    let Some(channel) = CHANNELS.iter().position(named) else { return Ok(None) };
    match unit.filter(|unit| !unit.is_empty()) {
        Some(unit) => Ok(Some((channel, Some(unit)))),
        None => {
            let (name, quantity, names) = CHANNELS[channel];
            let si = names.first().copied().unwrap_or(name);
            Err(format!(
                "column `{column}` has no unit: expected {name} [{}], or in SI {si}",
                quantity.si_unit()
            ))
        }
    }
}
