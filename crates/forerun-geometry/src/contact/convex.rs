//! Convex: any two of capsule, cuboid, cylinder and hull.
//!
//! 1. The best flat face of either (polyhedra before cylinders): exact where the other lies over that face.
//! 2. Cylinders: the axis between two sides, exact where they touch there.
//! 3. Otherwise the general axis: GJK where they are apart, the expanding polytope where they overlap.
//!
//! A face is preferred to the general axis by up to [`FACE_MARGIN`]: its four points are worth more than the last
//! millimetres of the true distance, and the answer must not flip. What is left of it after clipping must still be as
//! deep as the general axis says, within the same margin: a corner that hangs over the face's edge touches elsewhere.

use glam::DVec3;

use super::capsule::{Rod, parallel_ends};
use super::clip::face_manifold;
use super::gjk::{self, Distance, Witness};
use super::reduce::TIE;
use super::solid::Solid;
use super::{ContactPoint, Manifold, Placed, any_perpendicular, penetration, unit_or};
use crate::{Pose, Shape, Vec3};

/// By how much the general axis must beat the best face, for large shapes. Metres.
const FACE_MARGIN: f32 = 4.0e-3;

/// By how much the second shape's best face must beat the first's, for large shapes. Metres.
const SECOND_FACE_MARGIN: f32 = 1.0e-3;

/// Small shapes: neither margin is more than this part of the smaller one's half thickness.
const MARGIN_PART: f32 = 0.05;

/// A face's manifold is exact if its deepest point is as deep as its axis says, within this. Metres.
const EXACT: f32 = 1.0e-4;

/// The axis between two sides has this sine with the plane across a cylinder, at most.
const ACROSS: f32 = 1.0e-3;

/// Edges that enclose an angle with a smaller sine run alongside each other and touch in two points. About 1 degree: beside
/// each other they are only where they cross, and both points are given the normal of that place.
const ALONGSIDE: f32 = 0.02;

/// Cuboids that move by less than this together are left to the next frame. Metres.
const UNHURRIED: f32 = 5.0e-3;

/// A face, the solid that it belongs to, and how far the other is above it.
#[derive(Clone, Copy)]
struct BestFace {
    of_second: bool,
    face: usize,
    separation: f32,
}

/// The manifold of two shapes out of capsule, cuboid, cylinder and hull.
pub(super) fn convex_convex(
    first: (&Shape, &Pose),
    second: (&Shape, &Pose),
    margin: f32,
) -> Option<Manifold> {
    let origin = first.1.position;
    let a = Solid::new(first.0, first.1, origin)?;
    let b = Solid::new(second.0, second.1, origin)?;
    let manifold = if a.rank() <= b.rank() {
        solid_solid(&a, &b, margin)
    } else {
        solid_solid(&b, &a, margin).map(Manifold::flipped)
    };
    manifold.map(|manifold| manifold.moved(origin))
}

/// Two cuboids that no face of theirs brings together: the nearest corner or edge, if they are about to meet there.
pub(super) fn corner_about_to_hit(first: &Placed, second: &Placed, margin: f32) -> Option<Manifold> {
    let cuboids = matches!((first.shape, second.shape), (Shape::Cuboid(_), Shape::Cuboid(_)));
    if !cuboids || first.reach() + second.reach() < UNHURRIED {
        return None;
    }
    let origin = first.pose.position;
    let a = Solid::new(first.shape, &first.pose, origin)?;
    let b = Solid::new(second.shape, &second.pose, origin)?;
    let Distance::Apart(witness) = gjk::distance(&a, &b, margin) else { return None };
    let axis = Axis::from_witness(&a, &b, &witness);
    let manifold = axis.manifold(&a, &b, margin)?.moved(origin);
    let point = manifold.points[0];
    let closing = first.motion.of(point.position) - second.motion.of(point.position);
    (closing.dot(point.normal) > point.separation).then_some(manifold)
}

impl Placed<'_> {
    /// Further than this none of its points moves. Metres.
    fn reach(&self) -> f32 {
        let arm = (self.motion.about - self.pose.position).length() + self.shape.radius_about(Vec3::ZERO);
        self.motion.linear.length() + self.motion.angular.length() * arm
    }
}

