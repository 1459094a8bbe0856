//! Bounding volumes and their overlap tests (dissertation, section 2.3.1): spheres, axis-aligned and oriented boxes.
//!
//! Promise: volumes that share a point overlap; those that touch count as overlapping. Where a number is infinite or not a number, the
//! answer is yes: bounds may only rule out what cannot be.

mod aabb;
mod obb;
mod sphere;

pub use aabb::Aabb;
pub use obb::Obb;
pub use sphere::BoundingSphere;
