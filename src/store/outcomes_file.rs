//! `outcomes.parquet`: one row a sample, with the names of its parents in the footer.

use super::checksums::{Checksums, DIGEST_KEY, GROUPS_KEY};
use super::parquet::{TableWriter, frame};
use super::reader::{Cell, ParquetFile};
use crate::descent::{Fault, OutcomeQuantity};
use crate::error::{Error, Result};
use crate::outcomes::OutcomeTable;
use crate::study::Study;
use polars::prelude::{Column, DataFrame, Float64Chunked, IntoColumn, Schema};
use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Column of the sample's index.
const SAMPLE: &str = "sample";
/// Column that says whether the line ran out.
const DEPLOYED: &str = "deployed";
/// Column of the fault's name, null where there is none.
const FAULT: &str = "fault";
/// Footer entry of a table that does not begin with sample 0: the index of its first one.
pub const FIRST_SAMPLE: &str = "first_sample";
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

    /// Consecutive tables, one after the other.
    fn frame(&self, tables: &[OutcomeTable]) -> polars::prelude::PolarsResult<DataFrame> {
        let first = tables.first().map_or(0, |table| table.first);
        let rows = tables.iter().map(OutcomeTable::rows).sum();
        let indices: Vec<u64> = (first..first + rows as u64).collect();
        let mut columns = vec![Column::new(SAMPLE.into(), indices)];
        let one_after_the_other = |column: &dyn Fn(&OutcomeTable, &mut Vec<f64>)| {
            let mut values = Vec::with_capacity(rows);
            tables.iter().for_each(|table| column(table, &mut values));
            values
        };
        for (j, name) in self.inputs.iter().enumerate() {
            let of = |table: &OutcomeTable, all: &mut Vec<f64>| {
                all.extend_from_slice(table.inputs.column(j));
            };
            columns.push(number_column(name, one_after_the_other(&of), None));
        }
        let faults: Vec<Option<Fault>> =
            tables.iter().flat_map(|table| table.faults.iter().copied()).collect();
        let faulted = faults.iter().any(Option::is_some).then_some(&faults[..]);
        for quantity in OutcomeQuantity::ALL {
            let of = |table: &OutcomeTable, all: &mut Vec<f64>| {
                all.extend_from_slice(table.outcome(quantity));
            };
            let name = quantity.column();
            columns.push(number_column(&name, one_after_the_other(&of), faulted));
        }
        for (name, limit) in &self.margins {
            let of = |table: &OutcomeTable, all: &mut Vec<f64>| {
                all.extend(table.outcome(limit.outcome).iter().map(|&v| limit.margin_of(v)));
            };
            columns.push(number_column(name, one_after_the_other(&of), faulted));
        }
        let deployed: Vec<Option<bool>> = tables
            .iter()
            .flat_map(|table| &table.deployed)
            .zip(&faults)
            .map(|(&deployed, fault)| fault.is_none().then_some(deployed))
            .collect();
        columns.push(Column::new(DEPLOYED.into(), deployed));
        let faults: Vec<Option<&str>> = faults.iter().map(|fault| fault.map(Fault::name)).collect();
        columns.push(Column::new(FAULT.into(), faults));
        frame(rows, columns)
    }
}

/// A column of numbers, null where a sample faulted, if any has.
fn number_column(name: &str, values: Vec<f64>, faults: Option<&[Option<Fault>]>) -> Column {
    let Some(faults) = faults else {
        return Float64Chunked::from_vec(name.into(), values).into_column();
    };
    let values: Vec<Option<f64>> =
        values.iter().zip(faults).map(|(&v, fault)| fault.is_none().then_some(v)).collect();
    Column::new(name.into(), values)
}

/// Writes `outcomes.parquet`, row group by row group. What was written outlives the process: see
/// [`super::UnfinishedTable`].
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
        Self::start(path, study, parentage, TableWriter::create_durable)
    }

    /// Starts a file of which nothing is left if it is not finished, and which others may be writing as well: the
    /// last one to finish is the one that is read.
    ///
    /// # Errors
    /// If it cannot be made.
    pub fn create_whole(path: &Path, study: &Study, parentage: &Parentage) -> Result<Self> {
        Self::start(path, study, parentage, TableWriter::create)
    }

    fn start(
        path: &Path,
        study: &Study,
        parentage: &Parentage,
        create: impl FnOnce(&Path, &Schema, Vec<(String, String)>) -> Result<TableWriter>,
    ) -> Result<Self> {
        let layout = Layout::new(study);
        let schema = layout.frame(&[]).map_err(|reason| unusable(path, reason))?;
        let writer = create(path, schema.schema(), parentage.entries())?;
        Ok(OutcomesWriter { layout, writer })
    }

    /// Writes the next samples, in consecutive tables, as one row group.
    ///
    /// # Errors
    /// If the disk does not take them.
    pub fn write(&mut self, tables: &[OutcomeTable]) -> Result<()> {
        let frame = self.layout.frame(tables).map_err(|r| Error::argument(r.to_string()))?;
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
    first: u64,
    rows: u64,
    parentage: Parentage,
    checksums: Checksums,
}

