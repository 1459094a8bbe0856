//! The eight-lane kernel against the scalar reference of the geometry crate.

use forerun_geometry::contact::cuboid_cuboid;
use forerun_geometry::shape::Cuboid;
use forerun_geometry::{Pose, Quat, Vec3};

use super::cuboids::{BoxPair, Boxes, cuboid_manifolds};

struct Random(u64);

impl Random {
    fn between(&mut self, low: f32, high: f32) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 40) as f32 / (1u64 << 24) as f32)
    }

    fn vector(&mut self, reach: f32) -> Vec3 {
        Vec3::new(self.between(-reach, reach), self.between(-reach, reach), self.between(-reach, reach))
    }

    /// Half of the poses are nearly aligned, as in stacks.
    fn pose(&mut self, reach: f32) -> Pose {
        let spread = if self.between(0.0, 1.0) < 0.5 { 0.02 } else { 1.0 };
        let v = self.vector(spread);
        Pose::new(self.vector(reach), Quat::from_xyzw(v.x, v.y, v.z, 1.0).normalize())
    }
}

#[test]
fn eight_lanes_find_the_manifolds_of_the_reference() {
    let mut r = Random(11);
    let (mut boxes, mut pairs, mut scenes) = (Boxes::default(), Vec::new(), Vec::new());
    for slot in 0..3001 {
        let half = |r: &mut Random| Vec3::splat(0.7) + r.vector(0.5);
        let (ha, hb) = (half(&mut r), half(&mut r));
        let (pa, pb) = (r.pose(0.9), r.pose(0.9));
        let margin = r.between(0.0, 0.1);
        let (first, second) = (boxes.push(ha, &pa), boxes.push(hb, &pb));
        pairs.push(BoxPair { slot, first, second, margin });
        scenes.push((Cuboid { half_extents: ha }, pa, Cuboid { half_extents: hb }, pb, margin));
    }
    let mut found = Vec::new();
    cuboid_manifolds(&boxes, &pairs, &mut found);
    let mut found = found.into_iter().peekable();
    let mut differing = 0;
    for (slot, (a, pa, b, pb, margin)) in scenes.iter().enumerate() {
        let reference = cuboid_cuboid(a, pa, b, pb, *margin);
        let ours = found.next_if(|(s, _)| *s as usize == slot).map(|(_, m)| m);
        let same = match (&reference, &ours) {
            (None, None) => true,
            (Some(x), Some(y)) => {
                x.normal.dot(y.normal) > 0.999
                    && (x.deepest() - y.deepest()).abs() < 1e-4
                    && x.count == y.count
            }
            _ => false,
        };
        differing += usize::from(!same);
    }
    assert!(found.next().is_none(), "a manifold for no pair");
    // Ties between axes or corners fall either way by rounding, in one pair of a hundred at most: half of the boxes are nearly aligned.
    assert!(differing <= 30, "{differing} of {} manifolds differ", scenes.len());
}
