//! What the footer of a Parquet file says: columns, row groups, and where their bytes are.

use super::damaged;
use super::thrift::{Bytes, Value};
use std::io::{Read, Seek, SeekFrom};

/// The four bytes that begin and end a Parquet file.
pub(super) const MAGIC: &[u8; 4] = b"PAR1";

/// What the values of a column are.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::store) enum Kind {
    /// Binary numbers of 8 or 4 bytes.
    Double,
    Single,
    /// Binary numbers of two bytes.
    Half,
    /// Whole numbers of 4 or 8 bytes, or decimal ones of a number of places.
    Whole {
        bytes: usize,
        signed: bool,
        places: u32,
    },
    /// Decimal numbers in big-endian bytes, as many as stated or a length before each.
    Decimal {
        bytes: Option<usize>,
        places: u32,
    },
    Flag,
    Text,
    /// Something else, in a few words.
    Other(&'static str),
}

/// A column of the file.
#[derive(Debug, Clone)]
pub(super) struct Column {
    pub name: String,
    pub kind: Kind,
    /// Whether values may be missing.
    pub optional: bool,
    /// Its place among the chunks of a row group; none of a nested column.
    pub chunk: Option<usize>,
}

/// The bytes of a column in a row group.
#[derive(Debug, Clone)]
pub(super) struct Chunk {
    pub codec: i64,
    pub values: usize,
    pub start: u64,
    pub length: usize,
}

/// A row group: its rows, and its chunks in the order of the columns' leaves.
#[derive(Debug, Clone)]
pub(super) struct Group {
    pub rows: usize,
    pub chunks: Vec<Chunk>,
}

/// The footer.
#[derive(Debug)]
pub(super) struct Footer {
    pub columns: Vec<Column>,
    pub groups: Vec<Group>,
    pub metadata: Vec<(String, String)>,
    pub rows: u64,
}

/// Reads the footer of a file of `length` bytes.
pub(super) fn read(source: &mut (impl Read + Seek), length: u64) -> Result<Footer, String> {
    let no_parquet = || "it is no Parquet file".to_owned();
    if length < 12 || bytes_at(source, 0, 4)? != MAGIC {
        return Err(no_parquet());
    }
    let end = bytes_at(source, length - 8, 8)?;
    let (size, magic) = end.split_at(4);
    if magic != MAGIC {
        return Err(match magic {
            b"PARE" => "it is encrypted".to_owned(),
            _ => "it is damaged: its end is missing".to_owned(),
        });
    }
    let size = u64::from(Bytes::new(size).u32()?);
    if size > length - 12 {
        return Err(damaged());
    }
    let bytes = bytes_at(source, length - 8 - size, size as usize)?;
    let footer = Bytes::new(&bytes).structure()?;
    let (columns, leaves) = columns(footer.list(2))?;
    let groups = footer
        .list(4)
        .iter()
        .map(|group| self::group(group, leaves, length))
        .collect::<Result<Vec<_>, _>>()?;
    let rows = footer.count(3)? as u64;
    let held = groups.iter().try_fold(0u64, |sum, group| sum.checked_add(group.rows as u64));
    if held != Some(rows) {
        return Err(damaged());
    }
    let entry = |entry: &Value<'_>| Some((entry.text(1)?, entry.text(2)?));
    let metadata = footer.list(5).iter().filter_map(entry).collect();
    Ok(Footer { columns, groups, metadata, rows })
}

/// The bytes of a file from `start` on. Nothing is reserved for bytes that are not there.
pub(super) fn bytes_at(
    source: &mut (impl Read + Seek),
    start: u64,
    count: usize,
) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    source.seek(SeekFrom::Start(start)).map_err(|reason| reason.to_string())?;
    source.take(count as u64).read_to_end(&mut bytes).map_err(|reason| reason.to_string())?;
    if bytes.len() == count { Ok(bytes) } else { Err(damaged()) }
}