fn unusable(path: &Path, reason: impl std::fmt::Display) -> Error {
    Error::file(
        path,
        "read",
        reason,
        "expected a table of samples that `reeldown run` or `reeldown shard` has written",
    )
}

impl OutcomesReader {
    /// Opens a file and reads its footer.
    ///
    /// # Errors
    /// If it is not there, not Parquet, damaged, or not written by this program.
    pub fn open(path: &Path) -> Result<Self> {
        // A pipe or a device could keep a reader waiting for ever.
        if std::fs::metadata(path).is_ok_and(|there| !there.is_file()) {
            return Err(unusable(path, "it is not a regular file"));
        }
        let mut file = File::open(path).map_err(|reason| unusable(path, reason))?;
        let checksums = Checksums::of(&mut file).map_err(|reason| unusable(path, reason))?;
        let none = "it is not a table of reeldown's with checksums: it is another file, is cut off, or was written \
                    by an earlier version";
        let checksums = checksums.ok_or_else(|| unusable(path, none))?;
        let file = ParquetFile::open(file).map_err(|reason| unusable(path, reason))?;
        let entry = |(key, value): &(String, String)| {
            let own = key != GROUPS_KEY && key != DIGEST_KEY;
            let key = key.strip_prefix(PREFIX).filter(|_| own)?;
            Some((key.to_owned(), value.clone()))
        };
        let parentage: BTreeMap<String, String> =
            file.metadata().iter().filter_map(entry).collect();
        if parentage.is_empty() {
            return Err(unusable(path, "its footer has no entry of reeldown's"));
        }
        let (parentage, rows) = (Parentage(parentage), file.rows());
        let first = parentage.0.get(FIRST_SAMPLE).map_or(Ok(0), |first| first.parse::<u64>());
        let first = first.ok().filter(|first| first.checked_add(rows).is_some());
        let first = first.ok_or_else(|| unusable(path, "its footer has no right first sample"))?;
        Ok(OutcomesReader { path: path.to_owned(), first, rows, parentage, checksums })
    }

    /// Where the file is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Index of its first sample.
    pub fn first(&self) -> u64 {
        self.first
    }

    /// Verifies every row group.
    ///
    /// # Errors
    /// If one does not match its checksum, or the file cannot be read.
    pub fn verify(&self) -> Result<()> {
        let mut file = File::open(&self.path).map_err(|reason| unusable(&self.path, reason))?;
        let verified = self.checksums.verify(&mut file, 0..u64::MAX);
        verified.map_err(|reason| unusable(&self.path, reason))
    }

    /// Number of samples in the file.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// What the footer says of the file's parents.
    pub fn parentage(&self) -> &Parentage {
        &self.parentage
    }

    /// Reads samples `first` … `first + rows − 1` of a file of this study, after verifying the row groups that
    /// hold them.
    ///
    /// # Errors
    /// If a row group does not match its checksum, the file has other columns than the study, or it cannot be read.
    pub fn read(&self, study: &Study, first: u64, rows: usize) -> Result<OutcomeTable> {
        let fail = |reason: String| unusable(&self.path, reason);
        let mut file = File::open(&self.path).map_err(|reason| unusable(&self.path, reason))?;
        let skipped = first.checked_sub(self.first);
        let none = || fail(format!("it has no {rows} samples from {first} on"));
        let end = |skipped: u64| skipped.checked_add(rows as u64).filter(|&end| end <= self.rows);
        let (skipped, end) =
            skipped.and_then(|skipped| Some((skipped, end(skipped)?))).ok_or_else(none)?;
        self.checksums.verify(&mut file, skipped..end).map_err(fail)?;
        let mut file = ParquetFile::open(file).map_err(fail)?;
        if end > file.rows() {
            return Err(none());
        }
        fn cells<T: Cell>(
            file: &mut ParquetFile<File>,
            name: &str,
            first: u64,
            rows: usize,
        ) -> std::result::Result<Vec<Option<T>>, String> {
            let place = file.place(name).ok_or_else(|| format!("it lacks the column `{name}`"))?;
            let cells = file.read(place, first, rows as u64);
            cells.map_err(|reason| format!("column `{name}`: {reason}"))
        }
        let layout = Layout::new(study);
        let mut table = OutcomeTable::new(first, rows, study.inputs.len());
        let mut numbers = |name: &str, target: &mut [f64]| -> Result<()> {
            let column = cells::<f64>(&mut file, name, skipped, rows).map_err(fail)?;
            for (value, read) in target.iter_mut().zip(column) {
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
        let deployed = cells::<bool>(&mut file, DEPLOYED, skipped, rows).map_err(fail)?;
        let faults = cells::<Arc<str>>(&mut file, FAULT, skipped, rows).map_err(fail)?;
        for (k, (deployed, fault)) in deployed.into_iter().zip(faults).enumerate() {
            table.deployed[k] = deployed.unwrap_or(false);
            table.faults[k] = match fault {
                None => None,
                Some(name) => Some(
                    Fault::from_name(&name).ok_or_else(|| fail(format!("unknown fault {name}")))?,
                ),
            };
        }
        Ok(table)
    }
}
