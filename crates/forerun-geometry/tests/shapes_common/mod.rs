//! What the tests of shapes share: a fixed-seed generator and a few shapes.
#![allow(dead_code, reason = "every test file is a crate of its own and uses a part of this")]

use forerun_geometry::{Pose, Quat, Vec3};

/// SplitMix64 (Steele, Lea, Flood 2014).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// From `low` to `high`.
    pub(crate) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * (self.bits() >> 40) as f32 / (1 << 24) as f32
    }

    /// In the cube from -size to size.
    pub(crate) fn vector(&mut self, size: f32) -> Vec3 {
        Vec3::new(self.between(-size, size), self.between(-size, size), self.between(-size, size))
    }

    /// Evenly spread directions.
    pub(crate) fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.vector(1.0);
            if (0.01..1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }

    pub(crate) fn rotation(&mut self) -> Quat {
        loop {
            let [x, y, z, w] = [0; 4].map(|_| self.between(-1.0, 1.0));
            let q = Quat::from_xyzw(x, y, z, w);
            if (0.01..1.0).contains(&q.length_squared()) {
                return q.normalize();
            }
        }
    }

    pub(crate) fn pose(&mut self, size: f32) -> Pose {
        Pose::new(self.vector(size), self.rotation())
    }
}
