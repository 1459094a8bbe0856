//! Meshes from formulas: torus, ring, ball, box, frame and angle, for scenes and tests.
//!
//! All are closed, centred on the origin (but for the angle) and symmetric as far as their tessellation is.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use glam::{DVec2, DVec3};

use super::{Mesh, ShapeError};
use crate::Vec3;

mod link;
mod thread;

pub use link::{Link, link};
pub use thread::{Bolt, Grip, Nut, Thread, bolt, nut};

/// Most segments or sides that a maker accepts.
const FINEST: u32 = 1024;
/// Most parts that an edge of a ball is cut into: 327 680 triangles.
const FINEST_BALL: u32 = 128;

/// A torus about the y axis: `major` from its centre to the middle of the tube, `minor` the tube's radius (metres); `segments` round
/// the axis, `sides` round the tube. Has 2 `segments` `sides` triangles; its vertices lie on the true torus.
///
/// # Errors
/// When not 0 < `minor` < `major`, or a count is not from 3 to 1024.
pub fn torus(major: f32, minor: f32, segments: u32, sides: u32) -> Result<Mesh, ShapeError> {
    if !(minor > 0.0 && minor < major && major.is_finite()) {
        return Err(ShapeError::new(
            "minor",
            format!("must be above 0 and below major, is {minor} with major {major}"),
        ));
    }
    count("segments", segments, 3..=FINEST)?;
    count("sides", sides, 3..=FINEST)?;
    let section: Vec<DVec2> =
        (0..sides).map(|i| DVec2::new(major.into(), 0.0) + f64::from(minor) * on_circle(i, sides)).collect();
    revolve(&section, segments)
}

/// A ring of rectangular section about the y axis, like a washer or a pipe: radii and half height in metres. Has 8 `segments`
/// triangles.
///
/// # Errors
/// When not 0 < `inner` < `outer`, the half height is not above 0, or `segments` is not from 3 to 1024.
pub fn ring(outer: f32, inner: f32, half_height: f32, segments: u32) -> Result<Mesh, ShapeError> {
    if !(inner > 0.0 && inner < outer && outer.is_finite()) {
        return Err(ShapeError::new(
            "inner",
            format!("must be above 0 and below outer, is {inner} with outer {outer}"),
        ));
    }
    super::positive("half_height", half_height)?;
    count("segments", segments, 3..=FINEST)?;
    let (outer, inner, h) = (f64::from(outer), f64::from(inner), f64::from(half_height));
    revolve(
        &[DVec2::new(outer, -h), DVec2::new(outer, h), DVec2::new(inner, h), DVec2::new(inner, -h)],
        segments,
    )
}

/// A ball whose vertices lie on the sphere: an icosahedron with each edge cut into `parts`. Has 20 `parts`² triangles: 12 parts for
/// 2880.
///
/// # Errors
/// When the radius is not above 0, or `parts` is not from 1 to 128.
pub fn ball(radius: f32, parts: u32) -> Result<Mesh, ShapeError> {
    super::positive("radius", radius)?;
    count("parts", parts, 1..=FINEST_BALL)?;
    let (corners, faces) = icosahedron();
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for face in faces {
        let [a, b, c] = face.map(|i| corners[i]);
        // Row r has r + 1 points, from the side ab to the side ac. Points on an edge come out of the same sum for both of its faces
        // (a zero weight adds an exact zero), so that they weld.
        let first = vertices.len() as u32;
        for row in 0..=parts {
            for i in 0..=row {
                let weights = [parts - row, row - i, i].map(f64::from);
                vertices.push(sorted_sum([a * weights[0], b * weights[1], c * weights[2]], radius));
            }
        }
        let at = |row: u32, i: u32| first + row * (row + 1) / 2 + i;
        for row in 0..parts {
            for i in 0..=row {
                triangles.push([at(row, i), at(row + 1, i), at(row + 1, i + 1)]);
                if i < row {
                    triangles.push([at(row, i), at(row + 1, i + 1), at(row, i + 1)]);
                }
            }
        }
    }
    Ok(without_repairs(Mesh::new(vertices, triangles)?))
}

