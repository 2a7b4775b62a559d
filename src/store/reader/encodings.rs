//! Values in a page: how each encoding writes them, and what they are.

use super::damaged;
use super::footer::Kind;
use super::thrift::Bytes;
use std::sync::Arc;

/// A value that a column may hold.
pub(in crate::store) trait Cell: Clone {
    /// Why columns of a kind do not hold such values, in a few words.
    fn accepts(kind: &Kind) -> Result<(), String>;
    /// `count` values in the encoding PLAIN.
    fn plain(kind: &Kind, bytes: &[u8], count: usize) -> Result<Vec<Self>, String>;
}

/// The values of a page that are there.
pub(super) struct Encoded<'p> {
    pub kind: &'p Kind,
    pub bytes: &'p [u8],
    pub count: usize,
}

impl Encoded<'_> {
    /// The values, in the encoding of a number in `parquet.thrift`.
    pub fn values<T: Cell>(
        &self,
        encoding: i64,
        dictionary: Option<&[T]>,
    ) -> Result<Vec<T>, String> {
        if self.count == 0 {
            return Ok(Vec::new());
        }
        match encoding {
            0 => T::plain(self.kind, self.bytes, self.count),
            2 | 8 => {
                let (width, rest) = self.bytes.split_first().ok_or_else(damaged)?;
                let dictionary = dictionary.ok_or_else(damaged)?;
                let value = |k: u32| dictionary.get(k as usize).cloned().ok_or_else(damaged);
                hybrid(rest, u32::from(*width), self.count)?.into_iter().map(value).collect()
            }
            3 => {
                let mut bytes = Bytes::new(self.bytes);
                let length = bytes.u32()? as usize;
                let bits = hybrid(bytes.take(length)?, 1, self.count)?;
                let pack = |bits: &[u32]| bits.iter().rev().fold(0, |byte, &b| byte << 1 | b as u8);
                let packed: Vec<u8> = bits.chunks(8).map(pack).collect();
                T::plain(self.kind, &packed, self.count)
            }
            5 => {
                let Kind::Whole { bytes: width, .. } = *self.kind else { return Err(damaged()) };
                let wholes = delta(self.bytes, self.count)?;
                let bytes: Vec<u8> = wholes
                    .iter()
                    .flat_map(|whole| whole.to_le_bytes().into_iter().take(width))
                    .collect();
                T::plain(self.kind, &bytes, self.count)
            }
            9 => {
                let width = width(self.kind).ok_or_else(damaged)?;
                if self.count.checked_mul(width) != Some(self.bytes.len()) {
                    return Err(damaged());
                }
                let at = |k: usize| self.bytes[(k % width) * self.count + k / width];
                let bytes: Vec<u8> = (0..self.bytes.len()).map(at).collect();
                T::plain(self.kind, &bytes, self.count)
            }
            other => Err(format!("its encoding, number {other}, is not read")),
        }
    }
}

/// Bytes of a value, where all have as many.
fn width(kind: &Kind) -> Option<usize> {
    match kind {
        Kind::Double => Some(8),
        Kind::Single => Some(4),
        Kind::Half => Some(2),
        Kind::Whole { bytes, .. } => Some(*bytes),
        Kind::Decimal { bytes, .. } => bytes.filter(|&bytes| bytes > 0),
        Kind::Flag | Kind::Text | Kind::Other(_) => None,
    }
}

/// `count` numbers of `width` bits in runs, and packed in eights ("RLE/bit-packing hybrid").
pub(super) fn hybrid(bytes: &[u8], width: u32, count: usize) -> Result<Vec<u32>, String> {
    if width > 32 {
        return Err(damaged());
    }
    let mut bytes = Bytes::new(bytes);
    let mut values = Vec::new();
    while values.len() < count {
        let header = bytes.varint()?;
        let left = count - values.len();
        let length = usize::try_from(header >> 1).map_err(|_| damaged())?;
        if header & 1 == 0 {
            let mut value = [0; 4];
            let read = bytes.take(width.div_ceil(8) as usize)?;
            value[..read.len()].copy_from_slice(read);
            let run = u32::from_le_bytes(value);
            values.extend(std::iter::repeat_n(run, length.min(left)));
        } else {
            let size = length.checked_mul(width as usize).ok_or_else(damaged)?;
            let packed = bytes.take(size.min(bytes.rest().len()))?;
            // Some writers end the last pack where its values end.
            let there = match width {
                0 => left,
                width => packed.len().saturating_mul(8) / width as usize,
            };
            let taken = left.min(there).min(length.saturating_mul(8));
            values.extend((0..taken).map(|k| bits(packed, k, width) as u32));
            if packed.len() < size && values.len() < count {
                return Err(damaged());
            }
        }
    }
    Ok(values)
}