/// The columns at the top of a schema, which is written depth first, and the number of its leaves.
fn columns(elements: &[Value<'_>]) -> Result<(Vec<Column>, usize), String> {
    let (root, elements) = elements.split_first().ok_or_else(damaged)?;
    let mut columns = Vec::new();
    let mut leaves = 0;
    // How many children are still to come at every depth.
    let mut pending = vec![root.count(5)?];
    for element in elements {
        let depth = pending.len();
        let left = pending.last_mut().ok_or_else(damaged)?;
        *left = left.checked_sub(1).ok_or_else(damaged)?;
        let children = element.whole(5).unwrap_or(0);
        let repetition = element.whole(3).unwrap_or(0);
        if depth == 1 {
            let flat = children == 0 && repetition != 2;
            columns.push(Column {
                name: element.text(4).ok_or_else(damaged)?,
                kind: if flat { kind(element) } else { Kind::Other("it is nested") },
                optional: repetition == 1,
                chunk: flat.then_some(leaves),
            });
        }
        if children == 0 {
            leaves += 1;
        } else {
            pending.push(usize::try_from(children).map_err(|_| damaged())?);
        }
        while pending.len() > 1 && pending.last() == Some(&0) {
            pending.pop();
        }
    }
    if pending != [0] {
        return Err(damaged());
    }
    Ok((columns, leaves))
}

/// What the values of a leaf are.
fn kind(element: &Value<'_>) -> Kind {
    let logical = match element.field(10) {
        Some(Value::Struct(fields)) => fields.first(),
        _ => None,
    };
    let (logical, details) = logical.map_or((0, None), |(id, value)| (*id, Some(value)));
    let converted = element.whole(6).unwrap_or(-1);
    let places = || {
        let places = details.and_then(|d| d.whole(1)).or(element.whole(7)).unwrap_or(0);
        u32::try_from(places).unwrap_or(0)
    };
    let is_decimal = logical == 5 || converted == 5;
    let width = element.whole(2).and_then(|width| usize::try_from(width).ok());
    match (element.whole(1).unwrap_or(-1), logical, converted) {
        (0, ..) => Kind::Flag,
        (1 | 2, 6, _) | (1, _, 6) => Kind::Other("it holds dates"),
        (1 | 2, 7 | 8, _) | (1 | 2, _, 7..=10) => Kind::Other("it holds times of a clock"),
        (_, 11, _) => Kind::Other("it holds no values"),
        (physical @ (1 | 2), ..) => {
            let unsigned = (11..=14).contains(&converted)
                || logical == 10 && details.and_then(|d| d.flag(2)) == Some(false);
            let places = if is_decimal { places() } else { 0 };
            let bytes = if physical == 1 { 4 } else { 8 };
            Kind::Whole { bytes, signed: !unsigned, places }
        }
        (3, ..) => Kind::Other("it holds times of a clock"),
        (4, ..) => Kind::Single,
        (5, ..) => Kind::Double,
        (6, ..) if is_decimal => Kind::Decimal { bytes: None, places: places() },
        (7, ..) if is_decimal => Kind::Decimal { bytes: width, places: places() },
        (7, 15, _) if width == Some(2) => Kind::Half,
        (6, ..) => Kind::Text,
        _ => Kind::Other("it holds bytes"),
    }
}

fn group(group: &Value<'_>, leaves: usize, length: u64) -> Result<Group, String> {
    let chunk = |chunk: &Value<'_>| {
        let about = chunk.field(3).ok_or_else(damaged)?;
        let data = about.count(9)?;
        // A dictionary comes first; some writers state an offset of 0 where there is none.
        let dictionary = about.whole(11).and_then(|at| usize::try_from(at).ok());
        let start = dictionary.filter(|&at| at > 0 && at < data).unwrap_or(data) as u64;
        let bytes = about.count(7)?;
        if start.checked_add(bytes as u64).is_none_or(|end| end > length) {
            return Err(damaged());
        }
        let codec = about.whole(4).unwrap_or(0);
        Ok(Chunk { codec, values: about.count(5)?, start, length: bytes })
    };
    let chunks = group.list(1).iter().map(chunk).collect::<Result<Vec<_>, String>>()?;
    if chunks.len() != leaves {
        return Err(damaged());
    }
    Ok(Group { rows: group.count(3)?, chunks })
}
