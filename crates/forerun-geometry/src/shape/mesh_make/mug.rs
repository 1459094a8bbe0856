//! Mug: a turned cup whose handle grows out of its wall.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec2;

use super::revolution::{close_ends, lathe};
use super::surface::{Surface, arc, at_angle, line_to};
use super::{FINEST, ShapeError, below, count};
use crate::shape::{TriangleList, positive};

/// A mug about the y axis: it stands on y = 0, opens upwards, and has its handle, half an ellipse, towards +x.
///
/// Where the handle meets the wall, a patch of the wall is left out and its border joined to the handle's end: one closed surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mug {
    /// Of the cup outside. Metres, above 0.
    pub radius: f32,
    /// From foot to rim. Metres, above 0.
    pub height: f32,
    /// Of wall and bottom. Metres, above 0 and below a third of `radius` and `height`.
    pub thickness: f32,
    /// Radius of the handle's round section. Metres, above 0 and small enough for the handle to bend and to fit on the wall.
    pub handle_radius: f32,
    /// How far the middle of the handle stands out from the wall. Metres, above 0.
    pub handle_reach: f32,
    /// Points round the cup. 16 to 1024; best a multiple of 16, as smaller rings have half, a quarter... of them.
    pub segments: u32,
}

/// How much wider than the handle the patch is that it grows out of.
const FLARE: f64 = 1.3;
/// Part of the height between the ends of the handle.
const GRIP: f64 = 0.55;
/// The height of the middle of the handle, as part of the mug's.
const GRIP_MIDDLE: f64 = 0.52;

/// The two patches of the wall, in columns about the x axis and rows of the outer wall.
struct Patches {
    /// How many columns wide and rows high each patch is. Even.
    parts: u32,
    /// First row of the lower and of the upper patch: an index into the rings of the lathe.
    rows: [usize; 2],
}

impl Mug {
    /// Whether it can be made.
    ///
    /// # Errors
    /// When a parameter is out of its range.
    pub fn check(&self) -> Result<(), ShapeError> {
        positive("radius", self.radius)?;
        positive("height", self.height)?;
        below(
            "thickness",
            self.thickness,
            self.radius.min(self.height) / 3.0,
            "a third of radius and height",
        )?;
        positive("handle_reach", self.handle_reach)?;
        count("segments", self.segments, 16..=FINEST)?;
        // The handle is most bent at its middle or at its ends, and a patch is to be narrower than a quarter of the cup.
        let (half, reach) = (0.5 * GRIP as f32 * self.height, self.handle_reach);
        let bend = (half * half / reach).min(reach * reach / half);
        let room = (bend / 1.5).min(0.3 * self.radius).min(0.3 * half);
        below("handle_radius", self.handle_radius, room, "what handle_reach, height and radius leave")?;
        let patch = self.patch_half_width();
        let room = 0.4 * half;
        if patch < f64::from(room) {
            return Ok(());
        }
        let message = format!(
            "must be more for this handle: a patch of the wall is {patch:.4} wide, the handle leaves room for {room}"
        );
        Err(ShapeError::new("segments", message))
    }

    /// Its surface.
    ///
    /// # Errors
    /// As [`Mug::check`].
    pub fn triangles(&self) -> Result<TriangleList, ShapeError> {
        self.check()?;
        let mut surface = Surface::default();
        let (profile, patches) = self.profile();
        let rings = lathe(&mut surface, &profile, self.segments);
        for (row, pair) in rings.windows(2).enumerate() {
            let parts = patches.parts as usize;
            if patches.rows.iter().any(|first| (*first..*first + parts).contains(&row)) {
                band_but_patch(&mut surface, [&pair[0], &pair[1]], parts / 2);
            } else {
                surface.band(&pair[0], &pair[1]);
            }
        }
        close_ends(&mut surface, &profile, &rings);
        let mut sections = vec![border(&rings, &patches, 0)];
        sections.extend(self.handle(&mut surface, 4 * patches.parts));
        sections.push(border(&rings, &patches, 1));
        for pair in sections.windows(2) {
            surface.band(&pair[0], &pair[1]);
        }
        Ok(surface.finish())
    }

    /// Columns of a patch on either side of the x axis.
    fn half_columns(&self) -> u32 {
        let column = TAU * f64::from(self.radius) / f64::from(self.segments);
        ((FLARE * f64::from(self.handle_radius) / column).round() as u32).max(1)
    }

    fn patch_half_width(&self) -> f64 {
        let angle = TAU * f64::from(self.half_columns()) / f64::from(self.segments);
        f64::from(self.radius) * libm::sin(angle)
    }