/// The number of `width` ≤ 64 bits at place `k` of packed bytes.
fn bits(packed: &[u8], k: usize, width: u32) -> u64 {
    let mut value = 0u64;
    let first = k * width as usize;
    let mut have = 0;
    while have < width {
        let at = first + have as usize;
        let byte = u64::from(packed[at / 8] >> (at % 8));
        let taken = (8 - at as u32 % 8).min(width - have);
        value |= (byte & ((1 << taken) - 1)) << have;
        have += taken;
    }
    value
}

/// `count` whole numbers as differences ("DELTA_BINARY_PACKED").
fn delta(bytes: &[u8], count: usize) -> Result<Vec<i64>, String> {
    let mut bytes = Bytes::new(bytes);
    let (block, packs) = (bytes.varint()?, bytes.varint()?);
    let total = bytes.varint()?;
    let mut value = bytes.zigzag()?;
    if total != count as u64 || packs == 0 || packs > block {
        return Err(damaged());
    }
    let each = usize::try_from(block / packs).map_err(|_| damaged())?;
    let mut values = vec![value];
    while values.len() < count {
        let least = bytes.zigzag()?;
        let widths = bytes.take(usize::try_from(packs).map_err(|_| damaged())?)?;
        for &width in widths {
            if values.len() == count {
                break;
            }
            if width > 64 {
                return Err(damaged());
            }
            let size = each.checked_mul(usize::from(width)).ok_or_else(damaged)?.div_ceil(8);
            let packed = bytes.take(size)?;
            for k in 0..each.min(count - values.len()) {
                let step = bits(packed, k, u32::from(width)) as i64;
                value = value.wrapping_add(least).wrapping_add(step);
                values.push(value);
            }
        }
    }
    Ok(values)
}

/// `count` values of `width` bytes, read by `read`.
fn fixed<T>(
    bytes: &[u8],
    count: usize,
    width: usize,
    read: impl Fn(&[u8]) -> T,
) -> Result<Vec<T>, String> {
    let size = count.checked_mul(width).ok_or_else(damaged)?;
    let values = bytes.get(..size).filter(|_| width > 0).ok_or_else(damaged)?;
    Ok(values.chunks_exact(width).map(read).collect())
}

/// `count` values with their lengths before them, read by `read`.
fn prefixed<T>(
    bytes: &[u8],
    count: usize,
    read: impl Fn(&[u8]) -> Result<T, String>,
) -> Result<Vec<T>, String> {
    let mut bytes = Bytes::new(bytes);
    let mut values = Vec::new();
    for _ in 0..count {
        let length = bytes.u32()? as usize;
        values.push(read(bytes.take(length)?)?);
    }
    Ok(values)
}

impl Cell for f64 {
    fn accepts(kind: &Kind) -> Result<(), String> {
        match kind {
            Kind::Flag => Err("it holds true and false, not numbers".to_owned()),
            Kind::Text => Err("it holds text, not numbers".to_owned()),
            Kind::Other(what) => Err(format!("{what}, not numbers")),
            _ => Ok(()),
        }
    }

    fn plain(kind: &Kind, bytes: &[u8], count: usize) -> Result<Vec<f64>, String> {
        let wide = |bytes: &[u8]| little_endian(bytes);
        match *kind {
            Kind::Double => fixed(bytes, count, 8, |value| f64::from_bits(wide(value))),
            Kind::Single => {
                fixed(bytes, count, 4, |value| f64::from(f32::from_bits(wide(value) as u32)))
            }
            Kind::Half => fixed(bytes, count, 2, |value| half(wide(value) as u16)),
            Kind::Whole { bytes: width, signed, places } => fixed(bytes, count, width, |value| {
                let raw = wide(value);
                let whole = match (signed, width) {
                    (false, _) => i128::from(raw),
                    (true, 4) => i128::from(raw as u32 as i32),
                    (true, _) => i128::from(raw as i64),
                };
                decimal(whole, places)
            }),
            Kind::Decimal { bytes: Some(width), places } => {
                let values = fixed(bytes, count, width, big_endian)?;
                values.into_iter().map(|whole| Ok(decimal(whole?, places))).collect()
            }
            Kind::Decimal { bytes: None, places } => {
                prefixed(bytes, count, |value| Ok(decimal(big_endian(value)?, places)))
            }
            Kind::Flag | Kind::Text | Kind::Other(_) => Err(damaged()),
        }
    }
}

