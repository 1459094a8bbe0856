//! Shapes and what is between two of them: mass properties, bounds, ray casts, signed distance fields, contact.
//!
//! *Architecture invariant:* this crate knows no body, no mass in motion, and no time. Every function is pure: the
//! same arguments give the same bits on every platform.
//!
//! Units are SI, angles radians, y points up, quaternions are x, y, z, w. Boxes are given by half extents.

pub mod bounds;
pub mod contact;
pub mod mass;
pub mod mesh_file;
pub mod pose;
pub mod ray;
pub mod sdf;
pub mod shape;

pub use bounds::{Aabb, BoundingSphere, Obb};
pub use contact::{ContactPoint, Manifold, Motion, Placed};
pub use glam::{Mat3, Quat, Vec3};
pub use mass::MassProperties;
pub use pose::Pose;
pub use ray::{Ray, RayHit};
pub use shape::Shape;
