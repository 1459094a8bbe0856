//! Hull: a convex polyhedron with what contact needs to know of it.

use std::collections::BTreeMap;

use glam::DVec3;

use super::ShapeError;
use super::hull_faces::merge_faces;
use super::hull_surface::hull_triangles;
use crate::Vec3;

/// Points nearer to each other than this part of the hull's extent count as one.
const WELD: f64 = 1e-6;
/// Corners this close to a plane, as a part of the hull's extent, belong to the face.
const COPLANAR: f64 = 1e-5;
/// A hull thinner than this part of its extent is refused: its faces could no longer be told apart.
const THINNEST: f64 = 1e-4;

/// A convex polyhedron. Faces are planar polygons, coplanar triangles merged.
#[derive(Clone, Debug, PartialEq)]
pub struct Hull {
    /// Corners, in the order in which they were first given. Metres.
    pub vertices: Vec<Vec3>,
    /// Faces.
    pub faces: Vec<HullFace>,
    /// Vertex indices of all faces, one face after the other, counter-clockwise seen from outside.
    pub corners: Vec<u32>,
    /// Edges, each once.
    pub edges: Vec<HullEdge>,
    /// A point well inside: the mean of the vertices. Metres.
    pub centre: Vec3,
    /// Distance from the centre to the nearest face: a ball of this radius about it is inside. Metres.
    pub inner_radius: f32,
}

/// A face of a hull.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HullFace {
    /// Unit outward normal.
    pub normal: Vec3,
    /// Distance of the plane from the origin along the normal. Metres.
    pub offset: f32,
    /// First of its corners in [`Hull::corners`].
    pub first: u32,
    /// How many corners it has, 3 or more.
    pub count: u32,
}

/// An edge of a hull, between two faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HullEdge {
    /// Its two vertices, the lower index first.
    pub vertices: [u32; 2],
    /// The two faces that meet in it: first the one that passes it from the first vertex to the second.
    pub faces: [u32; 2],
}

impl Hull {
    /// The convex hull of points (metres). Points inside, on edges or on faces are left out, and of points closer than a millionth of
    /// the extent the first is kept.
    ///
    /// # Errors
    /// When there are fewer than 4 different points, one is not finite, or the hull is thinner than 1/10000 of its extent.
    pub fn new(points: &[Vec3]) -> Result<Hull, ShapeError> {
        let refuse = |message: String| Err(ShapeError::new("points", message));
        if let Some(i) = points.iter().position(|p| !p.is_finite()) {
            return refuse(format!("must be finite numbers, point {i} is {}", points[i]));
        }
        let extent = extent(points);
        let points = weld(points, WELD * extent);
        if points.len() < 4 {
            return refuse(format!("a hull needs at least 4 different points, there are {}", points.len()));
        }
        let flat = || {
            refuse(format!(
                "all {} points lie in a plane (or nearly: thinner than 1/10000 of the extent, {extent} m); a thin box needs thickness",
                points.len()
            ))
        };
        let Some(triangles) = hull_triangles(&points) else {
            return flat();
        };
        let loops = merge_faces(&points, &triangles, COPLANAR * extent);
        let Some(hull) = assemble(&points, &loops) else {
            return flat();
        };
        if f64::from(hull.thinnest_width()) < THINNEST * extent { flat() } else { Ok(hull) }
    }

    /// The vertex indices of a face, counter-clockwise seen from outside.
    #[must_use]
    pub fn face_corners(&self, face: &HullFace) -> &[u32] {
        &self.corners[face.first as usize..(face.first + face.count) as usize]
    }

    /// The faces cut into triangles, each by its corners (metres).
    pub fn triangles(&self) -> impl Iterator<Item = [Vec3; 3]> + Clone {
        self.faces.iter().flat_map(|face| {
            let corners = self.face_corners(face);
            let at = |i: usize| self.vertices[corners[i] as usize];
            (1..corners.len() - 1).map(move |i| [at(0), at(i), at(i + 1)])
        })
    }

