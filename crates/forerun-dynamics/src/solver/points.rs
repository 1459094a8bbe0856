//! Points: how the points of a contact push, seen from the contact's centre and along its own axes: two tangents and the normal.
//!
//! Nearly all manifolds are flat: all points push along the one normal, so that a point is two numbers, its place on the tangent plane. Those of
//! meshes have a normal at each point.

use std::fmt::Debug;

use crate::lanes::{Lanes, V8};

/// How the second body of a contact moves relative to the first, at the contact's centre and along its axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Relative<F> {
    pub(crate) linear: V8<F>,
    pub(crate) angular: V8<F>,
}

/// What the second body of a contact gets and the first one loses: impulse and its moment about the contact's centre, along its axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Push<F> {
    pub(crate) force: V8<F>,
    pub(crate) moment: V8<F>,
}

impl<F: Lanes> Push<F> {
    #[inline(always)]
    pub(crate) fn none() -> Self {
        Push { force: V8::zero(), moment: V8::zero() }
    }

    /// Adds friction: along the two tangents, and a twist about the normal.
    #[inline(always)]
    pub(crate) fn rub(&mut self, tangents: [F; 2], twist: F) {
        self.force.x += tangents[0];
        self.force.y += tangents[1];
        self.moment.z += twist;
    }
}

/// One body of eight contacts.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Side<F> {
    /// Square root of the inverse mass.
    pub(crate) scale: F,
    /// From the body's centre of mass to the contact's centre, along the contact's axes.
    pub(crate) offset: V8<F>,
    /// Mass-scaled angular velocity that a unit moment about each of the contact's axes gives: also what reads the angular velocity about it.
    pub(crate) turns: [V8<F>; 3],
}

impl<F: Lanes> Side<F> {
    /// Mass-scaled angular part of the Jacobian of a push: `turns` of its moment about the body's centre of mass.
    #[inline(always)]
    pub(crate) fn arm(&self, push: &Push<F>) -> V8<F> {
        let m = push.moment + self.offset.cross(push.force);
        self.turns[0] * m.x + self.turns[1] * m.y + self.turns[2] * m.z
    }
}

/// The sum over four points, in pairs: what waits for less is done sooner.
#[inline(always)]
pub(crate) fn sum<F: Lanes>([a, b, c, d]: &[F; 4]) -> F {
    (*a + *b) + (*c + *d)
}

/// The sum of products over four points.
#[inline(always)]
pub(crate) fn weighted<F: Lanes>(a: &[F; 4], b: &[F; 4]) -> F {
    (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3])
}

/// One point of each of eight contacts.
pub(crate) trait Point<F: Lanes>: Copy + Debug {
    /// The point at a place relative to the centre, with its normal, both along the contact's axes.
    fn new(place: V8<F>, normal: V8<F>) -> Self;

    /// How fast the bodies part at the point.
    fn speed(&self, relative: &Relative<F>) -> F;

    /// What impulses at the four points of a contact do together.
    fn push(points: &[Self; 4], impulses: &[F; 4]) -> Push<F>;

    /// Mass-scaled angular part of the point's Jacobian.
    fn arm(&self, side: &Side<F>) -> V8<F>;

    /// The point's normal along the contact's axes.
    fn normal(&self) -> V8<F>;
}

/// What the manifolds of some blocks are like.
pub(crate) trait Kind: Copy + Debug + Default {
    /// Their points.
    type Point<F: Lanes>: Point<F> + Send + Sync;
    /// Whether each point has a normal of its own.
    const NORMALS: bool;
}

/// All points of a contact share its normal.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Flat;

/// Each point of a contact has a normal of its own.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Uneven;

/// A place on the plane of the tangents.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct FlatPoint<F> {
    x: F,
    y: F,
}

/// A unit push along the point's normal.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct UnevenPoint<F> {
    normal: V8<F>,
    moment: V8<F>,
}

impl Kind for Flat {
    type Point<F: Lanes> = FlatPoint<F>;
    const NORMALS: bool = false;
}

impl Kind for Uneven {
    type Point<F: Lanes> = UnevenPoint<F>;
    const NORMALS: bool = true;
}

impl<F: Lanes> Point<F> for FlatPoint<F> {
    #[inline(always)]
    fn new(place: V8<F>, _normal: V8<F>) -> Self {
        FlatPoint { x: place.x, y: place.y }
    }

    #[inline(always)]
    fn speed(&self, relative: &Relative<F>) -> F {
        relative.linear.z + (relative.angular.x * self.y - relative.angular.y * self.x)
    }

    #[inline(always)]
    fn push([a, b, c, d]: &[Self; 4], impulses: &[F; 4]) -> Push<F> {
        let zero = F::zero();
        let x = weighted(impulses, &[a.y, b.y, c.y, d.y]);
        let y = weighted(impulses, &[a.x, b.x, c.x, d.x]);
        let force = V8 { x: zero, y: zero, z: sum(impulses) };
        Push { force, moment: V8 { x, y: -y, z: zero } }
    }

    #[inline(always)]
    fn arm(&self, side: &Side<F>) -> V8<F> {
        side.turns[0] * (side.offset.y + self.y) - side.turns[1] * (side.offset.x + self.x)
    }

    #[inline(always)]
    fn normal(&self) -> V8<F> {
        V8 { x: F::zero(), y: F::zero(), z: F::one() }
    }
}

impl<F: Lanes> Point<F> for UnevenPoint<F> {
    #[inline(always)]
    fn new(place: V8<F>, normal: V8<F>) -> Self {
        UnevenPoint { normal, moment: place.cross(normal) }
    }

    #[inline(always)]
    fn speed(&self, relative: &Relative<F>) -> F {
        self.normal.dot(relative.linear) + self.moment.dot(relative.angular)
    }

    #[inline(always)]
    fn push([a, b, c, d]: &[Self; 4], i: &[F; 4]) -> Push<F> {
        Push {
            force: (a.normal * i[0] + b.normal * i[1]) + (c.normal * i[2] + d.normal * i[3]),
            moment: (a.moment * i[0] + b.moment * i[1]) + (c.moment * i[2] + d.moment * i[3]),
        }
    }

    #[inline(always)]
    fn arm(&self, side: &Side<F>) -> V8<F> {
        side.arm(&Push { force: self.normal, moment: self.moment })
    }

    #[inline(always)]
    fn normal(&self) -> V8<F> {
        self.normal
    }
}
