//! From the triangles of a hull to its faces: coplanar neighbours merged into polygons.
//!
//! Contact wants a box to have six faces, not twelve, also where rounding has moved its corners off their planes by a few bits.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::Vec3;

/// Vertex indices of each face, counter-clockwise seen from outside. Vertices within a merged face or in the middle of an edge
/// appear in none.
///
/// A triangle joins a neighbour's face when its corners are within `tolerance` (metres) of the plane of the face's largest triangle.
pub(super) fn merge_faces(points: &[Vec3], triangles: &[[u32; 3]], tolerance: f64) -> Vec<Vec<u32>> {
    let neighbours = Neighbours::new(triangles);
    let planes: Vec<Plane> = triangles.iter().map(|t| Plane::of(points, *t)).collect();
    let mut order: Vec<usize> = (0..triangles.len()).collect();
    order.sort_by(|&i, &j| planes[j].double_area.total_cmp(&planes[i].double_area).then(i.cmp(&j)));

    let mut taken = vec![false; triangles.len()];
    let mut faces = Vec::new();
    for seed in order {
        if taken[seed] {
            continue;
        }
        let joins = |t: usize| {
            planes[t].normal.dot(planes[seed].normal) > 0.0
                && triangles[t].iter().all(|&v| planes[seed].distance(points, v).abs() <= tolerance)
        };
        let group = neighbours.flood(triangles, seed, |t| !taken[t] && joins(t));
        // A group that is no disc would have a torn rim; then the triangle stays alone.
        let (group, rim) = match rim(triangles, &group) {
            Some(rim) => (group, rim),
            None => (vec![seed], triangles[seed].to_vec()),
        };
        for t in group {
            taken[t] = true;
        }
        faces.push(rim);
    }
    drop_straight_vertices(&mut faces);
    faces
}

struct Plane {
    normal: DVec3,
    point: DVec3,
    double_area: f64,
}

impl Plane {
    fn of(points: &[Vec3], [a, b, c]: [u32; 3]) -> Plane {
        let [a, b, c] = [a, b, c].map(|i| points[i as usize].as_dvec3());
        let cross = (b - a).cross(c - a);
        Plane { normal: cross.normalize_or_zero(), point: a, double_area: cross.length() }
    }

    fn distance(&self, points: &[Vec3], vertex: u32) -> f64 {
        self.normal.dot(points[vertex as usize].as_dvec3() - self.point)
    }
}

/// Which triangle has which directed edge.
struct Neighbours(BTreeMap<(u32, u32), usize>);

impl Neighbours {
    fn new(triangles: &[[u32; 3]]) -> Self {
        let edges = triangles.iter().enumerate();
        Neighbours(edges.flat_map(|(t, &[a, b, c])| [((a, b), t), ((b, c), t), ((c, a), t)]).collect())
    }

    /// The triangles that can be reached from `seed` over triangles that `joins` accepts; the seed is one of them.
    fn flood(&self, triangles: &[[u32; 3]], seed: usize, joins: impl Fn(usize) -> bool) -> Vec<usize> {
        let mut group = vec![seed];
        let mut next = 0;
        while next < group.len() {
            let [a, b, c] = triangles[group[next]];
            next += 1;
            for edge in [(b, a), (c, b), (a, c)] {
                if let Some(&t) = self.0.get(&edge)
                    && !group.contains(&t)
                    && joins(t)
                {
                    group.push(t);
                }
            }
        }
        group
    }
}

/// The outline of a group of triangles, if it is a single loop that passes each vertex once.
fn rim(triangles: &[[u32; 3]], group: &[usize]) -> Option<Vec<u32>> {
    let mut edges: Vec<(u32, u32)> = group
        .iter()
        .flat_map(|&t| {
            let [a, b, c] = triangles[t];
            [(a, b), (b, c), (c, a)]
        })
        .collect();
    edges.sort_unstable();
    let rim: Vec<(u32, u32)> =
        edges.iter().copied().filter(|&(a, b)| edges.binary_search(&(b, a)).is_err()).collect();
    let start = rim.first()?.0;
    let mut outline = Vec::with_capacity(rim.len());
    let mut at = start;
    for _ in 0..rim.len() {
        outline.push(at);
        let from = rim.partition_point(|edge| edge.0 < at);
        let ways = rim[from..].iter().take_while(|edge| edge.0 == at).count();
        if ways != 1 {
            return None;
        }
        at = rim[from].1;
        if at == start {
            break;
        }
    }
    (outline.len() == rim.len() && at == start).then_some(outline)
}

/// Takes vertices with only two faces out of both, and then faces that are left with two vertices: they were slivers along an edge.
fn drop_straight_vertices(faces: &mut Vec<Vec<u32>>) {
    loop {
        let mut uses: BTreeMap<u32, u32> = BTreeMap::new();
        for vertex in faces.iter().flatten() {
            *uses.entry(*vertex).or_default() += 1;
        }
        if uses.values().all(|&count| count >= 3) {
            return;
        }
        for face in faces.iter_mut() {
            face.retain(|vertex| uses[vertex] >= 3);
        }
        faces.retain(|face| face.len() >= 3);
    }
}
