//! PLY, as text or binary in either byte order: the elements `vertex` (x, y, z) and `face` or `tristrips`; all others are skipped.

use super::ply_header::{Element, Encoding, Number, read_header};
use super::polygon::{cut_polygon, strip};
use super::{ParseError, TriangleList, shortened};
use crate::Vec3;

/// The triangles of a PLY file. Polygons and strips are cut into triangles.
///
/// # Errors
/// With the line, vertex or face: a header that is none, a file that is cut, a position that is not finite, a vertex that does not exist,
/// a polygon that cannot be cut, or no face at all.
pub fn parse_ply(bytes: &[u8]) -> Result<TriangleList, ParseError> {
    let header = read_header(bytes)?;
    let rest = &bytes[header.length..];
    let mut body = match header.encoding {
        Encoding::Text => Body::Text(Words { rest, line: header.lines + 1 }),
        Encoding::LittleEndian => Body::Binary { rest, turned: false },
        Encoding::BigEndian => Body::Binary { rest, turned: true },
    };
    let mut list = TriangleList::default();
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => read_vertices(element, &mut body, &mut list)?,
            "face" => read_faces(element, &mut body, &mut list)?,
            "tristrips" => read_strips(element, &mut body, &mut list)?,
            _ => {
                // What has no properties takes no room, however many there are.
                let count = if element.properties.is_empty() { 0 } else { element.count };
                let mut row = Row::default();
                for index in 0..count {
                    body.read_row(element, index, None, &mut row)?;
                }
            }
        }
    }
    if list.triangles.is_empty() {
        let message = format!(
            "there are {} vertices and no faces: a cloud of points; make a surface of it in a mesh program",
            list.vertices.len()
        );
        return Err(ParseError::new("end of file", message));
    }
    Ok(list)
}

fn read_vertices(element: &Element, body: &mut Body<'_>, list: &mut TriangleList) -> Result<(), ParseError> {
    let column = |name| {
        let found = element.column(name).filter(|i| element.properties[*i].length.is_none());
        found.ok_or_else(|| ParseError::new("header", format!("vertices have no number {name}")))
    };
    let columns = [column("x")?, column("y")?, column("z")?];
    let mut row = Row::default();
    for index in 0..element.count {
        body.read_row(element, index, None, &mut row)?;
        let position = Vec3::from_array(columns.map(|i| row.numbers[i] as f32));
        if !position.is_finite() {
            let message = format!("the position is {position}; positions must be finite numbers");
            return Err(ParseError::new(body.place(element, index), message));
        }
        list.vertices.push(position);
    }
    Ok(())
}

fn read_faces(element: &Element, body: &mut Body<'_>, list: &mut TriangleList) -> Result<(), ParseError> {
    let corners = corner_column(element)?;
    let mut row = Row::default();
    for index in 0..element.count {
        body.read_row(element, index, Some(corners), &mut row)?;
        let fail = |message: String| ParseError::new(body.place(element, index), message);
        let corners = row.list.iter().map(|c| vertex_index(*c, list.vertices.len()));
        let corners: Vec<u32> = corners.collect::<Result<_, _>>().map_err(fail)?;
        list.triangles.extend(cut_polygon(&list.vertices, &corners).map_err(fail)?);
    }
    Ok(())
}

/// Strips follow each other in one list, with -1 between them.
fn read_strips(element: &Element, body: &mut Body<'_>, list: &mut TriangleList) -> Result<(), ParseError> {
    let corners = corner_column(element)?;
    let mut row = Row::default();
    for index in 0..element.count {
        body.read_row(element, index, Some(corners), &mut row)?;
        for part in row.list.split(|c| *c < 0.0) {
            let corners = part.iter().map(|c| vertex_index(*c, list.vertices.len()));
            let corners: Vec<u32> = corners
                .collect::<Result<_, _>>()
                .map_err(|message: String| ParseError::new(body.place(element, index), message))?;
            list.triangles.extend(strip(&corners));
        }
    }
    Ok(())
}

fn corner_column(element: &Element) -> Result<usize, ParseError> {
    let column = element.column("vertex_indices").or_else(|| element.column("vertex_index"));
    column.filter(|i| element.properties[*i].length.is_some()).ok_or_else(|| {
        ParseError::new("header", format!("element {} has no list vertex_indices", shortened(&element.name)))
    })
}