    /// The heights of the middles of the handle's ends.
    fn ends(&self) -> [f64; 2] {
        [-0.5, 0.5].map(|side| f64::from(self.height) * (GRIP_MIDDLE + side * GRIP))
    }

    /// From the middle of the bottom outside up to the rim and inside down to the middle.
    fn profile(&self) -> (Vec<DVec2>, Patches) {
        let [radius, height, thickness] = [self.radius, self.height, self.thickness].map(f64::from);
        let step = TAU * radius / f64::from(self.segments);
        let round = 0.5 * thickness;
        let parts = ((FRAC_PI_2 * thickness / step).round() as u32).max(4);
        let mut profile = vec![DVec2::ZERO];
        line_to(&mut profile, DVec2::new(radius - round, 0.0), step);
        arc(
            &mut profile,
            DVec2::new(radius - round, round),
            DVec2::splat(round),
            (-FRAC_PI_2, 0.0, parts / 2),
        );
        let patch_parts = 2 * self.half_columns();
        let half_patch = self.patch_half_width();
        let rows = self.ends().map(|middle| {
            line_to(&mut profile, DVec2::new(radius, middle - half_patch), step);
            // The profile's first point is no ring.
            let first = profile.len() - 2;
            line_to(
                &mut profile,
                DVec2::new(radius, middle + half_patch),
                2.0 * half_patch / f64::from(patch_parts),
            );
            first
        });
        line_to(&mut profile, DVec2::new(radius, height - round), step);
        arc(&mut profile, DVec2::new(radius - round, height - round), DVec2::splat(round), (0.0, PI, parts));
        line_to(&mut profile, DVec2::new(radius - thickness, thickness), step);
        line_to(&mut profile, DVec2::new(0.0, thickness), step);
        (profile, Patches { parts: patch_parts, rows })
    }

    /// The sections of the handle from its lower to its upper end, each counter-clockwise about the way along it.
    fn handle(&self, surface: &mut Surface, sides: u32) -> Vec<Vec<u32>> {
        let [low, high] = self.ends();
        let (half, reach, radius) =
            (0.5 * (high - low), f64::from(self.handle_reach), f64::from(self.handle_radius));
        // The first section stands half a radius off the wall.
        let start = libm::asin(0.5 * radius / reach);
        let step = TAU * radius / f64::from(sides);
        let parts = (0.5 * PI * (half + reach) / (2.0 * step)).round().max(8.0) as u32;
        let sections = (0..=parts).map(|i| {
            let turn = at_angle(start + (PI - 2.0 * start) * f64::from(i) / f64::from(parts));
            let middle =
                DVec2::new(f64::from(self.radius) + reach * turn.y, 0.5 * (low + high) - half * turn.x);
            let along = DVec2::new(reach * turn.x, half * turn.y).normalize();
            surface.ring((0..sides).map(|k| {
                // Starts where the border of the patch starts: at its corner.
                let around = radius * at_angle(TAU * f64::from(k) / f64::from(sides) - 0.25 * PI);
                (middle + along.perp() * around.x).extend(around.y)
            }))
        });
        sections.collect()
    }
}

/// The band between two rings of the wall, without the columns of the patch: `half` on either side of the x axis.
fn band_but_patch(surface: &mut Surface, [a, b]: [&[u32]; 2], half: usize) {
    for i in half..a.len() - half {
        let next = (i + 1) % a.len();
        surface.quad([a[i], a[next], b[next], b[i]]);
    }
}

/// The border of the lower (0) or upper (1) patch, counter-clockwise about the way of the handle there: outwards at the lower, inwards at the upper.
/// Starts at the corner towards -z of the side that is inside the handle's bow.
fn border(rings: &[Vec<u32>], patches: &Patches, end: usize) -> Vec<u32> {
    let (n, first) = (patches.parts as usize, patches.rows[end]);
    // Row 0 is the one inside the bow; columns go towards +z, against the order of a ring.
    let at = |row: usize, column: usize| {
        let ring = &rings[if end == 0 { first + n - row } else { first + row }];
        ring[(ring.len() + n / 2 - column) % ring.len()]
    };
    let sides = [
        (0..n).map(|k| at(0, k)).collect::<Vec<u32>>(),
        (0..n).map(|k| at(k, n)).collect(),
        (0..n).map(|k| at(n, n - k)).collect(),
        (0..n).map(|k| at(n - k, 0)).collect(),
    ];
    sides.concat()
}
