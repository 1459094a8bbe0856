//! Bolts and nuts with a real thread: right-handed, of the basic profile of ISO 68-1.
//!
//! The profile is a row of triangles with flanks at 60 degrees to each other, an eighth of their height H = √3/2 pitch cut off at the
//! crest of the bolt and a quarter at its root: 5/8 H remain. The surface at angle θ about the y axis and height y depends on
//! y / pitch - θ / 2π alone, so that the triangles follow the helix and its edges are edges of the mesh.
//!
//! A bolt and a nut of the same thread fit when their frames coincide, and wherever a screw motion takes one of them.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::{count, larger};
use crate::shape::{ShapeError, TriangleList, positive};

/// Least and most columns of points round the axis. The corners of a hexagon are in every sixth part of them.
const COLUMNS: (u32, u32) = (12, 384);

/// The thread of a bolt: where and how steep its helix is. The root is 0.5413 `pitch` below the crest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thread {
    /// From the axis to the crest. Metres.
    pub radius: f32,
    /// How far a full turn goes along the axis. Metres, above 0 and at most `radius`.
    pub pitch: f32,
}

/// What a spanner grips.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grip {
    /// A regular hexagon.
    Hexagonal,
    /// A circle.
    Round,
}

/// A bolt about the y axis: its shank from y = -`length` to 0, with a chamfer at the tip, then the head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bolt {
    /// The thread, all along the shank.
    pub thread: Thread,
    /// Length of the shank. Metres, at least a pitch.
    pub length: f32,
    /// From the axis to the flat of the head. Metres, above the radius of the thread.
    pub head_radius: f32,
    /// Height of the head. Metres, above 0.
    pub head_height: f32,
    /// What the head looks like from above.
    pub head: Grip,
    /// Columns of points round the axis: a multiple of 6 from 12 to 384.
    pub segments: u32,
}

/// A nut about the y axis, centred on the origin, with a chamfer at both mouths of its thread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nut {
    /// The thread of the bolt that it is for.
    pub thread: Thread,
    /// How much larger the radius of its own thread is at every height. Metres, 0 or more. The flanks of the two are half of it apart.
    pub clearance: f32,
    /// Height. Metres, at least a pitch.
    pub height: f32,
    /// From the axis to the flat of the outside. Metres, above the radius of the thread with clearance and chamfer (a tenth of the pitch).
    pub outer_radius: f32,
    /// What the outside looks like from above.
    pub outside: Grip,
    /// Columns of points round the axis: a multiple of 6 from 12 to 384.
    pub segments: u32,
}

/// Height of the fundamental triangle, in pitches: √3/2.
const TRIANGLE: f64 = 0.866_025_403_784_438_6;
/// From root to crest, in pitches.
const DEPTH: f64 = 0.625 * TRIANGLE;
/// Corners of the profile in one pitch, by phase, and how far they are below the crest, in depths: crest, flank, root, flank. The points in
/// the middle of the flanks are for contact, which begins with the vertices.
const PROFILE: [(f64, f64); 6] = [
    (-1.0 / 16.0, 0.0),
    (1.0 / 16.0, 0.0),
    (7.0 / 32.0, 0.5),
    (3.0 / 8.0, 1.0),
    (5.0 / 8.0, 1.0),
    (25.0 / 32.0, 0.5),
];
/// How far a chamfer reaches beyond the thread, in pitches.
const CHAMFER: f64 = 0.1;

impl Thread {
    /// Whether it can be made so long.
    fn check_length(&self, field: &'static str, length: f32) -> Result<(), ShapeError> {
        let (least, most) = (self.pitch, PITCHES_MAX * self.pitch);
        if (least..=most).contains(&length) {
            return Ok(());
        }
        let message = format!("must be from one to a thousand pitches ({least} to {most} m), is {length}");
        Err(ShapeError::new(field, message))
    }

    /// From crest to root. Metres.
    #[must_use]
    pub fn depth(&self) -> f32 {
        (DEPTH * f64::from(self.pitch)) as f32
    }

    /// Distance of the bolt's true surface from the axis at an angle about +y (radians, from +x towards -z) and a height (metres).
    #[must_use]
    pub fn radius_at(&self, angle: f64, height: f64) -> f64 {
        let phase = height / f64::from(self.pitch) - angle / TAU;
        // From the middle of the nearest crest, 0 to a half.
        let away = (phase - phase.round()).abs();
        let below = ((away - PROFILE[1].0) / (PROFILE[3].0 - PROFILE[1].0)).clamp(0.0, 1.0);
        f64::from(self.radius) - below * DEPTH * f64::from(self.pitch)
    }

    fn check(&self) -> Result<(), ShapeError> {
        positive("radius", self.radius)?;
        positive("pitch", self.pitch)?;
        if self.pitch <= self.radius {
            return Ok(());
        }
        let message = format!("must be at most radius ({}), is {}", self.radius, self.pitch);
        Err(ShapeError::new("pitch", message))
    }
}

