//! Raster: which pixels a triangle covers.

use forerun::Vec3;

/// Calls `visit` with the index (row by row) of every pixel whose middle lies in a triangle, and the three parts that its corners have
/// there. Corners are in pixels; z is not looked at.
pub(crate) fn cover(corners: [Vec3; 3], size: [usize; 2], mut visit: impl FnMut(usize, [f32; 3])) {
    let [a, b, c] = corners;
    let cross = |p: Vec3, q: Vec3, x: f32, y: f32| (q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x);
    let area = cross(a, b, c.x, c.y);
    // Comparing so that what is not a number covers nothing.
    if !(area.abs() > 0.0 && area.is_finite()) {
        return;
    }
    let range = |low: f32, high: f32, size: usize| {
        let last = size as f32;
        ((low - 0.5).ceil().clamp(0.0, last) as usize, ((high - 0.5).floor() + 1.0).clamp(0.0, last) as usize)
    };
    let (left, right) = range(a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x), size[0]);
    let (top, bottom) = range(a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y), size[1]);
    for row in top..bottom {
        let y = row as f32 + 0.5;
        for column in left..right {
            let x = column as f32 + 0.5;
            let parts = [cross(b, c, x, y) / area, cross(c, a, x, y) / area, cross(a, b, x, y) / area];
            if parts.iter().all(|part| *part >= 0.0) {
                visit(row * size[0] + column, parts);
            }
        }
    }
}

/// A corner of a triangle as the camera sees it: (right, up, depth), and the normal there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    pub(crate) at: Vec3,
    pub(crate) normal: Vec3,
}

/// The part of a triangle that is deeper than `near`: none, one triangle or two.
pub(crate) fn clip(triangle: [Corner; 3], near: f32, mut visit: impl FnMut([Corner; 3])) {
    if triangle.iter().all(|corner| corner.at.z >= near) {
        return visit(triangle);
    }
    let mut kept: Vec<Corner> = Vec::with_capacity(4);
    for (i, from) in triangle.iter().enumerate() {
        let to = &triangle[(i + 1) % 3];
        if from.at.z >= near {
            kept.push(*from);
        }
        if (from.at.z >= near) != (to.at.z >= near) {
            let part = (near - from.at.z) / (to.at.z - from.at.z);
            kept.push(Corner { at: from.at.lerp(to.at, part), normal: from.normal.lerp(to.normal, part) });
        }
    }
    for i in 2..kept.len() {
        visit([kept[0], kept[i - 1], kept[i]]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_triangles_of_a_square_cover_it_once() {
        let at = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let mut count = vec![0; 64];
        let corners = [at(1.2, 0.7), at(6.9, 1.1), at(7.3, 6.6), at(0.4, 7.1)];
        for triangle in [[0, 1, 2], [0, 3, 2]] {
            cover(triangle.map(|i| corners[i]), [8, 8], |index, parts| {
                count[index] += 1;
                assert!((parts.iter().sum::<f32>() - 1.0).abs() < 1e-5);
                let x = parts.iter().zip(triangle).map(|(part, i)| part * corners[i].x).sum::<f32>();
                assert!((x - (index % 8) as f32 - 0.5).abs() < 1e-4);
            });
        }
        assert!(count.iter().all(|n| *n <= 1) && (28..45).contains(&count.iter().sum::<i32>()), "{count:?}");
        // Far out, not a number, without an area: nothing, and not for ever.
        for bad in [f32::NAN, f32::INFINITY, 1e30] {
            cover([at(bad, 0.0), at(1.0, 1e30), at(-1e30, bad)], [8, 8], |_, parts| assert!(parts[0] >= 0.0));
        }
    }

    #[test]
    fn what_is_behind_the_camera_is_cut_off() {
        let corner = |z: f32| Corner { at: Vec3::new(z, 1.0, z), normal: Vec3::Y };
        let depths = |triangle: [f32; 3]| {
            let mut found = Vec::new();
            clip(triangle.map(corner), 1.0, |t| found.push(t.map(|c| c.at.z)));
            found
        };
        assert_eq!(depths([2.0, 3.0, 4.0]), [[2.0, 3.0, 4.0]]);
        assert!(depths([0.0, 0.5, -4.0]).is_empty());
        assert_eq!(depths([0.0, 3.0, 0.0]).len(), 1);
        let two = depths([0.0, 3.0, 3.0]);
        assert!(two.len() == 2 && two.iter().flatten().all(|z| *z > 0.9999), "{two:?}");
    }
}
