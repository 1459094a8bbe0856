//! Polygons, fans and strips of mesh files, cut into triangles.

use glam::{DVec2, DVec3};

use crate::Vec3;
use crate::sdf::triangle::{corners_of, face_vector};

/// Corners of the largest polygon that is cut ear by ear: that takes time with the third power of their number.
const CORNERS_MAX: usize = 512;

/// Triangles that are looked at in search of the corner to begin a fan at, or those of one fan if they are more: all corners of polygons of 4096
/// are tried.
const SEARCH_MAX: usize = 1 << 24;

/// The triangles of a polygon: a fan about the first corner from which all of them face the same way, else ear by ear. The corners are
/// vertices that exist.
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
    let area = |triangle| face_vector(corners_of(vertices, triangle));
    let whole: DVec3 = fan(0).map(area).sum();
    // A face of no area at all faces no way: any fan will do.
    let tried = (SEARCH_MAX / corners.len()).clamp(1, corners.len());
    let best = (0..tried).find(|&first| fan(first).all(|t| area(t).dot(whole) >= 0.0));
    if let Some(first) = best {
        return Ok(fan(first).collect());
    }
    let (x, y) = whole.normalize().any_orthonormal_pair();
    let flat = |i: &u32| vertices[*i as usize].as_dvec3();
    let points: Vec<DVec2> = corners.iter().map(|i| DVec2::new(flat(i).dot(x), flat(i).dot(y))).collect();
    let cut = if corners.len() > CORNERS_MAX { None } else { clip_ears(&points) };
    let triangles = cut.ok_or_else(|| {
        format!(
            "a face with {} corners is too large or crosses itself and cannot be cut into triangles; triangulate the mesh when exporting it",
            corners.len()
        )
    })?;
    Ok(triangles.into_iter().map(|triangle| triangle.map(|i| corners[i])).collect())
}

/// The triangles of a counter-clockwise polygon that does not cross itself: one by one a corner is cut off whose triangle holds no other
/// corner (Meisters 1975). All corners are used, so that neighbours with the same edges still fit.
fn clip_ears(points: &[DVec2]) -> Option<Vec<[usize; 3]>> {
    let turn = |[a, b, c]: [usize; 3]| (points[b] - points[a]).perp_dot(points[c] - points[b]);
    let mut left: Vec<usize> = (0..points.len()).collect();
    let mut triangles = Vec::new();
    while left.len() > 3 {
        let around = |i: usize| {
            let n = left.len();
            [left[(i + n - 1) % n], left[i], left[(i + 1) % n]]
        };
        let is_free = |ear: [usize; 3]| {
            let [a, b, c] = ear.map(|i| points[i]);
            let holds = |p: DVec2| {
                let sides = [(b - a).perp_dot(p - a), (c - b).perp_dot(p - b), (a - c).perp_dot(p - c)];
                // Another corner may be at the same place, where two parts of the outline touch.
                sides.iter().all(|side| *side >= 0.0) && p != a && p != b && p != c
            };
            !left.iter().any(|i| !ear.contains(i) && holds(points[*i]))
        };
        let convex = (0..left.len()).find(|i| turn(around(*i)) > 0.0 && is_free(around(*i)));
        // What is left may have corners in a line.
        let ear = convex.or_else(|| (0..left.len()).find(|i| turn(around(*i)).abs() <= 0.0))?;
        triangles.push(around(ear));
        left.remove(ear);
    }
    triangles.push([left[0], left[1], left[2]]);
    Some(triangles)
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
    fn every_corner_of_a_comb_is_used_and_its_area_kept() {
        // No corner sees all of it; two of its corners lie in a line with their neighbours.
        let comb = "0 0 2 0 5 0 5 3 4 3 4 1 3 1 3 3 2 3 2 1 1 1 1 2 1 3 0 3";
        let numbers: Vec<f32> = comb.split(' ').map(|word| word.parse().unwrap()).collect();
        // Upright, to see that the plane is found.
        let vertices: Vec<Vec3> =
            numbers.as_chunks().0.iter().map(|&[x, y]| Vec3::new(x, y, x - y)).collect();
        let all: Vec<u32> = (0..vertices.len() as u32).collect();
        for start in 0..all.len() {
            let corners = [&all[start..], &all[..start]].concat();
            let triangles = cut_polygon(&vertices, &corners).unwrap();
            assert_eq!(triangles.len(), all.len() - 2);
            let areas = triangles.iter().map(|t| {
                let [a, b, c] = t.map(|i| vertices[i as usize].truncate());
                (b - a).perp_dot(c - a) / 2.0
            });
            let areas: Vec<f32> = areas.collect();
            assert!(areas.iter().all(|area| *area >= 0.0) && (areas.iter().sum::<f32>() - 11.0).abs() < 1e-5);
        }
        let crossing = [[0.0, 0.0], [3.0, 0.0], [0.0, 2.0], [2.0, 2.0], [1.0, -1.0], [1.5, 3.0], [0.2, 0.1]];
        let crossing: Vec<Vec3> = crossing.iter().map(|[x, y]| Vec3::new(*x, *y, 0.0)).collect();
        // Cut somehow or refused, but not for ever.
        let _ = cut_polygon(&crossing, &[0, 1, 2, 3, 4, 5, 6]);
    }

    #[test]
    fn a_polygon_of_very_many_corners_takes_no_time_without_end() {
        // A bar with many corners along its bottom, one of which may be high up: then that one alone sees all of it.
        let bar = |count: u32, height: f32| {
            let middle = count / 2;
            let bottom =
                (0..count - 2).map(|i| Vec3::new(i as f32, if i == middle { height } else { 0.0 }, 0.0));
            let top = [Vec3::new((count - 3) as f32, 10.0, 0.0), Vec3::Y * 10.0];
            let corners: Vec<u32> = (0..count).collect();
            cut_polygon(&bottom.chain(top).collect::<Vec<_>>(), &corners)
        };
        assert_eq!(bar(1 << 20, 0.0).unwrap().len(), (1 << 20) - 2);
        assert_eq!(bar(4096, 5.0).unwrap().len(), 4094);
        assert!(bar(1 << 20, 5.0).unwrap_err().contains("triangulate the mesh"));
    }

    #[test]
    fn strips_and_fans_keep_the_winding() {
        assert_eq!(strip(&[0, 1, 2, 3, 4]), [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
        // A doubled corner leads on without a triangle.
        assert_eq!(strip(&[0, 1, 2, 2, 3]), [[0, 1, 2]]);
        assert_eq!(fan(&[0, 1, 2, 3]), [[0, 1, 2], [0, 2, 3]]);
        assert!(strip(&[0, 1]).is_empty() && fan(&[0, 1]).is_empty() && fan(&[]).is_empty());
    }
}
