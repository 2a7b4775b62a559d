//! Parquet through polars: tables with metadata in the footer, one row group a batch.

use super::atomic::{AtomicFile, cannot_write};
use crate::error::Result;
use polars::prelude::{
    BatchedWriter, Column, DataFrame, KeyValueMetadata, ParquetCompression, ParquetWriter,
    PolarsResult, Schema,
};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// One column of a small table.
#[derive(Debug, Clone)]
pub enum Field {
    /// Numbers; `None` is null.
    Number(Vec<Option<f64>>),
    /// Texts; `None` is null.
    Text(Vec<Option<String>>),
    /// Whole numbers.
    Count(Vec<u64>),
}

impl Field {
    fn column(self, name: &str) -> Column {
        match self {
            Field::Number(values) => Column::new(name.into(), values),
            Field::Text(values) => Column::new(name.into(), values),
            Field::Count(values) => Column::new(name.into(), values),
        }
    }
}

/// A Parquet file under way.
pub(super) struct TableWriter {
    inner: BatchedWriter<SharedFile>,
    file: SharedFile,
    path: PathBuf,
}

/// polars keeps what it writes to; the other handle ends the file.
#[derive(Clone)]
struct SharedFile(Arc<Mutex<AtomicFile>>);

impl Write for SharedFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).flush()
    }
}

impl TableWriter {
    /// Starts a table.
    ///
    /// Sampled doubles do not compress, so the pages are left as they are: that is several times faster
    /// to write, and every reader reads it.
    pub(super) fn create(
        path: &Path,
        schema: &Schema,
        metadata: Vec<(String, String)>,
    ) -> Result<Self> {
        let file = SharedFile(Arc::new(Mutex::new(AtomicFile::create(path)?)));
        let inner = ParquetWriter::new(file.clone())
            .with_compression(ParquetCompression::Uncompressed)
            .with_key_value_metadata(Some(KeyValueMetadata::from_static(metadata)))
            .batched(schema)
            .map_err(|reason| cannot_write(path, reason))?;
        Ok(TableWriter { inner, file, path: path.to_owned() })
    }

    /// Writes a row group.
    pub(super) fn write(&mut self, frame: &DataFrame) -> Result<()> {
        self.inner.write_batch(frame).map_err(|reason| cannot_write(&self.path, reason))
    }

    /// Writes the footer and gives the file its name.
    pub(super) fn finish(self) -> Result<()> {
        self.inner.finish().map_err(|reason| cannot_write(&self.path, reason))?;
        drop(self.inner);
        match Arc::into_inner(self.file.0) {
            Some(file) => file.into_inner().unwrap_or_else(PoisonError::into_inner).commit(),
            None => Err(cannot_write(&self.path, "the file is still in use")),
        }
    }
}

/// Columns of one length as a frame.
pub(super) fn frame(rows: usize, columns: Vec<Column>) -> PolarsResult<DataFrame> {
    DataFrame::new(rows, columns)
}

/// Writes a small table, whole.
///
/// # Errors
/// If the columns differ in length or the file cannot be written.
pub fn write_table(
    path: &Path,
    columns: Vec<(String, Field)>,
    metadata: Vec<(String, String)>,
) -> Result<()> {
    let rows = columns.first().map_or(0, |(_, field)| match field {
        Field::Number(values) => values.len(),
        Field::Text(values) => values.len(),
        Field::Count(values) => values.len(),
    });
    let columns = columns.into_iter().map(|(name, field)| field.column(&name)).collect();
    let frame = frame(rows, columns).map_err(|reason| cannot_write(path, reason))?;
    let mut writer = TableWriter::create(path, frame.schema(), metadata)?;
    writer.write(&frame)?;
    writer.finish()
}
