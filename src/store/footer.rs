//! The footer of a table: what Parquet wants to know of its row groups, and the checksum of each.
//!
//! A row group's entry and its checksum are known as soon as it is written, so the footer of a table that is not
//! finished can be kept in a journal, a line a row group, and be put under the table if its writer dies.

use super::checksums::{DIGEST_KEY, GROUPS_KEY, GroupSum, MAGIC, NO_DIGEST, sha256, value_after};
use polars_parquet::parquet::metadata::KeyValue;
use polars_parquet_format::thrift::protocol::{
    ReadThrift, TCompactInputProtocol, TCompactOutputProtocol,
};
use polars_parquet_format::{FileMetaData, RowGroup};

/// A footer under way.
#[derive(Debug, Clone)]
pub(super) struct Footer {
    metadata: FileMetaData,
    sums: Vec<GroupSum>,
}

impl Footer {
    /// The footer of a table of no rows, from `metadata` as polars writes it, with entries of our own.
    pub(super) fn new(mut metadata: FileMetaData, entries: Vec<KeyValue>) -> Self {
        metadata.row_groups.clear();
        metadata.num_rows = 0;
        metadata.key_value_metadata = Some(entries);
        Footer { metadata, sums: Vec::new() }
    }

    /// Offset after the last row group.
    pub(super) fn end(&self) -> u64 {
        self.sums.last().map_or(MAGIC.len() as u64, |sum| sum.end)
    }

    /// The row groups with their checksums.
    pub(super) fn sums(&self) -> &[GroupSum] {
        &self.sums
    }

    /// Takes in the next row group: its bytes, and its entry as if it were the first of a file.
    pub(super) fn push(&mut self, mut group: RowGroup, bytes: &[u8]) {
        let start = self.end();
        let shift = start as i64 - MAGIC.len() as i64;
        let moved = |offset: &mut Option<i64>| *offset = offset.map(|at| at + shift);
        moved(&mut group.file_offset);
        group.ordinal = i16::try_from(self.sums.len()).ok();
        for column in &mut group.columns {
            // Writers that put no second copy of a column's entry beside its pages say 0.
            column.file_offset = 0;
            (column.offset_index_offset, column.offset_index_length) = (None, None);
            (column.column_index_offset, column.column_index_length) = (None, None);
            if let Some(entry) = &mut column.meta_data {
                entry.data_page_offset += shift;
                moved(&mut entry.index_page_offset);
                moved(&mut entry.dictionary_page_offset);
            }
        }
        self.take(GroupSum {
            rows: group.num_rows as u64,
            end: start + bytes.len() as u64,
            sha256: sha256(bytes),
        });
        self.metadata.row_groups.push(group);
    }

    fn take(&mut self, sum: GroupSum) {
        self.metadata.num_rows += sum.rows as i64;
        self.sums.push(sum);
    }

    /// Leaves out the row groups from number `groups` on.
    pub(super) fn truncate(&mut self, groups: usize) {
        self.metadata.row_groups.truncate(groups);
        self.sums.truncate(groups);
        self.metadata.num_rows = self.sums.iter().map(|sum| sum.rows as i64).sum();
    }

    /// The bytes that end the file: the footer with its checksums, its length, and the magic word.
    ///
    /// # Errors
    /// If it cannot be encoded; the reason in a few words.
    pub(super) fn bytes(&self) -> Result<Vec<u8>, String> {
        let mut metadata = self.metadata.clone();
        let sums = serde_json::to_string(&self.sums).map_err(|reason| reason.to_string())?;
        // The checksum of the footer comes last, where it is looked for.
        metadata.key_value_metadata.get_or_insert_default().extend([
            KeyValue { key: GROUPS_KEY.to_owned(), value: Some(sums) },
            KeyValue { key: DIGEST_KEY.to_owned(), value: Some(NO_DIGEST.to_owned()) },
        ]);
        let mut bytes = encoded(|protocol| metadata.write_to_out_protocol(protocol))?;
        let digest = sha256(&bytes);
        let place = value_after(&bytes, DIGEST_KEY).ok_or("the footer's checksum has no place")?;
        bytes[place].copy_from_slice(digest.as_bytes());
        let length = u32::try_from(bytes.len()).map_err(|_| "the footer is too long")?;
        bytes.extend_from_slice(&length.to_le_bytes());
        bytes.extend_from_slice(&MAGIC);
        Ok(bytes)
    }

    /// A journal's first line: everything but the row groups.
    ///
    /// # Errors
    /// If it cannot be encoded.
    pub(super) fn first_line(&self) -> Result<String, String> {
        let mut empty = self.clone();
        empty.truncate(0);
        let bytes = encoded(|protocol| empty.metadata.write_to_out_protocol(protocol))?;
        Ok(line("table", &bytes))
    }

    /// A journal's line for the last row group.
    ///
    /// # Errors
    /// If it cannot be encoded, or there is none.
    pub(super) fn last_line(&self) -> Result<String, String> {
        let (Some(group), Some(sum)) = (self.metadata.row_groups.last(), self.sums.last()) else {
            return Err("there is no row group".to_owned());
        };
        let bytes = encoded(|protocol| group.write_to_out_protocol(protocol))?;
        let sum = serde_json::to_string(sum).map_err(|reason| reason.to_string())?;
        Ok(line(&sum, &bytes))
    }

    /// The footer of a journal, as far as its lines are whole; `None` if not even the first is.
    pub(super) fn from_journal(text: &[u8]) -> Option<Footer> {
        let mut lines = text.split_inclusive(|&byte| byte == b'\n');
        let (_, bytes) = whole(lines.next()?)?;
        let mut footer = Footer { metadata: decoded(&bytes)?, sums: Vec::new() };
        for line in lines {
            let Some((sum, bytes)) = whole(line) else { break };
            let (Ok(sum), Some(group)) = (serde_json::from_str(&sum), decoded(&bytes)) else {
                break;
            };
            footer.take(sum);
            footer.metadata.row_groups.push(group);
        }
        Some(footer)
    }
}

fn encoded(
    write: impl FnOnce(
        &mut TCompactOutputProtocol<&mut Vec<u8>>,
    ) -> polars_parquet_format::thrift::Result<usize>,
) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    write(&mut TCompactOutputProtocol::new(&mut bytes)).map_err(|reason| reason.to_string())?;
    Ok(bytes)
}

fn decoded<T: ReadThrift>(bytes: &[u8]) -> Option<T> {
    // What the entries take in memory is at most some dozen times what they take as text.
    let most = bytes.len().saturating_mul(64) + 4096;
    T::read_from_in_protocol(&mut TCompactInputProtocol::new(bytes, most)).ok()
}

/// A line of a journal: the checksum of what follows, a word, and bytes in hexadecimal digits.
fn line(word: &str, bytes: &[u8]) -> String {
    let digits: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    let rest = format!("{word} {digits}");
    format!("{} {rest}\n", sha256(rest.as_bytes()))
}

/// Word and bytes of a line that is whole.
fn whole(line: &[u8]) -> Option<(String, Vec<u8>)> {
    let text = std::str::from_utf8(line).ok()?.strip_suffix('\n')?;
    let (digest, rest) = text.split_once(' ')?;
    if sha256(rest.as_bytes()) != digest {
        return None;
    }
    let (word, digits) = rest.rsplit_once(' ')?;
    let byte = |k: usize| u8::from_str_radix(digits.get(2 * k..2 * k + 2)?, 16).ok();
    let bytes = (0..digits.len() / 2).map(byte).collect::<Option<Vec<u8>>>()?;
    Some((word.to_owned(), bytes))
}
