//! `outcomes.parquet`: one row a sample, with the names of its parents in the footer.

use super::damage;
use super::parquet::{TableWriter, frame};
use crate::descent::{Fault, OutcomeQuantity};
use crate::error::{Error, Result};
use crate::outcomes::OutcomeTable;
use crate::study::Study;
use polars::prelude::{Column, DataFrame, ParquetReader, SerReader};
use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};

/// Column of the sample's index.
const SAMPLE: &str = "sample";
/// Column that says whether the line ran out.
const DEPLOYED: &str = "deployed";
/// Column of the fault's name, null where there is none.
const FAULT: &str = "fault";
/// Prefix of this program's footer keys.
const PREFIX: &str = "reeldown.";

/// What a file's footer says of its parents: keys without their prefix, and values.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Parentage(pub BTreeMap<String, String>);

impl Parentage {
    /// The footer's entries, with the prefix.
    pub fn entries(&self) -> Vec<(String, String)> {
        self.0.iter().map(|(key, value)| (format!("{PREFIX}{key}"), value.clone())).collect()
    }
}

/// The columns of a study's table.
#[derive(Debug, Clone)]
struct Layout {
    inputs: Vec<String>,
    margins: Vec<(String, crate::study::Limit)>,
}

impl Layout {
    fn new(study: &Study) -> Self {
        Layout {
            inputs: study.inputs.iter().map(|input| input.target.column()).collect(),
            margins: study
                .limits
                .iter()
                .map(|limit| (limit.margin_column(), limit.clone()))
                .collect(),
        }
    }

    fn frame(&self, table: &OutcomeTable) -> polars::prelude::PolarsResult<DataFrame> {
        let rows = table.rows();
        let indices: Vec<u64> = (0..rows as u64).map(|k| table.first + k).collect();
        let mut columns = vec![Column::new(SAMPLE.into(), indices)];
        for (j, name) in self.inputs.iter().enumerate() {
            columns.push(Column::new(name.as_str().into(), table.inputs.column(j)));
        }
        for quantity in OutcomeQuantity::ALL {
            let name = quantity.column();
            columns.push(number_column(&name, table.outcome(quantity), table));
        }
        for (name, limit) in &self.margins {
            let margins: Vec<f64> =
                table.outcome(limit.outcome).iter().map(|&v| limit.margin_of(v)).collect();
            columns.push(number_column(name, &margins, table));
        }
        let deployed: Vec<Option<bool>> =
            (0..rows).map(|k| table.faults[k].is_none().then_some(table.deployed[k])).collect();
        columns.push(Column::new(DEPLOYED.into(), deployed));
        let faults: Vec<Option<&str>> =
            table.faults.iter().map(|fault| fault.map(Fault::name)).collect();
        columns.push(Column::new(FAULT.into(), faults));
        frame(rows, columns)
    }
}

/// A column of numbers, null where the sample faulted.
fn number_column(name: &str, values: &[f64], table: &OutcomeTable) -> Column {
    if table.faults.iter().all(Option::is_none) {
        return Column::new(name.into(), values);
    }
    let values: Vec<Option<f64>> =
        values.iter().zip(&table.faults).map(|(&v, fault)| fault.is_none().then_some(v)).collect();
    Column::new(name.into(), values)
}

/// Writes `outcomes.parquet`, one row group a table.
pub struct OutcomesWriter {
    layout: Layout,
    writer: TableWriter,
}

impl OutcomesWriter {
    /// Starts the file.
    ///
    /// # Errors
    /// If it cannot be made.
    pub fn create(path: &Path, study: &Study, parentage: &Parentage) -> Result<Self> {
        let layout = Layout::new(study);
        let empty = OutcomeTable::new(0, 0, study.inputs.len());
        let schema = layout.frame(&empty).map_err(|reason| unusable(path, reason))?;
        let writer = TableWriter::create(path, schema.schema(), parentage.entries())?;
        Ok(OutcomesWriter { layout, writer })
    }

    /// Writes the next samples.
    ///
    /// # Errors
    /// If the disk does not take them.
    pub fn write(&mut self, table: &OutcomeTable) -> Result<()> {
        let frame = self.layout.frame(table).map_err(|r| Error::argument(r.to_string()))?;
        self.writer.write(&frame)
    }