impl Grip {
    /// Distance of the outline from the axis, at column `k` of `columns`, in distances of the flat.
    fn outline(self, k: u32, columns: u32) -> f64 {
        match self {
            Grip::Round => 1.0,
            Grip::Hexagonal => {
                let from_corner = TAU * f64::from(k % (columns / 6)) / f64::from(columns);
                1.0 / libm::cos(TAU / 12.0 - from_corner)
            }
        }
    }
}

/// A point of a column. Neighbouring columns are joined where they have points of the same number; numbers rise along the column.
struct Point {
    number: i64,
    /// Distance from the axis, and height.
    at: DVec2,
}

/// Most pitches of a thread.
const PITCHES_MAX: f32 = 1000.0;

/// Numbers of the points that all columns have, before and behind those of the thread.
const BEFORE: i64 = -1_000_000;
const BEHIND: i64 = 1_000_000;

impl Bolt {
    /// Whether it can be made.
    ///
    /// # Errors
    /// When a parameter is out of its range.
    pub fn check(&self) -> Result<(), ShapeError> {
        self.thread.check()?;
        columns(self.segments)?;
        self.thread.check_length("length", self.length)?;
        positive("head_height", self.head_height)?;
        larger(("head_radius", self.head_radius), ("radius", self.thread.radius))
    }

    /// Its surface. Both its crest and its root lie on the true thread at the columns, and within it between them.
    ///
    /// # Errors
    /// As [`Bolt::check`].
    pub fn triangles(&self) -> Result<TriangleList, ShapeError> {
        self.check()?;
        let Bolt { thread, length, head_radius, head_height, head, segments } = *self;
        let [length, pitch, top] = [length, thread.pitch, head_height].map(f64::from);
        let tip = f64::from(thread.radius) - (DEPTH + CHAMFER) * pitch;
        let columns = (0..segments).map(|k| {
            let limited = |radius: f64, height: f64| radius.min(tip + height + length);
            let mut column = threaded(&thread, (k, segments), (-length, 0.0), limited);
            let rim = f64::from(head_radius) * head.outline(k, segments);
            column.push(Point { number: BEHIND + 1, at: DVec2::new(rim, 0.0) });
            column.push(Point { number: BEHIND + 2, at: DVec2::new(rim, top) });
            column
        });
        let mut surface = Surface::of(columns.collect());
        surface.cap(-length, End::First);
        surface.cap(top, End::Last);
        Ok(surface.triangles())
    }
}

impl Nut {
    /// Whether it can be made.
    ///
    /// # Errors
    /// When a parameter is out of its range.
    pub fn check(&self) -> Result<(), ShapeError> {
        self.thread.check()?;
        columns(self.segments)?;
        if !(self.clearance >= 0.0 && self.clearance.is_finite()) {
            let message = format!("must be a finite number of 0 or more, is {}", self.clearance);
            return Err(ShapeError::new("clearance", message));
        }
        self.thread.check_length("height", self.height)?;
        let mouth = (self.mouth() * self.chord()) as f32;
        if self.outer_radius > mouth && self.outer_radius.is_finite() {
            return Ok(());
        }
        let message =
            format!("must be above that of the thread's mouths ({mouth}), is {}", self.outer_radius);
        Err(ShapeError::new("outer_radius", message))
    }

    /// Radius at the mouths of the thread. Metres.
    fn mouth(&self) -> f64 {
        f64::from(self.thread.radius) + f64::from(self.clearance) + CHAMFER * f64::from(self.thread.pitch)
    }

    /// Between columns a chord is nearer to the axis than its ends: so much farther out are these.
    fn chord(&self) -> f64 {
        1.0 / libm::cos(0.5 * TAU / f64::from(self.segments))
    }

    /// Its surface. No part of it is nearer to the axis than its true thread.
    ///
    /// # Errors
    /// As [`Nut::check`].
    pub fn triangles(&self) -> Result<TriangleList, ShapeError> {
        self.check()?;
        let (mouth, chord) = (self.mouth(), self.chord());
        let [clearance, half] = [self.clearance, 0.5 * self.height].map(f64::from);
        let columns = (0..self.segments).map(|k| {
            let widened =
                |radius: f64, height: f64| (radius + clearance).max(mouth - (half - height.abs())) * chord;
            let mut column = threaded(&self.thread, (k, self.segments), (-half, half), widened);
            let rim = f64::from(self.outer_radius) * self.outside.outline(k, self.segments);
            column.push(Point { number: BEHIND + 1, at: DVec2::new(rim, half) });
            column.push(Point { number: BEHIND + 2, at: DVec2::new(rim, -half) });
            column
        });
        let mut surface = Surface::of(columns.collect());
        surface.close();
        surface.turn();
        Ok(surface.triangles())
    }
}