fn vertex_index(number: f64, vertices: usize) -> Result<u32, String> {
    let index = number as u32;
    if f64::from(index).to_bits() == number.to_bits() && (index as usize) < vertices {
        Ok(index)
    } else {
        Err(format!("vertex {number} does not exist; {vertices} vertices come before this face"))
    }
}

/// What one line of a table has.
#[derive(Default)]
struct Row {
    /// For each property its number; for lists their length.
    numbers: Vec<f64>,
    /// The numbers of the list that was asked for.
    list: Vec<f64>,
}

/// What follows the header, as far as it has not been read.
enum Body<'a> {
    Text(Words<'a>),
    Binary {
        rest: &'a [u8],
        /// Whether the largest byte of a number comes first.
        turned: bool,
    },
}

impl Body<'_> {
    /// Where a row is, in words.
    fn place(&self, element: &Element, index: u64) -> String {
        let name = shortened(&element.name);
        match self {
            Body::Text(words) => format!("line {} ({name} {index} of {})", words.line, element.count),
            Body::Binary { .. } => format!("{name} {index} of {}", element.count),
        }
    }

    /// Reads a row; of its lists only the one in column `list` is kept.
    fn read_row(
        &mut self,
        element: &Element,
        index: u64,
        list: Option<usize>,
        row: &mut Row,
    ) -> Result<(), ParseError> {
        row.numbers.clear();
        row.list.clear();
        for (column, property) in element.properties.iter().enumerate() {
            let fail = |body: &Self, message: String| ParseError::new(body.place(element, index), message);
            let first = self.number(property.length.unwrap_or(property.number));
            let first = first.map_err(|message| fail(self, message))?;
            row.numbers.push(first);
            if property.length.is_some() {
                if !(first >= 0.0 && first.fract().to_bits() == 0) {
                    return Err(fail(self, format!("a list is {first} long")));
                }
                // Not allocated by what the file says: it may say anything.
                for _ in 0..first as u64 {
                    let number = self.number(property.number).map_err(|message| fail(self, message))?;
                    if list == Some(column) {
                        row.list.push(number);
                    }
                }
            }
        }
        Ok(())
    }

    fn number(&mut self, kind: Number) -> Result<f64, String> {
        const CUT: &str = "the file ends here: it is cut; export it again";
        match self {
            Body::Text(words) => {
                let word = words.next().ok_or(CUT)?;
                let word = std::str::from_utf8(word).unwrap_or("?");
                // A number of four bytes is rounded once, not twice.
                let read = match kind {
                    Number::F32 => word.parse::<f32>().map(f64::from),
                    _ => word.parse::<f64>(),
                };
                read.map_err(|_| format!("\"{}\" is not a number", shortened(word)))
            }
            Body::Binary { rest, turned } => {
                let (number, after) = rest.split_at_checked(kind.size()).ok_or(CUT)?;
                *rest = after;
                let mut bytes = [0; 8];
                bytes[..number.len()].copy_from_slice(number);
                if *turned {
                    bytes[..number.len()].reverse();
                }
                Ok(kind.value(bytes))
            }
        }
    }
}

/// Words of a text, and the line of the last one.
struct Words<'a> {
    rest: &'a [u8],
    line: usize,
}

impl<'a> Words<'a> {
    fn next(&mut self) -> Option<&'a [u8]> {
        let start = self.rest.iter().position(|b| !b.is_ascii_whitespace())?;
        self.line += self.rest[..start].iter().filter(|b| **b == b'\n').count();
        let rest = &self.rest[start..];
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.rest = &rest[end..];
        Some(&rest[..end])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 4\nproperty uchar red\nproperty float x\n\
                          property float y\nproperty double z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";

    fn text(rows: &str) -> Result<TriangleList, ParseError> {
        parse_ply(format!("{HEADER}{rows}").as_bytes())
    }

