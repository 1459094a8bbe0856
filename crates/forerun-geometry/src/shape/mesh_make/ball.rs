//! Ball: an icosahedron cut finer and blown up.

use glam::DVec3;

use super::surface::Surface;
use super::{Mesh, ShapeError, count};
use crate::Vec3;
use crate::shape::{TriangleList, positive};

/// Most parts that an edge of a ball is cut into: 327 680 triangles.
const FINEST_BALL: u32 = 128;

/// A ball whose vertices lie on the sphere: an icosahedron with each edge cut into parts. Has 20 `parts`² triangles: 12 parts for 2880.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Metres, above 0.
    pub radius: f32,
    /// 1 to 128.
    pub parts: u32,
}

impl Ball {
    /// Whether it can be made.
    ///
    /// # Errors
    /// When a parameter is out of its range.
    pub fn check(&self) -> Result<(), ShapeError> {
        positive("radius", self.radius)?;
        count("parts", self.parts, 1..=FINEST_BALL)
    }

    /// Its surface.
    ///
    /// # Errors
    /// As [`Ball::check`].
    pub fn triangles(&self) -> Result<TriangleList, ShapeError> {
        self.check()?;
        let (parts, radius) = (self.parts, self.radius);
        let (corners, faces) = icosahedron();
        let mut surface = Surface::default();
        for face in faces {
            let [a, b, c] = face.map(|i| corners[i]);
            // Row r has r + 1 points, from the side ab to the side ac. Points on an edge come out of the same sum for both of its
            // faces (a zero weight adds an exact zero), so that they weld.
            let mut points = Vec::new();
            for row in 0..=parts {
                for i in 0..=row {
                    let weights = [parts - row, row - i, i].map(f64::from);
                    let point = sorted_sum([a * weights[0], b * weights[1], c * weights[2]], radius);
                    points.push(surface.vertex(point));
                }
            }
            let at = |row: u32, i: u32| points[(row * (row + 1) / 2 + i) as usize];
            for row in 0..parts {
                for i in 0..=row {
                    surface.triangle([at(row, i), at(row + 1, i), at(row + 1, i + 1)]);
                    if i < row {
                        surface.triangle([at(row, i), at(row + 1, i + 1), at(row, i + 1)]);
                    }
                }
            }
        }
        Ok(surface.finish())
    }
}

/// A [`Ball`] of the given radius (metres), each edge of its icosahedron cut into `parts`.
///
/// # Errors
/// When the radius is not above 0, or `parts` is not from 1 to 128.
pub fn ball(radius: f32, parts: u32) -> Result<Mesh, ShapeError> {
    Ok(Ball { radius, parts }.triangles()?.mesh()?)
}

/// The sum in an order that depends on the three terms alone, put on the sphere.
fn sorted_sum(mut terms: [DVec3; 3], radius: f32) -> Vec3 {
    terms.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z)));
    let sum = terms[0] + terms[1] + terms[2];
    (sum / sum.length() * f64::from(radius)).as_vec3()
}

/// Corners (not on the unit sphere) and outward faces of an icosahedron: three golden rectangles.
fn icosahedron() -> ([DVec3; 12], [[usize; 3]; 20]) {
    let g = f64::midpoint(1.0, 5.0_f64.sqrt());
    let corners = [
        DVec3::new(-1.0, g, 0.0),
        DVec3::new(1.0, g, 0.0),
        DVec3::new(-1.0, -g, 0.0),
        DVec3::new(1.0, -g, 0.0),
        DVec3::new(0.0, -1.0, g),
        DVec3::new(0.0, 1.0, g),
        DVec3::new(0.0, -1.0, -g),
        DVec3::new(0.0, 1.0, -g),
        DVec3::new(g, 0.0, -1.0),
        DVec3::new(g, 0.0, 1.0),
        DVec3::new(-g, 0.0, -1.0),
        DVec3::new(-g, 0.0, 1.0),
    ];
    let faces = [
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    (corners, faces)
}
