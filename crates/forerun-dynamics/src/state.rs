//! State: what changes from frame to frame, and all that the next step reads of a body besides its [`Body`](crate::Body).

use forerun_geometry::{Pose, Quat, Vec3};

/// One body at one frame: 56 bytes.
///
/// *Invariant:* stored states are finite, and no component is -0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct BodyState {
    /// Centre of mass. Metres.
    pub position: Vec3,
    /// Rotation from the principal axes of inertia to the world. Unit quaternion (x, y, z, w).
    pub rotation: Quat,
    /// Velocity of the centre of mass. m/s.
    pub velocity: Vec3,
    /// Angular velocity in the world. rad/s.
    pub angular_velocity: Vec3,
    /// For how many frames the body has been quiet; see [`StepSettings::rest_frames`](crate::StepSettings::rest_frames).
    pub rest: u32,
}

impl BodyState {
    /// Where the principal frame is.
    #[must_use]
    pub fn pose(&self) -> Pose {
        Pose { position: self.position, rotation: self.rotation }
    }

    /// Velocity of the body's material at a world point. m/s.
    #[must_use]
    pub fn velocity_at(&self, point: Vec3) -> Vec3 {
        self.velocity + self.angular_velocity.cross(point - self.position)
    }

    /// Whether every component is a finite number.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.position.is_finite()
            && self.rotation.is_finite()
            && self.velocity.is_finite()
            && self.angular_velocity.is_finite()
    }

    /// The same state with -0 made +0, so that equal states have equal bits.
    #[must_use]
    pub fn canonical(mut self) -> BodyState {
        // -0 + 0 is +0 in the default rounding mode; every other number stays.
        self.position += Vec3::ZERO;
        self.velocity += Vec3::ZERO;
        self.angular_velocity += Vec3::ZERO;
        let q = self.rotation;
        self.rotation = Quat::from_xyzw(q.x + 0.0, q.y + 0.0, q.z + 0.0, q.w + 0.0);
        self
    }

    /// The bits of the state, for exact comparison and hashing.
    #[must_use]
    pub fn bits(&self) -> [u32; 14] {
        let (p, q, v, w) = (self.position, self.rotation, self.velocity, self.angular_velocity);
        let f = [p.x, p.y, p.z, q.x, q.y, q.z, q.w, v.x, v.y, v.z, w.x, w.y, w.z];
        let mut bits = [0; 14];
        for (bit, value) in bits.iter_mut().zip(f) {
            *bit = value.to_bits();
        }
        bits[13] = self.rest;
        bits
    }

    /// Whether the two states are the same, bit for bit.
    #[must_use]
    pub fn same_bits(&self, other: &BodyState) -> bool {
        self.bits() == other.bits()
    }
}
