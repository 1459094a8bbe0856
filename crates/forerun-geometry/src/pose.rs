//! Pose: where a rigid thing is and how it is turned.

use glam::{Mat3, Quat, Vec3};

/// A rigid transform: rotate, then translate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Position of the local origin in the outer frame. Metres.
    pub position: Vec3,
    /// Rotation from the local to the outer frame. A unit quaternion (x, y, z, w).
    pub rotation: Quat,
}

impl Pose {
    /// The pose that changes nothing.
    pub const IDENTITY: Pose = Pose { position: Vec3::ZERO, rotation: Quat::IDENTITY };

    /// A pose from a position (metres) and a unit quaternion.
    #[must_use]
    pub const fn new(position: Vec3, rotation: Quat) -> Self {
        Pose { position, rotation }
    }

    /// A pose that only moves.
    #[must_use]
    pub const fn from_position(position: Vec3) -> Self {
        Pose { position, rotation: Quat::IDENTITY }
    }

    /// A local point, seen from the outer frame.
    #[must_use]
    pub fn transform_point(&self, point: Vec3) -> Vec3 {
        self.rotation * point + self.position
    }

    /// A point of the outer frame, seen from the local one.
    #[must_use]
    pub fn inverse_transform_point(&self, point: Vec3) -> Vec3 {
        self.rotation.conjugate() * (point - self.position)
    }

    /// A vector of the outer frame, seen from the local one.
    #[must_use]
    pub fn inverse_transform_vector(&self, vector: Vec3) -> Vec3 {
        self.rotation.conjugate() * vector
    }

    /// The pose that undoes this one.
    #[must_use]
    pub fn inverse(&self) -> Pose {
        let rotation = self.rotation.conjugate();
        Pose { position: rotation * -self.position, rotation }
    }

    /// The rotation as a matrix; its columns are the local axes seen from the outer frame.
    #[must_use]
    pub fn axes(&self) -> Mat3 {
        Mat3::from_quat(self.rotation)
    }
}

impl std::ops::Mul for Pose {
    type Output = Pose;

    /// `outer * inner`: first `inner`, then `outer`.
    fn mul(self, inner: Pose) -> Pose {
        Pose { position: self.transform_point(inner.position), rotation: self.rotation * inner.rotation }
    }
}
