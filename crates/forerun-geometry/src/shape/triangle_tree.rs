//! Triangle tree: a hierarchy of boxes over the triangles of a mesh, so that a query need not look at all of them.

use crate::{Aabb, Vec3};

/// Triangles in a leaf.
const LEAF: usize = 4;
/// Deeper than any tree of 2³² triangles split in halves.
const DEEPEST: usize = 48;

/// Boxes over triangles, split at the median along the longest side.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TriangleTree {
    /// Each inner node is followed by its first child.
    nodes: Vec<Node>,
    /// Indices of triangles; a leaf has a run of them.
    order: Vec<u32>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Node {
    bounds: Aabb,
    /// Of a leaf the first of its run in the order, of an inner node its second child.
    link: u32,
    /// Length of a leaf's run; 0 for an inner node.
    count: u32,
}

impl TriangleTree {
    pub(super) fn new(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let bounds: Vec<Aabb> =
            triangles.iter().map(|t| Aabb::around(t.iter().map(|&i| vertices[i as usize]))).collect();
        let mut tree = TriangleTree { nodes: Vec::new(), order: (0..triangles.len() as u32).collect() };
        tree.build(&bounds, 0, triangles.len());
        tree
    }

    /// Builds the node over `order[from..to]` and all below it; returns its index.
    fn build(&mut self, bounds: &[Aabb], from: usize, to: usize) -> u32 {
        let run = &mut self.order[from..to];
        let nothing = Aabb::around(std::iter::empty());
        let around = run.iter().fold(nothing, |all, &t| all.union(&bounds[t as usize]));
        let index = self.nodes.len();
        self.nodes.push(Node { bounds: around, link: from as u32, count: (to - from) as u32 });
        if to - from <= LEAF {
            return index as u32;
        }
        let middles = Aabb::around(run.iter().map(|&t| bounds[t as usize].centre()));
        let size = middles.half_extents();
        let axis = if size.x >= size.y.max(size.z) {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let key = |t: u32| bounds[t as usize].centre()[axis];
        // The index as second key makes the order total: the tree is the same on every platform.
        let half = run.len() / 2;
        run.select_nth_unstable_by(half, |&a, &b| key(a).total_cmp(&key(b)).then(a.cmp(&b)));
        self.build(bounds, from, from + half);
        let second = self.build(bounds, from + half, to);
        self.nodes[index] = Node { bounds: around, link: second, count: 0 };
        index as u32
    }

    /// Calls `visit` with every triangle whose leaf overlaps the box, in the order of the tree.
    pub(super) fn near(&self, aabb: &Aabb, mut visit: impl FnMut(u32)) {
        self.walk(
            |bounds| if bounds.overlaps(aabb) { Some(0.0) } else { None },
            |triangle| {
                visit(triangle);
                f64::INFINITY
            },
            f64::INFINITY,
        );
    }

    /// Walks the tree, nearer child first. `distance` gives how far away a box is (`None`: not in the way), `visit` the new limit beyond
    /// which boxes need not be entered.
    pub(crate) fn walk(
        &self,
        distance: impl Fn(&Aabb) -> Option<f64>,
        mut visit: impl FnMut(u32) -> f64,
        mut limit: f64,
    ) {
        let mut stack = [(0, 0.0); DEEPEST];
        let mut height = 0;
        if let Some(d) = distance(&self.nodes[0].bounds) {
            stack[0] = (0, d);
            height = 1;
        }
        while height > 0 {
            height -= 1;
            let (index, d) = stack[height];
            if d > limit {
                continue;
            }
            let node = self.nodes[index as usize];
            if node.count > 0 {
                for &triangle in &self.order[node.link as usize..][..node.count as usize] {
                    limit = limit.min(visit(triangle));
                }
                continue;
            }
            let (first, second) = (index + 1, node.link);
            let to_first = distance(&self.nodes[first as usize].bounds);
            let to_second = distance(&self.nodes[second as usize].bounds);
            let mut push = |child: u32, distance: Option<f64>| {
                if let Some(d) = distance {
                    stack[height] = (child, d);
                    height += 1;
                }
            };
            // The nearer one last, to be taken up first.
            if matches!((to_first, to_second), (Some(a), Some(b)) if a <= b) {
                push(second, to_second);
                push(first, to_first);
            } else {
                push(first, to_first);
                push(second, to_second);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::mesh_make;
    use super::*;

    #[test]
    fn near_finds_every_triangle_that_overlaps() {
        let mesh = mesh_make::torus(1.0, 0.3, 40, 20).unwrap();
        let tree = TriangleTree::new(&mesh.vertices, &mesh.triangles);
        let mut visited_in_all = 0;
        for i in 0..200_u32 {
            let at = |k: u32| (i * 7919 + k * 104_729) % 1000;
            let centre = Vec3::new(at(1) as f32, at(2) as f32, at(3) as f32) / 500.0 - Vec3::ONE;
            let query = Aabb::from_centre(centre, Vec3::splat(0.1));
            let mut found = Vec::new();
            tree.near(&query, |t| found.push(t));
            visited_in_all += found.len();
            for t in 0..mesh.triangles.len() {
                let overlaps = Aabb::around(mesh.corners(t).into_iter()).overlaps(&query);
                assert!(!overlaps || found.contains(&(t as u32)));
            }
            let visited = found.len();
            found.sort_unstable();
            found.dedup();
            assert_eq!(found.len(), visited);
        }
        assert!(
            visited_in_all < 200 * mesh.triangles.len() / 20,
            "{visited_in_all}: the tree prunes nothing"
        );
    }
}
