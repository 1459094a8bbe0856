//! Winding: how often a surface goes round a point, quickly: 1 inside, 0 outside, 2 where two shells overlap.
//!
//! Jacobson, Kavan, Sorkine-Hornung, *Robust Inside-Outside Segmentation using Generalized Winding Numbers* (2013); summed as in Barill,
//! Dickson, Schmidt, Levin, Jacobson, *Fast Winding Numbers for Soups and Clouds* (2018): groups of triangles that are far away count as
//! a dipole and the first moment about it.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use super::pseudo_normals::corners;
use crate::shape::{Mesh, TreeNode};

/// Groups count as one from this many of their radii on: errors stay below a hundredth.
const FAR: f64 = 2.0;

/// The winding number of the triangles of a mesh.
pub(crate) struct Winding<'a> {
    mesh: &'a Mesh,
    /// One for each node of the mesh's tree.
    groups: Vec<Group>,
}

/// What triangles look like from far away.
#[derive(Clone, Copy, Default)]
struct Group {
    /// Sum of the areas. Square metres.
    area: f64,
    /// Mean position, weighted by area. Metres.
    centre: DVec3,
    /// No point of the triangles is farther from the centre. Metres.
    radius: f64,
    /// Sum of the normals, as long as the areas: the dipole.
    normal: DVec3,
    /// The integral of (x - centre) nᵀ over the triangles.
    moment: DMat3,
}

impl<'a> Winding<'a> {
    /// Sums up the triangles of each node of the mesh's tree.
    pub(crate) fn new(mesh: &'a Mesh) -> Winding<'a> {
        let tree = mesh.tree();
        let mut groups = vec![Group::default(); tree.len()];
        // Children come after their parents.
        for index in (0..tree.len()).rev() {
            let mut group = match tree.node(index) {
                TreeNode::Leaf(triangles) => {
                    Group::sum(triangles.iter().map(|t| Group::of(corners(mesh, *t as usize))))
                }
                TreeNode::Inner(children) => Group::sum(children.into_iter().map(|c| groups[c])),
            };
            let bounds = tree.bounds(index);
            let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
            group.radius = (group.centre - low).max(high - group.centre).length();
            groups[index] = group;
        }
        Winding { mesh, groups }
    }

    /// The winding number at a point that is not on a triangle. Dimensionless.
    pub(crate) fn at(&self, point: DVec3) -> f64 {
        let mut angle = 0.0;
        self.mesh.tree().descend(
            |node| {
                let group = &self.groups[node];
                let away = group.centre - point;
                let is_far = away.length_squared() > (FAR * group.radius) * (FAR * group.radius);
                if is_far {
                    angle += group.solid_angle(away);
                }
                !is_far
            },
            |triangles| {
                triangles.iter().map(|t| solid_angle(corners(self.mesh, *t as usize), point)).sum::<f64>()
            },
        ) / (4.0 * PI)
            + angle / (4.0 * PI)
    }
}

impl Group {
    fn of([a, b, c]: [DVec3; 3]) -> Group {
        let normal = (b - a).cross(c - a) * 0.5;
        let centre = (a + b + c) / 3.0;
        Group { area: normal.length(), centre, radius: 0.0, normal, moment: DMat3::ZERO }
    }

    fn sum(parts: impl Iterator<Item = Group> + Clone) -> Group {
        let area: f64 = parts.clone().map(|p| p.area).sum();
        let weighted: DVec3 = parts.clone().map(|p| p.centre * p.area).sum();
        let Some(first) = parts.clone().next() else { return Group::default() };
        let centre = if area > 0.0 { weighted / area } else { first.centre };
        let moved = |p: Group| {
            let (d, n) = (p.centre - centre, p.normal);
            p.moment + DMat3::from_cols(d * n.x, d * n.y, d * n.z)
        };
        Group {
            area,
            centre,
            radius: 0.0,
            normal: parts.clone().map(|p| p.normal).sum(),
            moment: parts.map(moved).sum(),
        }
    }

    /// About the solid angle of the triangles, seen from a point from which their centre is `away`.
    ///
    /// With r = x - q, n · r / |r|³ is expanded about the centre: n · r₀ / |r₀|³ + (n · d - 3 (n · r₀)(d · r₀) / |r₀|²) / |r₀|³.
    fn solid_angle(&self, away: DVec3) -> f64 {
        let inverse_squared = 1.0 / away.length_squared();
        let inverse_cubed = inverse_squared * inverse_squared.sqrt();
        let m = &self.moment;
        let trace = m.x_axis.x + m.y_axis.y + m.z_axis.z;
        // m = ∫ d nᵀ: r₀ᵀ m r₀ = ∫ (d · r₀)(n · r₀).
        let stretched = away.dot(*m * away) * inverse_squared;
        (self.normal.dot(away) + trace - 3.0 * stretched) * inverse_cubed
    }
}

/// The solid angle of a triangle seen from a point, above 0 from behind. Van Oosterom, Strackee, *The Solid Angle of a Plane Triangle*
/// (1983).
pub(crate) fn solid_angle(triangle: [DVec3; 3], point: DVec3) -> f64 {
    let [a, b, c] = triangle.map(|v| v - point);
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let volume = a.dot(b.cross(c));
    let base = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * libm::atan2(volume, base)
}
