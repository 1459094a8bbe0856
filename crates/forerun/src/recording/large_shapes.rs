//! Large shapes: hulls, meshes and compounds are stored once each, and bodies refer to them.
//!
//! Promise: a shape comes back bit for bit, and nothing that a file says makes one that no constructor would.

use std::collections::BTreeMap;
use std::sync::Arc;

use forerun_geometry::shape::{
    Capsule, Compound, Cuboid, Cylinder, Hull, HullEdge, HullFace, Inside, Mesh, MeshDraft, MeshOptions,
    MeshRepairs, Sphere, hull_inner_radius,
};
use forerun_geometry::{Pose, Quat, Shape, Vec3};
use serde::{Deserialize, Serialize};

/// How far a corner may be outside a face of its hull, as a part of the hull's size: hulls are made with less.
const HULL_TOLERANCE: f32 = 1e-3;

/// Three numbers.
pub(crate) type Three = [f32; 3];

/// A position and a rotation (x, y, z, w).
pub(crate) type PoseValue = (Three, [f32; 4]);

pub(crate) fn pose_value(pose: &Pose) -> PoseValue {
    (pose.position.to_array(), pose.rotation.to_array())
}

pub(crate) fn pose_of((position, rotation): PoseValue) -> Pose {
    Pose::new(Vec3::from_array(position), Quat::from_array(rotation))
}

/// A shape, as a body has it.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) enum ShapeValue {
    Sphere(f32),
    Cuboid(Three),
    Capsule {
        half_height: f32,
        radius: f32,
    },
    Cylinder {
        half_height: f32,
        radius: f32,
    },
    HalfSpace,
    /// That of the shape record with this number, from 0.
    Stored(u32),
}

/// A shape that is stored once.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) enum LargeShape {
    Hull {
        vertices: Vec<Three>,
        /// Normal, offset, first corner, number of corners.
        faces: Vec<(Three, f32, u32, u32)>,
        corners: Vec<u32>,
        /// Vertices, faces.
        edges: Vec<([u32; 2], [u32; 2])>,
        centre: Three,
    },
    /// Vertices, triangles, whether an inside is needed, the wished cell size, and what was mended before these triangles came to be:
    /// welded, unused, dropped, recut, flipped, turned.
    Mesh {
        vertices: Vec<Three>,
        triangles: Vec<[u32; 3]>,
        inside: bool,
        cell: Option<f32>,
        repairs: ([u32; 5], bool),
    },
    Compound(Vec<(PoseValue, ShapeValue)>),
}

/// The shapes that a file has so far, to write others.
#[derive(Debug, Default)]
pub(crate) struct StoredShapes {
    /// By where it is in memory: its number.
    numbers: BTreeMap<usize, u32>,
    /// Kept, so that nothing else comes to be where they are.
    kept: Vec<Shape>,
}

impl StoredShapes {
    /// The shapes by their numbers.
    pub(crate) fn shapes(&self) -> &[Shape] {
        &self.kept
    }

    /// The value of a shape. What has to be stored before goes to `new`, in this order.
    pub(crate) fn value(&mut self, shape: &Shape, new: &mut Vec<LargeShape>) -> ShapeValue {
        let place = match shape {
            Shape::Sphere(s) => return ShapeValue::Sphere(s.radius),
            Shape::Cuboid(s) => return ShapeValue::Cuboid(s.half_extents.to_array()),
            Shape::Capsule(s) => {
                return ShapeValue::Capsule { half_height: s.half_height, radius: s.radius };
            }
            Shape::Cylinder(s) => {
                return ShapeValue::Cylinder { half_height: s.half_height, radius: s.radius };
            }
            Shape::HalfSpace => return ShapeValue::HalfSpace,
            Shape::Hull(hull) => Arc::as_ptr(hull) as usize,
            Shape::Mesh(mesh) => Arc::as_ptr(mesh) as usize,
            Shape::Compound(compound) => Arc::as_ptr(compound) as usize,
        };
        if let Some(number) = self.numbers.get(&place) {
            return ShapeValue::Stored(*number);
        }
        let large = match shape {
            Shape::Hull(hull) => hull_value(hull),
            Shape::Mesh(mesh) => mesh_value(mesh),
            Shape::Compound(compound) => {
                let parts = compound.parts.iter();
                LargeShape::Compound(
                    parts.map(|(pose, part)| (pose_value(pose), self.value(part, new))).collect(),
                )
            }
            // The others are no large ones: see above.
            _ => return ShapeValue::HalfSpace,
        };
        new.push(large);
        let number = self.kept.len() as u32;
        self.kept.push(shape.clone());
        self.numbers.insert(place, number);
        ShapeValue::Stored(number)
    }
}

fn hull_value(hull: &Hull) -> LargeShape {
    LargeShape::Hull {
        vertices: hull.vertices.iter().map(Vec3::to_array).collect(),
        faces: hull.faces.iter().map(|f| (f.normal.to_array(), f.offset, f.first, f.count)).collect(),
        corners: hull.corners.clone(),
        edges: hull.edges.iter().map(|edge| (edge.vertices, edge.faces)).collect(),
        centre: hull.centre.to_array(),
    }
}

