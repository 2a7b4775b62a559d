//! Columns of numbers out of a user's Parquet file, for empirical laws, joint samples and measured runs.

use super::checksums::verify_if_ours;
use super::reader::ParquetFile;
use crate::study::{NumberColumn, Parquet};
use std::fs::File;
use std::io::Cursor;
use std::path::Path;

/// The reader of Parquet files that a study is loaded with.
pub const PARQUET: Parquet = Parquet { table: read_number_table };

/// The numbers of a column of a Parquet file. A failure is its reason, in a few words.
///
/// # Errors
/// If the file cannot be read, has no such column, or the column holds no numbers or a null.
pub fn read_number_column(path: &Path, column: &str) -> Result<Vec<f64>, String> {
    let mut file = File::open(path).map_err(|reason| reason.to_string())?;
    verify_if_ours(&mut file)?;
    let mut file = ParquetFile::open(file)?;
    let place = file.place(column).ok_or_else(|| format!("there is no column {column}"))?;
    let values = file.column(place)?;
    values
        .into_iter()
        .enumerate()
        .map(|(k, value)| value.ok_or_else(|| format!("row {} of column {column} is null", k + 1)))
        .collect()
}

/// All columns of the bytes of a Parquet file, each with its numbers or why it holds none. A failure is its reason, in
/// a few words.
fn read_number_table(bytes: &[u8]) -> Result<Vec<NumberColumn>, String> {
    // One of our own tables is verified.
    verify_if_ours(&mut Cursor::new(bytes))?;
    let mut file = ParquetFile::open(Cursor::new(bytes))?;
    let names: Vec<String> = file.names().map(str::to_owned).collect();
    let column = |(place, name)| (name, file.column(place));
    Ok(names.into_iter().enumerate().map(column).collect())
}
