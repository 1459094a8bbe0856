//! Mass, centre of mass and inertia of shapes (dissertation, sections 2.2.4, 2.2.5 and 2.2.9).

use glam::{Quat, Vec3};

/// What a body's shape says about how it moves. The frame is the shape's own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassProperties {
    /// Mass. Kilograms; 0 for shapes without a volume (half-spaces).
    pub mass: f32,
    /// Centre of mass in the shape's frame. Metres.
    pub centre: Vec3,
    /// Moments of inertia about the centre of mass along the principal axes. kg m².
    pub principal_inertia: Vec3,
    /// Rotation from the principal axes to the shape's frame. Identity where the shape's axes are principal.
    pub principal_rotation: Quat,
}