fn mesh_value(mesh: &Mesh) -> LargeShape {
    let r = &mesh.repairs;
    let counts =
        [r.welded_vertices, r.unused_vertices, r.dropped_triangles, r.recut_triangles, r.flipped_triangles];
    LargeShape::Mesh {
        vertices: mesh.vertices.iter().map(Vec3::to_array).collect(),
        triangles: mesh.triangles.clone(),
        inside: mesh.options().inside == Inside::Needed,
        cell: mesh.options().cell,
        repairs: (counts, r.turned),
    }
}

/// The shape of a value; `stored` are those of the shape records so far.
pub(crate) fn shape_of(value: ShapeValue, stored: &[Shape]) -> Result<Shape, String> {
    let made = match value {
        ShapeValue::Sphere(radius) => Shape::sphere(radius).map(|_| Shape::Sphere(Sphere { radius })),
        ShapeValue::Cuboid(half_extents) => {
            let half_extents = Vec3::from_array(half_extents);
            Shape::cuboid(half_extents).map(|_| Shape::Cuboid(Cuboid { half_extents }))
        }
        ShapeValue::Capsule { half_height, radius } => {
            Shape::capsule(half_height, radius).map(|_| Shape::Capsule(Capsule { half_height, radius }))
        }
        ShapeValue::Cylinder { half_height, radius } => {
            Shape::cylinder(half_height, radius).map(|_| Shape::Cylinder(Cylinder { half_height, radius }))
        }
        ShapeValue::HalfSpace => Ok(Shape::HalfSpace),
        ShapeValue::Stored(number) => {
            let found = stored.get(number as usize).cloned();
            return found.ok_or_else(|| format!("there is no shape {number} before it"));
        }
    };
    made.map_err(|error| error.to_string())
}

/// A stored shape; `stored` are those before it. Distance fields are baked again.
pub(crate) fn large_shape_of(value: LargeShape, stored: &[Shape]) -> Result<Shape, String> {
    large_shape_with(value, stored, None)
}

/// The same with the distance field that a mesh had ([`Mesh::baked_bytes`]); it is baked again where that is damaged.
pub(crate) fn large_shape_with(
    value: LargeShape,
    stored: &[Shape],
    baked: Option<&[u8]>,
) -> Result<Shape, String> {
    match value {
        LargeShape::Hull { vertices, faces, corners, edges, centre } => {
            let face = |(normal, offset, first, count)| HullFace {
                normal: Vec3::from_array(normal),
                offset,
                first,
                count,
            };
            let faces: Vec<HullFace> = faces.into_iter().map(face).collect();
            let centre = Vec3::from_array(centre);
            let hull = Hull {
                vertices: vertices.into_iter().map(Vec3::from_array).collect(),
                inner_radius: hull_inner_radius(&faces, centre),
                faces,
                corners,
                edges: edges.into_iter().map(|(vertices, faces)| HullEdge { vertices, faces }).collect(),
                centre,
            };
            check_hull(&hull).map_err(|what| format!("a hull {what}"))?;
            Ok(Shape::Hull(Arc::new(hull)))
        }
        LargeShape::Mesh { vertices, triangles, inside, cell, repairs } => {
            let vertices: Vec<Vec3> = vertices.into_iter().map(Vec3::from_array).collect();
            let mut mesh = mesh_of((vertices, triangles), (inside, cell), baked)?;
            let ([welded, unused, dropped, recut, flipped], turned) = repairs;
            mesh.repairs = MeshRepairs {
                welded_vertices: welded,
                unused_vertices: unused,
                dropped_triangles: dropped,
                recut_triangles: recut,
                flipped_triangles: flipped,
                turned,
                ..mesh.repairs
            };
            Ok(mesh.into())
        }
        LargeShape::Compound(parts) => {
            let parts: Result<Vec<(Pose, Shape)>, String> = (parts.into_iter())
                .map(|(pose, part)| Ok((pose_of(pose), shape_of(part, stored)?)))
                .collect();
            let parts = parts?;
            Compound::new(parts.clone()).map_err(|error| format!("a compound: {error}"))?;
            // The parts as they are: rotations that are normalised twice may differ in the last bit.
            Ok(Shape::Compound(Arc::new(Compound { parts })))
        }
    }
}

/// The mesh of triangles that came from one.
fn mesh_of(
    triangles: (Vec<Vec3>, Vec<[u32; 3]>),
    (inside, cell): (bool, Option<f32>),
    baked: Option<&[u8]>,
) -> Result<Mesh, String> {
    let options = MeshOptions { inside: if inside { Inside::Needed } else { Inside::Optional }, cell };
    let fail = |error| format!("a mesh: {error}");
    let draft = MeshDraft::new(triangles.0.clone(), triangles.1.clone(), options).map_err(fail)?;
    let restored = baked.and_then(|bytes| draft.restore(bytes).ok());
    let mesh = restored.map_or_else(|| draft.bake(&|_, _| {}).map_err(fail), Ok)?;
    // A mesh that was mended once needs no more of it.
    if (&mesh.vertices, &mesh.triangles) != (&triangles.0, &triangles.1) {
        return Err("a mesh that does not come out as it was".to_owned());
    }
    Ok(mesh)
}

