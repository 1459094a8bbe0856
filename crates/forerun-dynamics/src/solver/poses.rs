//! Poses: orientations of eight bodies side by side; the same formulas as in [`rotation`](super::rotation).

use crate::lanes::{LaneMask, Lanes, V8};

/// Largest turn (radians) for which the series holds.
const SERIES_MAX: f32 = 1.0;

/// Eight unit quaternions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Q8<F> {
    pub(crate) v: V8<F>,
    pub(crate) w: F,
}

impl<F: Lanes> Q8<F> {
    /// The axes of the bodies in the world.
    #[inline(always)]
    pub(crate) fn axes(self) -> [V8<F>; 3] {
        let V8 { x, y, z } = self.v;
        let (one, w) = (F::one(), self.w);
        let (x2, y2, z2) = (x + x, y + y, z + z);
        let (xx, xy, xz) = (x * x2, x * y2, x * z2);
        let (yy, yz, zz) = (y * y2, y * z2, z * z2);
        let (wx, wy, wz) = (w * x2, w * y2, w * z2);
        [
            V8 { x: one - (yy + zz), y: xy + wz, z: xz - wy },
            V8 { x: xy - wz, y: one - (xx + zz), z: yz + wx },
            V8 { x: xz + wy, y: yz - wx, z: one - (xx + yy) },
        ]
    }

    /// Turned by rotation vectors in the world. Where these are longer than the series holds, see [`is_large`], it is wrong.
    #[inline(always)]
    pub(crate) fn turned(self, rotation: V8<F>) -> Self {
        let square = rotation.dot(rotation);
        // tan(a/2) / a to the sixth order: relative error below 1e-4 up to one radian.
        let inner = F::splat(1.0 / 120.0) + square * F::splat(17.0 / 20160.0);
        let outer = F::splat(1.0 / 12.0) + square * inner;
        let turn = rotation * (F::splat(0.5) * (F::one() + square * outer));
        // The quaternion (turn, 1) times this one.
        let v = self.v + turn * self.w + turn.cross(self.v);
        let w = self.w - turn.dot(self.v);
        let inverse = F::one() / (v.dot(v) + w * w).sqrt();
        Q8 { v: v * inverse, w: w * inverse }
    }
}

/// Bit `i` is set where the turn of lane `i` is beyond the series (or is none).
#[inline(always)]
pub(crate) fn is_large<F: Lanes>(rotation: V8<F>) -> u32 {
    let most = F::splat(SERIES_MAX * SERIES_MAX);
    !rotation.dot(rotation).le(most).bits() & 0xff
}

/// From the world to the axes.
#[inline(always)]
pub(crate) fn to_axes<F: Lanes>(axes: &[V8<F>; 3], v: V8<F>) -> V8<F> {
    V8 { x: axes[0].dot(v), y: axes[1].dot(v), z: axes[2].dot(v) }
}

/// From the axes to the world.
#[inline(always)]
pub(crate) fn from_axes<F: Lanes>(axes: &[V8<F>; 3], v: V8<F>) -> V8<F> {
    axes[0] * v.x + axes[1] * v.y + axes[2] * v.z
}

#[cfg(test)]
mod tests {
    use forerun_geometry::{Quat, Vec3};

    use super::super::rotation;
    use super::*;
    use crate::lanes::{LANES, Portable};

    #[test]
    fn eight_turn_as_one_does() {
        let q = Quat::from_xyzw(0.3, -0.5, 0.1, 0.8).normalize();
        let rotation = Vec3::new(0.2, -0.7, 0.4);
        let splat =
            |v: Vec3| V8 { x: Portable::splat(v.x), y: Portable::splat(v.y), z: Portable::splat(v.z) };
        let eight = Q8 { v: splat(Vec3::new(q.x, q.y, q.z)), w: Portable::splat(q.w) };
        let turned = eight.turned(splat(rotation));
        let expected = rotation::turned(q, rotation);
        for lane in [0, LANES - 1] {
            let lane_of = |x: Portable| x.to_array()[lane];
            let found = Quat::from_xyzw(
                lane_of(turned.v.x),
                lane_of(turned.v.y),
                lane_of(turned.v.z),
                lane_of(turned.w),
            );
            assert!((found - expected).length() < 1e-6, "{found}, expected {expected}");
            let axis = turned.axes()[2];
            let found = Vec3::new(lane_of(axis.x), lane_of(axis.y), lane_of(axis.z));
            assert!((found - expected * Vec3::Z).length() < 1e-6);
        }
        assert_eq!(is_large(splat(rotation)), 0);
        assert_eq!(is_large(splat(rotation * 1.3)), 0xff);
    }
}
