//! Euler angles: a rotation as three numbers that people read: first about y (yaw), then about x (pitch), then about z (roll), each about the axis that
//! the one before has turned.

use forerun::{Quat, Vec3};

/// The sine of a pitch from which yaw and roll are the same turn, which is called yaw.
const STRAIGHT: f64 = 0.999_999;

/// Pitch (x), yaw (y) and roll (z) of a rotation. Degrees.
pub(super) fn degrees_of(rotation: Quat) -> Vec3 {
    let [x, y, z, w] = rotation.to_array().map(f64::from);
    let sine = (2.0 * (w * x - y * z)).clamp(-1.0, 1.0);
    let (yaw, roll) = if sine.abs() > STRAIGHT {
        (2.0 * y.atan2(w), 0.0)
    } else {
        let yaw = (2.0 * (x * z + w * y)).atan2(1.0 - 2.0 * (x * x + y * y));
        (yaw, (2.0 * (x * y + w * z)).atan2(1.0 - 2.0 * (x * x + z * z)))
    };
    let [pitch, yaw, roll] = [sine.asin(), yaw, roll].map(|angle| angle.to_degrees() as f32);
    Vec3::new(pitch, yaw, roll)
}

/// The rotation with these angles (degrees).
pub(super) fn rotation_of(degrees: Vec3) -> Quat {
    let about = |axis: Vec3, degrees: f32| Quat::from_axis_angle(axis, degrees.to_radians());
    let turned = about(Vec3::Y, degrees.y) * about(Vec3::X, degrees.x) * about(Vec3::Z, degrees.z);
    turned.normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_say_the_rotation_that_they_came_from() {
        for pitch in [-90.0, -89.0, -30.0, 0.0, 12.5, 90.0] {
            for yaw in [-170.0, -90.0, 0.0, 45.0, 179.0] {
                for roll in [-120.0, 0.0, 7.0, 150.0] {
                    let rotation = rotation_of(Vec3::new(pitch, yaw, roll));
                    let again = rotation_of(degrees_of(rotation));
                    let same = rotation.dot(again).abs();
                    assert!((1.0 - same) < 1e-5, "{pitch} {yaw} {roll}: {}", degrees_of(rotation));
                }
            }
        }
        let plain = degrees_of(rotation_of(Vec3::new(10.0, 20.0, 30.0)));
        assert!((plain - Vec3::new(10.0, 20.0, 30.0)).length() < 1e-3, "{plain}");
    }
}
