//! Polygons, fans and strips of mesh files, cut into triangles.

use glam::DVec3;

use crate::Vec3;

/// The triangles of a polygon, as a fan about the first corner from which all of them face the same way. The corners are vertices that exist.
pub(super) fn cut_polygon(vertices: &[Vec3], corners: &[u32]) -> Result<Vec<[u32; 3]>, String> {
    if corners.len() < 3 {
        return Err(format!("a face needs three corners or more, there are {}", corners.len()));
    }
    let fan = |first: usize| {
        let at = move |i: usize| corners[(first + i) % corners.len()];
        (1..corners.len() - 1).map(move |i| [at(0), at(i), at(i + 1)])
    };
    if corners.len() == 3 {
        return Ok(fan(0).collect());
    }
    let area = |triangle: [u32; 3]| {
        let [a, b, c] = triangle.map(|i| vertices[i as usize].as_dvec3());
        (b - a).cross(c - a)
    };
    let whole: DVec3 = fan(0).map(area).sum();
    // A face of no area at all faces no way: any fan will do.
    let best = (0..corners.len()).find(|&first| fan(first).all(|t| area(t).dot(whole) >= 0.0));
    match best {
        Some(first) => Ok(fan(first).collect()),
        None => Err(format!(
            "a face with {} corners is so far from convex that it cannot be cut into a fan; triangulate the mesh when exporting it",
            corners.len()
        )),
    }
}

/// The triangles of a fan about its first corner.
pub(super) fn fan(corners: &[u32]) -> Vec<[u32; 3]> {
    let Some((&first, others)) = corners.split_first() else {
        return Vec::new();
    };
    others.windows(2).map(|pair| [first, pair[0], pair[1]]).collect()
}

/// The triangles of a strip: each corner makes one with the two before it, and every second one is turned round. Corners that repeat
/// make no triangle: they only lead on to another place.
pub(super) fn strip(corners: &[u32]) -> Vec<[u32; 3]> {
    let turned = |(i, t): (usize, &[u32])| if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] };
    let differ = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
    corners.windows(3).enumerate().map(turned).filter(differ).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_the_winding() {
        assert_eq!(strip(&[0, 1, 2, 3, 4]), [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
        // A doubled corner leads on without a triangle.
        assert_eq!(strip(&[0, 1, 2, 2, 3]), [[0, 1, 2]]);
        assert_eq!(fan(&[0, 1, 2, 3]), [[0, 1, 2], [0, 2, 3]]);
        assert!(strip(&[0, 1]).is_empty() && fan(&[0, 1]).is_empty() && fan(&[]).is_empty());
    }
}
