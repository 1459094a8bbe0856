//! How large a shape is: bounds, reach and thickness.

use super::{Capsule, Cylinder, Shape};
use crate::{Aabb, Pose, Vec3};

impl Shape {
    /// An axis-aligned box around the shape at `pose`: the smallest one, but for turned meshes (a little larger) and half-spaces
    /// (infinite, but for the side they face along an axis).
    #[must_use]
    pub fn aabb(&self, pose: &Pose) -> Aabb {
        match self {
            Shape::Sphere(s) => Aabb::from_centre(pose.position, Vec3::splat(s.radius)),
            Shape::Cuboid(c) => Aabb::from_centre(pose.position, turned_extents(pose, c.half_extents)),
            Shape::Capsule(c) => {
                let reach = pose.axes().y_axis.abs() * c.half_height + Vec3::splat(c.radius);
                Aabb::from_centre(pose.position, reach)
            }
            Shape::Cylinder(c) => {
                let axis = pose.axes().y_axis;
                // The rim's reach along a unit vector u is r sqrt(1 - (u . axis)²).
                let rim = (Vec3::ONE - axis * axis).max(Vec3::ZERO);
                let rim = Vec3::new(rim.x.sqrt(), rim.y.sqrt(), rim.z.sqrt());
                Aabb::from_centre(pose.position, axis.abs() * c.half_height + rim * c.radius)
            }
            Shape::Hull(hull) => Aabb::around(hull.vertices.iter().map(|v| pose.transform_point(*v))),
            Shape::HalfSpace => half_space_aabb(pose),
            Shape::Compound(compound) => {
                let parts = compound.parts.iter().map(|(part, shape)| shape.aabb(&(*pose * *part)));
                parts.reduce(|a, b| a.union(&b)).unwrap_or(Aabb::from_centre(pose.position, Vec3::ZERO))
            }
            Shape::Mesh(mesh) => mesh.aabb(pose),
        }
    }

    /// Distance from `centre` to the farthest point of the shape. Metres; infinite for half-spaces.
    #[must_use]
    pub fn radius_about(&self, centre: Vec3) -> f32 {
        let farthest = |points: &[Vec3]| points.iter().map(|p| p.distance(centre)).fold(0.0, f32::max);
        match self {
            Shape::Sphere(s) => centre.length() + s.radius,
            Shape::Cuboid(c) => (centre.abs() + c.half_extents).length(),
            Shape::Capsule(Capsule { half_height, radius }) => {
                let to_end = Vec3::new(centre.x, centre.y.abs() + half_height, centre.z);
                to_end.length() + radius
            }
            Shape::Cylinder(Cylinder { half_height, radius }) => {
                let across = (centre.x * centre.x + centre.z * centre.z).sqrt() + radius;
                let along = centre.y.abs() + half_height;
                (across * across + along * along).sqrt()
            }
            Shape::Hull(hull) => farthest(&hull.vertices),
            Shape::HalfSpace => f32::INFINITY,
            Shape::Compound(compound) => {
                let reach =
                    |(part, shape): &(Pose, Shape)| shape.radius_about(part.inverse_transform_point(centre));
                compound.parts.iter().map(reach).fold(0.0, f32::max)
            }
            Shape::Mesh(mesh) => farthest(&mesh.vertices),
        }
    }

    /// Half of the smallest thickness: what moves further than this in one step may pass through. Metres; infinite for half-spaces.
    ///
    /// Of a hull half the smallest width along a face normal, of a compound the smallest of its parts. Of a mesh see
    /// [`Mesh::half_thickness`](super::Mesh::half_thickness).
    #[must_use]
    pub fn half_thickness(&self) -> f32 {
        match self {
            Shape::Sphere(s) => s.radius,
            Shape::Cuboid(c) => c.half_extents.min_element(),
            Shape::Capsule(c) => c.radius,
            Shape::Cylinder(c) => c.half_height.min(c.radius),
            Shape::Hull(hull) => 0.5 * hull.thinnest_width(),
            Shape::HalfSpace => f32::INFINITY,
            Shape::Compound(compound) => {
                compound.parts.iter().map(|(_, shape)| shape.half_thickness()).fold(f32::INFINITY, f32::min)
            }
            Shape::Mesh(mesh) => mesh.half_thickness(),
        }
    }
}

/// Half extents of the smallest axis-aligned box around a turned one.
fn turned_extents(pose: &Pose, half_extents: Vec3) -> Vec3 {
    let m = pose.axes();
    m.x_axis.abs() * half_extents.x + m.y_axis.abs() * half_extents.y + m.z_axis.abs() * half_extents.z
}

/// A half-space is bounded on one side only, and only when that side faces along an axis.
fn half_space_aabb(pose: &Pose) -> Aabb {
    let mut bounds = Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY };
    let normal = pose.axes().y_axis;
    for axis in 0..3 {
        let others = [normal[(axis + 1) % 3], normal[(axis + 2) % 3]];
        if others.iter().any(|component| *component != 0.0) {
            continue;
        }
        if normal[axis] > 0.0 {
            bounds.max[axis] = pose.position[axis];
        } else {
            bounds.min[axis] = pose.position[axis];
        }
    }
    bounds
}
