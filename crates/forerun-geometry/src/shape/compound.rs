//! Compound: several convex shapes held rigidly together.

use crate::{Pose, Shape};

/// Several convex shapes, each at a pose of its own. Parts may overlap; mass counts every part in full.
#[derive(Clone, Debug, PartialEq)]
pub struct Compound {
    /// The parts: pose in the compound's frame, and shape (no half-space, mesh or compound).
    pub parts: Vec<(Pose, Shape)>,
}
