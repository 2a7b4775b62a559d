//! The pages of a column chunk.

use super::encodings::{self, Cell, Encoded};
use super::footer::{Chunk, Column, bytes_at};
use super::thrift::{Bytes, Value};
use super::{Budget, damaged};
use polars_parquet::parquet::compression::{Compression, DecompressionContext, decompress};
use std::borrow::Cow;
use std::io::{Read, Seek};

/// The values of a column in a row group of `rows`.
pub(super) fn read<T: Cell>(
    source: &mut (impl Read + Seek),
    column: &Column,
    chunk: &Chunk,
    rows: usize,
    budget: &mut Budget,
) -> Result<Vec<Option<T>>, String> {
    if chunk.values != rows {
        return Err(damaged());
    }
    budget.charge(rows, size_of::<Option<T>>() + size_of::<u32>())?;
    budget.charge(chunk.length, 1)?;
    let bytes = bytes_at(source, chunk.start, chunk.length)?;
    let mut bytes = Bytes::new(&bytes);
    let mut pages = Pages { column, codec: chunk.codec, budget, dictionary: None };
    let mut cells = Vec::new();
    while cells.len() < rows {
        let header = bytes.structure()?;
        let page = bytes.take(header.count(3)?)?;
        pages.page(&header, page, rows, &mut cells)?;
    }
    Ok(cells)
}

struct Pages<'c, T> {
    column: &'c Column,
    codec: i64,
    budget: &'c mut Budget,
    dictionary: Option<Vec<T>>,
}

impl<T: Cell> Pages<'_, T> {
    /// Adds the cells of a page to those before it, of which there are `rows` in all.
    fn page(
        &mut self,
        header: &Value<'_>,
        page: &[u8],
        rows: usize,
        cells: &mut Vec<Option<T>>,
    ) -> Result<(), String> {
        let unpacked = header.count(2)?;
        let about = |field| header.field(field).ok_or_else(damaged);
        let most = rows - cells.len();
        let few = |count: usize| if count <= most { Ok(count) } else { Err(damaged()) };
        match header.whole(1) {
            Some(0) => {
                let about = about(5)?;
                let count = few(about.count(1)?)?;
                let page = self.unpacked(page, unpacked)?;
                let mut page = Bytes::new(&page);
                let mut levels = None;
                if self.column.optional {
                    if about.whole(3) != Some(3) {
                        return Err("its levels are packed in a way that is not read".to_owned());
                    }
                    let length = page.u32()? as usize;
                    levels = Some(encodings::hybrid(page.take(length)?, 1, count)?);
                }
                self.cells(about.whole(2), page.rest(), count, levels, cells)
            }
            Some(3) => {
                let about = about(8)?;
                let count = few(about.count(1)?)?;
                let length = about.count(5)?;
                if about.count(6)? != 0 {
                    return Err(damaged());
                }
                let (levels, values) = page.split_at_checked(length).ok_or_else(damaged)?;
                let levels = match self.column.optional {
                    true => Some(encodings::hybrid(levels, 1, count)?),
                    false => None,
                };
                let values = match about.flag(7) {
                    Some(false) => Cow::Borrowed(values),
                    _ => {
                        self.unpacked(values, unpacked.checked_sub(length).ok_or_else(damaged)?)?
                    }
                };
                self.cells(about.whole(4), &values, count, levels, cells)
            }
            Some(2) => {
                let count = about(7)?.count(1)?;
                let page = self.unpacked(page, unpacked)?;
                let dictionary = T::plain(&self.column.kind, &page, count)?;
                self.budget.charge(count, size_of::<T>())?;
                self.dictionary = Some(dictionary);
                Ok(())
            }
            // Indexes and what later versions may add hold no values.
            _ => Ok(()),
        }
    }

    /// Adds `count` cells, of which those with a level of 0 are missing.
    fn cells(
        &self,
        encoding: Option<i64>,
        bytes: &[u8],
        count: usize,
        levels: Option<Vec<u32>>,
        cells: &mut Vec<Option<T>>,
    ) -> Result<(), String> {
        let there = levels.as_ref().map_or(count, |l| l.iter().filter(|&&l| l == 1).count());
        let encoded = Encoded { kind: &self.column.kind, bytes, count: there };
        let encoding = encoding.ok_or_else(damaged)?;
        let mut values = encoded.values(encoding, self.dictionary.as_deref())?.into_iter();
        match levels {
            None => cells.extend(values.map(Some)),
            Some(levels) => {
                cells.extend(levels.iter().map(|&l| if l == 1 { values.next() } else { None }));
            }
        }
        Ok(())
    }

    /// A page's bytes, which are `size` when unpacked.
    fn unpacked<'p>(&mut self, page: &'p [u8], size: usize) -> Result<Cow<'p, [u8]>, String> {
        let codec = match self.codec {
            0 => return Ok(Cow::Borrowed(page)),
            1 => Compression::Snappy,
            2 => Compression::Gzip,
            4 => Compression::Brotli,
            5 => Compression::Lz4,
            6 => Compression::Zstd,
            7 => Compression::Lz4Raw,
            other => return Err(format!("its compression, number {other}, is not read")),
        };
        self.budget.charge(size, 1)?;
        let mut unpacked = vec![0; size];
        if size > 0 {
            decompress(codec, page, &mut unpacked, &mut DecompressionContext::Unset)
                .map_err(|_| damaged())?;
        }
        Ok(Cow::Owned(unpacked))
    }
}
