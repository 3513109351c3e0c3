//! The body of a PLY file, read one number at a time.

use std::str::SplitAsciiWhitespace;

use super::PlyError;
use super::header::{Element, Format, Property, Scalar};

/// The bytes after the header, read one scalar at a time. An `f64` represents every PLY type exactly.
pub enum Body<'a> {
    Ascii(SplitAsciiWhitespace<'a>),
    Binary { rest: &'a [u8], big_endian: bool },
}

enum Fault {
    Truncated,
    Number,
}

impl<'a> Body<'a> {
    pub fn new(format: Format, rest: &'a [u8]) -> Self {
        if format != Format::Ascii {
            return Body::Binary { rest, big_endian: format == Format::BigEndian };
        }
        // The text ends at the first byte that is not UTF-8.
        let text = rest.utf8_chunks().next().map_or("", |chunk| chunk.valid());
        Body::Ascii(text.split_ascii_whitespace())
    }

    fn scalar(&mut self, scalar: Scalar) -> Result<f64, Fault> {
        match self {
            Body::Ascii(words) => words.next().ok_or(Fault::Truncated)?.parse().map_err(|_| Fault::Number),
            Body::Binary { rest, big_endian } => binary(rest, scalar, *big_endian).ok_or(Fault::Truncated),
        }
    }

    /// Reads the values of a property into `values`. No memory is reserved ahead, so reading with a false length
    /// stops at the end of the file.
    fn property(&mut self, property: &Property, values: &mut Vec<f64>) -> Result<(), Fault> {
        values.clear();
        let length = property.length.map_or(Ok(1.0), |length| self.scalar(length))?;
        if !(0.0..=f64::from(u32::MAX)).contains(&length) || length.fract() != 0.0 {
            return Err(Fault::Number);
        }
        for _ in 0..length as u32 {
            values.push(self.scalar(property.scalar)?);
        }
        Ok(())
    }
}

fn binary(rest: &mut &[u8], scalar: Scalar, big_endian: bool) -> Option<f64> {
    fn take<const N: usize>(rest: &mut &[u8], big_endian: bool) -> Option<[u8; N]> {
        let (bytes, after) = rest.split_first_chunk::<N>()?;
        *rest = after;
        let mut bytes = *bytes;
        if big_endian {
            bytes.reverse();
        }
        Some(bytes)
    }
    Some(match scalar {
        Scalar::I8 => i8::from_le_bytes(take(rest, big_endian)?).into(),
        Scalar::U8 => u8::from_le_bytes(take(rest, big_endian)?).into(),
        Scalar::I16 => i16::from_le_bytes(take(rest, big_endian)?).into(),
        Scalar::U16 => u16::from_le_bytes(take(rest, big_endian)?).into(),
        Scalar::I32 => i32::from_le_bytes(take(rest, big_endian)?).into(),
        Scalar::U32 => u32::from_le_bytes(take(rest, big_endian)?).into(),
        Scalar::F32 => f32::from_le_bytes(take(rest, big_endian)?).into(),
        Scalar::F64 => f64::from_le_bytes(take(rest, big_endian)?),
    })
}

/// Reads all items of an element, and passes the place and the values of each property to `keep`.
pub fn read(body: &mut Body, element: &Element, mut keep: impl FnMut(usize, &[f64])) -> Result<(), PlyError> {
    if element.properties.is_empty() {
        return Ok(());
    }
    let (name, count) = (&element.name, element.count);
    let mut values = Vec::new();
    for item in 0..count {
        for (place, property) in element.properties.iter().enumerate() {
            body.property(property, &mut values).map_err(|fault| match fault {
                Fault::Truncated => PlyError::Truncated { element: name.clone(), item, count },
                Fault::Number => PlyError::Number { element: name.clone(), item },
            })?;
            keep(place, &values);
        }
    }
    Ok(())
}