impl Cell for bool {
    fn accepts(kind: &Kind) -> Result<(), String> {
        if *kind == Kind::Flag { Ok(()) } else { Err("it does not hold true and false".to_owned()) }
    }

    fn plain(_: &Kind, bytes: &[u8], count: usize) -> Result<Vec<bool>, String> {
        if count.div_ceil(8) > bytes.len() {
            return Err(damaged());
        }
        Ok((0..count).map(|k| bits(bytes, k, 1) == 1).collect())
    }
}

impl Cell for Arc<str> {
    fn accepts(kind: &Kind) -> Result<(), String> {
        if *kind == Kind::Text { Ok(()) } else { Err("it does not hold text".to_owned()) }
    }

    fn plain(_: &Kind, bytes: &[u8], count: usize) -> Result<Vec<Arc<str>>, String> {
        prefixed(bytes, count, |text| {
            std::str::from_utf8(text).map(Arc::from).map_err(|_| damaged())
        })
    }
}

/// Up to eight bytes, the lowest first.
fn little_endian(bytes: &[u8]) -> u64 {
    bytes.iter().rev().fold(0, |number, &byte| number << 8 | u64::from(byte))
}

/// A whole number in two's complement, the highest byte first.
fn big_endian(bytes: &[u8]) -> Result<i128, String> {
    let extra = bytes.len().saturating_sub(16);
    let (sign, bytes) = bytes.split_at(extra);
    let negative = bytes.first().is_some_and(|&byte| byte >= 0x80);
    if sign.iter().any(|&byte| byte != if negative { 0xff } else { 0 }) {
        return Err("a decimal number has more than 38 digits".to_owned());
    }
    Ok(bytes
        .iter()
        .fold(if negative { -1 } else { 0 }, |number: i128, &byte| number << 8 | i128::from(byte)))
}

/// The double nearest to a number of `places` decimal places.
fn decimal(whole: i128, places: u32) -> f64 {
    match places {
        0 => whole as f64,
        places => format!("{whole}e-{places}").parse().unwrap_or(f64::NAN),
    }
}

/// A binary number of IEEE 754 with 11 bits of precision.
fn half(bits: u16) -> f64 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let (exponent, fraction) = (i32::from(bits >> 10 & 0x1f), f64::from(bits & 0x3ff));
    let power = |n: i32| f64::from_bits(((1023 + n) as u64) << 52);
    sign * match exponent {
        0 => fraction * power(-24),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1024.0 + fraction) * power(exponent - 25),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_runs_and_packs_are_those_of_the_specification() {
        // Encodings.md: the numbers 0 … 7 in three bits each.
        let packed = [3, 0b1000_1000, 0b1100_0110, 0b1111_1010];
        assert_eq!(hybrid(&packed, 3, 8), Ok((0..8).collect()));
        assert_eq!(hybrid(&[8, 5], 3, 4), Ok(vec![5; 4]));
        // Encodings.md, delta encoding, example 1: 1, 2, 3, 4, 5 in a block of 128 with four packs.
        let bytes = [0x80, 0x01, 4, 5, 2, 2, 0, 0, 0, 0];
        assert_eq!(delta(&bytes, 5), Ok(vec![1, 2, 3, 4, 5]));
    }

    #[test]
    fn property_runs_beyond_what_is_asked_for_are_not_unpacked() {
        // A run of 2^28 in five bytes, of which four are wanted; packs of as many without their bytes.
        assert_eq!(hybrid(&[0x80, 0x80, 0x80, 0x80, 0x02, 7], 3, 4), Ok(vec![7; 4]));
        assert!(hybrid(&[0x81, 0x80, 0x80, 0x80, 0x02, 7], 3, 40).is_err());
        assert!(delta(&[0x80, 0x80, 0x80, 0x80, 0x08, 1, 5, 2, 2, 64], 5).is_err());
    }

    #[test]
    fn analytic_numbers_are_the_nearest_doubles() {
        assert_eq!(half(0x3c00), 1.0);
        assert_eq!(half(0xc000), -2.0);
        assert_eq!(half(0x7bff), 65504.0);
        assert_eq!(half(0x0001), 1.0 / 16_777_216.0);
        assert_eq!(decimal(62, 3), 0.062);
        assert_eq!(big_endian(&[0xff, 0x85]), Ok(-123));
        let long = [[0xff; 4].as_slice(), &[0x80; 16]].concat();
        assert!(big_endian(&long).is_ok());
        assert!(big_endian(&[1; 17]).is_err());
    }
}
