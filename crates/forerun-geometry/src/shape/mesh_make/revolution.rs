//! Solids of revolution about the y axis: torus, ring, and what a lathe makes.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::surface::{Surface, on_circle};
use super::{FINEST, Mesh, ShapeError, count, larger};
use crate::shape::{TriangleList, positive};

/// A torus about the y axis. Has 2 `segments` `sides` triangles; its vertices lie on the true torus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus {
    /// From the axis to the middle of the tube. Metres, above `tube_radius`.
    pub radius: f32,
    /// Radius of the tube. Metres, above 0.
    pub tube_radius: f32,
    /// Points round the axis. 3 to 1024.
    pub segments: u32,
    /// Points round the tube. 3 to 1024.
    pub sides: u32,
}

impl Torus {
    /// Whether it can be made.
    ///
    /// # Errors
    /// When a parameter is out of its range.
    pub fn check(&self) -> Result<(), ShapeError> {
        larger(("radius", self.radius), ("tube_radius", self.tube_radius))?;
        count("segments", self.segments, 3..=FINEST)?;
        count("sides", self.sides, 3..=FINEST)
    }

    /// Its surface.
    ///
    /// # Errors
    /// As [`Torus::check`].
    pub fn triangles(&self) -> Result<TriangleList, ShapeError> {
        self.check()?;
        let middle = DVec2::new(self.radius.into(), 0.0);
        let on_tube = |i| middle + f64::from(self.tube_radius) * on_circle(i, self.sides);
        let section: Vec<DVec2> = (0..self.sides).map(on_tube).collect();
        Ok(revolve(&section, self.segments))
    }
}

/// A [`Torus`] about the y axis: `radius` from its centre to the middle of the tube, and the tube's own (metres); `segments` round
/// the axis, `sides` round the tube.
///
/// # Errors
/// When not 0 < `tube_radius` < `radius`, or a count is not from 3 to 1024.
pub fn torus(radius: f32, tube_radius: f32, segments: u32, sides: u32) -> Result<Mesh, ShapeError> {
    Ok(Torus { radius, tube_radius, segments, sides }.triangles()?.mesh()?)
}

/// A ring of rectangular section about the y axis, like a washer or a pipe: radii and half height in metres. Has 8 `segments`
/// triangles.
///
/// # Errors
/// When not 0 < `inner` < `outer`, the half height is not above 0, or `segments` is not from 3 to 1024.
pub fn ring(outer: f32, inner: f32, half_height: f32, segments: u32) -> Result<Mesh, ShapeError> {
    if !(inner > 0.0 && inner < outer && outer.is_finite()) {
        return Err(ShapeError::new(
            "inner",
            format!("must be above 0 and below outer, is {inner} with outer {outer}"),
        ));
    }
    positive("half_height", half_height)?;
    count("segments", segments, 3..=FINEST)?;
    let (outer, inner, h) = (f64::from(outer), f64::from(inner), f64::from(half_height));
    let section = [DVec2::new(outer, -h), DVec2::new(outer, h), DVec2::new(inner, h), DVec2::new(inner, -h)];
    Ok(revolve(&section, segments).mesh()?)
}

/// A closed section (x: distance from the y axis, y: height; counter-clockwise) turned about the y axis.
fn revolve(section: &[DVec2], segments: u32) -> TriangleList {
    let sides = section.len() as u32;
    let mut vertices = Vec::new();
    for segment in 0..segments {
        let turn = on_circle(segment, segments);
        vertices.extend(section.iter().map(|p| DVec3::new(p.x * turn.x, p.y, p.x * turn.y).as_vec3()));
    }
    let at = |segment: u32, side: u32| (segment % segments) * sides + side % sides;
    let mut triangles = Vec::new();
    for i in 0..segments {
        for j in 0..sides {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    TriangleList { vertices, triangles }
}

/// Narrowest triangle of a ring of the lathe, as a part of the widest; below, the ring has half as many.
const NARROWEST: f64 = 0.65;

/// The rings of a turned piece: a profile (x: distance from the y axis, y: height) from a point of the axis outwards, up and back to
/// the axis, without its two ends. A ring has `segments` vertices, or half, a quarter... as many where it is small, counter-clockwise
/// about +y from the x axis.
pub(super) fn lathe(surface: &mut Surface, profile: &[DVec2], segments: u32) -> Vec<Vec<u32>> {
    let widest = profile.iter().fold(0.0, |w: f64, p| w.max(p.x)) * TAU / f64::from(segments);
    let rings = profile[1..profile.len() - 1].iter().map(|p| {
        let mut around = segments;
        while around.is_multiple_of(2) && around >= 8 && p.x * TAU / f64::from(around) < NARROWEST * widest {
            around /= 2;
        }
        surface.ring((0..around).map(|i| {
            let turn = on_circle(i, around);
            DVec3::new(p.x * turn.x, p.y, -p.x * turn.y)
        }))
    });
    rings.collect()
}

/// Closes the two ends of a turned piece on the axis.
pub(super) fn close_ends(surface: &mut Surface, profile: &[DVec2], rings: &[Vec<u32>]) {
    let on_axis = |p: &DVec2| DVec3::new(0.0, p.y, 0.0);
    if let ([first, .., last], [bottom, .., top]) = (profile, rings) {
        let backwards: Vec<u32> = bottom.iter().rev().copied().collect();
        surface.cap(&backwards, on_axis(first));
        surface.cap(top, on_axis(last));
    }
}
