//! The header of a PLY file: how numbers are written, and what elements follow.

use super::{ParseError, shortened};

/// How the numbers of a PLY file are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// A kind of number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Number {
    fn named(word: &str) -> Option<Number> {
        Some(match word {
            "char" | "int8" => Number::I8,
            "uchar" | "uint8" => Number::U8,
            "short" | "int16" => Number::I16,
            "ushort" | "uint16" => Number::U16,
            "int" | "int32" => Number::I32,
            "uint" | "uint32" => Number::U32,
            "float" | "float32" => Number::F32,
            "double" | "float64" => Number::F64,
            _ => return None,
        })
    }

    /// Bytes of a number in a binary file.
    pub(super) fn size(self) -> usize {
        match self {
            Number::I8 | Number::U8 => 1,
            Number::I16 | Number::U16 => 2,
            Number::I32 | Number::U32 | Number::F32 => 4,
            Number::F64 => 8,
        }
    }

    /// The number in the first bytes of `bytes`, little-endian; there are [`Number::size`] of them.
    pub(super) fn value(self, bytes: [u8; 8]) -> f64 {
        let [a, b, c, d, ..] = bytes;
        match self {
            Number::I8 => f64::from(i8::from_le_bytes([a])),
            Number::U8 => f64::from(a),
            Number::I16 => f64::from(i16::from_le_bytes([a, b])),
            Number::U16 => f64::from(u16::from_le_bytes([a, b])),
            Number::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Number::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Number::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Number::F64 => f64::from_le_bytes(bytes),
        }
    }
}

/// What an element has one of.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Property {
    pub(super) name: String,
    /// The kind of its number, or of the numbers of its list.
    pub(super) number: Number,
    /// The kind of a list's length; none for a single number.
    pub(super) length: Option<Number>,
}

/// A table of the file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

impl Element {
    /// The column of a property.
    pub(super) fn column(&self, name: &str) -> Option<usize> {
        self.properties.iter().position(|p| p.name == name)
    }
}

/// Everything before the first table.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Bytes of the header.
    pub(super) length: usize,
    /// Lines of the header.
    pub(super) lines: usize,
}

/// Reads the header.
pub(super) fn read_header(bytes: &[u8]) -> Result<Header, ParseError> {
    let (mut encoding, mut elements) = (None, Vec::<Element>::new());
    let (mut length, mut lines) = (0, 0);
    for line in bytes.split_inclusive(|b| *b == b'\n') {
        length += line.len();
        lines += 1;
        let fail = |message: String| ParseError::at_line(lines, message);
        let text = String::from_utf8_lossy(line);
        let words: Vec<&str> = text.split_whitespace().collect();
        match (lines, words.as_slice()) {
            (1, ["ply"]) => {}
            (1, _) => return Err(fail("a PLY file begins with a line \"ply\"".to_owned())),
            (_, ["format", kind, _version]) => encoding = Some(read_encoding(kind).map_err(fail)?),
            (_, ["element", name, count]) => {
                let read: Result<u64, _> = count.parse();
                let count =
                    read.map_err(|_| fail(format!("\"{}\" is no number of elements", shortened(count))))?;
                elements.push(Element { name: (*name).to_owned(), count, properties: Vec::new() });
            }
            (_, ["property", words @ ..]) => {
                let property = read_property(words).map_err(fail)?;
                let element = elements.last_mut();
                element
                    .ok_or_else(|| fail("a property before any element".to_owned()))?
                    .properties
                    .push(property);
            }
            (_, ["end_header"]) => {
                let encoding = encoding.ok_or_else(|| {
                    fail("the header has no line \"format ascii 1.0\" or the like".to_owned())
                })?;
                return Ok(Header { encoding, elements, length, lines });
            }
            // Comments, also those that some programs forget to call so.
            _ => {}
        }
    }
    let message = "the header has no \"end_header\": the file is cut, or not a PLY file; export it again";
    Err(ParseError::at_line(lines.max(1), message))
}

fn read_encoding(word: &str) -> Result<Encoding, String> {
    match word {
        "ascii" => Ok(Encoding::Text),
        "binary_little_endian" => Ok(Encoding::LittleEndian),
        "binary_big_endian" => Ok(Encoding::BigEndian),
        _ => Err(format!(
            "the format \"{}\" is none of ascii, binary_little_endian and binary_big_endian",
            shortened(word)
        )),
    }
}

fn read_property(words: &[&str]) -> Result<Property, String> {
    let number = |word: &str| {
        Number::named(word).ok_or_else(|| format!("\"{}\" is no kind of number in PLY", shortened(word)))
    };
    match words {
        ["list", length, kind, name] => {
            let length = number(length)?;
            if matches!(length, Number::F32 | Number::F64) {
                return Err("the length of a list must be a whole number".to_owned());
            }
            Ok(Property { name: (*name).to_owned(), number: number(kind)?, length: Some(length) })
        }
        [kind, name] => Ok(Property { name: (*name).to_owned(), number: number(kind)?, length: None }),
        _ => Err("a property is \"property TYPE NAME\" or \"property list TYPE TYPE NAME\"".to_owned()),
    }
}