/// The points of a thread in column `k` of so many, from one height to another; `shaped` makes the radius of the surface from that of the
/// bolt's thread and the height.
fn threaded(
    thread: &Thread,
    (k, columns): (u32, u32),
    (low, high): (f64, f64),
    shaped: impl Fn(f64, f64) -> f64,
) -> Vec<Point> {
    let (part, pitch) = (f64::from(k) / f64::from(columns), f64::from(thread.pitch));
    let end = |number: i64, height: f64| {
        let radius = shaped(thread.radius_at(TAU * part, height), height);
        Point { number, at: DVec2::new(radius, height) }
    };
    // What comes nearer to an end than this is left to it: no thinner triangles than the columns make anyway.
    let nearest = 0.25 * pitch / f64::from(columns);
    let mut points = vec![end(BEFORE, low)];
    let turns = |height: f64| (height / pitch - part).floor() as i64;
    for turn in turns(low) - 1..=turns(high) + 1 {
        for (corner, (phase, below)) in PROFILE.iter().enumerate() {
            let height = pitch * (turn as f64 + phase + part);
            if height > low + nearest && height < high - nearest {
                let radius = shaped(f64::from(thread.radius) - below * DEPTH * pitch, height);
                let number = turn * PROFILE.len() as i64 + corner as i64;
                points.push(Point { number, at: DVec2::new(radius, height) });
            }
        }
    }
    points.push(end(BEHIND, high));
    points
}

/// Which end of the columns.
#[derive(Clone, Copy)]
enum End {
    First,
    Last,
}

/// A surface of columns of points round the axis.
struct Surface {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// By column: the indices of its vertices, and their numbers.
    columns: Vec<Vec<(u32, i64)>>,
}

impl Surface {
    /// The strips between neighbouring columns, outwards when they go up outside of the axis.
    fn of(columns: Vec<Vec<Point>>) -> Surface {
        let count = columns.len();
        let mut surface =
            Surface { vertices: Vec::new(), triangles: Vec::new(), columns: Vec::with_capacity(count) };
        for (k, column) in columns.into_iter().enumerate() {
            let (sin, cos) = libm::sincos(TAU * k as f64 / count as f64);
            let first = surface.vertices.len() as u32;
            surface.columns.push(column.iter().zip(first..).map(|(p, i)| (i, p.number)).collect());
            // About +y, right-handed: from +x towards -z.
            surface.vertices.extend(column.iter().map(|p| DVec3::new(p.at.x * cos, p.at.y, -p.at.x * sin)));
        }
        for k in 0..count {
            let next = (k + 1) % count;
            // A turn on, the helix is a pitch higher: what was a number there is one of the turn before.
            let turned = if next == 0 { -(PROFILE.len() as i64) } else { 0 };
            strip(&surface.columns[k], &surface.columns[next], turned, &mut surface.triangles);
        }
        surface
    }

    /// Joins one end of all columns by a point of the axis.
    fn cap(&mut self, height: f64, end: End) {
        let pole = self.vertices.len() as u32;
        self.vertices.push(DVec3::new(0.0, height, 0.0));
        for k in 0..self.columns.len() {
            let [a, b] = [k, (k + 1) % self.columns.len()].map(|k| {
                let column = &self.columns[k];
                if matches!(end, End::First) { column[0].0 } else { column[column.len() - 1].0 }
            });
            self.triangles.push(if matches!(end, End::First) { [pole, b, a] } else { [pole, a, b] });
        }
    }

    /// Joins the last points of all columns with the first.
    fn close(&mut self) {
        for k in 0..self.columns.len() {
            let (column, next) = (&self.columns[k], &self.columns[(k + 1) % self.columns.len()]);
            let [a, b] = [column, next].map(|column| column[column.len() - 1].0);
            let [c, d] = [next[0].0, column[0].0];
            self.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }

    /// Makes outside what was inside.
    fn turn(&mut self) {
        self.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }

    fn triangles(self) -> TriangleList {
        let vertices = self.vertices.iter().map(|v| v.as_vec3()).collect();
        TriangleList { vertices, triangles: self.triangles }
    }
}

/// The triangles between two neighbouring columns: quadrilaterals where both go on to the same number, a triangle where only one has the next.
fn strip(left: &[(u32, i64)], right: &[(u32, i64)], turned: i64, triangles: &mut Vec<[u32; 3]>) {
    let of_thread = BEFORE + 1..BEHIND;
    let right_number =
        |i: usize| if of_thread.contains(&right[i].1) { right[i].1 + turned } else { right[i].1 };
    let (mut i, mut j) = (0, 0);
    while i + 1 < left.len() || j + 1 < right.len() {
        let (a, b) = (left[i].0, right[j].0);
        let on_left = left.get(i + 1).map_or(i64::MAX, |point| point.1);
        let on_right = if j + 1 < right.len() { right_number(j + 1) } else { i64::MAX };
        if on_left <= on_right {
            let (from, to) = (a, left[i + 1].0);
            triangles.push([from, b, to]);
            i += 1;
        }
        if on_right <= on_left {
            triangles.push([left[i].0, b, right[j + 1].0]);
            j += 1;
        }
    }
}

fn columns(segments: u32) -> Result<(), ShapeError> {
    count("segments", segments, COLUMNS.0..=COLUMNS.1)?;
    if segments.is_multiple_of(6) {
        return Ok(());
    }
    Err(ShapeError::new("segments", format!("must be a multiple of 6, is {segments}")))
}

#[cfg(test)]
mod tests;
