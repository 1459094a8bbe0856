//! Stale: what of the step from a frame to the next is out of date, and what it was computed from.
//!
//! *Invariant.* Let `S(k)` be the table stored at frame `k`, and for each frame `k` below the horizon let `O(k)` be its *old inputs*:
//! `S(k)`, the bodies and gravity at `k`, except where `Stale` of `k` says otherwise (`basis` in place of `S(k)`, `bodies` in place
//! of those bodies). Then every entry of `S(k+1)`, but for the bodies in `touched` (or all of them when `everyone` or `all_touched` is set), is what a
//! full step from `O(k)` followed by the commands of `k+1` gives.
//!
//! Where there is no `Stale`, `O(k)` is what is stored, so if there is none before frame `n`, all frames up to `n` equal a full
//! simulation (by induction from the oldest frame): that is [`Timeline::valid_to`](crate::Timeline::valid_to).
//!
//! The invariant holds per frame and says nothing about how `S(k)` came to differ from `O(k)`. So commands may arrive at any moment,
//! also before an older batch is worked off:
//! - a command changes what is at frame `k`, or the commands of `k+1`: it is noted in `Stale` of `k`, where the first note wins, as
//!   what is noted is what `S(k+1)` was computed from;
//! - computing `k -> k+1` replaces entries of `S(k+1)` until it is what `S(k)` gives, and drops `Stale` of `k`. The table that was
//!   there before becomes the basis of `k+1`, unless that has an older one, which is what `S(k+2)` was computed from.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use forerun_dynamics::{Body, BodyId};
use forerun_geometry::Shape;

use crate::frame_table::FrameTable;

/// What of the step from frame `k` to `k+1` is out of date. Empty when nothing is.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stale {
    /// The states at `k` that `S(k+1)` was computed from, where not those stored.
    pub(crate) basis: Option<Arc<FrameTable>>,
    /// The bodies that `S(k+1)` was computed from, where they may have changed since.
    pub(crate) bodies: BTreeMap<BodyId, Option<Arc<Body>>>,
    /// Bodies whose entry in `S(k+1)` is wrong whatever it was computed from: their commands at `k+1` changed.
    pub(crate) touched: BTreeSet<BodyId>,
    /// All entries of `S(k+1)` may be wrong, as by `touched`: a command to all of them changed. Where the step leads is known.
    pub(crate) all_touched: bool,
    /// All entries of `S(k+1)` may be wrong, wherever the step leads.
    pub(crate) everyone: bool,
}

impl Stale {
    /// The table that the next frame was computed from; `stored` is the one stored at this frame.
    pub(crate) fn old_table<'a>(&'a self, stored: &'a Arc<FrameTable>) -> &'a Arc<FrameTable> {
        self.basis.as_ref().unwrap_or(stored)
    }

    /// The bodies that have to be advanced because they, or the commands to them, are not what the next frame was computed from.
    /// Sorted. `body_now` says what a body is at this frame now.
    pub(crate) fn out_of_date<'a>(
        &self,
        stored: &Arc<FrameTable>,
        body_now: impl Fn(BodyId) -> Option<&'a Arc<Body>>,
    ) -> Vec<BodyId> {
        let mut bodies = self.differing(stored, body_now);
        if self.everyone || self.all_touched {
            bodies.extend(stored.iter().map(|(body, _)| body));
        }
        bodies.extend(&self.touched);
        bodies.sort_unstable();
        bodies.dedup();
        bodies
    }

    /// Those among them that are not, or are not how, they were when the next frame was computed. In no order.
    pub(crate) fn differing<'a>(
        &self,
        stored: &Arc<FrameTable>,
        body_now: impl Fn(BodyId) -> Option<&'a Arc<Body>>,
    ) -> Vec<BodyId> {
        let mut bodies = self.basis.as_ref().map_or_else(Vec::new, |old| stored.differences(old));
        let redefined = self.bodies.iter().filter(|(body, old)| !same_body(body_now(**body), old.as_ref()));
        bodies.extend(redefined.map(|(body, _)| *body));
        bodies
    }
}

/// Whether a body is the same before and after. A name may stand for another shape when the command that adds it was replaced.
pub(crate) fn same_body(a: Option<&Arc<Body>>, b: Option<&Arc<Body>>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => Arc::ptr_eq(a, b) || same_numbers(a, b) && same_shape(&a.shape, &b.shape),
        (None, None) => true,
        _ => false,
    }
}

fn same_numbers(a: &Body, b: &Body) -> bool {
    let Body {
        shape: _,
        frame,
        kind,
        material,
        inverse_mass,
        inverse_inertia,
        gravity_scale,
        force,
        torque,
        spring,
        radius,
        half_thickness,
    } = a;
    let commanded = (kind, material, gravity_scale, force, torque, spring);
    let made = (frame, inverse_mass, inverse_inertia, radius, half_thickness);
    commanded == (&b.kind, &b.material, &b.gravity_scale, &b.force, &b.torque, &b.spring)
        && made == (&b.frame, &b.inverse_mass, &b.inverse_inertia, &b.radius, &b.half_thickness)
}

/// Large shapes by where they are in memory: what commands change keeps that, and comparing meshes would take long.
fn same_shape(a: &Shape, b: &Shape) -> bool {
    match (a, b) {
        (Shape::Hull(a), Shape::Hull(b)) => Arc::ptr_eq(a, b),
        (Shape::Compound(a), Shape::Compound(b)) => Arc::ptr_eq(a, b),
        (Shape::Mesh(a), Shape::Mesh(b)) => Arc::ptr_eq(a, b),
        _ => a == b,
    }
}
