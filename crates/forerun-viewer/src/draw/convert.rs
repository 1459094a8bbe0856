//! From the engine's vectors to the graphics library's.

use forerun::Vec3;

pub(super) fn vector(v: Vec3) -> three_d::Vec3 {
    three_d::vec3(v.x, v.y, v.z)
}
