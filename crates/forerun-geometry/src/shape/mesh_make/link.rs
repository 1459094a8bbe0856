//! A link of a chain: a tube along two straights and two bends.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::{below, count};
use crate::shape::{ShapeError, TriangleList, positive};

/// A link in the plane y = 0, long along x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Radius of the bends, to the middle of the tube. Metres, above `tube_radius`.
    pub radius: f32,
    /// Length of each straight. Metres, 0 or more; a ring has none.
    pub straight: f32,
    /// Radius of the tube. Metres, above 0.
    pub tube_radius: f32,
    /// Parts that each bend is cut into. 2 to 512.
    pub bend_parts: u32,
    /// Points round the tube. 3 to 1024.
    pub sides: u32,
}

impl Link {
    /// Whether it can be made.
    ///
    /// # Errors
    /// When a parameter is out of its range.
    pub fn check(&self) -> Result<(), ShapeError> {
        let Link { radius, straight, tube_radius, bend_parts, sides } = *self;
        positive("radius", radius)?;
        below("tube_radius", tube_radius, radius, "radius")?;
        if !(straight >= 0.0 && straight.is_finite()) {
            return Err(ShapeError::new("straight", format!("must be 0 or more, is {straight}")));
        }
        count("bend_parts", bend_parts, 2..=512)?;
        count("sides", sides, 3..=super::FINEST)
    }

    /// Its surface. The vertices lie on the true tube.
    ///
    /// # Errors
    /// As [`Link::check`].
    pub fn triangles(&self) -> Result<TriangleList, ShapeError> {
        self.check()?;
        let (sections, sides) = (sections(self), self.sides);
        let mut vertices = Vec::with_capacity(sections.len() * sides as usize);
        for (middle, outward) in &sections {
            for side in 0..sides {
                let (sin, cos) = libm::sincos(TAU * f64::from(side) / f64::from(sides));
                let across = (*outward * cos + DVec3::Y * sin) * f64::from(self.tube_radius);
                vertices.push((*middle + across).as_vec3());
            }
        }
        let rounds = sections.len() as u32;
        let at = |section: u32, side: u32| (section % rounds) * sides + side % sides;
        let mut triangles = Vec::with_capacity(2 * vertices.len());
        for i in 0..rounds {
            for j in 0..sides {
                let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        Ok(TriangleList { vertices, triangles })
    }
}

/// Where the tube is cut, and which way is outwards there: from +x towards +z.
fn sections(link: &Link) -> Vec<(DVec3, DVec3)> {
    let (radius, half) = (f64::from(link.radius), 0.5 * f64::from(link.straight));
    let part = PI * radius / f64::from(link.bend_parts);
    // Longer parts do on a straight, but the points on it are what others touch.
    let straight_parts = (2.0 * half / (2.0 * part)).ceil() as u32;
    let mut sections = Vec::new();
    for (side, from) in [(1.0, -0.5 * PI), (-1.0, 0.5 * PI)] {
        for k in 0..=link.bend_parts {
            // A ring has no straights: the end of one bend is the beginning of the other.
            if k == link.bend_parts && straight_parts == 0 {
                continue;
            }
            let (sin, cos) = libm::sincos(from + PI * f64::from(k) / f64::from(link.bend_parts));
            let outward = DVec3::new(cos, 0.0, sin);
            sections.push((DVec3::X * (side * half) + outward * radius, outward));
        }
        for k in 1..straight_parts {
            let along = 1.0 - 2.0 * f64::from(k) / f64::from(straight_parts);
            let outward = DVec3::Z * side;
            sections.push((DVec3::X * (side * half * along) + outward * radius, outward));
        }
    }
    sections
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_are_closed_and_have_the_volume_of_their_tube() {
        for straight in [0.0, 0.01, 0.5] {
            let made = Link { radius: 0.2, straight, tube_radius: 0.05, bend_parts: 24, sides: 24 };
            let mesh = made.triangles().unwrap().mesh().unwrap();
            assert!(mesh.has_inside() && mesh.repairs.is_none(), "{}", mesh.repairs);
            let volume: f32 = (0..mesh.triangles.len())
                .map(|i| {
                    let [a, b, c] = mesh.corners(i);
                    a.dot(b.cross(c)) / 6.0
                })
                .sum();
            // Pappus: the section times the length of the middle line.
            let length = std::f32::consts::TAU * 0.2 + 2.0 * straight;
            let ratio = volume / (length * std::f32::consts::PI * 0.05 * 0.05);
            assert!((0.98..1.0).contains(&ratio), "{ratio}");
            let extent = mesh.bounds().max - mesh.bounds().min;
            assert!((extent.x - (0.5 + straight)).abs() < 1e-5 && (extent.z - 0.5).abs() < 1e-5, "{extent}");
        }
    }

    #[test]
    fn refuse_what_cannot_be() {
        let fine = Link { radius: 0.2, straight: 0.1, tube_radius: 0.05, bend_parts: 12, sides: 12 };
        assert_eq!(Link { radius: 0.05, ..fine }.check().unwrap_err().field, "tube_radius");
        assert_eq!(Link { straight: -1.0, ..fine }.check().unwrap_err().field, "straight");
        assert_eq!(Link { bend_parts: 1, ..fine }.check().unwrap_err().field, "bend_parts");
    }
}
