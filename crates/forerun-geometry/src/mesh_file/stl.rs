//! STL: triangles without shared vertices, as text or binary. Normals and attributes are skipped.

use super::{ParseError, TriangleList, parse_position, shortened};
use crate::Vec3;

/// Size of a binary file's header and count.
const HEADER: usize = 84;
/// Size of a binary triangle: normal, three corners, attribute.
const RECORD: usize = 50;

/// The triangles of an STL file, text or binary. Corners are not welded; [`Mesh::new`](crate::shape::Mesh::new) does that.
///
/// # Errors
/// With the number of the line or triangle: a file that is cut or too long, a number that is not finite, text that is not STL.
pub fn parse_stl(bytes: &[u8]) -> Result<TriangleList, ParseError> {
    // Many binary files begin with "solid" too, so their length decides.
    let binary_length = bytes.get(80..HEADER).and_then(|count| {
        let count = u32::from_le_bytes(count.try_into().ok()?);
        (count as usize).checked_mul(RECORD)?.checked_add(HEADER)
    });
    let corners = if binary_length == Some(bytes.len()) {
        parse_binary(&bytes[HEADER..])?
    } else if starts_as_text(bytes) {
        parse_text(&String::from_utf8_lossy(bytes))?
    } else if let Some(expected) = binary_length {
        return Err(ParseError::new(
            "header",
            format!(
                "its count of triangles makes {expected} bytes, the file has {}: cut, or not an STL file; export it again",
                bytes.len()
            ),
        ));
    } else {
        return Err(ParseError::new(
            "header",
            format!(
                "{} bytes are too few for a binary STL file, and a text one begins with \"solid\"",
                bytes.len()
            ),
        ));
    };
    if corners.is_empty() {
        return Err(ParseError::new("end of file", "there are no triangles"));
    }
    let triangles = (0..corners.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Ok(TriangleList { vertices: corners, triangles })
}

fn starts_as_text(bytes: &[u8]) -> bool {
    bytes.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
}

fn parse_binary(records: &[u8]) -> Result<Vec<Vec3>, ParseError> {
    let mut corners = Vec::with_capacity(records.len() / RECORD * 3);
    for (triangle, record) in records.as_chunks::<RECORD>().0.iter().enumerate() {
        let (numbers, _) = record[12..48].as_chunks::<4>();
        let numbers: Vec<f32> = numbers.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
        for corner in numbers.as_chunks::<3>().0 {
            let corner = Vec3::from(*corner);
            if !corner.is_finite() {
                return Err(ParseError::new(
                    format!("triangle {triangle}"),
                    format!("a corner is {corner}; positions must be finite numbers"),
                ));
            }
            corners.push(corner);
        }
    }
    Ok(corners)
}

/// `solid`, then for each triangle `facet`, `outer loop`, three times `vertex x y z`, `endloop`, `endfacet`, then `endsolid`; several solids may
/// follow each other.
fn parse_text(text: &str) -> Result<Vec<Vec3>, ParseError> {
    let mut corners = Vec::new();
    let mut first_of_facet = None;
    let mut in_solid = false;
    let mut number = 0;
    for line in text.lines() {
        number += 1;
        let fail = |message: String| Err(ParseError::at_line(number, message));
        let mut words = line.split_whitespace();
        let Some(word) = words.next() else {
            continue;
        };
        match (word.to_ascii_lowercase().as_str(), first_of_facet) {
            ("solid", None) => in_solid = true,
            ("endsolid", None) => in_solid = false,
            ("facet", None) if in_solid => first_of_facet = Some(corners.len()),
            ("outer" | "endloop", Some(_)) => {}
            ("vertex", Some(_)) => {
                let position = parse_position(&mut words);
                corners.push(position.map_err(|m| ParseError::at_line(number, m))?);
            }
            ("endfacet", Some(first)) => {
                if corners.len() - first != 3 {
                    return fail(format!("a facet has {} vertices instead of 3", corners.len() - first));
                }
                first_of_facet = None;
            }
            _ => return fail(format!("\"{}\" does not belong here", shortened(word))),
        }
    }
    if in_solid {
        let message = "the file ends before \"endsolid\": it is cut; export it again";
        return Err(ParseError::at_line(number, message));
    }
    Ok(corners)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "solid a b\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1 2.5e-1\n  \
                        endloop\n endfacet\nendsolid a b\n";

    #[test]
    fn reads_text() {
        let list = parse_stl(TEXT.as_bytes()).unwrap();
        assert_eq!(list.vertices, [Vec3::ZERO, Vec3::X, Vec3::new(0.0, 1.0, 0.25)]);
        assert_eq!(list.triangles, [[0, 1, 2]]);
        let twice = format!("{TEXT}\n{}", TEXT.to_uppercase());
        assert_eq!(parse_stl(twice.as_bytes()).unwrap().triangles.len(), 2);
    }

    #[test]
    fn reads_binary_even_if_it_calls_itself_solid() {
        let mut bytes = b"solid but binary".to_vec();
        bytes.resize(80, 0);
        bytes.extend(1_u32.to_le_bytes());
        for number in [9.0_f32, 9.0, 9.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.25] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend([7, 7]);
        assert_eq!(parse_stl(&bytes).unwrap(), parse_stl(TEXT.as_bytes()).unwrap());
        bytes[84 + 20..84 + 24].copy_from_slice(&f32::NAN.to_le_bytes());
        assert_eq!(parse_stl(&bytes).unwrap_err().place, "triangle 0");
        bytes[0] = b'S';
        bytes[1] = b'T';
        bytes.pop();
        assert!(parse_stl(&bytes).unwrap_err().message.contains("makes 134 bytes, the file has 133"));
    }

    #[test]
    fn errors_name_the_line() {
        let says = |text: &str, expected: &str| {
            assert_eq!(parse_stl(text.as_bytes()).unwrap_err().to_string(), expected);
        };
        says("solid\nfacet\nvertex 0 0\n", "line 3: a vertex needs three numbers, there are 2");
        says("solid\nvertex 0 0 0\n", "line 2: \"vertex\" does not belong here");
        says("solid\nfacet\nvertex 0 0 0\nendfacet", "line 4: a facet has 1 vertices instead of 3");
        says(&TEXT[..60], "line 5: the file ends before \"endsolid\": it is cut; export it again");
        says("solid\nendsolid", "end of file: there are no triangles");
        says(
            "hello",
            "header: 5 bytes are too few for a binary STL file, and a text one begins with \"solid\"",
        );
    }
}
