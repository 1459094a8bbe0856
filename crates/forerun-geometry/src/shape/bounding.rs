//! Bounding spheres and oriented boxes of shapes (dissertation, section 2.3.1).

use glam::Mat3;

use super::{Mesh, Shape};
use crate::{Aabb, BoundingSphere, Obb, Pose, Quat, Vec3};

impl Shape {
    /// A sphere around the shape in its own frame: the smallest for simple shapes, a few percent larger at most for hulls and meshes.
    /// Infinite for half-spaces.
    #[must_use]
    pub fn bounding_sphere(&self) -> BoundingSphere {
        let centred = |radius: f32| BoundingSphere { centre: Vec3::ZERO, radius };
        match self {
            Shape::Hull(hull) => BoundingSphere::around(&hull.vertices),
            Shape::Mesh(mesh) => BoundingSphere::around(&mesh.vertices),
            Shape::Compound(_) => {
                let centre = self.aabb(&Pose::IDENTITY).centre();
                BoundingSphere { centre, radius: self.radius_about(centre) }
            }
            _ => centred(self.radius_about(Vec3::ZERO)),
        }
    }

    /// An oriented box around the shape at `pose`: the box in the shape's own frame ([`Shape::own_obb`]), moved along.
    #[must_use]
    pub fn obb(&self, pose: &Pose) -> Obb {
        self.own_obb().at(pose)
    }

    /// An oriented box around the shape in its own frame: along its axes or along the principal axes of its mass, whichever is smaller.
    /// Infinite for half-spaces. To be kept where it is needed often: it looks at every vertex.
    #[must_use]
    pub fn own_obb(&self) -> Obb {
        let along_axes = self.box_along(Quat::IDENTITY);
        match self {
            Shape::Hull(_) | Shape::Compound(_) | Shape::Mesh(_) => {
                let along_mass = self.box_along(self.mass_properties(1.0).principal_rotation);
                if along_mass.volume() < along_axes.volume() { along_mass } else { along_axes }
            }
            Shape::HalfSpace => {
                Obb { centre: Vec3::ZERO, axes: Mat3::IDENTITY, half_extents: Vec3::INFINITY }
            }
            _ => along_axes,
        }
    }

    /// The smallest box whose axes are turned by `rotation`.
    fn box_along(&self, rotation: Quat) -> Obb {
        let to_box = Pose::new(Vec3::ZERO, rotation.conjugate());
        let bounds = match self {
            Shape::Mesh(mesh) => vertex_bounds(mesh, &to_box),
            _ => self.aabb(&to_box),
        };
        Obb::from(bounds).at(&to_box.inverse())
    }
}

fn vertex_bounds(mesh: &Mesh, pose: &Pose) -> Aabb {
    Aabb::around(mesh.vertices.iter().map(|v| pose.transform_point(*v)))
}
