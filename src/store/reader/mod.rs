//! Reads Parquet: flat columns of numbers, texts and truths, in every encoding and compression that is in use.
//!
//! A file may come from anywhere, so nothing is reserved, decoded or followed on its word alone: what it claims is
//! held against the bytes that it has, and what it unpacks into against [`MEMORY`]. Columns that are not
//! asked for are not looked at, whatever they hold.
//!
//! Source of the format: Apache Parquet, format 2.11, `parquet.thrift`, `Encodings.md` and `LogicalTypes.md`.

mod encodings;
mod footer;
mod pages;
mod thrift;

use footer::Footer;
use std::io::{Read, Seek, SeekFrom};

pub(super) use encodings::Cell;

/// What a file may unpack into, bytes: this, or a thousand times its size if that is more. A column of one number
/// four million times is a hundred bytes long and takes as much.
const MEMORY: u64 = 64 << 20;

/// The reason why a file is not read that breaks the rules of the format.
fn damaged() -> String {
    "the file is damaged".to_owned()
}

/// What may still be unpacked, bytes.
#[derive(Debug)]
struct Budget(u64);

impl Budget {
    fn charge(&mut self, count: usize, size: usize) -> Result<(), String> {
        let bytes = (count as u64).checked_mul(size as u64);
        self.0 = bytes.and_then(|bytes| self.0.checked_sub(bytes)).ok_or_else(|| {
            "it claims to unpack into more than a thousand times its size".to_owned()
        })?;
        Ok(())
    }
}

/// A Parquet file whose footer has been read.
#[derive(Debug)]
pub(super) struct ParquetFile<R> {
    source: R,
    footer: Footer,
    budget: Budget,
}

impl<R: Read + Seek> ParquetFile<R> {
    /// Reads the footer of a file. A failure is its reason, in a few words.
    pub fn open(mut source: R) -> Result<Self, String> {
        let length = source.seek(SeekFrom::End(0)).map_err(|reason| reason.to_string())?;
        let footer = footer::read(&mut source, length)?;
        let budget = Budget(MEMORY.max(length.saturating_mul(1000)));
        Ok(ParquetFile { source, footer, budget })
    }

    /// Number of rows.
    pub fn rows(&self) -> u64 {
        self.footer.rows
    }

    /// Keys and values in the footer.
    pub fn metadata(&self) -> &[(String, String)] {
        &self.footer.metadata
    }

    /// The names of the columns, in their order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.footer.columns.iter().map(|column| column.name.as_str())
    }

    /// The place of a column.
    pub fn place(&self, name: &str) -> Option<usize> {
        self.names().position(|own| own == name)
    }

    /// Rows `first` … `first` + `rows` − 1 of the column at `place`; what is missing is `None`. A failure is its reason,
    /// in a few words.
    pub fn read<T: Cell>(
        &mut self,
        place: usize,
        first: u64,
        rows: u64,
    ) -> Result<Vec<Option<T>>, String> {
        let column = self.footer.columns.get(place).ok_or("there is no such column")?;
        T::accepts(&column.kind)?;
        let chunk = column.chunk.ok_or_else(damaged)?;
        let end = first.checked_add(rows).filter(|&end| end <= self.footer.rows);
        let end = end.ok_or("it has fewer rows")?;
        let mut found = Vec::new();
        let mut before = 0;
        for group in &self.footer.groups {
            let after = before + group.rows as u64;
            let (from, to) = (first.max(before), end.min(after));
            if from < to {
                let chunk = group.chunks.get(chunk).ok_or_else(damaged)?;
                let mut cells = pages::read::<T>(
                    &mut self.source,
                    column,
                    chunk,
                    group.rows,
                    &mut self.budget,
                )?;
                cells.truncate((to - before) as usize);
                cells.drain(..(from - before) as usize);
                found.append(&mut cells);
            }
            before = after;
        }
        Ok(found)
    }

    /// All rows of the column at `place`.
    pub fn column<T: Cell>(&mut self, place: usize) -> Result<Vec<Option<T>>, String> {
        self.read(place, 0, self.footer.rows)
    }
}
