//! Mending and checking how the triangles of a mesh hang together.

use std::collections::BTreeMap;

use glam::DVec3;

use super::roots::Roots;
use super::{Mesh, MeshError};
use crate::Vec3;
use crate::sdf::mend::Covers;
use crate::sdf::triangle::{self, corners, corners_of};
use crate::sdf::winding::winding;

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
    a != b && b != c && c != a && face_vector(vertices, [a, b, c]).length_squared() <= 0.0
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

/// An edge of a triangle: lower vertex, higher vertex, triangle, whether passed upwards.
type Side = (u32, u32, u32, bool);

/// The sides of all triangles, sorted: each edge is a run.
fn sides(triangles: &[[u32; 3]]) -> Vec<Side> {
    let mut sides: Vec<Side> = (0_u32..)
        .zip(triangles)
        .flat_map(|(t, &[a, b, c])| [(a, b, t), (b, c, t), (c, a, t)])
        .map(|(a, b, t)| (a.min(b), a.max(b), t, a < b))
        .collect();
    sides.sort_unstable();
    sides
}

/// Turns triangles so that neighbours across edges of two triangles face the same way, as most of the area of each part does. Returns how
/// many were turned, and of each triangle the part that it hangs together with.
pub(super) fn turn_to_neighbours(vertices: &[Vec3], triangles: &mut [[u32; 3]]) -> (u32, Vec<u32>) {
    const NONE: u32 = u32::MAX;
    let mut neighbours: Vec<Vec<(u32, bool)>> = vec![Vec::new(); triangles.len()];
    for run in sides(triangles).chunk_by(|e, f| (e.0, e.1) == (f.0, f.1)) {
        if let [a, b] = run {
            let twisted = a.3 == b.3;
            neighbours[a.2 as usize].push((b.2, twisted));
            neighbours[b.2 as usize].push((a.2, twisted));
        }
    }
    let mut parts = vec![NONE; triangles.len()];
    let mut turn = vec![false; triangles.len()];
    let (mut count, mut turned) = (0, 0);
    for first in 0..triangles.len() {
        if parts[first] != NONE {
            continue;
        }
        parts[first] = count;
        let mut part = vec![first];
        let mut next = 0;
        while next < part.len() {
            let triangle = part[next];
            next += 1;
            for (neighbour, twisted) in neighbours[triangle].iter().map(|(n, t)| (*n as usize, *t)) {
                if parts[neighbour] == NONE {
                    parts[neighbour] = count;
                    turn[neighbour] = turn[triangle] ^ twisted;
                    part.push(neighbour);
                }
            }
        }
        count += 1;
        let area = |turned: bool| {
            let those = part.iter().filter(|t| turn[**t] == turned);
            those.map(|t| face_vector(vertices, triangles[*t]).length()).sum::<f64>()
        };
        let others = area(true) > area(false);
        for t in part.into_iter().filter(|t| turn[*t] != others) {
            triangles[t].swap(1, 2);
            turned += 1;
        }
    }
    (turned, parts)
}