fn solid_solid(a: &Solid, b: &Solid, margin: f32) -> Option<Manifold> {
    // Most neighbours that are apart are so along the line of their middles.
    let between = unit_or(b.middle() - a.middle(), Vec3::Y);
    if -b.reach(-between) - a.reach(between) - a.radius - b.radius >= margin {
        return None;
    }
    let small = MARGIN_PART * a.size.min(b.size);
    let face_margin = FACE_MARGIN.min(small);
    let face = best_face(a, b, SECOND_FACE_MARGIN.min(small));
    let mut on_face = None;
    if let Some(face) = face {
        if face.separation >= margin {
            return None;
        }
        on_face = on_best_face(a, b, face, margin);
        let exact = |manifold: &Manifold| manifold.deepest() <= face.separation + EXACT;
        if face.separation > -face_margin && on_face.as_ref().is_some_and(exact) {
            return on_face;
        }
    }
    let side = side_axis(a, b, margin);
    if let Some(side) = &side {
        if side.separation >= margin {
            return None;
        }
        let no_face = face.is_none_or(|face| face.separation < side.separation);
        if side.exact && side.separation > -face_margin && no_face {
            return side.manifold(a, b, margin);
        }
    }
    let general = general_axis(a, b, margin)?;
    if general.separation >= margin {
        return None;
    }
    if let (Some(face), Some(manifold)) = (face, on_face)
        && face.separation >= general.separation - face_margin
        && manifold.deepest() <= general.separation + face_margin
    {
        return Some(manifold);
    }
    match side {
        Some(side) if side.separation >= general.separation - TIE => side.manifold(a, b, margin),
        _ => general.manifold(a, b, margin),
    }
}

/// The face along whose normal the two are farthest apart; the first solid's within `preference`.
///
/// Most faces look away. How high a ball inside the other is above a face says how high the other itself can be at most: a face for which that is
/// less than another face is known to have cannot be the best, and nobody looks for the other's lowest point over it.
fn best_face(a: &Solid, b: &Solid, preference: f32) -> Option<BestFace> {
    let sides = [(false, a, b), (true, b, a)];
    let mut known = f32::NEG_INFINITY;
    for (_, own, other) in sides {
        let mut highest: Option<(usize, f32)> = None;
        for (face, height) in own.heights_of(other.middle()).enumerate() {
            if highest.is_none_or(|(_, best)| height > best) {
                highest = Some((face, height));
            }
        }
        known = highest.map_or(known, |(face, _)| known.max(height_over(own, face, other)));
    }
    let hopeless = known - preference - 4.0 * TIE;
    let mut best: Option<BestFace> = None;
    for (of_second, own, other) in sides {
        let inside = other.inner_radius();
        for (face, middle) in own.heights_of(other.middle()).enumerate() {
            if middle - inside < hopeless {
                continue;
            }
            let separation = height_over(own, face, other);
            let beats = |best: BestFace| {
                separation > best.separation + if of_second == best.of_second { TIE } else { preference }
            };
            if best.is_none_or(beats) {
                best = Some(BestFace { of_second, face, separation });
            }
        }
    }
    best
}

/// How high the lowest point of `other` is above a face. Metres.
fn height_over(own: &Solid, face: usize, other: &Solid) -> f32 {
    let (normal, offset) = own.plane(face);
    -other.reach(-normal) - offset - other.radius
}

fn on_best_face(a: &Solid, b: &Solid, best: BestFace, margin: f32) -> Option<Manifold> {
    let (own, other) = if best.of_second { (b, a) } else { (a, b) };
    let face = own.face(best.face);
    let lowest = other.lowest(-face.normal, face.u);
    let manifold = face_manifold(&face, &lowest, other.radius, margin);
    if best.of_second { manifold.map(Manifold::flipped) } else { manifold }
}

/// An axis that is no face's normal, and the nearest points along it.
struct Axis {
    normal: Vec3,
    /// Along the normal, radii included. Metres.
    separation: f32,
    /// On the cores.
    on_a: Vec3,
    on_b: Vec3,
    /// No other axis can be better.
    exact: bool,
}

impl Axis {
    fn from_witness(a: &Solid, b: &Solid, witness: &Witness) -> Axis {
        Axis {
            normal: unit_or(witness.normal.as_vec3(), Vec3::Y),
            separation: witness.separation as f32 - a.radius - b.radius,
            on_a: witness.on_a.as_vec3(),
            on_b: witness.on_b.as_vec3(),
            exact: true,
        }
    }

