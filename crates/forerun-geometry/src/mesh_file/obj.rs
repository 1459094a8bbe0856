//! Wavefront OBJ: the lines `v` (position) and `f` (face); all others are skipped.

use super::polygon::cut_polygon;
use super::{ParseError, TriangleList, parse_position, shortened};

/// The triangles of an OBJ file. Polygons are cut.
///
/// # Errors
/// With the number of the line: a position that is not three finite numbers, a vertex that does not exist (yet), a polygon that cannot
/// be cut into triangles, or no face at all.
pub fn parse_obj(bytes: &[u8]) -> Result<TriangleList, ParseError> {
    let mut list = TriangleList::default();
    let mut lines = 0;
    for (i, line) in bytes.split(|b| *b == b'\n').enumerate() {
        lines = i + 1;
        // Names and comments may be in any encoding.
        let line = String::from_utf8_lossy(line);
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let position = parse_position(&mut words).map_err(|m| ParseError::at_line(lines, m))?;
                list.vertices.push(position);
            }
            Some("f") => {
                let corners = words.map(|word| parse_corner(word, list.vertices.len()));
                let corners: Result<Vec<u32>, String> = corners.collect();
                let cut = corners.and_then(|corners| cut_polygon(&list.vertices, &corners));
                list.triangles.extend(cut.map_err(|m| ParseError::at_line(lines, m))?);
            }
            _ => {}
        }
    }
    if list.triangles.is_empty() {
        return Err(ParseError::new(
            format!("after {lines} lines"),
            format!(
                "there are {} vertices (v) and no faces (f): not an OBJ file, or only points",
                list.vertices.len()
            ),
        ));
    }
    Ok(list)
}

/// The vertex of a corner like `7`, `7/1`, `7//3` or `-1` (the last so far).
fn parse_corner(word: &str, vertices: usize) -> Result<u32, String> {
    let index = word.split('/').next().unwrap_or_default();
    let number: i64 = index.parse().map_err(|_| format!("\"{}\" names no vertex", shortened(word)))?;
    let count = vertices as i64;
    let zero_based = if number < 0 { count.checked_add(number) } else { Some(number - 1) };
    match zero_based {
        Some(i) if (0..count).contains(&i) => Ok(i as u32),
        _ => Err(format!("vertex {number} does not exist; {vertices} vertices come before this face")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;

    #[test]
    fn reads_positions_faces_and_relative_indices() {
        let list = parse_obj(
            b"# a comment\nmtllib x.mtl\nv 0 0 0\nv 1 0 0 1.0\r\nv 1 1 0 0.5 0.5 0.5\nvn 0 0 1\nv 0 1 -2.5e-1\nf 1/2/3 2//3 3\nf -4 -2 -1\n",
        )
        .unwrap();
        assert_eq!(list.vertices[3], Vec3::new(0.0, 1.0, -0.25));
        assert_eq!(list.triangles, [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn cuts_a_concave_polygon_where_a_fan_fits() {
        // An arrowhead: only fans from its notch (vertex 4) or its tip work.
        let text = b"v 0 0 0\nv 2 1 0\nv 0 2 0\nv 0.5 1 0\nf 1 2 3 4\n";
        let list = parse_obj(text).unwrap();
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| list.vertices[i as usize]);
            (b - a).cross(c - a).z
        };
        assert!(list.triangles.len() == 2 && list.triangles.iter().all(|t| area(t) > 0.0));
    }

    #[test]
    fn errors_name_the_line() {
        let says = |text: &str, expected: &str| {
            assert_eq!(parse_obj(text.as_bytes()).unwrap_err().to_string(), expected);
        };
        says("v 0 0\n", "line 1: a vertex needs three numbers, there are 2");
        says("\nv 0 x 0\n", "line 2: \"x\" is not a number");
        says("v 0 nan 0\n", "line 1: \"nan\" is not a finite number");
        says("v 0 0 0\nf 1 1 2", "line 2: vertex 2 does not exist; 1 vertices come before this face");
        says("v 0 0 0\nf 1 1 0", "line 2: vertex 0 does not exist; 1 vertices come before this face");
        says("v 0 0 0\nf 1 1 -2", "line 2: vertex -2 does not exist; 1 vertices come before this face");
        says("v 0 0 0\nf 1 1", "line 2: a face needs three corners or more, there are 2");
        says("v 0 0 0\nf 1 1 a/1", "line 2: \"a/1\" names no vertex");
        says("", "after 1 lines: there are 0 vertices (v) and no faces (f): not an OBJ file, or only points");
    }
}