/// A box as 12 triangles.
///
/// # Errors
/// When a half extent is not above 0.
pub fn cuboid(half_extents: Vec3) -> Result<Mesh, ShapeError> {
    for half_extent in half_extents.to_array() {
        super::positive("half_extents", half_extent)?;
    }
    let h = half_extents;
    blocks([&[-h.x, h.x], &[-h.y, h.y], &[-h.z, h.z]], |_| true)
}

/// A rectangular frame with a hole along y: a box of the given half extents whose bars are `width` wide in x and z (metres).
///
/// # Errors
/// When a half extent or the width is not above 0, or the bars leave no hole.
pub fn frame(half_extents: Vec3, width: f32) -> Result<Mesh, ShapeError> {
    for half_extent in half_extents.to_array() {
        super::positive("half_extents", half_extent)?;
    }
    super::positive("width", width)?;
    let h = half_extents;
    if width >= h.x.min(h.z) {
        return Err(ShapeError::new(
            "width",
            format!(
                "must be below the half extents in x and z ({} and {}) to leave a hole, is {width}",
                h.x, h.z
            ),
        ));
    }
    let across = |h: f32| [-h, -h + width, h - width, h];
    blocks([&across(h.x), &[-h.y, h.y], &across(h.z)], |[x, _, z]| x != 1 || z != 1)
}

/// An angle (L-shape): arms of `length` along +x and +y from the origin's corner, each `width` wide, from -half_depth to half_depth
/// in z (metres).
///
/// # Errors
/// When not 0 < `width` < `length`, or the half depth is not above 0.
pub fn angle(length: f32, width: f32, half_depth: f32) -> Result<Mesh, ShapeError> {
    super::positive("length", length)?;
    super::positive("half_depth", half_depth)?;
    if !(width > 0.0 && width < length) {
        return Err(ShapeError::new(
            "width",
            format!("must be above 0 and below the length of the arms ({length}), is {width}"),
        ));
    }
    let arms = [0.0, width, length];
    blocks([&arms, &arms, &[-half_depth, half_depth]], |[x, y, _]| x == 0 || y == 0)
}

fn count(field: &'static str, value: u32, range: RangeInclusive<u32>) -> Result<(), ShapeError> {
    if range.contains(&value) {
        Ok(())
    } else {
        Err(ShapeError::new(field, format!("must be from {} to {}, is {value}", range.start(), range.end())))
    }
}

fn on_circle(i: u32, of: u32) -> DVec2 {
    let (sin, cos) = libm::sincos(TAU * f64::from(i) / f64::from(of));
    DVec2::new(cos, sin)
}

