//! Cylinder: what of it touches first in a direction.

use super::unit_or;
use crate::shape::Cylinder;
use crate::{Mat3, Vec3};

/// A cap tilted by less than this sine (0.1 degrees) counts as flat: the direction of the tilt would be noise, and the
/// points would wander around the rim from frame to frame. The error is below 0.06 % of the radius.
const FLAT: f32 = 0.002;

/// A cylinder somewhere.
pub(super) struct Drum {
    pub(super) centre: Vec3,
    /// Unit direction of the axis.
    pub(super) axis: Vec3,
    pub(super) half_height: f32,
    pub(super) radius: f32,
}

/// The points of a cylinder that come first in a direction.
pub(super) enum Lowest {
    /// Four points on the rim of a flat cap, a quarter turn apart, in order.
    FlatCap([Vec3; 4]),
    /// The same of a tilted cap; the first is the lowest.
    TiltedCap([Vec3; 4]),
    /// Both ends of the lowest line of the side, the lower first.
    Side([Vec3; 2]),
}

impl Lowest {
    pub(super) fn as_slice(&self) -> &[Vec3] {
        match self {
            Lowest::FlatCap(points) | Lowest::TiltedCap(points) => points,
            Lowest::Side(points) => points,
        }
    }
}

impl Drum {
    pub(super) fn new(cylinder: &Cylinder, centre: Vec3, axes: Mat3) -> Self {
        Drum { centre, axis: axes.y_axis, half_height: cylinder.half_height, radius: cylinder.radius }
    }

    /// The centre of the cap that looks towards `down`, and the cap's outward normal.
    pub(super) fn cap(&self, down: Vec3) -> (Vec3, Vec3) {
        let outward = if self.axis.dot(down) < 0.0 { -self.axis } else { self.axis };
        (self.centre + outward * self.half_height, outward)
    }

    /// What comes first in direction `down` (unit).
    ///
    /// A cylinder that would fall back onto its cap, were it let go on its lowest point, shows that cap: the rim's
    /// lowest point, exactly, the two beside it and the one opposite; of a flat cap, where no point is lowest, the points
    /// towards `hint` (any vector that does not turn with the cylinder) and so on. Otherwise it shows its side.
    pub(super) fn lowest(&self, down: Vec3, hint: Vec3) -> Lowest {
        let (cap, outward) = self.cap(down);
        let cosine = outward.dot(down);
        // Of length sin(tilt), along the cap, downhill.
        let downhill = down - outward * cosine;
        let sine = downhill.length();
        if self.radius * cosine <= self.half_height * sine {
            let rim = unit_or(downhill, outward) * self.radius;
            return Lowest::Side([cap + rim, cap + rim - outward * (2.0 * self.half_height)]);
        }
        let flat = sine < FLAT;
        let towards = if flat { hint - outward * hint.dot(outward) } else { downhill };
        let u = unit_or(towards, super::any_perpendicular(outward));
        // Rounding leaves a trace of the normal in a short `downhill`: once more, so that the rim stays on the cap.
        let u = unit_or(u - outward * u.dot(outward), super::any_perpendicular(outward)) * self.radius;
        let v = outward.cross(u);
        let rim = [cap + u, cap + v, cap - u, cap - v];
        if flat { Lowest::FlatCap(rim) } else { Lowest::TiltedCap(rim) }
    }
}
