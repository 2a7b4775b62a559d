//! Columns of numbers out of a user's Parquet file, for empirical laws and joint samples.

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
    let file = File::open(path).map_err(|reason| reason.to_string())?;
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
    let file = File::open(path).map_err(|reason| reason.to_string())?;
    let columns = damage::read(|| {
        let frame = ParquetReader::new(file).finish()?;
        let numbers = |column: &polars::prelude::Column| -> Result<Vec<Option<f64>>, String> {
            if !column.dtype().is_primitive_numeric() {
                return Err("it holds no numbers".to_owned());
            }
            let cast = column.cast(&DataType::Float64).map_err(|reason| reason.to_string())?;
            let values = cast.f64().map_err(|reason| reason.to_string())?;
            Ok(values.iter().collect())
        };
        let columns = frame.columns().iter();
        let columns = columns.map(|column| (column.name().to_string(), numbers(column)));
        Ok::<Vec<_>, PolarsError>(columns.collect())
    })?;
    Ok(columns
        .into_iter()
        .map(|(name, values)| {
            let values = values.and_then(|values| without_nulls(&name, values));
            (name, values)
        })
        .collect())
}

fn without_nulls(column: &str, values: Vec<Option<f64>>) -> Result<Vec<f64>, String> {
    values
        .into_iter()
        .enumerate()
        .map(|(k, value)| value.ok_or_else(|| format!("row {} of column {column} is null", k + 1)))
        .collect()
}

/// Every column of numbers of a Parquet file, by name; a null is `None`. Other columns are left out. A failure
/// is its reason, in a few words.
///
/// # Errors
/// If the file cannot be read.
pub fn read_number_columns(path: &Path) -> Result<NumberColumns, String> {
    let file = File::open(path).map_err(|reason| reason.to_string())?;
    damage::read(|| {
        let frame = ParquetReader::new(file).finish()?;
        let mut columns = Vec::new();
        for column in frame.columns() {
            if column.dtype().is_primitive_numeric() {
                let values = column.cast(&DataType::Float64)?;
                columns.push((column.name().to_string(), values.f64()?.iter().collect()));
            }
        }
        Ok::<NumberColumns, PolarsError>(columns)
    })
}

/// Names and values of columns.
pub type NumberColumns = Vec<(String, Vec<Option<f64>>)>;
