//! Surface net: the surface where a function is 0, as quads between the cells of a grid that it passes through (Gibson 1998).
//!
//! Promise: closed and wound outwards if the surface does not touch the sides of the grid; every edge has two triangles if no cell has two
//! separate pieces of it, which holds where the surface is smooth on the scale of a cell.

use std::collections::BTreeMap;

use glam::DVec3;

use super::surface::Surface;
use crate::shape::TriangleList;

/// A cubic grid of cubic cells.
pub(super) struct Grid {
    /// Its lowest corner. Metres.
    pub(super) origin: DVec3,
    /// Side of a cell. Metres.
    pub(super) cell: f64,
    /// Cells along each side.
    pub(super) cells: u32,
}

/// Newton steps that bring a vertex onto the surface.
const NEWTON_STEPS: u32 = 4;
/// Offset for the slope of the function, in cells.
const SLOPE_CELLS: f64 = 1e-3;

type Node = [u32; 3];

/// The surface of where `value` is below 0.
pub(super) fn surface_net(grid: &Grid, value: impl Fn(DVec3) -> f64) -> TriangleList {
    let side = grid.cells + 1;
    let place = |node: Node| grid.origin + DVec3::from_array(node.map(f64::from)) * grid.cell;
    let index = |[x, y, z]: Node| ((z * side + y) * side + x) as usize;
    let nodes = (0..side).flat_map(|z| (0..side).flat_map(move |y| (0..side).map(move |x| [x, y, z])));
    let values: Vec<f64> = nodes.clone().map(|node| value(place(node))).collect();
    let mut net = Net { crossings: BTreeMap::new(), edges: Vec::new() };
    for node in nodes {
        for axis in 0..3 {
            if node[axis] == grid.cells {
                continue;
            }
            let mut next = node;
            next[axis] += 1;
            let (a, b) = (values[index(node)], values[index(next)]);
            if (a < 0.0) != (b < 0.0) {
                net.cross(node, axis, (a < 0.0, place(node).lerp(place(next), a / (a - b))));
            }
        }
    }
    let slope = SLOPE_CELLS * grid.cell;
    net.into_triangles(|middle| {
        let mut point = middle;
        for _ in 0..NEWTON_STEPS {
            let along = |axis: DVec3| value(point + axis * slope) - value(point - axis * slope);
            let gradient = DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z)) / (2.0 * slope);
            point -= gradient * (value(point) / gradient.length_squared().max(f64::MIN_POSITIVE));
        }
        // Where the function has a kink Newton may run away.
        if point.distance(middle) < grid.cell { point } else { middle }
    })
}

/// What passes through the surface.
struct Net {
    /// Of each cell that the surface passes through: the sum of its crossings with edges, and their number.
    crossings: BTreeMap<Node, (DVec3, f64)>,
    /// The four cells around each crossed edge, counter-clockwise seen from outside.
    edges: Vec<[Node; 4]>,
}

impl Net {
    /// The edge from `node` along `axis` is crossed; `begins_inside` and where.
    fn cross(&mut self, node: Node, axis: usize, (begins_inside, at): (bool, DVec3)) {
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        // Counter-clockwise about the axis.
        let mut around = [[1, 1], [0, 1], [0, 0], [1, 0]].map(|[back_u, back_v]| {
            let mut cell = node;
            cell[u] = cell[u].saturating_sub(back_u);
            cell[v] = cell[v].saturating_sub(back_v);
            cell
        });
        for cell in around {
            let (sum, number) = self.crossings.entry(cell).or_insert((DVec3::ZERO, 0.0));
            *sum += at;
            *number += 1.0;
        }
        if !begins_inside {
            around.reverse();
        }
        self.edges.push(around);
    }

    fn into_triangles(self, settle: impl Fn(DVec3) -> DVec3) -> TriangleList {
        let mut surface = Surface::default();
        let vertex = |(cell, (sum, number)): (&Node, &(DVec3, f64))| {
            let settled = settle(*sum / *number).as_vec3();
            (*cell, (surface.vertex(settled), settled))
        };
        let vertices: BTreeMap<Node, _> = self.crossings.iter().map(vertex).collect();
        for cells in self.edges {
            let [a, b, c, d] = cells.map(|cell| vertices[&cell]);
            // Along the shorter diagonal.
            if a.1.distance_squared(c.1) <= b.1.distance_squared(d.1) {
                surface.quad([a.0, b.0, c.0, d.0]);
            } else {
                surface.quad([b.0, c.0, d.0, a.0]);
            }
        }
        surface.finish()
    }
}
