//! Parquet through polars: tables with metadata in the footer, one row group a batch.

use super::atomic::{AtomicFile, cannot_write};
use crate::error::Result;
use polars::prelude::{Column, CompatLevel, DataFrame, PolarsResult, Schema, SchemaExt};
use polars_parquet::write::{
    CompressionOptions, Encoding, FileWriter, KeyValue, StatisticsOptions, Version, WriteOptions,
    row_group_iter, schema_to_metadata_key,
};
use std::path::{Path, PathBuf};

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

/// How tables are written. Sampled doubles do not compress, nor do they repeat: pages are left as they are, without
/// compression or a dictionary. Nor does the smallest and largest of tens of thousands of draws exclude a row
/// group from anybody's query. polars' own writer would look for both in every column, which cost as much again.
const OPTIONS: WriteOptions = WriteOptions {
    statistics: StatisticsOptions {
        min_value: false,
        max_value: false,
        distinct_count: false,
        null_count: true,
        binary_statistics_truncate_length: None,
    },
    version: Version::V1,
    compression: CompressionOptions::Uncompressed,
    data_page_size: None,
};

/// A Parquet file under way.
pub(super) struct TableWriter {
    inner: FileWriter<AtomicFile>,
    metadata: Vec<(String, String)>,
    path: PathBuf,
}

impl TableWriter {
    /// Starts a table.
    pub(super) fn create(
        path: &Path,
        schema: &Schema,
        metadata: Vec<(String, String)>,
    ) -> Result<Self> {
        let schema = schema.to_arrow(CompatLevel::newest());
        let inner = FileWriter::try_new(AtomicFile::create(path)?, schema, OPTIONS)
            .map_err(|reason| cannot_write(path, reason))?;
        Ok(TableWriter { inner, metadata, path: path.to_owned() })
    }

    /// Writes a row group.
    pub(super) fn write(&mut self, frame: &DataFrame) -> Result<()> {
        for batch in frame.iter_chunks(CompatLevel::newest(), false) {
            let fields = self.inner.parquet_schema().fields().to_vec();
            let plain = vec![vec![Encoding::Plain]; fields.len()];
            let rows = batch.len() as u64;
            let group = row_group_iter(batch, plain.into(), fields, OPTIONS);
            self.inner.write(rows, group).map_err(|reason| cannot_write(&self.path, reason))?;
        }
        Ok(())
    }

    /// Writes the footer and gives the file its name.
    pub(super) fn finish(mut self) -> Result<()> {
        let own =
            self.metadata.into_iter().map(|(key, value)| KeyValue { key, value: Some(value) });
        let entries = std::iter::once(schema_to_metadata_key(self.inner.schema())).chain(own);
        let entries = entries.collect();
        self.inner.end(Some(entries)).map_err(|reason| cannot_write(&self.path, reason))?;
        self.inner.into_inner().commit()
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
