//! Mending and checking how the triangles of a mesh hang together.

use std::collections::BTreeMap;

use glam::DVec3;

use super::MeshError;
use crate::Vec3;

/// How often slivers beside slivers are taken up again.
const SLIVER_ROUNDS: usize = 16;

/// Makes triangles name the first of the vertices at exactly the same position. Returns how many *used* vertices were merged away.
pub(super) fn weld_equal(vertices: &[Vec3], triangles: &mut [[u32; 3]]) -> u32 {
    // Adding 0 makes -0 and +0 one position.
    let key = |i: u32| (vertices[i as usize] + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut order: Vec<u32> = (0..vertices.len() as u32).collect();
    order.sort_by_key(|&i| (key(i), i));
    let mut first_of: Vec<u32> = (0..vertices.len() as u32).collect();
    for pair in order.windows(2) {
        if key(pair[0]) == key(pair[1]) {
            first_of[pair[1] as usize] = first_of[pair[0] as usize];
        }
    }
    let mut merged: Vec<u32> = Vec::new();
    for index in triangles.iter_mut().flatten() {
        let first = first_of[*index as usize];
        if first != *index {
            merged.push(*index);
        }
        *index = first;
    }
    merged.sort_unstable();
    merged.dedup();
    merged.len() as u32
}

/// Replaces triangles whose corners lie in a line: together with the neighbour at the long edge they are cut the other way, into two
/// triangles with an area. Leaving them out would open the mesh. Returns how many.
pub(super) fn recut_slivers(vertices: &[Vec3], triangles: &mut [[u32; 3]]) -> u32 {
    let mut recut = 0;
    for _ in 0..SLIVER_ROUNDS {
        let slivers: Vec<usize> =
            (0..triangles.len()).filter(|&t| is_sliver(vertices, triangles[t])).collect();
        if slivers.is_empty() {
            break;
        }
        let mut owner = BTreeMap::new();
        for (t, &[a, b, c]) in triangles.iter().enumerate() {
            owner.extend([((a, b), t), ((b, c), t), ((c, a), t)]);
        }
        let mut touched = vec![false; triangles.len()];
        for sliver in slivers {
            let [a, b, c] = longest_edge_last(vertices, triangles[sliver]);
            let Some(&neighbour) = owner.get(&(a, c)) else {
                continue;
            };
            let Some(&d) = triangles[neighbour].iter().find(|v| **v != a && **v != c) else {
                continue;
            };
            if d == b || touched[sliver] || touched[neighbour] {
                continue;
            }
            (triangles[sliver], triangles[neighbour]) = ([a, b, d], [b, c, d]);
            (touched[sliver], touched[neighbour]) = (true, true);
            recut += 1;
        }
    }
    recut
}

/// Different corners, all in a line. Exact: of `f32` positions the products that cancel are exact in `f64`.
fn is_sliver(vertices: &[Vec3], [a, b, c]: [u32; 3]) -> bool {
    let [p, q, r] = [a, b, c].map(|i| vertices[i as usize].as_dvec3());
    a != b && b != c && c != a && (q - p).cross(r - p).length_squared() <= 0.0
}

/// The same triangle, turned so that its longest edge leads from the third corner to the first.
fn longest_edge_last(vertices: &[Vec3], triangle: [u32; 3]) -> [u32; 3] {
    let length =
        |i: u32, j: u32| vertices[i as usize].as_dvec3().distance_squared(vertices[j as usize].as_dvec3());
    let [a, b, c] = triangle;
    let (ab, bc, ca) = (length(a, b), length(b, c), length(c, a));
    if ca >= ab && ca >= bc {
        [a, b, c]
    } else if ab >= bc {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// Leaves out triangles without an area. Returns how many.
pub(super) fn drop_degenerate(vertices: &[Vec3], triangles: &mut Vec<[u32; 3]>) -> u32 {
    let before = triangles.len();
    triangles.retain(|&[a, b, c]| a != b && b != c && c != a && !is_sliver(vertices, [a, b, c]));
    (before - triangles.len()) as u32
}

/// The vertices that triangles use, in their order; the triangles name them by their new indices.
pub(super) fn drop_unused(vertices: Vec<Vec3>, triangles: &mut [[u32; 3]]) -> Vec<Vec3> {
    let mut used: Vec<u32> = triangles.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    if used.len() == vertices.len() {
        return vertices;
    }
    let mut new_index = vec![0; vertices.len()];
    for (new, &old) in used.iter().enumerate() {
        new_index[old as usize] = new as u32;
    }
    for index in triangles.iter_mut().flatten() {
        *index = new_index[*index as usize];
    }
    used.iter().map(|&i| vertices[i as usize]).collect()
}

/// Whether every edge belongs to exactly two triangles that pass it in opposite directions.
pub(super) fn check_edges(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Result<(), MeshError> {
    // (lower vertex, higher vertex, whether passed upwards), sorted: each edge is a run.
    let mut edges: Vec<(u32, u32, bool)> = triangles
        .iter()
        .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
        .map(|(a, b)| (a.min(b), a.max(b), a < b))
        .collect();
    edges.sort_unstable();
    let (mut open, mut twisted, mut crowded) = (Vec::new(), Vec::new(), Vec::new());
    for run in edges.chunk_by(|e, f| (e.0, e.1) == (f.0, f.1)) {
        match run {
            [_] => open.push(run),
            [a, b] if a.2 == b.2 => twisted.push(run),
            [_, _] => {}
            _ => crowded.push(run),
        }
    }
    let ends = |run: &[(u32, u32, bool)]| [vertices[run[0].0 as usize], vertices[run[0].1 as usize]];
    if let Some(run) = open.first() {
        return Err(MeshError::Open { edges: open.len(), first: ends(run) });
    }
    if let Some(run) = crowded.first() {
        return Err(MeshError::Crowded { edges: crowded.len(), first: ends(run), triangles: run.len() });
    }
    match twisted.first() {
        Some(run) => Err(MeshError::Twisted { edges: twisted.len(), first: ends(run) }),
        None => Ok(()),
    }
}

/// Signed volume (m³, by the divergence theorem) and area (m²).
pub(super) fn volume_and_area(vertices: &[Vec3], triangles: &[[u32; 3]]) -> (f64, f64) {
    let origin = vertices[triangles[0][0] as usize].as_dvec3();
    let (mut volume, mut area) = (0.0, 0.0);
    for triangle in triangles {
        let [a, b, c]: [DVec3; 3] = triangle.map(|i| vertices[i as usize].as_dvec3() - origin);
        volume += a.dot(b.cross(c)) / 6.0;
        area += (b - a).cross(c - a).length() / 2.0;
    }
    (volume, area)
}