/// Whether a hull is closed and convex, and its parts refer to what is there.
fn check_hull(hull: &Hull) -> Result<(), &'static str> {
    let (vertices, faces) = (hull.vertices.len(), hull.faces.len());
    let known = |indices: &[u32], count: usize| indices.iter().all(|index| (*index as usize) < count);
    if vertices < 4 || faces < 4 || vertices + faces != hull.edges.len() + 2 {
        return Err("is not closed");
    }
    let finite = hull.vertices.iter().chain([&hull.centre]).all(|v| v.is_finite());
    let size = hull.vertices.iter().fold(0.0, |size: f32, v| size.max((*v - hull.centre).length()));
    if !(finite && size > 0.0 && size.is_finite()) {
        return Err("has numbers that are not finite, or no size");
    }
    if !known(&hull.corners, vertices)
        || !hull.edges.iter().all(|edge| known(&edge.vertices, vertices) && known(&edge.faces, faces))
    {
        return Err("refers to corners or faces that are not there");
    }
    for face in &hull.faces {
        let end = u64::from(face.first) + u64::from(face.count);
        if face.count < 3 || end > hull.corners.len() as u64 {
            return Err("has a face without corners");
        }
        let normal = face.normal;
        let unit = (normal.length_squared() - 1.0).abs() < HULL_TOLERANCE;
        let above = |point: &Vec3| normal.dot(*point) - face.offset;
        let on_plane = hull
            .face_corners(face)
            .iter()
            .all(|corner| above(&hull.vertices[*corner as usize]).abs() <= HULL_TOLERANCE * size);
        let convex = hull.vertices.iter().all(|v| above(v) <= HULL_TOLERANCE * size);
        if !(unit && face.offset.is_finite() && on_plane && convex && above(&hull.centre) < 0.0) {
            return Err("is not convex");
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use forerun_geometry::shape::mesh_make;

    fn hull() -> Shape {
        let points = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(0.9, 0.8, 0.7)];
        Shape::hull(&points).expect("five points")
    }

    fn shapes() -> Vec<Shape> {
        let turned = Pose::new(Vec3::Y, Quat::from_xyzw(0.1, 0.2, 0.3, 0.93).normalize());
        let compound = Shape::compound(vec![(turned, hull()), (Pose::IDENTITY, Shape::sphere(0.5).unwrap())]);
        let open = Mesh::open(vec![Vec3::ZERO, Vec3::Z, Vec3::X], vec![[0, 1, 2]]).unwrap();
        vec![
            Shape::sphere(0.5).unwrap(),
            Shape::cuboid(Vec3::new(0.1, 0.2, 0.3)).unwrap(),
            Shape::capsule(0.0, 0.3).unwrap(),
            Shape::cylinder(0.2, 0.3).unwrap(),
            Shape::HalfSpace,
            hull(),
            compound.unwrap(),
            mesh_make::torus(0.5, 0.15, 12, 8).unwrap().into(),
            open.into(),
        ]
    }

    #[test]
    fn shapes_come_back_and_are_stored_once() {
        let (mut stored, mut new) = (StoredShapes::default(), Vec::new());
        let shapes = shapes();
        let values: Vec<ShapeValue> = shapes.iter().map(|shape| stored.value(shape, &mut new)).collect();
        let again: Vec<ShapeValue> = shapes.iter().map(|shape| stored.value(shape, &mut new)).collect();
        assert_eq!(format!("{values:?}"), format!("{again:?}"));
        // The compound has a hull of its own.
        assert_eq!(new.len(), 5);
        let mut made: Vec<Shape> = Vec::new();
        for large in new {
            let shape = large_shape_of(large, &made).expect("it was one");
            made.push(shape);
        }
        for (shape, value) in shapes.iter().zip(values) {
            assert_eq!(shape_of(value, &made).as_ref(), Ok(shape));
        }
    }

    #[test]
    fn hulls_that_are_none_are_refused() {
        let Shape::Hull(good) = hull() else { unreachable!("it is a hull") };
        let refused = |change: fn(&mut Hull)| {
            let mut bad = Hull::clone(&good);
            assert_eq!(check_hull(&bad), Ok(()));
            change(&mut bad);
            assert!(check_hull(&bad).is_err(), "{bad:?}");
        };
        refused(|hull| hull.corners[2] = 5);
        refused(|hull| hull.edges[0].faces[1] = 1000);
        refused(|hull| hull.faces[0].first = u32::MAX);
        refused(|hull| hull.faces[0].count = 2);
        refused(|hull| hull.faces[1].normal = Vec3::NAN);
        refused(|hull| hull.faces[1].offset = f32::INFINITY);
        refused(|hull| hull.vertices[3].x = f32::NAN);
        refused(|hull| hull.vertices[3] *= 2.0);
        refused(|hull| hull.centre = Vec3::splat(3.0));
        refused(|hull| hull.edges.truncate(5));
        refused(|hull| hull.vertices.clear());
    }
}
