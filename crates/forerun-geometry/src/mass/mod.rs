//! Mass, centre of mass and inertia of shapes (dissertation, sections 2.2.4, 2.2.5 and 2.2.9).

use glam::{DMat3, DQuat, DVec3, Quat, Vec3};

use crate::Shape;
use crate::shape::Enclosure;

mod principal;
mod solid;

use solid::Solid;

/// What a body's shape says about how it moves. The frame is the shape's own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassProperties {
    /// Mass. Kilograms; 0 for shapes without a volume (half-spaces, open meshes).
    pub mass: f32,
    /// Centre of mass in the shape's frame. Metres.
    pub centre: Vec3,
    /// Moments of inertia about the centre of mass along the principal axes. kg m².
    pub principal_inertia: Vec3,
    /// Rotation from the principal axes to the shape's frame. Identity where the shape's axes are principal, otherwise of the
    /// possible ones (axes may swap and turn round) the one closest to it.
    pub principal_rotation: Quat,
}

impl MassProperties {
    fn of(solid: &Solid, density: f32) -> MassProperties {
        let (moments, rotation) = principal::diagonalise(solid.inertia);
        let density = f64::from(density);
        MassProperties {
            mass: (solid.volume * density) as f32,
            centre: solid.centre.as_vec3(),
            principal_inertia: (moments * density).as_vec3(),
            principal_rotation: rotation.as_quat(),
        }
    }

    /// The inertia tensor about the centre of mass along the axes of the shape's frame, R I_b Rᵀ (dissertation, equation 2.23). kg m².
    #[must_use]
    pub fn inertia_tensor(&self) -> DMat3 {
        let rotation = DMat3::from_quat(DQuat::from_xyzw(
            self.principal_rotation.x.into(),
            self.principal_rotation.y.into(),
            self.principal_rotation.z.into(),
            self.principal_rotation.w.into(),
        ));
        rotation * DMat3::from_diagonal(self.principal_inertia.as_dvec3()) * rotation.transpose()
    }
}

impl Shape {
    /// Mass properties at a uniform density (kg/m³). Overlapping parts of a compound count each in full.
    #[must_use]
    pub fn mass_properties(&self, density: f32) -> MassProperties {
        MassProperties::of(&self.solid(), density)
    }

    fn solid(&self) -> Solid {
        match self {
            Shape::Sphere(s) => Solid::sphere(s.radius.into()),
            Shape::Cuboid(c) => Solid::cuboid(c.half_extents.as_dvec3()),
            Shape::Capsule(c) => Solid::capsule(c.half_height.into(), c.radius.into()),
            Shape::Cylinder(c) => Solid::cylinder(c.half_height.into(), c.radius.into()),
            Shape::Hull(hull) => Solid::within(hull.triangles().map(|t| t.map(|v| v.as_dvec3()))),
            Shape::Mesh(mesh) => match (mesh.enclosure, &mesh.collider().moments) {
                (Enclosure::Open, _) => Solid::NOTHING,
                (_, Some(m)) => Solid::of_moments(m.volume, m.first, m.second),
                (_, None) => {
                    Solid::within((0..mesh.triangles.len()).map(|t| mesh.corners(t).map(|v| v.as_dvec3())))
                }
            },
            Shape::HalfSpace => Solid::NOTHING,
            Shape::Compound(compound) => {
                let parts = compound.parts.iter().map(|(pose, shape)| shape.solid().at(pose));
                Solid::sum(&parts.collect::<Vec<Solid>>())
            }
        }
    }
}

/// r² 1 - r rᵀ: the inertia of a unit point mass at `r` (dissertation, equation 2.21).
fn point_inertia(r: DVec3) -> DMat3 {
    DMat3::from_diagonal(DVec3::splat(r.length_squared())) - outer(r, r)
}

/// a bᵀ
fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}