    /// Two points where edges run alongside each other, else one.
    fn manifold(&self, a: &Solid, b: &Solid, margin: f32) -> Option<Manifold> {
        let normal = self.normal;
        let at = |on_a: Vec3, on_b: Vec3, separation: f32| ContactPoint {
            position: (on_a + on_b + normal * (a.radius - b.radius)) * 0.5,
            normal,
            separation,
        };
        if let (Some(edge_a), Some(edge_b)) = (a.edge(normal), b.edge(-normal)) {
            let (rod_a, rod_b) =
                (Rod { ends: edge_a, radius: a.radius }, Rod { ends: edge_b, radius: b.radius });
            if let Some(ends) = parallel_ends(&rod_a, &rod_b, ALONGSIDE) {
                let ends =
                    ends.map(|(on_a, on_b)| at(on_a, on_b, (on_b - on_a).dot(normal) - a.radius - b.radius));
                let near = |point: &ContactPoint| point.separation < margin;
                let all = ends.iter().copied().filter(near).collect::<Vec<_>>();
                return Manifold::from_points(&all);
            }
        }
        if self.separation >= margin {
            return None;
        }
        Manifold::from_points(&[at(self.on_a, self.on_b, self.separation)])
    }
}

/// The axis between the side of a cylinder and whatever is nearest to it; none if there is no cylinder, if its cap or rim is
/// nearer, or if an axis reaches into the other shape.
fn side_axis(a: &Solid, b: &Solid, margin: f32) -> Option<Axis> {
    let cylinders = [a.cylinder_axis(), b.cylinder_axis()];
    if cylinders == [None, None] {
        return None;
    }
    let (rod_a, rod_b) = (a.as_rod(), b.as_rod());
    let enough = margin + rod_a.radius + rod_b.radius;
    let Distance::Apart(witness) = gjk::distance(&rod_a, &rod_b, enough) else { return None };
    let mut normal = unit_or(witness.normal.as_vec3(), Vec3::Y);
    for axis in cylinders.into_iter().flatten() {
        let along = normal.dot(axis);
        if along.abs() > ACROSS {
            return None;
        }
        normal = unit_or(normal - axis * along, normal);
    }
    let true_separation = separation_along(a, b, normal);
    let rods_apart = witness.separation as f32 - rod_a.radius - rod_b.radius;
    // From the rods' cores to the surfaces of cylinders; a capsule's own radius stays with the solid.
    let on_a = witness.on_a.as_vec3() + normal * (rod_a.radius - a.radius);
    let on_b = witness.on_b.as_vec3() - normal * (rod_b.radius - b.radius);
    let exact = (true_separation - rods_apart).abs() < EXACT;
    Some(Axis { normal, separation: true_separation, on_a, on_b, exact })
}

fn separation_along(a: &Solid, b: &Solid, normal: Vec3) -> f32 {
    let direction = normal.as_dvec3();
    let gap = (b.support(-direction) - a.support(direction)).dot(direction);
    gap as f32 - a.radius - b.radius
}

/// The axis of the true distance, or of the shortest way out of an overlap.
fn general_axis(a: &Solid, b: &Solid, margin: f32) -> Option<Axis> {
    match gjk::distance(a, b, margin + a.radius + b.radius) {
        Distance::Apart(witness) => Some(Axis::from_witness(a, b, &witness)),
        Distance::Overlap(simplex) => {
            let witness = penetration::penetration(a, b, &simplex);
            Some(witness.map_or_else(|| flat_axis(a, b), |witness| Axis::from_witness(a, b, &witness)))
        }
    }
}

/// Both cores have shrunk to segments or points that meet: any way out is as good, the way between the middles best.
fn flat_axis(a: &Solid, b: &Solid) -> Axis {
    let arm = b.middle() - a.middle();
    let normal = unit_or(arm, any_perpendicular(Vec3::Y));
    let direction: DVec3 = normal.as_dvec3();
    let (on_a, on_b) = (a.support(direction).as_vec3(), b.support(-direction).as_vec3());
    Axis { normal, separation: separation_along(a, b, normal), on_a, on_b, exact: false }
}
