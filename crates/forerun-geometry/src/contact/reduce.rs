//! Reduce: many contact points to four.
//!
//! Promise: the choice follows the points' order and numbers alone; the deepest point is always kept.

use super::{ContactPoint, Manifold};
use crate::Vec3;

/// The four directions, as multiples of the two axes, in which the outermost points are kept. A quarter turn takes each
/// to the next. They are turned half a degree off the diagonals: a square that stands at exactly 45° would offer two
/// equally good corners to each, and one of its corners might be chosen twice and another not at all.
pub(super) const DIAGONALS: [(f32, f32); 4] = [(-0.99, -1.01), (1.01, -0.99), (0.99, 1.01), (-1.01, 0.99)];

/// A later point must beat an earlier one by this much, so that rounding does not decide. Metres.
pub(super) const TIE: f32 = 1.0e-5;

/// Points nearer to each other than this are one point. Metres.
const SAME_POINT: f32 = 1.0e-4;

/// The deepest point is put in by force if it is deeper than all that were chosen by this much. Metres.
const DEEPER: f32 = 2.0e-5;

/// Takes points one by one and keeps the outermost in four directions, depth counting like distance.
pub(super) struct Reducer {
    origin: Vec3,
    u: Vec3,
    v: Vec3,
    best: [Option<(f32, ContactPoint)>; 4],
    deepest: Option<ContactPoint>,
}

impl Reducer {
    /// `u` and `v` span the plane of contact; `origin` is any point nearby (it keeps the numbers small).
    pub(super) fn new(origin: Vec3, u: Vec3, v: Vec3) -> Self {
        Reducer { origin, u, v, best: [None; 4], deepest: None }
    }

    /// One more point.
    pub(super) fn offer(&mut self, point: ContactPoint) {
        let arm = point.position - self.origin;
        let (x, y) = (arm.dot(self.u), arm.dot(self.v));
        for (best, (du, dv)) in self.best.iter_mut().zip(DIAGONALS) {
            let score = x * du + y * dv - point.separation;
            if best.is_none_or(|(other, _)| score > other + TIE) {
                *best = Some((score, point));
            }
        }
        if self.deepest.is_none_or(|other| point.separation < other.separation - TIE) {
            self.deepest = Some(point);
        }
    }

    /// The manifold of what was kept; none if nothing was offered.
    pub(super) fn finish(self) -> Option<Manifold> {
        let deepest = self.deepest?;
        let mut kept = [deepest; 4];
        let mut count = 0;
        for (_, point) in self.best.into_iter().flatten() {
            let near = |other: &ContactPoint| {
                (other.position - point.position).length_squared() < SAME_POINT * SAME_POINT
            };
            match kept[..count].iter().position(near) {
                Some(twin) if point.separation < kept[twin].separation => kept[twin] = point,
                Some(_) => {}
                None => {
                    kept[count] = point;
                    count += 1;
                }
            }
        }
        let missed = |other: &ContactPoint| deepest.separation < other.separation - DEEPER;
        if kept[..count].iter().all(missed) {
            let mut nearest = 0;
            let distance = |point: &ContactPoint| (point.position - deepest.position).length_squared();
            for index in 1..count {
                if distance(&kept[index]) < distance(&kept[nearest]) {
                    nearest = index;
                }
            }
            kept[nearest] = deepest;
        }
        Manifold::from_points(&kept[..count])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: f32, z: f32, separation: f32) -> ContactPoint {
        ContactPoint { position: Vec3::new(x, 0.0, z), normal: Vec3::Y, separation }
    }

    #[test]
    fn a_square_at_45_degrees_keeps_its_corners() {
        let corners = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)];
        for first in 0..4 {
            let mut reducer = Reducer::new(Vec3::ZERO, Vec3::X, Vec3::Z);
            for k in 0..4 {
                let (x, z) = corners[(first + k) % 4];
                reducer.offer(point(x, z, 0.0));
            }
            assert_eq!(reducer.finish().map(|m| m.count), Some(4));
        }
    }

    #[test]
    fn the_deepest_point_is_kept_though_it_is_inside() {
        let mut reducer = Reducer::new(Vec3::ZERO, Vec3::X, Vec3::Z);
        for (x, z) in [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)] {
            reducer.offer(point(x, z, 0.0));
        }
        reducer.offer(point(0.1, 0.2, -0.01));
        let manifold = reducer.finish().expect("points were offered");
        assert_eq!(manifold.count, 4);
        assert!((manifold.deepest() + 0.01).abs() < 1.0e-9);
    }
}