/// Triangles that close a mesh: for each edge that is passed more often one way than the other, between it and the middle of its hole.
pub(super) fn covers(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Covers {
    let mut rims: Vec<[u32; 2]> = Vec::new();
    for run in sides(triangles).chunk_by(|e, f| (e.0, e.1) == (f.0, f.1)) {
        let (low, high) = (run[0].0, run[0].1);
        let up = run.iter().filter(|side| side.3).count();
        let down = run.len() - up;
        rims.extend((down..up).map(|_| [high, low]));
        rims.extend((up..down).map(|_| [low, high]));
    }
    // Rims that share a vertex are of one hole: it is named by a vertex.
    let mut holes = Roots::new(vertices.len());
    for [a, b] in &rims {
        holes.join(*a, *b);
    }
    let mut middles: BTreeMap<u32, (DVec3, f64, u32)> = BTreeMap::new();
    for rim in &rims {
        let [a, b] = rim.map(|v| vertices[v as usize].as_dvec3());
        let next = vertices.len() as u32 + middles.len() as u32;
        let middle = middles.entry(holes.root(rim[0])).or_insert((DVec3::ZERO, 0.0, next));
        let length = a.distance(b);
        middle.0 += (a + b) * (0.5 * length);
        middle.1 += length;
    }
    let triangles = rims.iter().map(|[a, b]| [*a, *b, middles[&holes.root(*a)].2]).collect();
    let mut apexes = vec![Vec3::ZERO; middles.len()];
    for (sum, length, index) in middles.values() {
        apexes[*index as usize - vertices.len()] = (sum / length).as_vec3();
    }
    Covers { apexes, triangles }
}

impl Mesh {
    /// How many parts of the surface do not hang together, not even by a vertex.
    #[must_use]
    pub fn shells(&self) -> usize {
        let mut parts = Roots::new(self.vertices.len());
        let mut joined = 0;
        for [a, b, c] in &self.triangles {
            joined += usize::from(parts.join(*a, *b)) + usize::from(parts.join(*a, *c));
        }
        self.vertices.len() - joined
    }
}

/// Number of edges of more than two triangles, and the vertices of the first.
pub(super) fn crowded_edges(triangles: &[[u32; 3]]) -> (u32, Option<[u32; 2]>) {
    let sides = sides(triangles);
    let mut crowded = sides.chunk_by(|e, f| (e.0, e.1) == (f.0, f.1)).filter(|run| run.len() > 2);
    let first = crowded.next().map(|run| [run[0].0, run[0].1]);
    (u32::from(first.is_some()) + crowded.count() as u32, first)
}

/// Normal of a triangle, twice as long as its area.
fn face_vector(vertices: &[Vec3], triangle: [u32; 3]) -> DVec3 {
    triangle::face_vector(corners_of(vertices, triangle))
}

/// Turns whole parts that face inwards without being a cavity in others. `parts`: of each triangle. Returns how many triangles.
pub(super) fn turn_shells(vertices: &[Vec3], triangles: &mut [[u32; 3]], parts: &[u32]) -> u32 {
    let volumes = part_volumes(vertices, triangles, parts);
    if volumes.iter().all(|volume| *volume >= 0.0) {
        return 0;
    }
    // All parts faced outwards: then they go round a point as often as it is inside of parts.
    let outward = (triangles.iter().zip(parts))
        .map(|(&[a, b, c], part)| if volumes[*part as usize] < 0.0 { [a, c, b] } else { [a, b, c] });
    let mut outward: Vec<[u32; 3]> = outward.collect();
    let covers = covers(vertices, &outward);
    outward.extend(covers.triangles);
    let outward = Mesh::assemble(vertices.iter().chain(&covers.apexes).copied().collect(), outward);
    let mut turn: Vec<Option<bool>> = volumes.iter().map(|v| (*v >= 0.0).then_some(false)).collect();
    let mut turned = 0;
    for (t, part) in parts.iter().enumerate() {
        let turn = turn[*part as usize].get_or_insert_with(|| {
            let [a, b, c] = corners(&outward, t);
            let vector = triangle::face_vector([a, b, c]);
            let beside = vector.normalize_or_zero() * (1e-3 * vector.length().sqrt());
            winding(&outward, (a + b + c) / 3.0 + beside).rem_euclid(2) == 0
        });
        if *turn {
            triangles[t].swap(1, 2);
            turned += 1;
        }
    }
    turned
}

/// Signed volume of each part, holes covered from its middle. Cubic metres.
fn part_volumes(vertices: &[Vec3], triangles: &[[u32; 3]], parts: &[u32]) -> Vec<f64> {
    let count = parts.iter().max().map_or(0, |last| *last as usize + 1);
    let mut middles = vec![(DVec3::ZERO, 0.0); count];
    for (triangle, part) in triangles.iter().zip(parts) {
        let area = face_vector(vertices, *triangle).length();
        let [a, b, c] = corners_of(vertices, *triangle);
        let middle = &mut middles[*part as usize];
        middle.0 += (a + b + c) * (area / 3.0);
        middle.1 += area;
    }
    let mut volumes = vec![0.0; count];
    for (triangle, part) in triangles.iter().zip(parts) {
        let (sum, area) = middles[*part as usize];
        let [a, b, c] = triangle.map(|i| vertices[i as usize].as_dvec3() - sum / area);
        volumes[*part as usize] += a.dot(b.cross(c)) / 6.0;
    }
    volumes
}

/// Signed volume (m³, by the divergence theorem) and area (m²).
pub(super) fn volume_and_area(vertices: &[Vec3], triangles: &[[u32; 3]]) -> (f64, f64) {
    let origin = vertices[triangles[0][0] as usize].as_dvec3();
    let (mut volume, mut area) = (0.0, 0.0);
    for triangle in triangles {
        let [a, b, c]: [DVec3; 3] = triangle.map(|i| vertices[i as usize].as_dvec3() - origin);
        volume += a.dot(b.cross(c)) / 6.0;
        area += 0.5 * triangle::face_vector([a, b, c]).length();
    }
    (volume, area)
}