    #[test]
    fn reads_text_and_cuts_polygons() {
        let list = text("255 0 0 0\n0 1 0 0\n0 1 1 0\r\n0 0 1 -2.5e-1\n4 0 1 2 3\n").unwrap();
        assert_eq!(
            list.vertices,
            [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::new(0.0, 1.0, -0.25)]
        );
        assert_eq!(list.triangles, [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn reads_both_byte_orders_and_skips_what_it_does_not_know() {
        let expected = text("0 0 0 0\n0 1 0 0\n0 1 1 0\n0 0 1 -0.25\n4 0 1 2 3\n").unwrap();
        for big in [false, true] {
            let name = if big { "big" } else { "little" };
            let header = HEADER.replace("ascii", &format!("binary_{name}_endian"));
            let header = header.replace(
                "element face",
                "element flag 2\nproperty list ushort short s\nelement nil 99999999999\nelement face",
            );
            let mut bytes = header.into_bytes();
            let f32 = |x: f32| if big { x.to_be_bytes() } else { x.to_le_bytes() };
            let f64 = |x: f64| if big { x.to_be_bytes() } else { x.to_le_bytes() };
            let u16 = |x: u16| if big { x.to_be_bytes() } else { x.to_le_bytes() };
            let i32 = |x: i32| if big { x.to_be_bytes() } else { x.to_le_bytes() };
            for v in &expected.vertices {
                bytes.push(7);
                bytes.extend([f32(v.x), f32(v.y)].concat());
                bytes.extend(f64(v.z.into()));
            }
            bytes.extend([u16(2), u16(1), u16(2), u16(0)].concat());
            bytes.push(4);
            bytes.extend([i32(0), i32(1), i32(2), i32(3)].concat());
            assert_eq!(parse_ply(&bytes).unwrap(), expected, "{name}");
            bytes.pop();
            let error = parse_ply(&bytes).unwrap_err().to_string();
            assert_eq!(error, "face 0 of 1: the file ends here: it is cut; export it again");
        }
    }

    #[test]
    fn reads_strips_with_restarts() {
        let header = HEADER.replace("face", "tristrips");
        let rows = "0 0 0 0\n0 1 0 0\n0 0 1 0\n0 1 1 0\n8 0 1 2 3 -1 3 2 1\n";
        let list = parse_ply(format!("{header}{rows}").as_bytes()).unwrap();
        assert_eq!(list.triangles, [[0, 1, 2], [2, 1, 3], [3, 2, 1]]);
    }

    #[test]
    fn errors_name_the_place() {
        let says = |result: Result<TriangleList, ParseError>, expected: &str| {
            assert_eq!(result.unwrap_err().to_string(), expected);
        };
        let four = "0 0 0 0\n0 1 0 0\n0 1 1 0\n0 0 1 0\n";
        says(text("0 0 0 0\n0 1 x 0\n"), "line 13 (vertex 1 of 4): \"x\" is not a number");
        says(
            text("0 0 0 0\n0 1 nan 0\n"),
            "line 13 (vertex 1 of 4): the position is [1, NaN, 0]; positions must be finite numbers",
        );
        says(
            text(&format!("{four}3 0 1 4")),
            "line 16 (face 0 of 1): vertex 4 does not exist; 4 vertices come before this face",
        );
        says(
            text(&format!("{four}3 0 1 0.5")),
            "line 16 (face 0 of 1): vertex 0.5 does not exist; 4 vertices come before this face",
        );
        says(
            text(&format!("{four}2 0 1")),
            "line 16 (face 0 of 1): a face needs three corners or more, there are 2",
        );
        says(text(&format!("{four}-1 0 1")), "line 16 (face 0 of 1): a list is -1 long");
        says(parse_ply(b"obj"), "line 1: a PLY file begins with a line \"ply\"");
        says(
            parse_ply(b""),
            "line 1: the header has no \"end_header\": the file is cut, or not a PLY file; export it again",
        );
        says(parse_ply(b"ply\nformat ascii 2\nelement face -1\n"), "line 3: \"-1\" is no number of elements");
        says(parse_ply(b"ply\nproperty int x\n"), "line 2: a property before any element");
        says(
            parse_ply(b"ply\nend_header\n"),
            "line 2: the header has no line \"format ascii 1.0\" or the like",
        );
        says(
            parse_ply(b"ply\nformat ascii 1.0\nelement vertex 1\nend_header\n"),
            "header: vertices have no number x",
        );
        says(
            parse_ply(b"ply\nformat ascii 1.0\nend_header\n"),
            "end of file: there are 0 vertices and no faces: a cloud of points; make a surface of it in a mesh program",
        );
    }
}
