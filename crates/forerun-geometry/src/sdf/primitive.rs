//! Primitive: signed distances to simple shapes, with the interface of a field.
//!
//! Promise: exact for spheres, boxes, capsules, cylinders and half-spaces; for hulls exact near faces and edges, and
//! never more than the true distance.

use forerun_lanes::{LANES, LaneMask, Lanes, Portable, V8};

use super::Field;
use super::eight::{lane, of_vectors, splat};
use super::nearest::{Nearest, Skin};
use crate::Vec3;
use crate::shape::{Capsule, Cuboid, Cylinder, Hull};

/// Something that points can be looked up in: signed distance and gradient, in a frame of its own.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Surface<'a> {
    HalfSpace,
    /// By radius.
    Sphere(f32),
    Cuboid(Cuboid),
    Capsule(Capsule),
    Cylinder(Cylinder),
    /// By planes: unit normal and offset.
    Hull(&'a [(Vec3, f32)]),
    /// A closed mesh.
    Field(&'a Field),
    /// An open mesh: its front is outside. Points deeper behind it than a limit (metres) are not inside of anything.
    Sheet(Skin<'a>, f32),
}

/// What eight points can be looked up in at a time.
pub(crate) trait LookUp {
    /// Signed distances (metres) and gradients. Gradients are not quite unit.
    ///
    /// Beyond a grid's box this is the distance to a point of the surface, that nearest to the nearest point of the box:
    /// the true distance or more.
    fn look_up<F: Lanes>(&self, points: V8<F>) -> (F, V8<F>);

    /// [`LookUp::look_up`] where only some of eight points are `asked` for; the answers for the others say nothing.
    #[inline(always)]
    fn look_up_some<F: Lanes>(&self, points: V8<F>, _asked: u32) -> (F, V8<F>) {
        self.look_up(points)
    }

    /// [`LookUp::look_up_some`]; may be none where all distances are `limit` (metres) or more.
    #[inline(always)]
    fn look_up_near<F: Lanes>(&self, points: V8<F>, asked: u32, limit: f32) -> Option<(F, V8<F>)> {
        let (distances, gradients) = self.look_up_some(points, asked);
        let near = distances.lt(F::splat(limit)).bits() & asked != 0;
        if near { Some((distances, gradients)) } else { None }
    }

    /// Lower bounds of the signed distances, for culling; exact (but for a grid) inside a grid's box.
    fn lower_bound<F: Lanes>(&self, points: V8<F>) -> F;
}

/// The bits of all eight points.
const ALL: u32 = (1 << LANES) - 1;

impl LookUp for Surface<'_> {
    #[inline(always)]
    fn look_up<F: Lanes>(&self, p: V8<F>) -> (F, V8<F>) {
        match self {
            Surface::HalfSpace => (p.y, splat(Vec3::Y)),
            Surface::Sphere(radius) => round(p, *radius),
            Surface::Cuboid(c) => cuboid(p, c.half_extents),
            Surface::Capsule(c) => {
                let h = F::splat(c.half_height);
                let on_axis = p.y.max(-h).min(h);
                round(V8 { y: p.y - on_axis, ..p }, c.radius)
            }
            Surface::Cylinder(c) => cylinder(p, *c),
            Surface::Hull(planes) => hull(p, planes),
            Surface::Field(field) => field.look_up(p),
            Surface::Sheet(skin, depth_limit) => {
                let (distance, gradient) = sheet(&p.form(), skin, *depth_limit, ALL);
                (F::from_array(distance), gradient.form())
            }
        }
    }

    #[inline(always)]
    fn look_up_some<F: Lanes>(&self, p: V8<F>, asked: u32) -> (F, V8<F>) {
        if let Surface::Sheet(skin, depth_limit) = self {
            let (distance, gradient) = sheet(&p.form(), skin, *depth_limit, asked);
            (F::from_array(distance), gradient.form())
        } else {
            self.look_up(p)
        }
    }

    #[inline(always)]
    fn lower_bound<F: Lanes>(&self, p: V8<F>) -> F {
        match self {
            Surface::Field(field) => field.lower_bound(p),
            Surface::Sheet(skin, depth_limit) => F::from_array(sheet_bound(&p.form(), skin, *depth_limit)),
            _ => self.look_up(p).0,
        }
    }
}

impl Surface<'_> {
    /// Signed distance and gradient at one point; in a field from the triangles of its mesh, exact at any distance.
    /// `guess` is for the next point close by.
    pub(crate) fn exact(&self, p: Vec3, skin: Option<&Skin<'_>>, guess: &mut Option<Nearest>) -> (f32, Vec3) {
        if let (Surface::Field(_), Some(skin)) = (self, skin) {
            let point = p.as_dvec3();
            let nearest = skin.nearest(point, guess.as_ref());
            *guess = Some(nearest);
            let signed = skin.signed(point, &nearest);
            return (signed.distance as f32, signed.gradient);
        }
        let (d, g) = self.look_up::<Portable>(splat(p));
        (d.to_array()[0], lane(&g, 0))
    }
}

