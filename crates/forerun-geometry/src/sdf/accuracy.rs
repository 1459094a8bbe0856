//! Accuracy: how far a field is off the surface that it was baked from.

use glam::DVec3;

use super::Field;
use super::kept::Reader;
use super::triangle::corners;
use crate::shape::Mesh;

/// Points of the surface that are asked, about.
const POINTS: u32 = 4096;

/// How far a field is off at points spread evenly over its surface: between its nodes it rounds edges off and cuts corners.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FieldError {
    /// Distance of points of the surface by the field, where it should be 0. Metres.
    pub distance: Spread,
    /// Angle between the gradient and the normal of the triangle: beside sharp edges up to that between their faces. Radians.
    pub angle: Spread,
}

/// Size of errors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Mean.
    pub mean: f32,
    /// What 95 of 100 are below.
    pub most: f32,
    /// The largest.
    pub max: f32,
}

impl Spread {
    fn of(mut values: Vec<f32>) -> Spread {
        values.sort_by(f32::total_cmp);
        let Some(max) = values.last() else { return Spread::default() };
        let sum: f64 = values.iter().map(|v| f64::from(*v)).sum();
        Spread { mean: (sum / values.len() as f64) as f32, most: values[values.len() * 95 / 100], max: *max }
    }
}

impl FieldError {
    /// Appends what [`FieldError::read`] reads.
    pub(super) fn write(&self, out: &mut Vec<u8>) {
        for spread in [self.distance, self.angle] {
            [spread.mean, spread.most, spread.max].iter().for_each(|x| out.extend(x.to_le_bytes()));
        }
    }

    /// What was written; none where there is too little of it.
    pub(super) fn read(reader: &mut Reader<'_>) -> Option<FieldError> {
        let mut spread = || Some(Spread { mean: reader.f32()?, most: reader.f32()?, max: reader.f32()? });
        Some(FieldError { distance: spread()?, angle: spread()? })
    }

    /// The error of a field on a surface.
    pub(crate) fn measure(field: &Field, surface: &Mesh) -> FieldError {
        let (mut distances, mut angles) = (Vec::new(), Vec::new());
        each_point(surface, |point, normal| {
            let (distance, gradient) = field.distance_and_gradient(point.as_vec3());
            distances.push(distance.abs());
            let gradient = gradient.as_dvec3();
            let angle = libm::atan2(gradient.cross(normal).length(), gradient.dot(normal));
            angles.push(angle as f32);
        });
        FieldError { distance: Spread::of(distances), angle: Spread::of(angles) }
    }
}

/// Calls `visit` with points that stand for equal areas each, and the normals there.
fn each_point(surface: &Mesh, mut visit: impl FnMut(DVec3, DVec3)) {
    surface.each_part(POINTS, |part, t| {
        let [a, b, c] = corners(surface, t as usize);
        // Even in the plane: multiples of the powers of the plastic number's inverse (Roberts, *The Unreasonable Effectiveness of
        // Quasirandom Sequences*, 2018).
        let along = |factor: f64| (0.5 + factor * f64::from(part)).fract();
        let (mut u, mut v) = (along(0.754_877_666_246_692_7), along(0.569_840_290_998_053_3));
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        visit(a + (b - a) * u + (c - a) * v, surface.face_vector(t).normalize());
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;
    use crate::shape::{MeshDraft, MeshOptions, mesh_make};

    #[test]
    fn points_are_spread_by_area() {
        let mesh = mesh_make::cuboid(Vec3::new(1.0, 0.5, 0.25)).expect("a closed mesh");
        let mut on_large = 0;
        let mut count = 0;
        each_point(&mesh, |point, normal| {
            count += 1;
            on_large += u32::from(normal.z.abs() > 0.9);
            assert!((point.abs() - DVec3::new(1.0, 0.5, 0.25)).abs().min_element() < 1e-9);
        });
        // By area the faces across z, y and x are as 4 to 2 to 1.
        assert_eq!(count, POINTS);
        assert!((f64::from(on_large) / f64::from(POINTS) - 4.0 / 7.0).abs() < 0.01, "{on_large}");
    }

    #[test]
    fn errors_are_those_of_the_grid_and_shrink_with_it() {
        let ball = mesh_make::ball(0.5, 16).expect("a closed mesh");
        let of = |cell: f32| {
            let options = MeshOptions { cell: Some(cell), ..MeshOptions::default() };
            let draft = MeshDraft::new(ball.vertices.clone(), ball.triangles.clone(), options);
            let mesh = draft.expect("a size").bake(&|_, _| {}).expect("a closed mesh");
            mesh.collider().field.as_ref().expect("it has an inside").error()
        };
        let (coarse, fine) = (of(0.1), of(0.025));
        // Second differences of the distance to a sphere are 2 / r in all: an eighth of them times the square of the cell at most.
        let most = 0.1 * 0.1 / 8.0 * 2.0 / 0.5;
        assert!(coarse.distance.max < most && coarse.distance.mean > 0.05 * most, "{coarse:?}");
        assert!(fine.distance.most < 0.2 * coarse.distance.most, "{fine:?} and {coarse:?}");
        assert!(fine.angle.most < 0.5 * coarse.angle.most && coarse.angle.max < 0.3, "{fine:?}");
        assert!(fine.distance.mean <= fine.distance.most && fine.distance.most <= fine.distance.max);
        // Faces along the grid are met exactly, but beside edges the gradient turns.
        let cuboid = mesh_make::cuboid(Vec3::new(0.5, 0.4, 0.3)).expect("a closed mesh");
        let error = cuboid.collider().field.as_ref().expect("it has an inside").error();
        assert!(error.distance.max < 5e-4 && error.angle.most < 0.01, "{error:?}");
    }
}
