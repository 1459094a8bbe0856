//! Moments: volume, first and second moments of what a field says is inside.

use glam::{DMat3, DVec3};

use super::Field;

/// Integrals over the inside, at density 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moments {
    /// m³.
    pub(crate) volume: f64,
    /// Integral of x. m⁴.
    pub(crate) first: DVec3,
    /// Integral of x xᵀ. m⁵.
    pub(crate) second: DMat3,
}

/// Parts along the sides of a cell that the surface passes.
const PARTS: u32 = 4;

impl Moments {
    /// Those of the inside of a field. In parts that the surface passes it counts as a plane.
    pub(crate) fn of(field: &Field) -> Moments {
        let mut sum = Moments { volume: 0.0, first: DVec3::ZERO, second: DMat3::ZERO };
        field.each_cell(|low, size, corners| {
            let size = size.as_dvec3();
            let (least, most) =
                corners.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(l, m), d| (l.min(*d), m.max(*d)));
            if most <= 0.0 {
                sum.add(low.as_dvec3() + size * 0.5, size, 1.0);
            } else if least < 0.0 {
                sum.add_parts(low.as_dvec3(), size, &corners.map(f64::from));
            }
        });
        sum
    }

    /// A cell that the surface passes, with the distances at its corners.
    fn add_parts(&mut self, low: DVec3, size: DVec3, corners: &[f64; 8]) {
        // From one side of the cell to the other, on average.
        let slope = |bit: usize| {
            let signed = |k: usize| if k >> bit & 1 == 1 { corners[k] } else { -corners[k] };
            (0..8).map(signed).sum::<f64>() / 4.0
        };
        let part = 1.0 / f64::from(PARTS);
        // How much the distance changes across a part, corner to corner.
        let width = [0, 1, 2].map(|bit| slope(bit).abs() * part).iter().sum::<f64>().max(1e-300);
        for k in 0..PARTS.pow(3) {
            let middle = [k % PARTS, k / PARTS % PARTS, k / (PARTS * PARTS)];
            let at = DVec3::from_array(middle.map(|i| (f64::from(i) + 0.5) * part));
            let mut distance = 0.0;
            for (k, corner) in corners.iter().enumerate() {
                let weight = |bit: usize| if k >> bit & 1 == 1 { at[bit] } else { 1.0 - at[bit] };
                distance += weight(0) * weight(1) * weight(2) * corner;
            }
            let inside = (0.5 - distance / width).clamp(0.0, 1.0);
            if inside > 0.0 {
                self.add(low + at * size, size * part, inside);
            }
        }
    }

    /// A box, of which a part is inside.
    fn add(&mut self, middle: DVec3, size: DVec3, part: f64) {
        let volume = size.x * size.y * size.z * part;
        self.volume += volume;
        self.first += middle * volume;
        let outer = DMat3::from_cols(middle * middle.x, middle * middle.y, middle * middle.z);
        self.second += (outer + DMat3::from_diagonal(size * size / 12.0)) * volume;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::mesh_make;
    use crate::{Shape, Vec3};

    #[test]
    fn what_a_field_holds_weighs_as_much_as_what_the_triangles_bound() {
        let meshes = [
            mesh_make::torus(0.5, 0.2, 48, 16),
            mesh_make::cuboid(Vec3::new(0.5, 0.2, 0.3)),
            mesh_make::ball(0.4, 8),
        ];
        for mesh in meshes.map(|mesh| mesh.expect("a closed mesh")) {
            let moments = Moments::of(mesh.collider().field.as_ref().expect("closed meshes have a field"));
            let truth = Shape::from(mesh).mass_properties(1.0);
            let volume = moments.volume as f32;
            assert!((volume / truth.mass - 1.0).abs() < 0.02, "{volume} instead of {}", truth.mass);
            let centre = (moments.first / moments.volume).as_vec3();
            assert!(centre.distance(truth.centre) < 1e-3, "{centre} instead of {}", truth.centre);
            let m = moments.second;
            let trace = m.x_axis.x + m.y_axis.y + m.z_axis.z;
            let inertia = (DMat3::from_diagonal(DVec3::splat(trace)) - m).x_axis.x as f32;
            let wanted = truth.inertia_tensor().x_axis.x as f32;
            assert!((inertia / wanted - 1.0).abs() < 0.03, "{inertia} instead of {wanted}");
        }
    }
}
