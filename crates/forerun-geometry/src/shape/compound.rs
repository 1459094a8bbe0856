//! Compound: several convex shapes held rigidly together.

use super::ShapeError;
use crate::{Pose, Shape};

/// Several convex shapes, each at a pose of its own. Parts may overlap; mass counts every part in full.
#[derive(Clone, Debug, PartialEq)]
pub struct Compound {
    /// The parts: pose in the compound's frame, and shape (no half-space, mesh or compound).
    pub parts: Vec<(Pose, Shape)>,
}

impl Compound {
    /// A compound of the given parts. Rotations are normalised.
    ///
    /// # Errors
    /// When there is no part, when a part is a half-space, a mesh or a compound, or when a pose is not finite or its
    /// rotation not a unit quaternion.
    pub fn new(mut parts: Vec<(Pose, Shape)>) -> Result<Compound, ShapeError> {
        if parts.is_empty() {
            return Err(ShapeError::new("parts", "a compound needs at least one part"));
        }
        for (i, (pose, shape)) in parts.iter_mut().enumerate() {
            let remedy = match shape {
                Shape::HalfSpace => Some("a half-space; make it a body of its own"),
                Shape::Mesh(_) => Some("a mesh; put all triangles into one mesh, or use hulls"),
                Shape::Compound(_) => Some("a compound; list its parts here instead"),
                _ => None,
            };
            if let Some(remedy) = remedy {
                return Err(ShapeError::new("parts", format!("part {i} is {remedy}")));
            }
            let q = pose.rotation;
            if !(q.is_finite() && (q.length_squared() - 1.0).abs() < 1e-3) {
                return Err(ShapeError::new(
                    "parts",
                    format!("part {i}: its rotation must be a unit quaternion (x, y, z, w), is {q}"),
                ));
            }
            if !pose.position.is_finite() {
                return Err(ShapeError::new(
                    "parts",
                    format!("part {i}: its position must be finite numbers, is {}", pose.position),
                ));
            }
            pose.rotation = q.normalize();
        }
        Ok(Compound { parts })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Quat, Vec3};

    #[test]
    fn names_the_part_at_fault() {
        let ball = || (Pose::IDENTITY, Shape::sphere(1.0).unwrap());
        assert!(Compound::new(vec![ball(), ball()]).is_ok());
        assert!(Compound::new(vec![]).unwrap_err().message.contains("at least one"));
        let ground = Compound::new(vec![ball(), (Pose::IDENTITY, Shape::HalfSpace)]).unwrap_err();
        assert!(ground.message.contains("part 1 is a half-space"), "{ground}");
        let inner = Shape::compound(vec![ball()]).unwrap();
        assert!(Compound::new(vec![(Pose::IDENTITY, inner)]).is_err());
        let skewed = Pose::new(Vec3::ZERO, Quat::from_xyzw(1.0, 1.0, 0.0, 0.0));
        assert!(Compound::new(vec![(skewed, Shape::sphere(1.0).unwrap())]).is_err());
    }
}
