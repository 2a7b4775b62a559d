//! Thrift's compact protocol, in which Parquet writes its footer and its page headers, as a tree of values.
//!
//! Nothing is reserved on the word of the file: every value takes a byte of it at least, so that a tree is as large as
//! the bytes that it was read from, within a factor, and structures nest no deeper than [`DEEPEST`].

use super::damaged;

/// The deepest nesting that is followed; Parquet's own structures nest six deep.
const DEEPEST: usize = 32;

/// A value. Texts are bytes of the file.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value<'b> {
    Flag(bool),
    Whole(i64),
    Real(f64),
    Bytes(&'b [u8]),
    List(Vec<Value<'b>>),
    Struct(Vec<(i16, Value<'b>)>),
}

impl<'b> Value<'b> {
    /// The field `id` of a structure.
    pub fn field(&self, id: i16) -> Option<&Value<'b>> {
        match self {
            Value::Struct(fields) => fields.iter().find(|(own, _)| *own == id).map(|(_, v)| v),
            _ => None,
        }
    }

    /// The whole number in field `id`.
    pub fn whole(&self, id: i16) -> Option<i64> {
        match self.field(id)? {
            Value::Whole(number) => Some(*number),
            _ => None,
        }
    }

    /// The number in field `id`, which counts something.
    pub fn count(&self, id: i16) -> Result<usize, String> {
        self.whole(id).and_then(|count| usize::try_from(count).ok()).ok_or_else(damaged)
    }

    /// The list in field `id`; empty where there is none.
    pub fn list(&self, id: i16) -> &[Value<'b>] {
        match self.field(id) {
            Some(Value::List(values)) => values,
            _ => &[],
        }
    }

    /// The text in field `id`.
    pub fn text(&self, id: i16) -> Option<String> {
        match self.field(id)? {
            Value::Bytes(bytes) => Some(String::from_utf8_lossy(bytes).into_owned()),
            _ => None,
        }
    }

    /// The truth in field `id`.
    pub fn flag(&self, id: i16) -> Option<bool> {
        match self.field(id)? {
            Value::Flag(flag) => Some(*flag),
            _ => None,
        }
    }
}

/// Reads bytes from the front.
#[derive(Debug, Clone)]
pub(super) struct Bytes<'b> {
    rest: &'b [u8],
}

impl<'b> Bytes<'b> {
    pub fn new(bytes: &'b [u8]) -> Self {
        Bytes { rest: bytes }
    }

    /// What has not been read.
    pub fn rest(&self) -> &'b [u8] {
        self.rest
    }

    /// The next `count` bytes.
    pub fn take(&mut self, count: usize) -> Result<&'b [u8], String> {
        let (taken, rest) = self.rest.split_at_checked(count).ok_or_else(damaged)?;
        self.rest = rest;
        Ok(taken)
    }

    pub fn byte(&mut self) -> Result<u8, String> {
        Ok(self.take(1)?[0])
    }

    /// A number in little-endian order of four bytes.
    pub fn u32(&mut self) -> Result<u32, String> {
        let bytes: [u8; 4] = self.take(4)?.try_into().map_err(|_| damaged())?;
        Ok(u32::from_le_bytes(bytes))
    }

    /// A number of seven bits a byte, the lowest first.
    pub fn varint(&mut self) -> Result<u64, String> {
        let mut value = 0u64;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Ok(value);
            }
        }
        Err(damaged())
    }

    /// A number whose sign is its last bit.
    pub fn zigzag(&mut self) -> Result<i64, String> {
        let value = self.varint()?;
        Ok((value >> 1) as i64 ^ -((value & 1) as i64))
    }

    /// A structure.
    pub fn structure(&mut self) -> Result<Value<'b>, String> {
        self.fields(DEEPEST)
    }

    fn fields(&mut self, depth: usize) -> Result<Value<'b>, String> {
        let mut fields = Vec::new();
        let mut id = 0i16;
        loop {
            let header = self.byte()?;
            if header == 0 {
                return Ok(Value::Struct(fields));
            }
            id = match header >> 4 {
                0 => i16::try_from(self.zigzag()?).map_err(|_| damaged())?,
                step => id.checked_add(i16::from(step)).ok_or_else(damaged)?,
            };
            let value = match header & 0x0f {
                1 => Value::Flag(true),
                2 => Value::Flag(false),
                kind => self.value(kind, depth)?,
            };
            fields.push((id, value));
        }
    }

    /// A value of a kind, in a list or a field.
    fn value(&mut self, kind: u8, depth: usize) -> Result<Value<'b>, String> {
        let depth = depth.checked_sub(1).ok_or_else(damaged)?;
        Ok(match kind {
            1 | 2 => Value::Flag(self.byte()? == 1),
            3 => Value::Whole(i64::from(self.byte()? as i8)),
            4..=6 => Value::Whole(self.zigzag()?),
            7 => {
                let bytes: [u8; 8] = self.take(8)?.try_into().map_err(|_| damaged())?;
                Value::Real(f64::from_le_bytes(bytes))
            }
            8 => {
                let length = usize::try_from(self.varint()?).map_err(|_| damaged())?;
                Value::Bytes(self.take(length)?)
            }
            9 | 10 => {
                let header = self.byte()?;
                let count = match header >> 4 {
                    15 => self.varint()?,
                    count => u64::from(count),
                };
                self.several(count, |bytes| bytes.value(header & 0x0f, depth))?
            }
            11 => {
                let count = self.varint()?;
                let kinds = if count == 0 { 0 } else { self.byte()? };
                self.several(count, |bytes| {
                    let key = bytes.value(kinds >> 4, depth)?;
                    Ok(Value::List(vec![key, bytes.value(kinds & 0x0f, depth)?]))
                })?
            }
            12 => self.fields(depth)?,
            _ => return Err(damaged()),
        })
    }

    /// As many values as the file claims, each of which takes a byte at least.
    fn several(
        &mut self,
        count: u64,
        mut read: impl FnMut(&mut Self) -> Result<Value<'b>, String>,
    ) -> Result<Value<'b>, String> {
        if count > self.rest.len() as u64 {
            return Err(damaged());
        }
        let mut values = Vec::new();
        for _ in 0..count {
            values.push(read(self)?);
        }
        Ok(Value::List(values))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_numbers_have_the_bytes_of_the_specification() {
        // Thrift compact protocol, "Integer encoding": ULEB128 of zigzag.
        for (bytes, value) in [(&[0x00][..], 0), (&[0x01], -1), (&[0x02], 1), (&[0xac, 0x02], 150)]
        {
            assert_eq!(Bytes::new(bytes).zigzag(), Ok(value));
        }
        // Field 1, a list of two i32; field 3, a text; stop.
        let bytes = [0x19, 0x25, 0x02, 0x04, 0x28, 0x02, b'h', b'i', 0x00];
        let read = Bytes::new(&bytes).structure().expect("a structure");
        assert_eq!(read.list(1), [Value::Whole(1), Value::Whole(2)]);
        assert_eq!(read.text(3).as_deref(), Some("hi"));
    }

    #[test]
    fn property_claims_beyond_the_bytes_are_damage() {
        // A list that claims 2^31 structures in five bytes, and structures in structures without end.
        assert!(Bytes::new(&[0x19, 0xfc, 0xff, 0xff, 0xff, 0xff, 0x07]).structure().is_err());
        assert!(Bytes::new(&[0x1c; 100_000]).structure().is_err());
        assert!(Bytes::new(&[0x18, 0xff, 0xff, 0xff, 0xff, 0x0f]).structure().is_err());
    }
}
