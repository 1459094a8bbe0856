//! Torus knot: a closed tube that winds round a ring.

use super::{FINEST, ShapeError, count, larger};
use crate::Vec3;
use crate::shape::{TriangleList, positive};

/// A tube along a (p, q) torus knot about the y axis: p turns about the axis while it winds q times round the ring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorusKnot {
    /// Turns about the axis. 1 to 12, without a common factor with `q`.
    pub p: u32,
    /// Windings round the ring. 1 to 12.
    pub q: u32,
    /// Radius of the ring that the tube winds round. Metres, above `winding_radius`.
    pub radius: f32,
    /// How far the middle of the tube is from the ring. Metres, above 0.
    pub winding_radius: f32,
    /// Radius of the tube. Metres, above 0 and so small that the tube does not cut itself.
    pub tube_radius: f32,
    /// Points along the tube. 16 to 4096.
    pub segments: u32,
    /// Points round the tube. 3 to 1024.
    pub sides: u32,
}

/// A cut through the tube: normal, binormal and the direction of the tube are a right-handed set of unit vectors.
struct Section {
    centre: Vec3,
    normal: Vec3,
    binormal: Vec3,
}

impl TorusKnot {
    /// Whether it can be made.
    ///
    /// # Errors
    /// When a parameter is out of its range.
    pub fn check(&self) -> Result<(), ShapeError> {
        count("p", self.p, 1..=12)?;
        count("q", self.q, 1..=12)?;
        if common_factor(self.p, self.q) != 1 {
            let message = format!(
                "p and q must have no common factor (2 and 3 make a trefoil), are {} and {}",
                self.p, self.q
            );
            return Err(ShapeError::new("q", message));
        }
        larger(("radius", self.radius), ("winding_radius", self.winding_radius))?;
        positive("tube_radius", self.tube_radius)?;
        count("segments", self.segments, 16..=4096)?;
        count("sides", self.sides, 3..=FINEST)?;
        let room = self.room();
        if self.tube_radius >= room {
            let message =
                format!("the tube cuts itself: must be below {room:.4} here, is {}", self.tube_radius);
            return Err(ShapeError::new("tube_radius", message));
        }
        Ok(())
    }

    /// Its surface.
    ///
    /// # Errors
    /// As [`TorusKnot::check`].
    pub fn triangles(&self) -> Result<TriangleList, ShapeError> {
        self.check()?;
        let n = self.segments;
        let sections = (0..n).map(|i| {
            let centre = self.point(i, n);
            let tangent = (self.point((i + 1) % n, n) - self.point((i + n - 1) % n, n)).normalize();
            // From the ring outwards, made square to the tangent: it closes after p turns, as the curve does.
            let (sin_p, cos_p) = turn(i * self.p, n);
            let outward = centre - Vec3::new(cos_p, 0.0, sin_p) * self.radius;
            let normal = (outward - tangent * outward.dot(tangent)).normalize();
            Section { centre, normal, binormal: tangent.cross(normal) }
        });
        Ok(tube(&sections.collect::<Vec<_>>(), self.tube_radius, self.sides))
    }

    /// Largest tube radius at which strands stay apart: half of the smallest distance between parts of the middle line that are
    /// not neighbours along it (further apart than half a turn of a circle with that diameter).
    fn room(&self) -> f32 {
        let count = 256;
        let line: Vec<Vec3> = (0..count).map(|i| self.point(i, count)).collect();
        let step: Vec<f32> =
            (0..count as usize).map(|i| line[i].distance(line[(i + 1) % count as usize])).collect();
        let length: f32 = step.iter().sum();
        let mut room = f32::INFINITY;
        for i in 0..line.len() {
            let mut along = 0.0;
            for j in i + 1..line.len() {
                along += step[j - 1];
                let distance = line[i].distance(line[j]);
                if along.min(length - along) > std::f32::consts::FRAC_PI_2 * distance {
                    room = room.min(0.5 * distance);
                }
            }
        }
        room
    }

    /// Place `i` of `count` along the middle line.
    pub(super) fn point(&self, i: u32, count: u32) -> Vec3 {
        let (sin_p, cos_p) = turn(i * self.p, count);
        let (sin_q, cos_q) = turn(i * self.q, count);
        let out = self.radius + self.winding_radius * cos_q;
        Vec3::new(out * cos_p, self.winding_radius * sin_q, out * sin_p)
    }
}

/// The closed tube round a ring of sections, wound counter-clockwise seen from outside.
fn tube(sections: &[Section], radius: f32, sides: u32) -> TriangleList {
    let count = sections.len() as u32;
    let mut vertices = Vec::with_capacity(sections.len() * sides as usize);
    for section in sections {
        for j in 0..sides {
            let (sin, cos) = turn(j, sides);
            vertices.push(section.centre + (section.normal * cos + section.binormal * sin) * radius);
        }
    }
    let at = |i: u32, j: u32| (i % count) * sides + j % sides;
    let mut triangles = Vec::with_capacity(vertices.len() * 2);
    for i in 0..count {
        for j in 0..sides {
            triangles.push([at(i, j), at(i, j + 1), at(i + 1, j)]);
            triangles.push([at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)]);
        }
    }
    TriangleList { vertices, triangles }
}

/// Sine and cosine of `part / whole` of a full turn.
fn turn(part: u32, whole: u32) -> (f32, f32) {
    libm::sincosf((part % whole) as f32 * (std::f32::consts::TAU / whole as f32))
}

fn common_factor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { common_factor(b, a % b) }
}