    /// The smallest of the widths along the face normals. Metres.
    #[must_use]
    pub fn thinnest_width(&self) -> f32 {
        let width = |face: &HullFace| {
            self.vertices.iter().map(|v| face.offset - face.normal.dot(*v)).fold(0.0, f32::max)
        };
        self.faces.iter().map(width).fold(f32::INFINITY, f32::min)
    }
}

/// The longest side of the box around the points. Metres.
fn extent(points: &[Vec3]) -> f64 {
    let min = points.iter().fold(DVec3::INFINITY, |m, p| m.min(p.as_dvec3()));
    let max = points.iter().fold(DVec3::NEG_INFINITY, |m, p| m.max(p.as_dvec3()));
    if points.is_empty() { 0.0 } else { (max - min).max_element() }
}

/// The points without those within `distance` of an earlier one.
fn weld(points: &[Vec3], distance: f64) -> Vec<Vec3> {
    let mut by_x: Vec<usize> = (0..points.len()).collect();
    by_x.sort_by(|&i, &j| points[i].x.total_cmp(&points[j].x).then(i.cmp(&j)));
    let mut dropped = vec![false; points.len()];
    for (at, &i) in by_x.iter().enumerate() {
        for &j in &by_x[at + 1..] {
            if f64::from(points[j].x) - f64::from(points[i].x) > distance {
                break;
            }
            if !dropped[i] && !dropped[j] && points[i].as_dvec3().distance(points[j].as_dvec3()) <= distance {
                dropped[i.max(j)] = true;
            }
        }
    }
    points.iter().zip(&dropped).filter(|(_, dropped)| !**dropped).map(|(p, _)| *p).collect()
}

/// The hull with the given faces; `None` when they do not close.
fn assemble(points: &[Vec3], loops: &[Vec<u32>]) -> Option<Hull> {
    let mut used: Vec<u32> = loops.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    if used.len() < 4 || loops.len() < 4 {
        return None;
    }
    let vertices: Vec<Vec3> = used.iter().map(|&i| points[i as usize]).collect();
    let mut corners: Vec<u32> = Vec::new();
    let mut faces = Vec::new();
    let mut face_of_edge = BTreeMap::new();
    for face_loop in loops {
        let first = corners.len();
        // Every vertex of a loop is in `used`, which is sorted.
        corners.extend(face_loop.iter().map(|v| used.partition_point(|u| u < v) as u32));
        let own = &corners[first..];
        for (i, &a) in own.iter().enumerate() {
            face_of_edge.insert((a, own[(i + 1) % own.len()]), faces.len() as u32);
        }
        let (normal, offset) = plane(&vertices, own);
        faces.push(HullFace { normal, offset, first: first as u32, count: own.len() as u32 });
    }
    let mut edges = Vec::new();
    for (&(a, b), &face) in &face_of_edge {
        let other = *face_of_edge.get(&(b, a))?;
        if a < b {
            edges.push(HullEdge { vertices: [a, b], faces: [face, other] });
        }
    }
    let sum: DVec3 = vertices.iter().map(|v| v.as_dvec3()).sum();
    let centre = (sum / vertices.len() as f64).as_vec3();
    let inner_radius = hull_inner_radius(&faces, centre);
    Some(Hull { vertices, faces, corners, edges, centre, inner_radius })
}

/// Distance from a point inside a hull to the nearest of its faces; infinite where there are none. Metres.
#[must_use]
pub fn hull_inner_radius(faces: &[HullFace], centre: Vec3) -> f32 {
    faces.iter().fold(f32::INFINITY, |least, face| least.min(face.offset - face.normal.dot(centre)))
}

/// Unit normal (Newell's) and offset of a polygon; no corner is in front of the plane.
fn plane(vertices: &[Vec3], corners: &[u32]) -> (Vec3, f32) {
    let at = |i: usize| vertices[corners[i % corners.len()] as usize].as_dvec3();
    let origin = at(0);
    let doubled: DVec3 = (1..corners.len()).map(|i| (at(i) - origin).cross(at(i + 1) - origin)).sum();
    let normal = doubled.normalize_or_zero();
    let offset = (0..corners.len()).map(|i| normal.dot(at(i))).fold(f64::NEG_INFINITY, f64::max);
    (normal.as_vec3(), offset as f32)
}
