//! Compound: every part against every part.

use super::reduce::Reducer;
use super::{ContactPoint, ContactScratch, Manifold, Placed, any_perpendicular};
use crate::{Shape, Vec3};

/// More manifolds than this between two shapes are merged where their normals agree.
const MANIFOLDS_KEPT: usize = 4;

/// Normals whose cosine is above this agree: about 8 degrees.
const AGREE: f32 = 0.99;

/// The manifolds of all parts, at least one of the two shapes being a compound.
pub(super) fn compound_any(
    first: &Placed,
    second: &Placed,
    margin: f32,
    scratch: &mut ContactScratch,
    out: &mut Vec<Manifold>,
) {
    let before = out.len();
    parts_of(first, second, margin, scratch, out);
    if out.len() - before > MANIFOLDS_KEPT {
        merge_agreeing(out, before);
    }
}

fn parts_of(
    first: &Placed,
    second: &Placed,
    margin: f32,
    scratch: &mut ContactScratch,
    out: &mut Vec<Manifold>,
) {
    if let Shape::Compound(compound) = first.shape {
        for (pose, shape) in &compound.parts {
            parts_of(&Placed { shape, pose: first.pose * *pose, ..*first }, second, margin, scratch, out);
        }
    } else if let Shape::Compound(compound) = second.shape {
        for (pose, shape) in &compound.parts {
            parts_of(first, &Placed { shape, pose: second.pose * *pose, ..*second }, margin, scratch, out);
        }
    } else if may_touch(first, second, margin) {
        scratch.contact_manifolds(first, second, margin, out);
    }
}

/// Whether the balls around two parts come within the margin. The balls of half-spaces are endless.
fn may_touch(first: &Placed, second: &Placed, margin: f32) -> bool {
    let ((at, radius), (other_at, other_radius)) = (ball(first), ball(second));
    let reach = radius + other_radius + margin;
    at.distance_squared(other_at) <= reach * reach
}

/// A ball around a part: its middle in the world, and its radius. Metres.
fn ball(part: &Placed) -> (Vec3, f32) {
    match part.shape {
        Shape::Mesh(mesh) => (part.pose.transform_point(mesh.ball().centre), mesh.ball().radius),
        shape => (part.pose.position, shape.radius_about(Vec3::ZERO)),
    }
}

/// Merges the manifolds from `start` on: each joins the first before it with which its normal agrees.
fn merge_agreeing(out: &mut Vec<Manifold>, start: usize) {
    let all = out.split_off(start);
    let mut groups: Vec<Vec<Manifold>> = Vec::new();
    for manifold in all {
        match groups.iter_mut().find(|group| group[0].normal.dot(manifold.normal) > AGREE) {
            Some(group) => group.push(manifold),
            None => groups.push(vec![manifold]),
        }
    }
    out.extend(groups.iter().filter_map(|group| merged(group)));
}

fn merged(group: &[Manifold]) -> Option<Manifold> {
    if let [only] = group {
        return Some(*only);
    }
    let lead: &ContactPoint = group.first()?.points().first()?;
    let u = any_perpendicular(lead.normal);
    let mut reducer = Reducer::new(lead.position, u, lead.normal.cross(u));
    for point in group.iter().flat_map(Manifold::points) {
        reducer.offer(*point);
    }
    reducer.finish()
}