/// Distance to a ball about the origin of what is left of the points.
#[inline(always)]
fn round<F: Lanes>(p: V8<F>, radius: f32) -> (F, V8<F>) {
    let length = p.length();
    (length - F::splat(radius), p * (F::one() / length.max(F::splat(1e-9))))
}

#[inline(always)]
fn with_sign_of<F: Lanes>(magnitude: F, sign: F) -> F {
    sign.lt(F::zero()).select(F::zero() - magnitude, magnitude)
}

#[inline(always)]
fn cuboid<F: Lanes>(p: V8<F>, half: Vec3) -> (F, V8<F>) {
    let (zero, one) = (F::zero(), F::one());
    let (qx, qy, qz) =
        (p.x.abs() - F::splat(half.x), p.y.abs() - F::splat(half.y), p.z.abs() - F::splat(half.z));
    let beyond = V8 { x: qx.max(zero), y: qy.max(zero), z: qz.max(zero) };
    let (outside_distance, outside_gradient) = round(beyond, 0.0);
    // Inside, the nearest face is the way out.
    let inside_distance = qx.max(qy).max(qz);
    let x_wins = qy.max(qz).lt(qx);
    let y_wins = qz.lt(qy);
    let inside_gradient = V8 {
        x: x_wins.select(one, zero),
        y: x_wins.select(zero, y_wins.select(one, zero)),
        z: x_wins.select(zero, y_wins.select(zero, one)),
    };
    let outside = zero.lt(outside_distance);
    let g = outside.select_v(outside_gradient, inside_gradient);
    let gradient = V8 { x: with_sign_of(g.x, p.x), y: with_sign_of(g.y, p.y), z: with_sign_of(g.z, p.z) };
    (outside.select(outside_distance, inside_distance), gradient)
}

#[inline(always)]
fn cylinder<F: Lanes>(p: V8<F>, c: Cylinder) -> (F, V8<F>) {
    let (zero, one, tiny) = (F::zero(), F::one(), F::splat(1e-9));
    let radial = (p.x * p.x + p.z * p.z).sqrt();
    let inverse = one / radial.max(tiny);
    let (across, along) = (radial - F::splat(c.radius), p.y.abs() - F::splat(c.half_height));
    let (a, b) = (across.max(zero), along.max(zero));
    let outside_distance = (a * a + b * b).sqrt();
    let inverse_outside = one / outside_distance.max(tiny);
    let outside = zero.lt(outside_distance);
    let side_wins = along.lt(across);
    let g_across = outside.select(a * inverse_outside, side_wins.select(one, zero));
    let g_along = outside.select(b * inverse_outside, side_wins.select(zero, one));
    let gradient =
        V8 { x: g_across * p.x * inverse, y: with_sign_of(g_along, p.y), z: g_across * p.z * inverse };
    (outside.select(outside_distance, across.max(along)), gradient)
}

#[inline(always)]
fn hull<F: Lanes>(p: V8<F>, planes: &[(Vec3, f32)]) -> (F, V8<F>) {
    let mut distance = F::splat(f32::NEG_INFINITY);
    let mut gradient = V8::zero();
    for (normal, offset) in planes {
        let normal = splat(*normal);
        let d = p.dot(normal) - F::splat(*offset);
        let wins = distance.lt(d);
        distance = wins.select(d, distance);
        gradient = wins.select_v(normal, gradient);
    }
    (distance, gradient)
}

