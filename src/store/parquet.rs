//! Parquet through polars: tables with metadata in the footer, one row group a batch.

use super::atomic::{AtomicFile, cannot_write};
use super::checksums::MAGIC;
use super::footer::Footer;
use super::journal::Journal;
use crate::error::Result;
use polars::prelude::{
    ArrowSchema, Column, CompatLevel, DataFrame, PolarsResult, Schema, SchemaExt,
};
use polars_parquet::write::{
    CompressionOptions, Encoding, FileWriter, KeyValue, StatisticsOptions, Version, WriteOptions,
    row_group_iter, schema_to_metadata_key,
};
use polars_parquet_format::FileMetaData;
use std::io::Write;
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

/// A Parquet file under way. polars encodes the row groups, one by one in memory; the footer, with their checksums,
/// is our own.
pub(super) struct TableWriter {
    file: AtomicFile,
    schema: ArrowSchema,
    footer: Footer,
    journal: Option<Journal>,
    path: PathBuf,
}

impl TableWriter {
    /// Starts a table.
    pub(super) fn create(
        path: &Path,
        schema: &Schema,
        metadata: Vec<(String, String)>,
    ) -> Result<Self> {
        Self::start(path, schema, metadata, None)
    }

    /// Starts a table whose finished row groups outlive the death of this process: see [`Journal`].
    pub(super) fn create_durable(
        path: &Path,
        schema: &Schema,
        metadata: Vec<(String, String)>,
    ) -> Result<Self> {
        Self::start(path, schema, metadata, Some(Journal::new(path)?))
    }

    fn start(
        path: &Path,
        schema: &Schema,
        metadata: Vec<(String, String)>,
        journal: Option<Journal>,
    ) -> Result<Self> {
        let mut file = match &journal {
            Some(journal) => AtomicFile::create_as(path, journal.part())?,
            None => AtomicFile::create(path)?,
        };
        let schema = schema.to_arrow(CompatLevel::newest());
        let empty = encode(&schema, |_| Ok(())).map_err(|reason| cannot_write(path, reason))?;
        let own = metadata.into_iter().map(|(key, value)| KeyValue { key, value: Some(value) });
        let entries = std::iter::once(schema_to_metadata_key(&schema)).chain(own).collect();
        file.write_all(&MAGIC).map_err(|reason| cannot_write(path, reason))?;
        let footer = Footer::new(empty.1, entries);
        Ok(TableWriter { file, schema, footer, journal, path: path.to_owned() })
    }

    /// Writes a row group.
    pub(super) fn write(&mut self, frame: &DataFrame) -> Result<()> {
        for batch in frame.iter_chunks(CompatLevel::newest(), false) {
            let fail = |reason: &dyn std::fmt::Display| cannot_write(&self.path, reason);
            let encoded = encode(&self.schema, |writer| {
                let fields = writer.parquet_schema().fields().to_vec();
                let plain = vec![vec![Encoding::Plain]; fields.len()];
                let rows = batch.len() as u64;
                writer.write(rows, row_group_iter(batch, plain.into(), fields, OPTIONS))
            });
            let (bytes, metadata) = encoded.map_err(|reason| fail(&reason))?;
            for group in metadata.row_groups {
                // After the pages come indices of them, which nobody needs where a column has one page.
                let pages = group.columns.iter().filter_map(|column| column.offset_index_offset);
                let end = pages.min().map_or(bytes.len(), |end| end as usize);
                let bytes = bytes.get(MAGIC.len()..end).unwrap_or_default();
                self.file.write_all(bytes).map_err(|reason| fail(&reason))?;
                self.footer.push(group, bytes);
                if let Some(journal) = &mut self.journal {
                    journal.note(&mut self.file, &self.footer)?;
                }
            }
        }
        Ok(())
    }

    /// Writes the footer and gives the file its name.
    pub(super) fn finish(mut self) -> Result<()> {
        let fail = |reason: &dyn std::fmt::Display| cannot_write(&self.path, reason);
        let footer = self.footer.bytes().map_err(|reason| fail(&reason))?;
        self.file.write_all(&footer).map_err(|reason| fail(&reason))?;
        self.file.commit()?;
        self.journal.map_or(Ok(()), Journal::close)
    }
}

/// A Parquet file in memory, with the row groups that `write` puts in, and what its footer says.
fn encode(
    schema: &ArrowSchema,
    write: impl FnOnce(&mut FileWriter<Vec<u8>>) -> PolarsResult<()>,
) -> PolarsResult<(Vec<u8>, FileMetaData)> {
    let mut writer = FileWriter::try_new(Vec::new(), schema.clone(), OPTIONS)?;
    write(&mut writer)?;
    writer.end(Some(Vec::new()))?;
    Ok(writer.into_inner_and_metadata())
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