/// A closed section (x: distance from the y axis, y: height; counter-clockwise) turned about the y axis.
fn revolve(section: &[DVec2], segments: u32) -> Result<Mesh, ShapeError> {
    let sides = section.len() as u32;
    let mut vertices = Vec::new();
    for segment in 0..segments {
        let turn = on_circle(segment, segments);
        vertices.extend(section.iter().map(|p| DVec3::new(p.x * turn.x, p.y, p.x * turn.y).as_vec3()));
    }
    let at = |segment: u32, side: u32| (segment % segments) * sides + side % sides;
    let mut triangles = Vec::new();
    for i in 0..segments {
        for j in 0..sides {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    Ok(Mesh::new(vertices, triangles)?)
}

/// The surface of the filled cells of a grid with planes at the given places along x, y and z.
fn blocks(planes: [&[f32]; 3], filled: impl Fn([usize; 3]) -> bool) -> Result<Mesh, ShapeError> {
    let cells = planes.map(|p| p.len() - 1);
    let corner = |at: [usize; 3]| Vec3::new(planes[0][at[0]], planes[1][at[1]], planes[2][at[2]]);
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for cell in (0..cells[0] * cells[1] * cells[2])
        .map(|i| [i % cells[0], i / cells[0] % cells[1], i / cells[0] / cells[1]])
        .filter(|cell| filled(*cell))
    {
        for axis in 0..3 {
            let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
            for high in [0, 1] {
                let mut beyond = cell;
                beyond[axis] = beyond[axis].wrapping_add(high * 2).wrapping_sub(1);
                if beyond[axis] < cells[axis] && filled(beyond) {
                    continue;
                }
                let first = vertices.len() as u32;
                for [i, j] in [[0, 0], [1, 0], [1, 1], [0, 1]] {
                    let mut at = cell;
                    at[axis] += high;
                    at[u] += i;
                    at[v] += j;
                    vertices.push(corner(at));
                }
                // Counter-clockwise in u, v is outwards on the high side.
                let order = if high == 1 { [0, 1, 2, 3] } else { [0, 3, 2, 1] };
                let [a, b, c, d] = order.map(|i| first + i);
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    Ok(without_repairs(Mesh::new(vertices, triangles)?))
}

/// Welding is how the makers join their patches: nothing that a user should hear about.
fn without_repairs(mut mesh: Mesh) -> Mesh {
    mesh.repairs.welded_vertices = 0;
    mesh
}

/// The sum in an order that depends on the three terms alone, put on the sphere.
fn sorted_sum(mut terms: [DVec3; 3], radius: f32) -> Vec3 {
    terms.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z)));
    let sum = terms[0] + terms[1] + terms[2];
    (sum / sum.length() * f64::from(radius)).as_vec3()
}

/// Corners (not on the unit sphere) and outward faces of an icosahedron: three golden rectangles.
fn icosahedron() -> ([DVec3; 12], [[usize; 3]; 20]) {
    let g = f64::midpoint(1.0, 5.0_f64.sqrt());
    let corners = [
        DVec3::new(-1.0, g, 0.0),
        DVec3::new(1.0, g, 0.0),
        DVec3::new(-1.0, -g, 0.0),
        DVec3::new(1.0, -g, 0.0),
        DVec3::new(0.0, -1.0, g),
        DVec3::new(0.0, 1.0, g),
        DVec3::new(0.0, -1.0, -g),
        DVec3::new(0.0, 1.0, -g),
        DVec3::new(g, 0.0, -1.0),
        DVec3::new(g, 0.0, 1.0),
        DVec3::new(-g, 0.0, -1.0),
        DVec3::new(-g, 0.0, 1.0),
    ];
    let faces = [
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    (corners, faces)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn makers_give_closed_outward_meshes_without_repairs() {
        let made = [
            (torus(0.4, 0.2, 48, 16).unwrap(), 2 * 48 * 16),
            (ring(1.0, 0.5, 0.1, 60).unwrap(), 8 * 60),
            (ball(1.0, 1).unwrap(), 20),
            (ball(0.5, 12).unwrap(), 2880),
            (cuboid(Vec3::new(1.0, 2.0, 3.0)).unwrap(), 12),
            (frame(Vec3::new(0.5, 0.04, 0.5), 0.08).unwrap(), 2 * 32),
            (angle(1.0, 0.2, 0.1).unwrap(), 2 * 14),
        ];
        for (mesh, triangles) in made {
            assert!(mesh.has_inside() && mesh.repairs.is_none(), "{}", mesh.repairs);
            assert_eq!(mesh.triangles.len(), triangles);
        }
    }

    #[test]
    fn a_balls_vertices_lie_on_it() {
        let mesh = ball(2.0, 7).unwrap();
        assert_eq!(mesh.vertices.len(), 10 * 49 + 2);
        assert!(mesh.vertices.iter().all(|v| (v.length() - 2.0).abs() < 1e-6));
    }

    #[test]
    fn refuse_what_cannot_be() {
        assert_eq!(torus(0.2, 0.4, 48, 16).unwrap_err().field, "minor");
        assert_eq!(torus(0.4, 0.2, 2, 16).unwrap_err().field, "segments");
        assert_eq!(frame(Vec3::ONE, 1.0).unwrap_err().field, "width");
        assert_eq!(angle(1.0, f32::NAN, 0.1).unwrap_err().field, "width");
        assert_eq!(ball(1.0, 5000).unwrap_err().field, "parts");
    }
}
