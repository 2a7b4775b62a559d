//! Checksums of a table that this program wrote: of every row group and of the footer, verified before anything
//! of the table is believed.
//!
//! A file is its magic word, its row groups without a gap, its footer, the footer's length and the magic word
//! again, and each of these is checked: no byte of a table can change unnoticed. polars writes no checksums of
//! pages; these are of whole row groups, in the footer's own entries, which other readers pass over.

use serde::{Deserialize, Serialize};
use std::io::{self, Read, Seek, SeekFrom};
use std::ops::Range;

/// What begins and ends a Parquet file.
pub(super) const MAGIC: [u8; 4] = *b"PAR1";
/// The footer's entry that lists the row groups.
pub(super) const GROUPS_KEY: &str = "reeldown.row_groups";
/// The footer's entry with the checksum of the footer itself, taken with zeros in its own place.
pub(super) const DIGEST_KEY: &str = "reeldown.footer_sha256";
/// What stands in the checksum's place while the checksum is taken.
pub(super) const NO_DIGEST: &str =
    "0000000000000000000000000000000000000000000000000000000000000000";
/// Bytes that are read at once.
const CHUNK: usize = 1 << 20;

/// Where a row group ends, and its checksum.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct GroupSum {
    /// Number of rows.
    pub rows: u64,
    /// Offset in the file after its last byte; it begins where the one before ended.
    pub end: u64,
    /// SHA-256 of its bytes, in hexadecimal digits.
    pub sha256: String,
}

/// The SHA-256 of bytes, in hexadecimal digits.
pub(super) fn sha256(bytes: &[u8]) -> String {
    crate::study::sha256(bytes)
}

/// Where the value of an entry stands in an encoded footer: the last one of that key.
pub(super) fn value_after(footer: &[u8], key: &str) -> Option<Range<usize>> {
    let at = footer.windows(key.len()).rposition(|window| window == key.as_bytes())?;
    // Thrift's compact protocol: the next field's header (a string, one further on), then a length of seven bits
    // a byte, the lowest first.
    let mut next = at + key.len();
    if *footer.get(next)? != 0x18 {
        return None;
    }
    let mut length = 0usize;
    for shift in (0..28).step_by(7) {
        next += 1;
        let byte = *footer.get(next)?;
        length |= usize::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            let value = next + 1..next + 1 + length;
            return (value.end <= footer.len()).then_some(value);
        }
    }
    None
}

/// The checksums of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Checksums {
    groups: Vec<GroupSum>,
}

impl Checksums {
    /// Reads and verifies the footer of a file. `None` if it bears no checksums: it is not Parquet, or a table
    /// that another program wrote.
    ///
    /// # Errors
    /// If the footer is damaged, or the file cannot be read; the reason in a few words.
    pub(super) fn of(file: &mut (impl Read + Seek)) -> Result<Option<Self>, String> {
        let damaged = || "its footer is damaged: it does not match its checksum".to_owned();
        let Some((start, mut footer)) = read_footer(file).map_err(|why| why.to_string())? else {
            return Ok(None);
        };
        let (Some(groups), Some(place)) =
            (value_after(&footer, GROUPS_KEY), value_after(&footer, DIGEST_KEY))
        else {
            let ours = |key: &str| footer.windows(key.len()).any(|w| w == key.as_bytes());
            return if ours(GROUPS_KEY) || ours(DIGEST_KEY) { Err(damaged()) } else { Ok(None) };
        };
        if place.len() != NO_DIGEST.len() {
            return Err(damaged());
        }
        let stated = footer[place.clone()].to_vec();
        footer[place].copy_from_slice(NO_DIGEST.as_bytes());
        if sha256(&footer).as_bytes() != stated {
            return Err(damaged());
        }
        let groups: Vec<GroupSum> =
            serde_json::from_slice(&footer[groups]).map_err(|_| damaged())?;
        let begin = MAGIC.len() as u64;
        let ends = std::iter::once(begin).chain(groups.iter().map(|group| group.end));
        let mut magic = [0; MAGIC.len()];
        let read = file.rewind().and_then(|()| file.read_exact(&mut magic));
        read.map_err(|why| why.to_string())?;
        if !ends.clone().is_sorted() || ends.last() != Some(start) || magic != MAGIC {
            return Err("it is damaged: its row groups do not fill it".to_owned());
        }
        Ok(Some(Checksums { groups }))
    }

    /// Verifies the row groups that hold any of `rows`.
    ///
    /// # Errors
    /// The first one whose bytes do not match, with its rows; or why the file cannot be read.
    pub(super) fn verify(
        &self,
        file: &mut (impl Read + Seek),
        rows: Range<u64>,
    ) -> Result<(), String> {
        let (mut first, mut start) = (0, MAGIC.len() as u64);
        for (k, group) in self.groups.iter().enumerate() {
            let held = first..group.rows.saturating_add(first);
            if held.start < rows.end && rows.start < held.end {
                let found = digest(file, start..group.end).map_err(|why| why.to_string())?;
                if found != group.sha256 {
                    return Err(format!(
                        "row group {k} (rows {} to {}) is damaged: its bytes do not match its checksum",
                        held.start,
                        held.end.saturating_sub(1)
                    ));
                }
            }
            (first, start) = (held.end, group.end);
        }
        Ok(())
    }
}

/// Verifies a whole file, if it is a table that this program wrote; others pass.
///
/// # Errors
/// If it is damaged or cannot be read; the reason in a few words.
pub(super) fn verify_if_ours(file: &mut (impl Read + Seek)) -> Result<(), String> {
    if let Some(sums) = Checksums::of(file)? {
        sums.verify(file, 0..u64::MAX)?;
    }
    file.rewind().map_err(|why| why.to_string())
}

/// The SHA-256 of some bytes of a file.
pub(super) fn digest(file: &mut (impl Read + Seek), bytes: Range<u64>) -> io::Result<String> {
    use sha2::Digest;
    file.seek(SeekFrom::Start(bytes.start))?;
    let mut left = bytes.end.saturating_sub(bytes.start);
    let mut hash = sha2::Sha256::new();
    let mut buffer = vec![0; CHUNK];
    while left > 0 {
        let wanted = usize::try_from(left).unwrap_or(CHUNK).min(CHUNK);
        file.read_exact(&mut buffer[..wanted])?;
        hash.update(&buffer[..wanted]);
        left -= wanted as u64;
    }
    Ok(hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Offset and bytes of a Parquet file's footer, without its length; `None` if the file does not end like one.
fn read_footer(file: &mut (impl Read + Seek)) -> io::Result<Option<(u64, Vec<u8>)>> {
    let size = file.seek(SeekFrom::End(0))?;
    let mut tail = [0; 8];
    let Some(end) = size.checked_sub(8) else { return Ok(None) };
    file.seek(SeekFrom::Start(end))?;
    file.read_exact(&mut tail)?;
    let [l0, l1, l2, l3, magic @ ..] = tail;
    let length = u64::from(u32::from_le_bytes([l0, l1, l2, l3]));
    let Some(start) = end.checked_sub(length).filter(|_| magic == MAGIC) else { return Ok(None) };
    file.seek(SeekFrom::Start(start))?;
    let mut footer = Vec::new();
    file.by_ref().take(length).read_to_end(&mut footer)?;
    Ok(Some((start, footer)))
}
