//! Mesh parts: triangles that stand for equal parts of the area of a mesh.

use super::Mesh;

/// Inverse of the golden ratio: its multiples are spread evenly between whole numbers, and repeat with no row of a mesh.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

impl Mesh {
    /// Cuts the surface, in the order of its triangles, into `count` parts of equal area, and calls `visit` with the number of each part and
    /// a triangle in it: a large one more often than a small one. Never with a triangle without area.
    pub(crate) fn each_part(&self, count: u32, mut visit: impl FnMut(u32, u32)) {
        let area = |t: u32| 0.5 * self.face_vector(t).length();
        let triangles = self.triangles.len() as u32;
        let part_area = (0..triangles).map(area).sum::<f64>() / f64::from(count);
        let (mut before, mut part) = (0.0, 0);
        // Not in the middle of every part: triangles that repeat every so many would all be met at the same one.
        let place = |part: u32| f64::from(part) + (0.5 + GOLDEN * f64::from(part)).fract();
        for t in 0..triangles {
            before += area(t);
            while part < count && place(part) * part_area < before {
                visit(part, t);
                part += 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::Vec3;
    use crate::shape::mesh_make;

    #[test]
    fn large_triangles_stand_for_more_and_rows_are_met_everywhere() {
        let torus = mesh_make::torus(0.5, 0.2, 128, 16).expect("a closed mesh");
        let mut met = [0_u32; 32];
        torus.each_part(1024, |_, t| met[t as usize % 32] += 1);
        // 32 triangles round the tube; those outside are 7/3 times as large as those inside.
        let (least, most) = (met.iter().min().expect("32"), met.iter().max().expect("32"));
        assert!(*least > 12 && *most < 52, "{met:?}");
        let plate = mesh_make::cuboid(Vec3::new(1.0, 0.01, 0.01)).expect("a closed mesh");
        let mut ends = 0;
        let mut parts = 0;
        plate.each_part(1000, |part, t| {
            assert_eq!(part, parts);
            parts += 1;
            ends += u32::from(plate.face_vector(t).normalize().x.abs() > 0.9);
        });
        assert_eq!(parts, 1000);
        assert!((2..=8).contains(&ends), "{ends} of 1000, 5 by area");
    }
}