/// Fills `planes` with those of a hull: its faces, and for each edge the plane halfway between its faces, which rounds
/// the corner that a point beyond the edge would otherwise see too near.
pub(crate) fn hull_planes(hull: &Hull, planes: &mut Vec<(Vec3, f32)>) {
    let edges = hull.edges.iter().filter_map(|e| {
        let sum = hull.faces[e.faces[0] as usize].normal + hull.faces[e.faces[1] as usize].normal;
        let normal = sum.try_normalize()?;
        let offset = e.vertices.map(|v| normal.dot(hull.vertices[v as usize]));
        Some((normal, offset[0].max(offset[1])))
    });
    planes.clear();
    planes.extend(hull.faces.iter().map(|f| (f.normal, f.offset)));
    planes.extend(edges);
}

fn sheet(p: &V8<Portable>, skin: &Skin<'_>, depth_limit: f32, asked: u32) -> ([f32; LANES], V8<Portable>) {
    let (mut distance, mut gradient) = ([f32::INFINITY; LANES], [Vec3::Y; LANES]);
    for i in (0..LANES).filter(|i| asked >> i & 1 == 1) {
        let signed = skin.look_up(lane(p, i));
        // Behind a boundary edge is beside the sheet; far behind the sheet is under a bridge.
        let lost = signed.on_boundary || signed.distance < -f64::from(depth_limit);
        if signed.distance < 0.0 && lost {
            continue;
        }
        (distance[i], gradient[i]) = (signed.distance as f32, signed.gradient);
    }
    (distance, of_vectors(&gradient))
}

fn sheet_bound(p: &V8<Portable>, skin: &Skin<'_>, depth_limit: f32) -> [f32; LANES] {
    std::array::from_fn(|i| skin.look_up(lane(p, i)).distance.abs() as f32 - depth_limit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Hull;

    fn numbers(i: u32) -> Vec3 {
        let part = |k: u32| ((i * 7919 + i * i % 613 * k * 104_729) % 2003) as f32 / 2003.0 * 2.0 - 1.0;
        Vec3::new(part(1), part(2), part(3))
    }

    /// For every shape: its surface, and whether distances beyond corners are exact.
    fn surfaces(planes: &mut Vec<(Vec3, f32)>) -> Vec<(Surface<'_>, bool)> {
        let corners: Vec<Vec3> = (0..12).map(|i| numbers(i * 37 + 5).normalize() * 0.6).collect();
        hull_planes(&Hull::new(&corners).expect("points in general position"), planes);
        vec![
            (Surface::HalfSpace, true),
            (Surface::Sphere(0.5), true),
            (Surface::Cuboid(Cuboid { half_extents: Vec3::new(0.3, 0.5, 0.2) }), true),
            (Surface::Capsule(Capsule { half_height: 0.3, radius: 0.2 }), true),
            (Surface::Cylinder(Cylinder { half_height: 0.3, radius: 0.4 }), true),
            (Surface::Hull(planes), false),
        ]
    }

    fn at(surface: &Surface, p: Vec3) -> (f32, Vec3) {
        surface.exact(p, None, &mut None)
    }

    #[test]
    fn the_gradient_leads_to_the_surface() {
        for (surface, exact) in surfaces(&mut Vec::new()) {
            for i in 0..2000 {
                let p = numbers(i) * 1.2;
                let (distance, gradient) = at(&surface, p);
                assert!((gradient.length() - 1.0).abs() < 1e-4, "{surface:?} at {p}: gradient {gradient}");
                let foot = p - gradient * distance;
                let (left, _) = at(&surface, foot);
                if exact {
                    assert!(left.abs() < 1e-5, "{surface:?} at {p}: {left} m left at {foot}");
                }
                // A distance: no faster than the way between two points.
                let q = numbers(i + 77) * 1.2;
                assert!((at(&surface, q).0 - distance).abs() <= p.distance(q) + 1e-5);
            }
        }
    }

    #[test]
    fn no_inner_point_is_nearer_than_the_distance() {
        for (surface, _) in surfaces(&mut Vec::new()) {
            let inner: Vec<Vec3> = (0..4000).map(numbers).filter(|p| at(&surface, *p).0 <= 0.0).collect();
            assert!(inner.len() > 50);
            for p in (0..300).map(|i| numbers(i * 3 + 1) * 1.5) {
                let (distance, _) = at(&surface, p);
                let nearest = inner.iter().map(|q| q.distance(p)).fold(f32::INFINITY, f32::min);
                assert!(
                    distance <= nearest + 1e-5,
                    "{surface:?}: {distance} at {p}, but {nearest} to an inner point"
                );
            }
        }
    }
}
