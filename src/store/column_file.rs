//! Columns of numbers out of a user's Parquet file, for empirical laws and joint samples.

use super::checksums::verify_if_ours;
use super::damage;
use crate::study::{Parquet, SampleColumn};
use polars::prelude::{DataType, ParquetReader, PolarsError, SerReader};
use std::fs::File;
use std::path::Path;

/// The readers of Parquet files that a study is loaded with.
pub const PARQUET: Parquet = Parquet { column: read_number_column, table: read_number_table };

/// The numbers of a column of a Parquet file. A failure is its reason, in a few words.
///
/// # Errors
/// If the file cannot be read, has no such column, or the column holds no numbers or a null.
pub fn read_number_column(path: &Path, column: &str) -> Result<Vec<f64>, String> {
    let file = open(path)?;
    let values = damage::read(|| {
        let frame =
            ParquetReader::new(file).with_columns(Some(vec![column.to_owned()])).finish()?;
        let values = frame.column(column)?.cast(&DataType::Float64)?;
        Ok::<Vec<Option<f64>>, PolarsError>(values.f64()?.iter().collect())
    })?;
    without_nulls(column, values)
}

/// All columns of a Parquet file, each with its numbers or why it holds none. A failure is its reason, in a few
/// words.
///
/// # Errors
/// If the file cannot be read.
fn read_number_table(path: &Path) -> Result<Vec<SampleColumn>, String> {
    let complete = |(name, values): (String, Option<Vec<Option<f64>>>)| {
        let values = values.ok_or_else(|| "it holds no numbers".to_owned());
        let values = values.and_then(|values| without_nulls(&name, values));
        (name, values)
    };
    Ok(read_columns(path)?.into_iter().map(complete).collect())
}

/// Every column of numbers of a Parquet file, by name; a null is `None`. Other columns are left out. A failure
/// is its reason, in a few words.
///
/// # Errors
/// If the file cannot be read.
pub fn read_number_columns(path: &Path) -> Result<NumberColumns, String> {
    let columns = read_columns(path)?.into_iter();
    Ok(columns.filter_map(|(name, values)| Some((name, values?))).collect())
}

/// Names and values of columns.
pub type NumberColumns = Vec<(String, Vec<Option<f64>>)>;

/// A column by name, with its values where they are numbers.
type AnyColumn = (String, Option<Vec<Option<f64>>>);

/// Every column of a Parquet file.
fn read_columns(path: &Path) -> Result<Vec<AnyColumn>, String> {
    let file = open(path)?;
    damage::read(|| {
        let frame = ParquetReader::new(file).finish()?;
        let mut columns = Vec::new();
        for column in frame.columns() {
            let values = if column.dtype().is_primitive_numeric() {
                Some(column.cast(&DataType::Float64)?.f64()?.iter().collect())
            } else {
                None
            };
            columns.push((column.name().to_string(), values));
        }
        Ok::<_, PolarsError>(columns)
    })
}

/// Opens a file; one of our own tables is verified.
fn open(path: &Path) -> Result<File, String> {
    let mut file = File::open(path).map_err(|reason| reason.to_string())?;
    verify_if_ours(&mut file)?;
    Ok(file)
}

fn without_nulls(column: &str, values: Vec<Option<f64>>) -> Result<Vec<f64>, String> {
    values
        .into_iter()
        .enumerate()
        .map(|(k, value)| value.ok_or_else(|| format!("row {} of column {column} is null", k + 1)))
        .collect()
}
