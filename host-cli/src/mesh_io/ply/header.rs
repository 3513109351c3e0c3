//! The header of a PLY file: the contents of the body, their order and their format.

use super::PlyError;

/// Types of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn named(name: &str) -> Option<Scalar> {
        Some(match name {
            "char" | "int8" => Scalar::I8,
            "uchar" | "uint8" => Scalar::U8,
            "short" | "int16" => Scalar::I16,
            "ushort" | "uint16" => Scalar::U16,
            "int" | "int32" => Scalar::I32,
            "uint" | "uint32" => Scalar::U32,
            "float" | "float32" => Scalar::F32,
            "double" | "float64" => Scalar::F64,
            _ => return None,
        })
    }
}

/// A property: one value or one list of values per item.
pub struct Property {
    pub name: String,
    /// Type of the length, if this is a list.
    pub length: Option<Scalar>,
    pub scalar: Scalar,
}

/// An element: `count` items of one kind.
pub struct Element {
    pub name: String,
    pub count: usize,
    pub properties: Vec<Property>,
}

/// Formats of numbers.
#[derive(Clone, Copy, PartialEq)]
pub enum Format {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// Reads the header: format, elements, and the bytes after the header.
pub fn read(bytes: &[u8]) -> Result<(Format, Vec<Element>, &[u8]), PlyError> {
    let (mut format, mut elements) = (None, Vec::new());
    let mut rest = bytes;
    for line in 1.. {
        let end = rest.iter().position(|&b| b == b'\n').ok_or(PlyError::NoEnd)?;
        let text = String::from_utf8_lossy(&rest[..end]);
        rest = &rest[end + 1..];
        let words: Vec<&str> = text.split_ascii_whitespace().collect();
        let good = match words.as_slice() {
            ["ply"] => line == 1,
            ["end_header"] => break,
            _ if line == 1 => false,
            [] | ["comment" | "obj_info", ..] => true,
            ["format", name, "1.0"] => format_named(name).map(|named| format = Some(named)).is_some(),
            ["element", name, count] => element(name, count).map(|element| elements.push(element)).is_some(),
            ["property", words @ ..] => add_property(elements.last_mut(), words).is_some(),
            _ => false,
        };
        if !good {
            return Err(PlyError::Header { line, text: text.trim_end().chars().take(60).collect() });
        }
    }
    Ok((format.ok_or(PlyError::Lacks("`format` line"))?, elements, rest))
}

fn format_named(name: &str) -> Option<Format> {
    match name {
        "ascii" => Some(Format::Ascii),
        "binary_little_endian" => Some(Format::LittleEndian),
        "binary_big_endian" => Some(Format::BigEndian),
        _ => None,
    }
}

fn element(name: &str, count: &str) -> Option<Element> {
    Some(Element { name: name.into(), count: count.parse().ok()?, properties: Vec::new() })
}

fn add_property(element: Option<&mut Element>, words: &[&str]) -> Option<()> {
    let (length, scalar, name) = match words {
        ["list", length, scalar, name] => (Some(Scalar::named(length)?), scalar, name),
        [scalar, name] => (None, scalar, name),
        _ => return None,
    };
    element?.properties.push(Property { name: (*name).into(), length, scalar: Scalar::named(scalar)? });
    Some(())
}
