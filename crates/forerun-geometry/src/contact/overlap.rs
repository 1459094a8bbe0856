//! Overlap: whether two shapes share a point, wherever in them that is. For questions from outside; the step asks for manifolds.
//!
//! Convex shapes by the distance of their cores (GJK), a mesh triangle by triangle, and where no surfaces meet by whether one shape is
//! inside the other.

use glam::DVec3;

use super::gjk::{self, Distance};
use super::solid::Solid;
use crate::shape::{Enclosure, Hull, Mesh};
use crate::{Aabb, Pose, Shape, Vec3};

/// Shapes nearer to each other than this touch: what GJK and the rounding of poses leave open. Metres.
const TOUCHING: f32 = 1.0e-6;

impl Shape {
    /// Whether this shape at `pose` and another at its pose share a point. Those that touch do, to within a few micrometres.
    ///
    /// An open mesh has no inside: only its triangles count. `false` where a pose is not finite.
    #[must_use]
    pub fn overlaps(&self, pose: &Pose, other: &Shape, other_pose: &Pose) -> bool {
        let finite = |pose: &Pose| pose.position.is_finite() && pose.rotation.is_finite();
        finite(pose) && finite(other_pose) && overlap((self, pose), (other, other_pose))
    }
}

fn overlap(first: (&Shape, &Pose), second: (&Shape, &Pose)) -> bool {
    match (first, second) {
        ((Shape::Compound(compound), pose), _) => {
            compound.parts.iter().any(|(part, shape)| overlap((shape, &(*pose * *part)), second))
        }
        (_, (Shape::Compound(_), _)) => overlap(second, first),
        ((Shape::HalfSpace, ground), _) => reaches_into(ground, second),
        (_, (Shape::HalfSpace, ground)) => reaches_into(ground, first),
        ((Shape::Mesh(a), pose_a), (Shape::Mesh(b), pose_b)) => {
            let b_in_a = pose_a.inverse() * *pose_b;
            meshes_meet(a, b, &b_in_a)
                || b.vertices.first().is_some_and(|v| holds(a, b_in_a.transform_point(*v)))
                || a.vertices.first().is_some_and(|v| holds(b, b_in_a.inverse_transform_point(*v)))
        }
        ((Shape::Mesh(mesh), pose), _) => mesh_and_convex(mesh, second.0, &(pose.inverse() * *second.1)),
        (_, (Shape::Mesh(mesh), pose)) => mesh_and_convex(mesh, first.0, &(pose.inverse() * *first.1)),
        _ => {
            let origin = first.1.position;
            let (a, b) = (Solid::new(first.0, first.1, origin), Solid::new(second.0, second.1, origin));
            a.zip(b).is_some_and(|(a, b)| solids_meet(&a, &b))
        }
    }
}

fn solids_meet(a: &Solid, b: &Solid) -> bool {
    let reach = a.radius + b.radius + TOUCHING;
    match gjk::distance(a, b, reach) {
        Distance::Apart(witness) => witness.separation <= f64::from(reach),
        Distance::Overlap(_) => true,
    }
}

/// Whether anything of a shape is in a half-space.
fn reaches_into(ground: &Pose, (shape, pose): (&Shape, &Pose)) -> bool {
    let up = ground.rotation * Vec3::Y;
    let height = |point: Vec3| (point - ground.position).dot(up);
    match shape {
        // Two of them are apart only where they turn their backs on each other.
        Shape::HalfSpace => {
            up.dot(pose.rotation * Vec3::Y) > -1.0 + 1.0e-6 || height(pose.position) <= TOUCHING
        }
        Shape::Mesh(mesh) => mesh.vertices.iter().any(|v| height(pose.transform_point(*v)) <= TOUCHING),
        _ => Solid::new(shape, pose, ground.position).is_some_and(|solid| {
            let lowest = solid.support(-up.as_dvec3()).dot(up.as_dvec3());
            lowest <= f64::from(solid.radius + TOUCHING)
        }),
    }
}

/// A mesh and a convex shape at a pose in the mesh's frame.
fn mesh_and_convex(mesh: &Mesh, shape: &Shape, pose: &Pose) -> bool {
    let Some(solid) = Solid::new(shape, pose, Vec3::ZERO) else { return false };
    let mut triangle = Triangle::default();
    triangles_in(mesh, &shape.aabb(pose))
        .into_iter()
        .any(|t| triangle.at(mesh.corners(t), |t| solids_meet(t, &solid)))
        || holds(mesh, solid.middle())
}

/// Whether the surfaces of two meshes meet; the second is at a pose in the frame of the first.
fn meshes_meet(a: &Mesh, b: &Mesh, b_in_a: &Pose) -> bool {
    let a_in_b = b_in_a.inverse();
    let (mut of_a, mut of_b) = (Triangle::default(), Triangle::default());
    triangles_in(b, &bounds_at(a, &a_in_b)).into_iter().any(|tb| {
        let corners = b.corners(tb).map(|corner| b_in_a.transform_point(corner));
        let near = triangles_in(a, &Aabb::around(corners.into_iter()));
        of_b.at(corners, |tb| near.iter().any(|ta| of_a.at(a.corners(*ta), |ta| solids_meet(ta, tb))))
    })
}

/// A box around a mesh at a pose.
fn bounds_at(mesh: &Mesh, pose: &Pose) -> Aabb {
    Aabb::around(mesh.vertices.iter().map(|v| pose.transform_point(*v)))
}

/// The triangles of a mesh near a box in its frame.
fn triangles_in(mesh: &Mesh, aabb: &Aabb) -> Vec<usize> {
    let mut found = Vec::new();
    mesh.triangles_near(&aabb.grown(TOUCHING), |triangle| found.push(triangle as usize));
    found
}

/// Whether a point that is not on the surface of a mesh is inside. In the mesh's frame.
fn holds(mesh: &Mesh, point: Vec3) -> bool {
    // Any way out will do; one that follows no axis meets the fewest edges of what people build.
    let way_out = DVec3::new(0.48, 0.64, 0.6);
    if !mesh.has_inside() || !mesh.bounds().contains(point) {
        return false;
    }
    if let (Enclosure::Mended, Some(field)) = (mesh.enclosure, &mesh.collider().field) {
        return field.distance_and_gradient(point).0 < 0.0;
    }
    let first = mesh.first_hits(point.as_dvec3(), way_out, |first| first.front.t.min(first.back.t));
    first.back.t < first.front.t
}

/// A triangle as a convex solid: a hull of three corners and no faces, of which GJK asks no more.
struct Triangle(Hull);

impl Default for Triangle {
    fn default() -> Self {
        Triangle(Hull {
            vertices: vec![Vec3::ZERO; 3],
            faces: Vec::new(),
            corners: Vec::new(),
            edges: Vec::new(),
            centre: Vec3::ZERO,
            inner_radius: 0.0,
        })
    }
}

impl Triangle {
    fn at(&mut self, corners: [Vec3; 3], ask: impl FnOnce(&Solid) -> bool) -> bool {
        self.0.vertices.copy_from_slice(&corners);
        self.0.centre = (corners[0] + corners[1] + corners[2]) / 3.0;
        ask(&Solid::of_hull(&self.0))
    }
}
