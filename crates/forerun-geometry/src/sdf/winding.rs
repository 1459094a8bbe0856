//! Winding: how often a surface goes round a point, quickly: 1 inside, 0 outside, 2 where two shells overlap.
//!
//! Jacobson, Kavan, Sorkine-Hornung, *Robust Inside-Outside Segmentation using Generalized Winding Numbers* (2013); summed as in Barill,
//! Dickson, Schmidt, Levin, Jacobson, *Fast Winding Numbers for Soups and Clouds* (2018): groups of triangles that are far away count as
//! a dipole and the first moment about it.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use super::pseudo_normals::corners;
use crate::shape::{Mesh, TreeNode};

/// Groups count as one from this many of their radii on: errors stay below a twentieth.
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
        let mut far = 0.0;
        let mut near = HalfTurns::NONE;
        self.mesh.tree().descend(
            |node| {
                let group = &self.groups[node];
                let away = group.centre - point;
                let is_far = away.length_squared() > (FAR * group.radius) * (FAR * group.radius);
                if is_far {
                    far += group.solid_angle(away);
                }
                !is_far
            },
            |triangles| {
                for t in triangles {
                    near.add(half_solid_angle(corners(self.mesh, *t as usize), point));
                }
            },
        );
        (2.0 * near.angle() + far) / (4.0 * PI)
    }
}

/// A sum of angles between -π and π, each given by its tangent's opposite and adjacent side: one arc tangent for all.
struct HalfTurns {
    /// A vector of this direction, and the number of whole turns beyond it.
    opposite: f64,
    adjacent: f64,
    turns: f64,
}

impl HalfTurns {
    const NONE: HalfTurns = HalfTurns { opposite: 0.0, adjacent: 1.0, turns: 0.0 };

    fn add(&mut self, [opposite, adjacent]: [f64; 2]) {
        let length = (opposite * opposite + adjacent * adjacent).sqrt();
        // On the triangle itself there is no angle to speak of.
        if length <= 0.0 {
            return;
        }
        let (sine, cosine) = (opposite / length, adjacent / length);
        let turned = self.opposite * cosine + self.adjacent * sine;
        // From above past -π, or from below past π.
        if sine >= 0.0 && self.opposite >= 0.0 && turned < 0.0 {
            self.turns += 1.0;
        } else if sine < 0.0 && self.opposite < 0.0 && turned >= 0.0 {
            self.turns -= 1.0;
        }
        self.adjacent = self.adjacent * cosine - self.opposite * sine;
        self.opposite = turned;
    }

    fn angle(&self) -> f64 {
        libm::atan2(self.opposite, self.adjacent) + 2.0 * PI * self.turns
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

/// Half the solid angle of a triangle seen from a point, above 0 from behind, as opposite and adjacent side. Van Oosterom, Strackee,
/// *The Solid Angle of a Plane Triangle* (1983).
fn half_solid_angle(triangle: [DVec3; 3], point: DVec3) -> [f64; 2] {
    let [a, b, c] = triangle.map(|v| v - point);
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let volume = a.dot(b.cross(c));
    [volume, la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;
    use crate::shape::mesh_make;

    /// The sum over all triangles, angle by angle.
    fn brute_force(mesh: &Mesh, point: DVec3) -> f64 {
        let angle = |t| {
            let [opposite, adjacent] = half_solid_angle(corners(mesh, t), point);
            2.0 * libm::atan2(opposite, adjacent)
        };
        (0..mesh.triangles.len()).map(angle).sum::<f64>() / (4.0 * PI)
    }

    #[test]
    fn the_quick_sum_is_the_sum() {
        let whole = mesh_make::torus(0.5, 0.2, 60, 30).expect("a closed mesh");
        // Twice over, so that it winds round some points twice; and with a third left out.
        let twice = whole.triangles.iter().chain(&whole.triangles).copied().collect();
        let holed = whole.triangles.iter().copied().step_by(3).chain(whole.triangles[..900].to_vec());
        let meshes = [
            Mesh::assemble(whole.vertices.clone(), twice),
            Mesh::assemble(whole.vertices.clone(), holed.collect()),
            whole,
        ];
        for mesh in &meshes {
            let winding = Winding::new(mesh);
            let (mut largest, mut seen) = (0.0_f64, [0; 4]);
            for i in 0..1500_u32 {
                let part = |k: u32| ((i * 7919 + i * i % 613 * k * 104_729) % 2003) as f32 / 2003.0 - 0.5;
                let point = Vec3::new(1.6 * part(1), 0.6 * part(2), 1.6 * part(3)).as_dvec3();
                let (quick, sum) = (winding.at(point), brute_force(mesh, point));
                largest = largest.max((quick - sum).abs());
                seen[(sum + 0.5).clamp(0.0, 3.0) as usize] += 1;
            }
            assert!(largest < 0.05, "{largest} off");
            assert!(seen.iter().filter(|n| **n > 100).count() >= 2, "{seen:?}");
        }
    }

    #[test]
    fn angles_add_up_past_whole_turns() {
        let mut turns = HalfTurns::NONE;
        let mut sum = 0.0;
        for i in 0..200_u32 {
            let angle = (f64::from(i * 7919 % 613) / 306.5 - 1.0) * 3.1 + if i < 100 { 0.9 } else { -1.0 };
            let angle = angle.clamp(-3.1, 3.1);
            turns.add([2.0 * libm::sin(angle), 2.0 * libm::cos(angle)]);
            sum += angle;
            assert!((turns.angle() - sum).abs() < 1e-9, "{} instead of {sum}", turns.angle());
        }
    }
}