    /// Ends the file and gives it its name.
    ///
    /// # Errors
    /// If the disk does not take it.
    pub fn finish(self) -> Result<()> {
        self.writer.finish()
    }
}

/// Reads `outcomes.parquet`.
#[derive(Debug)]
pub struct OutcomesReader {
    path: PathBuf,
    rows: u64,
    parentage: Parentage,
}

fn unusable(path: &Path, reason: impl std::fmt::Display) -> Error {
    Error::file(
        path,
        "read",
        reason,
        "expected an outcomes.parquet that `reeldown run` has written",
    )
}

impl OutcomesReader {
    /// Opens a file and reads its footer.
    ///
    /// # Errors
    /// If it is not there, not Parquet, or not written by this program.
    pub fn open(path: &Path) -> Result<Self> {
        let file = File::open(path).map_err(|reason| unusable(path, reason))?;
        let metadata = damage::read(|| ParquetReader::new(file).get_metadata().cloned())
            .map_err(|reason| unusable(path, reason))?;
        let rows = metadata.num_rows as u64;
        let entries = metadata.key_value_metadata().as_ref().map_or(&[][..], |list| list);
        let parentage: BTreeMap<String, String> = entries
            .iter()
            .filter_map(|entry| {
                let key = entry.key.strip_prefix(PREFIX)?;
                Some((key.to_owned(), entry.value.clone()?))
            })
            .collect();
        if parentage.is_empty() {
            return Err(unusable(path, "its footer has no entry of reeldown's"));
        }
        Ok(OutcomesReader { path: path.to_owned(), rows, parentage: Parentage(parentage) })
    }

    /// Number of samples in the file.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// What the footer says of the file's parents.
    pub fn parentage(&self) -> &Parentage {
        &self.parentage
    }

    /// Reads samples `first` … `first + rows − 1` of a file of this study.
    ///
    /// # Errors
    /// If the file has other columns than the study, or cannot be read.
    pub fn read(&self, study: &Study, first: u64, rows: usize) -> Result<OutcomeTable> {
        let fail = |reason: String| unusable(&self.path, reason);
        let file = File::open(&self.path).map_err(|reason| unusable(&self.path, reason))?;
        let slice = Some((first as usize, rows));
        let frame =
            damage::read(|| ParquetReader::new(file).with_slice(slice).finish()).map_err(fail)?;
        if frame.height() != rows {
            return Err(fail(format!("it has no samples {first} to {}", first + rows as u64 - 1)));
        }
        let layout = Layout::new(study);
        let mut table = OutcomeTable::new(first, rows, study.inputs.len());
        let numbers = |name: &str, target: &mut [f64]| -> Result<()> {
            let column = frame.column(name).and_then(|column| column.f64().cloned());
            let column = column.map_err(|reason| fail(reason.to_string()))?;
            for (value, read) in target.iter_mut().zip(column.iter()) {
                *value = read.unwrap_or(f64::NAN);
            }
            Ok(())
        };
        for (j, name) in layout.inputs.iter().enumerate() {
            numbers(name, table.inputs.column_mut(j))?;
        }
        for (j, quantity) in OutcomeQuantity::ALL.iter().enumerate() {
            numbers(&quantity.column(), table.outcomes.column_mut(j))?;
        }
        let deployed = frame.column(DEPLOYED).and_then(|column| column.bool().cloned());
        let faults = frame.column(FAULT).and_then(|column| column.str().cloned());
        let (Ok(deployed), Ok(faults)) = (deployed, faults) else {
            return Err(fail(format!("it lacks the columns `{DEPLOYED}` and `{FAULT}`")));
        };
        for (k, (deployed, fault)) in deployed.iter().zip(faults.iter()).enumerate() {
            table.deployed[k] = deployed.unwrap_or(false);
            table.faults[k] = match fault {
                None => None,
                Some(name) => Some(
                    Fault::from_name(name).ok_or_else(|| fail(format!("unknown fault {name}")))?,
                ),
            };
        }
        Ok(table)
    }
}
