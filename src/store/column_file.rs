//! One column of numbers out of a user's Parquet file, for empirical laws.

use super::damage;
use polars::prelude::{DataType, ParquetReader, PolarsError, SerReader};
use std::fs::File;
use std::path::Path;

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
