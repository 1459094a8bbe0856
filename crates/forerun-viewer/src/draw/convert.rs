//! From the engine's vectors to the graphics library's.

use forerun::{Pose, Vec3};
use three_d::Mat4;

pub(super) fn vector(v: Vec3) -> three_d::Vec3 {
    three_d::vec3(v.x, v.y, v.z)
}

pub(super) fn matrix_of(pose: &Pose) -> Mat4 {
    let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| vector(pose.rotation * axis).extend(0.0));
    Mat4::from_cols(x, y, z, vector(pose.position).extend(1.0))
}
